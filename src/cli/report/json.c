#include "cli/report/json.h"

#include <inttypes.h>
#include <math.h>

static void indent(json_writer *json) {
    fputc('\n', json->out);
    for (int i = 0; i < json->depth; i++) fputs("  ", json->out);
}

/* Bytes of the UTF-8 character at `text`, 0 when there is none (RFC 3629). */
static int utf8_length(const unsigned char *text) {
    int length = text[0] < 0x80             ? 1
                 : (text[0] & 0xe0) == 0xc0 ? 2
                 : (text[0] & 0xf0) == 0xe0 ? 3
                 : (text[0] & 0xf8) == 0xf0 ? 4
                                            : 0;
    uint32_t code = length == 1 ? text[0] : text[0] & (0x7f >> length);
    for (int i = 1; i < length; i++) {
        if ((text[i] & 0xc0) != 0x80) return 0;
        code = code << 6 | (text[i] & 0x3f);
    }
    static const uint32_t min[] = {0, 0, 0x80, 0x800, 0x10000};
    bool surrogate = code >= 0xd800 && code <= 0xdfff;
    return code < min[length] || code > 0x10ffff || surrogate ? 0 : length;
}

static void print_string(FILE *out, const char *text) {
    fputc('"', out);
    for (const unsigned char *c = (const unsigned char *)text; *c;) {
        int length = utf8_length(c);
        if (length == 0) {
            fputs("\\ufffd", out);
            c++;
            continue;
        }
        if (*c == '"' || *c == '\\')
            fprintf(out, "\\%c", *c);
        else if (*c == '\n')
            fputs("\\n", out);
        else if (*c < 0x20 || *c == 0x7f)
            fprintf(out, "\\u%04x", *c);
        else
            fwrite(c, 1, (size_t)length, out);
        c += length;
    }
    fputc('"', out);
}

/* Comma, line and name before a value. */
static void begin_value(json_writer *json, const char *name) {
    if (json->depth == 0) return;
    if (!json->empty[json->depth - 1]) fputc(',', json->out);
    json->empty[json->depth - 1] = false;
    indent(json);
    if (!name) return;
    print_string(json->out, name);
    fputs(": ", json->out);
}

json_writer json_begin(FILE *out) {
    json_writer json = {.out = out};
    json_open(&json, NULL, '{');
    return json;
}

void json_end(json_writer *json) {
    while (json->depth > 0) json_close(json);
    fputc('\n', json->out);
}

void json_open(json_writer *json, const char *name, char kind) {
    begin_value(json, name);
    fputc(kind, json->out);
    if (json->depth >= JSON_DEPTH) return;
    json->closing[json->depth] = kind == '{' ? '}' : ']';
    json->empty[json->depth++] = true;
}

void json_close(json_writer *json) {
    if (json->depth == 0) return;
    json->depth--;
    if (!json->empty[json->depth]) indent(json);
    fputc(json->closing[json->depth], json->out);
}

void json_text(json_writer *json, const char *name, const char *text) {
    begin_value(json, name);
    print_string(json->out, text);
}

void json_number(json_writer *json, const char *name, double value) {
    begin_value(json, name);
    if (isfinite(value))
        fprintf(json->out, "%.17g", value);
    else
        fputs("null", json->out);
}

void json_integer(json_writer *json, const char *name, int64_t value) {
    begin_value(json, name);
    fprintf(json->out, "%" PRId64, value);
}

void json_boolean(json_writer *json, const char *name, bool value) {
    begin_value(json, name);
    fputs(value ? "true" : "false", json->out);
}

void json_vector(json_writer *json, const char *name, const double v[3]) {
    begin_value(json, name);
    fputc('[', json->out);
    for (int i = 0; i < 3; i++) {
        if (i > 0) fputs(", ", json->out);
        if (isfinite(v[i]))
            fprintf(json->out, "%.17g", v[i]);
        else
            fputs("null", json->out);
    }
    fputc(']', json->out);
}
