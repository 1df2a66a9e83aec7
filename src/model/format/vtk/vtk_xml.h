/* VTK's XML files: the way through their elements to arrays of numbers.
 *
 *     vtu_split.c separates the XML from the data --> vtk_xml.c finds arrays --> vtu_array.c
 * decodes
 *
 * vtu.c reads meshes through it, vtp.c surfaces.
 */
#ifndef LAR_MODEL_FORMAT_VTK_VTK_XML_H
#define LAR_MODEL_FORMAT_VTK_VTK_XML_H

#include <libxml/tree.h>

#include "model/format/vtk/vtk_grid.h"
#include "model/format/vtk/vtu_split.h"

typedef struct lar_vtk_xml {
    const char *path; /* set by the caller */
    lar_error *error;
    lar_vtu_split split;
    xmlDoc *document;
    bool compressed, header64, swap;
    bool appended_raw;
} lar_vtk_xml;

/* Parses the file, whose type must be `type` ("UnstructuredGrid"); finds that element and its only
 * piece. `remedy` ends the message for files of another type. Close it also after a failure. */
lar_status lar_vtk_xml_open(lar_vtk_xml *file, const lar_bytes *bytes, const char *type,
                            const char *remedy, xmlNode **dataset, xmlNode **piece);
void lar_vtk_xml_close(lar_vtk_xml *file);

/* First child element of that name; NULL when there is none or no node. */
xmlNode *lar_vtk_xml_child(xmlNode *node, const char *name);

/* An attribute that is a count below 2^31. `otherwise` when it is not there; negative: it must. */
lar_status lar_vtk_xml_count(const lar_vtk_xml *file, const xmlNode *node, const char *name,
                             int64_t otherwise, int64_t *count);

/* The points of the piece: grid->point_count of them, into grid->point. */
lar_status lar_vtk_xml_points(const lar_vtk_xml *file, xmlNode *piece, lar_vtk_grid *grid);

/* The `count` integers of a named array in `parent`; the caller frees. */
lar_status lar_vtk_xml_integers(const lar_vtk_xml *file, xmlNode *parent, const char *name,
                                int64_t count, int64_t **out);

/* Offsets and connectivity of `list->count` cells in `parent`. */
lar_status lar_vtk_xml_cells(const lar_vtk_xml *file, xmlNode *parent, lar_vtk_cells *list);

/* The arrays in `parent` that say something about the mesh. `count` < 0: as many as it holds. */
lar_status lar_vtk_xml_data(const lar_vtk_xml *file, xmlNode *parent, lar_vtk_place place,
                            int64_t count, lar_vtk_grid *grid);

#endif
