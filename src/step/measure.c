#include "step/measure.h"

#include <stdlib.h>
#include <string.h>

#include "step/activation.h"
#include "step/folds.h"
#include "step/guard.h"
#include "step/rigid/free_body.h"
#include "step/viscous_history.h"
#include "mechanics/hex8_full.h"

static double element_energy(const lar_domain *domain, const lar_state *state, lar_gid e,
                             double *hourglass) {
    double corner[8][3], u[8][3];
    lar_mesh_corners(&domain->model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    *hourglass = 0;
    if (domain->kind != LAR_ELEMENT_HEX8)
        return lar_hex8_full_energy(corner, lar_domain_material(domain, e), u);
    lar_hex8 hex8;
    lar_hex8_prepare(corner, lar_domain_material(domain, e), &hex8);
    lar_model_fibres(domain->model, e, hex8.fibre);
    const lar_material now = lar_activation_material(domain, e, lar_state_time(domain, state));
    double energy = lar_hex8_energy(&hex8, &now, u, hourglass) + lar_guard_energy(domain, state, e);
    *hourglass += lar_folds_energy(domain, state, e);
    return energy;
}

/* What the present change of an element's activation does until now. */
static double pending_work(const lar_domain *domain, const lar_state *state, lar_gid e) {
    double corner[8][3], u[8][3], F[3][3];
    if (!domain->activates || !lar_fibre_active(&lar_domain_material(domain, e)->fibre)) return 0;
    lar_hex8 hex8;
    lar_mesh_corners(&domain->model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    lar_hex8_prepare(corner, lar_domain_material(domain, e), &hex8);
    lar_hex8_gradient(&hex8, u, F);
    return lar_activation_pending(domain, state, e, hex8.volume, F);
}

/* What a viscous element remembers, taken on to the time of the state: returns the stress P. */
static void look_at_history(const lar_domain *domain, const lar_state *state, lar_gid e,
                            const double F[3][3], double history[LAR_HISTORY_MAX], double P[3][3]) {
    double factor = domain->factor[lar_factor_of(domain->model->element_material[e])], fibre[6];
    lar_model_fibres(domain->model, e, fibre);
    lar_viscous_read(domain, state, e, history);
    const lar_material now = lar_activation_material(domain, e, lar_state_time(domain, state));
    lar_viscous_stress_at(&now, factor, state->past, fibre, F, history, P);
}

/* What the viscous terms of an element have taken. */
static double viscous_work(const lar_domain *domain, const lar_state *state, lar_gid e) {
    double corner[8][3], u[8][3], F[3][3], P[3][3], history[LAR_HISTORY_MAX];
    if (!lar_viscous_here(domain, e)) return 0;
    lar_hex8 hex8;
    lar_mesh_corners(&domain->model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    lar_hex8_prepare(corner, lar_domain_material(domain, e), &hex8);
    lar_hex8_gradient(&hex8, u, F);
    look_at_history(domain, state, e, F, history, P);
    double factor = domain->factor[lar_factor_of(domain->model->element_material[e])];
    return factor * hex8.volume * history[LAR_HISTORY_WORK];
}

double lar_measure_remembered(const lar_domain *domain, const lar_state *state, lar_gid e) {
    if (!lar_viscous_here(domain, e)) return 0;
    static const double twice[6] = {1, 2, 2, 1, 2, 1}; /* of a product of tensors */
    const lar_material *material = lar_domain_material(domain, e);
    const lar_viscosity *viscosity = &material->viscosity;
    double corner[8][3], history[LAR_HISTORY_MAX], sum = 0;
    double factor = domain->factor[lar_factor_of(domain->model->element_material[e])];
    lar_viscous_read(domain, state, e, history);
    for (int i = 0; i < viscosity->terms; i++)
        for (int k = 0; k < 6; k++) {
            double H = factor * history[LAR_HISTORY_TERMS + 6 * i + k];
            sum += viscosity->share[i] * twice[k] * H * H;
        }
    lar_mesh_corners(&domain->model->mesh, e, corner);
    return 0.25 * sum / lar_material_shear(material) * lar_hexahedron_volume(corner);
}

/* ---- scratch ------------------------------------------------------------------------------- */

lar_status lar_measure_scratch_create(const lar_domain *domain, const lar_tools *tools,
                                      lar_measure_scratch *scratch, lar_error *error) {
    const lar_surroundings *surroundings = &domain->surroundings;
    size_t values = 3 * domain->layout.axis_stride;
    lar_interactions *interactions = &scratch->interactions;
    *scratch = (lar_measure_scratch){0};
    lar_status status = lar_interactions_create(surroundings, tools, false, interactions, error);
    if (!status)
        status =
            lar_body_contact_create(&surroundings->bodies, domain->layout.local, domain->time_step,
                                    domain->stable_step, false, &interactions->body_contact, error);
    if (status) return status;
    scratch->force = lar_calloc_aligned(values, sizeof *scratch->force);
    scratch->tools = tools;
    if (tools) scratch->next = lar_calloc(1, sizeof *scratch->next);
    if (tools && !scratch->next) return lar_fail_memory(error, sizeof *scratch->next, "tools");
    if (tools && lar_free_bodies_any(domain->model)) {
        scratch->ahead = lar_calloc(1, sizeof *scratch->ahead);
        if (!scratch->ahead) return lar_fail_memory(error, sizeof *scratch->ahead, "free bodies");
    }
    if (scratch->force) return LAR_OK;
    return lar_fail_memory(error, values * sizeof *scratch->force, "force sums for energies");
}

void lar_measure_scratch_destroy(lar_measure_scratch *scratch) {
    lar_interactions_destroy(&scratch->interactions);
    free(scratch->force);
    free(scratch->next);
    free(scratch->ahead);
    *scratch = (lar_measure_scratch){0};
}

/* A look at a state: displacements and velocities are the state's, all else is of the look. */
typedef struct look {
    const lar_domain *domain;
    lar_interactions *interactions;
    lar_condition_context context;
    lar_state state;
    const lar_tools *tools; /* of the state; the look may have others */
    double gravity[3];      /* at the time of the state [m/s^2] */
} look;

static void enter_look(const lar_domain *domain, lar_measure_scratch *scratch,
                       const lar_state *state, look *l) {
    *l = (look){.domain = domain,
                .interactions = &scratch->interactions,
                .context = lar_domain_context(domain),
                .state = *state,
                .tools = scratch->tools};
    l->state.force = scratch->force;
    const lar_tools *tools = scratch->tools;
    if (tools && (lar_tools_go_on(tools, state->step, scratch->next) ||
                  lar_free_bodies_divide(tools, state, scratch->next)))
        tools = scratch->next;
    l->interactions->tool_contact.tools = tools;
    lar_step_enter(domain, l->interactions, &l->context, &l->state);
    lar_gravity_at(domain->model, lar_settings_of(l->interactions), lar_state_time(domain, state),
                   l->context.mean_step, l->gravity);
}

/* Loads and internal forces stand in look->state.force; free bodies set out. */
static void begin_look(const lar_domain *domain, lar_measure_scratch *scratch,
                       const lar_state *state, look *l) {
    lar_fault ignored = {0};
    enter_look(domain, scratch, state, l);
    lar_step_forces(domain, l->interactions, &l->state, &ignored);
    if (!scratch->ahead) return;
    *scratch->ahead = *l->interactions->tool_contact.tools;
    scratch->ahead->bearings = l->interactions->tool_contact.bearings;
    const lar_leapfrog leapfrog =
        lar_step_leapfrog_at(domain, l->interactions, &l->context, &l->state);
    lar_free_bodies_go(domain, &l->interactions->notes, &l->state, &leapfrog, scratch->ahead, NULL);
    l->context.tools = scratch->ahead;
}

static void end_look(look *l) {
    l->interactions->tool_contact.tools = l->tools;
    memset(l->state.force, 0, 3 * l->state.stride * sizeof *l->state.force);
}

/* The supports in effect, and the nodes before planes with them. */
static const lar_condition_notes *supports_of(const look *l) {
    return &l->interactions->notes;
}

static const lar_planes *planes_of(const look *l) {
    return l->interactions->tool_contact.plane_contact.planes;
}

static double damping_of(const look *l) {
    return lar_damping_of(l->domain->model, lar_settings_of(l->interactions));
}

/* That of which forces change the velocities next: between the last part and the next one. */
static double mean_step(const look *l) {
    return lar_mean_step(l->domain, lar_division_of(l->interactions), &l->state);
}

/* ---- motion -------------------------------------------------------------------------------- */

/* The velocity half a step ahead of an unsupported value, as the update kernel would make it. */
static double next_velocity(const look *l, lar_lid node, int axis) {
    size_t at = lar_state_at(&l->state, node, axis);
    lar_leapfrog leapfrog = lar_step_leapfrog(l->domain, l->interactions, &l->state);
    double step = mean_step(l);
    double half = 0.5 * damping_of(l) * step;
    double drift = l->gravity[axis] * step / (1 + half);
    return leapfrog.keep * l->state.v[at] + drift -
           leapfrog.push * l->domain->push[node] * (double)l->state.force[at];
}

/* Length of the next step, or of its parts. */
static double part_of_step(const look *l) {
    return l->domain->time_step / lar_division_of(l->interactions)->parts;
}

/* Kinetic energy of one value, and half of the present step's share of damping. */
static void add_kinetic(const look *l, lar_lid node, int axis, double ahead, lar_energy *energy) {
    double mass = l->domain->mass[node], behind = l->state.v[lar_state_at(&l->state, node, axis)];
    energy->kinetic += 0.5 * mass * behind * ahead;
    energy->damping += 0.25 * damping_of(l) * mean_step(l) * mass * behind * (behind + ahead);
}

/* What a support exerts on a value: all that the rest of the equation of motion leaves open. */
static double support_force(const look *l, const lar_constraint *constraint, double ahead) {
    size_t at = lar_constraint_at(&l->state, constraint);
    double behind = l->state.v[at];
    double inertia = (ahead - behind) / mean_step(l) + 0.5 * damping_of(l) * (ahead + behind);
    return l->domain->mass[constraint->node] * (inertia - l->gravity[constraint->axis]) +
           (double)l->state.force[at] / l->domain->scale;
}

static double gravity_potential(const look *l) {
    double work = 0;
    for (int32_t n = 0; n < l->domain->layout.node_count; n++)
        for (int i = 0; i < 3; i++)
            work += lar_domain_weighs(l->domain, n) * l->gravity[i] *
                    l->state.u[lar_state_at(&l->state, n, i)];
    return work;
}

/* The velocity half a step ahead of a supported value. */
static double supported_velocity(const look *l, const lar_constraint *constraint) {
    return lar_constraint_velocity(&l->context, constraint, lar_state_time(l->domain, &l->state),
                                   &l->state);
}

/* The velocity half a step ahead of the node whose first plane is `entry`, without planes and with
 * them. Returns the entry behind its last. */
static int32_t stop_at_planes(const look *l, int32_t entry, double free[3], double ahead[3]) {
    const lar_planes *planes = planes_of(l);
    lar_lid node = planes->node[entry].node;
    lar_condition_context context = l->context;
    context.time_step = part_of_step(l);
    const uint8_t *marks = supports_of(l)->mark;
    unsigned mark = marks ? marks[l->domain->layout.global[node]] / LAR_SUPPORT_SET : 0;
    for (int i = 0; i < 3; i++) { /* what supports hold goes on as it does, or stops */
        const lar_plane_way *way = &planes->way[planes->node[entry].way];
        bool held = way->slide[i] == 0 && way->normal[i] != 0;
        free[i] = !held           ? next_velocity(l, node, i)
                  : mark >> i & 1 ? 0
                                  : l->state.v[lar_state_at(&l->state, node, i)];
        ahead[i] = free[i];
    }
    return lar_planes_ahead(planes, &context, &l->state, entry, ahead);
}

/* Nodes that planes stop in this step: what add_kinetic has counted for them as free nodes, and
 * half of what the stop takes. */
static void add_stops(const look *l, lar_energy *energy) {
    const lar_planes *planes = planes_of(l);
    double half = 0.5 * damping_of(l) * mean_step(l);
    for (int32_t entry = 0; entry < planes->count;) {
        lar_lid node = planes->node[entry].node;
        double free[3], ahead[3], behind[3], mass = l->domain->mass[node];
        lar_state_velocity(&l->state, node, behind);
        entry = stop_at_planes(l, entry, free, ahead);
        for (int i = 0; i < 3; i++) {
            double change = ahead[i] - free[i];
            energy->kinetic += 0.5 * mass * behind[i] * change;
            energy->damping += 0.5 * half * mass * behind[i] * change;
            energy->contact -= 0.5 * mass * (1 + half) * change * behind[i];
        }
    }
}

/* Kinetic energy, damping and the work of moved supports: free values first, then the supported. */
static void add_motion(const look *l, lar_energy *energy) {
    const lar_domain *domain = l->domain;
    const lar_condition_notes *supports = supports_of(l);
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++)
        for (int i = 0; i < 3; i++) {
            lar_lid node = domain->layout.local[g];
            if (supports->held[g] >> i & 1) continue;
            add_kinetic(l, node, i, next_velocity(l, node, i), energy);
        }
    add_stops(l, energy);
    for (int32_t i = 0; i < supports->constraint_count; i++) {
        const lar_constraint *c = &supports->constraint[i];
        double ahead = supported_velocity(l, c);
        add_kinetic(l, c->node, c->axis, ahead, energy);
        if (c->curve != -1)
            energy->external += 0.5 * mean_step(l) * l->state.v[lar_constraint_at(&l->state, c)] *
                                support_force(l, c, ahead);
    }
}

/* ---- energies and forces ------------------------------------------------------------------- */

/* The first half of the present step's work of tools, bodies and barriers, as the loads'. Forces do
 * not count any more. */
static void add_contact(look *l, lar_energy *energy) {
    double external = l->state.external, contact = l->state.contact;
    lar_tool_contact_half_work(&l->interactions->tool_contact, &l->context, &l->state);
    lar_body_contact_half_work(&l->interactions->body_contact, &l->context, &l->state);
    if (l->domain->kind == LAR_ELEMENT_HEX8) lar_guard_half_work(l->domain, &l->state);
    energy->external += l->state.external - external;
    energy->contact += l->state.contact - contact;
}

void lar_measure_ahead(const lar_domain *domain, lar_measure_scratch *scratch,
                       const lar_state *state, lar_tools *tools) {
    look l;
    begin_look(domain, scratch, state, &l);
    *tools = *scratch->ahead;
    end_look(&l);
}

void lar_measure_energy(const lar_domain *domain, lar_measure_scratch *scratch,
                        const lar_state *state, lar_energy *energy) {
    look l;
    begin_look(domain, scratch, state, &l);
    *energy = (lar_energy){.external = state->external,
                           .contact = state->contact,
                           .damping = 0.25 * domain->time_step * state->damped};
    energy->external += lar_conditions_half_work(&domain->surroundings.conditions, &l.context,
                                                 lar_state_time(domain, &l.state),
                                                 &l.interactions->notes, &l.state);
    if (!lar_gravity_varies(domain->model, lar_settings_of(l.interactions)))
        energy->external += gravity_potential(&l);
    add_motion(&l, energy);
    add_contact(&l, energy);
    end_look(&l);
    lar_guard_half_to_come(domain, state, &energy->contact, &energy->external);

    for (lar_gid e = 0; e < domain->model->mesh.element_count; e++) {
        double hourglass;
        energy->strain += element_energy(domain, state, e, &hourglass);
        energy->hourglass += hourglass;
        energy->viscous += viscous_work(domain, &l.state, e);
        energy->external += pending_work(domain, &l.state, e);
    }
}

void lar_measure_touches(const lar_domain *domain, lar_measure_scratch *scratch,
                         const lar_state *state, lar_touch_list *list) {
    lar_tool_contact *contact = &scratch->interactions.tool_contact;
    look l;
    contact->touches = list;
    if (contact->press) { /* friction asks for all other forces */
        begin_look(domain, scratch, state, &l);
    } else {
        enter_look(domain, scratch, state, &l);
        lar_interactions_forget(&scratch->interactions);
        lar_tool_contact_apply(contact, &l.context, &l.state);
    }
    contact->touches = NULL;
    end_look(&l);
}

double lar_measure_element_energy(const lar_domain *domain, const lar_state *state, lar_gid e) {
    double hourglass, energy = element_energy(domain, state, e, &hourglass);
    return energy + hourglass;
}

double lar_measure_stress(const lar_domain *domain, const lar_state *state, lar_gid e,
                          double cauchy[6]) {
    double corner[8][3], u[8][3];
    const lar_material now = lar_activation_material(domain, e, lar_state_time(domain, state));
    const lar_material *material = &now;
    lar_mesh_corners(&domain->model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    if (domain->kind != LAR_ELEMENT_HEX8) {
        lar_hex8_full_stress(corner, material, u, cauchy);
        return lar_hex8_full_energy(corner, material, u) / lar_hexahedron_volume(corner);
    }
    double F[3][3], P[3][3];
    lar_hex8 hex8;
    lar_hex8_prepare(corner, material, &hex8);
    lar_hex8_gradient(&hex8, u, F);
    double fibre[6];
    lar_model_fibres(domain->model, e, fibre);
    double J = lar_material_stress(material, fibre, F, P), history[LAR_HISTORY_MAX];
    if (lar_viscous_here(domain, e))
        look_at_history(domain, state, e, (const double(*)[3])F, history, P);
    lar_cauchy_stress(F, P, J, cauchy);
    return lar_material_energy(material, fibre, F);
}

void lar_measure_add(const lar_domain *domain, const lar_state *state, lar_gid node,
                     const double force[3], const double about[3], double *sum) {
    double arm[3], turn[3];
    for (int i = 0; i < 3; i++) sum[i] += force[i];
    if (!about) return;
    lar_state_displacement(state, domain->layout.local[node], arm);
    for (int i = 0; i < 3; i++) arm[i] += domain->model->mesh.position[node][i] - about[i];
    lar_cross(arm, force, turn);
    for (int i = 0; i < 3; i++) sum[3 + i] += turn[i];
}

lar_status lar_measure_reaction(const lar_domain *domain, lar_measure_scratch *scratch,
                                const lar_state *state, const lar_node_list *nodes, bool arriving,
                                const double about[3], double *sum, lar_error *error) {
    const lar_condition_notes *supports = &scratch->interactions.notes;
    const lar_conditions *springs = &domain->surroundings.conditions;
    size_t count = (size_t)domain->layout.node_padded;
    bool *wanted = lar_calloc(count, sizeof *wanted);
    if (!wanted) return lar_fail_memory(error, count * sizeof *wanted, "the sum of reactions");
    for (int32_t i = 0; i < nodes->count; i++) wanted[domain->layout.local[nodes->node[i]]] = true;
    look l;
    begin_look(domain, scratch, state, &l);
    memset(sum, 0, (about ? 6 : 3) * sizeof *sum);
    arriving = arriving || state->step == 0;
    for (int32_t i = 0; i < supports->constraint_count; i++) {
        const lar_constraint *c = &supports->constraint[i];
        if (!wanted[c->node]) continue;
        const bool free = c->curve == LAR_CURVE_TOOL && domain->model->tool[c->rigid].free;
        const double ahead =
            arriving && !free ? state->v[lar_constraint_at(state, c)] : supported_velocity(&l, c);
        double force[3] = {0};
        force[c->axis] = support_force(&l, c, ahead);
        lar_measure_add(domain, state, domain->layout.global[c->node], force, about, sum);
    }
    for (int32_t i = 0; i < springs->spring_count; i++) {
        const lar_point_spring *s = &springs->spring[i];
        if (!wanted[s->node]) continue;
        double force[3];
        lar_state_displacement(state, s->node, force);
        for (int axis = 0; axis < 3; axis++) force[axis] *= -s->stiffness;
        lar_measure_add(domain, state, domain->layout.global[s->node], force, about, sum);
    }
    end_look(&l);
    free(wanted);
    return LAR_OK;
}

/* ---- nodal forces by cause -----------------------------------------------------------------
 *
 * What acts from u_n on takes v-, half a step back, to v+, half a step ahead, over the mean step h:
 *
 *     m (v+ - v-) / h  =  elements + tools + bodies + loads + m g - c m (v- + v+) / 2
 *                         + planes + supports
 *
 * Forces are summed up in whole units as the step sums them up. A plane's is what changes the free
 * v+ into the one that it lets be, a support's is all that is left open.
 */

static void take_sums(const lar_domain *domain, const int64_t *sum, double sign,
                      double (*force)[3]) {
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++)
        for (int i = 0; i < 3; i++) /* never -0 */
            force[g][i] = 0.0 + sign * ((double)sum[(size_t)domain->layout.local[g] +
                                                    (size_t)i * domain->layout.axis_stride] /
                                        domain->scale);
}

static void take_weights(const look *l, double (*force)[3]) {
    for (lar_gid g = 0; g < l->domain->model->mesh.node_count; g++)
        for (int i = 0; i < 3; i++)
            force[g][i] = lar_domain_weighs(l->domain, l->domain->layout.local[g]) * l->gravity[i];
}

/* Of held axes what the plane would change goes into the support. */
static void take_planes(const look *l, double (*force)[3]) {
    const lar_domain *domain = l->domain;
    const lar_planes *planes = planes_of(l);
    double h = mean_step(l), half = 0.5 * damping_of(l) * h;
    for (int32_t entry = 0; entry < planes->count;) {
        lar_lid n = planes->node[entry].node;
        lar_gid g = domain->layout.global[n];
        double free[3], ahead[3];
        entry = stop_at_planes(l, entry, free, ahead);
        for (int i = 0; i < 3; i++)
            if (!(supports_of(l)->held[g] >> i & 1))
                force[g][i] = domain->mass[n] * (1 + half) * (ahead[i] - free[i]) / h;
    }
}

/* What tissue pulls at a node with that a tool moves, the tool pushes with [N]. */
static double carried_force(const look *l, const lar_constraint *c) {
    return c->curve == LAR_CURVE_TOOL
               ? (double)l->state.force[lar_constraint_at(&l->state, c)] / l->domain->scale
               : 0;
}

/* But for what tools count as theirs. */
static void take_supports(const look *l, double (*force)[3]) {
    const lar_condition_notes *supports = supports_of(l);
    for (int32_t i = 0; i < supports->constraint_count; i++) {
        const lar_constraint *c = &supports->constraint[i];
        force[l->domain->layout.global[c->node]][c->axis] =
            support_force(l, c, supported_velocity(l, c)) - carried_force(l, c);
    }
}

/* What planes push free bodies with, which are supported for all others: their supports are the
 * bodies. `times`: 1 or -1. */
static void add_landings(const look *l, lar_measure_scratch *scratch, double times,
                         double (*force)[3]) {
    if (!scratch->ahead) return;
    const double h = mean_step(l), half = 0.5 * damping_of(l) * h;
    const lar_landed landed = {times * (1 + half) / h, force};
    const lar_leapfrog leapfrog =
        lar_step_leapfrog_at(l->domain, l->interactions, &l->context, &l->state);
    *scratch->ahead = *l->interactions->tool_contact.tools;
    lar_free_bodies_go(l->domain, supports_of(l), &l->state, &leapfrog, scratch->ahead, &landed);
}

static void take_damping(const look *l, double (*force)[3]) {
    const lar_domain *domain = l->domain;
    const lar_planes *planes = planes_of(l);
    const lar_condition_notes *supports = supports_of(l);
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++) /* v+ first */
        for (int i = 0; i < 3; i++) force[g][i] = next_velocity(l, domain->layout.local[g], i);
    for (int32_t entry = 0; entry < planes->count;) {
        double free[3];
        lar_gid g = domain->layout.global[planes->node[entry].node];
        entry = stop_at_planes(l, entry, free, force[g]);
    }
    for (int32_t i = 0; i < supports->constraint_count; i++) {
        const lar_constraint *c = &supports->constraint[i];
        force[domain->layout.global[c->node]][c->axis] = supported_velocity(l, c);
    }
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++) {
        lar_lid n = domain->layout.local[g];
        for (int i = 0; i < 3; i++)
            force[g][i] = 0.0 - 0.5 * damping_of(l) * domain->mass[n] *
                                    (force[g][i] + l->state.v[lar_state_at(&l->state, n, i)]);
    }
}

static void take_part(const lar_domain *domain, lar_measure_scratch *scratch,
                      const lar_state *state, lar_acting what, double (*force)[3]) {
    lar_fault ignored = {0};
    look l;
    enter_look(domain, scratch, state, &l);
    lar_step_forces_of(domain, l.interactions, what, &l.state, &ignored);
    take_sums(domain, l.state.force, -1, force);
    end_look(&l);
}

static void take_carried(const lar_domain *domain, lar_measure_scratch *scratch,
                         const lar_state *state, int32_t tool, double (*force)[3]) {
    look l;
    memset(force, 0, (size_t)domain->model->mesh.node_count * sizeof *force);
    begin_look(domain, scratch, state, &l);
    const lar_condition_notes *supports = supports_of(&l);
    for (int32_t i = supports->fixed_count; i < supports->constraint_count; i++) {
        const lar_constraint *c = &supports->constraint[i];
        if (c->curve == LAR_CURVE_TOOL && c->rigid == tool)
            force[domain->layout.global[c->node]][c->axis] = carried_force(&l, c);
    }
    end_look(&l);
}

static lar_status take_tool(const lar_domain *domain, lar_measure_scratch *scratch,
                            const lar_state *state, int32_t tool, double (*force)[3],
                            lar_error *error) {
    size_t stride = domain->layout.axis_stride, values = 3 * stride;
    lar_touch_list list = {
        .tool = tool, .on_nodes = lar_calloc(values, sizeof *list.on_nodes), .stride = stride};
    if (!list.on_nodes)
        return lar_fail_memory(error, values * sizeof *list.on_nodes, "forces on nodes");
    lar_measure_touches(domain, scratch, state, &list);
    take_sums(domain, list.on_nodes, 1, force);
    free(list.on_nodes);
    return LAR_OK;
}

lar_status lar_measure_nodal_forces(const lar_domain *domain, lar_measure_scratch *scratch,
                                    const lar_state *state, lar_cause cause, int32_t tool,
                                    double (*force)[3], lar_error *error) {
    look l;
    const lar_tool_list *list = domain->surroundings.list;
    if (cause == LAR_CAUSE_TOOL && list && list->tool[tool].shape == LAR_TOOL_RIGID) {
        take_carried(domain, scratch, state, tool, force);
        return LAR_OK;
    }
    if (cause == LAR_CAUSE_TOOL) return take_tool(domain, scratch, state, tool, force, error);
    if (cause == LAR_CAUSE_ELEMENTS)
        take_part(domain, scratch, state, LAR_ACTING_ELEMENTS, force);
    else if (cause == LAR_CAUSE_BODIES)
        take_part(domain, scratch, state, LAR_ACTING_BODIES, force);
    else if (cause == LAR_CAUSE_LOADS)
        take_part(domain, scratch, state, LAR_ACTING_LOADS, force);
    if (cause < LAR_CAUSE_PLANES) return LAR_OK;
    memset(force, 0, (size_t)domain->model->mesh.node_count * sizeof *force);
    begin_look(domain, scratch, state, &l);
    if (cause == LAR_CAUSE_GRAVITY)
        take_weights(&l, force);
    else if (cause == LAR_CAUSE_PLANES)
        take_planes(&l, force);
    else if (cause == LAR_CAUSE_SUPPORTS)
        take_supports(&l, force);
    if (cause == LAR_CAUSE_PLANES || cause == LAR_CAUSE_SUPPORTS)
        add_landings(&l, scratch, cause == LAR_CAUSE_PLANES ? 1 : -1, force);
    if (cause == LAR_CAUSE_DAMPING) take_damping(&l, force);
    end_look(&l);
    return LAR_OK;
}
