/* Segmented images: one label per voxel, 0 for what is none.
 *
 *     .nii .nii.gz (NIfTI-1 and -2, nifti.c)  --.
 *     .nrrd .nhdr  (NRRD, nrrd.c)             --+--> lar_image, always in metres, in the world of
 *                                               NIfTI: +x right, +y anterior (front), +z superior
 *
 * Nothing is believed before it is checked: headers that claim more voxels than memory may hold or
 * than the file can have (deflate makes 1 byte of 1,032 at most), images that are no label maps
 * (fractions, negative numbers), images of more than three axes, affine maps that cannot be turned
 * round. Oblique and left-handed axes are fine.
 */
#ifndef LAR_MESHING_IMAGE_IMAGE_H
#define LAR_MESHING_IMAGE_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"

/* Voxels that an image may have, and along one axis: labels take 1 GB at most, and a slice of the
 * image, of which some are held besides, no more than that. */
enum { LAR_IMAGE_VOXELS_MAX = 1 << 29, LAR_IMAGE_SIDE_MAX = 1 << 13, LAR_IMAGE_LABEL_MAX = 65535 };

typedef struct lar_label_name {
    int32_t label;
    char *name;
} lar_label_name;

struct lar_image {
    char *source;
    int32_t size[3];       /* voxels along i, j, k */
    double to_world[3][4]; /* [m]: world = to_world * (i, j, k, 1), at the voxel's centre */
    uint16_t *label;       /* [size[0] * size[1] * size[2]], i runs fastest */
    int32_t name_count;    /* names that the file gives to labels (NRRD segments) */
    lar_label_name *name;
};

/* The path's ending when it is one of a label image (".nii.gz"), else NULL. */
const char *lar_image_ending(const char *path);

/* By extension. `image` is zeroed before; on failure it is cleared. */
lar_status lar_image_read(const char *path, lar_image *image, lar_error *error);
void lar_image_clear(lar_image *image);

/* The readers, also entry points for fuzzing. `bytes` is the whole file as it lies on the disk
 * (compressed or not); a detached header (.nhdr) reads its data file beside `path`. On failure the
 * caller clears. */
lar_status lar_nifti_parse(const char *path, const lar_bytes *bytes, lar_image *image,
                           lar_error *error);
lar_status lar_nrrd_parse(const char *path, const lar_bytes *bytes, lar_image *image,
                          lar_error *error);

/* The name that the file gives to a label, or NULL. Owned by the image. */
const char *lar_image_label_name(const lar_image *image, int32_t label);

/* Voxels of every label, [LAR_IMAGE_LABEL_MAX + 1], by the caller. */
void lar_image_count(const lar_image *image, int64_t *count);

/* Cubic metres of a voxel. */
double lar_image_voxel_volume(const lar_image *image);

/* Reads a list of names, "LABEL,NAME" or "LABEL NAME" per line (a header line and further columns
 * are fine), and adds them to the image's. */
lar_status lar_image_read_names(const char *path, lar_image *image, lar_error *error);

#endif
