#include "contact/tools.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/pose.h"
#include "base/quaternion.h"
#include "base/vector.h"
#include "contact/spares.h"

/* How far a hand reaches: about a finger's breadth; of what is small a tenth of the bounding box's
 * diagonal, and so much that some point of a face is always within twice as much. */
static double hand_radius(const lar_model *model) {
    static const double FINGER = 0.008, OF_BODY = 0.1, OF_FACE = 0.5;
    const lar_surface *surface = &model->surface;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double edges = 0;
    for (int32_t f = 0; f < surface->face_count; f++)
        for (int a = 0; a < 4; a++) {
            const double *x = model->mesh.position[surface->corner[f][a]];
            const double *y = model->mesh.position[surface->corner[f][(a + 1) % 4]];
            double way[3];
            lar_minus(y, x, way);
            edges += lar_length(way);
            for (int i = 0; i < 3; i++) {
                low[i] = fmin(low[i], x[i]);
                high[i] = fmax(high[i], x[i]);
            }
        }
    double across[3];
    lar_minus(high, low, across);
    double face = edges / (4.0 * surface->face_count);
    return fmax(OF_FACE * face, fmin(FINGER, OF_BODY * lar_length(across)));
}

lar_status lar_tool_list_create(const lar_model *model, int32_t hands, int32_t spares,
                                lar_tool_list *list, lar_error *error) {
    if (hands < 0 || hands > LAR_HANDS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%ld hands; there can be 0 to %d", (long)hands,
                        (int)LAR_HANDS_MAX);
    if (spares < 0 || spares > LAR_SPARES_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%ld spare tools; there can be 0 to %d",
                        (long)spares, LAR_SPARES_MAX);
    const int max = LAR_TOOLS_MAX - LAR_SPARES_MAX;
    if (model->tool_count + hands > max)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s: %d tools and %ld hands; there can be %d together",
                        lar_model_source(model), model->tool_count, (long)hands, max);
    *list = (lar_tool_list){.count = model->tool_count + hands + spares, .spares = spares};
    if (model->tool_count)
        memcpy(list->tool, model->tool, (size_t)model->tool_count * sizeof *list->tool);
    for (int32_t i = 0; i < hands; i++) {
        if (i == 0)
            snprintf(list->hand[i], sizeof list->hand[i], "hand");
        else
            snprintf(list->hand[i], sizeof list->hand[i], "hand %d", (int)i + 1);
        list->tool[model->tool_count + i] =
            (lar_tool){.name = list->hand[i],
                       .shape = LAR_TOOL_HAND,
                       .radius = hand_radius(model),
                       .rest = {.orientation = {1, 0, 0, 0}, .opening = 1}};
    }
    lar_spares_name(list);
    return LAR_OK;
}

void lar_tools_reset(const lar_tool_list *list, lar_tools *tools) {
    lar_spare_tool added[LAR_SPARES_MAX];
    memcpy(added, tools->spare, sizeof added);
    memset(tools, 0, sizeof *tools);
    memcpy(tools->spare, added, sizeof added);
    tools->count = list->count;
    tools->division = (lar_step_division){.parts = 1, .before = 1, .hardness = 1, .base = 1};
    lar_settings_reset(&tools->settings);
    for (int32_t i = 0; i < LAR_TOOLS_MAX; i++) tools->hardness[i] = 1;
    for (int32_t i = 0; i < list->count; i++) {
        tools->motion[i] = (lar_tool_motion){.from = list->tool[i].rest, .to = list->tool[i].rest};
        tools->follower[i].hand = tools->motion[i];
    }
}

bool lar_tools_differ(const lar_tools *tools, int32_t count) {
    bool differ = false;
    for (int32_t i = 0; i < count; i++)
        differ = differ || tools->hardness[i] != tools->division.hardness || tools->deep[i] != 0;
    return differ;
}

/* ---- whether what a file says of them may be ----------------------------------------------------
 */

/* A way between two places is a number. Empty hands, which go no way, may be anywhere. */
static bool near_enough(const lar_tool *tool, const lar_tool_motion *motion) {
    static const double FARTHEST = 1e100;
    bool near = true;
    for (int i = 0; i < 3 && tool->shape != LAR_TOOL_HAND; i++)
        near = near && fabs(motion->from.position[i]) <= FARTHEST &&
               fabs(motion->to.position[i]) <= FARTHEST;
    return near;
}

bool lar_tool_motion_good(const lar_tool *tool, const lar_tool_motion *motion) {
    return lar_pose_is_normal(&motion->from) && lar_pose_is_normal(&motion->to) &&
           motion->start <= motion->end + 1 && motion->end <= LAR_STEPS_MAX &&
           motion->holding >= 0 && motion->holding <= LAR_HOLDS_NEAR &&
           (motion->outside | 1) == 1 && near_enough(tool, motion);
}

/* Sums are whatever they are; tissue is no deeper in a tool than its middle. Hands never lag. */
bool lar_tool_follower_good(const lar_tool *tool, const lar_tool_follower *follower) {
    const lar_tool_felt *felt = &follower->felt;
    int32_t lagging_max = tool->shape != LAR_TOOL_HAND;
    return lar_tool_motion_good(tool, &follower->hand) && follower->hand.holding == 0 &&
           follower->hand.outside == 0 && felt->depth >= 0 && felt->depth <= tool->radius &&
           felt->steps <= LAR_STEPS_MAX && follower->load >= 0 && isfinite(follower->load) &&
           follower->lagging >= 0 && follower->lagging <= lagging_max &&
           (follower->behind | 1) == 1;
}

bool lar_grasp_good(const lar_grasp *grasp, int32_t tools, const lar_model *model) {
    double sum = grasp->weight[0] + grasp->weight[1] + grasp->weight[2] + grasp->weight[3];
    bool finite = isfinite(grasp->stiffness);
    for (int a = 0; a < 4; a++) finite = finite && isfinite(grasp->weight[a]);
    for (int i = 0; i < 3; i++) finite = finite && isfinite(grasp->anchor[i]);
    return finite && grasp->tool >= 0 && grasp->tool < tools && grasp->face >= 0 &&
           grasp->face < model->surface.face_count && fabs(sum - 1) <= 1e-6 &&
           grasp->stiffness >= 0;
}

static bool good_parts(int32_t parts) {
    int32_t some = 1;
    while (some < parts && some < LAR_PARTS_MAX) some = lar_more_parts(some);
    return some == parts;
}

bool lar_division_good(const lar_step_division *d, uint64_t step) {
    return good_parts(d->parts) && good_parts(d->before) && d->since <= step &&
           d->decided <= step && d->hardness >= 1 && d->hardness <= 4.0 * d->parts * d->parts &&
           d->hardness <= LAR_HARDNESS_MAX && d->need >= 0 && d->lately >= 0 &&
           d->lately <= LAR_NEED_MAX && d->base >= 1 && d->base <= LAR_PARTS_MAX &&
           (d->base & (d->base - 1)) == 0 && d->softer >= 0 && d->due >= 0 &&
           (d->due & ~LAR_THROWN) <= 2 * LAR_WATCHED + 1 && abs(d->still) <= LAR_STILL_LONG &&
           d->untouched >= 0;
}

bool lar_hardness_good(const lar_tools *tools, int32_t tool, double radius) {
    double hardness = tools->hardness[tool], deep = tools->deep[tool];
    return hardness >= 1 && hardness <= tools->division.hardness && deep >= 0 && deep <= radius;
}

/* ---- where they are ----------------------------------------------------------------------------
 */

void lar_tool_at(const lar_tool_motion *motion, uint64_t step, double time_step,
                 lar_tool_pose *pose, double velocity[3]) {
    lar_tool_within(motion, step, 0, time_step, pose, velocity);
}

void lar_tool_within(const lar_tool_motion *motion, uint64_t step, double part, double time_step,
                     lar_tool_pose *pose, double velocity[3]) {
    bool moves = step < motion->end;
    if (velocity)
        for (int i = 0; i < 3; i++)
            velocity[i] = moves ? (motion->to.position[i] - motion->from.position[i]) /
                                      ((double)(motion->end - motion->start) * time_step)
                                : 0;
    if (!moves || step < motion->start) {
        *pose = moves ? motion->from : motion->to;
        return;
    }
    double share = ((double)(step - motion->start) + part) / (double)(motion->end - motion->start);
    for (int i = 0; i < 3; i++)
        pose->position[i] = (1 - share) * motion->from.position[i] + share * motion->to.position[i];
    lar_quaternion_blend(motion->from.orientation, motion->to.orientation, share,
                         pose->orientation);
    pose->opening = (1 - share) * motion->from.opening + share * motion->to.opening;
}

/* The same way once more. */
static void go_on(lar_tool_motion *motion) {
    const lar_tool_pose from = motion->from;
    double back[4], turn[4];
    motion->from = motion->to;
    motion->end += motion->end - motion->start;
    motion->start = (motion->start + motion->end) / 2;
    for (int i = 0; i < 3; i++)
        motion->to.position[i] += motion->from.position[i] - from.position[i];
    lar_quaternion_inverse(from.orientation, back);
    lar_quaternion_product(motion->from.orientation, back, turn);
    lar_quaternion_product(turn, motion->from.orientation, motion->to.orientation);
    lar_quaternion_normalise(motion->to.orientation);
    motion->to.opening = fmin(1, fmax(0, 2 * motion->from.opening - from.opening));
}

bool lar_tools_go_on(const lar_tools *tools, uint64_t step, lar_tools *next) {
    bool any = false;
    for (int32_t i = 0; i < tools->count; i++) {
        const lar_tool_motion *motion = &tools->motion[i];
        if (!tools->follower[i].lagging || motion->end != step || motion->start >= step) continue;
        if (!any) *next = *tools;
        any = true;
        go_on(&next->motion[i]);
    }
    return any;
}

void lar_tool_pose_now(const lar_tool_motion *motion, const lar_state *state, int32_t ahead,
                       double time_step, lar_tool_pose *pose) {
    int32_t part = state->part + ahead;
    if (lar_tool_motion_free(motion) && motion->end == state->step) {
        *pose = ahead > 0 ? motion->to : motion->from;
        return;
    }
    if (part >= state->parts)
        lar_tool_at(motion, state->step + 1, time_step, pose, NULL);
    else
        lar_tool_within(motion, state->step, (double)part / state->parts, time_step, pose, NULL);
}

/* v' = v + 2 w (a x v) + 2 a x (a x v), a the vector part; `sign` -1 turns back. */
static void rotate(const double q[4], double sign, const double v[3], double out[3]) {
    double c[3], a[3] = {sign * q[1], sign * q[2], sign * q[3]};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = 2 * (a[j] * v[k] - a[k] * v[j]);
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = v[i] + q[0] * c[i] + (a[j] * c[k] - a[k] * c[j]);
    }
}

void lar_turn(const double q[4], const double v[3], double out[3]) {
    rotate(q, 1, v, out);
}

void lar_turn_back(const double q[4], const double v[3], double out[3]) {
    rotate(q, -1, v, out);
}
