/* What liblariat lends liblariat-fit, of what is not public: one table, the only thing that it
 * exports beside the functions of lariat.h.
 *
 *     liblariat-fit.so                              liblariat.so
 *       study/inverse, compiled with lent_names.h     lar_lent_to_fit: { version, sizes,
 *       lar_calloc(...)  ------------------------>      &lar_calloc, &lar_scene_fail, ... }
 *
 * A fit needs the reader's words for a YAML file, a model whose materials it may change, forces of
 * supports. With the engine once more inside, that library would have memory functions of its own
 * and be ten times as large; functions that are exported one by one would look as if they were
 * promised. Both libraries are of one build: lar_fit_open compares version and sizes, since structs
 * are shared. No other program may use this.
 */
#ifndef LAR_SIMULATION_LENT_H
#define LAR_SIMULATION_LENT_H

#include "base/file/folder.h"
#include "base/file/part_file.h"
#include "base/json/write.h"
#include "base/memory.h"
#include "base/parallel_for.h"
#include "base/text.h"
#include "law/law.h"
#include "model/rest.h"
#include "model/scene/scene.h"
#include "model/triangles/surface_tree.h"
#include "simulation/rest.h"
#include "simulation/simulation.h"

/* clang-format off */
#define LAR_LENT(X) \
    X(lar_bytes_free) X(lar_bytes_read) X(lar_calloc) X(lar_embedded_surface_bind) \
    X(lar_embedded_surface_clear) X(lar_face_node) X(lar_fail) X(lar_fail_memory) \
    X(lar_fibre_law_name) X(lar_fibre_parameter_name) X(lar_folder_join) X(lar_folder_make) \
    X(lar_grow_array) X(lar_host_aligned) X(lar_host_calloc) X(lar_host_free) X(lar_host_malloc) \
    X(lar_host_realloc) X(lar_json_boolean) X(lar_json_close) X(lar_json_end) X(lar_json_integer) \
    X(lar_json_number) X(lar_json_open) X(lar_json_text) X(lar_json_to) X(lar_json_vector) \
    X(lar_law_table) X(lar_material_check) X(lar_material_from_shear_bulk) \
    X(lar_material_from_young) X(lar_measure_reaction) X(lar_model_slow_period) \
    X(lar_parallel_for) X(lar_part_close) X(lar_part_open) X(lar_path_beside) X(lar_rest_damping) \
    X(lar_scene_direction) X(lar_scene_fail) X(lar_scene_integer) \
    X(lar_scene_is_integer) X(lar_scene_is_word) X(lar_scene_keys) X(lar_scene_list) \
    X(lar_scene_need) X(lar_scene_no_memory) X(lar_scene_number) X(lar_scene_positive) \
    X(lar_scene_text) X(lar_scene_unknown) X(lar_scene_vector) X(lar_simulation_state) \
    X(lar_span_double) X(lar_span_split) X(lar_span_trim) X(lar_strdup) X(lar_strndup) \
    X(lar_surface_tree_clear) X(lar_surface_tree_create) X(lar_text_line) X(lar_text_open) \
    X(lar_triangle_tree_nearest) X(lar_triangles_clear) X(lar_triangles_normal) X(lar_yaml_clear) \
    X(lar_yaml_get) X(lar_yaml_parse)
/* clang-format on */

#define LAR_LENT_MEMBER(name) __typeof__(name) *name;
typedef struct lar_lent {
    const char *version;            /* of the library */
    size_t size, model, simulation; /* of this struct and of those */
    LAR_LENT(LAR_LENT_MEMBER)
} lar_lent;

extern LAR_API const lar_lent lar_lent_to_fit;

#endif
