#include "model/scene/scene.h"

#include <stdlib.h>
#include <string.h>

#include "model/rest.h"

static lar_status check_root(const lar_scene *scene) {
    static const char *const keys[] = {
        "lariat",  "title",        "mesh",    "scale",  "gravity",  "time_step",
        "damping", "materials",    "sets",    "fix",    "move",     "load",
        "initial", "contact",      "tools",   "output", "duration", "surface",
        "view",    "mass_scaling", "springs", NULL};
    const lar_yaml *version = NULL;
    int64_t number;
    if (scene->root->kind != LAR_YAML_MAPPING)
        return lar_scene_fail(scene, scene->root, LAR_ERROR_FORMAT,
                              "this is no scene: a scene is a list of lines \"key: value\" and "
                              "begins with the line lariat: 1");
    lar_status status =
        lar_scene_need(scene, scene->root, "a scene", "lariat", "lariat: 1", &version);
    if (status) return status;
    if (!lar_scene_is_integer(version, &number) || number != 1) {
        char shown[LAR_YAML_SHOWN];
        return lar_scene_fail(scene, version, LAR_ERROR_UNSUPPORTED,
                              "lariat: expected 1, the version of the scene format that this "
                              "program reads, but found %s; write lariat: 1, or take a "
                              "newer program",
                              lar_yaml_show(version, shown));
    }
    return lar_scene_keys(scene, scene->root, "a scene", keys);
}

static lar_status read_time_step(lar_scene *scene, const lar_yaml *node) {
    const char *const expected = "auto, or a number in seconds (SI units), for example 1.0e-4";
    if (lar_scene_is_word(node, "auto")) return LAR_OK;
    scene->model->time_step_line = node->line;
    lar_status status = lar_scene_positive(scene, node, expected, &scene->model->time_step);
    if (status || scene->model->time_step >= LAR_STEP_MIN) return status;
    return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                          "time_step: expected auto, or 1e-15 s at least");
}

/* More than a second is no step, and more mass than a body has is another body. */
static lar_status read_mass_step(lar_scene *scene, const lar_yaml *value) {
    const char *const step = "a number in seconds up to 1, for example 2.0e-4: what all elements "
                             "shall be stable up to";
    lar_model *model = scene->model;
    lar_status status = lar_scene_positive(scene, value, step, &model->mass_step);
    if (status) return status;
    if (model->mass_step > 1)
        return lar_scene_fail(scene, value, LAR_ERROR_MODEL, "time_step is %s; expected %s",
                              value->text, step);
    if (model->time_step > model->mass_step)
        return lar_scene_fail(scene, value, LAR_ERROR_MODEL,
                              "mass_scaling makes elements stable up to %g s, and the scene's "
                              "time_step is %g s: make one larger or the other smaller",
                              model->mass_step, model->time_step);
    return LAR_OK;
}

/* A part of the model's mass. */
static lar_status read_share(lar_scene *scene, const lar_yaml *value, const char *key, double most,
                             const char *expected, double *share) {
    lar_status status = lar_scene_positive(scene, value, expected, share);
    if (status || *share <= most) return status;
    return lar_scene_fail(scene, value, LAR_ERROR_MODEL, "%s is %s; expected %s", key, value->text,
                          expected);
}

/* Without what is strained it is about the time step. */
static lar_status read_mass_scaling(lar_scene *scene, const lar_yaml *node) {
    static const char *const keys[] = {"time_step", "largest_share", "strained", NULL};
    lar_model *model = scene->model;
    const lar_yaml *value, *strained;
    lar_status status = lar_scene_keys(scene, node, "mass_scaling", keys);
    if (status) return status;
    if ((strained = lar_yaml_get(node, "strained")))
        status = read_share(scene, strained, "strained", 0.2,
                            "a part of the model's mass above 0 and up to 0.2, for example 0.02",
                            &model->strained_share);
    bool alone = strained && !lar_yaml_get(node, "largest_share");
    if (status || (alone && !lar_yaml_get(node, "time_step"))) return status;
    status = lar_scene_need(scene, node, "mass_scaling", "time_step", "time_step: 2.0e-4", &value);
    if (!status) status = read_mass_step(scene, value);
    if (status || !(value = lar_yaml_get(node, "largest_share"))) return status;
    return read_share(scene, value, "largest_share", 1,
                      "a part of the model's mass above 0 and up to 1, for example 0.05",
                      &model->mass_share);
}

/* Seconds, or "rest". Without a damping of its own such a scene is damped as static decks are. */
static lar_status read_duration(lar_scene *scene, const lar_yaml *node) {
    const char *const expected = "rest, or a number in seconds (SI units), for example 0.2";
    scene->model->until_rest = lar_scene_is_word(node, "rest");
    if (scene->model->until_rest) return LAR_OK;
    return lar_scene_positive(scene, node, expected, &scene->model->duration);
}

static lar_status damp_to_rest(lar_scene *scene) {
    lar_model *model = scene->model;
    if (!model->until_rest || lar_yaml_get(scene->root, "damping")) return LAR_OK;
    model->damping = lar_model_rest_damping(model);
    model->damps_itself = true;
    return lar_model_notice(
        model, scene->error,
        "%s: duration: rest without a damping: it is at most %.3g 1/s, "
        "with which the slowest motion dies out; the key damping says otherwise",
        scene->path, model->damping);
}

static lar_status read_title(lar_scene *scene, const lar_yaml *node) {
    const char *title = strrchr(scene->path, '/');
    title = title ? title + 1 : scene->path;
    lar_status status = node ? lar_scene_text(scene, node, "a text", &title) : LAR_OK;
    if (status) return status;
    scene->model->title = lar_strdup(title);
    scene->model->source = lar_strdup(scene->path);
    if (!scene->model->title || !scene->model->source)
        return lar_scene_no_memory(scene, strlen(title) + 1);
    return LAR_OK;
}

/* One acceleration with a course of its own: the model has a curve for each axis. */
static lar_status read_gravity_entry(lar_scene *scene, const lar_yaml *entry) {
    static const char *const keys[] = {"acceleration", "over", "curve", NULL};
    const char *const what = "gravity";
    lar_model *model = scene->model;
    const lar_yaml *value;
    double acceleration[3];
    int curve;
    lar_status status = lar_scene_keys(scene, entry, what, keys);
    if (!status)
        status = lar_scene_need(scene, entry, what, "acceleration", "acceleration: [0, 0, -9.81]",
                                &value);
    if (!status) status = lar_scene_vector(scene, value, LAR_IN_GRAVITY, acceleration);
    if (!status) status = lar_scene_read_course(scene, entry, false, &curve);
    for (int axis = 0; !status && axis < 3; axis++) {
        if (acceleration[axis] == 0) continue;
        if (model->gravity[axis] != 0)
            return lar_scene_fail(scene, entry, LAR_ERROR_MODEL,
                                  "gravity along %c stands in two entries; write one, with the "
                                  "curve of both together",
                                  'x' + axis);
        model->gravity[axis] = acceleration[axis];
        model->gravity_curve[axis] = curve;
    }
    return status;
}

/* [x, y, z], or with a course, or several that act along different axes. */
static lar_status read_gravity(lar_scene *scene, const lar_yaml *node) {
    bool list = node->kind == LAR_YAML_LIST && node->first && node->first->kind == LAR_YAML_MAPPING;
    if (node->kind == LAR_YAML_MAPPING) return read_gravity_entry(scene, node);
    if (!list) return lar_scene_vector(scene, node, LAR_IN_GRAVITY, scene->model->gravity);
    lar_status status = LAR_OK;
    for (const lar_yaml *entry = node->first; !status && entry; entry = entry->next)
        status = read_gravity_entry(scene, entry);
    return status;
}

/* What needs no mesh, first: its mistakes should not wait for a large file. */
static lar_status read_plain_values(lar_scene *scene, double *scale) {
    lar_model *model = scene->model;
    const lar_yaml *root = scene->root, *value;
    *scale = 1.0;
    lar_status status = read_title(scene, lar_yaml_get(root, "title"));
    if (!status && (value = lar_yaml_get(root, "scale")))
        status = lar_scene_positive(scene, value,
                                    "a number, metres per unit of the mesh file, "
                                    "for example 0.001 for millimetres",
                                    scale);
    if (!status && (value = lar_yaml_get(root, "gravity"))) status = read_gravity(scene, value);
    if (!status && (value = lar_yaml_get(root, "time_step"))) status = read_time_step(scene, value);
    if (!status && (value = lar_yaml_get(root, "damping"))) {
        model->damping_line = value->line;
        status = lar_scene_not_negative(scene, value, "a number in 1/s, for example 2.0",
                                        &model->damping);
    }
    if (!status && (value = lar_yaml_get(root, "duration"))) status = read_duration(scene, value);
    if (!status && (value = lar_yaml_get(root, "mass_scaling")))
        status = read_mass_scaling(scene, value);
    if (!status && (value = lar_yaml_get(root, "view")))
        status = lar_scene_direction(scene, value, model->view);
    return status;
}

static lar_status read_root(lar_scene *scene) {
    typedef lar_status part_reader(lar_scene * scene, const lar_yaml *node);
    static const struct {
        const char *key;
        part_reader *read;
    } part[] = {{"sets", lar_scene_read_sets},       {"materials", lar_scene_read_materials},
                {"fix", lar_scene_read_fix},         {"move", lar_scene_read_move},
                {"load", lar_scene_read_load},       {"initial", lar_scene_read_initial},
                {"contact", lar_scene_read_contact}, {"tools", lar_scene_read_tools},
                {"springs", lar_scene_read_springs}, {"surface", lar_scene_read_surface},
                {"output", lar_scene_read_output}};
    const lar_yaml *mesh = NULL, *materials;
    double scale;
    lar_status status = check_root(scene);
    if (!status) status = lar_scene_check_mesh(scene, &mesh);
    if (!status)
        status = lar_scene_need(scene, scene->root, "a scene", "materials",
                                "materials: [{cells: all, law: neo-hookean, density: 1050, "
                                "shear_modulus: 4.0e3, bulk_modulus: 4.0e5}]",
                                &materials);
    if (!status) status = read_plain_values(scene, &scale);
    if (!status) status = lar_scene_read_meshes(scene, mesh, scale);
    for (size_t i = 0; !status && i < sizeof part / sizeof part[0]; i++) {
        const lar_yaml *value = lar_yaml_get(scene->root, part[i].key);
        if (value) status = part[i].read(scene, value);
    }
    if (!status) status = damp_to_rest(scene);
    return status ? status : lar_model_check(scene->model, scene->error);
}

/* `from`: path, and where the mesh comes from. */
static lar_status parse(const lar_scene *from, const lar_bytes *bytes, lar_model **model,
                        lar_error *error) {
    lar_error unused; /* the parts may rely on an error to write to */
    lar_yaml_tree tree;
    lar_status status = lar_yaml_parse(from->path, bytes, &tree, error);
    if (status) return status;
    lar_scene scene = {.path = from->path,
                       .root = tree.root,
                       .read_mesh = from->read_mesh,
                       .given = from->given,
                       .model = lar_model_create(),
                       .error = error ? error : &unused};
    status = scene.model ? read_root(&scene) : lar_scene_no_memory(&scene, sizeof *scene.model);
    lar_scene_sets_clear(&scene);
    free(scene.axis_line);
    lar_yaml_clear(&tree);
    if (status)
        lar_model_destroy(scene.model);
    else
        *model = scene.model;
    return status;
}

lar_status lar_scene_parse_with(const char *path, const lar_bytes *bytes,
                                lar_scene_mesh_reader *read_mesh, lar_model **model,
                                lar_error *error) {
    return parse(&(lar_scene){.path = path, .read_mesh = read_mesh}, bytes, model, error);
}

lar_status lar_scene_parse_given(const char *path, const lar_bytes *bytes,
                                 const lar_mesh_arrays *given, lar_model **model,
                                 lar_error *error) {
    return parse(&(lar_scene){.path = path, .given = given}, bytes, model, error);
}
