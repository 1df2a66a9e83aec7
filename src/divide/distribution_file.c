/* The distribution file, in and out; what it looks like is in distribution.h. */
#include "divide/distribution.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static const char magic[] = "lariat-distribution";
enum { VERSION = 1, MINIMUM_LINE = 4 }; /* the shortest line of an element: "0 0\n" */

/* ---- writing ---------------------------------------------------------------------------- */

static bool print_all(FILE *file, const lar_mesh *mesh, const lar_distribution *d) {
    char grid[LAR_GRID_TEXT];
    lar_grid_format(&d->grid, grid);
    bool good = fprintf(file, "%s %d\ngrid %s\nelements %d\nmesh %016" PRIx64 "\n", magic, VERSION,
                        grid, (int)d->element_count, lar_mesh_fingerprint(mesh)) > 0;
    for (int32_t e = 0; e < d->element_count && good; e++)
        good = fprintf(file, "%d %d\n", (int)e, (int)d->processor[e]) > 0;
    return good && fputs("end\n", file) >= 0 && fflush(file) == 0;
}

lar_status lar_distribution_write(const char *path, const lar_mesh *mesh,
                                  const lar_distribution *distribution, lar_error *error) {
    size_t size = strlen(path) + sizeof ".part";
    char *part = malloc(size);
    if (!part) return lar_fail_memory(error, size, path);
    snprintf(part, size, "%s.part", path);
    errno = 0;
    FILE *file = fopen(part, "wb");
    bool good = file && print_all(file, mesh, distribution);
    int cause = errno;
    if (file && fclose(file) != 0 && good) {
        good = false;
        cause = errno;
    }
    if (good && rename(part, path) != 0) {
        good = false;
        cause = errno;
    }
    if (file && !good) remove(part);
    free(part);
    if (good) return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO,
                    "%s: cannot be written: %s; check the folder, its permissions and the free "
                    "space",
                    path, strerror(cause ? cause : EIO));
}

/* ---- reading ---------------------------------------------------------------------------- */

typedef struct reader {
    const char *path;
    const lar_mesh *mesh;
    lar_error *error;
    lar_text text;
    lar_span line; /* without comment and outer blanks */
    int number;    /* of that line */
} reader;

/* One sentence with file and line. */
#define REFUSE(r, ...) lar_fail((r)->error, LAR_ERROR_FORMAT, __VA_ARGS__)

/* Next line that says something. False at the end of the file. A line must end: a file cut off
 * within its last number must not look like another number. */
static bool next_line(reader *r, bool *whole) {
    lar_span line;
    *whole = true;
    for (;;) {
        r->number = r->text.line;
        if (!lar_text_line(&r->text, &line)) return false;
        *whole = line.at + line.length < r->text.end;
        lar_span rest;
        lar_span_split(line, '#', &line, &rest);
        r->line = lar_span_trim(line);
        if (r->line.length > 0) return true;
    }
}

static lar_status cut_off(const reader *r) {
    return REFUSE(r,
                  "%s:%d: the file ends before its line 'end'; it was cut off, write it again with "
                  "lariat partition",
                  r->path, r->number);
}

/* A line "KEY VALUE"; the value goes to *value. */
static lar_status expect_key(reader *r, const char *key, lar_span *value) {
    bool whole;
    if (!next_line(r, &whole) || !whole) return cut_off(r);
    lar_span head;
    if (!lar_span_split(r->line, ' ', &head, value) || !lar_span_equal(head, key))
        return REFUSE(r, "%s:%d: here must stand '%s' and its value; see docs/formats.md", r->path,
                      r->number, key);
    *value = lar_span_trim(*value);
    return LAR_OK;
}

static lar_status read_magic(reader *r) {
    bool whole;
    lar_span head = {0}, value = {0};
    int64_t version;
    if (!next_line(r, &whole) || !lar_span_split(r->line, ' ', &head, &value) ||
        !lar_span_equal(head, magic) || !lar_span_int64(lar_span_trim(value), &version))
        return REFUSE(r,
                      "%s:%d: this is no distribution file, which begins with '%s %d'; make one "
                      "with lariat partition",
                      r->path, r->number, magic, VERSION);
    if (version != VERSION)
        return REFUSE(r,
                      "%s:%d: version %" PRId64 " of the distribution file is not known here, only "
                      "%d; make it anew with lariat partition",
                      r->path, r->number, version, VERSION);
    return whole ? LAR_OK : cut_off(r);
}

static lar_status read_grid(reader *r, lar_grid *grid) {
    lar_span value;
    lar_status status = expect_key(r, "grid", &value);
    if (status) return status;
    char text[LAR_GRID_TEXT] = {0};
    if (value.length < sizeof text && !memchr(value.at, 0, value.length))
        memcpy(text, value.at, value.length);
    lar_error why = {0};
    if (lar_grid_parse(text, grid, &why))
        return REFUSE(r, "%s:%d: %s", r->path, r->number, why.message);
    return LAR_OK;
}

static lar_status read_elements(reader *r) {
    lar_span value;
    int64_t count;
    lar_status status = expect_key(r, "elements", &value);
    if (status) return status;
    if (!lar_span_int64(value, &count) || count < 1)
        return REFUSE(r, "%s:%d: '%.*s' is no number of elements; write how many the model has",
                      r->path, r->number, (int)(value.length < 60 ? value.length : 60), value.at);
    if (count != r->mesh->element_count)
        return REFUSE(r,
                      "%s:%d: the file is for %" PRId64 " elements, the model has %d; it belongs "
                      "to another model, make one for this with lariat partition",
                      r->path, r->number, count, (int)r->mesh->element_count);
    if (!lar_claim_fits((unsigned long long)count, MINIMUM_LINE,
                        (size_t)(r->text.end - r->text.at)))
        return cut_off(r);
    return LAR_OK;
}

static bool hexadecimal(lar_span span, uint64_t *value) {
    *value = 0;
    for (size_t i = 0; i < span.length; i++) {
        char c = span.at[i];
        int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
        if (digit < 0) return false;
        *value = *value << 4 | (uint64_t)digit;
    }
    return span.length == 16;
}

static lar_status check_fingerprint(const reader *r, lar_span value) {
    uint64_t claimed;
    if (!hexadecimal(lar_span_trim(value), &claimed))
        return REFUSE(r,
                      "%s:%d: behind 'mesh' stand 16 hexadecimal digits; in a file written by hand "
                      "leave the line out",
                      r->path, r->number);
    if (claimed != lar_mesh_fingerprint(r->mesh))
        return REFUSE(r,
                      "%s:%d: the file was made for a mesh with other elements than %s; make one "
                      "for this with lariat partition",
                      r->path, r->number, r->mesh->source ? r->mesh->source : "this model");
    return LAR_OK;
}

/* One line "ELEMENT PROCESSOR" into processor[], where -1 means not given yet. */
static lar_status read_pair(const reader *r, lar_distribution *d) {
    lar_span first, second;
    int64_t e, p;
    if (!lar_span_split(r->line, ' ', &first, &second) || !lar_span_int64(first, &e) ||
        !lar_span_int64(lar_span_trim(second), &p))
        return REFUSE(r, "%s:%d: '%.*s' is not an element and a processor; write e.g. '17 3'",
                      r->path, r->number, (int)(r->line.length < 60 ? r->line.length : 60),
                      r->line.at);
    if (e < 0 || e >= d->element_count)
        return REFUSE(r, "%s:%d: there is no element %" PRId64 "; they count from 0 to %d", r->path,
                      r->number, e, (int)d->element_count - 1);
    if (p < 0 || p >= d->grid.count)
        return REFUSE(r, "%s:%d: the grid has no processor %" PRId64 "; they count from 0 to %d",
                      r->path, r->number, p, (int)d->grid.count - 1);
    if (d->processor[e] >= 0)
        return REFUSE(r, "%s:%d: element %" PRId64 " has a processor already; remove one of both",
                      r->path, r->number, e);
    d->processor[e] = (int32_t)p;
    return LAR_OK;
}

static lar_status read_pairs(reader *r, lar_distribution *d) {
    for (int64_t given = 0;;) {
        bool whole;
        lar_span head = {0}, value = {0};
        if (!next_line(r, &whole) || (!whole && !lar_span_equal(r->line, "end"))) return cut_off(r);
        if (lar_span_equal(r->line, "end")) return LAR_OK;
        lar_status status;
        if (given++ == 0 && lar_span_split(r->line, ' ', &head, &value) &&
            lar_span_equal(head, "mesh"))
            status = check_fingerprint(r, value);
        else
            status = read_pair(r, d);
        if (status) return status;
    }
}

/* Every element has a processor, every processor an element, and nothing follows. */
static lar_status check_complete(reader *r, const lar_distribution *d) {
    bool whole;
    int end = r->number;
    if (next_line(r, &whole))
        return REFUSE(r, "%s:%d: nothing may follow the line 'end'; remove it", r->path, r->number);
    for (int32_t e = 0; e < d->element_count; e++)
        if (d->processor[e] < 0)
            return REFUSE(r, "%s:%d: element %d has no processor; add the line '%d PROCESSOR'",
                          r->path, end, (int)e, (int)e);
    int32_t *count = lar_calloc((size_t)d->grid.count, sizeof *count);
    if (!count) return lar_fail_memory(r->error, 4 * (size_t)d->grid.count, r->path);
    lar_distribution_load(d, count);
    int32_t idle = 0;
    while (idle < d->grid.count && count[idle] > 0) idle++;
    free(count);
    if (idle < d->grid.count)
        return REFUSE(r,
                      "%s:%d: processor %d has no element; give it some or choose a smaller grid",
                      r->path, end, (int)idle);
    return LAR_OK;
}

lar_status lar_distribution_parse(const char *path, const lar_bytes *bytes, const lar_mesh *mesh,
                                  lar_distribution *out, lar_error *error) {
    reader r = {.path = path, .mesh = mesh, .error = error, .text = lar_text_from(bytes)};
    lar_distribution d = {0};
    lar_grid grid;
    lar_status status = read_magic(&r);
    if (!status) status = read_grid(&r, &grid);
    if (!status) status = read_elements(&r);
    if (!status) {
        lar_error why = {0};
        status = lar_distribution_create(mesh, &grid, &d, &why);
        if (status) lar_fail(error, status, "%s:%d: %s", path, r.number, why.message);
    }
    if (!status) memset(d.processor, 0xff, (size_t)d.element_count * sizeof *d.processor);
    if (!status) status = read_pairs(&r, &d);
    if (!status) status = check_complete(&r, &d);
    if (status)
        lar_distribution_clear(&d);
    else
        *out = d;
    return status;
}

lar_status lar_distribution_read(const char *path, const lar_mesh *mesh, lar_distribution *out,
                                 lar_error *error) {
    lar_bytes bytes = {0};
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (!status) status = lar_distribution_parse(path, &bytes, mesh, out, error);
    lar_bytes_free(&bytes);
    return status;
}
