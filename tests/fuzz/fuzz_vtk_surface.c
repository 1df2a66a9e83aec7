/* Fuzz target: the reader of surfaces in legacy VTK files (.vtk). */
#include "fuzz/surface.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    return fuzz_surface(lar_vtk_surface_parse, "fuzz.vtk", data, size);
}
