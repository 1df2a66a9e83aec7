/* Materials of any law in which every term of its energy is at work. */
#ifndef LAR_TESTS_LAW_EVERY_TERM_H
#define LAR_TESTS_LAW_EVERY_TERM_H

#include "model/material.h"
#include "testing.h"

/* Gives the constants that moduli leave zero `share` of the first one, and takes from the first one
 * what that adds to the shear modulus. Powers that are zero become -2 and 5. */
TEST_UNUSED static void every_term(lar_material *material, double share) {
    const lar_law_row *law = &lar_law_table[material->law];
    double *p = material->parameter, by_moduli[LAR_LAW_PARAMETERS] = {0};
    law->from_moduli(1, 1.7, by_moduli);
    for (int k = 0; k < law->count; k++) {
        if (by_moduli[k] != 0) continue;
        if (law->parameter[k].value == LAR_VALUE_POWER) {
            p[k] = k == 3 ? -2 : 5;
            continue;
        }
        double shear = lar_material_shear(material);
        p[k] = share * p[0];
        if (lar_material_shear(material) != shear) p[0] -= p[k];
    }
}

#endif
