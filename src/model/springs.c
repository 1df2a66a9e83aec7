#include "model/springs.h"

#include <math.h>
#include <stdlib.h>

lar_status lar_spring_squares(const lar_model *model, double **most, lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    size_t nodes = (size_t)mesh->node_count;
    *most = NULL;
    if (model->spring_count == 0) return LAR_OK;
    double(*at)[2] = lar_calloc(nodes, sizeof *at); /* stiffness, mass */
    *most = lar_calloc(nodes, sizeof **most);
    if (!at || !*most) {
        free(at);
        return lar_fail_memory(error, nodes * sizeof(double[3]), "springs");
    }
    for (int i = 0; i < model->spring_count; i++)
        for (int32_t k = 0; k < model->spring[i].nodes.count; k++)
            at[model->spring[i].nodes.node[k]][0] += model->spring[i].stiffness[k];
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        double mass = lar_model_material_of(model, e)->density * lar_hexahedron_volume(corner) / 8;
        for (int a = 0; a < 8; a++) at[mesh->element[e][a]][1] += mass;
    }
    for (size_t n = 0; n < nodes; n++) (*most)[n] = at[n][0] > 0 ? at[n][0] / at[n][1] : 0;
    free(at);
    return LAR_OK;
}

double lar_spring_square(const lar_model *model, const double *squares, lar_gid e) {
    double most = 0;
    for (int a = 0; squares && a < 8; a++) most = fmax(most, squares[model->mesh.element[e][a]]);
    return most;
}
