/* Nodes of a block of hexahedra, several elements at a time: their values, the sums and differences
 * along the edges that modes are made of, and what is made of them. For kernels only
 * (hex8_kernel.c).
 */
#ifndef LAR_MECHANICS_HEX8_GATHER_H
#define LAR_MECHANICS_HEX8_GATHER_H

#include "mechanics/hex8_block.h"

#include "base/simd.h"

/* Small where it cannot be fast: without the instruction, fma() is a call. */
#ifdef __OPTIMIZE_SIZE__
#define UNROLL3
#define UNROLL4
#define UNROLL6
#define UNROLL8
#define UNROLL9
#else
#define UNROLL3 _Pragma("GCC unroll 3")
#define UNROLL4 _Pragma("GCC unroll 4")
#define UNROLL6 _Pragma("GCC unroll 6")
#define UNROLL8 _Pragma("GCC unroll 8")
#define UNROLL9 _Pragma("GCC unroll 9")
#endif

/* What waits between the phases. */
typedef struct lane_record {
    lar_lane F[9];                      /* deformation gradient, then V times the stress P */
    lar_lane cq[LAR_HEX8_HOURGLASS][3]; /* hourglass forces c_m q_m */
} lane_record;

/* What a monitor says of the strain of some lanes (hex8_block.h). */
typedef struct lane_strain {
    lar_lane number[LAR_STRAIN_NUMBERS];
} lane_strain;

/* The phases work on a few blocks at a time. The law of one block is a long chain of dependent
 * operations, which a processor can hide only behind other blocks; in short loops their turns
 * overlap in its window. Few enough that the records stay in the first-level cache. */
enum { CHUNK = 4, PARTS = LAR_BLOCK / LAR_LANES };

/* The local nodes at xi = -1 and xi = +1 of the four edges along xi: (eta, zeta) = --, +-, -+,
 * ++. */
static const int left_node[4] = {0, 3, 4, 7}, right_node[4] = {1, 2, 5, 6};

LAR_INLINE void gather_pair(const lar_block_head *head, int lane, lar_block_rows rows, int edge,
                            const double *u, lar_lane left[3], lar_lane right[3]) {
    const int32_t *a = head->node[left_node[edge]] + lane, *b = head->node[right_node[edge]] + lane;
    if (rows == LAR_ROWS_NONE) {
        lar_lane_gather(u, a, left);
        lar_lane_gather(u, b, right);
    } else {
        lar_lane_gather_row(u, a, b, rows == LAR_ROWS_FOUR, left, right);
    }
}

LAR_INLINE void gather_edge(const lar_block_head *head, int lane, lar_block_rows rows, int edge,
                            const double *u, lar_lane sum[3], lar_lane difference[3]) {
    lar_lane left[3], right[3];
    gather_pair(head, lane, rows, edge, u, left, right);
    UNROLL3 for (int i = 0; i < 3; i++) {
        sum[i] = right[i] + left[i];
        difference[i] = right[i] - left[i];
    }
}

/* Sums and differences along xi and eta of the four nodes with one sign of zeta:
 * index 0: ++, 1: +-, 2: -+, 3: -- (xi first). */
LAR_INLINE void gather_layer(const lar_block_head *head, int lane, lar_block_rows rows, int edge,
                             const double *u, lar_lane layer[4][3]) {
    lar_lane s0[3], d0[3], s1[3], d1[3];
    gather_edge(head, lane, rows, edge, u, s0, d0);
    gather_edge(head, lane, rows, edge + 1, u, s1, d1);
    UNROLL3 for (int i = 0; i < 3; i++) {
        layer[0][i] = s1[i] + s0[i];
        layer[1][i] = s1[i] - s0[i];
        layer[2][i] = d1[i] + d0[i];
        layer[3][i] = d1[i] - d0[i];
    }
}

/* Modal displacements: xi, eta, zeta, eta zeta, xi zeta, xi eta, xi eta zeta. */
LAR_INLINE void gather_modes(const lar_block_head *head, int lane, lar_block_rows rows,
                             const double *u, lar_lane U[7][3]) {
    lar_lane lower[4][3], upper[4][3];
    gather_layer(head, lane, rows, 0, u, lower);
    gather_layer(head, lane, rows, 2, u, upper);
    UNROLL3 for (int i = 0; i < 3; i++) {
        U[0][i] = upper[2][i] + lower[2][i];
        U[1][i] = upper[1][i] + lower[1][i];
        U[2][i] = upper[0][i] - lower[0][i];
        U[3][i] = upper[1][i] - lower[1][i];
        U[4][i] = upper[2][i] - lower[2][i];
        U[5][i] = upper[3][i] + lower[3][i];
        U[6][i] = upper[3][i] - lower[3][i];
    }
}

/* factor / 64 (a x b), axis i: of the volume's derivatives (LAR_HEX8_VOLUME_TERM). */
LAR_INLINE lar_lane volume_term(double factor, const lar_lane a[3], const lar_lane b[3], int i) {
    int j = i == 2 ? 0 : i + 1, k = i == 0 ? 2 : i - 1;
    return lar_lane_set(factor / 64) * (a[j] * b[k] - a[k] * b[j]);
}

#endif
