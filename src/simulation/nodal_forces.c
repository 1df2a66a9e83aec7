/* Forces on nodes by cause, as the public header has them. */
#include "simulation/simulation.h"

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
