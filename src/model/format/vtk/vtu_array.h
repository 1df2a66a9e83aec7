/* The payload of one DataArray of a .vtu file, from characters or bytes to numbers.
 *
 *     format="ascii"      numbers as text
 *     format="binary"     base64 text       \   of   [size] bytes                (plain)
 *     format="appended"   base64 or raw      }  or   [blocks][block][last][compressed sizes...]
 *                         in AppendedData   /        zlib blocks                 (compressed)
 *
 * The words in brackets are header_type wide and in the file's byte order. In base64 the header
 * of compressed data is a stream of its own, padded with '='; some writers do the same for plain
 * data. The decoder takes padding anywhere at the end of a group of four and goes on, so both
 * read the same.
 *
 * Sizes: the number of values follows from the file's own claims (points, cells). Before anything
 * is allocated for it, the claim must be plausible for the bytes that are there: at least two
 * characters per ascii value, the full size for plain data, and at most 1032 bytes out of one
 * byte of zlib (the limit of deflate, RFC 1951: 258 bytes from a quarter byte).
 */
#ifndef LAR_MODEL_FORMAT_VTK_VTU_ARRAY_H
#define LAR_MODEL_FORMAT_VTK_VTU_ARRAY_H

#include "model/format/vtk/vtk_scalar.h"

typedef struct lar_vtu_array_text {
    const char *path; /* for messages */
    const char *name; /* the array's name, for messages */
    int line;         /* of its tag, for messages */
    lar_vtk_scalar type;
    enum { LAR_VTU_ASCII, LAR_VTU_BASE64, LAR_VTU_RAW } encoding;
    bool compressed, header64, swap;
    lar_span payload; /* where appended, other arrays' bytes may follow */
    bool appended;
} lar_vtu_array_text;

/* Reads exactly `count` values as doubles; the caller frees *out. */
lar_status lar_vtu_array_doubles(const lar_vtu_array_text *array, size_t count, double **out,
                                 lar_error *error);

/* The same as integers; refuses arrays of floating point type and values beyond int64. */
lar_status lar_vtu_array_integers(const lar_vtu_array_text *array, size_t count, int64_t **out,
                                  lar_error *error);

/* The number of values of an array that does not say it (field data). 0 for damaged ones, which
 * then fail when they are read. */
size_t lar_vtu_array_count(const lar_vtu_array_text *array);

#endif
