/* Flat elements of nearly incompressible tissue that pressure may fold. */
#ifndef LAR_CLI_REPORT_ZIGZAG_H
#define LAR_CLI_REPORT_ZIGZAG_H

#include "lariat.h"

typedef struct zigzag {
    int32_t elements; /* that are flat, nearly incompressible and pressed or drawn enough */
    double most;      /* of their pressures, in shear moduli */
} zigzag;

/* Of the body as it is now; none where there is no memory to find out. */
zigzag zigzag_find(const lar_simulation *simulation, const lar_model *model);

#endif
