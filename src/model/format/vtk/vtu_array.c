#include "model/format/vtk/vtu_array.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { DEFLATE_MAX = 1032, DEFLATE_SMALL = 64 };

/* Bytes of the payload, one after the other, whether they stand there raw or as base64. */
typedef struct byte_source {
    const unsigned char *at, *end;
    bool base64;
    unsigned char pending[3]; /* decoded, not yet taken */
    int pending_count;
} byte_source;

static lar_status damaged(const lar_vtu_array_text *array, const char *cause, lar_error *error) {
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s:%d: the data of array \"%s\" %s; the file is damaged or cut short, write "
                    "it again",
                    array->path, array->line, array->name, cause);
}

static byte_source source_of(const lar_vtu_array_text *array) {
    const unsigned char *start = (const unsigned char *)array->payload.at;
    return (byte_source){.at = start,
                         .end = start ? start + array->payload.length : start,
                         .base64 = array->encoding == LAR_VTU_BASE64};
}

/* At most so many bytes can still come. */
static size_t source_max(const byte_source *source) {
    size_t left = (size_t)(source->end - source->at);
    return (source->base64 ? left / 4 * 3 : left) + (size_t)source->pending_count;
}

static int base64_value(unsigned char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+') return 62;
    if (c == '/') return 63;
    return -1;
}

/* Decodes the next group of four characters into pending. */
static bool decode_group(byte_source *source) {
    uint32_t bits = 0;
    int characters = 0, padding = 0;
    while (characters < 4) {
        if (source->at == source->end) return false;
        unsigned char c = *source->at++;
        if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
        int value = base64_value(c);
        if (c == '=' && characters >= 2)
            padding++;
        else if (value < 0 || padding > 0)
            return false;
        bits = bits << 6 | (uint32_t)(c == '=' ? 0 : value);
        characters++;
    }
    source->pending[0] = (unsigned char)(bits >> 16);
    source->pending[1] = (unsigned char)(bits >> 8);
    source->pending[2] = (unsigned char)bits;
    source->pending_count = 3 - padding;
    return true;
}

static bool source_read(byte_source *source, void *out, size_t size) {
    unsigned char *to = out;
    if (!source->base64) {
        if (size > (size_t)(source->end - source->at)) return false;
        memcpy(to, source->at, size);
        source->at += size;
        return true;
    }
    while (size > 0) {
        if (source->pending_count == 0 && !decode_group(source)) return false;
        size_t take = (size_t)source->pending_count < size ? (size_t)source->pending_count : size;
        memcpy(to, source->pending, take);
        memmove(source->pending, source->pending + take, 3 - take);
        source->pending_count -= (int)take;
        to += take;
        size -= take;
    }
    return true;
}

static bool read_word(const lar_vtu_array_text *array, byte_source *source, uint64_t *word) {
    unsigned char bytes[8];
    size_t size = array->header64 ? 8 : 4;
    if (!source_read(source, bytes, size)) return false;
    if (array->header64) {
        memcpy(word, bytes, sizeof *word);
        if (array->swap) *word = __builtin_bswap64(*word);
    } else {
        uint32_t narrow;
        memcpy(&narrow, bytes, sizeof narrow);
        *word = array->swap ? __builtin_bswap32(narrow) : narrow;
    }
    return true;
}

/* [blocks][size of a block][size of the last one, 0: full] before the list of compressed sizes.
 * *total is what all blocks hold. False when the numbers cannot be. */
static bool read_block_header(const lar_vtu_array_text *array, byte_source *source,
                              uint64_t *blocks, uint64_t *block_size, uint64_t *last_size,
                              uint64_t *total) {
    size_t word = array->header64 ? 8 : 4;
    *total = 0;
    if (!read_word(array, source, blocks)) return false;
    if (*blocks == 0) return true;
    if (!read_word(array, source, block_size) || !read_word(array, source, last_size)) return false;
    if (!lar_claim_fits(*blocks, word, source_max(source))) return false;
    if (*last_size > *block_size) return false;
    if (*last_size == 0) *last_size = *block_size;
    uint64_t before;
    return !__builtin_mul_overflow(*blocks - 1, *block_size, &before) &&
           !__builtin_add_overflow(before, *last_size, total);
}

/* One zlib stream of `packed` bytes into exactly `size` bytes. `scratch` holds base64 output.
 * Returns what zlib does. */
static int inflate_block(byte_source *source, size_t packed, unsigned char *scratch,
                         unsigned char *out, size_t size) {
    const unsigned char *from = source->at;
    if (source->base64) {
        if (!source_read(source, scratch, packed)) return Z_DATA_ERROR;
        from = scratch;
    } else {
        if (packed > (size_t)(source->end - source->at)) return Z_DATA_ERROR;
        source->at += packed;
    }
    uLongf got = size;
    uLong used = packed;
    int result = uncompress2(out, &got, from, &used);
    return result == Z_OK && (got != size || used != packed) ? Z_DATA_ERROR : result;
}

/* The compressed sizes, each checked against the bytes there. False when they cannot be. */
static bool read_packed_sizes(const lar_vtu_array_text *array, byte_source *source, uint64_t blocks,
                              size_t *packed, size_t *sum, size_t *largest) {
    *sum = *largest = 0;
    for (uint64_t i = 0; i < blocks; i++) {
        uint64_t size;
        if (!read_word(array, source, &size) || size > source_max(source)) return false;
        packed[i] = (size_t)size;
        if (__builtin_add_overflow(*sum, packed[i], sum)) return false;
        if (packed[i] > *largest) *largest = packed[i];
    }
    return *sum <= source_max(source);
}

/* An array that has its text for itself must end with it. */
static bool more_follows(const lar_vtu_array_text *array, const byte_source *source) {
    if (array->appended) return false;
    lar_text rest = {(const char *)source->at, (const char *)source->end, 1};
    return source->pending_count > 0 || lar_text_skip_space(&rest);
}

/* Inflates all blocks into `size` bytes, allocated once the claim is plausible. */
static lar_status unpack(const lar_vtu_array_text *array, size_t size, unsigned char **out,
                         lar_error *error) {
    byte_source source = source_of(array);
    uint64_t blocks, block_size = 0, last_size = 0, total;
    if (!read_block_header(array, &source, &blocks, &block_size, &last_size, &total))
        return damaged(array, "begins with sizes that cannot be", error);
    if (total != size)
        return damaged(array, "do not have the size that the file's counts ask for", error);

    size_t sum = 0, largest = 0;
    size_t *packed = lar_calloc((size_t)blocks, sizeof *packed);
    if (!packed) return lar_fail_memory(error, (size_t)blocks * sizeof *packed, array->name);
    if (!read_packed_sizes(array, &source, blocks, packed, &sum, &largest) ||
        size / DEFLATE_MAX > sum + DEFLATE_SMALL) {
        free(packed);
        return damaged(array, "claim compressed sizes that cannot be", error);
    }

    unsigned char *data = malloc(size + 1);
    unsigned char *scratch = source.base64 ? malloc(largest + 1) : NULL;
    lar_status status = LAR_OK;
    if (!data || (source.base64 && !scratch)) status = lar_fail_memory(error, size, array->name);
    size_t filled = 0;
    for (uint64_t i = 0; i < blocks && !status; i++) {
        size_t want = (size_t)(i + 1 < blocks ? block_size : last_size);
        int result = inflate_block(&source, packed[i], scratch, data + filled, want);
        if (result == Z_MEM_ERROR)
            status = lar_fail_memory(error, want, array->name);
        else if (result != Z_OK)
            status = damaged(array, "cannot be decompressed", error);
        filled += want;
    }
    if (!status && more_follows(array, &source))
        status = damaged(array, "are more than the file's counts ask for", error);
    free(scratch);
    free(packed);
    if (status) {
        free(data);
        return status;
    }
    *out = data;
    return LAR_OK;
}

/* The bytes of a plain array. */
static lar_status copy_plain(const lar_vtu_array_text *array, size_t size, unsigned char **out,
                             lar_error *error) {
    byte_source source = source_of(array);
    uint64_t claimed;
    if (!read_word(array, &source, &claimed)) return damaged(array, "have no header", error);
    if (claimed != size)
        return damaged(array, "do not have the size that the file's counts ask for", error);
    if (size > source_max(&source)) return damaged(array, "end too early", error);
    unsigned char *data = malloc(size + 1);
    if (!data) return lar_fail_memory(error, size, array->name);
    bool read = source_read(&source, data, size);
    if (!read || more_follows(array, &source)) {
        free(data);
        return damaged(array,
                       read ? "are more than the file's counts ask for"
                            : "are no base64 text of that size",
                       error);
    }
    *out = data;
    return LAR_OK;
}

/* The bytes of `count` values. An array of none may lack even its header. */
static lar_status read_bytes(const lar_vtu_array_text *array, size_t count, unsigned char **out,
                             lar_error *error) {
    size_t size;
    if (__builtin_mul_overflow(count, lar_vtk_scalar_size(array->type), &size))
        return damaged(array, "claim an impossible number of values", error);
    if (size == 0) {
        *out = lar_calloc(1, 1);
        return *out ? LAR_OK : lar_fail_memory(error, 1, array->name);
    }
    return array->compressed ? unpack(array, size, out, error)
                             : copy_plain(array, size, out, error);
}

/* An array without text reads like an empty one. */
static lar_text ascii_text(const lar_vtu_array_text *array) {
    const char *start = array->payload.at ? array->payload.at : "";
    return (lar_text){start, start + array->payload.length, array->line};
}

/* Every value needs a character and one that ends it. */
static lar_status check_ascii(const lar_vtu_array_text *array, size_t count, lar_error *error) {
    if (count > (array->payload.length + 1) / 2)
        return damaged(array, "have fewer values than the file's counts ask for", error);
    return LAR_OK;
}

static lar_status bad_ascii(const lar_vtu_array_text *array, const lar_text *text, size_t index,
                            size_t count, lar_error *error) {
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s:%d: value %zu of the %zu of array \"%s\" is missing or no number of its "
                    "type; write the file again",
                    array->path, text->line, index, count, array->name);
}

static lar_status end_of_ascii(const lar_vtu_array_text *array, lar_text *text, size_t count,
                               lar_error *error) {
    if (!lar_text_skip_space(text)) return LAR_OK;
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s:%d: array \"%s\" has more values than the %zu that the file's counts ask "
                    "for; write the file again",
                    array->path, text->line, array->name, count);
}

lar_status lar_vtu_array_doubles(const lar_vtu_array_text *array, size_t count, double **out,
                                 lar_error *error) {
    unsigned char *bytes = NULL;
    bool ascii = array->encoding == LAR_VTU_ASCII;
    lar_status status =
        ascii ? check_ascii(array, count, error) : read_bytes(array, count, &bytes, error);
    if (status) return status;
    double *values = lar_calloc(count, sizeof *values);
    if (!values) {
        free(bytes);
        return lar_fail_memory(error, count * sizeof *values, array->name);
    }
    if (ascii) {
        lar_text text = ascii_text(array);
        for (size_t i = 0; i < count && !status; i++)
            if (!lar_text_double(&text, &values[i]))
                status = bad_ascii(array, &text, i, count, error);
        if (!status) status = end_of_ascii(array, &text, count, error);
    } else {
        lar_vtk_to_double(array->type, bytes, array->swap, count, values);
    }
    free(bytes);
    if (status) {
        free(values);
        return status;
    }
    *out = values;
    return LAR_OK;
}

lar_status lar_vtu_array_integers(const lar_vtu_array_text *array, size_t count, int64_t **out,
                                  lar_error *error) {
    if (!lar_vtk_scalar_is_integer(array->type))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s:%d: array \"%s\" must hold integers, but its type is a floating point "
                        "one; write it as Int64",
                        array->path, array->line, array->name);
    unsigned char *bytes = NULL;
    bool ascii = array->encoding == LAR_VTU_ASCII;
    lar_status status =
        ascii ? check_ascii(array, count, error) : read_bytes(array, count, &bytes, error);
    if (status) return status;
    int64_t *values = lar_calloc(count, sizeof *values);
    if (!values) {
        free(bytes);
        return lar_fail_memory(error, count * sizeof *values, array->name);
    }
    if (ascii) {
        lar_text text = ascii_text(array);
        for (size_t i = 0; i < count && !status; i++)
            if (!lar_text_int64(&text, &values[i]))
                status = bad_ascii(array, &text, i, count, error);
        if (!status) status = end_of_ascii(array, &text, count, error);
    } else if (!lar_vtk_to_int64(array->type, bytes, array->swap, count, values)) {
        status = damaged(array, "hold a number of more than 63 bits", error);
    }
    free(bytes);
    if (status) {
        free(values);
        return status;
    }
    *out = values;
    return LAR_OK;
}

size_t lar_vtu_array_count(const lar_vtu_array_text *array) {
    if (array->encoding == LAR_VTU_ASCII) {
        lar_text text = ascii_text(array);
        lar_span word;
        size_t count = 0;
        while (lar_text_word(&text, &word)) count++;
        return count;
    }
    byte_source source = source_of(array);
    uint64_t blocks, block_size, last_size, total;
    bool good = array->compressed
                    ? read_block_header(array, &source, &blocks, &block_size, &last_size, &total)
                    : read_word(array, &source, &total);
    return good ? (size_t)(total / lar_vtk_scalar_size(array->type)) : 0;
}
