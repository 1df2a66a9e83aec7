/* Surfaces: joining corners, volume and area, reading by extension, real files. */
#include "model/triangle_shapes.h"

#include <sys/stat.h>
#include <unistd.h>

static const double origin[3] = {0, 0, 0};

static void test_volume_and_area(void **state) {
    (void)state;
    lar_triangles body;
    shape_box_surface(&body, (double[]){1000, 2000, -500}, (double[]){1000.5, 2001, -498});
    assert_below(fabs(lar_triangles_volume(&body) - 1), 1e-10);
    assert_below(fabs(lar_triangles_area(&body) - 7), 1e-10);
    lar_triangles_clear(&body);
    shape_ellipsoid_surface(&body, (double[]){1, 2, 3}, origin, 60);
    assert_below(fabs(lar_triangles_volume(&body) / (8 * SHAPE_PI) - 1), 3e-3);
    lar_triangles_clear(&body);
    shape_torus_surface(&body, 3, 1, origin, 60);
    assert_below(fabs(lar_triangles_volume(&body) / (6 * SHAPE_PI * SHAPE_PI) - 1), 3e-3);
    assert_below(fabs(lar_triangles_area(&body) / (12 * SHAPE_PI * SHAPE_PI) - 1), 3e-3);
    lar_triangles_clear(&body);
    assert_true(lar_triangles_volume(&body) == 0 && lar_triangles_area(&body) == 0);
}

/* Every triangle with corners of its own, some of them at -0 instead of 0, and three that go. */
static void test_join(void **state) {
    (void)state;
    lar_triangles torus, loose;
    lar_error error;
    shape_torus_surface(&torus, 3, 1, origin, 12);
    int32_t count = torus.triangle_count;
    shape_surface_begin(&loose, 3 * count + 9, count + 3);
    loose.tag = lar_calloc((size_t)loose.triangle_count, sizeof *loose.tag);
    assert_non_null(loose.tag);
    for (int32_t t = 0; t < count + 3; t++) {
        int32_t from = t < 3 ? 5 : t - 3; /* the first three: a corner twice, in three ways */
        shape_triangle(&loose, t, 3 * t, 3 * t + 1, 3 * t + 2);
        loose.tag[t] = t;
        for (int a = 0; a < 3; a++)
            for (int i = 0; i < 3; i++) {
                double at = torus.vertex[torus.corner[from][a]][i];
                loose.vertex[3 * t + a][i] = at == 0 && t % 2 ? -0.0 : at;
            }
    }
    for (int way = 0; way < 3; way++) {
        int32_t first = 3 * way;
        memcpy(loose.vertex[first + way], loose.vertex[first + (way + 1) % 3],
               sizeof *loose.vertex);
    }
    assert_int_equal(lar_triangles_join(&loose, &error), LAR_OK);
    assert_int_equal(loose.triangle_count, count);
    assert_int_equal(loose.vertex_count, torus.vertex_count);
    assert_below(fabs(lar_triangles_volume(&loose) - lar_triangles_volume(&torus)), 1e-12);
    for (int32_t t = 0; t < count; t++) {
        assert_int_equal(loose.tag[t], t + 3);
        for (int a = 0; a < 3; a++)
            for (int i = 0; i < 3; i++)
                assert_true(loose.vertex[loose.corner[t][a]][i] ==
                            torus.vertex[torus.corner[t][a]][i]);
    }
    lar_triangles_clear(&loose);
    lar_triangles_clear(&torus);
    assert_int_equal(lar_triangles_join(&torus, &error), LAR_OK); /* nothing */
}

static const char *const path = LAR_TEST_BUILD "/test_triangles.OBJ";

static void write_text(const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static void refused(const char *name, double scale, const char *words) {
    lar_triangles triangles = {0};
    lar_error error = {0};
    assert_int_not_equal(lar_triangles_read(name, scale, &triangles, &error), LAR_OK);
    if (!strstr(error.message, words)) fail_msg("'%s' is not in: %s", words, error.message);
    assert_null(triangles.vertex);
    assert_null(triangles.source);
}

static void test_reading(void **state) {
    (void)state;
    write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 7 7 7\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    lar_triangles triangles = {0};
    lar_error error = {0};
    if (lar_triangles_read(path, 0.5, &triangles, &error)) fail_msg("%s", error.message);
    check_surface(&triangles, 4, 4, 0.125 / 6);
    assert_string_equal(triangles.source, path);
    lar_triangles_clear(&triangles);
    refused(path, 0, "the scale 0 is not a positive number");
    refused(path, NAN, "is not a positive number");
    refused(path, 1e31, "a coordinate of 1e+31 m, which no body has");
    refused("liver.msh", 1, "the known ones are .stl .obj .vtk .vtp");
    refused("nowhere.stl", 1, "nowhere.stl: cannot be opened");
    write_text("v 0 0 0\nv 1 0 0\nf 1 2 2\n");
    refused(path, 1, "no triangle with an area");
    unlink(path);
}

/* Figures of the data's own README. */
static void test_real_files(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int32_t triangles;
        double volume, tolerance;
        bool closed;
    } rows[] = {
        {"liver_female.stl", 33498, 2.135e-3, 5e-7, true},
        {"spleen_female.obj", 8544, 1.907e-4, 1e-7, true},
        {"uterus_posterior_wall.obj", 12022, 6.35e-6, 1e-8, true},
        {"coarse_liver.obj", 274, 36.57, 1e-2, true},
        {"open_sphere.stl", 285, 13.6, 0.1, false},
    };
    struct stat info;
    if (stat(LAR_TEST_SHARED "/data/surfaces", &info) != 0) {
        print_message("skipped: no shared data\n");
        skip();
    }
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        char name[512];
        snprintf(name, sizeof name, "%s/data/surfaces/%s", LAR_TEST_SHARED, rows[r].name);
        lar_triangles surface = {0};
        lar_error error = {0};
        if (lar_triangles_read(name, 1, &surface, &error)) fail_msg("%s", error.message);
        assert_int_equal(surface.triangle_count, rows[r].triangles);
        assert_below(fabs(lar_triangles_volume(&surface) - rows[r].volume), rows[r].tolerance);
        int32_t turned = -1;
        lar_status status = lar_triangles_close(&surface, &turned, &error);
        assert_int_equal(status, rows[r].closed ? LAR_OK : LAR_ERROR_MODEL);
        if (rows[r].closed)
            assert_int_equal(turned, 0);
        else
            assert_non_null(strstr(error.message, "open_sphere.stl: the surface is not closed: 9 "
                                                  "open edges, one at (1.5, 1.3"));
        lar_crossings crossings;
        assert_int_equal(lar_triangles_find_crossings(&surface, &crossings, &error), LAR_OK);
        assert_int_equal(crossings.deep, 0);
        assert_int_equal(crossings.shallow, 0);
        lar_triangles_clear(&surface);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_volume_and_area),
        cmocka_unit_test(test_join),
        cmocka_unit_test(test_reading),
        cmocka_unit_test(test_real_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
