#include "meshing/image/nrrd.h"

#include <stdlib.h>
#include <string.h>

static lar_voxel_type type_of(lar_span name) {
    static const struct {
        const char *name;
        lar_voxel_type type;
    } TYPES[] = {{"signed char", LAR_VOXEL_I8},
                 {"int8", LAR_VOXEL_I8},
                 {"int8_t", LAR_VOXEL_I8},
                 {"uchar", LAR_VOXEL_U8},
                 {"unsigned char", LAR_VOXEL_U8},
                 {"uint8", LAR_VOXEL_U8},
                 {"uint8_t", LAR_VOXEL_U8},
                 {"short", LAR_VOXEL_I16},
                 {"short int", LAR_VOXEL_I16},
                 {"signed short", LAR_VOXEL_I16},
                 {"signed short int", LAR_VOXEL_I16},
                 {"int16", LAR_VOXEL_I16},
                 {"int16_t", LAR_VOXEL_I16},
                 {"ushort", LAR_VOXEL_U16},
                 {"unsigned short", LAR_VOXEL_U16},
                 {"unsigned short int", LAR_VOXEL_U16},
                 {"uint16", LAR_VOXEL_U16},
                 {"uint16_t", LAR_VOXEL_U16},
                 {"int", LAR_VOXEL_I32},
                 {"signed int", LAR_VOXEL_I32},
                 {"int32", LAR_VOXEL_I32},
                 {"int32_t", LAR_VOXEL_I32},
                 {"uint", LAR_VOXEL_U32},
                 {"unsigned int", LAR_VOXEL_U32},
                 {"uint32", LAR_VOXEL_U32},
                 {"uint32_t", LAR_VOXEL_U32},
                 {"longlong", LAR_VOXEL_I64},
                 {"long long", LAR_VOXEL_I64},
                 {"long long int", LAR_VOXEL_I64},
                 {"signed long long", LAR_VOXEL_I64},
                 {"signed long long int", LAR_VOXEL_I64},
                 {"int64", LAR_VOXEL_I64},
                 {"int64_t", LAR_VOXEL_I64},
                 {"ulonglong", LAR_VOXEL_U64},
                 {"unsigned long long", LAR_VOXEL_U64},
                 {"unsigned long long int", LAR_VOXEL_U64},
                 {"uint64", LAR_VOXEL_U64},
                 {"uint64_t", LAR_VOXEL_U64},
                 {"float", LAR_VOXEL_F32},
                 {"double", LAR_VOXEL_F64}};
    for (size_t t = 0; t < sizeof TYPES / sizeof TYPES[0]; t++)
        if (lar_span_equal_nocase(name, TYPES[t].name)) return TYPES[t].type;
    return LAR_VOXEL_NONE;
}

typedef enum nrrd_encoding { RAW, GZIP, ASCII } nrrd_encoding;

static lar_status read_encoding(const lar_nrrd_header *header, nrrd_encoding *encoding,
                                lar_error *error) {
    static const struct {
        const char *name;
        nrrd_encoding encoding;
    } ENCODINGS[] = {{"raw", RAW},     {"gzip", GZIP},  {"gz", GZIP},
                     {"ascii", ASCII}, {"text", ASCII}, {"txt", ASCII}};
    lar_span name = header->field[LAR_NRRD_ENCODING].text;
    if (!name.at) return lar_nrrd_missing(header, LAR_NRRD_ENCODING, error);
    for (size_t e = 0; e < sizeof ENCODINGS / sizeof ENCODINGS[0]; e++)
        if (lar_span_equal_nocase(name, ENCODINGS[e].name)) {
            *encoding = ENCODINGS[e].encoding;
            return LAR_OK;
        }
    return lar_nrrd_bad(header, LAR_NRRD_ENCODING,
                        "is not read; write the image with encoding gzip or raw", error);
}

/* Whether the file's bytes stand the other way round than the machine's. */
static lar_status read_endian(const lar_nrrd_header *header, bool *swap, lar_error *error) {
    lar_span order = header->field[LAR_NRRD_ENDIAN].text;
    if (!order.at) return lar_nrrd_missing(header, LAR_NRRD_ENDIAN, error);
    bool little = lar_span_equal_nocase(order, "little");
    if (!little && !lar_span_equal_nocase(order, "big"))
        return lar_nrrd_bad(header, LAR_NRRD_ENDIAN, "is neither little nor big; correct it",
                            error);
    *swap = little != (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
    return LAR_OK;
}

/* ---- where the data are --------------------------------------------------------------------- */

/* The bytes after the header, or those of the data file, which the caller frees. */
static lar_status find_data(const lar_nrrd_header *header, lar_bytes *file, lar_span *data,
                            lar_error *error) {
    const lar_nrrd_value *name = &header->field[LAR_NRRD_DATA_FILE];
    if (!name->text.at) {
        if (!header->has_data)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: no empty line ends the header, and it names no data file; the "
                            "file is cut short, copy or write it again",
                            header->path);
        *data = (lar_span){header->rest.at, (size_t)(header->rest.end - header->rest.at)};
        return LAR_OK;
    }
    char *relative = lar_strndup(name->text.at, name->text.length);
    char *path = relative ? lar_path_beside(header->path, relative) : NULL;
    free(relative);
    if (!path) return lar_fail_memory(error, name->text.length, header->path);
    lar_status status = lar_bytes_read(path, file, error);
    free(path);
    if (!status) *data = (lar_span){(const char *)file->data, file->size};
    return status;
}

/* Lines are skipped before the data are decompressed. */
static lar_status skip_lines(const lar_nrrd_header *header, lar_span *data, lar_error *error) {
    int64_t lines = 0;
    lar_status status = lar_nrrd_whole(header, LAR_NRRD_LINE_SKIP, 0, &lines, error);
    if (status) return status;
    if (lines < 0) return lar_nrrd_bad(header, LAR_NRRD_LINE_SKIP, "is below 0; correct it", error);
    for (; lines > 0; lines--) {
        const char *end = data->length ? memchr(data->at, '\n', data->length) : NULL;
        if (!end)
            return lar_nrrd_bad(header, LAR_NRRD_LINE_SKIP,
                                "is more than the lines that the data have; correct it", error);
        data->length -= (size_t)(end + 1 - data->at);
        data->at = end + 1;
    }
    return LAR_OK;
}

/* Bytes are skipped after; -1 with raw data: all that come before the last ones. */
static lar_status skip_bytes(const lar_nrrd_header *header, const int64_t size[3], size_t each,
                             nrrd_encoding encoding, lar_image_stream *stream, lar_error *error) {
    int64_t skip = 0;
    lar_status status = lar_nrrd_whole(header, LAR_NRRD_BYTE_SKIP, 0, &skip, error);
    if (status) return status;
    if (skip == -1 && encoding == RAW) {
        uint64_t there = lar_image_stream_max(stream), needed;
        if (__builtin_mul_overflow((uint64_t)size[0], (uint64_t)size[1], &needed) ||
            __builtin_mul_overflow(needed, (uint64_t)size[2], &needed) ||
            __builtin_mul_overflow(needed, (uint64_t)each, &needed) || needed > there)
            return LAR_OK; /* refused by lar_image_allocate */
        skip = (int64_t)(there - needed);
    }
    if (skip < 0)
        return lar_nrrd_bad(header, LAR_NRRD_BYTE_SKIP,
                            "is below 0, which is for raw data only, and -1; correct it", error);
    if (lar_image_stream_read(stream, NULL, (uint64_t)skip) < (uint64_t)skip)
        return lar_nrrd_bad(header, LAR_NRRD_BYTE_SKIP,
                            "is more than the bytes that the data have; correct it", error);
    return LAR_OK;
}

/* ---- voxels --------------------------------------------------------------------------------- */

static lar_status fill_from_text(lar_image *image, const lar_nrrd_header *header,
                                 const lar_image_stream *stream, lar_error *error) {
    lar_text text = {(const char *)stream->at, (const char *)stream->end, 1};
    int64_t voxels = (int64_t)image->size[0] * image->size[1] * image->size[2];
    for (int64_t v = 0; v < voxels; v++) {
        double value;
        if (!lar_text_double(&text, &value)) {
            bool ends = !lar_text_skip_space(&text);
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: the header promises %lld numbers, %s after %lld; the file is cut "
                            "short or damaged, copy or write it again",
                            header->path, (long long)voxels,
                            ends ? "the file ends" : "something that is no number comes",
                            (long long)v);
        }
        lar_status status = lar_image_put(image, v, value, error);
        if (status) return status;
    }
    if (lar_text_skip_space(&text))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the header promises %lld numbers, but more follow them; the header or "
                        "the data are damaged, copy or write the file again",
                        header->path, (long long)voxels);
    return LAR_OK;
}

static lar_status read_voxels(const lar_nrrd_header *header, lar_image *image, lar_span data,
                              const int64_t size[3], lar_error *error) {
    nrrd_encoding encoding = RAW;
    lar_status status = read_encoding(header, &encoding, error);
    if (status) return status;
    if (!header->field[LAR_NRRD_TYPE].text.at)
        return lar_nrrd_missing(header, LAR_NRRD_TYPE, error);
    lar_voxel_type type = type_of(header->field[LAR_NRRD_TYPE].text);
    if (type == LAR_VOXEL_NONE)
        return lar_nrrd_bad(header, LAR_NRRD_TYPE, "is none for labels; write whole numbers",
                            error);
    /* Text takes a digit and a blank per voxel. */
    size_t each = encoding == ASCII ? 1 : lar_voxel_bytes(type);
    bool swap = false;
    if (each > 1) status = read_endian(header, &swap, error);
    if (!status) status = skip_lines(header, &data, error);
    if (status) return status;
    lar_image_stream stream;
    status = lar_image_stream_open(&stream, header->path, (const unsigned char *)data.at,
                                   data.length, encoding == GZIP, error);
    if (status) return status;
    status = skip_bytes(header, size, each, encoding, &stream, error);
    if (!status) status = lar_image_allocate(image, size, each, &stream, error);
    if (!status) status = lar_image_check_world(image, error);
    if (!status && encoding == ASCII)
        status = fill_from_text(image, header, &stream, error);
    else if (!status)
        status = lar_image_fill(image, &stream, type, swap, 1, 0, error);
    lar_image_stream_close(&stream);
    return status;
}

/* ---- segments ------------------------------------------------------------------------------- */

static int by_number(const void *left, const void *right) {
    const lar_nrrd_segment *a = left, *b = right;
    if (a->number != b->number) return a->number < b->number ? -1 : 1;
    if (a->is_name != b->is_name) return a->is_name ? 1 : -1;
    return a->value.line < b->value.line ? -1 : a->value.line > b->value.line;
}

/* 3D Slicer's segments: a label and a name under the same number. */
static lar_status read_segments(const lar_nrrd_header *header, lar_image *image, lar_error *error) {
    size_t count = header->segment_count, named = 0;
    if (count == 0) return LAR_OK;
    lar_nrrd_segment *segment = header->segment;
    qsort(segment, count, sizeof *segment, by_number);
    lar_image_entry *entry = lar_calloc(count, sizeof *entry);
    if (!entry) return lar_fail_memory(error, count * sizeof *entry, header->path);
    lar_status status = LAR_OK;
    for (size_t s = 0; !status && s + 1 < count; s++) {
        const lar_nrrd_segment *label = &segment[s], *name = &segment[s + 1];
        if (label->is_name || !name->is_name || label->number != name->number) continue;
        int64_t number;
        if (!lar_span_int64(label->value.text, &number) || number < 0 ||
            number > LAR_IMAGE_LABEL_MAX)
            status = lar_fail(error, LAR_ERROR_FORMAT,
                              "%s:%d: the segment's label is no whole number from 0 to %d; correct "
                              "it",
                              header->path, label->value.line, LAR_IMAGE_LABEL_MAX);
        else if (name->value.text.length > 0)
            entry[named++] = (lar_image_entry){(int32_t)number, s + 1, name->value.text};
    }
    if (!status) status = lar_image_add_names(image, entry, named, error);
    free(entry);
    return status;
}

lar_status lar_nrrd_parse(const char *path, const lar_bytes *bytes, lar_image *image,
                          lar_error *error) {
    *image = (lar_image){.source = lar_strdup(path)};
    if (!image->source) return lar_fail_memory(error, strlen(path), path);
    lar_nrrd_header header;
    lar_bytes file = {0};
    lar_span data = {0};
    int64_t size[3] = {0};
    lar_status status = lar_nrrd_read_header(path, bytes, &header, error);
    if (!status) status = lar_nrrd_geometry(&header, size, image, error);
    if (!status) status = find_data(&header, &file, &data, error);
    if (!status) status = read_voxels(&header, image, data, size, error);
    if (!status) status = read_segments(&header, image, error);
    lar_bytes_free(&file);
    lar_nrrd_clear_header(&header);
    return status;
}
