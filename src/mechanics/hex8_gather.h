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

/* Nodes, and sums of forces, axis by axis: `stride` values from one axis to the next. */
typedef struct lane_nodes {
    const double *value;
    size_t stride;
} lane_nodes;
typedef struct lane_sums {
    int64_t *value;
    size_t stride;
} lane_sums;

/* Whether a vector's elements are neighbours in a row, so that their nodes are found as lanes. One
 * element is a row of its own. Vectors of eight find two rows of four in halves (`fours`, always a
 * constant). */
#ifndef LANES_LIE_IN_ROWS
#define LANES_LIE_IN_ROWS(rows)                                                                    \
    (LAR_LANES == 1 || (rows) == LAR_ROWS_EIGHT || ((rows) == LAR_ROWS_FOUR && LAR_LANES <= 4))
#define LANES_KNOW_FOURS (LAR_LANES == 8)
#endif

/* What other lanes have at their corners is picked up, and later handed out, node by node: of the
 * four edges along xi first the left, then the right one. */
typedef struct picked_corners {
    double of[4][2][3][LAR_LANES] __attribute__((aligned(64)));
} picked_corners;
enum { PICKED_EDGE = 2 * 3 * LAR_LANES };
static const int32_t picked_place[8][LAR_BLOCK] = {{0},
                                                   {0},
                                                   {PICKED_EDGE},
                                                   {PICKED_EDGE},
                                                   {2 * PICKED_EDGE},
                                                   {2 * PICKED_EDGE},
                                                   {3 * PICKED_EDGE},
                                                   {3 * PICKED_EDGE}};

/* A function of its own and a loop: three loads for each node of each lane are many instructions,
 * and every phase would have them. */
__attribute__((noinline)) static void pick_corners(const lar_block_head *head, int lane,
                                                   lar_block_rows rows, lane_nodes u,
                                                   picked_corners *picked) {
    for (int k = 0; k < 8; k++) {
        int edge = k / 2, right = k % 2;
        lar_lane corner[3];
        const int32_t *node = head->node[right ? right_node[edge] : left_node[edge]] + lane;
        if (rows == LAR_ROWS_NONE)
            lar_lane_gather(u.value, u.stride, node, corner);
        else
            lar_lane_gather_row(u.value, u.stride, node, rows == LAR_ROWS_FOUR, corner);
        UNROLL3 for (int i = 0; i < 3; i++) lar_lane_store(picked->of[edge][right][i], corner[i]);
    }
}

__attribute__((noinline)) static void hand_out(const lar_block_head *head, int lane,
                                               lar_block_rows rows, const lar_ilane corner[8][3],
                                               lane_sums force) {
    for (int edge = 0; edge < 4; edge++) {
        const int left = left_node[edge], right = right_node[edge];
        const int32_t *a = head->node[left] + lane, *b = head->node[right] + lane;
        if (rows == LAR_ROWS_NONE) {
            lar_ilane_scatter_add(force.value, force.stride, a, corner[left]);
            lar_ilane_scatter_add(force.value, force.stride, b, corner[right]);
        } else {
            lar_ilane_scatter_row(force.value, force.stride, a, b, rows == LAR_ROWS_FOUR,
                                  corner[left], corner[right]);
        }
    }
}

/* Where the corners of some lanes are: those of the edge with left corner a at left[axis] and
 * right[axis], at[a * LAR_BLOCK] values further. Six pointers and one place for each edge are what
 * registers hold; with a place for each corner a third of a phase's instructions were addresses. A
 * single lane need not lie in a row: its right corners have places of their own. */
enum { ONE_LANE = LAR_LANES == 1 };
typedef struct lane_corners {
    const double *left[3], *right[3];
    const int32_t *at;
} lane_corners;

LAR_INLINE lane_corners find_corners(const lar_block_head *head, int lane, lar_block_rows rows,
                                     bool fours, lane_nodes u, picked_corners *picked) {
    lane_corners found = {.at = head->node[0] + lane};
    size_t axis = u.stride, next = ONE_LANE ? 0 : 1;
    const double *first = u.value;
    if (!fours && !LANES_LIE_IN_ROWS(rows)) {
        pick_corners(head, lane, rows, u, picked);
        found.at = picked_place[0];
        axis = LAR_LANES;
        next = (size_t)3 * LAR_LANES;
        first = picked->of[0][0][0];
    }
    UNROLL3 for (int i = 0; i < 3; i++) {
        found.left[i] = first + (size_t)i * axis;
        found.right[i] = found.left[i] + next;
    }
    return found;
}

LAR_INLINE lar_lane load_corner(const double *axis, const int32_t *at, bool fours) {
#if LANES_KNOW_FOURS
    if (fours) return lar_axis_fours(axis, at);
#endif
    (void)fours;
    return lar_lane_load_row(axis + at[0]);
}

LAR_INLINE void gather_edge(lane_corners from, int edge, bool fours, lar_lane sum[3],
                            lar_lane difference[3]) {
    lar_lane left[3], right[3];
    const int32_t *at = from.at + left_node[edge] * LAR_BLOCK;
    const int32_t *at_right = ONE_LANE ? from.at + right_node[edge] * LAR_BLOCK : at;
    UNROLL3 for (int i = 0; i < 3; i++) {
        left[i] = load_corner(from.left[i], at, fours);
        right[i] = load_corner(from.right[i], at_right, fours);
    }
    UNROLL3 for (int i = 0; i < 3; i++) {
        sum[i] = right[i] + left[i];
        difference[i] = right[i] - left[i];
    }
}

/* Sums and differences along xi and eta of the four nodes with one sign of zeta:
 * index 0: ++, 1: +-, 2: -+, 3: -- (xi first). */
LAR_INLINE void gather_layer(lane_corners from, int edge, bool fours, lar_lane layer[4][3]) {
    lar_lane s0[3], d0[3], s1[3], d1[3];
    gather_edge(from, edge, fours, s0, d0);
    gather_edge(from, edge + 1, fours, s1, d1);
    UNROLL3 for (int i = 0; i < 3; i++) {
        layer[0][i] = s1[i] + s0[i];
        layer[1][i] = s1[i] - s0[i];
        layer[2][i] = d1[i] + d0[i];
        layer[3][i] = d1[i] - d0[i];
    }
}

/* Modal displacements: xi, eta, zeta, eta zeta, xi zeta, xi eta, xi eta zeta. */
LAR_INLINE void gather_modes(const lar_block_head *head, int lane, lar_block_rows rows, bool fours,
                             lane_nodes u, lar_lane U[7][3]) {
    picked_corners picked;
    lar_lane lower[4][3], upper[4][3];
    const lane_corners from = find_corners(head, lane, rows, fours, u, &picked);
    gather_layer(from, 0, fours, lower);
    gather_layer(from, 2, fours, upper);
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
