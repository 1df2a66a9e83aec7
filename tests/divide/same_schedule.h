/* Whether two schedules say the same, part by part: their arrays may be arranged differently. */
#ifndef LAR_TESTS_SAME_SCHEDULE_H
#define LAR_TESTS_SAME_SCHEDULE_H

#include "divide/schedule/schedule.h"
#include "testing.h"

static inline void assert_same_numbers(const int32_t *a, lar_range of_a, const int32_t *b,
                                       lar_range of_b) {
    assert_int_equal(of_a.count, of_b.count);
    if (of_a.count > 0)
        assert_memory_equal(a + of_a.first, b + of_b.first, (size_t)of_a.count * sizeof *a);
}

static inline void assert_same_transfers(const lar_schedule *a, lar_range of_a,
                                         const lar_schedule *b, lar_range of_b) {
    assert_int_equal(of_a.count, of_b.count);
    for (int32_t i = 0; i < of_a.count; i++) {
        const lar_transfer *t = &a->transfer[of_a.first + i], *u = &b->transfer[of_b.first + i];
        assert_int_equal(t->peer, u->peer);
        assert_int_equal(t->stage, u->stage);
        assert_int_equal(t->whole, u->whole);
        assert_int_equal(t->offset, u->offset);
        assert_same_numbers(a->vector, t->vectors, b->vector, u->vectors);
    }
}

static inline void assert_same_schedule(const lar_schedule *a, const lar_schedule *b) {
    assert_memory_equal(&a->grid, &b->grid, sizeof a->grid);
    assert_int_equal(a->processor, b->processor);
    assert_int_equal(a->threads, b->threads);
    assert_int_equal(a->scheme, b->scheme);
    assert_int_equal(a->channels, b->channels);
    assert_true(a->mesh == b->mesh);
    assert_true(a->division == b->division);
    assert_int_equal(a->receive_bytes, b->receive_bytes);
    assert_int_equal(a->batch_count, b->batch_count);
    assert_memory_equal(a->thread_first, b->thread_first,
                        (size_t)(a->threads + 1) * sizeof *a->thread_first);
    assert_int_equal(a->element_count, b->element_count);
    assert_int_equal(a->wait_count, b->wait_count);
    assert_int_equal(a->transfer_count, b->transfer_count);
    assert_int_equal(a->node_count, b->node_count);
    assert_int_equal(a->vector_count, b->vector_count);
    for (int32_t i = 0; i < a->batch_count; i++) {
        const lar_batch *p = &a->batch[i], *q = &b->batch[i];
        assert_same_numbers(a->element, p->elements, b->element, q->elements);
        assert_same_numbers(a->wait, p->waits, b->wait, q->waits);
        assert_same_transfers(a, p->receives, b, q->receives);
        assert_same_numbers(a->node, p->positions, b->node, q->positions);
        assert_same_transfers(a, p->sends, b, q->sends);
    }
}

#endif
