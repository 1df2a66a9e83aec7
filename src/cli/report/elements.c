#include "cli/report/elements.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vector.h"

/* ---- flat ------------------------------------------------------------------------------------ *
 * Hourglass forces are as stiff along a flat element's thickness as along its width, where bending
 * asks for little (docs/theory.md, "Hourglass control"). Pressure is what folds it: in layers that
 * nothing lets escape, nodes in the middle go up and down in turns. What keeps elements from that
 * (mechanics/fold) is enough for those up to five times as wide as thick. */

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

/* The shear moduli of the model's materials, 0 of those that may be compressed; NULL: no memory. */
static double *nearly_incompressible(const lar_model *model) {
    static const double BULK = 30; /* shear moduli */
    const int32_t count = lar_model_material_count(model);
    double *shear = lar_calloc((size_t)count + 1, sizeof *shear);
    for (int32_t m = 0; shear && m < count; m++) {
        lar_material_info material;
        if (!lar_model_material(model, m, &material, NULL) &&
            material.bulk_modulus > BULK * material.shear_modulus)
            shear[m] = material.shear_modulus;
    }
    return shear;
}

flat_elements flat_elements_find(const lar_simulation *simulation, const lar_model *model) {
    static const double FLAT = 5.01, ENOUGH = 0.5; /* sides, and shear moduli */
    const int32_t elements = lar_model_element_count(model);
    const double(*position)[3] = lar_model_positions(model);
    double(*stress)[6] = lar_calloc((size_t)elements + 1, sizeof *stress);
    double *shear = nearly_incompressible(model);
    flat_elements found = {0};
    if (stress && shear && !lar_simulation_stresses(simulation, stress, NULL, NULL))
        for (int32_t e = 0; e < elements; e++) {
            const double modulus = shear[lar_model_element_material(model, e)];
            const double pressure = fabs(stress[e][0] + stress[e][1] + stress[e][2]) / 3;
            if (!(modulus > 0 && pressure > ENOUGH * modulus) ||
                !(flatness(position, lar_model_element_nodes(model, e)) > FLAT))
                continue;
            found.count++;
            found.most = fmax(found.most, pressure / modulus);
        }
    free(stress);
    free(shear);
    return found;
}

/* ---- crushed --------------------------------------------------------------------------------- */

/* Volume that the three edges at corner c span, positive where they are right-handed [m^3]. */
static double corner_volume(const double (*position)[3], const int32_t *node, int c) {
    static const int next[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                   {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};
    double edge[3][3], normal[3];
    for (int k = 0; k < 3; k++) lar_minus(position[node[next[c][k]]], position[node[c]], edge[k]);
    lar_cross(edge[0], edge[1], normal);
    return lar_dot(normal, edge[2]);
}

/* Where nodes are now; NULL: no memory. */
static double (*positions_of(const lar_simulation *simulation, const lar_model *model))[3] {
    const int32_t nodes = lar_model_node_count(model);
    const double(*rest)[3] = lar_model_positions(model);
    double(*now)[3] = lar_calloc((size_t)nodes + 1, sizeof *now);
    if (!now) return NULL;
    lar_simulation_displacements(simulation, now);
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) now[n][i] += rest[n][i];
    return now;
}

crushed_elements crushed_elements_find(const lar_simulation *simulation, const lar_model *model) {
    static const double CRUSHED = 0.2; /* barriers begin at 0.3 */
    const double(*rest)[3] = lar_model_positions(model);
    double(*now)[3] = positions_of(simulation, model);
    crushed_elements found = {.least = 1};
    for (int32_t e = 0; now && e < lar_model_element_count(model); e++) {
        const int32_t *node = lar_model_element_nodes(model, e);
        double least = CRUSHED;
        for (int c = 0; c < 8; c++) {
            const double part = corner_volume(now, node, c) / corner_volume(rest, node, c);
            if (!(part < least)) continue;
            least = part;
            if (part < found.least) {
                found.least = part;
                memcpy(found.at, now[node[c]], sizeof found.at);
            }
        }
        found.count += least < CRUSHED;
        found.inside_out += least < 0;
    }
    free(now);
    return found;
}
