#include "engine/control.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Regions are whole cache lines. */
static size_t region(size_t bytes) {
    return (lar_comm_packet_bytes(bytes) + 63) & ~(size_t)63;
}

size_t lar_control_bytes(int32_t processors, int32_t p) {
    if (processors == 1) return 0;
    return p == 0 ? (size_t)(processors - 1) * region(sizeof(lar_answer))
                  : region(sizeof(lar_order));
}

/* Where processor p's answers arrive at zero. */
static size_t answer_offset(int32_t p) {
    return (size_t)(p - 1) * region(sizeof(lar_answer));
}

lar_status lar_control_create(lar_comm *comm, lar_control **control, lar_error *error) {
    lar_control *made = lar_calloc(1, sizeof *made);
    if (made) made->answer = lar_calloc_aligned(1, sizeof *made->answer);
    if (!made || !made->answer) {
        lar_control_destroy(made);
        return lar_fail_memory(error, sizeof *made->answer, "the control of processors");
    }
    made->comm = comm;
    *control = made;
    return LAR_OK;
}

void lar_control_destroy(lar_control *control) {
    if (!control) return;
    free(control->answer);
    free(control);
}

lar_status lar_control_order(lar_control *control, const lar_order *order, lar_error *error) {
    lar_status status = LAR_OK;
    control->count++;
    for (int32_t p = 1; p < lar_comm_count(control->comm) && !status; p++)
        status = lar_comm_put(control->comm, p, 0, order, sizeof *order, control->count, error);
    return status;
}

lar_status lar_control_hear(lar_control *control, int32_t p, const lar_answer **answer,
                            lar_error *error) {
    const void *payload;
    lar_status status = lar_comm_await(control->comm, p, answer_offset(p), sizeof **answer,
                                       control->count, &payload, error);
    if (!status) *answer = payload;
    return status;
}

lar_status lar_control_obey(lar_control *control, lar_order *order, lar_error *error) {
    const void *payload;
    lar_status status =
        lar_comm_await(control->comm, 0, 0, sizeof *order, control->count + 1, &payload, error);
    if (status) return status;
    control->count++;
    memcpy(order, payload, sizeof *order);
    return LAR_OK;
}

lar_status lar_control_answer(lar_control *control, lar_error *error) {
    return lar_comm_put(control->comm, 0, answer_offset(lar_comm_self(control->comm)),
                        control->answer, sizeof *control->answer, control->count, error);
}
