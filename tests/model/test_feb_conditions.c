/* Supports, loads and curves of FEBio decks. */
#include "model/feb_deck.h"

/* ---- conditions ------------------------------------------------------------------------------ */

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

/* A dead load: each node has its share of the area at rest. The face is 1 by 1. */
static void test_traction(void **state) {
    (void)state;
    lar_model *model = read_deck(
        BASE4 "<Loads><surface_load type=\"traction\" surface=\"end\"><scale lc=\"1\">2</scale>"
              "<traction>4,0,-8</traction><linear>0</linear></surface_load></Loads>" LINEAR1 TAIL);
    double sum[3] = {0};
    for (int l = 0; l < model->load_count; l++) {
        const lar_nodal_load *load = &model->load[l];
        assert_true(lar_curve_value(&model->curve[load->curve], 0.5) == 1.0);
        for (int i = 0; i < 3; i++) sum[i] += load->nodes.count * load->force[i];
        assert_true(fabs(load->force[0] - 2) < 1e-12 && fabs(load->force[2] + 4) < 1e-12);
    }
    assert_int_equal(notices_with(model, "acts on the area at rest"), 1);
    assert_true(fabs(sum[0] - 8) < 1e-12 && sum[1] == 0 && fabs(sum[2] + 16) < 1e-12);
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
    assert_int_equal(model->load_count, 2 + 4); /* and the dead ones */
    assert_true(model->load[0].force[2] == 3.0 && model->load[0].nodes.count == 4);
    assert_true(model->load[1].force[1] == -4.0 && model->load[1].force[0] == 0.0);
    assert_int_equal(model->pressure_count, 1);
    assert_true(model->pressure[0].pressure == -50.0 && model->pressure[0].count == 1);
    for (int i = 2; i < 6; i++) /* a quarter each of the face of 1 by 1 */
        assert_true(fabs(model->load[i].force[0] + 12.5) < 1e-12 && model->load[i].force[1] == 0);
    assert_int_equal(notices_with(model, "<linear>"), 0);
    assert_int_equal(notices_with(model, "normals into the body"), 1);
    assert_true(model->gravity[2] == -9.81 && model->gravity[0] == 0.0);
    assert_int_equal(model->gravity_curve[2], model->load[0].curve);
    assert_int_equal(model->gravity_curve[1], -1);
    assert_int_equal(model->initial_count, 1);
    assert_true(model->initial[0].velocity[2] == -2.0 && model->initial[0].nodes.count == 4);
    lar_model_destroy(model);
}

/* What says the same in other words, or nothing of solids. */
static void test_scales_and_shells(void **state) {
    (void)state;
    lar_model *model = read_deck(
        BASE4 "<Boundary><bc type=\"prescribed displacement\" node_set=\"tip\"><dof>x</dof>"
              "<scale lc=\"1\">2</scale><value>-0.25</value><relative>1</relative></bc>"
              "<bc type=\"prescribed displacement\" node_set=\"tip\"><dof>u</dof><value>1</value>"
              "</bc><bc type=\"fix\" node_set=\"wall\"><dofs>x,sx,w</dofs></bc>"
              "<bc type=\"zero rotation\" node_set=\"wall\"/>"
              "<bc type=\"zero shell displacement\" node_set=\"wall\"/></Boundary>"
              "<Loads><nodal_load type=\"nodal_load\" node_set=\"tip\"><dof>z</dof>"
              "<scale>3</scale><value lc=\"1\">5</value></nodal_load></Loads>" LINEAR1 TAIL);
    assert_int_equal(model->move_count, 1);
    assert_true(model->move[0].by == -0.5);
    assert_true(lar_curve_value(&model->curve[model->move[0].curve], 0.5) == 1.0);
    assert_int_equal(model->fix_count, 1);
    assert_int_equal(model->fix[0].axes, LAR_AXIS_X);
    assert_int_equal(notices_with(model, "degree of freedom of shells"), 3);
    assert_int_equal(notices_with(model, "holds shells, of which there are none"), 2);
    assert_true(model->load[0].force[2] == 15);
    assert_int_equal(model->load[0].curve, model->move[0].curve);
    lar_model_destroy(model);
}

#define TRIANGLES                                                                                  \
    HEAD4 CONTROL("DYNAMIC") MATERIAL                                                              \
        "<Mesh>\n" NODES PARTS SETS4                                                               \
        "<Surface name=\"s\">\n<tri3 id=\"1\">1,2,3</tri3></Surface></Mesh>\n" DOMAINS

/* Faces that no hexahedron has matter only where something names them. */
static void test_other_faces(void **state) {
    (void)state;
    lar_model *model = read_deck(TRIANGLES TAIL);
    assert_int_equal(notices_with(model, "'s' was left out: <tri3> is no face of a hexahedron"), 1);
    lar_model_destroy(model);
    expect_failure(TRIANGLES
                   "<Boundary><bc type=\"fix\" node_set=\"@surface:s\"><dofs>x</dofs></bc>"
                   "</Boundary>" TAIL,
                   LAR_ERROR_UNSUPPORTED, 0, "'s', which has faces other than quad4");
    expect_failure(TRIANGLES "<Loads><surface_load type=\"pressure\" surface=\"s\"><pressure>1"
                             "</pressure></surface_load></Loads>" TAIL,
                   LAR_ERROR_UNSUPPORTED, 0, "'s', which has faces other than quad4");
}

#define MOVE(set, name, by)                                                                        \
    "<bc type=\"prescribed displacement\" name=\"" name "\" node_set=\"" set                       \
    "\"><dof>x</dof><value lc=\"1\">" by "</value></bc>\n"
#define FIX(set)         "<bc type=\"fix\" node_set=\"" set "\"><dofs>x,z</dofs></bc>\n"
#define HOLD(conditions) BASE4 "<Boundary>\n" conditions "</Boundary>" LINEAR1 TAIL

/* Each axis of a node has one holder; the same twice is one. */
static void test_holders(void **state) {
    (void)state;
    lar_model *model = read_deck(
        HOLD(MOVE("tip", "a", "1") MOVE("@elem_set:one", "b", "1") FIX("wall") FIX("wall")));
    assert_int_equal(model->move_count, 2);
    assert_int_equal(model->move[0].nodes.count, 4);
    assert_int_equal(model->move[1].nodes.count, 4); /* the other four */
    assert_int_equal(model->move[1].nodes.node[0], 1);
    lar_model_destroy(model);
    expect_failure(HOLD(MOVE("tip", "a", "1") MOVE("@elem_set:one", "b", "2")), LAR_ERROR_MODEL,
                   BC_LINE + 1,
                   "<bc> moves node 9 along x, which <bc> 'a' in line 22 moves; leave one");
    expect_failure(HOLD(MOVE("tip", "a", "1") FIX("tip")), LAR_ERROR_MODEL, BC_LINE + 1,
                   "<bc> fixes node 9 along x, which <bc> 'a' in line 22 moves");
    expect_failure(HOLD(FIX("tip") MOVE("tip", "a", "1")), LAR_ERROR_MODEL, BC_LINE + 1,
                   "<bc> moves node 9 along x, which <bc> in line 22 fixes");
}

#define BC(type, set, content)                                                                     \
    BASE4 "<Boundary>\n<bc type=\"" type "\" node_set=\"" set "\">\n" content                      \
          "</bc></Boundary>" LINEAR1 TAIL

static void test_bad_supports(void **state) {
    (void)state;
    expect_failure(BC("zero displacement", "wall", "<xdof>1</xdof>"), LAR_ERROR_FORMAT, BC_LINE,
                   "does not say which axes it holds");
    expect_failure(BC("zero displacement", "wall", "<x_dof>1</x_dof>\n<y_dof>2</y_dof>"),
                   LAR_ERROR_FORMAT, BC_LINE + 2, "<y_dof> is 2; write 1 for yes or 0 for no");
    expect_failure(BC("zero displacement", "wall", "<z_dof>-1</z_dof>"), LAR_ERROR_FORMAT,
                   BC_LINE + 1, "<z_dof> is -1");
    expect_failure(BC("zero displacement", "wall", "<x_dof>1</x_dof>\n<x_dof>0</x_dof>"),
                   LAR_ERROR_FORMAT, BC_LINE + 2, "a second <x_dof> in one <bc>");
    expect_failure(BC("zero displacement", "none", "<x_dof>1</x_dof>"), LAR_ERROR_FORMAT, BC_LINE,
                   "node set 'none'");
    expect_failure(BC("zero displacement", "@edge:e", "<x_dof>1</x_dof>"), LAR_ERROR_UNSUPPORTED,
                   BC_LINE, "@edge:e");
    expect_failure(BC("zero displacement", "@surface:no", "<x_dof>1</x_dof>"), LAR_ERROR_FORMAT,
                   BC_LINE, "surface 'no'");
    expect_failure(BC("normal displacement", "tip", ""), LAR_ERROR_UNSUPPORTED, BC_LINE,
                   "'normal displacement'");
    expect_failure(BC("fix", "tip", "<dofs>x,q</dofs>"), LAR_ERROR_UNSUPPORTED, BC_LINE + 1, "'q'");
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
                      "<dof>x</dof><value>1</value>\n<relative>2</relative>"),
                   LAR_ERROR_FORMAT, BC_LINE + 2, "<relative> is 2");
    expect_failure(BC("prescribed displacement", "tip",
                      "<dof>x</dof><value lc=\"1\">1</value>\n<scale lc=\"1\">1</scale>"),
                   LAR_ERROR_UNSUPPORTED, BC_LINE + 2, "follow a load curve each");
    expect_failure(BC("prescribed displacement", "tip", "<dof>x</dof>\n<value node_data=\"map\"/>"),
                   LAR_ERROR_UNSUPPORTED, BC_LINE + 2, "is a map on nodes, which is not read");
    expect_failure(BASE4 "<Boundary>\n<rigid/></Boundary>" TAIL, LAR_ERROR_UNSUPPORTED, BC_LINE,
                   "<rigid>");
    expect_failure(BASE4 "<Boundary>\n<bc type=\"fix\"><dofs>x</dofs></bc></Boundary>" TAIL,
                   LAR_ERROR_FORMAT, BC_LINE, "no attribute node_set");
}

static void test_bad_loads(void **state) {
    (void)state;
#define SURFACE_LOAD(type, surface, rest)                                                          \
    BASE4 "<Loads>\n<surface_load type=\"" type "\" surface=\"" surface "\">" rest                 \
          "</surface_load></Loads>" LINEAR1 TAIL
    expect_failure(SURFACE_LOAD("fluidflux", "end", ""), LAR_ERROR_UNSUPPORTED, BC_LINE,
                   "'fluidflux' is not read and would change the answer; Lariat reads pressure and "
                   "traction");
    expect_failure(SURFACE_LOAD("traction", "end", ""), LAR_ERROR_FORMAT, BC_LINE, "no <traction>");
    expect_failure(SURFACE_LOAD("traction", "end", "<traction>1,2</traction>"), LAR_ERROR_FORMAT,
                   BC_LINE, "holds 2 values where 3 belong");
    expect_failure(SURFACE_LOAD("traction", "no", "<traction>1,2,3</traction>"), LAR_ERROR_FORMAT,
                   BC_LINE, "surface 'no'");
    expect_failure(SURFACE_LOAD("traction", "end",
                                "<traction lc=\"1\">1,2,3</traction>"
                                "<scale lc=\"1\">2</scale>"),
                   LAR_ERROR_UNSUPPORTED, BC_LINE, "follow a load curve each");
    expect_failure(BASE4 "<Loads>\n<surface_load type=\"pressure\" surface=\"no\"><pressure>1"
                         "</pressure></surface_load></Loads>" TAIL,
                   LAR_ERROR_FORMAT, BC_LINE, "surface 'no'");
    expect_failure(SURFACE_LOAD("pressure", "end", "<pressure surface_data=\"map\"/>"),
                   LAR_ERROR_UNSUPPORTED, BC_LINE, "is a map on a surface, which is not read");
    expect_failure(SURFACE_LOAD("pressure", "end\" lc=\"1", "<pressure>1</pressure>"),
                   LAR_ERROR_UNSUPPORTED, BC_LINE, "the load curve of this <surface_load>");
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

/* ---- curves ---------------------------------------------------------------------------------- */

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
    /* beyond the points, up to the end of the run after a second */
#define BEYOND(how, extend) USE(CURVE("1", how, extend, "<pt>0,0</pt><pt>0.2,1</pt><pt>0.4,3</pt>"))
    assert_true(fabs(deck_curve(BEYOND("LINEAR", "EXTRAPOLATE"), 0.9) - 8) < 1e-12);
    assert_true(fabs(deck_curve(BEYOND("LINEAR", "REPEAT"), 0.9) - 0.5) < 1e-12);
    assert_true(fabs(deck_curve(BEYOND("LINEAR", "REPEAT"), 0.7) - 2) < 1e-12);
    assert_true(fabs(deck_curve(BEYOND("LINEAR", "REPEAT OFFSET"), 0.9) - 6.5) < 1e-12);
    assert_true(deck_curve(BEYOND("STEP", "REPEAT"), 0.9) == 1);
    assert_true(deck_curve(BEYOND("STEP", "REPEAT"), 0.7) == 3);
    double smooth = deck_curve(BEYOND("SMOOTH", "CONSTANT"), 0.1);
    assert_true(fabs(deck_curve(BEYOND("SMOOTH", "REPEAT"), 0.5) - smooth) < 1e-12);
    /* the run ends with the curve, so its extension does not matter */
    const char *covered = USE(CURVE("1", "LINEAR", "REPEAT", "<pt>0,0</pt><pt>1,1</pt>"));
    assert_true(deck_curve(covered, 0.5) == 0.5);
}

static void test_bad_curves(void **state) {
    (void)state;
    enum { LINE = BC_LINE + 1 };
    expect_failure(USE(CURVE("1", "LINEAR", "MIRROR", "<pt>0,0</pt><pt>0.5,1</pt>")),
                   LAR_ERROR_UNSUPPORTED, LINE, "extended beyond");
    expect_failure(USE(CURVE("1", "SMOOTH", "EXTRAPOLATE", "<pt>0,0</pt><pt>0.5,1</pt>")),
                   LAR_ERROR_UNSUPPORTED, LINE, "extended beyond");
    expect_failure(USE(CURVE("1", "LINEAR", "REPEAT", "<pt>0.1,0</pt><pt>0.5,1</pt>")),
                   LAR_ERROR_UNSUPPORTED, LINE, "extended beyond");
    expect_failure(USE(CURVE("1", "LINEAR", "REPEAT", "<pt>0,0</pt><pt>1e-9,1</pt>")),
                   LAR_ERROR_UNSUPPORTED, LINE, "extended beyond");
    expect_failure(USE(CURVE("1", "LINEAR", "EXTRAPOLATE", "<pt>0,1</pt>")), LAR_ERROR_UNSUPPORTED,
                   LINE, "extended beyond");
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
    expect_failure(HEAD4
                   "\n" MATERIAL MESH4 DOMAINS
                   "<Boundary><bc type=\"prescribe\" node_set=\"tip\"><dof>x</dof><scale "
                   "lc=\"1\">1</scale></bc></Boundary>\n<LoadData>\n" CURVE(
                       "1", "LINEAR", "EXTRAPOLATE", "<pt>0,0</pt><pt>1,1</pt>") "</LoadData>" TAIL,
                   LAR_ERROR_UNSUPPORTED, LINE, "the deck has no duration up to which");
    /* unused, it harms nobody */
    lar_model *model = read_deck(BASE4 "<LoadData>" CURVE("1", "CONTROL POINTS", "CONSTANT",
                                                          "<pt>0,0</pt>") "</LoadData>" TAIL);
    assert_int_equal(model->curve_count, 0);
    lar_model_destroy(model);
}

/* ---- contact --------------------------------------------------------------------------------- */

#define PAIRS                                                                                      \
    HEAD4 CONTROL("STATIC") MATERIAL                                                               \
        "<Mesh>\n" NODES PARTS SETS4                                                               \
        "<Surface name=\"start\"><quad4 id=\"1\">1,5,8,4</quad4></Surface>"                        \
        "<Surface name=\"within\"><quad4 id=\"1\">2,3,7,6</quad4></Surface>"                       \
        "<SurfacePair name=\"p\"><primary> end "                                                   \
        "</primary><secondary>start</secondary></SurfacePair>"                                     \
        "<SurfacePair name=\"old\"><master surface=\"end\"/><slave "                               \
        "surface=\"end\"/></SurfacePair>"                                                          \
        "<SurfacePair name=\"bad\"><primary>within</primary><secondary>end</secondary>"            \
        "</SurfacePair><SurfacePair name=\"none\"><primary>end</primary><secondary>x</secondary>"  \
        "</SurfacePair><SurfacePair "                                                              \
        "name=\"half\"><primary>end</primary></SurfacePair></Mesh>\n" DOMAINS
#define TOUCH(type, pair, more)                                                                    \
    PAIRS "<Contact><contact type=\"" type "\" surface_pair=\"" pair "\">" more                    \
          "</contact></Contact>" TAIL

static void test_contact(void **state) {
    (void)state;
    lar_model *model = read_deck(TOUCH("sliding-elastic", "p",
                                       "<laugon>PENALTY</laugon><penalty>10</penalty><tension>0"
                                       "</tension><fric_coeff>0.3</fric_coeff><glue>1</glue>"));
    assert_int_equal(model->contact_count, 1);
    const lar_contact *contact = &model->contact[0];
    assert_int_equal(contact->kind, LAR_CONTACT_BETWEEN);
    assert_true(contact->friction == 0.3);
    assert_true(contact->face_count == 1 && contact->face[0] / 6 == 1);
    assert_true(contact->against_count == 1 && contact->against[0] / 6 == 0);
    assert_int_equal(notices_with(model, "penalties, tolerances and searches"), 1);
    assert_int_equal(notices_with(model, "<glue> in <contact>"), 1);
    lar_model_destroy(model);
    model = read_deck(TOUCH("facet-to-facet sliding", "old", ""));
    assert_int_equal(model->contact[0].kind, LAR_CONTACT_SELF);
    assert_int_equal(notices_with(model, "penalties"), 0);
    lar_model_destroy(model);
}

static void test_contact_that_is_refused(void **state) {
    (void)state;
    static const struct {
        const char *deck, *words;
    } bad[] = {
        {TOUCH("tied-elastic", "p", ""), "join their nodes in the mesh"},
        {TOUCH("sticky", "p", ""), "of type 'sticky' is not read"},
        {TOUCH("sliding-elastic", "q", ""), "the surface pair 'q'"},
        {TOUCH("sliding-elastic", "none", ""), "the surface 'x'"},
        {TOUCH("sliding-elastic", "half", ""), "<SurfacePair> has no <secondary>"},
        {TOUCH("sliding-elastic", "bad", ""), "is inside the body"},
        {TOUCH("sliding-elastic", "p", "<tension>1</tension>"), "<tension> other than 0"},
        {TOUCH("sliding-elastic", "p", "<offset>0.1</offset>"), "<offset> other than 0"},
        {TOUCH("sliding-elastic", "p", "<fric_coeff>-1</fric_coeff>"), "<fric_coeff> is -1"},
        {TOUCH("sliding-elastic", "p", "<fric_coeff lc=\"1\">1</fric_coeff>"), "load curve"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        lar_error error = {0};
        lar_model *model = NULL;
        lar_status status = parse_bytes(bad[i].deck, strlen(bad[i].deck), &model, &error);
        if (!status || !strstr(error.message, bad[i].words))
            fail_msg("%d: %s", (int)i, error.message);
    }
}

/* ---- rigid bodies ---------------------------------------------------------------------------- */

#define STONE                                                                                      \
    HEAD4 CONTROL("STATIC") "<Material><material id=\"7\" name=\"soft\" "                          \
                            "type=\"neo-Hookean\"><density>1000</density>"                         \
                            "<E>3000</E><v>0.25</v></material><material id=\"8\" name=\"stone\" "  \
                            "type=\"rigid body\">"                                                 \
                            "<density>1</density></material></Material>\n" MESH4                   \
                            "<MeshDomains><SolidDomain name=\"left\" mat=\"soft\"/><SolidDomain "  \
                            "name=\"right\" "                                                      \
                            "mat=\"stone\"/></MeshDomains>\n"
#define HELD(but)                                                                                  \
    "<rigid_bc type=\"rigid_fixed\"><rb>stone</rb><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof>"            \
    "<Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof>" but "</rigid_bc>"
#define SLIDES                                                                                     \
    "<rigid_bc type=\"rigid_displacement\"><rb>8</rb><dof>x</dof><value "                          \
    "lc=\"1\">0.1</value></rigid_bc>"
#define AT_ONCE                                                                                    \
    "<rigid_bc type=\"rigid_displacement\"><rb>8</rb><dof>x</dof><value>0.1</value></rigid_bc>"
#define TURNS(way)                                                                                 \
    "<rigid_bc type=\"rigid_rotation\"><rb>stone</rb><dof>" way "</dof><value lc=\"1\">0.5"        \
    "</value></rigid_bc>"
#define RIGID(all) STONE "<Rigid>" all "</Rigid>" LINEAR1 TAIL

static void test_rigid_bodies(void **state) {
    (void)state;
    lar_model *model = read_deck(RIGID(HELD("") SLIDES TURNS("Ru")));
    assert_int_equal(model->move_count, 1);
    const lar_move *move = &model->move[0];
    assert_int_equal(move->nodes.count, 8);
    assert_int_equal(move->axes, LAR_AXIS_ALL);
    assert_int_equal(move->screw_count, 2);
    const lar_screw *turn = &move->screw[0], *way = &move->screw[1];
    assert_true(turn->angle == 0.5 && turn->slide == 0 && turn->axis[0] == 1);
    assert_true(turn->point[0] == 1.5 && turn->point[1] == 0.5 && turn->point[2] == 0.5);
    assert_true(way->angle == 0 && way->slide == 0.1 && way->axis[0] == 1);
    assert_true(lar_curve_value(&model->curve[way->curve], 0.5) == 1.0);
    assert_int_equal(notices_with(model, "about the middle of its elements"), 1);
    assert_int_equal(notices_with(model, "moves as prescribed"), 1);
    assert_true(lar_material_shear(&model->material[1]) == lar_material_shear(&model->material[0]));
    assert_true(model->material[1].density == 100 * model->material[0].density);
    lar_model_destroy(model);
    /* without a load curve within the first time step */
    model = read_deck(RIGID(HELD("<Ru_dof>1</Ru_dof>") AT_ONCE));
    const lar_curve *curve = &model->curve[model->move[0].screw[0].curve];
    assert_true(lar_curve_value(curve, 0) == 0 && lar_curve_value(curve, 0.1) == 1);
    lar_model_destroy(model);
    model = read_deck(RIGID(HELD("<Rx_dof>1</Rx_dof><Ru_dof>1</Ru_dof>")));
    assert_true(model->move_count == 0 && model->fix_count == 1);
    assert_int_equal(model->fix[0].nodes.count, 8);
    lar_model_destroy(model);
    /* the words of version 3, and a node of another part that goes with the body */
    model =
        read_deck(STONE "<Boundary><bc type=\"rigid\" node_set=\"wall\"><rb>8</rb></bc></Boundary>"
                        "<Rigid><rigid_constraint type=\"fix\"><rb>8</rb><dofs>Rx,Ry,Ru,Rv,Rw"
                        "</dofs></rigid_constraint><rigid_constraint type=\"prescribe\"><rb>8"
                        "</rb><dof>Rz</dof><value lc=\"1\">2</value></rigid_constraint>"
                        "</Rigid>" LINEAR1 TAIL);
    assert_int_equal(model->move[0].nodes.count, 12);
    assert_true(model->move[0].screw_count == 1 && model->move[0].screw[0].slide == 2);
    lar_model_destroy(model);
    /* those of 2.5, where Rx is a turn */
    model = read_deck(STONE
                      "<Boundary><rigid_body mat=\"8\"><fixed bc=\"x\"/><fixed bc=\"y\"/>"
                      "<fixed bc=\"z\"/><prescribed bc=\"Rx\" lc=\"1\">0.25</prescribed>"
                      "<fixed bc=\"Ry\"/><fixed bc=\"Rz\"/></rigid_body></Boundary>" LINEAR1 TAIL);
    assert_true(model->move[0].screw_count == 1 && model->move[0].screw[0].angle == 0.25);
    lar_model_destroy(model);
}

static void test_rigid_bodies_that_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *deck, *words;
    } bad[] = {
        {RIGID(HELD("") SLIDES), "may move about x by itself"},
        {RIGID(""), "may move along x by itself"},
        {RIGID(HELD("") SLIDES SLIDES), "along or about x a second time"},
        {RIGID(HELD("<Ru_dof>1</Ru_dof>") SLIDES TURNS("Rv")), "about y a second time"},
        {RIGID("<rigid_bc type=\"rigid_fixed\"><rb>soft</rb></rigid_bc>"),
         "'soft', which is no material of type rigid"},
        {RIGID("<rigid_bc type=\"rigid_fixed\"></rigid_bc>"), "has no <rb>"},
        {RIGID(TURNS("q")), "'q' is no degree of freedom"},
        {RIGID("<rigid_load type=\"rigid_force\"><rb>8</rb></rigid_load>"), "is not read"},
        {RIGID("<rigid_bc type=\"rigid_fixed\"><rb>8</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof>"
               "<Rz_dof>1</Rz_dof><Rw_dof>1</Rw_dof></rigid_bc>" TURNS("Ru") TURNS("Rv")),
         "turns about several axes"},
        {STONE "<Boundary><bc type=\"zero displacement\" node_set=\"tip\"><x_dof>1</x_dof></bc>"
               "</Boundary><Rigid>" HELD("") SLIDES TURNS("Ru") "</Rigid>" LINEAR1 TAIL,
         "leave one of the two"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        lar_error error = {0};
        lar_model *model = NULL;
        lar_status status = parse_bytes(bad[i].deck, strlen(bad[i].deck), &model, &error);
        if (!status || !strstr(error.message, bad[i].words))
            fail_msg("%d: %s", (int)i, error.message);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rigid_bodies),
        cmocka_unit_test(test_rigid_bodies_that_are_refused),
        cmocka_unit_test(test_contact),
        cmocka_unit_test(test_contact_that_is_refused),
        cmocka_unit_test(test_supports),
        cmocka_unit_test(test_loads),
        cmocka_unit_test(test_traction),
        cmocka_unit_test(test_bad_supports),
        cmocka_unit_test(test_scales_and_shells),
        cmocka_unit_test(test_holders),
        cmocka_unit_test(test_other_faces),
        cmocka_unit_test(test_bad_loads),
        cmocka_unit_test(test_curves),
        cmocka_unit_test(test_bad_curves),
    };
    return cmocka_run_group_tests_name("feb_conditions", tests, NULL, NULL);
}
