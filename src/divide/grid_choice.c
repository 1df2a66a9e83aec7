#include "divide/grid_choice.h"

#include <stdlib.h>

#include "base/memory.h"
#include "divide/cost.h"
#include "divide/distribution.h"

/* Scratch of the search for a grid. */
typedef struct grid_search {
    const lar_mesh *mesh;
    lar_incidence incidence;
    int32_t *set;
    int64_t *pays;
    lar_grid best;
    lar_cost least;
} grid_search;

static lar_status try_grid(grid_search *s, int32_t nx, int32_t ny, int32_t nz, lar_error *error) {
    lar_grid grid;
    lar_distribution distribution = {0};
    lar_status status = lar_grid_make(nx, ny, nz, &grid, error);
    if (!status) status = lar_distribution_cut(s->mesh, &grid, &distribution, error);
    if (!status) {
        lar_cost cost =
            lar_cost_measure(&s->incidence, distribution.processor, grid.count, s->set, s->pays);
        if (s->best.count == 0 || lar_cost_less(cost, s->least)) {
            s->best = grid;
            s->least = cost;
        }
    }
    lar_distribution_clear(&distribution);
    return status;
}

lar_status lar_grid_cheapest(const lar_mesh *mesh, int32_t count, lar_grid *grid,
                             lar_error *error) {
    grid_search s = {.mesh = mesh};
    lar_status status = lar_incidence_build(mesh, &s.incidence, error);
    if (!status) {
        s.set = lar_calloc((size_t)s.incidence.most, sizeof *s.set);
        s.pays = lar_calloc((size_t)count, sizeof *s.pays);
        if (!s.set || !s.pays) status = lar_fail_memory(error, (size_t)count * 8, "a grid");
    }
    for (int32_t nx = count; nx >= 1 && !status; nx--)
        for (int32_t ny = count / nx; count % nx == 0 && ny >= 1 && !status; ny--)
            if (count / nx % ny == 0) status = try_grid(&s, nx, ny, count / nx / ny, error);
    if (!status) *grid = s.best;
    lar_incidence_clear(&s.incidence);
    free(s.set);
    free(s.pays);
    return status;
}
