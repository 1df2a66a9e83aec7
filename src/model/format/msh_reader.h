/* Inside the Gmsh reader: one view of ascii and binary files.
 *
 *     $MeshFormat      version, encoding, size of a number
 *     $PhysicalNames   dimension, number, "name"              -> msh_group
 *     $Entities        (4.1) which groups an entity belongs to -> msh_entity
 *     $Nodes           or $NOD in version 1
 *     $Elements        or $ELM in version 1
 *
 * The versions differ in the order of the same numbers. So the sections ask for an integer, a
 * size or a double, and msh_int, msh_size and msh_double take it from text or from bytes.
 */
#ifndef LAR_MODEL_FORMAT_MSH_READER_H
#define LAR_MODEL_FORMAT_MSH_READER_H

#include "base/text.h"
#include "model/mesh/builder.h"

/* A physical group with a name. */
typedef struct msh_group {
    int dimension; /* -1: the file (version 2.0) does not say */
    int64_t number;
    char *name;
} msh_group;

/* A geometrical entity and its groups, physical[first .. first + count - 1]. */
typedef struct msh_entity {
    int dimension;
    int64_t number;
    size_t first, count;
} msh_entity;

typedef struct msh_reader {
    const char *path;
    lar_text text;
    const char *begin; /* of the file, for byte positions */
    bool binary;
    int version;         /* 1, 2 or 4 */
    const char *section; /* the one being read, "$Nodes" */
    bool has_nodes, has_elements;
    lar_error *error;
    lar_mesh_builder *builder;

    size_t group_count, group_capacity;
    msh_group *group; /* ascending number, then dimension */
    size_t entity_count, entity_capacity;
    msh_entity *entity; /* ascending dimension, then number */
    size_t physical_count, physical_capacity;
    int64_t *physical;

    /* Set entries that the file may still ask for. A group may name every element again, so that
     * a small file could ask for any amount. */
    size_t entries_left;

    /* The solid read last, because version 2 repeats an element for each of its groups. */
    bool has_last;
    int64_t last_id, last_nodes[8];

    /* The first face in a named group that no hexahedron can have; refused at the end, when no
     * other cell has told more. */
    bool has_odd_face;
    int64_t odd_face_id;
    int odd_face_line;
    const char *odd_face_type;
    const char *odd_face_group;
} msh_reader;

/* Next number of the section. A failure says what should have stood there. In binary files an
 * integer has 4 bytes, a size and a double 8. */
lar_status msh_int(msh_reader *reader, const char *what, int64_t *value);
lar_status msh_size(msh_reader *reader, const char *what, int64_t *value);
lar_status msh_double(msh_reader *reader, const char *what, double *value);

/* Fails with the sentence for a number that is missing. */
lar_status msh_expected(msh_reader *reader, const char *what);

/* Checks that `count` items of so many bytes in text and in binary can follow. */
lar_status msh_claim(msh_reader *reader, int64_t count, const char *what, size_t text_bytes,
                     size_t binary_bytes);

/* Where the reader stands: "file:line" or "file: byte 123". */
typedef struct msh_place {
    char text[400];
} msh_place;
msh_place msh_here(const msh_reader *reader);

/* Line for the builder, 0 in binary files. */
int msh_line(const msh_reader *reader);

/* The number of a group without the sign, which is its orientation. */
static inline int64_t msh_group_number(int64_t number) {
    return number < 0 && number > INT64_MIN ? -number : number;
}

/* The name of a group, NULL when it has none. */
const char *msh_group_name(const msh_reader *reader, int dimension, int64_t number);
/* The entity, NULL when the file does not list it. */
const msh_entity *msh_find_entity(const msh_reader *reader, int dimension, int64_t number);

/* The $Elements section of version 2 and 4.1, the $ELM section of version 1. */
lar_status msh_read_elements(msh_reader *reader);
/* What can be said only when all elements are known. */
lar_status msh_check_faces(msh_reader *reader);

#endif
