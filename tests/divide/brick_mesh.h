/* A block of unit cubes in memory, nx x ny x nz elements, x running fastest. */
#ifndef LAR_TESTS_BRICK_MESH_H
#define LAR_TESTS_BRICK_MESH_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "divide/distribution.h"
#include "model/mesh/mesh.h"

static inline lar_mesh brick_mesh(int nx, int ny, int nz) {
    lar_mesh mesh = {.source = lar_strdup("brick"),
                     .node_count = (nx + 1) * (ny + 1) * (nz + 1),
                     .element_count = nx * ny * nz};
    mesh.position = lar_calloc((size_t)mesh.node_count, sizeof *mesh.position);
    mesh.node_id = lar_calloc((size_t)mesh.node_count, sizeof *mesh.node_id);
    mesh.element = lar_calloc((size_t)mesh.element_count, sizeof *mesh.element);
    mesh.element_id = lar_calloc((size_t)mesh.element_count, sizeof *mesh.element_id);
    mesh.element_tag = lar_calloc((size_t)mesh.element_count, sizeof *mesh.element_tag);
    for (int n = 0; n < mesh.node_count; n++) {
        mesh.position[n][0] = n % (nx + 1);
        mesh.position[n][1] = n / (nx + 1) % (ny + 1);
        mesh.position[n][2] = n / (nx + 1) / (ny + 1);
    }
    for (int e = 0; e < mesh.element_count; e++)
        for (int a = 0; a < 8; a++) {
            int i = e % nx + (lar_node_sign[a][0] > 0);
            int j = e / nx % ny + (lar_node_sign[a][1] > 0);
            int k = e / nx / ny + (lar_node_sign[a][2] > 0);
            mesh.element[e][a] = i + (nx + 1) * (j + (ny + 1) * k);
        }
    return mesh;
}

static inline lar_grid grid_of(int nx, int ny, int nz) {
    lar_grid grid;
    assert_int_equal(lar_grid_make(nx, ny, nz, &grid, NULL), LAR_OK);
    return grid;
}

#endif
