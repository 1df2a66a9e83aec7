/* Structs that grow: a part of lariat.h, which includes it at its end. Programs include that.
 *
 * Later versions may add members at the end of a struct, behind its padding, and mean by 0 there
 * what was before. A program may be older or newer than the library that it finds, so the calls of
 * lariat.h that are LAR_SIZED are compiled into the program: they do nothing but tell the library
 * how large the program's own struct is. Nothing is written behind it; what only the program has is
 * 0; what only the library has is as by default; and what a newer program asks for and the library
 * does not know is LAR_ERROR_UNSUPPORTED. Other languages call those with a size, of their own
 * struct.
 *
 * These stay as they are: lar_error, lar_array_set, lar_surface_arrays, lar_set_info,
 * lar_surface_info, lar_embedded_info, lar_ray_hit, lar_model_contact_info, lar_tool_pose,
 * lar_grid_aim, lar_memory_hooks, lar_thread_hooks, lar_touch, lar_rest, lar_grasp_answer,
 * lar_tool_load, lar_server_options and all that is in another struct, but at its end. The library
 * makes lar_snapshot, so that may grow.
 */
#ifndef LARIAT_SIZES_H
#define LARIAT_SIZES_H

#ifndef LARIAT_H
#error "lariat_sizes.h is a part of lariat.h: include that"
#endif

#ifdef __cplusplus
extern "C" {
#endif

LAR_API lar_status lar_model_from_arrays_sized(const lar_mesh_arrays *mesh, size_t size,
                                               const char *scene, lar_model **model,
                                               lar_error *error);
LAR_API lar_status lar_model_inspect_sized(const lar_model *model, lar_model_info *info,
                                           size_t size, lar_error *error);
LAR_API lar_status lar_model_material_sized(const lar_model *model, int32_t index,
                                            lar_material_info *info, size_t size, lar_error *error);
LAR_API lar_status lar_model_tool_sized(const lar_model *model, int32_t index, lar_tool_info *info,
                                        size_t size, lar_error *error);
LAR_API lar_status lar_model_quality_sized(const lar_model *model, const char *against,
                                           double scale, lar_mesh_quality *quality, size_t size,
                                           lar_error *error);
LAR_API void lar_meshing_options_default_sized(lar_meshing_options *options, size_t size);
LAR_API lar_status lar_meshing_create_sized(const char *const *paths, int32_t count,
                                            const lar_meshing_options *options, size_t size,
                                            lar_meshing **meshing, lar_error *error);
LAR_API lar_status lar_meshing_of_image_sized(const lar_image *image,
                                              const lar_meshing_options *options, size_t size,
                                              lar_meshing **meshing, lar_error *error);
LAR_API lar_status lar_meshing_of_surfaces_sized(const lar_surface_arrays *surface, int32_t count,
                                                 const lar_meshing_options *options, size_t size,
                                                 lar_meshing **meshing, lar_error *error);
LAR_API void lar_meshing_arrays_sized(const lar_meshing *meshing, lar_mesh_arrays *mesh,
                                      size_t size, lar_surface_arrays *surface);
LAR_API void lar_meshing_inspect_sized(const lar_meshing *meshing, lar_meshing_info *info,
                                       size_t size);
LAR_API lar_status lar_meshing_region_sized(const lar_meshing *meshing, int32_t index,
                                            lar_region_info *info, size_t size, lar_error *error);
LAR_API lar_status lar_image_create_sized(const lar_image_info *from, size_t size,
                                          const char *const *name, const int32_t *named,
                                          lar_image **image, lar_error *error);
LAR_API void lar_image_inspect_sized(const lar_image *image, lar_image_info *info, size_t size);
LAR_API void lar_options_default_sized(lar_options *options, size_t size);
LAR_API lar_status lar_grid_choose_sized(const lar_model *model, const lar_options *options,
                                         size_t options_size, const lar_grid_aim *aim,
                                         lar_grid_choice *choice, size_t choice_size,
                                         lar_error *error);
LAR_API lar_status lar_simulation_create_sized(const lar_model *model, const lar_options *options,
                                               size_t size, lar_simulation **simulation,
                                               lar_error *error);
LAR_API void lar_simulation_inspect_sized(const lar_simulation *simulation,
                                          lar_simulation_info *info, size_t size);
LAR_API void lar_simulation_energy_sized(const lar_simulation *simulation, lar_energy *energy,
                                         size_t size);
LAR_API lar_status lar_simulation_tool_sized(const lar_simulation *simulation, int32_t index,
                                             lar_tool_info *info, size_t size, lar_error *error);
LAR_API lar_status lar_simulation_tool_force_sized(const lar_simulation *simulation, int32_t tool,
                                                   lar_tool_force *force, size_t size,
                                                   lar_error *error);
LAR_API lar_status lar_simulation_add_tool_sized(lar_simulation *simulation,
                                                 const lar_tool_info *wanted, size_t size,
                                                 int32_t *tool, lar_error *error);
LAR_API void lar_simulation_heavier_sized(const lar_simulation *simulation, lar_heavier *heavier,
                                          size_t size);
LAR_API void lar_simulation_contact_sized(const lar_simulation *simulation, lar_contact_info *info,
                                          size_t size);
LAR_API lar_status lar_checkpoint_inspect_sized(const char *path, lar_checkpoint_info *info,
                                                size_t size, lar_error *error);
LAR_API void lar_session_options_default_sized(lar_session_options *options, size_t size);
LAR_API lar_status lar_session_open_sized(lar_simulation *simulation,
                                          const lar_session_options *options, size_t size,
                                          lar_session **session, lar_error *error);
LAR_API void lar_session_inspect_sized(const lar_session *session, lar_session_info *info,
                                       size_t size);
LAR_API lar_status lar_session_add_tool_sized(lar_session *session, const lar_tool_info *wanted,
                                              size_t size, int32_t *tool, lar_error *error);
LAR_API lar_status lar_session_tool_info_sized(const lar_session *session, int32_t tool,
                                               lar_tool_info *info, size_t size, lar_error *error);
LAR_API lar_status lar_session_tool_force_sized(const lar_session *session, int32_t tool,
                                                lar_tool_pose *pose, lar_tool_force *force,
                                                size_t size, lar_error *error);
LAR_API lar_status lar_session_device_sized(const lar_session *session, int32_t tool,
                                            lar_device_status *status, size_t size,
                                            lar_error *error);
LAR_API void lar_session_status_get_sized(const lar_session *session, lar_session_status *status,
                                          size_t size);
LAR_API lar_status lar_recording_inspect_sized(const char *path, lar_recording_info *info,
                                               size_t size, lar_error *error);
LAR_API lar_status lar_replay_sized(lar_simulation *simulation, const char *path,
                                    lar_step_callback *callback, void *context,
                                    lar_replay_report *report, size_t size, lar_error *error);

#ifndef LARIAT_LIBRARY
LAR_SIZED lar_status lar_model_from_arrays(const lar_mesh_arrays *mesh, const char *scene,
                                           lar_model **model, lar_error *error) {
    return lar_model_from_arrays_sized(mesh, sizeof *mesh, scene, model, error);
}
LAR_SIZED lar_status lar_model_inspect(const lar_model *model, lar_model_info *info,
                                       lar_error *error) {
    return lar_model_inspect_sized(model, info, sizeof *info, error);
}
LAR_SIZED lar_status lar_model_material(const lar_model *model, int32_t index,
                                        lar_material_info *info, lar_error *error) {
    return lar_model_material_sized(model, index, info, sizeof *info, error);
}
LAR_SIZED lar_status lar_model_tool(const lar_model *model, int32_t index, lar_tool_info *info,
                                    lar_error *error) {
    return lar_model_tool_sized(model, index, info, sizeof *info, error);
}
LAR_SIZED lar_status lar_model_quality(const lar_model *model, const char *against, double scale,
                                       lar_mesh_quality *quality, lar_error *error) {
    return lar_model_quality_sized(model, against, scale, quality, sizeof *quality, error);
}
LAR_SIZED lar_meshing_options lar_meshing_options_default(void) {
    lar_meshing_options options;
    lar_meshing_options_default_sized(&options, sizeof options);
    return options;
}
LAR_SIZED lar_status lar_meshing_create(const char *const *paths, int32_t count,
                                        const lar_meshing_options *options, lar_meshing **meshing,
                                        lar_error *error) {
    return lar_meshing_create_sized(paths, count, options, sizeof *options, meshing, error);
}
LAR_SIZED lar_status lar_meshing_of_image(const lar_image *image,
                                          const lar_meshing_options *options, lar_meshing **meshing,
                                          lar_error *error) {
    return lar_meshing_of_image_sized(image, options, sizeof *options, meshing, error);
}
LAR_SIZED lar_status lar_meshing_of_surfaces(const lar_surface_arrays *surface, int32_t count,
                                             const lar_meshing_options *options,
                                             lar_meshing **meshing, lar_error *error) {
    return lar_meshing_of_surfaces_sized(surface, count, options, sizeof *options, meshing, error);
}
LAR_SIZED void lar_meshing_arrays(const lar_meshing *meshing, lar_mesh_arrays *mesh,
                                  lar_surface_arrays *surface) {
    lar_meshing_arrays_sized(meshing, mesh, sizeof *mesh, surface);
}
LAR_SIZED void lar_meshing_inspect(const lar_meshing *meshing, lar_meshing_info *info) {
    lar_meshing_inspect_sized(meshing, info, sizeof *info);
}
LAR_SIZED lar_status lar_meshing_region(const lar_meshing *meshing, int32_t index,
                                        lar_region_info *info, lar_error *error) {
    return lar_meshing_region_sized(meshing, index, info, sizeof *info, error);
}
LAR_SIZED lar_status lar_image_create(const lar_image_info *from, const char *const *name,
                                      const int32_t *named, lar_image **image, lar_error *error) {
    return lar_image_create_sized(from, sizeof *from, name, named, image, error);
}
LAR_SIZED void lar_image_inspect(const lar_image *image, lar_image_info *info) {
    lar_image_inspect_sized(image, info, sizeof *info);
}
LAR_SIZED lar_options lar_options_default(void) {
    lar_options options;
    lar_options_default_sized(&options, sizeof options);
    return options;
}
LAR_SIZED lar_status lar_grid_choose(const lar_model *model, const lar_options *options,
                                     const lar_grid_aim *aim, lar_grid_choice *choice,
                                     lar_error *error) {
    return lar_grid_choose_sized(model, options, sizeof *options, aim, choice, sizeof *choice,
                                 error);
}
LAR_SIZED lar_status lar_simulation_create(const lar_model *model, const lar_options *options,
                                           lar_simulation **simulation, lar_error *error) {
    return lar_simulation_create_sized(model, options, sizeof *options, simulation, error);
}
LAR_SIZED void lar_simulation_inspect(const lar_simulation *simulation, lar_simulation_info *info) {
    lar_simulation_inspect_sized(simulation, info, sizeof *info);
}
LAR_SIZED void lar_simulation_energy(const lar_simulation *simulation, lar_energy *energy) {
    lar_simulation_energy_sized(simulation, energy, sizeof *energy);
}
LAR_SIZED lar_status lar_simulation_tool(const lar_simulation *simulation, int32_t index,
                                         lar_tool_info *info, lar_error *error) {
    return lar_simulation_tool_sized(simulation, index, info, sizeof *info, error);
}
LAR_SIZED lar_status lar_simulation_tool_force(const lar_simulation *simulation, int32_t tool,
                                               lar_tool_force *force, lar_error *error) {
    return lar_simulation_tool_force_sized(simulation, tool, force, sizeof *force, error);
}
LAR_SIZED lar_status lar_simulation_add_tool(lar_simulation *simulation,
                                             const lar_tool_info *wanted, int32_t *tool,
                                             lar_error *error) {
    return lar_simulation_add_tool_sized(simulation, wanted, sizeof *wanted, tool, error);
}
LAR_SIZED void lar_simulation_heavier(const lar_simulation *simulation, lar_heavier *heavier) {
    lar_simulation_heavier_sized(simulation, heavier, sizeof *heavier);
}
LAR_SIZED void lar_simulation_contact(const lar_simulation *simulation, lar_contact_info *info) {
    lar_simulation_contact_sized(simulation, info, sizeof *info);
}
LAR_SIZED lar_status lar_checkpoint_inspect(const char *path, lar_checkpoint_info *info,
                                            lar_error *error) {
    return lar_checkpoint_inspect_sized(path, info, sizeof *info, error);
}
LAR_SIZED lar_session_options lar_session_options_default(void) {
    lar_session_options options;
    lar_session_options_default_sized(&options, sizeof options);
    return options;
}
LAR_SIZED lar_status lar_session_open(lar_simulation *simulation,
                                      const lar_session_options *options, lar_session **session,
                                      lar_error *error) {
    return lar_session_open_sized(simulation, options, sizeof *options, session, error);
}
LAR_SIZED void lar_session_inspect(const lar_session *session, lar_session_info *info) {
    lar_session_inspect_sized(session, info, sizeof *info);
}
LAR_SIZED lar_status lar_session_add_tool(lar_session *session, const lar_tool_info *wanted,
                                          int32_t *tool, lar_error *error) {
    return lar_session_add_tool_sized(session, wanted, sizeof *wanted, tool, error);
}
LAR_SIZED lar_status lar_session_tool_info(const lar_session *session, int32_t tool,
                                           lar_tool_info *info, lar_error *error) {
    return lar_session_tool_info_sized(session, tool, info, sizeof *info, error);
}
LAR_SIZED lar_status lar_session_tool_force(const lar_session *session, int32_t tool,
                                            lar_tool_pose *pose, lar_tool_force *force,
                                            lar_error *error) {
    return lar_session_tool_force_sized(session, tool, pose, force, sizeof *force, error);
}
LAR_SIZED lar_status lar_session_device(const lar_session *session, int32_t tool,
                                        lar_device_status *status, lar_error *error) {
    return lar_session_device_sized(session, tool, status, sizeof *status, error);
}
LAR_SIZED void lar_session_status_get(const lar_session *session, lar_session_status *status) {
    lar_session_status_get_sized(session, status, sizeof *status);
}
LAR_SIZED lar_status lar_recording_inspect(const char *path, lar_recording_info *info,
                                           lar_error *error) {
    return lar_recording_inspect_sized(path, info, sizeof *info, error);
}
LAR_SIZED lar_status lar_replay(lar_simulation *simulation, const char *path,
                                lar_step_callback *callback, void *context,
                                lar_replay_report *report, lar_error *error) {
    return lar_replay_sized(simulation, path, callback, context, report, sizeof *report, error);
}
#endif

#ifdef __cplusplus
}
#endif
#endif
