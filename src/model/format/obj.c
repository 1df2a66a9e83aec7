/* Reader for Wavefront OBJ surfaces.
 *
 *     v x y z [w | r g b]        a vertex
 *     f a b c ...                a polygon: a, a/texture, a/texture/normal or a//normal, counted
 *                                from 1; negative: backwards from the vertex above
 *
 * A backslash at its end continues a line. All else (groups, names, materials, normals, lines) says
 * nothing about the shape and is passed over. */
#include "model/triangles/triangles.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "model/format/triangle_builder.h"

typedef struct obj_file {
    const char *path;
    lar_error *error;
    lar_text text;
    int line; /* where the line in hand begins */
    char *joined;
    size_t joined_capacity; /* lines that were continued, as one */
    size_t corner_capacity;
    int32_t *corner; /* of the polygon in hand */
    int64_t last;    /* the largest vertex number of all polygons, from 1 */
    int last_line;   /* and where it stands */
    lar_triangle_builder builder;
} obj_file;

static bool is_continued(lar_span line) {
    return line.length > 0 && line.at[line.length - 1] == '\\';
}

static bool append(obj_file *file, size_t *length, lar_span part) {
    size_t wanted = *length + part.length + 2;
    if (wanted > file->joined_capacity) {
        char *grown = realloc(file->joined, 2 * wanted);
        if (!grown) return false;
        file->joined = grown;
        file->joined_capacity = 2 * wanted;
    }
    memcpy(file->joined + *length, part.at, part.length);
    *length += part.length;
    file->joined[(*length)++] = ' ';
    file->joined[*length] = '\0';
    return true;
}

/* The next line, with those that continue it. *ended: there is none. */
static lar_status next_line(obj_file *file, lar_text *line, bool *ended) {
    lar_span part;
    file->line = file->text.line;
    *ended = !lar_text_line(&file->text, &part);
    if (*ended) return LAR_OK;
    if (!is_continued(part)) {
        *line = (lar_text){part.at, part.at + part.length, file->line};
        return LAR_OK;
    }
    size_t length = 0;
    for (bool more = true; more;) {
        more = is_continued(part);
        if (more) part.length--;
        if (!append(file, &length, part))
            return lar_fail_memory(file->error, length + part.length, file->path);
        if (more && !lar_text_line(&file->text, &part)) more = false;
    }
    *line = (lar_text){file->joined, file->joined + length, file->line};
    return LAR_OK;
}

static lar_status read_vertex(obj_file *file, lar_text *line) {
    double at[3];
    for (int i = 0; i < 3; i++)
        if (!lar_text_double(line, &at[i]) || !isfinite(at[i]))
            return lar_fail(file->error, LAR_ERROR_FORMAT,
                            "%s:%d: a vertex needs three finite numbers; write the file again",
                            file->path, file->line);
    return lar_triangle_builder_vertex(&file->builder, at);
}

static lar_status read_corner(obj_file *file, lar_span word, int32_t *corner) {
    lar_span number, rest;
    lar_span_split(word, '/', &number, &rest);
    int64_t vertex;
    int shown = word.length < 40 ? (int)word.length : 40;
    if (!lar_span_int64(number, &vertex) || vertex == 0 || vertex > INT32_MAX)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:%d: \"%.*s\" is no corner of a polygon; vertices are counted from 1, "
                        "write the file again",
                        file->path, file->line, shown, word.at);
    int32_t above = file->builder.triangles->vertex_count;
    if (vertex < -(int64_t)above)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:%d: the corner \"%.*s\" goes back beyond the first of the %" PRId32
                        " vertices above; write the file again",
                        file->path, file->line, shown, word.at, above);
    if (vertex < 0) vertex += above + 1;
    if (vertex > file->last) {
        file->last = vertex;
        file->last_line = file->line;
    }
    *corner = (int32_t)(vertex - 1);
    return LAR_OK;
}

static lar_status read_polygon(obj_file *file, lar_text *line) {
    size_t count = 0;
    lar_span word;
    while (lar_text_word(line, &word) && word.at[0] != '#') {
        if (!LAR_GROW(file->corner, file->corner_capacity, count))
            return lar_fail_memory(file->error, count * sizeof *file->corner, file->path);
        lar_status status = read_corner(file, word, &file->corner[count++]);
        if (status) return status;
    }
    if (count < 3)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:%d: a polygon needs three corners at least; write the file again",
                        file->path, file->line);
    return lar_triangle_builder_polygon(&file->builder, file->corner, count);
}

static lar_status read_lines(obj_file *file) {
    for (;;) {
        lar_text line;
        lar_span keyword;
        bool ended;
        lar_status status = next_line(file, &line, &ended);
        if (status || ended) return status;
        if (!lar_text_word(&line, &keyword)) continue;
        if (lar_span_equal(keyword, "v")) status = read_vertex(file, &line);
        if (lar_span_equal(keyword, "f") || lar_span_equal(keyword, "fo"))
            status = read_polygon(file, &line);
        if (status) return status;
    }
}

lar_status lar_obj_parse(const char *path, const lar_bytes *bytes, lar_triangles *triangles,
                         lar_error *error) {
    obj_file file = {.path = path,
                     .error = error,
                     .text = lar_text_from(bytes),
                     .builder = {.path = path, .error = error, .triangles = triangles}};
    lar_status status = read_lines(&file);
    free(file.joined);
    free(file.corner);
    if (status) return status;
    if (file.last > triangles->vertex_count)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s:%d: vertex %" PRId64 " is named, but the file has %" PRId32
                        "; it is damaged or cut short, write it again",
                        path, file.last_line, file.last, triangles->vertex_count);
    if (triangles->triangle_count == 0)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: has no polygon (a line that begins with f), so it is no surface; "
                        "check the file or its extension",
                        path);
    return LAR_OK;
}
