#include "mechanics/viscous/change.h"

#include <math.h>
#include <string.h>

/* Symmetric tensors have six values, xx xy xz yy yz zz. */
static const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

static double product(const double a[6], const double b[6]) {
    double twice = a[1] * b[1] + a[2] * b[2] + a[4] * b[4];
    return a[0] * b[0] + a[3] * b[3] + a[5] * b[5] + 2 * twice;
}

typedef struct law_of {
    lar_material material;
    const double *fibre;
    double shear, bulk;
} law_of;

static void take_law(const lar_material *material, const double *fibre, law_of *law) {
    const lar_law_row *row = &lar_law_table[material->law];
    *law =
        (law_of){*material, fibre, row->shear(material->parameter), row->bulk(material->parameter)};
}

/* Se where F^T F = C, of which nothing else counts: F is Cholesky's factor. False: there is none.
 */
static bool stress_at(const law_of *law, const double C[6], double S[6]) {
    double F[3][3] = {{0}};
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double rest = C[place[i][j]];
            for (int k = 0; k < i; k++) rest -= F[k][i] * F[k][j];
            if (i == j && !(rest > 0)) return false;
            F[i][j] = i == j ? sqrt(rest) : rest / F[i][i];
        }
    lar_relaxing_stress(&law->material, law->fibre, (const double(*)[3])F, S);
    return isfinite(product(S, S));
}

/* Where the dampers of a term are, as far as it is known. */
typedef struct dampers {
    double C[6], stress[6];
    double left[6];   /* of H */
    double strain[6]; /* of that, about */
    double square;    /* left : strain, not below zero */
} dampers;

/* What is left of H where these dampers are, of the law's stress S. */
static void look(const law_of *law, const double S[6], const double H[6], dampers *at) {
    const double *C = at->C, *r = at->left;
    double soft = 0.5 / law->shear, wide = law->material.viscosity.isochoric ? 0 : 1 / law->bulk;
    for (int k = 0; k < 6; k++) at->left[k] = H[k] - (S[k] - at->stress[k]);
    double trace = product(r, C) / 3, half[3][3], more = (wide / 3 - soft) * trace;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            half[i][j] = r[place[i][0]] * C[place[0][j]] + r[place[i][1]] * C[place[1][j]] +
                         r[place[i][2]] * C[place[2][j]];
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double both = C[place[i][0]] * half[0][j] + C[place[i][1]] * half[1][j] +
                          C[place[i][2]] * half[2][j];
            at->strain[place[i][j]] = soft * both + more * C[place[i][j]];
        }
    at->square = product(r, at->strain);
}

static double determinant(const double a[6]) {
    return a[0] * (a[3] * a[5] - a[4] * a[4]) - a[1] * (a[1] * a[5] - a[4] * a[2]) +
           a[2] * (a[1] * a[4] - a[3] * a[2]);
}

/* By `length` times the strain. Where the isochoric part relaxes dampers have the element's volume,
 * of which `square` is the square: nearly, and the better the shorter the way is. False: the law
 * does not say what is there. */
static bool go(const law_of *law, const dampers *from, double length, double square, dampers *to) {
    for (int k = 0; k < 6; k++) to->C[k] = from->C[k] - 2 * length * from->strain[k];
    double more = law->material.viscosity.isochoric ? square / determinant(to->C) - 1 : 0;
    for (int k = 0; k < 6; k++) to->C[k] += more / 3 * to->C[k];
    return stress_at(law, to->C, to->stress);
}

/* The best of what is found. The law has the stress S at the strain C. */
static void find(const law_of *law, const double C[6], const double S[6], const double H[6],
                 dampers *best) {
    enum { TRIES = 30, IN_VAIN = 6 };
    static const double LONG = 0.1, SMALL = 1e-21; /* a strain, the square of one */
    memcpy(best->C, C, sizeof best->C);
    memcpy(best->stress, S, sizeof best->stress);
    look(law, S, H, best);
    dampers at = *best;
    double enough = SMALL * (law->shear + at.square), length = 1;
    double volume = determinant(C), far = LONG * (C[0] + C[3] + C[5]) / 3;
    for (int i = 0, last = 0; i < TRIES && i - last < IN_VAIN && best->square > enough; i++) {
        dampers next;
        length = fmin(length, far / sqrt(product(at.strain, at.strain)));
        if (!go(law, &at, length, volume, &next)) return;
        look(law, S, H, &next);
        double less = at.square - product(next.left, at.strain);
        if (less > 0) length *= at.square / less;
        at = next;
        if (!(at.square < best->square)) continue;
        *best = at;
        last = i;
    }
}

/* What the spring of a term holds, by Simpson's rule. */
static double held(const law_of *law, const double C[6], const double S[6], const dampers *at,
                   const double stress[6]) {
    double middle[6], there[6];
    for (int k = 0; k < 6; k++) middle[k] = 0.5 * (C[k] + at->C[k]);
    if (!stress_at(law, middle, there)) return 0;
    for (int k = 0; k < 6; k++) {
        there[k] = (S[k] - stress[k] + 4 * (there[k] - stress[k])) / 6;
        middle[k] = 0.5 * (C[k] - at->C[k]);
    }
    return product(there, middle);
}

void lar_viscous_change(const lar_material *before, const lar_material *after, const double *fibre,
                        double *history) {
    const lar_viscosity *v = &before->viscosity;
    double C[6], S[6], changed[6], there[6];
    law_of law, other;
    take_law(before, fibre, &law);
    take_law(after, fibre, &other);
    for (int k = 0; k < 6; k++)
        C[k] = history[LAR_HISTORY_STRAIN + k] + (k == 0 || k == 3 || k == 5 ? 1 : 0);
    if (!stress_at(&law, C, S) || !stress_at(&other, C, changed)) return;
    for (int k = 0; k < 6; k++) history[LAR_HISTORY_STRESS + k] += changed[k] - S[k];
    for (int i = 0; i < v->terms; i++) {
        double *H = history + LAR_HISTORY_TERMS + 6 * i, times = other.shear / law.shear;
        dampers at;
        find(&law, C, S, H, &at);
        if (!stress_at(&other, at.C, there)) continue;
        history[LAR_HISTORY_WORK] +=
            v->share[i] * (held(&other, C, changed, &at, there) - held(&law, C, S, &at, at.stress));
        for (int k = 0; k < 6; k++) H[k] = changed[k] - there[k] + times * at.left[k];
    }
}
