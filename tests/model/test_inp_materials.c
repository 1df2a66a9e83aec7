/* Materials of Abaqus and CalculiX decks. */
#include "model/inp_deck.h"

static void test_materials(void **state) {
    (void)state;
    lar_model *model = read_deck(
        MESH "*MATERIAL, NAME=a\n*HYPERELASTIC, NEO HOOKE\n500, 1e-4\n*DENSITY\n1000\n"
             "*Material, name=B\n*Hyperelastic, mooney-rivlin\n300, 100, 2e-5\n*Density\n1100,\n"
             "*Material, name=spare\n*Elastic\n1, 0.3\n"
             "*SOLID SECTION, ELSET=LEFT, MATERIAL=A\n1.,\n*Solid Section, elset=right, "
             "material=b\n");
    assert_int_equal(model->material_count, 2);
    assert_int_equal(model->material[0].law, LAR_LAW_neo_hookean);
    near(lar_material_shear(&model->material[0]), 1000);
    near(lar_material_bulk(&model->material[0]), 2e4);
    near(model->material[0].density, 1000);
    assert_int_equal(model->material[1].law, LAR_LAW_mooney_rivlin);
    near(model->material[1].parameter[0], 300);
    near(model->material[1].parameter[1], 100);
    near(model->material[1].parameter[2], 1e5);
    assert_int_equal(model->element_material[0], 0);
    assert_int_equal(model->element_material[1], 1);
    assert_int_equal(notices_with(model, "material 'spare' is not used"), 1);
    assert_int_equal(notices_with(model, "K/2 (ln J)^2 instead of (J - 1)^2 / D1"), 1);
    lar_model_destroy(model);

    model = read_deck(MESH "*MATERIAL, NAME=a\n*ELASTIC, TYPE=ISO\n3000, 0.25\n*DENSITY\n1\n"
                           "*DAMPING, ALPHA=2.5\n*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n");
    assert_int_equal(model->material[0].law, LAR_LAW_neo_hookean);
    near(lar_material_shear(&model->material[0]), 1200);
    near(lar_material_bulk(&model->material[0]), 2000);
    near(model->damping, 2.5);
    assert_int_equal(notices_with(model,
                                  "deck.inp:30: material 'a' is linear elastic; Lariat takes "
                                  "the neo-Hookean law with the same moduli, which is equal "
                                  "at small strain only"),
                     1);
    assert_int_equal(lar_model_until_rest(model), 0);
    lar_model_destroy(model);
}

/* Yeoh's law, and what it becomes where its further terms are zero. */
static void test_yeoh(void **state) {
    (void)state;
    lar_model *model = read_deck(
        MESH "*MATERIAL, NAME=a\n*HYPERELASTIC, YEOH\n500, -60, 7, 1e-4, 0, 0, 20\n*DENSITY\n"
             "1000\n*MATERIAL, NAME=b\n*HYPERELASTIC, YEOH\n500, , , 1e-4\n*DENSITY\n1000\n"
             "*SOLID SECTION, ELSET=LEFT, MATERIAL=a\n1.,\n*SOLID SECTION, ELSET=RIGHT, "
             "MATERIAL=b\n");
    assert_int_equal(model->material[0].law, LAR_LAW_yeoh);
    assert_memory_equal(model->material[0].parameter, ((double[]){500, -60, 7, 2e4}), 32);
    assert_int_equal(model->material[1].law, LAR_LAW_neo_hookean);
    near(lar_material_shear(&model->material[1]), 1000);
    assert_int_equal(notices_with(model, "Lariat's Yeoh law answers a change of volume by K/2 (ln "
                                         "J)^2 instead of (J - 1)^2 / D1"),
                     1);
    lar_model_destroy(model);
}

#define HOLZAPFEL                                                                                  \
    "*MATERIAL, NAME=a\n*ANISOTROPIC HYPERELASTIC, HOLZAPFEL, LOCAL DIRECTIONS=2\n"                \
    "400, 2e-5, 2500, 1.4, 0.1\n*DENSITY\n1000\n"
#define HELIX                                                                                      \
    "*ORIENTATION, NAME=helix, SYSTEM=RECTANGULAR, LOCAL DIRECTIONS=2\n1., 0., 0., 1., 1., 0.\n"   \
    "3, 90.\n0.8, 0.6, 0.\n0.8, -0.6\n"
#define OF_HELIX "*SOLID SECTION, ELSET=BOTH, MATERIAL=a, ORIENTATION=Helix\n"

static void near3(const double a[3], double x, double y, double z) {
    if (!(fabs(a[0] - x) + fabs(a[1] - y) + fabs(a[2] - z) < 1e-12))
        fail_msg("%g %g %g instead of %g %g %g", a[0], a[1], a[2], x, y, z);
}

/* Axes that are turned by a right angle: the first one runs along y. */
static void test_two_families(void **state) {
    (void)state;
    lar_model *model = read_deck(MESH HELIX HOLZAPFEL OF_HELIX);
    const lar_material *m = &model->material[0];
    assert_int_equal(m->law, LAR_LAW_neo_hookean);
    near(lar_material_shear(m), 800);
    near(lar_material_bulk(m), 1e5);
    assert_true(m->fibre.law == LAR_FIBRE_HGO && m->fibre.isochoric && m->fibre.paired);
    assert_memory_equal(m->fibre.parameter, ((double[]){2500, 1.4, 0.1, 0}), 32);
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        near3(model->mesh.fibre[e], -0.6, 0.8, 0);
        near3(model->mesh.second[e], 0.6, 0.8, 0);
    }
    assert_int_equal(notices_with(model, "instead of ((J^2 - 1)/2 - ln J) / D"), 1);
    lar_model_destroy(model);
    /* Without directions of its own the axes are. */
    model = read_deck(MESH HOLZAPFEL "*Orientation, name=helix\n0, 0, 2, 0, 3, 3\n1, 0\n" OF_HELIX);
    near3(model->mesh.fibre[0], 0, 0, 1);
    near3(model->mesh.second[1], 0, 1, 0);
    lar_model_destroy(model);
    model =
        read_deck(MESH "*ORIENTATION, NAME=helix\n1, 0, 0, 0, 1, 0, 0, 0, 0\n*MATERIAL, NAME=a\n"
                       "*ANISOTROPIC HYPERELASTIC, HOLZAPFEL, LOCAL DIRECTIONS=1\n"
                       "400, 2e-5, 2500, 1.4, 0\n*DENSITY\n1000\n" OF_HELIX);
    assert_false(model->material[0].fibre.paired);
    near3(model->mesh.fibre[0], 1, 0, 0);
    assert_null(model->mesh.second);
    lar_model_destroy(model);
}

static lar_model *of_two(const char *left, const char *right) {
    char deck[4000];
    snprintf(deck, sizeof deck,
             MESH "*MATERIAL, NAME=a\n*HYPERELASTIC, %s\n*DENSITY\n1000\n*MATERIAL, NAME=b\n"
                  "*HYPERELASTIC, %s\n*DENSITY\n1000\n*SOLID SECTION, ELSET=LEFT, MATERIAL=a\n"
                  "1.,\n*SOLID SECTION, ELSET=RIGHT, MATERIAL=b\n",
             left, right);
    return read_deck(deck);
}

/* Series of one, two and three terms; behind the terms their D, on a second line where there are
 * more than eight numbers. */
static void test_series(void **state) {
    (void)state;
    lar_model *model =
        of_two("OGDEN, N=3\n400, 1.3, 1.2, 5, -10, -2, 1e-4, 0\n0, 20", "OGDEN\n500, 8, 1e-4");
    assert_int_equal(model->material[0].law, LAR_LAW_ogden);
    assert_memory_equal(model->material[0].parameter, ((double[]){800, 1.3, 2.4, 5, -20, -2, 2e4}),
                        56);
    assert_memory_equal(model->material[1].parameter, ((double[]){1000, 8, 0, 0, 0, 0, 2e4}), 56);
    near(lar_material_shear(&model->material[1]), 500);
    assert_int_equal(notices_with(model, "Lariat's Ogden law answers a change of volume"), 2);
    lar_model_destroy(model);
    model = of_two("N=2, OGDEN\n400, 1.3, 1.2, 5, 1e-4, , 20",
                   "REDUCED POLYNOMIAL, N=2\n500, -60, 1e-4, 0");
    assert_memory_equal(model->material[0].parameter, ((double[]){800, 1.3, 2.4, 5, 0, 0, 2e4}),
                        56);
    assert_int_equal(model->material[1].law, LAR_LAW_yeoh);
    assert_memory_equal(model->material[1].parameter, ((double[]){500, -60, 0, 2e4}), 32);
    lar_model_destroy(model);
    model = of_two("REDUCED POLYNOMIAL, N=3\n500, -60, 7, 1e-4", "reduced polynomial\n500, 1e-4");
    assert_memory_equal(model->material[0].parameter, ((double[]){500, -60, 7, 2e4}), 32);
    assert_int_equal(model->material[1].law, LAR_LAW_neo_hookean);
    lar_model_destroy(model);
    /* without a kind it is a polynomial of one term: Mooney-Rivlin's */
    model = of_two("N=1\n300, 100, 1e-4", "POLYNOMIAL, N=1\n300, 0, 1e-4");
    assert_int_equal(model->material[0].law, LAR_LAW_mooney_rivlin);
    assert_memory_equal(model->material[0].parameter, ((double[]){300, 100, 2e4}), 24);
    assert_int_equal(model->material[1].law, LAR_LAW_neo_hookean);
    lar_model_destroy(model);
    model = read_deck(MESH "*MATERIAL, NAME=a\n*HYPERELASTIC\n300, 100, 1e-4\n*DENSITY\n1\n"
                           "*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n");
    assert_int_equal(model->material[0].law, LAR_LAW_mooney_rivlin);
    lar_model_destroy(model);
    model = of_two("ARRUDA-BOYCE\n500, 2, 1e-4", "NEO HOOKE\n500, 1e-4");
    assert_int_equal(model->material[0].law, LAR_LAW_arruda_boyce);
    assert_memory_equal(model->material[0].parameter, ((double[]){500, 4, 2e4}), 24);
    /* Abaqus's manual: mu (1 + 3/(5 l^2) + 99/(175 l^4) + 513/(875 l^6) + 42039/(67375 l^8)) */
    near(lar_material_shear(&model->material[0]),
         500 * (1 + 0.6 / 4 + 99.0 / 175 / 16 + 513.0 / 875 / 64 + 42039.0 / 67375 / 256));
    lar_model_destroy(model);
}

/* Moduli in the end, which is Abaqus's default, or at once. */
static void test_viscosity(void **state) {
    (void)state;
#define VISCOUS(moduli, terms)                                                                     \
    MESH "*MATERIAL, NAME=a\n*HYPERELASTIC, NEO HOOKE" moduli                                      \
         "\n500, 1e-4\n*DENSITY\n1000\n*VISCOELASTIC, TIME=PRONY\n" terms                          \
         "*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n"
    lar_model *model = read_deck(VISCOUS("", "0.25, 0, 0.1\n0.35, , 2.5\n"));
    const lar_viscosity *v = &model->material[0].viscosity;
    assert_true(v->terms == 2 && v->isochoric && v->rest == 1);
    near(v->share[0], 0.25 / 0.4);
    near(v->share[1], 0.35 / 0.4);
    near(v->time[1], 2.5);
    near(lar_material_shear(&model->material[0]), 1000);
    near(lar_material_instant_shear(&model->material[0]), 2500);
    near(lar_material_instant_bulk(&model->material[0]), 2e4);
    assert_int_equal(notices_with(model, "equal where strain is small"), 1);
    lar_model_destroy(model);

    model = read_deck(VISCOUS(", MODULI=INSTANTANEOUS", "0.25, 0.25, 0.1\n"));
    v = &model->material[0].viscosity;
    assert_true(v->terms == 1 && !v->isochoric && v->rest == 0.75 && v->share[0] == 0.25);
    near(lar_material_shear(&model->material[0]), 750);
    near(lar_material_instant_bulk(&model->material[0]), 2e4);
    lar_model_destroy(model);

    model = read_deck(MESH "*MATERIAL, NAME=a\n*VISCOELASTIC, TIME=PRONY\n0.5, 0.5, 1\n*ELASTIC, "
                           "MODULI=LONG TERM\n3000, 0.25\n*DENSITY\n1\n*SOLID SECTION, ELSET=BOTH, "
                           "MATERIAL=a\n");
    near(lar_material_instant_shear(&model->material[0]), 2400);
    lar_model_destroy(model);

    const int card = AFTER_MESH + 5;
    refused(VISCOUS("", ""), LAR_ERROR_FORMAT, card, "has no line of numbers; add g, k, tau");
    refused(VISCOUS("", "0.5, 0.2, 1\n"), LAR_ERROR_UNSUPPORTED, card + 1,
            "k of *VISCOELASTIC is 0.2 and g 0.5; Lariat relaxes");
    refused(VISCOUS("", "0.5, 0, 1\n0.1, 0.1, 2\n"), LAR_ERROR_UNSUPPORTED, card + 2,
            "differ in whether the volume relaxes");
    refused(VISCOUS("", "-0.5, 0, 1\n"), LAR_ERROR_MODEL, card + 1, "g of *VISCOELASTIC is -0.5");
    refused(VISCOUS("", "0.5, 0, 0\n"), LAR_ERROR_MODEL, card + 1, "tau of *VISCOELASTIC is 0");
    refused(VISCOUS("", "0.5, 0, 1\n0.6, 0, 2\n"), LAR_ERROR_MODEL, card,
            "the g of *VISCOELASTIC make up 1.1; they must stay below 1");
    refused(VISCOUS("", ".1,0,1\n.1,0,2\n.1,0,3\n.1,0,4\n.1,0,5\n.1,0,6\n.1,0,7\n"),
            LAR_ERROR_UNSUPPORTED, card + 7, "more than 6 terms of *VISCOELASTIC");
    refused(VISCOUS(", MODULI=SOMETIMES", "0.5, 0, 1\n"), LAR_ERROR_FORMAT, AFTER_MESH + 1,
            "MODULI=SOMETIMES is neither LONG TERM nor INSTANTANEOUS");
    refused(MESH "*MATERIAL, NAME=a\n*VISCOELASTIC, TIME=CREEP TEST DATA\n1, 1\n",
            LAR_ERROR_UNSUPPORTED, AFTER_MESH + 1, "TIME=CREEP TEST DATA is not read");
    refused(MESH "*MATERIAL, NAME=a\n*VISCOELASTIC, FREQUENCY=PRONY\n1, 1\n", LAR_ERROR_UNSUPPORTED,
            AFTER_MESH + 1, "FREQUENCY");
}

/* A static step takes moduli at once, or with LONG TERM those in the end; *VISCO relaxes. */
static void test_viscosity_in_steps(void **state) {
    (void)state;
#define IN_STEP(moduli, terms, step) VISCOUS(moduli, terms) "*STEP, NLGEOM\n" step "\n0.1, 2\n" END
    static const struct {
        const char *deck;
        double shear, bulk;
    } steps[] = {
        {IN_STEP("", "0.6, 0, 3\n", "*STATIC"), 2500, 2e4},
        {IN_STEP("", "0.6, 0.6, 3\n", "*STATIC"), 2500, 5e4},
        {IN_STEP("", "0.6, 0, 3\n", "*STATIC, LONG TERM"), 1000, 2e4},
        {IN_STEP(", MODULI=INSTANTANEOUS", "0.6, 0, 3\n", "*STATIC"), 1000, 2e4},
        {IN_STEP(", MODULI=INSTANTANEOUS", "0.6, 0, 3\n", "*STATIC, LONG TERM"), 400, 2e4},
    };
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        lar_model *model = read_deck(steps[i].deck);
        const lar_material *material = &model->material[0];
        assert_int_equal(material->viscosity.terms, 0);
        near(lar_material_shear(material), steps[i].shear);
        near(lar_material_bulk(material), steps[i].bulk);
        assert_int_equal(lar_model_until_rest(model), 1);
        assert_int_equal(notices_with(model, strstr(steps[i].deck, "LONG")
                                                 ? "*STATIC, LONG TERM takes its moduli in the end"
                                                 : "deck.inp:34: material 'a': *STATIC takes its "
                                                   "moduli at once; *STATIC, LONG TERM takes"),
                         1);
        lar_model_destroy(model);
    }
    lar_model *model = read_deck(
        IN_STEP("", "0.6, 0, 3\n", "*VISCO, CETOL=0.01") "*AMPLITUDE, NAME=a\n0, 0, 9, 9\n");
    assert_int_equal(model->material[0].viscosity.terms, 1);
    assert_true(model->by_material_time && !model->until_rest && model->duration == 2);
    assert_int_equal(notices_with(model, "deck.inp:37: the step is static and a material viscous"),
                     1);
    near(at(model, 0, 9), 2); /* it ends with the step */
    lar_model_destroy(model);
    /* a hundred periods of the slowest motion in the step */
    model = read_deck(MESH "*MATERIAL, NAME=a\n*ELASTIC\n3000, 0.25\n*VISCOELASTIC, TIME=PRONY\n"
                           "0.5, 0.5, 1\n*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n*STEP, NLGEOM\n"
                           "*VISCO\n0.1, 2\n*CLOAD\n9, 1, 1\n" END);
    near(8 * sqrt(model->material[0].density / lar_material_shear(&model->material[0])), 0.02);
    near(at(model, model->load[0].curve, 0), 1); /* Abaqus's default: at once */
    lar_model_destroy(model);
    /* or twenty in the fastest one, here back and forth by 1 and 2 in 0.01 and 0.03 s; but not more
     * than 20,000 in all */
#define WITH_WAVE(points)                                                                          \
    MESH "*MATERIAL, NAME=a\n*ELASTIC\n3000, 0.25\n*VISCOELASTIC, TIME=PRONY\n0.5, 0.5, 1\n"       \
         "*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n*AMPLITUDE, NAME=w\n" points                     \
         "\n*STEP, NLGEOM\n*VISCO\n0.1, 2\n*CLOAD, AMPLITUDE=w\n9, 1, 1\n" END
    static const struct {
        const char *deck;
        double period;
        int smoothed;
    } waves[] = {{WITH_WAVE("0, 0, 0.01, 1, 0.04, -1, 2, 0"), 0.001, 0},
                 {WITH_WAVE("0, 0, 0.00001, 1, 2, 1"), 0.0001, 1}};
    for (int i = 0; i < 2; i++) {
        model = read_deck(waves[i].deck);
        const lar_material *material = &model->material[0];
        near(8 * sqrt(material->density / lar_material_shear(material)), waves[i].period);
        assert_int_equal(notices_with(model, "what a curve does within 1e-05 s takes some 0.002 s"),
                         waves[i].smoothed);
        lar_model_destroy(model);
    }
    /* without a viscous material it is a static step */
    model = read_deck(MESH SOFT "*STEP, NLGEOM\n*VISCO\n0.1, 2\n*BOUNDARY\n9, 1, 1, 0.1\n" END);
    assert_true(model->until_rest && !model->by_material_time);
    near(at(model, model->move[0].curve, 1), 0.5); /* but displacements ramp */
    lar_model_destroy(model);
    refused(MESH SOFT "*STEP\n*DYNAMIC, LONG TERM\n0.1, 2\n" END, LAR_ERROR_UNSUPPORTED,
            AFTER_SOFT + 1, "the parameter LONG TERM of *DYNAMIC");
#undef IN_STEP
}

/* The mass of a static deck is such that loads come in 2 to 20 periods; what weighs keeps its
 * weight. */
static void test_static_mass(void **state) {
    (void)state;
    /* a period of 8 sqrt(density / G): 20 of them, as it is (0.25 s), 2 of them */
    static const struct {
        double density, period;
    } cases[] = {{1e-6, 0.1}, {1000.0 / 1024, 0.25}, {1000, 1}};
    for (int i = 0; i < 3; i++) {
        char text[2000];
        snprintf(text, sizeof text,
                 MESH "*MATERIAL, NAME=a\n*HYPERELASTIC, NEO HOOKE\n500, 1e-4\n*DENSITY\n%.17g\n"
                      "*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n" STATIC
                      "*DLOAD\n, GRAV, 9.81, 0, 0, -1\n" END,
                 cases[i].density);
        lar_model *model = read_deck(text);
        const lar_material *material = &model->material[0];
        double period = 8 * sqrt(material->density / lar_material_shear(material));
        near(period, cases[i].period);
        near(model->gravity[2] * material->density, -9.81 * cases[i].density);
        lar_model_destroy(model);
    }
}

/* Without gravity the density of a static deck does not matter. */
static void test_static_without_density(void **state) {
    (void)state;
    static const char *const deck =
        MESH "*MATERIAL, NAME=a\n*ELASTIC\n210e9, 0.3\n*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n"
             "*BOUNDARY\nWALL, 1, 3\n" STATIC "*CLOAD\nTIP, 1, 1\n" END;
    lar_model *model = read_deck(deck);
    /* ten periods of 4 L sqrt(rho / G) in the step's 2 s, with L = 2 */
    near(8 * sqrt(model->material[0].density / lar_material_shear(&model->material[0])), 0.2);
    assert_int_equal(notices_with(model, "no *DENSITY: the static answer does not depend on it"),
                     1);
    lar_model_destroy(model);
    refused(MESH
            "*MATERIAL, NAME=a\n*ELASTIC\n2e9, 0.3\n*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n" STATIC
            "*DLOAD\n, GRAV, 9.81, 0, 0, -1\n" END,
            LAR_ERROR_MODEL, AFTER_MESH + 1, "has no density; give it *DENSITY");
    refused(
        MESH
        "*MATERIAL, NAME=a\n*ELASTIC\n2e9, 0.3\n*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n" DYNAMIC
            END,
        LAR_ERROR_MODEL, AFTER_MESH + 1, "has no density");
}

static void test_bad_families(void **state) {
    (void)state;
    const int one = AFTER_MESH, two = one + 1, three = one + 2;
#define WITH(option, numbers)                                                                      \
    MESH "*MATERIAL, NAME=a\n*ANISOTROPIC HYPERELASTIC" option "\n" numbers
#define GOOD "400, 2e-5, 2500, 1.4, 0.1\n"
    refused(WITH(", FUNG-ANISOTROPIC", GOOD), LAR_ERROR_UNSUPPORTED, two, "Lariat has HOLZAPFEL");
    refused(WITH(", HOLZAPFEL", GOOD), LAR_ERROR_FORMAT, two, "needs LOCAL DIRECTIONS");
    refused(WITH(", HOLZAPFEL, LOCAL DIRECTIONS=3", GOOD), LAR_ERROR_UNSUPPORTED, two,
            "LOCAL DIRECTIONS=3; Lariat has one family of fibres or two");
    refused(WITH(", HOLZAPFEL, LOCAL DIRECTIONS=2, PROPERTIES=3", GOOD), LAR_ERROR_UNSUPPORTED, two,
            "PROPERTIES");
    refused(WITH(", HOLZAPFEL, LOCAL DIRECTIONS=2", "400, 2e-5, 2500, 1.4\n"), LAR_ERROR_FORMAT,
            three, "expected kappa");
    refused(WITH(", HOLZAPFEL, LOCAL DIRECTIONS=2", "400, 0, 2500, 1.4, 0.1\n"),
            LAR_ERROR_UNSUPPORTED, two, "D is 0, which asks for a material");
    refused(WITH(", HOLZAPFEL, LOCAL DIRECTIONS=2", "400, 2e-5, 2500, 1.4, 0.4\n"), LAR_ERROR_MODEL,
            two, "kappa must be between 0");
    refused(MESH HOLZAPFEL "*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n", LAR_ERROR_MODEL, one + 5,
            "need 2 directions; give the section an ORIENTATION");
    refused(MESH HOLZAPFEL OF_HELIX, LAR_ERROR_FORMAT, one + 5,
            "there is no *ORIENTATION called 'Helix'");
    refused(MESH
            "*ORIENTATION, NAME=helix, LOCAL DIRECTIONS=1\n1, 0, 0, 0, 1, 0\n3, 0\n1\n" HOLZAPFEL
                OF_HELIX,
            LAR_ERROR_MODEL, one + 9, "need 2 directions");
    refused(MESH "*ORIENTATION, NAME=h, SYSTEM=CYLINDRICAL\n", LAR_ERROR_UNSUPPORTED, one,
            "SYSTEM=CYLINDRICAL of *ORIENTATION is not read");
    refused(MESH "*ORIENTATION, NAME=h\n", LAR_ERROR_FORMAT, one, "no line of numbers");
    refused(MESH "*ORIENTATION, NAME=h\n1, 0, 0\n", LAR_ERROR_FORMAT, two, "points a and b");
    refused(MESH "*ORIENTATION, NAME=h\n1, 0, 0, 2, 0, 0\n", LAR_ERROR_MODEL, two, "span no plane");
    refused(MESH "*ORIENTATION, NAME=h\n1, 0, 0, 0, 1, 0\n4, 0\n", LAR_ERROR_FORMAT, three,
            "about axis 4");
    refused(MESH "*ORIENTATION, NAME=h, LOCAL DIRECTIONS=2\n1, 0, 0, 0, 1, 0\n3, 0\n1\n",
            LAR_ERROR_FORMAT, three + 1, "promises 2 directions");
    refused(MESH HELIX HELIX, LAR_ERROR_FORMAT, one + 5, "a second *ORIENTATION");
#undef WITH
#undef GOOD
}

static void test_bad_materials(void **state) {
    (void)state;
    const int one = AFTER_MESH, two = one + 1, three = one + 2;
#define OF(rest) MESH "*MATERIAL, NAME=a\n" rest
    refused(OF("*PLASTIC\n1, 0\n"), LAR_ERROR_UNSUPPORTED, two,
            "*PLASTIC is not read and would "
            "change the answer; remove it");
    refused(OF("*HYPERELASTIC, MARLOW\n1,2,3\n"), LAR_ERROR_UNSUPPORTED, two,
            "Lariat has NEO HOOKE, MOONEY-RIVLIN, POLYNOMIAL, YEOH, REDUCED POLYNOMIAL, "
            "ARRUDA-BOYCE and OGDEN, with constants");
    refused(OF("*HYPERELASTIC, POLYNOMIAL, N=2\n1,2,3\n"), LAR_ERROR_UNSUPPORTED, two,
            "N=2 of *HYPERELASTIC; Lariat's Mooney-Rivlin law has 1 term at most");
    refused(OF("*HYPERELASTIC, TEST DATA INPUT\n"), LAR_ERROR_UNSUPPORTED, two,
            "this kind of *HYPERELASTIC is not read");
    refused(OF("*HYPERELASTIC, OGDEN, N=4\n1,2,3\n"), LAR_ERROR_UNSUPPORTED, two,
            "N=4 of *HYPERELASTIC; Lariat's Ogden law has 3 terms at most");
    refused(OF("*HYPERELASTIC, REDUCED POLYNOMIAL, N=0\n1,2\n"), LAR_ERROR_FORMAT, two,
            "N=0 of *HYPERELASTIC is no number of terms");
    refused(OF("*HYPERELASTIC, YEOH, N=3\n1, 1, 1, 1\n"), LAR_ERROR_UNSUPPORTED, two,
            "the parameter N of *HYPERELASTIC");
    refused(OF("*HYPERELASTIC, OGDEN, N=2\n500, 2, 30, , 1e-4\n"), LAR_ERROR_MODEL, two,
            "m2 of the law ogden is 0; it is the power of the term of c2");
    refused(OF("*HYPERELASTIC, OGDEN, N=2\n500, 2, 30, -4, 1e-4, 1e-4\n"), LAR_ERROR_UNSUPPORTED,
            two, "D2 is 0.0001");
    refused(OF("*HYPERELASTIC, OGDEN\n500, 1e4, 1e-4\n"), LAR_ERROR_MODEL, two,
            "m1 of the law ogden is 10000");
    refused(OF("*HYPERELASTIC, OGDEN, N=1\n500, 2, 1e-4, 20, 7\n"), LAR_ERROR_FORMAT, three,
            "expected the end of the line");
    refused(OF("*HYPERELASTIC, OGDEN, N=3\n1, 2, 1, 2, 1, 2, 1, 0\n0, 20, 7\n"), LAR_ERROR_FORMAT,
            three + 1, "expected the end of the line");
    refused(OF("*HYPERELASTIC, ARRUDA-BOYCE\n500, -2, 1e-4\n"), LAR_ERROR_MODEL, two,
            "LAMBDA_M is -2; it must be more than zero");
    refused(OF("*HYPERELASTIC, ARRUDA-BOYCE\n500, 200, 1e-4\n"), LAR_ERROR_MODEL, two,
            "N of the law arruda-boyce is 40000");
    refused(OF("*HYPERELASTIC, ARRUDA-BOYCE\n500, 2\n"), LAR_ERROR_UNSUPPORTED, two,
            "D is 0, which asks for a material that cannot change its volume");
    refused(OF("*HYPERELASTIC, NEO HOOKE, TEST DATA INPUT\n"), LAR_ERROR_UNSUPPORTED, two,
            "the parameter TEST DATA INPUT of *HYPERELASTIC");
    refused(OF("*HYPERELASTIC, NEO HOOKE\n500\n"), LAR_ERROR_UNSUPPORTED, two, "D1 = 2 / K");
    refused(OF("*HYPERELASTIC, NEO HOOKE\n500, 1e-4\n600, 1e-4\n"), LAR_ERROR_UNSUPPORTED,
            three + 1, "depends on temperature");
    refused(OF("*HYPERELASTIC, NEO HOOKE\n500, 1e-4, 20, 7\n"), LAR_ERROR_FORMAT, three,
            "expected the end of the line");
    refused(OF("*HYPERELASTIC, YEOH\n500, -60, 7\n"), LAR_ERROR_UNSUPPORTED, two, "D1 = 2 / K");
    refused(OF("*HYPERELASTIC, YEOH\n500, -60, 7, 1e-4, 1e-3\n"), LAR_ERROR_UNSUPPORTED, two,
            "D2 is 0.001; Lariat's Yeoh law does not have that term");
    refused(OF("*HYPERELASTIC, YEOH\n500, nan, 7, 1e-4\n"), LAR_ERROR_FORMAT, three,
            "expected C20, found");
    refused(OF("*HYPERELASTIC, YEOH\n-500, 1, 7, 1e-4\n"), LAR_ERROR_MODEL, two, "shear modulus");
    refused(OF("*HYPERELASTIC, YEOH\n500, 1, 7e99, 1e-4\n"), LAR_ERROR_MODEL, two,
            "check its unit");
    refused(OF("*HYPERELASTIC, YEOH\n500, 1, 7, 1e-320\n"), LAR_ERROR_MODEL, two,
            "not a finite number");
    refused(OF("*HYPERELASTIC, NEO HOOKE\n-5, 1e-4\n"), LAR_ERROR_MODEL, two, "shear modulus");
    refused(OF("*ELASTIC, TYPE=ORTHO\n1,2,3\n"), LAR_ERROR_UNSUPPORTED, two, "isotropic");
    refused(OF("*ELASTIC\n1000, 0.5\n"), LAR_ERROR_MODEL, three, "Poisson's ratio 0.5");
    refused(OF("*ELASTIC\n1000, x\n"), LAR_ERROR_FORMAT, three, "expected Poisson's ratio, found");
    refused(OF("*ELASTIC\n"), LAR_ERROR_FORMAT, two, "*ELASTIC has no line of numbers");
    refused(OF("*ELASTIC\n1, 0.3\n*ELASTIC\n1, 0.3\n"), LAR_ERROR_FORMAT, two + 2, "second law");
    refused(OF("*DENSITY\n-1\n"), LAR_ERROR_MODEL, three, "must be positive");
    refused(OF("*DENSITY\n1\n*DENSITY\n2\n"), LAR_ERROR_FORMAT, two + 2, "a second *DENSITY");
    refused(OF("*DAMPING, ALPHA=1, BETA=0.1\n"), LAR_ERROR_UNSUPPORTED, two, "leave BETA out");
    refused(OF("*MATERIAL, NAME=A\n"), LAR_ERROR_FORMAT, two, "a second *MATERIAL");
    refused(OF("*DENSITY\n1\n*SOLID SECTION, ELSET=BOTH, MATERIAL=a\n"), LAR_ERROR_MODEL, one,
            "has no law");
    refused(OF("*SOLID SECTION, ELSET=BOTH, MATERIAL=b\n"), LAR_ERROR_FORMAT, two,
            "there is no *MATERIAL called 'b'");
    refused(OF("*SOLID SECTION, ELSET=BOTH, MATERIAL=a, ORIENTATION=o\n"), LAR_ERROR_UNSUPPORTED,
            two, "ORIENTATION");
    refused(MESH SOFT "*SHELL SECTION, ELSET=LEFT, MATERIAL=soft\n1\n", LAR_ERROR_UNSUPPORTED,
            AFTER_SOFT, "*SHELL SECTION");
    refused(MESH "*ELASTIC\n1, 0.3\n", LAR_ERROR_FORMAT, one, "outside of a material");
    refused(OF("*BOUNDARY\nWALL, 1\n*ELASTIC\n1, 0.3\n"), LAR_ERROR_FORMAT, two + 2, "outside");
    refused(OF("*ELASTIC\n1, 0.3\n*DENSITY\n1\n*SOLID SECTION, ELSET=NONE, MATERIAL=a\n"),
            LAR_ERROR_FORMAT, two + 4, "'NONE' is neither a number nor a set of elements");
#undef OF
    lar_model *model = NULL;
    lar_error error;
    assert_int_equal(parse(MESH "*MATERIAL, NAME=a\n*ELASTIC\n1, 0.3\n*DENSITY\n1\n"
                                "*SOLID SECTION, ELSET=LEFT, MATERIAL=a\n",
                           &model, &error),
                     LAR_ERROR_MODEL);
    assert_non_null(strstr(error.message, "element 2 has no material"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_materials),     cmocka_unit_test(test_yeoh),
        cmocka_unit_test(test_series),        cmocka_unit_test(test_static_without_density),
        cmocka_unit_test(test_bad_materials), cmocka_unit_test(test_viscosity),
        cmocka_unit_test(test_two_families),  cmocka_unit_test(test_bad_families),
        cmocka_unit_test(test_static_mass),   cmocka_unit_test(test_viscosity_in_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
