/* The distribution file, in and out; what it looks like is in distribution.h. */
#include "divide/distribution.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "divide/text_file.h"

static const char kind[] = "distribution";
enum { VERSION = 1, MINIMUM_LINE = 4 }; /* the shortest line of an element: "0 0\n" */

/* ---- writing ---------------------------------------------------------------------------- */

typedef struct content {
    const lar_mesh *mesh;
    const lar_distribution *distribution;
} content;

static void print_all(FILE *file, const void *context) {
    const content *c = context;
    const lar_distribution *d = c->distribution;
    char grid[LAR_GRID_TEXT];
    lar_grid_format(&d->grid, grid);
    fprintf(file, "lariat-%s %d\ngrid %s\nelements %d\nmesh %016" PRIx64 "\n", kind, VERSION, grid,
            (int)d->element_count, lar_mesh_fingerprint(c->mesh));
    for (int32_t e = 0; e < d->element_count && !ferror(file); e++)
        fprintf(file, "%d %d\n", (int)e, (int)d->processor[e]);
    fputs("end\n", file);
}

lar_status lar_distribution_write(const char *path, const lar_mesh *mesh,
                                  const lar_distribution *distribution, lar_error *error) {
    return lar_text_file_write(path, print_all, &(content){mesh, distribution}, error);
}

/* ---- reading ---------------------------------------------------------------------------- */

/* One sentence with file and line. */
#define REFUSE(f, ...) lar_text_file_refuse(f, (f)->number, __VA_ARGS__)

static lar_status read_elements(lar_text_file *f, const lar_mesh *mesh) {
    int64_t count;
    lar_status status = lar_text_file_key(f, "elements");
    if (status) return status;
    if (!lar_text_file_int64(f, &count) || count < 1)
        return REFUSE(f, "'%.*s' is no number of elements; write how many the model has",
                      lar_text_file_shown(f->word_length), f->word);
    if (count != mesh->element_count)
        return REFUSE(f,
                      "the file is for %" PRId64 " elements, the model has %d; it belongs to "
                      "another model, make one for this with lariat partition",
                      count, (int)mesh->element_count);
    if (!lar_claim_fits((unsigned long long)count, MINIMUM_LINE, (size_t)(f->end - f->at)))
        return lar_text_file_cut_off(f);
    return LAR_OK;
}

static lar_status check_fingerprint(const lar_text_file *f, const lar_mesh *mesh) {
    uint64_t claimed;
    if (!lar_text_file_hexadecimal(f, &claimed))
        return REFUSE(f, "behind 'mesh' stand 16 hexadecimal digits; in a file written by hand "
                         "leave the line out");
    return lar_text_file_mesh(f, claimed, mesh);
}

/* One line "ELEMENT PROCESSOR" into processor[], where -1 means not given yet. */
static lar_status read_pair(const lar_text_file *f, lar_distribution *d) {
    lar_span first, second;
    int64_t e, p;
    if (!lar_span_split((lar_span){f->line, f->line_length}, ' ', &first, &second) ||
        !lar_span_int64(first, &e) || !lar_span_int64(lar_span_trim(second), &p))
        return REFUSE(f, "'%.*s' is not an element and a processor; write e.g. '17 3'",
                      lar_text_file_shown(f->line_length), f->line);
    if (e < 0 || e >= d->element_count)
        return REFUSE(f, "there is no element %" PRId64 "; they count from 0 to %d", e,
                      (int)d->element_count - 1);
    if (p < 0 || p >= d->grid.count)
        return REFUSE(f, "the grid has no processor %" PRId64 "; they count from 0 to %d", p,
                      (int)d->grid.count - 1);
    if (d->processor[e] >= 0)
        return REFUSE(f, "element %" PRId64 " has a processor already; remove one of both", e);
    d->processor[e] = (int32_t)p;
    return LAR_OK;
}

static lar_status read_pairs(lar_text_file *f, const lar_mesh *mesh, lar_distribution *d) {
    for (int64_t given = 0;;) {
        if (!lar_text_file_line(f)) return lar_text_file_cut_off(f);
        lar_span line = {f->line, f->line_length}, head = {0}, value = {0};
        bool last = lar_span_equal(line, "end");
        if (!f->whole && !last) return lar_text_file_cut_off(f);
        f->word = f->line;
        f->word_length = f->line_length;
        if (last) return LAR_OK;
        lar_status status;
        if (given++ == 0 && lar_span_split(line, ' ', &head, &value) &&
            lar_span_equal(head, "mesh")) {
            value = lar_span_trim(value);
            f->word = value.at;
            f->word_length = value.length;
            status = check_fingerprint(f, mesh);
        } else {
            status = read_pair(f, d);
        }
        if (status) return status;
    }
}

/* Every element has a processor, every processor an element, and nothing follows. */
static lar_status check_complete(lar_text_file *f, const lar_distribution *d) {
    int end = f->number;
    lar_status status = lar_text_file_done(f);
    if (status) return status;
    for (int32_t e = 0; e < d->element_count; e++)
        if (d->processor[e] < 0)
            return lar_text_file_refuse(
                f, end, "element %d has no processor; add the line '%d PROCESSOR'", (int)e, (int)e);
    int32_t *count = lar_calloc((size_t)d->grid.count, sizeof *count);
    if (!count) return lar_fail_memory(f->error, 4 * (size_t)d->grid.count, f->path);
    lar_distribution_load(d, count);
    int32_t idle = 0;
    while (idle < d->grid.count && count[idle] > 0) idle++;
    free(count);
    if (idle < d->grid.count)
        return lar_text_file_refuse(
            f, end, "processor %d has no element; give it some or choose a smaller grid",
            (int)idle);
    return LAR_OK;
}

lar_status lar_distribution_parse(const char *path, const lar_bytes *bytes, const lar_mesh *mesh,
                                  lar_distribution *out, lar_error *error) {
    lar_text_file f = lar_text_file_from(kind, path, bytes, error);
    lar_distribution d = {0};
    lar_grid grid;
    lar_status status = lar_text_file_version(&f, VERSION);
    if (!status) status = lar_text_file_grid(&f, &grid);
    if (!status) status = read_elements(&f, mesh);
    if (!status) {
        lar_error why = {0};
        status = lar_distribution_create(mesh, &grid, &d, &why);
        if (status) lar_fail(error, status, "%s:%d: %s", path, f.number, why.message);
    }
    if (!status) memset(d.processor, 0xff, (size_t)d.element_count * sizeof *d.processor);
    if (!status) status = read_pairs(&f, mesh, &d);
    if (!status) status = check_complete(&f, &d);
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
