/* The legacy .vtk reader: every version and encoding of the same mesh, all kinds of data to be
 * walked over, real files, damaged ones. */
#include "model/vtk_sample.h"

typedef struct vtk_style {
    bool binary, version5, voxels, field_tag;
    const char *real, *integer; /* legacy type names */
    size_t real_size, integer_size;
} vtk_style;

static const vtk_style plain_style = {
    .real = "double", .integer = "int", .real_size = 8, .integer_size = 4};

static void put_integers(sample_file *file, const vtk_style *style, size_t size,
                         const int64_t *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (style->binary)
            put_word(file, (uint64_t)values[i], size, true);
        else
            print(file, "%lld ", (long long)values[i]);
    print(file, "\n");
}

/* Numbers of no meaning, `count` of `size` bytes. */
static void put_filler(sample_file *file, const vtk_style *style, size_t size, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (style->binary)
            put_word(file, 0x0a43454c4c532078ull, size, true); /* "\nCELLS x" */
        else
            print(file, "%zu.5\n", i);
    print(file, "\n");
}

static void put_cells(sample_file *file, const vtk_style *style) {
    const int64_t *corners = style->voxels ? sample_voxels : sample_hexahedra;
    if (style->version5) {
        static const int64_t offsets[] = {0, 4, 12, 20};
        print(file, "CELLS 4 20\nOFFSETS vtktypeint64\n");
        put_integers(file, style, 8, offsets, 4);
        print(file, "CONNECTIVITY %s\n", style->integer);
        put_integers(file, style, style->integer_size, corners, SAMPLE_CORNERS);
    } else {
        print(file, "CELLS 3 23\n");
        int64_t list[23];
        size_t filled = 0;
        for (int cell = 0, from = 0; cell < SAMPLE_CELLS; from = (int)sample_ends[cell++]) {
            list[filled++] = sample_ends[cell] - from;
            for (int k = from; k < sample_ends[cell]; k++) list[filled++] = corners[k];
        }
        put_integers(file, style, 4, list, filled);
    }
    print(file, "CELL_TYPES 3\n");
    put_integers(file, style, 4, style->voxels ? sample_voxel_types : sample_types, SAMPLE_CELLS);
}

/* Everything that may stand between the points' data and ours. */
static void put_things_to_skip(sample_file *file, const vtk_style *style) {
    print(file, "SCALARS pressure float 2\nLOOKUP_TABLE mine\n");
    put_filler(file, style, 4, SAMPLE_POINTS * 2);
    print(file, "LOOKUP_TABLE mine 5\n");
    put_filler(file, style, 1, 20);
    print(file, "COLOR_SCALARS colour 3\n");
    put_filler(file, style, 1, SAMPLE_POINTS * 3);
    print(file, "VECTORS v double\n");
    put_filler(file, style, 8, SAMPLE_POINTS * 3);
    print(file,
          "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n");
    print(file, "NORMALS n float\n");
    put_filler(file, style, 4, SAMPLE_POINTS * 3);
    print(file, "TEXTURE_COORDINATES t 2 float\n");
    put_filler(file, style, 4, SAMPLE_POINTS * 2);
    print(file, "TENSORS s double\n");
    put_filler(file, style, 8, SAMPLE_POINTS * 9);
    print(file, "GLOBAL_IDS ids vtkIdType\n");
    put_filler(file, style, 4, SAMPLE_POINTS);
    print(file, "FIELD more 4\nshorts 2 13 unsigned_short\n");
    put_filler(file, style, 2, SAMPLE_POINTS * 2);
    print(file, "bits 1 13 bit\n");
    put_filler(file, style, 1, style->binary ? 2 : 13);
    print(file, "words 1 3 string\n");
    if (style->binary)
        put(file, "\xc3yes\xc0\x80\x02ok", 9);
    else
        print(file, "yes\n\nok\n");
    print(file, "\nset_top 1 13 unsigned_char\n");
    put_integers(file, style, 1, sample_top, SAMPLE_POINTS);
}

static sample_file make_vtk(const vtk_style *style) {
    sample_file file = {0};
    print(&file, "# vtk DataFile Version %s\ntwo cubes\n%s\nDATASET UNSTRUCTURED_GRID\n",
          style->version5 ? "5.1" : "3.0", style->binary ? "BINARY" : "ASCII");
    print(&file, "FIELD FieldData 2\nTimeValue 1 1 double\n");
    put_filler(&file, style, 8, 1);
    print(&file, "set:nodes:base%%2520x 1 3 int\n");
    put_integers(&file, style, 4, sample_base, 3);
    print(&file, "POINTS 13 %s\n", style->real);
    for (int i = 0; i < SAMPLE_POINTS * 3; i++) {
        double value = sample_coordinate(i / 3, i % 3);
        bool single = style->real_size == 4;
        if (!style->binary)
            print(&file, "%.17g ", single ? (float)value : value);
        else
            put_word(&file, single ? float_bits((float)value) : double_bits(value),
                     style->real_size, true);
    }
    print(&file, "\nMETADATA\nINFORMATION 0\n\n");
    put_cells(&file, style);
    print(&file, "POINT_DATA 13\n");
    put_things_to_skip(&file, style);
    print(&file, "CELL_DATA 3\n");
    print(&file,
          style->field_tag ? "FIELD FieldData 1\nmaterial 1 3 %s\n"
                           : "SCALARS material %s\nLOOKUP_TABLE default\n",
          style->integer);
    put_integers(&file, style, style->integer_size, sample_material, SAMPLE_CELLS);
    return file;
}

static void expect_vtk(const vtk_style *style) {
    sample_file file = make_vtk(style);
    lar_mesh mesh;
    lar_error error;
    if (sample_parse(lar_vtk_parse, file.data, file.size, &mesh, &error))
        fail_msg("%s (binary %d, version 5 %d, %s, %s)", error.message, style->binary,
                 style->version5, style->real, style->integer);
    expect_sample(&mesh, style->real_size == 4);
    assert_int_equal(mesh.set_count, 2);
    expect_set(&mesh, "base x", LAR_SET_NODES, (const int32_t[]){0, 1, 2}, 3);
    expect_set(&mesh, "top", LAR_SET_NODES, (const int32_t[]){6, 7, 8, 9, 10, 11}, 6);
    lar_mesh_clear(&mesh);
    free(file.data);
}

static void test_encodings(void **state) {
    (void)state;
    static const struct {
        const char *name;
        size_t size;
    } integers[] = {{"char", 1},           {"unsigned_char", 1}, {"short", 2},
                    {"unsigned_short", 2}, {"int", 4},           {"unsigned_int", 4},
                    {"long", 8},           {"unsigned_long", 8}, {"vtkIdType", 4},
                    {"long_long", 8},      {"vtktypeint64", 8},  {"vtktypeuint64", 8}};
    for (size_t i = 0; i < sizeof integers / sizeof *integers; i++)
        for (int bits = 0; bits < 32; bits++) {
            vtk_style style = plain_style;
            style.integer = integers[i].name;
            style.integer_size = integers[i].size;
            style.binary = bits & 1;
            style.version5 = bits & 2;
            style.voxels = bits & 4;
            style.field_tag = bits & 8;
            style.real = bits & 16 ? "float" : "double";
            style.real_size = bits & 16 ? 4 : 8;
            expect_vtk(&style);
        }
}

static void test_truncation(void **state) {
    (void)state;
    for (int bits = 0; bits < 4; bits++) {
        vtk_style style = plain_style;
        style.binary = bits & 1;
        style.version5 = bits & 2;
        sample_file file = make_vtk(&style);
        /* Behind POINT_DATA a file may end between two arrays; before it, nowhere. */
        size_t whole = position_of(&file, "POINT_DATA");
        for (size_t size = 0; size < file.size; size++) {
            lar_mesh mesh;
            lar_error error;
            lar_status status = sample_parse(lar_vtk_parse, file.data, size, &mesh, &error);
            /* the last types may lose their digits and the white space behind them */
            if (status == LAR_OK && size < whole - 3)
                fail_msg("%zu of %zu bytes were accepted", size, file.size);
            lar_mesh_clear(&mesh);
        }
        free(file.data);
    }
}

static void test_flipped_bytes(void **state) {
    (void)state;
    static const unsigned char masks[] = {0x01, 0x80, 0xff};
    for (int bits = 0; bits < 4; bits++) {
        vtk_style style = plain_style;
        style.binary = bits & 1;
        style.version5 = bits & 2;
        sample_file file = make_vtk(&style);
        for (size_t i = 0; i < file.size; i++)
            for (size_t m = 0; m < sizeof masks; m++) {
                lar_mesh mesh;
                lar_error error;
                file.data[i] ^= masks[m];
                lar_status status =
                    sample_parse(lar_vtk_parse, file.data, file.size, &mesh, &error);
                if (status == LAR_OK) lar_mesh_check(&mesh, &error);
                lar_mesh_clear(&mesh);
                file.data[i] ^= masks[m];
            }
        free(file.data);
    }
}

typedef struct bad_case {
    const char *old, *fresh;
    lar_status status;
    const char *part;
} bad_case;

static void expect_bad_cases(const vtk_style *style, const bad_case *cases, size_t count) {
    sample_file file = make_vtk(style);
    for (size_t i = 0; i < count; i++) {
        char *bad = replaced((char *)file.data, cases[i].old, cases[i].fresh);
        expect_refusal(lar_vtk_parse, bad, strlen(bad), cases[i].status, cases[i].part);
        free(bad);
    }
    free(file.data);
}

static void test_bad_classic(void **state) {
    (void)state;
    static const bad_case cases[] = {
        {"# vtk DataFile", "# VTK", LAR_ERROR_FORMAT, "no legacy VTK file"},
        {"Version 3.0", "Version 6.0", LAR_ERROR_UNSUPPORTED, "save the file as .vtu"},
        {"Version 3.0", "Version x", LAR_ERROR_UNSUPPORTED, "save the file as .vtu"},
        {"ASCII", "TEXT", LAR_ERROR_FORMAT, "ASCII or BINARY"},
        {"UNSTRUCTURED_GRID", "STRUCTURED_POINTS", LAR_ERROR_UNSUPPORTED,
         "save it as an unstructured grid"},
        {"UNSTRUCTURED_GRID", "POLYDATA", LAR_ERROR_UNSUPPORTED, "POLYDATA"},
        {"POINTS 13", "POINTS 400000000", LAR_ERROR_FORMAT, "are announced"},
        {"POINTS 13", "POINTS 9223372036854775807", LAR_ERROR_FORMAT, "POINTS has no count"},
        {"POINTS 13", "POINTS -13", LAR_ERROR_FORMAT, "POINTS has no count"},
        {"POINTS 13", "POINTS 14", LAR_ERROR_FORMAT, "no number"},
        {"POINTS 13", "POINTS 12", LAR_ERROR_FORMAT, "keyword"},
        {"POINTS 13 double", "POINTS 13 quad", LAR_ERROR_UNSUPPORTED, "no type of numbers"},
        {"CELLS 3 23", "CELLS 3 400000000", LAR_ERROR_FORMAT, "are announced"},
        {"CELLS 3 23", "CELLS 400000000 23", LAR_ERROR_FORMAT, "more cells than numbers"},
        {"CELLS 3 23", "CELLS 4 23", LAR_ERROR_FORMAT, "ends inside cell 3"},
        {"CELLS 3 23", "CELLS 2 23", LAR_ERROR_FORMAT, "2 CELLS but 3 CELL_TYPES"},
        {"\n4 1 2 5 4 8", "\n4 1 2 5 4 99", LAR_ERROR_FORMAT, "ends inside cell 1"},
        {"\n4 1 2 5 4 8", "\n4 1 2 5 4 -8", LAR_ERROR_FORMAT, "ends inside cell 1"},
        {"\n4 1 2 5 4 8 1", "\n4 1 2 5 4 8 77", LAR_ERROR_FORMAT, "cell 1 names point 77"},
        {"CELL_TYPES 3\n9 12 12", "CELL_TYPES 3\n9 12 10", LAR_ERROR_FORMAT,
         "tetrahedron 2 has 8 corners instead of 4"},
        {"CELL_TYPES 3\n9 12 12", "CELL_TYPES 2\n9 12", LAR_ERROR_FORMAT, "2 CELL_TYPES"},
        {"CELL_TYPES 3\n9 12 12", "CELL_TYPES 3\n9 9 9", LAR_ERROR_MODEL, "no hexahedra"},
        {"POINT_DATA 13", "POINT_DATA 400000000", LAR_ERROR_FORMAT, "is missing"},
        {"CELL_DATA 3", "CELL_DATA 2", LAR_ERROR_FORMAT, "keyword"},
        {"FIELD more 4", "FIELD more 9000000000", LAR_ERROR_FORMAT, "FIELD"},
        {"shorts 2 13", "shorts 4000000000 4000000000", LAR_ERROR_FORMAT, "no counts"},
        {"SCALARS pressure float 2", "SCALARS pressure float 9", LAR_ERROR_FORMAT, "1 to 4"},
    };
    expect_bad_cases(&plain_style, cases, sizeof cases / sizeof *cases);
}

static void test_bad_version_5(void **state) {
    (void)state;
    static const bad_case cases[] = {
        {"CELLS 4 20", "CELLS 400000000 20", LAR_ERROR_FORMAT, "are announced"},
        {"CELLS 4 20", "CELLS 4 400000000", LAR_ERROR_FORMAT, "are announced"},
        {"OFFSETS", "ENDS", LAR_ERROR_FORMAT, "OFFSETS is missing"},
        {"CONNECTIVITY", "CORNERS", LAR_ERROR_FORMAT, "CONNECTIVITY is missing"},
        {"\n0 4 12 20 ", "\n1 4 12 20 ", LAR_ERROR_FORMAT, "OFFSETS is not 0"},
        {"\n0 4 12 20 ", "\n0 14 12 20 ", LAR_ERROR_FORMAT, "offsets must ascend"},
        {"\n0 4 12 20 ", "\n0 4 12 28 ", LAR_ERROR_FORMAT, "offsets must ascend"},
        {"OFFSETS vtktypeint64", "OFFSETS float", LAR_ERROR_FORMAT, "where integers belong"},
    };
    static const bad_case short_tag = {"material 1 3 int\n99 3 4", "material 1 2 int\n99 3",
                                       LAR_ERROR_FORMAT, "\"material\" has 2 values where 3"};
    vtk_style style = plain_style;
    style.field_tag = true;
    expect_bad_cases(&style, &short_tag, 1);
    style.version5 = true;
    expect_bad_cases(&style, cases, sizeof cases / sizeof *cases);
    expect_refusal(lar_vtk_parse, "", 0, LAR_ERROR_FORMAT, "no legacy VTK file");
    static const char empty[] = "# vtk DataFile Version 5.1\n\nBINARY\nDATASET UNSTRUCTURED_GRID\n"
                                "POINTS 0 float\nCELLS 0 0\nOFFSETS vtktypeint64\nCONNECTIVITY "
                                "vtktypeint64\nCELL_TYPES 0\n";
    expect_refusal(lar_vtk_parse, empty, sizeof empty - 1, LAR_ERROR_MODEL, "no hexahedra");
    static const char none[] = "# vtk DataFile Version 5.1\n\nASCII\nDATASET UNSTRUCTURED_GRID\n";
    expect_refusal(lar_vtk_parse, none, sizeof none - 1, LAR_ERROR_FORMAT, "POINTS is missing");
}

/* A file that was edited on another system. */
static void test_windows_line_ends(void **state) {
    (void)state;
    sample_file file = make_vtk(&plain_style), windows = {0};
    for (size_t i = 0; i < file.size; i++) {
        if (file.data[i] == '\n') put(&windows, "\r", 1);
        put(&windows, &file.data[i], 1);
    }
    lar_mesh mesh;
    lar_error error;
    if (sample_parse(lar_vtk_parse, windows.data, windows.size, &mesh, &error))
        fail_msg("%s", error.message);
    expect_sample(&mesh, false);
    lar_mesh_clear(&mesh);
    free(windows.data);
    free(file.data);
}

static void test_beam(void **state) {
    (void)state;
    lar_bytes bytes = shared_file("3D_hexahedron_linear.vtk");
    lar_mesh mesh = {0};
    lar_error error = {0};
    if (lar_vtk_parse("beam.vtk", &bytes, &mesh, &error)) fail_msg("%s", error.message);
    lar_bytes_free(&bytes);
    assert_int_equal(mesh.node_count, 125);
    assert_int_equal(mesh.element_count, 64);
    assert_int_equal(mesh.element_id[0], 96);                              /* behind 96 quads */
    for (int e = 0; e < 64; e++) assert_int_equal(mesh.element_tag[e], 4); /* gmsh:physical */
    if (lar_mesh_check(&mesh, &error)) fail_msg("%s", error.message);
    assert_true(mesh.position[0][0] == -17.0648);
    double volume = mesh_volume(&mesh); /* VTK 9.1, by tetrahedra: 1000.002 */
    assert_true(volume > 999.99 && volume < 1000.01);
    lar_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_encodings),     cmocka_unit_test(test_truncation),
        cmocka_unit_test(test_flipped_bytes), cmocka_unit_test(test_bad_classic),
        cmocka_unit_test(test_bad_version_5), cmocka_unit_test(test_windows_line_ends),
        cmocka_unit_test(test_beam),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
