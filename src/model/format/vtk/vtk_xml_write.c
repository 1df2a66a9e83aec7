#include "model/format/vtk/vtk_xml_write.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "model/format/vtk/vtk_scalar.h"

enum { BLOCK = 32768, LEVEL = 1, LEVEL_SMALL = 6 };

lar_status lar_part_attribute(lar_part_file *out, const char *text) {
    lar_status status = LAR_OK;
    for (const char *c = text; *c && !status; c++) {
        const char *escaped = *c == '&'   ? "&amp;"
                              : *c == '<' ? "&lt;"
                              : *c == '"' ? "&quot;"
                                          : NULL;
        char plain = (unsigned char)*c < ' ' ? '?' : *c;
        status = escaped ? lar_part_write(out, escaped, strlen(escaped))
                         : lar_part_write(out, &plain, 1);
    }
    return status;
}

const char *lar_vtk_byte_order(void) {
    return lar_vtk_must_swap(true) ? "LittleEndian" : "BigEndian";
}

/* ---- arrays and their compressed bytes -------------------------------------------------- */

static void writer_clear(lar_vtk_writer *w) {
    for (size_t i = 0; i < w->count; i++) {
        free(w->array[i].name);
        free(w->array[i].owned);
    }
    free(w->array);
    free(w->packed);
}

lar_status lar_vtk_writer_add(lar_vtk_writer *w, char *name, lar_vtk_out_array array) {
    array.name = name;
    if (!name || !LAR_GROW(w->array, w->capacity, w->count)) {
        free(name);
        free(array.owned);
        return lar_fail_memory(w->error, sizeof array, w->out.path);
    }
    w->array[w->count++] = array;
    return LAR_OK;
}

lar_status lar_vtk_writer_add_ends(lar_vtk_writer *w, const char *where, size_t cells,
                                   int corners) {
    int64_t *ends = lar_calloc(cells, sizeof *ends);
    if (!ends) return lar_fail_memory(w->error, cells * sizeof *ends, w->out.path);
    for (size_t c = 0; c < cells; c++) ends[c] = corners * ((int64_t)c + 1);
    lar_vtk_out_array array = lar_vtk_array(where, "Int64", 1, cells, sizeof *ends, ends);
    array.owned = ends;
    return lar_vtk_writer_add(w, lar_strdup("offsets"), array);
}

static lar_status reserve_packed(lar_vtk_writer *w, size_t more) {
    if (w->packed_capacity - w->packed_size >= more) return LAR_OK;
    size_t wanted = w->packed_capacity * 2 + more;
    unsigned char *grown = realloc(w->packed, wanted);
    if (!grown) return lar_fail_memory(w->error, wanted, w->out.path);
    w->packed = grown;
    w->packed_capacity = wanted;
    return LAR_OK;
}

/* Appends header and zlib blocks of one array. VTK wants all three words even for no blocks. */
static lar_status pack_array(lar_vtk_writer *w, lar_vtk_out_array *array) {
    size_t bytes = array->values * array->value_size;
    size_t blocks = bytes / BLOCK + (bytes % BLOCK != 0);
    size_t header = (3 + blocks) * sizeof(uint64_t);
    array->offset = w->packed_size;
    lar_status status = reserve_packed(w, header);
    if (status) return status;
    uint64_t words[3] = {blocks, BLOCK, bytes % BLOCK};
    memcpy(w->packed + array->offset, words, sizeof words);
    w->packed_size += header;
    for (size_t i = 0; i < blocks && !status; i++) {
        size_t from = i * BLOCK, size = bytes - from < BLOCK ? bytes - from : BLOCK;
        uLongf packed = compressBound(size);
        status = reserve_packed(w, packed);
        if (status) break;
        if (compress2(w->packed + w->packed_size, &packed, (const Bytef *)array->data + from, size,
                      w->small ? LEVEL_SMALL : LEVEL) != Z_OK)
            return lar_fail_memory(w->error, packed, w->out.path);
        uint64_t word = packed;
        memcpy(w->packed + array->offset + (3 + i) * sizeof word, &word, sizeof word);
        w->packed_size += packed;
    }
    return status;
}

/* ---- the file --------------------------------------------------------------------------- */

static const char field_data[] = "FieldData";

static lar_status print_arrays(lar_vtk_writer *w, const char *where) {
    lar_part_file *out = &w->out;
    bool any = false;
    for (size_t i = 0; i < w->count; i++) any = any || strcmp(w->array[i].where, where) == 0;
    if (!any) return LAR_OK;
    lar_status status = lar_part_print(out, "<%s>\n", where);
    for (size_t i = 0; i < w->count && !status; i++) {
        const lar_vtk_out_array *array = &w->array[i];
        if (strcmp(array->where, where) != 0) continue;
        status = lar_part_print(out, "<DataArray type=\"%s\" Name=\"", array->type);
        if (!status) status = lar_part_attribute(out, array->name);
        if (!status && strcmp(where, field_data) == 0)
            status = lar_part_print(out, "\" NumberOfTuples=\"%zu", array->values);
        if (!status)
            status = lar_part_print(
                out, "\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%zu\"/>\n",
                array->components, array->offset);
    }
    return status ? status : lar_part_print(out, "</%s>\n", where);
}

lar_status lar_vtk_writer_open(lar_vtk_writer *w, const char *path, lar_error *error) {
    *w = (lar_vtk_writer){.error = error};
    return lar_part_open(&w->out, path, error);
}

lar_status lar_vtk_writer_print(lar_vtk_writer *w, const char *type, const char *attributes,
                                const char *const *elements) {
    lar_part_file *out = &w->out;
    lar_status status = LAR_OK;
    for (size_t i = 0; i < w->count && !status; i++) status = pack_array(w, &w->array[i]);
    if (!status)
        status = lar_part_print(out,
                                "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" "
                                "byte_order=\"%s\" header_type=\"UInt64\" "
                                "compressor=\"vtkZLibDataCompressor\">\n<%s>\n",
                                type, lar_vtk_byte_order(), type);
    if (!status) status = print_arrays(w, field_data);
    if (!status) status = lar_part_print(out, "<Piece%s>\n", attributes);
    for (; *elements && !status; elements++) status = print_arrays(w, *elements);
    if (!status)
        status = lar_part_print(out, "</Piece>\n</%s>\n<AppendedData encoding=\"raw\">\n_", type);
    if (!status) status = lar_part_write(out, w->packed, w->packed_size);
    return status ? status : lar_part_print(out, "\n</AppendedData>\n</VTKFile>\n");
}

lar_status lar_vtk_writer_close(lar_vtk_writer *w, lar_status status) {
    status = lar_part_close(&w->out, status);
    writer_clear(w);
    return status;
}
