/* FEBio decks: what is read, what is refused and where, and damaged files. */
#include "model/feb_deck.h"

/* ---- mesh and materials ---------------------------------------------------------------------- */

static void check_two_cubes(const lar_model *model) {
    const lar_mesh *mesh = &model->mesh;
    assert_int_equal(mesh->node_count, 12);
    assert_int_equal(mesh->element_count, 2);
    assert_int_equal(mesh->element_tag[1], 7);
    assert_int_equal(mesh->element_id[1], 2);
    assert_int_equal(model->material_count, 1);
    assert_int_equal(model->element_material[0], 0);
    assert_int_equal(model->element_material[1], 0);
    assert_int_equal(model->material[0].law, LAR_LAW_coupled_neo_hookean);
    assert_true(fabs(model->material[0].parameter[0] - 1200.0) < 1e-9);
    assert_true(fabs(model->material[0].parameter[1] - 1200.0) < 1e-9);
    assert_true(model->material[0].density == 1000.0);
    assert_int_equal(lar_mesh_find_set(mesh, "all", LAR_SET_NODES)->count, 12);
    assert_int_equal(lar_mesh_find_set(mesh, "wall", LAR_SET_NODES)->count, 4);
    assert_int_equal(lar_mesh_find_set(mesh, "tip", LAR_SET_NODES)->count, 4);
    assert_int_equal(lar_mesh_find_set(mesh, "left", LAR_SET_ELEMENTS)->count, 1);
    assert_int_equal(lar_mesh_find_set(mesh, "one", LAR_SET_ELEMENTS)->index[0], 1);
    const lar_set *end = lar_mesh_find_set(mesh, "end", LAR_SET_FACES);
    assert_int_equal(end->count, 1);
    assert_int_equal(end->index[0], 1 * 6 + 1);
    assert_true(fabs(model->duration - 1.0) < 1e-12);
}

static void test_version_4(void **state) {
    (void)state;
    lar_model *model = read_deck(BASE4 TAIL);
    check_two_cubes(model);
    assert_int_equal(notices_with(model, "1 nodes that no element uses"), 1);
    assert_int_equal(model->notice_count, 1);
    assert_true(model->damping == 0.0);
    lar_model_destroy(model);
}

static void test_version_3(void **state) {
    (void)state;
    lar_model *model = read_deck(
        "<febio_spec version=\"3.0\"><Module type=\"solid\"/>" CONTROL("DYNAMIC") MATERIAL
        "<Mesh>" NODES "<Elements type=\"hex8\" mat=\"7\" name=\"left\"><elem id=\"1\">"
        "1,2,3,4,5,6,7,8</elem></Elements><Elements type=\"hex8\" mat=\"soft\" name=\"right\">"
        "<e id=\"2\">2,9,10,3,6,11,12,7</e></Elements>"
        "<NodeSet name=\"wall\"><n id=\"1\"/><n id=\"4\"/><node id=\"5\"/><n id=\"8\"/></NodeSet>"
        "<NodeSet name=\"tip\"><n id=\"9\"/><n id=\"10\"/><n id=\"11\"/><n id=\"12\"/></NodeSet>"
        "<ElementSet name=\"one\"><e id=\"2\"/></ElementSet>"
        "<Surface name=\"end\"><quad4 id=\"1\">9,10,12,11</quad4></Surface></Mesh>"
        "<Boundary><bc type=\"fix\" node_set=\"wall\"><dofs>x,z</dofs></bc>"
        "<bc type=\"prescribe\" node_set=\"tip\"><dof>y</dof><scale lc=\"4\">0.5</scale>"
        "<relative>0</relative></bc></Boundary>"
        "<LoadData><load_controller id=\"4\" type=\"loadcurve\"><points><point>0,0</point>"
        "<point>1,1</point></points></load_controller></LoadData></febio_spec>");
    check_two_cubes(model);
    assert_int_equal(model->fix_count, 1);
    assert_int_equal(model->fix[0].axes, LAR_AXIS_X | LAR_AXIS_Z);
    assert_int_equal(model->fix[0].nodes.count, 4);
    assert_int_equal(model->move_count, 1);
    assert_int_equal(model->move[0].axes, LAR_AXIS_Y);
    assert_true(model->move[0].by == 0.5);
    assert_true(lar_curve_value(&model->curve[model->move[0].curve], 0.5) == 0.5);
    lar_model_destroy(model);
}

/* Laws that stiffen, with what FEBio itself writes into its decks. */
static void test_stiffening_laws(void **state) {
    (void)state;
    static const struct {
        const char *type, *given;
        lar_law law;
        double parameter[LAR_LAW_PARAMETERS], shear, bulk;
    } laws[] = {
        {"Ogden",
         "<pressure_model>default</pressure_model><k>1000</k><c1>0.6</c1><c2>0.25</c2><c3>0</c3>"
         "<c4>0</c4><c5>0</c5><c6>0</c6><m1>6.83</m1><m2>-2</m2><m3>1</m3><m4>1</m4><m5>1</m5>"
         "<m6>1</m6>",
         LAR_LAW_ogden,
         {0.6, 6.83, 0.25, -2, 0, 1, 1000},
         0.425,
         1000},
        {"Arruda-Boyce",
         "<mu>0.09</mu><N>26.5</N><k>100</k>",
         LAR_LAW_arruda_boyce,
         {0.09, 26.5, 100},
         0.0921131869,
         100},
        {"Veronda-Westmann",
         "<c1>1</c1><c2>0.5</c2><k>100</k>",
         LAR_LAW_veronda_westmann,
         {1, 0.5, 100},
         0.5,
         100},
        /* FEBio's defaults: powers are 1, constants 0 */
        {"Ogden",
         "<c1>5</c1><c2>-1</c2><m2>-2</m2><k>9</k>",
         LAR_LAW_ogden,
         {5, 1, -1, -2, 0, 0, 9},
         2,
         9},
        {"Ogden", "<c2>5</c2><k>9</k>", LAR_LAW_ogden, {0, 0, 5, 1, 0, 0, 9}, 2.5, 9},
        {"Mooney-Rivlin", "<c2>5</c2><k>9</k>", LAR_LAW_mooney_rivlin, {0, 5, 9}, 10, 9},
        {"Holmes-Mow",
         "<E>1</E><v>0.25</v><beta>0.35</beta>",
         LAR_LAW_holmes_mow,
         {0.4, 0.4, 0.35},
         0.4,
         2.0 / 3}};
    for (size_t n = 0; n < sizeof laws / sizeof *laws; n++) {
        char deck[4000];
        snprintf(deck, sizeof deck,
                 HEAD4 CONTROL("DYNAMIC") "<Material><material id=\"1\" name=\"c\" type=\"%s\">"
                                          "<density>2</density>%s</material></Material>" MESH4
                                          "<MeshDomains><SolidDomain name=\"left\" mat=\"c\"/>"
                                          "<SolidDomain name=\"right\" mat=\"1\"/>"
                                          "</MeshDomains>" TAIL,
                 laws[n].type, laws[n].given);
        lar_model *model = read_deck(deck);
        const lar_material *material = &model->material[0];
        assert_int_equal(material->law, laws[n].law);
        for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
            assert_true(fabs(material->parameter[k] - laws[n].parameter[k]) < 1e-15);
        assert_true(fabs(lar_material_shear(material) / laws[n].shear - 1) < 1e-6);
        assert_true(fabs(lar_material_bulk(material) / laws[n].bulk - 1) < 1e-12);
        lar_model_destroy(model);
    }
}

static void test_materials(void **state) {
    (void)state;
    lar_model *model = read_deck(
        HEAD4 CONTROL("DYNAMIC") "<Material><material id=\"1\" name=\"a\" type=\"Mooney-Rivlin\">"
                                 "<k>100</k><pressure_model>default</pressure_model><c1>3</c1>"
                                 "<c2>2</c2><laugon>0</laugon></material><material id=\"2\" "
                                 "name=\"b\" type=\"muscle\"/><material id=\"3\" name=\"c\" "
                                 "type=\"neo-Hookean\"><density>2</density><E>1</E><v>0</v>"
                                 "</material></Material>" MESH4
                                 "<MeshDomains><SolidDomain name=\"left\" mat=\"c\"/><SolidDomain "
                                 "name=\"right\" mat=\"1\"/></MeshDomains>" TAIL);
    assert_int_equal(model->material_count, 2);
    const lar_material *first = &model->material[0], *second = &model->material[1];
    assert_int_equal(model->element_material[0], 0);
    assert_int_equal(model->element_material[1], 1);
    assert_true(first->parameter[0] == 0.5 && first->parameter[1] == 0.0);
    assert_int_equal(second->law, LAR_LAW_mooney_rivlin);
    assert_true(second->parameter[0] == 3 && second->parameter[1] == 2 &&
                second->parameter[2] == 100);
    assert_true(second->density == 1.0);
    assert_int_equal(notices_with(model, "no density"), 1);
    assert_int_equal(notices_with(model, "<laugon>"), 0);
    assert_int_equal(notices_with(model, "material 'b' is not used"), 1);
    lar_model_destroy(model);
}

#define WITH_MATERIAL(material)                                                                    \
    HEAD4 CONTROL("DYNAMIC") "<Material>\n" material "</Material>" MESH4 DOMAINS TAIL

static void test_bad_materials(void **state) {
    (void)state;
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"muscle\"/>"),
                   LAR_ERROR_UNSUPPORTED, 6, "'muscle'");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"rigid body\"/>"),
                   LAR_ERROR_UNSUPPORTED, 6, "all elements are of rigid bodies");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"neo-Hookean\">\n"
                                 "<E>1</E></material>"),
                   LAR_ERROR_FORMAT, 6, "no parameter <v>");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"neo-Hookean\">\n"
                                 "<E>7</E><v>0.3</v>\n<E>1</E></material>"),
                   LAR_ERROR_FORMAT, 8, "a second <E> in one <material>");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"neo-Hookean\">\n"
                                 "<E>1</E><v>0.5</v></material>"),
                   LAR_ERROR_MODEL, 6, "Poisson's ratio");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"neo-Hookean\">\n"
                                 "<E>nan</E><v>0</v></material>"),
                   LAR_ERROR_FORMAT, 7, "no finite number");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"neo-Hookean\">"
                                 "<E>-1</E><v>0</v></material>"),
                   LAR_ERROR_MODEL, 6, "shear modulus");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"neo-Hookean\">\n"
                                 "<E type=\"map\">m</E><v>0</v></material>"),
                   LAR_ERROR_UNSUPPORTED, 7, "varies in space or time");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"Mooney-Rivlin\"><c1>1"
                                 "</c1><k>9</k>\n<pressure_model>NIKE3D</pressure_model>"
                                 "</material>"),
                   LAR_ERROR_UNSUPPORTED, 7, "'NIKE3D'");
#define YEOH(rest)                                                                                 \
    WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"Yeoh\">\n" rest "</material>")
    expect_failure(YEOH("<c1>1</c1>"), LAR_ERROR_FORMAT, 6, "no parameter <k>");
    expect_failure(YEOH("<c1>1</c1><k>9</k><c4>2</c4>"), LAR_ERROR_UNSUPPORTED, 6,
                   "<c4> is 2; Lariat's Yeoh law does not have that term");
    expect_failure(YEOH("<c1>1</c1><k>9</k><c3>inf</c3>"), LAR_ERROR_FORMAT, 7, "no finite number");
    expect_failure(YEOH("<c1>1</c1><k>9</k><c3>1e90</c3>"), LAR_ERROR_MODEL, 6, "check its unit");
    expect_failure(YEOH("<c1>-1</c1><k>9</k>"), LAR_ERROR_MODEL, 6, "shear modulus is -2 Pa");
    expect_failure(YEOH("<c1>1</c1><k>0</k>"), LAR_ERROR_MODEL, 6, "bulk modulus is 0 Pa");
    expect_failure(YEOH("<c1>1</c1><k>9</k><pressure_model>NIKE3D</pressure_model>"),
                   LAR_ERROR_UNSUPPORTED, 7, "'NIKE3D'");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"muscle\"/>"),
                   LAR_ERROR_UNSUPPORTED, 6,
                   "Lariat has neo-Hookean, Mooney-Rivlin, Yeoh, Arruda-Boyce, "
                   "Veronda-Westmann, Holmes-Mow and Ogden; Holzapfel-Gasser-Ogden and trans iso; "
                   "and mixtures, viscoelasticity, fibers and contractions of them, as "
                   "docs/formats.md lists them");
    static const char *const typos[][2] = {
        {WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"NEO-HOOKEAN\"/>"),
         "'NEO-HOOKEAN' is not read (did you mean 'neo-Hookean'?); of FEBio's"},
        {WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"Moony Rivlin\"/>"),
         "(did you mean 'Mooney-Rivlin'?)"},
        {WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"solid mixtures\"/>"),
         "(did you mean 'solid mixture'?)"},
        {WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"fiber-exp-pow\"/>"),
         "'fiber-exp-pow' is not read here; of FEBio's"},
    };
    for (size_t i = 0; i < sizeof typos / sizeof *typos; i++)
        expect_failure(typos[i][0], LAR_ERROR_UNSUPPORTED, 6, typos[i][1]);
#define OF_TYPE(type, rest)                                                                        \
    WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"" type "\">\n" rest "</material>")
#define TERMS "<t1>0.1</t1><g1>0.5</g1>"
#define SOFT  "<elastic type=\"neo-Hookean\"><E>3000</E><v>0.25</v></elastic>"
#define OGDEN "<elastic type=\"Ogden\"><k>0</k><c1>1</c1><m1>2</m1></elastic>"
    expect_failure(OF_TYPE("viscoelastic", TERMS), LAR_ERROR_FORMAT, 6, "no <elastic> inside");
    expect_failure(OF_TYPE("viscoelastic", TERMS "<elastic type=\"muscle\"/>"),
                   LAR_ERROR_UNSUPPORTED, 7, "material type 'muscle' is not read");
    expect_failure(OF_TYPE("viscoelastic", SOFT "<g1>0.5</g1>"), LAR_ERROR_FORMAT, 6,
                   "no parameter <t1>");
    expect_failure(OF_TYPE("viscoelastic", SOFT "<t1>0.1</t1><g1>-0.5</g1>"), LAR_ERROR_MODEL, 6,
                   "g of viscous term 1 is -0.5");
    expect_failure(OF_TYPE("viscoelastic", SOFT "<t1>0</t1><g1>0.5</g1>"), LAR_ERROR_MODEL, 6,
                   "the relaxation time of viscous term 1 is 0 s");
    expect_failure(OF_TYPE("viscoelastic", SOFT "<t1 lc=\"1\">1</t1><g1>0.5</g1>"),
                   LAR_ERROR_UNSUPPORTED, 7, "varies in space or time");
    expect_failure(OF_TYPE("viscoelastic", SOFT "<g0>2</g0>"), LAR_ERROR_UNSUPPORTED, 6,
                   "g0 is 2 and nothing relaxes");
    expect_failure(OF_TYPE("uncoupled viscoelastic", OGDEN TERMS), LAR_ERROR_FORMAT, 6,
                   "no parameter <k>");
    expect_failure(OF_TYPE("uncoupled viscoelastic", SOFT TERMS "<k>9</k>"), LAR_ERROR_UNSUPPORTED,
                   7, "'neo-Hookean' is no uncoupled material");
    lar_model *viscous = read_deck(
        OF_TYPE("uncoupled viscoelastic", OGDEN TERMS "<k>9</k><g0>2</g0><g2>0</g2><t2>0</t2>"));
    const lar_viscosity *v = &viscous->material[0].viscosity;
    assert_true(v->terms == 1 && v->isochoric && v->rest == 2 && v->share[0] == 0.5);
    assert_true(v->time[0] == 0.1 && viscous->material[0].law == LAR_LAW_ogden);
    assert_true(lar_material_bulk(&viscous->material[0]) == 9);
    lar_model_destroy(viscous);
    viscous =
        read_deck(OF_TYPE("viscoelastic", SOFT TERMS "<g2>1</g2><t2>1</t2><g3>2</g3><t3>2</t3>"
                                                     "<g4>3</g4><t4>4</t4><g5>4</g5><t5>5</t5>"
                                                     "<g6>5</g6><t6>9</t6>"));
    v = &viscous->material[0].viscosity;
    assert_true(v->terms == 6 && v->share[3] == 3 && v->share[5] == 5 && v->time[5] == 9);
    lar_model_destroy(viscous);
    viscous = read_deck(OF_TYPE("viscoelastic", SOFT TERMS));
    v = &viscous->material[0].viscosity;
    assert_true(v->terms == 1 && !v->isochoric && v->rest == 1);
    lar_model_destroy(viscous);
    expect_failure(OF_TYPE("Ogden", "<c1>1</c1><m1>200</m1><k>9</k>"), LAR_ERROR_MODEL, 6,
                   "m1 of the law ogden is 200");
    expect_failure(OF_TYPE("Ogden", "<c1>1</c1><m1>2</m1><c4>1</c4><m4>3</m4><k>9</k>"),
                   LAR_ERROR_UNSUPPORTED, 6, "<c4> is 1; Lariat's Ogden law");
    expect_failure(OF_TYPE("Ogden", "<c1>1</c1><m1>2</m1><c3>-1</c3><m3>3</m3><k>9</k>"),
                   LAR_ERROR_MODEL, 6, "shear modulus is 0 Pa");
    expect_failure(OF_TYPE("Arruda-Boyce", "<mu>1</mu><k>9</k>"), LAR_ERROR_FORMAT, 6,
                   "no parameter <N>");
    expect_failure(OF_TYPE("Arruda-Boyce", "<mu>1</mu><N>-4</N><k>9</k>"), LAR_ERROR_MODEL, 6,
                   "N of the law arruda-boyce is -4; it has no unit and must be between");
    expect_failure(OF_TYPE("Veronda-Westmann", "<c1>1</c1><c2>1e5</c2><k>9</k>"), LAR_ERROR_MODEL,
                   6, "c2 of the law veronda-westmann is 100000");
    expect_failure(OF_TYPE("Holmes-Mow", "<E>1</E><v>0.5</v><beta>1</beta>"), LAR_ERROR_MODEL, 6,
                   "Poisson's ratio v = 0.5");
    expect_failure(OF_TYPE("Holmes-Mow", "<E>1</E><v>0.2</v><beta>0</beta>"), LAR_ERROR_MODEL, 6,
                   "beta of the law holmes-mow is 0");
    expect_failure(OF_TYPE("Holmes-Mow", "<E>1</E><v>0.2</v><beta>nan</beta>"), LAR_ERROR_FORMAT, 7,
                   "no finite number");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"hard\" type=\"neo-Hookean\"/>"),
                   LAR_ERROR_FORMAT, 0, "names the material 'soft'");
    expect_failure(WITH_MATERIAL("<material name=\"soft\" type=\"neo-Hookean\"/>"),
                   LAR_ERROR_FORMAT, 6, "no attribute id");
    expect_failure(WITH_MATERIAL("<material id=\"0\" name=\"soft\" type=\"neo-Hookean\"/>"),
                   LAR_ERROR_FORMAT, 6, "out of range");
    expect_failure(WITH_MATERIAL("<material id=\"1\" type=\"x\"/>\n<material id=\"1\"/>"),
                   LAR_ERROR_FORMAT, 7, "second material has the id 1");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"neo-Hookean\"/>"
                                 "<material id=\"2\" name=\"soft\" type=\"neo-Hookean\"/>"),
                   LAR_ERROR_FORMAT, 0, "two in <Material> are called so");
    expect_failure(HEAD4 CONTROL("DYNAMIC") MATERIAL MESH4 TAIL, LAR_ERROR_MODEL, 2,
                   "element 1 has no material");
}

#define WITH_MESH(mesh) HEAD4 CONTROL("DYNAMIC") MATERIAL "<Mesh>\n" mesh "</Mesh>" DOMAINS TAIL

static void test_bad_meshes(void **state) {
    (void)state;
    expect_failure(WITH_MESH("<Nodes>\n<node>0,0,0</node></Nodes>"), LAR_ERROR_FORMAT, 8,
                   "no attribute id");
    expect_failure(WITH_MESH("<Nodes>\n<node id=\"a\">0,0,0</node></Nodes>"), LAR_ERROR_FORMAT, 8,
                   "no whole number");
    expect_failure(WITH_MESH("<Nodes>\n<node id=\"1\">0,0</node></Nodes>"), LAR_ERROR_FORMAT, 8,
                   "holds 2 values where 3");
    expect_failure(WITH_MESH("<Nodes>\n<node id=\"1\">0,nan,0</node></Nodes>"), LAR_ERROR_FORMAT, 8,
                   "'nan'");
    expect_failure(WITH_MESH("<Nodes>\n<vertex/></Nodes>"), LAR_ERROR_FORMAT, 8, "<vertex>");
    expect_failure(WITH_MESH(NODES "<Elements type=\"hex8\">\n<elem id=\"1\">1,2,3,4,5,6,7</elem>"
                                   "</Elements>"),
                   LAR_ERROR_FORMAT, 11, "holds 7 values where 8");
    expect_failure(WITH_MESH(NODES "<Elements type=\"hex8\">\n<elem id=\"1\">1,2,3,4,5,6,7,77"
                                   "</elem></Elements>"),
                   LAR_ERROR_FORMAT, 11, "node 77");
    expect_failure(WITH_MESH(NODES "<Elements type=\"tet4\" name=\"t\"/>"), LAR_ERROR_UNSUPPORTED,
                   10, "type tet4");
    expect_failure(WITH_MESH(NODES PARTS "<NodeSet>1</NodeSet>"), LAR_ERROR_FORMAT, 12,
                   "no attribute name");
    expect_failure(WITH_MESH(NODES PARTS "<NodeSet name=\"a\">1,\n2,x</NodeSet>"), LAR_ERROR_FORMAT,
                   13, "'x' in a set");
    expect_failure(WITH_MESH(NODES PARTS "<NodeSet name=\"a\">\n1,\n55</NodeSet>"),
                   LAR_ERROR_FORMAT, 14, "node 55");
    expect_failure(WITH_MESH(NODES PARTS "<NodeSet name=\"a\">1</NodeSet>\n<NodeSet name=\"a\"/>"),
                   LAR_ERROR_FORMAT, 13, "second node set");
    expect_failure(WITH_MESH(NODES PARTS "<Surface name=\"s\">\n<quad4>1,2,3,7</quad4></Surface>"),
                   LAR_ERROR_FORMAT, 13, "not a face");
    expect_failure(WITH_MESH(NODES), LAR_ERROR_MODEL, 0, "");
    expect_failure(HEAD4 TAIL, LAR_ERROR_FORMAT, 2, "no <Mesh>");
    expect_failure(HEAD4 "<Mesh from=\"x.feb\"/>" TAIL, LAR_ERROR_UNSUPPORTED, 4, "another file");
}

/* ---- sections -------------------------------------------------------------------------------- */

#define GRAVITY                                                                                    \
    "<Loads><body_load "                                                                           \
    "type=\"gravity\"><x>0</x><y>0</y><z>9.81</z></body_load></Loads>"
#define VISCOUS                                                                                    \
    "<Material><material id=\"7\" name=\"soft\" type=\"viscoelastic\"><density>1000</density>"     \
    "<t1>1</t1><g1>1</g1><elastic type=\"neo-Hookean\"><E>3000</E><v>0.25</v></elastic>"           \
    "</material></Material>\n"
static const double PI = 3.14159265358979;

static void test_static_and_step(void **state) {
    (void)state;
    lar_model *model = read_deck(HEAD4 CONTROL("STATIC") MATERIAL MESH4 DOMAINS GRAVITY TAIL);
    assert_int_equal(notices_with(model, "the analysis is static"), 1);
    /* twice within the second of the deck: 2 omega = 4 pi / (1/2 s), and density so that this is
     * pi sqrt(1200 / density) / 2, the body being 2 long; its weight stays what it is */
    assert_true(fabs(model->damping / (8 * PI) - 1) < 1e-12);
    assert_true(fabs(model->material[0].density / (1200.0 / 256) - 1) < 1e-12);
    assert_true(fabs(model->material[0].density * model->gravity[2] / -9810 - 1) < 1e-12);
    assert_int_equal(lar_model_until_rest(model), 1);
    lar_model_destroy(model);

    /* in 100 s it would swing 14 times with its own mass, in 1000 s more than 20 times */
    const double seconds[] = {10, 100}, damping[] = {1.7207, 4 * PI / 50};
    for (int i = 0; i < 2; i++) {
        char text[6000];
        snprintf(text, sizeof text,
                 HEAD4 "<Control><time_steps>10</time_steps><step_size>%g</step_size></Control>%s",
                 seconds[i], MATERIAL MESH4 DOMAINS TAIL);
        model = read_deck(text);
        assert_true(fabs(model->damping / damping[i] - 1) < 1e-4);
        assert_true(i == 1 || fabs(model->material[0].density / 1000 - 1) < 1e-12);
        lar_model_destroy(model);
    }

    /* what is viscous has a time of its own: to the deck's end, a hundred times as fast */
    model = read_deck(HEAD4 CONTROL("STATIC") VISCOUS MESH4 DOMAINS GRAVITY TAIL);
    assert_int_equal(notices_with(model, "to the deck's end, 1 s"), 1);
    assert_int_equal(lar_model_until_rest(model), 0);
    assert_true(lar_model_duration(model) == 1);
    assert_true(fabs(model->damping / (0.1 * 400 * PI) - 1) < 1e-12);
    assert_true(fabs(model->material[0].density * model->gravity[2] / -9810 - 1) < 1e-12);
    lar_model_destroy(model);

    /* without an end of its own it is followed to rest, and without a period in its own time */
    model = read_deck(HEAD4 VISCOUS MESH4 DOMAINS TAIL);
    assert_int_equal(lar_model_until_rest(model), 1);
    assert_true(model->material[0].density == 1000);
    lar_model_destroy(model);

    /* the loads end with the deck's last step, 1 s, whatever their curves do behind it */
    model = read_deck(HEAD4 CONTROL("STATIC") MATERIAL MESH4 DOMAINS
                      "<Boundary><bc type=\"prescribe\" node_set=\"tip\"><dof>x</dof>"
                      "<scale lc=\"1\">1</scale></bc></Boundary>\n<LoadData>" CURVE(
                          "1", "LINEAR", "CONSTANT",
                          "<pt>0,0</pt><pt>0.5,1</pt><pt>2,4</pt>") "</LoadData>" TAIL);
    const lar_curve *curve = &model->curve[model->move[0].curve];
    assert_true(lar_curve_end(curve) == 1.0);
    assert_true(lar_curve_value(curve, 0.75) == 1.5 && lar_curve_value(curve, 9) == 2.0);
    lar_model_destroy(model);

    model = read_deck(HEAD4 MATERIAL MESH4 DOMAINS "<Step><step id=\"1\">" CONTROL(
        "DYNAMIC") "<Boundary><bc type=\"fix\" "
                   "node_set=\"wall\"><dofs>x,y,z</dofs></bc></Boundary></step></Step>" TAIL);
    assert_int_equal(model->fix_count, 1);
    assert_true(fabs(model->duration - 1.0) < 1e-12);
    lar_model_destroy(model);
}

static void test_sections(void **state) {
    (void)state;
    enum { LINE = BC_LINE - 1 };
    lar_model *model = read_deck(BASE4 "<Contact/><Rigid></Rigid><Output><plotfile/></Output>"
                                       "<Globals/><MeshData><NodeData/></MeshData>\n"
                                       "<Extras><one/></Extras><Hopes>1</Hopes><Step><step>"
                                       "<Dreams>1</Dreams></step></Step>" TAIL);
    assert_int_equal(notices_with(model, "deck.feb:22: the section <Hopes>"), 1);
    assert_int_equal(notices_with(model, "deck.feb:22: the section <Dreams>"), 1);
    assert_int_equal(notices_with(model, "deck.feb:21: <MeshData>"), 1);
    assert_int_equal(notices_with(model, "deck.feb:22: the section <Extras>"), 1);
    lar_model_destroy(model);
    model =
        read_deck(HEAD4 "<Control><analysis>DYNAMIC</analysis><time_steps>1</time_steps>"
                        "<step_size lc=\"1\">1</step_size><solver><dyn_damping>0.9</dyn_damping>"
                        "</solver></Control>" MATERIAL MESH4 DOMAINS
                        "<Boundary><bc lc=\"1\" type=\"fix\" node_set=\"tip\"><dofs>x</dofs><warp/>"
                        "</bc></Boundary>" TAIL);
    assert_int_equal(notices_with(model, "<dyn_damping> 0.9"), 1);
    assert_int_equal(notices_with(model, "<warp> in <bc>"), 1);
    assert_int_equal(notices_with(model, "the attribute lc of <step_size>"), 1);
    assert_int_equal(notices_with(model, "the attribute lc of <bc>"), 1);
    lar_model_destroy(model);
    expect_failure(BASE4 "<Contact>\n<contact type=\"sliding\"/></Contact>" TAIL,
                   LAR_ERROR_UNSUPPORTED, LINE + 1, "<contact> of type 'sliding' is not read");
    expect_failure(BASE4 "<Rigid>\n<rigid_bc/></Rigid>" TAIL, LAR_ERROR_FORMAT, LINE + 1, "type");
    expect_failure(BASE4 "<Constraints>\n<constraint/></Constraints>" TAIL, LAR_ERROR_UNSUPPORTED,
                   LINE + 1, "constraints");
    expect_failure(BASE4 "<Discrete>\n<discrete/></Discrete>" TAIL, LAR_ERROR_UNSUPPORTED, LINE + 1,
                   "springs");
    expect_failure(BASE4 "<Step><step id=\"1\"/>\n<step id=\"2\"/></Step>" TAIL,
                   LAR_ERROR_UNSUPPORTED, LINE + 1, "several steps");
    expect_failure(BASE4 "<Include>x.feb</Include>" TAIL, LAR_ERROR_UNSUPPORTED, LINE, "<Include>");
    expect_failure(BASE4 "<Loads from=\"x.feb\"/>" TAIL, LAR_ERROR_UNSUPPORTED, LINE, "<Loads>");
    static const char *const apart[] = {"Material", "LoadData", "MeshDomains", "Step"};
    for (int i = 0; i < 4; i++) {
        char text[200];
        snprintf(text, sizeof text, HEAD4 "<%s from=\"x.feb\"/>" TAIL, apart[i]);
        expect_failure(text, LAR_ERROR_UNSUPPORTED, 4, "stands in another file (from=");
    }
    expect_failure(BASE4 "<Boundary>\n<bc from=\"x.feb\"/></Boundary>" TAIL, LAR_ERROR_UNSUPPORTED,
                   LINE + 1, "<bc> stands in another file");
    expect_failure(BASE4 "<Mesh/>" TAIL, LAR_ERROR_UNSUPPORTED, LINE, "second <Mesh>");
    expect_failure(HEAD4 CONTROL("MODAL") MATERIAL MESH4 DOMAINS TAIL, LAR_ERROR_UNSUPPORTED, 4,
                   "'MODAL'");
    expect_failure("<febio_spec version=\"4.0\"><Module type=\"biphasic\"/>" TAIL,
                   LAR_ERROR_UNSUPPORTED, 1, "'biphasic'");
    expect_failure("<febio_spec version=\"2.0\">" TAIL, LAR_ERROR_UNSUPPORTED, 1,
                   "save it as version 4.0");
    expect_failure("<febio_spec>" TAIL, LAR_ERROR_FORMAT, 1, "no attribute version");
    expect_failure("<mesh/>", LAR_ERROR_FORMAT, 1, "<mesh>");
    expect_failure("", LAR_ERROR_FORMAT, 0, "too few");
    expect_failure(" ", LAR_ERROR_FORMAT, 1, "well-formed");
    expect_failure("<a>\n<b></a>", LAR_ERROR_FORMAT, 2, "well-formed");
}

/* Words that nobody knows are named; those of solvers, and the second one of a kind, are not. */
static void test_wrong_words(void **state) {
    (void)state;
    lar_model *model = read_deck(
        HEAD4
        "<Control><analysis>DYNAMIC</analysis><time_steps>1</time_steps><step_size>1"
        "</step_size><max_refs>15</max_refs><plot_level>PLOT_NEVER</plot_level><solver "
        "type=\"solid\"><dtol>1e-3</dtol></solver>\n<final_time>5</final_time></Control>" MATERIAL
            MESH4 DOMAINS "<Boundary>\n<bc type=\"prescribe\" node_set=\"tip\" name=\"a\">"
        "<dof>x</dof>\n<scale LC=\"1\">0.5</scale></bc></Boundary>\n<Loads>"
        "<body_load type=\"const\" elemset=\"left\"><z>1</z></body_load>"
        "</Loads><Output><plotfile colour=\"red\"/></Output>" LINEAR1 TAIL);
    assert_int_equal(model->notice_count, 5); /* and a node that nothing uses */
    assert_int_equal(notices_with(model, "deck.feb:5: <final_time> in <Control> is not known"), 1);
    assert_int_equal(notices_with(model, "deck.feb:23: the attribute LC of <scale> is not known"),
                     1);
    assert_int_equal(notices_with(model, "the attribute elemset of <body_load>"), 1);
    assert_int_equal(notices_with(model, "deck.feb:23: this displacement is there "
                                         "at once"),
                     1);
    lar_model_destroy(model);
    expect_failure(HEAD4 "<Control><time_steps>1</time_steps>\n<time_steps>2</time_steps>"
                         "</Control>" MATERIAL MESH4 DOMAINS TAIL,
                   LAR_ERROR_FORMAT, 5, "a second <time_steps> in one <Control>");
    model =
        read_deck(BASE4 "<Boundary><bc type=\"fix\" node_set=\"wall\"><dofs>x</dofs><y_dof>1"
                        "</y_dof></bc><bc type=\"prescribe\" node_set=\"tip\"><dof>x</dof>"
                        "<value>0</value></bc></Boundary><Step><step><Material>"
                        "<a/></Material></step></Step><LoadData><load_controller id=\"1\" "
                        "type=\"loadcurve\"><extent>REPEAT</extent><points><pt>0,0</pt></points>"
                        "</load_controller></LoadData>" TAIL);
    assert_int_equal(model->notice_count, 4);
    assert_int_equal(notices_with(model, "<y_dof> in <bc> is not known"), 1);
    assert_int_equal(notices_with(model, "the section <Material> is not known"), 1);
    assert_int_equal(notices_with(model, "<extent> in <load_controller> is not known"), 1);
    lar_model_destroy(model);
    expect_failure(BASE4 "<Step><step>\n" CONTROL("STATIC") "</step></Step>" TAIL,
                   LAR_ERROR_UNSUPPORTED, BC_LINE, "a second <Control>, of a step");
}

/* ---- the mesh alone -------------------------------------------------------------------------- */

static void test_mesh_only(void **state) {
    (void)state;
    const char *text = HEAD4 "<Material><material id=\"3\" name=\"stone\" type=\"rigid body\"/>"
                             "</Material>" MESH4
                             "<MeshDomains><SolidDomain name=\"left\" mat=\"stone\"/></MeshDomains>"
                             "<Contact><contact type=\"sliding\"/></Contact>" TAIL;
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    lar_error error = {0};
    lar_mesh mesh = {0};
    assert_int_equal(lar_feb_parse_mesh("deck.feb", &bytes, &mesh, &error), LAR_OK);
    assert_int_equal(mesh.element_count, 2);
    assert_int_equal(mesh.element_tag[0], 3);
    assert_int_equal(mesh.element_tag[1], 0);
    assert_int_equal(mesh.dropped_node_count, 1);
    assert_non_null(lar_mesh_find_set(&mesh, "end", LAR_SET_FACES));
    lar_mesh_clear(&mesh);
    lar_bytes_free(&bytes);
}

/* ---- hostile files --------------------------------------------------------------------------- */

static void test_entities(void **state) {
    (void)state;
    expect_failure("<?xml version=\"1.0\"?>\n<!DOCTYPE b [<!ENTITY a \"aaaa\"><!ENTITY b "
                   "\"&a;&a;&a;&a;\">]>\n<febio_spec version=\"4.0\">&b;</febio_spec>",
                   LAR_ERROR_FORMAT, 2, "<!DOCTYPE");
    expect_failure("<!DOCTYPE f SYSTEM \"file:///etc/passwd\"><febio_spec version=\"4.0\"/>",
                   LAR_ERROR_FORMAT, 1, "<!DOCTYPE");
    expect_failure(HEAD4 "<Mesh>&undefined;</Mesh>" TAIL, LAR_ERROR_FORMAT, 4, "");
    /* predefined entities and comments are ordinary text */
    lar_model *model =
        read_deck(HEAD4 CONTROL("DYNAMIC") MATERIAL
                  "<Mesh>" NODES PARTS
                  "<NodeSet name=\"a&amp;b&#38;c\">1,2<!-- not 3 -->,4</NodeSet></Mesh>" DOMAINS
                  "<Boundary><bc type=\"fix\" node_set=\"a&amp;b&amp;c\"><dofs><![CDATA[x]]></dofs>"
                  "</bc></Boundary>" TAIL);
    assert_int_equal(model->fix[0].nodes.count, 3);
    lar_model_destroy(model);
}

/* A range in a set, as FEBio reads it: both ends belong to it. */
static void test_ranges(void **state) {
    (void)state;
    lar_model *model = read_deck(
        HEAD4 CONTROL("DYNAMIC") MATERIAL
        "<Mesh>" NODES PARTS "<NodeSet name=\"some\">2:4, 5:8:2 9</NodeSet></Mesh>" DOMAINS
        "<Boundary><bc type=\"zero displacement\" node_set=\"some\"><x_dof>1</x_dof>"
        "</bc></Boundary>" TAIL);
    assert_int_equal(model->fix[0].nodes.count, 6); /* 2 3 4, 5 7, 9 */
    lar_model_destroy(model);
    static const char *const bad[] = {"4:2", "2:4:0", "2:", ":2", "1:2:1:1", "-1:2", "2:4:-1"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[4000], words[80];
        snprintf(text, sizeof text,
                 HEAD4 "<Mesh>" NODES PARTS "<NodeSet name=\"a\">%s</NodeSet></Mesh>" TAIL, bad[i]);
        snprintf(words, sizeof words, "'%s' in a set is no id", bad[i]);
        expect_failure(text, LAR_ERROR_FORMAT, 0, words);
    }
    expect_failure(WITH_MESH(NODES PARTS "<NodeSet name=\"a\">1:9223372036854775807</NodeSet>"),
                   LAR_ERROR_FORMAT, 0, "names more ids than such a deck can have");
}

/* FEBio's explicit solver integrates inertia, whatever the analysis is called. */
static void test_explicit_solver(void **state) {
    (void)state;
#define EXPLICIT(words)                                                                            \
    HEAD4 "<Control>" words "<time_steps>10</time_steps><step_size>0.1</step_size>"                \
          "<solver type=\"explicit-solid\"/></Control>\n" MATERIAL MESH4 DOMAINS TAIL
    lar_model *model = read_deck(EXPLICIT(""));
    assert_false(model->until_rest);
    assert_int_equal(notices_with(model, "the explicit solver has inertia"), 0);
    lar_model_destroy(model);
    model = read_deck(EXPLICIT("<analysis>STATIC</analysis>"));
    assert_false(model->until_rest);
    assert_int_equal(notices_with(model, "the explicit solver has inertia"), 1);
    lar_model_destroy(model);
#undef EXPLICIT
}

/* Every prefix and every damaged byte ends in a result or a message. */
static void test_damage(void **state) {
    (void)state;
    const char *deck =
        BASE4 "<Boundary><bc type=\"zero displacement\" node_set=\"@part_list:both\"><x_dof>1"
              "</x_dof></bc></Boundary><Loads><surface_load type=\"pressure\" surface=\"end\">"
              "<pressure lc=\"1\">50</pressure></surface_load></Loads>" LINEAR1 TAIL;
    size_t size = strlen(deck);
    for (size_t length = 0; length < size - 1; length++) {
        lar_error error = {0};
        lar_model *model = NULL;
        assert_int_not_equal(parse_bytes(deck, length, &model, &error), LAR_OK);
        assert_true(error.message[0] != '\0');
    }
    char *copy = lar_strdup(deck);
    static const char bad[] = {'\0', '<', '"', '9', '-', ' ', (char)0xff};
    for (size_t i = 0; i < size; i++) {
        copy[i] = bad[i % sizeof bad];
        lar_error error = {0};
        lar_model *model = NULL;
        if (parse_bytes(copy, size, &model, &error) == LAR_OK)
            lar_model_destroy(model);
        else
            assert_true(error.message[0] != '\0');
        copy[i] = deck[i];
    }
    free(copy);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_version_4),       cmocka_unit_test(test_version_3),
        cmocka_unit_test(test_materials),       cmocka_unit_test(test_stiffening_laws),
        cmocka_unit_test(test_bad_materials),   cmocka_unit_test(test_bad_meshes),
        cmocka_unit_test(test_static_and_step), cmocka_unit_test(test_wrong_words),
        cmocka_unit_test(test_sections),        cmocka_unit_test(test_mesh_only),
        cmocka_unit_test(test_entities),        cmocka_unit_test(test_ranges),
        cmocka_unit_test(test_explicit_solver), cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests_name("feb", tests, NULL, NULL);
}
