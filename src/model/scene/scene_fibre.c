/* The key `fibres` of a material; of its directions see scene_fibre_rule.c. */
#include "model/scene/scene.h"

#include <string.h>

static const char *const *const law_names = lar_fibre_law_name + LAR_FIBRE_EXP_POW;
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

/* Which parameter of the law has that name; -1: none. */
static int parameter_of(lar_fibre_law law, const char *name) {
    for (int k = 0; law != LAR_FIBRE_NONE && k < LAR_FIBRE_PARAMETERS; k++) {
        const char *own = lar_fibre_parameter_name[law][k];
        if (own && strcmp(own, name) == 0) return k;
    }
    return -1;
}

/* Every parameter of the law, and none of another. */
static lar_status read_parameters(const lar_scene *scene, const lar_yaml *node, lar_fibre *fibre) {
    lar_status status = LAR_OK;
    for (int i = 0; i < LAWS * LAR_FIBRE_PARAMETERS && !status; i++) {
        int law = LAR_FIBRE_EXP_POW + i / LAR_FIBRE_PARAMETERS;
        const char *name = lar_fibre_parameter_name[law][i % LAR_FIBRE_PARAMETERS];
        const lar_yaml *value = name ? lar_yaml_get(node, name) : NULL;
        int k = name ? parameter_of(fibre->law, name) : -1;
        if (k >= 0 && !value && (int)fibre->law == law)
            return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                                  "fibres of the law %s need %s; add it", lar_fibre_law_name[law],
                                  name);
        if (!value) continue;
        if (k < 0)
            return lar_scene_fail(scene, value, LAR_ERROR_FORMAT,
                                  "%s is no parameter of the law %s; remove it", name,
                                  fibre->law ? lar_fibre_law_name[fibre->law] : "none");
        const char *what = lar_fibre_scales(fibre->law, k)
                               ? LAR_IN_PASCAL
                               : "a number without a unit, for example 2";
        status = lar_scene_not_negative(scene, value, what, &fibre->parameter[k]);
    }
    return status;
}

/* Law and parameters; of what is only active there are none. */
static lar_status read_passive(const lar_scene *scene, const lar_yaml *node, lar_fibre *fibre) {
    static const char what[] = "fibres";
    const lar_yaml *law = NULL, *part = NULL;
    lar_status status = LAR_OK;
    part = lar_yaml_get(node, "part");
    if (!lar_yaml_get(node, "active") || lar_yaml_get(node, "law")) {
        status = lar_scene_need(scene, node, what, "law", "law: exp-pow", &law);
        if (!status) status = lar_scene_need(scene, node, what, "part", "part: isochoric", &part);
        if (!status) status = read_law(scene, law, fibre);
        if (!status) status = read_part(scene, part, &fibre->isochoric);
    } else if (part) {
        status = lar_scene_fail(scene, part, LAR_ERROR_FORMAT,
                                "part: of fibres that are only active there is none; remove it, or "
                                "add a law");
    }
    return status ? status : read_parameters(scene, node, fibre);
}

/* Along what they run is the scene's to say: of a tissue file's fibres too. */
static lar_status check_directions(const lar_scene *scene, const lar_yaml *node,
                                   const lar_fibre *fibre) {
    const lar_yaml *direction = lar_yaml_get(node, "direction");
    const lar_yaml *second = lar_yaml_get(node, "second");
    const lar_yaml *either = direction ? direction : second;
    if (lar_scene_is_tissue(scene))
        return !either ? LAR_OK
                       : lar_scene_fail(scene, either, LAR_ERROR_FORMAT,
                                        "%s: along what fibres run is not the tissue's but the "
                                        "body's; say it in the scene, beside tissue",
                                        direction ? "direction" : "second");
    lar_status status = lar_scene_need(scene, node, "fibres", "direction",
                                       "direction: {axis: [1, 0, 0]}", &direction);
    if (!status && second && fibre->law != LAR_FIBRE_HGO)
        status = lar_scene_fail(scene, second, LAR_ERROR_FORMAT,
                                "second: only fibres of the law hgo can have a second family; take "
                                "that one, or remove it");
    return status;
}

/* In a tissue file all but the directions, in an entry with such fibres nothing else. */
lar_status lar_scene_read_fibres(const lar_scene *scene, const lar_yaml *node,
                                 lar_material *material) {
    static const char *const keys[] = {"law",  "part", "direction", "active", "ksi",     "alpha",
                                       "beta", "c3",   "c4",        "c5",     "lam_max", "E",
                                       "lam0", "k1",   "k2",        "kappa",  "second",  NULL};
    static const char *const beside[] = {"direction", "second", "active", NULL};
    lar_fibre *fibre = &material->fibre;
    const bool given = lar_fibre_here(fibre);
    lar_status status =
        given ? lar_scene_keys(scene, node, "fibres whose law the tissue file has", beside)
              : lar_scene_keys(scene, node, "fibres", keys);
    const lar_yaml *active = status ? NULL : lar_yaml_get(node, "active");
    if (!status && !given) status = read_passive(scene, node, fibre);
    if (!status) status = check_directions(scene, node, fibre);
    fibre->paired = lar_yaml_get(node, "second") != NULL;
    fibre->line = node->line;
    return status || !active ? status : lar_scene_read_active(scene, active, material);
}
