/* Distributions from METIS (Karypis and Kumar 1998), the yardstick of today. Optional. */
#include "divide/distribution.h"

#include <stdlib.h>
#include <string.h>

#ifdef LAR_HAVE_METIS
#include <metis.h>

#include "divide/balance.h"

/* METIS meets a balance of 3 % well and a tighter one badly (its cuts become several times longer),
 * so the last elements are moved by lar_balance. It is fast: the best of some seeds is taken. */
enum { SEEDS = 8, LOOSE_PER_MILLE = 30, COMMON_NODES = 4 };

typedef struct metis_input {
    idx_t elements, nodes;
    idx_t *first, *corner, *element_part, *node_part;
} metis_input;

static lar_status input_build(const lar_mesh *mesh, metis_input *in, lar_error *error) {
    size_t elements = (size_t)mesh->element_count;
    *in = (metis_input){.elements = mesh->element_count,
                        .nodes = mesh->node_count,
                        .first = lar_calloc(elements + 1, sizeof *in->first),
                        .corner = lar_calloc(8 * elements, sizeof *in->corner),
                        .element_part = lar_calloc(elements, sizeof *in->element_part),
                        .node_part = lar_calloc((size_t)mesh->node_count, sizeof *in->node_part)};
    if (!in->first || !in->corner || !in->element_part || !in->node_part)
        return lar_fail_memory(error, 8 * elements * sizeof(idx_t), "METIS");
    for (size_t e = 0; e <= elements; e++) in->first[e] = (idx_t)(8 * e);
    for (size_t e = 0; e < elements; e++)
        for (int a = 0; a < 8; a++) in->corner[8 * e + (size_t)a] = mesh->element[e][a];
    return LAR_OK;
}

static void input_clear(metis_input *in) {
    free(in->first);
    free(in->corner);
    free(in->element_part);
    free(in->node_part);
}

static lar_status divide(metis_input *in, int32_t parts, uint64_t seed, int32_t *part,
                         lar_error *error) {
    idx_t options[METIS_NOPTIONS], common = COMMON_NODES, count = parts, cut = 0;
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_SEED] = (idx_t)(seed & 0x3fffffff);
    options[METIS_OPTION_UFACTOR] = LOOSE_PER_MILLE;
    int result =
        METIS_PartMeshDual(&in->elements, &in->nodes, in->first, in->corner, NULL, NULL, &common,
                           &count, NULL, options, &cut, in->element_part, in->node_part);
    if (result == METIS_ERROR_MEMORY) return lar_fail_memory(error, 0, "METIS");
    if (result != METIS_OK)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "METIS refuses to divide this mesh into %d (its error %d); choose another "
                        "method",
                        (int)parts, result);
    for (idx_t e = 0; e < in->elements; e++) part[e] = (int32_t)in->element_part[e];
    return LAR_OK;
}

/* ---- places in the grid ----------------------------------------------------------------- */

/* Nodes that two parts have in common, times the distance of their places: what is to be low. */
static int64_t way_of(const lar_grid *grid, const int64_t *common, const int32_t *place,
                      int32_t part) {
    int64_t way = 0;
    for (int32_t other = 0; other < grid->count; other++)
        way += common[(size_t)part * (size_t)grid->count + (size_t)other] *
               lar_grid_distance(grid, place[part], place[other]);
    return way;
}

static bool try_swap(const lar_grid *grid, const int64_t *common, int32_t *place, int32_t a,
                     int32_t b) {
    int64_t before = way_of(grid, common, place, a) + way_of(grid, common, place, b);
    int32_t swap = place[a];
    place[a] = place[b];
    place[b] = swap;
    if (way_of(grid, common, place, a) + way_of(grid, common, place, b) < before) return true;
    place[b] = place[a];
    place[a] = swap;
    return false;
}

/* Parts swap places as long as that brings common nodes nearer. */
static lar_status give_places(const lar_incidence *incidence, lar_distribution *d,
                              lar_error *error) {
    size_t n = (size_t)d->grid.count;
    int64_t *common = lar_calloc(n * n, sizeof *common);
    int32_t *place = lar_calloc(n, sizeof *place);
    int32_t *set = lar_calloc((size_t)incidence->max, sizeof *set);
    lar_status status = LAR_OK;
    if (common && place && set) {
        for (int32_t k = 0; k < incidence->node_count; k++) {
            int32_t count = lar_node_processors(incidence, d->processor, k, set);
            for (int32_t i = 0; i < count; i++)
                for (int32_t j = 0; j < count; j++)
                    common[(size_t)set[i] * n + (size_t)set[j]] += i != j;
        }
        for (int32_t p = 0; p < d->grid.count; p++) place[p] = p;
        for (bool better = true; better;) {
            better = false;
            for (int32_t a = 0; a < d->grid.count; a++)
                for (int32_t b = a + 1; b < d->grid.count; b++)
                    better |= try_swap(&d->grid, common, place, a, b);
        }
        for (int32_t e = 0; e < d->element_count; e++) d->processor[e] = place[d->processor[e]];
    } else {
        status = lar_fail_memory(error, n * n * sizeof *common, "places in the grid");
    }
    free(common);
    free(place);
    free(set);
    return status;
}

/* ---- the best of some seeds ------------------------------------------------------------- */

typedef struct metis_trial {
    int32_t *part;
    int32_t *set;
    int64_t *pays;
} metis_trial;

static lar_status best_of_seeds(const lar_mesh *mesh, const lar_incidence *incidence, uint64_t seed,
                                metis_input *in, metis_trial *trial, lar_distribution *d,
                                lar_error *error) {
    lar_cost best = {0};
    for (int i = 0; i < SEEDS; i++) {
        lar_status status = divide(in, d->grid.count, seed + (uint64_t)i, trial->part, error);
        if (!status) status = lar_balance(mesh, incidence, d->grid.count, trial->part, error);
        if (status) return status;
        lar_cost cost =
            lar_cost_measure(incidence, trial->part, d->grid.count, trial->set, trial->pays);
        if (i > 0 && !lar_cost_less(cost, best)) continue;
        best = cost;
        memcpy(d->processor, trial->part, (size_t)d->element_count * sizeof *d->processor);
    }
    return LAR_OK;
}

lar_status lar_distribution_metis(const lar_mesh *mesh, const lar_incidence *incidence,
                                  const lar_grid *grid, uint64_t seed, lar_distribution *out,
                                  lar_error *error) {
    lar_distribution d = {0};
    lar_status status = lar_distribution_create(mesh, grid, &d, error);
    if (status) return status;
    if (grid->count > 1) {
        metis_input in = {0};
        metis_trial trial = {lar_calloc((size_t)mesh->element_count, sizeof *trial.part),
                             lar_calloc((size_t)incidence->max, sizeof *trial.set),
                             lar_calloc((size_t)grid->count, sizeof *trial.pays)};
        if (trial.part && trial.set && trial.pays)
            status = input_build(mesh, &in, error);
        else
            status = lar_fail_memory(error, 4 * (size_t)mesh->element_count, "METIS");
        if (!status) status = best_of_seeds(mesh, incidence, seed, &in, &trial, &d, error);
        if (!status) status = give_places(incidence, &d, error);
        input_clear(&in);
        free(trial.part);
        free(trial.set);
        free(trial.pays);
    }
    if (status)
        lar_distribution_clear(&d);
    else
        *out = d;
    return status;
}

bool lar_distribution_has_metis(void) {
    return true;
}

#else

lar_status lar_distribution_metis(const lar_mesh *mesh, const lar_incidence *incidence,
                                  const lar_grid *grid, uint64_t seed, lar_distribution *out,
                                  lar_error *error) {
    (void)mesh, (void)incidence, (void)grid, (void)seed, (void)out;
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "this Lariat was built without METIS; install libmetis-dev and build again, or "
                    "choose another method");
}

bool lar_distribution_has_metis(void) {
    return false;
}

#endif
