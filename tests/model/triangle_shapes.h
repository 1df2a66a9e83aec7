/* Small helpers for tests of surfaces; the shapes themselves are in meshing/shapes.h. */
#ifndef LAR_TESTS_MODEL_TRIANGLE_SHAPES_H
#define LAR_TESTS_MODEL_TRIANGLE_SHAPES_H

#include "base/vector.h"
#include "meshing/shapes.h"

/* Numbers that look random, the same ones everywhere. */
static TEST_UNUSED double shape_random(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-53;
}

/* Both in one surface; they are cleared. */
static TEST_UNUSED lar_triangles shape_both(lar_triangles *a, lar_triangles *b) {
    lar_triangles both;
    shape_surface_begin(&both, a->vertex_count + b->vertex_count,
                        a->triangle_count + b->triangle_count);
    memcpy(both.vertex, a->vertex, (size_t)a->vertex_count * sizeof *a->vertex);
    memcpy(both.vertex + a->vertex_count, b->vertex, (size_t)b->vertex_count * sizeof *b->vertex);
    for (int32_t t = 0; t < both.triangle_count; t++)
        for (int i = 0; i < 3; i++)
            both.corner[t][i] = t < a->triangle_count
                                    ? a->corner[t][i]
                                    : b->corner[t - a->triangle_count][i] + a->vertex_count;
    lar_triangles_clear(a);
    lar_triangles_clear(b);
    return both;
}

/* ---- files ---------------------------------------------------------------------------------- */

typedef lar_status (*surface_parser)(const char *path, const lar_bytes *bytes,
                                     lar_triangles *triangles, lar_error *error);

/* Parses a copy of exactly `size` bytes, so that a sanitizer sees every byte read beyond. */
static TEST_UNUSED lar_status parse_surface(surface_parser parse, const void *data, size_t size,
                                            lar_triangles *triangles, lar_error *error) {
    lar_bytes bytes = {malloc(size + 1), size};
    assert_non_null(bytes.data);
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    *triangles = (lar_triangles){0};
    *error = (lar_error){0};
    lar_status status = parse("test.file", &bytes, triangles, error);
    lar_bytes_free(&bytes);
    return status;
}

/* Joined. */
static TEST_UNUSED lar_triangles good_surface(surface_parser parse, const void *data, size_t size) {
    lar_triangles triangles;
    lar_error error;
    if (parse_surface(parse, data, size, &triangles, &error))
        fail_msg("refused: %s", error.message);
    assert_int_equal(lar_triangles_join(&triangles, &error), LAR_OK);
    return triangles;
}

static TEST_UNUSED void check_surface(const lar_triangles *s, int32_t vertices, int32_t triangles,
                                      double volume) {
    assert_int_equal(s->vertex_count, vertices);
    assert_int_equal(s->triangle_count, triangles);
    assert_below(fabs(lar_triangles_volume(s) - volume), 1e-6 * fabs(volume));
}

/* Refused with a message that has these words in it. */
static TEST_UNUSED void refused_surface(surface_parser parse, const void *data, size_t size,
                                        const char *words) {
    lar_triangles triangles;
    lar_error error;
    lar_status status = parse_surface(parse, data, size, &triangles, &error);
    lar_triangles_clear(&triangles);
    if (!status) fail_msg("taken, but should be refused with '%s'", words);
    if (!strstr(error.message, words)) fail_msg("'%s' is not in: %s", words, error.message);
    assert_non_null(strstr(error.message, "test.file"));
}

/* Cut short anywhere a file is read or refused, within its bytes. */
static TEST_UNUSED void parse_all_beginnings(surface_parser parse, const void *data, size_t size) {
    for (size_t length = 0; length < size; length++) {
        lar_triangles triangles;
        lar_error error;
        parse_surface(parse, data, length, &triangles, &error);
        lar_triangles_clear(&triangles);
    }
}

/* A cube of edge 2 as six quads, seen from outside. */
static const double cube_point[8][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0},
                                        {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}};
static const int cube_quad[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                    {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

#endif
