#include "session/history.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

lar_status lar_history_create(int32_t tools, lar_history *history, lar_error *error) {
    size_t values = 3 * (size_t)LAR_HISTORY_RING * (size_t)tools;
    *history = (lar_history){.tools = tools, .value = lar_calloc(values, sizeof *history->value)};
    if (history->value) return LAR_OK;
    return lar_fail_memory(error, values * sizeof *history->value, "the forces of past ticks");
}

void lar_history_destroy(lar_history *history) {
    free(history->value);
    *history = (lar_history){0};
}

static uint32_t *slot_of(const lar_history *history, uint64_t tick, int32_t tool) {
    uint64_t row = tick % LAR_HISTORY_RING * (uint64_t)history->tools + (uint64_t)tool;
    return history->value + 3 * row;
}

/* Whoever sees a value of this tick sees that it was begun: values are released after `begun`. */
void lar_history_begin(lar_history *history) {
    __atomic_store_n(&history->begun, history->begun + 1, __ATOMIC_RELAXED);
}

void lar_history_put(lar_history *history, int32_t tool, const double force[3]) {
    uint32_t *slot = slot_of(history, history->begun, tool);
    for (int i = 0; i < 3; i++) {
        float value = (float)force[i];
        uint32_t bits;
        memcpy(&bits, &value, sizeof bits);
        __atomic_store_n(slot + i, bits, __ATOMIC_RELEASE);
    }
}

void lar_history_end(lar_history *history) {
    __atomic_store_n(&history->written, history->begun, __ATOMIC_RELEASE);
}

/* Drops those at the front that were written over meanwhile. */
static int32_t drop_damaged(const lar_history *history, uint64_t first, int32_t count,
                            float (*force)[3]) {
    uint64_t begun = __atomic_load_n(&history->begun, __ATOMIC_ACQUIRE);
    if (begun < first + LAR_HISTORY_RING) return count;
    uint64_t bad = begun - LAR_HISTORY_RING - first + 1;
    if (bad >= (uint64_t)count) return 0;
    memmove(force, force + bad, ((size_t)count - bad) * sizeof *force);
    return count - (int32_t)bad;
}

int32_t lar_history_copy(const lar_history *history, int32_t tool, uint64_t after, int32_t max,
                         float (*force)[3], uint64_t *last) {
    uint64_t written = __atomic_load_n(&history->written, __ATOMIC_ACQUIRE);
    uint64_t first = after + 1;
    if (written > LAR_HISTORY_TICKS && first <= written - LAR_HISTORY_TICKS)
        first = written - LAR_HISTORY_TICKS + 1;
    *last = after;
    if (after >= written || max <= 0) return 0;
    uint64_t available = written - first + 1;
    int32_t count = available < (uint64_t)max ? (int32_t)available : max;
    for (int32_t k = 0; k < count; k++) {
        const uint32_t *slot = slot_of(history, first + (uint64_t)k, tool);
        for (int i = 0; i < 3; i++) {
            uint32_t bits = __atomic_load_n(slot + i, __ATOMIC_ACQUIRE);
            memcpy(&force[k][i], &bits, sizeof bits);
        }
    }
    uint64_t end = first + (uint64_t)count - 1;
    count = drop_damaged(history, first, count, force);
    if (count > 0) *last = end;
    return count;
}
