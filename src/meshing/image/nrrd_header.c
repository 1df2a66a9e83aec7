#include <stdlib.h>
#include <string.h>

#include "meshing/image/nrrd.h"

static const struct {
    const char *name;
    lar_nrrd_field field;
} FIELDS[] = {{"type", LAR_NRRD_TYPE},
              {"dimension", LAR_NRRD_DIMENSION},
              {"sizes", LAR_NRRD_SIZES},
              {"encoding", LAR_NRRD_ENCODING},
              {"endian", LAR_NRRD_ENDIAN},
              {"space", LAR_NRRD_SPACE},
              {"space dimension", LAR_NRRD_SPACE_DIMENSION},
              {"space directions", LAR_NRRD_SPACE_DIRECTIONS},
              {"space origin", LAR_NRRD_SPACE_ORIGIN},
              {"space units", LAR_NRRD_SPACE_UNITS},
              {"spacings", LAR_NRRD_SPACINGS},
              {"units", LAR_NRRD_UNITS},
              {"kinds", LAR_NRRD_KINDS},
              {"data file", LAR_NRRD_DATA_FILE},
              {"datafile", LAR_NRRD_DATA_FILE},
              {"line skip", LAR_NRRD_LINE_SKIP},
              {"lineskip", LAR_NRRD_LINE_SKIP},
              {"byte skip", LAR_NRRD_BYTE_SKIP},
              {"byteskip", LAR_NRRD_BYTE_SKIP},
              {"content", LAR_NRRD_IGNORED},
              {"number", LAR_NRRD_IGNORED},
              {"block size", LAR_NRRD_IGNORED},
              {"blocksize", LAR_NRRD_IGNORED},
              {"min", LAR_NRRD_IGNORED},
              {"max", LAR_NRRD_IGNORED},
              {"old min", LAR_NRRD_IGNORED},
              {"oldmin", LAR_NRRD_IGNORED},
              {"old max", LAR_NRRD_IGNORED},
              {"oldmax", LAR_NRRD_IGNORED},
              {"sample units", LAR_NRRD_IGNORED},
              {"sampleunits", LAR_NRRD_IGNORED},
              {"labels", LAR_NRRD_IGNORED},
              {"centers", LAR_NRRD_CENTERS},
              {"centerings", LAR_NRRD_CENTERS},
              {"thicknesses", LAR_NRRD_IGNORED},
              {"axis mins", LAR_NRRD_AXIS_MINS},
              {"axismins", LAR_NRRD_AXIS_MINS},
              {"axis maxs", LAR_NRRD_IGNORED},
              {"axismaxs", LAR_NRRD_IGNORED},
              {"measurement frame", LAR_NRRD_IGNORED}};
enum { FIELD_NAMES = sizeof FIELDS / sizeof FIELDS[0] };

static const char *name_of(lar_nrrd_field field) {
    for (int f = 0; f < FIELD_NAMES; f++)
        if (FIELDS[f].field == field) return FIELDS[f].name;
    return "";
}

/* What a message quotes of a span. */
static int quoted(lar_span span) {
    return span.length > 60 ? 60 : (int)span.length;
}

lar_status lar_nrrd_bad(const lar_nrrd_header *header, lar_nrrd_field field, const char *cause,
                        lar_error *error) {
    const lar_nrrd_value *value = &header->field[field];
    return lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: %s \"%.*s\" %s", header->path, value->line,
                    name_of(field), quoted(value->text), value->text.at, cause);
}

lar_status lar_nrrd_missing(const lar_nrrd_header *header, lar_nrrd_field field, lar_error *error) {
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: the header lacks the field \"%s\"; write the image again", header->path,
                    name_of(field));
}

lar_status lar_nrrd_whole(const lar_nrrd_header *header, lar_nrrd_field field, int64_t missing,
                          int64_t *value, lar_error *error) {
    const lar_nrrd_value *given = &header->field[field];
    *value = missing;
    if (!given->text.at || lar_span_int64(given->text, value)) return LAR_OK;
    return lar_nrrd_bad(header, field, "is no whole number; correct it", error);
}

/* ---- lines ---------------------------------------------------------------------------------- */

/* "Segment12_Name" or "Segment12_LabelValue"; all other keys are passed over. */
static lar_status keep_segment(lar_nrrd_header *header, lar_span key, lar_nrrd_value value,
                               lar_error *error) {
    enum { PREFIX = 7 };
    lar_span number, what;
    if (key.length < PREFIX || memcmp(key.at, "Segment", PREFIX) != 0) return LAR_OK;
    if (!lar_span_split((lar_span){key.at + PREFIX, key.length - PREFIX}, '_', &number, &what))
        return LAR_OK;
    lar_nrrd_segment segment = {.is_name = lar_span_equal(what, "Name"), .value = value};
    if (!segment.is_name && !lar_span_equal(what, "LabelValue")) return LAR_OK;
    if (!lar_span_int64(number, &segment.number)) return LAR_OK;
    if (!LAR_GROW(header->segment, header->segment_capacity, header->segment_count))
        return lar_fail_memory(error, header->segment_count * sizeof segment, header->path);
    header->segment[header->segment_count++] = segment;
    return LAR_OK;
}

static lar_status keep_field(lar_nrrd_header *header, lar_span name, lar_nrrd_value value,
                             lar_error *error) {
    int f = 0;
    while (f < FIELD_NAMES && !lar_span_equal_nocase(name, FIELDS[f].name)) f++;
    if (f == FIELD_NAMES)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s:%d: \"%.*s\" is no field of NRRD; correct or delete the line",
                        header->path, value.line, quoted(name), name.at);
    lar_nrrd_field field = FIELDS[f].field;
    if (field == LAR_NRRD_IGNORED) return LAR_OK;
    if (header->field[field].text.at)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s:%d: the field \"%s\" is there already, in line %d; delete one",
                        header->path, value.line, FIELDS[f].name, header->field[field].line);
    if (value.text.length == 0)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s:%d: the field \"%s\" is empty; write its value", header->path,
                        value.line, FIELDS[f].name);
    header->field[field] = value;
    if (field == LAR_NRRD_DATA_FILE &&
        ((value.text.length >= 4 && memcmp(value.text.at, "LIST", 4) == 0) ||
         memchr(value.text.at, '%', value.text.length)))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: data in several files (\"%.*s\") are not read; write the image as "
                        "one .nrrd",
                        header->path, value.line, quoted(value.text), value.text.at);
    return LAR_OK;
}

/* "field: value" or "key:=value", whichever sign comes first. */
static lar_status keep_line(lar_nrrd_header *header, lar_span line, int number, lar_error *error) {
    for (size_t c = 0; c + 1 < line.length; c++) {
        if (line.at[c] != ':' || (line.at[c + 1] != '=' && line.at[c + 1] != ' ')) continue;
        lar_span name = {line.at, c};
        lar_span text = lar_span_trim((lar_span){line.at + c + 2, line.length - c - 2});
        lar_nrrd_value value = {text, number};
        return line.at[c + 1] == '=' ? keep_segment(header, name, value, error)
                                     : keep_field(header, lar_span_trim(name), value, error);
    }
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s:%d: \"%.*s\" is neither \"field: value\" nor \"key:=value\"; an empty line "
                    "must end the header",
                    header->path, number, quoted(line), line.at);
}

lar_status lar_nrrd_read_header(const char *path, const lar_bytes *bytes, lar_nrrd_header *header,
                                lar_error *error) {
    *header = (lar_nrrd_header){.path = path};
    lar_text text = lar_text_from(bytes);
    lar_span line;
    if (!lar_text_line(&text, &line) || line.length != 8 || memcmp(line.at, "NRRD000", 7) != 0)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the file does not begin with \"NRRD0001\" to \"NRRD0005\"; write the "
                        "image as .nrrd, .nii or .nii.gz",
                        path);
    if (line.at[7] < '1' || line.at[7] > '5')
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: version %c of NRRD is not read; write the image in version 5 or older",
                        path, line.at[7] >= '0' && line.at[7] <= '9' ? line.at[7] : '?');
    lar_status status = LAR_OK;
    for (int number = text.line; !status && lar_text_line(&text, &line); number = text.line) {
        if (line.length == 0) {
            header->has_data = true;
            break;
        }
        if (line.at[0] != '#') status = keep_line(header, line, number, error);
    }
    header->rest = text;
    return status;
}

void lar_nrrd_clear_header(lar_nrrd_header *header) {
    free(header->segment);
    *header = (lar_nrrd_header){0};
}
