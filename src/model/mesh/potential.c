#include "model/mesh/potential.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/union_find.h"
#include "base/vector.h"

/* ---- one element ---------------------------------------------------------------------------- */

enum { PAIRS = 8 * 9 / 2 };

/* Slopes of the shape functions at a point of the unit cube, times the determinant of the place by
 * the point, which is returned. */
static double slopes(const double corner[8][3], const double at[3], double slope[8][3]) {
    double own[8][3], place[3][3] = {{0}}, cofactor[3][3];
    for (int a = 0; a < 8; a++) {
        const int8_t *sign = lar_node_sign[a];
        for (int j = 0; j < 3; j++) {
            int k = (j + 1) % 3, l = (j + 2) % 3;
            own[a][j] = 0.125 * sign[j] * (1 + sign[k] * at[k]) * (1 + sign[l] * at[l]);
            for (int i = 0; i < 3; i++) place[j][i] += corner[a][i] * own[a][j];
        }
    }
    for (int j = 0; j < 3; j++) lar_cross(place[(j + 1) % 3], place[(j + 2) % 3], cofactor[j]);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++)
            slope[a][i] = own[a][0] * cofactor[0][i] + own[a][1] * cofactor[1][i] +
                          own[a][2] * cofactor[2][i];
    return lar_dot(place[0], cofactor[0]);
}

/* The upper half of the integral of grad N_a . grad N_b, row after row. */
static void element_matrix(const double corner[8][3], double matrix[PAIRS]) {
    const double FAR = 0.57735026918962576; /* 1 / sqrt(3), of Gauss's points */
    memset(matrix, 0, PAIRS * sizeof *matrix);
    for (int point = 0; point < 8; point++) {
        double at[3], slope[8][3];
        for (int i = 0; i < 3; i++) at[i] = FAR * lar_node_sign[point][i];
        double volume = slopes(corner, at, slope);
        for (int a = 0, k = 0; a < 8; a++)
            for (int b = a; b < 8; b++) matrix[k++] += lar_dot(slope[a], slope[b]) / volume;
    }
}

double lar_potential_at(const lar_mesh *mesh, const double *value, int32_t e, double gradient[3]) {
    const double centre[3] = {0, 0, 0};
    double corner[8][3], slope[8][3], mean = 0;
    lar_mesh_corners(mesh, e, corner);
    double volume = slopes((const double(*)[3])corner, centre, slope);
    memset(gradient, 0, 3 * sizeof *gradient);
    for (int a = 0; a < 8; a++) {
        double u = value[mesh->element[e][a]];
        mean += u / 8;
        for (int i = 0; i < 3; i++) gradient[i] += u * slope[a][i] / volume;
    }
    return mean;
}

/* ---- what hangs together -------------------------------------------------------------------- */

lar_status lar_potential_loose(const lar_mesh *mesh, const int32_t *element, int32_t count,
                               const uint8_t *held, int32_t *loose, int *missing,
                               lar_error *error) {
    size_t nodes = (size_t)mesh->node_count;
    int32_t *above = lar_calloc(nodes, sizeof *above);
    uint8_t *reached = above ? lar_calloc(nodes, 1) : NULL;
    *loose = -1;
    if (reached) {
        lar_union_start(above, mesh->node_count);
        for (int32_t i = 0; i < count; i++)
            for (int a = 1; a < 8; a++)
                lar_union_join(above, mesh->element[element[i]][0], mesh->element[element[i]][a]);
        for (int32_t n = 0; n < mesh->node_count; n++)
            reached[lar_union_root(above, n)] |= held[n]; /* low is one bit, high another */
        for (int32_t i = 0; i < count && *loose < 0; i++) {
            int there = reached[lar_union_root(above, mesh->element[element[i]][0])];
            if (there == (LAR_POTENTIAL_LOW | LAR_POTENTIAL_HIGH)) continue;
            *loose = element[i];
            *missing = there & LAR_POTENTIAL_LOW ? LAR_POTENTIAL_HIGH : LAR_POTENTIAL_LOW;
        }
    }
    lar_status status = reached ? LAR_OK : lar_fail_memory(error, nodes * 5, "a potential");
    free(above);
    free(reached);
    return status;
}

/* ---- conjugate gradients -------------------------------------------------------------------- */

typedef struct work {
    const lar_mesh *mesh;
    const int32_t *element;
    int32_t count;
    double (*matrix)[PAIRS]; /* [count] */
    double *inverse;         /* [nodes] of the diagonal; 0: held, or of no element */
    double *rest, *way, *image;
} work;

static void work_clear(work *w) {
    free(w->matrix);
    free(w->inverse);
}

static lar_status work_create(const uint8_t *held, work *w, lar_error *error) {
    size_t nodes = (size_t)w->mesh->node_count, elements = (size_t)w->count;
    w->matrix = lar_calloc(elements, sizeof *w->matrix);
    w->inverse = lar_calloc(4 * nodes, sizeof *w->inverse);
    if (!w->matrix || !w->inverse)
        return lar_fail_memory(error, elements * sizeof *w->matrix + 4 * nodes * sizeof(double),
                               "a potential");
    w->rest = w->inverse + nodes;
    w->way = w->rest + nodes;
    w->image = w->way + nodes;
    for (int32_t i = 0; i < w->count; i++) {
        const int32_t *node = w->mesh->element[w->element[i]];
        double corner[8][3];
        lar_mesh_corners(w->mesh, w->element[i], corner);
        element_matrix((const double(*)[3])corner, w->matrix[i]);
        for (int a = 0, k = 0; a < 8; k += 8 - a, a++)
            if (held[node[a]] == LAR_POTENTIAL_FREE) w->inverse[node[a]] += w->matrix[i][k];
    }
    for (size_t n = 0; n < nodes; n++)
        if (w->inverse[n] > 0) w->inverse[n] = 1 / w->inverse[n];
    return LAR_OK;
}

/* image = K x */
static void apply(const work *w, const double *x, double *image) {
    memset(image, 0, (size_t)w->mesh->node_count * sizeof *image);
    for (int32_t i = 0; i < w->count; i++) {
        const int32_t *node = w->mesh->element[w->element[i]];
        const double *entry = w->matrix[i];
        double in[8], out[8] = {0};
        for (int a = 0; a < 8; a++) in[a] = x[node[a]];
        for (int a = 0; a < 8; a++) {
            out[a] += *entry++ * in[a];
            for (int b = a + 1; b < 8; b++, entry++) {
                out[a] += *entry * in[b];
                out[b] += *entry * in[a];
            }
        }
        for (int a = 0; a < 8; a++) image[node[a]] += out[a];
    }
}

/* r . M^-1 r, with which free nodes alone count. */
static double square(const work *w) {
    double sum = 0;
    for (int32_t n = 0; n < w->mesh->node_count; n++)
        sum += w->rest[n] * w->rest[n] * w->inverse[n];
    return sum;
}

static bool descend(const work *w, double *value) {
    const double SMALL = 1e-26; /* of the first square: thirteen digits */
    const int32_t nodes = w->mesh->node_count, limit = nodes / 2 + 1000;
    apply(w, value, w->image);
    for (int32_t n = 0; n < nodes; n++) w->rest[n] = -w->image[n];
    double now = square(w), first = now;
    for (int32_t n = 0; n < nodes; n++) w->way[n] = w->rest[n] * w->inverse[n];
    for (int32_t step = 0; step < limit && now > SMALL * first; step++) {
        double spent = 0;
        apply(w, w->way, w->image);
        for (int32_t n = 0; n < nodes; n++) spent += w->way[n] * w->image[n];
        if (!(spent > 0)) return false;
        double far = now / spent, before = now;
        for (int32_t n = 0; n < nodes; n++) {
            value[n] += far * w->way[n];
            w->rest[n] -= far * w->image[n];
        }
        now = square(w);
        for (int32_t n = 0; n < nodes; n++)
            w->way[n] = w->rest[n] * w->inverse[n] + now / before * w->way[n];
    }
    return now <= SMALL * first;
}

lar_status lar_potential_solve(const lar_mesh *mesh, const int32_t *element, int32_t count,
                               const uint8_t *held, double *value, lar_error *error) {
    work w = {.mesh = mesh, .element = element, .count = count};
    lar_status status = work_create(held, &w, error);
    for (int32_t n = 0; n < mesh->node_count; n++) value[n] = held[n] == LAR_POTENTIAL_HIGH;
    if (!status && !descend(&w, value))
        status = lar_fail(error, LAR_ERROR_MODEL,
                          "the potential between the two cannot be computed to twelve digits; "
                          "look for elements that are nearly flat (lariat info)");
    work_clear(&w);
    return status;
}
