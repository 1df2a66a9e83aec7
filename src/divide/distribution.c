#include "divide/distribution.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "divide/cut.h"
#include "divide/random.h"

lar_status lar_distribution_create(const lar_mesh *mesh, const lar_grid *grid,
                                   lar_distribution *out, lar_error *error) {
    if (grid->count > mesh->element_count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a grid of %d processors is too large for %d elements; every processor "
                        "needs at least one, choose a smaller grid",
                        (int)grid->count, (int)mesh->element_count);
    int32_t *processor = lar_calloc((size_t)mesh->element_count, sizeof *processor);
    if (!processor)
        return lar_fail_memory(error, (size_t)mesh->element_count * sizeof *processor,
                               "a distribution");
    *out = (lar_distribution){*grid, mesh->element_count, processor};
    return LAR_OK;
}

void lar_distribution_clear(lar_distribution *distribution) {
    free(distribution->processor);
    *distribution = (lar_distribution){0};
}

lar_status lar_distribution_cut_by_weight(const lar_mesh *mesh, const lar_grid *grid,
                                          const float *weight, lar_distribution *out,
                                          lar_error *error) {
    lar_distribution made = {0};
    lar_status status = lar_distribution_create(mesh, grid, &made, error);
    if (status) return status;
    size_t elements = (size_t)mesh->element_count;
    double(*logical)[3] = lar_calloc(elements, sizeof *logical);
    lar_cut_item *item = lar_calloc(elements, sizeof *item);
    if (logical && item) {
        lar_logical_positions(mesh, logical);
        lar_cut_by_weight(grid, mesh->element_count, (const double(*)[3])logical, weight, item,
                          made.processor);
        *out = made;
    } else {
        status = lar_fail_memory(error, elements * (sizeof *item + sizeof *logical), "cutting");
        lar_distribution_clear(&made);
    }
    free(logical);
    free(item);
    return status;
}

lar_status lar_distribution_cut(const lar_mesh *mesh, const lar_grid *grid, lar_distribution *out,
                                lar_error *error) {
    return lar_distribution_cut_by_weight(mesh, grid, NULL, out, error);
}

lar_status lar_distribution_random(const lar_mesh *mesh, const lar_grid *grid, uint64_t seed,
                                   lar_distribution *out, lar_error *error) {
    lar_status status = lar_distribution_create(mesh, grid, out, error);
    if (status) return status;
    lar_random random = {seed};
    for (int32_t e = 0; e < out->element_count; e++) out->processor[e] = e % grid->count;
    for (int32_t e = out->element_count - 1; e > 0; e--) {
        int32_t other = lar_random_below(&random, e + 1), p = out->processor[e];
        out->processor[e] = out->processor[other];
        out->processor[other] = p;
    }
    return LAR_OK;
}

bool lar_distribution_load(const lar_distribution *distribution, int32_t *count) {
    int32_t processors = distribution->grid.count;
    int32_t max = (distribution->element_count + processors - 1) / processors;
    bool balanced = true;
    memset(count, 0, (size_t)processors * sizeof *count);
    for (int32_t e = 0; e < distribution->element_count; e++)
        balanced &= ++count[distribution->processor[e]] <= max;
    return balanced;
}

uint64_t lar_mesh_fingerprint(const lar_mesh *mesh) {
    uint64_t hash = lar_hash_word((uint64_t)mesh->node_count, (uint64_t)mesh->element_count);
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++) hash = lar_hash_word(hash, (uint64_t)mesh->element[e][a]);
    return hash;
}
