/* Finds the faces near a face: a tree over their boxes. */
#ifndef LAR_MESHING_FIT_FACE_BOXES_H
#define LAR_MESHING_FIT_FACE_BOXES_H

#include "model/triangles/tree.h"

typedef struct lar_face_boxes {
    lar_triangles ends; /* of face f: a triangle that is but the diagonal of its box */
    lar_triangle_tree *tree;
} lar_face_boxes;

/* Into a zeroed one: the boxes of `count` faces, by their nodes, as the places are now. */
lar_status lar_face_boxes_create(const double (*x)[3], const int32_t (*face)[4], int32_t count,
                                 lar_face_boxes *boxes, lar_error *error);
void lar_face_boxes_clear(lar_face_boxes *boxes);

/* Calls `visit` for every face whose box, widened by `margin`, meets that of `face`, itself too;
 * false from `visit` ends it. Any thread. */
void lar_face_boxes_near(const lar_face_boxes *boxes, int32_t face, double margin,
                         lar_triangle_visit *visit, void *context);

#endif
