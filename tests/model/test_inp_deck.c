/* Abaqus and CalculiX decks as models: what is read, and by which name and line the rest is
 * refused. */
#include "model/inp_deck.h"

/* ---- supports ------------------------------------------------------------------------------ */

static unsigned fixed(const lar_model *model, int64_t id) {
    unsigned axes = 0;
    for (int i = 0; i < model->fix_count; i++)
        for (int32_t n = 0; n < model->fix[i].nodes.count; n++)
            if (model->mesh.node_id[model->fix[i].nodes.node[n]] == id) axes |= model->fix[i].axes;
    return axes;
}

static const lar_move *moved(const lar_model *model, int64_t id, unsigned axes) {
    for (int i = 0; i < model->move_count; i++)
        for (int32_t n = 0; n < model->move[i].nodes.count; n++)
            if (model->mesh.node_id[model->move[i].nodes.node[n]] == id &&
                model->move[i].axes == axes)
                return &model->move[i];
    return NULL;
}

static void test_supports(void **state) {
    (void)state;
    lar_model *model = read_deck(MESH SOFT "*BOUNDARY\n1, ENCASTRE\nwall, 1\n4, 2, 6\n9, XSYMM\n"
                                           "2, 1, 1\n3, 4, 6\n" STATIC
                                           "*BOUNDARY\nTIP, 1, 1, 0.5\n2, 1, 2, -0.25\n5, 3, 3, 0\n"
                                           "*BOUNDARY, AMPLITUDE=up\n10, 3, 3, 2\n" END
                                           "*AMPLITUDE, NAME=UP\n0, 0, 1, 1, 4, 4\n");
    assert_int_equal(fixed(model, 1), LAR_AXIS_ALL);
    assert_int_equal(fixed(model, 4), LAR_AXIS_ALL);
    assert_int_equal(fixed(model, 5), LAR_AXIS_X | LAR_AXIS_Z);
    assert_int_equal(fixed(model, 3), 0);
    /* what the step says takes the place of what stands above it */
    assert_int_equal(fixed(model, 2), 0);
    assert_int_equal(fixed(model, 9), 0);
    const lar_move *tip = moved(model, 9, LAR_AXIS_X), *side = moved(model, 2, LAR_AXIS_Y);
    assert_non_null(tip);
    assert_non_null(side);
    near(tip->by, 0.5);
    assert_int_equal(tip->nodes.count, 4);
    near(side->by, -0.25);
    /* a static step's displacements grow over its period; an amplitude ends with it */
    near(at(model, tip->curve, 1), 0.5);
    near(at(model, tip->curve, 7), 1);
    const lar_move *up = moved(model, 10, LAR_AXIS_Z);
    assert_non_null(up);
    near(at(model, up->curve, 1), 1);
    near(at(model, up->curve, 9), 2);
    assert_int_equal(lar_model_until_rest(model), 1);
    assert_true(model->damping > 0 && model->duration == 2);
    lar_model_destroy(model);

    model = read_deck(MESH SOFT "*BOUNDARY\nWALL, 1, 3\n" DYNAMIC
                                "*BOUNDARY, OP=NEW\n1, 1, 3\n*BOUNDARY, OP=NEW\n2, 1, 3\n" END);
    assert_int_equal(fixed(model, 4), 0);
    assert_int_equal(fixed(model, 1), LAR_AXIS_ALL);
    assert_int_equal(fixed(model, 2), LAR_AXIS_ALL);
    lar_model_destroy(model);
}

/* Abaqus/Standard ramps displacements in steps of all kinds, CalculiX lets them jump in *DYNAMIC;
 * which of both it is is told once. */
static void test_displaced_over_the_step(void **state) {
    (void)state;
    static const char ramps[] = "this displacement grows linearly over the step";
    static const char jumps[] = "this displacement is there at once";
    lar_model *model = read_deck(MESH SOFT DYNAMIC "*BOUNDARY\nWALL, 1, 3\nTIP, 1, 1, 0.1\n"
                                                   "TIP, 2, 2, 0.1\n" END);
    assert_int_equal(notices_with(model, ramps), 1);
    assert_int_equal(notices_with(model, "deck.inp:40: this displacement"), 1);
    near(at(model, model->move[0].curve, 0), 0);
    near(at(model, model->move[0].curve, 1), 0.5);
    lar_model_destroy(model);
    static const char *const jumping[] = {
        MESH SOFT "*STEP, NLGEOM, AMPLITUDE=STEP\n*DYNAMIC\n, 2\n*BOUNDARY\nTIP, 1, 1, 1\n" END,
        MESH SOFT "*STEP, AMPLITUDE=STEP\n*DYNAMIC, EXPLICIT\n, 2\n*BOUNDARY\nTIP, 1, 1, 1\n" END,
        MESH SOFT "*AMPLITUDE, NAME=late\n1, 1, 2, 2\n" DYNAMIC
                  "*BOUNDARY, AMPLITUDE=late\nTIP, 1, 1, 0.1\n" END};
    static const char *const quiet[] = {
        MESH SOFT STATIC "*BOUNDARY\nTIP, 1, 1, 0.1\n" END,
        MESH SOFT DYNAMIC "*BOUNDARY\nTIP, 1, 1\nTIP, 4, 6, 1\n" END,
        MESH SOFT "*STEP, NLGEOM\n*VISCO\n0.1, 2\n*BOUNDARY\nTIP, 1, 1, 0.1\n" END,
        MESH SOFT "*AMPLITUDE, NAME=up\n0, 0, 1, 1\n" DYNAMIC
                  "*BOUNDARY, AMPLITUDE=up\nTIP, 1, 1, 0.1\n" END,
        MESH SOFT "*STEP, NLGEOM, AMPLITUDE=RAMP\n*DYNAMIC\n, 2\n*BOUNDARY\nTIP, 1, 1, 1\n" END};
    const size_t jump_count = sizeof jumping / sizeof *jumping;
    for (size_t i = 0; i < jump_count + sizeof quiet / sizeof *quiet; i++) {
        bool jump = i < jump_count;
        model = read_deck(jump ? jumping[i] : quiet[i - jump_count]);
        assert_int_equal(notices_with(model, jumps), jump);
        assert_int_equal(notices_with(model, ramps), 0);
        lar_model_destroy(model);
    }
    refused(MESH SOFT "*STEP, NLGEOM\n*DYNAMIC, EXPLICIT\n, 2\n*BOUNDARY\nTIP, 1, 1, 0.1\n" END,
            LAR_ERROR_UNSUPPORTED, AFTER_SOFT + 4, "EXPLICIT is 0 in Abaqus");
}

static void test_bad_supports(void **state) {
    (void)state;
    const int line = AFTER_SOFT;
    refused(MESH SOFT "*BOUNDARY\nWALL, 11, 11, 20\n", LAR_ERROR_UNSUPPORTED, line + 1,
            "the degrees of freedom 11 to 11 are none of a solid");
    refused(MESH SOFT "*BOUNDARY\nWALL, CLAMPED\n", LAR_ERROR_FORMAT, line + 1, "ENCASTRE");
    refused(MESH SOFT "*BOUNDARY\nNONE, 1\n", LAR_ERROR_FORMAT, line + 1, "'NONE' is neither");
    refused(MESH SOFT "*BOUNDARY\n99, 1\n", LAR_ERROR_FORMAT, line + 1,
            "there is no node 99 that belongs to a hexahedron");
    refused(MESH SOFT "*BOUNDARY\nTIP, 1, 1, 0.1\n", LAR_ERROR_FORMAT, line,
            "*BOUNDARY stands outside of a step");
    refused(MESH SOFT "*BOUNDARY, TYPE=VELOCITY\nTIP, 1, 1, 0.1\n", LAR_ERROR_UNSUPPORTED, line,
            "type 'VELOCITY'");
    refused(MESH SOFT STATIC "*BOUNDARY, FIXED\nTIP, 1\n" END, LAR_ERROR_UNSUPPORTED, line + 3,
            "the parameter FIXED of *BOUNDARY");
    refused(MESH SOFT STATIC "*BOUNDARY, AMPLITUDE=no\nTIP, 1, 1, 1\n" END, LAR_ERROR_FORMAT,
            line + 3, "there is no *AMPLITUDE called 'no'");
    refused(MESH SOFT "*TRANSFORM, NSET=WALL\n1,0,0,0,1,0\n", LAR_ERROR_UNSUPPORTED, line,
            "*TRANSFORM");
    refused(MESH SOFT "*EQUATION\n2\n", LAR_ERROR_UNSUPPORTED, line, "*EQUATION");
}

/* ---- loads --------------------------------------------------------------------------------- */

static void test_loads(void **state) {
    (void)state;
    lar_model *model = read_deck(MESH SOFT "*AMPLITUDE, NAME=swing, DEFINITION=SMOOTH STEP\n0, 0, "
                                           "1, 2\n" DYNAMIC "*CLOAD\nTIP, 3, -2\n9, 3, -1\n"
                                           "*CLOAD, AMPLITUDE=swing\n1, 1, 4\n"
                                           "*DLOAD\nRIGHT, P4, 100\n2, P2, 100\nLEFT, P6, -7\n"
                                           "LEFT, GRAV, 9.81, 0, 0, -1\nRIGHT, GRAV, 9.81, 0, 0, "
                                           "-1\n"
                                           "*DSLOAD, OP=NEW\nend, P, 5\n" END);
    assert_int_equal(model->load_count, 3);
    assert_int_equal(notices_with(model, "1 nodes have a force in this direction already"), 1);
    assert_int_equal(model->load[0].nodes.count + model->load[1].nodes.count, 4);
    near(model->load[0].force[2] + model->load[1].force[2], -5);
    near(model->load[2].force[0], 4);
    near(at(model, model->load[0].curve, 0), 1); /* at once, in a dynamic step */
    near(at(model, model->load[2].curve, 0.25), 2 * 0.103515625);
    near(at(model, model->load[2].curve, 3), 2);
    /* S4 of element 2 is its far end, local face 1 */
    assert_int_equal(model->pressure_count, 3);
    int32_t faces = 0;
    for (int i = 0; i < 3; i++) {
        const lar_pressure_load *load = &model->pressure[i];
        faces += load->count;
        if (load->pressure == 5) assert_int_equal(load->face[0], 6 + 1);
        if (load->pressure == -7) assert_int_equal(load->face[0], 0);
        if (load->pressure == 100) assert_int_equal(load->face[0] + load->face[1], 2 * 6 + 1 + 5);
    }
    assert_int_equal(faces, 4);
    near(model->gravity[2], -9.81);
    assert_int_equal(model->duration, 2);
    assert_int_equal(lar_model_until_rest(model), 0);
    assert_true(model->damping == 0);
    lar_model_destroy(model);

    model = read_deck(MESH SOFT STATIC "*DLOAD\n, GRAV, 2, 0.6, 0, 0.8\nLEFT, GRAV, 2, 0.6, 0, "
                                       "0.8\n" END);
    assert_int_equal(notices_with(model, "acts once, not twice"), 1);
    lar_model_destroy(model);
    /* different ones add up; each axis may have an amplitude of its own */
    model = read_deck(MESH SOFT "*AMPLITUDE, NAME=up\n0, 0, 1, 4\n"
                                "*STEP, NLGEOM, AMPLITUDE=RAMP\n*DYNAMIC\n0.1, 2\n"
                                "*DLOAD\nLEFT, GRAV, 2, 0, 0, -1\n, GRAV, 3, 0, 1, 0\nRIGHT, "
                                "GRAV, 2, 0, 0, -1\n, GRAV, 1, 0, 0.6, -0.8\n"
                                "*DLOAD, AMPLITUDE=up\nBOTH, GRAV, 5, 1, 0, 0\n" END);
    near(model->gravity[0], 5);
    near(model->gravity[1], 3.6);
    near(model->gravity[2], -2.8);
    near(at(model, model->gravity_curve[2], 1), 0.5);
    near(at(model, model->gravity_curve[0], 1), 4);
    assert_int_equal(notices_with(model, "GRAV"), 0);
    lar_model_destroy(model);
    model = read_deck(MESH SOFT STATIC "*DLOAD\n, GRAV, 2, 0.6, 0, 0.8\n" END);
    near(model->gravity[0] * model->material[0].density, 1200); /* its weight */
    near(at(model, model->gravity_curve[0], 1), 0.5);           /* grows, in a static step */
    lar_model_destroy(model);
    model = read_deck(MESH SOFT "*STEP, NLGEOM, AMPLITUDE=STEP\n*STATIC\n*CLOAD\n9, 1, 1\n" END);
    near(at(model, model->load[0].curve, 0), 1);
    assert_true(model->duration == 1);
    lar_model_destroy(model);
}

/* The same face twice: both act, and that is told, whatever the face is called. */
static void test_pressure_twice(void **state) {
    (void)state;
    lar_model *model = read_deck(MESH SOFT DYNAMIC "*DLOAD\nRIGHT, P4, 100\nBOTH, P1, 1\n"
                                                   "2, P4, 0\nBOTH, P1, 2\n"
                                                   "*DSLOAD\nend, P, 5\n" END);
    assert_int_equal(model->notice_count, 2);
    assert_int_equal(notices_with(model, "deck.inp:42: 2 faces have a pressure already; the two "
                                         "are added"),
                     1);
    assert_int_equal(notices_with(model, "deck.inp:44: 1 faces have a pressure already"), 1);
    lar_model_destroy(model);
}

/* A mirrored cube: its corners are taken the other way round, and faces stay where they are. */
static void test_left_handed(void **state) {
    (void)state;
    lar_model *model = read_deck(
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, -1\n6, 1, 0, -1\n"
        "7, 1, 1, -1\n8, 0, 1, -1\n*ELEMENT, TYPE=C3D8, ELSET=BOTH\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
        "*SURFACE, NAME=End\n1, S2\n" SOFT DYNAMIC
        "*DLOAD\nBOTH, P1, 100\n1, P3, 70\n*DSLOAD\nend, P, 5\n" END);
    assert_int_equal(notices_with(model, "left-handed"), 1);
    assert_int_equal(model->mesh.element[0][0], 4);
    assert_int_equal(model->pressure_count, 3);
    for (int i = 0; i < 3; i++) {
        double place = 0, side = 0;
        const lar_pressure_load *load = &model->pressure[i];
        for (int k = 0; k < 4; k++) {
            int32_t node = model->mesh.element[0][lar_face_node[load->face[0]][k]];
            place += model->mesh.position[node][2] / 4;
            side += model->mesh.position[node][1] / 4;
        }
        near(place, load->pressure == 100 ? 0 : load->pressure == 5 ? -1 : -0.5);
        near(side, load->pressure == 70 ? 0 : 0.5);
    }
    lar_model_destroy(model);
}

static void test_bad_loads(void **state) {
    (void)state;
    const int in = AFTER_SOFT + 3;
    refused(MESH SOFT "*CLOAD\nTIP, 1, 1\n", LAR_ERROR_FORMAT, AFTER_SOFT, "outside of a step");
    refused(MESH SOFT STATIC "*CLOAD\nTIP, 4, 1\n" END, LAR_ERROR_UNSUPPORTED, in + 1, "moments");
    refused(MESH SOFT STATIC "*CLOAD, FOLLOWER\nTIP, 1, 1\n" END, LAR_ERROR_UNSUPPORTED, in,
            "FOLLOWER");
    refused(MESH SOFT STATIC "*CLOAD\nTIP, 1, 1e400\n" END, LAR_ERROR_FORMAT, in + 1,
            "expected a force");
    refused(MESH SOFT STATIC "*CLOAD\nTIP, 1, 1, 2\n" END, LAR_ERROR_FORMAT, in + 1,
            "expected the end of the line");
    refused(MESH SOFT STATIC "*DLOAD\nBOTH, CENTRIF, 1\n" END, LAR_ERROR_UNSUPPORTED, in + 1,
            "the load 'CENTRIF' is not read");
    refused(MESH SOFT STATIC "*DLOAD\nBOTH, P7, 1\n" END, LAR_ERROR_UNSUPPORTED, in + 1, "'P7'");
    refused(MESH SOFT STATIC "*DLOAD\nLEFT, GRAV, 9.81, 0, 0, -1\n" END, LAR_ERROR_UNSUPPORTED,
            in + 1, "GRAV leaves out element 2");
    refused(MESH SOFT STATIC "*DLOAD\nBOTH, GRAV, 9.81, 0, 0, -2\n" END, LAR_ERROR_FORMAT, in + 1,
            "length 2");
    refused(MESH SOFT STATIC "*DLOAD\n, GRAV, 1, 0, 0, 1\nRIGHT, GRAV, 2, 0, 0, 1\n" END,
            LAR_ERROR_UNSUPPORTED, in + 2, "GRAV leaves out element 1");
    refused(MESH SOFT "*AMPLITUDE, NAME=a\n0, 0, 1, 1\n" STATIC "*DLOAD\n, GRAV, 1, 0, 0, 1\n"
                      "*DLOAD, AMPLITUDE=a\n, GRAV, 2, 0, 0, 1\n" END,
            LAR_ERROR_UNSUPPORTED, in + 5, "another GRAV along z has another amplitude");
    refused(MESH SOFT STATIC "*DLOAD\n, GRAV, 1, 1\n, GRAV, 2, 1\n, GRAV, 3, 1\n, GRAV, 4, 1\n"
                             ", GRAV, 5, 1\n, GRAV, 6, 1\n, GRAV, 7, 1\n, GRAV, 8, 1\n"
                             ", GRAV, 9, 1\n" END,
            LAR_ERROR_UNSUPPORTED, in + 9, "more than 8 different GRAV");
    refused(MESH SOFT STATIC "*DSLOAD\nInside, P, 1\n" END, LAR_ERROR_UNSUPPORTED, in + 1,
            "is one of nodes");
    refused(MESH SOFT STATIC "*DSLOAD\nEnd, HP, 1\n" END, LAR_ERROR_UNSUPPORTED, in + 1,
            "pressures");
    refused(MESH SOFT STATIC "*TEMPERATURE\nALL, 20\n" END, LAR_ERROR_UNSUPPORTED, in,
            "*TEMPERATURE");
    refused(MESH SOFT "*AMPLITUDE, NAME=a\n0, 0, 0, 1\n", LAR_ERROR_FORMAT, AFTER_SOFT + 1,
            "sort the points by time");
    refused(MESH SOFT "*AMPLITUDE, NAME=a\n0, 0, 1\n", LAR_ERROR_FORMAT, AFTER_SOFT + 1,
            "expected a value");
    refused(MESH SOFT "*AMPLITUDE, NAME=a\n", LAR_ERROR_FORMAT, AFTER_SOFT, "has no points");
    refused(MESH SOFT "*AMPLITUDE, NAME=a, DEFINITION=PERIODIC\n", LAR_ERROR_UNSUPPORTED,
            AFTER_SOFT, "TABULAR and SMOOTH STEP");
}

/* What a support bears at once moves nothing. */
static void test_forces_on_supports(void **state) {
    (void)state;
    lar_model *model =
        read_deck(MESH SOFT "*BOUNDARY\nWALL, 1, 3\n" STATIC "*BOUNDARY\n9, 1, 1, 0.1\n"
                            "*CLOAD\nALL, 1, 1\n10, 2, 1\n" END);
    assert_int_equal(notices_with(model, "deck.inp:42: forces on 5 nodes act along axes that "
                                         "*BOUNDARY holds: they move nothing"),
                     1);
    lar_model_destroy(model);
}

static void test_initial_velocity(void **state) {
    (void)state;
    lar_model *model = read_deck(MESH SOFT "*INITIAL CONDITIONS, TYPE=VELOCITY\nALL, 1, 2\nTip, 1, "
                                           "3\n9, 3, -1\n" DYNAMIC END);
    assert_int_equal(model->initial_count, 3);
    int32_t nodes = 0;
    for (int i = 0; i < 3; i++) {
        const lar_initial_velocity *initial = &model->initial[i];
        nodes += initial->nodes.count;
        if (initial->nodes.count == 1) near(initial->velocity[2], -1);
        near(initial->velocity[0], initial->nodes.count == 8 ? 2 : 3);
    }
    assert_int_equal(nodes, 12);
    lar_model_destroy(model);
    /* a static step knows neither velocity nor damping */
    model = read_deck(MESH "*MATERIAL, NAME=a\n*ELASTIC\n1, 0.3\n*DAMPING, ALPHA=7\n*MATERIAL, "
                           "NAME=b\n*ELASTIC\n1, 0.3\n*SOLID SECTION, ELSET=LEFT, MATERIAL=a\n"
                           "*SOLID SECTION, ELSET=RIGHT, MATERIAL=b\n*INITIAL CONDITIONS, "
                           "TYPE=VELOCITY\nALL, 1, 2\n" STATIC END);
    assert_int_equal(model->initial_count, 0);
    assert_int_equal(notices_with(model, "deck.inp:38: initial velocities were left out"), 1);
    assert_int_equal(notices_with(model, "deck.inp:32: *DAMPING was left out: it does not count"),
                     1);
    lar_model_destroy(model);
    refused(MESH SOFT "*INITIAL CONDITIONS, TYPE=STRESS\nBOTH, 1\n", LAR_ERROR_UNSUPPORTED,
            AFTER_SOFT, "type 'STRESS' is not read and would change the answer");
    refused(MESH SOFT "*INITIAL CONDITIONS, TYPE=VELOCITY\nALL, 5, 1\n", LAR_ERROR_FORMAT,
            AFTER_SOFT + 1, "a direction 1, 2 or 3");
}

/* ---- contact ------------------------------------------------------------------------------- */

#define TWO                                                                                        \
    "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n"  \
    "8, 0, 1, 1\n11, 0, 0, 2\n12, 1, 0, 2\n13, 1, 1, 2\n14, 0, 1, 2\n15, 0, 0, 3\n16, 1, 0, 3\n"   \
    "17, 1, 1, 3\n18, 0, 1, 3\n*ELEMENT, TYPE=C3D8, ELSET=BOTH\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"       \
    "2, 11, 12, 13, 14, 15, 16, 17, 18\n*SURFACE, NAME=Top\n1, S2\n*SURFACE, NAME=Under\n2, S1\n"  \
    "*SURFACE, NAME=Points, TYPE=NODE\n11\n" SOFT

static void test_contact(void **state) {
    (void)state;
    lar_model *model =
        read_deck(TWO "*SURFACE INTERACTION, NAME=touch\n1.,\n*SURFACE BEHAVIOR, "
                      "PRESSURE-OVERCLOSURE=LINEAR\n1e5, 1\n*FRICTION\n0.,\n"
                      "*CONTACT PAIR, INTERACTION=touch, SMALL SLIDING\nunder, TOP\n");
    assert_int_equal(model->contact_count, 1);
    assert_int_equal(model->contact[0].kind, LAR_CONTACT_BETWEEN);
    assert_int_equal(model->contact[0].face[0], 6 + 4);
    assert_int_equal(model->contact[0].against[0], 5);
    assert_int_equal(notices_with(model, "PRESSURE-OVERCLOSURE=LINEAR was left out"), 1);
    assert_int_equal(notices_with(model, "SMALL SLIDING was left out"), 1);
    lar_model_destroy(model);
    const int line = 33;
    refused(TWO "*FRICTION\n0.3,\n", LAR_ERROR_UNSUPPORTED, line,
            "*FRICTION belongs to no *SURFACE INTERACTION");
    refused(TWO "*CONTACT PAIR, INTERACTION=a\nPoints, Top\n", LAR_ERROR_UNSUPPORTED, line + 1,
            "the surface 'Points' is one of nodes");
    refused(TWO "*CONTACT PAIR, INTERACTION=a\n", LAR_ERROR_FORMAT, line, "names no surfaces");
    refused(TWO "*CONTACT PAIR, TIED\nUnder, Top\n", LAR_ERROR_UNSUPPORTED, line, "TIED");
    refused(TWO "*CONTACT PAIR\nUnder, Nothing\n", LAR_ERROR_FORMAT, line + 1,
            "there is no surface 'Nothing' of faces");
    refused(TWO "*TIE, NAME=a\nUnder, Top\n", LAR_ERROR_UNSUPPORTED, line, "*TIE");
    refused(TWO "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n", LAR_ERROR_UNSUPPORTED, line,
            "join their nodes");
    refused(MESH "*SURFACE, NAME=Mid\n1, S4\n" SOFT "*CONTACT PAIR\nMid, End\n", LAR_ERROR_MODEL,
            AFTER_SOFT + 3, "is inside the body");
}

#define PAIR       "*CONTACT PAIR, INTERACTION=Rough\nUnder, Top\n"
#define RUBS(card) TWO "*SURFACE INTERACTION, NAME=rough\n1.,\n" card PAIR

/* Coulomb's, with one coefficient, for the pairs that name the interaction. */
static void test_friction(void **state) {
    (void)state;
    lar_model *model =
        read_deck(TWO "*SURFACE INTERACTION, NAME=smooth\n1.,\n*FRICTION\n0.,\n" PAIR
                      "*CONTACT PAIR, INTERACTION=Smooth\nUnder, Top\n*CONTACT PAIR\n"
                      "Top\n*SURFACE INTERACTION, NAME=rough\n1.,\n*FRICTION, SLIP "
                      "TOLERANCE=0.005\n 0.3,\n*SURFACE BEHAVIOR, "
                      "PRESSURE-OVERCLOSURE=HARD\n");
    assert_int_equal(model->contact_count, 3);
    assert_true(model->contact[0].friction == 0.3 && model->contact[1].friction == 0 &&
                model->contact[2].friction == 0);
    assert_int_equal(notices_with(model, "SLIP TOLERANCE was left out"), 1);
    lar_model_destroy(model);
    model = read_deck(RUBS("*FRICTION\n0.25, 5000.\n")); /* as CalculiX has it */
    assert_true(model->contact[0].friction == 0.25);
    assert_int_equal(notices_with(model, "stick slope, was left out"), 1);
    lar_model_destroy(model);
    const int line = 35;
    refused(RUBS("*FRICTION, ROUGH\n"), LAR_ERROR_UNSUPPORTED, line, "ROUGH of *FRICTION");
    refused(RUBS("*FRICTION, ANISOTROPIC\n0.3, 0.2\n"), LAR_ERROR_UNSUPPORTED, line,
            "ANISOTROPIC of *FRICTION");
    refused(RUBS("*FRICTION, TAUMAX=1e3\n0.3\n"), LAR_ERROR_UNSUPPORTED, line, "TAUMAX");
    refused(RUBS("*FRICTION\n0.3, , 1e3\n"), LAR_ERROR_UNSUPPORTED, line + 1,
            "depends on pressure");
    refused(RUBS("*FRICTION\n0.3\n0.2, 0.01\n"), LAR_ERROR_UNSUPPORTED, line + 2, "slip rate");
    refused(RUBS("*FRICTION\n-0.3\n"), LAR_ERROR_MODEL, line + 1, "must be from 0 to 5");
    refused(RUBS("*FRICTION\nmuch\n"), LAR_ERROR_FORMAT, line + 1, "a coefficient");
    refused(RUBS("*FRICTION\n0.3\n*FRICTION\n0.2\n"), LAR_ERROR_FORMAT, line + 2,
            "a second *FRICTION of *SURFACE INTERACTION 'rough', after line 35");
    refused(RUBS("*SURFACE INTERACTION, NAME=ROUGH\n"), LAR_ERROR_FORMAT, line,
            "a second *SURFACE INTERACTION is called 'ROUGH'");
    refused(TWO "*SURFACE INTERACTION\n1.\n", LAR_ERROR_FORMAT, line - 2, "has no NAME");
    refused(TWO PAIR, LAR_ERROR_FORMAT, line - 2, "no *SURFACE INTERACTION called 'Rough'");
}

/* ---- sets ---------------------------------------------------------------------------------- */

/* A range may have numbers that do not exist, with a notice; a list must not. */
static void test_ranges(void **state) {
    (void)state;
    lar_model *model = read_deck(MESH "*NSET, NSET=a, GENERATE\n9, 12\n10, 2000000000\n1, 1\n"
                                      "*ELSET, ELSET=b, GENERATE\n1, 2\n-7, 2, 3\n" SOFT);
    assert_int_equal(model->notice_count, 1);
    assert_int_equal(notices_with(model,
                                  "deck.inp:31: 2 ranges of sets (GENERATE), the first here, "
                                  "have numbers that the file does not define"),
                     1);
    lar_model_destroy(model);
    refused(MESH "*NSET, NSET=a, GENERATE\n9, 12\n500, 2000000000\n" SOFT, LAR_ERROR_FORMAT, 31,
            "the file defines no node of this range; correct it or remove the line");
    refused(MESH "*ELSET, ELSET=a, GENERATE\n-3, 100, 3\n" SOFT, LAR_ERROR_FORMAT, 30,
            "the file defines no element of this range");
    refused(MESH "*NSET, NSET=a, GENERAT\n9, 12, 1\n" SOFT, LAR_ERROR_UNSUPPORTED, 29,
            "the parameter GENERAT of *NSET is not read and could change the answer");
    refused(MESH SOFT "*NSET, NSET=a\n*BOUNDARY\na, 1\n", LAR_ERROR_FORMAT, AFTER_SOFT + 2,
            "the set 'a' has nothing of the hexahedra; fill it or remove the line");
    refused(MESH SOFT "*NSET, NSET=a\n99\n*BOUNDARY\na, 1\n", LAR_ERROR_FORMAT, AFTER_SOFT + 3,
            "the set 'a' has nothing");
    refused(MESH SOFT "*SURFACE, NAME=a\n" DYNAMIC "*DSLOAD\na, P, 1\n" END, LAR_ERROR_FORMAT,
            AFTER_SOFT + 5, "the set 'a' has nothing");
}

/* ---- steps --------------------------------------------------------------------------------- */

static void test_what_goes_on_from_elsewhere(void **state) {
    (void)state;
    refused(MESH SOFT "*RESTART, READ, STEP=1\n" STATIC END, LAR_ERROR_UNSUPPORTED, AFTER_SOFT,
            "*RESTART, READ goes on from the results of another run");
    refused("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n"
            "7, 1, 1, 1\n8, 0, 1, 1\n*ELEMENT, TYPE=C3D8RP\n1, 1, 2, 3, 4, 5, 6, 7, 8\n" STATIC END,
            LAR_ERROR_UNSUPPORTED, 10, "elements of type 'C3D8RP' compute more than displacements");
    lar_model *model = read_deck(MESH SOFT "*STEP, NLGEOM\n*STATIC, STABILIZE=0.01\n" END);
    assert_int_equal(notices_with(model, "STABILIZE, a damping, was left out"), 1);
    lar_model_destroy(model);
}

static void test_steps(void **state) {
    (void)state;
    lar_model *model =
        read_deck("*HEADING\nA bar of\ntwo cubes\n" MESH SOFT
                  "*RESTART, WRITE\n*STEP\nwords\n*DYNAMIC, DIRECT\n*NODE PRINT, "
                  "NSET=ALL\nU, V\n*EL FILE\nS\n*NODE PRINT, NSET=wall, TOTALS=ONLY\nRF,"
                  "\nU, rf\n*NODE PRINT\nU\n*NODE PRINT, NSET=nobody\nU\n"
                  "*BULK VISCOSITY\n0.06\n" END);
    assert_string_equal(model->title, "A bar of");
    assert_true(model->duration == 1);
    assert_int_equal(notices_with(model, "deck.inp:39: the step has no NLGEOM"), 1);
    assert_int_equal(notices_with(model, "*BULK VISCOSITY was left out"), 1);
    assert_int_equal(notices_with(model, "deck.inp:42: requests for results, *NODE PRINT here"), 1);
    assert_int_equal(notices_with(model, "requests for results"), 1);
    /* U and RF of a set are probes */
    const lar_output *output = &model->output;
    assert_int_equal(output->probe_count, 3);
    assert_string_equal(output->probe[0].name, "ALL");
    assert_int_equal(output->probe[0].nodes.count, 12);
    assert_int_equal(output->probe[0].what, LAR_PROBE_DISPLACEMENT);
    assert_string_equal(output->probe[1].name, "Wall reaction");
    assert_int_equal(output->probe[1].what, LAR_PROBE_REACTION);
    assert_int_equal(output->probe[1].nodes.node[3], 7);
    assert_string_equal(output->probe[2].name, "Wall");
    lar_model_destroy(model);
    const int line = AFTER_SOFT;
    refused(MESH SOFT STATIC END STATIC END, LAR_ERROR_UNSUPPORTED, line + 4, "a second *STEP");
    refused(MESH SOFT STATIC STATIC END, LAR_ERROR_FORMAT, line + 3, "within the step of line 35");
    refused(MESH SOFT STATIC, LAR_ERROR_FORMAT, line, "*STEP has no *END STEP");
    refused(MESH SOFT END, LAR_ERROR_FORMAT, line, "without a *STEP");
    refused(MESH SOFT "*STEP\n" END, LAR_ERROR_FORMAT, line, "the step has no procedure");
    refused(MESH SOFT "*STEP\n*STATIC\n*DYNAMIC\n" END, LAR_ERROR_FORMAT, line + 2, "second proc");
    refused(MESH SOFT "*STATIC\n", LAR_ERROR_FORMAT, line, "outside of a step");
    refused(MESH SOFT "*STEP\n*FREQUENCY\n10\n" END, LAR_ERROR_UNSUPPORTED, line + 1, "*FREQUENCY");
    refused(MESH SOFT "*STEP, PERTURBATION\n*STATIC\n" END, LAR_ERROR_UNSUPPORTED, line,
            "PERTURBATION");
    refused(MESH SOFT "*STEP\n*STATIC, RIKS\n" END, LAR_ERROR_UNSUPPORTED, line + 1, "RIKS");
    refused(MESH SOFT "*STEP\n*DYNAMIC\n0.1, -2\n" END, LAR_ERROR_MODEL, line + 2, "period is -2");
    refused(MESH SOFT "*INCLUDE, INPUT=x.inp\n", LAR_ERROR_UNSUPPORTED, line, "copy the included");
}

/* As Abaqus/CAE writes them: one part, one instance, names with the instance before a dot. */
static void test_parts(void **state) {
    (void)state;
    lar_model *model = read_deck(
        "*Heading\n** Job name: Job-1\n*Preprint, echo=NO\n*Part, name=P\n" MESH
        "** Section: S\n*Solid Section, elset=BOTH, material=Soft\n,\n*End Part\n"
        "*Assembly, name=Assembly\n*Instance, name=P-1, part=P\n*End Instance\n"
        "*Nset, nset=Set-1, instance=P-1\n 9, 10\n*End Assembly\n"
        "*Material, name=Soft\n*Density\n1000.,\n*Hyperelastic, neo hooke\n500., 0.0001\n"
        "*Boundary\nP-1.Wall, ENCASTRE\n*Step, name=Step-1, nlgeom=YES\n*Static\n0.1, 1., 1e-05, "
        "1.\n*Cload\nSet-1, 2, 3.\nP-1.12, 1, 1.\n*Output, field, variable=PRESELECT\n*End Step\n");
    assert_int_equal(fixed(model, 8), LAR_AXIS_ALL);
    assert_int_equal(model->load_count, 2);
    assert_int_equal(model->notice_count, 2); /* static, results */
    lar_model_destroy(model);
}

#define CAE(part, assembly, step)                                                                  \
    "*Part, name=P\n" MESH "*Nset, nset=Set-1, generate\n1, 12, 1\n*Elset, elset=Set-1\n1, 2\n"    \
    "*Surface, type=ELEMENT, name=Surf-1\n1, S1\n*Solid Section, elset=Set-1, "                    \
    "material=Soft\n,\n" part                                                                      \
    "*End Part\n*Assembly, name=A\n*Instance, name=P-1, part=P\n*End Instance\n" assembly          \
    "*End Assembly\n*Material, name=Soft\n*Density\n1000.,\n*Hyperelastic, neo hooke\n"            \
    "500., 0.0001\n*Step, nlgeom=YES\n*Dynamic\n0.1, 1.\n" step "*End Step\n"
#define SETS                                                                                       \
    "*Nset, nset=Set-1, instance=P-1\n1, 4, 5, 8\n*Elset, elset=Set-1, instance=P-1\n2,\n"         \
    "*Elset, elset=_S, internal, instance=P-1\n2,\n*Surface, type=ELEMENT, name=Surf-1\n_S, S4\n"

/* Abaqus/CAE calls the first set of the part and the first of the assembly Set-1. */
static void test_same_name_in_part_and_assembly(void **state) {
    (void)state;
    lar_model *model =
        read_deck(CAE("", SETS,
                      "*Boundary\nSET-1, ENCASTRE\n*Dload\nSet-1, P4, 3\n*Dload\n"
                      "P-1.Set-1, P1, 5\n*Dsload\nSurf-1, P, 7\np-1.surf-1, P, 9\n"));
    assert_int_equal(fixed(model, 1), LAR_AXIS_ALL);
    assert_int_equal(fixed(model, 9), 0);
    assert_int_equal(model->element_material[0], 0); /* the section means the part's */
    assert_int_equal(model->pressure_count, 4);
    for (int i = 0; i < 4; i++) {
        const lar_pressure_load *load = &model->pressure[i];
        assert_int_equal(load->count, load->pressure == 5 ? 2 : 1);
        if (load->pressure == 3 || load->pressure == 7) assert_int_equal(load->face[0], 6 + 1);
        if (load->pressure == 9) assert_int_equal(load->face[0], 4);
    }
    lar_model_destroy(model);
    model = read_deck(CAE("", SETS, "*Boundary\nP-1.Set-1, 1\n"));
    assert_int_equal(fixed(model, 9), LAR_AXIS_X);
    lar_model_destroy(model);
    /* what only the part has needs no prefix */
    model = read_deck(CAE("", SETS, "*Boundary\nWall, 1\nP-1.Tip, 2\n"));
    assert_int_equal(fixed(model, 1), LAR_AXIS_X);
    assert_int_equal(fixed(model, 9), LAR_AXIS_Y);
    lar_model_destroy(model);
    refused(CAE("", "*Node\n1, 7, 7, 7\n*Nset, nset=RP\n1\n", "*Boundary\n1, 1\n"),
            LAR_ERROR_FORMAT, 56, "there is no node 1 that belongs to a hexahedron");
    refused(CAE("", "*Node\n1, 7, 7, 7\n*Nset, nset=RP\n1\n", "*Boundary\nRP, 1\n"),
            LAR_ERROR_FORMAT, 56, "the set 'RP' has nothing of the hexahedra");
}

/* A section of what is no hexahedron is refused where that stands, also among hexahedra. */
static void test_sections_of_hexahedra(void **state) {
    (void)state;
    refused(MESH "*ELEMENT, TYPE=T3D2, ELSET=LEFT\n7, 1, 2\n" SOFT, LAR_ERROR_UNSUPPORTED, 30,
            "element 7 is of type T3D2, and a *SOLID SECTION gives it a material; Lariat computes "
            "with eight-node hexahedra, take it out of the set 'BOTH'");
    lar_model *model = read_deck(MESH "*ELEMENT, TYPE=T3D2, ELSET=BAR\n7, 1, 2\n" SOFT);
    assert_int_equal(model->mesh.element_count, 2);
    lar_model_destroy(model);
    refused(MESH "*MATERIAL, NAME=a\n*ELASTIC\n1, 0.3\n*DENSITY\n1\n"
                 "*SOLID SECTION, ELSET=LEFT, MATERIAL=a\n",
            LAR_ERROR_MODEL, 18, "element 2 has no material");
}

static bool is_deck(const char *text) {
    lar_bytes bytes = {(unsigned char *)(uintptr_t)text, strlen(text)};
    return lar_inp_is_deck(&bytes);
}

static void test_is_deck(void **state) {
    (void)state;
    assert_false(is_deck(MESH));
    assert_false(is_deck("*Heading\nx\n" MESH "*SOLID SECTION, ELSET=LEFT, MATERIAL=Steel\n"));
    assert_true(is_deck(MESH SOFT));
    assert_true(is_deck(MESH "*boundary\nWALL, 1\n"));
    assert_true(is_deck(MESH "*End  Step"));
    assert_false(is_deck(MESH "** *BOUNDARY\n*"));
}

/* Cut off anywhere, or with a byte changed: read or refused, never more. */
static void test_damage(void **state) {
    (void)state;
    static const char deck[] =
        TWO "*BOUNDARY\n1, 1, 3\n*AMPLITUDE, NAME=a\n0,0,1,1\n*INITIAL CONDITIONS, "
            "TYPE=VELOCITY\n1, 1, 1\n*CONTACT PAIR\nUnder, Top\n" STATIC
            "*BOUNDARY, AMPLITUDE=a\n2, 1, 2, 1\n*CLOAD\n5, 1, 1\n*DLOAD\n1, P1, 2\n, GRAV, 1, 0, "
            "0, 1\n*DSLOAD\nTop, P, 1\n" END;
    static char text[sizeof deck];
    static const char bad[] = {'*', ',', '9', '-', ' ', 'x', '\n', '=', (char)0xff};
    for (size_t i = 0; i < sizeof deck; i++)
        for (size_t k = 0; k <= sizeof bad; k++) {
            lar_model *model = NULL;
            lar_error error;
            memcpy(text, deck, sizeof deck);
            text[i] = k < sizeof bad ? bad[k] : '\0';
            if (i + 1 == sizeof deck) text[i] = '\0';
            if (parse(text, &model, &error))
                assert_true(strncmp(error.message, "deck.inp", 8) == 0);
            else
                lar_model_destroy(model);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_supports),
        cmocka_unit_test(test_bad_supports),
        cmocka_unit_test(test_displaced_over_the_step),
        cmocka_unit_test(test_pressure_twice),
        cmocka_unit_test(test_ranges),
        cmocka_unit_test(test_loads),
        cmocka_unit_test(test_left_handed),
        cmocka_unit_test(test_bad_loads),
        cmocka_unit_test(test_initial_velocity),
        cmocka_unit_test(test_contact),
        cmocka_unit_test(test_friction),
        cmocka_unit_test(test_what_goes_on_from_elsewhere),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_parts),
        cmocka_unit_test(test_forces_on_supports),
        cmocka_unit_test(test_same_name_in_part_and_assembly),
        cmocka_unit_test(test_sections_of_hexahedra),
        cmocka_unit_test(test_is_deck),
        cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
