#include "meshing/starter/elastic_coarse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"

/* ---- groups --------------------------------------------------------------------------------- */

/* About so many boxes, of two elements at least. */
static double box_size(const lar_elastic *elastic) {
    static const double BOXES = 160, MIN = 2;
    double volume = 0;
    for (int32_t k = 0; k < elastic->element_count; k++) volume += elastic->element[k].volume;
    double edge = cbrt(volume / fmax(1, elastic->element_count));
    return fmax(MIN * edge, cbrt(volume / BOXES));
}

static bool same_box(const double a[3], const double b[3], double box) {
    for (int i = 0; i < 3; i++)
        if (floor(a[i] / box) != floor(b[i] / box)) return false;
    return true;
}

static void number_groups(lar_coarse *coarse, const lar_elastic *elastic, int32_t *parent) {
    const int32_t nodes = elastic->node_count;
    for (int32_t n = 0; n < nodes; n++) {
        const bool first = elastic->still[n] != LAR_AXIS_ALL && lar_union_root(parent, n) == n;
        coarse->group[n] = first ? coarse->group_count++ : -1;
    }
    for (int32_t n = 0; n < nodes; n++)
        if (elastic->still[n] != LAR_AXIS_ALL)
            coarse->group[n] = coarse->group[lar_union_root(parent, n)];
}

static lar_status find_groups(lar_coarse *coarse, const lar_elastic *elastic, double box,
                              lar_error *error) {
    const lar_mesh *mesh = elastic->mesh;
    size_t nodes = (size_t)mesh->node_count;
    int32_t *parent = lar_calloc(nodes, sizeof *parent);
    if (!parent) return lar_fail_memory(error, 4 * nodes, "groups of nodes");
    lar_union_start(parent, mesh->node_count);
    for (int32_t k = 0; k < elastic->element_count; k++) {
        const int32_t *node = elastic->element[k].node;
        for (int a = 0; a < 8; a++)
            for (int b = 0; b < a; b++)
                if (elastic->still[node[a]] != LAR_AXIS_ALL &&
                    elastic->still[node[b]] != LAR_AXIS_ALL &&
                    same_box(mesh->position[node[a]], mesh->position[node[b]], box))
                    lar_union_join(parent, node[a], node[b]);
    }
    number_groups(coarse, elastic, parent);
    free(parent);
    return LAR_OK;
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

/* How axis i of a node moves with its group's motion d: translations, then rotations; 0 where it is
 * held. */
static double share(const lar_coarse *coarse, int32_t n, int i, int d) {
    const double *arm = coarse->arm[n];
    if (coarse->still[n] >> i & 1) return 0;
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

/* Groups that an element hangs together know each other. */
static lar_status lay_matrix(lar_coarse *coarse, const lar_elastic *elastic, lar_error *error) {
    int32_t(*pair)[2] = NULL, *place = lar_calloc((size_t)coarse->group_count, sizeof *place);
    size_t pairs = 0, capacity = 0;
    bool ready = place != NULL;
    for (int32_t k = 0; ready && k < elastic->element_count; k++) {
        const int32_t *node = elastic->element[k].node;
        if (!resists(coarse, &elastic->element[k])) continue;
        for (int a = 0; a < 8; a++)
            for (int b = 0; ready && b < a; b++) {
                const int32_t one = coarse->group[node[a]], other = coarse->group[node[b]];
                if (one == other || one < 0 || other < 0) continue;
                ready = LAR_GROW(pair, capacity, pairs);
                if (ready) pair[pairs][0] = one, pair[pairs++][1] = other;
            }
    }
    lar_status status = ready ? LAR_OK : lar_fail_memory(error, 16 * pairs, "a coarse matrix");
    if (!status)
        status = lar_factor_lay(coarse->group_count, (const int32_t(*)[2])pair, pairs, place,
                                &coarse->factor, error);
    for (int32_t n = 0; !status && n < coarse->node_count; n++)
        if (coarse->group[n] >= 0) coarse->group[n] = place[coarse->group[n]];
    free(place);
    free(pair);
    return status;
}

/* P at one node. */
typedef double motions[3][LAR_RIGID];

static void find_motions(const lar_coarse *coarse, int32_t n, motions P) {
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < LAR_RIGID; d++) P[i][d] = share(coarse, n, i, d);
}

/* block += P_a^T K_ab P_b */
static void add_block(lar_factor_block block, const motions of_a, const double K[24][24], int a,
                      int b, const motions of_b) {
    double KP[3][LAR_RIGID] = {{0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int d = 0; d < LAR_RIGID; d++) KP[i][d] += K[3 * a + i][3 * b + j] * of_b[j][d];
    for (int c = 0; c < LAR_RIGID; c++) {
        double sum[LAR_RIGID] = {0};
        for (int i = 0; i < 3; i++)
            for (int d = 0; d < LAR_RIGID; d++) sum[d] += of_a[i][c] * KP[i][d];
        for (int d = 0; d < LAR_RIGID; d++) block[c][d] += sum[d];
    }
}

/* Adds P^T K P of an element. */
static void add_element(lar_coarse *coarse, const lar_elastic_element *e) {
    double K[24][24];
    motions P[8];
    lar_elastic_element_matrix(e, K);
    for (int a = 0; a < 8; a++)
        if (coarse->group[e->node[a]] >= 0) find_motions(coarse, e->node[a], P[a]);
    for (int a = 0; a < 8; a++)
        for (int b = 0; b < 8; b++) {
            const int32_t row = coarse->group[e->node[a]], column = coarse->group[e->node[b]];
            if (row < 0 || column < 0 || row < column) continue;
            add_block(*lar_factor_at(&coarse->factor, row, column),
                      (const double(*)[LAR_RIGID])P[a], (const double(*)[24])K, a, b,
                      (const double(*)[LAR_RIGID])P[b]);
        }
}

/* Of a spring on a node. */
static void add_spring(lar_coarse *coarse, int32_t n, double stiffness) {
    if (coarse->group[n] < 0) return;
    lar_factor_block *block = lar_factor_at(&coarse->factor, coarse->group[n], coarse->group[n]);
    for (int c = 0; c < LAR_RIGID; c++)
        for (int d = 0; d < LAR_RIGID; d++)
            for (int i = 0; i < 3; i++)
                (*block)[c][d] += stiffness * share(coarse, n, i, c) * share(coarse, n, i, d);
}

static void fill_matrix(lar_coarse *coarse, const lar_elastic *elastic) {
    for (int32_t k = 0; k < elastic->element_count; k++)
        if (resists(coarse, &elastic->element[k])) add_element(coarse, &elastic->element[k]);
    for (int32_t n = 0; elastic->spring && n < elastic->node_count; n++)
        if (elastic->spring[n] > 0) add_spring(coarse, n, elastic->spring[n]);
}

lar_status lar_coarse_create(const lar_elastic *elastic, lar_coarse *coarse, lar_error *error) {
    size_t nodes = (size_t)elastic->node_count;
    double box = box_size(elastic);
    *coarse = (lar_coarse){.node_count = elastic->node_count,
                           .still = elastic->still,
                           .group = lar_calloc(nodes, sizeof *coarse->group),
                           .arm = lar_calloc(nodes, sizeof *coarse->arm)};
    lar_status status = coarse->group && coarse->arm
                            ? LAR_OK
                            : lar_fail_memory(error, 28 * nodes, "groups of nodes");
    if (!status) status = find_groups(coarse, elastic, box, error);
    if (!status) status = find_arms(coarse, elastic->mesh, box, error);
    if (!status) status = lay_matrix(coarse, elastic, error);
    if (!status) fill_matrix(coarse, elastic);
    if (!status) status = lar_factor_compute(&coarse->factor, error);
    if (status) lar_coarse_clear(coarse);
    return status;
}

void lar_coarse_clear(lar_coarse *coarse) {
    free(coarse->group);
    free(coarse->arm);
    lar_factor_clear(&coarse->factor);
    *coarse = (lar_coarse){0};
}

/* ---- in use --------------------------------------------------------------------------------- */

/* `to`: the six motions of node n's group; they grow by P^T r of the node. */
static inline void gather(const lar_coarse *coarse, int32_t n, const lar_pair_vectors r,
                          lar_pair *to) {
    const double *arm = coarse->arm[n];
    lar_pair f[3];
    for (int i = 0; i < 3; i++) f[i] = coarse->still[n] >> i & 1 ? (lar_pair){0} : r[i];
    for (int i = 0; i < 3; i++) to[i] += f[i];
    to[3] = to[3] - arm[2] * f[1] + arm[1] * f[2];
    to[4] = to[4] + arm[2] * f[0] - arm[0] * f[2];
    to[5] = to[5] - arm[1] * f[0] + arm[0] * f[1];
}

/* z grows by P of the motions `by`. */
static inline void spread(const lar_coarse *coarse, int32_t n, const lar_pair *by,
                          lar_pair_vectors z) {
    const double *arm = coarse->arm[n];
    const lar_pair_vectors to = {z[0] + by[0] + arm[2] * by[4] - arm[1] * by[5],
                                 z[1] + by[1] - arm[2] * by[3] + arm[0] * by[5],
                                 z[2] + by[2] + arm[1] * by[3] - arm[0] * by[4]};
    for (int i = 0; i < 3; i++)
        if (!(coarse->still[n] >> i & 1)) z[i] = to[i];
}

void lar_coarse_add(const lar_coarse *coarse, lar_pair *way, const lar_pair_vectors *r,
                    lar_pair_vectors *z) {
    memset(way, 0, (size_t)(LAR_RIGID * coarse->group_count) * sizeof *way);
    for (int32_t n = 0; n < coarse->node_count; n++)
        if (coarse->group[n] >= 0) gather(coarse, n, r[n], &way[LAR_RIGID * coarse->group[n]]);
    lar_factor_solve(&coarse->factor, way);
    for (int32_t n = 0; n < coarse->node_count; n++)
        if (coarse->group[n] >= 0) spread(coarse, n, &way[LAR_RIGID * coarse->group[n]], z[n]);
}
