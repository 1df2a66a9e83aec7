/* Fuzz target: the scene file. Meshes come from memory, so that no file is needed and none is
 * opened, whatever name the input gives. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../model/brick.h"
#include "model/scene/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    lar_bytes bytes = {malloc(size + 1), size};
    if (!bytes.data) return 0;
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    lar_model *model = NULL;
    lar_error error = {0};
    if (lar_scene_parse_with("fuzz.yaml", &bytes, brick_read, &model, &error) == LAR_OK)
        for (int i = 0; i < model->curve_count; i++) lar_curve_value(&model->curve[i], 0.05);
    lar_model_destroy(model);
    lar_bytes_free(&bytes);
    return 0;
}
