#include "meshing/fit/face_boxes.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

lar_status lar_face_boxes_create(const double (*x)[3], const int32_t (*face)[4], int32_t count,
                                 lar_face_boxes *boxes, lar_error *error) {
    const size_t faces = (size_t)count;
    lar_triangles *ends = &boxes->ends;
    if (count > INT32_MAX / 2)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED, "%d faces are too many to be compared",
                        count);
    ends->vertex = lar_calloc(2 * faces, sizeof *ends->vertex);
    ends->corner = lar_calloc(faces, sizeof *ends->corner);
    if (!ends->vertex || !ends->corner) {
        lar_face_boxes_clear(boxes);
        return lar_fail_memory(error, 60 * faces, "the boxes of faces");
    }
    ends->vertex_count = 2 * count;
    ends->triangle_count = count;
    for (int32_t f = 0; f < count; f++) {
        double *lower = ends->vertex[2 * f], *upper = ends->vertex[2 * f + 1];
        memcpy(lower, x[face[f][0]], 3 * sizeof *lower);
        memcpy(upper, x[face[f][0]], 3 * sizeof *upper);
        for (int a = 1; a < 4; a++)
            for (int i = 0; i < 3; i++) {
                lower[i] = fmin(lower[i], x[face[f][a]][i]);
                upper[i] = fmax(upper[i], x[face[f][a]][i]);
            }
        const int32_t corner[3] = {2 * f, 2 * f + 1, 2 * f + 1};
        memcpy(ends->corner[f], corner, sizeof corner);
    }
    return lar_triangle_tree_create(ends, NULL, count, &boxes->tree, error);
}

void lar_face_boxes_clear(lar_face_boxes *boxes) {
    lar_triangle_tree_destroy(boxes->tree);
    lar_triangles_clear(&boxes->ends);
    *boxes = (lar_face_boxes){0};
}

void lar_face_boxes_near(const lar_face_boxes *boxes, int32_t face, double margin,
                         lar_triangle_visit *visit, void *context) {
    lar_triangle_tree_boxes(boxes->tree, boxes->ends.vertex[2 * face],
                            boxes->ends.vertex[2 * face + 1], margin, visit, context);
}
