/* How elements are grouped into blocks and kept changes no bit: rows and boxes against the same
 * turned elements in loose general blocks, and lean blocks against whole ones, 1,000 steps, on
 * every instruction set of this machine. */
#include "engine_test.h"

#include "model/demo/demo.h"
#include "step/identity.h"

enum { STEPS = 1000 };

/* Pulled, pressed, falling and damped. */
static void add_conditions(lar_model *model, lar_node_list held, lar_node_list pulled,
                           double pull) {
    int ramp = add_ramp(model, 0.05);
    memcpy(model->gravity, (double[]){0.1, 0.2, -0.981}, 24);
    model->damping = 2;
    fix_nodes(model, held, LAR_AXIS_ALL);
    load_nodes(model, pulled, pull, -pull / 2, pull, ramp);
    press(model, -1, 30, ramp);
}

static lar_model *conditioned_brick(int nx, int ny, int nz, double shift, lar_law law) {
    brick b = {{nx, ny, nz}, 0.01, shift, law, 2e3, 2e4, 1000};
    lar_model *model = brick_model(&b);
    add_conditions(model, brick_side(&b, 0, 0), single_node(brick_node(&b, nx / 2, ny, nz)), 0.002);
    return model;
}

static lar_node_list named_nodes(const lar_mesh *mesh, const char *name) {
    const lar_set *set = lar_mesh_find_set(mesh, name, LAR_SET_NODES);
    assert_non_null(set);
    lar_node_list list = {set->count, lar_calloc((size_t)set->count, sizeof(int32_t))};
    memcpy(list.node, set->index, (size_t)set->count * sizeof(int32_t));
    return list;
}

static lar_model *organ(void) {
    lar_model *model = lar_model_create();
    assert_int_equal(lar_demo_mesh(&model->mesh, NULL), LAR_OK);
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material *material = LAR_MODEL_APPEND(model, material);
        material->law = (lar_law)law;
        material->density = 1050;
        lar_material_from_shear_bulk(material, 5e3, 5e4);
    }
    model->element_material = lar_calloc(LAR_DEMO_ELEMENTS, sizeof(int32_t));
    for (int e = 0; e < LAR_DEMO_ELEMENTS; e++)
        model->element_material[e] = model->mesh.element_tag[e] % LAR_LAW_COUNT;
    add_conditions(model, named_nodes(&model->mesh, "cervix"), named_nodes(&model->mesh, "fundus"),
                   0.0002);
    return model;
}

/* The hash at the end; *fast: elements in rows or boxes. */
static uint64_t run(const lar_model *model, lar_isa isa, lar_layout_style style, int *fast) {
    lar_options options = lar_options_default();
    options.isa = isa;
    lar_simulation simulation = {0};
    lar_error error;
    const lar_domain *domain = &simulation.domain;
    if (lar_domain_create_styled(model, &options, style, &simulation.domain, &error) ||
        lar_state_create(&simulation.state, domain->layout.node_padded, 0, &error) ||
        lar_strained_create(domain, &simulation.strained, &error) ||
        lar_interactions_create(&domain->surroundings, NULL, false, &simulation.interactions,
                                &error))
        fail_msg("%s", error.message);
    simulation.state.strained = &simulation.strained;
    if (getenv("LARIAT_BLOCKS")) assert_int_equal(domain->lean, true);
    *fast = 0;
    for (int r = 0; r < simulation.domain.run_count; r++) {
        const lar_block_run *blocks = &simulation.domain.run[r];
        if (blocks->shape == LAR_SHAPE_BOX || blocks->rows != LAR_ROWS_NONE) *fast += blocks->count;
    }
    advance(&simulation, (uint64_t)(STEPS / test_every(5)));
    uint64_t hash = lar_simulation_hash(&simulation);
    lar_interactions_destroy(&simulation.interactions);
    lar_strained_destroy(&simulation.strained);
    lar_state_destroy(&simulation.state);
    lar_domain_destroy(&simulation.domain);
    return hash;
}

static void check_model(lar_model *model) {
    static const lar_isa sets[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    uint64_t first = 0;
    lar_error error = {0};
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
    for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
        const lar_kernels *kernels;
        if (lar_kernels_find(sets[i], &kernels, NULL)) continue;
        int fast;
        uint64_t rows = run(model, sets[i], LAR_LAYOUT_ROWS, &fast);
        assert_true(fast > 0);
        uint64_t loose = run(model, sets[i], LAR_LAYOUT_LOOSE, &fast);
        assert_int_equal(fast, 0);
        setenv("LARIAT_BLOCKS", "lean", 1);
        uint64_t lean = run(model, sets[i], LAR_LAYOUT_ROWS, &fast);
        uint64_t loose_lean = run(model, sets[i], LAR_LAYOUT_LOOSE, &fast);
        unsetenv("LARIAT_BLOCKS");
        if (first == 0) first = rows;
        if (rows != first || loose != first || lean != first || loose_lean != first)
            fail_msg("%s: rows 0x%016llx, loose 0x%016llx, lean 0x%016llx, loose and lean "
                     "0x%016llx, first 0x%016llx",
                     kernels->name, (unsigned long long)rows, (unsigned long long)loose,
                     (unsigned long long)lean, (unsigned long long)loose_lean,
                     (unsigned long long)first);
    }
    lar_model_destroy(model);
}

static void the_organ(void **unused) {
    (void)unused;
    check_model(organ());
}

static void boxes(void **unused) {
    (void)unused;
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        check_model(conditioned_brick(8, 5, 3, 0, (lar_law)law));
    check_model(conditioned_brick(3, 9, 2, 0, LAR_LAW_neo_hookean)); /* turned */
    check_model(conditioned_brick(2, 3, 13, 0, LAR_LAW_neo_hookean));
}

static void crooked_elements(void **unused) {
    (void)unused;
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        check_model(conditioned_brick(9, 5, 3, 0.12, (lar_law)law));
    check_model(conditioned_brick(3, 4, 7, 0.12, LAR_LAW_neo_hookean));
}

/* What elements are asked for later, and a model that is made stiffer meanwhile. */
static void lean_elements_are_whole_ones(void **unused) {
    (void)unused;
    lar_model *model = conditioned_brick(9, 5, 3, 0.12, LAR_LAW_neo_hookean);
    lar_simulation *whole = start_with(model, lar_options_default());
    setenv("LARIAT_BLOCKS", "lean", 1);
    lar_simulation *lean = start_with(model, lar_options_default());
    lar_simulation *refused = NULL;
    setenv("LARIAT_BLOCKS", "fat", 1);
    lar_error error;
    assert_int_equal(lar_simulation_create(model, NULL, &refused, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "must be auto, lean or whole"));
    unsetenv("LARIAT_BLOCKS");
    assert_true(lean->domain.lean && !whole->domain.lean);
    assert_true(lean->domain.block_bytes < whole->domain.block_bytes);
    const lar_domain *domain = &whole->domain;
    assert_true(lar_identity(domain, &whole->state, 0) ==
                lar_identity(&lean->domain, &lean->state, 0));
    for (int32_t r = 0; r < domain->run_count; r++)
        for (int32_t b = domain->run_first[r]; b < domain->run_first[r] + domain->run[r].count; b++)
            for (int lane = 0; lane < LAR_BLOCK; lane++) {
                if (domain->layout.block[b].element[lane] < 0) continue;
                lar_hex8 a, c;
                lar_domain_element(domain, r, b, lane, &a);
                lar_domain_element(&lean->domain, r, b, lane, &c);
                assert_memory_equal(&a, &c, sizeof a);
            }
    for (int i = 0; i < 3; i++) {
        lar_simulation *both[] = {whole, lean};
        for (int k = 0; k < 2; k++) {
            assert_int_equal(lar_simulation_set_stiffness(both[k], -1, 0.5 + 0.25 * i, NULL),
                             LAR_OK);
            advance(both[k], 50);
        }
        assert_true(lar_simulation_hash(whole) == lar_simulation_hash(lean));
    }
    lar_simulation_destroy(lean);
    finish(whole, model);
}

/* More than any third level is taken to hold: lean but where one processor has the model alone and
 * is asked for many lines. */
static void large_models_are_lean_where_that_pays(void **unused) {
    (void)unused;
    unsetenv("LARIAT_BLOCKS");
    lar_model *model = conditioned_brick(52, 50, 51, 0.12, LAR_LAW_neo_hookean);
    lar_error error = {0};
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
    for (int divided = 0; divided < 2; divided++) {
        lar_options options = lar_options_default();
        options.grid = divided ? "2x1x1" : NULL;
        lar_domain domain;
        if (lar_domain_create(model, &options, &domain, &error)) fail_msg("%s", error.message);
        bool many = lar_kernels_ask_many();
        assert_int_equal(domain.lean, divided || !many);
        assert_int_equal(domain.run[0].asks, many ? LAR_ASK_MANY : LAR_ASK_FEW);
        lar_domain_destroy(&domain);
    }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_organ),
        cmocka_unit_test(boxes),
        cmocka_unit_test(crooked_elements),
        cmocka_unit_test(lean_elements_are_whole_ones),
        cmocka_unit_test(large_models_are_lean_where_that_pays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
