#include "meshing/boundary/boundary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "meshing/grid/voxel_grid.h"
#include "model/triangles/tree.h"

void lar_boundary_clear(lar_boundary *boundary) {
    lar_triangles_clear(&boundary->triangles);
    free(boundary->side);
    for (int32_t r = 0; boundary->region && r <= boundary->region_count; r++)
        free(boundary->region[r].name);
    free(boundary->region);
    free(boundary->region_of_label);
    *boundary = (lar_boundary){0};
}

bool lar_boundary_between(const lar_boundary *boundary, int32_t t, int a, int b) {
    const uint16_t *side = boundary->side[t];
    /* A later surface has the place: what lies between two regions is the later one's surface. */
    if (boundary->nested) return a != b && side[1] == (a > b ? a : b);
    return (side[0] == a && side[1] == b) || (side[0] == b && side[1] == a);
}

/* ---- from closed surfaces ------------------------------------------------------------------- */

static lar_status check_surface(lar_triangles *surface, lar_error *error) {
    const char *source = surface->source ? surface->source : "surface";
    if (surface->triangle_count == 0)
        return lar_fail(error, LAR_ERROR_MODEL, "%s: the surface has no triangles", source);
    lar_status status = lar_triangles_close(surface, NULL, error);
    if (!status) status = lar_triangles_check_crossing(surface, error);
    if (status) return status;
    if (lar_triangles_volume(surface) > 0) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: the surface encloses no volume; it must go around the body", source);
}

static lar_status allocate(const lar_triangles *surfaces, int32_t count, lar_boundary *boundary,
                           lar_error *error) {
    size_t vertices = 0, triangles = 0;
    for (int32_t s = 0; s < count; s++) {
        vertices += (size_t)surfaces[s].vertex_count;
        triangles += (size_t)surfaces[s].triangle_count;
    }
    if (vertices > INT32_MAX || triangles > INT32_MAX)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "the surfaces have %zu triangles together, more than %d; take coarser ones",
                        triangles, INT32_MAX);
    boundary->triangles.vertex = lar_calloc(vertices, sizeof *boundary->triangles.vertex);
    boundary->triangles.corner = lar_calloc(triangles, sizeof *boundary->triangles.corner);
    boundary->side = lar_calloc(triangles, sizeof *boundary->side);
    boundary->region = lar_calloc((size_t)count + 1, sizeof *boundary->region);
    boundary->triangles.source = lar_strdup(surfaces[0].source ? surfaces[0].source : "surface");
    if (boundary->triangles.vertex && boundary->triangles.corner && boundary->side &&
        boundary->region && boundary->triangles.source)
        return LAR_OK;
    return lar_fail_memory(error, 24 * vertices + 16 * triangles, "the surfaces together");
}

static lar_status add_surface(const lar_triangles *surface, const char *name,
                              lar_boundary *boundary, lar_error *error) {
    lar_triangles *all = &boundary->triangles;
    int32_t region = ++boundary->region_count;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        int32_t at = all->triangle_count++;
        for (int c = 0; c < 3; c++) all->corner[at][c] = all->vertex_count + surface->corner[t][c];
        boundary->side[at][1] = (uint16_t)region;
    }
    memcpy(all->vertex + all->vertex_count, surface->vertex,
           (size_t)surface->vertex_count * sizeof *all->vertex);
    all->vertex_count += surface->vertex_count;
    boundary->region[region].tag = region;
    boundary->region[region].volume = lar_triangles_volume(surface);
    boundary->region[region].name = lar_strdup(name);
    return boundary->region[region].name ? LAR_OK : lar_fail_memory(error, 64, "a name");
}

static void find_box(const lar_triangles *triangles, double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) low[a] = INFINITY, high[a] = -INFINITY;
    for (int32_t v = 0; v < triangles->vertex_count; v++)
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], triangles->vertex[v][a]);
            high[a] = fmax(high[a], triangles->vertex[v][a]);
        }
}

static bool boxes_meet(const lar_triangles *a, const lar_triangles *b) {
    double low[2][3], high[2][3];
    find_box(a, low[0], high[0]);
    find_box(b, low[1], high[1]);
    for (int i = 0; i < 3; i++)
        if (low[0][i] > high[1][i] || low[1][i] > high[0][i]) return false;
    return true;
}

/* Surfaces that stay clear of each other enclose what they enclose; others are measured on the
 * lines of a grid, 4 x 256 across the body. */
static lar_status find_volumes(const lar_triangles *surfaces, int32_t count, lar_boundary *boundary,
                               lar_error *error) {
    enum { CELLS_ACROSS = 256 };
    bool meet = false;
    for (int32_t a = 0; a < count && !meet; a++)
        for (int32_t b = 0; b < a && !meet; b++) meet = boxes_meet(&surfaces[a], &surfaces[b]);
    if (!meet) return LAR_OK;
    double low[3], high[3], volume[LAR_REGIONS_MAX + 1] = {0};
    find_box(&boundary->triangles, low, high);
    double widest = fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2]));
    lar_status status = lar_voxel_grid_measure(boundary, widest / CELLS_ACROSS, volume, error);
    for (int32_t r = 1; r <= count && !status; r++) boundary->region[r].volume = volume[r];
    return status;
}

static lar_status join_surfaces(lar_triangles *surfaces, const char *const *names, int32_t count,
                                lar_boundary *boundary, lar_error *error) {
    if (count < 1 || count > LAR_REGIONS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d surfaces cannot be meshed together; name 1 to %d", (int)count,
                        (int)LAR_REGIONS_MAX);
    lar_status status = LAR_OK;
    for (int32_t s = 0; s < count && !status; s++) status = check_surface(&surfaces[s], error);
    if (!status) status = allocate(surfaces, count, boundary, error);
    for (int32_t s = 0; s < count && !status; s++)
        status = add_surface(&surfaces[s], names[s], boundary, error);
    boundary->nested = count > 1;
    for (int a = 0; a < 3; a++) boundary->axis[a][a] = 1;
    if (!status) status = find_volumes(surfaces, count, boundary, error);
    return status;
}

lar_status lar_boundary_from_surfaces(lar_triangles *surfaces, const char *const *names,
                                      int32_t count, lar_boundary *boundary, lar_error *error) {
    *boundary = (lar_boundary){0};
    lar_status status = join_surfaces(surfaces, names, count, boundary, error);
    for (int32_t s = 0; s < count; s++) lar_triangles_clear(&surfaces[s]);
    if (status) lar_boundary_clear(boundary);
    return status;
}

/* ---- principal axes ------------------------------------------------------------------------- */

/* Second moments of the body about its middle: the sum over the pyramids from a point to the
 * triangles around it. Where surfaces overlap the place counts for each. */
static double find_moments(const lar_boundary *boundary, double moment[3][3]) {
    const lar_triangles *triangles = &boundary->triangles;
    double volume = 0, first[3] = {0};
    for (int32_t t = 0; t < triangles->triangle_count; t++) {
        if (lar_boundary_region(boundary->side[t][0]) != 0) continue;
        double x[3][3], normal[3], sum[3];
        for (int c = 0; c < 3; c++)
            lar_minus(triangles->vertex[triangles->corner[t][c]], triangles->vertex[0], x[c]);
        lar_cross(x[1], x[2], normal);
        double part = lar_dot(x[0], normal) / 6;
        volume += part;
        for (int a = 0; a < 3; a++) sum[a] = x[0][a] + x[1][a] + x[2][a];
        for (int a = 0; a < 3; a++) {
            first[a] += part * sum[a] / 4;
            for (int b = 0; b < 3; b++) {
                double corners = x[0][a] * x[0][b] + x[1][a] * x[1][b] + x[2][a] * x[2][b];
                moment[a][b] += part * (sum[a] * sum[b] + corners) / 20;
            }
        }
    }
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) moment[a][b] -= first[a] * first[b] / volume;
    return volume;
}

/* Jacobi's rotations: the rows of `axis` become eigenvectors, the diagonal of m eigenvalues. */
static void diagonalise(double m[3][3], double axis[3][3]) {
    enum { SWEEPS = 20 };
    for (int turn = 0; turn < 3 * SWEEPS; turn++) {
        int p = turn % 3, q = (turn + 1) % 3;
        double largest = fabs(m[0][0]) + fabs(m[1][1]) + fabs(m[2][2]);
        if (!(fabs(m[p][q]) > 1e-15 * largest)) continue;
        double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
        double c = 1 / sqrt(t * t + 1), s = t * c;
        for (int i = 0; i < 3; i++) {
            double mp = m[i][p], mq = m[i][q];
            m[i][p] = c * mp - s * mq;
            m[i][q] = s * mp + c * mq;
        }
        for (int i = 0; i < 3; i++) {
            double mp = m[p][i], mq = m[q][i], ap = axis[p][i], aq = axis[q][i];
            m[p][i] = c * mp - s * mq;
            m[q][i] = s * mp + c * mq;
            axis[p][i] = c * ap - s * aq;
            axis[q][i] = s * ap + c * aq;
        }
    }
}

lar_status lar_boundary_principal_axes(lar_boundary *boundary, lar_error *error) {
    double moment[3][3] = {{0}}, axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double volume = find_moments(boundary, moment);
    if (!(volume > 0 && isfinite(volume)))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "the body has no principal axes: its surface encloses no volume");
    diagonalise(moment, axis);
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2 - i; j++)
            if (moment[order[j]][order[j]] < moment[order[j + 1]][order[j + 1]]) {
                int swap = order[j];
                order[j] = order[j + 1];
                order[j + 1] = swap;
            }
    for (int a = 0; a < 2; a++) {
        const double *from = axis[order[a]];
        int largest = 0;
        for (int b = 1; b < 3; b++)
            if (fabs(from[b]) > fabs(from[largest])) largest = b;
        for (int b = 0; b < 3; b++) boundary->axis[a][b] = from[largest] < 0 ? -from[b] : from[b];
    }
    lar_cross(boundary->axis[0], boundary->axis[1], boundary->axis[2]);
    return LAR_OK;
}

/* ---- what is seen from outside -------------------------------------------------------------- */

typedef struct line_test {
    const lar_boundary *boundary;
    double point[3];
    int32_t own, first; /* surfaces that count: of regions from `first` on, but for `own` */
    int crossings;
} line_test;

/* Crossings of the line from the point along +x; sides of edges as in
 * grid/voxel_grid_fill.c, but in floating point: good enough for a picture. */
static bool cross_triangle(void *context, int32_t t) {
    line_test *test = context;
    const lar_boundary *boundary = test->boundary;
    const int32_t region = boundary->side[t][1];
    if (region == test->own || region < test->first) return true;
    const int32_t *corner = boundary->triangles.corner[t];
    const double *x[3];
    double weight[3], whole = 0, at = 0;
    for (int c = 0; c < 3; c++) x[c] = boundary->triangles.vertex[corner[c]];
    for (int c = 0; c < 3; c++) {
        const double *a = x[(c + 1) % 3], *b = x[(c + 2) % 3];
        weight[c] = (a[1] - test->point[1]) * (b[2] - test->point[2]) -
                    (a[2] - test->point[2]) * (b[1] - test->point[1]);
        whole += weight[c];
        at += weight[c] * x[c][0];
    }
    bool positive = weight[0] > 0 && weight[1] > 0 && weight[2] > 0;
    bool negative = weight[0] < 0 && weight[1] < 0 && weight[2] < 0;
    if ((positive || negative) && at / whole > test->point[0]) test->crossings += positive ? 1 : -1;
    return true;
}

static bool held_by_another(const lar_triangle_tree *tree, line_test *test, const double high[3]) {
    double end[3] = {high[0], test->point[1], test->point[2]};
    test->crossings = 0;
    lar_triangle_tree_boxes(tree, test->point, end, 0, cross_triangle, test);
    return test->crossings > 0;
}

/* Nobody else has the place in front of the triangle, and no later one that behind it: of surfaces
 * that lie on each other none is seen where bodies touch, and the last one where they end together.
 */
static bool is_seen(const lar_triangle_tree *tree, const lar_boundary *boundary,
                    const double low[3], const double high[3], int32_t t) {
    /* Of the triangle and of all: farther than rounding of what lies on it. */
    const double NEAR = 1e-3, MIN = 1e-6;
    const int32_t *corner = boundary->triangles.corner[t], own = boundary->side[t][1];
    double normal[3], diagonal[3], middle[3] = {0};
    lar_triangles_normal(&boundary->triangles, t, normal);
    lar_minus(high, low, diagonal);
    const double length = lar_length(normal);
    const double step = NEAR * sqrt(length) + MIN * lar_length(diagonal);
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++) middle[a] += boundary->triangles.vertex[corner[c]][a] / 3;
    for (int behind = 0; behind < 2; behind++) {
        line_test test = {.boundary = boundary, .own = own, .first = behind ? own : 0};
        for (int a = 0; a < 3; a++) {
            const double out = length > 0 ? normal[a] / length : 0;
            test.point[a] = middle[a] + (behind ? -step : step) * out;
        }
        if (held_by_another(tree, &test, high)) return false;
    }
    return true;
}

/* seen[t]: triangle t is seen from outside. */
static lar_status find_seen(const lar_boundary *boundary, bool *seen, lar_error *error) {
    const lar_triangles *triangles = &boundary->triangles;
    for (int32_t t = 0; t < triangles->triangle_count; t++)
        seen[t] = lar_boundary_region(boundary->side[t][0]) == 0;
    if (!boundary->nested) return LAR_OK;
    lar_triangle_tree *tree = NULL;
    lar_status status =
        lar_triangle_tree_create(triangles, NULL, triangles->triangle_count, &tree, error);
    double low[3], high[3];
    find_box(triangles, low, high);
    for (int32_t t = 0; t < triangles->triangle_count && !status; t++)
        seen[t] = is_seen(tree, boundary, low, high, t);
    lar_triangle_tree_destroy(tree);
    return status;
}

static lar_status take_seen(const lar_boundary *boundary, const bool *seen, lar_triangles *outer,
                            lar_error *error) {
    const lar_triangles *from = &boundary->triangles;
    size_t triangles = 0, vertices = (size_t)from->vertex_count;
    for (int32_t t = 0; t < from->triangle_count; t++) triangles += seen[t];
    int32_t *number = lar_calloc(vertices, sizeof *number);
    outer->vertex = lar_calloc(vertices, sizeof *outer->vertex);
    outer->corner = lar_calloc(triangles, sizeof *outer->corner);
    outer->tag = lar_calloc(triangles, sizeof *outer->tag);
    outer->source = lar_strdup(from->source ? from->source : "surface");
    if (!number || !outer->vertex || !outer->corner || !outer->tag || !outer->source) {
        free(number);
        return lar_fail_memory(error, 28 * vertices + 16 * triangles, "the outer surface");
    }
    for (int32_t t = 0; t < from->triangle_count; t++) {
        if (!seen[t]) continue;
        for (int c = 0; c < 3; c++) {
            int32_t v = from->corner[t][c];
            if (!number[v]) {
                memcpy(outer->vertex[outer->vertex_count], from->vertex[v], sizeof *outer->vertex);
                number[v] = ++outer->vertex_count;
            }
            outer->corner[outer->triangle_count][c] = number[v] - 1;
        }
        outer->tag[outer->triangle_count++] = boundary->region[boundary->side[t][1]].tag;
    }
    free(number);
    return LAR_OK;
}

lar_status lar_boundary_outer(const lar_boundary *boundary, lar_triangles *outer,
                              lar_error *error) {
    lar_triangles made = {0};
    bool *seen = lar_calloc((size_t)boundary->triangles.triangle_count, sizeof *seen);
    lar_status status = seen ? LAR_OK
                             : lar_fail_memory(error, (size_t)boundary->triangles.triangle_count,
                                               "the outer surface");
    if (!status) status = find_seen(boundary, seen, error);
    if (!status) status = take_seen(boundary, seen, &made, error);
    free(seen);
    if (status)
        lar_triangles_clear(&made);
    else
        *outer = made;
    return status;
}
