/* Packets: every send has its receive, every place in a buffer one packet, every pair of
 * processors both directions. */
#include <stdio.h>
#include <stdlib.h>

#include "divide/proof/proof.h"

/* ---- both ends of a packet --------------------------------------------------------------- */

/* What names a packet comes first, so that ends and packets compare alike. */
typedef struct packet_end {
    int32_t from, to, stage;
    int32_t transfer, batch;
} packet_end;

static int compare_ends(const void *a, const void *b) {
    const packet_end *x = a, *y = b;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    if (x->to != y->to) return x->to < y->to ? -1 : 1;
    return (x->stage > y->stage) - (x->stage < y->stage);
}

static const char *where(const lar_proof *proof, const packet_end *end, bool sends,
                         char text[LAR_PLACE_TEXT]) {
    return lar_proof_place(&proof->set->of[sends ? end->from : end->to], end->batch, text);
}

/* All sends, or all receives, ordered by what names a packet; none twice. */
static lar_status collect(const lar_proof *proof, bool sends, packet_end *end, int32_t *count,
                          lar_error *error) {
    int32_t n = 0;
    for (int32_t p = 0; p < proof->set->count; p++) {
        const lar_schedule *s = &proof->set->of[p];
        for (int32_t b = 0; b < s->batch_count; b++) {
            int32_t first = sends ? s->batch[b].sends.first : s->batch[b].receives.first;
            int32_t many = sends ? s->batch[b].sends.count : s->batch[b].receives.count;
            for (int32_t i = first; i < first + many; i++) {
                const lar_transfer *t = &s->transfer[i];
                end[n++] = (packet_end){sends ? p : t->peer, sends ? t->peer : p, t->stage, i, b};
            }
        }
    }
    *count = n;
    qsort(end, (size_t)n, sizeof *end, compare_ends);
    for (int32_t i = 1; i < n; i++)
        if (compare_ends(&end[i - 1], &end[i]) == 0) {
            char one[LAR_PLACE_TEXT], two[LAR_PLACE_TEXT];
            return LAR_DISPROVE(error,
                                "the packet from processor %d to processor %d, stage %d, is %s "
                                "twice: by %s and by %s",
                                end[i].from, end[i].to, end[i].stage, sends ? "sent" : "received",
                                where(proof, &end[i - 1], sends, one),
                                where(proof, &end[i], sends, two));
        }
    return LAR_OK;
}

static lar_status compare_contents(const lar_proof *proof, const lar_proof_packet *packet,
                                   lar_error *error) {
    const lar_schedule *from = &proof->set->of[packet->from], *to = &proof->set->of[packet->to];
    const lar_transfer *send = &from->transfer[packet->send];
    const lar_transfer *receive = &to->transfer[packet->receive];
    char one[LAR_PLACE_TEXT], two[LAR_PLACE_TEXT], what[256];
    lar_proof_place(from, packet->send_batch, one);
    lar_proof_place(to, packet->receive_batch, two);
    snprintf(what, sizeof what, "stage %d: %s sends what %s receives", packet->stage, one, two);
    if (send->offset != receive->offset)
        return LAR_DISPROVE(error, "%s, but to offset %lld instead of %lld", what,
                            (long long)send->offset, (long long)receive->offset);
    if (send->vectors.count != receive->vectors.count)
        return LAR_DISPROVE(error, "%s, but with %d vectors instead of %d", what,
                            send->vectors.count, receive->vectors.count);
    for (int32_t i = 0; i < send->vectors.count; i++) {
        int32_t k = from->vector[send->vectors.first + i];
        int32_t l = to->vector[receive->vectors.first + i];
        if (k != l)
            return LAR_DISPROVE(error, "%s, but vector %d is node %d there and node %d here", what,
                                i, k, l);
    }
    if (send->whole != receive->whole) {
        int32_t max = send->whole > receive->whole ? send->whole : receive->whole;
        int32_t k = from->vector[send->vectors.first + send->vectors.count - max];
        return LAR_DISPROVE(error,
                            "%s, but with %d whole forces instead of %d: node %d is whole on one "
                            "side and a part on the other",
                            what, send->whole, receive->whole, k);
    }
    return LAR_OK;
}

static lar_status alone(const lar_proof *proof, const packet_end *end, bool sends,
                        lar_error *error) {
    char at[LAR_PLACE_TEXT];
    where(proof, end, sends, at);
    if (sends)
        return LAR_DISPROVE(error,
                            "%s sends a packet of stage %d to processor %d, which does not "
                            "receive it",
                            at, end->stage, end->to);
    return LAR_DISPROVE(error,
                        "%s waits for a packet of stage %d from processor %d, which does not send "
                        "it",
                        at, end->stage, end->from);
}

static lar_status pair_ends(lar_proof *proof, const packet_end *send, int32_t sends,
                            const packet_end *receive, int32_t receives, lar_error *error) {
    for (int32_t i = 0, j = 0; i < sends || j < receives; i++, j++) {
        int order = i >= sends ? 1 : j >= receives ? -1 : compare_ends(&send[i], &receive[j]);
        if (order < 0) return alone(proof, &send[i], true, error);
        if (order > 0) return alone(proof, &receive[j], false, error);
        lar_proof_packet *packet = &proof->packet[proof->packet_count++];
        *packet = (lar_proof_packet){send[i].from,     send[i].to,          send[i].stage,
                                     send[i].transfer, receive[j].transfer, send[i].batch,
                                     receive[j].batch};
        lar_status status = compare_contents(proof, packet, error);
        if (status) return status;
    }
    return LAR_OK;
}

/* ---- places in the receiver's buffer ----------------------------------------------------- */

typedef struct place {
    int32_t to, from, stage;
    int64_t begin, end;
} place;

static int compare_places(const void *a, const void *b) {
    const place *x = a, *y = b;
    if (x->to != y->to) return x->to < y->to ? -1 : 1;
    return (x->begin > y->begin) - (x->begin < y->begin);
}

static lar_status check_places(const lar_proof *proof, place *at, lar_error *error) {
    for (int32_t i = 0; i < proof->packet_count; i++) {
        const lar_proof_packet *packet = &proof->packet[i];
        const lar_schedule *to = &proof->set->of[packet->to];
        const lar_transfer *t = &to->transfer[packet->receive];
        int64_t size = lar_packet_payload(t->vectors.count) + LAR_TAIL_BYTES;
        if (t->offset < 0 || t->offset % LAR_PACKET_ALIGN || size > to->receive_bytes ||
            t->offset > to->receive_bytes - size)
            return LAR_DISPROVE(error,
                                "the packet from processor %d to processor %d, stage %d, has %lld "
                                "bytes at offset %lld of a receive buffer of %lld bytes; it must "
                                "be inside, at a multiple of %d",
                                packet->from, packet->to, packet->stage, (long long)size,
                                (long long)t->offset, (long long)to->receive_bytes,
                                LAR_PACKET_ALIGN);
        at[i] = (place){packet->to, packet->from, packet->stage, t->offset, t->offset + size};
    }
    qsort(at, (size_t)proof->packet_count, sizeof *at, compare_places);
    for (int32_t i = 1; i < proof->packet_count; i++)
        if (at[i].to == at[i - 1].to && at[i].begin < at[i - 1].end)
            return LAR_DISPROVE(
                error,
                "in the receive buffer of processor %d the packets from processor %d, stage %d, "
                "and from processor %d, stage %d, overlap at offset %lld",
                at[i].to, at[i - 1].from, at[i - 1].stage, at[i].from, at[i].stage,
                (long long)at[i].begin);
    for (int32_t p = 0; p < proof->set->count; p++) {
        int64_t bytes = proof->set->of[p].receive_bytes;
        if (bytes < 0 || bytes % LAR_PACKET_ALIGN)
            return LAR_DISPROVE(error,
                                "processor %d: half a receive buffer of %lld bytes; it must be a "
                                "multiple of %d",
                                p, (long long)bytes, LAR_PACKET_ALIGN);
    }
    return LAR_OK;
}

/* ---- both directions --------------------------------------------------------------------- */

static int compare_pairs(const void *a, const void *b) {
    const lar_proof_packet *x = a, *y = b;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    return (x->to > y->to) - (x->to < y->to);
}

/* A half of the buffer is used again two steps later. By then its reader is done with it: the
 * sender has heard of it in the step between. */
static lar_status check_parity(const lar_proof *proof, lar_error *error) {
    for (int32_t i = 0; i < proof->packet_count; i++) {
        const lar_proof_packet *packet = &proof->packet[i];
        const lar_proof_packet back = {.from = packet->to, .to = packet->from};
        if (!bsearch(&back, proof->packet, (size_t)proof->packet_count, sizeof back, compare_pairs))
            return LAR_DISPROVE(error,
                                "processor %d sends to processor %d, but nothing flows back: "
                                "without an empty packet from processor %d, buffers that alternate "
                                "could be overwritten before they are read",
                                packet->from, packet->to, packet->to);
    }
    return LAR_OK;
}

lar_status lar_proof_packets(lar_proof *proof, lar_error *error) {
    int64_t transfers = 0;
    for (int32_t p = 0; p < proof->set->count; p++) transfers += proof->set->of[p].transfer_count;
    size_t room = (size_t)transfers;
    packet_end *send = lar_calloc(room, sizeof *send), *receive = lar_calloc(room, sizeof *receive);
    place *at = lar_calloc(room, sizeof *at);
    proof->packet = lar_calloc(room, sizeof *proof->packet);
    lar_status status = LAR_OK;
    int32_t sends = 0, receives = 0;
    if (!send || !receive || !at || !proof->packet || transfers > INT32_MAX)
        status = lar_fail_memory(error, room * 4 * sizeof *at, "packets");
    if (!status) status = collect(proof, true, send, &sends, error);
    if (!status) status = collect(proof, false, receive, &receives, error);
    if (!status) status = pair_ends(proof, send, sends, receive, receives, error);
    if (!status) status = check_places(proof, at, error);
    if (!status) status = check_parity(proof, error);
    free(send);
    free(receive);
    free(at);
    return status;
}
