/* The public simulation: the whole model's domain and its state, and the parallel computer where
 * there is one. Its processors have the state then, and the whole one is gathered on demand. */
#ifndef LAR_SIMULATION_SIMULATION_H
#define LAR_SIMULATION_SIMULATION_H

#include "parallel/computer.h"
#include "step/domain.h"
#include "step/interval.h"
#include "layout/state.h"
#include "step/guard.h"
#include "step/measure.h"
#include "step/step.h"

/* What looking at a simulation needs, and changes nothing of it. */
typedef struct lar_simulation_scratch {
    lar_measure_scratch measure;
    struct lar_field_plan *field; /* made when lar_simulation_field is first asked; atomic */
} lar_simulation_scratch;

struct lar_simulation {
    lar_domain domain; /* changed by lar_simulation_settle only */
    lar_state state;
    lar_state start; /* the first one, once somebody has gone back there; else empty */
    lar_interactions interactions; /* of an advance without a computer */
    lar_strained strained;         /* the same */
    lar_needs needs;               /* the same */
    lar_simulation_scratch *scratch;
    lar_fault fault;
    lar_tool_list list;
    lar_tools tools;
    lar_interval interval;  /* of an advance without a computer */
    lar_computer *computer; /* NULL: lar_step advances the whole model; another one after it was
                               divided anew, so who looks from other threads looks here: */
    int32_t processors, threads; /* of each processor; constant */
    int32_t *reporter; /* [nodes of the model] the processor of each, atomic; NULL: there is one */
    uint64_t redivisions;  /* atomic */
    lar_report report;     /* of the last advance, of all processors */
    uint64_t report_steps; /* how many steps that was */
    double measured;       /* the most that bodies had and had lost when that was asked [J] */
    double taken;          /* by contacts, as of the last report [J] */
    int32_t sessions;      /* open on it: 0 or 1. Atomic */
    int32_t held;          /* by the thread of a session, which alone may change it. Atomic */
    int32_t calling;       /* a callback: 1 within an advance, 2 between two; then it may be looked
                              at, and not be changed (within an advance of several processors or
                              threads not even that). 0: no callback is under way */
};

/* The state as it is now: everything that looks at a simulation's state begins with this. */
const lar_state *lar_simulation_state(const lar_simulation *simulation);

/* The mean deformation gradient of an element (stresses.c). */
void lar_element_gradient(const lar_domain *domain, const lar_state *state, lar_gid e,
                          double F[3][3]);
/* The state with what measuring viscous stress needs to know. */
lar_state lar_state_measured(const lar_simulation *simulation);
/* Of an element the fields that have a bit in `wanted`, 1 << lar_cell_field; an element that is
 * inside out has 0 instead of a stress, never a NaN. */
void lar_element_fields(const lar_domain *domain, const lar_state *state, lar_gid e,
                        unsigned wanted, double value[LAR_CELL_FIELDS][6]);

/* lar_simulation_advance_with without bringing the state together: what a tick of a session
 * costs. lar_simulation_gather does that, before somebody looks, and says when it fails: between
 * processes it can. */
lar_status lar_simulation_compute(lar_simulation *simulation, uint64_t steps,
                                  lar_step_callback *callback, void *context, lar_error *error);
lar_status lar_simulation_gather(const lar_simulation *simulation, lar_error *error);

/* Whether other processes compute parts of it; and, between advances, when nothing is waited for,
 * LAR_ERROR_PEER once one of them is lost. */
bool lar_simulation_has_peers(const lar_simulation *simulation);
lar_status lar_simulation_look(lar_simulation *simulation, lar_error *error);

/* The other threads of this process that compute go before all others, or (0) as they did, and are
 * awake for what comes at once (base/thread_pool.h). Between advances. */
void lar_simulation_go_before(const lar_simulation *simulation, int priority);
void lar_simulation_rouse(const lar_simulation *simulation);

/* Between advances, while nobody waits: what will have to be done soon, such as searching for
 * contact, up to `until` by lar_clock_seconds. Changes no bit. */
lar_status lar_simulation_work_ahead(lar_simulation *simulation, double until, lar_error *error);

/* A session lets its own thread alone change the simulation, or everyone again. */
void lar_simulation_reserve(lar_simulation *simulation, bool held);
/* Called by that thread: it is the one. */
void lar_simulation_reserve_here(const lar_simulation *simulation);

/* Refuses NULL, processors other than zero, and what a session computes on. `call`: the public
 * name. */
lar_status lar_simulation_check_zero(const lar_simulation *simulation, const char *call,
                                     lar_error *error);

/* The same, and what a callback calls: for what begins anew. */
lar_status lar_simulation_check_idle(const lar_simulation *simulation, const char *call,
                                     lar_error *error);
/* The same, and what has lost a processor: for calls that change something. */
lar_status lar_simulation_check_change(const lar_simulation *simulation, const char *call,
                                       lar_error *error);

/* Where a tool's hand asks it to be now; lar_simulation_tool_pose says where it is. */
/* Whether it can take hold; a hand needs a point. */
lar_status lar_tool_check_grasp(const lar_tool *tool, const double point[3], lar_error *error);
void lar_simulation_tool_asked(const lar_simulation *simulation, int32_t tool, lar_tool_pose *pose);

/* Whether tools that have a path in the scene are slow enough for the time step. */
lar_status lar_simulation_check_paths(const lar_simulation *simulation, lar_error *error);
/* Before a step: tools whose path goes on here set out. *stop becomes the step before which the
 * next of them does, where that is earlier. */
lar_status lar_simulation_follow_paths(lar_simulation *simulation, uint64_t *stop,
                                       lar_error *error);

/* Processors have parts of the nodes of free bodies: these set out before each step, when all that
 * is decided is. `context` is the simulation. */
lar_status lar_simulation_lead(void *context, lar_error *error);

/* The start as lar_simulation_create makes it, into state and tools, also again. */
void lar_simulation_set_start(lar_simulation *simulation);

/* Memory for the state, and what stands beside it: domain, list and tools are there. */
lar_status lar_simulation_create_state(lar_simulation *simulation, bool search_always,
                                       lar_error *error);

/* Materials become as stiff as simulation->tools say, spares what these say, and tools bear what
 * the tissues bear. */
void lar_simulation_settle(lar_simulation *simulation);

/* Something has been set: what it does is watched, and all processors hear of it. */
void lar_simulation_set(lar_simulation *simulation);

/* The same of what acts on all of a body, in a state that is whole. Set before the first step it is
 * what the body starts with: no velocity is left for what it would have started with. */
lar_status lar_simulation_set_anew(lar_simulation *simulation, lar_error *error);

/* The steps of the whole model, and who looks at it, follow these supports from now on, or
 * nothing has changed: without memory. */
lar_status lar_simulation_support_here(lar_simulation *simulation, const lar_supports *supports,
                                       lar_error *error);

/* Materials as stiff as `wanted` says, with these parameters, and the work that it takes; refuses
 * what steps cannot be divided for. Both may be those of simulation->tools. */
lar_status lar_simulation_change_materials(lar_simulation *simulation, const lar_settings *wanted,
                                           const lar_parameters *parameters, lar_error *error);

/* Parameter `index` (model/parameters.h) of a material; -1: all as the model says. */
lar_status lar_simulation_set_parameter_at(lar_simulation *simulation, int32_t material, int index,
                                           double value, lar_error *error);
/* Its index; `name` NULL: -1. */
lar_status lar_simulation_parameter_index(const lar_model *model, int32_t material,
                                          const char *name, int *index, lar_error *error);

/* External work that a change between steps does [J]; the state is whole. */
void lar_simulation_add_external(lar_simulation *simulation, double work);

/* What every tool bears, and how often is decided about tools: after these have changed. */
void lar_simulation_limit_tools(lar_simulation *simulation);

/* lar_simulation_add_tool in a place of the spares, and the first one that is free; their number:
 * none is. */
lar_status lar_simulation_add_tool_at(lar_simulation *simulation, const lar_tool_info *wanted,
                                      int32_t place, lar_error *error);
int32_t lar_simulation_free_place(const lar_simulation *simulation);
/* Refuses what such a tool cannot have. */
lar_status lar_added_tool_check(const lar_tool_info *wanted, lar_error *error);

/* lar_simulation_set_force_on by index of the set, which recordings have, and the index. */
lar_status lar_simulation_set_force_at(lar_simulation *simulation, int32_t set,
                                       const double force[3], lar_error *error);
/* lar_simulation_set_support and _on, likewise. */
lar_status lar_simulation_set_support_of(lar_simulation *simulation, int32_t of, bool on_set,
                                         unsigned axes, bool held, lar_error *error);
lar_status lar_simulation_force_set(const lar_model *model, const char *name, int32_t *index,
                                    lar_error *error);

/* All processors go on from simulation->state and ->tools as they are now; what failed and what
 * was felt is forgotten. */
lar_status lar_simulation_take_up(lar_simulation *simulation, lar_error *error);

/* lar_simulation_hash of a state, which may be a copy of the simulation's. */
uint64_t lar_state_hash(const lar_domain *domain, const lar_state *state);

/* Bytes of memory that a step can touch: domain and state, without the model. */
size_t lar_simulation_bytes(const lar_simulation *simulation);

/* State and tools into a copy in memory, and back from there between advances, as from a
 * checkpoint: the same bits follow. `state` comes from lar_state_create for as many nodes as the
 * simulation's; no memory is asked for, but to reach other processes. A run that has broken off is
 * not copied. */
lar_status lar_simulation_copy(const lar_simulation *simulation, lar_state *state, lar_tools *tools,
                               lar_error *error);
lar_status lar_simulation_go_back(lar_simulation *simulation, const lar_state *state,
                                  const lar_tools *tools, lar_error *error);

/* lar_simulation_save and lar_simulation_load between advances, without the file: only copying.
 * `path` is for messages; the caller frees the bytes. */
lar_status lar_simulation_pack(const lar_simulation *simulation, const char *path, lar_bytes *bytes,
                               lar_error *error);
lar_status lar_simulation_unpack(lar_simulation *simulation, const char *path,
                                 const lar_bytes *bytes, lar_error *error);

#endif
