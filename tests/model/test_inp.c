#include "mesh_test.h"

/* Two cubes side by side along x with everything that is read. Node 13 belongs to no element,
 * elements 20 to 22 have no volume. */
static const char *const flat = "** a comment\n"
                                "*HEADING\n"
                                "Two hexahedra\n"
                                "*Node, nset=All\n"
                                "1, 0, 0, 0\n"
                                "2, 1, , 0.\n"
                                "3, 1, 1\n"
                                "4, 0, 1.0D0, 0\n"
                                "  5, 0, 0, 1e0\r\n"
                                "6, 1, 0, 1\n"
                                "\n"
                                "7, 1, 1, 1\n"
                                "8, 0, 1, 1\n"
                                "9, 2, 0, 0\n"
                                "10, 2, 1, 0\n"
                                "11, 2, 0, 1\n"
                                "12, 2, 1, 1\n"
                                "13, 7, 7, 7\n"
                                "*ELEMENT, TYPE=C3D8R, ELSET=Near\n"
                                "7, 1, 2, 3,\n"
                                "** in between\n"
                                "4, 5, 6, 7, 8\n"
                                "*ELEMENT, ELSET=Far,\n"
                                "TYPE=C3D8RH\n"
                                "8, 2, 9, 10, 3, 6, 11, 12, 7,\n"
                                "*ELEMENT, TYPE=CPS4, ELSET=End\n"
                                "20, 9, 10, 12, 11\n"
                                "*ELEMENT, TYPE=T3D2, ELSET=End\n"
                                "21, 9, 10\n"
                                "*ELEMENT, TYPE=S3\n"
                                "22, 1, 2, 3\n"
                                "*NSET, NSET=wall\n"
                                "1, 4, 5,\n"
                                "8\n"
                                "*NSET, NSET=\"both ends\"\n"
                                "WALL, 9, 13, wall\n"
                                "*NSET, NSET=row, GENERATE\n"
                                "2, 10, 4\n"
                                "1, 1\n"
                                "*ELSET, ELSET=everything\n"
                                "far, NEAR\n"
                                "*ELSET, ELSET=range, GENERATE\n"
                                "1, 100\n"
                                "*SURFACE, NAME=sides, TYPE=ELEMENT\n"
                                "7, S1\n"
                                "near, s2\n"
                                "Everything, S3\n"
                                "8, S4\n"
                                "8, S5\n"
                                "7, S6\n"
                                "END, SPOS\n"
                                "*SURFACE, NAME=touch, TYPE=NODE\n"
                                "WALL\n"
                                "2\n"
                                "*MATERIAL, NAME=soft\n"
                                "*ELASTIC\n"
                                "20000., 0.45\n"
                                "*STEP\n"
                                "*NODE PRINT, NSET=wall\n"
                                "U\n"
                                "*END STEP\n";

static void reads_everything(void **state) {
    (void)state;
    char *without_line = with(flat, "END, SPOS", "20, SPOS");
    lar_mesh mesh = parse_good(lar_inp_parse, "flat.inp", without_line, strlen(without_line));
    free(without_line);
    assert_int_equal(mesh.node_count, 12);
    assert_int_equal(mesh.dropped_node_count, 1);
    assert_int_equal(mesh.element_count, 2);
    assert_true(mesh_volume(&mesh) == 2);
    assert_int_equal(mesh.element_id[0], 7);
    assert_int_equal(mesh.element_id[1], 8);
    assert_int_equal(mesh.element_tag[0], 1);
    assert_int_equal(mesh.element_tag[1], 2);
    assert_int_equal(mesh.set_count, 14);
    ASSERT_SET(&mesh, "All", LAR_SET_NODES, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11);
    ASSERT_SET(&mesh, "wall", LAR_SET_NODES, 0, 3, 4, 7);
    ASSERT_SET(&mesh, "both ends", LAR_SET_NODES, 0, 3, 4, 7, 8);
    ASSERT_SET(&mesh, "row", LAR_SET_NODES, 0, 1, 5, 9);
    ASSERT_SET(&mesh, "touch", LAR_SET_NODES, 0, 1, 3, 4, 7);
    ASSERT_SET(&mesh, "Near", LAR_SET_ELEMENTS, 0);
    ASSERT_SET(&mesh, "Far", LAR_SET_ELEMENTS, 1);
    ASSERT_SET(&mesh, "everything", LAR_SET_ELEMENTS, 0, 1);
    ASSERT_SET(&mesh, "range", LAR_SET_ELEMENTS, 0, 1);
    /* The range of ids also takes in the face 20. */
    ASSERT_SET(&mesh, "range", LAR_SET_FACES, 6 + 1);
    ASSERT_SET(&mesh, "sides", LAR_SET_FACES, 4, 5, 8, 2, 7, 9, 0);
    ASSERT_SET(&mesh, "End", LAR_SET_FACES, 6 + 1);
    ASSERT_SET(&mesh, "End", LAR_SET_NODES, 8, 9, 10, 11);
    lar_mesh_clear(&mesh);
}

/* Abaqus S1 = nodes 1-2-3-4, S2 = 5-8-7-6, S3 = 1-5-6-2, S4 = 2-6-7-3, S5 = 3-7-8-4,
 * S6 = 4-8-5-1: the nodes of our faces must be those. */
static void faces_are_those_of_abaqus(void **state) {
    (void)state;
    static const int abaqus[6][4] = {{1, 2, 3, 4}, {5, 8, 7, 6}, {1, 5, 6, 2},
                                     {2, 6, 7, 3}, {3, 7, 8, 4}, {4, 8, 5, 1}};
    for (int s = 0; s < 6; s++) {
        char line[64];
        snprintf(line, sizeof line, "7, S%d\n*NODE PRINT\n", s + 1);
        char *one =
            with(flat, "7, S1\nnear, s2\nEverything, S3\n8, S4\n8, S5\n7, S6\nEND, SPOS\n", line);
        lar_mesh mesh = parse_good(lar_inp_parse, "flat.inp", one, strlen(one));
        const lar_set *set = lar_mesh_find_set(&mesh, "sides", LAR_SET_FACES);
        assert_non_null(set);
        assert_int_equal(set->count, 1);
        int expected = 0, got = 0;
        for (int a = 0; a < 4; a++) {
            expected |= 1 << (abaqus[s][a] - 1);
            got |= 1 << lar_face_node[set->index[0]][a];
        }
        assert_int_equal(got, expected);
        lar_mesh_clear(&mesh);
        free(one);
    }
}

static void reads_part(void **state) {
    (void)state;
    char *part = with(flat, "*Node, nset=All", "*Part, name=P\n*NODE");
    char *whole = with(part, "END, SPOS\n",
                       "*End Part\n*Assembly, name=A\n*Instance, name=P-1, part=P\n"
                       "*End Instance\n*Nset, nset=base, instance=P-1\n1, 4\n*End Assembly\n");
    lar_mesh mesh = parse_good(lar_inp_parse, "part.inp", whole, strlen(whole));
    ASSERT_SET(&mesh, "base", LAR_SET_NODES, 0, 3);
    ASSERT_SET(&mesh, "sides", LAR_SET_FACES, 4, 5, 8, 2, 7, 9, 0);
    lar_mesh_clear(&mesh);
    free(part);
    free(whole);
}

/* Cubes over each other, as Abaqus/CAE writes them: it calls the first set Set-1 in the part and in
 * the assembly. */
#define PART                                                                                       \
    "*Heading\n*Part, name=P\n*Node\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n"             \
    "5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n9, 0, 0, 2\n10, 1, 0, 2\n11, 1, 1, 2\n"       \
    "12, 0, 1, 2\n*Element, type=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"                                \
    "2, 5, 6, 7, 8, 9, 10, 11, 12\n*Nset, nset=Set-1, generate\n1, 12, 1\n"                        \
    "*Elset, elset=Set-1, generate\n1, 2, 1\n*Elset, elset=Top\n2\n"                               \
    "*Surface, type=ELEMENT, name=Skin\n1, S1\n*End Part\n*Assembly, name=A\n"
#define INSTANCE "*Instance, name=P-1, part=P\n0., 0, 0.0\n*End Instance\n"

static lar_mesh parse_whole(const char *text) {
    return parse_good(lar_inp_parse, "cae.inp", text, strlen(text));
}

static void parts_and_assemblies_have_sets_of_their_own(void **state) {
    (void)state;
    lar_mesh mesh = parse_whole(
        PART INSTANCE "*Nset, nset=SET-1, instance=P-1, generate\n1, 4, 1\n"
                      "*Elset, elset=_Skin_S2, instance=P-1\n1\n"
                      "*Surface, type=ELEMENT, name=Skin\n_Skin_S2, S2\n"
                      "*Elset, elset=both, instance=P-1\nSet-1\n*Nset, nset=all\nP-1.Set-1\n"
                      "*Nset, nset=mine\nSet-1, 12\n*Nset, nset=up, elset=P-1.Top\n"
                      "*End Assembly\n");
    ASSERT_SET(&mesh, "SET-1", LAR_SET_NODES, 0, 1, 2, 3);
    ASSERT_SET(&mesh, "P-1.Set-1", LAR_SET_NODES, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11);
    ASSERT_SET(&mesh, "Set-1", LAR_SET_ELEMENTS, 0, 1); /* the assembly has none of that name */
    ASSERT_SET(&mesh, "Skin", LAR_SET_FACES, 5);
    ASSERT_SET(&mesh, "P-1.Skin", LAR_SET_FACES, 4);
    ASSERT_SET(&mesh, "both", LAR_SET_ELEMENTS, 0, 1);
    ASSERT_SET(&mesh, "all", LAR_SET_NODES, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11);
    ASSERT_SET(&mesh, "mine", LAR_SET_NODES, 0, 1, 2, 3, 11);
    ASSERT_SET(&mesh, "up", LAR_SET_NODES, 4, 5, 6, 7, 8, 9, 10, 11);
    lar_mesh_clear(&mesh);
}

/* Reference points are nodes of the assembly, numbered from 1 like those of the part. */
static void reference_points_are_left_out(void **state) {
    (void)state;
    lar_mesh mesh = parse_whole(
        PART INSTANCE "*Node, nset=Points\n1, 5, 5, 5\n2, 6, 6, 6\n*Nset, nset=RP\n1\n"
                      "*Nset, nset=RPs, generate\n1, 2, 1\n*Nset, nset=base, instance=P-1\n1, 2\n"
                      "*Nset, nset=some\n2, 3\n*End Assembly\n");
    assert_int_equal(mesh.node_count, 12);
    assert_int_equal(lar_mesh_find_set(&mesh, "Points", LAR_SET_NODES)->count, 0);
    assert_int_equal(lar_mesh_find_set(&mesh, "RP", LAR_SET_NODES)->count, 0);
    assert_int_equal(lar_mesh_find_set(&mesh, "RPs", LAR_SET_NODES)->count, 0);
    ASSERT_SET(&mesh, "base", LAR_SET_NODES, 0, 1);
    ASSERT_SET(&mesh, "some", LAR_SET_NODES, 2);
    lar_mesh_clear(&mesh);
}

static void nodes_of_elements(void **state) {
    (void)state;
    char *good = with(flat, "END, SPOS", "20, SPOS");
    char *more = with(good, "*NSET, NSET=wall\n",
                      "*NSET, NSET=far, ELSET=FAR\n12\n"
                      "*NSET, NSET=farther\nfar, 1\n"
                      "*NSET, NSET=face, ELSET=End\n"
                      "*NSET, NSET=wall\n");
    lar_mesh mesh = parse_whole(more);
    ASSERT_SET(&mesh, "far", LAR_SET_NODES, 1, 2, 5, 6, 8, 9, 10, 11);
    ASSERT_SET(&mesh, "farther", LAR_SET_NODES, 0, 1, 2, 5, 6, 8, 9, 10, 11);
    ASSERT_SET(&mesh, "face", LAR_SET_NODES, 8, 9, 10, 11);
    lar_mesh_clear(&mesh);
    free(good);
    free(more);
}

/* A byte order mark, and line ends of other systems. */
static void beginnings_and_ends(void **state) {
    (void)state;
    lar_mesh mesh = parse_whole("\xef\xbb\xbf" PART INSTANCE "*End Assembly\n");
    assert_int_equal(mesh.element_count, 2);
    lar_mesh_clear(&mesh);
    char text[] = PART INSTANCE "*End Assembly\n";
    for (char *c = text; *c; c++)
        if (*c == '\n') *c = '\r';
    ASSERT_TEXT_REFUSED(lar_inp_parse, "bad.inp", text, LAR_ERROR_FORMAT,
                        "bad.inp: its lines end with CR alone");
}

/* ---- what is refused ---------------------------------------------------------------------- */

#define REFUSED(text, status, ...)                                                                 \
    ASSERT_TEXT_REFUSED(lar_inp_parse, "bad.inp", text, status, __VA_ARGS__)

static void refused_with(const char *old, const char *fresh, lar_status status, const char *part) {
    char *good = with(flat, "END, SPOS", "20");
    char *changed = with(good, old, fresh);
    REFUSED(changed, status, part, "bad.inp");
    free(good);
    free(changed);
}

static void refuses_damage(void **state) {
    (void)state;
    const lar_status format = LAR_ERROR_FORMAT;
    REFUSED("", LAR_ERROR_MODEL, "bad.inp: holds no eight-node hexahedra");
    REFUSED("\x89PNG\n", format,
            "bad.inp:1: expected a keyword line (such as *NODE), found '?PNG'");
    refused_with("9, 2, 0, 0\n", "9, 2, zero, 0\n", format,
                 "bad.inp:14: expected a coordinate, found 'zero'");
    refused_with("9, 2, 0, 0\n", "9, 2, nan, 0\n", format,
                 "bad.inp:14: node 9 has the y coordinate nan");
    refused_with("9, 2, 0, 0\n", "x, 2, 0, 0\n", format, "bad.inp:14: expected a node id");
    refused_with("9, 2, 0, 0\n", "8, 2, 0, 0\n", format,
                 "bad.inp:14: node 8 is given twice (first in line 13)");
    refused_with("10, 3, 6, 11", "10, 3, 6, 99", format,
                 "bad.inp:25: element 8 names node 99, which the file does not define");
    refused_with("10, 3, 6, 11, 12, 7,", "10, 3, 6, 11", format,
                 "bad.inp:25: element 8 has 6 nodes where its type needs 8");
    refused_with("10, 3, 6, 11, 12, 7,", "10, 3, 6, 11, 12, 7, 1", format,
                 "bad.inp:25: element 8 has more than the 8 nodes");
    refused_with("8, 2, 9, 10", "7, 2, 9, 10", format,
                 "bad.inp:25: element 7 is given twice (first in line 20)");
    refused_with("20, 9, 10, 12, 11", "8, 9, 10, 12, 11", format,
                 "bad.inp:27: element 8 is given twice");
    refused_with("20, 9, 10, 12, 11", "20, 9, 10, 12, 1", format,
                 "the quadrilateral 9 10 12 1 of set");
    refused_with("WALL, 9, 13", "WALL, 9, 14", format, "bad.inp:36: set 'both ends' names node 14");
    refused_with("WALL, 9, 13", "floor, 9, 13", format,
                 "bad.inp:36: 'floor' is neither a number nor a node set defined above");
    refused_with("2, 10, 4", "10, 2, 4", format,
                 "bad.inp:38: expected an ascending range after GENERATE");
    refused_with("2, 10, 4", "2, 10, 0", format, "bad.inp:38: expected an ascending range");
    refused_with("7, S1", "7, S7", format, "bad.inp:45: expected a face S1 to S6");
    refused_with("7, S1", "77, S1", format, "bad.inp:45: set 'sides' names element 77");
    refused_with("7, S1", "none, S1", format, "bad.inp:45: 'none' is neither a number nor an");
    refused_with("*NSET, NSET=wall", "*NSET", format, "bad.inp:32: the set has no name");
    refused_with("TYPE=C3D8R, ", "", format, "bad.inp:19: *ELEMENT has no TYPE");
    refused_with("7, 1, 2, 3,", "7, 1, 2, 2,", LAR_ERROR_MODEL,
                 "bad.inp:20: element 7 has node 2 twice");
    refused_with("7, 1, 2, 3,", "7, 2, 1, 3,", LAR_ERROR_MODEL,
                 "bad.inp:20: element 7 is inverted");
}

static void refuses_unsupported(void **state) {
    (void)state;
    const lar_status unsupported = LAR_ERROR_UNSUPPORTED;
    static const char *const types[] = {"C3D27", "C3D20R", "CPE", "SC8R", "B31", "DC3D8", "S4R5"};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        char part[100];
        snprintf(part, sizeof part, "bad.inp:26: elements of type '%s' are not read", types[i]);
        refused_with("CPS4", types[i], unsupported, part);
    }
    refused_with("CPS4", "C3D4", unsupported,
                 "bad.inp:27: element 20 is a four-node tetrahedron, but Lariat computes with "
                 "eight-node hexahedra; make them of the mesh's boundary and regions: lariat mesh "
                 "bad.inp");
    refused_with("*HEADING\n", "*Include, Input=nodes.inp\n", unsupported,
                 "bad.inp:2: *Include is not read here; copy the included file into this one");
    refused_with("*Node, nset=All", "*NODE, INPUT=n.txt", unsupported,
                 "bad.inp:4: *NODE is not read with INPUT=; copy the nodes");
    refused_with("*Node, nset=All", "*NODE, SYSTEM=C", unsupported, "rectangular coordinates");
    refused_with("*HEADING\n", "*NGEN\n", unsupported, "bad.inp:2: *NGEN is not read here");
    refused_with("*STEP\n", "*PART, NAME=A\n*PART, NAME=B\n", unsupported, "join the parts");
    refused_with("*STEP\n", "*INSTANCE, NAME=A\n1, 0, 0\n", unsupported, "move the nodes");
    refused_with("NAME=sides, TYPE=ELEMENT", "NAME=sides, TYPE=CYLINDER", unsupported,
                 "bad.inp:44: only surfaces with TYPE=ELEMENT or TYPE=NODE");
    refused_with("*STEP\n", "*INSTANCE, NAME=A\n0, 0, 0\n0, 0, 0, 0, 0, 1, 90\n", unsupported,
                 "move the nodes");
    refused_with("NSET=wall\n", "NSET=wall, ELSET=no\n", LAR_ERROR_FORMAT,
                 "bad.inp:32: 'no' is neither a number nor an element set defined above");
}

/* Sets that double with every line: fifty lines would ask for 2^50 entries. */
static void refuses_explosion(void **state) {
    (void)state;
    char text[4000] = "*NODE, NSET=s0\n1,0,0,0\n";
    for (int s = 1; s <= 50; s++) {
        char line[64];
        snprintf(line, sizeof line, "*NSET, NSET=s%d\ns%d, s%d\n", s, s - 1, s - 1);
        strcat(text, line);
    }
    REFUSED(text, LAR_ERROR_UNSUPPORTED, "repeat the same nodes or elements more often");
}

/* A range costs as much as the nodes that exist, not as many as it spans. */
static void range_of_billions(void **state) {
    (void)state;
    char *wide = with(flat, "2, 10, 4\n", "-9223372036854775807, 9223372036854775807, 3\n");
    char *whole = with(wide, "END, SPOS\n", "");
    lar_mesh mesh = parse_good(lar_inp_parse, "wide.inp", whole, strlen(whole));
    /* -(2^63 - 1) leaves the remainder 2 when divided by 3. */
    ASSERT_SET(&mesh, "row", LAR_SET_NODES, 0, 1, 4, 7, 10);
    lar_mesh_clear(&mesh);
    free(wide);
    free(whole);
}

static void long_keyword_line(void **state) {
    (void)state;
    char text[3000] = "*NODE, NSET=";
    memset(text + 12, 'a', 2000);
    REFUSED(text, LAR_ERROR_FORMAT, "bad.inp:1: the keyword line is longer");
}

static void every_prefix(void **state) {
    (void)state;
    sweep_prefixes(lar_inp_parse, "cut.inp", flat, strlen(flat));
}

/* ---- a file of others --------------------------------------------------------------------- */

static void shared_letter(void **state) {
    (void)state;
    const char *path = LAR_TEST_SHARED "/data/bench/automesh/letter_f_3d.inp";
    need_shared(path);
    lar_mesh mesh = {0};
    lar_error error;
    if (lar_mesh_read(path, 0.001, &mesh, &error)) fail_msg("%s", error.message);
    assert_int_equal(mesh.node_count, 102);
    assert_int_equal(mesh.element_count, 39);
    assert_int_equal(lar_mesh_find_set(&mesh, "ALLNODES", LAR_SET_NODES)->count, 102);
    assert_int_equal(lar_mesh_find_set(&mesh, "EB1", LAR_SET_ELEMENTS)->count, 39);
    double volume = mesh_volume(&mesh);
    assert_true(volume > 38.999999e-9 && volume < 39.000001e-9);
    lar_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_everything),
        cmocka_unit_test(faces_are_those_of_abaqus),
        cmocka_unit_test(reads_part),
        cmocka_unit_test(refuses_damage),
        cmocka_unit_test(refuses_unsupported),
        cmocka_unit_test(refuses_explosion),
        cmocka_unit_test(range_of_billions),
        cmocka_unit_test(long_keyword_line),
        cmocka_unit_test(every_prefix),
        cmocka_unit_test(shared_letter),
        cmocka_unit_test(parts_and_assemblies_have_sets_of_their_own),
        cmocka_unit_test(reference_points_are_left_out),
        cmocka_unit_test(nodes_of_elements),
        cmocka_unit_test(beginnings_and_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
