/* Tools and contact of a simulation, as the public header has them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/pose.h"
#include "base/quaternion.h"
#include "base/vector.h"
#include "contact/tool_body.h"
#include "contact/touch_list.h"
#include "step/grasp.h"
#include "step/mass/heavier.h"
#include "simulation/simulation.h"

/* The simulation that this thread computes for a session. */
static _Thread_local const lar_simulation *held_here;

void lar_simulation_reserve(lar_simulation *simulation, bool held) {
    __atomic_store_n(&simulation->held, held, __ATOMIC_RELEASE);
}

void lar_simulation_reserve_here(const lar_simulation *simulation) {
    held_here = simulation;
}

static lar_status refuse_callback(const char *call, lar_error *error) {
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s: a callback may not do this; let it return 0, and do it afterwards", call);
}

lar_status lar_simulation_check_zero(const lar_simulation *simulation, const char *call,
                                     lar_error *error) {
    if (!simulation)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s needs a simulation, not NULL", call);
    if (simulation->computer && simulation->computer->first != 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s is for processor 0; the others call lar_simulation_serve", call);
    if (simulation->calling == 1 && simulation->computer) return refuse_callback(call, error);
    if (!__atomic_load_n(&simulation->held, __ATOMIC_ACQUIRE) || held_here == simulation)
        return LAR_OK;
    return lar_fail(
        error, LAR_ERROR_ARGUMENT,
        "%s: a session has this simulation for itself, and two at once would spoil it; ask the "
        "session (lar_session_...), or close it first",
        call);
}

lar_status lar_simulation_check_idle(const lar_simulation *simulation, const char *call,
                                     lar_error *error) {
    lar_status status = lar_simulation_check_zero(simulation, call, error);
    return !status && simulation->calling ? refuse_callback(call, error) : status;
}

lar_status lar_simulation_check_change(const lar_simulation *simulation, const char *call,
                                       lar_error *error) {
    lar_status status = lar_simulation_check_idle(simulation, call, error);
    if (!status && simulation->computer) status = lar_computer_check(simulation->computer, error);
    return status;
}

static lar_status check_tool(const lar_simulation *simulation, int32_t tool, const void *place,
                             lar_error *error) {
    if (!simulation || !place)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a tool's call needs a simulation, and a pose or a place for the answer; "
                        "none may be NULL");
    if (tool < 0 || tool >= simulation->list.count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no tool %ld; the simulation has %ld, counted from 0", (long)tool,
                        (long)simulation->list.count);
    return LAR_OK;
}

int32_t lar_simulation_tool_count(const lar_simulation *simulation) {
    return simulation ? simulation->list.count : 0;
}

lar_status lar_simulation_tool(const lar_simulation *simulation, int32_t index, lar_tool_info *info,
                               lar_error *error) {
    lar_status status = check_tool(simulation, index, info, error);
    if (status) return status;
    *info = lar_tool_inspect(&simulation->list.tool[index]);
    info->serial = lar_spare_serial(&simulation->list, &simulation->tools, index);
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

void lar_simulation_tool_asked(const lar_simulation *simulation, int32_t tool,
                               lar_tool_pose *pose) {
    const lar_tools *tools = &simulation->tools;
    const lar_tool_follower *follower = &tools->follower[tool];
    lar_tool_at(follower->lagging ? &follower->hand : &tools->motion[tool],
                lar_simulation_steps(simulation), simulation->domain.time_step, pose, NULL);
}

/* ---- moving -------------------------------------------------------------------------------- */

/* Beyond this a step could not be told from the next as a number. */
static const double STEPS_MAX = 0x1p53;

/* How far the end goes that goes farthest. */
static double way_of(const lar_tool *tool, const lar_tool_pose *now, const lar_tool_pose *pose) {
    lar_tool_body body;
    if (tool->shape == LAR_TOOL_RIGID) {
        double way[3];
        lar_minus(pose->position, now->position, way);
        return lar_length(way) +
               tool->length * lar_quaternion_angle(now->orientation, pose->orientation);
    }
    lar_segment from[2], to[2];
    lar_tool_place(tool, now, &body, from);
    lar_tool_place(tool, pose, &body, to);
    return lar_tool_way(from, to, body.count);
}

/* The fewest steps to a pose, each with at most so much of a way [m]. */
static uint64_t fewest_steps(const lar_simulation *simulation, int32_t index,
                             const lar_tool_pose *pose, double way) {
    lar_tool_pose now;
    lar_tool_at(&simulation->tools.follower[index].hand, lar_simulation_steps(simulation),
                simulation->domain.time_step, &now, NULL);
    return 1 + (uint64_t)(way_of(&simulation->list.tool[index], &now, pose) / way);
}

/* 0 steps: as many as its jaws need at the speed that tools have in sessions. What goes as far as
 * it may in a step would crush what it meets. */
static uint64_t steps_for(const lar_simulation *simulation, int32_t index,
                          const lar_tool_pose *pose, uint64_t steps) {
    static const double SPEED = 1; /* [m/s] */
    const lar_tool *tool = &simulation->list.tool[index];
    if (steps > 0 || tool->shape == LAR_TOOL_HAND) return steps > 0 ? steps : 1;
    const double way = fmin(0.5 * tool->radius, SPEED * simulation->domain.time_step);
    return fewest_steps(simulation, index, pose, way);
}

/* How much of a tool's radius it may go in a step, in words. */
static const char *half_of(const lar_tool *tool) {
    return tool->shape == LAR_TOOL_RIGID ? "half an element's edge" : "half its radius";
}

/* Contact is looked for once in a step: what goes farther could pass through a surface. */
static lar_status check_speed(const lar_tool *tool, const lar_tool_pose *now,
                              const lar_tool_pose *pose, uint64_t steps, double time_step,
                              lar_error *error) {
    double way = way_of(tool, now, pose), max = 0.5 * tool->radius * (double)steps;
    if (way <= max) return LAR_OK;
    return lar_fail(
        error, LAR_ERROR_ARGUMENT,
        "tool %s: an end or jaw that goes %.4g m in %llu steps is at %.4g m/s, more than "
        "%s in a step (%.4g m/s); take %.0f steps or a smaller way",
        tool->name, way, (unsigned long long)steps, way / ((double)steps * time_step),
        half_of(tool), 0.5 * tool->radius / time_step, ceil(2 * way / tool->radius));
}

/* On processor 0, between two steps. */
static lar_status move_tool(lar_simulation *simulation, int32_t index, const lar_tool_pose *pose,
                            uint64_t steps, lar_error *error) {
    const lar_tool *tool = &simulation->list.tool[index];
    lar_tools *tools = &simulation->tools;
    lar_tool_motion *motion = &tools->motion[index];
    lar_tool_pose now, wanted;
    uint64_t step = lar_simulation_steps(simulation);
    double time_step = simulation->domain.time_step;
    lar_status status = LAR_OK;
    if (steps < 1 || (double)steps > STEPS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "tool %s: a way takes 1 to 2^53 steps, not %llu",
                        tool->name, (unsigned long long)steps);
    lar_tool_at(&tools->follower[index].hand, step, time_step, &now, NULL);
    char whose[128];
    snprintf(whose, sizeof whose, "tool %s", tool->name);
    wanted = *pose;
    status = lar_pose_normalise(&wanted, whose, error);
    if (!status && !(tool->shape == LAR_TOOL_HAND && lar_grasp_count(tools, index) == 0))
        status = check_speed(tool, &now, &wanted, steps, time_step, error);
    if (!status && lar_grasp_changes(tool, motion, wanted.opening)) {
        /* An empty hand is where it takes hold: its way there means nothing. */
        if (tool->shape == LAR_TOOL_HAND && lar_grasp_count(tools, index) == 0) now = wanted;
        status = lar_simulation_gather(simulation, error);
        if (!status)
            status = lar_grasp_update(&simulation->domain, &simulation->state, &simulation->list,
                                      index, &wanted, tools, error);
    }
    if (status) return status;
    lar_grasp_ease(&simulation->domain, &simulation->list, index, wanted.opening, tools);
    lar_tool_ask(tools, index,
                 &(lar_tool_motion){.from = now, .to = wanted, .start = step, .end = step + steps});
    if (simulation->computer) simulation->computer->tools_sent = false;
    return LAR_OK;
}

lar_status lar_simulation_tool_move(lar_simulation *simulation, int32_t index,
                                    const lar_tool_pose *pose, uint64_t steps, lar_error *error) {
    lar_status status = check_tool(simulation, index, pose, error);
    if (!status) status = lar_simulation_check_idle(simulation, "lar_simulation_tool_move", error);
    if (!status && simulation->list.tool[index].shape == LAR_TOOL_NONE)
        status =
            lar_fail(error, LAR_ERROR_ARGUMENT,
                     "tool %ld is not there; add one with lar_simulation_add_tool", (long)index);
    return status ? status : move_tool(simulation, index, pose, steps, error);
}

/* ---- paths of the scene -------------------------------------------------------------------- */

/* The step before which a row's time is. */
static uint64_t step_of(const lar_tool_script_row *row, double time_step) {
    return (uint64_t)fmin(floor(row->time / time_step + 0.5), STEPS_MAX);
}

lar_status lar_simulation_check_paths(const lar_simulation *simulation, lar_error *error) {
    double time_step = simulation->domain.time_step;
    for (int32_t i = 0; i < simulation->list.count; i++) {
        const lar_tool *tool = &simulation->list.tool[i];
        for (size_t j = 0; j + 1 < tool->path.count; j++) {
            const lar_tool_script_row *row = &tool->path.row[j];
            uint64_t steps = step_of(row + 1, time_step) - step_of(row, time_step);
            double way = way_of(tool, &row->pose, &row[1].pose);
            double max = 0.5 * tool->radius * fmax(1, (double)steps);
            if (way > max)
                return lar_fail(error, LAR_ERROR_MODEL,
                                "%s: tool %s: its path goes %.4g m from %.6g to %.6g s, more than "
                                "%s in a step of %.3g s; give it %.3g s or more",
                                lar_model_source(simulation->domain.model), tool->name, way,
                                row->time, row[1].time, half_of(tool), time_step,
                                2 * way / tool->radius * time_step);
        }
    }
    return LAR_OK;
}

/* The part of a path that a step belongs to: from `row` to the one behind it, NULL at the end.
 * Jaws take hold as they close, so where they move the part goes in pieces of about a millisecond,
 * as devices move tools; else in one. */
typedef struct path_part {
    const lar_tool_script_row *row;
    uint64_t begin, end; /* of the piece [steps] */
} path_part;

static path_part part_at(const lar_tool_script *path, uint64_t step, double time_step) {
    static const double PIECE = 1e-3;   /* [s] */
    size_t low = 0, high = path->count; /* the last row at or before the step: low */
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        *(step_of(&path->row[middle], time_step) <= step ? &low : &high) = middle;
    }
    const lar_tool_script_row *row = &path->row[low];
    if (high == path->count) return (path_part){0};
    path_part part = {row, step_of(row, time_step), step_of(row + 1, time_step)};
    if (row->pose.opening != row[1].pose.opening) {
        uint64_t piece = (uint64_t)fmax(1, floor(PIECE / time_step + 0.5));
        part.begin += (step - part.begin) / piece * piece;
        if (part.begin + piece < part.end) part.end = part.begin + piece;
    }
    return part;
}

/* What moved a tool otherwise may have left it where its path is too far for the time. */
static lar_status follow_part(lar_simulation *simulation, int32_t index, const path_part *part,
                              lar_error *error) {
    double time_step = simulation->domain.time_step;
    const lar_tool_script_row *row = part->row;
    lar_tool_pose pose = row[1].pose;
    if (part->end < step_of(row + 1, time_step))
        lar_tool_script_between(row, fmax(row->time, (double)part->end * time_step), &pose);
    const double way = 0.5 * simulation->list.tool[index].radius;
    uint64_t steps = part->end - part->begin, least = fewest_steps(simulation, index, &pose, way);
    return move_tool(simulation, index, &pose, steps > least ? steps : least, error);
}

lar_status lar_simulation_follow_paths(lar_simulation *simulation, uint64_t *stop,
                                       lar_error *error) {
    uint64_t step = lar_simulation_steps(simulation);
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < simulation->list.count && !status; i++) {
        const lar_tool_script *path = &simulation->list.tool[i].path;
        if (path->count == 0) continue;
        path_part part = part_at(path, step, simulation->domain.time_step);
        if (!part.row) continue;
        if (part.begin == step) status = follow_part(simulation, i, &part, error);
        if (part.end < *stop) *stop = part.end;
    }
    return status;
}

lar_status lar_simulation_lead(void *context, lar_error *error) {
    lar_simulation *simulation = context;
    lar_status status = lar_simulation_gather(simulation, error);
    if (status) return status;
    lar_burden_take(&simulation->domain, &simulation->tools.heavier, NULL);
    lar_measure_ahead(&simulation->domain, &simulation->scratch->measure, &simulation->state,
                      &simulation->tools);
    return LAR_OK;
}

/* ---- taking hold --------------------------------------------------------------------------- */

lar_status lar_tool_check_grasp(const lar_tool *tool, const double point[3], lar_error *error) {
    if (tool->shape == LAR_TOOL_GRASPER) return LAR_OK;
    if (tool->shape == LAR_TOOL_NONE)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a place for tools is empty: none was added there, or it was removed");
    if (tool->shape != LAR_TOOL_HAND)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "tool %s is no hand and no grasper: it cannot take hold", tool->name);
    if (!point)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "tool %s is a hand: it needs the point where it shall take hold",
                        tool->name);
    for (int i = 0; i < 3; i++)
        if (!isfinite(point[i]))
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "hand %s: the point where it shall take hold is not finite",
                            tool->name);
    return LAR_OK;
}

lar_status lar_simulation_release(lar_simulation *simulation, int32_t index, uint64_t steps,
                                  lar_error *error) {
    static const double nowhere[3];
    lar_tool_pose pose;
    lar_status status = check_tool(simulation, index, nowhere, error);
    if (!status) status = lar_tool_check_grasp(&simulation->list.tool[index], nowhere, error);
    if (status) return status;
    lar_simulation_tool_asked(simulation, index, &pose);
    pose.opening = 1;
    steps = steps_for(simulation, index, &pose, steps);
    return lar_simulation_tool_move(simulation, index, &pose, steps, error);
}

lar_status lar_simulation_grasp(lar_simulation *simulation, int32_t index, const double point[3],
                                uint64_t steps, int32_t *held, lar_error *error) {
    static const double nowhere[3];
    lar_tool_pose pose;
    lar_status status = check_tool(simulation, index, nowhere, error);
    if (!status) status = lar_tool_check_grasp(&simulation->list.tool[index], point, error);
    if (status) return status;
    bool hand = simulation->list.tool[index].shape == LAR_TOOL_HAND;
    if (hand) status = lar_simulation_release(simulation, index, 1, error);
    if (status) return status;
    lar_simulation_tool_asked(simulation, index, &pose);
    if (hand) memcpy(pose.position, point, sizeof pose.position);
    pose.opening = 0;
    if (!hand) steps = steps_for(simulation, index, &pose, steps);
    status = lar_simulation_tool_move(simulation, index, &pose, hand ? 1 : steps, error);
    int32_t count = lar_grasp_count(&simulation->tools, index);
    if (held) *held = status ? 0 : count;
    if (status || count > 0 || !hand) return status;
    return lar_simulation_release(simulation, index, 1, error);
}

/* ---- what came of it ----------------------------------------------------------------------- */

static const lar_interval *interval_of(const lar_simulation *simulation) {
    return simulation->computer ? &simulation->computer->interval : &simulation->interval;
}

static double limit_of(const lar_tool_list *list, int32_t tool) {
    return lar_tool_touches(&list->tool[tool]) ? list->limits[tool].force : 0;
}

/* What both jaws have in common; what one of them is pushed with besides is a force on the tool. */
static double grasp_of(const lar_tool_sum *sum, double unit) {
    double jaw[2] = {(double)sum->jaw[0] * unit, (double)sum->jaw[1] * unit};
    return fmax(0, fmin(jaw[0], jaw[1]));
}

/* In newtons. Whole units stand apart from the rest, so that what one step has summed up comes out
 * to the last bit: minus the sum of lar_simulation_nodal_forces. */
static double mean_of(lar_wide sum, lar_wide shares, double scale) {
    return ((double)(sum / shares) + (double)(sum % shares) / (double)shares) / scale;
}

lar_status lar_simulation_tool_force(const lar_simulation *simulation, int32_t tool,
                                     lar_tool_force *force, lar_error *error) {
    lar_status status = check_tool(simulation, tool, force, error);
    if (status) return status;
    const lar_tool_sum *sum = &simulation->report.tool[tool];
    double steps = simulation->report_steps ? (double)simulation->report_steps : 1;
    double unit = 1 / (LAR_STEP_SHARES * simulation->domain.scale * steps);
    lar_wide shares = LAR_STEP_SHARES * (lar_wide)steps;
    const lar_tools *tools = &simulation->tools;
    const lar_interval *interval = interval_of(simulation);
    lar_tool_pose now, hand;
    double apart[3];
    lar_simulation_tool_pose(simulation, tool, &now, NULL);
    lar_simulation_tool_asked(simulation, tool, &hand);
    lar_minus(hand.position, now.position, apart);
    memset(force, 0, sizeof *force); /* gaps, too */
    force->touching = sum->touching;
    force->held = lar_grasp_count(tools, tool);
    force->limit = limit_of(&simulation->list, tool);
    force->depth = simulation->report_steps ? interval->depth[tool] : 0;
    force->apart = lar_length(apart);
    force->limited = tools->follower[tool].lagging != 0;
    force->grasp_force = grasp_of(sum, unit);
    for (int i = 0; i < 3; i++) {
        force->force[i] = mean_of(sum->force[i], shares, simulation->domain.scale);
        force->torque[i] = ((double)sum->torque[i] + (double)sum->rest[i] * LAR_TORQUE_REST) * unit;
    }
    return LAR_OK;
}

/* Corners as the model numbers them. */
static void name_nodes(const lar_domain *domain, lar_touch *touch) {
    bool rubs = touch->face < 0;
    int32_t local = touch->node[0];
    for (int a = 0; a < 4; a++)
        touch->node[a] = rubs ? -1 : domain->model->surface.corner[touch->face][a];
    if (rubs) touch->node[0] = domain->layout.global[local];
}

lar_status lar_simulation_tool_touches(const lar_simulation *simulation, int32_t tool, int32_t max,
                                       lar_touch *touch, int32_t *count, lar_error *error) {
    lar_status status = check_tool(simulation, tool, count, error);
    if (!status)
        status = lar_simulation_check_zero(simulation, "lar_simulation_tool_touches", error);
    if (!status && (max < 0 || (max > 0 && !touch)))
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "lar_simulation_tool_touches: there is no room for %ld points; give an "
                          "array, or 0 to count them",
                          (long)max);
    if (!status) status = lar_simulation_gather(simulation, error);
    if (status) return status;
    lar_touch_list list = {.tool = tool, .max = max, .touch = touch};
    lar_measure_touches(&simulation->domain, &simulation->scratch->measure, &simulation->state,
                        &list);
    for (int32_t i = 0; i < list.count && i < max; i++) name_nodes(&simulation->domain, &touch[i]);
    *count = list.count;
    return LAR_OK;
}

void lar_simulation_contact(const lar_simulation *simulation, lar_contact_info *info) {
    if (info) *info = simulation ? simulation->report.contact : (lar_contact_info){0};
}

double lar_simulation_contact_distance(const lar_simulation *simulation) {
    const lar_contact_surface *s =
        simulation ? simulation->interactions.body_contact.surface : NULL;
    double most[2] = {0}; /* two bodies keep the smaller of theirs: the second largest of all */
    for (int32_t b = 0; s && b < s->body_count; b++) {
        const double own = s->body[b].standoff;
        most[1] = fmax(most[1], fmin(most[0], own));
        most[0] = fmax(most[0], own);
    }
    return most[1];
}

/* ---- divided steps ------------------------------------------------------------------------- */

int32_t lar_simulation_step_parts(const lar_simulation *simulation) {
    if (!simulation) return 0;
    int32_t parts = simulation->tools.division.parts;
    return parts > 1 ? parts : 1;
}

uint64_t lar_simulation_divided_steps(const lar_simulation *simulation, int32_t *max) {
    if (max) *max = 0;
    if (!simulation) return 0;
    const lar_interval *interval = interval_of(simulation);
    if (max) *max = interval->parts > 1 ? interval->parts : 1;
    return interval->divided;
}

uint64_t lar_simulation_redivisions(const lar_simulation *simulation) {
    return simulation ? __atomic_load_n(&simulation->redivisions, __ATOMIC_RELAXED) : 0;
}

/* What may be added is the share that the scene says, of the model's mass. */
void lar_simulation_heavier(const lar_simulation *simulation, lar_heavier *heavier) {
    if (!heavier) return;
    *heavier = (lar_heavier){0};
    const lar_domain *domain = simulation ? &simulation->domain : NULL;
    if (!domain || !domain->burden) return;
    const lar_interval *interval = interval_of(simulation);
    double mass = domain->burden->most / domain->model->strained_share;
    heavier->elements = simulation->tools.heavier.count;
    heavier->share = lar_heavier_added(domain, &simulation->tools.heavier) / mass;
    if (interval->steps > 0)
        heavier->mean_share = interval->heavy_steps / (double)interval->steps / mass;
    heavier->largest_share = interval->heaviest / mass;
}
