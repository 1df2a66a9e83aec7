/* The frames of a film: a folder of images, ordered by the number at the end of their names, or a
 * text file (.txt) with the name of one image a line, in their order. A number that is missing is a
 * frame that is missing: the others keep their time.
 */
#ifndef LAR_STUDY_FRAMES_LIST_H
#define LAR_STUDY_FRAMES_LIST_H

#include <stdint.h>

#include "base/error.h"

typedef struct lar_frame {
    char *path;
    int64_t number; /* frames after the first */
} lar_frame;

typedef struct lar_frame_list {
    int32_t count;
    lar_frame *frame; /* [count], the first has number 0 */
} lar_frame_list;

/* Into a zeroed one; the caller clears in any case. */
lar_status lar_frame_list_read(const char *path, lar_frame_list *list, lar_error *error);
void lar_frame_list_clear(lar_frame_list *list); /* idempotent */

#endif
