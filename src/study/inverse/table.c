#include "study/inverse/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

enum { COLUMNS_MAX = 64, ROWS_MAX = 100000, SHOWN = 40 };

typedef struct reader {
    lar_text text;
    int line;
    char separator;
    size_t capacity, line_capacity;
} reader;

static bool next_line(reader *r, lar_span *line) {
    do {
        r->line = r->text.line;
        if (!lar_text_line(&r->text, line)) return false;
        *line = lar_span_trim(*line);
    } while (line->length == 0 || line->at[0] == '#');
    return true;
}

static int shown(lar_span span) {
    return (int)(span.length < SHOWN ? span.length : SHOWN);
}

/* What parts the names parts all columns: the first comma, semicolon or tab outside of quotes. */
static char separator_of(lar_span line) {
    bool quoted = false;
    for (size_t c = 0; c < line.length; c++) {
        if (line.at[c] == '"') quoted = !quoted;
        if (!quoted && memchr(",;\t", line.at[c], 3)) return line.at[c];
    }
    return ',';
}

/* The next column, without the quotes around it; false: it is the last one. */
static bool take_column(lar_span *rest, char separator, lar_span *column) {
    lar_span all = *rest;
    while (all.length > 0 && *all.at == ' ') all = (lar_span){all.at + 1, all.length - 1};
    const char *end =
        all.length > 0 && *all.at == '"' ? memchr(all.at + 1, '"', all.length - 1) : NULL;
    if (!end) {
        bool more = lar_span_split(*rest, separator, column, rest);
        *column = lar_span_trim(*column);
        return more;
    }
    lar_span behind = {end + 1, all.length - (size_t)(end + 1 - all.at)}, unused;
    *column = lar_span_trim((lar_span){all.at + 1, (size_t)(end - all.at) - 1});
    return lar_span_split(behind, separator, &unused, rest);
}

static lar_status read_names(reader *r, lar_inverse_table *t, lar_error *error) {
    lar_span rest, part;
    double number;
    if (!next_line(r, &rest))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: nothing is in it; the first line names the columns, as time,force",
                        t->path);
    t->header_line = r->line;
    r->separator = separator_of(rest);
    for (bool more = true; more;) {
        more = take_column(&rest, r->separator, &part);
        if (part.length == 0 || lar_span_double(part, &number))
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s:%d: '%.*s' is no name of a column; the first line names the "
                            "columns, separated by commas, as time,force",
                            t->path, r->line, shown(part), part.at);
        if (t->columns == COLUMNS_MAX)
            return lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: more than %d columns", t->path,
                            r->line, COLUMNS_MAX);
        char *name = lar_strndup(part.at, part.length);
        if (!name) return lar_fail_memory(error, part.length, t->path);
        bool twice = lar_inverse_table_find(t, name) >= 0;
        t->name[t->columns++] = name;
        if (twice)
            return lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: the column %.*s stands twice", t->path,
                            r->line, shown(part), part.at);
    }
    return LAR_OK;
}

static lar_status read_row(reader *r, lar_inverse_table *t, lar_span rest, lar_error *error) {
    size_t rows = (size_t)t->rows;
    if (rows == ROWS_MAX)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s:%d: more than %d rows; leave out what tells nothing new", t->path,
                        r->line, ROWS_MAX);
    if (!lar_grow_array(&t->value, &r->capacity, rows, (size_t)t->columns * sizeof(double)) ||
        !LAR_GROW(t->line, r->line_capacity, rows))
        return lar_fail_memory(error, rows, t->path);
    bool more = true;
    int i = 0;
    for (lar_span part; i < t->columns && more; i++) {
        more = take_column(&rest, r->separator, &part);
        double *value = &t->value[rows * (size_t)t->columns + (size_t)i];
        if (!lar_span_double(part, value)) *value = NAN;
    }
    if (more || i < t->columns)
        return lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: %s values than the %d columns named above",
                        t->path, r->line, more ? "more" : "fewer", t->columns);
    t->line[t->rows++] = r->line;
    return LAR_OK;
}

static lar_status parse(const lar_bytes *bytes, lar_inverse_table *t, lar_error *error) {
    reader r = {0};
    lar_span line;
    lar_status status = lar_text_open(t->path, bytes, &r.text, error);
    if (!status) status = read_names(&r, t, error);
    while (!status && next_line(&r, &line)) status = read_row(&r, t, line, error);
    if (!status && t->rows < 2)
        status = lar_fail(error, LAR_ERROR_FORMAT,
                          "%s:%d: %s of numbers below the names; a fit needs two at least", t->path,
                          t->header_line, t->rows ? "one row only" : "no row");
    return status;
}

lar_status lar_inverse_table_read(const char *path, lar_inverse_table *t, lar_error *error) {
    lar_bytes bytes;
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    t->path = lar_strdup(path);
    t->name = lar_calloc(COLUMNS_MAX, sizeof *t->name);
    status = t->path && t->name ? parse(&bytes, t, error) : lar_fail_memory(error, 1, path);
    lar_bytes_free(&bytes);
    return status;
}

void lar_inverse_table_clear(lar_inverse_table *t) {
    for (int i = 0; i < t->columns; i++) free(t->name[i]);
    free(t->name);
    free(t->path);
    free(t->line);
    free(t->value);
    *t = (lar_inverse_table){0};
}

int lar_inverse_table_find(const lar_inverse_table *t, const char *name) {
    for (int i = 0; i < t->columns; i++)
        if (strcmp(t->name[i], name) == 0) return i;
    return -1;
}

lar_status lar_inverse_table_take(const lar_inverse_table *t, int column, double scale,
                                  double *value, lar_error *error) {
    for (int32_t i = 0; i < t->rows; i++) {
        value[i] = scale * t->value[(size_t)i * (size_t)t->columns + (size_t)column];
        if (!isfinite(value[i]))
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s:%d: what stands in the column %s is no finite number, as 0.5; "
                            "correct it, or leave the row out",
                            t->path, t->line[i], t->name[column]);
    }
    return LAR_OK;
}
