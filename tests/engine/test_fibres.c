/* Bodies with fibres: the same bits everywhere, saved and taken up, beside viscosity, on any number
 * of processors; a block that is pulled against the closed form, the step that stiff fibres ask
 * for, and the account of energy. */
#include "engine/same_bits_test.h"
#include "mechanics/stress.h"

#define PATH LAR_TEST_BUILD "/fibres.checkpoint"

/* Along a helix around the body's length, which no two elements have the same. */
static void lay_fibres(lar_model *model) {
    lar_mesh *mesh = &model->mesh;
    mesh->fibre = lar_calloc((size_t)mesh->element_count, sizeof *mesh->fibre);
    assert_non_null(mesh->fibre);
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        mesh->fibre[e][0] = 0.02;
        mesh->fibre[e][1] = -(corner[0][2] + corner[6][2]) / 2;
        mesh->fibre[e][2] = (corner[0][1] + corner[6][1]) / 2;
    }
    lar_error error;
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
}

/* Tools, supports, loads, all laws; some of these have fibres, each in another way, and one is
 * viscous as well. */
static lar_model *fibrous_tool_model(const brick *b) {
    lar_model *model = tool_model_of(b);
    lar_material *m = model->material;
    m[LAR_LAW_neo_hookean].fibre = (lar_fibre){.law = LAR_FIBRE_EXP_LINEAR,
                                               .parameter = {100, 10, 3000, 1.1},
                                               .isochoric = true,
                                               .along = 200};
    m[LAR_LAW_yeoh].fibre =
        (lar_fibre){.law = LAR_FIBRE_EXP_POW, .parameter = {500, 1, 2}, .across = 100};
    m[LAR_LAW_mooney_rivlin].fibre =
        (lar_fibre){.law = LAR_FIBRE_EXP_POW, .parameter = {2000, 0.5, 2.5}, .isochoric = true};
    m[LAR_LAW_coupled_neo_hookean].fibre =
        (lar_fibre){.law = LAR_FIBRE_EXP_LINEAR, .parameter = {50, 20, 1000, 1.05}};
    m[LAR_LAW_ogden].fibre = (lar_fibre){.along = 300};
    m[LAR_LAW_neo_hookean].viscosity =
        (lar_viscosity){.terms = 1, .isochoric = true, .rest = 1, .share = {0.6}, .time = {0.05}};
    lay_fibres(model);
    return model;
}

/* The same body, all of its fibres of the law that goes on straight. */
static lar_model *straight_tool_model(const brick *b) {
    lar_model *model = fibrous_tool_model(b);
    for (int i = 0; i < model->material_count; i++) {
        lar_fibre *fibre = &model->material[i].fibre;
        fibre->law = LAR_FIBRE_POW_LINEAR;
        fibre->isochoric = i % 2 == 0;
        const double parameter[] = {2000 + 500 * i, 1.02 + 0.03 * i, 2 + 0.4 * i, 0};
        memcpy(fibre->parameter, parameter, sizeof parameter);
    }
    lar_error error;
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
    return model;
}

/* ---- the same bits -------------------------------------------------------------------------- */

static same_bits body = {fibrous_tool_model, PATH, {0xb875749081aa8561, 0x6a985ce265ede585}};

static same_bits straight = {straight_tool_model,
                             LAR_TEST_BUILD "/straight.checkpoint",
                             {0xd5ec3be324218749, 0x056ef5bfa209a3e9}};

/* Parameters of each law beside tissue of some kilopascal. */
static const double LAWS[LAR_FIBRE_LAWS][LAR_FIBRE_PARAMETERS] = {
    [LAR_FIBRE_EXP_POW] = {300, 1, 2.5},
    [LAR_FIBRE_EXP_LINEAR] = {300, 15, 2.5, 1.1},
    [LAR_FIBRE_POW_LINEAR] = {2000, 1.03, 2.5},
    [LAR_FIBRE_HGO] = {400, 1.2, 0.15}};

/* The same turned elements in rows and boxes, and loose. */
static uint64_t styled(const lar_model *model, lar_layout_style style) {
    lar_options options = lar_options_default();
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
    advance(&simulation, 300);
    uint64_t hash = lar_simulation_hash(&simulation);
    lar_interactions_destroy(&simulation.interactions);
    lar_strained_destroy(&simulation.strained);
    lar_state_destroy(&simulation.state);
    lar_domain_destroy(&simulation.domain);
    return hash;
}

static void rows_and_loose_elements_agree(void **unused) {
    (void)unused;
    for (int crooked = 0; crooked < 2; crooked++)
        for (int law = LAR_FIBRE_EXP_POW; law < LAR_FIBRE_LAWS; law++) {
            const brick b = {{9, 5, 3}, 0.01, 0.12 * crooked, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
            lar_model *model = brick_model(&b);
            model->material[0].fibre = (lar_fibre){.law = (lar_fibre_law)law,
                                                   .isochoric = crooked || law == LAR_FIBRE_HGO,
                                                   .along = 150};
            memcpy(model->material[0].fibre.parameter, LAWS[law], sizeof LAWS[law]);
            fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
            model->gravity[2] = -9.81;
            lay_fibres(model);
            assert_true(styled(model, LAR_LAYOUT_ROWS) == styled(model, LAR_LAYOUT_LOOSE));
            lar_model_destroy(model);
        }
}

/* A body whose fibres run otherwise is another body. */
static void a_saved_run_goes_on(void **unused) {
    (void)unused;
    check_saved_runs(&body);
    lar_model *turned = fibrous_tool_model(&tool_brick);
    lar_error error;
    for (int32_t e = 0; e < turned->mesh.element_count; e++) turned->mesh.fibre[e][0] *= -1;
    lar_simulation *wrong = start_with(turned, setting(NULL, 0));
    assert_int_not_equal(lar_simulation_load(wrong, PATH, &error), LAR_OK);
    assert_non_null(strstr(error.message, "material"));
    finish(wrong, turned);
}

/* ---- against the element's own forces ------------------------------------------------------- */

/* A body at rest in a state has the forces that the plain element has: by what one step makes of
 * the velocities. */
static void kernels_agree_with_the_plain_element(void **unused) {
    (void)unused;
    lar_model *model = fibrous_tool_model(&tool_brick);
    lar_simulation *simulation = start_with(model, setting(NULL, 0));
    act(simulation, 0, 8);
    const lar_domain *domain = &simulation->domain;
    double strain = 0, hourglass;
    lar_energy energy;
    lar_simulation_energy(simulation, &energy);
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3], u[8][3], force[8][3];
        lar_hex8 hex8;
        const lar_material *material = lar_model_material_of(model, e);
        lar_mesh_corners(&model->mesh, e, corner);
        lar_domain_corners(domain, simulation->state.u, e, u);
        lar_hex8_prepare(corner, material, &hex8);
        lar_model_fibres(model, e, hex8.fibre);
        strain += lar_hex8_energy(&hex8, material, (const double(*)[3])u, &hourglass);
        lar_hex8_force(&hex8, material, (const double(*)[3])u, force);
    }
    assert_below(fabs(strain / energy.strain - 1), 0.05); /* barriers apart */
    finish(simulation, model);
}

/* ---- closed forms --------------------------------------------------------------------------- */

/* A cube pulled along x by half its length, its sides free, so slowly that it is at rest: the
 * tension is what the fibres and the law have for stretches l, t, t with no stress across. */
static void a_pulled_block_has_the_closed_form(void **unused) {
    (void)unused;
    static const double laws[LAR_FIBRE_LAWS][LAR_FIBRE_PARAMETERS] = {
        [LAR_FIBRE_EXP_POW] = {300, 0.8, 2},
        [LAR_FIBRE_EXP_LINEAR] = {200, 6, 4000, 1.2},
        [LAR_FIBRE_POW_LINEAR] = {4000, 1.15, 2.2}};
    for (int family = 0; family < 6; family++) {
        const brick b = {{2, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 1e3, 2e4, 1000};
        lar_model *model = brick_model(&b);
        lar_material *m = &model->material[0];
        int law = LAR_FIBRE_EXP_POW + family / 2;
        m->fibre = (lar_fibre){.law = (lar_fibre_law)law, .isochoric = family % 2};
        memcpy(m->fibre.parameter, laws[law], sizeof laws[law]);
        model->mesh.fibre = lar_calloc(8, sizeof *model->mesh.fibre);
        for (int e = 0; e < 8; e++) model->mesh.fibre[e][0] = 3;
        fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_X);
        fix_nodes(model, brick_side(&b, 1, 0), LAR_AXIS_Y);
        fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_Z);
        move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_X, 0.3 * 0.02, add_ramp(model, 0.05));
        model->damping = 100;
        lar_error error;
        if (lar_model_check(model, &error)) fail_msg("%s", error.message);
        lar_simulation *simulation = start(model);
        while (lar_simulation_time(simulation) < 0.6) advance(simulation, 100);
        double cauchy[6], t = 1 - 0.15, P[3][3], L = 1.3;
        lar_measure_stress(&simulation->domain, lar_simulation_state(simulation), 0, cauchy);
        const double a[3] = {1, 0, 0};
        for (int i = 0; i < 60; i++) { /* Newton: no stress across */
            double F[3][3] = {{L, 0, 0}, {0, t, 0}, {0, 0, t}}, below, h = 1e-6;
            F[1][1] = F[2][2] = t - h;
            lar_material_stress(m, a, (const double(*)[3])F, P);
            below = P[1][1];
            F[1][1] = F[2][2] = t + h;
            lar_material_stress(m, a, (const double(*)[3])F, P);
            t -= 0.5 * (P[1][1] + below) / (P[1][1] - below) * 2 * h;
        }
        const double F[3][3] = {{L, 0, 0}, {0, t, 0}, {0, 0, t}};
        lar_material_stress(m, a, F, P);
        assert_below(fabs(cauchy[0] / (P[0][0] / (t * t)) - 1), 1e-5);
        assert_below(fabs(cauchy[1]) / cauchy[0], 1e-5);
        finish(simulation, model);
    }
}

/* ---- the step ------------------------------------------------------------------------------- */

/* Fibres that are stiff at rest make the automatic step shorter; those that become stiff when they
 * are pulled make steps divide, and the body stays whole. */
static void steps_know_how_stiff_fibres_are(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(NULL, 0));
    double bare = lar_simulation_time_step(simulation);
    lar_simulation_destroy(simulation);
    for (int i = 0; i < model->material_count; i++)
        model->material[i].fibre = (lar_fibre){.law = LAR_FIBRE_EXP_POW, .parameter = {3e4, 0, 2}};
    lay_fibres(model);
    simulation = start_with(model, setting(NULL, 0));
    assert_true(lar_simulation_time_step(simulation) < 0.8 * bare);
    lar_simulation_destroy(simulation);
    for (int i = 0; i < model->material_count; i++)
        model->material[i].fibre = (lar_fibre){.law = LAR_FIBRE_EXP_POW, .parameter = {3e6, 0, 3}};
    simulation = start_with(model, setting(NULL, 0));
    int most = 1;
    for (int tick = 0; tick < 20; tick++) {
        act(simulation, tick, tick + 1);
        int parts = lar_division_of(&simulation->interactions)->parts;
        most = parts > most ? parts : most;
    }
    assert_true(most > 1);
    finish(simulation, model);
}

/* ---- energy --------------------------------------------------------------------------------- */

/* A thrown body with a load and a moved support. */
static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    static const double laws[LAR_FIBRE_LAWS][LAR_FIBRE_PARAMETERS] = {
        [LAR_FIBRE_EXP_POW] = {1500, 0.8, 2},
        [LAR_FIBRE_EXP_LINEAR] = {300, 8, 4000, 1.2},
        [LAR_FIBRE_POW_LINEAR] = {6000, 1.05, 2.2}};
    for (int family = 0; family < 6; family++) {
        int law = LAR_FIBRE_EXP_POW + family / 2;
        lar_model *model = brick_model(&soft_brick);
        static const double points[3][2] = {{0, 0}, {0.1, 1}, {0.2, 1}};
        int ramp = add_ramp(model, 0.05);
        model->material[0].fibre = (lar_fibre){.law = (lar_fibre_law)law, .isochoric = family % 2};
        memcpy(model->material[0].fibre.parameter, laws[law], sizeof laws[law]);
        fix_nodes(model, brick_side(&soft_brick, 0, 0), LAR_AXIS_ALL);
        move_nodes(model, brick_side(&soft_brick, 0, -1), LAR_AXIS_Y, 0.004,
                   add_table(model, LAR_CURVE_SMOOTH, 3, points));
        load_nodes(model, single_node(brick_node(&soft_brick, 1, 2, 2)), 0.01, 0, -0.01, ramp);
        throw_body(model, (double[]){0, 0, 0}, (double[]){0, 2, -1}, 0.05);
        lay_fibres(model);
        model->time_step = 1e-4;
        lar_simulation *simulation = start(model);
        double largest, worst = account_open(simulation, &largest);
        assert_below(worst, 2e-3 * largest);
        print_message("fibres %d: open by %.2g of %.2g J\n", family, worst, largest);
        finish(simulation, model);
    }
}

/* ---- what cannot be ------------------------------------------------------------------------- */

static void expect_refusal(lar_model *model, const char *words) {
    lar_error error;
    assert_int_not_equal(lar_model_check(model, &error), LAR_OK);
    if (!strstr(error.message, words)) fail_msg("'%s' lacks '%s'", error.message, words);
}

static void what_cannot_be_is_refused(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    lar_fibre *fibre = &model->material[0].fibre;
    *fibre = (lar_fibre){.law = LAR_FIBRE_EXP_POW, .parameter = {300, 1, 2}, .line = 7};
    expect_refusal(model, ":7: element 1 has fibres and nothing says along what");
    lay_fibres(model);
    memset(model->mesh.fibre[4], 0, sizeof *model->mesh.fibre);
    expect_refusal(model, "element 5 has fibres and their direction is 0, 0, 0");
    model->mesh.fibre[4][1] = NAN;
    expect_refusal(model, "element 5 has fibres and their direction is not finite");
    model->mesh.fibre[4][0] = model->mesh.fibre[4][1] = 1;
    fibre->parameter[2] = 1.5;
    expect_refusal(model, "beta must be between 2 and 20");
    fibre->parameter[2] = 2;
    fibre->parameter[0] = -1;
    expect_refusal(model, "ksi");
    fibre->parameter[0] = 300;
    model->material[0].viscosity =
        (lar_viscosity){.terms = 1, .isochoric = true, .rest = 1, .share = {0.6}, .time = {0.05}};
    expect_refusal(model, "only the isochoric part of the stress relaxes");
    model->material[0].viscosity.terms = 0;
    lar_options options = lar_options_default();
    options.element = LAR_ELEMENT_HEX8_FULL;
    lar_simulation *simulation = NULL;
    lar_error error;
    assert_int_not_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_OK);
    assert_non_null(strstr(error.message, "which only elements hex8 can have"));
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SAME_BITS_TESTS(body),
        SAME_BITS_TESTS(straight),
        cmocka_unit_test(rows_and_loose_elements_agree),
        cmocka_unit_test(a_saved_run_goes_on),
        cmocka_unit_test(kernels_agree_with_the_plain_element),
        cmocka_unit_test(a_pulled_block_has_the_closed_form),
        cmocka_unit_test(steps_know_how_stiff_fibres_are),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
