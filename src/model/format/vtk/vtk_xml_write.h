/* Writing VTK XML files.
 *
 *     <VTKFile ...> XML that names every array and its offset
 *                   AppendedData: _[blocks][32768][last][compressed sizes...]zlib blocks ...
 *
 * One list of arrays drives both parts: compressing it gives the offsets, then the XML is printed
 * and the compressed bytes follow. Level 1 of zlib: results are mostly noise to it, and a frame
 * must not hold up the run.
 *
 * Files appear whole or not at all: written to PATH.part, renamed at the end. No fsync: a power
 * cut may cost the last frames, but not a run's speed.
 */
#ifndef LAR_MODEL_FORMAT_VTK_VTK_XML_WRITE_H
#define LAR_MODEL_FORMAT_VTK_VTK_XML_WRITE_H

#include <stdio.h>

#include "base/memory.h"

/* ---- a file that appears whole ------------------------------------------------------------- */

typedef struct lar_part_file {
    const char *path;
    char *part;
    FILE *file;
    lar_error *error;
} lar_part_file;

lar_status lar_part_open(lar_part_file *out, const char *path, lar_error *error);

/* Ends the writing: with LAR_OK so far the file gets its name, else nothing stays; also when
 * something was written to out->file past the functions below and has failed. Returns the final
 * status. */
lar_status lar_part_close(lar_part_file *out, lar_status status);

lar_status lar_part_write(lar_part_file *out, const void *data, size_t size);
lar_status lar_part_print(lar_part_file *out, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

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

/* Prints the file: field data, then one piece with these attributes (" NumberOfPoints=...") and
 * the other elements, in this order, NULL at the end; an element without arrays is left out. */
lar_status lar_vtk_writer_print(lar_vtk_writer *writer, const char *type, const char *attributes,
                                const char *const *elements);

/* Gives the file its name, or removes it; frees. Returns the final status. */
lar_status lar_vtk_writer_close(lar_vtk_writer *writer, lar_status status);

#endif
