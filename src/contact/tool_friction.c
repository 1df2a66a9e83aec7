#include "contact/tool_friction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "contact/touch_list.h"

/* ---- set-up -------------------------------------------------------------------------------- */

bool lar_tool_friction_any(const lar_tool_list *list) {
    for (int32_t t = 0; list && t < list->count; t++)
        if (list->tool[t].friction > 0) return true;
    return false;
}

/* By local node: the surface node of the model that may rub, -1: none. */
LAR_SETUP static void find_nodes(const lar_model *model, const int32_t *local,
                                 const lar_condition_share *share, int32_t *node) {
    for (int32_t i = 0; i < 4 * model->surface.face_count; i++) {
        int32_t n = model->surface.corner[i / 4][i % 4];
        if (local[n] >= 0 && (!share || share->holds[n] == share->thread)) node[local[n]] = n;
    }
}

LAR_SETUP lar_status lar_tool_friction_list(const lar_model *model, const int32_t *local,
                                            const lar_condition_share *share,
                                            const lar_conditions *conditions, lar_tool_faces *faces,
                                            lar_error *error) {
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        if (local[n] >= faces->local_count) faces->local_count = local[n] + 1;
    size_t nodes = (size_t)model->surface.node_count, all = (size_t)faces->local_count;
    int32_t *node = lar_calloc(all, sizeof *node), *place = lar_calloc(all, sizeof *place);
    faces->rub = lar_calloc(nodes, sizeof *faces->rub);
    faces->rub_node = lar_calloc(nodes, sizeof *faces->rub_node);
    lar_status status = LAR_OK;
    if (!node || !place || !faces->rub || !faces->rub_node)
        status = lar_fail_memory(error, nodes * sizeof *faces->rub, "the nodes before tools");
    for (size_t n = 0; n < all && !status; n++) node[n] = place[n] = -1;
    if (!status) find_nodes(model, local, share, node);
    for (int32_t n = 0; n < faces->local_count && !status; n++) {
        if (node[n] < 0) continue;
        place[n] = faces->rub_count++;
        faces->rub_node[place[n]] = n;
        faces->rub[place[n]].node = node[n];
        memcpy(faces->rub[place[n]].rest, model->mesh.position[node[n]], sizeof faces->rub->rest);
    }
    for (int32_t i = 0; i < conditions->constraint_count && !status; i++) {
        int32_t at = place[conditions->constraint[i].node];
        if (at >= 0) faces->rub[at].held = true;
    }
    free(node);
    free(place);
    return status;
}

LAR_SETUP lar_status lar_tool_friction_create(lar_tool_contact *contact, lar_error *error) {
    if (!lar_tool_friction_any(contact->list)) return LAR_OK;
    size_t values = 3 * (size_t)contact->faces->local_count;
    size_t nodes = (size_t)contact->faces->rub_count;
    contact->press = lar_calloc(values, sizeof *contact->press);
    contact->rubbed = lar_calloc(nodes, sizeof *contact->rubbed);
    if (contact->press && contact->rubbed) return LAR_OK;
    return lar_fail_memory(error, values * sizeof *contact->press + nodes * sizeof *contact->rubbed,
                           "friction of tools");
}

void lar_tool_friction_destroy(lar_tool_contact *contact) {
    free(contact->press);
    free(contact->rubbed);
    contact->press = NULL;
    contact->rubbed = NULL;
}

void lar_tool_friction_forget(lar_tool_contact *contact) {
    if (!contact->press) return;
    memset(contact->press, 0, 3 * (size_t)contact->faces->local_count * sizeof *contact->press);
}

/* ---- the step ------------------------------------------------------------------------------ */

static inline int64_t *press_at(const lar_tool_contact *contact, int32_t node, int axis) {
    return contact->press + node + (size_t)axis * (size_t)contact->faces->local_count;
}

void lar_tool_friction_press(lar_tool_contact *contact, const lar_condition_context *context,
                             double friction, const lar_tool_contact_face *face,
                             const double force[3][4]) {
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) {
            double units = friction * force[i][a] * context->scale;
            if (fabs(units) < 0x1p56) *press_at(contact, face->node[a], i) += llrint(units);
        }
}

/* A tool with friction in the step under way. */
typedef struct rough_tool {
    int32_t tool;
    double radius;
    lar_tool_pose now, next;
    lar_tool_body body;
    bool turns;
    double speed[3];   /* of the tip [m/s] */
    double turn[3][3]; /* from the way from the tip to a point: what its speed is more [1/s] */
    lar_tool_sum felt; /* as of one share of a step: the sums of many take 128 bits */
} rough_tool;

/* How fast what is fixed to the tool goes: as fast as takes it to its next place. */
static void follow(rough_tool *r, double dt) {
    r->turns = memcmp(r->now.orientation, r->next.orientation, sizeof r->now.orientation) != 0;
    for (int i = 0; i < 3; i++) r->speed[i] = (r->next.position[i] - r->now.position[i]) / dt;
    for (int i = 0; i < 3 && r->turns; i++) {
        double axis[3] = {i == 0, i == 1, i == 2}, own[3], to[3];
        lar_turn_back(r->now.orientation, axis, own);
        lar_turn(r->next.orientation, own, to);
        for (int k = 0; k < 3; k++) r->turn[k][i] = (to[k] - axis[k]) / dt;
    }
}

static int32_t place_tools(const lar_tool_contact *contact, const lar_condition_context *context,
                           const lar_state *state, rough_tool rough[LAR_TOOLS_MAX]) {
    int32_t count = 0;
    for (int32_t t = 0; t < contact->list->count; t++) {
        const lar_tool *tool = &contact->list->tool[t];
        if (!(tool->friction > 0)) continue;
        rough_tool *r = &rough[count++];
        const lar_tool_motion *motion = &contact->tools->motion[t];
        r->tool = t;
        r->radius = tool->radius;
        r->felt = (lar_tool_sum){0};
        lar_tool_pose_now(motion, state, 0, context->whole_step, &r->now);
        lar_tool_pose_now(motion, state, 1, context->whole_step, &r->next);
        lar_tool_place(tool, &r->now, &r->body, r->body.now);
        lar_tool_place(tool, &r->next, &r->body, r->body.next);
        follow(r, context->time_step);
    }
    return count;
}

static rough_tool *nearest(rough_tool *rough, int32_t count, const double x[3]) {
    rough_tool *found = rough;
    double min = INFINITY;
    for (int32_t i = 0; i < count && count > 1; i++) {
        double distance = lar_tool_contact_distance(&rough[i].body, rough[i].radius, x);
        if (!(distance < min)) continue;
        min = distance;
        found = &rough[i];
    }
    return found;
}

/* Velocity at x of what is fixed to the tool. */
static inline void rigid_velocity(const rough_tool *tool, const double x[3], double velocity[3]) {
    memcpy(velocity, tool->speed, 3 * sizeof *velocity);
    if (!tool->turns) return;
    double arm[3];
    lar_minus(x, tool->now.position, arm);
    for (int i = 0; i < 3; i++) velocity[i] += lar_dot(tool->turn[i], arm);
}

/* Jaws turn about their hinge besides: their middle lines tell by how much. */
static void add_opening(const rough_tool *tool, const double x[3], double dt, double velocity[3]) {
    double deepest = -INFINITY, normal[3], along = 0, part, end[3];
    int32_t jaw = 0;
    for (int32_t s = 0; s < tool->body.count; s++) {
        double depth = lar_segment_depth(&tool->body.now[s], tool->radius, x, normal, &part);
        if (!(depth > deepest)) continue;
        deepest = depth;
        jaw = s;
        along = part;
    }
    const double *now = tool->body.now[jaw].end[1], *next = tool->body.next[jaw].end[1];
    rigid_velocity(tool, now, end);
    for (int i = 0; i < 3; i++) velocity[i] += along * ((next[i] - now[i]) / dt - end[i]);
}

/* The force on a node whose press sum is `press`, in whole units. */
static inline void rub(const double press[3], const double velocity[3], double unit,
                       const lar_leapfrog *leapfrog, const double *v, const int64_t *force,
                       int64_t units[3]) {
    double square = lar_dot(press, press), along[3], before[3];
    for (int i = 0; i < 3; i++) {
        double ahead = leapfrog->keep * v[i] + leapfrog->drift[i] - unit * (double)force[i];
        before[i] = v[i] - velocity[i];
        along[i] = ahead - velocity[i];
    }
    double across = lar_dot(press, along) / square;
    for (int i = 0; i < 3; i++) along[i] -= press[i] * across;
    double part =
        lar_friction_part(unit * sqrt(square), lar_dot(along, along), lar_dot(along, before));
    double times = -part / unit;
    for (int i = 0; i < 3; i++) {
        double wanted = times * along[i];
        units[i] = fabs(wanted) < 0x1p56 ? llrint(wanted) : 0;
    }
}

/* For who looks. */
__attribute__((noinline, cold)) static void note_rub(lar_touch_list *touches, int32_t local,
                                                     const double x[3], const double press[3],
                                                     const int64_t force[3], double scale) {
    lar_touch touch = {.kind = LAR_TOUCH_RUBBED, .face = -1, .node = {local}, .weight = {1}};
    double size = lar_length(press);
    for (int i = 0; i < 3; i++) {
        touch.place[i] = x[i];
        touch.normal[i] = press[i] / size;
    }
    lar_touch_note(touches, &touch);
    lar_touch_settle(touches, force, scale);
    lar_touch_push(touches, local, force);
}

static void rub_node(lar_tool_contact *contact, const lar_condition_context *context,
                     const lar_leapfrog *leapfrog, double push, rough_tool *rough, int32_t count,
                     const lar_tool_rub_node *node, lar_tool_rubbed *rubbed, const int64_t sum[3],
                     lar_state *state) {
    const double press[3] = {(double)sum[0], (double)sum[1], (double)sum[2]};
    const int32_t local = rubbed->node;
    double x[3], v[3], velocity[3];
    int64_t force[3];
    for (int i = 0; i < 3; i++) {
        x[i] = node->rest[i] + state->u[lar_state_at(state, local, i)];
        force[i] = state->force[lar_state_at(state, local, i)];
    }
    lar_state_velocity(state, local, v);
    rough_tool *tool = nearest(rough, count, x);
    rigid_velocity(tool, x, velocity);
    if (tool->body.count > 1) add_opening(tool, x, context->time_step, velocity);
    rub(press, velocity, leapfrog->push * push, leapfrog, v, force, rubbed->force);
    for (int i = 0; i < 3; i++)
        state->force[lar_state_at(state, local, i)] = force[i] - rubbed->force[i];
    if (!(context->weight[local] > 0)) return; /* another processor tells the tool */
    if (contact->touches && contact->touches->tool == tool->tool)
        note_rub(contact->touches, local, x, press, rubbed->force, context->scale);
    double arm[3];
    lar_tool_push felt = {0};
    lar_minus(x, tool->now.position, arm);
    lar_tool_push_add(&felt, arm, rubbed->force);
    lar_tool_sum_add(&tool->felt, 1, &felt);
}

/* What a tool has felt of the step, in all shares of it. */
static void tell_tool(const rough_tool *rough, int32_t shares, lar_tool_sum *sum) {
    for (int i = 0; i < 3; i++) {
        sum->force[i] += shares * rough->felt.force[i];
        sum->torque[i] += shares * rough->felt.torque[i];
        sum->rest[i] += shares * rough->felt.rest[i];
    }
}

static inline bool is_held(const lar_tool_rub_node *node, const lar_condition_context *context) {
    return context->held ? context->held[node->node] & LAR_AXIS_ALL : node->held;
}

/* Lists the nodes that are pressed. Nearly all of the surface is not, so what is done for each of
 * its nodes is kept short, and has no branch. */
static int32_t list_pressed(const lar_tool_contact *contact) {
    const int32_t *node = contact->faces->rub_node, all = contact->faces->rub_count;
    const int64_t *press = contact->press;
    const size_t axis = (size_t)contact->faces->local_count;
    lar_tool_rubbed *rubbed = contact->rubbed;
    int32_t count = 0;
    for (int32_t i = 0; i < all; i++) {
        const int64_t *at = press + node[i];
        rubbed[count].node = i;
        count += (at[0] | at[axis] | at[2 * axis]) != 0;
    }
    return count;
}

void lar_tool_friction_add(lar_tool_contact *contact, const lar_condition_context *context,
                           const lar_leapfrog *leapfrog, const double *push, lar_state *state) {
    const int32_t pressed = list_pressed(contact);
    rough_tool rough[LAR_TOOLS_MAX];
    contact->rubbed_count = 0;
    if (pressed == 0) return;
    int32_t count = place_tools(contact, context, state, rough);
    for (int32_t i = 0; i < pressed; i++) {
        const lar_tool_rub_node *node = &contact->faces->rub[contact->rubbed[i].node];
        const int32_t local = contact->faces->rub_node[contact->rubbed[i].node];
        int64_t sum[3];
        for (int k = 0; k < 3; k++) {
            sum[k] = *press_at(contact, local, k);
            *press_at(contact, local, k) = 0;
        }
        if (is_held(node, context)) continue;
        lar_tool_rubbed *rubbed = &contact->rubbed[contact->rubbed_count++];
        rubbed->node = local;
        rub_node(contact, context, leapfrog, push[local], rough, count, node, rubbed, sum, state);
    }
    for (int32_t i = 0; i < count; i++)
        tell_tool(&rough[i], context->shares, &contact->sum[rough[i].tool]);
}

void lar_tool_friction_half_work(const lar_tool_contact *contact,
                                 const lar_condition_context *context, lar_state *state) {
    double work = 0;
    for (int32_t i = 0; i < contact->rubbed_count; i++) {
        const lar_tool_rubbed *rubbed = &contact->rubbed[i];
        /* A node that several processors have is accounted for by one. */
        if (!(context->weight[rubbed->node] > 0)) continue;
        for (int k = 0; k < 3; k++)
            work += (double)rubbed->force[k] * state->v[lar_state_at(state, rubbed->node, k)];
    }
    state->external += 0.5 * context->mean_step * work / context->scale;
}
