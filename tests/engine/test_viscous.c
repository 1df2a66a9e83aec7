/* Viscous bodies: the same bits everywhere, what they remember in checkpoints, copies and on any
 * number of processors; stress against closed forms, and the account of energy. */
#include "engine/same_bits_test.h"
#include "step/viscous_history.h"

#define PATH LAR_TEST_BUILD "/viscous.checkpoint"

static void make_viscous(lar_material *material, bool isochoric, int terms) {
    static const double share[LAR_VISCOUS_TERMS] = {0.6, 0.9, 0.3, 0.2, 0.4, 0.1},
                        time[LAR_VISCOUS_TERMS] = {0.05, 0.008, 0.4, 0.02, 0.1, 2};
    material->viscosity = (lar_viscosity){.terms = terms, .isochoric = isochoric, .rest = 1};
    memcpy(material->viscosity.share, share, sizeof share);
    memcpy(material->viscosity.time, time, sizeof time);
}

/* Tools, supports, loads, all laws; some of these are viscous, each in another way. */
static lar_model *viscous_tool_model(const brick *b) {
    lar_model *model = tool_model_of(b);
    make_viscous(&model->material[LAR_LAW_neo_hookean], true, 2);
    make_viscous(&model->material[LAR_LAW_yeoh], false, 3);
    make_viscous(&model->material[LAR_LAW_holmes_mow], false, 1);
    make_viscous(&model->material[LAR_LAW_ogden], true, 1);
    return model;
}

/* ---- the same bits -------------------------------------------------------------------------- */

static same_bits body = {viscous_tool_model, PATH, {0x268fe108c24f82ec, 0xb3fb3476070d1ce8}};

static void a_saved_run_goes_on(void **unused) {
    (void)unused;
    check_saved_runs(&body);
}

/* A model in which nothing is viscous has nothing of it. */
static void elastic_models_have_no_history(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(NULL, 0));
    assert_null(simulation->domain.relaxing);
    assert_null(simulation->domain.element_history);
    assert_null(simulation->state.history);
    assert_int_equal(lar_viscous_total(&simulation->domain), 0);
    finish(simulation, model);
}

/* Crushed until no step bears it: stress that only what is remembered takes beyond the limits ends
 * the run as any other does, at the same step, by the same element. (It went on with the forces of
 * some blocks twice.) */
static lar_model *crushed_model(double force) {
    static const brick b = {{3, 3, 3}, 0.0015, 0.1, LAR_LAW_holmes_mow, 1e3, 2e3, 1000};
    static const double points[2][2] = {{0, 0}, {0.003, 1}};
    lar_model *model = brick_model(&b);
    lar_material *material = &model->material[0];
    material->parameter[0] = 2e3;
    material->parameter[1] = 1.6e4;
    material->parameter[2] = 0.3;
    make_viscous(material, false, 1);
    fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
    load_nodes(model, brick_side(&b, 2, -1), 0.6 * force, -0.3 * force, -force,
               add_table(model, LAR_CURVE_LINEAR, 2, points));
    return model;
}

static void what_is_beyond_its_limits_stops_everywhere(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "1x2x1", "1x1x3"};
    int stopped = 0;
    for (double force = 0.004; force < 0.2; force *= 1.3) {
        lar_model *model = crushed_model(force);
        lar_error first = {0};
        uint64_t hash = 0;
        for (int i = 0; i < 4; i++) {
            lar_error error = {0};
            lar_simulation *simulation = start_with(model, setting(grids[i], i == 1 ? 2 : 1));
            lar_status status = lar_simulation_advance(simulation, 250, &error);
            uint64_t end = status ? 0 : lar_simulation_hash(simulation);
            if (i == 0) {
                first = error;
                hash = end;
                stopped += status == LAR_ERROR_UNSTABLE;
            }
            assert_string_equal(error.message, first.message);
            assert_true(end == hash);
            lar_simulation_destroy(simulation);
        }
        lar_model_destroy(model);
    }
    print_message("%d stopped\n", stopped);
}

/* ---- closed forms --------------------------------------------------------------------------- */

/* A cube that is pulled evenly from 0 to the strain E within RAMP and held; sides stay. At small
 * strain sigma = M (g0 e + sum g t e' (1 - exp(-t / t_i))) while it is pulled. */
static const double E = 1e-4, RAMP = 0.02;

static double relaxed(const lar_viscosity *v, double t) {
    double pulled = fmin(t, RAMP), sum = v->rest * pulled;
    for (int i = 0; i < v->terms; i++)
        sum += v->share[i] * v->time[i] * exp(-(t - pulled) / v->time[i]) *
               -expm1(-pulled / v->time[i]);
    return sum * E / RAMP;
}

static lar_simulation *pulled_cube(bool isochoric, int terms, lar_model **model) {
    static const double points[2][2] = {{0, 0}, {0.02, 1}};
    const brick b = {{1, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    *model = brick_model(&b);
    make_viscous(&(*model)->material[0], isochoric, terms);
    (*model)->time_step = 5e-4;
    fix_nodes(*model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    fix_nodes(*model, brick_side(&b, 0, -1), LAR_AXIS_Y | LAR_AXIS_Z);
    move_nodes(*model, brick_side(&b, 0, -1), LAR_AXIS_X, E * b.edge,
               add_table(*model, LAR_CURVE_LINEAR, 2, points));
    return start(*model);
}

static double axial_stress(lar_simulation *simulation) {
    lar_state state = *lar_simulation_state(simulation);
    double cauchy[6];
    state.past =
        lar_past_step(&simulation->domain, lar_division_of(&simulation->interactions), &state);
    lar_measure_stress(&simulation->domain, &state, 0, cauchy);
    return cauchy[0];
}

/* In the middle the body becomes four times as stiff, and steps are divided. */
static void a_pulled_cube_relaxes_by_the_closed_form(void **unused) {
    (void)unused;
    for (int isochoric = 0; isochoric < 2; isochoric++)
        for (int terms = 1; terms <= LAR_VISCOUS_TERMS; terms++) {
            lar_model *model;
            lar_error error;
            double worst = 0, factor = 1;
            lar_simulation *simulation = pulled_cube(isochoric, terms, &model);
            for (int n = 1; n <= 80; n++) {
                advance(simulation, 10);
                if (n == 40) {
                    factor = 4;
                    assert_int_equal(lar_simulation_set_stiffness(simulation, 0, factor, &error),
                                     LAR_OK);
                }
                double t = lar_simulation_time(simulation);
                double strain = E * fmin(t / RAMP, 1), G = 2e3, K = 2e4;
                double wave = relaxed(&model->material[0].viscosity, t);
                double wanted = isochoric ? K * strain + 4 * G / 3 * wave : (K + 4 * G / 3) * wave;
                worst = fmax(worst, fabs(axial_stress(simulation) / (factor * wanted) - 1));
            }
            assert_below(worst, 1e-3);
            assert_true(lar_division_of(&simulation->interactions)->base > 1);
            finish(simulation, model);
        }
}

/* ---- energy --------------------------------------------------------------------------------- */

/* A thrown body with a load and a moved support: every joule is accounted for, and what the terms
 * take stops its swing. */
static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    for (int isochoric = 0; isochoric < 2; isochoric++) {
        lar_model *model = brick_model(&soft_brick);
        static const double points[3][2] = {{0, 0}, {0.1, 1}, {0.2, 1}};
        int ramp = add_ramp(model, 0.05);
        make_viscous(&model->material[0], isochoric, 3);
        fix_nodes(model, brick_side(&soft_brick, 0, 0), LAR_AXIS_ALL);
        move_nodes(model, brick_side(&soft_brick, 0, -1), LAR_AXIS_Y, 0.004,
                   add_table(model, LAR_CURVE_SMOOTH, 3, points));
        load_nodes(model, single_node(brick_node(&soft_brick, 1, 2, 2)), 0.01, 0, -0.01, ramp);
        throw_body(model, (double[]){0, 0, 0}, (double[]){0, 2, -1}, 0.05);
        model->time_step = 1e-4;
        lar_simulation *simulation = start(model);
        lar_energy start_energy, e;
        lar_simulation_energy(simulation, &start_energy);
        double worst = 0, largest = 0, viscous = 0;
        for (int n = 0; n < 60; n++) {
            advance(simulation, 100);
            lar_simulation_energy(simulation, &e);
            largest = fmax(largest, sum_of(&e));
            worst = fmax(worst, fabs(sum_of(&e) - e.external - sum_of(&start_energy)));
            assert_true(e.viscous >= 0);
            viscous = e.viscous;
        }
        assert_below(worst, 2e-3 * largest);
        assert_true(viscous > 0.2 * largest && e.kinetic < 0.01 * largest);
        print_message("%s: open by %.2g of %.2g J, viscous %.2g J\n",
                      isochoric ? "isochoric" : "whole", worst, largest, viscous);
        finish(simulation, model);
    }
}

/* ---- what cannot be ------------------------------------------------------------------------- */

static void expect_refusal(const lar_model *model, lar_options options, const char *words) {
    lar_simulation *simulation = NULL;
    lar_error error;
    assert_int_not_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_OK);
    if (!strstr(error.message, words)) fail_msg("'%s' lacks '%s'", error.message, words);
}

static void what_cannot_be_is_refused(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    make_viscous(&model->material[0], true, 2);
    lar_options options = lar_options_default();
    options.element = LAR_ELEMENT_HEX8_FULL;
    expect_refusal(model, options, "only elements hex8 can be");
    options.element = LAR_ELEMENT_HEX8;
    model->material[0].viscosity.time[1] = 1e-6;
    expect_refusal(model, options,
                   "viscous term 2 of the material without a name relaxes in 1e-06 s");
    model->material[0].viscosity.time[1] = 1;
    options.grid = "2x1x1";
    lar_simulation_destroy(start_with(model, options));
    lar_model_destroy(model);
}

/* ---- static decks --------------------------------------------------------------------------- */

#define SIDE(name, nodes) "<NodeSet name=\"" name "\">" nodes "</NodeSet>"
#define HELD(name, axis)                                                                           \
    "<bc type=\"zero displacement\" node_set=\"" name "\"><" axis "_dof>1</" axis "_dof></bc>"
#define DECK(steps, time, conditions)                                                              \
    "<?xml version=\"1.0\"?><febio_spec version=\"4.0\"><Control><analysis>STATIC</analysis>"      \
    "<time_steps>" steps "</time_steps><step_size>0.1</step_size></Control><Material><material "   \
    "id=\"1\" name=\"m\" type=\"viscoelastic\"><density>1</density><t1>" time "</t1><g1>1</g1>"    \
    "<elastic type=\"neo-Hookean\"><E>1</E><v>0</v></elastic></material></Material><Mesh><Nodes>"  \
    "<node id=\"1\">0,0,0</node><node id=\"2\">1,0,0</node><node id=\"3\">1,1,0</node><node "      \
    "id=\"4\">0,1,0</node><node id=\"5\">0,0,1</node><node id=\"6\">1,0,1</node><node id=\"7\">"   \
    "1,1,1</node><node id=\"8\">0,1,1</node></Nodes><Elements type=\"hex8\" name=\"p\"><elem "     \
    "id=\"1\">1,2,3,4,5,6,7,8</elem></Elements>" SIDE("x0", "1,4,5,8") SIDE("x1", "2,3,6,7")       \
        SIDE("y0", "1,2,5,6")                                                                      \
            SIDE("z0", "1,2,3,4") "</Mesh><MeshDomains><SolidDomain name=\"p\" "                   \
                                  "mat=\"m\"/></MeshDomains><Boundary>" HELD("x0", "x")            \
                                      HELD("y0", "y") HELD("z0", "z") conditions                   \
        "<LoadData><load_controller id=\"1\" type=\"loadcurve\"><points><pt>0,0</pt><pt>1,1"       \
        "</pt></points></load_controller></LoadData></febio_spec>"
#define PULLED                                                                                     \
    "<bc type=\"prescribed displacement\" node_set=\"x1\"><dof>x</dof><value lc=\"1\">0.2</value>" \
    "</bc></Boundary>"
#define LOADED                                                                                     \
    "</Boundary><Loads><nodal_load node_set=\"x1\" type=\"nodal_force\"><value lc=\"1\">0.1,0,0"   \
    "</value></nodal_load></Loads>"

/* The stress of the law along a cube that does not bulge, 1/E of it, as a second Piola-Kirchhoff's.
 */
static double law(double stretch) {
    return 0.5 * (1 - 1 / (stretch * stretch));
}

/* Stress (pulled) or stretch (loaded) at the end of `end`, by steps of 1/4000 of the ramp. */
static double material_alone(double end, double time, bool loaded) {
    double past = 0, before = 0, stretch = 1, step = 1 / 4000.0, x = step / time;
    const double keeps = exp(-x), takes = -expm1(-x) / x;
    for (int n = 1; n <= (int)(end / step + 0.5); n++) {
        double t = fmin(1, n * step), inner = 0;
        if (!loaded) stretch = 1 + 0.2 * t;
        for (int k = 0; loaded && k < 20; k++) { /* Newton: 0.4 t = stretch (law + past) */
            double rest = keeps * past - takes * before;
            double f = stretch * ((1 + takes) * law(stretch) + rest) - 0.4 * t;
            stretch -= f / ((1 + takes) * (law(stretch) + 1 / (stretch * stretch)) + rest);
        }
        inner = law(stretch);
        past = keeps * past + takes * (inner - before);
        before = inner;
    }
    return loaded ? stretch : stretch * (before + past);
}

/* Of a static deck that is viscous its end is the answer, also where it still creeps or relaxes.
 */
static void static_decks_end_with_their_time(void **unused) {
    (void)unused;
    static const struct {
        const char *text;
        double end, time;
        bool loaded;
    } decks[] = {{DECK("10", "1", PULLED), 1, 1, false},
                 {DECK("20", "1", PULLED), 2, 1, false},
                 {DECK("20", "0.03", PULLED), 2, 0.03, false},
                 {DECK("20", "100", LOADED), 2, 100, true},
                 {DECK("30", "1", LOADED), 3, 1, true}};
    for (size_t i = 0; i < sizeof decks / sizeof *decks; i++) {
        lar_bytes bytes = {(unsigned char *)lar_strdup(decks[i].text), strlen(decks[i].text)};
        lar_model *model = NULL;
        lar_error error;
        if (lar_feb_parse("viscous.feb", &bytes, &model, &error)) fail_msg("%s", error.message);
        lar_bytes_free(&bytes);
        lar_simulation *simulation = start(model);
        double step = lar_simulation_time_step(simulation), found;
        advance(simulation, (int)lround(decks[i].end / step));
        assert_true(fabs(lar_simulation_time(simulation) - decks[i].end) < 1e-9);
        if (decks[i].loaded)
            found = 1 + lar_simulation_state(simulation)->u[node_at(simulation, 6, 0)];
        else
            found = axial_stress(simulation);
        double wanted = material_alone(decks[i].end, decks[i].time, decks[i].loaded);
        print_message("deck %zu: %.6g, the material alone %.6g\n", i, found, wanted);
        assert_below(fabs(found / wanted - 1), 1e-3);
        finish(simulation, model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SAME_BITS_TESTS(body),
        cmocka_unit_test(a_saved_run_goes_on),
        cmocka_unit_test(elastic_models_have_no_history),
        cmocka_unit_test(what_is_beyond_its_limits_stops_everywhere),
        cmocka_unit_test(a_pulled_cube_relaxes_by_the_closed_form),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(static_decks_end_with_their_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
