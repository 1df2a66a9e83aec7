/* A simulation in real time, with people and devices at its tools (T 5.3.1, 6.1, 6.5).
 *
 *     any thread                              the engine's thread, every tick
 *     ----------                              -------------------------------
 *     play, pause, save, ... --requests-->    what was asked for
 *     tool_move ---------mailbox per tool-->  hands --> couplings --> tools move within the tick
 *                                             advance by the tick's steps
 *     tool_force, status <----mailbox------   forces, poses, counts
 *     force_history <----------ring--------   forces of past ticks
 *     snapshot (asks) <-------mailbox------   the whole state, when somebody has asked
 *     (file) <---------ring, a thread------   recording
 *                                             sleep until the next tick
 *
 * The engine's thread waits for nobody: it tries locks, and what it cannot have it does a tick
 * later. Everybody else may wait for it.
 *
 * While no thread runs (not started yet) the calls that ask for something do it themselves.
 */
#ifndef LAR_SESSION_SESSION_H
#define LAR_SESSION_SESSION_H

#include "engine/simulation.h"
#include "session/exchange.h"
#include "session/history.h"
#include "session/pace.h"
#include "session/requests.h"
#include "session/snapshot.h"

/* What the engine tells in every tick. */
typedef struct lar_session_view {
    lar_session_status status;
    struct {
        lar_tool_pose pose;
        lar_tool_force force;
    } tool[LAR_TOOLS_MOST];
} lar_session_view;

/* A tool and whoever moves it: the engine's. */
typedef struct lar_session_tool {
    lar_mailbox hand;     /* lar_tool_pose, from tool_move */
    lar_tool_info info;   /* constant */
    bool led;             /* somebody has moved it since the start or the last reset */
    lar_tool_pose target; /* where its hand is */
    lar_tool_pose pose;   /* where it is */
    lar_tool_force force; /* of the last tick */
} lar_session_tool;

struct lar_session {
    lar_simulation *simulation;
    lar_session_options options; /* with no zeros left */
    uint64_t tick_steps;
    double time_step;
    int32_t tools;
    lar_session_tool tool[LAR_TOOLS_MOST];

    lar_requests requests;
    lar_mailbox view; /* lar_session_view, to everybody */
    lar_history history;
    lar_snapshots snapshots;
    pthread_t thread;
    bool started; /* under requests.lock */

    /* The engine's own. */
    lar_session_status status;
    lar_pace pace;
    bool stepping; /* pauses when `steps_left` are done */
    uint64_t steps_left;
    bool ended;
};

/* The engine's thread, or whoever holds requests.lock while there is none. */
void *lar_session_run(void *session);
void lar_session_obey(lar_session *session, const lar_request *request);
void lar_session_publish(lar_session *session, bool quantiles);
/* The tools are where the simulation has them, and nobody has moved them. */
void lar_session_take_tools(lar_session *session);

#endif
