/* Schedules: the thesis's figures, counted from what the schedules send, and their shape. */
#include "divide/schedule/schedule.h"

#include "divide/proof/schedule_proof.h"
#include "brick_mesh.h"
#include "model/demo/demo.h"

typedef struct divided {
    lar_mesh mesh;
    lar_incidence incidence;
    lar_distribution distribution;
} divided;

/* gx x gy x gz cubes of n^3 elements, one for each processor. */
static divided cubes(int n, int gx, int gy, int gz) {
    divided d = {.mesh = brick_mesh(n * gx, n * gy, n * gz)};
    lar_grid grid = grid_of(gx, gy, gz);
    assert_int_equal(lar_distribution_cut(&d.mesh, &grid, &d.distribution, NULL), LAR_OK);
    assert_int_equal(lar_incidence_build(&d.mesh, &d.incidence, NULL), LAR_OK);
    return d;
}

static void clear(divided *d) {
    lar_distribution_clear(&d->distribution);
    lar_incidence_clear(&d->incidence);
    lar_mesh_clear(&d->mesh);
}

static void build(const divided *d, lar_scheme scheme, lar_channel_use channels, int threads,
                  lar_schedule_set *set) {
    lar_schedule_options options = lar_schedule_options_default();
    options.scheme = scheme;
    options.channels = channels;
    options.threads = threads;
    lar_error error = {0};
    if (lar_schedule_build(&d->mesh, &d->incidence, &d->distribution, &options, set, &error))
        fail_msg("%s", error.message);
}

static void prove(const divided *d, const lar_schedule_set *set) {
    lar_schedule_proof proof;
    lar_error error = {0};
    if (lar_schedule_prove(&d->mesh, &d->incidence, set, &proof, &error))
        fail_msg("grid %dx%dx%d, %s, %s, %d threads: %s", set->of->grid.edge[0],
                 set->of->grid.edge[1], set->of->grid.edge[2], lar_scheme_name[set->of->scheme],
                 lar_channel_use_name[set->of->channels], set->of->threads, error.message);
}

enum { CENTRE = 13 };

/* Table 3.1, counted from what the schedule of the processor in the middle sends. */
static void table_3_1(int first, int last) {
    for (int n = first; n <= last; n++) {
        divided d = cubes(n, 3, 3, 3);
        for (int s = 0; s < LAR_SCHEMES; s++)
            for (int c = 0; c < LAR_CHANNEL_USES; c++) {
                int64_t local, global;
                lar_schedule_set set;
                lar_traffic traffic;
                lar_traffic_formula((lar_scheme)s, n, &local, &global);
                build(&d, (lar_scheme)s, (lar_channel_use)c, 1, &set);
                lar_schedule_traffic(&set.of[CENTRE], &traffic);
                assert_int_equal(traffic.local, local);
                assert_int_equal(traffic.global, global);
                if (n == 5 && s == LAR_SCHEME_ALL) assert_int_equal(local + global, 296);
                if (n == 5 && s == LAR_SCHEME_LOCAL) assert_int_equal(local + global, 216);
                lar_schedule_set_clear(&set);
            }
        clear(&d);
    }
}

static void small_cubes(void **state) {
    (void)state;
    table_3_1(3, 6);
}

static void large_cubes(void **state) {
    (void)state;
    table_3_1(7, 10);
}

/* T 6.6.2.1: a cube of 64 elements with six neighbours. 32 elements for x, 16 more for y, 8 more
 * for z; the last 8 fill the longest gap. */
static void algorithm_2(void **state) {
    (void)state;
    divided d = cubes(4, 3, 3, 3);
    lar_schedule_set set;
    build(&d, LAR_SCHEME_LOCAL, LAR_CHANNELS_SEQUENTIAL, 1, &set);
    const lar_schedule *s = &set.of[CENTRE];
    /* elements, receives (number, stage), sends (number, stage, to) */
    static const int expected[5][7] = {{16, 0, 0, 1, 0, 14, 0},
                                       {16, 0, 0, 1, 0, 12, 0},
                                       {16, 2, 0, 2, 1, 10, 16},
                                       {8, 2, 1, 2, 2, 4, 22},
                                       {8, 2, 2, 0, 0, 0, 0}};
    assert_int_equal(s->batch_count, 5);
    for (int b = 0; b < 5; b++) {
        const lar_batch *batch = &s->batch[b];
        assert_int_equal(batch->elements.count, expected[b][0]);
        assert_int_equal(batch->receives.count, expected[b][1]);
        for (int i = 0; i < batch->receives.count; i++)
            assert_int_equal(s->transfer[batch->receives.first + i].stage, expected[b][2]);
        assert_int_equal(batch->sends.count, expected[b][3]);
        for (int i = 0; i < batch->sends.count; i++) {
            const lar_transfer *t = &s->transfer[batch->sends.first + i];
            assert_int_equal(t->stage, expected[b][4]);
            assert_int_equal(t->peer, expected[b][5 + i]);
            assert_int_equal(t->vectors.count, 25);
        }
        assert_int_equal(batch->waits.count, 0);
        assert_int_equal(batch->positions.count, b == 4 ? 125 : 0);
    }
    lar_schedule_set_clear(&set);
    clear(&d);
}

/* T 6.6.2.2: the nodes of the corners leave first, in any batch before a face is complete. */
static void far_travellers_first(void **state) {
    (void)state;
    divided d = cubes(4, 3, 3, 3);
    lar_schedule_set set;
    build(&d, LAR_SCHEME_LOCAL, LAR_CHANNELS_CONCURRENT, 1, &set);
    const lar_schedule *s = &set.of[CENTRE];
    const lar_batch *first = &s->batch[0];
    assert_int_equal(first->elements.count, 8);
    assert_int_equal(first->sends.count, 2);
    for (int i = 0; i < 2; i++)
        assert_int_equal(s->transfer[first->sends.first + i].vectors.count, 4);
    for (int b = 0; b < s->batch_count; b++) assert_int_equal(s->batch[b].elements.count, 8);
    lar_schedule_set_clear(&set);
    clear(&d);
}

/* Eq. 6.6: sums that others must add up and send back leave before what is needed by one only. */
static void urgent_ones_first(void **state) {
    (void)state;
    divided d = cubes(4, 3, 3, 3);
    lar_schedule_set set;
    build(&d, LAR_SCHEME_ONE, LAR_CHANNELS_SEQUENTIAL, 1, &set);
    const lar_schedule *s = &set.of[CENTRE];
    int lower = 0, upper = 0;
    for (int b = 0; b < s->batch_count; b++)
        for (int i = 0; i < s->batch[b].sends.count; i++) {
            const lar_transfer *t = &s->transfer[s->batch[b].sends.first + i];
            if (t->stage > 0) continue;
            upper += t->peer > CENTRE;
            if (t->peer > CENTRE) continue;
            lower++;
            assert_int_equal(upper, 0);
        }
    assert_int_equal(lower, 3 + 3 + 1); /* over faces, edges, a corner */
    assert_int_equal(upper, 3);
    lar_schedule_set_clear(&set);
    clear(&d);
}

/* ---- what holds for every schedule --------------------------------------------------------- */

static void count_once(const int32_t *number, int32_t count, int32_t max, char *seen) {
    memset(seen, 0, (size_t)max);
    for (int32_t i = 0; i < count; i++) {
        assert_in_range(number[i], 0, max - 1);
        assert_false(seen[number[i]]);
        seen[number[i]] = 1;
    }
}

static void covers(const divided *d, const lar_schedule *s) {
    size_t max = (size_t)(d->mesh.element_count + d->mesh.node_count);
    char *seen = calloc(max, 1), *node = calloc(max, 1);
    count_once(s->element, s->element_count, d->mesh.element_count, seen);
    for (int32_t e = 0; e < d->mesh.element_count; e++) {
        assert_int_equal(seen[e], d->distribution.processor[e] == s->processor);
        for (int a = 0; a < 8 && seen[e]; a++) node[d->mesh.element[e][a]] = 1;
    }
    count_once(s->node, s->node_count, d->mesh.node_count, seen);
    assert_memory_equal(seen, node, (size_t)d->mesh.node_count);
    free(seen);
    free(node);
}

/* The transfer of a processor with a peer and stage; NULL: none. */
static const lar_transfer *transfer_of(const lar_schedule *s, bool sends, int32_t peer, int stage) {
    for (int32_t b = 0; b < s->batch_count; b++) {
        lar_range span = sends ? s->batch[b].sends : s->batch[b].receives;
        for (int32_t i = span.first; i < span.first + span.count; i++)
            if (s->transfer[i].peer == peer && s->transfer[i].stage == stage)
                return &s->transfer[i];
    }
    return NULL;
}

/* What is sent is received, the same way. Returns how many packets a processor sends. */
static int packets_agree(const lar_schedule_set *set, int32_t from) {
    const lar_schedule *s = &set->of[from];
    int count = 0;
    for (int32_t b = 0; b < s->batch_count; b++)
        for (int32_t i = 0; i < s->batch[b].sends.count; i++, count++) {
            const lar_transfer *out = &s->transfer[s->batch[b].sends.first + i];
            const lar_schedule *peer = &set->of[out->peer];
            const lar_transfer *in = transfer_of(peer, false, from, out->stage);
            assert_non_null(in);
            assert_int_equal(out->whole, in->whole);
            assert_int_equal(out->offset, in->offset);
            assert_int_equal(out->vectors.count, in->vectors.count);
            if (out->vectors.count > 0)
                assert_memory_equal(s->vector + out->vectors.first,
                                    peer->vector + in->vectors.first,
                                    (size_t)out->vectors.count * sizeof(int32_t));
        }
    return count;
}

/* Every byte of the buffer belongs to one packet at most, and no line of 64 to two. */
static void places_are_apart(const lar_schedule *s) {
    char *line = calloc((size_t)(s->receive_bytes / LAR_PACKET_ALIGN) + 1, 1);
    assert_int_equal(s->receive_bytes % LAR_PACKET_ALIGN, 0);
    for (int32_t b = 0; b < s->batch_count; b++)
        for (int32_t i = 0; i < s->batch[b].receives.count; i++) {
            const lar_transfer *t = &s->transfer[s->batch[b].receives.first + i];
            int64_t bytes = lar_packet_payload(t->vectors.count) + LAR_TAIL_BYTES;
            assert_int_equal(t->offset % LAR_PACKET_ALIGN, 0);
            assert_true(t->offset + bytes <= s->receive_bytes);
            for (int64_t at = t->offset; at < t->offset + bytes; at += LAR_PACKET_ALIGN)
                assert_int_equal(line[at / LAR_PACKET_ALIGN]++, 0);
        }
    free(line);
}

/* No stage before an earlier one on a thread; the last batch moves, a gate waits for all others. */
static void threads_in_order(const lar_schedule *s) {
    int min = s->element_count, max = 0;
    for (int t = 0; t < s->threads; t++) {
        int stage = 0, elements = 0, end = s->thread_first[t + 1] - 1;
        for (int b = s->thread_first[t]; b <= end; b++) {
            const lar_batch *batch = &s->batch[b];
            elements += batch->elements.count;
            for (int i = 0; i < batch->sends.count; i++) {
                const lar_transfer *out = &s->transfer[batch->sends.first + i];
                assert_true(out->stage >= stage || out->vectors.count == 0);
                if (out->stage > stage) stage = out->stage;
            }
            if (b < end - (s->threads > 1)) assert_int_equal(batch->positions.count, 0);
        }
        if (elements < min) min = elements;
        if (elements > max) max = elements;
        if (s->threads == 1) continue;
        const lar_batch *gate = &s->batch[end];
        assert_int_equal(gate->waits.count, s->threads - 1);
        for (int i = 0, other = 0; i < gate->waits.count; i++, other++) {
            other += other == t;
            assert_int_equal(s->wait[gate->waits.first + i], s->thread_first[other + 1] - 2);
        }
    }
    /* Threads share the elements evenly, one here or there. */
    assert_in_range(max - min, 0, s->element_count < 10 * s->threads ? 3 : 1);
}

static void check(const divided *d, const lar_schedule_set *set) {
    uint64_t mesh = lar_mesh_fingerprint(&d->mesh);
    int sends = 0, transfers = 0;
    prove(d, set);
    for (int32_t p = 0; p < set->count; p++) {
        covers(d, &set->of[p]);
        places_are_apart(&set->of[p]);
        threads_in_order(&set->of[p]);
        assert_true(set->of[p].division == set->of->division);
        assert_true(set->of[p].mesh == mesh);
        sends += packets_agree(set, p);
        transfers += set->of[p].transfer_count;
    }
    assert_int_equal(transfers, 2 * sends);
}

static void check_all(const divided *d, int max_threads) {
    for (int s = 0; s < LAR_SCHEMES; s++)
        for (int c = 0; c < (s == LAR_SCHEME_LOCAL ? LAR_CHANNEL_USES : 1); c++)
            for (int threads = 1; threads <= max_threads; threads++) {
                lar_schedule_set set;
                build(d, (lar_scheme)s, (lar_channel_use)c, threads, &set);
                check(d, &set);
                lar_schedule_set_clear(&set);
            }
}

static void the_organ(void **state) {
    (void)state;
    static const int edges[][3] = {{1, 1, 1}, {1, 3, 1}, {2, 2, 3}, {4, 4, 4}};
    divided d = {0};
    assert_int_equal(lar_demo_mesh(&d.mesh, NULL), LAR_OK);
    assert_int_equal(lar_incidence_build(&d.mesh, &d.incidence, NULL), LAR_OK);
    for (size_t g = 0; g < sizeof edges / sizeof *edges; g++)
        for (int random = 0; random < 2; random++) {
            lar_grid grid = grid_of(edges[g][0], edges[g][1], edges[g][2]);
            if (random)
                lar_distribution_random(&d.mesh, &grid, 5, &d.distribution, NULL);
            else
                lar_distribution_cut(&d.mesh, &grid, &d.distribution, NULL);
            check_all(&d, grid.count > 12 ? 1 + !random : 4);
            lar_distribution_clear(&d.distribution);
        }
    clear(&d);
}

/* More threads than elements: some only move nodes, or do nothing. */
static void few_elements(void **state) {
    (void)state;
    divided d = cubes(1, 3, 1, 1);
    check_all(&d, LAR_THREADS_MAX);
    clear(&d);
    d = cubes(3, 1, 1, 1);
    check_all(&d, LAR_THREADS_MAX);
    clear(&d);
}

/* ---- empty packets, one division for one input, options ------------------------------------ */

static int64_t empty_packets(const divided *d, const lar_schedule_set *set) {
    lar_schedule_proof proof;
    assert_int_equal(lar_schedule_prove(&d->mesh, &d->incidence, set, &proof, NULL), LAR_OK);
    assert_true(proof.spread >= 0);
    return proof.empty_packets;
}

static bool exchange(const lar_schedule *s, int32_t peer) {
    bool any = false;
    for (int stage = 0; stage < LAR_STAGES; stage++) any |= transfer_of(s, true, peer, stage) != 0;
    return any;
}

/* Two points: the corners at the sides send to both points and hear from one. */
static void something_flows_back(void **state) {
    (void)state;
    divided d = cubes(3, 2, 2, 2);
    lar_schedule_set set;
    build(&d, LAR_SCHEME_TWO, LAR_CHANNELS_SEQUENTIAL, 1, &set);
    assert_int_equal(empty_packets(&d, &set), 6);
    for (int p = 0; p < 8; p++)
        for (int q = 0; q < 8; q++)
            assert_int_equal(exchange(&set.of[p], q), exchange(&set.of[q], p));
    lar_schedule_set_clear(&set);
    build(&d, LAR_SCHEME_ALL, LAR_CHANNELS_SEQUENTIAL, 1, &set);
    assert_int_equal(empty_packets(&d, &set), 0);
    lar_schedule_set_clear(&set);
    clear(&d);
}

/* Five bodies that do not touch, one for each processor, hear of each other all the same. */
static void bodies_apart(void **state) {
    (void)state;
    divided d = {.mesh = brick_mesh(9, 1, 1)};
    for (int i = 0; i < 5; i++)
        memcpy(d.mesh.element[i], d.mesh.element[2 * i], sizeof *d.mesh.element);
    d.mesh.element_count = 5;
    lar_grid grid = grid_of(5, 1, 1);
    assert_int_equal(lar_distribution_cut(&d.mesh, &grid, &d.distribution, NULL), LAR_OK);
    assert_int_equal(lar_incidence_build(&d.mesh, &d.incidence, NULL), LAR_OK);
    for (int threads = 1; threads < 3; threads++) {
        lar_schedule_set set;
        build(&d, LAR_SCHEME_ALL, LAR_CHANNELS_SEQUENTIAL, threads, &set);
        check(&d, &set);
        assert_int_equal(empty_packets(&d, &set), 8);
        /* Nobody may wait for an empty packet before its own have left. */
        assert_int_equal(set.of[0].batch[0].receives.count, 0);
        assert_int_equal(set.of[0].batch[0].sends.count, 2);
        lar_traffic traffic;
        lar_schedule_traffic(&set.of[0], &traffic);
        assert_int_equal(traffic.local_packets + traffic.global_packets, 0);
        lar_schedule_set_clear(&set);
    }
    clear(&d);
}

static void one_input_one_division(void **state) {
    (void)state;
    divided d = cubes(4, 2, 2, 2);
    lar_schedule_set one, two, other;
    build(&d, LAR_SCHEME_ONE, LAR_CHANNELS_SEQUENTIAL, 3, &one);
    build(&d, LAR_SCHEME_ONE, LAR_CHANNELS_SEQUENTIAL, 3, &two);
    build(&d, LAR_SCHEME_TWO, LAR_CHANNELS_SEQUENTIAL, 3, &other);
    assert_true(one.of->division == two.of->division);
    assert_true(one.of->division != other.of->division);
    for (int p = 0; p < 8; p++) {
        const lar_schedule *a = &one.of[p], *b = &two.of[p];
        assert_int_equal(a->batch_count, b->batch_count);
        assert_memory_equal(a->batch, b->batch, (size_t)a->batch_count * sizeof *a->batch);
        assert_int_equal(a->wait_count, b->wait_count);
        assert_memory_equal(a->wait, b->wait, (size_t)a->wait_count * sizeof *a->wait);
        assert_memory_equal(a->element, b->element, (size_t)a->element_count * sizeof *a->element);
        assert_memory_equal(a->node, b->node, (size_t)a->node_count * sizeof *a->node);
        assert_int_equal(a->vector_count, b->vector_count);
        assert_memory_equal(a->vector, b->vector, (size_t)a->vector_count * sizeof *a->vector);
    }
    lar_schedule_set_clear(&one);
    lar_schedule_set_clear(&one);
    lar_schedule_set_clear(&two);
    lar_schedule_set_clear(&other);
    clear(&d);
}

static void options(void **state) {
    (void)state;
    divided d = cubes(2, 2, 1, 1);
    lar_schedule_options good = lar_schedule_options_default(), bad;
    lar_schedule_set set = {0};
    lar_error error = {0};
    assert_int_equal(good.threads, 1);
    bad = good;
    bad.threads = 0;
    assert_int_equal(lar_schedule_build(&d.mesh, &d.incidence, &d.distribution, &bad, &set, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "1 to 16"));
    bad.threads = LAR_THREADS_MAX + 1;
    assert_int_equal(lar_schedule_build(&d.mesh, &d.incidence, &d.distribution, &bad, &set, NULL),
                     LAR_ERROR_ARGUMENT);
    bad = good;
    bad.scheme = LAR_SCHEMES;
    assert_int_equal(lar_schedule_build(&d.mesh, &d.incidence, &d.distribution, &bad, &set, NULL),
                     LAR_ERROR_ARGUMENT);
    bad = good;
    bad.search = -1;
    assert_int_equal(lar_schedule_build(&d.mesh, &d.incidence, &d.distribution, &bad, &set, NULL),
                     LAR_ERROR_ARGUMENT);
    assert_null(set.of);
    good.threads = 2;
    good.search = 0;
    assert_int_equal(lar_schedule_build(&d.mesh, &d.incidence, &d.distribution, &good, &set, NULL),
                     LAR_OK);
    check(&d, &set);
    lar_schedule_set_clear(&set);
    clear(&d);
}

int main(int argc, char **argv) {
    (void)argv;
    const struct CMUnitTest fast[] = {
        cmocka_unit_test(small_cubes),
        cmocka_unit_test(algorithm_2),
        cmocka_unit_test(far_travellers_first),
        cmocka_unit_test(urgent_ones_first),
        cmocka_unit_test(the_organ),
        cmocka_unit_test(few_elements),
        cmocka_unit_test(something_flows_back),
        cmocka_unit_test(bodies_apart),
        cmocka_unit_test(one_input_one_division),
        cmocka_unit_test(options),
    };
    const struct CMUnitTest slow[] = {cmocka_unit_test(large_cubes)};
    return argc > 1 ? cmocka_run_group_tests(slow, NULL, NULL)
                    : cmocka_run_group_tests(fast, NULL, NULL);
}
