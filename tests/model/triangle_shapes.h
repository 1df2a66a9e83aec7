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

#endif
