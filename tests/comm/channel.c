#include "comm/channel.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* ---- global packets ----------------------------------------------------------------------- */

lar_status lar_packet_start(lar_packet *packet, lar_comm *comm, int32_t peer, size_t offset,
                            size_t most, uint64_t step, void *gather, lar_error *error) {
    unsigned char *room = lar_comm_room(comm, peer, offset, most, step);
    if (!room && !gather && most > 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a packet to processor %d needs memory to be gathered in", (int)peer);
    *packet = (lar_packet){comm, peer, offset, 0, most, step, room ? room : gather};
    return LAR_OK;
}

lar_status lar_packet_queue(lar_packet *packet, const void *data, size_t bytes, lar_error *error) {
    if (bytes > packet->most - packet->filled)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a packet to processor %d has %zu bytes and should take %zu more; start it "
                        "with its full size",
                        (int)packet->peer, packet->most, bytes);
    if (bytes) memcpy(packet->bytes + packet->filled, data, bytes);
    packet->filled += bytes;
    return LAR_OK;
}

lar_status lar_packet_send(lar_packet *packet, lar_error *error) {
    if (packet->filled != packet->most)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a packet to processor %d is sent with %zu of its %zu bytes; queue all of "
                        "them, its size may not change",
                        (int)packet->peer, packet->filled, packet->most);
    return lar_comm_put(packet->comm, packet->peer, packet->offset, packet->bytes, packet->filled,
                        packet->step, error);
}

lar_status lar_packet_receive(lar_comm *comm, int32_t sender, size_t offset, size_t bytes,
                              uint64_t step, const void **payload, lar_error *error) {
    return lar_comm_wait(comm, sender, offset, bytes, step, payload, error);
}

/* ---- local channels ------------------------------------------------------------------------ */

lar_status lar_channel_create(lar_channel *channel, lar_comm *comm, const lar_channel_plan *plan,
                              lar_error *error) {
    if (plan->peer < 0 || plan->peer >= lar_comm_count(comm))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a channel to processor %d; there are processors 0 to %d", (int)plan->peer,
                        (int)lar_comm_count(comm) - 1);
    unsigned char *gather = lar_calloc_aligned(plan->send_bytes + 64, 1);
    if (!gather) return lar_fail_memory(error, plan->send_bytes, "a local channel");
    *channel = (lar_channel){.comm = comm, .plan = *plan, .gather = gather};
    return LAR_OK;
}

void lar_channel_destroy(lar_channel *channel) {
    if (!channel) return;
    free(channel->gather);
    memset(channel, 0, sizeof *channel);
}

lar_status lar_channel_reset(lar_channel *channel, uint64_t step, lar_error *error) {
    if (step != channel->step + 1)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the channel to processor %d is reset for step %llu after step %llu; reset "
                        "it once in every step",
                        (int)channel->plan.peer, (unsigned long long)step,
                        (unsigned long long)channel->step);
    channel->step = step;
    channel->sent = channel->received = channel->filled = 0;
    /* Nothing can stand in the halves of the first two steps yet. */
    channel->heard = channel->plan.receive_bytes > 0 || step <= 2;
    if (channel->plan.send_bytes > 0) return LAR_OK;
    return lar_comm_put(channel->comm, channel->plan.peer, channel->plan.send_offset, NULL, 0, step,
                        error);
}

/* Before the half of two steps ago is written again: the peer must have begun the step before this
 * one, so that it is done with that half. Where data comes back, receiving it has shown that. */
static lar_status half_is_free(lar_channel *channel, lar_error *error) {
    if (channel->heard) return LAR_OK;
    channel->heard = true;
    return lar_comm_wait(channel->comm, channel->plan.peer, channel->plan.receive_offset, 0,
                         channel->step - 1, NULL, error);
}

static lar_status begin_packet(lar_channel *channel, lar_error *error) {
    const lar_channel_plan *plan = &channel->plan;
    lar_status status = half_is_free(channel, error);
    if (status) return status;
    channel->at = lar_comm_room(channel->comm, plan->peer, plan->send_offset + channel->sent, 0,
                                channel->step);
    if (!channel->at) channel->at = channel->gather;
    return LAR_OK;
}

lar_status lar_channel_queue(lar_channel *channel, const void *data, size_t bytes,
                             lar_error *error) {
    const lar_channel_plan *plan = &channel->plan;
    if (channel->step == 0 || channel->sent > plan->send_bytes ||
        bytes > plan->send_bytes - channel->sent ||
        channel->filled > plan->send_bytes - channel->sent - bytes)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the channel to processor %d has a region of %zu bytes in a step, too few "
                        "for %zu more; plan it larger, and reset it before the first step",
                        (int)plan->peer, plan->send_bytes, bytes);
    if (channel->filled == 0) {
        lar_status status = begin_packet(channel, error);
        if (status) return status;
    }
    if (bytes) memcpy(channel->at + channel->filled, data, bytes);
    channel->filled += bytes;
    return LAR_OK;
}

lar_status lar_channel_send(lar_channel *channel, lar_error *error) {
    const lar_channel_plan *plan = &channel->plan;
    size_t packet = lar_comm_packet_bytes(channel->filled);
    if (channel->step == 0 || packet > plan->send_bytes - channel->sent)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the channel to processor %d has %zu bytes left in its region, a packet "
                        "with its tail takes %zu; plan it larger",
                        (int)plan->peer, plan->send_bytes - channel->sent, packet);
    /* An empty packet has not been begun. */
    lar_status status = channel->filled ? LAR_OK : half_is_free(channel, error);
    if (!status)
        status = lar_comm_put(channel->comm, plan->peer, plan->send_offset + channel->sent,
                              channel->at, channel->filled, channel->step, error);
    if (status) return status;
    channel->sent += packet;
    channel->filled = 0;
    return LAR_OK;
}

lar_status lar_channel_receive(lar_channel *channel, size_t bytes, const void **payload,
                               lar_error *error) {
    const lar_channel_plan *plan = &channel->plan;
    size_t packet = lar_comm_packet_bytes(bytes);
    if (bytes > plan->receive_bytes || packet > plan->receive_bytes - channel->received)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the channel from processor %d has %zu bytes left in its region, a packet "
                        "with its tail takes %zu; plan it larger",
                        (int)plan->peer, plan->receive_bytes - channel->received, packet);
    lar_status status =
        lar_comm_wait(channel->comm, plan->peer, plan->receive_offset + channel->received, bytes,
                      channel->step, payload, error);
    if (!status) channel->received += packet;
    return status;
}
