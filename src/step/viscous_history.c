#include "step/viscous_history.h"

#include <math.h>
#include <stdlib.h>

int lar_viscous_count(const lar_model *model, lar_gid e) {
    return lar_history_values(lar_model_material_of(model, e)->viscosity.terms);
}

size_t lar_viscous_total(const lar_model *model) {
    size_t total = 0;
    bool any = false;
    for (int i = 0; i < model->material_count; i++)
        any = any || model->material[i].viscosity.terms > 0;
    for (lar_gid e = 0; any && e < model->mesh.element_count; e++)
        total += (size_t)lar_viscous_count(model, e);
    return total;
}

/* ---- planning ------------------------------------------------------------------------------- */

static lar_status check_material(const lar_domain *domain, const lar_material *material,
                                 lar_error *error) {
    const lar_viscosity *v = &material->viscosity;
    bool named = material->name && *material->name;
    const char *name = named ? material->name : "without a name", *quote = named ? "'" : "";
    if (domain->kind != LAR_ELEMENT_HEX8)
        return lar_fail(
            error, LAR_ERROR_UNSUPPORTED,
            "%s:%d: the material %s%.60s%s is viscous, which only elements hex8 can be; "
            "take these, or leave its viscosity out",
            lar_model_source(domain->model), v->line, quote, name, quote);
    for (int i = 0; i < v->terms; i++)
        if (v->time[i] < domain->time_step)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s:%d: viscous term %d of the material %s%.60s%s relaxes in %g s, "
                            "which is less than the time step of %.3g s; leave the term out, or "
                            "take a time step below its time",
                            lar_model_source(domain->model), v->line, i + 1, quote, name, quote,
                            v->time[i], domain->time_step);
    return LAR_OK;
}

/* The first element of a run speaks for all: they have one kind of viscosity. */
static void plan_run(lar_domain *domain, int32_t r) {
    lar_block_run *run = &domain->run[r];
    const lar_lanes *block = &domain->layout.block[domain->run_first[r]];
    double stiffest = 1;
    for (int32_t b = 0; b < run->count; b++)
        for (int lane = 0; lane < LAR_BLOCK; lane++) {
            lar_gid e = block[b].element[lane];
            if (e < 0) continue;
            const lar_viscosity *v = &lar_model_material_of(domain->model, e)->viscosity;
            run->terms = v->terms;
            run->isochoric = v->isochoric;
            if (v->isochoric) stiffest = fmax(stiffest, lar_viscosity_instant(v));
        }
    run->softer = 1 / stiffest;
    size_t values = (size_t)lar_history_values(run->terms);
    domain->run_history[r] = domain->history_count;
    for (int32_t b = 0; b < run->count; b++)
        for (int lane = 0; lane < LAR_BLOCK; lane++) {
            lar_gid e = block[b].element[lane];
            if (e >= 0)
                domain->element_history[e] =
                    (int64_t)(domain->history_count + values * LAR_BLOCK * (size_t)b) + lane;
        }
    domain->history_count += values * LAR_BLOCK * (size_t)run->count;
}

lar_status lar_viscous_plan(lar_domain *domain, lar_error *error) {
    const lar_model *model = domain->model;
    bool any = false;
    for (int i = 0; i < model->material_count; i++) {
        if (model->material[i].viscosity.terms == 0) continue;
        lar_status status = check_material(domain, &model->material[i], error);
        if (status) return status;
        any = true;
    }
    if (!any) return LAR_OK;
    size_t elements = (size_t)model->mesh.element_count, runs = (size_t)domain->run_count;
    domain->relaxing_bytes = (size_t)domain->layout.block_count * sizeof *domain->relaxing;
    domain->relaxing = lar_calloc_aligned(domain->relaxing_bytes, 1);
    domain->run_history = lar_calloc(runs, sizeof *domain->run_history);
    domain->element_history = lar_calloc(elements, sizeof *domain->element_history);
    if (!domain->relaxing || !domain->run_history || !domain->element_history)
        return lar_fail_memory(error, domain->relaxing_bytes + 8 * elements, "viscous elements");
    for (size_t e = 0; e < elements; e++) domain->element_history[e] = -1;
    for (int32_t r = 0; r < domain->run_count; r++)
        if (domain->run[r].viscous) plan_run(domain, r);
    return LAR_OK;
}

void lar_viscous_unplan(lar_domain *domain) {
    free(domain->relaxing);
    free(domain->run_history);
    free(domain->element_history);
    domain->relaxing = NULL;
    domain->run_history = NULL;
    domain->element_history = NULL;
    domain->relaxing_bytes = domain->history_count = 0;
}

/* ---- one element ---------------------------------------------------------------------------- */

void lar_viscous_read(const lar_domain *domain, const lar_state *state, lar_gid e, double *value) {
    const double *from = state->history + domain->element_history[e];
    int count = lar_viscous_count(domain->model, e);
    for (int k = 0; k < count; k++) value[k] = from[LAR_BLOCK * k];
}

void lar_viscous_write(const lar_domain *domain, lar_state *state, lar_gid e, const double *value) {
    double *to = state->history + domain->element_history[e];
    int count = lar_viscous_count(domain->model, e);
    for (int k = 0; k < count; k++) to[LAR_BLOCK * k] = value[k];
}

/* ---- all of them ---------------------------------------------------------------------------- */

void lar_viscous_gather(const lar_domain *whole, const lar_state *state, double *value) {
    const lar_model *model = whole->model;
    for (lar_gid e = 0; whole->element_history && e < model->mesh.element_count; e++) {
        if (!lar_viscous_here(whole, e)) continue;
        lar_viscous_read(whole, state, e, value);
        value += lar_viscous_count(model, e);
    }
}

void lar_viscous_scatter(const lar_domain *whole, lar_state *state, const double *value) {
    const lar_model *model = whole->model;
    for (lar_gid e = 0; whole->element_history && e < model->mesh.element_count; e++) {
        if (!lar_viscous_here(whole, e)) continue;
        lar_viscous_write(whole, state, e, value);
        value += lar_viscous_count(model, e);
    }
}

void lar_viscous_copy(const lar_domain *from, const lar_state *state, const lar_domain *to,
                      lar_state *copy) {
    for (lar_gid e = 0; from->element_history && e < from->model->mesh.element_count; e++) {
        double value[LAR_HISTORY_MAX];
        if (!lar_viscous_here(from, e) || !lar_viscous_here(to, e)) continue;
        lar_viscous_read(from, state, e, value);
        lar_viscous_write(to, copy, e, value);
    }
}

uint64_t lar_viscous_hash_values(uint64_t hash, const double *value, size_t values) {
    for (size_t k = 0; k < values; k++) hash = lar_hash_double(hash, value[k]);
    return hash;
}

uint64_t lar_viscous_hash(const lar_domain *whole, const lar_state *state, uint64_t hash) {
    for (lar_gid e = 0; whole->element_history && e < whole->model->mesh.element_count; e++) {
        double value[LAR_HISTORY_MAX];
        if (!lar_viscous_here(whole, e)) continue;
        lar_viscous_read(whole, state, e, value);
        hash = lar_viscous_hash_values(hash, value, (size_t)lar_viscous_count(whole->model, e));
    }
    return hash;
}
