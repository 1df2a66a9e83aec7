/* Grey images: PGM (P2, P5) by hand, PNG by libpng where it was there when Lariat was built.
 * Colours become grey, transparency is on black. */
#ifndef LAR_STUDY_FRAMES_IMAGE_H
#define LAR_STUDY_FRAMES_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"

typedef struct lar_grey {
    int width, height;
    float *value; /* [height][width], 0 to 1, from the upper left */
    double step;  /* between two neighbouring numbers of the file, of 1 */
} lar_grey;

/* Samples as a file has them, before they are made light. */
typedef struct lar_samples {
    int width, height;
    int most; /* the number that is white, to 65535 */
    uint16_t *sample;
} lar_samples;

/* Reads into a zeroed image. Samples are raised to the power of `gamma`: 1 where numbers are as the
 * light was, some 2.2 for pictures made for people's eyes. Errors name the file. */
lar_status lar_grey_read(const char *path, double gamma, lar_grey *image, lar_error *error);
void lar_grey_clear(lar_grey *image); /* idempotent */

bool lar_grey_has_png(void); /* whether this program has libpng */

/* The two readers, of a file's bytes (the name is for sentences). The caller frees the samples in
 * any case. */
lar_status lar_pgm_read(const char *path, const lar_bytes *bytes, lar_samples *samples,
                        lar_error *error);
lar_status lar_png_read(const char *path, const lar_bytes *bytes, lar_samples *samples,
                        lar_error *error);

/* Room for an image of this size, or a sentence. */
lar_status lar_samples_make(const char *path, double width, double height, lar_samples *samples,
                            lar_error *error);

#endif
