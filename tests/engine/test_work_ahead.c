/* What is searched for while nobody waits changes no bit, however far it comes, and it comes to
 * something: where a small body strikes a large one, and its own nodes are much faster than those
 * of the other.
 */
#include "base/clock.h"
#include "divide/random.h"
#include "engine/body_contact_test.h"
#include "parallel/computer.h"

enum { TICKS = 300, TICK = 2 };

static lar_model *struck(void) {
    const brick large = {{6, 6, 3}, 0.01, 0, LAR_LAW_neo_hookean, 5e3, 2e4, 1000};
    const brick small = {{2, 2, 2}, 0.007, 0, LAR_LAW_neo_hookean, 2e4, 1e5, 4000};
    lar_model *model = empty_model(&large);
    add_brick(model, &large, (double[]){0, 0, 0});
    int32_t first = model->mesh.node_count;
    add_brick(model, &small, (double[]){0.021, 0.024, 0.0315});
    touch_between(model, 108);
    model->contact[0].friction = 0.2;
    fix_nodes(model, brick_side(&large, 2, 0), LAR_AXIS_ALL);
    throw_nodes(model, first, model->mesh.node_count, (double[]){0, 0, -0.7});
    return model;
}

/* So far; what lar_simulation_contact says is of the last advance. */
static uint64_t searches(const lar_simulation *simulation) {
    if (simulation->computer) return simulation->computer->contact.info.searches;
    return simulation->interactions.body_contact.info.searches;
}

/* `most`: up to so long is worked ahead between two ticks [s]. Returns how many searches were done
 * there. */
static int32_t play(const lar_model *model, const char *grid, double most, uint64_t *hash) {
    lar_options options = lar_options_default();
    options.grid = grid;
    lar_simulation *simulation = start_with(model, options);
    lar_random random = {91};
    int32_t ahead = 0;
    lar_error error;
    for (int tick = 0; tick < TICKS; tick++) {
        advance(simulation, TICK);
        double seconds = most * 1e-3 * (double)lar_random_below(&random, 1000);
        uint64_t before = searches(simulation);
        assert_int_equal(
            lar_simulation_work_ahead(simulation, lar_clock_seconds() + seconds, &error), LAR_OK);
        ahead += searches(simulation) > before;
    }
    *hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return ahead;
}

static void nothing_changes(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "2x2x2"};
    lar_model *model = struck();
    uint64_t plain, hash;
    assert_int_equal(play(model, NULL, 0, &plain), 0);
    for (int i = 0; i < 3; i++) {
        play(model, grids[i], 2e-5, &hash); /* seldom to the end */
        assert_int_equal(hash, plain);
        assert_true(play(model, grids[i], 2e-2, &hash) > 2);
        assert_int_equal(hash, plain);
    }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_changes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
