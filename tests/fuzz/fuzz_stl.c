/* Fuzz target: the reader of STL surfaces (.stl). */
#include "fuzz/surface.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    return fuzz_surface(lar_stl_parse, "fuzz.stl", data, size);
}
