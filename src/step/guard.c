#include "step/guard.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/hex8_guard.h"
#include "step/mass/heavier.h"
#include "step/mass/pressed.h"

/* Elements are listed when a corner is no farther from its barrier than twice START. That no corner
 * comes there before the next list is made is no theorem: in fast pushes with tools at 1.6 m/s the
 * least corner that was not listed stood at 0.48. */
static const double SHARES[2] = {LAR_GUARD_START, 2 * LAR_GUARD_START};

/* Part of the step by which the damping leads; it counts twice beside the spring (theory.md 10). */
static const double LEAD = 0.5;

lar_status lar_strained_create(const lar_domain *domain, lar_strained *strained, lar_error *error) {
    size_t lanes = LAR_BLOCK * (size_t)domain->layout.block_count;
    size_t runs = (size_t)domain->run_count;
    *strained = (lar_strained){.lane = lar_calloc(lanes, sizeof *strained->lane),
                               .count = lar_calloc(runs, sizeof *strained->count),
                               .listed_count = lar_calloc(runs, sizeof *strained->count),
                               .strain = lar_calloc(lanes, sizeof *strained->strain),
                               .near = lar_calloc(lanes, sizeof *strained->near),
                               .stiffness = lar_calloc(lanes, sizeof *strained->stiffness),
                               .sound = lar_calloc(lanes, sizeof *strained->sound),
                               .damped = lar_calloc(lanes, sizeof *strained->damped),
                               .damped_count = lar_calloc(runs, sizeof *strained->damped_count),
                               .lacked = lar_calloc(lanes, sizeof *strained->lacked),
                               .lacked_count = lar_calloc(runs, sizeof *strained->lacked_count)};
    strained->follows = domain->layout.thread_count == 1;
    bool active = lar_model_active(domain->model) != NULL;
    size_t elements = (size_t)domain->model->mesh.element_count;
    strained->pressed = lar_calloc(elements, sizeof *strained->pressed);
    strained->beyond = lar_calloc(lanes / LAR_BLOCK, sizeof *strained->beyond);
    if (active) {
        strained->activation = lar_calloc_aligned(lanes, sizeof *strained->activation);
        strained->active_energy = lar_calloc_aligned(lanes, sizeof *strained->active_energy);
    }
    if (strained->lane && strained->count && strained->listed_count && strained->strain &&
        strained->near && strained->stiffness && strained->sound && strained->damped &&
        strained->damped_count && strained->lacked && strained->lacked_count && strained->pressed &&
        strained->beyond && (!active || (strained->activation && strained->active_energy)))
        return LAR_OK;
    lar_strained_destroy(strained);
    size_t each = 3 * sizeof *strained->lane + sizeof *strained->strain +
                  2 * sizeof *strained->sound + sizeof *strained->damped;
    return lar_fail_memory(error, lanes * each, "the strained elements");
}

void lar_strained_destroy(lar_strained *strained) {
    free(strained->lane);
    free(strained->count);
    free(strained->listed_count);
    free(strained->strain);
    free(strained->near);
    free(strained->stiffness);
    free(strained->sound);
    free(strained->damped);
    free(strained->damped_count);
    free(strained->lacked);
    free(strained->lacked_count);
    free(strained->activation);
    free(strained->active_energy);
    free(strained->pressed);
    free(strained->beyond);
    *strained = (lar_strained){0};
}

/* Where the corners of an element are at rest and now, and how fast they are (`v` may be NULL). */
static void corners_of(const lar_domain *domain, const lar_state *state, lar_gid e,
                       double rest[8][3], double now[8][3], double v[8][3]) {
    const lar_mesh *mesh = &domain->model->mesh;
    for (int a = 0; a < 8; a++) {
        lar_gid node = mesh->element[e][a];
        lar_lid local = domain->layout.local[node];
        for (int i = 0; i < 3; i++) {
            size_t at = lar_state_at(state, local, i);
            rest[a][i] = mesh->position[node][i];
            now[a][i] = state->u[at] + rest[a][i];
            if (v) v[a][i] = state->v[at];
        }
    }
}

/* Strained elements of a run that are looked at side by side. */
typedef struct strained_group {
    lar_hex8_group hex8;
    int count;
    int32_t lane[LAR_BLOCK];  /* block * 8 + lane */
    int32_t entry[LAR_BLOCK]; /* of a list */
    lar_gid element[LAR_BLOCK];
} strained_group;

static lar_gid element_of(const lar_domain *domain, int32_t r, int32_t lane) {
    const lar_lanes *block = domain->layout.block + domain->run_first[r] + lane / LAR_BLOCK;
    return block->element[lane % LAR_BLOCK];
}

static bool is_there(const lar_domain *domain, int32_t r, int32_t lane) {
    return element_of(domain, r, lane) >= 0;
}

static void add_lane(const lar_domain *domain, int32_t r, int32_t lane, int32_t entry,
                     strained_group *group) {
    const lar_block_run *run = &domain->run[r];
    int32_t block = lane / LAR_BLOCK, at = group->count++;
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    int32_t node[8];
    lar_run_nodes(run, block, lane % LAR_BLOCK, node);
    for (int a = 0; a < 8; a++) group->hex8.node[a][at] = node[a];
    group->hex8.largest[at] = domain->base[first + (size_t)lane].largest;
    group->lane[at] = lane;
    group->entry[at] = entry;
    group->element[at] = element_of(domain, r, lane);
}

/* All lanes are computed with. */
static unsigned fill_up(strained_group *group) {
    for (int at = group->count; at < LAR_BLOCK; at++) {
        for (int a = 0; a < 8; a++) group->hex8.node[a][at] = group->hex8.node[a][0];
        group->hex8.largest[at] = 0;
    }
    return (1U << group->count) - 1;
}

/* Corners of a lane of run r as the mesh counts them: forces of several are added in that order. */
static unsigned corners_in_mesh(const lar_domain *domain, int32_t r, int32_t lane, unsigned at) {
    uint32_t corner = domain->base[LAR_BLOCK * domain->run_first[r] + lane].corner;
    unsigned in_mesh = 0;
    for (; at; at &= at - 1) in_mesh |= 1u << (corner >> 4 * __builtin_ctz(at) & 7);
    return in_mesh;
}

/* What is found in a step counts from the next one on, until that is over or, where steps are not
 * divided and nothing is close to it, until the next interval is. */
enum { SEEN_IN_STEPS = 3 };

static double steps_ahead(const lar_domain *domain, const lar_state *state) {
    return state->close ? SEEN_IN_STEPS : fmax(SEEN_IN_STEPS, (double)domain->interval + 1);
}

/* Whether nodes of an element move against each other by more than a tenth of its size in that
 * time: what springs back when it is let go comes to its barriers from where nobody looks. */
static bool is_thrown(const lar_domain *domain, const lar_state *state, double parting,
                      double volume) {
    double ahead = steps_ahead(domain, state) * domain->time_step;
    double square = 100 * parting * ahead * ahead;
    return square * square * square > volume * volume;
}

/* How stiff an element's barriers will be in `ahead` seconds if nothing stops these corners. */
static double barriers_ahead(const lar_domain *domain, const lar_state *state, lar_gid e,
                             double ahead, unsigned corners) {
    double rest[8][3], now[8][3], v[8][3];
    lar_guard then;
    corners_of(domain, state, e, rest, now, v);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) now[a][i] += ahead * v[a][i];
    lar_hex8_guard_force((const double(*)[3])rest, (const double(*)[3])now, NULL,
                         lar_domain_material(domain, e), (lar_guard_lead){0}, corners, NULL, &then);
    return then.stiffness;
}

/* How the square of a flat element's frequency has grown, with what its neighbours leave of it: its
 * areas as they are, not as those of a cube would be with such a strain. 0 for others. */
static double growth_of_flat(const lar_domain *domain, lar_gid e, size_t place, double areas,
                             const lar_hex8_stiff *stiff) {
    if (!domain->area_limit || !(domain->area_limit[place] < LAR_STRAINED_AREA)) return 0;
    return domain->rate[e].share * lar_hex8_growth(stiff, areas / domain->base[place].areas);
}

/* In whole units, which sum to nothing. */
static void add(const lar_domain *domain, lar_gid e, const double force[8][3], lar_state *state) {
    int64_t whole[8][3], sum[3] = {0};
    for (int a = 0; a < 7; a++)
        for (int i = 0; i < 3; i++) {
            double units = force[a][i] * domain->scale;
            if (!(fabs(units) < 0x1p56)) return; /* a run that is about to break */
            whole[a][i] = llrint(units);
            sum[i] += whole[a][i];
        }
    for (int i = 0; i < 3; i++) whole[7][i] = -sum[i];
    for (int a = 0; a < 8; a++) {
        lar_lid node = domain->layout.local[domain->model->mesh.element[e][a]];
        for (int i = 0; i < 3; i++) {
            int64_t *to = &state->force[lar_state_at(state, node, i)];
            *to = (int64_t)((uint64_t)*to + (uint64_t)whole[a][i]);
        }
    }
}

/* A barrier is no harder than the step bears: one that has just been met is as hard as it should be
 * after the next decision about parts of steps, and one that would ask for more parts than there
 * can be never is. Returns which part of it. */
static double soften(const lar_domain *domain, lar_gid e, double stiffness, double step,
                     double mean, double force[8][3]) {
    static const double ROOM = 1; /* of (omega dt / 2)^2 */
    double rate =
        (1 + 2 * LEAD) * stiffness / (domain->rate[e].mass * lar_burden_factor(domain, e));
    double takes = 0.25 * mean * fmax(mean, step) * rate;
    if (!(takes > ROOM)) return 1;
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) force[a][i] *= ROOM / takes;
    return ROOM / takes;
}

/* Half of the work of what an element was damped with: contact takes it. What a barrier lacks that
 * is softer than its energy says is done to the body from outside. */
static bool add_half_work(const double rest[8][3], const double now[8][3], const double v[8][3],
                          const lar_damped *damped, lar_state *state) {
    double damper[8], lack[8];
    bool lacks = false;
    for (int a = 0; a < 8; a++) {
        damper[a] = (double)damped->damper[a];
        lack[a] = (double)damped->lack[a];
        lacks = lacks || lack[a] != 0;
    }
    state->contact += (double)damped->half_mean * lar_hex8_guard_power(rest, now, v, damper);
    if (lacks)
        state->external += (double)damped->half_mean * lar_hex8_guard_power(rest, now, v, lack);
    return lacks;
}

/* The energy of an element's barriers, and its change with time when they move with v [J/s]. */
__attribute__((cold)) static double rise_of(const lar_material *material, const double rest[8][3],
                                            const double place[8][3], const double v[8][3],
                                            double *energy) {
    double force[8][3] = {{0}}, power = 0;
    lar_guard guard;
    lar_hex8_guard_force(rest, place, NULL, material, (lar_guard_lead){0}, LAR_ALL_CORNERS, force,
                         &guard);
    for (int a = 0; a < 8; a++) power += lar_dot(force[a], v[a]);
    *energy = guard.energy;
    return power;
}

/* What a barrier lacks is counted by its slopes at both ends of a step, each for the time that its
 * force acts. Where it comes up within one, that is far from what its energy becomes, and the rest
 * is done from outside as well. Nodes went from `then` to `now` with v. */
__attribute__((cold)) static void add_rise(const lar_material *material, const double rest[8][3],
                                           const double then[8][3], const double now[8][3],
                                           const double v[8][3], const double acts[2],
                                           lar_state *state) {
    double before, after;
    double slopes = acts[0] * rise_of(material, rest, then, v, &before);
    slopes += acts[1] * rise_of(material, rest, now, v, &after);
    state->external += after - before - 0.5 * slopes;
}

/* The same before a barrier is softer for the first time. */
__attribute__((cold)) static void add_first_rise(const lar_material *material,
                                                 const double rest[8][3], const double now[8][3],
                                                 const double v[8][3], double mean,
                                                 lar_state *state) {
    double then[8][3];
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) then[a][i] = now[a][i] - state->past * v[a][i];
    add_rise(material, rest, (const double(*)[3])then, now, v, (double[]){state->past, mean},
             state);
}

/* For how long forces act now [s]. */
static double mean_step(const lar_domain *domain, const lar_state *state) {
    double step = domain->time_step / state->parts;
    return state->past > 0 ? 0.5 * (state->past + step) : step;
}

/* Returns whether barriers are at work. What damps has half of its work done with the velocities
 * before the nodes move; `damped` says what the other half comes from, NULL: nothing counts. What
 * opens is damped as in a whole step: it gives back no more than it took while the step was not
 * divided yet. (A damper that never pulls cannot make a corner swing, however much it leads.) */
static bool apply(const lar_domain *domain, lar_gid e, unsigned corners, bool lacked,
                  lar_damped *damped, lar_state *state, double *stiffness) {
    double rest[8][3], now[8][3], v[8][3], force[8][3] = {{0}};
    double step = domain->time_step / state->parts;
    double mean = mean_step(domain, state);
    const lar_guard_lead lead = {.closing = LEAD * step, .opening = LEAD * domain->time_step};
    lar_guard guard;
    corners_of(domain, state, e, rest, now, v);
    lar_hex8_guard_force((const double(*)[3])rest, (const double(*)[3])now, (const double(*)[3])v,
                         lar_domain_material(domain, e), lead, corners, force, &guard);
    if (stiffness) *stiffness = guard.stiffness;
    if (!(guard.min < LAR_GUARD_START)) return false;
    if (state->lets_go) {
        if (damped) *damped = (lar_damped){.element = e, .step = (float)step, .gone = true};
        return true;
    }
    double part = soften(domain, e, guard.stiffness, step, mean, force);
    add(domain, e, (const double(*)[3])force, state);
    if (!damped) return true;
    *damped = (lar_damped){.element = e, .step = (float)step, .half_mean = (float)(0.5 * mean)};
    for (int a = 0; a < 8; a++) {
        damped->damper[a] = (float)(part * guard.damper[a]);
        damped->lack[a] = (float)((1 - part) * guard.slope[a]);
    }
    add_half_work((const double(*)[3])rest, (const double(*)[3])now, (const double(*)[3])v, damped,
                  state);
    if (part < 1 && !lacked && state->past > 0)
        add_first_rise(lar_domain_material(domain, e), (const double(*)[3])rest,
                       (const double(*)[3])now, (const double(*)[3])v, mean, state);
    return true;
}

/* Energies count barriers, there or not: what those of an element that are gone would have had done
 * on them in a step comes from outside. */
__attribute__((cold)) static void add_difference(const lar_material *material,
                                                 const double rest[8][3], const double then[8][3],
                                                 const double now[8][3], lar_state *state) {
    lar_guard before, after;
    lar_hex8_guard(rest, then, material, &before);
    lar_hex8_guard(rest, now, material, &after);
    state->external += after.energy - before.energy;
}

/* Where the nodes of an element are, were before they moved the last time, and how fast. */
typedef struct step_back {
    double rest[8][3], now[8][3], then[8][3], v[8][3];
} step_back;

static void look_back(const lar_domain *domain, const lar_damped *damped, const lar_state *state,
                      step_back *back) {
    corners_of(domain, state, damped->element, back->rest, back->now, back->v);
    for (int a = 0; a < 8; a++)
        for (int k = 0; k < 3; k++)
            back->then[a][k] = back->now[a][k] - (double)damped->step * back->v[a][k];
}

/* The other half of the work of what damped an element, now that its nodes have moved. Returns
 * whether its barriers lacked something. */
static bool finish(const lar_domain *domain, const lar_damped *damped, const step_back *back,
                   lar_state *state) {
    const double(*rest)[3] = (const double(*)[3])back->rest,
          (*then)[3] = (const double(*)[3])back->then;
    if (!damped->gone) return add_half_work(rest, then, (const double(*)[3])back->v, damped, state);
    add_difference(lar_domain_material(domain, damped->element), rest, then,
                   (const double(*)[3])back->now, state);
    return false;
}

/* The same of run r. Corners that swing from step to step would be said to lose more than they do
 * by the velocities before it alone. */
static void finish_damping(const lar_domain *domain, int32_t r, lar_state *state) {
    lar_strained *strained = state->strained;
    int32_t *lacked = strained->lacked + LAR_BLOCK * (size_t)domain->run_first[r];
    strained->lacked_count[r] = 0;
    const lar_damped *damped = strained->damped + LAR_BLOCK * (size_t)domain->run_first[r];
    for (int32_t i = 0; i < strained->damped_count[r] && state->listed; i++) {
        step_back back;
        look_back(domain, &damped[i], state, &back);
        if (!finish(domain, &damped[i], &back, state)) continue;
        add_rise(lar_domain_material(domain, damped[i].element), (const double(*)[3])back.rest,
                 (const double(*)[3])back.then, (const double(*)[3])back.now,
                 (const double(*)[3])back.v,
                 (double[]){2 * (double)damped[i].half_mean, mean_step(domain, state)}, state);
        lacked[strained->lacked_count[r]++] = damped[i].element;
    }
    strained->damped_count[r] = 0;
}

/* (What a barrier that lacks something rises by is left to the step that follows: it takes it for
 * one that is softer for the first time.) */
void lar_guard_half_to_come(const lar_domain *domain, const lar_state *state, double *contact,
                            double *external) {
    const lar_strained *strained = state->strained;
    lar_state own = *state;
    if (!strained || !state->listed) return;
    own.contact = own.external = 0;
    for (int32_t r = 0; r < domain->run_count; r++) {
        const lar_damped *damped = strained->damped + LAR_BLOCK * (size_t)domain->run_first[r];
        for (int32_t i = 0; i < strained->damped_count[r]; i++) {
            step_back back;
            look_back(domain, &damped[i], state, &back);
            finish(domain, &damped[i], &back, &own);
        }
    }
    *contact += own.contact;
    *external += own.external;
}

/* A corner's volume changes by no more than (L + 2 d)^3 - L^3 while its nodes go d, with edges of L
 * at most; that is below 7.28 L^2 d for d up to L / 10. So far may nodes go. */
static double may_go(double above, double longest) {
    return above > 0 ? fmin(0.1 * sqrt(longest), above / (7.28 * longest)) : 0;
}

/* They are few. */
static bool is_among(lar_gid e, const int32_t *list, int32_t count) {
    for (int32_t i = 0; i < count; i++)
        if (list[i] == e) return true;
    return false;
}

/* Looks at the corners of a group, which is empty then: adds the forces of their barriers. With
 * `lists` the lanes with a corner below twice START are listed. */
static void apply_group(const lar_domain *domain, int32_t r, bool lists, strained_group *group,
                        lar_state *state) {
    lar_strained *strained = state->strained;
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    int32_t *count = &strained->count[r], *damped = &strained->damped_count[r];
    const lar_hex8_places places = {.stride = state->stride, .rest = domain->rest, .u = state->u};
    lar_hex8_corner_look look;
    unsigned below = domain->kernels->corners(&group->hex8, fill_up(group), &places, SHARES, &look);
    for (int k = 0; k < group->count; k++) {
        size_t place = first + (size_t)group->lane[k];
        double stiffness = 0;
        strained->sound[place] = strained->travel + may_go(look.above[k], look.longest[k]);
        if (below >> k & 1) {
            unsigned corners = corners_in_mesh(domain, r, group->lane[k], look.at[k]);
            bool lacked =
                is_among(group->element[k], strained->lacked + first, strained->lacked_count[r]);
            *damped += apply(domain, group->element[k], corners, lacked,
                             &strained->damped[first + (size_t)*damped], state, &stiffness);
        }
        if (!lists || !(below >> (k + LAR_BLOCK) & 1)) continue;
        strained->near[first + (size_t)*count] = group->lane[k];
        strained->stiffness[first + (size_t)(*count)++] = stiffness;
    }
    group->count = 0;
}

/* The same of all that are listed, but not for being flat alone: their corners are far from the
 * barrier. Where it is known how far nodes can have gone, corners that cannot be near one are not
 * looked at. */
static void apply_list(const lar_domain *domain, int32_t r, const int32_t *list, int32_t count,
                       lar_state *state) {
    lar_strained *strained = state->strained;
    const double *sound = strained->sound + LAR_BLOCK * (size_t)domain->run_first[r];
    strained_group group = {.count = 0};
    strained->count[r] = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t lane = list[i];
        if (lane & LAR_LANE_FLAT || !is_there(domain, r, lane)) continue;
        if (strained->follows && strained->travel < sound[lane]) continue;
        add_lane(domain, r, lane, i, &group);
        if (group.count == LAR_BLOCK) apply_group(domain, r, true, &group, state);
    }
    if (group.count > 0) apply_group(domain, r, true, &group, state);
}

/* How stiff the barriers are that lanes of a group with a bit in `coming` are coming to in `ahead`
 * seconds; no less than they are now. */
static void look_ahead(const lar_domain *domain, const lar_state *state, int32_t r,
                       const strained_group *group, unsigned coming, const double ahead[LAR_BLOCK],
                       double stiffness[LAR_BLOCK]) {
    const lar_hex8_places places = {.stride = state->stride,
                                    .rest = domain->rest,
                                    .u = state->u,
                                    .v = state->v,
                                    .ahead = ahead};
    lar_hex8_corner_look look;
    coming &= domain->kernels->corners(&group->hex8, coming, &places, SHARES, &look);
    for (; coming; coming &= coming - 1) {
        int k = __builtin_ctz(coming);
        unsigned corners = corners_in_mesh(domain, r, group->lane[k], look.at[k]);
        stiffness[k] =
            fmax(stiffness[k], barriers_ahead(domain, state, group->element[k], ahead[k], corners));
    }
}

/* How fast a strained element has become: (omega dt / 2)^2, if it is not heavier for a while. */
static void measure(const lar_domain *domain, lar_gid e, size_t place, double stiffness,
                    double areas, const float strain[LAR_STRAIN_NUMBERS], lar_state *state) {
    double faster = domain->faster[lar_factor_of(domain->model->element_material[e])];
    double rate = faster * domain->rate[e].square;
    lar_hex8_stiff stiff;
    lar_hex8_stiff_of(lar_domain_material(domain, e), strain, &stiff);
    double square = rate * lar_hex8_growth(&stiff, strain[LAR_STRAIN_AREA] / 3.0);
    square += (1 + 2 * LEAD) * stiffness / domain->rate[e].mass;
    double flat = rate * growth_of_flat(domain, e, place, areas, &stiff);
    if (flat > square) square = flat;
    double need = 0.25 * domain->time_step * domain->time_step * square;
    if (!(need >= 0)) need = INFINITY; /* a corner that is a point has no number */
    if (!(need <= state->need)) state->need = need;
    if (state->needs) lar_pressed_need(domain, e, need, state);
}

/* Elements of which more than their strain counts, and what is known of them. */
typedef struct measured_group {
    strained_group lanes;
    unsigned moves, near, may_fold; /* bits: areas and speeds are asked for; a corner is below
                                       twice START; corners may come near a barrier */
    double stiffness[LAR_BLOCK];    /* of barriers that are at work [N/m] */
} measured_group;

static void measure_group(const lar_domain *domain, const lar_hex8_monitor *monitor, int32_t r,
                          measured_group *group, lar_state *state) {
    strained_group *lanes = &group->lanes;
    const lar_hex8_places places = {.stride = state->stride, .rest = domain->rest, .u = state->u};
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    double ahead[LAR_BLOCK] __attribute__((aligned(64))) = {0};
    lar_hex8_motion motion = {{0}, {0}};
    unsigned coming = 0;
    fill_up(lanes);
    if (group->moves)
        domain->kernels->motion(&lanes->hex8, group->moves, &places,
                                group->may_fold ? state->v : NULL, &motion);
    for (int k = 0; k < lanes->count; k++) {
        double volume = domain->base[first + (size_t)lanes->lane[k]].volume;
        if (group->near >> k & 1)
            ahead[k] = SEEN_IN_STEPS * domain->time_step;
        else if (group->may_fold >> k & 1 && is_thrown(domain, state, motion.parting[k], volume))
            ahead[k] = steps_ahead(domain, state) * domain->time_step;
        if (ahead[k] > 0) coming |= 1U << k;
    }
    if (coming) look_ahead(domain, state, r, lanes, coming, ahead, group->stiffness);
    for (int k = 0; k < lanes->count; k++)
        measure(domain, lanes->element[k], first + (size_t)lanes->lane[k], group->stiffness[k],
                motion.areas[k], monitor->strain[lanes->entry[k]], state);
    lanes->count = 0;
    group->moves = group->near = group->may_fold = 0;
}

/* No corners part faster than this, where it is known [m^2/s^2]. */
static double parting_max(const lar_state *state) {
    return state->strained->follows && state->listed ? 12.0001 * state->fastest * state->fastest
                                                     : INFINITY;
}

/* Measures all that are listed: most by their strain alone. Those near a barrier are looked at
 * beside each other, and so are the others, of which less is asked. */
static void measure_list(const lar_domain *domain, const lar_hex8_monitor *monitor, int32_t r,
                         lar_state *state) {
    const lar_strained *strained = state->strained;
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    double parting = parting_max(state);
    measured_group groups[2] = {{.lanes = {.count = 0}}, {.lanes = {.count = 0}}};
    int32_t met = 0; /* of strained->near */
    for (int32_t i = 0; i < monitor->count; i++) {
        int32_t lane = monitor->lane[i] & ~LAR_LANE_FLAT;
        size_t place = first + (size_t)lane;
        if (!is_there(domain, r, lane)) continue;
        bool near = met < strained->count[r] && strained->near[first + (size_t)met] == lane;
        bool may_fold = !near && lane == monitor->lane[i] &&
                        is_thrown(domain, state, parting, domain->base[place].volume);
        bool flat = domain->area_limit && domain->area_limit[place] < LAR_STRAINED_AREA;
        if (!near && !may_fold && !flat) {
            measure(domain, element_of(domain, r, lane), place, 0, 0, monitor->strain[i], state);
            continue;
        }
        measured_group *group = &groups[near];
        int k = group->lanes.count;
        group->stiffness[k] = near ? strained->stiffness[first + (size_t)met++] : 0;
        group->near |= (unsigned)near << k;
        group->may_fold |= (unsigned)may_fold << k;
        group->moves |= (unsigned)(may_fold || flat) << k;
        add_lane(domain, r, lane, i, &group->lanes);
        if (group->lanes.count == LAR_BLOCK) measure_group(domain, monitor, r, group, state);
    }
    for (int k = 0; k < 2; k++)
        if (groups[k].lanes.count > 0) measure_group(domain, monitor, r, &groups[k], state);
}

void lar_guard_select_and_apply(const lar_domain *domain, int32_t r,
                                const lar_hex8_monitor *monitor, bool measures, lar_state *state) {
    lar_strained *strained = state->strained;
    finish_damping(domain, r, state);
    if (!state->listed && strained->travel > 0)
        memset(strained->sound + LAR_BLOCK * (size_t)domain->run_first[r], 0,
               LAR_BLOCK * (size_t)domain->run[r].count * sizeof *strained->sound);
    apply_list(domain, r, monitor->lane, monitor->count, state);
    if (measures) measure_list(domain, monitor, r, state);
}

void lar_guard_apply(const lar_domain *domain, int32_t r, lar_state *state) {
    const lar_strained *strained = state->strained;
    const int32_t *near = strained->near + LAR_BLOCK * (size_t)domain->run_first[r];
    strained_group group = {.count = 0};
    finish_damping(domain, r, state);
    for (int32_t i = 0; i < strained->count[r]; i++) {
        add_lane(domain, r, near[i], i, &group);
        if (group.count == LAR_BLOCK) apply_group(domain, r, false, &group, state);
    }
    if (group.count > 0) apply_group(domain, r, false, &group, state);
}

void lar_guard_apply_all(const lar_domain *domain, lar_state *state) {
    for (lar_gid e = 0; e < domain->model->mesh.element_count; e++)
        apply(domain, e, LAR_ALL_CORNERS, false, NULL, state, NULL);
}

void lar_guard_half_work(const lar_domain *domain, lar_state *state) {
    lar_damped damped;
    for (lar_gid e = 0; e < domain->model->mesh.element_count; e++)
        apply(domain, e, LAR_ALL_CORNERS, false, &damped, state, NULL);
}

double lar_guard_energy(const lar_domain *domain, const lar_state *state, lar_gid e) {
    double rest[8][3], now[8][3];
    lar_guard guard;
    corners_of(domain, state, e, rest, now, NULL);
    lar_hex8_guard((const double(*)[3])rest, (const double(*)[3])now,
                   lar_domain_material(domain, e), &guard);
    return guard.energy;
}
