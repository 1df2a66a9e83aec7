/* How good a mesh is, and how well it stands for a true surface. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "meshing/fit/crossing.h"
#include "meshing/deviation.h"
#include "meshing/meshing.h"
#include "model/model.h"

static double volume(const lar_mesh *mesh) {
    double sum = 0, corner[8][3];
    for (int32_t e = 0; e < mesh->element_count; e++) {
        lar_mesh_corners(mesh, e, corner);
        sum += lar_hexahedron_volume(corner);
    }
    return sum;
}

static lar_status measure_deviation(const lar_mesh *mesh, const int32_t *face, int32_t count,
                                    const lar_triangles *surface, lar_mesh_quality *quality,
                                    lar_error *error) {
    lar_deviation deviation;
    lar_status status = lar_deviation_measure(mesh, face, count, surface, &deviation, error);
    if (status) return status;
    quality->deviation_mean = deviation.mean;
    quality->deviation_95 = deviation.max_95;
    quality->deviation_max = deviation.hausdorff;
    return LAR_OK;
}

static lar_status count_crossings(const lar_mesh *mesh, const int32_t *face, int32_t count,
                                  lar_mesh_quality *quality, lar_error *error) {
    lar_face_crossings found = {0};
    int32_t(*node)[4] = lar_calloc((size_t)count, sizeof *node);
    if (!node) return lar_fail_memory(error, (size_t)count * sizeof *node, "the outer faces");
    for (int32_t f = 0; f < count; f++)
        for (int a = 0; a < 4; a++)
            node[f][a] = mesh->element[face[f] / 6][lar_face_node[face[f] % 6][a]];
    lar_status status =
        lar_faces_find_crossings((const double(*)[3])mesh->position, (const int32_t(*)[4])node,
                                 count, 0, NULL, NULL, &found, error);
    free(node);
    quality->crossings = found.pairs;
    quality->crossing_depth = found.deepest;
    return status;
}

lar_status lar_quality_measure(const lar_mesh *mesh, const lar_triangles *surface,
                               lar_mesh_quality *quality, lar_error *error) {
    lar_jacobians jacobians;
    lar_jacobians_count(mesh, &jacobians);
    memcpy(quality->jacobian_bin, jacobians.bin, sizeof quality->jacobian_bin);
    quality->above_02 = jacobians.above_02;
    quality->above_05 = jacobians.above_05;
    quality->mean_edge = lar_mesh_mean_edge(mesh);
    quality->volume = volume(mesh);
    int32_t *face = NULL, count = 0;
    lar_status status = lar_mesh_boundary(mesh, &face, &count, error);
    if (!status) status = count_crossings(mesh, face, count, quality, error);
    if (!status && surface) status = measure_deviation(mesh, face, count, surface, quality, error);
    free(face);
    return status;
}

/* ---- of a model --------------------------------------------------------------------------- */

/* A copy of the embedded surface: closing it may turn triangles. */
static lar_status copy_embedded(const lar_embedded_info *embedded, lar_triangles *copy,
                                lar_error *error) {
    size_t vertices = (size_t)embedded->vertices, triangles = (size_t)embedded->triangles;
    copy->vertex = lar_calloc(vertices, sizeof *copy->vertex);
    copy->corner = lar_calloc(triangles, sizeof *copy->corner);
    if (!copy->vertex || !copy->corner)
        return lar_fail_memory(error, vertices * sizeof *copy->vertex, "the embedded surface");
    memcpy(copy->vertex, embedded->rest, vertices * sizeof *copy->vertex);
    memcpy(copy->corner, embedded->triangle, triangles * sizeof *copy->corner);
    copy->vertex_count = embedded->vertices;
    copy->triangle_count = embedded->triangles;
    return LAR_OK;
}

lar_status lar_model_quality(const lar_model *model, const char *against, double scale,
                             lar_mesh_quality *quality, lar_error *error) {
    if (!model || !quality)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_model_quality needs a model and a place for what it finds; neither "
                        "may be NULL");
    if (against && !(scale > 0 && isfinite(scale)))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_model_quality: a scale of %g makes no surface; give metres per unit "
                        "of the file, 1 when it is in metres",
                        scale);
    lar_mesh_quality made = {0};
    lar_triangles surface = {0};
    lar_embedded_info embedded;
    lar_status status = LAR_OK;
    if (against)
        status = lar_triangles_read(against, scale, &surface, error);
    else if (lar_model_embedded(model, &embedded))
        status = copy_embedded(&embedded, &surface, error);
    bool compared = surface.triangle_count > 0;
    /* An open surface has no volume, but a distance. */
    if (!status && compared && !lar_triangles_close(&surface, NULL, NULL))
        made.true_volume = lar_triangles_volume(&surface);
    if (!status)
        status = lar_quality_measure(&model->mesh, compared ? &surface : NULL, &made, error);
    lar_triangles_clear(&surface);
    if (!status) *quality = made;
    return status;
}
