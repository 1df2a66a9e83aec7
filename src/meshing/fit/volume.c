#include <math.h>
#include <stdlib.h>

#include "base/vector.h"
#include "meshing/fit/work.h"

/* Faces of a pair (a, b) that lie `offset` farther towards a take offset * area from a and give it
 * to b. Of all offsets that restore the volumes those are taken that change least, where a change
 * of an outer face, which is seen, counts more than one of an interface: offset = ease *
 * (p_b - p_a) with a pressure p per region, 0 outside, and an ease of 1 for interfaces, so that for
 * each region r
 *
 *     sum over its pairs (r, s) of ease * area * (p_r - p_s) = what r misses
 *
 * a small symmetric positive definite system, solved by damped Jacobi iteration. Flat cuts stay
 * where they are. */
enum { SWEEPS = 1000 };

/* Of outer faces. A power of two: a body of one region, where it has no meaning, keeps its bits. */
static const double EASE_OUTER = 0.5;

static double ease(const lar_fit_pair *pair) {
    return pair->region[0] == 0 ? EASE_OUTER : 1;
}

/* Beyond this many cells the mesh cannot follow: a region that misses so much lacks cells. Where
 * interfaces give way to outer faces they stand off farther for the same volume. */
static double farthest(const lar_fit_pair *pair) {
    return pair->region[0] == 0 ? 0.8 : 1.2;
}

static void measure_areas(lar_fit_work *work) {
    for (int32_t p = 0; p < work->pair_count; p++) work->pair[p].area = 0;
    for (int32_t f = 0; f < work->face_count; f++) {
        const lar_fit_face *face = &work->face[f];
        double area[3];
        lar_fit_area(work, face->node, area);
        work->pair[face->pair].area += lar_length(area);
    }
}

static void measure_missing(const lar_fit_work *work, double *missing) {
    const lar_mesh *mesh = work->mesh;
    const double cell = work->size * work->size * work->size;
    for (int32_t r = 1; r <= work->boundary->region_count; r++)
        missing[r] =
            (work->boundary->region[r].volume - (work->dropped ? work->dropped[r] : 0)) / cell;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double corner[8][3];
        lar_fit_corners(work, e, corner);
        missing[mesh->element_tag[e]] -= lar_hexahedron_volume(corner);
    }
}

static void solve_pressures(const lar_fit_work *work, const double *missing, double *pressure,
                            double *sum, double *area) {
    const int32_t regions = work->boundary->region_count;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        for (int32_t r = 0; r <= regions; r++) {
            sum[r] = missing[r];
            area[r] = 0;
        }
        for (int32_t p = 0; p < work->pair_count; p++) {
            const lar_fit_pair *pair = &work->pair[p];
            const int a = pair->region[0], b = pair->region[1];
            if (b >= LAR_REGION_CUT) continue;
            const double eased = ease(pair) * pair->area;
            area[a] += eased;
            area[b] += eased;
            sum[a] += eased * pressure[b];
            sum[b] += eased * pressure[a];
        }
        for (int32_t r = 1; r <= regions; r++)
            if (area[r] > 0) pressure[r] += 0.7 * (sum[r] / area[r] - pressure[r]);
    }
}

/* Where the elements' shape holds against an offset, volumes follow only by a part of it: what goes
 * on missing is asked for with more and more weight. */
static void weigh_missing(lar_fit_region *region, double *missing, size_t regions) {
    const double FOLLOWS = 0.6, MORE = 1.5, MAX = regions > 2 ? 8 : 4;
    for (size_t r = 1; r < regions; r++) {
        const double part = region[r].missing != 0 ? missing[r] / region[r].missing : 0;
        region[r].missing = missing[r];
        region[r].weight = part > FOLLOWS ? fmin(MORE * region[r].weight, MAX) : 1;
        missing[r] *= region[r].weight;
    }
}

lar_status lar_fit_volume_balance(lar_fit_work *work, double share, lar_error *error) {
    const size_t regions = (size_t)work->boundary->region_count + 1;
    double *table = lar_calloc(4 * regions, sizeof *table);
    if (!table) return lar_fail_memory(error, 4 * regions * sizeof *table, "the regions' volumes");
    double *missing = table, *pressure = table + regions;
    measure_areas(work);
    measure_missing(work, missing);
    weigh_missing(work->region, missing, regions);
    solve_pressures(work, missing, pressure, table + 2 * regions, table + 3 * regions);
    for (int32_t p = 0; p < work->pair_count; p++) {
        lar_fit_pair *pair = &work->pair[p];
        if (pair->region[1] >= LAR_REGION_CUT) continue;
        const double change = ease(pair) * (pressure[pair->region[1]] - pressure[pair->region[0]]);
        const double far = farthest(pair);
        pair->offset = fmax(fmin(pair->offset + share * change, far), -far);
    }
    free(table);
    return LAR_OK;
}
