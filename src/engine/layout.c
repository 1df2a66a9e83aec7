#include "engine/layout.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "engine/draft.h"
#include "engine/order.h"
#include "engine/row_plan.h"
#include "engine/rows.h"

/* Local nodes are addressed by 32-bit offsets, four values each, and faces by 32-bit numbers, six
 * of an element. A line of five and more nodes may need a spare one before it, so a quarter of the
 * nodes at most is added to those of the model. */
enum { NODES_MOST = 1 << 28, ELEMENTS_MOST = INT32_MAX / 6 };

/* Ways of looking for rows. The first serves models too large to try them all. */
static const lar_row_habit habits[] = {{1, 0.3}, {0, 0.3}, {2, 0.3}, {1, 0.2}, {0, 0.2},
                                       {2, 0.2}, {1, 0.4}, {0, 0.4}, {2, 0.4}};
enum { HABITS = sizeof habits / sizeof habits[0], TRY_ALL_ELEMENTS = 50000 };

/* What eight lanes of a kind of rows cost in a step, a row of eight being 1 (measured). */
static const double rows_cost[LAR_ROWS_COUNT] = {
    [LAR_ROWS_NONE] = 1.25, [LAR_ROWS_FOUR] = 1.05, [LAR_ROWS_EIGHT] = 1};

static double layout_cost(const lar_layout *layout) {
    double cost = 0;
    for (int32_t b = 0; b < layout->block_count; b++) cost += rows_cost[layout->block[b].rows];
    return cost;
}

/* What no row took: elements of one kind, eight by eight. */
static bool place_loose(lar_draft *draft, const lar_gid *order, bool general) {
    int32_t filling[LAR_KINDS], used[LAR_KINDS];
    memset(filling, -1, sizeof filling);
    memset(used, 0, sizeof used);
    for (int32_t i = 0; i < draft->model->mesh.element_count; i++) {
        lar_gid e = order[i];
        if (!draft->open[e]) continue;
        lar_kind own = lar_draft_kind(draft, &e, (const int32_t(*)[8])draft->layout->corner + e, 1);
        if (general) own = (lar_kind){own.law, LAR_SHAPE_GENERAL, 0};
        int at = lar_kind_index(own);
        if (filling[at] < 0 || used[at] == LAR_BLOCK) {
            if (!lar_draft_block(draft, own, LAR_ROWS_NONE)) return false;
            filling[at] = draft->layout->block_count - 1;
            used[at] = 0;
        }
        draft->layout->block[filling[at]].element[used[at]++] = e;
    }
    return true;
}

static int block_rank(const lar_lanes *block) {
    return lar_kind_index((lar_kind){block->law, block->shape, block->turn}) * LAR_ROWS_COUNT +
           (int)block->rows;
}

/* Equal kinds together, each in the order in which it was made. */
static bool sort_blocks(lar_layout *layout) {
    lar_lanes *sorted = lar_calloc((size_t)layout->block_count, sizeof *sorted);
    if (!sorted) return false;
    int32_t count = 0;
    for (int rank = 0; rank < LAR_KINDS * LAR_ROWS_COUNT; rank++)
        for (int32_t b = 0; b < layout->block_count; b++)
            if (block_rank(&layout->block[b]) == rank) sorted[count++] = layout->block[b];
    free(layout->block);
    layout->block = sorted;
    return true;
}

/* Nodes that are in no row follow in the order of the blocks, then the padding. */
static bool number_rest(lar_draft *draft) {
    lar_layout *layout = draft->layout;
    for (int32_t b = 0; b < layout->block_count; b++)
        for (int lane = 0; lane < LAR_BLOCK; lane++) {
            lar_gid e = layout->block[b].element[lane];
            for (int a = 0; e >= 0 && a < 8; a++)
                if (layout->local[layout->corner[e][a]] < 0 &&
                    !lar_draft_number(draft, layout->corner[e][a]))
                    return false;
        }
    layout->node_padded = (layout->node_count + 2) & ~1;
    int32_t real = layout->node_count;
    while (layout->node_count < layout->node_padded)
        if (!lar_draft_number(draft, -1)) return false;
    layout->node_count = real;
    return true;
}

/* Takes the rows of a layout apart: every element in a loose general block, its turn kept. */
static void take_apart(lar_draft *draft) {
    const lar_mesh *mesh = &draft->model->mesh;
    for (int32_t e = 0; e < mesh->element_count; e++) draft->open[e] = true;
    for (int32_t n = 0; n < mesh->node_count; n++) draft->layout->local[n] = -1;
    draft->layout->block_count = 0;
    draft->layout->node_count = 0;
}

/* One whole layout; the caller destroys it also on failure, which is for want of memory. */
static bool build(const lar_model *model, const lar_gid *order, const int32_t *neighbour,
                  lar_row_habit habit, lar_layout_style style, lar_layout *layout) {
    lar_draft draft;
    bool built =
        lar_draft_begin(&draft, model, layout) && lar_row_plan(&draft, order, neighbour, habit);
    if (built && style == LAR_LAYOUT_LOOSE) take_apart(&draft);
    built = built && place_loose(&draft, order, style == LAR_LAYOUT_LOOSE) && sort_blocks(layout) &&
            number_rest(&draft);
    lar_draft_end(&draft);
    return built;
}

/* Builds with one habit after the other and returns the best. One is enough for a large model, and
 * when everything is in rows of eight. */
static bool choose_habit(const lar_model *model, const lar_gid *order, const int32_t *neighbour,
                         lar_row_habit *best) {
    int32_t elements = model->mesh.element_count;
    double least = DBL_MAX, perfect = rows_cost[LAR_ROWS_EIGHT] * elements / LAR_BLOCK;
    *best = habits[0];
    if (elements > TRY_ALL_ELEMENTS) return true;
    for (int h = 0; h < HABITS && least > perfect; h++) {
        lar_layout trial;
        bool built = build(model, order, neighbour, habits[h], LAR_LAYOUT_ROWS, &trial);
        double cost = layout_cost(&trial);
        lar_layout_destroy(&trial);
        if (!built) return false;
        if (cost < least) {
            least = cost;
            *best = habits[h];
        }
    }
    return true;
}

lar_status lar_layout_create(const lar_model *model, lar_layout *layout, lar_error *error) {
    return lar_layout_create_styled(model, LAR_LAYOUT_ROWS, layout, error);
}

lar_status lar_layout_create_styled(const lar_model *model, lar_layout_style style,
                                    lar_layout *layout, lar_error *error) {
    *layout = (lar_layout){0};
    if (model->mesh.node_count > NODES_MOST || model->mesh.element_count > ELEMENTS_MOST)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: %d nodes and %d elements are more than can be numbered (%d and %d); "
                        "use a coarser mesh",
                        lar_model_source(model), (int)model->mesh.node_count,
                        (int)model->mesh.element_count, NODES_MOST, ELEMENTS_MOST);
    size_t elements = (size_t)model->mesh.element_count;
    lar_gid *order = lar_calloc(elements, sizeof *order);
    int32_t *neighbour = NULL;
    lar_status status =
        order ? LAR_OK : lar_fail_memory(error, elements * sizeof *order, "the element order");
    if (!status) status = lar_order_elements(model, order, error);
    if (!status) status = lar_rows_neighbours(&model->mesh, &neighbour, error);
    if (!status) {
        lar_row_habit habit;
        if (!choose_habit(model, order, neighbour, &habit) ||
            !build(model, order, neighbour, habit, style, layout))
            status = lar_fail_memory(error, elements * 40, "the layout of the elements");
    }
    free(order);
    free(neighbour);
    if (status) lar_layout_destroy(layout);
    return status;
}

void lar_layout_destroy(lar_layout *layout) {
    free(layout->corner);
    free(layout->block);
    free(layout->global);
    free(layout->local);
    *layout = (lar_layout){0};
}
