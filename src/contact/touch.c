#include "contact/touch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "contact/touch_face.h"

/* ---- set-up -------------------------------------------------------------------------------- */

static bool mine(const lar_model *model, const lar_condition_share *share, int32_t face) {
    return !share || share->presses[model->surface.element[face]] == share->thread;
}

static void add_face(const lar_model *model, const int32_t *local, const uint8_t *faces_at,
                     int32_t face, lar_touch *touch) {
    lar_touch_face *f = &touch->face[touch->face_count++];
    *f = (lar_touch_face){.of = face, .acting = -1};
    for (int a = 0; a < 4; a++) {
        int32_t node = model->surface.corner[face][a];
        f->value[a] = 4 * local[node];
        f->share[a] = 1.0 / faces_at[node];
        memcpy(f->rest[a], model->mesh.position[node], sizeof f->rest[a]);
    }
    for (int a = 0; a < 4; a++) {
        double square = 0;
        for (int i = 0; i < 3; i++) {
            double d = f->rest[(a + 1) % 4][i] - f->rest[a][i];
            square += d * d;
        }
        f->edge = fmax(f->edge, sqrt(square));
    }
}

/* Corners of own faces that other threads move. */
static void list_foreign(const lar_model *model, const int32_t *local,
                         const lar_condition_share *share, uint8_t *marked, lar_touch *touch) {
    memset(marked, 0, (size_t)model->mesh.node_count);
    for (int32_t f = 0; f < touch->face_count; f++)
        for (int a = 0; a < 4; a++) {
            int32_t node = model->surface.corner[touch->face[f].of][a];
            if (share->holds[node] == share->thread || marked[node]) continue;
            marked[node] = 1;
            touch->foreign[touch->foreign_count++] = 4 * local[node];
        }
}

static lar_status allocate(const lar_model *model, int32_t faces, int tools, lar_touch *touch,
                           lar_error *error) {
    size_t count = (size_t)faces, nodes = (size_t)model->surface.node_count;
    touch->face = lar_calloc(count, sizeof *touch->face);
    touch->acting = lar_calloc(count, sizeof *touch->acting);
    touch->foreign = lar_calloc(nodes, sizeof *touch->foreign);
    touch->face_of = lar_calloc((size_t)model->surface.face_count, sizeof *touch->face_of);
    touch->weights = lar_calloc(1, sizeof *touch->weights);
    bool fits = touch->face && touch->acting && touch->foreign && touch->face_of && touch->weights;
    for (int t = 0; t < tools && fits; t++) {
        lar_tool_watch *watch = &touch->watch[t];
        watch->near = lar_calloc(count, sizeof *watch->near);
        watch->look = lar_calloc(count, sizeof *watch->look);
        fits = watch->near && watch->look;
    }
    return fits ? LAR_OK
                : lar_fail_memory(error, count * sizeof *touch->face, "the faces before tools");
}

static lar_status create_faces(const lar_model *model, const int32_t *local,
                               const lar_condition_share *share, lar_touch *touch,
                               lar_error *error) {
    const lar_surface *surface = &model->surface;
    int32_t faces = 0;
    for (int32_t f = 0; f < surface->face_count; f++) faces += mine(model, share, f);
    uint8_t *marked = lar_calloc((size_t)model->mesh.node_count, sizeof *marked);
    if (!marked) return lar_fail_memory(error, (size_t)model->mesh.node_count, "the surface");
    lar_status status = allocate(model, faces, touch->list->count, touch, error);
    if (!status) {
        for (int32_t f = 0; f < surface->face_count; f++)
            for (int a = 0; a < 4; a++) marked[surface->corner[f][a]]++;
        for (int32_t f = 0; f < surface->face_count; f++)
            if (mine(model, share, f)) add_face(model, local, marked, f, touch);
        for (int n = 2; n <= LAR_POINTS_ALONG_EDGE; n++)
            for (int i = 0; i < n * n; i++) lar_touch_weights(i, n, touch->weights->of[n][i]);
        status = lar_touch_group_faces(touch, error);
    }
    if (!status) {
        for (int32_t f = 0; f < surface->face_count; f++) touch->face_of[f] = -1;
        for (int32_t f = 0; f < faces; f++) touch->face_of[touch->face[f].of] = f;
        if (share) list_foreign(model, local, share, marked, touch);
    }
    free(marked);
    return status;
}

lar_status lar_touch_create(const lar_model *model, const int32_t *local,
                            const lar_condition_share *share, const lar_tool_list *list,
                            const lar_tools *tools, lar_touch *touch, lar_error *error) {
    *touch = (lar_touch){.list = list, .tools = tools};
    lar_status status = lar_planes_create(model, local, share, &touch->planes, error);
    if (!status && list && list->count > 0)
        status = create_faces(model, local, share, touch, error);
    if (status) lar_touch_destroy(touch);
    return status;
}

void lar_touch_destroy(lar_touch *touch) {
    lar_planes_destroy(&touch->planes);
    for (int t = 0; t < LAR_TOOLS_MOST; t++) {
        free(touch->watch[t].near);
        free(touch->watch[t].look);
    }
    free(touch->face);
    free(touch->group);
    free(touch->acting);
    free(touch->foreign);
    free(touch->face_of);
    free(touch->weights);
    *touch = (lar_touch){0};
}

/* The balls of groups are measured anew when somebody asks. */
static void forget_groups(lar_touch *touch) {
    for (int32_t g = 0; g < touch->group_count; g++) touch->group[g].travel = -INFINITY;
    touch->travel = 0;
}

void lar_touch_forget(lar_touch *touch) {
    touch->planes.known = false;
    touch->moved = UINT64_MAX;
    forget_groups(touch);
    for (int t = 0; t < LAR_TOOLS_MOST; t++) touch->watch[t].known = touch->watch[t].rests = false;
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

/* The pose now, or `ahead` parts of a step later. */
static void pose_now(const lar_tool_motion *motion, const lar_state *state, int32_t ahead,
                     double time_step, lar_tool_pose *pose) {
    int32_t part = state->part + ahead;
    if (part >= state->parts)
        lar_tool_at(motion, state->step + 1, time_step, pose, NULL);
    else
        lar_tool_within(motion, state->step, (double)part / state->parts, time_step, pose, NULL);
}

/* Brings the tool to the step. Returns how far it has come since the last one. */
static double follow(lar_tool_watch *watch, const lar_tool *tool, const lar_tool_motion *motion,
                     const lar_state *state, double time_step) {
    if (watch->rests && state->step >= motion->end) return 0;
    lar_tool_body *body = &watch->body, old = *body;
    lar_tool_pose pose;
    pose_now(motion, state, 0, time_step, &pose);
    lar_tool_place(tool, &pose, body, body->now);
    pose_now(motion, state, 1, time_step, &pose);
    lar_tool_place(tool, &pose, body, body->next);
    watch->rests = state->step >= motion->end;
    return watch->known ? lar_tool_way(old.now, body->now, body->count) : 0;
}

/* ---- forces -------------------------------------------------------------------------------- */

/* Gives the corners their forces in whole units, and the tool exactly the opposite: nothing is lost
 * between them. */
static void give(lar_touch *touch, const lar_condition_context *context, int32_t f, int32_t tool,
                 const double tip[3], const double x[4][3], const double force[4][3]) {
    lar_touch_face *face = &touch->face[f];
    lar_tool_sum *sum = &touch->sum[tool];
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) /* a run that is about to break; the element says why */
            if (!(fabs(force[a][i] * context->scale) < 0x1p56)) return;
    if (face->acting < 0) {
        face->acting = touch->acting_count++;
        touch->acting[face->acting] = (lar_touch_force){.face = f};
    }
    lar_touch_force *acting = &touch->acting[face->acting];
    for (int a = 0; a < 4; a++) {
        double units[3], arm[3];
        for (int i = 0; i < 3; i++) {
            int64_t whole = llrint(force[a][i] * context->scale);
            acting->force[a][i] += whole;
            sum->force[i] -= context->shares * whole;
            units[i] = (double)whole;
            arm[i] = x[a][i] - tip[i];
        }
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double torque = -(arm[j] * units[k] - arm[k] * units[j]), whole = floor(torque);
            if (!(fabs(torque) < 0x1p56)) continue; /* an arm beyond all places */
            sum->torque[i] += context->shares * llrint(whole);
            sum->rest[i] += context->shares * llrint((torque - whole) / LAR_TORQUE_REST);
        }
    }
}

/* Nothing of a run that is about to break. */
static int64_t whole_units(double units) {
    return fabs(units) < 0x1p56 ? llrint(units) : 0;
}

static void touch_near(lar_touch *touch, const lar_condition_context *context,
                       const lar_state *state, int32_t tool, const lar_contact_law *law) {
    lar_tool_watch *watch = &touch->watch[tool];
    for (int32_t i = 0; i < watch->near_count; i++) {
        if (watch->path < watch->look[i] && !touch->always) continue;
        lar_touched_face patch = {.face = &touch->face[watch->near[i]],
                                  .body = &watch->body,
                                  .radius = touch->list->tool[tool].radius,
                                  .rate_of = 1 / context->time_step,
                                  .closest = INFINITY};
        double center[3];
        lar_touch_corners(patch.face, state->u, patch.x);
        double size = lar_touch_ball((const double(*)[3])patch.x, center);
        double gap = lar_touch_distance(&watch->body, patch.radius, center) - size;
        touch->seen.tested++;
        watch->look[i] = watch->path + lar_touch_clear(gap, patch.radius);
        if (gap > 0) continue;
        lar_touch_push_face(&patch, law, state->v, context->mass, touch->weights);
        watch->look[i] = watch->path + lar_touch_clear(patch.closest, patch.radius);
        if (patch.touching == 0) continue;
        lar_tool_sum *sum = &touch->sum[tool];
        sum->touching += patch.touching;
        sum->depth = fmax(sum->depth, patch.depth);
        sum->squeeze += context->shares * whole_units(patch.squeeze * context->scale);
        for (int s = 0; s < 2; s++)
            sum->jaw[s] += context->shares * whole_units(patch.jaw[s] * context->scale);
        give(touch, context, watch->near[i], tool, watch->body.now[0].end[0],
             (const double(*)[3])patch.x, (const double(*)[3])patch.force);
    }
}

/* ---- holds --------------------------------------------------------------------------------- */

/* Where the anchors of a tool's holds go in a step. */
typedef struct lar_hold_motion {
    lar_tool_pose now, next;
    bool known;
} lar_hold_motion;

static void place_anchor(const lar_tool_pose *pose, const double anchor[3], double out[3]) {
    lar_turn(pose->orientation, anchor, out);
    for (int i = 0; i < 3; i++) out[i] += pose->position[i];
}

/* The spring between a point of a face and its anchor; no stronger than at the length of the tool's
 * radius, so that what is torn away from a tool slips instead of being torn apart. */
static void hold_point(lar_touch *touch, const lar_condition_context *context,
                       const lar_state *state, const lar_hold *hold, const lar_hold_motion *motion,
                       const lar_contact_law *law) {
    const lar_touch_face *face = &touch->face[touch->face_of[hold->face]];
    const lar_tool *tool = &touch->list->tool[hold->tool];
    double dt = context->time_step, now[3], next[3], x[4][3], v[4][3], point[3], speed[3];
    double pull[3], force[4][3], length = 0;
    place_anchor(&motion->now, hold->anchor, now);
    place_anchor(&motion->next, hold->anchor, next);
    lar_touch_corners(face, state->u, x);
    for (int a = 0; a < 4; a++) memcpy(v[a], state->v + face->value[a], sizeof v[a]);
    lar_face_mean((const double(*)[3])x, hold->weight, point);
    lar_face_mean((const double(*)[3])v, hold->weight, speed);
    double most = lar_hold_most(face, tool->radius, law, context->mass);
    double stiffness = fmin(hold->stiffness, most), damping = sqrt(stiffness * most) * dt;
    for (int i = 0; i < 3; i++) {
        pull[i] = stiffness * (now[i] - point[i]) + damping * ((next[i] - now[i]) / dt - speed[i]);
        length += pull[i] * pull[i];
    }
    length = sqrt(length);
    double share = length > stiffness * tool->radius ? stiffness * tool->radius / length : 1;
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) force[a][i] = hold->weight[a] * share * pull[i];
    give(touch, context, touch->face_of[hold->face], hold->tool, motion->now.position,
         (const double(*)[3])x, (const double(*)[3])force);
    touch->sum[hold->tool].held++;
}

static void apply_holds(lar_touch *touch, const lar_condition_context *context,
                        const lar_state *state, const lar_contact_law *law) {
    lar_hold_motion motion[LAR_TOOLS_MOST];
    for (int t = 0; t < LAR_TOOLS_MOST; t++) motion[t].known = false;
    for (int32_t i = 0; i < touch->tools->hold_count; i++) {
        const lar_hold *hold = &touch->tools->hold[i];
        if (touch->face_of[hold->face] < 0) continue;
        lar_hold_motion *of = &motion[hold->tool];
        const lar_tool_motion *tool = &touch->tools->motion[hold->tool];
        if (!of->known) {
            pose_now(tool, state, 0, context->whole_step, &of->now);
            pose_now(tool, state, 1, context->whole_step, &of->next);
            of->known = true;
        }
        hold_point(touch, context, state, hold, of, law);
    }
}

/* ---- the step ------------------------------------------------------------------------------ */

/* How far any corner can have gone since the last step; infinitely far when that is not known. */
static double step_travel(const lar_touch *touch, const lar_condition_context *context,
                          const lar_state *state) {
    if (touch->moved != state->round) return INFINITY;
    double fastest = state->fastest;
    for (int32_t i = 0; i < touch->foreign_count; i++)
        for (int k = 0; k < 3; k++) fastest = fmax(fastest, fabs(state->v[touch->foreign[i] + k]));
    return 1.7320508075688774 * context->whole_step * fastest;
}

static void apply_tool(lar_touch *touch, const lar_condition_context *context,
                       const lar_state *state, int32_t t, double travel,
                       const lar_contact_law *law) {
    const lar_tool *tool = &touch->list->tool[t];
    lar_tool_watch *watch = &touch->watch[t];
    int32_t serial = lar_spare_serial(touch->list, touch->tools, t);
    if (watch->serial != serial) watch->known = watch->rests = false;
    watch->serial = serial;
    double came = follow(watch, tool, &touch->tools->motion[t], state, context->whole_step);
    watch->path += travel + came;
    if (touch->always || !watch->known || !(watch->path < watch->limit))
        lar_touch_search(touch, t, state,
                         travel +
                             lar_tool_way(watch->body.now, watch->body.next, watch->body.count));
    touch_near(touch, context, state, t, law);
    touch->seen.possible += (uint64_t)touch->face_count;
}

static void clear_acting(lar_touch *touch) {
    for (int32_t i = 0; i < touch->acting_count; i++)
        touch->face[touch->acting[i].face].acting = -1;
    touch->acting_count = 0;
    touch->seen.touching = 0;
    touch->seen.deepest = 0;
}

static void add_forces(const lar_touch *touch, int64_t *force) {
    for (int32_t i = 0; i < touch->acting_count; i++) {
        const lar_touch_force *acting = &touch->acting[i];
        for (int a = 0; a < 4; a++)
            for (int k = 0; k < 3; k++)
                force[touch->face[acting->face].value[a] + k] -= acting->force[a][k];
    }
}

void lar_touch_apply(lar_touch *touch, const lar_condition_context *context, lar_state *state) {
    clear_acting(touch);
    if (touch->face_count == 0) return;
    lar_contact_law law = lar_contact_law_for(context->whole_step, context->stable_step);
    lar_contact_law tool_law = lar_contact_tool_law_for(context->whole_step, context->stable_step);
    tool_law.stiffness *= context->hardness;
    tool_law.lead *= context->time_step / context->whole_step;
    double travel = step_travel(touch, context, state);
    bool known = isfinite(travel);
    if (!known) lar_touch_forget(touch);
    if (known) touch->travel += travel;
    if (touch->travel > 1) forget_groups(touch); /* short sums keep the smallest steps */
    for (int32_t t = 0; t < touch->list->count; t++) {
        touch->sum[t].touching = touch->sum[t].held = 0;
        if (lar_tool_touches(&touch->list->tool[t]))
            apply_tool(touch, context, state, t, known ? travel : 0, &tool_law);
    }
    apply_holds(touch, context, state, &law);
    add_forces(touch, state->force);
}

void lar_touch_half_work(const lar_touch *touch, const lar_condition_context *context,
                         lar_state *state) {
    double work = 0;
    for (int32_t i = 0; i < touch->acting_count; i++) {
        const lar_touch_force *acting = &touch->acting[i];
        for (int a = 0; a < 4; a++)
            for (int k = 0; k < 3; k++)
                work +=
                    (double)acting->force[a][k] * state->v[touch->face[acting->face].value[a] + k];
    }
    state->external += 0.5 * context->mean_step * work / context->scale;
}

void lar_touch_observe(lar_touch *touch, const lar_condition_context *context,
                       const lar_state *state) {
    lar_planes_observe(&touch->planes, context, state, touch->always, &touch->seen);
}

void lar_touch_stop(lar_touch *touch, const lar_condition_context *context, lar_state *state) {
    lar_planes_stop(&touch->planes, context, state, touch->always, &touch->seen);
    touch->moved = state->round + 1;
    bool tools = touch->face_count > 0 && lar_spares_any(touch->list, touch->tools);
    if (touch->planes.count > 0 || tools) touch->seen.steps++;
}

void lar_touch_remember(const lar_touch *touch, lar_touch_note *note) {
    memcpy(note->sum, touch->sum, sizeof note->sum);
    note->seen = touch->seen;
}

void lar_touch_restore(lar_touch *touch, const lar_touch_note *note) {
    memcpy(touch->sum, note->sum, sizeof note->sum);
    touch->seen = note->seen;
}
