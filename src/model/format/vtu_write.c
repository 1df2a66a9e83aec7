/* Writer for VTK XML files: one .vtu per frame, one .pvd for the series.
 *
 *     <VTKFile ...> XML that names every array and its offset </VTKFile>
 *                   AppendedData: _[blocks][32768][last][compressed sizes...]zlib blocks ...
 *
 * One list of arrays drives both parts: compressing it gives the offsets, then the XML is printed
 * and the compressed bytes follow. Level 1 of zlib: results are mostly noise to it, and a frame
 * must not hold up the run.
 *
 * Files appear whole or not at all: written to PATH.part, renamed at the end. No fsync: a power
 * cut may cost the last frames, but not a run's speed. */
#include "model/format/mesh_io.h"

#include <errno.h>
#include <inttypes.h>
#include <locale.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "model/format/vtk_grid.h"
#include "model/format/vtk_scalar.h"

enum { BLOCK = 32768, LEVEL = 1, HEXAHEDRON = 12 };

/* ---- a file that appears whole --------------------------------------------------------- */

typedef struct part_file {
    const char *path;
    char *part;
    FILE *file;
    lar_error *error;
} part_file;

static lar_status part_failed(part_file *out, const char *verb, int cause) {
    return lar_fail(out->error, LAR_ERROR_IO,
                    "%s: cannot be %s: %s; check the folder, its permissions and the free space",
                    out->path, verb, strerror(cause));
}

static lar_status part_open(part_file *out, const char *path, lar_error *error) {
    static const char suffix[] = ".part";
    size_t length = strlen(path);
    *out = (part_file){.path = path, .error = error, .part = malloc(length + sizeof suffix)};
    if (!out->part) return lar_fail_memory(error, length + sizeof suffix, path);
    memcpy(out->part, path, length);
    memcpy(out->part + length, suffix, sizeof suffix);
    out->file = fopen(out->part, "wb");
    return out->file ? LAR_OK : part_failed(out, "opened for writing", errno);
}

/* Ends the writing: with LAR_OK so far the file gets its name, else nothing stays. Returns the
 * final status. */
static lar_status part_close(part_file *out, lar_status status) {
    if (out->file) {
        if (!status && fflush(out->file) != 0) status = part_failed(out, "written", errno);
        if (fclose(out->file) != 0 && !status) status = part_failed(out, "written", errno);
        if (!status && rename(out->part, out->path) != 0)
            status = part_failed(out, "given its name", errno);
        if (status) remove(out->part);
    }
    free(out->part);
    *out = (part_file){0};
    return status;
}

static lar_status part_write(part_file *out, const void *data, size_t size) {
    errno = 0;
    return fwrite(data, 1, size, out->file) == size
               ? LAR_OK
               : part_failed(out, "written", errno ? errno : EIO);
}

static lar_status part_print(part_file *out, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static lar_status part_print(part_file *out, const char *format, ...) {
    va_list args;
    va_start(args, format);
    errno = 0;
    int written = vfprintf(out->file, format, args);
    int cause = errno ? errno : EIO;
    va_end(args);
    return written >= 0 ? LAR_OK : part_failed(out, "written", cause);
}

/* A text inside an attribute's quotes. Control characters, which XML cannot hold, become '?'. */
static lar_status part_attribute(part_file *out, const char *text) {
    lar_status status = LAR_OK;
    for (const char *c = text; *c && !status; c++) {
        const char *escaped = *c == '&'   ? "&amp;"
                              : *c == '<' ? "&lt;"
                              : *c == '"' ? "&quot;"
                                          : NULL;
        char plain = (unsigned char)*c < ' ' ? '?' : *c;
        status = escaped ? part_write(out, escaped, strlen(escaped)) : part_write(out, &plain, 1);
    }
    return status;
}

static const char *byte_order(void) {
    return lar_vtk_must_swap(true) ? "LittleEndian" : "BigEndian";
}

/* ---- arrays and their compressed bytes -------------------------------------------------- */

typedef enum place { FIELD_DATA, POINT_DATA, CELL_DATA, POINTS, CELLS, PLACES } place;

static const char *const place_name[PLACES] = {"FieldData", "PointData", "CellData", "Points",
                                               "Cells"};

typedef struct out_array {
    place where;
    char *name;       /* owned */
    const char *type; /* VTK's */
    int components;
    size_t values, value_size;
    const void *data;
    void *owned; /* freed at the end; NULL when `data` belongs to the caller */
    size_t offset;
} out_array;

typedef struct writer {
    part_file out;
    lar_error *error;
    size_t count, capacity;
    out_array *array;
    unsigned char *packed;
    size_t packed_size, packed_capacity;
} writer;

static void writer_clear(writer *w) {
    for (size_t i = 0; i < w->count; i++) {
        free(w->array[i].name);
        free(w->array[i].owned);
    }
    free(w->array);
    free(w->packed);
}

/* Takes ownership of `name` and array.owned, also on failure. */
static lar_status add_array(writer *w, char *name, out_array array) {
    array.name = name;
    if (!name || !LAR_GROW(w->array, w->capacity, w->count)) {
        free(name);
        free(array.owned);
        return lar_fail_memory(w->error, sizeof array, w->out.path);
    }
    w->array[w->count++] = array;
    return LAR_OK;
}

static lar_status reserve_packed(writer *w, size_t more) {
    if (w->packed_capacity - w->packed_size >= more) return LAR_OK;
    size_t wanted = w->packed_capacity * 2 + more;
    unsigned char *grown = realloc(w->packed, wanted);
    if (!grown) return lar_fail_memory(w->error, wanted, w->out.path);
    w->packed = grown;
    w->packed_capacity = wanted;
    return LAR_OK;
}

/* Appends header and zlib blocks of one array. VTK wants all three words even for no blocks. */
static lar_status pack_array(writer *w, out_array *array) {
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
                      LEVEL) != Z_OK)
            return lar_fail_memory(w->error, packed, w->out.path);
        uint64_t word = packed;
        memcpy(w->packed + array->offset + (3 + i) * sizeof word, &word, sizeof word);
        w->packed_size += packed;
    }
    return status;
}

/* ---- what a frame holds ----------------------------------------------------------------- */

static lar_status collect_sets(writer *w, const lar_mesh *mesh) {
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < mesh->set_count && !status; i++) {
        const lar_set *set = &mesh->set[i];
        status = add_array(w, lar_vtk_encode_name(lar_vtk_set_prefix[set->kind], set->name),
                           (out_array){.where = FIELD_DATA,
                                       .type = "Int32",
                                       .components = 1,
                                       .values = (size_t)set->count,
                                       .value_size = sizeof *set->index,
                                       .data = set->index});
    }
    return status;
}

static lar_status collect_results(writer *w, place where, const lar_vtu_array *arrays, int count,
                                  int32_t tuples) {
    lar_status status = LAR_OK;
    for (int i = 0; i < count && !status; i++)
        status = add_array(w, lar_strdup(arrays[i].name),
                           (out_array){.where = where,
                                       .type = "Float64",
                                       .components = arrays[i].components,
                                       .values = (size_t)tuples * (size_t)arrays[i].components,
                                       .value_size = sizeof(double),
                                       .data = arrays[i].values});
    return status;
}

static lar_status collect_cells(writer *w, const lar_mesh *mesh) {
    size_t elements = (size_t)mesh->element_count;
    lar_status status = add_array(w, lar_strdup("connectivity"),
                                  (out_array){.where = CELLS,
                                              .type = "Int32",
                                              .components = 1,
                                              .values = elements * 8,
                                              .value_size = sizeof(int32_t),
                                              .data = mesh->element});
    if (status) return status;
    int64_t *ends = lar_calloc(elements, sizeof *ends);
    unsigned char *types = lar_calloc(elements, 1);
    if (!ends || !types) {
        free(ends);
        free(types);
        return lar_fail_memory(w->error, elements * sizeof *ends, w->out.path);
    }
    for (size_t e = 0; e < elements; e++) ends[e] = (int64_t)(e + 1) * 8;
    memset(types, HEXAHEDRON, elements);
    out_array offsets = {.where = CELLS,
                         .type = "Int64",
                         .components = 1,
                         .values = elements,
                         .value_size = sizeof *ends,
                         .data = ends,
                         .owned = ends};
    out_array kinds = {.where = CELLS,
                       .type = "UInt8",
                       .components = 1,
                       .values = elements,
                       .value_size = 1,
                       .data = types,
                       .owned = types};
    status = add_array(w, lar_strdup("offsets"), offsets);
    if (status) {
        free(types);
        return status;
    }
    return add_array(w, lar_strdup("types"), kinds);
}

static lar_status collect_frame(writer *w, const lar_vtu_frame *frame) {
    const lar_mesh *mesh = frame->mesh;
    const void *position =
        frame->position ? (const void *)frame->position : (const void *)mesh->position;
    lar_status status = add_array(w, lar_strdup("TimeValue"),
                                  (out_array){.where = FIELD_DATA,
                                              .type = "Float64",
                                              .components = 1,
                                              .values = 1,
                                              .value_size = sizeof frame->time,
                                              .data = &frame->time});
    if (!status) status = collect_sets(w, mesh);
    if (!status)
        status = collect_results(w, POINT_DATA, frame->point_array, frame->point_array_count,
                                 mesh->node_count);
    if (!status && mesh->element_tag)
        status = add_array(w, lar_strdup("tag"),
                           (out_array){.where = CELL_DATA,
                                       .type = "Int32",
                                       .components = 1,
                                       .values = (size_t)mesh->element_count,
                                       .value_size = sizeof *mesh->element_tag,
                                       .data = mesh->element_tag});
    if (!status)
        status = collect_results(w, CELL_DATA, frame->cell_array, frame->cell_array_count,
                                 mesh->element_count);
    if (!status)
        status = add_array(w, lar_strdup("Points"),
                           (out_array){.where = POINTS,
                                       .type = "Float64",
                                       .components = 3,
                                       .values = (size_t)mesh->node_count * 3,
                                       .value_size = sizeof(double),
                                       .data = position});
    return status ? status : collect_cells(w, mesh);
}

/* ---- the file --------------------------------------------------------------------------- */

static lar_status print_arrays(writer *w, place where) {
    part_file *out = &w->out;
    lar_status status = part_print(out, "<%s>\n", place_name[where]);
    for (size_t i = 0; i < w->count && !status; i++) {
        const out_array *array = &w->array[i];
        if (array->where != where) continue;
        status = part_print(out, "<DataArray type=\"%s\" Name=\"", array->type);
        if (!status) status = part_attribute(out, array->name);
        if (!status && where == FIELD_DATA)
            status = part_print(out, "\" NumberOfTuples=\"%zu", array->values);
        if (!status)
            status = part_print(
                out, "\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%zu\"/>\n",
                array->components, array->offset);
    }
    return status ? status : part_print(out, "</%s>\n", place_name[where]);
}

static lar_status print_file(writer *w, const lar_mesh *mesh) {
    part_file *out = &w->out;
    lar_status status =
        part_print(out,
                   "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                   "byte_order=\"%s\" header_type=\"UInt64\" "
                   "compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n",
                   byte_order());
    if (!status) status = print_arrays(w, FIELD_DATA);
    if (!status)
        status = part_print(
            out, "<Piece NumberOfPoints=\"%" PRId32 "\" NumberOfCells=\"%" PRId32 "\">\n",
            mesh->node_count, mesh->element_count);
    for (int where = POINT_DATA; where < PLACES && !status; where++)
        status = print_arrays(w, (place)where);
    if (!status)
        status =
            part_print(out, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
    if (!status) status = part_write(out, w->packed, w->packed_size);
    return status ? status : part_print(out, "\n</AppendedData>\n</VTKFile>\n");
}

lar_status lar_vtu_write(const char *path, const lar_vtu_frame *frame, lar_error *error) {
    writer w = {.error = error};
    lar_status status = part_open(&w.out, path, error);
    if (!status) status = collect_frame(&w, frame);
    for (size_t i = 0; i < w.count && !status; i++) status = pack_array(&w, &w.array[i]);
    if (!status) status = print_file(&w, frame->mesh);
    status = part_close(&w.out, status);
    writer_clear(&w);
    return status;
}

lar_status lar_pvd_write(const char *path, const char *const *files, const double *times, int count,
                         lar_error *error) {
    /* Times are printed with a point, whatever the program's locale is. */
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c_locale) return lar_fail_memory(error, sizeof c_locale, path);
    locale_t before = uselocale(c_locale);
    part_file out;
    lar_status status = part_open(&out, path, error);
    if (!status)
        status = part_print(&out,
                            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
                            "byte_order=\"%s\">\n<Collection>\n",
                            byte_order());
    for (int i = 0; i < count && !status; i++) {
        status = part_print(&out, "<DataSet timestep=\"%.17g\" part=\"0\" file=\"", times[i]);
        if (!status) status = part_attribute(&out, files[i]);
        if (!status) status = part_print(&out, "\"/>\n");
    }
    if (!status) status = part_print(&out, "</Collection>\n</VTKFile>\n");
    status = part_close(&out, status);
    uselocale(before);
    freelocale(c_locale);
    return status;
}
