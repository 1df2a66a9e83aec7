/* The labels that an image has, for people who look for the one to mesh. */
#ifndef LAR_STUDY_LABEL_LIST_H
#define LAR_STUDY_LABEL_LIST_H

#include <stdbool.h>
#include <stdint.h>

#include "lariat.h"

typedef struct lar_label_row {
    int32_t label;
    char *name; /* NULL: it has none */
    int64_t voxels;
} lar_label_row;

typedef struct lar_label_list {
    int32_t count;
    lar_label_row *row; /* ascending labels that have voxels; without 0 */
    int32_t size[3];    /* of the image, voxels */
    double voxel;       /* volume of one [m^3] */
    double edge[3];     /* of one [m] */
} lar_label_list;

/* Reads an image, and names of its labels from a file (`names` may be NULL). */
lar_status lar_label_list_read(const char *path, const char *names, lar_label_list *list,
                               lar_error *error);
void lar_label_list_clear(lar_label_list *list); /* a zeroed one is fine */

/* Whether a word, number or name in any case of letters, is one of them. */
bool lar_label_list_has(const lar_label_list *list, const char *word);

#endif
