#include "step/grasp.h"

#include <math.h>
#include <string.h>

#include "contact/tool_contact_face.h"

/* All grasps of one tool together [N/m]: two finger tips give by about a centimetre at 5 N;
 * jaws are metal, and what is left is the tissue between them. */
static const double HAND_STIFFNESS = 600, JAWS_STIFFNESS = 3000;

/* Openings at which a tool takes hold and lets go. */
static const double CLOSED = 0.25, OPEN = 0.5;

/* More do not hold better, and cost time in every step. */
enum { GRASPS_OF_A_TOOL = 48 };

/* What is asked about the points of the surface. */
typedef struct lar_reach {
    const lar_tool *tool;
    lar_tool_pose pose;
    double sine, cosine; /* of half the angle between the jaws */
} lar_reach;

/* Distance from the tip, or infinity where the tool cannot take hold of the point. `own` is the
 * point in the tool's own axes. */
static double reach_of(const lar_reach *reach, const double point[3], double own[3]) {
    const lar_tool *tool = reach->tool;
    double from_tip[3], square = 0;
    for (int i = 0; i < 3; i++) {
        from_tip[i] = point[i] - reach->pose.position[i];
        square += from_tip[i] * from_tip[i];
    }
    lar_turn_back(reach->pose.orientation, from_tip, own);
    double distance = sqrt(square);
    if (tool->shape == LAR_TOOL_HAND) return distance;
    /* Between two jaws that are as wide as thick: in front of the hinge, not beyond their ends, and
     * on the inner side of either's middle line. */
    bool aside = fabs(own[1]) > 2 * tool->radius;
    bool beyond = own[2] > 0 || distance > tool->length + tool->radius;
    bool between = fabs(own[0]) * reach->cosine <= -own[2] * reach->sine + tool->radius;
    return aside || beyond || !between ? INFINITY : distance;
}

/* Whether a face is so far from the tip that none of its points matters: a hand that has nothing
 * within its radius looks twice as far. */
static bool is_far(const lar_reach *reach, const double x[4][3]) {
    const lar_tool *tool = reach->tool;
    double length = tool->shape == LAR_TOOL_HAND ? tool->radius : tool->length;
    double center[3], square = 0, far = lar_tool_contact_ball_of(x, center);
    far += (1 + 1e-9) * (length + tool->radius);
    for (int i = 0; i < 3; i++) {
        double from_tip = center[i] - reach->pose.position[i];
        square += from_tip * from_tip;
    }
    return square > far * far;
}

/* Goes through all points in the order of the faces: counts those that are no farther than `max`,
 * notes the nearest distance, and adds every `every`-th to the grasps when it is not 0. */
static int32_t go_through(const lar_domain *whole, const lar_state *state, const lar_reach *reach,
                          double max, int32_t every, int32_t tool, lar_tools *tools,
                          double *nearest) {
    const lar_tool_faces *faces = &whole->surroundings.faces;
    int32_t count = 0;
    for (int32_t s = 0; s < whole->model->surface.face_count; s++) {
        const lar_tool_contact_face *face = &faces->face[faces->face_of[s]];
        double x[4][3], weight[4], point[3], own[3];
        lar_tool_contact_corners(face, state, x);
        if (is_far(reach, (const double(*)[3])x)) continue;
        int n = lar_tool_contact_points(face, reach->tool->radius);
        for (int i = 0; i < n * n; i++) {
            lar_tool_contact_weights(i, n, weight);
            lar_face_mean((const double(*)[3])x, weight, point);
            double distance = reach_of(reach, point, own);
            if (distance < *nearest) *nearest = distance;
            if (!(distance <= max)) continue;
            if (every > 0 && count % every == 0 && tools->grasp_count < LAR_GRASPS_MAX) {
                lar_grasp *grasp = &tools->grasps[tools->grasp_count++];
                *grasp = (lar_grasp){.tool = tool, .face = s};
                memcpy(grasp->weight, weight, sizeof weight);
                memcpy(grasp->anchor, own, sizeof own);
            }
            count++;
        }
    }
    return count;
}

/* Fairly: so much that all tools that can hold could have as much. */
static int32_t room_of(const lar_tool_list *list, const lar_tools *tools) {
    int32_t holders = 0;
    for (int32_t i = 0; i < list->count; i++)
        holders += list->tool[i].shape == LAR_TOOL_HAND || list->tool[i].shape == LAR_TOOL_GRASPER;
    int32_t room = LAR_GRASPS_MAX / holders, left = LAR_GRASPS_MAX - tools->grasp_count;
    if (room > GRASPS_OF_A_TOOL) room = GRASPS_OF_A_TOOL;
    return room < left ? room : left;
}

static void take(const lar_domain *whole, const lar_state *state, const lar_tool_list *list,
                 int32_t tool, const lar_tool_pose *pose, lar_tools *tools) {
    lar_reach reach = {.tool = &list->tool[tool], .pose = *pose};
    int32_t before = tools->grasp_count, room = room_of(list, tools);
    double max = INFINITY, nearest = INFINITY;
    bool hand = reach.tool->shape == LAR_TOOL_HAND;
    if (whole->surroundings.faces.face_count == 0 || room <= 0) return;
    if (hand) {
        max = reach.tool->radius;
    } else {
        lar_tool_at(&tools->motion[tool], state->step, whole->time_step, &reach.pose, NULL);
        double opening = fmax(reach.pose.opening, CLOSED);
        lar_sine_cosine(0.5 * reach.tool->spread * opening, &reach.sine, &reach.cosine);
        max = 2 * reach.tool->length + reach.tool->radius; /* the jaws themselves decide */
    }
    int32_t count = go_through(whole, state, &reach, max, 0, tool, tools, &nearest);
    if (count == 0 && hand && nearest <= 2 * max) {
        max = nearest;
        count = 1;
    }
    if (count == 0) return;
    go_through(whole, state, &reach, max, (count + room - 1) / room, tool, tools, &nearest);
    int32_t taken = tools->grasp_count - before;
    for (int32_t i = before; i < tools->grasp_count; i++)
        tools->grasps[i].stiffness = (hand ? HAND_STIFFNESS : JAWS_STIFFNESS) / taken;
}

void lar_grasp_drop(int32_t tool, lar_tools *tools) {
    int32_t kept = 0;
    for (int32_t i = 0; i < tools->grasp_count; i++)
        if (tools->grasps[i].tool != tool) tools->grasps[kept++] = tools->grasps[i];
    memset(tools->grasps + kept, 0, (size_t)(tools->grasp_count - kept) * sizeof *tools->grasps);
    tools->grasp_count = kept;
}

bool lar_grasp_slip(const lar_tool_list *list, lar_tools *tools) {
    bool slipped = false;
    for (int32_t t = 0; t < tools->count; t++) {
        lar_tool_motion *motion = &tools->motion[t];
        if (list->tool[t].shape != LAR_TOOL_GRASPER || tools->follower[t].felt.steps == 0) continue;
        if (motion->holding == LAR_HOLDS && lar_grasp_count(tools, t) > 0) {
            lar_grasp_drop(t, tools);
            slipped = true;
        }
        if (motion->holding == LAR_HOLDS_NEAR) motion->holding = LAR_HOLDS;
    }
    return slipped;
}

lar_status lar_grasp_update(const lar_domain *whole, const lar_state *state,
                            const lar_tool_list *list, int32_t tool, const lar_tool_pose *pose,
                            lar_tools *tools, lar_error *error) {
    (void)error;
    lar_tool_shape shape = list->tool[tool].shape;
    lar_tool_motion *motion = &tools->motion[tool];
    if (shape != LAR_TOOL_HAND && shape != LAR_TOOL_GRASPER) return LAR_OK;
    if (motion->holding && pose->opening > OPEN) {
        lar_grasp_drop(tool, tools);
        motion->holding = 0;
    } else if (!motion->holding && pose->opening < CLOSED) {
        take(whole, state, list, tool, pose, tools);
        motion->holding = LAR_HOLDS_NEAR;
    }
    return LAR_OK;
}

bool lar_grasp_changes(const lar_tool *tool, const lar_tool_motion *motion, double opening) {
    if (tool->shape != LAR_TOOL_GRASPER && tool->shape != LAR_TOOL_HAND) return false;
    return motion->holding ? opening > OPEN : opening < CLOSED;
}

int32_t lar_grasp_count(const lar_tools *tools, int32_t tool) {
    int32_t count = 0;
    for (int32_t i = 0; i < tools->grasp_count; i++) count += tools->grasps[i].tool == tool;
    return count;
}

void lar_grasp_ease(const lar_domain *whole, const lar_tool_list *list, int32_t tool,
                    double opening, lar_tools *tools) {
    const lar_tool_faces *faces = &whole->surroundings.faces;
    if (list->tool[tool].shape != LAR_TOOL_GRASPER) return;
    lar_contact_law law = lar_contact_law_for(whole->time_step, whole->stable_step);
    double share = fmax(0, fmin(1, (OPEN - opening) / (OPEN - CLOSED)));
    double wanted = JAWS_STIFFNESS / fmax(1, lar_grasp_count(tools, tool));
    for (int32_t i = 0; i < tools->grasp_count; i++) {
        lar_grasp *grasp = &tools->grasps[i];
        if (grasp->tool != tool) continue;
        /* Of what it really has, or softening would begin unseen. */
        double max =
            lar_grasp_stiffness_limit(&faces->face[faces->face_of[grasp->face]],
                                      list->tool[tool].radius, &law, lar_domain_springs(whole));
        grasp->stiffness = share * fmin(wanted, max);
    }
}
