/* Pictures of the whole body, each of one step.
 *
 *     any thread: ask (a number) --->      engine, at the end of a tick: somebody has asked;
 *     waits until the newest frame   <---  copies displacements and velocities as they lie in
 *     answers its number                   memory, and goes on
 *
 * The engine only copies memory; putting nodes into the mesh's order and the hash are the asking
 * thread's work. With several processors the state is gathered first, when none of them computes,
 * so that all nodes are of one step.
 */
#ifndef LAR_SESSION_SNAPSHOT_H
#define LAR_SESSION_SNAPSHOT_H

#include "simulation/simulation.h"
#include "session/triple_buffer.h"

typedef struct lar_snapshots {
    lar_triple_buffer frames;
    uint64_t asked;    /* atomic: the latest number that was given out */
    uint64_t answered; /* the engine's */
    uint64_t ready;    /* atomic: the newest number that a frame answers */
} lar_snapshots;

lar_status lar_snapshots_create(const lar_simulation *simulation, lar_snapshots *snapshots,
                                lar_error *error);
void lar_snapshots_destroy(lar_snapshots *snapshots); /* idempotent */

/* Any thread: a number to wait for, and whether a frame answers it yet. */
uint64_t lar_snapshots_ask(lar_snapshots *snapshots);
bool lar_snapshots_ready(const lar_snapshots *snapshots, uint64_t number);
/* Copies the newest frame. LAR_ERROR_UNSTABLE when it is not finite. */
lar_status lar_snapshots_take(lar_snapshots *snapshots, const lar_simulation *simulation,
                              lar_snapshot *snapshot, lar_error *error);

/* The engine's thread: somebody has asked. */
bool lar_snapshots_wanted(const lar_snapshots *snapshots);
/* The engine's thread, between advances, when somebody has asked; with the tools of that moment. */
void lar_snapshots_serve(lar_snapshots *snapshots, const lar_simulation *simulation,
                         const lar_snapshot_tool *tool, int32_t tools);

#endif
