#include "step/domain.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "mechanics/stress.h"
#include "step/mass_scaling.h"

/* What a law gives as energy where there is none: strains here are so small that all is rounding.
 * The most that some of them give [J/m^3]. */
static double rounding_of(const lar_material *material) {
    static const double STRAIN = 1e-12;
    enum { STRAINS = 64 };
    double max = 0;
    for (int k = 0; k < STRAINS; k++) {
        double F[3][3];
        for (int i = 0; i < 9; i++) {
            int some = (37 * k + 11 * i * (k + 1)) % 101 - 50;
            F[i / 3][i % 3] = (i % 4 == 0) + STRAIN * some / 50;
        }
        max = fmax(max, fabs(lar_law_energy(material, (const double(*)[3])F)));
    }
    return max;
}

static lar_status inspect_rounding(const lar_model *model, double *sum, lar_error *error) {
    size_t count = (size_t)model->material_count;
    double *of = lar_calloc(count, sizeof *of);
    if (!of) return lar_fail_memory(error, count * sizeof *of, "the materials");
    for (size_t m = 0; m < count; m++) of[m] = rounding_of(&model->material[m]);
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(&model->mesh, e, corner);
        *sum += lar_hexahedron_volume(corner) * of[model->element_material[e]];
    }
    free(of);
    return LAR_OK;
}

static void inspect_elements(const lar_model *model, lar_model_info *info) {
    info->shortest_edge = DBL_MAX;
    info->scaled_jacobian_min = DBL_MAX;
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(&model->mesh, e, corner);
        double volume = lar_hexahedron_volume(corner), quality = lar_scaled_jacobian(corner);
        info->volume += volume;
        info->mass += volume * lar_model_material_of(model, e)->density;
        info->scaled_jacobian_mean += quality / model->mesh.element_count;
        if (quality < info->scaled_jacobian_min) {
            info->scaled_jacobian_min = quality;
            info->scaled_jacobian_worst = e;
        }
        for (int k = 0; k < 12; k++) {
            double square = 0;
            for (int i = 0; i < 3; i++) {
                double d = corner[lar_edge_node[k][0]][i] - corner[lar_edge_node[k][1]][i];
                square += d * d;
            }
            info->shortest_edge = fmin(info->shortest_edge, sqrt(square));
        }
    }
}

/* Faces of one element stand together in the surface, and opposite ones differ in the last bit. */
static int32_t count_thin_elements(const lar_surface *surface) {
    int32_t count = 0, last = -1;
    for (int32_t k = 0; k + 1 < surface->face_count; k++) {
        int32_t face = surface->face[k];
        if (face % 2 != 0 || surface->face[k + 1] != face + 1 || face / 6 == last) continue;
        last = face / 6;
        count++;
    }
    return count;
}

static lar_status count_fixed_nodes(const lar_model *model, int32_t *count, lar_error *error) {
    unsigned char *held = lar_calloc((size_t)model->mesh.node_count, 1);
    if (!held) return lar_fail_memory(error, (size_t)model->mesh.node_count, "a node mark");
    for (int i = 0; i < model->fix_count + model->move_count; i++) {
        const lar_node_list *nodes =
            i < model->fix_count ? &model->fix[i].nodes : &model->move[i - model->fix_count].nodes;
        for (int32_t k = 0; k < nodes->count; k++) {
            *count += !held[nodes->node[k]];
            held[nodes->node[k]] = 1;
        }
    }
    free(held);
    return LAR_OK;
}

static lar_status inspect_step(const lar_model *model, lar_model_info *info, lar_error *error) {
    size_t bytes = (size_t)model->mesh.element_count * sizeof(lar_element_rate);
    lar_element_rate *rate = lar_calloc(bytes, 1);
    lar_step_bound bound;
    if (!rate) return lar_fail_memory(error, bytes, "the elements");
    lar_status status = lar_step_bound_find(model, LAR_ELEMENT_HEX8, rate, &bound, error);
    if (!status) status = lar_mass_scaling_check(model, rate, &bound, error);
    info->stable_step = bound.step;
    info->stable_worst = bound.worst;
    if (!status)
        status = lar_mass_scaling_tell(model, rate, &bound, info, &info->mass_scaling, error);
    free(rate);
    return status;
}

lar_status lar_model_inspect(const lar_model *model, lar_model_info *info, lar_error *error) {
    if (!model || !info)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_model_inspect needs a model and a place for what it finds; neither "
                        "may be NULL");
    lar_model_info made = {.title = model->title ? model->title : "",
                           .nodes = model->mesh.node_count,
                           .elements = model->mesh.element_count,
                           .materials = model->material_count,
                           .duration = model->duration};
    for (int i = 0; i < 3; i++) {
        made.lower[i] = DBL_MAX;
        made.upper[i] = -DBL_MAX;
        for (int32_t n = 0; n < model->mesh.node_count; n++) {
            made.lower[i] = fmin(made.lower[i], model->mesh.position[n][i]);
            made.upper[i] = fmax(made.upper[i], model->mesh.position[n][i]);
        }
    }
    inspect_elements(model, &made);
    for (int i = 0; i < model->spring_count; i++) {
        const lar_spring_bed *bed = &model->spring[i];
        made.spring_nodes += bed->nodes.count;
        for (int32_t k = 0; k < bed->nodes.count; k++) made.spring_stiffness += bed->stiffness[k];
    }
    made.thin_elements = count_thin_elements(&model->surface);
    lar_status status = count_fixed_nodes(model, &made.fixed_nodes, error);
    if (!status) status = inspect_rounding(model, &made.rounding, error);
    if (!status) status = inspect_step(model, &made, error);
    if (status) return status;
    made.time_step =
        model->time_step > 0 ? model->time_step : lar_auto_step(model, made.stable_step);
    *info = made;
    return LAR_OK;
}
