/* Forces on nodes by cause, as the public header has them, and what those of contact are on the
 * area that they act on. */
#include "simulation/simulation.h"

#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "contact/contact_search.h"
#include "mechanics/contact.h"

lar_status lar_simulation_nodal_forces(const lar_simulation *simulation, lar_cause cause,
                                       int32_t tool, double (*force)[3], lar_error *error) {
    lar_status status = lar_simulation_check_zero(simulation, "lar_simulation_nodal_forces", error);
    if (status) return status;
    if (!force)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_simulation_nodal_forces needs room for the forces on all nodes, not "
                        "NULL");
    if ((int)cause < LAR_CAUSE_ELEMENTS || cause > LAR_CAUSE_DAMPING)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no cause %d of forces on nodes; lar_cause lists those that there "
                        "are",
                        (int)cause);
    if (cause == LAR_CAUSE_TOOL && (tool < 0 || tool >= simulation->list.count))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no tool %ld; the simulation has %ld, counted from 0", (long)tool,
                        (long)simulation->list.count);
    status = lar_simulation_gather(simulation, error);
    if (status) return status;
    return lar_measure_nodal_forces(&simulation->domain, &simulation->scratch->measure,
                                    &simulation->state, cause, tool, force, error);
}

/* ---- per area ------------------------------------------------------------------------------- */

/* What touches nodes: bodies, planes and tools. */
static lar_status sum_contact(const lar_simulation *simulation, double (*force)[3],
                              double (*part)[3], lar_error *error) {
    const size_t values = 3 * (size_t)simulation->domain.model->mesh.node_count;
    const int32_t tools = simulation->list.count;
    lar_status status = LAR_OK;
    double *to = &force[0][0];
    const double *from = &part[0][0];
    memset(force, 0, values * sizeof(double));
    for (int32_t t = -2; t < tools && !status; t++) {
        const lar_cause cause = t == -2   ? LAR_CAUSE_BODIES
                                : t == -1 ? LAR_CAUSE_PLANES
                                          : LAR_CAUSE_TOOL;
        if (t >= 0 && !lar_tool_touches(&simulation->list.tool[t])) continue;
        status = lar_measure_nodal_forces(&simulation->domain, &simulation->scratch->measure,
                                          &simulation->state, cause, t, part, error);
        for (size_t k = 0; k < values && !status; k++) to[k] += from[k];
    }
    return status;
}

/* A quarter of each face that looks against the force on its corner, within 60 degrees, as a
 * vector: of a block's rim that is its base, and not its sides; of a corner that is pressed from
 * three sides all of these, whose forces add up as their areas do. */
static void add_areas(const lar_simulation *simulation, const double (*force)[3],
                      double (*area)[3]) {
    static const double LOOKS = 0.5;
    const lar_model *model = simulation->domain.model;
    for (int32_t f = 0; f < model->surface.face_count; f++) {
        const int32_t *corner = model->surface.corner[f];
        double x[4][3], across[3];
        for (int a = 0; a < 4; a++) {
            lar_state_displacement(&simulation->state, simulation->domain.layout.local[corner[a]],
                                   x[a]);
            for (int i = 0; i < 3; i++) x[a][i] += model->mesh.position[corner[a]][i];
        }
        lar_face_normal((const double(*)[3])x, across);
        const double size = lar_length(across); /* twice its area */
        for (int a = 0; a < 4; a++) {
            const double *on = force[corner[a]];
            if (!(-lar_dot(across, on) > LOOKS * size * lar_length(on))) continue;
            for (int i = 0; i < 3; i++) area[corner[a]][i] += across[i] / 8;
        }
    }
}

/* The force on each node becomes that per area. */
static void divide(const lar_simulation *simulation, const double (*area)[3], double (*force)[3],
                   double *pressure) {
    for (int32_t n = 0; n < simulation->domain.model->mesh.node_count; n++) {
        const double size = lar_length(area[n]);
        if (pressure) pressure[n] = size > 0 ? 0 - lar_dot(area[n], force[n]) / (size * size) : 0;
        for (int i = 0; i < 3; i++) force[n][i] = size > 0 ? force[n][i] / size : 0;
    }
}

lar_status lar_simulation_contact_pressure(const lar_simulation *simulation, double (*traction)[3],
                                           double *pressure, lar_error *error) {
    lar_status status =
        lar_simulation_check_zero(simulation, "lar_simulation_contact_pressure", error);
    if (!status) status = lar_simulation_gather(simulation, error);
    if (status) return status;
    const size_t nodes = (size_t)simulation->domain.model->mesh.node_count;
    double(*own)[3] = traction ? NULL : lar_calloc(nodes, sizeof *own);
    double(*force)[3] = traction ? traction : own, (*area)[3] = lar_calloc(nodes, sizeof *area);
    if (!force || !area) status = lar_fail_memory(error, 48 * nodes, "the pressure of contact");
    if (!status) status = sum_contact(simulation, force, area, error);
    if (!status) {
        memset(area, 0, nodes * sizeof *area);
        add_areas(simulation, (const double(*)[3])force, area);
        divide(simulation, (const double(*)[3])area, force, pressure);
    }
    free(own);
    free(area);
    return status;
}

lar_status lar_simulation_contact_inside(const lar_simulation *simulation, int32_t *count,
                                         int32_t *node, lar_error *error) {
    lar_status status =
        lar_simulation_check_zero(simulation, "lar_simulation_contact_inside", error);
    if (!status && !count)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "lar_simulation_contact_inside needs a place for the count, not NULL");
    if (!status) status = lar_simulation_gather(simulation, error);
    if (status) return status;
    const lar_model *model = simulation->domain.model;
    const lar_contact_tree *tree = &simulation->domain.surroundings.bodies;
    const size_t nodes = (size_t)model->mesh.node_count;
    int32_t one = -1;
    *count = 0;
    if (node) *node = -1;
    if (tree->surface.node_count == 0) return LAR_OK;
    double(*force)[3] = lar_calloc(nodes, sizeof *force), (*u)[3] = lar_calloc(nodes, sizeof *u);
    if (!force || !u) status = lar_fail_memory(error, 48 * nodes, "nodes inside other bodies");
    if (!status)
        status = lar_measure_nodal_forces(&simulation->domain, &simulation->scratch->measure,
                                          &simulation->state, LAR_CAUSE_BODIES, 0, force, error);
    if (!status) {
        lar_simulation_displacements(simulation, u);
        status = lar_contact_count_inside(model, tree, (const double(*)[3])u,
                                          (const double(*)[3])force, count, &one, error);
    }
    if (node) *node = one;
    free(force);
    free(u);
    return status;
}
