/* A force-feedback device for people who have none: it sends positions to a session as a device's
 * driver would (docs/devices.md), takes the forces, and measures the way there and back.
 *
 *     send    |.....|.....|.....|     `rate` times a second, whatever comes back
 *     answer      \_____/             matched by sequence number
 *              round trip
 *
 * The hand moves by itself, in the device's axes: along a file, in a circle in x and y, or down and
 * up along z. It does not give way to the force.
 */
#ifndef LAR_STUDY_DEVICE_CLIENT_H
#define LAR_STUDY_DEVICE_CLIENT_H

#include <signal.h>
#include <stdbool.h>

#include "base/error.h"

typedef struct lar_device_client_options {
    const char *address; /* "udp:127.0.0.1:9000" */
    const char *token;   /* up to 16 characters, or NULL */
    const char *script;  /* a file (model/tool_script.h), or NULL */
    double circle, push; /* radius or depth [m]; both 0: at rest */
    double period;       /* of circle and push [s] */
    double rate;         /* packets per second */
    double seconds;
    const volatile sig_atomic_t *stop; /* ends it early when it becomes 1; may be NULL */
} lar_device_client_options;

typedef struct lar_device_client_report {
    double seconds;          /* that it took */
    uint64_t sent, answered; /* each answer counted once */
    uint64_t lost;           /* sent and never answered */
    uint64_t strange;        /* packets that answer nothing */
    uint64_t steps;          /* of the engine, from the first answer to the last */
    double round_trip_p50, round_trip_p99, round_trip_p999, round_trip_max; /* there and back [s] */
    double force_max, force_mean;                                           /* [N] */
    double torque_max;                                                      /* [N m] */
    uint64_t touching, holding; /* answers that said so */
} lar_device_client_report;

/* Sends for options->seconds and waits a tenth of a second for the last answers. LAR_ERROR_PEER
 * when nobody answers at all. */
lar_status lar_device_client(const lar_device_client_options *options,
                             lar_device_client_report *report, lar_error *error);

#endif
