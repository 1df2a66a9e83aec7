/* Going back to states in memory again and again with bodies that touch: the list of the last
 * search is kept where it still holds (contact/body_contact_whole.c), and the bits are those of a
 * search in every step. */
#include "engine/body_contact_test.h"

enum { STATES = 4, TRIES = 60 };

static lar_model *falling(void) {
    const brick lower = {{5, 5, 2}, 0.01, 0.05, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};
    const brick upper = {{2, 2, 2}, 0.01, 0.05, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = two_bricks(&lower, &upper, 0.002, true);
    model->gravity[2] = -9.81;
    throw_nodes(model, 108, model->mesh.node_count, (double[]){0.3, 0, -0.8});
    return model;
}

/* States at several moments, from before the bodies meet on; then back to one of them, some steps,
 * back to another one. The hashes after these, and in how many tries nothing was searched. */
static int wander(const lar_model *model, int always, uint64_t hash[TRIES]) {
    lar_options options = lar_options_default();
    lar_saved *saved[STATES];
    options.search_always = always;
    lar_simulation *simulation = start_with(model, options);
    lar_contact_info info;
    uint64_t touching = 0;
    int without = 0;
    for (int k = 0; k < STATES; k++) {
        advance(simulation, k == 0 ? 3 : 70);
        assert_int_equal(lar_saved_create(simulation, &saved[k], NULL), LAR_OK);
        assert_int_equal(lar_simulation_save_to(simulation, saved[k], NULL), LAR_OK);
    }
    for (int i = 0; i < TRIES; i++) {
        /* Mostly near the last one, sometimes far from it; stretches of one step and of many. */
        int k = i % 10 < 7 ? i / 20 : (i * 7) % STATES;
        assert_int_equal(lar_simulation_load_from(simulation, saved[k], NULL), LAR_OK);
        advance(simulation, i % 4 == 3 ? 90 : 1 + (uint64_t)i % 5);
        lar_simulation_contact(simulation, &info);
        without += info.searches == 0;
        touching += (uint64_t)info.touching;
        hash[i] = lar_simulation_hash(simulation);
    }
    for (int k = 0; k < STATES; k++) lar_saved_destroy(saved[k]);
    lar_simulation_destroy(simulation);
    assert_true(touching > 100);
    return without;
}

static void the_bits_are_those_of_a_search_in_every_step(void **unused) {
    (void)unused;
    uint64_t wanted[TRIES], found[TRIES];
    for (int self = 0; self < 2; self++) {
        lar_model *model = falling();
        if (self) touch_self(model);
        assert_int_equal(wander(model, 1, wanted), 0);
        int without = wander(model, 0, found);
        print_message("no search in %d of %d tries\n", without, TRIES);
        assert_true(without > 10);
        for (int i = 0; i < TRIES; i++)
            if (found[i] != wanted[i]) fail_msg("try %d differs", i);
        lar_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bits_are_those_of_a_search_in_every_step)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
