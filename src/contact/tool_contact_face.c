#include "contact/tool_contact_face.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/face_contact.h"

/* ---- points -------------------------------------------------------------------------------- */

int lar_tool_contact_points(const lar_tool_contact_face *face, double radius) {
    double wanted = ceil(2 * face->edge / radius);
    return wanted < 2 ? 2 : wanted > LAR_POINTS_ALONG_EDGE ? LAR_POINTS_ALONG_EDGE : (int)wanted;
}

void lar_tool_contact_weights(int point, int n, double weight[4]) {
    lar_face_weights((2 * (point % n) + 1.0) / n - 1, (2 * (point / n) + 1.0) / n - 1, weight);
}

LAR_SETUP void lar_tool_contact_grid(int n, lar_face_grid *grid) {
    double weight[4];
    grid->count = n * n;
    for (int i = 0; i < LAR_FACE_GRID_MAX; i++) {
        lar_tool_contact_weights(i < n * n ? i : n * n - 1, n, weight);
        for (int a = 0; a < 4; a++) grid->weight[a][i] = weight[a];
    }
}

double lar_tool_contact_point_mass(const lar_tool_contact_face *face, const double *mass, int n) {
    double min = INFINITY;
    for (int a = 0; a < 4; a++) min = lar_lesser(min, mass[face->node[a]] * face->share[a]);
    return 4 * min / (n * n);
}

double lar_grasp_stiffness_limit(const lar_tool_contact_face *face, double radius,
                                 const lar_contact_law *law, const double *mass) {
    return 0.5 * law->stiffness *
           lar_tool_contact_point_mass(face, mass, lar_tool_contact_points(face, radius));
}

/* The triangle that a point of the face is in: its first corner. */
static int triangle_at(const double weight[4]) {
    int a = 0;
    for (int b = 1; b < 4; b++)
        if (weight[b] + weight[(b + 1) % 4] > weight[a] + weight[(a + 1) % 4]) a = b;
    return a;
}

/* Unit normal of a triangle of the face, of corners a and the next and the face's middle, outwards.
 * 0 where it has no area. */
static void normal_of(const lar_tool_contact_patch *patch, int a, double normal[3]) {
    static const double MIDDLE[4] = {0.25, 0.25, 0.25, 0.25};
    double middle[3], from[3], to[3];
    lar_face_mean((const double(*)[3])patch->x, MIDDLE, middle);
    lar_minus(patch->x[a], middle, from);
    lar_minus(patch->x[(a + 1) % 4], middle, to);
    lar_cross(from, to, normal);
    double length = lar_length(normal);
    for (int i = 0; i < 3; i++) normal[i] = length > 0 ? normal[i] / length : 0;
}

/* At most how squarely one of both looks against a push: the face as a whole, `against`, or the
 * triangle; -1: the one where the weights say. */
__attribute__((noinline)) static double against_of(const lar_tool_contact_patch *patch,
                                                   const double normal[3], double against,
                                                   int triangle, const double weight[4]) {
    double local[3];
    normal_of(patch, triangle < 0 ? triangle_at(weight) : triangle, local);
    return lar_greater(against, -lar_dot(normal, local));
}

/* A point that has been passed by the middle of the tool sees a normal that would push it on, out
 * of the body: its face then looks the same way as the push. It is let go, smoothly where the push
 * goes along the face. A crumpled face looks elsewhere as a whole than where the point is, and
 * would let in what lies before it: of both, what keeps the tool outside counts. A tool that has
 * passed nothing pushes out whatever is in it: the end of a pad stands along the push, and a force
 * that goes with how a face is turned has no energy: tissue would flutter on it for ever. */
static double facing(lar_tool_contact_patch *patch, const double normal[3], int triangle,
                     const double weight[4]) {
    if (patch->outside) return 1;
    double against = -lar_dot(normal, patch->out);
    if (against < 0.2) against = against_of(patch, normal, against, triangle, weight);
    if (!(against < 0.2)) return 1;
    patch->behind = 1;
    return against <= 0 ? 0 : 5 * against;
}

/* A face that comes into a hard tool from the side, or turns round in it, is deep in it at once.
 * What leaves the tool too fast is pushed with less, and from three times as fast on no further:
 * contact brings out, and does not throw. */
static double not_thrown(const lar_tool_contact_face *face, double rate) {
    double away = -rate - face->lets_go;
    return away <= 0 ? 1 : lar_greater(0, 1 - away / (2 * face->lets_go));
}

/* For who looks. `deep`: how deep the point counts as. */
__attribute__((noinline, cold)) static void note_point(const lar_tool_contact_patch *patch,
                                                       int32_t s, const double weight[4],
                                                       const double normal[3], double force,
                                                       double deep) {
    lar_touch touch = {.depth = deep, .kind = LAR_TOUCH_PRESSED, .jaw = s, .face = patch->face->of};
    lar_face_mean((const double(*)[3])patch->x, weight, touch.place);
    for (int i = 0; i < 3; i++) {
        touch.normal[i] = normal[i];
        touch.force[i] = -force * normal[i];
    }
    memcpy(touch.weight, weight, sizeof touch.weight);
    lar_touch_note(patch->touches, &touch);
}

/* A point of the face is pushed along the normal of segment s. */
static double push_point(lar_tool_contact_patch *patch, const lar_contact_law *law, int32_t s,
                         double along, const double weight[4], const double normal[3], double mass,
                         double depth) {
    const lar_segment *now = &patch->body->now[s], *next = &patch->body->next[s];
    double v[3], rate = 0;
    lar_face_mean((const double(*)[3])patch->v, weight, v);
    for (int i = 0; i < 3; i++) {
        double begin = next->end[0][i] - now->end[0][i], end = next->end[1][i] - now->end[1][i];
        rate += normal[i] * ((begin + along * (end - begin)) * patch->rate_of - v[i]);
    }
    double force = not_thrown(patch->face, rate) * lar_contact_force(law, mass, depth, rate);
    patch->ahead = lar_greater(patch->ahead, depth + law->lead * rate);
    const double n[3] = {normal[0], normal[1], normal[2]};
    double share[4];
    for (int a = 0; a < 4; a++) share[a] = weight[a] * force;
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) patch->force[i][a] += share[a] * n[i];
    if (patch->body->count == 2) {
        double outwards = lar_dot(normal, patch->body->outward[s]);
        patch->squeeze -= force * along * outwards;
        patch->jaw[s] -= force * outwards;
    }
    patch->touching++;
    return force;
}

/* A point with springs fitted to a mass is so deep. */
static void note_spring(lar_tool_contact_patch *patch, const double weight[4], double mass,
                        double depth) {
    const double *yields = patch->face->yields;
    patch->deep = lar_greater(patch->deep, depth);
    for (int a = 0; a < 4; a++) patch->moves += mass * weight[a] * yields[a];
}

/* A point of the grid that is in segment s or close to it. */
static void touch_point(lar_tool_contact_patch *patch, const lar_contact_law *law, int32_t s,
                        const lar_face_grid *grid, const lar_face_near *near, int p) {
    double distance = sqrt(near->square[p]), depth = patch->radius - distance;
    double normal[3], weight[4];
    if (!(distance > 0) || !(depth > 0)) return;
    for (int i = 0; i < 3; i++) normal[i] = near->away[i][p] / distance;
    for (int a = 0; a < 4; a++) weight[a] = grid->weight[a][p];
    double share = facing(patch, normal, -1, weight);
    if (share == 0) return;
    if (patch->face->body >= 0) note_spring(patch, weight, patch->mass, depth);
    patch->depth = lar_greater(patch->depth, share * depth);
    patch->covered += lar_lesser(1, depth / (patch->face->wall * patch->radius));
    double force =
        push_point(patch, law, s, near->along[p], weight, normal, share * patch->mass, depth);
    if (patch->touches) note_point(patch, s, weight, normal, force, share * depth);
}

/* All of the grid against the tool's segments. */
static void touch_grid(lar_tool_contact_patch *patch, const lar_contact_law *law,
                       const lar_face_grid *grid) {
    /* More than what rounding could bring in; whether a point is in the tool its depth says. */
    const double within = patch->radius * patch->radius * (1 + 1e-9);
    lar_face_near near[2];
    near[1].points = 0;
    for (int32_t s = 0; s < patch->body->count; s++) {
        lar_face_grid_near(&patch->body->now[s], (const double(*)[3])patch->x, grid, within,
                           &near[s]);
        patch->min[s] = near[s].least;
    }
    for (uint64_t any = near[0].points | near[1].points; any; any &= any - 1) {
        int p = __builtin_ctzll(any);
        for (int32_t s = 0; s < 2; s++)
            if (near[s].points >> p & 1) touch_point(patch, law, s, grid, &near[s], p);
    }
}

/* ---- the wall ------------------------------------------------------------------------------ */

/* What a point with these weights may count as, so that the stiffness at each corner stays within
 * its mass: the row sums of theory.md, with one point instead of many. */
static double wall_mass(const lar_tool_contact_face *face, const double *mass,
                        const double weight[4]) {
    double max = INFINITY;
    for (int a = 0; a < 4; a++)
        if (weight[a] > 0) max = lar_lesser(max, mass[face->node[a]] * face->share[a] / weight[a]);
    return max;
}

/* What a triangle of the face has of the wall. */
typedef struct wall_part {
    double share, count; /* facing; against those of the other triangles [m^2] */
} wall_part;

static wall_part part_of(lar_tool_contact_patch *patch, int triangle, double reach,
                         lar_face_segment *at) {
    double beyond = reach - at->distance;
    if (!(beyond > 0)) return (wall_part){0};
    if (!(at->distance > 0)) { /* the middle line goes through the face: out the way it came */
        normal_of(patch, triangle, at->normal);
        for (int i = 0; i < 3; i++) at->normal[i] = -at->normal[i];
    }
    double share = facing(patch, at->normal, triangle, at->weight);
    return (wall_part){share, share * beyond * beyond};
}

/* The wall of one segment. Where a face is folded around a tool, two of its triangles are as close
 * as each other, and the closest point of the face would jump from the one to the other and back
 * for ever. So each triangle is pushed at its own closest point, and has the more of the wall the
 * deeper it is there: no force jumps. Returns how far the face is from where the wall begins. */
static double touch_wall(lar_tool_contact_patch *patch, const lar_contact_law *law,
                         const double *mass, int32_t s, double free_share) {
    lar_face_segment closest[4];
    wall_part parts[4];
    const double wall = patch->face->wall * patch->radius, reach = patch->radius - wall;
    double all = 0;
    double min = lar_face_segment_closest(&patch->body->now[s], (const double(*)[3])patch->x, reach,
                                          closest);
    for (int t = 0; t < 4; t++) {
        parts[t] = part_of(patch, t, reach, &closest[t]);
        all += parts[t].count;
    }
    for (int t = 0; t < 4; t++) {
        const wall_part *part = &parts[t];
        const lar_face_segment *at = &closest[t];
        const double depth = patch->radius - at->distance;
        if (!(part->count > 0)) continue;
        patch->depth = lar_greater(patch->depth, part->share * depth);
        const double bears = patch->hard * wall_mass(patch->face, mass, at->weight);
        double share = free_share * part->share * part->count / all;
        if (patch->face->body >= 0)
            note_spring(patch, at->weight, free_share * part->count / all * bears, depth);
        double force = push_point(patch, law, s, at->along, at->weight, at->normal, share * bears,
                                  depth - wall);
        if (patch->touches)
            note_point(patch, s, at->weight, at->normal, force, part->share * depth);
    }
    return min - reach;
}

/* How far a point of the face can be from the closest point of the grid: half of the diagonal
 * between two of these. */
static double spacing(const lar_tool_contact_patch *patch, int n) {
    double longest = 0;
    for (int a = 0; a < 4; a++) {
        double edge[3];
        lar_minus(patch->x[(a + 1) % 4], patch->x[a], edge);
        longest = lar_greater(longest, lar_dot(edge, edge));
    }
    return sqrt(0.5 * longest) / n;
}

/* Of a tool that is small beside a face few points of the grid touch, or none, and they bear what
 * so few may. What the others could bear belongs to the closest point of the face, when that is
 * deep in the tool: as much as its corners bear, at whatever size of tool and face. Returns how far
 * the face is at least from where the wall begins. */
static double touch_walls(lar_tool_contact_patch *patch, const lar_contact_law *law,
                          const double *mass, int n) {
    double free_share = 1 - patch->covered / (n * n), between = spacing(patch, n), gap = INFINITY;
    for (int32_t s = 0; s < patch->body->count; s++) {
        double distance = sqrt(patch->min[s]) - patch->radius;
        double own = distance - between + patch->face->wall * patch->radius;
        if (own < 0)
            own = free_share > 0 ? touch_wall(patch, law, mass, s, free_share) : -patch->radius;
        gap = lar_lesser(gap, own);
    }
    return gap;
}

/* ---- the face ------------------------------------------------------------------------------ */

void lar_tool_contact_push_face(lar_tool_contact_patch *patch, const lar_contact_law *law,
                                const double *mass, const lar_point_weights *weights) {
    const lar_tool_contact_face *face = patch->face;
    int n = lar_tool_contact_points(face, patch->radius);
    patch->mass = patch->hard * lar_tool_contact_point_mass(face, mass, n);
    patch->covered = patch->depth = patch->squeeze = patch->jaw[0] = patch->jaw[1] = 0;
    patch->touching = patch->behind = 0;
    patch->deep = patch->ahead = patch->moves = 0;
    memset(patch->force, 0, sizeof patch->force);
    lar_face_normal((const double(*)[3])patch->x, patch->out);
    double size = lar_length(patch->out);
    for (int i = 0; i < 3; i++) patch->out[i] = size > 0 ? patch->out[i] / size : 0;
    touch_grid(patch, law, &weights->of[n]);
    patch->closest = touch_walls(patch, law, mass, n);
    for (int32_t s = 0; s < patch->body->count; s++)
        patch->closest = lar_lesser(patch->closest, sqrt(patch->min[s]) - patch->radius);
}

double lar_tool_contact_asked(const lar_tool_contact_patch *patch) {
    return patch->moves * patch->deep * patch->deep;
}

double lar_tool_contact_hardness(const lar_tool_contact_patch *patch, double asked) {
    const double square = patch->deep * patch->deep;
    return asked > 0 && square > asked ? square / asked : 1;
}
