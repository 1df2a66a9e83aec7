/* The guard of strained elements (mechanics/hex8_guard.h), within the step.
 *
 * In the last step of an interval the kernels list the elements that are strained. These are looked
 * at, eight side by side: how fast they have become, for the division of steps, and how close a
 * corner is to where its barrier begins. Those that are close are gone through in every step until
 * the next list is made. A force is added only where a barrier is at work, so which elements are
 * listed besides does not matter; and corners with volume to spare are not looked at again before
 * the fastest node can have used it up.
 */
#ifndef LAR_STEP_GUARD_H
#define LAR_STEP_GUARD_H

#include "step/domain.h"
#include "layout/state.h"

/* What damped an element in the step before, and what its barriers should have pushed with. */
typedef struct lar_damped {
    lar_gid element;
    float step;      /* that its nodes then moved [s] */
    float half_mean; /* of the time that the force acted [s] */
    float damper[8]; /* of each corner: what takes energy [J] */
    float lack[8];   /* what a softened barrier lacks [J] */
    bool gone;       /* there were no barriers */
} lar_damped;

/* The strained elements of a domain's runs, beside the state: each run has the places of its
 * blocks, and is one thread's. */
struct lar_strained {
    int32_t *lane;         /* [8 for each block] what is looked at in every step */
    int32_t *count;        /* [run_count] of these, from the first of a run's places on */
    int32_t *listed_count; /* [run_count] strained elements of the last list (redivide.c) */
    float (*strain)[LAR_STRAIN_NUMBERS]; /* [8 for each block] scratch of a monitor */
    int32_t *near;                       /* [8 for each block] scratch: lanes with a corner below */
    double *stiffness;                   /* twice START, and of their barriers, likewise [N/m] */
    bool follows;       /* one thread moves all nodes: it is known how far they can have gone */
    double travel;      /* that is, along any way [m] */
    double *sound;      /* [8 for each block] `travel` until which no corner is below twice START */
    lar_damped *damped; /* [8 for each block] with half of their work to come */
    int32_t *damped_count; /* [run_count] of these, as above */
    int32_t *lacked;       /* [8 for each block] scratch: elements whose barriers were softer than
                              their energy says in the step before */
    int32_t *lacked_count; /* [run_count] of these, as above */
    double *activation;    /* [8 for each block] scratch (step/activation.h), */
    double *active_energy; /* likewise; NULL where nothing is active */
    uint8_t *pressed;      /* [elements of the model] step/mass/pressed.h; NULL: none is heavier */
    uint8_t *beyond;       /* [blocks] of lar_viscous_step, zero but in a step that fails */
};

lar_status lar_strained_create(const lar_domain *domain, lar_strained *strained, lar_error *error);
void lar_strained_destroy(lar_strained *strained); /* idempotent */

/* Adds the barriers' forces of run r to state->force. */
void lar_guard_apply(const lar_domain *domain, int32_t r, lar_state *state);

/* The same in a step in which the kernel has listed the strained elements of run r: what is close
 * of these is what is looked at from now on. `measures`: how fast they are counts for
 * state->need. Both in one go, for looking at corners is what takes the time. */
void lar_guard_select_and_apply(const lar_domain *domain, int32_t r,
                                const lar_hex8_monitor *monitor, bool measures, lar_state *state);

/* The same of all elements of the model, looked for one by one. */
void lar_guard_apply_all(const lar_domain *domain, lar_state *state);

/* The first half of what dampers of barriers take in the step that follows, to state->contact, and
 * of what barriers lack, to state->external, as if none had lacked anything before. For who looks:
 * adds forces as well. */
void lar_guard_half_work(const lar_domain *domain, lar_state *state);

/* The second half of that of the step before, which the next step counts before it looks at the run
 * of the element: to *contact and *external. For who looks, and for who copies the state: one that
 * is put back knows nothing of the step before. */
void lar_guard_half_to_come(const lar_domain *domain, const lar_state *state, double *contact,
                            double *external);

/* Energy of an element's barriers [J]. */
double lar_guard_energy(const lar_domain *domain, const lar_state *state, lar_gid e);

#endif
