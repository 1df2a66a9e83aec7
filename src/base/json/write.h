/* JSON, written piece by piece, with commas and escapes taken care of.
 *
 *     lar_json json = lar_json_to(stdout);       { "steps": 10,
 *     lar_json_integer(&json, "steps", 10);        "energy": { "kinetic": 0.5 },
 *     lar_json_open(&json, "energy", '{');         "sets": ["base"] }
 *     lar_json_number(&json, "kinetic", 0.5);
 *     lar_json_close(&json);                     Inside an array names are NULL.
 *     lar_json_end(&json);
 *
 * Into a file for people and scripts: indented, and nothing is allocated. Into memory for viewers:
 * compact; the memory is kept from one text to the next, so that a server which has said everything
 * once allocates no more.
 *
 *     lar_json json = {.headroom = 16};
 *     lar_json_begin(&json); ...                 the text begins at lar_json_data(&json) and has
 *     lar_json_end(&json);                       json.length bytes, or json.failed is set
 *
 * Numbers are written so that they read as the same double; what is not finite becomes null. Text
 * that is not UTF-8 gets replacement characters.
 */
#ifndef LAR_BASE_JSON_WRITE_H
#define LAR_BASE_JSON_WRITE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { LAR_JSON_DEPTH = 8 };

typedef struct lar_json {
    FILE *out;               /* indented into this; NULL: compact, into `memory` */
    size_t headroom;         /* bytes left free before the text, for whoever sends it */
    char *memory;            /* NULL: none yet */
    size_t length, capacity; /* of the text; of the memory */
    int depth;               /* how many are open */
    char closing[LAR_JSON_DEPTH];
    bool empty[LAR_JSON_DEPTH]; /* nothing in it yet */
    bool failed; /* memory was refused, or LAR_JSON_DEPTH; the text is not to be used */
} lar_json;

/* Begins the object that the text is. */
lar_json lar_json_to(FILE *out);
void lar_json_begin(lar_json *json); /* into memory */
/* Closes everything that is open; ends the line in a file. */
void lar_json_end(lar_json *json);
void lar_json_clear(lar_json *json); /* frees the memory; idempotent */

/* Opens an object '{' or an array '['; closes what was opened last. */
void lar_json_open(lar_json *json, const char *name, char kind);
void lar_json_close(lar_json *json);

/* NULL is written as null. */
void lar_json_text(lar_json *json, const char *name, const char *text);
void lar_json_number(lar_json *json, const char *name, double value);
void lar_json_integer(lar_json *json, const char *name, int64_t value);
void lar_json_boolean(lar_json *json, const char *name, bool value);
void lar_json_vector(lar_json *json, const char *name, const double *v, int count);
void lar_json_integers(lar_json *json, const char *name, const int32_t *v, int count);
void lar_json_hash(lar_json *json, const char *name, uint64_t hash); /* 16 digits, as a text */

/* Members or values that are JSON already. */
void lar_json_raw(lar_json *json, const char *text, size_t length);

static inline char *lar_json_data(const lar_json *json) {
    return json->memory + json->headroom;
}

#endif
