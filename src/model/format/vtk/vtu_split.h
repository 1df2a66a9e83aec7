/* Cuts a .vtu file into its small XML part and the big payloads of its arrays.
 *
 *     <VTKFile ...>                          kept
 *       <DataArray ...>0.1 0.2 ...           text cut out, remembered with its place
 *       </DataArray>                         kept
 *       <AppendedData encoding="raw">        kept, closed at once
 *        _#$%^...                            everything behind "_" cut out
 *
 * Why: raw appended data is no XML at all; and a general XML parser limits the length of a text
 * (10 MB in libxml2, unless its protections are switched off altogether) and copies it. What is
 * left for the parser is a few kilobytes, and its protections stay on. Declarations (<!DOCTYPE,
 * <!ENTITY, <![CDATA[), which VTK never writes and bombs are made of, end the reading here.
 */
#ifndef LAR_MODEL_FORMAT_VTK_VTU_SPLIT_H
#define LAR_MODEL_FORMAT_VTK_VTU_SPLIT_H

#include "base/text.h"

typedef struct lar_vtu_payload {
    lar_span text; /* inside the file's bytes; at == NULL when the array has no text */
    int line;
} lar_vtu_payload;

typedef struct lar_vtu_split {
    char *xml;
    size_t xml_length, xml_capacity;
    size_t payload_count, payload_capacity;
    lar_vtu_payload *payload; /* one per <DataArray> or <Array>, in the order of the file */
    lar_span appended;        /* from behind the "_" to the end of the file */
} lar_vtu_split;

/* `path` is for messages; the result points into `bytes`. A failed split is cleared. */
lar_status lar_vtu_split_file(const char *path, const lar_bytes *bytes, lar_vtu_split *split,
                              lar_error *error);

/* Idempotent; a zeroed split is fine. */
void lar_vtu_split_clear(lar_vtu_split *split);

#endif
