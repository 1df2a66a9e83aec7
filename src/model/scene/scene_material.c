#include "model/scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

/* A way to say the stiffness: with the law's own parameters, or with two moduli that every law
 * knows. */
typedef struct stiffness_form {
    int count;
    const lar_law_parameter *key;
} stiffness_form;

static const lar_law_parameter shear_bulk_key[] = {{"shear_modulus", LAR_VALUE_MODULUS},
                                                   {"bulk_modulus", LAR_VALUE_MODULUS}};
static const lar_law_parameter young_key[] = {{"youngs_modulus", LAR_VALUE_MODULUS},
                                              {"poisson_ratio", LAR_VALUE_RATIO}};
static const stiffness_form shear_bulk_form = {2, shear_bulk_key}, young_form = {2, young_key};

static stiffness_form own_form(lar_law law) {
    return (stiffness_form){lar_law_table[law].count, lar_law_table[law].parameter};
}

/* Keys of a material: its own seven, then all that any law may be asked with. */
enum { OWN_KEYS = 7, KEYS_MAX = OWN_KEYS + 4 + LAR_LAW_COUNT * LAR_LAW_PARAMETERS };

static void add_keys(const char **key, const stiffness_form *form) {
    for (int i = 0; i < form->count; i++) {
        int n = 0;
        while (key[n] && strcmp(key[n], form->key[i].name) != 0) n++;
        key[n] = form->key[i].name;
    }
}

/* Ends with NULL. */
static void list_keys(const char *key[KEYS_MAX + 1]) {
    static const char *const own[OWN_KEYS] = {"cells",   "tissue", "fibres", "law",
                                              "density", "name",   "viscous"};
    memset(key, 0, (KEYS_MAX + 1) * sizeof *key);
    for (int i = 0; i < OWN_KEYS; i++) key[i] = own[i];
    add_keys(key, &shear_bulk_form);
    add_keys(key, &young_form);
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        stiffness_form form = own_form((lar_law)law);
        add_keys(key, &form);
    }
}

/* True when the entry has exactly the form's stiffness keys; terms may be left out. */
static bool has_form(const lar_yaml *node, const stiffness_form *form) {
    const char *key[KEYS_MAX + 1];
    int present = 0, own = 0;
    for (int i = 0; i < form->count; i++) {
        bool given = lar_yaml_get(node, form->key[i].name) != NULL;
        if (!given && !lar_law_may_miss(form->key, i)) return false;
        own += given;
    }
    list_keys(key);
    for (int i = OWN_KEYS; key[i]; i++) present += lar_yaml_get(node, key[i]) != NULL;
    return present == own;
}

/* Whether a law's own parameters are the two moduli. */
static bool is_shear_bulk(const stiffness_form *form) {
    bool same = form->count == shear_bulk_form.count;
    for (int i = 0; same && i < form->count; i++)
        same = strcmp(form->key[i].name, shear_bulk_key[i].name) == 0;
    return same;
}

/* The keys of a form in a sentence: those that it needs, and those that may be left out. */
static void list_form(const stiffness_form *form, char *text, size_t size) {
    const char *name[LAR_LAW_PARAMETERS];
    char needed[120] = "", more[120] = "";
    for (int wanted = 0; wanted < 2; wanted++) {
        int count = 0;
        for (int i = 0; i < form->count; i++)
            if (lar_law_may_miss(form->key, i) == (wanted == 1)) name[count++] = form->key[i].name;
        if (count) lar_text_list(name, count, wanted ? more : needed, sizeof needed);
    }
    snprintf(text, size, *more ? "%s (%s may be left out)" : "%s", needed, more);
}

static lar_status no_form(const lar_scene *scene, const lar_yaml *node, lar_law law) {
    const stiffness_form own = own_form(law);
    char also[300] = "";
    if (!is_shear_bulk(&own)) list_form(&own, also, sizeof also);
    return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                          "a material of the law %s needs either shear_modulus and bulk_modulus, "
                          "or youngs_modulus and poisson_ratio%s%s, and nothing besides",
                          lar_law_name[law], *also ? ", or " : "", also);
}

static lar_status read_numbers(const lar_scene *scene, const lar_yaml *node,
                               const stiffness_form *form, double value[LAR_LAW_PARAMETERS]) {
    lar_status status = LAR_OK;
    for (int i = 0; !status && i < form->count; i++) {
        const lar_yaml *number = lar_yaml_get(node, form->key[i].name);
        const char *what = lar_law_in_pascal(&form->key[i])
                               ? LAR_IN_PASCAL
                               : "a number without a unit, for example 5";
        lar_law_value kind = form->key[i].value;
        value[i] = 0;
        if (!number && kind == LAR_VALUE_POWER && value[i - 1] != 0)
            return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                                  "%s is missing, the power of the term of %s; add it",
                                  form->key[i].name, form->key[i - 1].name);
        if (!number) continue;
        status = kind == LAR_VALUE_MODULUS || kind == LAR_VALUE_NUMBER
                     ? lar_scene_positive(scene, number, what, &value[i])
                     : lar_scene_number(scene, number, what, &value[i]);
    }
    return status;
}

/* Of the speed of a pressure wave, with which the stable step shrinks, at one Young's modulus. */
static double wave_of(double ratio) {
    return sqrt((1 - ratio) / ((1 + ratio) * (1 - 2 * ratio)));
}

static lar_status notice_ratio(const lar_scene *scene, const lar_yaml *node, double ratio) {
    static const double NEARLY = 0.499, DOUBTED = 0.4999;
    if (ratio <= DOUBTED) return LAR_OK;
    const double shorter = wave_of(ratio) / wave_of(NEARLY);
    return lar_model_notice(scene->model, scene->error,
                            "%.300s:%d: poisson_ratio: %.40s makes the time step %.*f times "
                            "shorter than 0.499 does; take 0.49 to 0.499, as nearly "
                            "incompressible tissue has",
                            scene->path, node->line, node->text, shorter < 10 ? 1 : 0, shorter);
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
    return notice_ratio(scene, ratio_node, ratio);
}

static lar_status read_stiffness(const lar_scene *scene, const lar_yaml *node,
                                 lar_material *material) {
    if (has_form(node, &young_form)) return read_young(scene, node, material);
    const stiffness_form own = own_form(material->law);
    double value[LAR_LAW_PARAMETERS] = {0};
    lar_status status;
    if (has_form(node, &own)) {
        status = read_numbers(scene, node, &own, value);
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

/* ---- viscosity ----------------------------------------------------------------------------- */

static lar_status read_part(const lar_scene *scene, const lar_yaml *node, bool *isochoric) {
    static const char *const names[] = {"isochoric", "whole"};
    *isochoric = lar_scene_is_word(node, names[0]);
    if (*isochoric || lar_scene_is_word(node, names[1])) return LAR_OK;
    return lar_scene_unknown(scene, node, LAR_ERROR_FORMAT, "the part of the stress",
                             "the parts are", names, 2);
}

static lar_status read_term(const lar_scene *scene, const lar_yaml *node, lar_viscosity *v) {
    static const char *const keys[] = {"g", "time", NULL}, what[] = "a viscous term";
    const lar_yaml *share = NULL, *time = NULL;
    lar_status status = lar_scene_keys(scene, node, what, keys);
    if (!status) status = lar_scene_need(scene, node, what, "g", "g: 0.5", &share);
    if (!status) status = lar_scene_need(scene, node, what, "time", "time: 0.1", &time);
    if (!status)
        status = lar_scene_positive(scene, share, "a number without a unit, for example 0.5",
                                    &v->share[v->terms]);
    if (!status)
        status = lar_scene_positive(scene, time, "a time in seconds, for example 0.1",
                                    &v->time[v->terms]);
    v->terms++;
    return status;
}

static lar_status read_viscosity(const lar_scene *scene, const lar_yaml *node, lar_viscosity *v) {
    static const char *const keys[] = {"part", "g0", "terms", NULL}, what[] = "viscous";
    const lar_yaml *part = NULL, *terms = NULL;
    lar_status status = lar_scene_keys(scene, node, what, keys);
    if (!status) status = lar_scene_need(scene, node, what, "part", "part: isochoric", &part);
    if (!status)
        status = lar_scene_need(scene, node, what, "terms", "terms: [{g: 0.5, time: 0.1}]", &terms);
    if (!status) status = read_part(scene, part, &v->isochoric);
    const lar_yaml *rest = lar_yaml_get(node, "g0");
    v->rest = 1;
    v->line = node->line;
    if (!status && rest)
        status =
            lar_scene_positive(scene, rest, "a number without a unit, for example 1", &v->rest);
    if (!status) status = lar_scene_list(scene, terms, "terms, {g: 0.5, time: 0.1}");
    if (status) return status;
    if (terms->count < 1 || terms->count > LAR_VISCOUS_TERMS)
        return lar_scene_fail(scene, terms, LAR_ERROR_FORMAT,
                              "terms: %d viscous terms; give one to %d", (int)terms->count,
                              LAR_VISCOUS_TERMS);
    for (const lar_yaml *entry = terms->first; !status && entry; entry = entry->next)
        status = read_term(scene, entry, v);
    return status;
}

/* taker[m]: the line of the last entry that took elements from material m. */
static lar_status assign(lar_scene *scene, const lar_yaml *cells, int material, int *taker) {
    int32_t *index, count;
    lar_status status = lar_scene_select(scene, cells, LAR_SET_ELEMENTS, true, &index, &count);
    if (status) return status;
    for (int32_t i = 0; i < count; i++) {
        int32_t *of = &scene->model->element_material[index[i]];
        if (*of >= 0) taker[*of] = cells->line;
        *of = material;
    }
    free(index);
    return LAR_OK;
}

/* A tissue file has its version instead of what only a scene can say. */
static lar_status check_keys(const lar_scene *scene, const lar_yaml *node) {
    enum { OF_SCENES = 2 };
    const char *key[KEYS_MAX + 1];
    list_keys(key);
    if (scene->root != node) return lar_scene_keys(scene, node, "a material", key);
    key[OF_SCENES - 1] = "lariat-tissue";
    return lar_scene_keys(scene, node, "a tissue file", key + OF_SCENES - 1);
}

lar_status lar_scene_read_material(const lar_scene *scene, const lar_yaml *node,
                                   lar_material *material) {
    const lar_yaml *law = NULL, *density = NULL, *viscous = lar_yaml_get(node, "viscous");
    const char *const what = scene->root == node ? "a tissue file" : "a material";
    lar_status status = check_keys(scene, node);
    if (!status) status = lar_scene_need(scene, node, what, "law", "law: neo-hookean", &law);
    if (!status) status = lar_scene_need(scene, node, what, "density", "density: 1050", &density);
    if (!status) status = read_law(scene, law, &material->law);
    if (!status) status = lar_scene_positive(scene, density, LAR_IN_DENSITY, &material->density);
    if (!status) status = read_stiffness(scene, node, material);
    if (!status && viscous) status = read_viscosity(scene, viscous, &material->viscosity);
    const lar_yaml *fibres = lar_yaml_get(node, "fibres");
    return status || !fibres ? status : lar_scene_read_fibres(scene, fibres, material);
}

static lar_status read_name(const lar_scene *scene, const lar_yaml *node, lar_material *material) {
    const char *name;
    if (!node) return LAR_OK;
    lar_status status = lar_scene_text(scene, node, "a name", &name);
    if (status) return status;
    for (int i = 0; i < scene->model->material_count - 1; i++) {
        const char *known = scene->model->material[i].name;
        if (known && strcmp(known, name) == 0)
            return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                                  "a second material is called \"%s\"; name one of them "
                                  "otherwise, or give both places in `cells` of one, for example "
                                  "cells: [1, 2]",
                                  name);
    }
    material->name = lar_strdup(name);
    return material->name ? LAR_OK : lar_scene_no_memory(scene, strlen(name) + 1);
}

/* Of an entry with a tissue file. */
static lar_status read_fibres_beside(const lar_scene *scene, const lar_yaml *entry,
                                     lar_material *material) {
    const lar_yaml *fibres = lar_yaml_get(entry, "fibres");
    if (fibres) return lar_scene_read_fibres(scene, fibres, material);
    if (!lar_fibre_directed(&material->fibre)) return LAR_OK;
    return lar_scene_fail(scene, lar_yaml_get(entry, "tissue"), LAR_ERROR_FORMAT,
                          "tissue: it has fibres; say along what they run, for example fibres: "
                          "{direction: {axis: [1, 0, 0]}}");
}

static lar_status read_material(lar_scene *scene, const lar_yaml *node, int *taker) {
    const lar_yaml *cells = NULL;
    const bool apart = lar_yaml_get(node, "tissue") != NULL;
    lar_status status = apart ? LAR_OK : check_keys(scene, node);
    if (!status) status = lar_scene_need(scene, node, "a material", "cells", "cells: all", &cells);
    if (status) return status;
    lar_material *material = LAR_MODEL_APPEND(scene->model, material);
    if (!material) return lar_scene_no_memory(scene, sizeof *material);
    status = read_name(scene, lar_yaml_get(node, "name"), material);
    if (!status && apart)
        status = lar_scene_read_tissue(scene, node, material);
    else if (!status)
        status = lar_scene_read_material(scene, node, material);
    if (!status && apart) status = read_fibres_beside(scene, node, material);
    if (status) return status;
    char where[512];
    snprintf(where, sizeof where, "%s:%d:%d", scene->path, node->line, node->column);
    status = lar_material_check(material, where, scene->error);
    return status ? status : assign(scene, cells, scene->model->material_count - 1, taker);
}

/* A material whose elements later entries have taken: they were meant the other way round. */
static lar_status notice_taken(const lar_scene *scene, const lar_yaml *node, const int *taker) {
    const lar_model *model = scene->model;
    lar_status status = LAR_OK;
    int m = 0;
    for (const lar_yaml *entry = node->first; !status && entry; entry = entry->next, m++) {
        bool has = false;
        char name[120] = "";
        for (int32_t e = 0; e < model->mesh.element_count && !has; e++)
            has = model->element_material[e] == m;
        if (has) continue;
        if (model->material[m].name)
            snprintf(name, sizeof name, " '%.100s'", model->material[m].name);
        status = lar_model_notice(scene->model, scene->error,
                                  "%.300s:%d: the material%s has no elements: later ones (the last "
                                  "in line %d) have them all; put the one for `all` first",
                                  scene->path, entry->line, name, taker[m]);
    }
    return status;
}

/* All entries, and whether each element has a material. */
static lar_status read_entries(lar_scene *scene, const lar_yaml *node, int *taker) {
    const lar_mesh *mesh = &scene->model->mesh;
    const int32_t *material = scene->model->element_material;
    lar_status status = LAR_OK;
    for (const lar_yaml *entry = node->first; !status && entry; entry = entry->next)
        status = read_material(scene, entry, taker);
    for (int32_t e = 0; e < mesh->element_count && !status; e++)
        if (material[e] < 0)
            status =
                lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                               "element %lld (tag %d) has no material; add an entry whose cells "
                               "contain it, for example cells: all as the first one",
                               (long long)mesh->element_id[e], (int)mesh->element_tag[e]);
    return status ? status : notice_taken(scene, node, taker);
}

lar_status lar_scene_read_materials(lar_scene *scene, const lar_yaml *node) {
    size_t count = (size_t)scene->model->mesh.element_count;
    int32_t *material = lar_calloc(count, sizeof *material);
    if (!material) return lar_scene_no_memory(scene, count * sizeof *material);
    for (size_t e = 0; e < count; e++) material[e] = -1;
    scene->model->element_material = material;
    lar_status status =
        lar_scene_list(scene, node, "materials, {cells: all, law: neo-hookean, ...}");
    if (status) return status;
    int *taker = lar_calloc((size_t)node->count, sizeof *taker);
    if (!taker) return lar_scene_no_memory(scene, (size_t)node->count * sizeof *taker);
    status = read_entries(scene, node, taker);
    free(taker);
    int index = 0;
    for (const lar_yaml *entry = node->first; !status && entry; entry = entry->next, index++) {
        const lar_yaml *fibres = lar_yaml_get(entry, "fibres");
        if (fibres) status = lar_scene_lay_fibres(scene, fibres, index);
    }
    return status;
}
