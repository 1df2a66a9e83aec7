/* One time step of one processor: the loop that everything else is built around.
 *
 *     loads -> elements -> nodes -> supports
 *
 * Leapfrog form of the central differences of T 2.2.5: forces at u_n turn v_(n-1/2) into
 * v_(n+1/2), which turns u_n into u_(n+1). No allocation, lock, system call or printing happens in
 * here (tests/engine/test_quiet.c counts).
 */
#ifndef LAR_ENGINE_STEP_H
#define LAR_ENGINE_STEP_H

#include "engine/domain.h"
#include "engine/state.h"

/* Why a run must stop: polled once per step, set once, never cleared. */
typedef struct lar_trip {
    enum { LAR_TRIP_NONE, LAR_TRIP_ELEMENT, LAR_TRIP_SPEED, LAR_TRIP_LOAD } kind;
    lar_gid element; /* of LAR_TRIP_ELEMENT; the node of LAR_TRIP_LOAD */
    uint64_t step;   /* the step under way */
} lar_trip;

/* Every so many steps the kernels also look at the hourglass modes. */
enum { LAR_WATCH_INTERVAL = 32 };

/* Advances the state by one step. */
void lar_step(lar_domain *domain, lar_state *state, lar_trip *trip);

/* Adds loads and internal forces at the present displacements to state->force (which is zero
 * between steps): the residual internal - external. */
void lar_step_forces(lar_domain *domain, lar_state *state, lar_trip *trip);

/* Time of the state [s]. */
static inline double lar_state_time(const lar_domain *domain, const lar_state *state) {
    return (double)state->step * domain->time_step;
}

/* What the conditions need of a domain. */
static inline lar_condition_context lar_domain_context(const lar_domain *domain) {
    return (lar_condition_context){domain->model, domain->scale, domain->time_step, domain->mass};
}

/* The sentence for a trip: element or node, place, time, cause and remedy. */
lar_status lar_trip_report(const lar_domain *domain, const lar_state *state, const lar_trip *trip,
                           lar_error *error);

#endif
