/* Writing VTK XML files.
 *
 *     <VTKFile ...> XML that names every array and its offset
 *                   AppendedData: _[blocks][32768][last][compressed sizes...]zlib blocks ...
 *
 * One list of arrays drives both parts: compressing it gives the offsets, then the XML is printed
 * and the compressed bytes follow. Level 1 of zlib: results are mostly noise to it, and a frame
 * must not hold up the run.
 */
#ifndef LAR_MODEL_FORMAT_VTK_VTK_XML_WRITE_H
#define LAR_MODEL_FORMAT_VTK_VTK_XML_WRITE_H

#include <stdbool.h>

#include "base/file/part_file.h"

/* A text inside an attribute's quotes. Control characters, which XML cannot hold, become '?'. */
lar_status lar_part_attribute(lar_part_file *out, const char *text);

/* "LittleEndian" or "BigEndian": this machine. */
const char *lar_vtk_byte_order(void);

/* ---- arrays -------------------------------------------------------------------------------- */

typedef struct lar_vtk_out_array {
    const char *where; /* the element that it stands in: "Points", "CellData", ... */
    char *name;        /* owned */
    const char *type;  /* VTK's */
    int components;
    size_t values, value_size;
    const void *data;
    void *owned; /* freed at the end; NULL when `data` belongs to the caller */
    size_t offset;
} lar_vtk_out_array;

/* Of numbers that are the caller's. */
static inline lar_vtk_out_array lar_vtk_array(const char *where, const char *type, int components,
                                              size_t tuples, size_t value_size, const void *data) {
    return (lar_vtk_out_array){.where = where,
                               .type = type,
                               .components = components,
                               .values = tuples * (size_t)components,
                               .value_size = value_size,
                               .data = data};
}

typedef struct lar_vtk_writer {
    lar_part_file out;
    lar_error *error;
    size_t count, capacity;
    lar_vtk_out_array *array;
    unsigned char *packed;
    size_t packed_size, packed_capacity;
    bool small; /* compressed more, which takes longer */
} lar_vtk_writer;

lar_status lar_vtk_writer_open(lar_vtk_writer *writer, const char *path, lar_error *error);

/* Takes ownership of `name` and array.owned, also on failure. */
lar_status lar_vtk_writer_add(lar_vtk_writer *writer, char *name, lar_vtk_out_array array);

/* The array "offsets": where the corners of each of `cells` cells end, `corners` of each. */
lar_status lar_vtk_writer_add_ends(lar_vtk_writer *writer, const char *where, size_t cells,
                                   int corners);

/* Prints the file: field data, then one piece with these attributes (" NumberOfPoints=...") and
 * the other elements, in this order, NULL at the end; an element without arrays is left out. */
lar_status lar_vtk_writer_print(lar_vtk_writer *writer, const char *type, const char *attributes,
                                const char *const *elements);

/* Gives the file its name, or removes it; frees. Returns the final status. */
lar_status lar_vtk_writer_close(lar_vtk_writer *writer, lar_status status);

#endif
