/* Lean blocks made whole, and memory asked for before it is needed (docs/performance.md, "Lean
 * blocks", "Large models"). For kernels only (hex8_kernel.c).
 */
#ifndef LAR_MECHANICS_HEX8_LEAN_H
#define LAR_MECHANICS_HEX8_LEAN_H

#include "base/simd.h"
#include "mechanics/hex8_block.h"
#include "mechanics/hex8_gather.h"

/* The quotient as division would round it: what is left over, times the reciprocal (Markstein
 * 1990). Divisions take five times as long. It may be wrong once in some 10^15 times, and then
 * lar_domain_create sees it and keeps whole blocks. */
LAR_INLINE lar_lane quotient(lar_lane a, lar_lane b, lar_lane reciprocal) {
    lar_lane q = a * reciprocal;
    return lar_lane_fma(lar_lane_fnma(q, b, a), reciprocal, q);
}

/* Gradients and shapes of some lanes, as hex8.c makes them, operation for operation. */
LAR_INLINE void expand_lanes(const lar_lean_block *lean, int lane, lar_block_rows rows,
                             lane_nodes rest, lar_hex8_block *whole) {
    lar_lane X[7][3];
    picked_corners picked;
    const lane_corners from = find_corners(&whole->head, lane, rows, false, rest, &picked);
    UNROLL3 for (int i = 0; i < 3; i++) {
        lar_lane along[7];
        gather_axis(from, i, false, along);
        UNROLL7 for (int m = 0; m < 7; m++) X[m][i] = along[m];
    }
    lar_lane volume = lar_lane_load(&lean->volume[lane]), reciprocal = lar_lane_set(1) / volume;
    UNROLL6 for (int m = 0; m < LAR_HEX8_GRADIENTS; m++) UNROLL3 for (int i = 0; i < 3; i++) {
        lar_lane term[2];
        for (int t = 0; t < 2; t++)
            term[t] =
                volume_term(LAR_HEX8_VOLUME_TERM[m][t].factor, X[LAR_HEX8_VOLUME_TERM[m][t].left],
                            X[LAR_HEX8_VOLUME_TERM[m][t].right], i);
        lar_lane_store(&whole->gradient[m][i][lane],
                       quotient(term[0] + term[1], volume, reciprocal));
    }
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) UNROLL3 for (int i = 0; i < 3; i++)
        lar_lane_store(&whole->shape[m][i][lane], X[3 + m][i]);
}

static lane_nodes nodes_of(const lar_block_run *run, const double *value) {
    return (lane_nodes){value, run->axis_stride};
}

/* Of some memory every so many lines are asked for, from the first one on.
 *
 * Blocks that come from beyond the second-level cache are asked for while the chunk before them is
 * computed: a few lines of each, evenly. Hardware fetches on from a line that was asked for, some
 * twenty lines, but only while somebody asks, and a core can wait for sixteen lines at once; asked
 * for in one go they keep it from computing. Some processors are faster where every line is
 * asked for (docs/performance.md, "Large models"). */
LAR_INLINE void ask(const char *memory, size_t bytes, size_t first, size_t each) {
    enum { LINE = 64 };
#pragma GCC unroll 1
    for (size_t k = first * LINE; k < bytes; k += each * LINE) __builtin_prefetch(memory + k, 0, 3);
}

/* Of a lean block in a model that caches do not hold nearly all that comes from memory is its
 * nodes, and of whole ones that need not be waited for they are what is left. They are numbered as
 * blocks come: what this many nodes further stands is needed soon. */
__attribute__((noinline)) static void ask_for_nodes(const lar_block_run *run,
                                                    const lar_block_head *head, const double *u,
                                                    const int64_t *force) {
    enum { AHEAD = 128 };
    __asm__ volatile(""); /* else calls of a function that changes nothing are left out */
    size_t at = (size_t)head->node[left_node[3]][0] + AHEAD;
    for (int i = 0; i < 3; i++, at += run->axis_stride) {
        if (run->rest) __builtin_prefetch(run->rest + at, 0, 3);
        __builtin_prefetch(u + at, 0, 3);
        __builtin_prefetch(force + at, 1, 3);
    }
}

static void expand(const lar_block_run *run, int32_t b, lar_hex8_block *whole) {
    const void *block = lar_run_block(run, b);
    lar_lean_head(run, block, &whole->head);
    for (int lane = 0; lane < LAR_BLOCK; lane += LAR_LANES)
        expand_lanes(block, lane, run->rows, nodes_of(run, run->rest), whole);
}

/* The blocks of a chunk that begins with block b as phases take them. */
static const char *whole_blocks(const lar_block_run *run, int32_t b, size_t count, const double *u,
                                const int64_t *force, lar_hex8_block *made) {
    const char *kept = lar_run_block(run, b);
    if (!run->rest) return kept;
    if (run->asks) ask(kept + count * lar_run_stride(run), count * lar_run_stride(run), 0, 1);
    for (size_t i = 0; i < count; i++) {
        expand(run, b + (int32_t)i, &made[i]);
        if (run->asks) ask_for_nodes(run, &made[i].head, u, force);
    }
    return (const char *)made;
}

#endif
