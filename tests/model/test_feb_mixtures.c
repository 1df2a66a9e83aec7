/* Materials of FEBio decks that hold others, directions that turn about a point or a line, and
 * decks of format version 2.5. */
#include "model/feb_deck.h"

#include "law/fibre.h"

#define DECK(type, material)                                                                       \
    HEAD4 CONTROL("DYNAMIC") "<Material><material id=\"7\" name=\"soft\" type=\"" type             \
                             "\"><density>1000</density>" material                                 \
                             "</material></Material>\n" MESH4 DOMAINS TAIL

#define TERM   "<t1>0.1</t1><g1>0.5</g1>"
#define SOLID  "<solid type=\"neo-Hookean\"><E>3000</E><v>0.25</v></solid>"
#define MOONEY "<solid type=\"Mooney-Rivlin\"><c1>500</c1><c2>0</c2><k>0</k></solid>"
#define ALONG  "<fiber type=\"vector\">0,0,2</fiber>"
#define FIBRES(type)                                                                               \
    "<solid type=\"" type "\"><ksi>300</ksi><alpha>1.5</alpha><beta>2.5</beta>" ALONG "</solid>"
#define PULLS "<solid type=\"prescribed uniaxial active contraction\"><T0>200</T0>" ALONG "</solid>"
#define TRANS_ISO                                                                                  \
    "<k>0</k><c1>500</c1><c2>0</c2><c3>40</c3><c4>12</c4><c5>3e3</c5><lam_max>1.2</lam_max>"

static void expect(const char *deck, lar_law law, int terms, lar_fibre_law fibres, double along) {
    lar_model *model = read_deck(deck);
    const lar_material *m = &model->material[0];
    assert_int_equal(m->law, law);
    assert_int_equal(m->viscosity.terms, terms);
    assert_int_equal(m->fibre.law, fibres);
    assert_true(m->fibre.along == along);
    if (law == LAR_LAW_mooney_rivlin) assert_true(lar_material_bulk(m) == 9e4);
    if (fibres) assert_true(lar_model_fibre(model, 1)[2] == 1);
    lar_model_destroy(model);
}

/* Whatever is within relaxes; what contracts stands beside. */
static void mixtures_may_be_viscous(void **state) {
    (void)state;
    expect(DECK("viscoelastic",
                TERM "<elastic type=\"solid mixture\">" SOLID FIBRES("fiber-exp-pow") "</elastic>"),
           LAR_LAW_coupled_neo_hookean, 1, LAR_FIBRE_EXP_POW, 0);
    expect(DECK("uncoupled viscoelastic",
                "<k>9e4</k>" TERM
                "<elastic type=\"uncoupled solid mixture\"><k>0</k>" MOONEY FIBRES(
                    "uncoupled fiber-exp-pow") "</elastic>"),
           LAR_LAW_mooney_rivlin, 1, LAR_FIBRE_EXP_POW, 0);
    expect(DECK("uncoupled solid mixture",
                "<k>9e4</k><solid type=\"uncoupled viscoelastic\">" TERM
                "<elastic type=\"trans iso Mooney-Rivlin\">" TRANS_ISO ALONG "</elastic></solid>"),
           LAR_LAW_mooney_rivlin, 1, LAR_FIBRE_EXP_LINEAR, 0);
    expect(DECK("solid mixture", PULLS "<solid type=\"viscoelastic\">" TERM
                                       "<elastic type=\"neo-Hookean\"><E>3000</E><v>0.25</v>"
                                       "</elastic></solid>"),
           LAR_LAW_coupled_neo_hookean, 1, LAR_FIBRE_NONE, 200);
    expect(DECK("uncoupled solid mixture",
                "<k>9e4</k><solid type=\"trans iso Mooney-Rivlin\">" TRANS_ISO ALONG "</solid>"
                "<solid type=\"uncoupled prescribed isotropic active contraction\"><T0>50</T0>"
                "</solid>"),
           LAR_LAW_mooney_rivlin, 0, LAR_FIBRE_EXP_LINEAR, 50);
}

/* Uncoupled materials add their bulk moduli, mixtures only where they have none of their own; and
 * mixtures the densities of their parts. */
static void moduli_and_densities_add_up(void **state) {
    (void)state;
#define PART(type, inside) "<solid type=\"" type "\">" inside "</solid>"
#define MR(k)              "<c1>500</c1><c2>0</c2>" k
#define ELASTIC(k)         "<elastic type=\"Mooney-Rivlin\">" MR(k) "</elastic>"
#define EXP                "<ksi>300</ksi><alpha>1.5</alpha><beta>2.5</beta>" ALONG
    static const struct {
        const char *text;
        double bulk, density;
    } decks[] = {
        {DECK("uncoupled viscoelastic", "<k>50</k>" TERM ELASTIC("<k>30</k>")), 80, 1000},
        {DECK("uncoupled viscoelastic", "<k>0</k>" TERM ELASTIC("<k>30</k>")), 30, 1000},
        {DECK("uncoupled viscoelastic", TERM ELASTIC("<k>30</k>")), 30, 1000},
        {DECK("uncoupled viscoelastic",
              "<k>50</k>" TERM "<elastic type=\"uncoupled solid mixture\"><k>30</k>" PART(
                  "Mooney-Rivlin", MR("<k>7</k>")) "</elastic>"),
         80, 1000},
        {DECK("uncoupled solid mixture",
              "<k>50</k>" PART("Mooney-Rivlin", MR("<k>70</k>") "<density>3</density>")),
         50, 3},
        {DECK("uncoupled solid mixture",
              "<k>0</k>" PART("Mooney-Rivlin", MR("<k>70</k>") "<density>900</density>")
                  PART("uncoupled fiber-exp-pow", EXP "<k>30</k><density>100</density>")),
         100, 1000},
        {DECK("uncoupled solid mixture",
              PART("uncoupled viscoelastic",
                   "<k>5</k><density>7</density>" TERM ELASTIC("<k>30</k>"))),
         35, 7},
        {DECK("uncoupled solid mixture",
              PART("Mooney-Rivlin", MR("<k>70</k>")) PART("uncoupled fiber-exp-pow", EXP)),
         70, 2},
    };
    for (size_t i = 0; i < sizeof decks / sizeof *decks; i++) {
        lar_model *model = read_deck(decks[i].text);
        const lar_material *m = &model->material[0];
        if (lar_material_bulk(m) != decks[i].bulk || m->density != decks[i].density)
            fail_msg("deck %zu: bulk modulus %g, density %g", i, lar_material_bulk(m), m->density);
        assert_int_equal(notices_with(model, "and not its own, 1000"), m->density != 1000);
        lar_model_destroy(model);
    }
    lar_model *model = read_deck(
        HEAD4 CONTROL("STATIC") "<Material><material id=\"7\" name=\"soft\" "
                                "type=\"solid mixture\"><density>9</density>" SOLID FIBRES(
                                    "fiber-exp-pow") "</material></Material>" MESH4 DOMAINS TAIL);
    assert_int_equal(notices_with(model, "density"), 0); /* nothing depends on it */
    lar_model_destroy(model);
    expect_failure(DECK("uncoupled viscoelastic", TERM ELASTIC("")), LAR_ERROR_FORMAT, 5,
                   "no parameter <k>, nor has what is within it; add it");
    expect_failure(DECK("uncoupled viscoelastic",
                        "<k>50</k>" TERM "<elastic type=\"uncoupled solid mixture\">" PART(
                            "Mooney-Rivlin", MR("<k>7</k>")) "</elastic>"),
                   LAR_ERROR_UNSUPPORTED, 5, "give the mixture its own");
}

/* An augmented volume stays: at least a thousand times what resists shear, fibres and what
 * contracts too; whether a domain, a material or a part of one says so. */
static void augmented_materials_keep_their_volume(void **state) {
    (void)state;
#define LAUGON(on) "<laugon>" on "</laugon><atol>0.01</atol><maxaug>10</maxaug>"
#define YEOH       "<c1>3</c1><k>7</k>"
    static const struct {
        const char *text;
        double bulk;
        int notices;
    } decks[] = {
        {DECK("Yeoh", YEOH LAUGON("1")), 6000, 1},
        {DECK("Yeoh", YEOH LAUGON("0")), 7, 0},
        {DECK("Yeoh", "<c1>3</c1><k>7e4</k>" LAUGON("1")), 7e4, 0},
        {DECK("uncoupled solid mixture",
              "<solid type=\"uncoupled fiber-exp-linear\"><c3>2</c3><c4>5</c4><c5>30</c5>"
              "<lambda>1.2</lambda>" ALONG "</solid><solid type=\"Yeoh\">" YEOH LAUGON(
                  "1") "</solid><solid type=\"uncoupled prescribed isotropic active "
                       "contraction\"><T0>8</T0></solid>"),
         24000, 1},
        {DECK("uncoupled viscoelastic",
              LAUGON("1") "<t1>1</t1><g1>0.5</g1><elastic type=\"Yeoh\">" YEOH "</elastic>"),
         9000, 1},
        {HEAD4 CONTROL("DYNAMIC") "<Material><material id=\"7\" name=\"soft\" type=\"Yeoh\">"
                                  "<density>1</density>" YEOH "</material></Material>\n" MESH4
                                  "<MeshDomains><SolidDomain name=\"left\" mat=\"soft\"/>"
                                  "<SolidDomain name=\"right\" mat=\"7\" "
                                  "type=\"three-field-solid\">" LAUGON(
                                      "1") "</SolidDomain></MeshDomains>" TAIL,
         6000, 1},
    };
    for (size_t i = 0; i < sizeof decks / sizeof *decks; i++) {
        lar_model *model = read_deck(decks[i].text);
        double bulk = lar_law_table[model->material[0].law].bulk(model->material[0].parameter);
        if (fabs(bulk / decks[i].bulk - 1) > 1e-12) fail_msg("deck %zu: bulk modulus %g", i, bulk);
        assert_int_equal(notices_with(model, "<laugon> asks for"), decks[i].notices);
        assert_int_equal(notices_with(model, "known"), 0);
        lar_model_destroy(model);
    }
    lar_model *model =
        read_deck(HEAD4 CONTROL("DYNAMIC") MATERIAL MESH4
                  "<MeshDomains><SolidDomain name=\"left\" mat=\"soft\" type=\"udg-hex\"><hg>2</hg>"
                  "<laugon>1</laugon></SolidDomain><SolidDomain name=\"right\" "
                  "mat=\"soft\"/></MeshDomains>" TAIL);
    assert_int_equal(notices_with(model, "the domain type 'udg-hex' was left out"), 1);
    assert_int_equal(notices_with(model, "<hg> in <SolidDomain> is not known"), 1);
    assert_int_equal(notices_with(model, "<laugon> was left out"), 1);
    lar_model_destroy(model);
}

/* What would be another model is refused. */
static void mixtures_that_are_refused(void **state) {
    (void)state;
    expect_failure(DECK("uncoupled solid mixture", "<k>9</k>" SOLID), LAR_ERROR_UNSUPPORTED, 5,
                   "'neo-Hookean' is no uncoupled material");
    expect_failure(DECK("uncoupled solid mixture", "<k>9</k>" MOONEY FIBRES("fiber-exp-pow")),
                   LAR_ERROR_UNSUPPORTED, 5, "'fiber-exp-pow' is no uncoupled material");
    expect_failure(DECK("uncoupled viscoelastic",
                        "<k>9</k>" TERM "<elastic type=\"solid mixture\">" MOONEY "</elastic>"),
                   LAR_ERROR_UNSUPPORTED, 5, "'solid mixture' is no uncoupled material");
    expect_failure(
        DECK("viscoelastic", TERM "<elastic type=\"solid mixture\">" SOLID PULLS "</elastic>"),
        LAR_ERROR_UNSUPPORTED, 5, "an active contraction within a viscous material");
    expect_failure(
        DECK("solid mixture",
             FIBRES("fiber-exp-pow") "<solid type=\"viscoelastic\">" TERM
                                     "<elastic type=\"neo-Hookean\"><E>3000</E><v>0.25</v>"
                                     "</elastic></solid>"),
        LAR_ERROR_UNSUPPORTED, 5, "fibres beside a viscous solid");
    expect_failure(DECK("viscoelastic",
                        TERM "<elastic type=\"solid mixture\"><solid type=\"viscoelastic\">" TERM
                             "<elastic type=\"neo-Hookean\"/></solid></elastic>"),
                   LAR_ERROR_FORMAT, 5, "a viscous material within another one");
    expect_failure(DECK("viscoelastic", TERM "<elastic type=\"viscoelastic\"/>"),
                   LAR_ERROR_UNSUPPORTED, 5, "material type 'viscoelastic' is not read");
    expect_failure(DECK("uncoupled solid mixture",
                        "<k>9e4</k>" FIBRES("uncoupled fiber-exp-pow") "<solid type=\"trans iso "
                                                                       "Mooney-Rivlin\">" TRANS_ISO
                                                                       "</solid>"),
                   LAR_ERROR_UNSUPPORTED, 5, "a second family of fibres");
}

/* The second element's centre is at 1.5, 0.5, 0.5. */
static void expect_direction(const char *rule, double x, double y, double z) {
    char deck[6000];
    snprintf(deck, sizeof deck, "%s%s%s",
             HEAD4 CONTROL(
                 "DYNAMIC") "<Material><material id=\"7\" "
                            "name=\"soft\" type=\"trans iso Mooney-Rivlin\"><density>1</density>"
                            "<c1>500</c1><c2>0</c2><c3>40</c3><c4>12</c4><c5>3e3</c5><lam_max>1.2</"
                            "lam_max>"
                            "<k>9e4</k>",
             rule, "</material></Material>\n" MESH4 DOMAINS TAIL);
    lar_model *model = read_deck(deck);
    const double *a = lar_model_fibre(model, 1), want[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        if (fabs(a[i] - want[i]) > 1e-12) fail_msg("%s: %g %g %g", rule, a[0], a[1], a[2]);
    lar_model_destroy(model);
}

static void directions_turn(void **state) {
    (void)state;
    const double third = 1 / sqrt(3), half = sqrt(0.5);
    expect_direction("<fiber type=\"spherical\"><center>0.5,-0.5,-0.5</center>"
                     "<vector>3,0,0</vector></fiber>",
                     third, third, third);
    expect_direction("<fiber type=\"spherical\"><center>2.5,0.5,0.5</center></fiber>", -1, 0, 0);
    expect_direction("<fiber type=\"spherical\"><center>1.5,-1,0.5</center>"
                     "<vector>0,1,0</vector></fiber>",
                     -1, 0, 0);
    expect_direction("<fiber type=\"cylindrical\"><center>0.5,-0.5,9</center></fiber>", half, half,
                     0);
    expect_direction("<fiber type=\"cylindrical\"><center>0.5,-0.5,9</center><axis>0,0,-3</axis>"
                     "<vector>0,1,0</vector></fiber>",
                     -half, half, 0);
    expect_direction("<mat_axis type=\"cylindrical\"><center>7,0.5,2.5</center><axis>1,0,0</axis>"
                     "<vector>0,1,0</vector></mat_axis>",
                     0, 1, 0);
    /* what FEBio takes where a deck does not say */
    expect_direction("<fiber>0,0,2</fiber>", 0, 0, 1);
    expect_direction("<fiber type=\"local\">0,0</fiber>", 1, 0, 0);
    expect_direction("<mat_axis type=\"local\"><local>0,0,0</local></mat_axis>", 1, 0, 0);
    /* a parameter that means nothing at its default, and a muscle that is never active */
    expect_direction(ALONG "<active_contraction><ascl>0</ascl><Tmax>1</Tmax></active_contraction>",
                     0, 0, 1);
}

static void rays_that_are_none(void **state) {
    (void)state;
    expect_failure(DECK("trans iso Mooney-Rivlin",
                        "<k>9</k><c1>1</c1><c3>1</c3><c4>1</c4><c5>1</c5><lam_max>1.1</lam_max>"
                        "<fiber type=\"cylindrical\"><axis>0,0,0</axis></fiber>"),
                   LAR_ERROR_FORMAT, 5, "has no length");
    expect_failure(DECK("trans iso Mooney-Rivlin",
                        "<k>9</k><c1>1</c1><c3>1</c3><c4>1</c4><c5>1</c5><lam_max>1.1</lam_max>"
                        "<fiber type=\"spherical\"><center>0.5,0.5,0.5</center></fiber>"),
                   LAR_ERROR_MODEL, 0, "their direction is 0, 0, 0");
}

/* A direction belongs to the part that it stands in, in the axes of that part and around it; one of
 * fibres and one of a contraction must be the same. */
#define CONTRACTS(inside)                                                                          \
    "<solid type=\"prescribed uniaxial active contraction\"><T0>200</T0>" inside "</solid>"
#define EXPANDS(inside)                                                                            \
    "<solid type=\"fiber-exp-pow\"><ksi>300</ksi><alpha>1.5</alpha><beta>2.5</beta>" inside        \
    "</solid>"
#define FIBER(to)  "<fiber type=\"vector\">" to "</fiber>"
#define YZX        "<mat_axis type=\"vector\"><a>0,2,0</a><d>0,1,3</d></mat_axis>"
#define MIX(parts) DECK("solid mixture", SOLID parts)

static void directions_belong_to_parts(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double way[3];
        int notices;
    } decks[] = {
        {MIX(CONTRACTS("")), {1, 0, 0}, 1},
        {MIX(YZX CONTRACTS("")), {0, 1, 0}, 0},
        {MIX(CONTRACTS("<theta>90</theta>")), {0, 1, 0}, 0},
        {MIX(CONTRACTS("<phi>0</phi>")), {0, 0, 1}, 0},
        {MIX(YZX CONTRACTS("<theta>90</theta><phi>90</phi>")), {0, 0, 1}, 0},
        {MIX(YZX CONTRACTS(YZX)), {0, 0, 1}, 0},
        {MIX(CONTRACTS("<fiber type=\"angles\"><theta>90</theta></fiber>")), {0, 1, 0}, 0},
        {MIX(YZX EXPANDS("<theta>90</theta><phi>90</phi>")), {0, 0, 1}, 0},
        {MIX(CONTRACTS("<phi>0</phi>") EXPANDS("<phi>180</phi>")), {0, 0, -1}, 0},
        {MIX(CONTRACTS("") EXPANDS("")), {1, 0, 0}, 2},
        {MIX(YZX CONTRACTS("") EXPANDS("")), {0, 1, 0}, 0},
        {MIX(YZX CONTRACTS("") EXPANDS(FIBER("3,0,0"))), {0, 1, 0}, 0},
        {MIX(CONTRACTS(FIBER("0,0,-1")) EXPANDS(FIBER("0,0,2"))), {0, 0, 1}, 0},
        {MIX(CONTRACTS(YZX) EXPANDS(FIBER("0,1,0"))), {0, 1, 0}, 0},
        {MIX(YZX CONTRACTS(YZX) EXPANDS(FIBER("0,1,0"))), {0, 0, 1}, 0},
    };
    for (size_t i = 0; i < sizeof decks / sizeof *decks; i++) {
        lar_model *model = read_deck(decks[i].text);
        const double *a = lar_model_fibre(model, 1);
        for (int k = 0; k < 3; k++)
            if (fabs(a[k] - decks[i].way[k]) > 1e-12)
                fail_msg("deck %zu: %g %g %g", i, a[0], a[1], a[2]);
        assert_int_equal(notices_with(model, "it is x, as in FEBio"), decks[i].notices);
        assert_int_equal(notices_with(model, "known"), 0);
        lar_model_destroy(model);
    }
    static const char *const apart[] = {
        MIX(CONTRACTS(FIBER("0,1,0")) EXPANDS("")),     MIX(CONTRACTS("") EXPANDS(FIBER("0,1,0"))),
        MIX(YZX CONTRACTS("") EXPANDS(FIBER("0,1,0"))), MIX(CONTRACTS("") EXPANDS(YZX)),
        MIX(CONTRACTS(FIBER("1,1e-5,0")) EXPANDS("")),
    };
    for (size_t i = 0; i < sizeof apart / sizeof *apart; i++)
        expect_failure(apart[i], LAR_ERROR_UNSUPPORTED, 5,
                       "'prescribed uniaxial active contraction' acts along another direction than "
                       "'fiber-exp-pow' (line 5)");
    expect_failure(MIX(CONTRACTS("<theta>1</theta>" FIBER("1,0,0"))), LAR_ERROR_FORMAT, 5,
                   "stand beside <fiber>");
    expect_failure(MIX(EXPANDS("<phi>1</phi>" FIBER("1,0,0"))), LAR_ERROR_FORMAT, 5,
                   "stand beside <fiber>");
}

/* ---- version 2.5 ----------------------------------------------------------------------------- */

#define OLD(boundary, rest)                                                                        \
    "<?xml version=\"1.0\"?>\n<febio_spec version=\"2.5\">\n<Material><material id=\"1\" "         \
    "type=\"neo-Hookean\"><density>1</density><E>3</E><v>0.2</v></material></Material>\n"          \
    "<Geometry>\n" NODES "<Elements type=\"hex8\" mat=\"1\"><elem id=\"1\">1,2,3,4,5,6,7,8</elem>" \
    "<elem id=\"2\">2,9,10,3,6,11,12,7</elem></Elements>\n<NodeSet name=\"wall\"><node id=\"1\"/>" \
    "<node id=\"4\"/></NodeSet>\n<NodeSet name=\"tip\"><node id=\"9\"/></NodeSet></Geometry>\n"    \
    "<Boundary>\n" boundary "</Boundary>\n" rest TAIL
#define OLD_CONTROL                                                                                \
    "<Control><time_steps>10</time_steps><step_size>0.1</step_size><analysis type=\"dynamic\"/>"   \
    "</Control>\n"
#define OLD_STEP                                                                                   \
    "<Step name=\"one\">" OLD_CONTROL "<Boundary><prescribe bc=\"x\" node_set=\"tip\">"            \
    "<scale lc=\"1\">-2</scale></prescribe></Boundary></Step>"
#define OLD_CURVE                                                                                  \
    "<LoadData><loadcurve id=\"1\" type=\"linear\" extend=\"extrapolate\"><point>0,0</point>"      \
    "<loadpoint>0.5,3</loadpoint></loadcurve></LoadData>"

static void old_decks_are_read(void **state) {
    (void)state;
    lar_model *model =
        read_deck(OLD("<fix bc=\"x,z\" node_set=\"wall\"/>",
                      "<Loads><nodal_load bc=\"y\" node_set=\"tip\"><scale lc=\"1\">4</scale>"
                      "</nodal_load></Loads>\n" OLD_STEP OLD_CURVE));
    assert_true(model->duration == 1 && model->damping == 0 && model->mesh.element_count == 2);
    assert_true(model->fix_count == 1 && model->fix[0].axes == (LAR_AXIS_X | LAR_AXIS_Z));
    assert_true(model->fix[0].nodes.count == 2);
    assert_true(model->move_count == 1 && model->move[0].by == -2 &&
                model->move[0].axes == LAR_AXIS_X);
    assert_true(model->load_count == 1 && model->load[0].force[1] == 4);
    const lar_curve *curve = &model->curve[model->load[0].curve];
    assert_true(fabs(lar_curve_value(curve, 0.25) - 1.5) < 1e-12);
    assert_true(fabs(lar_curve_value(curve, 1) - 6) < 1e-12);
    assert_int_equal(model->notice_count, 1); /* a node that nothing uses */
    lar_model_destroy(model);
}

/* Initial velocities of all forms, along one axis too; and curves that a condition names. */
static void old_words_are_read(void **state) {
    (void)state;
    lar_model *model = read_deck(
        OLD("<fix bc=\"x\" node_set=\"wall\" type=\"odd\"/>"
            "<prescribe bc=\"x\" node_set=\"tip\" type=\"relative\" lc=\"1\"><scale>3</scale>"
            "<value>2</value></prescribe>",
            "<Loads><nodal_load bc=\"y\" node_set=\"tip\" lc=\"1\"><scale>4</scale></nodal_load>"
            "</Loads><Initial><velocity node_set=\"wall\"><value>1,2,3</value></velocity>"
            "<init bc=\"vy\" node_set=\"tip\"><value>4</value></init>"
            "<init bc=\"vx\" node_set=\"wall\"><value>-1</value></init></Initial>" OLD_CONTROL
                OLD_CURVE));
    assert_true(model->move[0].by == 6 && model->load[0].force[1] == 4);
    assert_int_equal(model->move[0].curve, model->load[0].curve);
    assert_true(lar_curve_value(&model->curve[model->load[0].curve], 0.25) == 1.5);
    assert_int_equal(model->initial_count, 2);
    const double(*v)[3] = &model->initial[0].velocity;
    assert_true((*v)[0] == -1 && (*v)[1] == 2 && model->initial[0].nodes.count == 2);
    assert_true(model->initial[1].velocity[1] == 4 && model->initial[1].velocity[0] == 0);
    assert_int_equal(notices_with(model, "attribute type of <fix> is not known"), 1);
    assert_int_equal(notices_with(model, "attribute type of <prescribe> is not known"), 1);
    assert_int_equal(notices_with(model, "known"), 2);
    lar_model_destroy(model);
    expect_failure(OLD("", "<Initial><init bc=\"x\" node_set=\"tip\"><value>1</value></init>"
                           "</Initial>" OLD_CONTROL),
                   LAR_ERROR_UNSUPPORTED, 13, "'x' is not one of vx, vy, vz");
    expect_failure(
        OLD("", "<Initial><velocity node_set=\"@part:\"><value>1,2,3</value></velocity></Initial>"),
        LAR_ERROR_FORMAT, 13, "element set ''");
    expect_failure(OLD("",
                       "<Initial><velocity node_set=\"@surface:s\"><value>1,2,3</value></velocity>"
                       "</Initial>"),
                   LAR_ERROR_FORMAT, 13, "<velocity> names the surface 's'");
    expect_failure(OLD("<prescribe bc=\"x\" node_set=\"tip\"><scale>1</scale></prescribe>\n"
                       "<prescribe bc=\"x\" node_set=\"tip\"><scale>2</scale></prescribe>",
                       OLD_CONTROL),
                   LAR_ERROR_MODEL, 13,
                   "<prescribe> moves node 9 along x, which <prescribe> in line 12");
}

/* Lines stay those of the file. */
static void old_decks_that_are_refused(void **state) {
    (void)state;
    expect_failure(OLD("\n<fix bc=\"q\" node_set=\"wall\"/>", OLD_CONTROL), LAR_ERROR_UNSUPPORTED,
                   13, "the degree of freedom 'q'");
    expect_failure(OLD("<prescribe bc=\"x\" node_set=\"tip\"><scale lc=\"7\">1</scale></prescribe>",
                       OLD_CONTROL),
                   LAR_ERROR_FORMAT, 12, "names the load controller 7");
    expect_failure(OLD("<rigid rb=\"2\" node_set=\"tip\"/>", OLD_CONTROL), LAR_ERROR_UNSUPPORTED,
                   12, "<rigid> in <Boundary>");
    expect_failure(OLD("", OLD_STEP "\n" OLD_STEP), LAR_ERROR_UNSUPPORTED, 0, "second <Step>");
    expect_failure("<febio_spec version=\"2.5\"/>", LAR_ERROR_FORMAT, 0, "");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mixtures_may_be_viscous),
        cmocka_unit_test(moduli_and_densities_add_up),
        cmocka_unit_test(augmented_materials_keep_their_volume),
        cmocka_unit_test(mixtures_that_are_refused),
        cmocka_unit_test(directions_turn),
        cmocka_unit_test(directions_belong_to_parts),
        cmocka_unit_test(rays_that_are_none),
        cmocka_unit_test(old_decks_are_read),
        cmocka_unit_test(old_words_are_read),
        cmocka_unit_test(old_decks_that_are_refused),
    };
    return cmocka_run_group_tests_name("feb_mixtures", tests, NULL, NULL);
}
