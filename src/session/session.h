/* A simulation in real time, with people and devices at its tools (T 5.3.1, 6.1, 6.5).
 *
 *     any thread                              the engine's thread, every tick
 *     ----------                              -------------------------------
 *     play, pause, save, ... --requests-->    what was asked for
 *     tool_move ---triple buffer per tool-->  hands --> couplings --> tools move within the tick
 *                                             advance by the tick's steps
 *     tool_force, status <-triple buffer----   forces, poses, counts
 *     force_history <----------ring--------   forces of past ticks
 *     snapshot (asks) <---triple buffer----   the whole state, when somebody has asked
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

#include "base/thread.h"
#include "simulation/simulation.h"
#include "session/advice.h"
#include "session/coupling.h"
#include "session/device/device.h"
#include "session/triple_buffer.h"
#include "session/history.h"
#include "session/pace.h"
#include "session/recording/player.h"
#include "session/recording/file.h"
#include "session/recovery.h"
#include "session/requests.h"
#include "session/snapshot.h"

/* What the engine tells in every tick. */
typedef struct lar_session_view {
    lar_session_status status;
    double gravity[3], damping;     /* [m/s^2] [1/s] */
    double factor[LAR_FACTORS_MAX]; /* of the stiffness of materials */
    double activation[LAR_FACTORS_MAX];
    struct {
        lar_tool_info info;
        lar_tool_pose pose;
        lar_tool_force force, felt;
        lar_tool_load load;
        lar_grasp_answer grasp;
        lar_device_status device; /* summed up from time to time only */
    } tool[LAR_TOOLS_MAX];
} lar_session_view;

/* A tool and whoever moves it: the engine's. */
typedef struct lar_session_tool {
    lar_triple_buffer hand; /* lar_tool_pose, from tool_move */
    lar_tool_info info;     /* constant, but for spares: then the engine's, others ask the view */
    lar_device *device;     /* NULL: it listens to tool_move */
    uint64_t owners;        /* of the device, as of the last look */
    bool led;   /* somebody has moved it since the start, or since the simulation was last
                   put somewhere else */
    bool waits; /* a hand that let go when the run went back: until it has opened */
    lar_device_status device_status; /* as last summed up */
    lar_coupling coupling;           /* between the hand and it */
    lar_tool_pose target;            /* where its hand is */
    lar_tool_pose evenly;            /* where it was, to the tick: what it is led to */
    lar_tool_pose pose;              /* where the coupling asks it to be at the tick's end */
    lar_tool_pose sent;              /* where the simulation was told to move it */
    lar_tool_pose place;             /* where it is at the tick's end: tissue may keep it */
    lar_tool_force force;            /* what the tissue does to it */
    lar_tool_load load;              /* since the session was opened */
    lar_grasp_answer grasp;
    lar_tool_force felt; /* what its hand feels and its device is told, behind the coupling */
} lar_session_tool;

struct lar_session {
    lar_simulation *simulation;
    lar_session_options options; /* with no zeros left */
    uint64_t tick_steps;
    double time_step;
    int urgent;       /* how far its thread goes before others; 0: an ordinary one */
    int64_t owed;     /* what others are owed of the time that was not waited [ns] */
    int64_t waited;   /* until when was waited last [ns] */
    uint64_t divided; /* steps of the simulation that were divided before the session */
    int32_t tools;
    lar_session_tool tool[LAR_TOOLS_MAX];

    lar_requests requests;
    lar_triple_buffer *view; /* lar_session_view, to everybody: looking takes the newest one over */
    lar_history history;
    lar_snapshots snapshots;
    lar_thread thread;
    pid_t process; /* that opened it */
    bool started;  /* under requests.lock */
    bool hosted;   /* the same: lar_session_tick instead of a thread */

    /* The engine's own. */
    lar_session_status status;
    lar_pace pace;
    lar_advice advice;
    bool stepping; /* pauses when `steps_left` are done */
    uint64_t steps_left;
    lar_recovery recovery;
    uint64_t good_step;     /* where the last tick ended that did not break */
    lar_recorder *recorder; /* NULL: none */
    lar_player *player;     /* NULL: none */
    uint64_t hashed;        /* step of the latest hash in the recording */
    int64_t felt_at;        /* when hands last felt something, by the clock [ns]; 0: never */
    bool ended;
};

/* Refuses NULL and tools that are none. */
lar_status lar_session_check_tool(const lar_session *session, int32_t tool, lar_error *error);
lar_recording_header lar_session_recording_header(const lar_session *session);

/* All that follows belongs to the engine's thread, or to whoever holds requests.lock while there is
 * none. */

void *lar_session_run(void *session);
void lar_session_execute(lar_session *session, const lar_request *request);
/* With a host's clock, under requests.lock: what was asked for since the last tick. */
void lar_session_execute_asked(lar_session *session);
/* The simulation is somewhere else now, and the run goes on from there. */
lar_status lar_session_arrive(lar_session *session, lar_error *error);
/* Plays from now on; rests; stops, because the run broke. */
void lar_session_go_on(lar_session *session);
void lar_session_rest(lar_session *session);
void lar_session_stop(lar_session *session, const lar_error *error);
/* The run has become unstable, as *error says: goes back to a sound state and plays on from there.
 * False: the session has to stop, and *error says why. */
bool lar_session_recover(lar_session *session, lar_error *error);
/* At the end of a tick: keeps the state when it is time to. */
lar_status lar_session_keep_state(lar_session *session, lar_error *error);
/* The simulation is where the session was opened, reset or loaded: what was kept is forgotten. */
lar_status lar_session_begin_states(lar_session *session, lar_error *error);
/* Whether the tool may follow its hand, whose place is `target`. */
bool lar_session_follows(lar_session *session, int32_t tool);
/* False when nobody has asked for a snapshot. The state is gathered. */
bool lar_session_serve_snapshots(lar_session *session);
/* Tells everybody how it stands; with `quantiles` also what has to be summed up. */
void lar_session_publish(lar_session *session, bool quantiles);
/* Sets it now, and in the recording. */
lar_status lar_session_apply(lar_session *session, const lar_setting *setting, lar_error *error);
/* Into the recording, when there is one. */
void lar_session_put_record(lar_session *session, const lar_record *record);
/* The hash of this moment; the state that the simulation was put into; the end. */
void lar_session_record_hash(lar_session *session);
lar_status lar_session_record_state(lar_session *session, lar_error *error);
void lar_session_record_end(lar_session *session);

/* The force on the hand changes as fast as the tool's device allows, where it says so. */
void lar_session_take_rate(lar_session_tool *tool);
/* A hand and a tool come together anew: the tool is another one. */
void lar_session_couple(lar_session *session, int32_t tool);
/* Spares that have been added or removed since: they are where the simulation has them. */
void lar_session_look_at_spares(lar_session *session);

/* The tools are where the simulation has them, and nobody leads them. */
void lar_session_take_tools(lar_session *session);
/* Takes hold at a point (of hands), lets go: now, whatever was asked of the tool before. */
lar_status lar_session_take_hold(lar_session *session, int32_t tool, const double point[3],
                                 int32_t *held, lar_error *error);
lar_status lar_session_let_go(lar_session *session, int32_t tool, lar_error *error);
/* Before a tick: hands, couplings, tools. */
lar_status lar_session_move_tools(lar_session *session, lar_error *error);
/* Behind it: forces, to the hands and into the history. */
void lar_session_feel_tools(lar_session *session);
/* The run has broken off: tools feel nothing. What devices were told fades as in a pause. */
void lar_session_drop_forces(lar_session *session);
/* Instead of both while nothing moves: what hands feel shrinks to `share` of it. True when there
 * is a device, which wants to be looked after in every tick. */
bool lar_session_idle_tools(lar_session *session, double share);

#endif
