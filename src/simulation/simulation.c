#include "simulation/simulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/vector.h"
#include "contact/tool_body.h"
#include "simulation/field.h"
#include "step/domain_share.h"
#include "step/mass/heavier.h"
#include "step/rigid/firm.h"
#include "step/rigid/free_body.h"
#include "step/viscous_history.h"
#include "step/measure.h"

lar_options lar_options_default(void) {
    return (lar_options){.element = LAR_ELEMENT_HEX8, .isa = LAR_ISA_AUTO, .listener = -1};
}

/* Why a step is so long that no damping would do: a material that is no body's, whose units are
 * wrong. The limits are those of the command's notes. */
static void explain_long_step(const lar_model *model, char *text, size_t size) {
    static const double HEAVY = 3e4, SOFT = 10; /* [kg/m^3], [Pa] */
    *text = '\0';
    for (int i = 0; i < model->material_count && !*text; i++) {
        const lar_material *m = &model->material[i];
        const double shear = lar_material_shear(m);
        if (m->density > HEAVY)
            snprintf(text, size,
                     ". It is so long for material %d has a density of %.4g; densities are in "
                     "kg/m^3, water has 1000",
                     i + 1, m->density);
        else if (shear < SOFT)
            snprintf(text, size,
                     ". It is so long for material %d has a shear modulus of %.4g; moduli are in "
                     "pascals, soft organs have some thousand",
                     i + 1, shear);
    }
}

/* Within one step damping can stop a node, but not turn it around: v' = keep v needs keep > 0. */
static lar_status check_damping(const lar_domain *domain, lar_error *error) {
    const lar_model *model = domain->model;
    if (domain->leapfrog.keep > 0) return LAR_OK;
    char line[LAR_LINE_TEXT], why[200], remedy[100];
    snprintf(remedy, sizeof remedy, "; use a damping below %.3g 1/s or a time_step below %.3g s",
             2 / domain->time_step, 2 / model->damping);
    explain_long_step(model, why, sizeof why);
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s%s: damping %g 1/s stops a node within less than one time step of %.3g s%s",
                    lar_model_source(model), lar_line_text(model->damping_line, line),
                    model->damping, domain->time_step, *why ? why : remedy);
}

static lar_status check_options(const lar_options *options, lar_error *error) {
    if ((unsigned)options->element > LAR_ELEMENT_HEX8_MATRIX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_element_kind %d does not exist; use LAR_ELEMENT_HEX8",
                        (int)options->element);
    if (options->threads < 0 || options->threads > LAR_THREADS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d threads of a processor; there can be 1 to %d, and more processors",
                        (int)options->threads, LAR_THREADS_MAX);
    if (options->pin < 0 || options->pin > 2)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "pin is %d; it is 0 (never), 1 (always) or 2 (when all cores are taken)",
                        options->pin);
    lar_schedule_options words; /* unknown ones are, also where nothing is divided */
    return lar_division_options(options, &words, error);
}

/* How much the tissue bears of a tool: see contact/tool_body.h. */
static void set_tool_limits(const lar_domain *domain, lar_tool_list *list) {
    const lar_model *model = domain->model;
    const lar_surface *surface = &model->surface;
    lar_contact_law law = lar_contact_tool_law_for(domain->time_step, domain->stable_step);
    lar_tissue_scale scale = {.shear = INFINITY,
                              .interval =
                                  (double)lar_tool_interval(domain->time_step) * domain->time_step,
                              .firm = lar_free_bodies_any(model)};
    double edges = 0, mass = 0;
    for (int32_t f = 0; f < surface->face_count; f++) {
        scale.shear =
            fmin(scale.shear, lar_material_shear(lar_domain_material(domain, surface->element[f])));
        for (int a = 0; a < 4; a++) {
            double edge[3];
            int32_t node = surface->corner[f][a], next = surface->corner[f][(a + 1) % 4];
            lar_minus(model->mesh.position[next], model->mesh.position[node], edge);
            edges += lar_length(edge);
            mass += lar_domain_springs(domain)[domain->layout.local[node]];
        }
    }
    if (surface->face_count > 0) {
        scale.edge = edges / (4 * (double)surface->face_count);
        scale.stiffness =
            lar_interval_springs(domain) * law.stiffness * mass / (4 * (double)surface->face_count);
    }
    lar_tool_limits_set(&scale, list);
}

void lar_simulation_limit_tools(lar_simulation *simulation) {
    set_tool_limits(&simulation->domain, &simulation->list);
    simulation->domain.interval = lar_interval_length(&simulation->domain, &simulation->tools);
}

/* For those who look from other threads. */
static void note_time(lar_simulation *simulation) {
    double now = lar_simulation_time(simulation);
    __atomic_store(&simulation->domain.now, &now, __ATOMIC_RELAXED);
}

void lar_simulation_settle(lar_simulation *simulation) {
    note_time(simulation);
    bool tissue = lar_domain_stiffen(&simulation->domain, &simulation->tools.settings,
                                     &simulation->tools.parameters);
    bool tools = lar_spares_take(&simulation->tools, &simulation->list);
    if (tissue || tools) lar_simulation_limit_tools(simulation);
    lar_burden_take(&simulation->domain, &simulation->tools.heavier, NULL);
}

void lar_simulation_set(lar_simulation *simulation) {
    lar_division_watch(&simulation->tools.division);
    if (simulation->computer) simulation->computer->tools_sent = false;
}

lar_status lar_simulation_create_state(lar_simulation *simulation, bool search_always,
                                       lar_error *error) {
    const lar_domain *domain = &simulation->domain;
    lar_interactions *interactions = &simulation->interactions;
    lar_status status = lar_state_create(&simulation->state, domain->layout.node_padded,
                                         domain->history_count, error);
    if (!status) status = lar_strained_create(domain, &simulation->strained, error);
    simulation->strained.follows = simulation->strained.follows && !search_always;
    simulation->state.strained = &simulation->strained;
    simulation->state.needs = &simulation->needs;
    if (!status)
        status = lar_interactions_create(&domain->surroundings, &simulation->tools, search_always,
                                         interactions, error);
    if (!status)
        status = lar_body_contact_create(&domain->surroundings.bodies, domain->layout.local,
                                         domain->time_step, domain->stable_step, search_always,
                                         &interactions->body_contact, error);
    if (!status && !(simulation->scratch = lar_calloc(1, sizeof *simulation->scratch)))
        status = lar_fail_memory(error, sizeof *simulation->scratch, "the simulation");
    if (!status)
        status = lar_measure_scratch_create(domain, &simulation->tools,
                                            &simulation->scratch->measure, error);
    if (!status && simulation->scratch->measure.ahead) interactions->leads = &simulation->tools;
    return status;
}

static lar_status compile(const lar_model *model, const lar_options *options,
                          lar_simulation *simulation, lar_error *error) {
    lar_domain *domain = &simulation->domain;
    lar_status status =
        lar_tool_list_create(model, options->hands, options->spares, &simulation->list, error);
    if (!status) status = lar_domain_create(model, options, domain, error);
    if (status) return status;
    set_tool_limits(domain, &simulation->list);
    lar_tools_reset(&simulation->list, &simulation->tools);
    domain->interval = lar_interval_length(domain, &simulation->tools);
    status = lar_surroundings_add_contact(model, domain->layout.local, NULL, &simulation->list,
                                          &domain->surroundings, error);
    if (!status)
        status = lar_surroundings_add_bodies(model, domain->mass, domain->layout.local,
                                             domain->time_step, domain->stable_step,
                                             &domain->surroundings, error);
    if (!status) status = lar_free_bodies_yield(domain, &domain->surroundings.faces, error);
    if (!status) lar_free_bodies_firm(domain, &domain->surroundings.bodies.surface);
    if (!status) lar_history_plan_nodes(domain, &domain->surroundings.bodies.surface);
    if (!status) status = check_damping(domain, error);
    if (!status)
        status = lar_simulation_create_state(simulation, options->search_always != 0, error);
    if (!status) status = lar_simulation_check_paths(simulation, error);
    if (!status) lar_simulation_set_start(simulation);
    return status;
}

/* Grid "auto" becomes a grid, or none. */
static lar_status settle_grid(const lar_model *model, lar_options *options, lar_grid_choice *choice,
                              lar_error *error) {
    if (!options->grid || strcmp(options->grid, "auto") != 0) return LAR_OK;
    options->grid = NULL;
    lar_status status = lar_grid_choose(model, options, NULL, choice, error);
    if (!status) lar_grid_take(choice, options);
    return status;
}

/* Other threads may look meanwhile. */
static void note_division(lar_simulation *simulation) {
    const lar_computer *computer = simulation->computer;
    uint64_t times = computer->balance.times;
    __atomic_store_n(&simulation->redivisions, times, __ATOMIC_RELAXED);
    for (int32_t n = 0; n < simulation->domain.model->mesh.node_count; n++)
        __atomic_store_n(&simulation->reporter[n], computer->division.reporter[n],
                         __ATOMIC_RELAXED);
}

static lar_status create_computer(lar_simulation *simulation, const lar_options *options,
                                  lar_error *error) {
    size_t nodes = (size_t)simulation->domain.model->mesh.node_count;
    lar_status status = lar_computer_create(
        &simulation->domain, &simulation->interactions, &simulation->state, &simulation->tools,
        &simulation->list, options, &simulation->computer, error);
    if (status) return status;
    simulation->processors = simulation->computer->division.grid.count;
    simulation->threads = simulation->computer->threads;
    simulation->reporter = lar_calloc(nodes, sizeof *simulation->reporter);
    if (!simulation->reporter) return lar_fail_memory(error, 4 * nodes, "the processors of nodes");
    note_division(simulation);
    return LAR_OK;
}

lar_status lar_simulation_create(const lar_model *model, const lar_options *options,
                                 lar_simulation **simulation, lar_error *error) {
    lar_options chosen = options ? *options : lar_options_default();
    lar_grid_choice choice;
    lar_simulation *made = NULL;
    lar_status status = LAR_OK;
    if (!model || !simulation)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "lar_simulation_create needs a model and a place for the simulation");
    if (!status) status = check_options(&chosen, error);
    if (!status) status = settle_grid(model, &chosen, &choice, error);
    if (!status && !(made = lar_calloc(1, sizeof *made)))
        status = lar_fail_memory(error, sizeof *made, "the simulation");
    if (!status) status = compile(model, &chosen, made, error);
    if (!status && lar_division_asked(&chosen))
        status = create_computer(made, &chosen, error);
    else if (chosen.listener >= 0)
        close(chosen.listener); /* taken over, and nobody to use it */
    if (status)
        lar_simulation_destroy(made);
    else
        *simulation = made;
    return status;
}

void lar_simulation_destroy(lar_simulation *simulation) {
    if (!simulation) return;
    lar_computer_destroy(simulation->computer);
    free(simulation->reporter);
    if (simulation->scratch) {
        lar_measure_scratch_destroy(&simulation->scratch->measure);
        lar_field_plan_destroy(simulation->scratch->field);
        free(simulation->scratch);
    }
    lar_interactions_destroy(&simulation->interactions);
    lar_strained_destroy(&simulation->strained);
    lar_state_destroy(&simulation->state);
    lar_state_destroy(&simulation->start);
    lar_domain_leave(&simulation->domain);
    free(simulation);
}

/* Steps up to `end`, an interval's or the advance's. False when it shall not go on. */
static bool advance_stretch(lar_simulation *simulation, uint64_t end, lar_step_callback *callback,
                            void *context) {
    const lar_domain *domain = &simulation->domain;
    lar_interactions *interactions = &simulation->interactions;
    lar_state *state = &simulation->state;
    lar_fault *fault = &simulation->fault;
    uint64_t begin = state->step;
    bool goes_on = true;
    lar_report_stretch(interactions);
    state->need = 0;
    lar_needs_clear(&simulation->needs);
    while (state->step < end && goes_on) {
        lar_step(domain, interactions, state, fault);
        if (fault->kind) lar_fault_examine(domain, state, 0, domain->layout.node_count, fault);
        bool whole = state->part == 0;
        goes_on = !fault->kind && (!callback || !whole || callback(context, state->step));
    }
    simulation->report = (lar_report){0};
    lar_report_add(&simulation->report, interactions, state);
    lar_interval_harvest(&simulation->interval, domain, &simulation->report, state->step - begin,
                         &simulation->tools);
    return goes_on;
}

/* What strained elements have more now. `state`: NULL where the change has been accounted for. */
static void take_masses(lar_simulation *simulation, lar_state *state) {
    bool taken = lar_burden_take(&simulation->domain, &simulation->tools.heavier, state);
    /* Those near planes stand in a list with what they weigh. */
    if (taken) simulation->interactions.tool_contact.plane_contact.known = false;
}

/* `first`: of the portions of an advance. False when the watch has stopped it. */
static bool advance_alone(lar_simulation *simulation, uint64_t end, bool first,
                          lar_step_callback *callback, void *context) {
    const uint64_t *step = &simulation->state.step;
    bool goes_on = true;
    if (first) lar_report_begin(&simulation->interactions);
    if (first) lar_interval_restart(&simulation->interval);
    while (*step < end && goes_on) {
        if (lar_interval_decide(&simulation->domain, *step, &simulation->tools))
            take_masses(simulation, &simulation->state);
        uint64_t until = lar_interval_end(&simulation->domain, &simulation->tools.division, *step);
        goes_on = advance_stretch(simulation, until < end ? until : end, callback, context);
    }
    return goes_on;
}

enum { STEPS_BETWEEN_LOOKS = 32 }; /* at what contact has given */
_Static_assert(STEPS_BETWEEN_LOOKS % LAR_INTERVAL_MAX == 0, "nobody stops only for a look");

/* Without anything to touch it is the barriers of corners that give: what a load does that is
 * faster than the steps, which the account of energy tells. */
static bool may_touch(const lar_simulation *simulation) {
    const lar_domain *domain = &simulation->domain;
    return domain->model->contact_count > 0 ||
           (domain->surroundings.list &&
            lar_spares_any(domain->surroundings.list, &simulation->tools));
}

/* Contact may keep or lose energy, but must not have given more than it took: then the bodies would
 * have more than they began with. Surfaces that fold over themselves do that to it. What counts as
 * nothing is measured by the energy that the bodies have and have lost, or quiet ones would be
 * stopped for what they did not mind in motion (that of muscle may be below zero), and by what
 * contact has exchanged, for faces are flat: what slides takes a little here and gives it there.
 * Where loads have hardly begun there is rounding only. The first is asked for only when contact is
 * behind by more than it was the last time, or may be: what a report has lacks half of its last
 * step, which is taken for as much as all steps since the last look. The steps of looks are the
 * same however a run is divided into advances, and intervals end there (step/interval.h). */
static lar_status check_contact(lar_simulation *simulation, lar_error *error) {
    static const double NOTHING = 1e-3, SLIDING = 5e-3;
    if (!may_touch(simulation)) return LAR_OK;
    double taken = simulation->report.taken, change = fabs(taken - simulation->taken);
    simulation->taken = taken;
    double slid = SLIDING * simulation->report.exchanged;
    if (!(change - taken > NOTHING * simulation->measured + slid)) return LAR_OK;
    slid += lar_body_contact_nothing(&simulation->interactions.body_contact);
    if (!(change - taken > NOTHING * simulation->measured + slid)) return LAR_OK;
    lar_status status = lar_simulation_gather(simulation, error);
    if (status) return status;
    lar_energy e;
    lar_simulation_energy(simulation, &e);
    double had = e.kinetic + fabs(e.strain) + e.hourglass + e.damping + e.viscous;
    simulation->measured = fmax(simulation->measured, had);
    double given = -e.contact;
    if (!(given > NOTHING * simulation->measured + slid)) return LAR_OK;
    simulation->fault =
        (lar_fault){.kind = LAR_FAULT_ENERGY_GAIN, .step = simulation->state.step, .given = given};
    lar_fault_examine(&simulation->domain, &simulation->state, 0,
                      simulation->domain.layout.node_count, &simulation->fault);
    return LAR_OK;
}

/* Up to the step `end`, or less far when the watch or a fault stops it: *goes_on is false then. */
static lar_status advance_portion(lar_simulation *simulation, uint64_t end, bool first,
                                  lar_step_callback *callback, void *context, bool *goes_on,
                                  lar_error *error) {
    lar_computer *computer = simulation->computer;
    lar_status status = LAR_OK;
    if (computer) {
        uint64_t steps = end - lar_simulation_steps(simulation);
        if (first && lar_computer_redivide(&simulation->computer, &simulation->domain))
            note_division(simulation);
        computer = simulation->computer;
        computer->lead = simulation->interactions.leads ? lar_simulation_lead : NULL;
        computer->leader = simulation;
        status = lar_computer_advance(computer, steps, first, callback, context, &simulation->fault,
                                      error);
        simulation->report = computer->report;
        lar_burden_take(&simulation->domain, &simulation->tools.heavier, NULL);
        *goes_on = !computer->called_off;
    } else {
        *goes_on = advance_alone(simulation, end, first, callback, context);
    }
    if (status || simulation->fault.kind) *goes_on = false;
    return status;
}

static lar_status advance(lar_simulation *simulation, uint64_t end, lar_step_callback *callback,
                          void *context, lar_error *error) {
    lar_status status = LAR_OK;
    uint64_t step = lar_simulation_steps(simulation);
    bool goes_on = true;
    for (bool first = true; !status && goes_on && (first || step < end); first = false) {
        uint64_t look = (step / STEPS_BETWEEN_LOOKS + 1) * STEPS_BETWEEN_LOOKS;
        uint64_t stop = look < end ? look : end;
        status = lar_simulation_follow_paths(simulation, &stop, error);
        if (status) break;
        if (simulation->interactions.leads && simulation->computer) stop = step + 1;
        status = advance_portion(simulation, stop, first, callback, context, &goes_on, error);
        step = lar_simulation_steps(simulation);
        if (status || simulation->fault.kind || step % STEPS_BETWEEN_LOOKS != 0) continue;
        status = check_contact(simulation, error);
        if (simulation->fault.kind) goes_on = false;
    }
    /* What is looked at from here on is what the next step begins with. */
    uint64_t stop = UINT64_MAX;
    if (!status && goes_on) status = lar_simulation_follow_paths(simulation, &stop, error);
    return status;
}

lar_status lar_simulation_compute(lar_simulation *simulation, uint64_t steps,
                                  lar_step_callback *callback, void *context, lar_error *error) {
    lar_fault *fault = &simulation->fault;
    lar_status status = LAR_OK;
    if (!fault->kind && steps > 0) { /* no step leaves what tools felt as it is */
        uint64_t before = lar_simulation_steps(simulation);
        status = advance(simulation, before + steps, callback, context, error);
        simulation->report_steps = lar_simulation_steps(simulation) - before;
    }
    note_time(simulation);
    if (!status) lar_fault_attribute(&simulation->domain, &simulation->tools, fault);
    return status ? status : lar_fault_report(&simulation->domain, fault, error);
}

/* What the caller sees stays the same: `state` is the computer's copy, which is brought up to date.
 */
lar_status lar_simulation_gather(const lar_simulation *simulation, lar_error *error) {
    return simulation->computer ? lar_computer_gather(simulation->computer, error) : LAR_OK;
}

bool lar_simulation_has_peers(const lar_simulation *simulation) {
    return simulation->computer && simulation->computer->control;
}

void lar_simulation_go_before(const lar_simulation *simulation, int priority) {
    if (simulation->computer) lar_thread_pool_go_before(simulation->computer->pool, priority);
}

void lar_simulation_rouse(const lar_simulation *simulation) {
    if (simulation->computer) lar_thread_pool_rouse(simulation->computer->pool);
}

lar_status lar_simulation_work_ahead(lar_simulation *simulation, double until, lar_error *error) {
    if (simulation->fault.kind) return LAR_OK;
    if (simulation->computer) return lar_contact_work_ahead(simulation->computer, until, error);
    lar_body_contact_work_ahead(&simulation->interactions.body_contact, &simulation->state, until);
    return LAR_OK;
}

lar_status lar_simulation_look(lar_simulation *simulation, lar_error *error) {
    return simulation->computer ? lar_computer_look(simulation->computer, error) : LAR_OK;
}

lar_status lar_simulation_take_up(lar_simulation *simulation, lar_error *error) {
    simulation->fault = (lar_fault){0};
    simulation->report = (lar_report){0};
    simulation->report_steps = 0;
    simulation->measured = simulation->taken = 0;
    lar_simulation_settle(simulation);
    lar_status status = lar_simulation_support_here(simulation, &simulation->tools.supports, error);
    if (status || !simulation->computer) return status;
    return lar_computer_scatter(simulation->computer, error);
}

/* In one process gathering cannot fail and waits until somebody looks; between processes it can,
 * and nobody who looks could say so. */
lar_status lar_simulation_advance_with(lar_simulation *simulation, uint64_t steps,
                                       lar_step_callback *callback, void *context,
                                       lar_error *error) {
    if (!simulation)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_simulation_advance needs a simulation, not NULL");
    lar_status status = lar_simulation_check_idle(simulation, "lar_simulation_advance", error);
    if (status) return status;
    simulation->calling = callback != NULL;
    status = lar_simulation_compute(simulation, steps, callback, context, error);
    simulation->calling = 0;
    bool may_gather = !status || status == LAR_ERROR_UNSTABLE;
    if (may_gather && simulation->computer && simulation->computer->control) {
        lar_error lost;
        lar_status gathered = lar_simulation_gather(simulation, &lost);
        if (gathered) status = lar_fail(error, gathered, "%s", lost.message);
    }
    return status;
}

lar_status lar_simulation_advance(lar_simulation *simulation, uint64_t steps, lar_error *error) {
    return lar_simulation_advance_with(simulation, steps, NULL, NULL, error);
}

lar_status lar_simulation_serve(lar_simulation *simulation, lar_error *error) {
    if (!simulation || !simulation->computer || simulation->computer->first == 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_simulation_serve is for processes other than that of processor 0; "
                        "give options.processor and options.comm");
    return lar_computer_serve(simulation->computer, error);
}

const lar_state *lar_simulation_state(const lar_simulation *simulation) {
    lar_simulation_gather(simulation, NULL);
    return &simulation->state;
}

int32_t lar_simulation_processors(const lar_simulation *simulation) {
    if (!simulation) return 0;
    return simulation->reporter ? simulation->processors : 1;
}

int32_t lar_simulation_threads(const lar_simulation *simulation) {
    if (!simulation) return 0;
    return simulation->reporter ? simulation->threads : 1;
}

uint64_t lar_simulation_steps(const lar_simulation *simulation) {
    if (!simulation) return 0;
    return simulation->computer ? simulation->computer->processor[0].worker[0].state.step
                                : simulation->state.step;
}

double lar_simulation_time(const lar_simulation *simulation) {
    return (double)lar_simulation_steps(simulation) * lar_simulation_time_step(simulation);
}

void lar_simulation_inspect(const lar_simulation *simulation, lar_simulation_info *info) {
    if (!info) return;
    *info = (lar_simulation_info){0};
    if (!simulation) return;
    *info = (lar_simulation_info){.model = simulation->domain.model,
                                  .element = simulation->domain.kind,
                                  .tools = lar_spares_first(&simulation->list),
                                  .spares = simulation->list.spares,
                                  .time_step = simulation->domain.time_step};
}

double lar_simulation_time_step(const lar_simulation *simulation) {
    return simulation ? simulation->domain.time_step : 0;
}

const char *lar_simulation_isa(const lar_simulation *simulation) {
    return simulation ? simulation->domain.kernels->name : "";
}

static void copy_nodes(const lar_domain *domain, const double *values, double (*out)[3]) {
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++)
        lar_axes_get(values, domain->layout.axis_stride, domain->layout.local[g], out[g]);
}

void lar_simulation_displacements(const lar_simulation *simulation, double (*out)[3]) {
    if (simulation && out)
        copy_nodes(&simulation->domain, lar_simulation_state(simulation)->u, out);
}

void lar_simulation_velocities(const lar_simulation *simulation, double (*out)[3]) {
    if (simulation && out)
        copy_nodes(&simulation->domain, lar_simulation_state(simulation)->v, out);
}

uint64_t lar_state_hash(const lar_domain *domain, const lar_state *state) {
    uint64_t hash = lar_hash_word(0, state->step);
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++) {
        double value[LAR_NODE_VALUES];
        lar_state_read(state, domain->layout.local[g], value);
        hash = lar_state_hash_values(hash, value);
    }
    return lar_viscous_hash(domain, state, hash);
}

uint64_t lar_simulation_hash(const lar_simulation *simulation) {
    if (!simulation) return 0;
    return lar_state_hash(&simulation->domain, lar_simulation_state(simulation));
}

void lar_simulation_energy(const lar_simulation *simulation, lar_energy *energy) {
    if (!energy) return;
    *energy = (lar_energy){0};
    if (!simulation) return;
    lar_measure_energy(&simulation->domain, &simulation->scratch->measure,
                       lar_simulation_state(simulation), energy);
}

size_t lar_simulation_bytes(const lar_simulation *simulation) {
    const lar_domain *domain = &simulation->domain;
    const lar_conditions *conditions = &domain->surroundings.conditions;
    const lar_condition_notes *notes = &simulation->interactions.notes;
    const lar_layout *layout = &domain->layout;
    size_t nodes = (size_t)layout->node_padded;
    size_t elements = (size_t)domain->model->mesh.element_count;
    size_t bytes = domain->block_bytes + domain->more_bytes + domain->relaxing_bytes +
                   domain->fold_bytes + elements * sizeof *layout->corner +
                   (size_t)layout->block_count * sizeof *layout->block +
                   (size_t)domain->model->mesh.node_count * sizeof *layout->local +
                   nodes * (sizeof *layout->global + sizeof *domain->mass + sizeof *domain->push +
                            (domain->added ? sizeof *domain->added : 0));
    size_t moved = (size_t)(conditions->constraint_count - conditions->fixed_count);
    bytes +=
        (size_t)conditions->constraint_count * sizeof *conditions->constraint +
        moved * sizeof *notes->moved +
        (size_t)conditions->force_count * (sizeof *conditions->force + sizeof *notes->force) +
        (size_t)conditions->spring_count * (sizeof *conditions->spring + sizeof *notes->force) +
        (size_t)conditions->pressure_count *
            (sizeof *conditions->pressure + sizeof *notes->pressure);
#define LAR_STATE_BYTES(type, name, of_node, of_history, kept)                                     \
    bytes += LAR_STATE_SIZE(&simulation->state, of_node, of_history) * sizeof(type);
    LAR_STATE_ARRAYS(LAR_STATE_BYTES)
#undef LAR_STATE_BYTES
    return bytes;
}
