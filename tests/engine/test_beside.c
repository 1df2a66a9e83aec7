/* Blocks beside each other, side in line with side, as a program that lays them on a grid has them:
 * while nothing moves nothing is looked at, although their nodes are in the planes of the others'
 * sides; and what is not looked at changes no bit. */
#include "engine/body_contact_test.h"

/* 2 x 2 x 2 blocks of n x n x n elements, 0.6 of an element apart, their nodes shifted by up to
 * `shift` of an element. */
static lar_model *blocks(int n, double shift) {
    const brick block = {{n, n, n}, 0.01, 0, LAR_LAW_neo_hookean, 5e3, 5e4, 1000};
    const double apart = (n + 0.6) * block.edge;
    lar_model *model = empty_model(&block);
    for (int b = 0; b < 8; b++)
        add_brick(model, &block,
                  (double[]){apart * (b & 1), apart * (b >> 1 & 1), apart * (b >> 2)});
    uint32_t seed = 7;
    for (int32_t i = 0; i < model->mesh.node_count; i++)
        for (int k = 0; k < 3; k++)
            model->mesh.position[i][k] += shift * block.edge * noise(seed++);
    touch_self(model);
    return model;
}

static void at_rest_nothing_is_looked_at(void **state) {
    (void)state;
    for (int n = 1; n <= 3; n++) {
        lar_model *model = blocks(n, 0);
        lar_simulation *s = start(model);
        lar_contact_info early, late;
        advance(s, 20);
        lar_simulation_contact(s, &early);
        advance(s, 1000);
        lar_simulation_contact(s, &late);
        print_message("blocks of %d: %d pairs looked at in the first steps, %d in 1000 more\n", n,
                      (int)early.tested, (int)(late.tested - early.tested));
        assert_true(early.tested > 0 && late.tested == early.tested);
        finish(s, model);
    }
}

static uint64_t hash_of(lar_model *model, int always, uint64_t *tested) {
    lar_options options = lar_options_default();
    options.search_always = always;
    lar_simulation *s = start_with(model, options);
    lar_contact_info info;
    uint64_t hash = 0;
    for (int i = 0; i < 20; i++) {
        advance(s, 20);
        hash = lar_hash_word(hash, lar_simulation_hash(s));
    }
    lar_simulation_contact(s, &info);
    *tested = info.tested;
    lar_simulation_destroy(s);
    return hash;
}

/* Slowly, so that they are beside each other for long, and some of them turning. */
static void prediction_changes_no_bit(void **state) {
    (void)state;
    uint32_t seed = 11;
    for (int i = 0; i < 6; i++) {
        lar_model *model = blocks(1 + i % 2, i % 3 == 2 ? 0.1 : 0);
        int32_t each = model->mesh.node_count / 8;
        double fast = i == 3 ? 0.5 : 0.04;
        for (int b = 0; b < 8; b++) {
            double v[3], more[3] = {0};
            for (int k = 0; k < 3; k++) v[k] = fast * noise(seed++);
            if (i % 2) more[b % 3] = 0.5 * fast;
            throw_nodes(model, b * each, (b + 1) * each, v);
            for (int k = 0; k < 3; k++) v[k] += more[k];
            throw_nodes(model, b * each, b * each + each / 2, v);
        }
        uint64_t some, all, hash = hash_of(model, 0, &some), other = hash_of(model, 1, &all);
        print_message("%2d: %9d pairs looked at instead of %9d\n", i, (int)some, (int)all);
        assert_true(hash == other);
        lar_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(at_rest_nothing_is_looked_at),
        cmocka_unit_test(prediction_changes_no_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
