/* Published stiffnesses of tissues, for starter scenes: a table of a few lines, each with its
 * source or said to be a guess. */
#ifndef LAR_MESHING_STARTER_TISSUE_H
#define LAR_MESHING_STARTER_TISSUE_H

#include <stdbool.h>

typedef struct lar_tissue {
    const char *name;     /* "liver" */
    const char *words;    /* parts of a region's name that mean it, separated by blanks */
    double shear_modulus; /* at small strain [Pa] */
    double poisson_ratio; /* of the starter scene: below what tissue has, for longer steps */
    double density;       /* [kg/m^3] */
    double max; /* [m^3] more than its organs hold in anybody, for doubts about units; 0: unknown */
    bool rigid; /* bone: held where it is, and given a stiffness that real time bears */
    bool guess; /* the shear modulus: nobody's figure is for it */
    const char *source; /* who measured it, where, year; of a guess what it was chosen from */
} lar_tissue;

/* The tissue that a region's name speaks of ("liver", "kidney_left", "Left lung"); the last row,
 * "soft tissue", for names that speak of none. */
const lar_tissue *lar_tissue_find(const char *region);

#endif
