/* The public simulation: the whole model's domain and its state, and the parallel computer where
 * there is one. Its processors have the state then, and the whole one is gathered on demand. */
#ifndef LAR_ENGINE_SIMULATION_H
#define LAR_ENGINE_SIMULATION_H

#include "engine/computer.h"
#include "engine/domain.h"
#include "engine/state.h"
#include "engine/step.h"

struct lar_simulation {
    lar_domain domain;
    lar_state state;
    lar_trip trip;
    lar_tool_list list;
    lar_tools tools;
    lar_computer *computer; /* NULL: lar_step advances the whole model */
    bool gathered;          /* `state` is what the computer has */
};

/* The state as it is now: everything that looks at a simulation's state begins with this. */
const lar_state *lar_simulation_state(const lar_simulation *simulation);

/* lar_simulation_hash of a state, which may be a copy of the simulation's. */
uint64_t lar_state_hash(const lar_domain *domain, const lar_state *state);

/* Bytes of memory that a step can touch: domain and state, without the model. */
size_t lar_simulation_bytes(const lar_simulation *simulation);

#endif
