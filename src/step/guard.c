#include "step/guard.h"

#include <math.h>
#include <stdlib.h>

#include "base/vector.h"
#include "mechanics/hex8_guard.h"
#include "step/mass/heavier.h"

/* Elements are listed when a corner is no farther from its barrier than twice START. That no corner
 * comes there before the next list is made is no theorem: in fast pushes with tools at 1.6 m/s the
 * least corner that was not listed stood at 0.48. */
static const double SHARES[2] = {LAR_GUARD_START, 2 * LAR_GUARD_START};

enum { ALL_LANES = (1 << LAR_BLOCK) - 1 };

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
    lar_mesh_corners(&domain->model->mesh, e, rest);
    lar_domain_corners(domain, state->u, e, now);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) now[a][i] += rest[a][i];
}

/* What is found in a step counts from the next one on, until that is over or, where steps are not
 * divided and nothing is close to it, until the next interval is. */
enum { SEEN_IN_STEPS = 3 };

static double steps_ahead(const lar_domain *domain, const lar_state *state) {
    return state->close ? SEEN_IN_STEPS : fmax(SEEN_IN_STEPS, (double)domain->interval + 1);
}

/* Whether nodes of an element move against each other by more than a tenth of its size in that
 * time: what springs back when it is let go comes to its barriers from where nobody looks. */
static bool is_thrown(const lar_domain *domain, const lar_state *state, lar_gid e, double volume) {
    const lar_gid *node = domain->layout.corner[e];
    const double *first = state->v + 4 * domain->layout.local[node[0]];
    double most = 0, ahead = steps_ahead(domain, state) * domain->time_step;
    for (int a = 1; a < 8; a++) {
        double away[3];
        lar_minus(state->v + 4 * domain->layout.local[node[a]], first, away);
        double square = lar_dot(away, away);
        if (square > most) most = square;
    }
    double square = 100 * most * ahead * ahead;
    return square * square * square > volume * volume;
}

/* How stiff an element's barriers are: now, where a corner is at one, and where its corners will be
 * after so many steps if nothing stops them. */
static double barriers_of(const lar_domain *domain, const lar_state *state, lar_gid e, bool at_one,
                          double steps) {
    const lar_material *material = lar_domain_material(domain, e);
    double rest[8][3], now[8][3], v[8][3];
    lar_guard guard = {0}, then;
    corners_of(domain, state, e, rest, now);
    if (at_one) lar_hex8_guard((const double(*)[3])rest, (const double(*)[3])now, material, &guard);
    lar_domain_corners(domain, state->v, e, v);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) now[a][i] += steps * domain->time_step * v[a][i];
    lar_hex8_guard((const double(*)[3])rest, (const double(*)[3])now, material, &then);
    return fmax(guard.stiffness, then.stiffness);
}

/* How the square of a flat element's frequency has grown, with what its neighbours leave of it: its
 * areas as they are, not as those of a cube would be with such a strain. 0 for others. */
static double growth_of_flat(const lar_domain *domain, const lar_state *state, lar_gid e,
                             size_t place, const float strain[LAR_STRAIN_NUMBERS]) {
    double rest[8][3], now[8][3];
    if (!domain->area_limit || !(domain->area_limit[place] < LAR_STRAINED_AREA)) return 0;
    corners_of(domain, state, e, rest, now);
    double area =
        lar_hex8_areas((const double(*)[3])now) / lar_hex8_areas((const double(*)[3])rest);
    return domain->rate[e].share * lar_hex8_growth(lar_domain_material(domain, e), strain, area);
}

/* What barriers that an element is at, or is coming to, do to the square of its frequency. `below`:
 * the bits of its lane (lar_hex8_corners). */
static double square_of_barriers(const lar_domain *domain, const lar_state *state, lar_gid e,
                                 unsigned below, double volume) {
    double steps = 0;
    if (below >> LAR_BLOCK & 1)
        steps = SEEN_IN_STEPS;
    else if (is_thrown(domain, state, e, volume))
        steps = steps_ahead(domain, state);
    if (!(steps > 0)) return 0;
    return (1 + 2 * LEAD) * barriers_of(domain, state, e, below & 1, steps) / domain->rate[e].mass;
}

/* Strained lanes of one block, from entry `i` of a monitor on, without those that are listed for
 * being flat alone: their corners are far from the barrier. Returns where those of the next begin.
 */
static int32_t lanes_of_block(const lar_hex8_monitor *monitor, int32_t i, int32_t *block,
                              unsigned *lanes) {
    *block = (monitor->lane[i] & ~LAR_LANE_FLAT) / LAR_BLOCK;
    for (*lanes = 0; i < monitor->count; i++) {
        int32_t lane = monitor->lane[i] & ~LAR_LANE_FLAT;
        if (lane / LAR_BLOCK != *block) break;
        if (lane == monitor->lane[i]) *lanes |= 1u << lane % LAR_BLOCK;
    }
    return i;
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
static bool apply(const lar_domain *domain, lar_gid e, lar_damped *damped, lar_state *state) {
    double rest[8][3], now[8][3], v[8][3], force[8][3] = {{0}};
    double step = domain->time_step / state->parts;
    double mean = state->past > 0 ? 0.5 * (state->past + step) : step;
    const lar_guard_lead lead = {.closing = LEAD * step, .opening = LEAD * domain->time_step};
    lar_guard guard;
    corners_of(domain, state, e, rest, now);
    lar_domain_corners(domain, state->v, e, v);
    lar_hex8_guard_force((const double(*)[3])rest, (const double(*)[3])now, (const double(*)[3])v,
                         lar_domain_material(domain, e), lead, force, &guard);
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

/* Those lanes of a block of run r where a corner is below START, and from bit 8 on those where one
 * is below twice START. */
static unsigned lanes_below(const lar_domain *domain, int32_t r, int32_t block, unsigned lanes,
                            const lar_state *state) {
    const lar_lane_base *base = domain->base + LAR_BLOCK * (size_t)(domain->run_first[r] + block);
    double largest[LAR_BLOCK] __attribute__((aligned(64)));
    for (int lane = 0; lane < LAR_BLOCK; lane++) largest[lane] = base[lane].largest;
    return domain->kernels->corners(&domain->run[r], block, lanes, largest, domain->rest, state->u,
                                    SHARES);
}

static void apply_lanes(const lar_domain *domain, int32_t r, const lar_gid *element, unsigned lanes,
                        lar_state *state) {
    lar_damped *damped = state->strained->damped + LAR_BLOCK * (size_t)domain->run_first[r];
    int32_t *count = &state->strained->damped_count[r];
    for (; lanes; lanes &= lanes - 1)
        *count += apply(domain, element[__builtin_ctz(lanes)], &damped[*count], state);
}

/* How fast strained elements of a block have become, entries first to end - 1 of a monitor:
 * (omega dt / 2)^2 of each, if it is not heavier for a while. */
static void measure(const lar_domain *domain, const lar_hex8_monitor *monitor, int32_t first,
                    int32_t end, size_t place, const lar_gid *element, unsigned below,
                    lar_state *state) {
    for (int32_t i = first; i < end; i++) {
        int32_t lane = monitor->lane[i] % LAR_BLOCK;
        lar_gid e = element[lane];
        size_t at = place + (size_t)lane;
        if (e < 0) continue;
        double faster = domain->faster[lar_factor_of(domain->model->element_material[e])];
        const float *strain = monitor->strain[i];
        double rate = faster * domain->rate[e].square;
        double square = rate * lar_hex8_growth(lar_domain_material(domain, e), strain,
                                               strain[LAR_STRAIN_AREA] / 3.0);
        if (!(monitor->lane[i] & LAR_LANE_FLAT))
            square += square_of_barriers(domain, state, e, below >> lane, domain->base[at].volume);
        double flat = rate * growth_of_flat(domain, state, e, at, strain);
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
    finish_damping(domain, r, state);
    for (int32_t first = 0, end; first < monitor->count; first = end) {
        int32_t block;
        unsigned lanes;
        end = lanes_of_block(monitor, first, &block, &lanes);
        size_t at = (size_t)(domain->run_first[r] + block);
        const lar_gid *element = domain->layout.block[at].element;
        for (int lane = 0; lane < LAR_BLOCK; lane++)
            if (element[lane] < 0) lanes &= ~(1u << lane);
        unsigned below = lanes ? lanes_below(domain, r, block, lanes, state) : 0;
        if (measures) measure(domain, monitor, first, end, LAR_BLOCK * at, element, below, state);
        lanes &= below >> LAR_BLOCK;
        if (lanes) list[count++] = (int32_t)((unsigned)block << LAR_BLOCK | lanes);
        apply_lanes(domain, r, element, lanes & below, state);
    }
    state->strained->count[r] = count;
}

void lar_guard_apply(const lar_domain *domain, int32_t r, lar_state *state) {
    const int32_t *list = state->strained->lane + LAR_BLOCK * (size_t)domain->run_first[r];
    finish_damping(domain, r, state);
    for (int32_t i = 0; i < state->strained->count[r]; i++) {
        int32_t block = (int32_t)((uint32_t)list[i] >> LAR_BLOCK);
        unsigned lanes = (unsigned)list[i] & ALL_LANES;
        const lar_gid *element = domain->layout.block[domain->run_first[r] + block].element;
        apply_lanes(domain, r, element, lanes_below(domain, r, block, lanes, state) & ALL_LANES,
                    state);
    }
}

void lar_guard_apply_all(const lar_domain *domain, lar_state *state) {
    for (lar_gid e = 0; e < domain->model->mesh.element_count; e++) apply(domain, e, NULL, state);
}

double lar_guard_energy(const lar_domain *domain, const lar_state *state, lar_gid e) {
    double rest[8][3], now[8][3];
    lar_guard guard;
    corners_of(domain, state, e, rest, now);
    lar_hex8_guard((const double(*)[3])rest, (const double(*)[3])now,
                   lar_domain_material(domain, e), &guard);
    return guard.energy;
}
