#include "meshing/grid/unfitted_cuts.h"

#include <math.h>
#include <stdlib.h>

#include "base/vector.h"

/* A face that stands square to a triangle's normal is as wrong for it as one that is a cell away.
 */
static const double TURN_WEIGHT = 1;
/* A cut further from a face than this has no part in it [cells]. */
static const double REACH = 1.5;

static int front_of(const uint16_t side[2]) {
    for (int s = 0; s < 2; s++) {
        if (side[s] == 0) return 0;
        if (side[s] >= LAR_REGION_CUT && side[s] < LAR_REGION_CUT + LAR_CUTS)
            return 1 + side[s] - LAR_REGION_CUT;
    }
    return -1;
}

/* Normals out of the body: the front of a triangle may be its back by the order of its sides. */
static void set_normals(const lar_boundary *boundary, double (*normal)[3]) {
    const lar_triangles *triangles = &boundary->triangles;
    for (int32_t t = 0; t < triangles->triangle_count; t++) {
        lar_triangles_normal(triangles, t, normal[t]);
        const double length = lar_length(normal[t]);
        const double sign = lar_boundary_region(boundary->side[t][0]) == 0 ? 1 : -1;
        for (int d = 0; d < 3; d++) normal[t][d] *= length > 0 ? sign / length : 0;
    }
}

lar_status lar_unfitted_cuts_create(const lar_boundary *boundary, lar_unfitted_cuts *cuts,
                                    lar_error *error) {
    cuts->boundary = boundary;
    if (boundary->cut_count == 0) return LAR_OK;
    const int32_t count = boundary->triangles.triangle_count;
    cuts->normal = lar_calloc((size_t)count, sizeof *cuts->normal);
    int32_t *index = lar_calloc((size_t)count, sizeof *index);
    lar_status status = LAR_OK;
    if (!cuts->normal || !index)
        status = lar_fail_memory(error, (size_t)count * 28, "the flat cuts");
    else
        set_normals(boundary, cuts->normal);
    for (int f = 0; !status && f < 1 + LAR_CUTS; f++) {
        int32_t found = 0;
        for (int32_t t = 0; t < count; t++)
            if (front_of(boundary->side[t]) == f) index[found++] = t;
        if (found > 0)
            status =
                lar_triangle_tree_create(&boundary->triangles, index, found, &cuts->tree[f], error);
    }
    free(index);
    return status;
}

void lar_unfitted_cuts_clear(lar_unfitted_cuts *cuts) {
    for (int f = 0; f < 1 + LAR_CUTS; f++) lar_triangle_tree_destroy(cuts->tree[f]);
    free(cuts->normal);
    *cuts = (lar_unfitted_cuts){0};
}

/* Whether a cut's plane comes near a point: most faces are far from all. */
static bool any_cut_near(const lar_unfitted_cuts *cuts, const double point[3], double reach) {
    for (int c = 0; c < LAR_CUTS; c++) {
        const lar_cut *cut = &cuts->boundary->cut[c];
        if (!cuts->tree[1 + c]) continue;
        double away[3];
        lar_minus(point, cut->through, away);
        if (fabs(lar_dot(away, cut->normal)) <= reach) return true;
    }
    return false;
}

uint16_t lar_unfitted_cuts_front(const lar_unfitted_cuts *cuts, const lar_voxel_grid *voxel_grid,
                                 const int cell[3], int face) {
    if (cuts->boundary->cut_count == 0) return 0;
    const double *normal = voxel_grid->axis[face / 2], sign = face % 2 ? 1 : -1;
    double centre[3];
    for (int d = 0; d < 3; d++) {
        centre[d] = voxel_grid->origin[d] + 0.5 * sign * voxel_grid->size * normal[d];
        for (int a = 0; a < 3; a++)
            centre[d] += (cell[a] + 0.5) * voxel_grid->size * voxel_grid->axis[a][d];
    }
    if (!any_cut_near(cuts, centre, REACH * voxel_grid->size)) return 0;

    int front = 0;
    double min = INFINITY;
    for (int f = 0; f < 1 + LAR_CUTS; f++) {
        lar_nearest nearest;
        if (!cuts->tree[f] || !lar_triangle_tree_nearest(cuts->tree[f], centre,
                                                         2 * REACH * voxel_grid->size, &nearest))
            continue;
        const double along = sign * lar_dot(normal, cuts->normal[nearest.triangle]);
        const double cost = nearest.distance / voxel_grid->size + TURN_WEIGHT * (1 - along);
        if (cost < min) {
            min = cost;
            front = f;
        }
    }
    return (uint16_t)(front == 0 ? 0 : LAR_REGION_CUT + front - 1);
}
