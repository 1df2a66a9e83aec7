#include <math.h>
#include <stdio.h>
#include <string.h>

#include "meshing/image/parts.h"

enum {
    DEFLATE_MAX = 1032,
    PIECE = 4096 /* voxels */,
    FEED = 1 << 30,       /* bytes, below zlib's int */
    SURPLUS_MAX = 1 << 28 /* bytes that are read only to tell how many too many there are */
};

/* ---- bytes ---------------------------------------------------------------------------------- */

enum { WINDOW = 1 << 16 }; /* about what zlib needs */

bool lar_image_is_gzip(const unsigned char *bytes, size_t size) {
    return size >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

lar_status lar_image_stream_open(lar_image_stream *stream, const char *path,
                                 const unsigned char *bytes, size_t size, bool gzip,
                                 lar_error *error) {
    *stream = (lar_image_stream){.path = path, .at = bytes, .end = bytes + size};
    if (gzip && inflateInit2(&stream->inflate, 16 + MAX_WBITS) != Z_OK)
        return lar_fail_memory(error, WINDOW, path);
    stream->gzip = gzip;
    return LAR_OK;
}

void lar_image_stream_close(lar_image_stream *stream) {
    if (stream->gzip) inflateEnd(&stream->inflate);
    *stream = (lar_image_stream){0};
}

/* Archives fill their last block with zeros, which gzip passes over, too. */
static const unsigned char *past_zeros(const unsigned char *at, const unsigned char *end) {
    while (at < end && *at == 0) at++;
    return at;
}

/* Inflates into `out` until it is full or the stream ends. Files may be several gzip members, one
 * after the other (RFC 1952, 2.2); nothing else may follow. */
static void inflate_some(lar_image_stream *stream, unsigned char *out, uInt size) {
    z_stream *z = &stream->inflate;
    z->next_out = out;
    z->avail_out = size;
    while (z->avail_out > 0 && !stream->ended) {
        size_t left = (size_t)(stream->end - stream->at);
        z->next_in = (z_const Bytef *)stream->at;
        z->avail_in = (uInt)(left < FEED ? left : FEED);
        int result = inflate(z, Z_NO_FLUSH);
        stream->at = z->next_in;
        if (result == Z_STREAM_END) {
            left = (size_t)(stream->end - stream->at);
            stream->ended = !lar_image_is_gzip(stream->at, left) || inflateReset(z) != Z_OK;
            if (stream->ended) stream->at = past_zeros(stream->at, stream->end);
        } else if (result != Z_OK) { /* also Z_BUF_ERROR: more is needed, and there is none */
            stream->ended = stream->damaged = true;
            stream->starved = result == Z_MEM_ERROR;
        }
    }
}

uint64_t lar_image_stream_read(lar_image_stream *stream, void *out, uint64_t size) {
    unsigned char scratch[1 << 14], *to = out;
    uint64_t got = 0;
    if (!stream->gzip) {
        size_t left = (size_t)(stream->end - stream->at);
        got = size < left ? size : left;
        if (to) memcpy(to, stream->at, (size_t)got);
        stream->at += got;
        stream->ended = got < size;
        stream->given += got;
        return got;
    }
    while (got < size && !stream->ended) {
        uint64_t wanted = size - got, room = to ? FEED : sizeof scratch;
        uInt piece = (uInt)(wanted < room ? wanted : room);
        inflate_some(stream, to ? to + got : scratch, piece);
        got += piece - stream->inflate.avail_out;
    }
    stream->given += got;
    return got;
}

uint64_t lar_image_stream_max(const lar_image_stream *stream) {
    uint64_t left = (uint64_t)(stream->end - stream->at);
    /* zlib may hold some bytes that it has taken. */
    return stream->gzip ? (left + 8) * DEFLATE_MAX : left;
}

/* ---- memory --------------------------------------------------------------------------------- */

lar_status lar_image_allocate(lar_image *image, const int64_t size[3], size_t bytes_each,
                              const lar_image_stream *stream, lar_error *error) {
    const char *path = image->source;
    int64_t voxels = 1;
    for (int a = 0; a < 3; a++) {
        if (size[a] < 1)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: the image has %lld voxels along axis %c; write it again", path,
                            (long long)size[a], "ijk"[a]);
        if (size[a] > LAR_IMAGE_SIDE_MAX)
            return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                            "%s: the image has %lld voxels along axis %c, more than %d; cut it to "
                            "the organs that are wanted, or resample it",
                            path, (long long)size[a], "ijk"[a], LAR_IMAGE_SIDE_MAX);
        if ((voxels *= size[a]) > LAR_IMAGE_VOXELS_MAX)
            return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                            "%s: %lld x %lld x %lld voxels are more than %d; cut the image to the "
                            "organs that are wanted, or resample it",
                            path, (long long)size[0], (long long)size[1], (long long)size[2],
                            LAR_IMAGE_VOXELS_MAX);
        image->size[a] = (int32_t)size[a];
    }
    uint64_t promised = (uint64_t)voxels * bytes_each, max = lar_image_stream_max(stream);
    if (promised > max)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the header promises %llu bytes of voxels, the file holds %s%llu; it "
                        "is cut short or damaged, copy or write it again",
                        path, (unsigned long long)promised, stream->gzip ? "at most " : "",
                        (unsigned long long)max);
    image->label = lar_calloc((size_t)voxels, sizeof *image->label);
    if (!image->label) return lar_fail_memory(error, (size_t)voxels * sizeof *image->label, path);
    return LAR_OK;
}

/* ---- values --------------------------------------------------------------------------------- */

size_t lar_voxel_bytes(lar_voxel_type type) {
    static const size_t BYTES[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return BYTES[type];
}

/* Values of one type. Whole numbers beyond 2^53 are rounded, but they are no labels anyway. */
#define DECODE(kind, unsigned_kind, swapped)                                                       \
    for (size_t n = 0; n < count; n++) {                                                           \
        unsigned_kind word;                                                                        \
        kind number;                                                                               \
        memcpy(&word, from + n * sizeof word, sizeof word);                                        \
        if (swap) word = swapped;                                                                  \
        memcpy(&number, &word, sizeof number);                                                     \
        value[n] = (double)number;                                                                 \
    }                                                                                              \
    break

static void decode(lar_voxel_type type, bool swap, const unsigned char *from, size_t count,
                   double *value) {
    switch (type) {
    case LAR_VOXEL_U8:
        DECODE(uint8_t, uint8_t, word);
    case LAR_VOXEL_I8:
        DECODE(int8_t, uint8_t, word);
    case LAR_VOXEL_U16:
        DECODE(uint16_t, uint16_t, __builtin_bswap16(word));
    case LAR_VOXEL_I16:
        DECODE(int16_t, uint16_t, __builtin_bswap16(word));
    case LAR_VOXEL_U32:
        DECODE(uint32_t, uint32_t, __builtin_bswap32(word));
    case LAR_VOXEL_I32:
        DECODE(int32_t, uint32_t, __builtin_bswap32(word));
    case LAR_VOXEL_U64:
        DECODE(uint64_t, uint64_t, __builtin_bswap64(word));
    case LAR_VOXEL_I64:
        DECODE(int64_t, uint64_t, __builtin_bswap64(word));
    case LAR_VOXEL_F32:
        DECODE(float, uint32_t, __builtin_bswap32(word));
    case LAR_VOXEL_F64:
        DECODE(double, uint64_t, __builtin_bswap64(word));
    case LAR_VOXEL_NONE:
        break;
    }
}

static lar_status no_label(const lar_image *image, int64_t voxel, double value, lar_error *error) {
    int64_t i = voxel % image->size[0], j = voxel / image->size[0] % image->size[1];
    int64_t k = voxel / image->size[0] / image->size[1];
    char words[32] = "no number";
    if (isfinite(value)) snprintf(words, sizeof words, "%.9g", value);
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: voxel (%lld, %lld, %lld) has the value %s, but labels are whole numbers "
                    "from 0 to %d: this is no label map, perhaps the scan itself; segment it "
                    "first, or give the segmentation",
                    image->source, (long long)i, (long long)j, (long long)k, words,
                    LAR_IMAGE_LABEL_MAX);
}

/* 0 is there already: memory that is not written to takes no room, and most of a scan is 0. */
static inline bool take_label(double value, double slack, uint16_t *label) {
    if (!(value > -0.5 && value < LAR_IMAGE_LABEL_MAX + 0.5)) return false;
    int32_t whole = (int32_t)(value + 0.5);
    if (whole != 0) *label = (uint16_t)whole;
    return fabs(value - whole) <= slack;
}

lar_status lar_image_put(lar_image *image, int64_t voxel, double value, lar_error *error) {
    if (take_label(value, 0, &image->label[voxel])) return LAR_OK;
    return no_label(image, voxel, value, error);
}

static lar_status cut_short(const lar_image_stream *stream, uint64_t promised, uint64_t found,
                            lar_error *error) {
    if (stream->starved) return lar_fail_memory(error, WINDOW, stream->path);
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: the header promises %llu bytes of voxels, the file holds %llu%s; it "
                    "is cut short or damaged, copy or write it again",
                    stream->path, (unsigned long long)promised, (unsigned long long)found,
                    stream->damaged ? " that can be decompressed" : "");
}

/* gzip's check sum stands behind its last byte, so all is read; and a file that holds more than its
 * header promises is damaged, or another image than the header says. */
static lar_status check_end(lar_image_stream *stream, uint64_t promised, lar_error *error) {
    uint64_t surplus = lar_image_stream_read(stream, NULL, SURPLUS_MAX);
    if (stream->starved) return lar_fail_memory(error, WINDOW, stream->path);
    if (stream->damaged)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the compressed data do not fit their check sum, or end before it; the "
                        "file is damaged, copy or write it again",
                        stream->path);
    if (surplus > 0)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the header promises %llu bytes of voxels, but %s%llu more follow "
                        "them; the header or the data are damaged, copy or write the file again",
                        stream->path, (unsigned long long)promised,
                        surplus == SURPLUS_MAX ? "at least " : "", (unsigned long long)surplus);
    if (stream->at < stream->end)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: behind the end of the compressed data follow %llu bytes that are no "
                        "gzip; the file is damaged, copy or write it again",
                        stream->path, (unsigned long long)(stream->end - stream->at));
    return LAR_OK;
}

lar_status lar_image_fill(lar_image *image, lar_image_stream *stream, lar_voxel_type type,
                          bool swap, double slope, double intercept, lar_error *error) {
    unsigned char bytes[PIECE * 8];
    double value[PIECE];
    size_t each = lar_voxel_bytes(type);
    int64_t voxels = (int64_t)image->size[0] * image->size[1] * image->size[2];
    uint64_t promised = (uint64_t)voxels * each, before = stream->given;
    bool scaled = slope != 1 || intercept != 0;
    for (int64_t first = 0; first < voxels; first += PIECE) {
        size_t count = (size_t)(voxels - first < PIECE ? voxels - first : PIECE);
        if (lar_image_stream_read(stream, bytes, count * each) < count * each)
            return cut_short(stream, promised, stream->given - before, error);
        decode(type, swap, bytes, count, value);
        for (size_t n = 0; n < count; n++) {
            /* Slopes are 32-bit numbers: 0.1f * 10 is not 1. */
            double label = scaled ? slope * value[n] + intercept : value[n];
            double slack = scaled ? 1e-6 * (1 + fabs(label)) : 0;
            if (!take_label(label, slack, &image->label[first + (int64_t)n]))
                return no_label(image, first + (int64_t)n, label, error);
        }
    }
    return check_end(stream, promised, error);
}

/* ---- the world ------------------------------------------------------------------------------ */

lar_status lar_image_check_world(const lar_image *image, lar_error *error) {
    /* [m]; nothing that is scanned is smaller or larger */
    static const double FINEST = 1e-9, COARSEST = 1e3, FARTHEST = 1e6;
    const double(*m)[4] = image->to_world;
    double edge[3], product = 1;
    for (int a = 0; a < 3; a++) {
        edge[a] = hypot(hypot(m[0][a], m[1][a]), m[2][a]);
        for (int c = 0; c < 3; c++)
            if (!isfinite(m[c][a]) || !isfinite(m[c][3]))
                return lar_fail(error, LAR_ERROR_FORMAT,
                                "%s: the map from voxels to the world holds something that is no "
                                "number; write the image again with its orientation",
                                image->source);
        if (!(edge[a] >= FINEST && edge[a] <= COARSEST))
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: voxels are %g m long along axis %c, not between %g and %g m; "
                            "write the image again with its voxel sizes and their unit",
                            image->source, edge[a], "ijk"[a], FINEST, COARSEST);
        product *= edge[a];
    }
    for (int c = 0; c < 3; c++) {
        double far = fabs(m[c][3]);
        for (int a = 0; a < 3; a++) far += fabs(m[c][a]) * image->size[a];
        if (far > FARTHEST)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: the image reaches %g m from the world's origin; write it again "
                            "with its orientation and unit",
                            image->source, far);
    }
    if (!(lar_image_voxel_volume(image) > 1e-6 * product))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the image's axes lie in one plane, so that voxels have no volume; "
                        "write the image again with its orientation",
                        image->source);
    return LAR_OK;
}
