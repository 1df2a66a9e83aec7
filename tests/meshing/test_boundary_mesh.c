/* The boundary of meshes of any solids: regions, names and volumes, from every format. */
#include "testing.h"

#include "meshing/boundary/boundary.h"

enum { SIDE = 4 }; /* cubes along an axis, of 10 mm */

static lar_error error;

/* How each cube is cut, by corners in the order of a hexahedron and 8 for its middle. */
typedef struct cut {
    int corners, count;
    int solid[6][8];
} cut;

static const cut HEXAHEDRA = {8, 1, {{0, 1, 2, 3, 4, 5, 6, 7}}};
static const cut TETRAHEDRA = {
    4, 6, {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};
static const cut PRISMS = {6, 2, {{0, 1, 2, 4, 5, 6}, {0, 2, 3, 4, 6, 7}}};
static const cut PYRAMIDS = {5,
                             6,
                             {{0, 1, 2, 3, 8},
                              {4, 7, 6, 5, 8},
                              {0, 4, 5, 1, 8},
                              {1, 5, 6, 2, 8},
                              {2, 6, 7, 3, 8},
                              {3, 7, 4, 0, 8}}};

typedef struct grid {
    const cut *cut;
    bool doubled;  /* the halves have nodes of their own */
    bool mirrored; /* x the other way round */
    bool nameless; /* without tags and sets */
} grid;

/* Node numbers from 1: corners of one half, those of the other, middles. */
static int node_at(const grid *g, const int at[3], int corner) {
    const int across = SIDE + 1, all = across * across * across;
    if (corner == 8) return 1 + 2 * all + at[0] + SIDE * (at[1] + SIDE * at[2]);
    int x = at[0] + (corner % 4 == 1 || corner % 4 == 2), y = at[1] + (corner % 4 >= 2);
    int half = g->doubled && at[0] >= SIDE / 2;
    return 1 + half * all + x + across * (y + across * (at[2] + corner / 4));
}

/* tell(file, number, x, y, z) for every node. */
typedef void tell_node(FILE *file, int number, const double x[3]);

static int each_node(const grid *g, FILE *file, tell_node *tell) {
    int number = 0;
    for (int part = 0; part < 3; part++) {
        const int across = part < 2 ? SIDE + 1 : SIDE;
        for (int i = 0; i < across * across * across; i++) {
            const int at[3] = {i % across, i / across % across, i / across / across};
            double x[3];
            for (int a = 0; a < 3; a++) x[a] = 0.01 * (at[a] + (part == 2 ? 0.5 : 0));
            if (g->mirrored) x[0] = -x[0];
            if (tell) tell(file, number + 1, x);
            number++;
        }
    }
    return number;
}

/* tell(file, number, region, corners, nodes) for every solid of a half, 1 or 2, or of both, 0. */
typedef void tell_solid(FILE *file, int number, int half, int corners, const int *node);

static int each_solid(const grid *g, int wanted, FILE *file, tell_solid *tell) {
    int number = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        const int half = at[0] < SIDE / 2 ? 1 : 2;
        for (int s = 0; s < g->cut->count; s++) {
            int node[8] = {0};
            for (int c = 0; c < g->cut->corners; c++) node[c] = node_at(g, at, g->cut->solid[s][c]);
            number++;
            if (tell && (!wanted || half == wanted))
                tell(file, number, g->nameless ? 0 : half, g->cut->corners, node);
        }
    }
    return number;
}

/* ---- the formats ---------------------------------------------------------------------------- */

static void msh_node(FILE *file, int number, const double x[3]) {
    fprintf(file, "%d %.9g %.9g %.9g\n", number, x[0], x[1], x[2]);
}

static void msh_solid(FILE *file, int number, int half, int corners, const int *node) {
    static const int TYPE[9] = {[4] = 4, [5] = 7, [6] = 6, [8] = 5};
    fprintf(file, "%d %d 2 %d %d", number, TYPE[corners], half, half);
    for (int c = 0; c < corners; c++) fprintf(file, " %d", node[c]);
    fprintf(file, "\n");
}

static void write_msh(const grid *g, FILE *file) {
    fprintf(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
    if (!g->nameless)
        fprintf(file, "$PhysicalNames\n2\n3 1 \"liver\"\n3 2 \"tumour\"\n$EndPhysicalNames\n");
    fprintf(file, "$Nodes\n%d\n", each_node(g, NULL, NULL));
    each_node(g, file, msh_node);
    fprintf(file, "$EndNodes\n$Elements\n%d\n", each_solid(g, 0, NULL, NULL));
    each_solid(g, 0, file, msh_solid);
    fprintf(file, "$EndElements\n");
}

static void comma_node(FILE *file, int number, const double x[3]) {
    fprintf(file, "%d, %.9g, %.9g, %.9g\n", number, x[0], x[1], x[2]);
}

static void comma_solid(FILE *file, int number, int half, int corners, const int *node) {
    (void)half;
    fprintf(file, "%d", number);
    for (int c = 0; c < corners; c++) fprintf(file, ", %d", node[c]);
    fprintf(file, "\n");
}

static void write_inp(const grid *g, FILE *file) {
    static const char *const TYPE[9] = {[4] = "C3D4", [5] = "C3D5", [6] = "C3D6", [8] = "C3D8"};
    fprintf(file, "*NODE\n");
    each_node(g, file, comma_node);
    for (int half = 1; half <= 2; half++) {
        fprintf(file, "*ELEMENT, TYPE=%s%s\n", TYPE[g->cut->corners],
                g->nameless ? ""
                : half == 1 ? ", ELSET=liver"
                            : ", ELSET=tumour");
        each_solid(g, half, file, comma_solid);
    }
}

static void feb_node(FILE *file, int number, const double x[3]) {
    fprintf(file, "<node id=\"%d\">%.9g,%.9g,%.9g</node>\n", number, x[0], x[1], x[2]);
}

static void feb_solid(FILE *file, int number, int half, int corners, const int *node) {
    (void)half;
    fprintf(file, "<elem id=\"%d\">%d", number, node[0]);
    for (int c = 1; c < corners; c++) fprintf(file, ",%d", node[c]);
    fprintf(file, "</elem>\n");
}

static void write_feb(const grid *g, FILE *file) {
    static const char *const TYPE[9] = {[4] = "tet4", [5] = "pyra5", [6] = "penta6", [8] = "hex8"};
    fprintf(file, "<febio_spec version=\"4.0\"><Material>\n");
    for (int m = 1; m <= 2; m++)
        fprintf(file,
                "<material id=\"%d\" name=\"m%d\" type=\"neo-Hookean\"><density>1e3</density>"
                "<E>1e4</E><v>0.45</v></material>\n",
                m, m);
    fprintf(file, "</Material><Mesh><Nodes name=\"all\">\n");
    each_node(g, file, feb_node);
    fprintf(file, "</Nodes>\n");
    for (int half = 1; half <= 2; half++) {
        fprintf(file, "<Elements type=\"%s\" name=\"%s\">\n", TYPE[g->cut->corners],
                half == 1 ? "liver" : "tumour");
        each_solid(g, half, file, feb_solid);
        fprintf(file, "</Elements>\n");
    }
    fprintf(file, "</Mesh><MeshDomains>\n"
                  "<SolidDomain name=\"liver\" mat=\"m1\"/><SolidDomain name=\"tumour\" "
                  "mat=\"m2\"/>\n</MeshDomains></febio_spec>\n");
}

static void plain_node(FILE *file, int number, const double x[3]) {
    (void)number;
    fprintf(file, "%.9g %.9g %.9g\n", x[0], x[1], x[2]);
}

static void vtk_solid(FILE *file, int number, int half, int corners, const int *node) {
    (void)number, (void)half;
    fprintf(file, "%d", corners);
    for (int c = 0; c < corners; c++) fprintf(file, " %d", node[c] - 1);
    fprintf(file, "\n");
}

static void tell_half(FILE *file, int number, int half, int corners, const int *node) {
    (void)number, (void)corners, (void)node;
    fprintf(file, "%d\n", half);
}

static void write_vtk(const grid *g, FILE *file) {
    static const int TYPE[9] = {[4] = 10, [5] = 14, [6] = 13, [8] = 12};
    const int solids = each_solid(g, 0, NULL, NULL);
    fprintf(file, "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n");
    fprintf(file, "POINTS %d double\n", each_node(g, NULL, NULL));
    each_node(g, file, plain_node);
    fprintf(file, "CELLS %d %d\n", solids, solids * (g->cut->corners + 1));
    each_solid(g, 0, file, vtk_solid);
    fprintf(file, "CELL_TYPES %d\n", solids);
    for (int s = 0; s < solids; s++) fprintf(file, "%d\n", TYPE[g->cut->corners]);
    if (g->nameless) return;
    fprintf(file, "CELL_DATA %d\nSCALARS region int 1\nLOOKUP_TABLE default\n", solids);
    each_solid(g, 0, file, tell_half);
}

static const struct {
    const char *path;
    void (*write)(const grid *, FILE *);
    const char *name[2]; /* of the regions */
} FORMATS[] = {{LAR_TEST_BUILD "/solids.msh", write_msh, {"liver", "tumour"}},
               {LAR_TEST_BUILD "/solids.inp", write_inp, {"liver", "tumour"}},
               {LAR_TEST_BUILD "/solids.feb", write_feb, {"liver", "tumour"}},
               {LAR_TEST_BUILD "/solids.vtk", write_vtk, {"region 1", "region 2"}}};
enum { FORMAT_COUNT = sizeof FORMATS / sizeof FORMATS[0] };

static lar_status boundary_of(const grid *g, int format, bool fuse, lar_boundary *boundary,
                              int32_t *joined) {
    FILE *file = fopen(FORMATS[format].path, "w");
    assert_non_null(file);
    FORMATS[format].write(g, file);
    assert_int_equal(fclose(file), 0);
    return lar_boundary_from_mesh(FORMATS[format].path, 0.5, fuse, "solids", boundary, joined,
                                  &error);
}

/* Two halves of a box of 20 mm, after a scale of one half. */
static void check_halves(const grid *g, int format) {
    static const double HALF = 0.01 * 0.02 * 0.02;
    lar_boundary boundary;
    int32_t joined = -1;
    if (boundary_of(g, format, false, &boundary, &joined)) fail_msg("%s", error.message);
    assert_int_equal(boundary.region_count, 2);
    for (int r = 1; r <= 2; r++) {
        assert_string_equal(boundary.region[r].name, FORMATS[format].name[r - 1]);
        assert_int_equal(boundary.region[r].tag, r);
        assert_below(fabs(boundary.region[r].volume - HALF), 1e-6 * HALF);
    }
    /* Each half is closed: four sides of 2 x 4 squares and two of 4 x 4, each two triangles. */
    assert_int_equal(boundary.triangles.triangle_count, 2 * 2 * (4 * 2 * 4 + 2 * 16));
    assert_int_equal(joined, g->doubled ? (SIDE + 1) * (SIDE + 1) : 0);
    lar_boundary_clear(&boundary);
}

static void every_format(void **state) {
    (void)state;
    static const cut *const CUTS[] = {&TETRAHEDRA, &PRISMS, &PYRAMIDS, &HEXAHEDRA};
    for (int format = 0; format < FORMAT_COUNT; format++)
        for (int c = 0; c < 4; c++)
            for (int bits = 0; bits < 4; bits++)
                check_halves(&(grid){CUTS[c], bits & 1, bits & 2, false}, format);
}

static void one_region(void **state) {
    (void)state;
    for (int fuse = 0; fuse < 2; fuse++) {
        const grid g = {&TETRAHEDRA, false, false, !fuse};
        lar_boundary boundary;
        int32_t joined;
        if (boundary_of(&g, 0, fuse, &boundary, &joined)) fail_msg("%s", error.message);
        assert_int_equal(boundary.region_count, 1);
        assert_string_equal(boundary.region[1].name, "solids");
        assert_int_equal(boundary.region[1].tag, 1);
        assert_below(fabs(boundary.region[1].volume - 8e-6), 1e-12);
        assert_int_equal(boundary.triangles.triangle_count, 2 * 6 * 16);
        lar_boundary_clear(&boundary);
    }
}

static void refused_with(const char *elements, const char *words) {
    FILE *file = fopen(FORMATS[1].path, "w");
    assert_non_null(file);
    fprintf(file, "*NODE\n1, 0,0,0\n2, 1,0,0\n3, 0,1,0\n4, 0,0,1\n5, 0,0,-1\n6, 0,0,2\n%s",
            elements);
    assert_int_equal(fclose(file), 0);
    lar_boundary boundary;
    int32_t joined;
    assert_int_not_equal(
        lar_boundary_from_mesh(FORMATS[1].path, 1, false, "solids", &boundary, &joined, &error),
        LAR_OK);
    if (!strstr(error.message, words)) fail_msg("\"%s\" lacks \"%s\"", error.message, words);
}

static void refusals(void **state) {
    (void)state;
    refused_with("*ELEMENT, TYPE=C3D4\n1, 1,2,3,4\n2, 1,2,3,5\n3, 1,2,3,6\n",
                 "solids.inp: elements 1, 2 and 3 have a face in common");
    refused_with("*ELEMENT, TYPE=S3\n1, 1,2,3\n", "solids.inp: holds no solid elements");
    refused_with("*ELEMENT, TYPE=C3D20\n1, 1,2,3\n", "C3D20");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format),
        cmocka_unit_test(one_region),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
