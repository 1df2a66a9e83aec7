#include "step/mass/measured.h"

#include <math.h>

#include "mechanics/hex8_guard.h"
#include "step/mass/compressible.h"
#include "step/mass/pressed.h"
#include "step/mass/strained.h"

/* What is found in a step counts from the next one on, until that is over or, where steps are not
 * divided and nothing is close to it, until the next interval is. */
enum { SEEN_IN_STEPS = 3 };

static double steps_ahead(const lar_domain *domain, const lar_state *state) {
    return state->close ? SEEN_IN_STEPS : fmax(SEEN_IN_STEPS, (double)domain->interval + 1);
}

/* Nodes of an element of less than this volume, squared, move against each other by more than a
 * tenth of its size in that time: what springs back when it is let go comes to its barriers from
 * where nobody looks. */
static double thrown_square(const lar_domain *domain, const lar_state *state, double parting) {
    double ahead = steps_ahead(domain, state) * domain->time_step;
    double square = 100 * parting * ahead * ahead;
    return square * square * square;
}

/* How stiff an element's barriers will be in `ahead` seconds if nothing stops these corners. */
static double barriers_ahead(const lar_domain *domain, const lar_state *state, lar_gid e,
                             double ahead, unsigned corners) {
    double rest[8][3], now[8][3], v[8][3];
    lar_guard then;
    lar_strained_corners(domain, state, e, rest, now, v);
    double *x = now[0];
    const double *speed = v[0];
    for (int i = 0; i < 24; i++) x[i] += ahead * speed[i];
    lar_hex8_guard_force((const double(*)[3])rest, (const double(*)[3])now, NULL,
                         lar_domain_material(domain, e), (lar_guard_lead){0}, corners, NULL, &then);
    return then.stiffness;
}

double lar_way_ahead(const lar_domain *domain, const lar_state *state) {
    bool known = state->strained->follows && state->listed;
    return known ? 1.75 * state->fastest * SEEN_IN_STEPS * domain->time_step : INFINITY;
}

/* How stiff the barriers are that lanes of a group with a bit in `coming` are coming to in `ahead`
 * seconds; no less than they are now. */
static void look_ahead(const lar_domain *domain, const lar_state *state, int32_t r,
                       const lar_strained_group *group, unsigned coming,
                       const double ahead[LAR_BLOCK], double stiffness[LAR_BLOCK]) {
    const lar_hex8_places places = {.stride = state->stride,
                                    .rest = domain->rest,
                                    .u = state->u,
                                    .v = state->v,
                                    .ahead = ahead};
    lar_hex8_corner_look look;
    coming &= domain->kernels->corners(&group->hex8, coming, &places, LAR_GUARD_SHARES, &look);
    for (; coming; coming &= coming - 1) {
        int k = __builtin_ctz(coming);
        unsigned corners = lar_corners_in_mesh(domain, r, group->lane[k], look.at[k]);
        stiffness[k] =
            fmax(stiffness[k], barriers_ahead(domain, state, group->element[k], ahead[k], corners));
    }
}

/* Elements of which more than their strain counts, and what is known of them. */
typedef struct measured_group {
    lar_strained_group lanes;
    unsigned moves, near, may_fold; /* bits: areas and speeds are asked for; a corner is below
                                       twice START; corners may come near a barrier */
    double stiffness[LAR_BLOCK];    /* of barriers that are at work [N/m] */
} measured_group;

/* A run's list of elements, while they are measured. */
typedef struct measured_list {
    const lar_domain *domain;
    const lar_hex8_monitor *monitor;
    lar_state *state;
    size_t first;          /* place of the run */
    int32_t run, material; /* which the last one had, -1: none yet */
    double faster;         /* its elements (domain.h) */
    lar_hex8_stiff stiff;
    measured_group group;
} measured_list;

static void take_material(measured_list *list, int32_t material) {
    if (material == list->material) return;
    list->material = material;
    list->faster = list->domain->faster[lar_factor_of(material)];
    lar_hex8_stiff_begin(&list->domain->material[material], &list->stiff);
}

/* lar_domain.area_limit: below LAR_STRAINED_AREA its areas count, and below 0 its tissue. */
static inline double limit_at(const lar_domain *domain, size_t place) {
    return domain->area_limit ? domain->area_limit[place] : LAR_STRAINED_AREA;
}
static inline bool is_flat(const lar_domain *domain, size_t place) {
    return limit_at(domain, place) < LAR_STRAINED_AREA;
}

/* How the square of an element's frequency has grown by its mean gradient. */
static double growth_of(const measured_list *list, size_t place,
                        const float strain[LAR_STRAIN_NUMBERS]) {
    const lar_domain *domain = list->domain;
    double growth = lar_hex8_growth(&list->stiff, strain[LAR_STRAIN_AREA] / 3.0);
    const double limit = limit_at(domain, place);
    if (!(limit < 0)) return growth;
    double exact = lar_compressible_growth(&domain->material[list->material], limit, strain);
    if (list->stiff.fibrous) exact += list->stiff.fibres / list->stiff.whole;
    return lar_greater(growth, exact);
}

/* How the square of a flat element's frequency has grown, with what its neighbours leave of it: its
 * areas as they are, not as those of a cube would be with such a strain. */
static double growth_of_flat(const measured_list *list, lar_gid e, size_t place, double areas) {
    const lar_domain *domain = list->domain;
    return domain->rate[e].share * lar_hex8_growth(&list->stiff, areas / domain->base[place].areas);
}

/* Whether stiffness is not negative and grows with areas, as its numbers do, step by step as they
 * are rounded. */
static bool grows(const lar_hex8_stiff *stiff) {
    return stiff->shear >= 0 && stiff->further >= 0;
}

/* How fast a strained element has become: (omega dt / 2)^2, if it is not heavier for a while. False
 * where that would have to be known and it is not: with `most` its areas may be less. Of what asks
 * for less than others have, and finds room in a whole step, it need not be known. */
static bool measure(measured_list *list, lar_gid e, size_t place, double stiffness, double areas,
                    bool most, const float strain[LAR_STRAIN_NUMBERS]) {
    const lar_domain *domain = list->domain;
    lar_state *state = list->state;
    const lar_element_rate *at_rest = &domain->rate[e];
    take_material(list, domain->model->element_material[e]);
    lar_hex8_stiff_of(&domain->material[list->material], strain, &list->stiff);
    double rate = list->faster * at_rest->square, flat = 0;
    double square = rate * growth_of(list, place, strain);
    if (stiffness != 0) square += (1 + 2 * LAR_BARRIER_LEAD) * stiffness / at_rest->mass;
    if (is_flat(domain, place)) {
        if (most && !grows(&list->stiff)) return false;
        flat = rate * growth_of_flat(list, e, place, areas);
    }
    bool by_areas = flat > square;
    double need = 0.25 * domain->time_step * domain->time_step * (by_areas ? flat : square);
    if (!(need >= 0)) need = INFINITY; /* a corner that is a point has no number */
    bool pressed = state->needs && state->pressed[e];
    if (need <= state->need && need <= domain->room.max && !pressed) return true;
    if (by_areas && most) return false;
    if (!(need <= state->need)) state->need = need;
    if (state->needs) lar_pressed_need(domain, e, need, state);
    return true;
}

/* Whether an element, a flat one with no more than these areas, asks for no more than others have
 * and finds room in a whole step: then it does not matter how much that is. */
static inline bool asks_for_little(measured_list *list, lar_gid e, size_t place, double limit,
                                   double areas, const float strain[LAR_STRAIN_NUMBERS]) {
    if (limit < 0) return false;
    const lar_domain *domain = list->domain;
    const lar_state *state = list->state;
    const lar_hex8_stiff *stiff = &list->stiff;
    take_material(list, domain->model->element_material[e]);
    lar_hex8_stiff_of(&domain->material[list->material], strain, &list->stiff);
    double area = strain[LAR_STRAIN_AREA] / 3.0;
    if (limit < LAR_STRAINED_AREA) area = lar_greater(area, areas / domain->base[place].areas);
    double rate = list->faster * domain->rate[e].square;
    double square = rate * lar_hex8_growth(stiff, area);
    double need = 0.25 * domain->time_step * domain->time_step * square;
    return need <= state->need && need <= domain->room.max && grows(stiff) &&
           !(state->needs && state->pressed[e]);
}

/* How lanes of the group move that have a bit: their areas are then known for a while. */
static void look_at_motion(const measured_list *list, unsigned lanes, lar_hex8_motion *motion) {
    const lar_domain *domain = list->domain;
    const lar_state *state = list->state;
    const measured_group *group = &list->group;
    const lar_hex8_places places = {.stride = state->stride, .rest = domain->rest, .u = state->u};
    if (!lanes) return;
    domain->kernels->motion(&group->lanes.hex8, lanes, &places, group->may_fold ? state->v : NULL,
                            motion);
    for (; lanes; lanes &= lanes - 1) {
        int k = __builtin_ctz(lanes);
        double way = lar_hex8_steady_way(motion->areas[k], motion->longest[k]);
        lar_steady *steady = &state->strained->steady[list->first + (size_t)group->lanes.lane[k]];
        steady->areas = LAR_HEX8_STEADY * motion->areas[k];
        steady->until = state->strained->travel + way;
    }
}

/* Measures lanes of the group, of which `moved` have been looked at. Returns those where that has
 * to be done first. */
static unsigned measure_lanes(measured_list *list, unsigned lanes, unsigned moved,
                              const lar_hex8_motion *motion) {
    const measured_group *group = &list->group;
    unsigned left = 0;
    for (; lanes; lanes &= lanes - 1) {
        int k = __builtin_ctz(lanes);
        bool known = moved >> k & 1;
        size_t place = list->first + (size_t)group->lanes.lane[k];
        double areas = known ? motion->areas[k] : list->state->strained->steady[place].areas;
        if (!measure(list, group->lanes.element[k], place, group->stiffness[k], areas, !known,
                     list->monitor->strain[group->lanes.entry[k]]))
            left |= 1U << k;
    }
    return left;
}

static void measure_group(measured_list *list) {
    const lar_domain *domain = list->domain;
    const lar_state *state = list->state;
    measured_group *group = &list->group;
    lar_strained_group *lanes = &group->lanes;
    double ahead[LAR_BLOCK] __attribute__((aligned(64))) = {0};
    lar_hex8_motion motion;
    unsigned coming = 0;
    if (lanes->count == 0) return;
    unsigned all = lar_group_fill(lanes);
    look_at_motion(list, group->moves, &motion);
    for (int k = 0; k < lanes->count; k++) {
        double volume = domain->base[list->first + (size_t)lanes->lane[k]].volume;
        if (group->near >> k & 1)
            ahead[k] = SEEN_IN_STEPS * domain->time_step;
        else if (group->may_fold >> k & 1 &&
                 thrown_square(domain, state, motion.parting[k]) > volume * volume)
            ahead[k] = steps_ahead(domain, state) * domain->time_step;
        if (ahead[k] > 0) coming |= 1U << k;
    }
    if (coming) look_ahead(domain, state, list->run, lanes, coming, ahead, group->stiffness);
    unsigned left = measure_lanes(list, all, group->moves, &motion);
    look_at_motion(list, left, &motion);
    measure_lanes(list, left, left, &motion);
    lanes->count = 0;
    group->moves = group->near = group->may_fold = 0;
}

/* Whether an element's areas need not be looked at yet. */
static bool is_steady(const lar_strained *strained, size_t place) {
    return strained->follows && strained->travel < strained->steady[place].until;
}

/* Into the group, which is measured when it is full. */
static void measure_later(measured_list *list, int32_t entry, bool near, bool may_fold, bool moves,
                          double stiffness) {
    measured_group *group = &list->group;
    int k = group->lanes.count;
    group->stiffness[k] = stiffness;
    group->near |= (unsigned)near << k;
    group->may_fold |= (unsigned)may_fold << k;
    group->moves |= (unsigned)moves << k;
    lar_group_add(list->domain, list->run, list->monitor->lane[entry] & ~LAR_LANE_FLAT, entry,
                  &group->lanes);
    if (group->lanes.count == LAR_BLOCK) measure_group(list);
}

/* Those near a barrier, which ask for most, so that less need be known of the others. */
static void measure_near(measured_list *list) {
    const lar_strained *strained = list->state->strained;
    const int32_t *near = strained->near + list->first, *lane = list->monitor->lane;
    for (int32_t i = 0, k = 0; k < strained->count[list->run]; i++) {
        if (lane[i] != near[k]) continue;
        double stiffness = strained->stiffness[list->first + (size_t)k++];
        size_t place = list->first + (size_t)lane[i];
        bool moves = is_flat(list->domain, place) && !is_steady(strained, place);
        if (stiffness != LAR_BARRIER_FAR) measure_later(list, i, true, false, moves, stiffness);
    }
    measure_group(list);
}

/* No corners part faster than this, where it is known [m^2/s^2]. */
static double parting_max(const lar_state *state) {
    return state->strained->follows && state->listed ? 12.0001 * state->fastest * state->fastest
                                                     : INFINITY;
}

void lar_measure_strained(const lar_domain *domain, const lar_hex8_monitor *monitor, int32_t r,
                          lar_state *state) {
    const lar_strained *strained = state->strained;
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    const int32_t *near = strained->near + first, *end = near + strained->count[r];
    const double *stiffness = strained->stiffness + first;
    double thrown = thrown_square(domain, state, parting_max(state));
    measured_list list = {.domain = domain,
                          .monitor = monitor,
                          .state = state,
                          .first = first,
                          .run = r,
                          .material = -1};
    measure_near(&list);
    for (int32_t i = 0; i < monitor->count; i++) {
        uint32_t listed = (uint32_t)monitor->lane[i], lane = listed & ~(uint32_t)LAR_LANE_FLAT;
        lar_gid e = lar_lane_element(domain, r, lane);
        size_t place = first + lane;
        if (e < 0) continue;
        bool is_near = near < end && *near == (int32_t)lane;
        if (is_near && *stiffness++ != LAR_BARRIER_FAR) {
            near++;
            continue;
        }
        near += is_near;
        double volume = domain->base[place].volume;
        bool may_fold = !is_near && lane == listed && thrown > volume * volume;
        double limit = limit_at(domain, place);
        bool flat = limit < LAR_STRAINED_AREA, moves = flat && !is_steady(strained, place);
        double areas = flat ? strained->steady[place].areas : 0;
        if (!may_fold && !moves &&
            (asks_for_little(&list, e, place, limit, areas, monitor->strain[i]) ||
             measure(&list, e, place, 0, areas, true, monitor->strain[i])))
            continue;
        measure_later(&list, i, false, may_fold, may_fold || flat, 0);
    }
    measure_group(&list);
}
