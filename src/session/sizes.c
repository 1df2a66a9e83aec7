/* Structs that grow ("lariat.h"): what a program's own struct is smaller or larger than the
 * library's.
 *
 *     program's   [ a b c ]            [ a b c d ]
 *     library's   [ a b c d ]          [ a b c ]
 *     read:        d as by default      d must be 0, or the call is refused
 *     written:     d stays away         d becomes 0
 *
 * So does Linux with what system calls take (copy_struct_from_user). Inside the library all structs
 * are whole: its own calls have no size, and these here are all that programs reach.
 */
#include <string.h>

#include "base/error.h"
#include "simulation/rest.h"

static lar_status take(void *all, size_t known, const void *given, size_t size, const char *what,
                       lar_error *error) {
    if (!given) return LAR_OK;
    memcpy(all, given, size < known ? size : known);
    for (size_t i = known; i < size; i++)
        if (((const unsigned char *)given)[i])
            return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                            "the program sets members of a %s that Lariat %s does not know; leave "
                            "them 0, or use the version that the program was made with",
                            what, lar_version());
    return LAR_OK;
}

/* Nothing where there is no place, or nothing to tell. */
static lar_status give(lar_status status, void *place, size_t size, const void *all, size_t known) {
    if (status || !place) return status;
    memcpy(place, all, size < known ? size : known);
    if (size > known) memset((char *)place + known, 0, size - known);
    return LAR_OK;
}

lar_status lar_model_from_arrays_sized(const lar_mesh_arrays *mesh, size_t size, const char *scene,
                                       lar_model **model, lar_error *error) {
    lar_mesh_arrays known = {0};
    if (take(&known, sizeof known, mesh, size, "lar_mesh_arrays", error))
        return LAR_ERROR_UNSUPPORTED;
    lar_status status = lar_model_from_arrays(mesh ? &known : NULL, scene, model, error);
    return status ? status : lar_model_damp_itself(model, error);
}

lar_status lar_model_inspect_sized(const lar_model *model, lar_model_info *info, size_t size,
                                   lar_error *error) {
    lar_model_info all;
    const lar_status status = lar_model_inspect(model, info ? &all : NULL, error);
    return give(status, info, size, &all, sizeof all);
}

lar_status lar_model_material_sized(const lar_model *model, int32_t index, lar_material_info *info,
                                    size_t size, lar_error *error) {
    lar_material_info all;
    const lar_status status = lar_model_material(model, index, info ? &all : NULL, error);
    return give(status, info, size, &all, sizeof all);
}

lar_status lar_model_tool_sized(const lar_model *model, int32_t index, lar_tool_info *info,
                                size_t size, lar_error *error) {
    lar_tool_info all;
    const lar_status status = lar_model_tool(model, index, info ? &all : NULL, error);
    return give(status, info, size, &all, sizeof all);
}

lar_status lar_model_quality_sized(const lar_model *model, const char *against, double scale,
                                   lar_mesh_quality *quality, size_t size, lar_error *error) {
    lar_mesh_quality all;
    const lar_status status =
        lar_model_quality(model, against, scale, quality ? &all : NULL, error);
    return give(status, quality, size, &all, sizeof all);
}

void lar_meshing_options_default_sized(lar_meshing_options *options, size_t size) {
    const lar_meshing_options all = lar_meshing_options_default();
    give(LAR_OK, options, size, &all, sizeof all);
}

lar_status lar_meshing_create_sized(const char *const *paths, int32_t count,
                                    const lar_meshing_options *options, size_t size,
                                    lar_meshing **meshing, lar_error *error) {
    lar_meshing_options known = lar_meshing_options_default();
    if (take(&known, sizeof known, options, size, "lar_meshing_options", error))
        return LAR_ERROR_UNSUPPORTED;
    return lar_meshing_create(paths, count, options ? &known : NULL, meshing, error);
}

lar_status lar_meshing_of_image_sized(const lar_image *image, const lar_meshing_options *options,
                                      size_t size, lar_meshing **meshing, lar_error *error) {
    lar_meshing_options known = lar_meshing_options_default();
    if (take(&known, sizeof known, options, size, "lar_meshing_options", error))
        return LAR_ERROR_UNSUPPORTED;
    return lar_meshing_of_image(image, options ? &known : NULL, meshing, error);
}

lar_status lar_meshing_of_surfaces_sized(const lar_surface_arrays *surface, int32_t count,
                                         const lar_meshing_options *options, size_t size,
                                         lar_meshing **meshing, lar_error *error) {
    lar_meshing_options known = lar_meshing_options_default();
    if (take(&known, sizeof known, options, size, "lar_meshing_options", error))
        return LAR_ERROR_UNSUPPORTED;
    return lar_meshing_of_surfaces(surface, count, options ? &known : NULL, meshing, error);
}

void lar_meshing_arrays_sized(const lar_meshing *meshing, lar_mesh_arrays *mesh, size_t size,
                              lar_surface_arrays *surface) {
    lar_mesh_arrays all = {0};
    lar_meshing_arrays(meshing, mesh ? &all : NULL, surface);
    give(LAR_OK, mesh, size, &all, sizeof all);
}

void lar_meshing_inspect_sized(const lar_meshing *meshing, lar_meshing_info *info, size_t size) {
    lar_meshing_info all = {0};
    lar_meshing_inspect(meshing, info ? &all : NULL);
    give(LAR_OK, info, size, &all, sizeof all);
}

lar_status lar_meshing_region_sized(const lar_meshing *meshing, int32_t index,
                                    lar_region_info *info, size_t size, lar_error *error) {
    lar_region_info all;
    const lar_status status = lar_meshing_region(meshing, index, info ? &all : NULL, error);
    return give(status, info, size, &all, sizeof all);
}

lar_status lar_image_create_sized(const lar_image_info *from, size_t size, const char *const *name,
                                  const int32_t *named, lar_image **image, lar_error *error) {
    lar_image_info known = {0};
    if (take(&known, sizeof known, from, size, "lar_image_info", error))
        return LAR_ERROR_UNSUPPORTED;
    return lar_image_create(from ? &known : NULL, name, named, image, error);
}

void lar_image_inspect_sized(const lar_image *image, lar_image_info *info, size_t size) {
    lar_image_info all = {0};
    lar_image_inspect(image, info ? &all : NULL);
    give(LAR_OK, info, size, &all, sizeof all);
}

void lar_options_default_sized(lar_options *options, size_t size) {
    const lar_options all = lar_options_default();
    give(LAR_OK, options, size, &all, sizeof all);
}

lar_status lar_grid_choose_sized(const lar_model *model, const lar_options *options,
                                 size_t options_size, const lar_grid_aim *aim,
                                 lar_grid_choice *choice, size_t choice_size, lar_error *error) {
    lar_options known = lar_options_default();
    if (take(&known, sizeof known, options, options_size, "lar_options", error))
        return LAR_ERROR_UNSUPPORTED;
    lar_grid_choice all;
    const lar_status status =
        lar_grid_choose(model, options ? &known : NULL, aim, choice ? &all : NULL, error);
    return give(status, choice, choice_size, &all, sizeof all);
}

lar_status lar_simulation_create_sized(const lar_model *model, const lar_options *options,
                                       size_t size, lar_simulation **simulation, lar_error *error) {
    lar_options known = lar_options_default();
    if (take(&known, sizeof known, options, size, "lar_options", error))
        return LAR_ERROR_UNSUPPORTED;
    return lar_simulation_create(model, options ? &known : NULL, simulation, error);
}

void lar_simulation_inspect_sized(const lar_simulation *simulation, lar_simulation_info *info,
                                  size_t size) {
    lar_simulation_info all = {0};
    lar_simulation_inspect(simulation, info ? &all : NULL);
    give(LAR_OK, info, size, &all, sizeof all);
}

void lar_simulation_energy_sized(const lar_simulation *simulation, lar_energy *energy,
                                 size_t size) {
    lar_energy all = {0};
    lar_simulation_energy(simulation, energy ? &all : NULL);
    give(LAR_OK, energy, size, &all, sizeof all);
}

lar_status lar_simulation_tool_sized(const lar_simulation *simulation, int32_t index,
                                     lar_tool_info *info, size_t size, lar_error *error) {
    lar_tool_info all;
    const lar_status status = lar_simulation_tool(simulation, index, info ? &all : NULL, error);
    return give(status, info, size, &all, sizeof all);
}

lar_status lar_simulation_tool_force_sized(const lar_simulation *simulation, int32_t tool,
                                           lar_tool_force *force, size_t size, lar_error *error) {
    lar_tool_force all;
    const lar_status status =
        lar_simulation_tool_force(simulation, tool, force ? &all : NULL, error);
    return give(status, force, size, &all, sizeof all);
}

lar_status lar_simulation_add_tool_sized(lar_simulation *simulation, const lar_tool_info *wanted,
                                         size_t size, int32_t *tool, lar_error *error) {
    lar_tool_info known = {0};
    if (take(&known, sizeof known, wanted, size, "lar_tool_info", error))
        return LAR_ERROR_UNSUPPORTED;
    return lar_simulation_add_tool(simulation, wanted ? &known : NULL, tool, error);
}

void lar_simulation_heavier_sized(const lar_simulation *simulation, lar_heavier *heavier,
                                  size_t size) {
    lar_heavier all = {0};
    lar_simulation_heavier(simulation, heavier ? &all : NULL);
    give(LAR_OK, heavier, size, &all, sizeof all);
}

void lar_simulation_contact_sized(const lar_simulation *simulation, lar_contact_info *info,
                                  size_t size) {
    lar_contact_info all = {0};
    lar_simulation_contact(simulation, info ? &all : NULL);
    give(LAR_OK, info, size, &all, sizeof all);
}

lar_status lar_checkpoint_inspect_sized(const char *path, lar_checkpoint_info *info, size_t size,
                                        lar_error *error) {
    lar_checkpoint_info all;
    const lar_status status = lar_checkpoint_inspect(path, info ? &all : NULL, error);
    return give(status, info, size, &all, sizeof all);
}

void lar_session_options_default_sized(lar_session_options *options, size_t size) {
    const lar_session_options all = lar_session_options_default();
    give(LAR_OK, options, size, &all, sizeof all);
}

lar_status lar_session_open_sized(lar_simulation *simulation, const lar_session_options *options,
                                  size_t size, lar_session **session, lar_error *error) {
    lar_session_options known = lar_session_options_default();
    if (take(&known, sizeof known, options, size, "lar_session_options", error))
        return LAR_ERROR_UNSUPPORTED;
    return lar_session_open(simulation, options ? &known : NULL, session, error);
}

void lar_session_inspect_sized(const lar_session *session, lar_session_info *info, size_t size) {
    lar_session_info all = {0};
    lar_session_inspect(session, info ? &all : NULL);
    give(LAR_OK, info, size, &all, sizeof all);
}

lar_status lar_session_add_tool_sized(lar_session *session, const lar_tool_info *wanted,
                                      size_t size, int32_t *tool, lar_error *error) {
    lar_tool_info known = {0};
    if (take(&known, sizeof known, wanted, size, "lar_tool_info", error))
        return LAR_ERROR_UNSUPPORTED;
    return lar_session_add_tool(session, wanted ? &known : NULL, tool, error);
}

lar_status lar_session_tool_info_sized(const lar_session *session, int32_t tool,
                                       lar_tool_info *info, size_t size, lar_error *error) {
    lar_tool_info all;
    const lar_status status = lar_session_tool_info(session, tool, info ? &all : NULL, error);
    return give(status, info, size, &all, sizeof all);
}

lar_status lar_session_tool_force_sized(const lar_session *session, int32_t tool,
                                        lar_tool_pose *pose, lar_tool_force *force, size_t size,
                                        lar_error *error) {
    lar_tool_force all;
    const lar_status status =
        lar_session_tool_force(session, tool, pose, force ? &all : NULL, error);
    return give(status, force, size, &all, sizeof all);
}

lar_status lar_session_device_sized(const lar_session *session, int32_t tool,
                                    lar_device_status *status, size_t size, lar_error *error) {
    lar_device_status all;
    const lar_status done = lar_session_device(session, tool, status ? &all : NULL, error);
    return give(done, status, size, &all, sizeof all);
}

void lar_session_status_get_sized(const lar_session *session, lar_session_status *status,
                                  size_t size) {
    lar_session_status all = {0};
    lar_session_status_get(session, status ? &all : NULL);
    give(LAR_OK, status, size, &all, sizeof all);
}

lar_status lar_recording_inspect_sized(const char *path, lar_recording_info *info, size_t size,
                                       lar_error *error) {
    lar_recording_info all;
    const lar_status status = lar_recording_inspect(path, info ? &all : NULL, error);
    return give(status, info, size, &all, sizeof all);
}

lar_status lar_replay_sized(lar_simulation *simulation, const char *path,
                            lar_step_callback *callback, void *context, lar_replay_report *report,
                            size_t size, lar_error *error) {
    lar_replay_report all = {.different = UINT64_MAX}; /* tells of failures, too */
    const lar_status status = lar_replay(simulation, path, callback, context, &all, error);
    give(LAR_OK, report, size, &all, sizeof all);
    return status;
}
