/* How well a mesh stands for a true surface, and how good its elements are. */
#ifndef LAR_MESHING_DEVIATION_H
#define LAR_MESHING_DEVIATION_H

#include "meshing/boundary/boundary.h"
#include "model/mesh/mesh.h"

/* Distances between two surfaces [m]. */
typedef struct lar_deviation {
    double mean;      /* over both directions, weighted by area */
    double max_95;    /* 95 % of the area is nearer */
    double hausdorff; /* the largest */
} lar_deviation;

/* Between `count` faces of a mesh (element * 6 + face; quadrilaterals are bilinear, sampled finely)
 * and a surface, both ways. */
lar_status lar_deviation_measure(const lar_mesh *mesh, const int32_t *face, int32_t count,
                                 const lar_triangles *surface, lar_deviation *deviation,
                                 lar_error *error);

/* Elements by their scaled Jacobian in ten bins of 0.1 (below 0 counts in the first), the least,
 * the mean, and the parts above 0.2 and 0.5. */
typedef struct lar_jacobians {
    int32_t bin[10];
    double min, mean, above_02, above_05;
    int32_t worst; /* element index */
} lar_jacobians;
void lar_jacobians_count(const lar_mesh *mesh, lar_jacobians *jacobians);

#endif
