#include "server/json.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int lar_utf8_length(const unsigned char *text, size_t length) {
    if (length == 0) return 0;
    int bytes = text[0] < 0x80             ? 1
                : (text[0] & 0xe0) == 0xc0 ? 2
                : (text[0] & 0xf0) == 0xe0 ? 3
                : (text[0] & 0xf8) == 0xf0 ? 4
                                           : 0;
    if (bytes == 0 || (size_t)bytes > length) return 0;
    uint32_t code = bytes == 1 ? text[0] : text[0] & (0x7fu >> bytes);
    for (int i = 1; i < bytes; i++) {
        if ((text[i] & 0xc0) != 0x80) return 0;
        code = code << 6 | (text[i] & 0x3fu);
    }
    static const uint32_t min[] = {0, 0, 0x80, 0x800, 0x10000};
    bool surrogate = code >= 0xd800 && code <= 0xdfff;
    return code < min[bytes] || code > 0x10ffff || surrogate ? 0 : bytes;
}

static void add(lar_json *json, const char *text, size_t length) {
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

static void add_string(lar_json *json, const char *text) {
    const unsigned char *c = (const unsigned char *)text, *end = c + strlen(text);
    add(json, "\"", 1);
    while (c < end) {
        char escape[8];
        int length = lar_utf8_length(c, (size_t)(end - c));
        if (length == 0) {
            add_word(json, "\\ufffd");
            c++;
            continue;
        }
        if (*c == '"' || *c == '\\') {
            snprintf(escape, sizeof escape, "\\%c", *c);
            add_word(json, escape);
        } else if (*c < 0x20 || *c == 0x7f) {
            snprintf(escape, sizeof escape, "\\u%04x", *c);
            add_word(json, escape);
        } else {
            add(json, (const char *)c, (size_t)length);
        }
        c += length;
    }
    add(json, "\"", 1);
}

static void begin_value(lar_json *json, const char *name) {
    if (!json->empty) add(json, ",", 1);
    json->empty = false;
    if (!name) return;
    add_string(json, name);
    add(json, ":", 1);
}

static void add_number(lar_json *json, double value) {
    char number[32];
    if (isfinite(value)) {
        /* The shortest of these that reads as the same number. */
        snprintf(number, sizeof number, "%.9g", value);
        if (strtod(number, NULL) != value) snprintf(number, sizeof number, "%.17g", value);
        char *comma = strchr(number, ','); /* of the host's locale */
        if (comma) *comma = '.';
        add_word(json, number);
    } else {
        add_word(json, "null");
    }
}

void lar_json_begin(lar_json *json) {
    json->length = 0;
    json->failed = false;
    json->empty = true;
    lar_json_open(json, NULL, '{');
}

void lar_json_end(lar_json *json) {
    lar_json_close(json, '}');
}

void lar_json_clear(lar_json *json) {
    free(json->memory);
    *json = (lar_json){.headroom = json->headroom};
}

void lar_json_open(lar_json *json, const char *name, char kind) {
    begin_value(json, name);
    add(json, &kind, 1);
    json->empty = true;
}

void lar_json_close(lar_json *json, char kind) {
    add(json, &kind, 1);
    json->empty = false;
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
        if (i > 0) add(json, ",", 1);
        add_number(json, v[i]);
    }
    add(json, "]", 1);
}

void lar_json_raw(lar_json *json, const char *text, size_t length) {
    begin_value(json, NULL);
    add(json, text, length);
}
