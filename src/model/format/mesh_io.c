#include "model/format/mesh_io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"

/* ---- what the first bytes say ------------------------------------------------------------- */

/* The file from its first byte that is no white space and no byte order mark. */
static lar_span beginning(const lar_bytes *bytes) {
    lar_text text = lar_text_from(bytes);
    lar_text_skip_space(&text);
    return (lar_span){text.at, (size_t)(text.end - text.at)};
}

static bool starts_with(const lar_bytes *bytes, const char *word) {
    lar_span text = beginning(bytes);
    size_t length = strlen(word);
    return text.length >= length && strncasecmp(text.at, word, length) == 0;
}

static bool looks_like_xml(const lar_bytes *bytes) {
    return starts_with(bytes, "<");
}

static bool looks_like_vtk(const lar_bytes *bytes) {
    return starts_with(bytes, "# vtk");
}

static bool looks_like_msh(const lar_bytes *bytes) {
    return starts_with(bytes, "$");
}

static bool looks_like_inp(const lar_bytes *bytes) {
    return starts_with(bytes, "*");
}

/* ---- the formats -------------------------------------------------------------------------- */

typedef struct format_row {
    const char *extension;
    const char *content; /* what such a file holds, for messages */
    bool (*looks_right)(const lar_bytes *bytes);
    lar_status (*parse)(const char *path, const lar_bytes *bytes, lar_mesh *mesh, lar_error *error);
} format_row;

static const format_row formats[] = {
    {"vtu", "a VTK XML file (beginning with <)", looks_like_xml, lar_vtu_parse},
    {"vtk", "a legacy VTK file (beginning with '# vtk')", looks_like_vtk, lar_vtk_parse},
    {"msh", "a Gmsh mesh (beginning with $MeshFormat or $NOD)", looks_like_msh, lar_msh_parse},
    {"inp", "an Abaqus input file (beginning with *)", looks_like_inp, lar_inp_parse},
    {"feb", "a FEBio file (beginning with <)", looks_like_xml, lar_feb_parse_mesh},
};
enum { FORMAT_COUNT = sizeof formats / sizeof *formats };

static const format_row *find_format(const char *path) {
    const char *extension = lar_path_extension(path);
    for (int i = 0; i < FORMAT_COUNT; i++)
        if (strcasecmp(extension, formats[i].extension) == 0) return &formats[i];
    return NULL;
}

/* Files that people rename or pick by mistake. */
static const char *known_content(const lar_bytes *bytes) {
    static const struct {
        const char *magic;
        size_t length;
        const char *content;
    } magics[] = {
        {"\x89PNG", 4, "a PNG picture"},
        {"\xff\xd8\xff", 3, "a JPEG picture"},
        {"PK\x03\x04", 4, "a ZIP archive"},
        {"\x1f\x8b", 2, "a file compressed with gzip: unpack it first"},
        {"%PDF", 4, "a PDF document"},
        {"\x89HDF", 4, "an HDF5 file"},
        {"\x7f"
         "ELF",
         4, "a program"},
    };
    for (size_t i = 0; i < sizeof magics / sizeof *magics; i++)
        if (bytes->size >= magics[i].length &&
            memcmp(bytes->data, magics[i].magic, magics[i].length) == 0)
            return magics[i].content;
    for (int i = 0; i < FORMAT_COUNT; i++)
        if (formats[i].looks_right(bytes)) return formats[i].content;
    return NULL;
}

static lar_status fail_content(const char *path, const format_row *format, const lar_bytes *bytes,
                               lar_error *error) {
    const char *content = known_content(bytes);
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: is named .%s but is not %s%s%s; give the file its right name or export "
                    "it again",
                    path, format->extension, format->content, content ? "; it looks like " : "",
                    content ? content : "");
}

static lar_status fail_extension(const char *path, lar_error *error) {
    char known[FORMAT_COUNT * 8] = "";
    for (int i = 0; i < FORMAT_COUNT; i++) {
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, " .%s", formats[i].extension);
    }
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "%s: no mesh format has this extension; the known ones are%s", path, known);
}

/* The data set is named in the fourth line of the head, which is two short lines and a title. */
static bool holds_grid(const char *path) {
    char head[1024] = "";
    FILE *file = fopen(path, "rb");
    if (!file) return false;
    size_t length = fread(head, 1, sizeof head - 1, file);
    fclose(file);
    for (size_t c = 0; c < length; c++)
        if (strncasecmp(head + c, "UNSTRUCTURED_GRID", 17) == 0) return true;
    return false;
}

bool lar_mesh_named(const char *path) {
    const format_row *format = find_format(path);
    return format && (format->parse != lar_vtk_parse || holds_grid(path));
}

static lar_status read_unchecked(const char *path, double scale, lar_mesh *mesh, lar_error *error) {
    const format_row *format = find_format(path);
    if (!format) return fail_extension(path, error);
    if (!isfinite(scale) || !(scale > 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s: the scale %g is not a positive number; 0.001 turns millimetres into "
                        "metres",
                        path, scale);
    lar_bytes bytes = {0};
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;

    if (!format->looks_right(&bytes))
        status = fail_content(path, format, &bytes, error);
    else
        status = format->parse(path, &bytes, mesh, error);
    lar_bytes_free(&bytes);
    for (int32_t n = 0; n < mesh->node_count && !status; n++)
        for (int i = 0; i < 3; i++) mesh->position[n][i] *= scale;
    return status;
}

static lar_status take(lar_mesh *read, lar_status status, lar_mesh *mesh) {
    free(read->element_line);
    read->element_line = NULL;
    if (status)
        lar_mesh_clear(read);
    else
        *mesh = *read;
    return status;
}

lar_status lar_mesh_read(const char *path, double scale, lar_mesh *mesh, lar_error *error) {
    lar_mesh read = {0};
    lar_status status = read_unchecked(path, scale, &read, error);
    if (!status) lar_mesh_turn(&read);
    if (!status) status = lar_mesh_check(&read, error);
    return take(&read, status, mesh);
}

lar_status lar_mesh_read_solids(const char *path, double scale, lar_mesh *mesh, lar_error *error) {
    lar_mesh read = {0};
    lar_status status = read_unchecked(path, scale, &read, error);
    if (!status) status = lar_mesh_check_solids(&read, error);
    return take(&read, status, mesh);
}
