#include "step/activation.h"

#include <stdlib.h>
#include <string.h>

#include "law/fibre_stress.h"
#include "mechanics/stress.h"
#include "step/guard.h"
#include "step/step.h"

/* ---- what was set --------------------------------------------------------------------------- */

lar_status lar_activation_plan(lar_domain *domain, lar_error *error) {
    const lar_model *model = domain->model;
    size_t lanes = LAR_BLOCK * (size_t)domain->layout.block_count;
    bool waves = false;
    for (int i = 0; i < LAR_FACTORS_MAX; i++) domain->activation[i] = 1;
    for (int i = 0; i < model->material_count; i++) {
        const lar_material *material = &model->material[i];
        if (!lar_fibre_active(&material->fibre)) continue;
        domain->activates = domain->activates || lar_activation_varies(&material->activation);
        waves = waves || material->activation.wave.speed > 0;
    }
    if (!waves) return LAR_OK;
    domain->place = lar_calloc(lanes, sizeof *domain->place);
    if (!domain->place)
        return lar_fail_memory(error, lanes * sizeof *domain->place, "waves of activation");
    for (size_t k = 0; k < lanes; k++) {
        lar_gid e = domain->layout.block[k / LAR_BLOCK].element[k % LAR_BLOCK];
        double corner[8][3];
        if (e < 0) continue;
        lar_mesh_corners(&model->mesh, e, corner);
        domain->place[k] = lar_wave_place(&lar_model_material_of(model, e)->activation.wave,
                                          (const double(*)[3])corner);
    }
    return LAR_OK;
}

void lar_activation_unplan(lar_domain *domain) {
    free(domain->place);
    domain->place = NULL;
}

void lar_activation_take(lar_domain *domain, const lar_settings *settings) {
    const lar_model *model = domain->model;
    bool activates = lar_settings_activate(settings);
    for (int i = 0; i < LAR_FACTORS_MAX; i++) {
        double value = settings->activation[i];
        __atomic_store(&domain->activation[i], &value, __ATOMIC_RELAXED);
    }
    for (int i = 0; i < model->material_count; i++)
        activates = activates || (lar_fibre_active(&model->material[i].fibre) &&
                                  lar_activation_varies(&model->material[i].activation));
    domain->activates = activates;
}

static double set_of(const lar_domain *domain, int32_t material) {
    double value;
    __atomic_load(&domain->activation[lar_factor_of(material)], &value, __ATOMIC_RELAXED);
    return value;
}

/* ---- at a time ------------------------------------------------------------------------------ */

static double curve_at(const lar_domain *domain, const lar_material *material, double time) {
    int curve = material->activation.curve;
    if (curve == 0) return 1;
    return lar_curve_mean(&domain->model->curve[curve - 1], time, domain->time_step);
}

static double wave_at(const lar_material *material, double place, double time) {
    const lar_wave *wave = &material->activation.wave;
    return wave->speed > 0 ? lar_wave_value(wave, place, time) : 1;
}

/* What the model says of an element. */
static double model_at(const lar_domain *domain, lar_gid e, double time) {
    const lar_material *material = lar_model_material_of(domain->model, e);
    double corner[8][3], place = 0;
    if (material->activation.wave.speed > 0) {
        lar_mesh_corners(&domain->model->mesh, e, corner);
        place = lar_wave_place(&material->activation.wave, (const double(*)[3])corner);
    }
    return curve_at(domain, material, time) * wave_at(material, place, time);
}

double lar_activation_at(const lar_domain *domain, lar_gid e, double time) {
    return set_of(domain, domain->model->element_material[e]) * model_at(domain, e, time);
}

lar_material lar_activation_material(const lar_domain *domain, lar_gid e, double time) {
    lar_material material = *lar_domain_material(domain, e);
    if (!lar_fibre_active(&material.fibre)) return material;
    double activation = lar_activation_at(domain, e, time);
    material.fibre.along *= activation;
    material.fibre.across *= activation;
    return material;
}

/* ---- in a step ------------------------------------------------------------------------------ */

/* What a run's lanes follow from, but for their places: one look for each material in a row. */
typedef struct lane_walk {
    const lar_domain *domain;
    double time;
    int32_t material; /* -1: none yet */
    double factor;    /* what was set, times the curve */
} lane_walk;

static double lane_at(lane_walk *walk, size_t lane, lar_gid e) {
    const lar_domain *domain = walk->domain;
    int32_t index = domain->model->element_material[e];
    const lar_material *material = &domain->model->material[index];
    if (walk->material != index) {
        walk->material = index;
        walk->factor = set_of(domain, index) * curve_at(domain, material, walk->time);
    }
    return domain->place ? walk->factor * wave_at(material, domain->place[lane], walk->time)
                         : walk->factor;
}

bool lar_activation_begin(const lar_domain *domain, int32_t r, const lar_state *state,
                          lar_active_step *step) {
    const lar_block_run *run = &domain->run[r];
    lane_walk walk = {.domain = domain, .time = lar_state_time(domain, state), .material = -1};
    if (!domain->activates || !run->fibrous || !state->strained->activation) return false;
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    double *now = state->strained->activation + first;
    *step = (lar_active_step){.now = now, .energy = state->strained->active_energy + first};
    for (size_t k = 0; k < LAR_BLOCK * (size_t)run->count; k++) {
        lar_gid e = domain->layout.block[(first + k) / LAR_BLOCK].element[k % LAR_BLOCK];
        now[k] = e < 0 ? 0 : lane_at(&walk, first + k, e);
    }
    return true;
}

double lar_activation_change(const lar_domain *domain, int32_t r, const lar_active_step *step,
                             const lar_state *state) {
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    double time = lar_state_time(domain, state), work = 0;
    double next = time + domain->time_step / state->parts;
    lane_walk before = {.domain = domain, .time = time - state->past, .material = -1};
    lane_walk after = {.domain = domain, .time = next, .material = -1};
    for (size_t k = 0; k < LAR_BLOCK * (size_t)domain->run[r].count; k++) {
        lar_gid e = domain->layout.block[(first + k) / LAR_BLOCK].element[k % LAR_BLOCK];
        if (e < 0 || !lar_activation_varies(&lar_model_material_of(domain->model, e)->activation))
            continue;
        double change = lane_at(&after, first + k, e) - lane_at(&before, first + k, e);
        work += 0.5 * change * step->energy[k];
    }
    return work / domain->scale;
}

/* ---- between steps -------------------------------------------------------------------------- */

double lar_activation_pending(const lar_domain *domain, const lar_state *state, lar_gid e,
                              double volume, const double F[3][3]) {
    const lar_material *material = lar_domain_material(domain, e);
    if (!domain->activates || !lar_fibre_active(&material->fibre) ||
        !lar_activation_varies(&material->activation))
        return 0;
    double time = lar_state_time(domain, state);
    double change =
        lar_activation_at(domain, e, time) - lar_activation_at(domain, e, time - state->past);
    return 0.5 * change * volume *
           lar_active_energy(material, lar_model_fibre(domain->model, e), F);
}

/* W1 of an element times its volume, at corners of the layout; *power: P1 : dF/dt, likewise. */
static double stored(const lar_domain *domain, const lar_hex8 *hex8, lar_gid e,
                     const lar_state *state, double *power) {
    const lar_material *material = lar_domain_material(domain, e);
    const lar_gid *node = domain->layout.corner[e];
    double u[8][3], v[8][3], F[9], rate[9], P[9] = {0}, sum = 0;
    for (int a = 0; a < 8; a++) {
        lar_state_displacement(state, domain->layout.local[node[a]], u[a]);
        lar_state_velocity(state, domain->layout.local[node[a]], v[a]);
    }
    lar_hex8_gradient(hex8, (const double(*)[3])u, (double(*)[3])F);
    lar_hex8_gradient(hex8, (const double(*)[3])v, (double(*)[3])rate);
    lar_fibre_lane lane = {.along = material->fibre.along, .across = material->fibre.across};
    memcpy(lane.direction, hex8->fibre, sizeof lane.direction);
    (void)lar_active_stress(F, &lane, P);
    for (int k = 0; k < 9; k++) sum += P[k] * (rate[k] - (k % 4 == 0)); /* F - 1 of v */
    *power = hex8->volume * sum;
    return hex8->volume * lar_active_energy(material, hex8->fibre, (const double(*)[3])F);
}

/* The next step will count the change of curve and wave up to now with what is set then. */
double lar_activation_work(const lar_domain *domain, const lar_settings *wanted,
                           const lar_state *state, double past, double next) {
    double time = lar_state_time(domain, state), sum = 0;
    for (int32_t r = 0; r < domain->run_count; r++) {
        if (!domain->run[r].fibrous) continue;
        for (int32_t k = 0; k < LAR_BLOCK * domain->run[r].count; k++) {
            int32_t b = domain->run_first[r] + k / LAR_BLOCK;
            lar_hex8 hex8;
            lar_gid e = domain->layout.block[b].element[k % LAR_BLOCK];
            if (e < 0) continue;
            int i = lar_factor_of(domain->model->element_material[e]);
            double change = wanted->activation[i] - domain->activation[i];
            if (change == 0 || !lar_fibre_active(&lar_domain_material(domain, e)->fibre)) continue;
            lar_domain_element(domain, r, b, k % LAR_BLOCK, &hex8);
            double now = model_at(domain, e, time), before = model_at(domain, e, time - past);
            double power, energy = stored(domain, &hex8, e, state, &power);
            sum += change * (now * (energy - 0.5 * next * power) - 0.5 * (now - before) * energy);
        }
    }
    return sum;
}
