#include "contact/plane_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mechanics/contact.h"

/* ---- set-up -------------------------------------------------------------------------------- */

static inline double dot(const double a[3], const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Supports are stronger than planes: a node gives way along its free axes only, and not at all when
 * these lie along the plane. */
LAR_SETUP static void add_node(lar_planes *planes, const lar_contact *plane,
                               const double position[3], int32_t local, unsigned held) {
    lar_plane_way way = {.held = plane->friction > 0 && held != 0};
    lar_plane_node node = {.node = local};
    double free = 0;
    for (int i = 0; i < 3; i++) {
        way.normal[i] = plane->normal[i];
        node.offset += plane->normal[i] * (position[i] - plane->through[i]);
        way.slide[i] = held >> i & 1 ? 0 : plane->normal[i];
        way.free[i] = plane->friction > 0 && held >> i & 1 ? 0 : 1;
        free += way.slide[i] * way.slide[i];
    }
    if (free < 1e-6) return;
    for (int i = 0; i < 3; i++) way.slide[i] /= free;
    way.grip = plane->friction * dot(way.slide, way.slide);
    while (node.way < planes->way_count && memcmp(&planes->way[node.way], &way, sizeof way) != 0)
        node.way++;
    if (node.way == planes->way_count) planes->way[planes->way_count++] = way;
    planes->node[planes->count++] = node;
    planes->rough = planes->rough || plane->friction > 0;
}

LAR_SETUP static void add_plane(lar_planes *planes, const lar_model *model, const int32_t *local,
                                const lar_condition_share *share, int plane, uint8_t *held) {
    enum { SEEN = 0x80 };
    const lar_contact *contact = &model->contact[plane];
    for (int32_t f = 0; f < contact->face_count; f++)
        for (int a = 0; a < 4; a++) {
            int32_t face = contact->face[f];
            int32_t node = model->mesh.element[face / 6][lar_face_node[face % 6][a]];
            if (held[node] & SEEN || (share && share->holds[node] != share->thread)) continue;
            add_node(planes, contact, model->mesh.position[node], local[node],
                     held[node] & LAR_AXIS_ALL);
            held[node] |= SEEN;
        }
    for (int32_t n = 0; n < model->mesh.node_count; n++) held[n] &= (uint8_t)~SEEN;
}

static int by_node(const void *a, const void *b) {
    const lar_plane_node *x = a, *y = b;
    if (x->node != y->node) return x->node < y->node ? -1 : 1;
    return (x->way > y->way) - (x->way < y->way);
}

LAR_SETUP lar_status lar_planes_create(const lar_model *model, const int32_t *local,
                                       const lar_condition_share *share, const lar_supports *set,
                                       lar_planes *planes, lar_error *error) {
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
    lar_supports_mark(set, model, held);
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

LAR_SETUP lar_status lar_plane_contact_create(const lar_planes *planes,
                                              lar_plane_contact *plane_contact, lar_error *error) {
    *plane_contact = (lar_plane_contact){.planes = planes};
    if (planes->count == 0) return LAR_OK;
    plane_contact->near = lar_calloc((size_t)planes->count, sizeof *plane_contact->near);
    plane_contact->last = lar_calloc((size_t)planes->count, sizeof *plane_contact->last);
    if (plane_contact->near && plane_contact->last) return LAR_OK;
    lar_plane_contact_destroy(plane_contact);
    return lar_fail_memory(error, (size_t)planes->count * sizeof *plane_contact->near,
                           "the nodes before planes");
}

void lar_plane_contact_destroy(lar_plane_contact *plane_contact) {
    free(plane_contact->near);
    free(plane_contact->last);
    *plane_contact = (lar_plane_contact){0};
}

/* ---- the search ---------------------------------------------------------------------------- */

/* The library's fmax minds numbers that are none; so many calls of it would cost as much as all the
 * rest. */
static inline double larger(double a, double b) {
    return a > b ? a : b;
}

static double step_travel(const lar_condition_context *context, const lar_state *state) {
    return 1.7320508075688774 * context->whole_step * state->fastest;
}

/* The same from the nodes before planes themselves: nobody may have said how fast they are. */
static double travel_of_all(const lar_plane_contact *plane_contact,
                            const lar_condition_context *context, const lar_state *state) {
    double fastest = 0;
    for (int32_t i = 0; i < plane_contact->planes->count; i++)
        for (int k = 0; k < 3; k++)
            fastest =
                larger(fastest,
                       fabs(state->v[lar_state_at(state, plane_contact->planes->node[i].node, k)]));
    return 1.7320508075688774 * context->whole_step * fastest;
}

/* Looks so far that at the present speed the next search is some dozens of steps away, and never
 * less far than a falling body gets in a hundred steps: the update kernel sees a resting node fall
 * in every step, before it is stopped. */
static void search(lar_plane_contact *plane_contact, const lar_condition_context *context,
                   const lar_state *state, lar_contact_info *seen) {
    enum { AHEAD = 64 };
    double dt = context->time_step, travel = step_travel(context, state);
    /* Friction must not depend on when nodes were looked at, not even after a checkpoint. */
    if (plane_contact->planes->rough)
        travel = larger(travel, travel_of_all(plane_contact, context, state));
    plane_contact->reach = AHEAD * travel + 50000 * dt * dt;
    plane_contact->travel = 0;
    plane_contact->near_count = 0;
    const lar_planes *planes = plane_contact->planes;
    for (int32_t i = 0; i < planes->count; i++) {
        const lar_plane_node *n = &planes->node[i];
        double u[3];
        lar_state_displacement(state, n->node, u);
        double height = n->offset + dot(planes->way[n->way].normal, u);
        /* A little more, for rounding. Not a number counts as near. */
        if (height > (1 + 1e-9) * plane_contact->reach) continue;
        lar_plane_near *near = &plane_contact->near[plane_contact->near_count++];
        *near = (lar_plane_near){.node = *n, .weight = context->weight[n->node]};
        lar_state_velocity(state, n->node, near->before);
    }
    plane_contact->known = true;
    seen->searches++;
    seen->boxed += (uint64_t)plane_contact->near_count;
}

/* A search within a step: who was near has its velocity before the step from `last`; the others
 * have none. */
static void search_again(lar_plane_contact *plane_contact, const lar_condition_context *context,
                         const lar_state *state, lar_contact_info *seen) {
    int32_t count = plane_contact->near_count, k = 0;
    lar_plane_near *last = plane_contact->near;
    plane_contact->near = plane_contact->last;
    plane_contact->last = last;
    search(plane_contact, context, state, seen);
    for (int32_t i = 0; i < plane_contact->near_count; i++) {
        lar_plane_near *near = &plane_contact->near[i];
        while (k < count && last[k].node.node < near->node.node) k++;
        if (k < count && last[k].node.node == near->node.node)
            memcpy(near->before, last[k].before, sizeof near->before);
        else
            near->before[0] = NAN;
    }
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
        lar_state_velocity(state, plane_contact->near[i].node.node, plane_contact->near[i].before);
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
    double work, damped, deepest;
    double stopped, fastest; /* speeds of stopped nodes along an axis, without and with planes */
    int32_t touching;
} stops;

/* Returns whether it changes u and v. */
static inline bool stop_node(const lar_plane_near *near, const lar_plane_way *way, double dt,
                             double rate, double *restrict u, double *restrict v, stops *sum) {
    double height = near->node.offset + dot(way->normal, u);
    if (height >= 0) return false;
    double speed = dot(way->normal, v);
    double change = min_velocity(height - dt * speed, rate) - speed;
    if (change > 0) {
        double mean[3], free[3];
        bool known = !isnan(near->before[0]);
        for (int i = 0; i < 3; i++) {
            sum->stopped = larger(sum->stopped, fabs(v[i]));
            double now = v[i] + way->slide[i] * change, before = known ? near->before[i] : v[i];
            free[i] = before + v[i];
            mean[i] = before + now;
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
    return change > 0;
}

/* ---- friction ------------------------------------------------------------------------------ */

/* Whether a node comes from so far that its velocity before the step does not count: from more than
 * twice the way that it went in one. Who was not near at the beginning of the step has; so that who
 * knew of it makes no difference. */
static bool comes_from_afar(double height, double rate, const double *before) {
    double reach = height * rate;
    return height > 0 && !(reach * reach <= 4 * dot(before, before));
}

/* What a plane makes of the velocity v, from a height before the step; returns whether it does. Its
 * impulse along its normal changes the velocity along `slide`; of a node with held axes it is
 * larger than that, by the part that goes into supports. Without `before` no friction. */
static inline bool meet(const lar_plane_way *way, double height, double rate, const double *before,
                        const double v[3], double change[3]) {
    double speed = dot(way->normal, v), stopped = min_velocity(height, rate) - speed;
    if (!(stopped > 0)) return false;
    for (int i = 0; i < 3; i++) change[i] = way->slide[i] * stopped;
    if (!before || !(way->grip > 0)) return true;
    double along[3] = {v[0], v[1], v[2]};
    if (way->held) { /* what is left of the motion along the other axes */
        for (int i = 0; i < 3; i++) along[i] *= way->free[i];
        speed = dot(way->normal, along);
    }
    for (int i = 0; i < 3; i++) along[i] -= way->slide[i] * speed;
    double square = dot(along, along), both = dot(along, before);
    if (both < -LAR_FRICTION_NONE * square && comes_from_afar(height, rate, before)) both = 0;
    double part = lar_friction_part(way->grip * stopped, square, both);
    for (int i = 0; i < 3; i++) change[i] -= part * along[i];
    return true;
}

/* The same, done to a node that has moved by v; returns whether it has changed anything. */
static inline bool rub(const lar_plane_near *near, const lar_plane_way *way, double height,
                       double dt, double rate, bool rough, double *restrict u, double *restrict v) {
    double change[3], start = height - dt * dot(way->normal, v);
    if (!meet(way, start, rate, rough ? near->before : NULL, v, change)) return false;
    for (int i = 0; i < 3; i++) {
        v[i] += change[i];
        u[i] += dt * change[i];
    }
    return true;
}

/* Friction with one plane can bring a node through another one: the last word has the stop. Planes
 * that are not met change nothing: who knows of them is up to the search. `met` of `count` have
 * been met, the last of them by `only`. */
static void stop_again(const lar_plane_near *near, int32_t count, const lar_plane_way *way,
                       double dt, double rate, int32_t met, int32_t only, double *u, double *v) {
    for (int32_t k = 0; k < count; k++) {
        const lar_plane_way *w = &way[near[k].node.way];
        double height = near[k].node.offset + dot(w->normal, u);
        if (height >= 0 || (met == 1 && k == only)) continue;
        if (rub(&near[k], w, height, dt, rate, false, u, v)) met++;
    }
}

/* All planes of one node, of which some have friction. */
static inline void rub_node(const lar_plane_near *near, int32_t count, const lar_plane_way *way,
                            double dt, double rate, double *restrict u, double *restrict v,
                            stops *sum) {
    const double free[3] = {v[0], v[1], v[2]};
    int32_t met = 0, only = -1;
    for (int32_t k = 0; k < count; k++) {
        const lar_plane_way *w = &way[near[k].node.way];
        double height = near[k].node.offset + dot(w->normal, u);
        if (height >= 0) continue;
        if (rub(&near[k], w, height, dt, rate, true, u, v)) {
            met++;
            only = k;
        }
        sum->touching += near->weight > 0;
        sum->deepest = larger(sum->deepest, -(near[k].node.offset + dot(w->normal, u)));
    }
    if (met == 0) return;
    if (count > 1) stop_again(near, count, way, dt, rate, met, only, u, v);
    const double *before = isnan(near->before[0]) ? free : near->before;
    double work = 0, damped = 0;
    for (int i = 0; i < 3; i++) {
        sum->stopped = larger(sum->stopped, fabs(free[i]));
        sum->fastest = larger(sum->fastest, fabs(v[i]));
        work += (v[i] - free[i]) * (before[i] + v[i]);
        damped += (v[i] - free[i]) * (before[i] + free[i]);
    }
    sum->work += near->weight * work;
    sum->damped += near->weight * (work + damped);
}

static inline void put_node(lar_state *state, int32_t node, const double u[3], const double v[3]) {
    lar_axes_put(state->u, state->stride, node, u);
    lar_axes_put(state->v, state->stride, node, v);
}

static void rub_nodes(const lar_plane_contact *plane_contact, double dt, double rate,
                      lar_state *state, stops *sum) {
    const lar_plane_near *near = plane_contact->near;
    const int32_t near_count = plane_contact->near_count;
    for (int32_t i = 0, count; i < near_count; i += count) {
        int32_t node = near[i].node.node;
        double u[3], v[3];
        for (count = 1; i + count < near_count && near[i + count].node.node == node;) count++;
        lar_state_displacement(state, node, u);
        lar_state_velocity(state, node, v);
        rub_node(&near[i], count, plane_contact->planes->way, dt, rate, u, v, sum);
        put_node(state, node, u, v);
    }
}

/* ---- the step ------------------------------------------------------------------------------ */

/* The largest speed along an axis, with planes. The update kernel's is that of a node at rest,
 * where a body stands: it falls in every step, with all the weight that it bears and its own small
 * mass, before it is stopped. Searches would see a body fly that does not move. */
static double fastest_of(const lar_condition_context *context, const lar_state *state) {
    enum { TOGETHER = 4 }; /* chains that do not wait for each other */
    double max[TOGETHER] = {0};
    for (int axis = 0; axis < 3; axis++)
        for (int32_t n = context->first; n < context->end; n += TOGETHER)
            for (int i = 0; i < TOGETHER; i++)
                max[i] = larger(max[i], fabs(state->v[lar_state_at(state, n + i, axis)]));
    return larger(larger(max[0], max[1]), larger(max[2], max[3]));
}

void lar_plane_contact_stop(lar_plane_contact *plane_contact, const lar_condition_context *context,
                            lar_state *state, bool always, lar_contact_info *seen) {
    if (plane_contact->planes->count == 0) return;
    plane_contact->travel += step_travel(context, state);
    /* Faster within one step than the search allowed for: somebody else may be there now. (What
     * those had before is lost, which costs the energy account a little and the motion nothing.) */
    if (!(plane_contact->travel < plane_contact->reach) && !always)
        search_again(plane_contact, context, state, seen);
    double dt = context->time_step, rate = 1 / dt, moved = step_travel(context, state);
    stops sum = {0};
    const lar_plane_way *way = plane_contact->planes->way;
    if (plane_contact->planes->rough) rub_nodes(plane_contact, dt, rate, state, &sum);
    int32_t smooth = plane_contact->planes->rough ? 0 : plane_contact->near_count;
    for (int32_t i = 0; i < smooth; i++) {
        const lar_plane_near *near = &plane_contact->near[i];
        double u[3], v[3];
        lar_state_displacement(state, near->node.node, u);
        lar_state_velocity(state, near->node.node, v);
        if (stop_node(near, &way[near->node.way], dt, rate, u, v, &sum))
            put_node(state, near->node.node, u, v);
    }
    if (!(sum.stopped < state->fastest)) state->fastest = fastest_of(context, state);
    state->fastest = larger(state->fastest, sum.fastest);
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
    double rate = 1 / context->time_step;
    int32_t first = entry, node = planes->node[entry].node, met = 0, only = -1;
    double u[3], v[3];
    lar_state_displacement(state, node, u);
    lar_state_velocity(state, node, v);
    while (entry < planes->count && planes->node[entry].node == node) entry++;
    for (int again = 0; again < (planes->rough ? 2 : 1); again++) /* as rub_node */
        for (int32_t k = first; k < entry; k++) {
            const lar_plane_way *way = &planes->way[planes->node[k].way];
            double height = planes->node[k].offset + dot(way->normal, u), change[3];
            if (again && met == 1 && k == only) continue;
            if (!meet(way, height, rate, again ? NULL : v, ahead, change)) continue;
            for (int i = 0; i < 3; i++) ahead[i] += change[i];
            if (!again) only = k;
            met++;
        }
    return entry;
}
