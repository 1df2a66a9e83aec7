/* Fuzz target: the reader of OBJ surfaces (.obj). */
#include "fuzz/surface.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    return fuzz_surface(lar_obj_parse, "fuzz.obj", data, size);
}
