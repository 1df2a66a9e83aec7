#include "base/json/read.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/text.h"

enum { NESTED_MAX = 64 };

char lar_json_next(lar_json_reader *r) {
    while (r->at < r->end && memchr(" \t\r\n", *r->at, 4)) r->at++;
    return r->at < r->end ? *r->at : '\0';
}

bool lar_json_take(lar_json_reader *r, char wanted) {
    if (lar_json_next(r) != wanted || r->at == r->end) return false;
    r->at++;
    return true;
}

/* ---- strings -------------------------------------------------------------------------------- */

typedef struct sink {
    char *text;
    size_t size, length;
} sink;

static void put(sink *out, char c) {
    if (out->length + 1 < out->size) out->text[out->length] = c;
    out->length++;
}

static void put_code(sink *out, uint32_t code) {
    if (code < 0x80) {
        put(out, (char)code);
        return;
    }
    int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    static const unsigned char head[] = {0, 0xc0, 0xe0, 0xf0};
    put(out, (char)(head[more] | code >> (6 * more)));
    while (more-- > 0) put(out, (char)(0x80 | (code >> (6 * more) & 0x3f)));
}

static int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/* Four digits behind "\u". */
static bool take_unit(lar_json_reader *r, uint32_t *unit) {
    if (r->end - r->at < 4) return false;
    *unit = 0;
    for (int i = 0; i < 4; i++) {
        int digit = hex_digit(*r->at++);
        if (digit < 0) return false;
        *unit = *unit << 4 | (uint32_t)digit;
    }
    return true;
}

static bool take_code(lar_json_reader *r, uint32_t *code) {
    if (!take_unit(r, code)) return false;
    uint32_t high = *code, low;
    if (high >= 0xd800 && high < 0xdc00 && r->end - r->at >= 6 && memcmp(r->at, "\\u", 2) == 0) {
        lar_json_reader ahead = {r->at + 2, r->end};
        if (!take_unit(&ahead, &low)) return false;
        if (low >= 0xdc00 && low < 0xe000) {
            *code = 0x10000 + ((high - 0xd800) << 10 | (low - 0xdc00));
            r->at = ahead.at;
        }
    }
    if (*code == 0 || (*code >= 0xd800 && *code < 0xe000)) *code = 0xfffd;
    return true;
}

/* Behind a backslash. */
static bool take_escape(lar_json_reader *r, sink *out) {
    static const char names[] = "\"\\/bfnrt", values[] = "\"\\/\b\f\n\r\t";
    uint32_t code;
    char c = r->at < r->end ? *r->at++ : '\0';
    const char *found = c ? strchr(names, c) : NULL;
    if (found) {
        put(out, values[found - names]);
        return true;
    }
    if (c != 'u' || !take_code(r, &code)) return false;
    put_code(out, code);
    return true;
}

bool lar_json_take_string(lar_json_reader *r, char *text, size_t size, size_t *length) {
    sink out = {.text = text, .size = size};
    if (!lar_json_take(r, '"')) return false;
    while (r->at < r->end && *r->at != '"') {
        char c = *r->at++;
        if ((unsigned char)c < 0x20) return false;
        if (c != '\\')
            put(&out, c);
        else if (!take_escape(r, &out))
            return false;
    }
    if (r->at == r->end) return false;
    r->at++;
    if (size > 0) text[out.length < size ? out.length : size - 1] = '\0';
    if (length) *length = out.length;
    return true;
}

/* ---- numbers and words ---------------------------------------------------------------------- */

static bool is_digit(const lar_json_reader *r, const char *at) {
    return at < r->end && *at >= '0' && *at <= '9';
}

static const char *past_digits(const lar_json_reader *r, const char *at) {
    while (is_digit(r, at)) at++;
    return at;
}

bool lar_json_take_number(lar_json_reader *r, double *value) {
    lar_json_next(r);
    const char *at = r->at;
    if (at < r->end && *at == '-') at++;
    if (!is_digit(r, at) || (*at == '0' && is_digit(r, at + 1))) return false;
    at = past_digits(r, at);
    if (at < r->end && *at == '.') {
        if (!is_digit(r, ++at)) return false;
        at = past_digits(r, at);
    }
    if (at < r->end && (*at == 'e' || *at == 'E')) {
        at++;
        if (at < r->end && (*at == '+' || *at == '-')) at++;
        if (!is_digit(r, at)) return false;
        at = past_digits(r, at);
    }
    lar_span number = {r->at, (size_t)(at - r->at)};
    r->at = at;
    return lar_span_double(number, value) && isfinite(*value);
}

static bool take_word(lar_json_reader *r, const char *word) {
    size_t length = strlen(word);
    lar_json_next(r);
    if ((size_t)(r->end - r->at) < length || memcmp(r->at, word, length) != 0) return false;
    r->at += length;
    return true;
}

bool lar_json_take_boolean(lar_json_reader *r, bool *value) {
    *value = take_word(r, "true");
    return *value || take_word(r, "false");
}

/* ---- whole values --------------------------------------------------------------------------- */

static bool take_simple(lar_json_reader *r) {
    double number;
    bool word;
    char first = lar_json_next(r);
    if (first == '"') return lar_json_take_string(r, NULL, 0, NULL);
    if (first == 'n') return take_word(r, "null");
    if (first == 't' || first == 'f') return lar_json_take_boolean(r, &word);
    return lar_json_take_number(r, &number);
}

static bool take_name(lar_json_reader *r) {
    return lar_json_take_string(r, NULL, 0, NULL) && lar_json_take(r, ':');
}

/* No recursion: how deep it goes is not for the text to say. */
bool lar_json_take_value(lar_json_reader *r) {
    char closing[NESTED_MAX];
    int depth = 0;
    do {
        char first = lar_json_next(r);
        if (first == '{' || first == '[') {
            if (depth == NESTED_MAX) return false;
            r->at++;
            closing[depth++] = first == '{' ? '}' : ']';
            if (!lar_json_take(r, closing[depth - 1])) {
                if (first == '{' && !take_name(r)) return false;
                continue;
            }
            depth--;
        } else if (!take_simple(r)) {
            return false;
        }
        while (depth > 0 && lar_json_take(r, closing[depth - 1])) depth--;
        if (depth == 0) return true;
        if (!lar_json_take(r, ',') || (closing[depth - 1] == '}' && !take_name(r))) return false;
    } while (true);
}

bool lar_json_is_whole(lar_json_reader *r) {
    const lar_json_reader whole = *r;
    while (r->at < r->end) {
        int bytes = lar_utf8_length((const unsigned char *)r->at, (size_t)(r->end - r->at));
        if (bytes == 0) return false;
        r->at += bytes;
    }
    *r = whole;
    return lar_json_take_value(r) && lar_json_next(r) == '\0' && r->at == r->end;
}

/* ---- text that is whole --------------------------------------------------------------------- */

lar_json_reader lar_json_member(lar_json_reader object, const char *name) {
    char found[128];
    if (!object.at || !lar_json_take(&object, '{') || lar_json_take(&object, '}'))
        return (lar_json_reader){0};
    do {
        if (!lar_json_take_string(&object, found, sizeof found, NULL) ||
            !lar_json_take(&object, ':'))
            break;
        if (strcmp(found, name) == 0) return object;
    } while (lar_json_take_value(&object) && lar_json_take(&object, ','));
    return (lar_json_reader){0};
}

bool lar_json_element(lar_json_reader *array, lar_json_reader *element) {
    if (lar_json_next(array) == ']') return false;
    *element = *array;
    if (!lar_json_take_value(array)) return false;
    lar_json_take(array, ',');
    return true;
}

bool lar_json_scalar(lar_json_reader value, char *text, size_t size) {
    if (!value.at) return false;
    char first = lar_json_next(&value);
    if (first == '"') return lar_json_take_string(&value, text, size, NULL);
    const char *from = value.at;
    if (first == '{' || first == '[' || !lar_json_take_value(&value)) return false;
    size_t length = (size_t)(value.at - from);
    if (length >= size) length = size - 1;
    memcpy(text, from, length);
    text[length] = '\0';
    return true;
}
