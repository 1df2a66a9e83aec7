#include "session/device/jitter_buffer.h"

#include <math.h>

#include "base/quaternion.h"

/* The later positions are, the less stiff a wall may be: two periods of a device of 1 kHz. */
static const double BEHIND_MAX = 2000;        /* [us] */
static const double SHRINK = 1e-3;            /* of the time that goes by: no hand feels that */
static const double MEAN = 2e5, SLOPE = 2000; /* [us] */
/* After so long nobody knows how the hand went [us]. */
enum { SILENCE = 20000 };

void lar_jitter_buffer_clear(lar_jitter_buffer *buffer) {
    buffer->count = buffer->newest = 0;
    buffer->behind = buffer->lead = 0;
}

void lar_jitter_buffer_put(lar_jitter_buffer *buffer, const lar_tool_pose *pose, uint64_t time) {
    if (buffer->count > 0) {
        uint64_t passed = time - buffer->sample[buffer->newest].time;
        if (passed == 0 || passed > SILENCE) lar_jitter_buffer_clear(buffer);
        if (buffer->count > 0) buffer->behind += (double)passed;
    }
    buffer->newest = (buffer->newest + 1) % LAR_JITTER_SAMPLES;
    buffer->sample[buffer->newest].pose = *pose;
    buffer->sample[buffer->newest].time = time;
    if (buffer->count < LAR_JITTER_SAMPLES) buffer->count++;
}

/* The sample that is `ago` older than the newest one. */
static int older(const lar_jitter_buffer *buffer, int ago) {
    return (buffer->newest + LAR_JITTER_SAMPLES - ago) % LAR_JITTER_SAMPLES;
}

static double age(const lar_jitter_buffer *buffer, int ago) {
    return (double)(buffer->sample[buffer->newest].time - buffer->sample[older(buffer, ago)].time);
}

static void go_on(lar_jitter_buffer *buffer, int64_t now) {
    double passed = buffer->asked_at ? 1e-3 * (double)(now - buffer->asked_at) : 0;
    double most = fmin(BEHIND_MAX, age(buffer, buffer->count - 1));
    buffer->behind -= (1 + SHRINK) * passed;
    buffer->behind = fmax(0, fmin(most, buffer->behind));
    buffer->lead += fmin(1, passed / MEAN) * (buffer->behind - buffer->lead);
    buffer->asked_at = now;
}

/* Between two samples, `ago` microseconds before the newest one, which is in the buffer. */
static void look(const lar_jitter_buffer *buffer, double ago, lar_tool_pose *pose) {
    int k = 0;
    while (k + 1 < buffer->count && age(buffer, k + 1) <= ago) k++;
    const lar_tool_pose *late = &buffer->sample[older(buffer, k)].pose;
    *pose = *late;
    if (k + 1 == buffer->count) return;
    const lar_tool_pose *early = &buffer->sample[older(buffer, k + 1)].pose;
    double share = (ago - age(buffer, k)) / (age(buffer, k + 1) - age(buffer, k));
    for (int i = 0; i < 3; i++)
        pose->position[i] += share * (early->position[i] - late->position[i]);
    lar_quaternion_blend(late->orientation, early->orientation, share, pose->orientation);
}

/* As far on as it goes in `lead` microseconds, by what it has done in the last SLOPE before. */
static void lead_on(const lar_jitter_buffer *buffer, lar_tool_pose *pose) {
    double span = fmin(SLOPE, age(buffer, buffer->count - 1) - buffer->behind);
    if (span <= 0) return;
    lar_tool_pose now = *pose, before;
    look(buffer, buffer->behind + span, &before);
    double share = -buffer->lead / span;
    for (int i = 0; i < 3; i++) pose->position[i] += share * (before.position[i] - now.position[i]);
    lar_quaternion_blend(now.orientation, before.orientation, share, pose->orientation);
}

bool lar_jitter_buffer_at(lar_jitter_buffer *buffer, int64_t now, lar_tool_pose *pose) {
    if (buffer->count == 0) return false;
    go_on(buffer, now);
    look(buffer, buffer->behind, pose);
    lead_on(buffer, pose);
    pose->opening = buffer->sample[buffer->newest].pose.opening;
    return true;
}
