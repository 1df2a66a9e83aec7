/* Hourglass forces are as stiff along a flat element's thickness as along its width, where bending
 * asks for little (docs/theory.md, "Hourglass control"). Pressure is what folds it: in layers that
 * nothing lets escape, nodes in the middle go up and down in turns. */
#include "cli/report/zigzag.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/vector.h"

/* Longest over shortest mean edge of an element at rest. */
static double flatness(const double (*position)[3], const int32_t *node) {
    static const int along[3][4] = {{0, 3, 4, 7}, {0, 1, 4, 5}, {0, 1, 2, 3}};
    static const int other[3][4] = {{1, 2, 5, 6}, {3, 2, 7, 6}, {4, 5, 6, 7}};
    double least = INFINITY, most = 0;
    for (int axis = 0; axis < 3; axis++) {
        double length = 0;
        for (int k = 0; k < 4; k++) {
            double edge[3];
            lar_minus(position[node[other[axis][k]]], position[node[along[axis][k]]], edge);
            length += 0.25 * lar_length(edge);
        }
        least = fmin(least, length);
        most = fmax(most, length);
    }
    return least > 0 ? most / least : INFINITY;
}

/* Its pressure in shear moduli, of either sign; 0 where it is not flat, or may be compressed. */
static double pressed(const lar_model *model, const double (*position)[3], int32_t element,
                      const double stress[6]) {
    static const double FLAT = 2, BULK = 30; /* sides, and shear moduli */
    lar_material_info material = {0};
    if (lar_model_material(model, lar_model_element_material(model, element), &material, NULL) ||
        !(material.bulk_modulus > BULK * material.shear_modulus) ||
        !(flatness(position, lar_model_element_nodes(model, element)) > FLAT))
        return 0;
    return fabs(stress[0] + stress[1] + stress[2]) / 3 / material.shear_modulus;
}

zigzag zigzag_find(const lar_simulation *simulation, const lar_model *model) {
    static const double ENOUGH = 0.5; /* [shear moduli] */
    const int32_t elements = lar_model_element_count(model);
    const double(*position)[3] = lar_model_positions(model);
    double(*stress)[6] = lar_calloc((size_t)elements + 1, sizeof *stress);
    zigzag found = {0};
    if (stress && !lar_simulation_stresses(simulation, stress, NULL, NULL))
        for (int32_t e = 0; e < elements; e++) {
            const double most = pressed(model, position, e, stress[e]);
            if (!(most > ENOUGH)) continue;
            found.elements++;
            found.most = fmax(found.most, most);
        }
    free(stress);
    return found;
}
