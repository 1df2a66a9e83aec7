#include "engine/planes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- set-up -------------------------------------------------------------------------------- */

static void mark_held(const lar_model *model, uint8_t *held) {
    for (int i = 0; i < model->fix_count; i++)
        for (int32_t k = 0; k < model->fix[i].nodes.count; k++)
            held[model->fix[i].nodes.node[k]] |= (uint8_t)model->fix[i].axes;
    for (int i = 0; i < model->move_count; i++)
        for (int32_t k = 0; k < model->move[i].nodes.count; k++)
            held[model->move[i].nodes.node[k]] |= (uint8_t)model->move[i].axes;
}

/* Supports are stronger than planes: a node gives way along its free axes only, and not at all when
 * these lie along the plane. */
static void add_node(lar_planes *planes, const lar_model *model, int plane, int32_t node,
                     int32_t value, unsigned held) {
    const lar_contact *contact = &model->contact[plane];
    lar_plane_node entry = {.value = value, .plane = plane};
    double free = 0;
    for (int i = 0; i < 3; i++) {
        entry.normal[i] = contact->normal[i];
        entry.offset += contact->normal[i] * (model->mesh.position[node][i] - contact->through[i]);
        entry.slide[i] = held >> i & 1 ? 0 : contact->normal[i];
        free += entry.slide[i] * entry.slide[i];
    }
    if (free < 1e-6) return;
    for (int i = 0; i < 3; i++) entry.slide[i] /= free;
    planes->node[planes->count++] = entry;
}

static void add_plane(lar_planes *planes, const lar_model *model, const int32_t *local,
                      const lar_condition_share *share, int plane, uint8_t *held) {
    enum { SEEN = 0x80 };
    const lar_contact *contact = &model->contact[plane];
    for (int32_t f = 0; f < contact->face_count; f++)
        for (int a = 0; a < 4; a++) {
            int32_t face = contact->face[f];
            int32_t node = model->mesh.element[face / 6][lar_face_node[face % 6][a]];
            if (held[node] & SEEN || (share && share->holds[node] != share->thread)) continue;
            add_node(planes, model, plane, node, 4 * local[node], held[node]);
            held[node] |= SEEN;
        }
    for (int32_t n = 0; n < model->mesh.node_count; n++) held[n] &= (uint8_t)~SEEN;
}

static int by_node(const void *a, const void *b) {
    const lar_plane_node *x = a, *y = b;
    if (x->value != y->value) return x->value < y->value ? -1 : 1;
    return (x->plane > y->plane) - (x->plane < y->plane);
}

lar_status lar_planes_create(const lar_model *model, const int32_t *local,
                             const lar_condition_share *share, lar_planes *planes,
                             lar_error *error) {
    *planes = (lar_planes){0};
    size_t most = 0;
    for (int i = 0; i < model->contact_count; i++)
        if (model->contact[i].kind == LAR_CONTACT_PLANE)
            most += 4 * (size_t)model->contact[i].face_count;
    if (most == 0) return LAR_OK;
    uint8_t *held = lar_calloc((size_t)model->mesh.node_count, sizeof *held);
    planes->node = lar_calloc(most, sizeof *planes->node);
    planes->near = lar_calloc(most, sizeof *planes->near);
    planes->before = lar_calloc(most, sizeof *planes->before);
    if (!held || !planes->node || !planes->near || !planes->before) {
        free(held);
        lar_planes_destroy(planes);
        return lar_fail_memory(error, most * sizeof *planes->node, "the nodes before planes");
    }
    mark_held(model, held);
    for (int i = 0; i < model->contact_count; i++)
        if (model->contact[i].kind == LAR_CONTACT_PLANE)
            add_plane(planes, model, local, share, i, held);
    free(held);
    qsort(planes->node, (size_t)planes->count, sizeof *planes->node, by_node);
    return LAR_OK;
}

void lar_planes_destroy(lar_planes *planes) {
    free(planes->node);
    free(planes->near);
    free(planes->before);
    *planes = (lar_planes){0};
}

/* ---- the search ---------------------------------------------------------------------------- */

static double dot(const double a[3], const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double step_travel(const lar_condition_context *context, const lar_state *state) {
    return 1.7320508075688774 * context->time_step * state->fastest;
}

/* Looks so far that at the present speed the next search is some dozens of steps away, and never
 * less far than a falling body gets in ten steps. */
static void search(lar_planes *planes, const lar_condition_context *context, const lar_state *state,
                   lar_contact_info *seen) {
    enum { AHEAD = 64 };
    double dt = context->time_step;
    planes->reach = AHEAD * step_travel(context, state) + 1000 * dt * dt;
    planes->travel = 0;
    planes->near_count = 0;
    for (int32_t i = 0; i < planes->count; i++) {
        const lar_plane_node *n = &planes->node[i];
        /* Not a number counts as near. */
        if (n->offset + dot(n->normal, state->u + n->value) > planes->reach) continue;
        memcpy(planes->before[planes->near_count], state->v + n->value, sizeof *planes->before);
        planes->near[planes->near_count++] = i;
    }
    planes->known = true;
    seen->searches++;
    seen->boxed += (uint64_t)planes->near_count;
}

void lar_planes_observe(lar_planes *planes, const lar_condition_context *context,
                        const lar_state *state, bool always, lar_contact_info *seen) {
    if (planes->count == 0) return;
    double next = planes->travel + 2 * step_travel(context, state);
    if (always || !planes->known || !(next < planes->reach)) {
        search(planes, context, state, seen);
        return;
    }
    for (int32_t i = 0; i < planes->near_count; i++)
        memcpy(planes->before[i], state->v + planes->node[planes->near[i]].value,
               sizeof *planes->before);
}

/* ---- stopping ------------------------------------------------------------------------------ */

/* The least velocity along the normal that a node may move with: what takes it to the plane; one
 * that is in it already goes no deeper than it was before its last step. Then the mean of the
 * velocities before and after points into the plane or is zero, and the plane takes energy or none.
 */
static double least_velocity(const lar_plane_node *n, double height, const double before[3],
                             double dt) {
    double way = fmax(fmax(height, dt * dot(n->normal, before)), 0);
    return -way / dt;
}

static void account(const lar_plane_node *n, const lar_condition_context *context,
                    const double before[3], const double free[3], lar_state *state) {
    const double *now = state->v + n->value;
    double weight = context->weight[n->value / 4], work = 0, damped = 0;
    for (int i = 0; i < 3; i++) {
        work += (now[i] - free[i]) * (before[i] + now[i]);
        damped += (before[i] + now[i]) * (before[i] + now[i]) -
                  (before[i] + free[i]) * (before[i] + free[i]);
    }
    state->contact -=
        0.5 * weight * (1 + 0.5 * context->model->damping * context->time_step) * work;
    state->damped += weight * damped; /* the update kernel has counted the free motion */
}

static void stop_node(const lar_plane_node *n, const lar_condition_context *context,
                      const double before[3], lar_state *state, lar_contact_info *seen) {
    double dt = context->time_step, *u = state->u + n->value, *v = state->v + n->value;
    double height = n->offset + dot(n->normal, u);
    if (height >= 0) return;
    double speed = dot(n->normal, v);
    double least = least_velocity(n, height - dt * speed, before, dt);
    if (speed < least) {
        double free[3] = {v[0], v[1], v[2]};
        for (int i = 0; i < 3; i++) {
            double change = n->slide[i] * (least - speed);
            v[i] += change;
            u[i] += dt * change;
            state->fastest = fmax(state->fastest, fabs(v[i]));
        }
        account(n, context, before, free, state);
        height += dt * (least - speed);
    }
    if (context->weight[n->value / 4] > 0) seen->touching++; /* once, of several processors */
    seen->deepest = fmax(seen->deepest, -height);
}

void lar_planes_stop(lar_planes *planes, const lar_condition_context *context, lar_state *state,
                     bool always, lar_contact_info *seen) {
    if (planes->count == 0) return;
    planes->travel += step_travel(context, state);
    /* Faster within one step than the search allowed for: somebody else may be there now. (What
     * they had before is lost, which costs the energy account a little and the motion nothing.) */
    if (!(planes->travel < planes->reach) && !always) search(planes, context, state, seen);
    double moved = step_travel(context, state);
    for (int32_t i = 0; i < planes->near_count; i++)
        stop_node(&planes->node[planes->near[i]], context, planes->before[i], state, seen);
    planes->travel += step_travel(context, state) - moved;
    seen->possible += (uint64_t)planes->count;
    seen->tested += (uint64_t)planes->near_count;
}

int32_t lar_planes_ahead(const lar_planes *planes, const lar_condition_context *context,
                         const lar_state *state, int32_t entry, double ahead[3]) {
    double dt = context->time_step;
    int32_t value = planes->node[entry].value;
    for (; entry < planes->count && planes->node[entry].value == value; entry++) {
        const lar_plane_node *n = &planes->node[entry];
        double height = n->offset + dot(n->normal, state->u + value);
        double speed = dot(n->normal, ahead);
        double least = least_velocity(n, height, state->v + value, dt);
        for (int i = 0; i < 3 && speed < least; i++) ahead[i] += n->slide[i] * (least - speed);
    }
    return entry;
}
