/* The proof sees every damage, and says where: plain schedules, damaged one way at a time. */
#include "divide/proof/schedule_proof.h"

#include "plain_schedule.h"
#include "step_player.h"

/* ---- schedules to damage ----------------------------------------------------------------- */

/* Four processors in a square, 8 elements each; processor 0 exchanges along x with 1, along y with
 * 2. Batches of thread 0: 0 to 8, of thread 1: 9 to 17. */
typedef struct patient {
    divided d;
    lar_schedule_set set;
} patient;

static patient patient_make(lar_scheme scheme, int threads) {
    patient p = {.d = divided_brick(4, 4, 2, 2, 2, 1)};
    p.set = plain_schedules(&p.d, scheme, LAR_CHANNELS_SEQUENTIAL, threads);
    return p;
}

static lar_schedule *square(patient *p, lar_scheme scheme, int threads) {
    *p = patient_make(scheme, threads);
    return p->set.of;
}

static void patient_clear(patient *p) {
    lar_schedule_set_clear(&p->set);
    divided_clear(&p->d);
}

static lar_status prove(const patient *p, lar_schedule_proof *proof, lar_error *error) {
    return lar_schedule_prove(&p->d.mesh, &p->d.incidence, &p->set, proof, error);
}

/* The proof fails, with all these words in its sentence. Ends the patient. */
static void refused(patient *p, const char *const *word) {
    lar_error error = {0};
    lar_schedule_proof proof = {.spread = 77};
    assert_int_equal(prove(p, &proof, &error), LAR_ERROR_MODEL);
    for (; *word; word++)
        if (!strstr(error.message, *word))
            fail_msg("\"%s\" is not in \"%s\"", *word, error.message);
    assert_int_equal(proof.spread, 77);
    patient_clear(p);
}
#define REFUSED(p, ...) refused(p, (const char *const[]){__VA_ARGS__, NULL})

static int32_t find_end(const lar_schedule *s, bool sends, int32_t peer, int32_t stage) {
    for (int32_t b = 0; b < s->batch_count; b++) {
        lar_range span = sends ? s->batch[b].sends : s->batch[b].receives;
        for (int32_t i = span.first; i < span.first + span.count; i++)
            if (s->transfer[i].peer == peer && s->transfer[i].stage == stage) return i;
    }
    return -1;
}

static lar_transfer *end_of(lar_schedule *s, bool sends, int32_t peer, int32_t stage) {
    int32_t i = find_end(s, sends, peer, stage);
    assert_true(i >= 0);
    return &s->transfer[i];
}

static void leave_out(lar_range *span, int32_t i) {
    if (i < span->first)
        span->first--;
    else if (i < span->first + span->count)
        span->count--;
}

static void remove_end(lar_schedule *s, bool sends, int32_t peer, int32_t stage) {
    int32_t i = find_end(s, sends, peer, stage);
    assert_true(i >= 0);
    memmove(&s->transfer[i], &s->transfer[i + 1],
            (size_t)(--s->transfer_count - i) * sizeof *s->transfer);
    for (int32_t b = 0; b < s->batch_count; b++) {
        leave_out(&s->batch[b].sends, i);
        leave_out(&s->batch[b].receives, i);
    }
}

/* Exchanges what two batches receive and send; they keep their waits. */
static void swap_batches(lar_schedule *s, int32_t a, int32_t b) {
    lar_batch keep = s->batch[a];
    s->batch[a].receives = s->batch[b].receives;
    s->batch[a].sends = s->batch[b].sends;
    s->batch[b].receives = keep.receives;
    s->batch[b].sends = keep.sends;
}

/* ---- what is right ----------------------------------------------------------------------- */

static void plain_schedules_are_right(void **state) {
    (void)state;
    for (int scheme = 0; scheme < LAR_SCHEMES; scheme++)
        for (int threads = 1; threads <= 3; threads++)
            for (int use = 0; use < LAR_CHANNEL_USES; use++) {
                lar_schedule_proof proof;
                lar_error error = {0};
                patient p = {.d = divided_brick(3, 4, 3, 2, 2, 2)};
                p.set = plain_schedules(&p.d, (lar_scheme)scheme, (lar_channel_use)use, threads);
                if (prove(&p, &proof, &error)) fail_msg("%s", error.message);
                assert_int_equal(proof.batches, 8 * threads * plain_batches(threads));
                assert_int_equal(proof.sums, p.d.sharing.first[p.d.mesh.node_count]);
                assert_true(proof.balanced);
                for (uint64_t seed = 0; seed < 3; seed++)
                    assert_null(play_steps(&p.d.mesh, &p.set, seed));
                patient_clear(&p);
            }
}

static void counts(void **state) {
    (void)state;
    patient p;
    lar_schedule_proof proof;
    square(&p, LAR_SCHEME_ALL, 1);
    assert_int_equal(prove(&p, &proof, NULL), LAR_OK);
    assert_int_equal(proof.packets, 4 * 3);
    assert_int_equal(proof.empty_packets, 0);
    assert_int_equal(proof.waits, 0);
    /* A side has 9 nodes, 3 of them on the edge in the middle. */
    assert_int_equal(proof.vectors, 4 * (9 + 9 + 3));
    assert_int_equal(proof.spread, 1);
    patient_clear(&p);
    /* A whole force comes from the lowest processor only. */
    p = (patient){.d = divided_brick(2, 2, 2, 2, 2, 2)};
    p.set = plain_schedules(&p.d, LAR_SCHEME_TWO, LAR_CHANNELS_SEQUENTIAL, 1);
    assert_int_equal(prove(&p, &proof, NULL), LAR_OK);
    assert_int_equal(proof.empty_packets, 6);
    assert_int_equal(proof.spread, 2);
    patient_clear(&p);
}

/* Twelve processors in 2 x 2 x 3: the thesis's example, four steps. */
static void distances(void **state) {
    (void)state;
    patient p = {.d = divided_brick(4, 4, 6, 2, 2, 3)};
    p.set = plain_schedules(&p.d, LAR_SCHEME_LOCAL, LAR_CHANNELS_SEQUENTIAL, 1);
    lar_schedule_proof proof;
    assert_int_equal(prove(&p, &proof, NULL), LAR_OK);
    assert_int_equal(proof.spread, 4);
    int32_t *steps = lar_schedule_distances(&p.set);
    for (int i = 0; i < 12; i++)
        for (int j = 0; j < 12; j++)
            assert_int_equal(steps[12 * i + j], lar_grid_distance(&p.d.distribution.grid, i, j));
    free(steps);
    patient_clear(&p);
    /* One direction alone holds nobody together. */
    p = (patient){.d = divided_brick(4, 1, 1, 2, 1, 1)};
    p.set = plain_schedules(&p.d, LAR_SCHEME_ALL, LAR_CHANNELS_SEQUENTIAL, 1);
    remove_end(&p.set.of[0], true, 1, 0);
    steps = lar_schedule_distances(&p.set);
    assert_int_equal(steps[1], -1);
    assert_int_equal(steps[0], 0);
    free(steps);
    patient_clear(&p);
}

static void unbalanced_is_said(void **state) {
    (void)state;
    patient p = {.d = divided_brick(4, 4, 2, 2, 2, 1)};
    p.d.distribution.processor[0] = 1;
    lar_sharing_clear(&p.d.sharing);
    assert_int_equal(lar_sharing_build(&p.d.incidence, &p.d.distribution, &p.d.sharing, NULL),
                     LAR_OK);
    p.set = plain_schedules(&p.d, LAR_SCHEME_LOCAL, LAR_CHANNELS_SEQUENTIAL, 2);
    lar_schedule_proof proof;
    lar_error error = {0};
    if (prove(&p, &proof, &error)) fail_msg("%s", error.message);
    assert_false(proof.balanced);
    patient_clear(&p);
}

/* ---- shape and fit ----------------------------------------------------------------------- */

static void foreign_schedules(void **state) {
    (void)state;
    patient p;
    square(&p, LAR_SCHEME_ALL, 1)[2].mesh ^= 1;
    REFUSED(&p, "processor 2", "another mesh");
    square(&p, LAR_SCHEME_ALL, 1)[3].division ^= 1;
    REFUSED(&p, "processor 3", "another division");
    square(&p, LAR_SCHEME_ALL, 1)[2].grid = grid_of(4, 1, 1);
    REFUSED(&p, "processor 2", "another division");
    square(&p, LAR_SCHEME_ALL, 1)[1].processor = 2;
    REFUSED(&p, "schedule 1 of 4", "processor 2");
    square(&p, LAR_SCHEME_ALL, 1)[1].batch[0].elements.count = 1000;
    REFUSED(&p, "processor 1, thread 0, batch 0", "outside");
    square(&p, LAR_SCHEME_ALL, 1)[1].batch[0].elements.count--;
    REFUSED(&p, "processor 1: its batches have 7 elements");
    square(&p, LAR_SCHEME_ALL, 1)[1].transfer[0].peer = 1;
    REFUSED(&p, "processor 1", "packet 0", "none that can be");
    square(&p, LAR_SCHEME_ALL, 2)[1].wait[0] = 0;
    REFUSED(&p, "processor 1, thread 0, batch 1", "own thread");
    square(&p, LAR_SCHEME_ALL, 2)[1].element[0] = -1;
    REFUSED(&p, "processor 1", "do not exist");
}

static void elements_lost_and_doubled(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    char word[64];
    snprintf(word, sizeof word, "no processor recovers element %d", s[0].element[7]);
    s[0].batch[9].elements.count--;
    s[0].element_count--;
    REFUSED(&p, word);
    s = square(&p, LAR_SCHEME_LOCAL, 2);
    s[0].element[7] = s[0].element[0];
    REFUSED(&p, "processor 0, thread 1, batch 9 recovers element 0", "twice");
    s = square(&p, LAR_SCHEME_LOCAL, 2);
    s[3].element[7] = s[0].element[0];
    REFUSED(&p, "processor 3, thread 1, batch 9 recovers element 0",
            "as processor 0, thread 0, batch 0 does");
}

static void nodes_lost_and_doubled(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 1);
    s[0].node[1] = s[0].node[0];
    REFUSED(&p, "processor 0, thread 0, batch 7 moves node 0", "moved already");
    s = square(&p, LAR_SCHEME_LOCAL, 1);
    s[0].node[0] = 4;
    REFUSED(&p, "processor 0, thread 0, batch 7 moves node 4", "no element");
    s = square(&p, LAR_SCHEME_LOCAL, 1);
    s[1].node_count--;
    s[1].batch[7].positions.count--;
    char word[64];
    snprintf(word, sizeof word, "processor 1 does not move node %d", s[1].node[s[1].node_count]);
    REFUSED(&p, word);
    s = square(&p, LAR_SCHEME_LOCAL, 1);
    s[0].vector[end_of(&s[0], true, 1, 0)->vectors.first] = 0;
    s[1].vector[end_of(&s[1], false, 0, 0)->vectors.first] = 0;
    REFUSED(&p, "processor 1 exchanges node 0 with processor 0 (stage 0)", "no element");
}

/* ---- packets ----------------------------------------------------------------------------- */

static void packets_without_their_other_end(void **state) {
    (void)state;
    patient p;
    remove_end(&square(&p, LAR_SCHEME_LOCAL, 2)[1], false, 0, 0);
    REFUSED(&p, "processor 0, thread 1, batch 10 sends a packet of stage 0 to processor 1");
    remove_end(&square(&p, LAR_SCHEME_LOCAL, 2)[2], true, 0, 1);
    REFUSED(&p, "processor 0, thread 1, batch 13 waits for a packet of stage 1 from processor 2");
    lar_transfer *t = end_of(&square(&p, LAR_SCHEME_LOCAL, 2)[0], true, 2, 1);
    t->peer = 1;
    t->stage = 0;
    REFUSED(&p, "from processor 0 to processor 1, stage 0, is sent twice", "batch 10", "batch 12");
    t = end_of(&square(&p, LAR_SCHEME_LOCAL, 2)[0], false, 2, 1);
    t->peer = 1;
    t->stage = 0;
    REFUSED(&p, "from processor 1 to processor 0, stage 0, is received twice", "batch 11",
            "batch 13");
}

static void two_ends_differ(void **state) {
    (void)state;
    patient p;
    end_of(&square(&p, LAR_SCHEME_LOCAL, 2)[0], true, 1, 0)->vectors.count--;
    REFUSED(&p, "processor 0, thread 1, batch 10 sends what processor 1, thread 1, batch 11",
            "with 8 vectors instead of 9");
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    int32_t *node = s[0].vector + end_of(&s[0], true, 1, 0)->vectors.first;
    node[3] = node[4];
    REFUSED(&p, "processor 0, thread 1, batch 10", "vector 3 is node");
    end_of(&square(&p, LAR_SCHEME_ONE, 2)[1], false, 0, 1)->whole--;
    REFUSED(&p, "processor 1, thread", "whole forces instead");
    end_of(&square(&p, LAR_SCHEME_LOCAL, 2)[0], true, 1, 0)->offset += 64;
    REFUSED(&p, "processor 0, thread 1, batch 10", "to offset", "instead of");
}

static void move_packet(lar_schedule *s, int32_t from, int32_t to, int64_t offset) {
    end_of(&s[from], true, to, 0)->offset = offset;
    end_of(&s[to], false, from, 0)->offset = offset;
}

static void places_in_buffers(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_ALL, 2);
    move_packet(s, 1, 0, end_of(&s[0], false, 2, 0)->offset);
    REFUSED(&p, "buffer of processor 0", "from processor 1, stage 0", "from processor 2, stage 0",
            "overlap");
    /* Within the last bytes of the one before. */
    s = square(&p, LAR_SCHEME_ALL, 2);
    move_packet(s, 2, 0, end_of(&s[0], false, 1, 0)->offset + 192);
    REFUSED(&p, "buffer of processor 0", "from processor 1", "from processor 2", "overlap");
    s = square(&p, LAR_SCHEME_ALL, 2);
    move_packet(s, 1, 0, end_of(&s[0], false, 1, 0)->offset + 8);
    REFUSED(&p, "from processor 1 to processor 0", "a multiple of 64");
    s = square(&p, LAR_SCHEME_ALL, 2);
    s[3].receive_bytes -= 64;
    REFUSED(&p, "to processor 3", "must be inside");
    s = square(&p, LAR_SCHEME_ALL, 2);
    s[3].receive_bytes += 8;
    REFUSED(&p, "processor 3", "a multiple of 64");
    s = square(&p, LAR_SCHEME_ALL, 2);
    move_packet(s, 1, 0, -64);
    REFUSED(&p, "from processor 1 to processor 0", "offset -64");
}

static void nothing_flows_back(void **state) {
    (void)state;
    patient p = {.d = divided_brick(2, 2, 2, 2, 2, 2)};
    p.set = plain_schedules(&p.d, LAR_SCHEME_TWO, LAR_CHANNELS_SEQUENTIAL, 1);
    /* 3 is a neighbour of 7, which tells it the sum; 0 has nothing to tell. */
    remove_end(&p.set.of[0], true, 3, 0);
    remove_end(&p.set.of[3], false, 0, 0);
    REFUSED(&p, "processor 3 sends to processor 0", "nothing flows back", "empty packet");
}

/* ---- order ------------------------------------------------------------------------------- */

static void receiving_before_sending(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    swap_batches(&s[0], 10, 11);
    swap_batches(&s[1], 10, 11);
    REFUSED(&p, "deadlock, 4 batches",
            "processor 0, thread 1, batch 10 receives from processor 1, thread 1, batch 11, "
            "which comes after processor 1, thread 1, batch 10, which receives from processor 0, "
            "thread 1, batch 11, which comes after processor 0, thread 1, batch 10");
    /* All in one batch: it receives before it sends. */
    s = square(&p, LAR_SCHEME_LOCAL, 1);
    for (int i = 0; i < 4; i++) {
        s[i].batch[1].receives = s[i].batch[2].receives;
        s[i].batch[2].receives.count = 0;
    }
    REFUSED(&p, "deadlock, 2 batches", "processor 0, thread 0, batch 1", "receives from",
            "processor 1, thread 0, batch 1");
    /* Around the square: each receives from one side before it sends to the other. */
    s = square(&p, LAR_SCHEME_ALL, 1);
    for (int i = 0; i < 4; i++) swap_batches(&s[i], 1, 2);
    REFUSED(&p, "deadlock", "receives from", "comes after");
}

static void waiting_for_each_other(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    s[3].wait[s[3].batch[2].waits.first] = 12;
    REFUSED(&p, "deadlock, 2 batches", "processor 3, thread 0, batch 2",
            "waits for processor 3, thread 1, batch 12",
            "waits for processor 3, thread 0, batch 2");
    s = square(&p, LAR_SCHEME_LOCAL, 2);
    s[3].wait[s[3].batch[10].waits.first] = 3;
    REFUSED(&p, "deadlock", "processor 3, thread 1, batch 10",
            "waits for processor 3, thread 0, batch 3");
    /* Gates must not wait for gates. */
    s = square(&p, LAR_SCHEME_LOCAL, 2);
    s[1].wait[s[1].batch[8].waits.first] = 17;
    s[1].wait[s[1].batch[17].waits.first] = 8;
    REFUSED(&p, "deadlock, 2 batches", "processor 1, thread 0, batch 8",
            "processor 1, thread 1, batch 17");
}

static void receiving_too_early(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    swap_batches(&s[0], 10, 11);
    REFUSED(&p, "processor 0, thread 1, batch 10 receives it from processor 1 (stage 0)",
            "only then, in batch 11, sends it to processor 1 (stage 0)");
    s = square(&p, LAR_SCHEME_LOCAL, 2);
    swap_batches(&s[0], 11, 12);
    REFUSED(&p, "processor 0, thread 1, batch 11 sends it to processor 2 (stage 1)",
            "only then, in batch 12, receives it from processor 1 (stage 0)");
    /* The x packets one stage later: what goes along y misses them. */
    s = square(&p, LAR_SCHEME_LOCAL, 1);
    for (int i = 0; i < 4; i++)
        for (int sends = 0; sends < 2; sends++) end_of(&s[i], sends, i ^ 1, 0)->stage = 1;
    REFUSED(&p, "processor 0, thread 0, batch 2 receives it from processor 1 (stage 1)",
            "only then, in batch 3, sends it to processor 2 (stage 1)");
}

/* ---- races ------------------------------------------------------------------------------- */

static void waits_left_out(void **state) {
    (void)state;
    patient p;
    square(&p, LAR_SCHEME_LOCAL, 2)[0].batch[10].waits.count = 0;
    REFUSED(&p,
            "processor 0, thread 1, batch 10 sends it to processor 1 (stage 0) and does not wait "
            "for processor 0, thread 0, batch 0, which recovers element");
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    for (int b = 5; b <= 7; b++) s[2].batch[b].waits.count = 0;
    REFUSED(&p,
            "processor 2, thread 0, batch 7 moves it and does not wait for processor 2, thread 1, "
            "batch 13, which receives it from processor 0 (stage 1)");
    /* Thread 0 receives what thread 1 has not sent yet. */
    s = square(&p, LAR_SCHEME_LOCAL, 2);
    s[0].batch[2].receives = s[0].batch[11].receives;
    s[0].batch[11].receives.count = 0;
    s[0].batch[2].waits.count = 0;
    REFUSED(&p,
            "processor 0, thread 0, batch 2 receives it from processor 1 (stage 0) and does not "
            "wait for processor 0, thread 1, batch 10, which sends it to processor 1 (stage 0)");
}

static void moved_by_the_wrong_thread(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    s[0].batch[7].positions.first++;
    s[0].batch[7].positions.count--;
    s[0].batch[9].positions = (lar_range){0, 1};
    REFUSED(&p,
            "node 0: processor 0, thread 1, batch 9 moves it and does not wait for processor 0, "
            "thread 0, batch 0, which recovers element 0 at it");
    /* Before it is sent, in the same batch. */
    s = square(&p, LAR_SCHEME_LOCAL, 1);
    s[0].batch[1].positions = s[0].batch[7].positions;
    s[0].batch[7].positions.count = 0;
    REFUSED(&p, "processor 0, thread 0, batch 1 moves it",
            "only then, in batch 1, sends it to processor 1 (stage 0)");
}

static void gates_left_out(void **state) {
    (void)state;
    patient p;
    square(&p, LAR_SCHEME_LOCAL, 2)[1].batch[8].waits.count = 0;
    REFUSED(&p, "processor 1, thread 0 can begin the next step while thread 1", "batch 16");
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 3);
    s[2].wait[s[2].batch[26].waits.first] = 6;
    REFUSED(&p, "processor 2, thread 2 can begin the next step while thread 0", "batch 7");
}

/* ---- sums -------------------------------------------------------------------------------- */

static void vectors_left_out(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    lar_transfer *t = end_of(&s[0], true, 1, 0);
    char word[64];
    snprintf(word, sizeof word, "processor 1 moves node %d without the force of element",
             s[0].vector[t->vectors.first + --t->vectors.count]);
    end_of(&s[1], false, 0, 0)->vectors.count--;
    REFUSED(&p, word, "which processor 0 recovers");
}

static void vectors_twice(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    int32_t *sent = s[0].vector + end_of(&s[0], true, 1, 0)->vectors.first;
    int32_t *received = s[1].vector + end_of(&s[1], false, 0, 0)->vectors.first;
    sent[1] = received[1] = sent[0];
    char word[96];
    snprintf(word, sizeof word, "processor 1 moves node %d with 2 times the force of element",
             sent[0]);
    REFUSED(&p, word, "which processor 0 recovers");
}

static void parts_taken_for_whole_and_back(void **state) {
    (void)state;
    patient p;
    lar_schedule *s = square(&p, LAR_SCHEME_LOCAL, 2);
    end_of(&s[0], true, 1, 0)->whole++;
    end_of(&s[1], false, 0, 0)->whole++;
    REFUSED(&p, "processor 1 moves node", "without the force of element",
            "which processor 1 recovers");
    s = square(&p, LAR_SCHEME_ONE, 2);
    assert_int_equal(end_of(&s[1], false, 0, 1)->whole, 3);
    end_of(&s[0], true, 1, 1)->whole--;
    end_of(&s[1], false, 0, 1)->whole--;
    REFUSED(&p, "processor 1 moves node", "with 2 times the force of element");
    /* A whole force beside a part, in the same stage. */
    s = square(&p, LAR_SCHEME_ALL, 2);
    for (int i = 1; i < 3; i++) {
        lar_transfer *send = end_of(&s[i], true, 3, 0), *receive = end_of(&s[3], false, i, 0);
        send->whole = receive->whole = send->vectors.count;
    }
    REFUSED(&p, "processor 3, thread", "receives its whole force in the stage in which",
            "receives it from processor");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plain_schedules_are_right),
        cmocka_unit_test(counts),
        cmocka_unit_test(distances),
        cmocka_unit_test(unbalanced_is_said),
        cmocka_unit_test(foreign_schedules),
        cmocka_unit_test(elements_lost_and_doubled),
        cmocka_unit_test(nodes_lost_and_doubled),
        cmocka_unit_test(packets_without_their_other_end),
        cmocka_unit_test(two_ends_differ),
        cmocka_unit_test(places_in_buffers),
        cmocka_unit_test(nothing_flows_back),
        cmocka_unit_test(receiving_before_sending),
        cmocka_unit_test(waiting_for_each_other),
        cmocka_unit_test(receiving_too_early),
        cmocka_unit_test(waits_left_out),
        cmocka_unit_test(moved_by_the_wrong_thread),
        cmocka_unit_test(gates_left_out),
        cmocka_unit_test(vectors_left_out),
        cmocka_unit_test(vectors_twice),
        cmocka_unit_test(parts_taken_for_whole_and_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
