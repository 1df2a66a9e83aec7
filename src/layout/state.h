/* The state of a simulation: everything that changes from step to step, in ONE table.
 *
 *     arrays (memory)      u  x.. y.. z..     v  x.. y.. z..     level     force  x.. y.. z..
 *     rows (what is kept)  displacement       velocity           contact
 *                                                                level
 *
 *     history   what viscous elements remember (law/viscosity.h), eight lanes of each value, in the
 *               order of the domain's blocks; none where nothing is viscous
 *
 * The arrays drive allocation, freeing and copies, the rows everything that takes a node's state
 * elsewhere or looks at it: checkpoint, hash, division among processors, comparison. What is in
 * neither does not exist. Nodes are in the domain's local order, vectors axis by axis
 * (mechanics/axes.h), padded and aligned to 64 bytes. `level` is the node's offset in contact of
 * its body with itself (body_contact.h).
 */
#ifndef LAR_LAYOUT_STATE_H
#define LAR_LAYOUT_STATE_H

#include <stdint.h>
#include <string.h>

#include "mechanics/axes.h"
#include "base/hash.h"
#include "base/memory.h"

/* X(type, name, axes of a node, values of the history, kept): `kept` arrays carry the state from
 * one step to the next; the others are empty between steps. */
#define LAR_STATE_ARRAYS(X)                                                                        \
    X(double, u, 3, 0, 1)       /* displacements at the present time [m] */                        \
    X(double, v, 3, 0, 1)       /* velocities half a step before it [m/s] */                       \
    X(double, level, 1, 0, 1)   /* contact levels [m] */                                           \
    X(int64_t, force, 3, 0, 0)  /* internal minus external forces [force units] */                 \
    X(double, history, 0, 1, 1) /* as it was at the forces before [J/m^3, 1, Pa] */

/* How many values an array has. */
#define LAR_STATE_SIZE(state, of_node, of_history)                                                 \
    ((state)->stride * (of_node) + (state)->history_count * (of_history))

/* X(array, count, before, always): a node's values in a kept array. `before`: values of a node that
 * stand before them in a checkpoint, which has one row after the other (docs/formats.md). `always`:
 * in every hash; else where it is above 0, and it is never less. The rows stand in the order in
 * which they are hashed. */
#define LAR_STATE_ROWS(X)                                                                          \
    X(u, 3, 1, 1)     /* displacement [m] */                                                       \
    X(v, 3, 4, 1)     /* velocity [m/s] */                                                         \
    X(level, 1, 0, 0) /* contact level: the initial penetration offset [m] */

#define LAR_STATE_COUNT(array, count, before, always) +(count)
enum { LAR_NODE_VALUES = 0 LAR_STATE_ROWS(LAR_STATE_COUNT) };
/* Of a node that remembers where it took hold, in the history. */
enum { LAR_STICK_VALUES = 4 };
#undef LAR_STATE_COUNT

typedef struct lar_strained lar_strained; /* step/guard.h */
typedef struct lar_needs lar_needs;       /* step/mass/needs.h */

typedef struct lar_state {
    uint64_t step;    /* steps done */
    int32_t part;     /* parts of a divided step done; 0 between advances */
    int32_t parts;    /* of the step under way */
    uint64_t round;   /* times that nodes were moved; no state */
    double damped;    /* sum over the steps of sum c m |v + v'|^2, c: damping */
    double external;  /* work of loads, prescribed motion and tools so far [J] */
    double contact;   /* what contacts have taken from the bodies so far [J] */
    double exchanged; /* what contacts of bodies have done at single nodes, either way [J] */
    double fastest;   /* largest velocity of an axis of the nodes moved last [m/s]; no state */
    double need;  /* of the elements looked at in this stretch of steps: see lar_step_division */
    bool close;   /* they are looked at in this step: lar_division_is_close */
    bool lets_go; /* corners have no barriers: lar_division_lets_go; no state */
    bool listed;  /* the strained elements are listed; false: they are looked for anew */
    double past;  /* since the forces before [s], as the step was entered; no state */
    lar_strained *strained; /* the list, lent; no state */
    lar_needs *needs;       /* whose `need` that is, lent; NULL: nobody asks. No state */
    double hardness;        /* of tools: lar_step_division; no state */
    uint8_t *pressed;       /* elements that tools press on (step/mass/pressed.h), lent; no state */
    int32_t node_count;
    size_t stride;        /* from one axis of a node to the next */
    size_t history_count; /* values; 0: nothing is viscous */
#define LAR_STATE_MEMBER(type, name, of_node, of_history, kept) type *name;
    LAR_STATE_ARRAYS(LAR_STATE_MEMBER)
#undef LAR_STATE_MEMBER
} lar_state;

/* All zero, for `node_count` nodes (a multiple of LAR_NODES_TOGETHER) and a history of so many
 * values. */
lar_status lar_state_create(lar_state *state, int32_t node_count, size_t history_count,
                            lar_error *error);
void lar_state_destroy(lar_state *state); /* idempotent */

/* ---- one node, in the order of the rows ------------------------------------------------------ */

static inline void lar_state_read(const lar_state *state, int32_t node,
                                  double value[LAR_NODE_VALUES]) {
#define LAR_STATE_READ(array, count, before, always)                                               \
    for (int i = 0; i < (count); i++)                                                              \
        *value++ = state->array[(size_t)node + (size_t)i * state->stride];
    LAR_STATE_ROWS(LAR_STATE_READ)
#undef LAR_STATE_READ
}

static inline void lar_state_write(lar_state *state, int32_t node,
                                   const double value[LAR_NODE_VALUES]) {
#define LAR_STATE_WRITE(array, count, before, always)                                              \
    for (int i = 0; i < (count); i++)                                                              \
        state->array[(size_t)node + (size_t)i * state->stride] = *value++;
    LAR_STATE_ROWS(LAR_STATE_WRITE)
#undef LAR_STATE_WRITE
}

/* Where axis i of a node stands in u, v and force. */
static inline size_t lar_state_at(const lar_state *state, int32_t node, int i) {
    return (size_t)node + (size_t)i * state->stride;
}

static inline void lar_state_displacement(const lar_state *state, int32_t node, double u[3]) {
    lar_axes_get(state->u, state->stride, node, u);
}

static inline void lar_state_velocity(const lar_state *state, int32_t node, double v[3]) {
    lar_axes_get(state->v, state->stride, node, v);
}

/* A node's part of the hash of a state. */
static inline uint64_t lar_state_hash_values(uint64_t hash, const double value[LAR_NODE_VALUES]) {
#define LAR_STATE_HASH(array, count, before, always)                                               \
    for (int i = 0; i < (count); i++, value++)                                                     \
        if ((always) || *value > 0) hash = lar_hash_double(hash, *value);
    LAR_STATE_ROWS(LAR_STATE_HASH)
#undef LAR_STATE_HASH
    return hash;
}

#endif
