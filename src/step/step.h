/* One time step: the loop that everything else is built around.
 *
 *     loads -> elements -> nodes -> supports
 *
 * lar_step takes them in this order for a whole model. Processors of several go through the same
 * parts batch by batch, and exchange force sums in between (parallel/batch.c).
 *
 * Leapfrog form of the central differences of T 2.2.5: forces at u_n turn v_(n-1/2) into
 * v_(n+1/2), which turns u_n into u_(n+1). No allocation, lock, system call or printing happens in
 * here (tests/engine/test_quiet.c counts).
 */
#ifndef LAR_STEP_STEP_H
#define LAR_STEP_STEP_H

#include "contact/interactions.h"
#include "step/domain.h"
#include "layout/state.h"

/* Why a run must stop: polled once per step, set once, never cleared. */
typedef struct lar_fault {
    enum {
        LAR_FAULT_NONE,
        LAR_FAULT_ELEMENT,
        LAR_FAULT_SPEED,
        LAR_FAULT_LOAD,
        LAR_FAULT_TOO_MANY_PAIRS, /* contact: more faces near a node than make sense */
        LAR_FAULT_TOO_FAST,       /* contact: faster than processors can tell each other */
        LAR_FAULT_ENERGY_GAIN     /* contact: it has given more energy than it took */
    } kind;
    lar_gid element; /* of LAR_FAULT_ELEMENT and LAR_FAULT_ENERGY_GAIN; the node of the others */
    uint64_t step;   /* the step under way */
    int32_t part;    /* of a divided step */
    /* What lar_fault_examine found, for the report. */
    double place[3];      /* [m] */
    double volume_ratio;  /* of the element; of LAR_FAULT_ENERGY_GAIN: in its worst corner */
    double growth;        /* of its frequency */
    double stretch;       /* of the element: the largest */
    double stress;        /* of its fibres, or of its law where it has none [Pa] */
    double fibre_stretch; /* 0: it has none that stiffen */
    double times;         /* that stress by the shear modulus, of a law the larger modulus */
    bool slow;            /* the last step has changed little of its strain */
    double speed;         /* of the node [m/s] */
    double given;         /* of LAR_FAULT_ENERGY_GAIN: more than it took [J] */
    bool examined;
    bool too_many_pairs; /* of LAR_FAULT_TOO_FAST: the list had too many pairs for the skin it needs
                          */
    /* What lar_fault_attribute found. */
    bool attributed, tool_pulls;
    int32_t tool;      /* counted from 1; 0: none has to do with it; -1: a force that was set */
    double tool_speed; /* [m/s] */
    lar_gid pushed;    /* by that force */
    double force;      /* [N] */
} lar_fault;

/* Every so many steps spare nodes are put back. */
enum { LAR_PARK_INTERVAL = 32 };

/* Advances the state by one step, or by a part of a divided one. */
void lar_step(const lar_domain *domain, lar_interactions *interactions, lar_state *state,
              lar_fault *fault);

/* The parts of a step. What acts, and the state's sums (force, damped, external, contact), are one
 * thread's; u and v may be shared with the threads that move other nodes. */

/* Before all others: how long the step is, or its part. */
void lar_step_enter(const lar_domain *domain, const lar_interactions *interactions,
                    lar_condition_context *context, lar_state *state);

/* What has been set in place of what the model says; NULL: nothing can be. */
const lar_settings *lar_settings_of(const lar_interactions *interactions);
/* How steps are divided now. */
const lar_step_division *lar_division_of(const lar_interactions *interactions);
/* Velocities stand half-way between the displacements before and after: where the length of steps
 * changes they are carried over the mean of two lengths [s]. */
double lar_mean_step(const lar_domain *domain, const lar_step_division *division,
                     const lar_state *state);
/* Since the forces before, 0 at the start [s]. */
double lar_past_step(const lar_domain *domain, const lar_step_division *division,
                     const lar_state *state);
/* How nodes move in the step that lies before the state: see lar_step_division. */
lar_leapfrog lar_step_leapfrog(const lar_domain *domain, const lar_interactions *interactions,
                               const lar_state *state);

/* The same, with gravity where it follows a curve: that of the state's time. */
lar_leapfrog lar_step_leapfrog_at(const lar_domain *domain, const lar_interactions *interactions,
                                  const lar_condition_context *context, const lar_state *state);

/* Between steps: from now on the thread that moves the context's nodes follows what was set of
 * supports. Asks for memory where that has changed; when there is none nothing changes. */
lar_status lar_step_support(const lar_condition_context *context, const lar_supports *set,
                            lar_interactions *interactions, lar_error *error);

/* Loads, tools and planes, and the first half of their work. Contact of bodies follows: lar_step
 * does it itself, processors when they have heard of each other's nodes (contact_exchange.h). */
void lar_step_begin(const lar_domain *domain, lar_interactions *interactions,
                    const lar_condition_context *context, lar_state *state, lar_fault *fault);
/* The elements of runs first .. first + count - 1 of the domain. */
void lar_step_recover(const lar_domain *domain, int32_t first, int32_t count, lar_state *state,
                      lar_fault *fault);
/* Moves the context's nodes, whose force sums are complete, and clears the sums. */
void lar_step_move(const lar_domain *domain, lar_interactions *interactions,
                   const lar_condition_context *context, lar_state *state, lar_fault *fault);
/* All nodes have moved: the second half of the work; the step is done. */
void lar_step_end(const lar_domain *domain, const lar_interactions *interactions,
                  const lar_condition_context *context, lar_state *state, lar_fault *fault);

/* Adds loads and internal forces at the present displacements to state->force (which is zero
 * between steps): the residual internal - external. `scratch` are interactions of this domain that
 * take part in no step: contact is looked for anew. */
void lar_step_forces(const lar_domain *domain, lar_interactions *scratch, lar_state *state,
                     lar_fault *fault);
/* The same of one of these alone; of tools without their friction, which asks for all others. */
typedef enum lar_acting {
    LAR_ACTING_LOADS,
    LAR_ACTING_TOOLS,
    LAR_ACTING_BODIES,
    LAR_ACTING_ELEMENTS
} lar_acting;
void lar_step_forces_of(const lar_domain *domain, lar_interactions *scratch, lar_acting what,
                        lar_state *state, lar_fault *fault);

/* Time of the state [s]. */
static inline double lar_state_time(const lar_domain *domain, const lar_state *state) {
    double part = state->part > 0 ? (double)state->part / state->parts : 0;
    return ((double)state->step + part) * domain->time_step;
}

/* What the conditions need of a domain (and lar_step_enter of the step), for the nodes first .. end
 * - 1. */
static inline lar_condition_context lar_domain_context_of(const lar_domain *domain, lar_lid first,
                                                          lar_lid end) {
    return (lar_condition_context){.model = domain->model,
                                   .scale = domain->scale,
                                   .time_step = domain->time_step,
                                   .whole_step = domain->time_step,
                                   .mean_step = domain->time_step,
                                   .shares = LAR_STEP_SHARES,
                                   .stable_step = domain->stable_step,
                                   .mass = domain->mass,
                                   .springs = lar_domain_springs(domain),
                                   .weight = domain->weight,
                                   .added = domain->added,
                                   .first = first,
                                   .end = end};
}

static inline lar_condition_context lar_domain_context(const lar_domain *domain) {
    return lar_domain_context_of(domain, 0, domain->layout.node_padded);
}

/* Looks at what has failed, at the end of the step in which it did: several processors stop some
 * steps later, when the state says little. `domain` has the element, or the nodes; of these only
 * those from `first` to before `end`, which nobody else moves meanwhile. */
void lar_fault_examine(const lar_domain *domain, const lar_state *state, lar_lid first, lar_lid end,
                       lar_fault *fault);

/* Looks for the tool, or the force that was set, that has to do with an examined fault, once.
 * `domain` is the whole model's; the tools still move as they did. */
void lar_fault_attribute(const lar_domain *domain, const lar_tools *tools, lar_fault *fault);

/* Of a broken element: stretch, stress, and how fast it came. */
void lar_fault_examine_strain(const lar_domain *domain, const lar_state *state, lar_fault *fault);
/* Why an element that was examined broke, where its tissue or a pressure says, and what helps.
 * False: nothing but the time step stands out. `forceful`: it exceeds the force limit; *step_helps:
 * a smaller time step may help, which the text leaves to the caller then. */
bool lar_fault_remedy(const lar_domain *domain, const lar_fault *fault, bool forceful, char *text,
                      size_t size, bool *step_helps);

/* The sentence for an examined fault: element or node, place, time, cause and remedy. */
lar_status lar_fault_report(const lar_domain *domain, const lar_fault *fault, lar_error *error);
/* The same where fault->tool is not 0: that does what to the element or node. */
lar_status lar_fault_report_tool(const lar_domain *domain, const lar_fault *fault,
                                 const char *what_it_does, lar_error *error);

#endif
