/* Twin experiments: scenes of blocks, and what would be measured in them with the true parameters.
 */
#ifndef LAR_TESTS_STUDY_FIT_TWIN_H
#define LAR_TESTS_STUDY_FIT_TWIN_H

#include "testing.h"

#include "study/inverse/inverse.h"
#include "study/inverse/forward.h"

enum { TWIN_TEXT = 4096, TWIN_ROWS = 400 };

/* Of a group of tests: without cminpack nothing can be fitted. */
TEST_UNUSED static int twin_needs_cminpack(void **state) {
    (void)state;
    if (lar_inverse_available()) return 0;
    print_message("skipped: built without cminpack\n");
    exit(77);
}

/* A file of this program below the build folder: programs of tests run at the same time. */
TEST_UNUSED static const char *twin_path(const char *name) {
    static char path[8][512];
    static int next;
    const char *slash = strrchr(__BASE_FILE__, '/'), *program = slash ? slash + 1 : __BASE_FILE__;
    next = (next + 1) % 8;
    snprintf(path[next], sizeof path[next], "%s/%.*s_%s", LAR_TEST_BUILD,
             (int)strcspn(program, "."), program, name);
    return path[next];
}

TEST_UNUSED static void twin_write(const char *name, const char *text) {
    FILE *out = fopen(twin_path(name), "w");
    assert_non_null(out);
    fputs(text, out);
    assert_int_equal(fclose(out), 0);
}

/* A block of n[0] x n[1] x n[2] elements from the origin. */
TEST_UNUSED static void twin_block(const char *name, const int n[3], const double size[3]) {
    FILE *out = fopen(twin_path(name), "w");
    int x = n[0] + 1, xy = x * (n[1] + 1), count = n[0] * n[1] * n[2];
    assert_non_null(out);
    fprintf(out,
            "# vtk DataFile Version 3.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\n"
            "POINTS %d double\n",
            xy * (n[2] + 1));
    for (int k = 0; k <= n[2]; k++)
        for (int j = 0; j <= n[1]; j++)
            for (int i = 0; i <= n[0]; i++)
                fprintf(out, "%.12g %.12g %.12g\n", size[0] * i / n[0], size[1] * j / n[1],
                        size[2] * k / n[2]);
    fprintf(out, "CELLS %d %d\n", count, 9 * count);
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++)
            for (int i = 0; i < n[0]; i++) {
                int a = i + x * j + xy * k;
                fprintf(out, "8 %d %d %d %d %d %d %d %d\n", a, a + 1, a + 1 + x, a + x, a + xy,
                        a + 1 + xy, a + 1 + x + xy, a + x + xy);
            }
    fprintf(out, "CELL_TYPES %d\n", count);
    for (int i = 0; i < count; i++) fputs("12\n", out);
    assert_int_equal(fclose(out), 0);
}

TEST_UNUSED static void twin_read(const char *name, lar_inverse_problem *problem) {
    lar_error error = {0};
    *problem = (lar_inverse_problem){0};
    if (lar_inverse_problem_read(twin_path(name), problem, &error)) fail_msg("%s", error.message);
}

/* A scene with one material, gel, of all elements. */
TEST_UNUSED static void write_scene(const char *name, const char *mesh, const char *material,
                                    const char *more) {
    char text[TWIN_TEXT];
    snprintf(text, sizeof text,
             "lariat: 1\nmesh: %s\nmaterials: [ { cells: all, name: gel, %s } ]\n%s",
             twin_path(mesh), material, more);
    twin_write(name, text);
}

/* One experiment; `more` are further keys of it, after a comma. */
TEST_UNUSED static void write_fit(const char *name, const char *parameters, const char *kind,
                                  const char *scene, const char *data, const char *more) {
    char text[TWIN_TEXT];
    snprintf(text, sizeof text,
             "lariat-fit: 1\nparameters:\n%s\nexperiments:\n"
             "  - { kind: %s, scene: %s, data: %s%s }\n",
             parameters, kind, twin_path(scene), twin_path(data), more);
    twin_write(name, text);
}

/* A free parameter of gel. */
#define FREE(name, guess, low, high)                                                               \
    "  - { material: gel, parameter: " name ", guess: " guess ", bounds: [" low ", " high "] }\n"

/* What experiment 0 of this problem would measure with these parameters. */
TEST_UNUSED static void twin_measure(const char *name, const double *truth, double *measured) {
    lar_inverse_problem problem;
    lar_error error = {0};
    twin_read(name, &problem);
    assert_in_range(problem.experiment[0].values, 1, TWIN_ROWS);
    if (lar_inverse_forward(&problem, 0, truth, NULL, NULL, measured, &error))
        fail_msg("%s", error.message);
    lar_inverse_problem_clear(&problem);
}

TEST_UNUSED static void twin_fit(const char *name, lar_inverse_result *result) {
    lar_inverse_problem problem;
    lar_error error = {0};
    twin_read(name, &problem);
    if (lar_inverse_solve(&problem, NULL, result, &error)) fail_msg("%s", error.message);
    lar_inverse_problem_clear(&problem);
}

/* Normal numbers that are the same everywhere (Box and Muller over xorshift). */
TEST_UNUSED static double twin_noise(uint64_t *seed) {
    double u[2];
    for (int i = 0; i < 2; i++) {
        *seed ^= *seed << 13;
        *seed ^= *seed >> 7;
        *seed ^= *seed << 17;
        u[i] = ((double)(*seed >> 11) + 0.5) / 9007199254740992.0;
    }
    return sqrt(-2 * log(u[0])) * cos(6.28318530717958648 * u[1]);
}

#endif
