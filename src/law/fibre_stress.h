/* The stress of fibres for a lane (base/simd.h); law/fibre.h has the laws. With g = F a, I = g.g
 * and s = l dW/dl,
 *
 *     P += s (g (x) a / I)                             of the whole stretch
 *     P += s (g (x) a / I - cof F / (3 J))             of its isochoric part
 *
 * Of fibres that spread (hgo) the mean of g (x) a and of |g|^2 over them stand in place of both: q
 * = kappa |F|^2 + (1 - 3 kappa) |g|^2 and (kappa F + (1 - 3 kappa) g (x) a) / q, I = J^(-2/3) q.
 *
 * Fibres that are pressed have exactly no stress, and lanes without an element, with a direction
 * and parameters of zero, too. What is active is added behind viscosity: it does not relax.
 *
 * How stiff they are: the second derivative of W by F has the eigenvalues s'/l - s/I along g (x) a
 * and s/I across it. Of the isochoric stretch, dI/dF has the square 4/3 I + 4/9 I^2 |F^-T|^2, hence
 *
 *     s' l (1 / (3 |g|^2) + |F^-T|^2 / 9) + s (1 / |g|^2 + |F^-T|^2 / 3)
 *
 * is not below any of them. Of fibres that spread, the part of s is linear in |g|^2 and so in q;
 * that of s' l has the square of dI/dF, which with the mean M of |F b (x) b|, a tensor, is by 4 (q
 * - |M|^2) smaller.
 */
#ifndef LAR_LAW_FIBRE_STRESS_H
#define LAR_LAW_FIBRE_STRESS_H

#include "law/fibre.h"
#include "law/kinematics.h"
#include "law/lane_math.h"

typedef struct lar_fibre_lane {
    lar_lane direction[3], parameter[LAR_FIBRE_PARAMETERS], along, across;
} lar_fibre_lane;

/* What a stretch says of the fibres. */
typedef struct lar_fibre_answer {
    lar_lane tension; /* s */
    lar_lane slope;   /* ds/dl, never too low where the law has a corner */
} lar_fibre_answer;

/* x > 0 ? 1 : 0, for x that is not below 0. */
LAR_INLINE lar_lane lar_lane_is_above(lar_lane x) {
    return -lar_lane_max(-x * lar_lane_set(1e300), lar_lane_set(-1));
}

/* (I - 1)^(beta - 2) = e^((beta - 2) ln(I - 1)); the factors that are left of (I - 1)^(beta - 1)
 * make it zero where nothing pulls. */
LAR_INLINE lar_fibre_answer lar_fibre_exp_pow(lar_lane square, const lar_lane *p) {
    lar_lane x = lar_lane_max(square - lar_lane_set(1), lar_lane_set(0));
    lar_lane log_x = lar_lane_log(lar_lane_max(x, lar_lane_set(LAR_LANE_TINY)));
    lar_lane power = lar_lane_exp((p[2] - lar_lane_set(2)) * log_x);
    lar_lane exponent = p[1] * (x * x * power);
    lar_lane steep = p[0] * power * lar_lane_exp(exponent);
    lar_lane first = steep * x;
    lar_lane second = steep * lar_lane_fma(p[2], exponent, p[2] - lar_lane_set(1));
    return (lar_fibre_answer){.tension = lar_lane_set(2) * square * first,
                              .slope = lar_lane_set(4) * lar_lane_sqrt(square) *
                                       lar_lane_fma(square, second, first)};
}

LAR_INLINE lar_fibre_answer lar_fibre_exp_linear(lar_lane stretch, const lar_lane *p) {
    lar_lane x = lar_lane_max(stretch - lar_lane_set(1), lar_lane_set(0));
    lar_lane end = p[3] - lar_lane_set(1);
    lar_lane toe = -lar_lane_max(-x, -end), beyond = x - toe;
    lar_lane rise = lar_lane_expm1(p[1] * toe);
    lar_lane steep = p[0] * p[1] * (rise + lar_lane_set(1));
    return (lar_fibre_answer){.tension = lar_lane_fma(p[0], rise, p[2] * beyond),
                              .slope = lar_lane_max(steep, p[2] * lar_lane_is_above(beyond))};
}

/* With x = I - 1 and x0 = lam0^2 - 1, ksi x^(beta - 1) = k x (x / x0)^(beta - 2), k = E / (4 (beta
 * - 1) lam0^3), at the end of the toe at most; behind it dW/dl goes on with `steep`, its slope. */
LAR_INLINE lar_fibre_answer lar_fibre_pow_linear(lar_lane square, const lar_lane *p) {
    lar_lane one = lar_lane_set(1), zero = lar_lane_set(0), tiny = lar_lane_set(LAR_LANE_TINY);
    lar_lane stretch = lar_lane_sqrt(square), end = lar_lane_max(p[1], one);
    lar_lane x0 = lar_lane_max(end * end - one, tiny);
    lar_lane x = -lar_lane_max(-lar_lane_max(square - one, zero), -x0);
    lar_lane toe = -lar_lane_max(-stretch, -end), beyond = lar_lane_max(stretch - end, zero);
    lar_lane log_x = lar_lane_log(lar_lane_max(x / x0, tiny));
    lar_lane power = lar_lane_exp((p[2] - lar_lane_set(2)) * log_x);
    lar_lane straight = p[0] / (lar_lane_set(2) * end * end * end) * power;
    lar_lane bent = straight * x / (p[2] - one);
    lar_lane steep = lar_lane_fma(lar_lane_set(2) * toe * toe, straight, bent);
    lar_lane pull = lar_lane_fma(toe, bent, beyond * steep);
    return (lar_fibre_answer){.tension = stretch * pull,
                              .slope = lar_lane_fma(stretch, steep, pull)};
}

/* `square`: E + 1. */
LAR_INLINE lar_fibre_answer lar_fibre_hgo(lar_lane square, const lar_lane *p) {
    lar_lane x = lar_lane_max(square - lar_lane_set(1), lar_lane_set(0));
    lar_lane exponent = p[1] * (x * x), steep = p[0] * lar_lane_exp(exponent), first = steep * x;
    lar_lane second = lar_lane_fma(lar_lane_set(2) * steep, exponent, steep);
    return (lar_fibre_answer){.tension = lar_lane_set(2) * square * first,
                              .slope = lar_lane_set(4) * lar_lane_sqrt(square) *
                                       lar_lane_fma(square, second, first)};
}

/* `square`: l^2; of fibres that all run along `a`. */
LAR_INLINE lar_fibre_answer lar_fibre_straight(lar_fibre_law law, lar_lane square,
                                               const lar_lane *p) {
    if (law == LAR_FIBRE_EXP_POW) return lar_fibre_exp_pow(square, p);
    if (law == LAR_FIBRE_EXP_LINEAR) return lar_fibre_exp_linear(lar_lane_sqrt(square), p);
    if (law == LAR_FIBRE_POW_LINEAR) return lar_fibre_pow_linear(square, p);
    return (lar_fibre_answer){lar_lane_set(0), lar_lane_set(0)};
}

LAR_INLINE lar_fibre_answer lar_fibre_tension(lar_fibre_law law, lar_lane square,
                                              const lar_lane *p) {
    return law == LAR_FIBRE_HGO ? lar_fibre_hgo(square, p) : lar_fibre_straight(law, square, p);
}

/* l^2 from |F a|^2. */
LAR_INLINE lar_lane lar_fibre_square(int kind, lar_lane length, lar_lane J) {
    if (!lar_fibre_kind_isochoric(kind)) return length;
    lar_lane side = lar_lane_rcbrt(J);
    return side * side * length;
}

/* The largest eigenvalue of their stiffness, or more; `area` = |cof F|^2. */
LAR_INLINE lar_lane lar_fibre_stiffness(int kind, const lar_fibre_answer *now, lar_lane square,
                                        lar_lane length, lar_lane J, lar_lane area) {
    lar_lane inverse = lar_lane_set(1) / lar_lane_max(length, lar_lane_set(LAR_LANE_TINY));
    lar_lane stretch = lar_lane_sqrt(lar_lane_max(square, lar_lane_set(LAR_LANE_TINY)));
    if (!lar_fibre_kind_isochoric(kind)) {
        lar_lane across = now->tension * inverse;
        return lar_lane_max(now->slope / stretch - across, across);
    }
    lar_lane third = lar_lane_set(1.0 / 3), turned = area / (J * J);
    lar_lane mean = third * lar_lane_fma(turned, third, inverse);
    return lar_lane_fma(now->slope * stretch, mean, lar_lane_set(3) * now->tension * mean);
}

/* F a, and its square. */
LAR_INLINE lar_lane lar_fibre_push(const lar_lane F[9], const lar_lane a[3], lar_lane g[3]) {
    for (int i = 0; i < 3; i++)
        g[i] = lar_lane_fma(F[3 * i + 2], a[2], lar_lane_fma(F[3 * i + 1], a[1], F[3 * i] * a[0]));
    return lar_lane_fma(g[2], g[2], lar_lane_fma(g[1], g[1], g[0] * g[0]));
}

/* The mean of |F b|^2 over fibres b that spread; `length` is |F a|^2. */
LAR_INLINE lar_lane lar_fibre_mean(const lar_lane F[9], lar_lane length, lar_lane kappa) {
    lar_lane most = lar_lane_fnma(lar_lane_set(3), kappa, lar_lane_set(1));
    return lar_lane_fma(kappa, lar_lane_square_sum(F), most * length);
}

/* lar_fibre_stiffness of fibres that spread; `length`: lar_fibre_mean, `I1`: |F|^2. */
LAR_INLINE lar_lane lar_fibre_spread_stiffness(const lar_fibre_answer *now, lar_lane square,
                                               lar_lane length, lar_lane I1, lar_lane kappa,
                                               lar_lane J, lar_lane area) {
    lar_lane one = lar_lane_set(1),
             inverse = one / lar_lane_max(length, lar_lane_set(LAR_LANE_TINY));
    lar_lane mean =
        lar_lane_fma(kappa * kappa, I1, (one - kappa) * lar_lane_fnma(kappa, I1, length));
    lar_lane steep =
        lar_lane_fnma(lar_lane_set(2), now->tension, now->slope * lar_lane_sqrt(square));
    lar_lane straight = lar_fibre_stiffness(LAR_FIBRE_KIND_SPREAD, now, square, length, J, area);
    return straight - steep * inverse * lar_lane_fnma(mean, inverse, one);
}

/* How fibres are stretched. */
typedef struct lar_fibre_stretch {
    lar_lane g[3];   /* F a */
    lar_lane length; /* |g|^2; of fibres that spread lar_fibre_mean */
    lar_lane square; /* l^2 */
} lar_fibre_stretch;

LAR_INLINE lar_fibre_stretch lar_fibre_look(int kind, const lar_lane F[9],
                                            const lar_fibre_lane *c) {
    lar_fibre_stretch to;
    lar_lane cof[9], J = lar_lane_cofactor(F, cof);
    to.length = lar_fibre_push(F, c->direction, to.g);
    if (lar_fibre_kind_law(kind) == LAR_FIBRE_HGO)
        to.length = lar_fibre_mean(F, to.length, c->parameter[2]);
    to.square = lar_fibre_square(kind, to.length, J);
    return to;
}

/* Adds to P the stress of fibres with that answer to their stretch. Returns the square of its size,
 * as laws do; *stiff, where it is not NULL, becomes lar_fibre_stiffness. */
LAR_INLINE lar_lane lar_fibre_pull(int kind, const lar_lane F[9], const lar_fibre_lane *c,
                                   const lar_fibre_stretch *to, const lar_fibre_answer *now,
                                   lar_lane *stiff, lar_lane P[9]) {
    bool spreads = lar_fibre_kind_law(kind) == LAR_FIBRE_HGO;
    lar_lane cof[9], sum = lar_lane_set(0), kappa = c->parameter[2];
    lar_lane J = lar_lane_cofactor(F, cof);
    if (stiff && spreads)
        *stiff = lar_fibre_spread_stiffness(now, to->square, to->length, lar_lane_square_sum(F),
                                            kappa, J, lar_lane_square_sum(cof));
    else if (stiff)
        *stiff =
            lar_fibre_stiffness(kind, now, to->square, to->length, J, lar_lane_square_sum(cof));
    lar_lane all = now->tension / lar_lane_max(to->length, lar_lane_set(LAR_LANE_TINY));
    lar_lane spread = spreads ? kappa * all : lar_lane_set(0);
    lar_lane along = spreads ? lar_lane_fnma(lar_lane_set(3), spread, all) : all;
    lar_lane pressure = lar_fibre_kind_isochoric(kind) ? lar_lane_set(-1.0 / 3) * now->tension / J
                                                       : lar_lane_set(0);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            lar_lane more = pressure * cof[3 * i + j];
            if (spreads) more = lar_lane_fma(spread, F[3 * i + j], more);
            more = lar_lane_fma(along * to->g[i], c->direction[j], more);
            P[3 * i + j] = P[3 * i + j] + more;
            sum = lar_lane_fma(more, more, sum);
        }
    return sum;
}

/* Both, of one family. */
LAR_INLINE lar_lane lar_fibre_stress(int kind, const lar_lane F[9], const lar_fibre_lane *c,
                                     lar_lane P[9]) {
    lar_fibre_stretch to = lar_fibre_look(kind, F, c);
    lar_fibre_answer now = lar_fibre_tension(lar_fibre_kind_law(kind), to.square, c->parameter);
    return lar_fibre_pull(kind, F, c, &to, &now, NULL, P);
}

/* What an active stress has for a potential, 0 at rest. */
LAR_INLINE lar_lane lar_active_potential(const lar_lane F[9], const lar_fibre_lane *c) {
    lar_lane g[3], one = lar_lane_set(1);
    lar_lane along = (c->along - c->across) * (lar_fibre_push(F, c->direction, g) - one);
    lar_lane all = c->across * (lar_lane_square_sum(F) - lar_lane_set(3));
    return lar_lane_set(0.5) * (along + all);
}

/* Adds what is active: P += (along - across) g (x) a + across F. Returns the square of its size. */
LAR_INLINE lar_lane lar_active_stress(const lar_lane F[9], const lar_fibre_lane *c, lar_lane P[9]) {
    lar_lane g[3], sum = lar_lane_set(0), pull = c->along - c->across;
    (void)lar_fibre_push(F, c->direction, g);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            lar_lane more = lar_lane_fma(pull * g[i], c->direction[j], c->across * F[3 * i + j]);
            P[3 * i + j] = P[3 * i + j] + more;
            sum = lar_lane_fma(more, more, sum);
        }
    return sum;
}

#endif
