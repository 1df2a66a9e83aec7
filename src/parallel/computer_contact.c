/* Contact of bodies on all processors: processor zero looks and searches between two stretches, and
 * everyone takes the same list (contact_exchange.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "parallel/computer.h"

/* Steps that a search should last, those that it must last besides the way of a stop, and those
 * that the next one may take, so that no stop is much longer than others. */
enum { SEARCH_STEPS = 200, MIN_STEPS = 16, PART_STEPS = 60 };

/* The part of what nodes may move, after which the next search begins. */
#define BEGIN_AT 0.75

/* Where nobody waits for it, it begins when they have moved by this part. */
#define AHEAD_AT 0.5

/* The part of what is left, after which somebody looks: that costs as much as half a step. */
#define LOOK_AT 0.7

/* What they may move at least, as a part of the least reach. */
#define LEAST 0.125

/* What is sent: the groups of the list, its faces and their gaps follow. */
typedef struct list_head {
    double skin, moved, travel;
    int32_t group_count, face_count; /* -1: the list stays */
} list_head;

/* ---- opening --------------------------------------------------------------------------------- */

static void list_elements(const lar_computer *computer, int32_t *elements, size_t *shift) {
    size_t layers = (size_t)lar_processor_layers(computer->interactions, computer->checking);
    for (int32_t p = 0; p < computer->division.grid.count; p++) {
        const lar_schedule *schedule = &computer->division.schedules.of[p];
        for (int32_t i = 0; i < schedule->element_count; i++) elements[schedule->element[i]] = p;
        shift[p] = computer->shift[p] + layers * (size_t)schedule->receive_bytes;
    }
}

lar_status lar_contact_open(lar_computer *computer, lar_error *error) {
    lar_computer_contact *contact = &computer->contact;
    const lar_body_contact *whole = &computer->interactions->body_contact;
    if (!whole->surface || computer->checking) return LAR_OK;
    const lar_model *model = computer->whole->model;
    size_t nodes = (size_t)whole->surface->node_count;
    size_t elements = (size_t)model->mesh.element_count;
    int32_t count = computer->division.grid.count;
    int32_t *owner = lar_calloc(elements, sizeof *owner);
    contact->shift = lar_calloc((size_t)count, sizeof *contact->shift);
    contact->x = lar_calloc(nodes, sizeof *contact->x);
    contact->searched = lar_calloc(nodes, sizeof *contact->searched);
    contact->allow = lar_calloc(nodes, sizeof *contact->allow);
    lar_status status = LAR_OK;
    if (!owner || !contact->shift || !contact->x || !contact->searched || !contact->allow)
        status = lar_fail_memory(error, 4 * elements + 56 * nodes, "contact of bodies");
    if (!status) status = lar_sudden_create(model, &contact->sudden, error);
    if (!status) {
        list_elements(computer, owner, contact->shift);
        status =
            lar_contact_map_create(model, whole->surface, count, owner, computer->division.reporter,
                                   contact->shift, &contact->map, error);
    }
    contact->search = whole->search_state->search;
    contact->always = whole->search_state->always;
    free(owner);
    return status;
}

void lar_contact_close(lar_computer *computer) {
    lar_computer_contact *contact = &computer->contact;
    lar_contact_map_clear(&contact->map);
    free(contact->shift);
    free(contact->x);
    free(contact->searched);
    free(contact->allow);
    lar_sudden_destroy(&contact->sudden);
    *contact = (lar_computer_contact){0};
}

/* ---- looking --------------------------------------------------------------------------------- */

/* Where a contact node is; returns what it goes in a step along an axis, at most. */
static double place_of(const lar_computer *computer, int32_t n, double x[3]) {
    const lar_contact_map *map = &computer->contact.map;
    const lar_state *state = computer->state;
    int32_t local;
    if (computer->control) {
        local = computer->whole->layout.local[map->surface->node[n].node];
    } else {
        const lar_processor *p = &computer->processor[map->reporter[n]];
        state = &p->worker[0].state;
        local = p->exchange->local[n];
    }
    return computer->whole->time_step * lar_contact_node_place(map->surface, n, state, local, x);
}

/* What nodes may move until all have stopped for a search, if they become fast meanwhile, and a
 * little more. */
static double reserve(const lar_computer *computer, double way) {
    double max = fmax(2 * way, LAR_CONTACT_SPEED * computer->whole->time_step);
    return (computer->division.spread + 3) * max + MIN_STEPS * way;
}

/* What nodes may still move until the list must be another one [m]. */
static double left_of(const lar_computer *computer, double moved, double reserved) {
    return 0.5 * computer->contact.skin - reserved - moved;
}

/* What has really moved since the search, as on a list on which all may move alike. Processes do
 * not have all nodes: for them that takes longer. */
static lar_contact_motion motion_of(const lar_computer *computer) {
    const lar_computer_contact *contact = &computer->contact;
    lar_contact_motion motion = lar_contact_no_motion();
    const double reserved = reserve(computer, contact->way);
    for (int32_t n = 0; n < contact->map.surface->node_count; n++) {
        double x[3], way = place_of(computer, n, x);
        lar_contact_motion_add(&motion, contact->searched[n], x, way, contact->allow[n], reserved);
    }
    return motion;
}

/* What follows from that: when somebody looks again. */
static void note_motion(lar_computer *computer, const lar_contact_motion *motion) {
    lar_computer_contact *contact = &computer->contact;
    contact->moved = lar_contact_motion_alike(motion, contact->skin);
    contact->steps = lar_contact_motion_steps(motion);
    const double left = left_of(computer, contact->moved, reserve(computer, contact->way));
    contact->looked = contact->moved;
    contact->look_at = contact->moved + (computer->control ? BEGIN_AT : LOOK_AT) * left;
}

static lar_status look(lar_computer *computer, lar_contact_motion *motion, lar_error *error) {
    lar_status status = computer->control ? lar_computer_gather(computer, error) : LAR_OK;
    if (status) return status;
    *motion = motion_of(computer);
    note_motion(computer, motion);
    return LAR_OK;
}

/* ---- handing out ----------------------------------------------------------------------------- */

/* What a processor does with a list, since the search of which nodes have gone as far as `travel`.
 */
static void take_list(lar_processor *p, const lar_contact_map *map, const lar_contact_list *list,
                      double moved, double travel) {
    if (list) lar_contact_compile(p, map, list);
    for (int32_t t = 0; t < p->thread_count; t++) {
        lar_body_contact *contact = &p->worker[t].interactions.body_contact;
        contact->moved = moved;
        if (list) contact->travel = travel;
    }
}

static lar_status send_list(lar_computer *computer, const lar_contact_list *list, double travel,
                            lar_error *error) {
    const double moved = computer->contact.moved;
    list_head head = {.moved = moved, .group_count = -1};
    size_t groups = 0, faces = 0;
    if (list) {
        head = (list_head){list->skin, moved, travel, list->group_count, list->face_count};
        groups = (size_t)list->group_count * sizeof *list->group;
        faces = (size_t)list->face_count * sizeof *list->face;
    }
    size_t gaps = faces / sizeof *list->face * sizeof *list->gap;
    size_t bytes = sizeof head + groups + faces + gaps;
    unsigned char *payload = lar_calloc_aligned(bytes, 1);
    if (!payload) return lar_fail_memory(error, bytes, "pairs in contact");
    memcpy(payload, &head, sizeof head);
    if (groups) memcpy(payload + sizeof head, list->group, groups);
    if (faces) memcpy(payload + sizeof head + groups, list->face, faces);
    if (gaps) memcpy(payload + sizeof head + groups + faces, list->gap, gaps);
    const lar_order order = {LAR_ORDER_CONTACT, 0};
    lar_status status = lar_control_order(computer->control, &order, payload, bytes, error);
    for (int32_t p = 1; p < computer->division.grid.count && !status; p++) {
        const lar_answer *answer;
        status = lar_control_hear(computer->control, p, &answer, NULL, error);
    }
    free(payload);
    return status;
}

/* NULL: the list stays. */
static lar_status hand_out(lar_computer *computer, const lar_contact_list *list, double travel,
                           lar_error *error) {
    for (int32_t i = 0; i < computer->hosted; i++)
        take_list(&computer->processor[i], &computer->contact.map, list, computer->contact.moved,
                  travel);
    return computer->control ? send_list(computer, list, travel, error) : LAR_OK;
}

static bool list_fits(const lar_contact_surface *surface, const lar_contact_list *list) {
    int64_t from = 0;
    for (int32_t g = 0; g < list->group_count; g++) {
        const lar_contact_group *group = &list->group[g];
        if (group->node < 0 || group->node >= surface->point_count || group->first != from ||
            group->count < 1 || group->count > LAR_GROUP_FACES_MAX)
            return false;
        from += group->count;
    }
    for (int32_t i = 0; i < list->face_count; i++)
        if (list->face[i] < 0 || list->face[i] >= surface->face_count) return false;
    return from == list->face_count;
}

lar_status lar_contact_execute(lar_computer *computer, const void *payload, size_t bytes,
                               lar_error *error) {
    const lar_contact_map *map = &computer->contact.map;
    list_head head = {0};
    if (bytes >= sizeof head) memcpy(&head, payload, sizeof head);
    bool fits = map->surface && bytes >= sizeof head && head.group_count >= -1;
    lar_contact_list list = {.skin = head.skin};
    if (fits && head.group_count >= 0) {
        /* Handed out again by each thread: nothing here is changed. */
        lar_contact_group *group = (lar_contact_group *)((uintptr_t)payload + sizeof head);
        list.group = group;
        list.group_count = head.group_count;
        list.face = (int32_t *)(group + head.group_count);
        list.face_count = head.face_count;
        list.gap = (float *)(list.face + head.face_count);
        const lar_contact_list *room = &computer->contact.search->list; /* of every thread, too */
        fits = head.face_count >= 0 && head.group_count <= room->group_room &&
               head.face_count <= room->face_room &&
               bytes == sizeof head + (size_t)head.group_count * sizeof *list.group +
                            (size_t)head.face_count * (sizeof *list.face + sizeof *list.gap) &&
               list_fits(map->surface, &list);
    }
    if (!fits)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor 0 sends pairs for contact that do not fit this model; start all "
                        "processors again, from the same installation");
    take_list(&computer->processor[0], map, head.group_count >= 0 ? &list : NULL, head.moved,
              head.travel);
    return LAR_OK;
}

/* ---- searching ------------------------------------------------------------------------------- */

/* With half of the skin, and again, until there is room for all pairs; but with what a step takes,
 * and some more, where that fits. */
static bool search_with(lar_computer_contact *contact, double skin, double way) {
    static const double STEP[] = {2, 1.5, 1.25, 1.1}; /* times what the fastest goes in one */
    const double(*x)[3] = (const double(*)[3])contact->x;
    const lar_contact_list *list = &contact->search->list;
    if (!lar_contact_search_run(contact->search, x, skin)) return false;
    double fits = list->skin;
    if (fits == skin) return true;
    for (int i = 0; i < 4 && 2 * STEP[i] * way > fits; i++) {
        double wanted = 2 * STEP[i] * way;
        if (!lar_contact_search_run(contact->search, x, wanted)) return false;
        if (list->skin == wanted) return true;
    }
    return list->skin == fits || lar_contact_search_run(contact->search, x, fits);
}

/* Fetches the places for a search, and says what each node may move until the next one: processes
 * would have to ask too often. Returns the skin. */
static double prepare(lar_computer *computer, double way) {
    lar_computer_contact *contact = &computer->contact;
    const lar_contact_surface *surface = contact->map.surface;
    double reserved = reserve(computer, way), room = way * SEARCH_STEPS,
           least = LEAST * surface->reach;
    room = fmin(fmax(room, least), surface->reach_max);
    for (int32_t n = 0; n < surface->node_count; n++) {
        float part = lar_contact_share_of(place_of(computer, n, contact->x[n]), way, least / room);
        contact->search->share[n] =
            computer->control ? 1 : (float)((reserved + (double)part * room) / (reserved + room));
    }
    return 2 * (reserved + room);
}

/* A search is done, since the places of which nodes have gone as far as `travel`, as far as is
 * known: everyone takes its list. */
static lar_status take_found(lar_computer *computer, double travel, lar_error *error) {
    lar_computer_contact *contact = &computer->contact;
    const lar_contact_list *list = &contact->search->list;
    const double begin = lar_clock_seconds();
    const size_t nodes = (size_t)contact->map.surface->node_count;
    memcpy(contact->searched, contact->x, nodes * sizeof *contact->x);
    memcpy(contact->allow, list->allow, nodes * sizeof *contact->allow);
    contact->skin = list->skin;
    contact->searching = false;
    contact->info.searches++;
    contact->info.boxed += (uint64_t)list->face_count;
    lar_contact_motion motion = {.farthest = travel, .spent = travel - 0.5 * contact->skin};
    if (!computer->control) motion = motion_of(computer);
    note_motion(computer, &motion);
    lar_status status = hand_out(computer, list, motion.farthest, error);
    contact->taking = lar_clock_seconds() - begin;
    return status;
}

static lar_status search(lar_computer *computer, double way, lar_fault *fault, lar_error *error) {
    lar_computer_contact *contact = &computer->contact;
    double skin = prepare(computer, way);
    contact->searching = false;
    if (!search_with(contact, skin, way)) {
        *fault = (lar_fault){.kind = LAR_FAULT_TOO_MANY_PAIRS,
                             .element = -1,
                             .step = computer->processor[0].worker[0].state.step};
        return LAR_OK;
    }
    contact->too_many_pairs = contact->search->list.skin < skin;
    contact->way = way;
    return take_found(computer, 0, error);
}

/* Where faces are so crowded that the list has no room for the skin that a stretch takes, all stop
 * after every round: then a list is good until half of its skin, as on one processor. */
static bool is_crowded(const lar_computer *computer) {
    const lar_computer_contact *contact = &computer->contact;
    return contact->too_many_pairs &&
           contact->moved + reserve(computer, contact->way) >= 0.5 * contact->skin;
}

/* Nodes that are to be looked for in this stop: as many as must be, when the time that is left is
 * to be enough for the others, and all when there is none. */
static int32_t portion(const lar_computer *computer) {
    const lar_computer_contact *contact = &computer->contact;
    double left = left_of(computer, contact->moved, reserve(computer, contact->way));
    if (!(left > 0)) return INT32_MAX;
    double steps = contact->steps;
    if (computer->control) steps = contact->way > 0 ? left / (1.25 * contact->way) : PART_STEPS;
    double stops = fmin(steps, PART_STEPS) / (double)(contact->stretch ? contact->stretch : 1);
    return (int32_t)(lar_contact_search_left(contact->search) / fmax(stops, 1)) + 1;
}

/* What follows from how far the search under way has come; its places are those of when nodes had
 * moved by `since`. */
static lar_status take_progress(lar_computer *computer, lar_contact_progress progress,
                                lar_error *error) {
    lar_computer_contact *contact = &computer->contact;
    switch (progress) {
    case LAR_SEARCH_UNDER_WAY:
        return LAR_OK;
    case LAR_SEARCH_DONE:
        /* Rounding of two sums of positive numbers, far more of them than there are steps. */
        return take_found(computer, contact->moved - contact->since + 1e-6 * contact->moved, error);
    case LAR_SEARCH_FULL:
        break;
    }
    contact->searching = contact->valid = false; /* from here, with a thinner skin */
    return LAR_OK;
}

/* Looks; and begins the next search, when nodes have moved by such a part of what they may. */
static lar_status look_and_begin(lar_computer *computer, double begin_at, lar_error *error) {
    lar_computer_contact *contact = &computer->contact;
    lar_contact_motion motion;
    lar_status status = look(computer, &motion, error);
    if (!status) status = hand_out(computer, NULL, 0, error);
    if (status || contact->searching || motion.used < begin_at) return status;
    lar_contact_search_begin(contact->search, (const double(*)[3])contact->x,
                             prepare(computer, motion.way));
    contact->since = contact->moved;
    contact->searching = true;
    return LAR_OK;
}

/* The next search begins before it is due, a part of it at every stop. */
static lar_status look_ahead(lar_computer *computer, lar_error *error) {
    lar_computer_contact *contact = &computer->contact;
    if (contact->too_many_pairs) return LAR_OK;
    contact->steps -= (double)contact->stretch;
    const bool blind = computer->control && contact->searching; /* gathering takes too long */
    lar_status status = LAR_OK;
    if (contact->moved > contact->look_at && !blind)
        status = look_and_begin(computer, computer->control ? 0.5 * BEGIN_AT : BEGIN_AT, error);
    if (status || !contact->searching) return status;
    return take_progress(computer, lar_contact_search_go_on(contact->search, portion(computer)),
                         error);
}

lar_status lar_contact_work_ahead(lar_computer *computer, double until, lar_error *error) {
    lar_computer_contact *contact = &computer->contact;
    if (!contact->map.surface || !contact->valid || contact->always || contact->too_many_pairs ||
        computer->control)
        return LAR_OK;
    lar_status status = LAR_OK;
    if (2 * contact->moved > contact->looked + contact->look_at)
        status = look_and_begin(computer, AHEAD_AT, error);
    if (status || !contact->searching) return status;
    const double after = 2 * contact->taking;
    return take_progress(computer, lar_contact_search_until(contact->search, until, after), error);
}

/* The list must be another one, or nodes have moved less than was feared. */
static lar_status renew(lar_computer *computer, bool due, bool crowded, lar_fault *fault,
                        lar_error *error) {
    lar_computer_contact *contact = &computer->contact;
    lar_contact_motion motion;
    lar_status status = look(computer, &motion, error);
    if (status) return status;
    contact->searching = false;
    if (crowded)
        due = due || !(motion.farthest < 0.25 * contact->skin);
    else
        due = due || !(motion.used < BEGIN_AT) ||
              !(left_of(computer, contact->moved, reserve(computer, motion.way)) > 0);
    if (due) return search(computer, motion.way, fault, error);
    return hand_out(computer, NULL, 0, error);
}

static bool is_late(const lar_computer *computer, bool crowded) {
    const lar_computer_contact *contact = &computer->contact;
    double reserved = crowded ? 0 : reserve(computer, contact->way);
    return !contact->valid || contact->always || !(left_of(computer, contact->moved, reserved) > 0);
}

lar_status lar_contact_refresh(lar_computer *computer, lar_fault *fault, lar_error *error) {
    lar_computer_contact *contact = &computer->contact;
    if (!contact->map.surface) return LAR_OK;
    lar_sudden_note(&contact->sudden, computer->tools, computer->processor[0].worker[0].state.step,
                    !contact->valid);
    bool crowded = is_crowded(computer), always = !contact->valid || contact->always;
    lar_status status = LAR_OK;
    if (!always && (contact->searching || !is_late(computer, crowded)))
        status = look_ahead(computer, error);
    if (!status && is_late(computer, crowded))
        status = renew(computer, !contact->valid || contact->always, crowded, fault, error);
    contact->valid = !status;
    return status;
}

uint64_t lar_contact_until(const lar_computer *computer, uint64_t step, uint64_t end) {
    const lar_computer_contact *contact = &computer->contact;
    if (!contact->map.surface) return end;
    if (contact->always || is_crowded(computer)) return step;
    return lar_sudden_next(&contact->sudden, computer->whole, step, end);
}

void lar_contact_count(lar_computer *computer, uint64_t steps) {
    lar_computer_contact *contact = &computer->contact;
    if (!contact->map.surface) return;
    contact->moved = computer->report.moved;
    contact->stretch = steps;
    contact->way = computer->report.way * computer->tools->division.parts; /* it is of a part */
    contact->info.steps += steps;
    contact->info.possible += steps * contact->map.surface->possible;
    lar_report_contact(&computer->report.contact, &contact->info);
}
