/* Sets of nodes and vectors per step: the thesis's figures, counted from real sets. */
#include "divide/traffic.h"

#include "divide/cost.h"
#include "brick_mesh.h"
#include "model/demo/demo.h"

/* Everything that the tests ask about one division. */
typedef struct divided {
    lar_mesh mesh;
    lar_incidence incidence;
    lar_distribution distribution;
    lar_sharing sharing;
} divided;

static void finish(divided *d) {
    assert_int_equal(lar_incidence_build(&d->mesh, &d->incidence, NULL), LAR_OK);
    assert_int_equal(lar_sharing_build(&d->incidence, &d->distribution, &d->sharing, NULL), LAR_OK);
}

/* gx x gy x gz cubes of n^3 elements, one for each processor. */
static divided cubes(int n, int gx, int gy, int gz) {
    divided d = {.mesh = brick_mesh(n * gx, n * gy, n * gz)};
    lar_grid grid = grid_of(gx, gy, gz);
    assert_int_equal(lar_distribution_cut(&d.mesh, &grid, &d.distribution, NULL), LAR_OK);
    for (int e = 0; e < d.mesh.element_count; e++) {
        int x = e % (n * gx) / n, y = e / (n * gx) % (n * gy) / n, z = e / (n * n * gx * gy) / n;
        assert_int_equal(d.distribution.processor[e], x + gx * (y + gy * z));
    }
    finish(&d);
    return d;
}

static void clear(divided *d) {
    lar_sharing_clear(&d->sharing);
    lar_distribution_clear(&d->distribution);
    lar_incidence_clear(&d->incidence);
    lar_mesh_clear(&d->mesh);
}

/* ---- vectors of a step -------------------------------------------------------------------- */

typedef struct meter {
    const lar_grid *grid;
    lar_traffic *traffic;
    int64_t *packet; /* [processors][processors][LAR_STAGES] vectors */
} meter;

static void count_message(void *context, const lar_message *message) {
    meter *m = context;
    lar_traffic *t = &m->traffic[message->from];
    bool local = lar_grid_neighbours(m->grid, message->from, message->to);
    size_t pair = (size_t)message->from * (size_t)m->grid->count + (size_t)message->to;
    int64_t *packet = &m->packet[pair * LAR_STAGES + (size_t)message->stage];
    *(local ? &t->local : &t->global) += 1;
    if (++*packet == 1) *(local ? &t->local_packets : &t->global_packets) += 1;
    if (*packet > t->largest_packet) t->largest_packet = *packet;
}

/* What every processor sends, packets as in the sequential use of channels. */
static void measure(const lar_sharing *sharing, lar_scheme scheme, lar_traffic *traffic) {
    size_t processors = (size_t)sharing->grid.count;
    size_t packets = processors * processors * LAR_STAGES;
    meter m = {&sharing->grid, traffic, calloc(packets, sizeof *m.packet)};
    assert_non_null(m.packet);
    memset(traffic, 0, processors * sizeof *traffic);
    for (int32_t k = 0; k < sharing->node_count; k++) {
        const int32_t *set;
        int32_t count = lar_sharing_of(sharing, k, &set);
        lar_scheme_messages(scheme, LAR_CHANNELS_SEQUENTIAL, &sharing->grid, set, count,
                            count_message, &m);
    }
    free(m.packet);
}

enum { CENTRE = 13, GRID27 = 27 };

static void the_two_examples(void **state) {
    (void)state;
    divided d = cubes(5, 3, 3, 3);
    lar_traffic traffic[GRID27];
    measure(&d.sharing, LAR_SCHEME_ALL, traffic);
    assert_int_equal(traffic[CENTRE].local + traffic[CENTRE].global, 296);
    assert_int_equal(traffic[CENTRE].local_packets, 6);
    assert_int_equal(traffic[CENTRE].global_packets, 20);
    assert_int_equal(traffic[CENTRE].largest_packet, 36);
    measure(&d.sharing, LAR_SCHEME_LOCAL, traffic);
    assert_int_equal(traffic[CENTRE].local + traffic[CENTRE].global, 216);
    assert_int_equal(traffic[CENTRE].global, 0);
    assert_int_equal(traffic[CENTRE].local_packets, 6);
    clear(&d);
}

static void table_3_1(void **state) {
    (void)state;
    for (int n = 3; n <= 10; n++) {
        divided d = cubes(n, 3, 3, 3);
        for (int s = 0; s < LAR_SCHEMES; s++) {
            lar_traffic traffic[GRID27];
            int64_t local, global;
            measure(&d.sharing, (lar_scheme)s, traffic);
            lar_traffic_formula((lar_scheme)s, n, &local, &global);
            assert_int_equal(traffic[CENTRE].local, local);
            assert_int_equal(traffic[CENTRE].global, global);
        }
        clear(&d);
    }
}

/* The table as printed, so that the formulas in the program are not their own witness. */
static void formulas_are_the_printed_ones(void **state) {
    (void)state;
    for (int64_t n = 1; n < 20; n++) {
        const int64_t printed[LAR_SCHEMES][2] = {{6 * (n + 1) * (n + 1), 12 * n + 20},
                                                 {6 * (n + 1) * (n + 1), 0},
                                                 {6 * n * n, 6 * n + 2},
                                                 {6 * (n * n + 2 * n - 1), 8}};
        for (int s = 0; s < LAR_SCHEMES; s++) {
            int64_t local, global;
            lar_traffic_formula((lar_scheme)s, n, &local, &global);
            assert_int_equal(local, printed[s][0]);
            assert_int_equal(global, printed[s][1]);
        }
    }
}

/* Sizes of the sets of T 3.7.2, processor in the middle. */
static void sets_by_direction(void **state) {
    (void)state;
    const int n = 4;
    divided d = cubes(n, 3, 3, 3);
    int size[LAR_DIRECTIONS + 1] = {0};
    for (int32_t k = 0; k < d.sharing.node_count; k++) {
        const int32_t *set;
        int32_t count = lar_sharing_of(&d.sharing, k, &set), mine = 0;
        for (int32_t i = 0; i < count; i++) mine |= set[i] == CENTRE;
        if (!mine) continue;
        size[lar_node_direction(&d.sharing.grid, set, count)]++;
        assert_false(lar_node_scattered(&d.sharing.grid, set, count));
    }
    const int expected[LAR_DIRECTIONS] = {(n - 1) * (n - 1) * (n - 1),
                                          2 * (n - 1) * (n - 1),
                                          2 * (n - 1) * (n - 1),
                                          4 * (n - 1),
                                          2 * (n - 1) * (n - 1),
                                          4 * (n - 1),
                                          4 * (n - 1),
                                          8,
                                          0};
    for (int i = 0; i < LAR_DIRECTIONS; i++) assert_int_equal(size[i], expected[i]);
    clear(&d);
}

/* ---- a step, played ---------------------------------------------------------------------- */

enum { PROCESSORS = 64 };

typedef struct player {
    int stage;
    int part[PROCESSORS][PROCESSORS]; /* how often processor p has the part of q */
    int before[PROCESSORS][PROCESSORS];
} player;

static void play(void *context, const lar_message *m) {
    player *p = context;
    if (m->stage != p->stage) return;
    for (int q = 0; q < PROCESSORS; q++) {
        int carried = m->what == LAR_CARRIES_OWN ? q == m->from : p->before[m->from][q];
        if (m->what == LAR_CARRIES_ALL)
            p->part[m->to][q] = carried;
        else
            p->part[m->to][q] += carried;
    }
}

/* After all stages every processor of P_k has every part exactly once. */
static void play_node(lar_scheme scheme, lar_channel_use channels, const lar_grid *grid,
                      const int32_t *set, int32_t count) {
    player *p = calloc(1, sizeof *p);
    for (int32_t i = 0; i < count; i++) p->part[set[i]][set[i]] = 1;
    for (p->stage = 0; p->stage < LAR_STAGES; p->stage++) {
        memcpy(p->before, p->part, sizeof p->part);
        lar_scheme_messages(scheme, channels, grid, set, count, play, p);
    }
    for (int32_t i = 0; i < count; i++)
        for (int32_t j = 0; j < count; j++) assert_int_equal(p->part[set[i]][set[j]], 1);
    free(p);
}

static void every_part_arrives_once(void **state) {
    (void)state;
    static const int edges[][3] = {{2, 2, 3}, {3, 3, 3}, {4, 1, 2}, {1, 1, 5}, {4, 4, 4}};
    divided d = {0};
    assert_int_equal(lar_demo_mesh(&d.mesh, NULL), LAR_OK);
    for (size_t g = 0; g < sizeof edges / sizeof *edges; g++)
        for (int random = 0; random < 2; random++) {
            lar_grid grid = grid_of(edges[g][0], edges[g][1], edges[g][2]);
            if (random)
                lar_distribution_random(&d.mesh, &grid, 5, &d.distribution, NULL);
            else
                lar_distribution_cut(&d.mesh, &grid, &d.distribution, NULL);
            finish(&d);
            for (int32_t k = 0; k < d.sharing.node_count; k += random ? 17 : 1) {
                const int32_t *set;
                int32_t count = lar_sharing_of(&d.sharing, k, &set);
                for (int s = 0; s < LAR_SCHEMES && count > 1; s++)
                    for (int c = 0; c < LAR_CHANNEL_USES; c++)
                        play_node((lar_scheme)s, (lar_channel_use)c, &grid, set, count);
            }
            lar_sharing_clear(&d.sharing);
            lar_incidence_clear(&d.incidence);
            lar_distribution_clear(&d.distribution);
        }
    clear(&d);
}

/* Eqs. 3.18 and 3.19: all to all sends |P_k| - 1 vectors per node, and as many come back. */
static void equation_3_18(void **state) {
    (void)state;
    divided d = {0};
    assert_int_equal(lar_demo_mesh(&d.mesh, NULL), LAR_OK);
    lar_grid grid = grid_of(2, 2, 3);
    assert_int_equal(lar_distribution_cut(&d.mesh, &grid, &d.distribution, NULL), LAR_OK);
    finish(&d);
    int64_t expected[12] = {0}, have = 0;
    for (int32_t k = 0; k < d.sharing.node_count; k++) {
        const int32_t *set;
        int32_t count = lar_sharing_of(&d.sharing, k, &set);
        have += count;
        for (int32_t i = 0; i < count; i++) expected[set[i]] += count - 1;
    }
    lar_traffic traffic[12];
    measure(&d.sharing, LAR_SCHEME_ALL, traffic);
    for (int p = 0; p < 12; p++)
        assert_int_equal(traffic[p].local + traffic[p].global, expected[p]);
    assert_true(lar_sharing_mean(&d.sharing) == (double)have / d.mesh.node_count);
    clear(&d);
}

/* Eq. 6.8 by hand: two elements on two processors share four nodes; a 2 x 2 x 2 block on eight. */
static void cost(void **state) {
    (void)state;
    int32_t set[8];
    int64_t pays[8];
    divided d = cubes(1, 2, 1, 1);
    lar_cost c = lar_cost_measure(&d.incidence, d.distribution.processor, 2, set, pays);
    assert_int_equal(c.worst, 4 * 4);
    assert_int_equal(c.total, 2 * 4 * 4);
    clear(&d);
    d = cubes(1, 2, 2, 2);
    c = lar_cost_measure(&d.incidence, d.distribution.processor, 8, set, pays);
    /* Each cube: three nodes shared by two, three by four, one by eight. */
    assert_int_equal(c.worst, 3 * 4 + 3 * 8 + 12);
    assert_int_equal(c.total, 8 * c.worst);
    clear(&d);
    assert_int_equal(lar_cost_of_node(1), 0);
    assert_int_equal(lar_cost_of_node(3), 7);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_two_examples),
        cmocka_unit_test(table_3_1),
        cmocka_unit_test(formulas_are_the_printed_ones),
        cmocka_unit_test(sets_by_direction),
        cmocka_unit_test(every_part_arrives_once),
        cmocka_unit_test(equation_3_18),
        cmocka_unit_test(cost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
