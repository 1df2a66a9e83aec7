/* The OBJ reader: the ways to write a polygon, and damage. */
#include "model/triangle_shapes.h"
#include "model/vtk_sample.h"

static lar_triangles from_text(const char *text) {
    return good_surface(lar_obj_parse, text, strlen(text));
}

static void test_ways_to_write_a_cube(void **state) {
    (void)state;
    static const char *const corner[] = {"%d ", "%d/7 ", "%d/7/8 ", "%d//8 "};
    for (int way = 0; way < 4; way++)
        for (int negative = 0; negative < 2; negative++) {
            sample_file file = {0};
            print(&file, "# a cube\nmtllib x.mtl\no cube\r\ng sides\n\n");
            for (int v = 0; v < 8; v++)
                print(&file, "v %g %g \\\n %g%s\n", cube_point[v][0], cube_point[v][1],
                      cube_point[v][2], v % 2 ? " 0.5 0.5 1.0" : " 1");
            print(&file, "vt 0 0\nvn 0 0 1\ns off\nl 1 2\n");
            for (int q = 0; q < 6; q++) {
                print(&file, "f ");
                for (int a = 0; a < 4; a++) {
                    int number = negative ? cube_quad[q][a] - 8 : cube_quad[q][a] + 1;
                    char word[40];
                    snprintf(word, sizeof word, corner[way], number);
                    print(&file, "%s%s", word, a == 1 ? "\\\r\n" : "");
                }
                print(&file, " # side %d\n", q);
            }
            lar_triangles cube = good_surface(lar_obj_parse, file.data, file.size);
            check_surface(&cube, 8, 12, 8);
            assert_null(cube.tag);
            lar_triangles_clear(&cube);
            parse_all_beginnings(lar_obj_parse, file.data, file.size);
            free(file.data);
        }
}

/* A prism over a polygon of twelve corners; faces may stand before their vertices. */
static void test_polygons_of_any_size(void **state) {
    (void)state;
    enum { N = 12 };
    sample_file file = {0};
    print(&file, "f");
    for (int k = 0; k < N; k++) print(&file, " %d", N + k + 1);
    print(&file, "\nf");
    for (int k = N; k > 0; k--) print(&file, " %d", k);
    for (int k = 0; k < N; k++)
        print(&file, "\nf %d %d %d %d", k + 1, (k + 1) % N + 1, (k + 1) % N + N + 1, k + N + 1);
    for (int k = 0; k < 2 * N; k++)
        print(&file, "\nv %.17g %.17g %d", cos(SHAPE_PI * k / 6), sin(SHAPE_PI * k / 6), k >= N);
    lar_triangles prism = good_surface(lar_obj_parse, file.data, file.size);
    /* cos and sin of the second turn are rounded otherwise, by 1e-15 */
    check_surface(&prism, 2 * N, 2 * (N - 2) + 2 * N, 3);
    lar_error error;
    assert_int_equal(lar_triangles_close(&prism, NULL, &error), LAR_OK);
    lar_triangles_clear(&prism);
    free(file.data);
}

static void test_damage(void **state) {
    (void)state;
    static const struct {
        const char *text, *words;
    } rows[] = {
        {"v 0 0 0\nv 1 0\n", ":2: a vertex needs three finite numbers"},
        {"v 0 0 nan\n", ":1: a vertex needs three finite numbers"},
        {"v 0 0 0\nf 1 1 0\n", ":2: \"0\" is no corner"},
        {"v 0 0 0\nf 1 1 one\n", ":2: \"one\" is no corner"},
        {"v 0 0 0\nf 1 1 99999999999\n", ":2: \"99999999999\" is no corner"},
        {"v 0 0 0\nf 1 1 -2/1\n", ":2: the corner \"-2/1\" goes back beyond"},
        {"v 0 0 0\nf 1 1 1\nf 1 1 2\n", ":3: vertex 2 is named, but the file has 1"},
        {"v 0 0 0\nf 1 1\n", ":2: a polygon needs three corners"},
        {"v 0 0 0\n", "has no polygon"},
        {"\x89PNG\r\n", "has no polygon"},
        {"", "has no polygon"},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
        refused_surface(lar_obj_parse, rows[r].text, strlen(rows[r].text), rows[r].words);
    lar_triangles flat = from_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n\\\n\\");
    assert_int_equal(flat.triangle_count, 1);
    lar_triangles_clear(&flat);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ways_to_write_a_cube),
        cmocka_unit_test(test_polygons_of_any_size),
        cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
