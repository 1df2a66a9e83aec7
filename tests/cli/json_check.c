/* Reads one JSON object from standard input, strictly (RFC 8259), and looks for values.
 *
 *     json_check energy.kinetic state_hash     fails unless both are there
 *     json_check --print state_hash            prints the value as it stands
 *     json_check --numbers p50 p99             fails unless they are there and are numbers
 *
 * Nothing may stand before or behind the object, and no number may be missing (null).
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_BYTES = 1 << 20, MAX_PATH = 256, MAX_VALUES = 4096 };

typedef struct value {
    char path[MAX_PATH];
    const char *at;
    size_t length;
} value;

static char text[MAX_BYTES];
static const char *at = text;
static value values[MAX_VALUES];
static int value_count;

static void fail(const char *what) {
    int line = 1;
    for (const char *c = text; c < at; c++) line += *c == '\n';
    fprintf(stderr, "json_check: line %d: %s\n", line, what);
    exit(1);
}

static void skip_space(void) {
    at += strspn(at, " \t\r\n");
}

static void expect(char c) {
    char what[] = "expected ?";
    what[9] = c;
    if (*at != c) fail(what);
    at++;
}

/* A string; its inside is copied as it is written. */
static void read_string(char *copy, size_t size) {
    size_t used = 0;
    expect('"');
    while (*at != '"') {
        if ((unsigned char)*at < 0x20) fail("control character or end inside a string");
        if (*at == '\\') {
            if (!strchr("\"\\/bfnrtu", at[1]) || at[1] == '\0') fail("unknown escape");
            if (at[1] == 'u' && strspn(at + 2, "0123456789abcdefABCDEF") < 4) fail("bad \\u");
            if (used + 1 < size) copy[used++] = *at;
            at++;
        }
        if (used + 1 < size) copy[used++] = *at;
        at++;
    }
    if (size > 0) copy[used] = '\0';
    at++;
}

static void read_number(void) {
    const char *digits = "0123456789";
    if (*at == '-') at++;
    size_t whole = strspn(at, digits);
    if (whole == 0 || (*at == '0' && whole > 1)) fail("not a value (NaN and infinity are none)");
    at += whole;
    if (*at == '.') {
        size_t fraction = strspn(++at, digits);
        if (fraction == 0) fail("digits are missing behind the point");
        at += fraction;
    }
    if (*at == 'e' || *at == 'E') {
        at++;
        if (*at == '+' || *at == '-') at++;
        size_t exponent = strspn(at, digits);
        if (exponent == 0) fail("the exponent has no digits");
        at += exponent;
    }
}

static void read_value(const char *path);

static void read_members(const char *path, char open, char close) {
    expect(open);
    skip_space();
    for (int i = 0; *at != close; i++) {
        char name[MAX_PATH], inner[2 * MAX_PATH];
        snprintf(name, sizeof name, "%d", i);
        if (i > 0) {
            expect(',');
            skip_space();
        }
        if (open == '{') {
            read_string(name, sizeof name);
            skip_space();
            expect(':');
        }
        snprintf(inner, sizeof inner, "%s%s%s", path, *path ? "." : "", name);
        if (strlen(inner) >= MAX_PATH) fail("the path is too long");
        for (int k = 0; k < value_count; k++)
            if (strcmp(values[k].path, inner) == 0) fail("a key stands twice");
        read_value(inner);
    }
    at++;
}

static bool skip_word(const char *word) {
    if (strncmp(at, word, strlen(word)) != 0) return false;
    at += strlen(word);
    return true;
}

static void read_value(const char *path) {
    skip_space();
    if (value_count == MAX_VALUES) fail("too many values");
    value *v = &values[value_count++];
    snprintf(v->path, sizeof v->path, "%s", path);
    v->at = at;
    if (*at == '{')
        read_members(path, '{', '}');
    else if (*at == '[')
        read_members(path, '[', ']');
    else if (*at == '"')
        read_string(NULL, 0);
    else if (!skip_word("true") && !skip_word("false")) {
        if (skip_word("null")) fail("a null: some number was not finite");
        read_number();
    }
    v->length = (size_t)(at - v->at);
    skip_space();
}

static const value *find(const char *path) {
    for (int i = 0; i < value_count; i++)
        if (strcmp(values[i].path, path) == 0) return &values[i];
    fprintf(stderr, "json_check: %s is missing\n", path);
    exit(1);
}

int main(int argc, char **argv) {
    size_t size = fread(text, 1, sizeof text - 1, stdin);
    text[size] = '\0';
    if (strlen(text) != size) fail("a zero byte");
    if (*text != '{') fail("the output does not begin with an object");
    read_value("");
    if (*at) fail("something stands behind the object");
    bool print = false, numbers = false;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--print") == 0 || strcmp(argv[i], "--numbers") == 0) {
            print = argv[i][2] == 'p';
            numbers = !print;
            continue;
        }
        const value *v = find(argv[i]);
        if (numbers && !strchr("-0123456789", *v->at)) {
            fprintf(stderr, "json_check: %s is no number\n", argv[i]);
            return 1;
        }
        if (print) printf("%.*s\n", (int)v->length, v->at);
    }
    return 0;
}
