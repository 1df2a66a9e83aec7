/* A small JSON writer: one object, indented, commas and escapes taken care of.
 *
 *     json_writer json = json_begin(stdout);       { "steps": 10,
 *     json_integer(&json, "steps", 10);              "energy": { "kinetic": 0.5 },
 *     json_open(&json, "energy", '{');               "sets": ["base"] }
 *     json_number(&json, "kinetic", 0.5);
 *     json_close(&json);                           Inside an array the names are NULL.
 *     json_end(&json);
 *
 * Doubles are written with 17 digits, so that reading gives the same bits; what is no finite number
 * becomes null.
 */
#ifndef LAR_CLI_REPORT_JSON_H
#define LAR_CLI_REPORT_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { JSON_DEPTH = 8 };

typedef struct json_writer {
    FILE *out;
    int depth;
    char closing[JSON_DEPTH];
    bool empty[JSON_DEPTH];
} json_writer;

json_writer json_begin(FILE *out);
/* Closes everything that is open and ends the line. */
void json_end(json_writer *json);

/* Opens an object '{' or an array '['. */
void json_open(json_writer *json, const char *name, char kind);
void json_close(json_writer *json);

/* Text that is not UTF-8 is written with replacement characters. */
void json_text(json_writer *json, const char *name, const char *text);
void json_number(json_writer *json, const char *name, double value);
void json_integer(json_writer *json, const char *name, int64_t value);
void json_boolean(json_writer *json, const char *name, bool value);
void json_vector(json_writer *json, const char *name, const double v[3]);

#endif
