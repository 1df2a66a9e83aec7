/* Rays against the outer surface, wherever its nodes are: what a program picks and looks with.
 *
 * A face is two triangles, as viewers draw it. A triangle is met where the ray passes its three
 * edges on the same side (Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", Journal
 * of Computer Graphics Techniques 2:65, 2013): two triangles find the same number, with the other
 * sign, for their common edge, so that no ray slips through between them. Corners in the order of
 * their numbers see to it that it is the same to the last bit. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vector.h"
#include "model/model.h"
#include "model/triangles/tree.h"

/* So many rays are worth a tree. */
enum { RAYS_FOR_TREE = 8 };

typedef struct ray {
    const lar_triangles *surface;
    double origin[3], direction[3]; /* of length 1 */
    int axis[3];                    /* the last one is the longest of the direction's */
    double shear[3];
    double reach;     /* so far [m] */
    int32_t triangle; /* so far; -1: none */
} ray;

static void ray_aim(ray *r, const double origin[3], const double direction[3], double longest) {
    int z = 0;
    double size = 0;
    /* Scaled before it is squared: directions may have any length. */
    for (int i = 0; i < 3; i++)
        if (fabs(direction[i]) > fabs(direction[z])) z = i;
    const double scale = fabs(direction[z]);
    for (int i = 0; i < 3; i++) size += (direction[i] / scale) * (direction[i] / scale);
    for (int i = 0; i < 3; i++) {
        r->origin[i] = origin[i];
        r->direction[i] = direction[i] / scale / sqrt(size);
        r->axis[i] = (z + 1 + i) % 3;
    }
    r->shear[0] = r->direction[r->axis[0]] / r->direction[z];
    r->shear[1] = r->direction[r->axis[1]] / r->direction[z];
    r->shear[2] = 1 / r->direction[z];
    r->reach = longest;
    r->triangle = -1;
}

static void sort_corners(const int32_t corner[3], int32_t sorted[3]) {
    memcpy(sorted, corner, 3 * sizeof *sorted);
    for (int i = 0; i < 2; i++)
        for (int k = i + 1; k < 3; k++)
            if (sorted[k] < sorted[i]) {
                int32_t swapped = sorted[i];
                sorted[i] = sorted[k];
                sorted[k] = swapped;
            }
}

/* Looks at one triangle; of equally far ones the first counts. */
static bool look(void *context, int32_t triangle) {
    ray *r = context;
    int32_t corner[3];
    double x[3], y[3], z[3];
    sort_corners(r->surface->corner[triangle], corner);
    for (int a = 0; a < 3; a++) {
        double at[3];
        lar_minus(r->surface->vertex[corner[a]], r->origin, at);
        z[a] = at[r->axis[2]];
        x[a] = at[r->axis[0]] - r->shear[0] * z[a];
        y[a] = at[r->axis[1]] - r->shear[1] * z[a];
    }
    const double u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2],
                 w = x[1] * y[0] - y[1] * x[0], sum = u + v + w;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return true;
    const double at = r->shear[2] * (u * z[0] + v * z[1] + w * z[2]) / sum;
    const bool first = at < r->reach || r->triangle < 0 || triangle < r->triangle;
    if (sum != 0 && at >= 0 && at <= r->reach && first) {
        r->reach = at;
        r->triangle = triangle;
    }
    return true;
}

static void tell(const ray *r, const lar_surface *surface, int32_t *body, lar_ray_hit *hit) {
    *hit = (lar_ray_hit){.face = -1, .element = -1, .body = -1, .distance = INFINITY};
    if (r->triangle < 0) return;
    const int32_t *corner = r->surface->corner[r->triangle];
    double one[3], other[3];
    hit->face = r->triangle / 2;
    hit->element = surface->element[hit->face];
    hit->body = body[corner[0]];
    hit->distance = r->reach;
    lar_minus(r->surface->vertex[corner[1]], r->surface->vertex[corner[0]], one);
    lar_minus(r->surface->vertex[corner[2]], r->surface->vertex[corner[0]], other);
    lar_cross(one, other, hit->normal);
    const double length = lar_length(hit->normal);
    for (int i = 0; i < 3; i++) {
        hit->point[i] = r->origin[i] + r->reach * r->direction[i];
        hit->normal[i] = length > 0 ? hit->normal[i] / length : 0;
    }
}

/* ---- the surface now ------------------------------------------------------------------------ */

typedef struct surface_now {
    lar_triangles triangles;
    int32_t *body; /* [nodes] the connected part of the mesh, numbered by its first node */
    lar_triangle_tree *tree;
} surface_now;

static void surface_clear(surface_now *now) {
    lar_triangle_tree_destroy(now->tree);
    free(now->triangles.vertex);
    free(now->triangles.corner);
    free(now->body);
}

static void find_bodies(const lar_mesh *mesh, int32_t *body) {
    int32_t bodies = 0;
    lar_mesh_bodies(mesh, body);
    /* The first node of a body stands before all others of it. */
    for (int32_t n = 0; n < mesh->node_count; n++)
        body[n] = body[n] == n ? bodies++ : body[body[n]];
}

static lar_status place_nodes(const lar_model *model, const double (*u)[3], surface_now *now,
                              lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    for (int32_t n = 0; n < mesh->node_count; n++)
        for (int i = 0; i < 3; i++) {
            double at = mesh->position[n][i] + (u ? u[n][i] : 0);
            if (!(fabs(at) <= 1e30))
                return lar_fail(error, LAR_ERROR_UNSTABLE,
                                "node %lld has left the range of numbers: there is no surface to "
                                "meet; go back to the start",
                                (long long)mesh->node_id[n]);
            now->triangles.vertex[n][i] = at;
        }
    for (int32_t f = 0; f < model->surface.face_count; f++) {
        const int32_t *corner = model->surface.corner[f];
        for (int k = 0; k < 2; k++) {
            int32_t *triangle = now->triangles.corner[2 * f + k];
            triangle[0] = corner[0];
            triangle[1] = corner[1 + k];
            triangle[2] = corner[2 + k];
        }
    }
    find_bodies(mesh, now->body);
    return LAR_OK;
}

static lar_status surface_make(const lar_model *model, const double (*u)[3], bool tree,
                               surface_now *now, lar_error *error) {
    const size_t nodes = (size_t)model->mesh.node_count, faces = (size_t)model->surface.face_count;
    lar_triangles *t = &now->triangles;
    t->vertex = lar_calloc(nodes, sizeof *t->vertex);
    t->corner = lar_calloc(2 * faces, sizeof *t->corner);
    now->body = lar_calloc(nodes, sizeof *now->body);
    t->vertex_count = model->mesh.node_count;
    t->triangle_count = 2 * model->surface.face_count;
    if (!t->vertex || !t->corner || !now->body)
        return lar_fail_memory(error, nodes * sizeof *t->vertex, "rays");
    lar_status status = place_nodes(model, u, now, error);
    if (status || !tree) return status;
    return lar_triangle_tree_create(t, NULL, t->triangle_count, &now->tree, error);
}

/* ---- the public call ------------------------------------------------------------------------ */

static lar_status check(int32_t count, const double (*origin)[3], const double (*direction)[3],
                        double longest, lar_error *error) {
    if (!(longest >= 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "rays of %g m: give the longest distance, 0 or more; INFINITY: any",
                        longest);
    for (int32_t k = 0; k < count; k++) {
        double size = 0;
        bool good = true;
        for (int i = 0; i < 3; i++) {
            size = fmax(size, fabs(direction[k][i]));
            good = good && fabs(origin[k][i]) <= 1e30 && isfinite(direction[k][i]);
        }
        if (!good || size == 0)
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "ray %ld, counted from 0, has no place or no direction: both need "
                            "three finite numbers, of a place none beyond 1e30 m, and those of a "
                            "direction cannot all be 0",
                            (long)k);
    }
    return LAR_OK;
}

lar_status lar_model_rays(const lar_model *model, const double (*u)[3], int32_t count,
                          const double (*origin)[3], const double (*direction)[3], double longest,
                          lar_ray_hit *hit, lar_error *error) {
    if (count < 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_model_rays is asked for %ld rays; there are 0 or more", (long)count);
    if (!model || (count > 0 && (!origin || !direction || !hit)))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_model_rays needs a model, origins, directions and a place for what "
                        "they meet; none may be NULL");
    surface_now now = {.tree = NULL};
    lar_status status = check(count, origin, direction, longest, error);
    if (!status) status = surface_make(model, u, count >= RAYS_FOR_TREE, &now, error);
    for (int32_t k = 0; k < count && !status; k++) {
        ray r = {.surface = &now.triangles};
        ray_aim(&r, origin[k], direction[k], longest);
        if (now.tree) lar_triangle_tree_line(now.tree, r.origin, r.direction, &r.reach, look, &r);
        for (int32_t t = 0; !now.tree && t < now.triangles.triangle_count; t++) look(&r, t);
        tell(&r, &model->surface, now.body, &hit[k]);
    }
    surface_clear(&now);
    return status;
}
