/* Fuzzing of the FEBio reader: the whole deck, and the mesh alone. */
#include <stdlib.h>
#include <string.h>

#include "model/format/mesh_io.h"
#include "model/model.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    lar_bytes bytes = {malloc(size + 1), size};
    if (!bytes.data) return 0;
    if (size) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;

    lar_error error;
    lar_model *model = NULL;
    if (lar_feb_parse("fuzz.feb", &bytes, &model, &error) == LAR_OK) lar_model_destroy(model);
    lar_mesh mesh = {0};
    lar_status status = lar_feb_parse_mesh("fuzz.feb", &bytes, &mesh, &error);
    if (!status) status = lar_mesh_check(&mesh, &error);
    lar_mesh_clear(&mesh);
    free(bytes.data);
    return 0;
}
