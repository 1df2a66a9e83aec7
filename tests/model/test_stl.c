/* The STL reader: binary, ascii, what lies between, and damage. */
#include "model/triangle_shapes.h"
#include "model/vtk_sample.h"

/* The cube as 12 triangles, binary. */
static sample_file binary_cube(const char *header) {
    sample_file file = {0};
    char head[80] = {0};
    memcpy(head, header, strlen(header));
    put(&file, head, sizeof head);
    put_word(&file, 12, 4, false);
    for (int q = 0; q < 6; q++)
        for (int half = 0; half < 2; half++) {
            for (int i = 0; i < 3; i++) put_word(&file, 0x7fc00000u, 4, false); /* nan normals */
            for (int a = 0; a < 3; a++) {
                const double *at = cube_point[cube_quad[q][a == 0 ? 0 : a + half]];
                for (int i = 0; i < 3; i++) put_word(&file, float_bits((float)at[i]), 4, false);
            }
            put_word(&file, 0x1234, 2, false);
        }
    return file;
}

static void put_ascii(sample_file *file, int first, int last, const char *end) {
    for (int q = first; q < last; q++)
        for (int half = 0; half < 2; half++) {
            print(file, "  facet normal nan 0 0%s    outer loop%s", end, end);
            for (int a = 0; a < 3; a++) {
                const double *at = cube_point[cube_quad[q][a == 0 ? 0 : a + half]];
                print(file, "      vertex %g %ge0 %.3f%s", at[0], at[1], at[2], end);
            }
            print(file, "    endloop%s  endfacet%s", end, end);
        }
}

static void test_binary(void **state) {
    (void)state;
    static const char *const headers[] = {"", "solid made by a program", "solid\nfacet normal"};
    for (size_t h = 0; h < sizeof headers / sizeof *headers; h++) {
        sample_file file = binary_cube(headers[h]);
        lar_triangles cube = good_surface(lar_stl_parse, file.data, file.size);
        check_surface(&cube, 8, 12, 8);
        lar_triangles_clear(&cube);
        free(file.data);
    }
}

static void test_ascii(void **state) {
    (void)state;
    static const char *const ends[] = {"\n", "\r\n", " "};
    for (size_t e = 0; e < sizeof ends / sizeof *ends; e++)
        for (int split = 0; split <= 6; split += 3) {
            sample_file file = {0};
            if (split > 0) print(&file, "\xef\xbb\xbf");
            print(&file, "solid the first facet solid\n");
            put_ascii(&file, 0, split, ends[e]);
            print(&file, "ENDSOLID the first\nSolid\n");
            put_ascii(&file, split, 6, ends[e]);
            print(&file, "endsolid");
            lar_triangles cube = good_surface(lar_stl_parse, file.data, file.size);
            check_surface(&cube, 8, 12, 8);
            lar_triangles_clear(&cube);
            free(file.data);
        }
}

static void test_damage(void **state) {
    (void)state;
    sample_file file = binary_cube("solid");
    refused_surface(lar_stl_parse, file.data, file.size - 60,
                    "announces 12 triangles, but the 624 bytes of the file hold 10");
    refused_surface(lar_stl_parse, file.data, 80, "is no STL surface");
    parse_all_beginnings(lar_stl_parse, file.data, file.size);
    sample_file more = binary_cube("");
    put(&more, file.data, 100);
    refused_surface(lar_stl_parse, more.data, more.size, "announces 12 triangles");
    memset(more.data + 80, 0xff, 4);
    refused_surface(lar_stl_parse, more.data, more.size, "announces 4294967295 triangles");
    const uint32_t nan = 0x7fc00000u;
    memcpy(file.data + 84 + 50 * 3 + 12 + 4 * 7, &nan, sizeof nan);
    refused_surface(lar_stl_parse, file.data, file.size, "byte 274 (triangle 4 of 12)");
    free(more.data);
    free(file.data);

    static const struct {
        const char *text, *words;
    } rows[] = {
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n", ":4: \"x\" stands where"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n",
         ":4: a coordinate is no finite"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop",
         ":6: \"endloop\" stands where \"vertex\""},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "the file ends where \"vertex\""},
        {"solid\nfacet normal 0 0 1\n", "the file ends where \"outer\""},
        {"solid\nendsolid\nbread", ":3: \"bread\" stands where \"solid\""},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nvertex",
         "stands where \"endloop\""},
        {"", "is no STL surface"},
        {"bread", "is no STL surface"},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
        refused_surface(lar_stl_parse, rows[r].text, strlen(rows[r].text), rows[r].words);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_binary),
        cmocka_unit_test(test_ascii),
        cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
