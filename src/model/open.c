#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "model/format/mesh_io.h"
#include "model/mesh/arrays.h"
#include "model/scene/scene.h"

/* ---- scenes from files -------------------------------------------------------------------- */

lar_status lar_scene_parse(const char *path, const lar_bytes *bytes, lar_model **model,
                           lar_error *error) {
    return lar_scene_parse_with(path, bytes, lar_mesh_read, model, error);
}

lar_status lar_scene_read(const char *path, lar_model **model, lar_error *error) {
    lar_bytes bytes = {0};
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (!status) status = lar_scene_parse(path, &bytes, model, error);
    lar_bytes_free(&bytes);
    return status;
}

/* ---- a mesh alone ------------------------------------------------------------------------- */

/* A mesh without a scene is shown and inspected: one soft material, no supports. */
static lar_status fill_bare(lar_model *model, const char *path, lar_error *error) {
    const double density = 1050.0, shear = 4.0e3, bulk = 4.0e5;
    const char *name = strrchr(path, '/');
    model->title = lar_strdup(name ? name + 1 : path);
    model->source = lar_strdup(path);
    model->element_material = lar_calloc((size_t)model->mesh.element_count, sizeof(int32_t));
    lar_material *material = LAR_MODEL_APPEND(model, material);
    if (!model->title || !model->source || !model->element_material || !material)
        return lar_fail_memory(error, (size_t)model->mesh.element_count * sizeof(int32_t), path);
    material->law = LAR_LAW_neo_hookean;
    material->density = density;
    lar_material_from_shear_bulk(material, shear, bulk);
    return lar_model_check(model, error);
}

/* `given`: instead of the file. */
static lar_status make_bare(const char *path, const lar_mesh_arrays *given, lar_model **model,
                            lar_error *error) {
    lar_model *bare = lar_model_create();
    if (!bare) return lar_fail_memory(error, sizeof *bare, path);
    lar_status status = given ? lar_mesh_from_arrays(given, 1, &bare->mesh, error)
                              : lar_mesh_read(path, 1, &bare->mesh, error);
    if (!status) status = fill_bare(bare, path, error);
    if (status)
        lar_model_destroy(bare);
    else
        *model = bare;
    return status;
}

static lar_status read_bare(const char *path, lar_model **model, lar_error *error) {
    return make_bare(path, NULL, model, error);
}

/* ---- from memory -------------------------------------------------------------------------- */

/* What messages call it; afterwards it has no file (lar_model_source). */
static const char NOWHERE[] = "scene";

lar_status lar_model_from_arrays(const lar_mesh_arrays *mesh, const char *scene, lar_model **model,
                                 lar_error *error) {
    lar_model *made = NULL;
    if (!mesh || !model)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_model_from_arrays needs a mesh and a place for the model; neither may "
                        "be NULL");
    /* The parser only reads it; lar_bytes are what others own. */
    lar_bytes text = {0};
    if (scene && !(text.data = (unsigned char *)lar_strdup(scene)))
        return lar_fail_memory(error, strlen(scene) + 1, "the scene");
    text.size = scene ? strlen(scene) : 0;
    lar_status status = scene ? lar_scene_parse_given(NOWHERE, &text, mesh, &made, error)
                              : make_bare(NOWHERE, mesh, &made, error);
    lar_bytes_free(&text);
    if (status) return status;
    free(made->source);
    made->source = NULL;
    *model = made;
    return LAR_OK;
}

/* Mesh programs write .inp without anything else, and name materials that stand nowhere. */
lar_status lar_inp_read(const char *path, lar_model **model, lar_error *error) {
    lar_bytes bytes = {0};
    lar_status status = lar_bytes_read(path, &bytes, error);
    bool deck = !status && lar_inp_is_deck(&bytes);
    if (deck) status = lar_inp_deck_parse(path, &bytes, model, error);
    lar_bytes_free(&bytes);
    return status || deck ? status : read_bare(path, model, error);
}

/* ---- by extension ------------------------------------------------------------------------- */

lar_status lar_model_read(const char *path, lar_model **model, lar_error *error) {
    static const struct {
        const char *extension;
        lar_status (*read)(const char *path, lar_model **model, lar_error *error);
    } reader[] = {{"yaml", lar_scene_read}, {"yml", lar_scene_read}, {"feb", lar_feb_read},
                  {"vtu", read_bare},       {"vtk", read_bare},      {"msh", read_bare},
                  {"inp", lar_inp_read}};
    if (!path || !model)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_model_open needs a path and a place for the model; neither may be "
                        "NULL");
    const char *extension = lar_path_extension(path);
    for (size_t i = 0; i < sizeof reader / sizeof reader[0]; i++)
        if (strcasecmp(extension, reader[i].extension) == 0)
            return reader[i].read(path, model, error);
    if (strcasecmp(extension, "checkpoint") == 0)
        return lar_fail(
            error, LAR_ERROR_ARGUMENT,
            "%s: is a saved state and holds no model; name its scene, and go on from it "
            "with lariat run SCENE --resume %s, or with lariat view",
            path, path);
    if (strcasecmp(extension, "recording") == 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s: is a recording of a session and holds no model; name its scene, and "
                        "play it with lariat replay SCENE %s, or in lariat view with the folder "
                        "that it lies in as --save-folder",
                        path, path);
    if (!*extension)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s: has no extension that says what it is; give a scene (.yaml), a deck "
                        "(.feb .inp) or a mesh (.vtu .vtk .msh .inp)",
                        *path ? path : "\"\"");
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s: the extension \".%s\" is not known; give a scene (.yaml), a deck "
                    "(.feb .inp) or a mesh (.vtu .vtk .msh .inp); of scans and surfaces lariat "
                    "mesh makes a scene",
                    path, extension);
}
