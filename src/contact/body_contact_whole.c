/* Contact of bodies: what follows from a new list; and, by who has the whole model, when it is
 * made. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "contact/history/body_friction.h"
#include "contact/history/flush.h"

/* ---- a new list ------------------------------------------------------------------------------ */

void lar_body_contact_restart(lar_body_contact *contact) {
    contact->travel = contact->horizon = 0;
    contact->fresh = true;
    if (contact->friction) contact->friction->known = false;
    /* Along one axis, by both. */
    for (int32_t g = 0; g < contact->list.group_count; g++) {
        contact->due[g] = fmax(0.5 * (double)contact->list.group[g].gap, 0);
        contact->last[g] = 0;
    }
    for (int32_t i = 0; i < contact->list.face_count; i++)
        contact->away[i] = fmax(0.5 * (double)contact->list.gap[i], 0);
}

/* The group of node n, among those from *g on, that has faces of a body; -1: there is none. They
 * are in the order of nodes. */
static int32_t group_with(const lar_body_contact *contact, int32_t n, int32_t body, int32_t *g) {
    const lar_contact_list *list = &contact->list;
    int32_t found = -1;
    while (*g < list->group_count && list->group[*g].node < n) (*g)++;
    for (int32_t k = *g; k < list->group_count && list->group[k].node == n; k++)
        if (contact->surface->face[list->face[list->group[k].first]].body == body) found = k;
    return found;
}

/* Which body's faces a node's offset is about. */
static int32_t body_behind(const lar_body_contact *contact, int32_t n, double offset) {
    const lar_contact_surface *s = contact->surface;
    if (lar_offset_is_behind(offset))
        for (int32_t b = 0; b < s->body_count; b++)
            if (offset == lar_offset_behind(b)) return b;
    return s->node[n].body;
}

/* Of a node that is flush; `g` is of group_with. */
static void look_at_flush(lar_body_contact *contact, const lar_state *state, int32_t n, int32_t g) {
    int32_t at = 0, body = -1;
    while (lar_flush_next_body(contact->surface, n, &at, &body)) {
        int32_t found = group_with(contact, n, body, &g);
        if (found >= 0) contact->due[found] = 0;
    }
    lar_offset_lose_flush(contact, state, n, g);
}

void lar_body_contact_end_offsets(lar_body_contact *contact, const lar_state *state) {
    int32_t g = 0;
    contact->fresh = false;
    for (int32_t n = 0; n < contact->surface->node_count; n++) {
        if (contact->keeps && !contact->keeps[n]) continue;
        int32_t local = contact->view.local[n];
        double before = fabs(state->level[local]);
        if (!signbit(state->level[local])) look_at_flush(contact, state, n, g);
        if (before == 0 || before == LAR_OFFSET_OUT) continue;
        int32_t found = group_with(contact, n, body_behind(contact, n, before), &g);
        if (found >= 0)
            contact->due[found] = 0;
        else
            contact->offset[contact->offset_count++] = (lar_penetration_offset){local, 0};
    }
}

/* ---- motion and searches, of the whole model ------------------------------------------------ */

/* Steps that a search should last, and those that the next one may take; the part of what nodes may
 * move after which that one begins. */
enum { SEARCH_STEPS = 200, PART_STEPS = 60 };
#define BEGIN_AT 0.6

/* The same where nobody waits for it; and the part of what is left, after which somebody looks. */
#define AHEAD_AT 0.5
#define LOOK_AT  0.7

/* Where a contact node is; returns what it goes in a step along an axis, at most. */
static double place_of(const lar_body_contact *contact, const lar_state *state, int32_t n,
                       double x[3]) {
    return contact->time_step *
           lar_contact_node_place(contact->surface, n, state, contact->view.local[n], x);
}

/* What has really moved since the list's search? */
static lar_contact_motion look(lar_body_contact *contact, const lar_state *state) {
    lar_body_contact_search_state *search_state = contact->search_state;
    lar_contact_motion motion = lar_contact_no_motion();
    for (int32_t n = 0; n < contact->surface->node_count; n++) {
        double x[3], way = place_of(contact, state, n, x);
        lar_contact_motion_add(&motion, search_state->searched[n], x, way, contact->list.allow[n],
                               0);
    }
    contact->moved = lar_contact_motion_alike(&motion, contact->list.skin);
    search_state->looked = contact->moved;
    search_state->look_at = contact->moved + LOOK_AT * (0.5 * contact->list.skin - contact->moved);
    search_state->steps = lar_contact_motion_steps(&motion);
    return motion;
}

/* Fetches the places for a search, and says what each node may move until the next one. */
static double prepare(lar_body_contact *contact, const lar_state *state, double way) {
    lar_body_contact_search_state *search_state = contact->search_state;
    double skin =
        fmin(fmax(2 * way * SEARCH_STEPS, search_state->skin_min), search_state->skin_max);
    for (int32_t n = 0; n < contact->surface->node_count; n++)
        search_state->search->share[n] = lar_contact_share_of(
            place_of(contact, state, n, search_state->x[n]), way, search_state->skin_min / skin);
    return skin;
}

/* A search is done. */
static void take_list(lar_body_contact *contact, const lar_state *state) {
    lar_body_contact_search_state *search_state = contact->search_state;
    const double begin = lar_clock_seconds();
    contact->list = search_state->search->list;
    memcpy(search_state->searched, search_state->x,
           (size_t)contact->surface->node_count * sizeof *search_state->x);
    contact->info.searches++;
    contact->info.boxed += (uint64_t)contact->list.face_count;
    lar_body_contact_restart(contact);
    contact->travel = look(contact, state).farthest;
    search_state->searching = false;
    search_state->taking = lar_clock_seconds() - begin;
}

static void search_now(lar_body_contact *contact, const lar_state *state, double way) {
    lar_body_contact_search_state *search_state = contact->search_state;
    double skin = prepare(contact, state, way);
    search_state->whole =
        lar_contact_search_run(search_state->search, (const double(*)[3])search_state->x, skin);
    if (!search_state->whole) contact->too_many_pairs = true;
    take_list(contact, state);
    search_state->valid = true;
}

/* The state is another one, such as that to which a program goes back again and again. Where no
 * node is far from its place at the last search, the list is as good as a new one: the same forces,
 * in a fraction of the time. A search that was under way ends. */
static bool rejoin(lar_body_contact *contact, const lar_state *state) {
    lar_body_contact_search_state *search_state = contact->search_state;
    if (!search_state->whole) return false;
    search_state->searching = false;
    lar_contact_motion motion = look(contact, state);
    if (!(motion.used < BEGIN_AT)) return false;
    lar_body_contact_restart(contact);
    contact->travel = motion.farthest;
    search_state->valid = true;
    return true;
}

/* Looks; and begins the next search, when nodes have moved by such a part of what they may. */
static void look_and_begin(lar_body_contact *contact, const lar_state *state, double way,
                           double begin_at) {
    lar_body_contact_search_state *search_state = contact->search_state;
    double used = look(contact, state).used;
    if (search_state->searching || used < begin_at) return;
    double skin = prepare(contact, state, way);
    lar_contact_search_begin(search_state->search, (const double(*)[3])search_state->x, skin);
    search_state->searching = true;
}

/* Some nodes of the search under way: as many as must be, when the time that is left is to be
 * enough for the others. */
static void go_on(lar_body_contact *contact, const lar_state *state, double way) {
    lar_body_contact_search_state *search_state = contact->search_state;
    bool last = !(contact->moved < 0.5 * contact->list.skin);
    int32_t left = lar_contact_search_left(search_state->search);
    int32_t nodes = (int32_t)(left / fmax(fmin(search_state->steps, PART_STEPS), 1)) + 1;
    search_state->steps--;
    lar_contact_progress progress =
        lar_contact_search_go_on(search_state->search, last ? INT32_MAX : nodes);
    if (progress == LAR_SEARCH_DONE) take_list(contact, state);
    if (progress == LAR_SEARCH_FULL) search_now(contact, state, way);
}

/* The list is good for this step, whatever happens. `way` is what a step takes at present. */
static void keep_list(lar_body_contact *contact, const lar_state *state, double way) {
    lar_body_contact_search_state *search_state = contact->search_state;
    bool known = search_state->valid || (!search_state->always && rejoin(contact, state));
    if (!known || search_state->always) {
        search_now(contact, state, way);
        return;
    }
    if (!(contact->moved < search_state->look_at)) look_and_begin(contact, state, way, BEGIN_AT);
    if (search_state->searching) go_on(contact, state, way);
    /* It has become so fast that even the new list is old. */
    if (!(contact->moved < 0.5 * contact->list.skin)) search_now(contact, state, way);
}

void lar_body_contact_work_ahead(lar_body_contact *contact, const lar_state *state, double until) {
    lar_body_contact_search_state *search_state = contact->search_state;
    if (!contact->surface || !search_state->valid || search_state->always ||
        search_state->next != state->round)
        return;
    const double way = contact->time_step * state->fastest;
    if (2 * contact->moved > search_state->looked + search_state->look_at)
        look_and_begin(contact, state, way, AHEAD_AT);
    if (!search_state->searching) return;
    const double after = 2 * search_state->taking;
    switch (lar_contact_search_until(search_state->search, until, after)) {
    case LAR_SEARCH_UNDER_WAY:
        break;
    case LAR_SEARCH_DONE:
        take_list(contact, state);
        break;
    case LAR_SEARCH_FULL:
        search_state->valid = false; /* from there, with a thinner skin */
    }
}

void lar_body_contact_apply(lar_body_contact *contact, const lar_condition_context *context,
                            lar_state *state) {
    if (!contact->surface) return;
    lar_body_contact_search_state *search_state = contact->search_state;
    if (state->round != search_state->next) search_state->valid = false;
    keep_list(contact, state, context->whole_step * state->fastest);
    search_state->next = state->round + 1;
    lar_body_contact_add(contact, context, state);
    contact->info.possible += contact->surface->possible;
    contact->info.steps++;
}

/* Who has parted stays so until it meets again, whatever its offset is. */
static void take_offset(const lar_penetration_offset *offset, double *level) {
    if (signbit(offset->depth) || offset->depth == LAR_OFFSET_MET)
        *level = copysign(*level, offset->depth);
    else
        *level = copysign(offset->depth, *level);
}

/* Who goes far in a step is deep in what it meets before anybody knows: it finds springs as hard as
 * they become, and parts of steps for them. */
static void ask_for_parts(lar_body_contact *contact, double way) {
    static const double FAR = 0.1; /* of a layer */
    if (!contact->surface) return;
    const double layer = 2 * contact->surface->reach,
                 parts = contact->law.lead / contact->time_step;
    if (parts * way > FAR * layer)
        contact->need = fmax(contact->need, lar_contact_deep_need(&contact->law, layer, layer));
}

void lar_body_contact_moved(lar_body_contact *contact, lar_state *state, double way) {
    for (int32_t i = 0; i < contact->offset_count; i++)
        take_offset(&contact->offset[i], &state->level[contact->offset[i].node]);
    contact->offset_count = 0;
    if (contact->friction) lar_body_friction_keep(contact, state);
    contact->moved += way;
    contact->way = way;
    contact->info.way = fmax(contact->info.way, way);
    ask_for_parts(contact, way);
    if (!contact->search_state) return;
    /* Who does not have all nodes hears how fast the others are (contact_exchange.h). */
    contact->travel += way;
}

void lar_body_contact_forget(lar_body_contact *contact) {
    if (contact->search_state) contact->search_state->valid = false;
}

double lar_body_contact_nothing(const lar_body_contact *contact) {
    double mass = 0;
    if (!contact->surface) return 0;
    for (int32_t n = 0; n < contact->surface->node_count; n++)
        mass += contact->surface->node[n].mass;
    const double depth = fmax(1e-8 * contact->surface->reach, contact->surface->rounding);
    return 0.5 * contact->law.stiffness * mass * depth * depth;
}

/* ---- creation ------------------------------------------------------------------------------- */

static lar_status allocate(lar_body_contact *contact, const int32_t *local, lar_error *error) {
    lar_body_contact_search_state *search_state = contact->search_state;
    const lar_contact_surface *surface = &search_state->search->tree->surface;
    size_t nodes = (size_t)surface->node_count,
           groups = (size_t)search_state->search->list.group_room;
    size_t pairs = (size_t)search_state->search->list.face_room;
    int32_t *own = lar_calloc(nodes, sizeof *own);
    contact->view.local = search_state->local = own;
    search_state->x = lar_calloc(nodes, sizeof *search_state->x);
    search_state->searched = lar_calloc(nodes, sizeof *search_state->searched);
    contact->due = lar_calloc(groups, sizeof *contact->due);
    contact->last = lar_calloc(groups, sizeof *contact->last);
    contact->near = lar_calloc(groups, sizeof *contact->near);
    contact->away = lar_calloc(pairs, sizeof *contact->away);
    contact->part = lar_calloc(groups, sizeof *contact->part);
    contact->offset = lar_calloc(3 * groups, sizeof *contact->offset);
    if (!own || !search_state->x || !search_state->searched || !contact->due || !contact->last ||
        !contact->near || !contact->away || !contact->part || !contact->offset)
        return lar_fail_memory(error, groups * sizeof *contact->part, "contact of bodies");
    for (size_t n = 0; n < nodes; n++) own[n] = local[surface->node[n].node];
    return LAR_OK;
}

/* Of the stiffness that two rigid bodies bear: in a stack each bears springs above and below, of
 * its own nodes and points and of its neighbour's. Cubes of one element, 9/5 of their mass for a
 * face, go to and fro for ever from 5/6 on. */
static const double CHAINS = 0.75;

lar_status lar_body_contact_create(const lar_contact_tree *tree, const int32_t *local,
                                   double time_step, double stable_step, bool search_always,
                                   lar_body_contact *contact, lar_error *error) {
    *contact = (lar_body_contact){0};
    const lar_contact_surface *surface = &tree->surface;
    if (surface->node_count == 0) return LAR_OK;
    lar_body_contact_search_state *search_state = contact->search_state =
        lar_calloc(1, sizeof *search_state);
    if (search_state) search_state->search = lar_calloc(1, sizeof *search_state->search);
    if (!search_state || !search_state->search) {
        lar_body_contact_destroy(contact);
        return lar_fail_memory(error, sizeof *search_state->search, "contact of bodies");
    }
    lar_status status = lar_contact_search_create(tree, search_state->search, error);
    if (status) {
        lar_body_contact_destroy(contact);
        return status;
    }
    contact->law = lar_contact_law_for(time_step, stable_step);
    contact->rigid =
        CHAINS * lar_contact_law_for(time_step, INFINITY).stiffness / contact->law.stiffness;
    contact->time_step = time_step;
    contact->list = search_state->search->list;
    search_state->always = search_always;
    search_state->skin_min = 0.25 * surface->reach;
    search_state->skin_max = 2 * surface->reach_max;
    status = allocate(contact, local, error);
    if (!status) status = lar_body_friction_create(surface, contact, error);
    if (status)
        lar_body_contact_destroy(contact);
    else
        contact->surface = surface;
    return status;
}

void lar_body_contact_destroy(lar_body_contact *contact) {
    lar_body_contact_search_state *search_state = contact->search_state;
    lar_body_friction_destroy(contact);
    free(contact->due);
    free(contact->last);
    free(contact->near);
    free(contact->away);
    free(contact->part);
    free(contact->offset);
    if (search_state) {
        free(search_state->local);
        if (search_state->search) lar_contact_search_clear(search_state->search);
        free(search_state->search);
        free(search_state->x);
        free(search_state->searched);
        free(search_state);
    }
    *contact = (lar_body_contact){0};
}

/* ---- work ------------------------------------------------------------------------------------ */

void lar_body_contact_half_work(const lar_body_contact *contact,
                                const lar_condition_context *context, lar_state *state) {
    double power = 0, exchanged = 0;
    for (int32_t p = 0; p < contact->part_count; p++) {
        const lar_body_contact_part *part = &contact->part[p];
        for (int k = 0; k < part->count; k++) {
            double of_node = 0;
            for (int i = 0; i < 3; i++)
                of_node += part->force[k][i] * state->v[lar_state_at(state, part->node[k], i)];
            power += of_node;
            exchanged += fabs(of_node);
        }
    }
    state->contact -= 0.5 * context->mean_step * power;
    state->exchanged += 0.5 * context->mean_step * exchanged;
}
