/* Flat elements of nearly incompressible tissue under pressure do not fold: strips that nothing
 * lets escape stay what they are when they are pressed and bear what fine ones do, kernels say what
 * the oracle says, and the bits are the same everywhere. */
#include "engine/same_bits_test.h"
#include "mechanics/fold/hex8_fold.h"
#include "step/folds.h"

static const double SHEAR = 1e4, BULK = 1e6;

/* ---- strips --------------------------------------------------------------------------------- */

enum { LAYERS = 4 };
static const double LONG = 0.02, HIGH = 0.002, SHORTER = 0.2;

/* A strip in plane strain, held above and below, of so many elements along it. */
static lar_model *strip(int along) {
    const brick b = {
        {along, 1, LAYERS}, LONG / along, 1e-3, LAR_LAW_neo_hookean, SHEAR, BULK, 1000};
    lar_model *model = brick_model(&b);
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double *x = model->mesh.position[n];
        x[2] *= HIGH / (LAYERS * b.edge);
        x[1] = b.edge * round(x[1] / b.edge);
    }
    for (int k = 0; k <= LAYERS; k++)
        fix_nodes(model, brick_side(&b, 2, k), k % LAYERS ? LAR_AXIS_Y : LAR_AXIS_Y | LAR_AXIS_X);
    fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_Z);
    move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_Z, -SHORTER * HIGH, add_ramp(model, 0.2));
    model->damping = 500;
    return model;
}

/* Its force over its length and the shear modulus, and how far nodes in the middle are from where
 * half of the way would take them, of the height of an element. */
static void press_strip(int along, double *force, double *uneven) {
    const brick b = {{along, 1, LAYERS}, LONG / along, 0, LAR_LAW_neo_hookean, SHEAR, BULK, 1000};
    lar_model *model = strip(along);
    lar_simulation *s = start(model);
    lar_node_list top = brick_side(&b, 2, -1), middle = brick_side(&b, 2, LAYERS / 2);
    balanced_after(s, 0.5);
    double *held = residual_forces(s);
    *force = *uneven = 0;
    for (int32_t i = 0; i < top.count; i++)
        *force -= held[node_at(s, top.node[i], 2)] / (SHEAR * LONG * b.edge);
    for (int32_t i = 0; i < middle.count; i++)
        *uneven = fmax(*uneven,
                       fabs(node_u(s, middle.node[i])[2] + 0.5 * SHORTER * HIGH) / (HIGH / LAYERS));
    free(held);
    free(top.node);
    free(middle.node);
    finish(s, model);
}

static void strips_stay_what_they_are(void **unused) {
    (void)unused;
    static const int along[] = {40, 16, 8, 5};
    double fine = 0;
    for (size_t i = 0; i < sizeof along / sizeof *along; i++) {
        double force, uneven;
        press_strip(along[i], &force, &uneven);
        if (i == 0) fine = force;
        print_message("%d along it: bears %.3f, uneven by %.2g of an element\n", along[i], force,
                      uneven);
        assert_below(uneven, 0.05);
        if (along[i] >= 8) assert_below(fabs(force - fine), 0.25 * fine); /* 5 : 1 and less */
    }
}

/* ---- the kernels ---------------------------------------------------------------------------- */

static void add_oracle(const lar_simulation *s, int32_t e, double (*sum)[3]) {
    const lar_mesh *mesh = &s->domain.model->mesh;
    const lar_material *material = lar_domain_material(&s->domain, e);
    double corner[8][3], u[8][3], force[8][3];
    lar_hex8 element;
    lar_mesh_corners(mesh, e, corner);
    lar_domain_corners(&s->domain, s->state.u, e, u);
    lar_hex8_prepare((const double(*)[3])corner, material, &element);
    lar_hex8_force(&element, material, (const double(*)[3])u, force);
    lar_hex8_fold_force((const double(*)[3])corner, material, (const double(*)[3])u, force);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) sum[mesh->element[e][a]][i] += force[a][i];
}

/* Of blocks in rows and out of them, boxes and others, stiffer than the model says. */
static void kernels_say_what_the_oracle_says(void **unused) {
    (void)unused;
    static const lar_isa sets[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    for (int n = 0; n < 8; n++) {
        const brick b = {{9, 3, 3}, 0.01, n / 4 ? 0.05 : 0, LAR_LAW_neo_hookean, SHEAR, BULK, 1000};
        lar_options options = lar_options_default();
        const lar_kernels *kernels;
        lar_error error;
        if (lar_kernels_find(options.isa = sets[n % 4], &kernels, NULL)) continue;
        lar_model *model = brick_model(&b);
        for (int32_t i = 0; i < model->mesh.node_count; i++) model->mesh.position[i][1] /= 3;
        lar_simulation *s = start_with(model, options);
        if (lar_simulation_set_stiffness(s, 0, 1.5, &error)) fail_msg("%s", error.message);
        advance(s, 1);
        for (int32_t i = 0; i < model->mesh.node_count; i++)
            for (int axis = 0; axis < 3; axis++)
                s->state.u[node_at(s, i, axis)] =
                    -0.01 * model->mesh.position[i][axis] +
                    0.02 * b.edge / (axis == 1 ? 3 : 1) * noise((uint32_t)(3 * i + axis));
        double(*sum)[3] = lar_calloc((size_t)model->mesh.node_count, sizeof *sum), worst = 0;
        double *force = residual_forces(s), energy = 0;
        for (int32_t e = 0; e < model->mesh.element_count; e++) {
            add_oracle(s, e, sum);
            energy += lar_folds_energy(&s->domain, &s->state, e);
        }
        for (int32_t i = 0; i < model->mesh.node_count; i++)
            for (int axis = 0; axis < 3; axis++)
                worst = fmax(worst, fabs(force[node_at(s, i, axis)] - sum[i][axis]));
        print_message("%s, %s: off by %.2g N, %.3g J of folding\n", kernels->name,
                      n / 4 ? "general" : "boxes", worst, energy);
        assert_true(energy > 0);
        assert_below(worst, 1e-12 * characteristic_force(&b));
        free(force);
        free(sum);
        finish(s, model);
    }
}

/* Bars whose elements are long, so that two of their axes are the shortest: kernels and the account
 * take the same one. */
static void long_elements_keep_the_account(void **unused) {
    (void)unused;
    for (int along = 0; along < 3; along++) {
        const brick b = {{4, 4, 4}, 0.01, 0, LAR_LAW_neo_hookean, SHEAR, BULK, 1000};
        lar_model *model = brick_model(&b);
        for (int32_t i = 0; i < model->mesh.node_count; i++) model->mesh.position[i][along] *= 3;
        const int across = (along + 1) % 3, other = (along + 2) % 3;
        fix_nodes(model, brick_side(&b, across, 0), LAR_AXIS_ALL);
        fix_nodes(model, brick_side(&b, along, 0), 1U << along);
        fix_nodes(model, brick_side(&b, along, -1), 1U << along);
        fix_nodes(model, brick_side(&b, across, -1), 1U << other);
        move_nodes(model, brick_side(&b, across, -1), 1U << across, -0.2 * 0.04,
                   add_ramp(model, 0.2));
        model->damping = 50;
        lar_simulation *s = start(model);
        lar_energy e = balanced_after(s, 0.3);
        double folding = 0;
        for (int32_t k = 0; k < model->mesh.element_count; k++)
            folding += lar_folds_energy(&s->domain, &s->state, k);
        print_message("long along %d: %.3g J of folding, %.3g J in all\n", along, folding,
                      e.strain + e.hourglass);
        assert_true(folding > 1e-4 * e.strain);
        finish(s, model);
    }
}

/* ---- the bits ------------------------------------------------------------------------------- */

/* Tools in a body that is under pressure, and flat. */
static lar_model *pressed_tool_model(const brick *b) {
    brick tight = *b;
    tight.bulk = 60 * tight.shear;
    for (int i = 0; i < 2; i++) tight.edge = b->edge;
    lar_model *model = tool_model_of(&tight);
    for (int32_t n = 0; n < model->mesh.node_count; n++) model->mesh.position[n][1] *= 0.45;
    press(model, -1, 2 * tight.shear, add_ramp(model, 0.002));
    return model;
}

static same_bits body = {pressed_tool_model,
                         LAR_TEST_BUILD "/fold.checkpoint",
                         {0xa882746e492e7d94, 0x4c7fba840905b83d}};

static void a_saved_run_goes_on(void **unused) {
    (void)unused;
    check_saved_runs(&body);
}

static void what_tools_press_would_fold(void **unused) {
    (void)unused;
    lar_model *model = body.model(&tool_brick);
    lar_simulation *s = start_with(model, setting(NULL, 0));
    int would = 0;
    act(s, 0, 20);
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        would += lar_folds_energy(&s->domain, &s->state, e) > 0;
    print_message("%d of %d elements\n", would, (int)model->mesh.element_count);
    assert_true(would > 5);
    finish(s, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_stay_what_they_are),
        cmocka_unit_test(kernels_say_what_the_oracle_says),
        cmocka_unit_test(long_elements_keep_the_account),
        SAME_BITS_TESTS(body),
        cmocka_unit_test(a_saved_run_goes_on),
        cmocka_unit_test(what_tools_press_would_fold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
