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
#define UNROLL7
#define UNROLL8
#define UNROLL9
#else
#define UNROLL3 _Pragma("GCC unroll 3")
#define UNROLL4 _Pragma("GCC unroll 4")
#define UNROLL6 _Pragma("GCC unroll 6")
#define UNROLL7 _Pragma("GCC unroll 7")
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

/* How many axes of some lanes are worked on at once: modes, gradients and stresses of all three
 * fill 32 registers, those of one 16. */
enum { AXES = LAR_LANES == 4 ? 1 : 3 };

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
            lar_ilane_scatter_row(force.value, force.stride, a, b, rows == LAR_ROWS_FOUR, 3,
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
    return lar_lane_keep(lar_lane_load_row(axis + at[0]));
}

/* Modal displacements along an axis: xi, eta, zeta, eta zeta, xi zeta, xi eta, xi eta zeta. */
LAR_INLINE void gather_axis(lane_corners from, int axis, bool fours, lar_lane U[7]) {
    lar_lane sum[4], difference[4]; /* along xi, for (eta, zeta) = --, +-, -+, ++ */
    UNROLL4 for (int edge = 0; edge < 4; edge++) {
        const int32_t *at = from.at + left_node[edge] * LAR_BLOCK;
        const int32_t *at_right = ONE_LANE ? from.at + right_node[edge] * LAR_BLOCK : at;
        lar_lane left = load_corner(from.left[axis], at, fours);
        lar_lane right = load_corner(from.right[axis], at_right, fours);
        sum[edge] = right + left;
        difference[edge] = right - left;
    }
    lar_lane lower[4], upper[4]; /* along xi and eta: ++, +-, -+, -- */
    for (int top = 0; top < 2; top++) {
        lar_lane *layer = top ? upper : lower;
        layer[0] = sum[2 * top + 1] + sum[2 * top];
        layer[1] = sum[2 * top + 1] - sum[2 * top];
        layer[2] = difference[2 * top + 1] + difference[2 * top];
        layer[3] = difference[2 * top + 1] - difference[2 * top];
    }
    U[0] = upper[2] + lower[2];
    U[1] = upper[1] + lower[1];
    U[2] = upper[0] - lower[0];
    U[3] = upper[1] - lower[1];
    U[4] = upper[2] - lower[2];
    U[5] = upper[3] + lower[3];
    U[6] = upper[3] - lower[3];
}

/* factor / 64 (a x b), axis i: of the volume's derivatives (LAR_HEX8_VOLUME_TERM). */
LAR_INLINE lar_lane volume_term(double factor, const lar_lane a[3], const lar_lane b[3], int i) {
    int j = i == 2 ? 0 : i + 1, k = i == 0 ? 2 : i - 1;
    return lar_lane_set(factor / 64) * (a[j] * b[k] - a[k] * b[j]);
}

#endif
