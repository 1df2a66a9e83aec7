/* A surface that grows while a file is read: vertices, and polygons cut into triangles. */
#ifndef LAR_MODEL_FORMAT_TRIANGLE_BUILDER_H
#define LAR_MODEL_FORMAT_TRIANGLE_BUILDER_H

#include <stddef.h>

#include "model/triangles/triangles.h"

typedef struct lar_triangle_builder {
    const char *path; /* for messages */
    lar_error *error;
    lar_triangles *triangles; /* being filled; its counts are always right */
    size_t vertex_capacity, corner_capacity, tag_capacity;
    int32_t tag; /* of the triangles to come */
    bool tagged; /* triangles have tags; set before the first one */
} lar_triangle_builder;

lar_status lar_triangle_builder_vertex(lar_triangle_builder *builder, const double at[3]);

/* A fan of triangles from the first corner; polygons of less than three corners have none. Corners
 * are indices of vertices, which the caller checks. */
lar_status lar_triangle_builder_polygon(lar_triangle_builder *builder, const int32_t *corner,
                                        size_t count);

#endif
