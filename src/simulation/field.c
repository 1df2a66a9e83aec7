#include "simulation/field.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "simulation/simulation.h"
#include "mechanics/fold/hex8_fold.h"
#include "mechanics/hex8_full.h"

struct lar_field_plan {
    lar_hex8 *element; /* [elements]; NULL for the kinds that go the slow way */
};

/* ---- stress and energy ---------------------------------------------------------------------- */

/* Prepares all elements of the model. */
static lar_status plan_create(const lar_domain *whole, lar_field_plan **out, lar_error *error) {
    const lar_mesh *mesh = &whole->model->mesh;
    size_t elements = (size_t)mesh->element_count;
    bool prepares = whole->kind == LAR_ELEMENT_HEX8;
    lar_field_plan *plan = lar_calloc(1, sizeof *plan);
    if (plan && prepares) plan->element = lar_calloc_aligned(elements, sizeof *plan->element);
    if (!plan || (prepares && !plan->element)) {
        free(plan);
        return lar_fail_memory(error, elements * sizeof(lar_hex8), "the fields of pictures");
    }
    for (lar_gid e = 0; prepares && e < mesh->element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        lar_hex8_prepare(corner, lar_model_material_of(whole->model, e), &plan->element[e]);
        lar_model_fibres(whole->model, e, plan->element[e].fibre);
    }
    *out = plan;
    return LAR_OK;
}

void lar_field_plan_destroy(lar_field_plan *plan) {
    if (!plan) return;
    free(plan->element);
    free(plan);
}

/* As lar_measure_stress. */
static double element_value(const lar_field_plan *plan, const lar_domain *whole, lar_field field,
                            lar_gid e, const double u[8][3]) {
    const lar_material now = lar_domain_material_copy(whole, e, NULL), *material = &now;
    double cauchy[6], corner[8][3];
    if (plan->element) {
        double F[3][3], P[3][3];
        const double *fibre = plan->element[e].fibre;
        lar_hex8_gradient(&plan->element[e], u, F);
        if (field == LAR_FIELD_ENERGY)
            return lar_material_energy(material, fibre, (const double(*)[3])F);
        double J = lar_material_stress(material, fibre, (const double(*)[3])F, P);
        lar_cauchy_stress((const double(*)[3])F, (const double(*)[3])P, J, cauchy);
    } else {
        lar_mesh_corners(&whole->model->mesh, e, corner);
        if (field == LAR_FIELD_ENERGY)
            return lar_hex8_full_energy(corner, material, u) / lar_hexahedron_volume(corner);
        lar_hex8_full_stress(corner, material, u, cauchy);
    }
    return field == LAR_FIELD_PRESSURE ? lar_mean_pressure(cauchy) : lar_von_mises(cauchy);
}

/* What a node has of its elements so far. */
typedef struct node_mean {
    double sum;
    double count;
} node_mean;

static void corners_of(const lar_mesh *mesh, lar_gid e, const double (*u)[3], double corner[8][3]) {
    for (int a = 0; a < 8; a++) memcpy(corner[a], u[mesh->element[e][a]], sizeof corner[a]);
}

/* A field of stress or energy at u, [nodes][3] in the mesh's order, into out [nodes]. An element
 * that is inside out has none: it is left out; a node with no other one has 0. */
static lar_status of_elements(const lar_field_plan *plan, const lar_domain *whole, lar_field field,
                              const double (*u)[3], float *out, lar_error *error) {
    const lar_mesh *mesh = &whole->model->mesh;
    size_t nodes = (size_t)mesh->node_count;
    node_mean *mean = lar_calloc(nodes, sizeof *mean);
    if (!mean) return lar_fail_memory(error, nodes * sizeof *mean, "a field");
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        double corner[8][3];
        corners_of(mesh, e, u, corner);
        double value = element_value(plan, whole, field, e, (const double(*)[3])corner);
        for (int a = 0; a < 8 && fabs(value) <= (double)FLT_MAX; a++) {
            node_mean *node = &mean[mesh->element[e][a]];
            node->sum += value;
            node->count += 1;
        }
    }
    for (size_t n = 0; n < nodes; n++)
        out[n] = mean[n].count > 0 ? (float)(mean[n].sum / mean[n].count) : 0;
    free(mean);
    return LAR_OK;
}

/* ---- the public calls ----------------------------------------------------------------------- */

/* The simulation's plan, made when there is none. */
static lar_status find_plan(const lar_simulation *simulation, lar_field_plan **plan,
                            lar_error *error) {
    lar_field_plan **kept = &simulation->scratch->field;
    *plan = __atomic_load_n(kept, __ATOMIC_ACQUIRE);
    if (*plan) return LAR_OK;
    lar_field_plan *made = NULL;
    lar_status status = plan_create(&simulation->domain, &made, error);
    if (status) return status;
    if (__atomic_compare_exchange_n(kept, plan, made, false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE))
        *plan = made;
    else
        lar_field_plan_destroy(made);
    return LAR_OK;
}

static void measure_lengths(const double (*u)[3], size_t nodes, float *out) {
    for (size_t n = 0; n < nodes; n++)
        out[n] = (float)sqrt(u[n][0] * u[n][0] + u[n][1] * u[n][1] + u[n][2] * u[n][2]);
}

static void tell_processors(const lar_simulation *simulation, size_t nodes, float *out) {
    const int32_t *reporter = simulation->reporter;
    for (size_t n = 0; n < nodes; n++)
        out[n] = reporter ? (float)__atomic_load_n(&reporter[n], __ATOMIC_RELAXED) : 0;
}

static lar_status refuse_null(const char *call, lar_error *error) {
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s needs a simulation, displacements and a place for the answer; none may be "
                    "NULL",
                    call);
}

/* What elements have a value of their own of. */
static lar_status check_value(const char *call, lar_field field, const char *what, int32_t index,
                              int32_t count, lar_error *error) {
    if (index < 0 || index >= count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no %s %ld; the model has %ld, counted from 0", what, (long)index,
                        (long)count);
    if (field == LAR_FIELD_VON_MISES || field == LAR_FIELD_PRESSURE || field == LAR_FIELD_ENERGY)
        return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s has no field %d; take one of von Mises stress, pressure and energy", call,
                    (int)field);
}

static double value_at(const lar_simulation *simulation, const lar_field_plan *plan,
                       lar_field field, lar_gid e, const double (*u)[3]) {
    double corner[8][3];
    corners_of(&simulation->domain.model->mesh, e, u, corner);
    return element_value(plan, &simulation->domain, field, e, (const double(*)[3])corner);
}

lar_status lar_simulation_element_value(const lar_simulation *simulation, lar_field field,
                                        int32_t element, const double (*u)[3], double *value,
                                        lar_error *error) {
    static const char call[] = "lar_simulation_element_value";
    lar_field_plan *plan;
    if (!simulation || !u || !value) return refuse_null(call, error);
    lar_status status = check_value(call, field, "element", element,
                                    simulation->domain.model->mesh.element_count, error);
    if (!status) status = find_plan(simulation, &plan, error);
    if (!status) *value = value_at(simulation, plan, field, element, u);
    return status;
}

static bool has_node(const lar_mesh *mesh, lar_gid e, int32_t node) {
    for (int a = 0; a < 8; a++)
        if (mesh->element[e][a] == node) return true;
    return false;
}

lar_status lar_simulation_node_value(const lar_simulation *simulation, lar_field field,
                                     int32_t node, const double (*u)[3], double *value,
                                     lar_error *error) {
    static const char call[] = "lar_simulation_node_value";
    node_mean mean = {0};
    lar_field_plan *plan;
    if (!simulation || !u || !value) return refuse_null(call, error);
    const lar_mesh *mesh = &simulation->domain.model->mesh;
    lar_status status = check_value(call, field, "node", node, mesh->node_count, error);
    if (!status) status = find_plan(simulation, &plan, error);
    if (status) return status;
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        if (!has_node(mesh, e, node)) continue;
        double here = value_at(simulation, plan, field, e, u);
        if (!(fabs(here) <= (double)FLT_MAX)) continue;
        mean.sum += here;
        mean.count += 1;
    }
    *value = mean.count > 0 ? mean.sum / mean.count : 0;
    return LAR_OK;
}

lar_status lar_simulation_stored_energy(const lar_simulation *simulation, const double (*u)[3],
                                        double *strain, double *hourglass, lar_error *error) {
    if (!simulation || !u || !strain || !hourglass)
        return refuse_null("lar_simulation_stored_energy", error);
    const lar_model *model = simulation->domain.model;
    lar_field_plan *plan;
    lar_status status = find_plan(simulation, &plan, error);
    if (status) return status;
    *strain = *hourglass = 0;
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3], place[8][3], other = 0, factor;
        corners_of(&model->mesh, e, u, corner);
        lar_mesh_corners(&model->mesh, e, place);
        const lar_material now = lar_domain_material_copy(&simulation->domain, e, &factor);
        const lar_material *material = &now;
        *strain += plan->element ? lar_hex8_energy(&plan->element[e], material,
                                                   (const double(*)[3])corner, &other)
                                 : lar_hex8_full_energy((const double(*)[3])place, material,
                                                        (const double(*)[3])corner);
        *hourglass += factor * other; /* the plan has the hourglass stiffness of the model */
        if (plan->element)
            *hourglass += lar_hex8_fold_force((const double(*)[3])place, material,
                                              (const double(*)[3])corner, NULL);
    }
    return LAR_OK;
}

lar_status lar_simulation_field(const lar_simulation *simulation, lar_field field,
                                const double (*u)[3], float *out, lar_error *error) {
    if (!simulation || !u || !out) return refuse_null("lar_simulation_field", error);
    const lar_mesh *mesh = &simulation->domain.model->mesh;
    size_t nodes = (size_t)mesh->node_count;
    lar_field_plan *plan;
    lar_status status;
    for (size_t n = 0; n < nodes; n++)
        if (!(fabs(u[n][0]) <= 1e30 && fabs(u[n][1]) <= 1e30 && fabs(u[n][2]) <= 1e30))
            return lar_fail(error, LAR_ERROR_UNSTABLE,
                            "node %lld has left the range of numbers: there is nothing to draw; go "
                            "back to the start",
                            (long long)mesh->node_id[n]);
    switch (field) {
    case LAR_FIELD_DISPLACEMENT:
        measure_lengths(u, nodes, out);
        return LAR_OK;
    case LAR_FIELD_PROCESSOR:
        tell_processors(simulation, nodes, out);
        return LAR_OK;
    case LAR_FIELD_VON_MISES:
    case LAR_FIELD_PRESSURE:
    case LAR_FIELD_ENERGY:
        status = find_plan(simulation, &plan, error);
        return status ? status : of_elements(plan, &simulation->domain, field, u, out, error);
    case LAR_FIELD_VELOCITY:
        break;
    }
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "field %d cannot be had from displacements; take one of displacement, von "
                    "Mises stress, pressure, energy and processor",
                    (int)field);
}
