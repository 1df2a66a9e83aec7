/* What the text files of this room have in common: distributions and schedules.
 *
 *     lariat-KIND 1        kind and version
 *     key value            lines of a head
 *     word word  word      the rest, by lines or by words
 *     end                  # a comment; empty lines do not count
 *
 * A reader holds one line and one word of it at a time, both in the file's own bytes, and knows the
 * number of the line for its messages. Neither may be cut off: a number at the very end of a file
 * without a line end could be half of another one. Files are written whole or not at all.
 */
#ifndef LAR_DIVIDE_TEXT_FILE_H
#define LAR_DIVIDE_TEXT_FILE_H

#include <stdio.h>

#include "base/memory.h"
#include "divide/grid.h"
#include "model/mesh/mesh.h"

typedef struct lar_text_file {
    const char *path; /* for messages */
    const char *kind; /* "distribution" */
    lar_error *error;
    const char *at, *end; /* what is not read yet */
    int next;             /* number of its first line */

    const char *line; /* this line, without comment and outer blanks; not terminated */
    size_t line_length;
    int number;
    bool whole; /* it has a line end */

    const char *word; /* a word of this line, or the value behind a key; not terminated */
    size_t word_length;
} lar_text_file;

/* ---- reading: the bytes must outlive the reader ------------------------------------------- */

lar_text_file lar_text_file_from(const char *kind, const char *path, const lar_bytes *bytes,
                                 lar_error *error);

/* LAR_ERROR_FORMAT with "PATH:LINE: " before the sentence. */
lar_status lar_text_file_refuse(const lar_text_file *file, int line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The same for a file that stops too early. */
lar_status lar_text_file_cut_off(const lar_text_file *file);

/* Next line that says something; false at the end. */
bool lar_text_file_line(lar_text_file *file);
/* Next word, of this line or of the next ones. */
lar_status lar_text_file_word(lar_text_file *file);

/* The word: is it this one, what number is it, and as much of it as a message takes ("%.*s"). */
bool lar_text_file_is(const lar_text_file *file, const char *word);
bool lar_text_file_int64(const lar_text_file *file, int64_t *value);
bool lar_text_file_hexadecimal(const lar_text_file *file, uint64_t *value); /* 16 digits */
int lar_text_file_shown(size_t length);

/* First line: kind and version. Also refuses what is no text. */
lar_status lar_text_file_version(lar_text_file *file, int version);
/* Next line is "KEY VALUE"; the value becomes the word. */
lar_status lar_text_file_key(lar_text_file *file, const char *key);
lar_status lar_text_file_grid(lar_text_file *file, lar_grid *grid);
/* Refuses a fingerprint that is not the mesh's. */
lar_status lar_text_file_mesh(const lar_text_file *file, uint64_t claimed, const lar_mesh *mesh);
/* After the line "end". */
lar_status lar_text_file_done(lar_text_file *file);

/* ---- writing ------------------------------------------------------------------------------ */

typedef void lar_text_file_print(FILE *file, const void *context);

/* Writes PATH.part and gives it its name when it is complete. */
lar_status lar_text_file_write(const char *path, lar_text_file_print *print, const void *context,
                               lar_error *error);

#endif
