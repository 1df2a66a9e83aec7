#include "layout/part_layout.h"

#include <float.h>
#include <stdlib.h>

#include "layout/chains.h"
#include "layout/finish.h"
#include "layout/order.h"

/* Ways of looking for rows. The first serves parts too large to try them all. */
static const double patience[] = {0.3, 0, 0.2, 0.4};
enum { PATIENCES = sizeof patience / sizeof patience[0], TRY_ALL_ELEMENTS = 200000 };

/* What a part is made from. Two orders: along the Z curve, and as the whole layout has them. */
enum { ORDERS = 2 };
typedef struct sources {
    const lar_model *model;
    const lar_layout *whole;
    const lar_part *part;
    int32_t count;
    lar_gid *order[ORDERS]; /* [count] */
    lar_chains chains;
} sources;

static lar_status check_part(const lar_model *model, const lar_layout *whole, const lar_part *part,
                             int32_t *count, lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    if (part->threads < 1 || part->threads > LAR_LAYOUT_THREADS)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: %d threads in a processor; 1 to %d can be",
                        lar_model_source(model), (int)part->threads, LAR_LAYOUT_THREADS);
    *count = 0;
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        int32_t thread = part->thread[e];
        if (thread < 0) continue;
        ++*count;
        if (thread >= part->threads || part->batch[e] < 0)
            return lar_fail(
                error, LAR_ERROR_ARGUMENT,
                "%s: element %lld is given to thread %d, batch %d; there are %d threads, "
                "and batches count from 0",
                lar_model_source(model), (long long)mesh->element_id[e], (int)thread,
                (int)part->batch[e], (int)part->threads);
        for (int a = 0; a < 8; a++) {
            int32_t owner = part->owner[whole->corner[e][a]];
            if (owner < 0 || owner >= part->threads)
                return lar_fail(error, LAR_ERROR_ARGUMENT,
                                "%s: node %lld of element %lld, recovered by this processor, is "
                                "moved by thread %d of it; there are %d",
                                lar_model_source(model),
                                (long long)mesh->node_id[whole->corner[e][a]],
                                (long long)mesh->element_id[e], (int)owner, (int)part->threads);
        }
    }
    return LAR_OK;
}

/* Which of the part's elements stands where in the whole layout. */
static void order_as_whole(const sources *from, lar_gid *order) {
    int32_t count = 0;
    for (int32_t b = 0; b < from->whole->block_count; b++)
        for (int lane = 0; lane < LAR_BLOCK; lane++) {
            lar_gid e = from->whole->block[b].element[lane];
            if (e >= 0 && from->part->thread[e] >= 0) order[count++] = e;
        }
}

static lar_status collect(sources *from, lar_error *error) {
    const lar_mesh *mesh = &from->model->mesh;
    lar_status status = check_part(from->model, from->whole, from->part, &from->count, error);
    if (status) return status;
    size_t bytes = (size_t)from->count * sizeof(lar_gid);
    for (int i = 0; i < ORDERS; i++) {
        from->order[i] = lar_calloc((size_t)from->count, sizeof(lar_gid));
        if (!from->order[i]) return lar_fail_memory(error, bytes, "the elements of a processor");
        order_as_whole(from, from->order[i]);
    }
    status = lar_order_elements(from->model, from->order[0], from->count, error);
    if (!status && !lar_chains_create(mesh, (const int32_t(*)[8])from->whole->corner,
                                      from->order[0], from->count, &from->chains))
        status = lar_fail_memory(error, (size_t)mesh->element_count * 24, "the chains of elements");
    return status;
}

/* One layout of the part; the caller destroys it also on failure, which is for want of memory. */
static bool build(const sources *from, int way, lar_layout *layout) {
    lar_draft draft;
    lar_row_ways ways = lar_chains_ways(&from->chains);
    lar_row_habit habit = {0, patience[way / ORDERS]};
    bool built = lar_draft_begin(&draft, from->model, from->whole, from->part,
                                 from->order[way % ORDERS], from->count, layout) &&
                 lar_row_plan(&draft, &ways, habit) && lar_finish_layout(&draft, false);
    lar_draft_end(&draft);
    return built;
}

/* The cheapest of all ways. */
static bool build_best(const sources *from, lar_layout *best) {
    int ways = from->count > TRY_ALL_ELEMENTS ? 1 : ORDERS * PATIENCES;
    double min = DBL_MAX, perfect = lar_layout_min_cost(from->count);
    for (int way = 0; way < ways && min > perfect; way++) {
        lar_layout trial;
        bool built = build(from, way, &trial);
        double cost = built ? lar_layout_cost(&trial) : 0;
        lar_layout *loser = built && cost < min ? best : &trial;
        lar_layout_destroy(loser);
        if (!built) return false;
        if (loser == best) {
            min = cost;
            *best = trial;
        }
    }
    return true;
}

lar_status lar_layout_create_part(const lar_model *model, const lar_layout *whole,
                                  const lar_part *part, lar_layout *layout, lar_error *error) {
    sources from = {.model = model, .whole = whole, .part = part};
    *layout = (lar_layout){0};
    lar_status status = collect(&from, error);
    if (!status && !build_best(&from, layout))
        status = lar_fail_memory(error, (size_t)from.count * 40, "the layout of a processor");
    for (int i = 0; i < ORDERS; i++) free(from.order[i]);
    lar_chains_destroy(&from.chains);
    if (status) lar_layout_destroy(layout);
    return status;
}
