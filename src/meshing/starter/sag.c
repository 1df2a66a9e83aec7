#include "meshing/starter/sag.h"

#include <math.h>
#include <stdlib.h>

#include "meshing/starter/elastic.h"

static const double GRAVITY = 9.81;
enum { PULL = 3 }; /* the load that is not weight */

/* What is solved for, and from what. */
typedef struct solution {
    const lar_mesh *mesh;
    lar_elastic elastic;
    double *mass;                 /* [nodes] of what moves */
    lar_load_vectors *load, *way; /* [nodes] */
    double work[LAR_LOADS];
} solution;

static const lar_region_info *region_of(const lar_meshing *m, int32_t tag) {
    for (int32_t r = 0; r < m->info.regions; r++)
        if (m->region[r].tag == tag) return &m->region[r];
    return NULL;
}

/* Elements' materials and nodes' masses. */
static void weigh(const lar_meshing *m, lar_elastic_material *material, double *mass) {
    for (int32_t e = 0; e < m->mesh.element_count; e++) {
        const lar_region_info *region = region_of(m, m->mesh.element_tag[e]);
        if (!region || region->held) continue;
        double corner[8][3];
        lar_mesh_corners(&m->mesh, e, corner);
        double eighth = region->density * lar_hexahedron_volume(corner) / 8;
        material[e] = (lar_elastic_material){region->shear_modulus, region->bulk_modulus};
        for (int a = 0; a < 8; a++) mass[m->mesh.element[e][a]] += eighth;
    }
}

static lar_status prepare(solution *s, const lar_meshing *m, const bool *held, lar_error *error) {
    size_t nodes = (size_t)m->mesh.node_count, elements = (size_t)m->mesh.element_count;
    lar_elastic_material *material = lar_calloc(elements, sizeof *material);
    s->mesh = &m->mesh;
    s->mass = lar_calloc(nodes, sizeof *s->mass);
    s->load = lar_calloc(nodes, sizeof *s->load);
    s->way = lar_calloc(nodes, sizeof *s->way);
    lar_status status = material && s->mass && s->load && s->way
                            ? LAR_OK
                            : lar_fail_memory(error, 200 * nodes, "an estimate of motion");
    if (!status) {
        weigh(m, material, s->mass);
        status = lar_elastic_create(&m->mesh, material, held, &s->elastic, error);
        s->elastic.goes_on = m->goes_on;
        s->elastic.asker = m->asker;
    }
    free(material);
    return status;
}

static void apply_loads(solution *s, const bool *handle, int axis) {
    int32_t pulled = 0;
    for (int32_t n = 0; n < s->mesh->node_count; n++) pulled += handle[n] && !s->elastic.still[n];
    for (int32_t n = 0; n < s->mesh->node_count; n++) {
        if (s->elastic.still[n]) continue;
        for (int i = 0; i < 3; i++) s->load[n][i][i] = s->mass[n] * GRAVITY;
        if (handle[n]) s->load[n][axis][PULL] = 1. / pulled;
    }
}

/* Rayleigh's quotients; u K u is the work of the load. */
static double slowest(const solution *s) {
    double min = INFINITY;
    for (int l = 0; l < LAR_LOADS; l++) {
        double moved = 0;
        for (int32_t n = 0; n < s->mesh->node_count; n++)
            for (int i = 0; i < 3; i++) moved += s->mass[n] * s->way[n][i][l] * s->way[n][i][l];
        if (moved > 0 && s->work[l] > 0) min = fmin(min, sqrt(s->work[l] / moved));
    }
    return isfinite(min) ? min : 0;
}

static void find_sag(const solution *s, double *sag) {
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
    solution s = {0};
    *motion = (lar_sag){0};
    lar_status status = prepare(&s, meshing, held, error);
    if (!status) {
        apply_loads(&s, handle, axis);
        status =
            lar_elastic_solve(&s.elastic, (const lar_load_vectors *)s.load, s.way, s.work, error);
    }
    if (!status) {
        motion->slowest = slowest(&s);
        motion->compliance = s.work[PULL]; /* of one newton */
        if (sag) find_sag(&s, sag);
    }
    lar_elastic_clear(&s.elastic);
    free(s.mass);
    free(s.load);
    free(s.way);
    return status;
}
