/* Where the tools are: the input of a simulation besides its model.
 *
 *     tool_move at step 100, 10 steps:   from ---- linear ---- to ======= rests there
 *                                        100                  110
 *
 * Plain numbers without pointers, so that they travel in orders to other processes and into
 * checkpoints as they are. Changed between advances only, when no processor computes (so the change
 * takes effect in the same step everywhere, T 6.5.1); read by all threads within them.
 *
 * Who holds what is decided here too, by whoever has the whole state: a hold binds a point of a
 * face to the tool's own axes (docs/theory.md, contact).
 */
#ifndef LAR_ENGINE_TOOLS_H
#define LAR_ENGINE_TOOLS_H

#include <stdbool.h>
#include <stddef.h>

#include "model/model.h"

enum { LAR_TOOLS_MOST = 16, LAR_HOLDS_MOST = 256 };

typedef struct lar_tool_motion {
    lar_tool_pose from, to;
    uint64_t start, end; /* steps */
    int32_t holding;     /* it has closed upon something, or nothing, and not opened since */
    int32_t padding;
} lar_tool_motion;

/* A surface point that a tool has hold of. */
typedef struct lar_hold {
    int32_t tool;
    int32_t face;     /* index into the model's surface */
    double weight[4]; /* of the face's corners, sum 1 */
    double anchor[3]; /* where the point is kept, in the tool's own axes [m] */
    double stiffness; /* [N/m] */
} lar_hold;

typedef struct lar_tools {
    int32_t count, hold_count;
    lar_tool_motion motion[LAR_TOOLS_MOST];
    lar_hold hold[LAR_HOLDS_MOST];
} lar_tools;

/* What a tool is, of the model's or a hand: the same on all processors, constant. */
typedef struct lar_tool_list {
    int32_t count;
    lar_tool tool[LAR_TOOLS_MOST]; /* names are borrowed from the model, or static */
} lar_tool_list;

/* The model's tools and so many hands; too many are an error. */
lar_status lar_tool_list_create(const lar_model *model, int32_t hands, lar_tool_list *list,
                                lar_error *error);
/* All at rest, holding nothing. */
void lar_tools_reset(const lar_tool_list *list, lar_tools *tools);

/* Bytes of the used part, from the beginning on: what travels. */
static inline size_t lar_tools_bytes(const lar_tools *tools) {
    return offsetof(lar_tools, hold) + (size_t)tools->hold_count * sizeof tools->hold[0];
}

/* Pose and velocity (of the tip, [m/s]; may be NULL) of a tool at a step. */
void lar_tool_at(const lar_tool_motion *motion, uint64_t step, double time_step,
                 lar_tool_pose *pose, double velocity[3]);

/* ---- quaternions w, x, y, z, of unit length ------------------------------------------------- */

void lar_turn(const double q[4], const double v[3], double out[3]);      /* own axes to the world */
void lar_turn_back(const double q[4], const double v[3], double out[3]); /* and back */

#endif
