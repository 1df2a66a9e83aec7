/* The scene reader's own header: what its sources share. The format is docs/formats.md.
 *
 *     bytes --yaml_tree.c--> tree --scene.c--> lar_model
 *                                     |
 *           scene_mesh.c      mesh files, several put together
 *           scene_sets.c      set names, ids, tags -> marks (one byte per node, element or face)
 *           scene_select.c    selectors -> marks -> lists of indices
 *           scene_material.c  materials
 *           scene_tissue.c    a material in a file of its own
 *           scene_fibre.c     fibres of materials
 *           scene_fibre_rule.c   along what they run
 *           scene_active.c    what is active of them, and when
 *           scene_motion.c    fix, move, springs, load, initial, curves
 *           scene_contact.c   contact
 *           scene_tools.c     tools
 *           scene_output.c    output, probes
 *           scene_surface.c   the embedded surface
 *           scene_value.c     numbers, words, keys, and every message's "FILE:LINE:COLUMN: "
 *
 * Every function here returns the status of lar_scene_fail, which has written the sentence.
 */
#ifndef LAR_MODEL_SCENE_SCENE_H
#define LAR_MODEL_SCENE_SCENE_H

#include "model/mesh/id_map.h"
#include "model/model.h"
#include "model/scene/yaml_tree.h"

/* Reads a mesh file; has the shape of lar_mesh_read, tests and fuzzing give another one. */
typedef lar_status lar_scene_mesh_reader(const char *path, double scale, lar_mesh *mesh,
                                         lar_error *error);

/* lar_scene_parse with another source of meshes. */
lar_status lar_scene_parse_with(const char *path, const lar_bytes *bytes,
                                lar_scene_mesh_reader *read_mesh, lar_model **model,
                                lar_error *error);

/* The same of a mesh from memory: the scene names no file. */
lar_status lar_scene_parse_given(const char *path, const lar_bytes *bytes,
                                 const lar_mesh_arrays *given, lar_model **model, lar_error *error);

/* The directions of a mesh by a rule as scenes have it, with braces around or without. material:
 * [elements] 0 to `materials` - 1, as each of which the rule is followed by itself; -1: it has no
 * fibres. Messages begin with "fibres:LINE:COLUMN: ". */
lar_status lar_scene_fibres_by_rule(const char *words, const int32_t *material, int materials,
                                    lar_mesh *mesh, lar_error *error);

typedef struct lar_scene {
    const char *path;
    const lar_yaml *root;
    lar_scene_mesh_reader *read_mesh;
    const lar_mesh_arrays *given; /* instead; NULL: the mesh is in files */
    lar_model *model;             /* growing */
    lar_error *error;

    /* Made when first asked for (scene_sets.c). */
    lar_id_map node_ids, element_ids;
    int32_t *boundary; /* faces, as lar_mesh_boundary gives them */
    int32_t boundary_count;
    double size; /* diagonal of the mesh's bounding box [m] */

    int *axis_line; /* [nodes][3]: the line that fixes (< 0) or moves (> 0) it, 0 free */
} lar_scene;

/* ---- scene_value.c ------------------------------------------------------------------------ */

/* "FILE:LINE:COLUMN: " of `at` and the sentence. */
lar_status lar_scene_fail(const lar_scene *scene, const lar_yaml *at, lar_status status,
                          const char *format, ...) __attribute__((format(printf, 4, 5)));
lar_status lar_scene_no_memory(const lar_scene *scene, size_t bytes);

/* "WHAT WORD is unknown; did you mean ...? ..." with the names that exist (`list` introduces
 * them). */
lar_status lar_scene_unknown(const lar_scene *scene, const lar_yaml *at, lar_status status,
                             const char *what, const char *list, const char *const *names,
                             int count);

/* `node` is a mapping with no other keys than `keys` (ends with NULL). `what`: "a fix entry". */
lar_status lar_scene_keys(const lar_scene *scene, const lar_yaml *node, const char *what,
                          const char *const *keys);
/* `node` is a list. `what` says of what. */
lar_status lar_scene_list(const lar_scene *scene, const lar_yaml *node, const char *what);
/* The value of a key that must be there; `example` says how to write it. */
lar_status lar_scene_need(const lar_scene *scene, const lar_yaml *mapping, const char *what,
                          const char *key, const char *example, const lar_yaml **value);

/* What a number is, for messages. */
#define LAR_IN_PASCAL     "a number in pascal (SI units), for example 4.0e3"
#define LAR_IN_METRES     "a number in metres (SI units), for example 0.01"
#define LAR_IN_SECONDS    "a number in seconds (SI units), for example 0.2"
#define LAR_IN_DENSITY    "a number in kg/m^3 (SI units), for example 1050"
#define LAR_IN_NEWTON     "three numbers in newton (SI units), for example [0, 0, -0.1]"
#define LAR_IN_POSITION   "three numbers in metres (SI units), for example [0, 0, 0.01]"
#define LAR_IN_VELOCITY   "three numbers in m/s (SI units), for example [0, 0, 0.5]"
#define LAR_A_DIRECTION   "three numbers, a direction, for example [0, 0, 1]"
#define LAR_IN_DEGREES    "a number in degrees, for example 60"
#define LAR_A_FRICTION    "a number from 0 to 5, for example 0.3"
#define LAR_A_RESTITUTION "a number from 0 to 1, for example 0.5"
#define LAR_IN_GRAVITY    "three numbers in m/s^2 (SI units), for example [0, 0, -9.81]"

/* A finite number that is written without quotes and unit. */
lar_status lar_scene_number(const lar_scene *scene, const lar_yaml *node, const char *expected,
                            double *value);
/* The same, more than zero, or at least zero. */
lar_status lar_scene_positive(const lar_scene *scene, const lar_yaml *node, const char *expected,
                              double *value);
/* `friction: MU` of a contact entry or a tool, where it is there. */
lar_status lar_scene_friction(const lar_scene *scene, const lar_yaml *entry, double *friction);
lar_status lar_scene_not_negative(const lar_scene *scene, const lar_yaml *node,
                                  const char *expected, double *value);
lar_status lar_scene_vector(const lar_scene *scene, const lar_yaml *node, const char *expected,
                            double value[3]);
/* The same, brought to length one. */
lar_status lar_scene_direction(const lar_scene *scene, const lar_yaml *node, double unit[3]);
/* Some of x, y and z, as bits. */
lar_status lar_scene_axes(const lar_scene *scene, const lar_yaml *node, unsigned *axes);
lar_status lar_scene_integer(const lar_scene *scene, const lar_yaml *node, const char *expected,
                             int64_t *value);
/* True when the node is written like an integer. */
bool lar_scene_is_integer(const lar_yaml *node, int64_t *value);
/* A text that is not empty. */
lar_status lar_scene_text(const lar_scene *scene, const lar_yaml *node, const char *expected,
                          const char **value);
bool lar_scene_is_word(const lar_yaml *node, const char *word);

/* ---- scene_mesh.c ------------------------------------------------------------------------- */

/* The key `mesh`; of a mesh that was given it is not there, or says so. */
lar_status lar_scene_check_mesh(const lar_scene *scene, const lar_yaml **mesh);
lar_status lar_scene_read_meshes(lar_scene *scene, const lar_yaml *node, double scale);
/* The diagonal of the mesh's bounding box [m]. */
double lar_scene_size(const lar_mesh *mesh);

/* ---- scene_sets.c -------------------------------------------------------------------------- */

/* Marks: one byte per node, per element, or per face (element * 6 + local face). The functions
 * below set bytes to 1 and leave the others alone. */
size_t lar_scene_mark_count(const lar_scene *scene, lar_set_kind kind);
lar_status lar_scene_mark_set(lar_scene *scene, const lar_yaml *name, lar_set_kind kind,
                              uint8_t *mark);
lar_status lar_scene_mark_tag(lar_scene *scene, const lar_yaml *tag, lar_set_kind kind,
                              uint8_t *mark);
/* `id` is an integer as lar_scene_is_integer takes it; nodes and elements only. */
lar_status lar_scene_mark_id(lar_scene *scene, const lar_yaml *id, lar_set_kind kind,
                             uint8_t *mark);
/* Everything on the boundary. */
lar_status lar_scene_mark_surface(lar_scene *scene, lar_set_kind kind, uint8_t *mark);

/* Fills scene->boundary. */
lar_status lar_scene_need_boundary(lar_scene *scene);
/* Fills scene->model->surface. */
lar_status lar_scene_need_surface(lar_scene *scene);
void lar_scene_sets_clear(lar_scene *scene);

/* The key `sets`. */
lar_status lar_scene_read_sets(lar_scene *scene, const lar_yaml *node);

/* ---- scene_select.c ----------------------------------------------------------------------- */

/* What `nodes:`, `faces:`, `elements:` and `cells:` take: "all", a set name, an integer, a
 * selector mapping, or a list of those. Gives the indices, ascending; the caller frees them. An
 * empty selection is an error. Integers are node ids, and tags where `tags` is true (cells). */
lar_status lar_scene_select(lar_scene *scene, const lar_yaml *node, lar_set_kind kind, bool tags,
                            int32_t **index, int32_t *count);
lar_status lar_scene_select_nodes(lar_scene *scene, const lar_yaml *node, lar_node_list *nodes);

/* ---- scene_material.c, scene_motion.c, scene_contact.c, scene_tools.c, scene_output.c,
 * scene_surface.c ---------------------------------------------------------------------------- */

/* Notes who holds which axis, for messages with lines; a moved axis must not be held by another
 * entry. Lines of fix entries are kept as negative numbers. */
lar_status lar_scene_claim_axes(lar_scene *scene, const lar_yaml *entry, const lar_node_list *nodes,
                                unsigned axes, bool moved);
lar_status lar_scene_read_materials(lar_scene *scene, const lar_yaml *node);
/* Law, density, stiffness and viscosity from keys of a mapping, an entry of a scene or a tissue
 * file: reads all of `material` but its cells, name and fibres. */
lar_status lar_scene_read_material(const lar_scene *scene, const lar_yaml *node,
                                   lar_material *material);
/* The same from the file that the key `tissue` of a material names. */
lar_status lar_scene_read_tissue(lar_scene *scene, const lar_yaml *entry, lar_material *material);
/* And from a tissue file itself, whose text is `bytes`. */
lar_status lar_tissue_read(const char *path, const lar_bytes *bytes, lar_material *material,
                           lar_error *error);
/* Whether it is a tissue file that is read. */
bool lar_scene_is_tissue(const lar_scene *scene);
/* The fibres of a material; and, when all elements have their materials, the directions of those of
 * one (scene_fibre_rule.c). */
lar_status lar_scene_read_fibres(const lar_scene *scene, const lar_yaml *node,
                                 lar_material *material);
lar_status lar_scene_lay_fibres(lar_scene *scene, const lar_yaml *node, int material);
/* The key `active` of these (scene_active.c). */
lar_status lar_scene_read_active(const lar_scene *scene, const lar_yaml *node,
                                 lar_material *material);
/* `over` or `curve` of an entry; *index stays where neither is there. */
lar_status lar_scene_read_course(const lar_scene *scene, const lar_yaml *entry, bool motion,
                                 int *index);
lar_status lar_scene_read_fix(lar_scene *scene, const lar_yaml *node);
lar_status lar_scene_read_move(lar_scene *scene, const lar_yaml *node);
lar_status lar_scene_read_load(lar_scene *scene, const lar_yaml *node);
lar_status lar_scene_read_initial(lar_scene *scene, const lar_yaml *node);
lar_status lar_scene_read_springs(lar_scene *scene, const lar_yaml *node);
lar_status lar_scene_read_contact(lar_scene *scene, const lar_yaml *node);
lar_status lar_scene_read_tools(lar_scene *scene, const lar_yaml *node);
lar_status lar_scene_read_output(lar_scene *scene, const lar_yaml *node);
lar_status lar_scene_read_surface(lar_scene *scene, const lar_yaml *node);

#endif
