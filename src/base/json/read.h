/* Reading JSON (RFC 8259) piece by piece, without memory of its own: who reads says what must come
 * next, and refuses what does not.
 *
 *     {"do": "step", "steps": 10}     take '{', string, take ':', string, take ',', ... take '}'
 *
 * White space before a piece is skipped. A function that returns false has found something else;
 * the reader then stands where it was found, or at the beginning of the piece.
 *
 * For text that lar_json_is_whole has gone over there is a second way: by names.
 *
 *     lar_json_reader machine = lar_json_member(root, "machine");
 *     if (lar_json_scalar(lar_json_member(machine, "cpu"), cpu, sizeof cpu)) ...
 */
#ifndef LAR_BASE_JSON_READ_H
#define LAR_BASE_JSON_READ_H

#include <stdbool.h>
#include <stddef.h>

typedef struct lar_json_reader {
    const char *at, *end; /* `at` NULL: of a value that is not there */
} lar_json_reader;

/* The next character: what it is, '\0' at the end; past it, when it is this one. */
char lar_json_next(lar_json_reader *reader);
bool lar_json_take(lar_json_reader *reader, char wanted);

/* A string, cut to text[size] with its end; *length: of the whole. \u0000, which no text can hold,
 * and halves of pairs become U+FFFD. */
bool lar_json_take_string(lar_json_reader *reader, char *text, size_t size, size_t *length);
/* No plus sign, no leading zero, no hexadecimal, no nan; finite. */
bool lar_json_take_number(lar_json_reader *reader, double *value);
bool lar_json_take_boolean(lar_json_reader *reader, bool *value);
/* Any value; false also where it nests deeper than 64. */
bool lar_json_take_value(lar_json_reader *reader);

/* Whether it is UTF-8 and one value, and nothing else; else the reader stands where it is not. */
bool lar_json_is_whole(lar_json_reader *reader);

/* ---- text that is whole ---- */

/* The value of that name; `at` is NULL where `object` is none or has no such name. */
lar_json_reader lar_json_member(lar_json_reader object, const char *name);
/* The next one of an array: from its beginning, until it returns false. Past '[', the reader stands
 * before a value or at ']'. */
bool lar_json_element(lar_json_reader *array, lar_json_reader *element);
/* A string's text, or a number, true, false or null as it is written; cut to text[size]. False for
 * an object, an array, or what is not there. */
bool lar_json_scalar(lar_json_reader value, char *text, size_t size);

#endif
