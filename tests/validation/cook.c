#include "validation/cook.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void load_right_edge(lar_model *model, int cells) {
    lar_node_list edge = nodes_at(model, 0, 0.048);
    assert_int_equal(edge.count, 2 * (cells + 1));
    int curve = add_ramp(model, 0, 1 / COOK_DAMPING, 0, 1);
    for (int32_t i = 0; i < edge.count; i++) {
        double y = model->mesh.position[edge.node[i]][1];
        bool end = fabs(y - 0.044) < 1e-6 || fabs(y - 0.060) < 1e-6;
        lar_nodal_load *load = LAR_MODEL_APPEND(model, load);
        int32_t *node = lar_calloc(1, sizeof *node);
        assert_true(load && node);
        *node = edge.node[i];
        *load =
            (lar_nodal_load){{1, node}, {0, 100.0 / (2 * cells) * (end ? 0.5 : 1), 0}, curve, 0};
    }
    free(edge.node);
}

lar_model *cook_model(int cells, bool plane_strain) {
    char name[64];
    snprintf(name, sizeof name, "b_cook_%dx%dx1", cells, cells);
    lar_model *model = reference_model(name, 1e-3, 80.194e6, 400889.8e6, 1000);
    fix_nodes(model, nodes_at(model, 0, 0), LAR_AXIS_ALL);
    fix_nodes(model, nodes_at(model, 2, 0), LAR_AXIS_Z);
    if (plane_strain) fix_nodes(model, nodes_at(model, 2, 1e-3), LAR_AXIS_Z);
    load_right_edge(model, cells);
    model->damping = COOK_DAMPING;
    return model;
}

int32_t cook_tip(const lar_model *model) {
    return node_near(model, 0.048, 0.060, 0);
}
