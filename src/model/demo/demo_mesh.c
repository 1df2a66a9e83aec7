/* From the half to the whole mesh: mirror, number, name. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "model/demo/demo.h"
#include "model/demo/demo_parts.h"

/* Elements and nodes are numbered from below, row by row, so that neighbours in space are near in
 * memory. `at` holds, for every grid point of the whole organ, an index of the half or -1. */
enum { I_SPAN = 2 * LAR_DEMO_I_END + 1 };
typedef int whole_table[LAR_DEMO_K_END + 1][LAR_DEMO_J_NODES][I_SPAN];

static int *entry(whole_table table, int i, int j, int k) {
    return &table[k][j - LAR_DEMO_J_FIRST][i + LAR_DEMO_I_END];
}

static void empty(whole_table table) {
    for (int k = 0; k <= LAR_DEMO_K_END; ++k)
        for (int j = 0; j < LAR_DEMO_J_NODES; ++j)
            for (int i = 0; i < I_SPAN; ++i) table[k][j][i] = -1;
}

/* Numbers the nodes of both halves; `nodes` becomes grid point -> mesh node. */
static void place_nodes(const lar_demo_half *half, whole_table nodes, lar_mesh *mesh,
                        int (*grid)[3]) {
    empty(nodes);
    for (int a = 0; a < half->node_count; ++a)
        for (int side = -1; side <= 1; side += 2)
            *entry(nodes, side * half->grid[a][0], half->grid[a][1], half->grid[a][2]) = a;
    for (int k = 0; k <= LAR_DEMO_K_END; ++k)
        for (int j = LAR_DEMO_J_FIRST; j <= LAR_DEMO_J_END; ++j)
            for (int i = -LAR_DEMO_I_END; i <= LAR_DEMO_I_END; ++i) {
                int *node = entry(nodes, i, j, k);
                if (*node < 0) continue;
                const int16_t *from = half->position[*node];
                const int32_t n = mesh->node_count++;
                for (int d = 0; d < 3; ++d) mesh->position[n][d] = from[d] * (1e-3 / 256.0);
                if (i < 0) mesh->position[n][0] = -mesh->position[n][0];
                mesh->node_id[n] = n;
                memcpy(grid[n], (int[3]){i, j, k}, sizeof grid[n]);
                *node = n;
            }
}

static void place_elements(const lar_demo_half *half, whole_table nodes, whole_table cells,
                           lar_mesh *mesh) {
    empty(cells);
    for (int e = 0; e < half->cell_count; ++e) {
        const int *c = half->cell[e];
        *entry(cells, c[0], c[1], c[2]) = e;
        *entry(cells, -1 - c[0], c[1], c[2]) = e;
    }
    for (int k = 0; k < LAR_DEMO_K_END; ++k)
        for (int j = LAR_DEMO_J_FIRST; j < LAR_DEMO_J_END; ++j)
            for (int i = -LAR_DEMO_I_END; i < LAR_DEMO_I_END; ++i) {
                const int cell = *entry(cells, i, j, k);
                if (cell < 0) continue;
                const int32_t e = mesh->element_count++;
                for (int a = 0; a < 8; ++a)
                    mesh->element[e][a] =
                        *entry(nodes, i + (lar_node_sign[a][0] > 0), j + (lar_node_sign[a][1] > 0),
                               k + (lar_node_sign[a][2] > 0));
                mesh->element_id[e] = e;
                mesh->element_tag[e] = half->part[cell];
            }
}

/* Node sets as boxes of grid points, both ends included. */
static const struct named_box {
    const char *name;
    int low[3], high[3];
} node_boxes[] = {
    {"cervix", {-4, 0, 0}, {4, 8, 1}},
    {"ligament_ends", {-5, LAR_DEMO_J_FIRST, 12}, {5, LAR_DEMO_J_FIRST, 14}},
    {"ligament_end_left", {3, LAR_DEMO_J_FIRST, 12}, {5, LAR_DEMO_J_FIRST, 14}},
    {"ligament_end_right", {-5, LAR_DEMO_J_FIRST, 12}, {-3, LAR_DEMO_J_FIRST, 14}},
    {"fundus", {-3, 2, 18}, {3, 6, 18}},
    {"posterior", {-3, 8, 9}, {3, 8, 14}},
    {"ovary_left", {8, 2, 9}, {12, 6, 12}},
    {"ovary_right", {-12, 2, 9}, {-8, 6, 12}},
};

static lar_status add_node_sets(lar_mesh *mesh, int (*grid)[3], lar_error *error) {
    lar_status status = LAR_OK;
    for (size_t s = 0; !status && s < sizeof node_boxes / sizeof node_boxes[0]; ++s) {
        const struct named_box *box = &node_boxes[s];
        int32_t *index = lar_calloc((size_t)mesh->node_count, sizeof *index), count = 0;
        if (!index) return lar_fail_memory(error, (size_t)mesh->node_count * 4, box->name);
        for (int32_t n = 0; n < mesh->node_count; ++n) {
            bool inside = true;
            for (int d = 0; d < 3; ++d)
                inside &= grid[n][d] >= box->low[d] && grid[n][d] <= box->high[d];
            if (inside) index[count++] = n;
        }
        status = lar_mesh_add_set(mesh, box->name, LAR_SET_NODES, index, count, error);
    }
    return status;
}

static lar_status add_element_sets(lar_mesh *mesh, lar_error *error) {
    static const char *const name[] = {[LAR_DEMO_UTERUS] = "uterus",
                                       [LAR_DEMO_TUBES] = "tubes",
                                       [LAR_DEMO_OVARIES] = "ovaries",
                                       [LAR_DEMO_LIGAMENTS] = "ligaments"};
    lar_status status = LAR_OK;
    for (int part = LAR_DEMO_UTERUS; !status && part <= LAR_DEMO_LIGAMENTS; ++part) {
        int32_t *index = lar_calloc((size_t)mesh->element_count, sizeof *index), count = 0;
        if (!index) return lar_fail_memory(error, (size_t)mesh->element_count * 4, name[part]);
        for (int32_t e = 0; e < mesh->element_count; ++e)
            if (mesh->element_tag[e] == part) index[count++] = e;
        status = lar_mesh_add_set(mesh, name[part], LAR_SET_ELEMENTS, index, count, error);
    }
    return status;
}

static lar_status assemble(const lar_demo_half *half, lar_mesh *mesh, lar_error *error) {
    const size_t max_nodes = 2 * (size_t)half->node_count;
    int(*grid)[3] = lar_calloc(max_nodes, sizeof *grid);
    if (!grid) return lar_fail_memory(error, max_nodes * sizeof *grid, "the demonstration organ");
    whole_table nodes, cells;
    lar_status status = lar_mesh_allocate(mesh, "demonstration organ", max_nodes,
                                          2 * (size_t)half->cell_count, error);
    if (!status) {
        place_nodes(half, nodes, mesh, grid);
        place_elements(half, nodes, cells, mesh);
        status = add_node_sets(mesh, grid, error);
    }
    if (!status) status = add_element_sets(mesh, error);
    free(grid);
    return status;
}

lar_status lar_demo_mesh(lar_mesh *mesh, lar_error *error) {
    lar_demo_half half = {0};
    lar_status status = lar_demo_grid(&half, error);
    if (!status) status = assemble(&half, mesh, error);
    lar_demo_half_clear(&half);
    return status;
}
