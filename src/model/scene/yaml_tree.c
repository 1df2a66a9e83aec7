#include "model/scene/yaml_tree.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

/* ---- memory: blocks that live as long as the tree ----------------------------------------- */

typedef struct lar_yaml_block {
    struct lar_yaml_block *older;
    size_t used, size;
    max_align_t data[];
} lar_yaml_block;

static void *take(lar_yaml_tree *tree, size_t bytes) {
    const size_t align = sizeof(max_align_t), block_size = (size_t)1 << 16;
    bytes = (bytes + align - 1) / align * align;
    lar_yaml_block *block = tree->block;
    if (!block || block->size - block->used < bytes) {
        size_t size = bytes > block_size ? bytes : block_size;
        block = malloc(sizeof *block + size);
        if (!block) return NULL;
        *block = (lar_yaml_block){tree->block, 0, size};
        tree->block = block;
    }
    char *at = (char *)block->data + block->used;
    block->used += bytes;
    return at;
}

void lar_yaml_clear(lar_yaml_tree *tree) {
    for (lar_yaml_block *block = tree->block; block;) {
        lar_yaml_block *older = block->older;
        free(block);
        block = older;
    }
    *tree = (lar_yaml_tree){0};
}

/* ---- building ----------------------------------------------------------------------------- */

typedef struct open_node {
    lar_yaml *node;
    lar_yaml *last; /* its last entry so far */
    lar_yaml *key;  /* the key that waits for its value */
} open_node;

typedef struct yaml_builder {
    const char *path;
    lar_yaml_tree *tree;
    lar_error *error;
    int documents;
    int depth;
    open_node open[LAR_YAML_DEPTH];
} yaml_builder;

static lar_status refuse(yaml_builder *builder, yaml_mark_t mark, const char *sentence) {
    return lar_fail(builder->error, LAR_ERROR_FORMAT, "%s:%zu:%zu: %s", builder->path,
                    mark.line + 1, mark.column + 1, sentence);
}

static lar_yaml *new_node(yaml_builder *builder, lar_yaml_kind kind, yaml_mark_t mark) {
    lar_yaml *node = take(builder->tree, sizeof *node);
    if (!node) return NULL;
    *node = (lar_yaml){.kind = kind, .line = (int)mark.line + 1, .column = (int)mark.column + 1};
    builder->tree->node_count++;
    return node;
}

static lar_status take_key(yaml_builder *builder, open_node *parent, lar_yaml *key,
                           yaml_mark_t mark) {
    if (key->kind != LAR_YAML_SCALAR)
        return refuse(builder, mark, "a key must be a word; remove the brackets or the '?'");
    const lar_yaml *same = lar_yaml_get(parent->node, key->text);
    if (same) {
        char shown[LAR_YAML_SHOWN];
        return lar_fail(builder->error, LAR_ERROR_FORMAT,
                        "%s:%d:%d: the key %s stands here twice, first in line %d; remove one",
                        builder->path, key->line, key->column, lar_yaml_show(key, shown),
                        same->key->line);
    }
    if (parent->node->count >= LAR_YAML_KEYS)
        return refuse(builder, mark, "this mapping has more than 100 keys; a scene needs few");
    parent->key = key;
    return LAR_OK;
}

/* Hangs a finished scalar or a beginning collection into the tree. */
static lar_status attach(yaml_builder *builder, lar_yaml *node, yaml_mark_t mark) {
    if (!node) return lar_fail_memory(builder->error, sizeof *node, "the scene file");
    if (builder->tree->node_count > LAR_YAML_NODES)
        return refuse(builder, mark,
                      "the file has more than 1000000 values; describe regions by selectors, and "
                      "motions by curves of fewer points");
    if (builder->depth == 0) {
        builder->tree->root = node;
        return LAR_OK;
    }
    open_node *parent = &builder->open[builder->depth - 1];
    if (parent->node->kind == LAR_YAML_MAPPING && !parent->key)
        return take_key(builder, parent, node, mark);
    node->key = parent->key;
    parent->key = NULL;
    if (parent->last)
        parent->last->next = node;
    else
        parent->node->first = node;
    parent->last = node;
    parent->node->count++;
    return LAR_OK;
}

static lar_status begin(yaml_builder *builder, lar_yaml_kind kind, yaml_mark_t mark) {
    if (builder->depth == LAR_YAML_DEPTH)
        return refuse(builder, mark,
                      "lists and mappings stand more than 32 deep in one another; "
                      "a scene needs few levels");
    lar_yaml *node = new_node(builder, kind, mark);
    lar_status status = attach(builder, node, mark);
    if (status) return status;
    builder->open[builder->depth++] = (open_node){.node = node};
    return LAR_OK;
}

static lar_status scalar(yaml_builder *builder, const yaml_event_t *event) {
    const char *value = (const char *)event->data.scalar.value;
    size_t length = event->data.scalar.length;
    if (memchr(value, '\0', length))
        return refuse(builder, event->start_mark, "this text holds a zero character; remove it");
    lar_yaml *node = new_node(builder, LAR_YAML_SCALAR, event->start_mark);
    char *text = node ? take(builder->tree, length + 1) : NULL;
    if (!text) return lar_fail_memory(builder->error, length + 1, "the scene file");
    memcpy(text, value, length);
    text[length] = '\0';
    node->text = text;
    node->quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
    return attach(builder, node, event->start_mark);
}

static lar_status refuse_decoration(yaml_builder *builder, const yaml_event_t *event,
                                    const yaml_char_t *anchor, const yaml_char_t *tag) {
    if (anchor)
        return refuse(builder, event->start_mark,
                      "anchors (&name) are not read; write the value out where it is needed");
    if (tag) return refuse(builder, event->start_mark, "tags (!name) are not read; remove the tag");
    return LAR_OK;
}

static lar_status take_event(yaml_builder *builder, const yaml_event_t *event) {
    lar_status status;
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        if (builder->documents++ > 0)
            return refuse(builder, event->start_mark,
                          "a second document begins here; a scene is one document, remove '---'");
        return LAR_OK;
    case YAML_ALIAS_EVENT:
        return refuse(builder, event->start_mark,
                      "aliases (*name) are not read; write the value out");
    case YAML_SCALAR_EVENT:
        status =
            refuse_decoration(builder, event, event->data.scalar.anchor, event->data.scalar.tag);
        return status ? status : scalar(builder, event);
    case YAML_SEQUENCE_START_EVENT:
        status = refuse_decoration(builder, event, event->data.sequence_start.anchor,
                                   event->data.sequence_start.tag);
        return status ? status : begin(builder, LAR_YAML_LIST, event->start_mark);
    case YAML_MAPPING_START_EVENT:
        status = refuse_decoration(builder, event, event->data.mapping_start.anchor,
                                   event->data.mapping_start.tag);
        return status ? status : begin(builder, LAR_YAML_MAPPING, event->start_mark);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
        builder->depth--;
        return LAR_OK;
    default:
        return LAR_OK;
    }
}

/* Whether a line is indented with a tab, which YAML does not allow. */
static bool begins_with_tab(const lar_bytes *bytes, size_t line) {
    size_t at = 0;
    for (size_t l = 1; l < line && at < bytes->size; at++) l += bytes->data[at] == '\n';
    while (at < bytes->size && bytes->data[at] == ' ') at++;
    return at < bytes->size && bytes->data[at] == '\t';
}

/* What libyaml says when the text is no YAML. Its reader gives a byte offset, the rest a mark. */
static lar_status explain(yaml_builder *builder, const yaml_parser_t *parser,
                          const lar_bytes *bytes) {
    if (parser->error == YAML_MEMORY_ERROR)
        return lar_fail_memory(builder->error, bytes->size, "the scene file");
    size_t line = parser->problem_mark.line + 1, column = parser->problem_mark.column + 1;
    if (parser->error == YAML_READER_ERROR) {
        line = column = 1;
        for (size_t i = 0; i < parser->problem_offset && i < bytes->size; i++) {
            column++;
            if (bytes->data[i] == '\n') line++, column = 1;
        }
    }
    if (parser->error == YAML_SCANNER_ERROR && begins_with_tab(bytes, line))
        return lar_fail(builder->error, LAR_ERROR_FORMAT,
                        "%s:%zu:%zu: the line begins with a tab; YAML is indented with blanks only",
                        builder->path, line, column);
    return lar_fail(builder->error, LAR_ERROR_FORMAT,
                    "%s:%zu:%zu: this is not YAML: %s%s%s; check indentation, brackets, colons and "
                    "quotes here and in the line before",
                    builder->path, line, column, parser->context ? parser->context : "",
                    parser->context ? ", " : "", parser->problem ? parser->problem : "unreadable");
}

lar_status lar_yaml_parse(const char *path, const lar_bytes *bytes, lar_yaml_tree *tree,
                          lar_error *error) {
    *tree = (lar_yaml_tree){0};
    yaml_builder builder = {.path = path, .tree = tree, .error = error};
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser)) return lar_fail_memory(error, bytes->size, path);
    yaml_parser_set_input_string(&parser, bytes->data, bytes->size);
    lar_status status = LAR_OK;
    for (bool done = false; !status && !done;) {
        yaml_event_t event;
        if (!yaml_parser_parse(&parser, &event)) {
            status = explain(&builder, &parser, bytes);
            break;
        }
        done = event.type == YAML_STREAM_END_EVENT;
        status = take_event(&builder, &event);
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
    if (!status && !tree->root)
        status = lar_fail(error, LAR_ERROR_FORMAT,
                          "%s:1:1: there is nothing in this file; a scene begins with the line "
                          "'lariat: 1'",
                          path);
    if (status) lar_yaml_clear(tree);
    return status;
}

/* ---- asking ------------------------------------------------------------------------------- */

const lar_yaml *lar_yaml_get(const lar_yaml *mapping, const char *key) {
    if (!mapping || mapping->kind != LAR_YAML_MAPPING) return NULL;
    for (const lar_yaml *entry = mapping->first; entry; entry = entry->next)
        if (strcmp(entry->key->text, key) == 0) return entry;
    return NULL;
}

const char *lar_yaml_show(const lar_yaml *node, char shown[LAR_YAML_SHOWN]) {
    if (node->kind == LAR_YAML_LIST) return "a list";
    if (node->kind == LAR_YAML_MAPPING) return "a mapping";
    if (node->text[0] == '\0' && !node->quoted) return "nothing";
    const size_t room = LAR_YAML_SHOWN - sizeof "\"...\"";
    size_t length = strlen(node->text), kept = length < room ? length : room;
    /* Never cut inside a UTF-8 character. */
    while (kept < length && kept > 0 && ((unsigned char)node->text[kept] & 0xC0) == 0x80) kept--;
    shown[0] = '"';
    for (size_t i = 0; i < kept; i++) {
        unsigned char c = (unsigned char)node->text[i];
        shown[1 + i] = c < 32 || c == 127 ? ' ' : (char)c;
    }
    snprintf(shown + 1 + kept, LAR_YAML_SHOWN - 1 - kept, "%s", kept < length ? "...\"" : "\"");
    return shown;
}
