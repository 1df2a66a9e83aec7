#include "step/mass/masses.h"

#include <stdlib.h>
#include <string.h>

#include "mechanics/hexahedron.h"

void lar_masses_spread(const lar_model *model, const lar_layout *layout,
                       const lar_element_rate *rate, double *mass, double *added) {
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(&model->mesh, e, corner);
        double share = lar_model_material_of(model, e)->density * lar_hexahedron_volume(corner) / 8;
        for (int a = 0; a < 8; a++) {
            lar_lid n = layout->local[model->mesh.element[e][a]];
            mass[n] += share;
            if (added) added[n] += rate[e].added;
        }
    }
    for (int32_t n = 0; added && n < layout->node_padded; n++) mass[n] += added[n];
}

static double *copy_of(const double *from, size_t count) {
    double *made = from ? lar_calloc_aligned(count, sizeof *made) : NULL;
    if (made) memcpy(made, from, count * sizeof *made);
    return made;
}

lar_burden *lar_burden_create(const double *mass, const double *added, size_t nodes) {
    lar_burden *burden = lar_calloc(1, sizeof *burden);
    if (!burden) return NULL;
    burden->mass = copy_of(mass, nodes);
    burden->added = copy_of(added, nodes);
    if (burden->mass && (!added || burden->added)) return burden;
    lar_burden_destroy(burden);
    return NULL;
}

lar_burden *lar_burden_copy(const lar_burden *from, size_t nodes) {
    lar_burden *burden = lar_burden_create(from->mass, from->added, nodes);
    if (!burden) return NULL;
    burden->most = from->most;
    burden->now = from->now;
    burden->node_count = from->node_count;
    memcpy(burden->node, from->node, sizeof burden->node);
    return burden;
}

void lar_burden_destroy(lar_burden *burden) {
    if (!burden) return;
    free(burden->mass);
    free(burden->added);
    free(burden);
}

double lar_burden_most(const lar_model *model, const lar_element_rate *rate) {
    double mass = 0;
    for (lar_gid e = 0; e < model->mesh.element_count; e++)
        mass += 8 * (rate[e].mass - rate[e].added);
    return model->strained_share * mass;
}
