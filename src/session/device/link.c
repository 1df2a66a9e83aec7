#include "session/device/link.h"

#include <math.h>
#include <string.h>

#include "base/quaternion.h"
#include "session/coupling.h"

static const uint64_t MILLISECOND = 1000000;
enum { SILENCE = 20, FADE = 50, APPROACH = 300, LEAVE = 1000 }; /* [ms] */
/* A device of 4 kHz sends as many in LEAVE; beyond it the numbers belong to something else. */
enum { JUMP_MAX = 10000 };

void lar_link_create(lar_link *link, const char *token, const lar_tool_pose *tool) {
    *link = (lar_link){
        .tool = *tool, .pose = *tool, .from = *tool, .silent = true, .rate = LAR_COUPLING_RATE};
    if (token) memcpy(link->token, token, strnlen(token, sizeof link->token));
}

/* In a time that does not depend on how much of it is right. */
static bool is_token(const lar_link *link, const char token[LAR_PACKET_TOKEN]) {
    int different = 0;
    for (int i = 0; i < LAR_PACKET_TOKEN; i++) different |= link->token[i] ^ token[i];
    return different == 0;
}

static bool is_gone(const lar_link *link, uint64_t now) {
    return now > link->last_packet && now - link->last_packet > LEAVE * MILLISECOND;
}

static lar_link_verdict refuse(lar_link *link) {
    link->refused++;
    return LAR_LINK_REFUSED;
}

/* A word that nobody can guess who does not hear (Steele, Lea and Flood 2014: SplitMix64). */
static uint32_t another_word(lar_link *link) {
    uint32_t word;
    do {
        uint64_t z = link->dice += 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        word = (uint32_t)((z ^ z >> 31) >> 48);
    } while (word == 0 || word == link->word);
    return word;
}

static void take_owner(lar_link *link, const lar_link_address *from) {
    link->owned = true;
    link->owners++;
    link->owner = *from;
    link->word = another_word(link);
    link->proved = false;
    link->told_at = 0; /* it was told nothing yet */
    lar_jitter_buffer_clear(&link->evenly);
    for (int i = 0; i < 3; i++) link->force[i] = link->torque[i] = 0;
}

lar_link_verdict lar_link_take(lar_link *link, const lar_link_address *from, const void *bytes,
                               size_t size, uint64_t now) {
    lar_position_packet packet;
    if (!lar_position_packet_decode(bytes, size, &packet) || !is_token(link, packet.token))
        return refuse(link);
    if (link->owned && is_gone(link, now)) link->owned = false;
    if (!link->owned) {
        take_owner(link, from);
    } else {
        if (memcmp(&link->owner, from, sizeof *from)) return refuse(link);
        /* Numbers go round after 2^32; what lies less than half of that ahead is newer. */
        uint32_t ahead = packet.sequence - link->newest.sequence;
        if (ahead == 0 || ahead > UINT32_MAX / 2) {
            link->late++;
            return LAR_LINK_LATE;
        }
        if (ahead > JUMP_MAX) return refuse(link);
        link->lost += ahead - 1;
        link->proved = link->proved || packet.buttons >> LAR_PACKET_WORD == link->word;
    }
    if (packet.buttons & LAR_BUTTON_CLOSE) packet.pose.opening = 0;
    link->newest = packet;
    lar_jitter_buffer_put(&link->evenly, &packet.pose, packet.time);
    link->last_packet = now;
    link->received++;
    return LAR_LINK_TAKEN;
}

static double toward(double value, double target, double max) {
    return value + fmax(-max, fmin(max, target - value));
}

/* Between the place where the approach began and the hand; starts and ends without a jerk. */
static void approach(const lar_link *link, const lar_tool_pose *to, lar_tool_pose *pose) {
    double a = link->approach, share = a * a * (3 - 2 * a);
    const lar_tool_pose *from = &link->from;
    for (int i = 0; i < 3; i++)
        pose->position[i] = (1 - share) * from->position[i] + share * to->position[i];
    lar_quaternion_blend(from->orientation, to->orientation, share, pose->orientation);
    pose->opening = to->opening;
}

bool lar_link_advance(lar_link *link, bool paused, uint64_t now) {
    uint64_t passed = now > link->last_time ? now - link->last_time : 0;
    if (link->last_time == 0) passed = 0;
    link->last_time = now;
    double ms = (double)passed / (double)MILLISECOND;
    link->left = toward(link->left, 0, ms / FADE);
    if (link->owned && is_gone(link, now)) link->owned = false;
    bool here = link->owned &&
                !(now > link->last_packet && now - link->last_packet > SILENCE * MILLISECOND);
    if (!here && !link->silent && link->received) link->timeouts++;
    /* The engine was held up: for the device, as long a silence. An engine that is always so slow
     * is not. */
    bool held_up = ms > SILENCE && link->last_gap <= SILENCE;
    link->last_gap = ms;
    if (held_up) {
        link->silent = true;
        link->strength = toward(link->strength, 0, (ms - SILENCE) / FADE);
        ms = 0;
    }
    if ((here && link->silent) || paused) {
        link->from = link->tool;
        link->approach = 0;
    }
    link->silent = !here;
    bool lively = here && !paused;
    link->strength = toward(link->strength, lively, ms / (lively ? APPROACH : FADE));
    if (!lively) return false;
    link->approach = toward(link->approach, 1, ms / APPROACH);
    approach(link, &link->newest.pose, &link->pose);
    return true;
}

void lar_link_evenly(lar_link *link, int64_t due, lar_tool_pose *pose) {
    lar_tool_pose hand = link->newest.pose;
    lar_jitter_buffer_at(&link->evenly, due, &hand);
    approach(link, &hand, pose);
}

void lar_link_feel(lar_link *link, const double force[3], const double torque[3],
                   const double held_back[2]) {
    for (int i = 0; i < 3; i++) {
        link->wanted[i] = link->strength * force[i] + link->left * link->left_force[i];
        link->wanted_torque[i] = link->strength * torque[i] + link->left * link->left_torque[i];
        link->force[i] *= 1 - held_back[0];
        link->torque[i] *= 1 - held_back[1];
    }
}

void lar_link_tell(lar_link *link, uint64_t now) {
    uint64_t passed = link->told_at && now > link->told_at ? now - link->told_at : 0;
    double max = link->rate * 1e-9 * (double)passed;
    lar_coupling_approach(link->force, link->wanted, max);
    lar_coupling_approach(link->torque, link->wanted_torque, LAR_COUPLING_RATE_LEVER * max);
    if (link->told_at < now) link->told_at = now;
}

void lar_link_jump(lar_link *link) {
    memcpy(link->left_force, link->force, sizeof link->left_force);
    memcpy(link->left_torque, link->torque, sizeof link->left_torque);
    link->left = 1;
    link->strength = link->approach = 0;
    link->silent = true; /* comes back as after a silence */
}
