/* The phase of the kernels (hex8_kernel.c) that keeps flat elements from folding (hex8_fold.h). For
 * kernels only.
 */
#ifndef LAR_MECHANICS_FOLD_HEX8_FOLD_LANES_H
#define LAR_MECHANICS_FOLD_HEX8_FOLD_LANES_H

#include "law/kinematics.h"
#include "mechanics/hex8_gather.h"

enum { ALL_LANES = (1U << LAR_LANES) - 1 };

/* A lane per element, whose record still has its gradient: adds to its hourglass forces; what is to
 * be added to its stress goes to P. False: there is nothing, and P is not written. */
LAR_INLINE bool fold_lanes(const lar_fold_block *of, int lane, lane_record *record, lar_lane P[9]) {
    const lar_lane *F = record->F, nothing = lar_lane_set(0);
    lar_lane N[3], b[3], strained[LAR_HEX8_HOURGLASS], v[3] = {nothing, nothing, nothing};
    lar_lane from = lar_lane_load(&of->from[lane]), Q = nothing;
    if (lar_lane_not_greater(from, nothing) == ALL_LANES) return false; /* none of these folds */
    UNROLL3 for (int j = 0; j < 3; j++) N[j] = lar_lane_load(&of->axis[j][lane]);
    UNROLL3 for (int i = 0; i < 3; i++) b[i] =
        lar_lane_fma(F[3 * i + 2], N[2], lar_lane_fma(F[3 * i + 1], N[1], F[3 * i] * N[0]));
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        const lar_lane *cq = record->cq[m];
        lar_lane along = lar_lane_fma(cq[2], b[2], lar_lane_fma(cq[1], b[1], cq[0] * b[0]));
        strained[m] = along * lar_lane_load(&of->softness[m][lane]);
        Q = lar_lane_fma(strained[m], strained[m], Q);
    }
    lar_lane t = from - lar_lane_cofactor(F, P);
    lar_lane before = lar_lane_max(t, nothing),
             now = lar_lane_max(lar_lane_fma(Q, lar_lane_set(0.5), t), nothing);
    if (lar_lane_not_greater(now, nothing) == ALL_LANES) return false;
    lar_lane bulk = lar_lane_load(&of->bulk[lane]), less = bulk * (before - now), more = bulk * now;
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        lar_lane *cq = record->cq[m], part = strained[m] * more;
        lar_lane by = part * lar_lane_load(&of->softness[m][lane]);
        part = part * lar_lane_load(&of->weight[m][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) {
            v[i] = lar_lane_fma(by, cq[i], v[i]);
            cq[i] = lar_lane_fma(part, b[i], cq[i]);
        }
    }
    UNROLL3 for (int i = 0; i < 3; i++) UNROLL3 for (int j = 0; j < 3; j++) P[3 * i + j] =
        lar_lane_fma(less, P[3 * i + j], v[i] * N[j]);
    return true;
}

/* The blocks of a chunk: a bit for each part that has something in P. */
__attribute__((noinline)) static unsigned fold(const lar_fold_block *of, size_t count,
                                               lane_record *record, lar_lane P[][9]) {
    unsigned parts = 0;
    for (size_t part = 0; part < count * PARTS; part++)
        if (fold_lanes(&of[part / PARTS], (int)(part % PARTS) * LAR_LANES, &record[part], P[part]))
            parts |= 1U << part;
    return parts;
}

/* Behind all that gives stress. */
LAR_INLINE void unfold(unsigned parts, lar_lane P[][9], lane_record *record) {
    for (; parts; parts &= parts - 1) {
        const int part = __builtin_ctz(parts);
        for (int k = 0; k < 9; k++) record[part].F[k] = record[part].F[k] + P[part][k];
    }
}

#endif
