#include "validation/beam.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const beam_mesh beam_meshes[3] = {{"20x2x2", 20, 2}, {"40x4x4", 40, 4}, {"80x8x8", 80, 8}};

lar_model *beam_model(const beam_mesh *mesh, int poisson) {
    char name[64];
    snprintf(name, sizeof name, "c_beam_%s", mesh->name);
    double shear = poisson == 45 ? 1034.482759 : 1006.711409;
    double bulk = poisson == 45 ? 10000 : 50000;
    lar_model *model = reference_model(name, 1, shear, bulk, 1000);
    fix_nodes(model, nodes_at(model, 0, 0), LAR_AXIS_ALL);
    model->damping = BEAM_DAMPING;
    model->gravity[2] = -9.81;
    model->gravity_curve[2] = add_ramp(model, 0, 1, 0, 0);
    return model;
}

int32_t beam_tip(const lar_model *model) {
    return node_near(model, 0.1, 0.005, 0.005);
}

/* Nodes are numbered x fastest, then y, then z. */
static int node_at(const beam_mesh *mesh, int i, int j, int k) {
    return i + (mesh->along + 1) * (j + (mesh->across + 1) * k);
}

/* Where a fine index lies in the coarse direction: cell and share of its far end. */
static int locate(int fine_index, int fine_cells, int coarse_cells, double *share) {
    double at = (double)fine_index * coarse_cells / fine_cells;
    int cell = (int)fmin(floor(at), coarse_cells - 1);
    *share = at - cell;
    return cell;
}

static void interpolate(const beam_mesh *coarse, double (*from)[3], const int cell[3],
                        const double share[3], double out[3]) {
    memset(out, 0, 3 * sizeof *out);
    for (int a = 0; a < 8; a++) {
        int far[3] = {a & 1, a >> 1 & 1, a >> 2};
        double weight = 1;
        for (int i = 0; i < 3; i++) weight *= far[i] ? share[i] : 1 - share[i];
        const double *u =
            from[node_at(coarse, cell[0] + far[0], cell[1] + far[1], cell[2] + far[2])];
        for (int i = 0; i < 3; i++) out[i] += weight * u[i];
    }
}

void beam_refine(const beam_mesh *coarse, double (*from)[3], const beam_mesh *fine,
                 double (*to)[3]) {
    for (int k = 0; k <= fine->across; k++)
        for (int j = 0; j <= fine->across; j++)
            for (int i = 0; i <= fine->along; i++) {
                double share[3];
                int cell[3] = {locate(i, fine->along, coarse->along, &share[0]),
                               locate(j, fine->across, coarse->across, &share[1]),
                               locate(k, fine->across, coarse->across, &share[2])};
                interpolate(coarse, from, cell, share, to[node_at(fine, i, j, k)]);
            }
}
