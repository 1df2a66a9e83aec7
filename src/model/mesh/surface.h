/* The outer surface of a mesh: the faces that belong to one element only. What people see, what
 * tools and other bodies touch. */
#ifndef LAR_MODEL_MESH_SURFACE_H
#define LAR_MODEL_MESH_SURFACE_H

#include "model/mesh/mesh.h"

typedef struct lar_surface {
    int32_t face_count, node_count;
    int32_t *face;        /* [face_count] element * 6 + local face, ascending */
    int32_t (*corner)[4]; /* [face_count] their nodes, counter-clockwise seen from outside */
    int32_t *element;     /* [face_count] the element behind each */
    int32_t *node;        /* [node_count] nodes on the surface, ascending */
    int32_t *index_of;    /* [nodes of the mesh] index into `node`, -1: inside */
} lar_surface;

/* `surface` is zeroed; its arrays are freed by lar_surface_clear. */
lar_status lar_surface_build(const lar_mesh *mesh, lar_surface *surface, lar_error *error);
void lar_surface_clear(lar_surface *surface); /* idempotent */

/* Index into surface->face of element * 6 + local face; -1 when it is not on the surface. */
int32_t lar_surface_find(const lar_surface *surface, int32_t face);

#endif
