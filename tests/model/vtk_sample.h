/* Files for the VTK tests, put together from their parts by the test itself.
 *
 * The sample: two cubes beside a quad and an unused point, so that cell numbers and element
 * numbers differ and a point is dropped.
 *
 *     points 1 .. 12 are the nodes 0 .. 11; point 0 is used by nobody
 *     cell 0 a quad, cells 1 and 2 hexahedra (or voxels): elements 0 and 1
 */
#ifndef LAR_TESTS_VTK_SAMPLE_H
#define LAR_TESTS_VTK_SAMPLE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "model/format/mesh_io.h"

enum { SAMPLE_POINTS = 13, SAMPLE_CELLS = 3, SAMPLE_CORNERS = 20 };

static const int64_t sample_hexahedra[SAMPLE_CORNERS] = {1,  2,  5, 4, 1, 2, 5, 4, 7,  8,
                                                         11, 10, 2, 3, 6, 5, 8, 9, 12, 11};
static const int64_t sample_voxels[SAMPLE_CORNERS] = {1,  2,  5, 4, 1, 2, 4, 5, 7,  8,
                                                      10, 11, 2, 3, 5, 6, 8, 9, 11, 12};
static const int64_t sample_ends[SAMPLE_CELLS] = {4, 12, 20};
static const int64_t sample_types[SAMPLE_CELLS] = {9, 12, 12};
static const int64_t sample_voxel_types[SAMPLE_CELLS] = {9, 11, 11};
static const int64_t sample_material[SAMPLE_CELLS] = {99, 3, 4};
static const int64_t sample_part[SAMPLE_CELLS] = {50, 51, 52};
static const int64_t sample_right[SAMPLE_CELLS] = {0, 0, 1};
static const int64_t sample_top[SAMPLE_POINTS] = {1, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
static const int64_t sample_not_a_mask[SAMPLE_POINTS] = {0, 1, 2};
static const int64_t sample_base[3] = {3, 1, 2};
static const int64_t sample_front[2] = {17, 8};

/* Coordinate of point p; a third as a fraction that needs all 53 bits. */
static inline double sample_coordinate(int p, int axis) {
    static const double third = 1.0 / 3.0;
    if (p == 0) return -7;
    int i = p - 1;
    return third * (axis == 0 ? i % 3 : axis == 1 ? i / 3 % 2 : i / 6);
}

/* A file that grows. */
typedef struct sample_file {
    unsigned char *data;
    size_t size, capacity;
} sample_file;

static inline void put(sample_file *file, const void *data, size_t size) {
    if (file->size + size + 1 > file->capacity) {
        file->capacity = 2 * file->capacity + size + 1024;
        file->data = realloc(file->data, file->capacity);
        assert_non_null(file->data);
    }
    if (size > 0) memcpy(file->data + file->size, data, size);
    file->size += size;
    file->data[file->size] = 0;
}

static inline void __attribute__((format(printf, 2, 3)))
print(sample_file *file, const char *format, ...) {
    char text[4096];
    va_list args;
    va_start(args, format);
    int length = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    assert_in_range(length, 0, sizeof text - 1);
    put(file, text, (size_t)length);
}

/* Where `text` first stands in the file. */
static inline size_t position_of(const sample_file *file, const char *text) {
    size_t length = strlen(text);
    for (size_t i = 0; i + length <= file->size; i++)
        if (memcmp(file->data + i, text, length) == 0) return i;
    fail_msg("\"%s\" is not in the file", text);
    return 0;
}

/* The low `size` bytes of a word in either order. */
static inline void put_word(sample_file *file, uint64_t word, size_t size, bool big_endian) {
    for (size_t i = 0; i < size; i++) {
        unsigned char byte = (unsigned char)(word >> 8 * (big_endian ? size - 1 - i : i));
        put(file, &byte, 1);
    }
}

static inline uint64_t double_bits(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static inline uint64_t float_bits(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

typedef lar_status sample_parser(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                                 lar_error *error);

/* Parses a copy of exactly that size, so that a sanitizer sees a byte too many. */
static inline lar_status sample_parse(sample_parser *parse, const void *data, size_t size,
                                      lar_mesh *mesh, lar_error *error) {
    lar_bytes bytes = {malloc(size + 1), size};
    assert_non_null(bytes.data);
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    *mesh = (lar_mesh){0};
    *error = (lar_error){0};
    lar_status status = parse("sample", &bytes, mesh, error);
    lar_bytes_free(&bytes);
    return status;
}

static inline void expect_refusal(sample_parser *parse, const void *data, size_t size,
                                  lar_status expected, const char *part) {
    lar_mesh mesh;
    lar_error error;
    lar_status status = sample_parse(parse, data, size, &mesh, &error);
    lar_mesh_clear(&mesh);
    if (status != expected || !strstr(error.message, part))
        fail_msg("expected status %d and \"%s\", got %d: %s", expected, part, status,
                 error.message);
    assert_int_equal(error.status, status);
    assert_memory_equal(error.message, "sample", 6);
}

/* `text` with the first `old` replaced. */
static inline char *replaced(const char *text, const char *old, const char *fresh) {
    const char *at = strstr(text, old);
    if (!at) fail_msg("\"%s\" is not in the sample", old);
    sample_file out = {0};
    put(&out, text, (size_t)(at - text));
    put(&out, fresh, strlen(fresh));
    put(&out, at + strlen(old), strlen(at + strlen(old)));
    return (char *)out.data;
}

static inline void expect_set(const lar_mesh *mesh, const char *name, lar_set_kind kind,
                              const int32_t *index, int32_t count) {
    const lar_set *set = lar_mesh_find_set(mesh, name, kind);
    if (!set) fail_msg("set %s is missing", name);
    assert_int_equal(set->count, count);
    assert_memory_equal(set->index, index, (size_t)count * sizeof *index);
}

/* The sample as a mesh. `single`: coordinates went through float. */
static inline void expect_sample(const lar_mesh *mesh, bool single) {
    assert_int_equal(mesh->node_count, 12);
    assert_int_equal(mesh->element_count, 2);
    assert_string_equal(mesh->source, "sample");
    for (int n = 0; n < 12; n++) {
        assert_int_equal(mesh->node_id[n], n + 1);
        for (int axis = 0; axis < 3; axis++) {
            double wanted = sample_coordinate(n + 1, axis);
            if (single) wanted = (float)wanted;
            assert_memory_equal(&mesh->position[n][axis], &wanted, sizeof wanted);
        }
    }
    for (int e = 0; e < 2; e++) {
        assert_int_equal(mesh->element_id[e], e + 1);
        assert_int_equal(mesh->element_tag[e], 3 + e);
        for (int a = 0; a < 8; a++)
            assert_int_equal(mesh->element[e][a], sample_hexahedra[4 + e * 8 + a] - 1);
    }
    lar_error error = {0};
    if (lar_mesh_check(mesh, &error)) fail_msg("%s", error.message);
}

/* A file of the shared data, or a skipped test. */
static inline lar_bytes shared_file(const char *name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/data/volumes/%s", LAR_TEST_SHARED, name);
    lar_bytes bytes = {0};
    if (lar_bytes_read(path, &bytes, NULL) != LAR_OK) {
        print_message("skipped: no shared data\n");
        skip();
    }
    return bytes;
}

static inline double mesh_volume(const lar_mesh *mesh) {
    double volume = 0, corner[8][3];
    for (int32_t e = 0; e < mesh->element_count; e++) {
        lar_mesh_corners(mesh, e, corner);
        volume += lar_hexahedron_volume(corner);
    }
    return volume;
}

#endif
