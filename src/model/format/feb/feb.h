/* FEBio decks (.feb, format versions 2.5, 3.0 and 4.0): what the parts of the reader share.
 *
 *     bytes --libxml2--> tree --feb_mesh--> lar_mesh          lar_feb_parse_mesh stops here
 *                         |---feb_material, feb_curve, feb_conditions--> lar_model
 *
 * The whole tree is read first, because a deck's sections refer to each other by name in both
 * directions (a part to its material, a support to its node set, a load to its curve). After
 * that every section is visited once. A rule holds throughout: what is not read is either
 * harmless (solver settings, output), or refused (LAR_ERROR_UNSUPPORTED) when leaving it out
 * would change the answer, or named in a notice. Nothing is skipped in silence.
 *
 * libxml2 runs without network, without entity substitution, without the limits lifted, and stops
 * at the first <!DOCTYPE: a deck has no use for entities, an attacker has.
 */
#ifndef LAR_MODEL_FORMAT_FEB_FEB_H
#define LAR_MODEL_FORMAT_FEB_FEB_H

#include <libxml/tree.h>

#include "base/text.h"
#include "model/model.h"

/* One <material>. */
typedef struct lar_feb_material {
    int32_t id;
    const char *name;
    xmlNode *node;
    int index; /* in lar_model.material, -1 until an element uses it */
} lar_feb_material;

/* One <load_controller>. A curve that cannot be read is no error until something uses it. */
typedef struct lar_feb_controller {
    int64_t id;
    xmlNode *node;
    int curve; /* in lar_model.curve, -1 when `problem` says why not */
    const char *problem;
} lar_feb_controller;

/* A condition that holds nodes: where it stands, and in lar_model.move, -1: it fixes them. */
typedef struct lar_feb_holder {
    const xmlNode *at;
    int move;
} lar_feb_holder;

/* A body of a material of type "rigid body": what it does along x, y and z, and about them. */
typedef struct lar_feb_body {
    int material;         /* in lar_feb.material */
    const xmlNode *at[6]; /* what says so, NULL: nothing does */
    double value[6];      /* [m], [rad] */
    int curve[6];         /* in lar_model.curve, -1: held */
    uint8_t *tied;        /* [node_count] nodes that go with it, or NULL */
} lar_feb_body;

typedef struct lar_feb {
    const char *path;
    lar_error *error;
    xmlDoc *document;
    xmlNode *root;
    xmlDict *strings; /* owns text that had to be put together */
    int64_t ids_left; /* that ranges in sets may still name */

    lar_mesh *mesh;
    lar_model *model;   /* NULL when only the mesh is wanted */
    bool is_static;     /* the analysis */
    double first_step;  /* time step of the deck, 0: it says none [s] */
    bool weightless;    /* the answer does not depend on density: static, no body load */
    int constant_curve; /* the curve that is 1 for ever, -1 until wanted */

    int material_count;
    size_t material_room;
    lar_feb_material *material;
    int controller_count;
    size_t controller_room;
    lar_feb_controller *controller;
    int holder_count;
    size_t holder_room;
    lar_feb_holder *holder;
    int body_count;
    size_t body_room;
    lar_feb_body *body;
    int32_t *held; /* per node and axis 1 + its holder, 0: none; NULL before the first one */
} lar_feb;

/* ---- xml.c: the tree, its messages and its values --------------------------------------- */

/* Parses the bytes into feb->document and feb->root and checks the version. `feb` is zeroed
 * before and cleared by lar_feb_clear, also after a failure. */
lar_status lar_feb_open(lar_feb *feb, const char *path, const lar_bytes *bytes, lar_error *error);
void lar_feb_clear(lar_feb *feb);

/* old.c: a tree of version 2.5 in the words of 4.0. A type that is none there keeps this name. */
#define LAR_FEB_OLD_TYPE "old-type"
lar_status lar_feb_renew(lar_feb *feb);

/* A failure and a notice that begin with FILE:LINE: of an element. */
lar_status lar_feb_fail(const lar_feb *feb, const xmlNode *at, lar_status status,
                        const char *format, ...) __attribute__((format(printf, 4, 5)));
lar_status lar_feb_notice(const lar_feb *feb, const xmlNode *at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* A notice for every child of `parent` whose name is not among `known`, with spaces in between. Of
 * those one is read, a second one is refused; but for the parts of a mixture, <solid>. */
lar_status lar_feb_notice_others(const lar_feb *feb, const xmlNode *parent, const char *known);
/* The same for attributes, in all that is read of the deck. */
lar_status lar_feb_notice_attributes(const lar_feb *feb, const xmlNode *parent);
/* Refuses an element that another file holds: from="...". */
lar_status lar_feb_refuse_files(lar_feb *feb, const xmlNode *parent);
lar_status lar_feb_no_memory(const lar_feb *feb, const char *what);
int lar_feb_line(const xmlNode *at);

/* Child elements: the first, the next sibling, the first with a name. NULL when there is none. */
xmlNode *lar_feb_first(const xmlNode *parent);
xmlNode *lar_feb_next(const xmlNode *element);
xmlNode *lar_feb_child(const xmlNode *parent, const char *name);
bool lar_feb_is(const xmlNode *element, const char *name);
/* What the deck calls it, also where old.c has renamed it. */
const char *lar_feb_name(const xmlNode *element);
bool lar_feb_is_any(const xmlNode *element, const char *names); /* with spaces in between */

/* Value of an attribute, NULL when it is missing. Lives as long as `feb`. */
const char *lar_feb_attribute(lar_feb *feb, const xmlNode *element, const char *name);
/* The same, missing or empty being an error. */
lar_status lar_feb_need_attribute(lar_feb *feb, const xmlNode *element, const char *name,
                                  const char **value);
/* A whole number in an attribute (an id). */
lar_status lar_feb_id_attribute(lar_feb *feb, const xmlNode *element, const char *name,
                                int64_t *value);
/* Text of an element without white space at both ends; terminated one byte after the untrimmed
 * text. Lives as long as `feb`. */
lar_span lar_feb_text(lar_feb *feb, const xmlNode *element);

/* The same as a string of its own, without white space at both ends; NULL: no memory. */
const char *lar_feb_word(lar_feb *feb, const xmlNode *element);

/* Values separated by commas or white space, with the line where each stands. */
typedef struct lar_feb_list {
    const char *at, *end;
    int line;
} lar_feb_list;
lar_feb_list lar_feb_list_of(lar_feb *feb, const xmlNode *element);
bool lar_feb_list_next(lar_feb_list *list, lar_span *item);

/* The ids in the text of a set: numbers, and ranges first:last and first:last:step as FEBio reads
 * them. */
typedef struct lar_feb_id_list {
    lar_feb_list text;
    int64_t next, last, step; /* what is left of a range */
} lar_feb_id_list;
lar_feb_id_list lar_feb_id_list_of(lar_feb *feb, const xmlNode *set);
/* *found: false at the end. */
lar_status lar_feb_next_id(lar_feb *feb, lar_feb_id_list *list, int64_t *id, bool *found);

/* Exactly `count` finite numbers, or ids, in the text of an element. */
lar_status lar_feb_doubles(lar_feb *feb, const xmlNode *element, double *value, int count);
lar_status lar_feb_ids(lar_feb *feb, const xmlNode *element, int64_t *id, int count);
/* 0 or 1 in the child `name` of `parent`, all else is refused; `fallback` when there is no such
 * child. */
lar_status lar_feb_flag(lar_feb *feb, const xmlNode *parent, const char *name, bool fallback,
                        bool *value);

/* ---- mesh.c ---------------------------------------------------------------------------------- */

/* Reads <Mesh> into feb->mesh. Element tags are material ids, 0 where none is named. Needs the
 * material table. */
lar_status lar_feb_read_mesh(lar_feb *feb);
/* The nodes that a reference names: a node set, or @surface:, @elem_set:, @part_list:. */
lar_status lar_feb_node_list(lar_feb *feb, const xmlNode *at, const char *reference,
                             lar_node_list *list);
/* True in *all when an element reference (set, part, @part_list:, @elem_set:) is the whole mesh. */
lar_status lar_feb_is_whole_mesh(lar_feb *feb, const xmlNode *at, const char *reference, bool *all);
/* Something names a set that the mesh does not define, or a surface of other faces than quad4. */
lar_status lar_feb_no_set(lar_feb *feb, const xmlNode *at, const char *kind, const char *name);
/* The <Surface> of that name, NULL when there is none. */
xmlNode *lar_feb_find_surface(lar_feb *feb, const char *name);

/* ---- material.c ------------------------------------------------------------------------------ */

/* Lists the <material> entries without reading their parameters. */
lar_status lar_feb_list_materials(lar_feb *feb);
/* The material that an <Elements> part is made of (its `mat`, else its SolidDomain's), NULL when
 * none is named; a name that no material bears is an error. */
lar_status lar_feb_part_material(lar_feb *feb, const xmlNode *elements,
                                 const lar_feb_material **material);
/* Reads the materials that elements use into the model and assigns them. */
lar_status lar_feb_read_materials(lar_feb *feb);

/* One parameter that does not vary in space or time. A missing one keeps *value when that is
 * allowed. */
lar_status lar_feb_parameter(lar_feb *feb, const xmlNode *material, const char *name, bool required,
                             double *value);

/* ---- fibre.c --------------------------------------------------------------------------------- */

/* Whether a type within a mixture is one of fibres; reads it, and those of a "trans iso" law. */
bool lar_feb_is_fibre(const char *type);
lar_status lar_feb_read_fibre(lar_feb *feb, const xmlNode *node, const char *type,
                              lar_fibre *fibre);
lar_status lar_feb_read_trans_iso(lar_feb *feb, const xmlNode *node, lar_fibre *fibre);
/* The same of what contracts; a curve that its stress follows is looked up when there are curves
 * (lar_feb_read_activation). */
bool lar_feb_is_active(const char *type);
/* Type i of both kinds, NULL behind the last one. */
const char *lar_feb_fibre_name(int i);
lar_status lar_feb_read_active(lar_feb *feb, const xmlNode *node, const char *type,
                               lar_fibre *fibre);
lar_status lar_feb_read_activation(lar_feb *feb);

/* ---- direction.c ----------------------------------------------------------------------------- */

/* Turns a direction of element e from its axes, of which the first runs along a and the second in
 * the plane of a and d on d's side, to those of the mesh. */
lar_status lar_feb_turn(lar_feb *feb, const xmlNode *at, int32_t e, const double a[3],
                        const double d[3], double direction[3]);
/* Gives all elements with fibres their directions; the materials are assigned. */
lar_status lar_feb_lay_fibres(lar_feb *feb);
/* Whether an entry of <MeshData> says directions. */
bool lar_feb_is_direction(lar_feb *feb, const xmlNode *data);

/* ---- hgo.c ----------------------------------------------------------------------------------- */

/* "Holzapfel-Gasser-Ogden", which has two families of fibres; and their directions, in one element
 * by vectors a and d, and in those of a material by its <mat_axis>, NULL: by the axes x and y. The
 * arrays of the mesh are there. */
bool lar_feb_is_hgo(const char *type);
lar_status lar_feb_read_hgo(lar_feb *feb, const xmlNode *node, lar_material *material);
lar_status lar_feb_lay_pair(lar_feb *feb, const xmlNode *at, int32_t e, const double a[3],
                            const double d[3]);
lar_status lar_feb_lay_pairs(lar_feb *feb, const xmlNode *node, const xmlNode *rule, int material);

/* ---- curve.c --------------------------------------------------------------------------------- */

/* Reads <LoadData>; the model's duration must be known. */
lar_status lar_feb_read_curves(lar_feb *feb);
/* The curve that the `lc` of a value names, or the constant one. Refuses values that are maps or
 * expressions, and only that where `curve` is NULL. */
lar_status lar_feb_curve_of(lar_feb *feb, const xmlNode *value, int *curve);

/* ---- conditions.c ---------------------------------------------------------------------------- */

/* The child that every condition of this kind must have. */
lar_status lar_feb_need_child(lar_feb *feb, const xmlNode *parent, const char *name,
                              const xmlNode **child);
/* Nodes of the attribute node_set. *list is owned by the caller, also after a failure. */
lar_status lar_feb_nodes_of(lar_feb *feb, const xmlNode *at, lar_node_list *list);
/* "x", "y" or "z" as an axis number; more than 2, with a notice, for those of shells. */
lar_status lar_feb_axis_of(lar_feb *feb, const xmlNode *at, lar_span word, int *axis);
lar_status lar_feb_refuse_type(lar_feb *feb, const xmlNode *at, const char *known);
/* Refuses flags that ask for something else than FEBio's default. */
lar_status lar_feb_check_flags(lar_feb *feb, const xmlNode *at);
/* The child `name`, `count` numbers, times <scale>, which may also stand alone for one number, and
 * the curve that either of them follows. */
lar_status lar_feb_scaled(lar_feb *feb, const xmlNode *at, const char *name, double *value,
                          int count, int *curve);

/* Writes down that the condition `at` holds the nodes along these axes; `move` NULL: fixed. Nodes
 * that move in the same way already leave the list. */
lar_status lar_feb_hold(lar_feb *feb, const xmlNode *at, unsigned axes, lar_node_list *nodes,
                        const lar_move *move);
/* Where something is displaced at the start. */
lar_status lar_feb_notice_at_once(lar_feb *feb, const xmlNode *value, double by, int curve);

lar_status lar_feb_read_boundary(lar_feb *feb, const xmlNode *section);
lar_status lar_feb_read_initial(lar_feb *feb, const xmlNode *section);

/* ---- loads.c --------------------------------------------------------------------------------- */

lar_status lar_feb_read_loads(lar_feb *feb, const xmlNode *section);

/* ---- rigid.c --------------------------------------------------------------------------------- */

bool lar_feb_is_rigid(lar_feb *feb, const lar_feb_material *material);
lar_status lar_feb_read_rigid(lar_feb *feb, const xmlNode *section);
/* Of version 2.5, in <Boundary>; and a <bc> that ties nodes to such a body. */
lar_status lar_feb_read_rigid_body(lar_feb *feb, const xmlNode *node);
lar_status lar_feb_tie_to_rigid(lar_feb *feb, const xmlNode *at);
/* When all sections are read: makes supports of them. */
lar_status lar_feb_hold_rigid(lar_feb *feb);
/* When all materials are read: what their elements are made of; when the deck's own densities are
 * those of the run, how heavy they are. */
lar_status lar_feb_fill_rigid(lar_feb *feb);
lar_status lar_feb_weigh_rigid(lar_feb *feb);

/* ---- contact.c ------------------------------------------------------------------------------- */

lar_status lar_feb_read_contact(lar_feb *feb, const xmlNode *section);

#endif
