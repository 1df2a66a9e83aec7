/* Fuzz target: the readers of Abaqus and CalculiX files (.inp): the whole deck, and the mesh alone.
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "model/format/mesh_io.h"
#include "model/model.h"

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
    lar_model *model = NULL;
    (void)lar_inp_is_deck(&bytes);
    if (lar_inp_deck_parse("fuzz.inp", &bytes, &model, &error) == LAR_OK) lar_model_destroy(model);
    lar_bytes_free(&bytes);
    return 0;
}
