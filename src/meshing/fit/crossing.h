/* Which faces of a mesh's surface go through each other.
 *
 *      3-------2      The four corners of a face need not lie in one plane, and nothing says which
 *      | \   / |      diagonal it folds along: contact, viewers and other programs each choose one.
 *      |   X   |      So two faces are apart only when the four triangles of the one, two for each
 *      | /   \ |      diagonal, are apart from the four of the other.
 *      0-------1
 *
 * Where all elements are good and no two outer faces cross, no two elements lie in each other. */
#ifndef LAR_MESHING_FIT_CROSSING_H
#define LAR_MESHING_FIT_CROSSING_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "meshing/fit/face_boxes.h"

typedef struct lar_face_crossings {
    int32_t pairs;  /* of faces */
    double deepest; /* how far a triangle must be moved to be free of the other, as the places */
} lar_face_crossings;

/* How deep two faces, by their nodes, go through each other; 0 when they are apart. Triangles with
 * two common nodes are neighbours and never cross. Faces that share no node must be more than `gap`
 * apart (0 or more, in units of the places `x`); when they are nearer the answer is above 0. */
double lar_faces_cross(const double (*x)[3], const int32_t a[4], const int32_t b[4], double gap);

/* How far their nodes may move, the farthest of the one and the farthest of the other in sum, while
 * the faces stay apart whatever else they do; 0: nothing is known of them, they may cross. */
double lar_faces_clearance(const double (*x)[3], const int32_t a[4], const int32_t b[4],
                           double gap);

/* All pairs of `count` faces. boxes: of these faces at these places; NULL: the caller has none.
 * `crosses` [count], by the caller, is set for each face that crosses another one; NULL: not
 * wanted. */
lar_status lar_faces_find_crossings(const double (*x)[3], const int32_t (*face)[4], int32_t count,
                                    double gap, const lar_face_boxes *boxes, bool *crosses,
                                    lar_face_crossings *found, lar_error *error);

#endif
