#include "meshing/elastic_coarse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"

/* ---- groups --------------------------------------------------------------------------------- */

/* About so many boxes, of two elements at least. */
static double box_size(const lar_elastic *elastic) {
    static const double BOXES = 160, LEAST = 2;
    double volume = 0;
    for (int32_t k = 0; k < elastic->element_count; k++) volume += elastic->element[k].volume;
    double edge = cbrt(volume / fmax(1, elastic->element_count));
    return fmax(LEAST * edge, cbrt(volume / BOXES));
}

typedef struct place {
    double at;
    int32_t root;
} place;

static int compare(const void *a, const void *b) {
    const place *p = a, *q = b;
    if (p->at != q->at) return p->at < q->at ? -1 : 1;
    return (p->root > q->root) - (p->root < q->root);
}

static bool same_box(const double a[3], const double b[3], double box) {
    for (int i = 0; i < 3; i++)
        if (floor(a[i] / box) != floor(b[i] / box)) return false;
    return true;
}

static int longest_axis(const lar_mesh *mesh) {
    double lower[3], upper[3];
    int axis = 0;
    for (int i = 0; i < 3; i++) {
        lower[i] = upper[i] = mesh->position[0][i];
        for (int32_t n = 1; n < mesh->node_count; n++) {
            lower[i] = fmin(lower[i], mesh->position[n][i]);
            upper[i] = fmax(upper[i], mesh->position[n][i]);
        }
        if (upper[i] - lower[i] > upper[axis] - lower[axis]) axis = i;
    }
    return axis;
}

/* Groups are numbered along the body, so that those that know each other have near numbers. */
static void number_groups(lar_coarse *coarse, const lar_elastic *elastic, int32_t *parent,
                          place *groups) {
    const lar_mesh *mesh = elastic->mesh;
    int axis = longest_axis(mesh);
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (!elastic->still[n] && lar_union_root(parent, n) == n)
            groups[coarse->group_count++] = (place){mesh->position[n][axis], n};
    qsort(groups, (size_t)coarse->group_count, sizeof *groups, compare);
    for (int32_t n = 0; n < mesh->node_count; n++) coarse->group[n] = -1;
    for (int32_t g = 0; g < coarse->group_count; g++) coarse->group[groups[g].root] = g;
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (!elastic->still[n]) coarse->group[n] = coarse->group[lar_union_root(parent, n)];
}

static lar_status find_groups(lar_coarse *coarse, const lar_elastic *elastic, double box,
                              lar_error *error) {
    const lar_mesh *mesh = elastic->mesh;
    size_t nodes = (size_t)mesh->node_count;
    int32_t *parent = lar_calloc(nodes, sizeof *parent);
    place *groups = lar_calloc(nodes, sizeof *groups);
    if (parent && groups) {
        lar_union_start(parent, mesh->node_count);
        for (int32_t k = 0; k < elastic->element_count; k++) {
            const int32_t *node = elastic->element[k].node;
            for (int a = 0; a < 8; a++)
                for (int b = 0; b < a; b++)
                    if (!elastic->still[node[a]] && !elastic->still[node[b]] &&
                        same_box(mesh->position[node[a]], mesh->position[node[b]], box))
                        lar_union_join(parent, node[a], node[b]);
        }
        number_groups(coarse, elastic, parent, groups);
    }
    bool ready = parent && groups;
    free(parent);
    free(groups);
    return ready ? LAR_OK : lar_fail_memory(error, 20 * nodes, "groups of nodes");
}

static lar_status find_arms(lar_coarse *coarse, const lar_mesh *mesh, double box,
                            lar_error *error) {
    double(*sum)[4] = lar_calloc((size_t)coarse->group_count, sizeof *sum);
    if (!sum) return lar_fail_memory(error, 32 * (size_t)coarse->group_count, "groups of nodes");
    for (int32_t n = 0; n < mesh->node_count; n++) {
        if (coarse->group[n] < 0) continue;
        double *s = sum[coarse->group[n]];
        for (int i = 0; i < 3; i++) s[i] += mesh->position[n][i];
        s[3]++;
    }
    for (int32_t n = 0; n < mesh->node_count; n++) {
        if (coarse->group[n] < 0) continue;
        const double *s = sum[coarse->group[n]];
        for (int i = 0; i < 3; i++) coarse->arm[n][i] = (mesh->position[n][i] - s[i] / s[3]) / box;
    }
    free(sum);
    return LAR_OK;
}

/* ---- the matrix ----------------------------------------------------------------------------- */

/* How axis i of a node moves with its group's motion d: translations, then rotations. */
static double share(const double arm[3], int i, int d) {
    if (d < 3) return i == d;
    d -= 3;
    if (i == d) return 0;
    return (d + 1) % 3 == i ? -arm[3 - i - d] : arm[3 - i - d];
}

/* Whether the element resists the groups' motions: not when it moves along with one of them. */
static bool resists(const lar_coarse *coarse, const lar_elastic_element *e) {
    for (int a = 1; a < 8; a++)
        if (coarse->group[e->node[a]] != coarse->group[e->node[0]]) return true;
    return false;
}

static lar_status lay_rows(lar_coarse *coarse, const lar_elastic *elastic, lar_error *error) {
    int32_t rows = LAR_RIGID * coarse->group_count;
    coarse->first = lar_calloc((size_t)rows, sizeof *coarse->first);
    coarse->start = lar_calloc((size_t)rows + 1, sizeof *coarse->start);
    coarse->load = lar_calloc((size_t)rows, sizeof *coarse->load);
    if (!coarse->first || !coarse->start || !coarse->load)
        return lar_fail_memory(error, 44 * (size_t)rows, "a coarse matrix");
    for (int32_t r = 0; r < rows; r++) coarse->first[r] = r - r % LAR_RIGID;
    for (int32_t k = 0; k < elastic->element_count; k++) {
        const lar_elastic_element *e = &elastic->element[k];
        int32_t least = coarse->group_count;
        for (int a = 0; a < 8; a++)
            if (coarse->group[e->node[a]] >= 0 && coarse->group[e->node[a]] < least)
                least = coarse->group[e->node[a]];
        for (int a = 0; a < 8; a++)
            for (int d = 0; d < LAR_RIGID && coarse->group[e->node[a]] >= 0; d++) {
                int32_t *first = &coarse->first[LAR_RIGID * coarse->group[e->node[a]] + d];
                if (LAR_RIGID * least < *first) *first = LAR_RIGID * least;
            }
    }
    for (int32_t r = 0; r < rows; r++)
        coarse->start[r + 1] = coarse->start[r] + (size_t)(r - coarse->first[r] + 1);
    coarse->factor = lar_calloc(coarse->start[rows], sizeof *coarse->factor);
    if (!coarse->factor) return lar_fail_memory(error, 8 * coarse->start[rows], "a coarse matrix");
    return LAR_OK;
}

static double *entry(lar_coarse *coarse, int32_t row, int32_t column) {
    return &coarse->factor[coarse->start[row] + (size_t)(column - coarse->first[row])];
}

/* Adds P^T K P of two of the element's nodes. */
static void add_pair(lar_coarse *coarse, const int32_t *node, double K[24][24], int a, int b) {
    int32_t row = LAR_RIGID * coarse->group[node[a]], column = LAR_RIGID * coarse->group[node[b]];
    if (row < 0 || column < 0 || row < column) return;
    double KP[3][LAR_RIGID] = {{0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int d = 0; d < LAR_RIGID; d++)
                KP[i][d] += K[3 * a + i][3 * b + j] * share(coarse->arm[node[b]], j, d);
    for (int c = 0; c < LAR_RIGID; c++)
        for (int d = 0; d < LAR_RIGID; d++) {
            double sum = 0;
            for (int i = 0; i < 3; i++) sum += share(coarse->arm[node[a]], i, c) * KP[i][d];
            if (column + d <= row + c) *entry(coarse, row + c, column + d) += sum;
        }
}

static void fill_rows(lar_coarse *coarse, const lar_elastic *elastic) {
    for (int32_t k = 0; k < elastic->element_count; k++) {
        const lar_elastic_element *e = &elastic->element[k];
        double K[24][24];
        if (!resists(coarse, e)) continue;
        lar_elastic_element_matrix(e, K);
        for (int a = 0; a < 8; a++)
            for (int b = 0; b < 8; b++) add_pair(coarse, e->node, K, a, b);
    }
}

static double dot(const double *a, const double *b, size_t count) {
    double sum[4] = {0};
    size_t k = 0;
    for (; k + 4 <= count; k += 4)
        for (int i = 0; i < 4; i++) sum[i] += a[k + (size_t)i] * b[k + (size_t)i];
    for (; k < count; k++) sum[0] += a[k] * b[k];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Cholesky's, in place; the diagonal holds inverses. A motion that the others make already (a group
 * of one node does not turn) is left out: its inverse is 0. */
static void factorise(lar_coarse *coarse) {
    static const double NOTHING = 1e-9;
    for (int32_t r = 0; r < LAR_RIGID * coarse->group_count; r++) {
        double *row = entry(coarse, r, coarse->first[r]);
        size_t length = (size_t)(r - coarse->first[r]);
        double diagonal = row[length];
        for (int32_t c = coarse->first[r]; c < r; c++) {
            int32_t from =
                coarse->first[c] > coarse->first[r] ? coarse->first[c] : coarse->first[r];
            double *left = entry(coarse, r, from), *other = entry(coarse, c, from);
            double *at = entry(coarse, r, c);
            *at = (*at - dot(left, other, (size_t)(c - from))) * *entry(coarse, c, c);
        }
        double pivot = diagonal - dot(row, row, length);
        row[length] = pivot > NOTHING * diagonal ? 1 / sqrt(pivot) : 0;
    }
}

lar_status lar_coarse_create(const lar_elastic *elastic, lar_coarse *coarse, lar_error *error) {
    size_t nodes = (size_t)elastic->node_count;
    double box = box_size(elastic);
    *coarse = (lar_coarse){.node_count = elastic->node_count,
                           .group = lar_calloc(nodes, sizeof *coarse->group),
                           .arm = lar_calloc(nodes, sizeof *coarse->arm)};
    lar_status status = coarse->group && coarse->arm
                            ? LAR_OK
                            : lar_fail_memory(error, 28 * nodes, "groups of nodes");
    if (!status) status = find_groups(coarse, elastic, box, error);
    if (!status) status = find_arms(coarse, elastic->mesh, box, error);
    if (!status) status = lay_rows(coarse, elastic, error);
    if (status) {
        lar_coarse_clear(coarse);
        return status;
    }
    fill_rows(coarse, elastic);
    factorise(coarse);
    return LAR_OK;
}

void lar_coarse_clear(lar_coarse *coarse) {
    free(coarse->group);
    free(coarse->arm);
    free(coarse->first);
    free(coarse->start);
    free(coarse->factor);
    free(coarse->load);
    *coarse = (lar_coarse){0};
}

/* ---- in use --------------------------------------------------------------------------------- */

/* A group's rows begin in the same column; they are taken at once, so that what is loaded serves
 * for all of them and none waits for the sum before it. */
typedef struct rows {
    int32_t from, diagonal; /* columns: the first one, and that of the group's first motion */
    const double *entry[LAR_RIGID]; /* from the first column on */
} rows;

static rows rows_of(lar_coarse *coarse, int32_t group) {
    const int32_t at = LAR_RIGID * group;
    rows these = {coarse->first[at], at, {NULL}};
    for (int d = 0; d < LAR_RIGID; d++) these.entry[d] = entry(coarse, at + d, these.from);
    return these;
}

static void substitute_forward(const rows *these, lar_loads *load) {
    const int32_t before = these->diagonal - these->from;
    lar_loads *own = load + before, x[LAR_RIGID];
    memcpy(x, own, sizeof x); /* apart from `load`, so that it stays in registers */
    for (int32_t c = 0; c < before; c++)
        for (int d = 0; d < LAR_RIGID; d++) x[d] -= these->entry[d][c] * load[c];
    for (int d = 0; d < LAR_RIGID; d++) {
        const double *entry = these->entry[d] + before;
        for (int c = 0; c < d; c++) x[d] -= entry[c] * own[c];
        own[d] = entry[d] * x[d];
    }
}

static void substitute_back(const rows *these, lar_loads *load) {
    const int32_t before = these->diagonal - these->from;
    lar_loads *own = load + before, x[LAR_RIGID];
    for (int d = LAR_RIGID - 1; d >= 0; d--) {
        const double *entry = these->entry[d] + before;
        own[d] *= entry[d];
        for (int c = 0; c < d; c++) own[c] -= entry[c] * own[d];
    }
    memcpy(x, own, sizeof x);
    for (int32_t c = 0; c < before; c++) {
        lar_loads less = load[c];
        for (int d = LAR_RIGID - 1; d >= 0; d--) less -= these->entry[d][c] * x[d];
        load[c] = less;
    }
}

static void solve(lar_coarse *coarse) {
    for (int32_t g = 0; g < coarse->group_count; g++) {
        const rows these = rows_of(coarse, g);
        substitute_forward(&these, coarse->load + these.from);
    }
    for (int32_t g = coarse->group_count - 1; g >= 0; g--) {
        const rows these = rows_of(coarse, g);
        substitute_back(&these, coarse->load + these.from);
    }
}

void lar_coarse_add(lar_coarse *coarse, const lar_load_vectors *r, lar_load_vectors *z) {
    memset(coarse->load, 0, (size_t)(LAR_RIGID * coarse->group_count) * sizeof *coarse->load);
    for (int32_t n = 0; n < coarse->node_count; n++) {
        if (coarse->group[n] < 0) continue;
        for (int d = 0; d < LAR_RIGID; d++)
            for (int i = 0; i < 3; i++) {
                const double part = share(coarse->arm[n], i, d);
                if (part != 0) coarse->load[LAR_RIGID * coarse->group[n] + d] += part * r[n][i];
            }
    }
    solve(coarse);
    for (int32_t n = 0; n < coarse->node_count; n++) {
        if (coarse->group[n] < 0) continue;
        for (int d = 0; d < LAR_RIGID; d++)
            for (int i = 0; i < 3; i++) {
                const double part = share(coarse->arm[n], i, d);
                if (part != 0) z[n][i] += part * coarse->load[LAR_RIGID * coarse->group[n] + d];
            }
    }
}
