/* Surfaces in VTK files, legacy and XML: both layouts of cells, strips, tags, what is passed over,
 * what is refused, and the way out and in again. The encodings of numbers are the same as of meshes
 * (test_vtk.c, test_vtu.c). */
#include "model/triangle_shapes.h"
#include "model/vtk_sample.h"

#include <unistd.h>

/* The cube's sides, five as quads and one as a strip, beside a vertex and a line. */
enum { POLYS = 5 };
static const int64_t strip[4] = {3, 0, 7, 4}, line[2] = {0, 6};
static const int64_t tags[8] = {90, 91, 1, 2, 3, 4, 5, 6};

static void put_integer(sample_file *file, bool binary, int64_t value) {
    if (binary)
        put_word(file, (uint64_t)value, 4, true);
    else
        print(file, "%lld ", (long long)value);
}

static void put_list(sample_file *file, bool binary, bool split, const char *keyword, int cells,
                     int each, const int64_t *corner) {
    if (split) {
        print(file, "%s %d %d\nOFFSETS int\n", keyword, cells + 1, cells * each);
        for (int c = 0; c <= cells; c++) put_integer(file, binary, c * each);
        print(file, "\nCONNECTIVITY int\n");
    } else {
        print(file, "%s %d %d\n", keyword, cells, cells * (each + 1));
    }
    for (int c = 0; c < cells; c++) {
        if (!split) put_integer(file, binary, each);
        for (int a = 0; a < each; a++) put_integer(file, binary, corner[c * each + a]);
    }
    print(file, "\n");
}

static void quad_corners(int64_t corner[4 * POLYS]) {
    for (int q = 0; q < POLYS; q++)
        for (int a = 0; a < 4; a++) corner[4 * q + a] = cube_quad[q][a];
}

static sample_file legacy_cube(bool binary, bool split) {
    sample_file file = {0};
    int64_t corner[4 * POLYS];
    quad_corners(corner);
    print(&file, "# vtk DataFile Version %s\na cube\n%s\nDATASET POLYDATA\nPOINTS 8 float\n",
          split ? "5.1" : "3.0", binary ? "BINARY" : "ASCII");
    for (int v = 0; v < 8; v++)
        for (int i = 0; i < 3; i++)
            if (binary)
                put_word(&file, float_bits((float)cube_point[v][i]), 4, true);
            else
                print(&file, "%g ", cube_point[v][i]);
    print(&file, "\n");
    /* The strip first: tags count the lists in VTK's order, not in the file's. */
    put_list(&file, binary, split, "TRIANGLE_STRIPS", 1, 4, strip);
    put_list(&file, binary, split, "VERTICES", 1, 1, line);
    put_list(&file, binary, split, "POLYGONS", POLYS, 4, corner);
    put_list(&file, binary, split, "LINES", 1, 2, line);
    print(&file, "CELL_DATA 8\nSCALARS region int\nLOOKUP_TABLE default\n");
    for (int c = 0; c < 8; c++) put_integer(&file, binary, tags[c]);
    print(&file, "\nPOINT_DATA 8\nVECTORS u float\n");
    for (int k = 0; k < 24; k++) put_integer(&file, binary, 1);
    return file;
}

static void check_tags(const lar_triangles *cube) {
    assert_non_null(cube->tag);
    for (int32_t t = 0; t < cube->triangle_count; t++) {
        assert_int_equal(cube->tag[t], t / 2 + 1);
        double e[3], f[3], normal[3];
        double(*v)[3] = cube->vertex;
        const int32_t *c = cube->corner[t];
        lar_minus(v[c[1]], v[c[0]], e);
        lar_minus(v[c[2]], v[c[0]], f);
        lar_cross(e, f, normal);
        static const double outward[6][3] = {{0, 0, -4}, {0, 0, 4}, {0, -4, 0},
                                             {4, 0, 0},  {0, 4, 0}, {-4, 0, 0}};
        for (int i = 0; i < 3; i++) assert_true(normal[i] == outward[t / 2][i]);
    }
}

static void test_legacy(void **state) {
    (void)state;
    for (int way = 0; way < 4; way++) {
        sample_file file = legacy_cube(way & 1, way & 2);
        lar_triangles cube = good_surface(lar_vtk_surface_parse, file.data, file.size);
        check_surface(&cube, 8, 12, 8);
        check_tags(&cube);
        lar_triangles_clear(&cube);
        parse_all_beginnings(lar_vtk_surface_parse, file.data, file.size);
        free(file.data);
    }
}

static void put_array(sample_file *file, const char *type, const char *name, const int64_t *value,
                      int count) {
    print(file, "<DataArray type=\"%s\" Name=\"%s\" format=\"ascii\">", type, name);
    for (int k = 0; k < count; k++) print(file, "%lld ", (long long)value[k]);
    print(file, "</DataArray>\n");
}

static sample_file xml_cube(void) {
    sample_file file = {0};
    int64_t corner[4 * POLYS];
    quad_corners(corner);
    print(&file, "<VTKFile type=\"PolyData\"><PolyData>\n<Piece NumberOfPoints=\"8\" "
                 "NumberOfVerts=\"1\" NumberOfLines=\"1\" NumberOfStrips=\"1\" "
                 "NumberOfPolys=\"5\">\n<CellData>\n");
    put_array(&file, "Int32", "region", tags, 8);
    print(&file, "</CellData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">\n");
    for (int v = 0; v < 8; v++)
        print(&file, "%g %g %g ", cube_point[v][0], cube_point[v][1], cube_point[v][2]);
    print(&file, "</DataArray></Points>\n<Verts>");
    put_array(&file, "Int32", "connectivity", line, 1);
    put_array(&file, "Int32", "offsets", (const int64_t[]){1}, 1);
    print(&file, "</Verts><Strips>");
    put_array(&file, "Int64", "connectivity", strip, 4);
    put_array(&file, "UInt8", "offsets", (const int64_t[]){4}, 1);
    print(&file, "</Strips><Polys>");
    put_array(&file, "Int32", "connectivity", corner, 4 * POLYS);
    put_array(&file, "Int32", "offsets", (const int64_t[]){4, 8, 12, 16, 20}, POLYS);
    print(&file, "</Polys></Piece></PolyData></VTKFile>\n");
    return file;
}

static void test_xml(void **state) {
    (void)state;
    sample_file file = xml_cube();
    lar_triangles cube = good_surface(lar_vtp_parse, file.data, file.size);
    check_surface(&cube, 8, 12, 8);
    check_tags(&cube);
    lar_triangles_clear(&cube);
    parse_all_beginnings(lar_vtp_parse, file.data, file.size);
    free(file.data);
}

/* The first place of `from` becomes `to`, of the same length. */
static void replace(sample_file *file, const char *from, const char *to) {
    assert_int_equal(strlen(from), strlen(to));
    memcpy(file->data + position_of(file, from), to, strlen(to));
}

static void test_damage(void **state) {
    (void)state;
    static const struct {
        bool xml;
        const char *from, *to, *words;
    } rows[] = {
        {false, "POLYDATA", "polybook", "DATASET polybook is no surface"},
        {false, "4 0 3 2 1", "4 0 3 2 8", "cell 2 (from 0) names a point"},
        {false, "4 0 3 2 1", "4 0 3 2 .", "missing or no number"},
        {false, "POLYGONS 5 25", "POLYGONS 5 24", "the list of POLYGONS ends inside cell 4"},
        {true, "0 3 2 1", "0 3 9 1", "cell 2 (from 0) names a point"},
        {true, "4 8 12 16 20", "9 8 12 16 20", "cell 3 (from 0) ends beyond"},
        {true, "4 8 12 16 20", "4 8 12 16 -1", "the last offset is negative"},
        {true, "\"offsets\" format=\"ascii\">4 8", "\"offset!\" format=\"ascii\">4 8",
         "the array \"offsets\" is missing in Polys"},
        {true, "NumberOfPolys=\"5\"", "NumberOfPolys=\"x\"", "NumberOfPolys of the piece"},
        {true, "90 91 1", "90 91  ", "array \"region\""},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        sample_file file = rows[r].xml ? xml_cube() : legacy_cube(false, false);
        replace(&file, rows[r].from, rows[r].to);
        refused_surface(rows[r].xml ? lar_vtp_parse : lar_vtk_surface_parse, file.data, file.size,
                        rows[r].words);
        free(file.data);
    }
    static const char *const mesh = "# vtk DataFile Version 3.0\nx\nASCII\n"
                                    "DATASET UNSTRUCTURED_GRID\nPOINTS 0 float\n";
    refused_surface(lar_vtk_surface_parse, mesh, strlen(mesh),
                    ":4: DATASET UNSTRUCTURED_GRID is a "
                    "mesh already");
    static const char *const vtu = "<VTKFile type=\"UnstructuredGrid\"></VTKFile>";
    refused_surface(lar_vtp_parse, vtu, strlen(vtu), "save it as .vtp");
    static const char *const empty = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n";
    refused_surface(lar_vtk_surface_parse, empty, strlen(empty), "has no polygon");
    static const char *const nan = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n"
                                   "POINTS 2 float\n0 0 0 0 nan 0\n";
    refused_surface(lar_vtk_surface_parse, nan, strlen(nan), "a coordinate of point 1 (from 0)");
}

static void test_written_and_read(void **state) {
    (void)state;
    lar_triangles torus, back = {0};
    shape_torus_surface(&torus, 0.03, 0.01, (double[]){0.1, 0.2, 1.0 / 3}, 40);
    lar_error error = {0};
    static const char path[] = LAR_TEST_BUILD "/test_polydata.vtp";
    for (int tagged = 0; tagged < 2; tagged++) {
        if (tagged) {
            torus.tag = lar_calloc((size_t)torus.triangle_count, sizeof *torus.tag);
            assert_non_null(torus.tag);
            for (int32_t t = 0; t < torus.triangle_count; t++) torus.tag[t] = t % 7 - 3;
        }
        assert_int_equal(lar_vtp_write(path, &torus, &error), LAR_OK);
        if (lar_triangles_read(path, 1, &back, &error)) fail_msg("%s", error.message);
        assert_int_equal(back.vertex_count, torus.vertex_count);
        assert_int_equal(back.triangle_count, torus.triangle_count);
        size_t triangles = (size_t)torus.triangle_count;
        assert_memory_equal(back.vertex, torus.vertex,
                            (size_t)torus.vertex_count * sizeof *torus.vertex);
        assert_memory_equal(back.corner, torus.corner, triangles * sizeof *torus.corner);
        if (tagged)
            assert_memory_equal(back.tag, torus.tag, triangles * sizeof *torus.tag);
        else
            assert_null(back.tag);
        lar_triangles_clear(&back);
    }
    unlink(path);
    assert_int_equal(lar_vtp_write("/nowhere/at/all.vtp", &torus, &error), LAR_ERROR_IO);
    lar_triangles_clear(&torus);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_legacy),
        cmocka_unit_test(test_xml),
        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_written_and_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
