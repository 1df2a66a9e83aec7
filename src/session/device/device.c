#include "session/device/device.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "contact/tools.h"
#include "session/device/backend.h"
#include "base/quaternion.h"

static const lar_device_backend *const backends[] = {&lar_device_script, &lar_device_udp,
                                                     &lar_device_gamepad};
enum { KINDS = sizeof backends / sizeof backends[0] };

struct lar_device {
    const lar_device_backend *backend;
    void *state;
    char *name;                   /* the spec */
    double at[3], scale, axes[4]; /* the device's axes in the scene */
    bool turns_absolute;
    double rest[4]; /* of the tool */
    double rate;    /* [N/s]; 0: not given */
    bool pivots;
    lar_trocar trocar;
    lar_trocar_angles angles; /* of the last pose */
};

/* ---- what the spec says ---------------------------------------------------------------------- */

static const char COMMON_OPTIONS[] = " at axes scale trocar ";

static lar_status bad_kind(const char *text, lar_error *error) {
    char forms[400] = "";
    for (int i = 0; i < KINDS; i++) {
        size_t used = strlen(forms);
        snprintf(forms + used, sizeof forms - used, "%s%s",
                 i == 0           ? ""
                 : i == KINDS - 1 ? " or "
                                  : ", ",
                 backends[i]->form);
    }
    return lar_fail(error, LAR_ERROR_ARGUMENT, "device '%s': no such kind of device; use %s", text,
                    forms);
}

static const lar_device_backend *find_kind(const char *text) {
    size_t length = strcspn(text, ":,");
    for (int i = 0; i < KINDS; i++)
        if (strlen(backends[i]->name) == length && !strncmp(backends[i]->name, text, length))
            return backends[i];
    return NULL;
}

static bool read_point(lar_span value, double point[3]) {
    lar_span part, rest = value;
    for (int i = 0; i < 3; i++) {
        bool more = lar_span_split(rest, ':', &part, &rest);
        if (more != (i < 2) || !lar_span_double(part, &point[i])) return false;
        if (!(fabs(point[i]) <= 100)) return false;
    }
    return true;
}

/* "x-zy": the scene's x is the device's x, its y the device's -z, its z the device's y. */
static bool read_axes(lar_span value, double q[4]) {
    double m[3][3] = {{0}};
    size_t at = 0;
    for (int row = 0; row < 3; row++) {
        double sign = 1;
        if (at < value.length && (value.at[at] == '-' || value.at[at] == '+'))
            sign = value.at[at++] == '-' ? -1 : 1;
        if (at >= value.length || value.at[at] < 'x' || value.at[at] > 'z') return false;
        m[row][value.at[at++] - 'x'] = sign;
    }
    double volume = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        volume += m[0][i] * (m[1][j] * m[2][k] - m[1][k] * m[2][j]);
    }
    if (at != value.length || volume != 1) return false;
    /* The largest component first: one of the four is at least 1/2. */
    double square[4] = {1 + m[0][0] + m[1][1] + m[2][2], 1 + m[0][0] - m[1][1] - m[2][2],
                        1 - m[0][0] + m[1][1] - m[2][2], 1 - m[0][0] - m[1][1] + m[2][2]};
    int max = 0;
    for (int i = 1; i < 4; i++)
        if (square[i] > square[max]) max = i;
    double turn[3] = {m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
    for (int i = 0; i < 4; i++) {
        if (i == max)
            q[i] = square[i];
        else if (max == 0)
            q[i] = turn[i - 1];
        else if (i == 0)
            q[i] = turn[max - 1];
        else
            q[i] = m[i - 1][max - 1] + m[max - 1][i - 1];
    }
    return lar_quaternion_normalise(q);
}

static bool is_twice(const char *text, lar_span name) {
    char option[32];
    snprintf(option, sizeof option, ",%.*s=", (int)name.length, name.at);
    const char *first = strstr(text, option);
    return first && strstr(first + 1, option);
}

static lar_status read_option(const lar_device_backend *backend, char *option,
                              lar_device_spec *spec, lar_error *error) {
    lar_span name, value;
    bool split = lar_span_split((lar_span){option, strlen(option)}, '=', &name, &value);
    char word[32];
    snprintf(word, sizeof word, " %.*s ", (int)(name.length < 28 ? name.length : 28), name.at);
    bool known = strstr(COMMON_OPTIONS, word) || strstr(backend->options, word);
    if (!split || !known || strchr(word + 1, ' ') != word + strlen(word) - 1)
        return lar_fail(
            error, LAR_ERROR_ARGUMENT,
            "device '%s': '%s' is no option of it; there are%s%sto write as name=value, "
            "each behind a comma",
            spec->text, option, COMMON_OPTIONS, backend->options + 1);
    if (is_twice(spec->text, name))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "device '%s': %.*s is there twice; leave one out", spec->text,
                        (int)name.length, name.at);
    const char *wanted = NULL;
    if (lar_span_equal(name, "at")) {
        spec->at_given = true;
        if (!read_point(value, spec->at)) wanted = "a point X:Y:Z in metres, within 100 m";
    } else if (lar_span_equal(name, "trocar")) {
        spec->trocar_given = true;
        if (!read_point(value, spec->trocar)) wanted = "a point X:Y:Z in metres, within 100 m";
    } else if (lar_span_equal(name, "scale")) {
        if (!lar_span_double(value, &spec->scale) || !(spec->scale >= 1e-3 && spec->scale <= 1e3))
            wanted = "a number from 0.001 to 1000";
    } else if (lar_span_equal(name, "axes")) {
        if (!read_axes(value, spec->axes))
            wanted = "the device's axes that are the scene's x, y and z, right-handed, as in "
                     "xyz or x-zy";
    } else if (lar_span_equal(name, "speed")) {
        if (!lar_span_double(value, &spec->speed) || !(spec->speed > 0 && spec->speed <= 1))
            wanted = "a speed in m/s, more than 0 and at most 1";
    } else if (lar_span_equal(name, "rate")) {
        if (!lar_span_double(value, &spec->rate) || !(spec->rate >= 1 && spec->rate <= 1e5))
            wanted = "how fast the force may change, from 1 to 100000 N/s";
    } else {
        spec->token = value.at; /* the last piece of the text ends there */
        if (value.length < 8 || value.length > 16) wanted = "8 to 16 characters";
    }
    if (!wanted) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "device '%s': %.*s needs %s", spec->text,
                    (int)name.length, name.at, wanted);
}

/* Takes `text`, a copy of the spec, apart in its place. */
static lar_status read_spec(char *text, lar_device_spec *spec, const lar_device_backend **backend,
                            lar_error *error) {
    char *colon = strchr(text, ':');
    *backend = find_kind(text);
    if (!*backend) return bad_kind(spec->text, error);
    if (!colon || colon[1] == '\0' || colon[1] == ',')
        return lar_fail(error, LAR_ERROR_ARGUMENT, "device '%s': it does not say which; use %s",
                        spec->text, (*backend)->form);
    spec->argument = colon + 1;
    char *comma = strchr(text, ',');
    while (comma) {
        char *option = comma + 1;
        *comma = '\0';
        comma = strchr(option, ',');
        if (comma) *comma = '\0';
        lar_status status = read_option(*backend, option, spec, error);
        if (status) return status;
    }
    return LAR_OK;
}

/* ---- the device's axes and the scene's ------------------------------------------------------- */

/* `spec` as open has left it. */
static void place(lar_device *device, const lar_device_spec *spec, const lar_tool_info *tool) {
    for (int i = 0; i < 3; i++)
        device->at[i] = spec->at_given              ? spec->at[i]
                        : device->backend->absolute ? 0
                                                    : tool->rest.position[i];
    device->scale = spec->scale;
    memcpy(device->axes, spec->axes, sizeof device->axes);
    device->turns_absolute = spec->turns_absolute;
    memcpy(device->rest, tool->rest.orientation, sizeof device->rest);
    device->rate = spec->rate;
    device->pivots = spec->trocar_given;
    if (device->pivots) lar_trocar_create(&device->trocar, spec->trocar, &tool->rest);
}

static void into_scene(lar_device *device, const lar_tool_pose *own, lar_tool_pose *pose) {
    double turned[3], back[4];
    lar_turn(device->axes, own->position, turned);
    for (int i = 0; i < 3; i++) pose->position[i] = device->at[i] + device->scale * turned[i];
    lar_quaternion_product(device->axes, own->orientation, pose->orientation);
    if (!device->turns_absolute) { /* the same turn seen from the scene, of the tool at rest */
        lar_quaternion_inverse(device->axes, back);
        lar_quaternion_product(pose->orientation, back, pose->orientation);
        lar_quaternion_product(pose->orientation, device->rest, pose->orientation);
    }
    lar_quaternion_normalise(pose->orientation);
    pose->opening = own->opening;
    if (!device->pivots) return;
    lar_trocar_find(&device->trocar, pose, &device->angles);
    lar_trocar_limit(&device->trocar, &device->angles);
    lar_trocar_pose(&device->trocar, &device->angles, pose);
}

static void into_device(const lar_device *device, const lar_tool_pose *pose, lar_tool_pose *own) {
    double from[3], back[4];
    for (int i = 0; i < 3; i++) from[i] = (pose->position[i] - device->at[i]) / device->scale;
    lar_turn_back(device->axes, from, own->position);
    memcpy(own->orientation, pose->orientation, sizeof own->orientation);
    if (!device->turns_absolute) {
        lar_quaternion_inverse(device->rest, back);
        lar_quaternion_product(own->orientation, back, own->orientation);
        lar_quaternion_product(own->orientation, device->axes, own->orientation);
    }
    lar_quaternion_inverse(device->axes, back);
    lar_quaternion_product(back, own->orientation, own->orientation);
    own->opening = pose->opening;
}

/* ---- the interface --------------------------------------------------------------------------- */

lar_status lar_device_open(const char *spec, const lar_tool_info *tool, lar_device **device,
                           lar_error *error) {
    lar_device_spec parts = {.text = spec, .scale = 1, .axes = {1, 0, 0, 0}};
    lar_device *d = lar_calloc(1, sizeof *d);
    char *text = lar_strdup(spec);
    if (d) d->name = lar_strdup(spec);
    lar_status status = LAR_OK;
    if (!d || !text || !d->name) status = lar_fail_memory(error, sizeof *d, "a device");
    if (!status) status = read_spec(text, &parts, &d->backend, error);
    if (!status && d->backend->missing)
        status =
            lar_fail(error, LAR_ERROR_UNSUPPORTED, "device '%s': %s", spec, d->backend->missing);
    if (!status) status = d->backend->open(&parts, &d->state, error);
    if (!status) place(d, &parts, tool);
    free(text);
    if (status)
        lar_device_close(d);
    else
        *device = d;
    return status;
}

void lar_device_close(lar_device *device) {
    if (!device) return;
    if (device->state) device->backend->close(device->state);
    free(device->name);
    free(device);
}

double lar_device_rate(const lar_device *device) {
    return device->rate;
}

bool lar_device_poll(lar_device *device, const lar_device_tick *tick, lar_tool_pose *pose) {
    lar_tool_pose own = {.orientation = {1, 0, 0, 0}, .opening = 1};
    if (!device->backend->poll(device->state, tick, &own)) return false;
    into_scene(device, &own, pose);
    return true;
}

uint64_t lar_device_owners(const lar_device *device) {
    return device->backend->owners ? device->backend->owners(device->state) : 0;
}

void lar_device_evenly(lar_device *device, int64_t due, lar_tool_pose *pose) {
    lar_tool_pose own;
    if (!device->backend->evenly) return;
    device->backend->evenly(device->state, due, &own);
    into_scene(device, &own, pose);
}

void lar_device_feel(lar_device *device, const lar_device_tick *tick, const lar_tool_force *force,
                     const lar_tool_pose *pose) {
    if (!device->backend->feel) return;
    lar_tool_force own = *force;
    lar_tool_pose there;
    lar_turn_back(device->axes, force->force, own.force);
    lar_turn_back(device->axes, force->torque, own.torque);
    into_device(device, pose, &there);
    device->backend->feel(device->state, tick, &own, &there);
}

void lar_device_told(lar_device *device, uint64_t now) {
    if (device->backend->told) device->backend->told(device->state, now);
}

void lar_device_reset(lar_device *device) {
    if (device->backend->reset) device->backend->reset(device->state);
}

void lar_device_status_get(const lar_device *device, lar_device_status *status) {
    *status = (lar_device_status){.name = device->name};
    if (device->backend->report) device->backend->report(device->state, status);
}
