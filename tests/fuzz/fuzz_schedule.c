/* Fuzz target: the reader of schedule files, against a mesh of eight cubes in a row. Whatever it
 * takes must be safe to index by. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "divide/schedule/file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { ELEMENTS = 8, NODES = 4 * ELEMENTS + 4 };

static void require(bool good) {
    if (!good) __builtin_trap();
}

static void check_span(lar_range span, const int32_t *array, int32_t used, int32_t limit) {
    require(span.first >= 0 && span.count >= 0 && span.count <= used - span.first);
    for (int32_t i = 0; i < span.count; i++)
        require(array[span.first + i] >= 0 && array[span.first + i] < limit);
}

static void check_transfers(const lar_schedule *s, lar_range span, bool received) {
    require(span.first >= 0 && span.count >= 0 && span.count <= s->transfer_count - span.first);
    for (int32_t i = 0; i < span.count; i++) {
        const lar_transfer *t = &s->transfer[span.first + i];
        check_span(t->vectors, s->vector, s->vector_count, NODES);
        require(t->peer >= 0 && t->peer < s->grid.count && t->peer != s->processor);
        require(t->stage >= 0 && t->stage < LAR_STAGES);
        require(t->whole >= 0 && t->whole <= t->vectors.count);
        require(t->offset >= 0 && t->offset % LAR_PACKET_ALIGN == 0);
        int64_t bytes = lar_packet_payload(t->vectors.count) + LAR_TAIL_BYTES;
        require(!received || t->offset <= s->receive_bytes - bytes);
    }
}

static void check_schedule(const lar_schedule *s) {
    require(s->processor >= 0 && s->processor < s->grid.count);
    require(s->threads >= 1 && s->threads <= LAR_THREADS_MAX);
    require(s->thread_first[0] == 0 && s->thread_first[s->threads] == s->batch_count);
    for (int32_t t = 0; t < s->threads; t++) require(s->thread_first[t] <= s->thread_first[t + 1]);
    for (int32_t i = 0; i < s->batch_count; i++) {
        const lar_batch *b = &s->batch[i];
        check_span(b->elements, s->element, s->element_count, ELEMENTS);
        check_span(b->waits, s->wait, s->wait_count, s->batch_count);
        check_span(b->positions, s->node, s->node_count, NODES);
        check_transfers(s, b->receives, true);
        check_transfers(s, b->sends, false);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int32_t element[ELEMENTS][8];
    for (int e = 0; e < ELEMENTS; e++)
        for (int a = 0; a < 8; a++) element[e][a] = 4 * e + a;
    lar_mesh mesh = {.node_count = NODES, .element_count = ELEMENTS, .element = element};
    lar_bytes bytes = {malloc(size + 1), size};
    if (!bytes.data) return 0;
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    lar_schedule schedule = {0};
    lar_error error = {0};
    if (lar_schedule_parse("fuzz.schedule", &bytes, &mesh, &schedule, &error) == LAR_OK)
        check_schedule(&schedule);
    lar_schedule_clear(&schedule);
    lar_bytes_free(&bytes);
    return 0;
}
