/* FEBio decks that others have written: what is read of them, and why the rest is refused. */
#include "model/feb_deck.h"

static void read_shared(const char *name, lar_status wanted, lar_model **model, lar_error *error) {
    char path[1000];
    snprintf(path, sizeof path, "%s/data/bench/febio/%s", LAR_TEST_SHARED, name);
    FILE *file = fopen(path, "rb");
    if (!file) {
        print_message("skipped: no shared data\n");
        skip();
    }
    fclose(file);
    if (lar_feb_read(path, model, error) != wanted) fail_msg("%s: %s", name, error->message);
}

typedef struct expected_deck {
    const char *name;
    int nodes, elements, curves, law, notices;
    double duration;
    int fix_nodes[3]; /* of the three supports; 0: none */
    unsigned fix_axes[3];
    int move_nodes;
    unsigned move_axes;
    double move_by;
} expected_deck;

/* Counted in the files by other means. */
static const expected_deck expected[] = {
    {"dy01.feb", 8, 1, 3, LAR_LAW_coupled_neo_hookean, 0, 1.0, {0}, {0}, 0, 0, 0},
    {"dy02.feb",
     189,
     80,
     3,
     LAR_LAW_coupled_neo_hookean,
     0,
     16.8,
     {9, 9, 9},
     {LAR_AXIS_Z, LAR_AXIS_Y, LAR_AXIS_X},
     0,
     0,
     0},
    {"mi27.feb",
     396,
     250,
     1,
     LAR_LAW_mooney_rivlin,
     1,
     1.0,
     {36, 66, 66},
     {LAR_AXIS_X, LAR_AXIS_Y, LAR_AXIS_Z},
     36,
     LAR_AXIS_X,
     1.0},
    {"tu01.feb",
     756,
     500,
     1,
     LAR_LAW_mooney_rivlin,
     1,
     1.0,
     {72, 72, 36},
     {LAR_AXIS_Z, LAR_AXIS_Y, LAR_AXIS_X},
     36,
     LAR_AXIS_X,
     1.0},
    {"ma01.feb",
     225,
     128,
     1,
     LAR_LAW_ogden,
     1,
     1.0,
     {50, 50, 25},
     {LAR_AXIS_Z, LAR_AXIS_Y, LAR_AXIS_X},
     25,
     LAR_AXIS_X,
     1.0},
    {"ma61.feb",
     27,
     8,
     1,
     LAR_LAW_yeoh,
     2,
     1.0,
     {9, 9, 9},
     {LAR_AXIS_X, LAR_AXIS_Y, LAR_AXIS_Z},
     9,
     LAR_AXIS_Z,
     2.0},
};

static void check_deck(const expected_deck *want) {
    lar_error error = {0};
    lar_model *model = NULL;
    read_shared(want->name, LAR_OK, &model, &error);
    assert_int_equal(model->mesh.node_count, want->nodes);
    assert_int_equal(model->mesh.element_count, want->elements);
    assert_int_equal(model->curve_count, want->curves);
    assert_int_equal(model->material[0].law, want->law);
    assert_int_equal(model->notice_count, want->notices);
    assert_true(fabs(model->duration - want->duration) < 1e-9);
    assert_int_equal(model->fix_count, want->fix_nodes[0] ? 3 : 0);
    for (int i = 0; i < model->fix_count; i++) {
        assert_int_equal(model->fix[i].nodes.count, want->fix_nodes[i]);
        assert_int_equal(model->fix[i].axes, want->fix_axes[i]);
    }
    assert_int_equal(model->move_count, want->move_nodes ? 1 : 0);
    if (model->move_count) {
        assert_int_equal(model->move[0].nodes.count, want->move_nodes);
        assert_int_equal(model->move[0].axes, want->move_axes);
        assert_true(model->move[0].by == want->move_by);
    }
    lar_model_destroy(model);
}

static void test_real_decks(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) check_deck(&expected[i]);
    lar_error error = {0};
    lar_model *model = NULL;
    read_shared("dy01.feb", LAR_OK, &model, &error);
    assert_true(model->gravity[2] == -1.0 && model->gravity[0] == 0.0);
    assert_true(lar_curve_value(&model->curve[model->gravity_curve[2]], 0.3) == 1.0);
    lar_model_destroy(model);
}

static void test_real_refusals(void **state) {
    (void)state;
    static const char *const decks[][2] = {
        {"ex01.feb", "<rigid_load> of type 'rigid_force' is not read"}};
    for (int i = 0; i < 1; i++) {
        lar_error error = {0};
        lar_model *model = NULL;
        read_shared(decks[i][0], LAR_ERROR_UNSUPPORTED, &model, &error);
        if (!strstr(error.message, decks[i][1])) fail_msg("%s", error.message);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_real_decks),
        cmocka_unit_test(test_real_refusals),
    };
    return cmocka_run_group_tests_name("feb_decks", tests, NULL, NULL);
}
