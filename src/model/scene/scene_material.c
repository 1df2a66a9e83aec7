#include "model/scene/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The ways to say the stiffness: with the law's own parameters, in the order of material.h, or
 * with two moduli that every law knows. */
typedef struct stiffness_form {
    const char *key[LAR_LAW_PARAMETERS + 1]; /* ends with NULL */
} stiffness_form;

static const stiffness_form own_form[LAR_LAW_COUNT] = {
    [LAR_LAW_neo_hookean] = {{"shear_modulus", "bulk_modulus"}},
    [LAR_LAW_coupled_neo_hookean] = {{"mu", "lambda"}},
    [LAR_LAW_mooney_rivlin] = {{"c1", "c2", "bulk_modulus"}}};
static const stiffness_form shear_bulk_form = {{"shear_modulus", "bulk_modulus"}};
static const stiffness_form young_form = {{"youngs_modulus", "poisson_ratio"}};

static const char *const stiffness_key[] = {"shear_modulus",
                                            "bulk_modulus",
                                            "youngs_modulus",
                                            "poisson_ratio",
                                            "mu",
                                            "lambda",
                                            "c1",
                                            "c2",
                                            NULL};
static const char *const material_key[] = {"cells",
                                           "law",
                                           "density",
                                           "name",
                                           "shear_modulus",
                                           "bulk_modulus",
                                           "youngs_modulus",
                                           "poisson_ratio",
                                           "mu",
                                           "lambda",
                                           "c1",
                                           "c2",
                                           NULL};

/* True when the entry has exactly the form's stiffness keys. */
static bool has_form(const lar_yaml *node, const stiffness_form *form) {
    int wanted = 0, present = 0;
    for (; form->key[wanted]; wanted++)
        if (!lar_yaml_get(node, form->key[wanted])) return false;
    for (int i = 0; stiffness_key[i]; i++) present += lar_yaml_get(node, stiffness_key[i]) != NULL;
    return present == wanted;
}

static lar_status no_form(const lar_scene *scene, const lar_yaml *node, lar_law law) {
    const stiffness_form *own = &own_form[law];
    char also[64] = "";
    if (law != LAR_LAW_neo_hookean)
        snprintf(also, sizeof also, ", or %s%s%s%s%s", own->key[0], own->key[2] ? ", " : " and ",
                 own->key[1], own->key[2] ? " and " : "", own->key[2] ? own->key[2] : "");
    return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                          "a material of the law %s needs either shear_modulus and bulk_modulus, "
                          "or youngs_modulus and poisson_ratio%s, and nothing besides",
                          lar_law_name[law], also);
}

/* lambda and c2 may be negative or zero as long as the moduli that follow are positive. */
static bool may_be_negative(const char *key) {
    return strcmp(key, "lambda") == 0 || strcmp(key, "c1") == 0 || strcmp(key, "c2") == 0;
}

static lar_status read_numbers(const lar_scene *scene, const lar_yaml *node,
                               const stiffness_form *form, double value[LAR_LAW_PARAMETERS]) {
    lar_status status = LAR_OK;
    for (int i = 0; !status && form->key[i]; i++) {
        const lar_yaml *number = lar_yaml_get(node, form->key[i]);
        status = may_be_negative(form->key[i])
                     ? lar_scene_number(scene, number, LAR_IN_PASCAL, &value[i])
                     : lar_scene_positive(scene, number, LAR_IN_PASCAL, &value[i]);
    }
    return status;
}

static lar_status read_young(const lar_scene *scene, const lar_yaml *node, lar_material *material) {
    const lar_yaml *ratio_node = lar_yaml_get(node, "poisson_ratio");
    double young, ratio;
    lar_status status =
        lar_scene_positive(scene, lar_yaml_get(node, "youngs_modulus"), LAR_IN_PASCAL, &young);
    if (!status)
        status = lar_scene_number(scene, ratio_node,
                                  "a number between -1 and 0.5, for example 0.49", &ratio);
    if (status) return status;
    if (!(ratio > -1.0 && ratio < 0.5))
        return lar_scene_fail(scene, ratio_node, LAR_ERROR_MODEL,
                              "poisson_ratio is %.40s; it must lie between -1 and 0.5, exclusive: "
                              "nearly incompressible tissue has 0.49 to 0.499",
                              ratio_node->text);
    lar_material_from_young(material, young, ratio);
    return LAR_OK;
}

static lar_status read_stiffness(const lar_scene *scene, const lar_yaml *node,
                                 lar_material *material) {
    if (has_form(node, &young_form)) return read_young(scene, node, material);
    double value[LAR_LAW_PARAMETERS] = {0};
    lar_status status;
    if (has_form(node, &own_form[material->law])) {
        status = read_numbers(scene, node, &own_form[material->law], value);
        memcpy(material->parameter, value, sizeof value);
    } else if (has_form(node, &shear_bulk_form)) {
        status = read_numbers(scene, node, &shear_bulk_form, value);
        lar_material_from_shear_bulk(material, value[0], value[1]);
    } else {
        return no_form(scene, node, material->law);
    }
    return status;
}

static lar_status read_law(const lar_scene *scene, const lar_yaml *node, lar_law *law) {
    const char *name;
    lar_status status =
        lar_scene_text(scene, node, "the name of a law, for example neo-hookean", &name);
    if (status) return status;
    for (int i = 0; i < LAR_LAW_COUNT; i++)
        if (strcmp(name, lar_law_name[i]) == 0) {
            *law = (lar_law)i;
            return LAR_OK;
        }
    return lar_scene_unknown(scene, node, LAR_ERROR_MODEL, "the law", "the laws are", lar_law_name,
                             LAR_LAW_COUNT);
}

static lar_status assign(lar_scene *scene, const lar_yaml *cells, int material) {
    int32_t *index, count;
    lar_status status = lar_scene_select(scene, cells, LAR_SET_ELEMENTS, true, &index, &count);
    if (status) return status;
    for (int32_t i = 0; i < count; i++) scene->model->element_material[index[i]] = material;
    free(index);
    return LAR_OK;
}

static lar_status read_material(lar_scene *scene, const lar_yaml *node) {
    const char *const what = "a material", *name;
    const lar_yaml *cells = NULL, *law = NULL, *density = NULL;
    lar_status status = lar_scene_keys(scene, node, what, material_key);
    if (!status) status = lar_scene_need(scene, node, what, "cells", "cells: all", &cells);
    if (!status) status = lar_scene_need(scene, node, what, "law", "law: neo-hookean", &law);
    if (!status) status = lar_scene_need(scene, node, what, "density", "density: 1050", &density);
    if (status) return status;
    lar_material *material = LAR_MODEL_APPEND(scene->model, material);
    if (!material) return lar_scene_no_memory(scene, sizeof *material);
    const lar_yaml *name_node = lar_yaml_get(node, "name");
    if (name_node) {
        status = lar_scene_text(scene, name_node, "a name", &name);
        if (status) return status;
        material->name = lar_strdup(name);
        if (!material->name) return lar_scene_no_memory(scene, strlen(name) + 1);
    }
    status = read_law(scene, law, &material->law);
    if (!status) status = lar_scene_positive(scene, density, LAR_IN_DENSITY, &material->density);
    if (!status) status = read_stiffness(scene, node, material);
    if (status) return status;
    char where[512];
    snprintf(where, sizeof where, "%s:%d:%d", scene->path, node->line, node->column);
    status = lar_material_check(material, where, scene->error);
    return status ? status : assign(scene, cells, scene->model->material_count - 1);
}

lar_status lar_scene_read_materials(lar_scene *scene, const lar_yaml *node) {
    const lar_mesh *mesh = &scene->model->mesh;
    size_t count = (size_t)mesh->element_count;
    int32_t *material = lar_calloc(count, sizeof *material);
    if (!material) return lar_scene_no_memory(scene, count * sizeof *material);
    for (size_t e = 0; e < count; e++) material[e] = -1;
    scene->model->element_material = material;
    lar_status status =
        lar_scene_list(scene, node, "materials, {cells: all, law: neo-hookean, ...}");
    for (const lar_yaml *entry = node->first; !status && entry; entry = entry->next)
        status = read_material(scene, entry);
    if (status) return status;
    for (size_t e = 0; e < count; e++)
        if (material[e] < 0)
            return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                                  "element %lld (tag %d) has no material; add an entry whose cells "
                                  "contain it, for example cells: all as the first one",
                                  (long long)mesh->element_id[e], (int)mesh->element_tag[e]);
    return LAR_OK;
}
