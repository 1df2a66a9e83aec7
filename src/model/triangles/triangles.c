#include "model/triangles/triangles.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/vector.h"

void lar_triangles_clear(lar_triangles *triangles) {
    free(triangles->source);
    free(triangles->vertex);
    free(triangles->corner);
    free(triangles->tag);
    *triangles = (lar_triangles){0};
}

void lar_triangles_normal(const lar_triangles *triangles, int32_t triangle, double normal[3]) {
    const int32_t *corner = triangles->corner[triangle];
    const double *from = triangles->vertex[corner[0]];
    double e[3], f[3];
    lar_minus(triangles->vertex[corner[1]], from, e);
    lar_minus(triangles->vertex[corner[2]], from, f);
    lar_cross(e, f, normal);
}

void lar_triangles_part(const lar_triangles *triangles, int32_t triangle, int cuts, int part,
                        double middle[3]) {
    const int32_t *corner = triangles->corner[triangle];
    const double *x[3];
    for (int c = 0; c < 3; c++) x[c] = triangles->vertex[corner[c]];
    const int i = part / cuts, j = part % cuts;
    const bool upright = i + j < cuts;
    const double a = (upright ? i + 1.0 / 3 : cuts - i - 1.0 / 3) / cuts;
    const double b = (upright ? j + 1.0 / 3 : cuts - j - 1.0 / 3) / cuts;
    for (int d = 0; d < 3; d++)
        middle[d] = x[0][d] + a * (x[1][d] - x[0][d]) + b * (x[2][d] - x[0][d]);
}

/* Seen from the first vertex, not from the origin: a body far from it would lose its digits. */
double lar_triangles_volume(const lar_triangles *triangles) {
    double volume = 0;
    for (int32_t t = 0; t < triangles->triangle_count; t++) {
        double c[3][3], turned[3];
        for (int a = 0; a < 3; a++)
            lar_minus(triangles->vertex[triangles->corner[t][a]], triangles->vertex[0], c[a]);
        lar_cross(c[1], c[2], turned);
        volume += lar_dot(c[0], turned);
    }
    return volume / 6;
}

double lar_triangles_area(const lar_triangles *triangles) {
    double area = 0;
    for (int32_t t = 0; t < triangles->triangle_count; t++) {
        double normal[3];
        lar_triangles_normal(triangles, t, normal);
        area += lar_length(normal);
    }
    return area / 2;
}

/* ---- joining ------------------------------------------------------------------------------ */

typedef struct place {
    double at[3];
    int32_t vertex;
} place;

static int by_place(const void *a, const void *b) {
    const place *p = a, *q = b;
    for (int i = 0; i < 3; i++)
        if (p->at[i] != q->at[i]) return p->at[i] < q->at[i] ? -1 : 1;
    return (p->vertex > q->vertex) - (p->vertex < q->vertex);
}

/* same[vertex]: the first vertex at its place. Sorted, not hashed: no file can make it slow. */
static void find_same(const lar_triangles *triangles, place *sorted, int32_t *same) {
    int32_t count = triangles->vertex_count;
    for (int32_t v = 0; v < count; v++) {
        memcpy(sorted[v].at, triangles->vertex[v], sizeof sorted[v].at);
        sorted[v].vertex = v;
    }
    qsort(sorted, (size_t)count, sizeof *sorted, by_place);
    int32_t first = 0;
    for (int32_t k = 0; k < count; k++) {
        const double *at = sorted[k].at, *before = sorted[first].at;
        if (at[0] != before[0] || at[1] != before[1] || at[2] != before[2]) first = k;
        same[sorted[k].vertex] = sorted[first].vertex;
    }
}

/* Triangles get the first vertices; those with a corner twice go. */
static void rename_corners(lar_triangles *triangles, const int32_t *same) {
    int32_t kept = 0;
    for (int32_t t = 0; t < triangles->triangle_count; t++) {
        int32_t corner[3];
        for (int a = 0; a < 3; a++) corner[a] = same[triangles->corner[t][a]];
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
        if (triangles->tag) triangles->tag[kept] = triangles->tag[t];
        memcpy(triangles->corner[kept++], corner, sizeof corner);
    }
    triangles->triangle_count = kept;
}

/* Vertices without a triangle go; the order of the others stays. `number` is scratch. */
static void drop_vertices(lar_triangles *triangles, int32_t *number) {
    for (int32_t v = 0; v < triangles->vertex_count; v++) number[v] = -1;
    for (int32_t t = 0; t < triangles->triangle_count; t++)
        for (int a = 0; a < 3; a++) number[triangles->corner[t][a]] = 0;
    int32_t kept = 0;
    for (int32_t v = 0; v < triangles->vertex_count; v++) {
        if (number[v] < 0) continue;
        if (kept != v)
            memcpy(triangles->vertex[kept], triangles->vertex[v], sizeof *triangles->vertex);
        number[v] = kept++;
    }
    triangles->vertex_count = kept;
    for (int32_t t = 0; t < triangles->triangle_count; t++)
        for (int a = 0; a < 3; a++) triangles->corner[t][a] = number[triangles->corner[t][a]];
}

lar_status lar_triangles_join(lar_triangles *triangles, lar_error *error) {
    size_t vertices = (size_t)triangles->vertex_count;
    place *sorted = lar_calloc(vertices, sizeof *sorted);
    int32_t *same = lar_calloc(vertices, sizeof *same);
    lar_status status = LAR_OK;
    if (sorted && same) {
        find_same(triangles, sorted, same);
        rename_corners(triangles, same);
        drop_vertices(triangles, same);
    } else {
        status = lar_fail_memory(error, vertices * (sizeof *sorted + sizeof *same),
                                 "joining the corners of triangles");
    }
    free(sorted);
    free(same);
    return status;
}

/* ---- reading ------------------------------------------------------------------------------ */

typedef struct surface_format {
    const char *extension;
    lar_status (*parse)(const char *path, const lar_bytes *bytes, lar_triangles *triangles,
                        lar_error *error);
} surface_format;

static const surface_format formats[] = {
    {"stl", lar_stl_parse},
    {"obj", lar_obj_parse},
    {"vtk", lar_vtk_surface_parse},
    {"vtp", lar_vtp_parse},
};
enum { FORMAT_COUNT = sizeof formats / sizeof *formats };

static const surface_format *find_format(const char *path) {
    const char *extension = lar_path_extension(path);
    for (int i = 0; i < FORMAT_COUNT; i++)
        if (strcasecmp(extension, formats[i].extension) == 0) return &formats[i];
    return NULL;
}

bool lar_triangles_named(const char *path) {
    return find_format(path) != NULL;
}

/* Beyond FARTHEST metres products of coordinates would leave the range of a double. */
static lar_status scale_vertices(const char *path, double scale, lar_triangles *triangles,
                                 lar_error *error) {
    const double FARTHEST = 1e30;
    for (int32_t v = 0; v < triangles->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            double at = triangles->vertex[v][i] *= scale;
            if (!(fabs(at) < FARTHEST))
                return lar_fail(error, LAR_ERROR_FORMAT,
                                "%s: vertex %" PRId32
                                " (from 0) has a coordinate of %g m, which no body has; write the "
                                "file again or check the scale",
                                path, v, at);
        }
    return LAR_OK;
}

lar_status lar_triangles_settle(lar_triangles *triangles, const char *name, double scale,
                                lar_error *error) {
    lar_status status = scale_vertices(name, scale, triangles, error);
    if (!status) status = lar_triangles_join(triangles, error);
    if (!status && triangles->triangle_count == 0)
        status =
            lar_fail(error, LAR_ERROR_FORMAT,
                     "%s: has no triangle with an area, so it is no surface; check the file", name);
    if (!status && !(triangles->source = lar_strdup(name)))
        status = lar_fail_memory(error, strlen(name) + 1, name);
    return status;
}

lar_status lar_triangles_read(const char *path, double scale, lar_triangles *triangles,
                              lar_error *error) {
    const surface_format *format = find_format(path);
    if (!format)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: no surface format has this extension; the known ones are .stl .obj "
                        ".vtk .vtp",
                        path);
    if (!isfinite(scale) || !(scale > 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s: the scale %g is not a positive number; 0.001 turns millimetres into "
                        "metres",
                        path, scale);
    lar_bytes bytes = {0};
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    lar_triangles read = {0};
    status = format->parse(path, &bytes, &read, error);
    if (!status) status = lar_triangles_settle(&read, path, scale, error);
    lar_bytes_free(&bytes);
    if (status)
        lar_triangles_clear(&read);
    else
        *triangles = read;
    return status;
}
