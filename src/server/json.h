/* JSON for viewers: written into memory, compact, with commas and escapes taken care of.
 *
 *     lar_json json = {.headroom = 16};
 *     lar_json_begin(&json);                      {"kind":"note","text":"..."}
 *     lar_json_text(&json, "kind", "note");
 *     lar_json_text(&json, "text", sentence);     the text begins at lar_json_data(&json) and has
 *     lar_json_end(&json);                        json.length bytes, or json.failed is set
 *
 * The memory is kept from one text to the next. Inside an array names are NULL. Numbers are written
 * so that they read the same; one that is not finite becomes null.
 */
#ifndef LAR_SERVER_JSON_H
#define LAR_SERVER_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct lar_json {
    size_t headroom; /* bytes left free before the text, for whoever sends it */
    char *memory;
    size_t length, capacity; /* of the text */
    bool empty;              /* nothing yet in what was opened last */
    bool failed;             /* memory was refused; the text is not to be used */
} lar_json;

/* An empty text, and the object that it is. */
void lar_json_begin(lar_json *json);
void lar_json_end(lar_json *json);
void lar_json_clear(lar_json *json); /* frees the memory; idempotent */

/* Opens an object '{' or an array '['; closes with '}' or ']'. */
void lar_json_open(lar_json *json, const char *name, char kind);
void lar_json_close(lar_json *json, char kind);

/* What is not UTF-8 is replaced. NULL is written as null. */
void lar_json_text(lar_json *json, const char *name, const char *text);
void lar_json_number(lar_json *json, const char *name, double value);
void lar_json_integer(lar_json *json, const char *name, int64_t value);
void lar_json_boolean(lar_json *json, const char *name, bool value);
void lar_json_vector(lar_json *json, const char *name, const double *v, int count);

/* Text that is JSON already, where a value may stand. */
void lar_json_raw(lar_json *json, const char *text, size_t length);

static inline char *lar_json_data(const lar_json *json) {
    return json->memory + json->headroom;
}

/* Bytes of the UTF-8 character at the beginning of `text`; 0: there is none (RFC 3629). */
int lar_utf8_length(const unsigned char *text, size_t length);

#endif
