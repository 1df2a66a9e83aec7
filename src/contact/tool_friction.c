#include "contact/tool_friction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "contact/history/tool_grip.h"
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

/* Which of them are free bodies', in the order of lar_grips_list. */
LAR_SETUP static void find_grips(const lar_model *model, const int32_t *local,
                                 lar_tool_faces *faces) {
    int32_t grip = 0;
    if (lar_grips_list(model, NULL) == 0) return;
    for (int m = 0; m < model->move_count; m++) {
        const lar_move *move = &model->move[m];
        if (!move->tool || !model->tool[move->tool - 1].free) continue;
        for (int32_t k = 0; k < move->nodes.count; k++, grip++) {
            const int32_t n = local[move->nodes.node[k]], at = n < 0 ? -1 : faces->rub_at[n];
            if (at < 0) continue;
            faces->rub[at].grip = grip;
            faces->rub[at].body = move->tool - 1;
            faces->grips = true;
        }
    }
}

LAR_SETUP lar_status lar_tool_friction_list(const lar_model *model, const int32_t *local,
                                            const lar_condition_share *share,
                                            const lar_conditions *conditions, lar_tool_faces *faces,
                                            lar_error *error) {
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        if (local[n] >= faces->local_count) faces->local_count = local[n] + 1;
    size_t nodes = (size_t)model->surface.node_count, all = (size_t)faces->local_count;
    int32_t *node = lar_calloc(all, sizeof *node);
    faces->rub = lar_calloc(nodes, sizeof *faces->rub);
    faces->rub_at = lar_calloc(all, sizeof *faces->rub_at);
    lar_status status = LAR_OK;
    if (!node || !faces->rub || !faces->rub_at)
        status = lar_fail_memory(error, nodes * sizeof *faces->rub, "the nodes before tools");
    for (size_t n = 0; n < all && !status; n++) node[n] = faces->rub_at[n] = -1;
    if (!status) find_nodes(model, local, share, node);
    for (int32_t n = 0; n < faces->local_count && !status; n++) {
        if (node[n] < 0) continue;
        lar_tool_rub_node *rub = &faces->rub[faces->rub_at[n] = faces->rub_count++];
        rub->node = node[n];
        rub->grip = -1;
        memcpy(rub->rest, model->mesh.position[node[n]], sizeof rub->rest);
    }
    for (int32_t i = 0; i < conditions->constraint_count && !status; i++) {
        const lar_constraint *constraint = &conditions->constraint[i];
        int32_t at = faces->rub_at[constraint->node];
        if (at >= 0) faces->rub[at].held |= (uint8_t)(LAR_AXIS_X << constraint->axis);
    }
    if (!status) find_grips(model, local, faces);
    free(node);
    return status;
}

static inline int32_t words_of(const lar_tool_contact *contact) {
    return (contact->faces->local_count + 63) / 64;
}

LAR_SETUP lar_status lar_tool_friction_create(lar_tool_contact *contact, lar_error *error) {
    if (!lar_tool_friction_any(contact->list)) return LAR_OK;
    size_t values = 3 * (size_t)contact->faces->local_count;
    size_t nodes = (size_t)contact->faces->rub_count;
    contact->press = lar_calloc(values, sizeof *contact->press);
    contact->pressed = lar_calloc((size_t)words_of(contact), sizeof *contact->pressed);
    contact->rubbed = lar_calloc(nodes, sizeof *contact->rubbed);
    if (contact->press && contact->pressed && contact->rubbed) return LAR_OK;
    return lar_fail_memory(error, values * sizeof *contact->press + nodes * sizeof *contact->rubbed,
                           "friction of tools");
}

void lar_tool_friction_destroy(lar_tool_contact *contact) {
    free(contact->press);
    free(contact->pressed);
    free(contact->rubbed);
    contact->press = NULL;
    contact->pressed = NULL;
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
    const double times = friction * context->scale; /* a power of 2 */
    const size_t axis = (size_t)contact->faces->local_count;
    int64_t *const press = contact->press;
#pragma GCC unroll 4
    for (int a = 0; a < 4; a++) {
        int64_t *at = press + face->node[a];
        lar_tool_friction_mark(contact->pressed, face->node[a]);
#pragma GCC unroll 3
        for (size_t i = 0; i < 3; i++) {
            double units = times * force[i][a];
            if (fabs(units) < 0x1p56) at[i * axis] += llrint(units);
        }
    }
}

/* A tool with friction in the step under way. */
typedef struct rough_tool {
    int32_t tool;
    double radius;
    lar_tool_pose now, next;
    lar_tool_body body;
    bool turns;
    double speed[3];    /* of the tip [m/s] */
    double turn[3][3];  /* from the way from the tip to a point: what its speed is more [1/s] */
    lar_tool_push felt; /* since it was told, as of one share of a step */
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
        r->felt = (lar_tool_push){0};
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

/* For who looks. */
__attribute__((noinline, cold)) static void note_rub(lar_touch_list *touches,
                                                     const lar_tool_rubbed *rubbed,
                                                     const double x[3], const double press[3],
                                                     double scale) {
    lar_touch touch = {.kind = LAR_TOUCH_RUBBED, .face = -1, .node = {rubbed->node}, .weight = {1}};
    double size = lar_length(press);
    for (int i = 0; i < 3; i++) {
        touch.place[i] = x[i];
        touch.normal[i] = press[i] / size;
    }
    lar_touch_note(touches, &touch);
    lar_touch_settle(touches, rubbed->force, scale);
    lar_touch_push(touches, rubbed->node, rubbed->force);
}

/* LAR_AXIS bits of the axes along which supports hold or move the node. */
static inline unsigned held_axes(const lar_tool_contact *contact,
                                 const lar_condition_context *context, int32_t local) {
    const lar_tool_rub_node *node = &contact->faces->rub[contact->faces->rub_at[local]];
    return context->held ? context->held[node->node] & LAR_AXIS_ALL : node->held;
}

/* The place of a node in the history that is held by a free body now; of others -1. */
static inline int32_t grip_of(const lar_tool_contact *contact, int32_t local, unsigned held) {
    return held == LAR_AXIS_ALL ? contact->faces->rub[contact->faces->rub_at[local]].grip : -1;
}

/* Whether the node is one that rubs: that something pushes along axes that nothing holds, but what
 * goes where forces take it. */
static inline bool rubs_at(const lar_tool_contact *contact, const lar_condition_context *context,
                           int32_t local, int32_t *grip) {
    const int32_t at = contact->faces->rub_at[local];
    if (at < 0) return false; /* another thread moves it */
    unsigned held = held_axes(contact, context, local);
    *grip = grip_of(contact, local, held);
    if (*grip >= 0) held = 0;
    for (int i = 0; held && i < 3; i++)
        if (held & (unsigned)LAR_AXIS_X << i) *press_at(contact, local, i) = 0;
    return (*press_at(contact, local, 0) | *press_at(contact, local, 1) |
            *press_at(contact, local, 2)) != 0;
}

/* Lists the nodes that rub, ascending, which are few: of the others not one is looked at. */
static void list_rubbed(lar_tool_contact *contact, const lar_condition_context *context) {
    const int32_t words = words_of(contact);
    contact->rubbed_count = 0;
    for (int32_t w = 0; w < words; w++) {
        for (uint64_t left = contact->pressed[w]; left; left &= left - 1) {
            int32_t grip, local = 64 * w + __builtin_ctzll(left);
            if (!rubs_at(contact, context, local, &grip)) continue;
            lar_tool_rubbed *rubbed = &contact->rubbed[contact->rubbed_count++];
            rubbed->node = local;
            rubbed->grip = grip;
        }
        contact->pressed[w] = 0;
    }
}

static inline void place_of(const lar_tool_contact *contact, const lar_state *state, int32_t local,
                            double x[3]) {
    const lar_tool_rub_node *node = &contact->faces->rub[contact->faces->rub_at[local]];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) x[i] = node->rest[i] + state->u[lar_state_at(state, local, i)];
}

/* Puts a node into lane t, and takes its press sum. Returns the tool that it rubs on. */
static inline rough_tool *take_up(const lar_tool_contact *contact,
                                  const lar_condition_context *context, rough_tool *rough,
                                  int32_t count, int32_t local, const lar_state *state,
                                  lar_tool_rubs *rubs, int32_t t) {
    double x[3], velocity[3];
    place_of(contact, state, local, x);
    rough_tool *tool = nearest(rough, count, x);
    rigid_velocity(tool, x, velocity);
    if (tool->body.count > 1) add_opening(tool, x, context->time_step, velocity);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        const size_t at = lar_state_at(state, local, i);
        rubs->press[i][t] = (double)*press_at(contact, local, i);
        *press_at(contact, local, i) = 0;
        rubs->force[i][t] = (double)state->force[at];
        rubs->v[i][t] = state->v[at];
        rubs->velocity[i][t] = velocity[i];
        rubs->arm[i][t] = x[i] - tool->now.position[i];
    }
    unsigned held = held_axes(contact, context, local);
    if (grip_of(contact, local, held) >= 0) held = 0;
    for (int i = 0; held && i < 3; i++) /* no slip along it, so no friction */
        if (held & (unsigned)LAR_AXIS_X << i)
            rubs->force[i][t] = rubs->v[i][t] = rubs->velocity[i][t] = 0;
    return tool;
}

/* Of the spring that a node hangs on, pressed along its normal with so much [N/m]. */
static double stiffness_of(const lar_tool_contact *contact, const lar_condition_context *context,
                           int32_t tool, int32_t node, const double press[3],
                           const lar_contact_law *law) {
    const int32_t body = contact->faces->rub[contact->faces->rub_at[node]].body;
    const double own = lar_hardness_on_free(context->tools, tool, context) * law->stiffness *
                       context->springs[node];
    const lar_bearing *bearing = lar_bearing_of(lar_tool_bearings(contact), tool, body);
    const double deep = bearing ? contact->list->tool[tool].friction * bearing->deep : 0;
    return deep > 0 ? lar_greater(own, lar_length(press) / deep) : own;
}

/* What the node remembers pulls in lane t in place of what it would need. */
__attribute__((noinline, cold)) static void hang_on(const lar_tool_contact *contact,
                                                    const lar_condition_context *context,
                                                    const lar_state *state, const rough_tool *tool,
                                                    const double tip[3], lar_tool_rubbed *rubbed,
                                                    lar_tool_rubs *rubs, int32_t t) {
    const lar_contact_law law = lar_contact_free_law_for(context->whole_step);
    const double dt = context->time_step;
    lar_grip grip = {.tool = tool->tool};
    double pull[3], force[3][4] = {{0}}, x[4][3] = {{0}};
    lar_tool_pushes pushes;
    for (int i = 0; i < 3; i++) {
        grip.press[i] = rubs->press[i][t] / context->scale;
        grip.slide[i] = rubs->v[i][t] - rubs->velocity[i][t];
        x[0][i] = tip[i] + rubs->arm[i][t];
    }
    grip.stiffness = stiffness_of(contact, context, tool->tool, rubbed->node, grip.press, &law);
    lar_tool_grip_pull(&grip, law.lead * dt / context->whole_step, dt,
                       lar_grip_of(state, rubbed->grip), rubbed->stick, pull);
    for (int i = 0; i < 3; i++) force[i][0] = pull[i];
    lar_tool_push_lanes(context->scale, (const double(*)[4])force, (const double(*)[3])x, tip,
                        &pushes);
    for (int i = 0; i < 3; i++) {
        rubs->friction.force[i][t] = pushes.force[i][0];
        rubs->friction.torque[i][t] = pushes.torque[i][0];
        rubs->friction.rest[i][t] = pushes.rest[i][0];
    }
}

/* The node and its tool get what lane t has found. */
static inline void hand_over(const lar_tool_contact *contact, const lar_condition_context *context,
                             lar_tool_rubbed *rubbed, rough_tool *tool, lar_tool_rubs *rubs,
                             int32_t t, lar_state *state) {
    if (rubbed->grip >= 0)
        hang_on(contact, context, state, tool, tool->now.position, rubbed, rubs, t);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        rubbed->force[i] = (int64_t)rubs->friction.force[i][t];
        state->force[lar_state_at(state, rubbed->node, i)] -= rubbed->force[i];
    }
    if (!(context->weight[rubbed->node] > 0)) return; /* another processor tells the tool */
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        tool->felt.force[i] -= rubbed->force[i];
        tool->felt.torque[i] += (int64_t)rubs->friction.torque[i][t];
        tool->felt.rest[i] += (int64_t)rubs->friction.rest[i][t];
    }
    if (!contact->touches || contact->touches->tool != tool->tool) return;
    double x[3], press[3];
    place_of(contact, state, rubbed->node, x);
    for (int i = 0; i < 3; i++) press[i] = rubs->press[i][t];
    note_rub(contact->touches, rubbed, x, press, context->scale);
}

static void tell_tools(lar_tool_contact *contact, int32_t shares, rough_tool *rough,
                       int32_t count) {
    for (int32_t i = 0; i < count; i++) {
        lar_tool_sum_add(&contact->sum[rough[i].tool], shares, &rough[i].felt);
        rough[i].felt = (lar_tool_push){0};
    }
}

/* So many nodes that rub at a time: 64 bits hold what a tool feels of them, for none has more than
 * 2^56. */
enum { TOGETHER = 64 };

static void rub_nodes(lar_tool_contact *contact, const lar_condition_context *context,
                      const lar_leapfrog *leapfrog, const double *push, rough_tool *rough,
                      int32_t count, lar_tool_rubbed *rubbed, int32_t nodes, lar_state *state) {
    lar_tool_rubs rubs[TOGETHER / LAR_TOOL_LANES];
    rough_tool *tool[TOGETHER];
    const int32_t groups = (nodes + LAR_TOOL_LANES - 1) / LAR_TOOL_LANES;
    memset(&rubs[groups - 1], 0, sizeof *rubs); /* not all of its lanes may be used */
    for (int32_t i = 0; i < nodes; i++) {
        lar_tool_rubs *group = &rubs[i / LAR_TOOL_LANES];
        group->unit[i % LAR_TOOL_LANES] = leapfrog->push * push[rubbed[i].node];
        tool[i] = take_up(contact, context, rough, count, rubbed[i].node, state, group,
                          i % LAR_TOOL_LANES);
    }
    lar_tool_rub_lanes(leapfrog, rubs, groups);
    for (int32_t i = 0; i < nodes; i++)
        hand_over(contact, context, &rubbed[i], tool[i], &rubs[i / LAR_TOOL_LANES],
                  i % LAR_TOOL_LANES, state);
    tell_tools(contact, context->shares, rough, count);
}

void lar_tool_friction_add(lar_tool_contact *contact, const lar_condition_context *context,
                           const lar_leapfrog *leapfrog, const double *push, lar_state *state) {
    list_rubbed(contact, context);
    const int32_t all = contact->rubbed_count;
    if (all == 0) return;
    rough_tool rough[LAR_TOOLS_MAX];
    const int32_t count = place_tools(contact, context, state, rough);
    for (int32_t i = 0; i < all; i += TOGETHER)
        rub_nodes(contact, context, leapfrog, push, rough, count, &contact->rubbed[i],
                  all - i < TOGETHER ? all - i : TOGETHER, state);
}

void lar_tool_friction_keep(const lar_tool_contact *contact, lar_state *state) {
    if (!contact->press || !contact->faces->grips) return;
    for (int32_t i = 0; i < contact->faces->rub_count; i++) {
        const int32_t grip = contact->faces->rub[i].grip;
        if (grip >= 0) memset(lar_grip_of(state, grip), 0, LAR_STICK_VALUES * sizeof(double));
    }
    for (int32_t i = 0; i < contact->rubbed_count; i++) {
        const lar_tool_rubbed *rubbed = &contact->rubbed[i];
        if (rubbed->grip >= 0)
            memcpy(lar_grip_of(state, rubbed->grip), rubbed->stick, sizeof rubbed->stick);
    }
}

void lar_tool_friction_half_work(const lar_tool_contact *contact,
                                 const lar_condition_context *context, lar_state *state) {
    double work = 0;
    for (int32_t i = 0; i < contact->rubbed_count; i++) {
        const lar_tool_rubbed *rubbed = &contact->rubbed[i];
        /* A node that several processors have is accounted for by one. */
        if (!(context->weight[rubbed->node] > 0)) continue;
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++)
            work += (double)rubbed->force[k] * state->v[lar_state_at(state, rubbed->node, k)];
    }
    state->external += 0.5 * context->mean_step * work / context->scale;
}
