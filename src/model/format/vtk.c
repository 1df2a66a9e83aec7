/* Reader for legacy VTK files (.vtk), versions 2.0 to 5.1, ASCII and BINARY (big-endian).
 *
 *     # vtk DataFile Version 4.2          POINTS n type          values
 *     title                               CELLS n size           [8 a b c d e f g h] ... (to 4.2)
 *     ASCII | BINARY                      CELLS n+1 size         OFFSETS type, CONNECTIVITY type
 * (5) DATASET UNSTRUCTURED_GRID           CELL_TYPES n           types CELL_DATA n, POINT_DATA n,
 * FIELD, SCALARS, ...
 *
 * The file is a chain of keywords, each followed by numbers whose amount the keyword's line says.
 * Data that is of no interest must still be walked over exactly. What the numbers mean is decided
 * in vtk_grid.c. */
#include "model/format/mesh_io.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "model/format/vtk_grid.h"
#include "model/format/vtk_scalar.h"

typedef struct vtk_file {
    const char *path;
    lar_error *error;
    lar_text text;
    bool binary;
    int64_t major; /* version */
    bool has_points, has_cells, has_types;
    int64_t type_count;
    bool in_data; /* behind CELL_DATA or POINT_DATA */
    lar_vtk_place place;
    int64_t tuples;
    lar_vtk_grid grid;
} vtk_file;

static lar_status bad_file(const vtk_file *file, const char *cause) {
    return lar_fail(file->error, LAR_ERROR_FORMAT,
                    "%s:%d: %s; the file is damaged or cut short, write it again", file->path,
                    file->text.line, cause);
}

static bool read_count(vtk_file *file, int64_t *count) {
    return lar_text_int64(&file->text, count) && *count >= 0;
}

static lar_status read_type(vtk_file *file, lar_vtk_scalar *type) {
    lar_span word;
    if (!lar_text_word(&file->text, &word)) return bad_file(file, "a type name is missing");
    if (lar_vtk_scalar_from_legacy(word, type)) return LAR_OK;
    int shown = word.length < 40 ? (int)word.length : 40;
    return lar_fail(file->error, LAR_ERROR_UNSUPPORTED,
                    "%s:%d: \"%.*s\" is no type of numbers that Lariat reads; write the array as "
                    "int or double",
                    file->path, file->text.line, shown, word.at);
}

/* Numbers begin on the line after their keyword; binary ones directly there. */
static bool begin_values(vtk_file *file) {
    lar_span rest;
    return !file->binary || lar_text_line(&file->text, &rest);
}

/* Checks that `count` values can be there. */
static lar_status check_values(const vtk_file *file, lar_vtk_scalar type, int64_t count) {
    size_t left = (size_t)(file->text.end - file->text.at);
    bool fits = count >= 0 &&
                (file->binary ? lar_claim_fits((uint64_t)count, lar_vtk_scalar_size(type), left)
                              : (uint64_t)count <= (left + 1) / 2);
    if (fits) return LAR_OK;
    return lar_fail(file->error, LAR_ERROR_FORMAT,
                    "%s:%d: %" PRId64 " values are announced, but only %zu bytes follow; the file "
                    "is damaged or cut short, write it again",
                    file->path, file->text.line, count, left);
}

static lar_status missing_value(const vtk_file *file, int64_t index, int64_t count) {
    return lar_fail(file->error, LAR_ERROR_FORMAT,
                    "%s:%d: value %" PRId64 " of %" PRId64
                    " is missing or no number of its type; the file is damaged or cut short, write "
                    "it again",
                    file->path, file->text.line, index, count);
}

/* Either *doubles or *integers is set to `count` values; the caller frees. */
static lar_status read_values(vtk_file *file, lar_vtk_scalar type, int64_t count, double **doubles,
                              int64_t **integers) {
    if (!begin_values(file)) return bad_file(file, "the data is missing");
    lar_status status = check_values(file, type, count);
    if (status) return status;
    if (integers && !lar_vtk_scalar_is_integer(type))
        return bad_file(file, "floating point numbers stand where integers belong");
    size_t n = (size_t)count;
    void *values = lar_calloc(n, 8);
    if (!values) return lar_fail_memory(file->error, n * 8, file->path);
    if (file->binary) {
        const unsigned char *bytes = (const unsigned char *)file->text.at;
        bool swap = lar_vtk_must_swap(true);
        if (doubles)
            lar_vtk_to_double(type, bytes, swap, n, values);
        else if (!lar_vtk_to_int64(type, bytes, swap, n, values))
            status = bad_file(file, "an integer is larger than 63 bits hold");
        file->text.at += n * lar_vtk_scalar_size(type);
    } else {
        for (int64_t i = 0; i < count && !status; i++)
            if (doubles ? !lar_text_double(&file->text, (double *)values + i)
                        : !lar_text_int64(&file->text, (int64_t *)values + i))
                status = missing_value(file, i, count);
    }
    if (status) {
        free(values);
        return status;
    }
    if (doubles)
        *doubles = values;
    else
        *integers = values;
    return LAR_OK;
}

/* Walks over `count` values of `bytes_each` in binary files, one word each in text. */
static lar_status skip_values(vtk_file *file, int64_t count, size_t bytes_each) {
    if (!begin_values(file)) return bad_file(file, "the data is missing");
    size_t left = (size_t)(file->text.end - file->text.at);
    if (file->binary) {
        if (count < 0 || !lar_claim_fits((uint64_t)count, bytes_each, left))
            return bad_file(file, "the data ends too early");
        file->text.at += (size_t)count * bytes_each;
        return LAR_OK;
    }
    lar_span word;
    for (int64_t i = 0; i < count; i++)
        if (!lar_text_word(&file->text, &word)) return missing_value(file, i, count);
    return LAR_OK;
}

/* bits: eight to a byte; strings: a line each in text, behind their length in binary. Returns
 * false for other types. */
static bool skip_odd_type(vtk_file *file, lar_span type, int64_t count, lar_status *status) {
    if (lar_span_equal_nocase(type, "bit")) {
        *status = file->binary ? skip_values(file, count / 8 + (count % 8 != 0), 1)
                               : skip_values(file, count, 1);
        return true;
    }
    if (!lar_span_equal_nocase(type, "string") && !lar_span_equal_nocase(type, "utf8_string"))
        return false;
    lar_span line;
    *status = LAR_OK;
    if (!lar_text_line(&file->text, &line)) *status = bad_file(file, "the data is missing");
    for (int64_t i = 0; i < count && !*status; i++) {
        if (!file->binary) {
            if (!lar_text_line(&file->text, &line)) *status = missing_value(file, i, count);
            continue;
        }
        /* The two high bits of the first byte say how many bytes the length takes: 8 to 1. */
        size_t left = (size_t)(file->text.end - file->text.at), length = 0;
        const unsigned char *at = (const unsigned char *)file->text.at;
        size_t width = left > 0 ? (size_t)8 >> (at[0] >> 6) : 1;
        if (left >= width) length = at[0] & 0x3f;
        for (size_t k = 1; k < width && left >= width; k++) length = length << 8 | at[k];
        if (left < width || length > left - width)
            *status = bad_file(file, "the data ends too early");
        else
            file->text.at += width + length;
    }
    return true;
}

static lar_status read_header(vtk_file *file) {
    static const char magic[] = "# vtk DataFile Version ";
    lar_span first, title, format;
    size_t length = sizeof magic - 1;
    if (!lar_text_line(&file->text, &first) || first.length < length ||
        memcmp(first.at, magic, length) != 0)
        return lar_fail(
            file->error, LAR_ERROR_FORMAT,
            "%s: does not begin with \"# vtk DataFile Version\", so it is no legacy VTK "
            "file; check the file or its extension",
            file->path);
    lar_span version = lar_span_trim((lar_span){first.at + length, first.length - length});
    lar_span major, minor;
    lar_span_split(version, '.', &major, &minor);
    if (!lar_span_int64(major, &file->major) || file->major < 1 || file->major > 5)
        return lar_fail(file->error, LAR_ERROR_UNSUPPORTED,
                        "%s:1: version %.*s of the legacy format is not among 2.0 to 5.1; save the "
                        "file as .vtu",
                        file->path, version.length < 20 ? (int)version.length : 20, version.at);
    if (!lar_text_line(&file->text, &title) || !lar_text_line(&file->text, &format))
        return bad_file(file, "the file ends in its header");
    format = lar_span_trim(format);
    file->binary = lar_span_equal_nocase(format, "BINARY");
    if (!file->binary && !lar_span_equal_nocase(format, "ASCII"))
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:3: the third line must be ASCII or BINARY; write the file again",
                        file->path);
    return LAR_OK;
}

static lar_status read_dataset(vtk_file *file) {
    lar_span kind;
    if (!lar_text_word(&file->text, &kind)) return bad_file(file, "DATASET names no type");
    if (lar_span_equal_nocase(kind, "UNSTRUCTURED_GRID")) return LAR_OK;
    return lar_fail(file->error, LAR_ERROR_UNSUPPORTED,
                    "%s:%d: DATASET %.*s is no mesh of hexahedra that Lariat reads; save it as an "
                    "unstructured grid (ParaView: Append Datasets, then save as .vtu)",
                    file->path, file->text.line, kind.length < 40 ? (int)kind.length : 40, kind.at);
}

static lar_status read_points(vtk_file *file) {
    int64_t count, values;
    lar_vtk_scalar type;
    if (file->has_points) return bad_file(file, "POINTS stands there twice");
    if (!read_count(file, &count) || __builtin_mul_overflow(count, 3, &values))
        return bad_file(file, "POINTS has no count");
    lar_status status = read_type(file, &type);
    double *point = NULL;
    if (!status) status = read_values(file, type, values, &point, NULL);
    file->grid.point = (double(*)[3])point;
    file->grid.point_count = count;
    file->has_points = !status;
    return status;
}

/* Versions to 4.2: every cell is its number of corners, then the corners. */
static lar_status read_cells_classic(vtk_file *file, int64_t cells, int64_t size) {
    lar_vtk_grid *grid = &file->grid;
    lar_status status = read_values(file, LAR_VTK_INT32, size, NULL, &grid->corner);
    if (status) return status;
    if (cells > size) return bad_file(file, "CELLS announces more cells than numbers");
    grid->cell_end = lar_calloc((size_t)cells, sizeof *grid->cell_end);
    if (!grid->cell_end)
        return lar_fail_memory(file->error, (size_t)cells * sizeof *grid->cell_end, file->path);
    int64_t from = 0, to = 0; /* the corners move up over the numbers of corners */
    for (int64_t cell = 0; cell < cells; cell++) {
        int64_t corners = from < size ? grid->corner[from++] : -1;
        if (corners < 0 || corners > size - from)
            return lar_fail(file->error, LAR_ERROR_FORMAT,
                            "%s:%d: the list of CELLS ends inside cell %" PRId64
                            "; the file is damaged, write it again",
                            file->path, file->text.line, cell);
        memmove(grid->corner + to, grid->corner + from, (size_t)corners * sizeof *grid->corner);
        from += corners;
        to += corners;
        grid->cell_end[cell] = to;
    }
    grid->corner_count = to;
    return LAR_OK;
}

/* "OFFSETS type" or "CONNECTIVITY type" and `count` values. */
static lar_status read_part(vtk_file *file, const char *keyword, int64_t count, int64_t **out) {
    lar_span word;
    lar_vtk_scalar type;
    if (!lar_text_word(&file->text, &word) || !lar_span_equal_nocase(word, keyword))
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:%d: %s is missing behind CELLS; the file is damaged, write it again",
                        file->path, file->text.line, keyword);
    lar_status status = read_type(file, &type);
    return status ? status : read_values(file, type, count, NULL, out);
}

/* Version 5: offsets (one more than cells, from 0) and connectivity. */
static lar_status read_cells_split(vtk_file *file, int64_t offsets, int64_t size) {
    lar_vtk_grid *grid = &file->grid;
    lar_status status = read_part(file, "OFFSETS", offsets, &grid->cell_end);
    if (!status) status = read_part(file, "CONNECTIVITY", size, &grid->corner);
    if (status) return status;
    if (offsets > 0) {
        if (grid->cell_end[0] != 0) return bad_file(file, "the first of the OFFSETS is not 0");
        memmove(grid->cell_end, grid->cell_end + 1, (size_t)(offsets - 1) * sizeof *grid->cell_end);
    }
    grid->corner_count = size;
    return LAR_OK;
}

static lar_status read_cells(vtk_file *file) {
    int64_t count, size;
    if (file->has_cells) return bad_file(file, "CELLS stands there twice");
    if (!read_count(file, &count) || !read_count(file, &size))
        return bad_file(file, "CELLS has no counts");
    lar_status status = file->major >= 5 ? read_cells_split(file, count, size)
                                         : read_cells_classic(file, count, size);
    file->grid.cell_count = file->major >= 5 && count > 0 ? count - 1 : count;
    file->has_cells = !status;
    return status;
}

static lar_status read_cell_types(vtk_file *file) {
    if (file->has_types) return bad_file(file, "CELL_TYPES stands there twice");
    if (!read_count(file, &file->type_count)) return bad_file(file, "CELL_TYPES has no count");
    file->has_types = true;
    return read_values(file, LAR_VTK_INT32, file->type_count, NULL, &file->grid.cell_type);
}

/* The values of one array: kept when the name says something about the mesh. */
static lar_status read_array(vtk_file *file, lar_span name, lar_vtk_scalar type, int64_t width,
                             int64_t tuples) {
    int64_t count;
    if (__builtin_mul_overflow(width, tuples, &count))
        return bad_file(file, "an array announces an impossible size");
    char *decoded = lar_vtk_decode_name(name.at, name.length);
    if (!decoded) return lar_fail_memory(file->error, name.length, "a name");
    lar_vtk_place place = file->in_data ? file->place : LAR_VTK_FIELD_DATA;
    lar_status status;
    if (width == 1 && lar_vtk_scalar_is_integer(type) && lar_vtk_wants(place, decoded)) {
        int64_t *values = NULL;
        status = read_values(file, type, count, NULL, &values);
        if (!status)
            status = lar_vtk_grid_add(&file->grid, place, decoded, values, count, file->error);
    } else {
        status = skip_values(file, count, lar_vtk_scalar_size(type));
    }
    free(decoded);
    return status;
}

/* METADATA and what follows, up to an empty line. */
static void skip_metadata(vtk_file *file) {
    lar_span line;
    bool more = lar_text_line(&file->text, &line); /* the rest of METADATA's own line */
    while (more && lar_text_line(&file->text, &line)) more = lar_span_trim(line).length > 0;
}

/* FIELD name n, then n times: name components tuples type, values. */
static lar_status read_field(vtk_file *file) {
    lar_span name, type_name;
    int64_t arrays;
    if (!lar_text_word(&file->text, &name) || !read_count(file, &arrays))
        return bad_file(file, "FIELD has no name and count");
    lar_status status = LAR_OK;
    for (int64_t i = 0; i < arrays && !status; i++) {
        int64_t width, tuples, count;
        if (!lar_text_word(&file->text, &name))
            return bad_file(file, "an array of FIELD is missing");
        if (lar_span_equal(name, "METADATA")) {
            skip_metadata(file);
            i--;
            continue;
        }
        if (!read_count(file, &width) || !read_count(file, &tuples) ||
            __builtin_mul_overflow(width, tuples, &count))
            return bad_file(file, "an array of FIELD has no counts");
        lar_text before = file->text;
        if (lar_text_word(&file->text, &type_name) &&
            skip_odd_type(file, type_name, count, &status))
            continue;
        file->text = before;
        lar_vtk_scalar type;
        status = read_type(file, &type);
        if (!status) status = read_array(file, name, type, width, tuples);
    }
    return status;
}

/* SCALARS name type [components], LOOKUP_TABLE name, values. */
static lar_status read_scalars(vtk_file *file) {
    lar_span name, rest, word;
    if (!lar_text_word(&file->text, &name)) return bad_file(file, "SCALARS has no name");
    lar_vtk_scalar type;
    lar_status status = read_type(file, &type);
    if (status) return status;
    int64_t width = 1;
    if (!lar_text_line(&file->text, &rest)) return bad_file(file, "the data is missing");
    rest = lar_span_trim(rest);
    if (rest.length > 0 && (!lar_span_int64(rest, &width) || width < 1 || width > 4))
        return bad_file(file, "SCALARS must have 1 to 4 components");
    if (!lar_text_word(&file->text, &word) || !lar_span_equal_nocase(word, "LOOKUP_TABLE") ||
        !lar_text_word(&file->text, &word))
        return bad_file(file, "LOOKUP_TABLE is missing behind SCALARS");
    return read_array(file, name, type, width, file->tuples);
}

/* Data of no interest: what stands behind the keyword and how many values there are. */
static lar_status skip_attribute(vtk_file *file, lar_span keyword, bool *known) {
    static const struct {
        const char *keyword;
        int width;  /* components; 0: a word behind the name says it */
        bool typed; /* a type name stands behind */
        bool sized; /* the word behind the name is the number of tuples */
    } kinds[] = {
        {"VECTORS", 3, true, false},        {"NORMALS", 3, true, false},
        {"TENSORS", 9, true, false},        {"TENSORS6", 6, true, false},
        {"GLOBAL_IDS", 1, true, false},     {"PEDIGREE_IDS", 1, true, false},
        {"EDGE_FLAGS", 1, true, false},     {"TEXTURE_COORDINATES", 0, true, false},
        {"COLOR_SCALARS", 0, false, false}, {"LOOKUP_TABLE", 4, false, true},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (!lar_span_equal_nocase(keyword, kinds[i].keyword)) continue;
        *known = true;
        lar_span name, type_name;
        int64_t width = kinds[i].width, tuples = file->tuples, count;
        if (!lar_text_word(&file->text, &name)) return bad_file(file, "an array has no name");
        if ((width == 0 && !read_count(file, &width)) ||
            (kinds[i].sized && !read_count(file, &tuples)) ||
            __builtin_mul_overflow(width, tuples, &count))
            return bad_file(file, "an array has no counts");
        if (!kinds[i].typed) return skip_values(file, count, 1);
        lar_text before = file->text;
        lar_status status = LAR_OK;
        if (lar_text_word(&file->text, &type_name) &&
            skip_odd_type(file, type_name, count, &status))
            return status;
        file->text = before;
        lar_vtk_scalar type;
        status = read_type(file, &type);
        return status ? status : skip_values(file, count, lar_vtk_scalar_size(type));
    }
    *known = false;
    return LAR_OK;
}

static lar_status begin_data(vtk_file *file, lar_vtk_place place) {
    if (!read_count(file, &file->tuples)) return bad_file(file, "the data section has no count");
    file->in_data = true;
    file->place = place;
    return LAR_OK;
}

static lar_status read_section(vtk_file *file, lar_span keyword) {
    if (lar_span_equal_nocase(keyword, "DATASET")) return read_dataset(file);
    if (lar_span_equal_nocase(keyword, "POINTS")) return read_points(file);
    if (lar_span_equal_nocase(keyword, "CELLS")) return read_cells(file);
    if (lar_span_equal_nocase(keyword, "CELL_TYPES")) return read_cell_types(file);
    if (lar_span_equal_nocase(keyword, "POINT_DATA")) return begin_data(file, LAR_VTK_POINT_DATA);
    if (lar_span_equal_nocase(keyword, "CELL_DATA")) return begin_data(file, LAR_VTK_CELL_DATA);
    if (lar_span_equal_nocase(keyword, "FIELD")) return read_field(file);
    if (lar_span_equal_nocase(keyword, "SCALARS")) return read_scalars(file);
    if (lar_span_equal_nocase(keyword, "METADATA")) {
        skip_metadata(file);
        return LAR_OK;
    }
    bool known;
    lar_status status = skip_attribute(file, keyword, &known);
    if (known) return status;
    return lar_fail(
        file->error, LAR_ERROR_FORMAT,
        "%s:%d: a keyword of the legacy VTK format was expected, not \"%.*s\"; the file "
        "is damaged, write it again",
        file->path, file->text.line, keyword.length < 40 ? (int)keyword.length : 40, keyword.at);
}

static lar_status check_complete(const vtk_file *file) {
    const char *missing = !file->has_points  ? "POINTS"
                          : !file->has_cells ? "CELLS"
                          : !file->has_types ? "CELL_TYPES"
                                             : NULL;
    if (missing)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s: the section %s is missing; the file is cut short, write it again",
                        file->path, missing);
    if (file->type_count != file->grid.cell_count)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s: there are %" PRId64 " CELLS but %" PRId64
                        " CELL_TYPES; write the file again",
                        file->path, file->grid.cell_count, file->type_count);
    return LAR_OK;
}

lar_status lar_vtk_parse(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                         lar_error *error) {
    vtk_file file = {.path = path, .error = error, .text = lar_text_from(bytes)};
    lar_status status = read_header(&file);
    lar_span keyword;
    while (!status && lar_text_word(&file.text, &keyword)) status = read_section(&file, keyword);
    if (!status) status = check_complete(&file);
    if (!status) status = lar_vtk_grid_to_mesh(path, &file.grid, mesh, error);
    lar_vtk_grid_clear(&file.grid);
    return status;
}
