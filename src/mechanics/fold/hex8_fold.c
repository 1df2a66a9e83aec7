#include "mechanics/fold/hex8_fold.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "law/kinematics.h"
#include "model/mesh/mesh.h"

/* Bulk over shear modulus: below it nothing folds, above it more and more. */
static const double FROM = 20;
/* Of its volume is free, before anything happens. */
static const double FREE = 1e-3;

/* Mean edges along xi, eta, zeta, times 4. */
static void mean_edges(const double corner[8][3], double edge[3][3]) {
    memset(edge, 0, 3 * sizeof edge[0]);
    for (int axis = 0; axis < 3; axis++)
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) edge[axis][i] += lar_node_sign[a][axis] * corner[a][i];
}

/* Of two that are as long the one that lies so in space, however corners are counted: what kernels
 * and energies take must be the same. */
static bool is_shorter(const double a[3], const double b[3]) {
    static const double EQUAL = 1e-6;
    const double square = lar_dot(a, a), other = lar_dot(b, b), noise = EQUAL * square;
    const double of_a[5] = {a[0] * a[0], a[1] * a[1], a[0] * a[1], a[0] * a[2], a[1] * a[2]};
    const double of_b[5] = {b[0] * b[0], b[1] * b[1], b[0] * b[1], b[0] * b[2], b[1] * b[2]};
    if (fabs(square - other) > noise) return square < other;
    for (int k = 0; k < 5; k++)
        if (fabs(of_a[k] - of_b[k]) > noise) return of_a[k] > of_b[k];
    return false;
}

static int shortest_of(const double edge[3][3]) {
    int axis = is_shorter(edge[1], edge[0]) ? 1 : 0;
    return is_shorter(edge[2], edge[axis]) ? 2 : axis;
}

bool lar_hex8_is_flat(const double corner[8][3]) {
    static const double FLAT =
        1.79993; /* longest over shortest; no number that meshes are made by */
    double edge[3][3], least = INFINITY, most = 0;
    mean_edges(corner, edge);
    for (int axis = 0; axis < 3; axis++) {
        least = fmin(least, lar_dot(edge[axis], edge[axis]));
        most = fmax(most, lar_dot(edge[axis], edge[axis]));
    }
    return most > FLAT * FLAT * least;
}

bool lar_hex8_may_fold(const lar_material *material) {
    return lar_material_bulk(material) > FROM * lar_material_shear(material);
}

void lar_hex8_fold_prepare(const double corner[8][3], const double gradient[3][3],
                           const lar_material *material, lar_hex8_fold *fold) {
    double edge[3][3];
    mean_edges(corner, edge);
    const int axis = shortest_of((const double(*)[3])edge);
    for (int i = 0; i < 3; i++) {
        fold->axis[i] = sqrt(LAR_HOURGLASS_FACTOR / 2) * gradient[axis][i];
        fold->weight[i] = i != axis; /* mode 3 + i is the product of the two others */
    }
    fold->weight[3] = sqrt(1.0 / 3);
    fold->bulk = 0.5 * (lar_material_bulk(material) - FROM * lar_material_shear(material));
    fold->from = 1 - FREE;
}

double lar_hex8_fold_force(const double corner[8][3], const lar_material *material,
                           const double u[8][3], double force[8][3]) {
    if (!lar_hex8_may_fold(material) || !lar_hex8_is_flat(corner)) return 0;
    lar_hex8 element;
    lar_hex8_fold fold;
    double F[3][3], cof[9], q[LAR_HEX8_HOURGLASS][3], b[3], v[3] = {0}, P[3][3], added[8][3];
    lar_hex8_prepare(corner, material, &element);
    lar_hex8_fold_prepare(corner, (const double(*)[3])element.gradient, material, &fold);
    lar_hex8_modes(&element, u, F, q);
    double strained[LAR_HEX8_HOURGLASS], Q = 0;
    for (int i = 0; i < 3; i++) b[i] = lar_dot(F[i], fold.axis);
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        strained[m] = fold.weight[m] * lar_dot(q[m], b);
        Q += 0.5 * strained[m] * strained[m];
        for (int i = 0; i < 3; i++) v[i] += fold.weight[m] * strained[m] * q[m][i];
    }
    const double t = fold.from - lar_lane_cofactor((const double *)F, cof);
    const double before = fmax(t, 0), now = fmax(t + Q, 0);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            P[i][j] = fold.bulk * (now * v[i] * fold.axis[j] - (now - before) * cof[3 * i + j]);
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
        for (int i = 0; i < 3; i++)
            q[m][i] = element.volume * fold.bulk * now * fold.weight[m] * strained[m] * b[i];
    lar_hex8_nodal(&element, (const double(*)[3])P, (const double(*)[3])q, added);
    for (int a = 0; a < 8 && force; a++)
        for (int i = 0; i < 3; i++) force[a][i] += added[a][i];
    return 0.5 * fold.bulk * element.volume * (now * now - before * before);
}
