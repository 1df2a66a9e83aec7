/* Files of label images, byte by byte, for the tests of their readers. */
#ifndef LAR_TESTS_IMAGE_BYTES_H
#define LAR_TESTS_IMAGE_BYTES_H

#include "testing.h"

#include <zlib.h>

#include "meshing/image/image.h"

/* ---- bytes ---------------------------------------------------------------------------------- */

static TEST_UNUSED void append(lar_bytes *bytes, const void *more, size_t size) {
    unsigned char *grown = realloc(bytes->data, bytes->size + size + 1);
    assert_non_null(grown);
    if (more)
        memcpy(grown + bytes->size, more, size);
    else
        memset(grown + bytes->size, 0, size);
    bytes->data = grown;
    bytes->size += size;
    bytes->data[bytes->size] = 0;
}

/* The lower `size` bytes of a word. */
static TEST_UNUSED void place_word(unsigned char *to, uint64_t word, size_t size, bool big) {
    for (size_t b = 0; b < size; b++) to[big ? size - 1 - b : b] = (unsigned char)(word >> (8 * b));
}

static TEST_UNUSED void place_float(unsigned char *to, float value, bool big) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    place_word(to, word, sizeof word, big);
}

static TEST_UNUSED void place_double(unsigned char *to, double value, bool big) {
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    place_word(to, word, sizeof word, big);
}

/* Compressed as one gzip member, which takes the place of what was there from byte `from` on. */
static TEST_UNUSED void gzip_from(lar_bytes *bytes, size_t from) {
    z_stream z = {0};
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
    size_t size = bytes->size - from, max = deflateBound(&z, size);
    unsigned char *packed = malloc(max);
    assert_non_null(packed);
    z.next_in = bytes->data + from;
    z.avail_in = (uInt)size;
    z.next_out = packed;
    z.avail_out = (uInt)max;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    bytes->size = from;
    append(bytes, packed, z.total_out);
    deflateEnd(&z);
    free(packed);
}

static TEST_UNUSED void save(const lar_bytes *bytes, const char *path) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes->data, 1, bytes->size, file), bytes->size);
    assert_int_equal(fclose(file), 0);
}

/* ---- voxels --------------------------------------------------------------------------------- */

typedef enum value_type { U8, I8, U16, I16, U32, I32, U64, I64, F32, F64, VALUE_TYPES } value_type;

static const struct {
    size_t size;
    int nifti; /* its code there */
    const char *nrrd;
} VALUE_TYPE[VALUE_TYPES] = {{1, 2, "uchar"},          {1, 256, "signed char"},
                             {2, 512, "uint16"},       {2, 4, "short"},
                             {4, 768, "unsigned int"}, {4, 8, "int32_t"},
                             {8, 1280, "ulonglong"},   {8, 1024, "signed long long int"},
                             {4, 16, "float"},         {8, 64, "double"}};

static TEST_UNUSED void append_value(lar_bytes *bytes, value_type type, double value, bool big) {
    unsigned char word[8];
    if (type == F32)
        place_float(word, (float)value, big);
    else if (type == F64)
        place_double(word, value, big);
    else
        place_word(word, (uint64_t)(int64_t)value, VALUE_TYPE[type].size, big);
    append(bytes, word, VALUE_TYPE[type].size);
}

enum { VOXELS = 12 }; /* 3 x 2 x 2 */

/* Fit every type; the larger ones have larger labels, too. */
static TEST_UNUSED uint16_t label_of(value_type type, int voxel) {
    static const uint16_t SMALL[VOXELS] = {0, 1, 2, 3, 0, 5, 100, 7, 0, 1, 0, 127};
    if (voxel == 6 && type != I8) return type == U8 ? 255 : 300;
    if (voxel == 7 && type > I16) return 65535;
    return SMALL[voxel];
}

static TEST_UNUSED void append_labels(lar_bytes *bytes, value_type type, bool big) {
    for (int v = 0; v < VOXELS; v++) append_value(bytes, type, label_of(type, v), big);
}

static TEST_UNUSED void expect_labels(const lar_image *image, value_type type) {
    assert_int_equal(image->size[0], 3);
    assert_int_equal(image->size[1], 2);
    assert_int_equal(image->size[2], 2);
    for (int v = 0; v < VOXELS; v++) assert_int_equal(image->label[v], label_of(type, v));
}

/* ---- what comes out ------------------------------------------------------------------------- */

static TEST_UNUSED void expect_world(const lar_image *image, const double wanted[3][4]) {
    for (int c = 0; c < 3; c++)
        for (int d = 0; d < 4; d++)
            if (!(fabs(image->to_world[c][d] - wanted[c][d]) < 1e-8))
                fail_msg("world[%d][%d] is %.9g, not %.9g", c, d, image->to_world[c][d],
                         wanted[c][d]);
}

typedef lar_status image_parser(const char *, const lar_bytes *, lar_image *, lar_error *);

static TEST_UNUSED void parse_good(image_parser *parse, const char *path, const lar_bytes *bytes,
                                   lar_image *image) {
    lar_error error = {0};
    if (parse(path, bytes, image, &error)) fail_msg("%s", error.message);
    assert_string_equal(image->source, path);
}

/* Refused with these words, separated by bars, and without NaN. */
static TEST_UNUSED void expect_words(const lar_error *error, const char *words) {
    char copy[400];
    snprintf(copy, sizeof copy, "%s", words);
    char *rest = NULL;
    for (char *word = strtok_r(copy, "|", &rest); word; word = strtok_r(NULL, "|", &rest))
        if (!strstr(error->message, word))
            fail_msg("\"%s\" does not say \"%s\"", error->message, word);
    /* Only in a quotation of the file. */
    if (!strchr(error->message, '"')) {
        assert_null(strstr(error->message, "nan"));
        assert_null(strstr(error->message, "inf"));
    }
}

static TEST_UNUSED void expect_bad(image_parser *parse, const char *path, const lar_bytes *bytes,
                                   lar_status status, const char *words) {
    lar_image image;
    lar_error error = {0};
    lar_status got = parse(path, bytes, &image, &error);
    lar_image_clear(&image);
    if (got == LAR_OK) fail_msg("accepted; should say \"%s\"", words);
    expect_words(&error, words);
    if (got != status) fail_msg("status %d, not %d: %s", got, status, error.message);
    assert_int_equal(error.status, status);
}

#endif
