/* Who holds a device's place on the network, and how much of the force it gets.
 *
 *     first good packet: its sender is the owner, until it has been silent for 1 s
 *
 *     force   1 -----------.                        .--------   the whole force
 *                           \                      /
 *             0 .            '--------------------'             none
 *               | packets  20 50 ms  silence       | 300 ms
 *                          of silence              packets again
 *
 * After a silence, and at the beginning, the hand is somewhere else than the tool: the pose is led
 * from where the tool is to where the hand is within the same 300 ms, so that nothing jumps.
 *
 * When the simulation jumps (a reset, a break, a state that is loaded) what was felt last fades
 * within the same 50 ms, while the hand comes back as after a silence.
 *
 * An engine that was held up for longer than 20 ms has been silent itself, and comes back likewise.
 *
 * Whatever comes of all that, what is told changes from packet to packet by no more than a rate
 * times the time between them: ticks may be shorter than the clock's, or come in bunches.
 *
 * Anybody can send under somebody else's address. Every answer carries a word that belongs to the
 * owner; who sends it back hears. Until then each packet is answered and nothing else is said.
 *
 * Time is CLOCK_MONOTONIC in ns, as a number that the caller gives: no clock, no socket, no memory
 * in here, so that a test and the fuzzer can play everything that a network does.
 */
#ifndef LAR_SESSION_DEVICE_LINK_H
#define LAR_SESSION_DEVICE_LINK_H

#include "base/device_packet.h"
#include "session/device/jitter_buffer.h"

typedef enum lar_link_verdict {
    LAR_LINK_TAKEN = 0, /* the newest */
    LAR_LINK_LATE,      /* a newer one has come before, or the same */
    LAR_LINK_REFUSED    /* no packet, a wrong token, somebody else's, a jump in the numbers */
} lar_link_verdict;

/* Where a packet comes from, as bytes that are the same for the same sender. */
typedef struct lar_link_address {
    unsigned char bytes[32];
} lar_link_address;

typedef struct lar_link {
    char token[LAR_PACKET_TOKEN]; /* zeros: none is asked for */
    bool owned;
    lar_link_address owner;
    uint64_t owners;                      /* so far */
    uint32_t word;                        /* in answers to the owner: 16 bits, never 0 */
    bool proved;                          /* the owner has sent it back: it hears */
    uint64_t dice;                        /* for words; start it from something unknown */
    uint64_t last_packet;                 /* of the owner [ns] */
    uint64_t last_time;                   /* of the last call of lar_link_advance [ns] */
    double last_gap;                      /* between the last two calls of lar_link_advance [ms] */
    bool silent;                          /* between a time-out and the next packet */
    double strength;                      /* 0..1: share of the force */
    double approach;                      /* 0..1: share of the way to the hand */
    double left;                          /* 0..1: share of what was felt before a jump */
    double left_force[3], left_torque[3]; /* [N] [N m] */
    double wanted[3], wanted_torque[3];   /* what the device should feel now */
    double force[3], torque[3];           /* what it was told last */
    double rate;                          /* of that, at most [N/s] */
    uint64_t told_at;                     /* [ns]; 0: never */
    lar_position_packet newest;
    lar_jitter_buffer evenly; /* the positions, by the device's own times */
    lar_tool_pose tool;       /* where the tool is; the caller's to keep */
    lar_tool_pose from;       /* where the approach began: where the tool was */
    lar_tool_pose pose;       /* what was given last */
    uint64_t received, refused, late, lost, timeouts;
} lar_link;

/* `token`: NULL or "": none. */
void lar_link_create(lar_link *link, const char *token, const lar_tool_pose *tool);

/* A packet has come. Good ones become link->newest. */
lar_link_verdict lar_link_take(lar_link *link, const lar_link_address *from, const void *bytes,
                               size_t size, uint64_t now);

/* Once in a tick, after its packets: moves strength, approach and pose on to `now`. While `paused`
 * the force fades as in a silence. True when the pose is the hand's (false: nobody is there, and
 * it stays where it was). */
bool lar_link_advance(lar_link *link, bool paused, uint64_t now);

/* After it was true: where the hand was a little before `due`, a time that goes evenly [ns]; led to
 * in the same way. */
void lar_link_evenly(lar_link *link, int64_t due, lar_tool_pose *pose);

/* What the device should get of this force and torque now. `held_back`: the shares of the ones
 * before that nobody has paid for, and that they lose at once. */
void lar_link_feel(lar_link *link, const double force[3], const double torque[3],
                   const double held_back[2]);

/* A packet leaves: what it says, link->force and ->torque, as near to that as the rate allows. */
void lar_link_tell(lar_link *link, uint64_t now);

/* The simulation has jumped. */
void lar_link_jump(lar_link *link);

#endif
