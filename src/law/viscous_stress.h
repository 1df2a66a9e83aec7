/* The stress of a viscous material in one step, for a lane (base/simd.h). law/viscosity.h has the
 * model. Simo's integration (1987, "On a fully three-dimensional finite-strain viscoelastic damage
 * model", eq. 5.3; FEBio's too), exact where Se changes at a constant rate within the step:
 *
 *     Hi(n+1) = e Hi(n) + h (Se(n+1) - Se(n)),   x = dt / t_i,   e = exp(-x),   h = (1 - e) / x
 *
 * The isochoric part of the law's stress is that of the deviator of Cauchy's stress,
 *
 *     Se = F^-1 (P - (P : F) / (3 J) cof F).
 *
 * What the terms take is their stress times the change of strain, by the trapezoidal rule:
 * work += 1/2 sum_i g_i (Hi(n) + Hi(n+1)) : (E(n+1) - E(n)).
 */
#ifndef LAR_LAW_VISCOUS_STRESS_H
#define LAR_LAW_VISCOUS_STRESS_H

#include "law/kinematics.h"
#include "law/lane_math.h"
#include "law/viscosity.h"

/* Coefficients of a lane; `unit` is by how much P is larger than pascal of the material as the
 * model has it, `inverse` its reciprocal; both 0 without an element. */
typedef struct lar_viscous_lane {
    lar_lane rest, share[LAR_VISCOUS_TERMS], unit, inverse;
    lar_lane less[LAR_VISCOUS_TERMS], rise[LAR_VISCOUS_TERMS]; /* e - 1 and h: lar_viscous_fade */
} lar_viscous_lane;

/* a^T b over J, as six values: a = cof F and b = P make F^-1 P. */
LAR_INLINE void lar_lane_pull(const lar_lane a[9], const lar_lane b[9], lar_lane factor,
                              lar_lane out[6]) {
    for (int i = 0, n = 0; i < 3; i++)
        for (int j = i; j < 3; j++, n++)
            out[n] = factor * lar_lane_fma(a[6 + i], b[6 + j],
                                           lar_lane_fma(a[3 + i], b[3 + j], a[i] * b[j]));
}

/* What a term does in a step, of its rate 1/t_i. */
LAR_INLINE void lar_viscous_fade(lar_lane dt, lar_lane rate, lar_lane *less, lar_lane *rise) {
    lar_lane x = lar_lane_max(dt * rate, lar_lane_set(LAR_LANE_TINY));
    *less = lar_lane_expm1(-x);
    *rise = -*less / x;
}

/* Takes value k of all terms on; returns what they are together, and had been in *then. */
LAR_INLINE lar_lane lar_viscous_relax(const lar_viscous_lane *c, int terms, int k, lar_lane change,
                                      const double *before, double *after, int stride,
                                      lar_lane *then) {
    lar_lane now = lar_lane_set(0);
    *then = now;
    for (int i = 0; i < terms; i++) {
        int at = stride * (LAR_HISTORY_TERMS + 6 * i + k);
        lar_lane H = lar_lane_load(before + at);
        *then = lar_lane_fma(c->share[i], H, *then);
        H = lar_lane_fma(c->rise[i], change, lar_lane_fma(c->less[i], H, H));
        now = lar_lane_fma(c->share[i], H, now);
        lar_lane_store(after + at, H);
    }
    return now;
}

/* What a step changes, of all six values together. */
typedef struct lar_viscous_sum {
    lar_lane work, size;
    lar_lane over[6]; /* S - Se, in the units of P */
} lar_viscous_sum;

/* Value k of a lane, whose strain C - 1 and stress Se are these now. */
LAR_INLINE void lar_viscous_value(const lar_viscous_lane *c, int terms, int k, double twice,
                                  lar_lane strain, lar_lane stress, const double *before,
                                  double *after, int stride, lar_viscous_sum *sum) {
    int strained = stride * (LAR_HISTORY_STRAIN + k), stressed = stride * (LAR_HISTORY_STRESS + k);
    lar_lane change = stress - lar_lane_load(before + stressed), then;
    lar_lane now = lar_viscous_relax(c, terms, k, change, before, after, stride, &then);
    lar_lane step = lar_lane_set(0.25 * twice) * (strain - lar_lane_load(before + strained));
    sum->work = lar_lane_fma(then + now, step, sum->work);
    lar_lane_store(after + stressed, stress);
    lar_lane_store(after + strained, strain);
    sum->over[k] = c->unit * lar_lane_fma(c->rest - lar_lane_set(1), stress, now);
    sum->size = lar_lane_fma(lar_lane_set(twice) * sum->over[k], sum->over[k], sum->size);
}

/* P of the law becomes P of the material. What is remembered stands in `before` and goes on in
 * `after`, which may be the same: value k of some lanes at k times `stride`. Returns a number not
 * below |S - Se|^2 |F|^2 in order of magnitude, in the units of P. */
LAR_INLINE lar_lane lar_viscous_stress(const lar_lane F[9], const lar_viscous_lane *c, int terms,
                                       bool isochoric, const double *before, double *after,
                                       int stride, lar_lane P[9]) {
    static const int symmetric[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    static const double twice[6] = {1, 2, 2, 1, 2, 1}; /* of a product of tensors */
    lar_lane cof[9], part[9], strain[6], stress[6], mean = lar_lane_set(0);
    lar_lane J = lar_lane_cofactor(F, cof), reciprocal = lar_lane_set(1) / J;
    lar_viscous_sum sum = {.work = mean, .size = mean};
    for (int k = 0; isochoric && k < 9; k++) mean = lar_lane_fma(P[k], F[k], mean);
    mean = mean * reciprocal * lar_lane_set(1.0 / 3);
    for (int k = 0; k < 9; k++) part[k] = isochoric ? lar_lane_fnma(mean, cof[k], P[k]) : P[k];
    lar_lane_pull(cof, part, c->inverse * reciprocal, stress);
    lar_lane_pull(F, F, lar_lane_set(1), strain);
    for (int k = 0; k < 6; k++)
        if (twice[k] == 1) strain[k] = strain[k] - lar_lane_set(1);
    if (__builtin_constant_p(terms))
        for (int k = 0; k < 6; k++)
            lar_viscous_value(c, terms, k, twice[k], strain[k], stress[k], before, after, stride,
                              &sum);
    else /* shorter: 2 kB for each instruction set, and 5 % more instructions */
#pragma GCC unroll 1
        for (int k = 0; k < 6; k++)
            lar_viscous_value(c, terms, k, twice[k], strain[k], stress[k], before, after, stride,
                              &sum);
    sum.work = lar_lane_load(before + stride * LAR_HISTORY_WORK) + sum.work;
    lar_lane_store(after + stride * LAR_HISTORY_WORK, sum.work);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                P[3 * i + j] = lar_lane_fma(F[3 * i + k], sum.over[symmetric[k][j]], P[3 * i + j]);
    return sum.size * lar_lane_square_sum(F);
}

#endif
