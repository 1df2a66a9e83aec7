#include "contact/tool_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "contact/tool_contact_face.h"
#include "contact/tool_friction.h"
#include "contact/touch_list.h"

/* ---- set-up -------------------------------------------------------------------------------- */

static lar_status allocate(lar_tool_contact *contact, lar_error *error) {
    size_t count = (size_t)contact->faces->face_count, groups = (size_t)contact->faces->group_count;
    contact->loaded = lar_calloc(count, sizeof *contact->loaded);
    contact->loaded_at = lar_calloc(count, sizeof *contact->loaded_at);
    contact->ball = lar_calloc(groups, sizeof *contact->ball);
    bool fits = contact->loaded && contact->loaded_at && contact->ball;
    for (int32_t t = 0; contact->list && t < contact->list->count && fits; t++) {
        lar_tool_vicinity *vicinity = &contact->vicinity[t];
        vicinity->near = lar_calloc(count, sizeof *vicinity->near);
        vicinity->look = lar_calloc(count, sizeof *vicinity->look);
        fits = vicinity->near && vicinity->look;
    }
    return fits ? LAR_OK
                : lar_fail_memory(error, count * sizeof *contact->loaded, "the faces before tools");
}

LAR_SETUP lar_status lar_tool_contact_create(const lar_tool_faces *faces, const lar_planes *planes,
                                             const lar_tool_list *list, const lar_tools *tools,
                                             bool always, lar_tool_contact *contact,
                                             lar_error *error) {
    *contact = (lar_tool_contact){.list = list, .tools = tools, .faces = faces, .always = always};
    lar_status status = lar_plane_contact_create(planes, &contact->plane_contact, error);
    if (!status && faces->face_count > 0) status = allocate(contact, error);
    if (!status) status = lar_tool_friction_create(contact, error);
    if (status) {
        lar_tool_contact_destroy(contact);
        return status;
    }
    for (int32_t f = 0; f < faces->face_count; f++) contact->loaded_at[f] = -1;
    lar_tool_contact_forget(contact);
    return LAR_OK;
}

void lar_tool_contact_destroy(lar_tool_contact *contact) {
    lar_plane_contact_destroy(&contact->plane_contact);
    lar_tool_friction_destroy(contact);
    for (int t = 0; t < LAR_TOOLS_MAX; t++) {
        free(contact->vicinity[t].near);
        free(contact->vicinity[t].look);
    }
    free(contact->ball);
    free(contact->loaded);
    free(contact->loaded_at);
    *contact = (lar_tool_contact){0};
}

/* The balls of groups are measured anew when somebody asks. */
static void forget_groups(lar_tool_contact *contact) {
    for (int32_t g = 0; g < contact->faces->group_count; g++) contact->ball[g].travel = -INFINITY;
    contact->travel = 0;
}

void lar_tool_contact_forget(lar_tool_contact *contact) {
    contact->plane_contact.known = false;
    contact->moved = UINT64_MAX;
    forget_groups(contact);
    for (int t = 0; t < LAR_TOOLS_MAX; t++)
        contact->vicinity[t].known = contact->vicinity[t].rests = false;
}

/* ---- where tools are ----------------------------------------------------------------------- */

/* Jaws hang on the tip and open in the plane y = 0. */
void lar_tool_place(const lar_tool *tool, const lar_tool_pose *pose, lar_tool_body *body,
                    lar_segment segment[2]) {
    double end[2][3] = {{0, 0, tool->shape == LAR_TOOL_CAPSULE ? tool->length : 0}};
    body->count = 1;
    if (tool->shape == LAR_TOOL_GRASPER) {
        double sine, cosine;
        lar_sine_cosine(0.5 * tool->spread * pose->opening, &sine, &cosine);
        for (int s = 0; s < 2; s++) {
            end[s][0] = (s ? -1 : 1) * tool->length * sine;
            end[s][2] = -tool->length * cosine;
        }
        body->count = 2;
    }
    for (int32_t s = 0; s < body->count; s++) {
        lar_turn(pose->orientation, end[s], segment[s].end[1]);
        for (int i = 0; i < 3; i++) {
            segment[s].end[0][i] = pose->position[i];
            segment[s].end[1][i] += pose->position[i];
        }
    }
    if (tool->shape != LAR_TOOL_GRASPER) return;
    static const double hinge[3] = {0, 1, 0};
    double axis[3], jaw[3];
    lar_turn(pose->orientation, hinge, axis);
    for (int s = 0; s < 2; s++) {
        for (int i = 0; i < 3; i++)
            jaw[i] = (s ? 1 : -1) * (segment[s].end[1][i] - segment[s].end[0][i]) / tool->length;
        lar_cross(axis, jaw, body->outward[s]);
    }
}

double lar_tool_way(const lar_segment *from, const lar_segment *to, int32_t count) {
    double farthest = 0;
    for (int32_t s = 0; s < count; s++)
        for (int e = 0; e < 2; e++) {
            double square = 0;
            for (int i = 0; i < 3; i++) {
                double way = to[s].end[e][i] - from[s].end[e][i];
                square += way * way;
            }
            farthest = fmax(farthest, square);
        }
    return sqrt(farthest);
}

/* Brings the tool to the step. Returns how far it has come since the last one. */
static double follow(lar_tool_vicinity *vicinity, const lar_tool *tool,
                     const lar_tool_motion *motion, const lar_state *state, double time_step) {
    if (vicinity->rests && state->step >= motion->end) return 0;
    lar_tool_body *body = &vicinity->body, old = *body;
    lar_tool_pose pose;
    lar_tool_pose_now(motion, state, 0, time_step, &pose);
    lar_tool_place(tool, &pose, body, body->now);
    lar_tool_pose_now(motion, state, 1, time_step, &pose);
    lar_tool_place(tool, &pose, body, body->next);
    vicinity->rests = state->step >= motion->end;
    return vicinity->known ? lar_tool_way(old.now, body->now, body->count) : 0;
}

/* ---- forces -------------------------------------------------------------------------------- */

/* Somebody looks at this tool; NULL: nobody does. */
static lar_touch_list *touches_of(const lar_tool_contact *contact, int32_t tool) {
    return contact->touches && contact->touches->tool == tool ? contact->touches : NULL;
}

/* Gives the corners their forces in whole units, and the tool exactly the opposite: nothing is lost
 * between them. */
static void give(lar_tool_contact *contact, const lar_condition_context *context, int32_t f,
                 int32_t tool, const double tip[3], const double x[4][3],
                 const double force[3][4]) {
    int32_t *at = &contact->loaded_at[f];
    lar_touch_list *touches = touches_of(contact, tool);
    lar_tool_push push = {0};
    lar_tool_pushes pushes;
    /* A run that is about to break: the element says why. */
    if (!lar_tool_push_lanes(context->scale, force, x, tip, &pushes)) {
        if (touches) touches->pending = 0;
        return;
    }
    if (*at < 0) {
        *at = contact->loaded_count++;
        contact->loaded[*at] = (lar_tool_contact_force){.face = f};
    }
    lar_tool_contact_force *loaded = &contact->loaded[*at];
#pragma GCC unroll 4
    for (int a = 0; a < 4; a++)
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++) {
            int64_t whole = (int64_t)pushes.force[i][a];
            loaded->force[a][i] += whole;
            push.force[i] -= whole;
            push.torque[i] += (int64_t)pushes.torque[i][a];
            push.rest[i] += (int64_t)pushes.rest[i][a];
        }
    lar_tool_sum_add(&contact->sum[tool], context->shares, &push);
    if (!touches) return;
    const int64_t total[3] = {-push.force[0], -push.force[1], -push.force[2]};
    lar_touch_settle(touches, total, context->scale);
    for (int a = 0; a < 4; a++) {
        const int64_t whole[3] = {(int64_t)pushes.force[0][a], (int64_t)pushes.force[1][a],
                                  (int64_t)pushes.force[2][a]};
        lar_touch_push(touches, contact->faces->face[f].node[a], whole);
    }
}

/* Nothing of a run that is about to break. */
static int64_t whole_units(double units) {
    return fabs(units) < 0x1p56 ? llrint(units) : 0;
}

/* Of a tool that is as hard as it is, on tissue and on free bodies. */
typedef struct tool_laws {
    lar_contact_law tissue, free;
} tool_laws;

/* The i-th near face before a tool; the rest of the patch is filled in when it is pushed. False: it
 * is too far away for that. */
static bool come_near(lar_tool_contact *contact, const lar_condition_context *context,
                      const lar_state *state, int32_t tool, int32_t i,
                      lar_tool_contact_patch *patch) {
    lar_tool_vicinity *vicinity = &contact->vicinity[tool];
    if (vicinity->path < vicinity->look[i] && !contact->always) return false;
    patch->face = &contact->faces->face[vicinity->near[i]];
    patch->body = &vicinity->body;
    patch->radius = contact->list->tool[tool].radius;
    patch->hard = 1;
    patch->outside = contact->tools->motion[tool].outside;
    patch->rate_of = 1 / context->time_step;
    patch->touches = NULL;
    double center[3];
    lar_tool_contact_corners(patch->face, state, patch->x);
    double size = lar_tool_contact_ball_of((const double(*)[3])patch->x, center);
    double gap = lar_tool_contact_distance(&vicinity->body, patch->radius, center) - size;
    contact->seen.tested++;
    vicinity->look[i] = vicinity->path + lar_tool_contact_clear(gap, patch->radius);
    if (gap > 0) return false;
    for (int a = 0; a < 4; a++) lar_state_velocity(state, patch->face->node[a], patch->v[a]);
    return true;
}

/* What a free body bears of a tool, in parts of springs that move all of it at once in a step,
 * beside those that are fitted to its nodes: all tools two fifths of these. And no more than is
 * good for the tool. */
static double bears_of(const lar_tool_contact *contact, int32_t tool, int32_t body,
                       const lar_contact_law *law) {
    static const double ALL = 0.4;
    const lar_tool_list *list = contact->list;
    int32_t count = 0;
    for (int32_t t = 0; t < list->count; t++) count += lar_tool_touches(&list->tool[t]);
    return lar_lesser(ALL / count,
                      list->limits[tool].firm / (law->stiffness * contact->faces->heavy[body]));
}

static lar_bearing *bearing_for(lar_bearings *all, int32_t tool, int32_t body) {
    int32_t i = all->count;
    while (i > 0 && all->of[i - 1].tool == tool)
        if (all->of[--i].body == body) return &all->of[i];
    all->of[all->count] = (lar_bearing){.tool = tool, .body = body};
    return &all->of[all->count++];
}

/* Whoever sees all faces of free bodies sums up what the tool asks of them. */
static void weigh_near(lar_tool_contact *contact, const lar_condition_context *context,
                       const lar_state *state, int32_t tool, const lar_contact_law *law) {
    const lar_tool_vicinity *vicinity = &contact->vicinity[tool];
    const int32_t first = contact->bearings.count;
    for (int32_t i = 0; i < vicinity->near_count; i++) {
        const int32_t body = contact->faces->face[vicinity->near[i]].body;
        lar_tool_contact_patch patch;
        if (body < 0 || !come_near(contact, context, state, tool, i, &patch)) continue;
        lar_tool_contact_push_face(&patch, law, context->springs, contact->faces->weights);
        lar_bearing *bearing = bearing_for(&contact->bearings, tool, body);
        bearing->asked += lar_tool_contact_asked(&patch);
        bearing->deep = lar_greater(bearing->deep, patch.ahead);
    }
    for (int32_t i = first; i < contact->bearings.count; i++)
        contact->bearings.of[i].asked /= bears_of(contact, tool, contact->bearings.of[i].body, law);
}

static void harden(const lar_tool_contact *contact, const lar_condition_context *context,
                   int32_t tool, const lar_contact_law *law, lar_tool_contact_patch *patch) {
    const lar_bearing *bearing =
        lar_bearing_of(lar_tool_bearings(contact), tool, patch->face->body);
    lar_tool_contact_push_face(patch, law, context->springs, contact->faces->weights);
    if (bearing) patch->hard = lar_tool_contact_hardness(patch, bearing->asked);
}

static void touch_near(lar_tool_contact *contact, const lar_condition_context *context,
                       const lar_state *state, int32_t tool, const tool_laws *laws) {
    lar_tool_vicinity *vicinity = &contact->vicinity[tool];
    for (int32_t i = 0; i < vicinity->near_count; i++) {
        lar_tool_contact_patch patch;
        if (!come_near(contact, context, state, tool, i, &patch)) continue;
        const bool free = patch.face->body >= 0;
        if (free) harden(contact, context, tool, &laws->free, &patch);
        patch.touches = touches_of(contact, tool);
        lar_tool_contact_push_face(&patch, free ? &laws->free : &laws->tissue, context->springs,
                                   contact->faces->weights);
        vicinity->look[i] = vicinity->path + lar_tool_contact_clear(patch.closest, patch.radius);
        lar_tool_sum *sum = &contact->sum[tool];
        sum->behind |= patch.behind;
        if (patch.touching == 0) continue;
        sum->touching += patch.touching;
        if (patch.depth > sum->depth) sum->depth = patch.depth;
        sum->squeeze += context->shares * whole_units(patch.squeeze * context->scale);
        for (int s = 0; s < 2; s++)
            sum->jaw[s] += context->shares * whole_units(patch.jaw[s] * context->scale);
        give(contact, context, vicinity->near[i], tool, vicinity->body.now[0].end[0],
             (const double(*)[3])patch.x, (const double(*)[4])patch.force);
        if (contact->list->tool[tool].friction > 0)
            lar_tool_friction_press(contact, context, contact->list->tool[tool].friction,
                                    patch.face, (const double(*)[4])patch.force);
    }
}

/* ---- grasps -------------------------------------------------------------------------------- */

/* Where the anchors of a tool's grasps go in a step. */
typedef struct lar_grasp_motion {
    lar_tool_pose now, next;
    bool known;
} lar_grasp_motion;

static void place_anchor(const lar_tool_pose *pose, const double anchor[3], double out[3]) {
    lar_turn(pose->orientation, anchor, out);
    for (int i = 0; i < 3; i++) out[i] += pose->position[i];
}

/* The spring between a point of a face and its anchor. */
static void grasp_point(lar_tool_contact *contact, const lar_condition_context *context,
                        const lar_state *state, const lar_grasp *grasp,
                        const lar_grasp_motion *motion, const lar_contact_law *law) {
    const lar_tool_contact_face *face = &contact->faces->face[contact->faces->face_of[grasp->face]];
    const lar_tool *tool = &contact->list->tool[grasp->tool];
    double dt = context->time_step, now[3], next[3], x[4][3], v[4][3], point[3], speed[3];
    double pull[3], force[3][4], length = 0, slack = 0;
    place_anchor(&motion->now, grasp->anchor, now);
    place_anchor(&motion->next, grasp->anchor, next);
    lar_tool_contact_corners(face, state, x);
    for (int a = 0; a < 4; a++) lar_state_velocity(state, face->node[a], v[a]);
    lar_face_mean((const double(*)[3])x, grasp->weight, point);
    lar_face_mean((const double(*)[3])v, grasp->weight, speed);
    double max = lar_grasp_stiffness_limit(face, tool->radius, law, context->springs);
    double stiffness = fmin(grasp->stiffness, max), damping = sqrt(stiffness * max) * dt;
    for (int i = 0; i < 3; i++) {
        pull[i] = stiffness * (now[i] - point[i]) + damping * ((next[i] - now[i]) / dt - speed[i]);
        length += pull[i] * pull[i];
        slack += (now[i] - point[i]) * (now[i] - point[i]);
    }
    length = sqrt(length);
    double most = stiffness * tool->radius * lar_division_reach(&contact->tools->division);
    double share = length > most ? most / length : 1;
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) force[i][a] = grasp->weight[a] * share * pull[i];
    if (touches_of(contact, grasp->tool)) {
        lar_touch touch = {.kind = LAR_TOUCH_HELD, .face = grasp->face};
        for (int i = 0; i < 3; i++) {
            touch.place[i] = point[i];
            touch.force[i] = -share * pull[i];
        }
        memcpy(touch.weight, grasp->weight, sizeof touch.weight);
        lar_touch_note(contact->touches, &touch);
    }
    give(contact, context, contact->faces->face_of[grasp->face], grasp->tool, motion->now.position,
         (const double(*)[3])x, (const double(*)[4])force);
    double jaws = tool->length + 2 * tool->radius; /* farther away it has slipped out of them */
    contact->sum[grasp->tool].held++;
    if (tool->shape == LAR_TOOL_HAND || slack <= jaws * jaws) contact->sum[grasp->tool].clings = 1;
}

static void apply_grasps(lar_tool_contact *contact, const lar_condition_context *context,
                         const lar_state *state, const lar_contact_law *law) {
    lar_grasp_motion motion[LAR_TOOLS_MAX];
    for (int t = 0; t < contact->tools->count; t++) motion[t].known = false;
    for (int32_t i = 0; i < contact->tools->grasp_count; i++) {
        const lar_grasp *grasp = &contact->tools->grasps[i];
        if (contact->faces->face_of[grasp->face] < 0) continue;
        lar_grasp_motion *of = &motion[grasp->tool];
        const lar_tool_motion *tool = &contact->tools->motion[grasp->tool];
        if (!of->known) {
            lar_tool_pose_now(tool, state, 0, context->whole_step, &of->now);
            lar_tool_pose_now(tool, state, 1, context->whole_step, &of->next);
            of->known = true;
        }
        grasp_point(contact, context, state, grasp, of, law);
    }
}

/* ---- the step ------------------------------------------------------------------------------ */

/* How far any corner can have gone since the last step; infinitely far when that is not known. */
static double step_travel(const lar_tool_contact *contact, const lar_condition_context *context,
                          const lar_state *state) {
    if (contact->moved != state->round) return INFINITY;
    double fastest = state->fastest;
    for (int32_t i = 0; i < contact->faces->foreign_count; i++)
        for (int k = 0; k < 3; k++)
            fastest =
                fmax(fastest, fabs(state->v[lar_state_at(state, contact->faces->foreign[i], k)]));
    return 1.7320508075688774 * context->whole_step * fastest;
}

static void apply_tool(lar_tool_contact *contact, const lar_condition_context *context,
                       const lar_state *state, int32_t t, double travel, tool_laws laws) {
    const lar_tool *tool = &contact->list->tool[t];
    lar_tool_vicinity *vicinity = &contact->vicinity[t];
    int32_t serial = lar_spare_serial(contact->list, contact->tools, t);
    if (vicinity->serial != serial) vicinity->known = vicinity->rests = false;
    vicinity->serial = serial;
    double came = follow(vicinity, tool, &contact->tools->motion[t], state, context->whole_step);
    vicinity->path += travel + came;
    if (contact->always || !vicinity->known || !(vicinity->path < vicinity->limit))
        lar_tool_contact_search(
            contact, t, state,
            travel + lar_tool_way(vicinity->body.now, vicinity->body.next, vicinity->body.count));
    laws.tissue.stiffness *= contact->tools->hardness[t];
    laws.free.stiffness *= lar_hardness_on_free(contact->tools, t, context);
    if (contact->faces->weighs) weigh_near(contact, context, state, t, &laws.free);
    touch_near(contact, context, state, t, &laws);
    contact->seen.possible += (uint64_t)contact->faces->face_count;
}

static void clear_loaded(lar_tool_contact *contact) {
    for (int32_t i = 0; i < contact->loaded_count; i++)
        contact->loaded_at[contact->loaded[i].face] = -1;
    contact->loaded_count = contact->rubbed_count = contact->bearings.count = 0;
    contact->seen.touching = 0;
    contact->seen.deepest_ever = fmax(contact->seen.deepest_ever, contact->seen.deepest);
    contact->seen.deepest = 0;
}

static void add_forces(const lar_tool_contact *contact, lar_state *state) {
    for (int32_t i = 0; i < contact->loaded_count; i++) {
        const lar_tool_contact_force *loaded = &contact->loaded[i];
        for (int a = 0; a < 4; a++)
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++)
                state->force[lar_state_at(state, contact->faces->face[loaded->face].node[a], k)] -=
                    loaded->force[a][k];
    }
}

void lar_tool_contact_apply(lar_tool_contact *contact, const lar_condition_context *context,
                            lar_state *state) {
    clear_loaded(contact);
    if (contact->faces->face_count == 0) return;
    lar_contact_law law = lar_contact_law_for(context->whole_step, context->stable_step);
    tool_laws laws = {lar_contact_tool_law_for(context->whole_step, context->stable_step),
                      lar_contact_free_law_for(context->whole_step)};
    laws.tissue.lead *= context->time_step / context->whole_step;
    laws.free.lead *= context->time_step / context->whole_step;
    double travel = step_travel(contact, context, state);
    bool known = isfinite(travel);
    if (!known) lar_tool_contact_forget(contact);
    if (known) contact->travel += travel;
    if (contact->travel > 1) forget_groups(contact); /* short sums keep the smallest steps */
    for (int32_t t = 0; t < contact->list->count; t++) {
        contact->sum[t].touching = contact->sum[t].held = 0;
        if (lar_tool_touches(&contact->list->tool[t]))
            apply_tool(contact, context, state, t, known ? travel : 0, laws);
    }
    apply_grasps(contact, context, state, &law);
    add_forces(contact, state);
}

void lar_tool_contact_half_work(const lar_tool_contact *contact,
                                const lar_condition_context *context, lar_state *state) {
    double work = 0;
    for (int32_t i = 0; i < contact->loaded_count; i++) {
        const lar_tool_contact_force *loaded = &contact->loaded[i];
        for (int a = 0; a < 4; a++)
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++)
                work +=
                    (double)loaded->force[a][k] *
                    state->v[lar_state_at(state, contact->faces->face[loaded->face].node[a], k)];
    }
    state->external += 0.5 * context->mean_step * work / context->scale;
    if (contact->rubbed_count > 0) lar_tool_friction_half_work(contact, context, state);
}

/* What a force along an axis turns about the tip, in whole units and what it is more. */
static void add_turn(int axis, double turn, lar_tool_push *push) {
    const int64_t whole = whole_units(turn);
    push->torque[axis] += whole;
    push->rest[axis] += whole_units((turn - (double)whole) / LAR_TORQUE_REST);
}

void lar_tool_contact_carry(lar_tool_contact *contact, const lar_condition_context *context,
                            const lar_condition_notes *notes, const lar_state *state) {
    lar_tool_pose pose;
    int32_t tool = -1;
    for (int32_t i = notes->fixed_count; i < notes->constraint_count; i++) {
        const lar_constraint *c = &notes->constraint[i];
        const int32_t next = (c->axis + 1) % 3, last = (c->axis + 2) % 3;
        const int64_t pull = state->force[lar_constraint_at(state, c)];
        if (c->curve != LAR_CURVE_TOOL || pull == 0 || !(context->weight[c->node] > 0)) continue;
        if (tool != c->rigid)
            lar_tool_pose_now(&contact->tools->motion[c->rigid], state, 0, context->whole_step,
                              &pose);
        tool = c->rigid;
        const double *at = context->model->mesh.position[c->point];
        lar_tool_push push = {0};
        double u[3];
        lar_state_displacement(state, c->node, u);
        push.force[c->axis] = -pull;
        const double force = (double)push.force[c->axis];
        add_turn(next, (at[last] + u[last] - pose.position[last]) * force, &push);
        add_turn(last, -(at[next] + u[next] - pose.position[next]) * force, &push);
        lar_tool_sum_add(&contact->sum[tool], context->shares, &push);
    }
}

void lar_tool_contact_observe(lar_tool_contact *contact, const lar_condition_context *context,
                              const lar_state *state) {
    lar_plane_contact_observe(&contact->plane_contact, context, state, contact->always,
                              &contact->seen);
}

void lar_tool_contact_stop(lar_tool_contact *contact, const lar_condition_context *context,
                           lar_state *state) {
    lar_plane_contact_stop(&contact->plane_contact, context, state, contact->always,
                           &contact->seen);
    contact->moved = state->round + 1;
    bool tools = contact->faces->face_count > 0 && lar_spares_any(contact->list, contact->tools);
    if (contact->plane_contact.planes->count > 0 || tools) contact->seen.steps++;
}
