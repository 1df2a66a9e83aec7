/* Positions that were taken at a device's own times, asked for at the engine's.
 *
 *     device    x   x   x   x   x   x   x      taken evenly, by its own clock
 *     arrive     x   x    xx    x   x   x      early, late and in bunches
 *     ticks     |    |    |    |    |    |     0, 1 or 2 of them new
 *     played    o    o    o    o    o    o     between two that are there, `behind` the newest
 *
 * Whoever takes the newest in each tick sees a hand that moves evenly stand still in one tick and
 * go twice as far in another, and a coupling's spring and damper make forces of it. Here positions
 * are played out as in telephony over networks: so far behind the newest one that the next has
 * nearly always come (adaptive playout delay; Ramjee, Kurose, Towsley and Schulzrinne 1994). The
 * two clocks are never compared: what counts is how far each went. Behind grows at once when
 * nothing newer is there, and shrinks slowly.
 *
 * No clock in here: times are numbers that the caller gives.
 */
#ifndef LAR_SESSION_DEVICE_JITTER_BUFFER_H
#define LAR_SESSION_DEVICE_JITTER_BUFFER_H

#include <stdbool.h>

#include "lariat.h"

enum { LAR_JITTER_SAMPLES = 16 };

typedef struct lar_jitter_buffer {
    int count, newest; /* of the samples; which one */
    struct {
        lar_tool_pose pose;
        uint64_t time; /* the device's own [us] */
    } sample[LAR_JITTER_SAMPLES];
    double behind;    /* the newest, what is played [us] */
    double lead;      /* the mean of that */
    int64_t asked_at; /* when it was asked last [ns]; 0: never */
} lar_jitter_buffer;

/* Forgets all. */
void lar_jitter_buffer_clear(lar_jitter_buffer *buffer);

/* The device was there at `time`, by its own clock [us]. One that stands still or jumps says
 * nothing: what came before is forgotten. */
void lar_jitter_buffer_put(lar_jitter_buffer *buffer, const lar_tool_pose *pose, uint64_t time);

/* Where it was a little before `now` [ns], by a clock that goes evenly; the opening is the newest.
 * False, and *pose stays: nothing has come. */
bool lar_jitter_buffer_at(lar_jitter_buffer *buffer, int64_t now, lar_tool_pose *pose);

#endif
