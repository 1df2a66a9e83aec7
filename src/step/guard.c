#include "step/guard.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/hex8_guard.h"
#include "step/mass/heavier.h"
#include "step/mass/measured.h"

static bool is_there(const lar_domain *domain, int32_t r, int32_t lane) {
    return lar_lane_element(domain, r, (uint32_t)lane) >= 0;
}

/* In whole units, which sum to nothing. */
static void add(const lar_domain *domain, lar_gid e, const double force[8][3], lar_state *state) {
    int64_t whole[8][3], sum[3] = {0};
    size_t stride = state->stride;
    for (int a = 0; a < 7; a++)
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++) {
            double units = force[a][i] * domain->scale;
            if (!(fabs(units) < 0x1p56)) return; /* a run that is about to break */
            whole[a][i] = llrint(units);
            sum[i] += whole[a][i];
        }
    for (int i = 0; i < 3; i++) whole[7][i] = -sum[i];
    for (int a = 0; a < 8; a++) {
        lar_lid node = domain->layout.local[domain->model->mesh.element[e][a]];
        int64_t *to = &state->force[lar_state_at(state, node, 0)];
#pragma GCC unroll 3
        for (size_t i = 0; i < 3; i++)
            to[i * stride] = (int64_t)((uint64_t)to[i * stride] + (uint64_t)whole[a][i]);
    }
}

/* A barrier is no harder than the step bears: one that has just been met is as hard as it should be
 * after the next decision about parts of steps, and one that would ask for more parts than there
 * can be never is. Returns which part of it. */
static double soften(const lar_domain *domain, lar_gid e, double stiffness, double step,
                     double mean, double force[8][3]) {
    static const double ROOM = 1; /* of (omega dt / 2)^2 */
    double rate = (1 + 2 * LAR_BARRIER_LEAD) * stiffness /
                  (domain->rate[e].mass * lar_burden_factor(domain, e));
    double takes = 0.25 * mean * fmax(mean, step) * rate;
    if (!(takes > ROOM)) return 1;
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) force[a][i] *= ROOM / takes;
    return ROOM / takes;
}

/* lar_hex8_guard_power, where it is known how fast corners open. */
static double power_of(const double opening[8][4], const double damper[8]) {
    double power = 0;
    for (int a = 0; a < 8; a++) {
        if (damper[a] == 0) continue;
        for (int k = 0; k < 4; k++) power += damper[a] * opening[a][k];
    }
    return power;
}

/* Half of the work of what an element was damped with: contact takes it. What a barrier lacks that
 * is softer than its energy says is done to the body from outside. `opening`: as of lar_guard, or
 * NULL. */
static bool add_half_work(const double rest[8][3], const double now[8][3], const double v[8][3],
                          const double opening[8][4], const lar_damped *damped, lar_state *state) {
    double damper[8], lack[8];
    bool lacks = false;
    for (int a = 0; a < 8; a++) {
        damper[a] = (double)damped->damper[a];
        lack[a] = (double)damped->lack[a];
        lacks = lacks || lack[a] != 0;
    }
    double half = (double)damped->half_mean;
    state->contact +=
        half * (opening ? power_of(opening, damper) : lar_hex8_guard_power(rest, now, v, damper));
    if (lacks)
        state->external +=
            half * (opening ? power_of(opening, lack) : lar_hex8_guard_power(rest, now, v, lack));
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
    const lar_guard_lead lead = {.closing = LAR_BARRIER_LEAD * step,
                                 .opening = LAR_BARRIER_LEAD * domain->time_step};
    lar_guard guard;
    lar_strained_corners(domain, state, e, rest, now, v);
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
    add_half_work((const double(*)[3])rest, (const double(*)[3])now, (const double(*)[3])v,
                  (const double(*)[4])guard.opening, damped, state);
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
    lar_strained_corners(domain, state, damped->element, back->rest, back->now, back->v);
    const double *now = back->now[0], *v = back->v[0];
    double *then = back->then[0], step = (double)damped->step;
    for (int i = 0; i < 24; i++) then[i] = now[i] - step * v[i];
}

/* The other half of the work of what damped an element, now that its nodes have moved. Returns
 * whether its barriers lacked something. */
static bool finish(const lar_domain *domain, const lar_damped *damped, const step_back *back,
                   lar_state *state) {
    const double(*rest)[3] = (const double(*)[3])back->rest,
          (*then)[3] = (const double(*)[3])back->then;
    if (!damped->gone)
        return add_half_work(rest, then, (const double(*)[3])back->v, NULL, damped, state);
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

/* Into the list of lanes with a corner below twice START, which ascends. */
static void put_near(lar_strained *strained, size_t first, int32_t *count, int32_t lane,
                     double stiffness) {
    int32_t *near = strained->near + first, k = (*count)++;
    double *stiff = strained->stiffness + first;
    for (; k > 0 && near[k - 1] > lane; k--) {
        near[k] = near[k - 1];
        stiff[k] = stiff[k - 1];
    }
    near[k] = lane;
    stiff[k] = stiffness;
}

/* Looks at the corners of a group, which is empty then: adds the forces of their barriers. With
 * `lists` the lanes with a corner below twice START are listed. */
static void apply_group(const lar_domain *domain, int32_t r, bool lists, lar_strained_group *group,
                        lar_state *state) {
    lar_strained *strained = state->strained;
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    int32_t *count = strained->count + r, *damped = strained->damped_count + r;
    const lar_hex8_places places = {.stride = state->stride, .rest = domain->rest, .u = state->u};
    lar_hex8_corner_look look;
    unsigned below = domain->kernels->corners(&group->hex8, lar_group_fill(group), &places,
                                              LAR_GUARD_SHARES, &look);
    double way = lar_way_ahead(domain, state);
    for (int k = 0; k < group->count; k++) {
        size_t place = first + (size_t)group->lane[k];
        double stiffness = 0;
        strained->sound[place] = strained->travel + may_go(look.above[k], look.longest[k]);
        if (below >> k & 1) {
            unsigned corners = lar_corners_in_mesh(domain, r, group->lane[k], look.at[k]);
            bool lacked =
                is_among(group->element[k], strained->lacked + first, strained->lacked_count[r]);
            *damped += apply(domain, group->element[k], corners, lacked,
                             &strained->damped[first + (size_t)*damped], state, &stiffness);
        }
        if (!lists || !(below >> (k + LAR_BLOCK) & 1)) continue;
        double far = may_go(look.over[k], look.longest[k]);
        put_near(strained, first, count, group->lane[k], far > way ? LAR_BARRIER_FAR : stiffness);
        strained->steady[place].far =
            strained->travel + fmin(far, may_go(-look.above[k], look.longest[k]));
    }
    group->count = 0;
}

/* The same of all that are listed, but not for being flat alone: their corners are far from the
 * barrier. Where it is known how far nodes can have gone, corners that cannot be near one are not
 * looked at, nor those of which it is known that they are near one and come no nearer. */
static void apply_list(const lar_domain *domain, int32_t r, const int32_t *list, int32_t count,
                       lar_state *state) {
    lar_strained *strained = state->strained;
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    const double *sound = strained->sound + first;
    double travel = strained->follows ? strained->travel : INFINITY;
    double then = travel + lar_way_ahead(domain, state);
    lar_strained_group group = {.count = 0};
    strained->count[r] = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t lane = list[i];
        if (lane & LAR_LANE_FLAT || travel < sound[lane] || !is_there(domain, r, lane)) continue;
        if (then < strained->steady[first + (size_t)lane].far) {
            put_near(strained, first, &strained->count[r], lane, LAR_BARRIER_FAR);
            continue;
        }
        lar_group_add(domain, r, lane, i, &group);
        if (group.count == LAR_BLOCK) apply_group(domain, r, true, &group, state);
    }
    if (group.count > 0) apply_group(domain, r, true, &group, state);
}

/* The state has been put elsewhere: corners may be anywhere. */
static void forget_places(const lar_domain *domain, int32_t r, lar_strained *strained) {
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    size_t lanes = LAR_BLOCK * (size_t)domain->run[r].count;
    memset(strained->sound + first, 0, lanes * sizeof *strained->sound);
    memset(strained->steady + first, 0, lanes * sizeof *strained->steady);
}

void lar_guard_select_and_apply(const lar_domain *domain, int32_t r,
                                const lar_hex8_monitor *monitor, bool measures, lar_state *state) {
    lar_strained *strained = state->strained;
    finish_damping(domain, r, state);
    if (strained->follows && !state->listed) forget_places(domain, r, strained);
    apply_list(domain, r, monitor->lane, monitor->count, state);
    if (measures) lar_measure_strained(domain, monitor, r, state);
}

void lar_guard_apply(const lar_domain *domain, int32_t r, lar_state *state) {
    const lar_strained *strained = state->strained;
    const int32_t *near = strained->near + LAR_BLOCK * (size_t)domain->run_first[r];
    lar_strained_group group = {.count = 0};
    finish_damping(domain, r, state);
    for (int32_t i = 0; i < strained->count[r]; i++) {
        lar_group_add(domain, r, near[i], i, &group);
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
    lar_strained_corners(domain, state, e, rest, now, NULL);
    lar_hex8_guard((const double(*)[3])rest, (const double(*)[3])now,
                   lar_domain_material(domain, e), &guard);
    return guard.energy;
}
