/* The same bits everywhere: the state hash of a short, busy run, for every instruction set of this
 * machine, twice in one process.
 *
 * THE RULE OF THE GOLDEN VALUES. They belong to the physics: element, law, loads, time integration,
 * and the order of operations in which these are written down. A commit may change them only when
 * it changes one of those on purpose, and says so in its message. Compiler, optimisation,
 * instruction set, order of elements and nodes in memory, and threads must not; when a value below
 * differs for such a reason, the change is wrong, not the value.
 *
 * How elements are threaded into rows is a matter of speed and may change at any time, yet an
 * element in a row is turned, and its turn decides the last bits of its forces. The golden bodies
 * are therefore 2 x 2 x 2 elements: no row has three, nothing is turned (which is checked). Where
 * rows do form, in longer bricks and in the demonstration organ, what is asked for is only that all
 * instruction sets agree. */
#include "engine/engine_test.h"

enum { GENERAL, BOXES, SHAPES };

static const uint64_t golden[SHAPES][LAR_LAW_COUNT] = {
    [GENERAL] = {[LAR_LAW_neo_hookean] = 0xc44935768235c0a1,
                 [LAR_LAW_coupled_neo_hookean] = 0xc779a3c71db8f4c3,
                 [LAR_LAW_mooney_rivlin] = 0x02059b055efc0463,
                 [LAR_LAW_yeoh] = 0xcc6a85697a65a356,
                 [LAR_LAW_arruda_boyce] = 0xf5e5865d968e908c,
                 [LAR_LAW_veronda_westmann] = 0x057a813394ce0a82,
                 [LAR_LAW_holmes_mow] = 0xeaeb9dac86fd3005,
                 [LAR_LAW_ogden] = 0x27483b650776d4ec},
    [BOXES] = {[LAR_LAW_neo_hookean] = 0x920861e432d6a501,
               [LAR_LAW_coupled_neo_hookean] = 0x1869882bfd8a6e24,
               [LAR_LAW_mooney_rivlin] = 0x98460c2c92002b58,
               [LAR_LAW_yeoh] = 0x10b1c3e6b688b146,
               [LAR_LAW_arruda_boyce] = 0x815b8224c7f35164,
               [LAR_LAW_veronda_westmann] = 0xef9c63b52233378c,
               [LAR_LAW_holmes_mow] = 0xfabff7a16433f1ae,
               [LAR_LAW_ogden] = 0x49d0a568bb0681c2},
};

static const lar_isa sets[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
enum { SETS = sizeof sets / sizeof sets[0] };

/* A brick on which everything acts: supports, motion, pressure, load, weight, damping, a throw. */
static lar_model *busy_model(lar_law law, int shape, int x, int y, int z) {
    brick b = {{x, y, z}, 0.01, shape == BOXES ? 0 : 0.12, law, 2e3, 2e4, 1050};
    lar_model *model = brick_model(&b);
    static const double points[3][2] = {{0, 0}, {0.02, 1}, {0.05, -0.5}};
    int ramp = add_ramp(model, 0.03), table = add_table(model, LAR_CURVE_SMOOTH, 3, points);
    memcpy(model->gravity, (double[]){2, 1, -9.81}, 24);
    model->gravity_curve[0] = table;
    model->damping = 3;
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_Y, 0.006, table);
    press(model, 4, 120, ramp);
    load_nodes(model, single_node(brick_node(&b, 2, y, z)), 0.01, -0.004, 0.02, add_ramp(model, 0));
    throw_node(model, brick_node(&b, x - 1, 1, 1), (double[]){0.1, -0.2, 0.3});
    model->time_step = 0.00025;
    return model;
}

static lar_model *golden_model(lar_law law, int shape) {
    return busy_model(law, shape, 2, 2, 2);
}

enum { STEPS = 500, FEW_STEPS = 120 };

static uint64_t run(const lar_model *model, lar_isa isa, uint64_t steps, const char **name) {
    lar_options options = lar_options_default();
    options.isa = isa;
    lar_simulation *simulation = start_with(model, options);
    *name = simulation->domain.kernels->name;
    advance(simulation, steps);
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return hash;
}

static bool there_is(lar_isa isa) {
    const lar_kernels *kernels;
    return lar_kernels_find(isa, &kernels, NULL) == LAR_OK;
}

/* No element of a golden body is turned or part of a row. */
static void check_layout(const lar_model *model) {
    lar_layout layout;
    assert_int_equal(lar_layout_create(model, &layout, NULL), LAR_OK);
    assert_memory_equal(layout.corner, model->mesh.element,
                        (size_t)model->mesh.element_count * sizeof *layout.corner);
    for (int32_t b = 0; b < layout.block_count; b++)
        assert_int_equal(layout.block[b].rows, LAR_ROWS_NONE);
    lar_layout_destroy(&layout);
}

static int count_wrong(lar_law law, int shape, lar_isa isa) {
    int wrong = 0;
    lar_model *model = golden_model(law, shape);
    check_layout(model);
    for (int again = 0; again < 2; again++) {
        const char *name;
        uint64_t hash = run(model, isa, STEPS, &name);
        if (hash == golden[shape][law]) continue;
        print_message("%s, %s, %s: hash 0x%016llx\n", lar_law_name[law],
                      shape == BOXES ? "boxes" : "general", name, (unsigned long long)hash);
        wrong++;
    }
    lar_model_destroy(model);
    return wrong;
}

static void the_hash_is_golden(void **unused) {
    (void)unused;
    int tried = 0, wrong = 0;
    for (int i = 0; i < SETS; i++) {
        if (!there_is(sets[i])) continue;
        tried++;
        for (int law = 0; law < LAR_LAW_COUNT; law++)
            for (int shape = 0; shape < SHAPES; shape++)
                wrong += count_wrong((lar_law)law, shape, sets[i]);
    }
    assert_true(tried > 0);
    assert_int_equal(wrong, 0);
}

/* Every instruction set of this machine finds the bits of the plain C kernels. */
static void all_sets_agree(const lar_model *model, const char *what) {
    const char *name;
    uint64_t plain = run(model, LAR_ISA_C, FEW_STEPS, &name);
    for (int i = 1; i < SETS; i++) {
        if (!there_is(sets[i])) continue;
        if (run(model, sets[i], FEW_STEPS, &name) != plain)
            fail_msg("%s: %s differs from c", what, name);
    }
}

/* Rows of eight and of four, loose elements, a last block that is not full. */
static void bricks_agree(void **unused) {
    (void)unused;
    static const int cells[3][3] = {{7, 3, 2}, {13, 5, 4}, {4, 17, 8}};
    for (int i = 0; i < 3; i++)
        for (int law = 0; law < LAR_LAW_COUNT; law++)
            for (int shape = 0; shape < SHAPES; shape++) {
                lar_model *model =
                    busy_model((lar_law)law, shape, cells[i][0], cells[i][1], cells[i][2]);
                all_sets_agree(model, lar_law_name[law]);
                lar_model_destroy(model);
            }
}

static void the_organ_agrees(void **unused) {
    (void)unused;
    char folder[512], path[600];
    lar_model *model = NULL;
    lar_error error;
    snprintf(folder, sizeof folder, "%s/determinism", LAR_TEST_BUILD);
    if (lar_demo_write(folder, &error)) fail_msg("%s", error.message);
    snprintf(path, sizeof path, "%s/uterus.yaml", folder);
    if (lar_model_open(path, &model, &error)) fail_msg("%s", error.message);
    throw_body(model, (double[]){0.1, 0.2, -0.1}, (double[]){2, -3, 1}, 0.02);
    all_sets_agree(model, "the demonstration organ");
    lar_model_destroy(model);
}

/* Splitting a run in calls, and measuring between them, changes nothing. */
static void looking_does_not_change_the_run(void **unused) {
    (void)unused;
    const char *name;
    lar_model *model = busy_model(LAR_LAW_neo_hookean, GENERAL, 7, 3, 2);
    lar_simulation *simulation = start(model);
    for (int i = 0; i < 20; i++) {
        lar_energy energy;
        double reaction[3], stress[6];
        advance(simulation, 25);
        lar_simulation_energy(simulation, &energy);
        lar_measure_stress(&simulation->domain, &simulation->state, i, stress);
        lar_measure_reaction(&simulation->domain, &simulation->scratch->measure, &simulation->state,
                             &model->fix[0].nodes, false, NULL, reaction, NULL);
    }
    assert_true(lar_simulation_hash(simulation) == run(model, LAR_ISA_AUTO, STEPS, &name));
    finish(simulation, model);
}

/* The hash sees the last bit of one number, and the step. */
static void the_hash_sees_one_bit(void **unused) {
    (void)unused;
    lar_model *model = golden_model(LAR_LAW_neo_hookean, GENERAL);
    lar_simulation *simulation = start(model);
    advance(simulation, 10);
    uint64_t hash = lar_simulation_hash(simulation);
    double *u = &simulation->state.u[node_at(simulation, 17, 1)], was = *u;
    *u = nextafter(was, 1);
    assert_true(lar_simulation_hash(simulation) != hash);
    *u = was;
    assert_true(lar_simulation_hash(simulation) == hash);
    simulation->state.step++;
    assert_true(lar_simulation_hash(simulation) != hash);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_hash_is_golden),    cmocka_unit_test(bricks_agree),
        cmocka_unit_test(the_organ_agrees),      cmocka_unit_test(looking_does_not_change_the_run),
        cmocka_unit_test(the_hash_sees_one_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
