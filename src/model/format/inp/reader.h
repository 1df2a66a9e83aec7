/* Inside the Abaqus reader: cards, and the sets they name.
 *
 *     *ELEMENT, TYPE=C3D8, ELSET=EB1      a card: keyword and parameters
 *     1, 1, 2, 7, 6, 31, 32, 37, 36       its data lines
 *
 * The file is walked three times: nodes and elements, then sets (they may name anything above or
 * below), then surfaces (they may name any set). Keywords that say nothing about the mesh are
 * passed over.
 *
 * Names have a scope:
 *
 *     *PART, NAME=P            the part's: what stands here, and what names P-1.NAME outside
 *     *END PART
 *     *ASSEMBLY                everything else: a file without parts, the assembly, and what
 *     *INSTANCE, NAME=P-1      stands behind it
 *
 * In the mesh a set has its bare name; one of the part whose name the assembly has too is there
 * called P-1.NAME. Nodes of the assembly are reference points, which no hexahedron has.
 */
#ifndef LAR_MODEL_FORMAT_INP_READER_H
#define LAR_MODEL_FORMAT_INP_READER_H

#include "base/text.h"
#include "model/mesh/builder.h"

/* A keyword line, continuation lines joined. */
typedef struct inp_card {
    char text[1024];
    lar_span keyword; /* without the star */
    lar_span parameters;
    int line;
} inp_card;

typedef struct inp_entry {
    int64_t id;
    int line;
    bool corners; /* in a node set: the nodes of the element `id` */
} inp_entry;

typedef struct inp_set {
    char *name, *built; /* the latter in the mesh, where it is another one; NULL: the name */
    lar_set_kind kind;  /* of surfaces only the name is here */
    bool in_part;       /* its scope */
    int32_t tag;        /* element sets on *ELEMENT lines: 1, 2, ... ; 0 for others */
    size_t count, capacity;
    inp_entry *entry;
} inp_set;

/* An element that carries no volume; its nodes are kept when it is a quadrilateral. */
typedef struct inp_boundary {
    int64_t id;
    int64_t node_ids[4];
    bool is_quad;
    const char *type; /* static */
    int line;
} inp_boundary;

typedef struct inp_ids {
    size_t count, capacity;
    int64_t *id;
} inp_ids;

typedef struct inp_reader {
    const char *path;
    lar_text text;
    int line; /* of the last data line */
    lar_error *error;
    lar_mesh_builder *builder;
    int part_count, instance_count;
    char *instance; /* its name, or the part's; NULL: there is none */
    bool in_part;   /* the card stands in the part */
    bool of_part;   /* or names it: INSTANCE= */
    int32_t tag_count;
    int32_t sparse_ranges; /* as in lar_mesh */
    int sparse_line;

    inp_ids nodes, elements; /* every id of the file; ascending after the first walk */
    inp_ids apart;           /* nodes of the assembly, likewise */
    size_t boundary_count, boundary_capacity;
    inp_boundary *boundary; /* ascending id after the first walk */
    size_t set_count, set_capacity;
    inp_set *set;

    /* Set entries that the file may still ask for: a set may contain another one twice, and so
     * on, and few bytes could ask for any amount. */
    size_t entries_left;
} inp_reader;

/* The beginning of the text, behind a byte order mark; where a walk begins. */
lar_text inp_begin(inp_reader *reader, const lar_bytes *bytes);

/* The mesh of a file; reader: path and error, all else zero. What it knows of sets and elements
 * stays until it is cleared. */
lar_status inp_read_mesh(inp_reader *reader, const lar_bytes *bytes, lar_mesh *mesh);
void inp_clear(inp_reader *reader);

/* Reads a keyword line; a comma at its end continues it. False at the end of the file, and when
 * something else stands there (*status then says so). */
bool inp_next_card(inp_reader *reader, inp_card *card, lar_status *status);

/* Next data line of the card; false at the next card or the end. */
bool inp_data_line(inp_reader *reader, lar_span *line);

/* Value of a parameter ("" when it has none); false when the card does not have it. */
bool inp_parameter(const inp_card *card, const char *name, lar_span *value);

/* Refuses a card with another parameter than these, with commas in between. */
lar_status inp_check_parameters(const inp_reader *reader, const inp_card *card, const char *known);

/* The set of the scope in which the card stands, made when new. */
lar_status inp_open_set(inp_reader *reader, lar_span name, lar_set_kind kind, inp_set **set);
lar_status inp_add_entry(inp_reader *reader, inp_set *set, inp_entry entry);

/* Whether a number that the card names is a node of the assembly. */
bool inp_is_apart(const inp_reader *reader, int64_t id);
/* What stands behind the instance's name: "Part-1-1.Wall". */
lar_span inp_without_instance(lar_span name);
/* Refuses an element set that has something else than hexahedra. */
lar_status inp_check_solids(inp_reader *reader, lar_span name);

/* Fails with "expected WHAT, found 'text'". */
lar_status inp_expected(inp_reader *reader, int line, const char *what, lar_span found);

/* Our local face of the digit in S1 to S6 or P1 to P6; -1: no such face. */
int inp_face_of(char digit);

/* *NSET and *ELSET, *SURFACE: its name, its faces. */
lar_status inp_read_nset(inp_reader *reader, const inp_card *card);
lar_status inp_read_elset(inp_reader *reader, const inp_card *card);
lar_status inp_name_surface(inp_reader *reader, const inp_card *card);
lar_status inp_read_surface(inp_reader *reader, const inp_card *card);
/* Their names in the mesh, which the other scope may have. */
lar_status inp_name_sets(inp_reader *reader);
/* Hands the sets to the builder. */
lar_status inp_build_sets(inp_reader *reader);

#endif
