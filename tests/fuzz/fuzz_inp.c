/* Fuzz target: the reader of Abaqus and CalculiX input files (.inp). */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "model/format/mesh_io.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    lar_bytes bytes = {malloc(size + 1), size};
    if (!bytes.data) return 0;
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    lar_mesh mesh = {0};
    lar_error error = {0};
    if (lar_inp_parse("fuzz.inp", &bytes, &mesh, &error) == LAR_OK) lar_mesh_check(&mesh, &error);
    lar_mesh_clear(&mesh);
    lar_bytes_free(&bytes);
    return 0;
}
