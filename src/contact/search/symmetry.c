#include "contact/search/symmetry.h"

#include <math.h>
#include <stdlib.h>

static double tie_of(const lar_symmetry *s, int axis) {
    return 1e-6 * (s->end[3 + axis] - s->end[axis]);
}

static bool lies_at(const lar_symmetry *s, const lar_model *model, int32_t f, int end) {
    const int axis = end % 3;
    const double tie = tie_of(s, axis);
    bool lies = true;
    for (int a = 0; a < 4; a++) {
        const double x = model->mesh.position[model->surface.corner[f][a]][axis];
        lies = lies && fabs(x - s->end[end]) <= tie;
    }
    return lies;
}

lar_status lar_symmetry_find(const lar_model *model, lar_symmetry *s, lar_error *error) {
    const size_t nodes = (size_t)model->mesh.node_count;
    unsigned *held = lar_calloc(nodes, sizeof *held);
    if (!held) return lar_fail_memory(error, nodes * sizeof *held, "planes of symmetry");
    for (int i = 0; i < model->fix_count; i++)
        for (int32_t n = 0; n < model->fix[i].nodes.count; n++)
            held[model->fix[i].nodes.node[n]] |= model->fix[i].axes;
    *s = (lar_symmetry){{INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY}, {0}};
    for (int32_t k = 0; k < model->surface.node_count; k++)
        for (int i = 0; i < 3; i++) {
            const double x = model->mesh.position[model->surface.node[k]][i];
            s->end[i] = fmin(s->end[i], x);
            s->end[3 + i] = fmax(s->end[3 + i], x);
        }
    for (int32_t f = 0; f < model->surface.face_count; f++) {
        unsigned all = LAR_AXIS_ALL;
        for (int a = 0; a < 4; a++) all &= held[model->surface.corner[f][a]];
        for (int end = 0; end < 6 && all != LAR_AXIS_ALL; end++)
            s->cut[end] = s->cut[end] || ((all >> end % 3 & 1) && lies_at(s, model, f, end));
    }
    free(held);
    return LAR_OK;
}

bool lar_symmetry_cuts(const lar_symmetry *s, const lar_model *model, int32_t face) {
    bool cuts = false;
    for (int end = 0; end < 6; end++) cuts = cuts || (s->cut[end] && lies_at(s, model, face, end));
    return cuts;
}

bool lar_symmetry_ends(const lar_symmetry *s, const lar_model *model, int32_t face, double from[3],
                       double to[3]) {
    bool cuts = false;
    for (int end = 0; end < 6; end++) {
        if (!s->cut[end] || !lies_at(s, model, face, end)) continue;
        cuts = true;
        if (end < 3)
            from[end] = s->end[end] - tie_of(s, end);
        else
            to[end - 3] = s->end[end] + tie_of(s, end - 3);
    }
    return cuts;
}
