/* Surfaces of triangles whose volume and topology are known. */
#ifndef LAR_TESTS_MODEL_TRIANGLE_SHAPES_H
#define LAR_TESTS_MODEL_TRIANGLE_SHAPES_H

#include "testing.h"

#include "base/vector.h"
#include "model/triangles.h"

/* Numbers that look random, the same ones everywhere. */
static TEST_UNUSED double shape_random(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-53;
}

static TEST_UNUSED lar_triangles shape_empty(int32_t vertices, int32_t triangles) {
    lar_triangles made = {.vertex_count = vertices, .triangle_count = triangles};
    made.vertex = lar_calloc((size_t)vertices, sizeof *made.vertex);
    made.corner = lar_calloc((size_t)triangles, sizeof *made.corner);
    assert_non_null(made.vertex);
    assert_non_null(made.corner);
    return made;
}

static TEST_UNUSED void shape_set(lar_triangles *shape, int32_t triangle, int32_t a, int32_t b,
                                  int32_t c) {
    shape->corner[triangle][0] = a, shape->corner[triangle][1] = b, shape->corner[triangle][2] = c;
}

/* A ball cut along `rings` circles of latitude and 2 `rings` meridians. */
static TEST_UNUSED lar_triangles shape_ball(const double centre[3], double radius, int rings) {
    const double pi = 3.14159265358979323846;
    int around = 2 * rings;
    lar_triangles ball = shape_empty((rings - 1) * around + 2, 2 * around * (rings - 1));
    int32_t south = ball.vertex_count - 2, north = south + 1, triangle = 0;
    for (int r = 1; r < rings; r++)
        for (int k = 0; k < around; k++) {
            double *at = ball.vertex[(r - 1) * around + k];
            double polar = pi * r / rings, turn = 2 * pi * k / around;
            at[0] = radius * sin(polar) * cos(turn);
            at[1] = radius * sin(polar) * sin(turn);
            at[2] = -radius * cos(polar);
        }
    ball.vertex[south][2] = -radius;
    ball.vertex[north][2] = radius;
    for (int32_t v = 0; v < ball.vertex_count; v++)
        for (int i = 0; i < 3; i++) ball.vertex[v][i] += centre[i];
    for (int k = 0; k < around; k++) {
        int next = (k + 1) % around, top = (rings - 2) * around;
        shape_set(&ball, triangle++, south, next, k);
        shape_set(&ball, triangle++, north, top + k, top + next);
        for (int r = 0; r < rings - 2; r++) {
            int32_t low = r * around, high = low + around;
            shape_set(&ball, triangle++, low + k, low + next, high + next);
            shape_set(&ball, triangle++, low + k, high + next, high + k);
        }
    }
    assert_int_equal(triangle, ball.triangle_count);
    return ball;
}

/* A torus about the z axis: tube of `thin` around a circle of `wide`; `steps` around the axis, half
 * of it around the tube. */
static TEST_UNUSED lar_triangles shape_torus(double wide, double thin, int steps) {
    const double pi = 3.14159265358979323846;
    int tube = steps / 2;
    lar_triangles torus = shape_empty(steps * tube, 2 * steps * tube);
    for (int i = 0; i < steps; i++)
        for (int k = 0; k < tube; k++) {
            double *at = torus.vertex[i * tube + k];
            double turn = 2 * pi * i / steps, roll = 2 * pi * k / tube;
            at[0] = (wide + thin * cos(roll)) * cos(turn);
            at[1] = (wide + thin * cos(roll)) * sin(turn);
            at[2] = thin * sin(roll);
            int32_t a = i * tube + k, b = (i + 1) % steps * tube + k;
            int32_t c = (i + 1) % steps * tube + (k + 1) % tube, d = i * tube + (k + 1) % tube;
            shape_set(&torus, 2 * a, a, b, c);
            shape_set(&torus, 2 * a + 1, a, c, d);
        }
    return torus;
}

/* Both in one surface; they are cleared. */
static TEST_UNUSED lar_triangles shape_both(lar_triangles *a, lar_triangles *b) {
    lar_triangles both =
        shape_empty(a->vertex_count + b->vertex_count, a->triangle_count + b->triangle_count);
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

#endif
