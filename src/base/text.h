/* Reading numbers and words from text in memory, with the line always known, and what writers need
 * to print numbers that can be read again.
 *
 * Every text reader (legacy VTK, Gmsh, Abaqus, XML payloads) stands on this one scanner:
 * bounded, independent of the locale, and able to say where it stopped.
 */
#ifndef LAR_BASE_TEXT_H
#define LAR_BASE_TEXT_H

#include <locale.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"

/* A position in text [at, end). *end must be readable and hold a byte that ends a number
 * (lar_bytes gives a zero byte there). */
typedef struct lar_text {
    const char *at;
    const char *end;
    int line; /* 1-based */
} lar_text;

/* A word or a line inside the text; not terminated. */
typedef struct lar_span {
    const char *at;
    size_t length;
} lar_span;

/* The whole of a file, behind the byte order mark of UTF-8 that editors and spreadsheets put before
 * it. */
lar_text lar_text_from(const lar_bytes *bytes);

/* The same of a file that a spreadsheet may have written, whose export as "Unicode text" has two
 * bytes for each character: LAR_ERROR_FORMAT, with file and line, where a byte is 0. */
lar_status lar_text_open(const char *path, const lar_bytes *bytes, lar_text *text,
                         lar_error *error);

/* Skips blanks and line ends, counting lines. False at the end of the text. */
bool lar_text_skip_space(lar_text *text);

/* Next word (up to white space). False at the end. */
bool lar_text_word(lar_text *text, lar_span *word);

/* The rest of the current line without its end (\n or \r\n), moving past it. False at the end
 * of the text. */
bool lar_text_line(lar_text *text, lar_span *line);

/* Next number; white space before it is skipped. False when the next word is no number of that
 * kind or does not fit; the position then stays before the word. Doubles: decimal notation, also
 * with Fortran's D exponent; "nan" and "inf" are read as such, so that the caller can say where
 * they stand. */
bool lar_text_double(lar_text *text, double *value);
bool lar_text_int64(lar_text *text, int64_t *value);

/* One number from a whole span; false when anything else is in it. */
bool lar_span_double(lar_span span, double *value);
bool lar_span_int64(lar_span span, int64_t *value);

/* Span without white space at both ends. */
lar_span lar_span_trim(lar_span span);

/* Splits at the first `separator`: *head before it, *rest after it. False (and *head the whole)
 * when there is none. */
bool lar_span_split(lar_span span, char separator, lar_span *head, lar_span *rest);

bool lar_span_equal(lar_span span, const char *word);
bool lar_span_equal_nocase(lar_span span, const char *word);

/* Bytes of the UTF-8 character at the beginning of `text`; 0: there is none (RFC 3629). */
int lar_utf8_length(const unsigned char *text, size_t length);

/* Puts '?' where a character would steer a terminal that shows the text: control characters, also
 * those beyond ASCII (U+0080 to U+009F in UTF-8). All other UTF-8 stays. NULL is fine. */
void lar_text_show(char *text);

/* vsnprintf for sentences: what does not fit is left out of the middle ("..."), for that is where
 * long paths are; what is wrong with them, and what to do, stands behind. */
void lar_text_print(char *to, size_t size, const char *format, va_list args)
    __attribute__((format(printf, 3, 0)));

/* "a", "a and b", "a, b and c" into to[size], cut where it does not fit. */
void lar_text_list(const char *const *name, int count, char *to, size_t size);

/* A time [s] as people write it: "52.3 us", "8.77 ms". */
typedef struct lar_time_text {
    char text[16];
} lar_time_text;
lar_time_text lar_text_time(double seconds);

/* The C locale, in which numbers have a point. For uselocale() around what prints numbers into a
 * file: an embedding program may have another one. Lives as long as the program; 0, with which
 * uselocale() changes nothing, when there is no memory for it. */
locale_t lar_text_locale(void);

#endif
