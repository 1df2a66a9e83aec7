/* Fuzz target: what a device on the network may be sent. The input is a list of datagrams and the
 * time between them:
 *
 *     | sender 1 | size 1 | wait [ms] 1 | bytes ... | sender 1 | ...
 *
 * Whatever comes, the pose is one that a tool can have, the force's share is in 0..1, nothing jumps
 * while somebody holds the device, and no one but the owner moves it. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "session/device/link.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const uint64_t MS = 1000000;

static void require(bool good) {
    if (!good) __builtin_trap();
}

static void check_pose(const lar_tool_pose *pose) {
    double square = 0;
    for (int i = 0; i < 3; i++) require(fabs(pose->position[i]) <= 100);
    for (int i = 0; i < 4; i++) square += pose->orientation[i] * pose->orientation[i];
    require(fabs(square - 1) < 1e-9);
    require(pose->opening >= 0 && pose->opening <= 1);
}

static void check_link(const lar_link *link) {
    require(link->strength >= 0 && link->strength <= 1);
    require(link->approach >= 0 && link->approach <= 1);
    check_pose(&link->pose);
}

static void check_packet(const uint8_t *bytes, size_t size) {
    lar_position_packet packet, again;
    unsigned char back[LAR_PACKET_BYTES];
    lar_force_packet force;
    (void)lar_force_packet_decode(bytes, size, &force);
    if (!lar_position_packet_decode(bytes, size, &packet)) return;
    check_pose(&packet.pose);
    lar_position_packet_encode(&packet, back);
    require(lar_position_packet_decode(back, sizeof back, &again));
    require(again.sequence == packet.sequence && again.time == packet.time);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const lar_tool_pose origin = {.orientation = {1, 0, 0, 0}, .opening = 1};
    lar_link link;
    uint64_t now = 1;
    bool token = size > 0 && data[0] & 0x80;
    lar_link_create(&link, token ? "0123456789" : NULL, &origin);
    while (size >= 3) {
        lar_link_address from = {{(unsigned char)(1 + (data[0] & 3))}};
        size_t bytes = data[1] < size - 3 ? data[1] : size - 3;
        uint32_t last = link.newest.sequence;
        bool held = link.owned && now - link.last_packet <= 1000 * MS;
        bool owner = held && !memcmp(&link.owner, &from, sizeof from);
        lar_link_verdict verdict = lar_link_take(&link, &from, data + 3, bytes, now);
        check_packet(data + 3, bytes);
        if (held && !owner) require(verdict == LAR_LINK_REFUSED);
        if (verdict == LAR_LINK_TAKEN) {
            require(bytes == LAR_PACKET_BYTES);
            require(!token || !memcmp(link.newest.token, "0123456789\0\0\0\0\0", 16));
            if (owner) require((int32_t)(link.newest.sequence - last) > 0);
        }
        now += data[2] * MS;
        lar_tool_pose before = link.pose;
        bool here = lar_link_advance(&link, data[0] & 0x40, now);
        if (!here) require(!memcmp(&before, &link.pose, sizeof before));
        check_link(&link);
        link.tool = link.pose;
        data += 3 + bytes;
        size -= 3 + bytes;
    }
    return 0;
}
