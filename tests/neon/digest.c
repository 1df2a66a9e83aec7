/* One line per instruction set, law, body and form of its blocks: a digest of 100 steps of a shaken
 * brick, through the same kernels as a simulation.
 *
 *     c neo-hookean crooked 0123456789abcdef general rows-of-eight
 *
 * The body is crooked, or of boxes whose xi runs along x, y or z (box0, box1, box2); the form
 * (general or box blocks, loose or in rows) must not change its digest. digest.sh runs this on this
 * processor and, cross-compiled, on an emulated ARM processor, and compares. It needs base,
 * mechanics and the materials only, so that it links without any other library.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/simd.h"
#include "mechanics/hex8_block.h"

enum { LONG = 8, EDGE = 4, ELEMENTS = LONG * EDGE * EDGE, STEPS = 100 };
enum {
    NODES = ((LONG + 1) * (EDGE + 1) * (EDGE + 1) / LAR_NODES_TOGETHER + 1) * LAR_NODES_TOGETHER
};
enum { BLOCKS = ELEMENTS / LAR_BLOCK };
_Static_assert((int)LONG == (int)LAR_BLOCK, "whole rows");

static const double SIDE = 0.01, DENSITY = 1000.0, DT = 5e-5, SCALE = 0x1p40;

/* A body (turn of its boxes, -1: crooked) and the form in which the kernels get it. */
typedef struct form {
    int turn;
    lar_block_shape shape;
    lar_block_rows rows;
} form;

static const form forms[] = {
    {-1, LAR_SHAPE_GENERAL, LAR_ROWS_NONE},  {-1, LAR_SHAPE_GENERAL, LAR_ROWS_FOUR},
    {-1, LAR_SHAPE_GENERAL, LAR_ROWS_EIGHT}, {0, LAR_SHAPE_GENERAL, LAR_ROWS_NONE},
    {0, LAR_SHAPE_BOX, LAR_ROWS_NONE},       {1, LAR_SHAPE_GENERAL, LAR_ROWS_FOUR},
    {1, LAR_SHAPE_BOX, LAR_ROWS_FOUR},       {2, LAR_SHAPE_GENERAL, LAR_ROWS_EIGHT},
    {2, LAR_SHAPE_BOX, LAR_ROWS_EIGHT}};

typedef struct world {
    lar_hex8_block general[BLOCKS];
    lar_block_more more[BLOCKS];
    lar_box_block box[BLOCKS];
    lar_fibre_block fibres[BLOCKS];
    lar_fibre_block second[BLOCKS];
    double position[NODES][3];
    double u[3][NODES] __attribute__((aligned(64)));
    double v[3][NODES] __attribute__((aligned(64)));
    int64_t force[3][NODES] __attribute__((aligned(64)));
    double mass[NODES] __attribute__((aligned(64))), push[NODES] __attribute__((aligned(64)));
} world;

static uint32_t chance_state;

/* -1..1 in steps of 2^-15, the same everywhere. */
static double chance(void) {
    chance_state = chance_state * 1664525u + 1013904223u;
    return (double)(int32_t)(chance_state >> 16) / 32768.0 - 1.0;
}

static int node_at(int i, int j, int k) {
    return i + (LONG + 1) * (j + (EDGE + 1) * k);
}

static void place_nodes(world *w, int turn) {
    for (int k = 0; k <= EDGE; k++)
        for (int j = 0; j <= EDGE; j++)
            for (int i = 0; i <= LONG; i++) {
                int n = node_at(i, j, k);
                const int at[3] = {i, j, k};
                for (int m = 0; m < 3; m++) {
                    int axis = turn < 0 ? m : (m + turn) % 3;
                    double crooked = turn < 0 ? 0.15 * chance() : 0;
                    w->position[n][axis] = SIDE * (at[m] + crooked);
                    w->v[axis][n] = 0.5 * chance();
                }
            }
}

/* Into both kinds of blocks, in the lane of its place in the row. */
static void pack_element(world *w, int e, int turn, const lar_material *material) {
    const int at[3] = {e % LONG, e / LONG % EDGE, e / LONG / EDGE};
    lar_hex8_block *block = &w->general[e / LAR_BLOCK];
    lar_box_block *box = &w->box[e / LAR_BLOCK];
    int lane = e % LAR_BLOCK;
    double corner[8][3];
    for (int a = 0; a < 8; a++) {
        int n = node_at(at[0] + (a % 4 == 1 || a % 4 == 2), at[1] + (a % 4 > 1), at[2] + (a > 3));
        memcpy(corner[a], w->position[n], sizeof corner[a]);
        block->head.node[a][lane] = n;
        w->mass[n] += DENSITY * SIDE * SIDE * SIDE / 8;
    }
    lar_hex8 hex8;
    lar_hex8_prepare(corner, material, &hex8);
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int i = 0; i < 3; i++) block->gradient[m][i][lane] = hex8.gradient[m][i];
    for (int m = 0; m < 3 && turn >= 0; m++)
        box->gradient[m][lane] = hex8.gradient[m][(m + turn) % 3];
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        for (int i = 0; i < 3; i++) block->shape[m][i][lane] = hex8.shape[m][i];
        block->head.stiffness[m][lane] = hex8.stiffness[m] * SCALE;
    }
    for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
        *lar_block_parameter(&block->head, &w->more[e / LAR_BLOCK], k, lane) =
            material->parameter[k] * (lar_law_scales(material->law, k) ? hex8.volume * SCALE : 1);
    box->head = block->head;
    lar_fibre_block *fibres = &w->fibres[e / LAR_BLOCK];
    const lar_fibre *fibre = &material->fibre;
    double unit = hex8.volume * SCALE;
    fibres->direction[e % 3][lane] = 0.6;
    fibres->direction[(e + 1) % 3][lane] = -0.8;
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        fibres->parameter[k][lane] =
            fibre->parameter[k] * (lar_fibre_scales(fibre->law, k) ? unit : 1);
    fibres->along[lane] = fibre->along * unit;
    fibres->across[lane] = fibre->across * unit;
    lar_fibre_block *second = &w->second[e / LAR_BLOCK];
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        second->parameter[k][lane] = fibres->parameter[k][lane];
    second->direction[e % 3][lane] = 0.6;
    second->direction[(e + 2) % 3][lane] = 0.8;
}

static uint64_t digest(uint64_t hash, const void *data, size_t size) {
    const unsigned char *byte = data; /* FNV-1a; both machines are little-endian */
    for (size_t i = 0; i < size; i++) hash = (hash ^ byte[i]) * 0x100000001b3u;
    return hash;
}

/* False when an element left the limits: then the digest would say nothing. */
static bool shake(const lar_kernels *kernels, lar_law law, const lar_fibre *fibre, const form *as,
                  uint64_t *hash) {
    world *w = lar_calloc_aligned(1, sizeof *w);
    if (!w) return false;
    lar_material material = {.law = law, .density = DENSITY, .fibre = *fibre};
    lar_material_from_shear_bulk(&material, 4e3, 1e5);
    chance_state = 2001;
    place_nodes(w, as->turn);
    for (int e = 0; e < ELEMENTS; e++) pack_element(w, e, as->turn, &material);
    for (int n = 0; n < NODES; n++) w->push[n] = w->mass[n] > 0 ? DT / (w->mass[n] * SCALE) : 0;

    const lar_hex8_limits limits = {0.05, 1e300, 1e300};
    const lar_leapfrog leapfrog = {
        .keep = 0.9999, .dt = DT, .speed = 100, .drift = {0, 0, -9.81 * DT}, .push = 1};
    bool boxes = as->shape == LAR_SHAPE_BOX;
    const lar_block_run run = {.law = law,
                               .shape = as->shape,
                               .rows = as->rows,
                               .turn = boxes ? as->turn : 0,
                               .asks = as->turn == 1   ? LAR_ASK_FEW
                                       : as->turn == 2 ? LAR_ASK_MANY
                                                       : 0,
                               .count = BLOCKS,
                               .axis_stride = NODES,
                               .blocks = boxes ? (const void *)w->box : w->general,
                               .more = lar_law_has_more(law) ? w->more : NULL,
                               .fibrous = lar_fibre_kind(fibre),
                               .fibres = w->fibres,
                               .second = lar_fibre_families(fibre) == 2 ? w->second : NULL};
    static int32_t lane[BLOCKS * LAR_BLOCK];
    static double limit[BLOCKS * LAR_BLOCK] __attribute__((aligned(64)));
    static float strain[BLOCKS * LAR_BLOCK][LAR_STRAIN_NUMBERS];
    for (int i = 0; i < BLOCKS * LAR_BLOCK; i++) limit[i] = INFINITY;
    bool good = true;
    double damped = 0, fastest = 0;
    for (int step = 0; step < STEPS && good; step++) {
        lar_hex8_monitor monitor = {.limit = limit, .lane = lane, .strain = strain};
        lar_hex8_monitor *looks = step % 10 == 0 ? &monitor : NULL;
        int64_t beyond = run.fibrous
                             ? kernels->recover_more(&run, NULL, NULL, &w->u[0][0], &w->force[0][0],
                                                     &limits, looks)
                             : kernels->recover(&run, &w->u[0][0], &w->force[0][0], &limits, looks);
        good = beyond < 0 && kernels->update(&leapfrog, 0, NODES, NODES, &w->u[0][0], &w->v[0][0],
                                             &w->force[0][0], w->push, step % 10 ? NULL : w->mass,
                                             &damped, &fastest);
    }
    *hash = digest(0xcbf29ce484222325u, w->u, sizeof w->u);
    *hash = digest(*hash, w->v, sizeof w->v);
    *hash = digest(*hash, &fastest, sizeof fastest);
    free(w);
    return good;
}

static int print_digest(const lar_kernels *kernels, lar_law law, const lar_fibre *fibre,
                        const form *as) {
    static const char *const fibres[] = {"",
                                         "+active",
                                         "+active",
                                         "+exp-pow",
                                         "+exp-pow~",
                                         "+exp-linear",
                                         "+exp-linear~",
                                         "+pow-linear",
                                         "+pow-linear~",
                                         "+hgo",
                                         "+hgo~"};
    char with[40];
    snprintf(with, sizeof with, "%s%s", fibres[lar_fibre_kind_single(fibre)],
             lar_fibre_families(fibre) == 2 ? "x2" : "");
    static const char *const body[] = {"crooked", "box0", "box1", "box2"};
    static const char *const shape[] = {"general", "box"};
    static const char *const rows[] = {"loose", "rows-of-four", "rows-of-eight"};
    uint64_t hash;
    if (!shake(kernels, law, fibre, as, &hash)) {
        fprintf(stderr, "digest: %s %s%s %s left the limits\n", kernels->name, lar_law_name[law],
                with, body[as->turn + 1]);
        return 1;
    }
    printf("%s %s%s %s %016" PRIx64 " %s %s\n", kernels->name, lar_law_name[law], with,
           body[as->turn + 1], hash, shape[as->shape], rows[as->rows]);
    return 0;
}

int main(void) {
    static const lar_fibre none,
        fibres[] = {
            {.law = LAR_FIBRE_EXP_POW, .parameter = {2e3, 1, 2.5}, .along = 300},
            {.law = LAR_FIBRE_EXP_POW, .parameter = {2e3, 1, 2}, .isochoric = true},
            {.law = LAR_FIBRE_EXP_LINEAR, .parameter = {300, 9, 5e3, 1.1}, .across = 200},
            {.law = LAR_FIBRE_EXP_LINEAR, .parameter = {300, 9, 5e3, 1.1}, .isochoric = true},
            {.law = LAR_FIBRE_POW_LINEAR, .parameter = {4e3, 1.05, 3}},
            {.law = LAR_FIBRE_POW_LINEAR, .parameter = {3e3, 1.1, 2}, .isochoric = true},
            {.law = LAR_FIBRE_HGO, .parameter = {2e3, 1, 0.1}, .isochoric = true, .paired = true},
            {.along = 400}};
    int failures = 0;
    for (lar_isa isa = LAR_ISA_C; isa <= LAR_ISA_AVX512; isa++) {
        const lar_kernels *kernels = NULL;
        if (lar_kernels_find(isa, &kernels, NULL)) continue;
        for (int law = 0; law < LAR_LAW_COUNT; law++)
            for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++)
                failures += print_digest(kernels, (lar_law)law, &none, &forms[i]);
        for (size_t k = 0; k < sizeof fibres / sizeof *fibres; k++)
            for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++)
                failures += print_digest(kernels, LAR_LAW_neo_hookean, &fibres[k], &forms[i]);
    }
    return failures != 0;
}
