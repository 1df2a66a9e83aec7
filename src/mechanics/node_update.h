/* Nodes from one step to the next, several values at a time: central differences (hex8_block.h has
 * their constants). For kernels only (hex8_kernel.c).
 */
#ifndef LAR_MECHANICS_NODE_UPDATE_H
#define LAR_MECHANICS_NODE_UPDATE_H

#include "mechanics/hex8_gather.h"

#include "base/simd.h"

/* The three axes of a node in turn: its push and mass are loaded once. */
LAR_INLINE bool update_values(const lar_leapfrog *leapfrog, int64_t first, int64_t end,
                              size_t stride, double *u, double *v, int64_t *force,
                              const double *push, bool divided, const double *mass, double *damped,
                              double *fastest) {
    const lar_lane keep = lar_lane_set(leapfrog->keep), dt = lar_lane_set(leapfrog->dt);
    const lar_lane speed = lar_lane_set(leapfrog->speed), factor = lar_lane_set(leapfrog->push);
    lar_lane drift[3], sum = lar_lane_set(0), max = lar_lane_set(0);
    for (int i = 0; i < 3; i++) drift[i] = lar_lane_set(leapfrog->drift[i]);
    unsigned beyond = 0;
    for (int64_t n = first; n < end; n += LAR_LANES) {
        lar_lane pushed = lar_lane_load(push + n);
        if (divided) pushed = factor * pushed;
        UNROLL3 for (int i = 0; i < 3; i++) {
            size_t k = (size_t)n + (size_t)i * stride;
            lar_lane f = lar_ilane_to_lane(lar_ilane_load(force + k));
            lar_lane before = lar_lane_load(v + k);
            lar_lane after = lar_lane_fnma(f, pushed, lar_lane_fma(keep, before, drift[i]));
            lar_lane_store(v + k, after);
            lar_lane_store(u + k, lar_lane_fma(dt, after, lar_lane_load(u + k)));
            lar_ilane_store(force + k, (lar_ilane){0});
            lar_lane size = lar_lane_abs(after);
            beyond |= lar_lane_not_greater(speed, size);
            max = lar_lane_max(max, size);
            if (mass) {
                lar_lane twice = before + after;
                sum = lar_lane_fma(lar_lane_load(mass + n) * twice, twice, sum);
            }
        }
    }
    double values[LAR_LANES] __attribute__((aligned(64)));
    if (mass) {
        lar_lane_store(values, sum);
        for (int i = 0; i < LAR_LANES; i++) *damped += values[i];
    }
    lar_lane_store(values, max);
    for (int i = 0; i < LAR_LANES; i++)
        if (values[i] > *fastest) *fastest = values[i];
    return beyond == 0;
}

static bool update(const lar_leapfrog *leapfrog, int32_t first, int32_t end, size_t stride,
                   double *u, double *v, int64_t *force, const double *push, const double *mass,
                   double *damped, double *fastest) {
    /* Four loops: what is not wanted costs nothing. */
#define VALUES(divided, mass)                                                                      \
    update_values(leapfrog, first, end, stride, u, v, force, push, divided, mass, damped, fastest)
    if (leapfrog->push != 1) return mass ? VALUES(true, mass) : VALUES(true, NULL);
    return mass ? VALUES(false, mass) : VALUES(false, NULL);
#undef VALUES
}

#endif
