/* Bodies with two families of fibres, and with fibres that spread (law hgo): the same bits
 * everywhere, saved and taken up, beside viscosity; blocks that are pulled, stretched both ways and
 * sheared against formulas that are written here once more; the step and the account of energy. */
#include "engine/same_bits_test.h"

/* Two families that cross around the body's length, in no two elements alike. */
static void lay_families(lar_model *model) {
    lar_mesh *mesh = &model->mesh;
    size_t count = (size_t)mesh->element_count;
    mesh->fibre = lar_calloc(count, sizeof *mesh->fibre);
    mesh->second = lar_calloc(count, sizeof *mesh->second);
    assert_true(mesh->fibre && mesh->second);
    for (size_t e = 0; e < count; e++) {
        double corner[8][3];
        lar_mesh_corners(mesh, (int32_t)e, corner);
        for (int k = 0; k < 2; k++) {
            double *a = k ? mesh->second[e] : mesh->fibre[e];
            a[0] = k ? -0.015 : 0.02;
            a[1] = -(corner[0][2] + corner[6][2]) / 2;
            a[2] = (corner[0][1] + corner[6][1]) / 2;
        }
    }
    lar_error error;
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
}

/* Single families and pairs, spread and straight, one viscous and one active as well. */
static lar_model *crossed_tool_model(const brick *b) {
    lar_model *model = tool_model_of(b);
    lar_material *m = model->material;
    m[LAR_LAW_neo_hookean].fibre = (lar_fibre){
        .law = LAR_FIBRE_HGO, .isochoric = true, .parameter = {900, 1.5, 0.12}, .paired = true};
    m[LAR_LAW_neo_hookean].viscosity =
        (lar_viscosity){.terms = 1, .isochoric = true, .rest = 1, .share = {0.6}, .time = {0.05}};
    m[LAR_LAW_yeoh].fibre = (lar_fibre){.law = LAR_FIBRE_HGO,
                                        .isochoric = true,
                                        .parameter = {500, 1, 1.0 / 3},
                                        .across = 100,
                                        .paired = true};
    m[LAR_LAW_mooney_rivlin].fibre =
        (lar_fibre){.law = LAR_FIBRE_HGO, .isochoric = true, .parameter = {2000, 0.5, 0.226}};
    m[LAR_LAW_ogden].fibre = (lar_fibre){.law = LAR_FIBRE_HGO,
                                         .isochoric = true,
                                         .parameter = {1500, 3, 0},
                                         .along = 300,
                                         .paired = true};
    m[LAR_LAW_coupled_neo_hookean].fibre =
        (lar_fibre){.law = LAR_FIBRE_EXP_LINEAR, .parameter = {50, 20, 1000, 1.05}};
    lay_families(model);
    return model;
}

static same_bits body = {
    crossed_tool_model, LAR_TEST_BUILD "/hgo.checkpoint", {0xd359b7dc19530357, 0x0d9389eb97066acc}};

/* A body whose second family runs otherwise is another body. */
static void a_saved_run_goes_on(void **unused) {
    (void)unused;
    check_saved_runs(&body);
    lar_model *turned = crossed_tool_model(&tool_brick);
    lar_error error;
    for (int32_t e = 0; e < turned->mesh.element_count; e++) turned->mesh.second[e][0] *= -1;
    lar_simulation *wrong = start_with(turned, setting(NULL, 0));
    assert_int_not_equal(lar_simulation_load(wrong, body.path, &error), LAR_OK);
    assert_non_null(strstr(error.message, "material"));
    finish(wrong, turned);
}

/* ---- closed forms --------------------------------------------------------------------------- */

static const double G = 1e3, K = 1e5, K1 = 600, K2 = 0.9;

/* Whether the volume answers as in FEBio, not as here. */
static bool febio;

/* Cauchy stress of a neo-Hookean body with two families, by the formulas of the papers: parts
 * without their mean, and the pressure of the volume. */
static void paper(const double F[3][3], const double a[6], double kappa, double s[3][3]) {
    double b[3][3], J = F[0][0] * F[1][1] * F[2][2], m = pow(J, -2.0 / 3), I1 = 0, mean = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            b[i][j] = m * (F[i][0] * F[j][0] + F[i][1] * F[j][1] + F[i][2] * F[j][2]);
            s[i][j] = G * b[i][j];
        }
        I1 += b[i][i];
    }
    for (int k = 0; k < 6; k += 3) {
        double g[3], I4 = 0;
        for (int i = 0; i < 3; i++) {
            g[i] = F[i][0] * a[k] + F[i][1] * a[k + 1] + F[i][2] * a[k + 2];
            I4 += m * g[i] * g[i];
        }
        double E = kappa * (I1 - 3) + (1 - 3 * kappa) * (I4 - 1);
        for (int i = 0; i < 3 && E > 0; i++)
            for (int j = 0; j < 3; j++)
                s[i][j] += 2 * K1 * E * exp(K2 * E * E) *
                           (kappa * b[i][j] + (1 - 3 * kappa) * m * g[i] * g[j]);
    }
    double pressure = febio ? K / 2 * (J - 1 / J) : K * (J - 1);
    for (int i = 0; i < 3; i++) mean += s[i][i] / 3;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            s[i][j] = (s[i][j] - (i == j ? mean : 0)) / J + (i == j ? pressure : 0);
}

/* Stretches so that the axes from `first` on have no stress: Newton's steps, one after the other.
 */
static void settle(double F[3][3], const double a[6], double kappa, int first) {
    double s[3][3], h = 1e-7;
    for (int n = 0; n < 3000; n++)
        for (int i = first; i < 3; i++) {
            paper((const double(*)[3])F, a, kappa, s);
            double at = s[i][i];
            F[i][i] += h;
            paper((const double(*)[3])F, a, kappa, s);
            F[i][i] -= h + at * h / (s[i][i] - at);
        }
}

enum how { ALONG, BOTH_WAYS, SHEARED, WAYS };

/* Of a block that is pulled along the line between its families with free sides, stretched both
 * ways with a free thickness, or sheared as a whole; what is free finds its place by the kernels'
 * forces. */
static void stress_of_a_block(enum how how, const double a[6], double kappa, const double F[3][3],
                              double cauchy[6]) {
    const brick b = {{2, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, G, K, 1000};
    lar_model *model = brick_model(&b);
    lar_mesh *mesh = &model->mesh;
    mesh->fibre = lar_calloc(8, sizeof *mesh->fibre);
    mesh->second = lar_calloc(8, sizeof *mesh->second);
    for (int e = 0; e < 8; e++)
        for (int i = 0; i < 3; i++) {
            mesh->fibre[e][i] = 2 * a[i];
            mesh->second[e][i] = 3 * a[3 + i];
        }
    model->material[0].fibre = (lar_fibre){
        .law = LAR_FIBRE_HGO, .isochoric = true, .parameter = {K1, K2, kappa}, .paired = true};
    int ramp = add_ramp(model, 0.05);
    for (int layer = 0; layer < 3 && how == SHEARED; layer++) {
        move_nodes(model, brick_side(&b, 1, layer), LAR_AXIS_X, F[0][1] * 0.01 * layer, ramp);
        fix_nodes(model, brick_side(&b, 1, layer), LAR_AXIS_Y | LAR_AXIS_Z);
    }
    for (int axis = 0; axis < 3 && how != SHEARED; axis++) {
        fix_nodes(model, brick_side(&b, axis, 0), 1U << axis);
        if (axis <= (int)how)
            move_nodes(model, brick_side(&b, axis, -1), 1U << axis, 0.02 * (F[axis][axis] - 1),
                       ramp);
    }
    model->damping = 150;
    lar_error error;
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
    lar_simulation *simulation = start(model);
    while (lar_simulation_time(simulation) < 0.6) advance(simulation, 100);
    lar_measure_stress(&simulation->domain, lar_simulation_state(simulation), 0, cauchy);
    finish(simulation, model);
}

static void blocks_have_the_closed_forms(void **unused) {
    (void)unused;
    static const double kappas[] = {0, 0.226, 1.0 / 3};
    static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
    for (int n = 0; n < 3 * WAYS; n++) {
        enum how how = (enum how)(n % WAYS);
        double F[3][3] = {{1.25, 0, 0}, {0, 1, 0}, {0, 0, 1}}, s[3][3], cauchy[6], worst = 0;
        const double c = 0.8, a[6] = {c, 0.6, 0, c, -0.6, 0};
        if (how == BOTH_WAYS) F[1][1] = 1.15;
        if (how == SHEARED) F[0][0] = 1, F[0][1] = 0.3;
        settle(F, a, kappas[n / WAYS], how == SHEARED ? 3 : how + 1);
        paper((const double(*)[3])F, a, kappas[n / WAYS], s);
        stress_of_a_block(how, a, kappas[n / WAYS], (const double(*)[3])F, cauchy);
        for (int k = 0; k < 6; k++) worst = fmax(worst, fabs(cauchy[k] - s[row[k]][column[k]]));
        print_message("kappa %.3f, way %d: off by %.2g of %.5g Pa\n", kappas[n / WAYS], how, worst,
                      fmax(s[0][0], s[0][1]));
        assert_below(worst, 1e-8 * fmax(s[0][0], s[0][1]));
    }
}

/* A deck of FEBio's, a cube of one element that is pulled slowly: as FEBio's formulas have it,
 * its volume term included. */
#define FACE(name, nodes) "<NodeSet name=\"" name "\">" nodes "</NodeSet>"
#define HELD(name, axis)                                                                           \
    "<bc type=\"zero displacement\" node_set=\"" name "\"><" axis "_dof>1</" axis "_dof></bc>"
static const char DECK[] =
    "<?xml version=\"1.0\"?><febio_spec version=\"4.0\"><Module type=\"solid\"/><Control><analysis>"
    "STATIC</analysis><time_steps>10</time_steps><step_size>0.1</step_size></Control><Material>"
    "<material id=\"1\" name=\"m\" type=\"Holzapfel-Gasser-Ogden\"><density>1000</density>"
    "<c>1e3</c><k1>600</k1><k2>0.9</k2><kappa>0.226</kappa><gamma>40</gamma><k>1e5</k>"
    "<mat_axis type=\"vector\"><a>2,0,0</a><d>1,1,0</d></mat_axis></material></Material><Mesh>"
    "<Nodes><node id=\"1\">0,0,0</node><node id=\"2\">1,0,0</node><node id=\"3\">1,1,0</node>"
    "<node id=\"4\">0,1,0</node><node id=\"5\">0,0,1</node><node id=\"6\">1,0,1</node><node "
    "id=\"7\">1,1,1</node><node id=\"8\">0,1,1</node></Nodes><Elements type=\"hex8\" name=\"p\">"
    "<elem id=\"1\">1,2,3,4,5,6,7,8</elem></Elements>" FACE("x0", "1,4,5,8") FACE("x1", "2,3,6,7")
        FACE("y0", "1,2,5,6") FACE(
            "z0", "1,2,3,4") "</Mesh><MeshDomains><SolidDomain name=\"p\" "
                             "mat=\"m\"/></MeshDomains><Boundary>" HELD("x0", "x") HELD("y0", "y")
                                 HELD("z0",
                                      "z") "<bc type=\"prescribed displacement\" "
                                           "node_set=\"x1\"><dof>x</dof><value lc=\"1\">0.3</value>"
                                           "<relative>0</relative></bc></"
                                           "Boundary><LoadData><load_controller id=\"1\" "
                                           "type=\"loadcurve\">"
                                           "<interpolate>LINEAR</interpolate><points><pt>0,0</"
                                           "pt><pt>1,1</pt></points></load_controller>"
                                           "</LoadData></febio_spec>";

static void a_deck_has_the_closed_form(void **unused) {
    (void)unused;
    lar_bytes bytes = {(unsigned char *)lar_strdup(DECK), sizeof DECK - 1};
    lar_model *model = NULL;
    lar_error error;
    if (lar_feb_parse("hgo.feb", &bytes, &model, &error)) fail_msg("%s", error.message);
    lar_bytes_free(&bytes);
    const double gamma = 40 * acos(-1) / 180;
    const double a[6] = {cos(gamma), sin(gamma), 0, cos(gamma), -sin(gamma), 0};
    double F[3][3] = {{1.3, 0, 0}, {0, 1, 0}, {0, 0, 1}}, s[3][3], cauchy[6];
    febio = true;
    settle(F, a, 0.226, 1);
    paper((const double(*)[3])F, a, 0.226, s);
    febio = false;
    lar_simulation *simulation = start(model);
    while (lar_simulation_time(simulation) < 60) advance(simulation, 100);
    lar_measure_stress(&simulation->domain, lar_simulation_state(simulation), 0, cauchy);
    double side = 1 + lar_simulation_state(simulation)->u[node_at(simulation, 6, 1)];
    print_message("deck: %.6g Pa and %.6f wide, %.6g Pa and %.6f by the formulas\n", cauchy[0],
                  side, s[0][0], F[1][1]);
    assert_below(fabs(cauchy[0] / s[0][0] - 1), 1e-3);
    assert_below(fabs(side / F[1][1] - 1), 1e-4);
    finish(simulation, model);
}

/* ---- the step, and energy ------------------------------------------------------------------- */

/* Two families make the automatic step shorter than one; where they stiffen, steps divide. */
static void steps_know_both_families(void **unused) {
    (void)unused;
    double step[2];
    for (int paired = 0; paired < 2; paired++) {
        lar_model *model = tool_model();
        for (int i = 0; i < model->material_count; i++)
            model->material[i].fibre = (lar_fibre){.law = LAR_FIBRE_HGO,
                                                   .isochoric = true,
                                                   .parameter = {3e4, 0, 0},
                                                   .paired = paired};
        lay_families(model);
        lar_simulation *simulation = start_with(model, setting(NULL, 0));
        step[paired] = lar_simulation_time_step(simulation);
        finish(simulation, model);
    }
    assert_true(step[1] < 0.95 * step[0]);
    lar_model *model = tool_model();
    for (int i = 0; i < model->material_count; i++)
        model->material[i].fibre = (lar_fibre){
            .law = LAR_FIBRE_HGO, .isochoric = true, .parameter = {4e3, 100, 0.05}, .paired = true};
    lay_families(model);
    lar_simulation *simulation = start_with(model, setting(NULL, 0));
    int most = 1;
    for (int tick = 0; tick < 20; tick++) {
        act(simulation, tick, tick + 1);
        int parts = lar_division_of(&simulation->interactions)->parts;
        most = parts > most ? parts : most;
    }
    assert_true(most > 1);
    finish(simulation, model);
}

/* A thrown body that is pulled. */
static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    model->material[0].fibre = (lar_fibre){
        .law = LAR_FIBRE_HGO, .isochoric = true, .parameter = {2000, 1, 0.15}, .paired = true};
    fix_nodes(model, brick_side(&soft_brick, 0, 0), LAR_AXIS_ALL);
    load_nodes(model, single_node(brick_node(&soft_brick, 1, 2, 2)), 0.01, 0, -0.01,
               add_ramp(model, 0.05));
    throw_body(model, (double[]){0, 0, 0}, (double[]){0, 2, -1}, 0.05);
    lay_families(model);
    model->time_step = 1e-4;
    lar_simulation *simulation = start(model);
    double largest, worst = account_open(simulation, &largest);
    assert_below(worst, 2e-3 * largest);
    finish(simulation, model);
}

static void expect_refusal(lar_model *model, const char *words) {
    lar_error error;
    assert_int_not_equal(lar_model_check(model, &error), LAR_OK);
    if (!strstr(error.message, words)) fail_msg("'%s' lacks '%s'", error.message, words);
}

static void what_cannot_be_is_refused(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    lar_fibre *fibre = &model->material[0].fibre;
    *fibre = (lar_fibre){.law = LAR_FIBRE_HGO,
                         .isochoric = true,
                         .parameter = {300, 1, 0.1},
                         .paired = true,
                         .line = 7};
    lay_families(model);
    memset(model->mesh.second[4], 0, sizeof *model->mesh.second);
    expect_refusal(model, ":7: element 5 has a second family of fibres and their direction is 0");
    free(model->mesh.second);
    model->mesh.second = NULL;
    expect_refusal(model, "cell array \"fibre2\"");
    fibre->paired = false;
    fibre->parameter[2] = 0.34;
    expect_refusal(model, "kappa must be between 0");
    fibre->parameter[2] = 0.1;
    fibre->isochoric = false;
    expect_refusal(model, "the isochoric part of the stretch");
    fibre->isochoric = true;
    *fibre = (lar_fibre){.law = LAR_FIBRE_EXP_POW, .parameter = {300, 1, 2}, .paired = true};
    expect_refusal(model, "only fibres of the law hgo can have a second family");
    *fibre = (lar_fibre){.law = LAR_FIBRE_HGO, .isochoric = true};
    fibre->parameter[0] = -1;
    expect_refusal(model, "k1");
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SAME_BITS_TESTS(body),
        cmocka_unit_test(a_saved_run_goes_on),
        cmocka_unit_test(blocks_have_the_closed_forms),
        cmocka_unit_test(a_deck_has_the_closed_form),
        cmocka_unit_test(steps_know_both_families),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
