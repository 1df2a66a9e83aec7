/* Fuzz target: the reader of distribution files, against a mesh of eight cubes in a row. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "divide/distribution.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { ELEMENTS = 8 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int32_t element[ELEMENTS][8];
    for (int e = 0; e < ELEMENTS; e++)
        for (int a = 0; a < 8; a++) element[e][a] = 4 * e + a;
    lar_mesh mesh = {.node_count = 4 * ELEMENTS + 4, .element_count = ELEMENTS, .element = element};
    lar_bytes bytes = {malloc(size + 1), size};
    if (!bytes.data) return 0;
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    lar_distribution distribution = {0};
    lar_error error = {0};
    if (lar_distribution_parse("fuzz.dist", &bytes, &mesh, &distribution, &error) == LAR_OK) {
        int32_t count[LAR_GRID_MAX];
        lar_distribution_load(&distribution, count);
        for (int32_t p = 0; p < distribution.grid.count; p++)
            if (count[p] < 1) __builtin_trap();
    }
    lar_distribution_clear(&distribution);
    lar_bytes_free(&bytes);
    return 0;
}
