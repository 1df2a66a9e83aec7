/* Devices in a person's hand: where they are goes in, what the tool feels comes out (T 1.6, 6.5.1).
 *
 *     device --> poll --> [trocar] --> coupling --> tool --> engine
 *                                         |                    |
 *     device <-- feel <------------ force, bounded <--- force of the tissue
 *
 * The engine's thread polls every device at the beginning of a tick and tells it the force at the
 * end. Neither waits, allocates or takes a lock. What a device must wait for (a file, a name, a
 * library) it does when it is opened. The coupling (coupling.h) is the session's, one for every
 * tool, also for tools without a device: the device only says where the hand is.
 *
 * Kinds of devices are the rows of one table (device.c); backend.h is what a new one fills.
 */
#ifndef LAR_SESSION_DEVICE_DEVICE_H
#define LAR_SESSION_DEVICE_DEVICE_H

#include <stdbool.h>

#include "base/error.h"

/* One exchange with the engine. */
typedef struct lar_device_tick {
    uint64_t step;  /* steps done */
    double time;    /* simulated, since the start or the last reset [s] */
    double seconds; /* length of a tick [s] */
    uint64_t now;   /* CLOCK_MONOTONIC [ns] */
    bool paused;    /* nothing moves: devices may be answered, scripts stand still */
    /* To feel: shares of force and torque that nobody paid for, which fall at once. */
    double held_back[2];
} lar_device_tick;

typedef struct lar_device lar_device;

/* Opens what `spec` says (lar_session_attach; docs/devices.md) for this tool, whose rest pose is
 * where the device's own origin lies. LAR_ERROR_ARGUMENT: no such kind or option, the message lists
 * those that exist; LAR_ERROR_UNSUPPORTED: not in this build, or no such controller is plugged in;
 * LAR_ERROR_IO, LAR_ERROR_FORMAT: of the file or the socket. */
lar_status lar_device_open(const char *spec, const lar_tool_info *tool, lar_device **device,
                           lar_error *error);
/* NULL is fine. */
void lar_device_close(lar_device *device);

/* How fast what the hand feels may change [N/s]; 0: as the coupling has it. */
double lar_device_rate(const lar_device *device);

/* Where the hand is. False: nothing new, `pose` is as it was and the tool stays where it was sent.
 */
bool lar_device_poll(lar_device *device, const lar_device_tick *tick, lar_tool_pose *pose);

/* How many hands have had it so far, as of the last poll: each that comes to a device which nobody
 * had, or had no longer, is another one. */
uint64_t lar_device_owners(const lar_device *device);

/* After it was true: where the hand was a little before the tick was due [ns], as far on from the
 * tick before as it has gone in that time, however packets came. As it is where a device has no
 * times of its own. */
void lar_device_evenly(lar_device *device, int64_t due, lar_tool_pose *pose);

/* What the hand feels, after the coupling, and where the tool is. `tick` is the one that ended,
 * with `now` of now. */
void lar_device_feel(lar_device *device, const lar_device_tick *tick, const lar_tool_force *force,
                     const lar_tool_pose *pose);

/* What it was told last has left by now, CLOCK_MONOTONIC [ns]. Without this call: at the tick's. */
void lar_device_told(lar_device *device, uint64_t now);

/* The simulation went back or was loaded: time and tool have jumped. */
void lar_device_reset(lar_device *device);

/* Belongs to the thread that polls, between two polls. `name` lives as long as the device. */
void lar_device_status_get(const lar_device *device, lar_device_status *status);

#endif
