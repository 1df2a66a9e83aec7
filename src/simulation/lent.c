#include "simulation/lent.h"

#define LENT(name) .name = &name,

const lar_lent lar_lent_to_fit = {.version = LAR_VERSION,
                                  .size = sizeof(lar_lent),
                                  .model = sizeof(lar_model),
                                  .simulation = sizeof(lar_simulation),
                                  LAR_LENT(LENT)};
