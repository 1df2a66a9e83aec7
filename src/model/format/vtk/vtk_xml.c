#include "model/format/vtk/vtk_xml.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <libxml/parser.h>

#include "model/format/vtk/vtu_array.h"
#include "model/format/xml_guard.h"

static const char *attribute(const xmlNode *node, const char *name) {
    const xmlAttr *found = xmlHasProp(node, (const xmlChar *)name);
    if (!found || !found->children || found->children->next ||
        found->children->type != XML_TEXT_NODE || !found->children->content)
        return NULL;
    return (const char *)found->children->content;
}

static bool is_element(const xmlNode *node, const char *name) {
    return node->type == XML_ELEMENT_NODE && strcmp((const char *)node->name, name) == 0;
}

/* First child element of that name at or behind `node`. */
static xmlNode *find_element(xmlNode *node, const char *name) {
    while (node && !is_element(node, name)) node = node->next;
    return node;
}

xmlNode *lar_vtk_xml_child(xmlNode *node, const char *name) {
    return node ? find_element(node->children, name) : NULL;
}

static lar_status parse_xml(lar_vtk_xml *file) {
    xmlInitParser();
    lar_xml_guard guard;
    lar_xml_guard_begin(&guard);
    xmlParserCtxt *context = xmlNewParserCtxt();
    if (!context) {
        lar_xml_guard_end(&guard);
        return lar_fail_memory(file->error, sizeof *context, file->path);
    }
    /* No entity substitution, no network, and without XML_PARSE_HUGE the limits stay on. */
    file->document = xmlCtxtReadMemory(context, file->split.xml ? file->split.xml : "",
                                       (int)file->split.xml_length, NULL, NULL,
                                       XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING);
    lar_status status = LAR_OK;
    if (lar_xml_guard_end(&guard)) {
        status = lar_fail_memory(file->error, file->split.xml_length, file->path);
    } else if (!file->document) {
        const char *message =
            context->lastError.message ? context->lastError.message : "no XML element found";
        int length = (int)strcspn(message, "\n");
        status =
            lar_fail(file->error, LAR_ERROR_FORMAT,
                     "%s:%d: the XML of the file is damaged (%.*s); write the file again",
                     file->path, context->lastError.line, length < 200 ? length : 200, message);
    }
    xmlFreeParserCtxt(context);
    if (!status && file->document->intSubset)
        status = lar_fail(file->error, LAR_ERROR_FORMAT,
                          "%s: a document type has no place in a VTK file; remove it", file->path);
    return status;
}

/* Hangs every payload on its element, in the order of the file. */
static size_t attach_payloads(lar_vtk_xml *file, xmlNode *node, size_t next) {
    for (; node; node = node->next) {
        if (is_element(node, "DataArray") || is_element(node, "Array")) {
            if (next < file->split.payload_count) node->_private = &file->split.payload[next];
            next++;
        }
        if (node->type == XML_ELEMENT_NODE) next = attach_payloads(file, node->children, next);
    }
    return next;
}

static lar_status refuse_kind(const lar_vtk_xml *file, const char *what, const char *found,
                              const char *remedy) {
    return lar_fail(file->error, LAR_ERROR_UNSUPPORTED, "%s: %s is \"%.80s\"; %s", file->path, what,
                    found, remedy);
}

/* byte_order, header_type and compressor of the file, encoding of its appended data. */
static lar_status read_encoding(lar_vtk_xml *file, xmlNode *root) {
    const char *order = attribute(root, "byte_order");
    bool big = order && strcmp(order, "BigEndian") == 0;
    if (order && !big && strcmp(order, "LittleEndian") != 0)
        return refuse_kind(file, "byte_order", order, "it must be LittleEndian or BigEndian");
    file->swap = lar_vtk_must_swap(big);
    const char *header = attribute(root, "header_type");
    file->header64 = header && strcmp(header, "UInt64") == 0;
    if (header && !file->header64 && strcmp(header, "UInt32") != 0)
        return refuse_kind(file, "header_type", header, "it must be UInt32 or UInt64");
    const char *compressor = attribute(root, "compressor");
    file->compressed = compressor && compressor[0];
    if (file->compressed && strcmp(compressor, "vtkZLibDataCompressor") != 0)
        return refuse_kind(file, "the compressor", compressor,
                           "Lariat reads zlib; save the file with zlib or without compression");
    xmlNode *appended = lar_vtk_xml_child(root, "AppendedData");
    const char *encoding = appended ? attribute(appended, "encoding") : NULL;
    file->appended_raw = encoding && strcmp(encoding, "raw") == 0;
    if (encoding && !file->appended_raw && strcmp(encoding, "base64") != 0)
        return refuse_kind(file, "the encoding of AppendedData", encoding,
                           "it must be raw or base64");
    return LAR_OK;
}

static lar_status find_piece(const lar_vtk_xml *file, xmlNode *dataset, xmlNode **piece) {
    *piece = lar_vtk_xml_child(dataset, "Piece");
    if (!*piece)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s: the element Piece is missing; write the file again", file->path);
    if (find_element((*piece)->next, "Piece"))
        return lar_fail(file->error, LAR_ERROR_UNSUPPORTED,
                        "%s: the grid comes in several pieces, whose common points are there "
                        "twice; join them first (ParaView: Merge Blocks, then Clean to Grid)",
                        file->path);
    return LAR_OK;
}

static lar_status read_root(lar_vtk_xml *file, const char *type, const char *remedy,
                            xmlNode **dataset) {
    xmlNode *root = xmlDocGetRootElement(file->document);
    if (!root || !is_element(root, "VTKFile"))
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s: the outermost XML element is not VTKFile, so this is no VTK file; "
                        "check the file or its extension",
                        file->path);
    const char *found = attribute(root, "type");
    if (!found || strcmp(found, type) != 0)
        return refuse_kind(file, "the type of the VTK file", found ? found : "", remedy);
    lar_status status = read_encoding(file, root);
    if (status) return status;
    *dataset = lar_vtk_xml_child(root, type);
    if (*dataset) return LAR_OK;
    return lar_fail(file->error, LAR_ERROR_FORMAT,
                    "%s: the element %s is missing; write the file again", file->path, type);
}

lar_status lar_vtk_xml_open(lar_vtk_xml *file, const lar_bytes *bytes, const char *type,
                            const char *remedy, xmlNode **dataset, xmlNode **piece) {
    lar_status status = lar_vtu_split_file(file->path, bytes, &file->split, file->error);
    if (!status) status = parse_xml(file);
    if (!status &&
        attach_payloads(file, xmlDocGetRootElement(file->document), 0) != file->split.payload_count)
        status = lar_fail(file->error, LAR_ERROR_FORMAT,
                          "%s: the XML tags of the arrays are damaged; write the file again",
                          file->path);
    if (!status) status = read_root(file, type, remedy, dataset);
    return status ? status : find_piece(file, *dataset, piece);
}

void lar_vtk_xml_close(lar_vtk_xml *file) {
    lar_vtu_split_clear(&file->split);
    if (file->document) xmlFreeDoc(file->document);
    file->document = NULL;
}

static bool parse_count(const char *text, int64_t *value) {
    return text && lar_span_int64(lar_span_trim((lar_span){text, strlen(text)}), value) &&
           *value >= 0;
}

/* Where the payload of an array is and how to read it. */
static lar_status describe_array(const lar_vtk_xml *file, const xmlNode *node,
                                 lar_vtu_array_text *array) {
    const lar_vtu_payload *payload = node->_private;
    const char *name = attribute(node, "Name"), *type = attribute(node, "type");
    const char *format = attribute(node, "format");
    *array = (lar_vtu_array_text){.path = file->path,
                                  .name = name ? name : "",
                                  .line = payload ? payload->line : 0,
                                  .compressed = file->compressed,
                                  .header64 = file->header64,
                                  .swap = file->swap};
    if (!type || !lar_vtk_scalar_from_xml(type, &array->type))
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:%d: the type of array \"%s\" is \"%.40s\", none that VTK knows; write "
                        "it as Float64 or Int64",
                        file->path, array->line, array->name, type ? type : "");
    if (payload) array->payload = payload->text;
    if (!format || strcmp(format, "ascii") == 0) return LAR_OK;
    array->encoding = LAR_VTU_BASE64;
    if (strcmp(format, "binary") == 0) return LAR_OK;
    if (strcmp(format, "appended") != 0)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:%d: the format of array \"%s\" is \"%.40s\", but must be ascii, binary "
                        "or appended; write the file again",
                        file->path, array->line, array->name, format);
    int64_t offset;
    if (!parse_count(attribute(node, "offset"), &offset) ||
        (uint64_t)offset > file->split.appended.length)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s:%d: the offset of array \"%s\" does not lie in the %zu bytes of "
                        "appended data; the file is damaged or cut short, write it again",
                        file->path, array->line, array->name, file->split.appended.length);
    array->appended = true;
    if (file->appended_raw) array->encoding = LAR_VTU_RAW;
    const lar_span *appended = &file->split.appended;
    array->payload = appended->at
                         ? (lar_span){appended->at + offset, appended->length - (size_t)offset}
                         : (lar_span){NULL, 0};
    return LAR_OK;
}

/* Components of an array; 1 when it does not say. */
static int64_t components(const xmlNode *node) {
    const char *text = attribute(node, "NumberOfComponents");
    int64_t count = 1;
    return !text || !text[0] || parse_count(text, &count) ? (count > 0 ? count : 1) : -1;
}

lar_status lar_vtk_xml_points(const lar_vtk_xml *file, xmlNode *piece, lar_vtk_grid *grid) {
    xmlNode *node = lar_vtk_xml_child(lar_vtk_xml_child(piece, "Points"), "DataArray");
    if (!node)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s: the piece has no Points array; write the file again", file->path);
    if (components(node) != 3)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s: the Points array must have NumberOfComponents=\"3\"; write x, y and z "
                        "of every point",
                        file->path);
    lar_vtu_array_text array;
    double *values = NULL;
    lar_status status = describe_array(file, node, &array);
    if (!status)
        status = lar_vtu_array_doubles(&array, (size_t)grid->point_count * 3, &values, file->error);
    grid->point = (double(*)[3])values;
    return status;
}

static xmlNode *named_array(xmlNode *parent, const char *name) {
    for (xmlNode *node = lar_vtk_xml_child(parent, "DataArray"); node;
         node = find_element(node->next, "DataArray")) {
        const char *found = attribute(node, "Name");
        if (found && strcmp(found, name) == 0) return node;
    }
    return NULL;
}

lar_status lar_vtk_xml_count(const lar_vtk_xml *file, const xmlNode *node, const char *name,
                             int64_t otherwise, int64_t *count) {
    const char *text = attribute(node, name);
    *count = otherwise;
    if (!text && otherwise >= 0) return LAR_OK;
    if (!parse_count(text, count))
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s: %s of the piece is missing or no count; write the file again",
                        file->path, name);
    if (*count <= INT32_MAX) return LAR_OK;
    return lar_fail(file->error, LAR_ERROR_UNSUPPORTED,
                    "%s: %s of the piece is %" PRId64 ", more than 32 bits count; divide the model",
                    file->path, name, *count);
}

lar_status lar_vtk_xml_integers(const lar_vtk_xml *file, xmlNode *parent, const char *name,
                                int64_t count, int64_t **out) {
    xmlNode *node = named_array(parent, name);
    if (!node)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s: the array \"%s\" is missing in %s; write the file again", file->path,
                        name, parent ? (const char *)parent->name : "the piece");
    lar_vtu_array_text array;
    lar_status status = describe_array(file, node, &array);
    return status ? status : lar_vtu_array_integers(&array, (size_t)count, out, file->error);
}

lar_status lar_vtk_xml_cells(const lar_vtk_xml *file, xmlNode *parent, lar_vtk_cells *list) {
    lar_status status = lar_vtk_xml_integers(file, parent, "offsets", list->count, &list->end);
    if (status) return status;
    list->corner_count = list->count > 0 ? list->end[list->count - 1] : 0;
    if (list->corner_count < 0)
        return lar_fail(file->error, LAR_ERROR_FORMAT,
                        "%s: the last offset is negative; write the file again", file->path);
    return lar_vtk_xml_integers(file, parent, "connectivity", list->corner_count, &list->corner);
}

/* The directions of fibres, a cell array of three numbers; the last one counts. */
static lar_status read_fibres(const lar_vtk_xml *file, xmlNode *node, int64_t cells,
                              double **fibre) {
    lar_vtu_array_text array;
    lar_status status = describe_array(file, node, &array);
    if (status) return status;
    double *value = NULL;
    status = lar_vtu_array_doubles(&array, 3 * (size_t)cells, &value, file->error);
    if (status) return status;
    free(*fibre);
    *fibre = value;
    return LAR_OK;
}

lar_status lar_vtk_xml_data(const lar_vtk_xml *file, xmlNode *parent, lar_vtk_place place,
                            int64_t count, lar_vtk_grid *grid) {
    for (xmlNode *node = lar_vtk_xml_child(parent, "DataArray"); node;
         node = find_element(node->next, "DataArray")) {
        const char *name = attribute(node, "Name"), *type = attribute(node, "type");
        lar_vtk_scalar scalar;
        int family = name && count >= 0 ? lar_vtk_family(place, name) : -1;
        if (family >= 0 && components(node) == 3) {
            lar_status status = read_fibres(file, node, count, &grid->fibre[family]);
            if (status) return status;
            continue;
        }
        if (!name || !type || !lar_vtk_wants(place, name) ||
            !lar_vtk_scalar_from_xml(type, &scalar) || !lar_vtk_scalar_is_integer(scalar) ||
            components(node) != 1)
            continue;
        lar_vtu_array_text array;
        lar_status status = describe_array(file, node, &array);
        if (status) return status;
        size_t values = count < 0 ? lar_vtu_array_count(&array) : (size_t)count;
        int64_t *value = NULL;
        status = lar_vtu_array_integers(&array, values, &value, file->error);
        if (!status)
            status = lar_vtk_grid_add(grid, place, name, value, (int64_t)values, file->error);
        if (status) return status;
    }
    return LAR_OK;
}
