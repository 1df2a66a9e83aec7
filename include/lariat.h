/* Lariat: real-time finite elements for soft tissue. The public C API.
 *
 * A MODEL says what is simulated (mesh, materials, supports, loads). It is read once, never
 * changes and may be shared by any number of simulations and threads. A SIMULATION owns the
 * state that moves: displacements and velocities, advanced step by step.
 *
 *     lar_error error;
 *     lar_model *model = NULL;
 *     lar_simulation *simulation = NULL;
 *     if (lar_model_open("organ.yaml", &model, &error) ||
 *         lar_simulation_create(model, NULL, &simulation, &error) ||
 *         lar_simulation_advance(simulation, 1000, &error))
 *         fprintf(stderr, "%s\n", error.message);
 *     lar_simulation_destroy(simulation);
 *     lar_model_destroy(model);
 *
 * Conventions. SI units. Vectors are x, y, z. Node and element indices count from 0 in the
 * order of the mesh file. Every call that can fail returns a lar_status (LAR_OK is 0) and writes
 * one sentence to *error, which may be NULL; outputs are set on success only. Calls without a
 * status accept NULL: they return 0, -1 for an index, "" or NULL for a text; what they fill in is
 * 0, but for arrays of nodes, which stay as they are. The library never exits, and prints nothing:
 * what a log would have stands in errors, lar_model_notice_text and lar_session_status.
 *
 * Threads. A model may be used by any number of threads at once. A simulation, and the results that
 * are written from it, belong to one thread at a time: also calls that take a const simulation may
 * use scratch memory inside it, though never change what another call returns. A SESSION takes a
 * simulation over and computes on a thread of its own; all its calls may come from any thread.
 * While it does, calls that change the simulation, or write frames of it, are refused.
 *
 * Calls need up to 128 kB of stack, and so do threads that a host makes for the library. What a
 * signal does, and what the terminal shows, stays the host's. After fork() a child has none of the
 * threads: it goes on with simulations of one thread, and makes new ones; one with a grid or
 * threads refuses to advance there, and a session or server must not be used. All may be destroyed
 * or closed there: that frees the child's copy, and the parent, the other processors and files go
 * on undisturbed.
 *
 * "T 6.5.2" in comments and docs is section 6.5.2 of the dissertation that Lariat takes up:
 * Real-Time Finite Elements: A Parallel Computer Application, ETH Zuerich 2001. Words:
 * docs/glossary.md.
 */
#ifndef LARIAT_H
#define LARIAT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(LARIAT_STATIC) || !defined(__GNUC__)
#define LAR_API
#else
#define LAR_API __attribute__((visibility("default")))
#endif
/* Compiled into the program: lariat_sizes.h. */
#ifdef LARIAT_LIBRARY /* the library itself */
#define LAR_SIZED
#elif defined(__cplusplus)
#define LAR_SIZED inline
#elif defined(__GNUC__)
#define LAR_SIZED static inline __attribute__((unused))
#else
#define LAR_SIZED static inline
#endif

/* ---- errors ---------------------------------------------------------------------------- */

typedef enum lar_status {
    LAR_OK = 0,
    LAR_ERROR_ARGUMENT,    /* an invalid argument of a call or a command line */
    LAR_ERROR_IO,          /* a file or folder that cannot be read or written */
    LAR_ERROR_FORMAT,      /* a file that is damaged or breaks its format */
    LAR_ERROR_MODEL,       /* a readable model that cannot be simulated */
    LAR_ERROR_UNSUPPORTED, /* a valid request that Lariat does not support */
    LAR_ERROR_MEMORY,      /* the system refuses memory */
    LAR_ERROR_UNSTABLE,    /* a run that became unstable: its results mean nothing */
    LAR_ERROR_PEER         /* another processor that is lost, silent or incompatible */
} lar_status;

typedef struct lar_error {
    lar_status status;
    char message[1016]; /* one sentence: file, line or element, cause and remedy */
} lar_error;

/* Version of this header: 10000 major + 100 minor + patch. */
#define LARIAT_VERSION 100
/* Version of the library, "major.minor.patch", and as a number. */
LAR_API const char *lar_version(void);
LAR_API int32_t lar_version_number(void);

/* Cores that the calling thread may use, second threads of cores included: those that it may run
 * on, and no more than the time of whole cores that control groups leave it, as those of a container
 * do (Linux); at least 1. What is chosen by itself, a grid or the workers of a batch, keeps to it. */
LAR_API int32_t lar_usable_cores(void);

/* Functions for memory, from any thread; NULL says that there is none. `alignment` is a power of 2
 * up to 2 MiB. What is resized, or released, was allocated with that of max_align_t, or any. */
typedef struct lar_memory_hooks {
    void *(*allocate)(void *context, size_t bytes, size_t alignment);
    void *(*resize)(void *context, void *memory, size_t bytes);
    void (*release)(void *context, void *memory);
    void *context;
} lar_memory_hooks;

/* All memory of the library comes from these, and goes back there: called before all other calls,
 * and once; LAR_ERROR_ARGUMENT later. Not what other libraries need that this one uses, while
 * files are read and written, and stacks of threads. */
LAR_API lar_status lar_memory_set(const lar_memory_hooks *hooks, lar_error *error);

/* Threads of the host: `start` makes one that calls run(data) once, and says into *thread what
 * `join` gets, which waits for its end. `priority`: what lar_session_options asks for, 0: nothing.
 * Threads of a grid take the priority that a session's thread has for as long as it runs.
 * `start` returns 0, or an errno when there is no thread: loops do without, what needs one fails.
 */
typedef struct lar_thread_hooks {
    int (*start)(void *context, int priority, void *(*run)(void *data), void *data, void **thread);
    void (*join)(void *context, void *thread);
    void *context;
} lar_thread_hooks;

/* All threads that the library needs come from these (of grids, loops of meshing and reading,
 * sessions, devices, recordings, servers), called with all signals blocked; NULL: its own again.
 * Called while it has none and no other call is under way. */
LAR_API lar_status lar_threads_set(const lar_thread_hooks *hooks, lar_error *error);

/* ---- model ------------------------------------------------------------------------------ */

typedef struct lar_model lar_model;

/* Reads a model: a scene (.yaml, docs/formats.md), a deck of FEBio (.feb) or of Abaqus and CalculiX
 * (.inp), or a bare mesh (.vtu .vtk .msh, and .inp without more), which gets a soft default
 * material and no supports. The caller destroys it. */
LAR_API lar_status lar_model_open(const char *path, lar_model **model, lar_error *error);
LAR_API void lar_model_destroy(lar_model *model);

/* A named set of a mesh from arrays. */
typedef struct lar_array_set {
    const char *name;
    const char *kind;     /* "nodes" (NULL), "elements" or "faces" */
    int32_t count;        /* at least 1 */
    const int32_t *index; /* [count] nodes; elements; or faces as 6 * element + face: corners
                             0473 1265 0154 3762 0321 4567 of the element, in this order */
} lar_array_set;

/* Hexahedra in memory. Nodes and elements are numbered by their index. */
typedef struct lar_mesh_arrays {
    int32_t nodes, elements, sets; /* counts */
    const double (*position)[3];   /* [nodes], in metres times the scene's `scale` */
    const int32_t (*element)[8];   /* [elements] nodes: four around the bottom, counter-clockwise
                                      seen from above, then those above them */
    const int32_t *tag;            /* [elements] what scenes select by `tag`; NULL: all 0 */
    const lar_array_set *set;      /* [sets] what scenes select by name; may be NULL */
    const double (*fibre)[3];      /* [elements] along fibres, of any length, for `direction: mesh`
                                      of a material; NULL: none */
    const double (*fibre2)[3];     /* the same of a second family, for `second: mesh`; NULL: none */
} lar_mesh_arrays;

/* Makes a model of arrays and the text of a scene (YAML, docs/formats.md), which has no key `mesh`,
 * or `mesh: given`, and no `surface`: no file is read. A small one:
 *
 *     "lariat: 1\n"
 *     "damping: 15\n"
 *     "materials:\n"
 *     "  - {name: liver, cells: all, law: neo-hookean, density: 1050,\n"
 *     "     shear_modulus: 2.0e3, bulk_modulus: 4.0e4}\n"
 *     "fix:\n"
 *     "  - {nodes: floor, axes: xyz}\n"
 *     "tools:\n"
 *     "  - {name: jaws, shape: grasper, radius: 0.003, length: 0.02, at: [0.03, 0.04, 0.07]}\n"
 *
 * scene NULL: a soft default material and no supports. Everything is copied. It behaves like a file
 * with this mesh, to the last bit; where all elements are left-handed they are turned, as those of
 * files are. LAR_ERROR_MODEL names the element, node or set that cannot be so; every node must
 * belong to an element. The caller destroys the model. */
LAR_SIZED lar_status lar_model_from_arrays(const lar_mesh_arrays *mesh, const char *scene,
                                           lar_model **model, lar_error *error);

/* Mass that elements move with and do not weigh, so that steps may be longer (scene key
 * `mass_scaling`); what it takes is the scene's to say. */
typedef struct lar_mass_scaling {
    double time_step; /* that all elements are to be stable up to [s]; 0: nothing is asked for */
    double largest_share;  /* of the model's mass that may be added */
    int32_t elements;      /* that have added mass */
    int32_t worst;         /* the one that has the most for its own */
    double factor;         /* how many times as much mass this one moves with as it weighs */
    double added;          /* [kg] */
    double share;          /* the same as a part of the model's mass */
    double stable_step;    /* without added mass [s] */
    double possible_step;  /* the longest stable step that largest_share allows [s] */
    double slowing;        /* by which part of themselves frequencies of slow motions fall at most:
                              of those that are polynomials of second degree of the place */
    double strained_share; /* of the model's mass that strained elements may have more for a while
                              (lar_heavier); 0: none */
} lar_mass_scaling;

/* Counts and measures of the mesh and its time step: the beginning of what `lariat info` prints,
 * which tells materials, sets and speed as well. */
typedef struct lar_model_info {
    const char *title;         /* lives as long as the model */
    int32_t nodes, elements;   /* counts */
    int32_t materials;         /* count */
    int32_t fixed_nodes;       /* nodes with at least one fixed or moved axis */
    double lower[3], upper[3]; /* bounding box [m] */
    double volume;             /* [m^3] */
    double mass;               /* [kg] */
    double shortest_edge;      /* [m] */
    double scaled_jacobian_min, scaled_jacobian_mean; /* -1..1, a cube has 1 */
    int32_t scaled_jacobian_worst;                    /* element index */
    double stable_step;   /* largest that LAR_ELEMENT_HEX8 allows at rest, without safety [s] */
    int32_t stable_worst; /* the element that asks for it */
    double time_step;     /* what lar_options_default() will take [s] */
    lar_mass_scaling mass_scaling;
    int32_t thin_elements;   /* with outer faces on opposite sides: one layer bends too far */
    int32_t spring_nodes;    /* that springs hold, counted once for each entry of a scene */
    double spring_stiffness; /* of all these springs together [N/m] */
    double duration;         /* that the model states [s], 0: none; see lar_model_duration */
    double rounding; /* a strain energy is known no better than to this, for it is the difference of
                        terms that large moduli make [J] */
} lar_model_info;

/* Counts, measures and the stable step: goes through all elements. `info` is the caller's. */
LAR_SIZED lar_status lar_model_inspect(const lar_model *model, lar_model_info *info,
                                       lar_error *error);

/* Counts, at once. */
LAR_API int32_t lar_model_node_count(const lar_model *model);
LAR_API int32_t lar_model_element_count(const lar_model *model);
LAR_API int32_t lar_model_material_count(const lar_model *model);
/* The file that it was read from, as it was named; "model" when there is none. Lives as long as the
 * model. */
LAR_API const char *lar_model_source(const lar_model *model);

/* Reference positions of all nodes, [nodes][3], in metres. Lives as long as the model. */
LAR_API const double (*lar_model_positions(const lar_model *model))[3];

/* The number that the mesh file gives to a node or an element (messages use it); -1 when there is
 * none. */
LAR_API int64_t lar_model_node_id(const lar_model *model, int32_t node);
LAR_API int64_t lar_model_element_id(const lar_model *model, int32_t element);

/* One material. Strings live as long as the model. */
typedef struct lar_material_info {
    const char *name;                   /* "" when it has none */
    const char *law;                    /* as in scenes: "neo-hookean", ... */
    int32_t elements;                   /* that are made of it */
    double density;                     /* [kg/m^3] */
    double shear_modulus, bulk_modulus; /* at rest [Pa]; of a viscous one: in the end */
    int32_t viscous_terms;              /* 0: elastic */
    double instant_shear_modulus;       /* when it is strained at once [Pa] */
    const char *fibres;                 /* their law, as in scenes: "exp-pow", ...; "": none */
    double fibre_modulus; /* d(tension)/d(stretch) of fibres that begin to pull [Pa] */
    double active_along, active_across; /* stress that fibres develop when all of them are active,
                                           along and across them [Pa] */
    int32_t fibre_families;             /* for which its elements have directions: 0, 1 or 2 */
    double fibre_dispersion; /* kappa of "hgo": 0, all along the direction, to 1/3, evenly */
} lar_material_info;

/* One named set of the mesh or the scene. */
typedef struct lar_set_info {
    const char *name;
    const char *kind; /* "nodes", "elements" or "faces" */
    int32_t count;
} lar_set_info;

/* Material `index` of lar_model_info.materials; LAR_ERROR_ARGUMENT beyond. */
LAR_SIZED lar_status lar_model_material(const lar_model *model, int32_t index,
                                        lar_material_info *info, lar_error *error);

/* The named sets, as lar_material_info for materials: set `index` of the count. */
LAR_API int32_t lar_model_set_count(const lar_model *model);
LAR_API lar_status lar_model_set(const lar_model *model, int32_t index, lar_set_info *info,
                                 lar_error *error);

/* What the model's file asks for and Lariat does not do, one sentence each: read them, the
 * results leave it out. NULL beyond the count. */
LAR_API int32_t lar_model_notice_count(const lar_model *model);
LAR_API const char *lar_model_notice_text(const lar_model *model, int32_t index);

/* The outer surface: faces that belong to one element only. */
typedef struct lar_surface_info {
    int32_t faces, nodes;
    const int32_t (*face)[4]; /* [faces] node indices, counter-clockwise seen from outside */
    const int32_t *element;   /* [faces] the element behind each */
    const int32_t *node;      /* [nodes] indices of the nodes on it, ascending */
} lar_surface_info;

/* The arrays live as long as the model. `info` is the caller's. */
LAR_API void lar_model_surface(const lar_model *model, lar_surface_info *info);

/* Places and outward unit normals of its nodes, both [nodes][3] of the surface, or NULL, for who
 * draws it when the nodes have moved by u, [nodes of the model][3]; NULL: at rest. A normal is the
 * mean of the faces around, by their areas; 0 0 0 where these cancel. */
LAR_API void lar_model_surface_move(const lar_model *model, const double (*u)[3], float (*place)[3],
                                    float (*normal)[3]);

/* The material of an element: index into those of lar_model_material; -1: no such element. */
LAR_API int32_t lar_model_element_material(const lar_model *model, int32_t element);

/* Unit vectors along the fibres of an element at rest, one for each family, 0 0 0 where there is
 * none; NULL: not asked for. How many families it has: 0, 1 or 2. */
LAR_API int32_t lar_model_element_fibres(const lar_model *model, int32_t element,
                                         double fibre[2][3]);

/* A fine surface embedded in the mesh, for display (scene key `surface`). */
typedef struct lar_embedded_info {
    int32_t vertices, triangles;
    const int32_t (*triangle)[3]; /* [triangles] vertices, counter-clockwise seen from outside */
    const double (*rest)[3];      /* [vertices] places at rest [m] */
    const int32_t *element;       /* [vertices] the element that each is bound to */
    const float (*weight)[8];     /* [vertices] shares of that element's nodes; they sum to 1 */
} lar_embedded_info;

/* 0 when the model has none. The arrays live as long as the model. `info` is the caller's. */
LAR_API int lar_model_embedded(const lar_model *model, lar_embedded_info *info);
/* Places of its vertices, [vertices][3], when the nodes have moved by u, [nodes][3]; NULL: at
 * rest. */
LAR_API void lar_model_embedded_move(const lar_model *model, const double (*u)[3],
                                     double (*place)[3]);

/* What a ray meets first. */
typedef struct lar_ray_hit {
    int32_t face;     /* of lar_surface_info; -1: nothing, and no other field says anything */
    int32_t element;  /* behind it */
    int32_t body;     /* the connected part of the mesh, counted from 0 by their first nodes */
    double distance;  /* from the origin [m]; INFINITY: nothing */
    double point[3];  /* where [m] */
    double normal[3]; /* of the surface there, outwards, of length 1 */
} lar_ray_hit;

/* Rays against the outer surface when the nodes have moved by u, [nodes][3]; NULL: at rest. From
 * origin[k] along direction[k], of any length but 0, at most `longest` [m] (INFINITY: any), into
 * hit[k]. A face is two triangles, corners 0 1 2 and 0 2 3; inner sides are met too. The same
 * answer for rays asked together and one by one; from eight on they share a tree. Any thread. */
LAR_API lar_status lar_model_rays(const lar_model *model, const double (*u)[3], int32_t count,
                                  const double (*origin)[3], const double (*direction)[3],
                                  double longest, lar_ray_hit *hit, lar_error *error);

/* The nodes of an element, eight indices; NULL: no such element. Lives as long as the model. */
LAR_API const int32_t *lar_model_element_nodes(const lar_model *model, int32_t element);

/* Where viewers look from at first (scene key `view`), a unit vector; 0: the model does not say. */
LAR_API int lar_model_view(const lar_model *model, double from[3]);

/* What may touch what: one entry of a model's contact. */
typedef struct lar_model_contact_info {
    const char *kind;             /* "self", "between" or "plane" */
    int32_t faces, against;       /* counts; the second of "between", else 0 */
    double through[3], normal[3]; /* of a plane [m], unit length; else zero */
    double friction;              /* Coulomb's coefficient */
} lar_model_contact_info;

LAR_API int32_t lar_model_contact_count(const lar_model *model);
/* Entry `index` of the count; LAR_ERROR_ARGUMENT beyond. */
LAR_API lar_status lar_model_contact(const lar_model *model, int32_t index,
                                     lar_model_contact_info *info, lar_error *error);

/* ---- tools ------------------------------------------------------------------------------ */

/* Tools that a simulation has at most, places for those that are added included; of these places.
 */
enum { LAR_TOOLS_MAX = 40, LAR_SPARES_MAX = 4 };

typedef enum lar_tool_shape {
    LAR_TOOL_SPHERE = 0, /* radius */
    LAR_TOOL_CAPSULE,    /* a shaft with round ends: radius, length */
    LAR_TOOL_GRASPER,    /* two jaws that take hold of tissue: radius and length of a jaw, spread */
    LAR_TOOL_HAND,       /* touches nothing, but takes hold of the surface within its radius */
    LAR_TOOL_NONE,       /* a spare one that is not there (lar_simulation_add_tool) */
    LAR_TOOL_RIGID       /* touches nothing, but moves nodes of the body as one rigid body: a bone,
                            a clamp. radius: the shortest edge of elements there; length: from its
                            tip to the farthest node at the start */
} lar_tool_shape;

/* Where a tool is. Its own axes: the tip is the origin, the shaft lies along +z, the jaws of a
 * grasper open in the plane y = 0 towards -z. */
typedef struct lar_tool_pose {
    double position[3];    /* of the tip [m] */
    double orientation[4]; /* unit quaternion w, x, y, z, within 1 %: the tool's axes into the
                              world's */
    double opening;        /* 0 closed .. 1 open. Graspers and hands take hold of what is within
                              reach when it falls below 0.25, and let go when it rises above 0.5 */
} lar_tool_pose;

/* One tool of a model or a simulation. Strings live as long as its owner. */
typedef struct lar_tool_info {
    const char *name;
    lar_tool_shape shape;
    double radius;      /* [m] */
    double length;      /* [m]; 0 where the shape has none */
    double spread;      /* angle between open jaws [rad]; 0 where the shape has none */
    lar_tool_pose rest; /* at the start */
    int32_t serial;     /* one more for every tool that was added in this place, which tells it from
                           the one before; 0 for tools that were there from the start */
    double friction;    /* Coulomb's coefficient; 0 for tools that were added */
} lar_tool_info;

LAR_API int32_t lar_model_tool_count(const lar_model *model);
LAR_SIZED lar_status lar_model_tool(const lar_model *model, int32_t index, lar_tool_info *info,
                                    lar_error *error);
/* Of a rigid body that nothing leads (`free` in a scene): the axes of space along which forces take
 * it, LAR_AXIS_X and so on added up, and 8 where it turns. 0: it is led, as all other tools are. */
LAR_API unsigned lar_model_tool_free(const lar_model *model, int32_t index);

/* What the tissue does to a tool. */
typedef struct lar_tool_force {
    double force[3];    /* [N], the mean over the steps of the last advance */
    double torque[3];   /* about the tip [N m], likewise */
    int32_t touching;   /* surface points that it touched in the last step */
    int32_t held;       /* surface points that it has hold of */
    double limit;       /* beyond it stays behind its hand [N]; 0 for hands: none. It may do so with
                           less, too: half its radius deep, or where elements need shorter steps */
    double depth;       /* the deepest tissue point in it in the last advance [m]; 0: none */
    double apart;       /* from its tip to where its hand asks the tip to be, now [m]; 0 where tissue
                           keeps it from turning or closing only, of which `limited` tells */
    int32_t limited;    /* 1 while tissue keeps it from following its hand, which includes its way
                           back to it; else 0 */
    double grasp_force; /* what both jaws of a grasper press with on the tissue between them [N],
                     the mean over the last advance: the smaller of what each is pushed outwards
                     with; 0 when a jaw is not, and for other tools */
} lar_tool_force;

/* Writes the demonstration organ into a folder, which is made when it is missing: uterus.vtu, and
 * its scenes uterus.yaml (pulled by a force) and uterus_live.yaml (to take hold of). A scene that
 * is there already and differs, as after an edit, is left as it is. */
LAR_API lar_status lar_demo_write(const char *folder, lar_error *error);

/* ---- meshing: from a scan to a model ------------------------------------------------------ */

/* Mesh quality, and distance from a true surface. */
typedef struct lar_mesh_quality {
    int32_t jacobian_bin[10];   /* elements by scaled Jacobian, bins of 0.1 from 0 */
    double above_02, above_05;  /* parts of the elements, 0..1 */
    double mean_edge;           /* [m] */
    double volume, true_volume; /* of the mesh and inside the true surface [m^3]; 0: unknown */
    double deviation_mean;      /* between both surfaces, both ways, by area [m] */
    double deviation_95;        /* 95 % of the area is nearer [m] */
    double deviation_max;       /* the largest: Hausdorff distance [m] */
    int32_t crossings;          /* pairs of outer faces that go through each other */
    double crossing_depth;      /* of the deepest of them [m]; 0: there is none */
} lar_mesh_quality;

/* Compares a model's mesh with a surface (.stl .obj .vtk .vtp, in the model's metres times
 * `scale`), or with its embedded surface (against NULL); without either the deviations
 * and true_volume are 0. */
LAR_SIZED lar_status lar_model_quality(const lar_model *model, const char *against, double scale,
                                       lar_mesh_quality *quality, lar_error *error);

typedef struct lar_meshing lar_meshing;

/* Progress callback: stage and fraction done (0..1). Return 0 to cancel. */
typedef int lar_meshing_progress(void *context, const char *what, double part);

typedef struct lar_meshing_options {
    double size;               /* edge of an element [m]; 0: from `elements` */
    int32_t elements;          /* about so many; 0: 5,000 */
    double scale;              /* of surfaces and meshes: metres per unit of the file; 0: 1 */
    const char *const *labels; /* of an image: numbers or names, each a region; NULL: all */
    int32_t label_count;
    int fuse;          /* not 0: all labels, or regions of a mesh, become one region */
    const char *names; /* a file of label names, "LABEL,NAME" per line; NULL: none */
    int principal;     /* not 0: along the body's principal axes instead of the image's */
    int voxel;         /* not 0: cubes on a grid, not fitted; size and elements 0: the
                          image's own voxels */
    const char *title; /* NULL: the only region's name, or the first file's */
    const char *fix;   /* where the starter scene holds it: "left", "right", "back", "front",
                          "bottom", "top", "cut", "none"; NULL: "cut" where the image cuts
                          it, else "back", and extra supports that bear its weight */
    lar_meshing_progress *progress; /* may be NULL */
    void *context;
    const char *fibres; /* along what fibres run, by a rule as scenes have it, for example "axis:
                           [0, 0, 1]"; NULL: there are none */
    const char *fibre_region;   /* the name of the region that has them; NULL: all but bones */
    const char *const *tissues; /* tissue files for the starter scene in place of the table's
                                   figures: REGION=FILE, or FILE for all regions but bones (=FILE
                                   where its name has a "="); the later one counts; NULL: none */
    int32_t tissue_count;
    int apart; /* not 0: regions are bodies of their own that touch where they meet, each with its
                  nodes; the starter scene has contact between them, and there is no true surface
                  that is embedded */
} lar_meshing_options;

LAR_SIZED lar_meshing_options lar_meshing_options_default(void);

/* Meshes one label image (.nii .nii.gz .nrrd .nhdr), or closed surfaces (.stl .obj .vtk .vtp), one
 * region each, where surfaces overlap the later one has the place; or the boundary of the regions
 * of one mesh (.msh .vtu .vtk .inp .feb) of tetrahedra, prisms, pyramids or hexahedra. World:
 * metres, for images +x right, +y front, +z head. docs/meshing.md. Works on all cores that the
 * process may use; what it makes does not depend on how many these are. `options` may be NULL. */
LAR_SIZED lar_status lar_meshing_create(const char *const *paths, int32_t count,
                                        const lar_meshing_options *options, lar_meshing **meshing,
                                        lar_error *error);
LAR_API void lar_meshing_destroy(lar_meshing *meshing);

/* A label image (lar_image_open, lar_image_create). */
typedef struct lar_image lar_image;

/* A closed surface in memory. */
typedef struct lar_surface_arrays {
    const char *name;             /* of its region; NULL or "": "surface" */
    int32_t vertices, triangles;  /* counts */
    const double (*vertex)[3];    /* [vertices], in metres times options.scale */
    const int32_t (*triangle)[3]; /* [triangles] vertices, counter-clockwise seen from outside */
} lar_surface_arrays;

/* As lar_meshing_create, without files: what it makes is the same. An image knows its labels'
 * names, so options.names is refused; surfaces are copied. */
LAR_SIZED lar_status lar_meshing_of_image(const lar_image *image,
                                          const lar_meshing_options *options, lar_meshing **meshing,
                                          lar_error *error);
LAR_SIZED lar_status lar_meshing_of_surfaces(const lar_surface_arrays *surface, int32_t count,
                                             const lar_meshing_options *options,
                                             lar_meshing **meshing, lar_error *error);

/* What was made: the mesh in metres, and the true surface (the embedded one of a file). Either may
 * be NULL. The arrays live as long as the meshing. */
LAR_SIZED void lar_meshing_arrays(const lar_meshing *meshing, lar_mesh_arrays *mesh,
                                  lar_surface_arrays *surface);

/* The true boundary of region `index`, of lar_meshing_region, all around: also where it touches
 * others. Its triangles, counter-clockwise seen from outside the region, into `triangle` (NULL: they
 * are only counted); vertices are those of all regions, *boundary (may be NULL) has both. Returns
 * how many triangles there are; -1: no such region. Vertices live as long as the meshing. */
LAR_API int32_t lar_meshing_region_boundary(const lar_meshing *meshing, int32_t index,
                                            int32_t (*triangle)[3], lar_surface_arrays *boundary);
/* The starter scene as a text for lar_model_from_arrays with that mesh; lives as long as the
 * meshing. */
LAR_API lar_status lar_meshing_scene(lar_meshing *meshing, const char **scene, lar_error *error);

typedef struct lar_meshing_info {
    const char *title; /* strings live as long as the meshing */
    const char *name;  /* of its files: the title, "_" for what is no letter, digit, "-" or "." */
    int32_t nodes, elements, regions;
    double size;                     /* edge of the grid's cells [m] */
    int32_t islands, island_cells;   /* loose pieces left out */
    int32_t pinholes, pinhole_cells; /* hollows filled */
    int32_t added, removed; /* cells, so that none hang together by an edge or a corner only */
    int32_t cuts;           /* flat cuts, where the image ends in an organ */
    const char *fix;        /* the rule that holds the body, as in the options */
    int32_t extra_supports; /* small places that hold it besides, because its weight asks for them;
                     not when the options say what holds it */
    int32_t fixed_nodes;
    int image;      /* not 0: made from a label image, which says how large it is */
    int32_t joined; /* nodes of a mesh that stood at the place of another one, and were joined */
    lar_mesh_quality quality;
    int32_t parted; /* nodes that bodies which touch have more than if they hung together */
} lar_meshing_info;

typedef struct lar_region_info {
    const char *name;
    int32_t tag, elements;
    double volume, true_volume;  /* in the mesh, and in the image, surface or other mesh [m^3] */
    const char *tissue, *source; /* of the starter scene's material: which, from where */
    double shear_modulus, bulk_modulus, density;
    int held;         /* not 0: bone, which the starter scene holds where it is */
    double usual_max; /* more than such organs hold in anybody [m^3]; 0: not known */
} lar_region_info;

LAR_SIZED void lar_meshing_inspect(const lar_meshing *meshing, lar_meshing_info *info);
/* Region `index` of the count; LAR_ERROR_ARGUMENT beyond. */
LAR_SIZED lar_status lar_meshing_region(const lar_meshing *meshing, int32_t index,
                                        lar_region_info *info, lar_error *error);

/* Writes FOLDER/NAME.vtu (tags, named sets, fibres), NAME_surface.vtp (the true surface, embedded
 * in it) and NAME.yaml, a scene that runs; NAME is that of lar_meshing_info. The folder is made
 * when it is missing; files that are there are replaced, each whole. *scene (may be NULL): the
 * scene's path, freed with the meshing. */
LAR_API lar_status lar_meshing_write(lar_meshing *meshing, const char *folder, const char **scene,
                                     lar_error *error);

/* A label image is a number for every voxel, 0 for nothing. It never changes; any thread may look
 * at it. */
typedef struct lar_image_info {
    int32_t size[3];       /* voxels along i, j, k */
    int32_t names;         /* labels that the file gives names to */
    double to_world[3][4]; /* [m]: world = to_world * (i, j, k, 1), at the voxel's centre */
    const uint16_t *label; /* [size[2]][size[1]][size[0]], i runs fastest; lives as long as the
                              image */
} lar_image_info;

/* Reads .nii .nii.gz .nrrd .nhdr; the caller destroys it. */
LAR_API lar_status lar_image_open(const char *path, lar_image **image, lar_error *error);
/* One of memory, copied. from->names of its labels have names: name[i] is that of label named[i];
 * both may be NULL where that is 0. */
LAR_SIZED lar_status lar_image_create(const lar_image_info *from, const char *const *name,
                                      const int32_t *named, lar_image **image, lar_error *error);
LAR_API void lar_image_destroy(lar_image *image);
LAR_SIZED void lar_image_inspect(const lar_image *image, lar_image_info *info);
/* Name `index` of the count, which lives as long as the image, and its label (may be NULL); NULL
 * beyond. */
LAR_API const char *lar_image_name(const lar_image *image, int32_t index, int32_t *label);

/* ---- simulation ------------------------------------------------------------------------- */

typedef struct lar_simulation lar_simulation;

typedef enum lar_element_kind {
    LAR_ELEMENT_HEX8 = 0,   /* uniform strain with total hourglass control: the fast one */
    LAR_ELEMENT_HEX8_FULL,  /* eight Gauss points: the oracle */
    LAR_ELEMENT_HEX8_MATRIX /* element matrices built every step */
} lar_element_kind;

typedef enum lar_isa {
    LAR_ISA_AUTO = 0, /* the widest that this processor has, or LARIAT_ISA=avx512|avx2|neon|c */
    LAR_ISA_C,
    LAR_ISA_NEON,
    LAR_ISA_AVX2,
    LAR_ISA_AVX512
} lar_isa;

typedef struct lar_options {
    lar_element_kind element;
    lar_isa isa;
    double time_step; /* seconds, 1e-15 or more; 0 takes the model's */

    /* The parallel computer: processors in a grid, each with its part of the model. The state and
     * its hash are the same with all of these (docs/parallel.md). Strings are read by
     * lar_simulation_create only. */
    const char *grid;         /* processors along x, y and z, "2x2x3"; "auto": lar_grid_choose;
                                 NULL: no division */
    int32_t threads;          /* of every processor; 0: one */
    const char *scheme;       /* who sends to whom: "all" (NULL), "local", "one", "two" */
    const char *channels;     /* of scheme local: "sequential" (NULL) or "concurrent" */
    const char *distribution; /* "cut", "genetic", "metis", "random", or a file's path; NULL: cut,
                                 and anew under way (lar_simulation_redivisions) */
    const char *schedules;    /* a folder of schedule files, instead of all these */
    const char *comm;         /* "threads" (NULL); "shm", "ucx", "mpi", "tcp": other processes */
    uint64_t delays;          /* seed of random delays, to test with; 0: none */
    int verify;               /* not 0: steps verify the schedules instead of moving (T 6.9) */
    int pin; /* a core for every thread, where there are enough: 0: never; 1: always;
                2: only when all cores are taken, so that two runs never share a
                core while another is idle */

    /* When processors are processes: which one this is, and how they find each other. Processor 0
     * is the one that is talked to; the others call lar_simulation_serve. */
    int32_t processor;
    const char *master; /* "host:port" where processor 0 listens */
    int listener;       /* processor 0: a socket that listens already, taken over; -1: none */

    int32_t hands;     /* tools of shape LAR_TOOL_HAND besides the model's, after them */
    int32_t spares;    /* tools that may be added while it runs, after these: 0 to 4 */
    int search_always; /* not 0: contact is searched anew in every step; the same bits, slow */
    double tick;       /* of a host's clock [s]; 0: none. A whole number of steps makes a tick then,
                          exactly: an automatic step is shortened for that (1 ms and a step of 95 us:
                          11 of 90.9), another one must fit */
} lar_options;

/* hex8, the widest instruction set, the model's time step, one processor. Start from these: options
 * may grow. */
LAR_SIZED lar_options lar_options_default(void);

/* What a division is chosen for. All 0: as fast as it goes, for a long time. */
typedef struct lar_grid_aim {
    double tick;    /* a clock that the simulation keeps up with: its ticks [s]; 0: none */
    double seconds; /* that will be simulated [s], or */
    uint64_t steps; /* that will be done; both 0: not known */
} lar_grid_aim;

typedef struct lar_grid_choice {
    char grid[40];        /* "1x1x1": no division */
    int32_t processors;   /* in it */
    int32_t cores, tried; /* that this process may use; divisions that were measured */
    double alone, chosen; /* a step with one processor, and so divided [s]; 0: not measured */
    char reason[240];     /* in words */
} lar_grid_choice;

/* Which division of the model is best on this machine, as busy as it is now: some hundred steps
 * with one processor, and with two, four, ... threads up to the cores that this process may use,
 * are measured side by side; with a tick beside a thread that wakes as often as devices do, and
 * half by the slowest twentieth. More processors have to be a tenth faster to be taken. Takes half
 * a second and what it takes to create the simulations that are tried, some seconds for a hundred
 * thousand elements, and their memory. What is too small to gain, too large to try, or over before
 * this would be, is not measured, and the reason says so. The environment variable LARIAT_GRID
 * ("2x1x1") is taken as it is. Who only wants a simulation that is divided so gives grid "auto" in
 * the options. `aim` may be NULL. Fails only for a LARIAT_GRID that is none, for options that name
 * processes or schedule files besides, and as creating a simulation fails. */
LAR_SIZED lar_status lar_grid_choose(const lar_model *model, const lar_options *options,
                                     const lar_grid_aim *aim, lar_grid_choice *choice,
                                     lar_error *error);
/* Into the options: its grid, which lives as long as the choice does, or none for one processor.
 * NULL is fine. */
LAR_API void lar_grid_take(const lar_grid_choice *choice, lar_options *options);

/* Compiles the model for this processor and sets the state to rest. `options` may be NULL. The
 * model must outlive the simulation. */
LAR_SIZED lar_status lar_simulation_create(const lar_model *model, const lar_options *options,
                                           lar_simulation **simulation, lar_error *error);
LAR_API void lar_simulation_destroy(lar_simulation *simulation);
/* A second simulation in the state of the first one: nodes, tools, settings, what tools felt, as
 * with lar_simulation_load_from. Model, options and what was compiled of the model are the same
 * and there once, whichever is destroyed first; the two may belong to different threads then. Some
 * ten times as fast as lar_simulation_create. LAR_ERROR_UNSUPPORTED for one of several processors
 * or threads (a grid of one with one thread is none, and its clone has no grid); LAR_ERROR_UNSTABLE
 * as lar_simulation_save_to. */
LAR_API lar_status lar_simulation_clone(lar_simulation *simulation, lar_simulation **clone,
                                        lar_error *error);

/* What it was made of: constant while it lives. `info` is the caller's. */
typedef struct lar_simulation_info {
    const lar_model *model;
    lar_element_kind element;
    int32_t tools;    /* of the model, and lar_options.hands */
    int32_t spares;   /* places behind these, for tools that are added */
    double time_step; /* [s] */
} lar_simulation_info;

LAR_SIZED void lar_simulation_inspect(const lar_simulation *simulation, lar_simulation_info *info);

/* Advances by `steps` time steps. On LAR_ERROR_UNSTABLE the message names element or node, place,
 * time and cause; the state is then the one after the failing step, or, with several processors,
 * after the step at which all have stopped, some steps later: nearly always finite and fit for a
 * picture (lar_results_add refuses it where it is not), but not for going on, and further calls
 * fail with the same message. No steps change nothing, also of what tools felt. */
LAR_API lar_status lar_simulation_advance(lar_simulation *simulation, uint64_t steps,
                                          lar_error *error);

/* Called after every step with the number of steps done, by the thread that advances; 0 ends the
 * advance: at once, or, with several processors, some steps later in the same step on all. Without
 * grid and threads it may look at the simulation (state, fields, tools; lar_results_add and
 * saving, too); with them at lar_simulation_steps, _time and what is constant. What
 * advances or changes the simulation, or opens a session on it, is refused (LAR_ERROR_ARGUMENT).
 * Nor may it destroy it. */
typedef int lar_step_callback(void *context, uint64_t step);

/* The same with a callback. Ask lar_simulation_steps where it ended. */
LAR_API lar_status lar_simulation_advance_with(lar_simulation *simulation, uint64_t steps,
                                               lar_step_callback *callback, void *context,
                                               lar_error *error);

/* For processes other than processor 0: computes what processor 0 asks for, and returns when it
 * destroys its simulation, or with LAR_ERROR_PEER when a processor is lost. */
LAR_API lar_status lar_simulation_serve(lar_simulation *simulation, lar_error *error);

/* Processors and threads of each, as they are. */
LAR_API int32_t lar_simulation_processors(const lar_simulation *simulation);
LAR_API int32_t lar_simulation_threads(const lar_simulation *simulation);

LAR_API uint64_t lar_simulation_steps(const lar_simulation *simulation);
LAR_API double lar_simulation_time(const lar_simulation *simulation);      /* [s] */
LAR_API double lar_simulation_time_step(const lar_simulation *simulation); /* [s] */
LAR_API const char *lar_simulation_isa(const lar_simulation *simulation);  /* "avx512", ... */

/* Copies the state, [nodes][3] each, in the mesh's order. Velocities are those half a step back
 * (leapfrog). */
LAR_API void lar_simulation_displacements(const lar_simulation *simulation, double (*out)[3]);
LAR_API void lar_simulation_velocities(const lar_simulation *simulation, double (*out)[3]);

/* 64 bits over step number, displacements and velocities of all nodes, and what viscous elements
 * remember. The same for every instruction set, thread count and division of the model. */
LAR_API uint64_t lar_simulation_hash(const lar_simulation *simulation);

/* Energies now, in joules. external = work done by loads, prescribed motion, supports that are set
 * and tools since the start, damping = energy taken out, contact = stored in contacts and lost in
 * them, and, without any contact too, lost in the dampers of corners that nearly fold; viscous =
 * what the viscous terms of materials have taken, most of it for good; strain = what is left in the
 * end, with what barriers of such corners store. Of tools this is what they do at the nodes: what
 * a hand puts into a tool is more by what its spring stores and its friction takes, the force of
 * lar_simulation_tool_force along the way of its pose;
 * kinetic + strain + hourglass + damping + contact + viscous = external (+ start). */
typedef struct lar_energy {
    double kinetic, strain, hourglass, external, damping, contact, viscous;
} lar_energy;

/* Goes through all nodes and elements: as long as many steps. Asks for no memory. */
LAR_SIZED void lar_simulation_energy(const lar_simulation *simulation, lar_energy *energy);

/* Values for a picture, one per node of the model. */
typedef enum lar_field {
    LAR_FIELD_DISPLACEMENT = 1, /* its length [m] */
    LAR_FIELD_VELOCITY = 2,     /* its length [m/s]; not for lar_simulation_field */
    LAR_FIELD_VON_MISES = 4,    /* [Pa] mean of the elements around the node, as the others */
    LAR_FIELD_PRESSURE = 8,     /* [Pa] */
    LAR_FIELD_ENERGY = 16,      /* strain energy per reference volume [J/m^3] */
    LAR_FIELD_PROCESSOR = 32    /* the one that accounts for the node */
} lar_field;

/* A field at the displacements u, [nodes][3] in the mesh's order, into out [nodes]. Any thread may
 * ask at any time while the simulation lives, also while another one advances it. */
LAR_API lar_status lar_simulation_field(const lar_simulation *simulation, lar_field field,
                                        const double (*u)[3], float *out, lar_error *error);

/* Von Mises stress, pressure or energy at one node, the mean of its elements that are not inside
 * out (0 when all are), and in one element, not finite when that is inside out. u and threads as
 * above; the elements behind faces: lar_surface_info. */
LAR_API lar_status lar_simulation_node_value(const lar_simulation *simulation, lar_field field,
                                             int32_t node, const double (*u)[3], double *value,
                                             lar_error *error);
LAR_API lar_status lar_simulation_element_value(const lar_simulation *simulation, lar_field field,
                                                int32_t element, const double (*u)[3],
                                                double *value, lar_error *error);
/* Mean Cauchy stress [Pa] and Green-Lagrange strain of all elements now, [elements][6] each, as xx
 * yy zz xy yz zx: components of tensors, shear without a factor 2. Viscous and active stress is in
 * it: what results on disk are made of. An element that is inside out has none that is finite.
 * Either may be NULL. */
LAR_API lar_status lar_simulation_stresses(const lar_simulation *simulation, double (*cauchy)[6],
                                           double (*strain)[6], lar_error *error);
/* What pushes nodes. */
typedef enum lar_cause {
    LAR_CAUSE_ELEMENTS = 0, /* all that elements do: elastic, viscous and active stress, hourglass
                               control, barriers of those that are nearly folded */
    LAR_CAUSE_TOOL,         /* one tool: what it pushes, holds and rubs. Of tools that press the
                               same node with friction the nearest has the friction of all */
    LAR_CAUSE_BODIES,       /* contact of bodies with each other and themselves, with friction */
    LAR_CAUSE_LOADS,        /* forces, pressures and springs of the model, and forces that were
                               set */
    LAR_CAUSE_PLANES,       /* all planes, with friction */
    LAR_CAUSE_SUPPORTS,     /* what fixes, holds and moves nodes, along its axes */
    LAR_CAUSE_GRAVITY,
    LAR_CAUSE_DAMPING /* of the model; what contact and barriers damp is in their forces */
} lar_cause;

/* Forces on all nodes by one cause [N], [nodes][3] in the mesh's order, at the displacements and
 * velocities of now: those that the next step begins with, so that all causes and tools together
 * are each node's mass times (v+ - v-) / dt, within rounding; v are the velocities now and after
 * that step, dt its length, where neither it nor the one before is divided
 * (lar_simulation_step_parts). `tool` counts for LAR_CAUSE_TOOL.
 *
 * Elements, tools, bodies and loads give whole force units, whose sums over nodes are exact in any
 * order up to 2^53 of them, some hundred times the strongest force of an element: bodies sum up to
 * nothing, and a tool's forces to minus lar_tool_force.force after an advance by that one step, to
 * the last bit (the torque within rounding), under the conditions that
 * lar_simulation_tool_touches has. These are the same bits on every grid and instruction set; the
 * others are doubles, whose last bits may depend on the instruction set.
 *
 * Changes nothing; takes as long as some steps, on processor 0. */
LAR_API lar_status lar_simulation_nodal_forces(const lar_simulation *simulation, lar_cause cause,
                                               int32_t tool, double (*force)[3], lar_error *error);
/* What bodies, planes and tools push the nodes of the surface with, per area around a node as it is
 * now, on faces that look against the force (within 60 degrees): as a vector, with friction,
 * [nodes][3], and along the surface's normal there, [nodes], positive inwards [Pa]; 0 where nothing
 * touches. Either may be NULL. Forces are those of lar_simulation_nodal_forces; takes as long. */
LAR_API lar_status lar_simulation_contact_pressure(const lar_simulation *simulation,
                                                   double (*traction)[3], double *pressure,
                                                   lar_error *error);

/* What all elements store at u, and what their hourglass control does [J]. u and threads as above.
 * Not finite when an element is inside out. */
LAR_API lar_status lar_simulation_stored_energy(const lar_simulation *simulation,
                                                const double (*u)[3], double *strain,
                                                double *hourglass, lar_error *error);

/* ---- changing a body while it runs ----------------------------------------------------------
 *
 * From the present step on, in the same step on all processors; in checkpoints and recordings.
 * Reset goes back to what the model says. Work that a change does counts as external (lar_energy).
 */

/* Gravity [m/s^2], at most 1000 long; NULL: as the model says, which may follow a curve. */
LAR_API lar_status lar_simulation_set_gravity(lar_simulation *simulation, const double gravity[3],
                                              lar_error *error);
/* Damping in proportion to mass [1/s], 0 or more, as lar_model_damping: the model's. */
LAR_API lar_status lar_simulation_set_damping(lar_simulation *simulation, double damping,
                                              lar_error *error);
/* How many times as stiff a material is as the model says, within these bounds; material -1: all of
 * them. The 64th material and all after it share a factor. While one is stiffer, steps may be
 * divided (lar_simulation_step_parts). Takes as long as some forty steps. */
#define LAR_STIFFNESS_MIN 0.1
#define LAR_STIFFNESS_MAX 4.0
LAR_API lar_status lar_simulation_set_stiffness(lar_simulation *simulation, int32_t material,
                                                double factor, lar_error *error);
/* Materials that can have other parameters than the model's at a time. */
enum { LAR_MATERIALS_SET_MAX = 16 };
/* A parameter of a material's law: `name` as in scenes ("shear_modulus", "c1"), of its fibres'
 * "fibres.ksi" and so on, in pascal where it has a unit, before the stiffness that was set counts;
 * the material's other parameters stay as they are (of coupled-neo-hookean "shear_modulus" and
 * "bulk_modulus", too, from which mu and lambda follow: the other modulus stays). NULL: all are the
 * model's again. Density, viscous terms and active stress stay the model's. Steps may be divided as
 * with stiffness, and what would have to be divided more, with the stiffness that is set, is
 * refused: together they make frequencies at rest at most twice as high (LAR_STIFFNESS_MAX of their
 * square). LAR_ERROR_ARGUMENT for that, for what the law does not have, which the message lists,
 * for values that no material can have, and beyond LAR_MATERIALS_SET_MAX. Strained tissue that
 * becomes many times as stiff at once springs back with what that adds, and may break the run: go
 * there in steps. A change is no strain: what had relaxed stays so at once, dampers of viscous
 * terms stay where they are, and what their springs gain counts as external. Takes as long as
 * creating the elements of that material, and some 10 us for each viscous term of an element. */
LAR_API lar_status lar_simulation_set_parameter(lar_simulation *simulation, int32_t material,
                                                const char *name, double value, lar_error *error);
/* How active a material is, from 0 to 1 (it starts at 1): times what its model says at that time by
 * a curve or a wave, and times its active stress; material -1: all that have one. The 64th material
 * and all after it share a value. LAR_ERROR_ARGUMENT for other values and for a material without
 * active stress. Steps stay as long as they are; a call looks at every active element. */
LAR_API lar_status lar_simulation_activate(lar_simulation *simulation, int32_t material,
                                           double value, lar_error *error);
/* Forces that can be set at a time; one on a set counts once. */
enum { LAR_FORCES_MAX = 128 };
/* A constant force on a node [N], besides the model's loads and what is set on sets that it is in;
 * NULL or zeros: none any more. Node -1 with NULL: all that were set, on sets too, are gone.
 * Supports take what acts along their axes. LAR_ERROR_ARGUMENT beyond LAR_FORCES_MAX, and for more
 * than force sums hold (the message says how much that is). */
LAR_API lar_status lar_simulation_set_force(lar_simulation *simulation, int32_t node,
                                            const double force[3], lar_error *error);
/* The same on every node of a set of nodes (lar_model_set): so much on each of them. */
LAR_API lar_status lar_simulation_set_force_on(lar_simulation *simulation, const char *set,
                                               const double force[3], lar_error *error);
/* Axes of nodes. */
enum { LAR_AXIS_X = 1, LAR_AXIS_Y = 2, LAR_AXIS_Z = 4, LAR_AXIS_ALL = 7 };
/* Supports that can be set at a time; one on a set counts once for all axes together. */
enum { LAR_SUPPORTS_MAX = 128 };
/* `held` not 0: from now on these axes (LAR_AXIS_X | ..., 1 to 7) of a node stand still where they
 * are, as with a clamp or a stitch. 0: they are free, also of what the model fixes or moves: the
 * node goes on from where it is with the velocity that it has, from rest where it was fixed. The
 * other axes stay as they are; of what is said of one axis the last counts. What moves along a
 * curve of the model and is stopped does not take it up again before a reset. A body that stops in
 * one step is hit: its kinetic energy there is negative work of the support.
 * LAR_ERROR_ARGUMENT for another node or axis, and beyond LAR_SUPPORTS_MAX; LAR_ERROR_MEMORY. */
LAR_API lar_status lar_simulation_set_support(lar_simulation *simulation, int32_t node,
                                              unsigned axes, int held, lar_error *error);
/* The same of every node of a set of nodes (lar_model_set). */
LAR_API lar_status lar_simulation_set_support_on(lar_simulation *simulation, const char *set,
                                                 unsigned axes, int held, lar_error *error);
/* As they are now. The stiffness and the activation of a material that does not exist are 0. */
LAR_API void lar_simulation_gravity(const lar_simulation *simulation, double gravity[3]);
LAR_API double lar_simulation_damping(const lar_simulation *simulation);
LAR_API double lar_simulation_stiffness(const lar_simulation *simulation, int32_t material);
/* Likewise, without its stiffness; not a number for what there is not. */
LAR_API double lar_simulation_parameter(const lar_simulation *simulation, int32_t material,
                                        const char *name);
/* What was set, without curve and wave. */
LAR_API double lar_simulation_activation(const lar_simulation *simulation, int32_t material);
/* What was set on a node and on sets that it is in, together [N]; 0 for no such node. */
LAR_API void lar_simulation_force(const lar_simulation *simulation, int32_t node, double force[3]);
/* The axes that hold or move a node, by the model and by what was set; 0 for no such node. */
LAR_API unsigned lar_simulation_support(const lar_simulation *simulation, int32_t node);

/* ---- tools and contact of a simulation ---------------------------------------------------- */

/* Those of the model, then options.hands hands, then options.spares that can be added: of shape
 * LAR_TOOL_NONE and called "" until they are. */
LAR_API int32_t lar_simulation_tool_count(const lar_simulation *simulation);
LAR_SIZED lar_status lar_simulation_tool(const lar_simulation *simulation, int32_t index,
                                         lar_tool_info *info, lar_error *error);

/* From the present step on the tool moves evenly from where it is to `pose`, within `steps` (at
 * least 1) steps, and rests there: in the same steps on all processors. Taking hold and letting go
 * happen now. Neither its tip nor its other end faster than half its radius in a step
 * (LAR_ERROR_ARGUMENT), but a hand that holds nothing may be put anywhere. Up to a quarter of it
 * tissue keeps a tool out; what is faster may go through a wall as thin as the tool. A rigid one
 * takes its nodes along: none of them goes farther than half its radius in a step. */
LAR_API lar_status lar_simulation_tool_move(lar_simulation *simulation, int32_t tool,
                                            const lar_tool_pose *pose, uint64_t steps,
                                            lar_error *error);
/* Takes hold. A hand does so at `point` [m], at once, whatever it held before; *held (may be NULL)
 * says how many surface points it has got, 0 when there was nothing within its reach, and then it
 * is open. A grasper closes its jaws where it is within `steps` steps, as far as what is between
 * them lets it (the force of jaws is bounded, and less the more they strain), and takes that when
 * they begin; `point` counts for hands only, who need one. 0 steps: as many as the jaws' ends need
 * at 1 m/s, or at half their radius in a step where that is less. */
LAR_API lar_status lar_simulation_grasp(lar_simulation *simulation, int32_t tool,
                                        const double point[3], uint64_t steps, int32_t *held,
                                        lar_error *error);
/* Lets go: a hand at once, a grasper by opening its jaws within `steps` steps; 0: as above. */
LAR_API lar_status lar_simulation_release(lar_simulation *simulation, int32_t tool, uint64_t steps,
                                          lar_error *error);
/* Where it is now, which may be short of where it was asked to be. Jaws that hold something are
 * open by that much: who moves them on gives lar_simulation_tool_move the opening that they shall
 * have (0), for this one would let go. */
LAR_API lar_status lar_simulation_tool_pose(const lar_simulation *simulation, int32_t tool,
                                            lar_tool_pose *pose, lar_error *error);
LAR_SIZED lar_status lar_simulation_tool_force(const lar_simulation *simulation, int32_t tool,
                                               lar_tool_force *force, lar_error *error);

typedef enum lar_touch_kind {
    LAR_TOUCH_PRESSED = 0, /* the tool pushes a point of a face */
    LAR_TOUCH_HELD,        /* it has hold of a point of a face */
    LAR_TOUCH_RUBBED       /* friction at a node */
} lar_touch_kind;

/* Where a tool and the surface touch. */
typedef struct lar_touch {
    double place[3];  /* of the point of the surface [m] */
    double normal[3]; /* unit, out of the tool; 0 where it holds */
    double force[3];  /* of the tissue on the tool [N] */
    double depth;     /* of the point in the tool [m]; 0 where it holds or rubs */
    lar_touch_kind kind;
    int32_t jaw;      /* of a grasper that pushes: 0 or 1; else 0 */
    int32_t face;     /* index into lar_surface_info.face; -1: friction, at node[0] */
    int32_t node[4];  /* of the model: the face's corners; -1: none */
    double weight[4]; /* shares of these in the point; they sum to 1 */
} lar_touch;

/* Where a tool touches in the present state, with the forces that the next step begins with:
 * copies at most `max` points (0 with NULL: only counts); *count is how many there are, which may
 * be more. Forces are whole force units, so that their sum is exact in any order. It is what
 * lar_tool_force says after an advance by that one step, but for the rounding of its mean, where
 * the step is not divided and nothing is decided anew before it (how steps are divided, how a tool
 * follows its hand). The same bits and order on every grid, also right after loading. Changes
 * nothing; takes as long as some steps, on processor 0, because the tool's surroundings are
 * searched anew. */
LAR_API lar_status lar_simulation_tool_touches(const lar_simulation *simulation, int32_t tool,
                                               int32_t max, lar_touch *touch, int32_t *count,
                                               lar_error *error);

/* Adds a tool in the first spare place, from the present step on, in the same step on all
 * processors: it stands above the body, as that is and as it is at rest, tip down, clear of both.
 * It is in checkpoints and recordings; a reset puts it back there. `shape` (sphere, capsule,
 * grasper), `radius`, `length` and `spread` (0: 60 degrees) of `wanted` count; its name follows
 * from its place in the list: "sphere 1". *tool, its index, may be NULL. LAR_ERROR_ARGUMENT when
 * no place is left, and for a size that does not fit the body: a radius between that at which faces
 * still feel it everywhere and half of the body's diagonal, a length up to five of these; and for a
 * `friction`, which only tools of the scene have. */
LAR_SIZED lar_status lar_simulation_add_tool(lar_simulation *simulation,
                                             const lar_tool_info *wanted, int32_t *tool,
                                             lar_error *error);
/* Takes one that was added away, from the present step on: it lets go, and its place is free. */
LAR_API lar_status lar_simulation_remove_tool(lar_simulation *simulation, int32_t tool,
                                              lar_error *error);

/* Strained elements and tools that press hard need shorter steps: for as long as they do, every
 * step is computed in several parts: 2, 3, 4, 6, 8, 12, ... up to 32. Now; 1: not divided. It is
 * decided every eight steps, and with tools or spares, wherever they are, as many as fit into
 * 0.4 ms: so a tool in the air changes the bits of a run whose steps are divided. */
LAR_API int32_t lar_simulation_step_parts(const lar_simulation *simulation);
/* How many steps were divided since the simulation was created, and into how many parts at most
 * (`max`; may be NULL). Going back, loading and a reset do not change these. */
LAR_API uint64_t lar_simulation_divided_steps(const lar_simulation *simulation, int32_t *max);
/* How often a grid of threads has been divided anew since the simulation was created. Where tools
 * press, elements come to cost many times what others do; when the slowest processor would be a
 * tenth faster with another division it gets one, between two calls that advance (not within a long
 * one), which takes as long as the first one did, and a hundredth of the time in all at most. The bits stay the same. 0 for
 * processes, threads of a processor, a distribution that was asked for, and more processors than
 * cores. */
LAR_API uint64_t lar_simulation_redivisions(const lar_simulation *simulation);

/* Where the scene allows it (mass_scaling: {strained: SHARE}) the elements that are strained most
 * move with more mass for a while, so that steps are divided into fewer parts, or none. */
typedef struct lar_heavier {
    int32_t elements;     /* that are heavier now */
    double share;         /* what they have more now, as a part of the model's mass */
    double mean_share;    /* the same over all steps since the simulation was created, */
    double largest_share; /* and at most */
} lar_heavier;

LAR_SIZED void lar_simulation_heavier(const lar_simulation *simulation, lar_heavier *heavier);

/* What the search for contact did since the start, in pairs of a node and a face. */
typedef struct lar_contact_info {
    uint64_t possible; /* every node against every face in every step */
    uint64_t boxed;    /* left over by the boxes of searches */
    uint64_t tested;   /* exact tests */
    uint64_t searches; /* times that the boxes were compared; without prediction: every step */
    uint64_t steps;    /* steps done with contact */
    int32_t touching;  /* nodes in contact in the last step, with bodies and planes */
    double deepest;    /* immersion of these [m] */
    uint64_t through;  /* times that a node was pressed through a face, deeper than contact reaches
                          or  over to the other side: bodies lie in each other, or behind */
    double way;        /* the farthest that a node went along an axis in a step, or a part of one
                          that is divided, where bodies may touch; of those on supports what they would go [m] */
    double deepest_ever; /* the largest `deepest` of all steps since the start [m] */
} lar_contact_info;

LAR_SIZED void lar_simulation_contact(const lar_simulation *simulation, lar_contact_info *info);

/* From how far on different bodies push each other, before they touch: the most of all that may
 * [m]; 0 where none do, or those that may touch at rest (docs/formats.md, contact). */
LAR_API double lar_simulation_contact_distance(const lar_simulation *simulation);

/* How many nodes lie inside another body that may touch them, now, where contact does not see them:
 * they came in past the end of a contact's faces, or from behind. *node (may be NULL): one of them;
 * -1: none. Takes as long as some steps, on processor 0. */
LAR_API lar_status lar_simulation_contact_inside(const lar_simulation *simulation, int32_t *count,
                                                 int32_t *node, lar_error *error);

/* ---- going back, saving, loading ---------------------------------------------------------- */

/* The state that lar_simulation_create made; tools at rest, added ones where they were added (they
 * stay; lar_simulation_load_from has those that the state was saved with). The first time it asks
 * for memory to keep that, and from the second time on it takes as long as
 * lar_simulation_load_from. */
LAR_API lar_status lar_simulation_reset(lar_simulation *simulation, lar_error *error);
/* Writes state and tools to a file, whole or not at all (docs/formats.md, checkpoint). */
LAR_API lar_status lar_simulation_save(const lar_simulation *simulation, const char *path,
                                       lar_error *error);
/* Takes up a saved state: from then on everything is as if it had never stopped, on any grid. A
 * damaged file, one of another model or of another time step is refused; nothing changes then. */
LAR_API lar_status lar_simulation_load(lar_simulation *simulation, const char *path,
                                       lar_error *error);

/* The same in memory, for whoever tries one thing after another from the same state: nodes, tools,
 * settings, and what the tools felt in the last advance (lar_tool_force), to the last bit. Memory
 * is asked for when it is created and not again, but to reach other processes. It serves all
 * simulations of the model, on any grid, that have as many tools, hands and spares, the same kind
 * of element and time step; others are refused (LAR_ERROR_ARGUMENT). One thread at a time, but any
 * number may take up what is there at once. */
typedef struct lar_saved lar_saved;

/* Empty; the caller destroys it, after or before the simulation, but before the model. */
LAR_API lar_status lar_saved_create(const lar_simulation *simulation, lar_saved **saved,
                                    lar_error *error);
LAR_API void lar_saved_destroy(lar_saved *saved);
/* Replaces what was saved there. LAR_ERROR_UNSTABLE when the run has broken off: that stays. */
LAR_API lar_status lar_simulation_save_to(const lar_simulation *simulation, lar_saved *saved,
                                          lar_error *error);
/* As often as one likes; counts of contact (lar_contact_info) begin anew, as after
 * lar_simulation_load. Takes as long as a few steps. */
LAR_API lar_status lar_simulation_load_from(lar_simulation *simulation, const lar_saved *saved,
                                            lar_error *error);

/* What a saved state was made with: a simulation that shall take it up needs the same. */
typedef struct lar_checkpoint_info {
    lar_element_kind element;
    int32_t nodes, elements; /* of the model */
    int32_t tools;           /* of the model, and lar_options.hands */
    double time_step;        /* [s] */
    uint64_t step;
    int32_t spares; /* lar_options.spares must be as many at least: tools were added */
} lar_checkpoint_info;

/* Reads a saved state without taking it up. LAR_ERROR_FORMAT when it is none, or damaged. */
LAR_SIZED lar_status lar_checkpoint_inspect(const char *path, lar_checkpoint_info *info,
                                            lar_error *error);

/* ---- results on disk -------------------------------------------------------------------- */

typedef struct lar_results lar_results;

/* Opens a folder for results of this simulation's model (made when missing): frames as .vtu with
 * one .pvd, and probes.csv, as the model's `output` asks. Frames appear whole or not at all.
 * LAR_ERROR_IO while another run, or other results of this program, are written there: the folder
 * is locked until they are closed, or the process ends. */
LAR_API lar_status lar_results_open(const char *folder, const lar_simulation *simulation,
                                    lar_results **results, lar_error *error);
/* The same, and the embedded surface, if any, in every frame (.vtp), which takes
 * many times the room; lar_results_open writes it only where the scene's output says so. */
LAR_API lar_status lar_results_open_surface(const char *folder, const lar_simulation *simulation,
                                            lar_results **results, lar_error *error);
/* The same, with or without the embedded surface, for a simulation that goes on from a state
 * (lar_simulation_load): frames and lines of the folder up to its time stay, provided that one is of
 * that time, and what is later goes. Else nothing stays, as with lar_results_open.
 * LAR_ERROR_IO where probes.csv has other columns than the model's probes. */
LAR_API lar_status lar_results_resume(const char *folder, const lar_simulation *simulation,
                                      int surface, lar_results **results, lar_error *error);
/* How many frames the series has, with those that stayed: 0 for NULL. */
LAR_API int lar_results_frames(const lar_results *results);
/* Adds the present state as a frame, of any simulation of that model (else LAR_ERROR_ARGUMENT).
 * LAR_ERROR_UNSTABLE when it is not finite: nothing is added. */
LAR_API lar_status lar_results_add(lar_results *results, const lar_simulation *simulation,
                                   lar_error *error);
/* Completes the series and frees the results, also on failure. NULL is fine. */
LAR_API lar_status lar_results_close(lar_results *results, lar_error *error);

/* Seconds of simulated time between frames that the model asks for; 0 when it does not say. */
LAR_API double lar_model_output_interval(const lar_model *model);
/* Seconds that the model's own description lasts (its last ramp or table), at least 0. */
LAR_API double lar_model_duration(const lar_model *model);

/* ---- coming to rest ------------------------------------------------------------------------
 *
 * Static answers are states of rest. The measure is the kinetic energy over the strain energy, from
 * the moment on at which loads and prescribed values are constant:
 *
 *     lar_rest rest;
 *     lar_rest_begin(&rest, simulation);
 *     while (!lar_rest_look(&rest, simulation) && rest.next <= rest.limit)
 *         if (lar_simulation_advance(simulation, rest.next - lar_simulation_steps(simulation), &e))
 *             ...
 *
 * The step in which rest is found is the same on every grid and instruction set. */

/* Steps of the simulation, from `begin` to `end`, and what was seen there. */
typedef struct lar_rest_window {
    uint64_t begin, end;
    double largest, sum; /* kinetic energy [J] */
    int32_t looks;
} lar_rest_window;

typedef struct lar_rest {
    uint64_t next;  /* the step at which to look next */
    uint64_t limit; /* the step at which to give up: 1000 times the period of a slow shear wave
                       after `since`, or when damping has taken all but e^-100 of the energy, which
                       may be ten times as long */
    int reached;    /* 1: the body is at rest */
    int looked;     /* not 0: `left` is known; 2: most of it is what viscous terms still relax */
    double since;   /* no load or prescribed value changes after that time [s]; infinite where a wave or
                       a curve comes again and again: then there is no rest, and `limit` is 0 */
    double kinetic, strain; /* when a window last ended, strain with the hourglass energy [J] */
    double left;            /* largest kinetic energy lately, what damping will still take and what
                               viscous terms store that will have relaxed, as a share of the strain energy; where that is next to nothing, of one
                               at which this share is rounding */
    double share;           /* at rest `left` is at most that */
    /* The rest is its own. */
    uint64_t since_step, every;
    double mean_before;
    lar_rest_window window;
} lar_rest;

/* A body that nothing damps gets the damping with which it comes to rest soonest [1/s], that of its
 * slowest motion, as lar_simulation_set_damping; 0: it is damped already, or the model says that it
 * is not. Solves for that motion: some thousand steps' time. `damping` may be NULL. */
LAR_API lar_status lar_rest_damp(lar_simulation *simulation, double *damping, lar_error *error);
LAR_API void lar_rest_begin(lar_rest *rest, const lar_simulation *simulation);
/* Looks when simulation has come to `rest.next`, otherwise costs nothing; as long as some ten
 * steps. Returns rest.reached. */
LAR_API int lar_rest_look(lar_rest *rest, const lar_simulation *simulation);

/* Damping in proportion to mass [1/s]. */
LAR_API double lar_model_damping(const lar_model *model);
/* Gravity at a time [s] as the model says [m/s^2]; 1: it follows a curve, 0: it is constant. */
LAR_API int lar_model_gravity(const lar_model *model, double time, double gravity[3]);
/* 1: the model asks for a run until it is at rest (a static analysis, `duration: rest`). */
LAR_API int lar_model_until_rest(const lar_model *model);

/* ---- sessions: people and devices ----------------------------------------------------------
 *
 *     your threads: tool_move ---> latest wins --->  engine's thread: every tick (1 ms)
 *                   tool_force <-- latest <--------    tools, steps, forces, snapshot, pace
 *                   snapshot   <-- when asked for --
 *
 * A session advances a simulation in real time, on a thread of its own, and exchanges
 * tools' positions and forces once in a tick. All calls may come from any thread; none makes the
 * engine wait. docs/session.md.
 */

typedef struct lar_session lar_session;

typedef struct lar_session_options {
    double tick;            /* seconds of simulated time between exchanges; 0: 1 ms, or what 10,000
                               steps take. In whole steps, 10,000 at most, lar_session_info.tick,
                               for a clock of one's own: lar_options.tick makes it exact */
    double pace;            /* simulated seconds per second of the clock; 0: as fast as it goes */
    int paused;             /* not 0: starts paused */
    double tool_speed;      /* tools follow their devices no faster than this [m/s]; 0: 1 m/s */
    double hand_force;      /* hands pull no harder than this [N]; 0: 1 N */
    const char *record;     /* path of a recording to write, from the start; NULL: none */
    int priority;           /* 1 to 99: the engine's thread goes before all ordinary ones of the
                               machine (SCHED_FIFO), where the system allows it, and the other
                               threads of its simulation with it; 0: ordinary */
    uint64_t hash_every;    /* steps between the hashes of a recording; 0: 100 */
    int stop_when_unstable; /* not 0: a run that becomes unstable stops the session; 0: it goes back
                               to a sound state and on from there (lar_session_status.recoveries) */
} lar_session_options;

LAR_SIZED lar_session_options lar_session_options_default(void); /* pace 1, all others 0 */

/* Takes the simulation over until the session is closed: no other call may use it, but
 * lar_simulation_field with lar_simulation_node_value, _element_value and _stored_energy, and what
 * is said to be constant (counts, names, time step). `options` may be NULL. */
LAR_SIZED lar_status lar_session_open(lar_simulation *simulation,
                                      const lar_session_options *options, lar_session **session,
                                      lar_error *error);
/* Starts the thread. */
LAR_API lar_status lar_session_start(lar_session *session, lar_error *error);
/* Instead of starting it: one tick now, in the thread that calls, for a host that has a clock of
 * its own. What was asked for is done first; while the session is paused nothing is computed.
 * `pace` means nothing then, and calls that wait are done at once between two ticks. From the first
 * tick on it cannot be started any more. Where the run has stopped: why (lar_session_status.error).
 */
LAR_API lar_status lar_session_tick(lar_session *session, lar_error *error);
/* Ends the thread within a tick, closes devices and the recording. NULL is fine. No other call may
 * be under way or come after it, and servers are closed before. The simulation may be used again,
 * and is the caller's to destroy. Closing fails only when a recording could not be completed. */
LAR_API lar_status lar_session_close(lar_session *session, lar_error *error);

/* What a session was opened with: constant. `info` is the caller's. */
typedef struct lar_session_info {
    const lar_simulation *simulation; /* for the calls that are allowed meanwhile */
    uint64_t tick_steps;              /* steps of a tick */
    double tick;                      /* the same [s] */
    lar_session_options options;      /* no zeros where they stand for something; record: NULL */
} lar_session_info;

LAR_SIZED void lar_session_inspect(const lar_session *session, lar_session_info *info);

/* Asked for here, done at the end of the tick under way, in this order. */
LAR_API void lar_session_play(lar_session *session);
LAR_API void lar_session_pause(lar_session *session);
LAR_API void lar_session_step(lar_session *session, uint64_t steps); /* pauses then; 0: nothing */
/* 0 to 1e6, as lar_session_options.pace; another one is passed over. */
LAR_API void lar_session_set_pace(lar_session *session, double pace);
/* These wait until it is done, or failed. */
LAR_API lar_status lar_session_reset(lar_session *session, lar_error *error);
LAR_API lar_status lar_session_save(lar_session *session, const char *path, lar_error *error);
LAR_API lar_status lar_session_load(lar_session *session, const char *path, lar_error *error);
LAR_API lar_status lar_session_save_to(lar_session *session, lar_saved *saved, lar_error *error);
LAR_API lar_status lar_session_load_from(lar_session *session, const lar_saved *saved,
                                         lar_error *error);
/* Begins a recording at `path`, after the end of the one under way; NULL ends that only.
 * LAR_ERROR_IO when there is another file at `path`, or a recording that is being written. */
LAR_API lar_status lar_session_record(lar_session *session, const char *path, lar_error *error);

/* As lar_simulation_set_gravity and the others, at the end of the tick under way; done, or failed,
 * when they return. Refused while a recording is being played, and with LAR_ERROR_UNSTABLE
 * when the run has broken off. */
LAR_API lar_status lar_session_set_gravity(lar_session *session, const double gravity[3],
                                           lar_error *error);
LAR_API lar_status lar_session_set_damping(lar_session *session, double damping, lar_error *error);
LAR_API lar_status lar_session_set_stiffness(lar_session *session, int32_t material, double factor,
                                             lar_error *error);
LAR_API lar_status lar_session_set_parameter(lar_session *session, int32_t material,
                                             const char *name, double value, lar_error *error);
LAR_API lar_status lar_session_activate(lar_session *session, int32_t material, double value,
                                        lar_error *error);
LAR_API lar_status lar_session_set_force(lar_session *session, int32_t node, const double force[3],
                                         lar_error *error);
LAR_API lar_status lar_session_set_force_on(lar_session *session, const char *set,
                                            const double force[3], lar_error *error);
LAR_API lar_status lar_session_set_support(lar_session *session, int32_t node, unsigned axes,
                                           int held, lar_error *error);
LAR_API lar_status lar_session_set_support_on(lar_session *session, const char *set, unsigned axes,
                                              int held, lar_error *error);
/* As they were at the end of the last tick. */
LAR_API void lar_session_gravity(const lar_session *session, double gravity[3]);
LAR_API double lar_session_damping(const lar_session *session);
LAR_API double lar_session_stiffness(const lar_session *session, int32_t material);
LAR_API double lar_session_activation(const lar_session *session, int32_t material);

/* As lar_simulation_add_tool and lar_simulation_remove_tool, likewise. A tool that has a device is
 * not removed. What was added stays when a run goes back to a sound state by itself, and comes to
 * stand above the body that it finds there. */
LAR_SIZED lar_status lar_session_add_tool(lar_session *session, const lar_tool_info *wanted,
                                          int32_t *tool, lar_error *error);
LAR_API lar_status lar_session_remove_tool(lar_session *session, int32_t tool, lar_error *error);
/* What a tool is, as of the last tick: as lar_simulation_tool. */
LAR_SIZED lar_status lar_session_tool_info(const lar_session *session, int32_t tool,
                                           lar_tool_info *info, lar_error *error);

/* Where a tool's device is now: the tool follows, no faster than options.tool_speed. A tool that
 * has a device (lar_session_attach) does not listen. */
LAR_API lar_status lar_session_tool_move(lar_session *session, int32_t tool,
                                         const lar_tool_pose *pose, lar_error *error);
/* Takes hold and lets go, as lar_simulation_grasp and lar_simulation_release, between two ticks;
 * what was asked of a hand before does not count any more. Waits for that: a tick at most, and
 * none while the session rests. A grasper's jaws move no faster than options.tool_speed allows, so
 * *held is what a hand has got, and 0 for a grasper: lar_tool_force.held tells later. Refused
 * (LAR_ERROR_ARGUMENT) while a recording is played and for a tool that has a device, and with
 * LAR_ERROR_UNSTABLE after the run has broken off. Recordings have both. */
LAR_API lar_status lar_session_grasp(lar_session *session, int32_t tool, const double point[3],
                                     int32_t *held, lar_error *error);
LAR_API lar_status lar_session_release(lar_session *session, int32_t tool, lar_error *error);

/* The same without waiting, for threads that serve many, or draw: done between two ticks likewise,
 * and not before the session is started. LAR_ERROR_PEER while 256 requests wait already: ask again.
 * What comes of a grasp is known by its ticket, which is any number but 0. */
LAR_API lar_status lar_session_ask_grasp(lar_session *session, int32_t tool, const double point[3],
                                         uint64_t ticket, lar_error *error);
LAR_API lar_status lar_session_ask_release(lar_session *session, int32_t tool, lar_error *error);

/* What came of the latest grasp of a tool that was asked for so and is done. */
typedef struct lar_grasp_answer {
    uint64_t ticket;   /* 0: there was none */
    int32_t held;      /* as of lar_session_grasp */
    lar_status status; /* likewise: why nothing is held, or LAR_OK */
} lar_grasp_answer;

LAR_API lar_status lar_session_grasp_answer(const lar_session *session, int32_t tool,
                                            lar_grasp_answer *answer, lar_error *error);
/* Of the last tick: pose and force, either may be NULL. The pose is where the tool is: tissue may
 * keep it from where its hand asks it to be. */
LAR_SIZED lar_status lar_session_tool_force(const lar_session *session, int32_t tool,
                                            lar_tool_pose *pose, lar_tool_force *force,
                                            lar_error *error);

/* What a hand feels that leads a tool by lar_session_tool_move, of the last tick: what a driver in
 * this process gives to its device. Spring and damper of the coupling between hand and tool, not
 * the tissue itself: bounded, and passive for a device that holds it until the next tick. Counted
 * so, a hand gets 0.5 mJ and 1 mW more than was put in at most, and so much again by turning; only
 * a jump farther than any of the last ticks may take one tick's force besides, once
 * (docs/devices.md). 0 while nobody leads the tool. Either may be NULL. */
LAR_API lar_status lar_session_tool_felt(const lar_session *session, int32_t tool, double force[3],
                                         double torque[3], lar_error *error);

/* As lar_simulation_tool_touches, between two ticks: waits for that. */
LAR_API lar_status lar_session_tool_touches(lar_session *session, int32_t tool, int32_t max,
                                            lar_touch *touch, int32_t *count, lar_error *error);

/* What a tool had to bear since the session was opened. */
typedef struct lar_tool_load {
    double force;       /* the largest of all ticks [N] */
    double limit;       /* lar_tool_force.limit [N] */
    int reached;        /* not 0: it was kept from following its hand (lar_tool_force.limited) */
    double grasp_force; /* the largest lar_tool_force.grasp_force of all ticks [N] */
} lar_tool_load;

LAR_API lar_status lar_session_tool_load(const lar_session *session, int32_t tool,
                                         lar_tool_load *load, lar_error *error);

/* Connects a tool with a device for as long as the session lives (docs/devices.md):
 *     "script:FILE.csv"     positions at times
 *     "udp:HOST:PORT"       packets of positions in, of forces out; HOST should be a loopback one
 *     "gamepad:N"           the N-th game controller, from 0
 * any of them with ",trocar=X:Y:Z" behind for an instrument that pivots there. */
LAR_API lar_status lar_session_attach(lar_session *session, int32_t tool, const char *device,
                                      lar_error *error);

/* Status of a tool's device. Zero where its kind has no such number. */
typedef struct lar_device_status {
    const char *name;  /* as it was attached, lives as long as the session; NULL: no device */
    int port;          /* where it listens */
    int connected;     /* not 0: a client is connected now */
    uint64_t received; /* positions taken */
    uint64_t answered; /* of these, with a force; what is sent besides while it fades is not counted */
    uint64_t refused;  /* malformed packets, or packets from another sender */
    uint64_t late;     /* packets that came after a newer one, or twice */
    uint64_t lost;     /* sequence numbers that never came */
    uint64_t timeouts; /* times that no packet came for too long */
    double answer_p50, answer_p99, answer_p999, answer_max; /* packet in to force out [s] */
} lar_device_status;

/* As of the last second. A tool without a device has a status of zeros. */
LAR_SIZED lar_status lar_session_device(const lar_session *session, int32_t tool,
                                        lar_device_status *status, lar_error *error);

typedef enum lar_session_state {
    LAR_SESSION_IDLE = 0, /* not started */
    LAR_SESSION_PLAYING,
    LAR_SESSION_PAUSED,
    LAR_SESSION_STOPPED /* see error and message */
} lar_session_state;

/* Why a session is in slow motion. */
typedef enum lar_slow_cause {
    LAR_SLOW_NOT = 0,  /* it is not, or nobody knows yet */
    LAR_SLOW_STEP,     /* a step takes longer than the time that it stands for */
    LAR_SLOW_DIVISION, /* the same, because steps are divided now */
    LAR_SLOW_MACHINE   /* a step does not, but other programs take the processor away */
} lar_slow_cause;

/* Counts of how long things took: bin i of lar_session_status.step_bins holds what took from
 * lar_time_bin(i) to lar_time_bin(i + 1), two bins to every doubling; the first and the last one
 * hold what is beyond, too. */
enum { LAR_TIME_BINS = 40 };
LAR_API double lar_time_bin(int bin); /* 1.024 us for bin 0 [s] */

/* Status of a session. Times are of the clock, in seconds; rates over about the last second. */
typedef struct lar_session_status {
    lar_session_state state;
    uint64_t step;
    double time;                                    /* simulated [s] */
    double step_p50, step_p99, step_p999, step_max; /* of a step, engine alone: tick / steps */
    double tick_p50, tick_p99, tick_p999, tick_max; /* from a tick's due time to its forces */
    uint32_t step_bins[LAR_TIME_BINS]; /* steps and ticks by their time, since the start */
    uint32_t tick_bins[LAR_TIME_BINS];
    uint64_t ticks, misses;      /* ticks whose forces came after the next was due, those of slow
                                    motion left out */
    uint64_t slow_ticks;         /* these: late because the session is in slow motion; their times
                                    in tick_... count from when they began */
    double pace;                 /* simulated seconds per second of the clock, as asked for; 0: as
                                    fast as it goes */
    double real_time_factor;     /* simulated time per time of the clock, paused
                                    time left out, since the start */
    double real_time_factor_now; /* the same over the last second */
    double engine_rate, haptic_rate, snapshot_rate; /* steps, ticks, snapshots per second */
    int slow_motion;                                /* not 0: slower than asked for, now */
    double lag;                                     /* behind the clock [s]; what is over 0.1 s is
                                                       given up, and counted in `skipped` */
    double skipped;
    int recording;
    char recording_lost[1016]; /* why a recording ended by itself, such as a full disk; "": none
                                  did since the latest one was begun */
    lar_status error;    /* why it stopped: LAR_OK while it has not; LAR_ERROR_UNSTABLE: the run
                            broke and did not go back (stop_when_unstable, or nobody has moved a
                            tool since the start), reset or load takes it up again;
                            LAR_ERROR_PEER: a processor is lost, nothing but closing is left */
    char message[1016];  /* the same as a sentence; "" */
    uint64_t recoveries; /* how often the run broke and went back to a sound state by itself,
                            since the session was opened */
    char recovery[1016]; /* the last time: "went back 0.62 s to step 15800: " and why; "" */
    uint64_t placed;     /* how often the run was put somewhere else: reset, loaded, went back.
                            Tools are where the state has them then, and in nobody's hand */
    int replaying;       /* not 0: a recording is being played (lar_session_replay) */
    double replay_time, replay_length; /* of it: where it is and how long it lasts, in simulated
                                          seconds that were computed [s] */
    int32_t step_parts;                /* lar_simulation_step_parts at the end of the last tick */
    uint64_t divided_steps;            /* steps that were divided, since the session was opened */
    int32_t heavier;                   /* lar_heavier.elements, */
    double heavier_share;              /* and .share, at the end of the last tick */
    double step_min; /* the least processor time of a step in the last second [s]; 0: none */
    lar_slow_cause slow_cause; /* of the slow motion that is now */
    char slow_advice[256];     /* the same as a sentence, with what to do about it; "" */
} lar_session_status;

LAR_SIZED void lar_session_status_get(const lar_session *session, lar_session_status *status);

/* A tool at the end of a tick, as lar_session_tool_force has it. */
typedef struct lar_snapshot_tool {
    lar_tool_pose pose;
    double force[3], torque[3]; /* [N] [N m] */
} lar_snapshot_tool;

/* All nodes at the end of one step, and the tools. */
typedef struct lar_snapshot {
    uint64_t step;
    double time;    /* [s] */
    uint64_t hash;  /* lar_simulation_hash of that step */
    int32_t nodes;  /* of the model */
    double (*u)[3]; /* [nodes] displacements [m] */
    double kinetic; /* energy of its velocities, which are those of half a step before [J] */
    int32_t tools;
    lar_snapshot_tool *tool; /* [tools] */
} lar_snapshot;

/* Memory for snapshots of this session; those of another one are refused (LAR_ERROR_ARGUMENT).
 * lar_snapshot_destroy frees it, NULL is fine. */
LAR_API lar_status lar_snapshot_create(const lar_session *session, lar_snapshot **snapshot,
                                       lar_error *error);
LAR_API void lar_snapshot_destroy(lar_snapshot *snapshot);

/* Asks the engine for the state at the end of a tick and waits for it, at most `seconds`. Fills
 * `snapshot` and returns LAR_OK, or LAR_ERROR_PEER when none came in time. While paused or stopped
 * it is the present state. Any number of threads may ask, each with a snapshot of its own. */
LAR_API lar_status lar_session_snapshot(lar_session *session, lar_snapshot *snapshot,
                                        double seconds, lar_error *error);

/* The same without waiting, for who draws when it is time to draw: asks with the first call, and
 * fills `snapshot` in that one in which what was asked for has come; then *fresh is 1, and the next
 * is asked for. Else *fresh is 0, and `snapshot` as it was. */
LAR_API lar_status lar_session_snapshot_poll(lar_session *session, lar_snapshot *snapshot,
                                             int32_t *fresh, lar_error *error);

/* Ticks whose forces are kept. */
enum { LAR_HISTORY_TICKS = 8192 };

/* Forces on a tool, one entry per tick: copies those after tick `after` (0: from the oldest that is
 * kept), at most `max`, oldest first. *last is the number of the
 * last one copied (`after` when there is none). Returns how many. */
LAR_API int32_t lar_session_force_history(const lar_session *session, int32_t tool, uint64_t after,
                                          int32_t max, float (*force)[3], uint64_t *last);

/* ---- recordings ----------------------------------------------------------------------------- */

/* What a recording was made with: a simulation that shall play it needs the same. */
typedef struct lar_recording_info {
    lar_element_kind element;
    int32_t nodes, elements; /* of the model */
    int32_t tools;           /* all, these among them: */
    int32_t hands;           /* lar_options.hands */
    double time_step;        /* [s] */
    uint64_t tick_steps;     /* steps of a tick */
    int32_t spares;          /* lar_options.spares: as many at least */
} lar_recording_info;

/* Reads the beginning of a recording. LAR_ERROR_FORMAT when it is none. */
LAR_SIZED lar_status lar_recording_inspect(const char *path, lar_recording_info *info,
                                           lar_error *error);

typedef struct lar_replay_report {
    uint64_t steps;     /* done */
    uint64_t hashes;    /* compared */
    uint64_t different; /* the first step whose hash differs; UINT64_MAX: none does */
    uint64_t recorded_hash, replayed_hash; /* there */
    int broken; /* not 0: the run broke where the recorded one did, at the recording's end, and all
                   hashes before are equal */
} lar_replay_report;

/* Plays a recording on a simulation of the same model and time step, on any grid, and compares the
 * hashes. The first difference ends it with LAR_ERROR_FORMAT, and `report` names the step. So does
 * a file that is damaged or cut off where it is; what comes before is played and compared, and
 * `different` says that it is equal. A run that breaks ends it with LAR_ERROR_UNSTABLE, and
 * `broken` says whether the recording ends with that, too. `callback` may be NULL: called with the
 * number of steps at the beginning, after every tick, reset and load, between two advances, so that
 * it may look at the simulation, on any grid, and not change it (lar_step_callback); 0 ends the
 * replay. */
LAR_SIZED lar_status lar_replay(lar_simulation *simulation, const char *path,
                                lar_step_callback *callback, void *context,
                                lar_replay_report *report, lar_error *error);

/* Plays a recording in the session, at its pace, with play, pause and step; it pauses at its end.
 * Tools follow the recording and nobody else meanwhile. NULL: ends that, and the run goes on from
 * where it is, as does a reset or a load. Refused while a recording is being made, and for one of
 * another model. A hash that differs from the recorded one pauses it, and `message` says where. */
LAR_API lar_status lar_session_replay(lar_session *session, const char *path, lar_error *error);
/* Goes to a moment of what is being played [s]: the steps from the nearest state before it that is
 * kept are computed as fast as it goes. */
LAR_API void lar_session_seek(lar_session *session, double seconds);

/* ---- the viewer's server --------------------------------------------------------------------- */

typedef struct lar_server lar_server;

typedef struct lar_server_options {
    const char *address; /* NULL: 127.0.0.1. Any other one needs a token */
    int port;            /* 0: a free one */
    const char *token;   /* what viewers must show: 8 to 128 letters, digits, - and _; NULL: none */
    const char *watch_token; /* who shows this one instead may watch and do nothing else; needs a
                                token beside it; NULL: none */
    const char *folder;      /* of the viewer's files; NULL: those installed with the library */
    const char *scan;        /* a segmented image (lariat mesh) whose slices viewers may see;
                                NULL: none */
    const char *save_folder; /* where the viewer's record and save go, made when it is missing;
                                NULL: they are refused */
    double save_max;         /* bytes of states and recordings that there may be in it, those from
                                 before included; 0: 4e9. One recording under way is ended there */
} lar_server_options;

/* Serves a session to viewers on a thread of its own. The session must outlive it; `model` is that
 * of its simulation, no other (LAR_ERROR_ARGUMENT). `options` may be NULL. LAR_ERROR_IO when it
 * cannot listen there, LAR_ERROR_UNSUPPORTED when this build has no libwebsockets.
 * docs/viewer-protocol.md. */
LAR_API lar_status lar_server_open(lar_session *session, const lar_model *model,
                                   const lar_server_options *options, lar_server **server,
                                   lar_error *error);
/* "http://127.0.0.1:8000/", with "#token=..." behind when there is one; lives as long as the
 * server. */
LAR_API const char *lar_server_url(const lar_server *server);
/* The address for those who may only watch, likewise; "" without a watch_token. */
LAR_API const char *lar_server_watch_url(const lar_server *server);
LAR_API int32_t lar_server_viewers(const lar_server *server); /* connected now */
LAR_API void lar_server_close(lar_server *server);            /* NULL is fine */
/* 1 when the page that is served without a `folder` is there; 0 when a page stands in for it that
 * says how to get it, and where this build has no libwebsockets. */
LAR_API int lar_server_has_page(void);

#ifdef __cplusplus
}
#endif

#include "lariat_sizes.h"
#endif
