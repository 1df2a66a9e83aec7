/* The key `active` of a material's fibres: how much stress they develop, and when. */
#include "model/scene/scene.h"

#define IN_METRES_PER_SECOND "a number in m/s (SI units), for example 0.02"
#define A_SHARE              "a number from 0 to 1, for example 0.1"

static lar_status read_rest(const lar_scene *scene, const lar_yaml *node, double *rest) {
    lar_status status = lar_scene_not_negative(scene, node, A_SHARE, rest);
    if (status || *rest <= 1) return status;
    return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                          "rest: %g; a wave leaves " A_SHARE " of the active stress", *rest);
}

static lar_status check_every(const lar_scene *scene, const lar_yaml *node, const lar_wave *wave) {
    double passes = wave->length / wave->speed;
    if (wave->every >= passes) return LAR_OK;
    return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                          "every: %g s, but a pulse takes length / speed = %g s to pass; pulses do "
                          "not overlap, give at least that",
                          wave->every, passes);
}

static lar_status read_wave(const lar_scene *scene, const lar_yaml *node, lar_wave *wave) {
    static const char *const keys[] = {"direction", "speed", "length", "every", "rest", NULL};
    static const char what[] = "a wave";
    const lar_yaml *direction = NULL, *speed = NULL, *length = NULL;
    lar_status status = lar_scene_keys(scene, node, what, keys);
    if (!status)
        status = lar_scene_need(scene, node, what, "direction", "direction: [1, 0, 0]", &direction);
    if (!status) status = lar_scene_need(scene, node, what, "speed", "speed: 0.02", &speed);
    if (!status) status = lar_scene_need(scene, node, what, "length", "length: 0.03", &length);
    if (!status) status = lar_scene_direction(scene, direction, wave->direction);
    if (!status) status = lar_scene_positive(scene, length, LAR_IN_METRES, &wave->length);
    if (!status) status = lar_scene_positive(scene, speed, IN_METRES_PER_SECOND, &wave->speed);
    const lar_yaml *every = status ? NULL : lar_yaml_get(node, "every");
    const lar_yaml *rest = status ? NULL : lar_yaml_get(node, "rest");
    if (every) status = lar_scene_positive(scene, every, LAR_IN_SECONDS, &wave->every);
    if (!status && every) status = check_every(scene, every, wave);
    return status || !rest ? status : read_rest(scene, rest, &wave->rest);
}

lar_status lar_scene_read_active(const lar_scene *scene, const lar_yaml *node,
                                 lar_material *material) {
    static const char *const keys[] = {"along", "across", "over", "curve", "wave", NULL};
    static const char *const strength[] = {"along", "across", NULL};
    static const char in_file[] = "active, in a tissue file,";
    lar_fibre *fibre = &material->fibre;
    lar_activation *activation = &material->activation;
    int curve = -1;
    lar_status status = lar_scene_is_tissue(scene) ? lar_scene_keys(scene, node, in_file, strength)
                                                   : lar_scene_keys(scene, node, "active", keys);
    if (status) return status;
    const lar_yaml *along = lar_yaml_get(node, "along"), *across = lar_yaml_get(node, "across");
    const lar_yaml *wave = lar_yaml_get(node, "wave");
    if (!along && !across && !lar_fibre_active(fibre))
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "active: give \"along\" or \"across\" the fibres, or both, for "
                              "example {along: 2.0e3}");
    if (along) status = lar_scene_not_negative(scene, along, LAR_IN_PASCAL, &fibre->along);
    if (!status && across)
        status = lar_scene_not_negative(scene, across, LAR_IN_PASCAL, &fibre->across);
    if (!status && (lar_yaml_get(node, "over") || lar_yaml_get(node, "curve")))
        status = lar_scene_read_course(scene, node, false, &curve);
    activation->curve = curve + 1;
    return status || !wave ? status : read_wave(scene, wave, &activation->wave);
}
