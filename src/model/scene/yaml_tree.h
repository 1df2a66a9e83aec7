/* A YAML file as a small tree in which every node knows its line and column.
 *
 * The scene reader wants to say where a value stands even when the value may have several shapes
 * (a set name, a number, a list, a mapping), so it walks a tree instead of binding a schema. The
 * events come from libyaml; this file only bounds them and puts them together.
 *
 * Bounds, because the file may be anything: 32 levels, a million nodes, 100 keys in a mapping.
 * Refused with a sentence: aliases and anchors (a short file could otherwise unfold into
 * gigabytes), tags, keys that are no words, the same key twice, a second document.
 */
#ifndef LAR_MODEL_SCENE_YAML_TREE_H
#define LAR_MODEL_SCENE_YAML_TREE_H

#include <stdbool.h>

#include "base/memory.h"

enum { LAR_YAML_DEPTH = 32, LAR_YAML_NODES = 1000000, LAR_YAML_KEYS = 100 };

typedef enum lar_yaml_kind { LAR_YAML_SCALAR, LAR_YAML_LIST, LAR_YAML_MAPPING } lar_yaml_kind;

typedef struct lar_yaml {
    lar_yaml_kind kind;
    bool quoted;            /* scalar in quotes, or a block of text: never a number */
    int line, column;       /* where it begins, 1-based */
    const char *text;       /* scalar: its text, terminated, no zero byte inside */
    struct lar_yaml *key;   /* value in a mapping: its key (a scalar) */
    struct lar_yaml *first; /* list and mapping: the entries in the file's order */
    struct lar_yaml *next;  /* the next entry of the parent */
    int count;              /* number of entries */
} lar_yaml;

typedef struct lar_yaml_tree {
    lar_yaml *root;
    int node_count;
    struct lar_yaml_block *block; /* the memory of all nodes and texts */
} lar_yaml_tree;

/* Reads the whole file. `path` begins the messages ("FILE:LINE:COLUMN: "). On failure the tree is
 * empty. The caller frees it with lar_yaml_clear. */
lar_status lar_yaml_parse(const char *path, const lar_bytes *bytes, lar_yaml_tree *tree,
                          lar_error *error);
/* Frees what the tree owns and zeroes it; a zeroed tree is fine. */
void lar_yaml_clear(lar_yaml_tree *tree);

/* The value of that key, or NULL (also when `mapping` is none). */
const lar_yaml *lar_yaml_get(const lar_yaml *mapping, const char *key);

/* What a node is, in words for a message: its text in quotes (cut, no control characters),
 * "a list", "a mapping" or "nothing". */
enum { LAR_YAML_SHOWN = 64 };
const char *lar_yaml_show(const lar_yaml *node, char shown[LAR_YAML_SHOWN]);

#endif
