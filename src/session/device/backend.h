/* What a kind of device fills: one row of the table in device.c.
 *
 * A backend speaks of poses in the device's own axes. Where these lie in the scene (options at,
 * axes, scale and trocar) is done once for all of them in device.c.
 */
#ifndef LAR_SESSION_DEVICE_BACKEND_H
#define LAR_SESSION_DEVICE_BACKEND_H

#include "session/device/device.h"
#include "session/device/trocar.h"

/* "udp:127.0.0.1:9000,scale=2" taken apart. */
typedef struct lar_device_spec {
    const char *text; /* all of it */
    char *argument;   /* "127.0.0.1:9000" */
    double at[3];     /* where the device's origin lies in the scene [m] */
    bool at_given;
    double scale;   /* metres of the scene per metre of the device */
    double axes[4]; /* quaternion: the device's axes into the scene's */
    bool trocar_given;
    double trocar[3];    /* [m] */
    const char *token;   /* of udp; NULL: none */
    double rate;         /* of udp: what the force may change by [N/s]; 0: not given */
    double speed;        /* of gamepad, at full stick [m/s]; 0: not given */
    bool turns_absolute; /* set by open: orientations are the scene's, not turns of the tool's */
} lar_device_spec;

typedef struct lar_device_backend {
    const char *name, *form, *summary;
    const char *options; /* besides those of all, with blanks between and at both ends */
    const char *missing; /* NULL, or how to get it */
    bool absolute;       /* positions are the scene's, not relative to the tool at rest */
    lar_status (*open)(lar_device_spec *spec, void **state, lar_error *error);
    void (*close)(void *state);
    /* The newest pose; false when there is none. */
    bool (*poll)(void *state, const lar_device_tick *tick, lar_tool_pose *pose);
    /* The pose of lar_device_evenly; NULL: the newest. */
    void (*evenly)(void *state, int64_t due, lar_tool_pose *pose);
    uint64_t (*owners)(const void *state); /* of lar_device_owners; NULL: one */
    /* NULL: feels nothing. Force and pose in the device's axes. */
    void (*feel)(void *state, const lar_device_tick *tick, const lar_tool_force *force,
                 const lar_tool_pose *pose);
    void (*told)(void *state, uint64_t now);                      /* may be NULL */
    void (*reset)(void *state);                                   /* may be NULL */
    void (*report)(const void *state, lar_device_status *status); /* may be NULL */
} lar_device_backend;

extern const lar_device_backend lar_device_script, lar_device_udp, lar_device_gamepad;

#endif
