/* Fuzz target: the reader of label images of NIfTI (.nii, .nii.gz). */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "meshing/image/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    lar_bytes bytes = {malloc(size + 1), size};
    if (!bytes.data) return 0;
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    lar_image image;
    lar_error error = {0};
    if (lar_nifti_parse("fuzz.nii", &bytes, &image, &error) == LAR_OK &&
        !(lar_image_voxel_volume(&image) > 0))
        abort();
    lar_image_clear(&image);
    lar_bytes_free(&bytes);
    return 0;
}
