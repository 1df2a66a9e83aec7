#include "step/measure.h"

#include <stdlib.h>
#include <string.h>

#include "step/guard.h"
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
    return lar_hex8_energy(&hex8, lar_domain_material(domain, e), u, hourglass) +
           lar_guard_energy(domain, state, e);
}

static double damping_of(const lar_domain *domain) {
    return lar_damping_of(domain->model, lar_settings_of(&domain->interactions));
}

static void gravity_at(const lar_domain *domain, double time, double gravity[3]) {
    lar_gravity_at(domain->model, lar_settings_of(&domain->interactions), time, gravity);
}

/* That of which forces change the velocities next: between the last part and the next one. */
static double mean_step(const lar_domain *domain, const lar_state *state) {
    return lar_mean_step(domain, lar_division_of(&domain->interactions), state);
}

/* The velocity half a step ahead of an unsupported value, as the update kernel would make it. */
static double next_velocity(const lar_domain *domain, const lar_state *state, int32_t value,
                            const double gravity[3]) {
    lar_leapfrog leapfrog = lar_step_leapfrog(domain, &domain->interactions, state);
    double step = mean_step(domain, state);
    double half = 0.5 * damping_of(domain) * step;
    double drift = gravity[value % 4] * step / (1 + half);
    return leapfrog.keep * state->v[value] + drift -
           leapfrog.push * domain->push[value / 4] * (double)state->force[value];
}

/* Length of the next step, or of its parts. */
static double part_of_step(const lar_domain *domain) {
    return domain->time_step / lar_division_of(&domain->interactions)->parts;
}

/* Kinetic energy of one value, and half of the present step's share of damping. */
static void add_kinetic(const lar_domain *domain, const lar_state *state, int32_t value,
                        double ahead, lar_energy *energy) {
    double mass = domain->mass[value / 4], behind = state->v[value];
    energy->kinetic += 0.5 * mass * behind * ahead;
    energy->damping +=
        0.25 * damping_of(domain) * mean_step(domain, state) * mass * behind * (behind + ahead);
}

/* What a support exerts on a value: all that the rest of the equation of motion leaves open. */
static double support_force(const lar_domain *domain, const lar_state *state,
                            const lar_constraint *constraint, double ahead,
                            const double gravity[3]) {
    int32_t value = constraint->value;
    double behind = state->v[value];
    double inertia =
        (ahead - behind) / mean_step(domain, state) + 0.5 * damping_of(domain) * (ahead + behind);
    return domain->mass[value / 4] * (inertia - gravity[value % 4]) +
           (double)state->force[value] / domain->scale;
}

static double gravity_potential(const lar_domain *domain, const lar_state *state,
                                const double gravity[3]) {
    double work = 0;
    for (int32_t n = 0; n < domain->layout.node_count; n++)
        for (int i = 0; i < 3; i++) work += domain->mass[n] * gravity[i] * state->u[4 * n + i];
    return work;
}

/* The velocity half a step ahead of a supported value. */
static double supported_velocity(const lar_domain *domain, const lar_state *state,
                                 const lar_constraint *constraint) {
    double time = lar_state_time(domain, state), dt = part_of_step(domain);
    return (lar_constraint_value(domain->model, constraint, time + dt) -
            lar_constraint_value(domain->model, constraint, time)) /
           dt;
}

/* Nodes that planes stop in this step: what add_kinetic has counted for them as free nodes, and
 * half of what the stop takes. */
static void add_stops(const lar_domain *domain, const lar_state *state, const double gravity[3],
                      lar_energy *energy) {
    const lar_plane_contact *plane_contact = &domain->interactions.tool_contact.plane_contact;
    lar_condition_context context = lar_domain_context(domain);
    context.time_step = part_of_step(domain);
    double half = 0.5 * damping_of(domain) * mean_step(domain, state);
    for (int32_t entry = 0; entry < plane_contact->count;) {
        int32_t value = plane_contact->node[entry].value;
        double free[3], ahead[3], mass = domain->mass[value / 4];
        for (int i = 0; i < 3; i++) { /* what supports hold goes on as it does */
            const lar_plane_way *way = &plane_contact->way[plane_contact->node[entry].way];
            bool held = way->slide[i] == 0 && way->normal[i] != 0;
            free[i] = held ? state->v[value + i] : next_velocity(domain, state, value + i, gravity);
            ahead[i] = free[i];
        }
        entry = lar_plane_contact_ahead(plane_contact, &context, state, entry, ahead);
        for (int i = 0; i < 3; i++) {
            double change = ahead[i] - free[i], behind = state->v[value + i];
            energy->kinetic += 0.5 * mass * behind * change;
            energy->damping += 0.5 * half * mass * behind * change;
            energy->contact -= 0.5 * mass * (1 + half) * change * behind;
        }
    }
}

/* Kinetic energy, damping and the work of moved supports: free values first, then the supported. */
static void add_motion(const lar_domain *domain, const lar_state *state, const double gravity[3],
                       lar_energy *energy) {
    const lar_conditions *conditions = &domain->interactions.conditions;
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++)
        for (int i = 0; i < 3; i++) {
            int32_t value = 4 * domain->layout.local[g] + i;
            if (conditions->held[g] >> i & 1) continue;
            add_kinetic(domain, state, value, next_velocity(domain, state, value, gravity), energy);
        }
    add_stops(domain, state, gravity, energy);
    for (int32_t i = 0; i < conditions->constraint_count; i++) {
        const lar_constraint *c = &conditions->constraint[i];
        double ahead = supported_velocity(domain, state, c);
        add_kinetic(domain, state, c->value, ahead, energy);
        if (c->curve >= 0)
            energy->external += 0.5 * mean_step(domain, state) * state->v[c->value] *
                                support_force(domain, state, c, ahead, gravity);
    }
}

/* The first half of the present step's work of tools and bodies, as the loads'. */
static void add_contact(const lar_domain *domain, const lar_condition_context *context,
                        lar_state *state, lar_energy *energy) {
    double external = state->external, contact = state->contact;
    lar_tool_contact_half_work(&domain->interactions.tool_contact, context, state);
    lar_body_contact_half_work(&domain->interactions.body_contact, context, state);
    energy->external += state->external - external;
    energy->contact += state->contact - contact;
    state->external = external;
    state->contact = contact;
}

static void clear_forces(const lar_domain *domain, lar_state *state) {
    memset(state->force, 0, 4 * (size_t)domain->layout.node_padded * sizeof *state->force);
}

void lar_measure_energy(lar_domain *domain, lar_state *state, lar_energy *energy) {
    lar_condition_context context = lar_domain_context(domain);
    double time = lar_state_time(domain, state), gravity[3];
    lar_step_enter(domain, &domain->interactions, &context, state);
    gravity_at(domain, time, gravity);
    lar_fault ignored = {0};
    lar_step_forces(domain, state, &ignored);

    *energy = (lar_energy){.external = state->external,
                           .contact = state->contact,
                           .damping = 0.25 * domain->time_step * state->damped};
    energy->external +=
        lar_conditions_half_work(&domain->interactions.conditions, &context, time, state);
    add_contact(domain, &context, state, energy);
    if (!lar_gravity_varies(domain->model, lar_settings_of(&domain->interactions)))
        energy->external += gravity_potential(domain, state, gravity);
    add_motion(domain, state, gravity, energy);
    clear_forces(domain, state);

    for (lar_gid e = 0; e < domain->model->mesh.element_count; e++) {
        double hourglass;
        energy->strain += element_energy(domain, state, e, &hourglass);
        energy->hourglass += hourglass;
    }
}

double lar_measure_element_energy(const lar_domain *domain, const lar_state *state, lar_gid e) {
    double hourglass, energy = element_energy(domain, state, e, &hourglass);
    return energy + hourglass;
}

double lar_measure_stress(const lar_domain *domain, const lar_state *state, lar_gid e,
                          double cauchy[6]) {
    double corner[8][3], u[8][3];
    const lar_material *material = lar_domain_material(domain, e);
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
    double J = lar_law_stress(material, F, P);
    lar_cauchy_stress(F, P, J, cauchy);
    return lar_law_energy(material, F);
}

lar_status lar_measure_reaction(lar_domain *domain, lar_state *state, const lar_node_list *nodes,
                                double sum[3], lar_error *error) {
    const lar_conditions *conditions = &domain->interactions.conditions;
    size_t count = (size_t)domain->layout.node_padded;
    bool *wanted = lar_calloc(count, sizeof *wanted);
    if (!wanted) return lar_fail_memory(error, count * sizeof *wanted, "the sum of reactions");
    for (int32_t i = 0; i < nodes->count; i++) wanted[domain->layout.local[nodes->node[i]]] = true;
    double gravity[3];
    gravity_at(domain, lar_state_time(domain, state), gravity);
    lar_fault ignored = {0};
    lar_step_forces(domain, state, &ignored);
    memset(sum, 0, 3 * sizeof *sum);
    for (int32_t i = 0; i < conditions->constraint_count; i++) {
        const lar_constraint *c = &conditions->constraint[i];
        if (!wanted[c->value / 4]) continue;
        double ahead = supported_velocity(domain, state, c);
        sum[c->value % 4] += support_force(domain, state, c, ahead, gravity);
    }
    clear_forces(domain, state);
    free(wanted);
    return LAR_OK;
}
