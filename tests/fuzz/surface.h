/* What the fuzz targets of surfaces do with their bytes: read, join, close, look for crossings. */
#ifndef LAR_TESTS_FUZZ_SURFACE_H
#define LAR_TESTS_FUZZ_SURFACE_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "model/triangles/triangles.h"

typedef lar_status surface_parser(const char *path, const lar_bytes *bytes,
                                  lar_triangles *triangles, lar_error *error);

static inline int fuzz_surface(surface_parser *parse, const char *path, const uint8_t *data,
                               size_t size) {
    enum { FEW = 300 }; /* the time to compare pairs grows with the square */
    lar_bytes bytes = {malloc(size + 1), size};
    if (!bytes.data) return 0;
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    lar_triangles triangles = {0};
    lar_error error = {0};
    lar_crossings crossings;
    if (!parse(path, &bytes, &triangles, &error) && !lar_triangles_join(&triangles, &error)) {
        lar_triangles_close(&triangles, NULL, &error);
        if (triangles.triangle_count < FEW)
            lar_triangles_find_crossings(&triangles, &crossings, &error);
    }
    lar_triangles_clear(&triangles);
    lar_bytes_free(&bytes);
    return 0;
}

#endif
