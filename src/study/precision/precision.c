#include "study/precision/precision.h"

#include <math.h>

#include "base/clock.h"
#include "study/precision/single.h"
#include "study/precision/single_domain.h"

const char *const lar_precision_names[LAR_PRECISION_COUNT] = {"double", "mixed", "single"};
/* One way of computing the model. */
typedef struct run {
    lar_simulation *simulation;
    lar_single_domain single;
    bool went;
    double energy_begin, strain;
} run;

static void end_run(run *r) {
    lar_simulation_destroy(r->simulation);
    lar_single_release(&r->single);
    *r = (run){0};
}

static double all_energy(const lar_energy *e) {
    return e->kinetic + e->strain + e->hourglass + e->damping + e->contact + e->viscous -
           e->external;
}

static lar_status begin_run(const lar_model *model, lar_precision_case what, lar_precision way,
                            lar_isa isa, run *r, lar_error *error) {
    lar_options options = lar_options_default();
    options.isa = isa;
    lar_status status = lar_simulation_create(model, &options, &r->simulation, error);
    if (!status && way != LAR_PRECISION_DOUBLE)
        status = lar_single_adopt(&r->simulation->domain, way == LAR_PRECISION_SINGLE, &r->single,
                                  error);
    if (status) return status;
    /* What keeps flat elements from folding is not there in single precision. */
    for (int32_t i = 0; i < r->simulation->domain.run_count; i++)
        r->simulation->domain.run[i].folds = NULL;
    if (what != LAR_CASE_MODEL) lar_precision_start(what, r->simulation);
    r->went = true;
    return LAR_OK;
}

/* AUTO takes what has kernels in single precision. */
static lar_isa choose_isa(lar_isa isa) {
    const lar_kernels *found;
    lar_error ignored;
    if (isa != LAR_ISA_AUTO) return isa;
    if (lar_single_kernels_find("avx512", false) &&
        !lar_kernels_find(LAR_ISA_AVX512, &found, &ignored))
        return LAR_ISA_AVX512;
    return LAR_ISA_C;
}

/* ---- looking ------------------------------------------------------------------------------ */

/* The largest displacement of an axis of the model's nodes, and of its difference. */
static void compare(const lar_simulation *a, const lar_simulation *b, double offset, double *size,
                    double *difference) {
    const lar_domain *domain = &a->domain;
    *size = *difference = 0;
    for (lar_lid n = 0; n < domain->layout.node_padded; n++)
        for (int i = 0; i < 3 && domain->layout.global[n] >= 0; i++) {
            double u = a->state.u[lar_state_at(&a->state, n, i)];
            *size = fmax(*size, fabs(u - offset));
            *difference = fmax(*difference, fabs(u - b->state.u[lar_state_at(&b->state, n, i)]));
        }
}

static double fastest(const lar_simulation *s) {
    double max = 0;
    for (lar_lid n = 0; n < s->domain.layout.node_padded; n++)
        for (int i = 0; i < 3 && s->domain.layout.global[n] >= 0; i++)
            max = fmax(max, fabs(s->state.v[lar_state_at(&s->state, n, i)]));
    return max;
}

typedef struct look {
    double difference[LAR_PRECISION_COUNT], size[LAR_PRECISION_COUNT];
} look;

typedef struct study {
    run run[LAR_PRECISION_COUNT];
    look look[LAR_PRECISION_LOOKS];
    double nanoseconds[LAR_PRECISION_COUNT][LAR_PRECISION_LOOKS];
    double max_energy, max_strain;
    int looks;
} study;

static void note_energy(study *s) {
    lar_energy e;
    lar_simulation_energy(s->run[LAR_PRECISION_DOUBLE].simulation, &e);
    s->max_energy = fmax(s->max_energy, e.kinetic + e.strain + e.hourglass);
    s->max_energy = fmax(s->max_energy, fabs(e.external));
    s->max_strain = fmax(s->max_strain, e.strain + e.hourglass);
}

/* All three go on, one after the other, and are looked at. Only double must not stop. */
static lar_status go_on(study *s, uint64_t steps, double offset, lar_error *error) {
    const lar_simulation *reference = s->run[LAR_PRECISION_DOUBLE].simulation;
    look *seen = &s->look[s->looks];
    for (int w = 0; w < LAR_PRECISION_COUNT; w++) {
        run *r = &s->run[w];
        if (!r->went) continue;
        double begin = lar_clock_seconds();
        lar_status status = lar_simulation_advance(r->simulation, steps, error);
        double took = lar_clock_seconds() - begin;
        if (status && w == LAR_PRECISION_DOUBLE) return status;
        r->went = !status;
        s->nanoseconds[w][s->looks] =
            1e9 * took / ((double)steps * reference->domain.model->mesh.element_count);
        double ignored;
        compare(r->simulation, reference, offset, &seen->size[w], &seen->difference[w]);
        if (w == LAR_PRECISION_DOUBLE)
            compare(reference, reference, offset, &seen->size[w], &ignored);
    }
    note_energy(s);
    s->looks++;
    return LAR_OK;
}

static void conclude_way(study *s, int w, double largest, lar_precision_way *to) {
    run *r = &s->run[w];
    const look *last = &s->look[s->looks - 1];
    *to = (lar_precision_way){.went = r->went};
    if (!r->went) return;
    lar_energy e;
    lar_simulation_energy(r->simulation, &e);
    double size = largest > 0 ? largest : 1, energy = s->max_energy > 0 ? s->max_energy : 1;
    to->difference = last->difference[w] / size;
    to->left = last->size[w] / size;
    for (int k = 0; k < s->looks; k++)
        to->difference_max = fmax(to->difference_max, s->look[k].difference[w] / size);
    to->hash = lar_simulation_hash(r->simulation);
    to->speed = fastest(r->simulation);
    to->strain = (e.strain + e.hourglass) / (s->max_strain > 0 ? s->max_strain : 1);
    to->drift = (all_energy(&e) - r->energy_begin) / energy;
    const lar_domain *domain = &r->simulation->domain;
    to->bytes = (double)(w == LAR_PRECISION_DOUBLE ? domain->block_bytes : r->single.bytes) /
                domain->model->mesh.element_count;
    to->nanoseconds = lar_spread_of(s->nanoseconds[w], s->looks);
}

static lar_status compare_model(const lar_model *model, const lar_precision_options *options,
                                study *s, lar_precision_result *result, lar_error *error) {
    const lar_isa isa = choose_isa(options->isa);
    const double offset = lar_precision_offset(options->what);
    lar_status status = LAR_OK;
    for (int w = 0; w < LAR_PRECISION_COUNT && !status; w++) {
        run *r = &s->run[w];
        lar_energy e;
        status = begin_run(model, options->what, (lar_precision)w, isa, r, error);
        if (status) break;
        lar_simulation_energy(r->simulation, &e);
        r->energy_begin = all_energy(&e);
    }
    if (status) return status;
    note_energy(s);
    for (int k = 0; k < LAR_PRECISION_LOOKS && !status; k++) {
        uint64_t begin = options->steps * (uint64_t)k / LAR_PRECISION_LOOKS;
        uint64_t end = options->steps * (uint64_t)(k + 1) / LAR_PRECISION_LOOKS;
        status = go_on(s, end - begin, offset, error);
        result->largest = fmax(result->largest, s->look[k].size[LAR_PRECISION_DOUBLE]);
    }
    if (status) return status;
    const lar_simulation *reference = s->run[LAR_PRECISION_DOUBLE].simulation;
    result->elements = model->mesh.element_count;
    result->nodes = model->mesh.node_count;
    result->isa = lar_simulation_isa(reference);
    result->time_step = reference->domain.time_step;
    for (int w = 0; w < LAR_PRECISION_COUNT; w++)
        conclude_way(s, w, result->largest, &result->way[w]);
    return LAR_OK;
}

static lar_status check(const lar_precision_options *options, lar_error *error) {
    const bool block = options->what != LAR_CASE_MODEL;
    if (options->steps < LAR_PRECISION_LOOKS || options->steps > 1000000000 ||
        (block && (options->elements < 8 || options->elements > 1000000)) ||
        (!block && !options->model))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "comparing precisions takes %d to 1e9 steps of a model or of a block of 8 "
                        "to 1e6 elements",
                        LAR_PRECISION_LOOKS);
    if (!block && lar_model_viscous(options->model))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: single precision knows no viscous materials; take a model without "
                        "them",
                        lar_model_source(options->model),
                        lar_model_viscous(options->model)->viscosity.line);
    if (!block && lar_model_fibrous(options->model))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: single precision knows no fibres; take a model without them",
                        lar_model_source(options->model),
                        lar_model_fibrous(options->model)->fibre.line);
    if (!block && (options->model->mass_step > 0 || options->model->strained_share > 0))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: single precision knows no mass_scaling; take a scene without it",
                        lar_model_source(options->model));
    return LAR_OK;
}

/* How long the steps of a block are together: its load path follows from that. */
static lar_status duration_of(const lar_precision_options *options, double *duration,
                              lar_error *error) {
    lar_model *model = NULL;
    double stable;
    lar_gid worst;
    lar_status status = lar_precision_block(options->what, options->elements, 1, &model, error);
    if (status) return status;
    status = lar_stable_step(model, LAR_ELEMENT_HEX8, &stable, &worst, error);
    if (!status) *duration = (double)options->steps * lar_auto_step(model, stable);
    lar_model_destroy(model);
    return status;
}

lar_status lar_precision_compare(const lar_precision_options *options, lar_precision_result *result,
                                 lar_error *error) {
    lar_precision_result made = {0};
    study s = {0};
    lar_model *block = NULL;
    double duration = 0;
    lar_status status = check(options, error);
    if (!status && options->what != LAR_CASE_MODEL) {
        status = duration_of(options, &duration, error);
        if (!status)
            status = lar_precision_block(options->what, options->elements, duration, &block, error);
    }
    if (!status) status = compare_model(block ? block : options->model, options, &s, &made, error);
    for (int w = 0; w < LAR_PRECISION_COUNT; w++) end_run(&s.run[w]);
    lar_model_destroy(block);
    if (!status) *result = made;
    return status;
}

/* ---- the largest step --------------------------------------------------------------------- */

/* Whether the block swings with a step of `ratio` times the stable one, beyond which production
 * refuses to begin: so the compiled step is changed. There is no damping in this case. */
static lar_status swings(const lar_model *model, lar_precision way, lar_isa isa, uint64_t steps,
                         double ratio, bool *answer, lar_error *error) {
    run r = {0};
    lar_energy e;
    lar_status status = begin_run(model, LAR_CASE_VIBRATION, way, isa, &r, error);
    if (!status) {
        lar_domain *domain = &r.simulation->domain;
        double factor = ratio * domain->stable_step / domain->time_step;
        lar_simulation_energy(r.simulation, &e);
        const double begin = e.kinetic;
        domain->time_step *= factor;
        domain->leapfrog.dt *= factor;
        for (lar_lid n = 0; n < domain->layout.node_padded; n++) domain->push[n] *= factor;
        *answer = !lar_simulation_advance(r.simulation, steps, error);
        lar_simulation_energy(r.simulation, &e);
        *answer = *answer && e.kinetic + e.strain < 10 * begin;
    }
    end_run(&r);
    return status;
}

lar_status lar_precision_stable(const lar_precision_options *options,
                                double ratio[LAR_PRECISION_COUNT], lar_error *error) {
    lar_model *model = NULL;
    lar_status status = check(options, error);
    if (!status)
        status = lar_precision_block(LAR_CASE_VIBRATION, options->elements, 1, &model, error);
    for (int w = 0; w < LAR_PRECISION_COUNT && !status; w++) {
        double good = 0.5, bad = 4;
        while (bad - good > 1e-3 * good && !status) {
            bool answer = false;
            double middle = 0.5 * (good + bad);
            status = swings(model, (lar_precision)w, choose_isa(options->isa), options->steps,
                            middle, &answer, error);
            if (answer)
                good = middle;
            else
                bad = middle;
        }
        ratio[w] = good;
    }
    lar_model_destroy(model);
    return status;
}
