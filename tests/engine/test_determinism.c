/* The same bits everywhere: the state hash of a short, busy run of each law, for every instruction
 * set of this machine, twice in one process.
 *
 * THE RULE OF THE GOLDEN VALUES. They belong to the physics: element, law, loads, time integration,
 * and the order of operations in which these are written down. A commit may change them only when
 * it changes one of those on purpose, and says so in its message. Compiler, optimisation,
 * instruction set, order of elements and nodes in memory, and threads must not; when a value below
 * differs for such a reason, the change is wrong, not the value. */
#include "engine/engine_test.h"

static const uint64_t golden[LAR_LAW_COUNT] = {
    [LAR_LAW_neo_hookean] = 0xc3d917f242119495,
    [LAR_LAW_coupled_neo_hookean] = 0x27fd19a44597bb6b,
    [LAR_LAW_mooney_rivlin] = 0xdba8e5a1a3815d75,
};

/* 7 x 3 x 2 elements (the last block is not full), everything acts. */
static lar_model *busy_model(lar_law law) {
    brick b = {{7, 3, 2}, 0.01, 0.12, law, 2e3, 2e4, 1050};
    lar_model *model = brick_model(&b);
    static const double points[3][2] = {{0, 0}, {0.02, 1}, {0.05, -0.5}};
    int ramp = add_ramp(model, 0.03), table = add_table(model, LAR_CURVE_SMOOTH, 3, points);
    memcpy(model->gravity, (double[]){2, 1, -9.81}, 24);
    model->gravity_curve[0] = table;
    model->damping = 3;
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_Y, 0.006, table);
    press(model, 4, 120, ramp);
    load_nodes(model, single_node(brick_node(&b, 3, 3, 2)), 0.01, -0.004, 0.02, ramp);
    throw_node(model, brick_node(&b, 5, 1, 1), (double[]){0.1, -0.2, 0.3});
    model->time_step = 0.00025;
    return model;
}

static uint64_t run(const lar_model *model, lar_isa isa, const char **name) {
    lar_options options = lar_options_default();
    options.isa = isa;
    lar_simulation *simulation = start_with(model, options);
    *name = simulation->domain.kernels->name;
    advance(simulation, 500);
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return hash;
}

static bool there_is(lar_isa isa) {
    const lar_kernels *kernels;
    return lar_kernels_find(isa, &kernels, NULL) == LAR_OK;
}

static void the_hash_is_golden(void **unused) {
    (void)unused;
    static const lar_isa sets[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    int tried = 0, wrong = 0;
    for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
        if (!there_is(sets[i])) continue;
        tried++;
        for (int law = 0; law < LAR_LAW_COUNT; law++)
            for (int again = 0; again < 2; again++) {
                const char *name;
                lar_model *model = busy_model((lar_law)law);
                uint64_t hash = run(model, sets[i], &name);
                if (hash != golden[law]) {
                    print_message("%s, %s: hash %016llx\n", lar_law_name[law], name,
                                  (unsigned long long)hash);
                    wrong++;
                }
                lar_model_destroy(model);
            }
    }
    assert_true(tried > 0);
    assert_int_equal(wrong, 0);
}

/* Splitting a run in calls, and measuring between them, changes nothing. */
static void looking_does_not_change_the_run(void **unused) {
    (void)unused;
    lar_model *model = busy_model(LAR_LAW_neo_hookean);
    lar_simulation *simulation = start(model);
    for (int i = 0; i < 20; i++) {
        lar_energy energy;
        double reaction[3], stress[6];
        advance(simulation, 25);
        lar_simulation_energy(simulation, &energy);
        lar_measure_stress(&simulation->domain, &simulation->state, i, stress);
        lar_measure_reaction(&simulation->domain, &simulation->state, &model->fix[0].nodes,
                             reaction);
    }
    assert_true(lar_simulation_hash(simulation) == golden[LAR_LAW_neo_hookean]);
    finish(simulation, model);
}

/* The hash sees the last bit of one number, and the step. */
static void the_hash_sees_one_bit(void **unused) {
    (void)unused;
    lar_model *model = busy_model(LAR_LAW_neo_hookean);
    lar_simulation *simulation = start(model);
    advance(simulation, 10);
    uint64_t hash = lar_simulation_hash(simulation);
    double *u = &simulation->state.u[4 * simulation->domain.layout.local[17] + 1], was = *u;
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
        cmocka_unit_test(the_hash_is_golden),
        cmocka_unit_test(looking_does_not_change_the_run),
        cmocka_unit_test(the_hash_sees_one_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
