/* What tests of grids and unfitted meshes share: grids of implicit functions, and a judge of solids
 * that knows nothing of how they are cleaned: it looks at the quadrilaterals of a mesh only.
 */
#ifndef LAR_TESTS_SOLID_H
#define LAR_TESTS_SOLID_H

#include "testing.h"

#include "meshing/fit/fit.h"
#include "meshing/grid/voxel_grid.h"

/* The region at a place, in cells; 0: outside. */
typedef int solid_function(const double x[3]);

/* A grid of unit cubes by 4 x 4 x 4 samples per cell, its corner at the origin. */
static TEST_UNUSED lar_voxel_grid solid_voxel_grid(solid_function *region, int ni, int nj, int nk) {
    lar_voxel_grid voxel_grid = {.cells = {ni, nj, nk}, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    voxel_grid.size = 1;
    const size_t cells = (size_t)ni * (size_t)nj * (size_t)nk;
    voxel_grid.region = lar_calloc(cells, 1);
    voxel_grid.inner = lar_calloc(cells, 1);
    voxel_grid.share = lar_calloc(cells, 1);
    assert_non_null(voxel_grid.share);
    for (size_t c = 0; c < cells; c++) {
        const int at[3] = {(int)(c % (size_t)ni), (int)(c / (size_t)ni % (size_t)nj),
                           (int)(c / (size_t)ni / (size_t)nj)};
        int count[256] = {0}, max = 0;
        for (int s = 0; s < 64; s++) {
            const double x[3] = {at[0] + (s % 4 + 0.5) / 4, at[1] + (s / 4 % 4 + 0.5) / 4,
                                 at[2] + (s / 16 + 0.5) / 4};
            count[region(x)]++;
        }
        for (int r = 1; r < 256; r++)
            if (count[r] > 0 && (max == 0 || count[r] > count[max])) max = r;
        voxel_grid.inner[c] = (uint8_t)max;
        voxel_grid.share[c] = (uint8_t)((64 - count[0]) * 255 / 64);
        voxel_grid.region[c] = (uint8_t)(count[0] > 32 ? 0 : max);
    }
    return voxel_grid;
}

static TEST_UNUSED int64_t solid_cells(const lar_voxel_grid *voxel_grid) {
    int64_t cells = 0;
    const size_t all =
        (size_t)voxel_grid->cells[0] * (size_t)voxel_grid->cells[1] * (size_t)voxel_grid->cells[2];
    for (size_t c = 0; c < all; c++) cells += voxel_grid->region[c] != 0;
    return cells;
}

/* What the surface of a mesh is like. */
typedef struct solid_surface {
    int quads, shells, euler; /* V - E + F of the surface */
    int bad_edges;            /* with more or less than two quadrilaterals */
    int bad_nodes;            /* whose quadrilaterals form more than one fan */
} solid_surface;

typedef struct solid_edge {
    int32_t low, high, quad;
} solid_edge;

static inline int solid_compare_edges(const void *a, const void *b) {
    const solid_edge *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return (p->quad > q->quad) - (p->quad < q->quad);
}

static inline int32_t solid_root(int32_t *parent, int32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Nodes of the faces of elements with tag `tag` (all when it is 0) towards others. */
static TEST_UNUSED solid_surface solid_judge(const lar_mesh *mesh, int32_t tag) {
    lar_mesh part = *mesh;
    part.element = lar_calloc((size_t)mesh->element_count, sizeof *part.element);
    part.element_count = 0;
    for (int32_t e = 0; e < mesh->element_count; e++)
        if (tag == 0 || mesh->element_tag[e] == tag)
            memcpy(part.element[part.element_count++], mesh->element[e], sizeof *part.element);
    int32_t *face, count;
    lar_error error;
    assert_int_equal(lar_mesh_boundary(&part, &face, &count, &error), LAR_OK);

    solid_surface surface = {.quads = count};
    solid_edge *edge = lar_calloc((size_t)count * 4, sizeof *edge);
    /* Corners of quadrilaterals are joined where two quadrilaterals share an edge: what is joined
     * at a node is a fan. */
    int32_t *fan = lar_calloc((size_t)count * 4, sizeof *fan);
    int32_t *shell = lar_calloc((size_t)count, sizeof *shell);
    int32_t *fan_of_node = lar_calloc((size_t)mesh->node_count, sizeof *fan_of_node);
    for (int32_t q = 0; q < count; q++) {
        shell[q] = q;
        for (int a = 0; a < 4; a++) {
            const int32_t *node = part.element[face[q] / 6];
            const int32_t n = node[lar_face_node[face[q] % 6][a]];
            const int32_t m = node[lar_face_node[face[q] % 6][(a + 1) % 4]];
            edge[4 * q + a] = (solid_edge){n < m ? n : m, n < m ? m : n, q};
            fan[4 * q + a] = 4 * q + a;
        }
    }
    qsort(edge, (size_t)count * 4, sizeof *edge, solid_compare_edges);
    int edges = 0;
    for (int32_t i = 0, next; i < 4 * count; i = next) {
        for (next = i;
             next < 4 * count && edge[next].low == edge[i].low && edge[next].high == edge[i].high;
             next++) {
        }
        edges++;
        surface.bad_edges += next - i != 2;
        if (next - i != 2) continue;
        const int32_t p = edge[i].quad, q = edge[i + 1].quad;
        shell[solid_root(shell, p)] = solid_root(shell, q);
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++) {
                const int32_t n = part.element[face[p] / 6][lar_face_node[face[p] % 6][a]];
                const int32_t m = part.element[face[q] / 6][lar_face_node[face[q] % 6][b]];
                if (n == m && (n == edge[i].low || n == edge[i].high))
                    fan[solid_root(fan, 4 * p + a)] = solid_root(fan, 4 * q + b);
            }
    }
    int nodes = 0;
    for (int32_t i = 0; i < 4 * count; i++) {
        const int32_t n = part.element[face[i / 4] / 6][lar_face_node[face[i / 4] % 6][i % 4]];
        if (fan_of_node[n] == 0) nodes++;
        if (fan_of_node[n] != 0 && fan_of_node[n] != 1 + solid_root(fan, i)) surface.bad_nodes++;
        fan_of_node[n] = 1 + solid_root(fan, i);
    }
    for (int32_t q = 0; q < count; q++) surface.shells += shell[q] == q;
    surface.euler = nodes - edges + count;
    free(edge);
    free(fan);
    free(shell);
    free(fan_of_node);
    free(face);
    free(part.element);
    return surface;
}

/* The surface of a grid's cells. */
static TEST_UNUSED solid_surface solid_judge_voxel_grid(const lar_voxel_grid *voxel_grid,
                                                        int32_t region) {
    lar_boundary none = {0};
    lar_unfitted_mesh unfitted;
    lar_error error;
    assert_int_equal(lar_unfitted_create(voxel_grid, &none, &unfitted, &error), LAR_OK);
    const solid_surface surface = solid_judge(&unfitted.mesh, region);
    lar_unfitted_clear(&unfitted);
    return surface;
}

#define assert_manifold(surface)                                                                   \
    do {                                                                                           \
        if ((surface).bad_edges || (surface).bad_nodes)                                            \
            fail_msg("%d edges and %d nodes are not manifold", (surface).bad_edges,                \
                     (surface).bad_nodes);                                                         \
    } while (0)

#endif
