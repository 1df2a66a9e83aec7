/* A file that is there when it is whole: written beside its place, and moved there at the end. */
#ifndef LAR_STUDY_OUTPUT_H
#define LAR_STUDY_OUTPUT_H

#include <stdio.h>

#include "base/error.h"

typedef struct lar_output {
    FILE *file;
    char *part; /* the file until it is whole */
} lar_output;

/* Errors name the path and the reason. */
lar_status lar_output_begin(const char *path, lar_output *output, lar_error *error);
/* After a begin that succeeded, whatever has become of the writing. */
lar_status lar_output_end(const char *path, lar_output *output, lar_error *error);

#endif
