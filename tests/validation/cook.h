/* Cook's membrane of the reference data: 48 x 44/16 mm, 1 mm thick, clamped on the left, 100 N dead
 * load upwards spread over the right edge; nearly incompressible (nu = 0.4999). `ps`: plane strain;
 * `3d`: only the plane z = 0 is held along z. */
#ifndef LAR_TESTS_VALIDATION_COOK_H
#define LAR_TESTS_VALIDATION_COOK_H

#include "validation/reference.h"

/* cells: 8, 16 or 32. */
lar_model *cook_model(int cells, bool plane_strain);
/* The upper right corner. */
int32_t cook_tip(const lar_model *model);

/* Near critical for the slowest mode [1/s]; the density is 1000 kg/m^3. */
#define COOK_DAMPING 1.2e4

#endif
