#include "layout/finish.h"

#include <stdlib.h>

#include "mechanics/axes.h"

enum { HALF_ROW = LAR_BLOCK / 2 };

/* What eight lanes of a kind of rows cost in a step, a row of eight being 1 (measured). */
static const double rows_cost[LAR_ROWS_COUNT] = {
    [LAR_ROWS_NONE] = 1.9, [LAR_ROWS_FOUR] = 1.08, [LAR_ROWS_EIGHT] = 1};

double lar_layout_cost(const lar_layout *layout) {
    double cost = 0;
    for (int32_t b = 0; b < layout->block_count; b++) cost += rows_cost[layout->block[b].rows];
    return cost;
}

double lar_layout_min_cost(int32_t elements) {
    return rows_cost[LAR_ROWS_EIGHT] * elements / LAR_BLOCK;
}

/* A block or an element in an order to come; equal keys stay in the order of `index`. */
typedef struct ranked {
    uint64_t key;
    int32_t index;
} ranked;

static int compare_ranked(const void *a, const void *b) {
    const ranked *left = a, *right = b;
    if (left->key != right->key) return left->key < right->key ? -1 : 1;
    return left->index < right->index ? -1 : left->index > right->index;
}

/* What may share a block: the upper half of a pool's keys; the lower half is the batch, so that
 * those that do share one are wanted at about the same time. */
static uint64_t pool_key(int32_t thread, lar_kind kind, int32_t batch) {
    return (uint64_t)(thread * LAR_KINDS + lar_kind_index(kind)) << 32 | (uint32_t)batch;
}

static lar_kind kind_of(const lar_lanes *block) {
    return (lar_kind){block->law, block->shape, block->turn, block->viscous, block->fibrous};
}

/* ---- rows of four ---------------------------------------------------------------------------- */

/* The second takes the free half of the first; without a second the row's elements are open again.
 */
static void join_halves(lar_draft *draft, lar_lanes *first, lar_lanes *second) {
    lar_lanes *emptied = second ? second : first;
    for (int k = 0; k < HALF_ROW; k++) {
        lar_gid e = emptied->element[k];
        if (e < 0) continue;
        draft->open[e] = true;
        emptied->element[k] = -1;
        if (second) lar_draft_put(draft, first, HALF_ROW + k, e);
    }
}

/* Rows of four so far have a block each: two share one, and one that stays alone is no row. */
static bool pair_rows_of_four(lar_draft *draft) {
    lar_layout *layout = draft->layout;
    ranked *half = lar_calloc((size_t)layout->block_count, sizeof *half);
    if (!half) return false;
    int32_t count = 0, kept = 0;
    for (int32_t b = 0; b < layout->block_count; b++) {
        const lar_lanes *block = &layout->block[b];
        if (block->rows == LAR_ROWS_FOUR)
            half[count++] = (ranked){pool_key(block->thread, kind_of(block), block->batch), b};
    }
    qsort(half, (size_t)count, sizeof *half, compare_ranked);
    for (int32_t i = 0; i < count;) {
        bool paired = i + 1 < count && half[i].key >> 32 == half[i + 1].key >> 32;
        join_halves(draft, &layout->block[half[i].index],
                    paired ? &layout->block[half[i + 1].index] : NULL);
        i += paired ? 2 : 1;
    }
    for (int32_t b = 0; b < layout->block_count; b++)
        if (layout->block[b].element[0] >= 0) layout->block[kept++] = layout->block[b];
    layout->block_count = kept;
    free(half);
    return true;
}

/* ---- loose elements ------------------------------------------------------------------------- */

static lar_kind loose_kind(const lar_draft *draft, lar_gid e, bool general) {
    const int32_t(*corner)[8] = (const int32_t(*)[8])draft->layout->corner + e;
    lar_kind kind = lar_draft_kind(draft, &e, corner, 1);
    return general ? (lar_kind){kind.law, LAR_SHAPE_GENERAL, 0, kind.viscous, kind.fibrous} : kind;
}

/* What no row took: elements of one thread and kind, eight by eight. */
static bool place_loose(lar_draft *draft, bool general) {
    ranked *loose = lar_calloc((size_t)draft->count, sizeof *loose);
    if (!loose) return false;
    int32_t count = 0, used = 0;
    for (int32_t i = 0; i < draft->count; i++) {
        lar_gid e = draft->order[i];
        if (!draft->open[e]) continue;
        uint64_t key = pool_key(lar_draft_thread(draft, e), loose_kind(draft, e, general),
                                lar_draft_batch(draft, e));
        loose[count++] = (ranked){key, i};
    }
    qsort(loose, (size_t)count, sizeof *loose, compare_ranked);
    bool good = true;
    lar_lanes *block = NULL;
    for (int32_t i = 0; good && i < count; i++) {
        lar_gid e = draft->order[loose[i].index];
        if (i == 0 || used == LAR_BLOCK || loose[i].key >> 32 != loose[i - 1].key >> 32) {
            block = lar_draft_block(draft, loose_kind(draft, e, general), LAR_ROWS_NONE);
            used = 0;
        }
        good = block;
        if (good) lar_draft_put(draft, block, used++, e);
    }
    free(loose);
    return good;
}

/* ---- order and numbers ---------------------------------------------------------------------- */

/* Threads and their batches one after the other, then equal kinds together, each in the order in
 * which it was made. */
static bool sort_blocks(lar_layout *layout) {
    size_t count = (size_t)layout->block_count;
    ranked *rank = lar_calloc(count, sizeof *rank);
    lar_lanes *sorted = lar_calloc(count, sizeof *sorted);
    if (rank && sorted) {
        for (size_t b = 0; b < count; b++) {
            const lar_lanes *block = &layout->block[b];
            uint64_t batch = (uint64_t)block->thread << 31 | (uint32_t)block->batch;
            uint64_t kind = (uint64_t)lar_kind_index(kind_of(block));
            rank[b] =
                (ranked){(batch * LAR_KINDS + kind) * LAR_ROWS_COUNT + block->rows, (int32_t)b};
        }
        qsort(rank, count, sizeof *rank, compare_ranked);
        for (size_t b = 0; b < count; b++) sorted[b] = layout->block[rank[b].index];
        free(layout->block);
        layout->block = sorted;
        sorted = NULL;
    }
    bool good = rank && !sorted;
    free(rank);
    free(sorted);
    return good;
}

/* Nodes that are in no row follow in the order of the blocks; then those that no element here has,
 * but that are moved here. */
static bool number_rest(lar_draft *draft) {
    const lar_layout *layout = draft->layout;
    for (int32_t b = 0; b < layout->block_count; b++)
        for (int lane = 0; lane < LAR_BLOCK; lane++) {
            lar_gid e = layout->block[b].element[lane];
            for (int a = 0; e >= 0 && a < 8; a++) {
                lar_gid node = layout->corner[e][a];
                if (layout->local[node] < 0 &&
                    !lar_draft_number(draft, lar_draft_owner(draft, node), node))
                    return false;
            }
        }
    for (int32_t n = 0; draft->part && n < draft->model->mesh.node_count; n++)
        if (layout->local[n] < 0 && draft->part->owner[n] >= 0 &&
            !lar_draft_number(draft, draft->part->owner[n], n))
            return false;
    return true;
}

/* Puts the owners' ranges one behind the other. Each is filled up to whole lanes, with at least one
 * spare node: behind a line that ends a range may be a lane without an element (row_plan.c). */
static bool join_ranges(lar_draft *draft) {
    lar_layout *layout = draft->layout;
    int32_t nodes = 0;
    layout->thread_count = draft->threads;
    for (int32_t t = 0; t < draft->threads; t++) {
        layout->first_node[t] = nodes;
        if (draft->range[t].count == 0) continue;
        layout->node_count = nodes + draft->range[t].count;
        nodes = lar_whole_lanes(layout->node_count + 1);
    }
    layout->node_padded = lar_whole_lanes(layout->node_count + 1);
    layout->axis_stride = lar_axis_stride((size_t)layout->node_padded);
    for (int32_t t = draft->threads; t <= LAR_LAYOUT_THREADS; t++)
        layout->first_node[t] = layout->node_padded;
    layout->global = lar_calloc((size_t)layout->node_padded, sizeof *layout->global);
    if (!layout->global) return false;
    for (lar_lid n = 0; n < layout->node_padded; n++) layout->global[n] = -1;
    for (int32_t t = 0; t < draft->threads; t++)
        for (int32_t i = 0; i < draft->range[t].count; i++) {
            lar_gid node = draft->range[t].node[i];
            layout->global[layout->first_node[t] + i] = node;
            if (node >= 0) layout->local[node] = layout->first_node[t] + i;
        }
    return true;
}

bool lar_finish_layout(lar_draft *draft, bool general) {
    return pair_rows_of_four(draft) && place_loose(draft, general) && sort_blocks(draft->layout) &&
           number_rest(draft) && join_ranges(draft);
}
