#include "meshing/starter/sag.h"

#include <math.h>

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
        if (handle[n]) s->load[n][axis][PULL] = 1. / pulled;
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

lar_status lar_sag_estimate(const lar_meshing *meshing, const bool *held, const bool *handle,
                            int axis, lar_sag *motion, double *sag, lar_error *error) {
    lar_ways s;
    *motion = (lar_sag){0};
    lar_status status = prepare(&s, meshing, held, error);
    if (!status) {
        apply_loads(&s, handle, axis);
        status =
            lar_elastic_solve(&s.elastic, (const lar_load_vectors *)s.load, s.way, s.work, error);
    }
    if (!status) {
        motion->slowest = lar_ways_slowest(&s);
        motion->compliance = s.work[PULL]; /* of one newton */
        if (sag) find_sag(&s, sag);
    }
    lar_ways_clear(&s);
    return status;
}
