/* The cells of the demonstration organ, and where their nodes are. */
#include <assert.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/memory.h"
#include "model/demo/demo_parts.h"
#include "model/mesh/mesh.h"

static const int16_t positions[][3] = {
#include "model/demo/demo_nodes.inc"
};

/* Bricks of cells, i0 <= i < i1 and so on, for the half i >= 0. Together 920 cells; a later brick
 * does not overlap an earlier one. */
static const struct brick {
    int i0, i1, j0, j1, k0, k1, part;
} bricks[] = {
    {0, 4, 0, 8, 0, 6, LAR_DEMO_UTERUS},       /* cervix */
    {0, 6, 0, 8, 6, 18, LAR_DEMO_UTERUS},      /* corpus and fundus */
    {6, 15, 3, 5, 14, 16, LAR_DEMO_TUBES},     /* tube, from the cornu outwards */
    {13, 15, 3, 5, 11, 14, LAR_DEMO_TUBES},    /* tube, the free end turning down */
    {6, 12, 3, 5, 12, 14, LAR_DEMO_LIGAMENTS}, /* mesosalpinx, under the tube */
    {6, 8, 3, 5, 8, 12, LAR_DEMO_LIGAMENTS},   /* broad ligament with the ovarian ligament */
    {8, 12, 2, 6, 9, 12, LAR_DEMO_OVARIES},
    {3, 5, -4, 0, 12, 14, LAR_DEMO_LIGAMENTS}, /* round ligament */
};
enum { BRICKS = sizeof bricks / sizeof bricks[0] };

/* Number of the node at grid point (I, J, K), -1 where there is none. */
typedef int node_table[LAR_DEMO_K_END + 1][LAR_DEMO_J_NODES][LAR_DEMO_I_END + 1];

static int *node_at(node_table table, int i, int j, int k) {
    return &table[k][j - LAR_DEMO_J_FIRST][i];
}

void lar_demo_half_clear(lar_demo_half *half) {
    free(half->grid);
    free(half->cell);
    free(half->part);
    *half = (lar_demo_half){0};
}

static void add_cell(lar_demo_half *half, node_table table, int i, int j, int k, int part) {
    const int e = half->cell_count++;
    half->part[e] = part;
    half->cell[e][0] = i;
    half->cell[e][1] = j;
    half->cell[e][2] = k;
    for (int a = 0; a < 8; ++a) {
        const int at[3] = {i + (lar_node_sign[a][0] > 0), j + (lar_node_sign[a][1] > 0),
                           k + (lar_node_sign[a][2] > 0)};
        int *node = node_at(table, at[0], at[1], at[2]);
        if (*node < 0) {
            *node = half->node_count++;
            for (int c = 0; c < 3; ++c) half->grid[*node][c] = at[c];
        }
    }
}

lar_status lar_demo_grid(lar_demo_half *half, lar_error *error) {
    int cells = 0;
    for (int b = 0; b < BRICKS; ++b)
        cells += (bricks[b].i1 - bricks[b].i0) * (bricks[b].j1 - bricks[b].j0) *
                 (bricks[b].k1 - bricks[b].k0);
    const size_t max_nodes = sizeof(node_table) / sizeof(int);
    half->grid = lar_calloc(max_nodes, sizeof *half->grid);
    half->cell = lar_calloc((size_t)cells, sizeof *half->cell);
    half->part = lar_calloc((size_t)cells, sizeof *half->part);
    if (!half->grid || !half->cell || !half->part)
        return lar_fail_memory(error, max_nodes * sizeof *half->grid, "the demonstration organ");
    node_table table;
    for (int *node = &table[0][0][0]; node != &table[0][0][0] + max_nodes; ++node) *node = -1;
    for (int b = 0; b < BRICKS; ++b)
        for (int k = bricks[b].k0; k < bricks[b].k1; ++k)
            for (int j = bricks[b].j0; j < bricks[b].j1; ++j)
                for (int i = bricks[b].i0; i < bricks[b].i1; ++i)
                    add_cell(half, table, i, j, k, bricks[b].part);
    assert((size_t)half->node_count == sizeof positions / sizeof positions[0]);
    half->position = positions;
    return LAR_OK;
}
