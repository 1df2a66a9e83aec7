/* A label image on the disk, as an NRRD file, for tests of what begins with a file. */
#ifndef LAR_TESTS_IMAGE_FILE_H
#define LAR_TESTS_IMAGE_FILE_H

#include "testing.h"

#include "meshing/image/image.h"

/* Segments' names may be NULL; name[i] is that of label i + 1. */
static TEST_UNUSED void image_file(const lar_image *image, const char *path,
                                   const char *const *name, int names) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file,
            "NRRD0004\ntype: unsigned short\ndimension: 3\nspace: right-anterior-superior\n"
            "sizes: %d %d %d\nendian: little\nencoding: raw\nspace directions:",
            (int)image->size[0], (int)image->size[1], (int)image->size[2]);
    for (int a = 0; a < 3; a++)
        fprintf(file, " (%.17g,%.17g,%.17g)", 1e3 * image->to_world[0][a],
                1e3 * image->to_world[1][a], 1e3 * image->to_world[2][a]);
    fprintf(file, "\nspace origin: (%.17g,%.17g,%.17g)\n", 1e3 * image->to_world[0][3],
            1e3 * image->to_world[1][3], 1e3 * image->to_world[2][3]);
    for (int i = 0; i < names; i++)
        fprintf(file, "Segment%d_LabelValue:=%d\nSegment%d_Name:=%s\n", i, i + 1, i, name[i]);
    fputc('\n', file);
    size_t voxels = (size_t)image->size[0] * (size_t)image->size[1] * (size_t)image->size[2];
    for (size_t v = 0; v < voxels; v++) {
        fputc(image->label[v] & 255, file);
        fputc(image->label[v] >> 8, file);
    }
    assert_int_equal(fclose(file), 0);
}

#endif
