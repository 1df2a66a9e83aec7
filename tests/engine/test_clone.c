/* Clones: the same bits as the first simulation from there on, whatever is compiled of the model;
 * independent of it in all that can change; destroyed in any order. */
#include <pthread.h>

#include "engine/body_contact_test.h"
#include "engine/engine_test.h"
#include "engine/tools_test.h"

static lar_simulation *clone_of(lar_simulation *simulation) {
    lar_simulation *clone = NULL;
    lar_error error;
    if (lar_simulation_clone(simulation, &clone, &error)) fail_msg("%s", error.message);
    return clone;
}

/* Fibres, active with waves, and viscosity besides tools, all laws, supports and loads. */
static lar_model *full_model(void) {
    lar_model *model = tool_model();
    lar_mesh *mesh = &model->mesh;
    mesh->fibre = lar_calloc((size_t)mesh->element_count, sizeof *mesh->fibre);
    for (lar_gid e = 0; e < mesh->element_count; e++) mesh->fibre[e][0] = 1;
    lar_material *soft = &model->material[LAR_LAW_neo_hookean];
    soft->viscosity = (lar_viscosity){
        .terms = 2, .isochoric = true, .rest = 1, .share = {0.5, 0.3}, .time = {0.01, 0.05}};
    soft->fibre = (lar_fibre){.law = LAR_FIBRE_EXP_LINEAR,
                              .parameter = {100, 10, 3000, 1.1},
                              .isochoric = true,
                              .along = 200};
    soft->activation.wave =
        (lar_wave){.speed = 0.5, .direction = {1, 0, 0}, .length = 0.02, .every = 0.1};
    model->material[LAR_LAW_yeoh].viscosity =
        (lar_viscosity){.terms = 1, .rest = 1, .share = {0.4}, .time = {0.02}};
    return model;
}

static lar_options with_tools(void) {
    lar_options options = lar_options_default();
    options.hands = 1;
    options.spares = 2;
    return options;
}

static void add_ball(lar_simulation *simulation) {
    lar_error error;
    lar_tool_info wanted = {.shape = LAR_TOOL_SPHERE, .radius = 0.01};
    if (lar_simulation_add_tool(simulation, &wanted, NULL, &error)) fail_msg("%s", error.message);
}

static void stiffen(lar_simulation *simulation, double factor) {
    lar_error error;
    if (lar_simulation_set_stiffness(simulation, -1, factor, &error)) fail_msg("%s", error.message);
}

static lar_tool_force force_on(const lar_simulation *simulation, int32_t tool) {
    lar_tool_force force;
    assert_int_equal(lar_simulation_tool_force(simulation, tool, &force, NULL), LAR_OK);
    return force;
}

/* Both from where the first one is, through the same; the first one is destroyed on the way. */
static void goes_on_alike(lar_simulation *first, int from, int to) {
    lar_simulation *clone = clone_of(first), *again = clone_of(clone);
    assert_int_equal(lar_simulation_hash(clone), lar_simulation_hash(first));
    assert_int_equal(lar_simulation_steps(clone), lar_simulation_steps(first));
    for (int32_t t = 0; t < lar_simulation_tool_count(first); t++) {
        lar_tool_force a = force_on(first, t), b = force_on(clone, t);
        lar_tool_info one, other;
        assert_memory_equal(&a, &b, sizeof a);
        assert_int_equal(lar_simulation_tool(first, t, &one, NULL), LAR_OK);
        assert_int_equal(lar_simulation_tool(clone, t, &other, NULL), LAR_OK);
        assert_string_equal(one.name, other.name);
        assert_true(one.radius == other.radius);
    }
    act(first, from, to);
    uint64_t hash = lar_simulation_hash(first);
    lar_energy energy, same;
    lar_simulation_energy(first, &energy);
    lar_simulation_destroy(first);
    act(clone, from, to);
    lar_simulation_energy(clone, &same);
    assert_int_equal(lar_simulation_hash(clone), hash);
    assert_memory_equal(&same, &energy, sizeof energy);
    lar_simulation_destroy(clone);
    act(again, from, to);
    assert_int_equal(lar_simulation_hash(again), hash);
    lar_simulation_destroy(again);
}

static void goes_on_with_the_same_bits(void **unused) {
    (void)unused;
    lar_model *model = full_model();
    for (int kind = 0; kind < 5; kind++) {
        lar_options options = with_tools();
        options.element = kind == 3   ? LAR_ELEMENT_HEX8_FULL
                          : kind == 4 ? LAR_ELEMENT_HEX8_MATRIX
                                      : LAR_ELEMENT_HEX8;
        options.search_always = kind == 2;
        if (kind > 2) model->mesh.fibre = (free(model->mesh.fibre), NULL);
        if (kind > 2)
            for (int i = 0; i < model->material_count; i++) {
                model->material[i].viscosity = (lar_viscosity){0};
                model->material[i].fibre = (lar_fibre){0};
                model->material[i].activation = (lar_activation){0};
            }
        lar_simulation *first = start_with(model, options);
        if (kind == 1) stiffen(first, 1.7);
        if (kind == 1) add_ball(first);
        if (kind != 2) act(first, 0, 9);
        goes_on_alike(first, kind == 2 ? 0 : 9, 16);
    }
    lar_model_destroy(model);
}

/* Bodies in contact that rub: what nodes hold on to is state, and lies behind viscous elements'. */
static void bodies_that_rub(void **unused) {
    (void)unused;
    static const brick slab = {{6, 4, 2}, 0.012, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000},
                       block = {{3, 3, 2}, 0.01, 0, LAR_LAW_yeoh, 2e3, 2e4, 1000};
    lar_model *model = two_bricks(&slab, &block, 1e-3, true);
    model->contact[0].friction = 0.3;
    model->gravity[0] = 2;
    model->gravity[2] = -9.81;
    model->material[0].viscosity =
        (lar_viscosity){.terms = 1, .rest = 1, .share = {0.5}, .time = {0.02}};
    lar_simulation *first = start(model);
    advance(first, 600);
    lar_contact_info contact;
    lar_simulation_contact(first, &contact);
    assert_true(contact.touching > 0);
    lar_simulation *clone = clone_of(first);
    advance(first, 400);
    uint64_t hash = lar_simulation_hash(first);
    lar_simulation_destroy(first);
    advance(clone, 400);
    assert_int_equal(lar_simulation_hash(clone), hash);
    finish(clone, model);
}

static void what_is_changed_in_one_is_not_in_the_other(void **unused) {
    (void)unused;
    lar_model *model = full_model();
    lar_simulation *alone = start_with(model, with_tools()), *first, *clone;
    first = start_with(model, with_tools());
    act(alone, 0, 12);
    act(first, 0, 6);
    clone = clone_of(first);
    lar_error error;
    stiffen(clone, 0.4);
    add_ball(clone);
    assert_int_equal(lar_simulation_activate(clone, -1, 0.2, &error), LAR_OK);
    assert_int_equal(lar_simulation_set_gravity(clone, (double[]){0, 0, 3}, &error), LAR_OK);
    act(clone, 6, 12);
    act(first, 6, 12);
    assert_int_equal(lar_simulation_hash(first), lar_simulation_hash(alone));
    assert_int_not_equal(lar_simulation_hash(clone), lar_simulation_hash(alone));
    assert_true(lar_simulation_stiffness(first, 0) == 1);
    /* Back at the start a clone is what a new one is. */
    assert_int_equal(lar_simulation_reset(clone, &error), LAR_OK);
    assert_int_equal(lar_simulation_remove_tool(clone, TEST_TOOLS, &error), LAR_OK);
    act(clone, 0, 12);
    assert_int_equal(lar_simulation_hash(clone), lar_simulation_hash(alone));
    lar_simulation_destroy(alone);
    lar_simulation_destroy(first);
    finish(clone, model);
}

static void *run(void *context) {
    act(context, 0, 10);
    stiffen(context, 1.3);
    act(context, 10, 16);
    return NULL;
}

static void clones_compute_in_threads_of_their_own(void **unused) {
    (void)unused;
    enum { CLONES = 4 };
    lar_model *model = full_model();
    lar_simulation *first = start_with(model, with_tools()), *clone[CLONES];
    pthread_t thread[CLONES];
    for (int i = 0; i < CLONES; i++) clone[i] = clone_of(first);
    for (int i = 0; i < CLONES; i++)
        assert_int_equal(pthread_create(&thread[i], NULL, run, clone[i]), 0);
    run(first);
    for (int i = 0; i < CLONES; i++) {
        pthread_join(thread[i], NULL);
        assert_int_equal(lar_simulation_hash(clone[i]), lar_simulation_hash(first));
        lar_simulation_destroy(clone[i]);
    }
    finish(first, model);
}

/* A grid of one processor with one thread is one whole: its clone has the same bits. */
static void one_processor_clones(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_options options = with_tools();
    lar_error error;
    options.grid = "1x1x1";
    options.threads = 1;
    lar_simulation *divided = start_with(model, options);
    assert_int_equal(lar_simulation_advance(divided, 50, &error), LAR_OK);
    lar_simulation *clone = clone_of(divided);
    assert_int_equal(lar_simulation_hash(clone), lar_simulation_hash(divided));
    assert_int_equal(lar_simulation_advance(clone, 50, &error), LAR_OK);
    assert_int_equal(lar_simulation_advance(divided, 50, &error), LAR_OK);
    assert_int_equal(lar_simulation_hash(clone), lar_simulation_hash(divided));
    lar_simulation_destroy(clone);
    finish(divided, model);
}

static void what_cannot_be_cloned(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_error error;
    lar_simulation *clone = NULL;
    for (int i = 0; i < 2; i++) {
        lar_options options = with_tools();
        options.grid = i ? NULL : "2x1x1";
        options.threads = i ? 2 : 0;
        lar_simulation *divided = start_with(model, options);
        assert_int_equal(lar_simulation_clone(divided, &clone, &error), LAR_ERROR_UNSUPPORTED);
        assert_non_null(strstr(error.message, "lar_simulation_load_from"));
        lar_simulation_destroy(divided);
    }
    lar_simulation *simulation = start_with(model, with_tools());
    for (int32_t n = 100; n < 180; n++)
        assert_int_equal(lar_simulation_set_force(simulation, n, (double[]){0, 0, 20}, &error),
                         LAR_OK);
    assert_int_equal(lar_simulation_advance(simulation, 5000, &error), LAR_ERROR_UNSTABLE);
    assert_int_equal(lar_simulation_clone(simulation, &clone, &error), LAR_ERROR_UNSTABLE);
    assert_int_equal(lar_simulation_clone(simulation, NULL, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_clone(NULL, &clone, &error), LAR_ERROR_ARGUMENT);
    assert_null(clone);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(goes_on_with_the_same_bits),
        cmocka_unit_test(bodies_that_rub),
        cmocka_unit_test(what_is_changed_in_one_is_not_in_the_other),
        cmocka_unit_test(clones_compute_in_threads_of_their_own),
        cmocka_unit_test(one_processor_clones),
        cmocka_unit_test(what_cannot_be_cloned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
