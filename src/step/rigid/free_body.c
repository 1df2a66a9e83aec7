#include "step/rigid/free_body.h"

#include <math.h>
#include <string.h>

#include "base/quaternion.h"
#include "base/vector.h"
#include "contact/tool_body.h"
#include "step/rigid/landing.h"

bool lar_free_bodies_any(const lar_model *model) {
    bool any = false;
    for (int i = 0; i < model->tool_count; i++) any = any || model->tool[i].free;
    return any;
}

/* ---- what the nodes would do ----------------------------------------------------------------- */

/* Where a node is now, seen from a point. Returns its mass. */
static double arm_of(const lar_domain *domain, const lar_state *state, lar_lid node,
                     const double from[3], double arm[3]) {
    const double *rest = domain->model->mesh.position[domain->layout.global[node]];
    lar_state_displacement(state, node, arm);
    for (int i = 0; i < 3; i++) arm[i] += rest[i] - from[i];
    return domain->mass[node];
}

/* The nodes that a tool has: some may have been let go. From one constraint to the next along x. */
static int32_t next_of(const lar_condition_notes *notes, int tool, int32_t i) {
    while (i < notes->constraint_count &&
           (notes->constraint[i].curve != LAR_CURVE_TOOL || notes->constraint[i].rigid != tool ||
            notes->constraint[i].axis != 0))
        i++;
    return i;
}

/* The centre of mass, or the point that the body turns about. */
static void find_centre(const lar_domain *domain, const lar_condition_notes *notes,
                        const lar_state *state, int tool, lar_rigid_sum *sum) {
    static const double origin[3];
    const lar_tool *body = &domain->model->tool[tool];
    double x[3], all[3] = {0};
    for (int32_t k = 0; (k = next_of(notes, tool, k)) < notes->constraint_count; k++) {
        const double mass = arm_of(domain, state, notes->constraint[k].node, origin, x);
        sum->mass += mass;
        for (int i = 0; i < 3; i++) all[i] += mass * x[i];
    }
    for (int i = 0; i < 3; i++)
        sum->centre[i] = body->free & LAR_AXIS_ALL ? all[i] / sum->mass : body->point[i];
}

static void sum_nodes(const lar_domain *domain, const lar_condition_notes *notes,
                      const lar_state *state, const lar_leapfrog *leapfrog, int tool,
                      lar_rigid_sum *sum) {
    *sum = (lar_rigid_sum){0};
    find_centre(domain, notes, state, tool, sum);
    for (int32_t k = 0; (k = next_of(notes, tool, k)) < notes->constraint_count; k++) {
        const lar_lid n = notes->constraint[k].node;
        double r[3], p[3], turn[3];
        const double mass = arm_of(domain, state, n, sum->centre, r);
        for (int i = 0; i < 3; i++) {
            const size_t at = lar_state_at(state, n, i);
            p[i] = mass * (leapfrog->keep * state->v[at] + leapfrog->drift[i] -
                           leapfrog->push * domain->push[n] * (double)state->force[at]);
        }
        double had[3], had_turn[3];
        lar_state_velocity(state, n, had);
        for (int i = 0; i < 3; i++) had[i] *= mass;
        lar_cross(r, had, had_turn);
        lar_cross(r, p, turn);
        for (int i = 0; i < 3; i++) {
            sum->had[i] += had[i];
            sum->had_spin[i] += had_turn[i];
            sum->momentum[i] += p[i];
            sum->spin[i] += turn[i];
            sum->inertia[i] += mass * (lar_dot(r, r) - r[i] * r[i]);
            sum->inertia[3 + i] -= mass * r[i] * r[(i + 1) % 3];
        }
    }
}

/* ---- what the body does ---------------------------------------------------------------------- */

void lar_free_body_turn(const lar_rigid_sum *sum, const double axis[3], double dt, double v[3]) {
    enum { TIMES = 12 };             /* each brings it closer by a factor of |v| or more */
    static const double QUARTER = 2; /* of a circle: beyond that momentum says nothing */
    double inverse[6], carried[3], across[3];
    memset(v, 0, 3 * sizeof *v);
    if (!lar_inertia_invert(sum->inertia, axis, inverse)) return;
    for (int n = 0; n < TIMES; n++) {
        lar_symmetric_product(sum->inertia, v, carried);
        lar_cross(v, carried, across);
        for (int i = 0; i < 3; i++)
            across[i] = (1 + 0.25 * lar_dot(v, v)) * dt * sum->spin[i] - 0.5 * across[i];
        lar_symmetric_product(inverse, across, v);
        const double size = lar_length(v);
        for (int i = 0; i < 3 && size > QUARTER; i++) v[i] *= QUARTER / size;
    }
}

/* Where the body is after the step, from where it is. */
static void next_pose(const lar_tool *tool, const lar_rigid_sum *sum, double dt,
                      const lar_tool_pose *now, lar_tool_pose *next) {
    double turn[4] = {1}, v[3] = {0}, arm[3], swung[3];
    *next = *now;
    if (tool->free & LAR_FREE_TURNS) lar_free_body_turn(sum, tool->axis, dt, v);
    for (int i = 0; i < 3; i++) turn[1 + i] = 0.5 * v[i];
    lar_quaternion_normalise(turn);
    lar_quaternion_product(turn, now->orientation, next->orientation);
    lar_quaternion_normalise(next->orientation);
    lar_minus(now->position, sum->centre, arm);
    lar_turn(turn, arm, swung);
    for (int i = 0; i < 3; i++) {
        if (tool->free >> i & 1) next->position[i] += dt * sum->momentum[i] / sum->mass;
        next->position[i] += swung[i] - arm[i];
    }
}

static void note_landing(const lar_domain *domain, const lar_condition_notes *notes, int tool,
                         const lar_landing *landing, const lar_landed *landed) {
    int32_t n = 0;
    for (int32_t k = 0; (k = next_of(notes, tool, k)) < notes->constraint_count; k++) {
        double *force = landed->force[domain->layout.global[notes->constraint[k].node]];
        double impulse[3] = {0};
        lar_landing_on(landing, ++n, impulse);
        for (int i = 0; i < 3; i++) force[i] += landed->times * impulse[i];
    }
}

/* What planes take from it. */
static void land(const lar_domain *domain, const lar_condition_notes *notes, const lar_state *state,
                 double dt, int tool, lar_rigid_sum *sum, const lar_landed *landed) {
    const lar_model *model = domain->model;
    lar_landing landing;
    double arm[3];
    lar_landing_begin(model, &model->tool[tool], sum, dt, &landing);
    for (int32_t k = 0; (k = next_of(notes, tool, k)) < notes->constraint_count; k++) {
        arm_of(domain, state, notes->constraint[k].node, sum->centre, arm);
        lar_landing_meet(&landing, arm);
    }
    lar_landing_end(&landing);
    if (landed) note_landing(domain, notes, tool, &landing, landed);
}

void lar_free_bodies_go(const lar_domain *domain, const lar_condition_notes *notes,
                        const lar_state *state, const lar_leapfrog *leapfrog, lar_tools *tools,
                        const lar_landed *landed) {
    const lar_model *model = domain->model;
    for (int tool = 0; tool < model->tool_count; tool++) {
        if (!model->tool[tool].free || tools->motion[tool].end > state->step) continue;
        lar_tool_motion way = {.start = state->step + 1, .end = state->step};
        lar_rigid_sum sum;
        sum_nodes(domain, notes, state, leapfrog, tool, &sum);
        if (!(sum.mass > 0)) continue;
        if (model->tool[tool].planes) land(domain, notes, state, leapfrog->dt, tool, &sum, landed);
        lar_tool_at(&tools->motion[tool], state->step, domain->time_step, &way.from, NULL);
        next_pose(&model->tool[tool], &sum, leapfrog->dt, &way.from, &way.to);
        lar_tool_ask(tools, tool, &way);
    }
}

void lar_free_bodies_start(const lar_domain *domain, const lar_condition_notes *notes,
                           const lar_state *state, lar_tools *tools) {
    const lar_model *model = domain->model;
    const lar_leapfrog as_they_are = {.keep = 1};
    for (int tool = 0; tool < model->tool_count; tool++) {
        if (!model->tool[tool].free || tools->motion[tool].end > state->step) continue;
        lar_tool_motion way = {.start = state->step + 1, .end = state->step};
        lar_rigid_sum sum;
        sum_nodes(domain, notes, state, &as_they_are, tool, &sum);
        if (!(sum.mass > 0)) continue;
        way.to = tools->motion[tool].to;
        next_pose(&model->tool[tool], &sum, -domain->time_step / LAR_PARTS_MAX, &way.to, &way.from);
        lar_tool_ask(tools, tool, &way);
    }
}

/* Twice the sine of half the turn on a way. */
static double turn_of(const lar_tool_motion *way) {
    double before[4], turn[4];
    lar_quaternion_inverse(way->from.orientation, before);
    lar_quaternion_product(way->to.orientation, before, turn);
    return 2 * lar_length(&turn[1]);
}

bool lar_free_bodies_turn_far(const lar_tools *tools, uint64_t step, int32_t parts) {
    static const double FAR = 0.1;
    const int32_t before = step == 0 ? LAR_PARTS_MAX : tools->division.parts;
    bool far = false;
    for (int32_t i = 0; i < tools->count && !far; i++)
        far = lar_tool_motion_free(&tools->motion[i]) &&
              turn_of(&tools->motion[i]) * before > FAR * parts;
    return far;
}

bool lar_free_bodies_divide(const lar_tools *tools, const lar_state *state, lar_tools *divided) {
    int32_t parts = tools->division.parts;
    if (state->step > 0 || state->part > 0 || !lar_free_bodies_turn_far(tools, 0, parts))
        return false;
    while (parts < LAR_PARTS_MAX && lar_free_bodies_turn_far(tools, 0, parts))
        parts = lar_more_parts(parts);
    *divided = *tools;
    divided->division.parts = parts;
    return true;
}
