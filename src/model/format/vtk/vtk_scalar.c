#include "model/format/vtk/vtk_scalar.h"

#include <string.h>

static const struct {
    const char *xml;
    size_t size;
} scalars[LAR_VTK_SCALAR_COUNT] = {
    [LAR_VTK_INT8] = {"Int8", 1},       [LAR_VTK_UINT8] = {"UInt8", 1},
    [LAR_VTK_INT16] = {"Int16", 2},     [LAR_VTK_UINT16] = {"UInt16", 2},
    [LAR_VTK_INT32] = {"Int32", 4},     [LAR_VTK_UINT32] = {"UInt32", 4},
    [LAR_VTK_INT64] = {"Int64", 8},     [LAR_VTK_UINT64] = {"UInt64", 8},
    [LAR_VTK_FLOAT32] = {"Float32", 4}, [LAR_VTK_FLOAT64] = {"Float64", 8},
};

/* vtkIdType is stored in legacy files as a 32-bit int; long as the 64 bits of today's systems. */
static const struct {
    const char *name;
    lar_vtk_scalar type;
} legacy_names[] = {
    {"char", LAR_VTK_INT8},
    {"signed_char", LAR_VTK_INT8},
    {"unsigned_char", LAR_VTK_UINT8},
    {"short", LAR_VTK_INT16},
    {"unsigned_short", LAR_VTK_UINT16},
    {"int", LAR_VTK_INT32},
    {"unsigned_int", LAR_VTK_UINT32},
    {"vtkidtype", LAR_VTK_INT32},
    {"long", LAR_VTK_INT64},
    {"unsigned_long", LAR_VTK_UINT64},
    {"long_long", LAR_VTK_INT64},
    {"unsigned_long_long", LAR_VTK_UINT64},
    {"vtktypeint64", LAR_VTK_INT64},
    {"vtktypeuint64", LAR_VTK_UINT64},
    {"float", LAR_VTK_FLOAT32},
    {"double", LAR_VTK_FLOAT64},
};

size_t lar_vtk_scalar_size(lar_vtk_scalar type) {
    return scalars[type].size;
}

bool lar_vtk_scalar_from_xml(const char *name, lar_vtk_scalar *type) {
    for (int i = 0; i < LAR_VTK_SCALAR_COUNT; i++)
        if (strcmp(scalars[i].xml, name) == 0) {
            *type = (lar_vtk_scalar)i;
            return true;
        }
    return false;
}

bool lar_vtk_scalar_from_legacy(lar_span name, lar_vtk_scalar *type) {
    for (size_t i = 0; i < sizeof legacy_names / sizeof *legacy_names; i++)
        if (lar_span_equal_nocase(name, legacy_names[i].name)) {
            *type = legacy_names[i].type;
            return true;
        }
    return false;
}

/* The `size` bytes at `bytes` as the low bytes of an unsigned integer of this machine. */
static uint64_t load(const unsigned char *bytes, size_t size, bool swap) {
    uint16_t two;
    uint32_t four;
    uint64_t eight;
    switch (size) {
    case 1:
        return bytes[0];
    case 2:
        memcpy(&two, bytes, sizeof two);
        return swap ? __builtin_bswap16(two) : two;
    case 4:
        memcpy(&four, bytes, sizeof four);
        return swap ? __builtin_bswap32(four) : four;
    default:
        memcpy(&eight, bytes, sizeof eight);
        return swap ? __builtin_bswap64(eight) : eight;
    }
}

static int64_t as_integer(lar_vtk_scalar type, uint64_t bits) {
    switch (type) {
    case LAR_VTK_INT8:
        return (int8_t)bits;
    case LAR_VTK_INT16:
        return (int16_t)bits;
    case LAR_VTK_INT32:
        return (int32_t)bits;
    default:
        return (int64_t)bits;
    }
}

static double as_double(lar_vtk_scalar type, uint64_t bits) {
    if (type == LAR_VTK_FLOAT64) {
        double value;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    if (type == LAR_VTK_FLOAT32) {
        uint32_t low = (uint32_t)bits;
        float value;
        memcpy(&value, &low, sizeof value);
        return value;
    }
    if (type == LAR_VTK_UINT64) return (double)bits;
    return (double)as_integer(type, bits);
}

void lar_vtk_to_double(lar_vtk_scalar type, const unsigned char *bytes, bool swap, size_t count,
                       double *out) {
    size_t size = scalars[type].size;
    for (size_t i = 0; i < count; i++) out[i] = as_double(type, load(bytes + i * size, size, swap));
}

bool lar_vtk_to_int64(lar_vtk_scalar type, const unsigned char *bytes, bool swap, size_t count,
                      int64_t *out) {
    size_t size = scalars[type].size;
    for (size_t i = 0; i < count; i++) {
        uint64_t bits = load(bytes + i * size, size, swap);
        if (type == LAR_VTK_UINT64 && bits > INT64_MAX) return false;
        out[i] = as_integer(type, bits);
    }
    return true;
}
