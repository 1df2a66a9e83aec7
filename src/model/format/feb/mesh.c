/* FEBio decks: nodes, elements and sets. See feb.h.
 *
 * A part (<Elements name=...>) becomes an element set of its name, a named <Nodes> block a node
 * set unless a <NodeSet> has that name already.
 */
#include "model/format/feb/feb.h"

#include <stdlib.h>
#include <string.h>

#include <libxml/hash.h>

#include "model/mesh/builder.h"

typedef struct mesh_reader {
    lar_feb *feb;
    lar_mesh_builder *builder;
    xmlHashTable *names; /* "kind" + name of what is defined already */
} mesh_reader;

/* Refuses a second definition of a name. `kind` sorts the names into spaces of their own. */
static lar_status define_name(mesh_reader *reader, const xmlNode *at, const char *kind,
                              const char *name) {
    if (xmlHashLookup2(reader->names, (const xmlChar *)kind, (const xmlChar *)name))
        return lar_feb_fail(reader->feb, at, LAR_ERROR_FORMAT,
                            "a second %s has the name '%.100s'; rename one of them", kind, name);
    if (xmlHashAddEntry2(reader->names, (const xmlChar *)kind, (const xmlChar *)name, reader))
        return lar_feb_no_memory(reader->feb, "set names");
    return LAR_OK;
}

static lar_status read_nodes(mesh_reader *reader, const xmlNode *block) {
    lar_feb *feb = reader->feb;
    const char *name = lar_feb_attribute(feb, block, "name");
    bool named = name && *name &&
                 !xmlHashLookup2(reader->names, (const xmlChar *)"node set", (const xmlChar *)name);
    lar_status status = LAR_OK;
    if (named) status = lar_mesh_builder_set(reader->builder, name, LAR_SET_NODES, feb->error);
    for (xmlNode *node = lar_feb_first(block); node && !status; node = lar_feb_next(node)) {
        if (!lar_feb_is_any(node, "node n"))
            return lar_feb_fail(feb, node, LAR_ERROR_FORMAT,
                                "<%s> stands among the nodes; only <node id=\"...\">x,y,z</node> "
                                "belongs there",
                                (const char *)node->name);
        int64_t id;
        double position[3];
        int line = lar_feb_line(node);
        status = lar_feb_id_attribute(feb, node, "id", &id);
        if (!status) status = lar_feb_doubles(feb, node, position, 3);
        if (!status)
            status = lar_mesh_builder_node(reader->builder, id, position, line, feb->error);
        if (!status && named)
            status = lar_mesh_builder_set_id(reader->builder, id, line, feb->error);
    }
    return status;
}

/* The solids of FEBio by their corners; those of a mesh without a model may be any. */
static const struct solid_type {
    const char *type;
    int nodes, corners;
    const char *name;
} solid_types[] = {{"hex8", 8, 8, "hexahedron"},
                   {"tet4", 4, 4, "four-node tetrahedron"},
                   {"tet10", 10, 4, "ten-node tetrahedron"},
                   {"tet15", 15, 4, "15-node tetrahedron"},
                   {"penta6", 6, 6, "six-node prism"},
                   {"penta15", 15, 6, "15-node prism"},
                   {"pyra5", 5, 5, "five-node pyramid"},
                   {"pyra13", 13, 5, "13-node pyramid"}};
enum { SOLID_TYPES = sizeof solid_types / sizeof solid_types[0], NODES_MAX = 15 };

static const struct solid_type *find_solid(const char *type) {
    for (int i = 0; i < SOLID_TYPES; i++)
        if (strcmp(type, solid_types[i].type) == 0) return &solid_types[i];
    return NULL;
}

/* Refuses parts that Lariat cannot make of hexahedra, by name. */
static lar_status check_part(mesh_reader *reader, const xmlNode *block,
                             const struct solid_type **solid) {
    lar_feb *feb = reader->feb;
    const char *type, *name = lar_feb_attribute(feb, block, "name");
    lar_status status = lar_feb_need_attribute(feb, block, "type", &type);
    if (status) return status;
    *solid = find_solid(type);
    if (!*solid)
        return lar_feb_fail(feb, block, LAR_ERROR_UNSUPPORTED,
                            "part '%.100s' has elements of type %.40s; Lariat computes with "
                            "eight-node hexahedra (hex8), mesh the part with those",
                            name ? name : "", type);
    if (feb->model && (*solid)->corners < 8)
        return lar_feb_fail(feb, block, LAR_ERROR_UNSUPPORTED,
                            "part '%.100s' has elements of type %.40s; Lariat computes with "
                            "eight-node hexahedra (hex8), make them of the mesh's boundary and "
                            "parts: lariat mesh %s",
                            name ? name : "", type, feb->path);
    return LAR_OK;
}

static lar_status read_elements(mesh_reader *reader, const xmlNode *block) {
    lar_feb *feb = reader->feb;
    const lar_feb_material *material = NULL;
    lar_status status = lar_feb_part_material(feb, block, &material);
    const struct solid_type *solid = NULL;
    if (!status) status = check_part(reader, block, &solid);
    const char *name = lar_feb_attribute(feb, block, "name");
    bool named = name && *name;
    if (!status && named) status = define_name(reader, block, "element set", name);
    if (!status && named)
        status = lar_mesh_builder_set(reader->builder, name, LAR_SET_ELEMENTS, feb->error);
    for (xmlNode *element = lar_feb_first(block); element && !status;
         element = lar_feb_next(element)) {
        if (!lar_feb_is_any(element, "elem e"))
            return lar_feb_fail(feb, element, LAR_ERROR_FORMAT,
                                "<%s> stands among the elements; only <elem id=\"...\"> belongs "
                                "there",
                                (const char *)element->name);
        int64_t id, corner[NODES_MAX];
        int line = lar_feb_line(element);
        int32_t tag = material ? material->id : 0;
        status = lar_feb_id_attribute(feb, element, "id", &id);
        if (!status) status = lar_feb_ids(feb, element, corner, solid->nodes);
        if (!status)
            status = solid->corners == 8
                         ? lar_mesh_builder_hexahedron(reader->builder, id, tag, corner, line,
                                                       feb->error)
                         : lar_mesh_builder_solid(reader->builder, id, tag, solid->name,
                                                  solid->corners, corner, line, feb->error);
        if (!status && named)
            status = lar_mesh_builder_set_id(reader->builder, id, line, feb->error);
    }
    return status;
}

/* Ids of a set: children with an id (3.0), or a list in the text (4.0). */
static lar_status read_set_ids(mesh_reader *reader, const xmlNode *set, const char *names) {
    lar_feb *feb = reader->feb;
    lar_status status = LAR_OK;
    int64_t id;
    xmlNode *child = lar_feb_first(set);
    if (child) {
        for (; child && !status; child = lar_feb_next(child)) {
            if (!lar_feb_is_any(child, names))
                return lar_feb_fail(feb, child, LAR_ERROR_UNSUPPORTED,
                                    "<%s> in a set is not read; list the ids themselves",
                                    (const char *)child->name);
            status = lar_feb_id_attribute(feb, child, "id", &id);
            if (!status)
                status =
                    lar_mesh_builder_set_id(reader->builder, id, lar_feb_line(child), feb->error);
        }
        return status;
    }
    lar_feb_id_list list = lar_feb_id_list_of(feb, set);
    for (bool found = true; !status;) {
        status = lar_feb_next_id(feb, &list, &id, &found);
        if (status || !found) return status;
        status = lar_mesh_builder_set_id(reader->builder, id, list.text.line, feb->error);
    }
    return status;
}

static lar_status read_surface(mesh_reader *reader, const xmlNode *surface) {
    lar_feb *feb = reader->feb;
    lar_status status = LAR_OK;
    if (lar_mesh_builder_has_solids(reader->builder)) return LAR_OK; /* only its parts count */
    for (xmlNode *face = lar_feb_first(surface); face && !status; face = lar_feb_next(face)) {
        int64_t corner[4];
        status = lar_feb_ids(feb, face, corner, 4);
        if (!status)
            status =
                lar_mesh_builder_set_quad(reader->builder, corner, lar_feb_line(face), feb->error);
    }
    return status;
}

/* The first face of a surface that is not one of a hexahedron, NULL: all are. */
static const xmlNode *foreign_face(const xmlNode *surface) {
    const xmlNode *face = lar_feb_first(surface);
    while (face && lar_feb_is(face, "quad4")) face = lar_feb_next(face);
    return face;
}

/* A named set of any kind. A surface of other faces is none, which matters where one names it. */
static lar_status read_set(mesh_reader *reader, const xmlNode *set, const char *kind_name,
                           lar_set_kind kind) {
    lar_feb *feb = reader->feb;
    const char *name;
    lar_status status = lar_feb_need_attribute(feb, set, "name", &name);
    if (!status && kind != LAR_SET_NODES) status = define_name(reader, set, kind_name, name);
    const xmlNode *foreign = status || kind != LAR_SET_FACES ? NULL : foreign_face(set);
    if (foreign && !lar_mesh_builder_has_solids(reader->builder))
        return lar_feb_notice(feb, foreign,
                              "the surface '%.100s' was left out: <%s> is no face of a hexahedron, "
                              "which quad4 is",
                              name, (const char *)foreign->name);
    if (!status) status = lar_mesh_builder_set(reader->builder, name, kind, feb->error);
    if (status) return status;
    if (kind == LAR_SET_NODES) return read_set_ids(reader, set, "node n");
    if (kind == LAR_SET_ELEMENTS) return read_set_ids(reader, set, "elem e");
    return read_surface(reader, set);
}

static lar_status read_block(mesh_reader *reader, const xmlNode *block) {
    /* Only conditions use these, and those that do are refused where they stand; a part list is
     * looked up when something names it. */
    if (lar_feb_is(block, "Nodes")) return read_nodes(reader, block);
    if (lar_feb_is(block, "Elements")) return read_elements(reader, block);
    if (lar_feb_is(block, "NodeSet")) return read_set(reader, block, "node set", LAR_SET_NODES);
    if (lar_feb_is(block, "ElementSet"))
        return read_set(reader, block, "element set", LAR_SET_ELEMENTS);
    if (lar_feb_is(block, "Surface")) return read_set(reader, block, "surface", LAR_SET_FACES);
    if (lar_feb_is_any(block, "SurfacePair PartList DiscreteSet Edge NodeSetPair")) return LAR_OK;
    return lar_feb_notice(reader->feb, block, "<%s> in the mesh is not known and was left out",
                          (const char *)block->name);
}

/* The names of node sets come first: a <Nodes> block gives way to a set of its name. */
static lar_status define_node_sets(mesh_reader *reader, const xmlNode *section) {
    lar_status status = LAR_OK;
    for (xmlNode *set = lar_feb_first(section); set && !status; set = lar_feb_next(set)) {
        const char *name;
        if (!lar_feb_is(set, "NodeSet")) continue;
        status = lar_feb_need_attribute(reader->feb, set, "name", &name);
        if (!status) status = define_name(reader, set, "node set", name);
    }
    return status;
}

static lar_status read_section(mesh_reader *reader, const xmlNode *section) {
    lar_feb *feb = reader->feb;
    lar_status status = define_node_sets(reader, section);
    for (xmlNode *block = lar_feb_first(section); block && !status; block = lar_feb_next(block))
        status = read_block(reader, block);
    if (!status) status = lar_mesh_builder_finish(reader->builder, feb->mesh, feb->error);
    if (status) return status;
    if (feb->mesh->dropped_node_count <= 0) return LAR_OK;
    return lar_feb_notice(feb, section, "%d nodes that no element uses were left out",
                          (int)feb->mesh->dropped_node_count);
}

lar_status lar_feb_read_mesh(lar_feb *feb) {
    const xmlNode *section = lar_feb_child(feb->root, "Mesh");
    if (!section)
        return lar_feb_fail(feb, feb->root, LAR_ERROR_FORMAT,
                            "the deck has no <Mesh> section%s; save it with its mesh, as version "
                            "3.0 or 4.0",
                            lar_feb_child(feb->root, "Geometry") ? " (<Geometry> is older)" : "");
    if (lar_feb_attribute(feb, section, "from"))
        return lar_feb_fail(feb, section, LAR_ERROR_UNSUPPORTED,
                            "the mesh stands in another file (from=\"...\"); put it into this one");
    mesh_reader reader = {feb, lar_mesh_builder_create(feb->path), xmlHashCreate(16)};
    lar_status status = reader.builder && reader.names ? read_section(&reader, section)
                                                       : lar_feb_no_memory(feb, "the mesh");
    lar_mesh_builder_destroy(reader.builder);
    if (reader.names) xmlHashFree(reader.names, NULL);
    return status;
}

/* ---- references ------------------------------------------------------------------------------ */

xmlNode *lar_feb_find_surface(lar_feb *feb, const char *name) {
    xmlNode *section = lar_feb_child(feb->root, "Mesh");
    xmlNode *block = section ? lar_feb_first(section) : NULL;
    for (; block; block = lar_feb_next(block)) {
        if (!lar_feb_is(block, "Surface")) continue;
        const char *found = lar_feb_attribute(feb, block, "name");
        if (found && strcmp(found, name) == 0) break;
    }
    return block;
}

static const char *after_prefix(const char *text, const char *prefix) {
    size_t length = strlen(prefix);
    return strncmp(text, prefix, length) == 0 ? text + length : NULL;
}

lar_status lar_feb_no_set(lar_feb *feb, const xmlNode *at, const char *kind, const char *name) {
    const xmlNode *surface = lar_feb_find_surface(feb, name);
    if (surface && foreign_face(surface) && strcmp(kind, "surface") == 0)
        return lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                            "<%s> names the surface '%.100s', which has faces other than quad4 "
                            "(line %d); the faces of hexahedra are quad4",
                            lar_feb_name(at), name, lar_feb_line(foreign_face(surface)));
    return lar_feb_fail(feb, at, LAR_ERROR_FORMAT,
                        "<%s> names the %s '%.100s', which the mesh does not define; define it or "
                        "correct the name",
                        lar_feb_name(at), kind, name);
}

/* Marks the elements of one set or part. */
static lar_status mark_elements(lar_feb *feb, const xmlNode *at, const char *name, char *mark) {
    const lar_set *set = lar_mesh_find_set(feb->mesh, name, LAR_SET_ELEMENTS);
    if (!set) return lar_feb_no_set(feb, at, "element set", name);
    for (int32_t i = 0; i < set->count; i++) mark[set->index[i]] = 1;
    return LAR_OK;
}

/* Marks the elements of a <PartList> of that name, or of the part of that name. */
static lar_status mark_part_list(lar_feb *feb, const xmlNode *at, const char *name, char *mark) {
    xmlNode *section = lar_feb_child(feb->root, "Mesh");
    xmlNode *block = section ? lar_feb_first(section) : NULL;
    for (; block; block = lar_feb_next(block)) {
        if (!lar_feb_is(block, "PartList")) continue;
        const char *found = lar_feb_attribute(feb, block, "name");
        if (found && strcmp(found, name) == 0) break;
    }
    if (!block) return mark_elements(feb, at, name, mark);
    lar_span rest = lar_feb_text(feb, block), item;
    lar_status status = LAR_OK;
    for (bool more = rest.length > 0; more && !status;) {
        more = lar_span_split(rest, ',', &item, &rest);
        item = lar_span_trim(item);
        const xmlChar *part =
            xmlDictLookup(feb->strings, (const xmlChar *)item.at, (int)item.length);
        if (!part) return lar_feb_no_memory(feb, "a part list");
        status = mark_elements(feb, block, (const char *)part, mark);
    }
    return status;
}

/* Marks what an element reference names. *known is false when it is no element reference. */
static lar_status mark_reference(lar_feb *feb, const xmlNode *at, const char *reference, char *mark,
                                 bool *known) {
    const char *name;
    *known = true;
    if ((name = after_prefix(reference, "@elem_set:"))) return mark_elements(feb, at, name, mark);
    if ((name = after_prefix(reference, "@part_list:")) ||
        (name = after_prefix(reference, "@part:")))
        return mark_part_list(feb, at, name, mark);
    *known = false;
    return LAR_OK;
}

lar_status lar_feb_is_whole_mesh(lar_feb *feb, const xmlNode *at, const char *reference,
                                 bool *all) {
    char *mark = lar_calloc((size_t)feb->mesh->element_count, 1);
    if (!mark) return lar_feb_no_memory(feb, "a set");
    bool known;
    lar_status status = mark_reference(feb, at, reference, mark, &known);
    if (!status && !known) status = mark_part_list(feb, at, reference, mark);
    *all = !status && !memchr(mark, 0, (size_t)feb->mesh->element_count);
    free(mark);
    return status;
}

/* Marks the nodes of the faces of a surface, or of the elements of a reference. */
static lar_status mark_nodes(lar_feb *feb, const xmlNode *at, const char *reference, char *mark) {
    const lar_mesh *mesh = feb->mesh;
    const char *name = after_prefix(reference, "@surface:");
    if (name) {
        const lar_set *set = lar_mesh_find_set(mesh, name, LAR_SET_FACES);
        if (!set) return lar_feb_no_set(feb, at, "surface", name);
        for (int32_t i = 0; i < set->count; i++)
            for (int a = 0; a < 4; a++)
                mark[mesh->element[set->index[i] / 6][lar_face_node[set->index[i] % 6][a]]] = 1;
        return LAR_OK;
    }
    char *element = lar_calloc((size_t)mesh->element_count, 1);
    if (!element) return lar_feb_no_memory(feb, "a set");
    bool known;
    lar_status status = mark_reference(feb, at, reference, element, &known);
    if (!status && !known)
        status = lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                              "the reference '%.100s' is not read; @surface:, @elem_set: and "
                              "@part_list: are, or name a node set",
                              reference);
    for (int32_t e = 0; e < mesh->element_count && !status; e++)
        for (int a = 0; element[e] && a < 8; a++) mark[mesh->element[e][a]] = 1;
    free(element);
    return status;
}

/* The marked nodes, ascending. */
static lar_status collect_marked(lar_feb *feb, const char *mark, lar_node_list *list) {
    int32_t count = 0;
    for (int32_t i = 0; i < feb->mesh->node_count; i++) count += mark[i] != 0;
    int32_t *node = lar_calloc((size_t)count, sizeof *node);
    if (!node) return lar_feb_no_memory(feb, "a set");
    *list = (lar_node_list){0, node};
    for (int32_t i = 0; i < feb->mesh->node_count; i++)
        if (mark[i]) node[list->count++] = i;
    return LAR_OK;
}

lar_status lar_feb_node_list(lar_feb *feb, const xmlNode *at, const char *reference,
                             lar_node_list *list) {
    char *mark = lar_calloc((size_t)feb->mesh->node_count, 1);
    if (!mark) return lar_feb_no_memory(feb, "a set");
    lar_status status = LAR_OK;
    if (reference[0] == '@') {
        status = mark_nodes(feb, at, reference, mark);
    } else {
        const lar_set *set = lar_mesh_find_set(feb->mesh, reference, LAR_SET_NODES);
        if (!set) status = lar_feb_no_set(feb, at, "node set", reference);
        for (int32_t i = 0; set && i < set->count; i++) mark[set->index[i]] = 1;
    }
    if (!status) status = collect_marked(feb, mark, list);
    free(mark);
    return status;
}
