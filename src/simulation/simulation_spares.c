/* Tools that are added and removed while a simulation runs, as the public header has them. */
#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "model/contact_check.h"
#include "simulation/simulation.h"
#include "step/grasp.h"

/* A grasper's jaws, where nobody says how far they open: 60 degrees, as in scenes. */
static const double SPREAD = LAR_PI / 3;

/* ---- the room around the body --------------------------------------------------------------- */

typedef struct room {
    double lower[3], upper[3]; /* of the body now and at rest together [m] */
    double size;               /* of the body at rest: its diagonal [m] */
} room;

static void stretch(const double point[3], double lower[3], double upper[3]) {
    for (int i = 0; i < 3; i++) {
        lower[i] = fmin(lower[i], point[i]);
        upper[i] = fmax(upper[i], point[i]);
    }
}

/* The state is whole. In the mesh's order: the same on every grid. */
static void measure_room(const lar_simulation *simulation, room *around) {
    const lar_domain *domain = &simulation->domain;
    const lar_mesh *mesh = &domain->model->mesh;
    *around = (room){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0};
    for (lar_gid g = 0; g < mesh->node_count; g++)
        stretch(mesh->position[g], around->lower, around->upper);
    double diagonal[3];
    lar_minus(around->upper, around->lower, diagonal);
    around->size = lar_length(diagonal);
    for (lar_gid g = 0; g < mesh->node_count; g++) {
        double u[3], now[3];
        lar_state_displacement(&simulation->state, domain->layout.local[g], u);
        for (int i = 0; i < 3; i++) now[i] = mesh->position[g][i] + u[i];
        stretch(now, around->lower, around->upper);
    }
}

/* Above everything, tip down, places side by side: nothing of a tool is below its tip but the jaws
 * of a grasper. Room for a wide one, and for the tissue to move a little. */
static void find_place(const room *around, int32_t place, lar_tool *tool) {
    static const double aside[LAR_SPARES_MAX] = {0, 1, -1, 2};
    static const double CLEAR = 0.05;
    double wide = fmax(0.25 * (around->upper[0] - around->lower[0]), 3 * tool->radius);
    double below = tool->shape == LAR_TOOL_GRASPER ? tool->length : 0;
    tool->rest = (lar_tool_pose){.orientation = {1, 0, 0, 0}, .opening = 1};
    for (int i = 0; i < 2; i++)
        tool->rest.position[i] = 0.5 * (around->lower[i] + around->upper[i]);
    tool->rest.position[0] += aside[place] * wide;
    tool->rest.position[2] =
        around->upper[2] + below + tool->radius + fmax(tool->radius, CLEAR * around->size);
}

/* ---- what may be added ---------------------------------------------------------------------- */

/* A face feels tools at 6 x 6 points at most (contact/tool_contact.h): what is thinner could slip
 * between four of them. */
static double min_radius(const lar_simulation *simulation) {
    const lar_tool_faces *faces = &simulation->domain.surroundings.faces;
    double edge = 0;
    for (int32_t f = 0; f < faces->face_count; f++) edge = fmax(edge, faces->face[f].edge);
    return edge / LAR_POINTS_ALONG_EDGE * sqrt(0.5);
}

static lar_status check_size(const lar_simulation *simulation, const lar_tool *tool, double size,
                             lar_error *error) {
    const double RADIUS_MAX = 0.5, LENGTH_MAX = 5;
    const char *wrong = lar_tool_size_problem(tool);
    double min = min_radius(simulation);
    if (wrong) return lar_fail(error, LAR_ERROR_ARGUMENT, "the tool cannot be added: %s", wrong);
    if (tool->radius < min)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a radius of %.4g mm is too thin: large faces of this body would not feel "
                        "the tool everywhere; give it %.3g mm or more",
                        1e3 * tool->radius, 1e3 * 1.05 * min);
    if (tool->radius > RADIUS_MAX * size)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a radius of %.4g mm is too large for a body that is %.3g mm across; give "
                        "the tool %.3g mm at most",
                        1e3 * tool->radius, 1e3 * size, 1e3 * 0.99 * RADIUS_MAX * size);
    if (tool->length > LENGTH_MAX * size)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a length of %.4g mm is too large for a body that is %.3g mm across; give "
                        "the tool %.3g mm at most",
                        1e3 * tool->length, 1e3 * size, 1e3 * 0.99 * LENGTH_MAX * size);
    return LAR_OK;
}

int32_t lar_simulation_free_place(const lar_simulation *simulation) {
    int32_t place = 0;
    while (place < simulation->list.spares && simulation->tools.spare[place].placed) place++;
    return place;
}

static lar_status check_place(const lar_simulation *simulation, int32_t place, lar_error *error) {
    int32_t spares = simulation->list.spares;
    bool there = place >= 0 && place < spares;
    if (there && !simulation->tools.spare[place].placed) return LAR_OK;
    if (there)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "a tool is already where one shall be added");
    if (spares == 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "no tool can be added here; create the simulation with options.spares");
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "no place is left: %ld tools were added, which is the most; remove one of them",
                    (long)spares);
}

/* ---- adding and removing -------------------------------------------------------------------- */

/* What was said about the tool that was there is over. */
static void forget_tool(lar_simulation *simulation, int32_t tool) {
    simulation->report.tool[tool] = (lar_tool_sum){0};
    simulation->interval.depth[tool] = 0;
    if (!simulation->computer) return;
    simulation->computer->interval.depth[tool] = 0;
    simulation->computer->tools_sent = false;
}

static lar_status check_add(const lar_simulation *simulation, int32_t place, lar_error *error) {
    lar_status status = lar_simulation_check_change(simulation, "lar_simulation_add_tool", error);
    if (status) return status;
    if (simulation->fault.kind)
        return lar_fail(error, LAR_ERROR_UNSTABLE,
                        "the run has broken off; reset it or load a state before tools are added");
    return check_place(simulation, place, error);
}

lar_status lar_added_tool_check(const lar_tool_info *wanted, lar_error *error) {
    if (wanted->friction == 0) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "a tool that is added has no friction, and %g was asked for; ask for 0, or let "
                    "the scene have the tool",
                    wanted->friction);
}

lar_status lar_simulation_add_tool_at(lar_simulation *simulation, const lar_tool_info *wanted,
                                      int32_t place, lar_error *error) {
    lar_status status = check_add(simulation, place, error);
    if (!status) status = lar_added_tool_check(wanted, error);
    if (!status) status = lar_simulation_gather(simulation, error);
    if (status) return status;
    lar_tool added = {.shape = wanted->shape,
                      .radius = wanted->radius,
                      .length = wanted->length,
                      .spread = wanted->spread};
    if (added.shape == LAR_TOOL_GRASPER && added.spread == 0) added.spread = SPREAD;
    room around;
    measure_room(simulation, &around);
    find_place(&around, place, &added);
    status = check_size(simulation, &added, around.size, error);
    if (status) return status;
    lar_spare_put(place, &added, &simulation->list, &simulation->tools);
    forget_tool(simulation, lar_spares_first(&simulation->list) + place);
    lar_simulation_limit_tools(simulation);
    return LAR_OK;
}

lar_status lar_simulation_add_tool(lar_simulation *simulation, const lar_tool_info *wanted,
                                   int32_t *tool, lar_error *error) {
    lar_status status = lar_simulation_check_change(simulation, "lar_simulation_add_tool", error);
    if (status) return status;
    if (!wanted)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_simulation_add_tool needs a shape and a size, not NULL");
    int32_t place = lar_simulation_free_place(simulation);
    status = lar_simulation_add_tool_at(simulation, wanted, place, error);
    if (!status && tool) *tool = lar_spares_first(&simulation->list) + place;
    return status;
}

lar_status lar_simulation_remove_tool(lar_simulation *simulation, int32_t tool, lar_error *error) {
    lar_status status =
        lar_simulation_check_change(simulation, "lar_simulation_remove_tool", error);
    if (status) return status;
    int32_t place = lar_spare_of(&simulation->list, tool);
    if (tool < 0 || tool >= simulation->list.count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no tool %ld; the simulation has %ld, counted from 0", (long)tool,
                        (long)simulation->list.count);
    if (place < 0)
        return lar_fail(
            error, LAR_ERROR_ARGUMENT,
            "%s belongs to the scene or a viewer and stays; only tools that were added can be "
            "removed",
            simulation->list.tool[tool].name);
    if (!simulation->tools.spare[place].placed)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "tool %ld is not there", (long)tool);
    lar_grasp_drop(tool, &simulation->tools);
    lar_spare_clear(place, &simulation->list, &simulation->tools);
    forget_tool(simulation, tool);
    lar_simulation_limit_tools(simulation);
    return LAR_OK;
}
