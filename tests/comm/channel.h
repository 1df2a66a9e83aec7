/* The thesis's two interfaces (T 6.3), on put and tail.
 *
 *     local channel                            global packet
 *       lar_channel_reset(step)                  lar_packet_start(peer, offset, step)
 *       lar_channel_queue(data) ...              lar_packet_queue(data) ...
 *       lar_channel_send()                       lar_packet_send()
 *       lar_channel_receive()                    lar_packet_receive(sender, offset, step)
 *
 * A LOCAL CHANNEL joins two neighbours of the grid. Packets of a step follow each other in a region
 * of the receiver's buffer, so that the order alone identifies them:
 *
 *     region at the receiver:   | packet 0 |tail| packet 1 |tail| ...
 *
 * The sequence of sizes must be the same in every step. A GLOBAL PACKET goes to any processor, to
 * an offset that the schedule gives it. In both, data is gathered where it leaves from: in the
 * peer's memory where that can be written, otherwise in the sender's region (T 6.3.1: queueing and
 * copying to the network are one).
 *
 * The thesis's reset is a packet; here both sides know when a step begins, and it costs nothing.
 * Where one direction of a channel carries no data (send_bytes 0), reset sends an empty packet in
 * it, and the other side, before it writes a half again, makes sure that it came (comm.h, no
 * acknowledgement). Global packets leave that to the schedule: an empty packet is one that is
 * started and sent.
 *
 * A channel belongs to one thread at a time.
 */
#ifndef LAR_COMM_CHANNEL_H
#define LAR_COMM_CHANNEL_H

#include "comm/comm.h"

/* A packet being gathered. */
typedef struct lar_packet {
    lar_comm *comm;
    int32_t peer;
    size_t offset; /* in the peer's half */
    size_t filled, most;
    uint64_t step;
    unsigned char *bytes;
} lar_packet;

/* Begins a packet of at most `most` bytes. `gather` (at least `most` bytes) is used where the
 * peer's memory cannot be written; it may serve the next packet after lar_packet_send. */
lar_status lar_packet_start(lar_packet *packet, lar_comm *comm, int32_t peer, size_t offset,
                            size_t most, uint64_t step, void *gather, lar_error *error);
lar_status lar_packet_queue(lar_packet *packet, const void *data, size_t bytes, lar_error *error);
/* The packet must be filled: its size is part of the layout. */
lar_status lar_packet_send(lar_packet *packet, lar_error *error);
/* Waits for a packet of `bytes` bytes at `offset` of the own buffer; as lar_comm_wait. */
lar_status lar_packet_receive(lar_comm *comm, int32_t sender, size_t offset, size_t bytes,
                              uint64_t step, const void **payload, lar_error *error);

typedef struct lar_channel_plan {
    int32_t peer;
    size_t send_offset;    /* of the region in the peer's half */
    size_t send_bytes;     /* of that region, tails included; 0: nothing is sent */
    size_t receive_offset; /* of the region in the own half */
    size_t receive_bytes;  /* of that region, tails included; 0: nothing comes */
} lar_channel_plan;

/* A direction without data still takes lar_comm_packet_bytes(0) bytes at its offset. */
typedef struct lar_channel {
    lar_comm *comm;
    lar_channel_plan plan;
    uint64_t step;         /* of the last reset */
    bool heard;            /* the peer's empty packet of the step before has been seen */
    size_t sent, received; /* bytes of the regions that are used up in this step */
    size_t filled;         /* of the packet being gathered */
    unsigned char *at;     /* where it is gathered */
    unsigned char *gather; /* [send_bytes], owned; where the peer's memory cannot be written */
} lar_channel;

/* Takes memory for gathering; destroy frees it and accepts a zeroed channel. */
lar_status lar_channel_create(lar_channel *channel, lar_comm *comm, const lar_channel_plan *plan,
                              lar_error *error);
void lar_channel_destroy(lar_channel *channel);

/* Begins a step: 1, 2, 3, ... for every channel, whether it has data or not. */
lar_status lar_channel_reset(lar_channel *channel, uint64_t step, lar_error *error);
lar_status lar_channel_queue(lar_channel *channel, const void *data, size_t bytes,
                             lar_error *error);
lar_status lar_channel_send(lar_channel *channel, lar_error *error);
/* The next packet of the step. */
lar_status lar_channel_receive(lar_channel *channel, size_t bytes, const void **payload,
                               lar_error *error);

#endif
