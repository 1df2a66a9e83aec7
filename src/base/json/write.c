#include "base/json/write.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static void add(lar_json *json, const char *text, size_t length) {
    if (json->out) {
        fwrite(text, 1, length, json->out);
        return;
    }
    size_t needed = json->headroom + json->length + length + 1;
    if (json->failed) return;
    if (needed > json->capacity) {
        size_t capacity = needed + needed / 2 + 256;
        char *memory = realloc(json->memory, capacity);
        if (!memory) {
            json->failed = true;
            return;
        }
        json->memory = memory;
        json->capacity = capacity;
    }
    memcpy(lar_json_data(json) + json->length, text, length);
    json->length += length;
    lar_json_data(json)[json->length] = '\0';
}

static void add_word(lar_json *json, const char *word) {
    add(json, word, strlen(word));
}

static void add_line(lar_json *json) {
    if (!json->out) return;
    add(json, "\n", 1);
    for (int i = 0; i < json->depth; i++) add(json, "  ", 2);
}

static void add_string(lar_json *json, const char *text) {
    const unsigned char *c = (const unsigned char *)text, *end = c + strlen(text);
    add(json, "\"", 1);
    while (c < end) {
        char escape[8];
        int length = lar_utf8_length(c, (size_t)(end - c));
        if (length == 0)
            snprintf(escape, sizeof escape, "\\ufffd");
        else if (*c == '"' || *c == '\\')
            snprintf(escape, sizeof escape, "\\%c", *c);
        else if (*c == '\n' && json->out)
            snprintf(escape, sizeof escape, "\\n");
        else if (*c < 0x20 || *c == 0x7f)
            snprintf(escape, sizeof escape, "\\u%04x", *c);
        else
            *escape = '\0';
        if (*escape)
            add_word(json, escape);
        else
            add(json, (const char *)c, (size_t)length);
        c += length > 0 ? length : 1;
    }
    add(json, "\"", 1);
}

static void add_number(lar_json *json, double value) {
    char number[32];
    if (!isfinite(value)) {
        add_word(json, "null");
        return;
    }
    /* Viewers get the shorter of two that read as the same number. */
    if (!json->out) snprintf(number, sizeof number, "%.9g", value);
    if (json->out || strtod(number, NULL) != value) snprintf(number, sizeof number, "%.17g", value);
    char *comma = strchr(number, ','); /* of the host's locale */
    if (comma) *comma = '.';
    add_word(json, number);
}

/* Comma, line and name before a value. */
static void begin_value(lar_json *json, const char *name) {
    if (json->depth > 0) {
        bool *empty = &json->empty[json->depth - 1];
        if (!*empty) add(json, ",", 1);
        *empty = false;
        add_line(json);
    }
    if (!name) return;
    add_string(json, name);
    add_word(json, json->out ? ": " : ":");
}

lar_json lar_json_to(FILE *out) {
    lar_json json = {.out = out};
    lar_json_begin(&json);
    return json;
}

void lar_json_begin(lar_json *json) {
    json->length = 0;
    json->depth = 0;
    json->failed = false;
    lar_json_open(json, NULL, '{');
}

void lar_json_end(lar_json *json) {
    while (json->depth > 0) lar_json_close(json);
    add_line(json);
}

void lar_json_clear(lar_json *json) {
    free(json->memory);
    *json = (lar_json){.headroom = json->headroom};
}

void lar_json_open(lar_json *json, const char *name, char kind) {
    begin_value(json, name);
    add(json, &kind, 1);
    if (json->depth == LAR_JSON_DEPTH) {
        json->failed = true;
        return;
    }
    json->closing[json->depth] = kind == '{' ? '}' : ']';
    json->empty[json->depth++] = true;
}

void lar_json_close(lar_json *json) {
    if (json->depth == 0) return;
    json->depth--;
    if (!json->empty[json->depth]) add_line(json);
    add(json, &json->closing[json->depth], 1);
}

void lar_json_text(lar_json *json, const char *name, const char *text) {
    begin_value(json, name);
    if (text)
        add_string(json, text);
    else
        add_word(json, "null");
}

void lar_json_number(lar_json *json, const char *name, double value) {
    begin_value(json, name);
    add_number(json, value);
}

void lar_json_integer(lar_json *json, const char *name, int64_t value) {
    char number[32];
    begin_value(json, name);
    snprintf(number, sizeof number, "%" PRId64, value);
    add_word(json, number);
}

void lar_json_boolean(lar_json *json, const char *name, bool value) {
    begin_value(json, name);
    add_word(json, value ? "true" : "false");
}

void lar_json_vector(lar_json *json, const char *name, const double *v, int count) {
    begin_value(json, name);
    add(json, "[", 1);
    for (int i = 0; i < count; i++) {
        if (i > 0) add_word(json, json->out ? ", " : ",");
        add_number(json, v[i]);
    }
    add(json, "]", 1);
}

void lar_json_integers(lar_json *json, const char *name, const int32_t *v, int count) {
    lar_json_open(json, name, '[');
    for (int i = 0; i < count; i++) lar_json_integer(json, NULL, v[i]);
    lar_json_close(json);
}

void lar_json_hash(lar_json *json, const char *name, uint64_t hash) {
    char text[17];
    snprintf(text, sizeof text, "%016" PRIx64, hash);
    lar_json_text(json, name, text);
}

void lar_json_raw(lar_json *json, const char *text, size_t length) {
    begin_value(json, NULL);
    add(json, text, length);
}
