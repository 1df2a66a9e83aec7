/* The public simulation: a domain and its state. */
#ifndef LAR_ENGINE_SIMULATION_H
#define LAR_ENGINE_SIMULATION_H

#include "engine/domain.h"
#include "engine/state.h"
#include "engine/step.h"

struct lar_simulation {
    lar_domain domain;
    lar_state state;
    lar_trip trip;
};

/* Bytes of memory that a step can touch: domain and state, without the model. */
size_t lar_simulation_bytes(const lar_simulation *simulation);

#endif
