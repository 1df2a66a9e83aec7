#include "parallel/control.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* What stands before the tail of an order's region. */
typedef struct order_head {
    lar_order order;
    uint64_t bytes; /* of this part */
    uint64_t left;  /* that come after it */
} order_head;

_Static_assert(sizeof(order_head) % 8 == 0 && sizeof(lar_answer) % 8 == 0, "heads are words");
_Static_assert(LAR_PART_BYTES % 8 == 0, "parts are words");

/* Regions are whole cache lines. */
static size_t region(size_t head) {
    return (lar_comm_packet_bytes(LAR_PART_BYTES + head) + 63) & ~(size_t)63;
}

size_t lar_control_bytes(int32_t processors, int32_t p) {
    if (processors == 1) return 0;
    return p == 0 ? (size_t)(processors - 1) * region(sizeof(lar_answer))
                  : region(sizeof(order_head));
}

/* Where the heads of processor p's answers arrive at zero, and those of orders at the others. */
static size_t answer_head(int32_t p) {
    return (size_t)(p - 1) * region(sizeof(lar_answer)) + LAR_PART_BYTES;
}

enum { ORDER_HEAD = LAR_PART_BYTES };

lar_status lar_control_create(lar_comm *comm, lar_control **control, lar_error *error) {
    size_t max = LAR_PART_BYTES + sizeof(lar_answer) + sizeof(order_head);
    lar_control *made = lar_calloc(1, sizeof *made);
    if (made) made->packet = lar_calloc_aligned(max, 1);
    if (!made || !made->packet) {
        lar_control_destroy(made);
        return lar_fail_memory(error, max, "the control of processors");
    }
    made->comm = comm;
    *control = made;
    return LAR_OK;
}

void lar_control_destroy(lar_control *control) {
    if (!control) return;
    free(control->packet);
    free(control->whole);
    free(control);
}

/* Payload and head as one packet whose head comes to stand at `place`. Returns where it begins. */
static size_t put_together(lar_control *control, size_t place, const void *payload, size_t bytes,
                           const void *head, size_t head_bytes) {
    assert(bytes <= LAR_PART_BYTES);
    size_t padded = lar_comm_padded(bytes);
    if (bytes) memcpy(control->packet, payload, bytes);
    memset(control->packet + bytes, 0, padded - bytes);
    memcpy(control->packet + padded, head, head_bytes);
    return place - padded;
}

/* ---- processor zero ------------------------------------------------------------------------ */

static lar_status order_part(lar_control *control, const order_head *head, const void *payload,
                             lar_error *error) {
    lar_status status = LAR_OK;
    size_t bytes = (size_t)head->bytes;
    size_t begin = put_together(control, ORDER_HEAD, payload, bytes, head, sizeof *head);
    control->count++;
    for (int32_t p = 1; p < lar_comm_count(control->comm) && !status; p++)
        status = lar_comm_put(control->comm, p, begin, control->packet,
                              lar_comm_padded(bytes) + sizeof *head, control->count, error);
    return status;
}

lar_status lar_control_order(lar_control *control, const lar_order *order, const void *payload,
                             size_t bytes, lar_error *error) {
    order_head head = {.order = *order, .left = bytes};
    const unsigned char *at = payload;
    for (;;) {
        head.bytes = head.left < LAR_PART_BYTES ? head.left : LAR_PART_BYTES;
        head.left -= head.bytes;
        lar_status status = order_part(control, &head, at, error);
        for (int32_t p = 1; head.left && p < lar_comm_count(control->comm) && !status; p++) {
            const lar_answer *answer;
            status = lar_control_hear(control, p, &answer, NULL, error);
        }
        if (status || !head.left) return status;
        at += head.bytes;
    }
}

static lar_status refuse_size(int32_t p, uint64_t bytes, lar_error *error) {
    return lar_fail(error, LAR_ERROR_PEER,
                    "processor %d sends a message of %llu bytes, which is none of this program's; "
                    "start all processors again, from the same installation",
                    (int)p, (unsigned long long)bytes);
}

lar_status lar_control_hear(lar_control *control, int32_t p, const lar_answer **answer,
                            const void **payload, lar_error *error) {
    const void *head;
    lar_status status = lar_comm_await(control->comm, p, answer_head(p), sizeof **answer,
                                       control->count, &head, error);
    if (status) return status;
    *answer = head;
    if ((*answer)->bytes > LAR_PART_BYTES) return refuse_size(p, (*answer)->bytes, error);
    if (payload) *payload = (const char *)head - lar_comm_padded((size_t)(*answer)->bytes);
    return LAR_OK;
}

/* ---- the others ---------------------------------------------------------------------------- */

static lar_status await_part(lar_control *control, order_head *head, const void **payload,
                             lar_error *error) {
    const void *there;
    lar_status status = lar_comm_await(control->comm, 0, ORDER_HEAD, sizeof *head,
                                       control->count + 1, &there, error);
    if (status) return status;
    control->count++;
    memcpy(head, there, sizeof *head);
    if (head->bytes > LAR_PART_BYTES) return refuse_size(0, head->bytes, error);
    *payload = (const char *)there - lar_comm_padded((size_t)head->bytes);
    return LAR_OK;
}

lar_status lar_control_await(lar_control *control, lar_order *order, const void **payload,
                             size_t *bytes, lar_error *error) {
    order_head head;
    lar_status status = await_part(control, &head, payload, error);
    if (status) return status;
    *order = head.order;
    *bytes = (size_t)(head.bytes + head.left);
    if (!head.left) return LAR_OK;
    free(control->whole);
    control->whole = lar_calloc_aligned(*bytes, 1);
    if (!control->whole) return lar_fail_memory(error, *bytes, "an order of processor 0");
    for (size_t at = 0;;) {
        if (head.bytes > *bytes - at) return refuse_size(0, head.bytes, error);
        memcpy(control->whole + at, *payload, (size_t)head.bytes);
        at += (size_t)head.bytes;
        if (!head.left) break;
        const lar_answer more = {0};
        status = lar_control_answer(control, &more, NULL, 0, error);
        if (!status) status = await_part(control, &head, payload, error);
        if (status) return status;
    }
    *payload = control->whole;
    return LAR_OK;
}

lar_status lar_control_answer(lar_control *control, const lar_answer *answer, const void *payload,
                              size_t bytes, lar_error *error) {
    lar_answer head = *answer;
    head.bytes = bytes;
    size_t place = answer_head(lar_comm_self(control->comm));
    size_t begin = put_together(control, place, payload, bytes, &head, sizeof head);
    return lar_comm_put(control->comm, 0, begin, control->packet,
                        lar_comm_padded(bytes) + sizeof head, control->count, error);
}
