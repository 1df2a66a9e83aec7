/* Elements that are looked at more closely, from anywhere in a run, a lane each: how much of their
 * volume the corners have, and how they move. For the kernels (hex8_kernel.c).
 *
 * Few lanes of a block are strained, and those of three blocks fill the lanes of one group.
 */
#ifndef LAR_MECHANICS_HEX8_GROUP_H
#define LAR_MECHANICS_HEX8_GROUP_H

#include <string.h>

#include "base/simd.h"
#include "mechanics/hex8_block.h"
#include "mechanics/hex8_gather.h"

/* These are called and not inlined: several times, for a few groups in a step. */
#define GROUP_CALL static __attribute__((noinline))

/* A vector of the corners of some lanes. */
GROUP_CALL void gather_corners(const lar_hex8_group *group, int lane, const double *of,
                               size_t stride, lar_lane x[8][3]) {
    for (int a = 0; a < 8; a++) lar_lane_gather(of, stride, group->node[a] + lane, x[a]);
}

/* The volumes that the edges span in the eight corners. */
GROUP_CALL void corner_volumes(const lar_lane x[8][3], lar_lane volume[8]) {
    /* Of every corner the corners where its edges along xi, eta, zeta begin and end. */
    static const int from[8][3] = {{0, 0, 0}, {0, 1, 1}, {3, 1, 2}, {3, 0, 3},
                                   {4, 4, 0}, {4, 5, 1}, {7, 5, 2}, {7, 4, 3}};
    static const int to[8][3] = {{1, 3, 4}, {1, 2, 5}, {2, 2, 6}, {2, 3, 7},
                                 {5, 7, 4}, {5, 6, 5}, {6, 6, 6}, {6, 7, 7}};
    UNROLL8 for (int a = 0; a < 8; a++) {
        lar_lane e[3][3];
        UNROLL3 for (int k = 0; k < 3; k++) UNROLL3 for (int i = 0; i < 3; i++) e[k][i] =
            x[to[a][k]][i] - x[from[a][k]][i];
        lar_lane sum = e[0][0] * lar_lane_fnma(e[1][2], e[2][1], e[1][1] * e[2][2]);
        sum = lar_lane_fma(e[0][1], lar_lane_fnma(e[1][0], e[2][2], e[1][2] * e[2][0]), sum);
        volume[a] = lar_lane_fma(e[0][2], lar_lane_fnma(e[1][1], e[2][0], e[1][0] * e[2][1]), sum);
    }
}

/* Modes of the corners, as gather_axis has them. */
LAR_INLINE void modes_of(const lar_lane x[8][3], lar_lane X[7][3]) {
    static const int left[4] = {0, 3, 4, 7}, right[4] = {1, 2, 5, 6};
    UNROLL3 for (int i = 0; i < 3; i++) {
        lar_lane sum[4], difference[4]; /* along xi, for (eta, zeta) = --, +-, -+, ++ */
        UNROLL4 for (int k = 0; k < 4; k++) {
            sum[k] = x[right[k]][i] + x[left[k]][i];
            difference[k] = x[right[k]][i] - x[left[k]][i];
        }
        X[0][i] = (difference[3] + difference[2]) + (difference[1] + difference[0]);
        X[1][i] = (sum[3] - sum[2]) + (sum[1] - sum[0]);
        X[2][i] = (sum[3] + sum[2]) - (sum[1] + sum[0]);
        X[3][i] = (sum[3] - sum[2]) - (sum[1] - sum[0]);
        X[4][i] = (difference[3] + difference[2]) - (difference[1] + difference[0]);
        X[5][i] = (difference[3] - difference[2]) + (difference[1] - difference[0]);
        X[6][i] = (difference[3] - difference[2]) - (difference[1] - difference[0]);
    }
}

/* lar_hex8_areas, operation for operation. */
LAR_INLINE lar_lane areas_of(const lar_lane x[8][3]) {
    lar_lane X[7][3], sum = lar_lane_set(0);
    modes_of(x, X);
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++) UNROLL3 for (int i = 0; i < 3; i++) {
            lar_lane term[2];
            for (int t = 0; t < 2; t++)
                term[t] = volume_term(LAR_HEX8_VOLUME_TERM[m][t].factor,
                                      X[LAR_HEX8_VOLUME_TERM[m][t].left],
                                      X[LAR_HEX8_VOLUME_TERM[m][t].right], i);
            lar_lane derivative = term[0] + term[1];
            sum = sum + derivative * derivative;
        }
    return lar_lane_set(8) * sum;
}

/* The largest |v_a - v_0|^2. */
LAR_INLINE lar_lane parting_of(const lar_lane v[8][3]) {
    lar_lane most = lar_lane_set(0);
    for (int a = 1; a < 8; a++) {
        lar_lane d[3];
        UNROLL3 for (int i = 0; i < 3; i++) d[i] = v[a][i] - v[0][i];
        most = lar_lane_max(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], most);
    }
    return most;
}

/* Where corners are. */
LAR_INLINE void displace(const lar_hex8_group *group, int lane, const lar_hex8_places *places,
                         lar_lane rest[8][3], lar_lane x[8][3]) {
    gather_corners(group, lane, places->u, places->stride, x);
    for (int a = 0; a < 8; a++) UNROLL3 for (int i = 0; i < 3; i++) x[a][i] += rest[a][i];
}

/* Where corners are that move on. */
LAR_INLINE void go_ahead(const lar_hex8_group *group, int lane, const lar_hex8_places *places,
                         lar_lane x[8][3]) {
    lar_lane v[8][3], ahead = lar_lane_load(&places->ahead[lane]);
    gather_corners(group, lane, places->v, places->stride, v);
    for (int a = 0; a < 8; a++) UNROLL3 for (int i = 0; i < 3; i++) x[a][i] += ahead * v[a][i];
}

/* Sets the bits of corners that have not more than `share` of their volumes at rest; returns the
 * lanes with such a one. */
LAR_INLINE unsigned look_below(const lar_lane now[8], const lar_lane at_rest[8], unsigned part,
                               double share, uint8_t *at) {
    unsigned any = 0;
    for (int a = 0; a < 8; a++) {
        unsigned below = lar_lane_not_greater(now[a], lar_lane_set(share) * at_rest[a]) & part;
        any |= below;
        for (; at && below; below &= below - 1) at[__builtin_ctz(below)] |= (uint8_t)(1u << a);
    }
    return any;
}

/* How much is left above `share`, at least. */
LAR_INLINE lar_lane least_above(const lar_lane now[8], const lar_lane at_rest[8], double share) {
    lar_lane missing = lar_lane_set(share) * at_rest[0] - now[0];
    for (int a = 1; a < 8; a++)
        missing = lar_lane_max(missing, lar_lane_set(share) * at_rest[a] - now[a]);
    return -missing;
}

/* The square of the longest edge. */
GROUP_CALL lar_lane longest_edge(const lar_lane x[8][3]) {
    static const int8_t end[12][2] = {{0, 1}, {3, 2}, {4, 5}, {7, 6}, {0, 3}, {1, 2},
                                      {4, 7}, {5, 6}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    lar_lane longest = lar_lane_set(0);
    for (int e = 0; e < 12; e++) {
        lar_lane d[3];
        UNROLL3 for (int i = 0; i < 3; i++) d[i] = x[end[e][1]][i] - x[end[e][0]][i];
        longest = lar_lane_max(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], longest);
    }
    return longest;
}

static unsigned corners(const lar_hex8_group *group, unsigned lanes, const lar_hex8_places *places,
                        const double share[2], lar_hex8_corner_look *look) {
    unsigned below[2] = {0, 0};
    memset(look->at, 0, sizeof look->at);
    for (int lane = 0; lane < LAR_BLOCK; lane += LAR_LANES) {
        lar_lane rest[8][3], x[8][3], now[8], at_rest[8];
        unsigned part = lanes >> lane & ((1u << LAR_LANES) - 1);
        if (!part) continue;
        gather_corners(group, lane, places->rest, places->stride, rest);
        displace(group, lane, places, rest, x);
        if (places->v) go_ahead(group, lane, places, x);
        corner_volumes((const lar_lane(*)[3])x, now);
        lar_lane_store(&look->longest[lane], longest_edge((const lar_lane(*)[3])x));
        for (int a = 0; a < 8; a++) at_rest[a] = lar_lane_load(&group->largest[lane]);
        if (look_below(now, at_rest, part, share[1], NULL)) {
            corner_volumes((const lar_lane(*)[3])rest, at_rest);
            below[0] |= look_below(now, at_rest, part, share[0], look->at + lane) << lane;
            below[1] |= look_below(now, at_rest, part, share[1], NULL) << lane;
            lar_lane_store(&look->over[lane], least_above(now, at_rest, share[0]));
        }
        lar_lane_store(&look->above[lane], least_above(now, at_rest, share[1]));
    }
    return below[0] | below[1] << LAR_BLOCK;
}

static void motion(const lar_hex8_group *group, unsigned lanes, const lar_hex8_places *places,
                   const double *v, lar_hex8_motion *out) {
    for (int lane = 0; lane < LAR_BLOCK; lane += LAR_LANES) {
        lar_lane rest[8][3], x[8][3];
        if (!(lanes >> lane & ((1u << LAR_LANES) - 1))) continue;
        gather_corners(group, lane, places->rest, places->stride, rest);
        displace(group, lane, places, rest, x);
        lar_lane_store(&out->areas[lane], areas_of((const lar_lane(*)[3])x));
        lar_lane_store(&out->longest[lane], longest_edge((const lar_lane(*)[3])x));
        if (!v) continue;
        gather_corners(group, lane, v, places->stride, x);
        lar_lane_store(&out->parting[lane], parting_of((const lar_lane(*)[3])x));
    }
}

#endif
