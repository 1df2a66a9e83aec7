#include "contact/plane_contact.h"

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
static void add_node(lar_planes *planes, const lar_contact *plane, const double position[3],
                     int32_t value, unsigned held) {
    lar_plane_way way;
    lar_plane_node node = {.value = value};
    double free = 0;
    for (int i = 0; i < 3; i++) {
        way.normal[i] = plane->normal[i];
        node.offset += plane->normal[i] * (position[i] - plane->through[i]);
        way.slide[i] = held >> i & 1 ? 0 : plane->normal[i];
        free += way.slide[i] * way.slide[i];
    }
    if (free < 1e-6) return;
    for (int i = 0; i < 3; i++) way.slide[i] /= free;
    while (node.way < planes->way_count && memcmp(&planes->way[node.way], &way, sizeof way) != 0)
        node.way++;
    if (node.way == planes->way_count) planes->way[planes->way_count++] = way;
    planes->node[planes->count++] = node;
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
            add_node(planes, contact, model->mesh.position[node], 4 * local[node],
                     held[node] & LAR_AXIS_ALL);
            held[node] |= SEEN;
        }
    for (int32_t n = 0; n < model->mesh.node_count; n++) held[n] &= (uint8_t)~SEEN;
}

static int by_node(const void *a, const void *b) {
    const lar_plane_node *x = a, *y = b;
    if (x->value != y->value) return x->value < y->value ? -1 : 1;
    return (x->way > y->way) - (x->way < y->way);
}

lar_status lar_planes_create(const lar_model *model, const int32_t *local,
                             const lar_condition_share *share, lar_planes *planes,
                             lar_error *error) {
    *planes = (lar_planes){0};
    size_t max = 0, ways = 0;
    for (int i = 0; i < model->contact_count; i++)
        if (model->contact[i].kind == LAR_CONTACT_PLANE) {
            max += 4 * (size_t)model->contact[i].face_count;
            ways += LAR_AXIS_ALL; /* one for each choice of held axes, but not for all three */
        }
    if (max == 0) return LAR_OK;
    uint8_t *held = lar_calloc((size_t)model->mesh.node_count, sizeof *held);
    planes->node = lar_calloc(max, sizeof *planes->node);
    planes->way = lar_calloc(ways, sizeof *planes->way);
    if (!held || !planes->node || !planes->way) {
        free(held);
        lar_planes_destroy(planes);
        return lar_fail_memory(error, max * sizeof *planes->node, "the nodes before planes");
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
    free(planes->way);
    *planes = (lar_planes){0};
}

lar_status lar_plane_contact_create(const lar_planes *planes, lar_plane_contact *plane_contact,
                                    lar_error *error) {
    *plane_contact = (lar_plane_contact){.planes = planes};
    if (planes->count == 0) return LAR_OK;
    plane_contact->near = lar_calloc((size_t)planes->count, sizeof *plane_contact->near);
    if (plane_contact->near) return LAR_OK;
    return lar_fail_memory(error, (size_t)planes->count * sizeof *plane_contact->near,
                           "the nodes before planes");
}

void lar_plane_contact_destroy(lar_plane_contact *plane_contact) {
    free(plane_contact->near);
    *plane_contact = (lar_plane_contact){0};
}

/* ---- the search ---------------------------------------------------------------------------- */

/* The library's fmax minds numbers that are none; so many calls of it would cost as much as all the
 * rest. */
static inline double larger(double a, double b) {
    return a > b ? a : b;
}

static inline double dot(const double a[3], const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double step_travel(const lar_condition_context *context, const lar_state *state) {
    return 1.7320508075688774 * context->whole_step * state->fastest;
}

/* Looks so far that at the present speed the next search is some dozens of steps away, and never
 * less far than a falling body gets in a hundred steps: the update kernel sees a resting node fall
 * in every step, before it is stopped. */
static void search(lar_plane_contact *plane_contact, const lar_condition_context *context,
                   const lar_state *state, lar_contact_info *seen) {
    enum { AHEAD = 64 };
    double dt = context->time_step;
    plane_contact->reach = AHEAD * step_travel(context, state) + 50000 * dt * dt;
    plane_contact->travel = 0;
    plane_contact->near_count = 0;
    const lar_planes *planes = plane_contact->planes;
    for (int32_t i = 0; i < planes->count; i++) {
        const lar_plane_node *n = &planes->node[i];
        double height = n->offset + dot(planes->way[n->way].normal, state->u + n->value);
        /* A little more, for rounding. Not a number counts as near. */
        if (height > (1 + 1e-9) * plane_contact->reach) continue;
        lar_plane_near *near = &plane_contact->near[plane_contact->near_count++];
        *near = (lar_plane_near){.node = *n, .weight = context->weight[n->value / 4]};
        memcpy(near->before, state->v + n->value, sizeof near->before);
    }
    plane_contact->known = true;
    seen->searches++;
    seen->boxed += (uint64_t)plane_contact->near_count;
}

void lar_plane_contact_observe(lar_plane_contact *plane_contact,
                               const lar_condition_context *context, const lar_state *state,
                               bool always, lar_contact_info *seen) {
    if (plane_contact->planes->count == 0) return;
    double next = plane_contact->travel + 2 * step_travel(context, state);
    if (always || !plane_contact->known || !(next < plane_contact->reach)) {
        search(plane_contact, context, state, seen);
        return;
    }
    for (int32_t i = 0; i < plane_contact->near_count; i++)
        memcpy(plane_contact->near[i].before, state->v + plane_contact->near[i].node.value,
               sizeof plane_contact->near[i].before);
}

/* ---- stopping ------------------------------------------------------------------------------ */

/* The least velocity along the normal that a node may move with: what takes it to the plane from
 * its height, or nothing from below. It came from no lower than the plane, so its velocity before
 * was not greater than that, turned around: the mean of the two points into the plane or is zero,
 * and the plane takes energy or none. (The larger of a height and zero, without a branch: of
 * resting nodes the height is rounding, and its sign cannot be guessed.) */
static inline double min_velocity(double height, double rate) {
    return -0.5 * rate * (height + fabs(height));
}

/* What a step's stops sum up to. */
typedef struct stops {
    double work, damped, fastest, deepest;
    int32_t touching;
} stops;

static inline void stop_node(const lar_plane_near *near, const lar_plane_way *way, double dt,
                             double rate, double *restrict u, double *restrict v, stops *sum) {
    double height = near->node.offset + dot(way->normal, u);
    if (height >= 0) return;
    double speed = dot(way->normal, v);
    double change = min_velocity(height - dt * speed, rate) - speed;
    if (change > 0) {
        double mean[3], free[3];
        for (int i = 0; i < 3; i++) {
            double now = v[i] + way->slide[i] * change;
            free[i] = near->before[i] + v[i];
            mean[i] = near->before[i] + now;
            u[i] += dt * (way->slide[i] * change);
            v[i] = now;
        }
        for (int i = 0; i < 3; i++) sum->fastest = larger(sum->fastest, fabs(v[i]));
        /* m v'^2 less what it were without the stop, and the same for |v + v'|^2. */
        double work = near->weight * change * dot(way->slide, mean);
        sum->work += work;
        sum->damped += work + near->weight * change * dot(way->slide, free);
        height += dt * change;
    }
    sum->touching += near->weight > 0; /* once, of several processors */
    sum->deepest = larger(sum->deepest, -height);
}

void lar_plane_contact_stop(lar_plane_contact *plane_contact, const lar_condition_context *context,
                            lar_state *state, bool always, lar_contact_info *seen) {
    if (plane_contact->planes->count == 0) return;
    plane_contact->travel += step_travel(context, state);
    /* Faster within one step than the search allowed for: somebody else may be there now. (What
     * they had before is lost, which costs the energy account a little and the motion nothing.) */
    if (!(plane_contact->travel < plane_contact->reach) && !always)
        search(plane_contact, context, state, seen);
    double dt = context->time_step, rate = 1 / dt, moved = step_travel(context, state);
    stops sum = {.fastest = state->fastest};
    const lar_plane_way *way = plane_contact->planes->way;
    for (int32_t i = 0; i < plane_contact->near_count; i++) {
        const lar_plane_near *near = &plane_contact->near[i];
        stop_node(near, &way[near->node.way], dt, rate, state->u + near->node.value,
                  state->v + near->node.value, &sum);
    }
    state->fastest = sum.fastest;
    double damping = lar_damping_of(context->model, context->settings);
    /* The update kernel has counted the free motion. */
    state->damped += damping * sum.damped * (context->mean_step / context->whole_step);
    state->contact -= 0.5 * (1 + 0.5 * damping * context->mean_step) * sum.work;
    plane_contact->travel += step_travel(context, state) - moved;
    seen->touching += sum.touching;
    seen->deepest = larger(seen->deepest, sum.deepest);
    seen->possible += (uint64_t)plane_contact->planes->count;
    seen->tested += (uint64_t)plane_contact->near_count;
}

int32_t lar_planes_ahead(const lar_planes *planes, const lar_condition_context *context,
                         const lar_state *state, int32_t entry, double ahead[3]) {
    double dt = context->time_step;
    int32_t value = planes->node[entry].value;
    for (; entry < planes->count && planes->node[entry].value == value; entry++) {
        const lar_plane_way *way = &planes->way[planes->node[entry].way];
        double height = planes->node[entry].offset + dot(way->normal, state->u + value);
        double speed = dot(way->normal, ahead);
        double min = min_velocity(height, 1 / dt);
        for (int i = 0; i < 3 && speed < min; i++) ahead[i] += way->slide[i] * (min - speed);
    }
    return entry;
}
