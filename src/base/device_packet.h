/* The two packets of a device on the network, byte by byte (docs/devices.md).
 *
 *     to the engine                          from the engine
 *       0  4  "LARD"                           0  4  "LARD"
 *       4  2  version, 1                       4  2  version, 1
 *       6  2  kind, 1                          6  2  kind, 2
 *       8  4  sequence number                  8  4  sequence number that is answered
 *      12  2  buttons                         12  2  flags
 *      14  2  word of the last answer, or 0   14  2  word
 *      16  8  the device's time [us]          16  8  the device's time that is answered
 *      24 16  token, zeros behind             24  8  step of the engine
 *      40 24  position x y z [m]              32 24  force x y z [N]
 *      64 32  orientation w x y z             56 24  torque x y z about the tip [N m]
 *      96  8  opening 0..1                    80 24  position of the tool [m]
 *     104                                    104
 *
 * Little endian, IEEE doubles. Both have one size, so that nobody can use the engine to make a
 * small packet into a large one. Only bytes in, numbers out: no sockets, no state.
 */
#ifndef LAR_BASE_DEVICE_PACKET_H
#define LAR_BASE_DEVICE_PACKET_H

#include <stdbool.h>
#include <stddef.h>

#include "lariat.h"

enum { LAR_PACKET_BYTES = 104, LAR_PACKET_VERSION = 1, LAR_PACKET_TOKEN = 16 };

/* The upper half of flags is a word, which who hears sends back in the upper half of buttons. */
enum { LAR_PACKET_WORD = 16 };

enum {                      /* buttons */
       LAR_BUTTON_CLOSE = 1 /* takes hold, whatever the opening says */
};

enum { /* flags of an answer */
       LAR_ANSWER_PLAYING = 1,
       LAR_ANSWER_TOUCHING = 2,
       LAR_ANSWER_HOLDING = 4,
       LAR_ANSWER_FADING = 8 /* the force is not the whole one: after a silence, or paused */
};

typedef struct lar_position_packet {
    uint32_t sequence, buttons;
    uint64_t time; /* the device's own [us] */
    char token[LAR_PACKET_TOKEN];
    lar_tool_pose pose;
} lar_position_packet;

typedef struct lar_force_packet {
    uint32_t sequence, flags;
    uint64_t time; /* as it came */
    uint64_t step;
    double force[3], torque[3], position[3];
} lar_force_packet;

void lar_position_packet_encode(const lar_position_packet *packet,
                                unsigned char bytes[LAR_PACKET_BYTES]);
void lar_force_packet_encode(const lar_force_packet *packet, unsigned char bytes[LAR_PACKET_BYTES]);

/* False for what is no such packet: size, magic, version or kind differ, a number is not finite or
 * beyond 100 m, the orientation has not length 1 (within 1 %; it is brought to 1), the opening is
 * not 0..1. *packet is then undefined. */
bool lar_position_packet_decode(const void *bytes, size_t size, lar_position_packet *packet);
bool lar_force_packet_decode(const void *bytes, size_t size, lar_force_packet *packet);

#endif
