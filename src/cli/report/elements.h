/* Elements that may answer in the place of the tissue. */
#ifndef LAR_CLI_REPORT_ELEMENTS_H
#define LAR_CLI_REPORT_ELEMENTS_H

#include "lariat.h"

/* Flat ones of nearly incompressible tissue, which pressure may fold. */
typedef struct flat_elements {
    int32_t count; /* that are pressed or drawn enough */
    double most;   /* of their pressures, in shear moduli */
} flat_elements;

/* Those with a corner that has less than a fifth of its volume at rest, where barriers of corners
 * push back with a share that shows (docs/theory.md, "Corners"). */
typedef struct crushed_elements {
    int32_t count, inside_out; /* the latter with a corner without volume */
    double least;              /* volume of a corner, as a part of that at rest; 1: none crushed */
    double at[3];              /* where that corner is now [m] */
} crushed_elements;

/* Of the body as it is now; none where there is no memory to find out. */
flat_elements flat_elements_find(const lar_simulation *simulation, const lar_model *model);
crushed_elements crushed_elements_find(const lar_simulation *simulation, const lar_model *model);

#endif
