#include "divide/text_file.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/file/part_file.h"
#include "base/text.h"
#include "divide/distribution.h"

/* ---- lines and words -------------------------------------------------------------------- */

lar_text_file lar_text_file_from(const char *kind, const char *path, const lar_bytes *bytes,
                                 lar_error *error) {
    const lar_text text = lar_text_from(bytes);
    return (lar_text_file){.path = path,
                           .kind = kind,
                           .error = error,
                           .at = text.at,
                           .end = text.end,
                           .next = text.line,
                           .line = text.at,
                           .number = text.line,
                           .word = text.at};
}

lar_status lar_text_file_refuse(const lar_text_file *file, int line, const char *format, ...) {
    lar_error why;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why.message, sizeof why.message, format, arguments);
    va_end(arguments);
    return lar_fail(file->error, LAR_ERROR_FORMAT, "%s:%d: %s", file->path, line, why.message);
}

lar_status lar_text_file_cut_off(const lar_text_file *file) {
    return lar_text_file_refuse(file, file->number,
                                "the file ends before its line 'end'; it was cut off, write it "
                                "again with lariat partition");
}

bool lar_text_file_line(lar_text_file *file) {
    lar_text text = {file->at, file->end, file->next};
    lar_span line, rest;
    do {
        file->number = text.line;
        if (!lar_text_line(&text, &line)) {
            file->at = file->end;
            return false;
        }
        file->whole = line.at + line.length < text.end;
        lar_span_split(line, '#', &line, &rest);
        line = lar_span_trim(line);
    } while (line.length == 0);
    file->at = text.at;
    file->next = text.line;
    file->line = line.at;
    file->line_length = line.length;
    file->word = line.at;
    file->word_length = 0;
    return true;
}

lar_status lar_text_file_word(lar_text_file *file) {
    for (;;) {
        const char *stop = file->line + file->line_length;
        lar_text rest = {file->word + file->word_length, stop, file->number};
        lar_span word;
        if (lar_text_word(&rest, &word)) {
            file->word = word.at;
            file->word_length = word.length;
            bool last = word.at + word.length == stop;
            if (!file->whole && last && !lar_span_equal(word, "end"))
                return lar_text_file_cut_off(file);
            return LAR_OK;
        }
        if (!lar_text_file_line(file)) return lar_text_file_cut_off(file);
    }
}

bool lar_text_file_is(const lar_text_file *file, const char *word) {
    return lar_span_equal((lar_span){file->word, file->word_length}, word);
}

bool lar_text_file_int64(const lar_text_file *file, int64_t *value) {
    return lar_span_int64((lar_span){file->word, file->word_length}, value);
}

bool lar_text_file_hexadecimal(const lar_text_file *file, uint64_t *value) {
    *value = 0;
    for (size_t i = 0; i < file->word_length; i++) {
        char c = file->word[i];
        int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
        if (digit < 0) return false;
        *value = *value << 4 | (uint64_t)digit;
    }
    return file->word_length == 16;
}

int lar_text_file_shown(size_t length) {
    return (int)(length < 60 ? length : 60);
}

/* ---- head and end ----------------------------------------------------------------------- */

/* A zero byte would end every message early, and no editor shows it. */
static lar_status check_text(const lar_text_file *file) {
    const char *zero = memchr(file->at, 0, (size_t)(file->end - file->at));
    if (!zero) return LAR_OK;
    int line = file->next;
    for (const char *c = file->at; c < zero; c++) line += *c == '\n';
    return lar_text_file_refuse(file, line,
                                "a zero byte stands here, the file is damaged; write it again with "
                                "lariat partition");
}

lar_status lar_text_file_version(lar_text_file *file, int version) {
    static const char family[] = "lariat-";
    const lar_text_file all = *file;
    lar_span head = {0}, value = {0};
    int64_t claimed;
    bool good = lar_text_file_line(file) &&
                lar_span_split((lar_span){file->line, file->line_length}, ' ', &head, &value) &&
                head.length > strlen(family) && memcmp(head.at, family, strlen(family)) == 0;
    if (good) {
        head.at += strlen(family);
        head.length -= strlen(family);
        good = lar_span_equal(head, file->kind) && lar_span_int64(lar_span_trim(value), &claimed);
    }
    if (!good)
        return lar_text_file_refuse(file, file->number,
                                    "this is no %s file, which begins with '%s%s %d'; make one "
                                    "with lariat partition",
                                    file->kind, family, file->kind, version);
    if (claimed != version)
        return lar_text_file_refuse(file, file->number,
                                    "version %" PRId64 " of the %s file is not known here, only "
                                    "%d; make it anew with lariat partition",
                                    claimed, file->kind, version);
    return file->whole ? check_text(&all) : lar_text_file_cut_off(file);
}

lar_status lar_text_file_key(lar_text_file *file, const char *key) {
    if (!lar_text_file_line(file) || !file->whole) return lar_text_file_cut_off(file);
    lar_span head, value;
    if (!lar_span_split((lar_span){file->line, file->line_length}, ' ', &head, &value) ||
        !lar_span_equal(head, key))
        return lar_text_file_refuse(file, file->number,
                                    "here must stand '%s' and its value; see docs/formats.md", key);
    value = lar_span_trim(value);
    file->word = value.at;
    file->word_length = value.length;
    return LAR_OK;
}

lar_status lar_text_file_grid(lar_text_file *file, lar_grid *grid) {
    lar_status status = lar_text_file_key(file, "grid");
    if (status) return status;
    char text[LAR_GRID_TEXT] = {0};
    if (file->word_length < sizeof text) memcpy(text, file->word, file->word_length);
    lar_error why = {0};
    if (lar_grid_parse(text, grid, &why))
        return lar_text_file_refuse(file, file->number, "%s", why.message);
    return LAR_OK;
}

lar_status lar_text_file_mesh(const lar_text_file *file, uint64_t claimed, const lar_mesh *mesh) {
    if (claimed == lar_mesh_fingerprint(mesh)) return LAR_OK;
    return lar_text_file_refuse(file, file->number,
                                "the file was made for a mesh with other elements than %s; make "
                                "one for this with lariat partition",
                                mesh->source ? mesh->source : "this model");
}

lar_status lar_text_file_done(lar_text_file *file) {
    const char *stop = file->line + file->line_length;
    if (file->word + file->word_length == stop && !lar_text_file_line(file)) return LAR_OK;
    return lar_text_file_refuse(file, file->number, "nothing may follow the line 'end'; remove it");
}

/* ---- writing ---------------------------------------------------------------------------- */

lar_status lar_text_file_write(const char *path, lar_text_file_print *print, const void *context,
                               lar_error *error) {
    lar_part_file out;
    lar_status status = lar_part_open(&out, path, error);
    if (!status) print(out.file, context);
    return lar_part_close(&out, status);
}
