#include "meshing/deviation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel_for.h"
#include "base/vector.h"
#include "model/triangles/tree.h"

/* Samples in each direction, about; samples along a side of a face or triangle, at most; samples
 * along the edge of a face, of the surface or, where its triangles are smaller, of the face. */
enum { SAMPLES_MAX = 200000, CUTS_MAX = 16, CUTS_PER_EDGE = 8 };

typedef struct sample {
    double point[3], distance, weight;
} sample;

typedef struct samples {
    sample *one;
    size_t count, capacity;
    size_t first;                  /* of those that are asked for now */
    const lar_triangle_tree *tree; /* of what they are asked for */
    lar_error *error;
} samples;

static lar_status add(samples *all, const double point[3], double weight) {
    if (!LAR_GROW(all->one, all->capacity, all->count))
        return lar_fail_memory(all->error, 2 * all->capacity * sizeof *all->one,
                               "the distances between two surfaces");
    all->one[all->count++] = (sample){{point[0], point[1], point[2]}, 0, weight};
    return LAR_OK;
}

/* What was nearest to the sample before, mostly a neighbour, says how far to look, at first. */
static void measure_some(void *context, int32_t first, int32_t end) {
    const samples *all = context;
    lar_nearest nearest = {0};
    double reach = INFINITY;
    for (int32_t i = first; i < end; i++) {
        sample *one = &all->one[all->first + (size_t)i];
        if (i > first) {
            double away[3];
            lar_minus(one->point, nearest.point, away);
            reach = lar_length(away);
        }
        if (!lar_triangle_tree_nearest(all->tree, one->point, reach, &nearest))
            lar_triangle_tree_nearest(all->tree, one->point, INFINITY, &nearest);
        one->distance = nearest.distance;
    }
}

/* Makes the weights of this direction sum up to a half, so that both count the same. */
static void halve_weights(samples *all) {
    const size_t first = all->first;
    double sum = 0;
    for (size_t s = first; s < all->count; s++) sum += all->one[s].weight;
    for (size_t s = first; s < all->count; s++)
        all->one[s].weight = sum > 0 ? 0.5 * all->one[s].weight / sum : 0;
}

/* One direction: the distances of the samples that have come since the last call. */
static void measure(samples *all, const lar_triangle_tree *tree) {
    enum { PORTION = 1024 };
    all->tree = tree;
    halve_weights(all);
    lar_parallel_for((int32_t)(all->count - all->first), PORTION, measure_some, all);
    all->first = all->count;
}

static void face_corners(const lar_mesh *mesh, int32_t face, double corner[4][3]) {
    for (int a = 0; a < 4; a++)
        memcpy(corner[a], mesh->position[mesh->element[face / 6][lar_face_node[face % 6][a]]],
               sizeof corner[a]);
}

/* A place of a bilinear face, u and v from 0 to 1, and the area per du dv there. */
static double place_on_face(const double corner[4][3], double u, double v, double point[3]) {
    double along_u[3], along_v[3], normal[3];
    for (int d = 0; d < 3; d++) {
        const double low = corner[1][d] - corner[0][d], high = corner[2][d] - corner[3][d];
        const double left = corner[3][d] - corner[0][d], right = corner[2][d] - corner[1][d];
        along_u[d] = low + v * (high - low);
        along_v[d] = left + u * (right - left);
        point[d] = corner[0][d] + u * low + v * along_v[d];
    }
    lar_cross(along_u, along_v, normal);
    return lar_length(normal);
}

/* Samples along a side of a face or triangle of some area, for about SAMPLES_MAX in all. */
static int cuts_for(double area, double area_of_all, double min_spacing) {
    const double spacing = fmax(sqrt(area_of_all / SAMPLES_MAX), min_spacing);
    const double cuts = spacing > 0 ? ceil(sqrt(area) / spacing) : 1;
    return cuts < 1 ? 1 : cuts > CUTS_MAX ? CUTS_MAX : (int)cuts;
}

/* Where many small faces would give more samples than that, every n-th one is looked at. */
static int32_t stride_for(int32_t count) {
    return 1 + count / (2 * SAMPLES_MAX);
}

/* The face's corners and its middle as four triangles around the middle. */
static void add_fan(lar_triangles *fans, int32_t f, const double corner[4][3]) {
    memcpy(fans->vertex[5 * f], corner, 4 * sizeof corner[0]);
    place_on_face(corner, 0.5, 0.5, fans->vertex[5 * f + 4]);
    for (int a = 0; a < 4; a++) {
        int32_t *triangle = fans->corner[4 * f + a];
        triangle[0] = 5 * f + a;
        triangle[1] = 5 * f + (a + 1) % 4;
        triangle[2] = 5 * f + 4;
    }
}

/* The faces of the mesh as triangles; *area: of all. */
static lar_status build_fans(const lar_mesh *mesh, const int32_t *face, int32_t count,
                             lar_triangles *fans, double *area, lar_error *error) {
    if (count > INT32_MAX / 5)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED, "%d faces are too many to be compared",
                        count);
    fans->vertex = lar_calloc((size_t)count * 5, sizeof *fans->vertex);
    fans->corner = lar_calloc((size_t)count * 4, sizeof *fans->corner);
    if (!fans->vertex || !fans->corner)
        return lar_fail_memory(error, (size_t)count * 168, "the faces of the mesh");
    fans->vertex_count = 5 * count;
    fans->triangle_count = 4 * count;
    *area = 0;
    for (int32_t f = 0; f < count; f++) {
        double corner[4][3], middle[3];
        face_corners(mesh, face[f], corner);
        add_fan(fans, f, (const double(*)[3])corner);
        *area += place_on_face((const double(*)[3])corner, 0.5, 0.5, middle);
    }
    return LAR_OK;
}

/* From the mesh to the surface. A face has at least 2 x 2 samples, so that a bent one is seen. */
static lar_status sample_faces(const lar_mesh *mesh, const int32_t *face, int32_t count,
                               double area, double finest, samples *all) {
    lar_status status = LAR_OK;
    for (int32_t f = 0; !status && f < count; f += stride_for(count)) {
        double corner[4][3], point[3];
        face_corners(mesh, face[f], corner);
        const double own = place_on_face((const double(*)[3])corner, 0.5, 0.5, point);
        int cuts = cuts_for(own, area, finest);
        if (cuts < 2 && count < SAMPLES_MAX) cuts = 2;
        for (int s = 0; !status && s < cuts * cuts; s++) {
            const double u = (s % cuts + 0.5) / cuts, v = (s / cuts + 0.5) / cuts;
            const double weight = place_on_face((const double(*)[3])corner, u, v, point);
            status = add(all, point, weight / (cuts * cuts));
        }
    }
    return status;
}

/* The area. */
static double triangle_corners(const lar_triangles *surface, int32_t t, double corner[3][3]) {
    double normal[3];
    for (int a = 0; a < 3; a++)
        memcpy(corner[a], surface->vertex[surface->corner[t][a]], sizeof corner[a]);
    lar_triangles_normal(surface, t, normal);
    return lar_length(normal) / 2;
}

/* From the surface to the mesh: at the middles of the small triangles, cuts x cuts of them, into
 * which lines parallel to its sides cut a triangle. */
static lar_status sample_triangles(const lar_triangles *surface, double area, double finest,
                                   samples *all) {
    lar_status status = LAR_OK;
    const int32_t count = surface->triangle_count;
    for (int32_t t = 0; !status && t < count; t += stride_for(count)) {
        double corner[3][3];
        const double own = triangle_corners(surface, t, corner);
        const int cuts = cuts_for(own, area, finest);
        for (int s = 0; !status && s < cuts * cuts; s++) {
            /* Row i has cuts - i upright triangles and cuts - i - 1 that hang. */
            const int i = s / cuts, j = s % cuts;
            const bool upright = i + j < cuts;
            const double a = upright ? i + 1.0 / 3 : cuts - i - 1.0 / 3;
            const double b = upright ? j + 1.0 / 3 : cuts - j - 1.0 / 3;
            double point[3];
            for (int d = 0; d < 3; d++)
                point[d] =
                    corner[0][d] +
                    (a * (corner[1][d] - corner[0][d]) + b * (corner[2][d] - corner[0][d])) / cuts;
            status = add(all, point, own / (cuts * cuts));
        }
    }
    return status;
}

/* Corners have no area, but the largest distance is often there. */
static lar_status sample_vertices(const lar_triangles *from, samples *all) {
    lar_status status = LAR_OK;
    for (int32_t v = 0; !status && v < from->vertex_count; v += stride_for(from->vertex_count))
        status = add(all, from->vertex[v], 0);
    return status;
}

static int compare_samples(const void *a, const void *b) {
    const sample *p = a, *q = b;
    if (p->distance != q->distance) return p->distance < q->distance ? -1 : 1;
    return (p->weight > q->weight) - (p->weight < q->weight);
}

static void summarise(samples *all, lar_deviation *deviation) {
    *deviation = (lar_deviation){0};
    double reached = 0, weight = 0;
    qsort(all->one, all->count, sizeof *all->one, compare_samples);
    for (size_t s = 0; s < all->count; s++) {
        weight += all->one[s].weight;
        deviation->mean += all->one[s].weight * all->one[s].distance;
    }
    for (size_t s = 0; s < all->count && reached < 0.95 * weight; s++) {
        reached += all->one[s].weight;
        deviation->max_95 = all->one[s].distance;
    }
    if (weight > 0) deviation->mean /= weight;
    if (all->count > 0) deviation->hausdorff = all->one[all->count - 1].distance;
}

lar_status lar_deviation_measure(const lar_mesh *mesh, const int32_t *face, int32_t count,
                                 const lar_triangles *surface, lar_deviation *deviation,
                                 lar_error *error) {
    if (count <= 0 || surface->triangle_count <= 0)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "nothing to compare: the mesh has %d faces there, the surface %d triangles",
                        count, surface->triangle_count);
    lar_triangles fans = {0};
    lar_triangle_tree *surface_tree = NULL, *mesh_tree = NULL;
    samples all = {.error = error};
    const double area = lar_triangles_area(surface);
    double face_area = 0;
    lar_status status = build_fans(mesh, face, count, &fans, &face_area, error);
    if (!status)
        status =
            lar_triangle_tree_create(surface, NULL, surface->triangle_count, &surface_tree, error);
    if (!status)
        status = lar_triangle_tree_create(&fans, NULL, fans.triangle_count, &mesh_tree, error);
    const double face_spacing = sqrt(face_area / count) / CUTS_PER_EDGE;
    const double spacing = fmin(face_spacing, sqrt(area / surface->triangle_count) / 2);
    if (!status) status = sample_faces(mesh, face, count, face_area, spacing, &all);
    if (!status) status = sample_vertices(&fans, &all);
    if (!status) measure(&all, surface_tree);
    if (!status) status = sample_triangles(surface, area, face_spacing, &all);
    if (!status) status = sample_vertices(surface, &all);
    if (!status) measure(&all, mesh_tree);
    if (!status) summarise(&all, deviation);
    lar_triangle_tree_destroy(surface_tree);
    lar_triangle_tree_destroy(mesh_tree);
    lar_triangles_clear(&fans);
    free(all.one);
    return status;
}
