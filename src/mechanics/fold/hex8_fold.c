#include "mechanics/fold/hex8_fold.h"

#include <math.h>

#include "base/vector.h"
#include "law/kinematics.h"
#include "model/mesh/mesh.h"

/* Bulk over shear modulus: below it nothing folds, above it more and more. */
static const double FROM = 20;
/* Of its volume is free, before anything happens. */
static const double FREE = 1e-3;

/* Squares of the mean edges along xi, eta, zeta, times 16. */
static void edge_squares(const double corner[8][3], double square[3]) {
    for (int axis = 0; axis < 3; axis++) {
        double edge[3] = {0};
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) edge[i] += lar_node_sign[a][axis] * corner[a][i];
        square[axis] = lar_dot(edge, edge);
    }
}

static int shortest_of(const double square[3]) {
    int axis = square[1] < square[0] ? 1 : 0;
    return square[2] < square[axis] ? 2 : axis;
}

bool lar_hex8_is_flat(const double corner[8][3]) {
    static const double FLAT = 1.8; /* longest over shortest */
    double square[3];
    edge_squares(corner, square);
    return fmax(square[0], fmax(square[1], square[2])) > FLAT * FLAT * square[shortest_of(square)];
}

bool lar_hex8_may_fold(const lar_material *material) {
    return lar_material_bulk(material) > FROM * lar_material_shear(material);
}

void lar_hex8_fold_prepare(const double corner[8][3], const double gradient[3][3],
                           const lar_material *material, lar_hex8_fold *fold) {
    double square[3];
    edge_squares(corner, square);
    const int axis = shortest_of(square);
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
