/* Forces on nodes by cause, as the public header has them, and what those of contact are on the
 * area that they act on. */
#include "simulation/simulation.h"

#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
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

/* A quarter of each face that looks against the force on its corner, within some 70 degrees: of a
 * block's rim that is its base, and not its sides. */
static void add_areas(const lar_simulation *simulation, const double (*force)[3],
                      double (*normal)[3], double *area) {
    static const double LOOKS = 0.35;
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
            area[corner[a]] += size / 8;
            for (int i = 0; i < 3; i++) normal[corner[a]][i] += across[i];
        }
    }
}

/* The force on each node becomes that per area. */
static void divide(const lar_simulation *simulation, const double (*normal)[3], const double *area,
                   double (*force)[3], double *pressure) {
    for (int32_t n = 0; n < simulation->domain.model->mesh.node_count; n++) {
        const double length = lar_length(normal[n]);
        if (pressure)
            pressure[n] = length > 0 ? 0 - lar_dot(normal[n], force[n]) / (length * area[n]) : 0;
        for (int i = 0; i < 3; i++) force[n][i] = area[n] > 0 ? force[n][i] / area[n] : 0;
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
    double(*force)[3] = traction ? traction : own, (*normal)[3] = lar_calloc(nodes, sizeof *normal);
    double *area = lar_calloc(nodes, sizeof *area);
    if (!force || !normal || !area)
        status = lar_fail_memory(error, 56 * nodes, "the pressure of contact");
    if (!status) status = sum_contact(simulation, force, normal, error);
    if (!status) {
        memset(normal, 0, nodes * sizeof *normal);
        add_areas(simulation, (const double(*)[3])force, normal, area);
        divide(simulation, (const double(*)[3])normal, area, force, pressure);
    }
    free(own);
    free(normal);
    free(area);
    return status;
}
