/* What a state says about itself: energies, stresses, reactions. Slow, exact, never in the step.
 */
#ifndef LAR_STEP_MEASURE_H
#define LAR_STEP_MEASURE_H

#include "step/step.h"

/* What forces are found with that nobody feels: interactions and force sums of their own, so that
 * who looks at a state changes nothing of it, nor of what its steps know. */
typedef struct lar_measure_scratch {
    lar_interactions interactions;
    int64_t *force;         /* [3][stride of the state] force units, zero between two looks */
    const lar_tools *tools; /* NULL: none */
    lar_tools *next;        /* these, where some go on (lar_tools_go_on); NULL: there are none */
    lar_tools *ahead;       /* these, and where free bodies will have gone; NULL: there are none */
} lar_measure_scratch;

/* `tools` may be NULL. What cannot be made is cleared by lar_measure_scratch_destroy. */
lar_status lar_measure_scratch_create(const lar_domain *domain, const lar_tools *tools,
                                      lar_measure_scratch *scratch, lar_error *error);
void lar_measure_scratch_destroy(lar_measure_scratch *scratch); /* idempotent */

/* Energies at the time of the state. Kinetic energy is sum m v-.v+ / 2 over the half steps before
 * and after, the form that central differences conserve exactly for linear bodies. No memory is
 * asked for. */
void lar_measure_energy(const lar_domain *domain, lar_measure_scratch *scratch,
                        const lar_state *state, lar_energy *energy);

/* Tells tools where free bodies go in the step that follows (step/rigid/free_body.h), for those
 * that move their nodes. No memory is asked for. */
void lar_measure_ahead(const lar_domain *domain, lar_measure_scratch *scratch,
                       const lar_state *state, lar_tools *tools);

/* Where the list's tool touches at the time of the state, and with which force the step that
 * follows begins; corners of faces are not filled in. No memory is asked for. */
void lar_measure_touches(const lar_domain *domain, lar_measure_scratch *scratch,
                         const lar_state *state, lar_touch_list *list);

/* What one cause does to every node of the model at the time of the state [N], [nodes][3] by global
 * node; `tool` counts for LAR_CAUSE_TOOL. Fails only for want of memory. */
lar_status lar_measure_nodal_forces(const lar_domain *domain, lar_measure_scratch *scratch,
                                    const lar_state *state, lar_cause cause, int32_t tool,
                                    double (*force)[3], lar_error *error);

/* What element e stores, hourglass and guard included [J]: the same bits on every grid. */
double lar_measure_element_energy(const lar_domain *domain, const lar_state *state, lar_gid e);

/* What its viscous terms store that will have relaxed (simulation/rest.h) [J]. */
double lar_measure_remembered(const lar_domain *domain, const lar_state *state, lar_gid e);

/* Mean Cauchy stress of global element e [Pa]: xx yy zz xy yz zx, of viscous elements state->past
 * after the forces before. Returns the strain energy per reference volume [J/m^3]. */
double lar_measure_stress(const lar_domain *domain, const lar_state *state, lar_gid e,
                          double cauchy[6]);

/* Sum over some global nodes of the forces that their supports exert on them [N], and, of nodes
 * where they are now, of the moments about a point, NULL: not these, sum[3..5] [N m]; axes without
 * a support add nothing. `arriving`: those that bring them here at the speed that they have,
 * whatever the supports do next; else what the next step takes, which throws them from one speed to
 * the next where a curve has a kink. At step 0 nothing has moved, and nothing is thrown. Fails only
 * for want of memory. */
lar_status lar_measure_reaction(const lar_domain *domain, lar_measure_scratch *scratch,
                                const lar_state *state, const lar_node_list *nodes, bool arriving,
                                const double about[3], double *sum, lar_error *error);

/* Adds a force on a global node [N], and its moment about a point, NULL: not this [N m]. */
void lar_measure_add(const lar_domain *domain, const lar_state *state, lar_gid node,
                     const double force[3], const double about[3], double *sum);

#endif
