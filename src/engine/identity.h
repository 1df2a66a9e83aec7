/* A number that tells whether two processes compute the same: model, time step, start and division
 * (comm.h refuses a peer with another one). */
#ifndef LAR_ENGINE_IDENTITY_H
#define LAR_ENGINE_IDENTITY_H

#include "engine/domain.h"
#include "engine/state.h"

uint64_t lar_identity(const lar_domain *whole, const lar_state *start, uint64_t division);

#endif
