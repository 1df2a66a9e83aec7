/* Fuzz target: the reader of surfaces in VTK XML files (.vtp). */
#include "fuzz/surface.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    return fuzz_surface(lar_vtp_parse, "fuzz.vtp", data, size);
}
