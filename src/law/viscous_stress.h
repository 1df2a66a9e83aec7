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
    lar_lane rest, share[LAR_VISCOUS_TERMS], rate[LAR_VISCOUS_TERMS], unit, inverse;
} lar_viscous_lane;

/* a^T b over J, as six values: a = cof F and b = P make F^-1 P. */
LAR_INLINE void lar_lane_pull(const lar_lane a[9], const lar_lane b[9], lar_lane factor,
                              lar_lane out[6]) {
    for (int i = 0, n = 0; i < 3; i++)
        for (int j = i; j < 3; j++, n++)
            out[n] = factor * lar_lane_fma(a[6 + i], b[6 + j],
                                           lar_lane_fma(a[3 + i], b[3 + j], a[i] * b[j]));
}

/* Takes a term on by a step; `now` is its H. */
LAR_INLINE void lar_viscous_relax(lar_lane dt, lar_lane rate, const lar_lane change[6],
                                  lar_lane now[6]) {
    lar_lane x = lar_lane_max(dt * rate, lar_lane_set(LAR_LANE_TINY));
    lar_lane less = lar_lane_expm1(-x), h = -less / x;
    for (int k = 0; k < 6; k++)
        now[k] = lar_lane_fma(h, change[k], lar_lane_fma(less, now[k], now[k]));
}

/* P of the law becomes P of the material; `history` [values] goes on by dt. Returns a number not
 * below |S - Se|^2 |F|^2 in order of magnitude, in the units of P. */
LAR_INLINE lar_lane lar_viscous_stress(const lar_lane F[9], const lar_viscous_lane *c, int terms,
                                       bool isochoric, lar_lane dt, lar_lane history[],
                                       lar_lane P[9]) {
    static const int symmetric[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    static const double twice[6] = {1, 2, 2, 1, 2, 1}; /* of a product of tensors */
    lar_lane cof[9], part[9], strain[6], stress[6], change[6], before[6], after[6];
    lar_lane J = lar_lane_cofactor(F, cof), work = lar_lane_set(0), size = work;
    lar_lane reciprocal = lar_lane_set(1) / J, mean = work;
    for (int k = 0; isochoric && k < 9; k++) mean = lar_lane_fma(P[k], F[k], mean);
    mean = mean * reciprocal * lar_lane_set(1.0 / 3);
    for (int k = 0; k < 9; k++) part[k] = isochoric ? lar_lane_fnma(mean, cof[k], P[k]) : P[k];
    lar_lane_pull(cof, part, c->inverse * reciprocal, stress);
    lar_lane_pull(F, F, lar_lane_set(1), strain);
    for (int k = 0; k < 6; k++) {
        if (k == 0 || k == 3 || k == 5) strain[k] = strain[k] - lar_lane_set(1);
        change[k] = stress[k] - history[LAR_HISTORY_STRESS + k];
        history[LAR_HISTORY_STRESS + k] = stress[k];
        before[k] = after[k] = lar_lane_set(0);
    }
    for (int i = 0; i < terms; i++) {
        lar_lane *H = history + LAR_HISTORY_TERMS + 6 * i;
        for (int k = 0; k < 6; k++) before[k] = lar_lane_fma(c->share[i], H[k], before[k]);
        lar_viscous_relax(dt, c->rate[i], change, H);
        for (int k = 0; k < 6; k++) after[k] = lar_lane_fma(c->share[i], H[k], after[k]);
    }
    for (int k = 0; k < 6; k++) {
        lar_lane step =
            lar_lane_set(0.25 * twice[k]) * (strain[k] - history[LAR_HISTORY_STRAIN + k]);
        work = lar_lane_fma(before[k] + after[k], step, work);
        history[LAR_HISTORY_STRAIN + k] = strain[k];
        after[k] = c->unit * lar_lane_fma(c->rest - lar_lane_set(1), stress[k], after[k]);
        size = lar_lane_fma(lar_lane_set(twice[k]) * after[k], after[k], size);
    }
    history[LAR_HISTORY_WORK] = history[LAR_HISTORY_WORK] + work;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                P[3 * i + j] = lar_lane_fma(F[3 * i + k], after[symmetric[k][j]], P[3 * i + j]);
    return size * lar_lane_square_sum(F);
}

#endif
