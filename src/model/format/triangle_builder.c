#include "model/format/triangle_builder.h"

static lar_status too_many(const lar_triangle_builder *builder, const char *what) {
    return lar_fail(builder->error, LAR_ERROR_UNSUPPORTED,
                    "%s: more %s than 32-bit indices can name; make the surface coarser",
                    builder->path, what);
}

lar_status lar_triangle_builder_vertex(lar_triangle_builder *builder, const double at[3]) {
    lar_triangles *to = builder->triangles;
    if (to->vertex_count == INT32_MAX) return too_many(builder, "vertices");
    if (!LAR_GROW(to->vertex, builder->vertex_capacity, to->vertex_count))
        return lar_fail_memory(builder->error, sizeof *to->vertex * (size_t)to->vertex_count,
                               builder->path);
    for (int i = 0; i < 3; i++) to->vertex[to->vertex_count][i] = at[i];
    to->vertex_count++;
    return LAR_OK;
}

lar_status lar_triangle_builder_polygon(lar_triangle_builder *builder, const int32_t *corner,
                                        size_t count) {
    lar_triangles *to = builder->triangles;
    for (size_t k = 2; k < count; k++) {
        int32_t t = to->triangle_count;
        if (t == INT32_MAX) return too_many(builder, "triangles");
        if (!LAR_GROW(to->corner, builder->corner_capacity, t) ||
            (builder->tagged && !LAR_GROW(to->tag, builder->tag_capacity, t)))
            return lar_fail_memory(builder->error, sizeof *to->corner * (size_t)t, builder->path);
        to->corner[t][0] = corner[0];
        to->corner[t][1] = corner[k - 1];
        to->corner[t][2] = corner[k];
        if (builder->tagged) to->tag[t] = builder->tag;
        to->triangle_count++;
    }
    return LAR_OK;
}
