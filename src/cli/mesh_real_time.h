/* How many elements of a body keep the clock on this machine: meshes of it are made and measured
 * until one does, with a third in reserve and not much more. */
#ifndef LAR_CLI_MESH_REAL_TIME_H
#define LAR_CLI_MESH_REAL_TIME_H

#include "lariat.h"

/* What the files of a mesh end with, behind FOLDER/NAME; NULL at the end. */
extern const char *const cli_mesh_endings[];

/* Makes the body with about so many elements: what lar_meshing_create does for a command. */
typedef lar_status cli_make_mesh(void *context, int32_t elements, lar_meshing **meshing,
                                 lar_error *error);

/* The largest mesh that holds of those that were tried; the smallest, with *holds 0, when none
 * does. LAR_ERROR_MODEL when a mesh of the body cannot be stepped; what `make` fails with. */
lar_status cli_mesh_real_time(cli_make_mesh *make, void *context, lar_meshing **meshing, int *holds,
                              lar_error *error);

#endif
