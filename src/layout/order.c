#include "layout/order.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

typedef struct ranked {
    uint64_t key;
    lar_gid element;
} ranked;

/* Spreads the lowest 20 bits of x to every third bit. */
static uint64_t spread_bits(uint64_t x) {
    x = (x | x << 32) & 0x001f00000000ffffULL;
    x = (x | x << 16) & 0x001f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    return (x | x << 2) & 0x1249249249249249ULL;
}

static int compare_ranked(const void *a, const void *b) {
    const ranked *left = a, *right = b;
    if (left->key != right->key) return left->key < right->key ? -1 : 1;
    return left->element < right->element ? -1 : left->element > right->element;
}

static void center_of(const lar_mesh *mesh, lar_gid e, double center[3]) {
    for (int i = 0; i < 3; i++) {
        center[i] = 0;
        for (int a = 0; a < 8; a++) center[i] += mesh->position[mesh->element[e][a]][i] / 8;
    }
}

lar_status lar_order_elements(const lar_model *model, lar_gid *order, int32_t count,
                              lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    ranked *rank = lar_calloc((size_t)count, sizeof *rank);
    if (!rank) return lar_fail_memory(error, (size_t)count * sizeof *rank, "the element order");

    double lower[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, upper = 0;
    for (int32_t n = 0; n < mesh->node_count; n++)
        for (int i = 0; i < 3; i++) lower[i] = fmin(lower[i], mesh->position[n][i]);
    for (int32_t n = 0; n < mesh->node_count; n++)
        for (int i = 0; i < 3; i++) upper = fmax(upper, mesh->position[n][i] - lower[i]);

    const double cells = 0xfffff; /* 2^20 - 1 per axis */
    for (int32_t i = 0; i < count; i++) {
        lar_gid e = order[i];
        double center[3];
        center_of(mesh, e, center);
        uint64_t key = (uint64_t)lar_model_material_of(model, e)->law << 60;
        for (int k = 0; k < 3; k++)
            key |= spread_bits((uint64_t)(cells * (center[k] - lower[k]) / upper)) << k;
        rank[i] = (ranked){key, e};
    }
    qsort(rank, (size_t)count, sizeof *rank, compare_ranked);
    for (int32_t i = 0; i < count; i++) order[i] = rank[i].element;
    free(rank);
    return LAR_OK;
}
