/* Gravity, damping, stiffness and forces on nodes while a simulation runs, as the public header has
 * them.
 *
 * A change acts from the present step on. Whoever changes gravity or stiffness does work, which the
 * energy account gets here. With the velocity v- half a step back, and what central differences
 * have ahead of it, a force that changes by dF at the displacement u changes the kinetic energy
 * m v- v+ / 2 by dt dF v- / 2, and
 *
 *     gravity      is a potential, which jumps by -m dg u        external += m dg (dt v-/2 - u)
 *     materials    W jumps by dW, the inner force by df          external += dW - dt df v-/2
 *
 * Damping does no work when it changes. Nor do forces that are set on nodes: their work is counted
 * in halves, before and after nodes move, so that the half of a force that begins belongs to its
 * first step (contact/conditions.h). */
#include <string.h>

#include "step/folds.h"
#include "step/guard.h"
#include "step/viscous_history.h"
#include "simulation/simulation.h"
#include "mechanics/hex8_full.h"
#include "mechanics/hex8_matrix.h"
#include "mechanics/viscous/change.h"

/* Of the step that follows. */
static double length_of_step(const lar_simulation *simulation) {
    return simulation->domain.time_step / simulation->tools.division.parts;
}

/* The state is whole. Of several processors the first one keeps what belongs to nobody. */
void lar_simulation_add_external(lar_simulation *simulation, double work) {
    lar_computer *computer = simulation->computer;
    simulation->state.external += work;
    if (computer) computer->processor[0].worker[0].state.external += work;
}

/* ---- gravity -------------------------------------------------------------------------------- */

/* m g (dt v-/2 - u) of all nodes [J]; 0 for gravity that follows a curve, whose work is counted
 * step by step. */
static double gravity_account(const lar_simulation *simulation, const lar_settings *settings) {
    const lar_domain *domain = &simulation->domain;
    const lar_state *state = &simulation->state;
    double gravity[3], half = 0.5 * length_of_step(simulation), sum = 0;
    if (lar_gravity_varies(domain->model, settings)) return 0;
    lar_gravity_at(domain->model, settings, 0, 0, gravity);
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++) {
        lar_lid n = domain->layout.local[g];
        double u[3], v[3];
        lar_state_displacement(state, n, u);
        lar_state_velocity(state, n, v);
        double mass = lar_domain_weighs(domain, n);
        for (int i = 0; i < 3; i++) sum += mass * gravity[i] * (half * v[i] - u[i]);
    }
    return sum;
}

lar_status lar_simulation_set_gravity(lar_simulation *simulation, const double gravity[3],
                                      lar_error *error) {
    lar_status status =
        lar_simulation_check_change(simulation, "lar_simulation_set_gravity", error);
    if (status) return status;
    lar_settings wanted = simulation->tools.settings;
    wanted.gravity_set = gravity != NULL;
    for (int i = 0; i < 3; i++) wanted.gravity[i] = gravity ? gravity[i] : 0;
    const double *g = wanted.gravity;
    if (!(g[0] * g[0] + g[1] * g[1] + g[2] * g[2] <= LAR_GRAVITY_MAX * LAR_GRAVITY_MAX))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a gravity of (%g, %g, %g) m/s^2; it is at most %g m/s^2 long", g[0], g[1],
                        g[2], LAR_GRAVITY_MAX);
    status = lar_simulation_gather(simulation, error);
    if (status) return status;
    double before = gravity_account(simulation, &simulation->tools.settings);
    lar_simulation_add_external(simulation, gravity_account(simulation, &wanted) - before);
    simulation->tools.settings = wanted;
    return lar_simulation_set_anew(simulation, error);
}

void lar_simulation_gravity(const lar_simulation *simulation, double gravity[3]) {
    if (!gravity) return;
    for (int i = 0; i < 3; i++) gravity[i] = 0;
    if (!simulation) return;
    lar_gravity_at(simulation->domain.model, &simulation->tools.settings,
                   lar_simulation_time(simulation), 0, gravity);
}

/* ---- damping -------------------------------------------------------------------------------- */

lar_status lar_simulation_set_damping(lar_simulation *simulation, double damping,
                                      lar_error *error) {
    lar_status status =
        lar_simulation_check_change(simulation, "lar_simulation_set_damping", error);
    if (status) return status;
    double time_step = simulation->domain.time_step;
    if (!lar_damping_fits(damping, time_step))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a damping of %g 1/s; it is 0 or more, and with a time step of %.3g s less "
                        "than %.3g 1/s",
                        damping, time_step, 2 / time_step);
    lar_settings *settings = &simulation->tools.settings;
    settings->damping_set = damping != simulation->domain.model->damping;
    settings->damping = settings->damping_set ? damping : 0;
    return lar_simulation_set_anew(simulation, error);
}

double lar_simulation_damping(const lar_simulation *simulation) {
    if (!simulation) return 0;
    return lar_damping_of(simulation->domain.model, &simulation->tools.settings);
}

/* ---- stiffness ------------------------------------------------------------------------------ */

/* Element `e` of the whole model, ready, as stiff as it is now; NULL: not of kind hex8. */
typedef struct body_element {
    lar_gid e;
    const lar_hex8 *hex8;
} body_element;

/* The same of what its viscous terms have taken, and of their forces. */
static double viscous_account(const lar_simulation *simulation, const body_element *element,
                              const double u[8][3], const double v[8][3], double half) {
    const lar_domain *domain = &simulation->domain;
    double F[3][3], rate[3][3], P[3][3], rest[3][3], history[LAR_HISTORY_MAX], power = 0;
    if (!lar_viscous_here(domain, element->e)) return 0;
    const lar_material *material = lar_domain_material(domain, element->e);
    double factor = domain->factor[lar_factor_of(domain->model->element_material[element->e])];
    double past =
        lar_past_step(domain, lar_division_of(&simulation->interactions), &simulation->state);
    lar_hex8_gradient(element->hex8, u, F);
    lar_hex8_gradient(element->hex8, v, rate);
    lar_viscous_read(domain, &simulation->state, element->e, history);
    const double *fibre = element->hex8->fibre;
    lar_viscous_stress_at(material, factor, past, fibre, (const double(*)[3])F, history, P);
    lar_material_stress(material, fibre, (const double(*)[3])F, rest);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) power += (P[i][j] - rest[i][j]) * (rate[i][j] - (i == j));
    return element->hex8->volume * (factor * history[LAR_HISTORY_WORK] - half * power);
}

/* Energy of an element less dt f v-/2 with its material as it is [J]. (Of barriers the energy only:
 * their force in half a step is nothing beside it.) The element's nodes are numbered differently in
 * its block, so corners are those of the layout. */
static double element_account(const lar_simulation *simulation, const body_element *element,
                              double half) {
    const lar_domain *domain = &simulation->domain;
    lar_material passive = *lar_domain_material(domain, element->e);
    const lar_material *material = &passive;
    const lar_state *state = &simulation->state;
    passive.fibre.along = passive.fibre.across = 0; /* what is active stays as it is */
    double u[8][3], v[8][3], force[8][3], hourglass = 0, account;
    if (element->hex8) {
        const lar_gid *node = domain->layout.corner[element->e];
        for (int a = 0; a < 8; a++) {
            lar_state_displacement(state, domain->layout.local[node[a]], u[a]);
            lar_state_velocity(state, domain->layout.local[node[a]], v[a]);
        }
        account = lar_hex8_energy(element->hex8, material, (const double(*)[3])u, &hourglass) +
                  lar_guard_energy(domain, state, element->e) +
                  lar_folds_energy(domain, state, element->e) + hourglass;
        lar_hex8_force(element->hex8, material, (const double(*)[3])u, force);
        account += viscous_account(simulation, element, (const double(*)[3])u,
                                   (const double(*)[3])v, half);
    } else {
        double corner[8][3];
        lar_mesh_corners(&domain->model->mesh, element->e, corner);
        lar_domain_corners(domain, state->u, element->e, u);
        lar_domain_corners(domain, state->v, element->e, v);
        account = lar_hex8_full_energy((const double(*)[3])corner, material, (const double(*)[3])u);
        lar_hex8_full_force((const double(*)[3])corner, material, (const double(*)[3])u, force);
    }
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) account -= half * force[a][i] * v[a][i];
    return account;
}

/* How often the accounts of materials count that become others, before and after; by factor. An
 * account is linear in the stiffness: with other parameters alone it has to be looked at again. */
static void weigh_changes(const lar_tools *now, const lar_settings *wanted,
                          const lar_parameters *parameters, double before[LAR_FACTORS_MAX],
                          double after[LAR_FACTORS_MAX]) {
    const lar_parameters *list[] = {&now->parameters, parameters};
    bool set = memcmp(&now->parameters, parameters, sizeof *parameters) != 0;
    for (int i = 0; i < LAR_FACTORS_MAX; i++) {
        before[i] = 1 - wanted->factor[i] / now->settings.factor[i];
        after[i] = 0;
    }
    for (int k = 0; k < 2 && set; k++)
        for (int32_t m = 0; m < list[k]->count; m++) {
            int i = lar_factor_of(list[k]->entry[m].material);
            before[i] = after[i] = 1;
        }
}

/* The accounts of all elements, so often [J]. */
static double materials_account(const lar_simulation *simulation,
                                const double times[LAR_FACTORS_MAX]) {
    const lar_domain *domain = &simulation->domain;
    double half = 0.5 * length_of_step(simulation), sum = 0;
    for (int32_t r = 0; r < domain->run_count; r++)
        for (int32_t k = 0; k < LAR_BLOCK * domain->run[r].count; k++) {
            int32_t b = domain->run_first[r] + k / LAR_BLOCK;
            lar_hex8 hex8;
            body_element element = {.e = domain->layout.block[b].element[k % LAR_BLOCK]};
            if (element.e < 0) continue;
            double often = times[lar_factor_of(domain->model->element_material[element.e])];
            if (often == 0) continue;
            if (domain->kind == LAR_ELEMENT_HEX8) {
                lar_domain_element(domain, r, b, k % LAR_BLOCK, &hex8);
                element.hex8 = &hex8;
            }
            sum += often * element_account(simulation, &element, half);
        }
    return sum;
}

/* Viscous elements of a material whose parameters change go on remembering as if the new law had
 * been there. Whether there are any. */
static bool change_memories(lar_simulation *simulation, const lar_parameters *before,
                            const lar_parameters *after) {
    const lar_domain *domain = &simulation->domain;
    const lar_model *model = domain->model;
    bool any = false;
    for (int32_t m = 0; m < model->material_count && domain->element_history; m++) {
        const lar_parameter_entry then = lar_parameters_at(before, model, m),
                                  now = lar_parameters_at(after, model, m);
        const lar_material from = lar_parameters_give(model, &then),
                           to = lar_parameters_give(model, &now);
        if (memcmp(then.value, now.value, sizeof now.value) == 0) continue;
        for (lar_gid e = 0; e < model->mesh.element_count; e++) {
            double history[LAR_HISTORY_MAX], fibre[6];
            if (model->element_material[e] != m || !lar_viscous_here(domain, e)) continue;
            lar_model_fibres(model, e, fibre);
            lar_viscous_read(domain, &simulation->state, e, history);
            lar_viscous_change(&from, &to, fibre, history);
            lar_viscous_write(domain, &simulation->state, e, history);
            any = true;
        }
    }
    return any;
}

lar_status lar_simulation_change_materials(lar_simulation *simulation, const lar_settings *wanted,
                                           const lar_parameters *parameters, lar_error *error) {
    lar_tools *tools = &simulation->tools;
    double before[LAR_FACTORS_MAX], after[LAR_FACTORS_MAX], work;
    if (!lar_parameters_bearable(parameters, wanted))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "stiffness and parameters of a material together would make its elements "
                        "so fast that steps had to be divided more than they can be for that: the "
                        "square of a frequency at rest may become %g times what it is by the "
                        "model; set softer ones, or change the model's materials",
                        LAR_STIFFNESS_MAX);
    lar_status status = lar_simulation_gather(simulation, error);
    if (status) return status;
    weigh_changes(tools, wanted, parameters, before, after);
    work = -materials_account(simulation, before);
    bool remembered = change_memories(simulation, &tools->parameters, parameters);
    tools->settings = *wanted;
    tools->parameters = *parameters;
    tools->division.due = 1;
    lar_simulation_settle(simulation);
    lar_simulation_add_external(simulation, work + materials_account(simulation, after));
    lar_simulation_set(simulation);
    if (!remembered || !simulation->computer) return LAR_OK;
    return lar_computer_remember(simulation->computer, error);
}

lar_status lar_simulation_set_stiffness(lar_simulation *simulation, int32_t material, double factor,
                                        lar_error *error) {
    lar_status status =
        lar_simulation_check_change(simulation, "lar_simulation_set_stiffness", error);
    if (status) return status;
    int32_t count = simulation->domain.model->material_count;
    if (material < -1 || material >= count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no material %ld; the model has %ld, counted from 0, and -1 means "
                        "all",
                        (long)material, (long)count);
    if (!(factor >= LAR_STIFFNESS_MIN && factor <= LAR_STIFFNESS_MAX))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a stiffness of %g times the model's; it is %g to %g times, change the "
                        "model's materials for more",
                        factor, LAR_STIFFNESS_MIN, LAR_STIFFNESS_MAX);
    lar_settings wanted = simulation->tools.settings;
    for (int i = 0; i < LAR_FACTORS_MAX; i++)
        if (material < 0 || i == lar_factor_of(material)) wanted.factor[i] = factor;
    if (memcmp(&wanted, &simulation->tools.settings, sizeof wanted) == 0) return LAR_OK;
    return lar_simulation_change_materials(simulation, &wanted, &simulation->tools.parameters,
                                           error);
}

double lar_simulation_stiffness(const lar_simulation *simulation, int32_t material) {
    int32_t count = simulation ? simulation->domain.model->material_count : 0;
    if (material < 0 || material >= count) return 0;
    return simulation->tools.settings.factor[lar_factor_of(material)];
}

/* ---- forces on nodes ------------------------------------------------------------------------- */

static lar_status put_force(lar_simulation *simulation, const lar_force_entry *entry,
                            lar_error *error) {
    double max = lar_domain_force_max(&simulation->domain);
    const double *f = entry->force;
    if (!lar_force_good(entry, simulation->domain.model, max))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a force of (%g, %g, %g) N on a node; this material bears components up "
                        "to %.3g N, check the unit",
                        f[0], f[1], f[2], max);
    if (!lar_forces_put(&simulation->tools.forces, entry))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d forces are set already; remove one, or give nodes of one force a set",
                        LAR_FORCES_MAX);
    return lar_simulation_set_anew(simulation, error);
}

static void take_force(lar_force_entry *entry, const double force[3]) {
    for (int i = 0; i < 3 && force; i++) entry->force[i] = force[i];
}

lar_status lar_simulation_set_force(lar_simulation *simulation, int32_t node, const double force[3],
                                    lar_error *error) {
    lar_status status = lar_simulation_check_change(simulation, "lar_simulation_set_force", error);
    if (status) return status;
    int32_t count = simulation->domain.model->mesh.node_count;
    bool all = node == -1 && !force;
    if (!all && (node < 0 || node >= count))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no node %ld; the model has %ld, counted from 0, and -1 without a "
                        "force removes all forces that were set",
                        (long)node, (long)count);
    lar_force_entry entry = {.of = node};
    take_force(&entry, force);
    if (!all) return put_force(simulation, &entry, error);
    simulation->tools.forces = (lar_forces){0};
    return lar_simulation_set_anew(simulation, error);
}

lar_status lar_simulation_force_set(const lar_model *model, const char *name, int32_t *index,
                                    lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    const lar_set *set = name ? lar_mesh_find_set(mesh, name, LAR_SET_NODES) : NULL;
    if (!set)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the model has no set of nodes '%.100s'; lar_model_set names those that "
                        "there are",
                        name ? name : "");
    *index = (int32_t)(set - mesh->set);
    return LAR_OK;
}

lar_status lar_simulation_set_force_at(lar_simulation *simulation, int32_t set,
                                       const double force[3], lar_error *error) {
    lar_status status =
        lar_simulation_check_change(simulation, "lar_simulation_set_force_on", error);
    if (status) return status;
    const lar_mesh *mesh = &simulation->domain.model->mesh;
    if (set < 0 || set >= mesh->set_count || mesh->set[set].kind != LAR_SET_NODES)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "set %ld of the model is none of nodes",
                        (long)set);
    lar_force_entry entry = {.of = set, .on_set = 1};
    take_force(&entry, force);
    return put_force(simulation, &entry, error);
}

lar_status lar_simulation_set_force_on(lar_simulation *simulation, const char *set,
                                       const double force[3], lar_error *error) {
    int32_t index = 0;
    lar_status status =
        lar_simulation_check_change(simulation, "lar_simulation_set_force_on", error);
    if (!status) status = lar_simulation_force_set(simulation->domain.model, set, &index, error);
    return status ? status : lar_simulation_set_force_at(simulation, index, force, error);
}

void lar_simulation_force(const lar_simulation *simulation, int32_t node, double force[3]) {
    if (!force) return;
    for (int i = 0; i < 3; i++) force[i] = 0;
    if (simulation) lar_forces_at(&simulation->tools.forces, simulation->domain.model, node, force);
}
