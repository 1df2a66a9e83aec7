/* Which thread takes which unit, and in which order (T 6.7). */
#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "divide/schedule_plan.h"

lar_status lar_plan_units(lar_plan *plan, lar_packet **packet, int32_t count, lar_error *error) {
    for (int32_t i = 0; i < count; i++) {
        int32_t batch = lar_plan_add_batch(plan, 0);
        if (batch == LAR_NOWHERE) return lar_fail_memory(error, sizeof *plan->batch, "batches");
        packet[i]->sent_in = batch;
        plan->batch[batch].elements += lar_plan_claim(plan, packet[i], batch, NULL);
    }
    return LAR_OK;
}
