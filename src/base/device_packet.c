#include "base/device_packet.h"

#include <math.h>
#include <string.h>

#include "base/pose.h"

enum { KIND_POSITION = 1, KIND_FORCE = 2 };
static const unsigned char MAGIC[4] = {'L', 'A', 'R', 'D'};
static const double FARTHEST = 100, GREATEST = 1e6; /* [m], [N] */

static void put(unsigned char *at, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++) at[i] = (unsigned char)(value >> 8 * i);
}

static uint64_t get(const unsigned char *at, int bytes) {
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++) value |= (uint64_t)at[i] << 8 * i;
    return value;
}

static void put_doubles(unsigned char *at, const double *value, int count) {
    for (int i = 0; i < count; i++) {
        uint64_t word;
        memcpy(&word, &value[i], sizeof word);
        put(at + 8 * i, word, 8);
    }
}

/* False when one is not finite or its size is above `max`. */
static bool get_doubles(const unsigned char *at, double *value, int count, double max) {
    bool fine = true;
    for (int i = 0; i < count; i++) {
        uint64_t word = get(at + 8 * i, 8);
        memcpy(&value[i], &word, sizeof word);
        fine = fine && fabs(value[i]) <= max; /* false for NaN */
    }
    return fine;
}

static void put_head(unsigned char *bytes, int kind, uint32_t sequence, uint32_t word,
                     uint64_t time) {
    memcpy(bytes, MAGIC, sizeof MAGIC);
    put(bytes + 4, LAR_PACKET_VERSION, 2);
    put(bytes + 6, (uint64_t)kind, 2);
    put(bytes + 8, sequence, 4);
    put(bytes + 12, word, 4);
    put(bytes + 16, time, 8);
}

static bool has_head(const unsigned char *bytes, size_t size, uint64_t kind) {
    return size == LAR_PACKET_BYTES && !memcmp(bytes, MAGIC, sizeof MAGIC) &&
           get(bytes + 4, 2) == LAR_PACKET_VERSION && get(bytes + 6, 2) == kind;
}

void lar_position_packet_encode(const lar_position_packet *packet,
                                unsigned char bytes[LAR_PACKET_BYTES]) {
    put_head(bytes, KIND_POSITION, packet->sequence, packet->buttons, packet->time);
    memcpy(bytes + 24, packet->token, LAR_PACKET_TOKEN);
    put_doubles(bytes + 40, packet->pose.position, 3);
    put_doubles(bytes + 64, packet->pose.orientation, 4);
    put_doubles(bytes + 96, &packet->pose.opening, 1);
}

void lar_force_packet_encode(const lar_force_packet *packet,
                             unsigned char bytes[LAR_PACKET_BYTES]) {
    put_head(bytes, KIND_FORCE, packet->sequence, packet->flags, packet->time);
    put(bytes + 24, packet->step, 8);
    put_doubles(bytes + 32, packet->force, 3);
    put_doubles(bytes + 56, packet->torque, 3);
    put_doubles(bytes + 80, packet->position, 3);
}

bool lar_position_packet_decode(const void *data, size_t size, lar_position_packet *packet) {
    const unsigned char *bytes = data;
    if (!has_head(bytes, size, KIND_POSITION)) return false;
    packet->sequence = (uint32_t)get(bytes + 8, 4);
    packet->buttons = (uint32_t)get(bytes + 12, 4);
    packet->time = get(bytes + 16, 8);
    memcpy(packet->token, bytes + 24, LAR_PACKET_TOKEN);
    lar_tool_pose *pose = &packet->pose;
    if (!get_doubles(bytes + 40, pose->position, 3, FARTHEST) ||
        !get_doubles(bytes + 64, pose->orientation, 4, 1.01) ||
        !get_doubles(bytes + 96, &pose->opening, 1, 1) || pose->opening < 0)
        return false;
    return lar_pose_normalise(pose, NULL, NULL) == LAR_OK;
}

bool lar_force_packet_decode(const void *data, size_t size, lar_force_packet *packet) {
    const unsigned char *bytes = data;
    if (!has_head(bytes, size, KIND_FORCE)) return false;
    packet->sequence = (uint32_t)get(bytes + 8, 4);
    packet->flags = (uint32_t)get(bytes + 12, 4);
    packet->time = get(bytes + 16, 8);
    packet->step = get(bytes + 24, 8);
    return get_doubles(bytes + 32, packet->force, 3, GREATEST) &&
           get_doubles(bytes + 56, packet->torque, 3, GREATEST) &&
           get_doubles(bytes + 80, packet->position, 3, GREATEST);
}
