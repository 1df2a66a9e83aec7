#include "study/inverse/aspiration.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/vector.h"

/* ---- where the tube is --------------------------------------------------------------------------
 */

/* Which pressure of the scene is the tube's: the only one, or `load: N`, from 1. */
static lar_status choose_load(const lar_scene *scene, const lar_yaml *node,
                              lar_inverse_experiment *e) {
    const lar_yaml *own = lar_yaml_get(node, "load");
    const int count = e->model->pressure_count;
    int64_t number = 1;
    lar_status status =
        own ? lar_scene_integer(scene, own, "an integer, for example 1", &number) : LAR_OK;
    if (status) return status;
    if (number >= 1 && number <= count && (own || count == 1)) {
        e->aspiration.load = (int)number - 1;
        return LAR_OK;
    }
    const lar_yaml *at = own ? own : node;
    if (count == 0)
        return lar_scene_fail(scene, at, LAR_ERROR_MODEL,
                              "the scene %s has no pressure; give its faces in the tube one: load: "
                              "[ { faces: tube, pressure: -1.0e3 } ]",
                              e->scene);
    return lar_scene_fail(scene, at, LAR_ERROR_MODEL,
                          "the scene %s has %d pressure%s; say which one is the tube's, from 1: "
                          "load: 1",
                          e->scene, count, count == 1 ? "" : "s");
}

/* A new list of the nodes of the loaded faces, each once, ascending. */
static lar_status collect_nodes(const lar_scene *scene, lar_inverse_experiment *e) {
    const lar_mesh *mesh = &e->model->mesh;
    const lar_pressure_load *load = &e->model->pressure[e->aspiration.load];
    lar_inverse_aspiration *a = &e->aspiration;
    char *used = lar_calloc((size_t)mesh->node_count, 1);
    a->node = lar_calloc(4 * (size_t)load->count, sizeof *a->node);
    for (int32_t f = 0; used && f < load->count; f++)
        for (int c = 0; c < 4; c++)
            used[mesh->element[load->face[f] / 6][lar_face_node[load->face[f] % 6][c]]] = 1;
    for (int32_t n = 0; used && a->node && n < mesh->node_count; n++)
        if (used[n]) a->node[a->nodes++] = n;
    bool memory = used && a->node;
    free(used);
    return memory ? LAR_OK : lar_scene_no_memory(scene, (size_t)mesh->node_count);
}

/* Centre and mean normal of the loaded faces, and the window: some two of their edges. */
static void look_at_faces(lar_inverse_experiment *e) {
    static const double EDGES = 1.3;
    const lar_mesh *mesh = &e->model->mesh;
    const lar_pressure_load *load = &e->model->pressure[e->aspiration.load];
    lar_inverse_aspiration *a = &e->aspiration;
    double centre[3] = {0}, normal[3] = {0}, all = 0;
    for (int32_t f = 0; f < load->count; f++) {
        const double *p[4];
        double first[3], second[3], product[3];
        for (int c = 0; c < 4; c++)
            p[c] = mesh->position[mesh->element[load->face[f] / 6]
                                               [lar_face_node[load->face[f] % 6][c]]];
        lar_minus(p[2], p[0], first);
        lar_minus(p[3], p[1], second);
        lar_cross(first, second, product);
        double area = 0.5 * lar_length(product);
        all += area;
        for (int i = 0; i < 3; i++) {
            centre[i] += area * (p[0][i] + p[1][i] + p[2][i] + p[3][i]) / 4;
            normal[i] += 0.5 * product[i];
        }
    }
    double length = lar_length(normal);
    for (int i = 0; i < 3; i++) {
        a->origin[i] = all > 0 ? centre[i] / all : 0;
        a->axis[i] = length > 0 ? normal[i] / length : i == 2;
    }
    a->width = EDGES * sqrt(all / load->count);
}

lar_status lar_inverse_tube_read(const lar_scene *scene, const lar_yaml *node,
                                 lar_inverse_experiment *e) {
    const lar_yaml *origin = lar_yaml_get(node, "origin"), *axis = lar_yaml_get(node, "axis");
    lar_inverse_aspiration *a = &e->aspiration;
    lar_status status = choose_load(scene, node, e);
    if (!status) status = collect_nodes(scene, e);
    if (status) return status;
    look_at_faces(e);
    if (origin) status = lar_scene_vector(scene, origin, LAR_IN_POSITION, a->origin);
    if (!status && axis) status = lar_scene_direction(scene, axis, a->axis);
    return status;
}

/* ---- profiles -----------------------------------------------------------------------------------
 */

/* Of node k of the loaded faces, displaced by `u` (NULL: at rest). */
static void place(const lar_inverse_experiment *e, int32_t k, const double (*u)[3], double *r,
                  double *z) {
    const lar_inverse_aspiration *a = &e->aspiration;
    double from[3], out[3];
    lar_minus(e->model->mesh.position[a->node[k]], a->origin, from);
    for (int i = 0; u && i < 3; i++) from[i] += u[a->node[k]][i];
    *z = lar_dot(from, a->axis);
    for (int i = 0; i < 3; i++) out[i] = from[i] - *z * a->axis[i];
    *r = lar_length(out);
}

double lar_inverse_tube_reach(const lar_inverse_experiment *e) {
    double reach = 0, r, z;
    for (int32_t k = 0; k < e->aspiration.nodes; k++) {
        place(e, k, NULL, &r, &z);
        reach = fmax(reach, r);
    }
    return reach;
}

/* Sums of powers of the distance x from where the parabola is wanted, with z once. */
typedef struct sums {
    double x[5], zx[3];
} sums;

static void add(sums *s, double x, double z) {
    if (!(fabs(x) < 1)) return;
    double weight = (1 - x * x) * (1 - x * x);
    for (int i = 0; i < 5; i++) {
        s->x[i] += weight;
        if (i < 3) s->zx[i] += weight * z;
        weight *= x;
    }
}

/* The parabola's value at x = 0, by Cramer's rule. False where too few places tell it: where an
 * error of the heights would be more than so many times as large in it (in squares). */
static bool solve(const sums *s, double *value) {
    static const double GROWS = 30;
    const double *m = s->x, *b = s->zx;
    double own = m[2] * m[4] - m[3] * m[3];
    double whole =
        m[0] * own - m[1] * (m[1] * m[4] - m[3] * m[2]) + m[2] * (m[1] * m[3] - m[2] * m[2]);
    if (!(GROWS * whole > own * m[0])) return false;
    *value =
        (b[0] * own - m[1] * (b[1] * m[4] - m[3] * b[2]) + m[2] * (b[1] * m[3] - m[2] * b[2])) /
        whole;
    return true;
}

double lar_inverse_tube_height(const lar_inverse_experiment *e, const double (*u)[3], double r) {
    enum { WINDOWS = 12 };
    const lar_inverse_aspiration *a = &e->aspiration;
    double width = a->width, value = 0;
    for (int w = 0; w < WINDOWS; w++, width *= 1.5) {
        sums s = {{0}, {0}};
        for (int32_t k = 0; k < a->nodes; k++) {
            double at, z;
            place(e, k, u, &at, &z);
            add(&s, (at - r) / width, z);
            add(&s, (-at - r) / width, z);
        }
        if (solve(&s, &value)) return value;
        if (s.x[0] > 0) value = s.zx[0] / s.x[0]; /* the mean, where all are as far from the axis */
    }
    return value;
}
