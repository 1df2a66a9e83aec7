#include "meshing/starter/sag.h"

#include <math.h>
#include <stdlib.h>

#include "meshing/starter/slowest.h"

static const double GRAVITY = 9.81;
enum { PULL = 3 }; /* the load that is not weight */

static const lar_region_info *region_of(const lar_meshing *m, int32_t tag) {
    for (int32_t r = 0; r < m->info.regions; r++)
        if (m->region[r].tag == tag) return &m->region[r];
    return NULL;
}

static lar_status prepare(lar_ways *s, const lar_meshing *m, const bool *held, lar_error *error) {
    lar_status status = lar_ways_create(&m->mesh, s, error);
    if (status) return status;
    for (int32_t e = 0; e < m->mesh.element_count; e++) {
        const lar_region_info *region = region_of(m, m->mesh.element_tag[e]);
        if (!region || region->held) continue;
        lar_ways_weigh(s, e, region->density,
                       (lar_elastic_material){region->shear_modulus, region->bulk_modulus, false});
    }
    for (int32_t n = 0; n < m->mesh.node_count; n++) s->still[n] = held[n] ? LAR_AXIS_ALL : 0;
    status = lar_elastic_create(&m->mesh, s->material, s->still, NULL, &s->elastic, error);
    s->elastic.goes_on = m->goes_on;
    s->elastic.asker = m->asker;
    return status;
}

static void apply_loads(lar_ways *s, const bool *handle, int axis) {
    int32_t pulled = 0;
    for (int32_t n = 0; n < s->mesh->node_count; n++) pulled += handle[n] && !s->still[n];
    for (int32_t n = 0; n < s->mesh->node_count; n++) {
        if (s->still[n]) continue;
        for (int i = 0; i < 3; i++) s->load[n][i][i] = s->mass[n] * GRAVITY;
        s->load[n][axis][PULL] = handle[n] ? 1. / pulled : 0;
    }
}

static void find_sag(const lar_ways *s, double *sag) {
    for (int32_t n = 0; n < s->mesh->node_count; n++) {
        double max = 0;
        for (int l = 0; l < PULL; l++) {
            double square = 0;
            for (int i = 0; i < 3; i++) square += s->way[n][i][l] * s->way[n][i][l];
            max = fmax(max, square);
        }
        sag[n] = sqrt(max);
    }
}

static int by_way(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Takes out of the handle what would go more than LOOSE times its median way. */
static lar_status drop_loose(const lar_ways *s, bool *handle, int axis, bool *dropped,
                             lar_error *error) {
    static const double LOOSE = 3;
    size_t count = 0;
    double *way = lar_calloc((size_t)s->mesh->node_count + 1, sizeof *way);
    if (!way) return lar_fail_memory(error, (size_t)s->mesh->node_count * sizeof *way, "ways");
    for (int32_t n = 0; n < s->mesh->node_count; n++)
        if (handle[n] && !s->still[n]) way[count++] = s->way[n][axis][PULL];
    qsort(way, count, sizeof *way, by_way);
    const double far = LOOSE * way[count / 2];
    free(way);
    *dropped = false;
    for (int32_t n = 0; far > 0 && n < s->mesh->node_count; n++)
        if (handle[n] && !s->still[n] && s->way[n][axis][PULL] > far) {
            handle[n] = false;
            *dropped = true;
        }
    return LAR_OK;
}

static lar_status solve(lar_ways *s, const bool *handle, int axis, lar_error *error) {
    apply_loads(s, handle, axis);
    return lar_ways_solve(s, error);
}

lar_status lar_sag_estimate(const lar_meshing *meshing, const bool *held, bool *handle, int axis,
                            lar_sag *motion, double *sag, lar_error *error) {
    lar_ways s;
    *motion = (lar_sag){0};
    lar_status status = prepare(&s, meshing, held, error);
    if (!status) {
        bool dropped = false;
        status = solve(&s, handle, axis, error);
        if (!status) status = drop_loose(&s, handle, axis, &dropped, error);
        if (!status && dropped) status = solve(&s, handle, axis, error);
    }
    if (!status) {
        motion->slowest = lar_ways_slowest(&s);
        motion->compliance = s.work[PULL]; /* of one newton */
        if (sag) find_sag(&s, sag);
    }
    lar_ways_clear(&s);
    return status;
}
