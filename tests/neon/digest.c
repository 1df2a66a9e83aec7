/* One line per instruction set and law: a digest of 300 steps of a shaken block of crooked
 * elements, through the same kernels as a simulation.
 *
 *     c neo-hookean 0123456789abcdef
 *
 * digest.sh runs it on this processor and, cross-compiled, on an emulated ARM processor, and
 * compares. It needs base, mechanics and the materials only, so that it links without any other
 * library.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "mechanics/hex8_block.h"

enum { EDGE = 4, NODES_EDGE = EDGE + 1, ELEMENTS = EDGE * EDGE * EDGE, STEPS = 300 };
enum { NODES = NODES_EDGE * NODES_EDGE * NODES_EDGE + 1, BLOCKS = ELEMENTS / LAR_BLOCK };
_Static_assert(NODES % 2 == 0 && ELEMENTS % LAR_BLOCK == 0, "whole pairs and blocks");

static const double SIDE = 0.01, DENSITY = 1000.0, DT = 5e-5, SCALE = 0x1p40;

typedef struct world {
    lar_hex8_block blocks[BLOCKS];
    double position[NODES][3];
    double u[NODES][4] __attribute__((aligned(64)));
    double v[NODES][4] __attribute__((aligned(64)));
    int64_t force[NODES][4] __attribute__((aligned(64)));
    double mass[NODES], push[NODES];
} world;

static uint32_t chance_state;

/* -1..1 in steps of 2^-15, the same everywhere. */
static double chance(void) {
    chance_state = chance_state * 1664525u + 1013904223u;
    return (double)(int32_t)(chance_state >> 16) / 32768.0 - 1.0;
}

static int node_at(int i, int j, int k) {
    return i + NODES_EDGE * (j + NODES_EDGE * k);
}

static void place_nodes(world *w) {
    for (int k = 0; k < NODES_EDGE; k++)
        for (int j = 0; j < NODES_EDGE; j++)
            for (int i = 0; i < NODES_EDGE; i++) {
                int n = node_at(i, j, k);
                const int at[3] = {i, j, k};
                for (int axis = 0; axis < 3; axis++) {
                    w->position[n][axis] = SIDE * (at[axis] + 0.15 * chance());
                    w->v[n][axis] = 0.5 * chance();
                }
            }
}

static void pack_element(world *w, int e, const lar_material *material) {
    static const int offset[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const int at[3] = {e % EDGE, e / EDGE % EDGE, e / EDGE / EDGE};
    lar_hex8_block *block = &w->blocks[e / LAR_BLOCK];
    int lane = e % LAR_BLOCK;
    double corner[8][3];
    for (int a = 0; a < 8; a++) {
        int n = node_at(at[0] + offset[a][0], at[1] + offset[a][1], at[2] + offset[a][2]);
        memcpy(corner[a], w->position[n], sizeof corner[a]);
        block->head.node[a][lane] = 4 * n;
        w->mass[n] += DENSITY * SIDE * SIDE * SIDE / 8;
    }
    lar_hex8 hex8;
    lar_hex8_prepare(corner, material, &hex8);
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int i = 0; i < 3; i++) block->gradient[m][i][lane] = hex8.gradient[m][i];
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        for (int i = 0; i < 3; i++) block->shape[m][i][lane] = hex8.shape[m][i];
        block->head.stiffness[m][lane] = hex8.stiffness[m] * SCALE;
    }
    for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
        block->head.modulus[k][lane] = material->parameter[k] * hex8.volume * SCALE;
}

static uint64_t digest(uint64_t hash, const void *data, size_t size) {
    const unsigned char *byte = data; /* FNV-1a; both machines are little-endian */
    for (size_t i = 0; i < size; i++) hash = (hash ^ byte[i]) * 0x100000001b3u;
    return hash;
}

/* False when an element left the limits: then the digest would say nothing. */
static bool shake(const lar_kernels *kernels, lar_law law, uint64_t *hash) {
    world *w = lar_calloc_aligned(1, sizeof *w);
    if (!w) return false;
    lar_material material = {.law = law, .density = DENSITY};
    lar_material_from_shear_bulk(&material, 4e3, 1e5);
    chance_state = 2001;
    place_nodes(w);
    for (int e = 0; e < ELEMENTS; e++) pack_element(w, e, &material);
    for (int n = 0; n < NODES; n++) w->push[n] = w->mass[n] > 0 ? DT / (w->mass[n] * SCALE) : 0;

    const lar_hex8_limits limits = {0.05, 1e300, 1e300};
    const lar_motion motion = {.keep = 0.9999, .dt = DT, .speed = 100, .drift = {0, 0, -9.81 * DT}};
    const lar_block_run run = {law, LAR_SHAPE_GENERAL, LAR_ROWS_NONE, 0, false, BLOCKS, w->blocks};
    bool good = true;
    double damped = 0;
    for (int step = 0; step < STEPS && good; step++) {
        good = kernels->recover(&run, &w->u[0][0], &w->force[0][0], &limits, step % 10 == 0) < 0 &&
               kernels->update(&motion, 0, NODES, &w->u[0][0], &w->v[0][0], &w->force[0][0],
                               w->push, step % 10 ? NULL : w->mass, &damped);
    }
    *hash = digest(0xcbf29ce484222325u, w->u, sizeof w->u);
    *hash = digest(*hash, w->v, sizeof w->v);
    free(w);
    return good;
}

int main(void) {
    for (lar_isa isa = LAR_ISA_C; isa <= LAR_ISA_AVX512; isa++) {
        const lar_kernels *kernels = NULL;
        if (lar_kernels_find(isa, &kernels, NULL)) continue;
        for (int law = 0; law < LAR_LAW_COUNT; law++) {
            uint64_t hash;
            if (!shake(kernels, (lar_law)law, &hash)) {
                fprintf(stderr, "digest: %s %s left the limits\n", kernels->name,
                        lar_law_name[law]);
                return 1;
            }
            printf("%s %s %016" PRIx64 "\n", kernels->name, lar_law_name[law], hash);
        }
    }
    return 0;
}
