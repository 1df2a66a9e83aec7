#include "layout/layout.h"

#include <float.h>
#include <stdlib.h>

#include "layout/finish.h"
#include "layout/order.h"
#include "layout/row_plan.h"
#include "layout/rows.h"

/* Places of nodes in packets are 32-bit offsets, four values each, and faces 32-bit numbers, six of
 * an element. A line of five and more nodes may need a spare one before it, so a quarter of the
 * nodes at most is added to those of the model. */
enum { NODES_MAX = 1 << 28, ELEMENTS_MAX = INT32_MAX / 6 };

/* Ways of looking for rows. The first serves models too large to try them all. */
static const lar_row_habit habits[] = {{1, 0.3}, {0, 0.3}, {2, 0.3}, {1, 0.2}, {0, 0.2},
                                       {2, 0.2}, {1, 0.4}, {0, 0.4}, {2, 0.4}};
enum { HABITS = sizeof habits / sizeof habits[0], TRY_ALL_ELEMENTS = 50000 };

/* Takes the rows of a layout apart: every element in a loose general block, its turn kept. */
static void take_apart(lar_draft *draft) {
    const lar_mesh *mesh = &draft->model->mesh;
    for (int32_t e = 0; e < mesh->element_count; e++) draft->open[e] = true;
    for (int32_t n = 0; n < mesh->node_count; n++) draft->layout->local[n] = -1;
    draft->layout->block_count = 0;
    draft->range[0].count = 0;
}

/* One whole layout; the caller destroys it also on failure, which is for want of memory. */
static bool build(const lar_model *model, const lar_gid *order, const lar_row_ways *ways,
                  lar_row_habit habit, lar_layout_style style, lar_layout *layout) {
    lar_draft draft;
    bool built =
        lar_draft_begin(&draft, model, NULL, NULL, order, model->mesh.element_count, layout) &&
        lar_row_plan(&draft, ways, habit);
    if (built && style == LAR_LAYOUT_LOOSE) take_apart(&draft);
    built = built && lar_finish_layout(&draft, style == LAR_LAYOUT_LOOSE);
    lar_draft_end(&draft);
    return built;
}

/* Builds with one habit after the other and returns the best. One is enough for a large model, and
 * when everything is in rows of eight. */
static bool choose_habit(const lar_model *model, const lar_gid *order, const lar_row_ways *ways,
                         lar_row_habit *best) {
    int32_t elements = model->mesh.element_count;
    double min = DBL_MAX, perfect = lar_layout_min_cost(elements);
    *best = habits[0];
    if (elements > TRY_ALL_ELEMENTS) return true;
    for (int h = 0; h < HABITS && min > perfect; h++) {
        lar_layout trial;
        bool built = build(model, order, ways, habits[h], LAR_LAYOUT_ROWS, &trial);
        double cost = lar_layout_cost(&trial);
        lar_layout_destroy(&trial);
        if (!built) return false;
        if (cost < min) {
            min = cost;
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
    if (model->mesh.node_count > NODES_MAX || model->mesh.element_count > ELEMENTS_MAX)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: %d nodes and %d elements are more than can be numbered (%d and %d); "
                        "use a coarser mesh",
                        lar_model_source(model), (int)model->mesh.node_count,
                        (int)model->mesh.element_count, NODES_MAX, ELEMENTS_MAX);
    size_t elements = (size_t)model->mesh.element_count;
    lar_gid *order = lar_calloc(elements, sizeof *order);
    int32_t *neighbour = NULL;
    lar_status status =
        order ? LAR_OK : lar_fail_memory(error, elements * sizeof *order, "the element order");
    for (int32_t e = 0; order && e < model->mesh.element_count; e++) order[e] = e;
    if (!status) status = lar_order_elements(model, order, model->mesh.element_count, error);
    if (!status) status = lar_rows_neighbours(&model->mesh, &neighbour, error);
    if (!status) {
        lar_row_habit habit;
        lar_row_ways ways = lar_row_ways_all(neighbour);
        if (!choose_habit(model, order, &ways, &habit) ||
            !build(model, order, &ways, habit, style, layout))
            status = lar_fail_memory(error, elements * 40, "the layout of the elements");
    }
    free(order);
    free(neighbour);
    if (status) lar_layout_destroy(layout);
    return status;
}

uint32_t lar_layout_turn(const lar_layout *layout, const lar_mesh *mesh, lar_gid e) {
    uint32_t turn = 0;
    for (unsigned a = 0; a < 8; a++) {
        unsigned k = 0;
        while (k < 7 && mesh->element[e][k] != layout->corner[e][a]) k++;
        turn |= k << 4 * a;
    }
    return turn;
}

void lar_layout_destroy(lar_layout *layout) {
    if (!layout->corner_lent) free(layout->corner);
    free(layout->block);
    free(layout->global);
    free(layout->local);
    *layout = (lar_layout){0};
}
