/* The .vtu reader: every encoding of the same mesh, real files, damaged and hostile ones. */
#include "model/vtk_sample.h"
#include "testing.h"

#include <zlib.h>

typedef enum { ASCII, INLINE, APPENDED_BASE64, APPENDED_RAW, FORMATS } vtu_format;

typedef struct vtu_style {
    vtu_format format;
    bool compressed, header64, big_endian, voxels, joined_base64;
    const char *real, *integer; /* VTK type names */
} vtu_style;

static const vtu_style plain_style = {.format = ASCII, .real = "Float64", .integer = "Int64"};

static size_t type_size(const char *type) {
    return strstr(type, "64") ? 8 : strstr(type, "32") ? 4 : strstr(type, "16") ? 2 : 1;
}

static void put_base64(sample_file *to, const unsigned char *data, size_t size) {
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; k++) bits = bits << 8 | (i + k < size ? data[i + k] : 0u);
        char text[4];
        for (int k = 0; k < 4; k++) text[k] = digit[bits >> (18 - 6 * k) & 63];
        if (i + 1 >= size) text[2] = '=';
        if (i + 2 >= size) text[3] = '=';
        put(to, text, 4);
    }
}

/* Header and data of one array as VTK lays them out; blocks of 64 bytes, so that there are many. */
static void put_payload(sample_file *to, const vtu_style *style, const sample_file *values) {
    size_t word = style->header64 ? 8 : 4;
    bool base64 = style->format != APPENDED_RAW;
    sample_file header = {0}, body = {0};
    if (!style->compressed) {
        put_word(&header, values->size, word, style->big_endian);
        put(&header, values->data, values->size);
    } else {
        enum { BLOCK = 64 };
        size_t blocks = (values->size + BLOCK - 1) / BLOCK;
        put_word(&header, blocks, word, style->big_endian);
        put_word(&header, BLOCK, word, style->big_endian);
        put_word(&header, values->size % BLOCK, word, style->big_endian);
        for (size_t i = 0; i < blocks; i++) {
            size_t size = i + 1 < blocks ? BLOCK : values->size - i * BLOCK;
            unsigned char packed[2 * BLOCK];
            uLongf length = sizeof packed;
            assert_int_equal(compress(packed, &length, values->data + i * BLOCK, size), Z_OK);
            put_word(&header, length, word, style->big_endian);
            put(&body, packed, length);
        }
    }
    if (!base64) {
        put(to, header.data, header.size);
        put(to, body.data, body.size);
    } else if (style->joined_base64) {
        put(&header, body.data, body.size);
        put_base64(to, header.data, header.size);
    } else {
        put_base64(to, header.data, header.size);
        put_base64(to, body.data, body.size);
    }
    free(header.data);
    free(body.data);
}

typedef struct vtu_writer {
    const vtu_style *style;
    sample_file file, appended;
} vtu_writer;

/* One DataArray from doubles or from integers. */
static void add_array(vtu_writer *w, const char *name, int components, bool field,
                      const double *reals, const int64_t *integers, size_t count) {
    const vtu_style *style = w->style;
    const char *type = reals ? style->real : style->integer;
    print(&w->file, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" ", type, name,
          components);
    if (field) print(&w->file, "NumberOfTuples=\"%zu\" ", count);
    if (style->format == ASCII) {
        print(&w->file, "format=\"ascii\">\n");
        for (size_t i = 0; i < count; i++)
            if (reals)
                print(&w->file, " %.17g", strcmp(type, "Float32") ? reals[i] : (float)reals[i]);
            else
                print(&w->file, " %lld", (long long)integers[i]);
        print(&w->file, "\n</DataArray>\n");
        return;
    }
    sample_file values = {0};
    for (size_t i = 0; i < count; i++) {
        uint64_t bits = !reals                 ? (uint64_t)integers[i]
                        : type_size(type) == 8 ? double_bits(reals[i])
                                               : float_bits((float)reals[i]);
        put_word(&values, bits, type_size(type), style->big_endian);
    }
    if (style->format == INLINE) {
        print(&w->file, "format=\"binary\">\n  ");
        put_payload(&w->file, style, &values);
        print(&w->file, "\n</DataArray>\n");
    } else {
        print(&w->file, "format=\"appended\" offset=\"%zu\"/>\n", w->appended.size);
        put_payload(&w->appended, style, &values);
    }
    free(values.data);
}

static sample_file make_vtu(const vtu_style *style) {
    vtu_writer w = {.style = style};
    double points[SAMPLE_POINTS * 3];
    for (int i = 0; i < SAMPLE_POINTS * 3; i++) points[i] = sample_coordinate(i / 3, i % 3);
    print(&w.file,
          "<?xml version=\"1.0\"?>\n<!-- a > b & <AppendedData> -->\n<VTKFile "
          "type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" header_type=\"%s\"%s>\n",
          style->big_endian ? "BigEndian" : "LittleEndian", style->header64 ? "UInt64" : "UInt32",
          style->compressed ? " compressor=\"vtkZLibDataCompressor\"" : "");
    print(&w.file, "<UnstructuredGrid>\n<FieldData>\n");
    add_array(&w, "set:nodes:base", 1, true, NULL, sample_base, 3);
    add_array(&w, "set:faces:a%20b", 1, true, NULL, sample_front, 2);
    add_array(&w, "set:elements:none", 1, true, NULL, sample_front, 0);
    print(&w.file,
          "</FieldData>\n<Piece NumberOfPoints=\"13\" NumberOfCells=\"3\">\n<PointData>\n");
    add_array(&w, "u > 0", 3, false, points, NULL, SAMPLE_POINTS * 3);
    add_array(&w, "set_top", 1, false, NULL, sample_top, SAMPLE_POINTS);
    add_array(&w, "set_of_values", 1, false, NULL, sample_not_a_mask, SAMPLE_POINTS);
    print(&w.file, "</PointData>\n<CellData>\n");
    add_array(&w, "part", 1, false, NULL, sample_part, SAMPLE_CELLS);
    add_array(&w, "material", 1, false, NULL, sample_material, SAMPLE_CELLS);
    add_array(&w, "set_right", 1, false, NULL, sample_right, SAMPLE_CELLS);
    print(&w.file, "</CellData>\n<Points>\n");
    add_array(&w, "Points", 3, false, points, NULL, SAMPLE_POINTS * 3);
    print(&w.file, "</Points>\n<Cells>\n");
    add_array(&w, "connectivity", 1, false, NULL, style->voxels ? sample_voxels : sample_hexahedra,
              SAMPLE_CORNERS);
    add_array(&w, "offsets", 1, false, NULL, sample_ends, SAMPLE_CELLS);
    add_array(&w, "types", 1, false, NULL, style->voxels ? sample_voxel_types : sample_types,
              SAMPLE_CELLS);
    print(&w.file, "</Cells>\n</Piece>\n</UnstructuredGrid>\n");
    if (style->format >= APPENDED_BASE64) {
        print(&w.file, "<AppendedData encoding=\"%s\">\n  _",
              style->format == APPENDED_RAW ? "raw" : "base64");
        put(&w.file, w.appended.data, w.appended.size);
        print(&w.file, "\n</AppendedData>\n");
    }
    print(&w.file, "</VTKFile>");
    free(w.appended.data);
    return w.file;
}

static void expect_vtu(const vtu_style *style) {
    sample_file file = make_vtu(style);
    lar_mesh mesh;
    lar_error error;
    if (sample_parse(lar_vtu_parse, file.data, file.size, &mesh, &error))
        fail_msg("%s (format %d, compressed %d, header64 %d, big %d, %s, %s)", error.message,
                 style->format, style->compressed, style->header64, style->big_endian, style->real,
                 style->integer);
    expect_sample(&mesh, strcmp(style->real, "Float32") == 0);
    assert_int_equal(mesh.set_count, 5);
    expect_set(&mesh, "base", LAR_SET_NODES, (const int32_t[]){0, 1, 2}, 3);
    expect_set(&mesh, "a b", LAR_SET_FACES, (const int32_t[]){11, 2}, 2);
    expect_set(&mesh, "none", LAR_SET_ELEMENTS, NULL, 0);
    expect_set(&mesh, "top", LAR_SET_NODES, (const int32_t[]){6, 7, 8, 9, 10, 11}, 6);
    expect_set(&mesh, "right", LAR_SET_ELEMENTS, (const int32_t[]){1}, 1);
    lar_mesh_clear(&mesh);
    free(file.data);
}

static void test_encodings(void **state) {
    (void)state;
    for (int bits = 0; bits < 32; bits++)
        for (int format = 0; format < FORMATS; format++) {
            vtu_style style = plain_style;
            style.format = (vtu_format)format;
            style.compressed = bits & 1;
            style.header64 = bits & 2;
            style.big_endian = bits & 4;
            style.voxels = bits & 8;
            style.joined_base64 = bits & 16;
            expect_vtu(&style);
        }
}

static void test_scalar_types(void **state) {
    (void)state;
    static const char *const integers[] = {"Int8",  "UInt8",  "Int16", "UInt16",
                                           "Int32", "UInt32", "Int64", "UInt64"};
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < FORMATS * 2; k++) {
            vtu_style style = plain_style;
            style.integer = integers[i];
            style.format = (vtu_format)(k / 2);
            style.big_endian = k % 2;
            style.real = i % 2 ? "Float32" : "Float64";
            expect_vtu(&style);
        }
}

/* Every shorter file is refused, except for those that only lack the closing tags behind
 * appended data. */
static void test_truncation(void **state) {
    (void)state;
    for (int k = 0; k < FORMATS * 2; k++) {
        vtu_style style = plain_style;
        style.format = (vtu_format)(k / 2);
        style.compressed = k % 2;
        sample_file file = make_vtu(&style);
        size_t tail = style.format >= APPENDED_BASE64 ? strlen("\n</AppendedData>\n</VTKFile>") : 0;
        for (size_t size = 0; size < file.size - tail; size++) {
            lar_mesh mesh;
            lar_error error;
            lar_status status = sample_parse(lar_vtu_parse, file.data, size, &mesh, &error);
            if (status == LAR_OK) fail_msg("%zu of %zu bytes were accepted", size, file.size);
            lar_mesh_clear(&mesh);
        }
        free(file.data);
    }
}

/* Every byte of a small file turned into others: nothing but a status may come of it. */
static void test_flipped_bytes(void **state) {
    (void)state;
    static const unsigned char masks[] = {0x01, 0x80, 0xff};
    const size_t every = (size_t)test_every(sizeof masks);
    for (int k = 0; k < FORMATS * 2; k++) {
        vtu_style style = plain_style;
        style.format = (vtu_format)(k / 2);
        style.compressed = k % 2;
        sample_file file = make_vtu(&style);
        for (size_t i = 0; i < file.size; i++)
            for (size_t m = i % every; m < sizeof masks; m += every) {
                lar_mesh mesh;
                lar_error error;
                file.data[i] ^= masks[m];
                lar_status status =
                    sample_parse(lar_vtu_parse, file.data, file.size, &mesh, &error);
                if (status == LAR_OK) lar_mesh_check(&mesh, &error);
                lar_mesh_clear(&mesh);
                file.data[i] ^= masks[m];
            }
        free(file.data);
    }
}

static void test_bad_text(void **state) {
    (void)state;
    static const struct {
        const char *old, *fresh;
        lar_status status;
        const char *part;
    } cases[] = {
        {"<VTKFile type=\"UnstructuredGrid\"", "<VTKFile type=\"PolyData\"", LAR_ERROR_UNSUPPORTED,
         "save the mesh as an unstructured grid"},
        {"LittleEndian", "MiddleEndian", LAR_ERROR_UNSUPPORTED, "byte_order"},
        {"UInt32", "UInt16", LAR_ERROR_UNSUPPORTED, "header_type"},
        {"version=\"1.0\" byte", "compressor=\"vtkLZ4DataCompressor\" byte", LAR_ERROR_UNSUPPORTED,
         "save the file with zlib"},
        {"<?xml version=\"1.0\"?>", "PK\3\4", LAR_ERROR_FORMAT, "XML"},
        {"<!-- a", "<!DOCTYPE x>", LAR_ERROR_FORMAT, "declaration"},
        {"NumberOfPoints=\"13\"", "NumberOfPoints=\"-1\"", LAR_ERROR_FORMAT, "no count"},
        {"NumberOfPoints=\"13\"", "NumberOfPoints=\"400000000\"", LAR_ERROR_FORMAT, "fewer values"},
        {"NumberOfPoints=\"13\"", "NumberOfPoints=\"9000000000000000000\"", LAR_ERROR_UNSUPPORTED,
         "divide the model"},
        {"NumberOfPoints=\"13\"", "NumberOfPoints=\"12\"", LAR_ERROR_FORMAT, "more values"},
        {"NumberOfPoints=\"13\"", "NumberOfPoints=\"14\"", LAR_ERROR_FORMAT,
         "missing or no number"},
        {"NumberOfCells=\"3\"", "NumberOfCells=\"2\"", LAR_ERROR_FORMAT, "more values"},
        {"NumberOfCells=\"3\"", "", LAR_ERROR_FORMAT, "NumberOfCells"},
        {" 4 12 20\n", " 4 12 -20\n", LAR_ERROR_FORMAT, "last offset is negative"},
        {" 4 12 20\n", " 14 12 20\n", LAR_ERROR_FORMAT, "offsets must ascend"},
        {" 4 12 20\n", " 4 99 20\n", LAR_ERROR_FORMAT, "offsets must ascend"},
        {" 4 12 20\n", " 5 12 20\n", LAR_ERROR_FORMAT, "7 corners instead of 8"},
        {" 9 12 12\n", " 9 12 15\n", LAR_ERROR_UNSUPPORTED,
         "cell 2 is a pentagonal prism (VTK cell type 15); Lariat computes with eight-node "
         "hexahedra"},
        {" 9 12 12\n", " 9 12 10\n", LAR_ERROR_FORMAT, "tetrahedron 2 has 8 corners instead of 4"},
        {" 9 12 12\n", " 9 12 24\n", LAR_ERROR_FORMAT, "tetrahedron 2 has 8 corners instead of 10"},
        {" 9 12 12\n", " 9 25 12\n", LAR_ERROR_UNSUPPORTED, "first-order"},
        {" 9 12 12\n", " 9 -5 12\n", LAR_ERROR_UNSUPPORTED, "unknown kind"},
        {" 9 12 12\n", " 9 9 9\n", LAR_ERROR_MODEL, "no hexahedra"},
        {" 9 12 12\n", " 9 1e1 12\n", LAR_ERROR_FORMAT, "no number"},
        {" 1 2 5 4 1 2", " 1 2 5 4 -1 2", LAR_ERROR_FORMAT, "cell 1 names point -1"},
        {" 1 2 5 4 1 2", " 1 2 5 4 1 13", LAR_ERROR_FORMAT, "there are 13 points"},
        {" 99 3 4\n", " 99 3 5000000000\n", LAR_ERROR_FORMAT, "does not fit 32 bits"},
        {" 3 1 2\n", " 3 1 13\n", LAR_ERROR_FORMAT, "set:nodes:base"},
        {" 3 1 2\n", " 3 1 -1\n", LAR_ERROR_FORMAT, "set:nodes:base"},
        {" 17 8\n", " 18 8\n", LAR_ERROR_FORMAT, "set:faces:a%20b"},
        {" 17 8\n", " 1 8\n", LAR_ERROR_FORMAT, "set:faces:a%20b"},
        {"<Points>", "<Dots>", LAR_ERROR_FORMAT, "XML"},
        {"Name=\"Points\" NumberOfComponents=\"3\"", "Name=\"Points\" NumberOfComponents=\"2\"",
         LAR_ERROR_FORMAT, "x, y and z"},
        {"Name=\"offsets\"", "Name=\"ends\"", LAR_ERROR_FORMAT, "\"offsets\" is missing"},
        {"<DataArray type=\"Float64\" Name=\"Points\"", "<DataArray type=\"Quad\" Name=\"Points\"",
         LAR_ERROR_FORMAT, "none that VTK knows"},
        {"<DataArray type=\"Int64\" Name=\"types\"", "<DataArray type=\"Float64\" Name=\"types\"",
         LAR_ERROR_FORMAT, "must hold integers"},
        {"Name=\"types\" NumberOfComponents=\"1\" format=\"ascii\"",
         "Name=\"types\" format=\"appended\" offset=\"5\"", LAR_ERROR_FORMAT, "appended data"},
        {"Name=\"types\" NumberOfComponents=\"1\" format=\"ascii\"",
         "Name=\"types\" format=\"binary\"", LAR_ERROR_FORMAT, "damaged"},
        {"Name=\"types\" NumberOfComponents=\"1\" format=\"ascii\"",
         "Name=\"types\" format=\"zip\"", LAR_ERROR_FORMAT, "ascii, binary or appended"},
        {"</Piece>", "</Piece><Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"></Piece>",
         LAR_ERROR_UNSUPPORTED, "Merge Blocks"},
        {" 4 12 20\n", " 4 <DataArray/> 12 20\n", LAR_ERROR_FORMAT, "inside another array"},
        {" 4 12 20\n", " 4 12 <x/> 20\n", LAR_ERROR_FORMAT, "interrupted"},
        {"<Points>", "<Points><a>&lol;</a>", LAR_ERROR_FORMAT, "XML"},
    };
    sample_file file = make_vtu(&plain_style);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *bad = replaced((char *)file.data, cases[i].old, cases[i].fresh);
        expect_refusal(lar_vtu_parse, bad, strlen(bad), cases[i].status, cases[i].part);
        free(bad);
    }
    char *renamed = replaced((char *)file.data, "<Points>", "<Dots>");
    char *missing = replaced(renamed, "</Points>", "</Dots>");
    expect_refusal(lar_vtu_parse, missing, strlen(missing), LAR_ERROR_FORMAT, "no Points array");
    free(renamed);
    free(missing);
    free(file.data);
}

/* NaN is a matter of lar_mesh_check, which names the node. */
static void test_nan_is_left_to_the_check(void **state) {
    (void)state;
    sample_file file = make_vtu(&plain_style);
    char *start = strstr((char *)file.data, "<Points>");
    char *bad = replaced(start, " 0 0 0", " nan 0 0");
    char *whole = replaced((char *)file.data, start, bad);
    lar_mesh mesh;
    lar_error error;
    assert_int_equal(sample_parse(lar_vtu_parse, whole, strlen(whole), &mesh, &error), LAR_OK);
    assert_true(lar_mesh_check(&mesh, &error) != LAR_OK);
    lar_mesh_clear(&mesh);
    free(bad);
    free(whole);
    free(file.data);
}

static void test_entity_bomb_and_nesting(void **state) {
    (void)state;
    sample_file bomb = {0};
    print(&bomb, "<?xml version=\"1.0\"?>\n<!DOCTYPE lolz [<!ENTITY l0 \"lol\">");
    for (int i = 1; i < 10; i++) {
        print(&bomb, "<!ENTITY l%d \"", i);
        for (int k = 0; k < 10; k++) print(&bomb, "&l%d;", i - 1);
        print(&bomb, "\">");
    }
    print(&bomb, "]><VTKFile type=\"&l9;\">&l9;</VTKFile>");
    expect_refusal(lar_vtu_parse, bomb.data, bomb.size, LAR_ERROR_FORMAT, "declaration");
    bomb.size = 0;
    for (int i = 0; i < 100000; i++) print(&bomb, "<a>");
    expect_refusal(lar_vtu_parse, bomb.data, bomb.size, LAR_ERROR_FORMAT, "XML");
    bomb.size = 0;
    print(&bomb, "<VTKFile>");
    while (bomb.size < 20 << 20) print(&bomb, "<aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa/>");
    expect_refusal(lar_vtu_parse, bomb.data, bomb.size, LAR_ERROR_FORMAT, "more XML");
    bomb.size = 0;
    static const char utf16[] = "\xff\xfe<\0V\0T\0K\0>\0";
    expect_refusal(lar_vtu_parse, utf16, sizeof utf16 - 1, LAR_ERROR_FORMAT, "UTF-8");
    expect_refusal(lar_vtu_parse, "", 0, LAR_ERROR_FORMAT, "XML");
    free(bomb.data);
}

/* A file whose Points are `payload`: claims of the header against the bytes. */
static void expect_bad_points(const vtu_style *style, const char *count, const sample_file *payload,
                              const char *part) {
    sample_file file = {0};
    print(&file,
          "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" header_type=\"UInt64\"%s>"
          "<UnstructuredGrid><Piece NumberOfPoints=\"%s\" NumberOfCells=\"1\"><Points><DataArray "
          "type=\"Float64\" NumberOfComponents=\"3\" format=\"%s\" offset=\"0\">",
          style->compressed ? " compressor=\"vtkZLibDataCompressor\"" : "", count,
          style->format == INLINE ? "binary" : "appended");
    if (style->format == INLINE) put_base64(&file, payload->data, payload->size);
    print(&file, "</DataArray></Points></Piece></UnstructuredGrid>");
    if (style->format == APPENDED_RAW) {
        print(&file, "<AppendedData encoding=\"raw\">_");
        put(&file, payload->data, payload->size);
        print(&file, "</AppendedData>");
    }
    print(&file, "</VTKFile>");
    expect_refusal(lar_vtu_parse, file.data, file.size, LAR_ERROR_FORMAT, part);
    free(file.data);
}

static void test_false_claims(void **state) {
    (void)state;
    const uint64_t ten_gigabytes = 400000000ull * 24;
    for (int k = 0; k < 2; k++) {
        vtu_style style = plain_style;
        style.format = k ? APPENDED_RAW : INLINE;
        sample_file data = {0};
        put_word(&data, ten_gigabytes, 8, false);
        put(&data, "0123456789", 10);
        expect_bad_points(&style, "400000000", &data, "end too early");
        expect_bad_points(&style, "4", &data, "do not have the size");

        style.compressed = true;
        static const struct {
            uint64_t blocks, block, last, packed;
            const char *count, *part;
        } claims[] = {
            {1, 9600000000, 0, 16, "400000000", "compressed sizes"},
            {1, 9600000000, 0, 1 << 30, "400000000", "compressed sizes"},
            {1ull << 60, 1 << 15, 0, 16, "400000000", "sizes that cannot be"},
            {2, 1ull << 63, 5, 16, "400000000", "do not have the size"},
            {UINT64_MAX, UINT64_MAX, 0, 16, "400000000", "sizes that cannot be"},
            {1, 24, 30, 16, "1", "sizes that cannot be"},
            {1, 24, 0, UINT64_MAX, "1", "compressed sizes"},
            {1, 24, 0, 16, "1", "cannot be decompressed"},
            {0, 0, 0, 0, "1", "do not have the size"},
        };
        for (size_t i = 0; i < sizeof claims / sizeof *claims; i++) {
            data.size = 0;
            put_word(&data, claims[i].blocks, 8, false);
            put_word(&data, claims[i].block, 8, false);
            put_word(&data, claims[i].last, 8, false);
            put_word(&data, claims[i].packed, 8, false);
            put(&data, "no zlib stream at all", 21);
            expect_bad_points(&style, claims[i].count, &data, claims[i].part);
        }
        free(data.data);
    }
}

/* A block that inflates to more, or to less, than it claims. */
static void test_zlib_bomb(void **state) {
    (void)state;
    enum { REAL = 1 << 20 };
    unsigned char *zeros = calloc(1, REAL), packed[8192];
    assert_non_null(zeros);
    uLongf length = sizeof packed;
    assert_int_equal(compress2(packed, &length, zeros, REAL, 9), Z_OK);
    for (int k = 0; k < 2; k++)
        for (int longer = 0; longer < 2; longer++) {
            vtu_style style = plain_style;
            style.format = k ? APPENDED_RAW : INLINE;
            style.compressed = true;
            sample_file data = {0};
            put_word(&data, 1, 8, false);
            put_word(&data, longer ? 43691 * 24 : 240, 8, false);
            put_word(&data, 0, 8, false);
            put_word(&data, length, 8, false);
            put(&data, packed, length);
            expect_bad_points(&style, longer ? "43691" : "10", &data, "cannot be decompressed");
            free(data.data);
        }
    free(zeros);
}

/* Bytes behind the end of a zlib stream, or of an array that has its text for itself. */
static void test_left_over(void **state) {
    (void)state;
    const double points[30] = {0};
    unsigned char packed[256];
    uLongf length = sizeof packed;
    assert_int_equal(compress2(packed, &length, (const Bytef *)points, sizeof points, 9), Z_OK);
    for (int k = 0; k < 3; k++) {
        vtu_style style = plain_style;
        style.format = k == 1 ? APPENDED_RAW : INLINE;
        style.compressed = k < 2;
        sample_file data = {0};
        if (style.compressed) {
            put_word(&data, 1, 8, false);
            put_word(&data, sizeof points, 8, false);
            put_word(&data, 0, 8, false);
            put_word(&data, length + 3, 8, false);
            put(&data, packed, length);
            put(&data, "123", 3);
            expect_bad_points(&style, "10", &data, "cannot be decompressed");
            data.data[24] = (unsigned char)length; /* little-endian, as the file says */
        } else {
            put_word(&data, sizeof points, 8, false);
            put(&data, points, sizeof points);
            put(&data, "123", 3);
        }
        if (k != 1) expect_bad_points(&style, "10", &data, "are more than");
        free(data.data);
    }
}

static void test_base64_garbage(void **state) {
    (void)state;
    static const char *const garbage[] = {
        "", "A", "====", "A===", "AB=C", "$%^&", "AAAA", "\xff\xfe"};
    vtu_style style = plain_style;
    style.format = INLINE;
    sample_file file = make_vtu(&style);
    char *points = strstr((char *)file.data, "<Points>");
    char *from = strchr(strstr(points, "<DataArray"), '>') + 1;
    char *to = strchr(from, '<');
    for (size_t i = 0; i < sizeof garbage / sizeof *garbage; i++) {
        sample_file bad = {0};
        put(&bad, file.data, (size_t)(from - (char *)file.data));
        put(&bad, garbage[i], strlen(garbage[i]));
        put(&bad, to, file.size - (size_t)(to - (char *)file.data));
        expect_refusal(lar_vtu_parse, bad.data, bad.size, LAR_ERROR_FORMAT, "\"Points\"");
        free(bad.data);
    }
    free(file.data);
}

/* More text in one array than a general XML parser lets pass. */
static void test_long_text(void **state) {
    (void)state;
    sample_file file = make_vtu(&plain_style);
    size_t before = position_of(&file, " 9 12 12\n");
    sample_file longer = {0};
    put(&longer, file.data, before);
    while (longer.size < 12 << 20) put(&longer, "                    \n", 21);
    put(&longer, file.data + before, file.size - before);
    lar_mesh mesh;
    lar_error error;
    assert_int_equal(sample_parse(lar_vtu_parse, longer.data, longer.size, &mesh, &error), LAR_OK);
    expect_sample(&mesh, false);
    lar_mesh_clear(&mesh);
    free(longer.data);
    free(file.data);
}

static void test_liver(void **state) {
    (void)state;
    lar_bytes bytes = shared_file("deformed_liver_volume_hexahedrons.vtu");
    lar_mesh mesh = {0};
    lar_error error = {0};
    if (lar_vtu_parse("liver.vtu", &bytes, &mesh, &error)) fail_msg("%s", error.message);
    lar_bytes_free(&bytes);
    assert_int_equal(mesh.node_count, 1736);
    assert_int_equal(mesh.element_count, 1165);
    if (lar_mesh_check(&mesh, &error)) fail_msg("%s", error.message);
    /* VTK 9.1 (vtkCellSizeFilter) finds the same point and 5553386.9 mm^3 */
    assert_true(mesh.position[0][0] == 274.06326293945312);
    assert_in_range((uintmax_t)mesh_volume(&mesh), 5553300, 5553500);
    lar_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_encodings),
        cmocka_unit_test(test_scalar_types),
        cmocka_unit_test(test_truncation),
        cmocka_unit_test(test_flipped_bytes),
        cmocka_unit_test(test_bad_text),
        cmocka_unit_test(test_nan_is_left_to_the_check),
        cmocka_unit_test(test_entity_bomb_and_nesting),
        cmocka_unit_test(test_false_claims),
        cmocka_unit_test(test_zlib_bomb),
        cmocka_unit_test(test_left_over),
        cmocka_unit_test(test_base64_garbage),
        cmocka_unit_test(test_long_text),
        cmocka_unit_test(test_liver),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
