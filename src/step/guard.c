#include "step/guard.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/hex8_guard.h"
#include "step/mass/heavier.h"

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
                               .strain = lar_calloc(lanes, sizeof *strained->strain),
                               .damped = lar_calloc(lanes, sizeof *strained->damped),
                               .damped_count = lar_calloc(runs, sizeof *strained->damped_count)};
    bool active = lar_model_active(domain->model) != NULL;
    if (active) {
        strained->activation = lar_calloc_aligned(lanes, sizeof *strained->activation);
        strained->active_energy = lar_calloc_aligned(lanes, sizeof *strained->active_energy);
    }
    if (strained->lane && strained->count && strained->strain && strained->damped &&
        strained->damped_count && (!active || (strained->activation && strained->active_energy)))
        return LAR_OK;
    lar_strained_destroy(strained);
    size_t each = sizeof *strained->lane + sizeof *strained->strain + sizeof *strained->damped;
    return lar_fail_memory(error, lanes * each, "the strained elements");
}

void lar_strained_destroy(lar_strained *strained) {
    free(strained->lane);
    free(strained->count);
    free(strained->strain);
    free(strained->damped);
    free(strained->damped_count);
    free(strained->activation);
    free(strained->active_energy);
    *strained = (lar_strained){0};
}

static void corners_of(const lar_domain *domain, const lar_state *state, lar_gid e,
                       double rest[8][3], double now[8][3]) {
    const lar_gid *node = domain->model->mesh.element[e];
    for (int a = 0; a < 8; a++) {
        size_t at = 4 * (size_t)domain->layout.local[node[a]];
        for (int i = 0; i < 3; i++) {
            rest[a][i] = domain->rest[at + (size_t)i];
            now[a][i] = state->u[at + (size_t)i] + rest[a][i];
        }
    }
}

/* Strained elements of a run that are looked at side by side. */
typedef struct strained_group {
    lar_hex8_group hex8;
    int count;
    int32_t lane[LAR_BLOCK];  /* block * 8 + lane */
    int32_t entry[LAR_BLOCK]; /* in the list */
    lar_gid element[LAR_BLOCK];
    unsigned lanes;              /* whose corners may be near a barrier: a bit each */
    unsigned below;              /* of these (lar_hex8_corners) */
    uint8_t at[LAR_BLOCK];       /* corners below START, likewise */
    double stiffness[LAR_BLOCK]; /* of the barriers that are at work [N/m] */
} strained_group;

static void set_nodes(strained_group *group, int at, const lar_block_head *head, int32_t lane) {
    for (int a = 0; a < 8; a++) group->hex8.node[a][at] = head->node[a][lane];
}

/* Takes up to eight lanes of run r, from entry `first` of `count` on, and looks at their corners,
 * but not of those that are listed for being flat alone: these are far from the barrier. Returns
 * where the next ones begin. */
static int32_t look(const lar_domain *domain, const lar_state *state, int32_t r,
                    const int32_t *list, int32_t first, int32_t count, strained_group *group) {
    const lar_block_run *run = &domain->run[r];
    const lar_lanes *lanes = domain->layout.block + domain->run_first[r];
    const lar_lane_base *base = domain->base + LAR_BLOCK * (size_t)domain->run_first[r];
    const lar_block_head *head = NULL;
    int32_t i = first;
    group->count = 0;
    group->lanes = 0;
    for (; i < count && group->count < LAR_BLOCK; i++) {
        int32_t lane = list[i] & ~LAR_LANE_FLAT, block = lane / LAR_BLOCK, at = group->count;
        lar_gid e = lanes[block].element[lane % LAR_BLOCK];
        if (e < 0) continue;
        head = (const void *)((const char *)run->blocks + (size_t)block * lar_run_stride(run));
        set_nodes(group, at, head, lane % LAR_BLOCK);
        group->hex8.largest[at] = base[lane].largest;
        group->lane[at] = lane;
        group->entry[at] = i;
        group->element[at] = e;
        group->stiffness[at] = 0;
        if (lane == list[i]) group->lanes |= 1u << at;
        group->count++;
    }
    for (int at = group->count; at < LAR_BLOCK && head; at++) {
        set_nodes(group, at, head, group->lane[group->count - 1] % LAR_BLOCK);
        group->hex8.largest[at] = 0;
    }
    const lar_hex8_places places = {.rest = domain->rest, .u = state->u};
    group->below = 0;
    if (group->lanes)
        group->below =
            domain->kernels->corners(&group->hex8, group->lanes, &places, SHARES, group->at);
    return i;
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
    corners_of(domain, state, e, rest, now);
    lar_domain_corners(domain, state->v, e, v);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) now[a][i] += ahead * v[a][i];
    lar_hex8_guard_force((const double(*)[3])rest, (const double(*)[3])now, NULL,
                         lar_domain_material(domain, e), (lar_guard_lead){0}, corners, NULL, &then);
    return then.stiffness;
}

/* How the square of a flat element's frequency has grown, with what its neighbours leave of it: its
 * areas as they are, not as those of a cube would be with such a strain. 0 for others. */
static double growth_of_flat(const lar_domain *domain, lar_gid e, size_t place, double areas,
                             const float strain[LAR_STRAIN_NUMBERS]) {
    if (!domain->area_limit || !(domain->area_limit[place] < LAR_STRAINED_AREA)) return 0;
    return domain->rate[e].share * lar_hex8_growth(lar_domain_material(domain, e), strain,
                                                   areas / domain->base[place].areas);
}

/* How stiff the barriers are that lanes of a group are coming to: in some steps where a corner is
 * close to one, in as many as are ahead where an element is thrown. */
static void look_ahead(const lar_domain *domain, const lar_state *state, int32_t r,
                       const strained_group *group, const double parting[LAR_BLOCK],
                       double stiffness[LAR_BLOCK]) {
    double ahead[LAR_BLOCK] __attribute__((aligned(64))) = {0};
    const lar_hex8_places places = {
        .rest = domain->rest, .u = state->u, .v = state->v, .ahead = ahead};
    uint8_t at[LAR_BLOCK];
    unsigned coming = 0;
    for (unsigned lanes = group->lanes; lanes; lanes &= lanes - 1) {
        int k = __builtin_ctz(lanes);
        double volume = domain->base[LAR_BLOCK * domain->run_first[r] + group->lane[k]].volume;
        if (group->below >> (k + LAR_BLOCK) & 1)
            ahead[k] = SEEN_IN_STEPS * domain->time_step;
        else if (is_thrown(domain, state, parting[k], volume))
            ahead[k] = steps_ahead(domain, state) * domain->time_step;
        if (ahead[k] > 0) coming |= 1u << k;
    }
    memcpy(stiffness, group->stiffness, sizeof group->stiffness);
    if (!coming) return;
    coming &= domain->kernels->corners(&group->hex8, coming, &places, SHARES, at);
    for (; coming; coming &= coming - 1) {
        int k = __builtin_ctz(coming);
        unsigned corners = corners_in_mesh(domain, r, group->lane[k], at[k]);
        stiffness[k] =
            fmax(stiffness[k], barriers_ahead(domain, state, group->element[k], ahead[k], corners));
    }
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
        int64_t *to = state->force + 4 * domain->layout.local[domain->model->mesh.element[e][a]];
        for (int i = 0; i < 3; i++) to[i] = (int64_t)((uint64_t)to[i] + (uint64_t)whole[a][i]);
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
static void add_half_work(const double rest[8][3], const double now[8][3], const double v[8][3],
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
}

/* Returns whether barriers are at work. What damps has half of its work done with the velocities
 * before the nodes move; `damped` says what the other half comes from, NULL: nothing counts. What
 * opens is damped as in a whole step: it gives back no more than it took while the step was not
 * divided yet. (A damper that never pulls cannot make a corner swing, however much it leads.) */
static bool apply(const lar_domain *domain, lar_gid e, unsigned corners, lar_damped *damped,
                  lar_state *state, double *stiffness) {
    double rest[8][3], now[8][3], v[8][3], force[8][3] = {{0}};
    double step = domain->time_step / state->parts;
    double mean = state->past > 0 ? 0.5 * (state->past + step) : step;
    const lar_guard_lead lead = {.closing = LEAD * step, .opening = LEAD * domain->time_step};
    lar_guard guard;
    corners_of(domain, state, e, rest, now);
    lar_domain_corners(domain, state->v, e, v);
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
    return true;
}

/* Energies count barriers, there or not: what those of an element that are gone would have had done
 * on them in a step comes from outside. */
static void add_difference(const lar_material *material, const double rest[8][3],
                           const double then[8][3], const double now[8][3], lar_state *state) {
    lar_guard before, after;
    lar_hex8_guard(rest, then, material, &before);
    lar_hex8_guard(rest, now, material, &after);
    state->external += after.energy - before.energy;
}

/* The other half of the work of what damped run r in the step before, now that its nodes have
 * moved. Corners that swing from step to step would be said to lose more than they do by the
 * velocities before it alone. */
static void finish_damping(const lar_domain *domain, int32_t r, lar_state *state) {
    lar_strained *strained = state->strained;
    const lar_damped *damped = strained->damped + LAR_BLOCK * (size_t)domain->run_first[r];
    for (int32_t i = 0; i < strained->damped_count[r] && state->listed; i++) {
        double rest[8][3], now[8][3], then[8][3], v[8][3];
        corners_of(domain, state, damped[i].element, rest, now);
        memcpy(then, now, sizeof then);
        lar_domain_corners(domain, state->v, damped[i].element, v);
        for (int a = 0; a < 8; a++)
            for (int k = 0; k < 3; k++) then[a][k] -= (double)damped[i].step * v[a][k];
        if (damped[i].gone)
            add_difference(lar_domain_material(domain, damped[i].element), (const double(*)[3])rest,
                           (const double(*)[3])then, (const double(*)[3])now, state);
        else
            add_half_work((const double(*)[3])rest, (const double(*)[3])then, (const double(*)[3])v,
                          &damped[i], state);
    }
    strained->damped_count[r] = 0;
}

/* Barriers of those lanes of a group that have a corner below START. */
static void apply_group(const lar_domain *domain, int32_t r, strained_group *group,
                        lar_state *state) {
    lar_damped *damped = state->strained->damped + LAR_BLOCK * (size_t)domain->run_first[r];
    int32_t *count = &state->strained->damped_count[r];
    for (unsigned lanes = group->lanes & group->below; lanes; lanes &= lanes - 1) {
        int k = __builtin_ctz(lanes);
        unsigned corners = corners_in_mesh(domain, r, group->lane[k], group->at[k]);
        *count +=
            apply(domain, group->element[k], corners, &damped[*count], state, &group->stiffness[k]);
    }
}

/* How fast the strained elements of a group have become: (omega dt / 2)^2 of each, if it is not
 * heavier for a while. */
static void measure(const lar_domain *domain, const lar_hex8_monitor *monitor, int32_t r,
                    const strained_group *group, lar_state *state) {
    const lar_hex8_places places = {.rest = domain->rest, .u = state->u};
    lar_hex8_motion motion;
    double stiffness[LAR_BLOCK];
    domain->kernels->motion(&group->hex8, (1u << group->count) - 1, &places, state->v, &motion);
    look_ahead(domain, state, r, group, motion.parting, stiffness);
    for (int k = 0; k < group->count; k++) {
        lar_gid e = group->element[k];
        size_t at = LAR_BLOCK * (size_t)domain->run_first[r] + (size_t)group->lane[k];
        double factor = domain->factor[lar_factor_of(domain->model->element_material[e])];
        const float *strain = monitor->strain[group->entry[k]];
        double rate = factor * domain->rate[e].square;
        double square = rate * lar_hex8_growth(lar_domain_material(domain, e), strain,
                                               strain[LAR_STRAIN_AREA] / 3.0);
        square += (1 + 2 * LEAD) * stiffness[k] / domain->rate[e].mass;
        double flat = rate * growth_of_flat(domain, e, at, motion.areas[k], strain);
        if (flat > square) square = flat;
        double need = 0.25 * domain->time_step * domain->time_step * square;
        if (!(need >= 0)) need = INFINITY; /* a corner that is a point has no number */
        if (!(need <= state->need)) state->need = need;
        if (state->needs && need > domain->burden->least) lar_needs_add(state->needs, e, need);
    }
}

void lar_guard_select_and_apply(const lar_domain *domain, int32_t r,
                                const lar_hex8_monitor *monitor, bool measures, lar_state *state) {
    int32_t *list = monitor->lane, count = 0;
    strained_group group;
    finish_damping(domain, r, state);
    for (int32_t i = 0; i < monitor->count;) {
        i = look(domain, state, r, monitor->lane, i, monitor->count, &group);
        apply_group(domain, r, &group, state);
        if (measures) measure(domain, monitor, r, &group, state);
        for (int k = 0; k < group.count; k++) /* never more than were read */
            if (group.below >> (k + LAR_BLOCK) & 1) list[count++] = group.lane[k];
    }
    state->strained->count[r] = count;
}

void lar_guard_apply(const lar_domain *domain, int32_t r, lar_state *state) {
    const int32_t *list = state->strained->lane + LAR_BLOCK * (size_t)domain->run_first[r];
    int32_t count = state->strained->count[r];
    strained_group group;
    finish_damping(domain, r, state);
    for (int32_t i = 0; i < count;) {
        i = look(domain, state, r, list, i, count, &group);
        apply_group(domain, r, &group, state);
    }
}

void lar_guard_apply_all(const lar_domain *domain, lar_state *state) {
    for (lar_gid e = 0; e < domain->model->mesh.element_count; e++)
        apply(domain, e, LAR_ALL_CORNERS, NULL, state, NULL);
}

double lar_guard_energy(const lar_domain *domain, const lar_state *state, lar_gid e) {
    double rest[8][3], now[8][3];
    lar_guard guard;
    corners_of(domain, state, e, rest, now);
    lar_hex8_guard((const double(*)[3])rest, (const double(*)[3])now,
                   lar_domain_material(domain, e), &guard);
    return guard.energy;
}
