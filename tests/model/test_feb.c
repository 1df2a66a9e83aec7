/* FEBio decks: what is read, what is refused and where, and damaged files. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "model/format/mesh_io.h"
#include "model/model.h"

/* ---- decks made of pieces ---------------------------------------------------------------------
 */

#define HEAD4 "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n<Module type=\"solid\"/>\n"
#define CONTROL(analysis)                                                                          \
    "<Control><analysis>" analysis                                                                 \
    "</analysis><time_steps>10</time_steps><step_size>0.1</step_size></Control>\n"
#define MATERIAL                                                                                   \
    "<Material><material id=\"7\" name=\"soft\" type=\"neo-Hookean\"><density>1000</density>"      \
    "<E>3000</E><v>0.25</v></material></Material>\n"
/* Two cubes side by side in x, and a node that nothing uses. */
#define NODES                                                                                      \
    "<Nodes name=\"all\">\n<node id=\"1\">0,0,0</node><node id=\"2\">1,0,0</node>"                 \
    "<node id=\"3\">1,1,0</node><node id=\"4\">0,1,0</node><node id=\"5\">0,0,1</node>"            \
    "<node id=\"6\">1,0,1</node><node id=\"7\">1,1,1</node><node id=\"8\">0,1,1</node>"            \
    "<node id=\"9\">2,0,0</node><node id=\"10\">2,1,0</node><node id=\"11\">2,0,1</node>"          \
    "<node id=\"12\">2,1,1</node><node id=\"99\">5,5,5</node>\n</Nodes>\n"
#define PARTS                                                                                      \
    "<Elements type=\"hex8\" name=\"left\"><elem id=\"1\">1,2,3,4,5,6,7,8</elem></Elements>\n"     \
    "<Elements type=\"hex8\" name=\"right\"><elem id=\"2\">2,9,10,3,6,11,12,7</elem></Elements>\n"
#define SETS4                                                                                      \
    "<NodeSet name=\"wall\">1,4,\n5,8</NodeSet>\n<NodeSet name=\"tip\">9, 10 11,12</NodeSet>\n"    \
    "<ElementSet name=\"one\">2</ElementSet>\n"                                                    \
    "<Surface name=\"end\"><quad4 id=\"1\">9,10,12,11</quad4></Surface>\n"                         \
    "<Surface name=\"inward\"><quad4 id=\"1\">9,11,12,10</quad4></Surface>\n"                      \
    "<PartList name=\"both\">left, right</PartList>\n"
#define MESH4 "<Mesh>\n" NODES PARTS SETS4 "</Mesh>\n"
#define DOMAINS                                                                                    \
    "<MeshDomains><SolidDomain name=\"left\" mat=\"soft\"/><SolidDomain name=\"right\" "           \
    "mat=\"soft\"/></MeshDomains>\n"
#define BASE4 HEAD4 CONTROL("DYNAMIC") MATERIAL MESH4 DOMAINS
#define CURVE(id, interpolate, extend, points)                                                     \
    "<load_controller id=\"" id "\" type=\"loadcurve\"><interpolate>" interpolate                  \
    "</interpolate><extend>" extend "</extend><points>" points "</points></load_controller>"
#define LINEAR1                                                                                    \
    "<LoadData>" CURVE("1", "LINEAR", "CONSTANT", "<pt>0,0</pt><pt>1,2</pt>") "</LoadData>\n"
#define TAIL "</febio_spec>\n"

static lar_status parse_bytes(const char *text, size_t size, lar_model **model, lar_error *error) {
    /* A copy of the exact size, so that the address sanitizer sees reads beyond it. */
    lar_bytes bytes = {malloc(size + 1), size};
    assert_non_null(bytes.data);
    memcpy(bytes.data, text, size);
    bytes.data[size] = 0;
    lar_status status = lar_feb_parse("deck.feb", &bytes, model, error);
    free(bytes.data);
    return status;
}

static lar_model *read_deck(const char *text) {
    lar_error error = {0};
    lar_model *model = NULL;
    if (parse_bytes(text, strlen(text), &model, &error)) fail_msg("%s", error.message);
    return model;
}

/* The deck must fail with this status and a message that begins with deck.feb:LINE: (line 0: any)
 * and holds the words. */
static void expect_failure(const char *text, lar_status status, int line, const char *words) {
    lar_error error = {0};
    lar_model *model = NULL;
    lar_status got = parse_bytes(text, strlen(text), &model, &error);
    char start[40];
    snprintf(start, sizeof start, "deck.feb:%d: ", line);
    if (got != status || !strstr(error.message, words) ||
        (line && strncmp(error.message, start, strlen(start)) != 0))
        fail_msg("status %d (wanted %d), message '%s', wanted '%s...%s'", got, status,
                 error.message, start, words);
    assert_null(model);
}

static int notices_with(const lar_model *model, const char *words) {
    int count = 0;
    for (int i = 0; i < model->notice_count; i++) count += strstr(model->notice[i], words) != NULL;
    return count;
}

/* ---- mesh and materials ------------------------------------------------------------------------
 */

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
    assert_int_equal(notices_with(model, "<laugon>"), 1);
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
                   LAR_ERROR_UNSUPPORTED, 0, "the elements of part 'left' are a rigid body");
    expect_failure(WITH_MATERIAL("<material id=\"1\" name=\"soft\" type=\"neo-Hookean\">\n"
                                 "<E>1</E></material>"),
                   LAR_ERROR_FORMAT, 6, "no parameter <v>");
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
                   "Veronda-Westmann, Holmes-Mow and Ogden");
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
    expect_failure(OF_TYPE("viscoelastic", SOFT TERMS "<g2>1</g2><t2>1</t2><g3>1</g3><t3>2</t3>"
                                                      "<g6>1</g6><t6>9</t6>"),
                   LAR_ERROR_UNSUPPORTED, 6, "more than 3 terms of relaxation");
    expect_failure(OF_TYPE("uncoupled viscoelastic", OGDEN TERMS), LAR_ERROR_FORMAT, 6,
                   "no parameter <k>");
    expect_failure(OF_TYPE("uncoupled viscoelastic", SOFT TERMS "<k>9</k>"), LAR_ERROR_MODEL, 6,
                   "has no isochoric part that could relax alone");
    lar_model *viscous = read_deck(
        OF_TYPE("uncoupled viscoelastic", OGDEN TERMS "<k>9</k><g0>2</g0><g2>0</g2><t2>0</t2>"));
    const lar_viscosity *v = &viscous->material[0].viscosity;
    assert_true(v->terms == 1 && v->isochoric && v->rest == 2 && v->share[0] == 0.5);
    assert_true(v->time[0] == 0.1 && viscous->material[0].law == LAR_LAW_ogden);
    assert_true(lar_material_bulk(&viscous->material[0]) == 9);
    lar_model_destroy(viscous);
    viscous = read_deck(OF_TYPE("viscoelastic", SOFT TERMS));
    v = &viscous->material[0].viscosity;
    assert_true(v->terms == 1 && !v->isochoric && v->rest == 1);
    lar_model_destroy(viscous);
    expect_failure(OF_TYPE("Ogden", "<c1>1</c1><k>9</k>"), LAR_ERROR_MODEL, 6,
                   "m1 of the law ogden is 0; it is the power of the term of c1");
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
    expect_failure(WITH_MESH(NODES PARTS "<Surface name=\"s\">\n<tri3>1,2,3</tri3></Surface>"),
                   LAR_ERROR_UNSUPPORTED, 13, "<tri3>");
    expect_failure(WITH_MESH(NODES PARTS "<Surface name=\"s\">\n<quad4>1,2,3,7</quad4></Surface>"),
                   LAR_ERROR_FORMAT, 13, "not a face");
    expect_failure(WITH_MESH(NODES), LAR_ERROR_MODEL, 0, "");
    expect_failure(HEAD4 TAIL, LAR_ERROR_FORMAT, 2, "no <Mesh>");
    expect_failure(HEAD4 "<Mesh from=\"x.feb\"/>" TAIL, LAR_ERROR_UNSUPPORTED, 4, "another file");
}

/* ---- conditions --------------------------------------------------------------------------------
 */

static void test_supports(void **state) {
    (void)state;
    lar_model *model = read_deck(
        BASE4 "<Boundary><bc type=\"zero displacement\" node_set=\"wall\"><x_dof>1</x_dof>"
              "<y_dof>0</y_dof><z_dof>1</z_dof></bc>"
              "<bc type=\"fixed displacement\" node_set=\"@part_list:both\"><dofs>y</dofs></bc>"
              "<bc type=\"prescribed displacement\" node_set=\"@surface:end\"><dof>x</dof>"
              "<value lc=\"1\">-0.25</value><relative>0</relative></bc>"
              "<bc type=\"prescribed displacement\" node_set=\"@elem_set:one\"><dof>z</dof>"
              "<value>1e-3</value></bc></Boundary>" LINEAR1 TAIL);
    assert_int_equal(model->fix_count, 2);
    assert_int_equal(model->fix[0].axes, LAR_AXIS_X | LAR_AXIS_Z);
    assert_int_equal(model->fix[0].nodes.count, 4);
    assert_int_equal(model->fix[0].nodes.node[1], 3);
    assert_int_equal(model->fix[1].axes, LAR_AXIS_Y);
    assert_int_equal(model->fix[1].nodes.count, 12);
    assert_int_equal(model->move_count, 2);
    assert_int_equal(model->move[0].nodes.count, 4);
    assert_int_equal(model->move[0].nodes.node[0], 8);
    assert_true(model->move[0].by == -0.25);
    assert_true(lar_curve_value(&model->curve[model->move[0].curve], 0.5) == 1.0);
    assert_int_equal(model->move[1].nodes.count, 8);
    assert_true(lar_curve_value(&model->curve[model->move[1].curve], 0.0) == 1.0);
    assert_int_equal(model->curve_count, 2);
    lar_model_destroy(model);
}

static void test_loads(void **state) {
    (void)state;
    lar_model *model = read_deck(
        BASE4 "<Loads><nodal_load type=\"nodal_force\" node_set=\"tip\"><value lc=\"1\">1,2,3"
              "</value></nodal_load><nodal_load type=\"nodal_load\" node_set=\"wall\"><dof>y</dof>"
              "<scale lc=\"1\">-4</scale></nodal_load>"
              "<surface_load type=\"pressure\" surface=\"end\"><pressure lc=\"1\">50</pressure>"
              "<linear>1</linear></surface_load>"
              "<surface_load type=\"pressure\" surface=\"inward\"><pressure>50</pressure>"
              "<symmetric_stiffness>1</symmetric_stiffness></surface_load>"
              "<body_load type=\"const\" elem_set=\"@part_list:both\"><x>0</x><z lc=\"1\">9.81</z>"
              "</body_load></Loads><Initial><ic type=\"velocity\" node_set=\"tip\">"
              "<value>0,0,-2</value></ic></Initial>" LINEAR1 TAIL);
    assert_int_equal(model->load_count, 2);
    assert_true(model->load[0].force[2] == 3.0 && model->load[0].nodes.count == 4);
    assert_true(model->load[1].force[1] == -4.0 && model->load[1].force[0] == 0.0);
    assert_int_equal(model->pressure_count, 2);
    assert_true(model->pressure[0].pressure == 50.0 && model->pressure[0].face[0] == 7);
    assert_true(model->pressure[1].pressure == -50.0 && model->pressure[1].count == 1);
    assert_int_equal(notices_with(model, "<linear>"), 1);
    assert_int_equal(notices_with(model, "normals into the body"), 1);
    assert_true(model->gravity[2] == -9.81 && model->gravity[0] == 0.0);
    assert_int_equal(model->gravity_curve[2], model->load[0].curve);
    assert_int_equal(model->gravity_curve[1], -1);
    assert_int_equal(model->initial_count, 1);
    assert_true(model->initial[0].velocity[2] == -2.0 && model->initial[0].nodes.count == 4);
    lar_model_destroy(model);
}

#define BC(type, set, content)                                                                     \
    BASE4 "<Boundary>\n<bc type=\"" type "\" node_set=\"" set "\">\n" content                      \
          "</bc></Boundary>" LINEAR1 TAIL
enum { BC_LINE = 22 };

static void test_bad_supports(void **state) {
    (void)state;
    expect_failure(BC("zero displacement", "none", "<x_dof>1</x_dof>"), LAR_ERROR_FORMAT, BC_LINE,
                   "node set 'none'");
    expect_failure(BC("zero displacement", "@edge:e", "<x_dof>1</x_dof>"), LAR_ERROR_UNSUPPORTED,
                   BC_LINE, "@edge:e");
    expect_failure(BC("zero displacement", "@surface:no", "<x_dof>1</x_dof>"), LAR_ERROR_FORMAT,
                   BC_LINE, "surface 'no'");
    expect_failure(BC("normal displacement", "tip", ""), LAR_ERROR_UNSUPPORTED, BC_LINE,
                   "'normal displacement'");
    expect_failure(BC("fix", "tip", "<dofs>x,u</dofs>"), LAR_ERROR_UNSUPPORTED, BC_LINE + 1, "'u'");
    expect_failure(BC("prescribed displacement", "tip", "<value lc=\"1\">1</value>"),
                   LAR_ERROR_FORMAT, BC_LINE, "no <dof>");
    expect_failure(BC("prescribed displacement", "tip", "<dof>x</dof>\n"), LAR_ERROR_FORMAT,
                   BC_LINE, "no <value>");
    expect_failure(BC("prescribed displacement", "tip", "<dof>x</dof>\n<value lc=\"3\">1</value>"),
                   LAR_ERROR_FORMAT, BC_LINE + 2, "load controller 3");
    expect_failure(
        BC("prescribed displacement", "tip", "<dof>x</dof>\n<value type=\"map\">m</value>"),
        LAR_ERROR_UNSUPPORTED, BC_LINE + 2, "is a map");
    expect_failure(BC("prescribed displacement", "tip",
                      "<dof>x</dof><value>1</value>\n<relative>1</relative>"),
                   LAR_ERROR_UNSUPPORTED, BC_LINE + 2, "<relative>");
    expect_failure(BASE4 "<Boundary>\n<rigid/></Boundary>" TAIL, LAR_ERROR_UNSUPPORTED, BC_LINE,
                   "<rigid>");
    expect_failure(BASE4 "<Boundary>\n<bc type=\"fix\"><dofs>x</dofs></bc></Boundary>" TAIL,
                   LAR_ERROR_FORMAT, BC_LINE, "no attribute node_set");
}

static void test_bad_loads(void **state) {
    (void)state;
    expect_failure(BASE4 "<Loads>\n<surface_load type=\"traction\" surface=\"end\"/></Loads>" TAIL,
                   LAR_ERROR_UNSUPPORTED, BC_LINE, "'traction'");
    expect_failure(BASE4 "<Loads>\n<surface_load type=\"pressure\" surface=\"no\"><pressure>1"
                         "</pressure></surface_load></Loads>" TAIL,
                   LAR_ERROR_FORMAT, BC_LINE, "surface 'no'");
    expect_failure(BASE4 "<Loads>\n<body_load type=\"centrifugal\"/></Loads>" TAIL,
                   LAR_ERROR_UNSUPPORTED, BC_LINE, "'centrifugal'");
    expect_failure(BASE4 "<Loads>\n<body_load type=\"const\"/></Loads>" TAIL, LAR_ERROR_FORMAT,
                   BC_LINE, "neither");
    expect_failure(BASE4 "<Loads>\n<body_load type=\"const\" elem_set=\"left\"><z>1</z>"
                         "</body_load></Loads>" TAIL,
                   LAR_ERROR_UNSUPPORTED, BC_LINE, "'left' only");
    expect_failure(BASE4 "<Loads>\n<edge_load/></Loads>" TAIL, LAR_ERROR_UNSUPPORTED, BC_LINE,
                   "<edge_load>");
    expect_failure(BASE4 "<Loads>\n<nodal_load type=\"nodal_force\" node_set=\"tip\"><value>1,2"
                         "</value></nodal_load></Loads>" TAIL,
                   LAR_ERROR_FORMAT, BC_LINE, "holds 2 values");
    expect_failure(BASE4 "<Initial>\n<ic type=\"temperature\" node_set=\"tip\"/></Initial>" TAIL,
                   LAR_ERROR_UNSUPPORTED, BC_LINE, "'temperature'");
}

/* ---- curves ------------------------------------------------------------------------------------
 */

#define USE(curve)                                                                                 \
    BASE4                                                                                          \
    "<Boundary><bc type=\"prescribe\" node_set=\"tip\"><dof>x</dof><scale lc=\"1\">1</scale>"      \
    "</bc></Boundary>\n<LoadData>\n" curve "</LoadData>" TAIL

static double deck_curve(const char *deck, double time) {
    lar_model *model = read_deck(deck);
    double value = lar_curve_value(&model->curve[model->move[0].curve], time);
    lar_model_destroy(model);
    return value;
}

static void test_curves(void **state) {
    (void)state;
    const char *step = USE(CURVE("1", "STEP", "CONSTANT", "<pt>0,1</pt><pt>1,2</pt><pt>2,3</pt>"));
    assert_true(deck_curve(step, 0.5) == 2.0);
    assert_true(deck_curve(step, 1.5) == 3.0);
    const char *two = USE(CURVE("1", "SMOOTH", "CONSTANT", "<pt>0,0</pt><pt>1,1</pt>"));
    assert_true(fabs(deck_curve(two, 0.25) - 0.25) < 1e-12);
    /* t^2 is its own parabola, blended or not */
    const char *four =
        USE(CURVE("1", "SMOOTH", "CONSTANT", "<pt>0,0</pt><pt>1,1</pt><pt>2,4</pt><pt>3,9</pt>"));
    for (double t = 0.0; t < 3.0; t += 0.37) assert_true(fabs(deck_curve(four, t) - t * t) < 1e-3);
    const char *rise = USE(CURVE("1", "SMOOTH STEP", "CONSTANT", "<pt>0,0</pt><pt>1,1</pt>"));
    assert_true(fabs(deck_curve(rise, 0.25) - 0.103515625) < 1e-4);
    const char *jump =
        USE(CURVE("1", "LINEAR", "CONSTANT", "<pt>0,0</pt><pt>1,1</pt><pt>1,5</pt>"));
    assert_true(deck_curve(jump, 2.0) == 5.0);
    /* the run ends with the curve, so its extension does not matter */
    const char *covered = USE(CURVE("1", "LINEAR", "REPEAT", "<pt>0,0</pt><pt>1,1</pt>"));
    assert_true(deck_curve(covered, 0.5) == 0.5);
}

static void test_bad_curves(void **state) {
    (void)state;
    enum { LINE = BC_LINE + 1 };
    expect_failure(USE(CURVE("1", "LINEAR", "REPEAT", "<pt>0,0</pt><pt>0.5,1</pt>")),
                   LAR_ERROR_UNSUPPORTED, LINE, "extended beyond");
    expect_failure(USE(CURVE("1", "CONTROL POINTS", "CONSTANT", "<pt>0,0</pt>")),
                   LAR_ERROR_UNSUPPORTED, LINE, "interpolation that is not read");
    expect_failure(USE("<load_controller id=\"1\" type=\"math\"><math>t</math></load_controller>"),
                   LAR_ERROR_UNSUPPORTED, LINE, "not of type loadcurve");
    expect_failure(USE(CURVE("1", "LINEAR", "CONSTANT", "")), LAR_ERROR_FORMAT, LINE, "no points");
    expect_failure(USE(CURVE("1", "LINEAR", "CONSTANT", "<pt>1,0</pt>\n<pt>0,0</pt>")),
                   LAR_ERROR_FORMAT, LINE + 1, "before");
    expect_failure(USE(CURVE("1", "LINEAR", "CONSTANT", "\n<pt>1,inf</pt>")), LAR_ERROR_FORMAT,
                   LINE + 1, "'inf'");
    expect_failure(USE(CURVE("1", "LINEAR", "CONSTANT",
                             "<pt>1,1</pt>") "\n" CURVE("1", "LINEAR", "CONSTANT", "<pt>1,1</pt>")),
                   LAR_ERROR_FORMAT, LINE + 1, "second load controller");
    expect_failure(USE(CURVE("1", "SMOOTH", "CONSTANT", "<pt>0,0</pt><pt>0,1</pt><pt>1,1</pt>")),
                   LAR_ERROR_UNSUPPORTED, LINE, "two points at the same time");
    /* unused, it harms nobody */
    lar_model *model = read_deck(BASE4 "<LoadData>" CURVE("1", "CONTROL POINTS", "CONSTANT",
                                                          "<pt>0,0</pt>") "</LoadData>" TAIL);
    assert_int_equal(model->curve_count, 0);
    lar_model_destroy(model);
}

/* ---- sections ----------------------------------------------------------------------------------
 */

static void test_static_and_step(void **state) {
    (void)state;
    lar_model *model = read_deck(HEAD4 CONTROL("STATIC") MATERIAL MESH4 DOMAINS TAIL);
    assert_int_equal(notices_with(model, "the analysis is static"), 1);
    /* pi sqrt(1200 / 1000) / 2: the body is 2 long */
    assert_true(fabs(model->damping - 1.7207) < 1e-3);
    assert_int_equal(lar_model_until_rest(model), 1);
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
                                       "<Wishes><wish/></Wishes>" TAIL);
    assert_int_equal(notices_with(model, "deck.feb:21: <MeshData>"), 1);
    assert_int_equal(notices_with(model, "deck.feb:22: the section <Wishes>"), 1);
    lar_model_destroy(model);
    model = read_deck(HEAD4 "<Control><analysis>DYNAMIC</analysis><time_steps>1</time_steps>"
                            "<step_size>1</step_size><solver><dyn_damping>0.9</dyn_damping>"
                            "</solver></Control>" MATERIAL MESH4 DOMAINS
                            "<Boundary><bc type=\"fix\" node_set=\"tip\"><dofs>x</dofs><warp/>"
                            "</bc></Boundary>" TAIL);
    assert_int_equal(notices_with(model, "<dyn_damping> 0.9"), 1);
    assert_int_equal(notices_with(model, "<warp> in <bc>"), 1);
    lar_model_destroy(model);
    expect_failure(BASE4 "<Contact>\n<contact type=\"sliding\"/></Contact>" TAIL,
                   LAR_ERROR_UNSUPPORTED, LINE + 1, "<contact> of type 'sliding' asks for contact");
    expect_failure(BASE4 "<Rigid>\n<rigid_bc/></Rigid>" TAIL, LAR_ERROR_UNSUPPORTED, LINE + 1,
                   "rigid bodies");
    expect_failure(BASE4 "<Constraints>\n<constraint/></Constraints>" TAIL, LAR_ERROR_UNSUPPORTED,
                   LINE + 1, "constraints");
    expect_failure(BASE4 "<Discrete>\n<discrete/></Discrete>" TAIL, LAR_ERROR_UNSUPPORTED, LINE + 1,
                   "springs");
    expect_failure(BASE4 "<Step><step id=\"1\"/>\n<step id=\"2\"/></Step>" TAIL,
                   LAR_ERROR_UNSUPPORTED, LINE + 1, "several steps");
    expect_failure(BASE4 "<Include>x.feb</Include>" TAIL, LAR_ERROR_UNSUPPORTED, LINE, "<Include>");
    expect_failure(BASE4 "<Loads from=\"x.feb\"/>" TAIL, LAR_ERROR_UNSUPPORTED, LINE, "<Loads>");
    expect_failure(BASE4 "<Mesh/>" TAIL, LAR_ERROR_UNSUPPORTED, LINE, "second <Mesh>");
    expect_failure(HEAD4 CONTROL("MODAL") MATERIAL MESH4 DOMAINS TAIL, LAR_ERROR_UNSUPPORTED, 4,
                   "'MODAL'");
    expect_failure("<febio_spec version=\"4.0\"><Module type=\"biphasic\"/>" TAIL,
                   LAR_ERROR_UNSUPPORTED, 1, "'biphasic'");
    expect_failure("<febio_spec version=\"2.5\">" TAIL, LAR_ERROR_UNSUPPORTED, 1,
                   "save it as version 3.0 or 4.0");
    expect_failure("<febio_spec>" TAIL, LAR_ERROR_FORMAT, 1, "no attribute version");
    expect_failure("<mesh/>", LAR_ERROR_FORMAT, 1, "<mesh>");
    expect_failure("", LAR_ERROR_FORMAT, 0, "too few");
    expect_failure(" ", LAR_ERROR_FORMAT, 1, "well-formed");
    expect_failure("<a>\n<b></a>", LAR_ERROR_FORMAT, 2, "well-formed");
}

/* ---- the mesh alone ----------------------------------------------------------------------------
 */

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

/* ---- hostile files -----------------------------------------------------------------------------
 */

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

/* ---- real decks --------------------------------------------------------------------------------
 */

static void read_shared(const char *name, lar_status wanted, lar_model **model, lar_error *error) {
    char path[1000];
    snprintf(path, sizeof path, "%s/data/bench/febio/%s", LAR_TEST_SHARED, name);
    FILE *file = fopen(path, "rb");
    if (!file) {
        print_message("skipped: no shared data\n");
        skip();
    }
    fclose(file);
    if (lar_feb_read(path, model, error) != wanted) fail_msg("%s: %s", name, error->message);
}

typedef struct expected_deck {
    const char *name;
    int nodes, elements, curves, law, notices;
    double duration;
    int fix_nodes[3]; /* of the three supports; 0: none */
    unsigned fix_axes[3];
    int move_nodes;
    unsigned move_axes;
    double move_by;
} expected_deck;

/* Counted in the files by other means. */
static const expected_deck expected[] = {
    {"dy01.feb", 8, 1, 3, LAR_LAW_coupled_neo_hookean, 0, 1.0, {0}, {0}, 0, 0, 0},
    {"dy02.feb",
     189,
     80,
     3,
     LAR_LAW_coupled_neo_hookean,
     0,
     16.8,
     {9, 9, 9},
     {LAR_AXIS_Z, LAR_AXIS_Y, LAR_AXIS_X},
     0,
     0,
     0},
    {"mi27.feb",
     396,
     250,
     1,
     LAR_LAW_mooney_rivlin,
     1,
     1.0,
     {36, 66, 66},
     {LAR_AXIS_X, LAR_AXIS_Y, LAR_AXIS_Z},
     36,
     LAR_AXIS_X,
     1.0},
    {"tu01.feb",
     756,
     500,
     1,
     LAR_LAW_mooney_rivlin,
     1,
     1.0,
     {72, 72, 36},
     {LAR_AXIS_Z, LAR_AXIS_Y, LAR_AXIS_X},
     36,
     LAR_AXIS_X,
     1.0},
    {"ma01.feb",
     225,
     128,
     1,
     LAR_LAW_ogden,
     1,
     1.0,
     {50, 50, 25},
     {LAR_AXIS_Z, LAR_AXIS_Y, LAR_AXIS_X},
     25,
     LAR_AXIS_X,
     1.0},
    {"ma61.feb",
     27,
     8,
     1,
     LAR_LAW_yeoh,
     1,
     1.0,
     {9, 9, 9},
     {LAR_AXIS_X, LAR_AXIS_Y, LAR_AXIS_Z},
     9,
     LAR_AXIS_Z,
     2.0},
};

static void check_deck(const expected_deck *want) {
    lar_error error = {0};
    lar_model *model = NULL;
    read_shared(want->name, LAR_OK, &model, &error);
    assert_int_equal(model->mesh.node_count, want->nodes);
    assert_int_equal(model->mesh.element_count, want->elements);
    assert_int_equal(model->curve_count, want->curves);
    assert_int_equal(model->material[0].law, want->law);
    assert_int_equal(model->notice_count, want->notices);
    assert_true(fabs(model->duration - want->duration) < 1e-9);
    assert_int_equal(model->fix_count, want->fix_nodes[0] ? 3 : 0);
    for (int i = 0; i < model->fix_count; i++) {
        assert_int_equal(model->fix[i].nodes.count, want->fix_nodes[i]);
        assert_int_equal(model->fix[i].axes, want->fix_axes[i]);
    }
    assert_int_equal(model->move_count, want->move_nodes ? 1 : 0);
    if (model->move_count) {
        assert_int_equal(model->move[0].nodes.count, want->move_nodes);
        assert_int_equal(model->move[0].axes, want->move_axes);
        assert_true(model->move[0].by == want->move_by);
    }
    lar_model_destroy(model);
}

static void test_real_decks(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) check_deck(&expected[i]);
    lar_error error = {0};
    lar_model *model = NULL;
    read_shared("dy01.feb", LAR_OK, &model, &error);
    assert_true(model->gravity[2] == -1.0 && model->gravity[0] == 0.0);
    assert_true(lar_curve_value(&model->curve[model->gravity_curve[2]], 0.3) == 1.0);
    lar_model_destroy(model);
}

static void test_real_refusals(void **state) {
    (void)state;
    static const char *const decks[][2] = {{"co01.feb", "co01.feb:149: <contact> of type "
                                                        "'sliding-facet-on-facet'"},
                                           {"co02.feb", "'sliding-node-on-facet' asks for contact"},
                                           {"ex01.feb", "part 'Part3' are a rigid body"}};
    for (int i = 0; i < 3; i++) {
        lar_error error = {0};
        lar_model *model = NULL;
        read_shared(decks[i][0], LAR_ERROR_UNSUPPORTED, &model, &error);
        if (!strstr(error.message, decks[i][1])) fail_msg("%s", error.message);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_version_4),       cmocka_unit_test(test_version_3),
        cmocka_unit_test(test_materials),       cmocka_unit_test(test_stiffening_laws),
        cmocka_unit_test(test_bad_materials),   cmocka_unit_test(test_bad_meshes),
        cmocka_unit_test(test_supports),        cmocka_unit_test(test_loads),
        cmocka_unit_test(test_bad_supports),    cmocka_unit_test(test_bad_loads),
        cmocka_unit_test(test_curves),          cmocka_unit_test(test_bad_curves),
        cmocka_unit_test(test_static_and_step), cmocka_unit_test(test_sections),
        cmocka_unit_test(test_mesh_only),       cmocka_unit_test(test_entities),
        cmocka_unit_test(test_damage),          cmocka_unit_test(test_real_decks),
        cmocka_unit_test(test_real_refusals),
    };
    return cmocka_run_group_tests_name("feb", tests, NULL, NULL);
}
