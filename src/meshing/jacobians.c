#include <math.h>

#include "meshing/deviation.h"

void lar_jacobians_count(const lar_mesh *mesh, lar_jacobians *jacobians) {
    *jacobians = (lar_jacobians){.min = mesh->element_count > 0 ? INFINITY : 0};
    double sum = 0;
    int32_t above_02 = 0, above_05 = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        const double jacobian = lar_scaled_jacobian((const double(*)[3])corner);
        int bin = (int)floor(10 * jacobian);
        if (bin < 0) bin = 0;
        if (bin > 9) bin = 9;
        jacobians->bin[bin]++;
        above_02 += jacobian > 0.2;
        above_05 += jacobian > 0.5;
        sum += jacobian;
        if (jacobian >= jacobians->min) continue;
        jacobians->min = jacobian;
        jacobians->worst = e;
    }
    if (mesh->element_count == 0) return;
    jacobians->mean = sum / mesh->element_count;
    jacobians->above_02 = (double)above_02 / mesh->element_count;
    jacobians->above_05 = (double)above_05 / mesh->element_count;
}
