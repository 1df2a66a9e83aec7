/* Tools and contact of a simulation, as the public header has them. */
#include <math.h>

#include "engine/simulation.h"

static lar_status check_tool(const lar_simulation *simulation, int32_t tool, const void *place,
                             lar_error *error) {
    if (!simulation || !place)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a tool's call needs a simulation and a place for the answer; neither may "
                        "be NULL");
    if (tool < 0 || tool >= simulation->list.count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no tool %ld; the simulation has %ld, counted from 0", (long)tool,
                        (long)simulation->list.count);
    return LAR_OK;
}

int32_t lar_simulation_tool_count(const lar_simulation *simulation) {
    return simulation->list.count;
}

lar_status lar_simulation_tool(const lar_simulation *simulation, int32_t index, lar_tool_info *info,
                               lar_error *error) {
    lar_status status = check_tool(simulation, index, info, error);
    if (status) return status;
    const lar_tool *tool = &simulation->list.tool[index];
    *info = (lar_tool_info){.name = tool->name,
                            .shape = tool->shape,
                            .radius = tool->radius,
                            .length = tool->length,
                            .spread = tool->spread,
                            .rest = tool->rest};
    return LAR_OK;
}

lar_status lar_simulation_tool_pose(const lar_simulation *simulation, int32_t tool,
                                    lar_tool_pose *pose, lar_error *error) {
    lar_status status = check_tool(simulation, tool, pose, error);
    if (!status)
        lar_tool_at(&simulation->tools.motion[tool], lar_simulation_steps(simulation),
                    simulation->domain.time_step, pose, NULL);
    return status;
}

lar_status lar_simulation_tool_move(lar_simulation *simulation, int32_t tool,
                                    const lar_tool_pose *pose, uint64_t steps, lar_error *error) {
    lar_tool_pose now;
    lar_status status = check_tool(simulation, tool, pose, error);
    if (!status) status = lar_simulation_tool_pose(simulation, tool, &now, error);
    if (status) return status;
    uint64_t step = lar_simulation_steps(simulation);
    lar_tool_motion *motion = &simulation->tools.motion[tool];
    motion->from = now;
    motion->to = *pose;
    motion->start = step;
    motion->end = step + (steps ? steps : 1);
    return LAR_OK;
}

lar_status lar_simulation_tool_force(const lar_simulation *simulation, int32_t tool,
                                     lar_tool_force *force, lar_error *error) {
    lar_status status = check_tool(simulation, tool, force, error);
    if (!status) *force = (lar_tool_force){0};
    return status;
}

void lar_simulation_contact(const lar_simulation *simulation, lar_contact_info *info) {
    (void)simulation;
    *info = (lar_contact_info){0};
}
