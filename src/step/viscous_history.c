#include "step/viscous_history.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/history/body_friction.h"
#include "contact/history/tool_grip.h"

int lar_viscous_count(const lar_domain *domain, int32_t item) {
    if (lar_history_node(domain, item) >= 0) return LAR_STICK_VALUES;
    return lar_history_values(lar_model_material_of(domain->model, item)->viscosity.terms);
}

size_t lar_viscous_total(const lar_domain *domain) {
    const lar_model *model = domain->model;
    size_t total = LAR_STICK_VALUES * (size_t)domain->grip_count;
    if (domain->rubbing) total += lar_stick_total(domain->rubbing);
    bool any = false;
    for (int i = 0; i < model->material_count; i++)
        any = any || model->material[i].viscosity.terms > 0;
    for (lar_gid e = 0; any && e < model->mesh.element_count; e++)
        total += (size_t)lar_viscous_count(domain, e);
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

/* Nodes of free bodies that tools may hold. */
static lar_status plan_grips(lar_domain *domain, lar_error *error) {
    const int32_t count = lar_grips_list(domain->model, NULL);
    if (count == 0) return LAR_OK;
    domain->grip = lar_calloc((size_t)count, sizeof *domain->grip);
    if (!domain->grip)
        return lar_fail_memory(error, (size_t)count * sizeof(lar_gid), "free bodies");
    domain->grip_count = lar_grips_list(domain->model, domain->grip);
    domain->history_count = LAR_STICK_VALUES * (size_t)count;
    domain->history_count += LAR_BLOCK - 1 - (domain->history_count - 1) % LAR_BLOCK;
    return LAR_OK;
}

lar_status lar_viscous_plan(lar_domain *domain, lar_error *error) {
    const lar_model *model = domain->model;
    bool any = false;
    lar_status status = plan_grips(domain, error);
    if (status) return status;
    for (int i = 0; i < model->material_count; i++) {
        if (model->material[i].viscosity.terms == 0) continue;
        status = check_material(domain, &model->material[i], error);
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
    free(domain->grip);
    domain->grip = NULL;
    domain->grip_count = 0;
    domain->relaxing = NULL;
    domain->run_history = NULL;
    domain->element_history = NULL;
    domain->rubbing = NULL;
    domain->relaxing_bytes = domain->history_count = 0;
}

void lar_history_plan_nodes(lar_domain *domain, const lar_contact_surface *surface) {
    if (!surface->rough) return;
    domain->rubbing = surface;
    domain->history_count += lar_stick_total(surface);
}

/* ---- one item ---------------------------------------------------------------------------- */

/* Of a node. */
static double *stick_of(const lar_domain *domain, const lar_state *state, int32_t item) {
    const int32_t grip = lar_history_grip(domain, item);
    if (grip >= 0) return lar_grip_of(state, grip);
    return lar_stick_of(domain->rubbing, state, item - domain->model->mesh.element_count);
}

void lar_viscous_read(const lar_domain *domain, const lar_state *state, int32_t item,
                      double *value) {
    if (lar_history_node(domain, item) >= 0) {
        memcpy(value, stick_of(domain, state, item), LAR_STICK_VALUES * sizeof *value);
        return;
    }
    const double *from = state->history + domain->element_history[item];
    int count = lar_viscous_count(domain, item);
    for (int k = 0; k < count; k++) value[k] = from[LAR_BLOCK * k];
}

void lar_viscous_write(const lar_domain *domain, lar_state *state, int32_t item,
                       const double *value) {
    if (lar_history_node(domain, item) >= 0) {
        memcpy(stick_of(domain, state, item), value, LAR_STICK_VALUES * sizeof *value);
        return;
    }
    double *to = state->history + domain->element_history[item];
    int count = lar_viscous_count(domain, item);
    for (int k = 0; k < count; k++) to[LAR_BLOCK * k] = value[k];
}

/* ---- all of them ---------------------------------------------------------------------------- */

/* The first item that may remember. */
static int32_t first_item(const lar_domain *domain) {
    return domain->element_history ? 0 : domain->model->mesh.element_count;
}

void lar_viscous_gather(const lar_domain *whole, const lar_state *state, double *value) {
    for (int32_t i = first_item(whole); i < lar_history_end(whole); i++) {
        if (!lar_viscous_here(whole, i)) continue;
        lar_viscous_read(whole, state, i, value);
        value += lar_viscous_count(whole, i);
    }
}

void lar_viscous_scatter(const lar_domain *whole, lar_state *state, const double *value) {
    for (int32_t i = first_item(whole); i < lar_history_end(whole); i++) {
        if (!lar_viscous_here(whole, i)) continue;
        lar_viscous_write(whole, state, i, value);
        value += lar_viscous_count(whole, i);
    }
}

void lar_viscous_copy(const lar_domain *from, const lar_state *state, const lar_domain *to,
                      lar_state *copy) {
    for (int32_t i = first_item(from); i < lar_history_end(from); i++) {
        double value[LAR_HISTORY_MAX];
        if (!lar_viscous_here(from, i) || !lar_viscous_here(to, i)) continue;
        lar_viscous_read(from, state, i, value);
        lar_viscous_write(to, copy, i, value);
    }
}

uint64_t lar_viscous_hash_values(uint64_t hash, const double *value, size_t values) {
    for (size_t k = 0; k < values; k++) hash = lar_hash_double(hash, value[k]);
    return hash;
}

uint64_t lar_viscous_hash(const lar_domain *whole, const lar_state *state, uint64_t hash) {
    for (int32_t i = first_item(whole); i < lar_history_end(whole); i++) {
        double value[LAR_HISTORY_MAX];
        if (!lar_viscous_here(whole, i)) continue;
        lar_viscous_read(whole, state, i, value);
        hash = lar_viscous_hash_values(hash, value, (size_t)lar_viscous_count(whole, i));
    }
    return hash;
}
