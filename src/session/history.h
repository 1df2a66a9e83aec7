/* The forces of the latest ticks, for graphs: a ring that the engine writes and anybody reads.
 *
 *     tick:   ... 9001 9002 9003 | 9004 ...      slot = tick mod LAR_HISTORY_RING
 *             safe to read        being written: `begun` says so before, `written` after
 *
 * The ring is twice as long as what is promised, so a reader has thousands of ticks before what it
 * copies is written over; it looks at `begun` behind its copy all the same, and leaves out what may
 * be damaged. Numbers are written and read as atomic words; on today's processors these are plain
 * stores.
 */
#ifndef LAR_SESSION_HISTORY_H
#define LAR_SESSION_HISTORY_H

#include <stdint.h>

#include "base/error.h"

enum { LAR_HISTORY_RING = 2 * LAR_HISTORY_TICKS };

typedef struct lar_history {
    int32_t tools;
    uint64_t begun, written; /* atomic: ticks */
    uint32_t *value;         /* atomic: [LAR_HISTORY_RING][tools][3], the bits of floats */
} lar_history;

lar_status lar_history_create(int32_t tools, lar_history *history, lar_error *error);
void lar_history_destroy(lar_history *history); /* idempotent */

/* The engine: begins a tick, gives every tool's force, ends it. */
void lar_history_begin(lar_history *history);
void lar_history_put(lar_history *history, int32_t tool, const double force[3]);
void lar_history_end(lar_history *history);

/* Any thread: lar_session_force_history. */
int32_t lar_history_copy(const lar_history *history, int32_t tool, uint64_t after, int32_t max,
                         float (*force)[3], uint64_t *last);

#endif
