/* What the mesh tests share: files in memory, messages, the sweep over every prefix. */
#ifndef LAR_TESTS_MODEL_MESH_TEST_H
#define LAR_TESTS_MODEL_MESH_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "model/format/mesh_io.h"

typedef lar_status (*mesh_parser)(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                                  lar_error *error);

/* Parses a copy of exactly `size` bytes, so that a sanitizer sees every byte read beyond. */
static inline lar_status parse_copy(mesh_parser parse, const char *path, const void *data,
                                    size_t size, lar_mesh *mesh, lar_error *error) {
    lar_bytes bytes = {malloc(size + 1), size};
    assert_non_null(bytes.data);
    memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    *mesh = (lar_mesh){0};
    *error = (lar_error){0};
    lar_status status = parse(path, &bytes, mesh, error);
    if (!status) status = lar_mesh_check(mesh, error);
    lar_bytes_free(&bytes);
    return status;
}

static inline lar_mesh parse_good(mesh_parser parse, const char *path, const void *data,
                                  size_t size) {
    lar_mesh mesh;
    lar_error error;
    lar_status status = parse_copy(parse, path, data, size, &mesh, &error);
    if (status) fail_msg("refused: %s", error.message);
    return mesh;
}

static inline void assert_says(const lar_error *error, const char *part) {
    if (!strstr(error->message, part))
        fail_msg("'%s' is not in the message: %s", part, error->message);
}

/* The data must be refused with a message that holds every one of the parts (NULL ends them). */
static inline void assert_refused(mesh_parser parse, const char *path, const void *data,
                                  size_t size, lar_status status, const char *const *parts) {
    lar_mesh mesh;
    lar_error error;
    lar_status got = parse_copy(parse, path, data, size, &mesh, &error);
    lar_mesh_clear(&mesh);
    if (got == LAR_OK) fail_msg("accepted, but should be refused with '%s'", parts[0]);
    for (; *parts; parts++) assert_says(&error, *parts);
    assert_int_equal(got, status);
    assert_int_equal(error.status, status);
}
#define ASSERT_TEXT_REFUSED(parse, path, text, status, ...)                                        \
    assert_refused(parse, path, text, strlen(text), status,                                        \
                   (const char *const[]){__VA_ARGS__, NULL})

/* Every prefix of a good file gives a mesh or a message, and nothing else. */
static inline void sweep_prefixes(mesh_parser parse, const char *path, const void *data,
                                  size_t size) {
    for (size_t length = 0; length < size; length++) {
        lar_mesh mesh;
        lar_error error;
        if (parse_copy(parse, path, data, length, &mesh, &error)) assert_says(&error, path);
        lar_mesh_clear(&mesh);
    }
}

/* `text` with the first `old` replaced; free it. */
static inline char *with(const char *text, const char *old, const char *fresh) {
    const char *at = strstr(text, old);
    assert_non_null(at);
    size_t before = (size_t)(at - text), length = strlen(text) - strlen(old) + strlen(fresh);
    char *changed = malloc(length + 1);
    assert_non_null(changed);
    memcpy(changed, text, before);
    strcpy(changed + before, fresh);
    strcat(changed, at + strlen(old));
    return changed;
}

static inline double mesh_volume(const lar_mesh *mesh) {
    double volume = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        volume += lar_hexahedron_volume((const double(*)[3])corner);
    }
    return volume;
}

static inline void assert_set(const lar_mesh *mesh, const char *name, lar_set_kind kind,
                              int32_t count, const int32_t *index) {
    const lar_set *set = lar_mesh_find_set(mesh, name, kind);
    if (!set) fail_msg("no set '%s'", name);
    assert_int_equal(set->count, count);
    for (int32_t i = 0; i < count; i++) assert_int_equal(set->index[i], index[i]);
}
#define ASSERT_SET(mesh, name, kind, ...)                                                          \
    assert_set(mesh, name, kind, sizeof((int32_t[]){__VA_ARGS__}) / sizeof(int32_t),               \
               (int32_t[]){__VA_ARGS__})

/* Skips the test when the reference data that lie beside a checkout are missing. */
static inline void need_shared(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file) {
        fclose(file);
        return;
    }
    printf("skipped: no shared data\n");
    skip();
}

#endif
