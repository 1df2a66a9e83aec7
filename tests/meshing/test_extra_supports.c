/* Extra supports carry what would sag, and nothing else gets one. */
#include "bars.h"

#include "meshing/starter/extra_supports.h"

static lar_error error;
static bool held[BAR_NODES], handle[BAR_NODES], extra[BAR_NODES], all[BAR_NODES];
static double sag[BAR_NODES];

/* Held at the left end, the right one is the handle; extra supports under it, at the lower end of
 * y. */
static lar_sag with_extra_supports(const lar_meshing *m, int32_t *extra_supports) {
    lar_sag motion;
    bool carried;
    memset(extra, 0, sizeof extra);
    bar_mark(m, 0, held);
    bar_mark(m, BAR_LENGTH, handle);
    if (lar_extra_supports_choose(m, held, 1, -1, handle, 0, extra, extra_supports, &carried,
                                  &motion, &error))
        fail_msg("%s", error.message);
    assert_true(carried);
    return motion;
}

static void a_soft_bar_is_carried(void **state) {
    (void)state;
    lar_meshing m = bar(BAR_SIDE);
    lar_sag motion, again;
    int32_t extra_supports = 0, nodes = 0;
    bar_mark(&m, 0, held);
    assert_int_equal(lar_sag_estimate(&m, held, handle, 0, &motion, sag, &error), LAR_OK);
    assert_true(sag[BAR_NODES - 1] > 0.25 * BAR_LENGTH);
    double slowest = motion.slowest;
    motion = with_extra_supports(&m, &extra_supports);
    assert_in_range(extra_supports, 1, 8);
    assert_true(motion.slowest > 2 * slowest);
    for (int n = 0; n < BAR_NODES; n++) {
        if (extra[n]) assert_true(m.mesh.position[n][1] == 0 && !held[n] && !handle[n]);
        nodes += extra[n];
        all[n] = held[n] || extra[n];
    }
    assert_in_range(nodes, 4, BAR_NODES / 10);
    assert_int_equal(lar_sag_estimate(&m, all, handle, 0, &again, sag, &error), LAR_OK);
    assert_true(again.slowest == motion.slowest && again.compliance == motion.compliance);
    for (int n = 0; n < BAR_NODES; n++) assert_true(sag[n] <= 0.15 * BAR_LENGTH);
}

/* A piece may lie in the handle as a whole: then extra supports are there, and the rest is pulled.
 */
static void the_handle_gives_way_where_it_must(void **state) {
    (void)state;
    lar_meshing m = bar(BAR_SIDE);
    lar_sag motion;
    int32_t extra_supports = 0, left = 0;
    bool carried = false;
    memset(extra, 0, sizeof extra);
    bar_mark(&m, 0, held);
    for (int n = 0; n < BAR_NODES; n++) handle[n] = !held[n];
    assert_int_equal(lar_extra_supports_choose(&m, held, 1, -1, handle, 0, extra, &extra_supports,
                                               &carried, &motion, &error),
                     LAR_OK);
    assert_true(carried && extra_supports > 0);
    for (int n = 0; n < BAR_NODES; n++) {
        assert_false(extra[n] && handle[n]);
        left += handle[n];
    }
    assert_true(left > BAR_NODES / 2);
}

static void a_stiff_bar_needs_none(void **state) {
    (void)state;
    lar_meshing m = bar(BAR_SIDE);
    int32_t extra_supports = 1;
    m.region[0].shear_modulus *= 1000;
    m.region[0].bulk_modulus *= 1000;
    with_extra_supports(&m, &extra_supports);
    assert_int_equal(extra_supports, 0);
    for (int n = 0; n < BAR_NODES; n++) assert_false(extra[n]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_soft_bar_is_carried),
        cmocka_unit_test(the_handle_gives_way_where_it_must),
        cmocka_unit_test(a_stiff_bar_needs_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
