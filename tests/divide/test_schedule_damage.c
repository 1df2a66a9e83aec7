/* Random damage to schedules. Whatever the proof lets pass must also pass when it is played in
 * random orders of events: what has been proved, holds. And it must look at nothing that is not
 * there, which the sanitizers watch.
 *
 *     test_divide_schedule_damage [rounds]
 */
#include "divide/proof/schedule_proof.h"

#include "plain_schedule.h"
#include "step_player.h"

static int32_t rounds = 500; /* of damage per kind of schedule */

static void *copy_of(const void *from, int32_t count, size_t size) {
    /* Exactly as long as it says, so that reading beyond is seen. */
    void *to = malloc((size_t)count * size + !count);
    if (count) memcpy(to, from, (size_t)count * size);
    return to;
}

static lar_schedule_set copy_set(const lar_schedule_set *from) {
    lar_schedule_set set = {from->count, copy_of(from->of, from->count, sizeof *set.of)};
    for (int32_t p = 0; p < set.count; p++) {
        lar_schedule *s = &set.of[p];
        s->batch = copy_of(s->batch, s->batch_count, sizeof *s->batch);
        s->element = copy_of(s->element, s->element_count, sizeof *s->element);
        s->wait = copy_of(s->wait, s->wait_count, sizeof *s->wait);
        s->transfer = copy_of(s->transfer, s->transfer_count, sizeof *s->transfer);
        s->node = copy_of(s->node, s->node_count, sizeof *s->node);
        s->vector = copy_of(s->vector, s->vector_count, sizeof *s->vector);
    }
    return set;
}

/* ---- damage ------------------------------------------------------------------------------ */

static lar_range *some_span(lar_batch *b, int32_t part) {
    lar_range *const span[] = {&b->elements, &b->waits, &b->receives, &b->positions, &b->sends};
    return span[part];
}

static void damage_number(lar_random *r, int32_t *array, int32_t count, int32_t bound) {
    if (!count) return;
    int32_t *at = &array[lar_random_below(r, count)];
    int32_t *other = &array[lar_random_below(r, count)], keep = *at;
    switch (lar_random_below(r, 4)) {
    case 0:
        *at = lar_random_below(r, bound);
        break;
    case 1:
        *at = *other;
        break;
    case 2:
        *at += lar_random_below(r, 3) - 1;
        break;
    default:
        *at = *other, *other = keep;
    }
}

static void damage_transfer(lar_random *r, lar_schedule *s) {
    if (!s->transfer_count) return;
    lar_transfer *t = &s->transfer[lar_random_below(r, s->transfer_count)];
    lar_transfer *other = &s->transfer[lar_random_below(r, s->transfer_count)], keep = *t;
    int32_t by = lar_random_below(r, 3) - 1;
    switch (lar_random_below(r, 7)) {
    case 0:
        t->peer += by;
        break;
    case 1:
        t->stage += by;
        break;
    case 2:
        t->whole += by;
        break;
    case 3:
        t->offset += by * (int64_t)lar_random_below(r, 200);
        break;
    case 4:
        t->vectors.count += by;
        break;
    case 5:
        t->vectors.first += by;
        break;
    default:
        *t = *other, *other = keep;
    }
}

static void damage_batch(lar_random *r, lar_schedule *s) {
    int32_t b = lar_random_below(r, s->batch_count), part = lar_random_below(r, 5);
    int32_t c = lar_random_below(r, s->batch_count);
    lar_range *span = some_span(&s->batch[b], part), *other = some_span(&s->batch[c], part);
    lar_range keep = *span;
    lar_batch whole = s->batch[b];
    switch (lar_random_below(r, 6)) {
    case 0:
        span->first += lar_random_below(r, 3) - 1;
        break;
    case 1:
        span->count += lar_random_below(r, 3) - 1;
        break;
    case 2:
        *span = *other, *other = keep;
        break;
    case 3:
        s->batch[b].waits.count = 0;
        break;
    case 4:
        s->batch[b] = s->batch[c], s->batch[c] = whole;
        break;
    default:
        /* A batch takes over what its neighbour begins or ends with. */
        if (!other->count || span->first + span->count != other->first) break;
        span->count++, other->count--, other->first++;
    }
}

/* The same at both ends of a packet: its stage, its wholeness, a vector less, its place. */
static void damage_packet(lar_random *r, lar_schedule_set *set, int32_t p) {
    lar_schedule *s = &set->of[p];
    if (!s->transfer_count) return;
    lar_transfer *t = &s->transfer[lar_random_below(r, s->transfer_count)];
    lar_schedule *peer = &set->of[t->peer >= 0 && t->peer < set->count ? t->peer : 0];
    int32_t kind = lar_random_below(r, 4), by = lar_random_below(r, 3) - 1, stage = t->stage;
    int64_t offset = t->offset;
    for (int i = 0; i < 2; i++) {
        lar_schedule *end = i ? peer : s;
        for (int32_t j = 0; j < end->transfer_count; j++) {
            lar_transfer *u = &end->transfer[j];
            if (u->offset != offset || u->stage != stage || u->peer != (i ? p : peer->processor))
                continue;
            if (kind == 0) u->stage += by;
            if (kind == 1) u->whole += by;
            if (kind == 2) u->vectors.count += by;
            if (kind == 3) u->offset += by * 64;
        }
    }
}

static void damage(lar_random *r, const lar_mesh *mesh, lar_schedule_set *set) {
    int32_t p = lar_random_below(r, set->count);
    lar_schedule *s = &set->of[p];
    switch (lar_random_below(r, 8)) {
    case 0:
        damage_number(r, s->element, s->element_count, mesh->element_count);
        break;
    case 1:
        damage_number(r, s->node, s->node_count, mesh->node_count);
        break;
    case 2:
        damage_number(r, s->vector, s->vector_count, mesh->node_count);
        break;
    case 3:
        damage_number(r, s->wait, s->wait_count, s->batch_count);
        break;
    case 4:
        damage_transfer(r, s);
        break;
    case 5:
        damage_packet(r, set, p);
        break;
    default:
        damage_batch(r, s);
    }
}

/* ---- schedules --------------------------------------------------------------------------- */

static void damage_one_kind(const divided *d, const lar_schedule_set *good, uint64_t seed) {
    lar_random random = {seed};
    int32_t passed = 0, refused = 0;
    for (int32_t i = 0; i < rounds; i++) {
        lar_schedule_set set = copy_set(good);
        lar_error error = {0};
        for (int32_t n = 1 + lar_random_below(&random, 3); n; n--) damage(&random, &d->mesh, &set);
        lar_status status = lar_schedule_prove(&d->mesh, &d->incidence, &set, NULL, &error);
        if (status) {
            assert_int_equal(status, LAR_ERROR_MODEL);
            assert_true(error.message[0]);
            refused++;
        }
        for (uint64_t order = 0; !status && order < 4; order++) {
            const char *wrong = play_steps(&d->mesh, &set, order);
            if (wrong) fail_msg("round %d of seed %d: proved, but %s", i, (int)seed, wrong);
        }
        passed += !status;
        lar_schedule_set_clear(&set);
    }
    /* Both must happen, or this test is no test. */
    assert_true(refused > rounds / 2);
    assert_true(rounds < 100 || passed > rounds / 100);
}

static void plain(void **state) {
    (void)state;
    for (int kind = 0; kind < 8; kind++) {
        int threads = 1 + kind % 2;
        divided d = kind & 4 ? divided_brick(2, 3, 2, 2, 2, 2) : divided_brick(4, 2, 1, 2, 2, 1);
        lar_schedule_set set =
            plain_schedules(&d, (lar_scheme)(kind % 4), LAR_CHANNELS_SEQUENTIAL, threads);
        damage_one_kind(&d, &set, (uint64_t)kind);
        lar_schedule_set_clear(&set);
        divided_clear(&d);
    }
}

static void built(void **state) {
    (void)state;
    for (int kind = 0; kind < 12; kind++) {
        divided d = kind & 1 ? divided_brick(4, 3, 2, 2, 2, 1) : divided_brick(2, 3, 4, 2, 2, 2);
        lar_schedule_options options = lar_schedule_options_default();
        lar_schedule_set set;
        options.scheme = (lar_scheme)(kind % 4);
        options.channels = (lar_channel_use)(kind / 4 % 2);
        options.threads = 1 + kind / 4;
        options.search = 100;
        assert_int_equal(
            lar_schedule_build(&d.mesh, &d.incidence, &d.distribution, &options, &set, NULL),
            LAR_OK);
        damage_one_kind(&d, &set, (uint64_t)kind + 100);
        lar_schedule_set_clear(&set);
        divided_clear(&d);
    }
}

int main(int argc, char **argv) {
    if (argc > 1) rounds = atoi(argv[1]);
    const struct CMUnitTest tests[] = {cmocka_unit_test(plain), cmocka_unit_test(built)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
