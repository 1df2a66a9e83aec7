/* Contact of bodies by who has the whole model: the list and when it is made anew. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/collide.h"

/* ---- motion and searches, of the whole model ------------------------------------------------ */

/* Steps that a search should last, and those that the next one may take within the last fifth of
 * the skin. */
enum { SEARCH_STEPS = 200, PART_STEPS = 60 };

/* Fetches the places; returns how far the farthest has moved since the search. */
static double fetch_places(lar_collide *collide, const lar_state *state) {
    lar_collide_motion *motion = collide->motion;
    double most = 0;
    for (int32_t n = 0; n < collide->surface->node_count; n++) {
        const double *u = state->u + collide->view.value[n];
        for (int i = 0; i < 3; i++) {
            motion->x[n][i] = collide->surface->rest[n][i] + u[i];
            most = lar_most(most, fabs(motion->x[n][i] - motion->searched[n][i]));
        }
    }
    return most;
}

static double skin_for(const lar_collide_motion *motion, double way) {
    return fmin(fmax(2 * way * SEARCH_STEPS, motion->skin_least), motion->skin_most);
}

/* A search is done; `moved` says what has moved since its places. */
static void take_list(lar_collide *collide, double moved) {
    lar_collide_motion *motion = collide->motion;
    collide->list = motion->search->list;
    memcpy(motion->searched, motion->x, (size_t)collide->surface->node_count * sizeof *motion->x);
    collide->info.searches++;
    collide->info.boxed += (uint64_t)collide->list.face_count;
    lar_collide_restart(collide);
    collide->moved = collide->travel = moved;
    motion->searching = false;
}

static void search_now(lar_collide *collide, const lar_state *state, double way) {
    lar_collide_motion *motion = collide->motion;
    fetch_places(collide, state);
    if (!lar_contact_search_run(motion->search, (const double(*)[3])motion->x,
                                skin_for(motion, way)))
        collide->too_many_pairs = true;
    take_list(collide, 0);
    motion->valid = true;
}

/* What has really moved? */
static void look(lar_collide *collide, const lar_state *state, double way) {
    lar_collide_motion *motion = collide->motion;
    double moved = fetch_places(collide, state);
    if (moved < 0.15 * collide->list.skin) {
        collide->moved = moved;
        return;
    }
    lar_contact_search_begin(motion->search, (const double(*)[3])motion->x, skin_for(motion, way));
    motion->since = 0;
    motion->searching = true;
}

/* The list is good for this step, whatever happens. `way` is what a step takes at present. */
static void keep_list(lar_collide *collide, const lar_state *state, double way) {
    lar_collide_motion *motion = collide->motion;
    if (!motion->valid || motion->always) {
        search_now(collide, state, way);
        return;
    }
    if (!motion->searching && collide->moved > 0.3 * collide->list.skin) look(collide, state, way);
    bool last = !(collide->moved < 0.5 * collide->list.skin);
    if (motion->searching) {
        /* As many as must be, when the rest of the way is to be enough for the others. */
        double steps = way > 0 ? (0.5 * collide->list.skin - collide->moved) / (1.25 * way) : 1e9;
        int32_t left = lar_contact_search_left(motion->search);
        int32_t nodes = (int32_t)(left / fmax(fmin(steps, PART_STEPS), 1)) + 1;
        lar_contact_progress progress =
            lar_contact_search_go_on(motion->search, last ? INT32_MAX : nodes);
        if (progress == LAR_SEARCH_DONE) take_list(collide, motion->since);
        if (progress == LAR_SEARCH_FULL) search_now(collide, state, way);
    }
    /* It has become so fast that even the new list is old. */
    if (!(collide->moved < 0.5 * collide->list.skin)) search_now(collide, state, way);
}

void lar_collide_apply(lar_collide *collide, const lar_condition_context *context,
                       lar_state *state) {
    if (!collide->surface) return;
    lar_collide_motion *motion = collide->motion;
    if (state->round != motion->next) motion->valid = false;
    keep_list(collide, state, context->whole_step * state->fastest);
    motion->next = state->round + 1;
    lar_collide_add(collide, context, state);
    collide->info.possible += collide->surface->possible;
    collide->info.steps++;
}

void lar_collide_moved(lar_collide *collide, lar_state *state, double way) {
    for (int32_t i = 0; i < collide->level_count; i++)
        state->u[collide->level[i].value] = collide->level[i].depth;
    collide->level_count = 0;
    collide->moved += way;
    collide->way = way;
    if (!collide->motion) return;
    /* Who does not have all nodes hears how fast the others are (contact_exchange.h). */
    collide->travel += way;
    collide->motion->since += way;
}

void lar_collide_forget(lar_collide *collide) {
    if (collide->motion) collide->motion->valid = false;
}

/* ---- creation ------------------------------------------------------------------------------- */

static lar_status allocate(lar_collide *collide, const int32_t *local, lar_error *error) {
    lar_collide_motion *motion = collide->motion;
    const lar_contact_surface *surface = &motion->search->surface;
    size_t nodes = (size_t)surface->node_count, groups = (size_t)motion->search->list.group_room;
    size_t pairs = (size_t)motion->search->list.face_room;
    int32_t *value = lar_calloc(nodes, sizeof *value);
    collide->view.value = value;
    motion->x = lar_calloc(nodes, sizeof *motion->x);
    motion->searched = lar_calloc(nodes, sizeof *motion->searched);
    collide->due = lar_calloc(groups, sizeof *collide->due);
    collide->last = lar_calloc(groups, sizeof *collide->last);
    collide->near = lar_calloc(groups, sizeof *collide->near);
    collide->away = lar_calloc(pairs, sizeof *collide->away);
    collide->part = lar_calloc(groups, sizeof *collide->part);
    collide->level = lar_calloc(groups, sizeof *collide->level);
    if (!value || !motion->x || !motion->searched || !collide->due || !collide->last ||
        !collide->near || !collide->away || !collide->part || !collide->level)
        return lar_fail_memory(error, groups * sizeof *collide->part, "contact of bodies");
    for (size_t n = 0; n < nodes; n++) value[n] = 4 * local[surface->node[n].node];
    return LAR_OK;
}

lar_status lar_collide_create(const lar_model *model, const double *mass, const int32_t *local,
                              double time_step, double stable_step, bool search_always,
                              lar_collide *collide, lar_error *error) {
    *collide = (lar_collide){0};
    lar_collide_motion *motion = collide->motion = lar_calloc(1, sizeof *motion);
    if (motion) motion->search = lar_calloc(1, sizeof *motion->search);
    if (!motion || !motion->search) {
        lar_collide_destroy(collide);
        return lar_fail_memory(error, sizeof *motion->search, "contact of bodies");
    }
    lar_status status = lar_contact_search_create(model, mass, local, motion->search, error);
    lar_contact_surface *surface = &motion->search->surface;
    if (!status && surface->node_count > 0)
        status = lar_contact_surface_fit(model, time_step, stable_step, surface, error);
    if (status || surface->node_count == 0) {
        lar_collide_destroy(collide);
        return status;
    }
    collide->law = lar_contact_law_for(time_step, stable_step);
    collide->time_step = time_step;
    collide->list = motion->search->list;
    motion->always = search_always;
    motion->skin_least = 0.25 * surface->reach;
    motion->skin_most = 2 * surface->reach_most;
    status = allocate(collide, local, error);
    if (status)
        lar_collide_destroy(collide);
    else
        collide->surface = surface;
    return status;
}

void lar_collide_destroy(lar_collide *collide) {
    lar_collide_motion *motion = collide->motion;
    free(collide->due);
    free(collide->last);
    free(collide->near);
    free(collide->away);
    free(collide->part);
    free(collide->level);
    if (motion) {
        free((int32_t *)collide->view.value);
        if (motion->search) lar_contact_search_clear(motion->search);
        free(motion->search);
        free(motion->x);
        free(motion->searched);
        free(motion);
    }
    *collide = (lar_collide){0};
}
