#include "step/mass/compressible.h"

#include <math.h>

#include "base/vector.h"
#include "law/law.h"

/* |F^-1|^2 and |cof F|^2 up to which no such element is 1.4 times as fast as at rest. */
static const double LISTED_FROM = 3.15;

bool lar_material_compressible(const lar_material *material) {
    return lar_material_instant_bulk(material) < 4 * lar_material_instant_shear(material);
}

double lar_compressible_limit(double area_limit) {
    bool flat = area_limit < LAR_STRAINED_AREA;
    return -(flat ? lar_lesser(area_limit, 0.99 * LISTED_FROM) : LISTED_FROM);
}

static bool is_flat(double limit) {
    return -limit < LISTED_FROM;
}

/* The largest root of x^3 - a x^2 + b x - c, all of which are real, from above: Newton's steps go
 * down to it. */
static double largest_root(double a, double b, double c, double x) {
    for (int i = 0; i < 40; i++) {
        double value = ((x - a) * x + b) * x - c, slope = (3 * x - 2 * a) * x + b;
        if (!(value > 0) || !(slope > 0)) break;
        double step = value / slope;
        x -= step;
        if (!(step > 1e-9 * x)) break;
    }
    return x;
}

/* The squares of the principal stretches, by their invariants. */
static void principal_squares(const float strain[LAR_STRAIN_NUMBERS], double square[3]) {
    double I1 = strain[LAR_STRAIN_LENGTH], J = strain[LAR_STRAIN_VOLUME];
    square[0] = largest_root(I1, strain[LAR_STRAIN_AREA], J * J, I1);
    double half = 0.5 * (I1 - square[0]), product = J * J / square[0];
    double apart = sqrt(lar_greater(0, half * half - product));
    square[1] = half + apart;
    square[2] = product / square[1];
}

/* The tangent of a law, dP/dF, for gradients F along the principal axes. */
typedef struct principal {
    double along[3][3]; /* of F_bb on P_aa */
    double shear[3];    /* without axis a: of what is along one of the other two across the other */
    double turn[3];     /* on itself, and on what is the other way round */
} principal;

static void by_invariants(const lar_law_slopes *w, double I1, const double F[3], principal *A) {
    const double *l = F;
    double C[3], s[3]; /* cofactors, and the slope of I2 */
    for (int a = 0; a < 3; a++) {
        C[a] = l[(a + 1) % 3] * l[(a + 2) % 3];
        s[a] = 2 * l[a] * (I1 - l[a] * l[a]);
    }
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        double own = 4 * w->w1J * l[a] + 2 * w->w2J * s[a] + w->wJJ * C[a];
        A->along[a][a] =
            2 * w->w1 + 2 * w->w2 * (I1 - l[a] * l[a]) + 4 * w->w11 * l[a] * l[a] + own * C[a];
        A->along[a][b] = A->along[b][a] =
            4 * (w->w11 + w->w2) * l[a] * l[b] + w->wJ * l[c] + w->wJJ * C[a] * C[b] +
            2 * w->w1J * (l[a] * C[b] + l[b] * C[a]) + w->w2J * (s[a] * C[b] + s[b] * C[a]);
        A->shear[c] = 2 * w->w1 + 2 * w->w2 * l[c] * l[c];
        A->turn[c] = -2 * w->w2 * l[a] * l[b] - w->wJ * l[c];
    }
}

static void by_tangent(const lar_law_row *law, const double *p, const double l[3], principal *A) {
    double F[9] = {l[0], 0, 0, 0, l[1], 0, 0, 0, l[2]}, whole[9][9];
    law->tangent(p, F, whole);
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        for (int k = 0; k < 3; k++) A->along[a][k] = whole[4 * a][4 * k];
        A->shear[c] = whole[3 * a + b][3 * a + b];
        A->turn[c] = whole[3 * a + b][3 * b + a];
    }
}

/* Adds what the law's volume term alone has of it, `more` times. */
static void add_volume(const lar_law_strained *volume, double more, const double l[3],
                       principal *A) {
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        double C = l[b] * l[c], pressed = more * volume->pressure * l[c];
        double both = more * volume->slope * C * l[c] * l[a] + pressed;
        A->along[a][a] += more * volume->slope * C * C;
        A->along[a][b] += both;
        A->along[b][a] += both;
        A->turn[c] -= pressed;
    }
}

/* The tangent times what the terms of viscosity have of it at once. */
static void find_tangent(const lar_material *material, const double square[3],
                         const float strain[LAR_STRAIN_NUMBERS], principal *A) {
    const lar_law_row *law = &lar_law_table[material->law];
    double shear = lar_viscosity_instant(&material->viscosity);
    double volume = lar_viscosity_volume_instant(&material->viscosity);
    lar_law_invariants is = {.I1 = strain[LAR_STRAIN_LENGTH],
                             .I2 = strain[LAR_STRAIN_AREA],
                             .J = strain[LAR_STRAIN_VOLUME]};
    const double l[3] = {sqrt(square[0]), sqrt(square[1]), sqrt(square[2])};
    if (law->slopes) {
        lar_law_slopes w = law->slopes(material->parameter, &is);
        by_invariants(&w, is.I1, l, A);
    } else {
        by_tangent(law, material->parameter, l, A);
    }
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) A->along[a][b] *= shear;
        A->shear[a] *= shear;
        A->turn[a] *= shear;
    }
    if (volume == shear) return;
    lar_law_strained now = law->strained(material->parameter, is.J, is.I1, is.I2);
    add_volume(&now, volume - shear, l, A);
}

/* The largest eigenvalue of what goes along the principal axes. */
static double largest_along(const double A[3][3]) {
    double x = A[0][0], y = A[1][1], z = A[2][2], xy = A[0][1], yz = A[1][2], zx = A[2][0];
    double most = lar_greater(lar_greater(x + fabs(xy) + fabs(zx), y + fabs(xy) + fabs(yz)),
                              z + fabs(yz) + fabs(zx));
    double minors = x * y - xy * xy + y * z - yz * yz + z * x - zx * zx;
    double det = x * (y * z - yz * yz) - xy * (xy * z - yz * zx) + zx * (xy * yz - y * zx);
    return largest_root(x + y + z, minors, det, most);
}

double lar_compressible_growth(const lar_material *material, double limit,
                               const float strain[LAR_STRAIN_NUMBERS]) {
    double square[3], bulk = lar_material_instant_bulk(material);
    double shear = lar_material_instant_shear(material);
    principal A;
    if (!(strain[LAR_STRAIN_VOLUME] > 0)) return 0;
    principal_squares(strain, square);
    find_tangent(material, square, strain, &A);
    if (is_flat(limit))
        return lar_greater(lar_greater(A.along[0][0], A.along[1][1]), A.along[2][2]) /
               (bulk + 4 * shear / 3);
    double most = largest_along((const double(*)[3])A.along);
    for (int a = 0; a < 3; a++) most = lar_greater(most, A.shear[a] + fabs(A.turn[a]));
    return most / lar_greater(3 * bulk, 2 * shear);
}
