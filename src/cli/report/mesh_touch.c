#include "cli/report/mesh_touch.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vector.h"

/* A face by its corners in ascending order; triangles have three and -1. */
typedef struct shared_face {
    int32_t corner[4], region;
    double area;
} shared_face;

static int by_corners(const void *a, const void *b) {
    return memcmp(((const shared_face *)a)->corner, ((const shared_face *)b)->corner,
                  sizeof((const shared_face *)a)->corner);
}

static void sort_corners(int32_t corner[4]) {
    for (int i = 1; i < 4; i++)
        for (int k = i; k > 0 && corner[k - 1] > corner[k]; k--) {
            int32_t other = corner[k];
            corner[k] = corner[k - 1];
            corner[k - 1] = other;
        }
}

/* Half of the parallelogram of two diagonals, or of two edges. */
static double area_of(const double a[3], const double b[3], const double c[3], const double d[3]) {
    double first[3], second[3], across[3];
    lar_minus(c, a, first);
    lar_minus(d, b, second);
    lar_cross(first, second, across);
    return 0.5 * lar_length(across);
}

/* Adds up where equal faces belong to two regions, [regions][regions] with the lesser one first. */
static void add_shared(shared_face *face, size_t count, int32_t regions, double *area) {
    qsort(face, count, sizeof *face, by_corners);
    for (size_t i = 1; i < count; i++) {
        const int32_t a = face[i - 1].region, b = face[i].region;
        if (a == b || by_corners(&face[i - 1], &face[i]) != 0) continue;
        area[a < b ? a * regions + b : b * regions + a] += face[i].area;
    }
}

static int32_t region_of(const lar_region_info *region, int32_t regions, int32_t tag) {
    for (int32_t i = 0; i < regions; i++)
        if (region[i].tag == tag) return i;
    return -1;
}

/* False: no memory. */
static bool measure_mesh(const lar_mesh_arrays *m, const lar_region_info *region, int32_t regions,
                         double *area) {
    static const int corner[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4},
                                     {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
    shared_face *face = lar_calloc(6 * (size_t)m->elements + 1, sizeof *face);
    size_t count = 0;
    for (int32_t e = 0; face && e < m->elements; e++) {
        const int32_t mine = region_of(region, regions, m->tag[e]), *node = m->element[e];
        for (int f = 0; f < 6 && mine >= 0; f++) {
            shared_face *one = &face[count++];
            const double *at[4];
            for (int a = 0; a < 4; a++) at[a] = m->position[one->corner[a] = node[corner[f][a]]];
            one->region = mine;
            one->area = area_of(at[0], at[1], at[2], at[3]);
            sort_corners(one->corner);
        }
    }
    if (face) add_shared(face, count, regions, area);
    free(face);
    return face != NULL;
}

static bool measure_truth(const lar_meshing *meshing, int32_t regions, double *area) {
    size_t all = 0, count = 0;
    for (int32_t i = 0; i < regions; i++)
        all += (size_t)lar_meshing_region_boundary(meshing, i, NULL, NULL);
    shared_face *face = lar_calloc(all + 1, sizeof *face);
    int32_t(*triangle)[3] = lar_calloc(all + 1, sizeof *triangle);
    for (int32_t i = 0; face && triangle && i < regions; i++) {
        lar_surface_arrays s;
        lar_meshing_region_boundary(meshing, i, triangle, &s);
        for (int32_t t = 0; t < s.triangles; t++) {
            shared_face *one = &face[count++];
            const double *at[3];
            for (int a = 0; a < 3; a++) at[a] = s.vertex[one->corner[a] = triangle[t][a]];
            one->corner[3] = -1;
            one->region = i;
            one->area = area_of(at[0], at[0], at[1], at[2]);
            sort_corners(one->corner);
        }
    }
    const bool done = face && triangle;
    if (done) add_shared(face, count, regions, area);
    free(face);
    free(triangle);
    return done;
}

/* Whether a ray along x from there leaves a closed surface once more than it enters it. */
static bool is_inside(const lar_surface_arrays *s, const double at[3]) {
    bool inside = false;
    for (int32_t t = 0; t < s->triangles; t++) {
        const double *a = s->vertex[s->triangle[t][0]], *b = s->vertex[s->triangle[t][1]],
                     *c = s->vertex[s->triangle[t][2]];
        if ((a[1] > at[1]) == (b[1] > at[1]) && (a[1] > at[1]) == (c[1] > at[1])) continue;
        const double u = (b[1] - at[1]) * (c[2] - at[2]) - (b[2] - at[2]) * (c[1] - at[1]);
        const double v = (c[1] - at[1]) * (a[2] - at[2]) - (c[2] - at[2]) * (a[1] - at[1]);
        const double w = (a[1] - at[1]) * (b[2] - at[2]) - (a[2] - at[2]) * (b[1] - at[1]);
        if (((u > 0) != (v > 0)) || ((u > 0) != (w > 0))) continue;
        inside ^= (u * a[0] + v * b[0] + w * c[0]) / (u + v + w) > at[0];
    }
    return inside;
}

/* Surfaces may lie in each other, and each knows nothing of the others: the last one that holds a
 * place has it. What lies outside of some hundred triangles of region i, for all of them. */
static void sample_nested(const lar_surface_arrays *s, int32_t regions, int32_t i, double way,
                          double *area) {
    enum { SAMPLES = 1000 };
    const int32_t each = 1 + s[i].triangles / SAMPLES;
    for (int32_t t = 0; t < s[i].triangles; t += each) {
        const int32_t *corner = s[i].triangle[t];
        double at[3], first[3], second[3], across[3];
        const double *a = s[i].vertex[corner[0]], *b = s[i].vertex[corner[1]],
                     *c = s[i].vertex[corner[2]];
        lar_minus(b, a, first);
        lar_minus(c, a, second);
        lar_cross(first, second, across);
        const double twice = lar_length(across);
        if (!(twice > 0)) continue;
        for (int k = 0; k < 3; k++) at[k] = (a[k] + b[k] + c[k]) / 3 + way * across[k] / twice;
        int32_t there = regions - 1;
        while (there >= 0 && (there == i || !is_inside(&s[there], at))) there--;
        if (there >= 0 && there < i) area[there * regions + i] += 0.5 * twice * each;
    }
}

static bool measure_nested(const lar_meshing *meshing, int32_t regions, double size, double *area) {
    lar_surface_arrays *s = lar_calloc((size_t)regions, sizeof *s);
    bool done = s != NULL;
    for (int32_t i = 0; done && i < regions; i++) {
        const int32_t count = lar_meshing_region_boundary(meshing, i, NULL, NULL);
        int32_t(*triangle)[3] = lar_calloc((size_t)count + 1, sizeof *triangle);
        done = triangle != NULL;
        if (done) lar_meshing_region_boundary(meshing, i, triangle, &s[i]);
    }
    for (int32_t i = 1; done && i < regions; i++) sample_nested(s, regions, i, 1e-3 * size, area);
    for (int32_t i = 0; s && i < regions; i++) free((void *)(uintptr_t)s[i].triangle);
    free(s);
    return done;
}

static int by_excess(const void *a, const void *b) {
    const mesh_touch *x = a, *y = b;
    const double one = x->area - x->wanted, other = y->area - y->wanted;
    return (one < other) - (one > other);
}

/* `got` and `wanted`: as of add_shared. */
static mesh_touch *list_touches(const double *got, const double *wanted, int32_t regions,
                                double face, int32_t *count) {
    static const double PART = 1, FACES = 8;
    mesh_touch *list = lar_calloc((size_t)regions * (size_t)regions, sizeof *list);
    for (int32_t i = 0; list && i < regions * regions; i++) {
        if (!(got[i] > (1 + PART) * wanted[i] + FACES * face)) continue;
        list[(*count)++] = (mesh_touch){{i / regions, i % regions}, got[i], wanted[i]};
    }
    if (list) qsort(list, (size_t)*count, sizeof *list, by_excess);
    if (*count > 0) return list;
    free(list);
    return NULL;
}

mesh_touch *mesh_touches(const lar_meshing *meshing, int32_t *count) {
    enum { MANY = 1000 };
    lar_meshing_info info;
    lar_mesh_arrays mesh;
    mesh_touch *list = NULL;
    *count = 0;
    lar_meshing_inspect(meshing, &info);
    lar_meshing_arrays(meshing, &mesh, NULL);
    const int32_t regions = info.regions;
    if (regions < 2 || regions > MANY) return NULL;
    lar_region_info *region = lar_calloc((size_t)regions, sizeof *region);
    double *area = lar_calloc(2 * (size_t)regions * (size_t)regions, sizeof *area);
    double *wanted = area ? area + (size_t)regions * (size_t)regions : NULL;
    for (int32_t i = 0; region && i < regions; i++)
        lar_meshing_region(meshing, i, &region[i], NULL);
    if (region && area && measure_mesh(&mesh, region, regions, area) &&
        (info.image ? measure_truth(meshing, regions, wanted)
                    : measure_nested(meshing, regions, info.size, wanted)))
        list = list_touches(area, wanted, regions, info.size * info.size, count);
    free(region);
    free(area);
    return list;
}
