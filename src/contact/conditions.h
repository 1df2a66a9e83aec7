/* Supports, prescribed motion and loads of one domain: what acts on nodes besides elements.
 *
 * Kept as flat lists by node, so that a step touches only the nodes concerned. Loads enter the
 * integer force sums (order does not matter); motion is imposed after the nodes have moved.
 * Prescribed values are computed from the model's curves at the new time, the same on every
 * processor that has the node.
 *
 * The lists are constant. What a thread notes of them within a step (forces, velocities before)
 * stands beside them, and means nothing between steps: it is no state.
 *
 * Work. In the leapfrog scheme a force F_n held from v- to v+ does exactly the work
 * dt F_n (v- + v+)/2 on the half-step kinetic energy; the sums here use that, so the energy
 * balance has no error of first order in dt.
 */
#ifndef LAR_CONTACT_CONDITIONS_H
#define LAR_CONTACT_CONDITIONS_H

#include "contact/tools.h"
#include "layout/state.h"
#include "model/forces.h"
#include "model/settings.h"
#include "model/supports.h"

/* Of functions of sources that are compiled for speed: this one is called before steps, and need
 * only be small. */
#define LAR_SETUP __attribute__((cold))

/* One axis of one node held at, or moved to, by * curve(t). */
typedef struct lar_constraint {
    int32_t node, axis; /* local */
    int32_t curve;      /* -1: held at 0; LAR_CURVE_HERE, LAR_CURVE_TOOL */
    int32_t rigid;      /* of the model's entries of move: the one with screws; LAR_CURVE_TOOL: the
                           tool; -1: none */
    int32_t point;      /* its node of the model */
    double by;          /* of LAR_CURVE_HERE: where it is, as of the step under way [m] */
} lar_constraint;

/* Where it stands in u, v and force. */
static inline size_t lar_constraint_at(const lar_state *state, const lar_constraint *constraint) {
    return lar_state_at(state, constraint->node, constraint->axis);
}

/* Held where it is: a support that was set (model/supports.h); and moved by a tool. */
enum { LAR_CURVE_HERE = -2, LAR_CURVE_TOOL = -3 };

/* A dead force on one node. */
typedef struct lar_point_force {
    int32_t node; /* local */
    int32_t curve;
    double force[3];
} lar_point_force;

/* A spring to where a node is at rest. */
typedef struct lar_point_spring {
    int32_t node;     /* local */
    double stiffness; /* [N/m] */
} lar_point_spring;

/* A pressure on one face. */
typedef struct lar_face_pressure {
    int32_t node[4]; /* local, counter-clockwise from outside */
    int32_t curve;
    double pressure;
    double position[4][3]; /* reference */
} lar_face_pressure;

typedef struct lar_conditions {
    int32_t constraint_count, force_count, spring_count, pressure_count;
    int32_t fixed_count; /* of the constraints, the first: those that stand still */
    lar_constraint *constraint;
    lar_point_force *force;
    lar_point_spring *spring;
    lar_face_pressure *pressure;
    uint8_t *held; /* [nodes of the model] LAR_AXIS bits of the axes in `constraint`, or NULL */
    /* Of forces that are set while it runs (model/forces.h). */
    const int32_t *local; /* as it was given */
    uint8_t *bears;       /* a bit for each node of the model that its thread loads; NULL: all */
} lar_conditions;

/* Of an axis that is moved, in the step under way. */
typedef struct lar_moved_axis {
    double force;  /* residual [N] */
    double before; /* velocity before it [m/s] */
} lar_moved_axis;

/* What a thread notes of its conditions in the step under way. */
typedef struct lar_condition_notes {
    /* The supports in effect: those of the conditions, or what has been set in their place. */
    int32_t constraint_count, fixed_count; /* as in the conditions; at last those held here */
    lar_constraint *constraint;
    const uint8_t *held;      /* as the conditions'; of what was set: lar_supports_mark */
    uint8_t *mark;            /* own, as `constraint` then: supports were set; else NULL */
    lar_supports set;         /* that these follow */
    lar_moved_axis *moved;    /* [constraint_count - fixed_count] */
    double (*force)[3];       /* [force_count], and behind these [spring_count] [N] */
    double (*pressure)[4][3]; /* [pressure_count] on the corners [N] */
} lar_condition_notes;

/* Everything a step needs to know besides the lists. */
typedef struct lar_condition_context {
    const lar_model *model;
    const lar_settings *settings; /* NULL: as the model says */
    const lar_forces *forces;     /* that were set; NULL: none */
    const lar_tool_list *list;    /* NULL: no tools */
    const lar_tools *tools;       /* likewise */
    const uint8_t *held;          /* [nodes of the model] axes, where supports were set, or NULL */
    double scale;                 /* force units per newton */
    double time_step;             /* of the step, or the part of it, under way [s] */
    double whole_step;            /* [s] */
    double mean_step;             /* of which forces change velocities: time_step, but where parts
                                     become longer or shorter; for work [s] */
    int32_t shares;               /* of LAR_STEP_SHARES, that the part of the step is */
    double stable_step;           /* the elements' bound at rest [s] */
    const double *springs;        /* the masses that springs of contact are fitted to */
    const double *mass;           /* by local node */
    const double *weight;         /* the same, 0 for nodes that another processor accounts for */
    const double *added;          /* of `mass`, what gravity does not pull at; NULL: nothing */
    int32_t first, end;           /* local nodes that the thread moves */
} lar_condition_context;

/* The thread of one processor that the conditions are for. */
typedef struct lar_condition_share {
    int32_t thread;
    const int32_t *holds;   /* [nodes of the model] thread that moves it: supports go there */
    const int32_t *loads;   /* [nodes of the model] thread that applies the loads of the node */
    const int32_t *presses; /* [elements of the model] thread that applies pressures on its faces */
} lar_condition_share;

/* `local` maps global to local nodes, and outlives it. An axis that several entries hold is held
 * once. With a share (NULL: all) only the conditions of one thread, and no `held`. */
lar_status lar_conditions_create(const lar_model *model, const int32_t *local,
                                 const lar_condition_share *share, lar_conditions *conditions,
                                 lar_error *error);
void lar_conditions_destroy(lar_conditions *conditions); /* idempotent */

lar_status lar_condition_notes_create(const lar_conditions *conditions, lar_condition_notes *notes,
                                      lar_error *error);
void lar_condition_notes_destroy(lar_condition_notes *notes); /* idempotent */

/* Between steps: from now on the notes follow what was set. With a share (NULL: all) as above. */
lar_status lar_condition_notes_set(const lar_conditions *conditions, const lar_model *model,
                                   const lar_condition_share *share, const lar_supports *set,
                                   lar_condition_notes *notes, lar_error *error);

/* Adds the loads at `time` to state->force. Returns a node (local) whose loads are too large for
 * the force sums, so that the run must stop; -1 when there is none. */
int32_t lar_conditions_load(const lar_conditions *conditions, const lar_condition_context *context,
                            double time, lar_condition_notes *notes, lar_state *state);

/* Half the work of one step by the loads of the last lar_conditions_load, with the velocities as
 * they are: once before and once after the nodes move [J]. */
double lar_conditions_half_work(const lar_conditions *conditions,
                                const lar_condition_context *context, double time,
                                const lar_condition_notes *notes, const lar_state *state);

/* After the elements, before the nodes move: remembers residual force and velocity where motion is
 * prescribed, and takes the residual from every supported value: it goes into the ground. */
void lar_conditions_observe(const lar_condition_context *context, lar_condition_notes *notes,
                            lar_state *state);

/* After the nodes moved from `time`: imposes supports and motion at time + dt; returns the work
 * that moving the supports took [J]. */
double lar_conditions_impose(const lar_condition_context *context, double time,
                             const lar_condition_notes *notes, lar_state *state);

/* Displacement of a constraint at `time` [m]; of what a tool moves at the start, 0. */
double lar_constraint_value(const lar_model *model, const lar_constraint *constraint, double time);

/* How fast a constraint goes in the part of a step that begins at `time`, as the state has it
 * [m/s]. */
double lar_constraint_velocity(const lar_condition_context *context,
                               const lar_constraint *constraint, double time,
                               const lar_state *state);

/* Largest nodal load [N], for the choice of the force scale. */
double lar_conditions_largest(const lar_conditions *conditions);

#endif
