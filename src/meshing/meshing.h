/* A meshing between its making and its files.
 *
 *     meshing.c     reads, meshes, measures
 *     given.c       what comes from the caller's memory, and what goes there
 *       |
 *       +--> starter/support.c         node sets: what holds it, where it is pulled
 *       +--> starter/extra_supports.c  what carries its weight besides
 *       +--> starter/sag.c             how far it moves under its weight, and how slowly
 *       +--> starter/fibres.c          along what its fibres run
 *       +--> starter/given.c           tissue files in place of the table of tissues
 *       +--> quality.c                 deviation, volumes, quality of elements
 *       '--> write.c                   all files, the scene by starter/starter.c
 */
#ifndef LAR_MESHING_MESHING_H
#define LAR_MESHING_MESHING_H

#include "lariat.h"
#include "meshing/boundary/boundary.h"
#include "meshing/starter/tissue.h"
#include "model/mesh/mesh.h"

/* What holds the body, and where the starter scene pulls at it. */
typedef struct lar_support {
    const char *rule;       /* "left", ..., "cut", "none" */
    bool held;              /* there is a node set "support" */
    int32_t extra_supports; /* in the node set "pads"; 0: there is none */
    bool carried;           /* it was seen to that all this bears the body's weight */
    int32_t fixed_nodes;    /* of both and of rigid regions */
    const char *handle;     /* the side of the node set "handle"; NULL: there is none */
    bool opposed;           /* "handle_opposite" is pulled the other way: nothing holds the body */
    double pull[3];         /* [N] at "handle" */
    double slowest;         /* [1/s] angular frequency of the slowest motion; 0: not known */
} lar_support;

/* A tissue file, as it goes into the scene. */
typedef struct lar_given_tissue {
    char *path; /* NULL: there is none */
    lar_bytes text;
    double shear, bulk, density; /* strained at once [Pa], [kg/m^3] */
    bool fibres;                 /* it has some, without a direction */
} lar_given_tissue;

struct lar_meshing {
    char *title;
    char *stem;  /* the title as a file's name */
    char *from;  /* the files that it was made from, for the scene's head */
    bool image;  /* from an image, not from surfaces */
    bool solids; /* from the mesh of a volume */
    bool fitted;
    bool apart; /* its regions are bodies of their own */
    lar_boundary boundary;
    lar_mesh mesh;
    lar_triangles outer; /* the true surface that is seen from outside */
    lar_support support;
    char *fibres;             /* the rule of mesh.fibre; NULL: there are none */
    const char *fibre_region; /* that has them; NULL: all but bones */
    lar_region_info *region;  /* [info.regions] */
    lar_given_tissue *given;  /* [info.regions] */
    lar_meshing_info info;
    bool (*goes_on)(void *asker); /* while it is made: asked where that takes long, by the thread
                                     that makes it; NULL: it does */
    void *asker;
    char *scene;        /* path, once written */
    char *text;         /* of the scene for memory, once asked for */
    lar_array_set *set; /* [mesh.set_count] the mesh's sets as the public header has them */
};

/* Whether the rule is one, or NULL. */
lar_status lar_support_check(const char *rule, lar_error *error);

/* Adds the node sets "support", "pads" (extra supports) and "handle" to the mesh. `rule` as
 * lar_meshing_options.fix. The regions' information must be there. */
lar_status lar_support_choose(lar_meshing *meshing, const char *rule, lar_error *error);

/* Whether the meshing has fibres in a region. */
bool lar_starter_fibrous(const lar_meshing *meshing, const lar_region_info *region);

/* Lays mesh.fibre by meshing->fibres; sets and the regions' information must be there. */
lar_status lar_starter_lay_fibres(lar_meshing *meshing, lar_error *error);

/* Reads the tissue files of the options into meshing->given; the boundary's regions must be there.
 */
lar_status lar_starter_take_tissues(lar_meshing *meshing, const lar_meshing_options *options,
                                    lar_error *error);
/* When fibres are laid: those of tissue files must have a direction. */
lar_status lar_starter_check_tissues(const lar_meshing *meshing, lar_error *error);
void lar_starter_clear_tissues(lar_meshing *meshing);
/* Fails because there is no region of that name; `what` asks for it. */
lar_status lar_starter_no_region(const lar_meshing *meshing, const char *what, const char *name,
                                 lar_error *error);

/* Writes the scene, whole or not at all; it names the mesh's and the surface's files. */
lar_status lar_starter_write(const lar_meshing *meshing, const char *path, lar_error *error);

/* The same as a text that names no files. The caller frees it. */
lar_status lar_starter_text(const lar_meshing *meshing, char **text, lar_error *error);

/* A surface of the caller's memory, copied, as lar_triangles_read gives one of a file. */
lar_status lar_meshing_take_surface(const lar_surface_arrays *given, double scale,
                                    lar_triangles *surface, lar_error *error);

/* meshing->set, once the mesh has all its sets. */
lar_status lar_meshing_list_sets(lar_meshing *meshing, lar_error *error);

/* Jacobians, edges, volume of a mesh and, with a surface (may be NULL), how far apart they are.
 * true_volume is left alone. */
lar_status lar_quality_measure(const lar_mesh *mesh, const lar_triangles *surface,
                               lar_mesh_quality *quality, lar_error *error);

#endif
