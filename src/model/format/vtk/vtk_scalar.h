/* The scalar types of VTK files, XML and legacy, and their bytes as numbers.
 *
 * Both readers end up with bytes of a known type and byte order; everything behind them works
 * on double (coordinates) or int64_t (connectivity, tags, sets).
 */
#ifndef LAR_MODEL_FORMAT_VTK_VTK_SCALAR_H
#define LAR_MODEL_FORMAT_VTK_VTK_SCALAR_H

#include "base/text.h"

typedef enum lar_vtk_scalar {
    LAR_VTK_INT8,
    LAR_VTK_UINT8,
    LAR_VTK_INT16,
    LAR_VTK_UINT16,
    LAR_VTK_INT32,
    LAR_VTK_UINT32,
    LAR_VTK_INT64,
    LAR_VTK_UINT64,
    LAR_VTK_FLOAT32,
    LAR_VTK_FLOAT64,
    LAR_VTK_SCALAR_COUNT
} lar_vtk_scalar;

/* Bytes of one value: 1, 2, 4 or 8. */
size_t lar_vtk_scalar_size(lar_vtk_scalar type);

static inline bool lar_vtk_scalar_is_integer(lar_vtk_scalar type) {
    return type < LAR_VTK_FLOAT32;
}

/* The type by its name in XML files ("Int32", "Float64", ...). False when there is none. */
bool lar_vtk_scalar_from_xml(const char *name, lar_vtk_scalar *type);

/* The type by its name in legacy files ("int", "unsigned_char", "vtktypeint64", ...; any case).
 * False when there is none. */
bool lar_vtk_scalar_from_legacy(lar_span name, lar_vtk_scalar *type);

/* True when the bytes of a file in that order must be turned round on this machine. */
static inline bool lar_vtk_must_swap(bool file_is_big_endian) {
    const uint16_t probe = 1;
    bool machine_is_big_endian = *(const unsigned char *)&probe == 0;
    return file_is_big_endian != machine_is_big_endian;
}

/* `count` values of `type` at `bytes` (any alignment) as doubles. */
void lar_vtk_to_double(lar_vtk_scalar type, const unsigned char *bytes, bool swap, size_t count,
                       double *out);

/* The same as integers. False when a value does not fit an int64_t (only UInt64 can do that). The
 * type must be an integer. */
bool lar_vtk_to_int64(lar_vtk_scalar type, const unsigned char *bytes, bool swap, size_t count,
                      int64_t *out);

#endif
