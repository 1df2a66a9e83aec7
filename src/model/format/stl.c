/* Reader for STL surfaces.
 *
 *     binary                                   ascii
 *     80 bytes header, uint32 count            solid NAME
 *     per triangle 50 bytes:                     facet normal x y z
 *       float32 normal[3], corner[3][3]            outer loop
 *       uint16 attribute                             vertex x y z   (three times)
 *     (little-endian)                          endloop endfacet ... endsolid NAME, solid ...
 *
 * Many programs begin the header of binary files with "solid": the size of the file decides. The
 * normals are not read, they follow from the corners. */
#include "model/triangles/triangles.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/text.h"
#include "model/format/triangle_builder.h"
#include "model/format/vtk/vtk_scalar.h"

enum { HEADER = 84, COUNT_AT = 80, RECORD = 50, NORMAL = 12 };

/* ---- binary ------------------------------------------------------------------------------- */

static uint32_t announced(const lar_bytes *bytes) {
    uint32_t count;
    memcpy(&count, bytes->data + COUNT_AT, sizeof count);
    return lar_vtk_must_swap(false) ? __builtin_bswap32(count) : count;
}

static lar_status parse_binary(const char *path, const lar_bytes *bytes,
                               lar_triangle_builder *builder) {
    uint32_t count = announced(bytes);
    size_t there = (bytes->size - HEADER) / RECORD;
    if (count != there)
        return lar_fail(builder->error, LAR_ERROR_FORMAT,
                        "%s: byte %d announces %" PRIu32
                        " triangles, but the %zu bytes of the file hold %zu; the file is damaged "
                        "or cut short, write it again",
                        path, COUNT_AT, count, bytes->size, there);
    for (uint32_t t = 0; t < count; t++) {
        size_t offset = HEADER + (size_t)RECORD * t + NORMAL;
        double corner[3][3];
        lar_vtk_to_double(LAR_VTK_FLOAT32, bytes->data + offset, lar_vtk_must_swap(false), 9,
                          &corner[0][0]);
        lar_status status = LAR_OK;
        for (int a = 0; a < 3 && !status; a++)
            for (int i = 0; i < 3 && !status; i++)
                if (!isfinite(corner[a][i]))
                    status = lar_fail(builder->error, LAR_ERROR_FORMAT,
                                      "%s: the coordinate at byte %zu (triangle %" PRIu32
                                      " of %" PRIu32 ") is no finite number; write the file again",
                                      path, offset + 4 * (size_t)(3 * a + i), t + 1, count);
        int32_t first = builder->triangles->vertex_count;
        for (int a = 0; a < 3 && !status; a++)
            status = lar_triangle_builder_vertex(builder, corner[a]);
        const int32_t fan[3] = {first, first + 1, first + 2};
        if (!status) status = lar_triangle_builder_polygon(builder, fan, 3);
        if (status) return status;
    }
    return LAR_OK;
}

/* ---- ascii -------------------------------------------------------------------------------- */

typedef struct stl_text {
    const char *path;
    lar_error *error;
    lar_text text;
} stl_text;

static lar_status expected(const stl_text *file, const char *what) {
    lar_text text = file->text;
    lar_span found = {"", 0};
    if (!lar_text_word(&text, &found))
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:%d: the file ends where \"%s\" belongs; it is cut short, write it "
                        "again",
                        file->path, file->text.line, what);
    return lar_fail(file->error, LAR_ERROR_FORMAT,
                    "%s:%d: \"%.*s\" stands where \"%s\" belongs; write the file again", file->path,
                    text.line, found.length < 40 ? (int)found.length : 40, found.at, what);
}

/* Moves past the word, when it is the next one. */
static bool take(stl_text *file, const char *word) {
    lar_text ahead = file->text;
    lar_span found;
    if (!lar_text_word(&ahead, &found) || !lar_span_equal_nocase(found, word)) return false;
    file->text = ahead;
    return true;
}

static lar_status read_vertex(stl_text *file, double at[3]) {
    if (!take(file, "vertex")) return expected(file, "vertex");
    for (int i = 0; i < 3; i++) {
        if (!lar_text_double(&file->text, &at[i])) return expected(file, "a coordinate");
        if (!isfinite(at[i]))
            return lar_fail(file->error, LAR_ERROR_FORMAT,
                            "%s:%d: a coordinate is no finite number; write the file again",
                            file->path, file->text.line);
    }
    return LAR_OK;
}

/* From behind "facet" to "endfacet". The normal may be anything, some programs write nan. */
static lar_status read_facet(stl_text *file, lar_triangle_builder *builder) {
    lar_span word;
    while (!take(file, "outer"))
        if (!lar_text_word(&file->text, &word)) return expected(file, "outer");
    if (!take(file, "loop")) return expected(file, "loop");
    int32_t first = builder->triangles->vertex_count;
    for (int a = 0; a < 3; a++) {
        double at[3];
        lar_status status = read_vertex(file, at);
        if (!status) status = lar_triangle_builder_vertex(builder, at);
        if (status) return status;
    }
    if (!take(file, "endloop")) return expected(file, "endloop");
    if (!take(file, "endfacet")) return expected(file, "endfacet");
    const int32_t fan[3] = {first, first + 1, first + 2};
    return lar_triangle_builder_polygon(builder, fan, 3);
}

static lar_status parse_ascii(stl_text *file, lar_triangle_builder *builder) {
    lar_span name;
    lar_status status = LAR_OK;
    while (!status && lar_text_skip_space(&file->text)) {
        if (!take(file, "solid")) return expected(file, "solid");
        lar_text_line(&file->text, &name);
        while (!status && !take(file, "endsolid"))
            status = take(file, "facet") ? read_facet(file, builder) : expected(file, "facet");
        if (!status) lar_text_line(&file->text, &name);
    }
    return status;
}

/* ---- which one it is ---------------------------------------------------------------------- */

/* The text begins with "solid", and its next line with a word of the format. */
static bool looks_like_text(const stl_text *file) {
    stl_text ahead = *file;
    lar_span line;
    return take(&ahead, "solid") && lar_text_line(&ahead.text, &line) &&
           (take(&ahead, "facet") || take(&ahead, "endsolid"));
}

lar_status lar_stl_parse(const char *path, const lar_bytes *bytes, lar_triangles *triangles,
                         lar_error *error) {
    lar_triangle_builder builder = {.path = path, .error = error, .triangles = triangles};
    stl_text file = {path, error, lar_text_from(bytes)};
    bool fits = bytes->size >= HEADER && bytes->size == HEADER + (size_t)RECORD * announced(bytes);
    if (!fits && looks_like_text(&file)) return parse_ascii(&file, &builder);
    if (bytes->size < HEADER)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: is no STL surface: neither text that begins with \"solid\" nor as "
                        "long as a binary file; check the file or its extension",
                        path);
    return parse_binary(path, bytes, &builder);
}
