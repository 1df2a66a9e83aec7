/* The key `fibres` of a material. */
#include "model/scene/scene.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"

/* Their parameters, in the order of lar_fibre.parameter. */
static const char *const *const law_names = lar_fibre_law_name + LAR_FIBRE_EXP_POW;
static const char *const parameter_names[][LAR_FIBRE_PARAMETERS] = {{"ksi", "alpha", "beta", NULL},
                                                                    {"c3", "c4", "c5", "lam_max"}};
enum { LAWS = LAR_FIBRE_LAWS - LAR_FIBRE_EXP_POW };

static lar_status read_law(const lar_scene *scene, const lar_yaml *node, lar_fibre *fibre) {
    for (int i = 0; i < LAWS; i++)
        if (lar_scene_is_word(node, law_names[i])) {
            fibre->law = (lar_fibre_law)(LAR_FIBRE_EXP_POW + i);
            return LAR_OK;
        }
    return lar_scene_unknown(scene, node, LAR_ERROR_FORMAT, "the law of fibres", "the laws are",
                             law_names, LAWS);
}

static lar_status read_part(const lar_scene *scene, const lar_yaml *node, bool *isochoric) {
    static const char *const names[] = {"isochoric", "whole"};
    *isochoric = lar_scene_is_word(node, names[0]);
    if (*isochoric || lar_scene_is_word(node, names[1])) return LAR_OK;
    return lar_scene_unknown(scene, node, LAR_ERROR_FORMAT, "the part of the stretch",
                             "the parts are", names, 2);
}

/* Every parameter of the law, and none of another. */
static lar_status read_parameters(const lar_scene *scene, const lar_yaml *node, lar_fibre *fibre) {
    lar_status status = LAR_OK;
    for (int law = 0; law < LAWS && !status; law++)
        for (int k = 0; k < LAR_FIBRE_PARAMETERS && !status; k++) {
            const char *name = parameter_names[law][k];
            const lar_yaml *value = name ? lar_yaml_get(node, name) : NULL;
            bool own = (int)fibre->law == LAR_FIBRE_EXP_POW + law;
            if (own && name && !value)
                return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                                      "fibres of the law %s need %s; add it", law_names[law], name);
            if (!own && value)
                return lar_scene_fail(scene, value, LAR_ERROR_FORMAT,
                                      "%s is no parameter of the law %s; remove it", name,
                                      fibre->law ? lar_fibre_law_name[fibre->law] : "none");
            if (!value) continue;
            const char *what = lar_fibre_scales(fibre->law, k)
                                   ? LAR_IN_PASCAL
                                   : "a number without a unit, for example 2";
            status = lar_scene_not_negative(scene, value, what, &fibre->parameter[k]);
        }
    return status;
}

lar_status lar_scene_read_fibres(const lar_scene *scene, const lar_yaml *node,
                                 lar_material *material) {
    static const char *const keys[] = {"law",  "part", "direction", "active", "ksi",     "alpha",
                                       "beta", "c3",   "c4",        "c5",     "lam_max", NULL};
    static const char what[] = "fibres";
    const lar_yaml *law = NULL, *part = NULL, *direction = NULL;
    lar_fibre *fibre = &material->fibre;
    lar_status status = lar_scene_keys(scene, node, what, keys);
    const lar_yaml *active = status ? NULL : lar_yaml_get(node, "active");
    bool passive = !active || lar_yaml_get(node, "law") || lar_yaml_get(node, "part");
    if (!status && passive) status = lar_scene_need(scene, node, what, "law", "law: exp-pow", &law);
    if (!status && passive)
        status = lar_scene_need(scene, node, what, "part", "part: isochoric", &part);
    if (!status)
        status = lar_scene_need(scene, node, what, "direction", "direction: {axis: [1, 0, 0]}",
                                &direction);
    if (!status && passive) status = read_law(scene, law, fibre);
    if (!status && passive) status = read_part(scene, part, &fibre->isochoric);
    fibre->line = node->line;
    if (!status && active) status = lar_scene_read_active(scene, active, material);
    return status ? status : read_parameters(scene, node, fibre);
}

/* ---- directions ----------------------------------------------------------------------------- */

/* Around a line: along axis x (centre - point), 0 on the line itself. */
typedef struct circle {
    double point[3], axis[3];
} circle;

static lar_status read_circle(const lar_scene *scene, const lar_yaml *node, circle *around) {
    static const char *const keys[] = {"point", "axis", NULL}, what[] = "around";
    const lar_yaml *point = NULL, *axis = NULL;
    lar_status status = lar_scene_keys(scene, node, what, keys);
    if (!status) status = lar_scene_need(scene, node, what, "point", "point: [0, 0, 0.01]", &point);
    if (!status) status = lar_scene_need(scene, node, what, "axis", "axis: [0, 0, 1]", &axis);
    if (!status) status = lar_scene_vector(scene, point, LAR_IN_POSITION, around->point);
    return status ? status : lar_scene_direction(scene, axis, around->axis);
}

static void turn_around(const lar_mesh *mesh, const circle *around, double size, int32_t e,
                        double out[3]) {
    double from[3] = {0};
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) from[i] += mesh->position[mesh->element[e][a]][i] / 8;
    lar_minus(from, around->point, from);
    lar_cross(around->axis, from, out);
    if (!(lar_dot(out, out) > 1e-18 * size * size)) memset(out, 0, 3 * sizeof *out);
}

lar_status lar_scene_lay_fibres(lar_scene *scene, const lar_yaml *node, int material) {
    static const char *const keys[] = {"axis", "around", NULL};
    lar_mesh *mesh = &scene->model->mesh;
    const lar_yaml *rule = lar_yaml_get(node, "direction");
    if (lar_scene_is_word(rule, "mesh")) {
        if (mesh->fibre) return LAR_OK;
        return lar_scene_fail(scene, rule, LAR_ERROR_MODEL,
                              "direction: mesh, but no mesh has directions; they stand in a .vtu "
                              "file as a cell array \"fibre\" of three components, or in the "
                              "arrays of lar_model_from_arrays");
    }
    lar_status status = lar_scene_keys(scene, rule, "direction", keys);
    const lar_yaml *axis = status ? NULL : lar_yaml_get(rule, "axis");
    const lar_yaml *around = status ? NULL : lar_yaml_get(rule, "around");
    double along[3] = {0};
    circle round = {{0}, {0}};
    if (!status && !axis == !around)
        return lar_scene_fail(scene, rule, LAR_ERROR_FORMAT,
                              "direction: expected mesh, {axis: [x, y, z]} or {around: {point: [x, "
                              "y, z], axis: [x, y, z]}}");
    if (!status && axis) status = lar_scene_direction(scene, axis, along);
    if (!status && around) status = read_circle(scene, around, &round);
    if (status) return status;
    size_t elements = (size_t)mesh->element_count;
    if (!mesh->fibre) mesh->fibre = lar_calloc(elements, sizeof *mesh->fibre);
    if (!mesh->fibre) return lar_scene_no_memory(scene, elements * sizeof *mesh->fibre);
    for (int32_t e = 0; e < mesh->element_count; e++) {
        if (scene->model->element_material[e] != material) continue;
        if (axis)
            memcpy(mesh->fibre[e], along, sizeof along);
        else
            turn_around(mesh, &round, scene->size, e, mesh->fibre[e]);
    }
    return LAR_OK;
}
