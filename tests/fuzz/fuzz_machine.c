/* Fuzz target: the reader of machines for lariat predict. What it accepts can be computed with. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "study/predict/cluster.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    lar_bytes bytes = {malloc(size + 1), size};
    if (!bytes.data) return 0;
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    lar_cluster machine;
    lar_error error = {0};
    if (lar_cluster_parse("fuzz.machine", &bytes, &machine, &error) == LAR_OK) {
        double alone = lar_cluster_alone(&machine, 1e6, 1e6);
        if (!isfinite(alone) || alone <= 0) __builtin_trap();
    } else if (!*error.message) {
        __builtin_trap();
    }
    lar_bytes_free(&bytes);
    return 0;
}
