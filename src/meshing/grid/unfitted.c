#include <stdlib.h>
#include <string.h>

#include "meshing/grid/unfitted_cuts.h"
#include "meshing/fit/fit.h"
#include "meshing/fit/quality.h"

/* Grid points along an axis are one more than cells. */
typedef struct point_grid {
    const lar_voxel_grid *voxel_grid;
    int32_t points[3];
    int32_t *node; /* [points] node number, or -1 */
} point_grid;

static size_t point_index(const point_grid *grid, int i, int j, int k) {
    return ((size_t)k * (size_t)grid->points[1] + (size_t)j) * (size_t)grid->points[0] + (size_t)i;
}

static uint8_t region_of(const lar_voxel_grid *voxel_grid, const int at[3]) {
    for (int d = 0; d < 3; d++)
        if (at[d] < 0 || at[d] >= voxel_grid->cells[d]) return 0;
    return voxel_grid->region[lar_voxel_grid_cell(voxel_grid, at[0], at[1], at[2])];
}

/* Regions of the eight cells around a grid point, numbered by bits: 1: +i, 2: +j, 4: +k. */
static bool cells_around(const lar_voxel_grid *voxel_grid, const int at[3], uint8_t around[8]) {
    bool any = false;
    for (int c = 0; c < 8; c++) {
        const int cell[3] = {at[0] - 1 + (c & 1), at[1] - 1 + (c >> 1 & 1), at[2] - 1 + (c >> 2)};
        around[c] = region_of(voxel_grid, cell);
        any = any || around[c] != 0;
    }
    return any;
}

/* The pairs of regions that faces at a point divide: twelve faces, one for each pair of cells that
 * differ in one bit. Ascending, none twice; the number of pairs. */
enum { PAIRS_MAX = 12 };

static int add_pair(uint16_t pair[PAIRS_MAX][2], int count, uint16_t a, uint16_t b) {
    int place = count;
    while (place > 0 &&
           (pair[place - 1][0] > a || (pair[place - 1][0] == a && pair[place - 1][1] > b)))
        place--;
    if (place > 0 && pair[place - 1][0] == a && pair[place - 1][1] == b) return count;
    memmove(pair + place + 1, pair + place, (size_t)(count - place) * sizeof *pair);
    pair[place][0] = a;
    pair[place][1] = b;
    return count + 1;
}

/* A pair has a cut's number in the place of outside where the face belongs to a cut. */
static int pairs_at(const lar_voxel_grid *voxel_grid, const lar_unfitted_cuts *cuts,
                    const int at[3], uint16_t pair[PAIRS_MAX][2]) {
    uint8_t around[8];
    cells_around(voxel_grid, at, around);
    int count = 0;
    for (int c = 0; c < 8; c++)
        for (int d = 0; d < 3; d++) {
            const int other = c | 1 << d;
            if (other == c || around[c] == around[other]) continue;
            uint16_t a = around[c], b = around[other];
            if (a == 0 || b == 0) {
                const int inside = a ? c : other;
                const int cell[3] = {at[0] - 1 + (inside & 1), at[1] - 1 + (inside >> 1 & 1),
                                     at[2] - 1 + (inside >> 2)};
                const uint16_t front =
                    lar_unfitted_cuts_front(cuts, voxel_grid, cell, 2 * d + (inside == c));
                if (a == 0)
                    a = front;
                else
                    b = front;
            }
            count = add_pair(pair, count, a < b ? a : b, a < b ? b : a);
        }
    return count;
}

static void place_of(const lar_voxel_grid *voxel_grid, const int at[3], double position[3]) {
    for (int d = 0; d < 3; d++)
        position[d] = voxel_grid->origin[d] + voxel_grid->size * (at[0] * voxel_grid->axis[0][d] +
                                                                  at[1] * voxel_grid->axis[1][d] +
                                                                  at[2] * voxel_grid->axis[2][d]);
}

/* Numbers the points that have a cell, in grid order; counts nodes and elements. */
static lar_status number_points(point_grid *grid, lar_mesh *mesh, lar_error *error) {
    const lar_voxel_grid *voxel_grid = grid->voxel_grid;
    size_t points = 1, cells = 1, inside = 0;
    for (int d = 0; d < 3; d++) {
        grid->points[d] = voxel_grid->cells[d] + 1;
        points *= (size_t)grid->points[d];
        cells *= (size_t)voxel_grid->cells[d];
    }
    for (size_t c = 0; c < cells; c++) inside += voxel_grid->region[c] != 0;
    if (inside == 0)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "the grid of cubes has none inside the body; take smaller elements");
    if (inside > (size_t)INT32_MAX / 8)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%zu elements are more than a mesh may have; take larger elements", inside);
    grid->node = lar_calloc(points, sizeof *grid->node);
    if (!grid->node) return lar_fail_memory(error, points * sizeof *grid->node, "the grid's nodes");
    size_t p = 0;
    int32_t nodes = 0;
    for (int k = 0; k < grid->points[2]; k++)
        for (int j = 0; j < grid->points[1]; j++)
            for (int i = 0; i < grid->points[0]; i++, p++) {
                uint8_t around[8];
                grid->node[p] =
                    cells_around(voxel_grid, (const int[]){i, j, k}, around) ? nodes++ : -1;
            }
    mesh->node_count = nodes;
    mesh->element_count = (int32_t)inside;
    return LAR_OK;
}

static lar_status allocate(lar_unfitted_mesh *unfitted, lar_error *error) {
    lar_mesh *mesh = &unfitted->mesh;
    const size_t nodes = (size_t)mesh->node_count;
    lar_status status =
        lar_mesh_allocate(mesh, "the grid of cubes", nodes, (size_t)mesh->element_count, error);
    if (status) return status;
    unfitted->point = lar_calloc(nodes, sizeof *unfitted->point);
    unfitted->meet_start = lar_calloc(nodes + 1, sizeof *unfitted->meet_start);
    if (!unfitted->point || !unfitted->meet_start)
        return lar_fail_memory(error, nodes * 20, "the mesh");
    return LAR_OK;
}

static void corners_of(const point_grid *grid, const int at[3], int32_t node[8]) {
    for (int a = 0; a < 8; a++)
        node[a] = grid->node[point_index(grid, at[0] + (lar_node_sign[a][0] > 0),
                                         at[1] + (lar_node_sign[a][1] > 0),
                                         at[2] + (lar_node_sign[a][2] > 0))];
}

static void fill_elements(const point_grid *grid, lar_mesh *mesh) {
    const lar_voxel_grid *voxel_grid = grid->voxel_grid;
    size_t c = 0;
    int32_t e = 0;
    for (int k = 0; k < voxel_grid->cells[2]; k++)
        for (int j = 0; j < voxel_grid->cells[1]; j++)
            for (int i = 0; i < voxel_grid->cells[0]; i++, c++) {
                if (voxel_grid->region[c] == 0) continue;
                corners_of(grid, (const int[]){i, j, k}, mesh->element[e]);
                mesh->element_tag[e] = voxel_grid->region[c];
                mesh->element_id[e] = e + 1;
                e++;
            }
}

/* Whether the way along `axis` from a point to the next one is an edge of an element. */
static bool is_edge(const lar_voxel_grid *voxel_grid, const int from[3], int axis) {
    for (int c = 0; c < 4; c++) {
        int cell[3] = {from[0], from[1], from[2]};
        cell[(axis + 1) % 3] -= c & 1;
        cell[(axis + 2) % 3] -= c >> 1;
        if (region_of(voxel_grid, cell) != 0) return true;
    }
    return false;
}

/* Whether an edge of a cell's corner goes over to another side of the body. */
static bool goes_across(const lar_voxel_grid *voxel_grid, const int at[3], int a) {
    for (int axis = 0; axis < 3; axis++) {
        int from[3];
        for (int d = 0; d < 3; d++) from[d] = at[d] + (d != axis && lar_node_sign[a][d] > 0);
        if (!is_edge(voxel_grid, from, axis)) return true;
    }
    return false;
}

/* The corners of a cell outside. */
static bool add_slots(const point_grid *grid, const int at[3], lar_unfitted_mesh *unfitted,
                      size_t *capacity) {
    int32_t node[8];
    corners_of(grid, at, node);
    for (int a = 0; a < 8; a++) {
        const uint8_t *end = lar_fit_edge[a];
        if (node[a] < 0 || node[end[0]] < 0 || node[end[1]] < 0 || node[end[2]] < 0) continue;
        if (!goes_across(grid->voxel_grid, at, a)) continue;
        if (unfitted->slot_count == INT32_MAX / 4) return true;
        if (!LAR_GROW(unfitted->slot, *capacity, unfitted->slot_count)) return false;
        int32_t *slot = unfitted->slot[unfitted->slot_count++];
        for (int e = 0; e < 3; e++) slot[e] = node[end[e]];
        slot[LAR_FIT_MOVES_CORNER] = node[a];
    }
    return true;
}

static lar_status fill_slots(const point_grid *grid, lar_unfitted_mesh *unfitted,
                             lar_error *error) {
    const lar_voxel_grid *voxel_grid = grid->voxel_grid;
    size_t capacity = 0, c = 0;
    for (int k = 0; k < voxel_grid->cells[2]; k++)
        for (int j = 0; j < voxel_grid->cells[1]; j++)
            for (int i = 0; i < voxel_grid->cells[0]; i++, c++)
                if (voxel_grid->region[c] == 0 &&
                    !add_slots(grid, (const int[]){i, j, k}, unfitted, &capacity))
                    return lar_fail_memory(error, 2 * capacity * sizeof *unfitted->slot, "slots");
    return LAR_OK;
}

/* Positions, ids, and what meets at the nodes. */
static lar_status fill_nodes(const point_grid *grid, const lar_unfitted_cuts *cuts,
                             lar_unfitted_mesh *unfitted, lar_error *error) {
    size_t capacity = 0, used = 0, p = 0;
    for (int k = 0; k < grid->points[2]; k++)
        for (int j = 0; j < grid->points[1]; j++)
            for (int i = 0; i < grid->points[0]; i++, p++) {
                const int32_t n = grid->node[p];
                if (n < 0) continue;
                const int at[3] = {i, j, k};
                place_of(grid->voxel_grid, at, unfitted->mesh.position[n]);
                memcpy(unfitted->point[n], at, sizeof at);
                unfitted->mesh.node_id[n] = n + 1;
                uint16_t pair[PAIRS_MAX + 1][2];
                const int count = pairs_at(grid->voxel_grid, cuts, at, pair);
                for (int m = 0; m < count; m++, used++) {
                    if (used == INT32_MAX || !LAR_GROW(unfitted->meet, capacity, used))
                        return lar_fail_memory(error, used * sizeof *pair, "what meets at nodes");
                    memcpy(unfitted->meet[used], pair[m], sizeof *pair);
                }
                unfitted->meet_start[n + 1] = (int32_t)used;
            }
    return LAR_OK;
}

void lar_unfitted_clear(lar_unfitted_mesh *unfitted) {
    lar_mesh_clear(&unfitted->mesh);
    free(unfitted->point);
    free(unfitted->meet_start);
    free(unfitted->meet);
    free(unfitted->slot);
    *unfitted = (lar_unfitted_mesh){0};
}

lar_status lar_unfitted_create(const lar_voxel_grid *voxel_grid, const lar_boundary *boundary,
                               lar_unfitted_mesh *unfitted, lar_error *error) {
    point_grid grid = {.voxel_grid = voxel_grid};
    lar_unfitted_cuts cuts = {0};
    *unfitted = (lar_unfitted_mesh){.size = voxel_grid->size};
    lar_status status = lar_unfitted_cuts_create(boundary, &cuts, error);
    if (!status) status = number_points(&grid, &unfitted->mesh, error);
    if (!status) status = allocate(unfitted, error);
    if (!status) {
        fill_elements(&grid, &unfitted->mesh);
        status = fill_nodes(&grid, &cuts, unfitted, error);
    }
    if (!status) status = fill_slots(&grid, unfitted, error);
    free(grid.node);
    lar_unfitted_cuts_clear(&cuts);
    if (status) lar_unfitted_clear(unfitted);
    return status;
}
