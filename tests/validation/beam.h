/* The cantilever of the reference data: 0.1 x 0.01 x 0.01 m along x, clamped at x = 0, under its
 * own weight in -z; E = 3000 Pa, density 1000 kg/m^3. Its slowest mode has 0.28 Hz. */
#ifndef LAR_TESTS_VALIDATION_BEAM_H
#define LAR_TESTS_VALIDATION_BEAM_H

#include "validation/reference.h"

typedef struct beam_mesh {
    const char *name; /* "40x4x4" */
    int along, across;
} beam_mesh;

extern const beam_mesh beam_meshes[3];

/* Critical damping of the first mode [1/s]. */
#define BEAM_DAMPING 3.5

/* poisson is 45 or 49. Gravity is 9.81 m/s^2 times curve 0, which is zero. */
lar_model *beam_model(const beam_mesh *mesh, int poisson);
/* The node in the middle of the free end. */
int32_t beam_tip(const lar_model *model);

/* Displacements of a mesh from those of a coarser one, linear within its elements. */
void beam_refine(const beam_mesh *coarse, double (*from)[3], const beam_mesh *fine,
                 double (*to)[3]);

#endif
