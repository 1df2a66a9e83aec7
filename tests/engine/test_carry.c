/* Jaws carry what they have closed on as fast as they are led, also what is much stiffer than the
 * softest tissue of the model, by which they measure how hard they may press. */
#include "engine/engine_test.h"

#include "engine/body_contact_test.h"
#include "engine/tools_test.h"

static const double rest_height = 0.06, grip_height = 0.026, lift = 0.05;

/* A stone on a slab that is held, and open jaws above it. */
static lar_model *stone_on_a_slab(double shear, int32_t *first) {
    static const brick slab = {{6, 6, 1}, 0.02, 0, LAR_LAW_neo_hookean, 2e4, 2e5, 1000};
    const brick stone = {{4, 4, 4}, 0.004, 0, LAR_LAW_neo_hookean, shear, 10 * shear, 2000};
    lar_model *model = empty_model(&slab);
    add_brick(model, &slab, (double[]){-0.06, -0.06, -0.02});
    const int32_t elements = model->mesh.element_count;
    fix_nodes(model, brick_side(&slab, 2, -1), LAR_AXIS_ALL);
    fix_nodes(model, brick_side(&slab, 2, 0), LAR_AXIS_ALL);
    lar_material *material = LAR_MODEL_APPEND(model, material);
    *material = model->material[0];
    material->name = NULL;
    material->density = stone.density;
    lar_material_from_shear_bulk(material, stone.shear, stone.bulk);
    *first = add_brick(model, &stone, (double[]){-0.008, -0.008, 0});
    for (int32_t e = elements; e < model->mesh.element_count; e++) model->element_material[e] = 1;
    touch_between(model, elements);
    model->contact[0].friction = 0.4;
    model->gravity[2] = -9.81;
    model->damping = 2;
    add_tool(model, "jaws", LAR_TOOL_GRASPER, 0, 0, rest_height);
    lar_tool *jaws = &model->tool[0];
    jaws->radius = 0.003;
    jaws->length = 0.02;
    jaws->spread = 2.27;
    jaws->friction = 0.4;
    return model;
}

/* Within so many seconds. */
static void lead(lar_simulation *s, double z, double opening, double seconds) {
    const uint64_t steps = (uint64_t)(seconds / lar_simulation_time_step(s));
    place_tool(s, 0, 0, 0, z, opening, steps);
    advance(s, steps);
}

/* What is seen of a tool on its way is what it feels: its speed counts where a way has just come to
 * its end and the next one is not decided. */
static void check_seen(lar_simulation *s, int32_t nodes) {
    enum { LOOKS = 100, STEPS = 7 };
    double(*force)[3] = lar_calloc((size_t)nodes, sizeof *force), seen = 0, felt = 0;
    for (int k = 0; k < LOOKS; k++) {
        lar_tool_force mean;
        advance(s, STEPS);
        assert_int_equal(lar_simulation_tool_force(s, 0, &mean, NULL), LAR_OK);
        assert_int_equal(lar_simulation_nodal_forces(s, LAR_CAUSE_TOOL, 0, force, NULL), LAR_OK);
        felt += mean.force[2] / LOOKS;
        for (int32_t n = 0; n < nodes; n++) seen -= force[n][2] / LOOKS;
    }
    print_message("feels %.4f N, seen are %.4f\n", felt, seen);
    assert_below(fabs(seen - felt), 0.05); /* some tenths of a newton before */
    free(force);
}

static void jaws_carry_a_stone(void **unused) {
    (void)unused;
    static const double shear[] = {2e4, 2e5};
    for (int i = 0; i < 2; i++) {
        int32_t first;
        lar_model *model = stone_on_a_slab(shear[i], &first);
        lar_simulation *s = start(model);
        lead(s, grip_height, 1, 0.3);
        lead(s, grip_height, 0, 0.3);
        lead(s, grip_height + lift, 0, 0.5);
        place_tool(s, 0, 0, 0, grip_height + lift + 0.02, 0, 2000);
        advance(s, 600);
        check_seen(s, model->mesh.node_count);
        lead(s, grip_height + lift, 0, 0.3);
        lar_tool_pose pose;
        assert_int_equal(lar_simulation_tool_pose(s, 0, &pose, NULL), LAR_OK);
        const double up = node_u(s, first)[2], behind = grip_height + lift - pose.position[2];
        print_message("%g Pa: jaws are %.1f mm behind, the stone is %.1f mm up\n", shear[i],
                      1e3 * behind, 1e3 * up);
        assert_below(behind, 0.001); /* 40 mm with the stiff one before */
        assert_below(fabs(up - lift), 0.1 * lift);
        finish(s, model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jaws_carry_a_stone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
