#include "simulation/rest.h"

#include <math.h>

#include "meshing/starter/slowest.h"
#include "model/rest.h"
#include "step/measure.h"

/* Of the strain energy. */
static const double REST_SHARE = 1e-10;
/* Of the motion that rounding makes between two looks: Q n of rest.h. */
static const double ROUNDING = 1e4;
/* The slow period is an estimate for compact bodies; a slender beam takes many of them. What swings
 * more slowly still, on springs, has an end when damping has taken e^-100 of its energy; not more
 * than ten times as long is waited for that. */
static const double PERIODS_MAX = 1000, PERIODS_DAMPED = 10000, FADED = 100;

enum { LOOKS_PER_PERIOD = 16, MIN_LOOKS = LOOKS_PER_PERIOD / 2 /* of a window */ };

static uint64_t step_at(const lar_simulation *simulation, double time) {
    double step = ceil(time / lar_simulation_time_step(simulation));
    return step < 1e18 ? (uint64_t)step : (uint64_t)1e18;
}

/* What follows `step` by so much of a slow period, at least a step. */
static uint64_t steps_of(const lar_simulation *simulation, double periods) {
    double period = lar_model_slow_period(simulation->domain.model);
    uint64_t steps = step_at(simulation, periods * period);
    return steps > 0 ? steps : 1;
}

static void open_window(lar_rest *rest, uint64_t step) {
    uint64_t min = MIN_LOOKS * rest->every, share = (step - rest->since_step) / 4;
    rest->window = (lar_rest_window){.begin = step, .end = step + (min > share ? min : share)};
    rest->next = step + rest->every;
}

void lar_rest_begin(lar_rest *rest, const lar_simulation *simulation) {
    if (!rest) return;
    *rest = (lar_rest){0};
    if (!simulation) return;
    const lar_model *model = simulation->domain.model;
    uint64_t now = lar_simulation_steps(simulation);
    *rest = (lar_rest){.since = lar_model_loads_end(model), .share = REST_SHARE};
    if (lar_model_repeats(model)) { /* loads never end, and the limit is now */
        rest->since = INFINITY;
        rest->next = UINT64_MAX;
        return;
    }
    uint64_t since = step_at(simulation, rest->since);
    rest->since_step = since > now ? since : now;
    rest->every = steps_of(simulation, 1.0 / LOOKS_PER_PERIOD);
    const uint64_t most = steps_of(simulation, PERIODS_DAMPED);
    const double damping = lar_simulation_damping(simulation);
    const uint64_t faded = damping > 0 ? step_at(simulation, FADED / damping) : 0;
    const uint64_t longer = faded < most ? faded : most;
    rest->limit = steps_of(simulation, PERIODS_MAX);
    rest->limit = rest->since_step + (rest->limit > longer ? rest->limit : longer);
    open_window(rest, rest->since_step);
}

/* Q of rest.h: the kinetic energy that one unit of force on every node makes in a step. */
static double unit_energy(const lar_domain *domain) {
    double sum = 0.0;
    for (int32_t node = 0; node < domain->layout.node_count; node++)
        sum += 0.5 * domain->mass[node] * domain->push[node] * domain->push[node];
    return sum;
}

/* The ratio of what is left to the strain energy, which what is active makes negative; where
 * nothing is strained, to one of which rounding is no more than the share at rest. */
static double share_of(const lar_rest *rest, const lar_domain *domain, double energy) {
    double rounding = ROUNDING * (double)rest->every * unit_energy(domain);
    return energy == 0.0 ? 0.0 : energy / fmax(fabs(rest->strain), rounding / REST_SHARE);
}

/* What damping will still take: R of rest.h. */
static double energy_ahead(const lar_rest *rest, const lar_simulation *simulation, double mean) {
    static const double SLOWEST = 0.99; /* noise at the end of all motion does not fade */
    const lar_rest_window *window = &rest->window;
    double seconds = (double)(window->end - window->begin) * lar_simulation_time_step(simulation);
    double damping = lar_simulation_damping(simulation);
    double ratio = mean < SLOWEST * rest->mean_before ? mean / rest->mean_before : SLOWEST;
    return 2.0 * damping * mean * seconds * ratio / (1.0 - ratio);
}

/* M of rest.h. */
static double memory_of(const lar_domain *domain, const lar_state *state) {
    double sum = 0;
    for (lar_gid e = 0; e < domain->model->mesh.element_count; e++)
        sum += lar_measure_remembered(domain, state, e);
    return sum;
}

int lar_rest_look(lar_rest *rest, const lar_simulation *simulation) {
    uint64_t now = lar_simulation_steps(simulation);
    if (!rest || !simulation) return 0;
    if (rest->reached || now < rest->next) return rest->reached;
    lar_rest_window *window = &rest->window;
    const lar_state *state = lar_simulation_state(simulation);
    const bool ends = now + rest->every > window->end;
    const bool asks = ends || (!rest->looked && window->looks == 0); /* and once at the beginning */
    double kinetic, strain; /* which takes as long as many steps: asked for when it is needed */
    lar_rest_energies(&simulation->domain, state, &kinetic, asks ? &strain : NULL);
    if (asks) {
        rest->kinetic = kinetic;
        rest->strain = strain;
    }
    window->largest = fmax(window->largest, kinetic);
    window->sum += kinetic;
    window->looks++;
    rest->next = now + rest->every;
    if (!ends) return 0;
    double mean = window->sum / window->looks;
    double left = window->largest;
    if (mean > 0.0) left += energy_ahead(rest, simulation, mean);
    double memory = memory_of(&simulation->domain, state);
    rest->left = share_of(rest, &simulation->domain, left + memory);
    rest->looked = memory > left ? 2 : 1;
    rest->mean_before = mean;
    rest->reached = rest->left <= REST_SHARE;
    open_window(rest, now);
    return rest->reached;
}

void lar_rest_energies(const lar_domain *domain, const lar_state *state, double *kinetic,
                       double *strain) {
    *kinetic = 0;
    if (strain) *strain = 0;
    for (lar_gid g = 0; g < domain->model->mesh.node_count; g++) {
        int32_t node = domain->layout.local[g];
        double v[3];
        lar_state_velocity(state, node, v);
        *kinetic += 0.5 * domain->mass[node] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    for (lar_gid e = 0; strain && e < domain->model->mesh.element_count; e++)
        *strain += lar_measure_element_energy(domain, state, e);
}

/* ---- models that damp themselves ------------------------------------------------------------- */

/* Rayleigh's quotient is never below what it stands for, and a little below 2 is faster than 2: a
 * body that swings once comes to rest sooner than one that creeps. */
static const double PART = 1.8;
/* Of the guess; what is slower still is not held, but for bodies a thousand times as long as thick.
 */
static const double LEAST = 1e-3;

double lar_rest_damping(const lar_model *model) {
    double guess = lar_model_rest_damping(model);
    double damping = PART * lar_slowest_motion(model);
    return damping > LEAST * guess ? fmin(damping, guess) : guess;
}

lar_status lar_rest_damp(lar_simulation *simulation, double *damping, lar_error *error) {
    if (damping) *damping = 0;
    if (!simulation)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "lar_rest_damp needs a simulation, not NULL");
    const lar_model *model = simulation->domain.model;
    if (lar_simulation_damping(simulation) > 0 || model->damping_line > 0) return LAR_OK;
    double found = lar_rest_damping(model);
    if (damping) *damping = found;
    return lar_simulation_set_damping(simulation, found, error);
}

lar_status lar_model_damp_itself(lar_model **opened, lar_error *error) {
    lar_model *model = *opened;
    double damping = model->damps_itself ? lar_rest_damping(model) : model->damping;
    if (damping == model->damping) return LAR_OK;
    model->damping = damping;
    lar_status status = lar_model_notice(
        model, error, "%s: the body's slowest motion has %.3g 1/s: its damping is %.3g 1/s",
        lar_model_source(model), damping / PART, damping);
    if (!status) return LAR_OK;
    lar_model_destroy(model);
    *opened = NULL;
    return status;
}

lar_status lar_model_open(const char *path, lar_model **model, lar_error *error) {
    lar_status status = lar_model_read(path, model, error);
    return status ? status : lar_model_damp_itself(model, error);
}
