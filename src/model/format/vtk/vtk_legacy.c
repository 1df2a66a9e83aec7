/* The chain of keywords is walked here; what it holds is up to the reader. */
#include "model/format/vtk/vtk_legacy.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

lar_status lar_vtk_legacy_bad(const lar_vtk_legacy *file, const char *cause) {
    return lar_fail(file->error, LAR_ERROR_FORMAT,
                    "%s:%d: %s; the file is damaged or cut short, write it again", file->path,
                    file->text.line, cause);
}

bool lar_vtk_legacy_count(lar_vtk_legacy *file, int64_t *count) {
    return lar_text_int64(&file->text, count) && *count >= 0;
}

static lar_status read_type(lar_vtk_legacy *file, lar_vtk_scalar *type) {
    lar_span word;
    if (!lar_text_word(&file->text, &word))
        return lar_vtk_legacy_bad(file, "a type name is missing");
    if (lar_vtk_scalar_from_legacy(word, type)) return LAR_OK;
    int shown = word.length < 40 ? (int)word.length : 40;
    return lar_fail(file->error, LAR_ERROR_UNSUPPORTED,
                    "%s:%d: \"%.*s\" is no type of numbers that Lariat reads; write the array as "
                    "int or double",
                    file->path, file->text.line, shown, word.at);
}

/* Numbers begin on the line after their keyword; binary ones directly there. */
static bool begin_values(lar_vtk_legacy *file) {
    lar_span rest;
    return !file->binary || lar_text_line(&file->text, &rest);
}

/* Checks that `count` values can be there. */
static lar_status check_values(const lar_vtk_legacy *file, lar_vtk_scalar type, int64_t count) {
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

static lar_status missing_value(const lar_vtk_legacy *file, int64_t index, int64_t count) {
    return lar_fail(file->error, LAR_ERROR_FORMAT,
                    "%s:%d: value %" PRId64 " of %" PRId64
                    " is missing or no number of its type; the file is damaged or cut short, write "
                    "it again",
                    file->path, file->text.line, index, count);
}

/* Either *doubles or *integers is set to `count` values; the caller frees. */
static lar_status read_values(lar_vtk_legacy *file, lar_vtk_scalar type, int64_t count,
                              double **doubles, int64_t **integers) {
    if (!begin_values(file)) return lar_vtk_legacy_bad(file, "the data is missing");
    lar_status status = check_values(file, type, count);
    if (status) return status;
    if (integers && !lar_vtk_scalar_is_integer(type))
        return lar_vtk_legacy_bad(file, "floating point numbers stand where integers belong");
    size_t n = (size_t)count;
    void *values = lar_calloc(n, 8);
    if (!values) return lar_fail_memory(file->error, n * 8, file->path);
    if (file->binary) {
        const unsigned char *bytes = (const unsigned char *)file->text.at;
        bool swap = lar_vtk_must_swap(true);
        if (doubles)
            lar_vtk_to_double(type, bytes, swap, n, values);
        else if (!lar_vtk_to_int64(type, bytes, swap, n, values))
            status = lar_vtk_legacy_bad(file, "an integer is larger than 63 bits hold");
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

lar_status lar_vtk_legacy_integers(lar_vtk_legacy *file, int64_t count, int64_t **values) {
    return read_values(file, LAR_VTK_INT32, count, NULL, values);
}

/* Walks over `count` values of `bytes_each` in binary files, one word each in text. */
static lar_status skip_values(lar_vtk_legacy *file, int64_t count, size_t bytes_each) {
    if (!begin_values(file)) return lar_vtk_legacy_bad(file, "the data is missing");
    size_t left = (size_t)(file->text.end - file->text.at);
    if (file->binary) {
        if (count < 0 || !lar_claim_fits((uint64_t)count, bytes_each, left))
            return lar_vtk_legacy_bad(file, "the data ends too early");
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
static bool skip_odd_type(lar_vtk_legacy *file, lar_span type, int64_t count, lar_status *status) {
    if (lar_span_equal_nocase(type, "bit")) {
        *status = file->binary ? skip_values(file, count / 8 + (count % 8 != 0), 1)
                               : skip_values(file, count, 1);
        return true;
    }
    if (!lar_span_equal_nocase(type, "string") && !lar_span_equal_nocase(type, "utf8_string"))
        return false;
    lar_span line;
    *status = LAR_OK;
    if (!lar_text_line(&file->text, &line))
        *status = lar_vtk_legacy_bad(file, "the data is missing");
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
            *status = lar_vtk_legacy_bad(file, "the data ends too early");
        else
            file->text.at += width + length;
    }
    return true;
}

lar_status lar_vtk_legacy_begin(lar_vtk_legacy *file) {
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
        return lar_vtk_legacy_bad(file, "the file ends in its header");
    format = lar_span_trim(format);
    file->binary = lar_span_equal_nocase(format, "BINARY");
    if (!file->binary && !lar_span_equal_nocase(format, "ASCII"))
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:3: the third line must be ASCII or BINARY; write the file again",
                        file->path);
    return LAR_OK;
}

static lar_status read_points(lar_vtk_legacy *file) {
    int64_t count, values;
    lar_vtk_scalar type;
    if (file->has_points) return lar_vtk_legacy_bad(file, "POINTS stands there twice");
    if (!lar_vtk_legacy_count(file, &count) || __builtin_mul_overflow(count, 3, &values))
        return lar_vtk_legacy_bad(file, "POINTS has no count");
    lar_status status = read_type(file, &type);
    double *point = NULL;
    if (!status) status = read_values(file, type, values, &point, NULL);
    file->grid.point = (double(*)[3])point;
    file->grid.point_count = count;
    file->has_points = !status;
    return status;
}

static lar_status bad_keyword(const lar_vtk_legacy *file, const char *keyword, const char *cause) {
    return lar_fail(file->error, LAR_ERROR_FORMAT,
                    "%s:%d: %s %s; the file is damaged or cut short, write it again", file->path,
                    file->text.line, keyword, cause);
}

/* Versions to 4.2: every cell is its number of corners, then the corners. */
static lar_status read_cells_classic(lar_vtk_legacy *file, const char *keyword, int64_t size,
                                     lar_vtk_cells *cells) {
    lar_status status = read_values(file, LAR_VTK_INT32, size, NULL, &cells->corner);
    if (status) return status;
    if (cells->count > size) return bad_keyword(file, keyword, "announces more cells than numbers");
    cells->end = lar_calloc((size_t)cells->count, sizeof *cells->end);
    if (!cells->end)
        return lar_fail_memory(file->error, (size_t)cells->count * sizeof *cells->end, file->path);
    int64_t from = 0, to = 0; /* the corners move up over the numbers of corners */
    for (int64_t cell = 0; cell < cells->count; cell++) {
        int64_t corners = from < size ? cells->corner[from++] : -1;
        if (corners < 0 || corners > size - from)
            return lar_fail(file->error, LAR_ERROR_FORMAT,
                            "%s:%d: the list of %s ends inside cell %" PRId64
                            "; the file is damaged, write it again",
                            file->path, file->text.line, keyword, cell);
        memmove(cells->corner + to, cells->corner + from, (size_t)corners * sizeof *cells->corner);
        from += corners;
        to += corners;
        cells->end[cell] = to;
    }
    cells->corner_count = to;
    return LAR_OK;
}

/* "OFFSETS type" or "CONNECTIVITY type" and `count` values. */
static lar_status read_part(lar_vtk_legacy *file, const char *keyword, const char *part,
                            int64_t count, int64_t **out) {
    lar_span word;
    lar_vtk_scalar type;
    if (!lar_text_word(&file->text, &word) || !lar_span_equal_nocase(word, part))
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:%d: %s is missing behind %s; the file is damaged, write it again",
                        file->path, file->text.line, part, keyword);
    lar_status status = read_type(file, &type);
    return status ? status : read_values(file, type, count, NULL, out);
}

/* Version 5: offsets (one more than cells, from 0) and connectivity. */
static lar_status read_cells_split(lar_vtk_legacy *file, const char *keyword, int64_t offsets,
                                   int64_t size, lar_vtk_cells *cells) {
    lar_status status = read_part(file, keyword, "OFFSETS", offsets, &cells->end);
    if (!status) status = read_part(file, keyword, "CONNECTIVITY", size, &cells->corner);
    if (status) return status;
    if (offsets > 0) {
        if (cells->end[0] != 0)
            return lar_vtk_legacy_bad(file, "the first of the OFFSETS is not 0");
        memmove(cells->end, cells->end + 1, (size_t)(offsets - 1) * sizeof *cells->end);
    }
    cells->corner_count = size;
    return LAR_OK;
}

lar_status lar_vtk_legacy_cells(lar_vtk_legacy *file, const char *keyword, lar_vtk_cells *cells) {
    int64_t count, size;
    if (cells->end) return bad_keyword(file, keyword, "stands there twice");
    if (!lar_vtk_legacy_count(file, &count) || !lar_vtk_legacy_count(file, &size))
        return bad_keyword(file, keyword, "has no counts");
    lar_vtk_cells read = {.count = file->major >= 5 && count > 0 ? count - 1 : count};
    lar_status status = file->major >= 5 ? read_cells_split(file, keyword, count, size, &read)
                                         : read_cells_classic(file, keyword, size, &read);
    if (status)
        lar_vtk_cells_clear(&read);
    else
        *cells = read;
    return status;
}

/* The values of one array: kept when the name says something about the mesh. */
static lar_status read_array(lar_vtk_legacy *file, lar_span name, lar_vtk_scalar type,
                             int64_t width, int64_t tuples) {
    int64_t count;
    if (__builtin_mul_overflow(width, tuples, &count))
        return lar_vtk_legacy_bad(file, "an array announces an impossible size");
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
static void skip_metadata(lar_vtk_legacy *file) {
    lar_span line;
    bool more = lar_text_line(&file->text, &line); /* the rest of METADATA's own line */
    while (more && lar_text_line(&file->text, &line)) more = lar_span_trim(line).length > 0;
}

/* FIELD name n, then n times: name components tuples type, values. */
static lar_status read_field(lar_vtk_legacy *file) {
    lar_span name, type_name;
    int64_t arrays;
    if (!lar_text_word(&file->text, &name) || !lar_vtk_legacy_count(file, &arrays))
        return lar_vtk_legacy_bad(file, "FIELD has no name and count");
    lar_status status = LAR_OK;
    for (int64_t i = 0; i < arrays && !status; i++) {
        int64_t width, tuples, count;
        if (!lar_text_word(&file->text, &name))
            return lar_vtk_legacy_bad(file, "an array of FIELD is missing");
        if (lar_span_equal(name, "METADATA")) {
            skip_metadata(file);
            i--;
            continue;
        }
        if (!lar_vtk_legacy_count(file, &width) || !lar_vtk_legacy_count(file, &tuples) ||
            __builtin_mul_overflow(width, tuples, &count))
            return lar_vtk_legacy_bad(file, "an array of FIELD has no counts");
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
static lar_status read_scalars(lar_vtk_legacy *file) {
    lar_span name, rest, word;
    if (!lar_text_word(&file->text, &name)) return lar_vtk_legacy_bad(file, "SCALARS has no name");
    lar_vtk_scalar type;
    lar_status status = read_type(file, &type);
    if (status) return status;
    int64_t width = 1;
    if (!lar_text_line(&file->text, &rest)) return lar_vtk_legacy_bad(file, "the data is missing");
    rest = lar_span_trim(rest);
    if (rest.length > 0 && (!lar_span_int64(rest, &width) || width < 1 || width > 4))
        return lar_vtk_legacy_bad(file, "SCALARS must have 1 to 4 components");
    if (!lar_text_word(&file->text, &word) || !lar_span_equal_nocase(word, "LOOKUP_TABLE") ||
        !lar_text_word(&file->text, &word))
        return lar_vtk_legacy_bad(file, "LOOKUP_TABLE is missing behind SCALARS");
    return read_array(file, name, type, width, file->tuples);
}

/* Data of no interest: what stands behind the keyword and how many values there are. */
static lar_status skip_attribute(lar_vtk_legacy *file, lar_span keyword, bool *known) {
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
        if (!lar_text_word(&file->text, &name))
            return lar_vtk_legacy_bad(file, "an array has no name");
        if ((width == 0 && !lar_vtk_legacy_count(file, &width)) ||
            (kinds[i].sized && !lar_vtk_legacy_count(file, &tuples)) ||
            __builtin_mul_overflow(width, tuples, &count))
            return lar_vtk_legacy_bad(file, "an array has no counts");
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

static lar_status begin_data(lar_vtk_legacy *file, lar_vtk_place place) {
    if (!lar_vtk_legacy_count(file, &file->tuples))
        return lar_vtk_legacy_bad(file, "the data section has no count");
    file->in_data = true;
    file->place = place;
    return LAR_OK;
}

lar_status lar_vtk_legacy_section(lar_vtk_legacy *file, lar_span keyword) {
    if (lar_span_equal_nocase(keyword, "POINTS")) return read_points(file);
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
