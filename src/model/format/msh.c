/* The file as a whole, names, entities and nodes. Format: Gmsh reference manual, "MSH file format"
 * (4.1), "MSH file format version 2" and "version 1". */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/format/mesh_io.h"
#include "model/format/msh_reader.h"

/* ---- numbers ---------------------------------------------------------------------------- */

msh_place msh_here(const msh_reader *reader) {
    msh_place where;
    if (reader->binary)
        snprintf(where.text, sizeof where.text, "%.370s: byte %zu", reader->path,
                 (size_t)(reader->text.at - reader->begin));
    else
        snprintf(where.text, sizeof where.text, "%.370s:%d", reader->path, reader->text.line);
    return where;
}

int msh_line(const msh_reader *reader) {
    return reader->binary ? 0 : reader->text.line;
}

lar_status msh_expected(msh_reader *reader, const char *what) {
    lar_text ahead = reader->text;
    lar_span word;
    if (reader->binary || !lar_text_word(&ahead, &word))
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: the file ends inside %s, where %s should stand; it was cut short, "
                        "save it again",
                        msh_here(reader).text, reader->section, what);
    char found[25] = "";
    for (size_t i = 0; i < word.length && i < sizeof found - 1; i++)
        found[i] = word.at[i] > ' ' && word.at[i] < 127 ? word.at[i] : '?';
    return lar_fail(reader->error, LAR_ERROR_FORMAT,
                    "%s: expected %s in %s, found '%s'; the file is damaged, save it again",
                    msh_here(reader).text, what, reader->section, found);
}

static bool take_bytes(msh_reader *reader, void *value, size_t size) {
    if ((size_t)(reader->text.end - reader->text.at) < size) return false;
    memcpy(value, reader->text.at, size);
    reader->text.at += size;
    return true;
}

lar_status msh_int(msh_reader *reader, const char *what, int64_t *value) {
    if (!reader->binary)
        return lar_text_int64(&reader->text, value) ? LAR_OK : msh_expected(reader, what);
    int32_t number;
    if (!take_bytes(reader, &number, sizeof number)) return msh_expected(reader, what);
    *value = number;
    return LAR_OK;
}

lar_status msh_size(msh_reader *reader, const char *what, int64_t *value) {
    int64_t number;
    if (reader->binary ? !take_bytes(reader, &number, sizeof number)
                       : !lar_text_int64(&reader->text, &number))
        return msh_expected(reader, what);
    if (number < 0)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: %s in %s is negative or far too large; the file is damaged, save it "
                        "again",
                        msh_here(reader).text, what, reader->section);
    *value = number;
    return LAR_OK;
}

lar_status msh_double(msh_reader *reader, const char *what, double *value) {
    if (reader->binary ? take_bytes(reader, value, sizeof *value)
                       : lar_text_double(&reader->text, value))
        return LAR_OK;
    return msh_expected(reader, what);
}

lar_status msh_claim(msh_reader *reader, int64_t count, const char *what, size_t text_bytes,
                     size_t binary_bytes) {
    size_t left = (size_t)(reader->text.end - reader->text.at);
    size_t each = reader->binary ? binary_bytes : text_bytes;
    if (count >= 0 && lar_claim_fits((unsigned long long)count, each, left)) return LAR_OK;
    return lar_fail(reader->error, LAR_ERROR_FORMAT,
                    "%s: %s announces %lld %s, but only %zu bytes follow; the file is damaged or "
                    "was cut short, save it again",
                    msh_here(reader).text, reader->section, (long long)count, what, left);
}

/* ---- physical names and entities ---------------------------------------------------------- */

static int compare_groups(const void *a, const void *b) {
    const msh_group *x = a, *y = b;
    if (x->number != y->number) return x->number < y->number ? -1 : 1;
    return (x->dimension > y->dimension) - (x->dimension < y->dimension);
}

const char *msh_group_name(const msh_reader *reader, int dimension, int64_t number) {
    if (reader->group_count == 0) return NULL;
    msh_group wanted = {dimension, number, NULL};
    const msh_group *found =
        bsearch(&wanted, reader->group, reader->group_count, sizeof wanted, compare_groups);
    if (!found) {
        wanted.dimension = -1;
        found = bsearch(&wanted, reader->group, reader->group_count, sizeof wanted, compare_groups);
    }
    return found ? found->name : NULL;
}

/* One line: dimension, number, "name"; version 2.0 leaves the dimension out. */
static lar_status read_physical_name(msh_reader *reader) {
    static const char *const what = "a physical name (dimension, number, \"name\")";
    lar_text start = reader->text;
    lar_span line, numbers, rest, name;
    if (!lar_text_skip_space(&start)) return msh_expected(reader, what);
    reader->text = start;
    lar_text_line(&reader->text, &line);
    bool quoted = lar_span_split(line, '"', &numbers, &rest);
    while (rest.length > 0 && rest.at[rest.length - 1] != '"') rest.length--;
    if (!quoted || rest.length == 0) {
        reader->text = start;
        return msh_expected(reader, what);
    }
    name = (lar_span){rest.at, rest.length - 1};

    lar_text scan = {numbers.at, numbers.at + numbers.length, start.line};
    int64_t first, second;
    bool has_first = lar_text_int64(&scan, &first);
    bool has_second = has_first && lar_text_int64(&scan, &second);
    if (!has_first || (has_second && (first < 0 || first > 3))) {
        reader->text = start;
        return msh_expected(reader, what);
    }
    if (reader->group_count >= LAR_MESH_SETS_MAX)
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s: more than %d physical names; remove those that are not used",
                        msh_here(reader).text, LAR_MESH_SETS_MAX);
    char *copy = lar_strndup(name.at, name.length);
    if (!copy || !LAR_GROW(reader->group, reader->group_capacity, reader->group_count)) {
        free(copy);
        return lar_fail_memory(reader->error, sizeof *reader->group, "physical names");
    }
    reader->group[reader->group_count++] =
        has_second ? (msh_group){(int)first, second, copy} : (msh_group){-1, first, copy};
    return LAR_OK;
}

static lar_status read_physical_names(msh_reader *reader) {
    /* These lines are text in binary files too. */
    int64_t count;
    if (!lar_text_int64(&reader->text, &count))
        return msh_expected(reader, "the number of physical names");
    lar_status status = LAR_OK;
    for (int64_t i = 0; i < count && !status; i++) status = read_physical_name(reader);
    if (!status && reader->group_count > 0)
        qsort(reader->group, reader->group_count, sizeof *reader->group, compare_groups);
    return status;
}

static int compare_entities(const void *a, const void *b) {
    const msh_entity *x = a, *y = b;
    if (x->dimension != y->dimension) return x->dimension < y->dimension ? -1 : 1;
    return (x->number > y->number) - (x->number < y->number);
}

const msh_entity *msh_find_entity(const msh_reader *reader, int dimension, int64_t number) {
    if (reader->entity_count == 0) return NULL;
    msh_entity wanted = {dimension, number, 0, 0};
    return bsearch(&wanted, reader->entity, reader->entity_count, sizeof wanted, compare_entities);
}

static lar_status read_entity(msh_reader *reader, int dimension) {
    msh_entity entity = {.dimension = dimension, .first = reader->physical_count};
    lar_status status = msh_int(reader, "an entity", &entity.number);
    /* A point has its place here, everything else its bounding box. */
    for (int i = 0; i < (dimension == 0 ? 3 : 6) && !status; i++) {
        double ignored;
        status = msh_double(reader, "a coordinate of an entity", &ignored);
    }
    int64_t groups = 0, bounds = 0, number = 0;
    if (!status) status = msh_size(reader, "the number of physical groups", &groups);
    if (!status) status = msh_claim(reader, groups, "physical groups", 2, 4);
    for (int64_t i = 0; i < groups && !status; i++) {
        status = msh_int(reader, "a physical group", &number);
        if (status) break;
        if (!LAR_GROW(reader->physical, reader->physical_capacity, reader->physical_count))
            return lar_fail_memory(reader->error, (size_t)groups * 8, "physical groups");
        reader->physical[reader->physical_count++] = msh_group_number(number);
    }
    if (!status && dimension > 0) status = msh_size(reader, "the number of boundaries", &bounds);
    if (!status) status = msh_claim(reader, bounds, "boundaries", 2, 4);
    for (int64_t i = 0; i < bounds && !status; i++) status = msh_int(reader, "a boundary", &number);
    if (status) return status;

    entity.count = reader->physical_count - entity.first;
    if (!LAR_GROW(reader->entity, reader->entity_capacity, reader->entity_count))
        return lar_fail_memory(reader->error, sizeof entity, "entities");
    reader->entity[reader->entity_count++] = entity;
    return LAR_OK;
}

static lar_status read_entities(msh_reader *reader) {
    int64_t count[4] = {0};
    lar_status status = LAR_OK;
    for (int d = 0; d < 4 && !status; d++)
        status = msh_size(reader, "the number of entities", &count[d]);
    for (int d = 0; d < 4 && !status; d++) {
        status = msh_claim(reader, count[d], "entities", 10, d == 0 ? 36 : 68);
        for (int64_t i = 0; i < count[d] && !status; i++) status = read_entity(reader, d);
    }
    if (!status && reader->entity_count > 0)
        qsort(reader->entity, reader->entity_count, sizeof *reader->entity, compare_entities);
    return status;
}

/* ---- nodes ------------------------------------------------------------------------------ */

static lar_status read_position(msh_reader *reader, double position[3]) {
    lar_status status = LAR_OK;
    for (int i = 0; i < 3 && !status; i++)
        status = msh_double(reader, "a coordinate of a node", &position[i]);
    return status;
}

static lar_status read_nodes_2(msh_reader *reader) {
    int64_t count;
    if (!lar_text_int64(&reader->text, &count)) return msh_expected(reader, "the number of nodes");
    lar_span rest;
    if (reader->binary) lar_text_line(&reader->text, &rest);
    lar_status status = msh_claim(reader, count, "nodes", 7, 28);
    for (int64_t i = 0; i < count && !status; i++) {
        int64_t id;
        double position[3];
        status = msh_int(reader, "a node id", &id);
        if (!status) status = read_position(reader, position);
        if (!status)
            status = lar_mesh_builder_node(reader->builder, id, position, msh_line(reader),
                                           reader->error);
    }
    return status;
}

static lar_status read_node_block(msh_reader *reader, int64_t *ids, int64_t count, int parameters) {
    lar_status status = LAR_OK;
    for (int64_t i = 0; i < count && !status; i++) status = msh_size(reader, "a node id", &ids[i]);
    for (int64_t i = 0; i < count && !status; i++) {
        double position[3], ignored;
        status = read_position(reader, position);
        for (int p = 0; p < parameters && !status; p++)
            status = msh_double(reader, "a parameter of a node", &ignored);
        if (!status)
            status = lar_mesh_builder_node(reader->builder, ids[i], position, msh_line(reader),
                                           reader->error);
    }
    return status;
}

static lar_status read_nodes_4(msh_reader *reader) {
    int64_t blocks = 0, total = 0, seen = 0, ignored, dimension = 0, parametric = 0, count = 0;
    lar_status status = msh_size(reader, "the number of node blocks", &blocks);
    if (!status) status = msh_size(reader, "the number of nodes", &total);
    if (!status) status = msh_size(reader, "the smallest node id", &ignored);
    if (!status) status = msh_size(reader, "the largest node id", &ignored);
    if (!status) status = msh_claim(reader, blocks, "node blocks", 7, 20);
    if (!status) status = msh_claim(reader, total, "nodes", 7, 32);
    for (int64_t b = 0; b < blocks && !status; b++) {
        status = msh_int(reader, "the dimension of a node block", &dimension);
        if (!status) status = msh_int(reader, "the entity of a node block", &ignored);
        if (!status) status = msh_int(reader, "the parametric flag of a block", &parametric);
        if (!status) status = msh_size(reader, "the number of nodes of a block", &count);
        if (!status) status = msh_claim(reader, count, "nodes", 7, 32);
        if (status) return status;
        if (dimension < 0 || dimension > 3)
            return lar_fail(reader->error, LAR_ERROR_FORMAT,
                            "%s: a node block has the dimension %lld; 0 to 3 are possible, the "
                            "file is damaged",
                            msh_here(reader).text, (long long)dimension);
        int64_t *ids = lar_calloc((size_t)count, sizeof *ids);
        if (!ids) return lar_fail_memory(reader->error, (size_t)count * 8, "node ids");
        status = read_node_block(reader, ids, count, parametric ? (int)dimension : 0);
        free(ids);
        seen += count;
    }
    if (!status && seen != total)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: $Nodes announces %lld nodes, but its blocks hold %lld; the file is "
                        "damaged, save it again",
                        msh_here(reader).text, (long long)total, (long long)seen);
    return status;
}

/* ---- the file --------------------------------------------------------------------------- */

/* $MeshFormat: "version file-type data-size", in binary files an integer one after it. */
static lar_status read_format(msh_reader *reader) {
    double version;
    int64_t type, size;
    if (!lar_text_double(&reader->text, &version)) return msh_expected(reader, "a version");
    if (!lar_text_int64(&reader->text, &type)) return msh_expected(reader, "a file type");
    if (!lar_text_int64(&reader->text, &size)) return msh_expected(reader, "a data size");
    bool two = version >= 2 && version<3, four = version> 4.09 && version < 4.2;
    if (!two && !four)
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s: Gmsh format %g is not read; save the mesh as version 4.1 or 2.2 "
                        "(Gmsh: File, Export, MSH)",
                        msh_here(reader).text, version);
    if ((type != 0 && type != 1) || size != 8)
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s: file type %lld with data size %lld is not read; save the mesh as "
                        "ascii (0) or binary (1) with data size 8",
                        msh_here(reader).text, (long long)type, (long long)size);
    reader->version = two ? 2 : 4;
    if (type == 0) return LAR_OK;

    lar_span rest;
    uint32_t one;
    lar_text_line(&reader->text, &rest);
    reader->binary = true;
    if (!take_bytes(reader, &one, sizeof one)) return msh_expected(reader, "the integer one");
    if (one == 0x01000000u)
        return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                        "%s: the binary file comes from a machine with the other byte order; "
                        "save it as ascii",
                        msh_here(reader).text);
    if (one != 1)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: the integer one that begins binary data reads %u; the file is "
                        "damaged, perhaps by a transfer as text, fetch it again",
                        msh_here(reader).text, one);
    return LAR_OK;
}

static lar_status read_nodes(msh_reader *reader) {
    reader->has_nodes = true;
    return reader->version == 4 ? read_nodes_4(reader) : read_nodes_2(reader);
}

static lar_status read_elements(msh_reader *reader) {
    reader->has_elements = true;
    return msh_read_elements(reader);
}

static lar_status refuse_section(msh_reader *reader) {
    return lar_fail(reader->error, LAR_ERROR_UNSUPPORTED,
                    "%s: the section %s is not read; save the mesh without partitions and "
                    "without parametric coordinates",
                    msh_here(reader).text, reader->section);
}

typedef struct section_row {
    const char *name, *end;
    bool needs_format; /* stands after $MeshFormat only */
    lar_status (*read)(msh_reader *reader);
} section_row;

static const section_row sections[] = {
    {"$MeshFormat", "$EndMeshFormat", false, read_format},
    {"$PhysicalNames", "$EndPhysicalNames", false, read_physical_names},
    {"$Entities", "$EndEntities", true, read_entities},
    {"$Nodes", "$EndNodes", true, read_nodes},
    {"$Elements", "$EndElements", true, read_elements},
    {"$NOD", "$ENDNOD", false, read_nodes},
    {"$ELM", "$ENDELM", false, read_elements},
    {"$PartitionedEntities", "$EndPartitionedEntities", true, refuse_section},
    {"$ParametricNodes", "$EndParametricNodes", true, refuse_section},
};

/* Passes over a section that says nothing about the mesh. */
static lar_status skip_section(msh_reader *reader, lar_span name, msh_place where) {
    char end[64];
    snprintf(end, sizeof end, "$End%.*s", (int)(name.length < 50 ? name.length - 1 : 49),
             name.at + 1);
    lar_span text;
    while (lar_text_line(&reader->text, &text))
        if (lar_span_equal(lar_span_trim(text), end)) return LAR_OK;
    return lar_fail(reader->error, LAR_ERROR_FORMAT,
                    "%s: the section has no %s; the file was cut short, save it again", where.text,
                    end);
}

static lar_status read_section(msh_reader *reader) {
    lar_span line, word;
    lar_text_skip_space(&reader->text);
    msh_place where = msh_here(reader);
    lar_text_line(&reader->text, &line);
    word = lar_span_trim(line);
    if (word.length < 2 || word.at[0] != '$')
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: expected a section such as $MeshFormat, $Nodes or $Elements; this is "
                        "no Gmsh mesh or it is damaged",
                        where.text);
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++) {
        const section_row *row = &sections[i];
        if (!lar_span_equal(word, row->name)) continue;
        reader->section = row->name;
        if (row->needs_format && reader->version == 1)
            return lar_fail(reader->error, LAR_ERROR_FORMAT,
                            "%s: %s stands before any $MeshFormat section; the file is damaged, "
                            "save it again",
                            where.text, row->name);
        lar_status status = row->read(reader);
        if (status) return status;
        lar_text before = reader->text;
        if (!lar_text_word(&reader->text, &word) || !lar_span_equal(word, row->end)) {
            reader->text = before;
            return lar_fail(reader->error, LAR_ERROR_FORMAT,
                            "%s: expected %s; the section holds more or less than it announces, "
                            "save the file again",
                            msh_here(reader).text, row->end);
        }
        return LAR_OK;
    }
    return skip_section(reader, word, where);
}

static lar_status read_file(msh_reader *reader) {
    lar_status status = LAR_OK;
    while (!status && lar_text_skip_space(&reader->text)) status = read_section(reader);
    if (status) return status;
    if (!reader->has_nodes || !reader->has_elements)
        return lar_fail(reader->error, LAR_ERROR_FORMAT,
                        "%s: the file ends without a section %s; it was cut short or holds no "
                        "mesh, save it again",
                        msh_here(reader).text, reader->has_nodes ? "$Elements" : "$Nodes");
    return msh_check_faces(reader);
}

lar_status lar_msh_parse(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                         lar_error *error) {
    enum { SPARE_ENTRIES = 1000000 };
    msh_reader reader = {.path = path,
                         .text = lar_text_from(bytes),
                         .begin = (const char *)bytes->data,
                         .version = 1,
                         .error = error,
                         .builder = lar_mesh_builder_create(path),
                         .entries_left = 4 * bytes->size + SPARE_ENTRIES};
    lar_status status = LAR_OK;
    if (!reader.builder)
        status = lar_fail_memory(error, sizeof reader, path);
    else
        status = read_file(&reader);
    if (!status) status = lar_mesh_builder_finish(reader.builder, mesh, error);
    lar_mesh_builder_destroy(reader.builder);
    for (size_t i = 0; i < reader.group_count; i++) free(reader.group[i].name);
    free(reader.group);
    free(reader.entity);
    free(reader.physical);
    return status;
}
