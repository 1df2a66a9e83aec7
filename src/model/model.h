/* The model: WHAT is simulated, everything in SI units and index form.
 *
 * Built once by a reader (scene.c, feb.c), immutable afterwards, shared freely. Nothing in here
 * knows how a body answers (mechanics) or who computes what (divide).
 */
#ifndef LAR_MODEL_MODEL_H
#define LAR_MODEL_MODEL_H

#include "model/curve.h"
#include "model/triangles/embedded_surface.h"
#include "model/material.h"
#include "model/mesh/mesh.h"
#include "model/mesh/surface.h"
#include "model/tool_script.h"

/* A list of node indices, owned. */
typedef struct lar_node_list {
    int32_t count;
    int32_t *node;
} lar_node_list;

/* Axes of nodes held where they are. */
typedef struct lar_fix {
    lar_node_list nodes;
    unsigned axes;
} lar_fix;

/* A turn about an axis, right-handed, and a slide along it, both times a curve: what moves a rigid
 * body from one place to another (Chasles). */
typedef struct lar_screw {
    double point[3], axis[3]; /* [m], of unit length */
    double angle, slide;      /* [rad], [m] */
    int curve;                /* index into lar_model.curve */
} lar_screw;

#define LAR_PI 3.14159265358979323846

enum { LAR_SCREWS_MAX = 6 }; /* of one entry: as many as a rigid body has ways to move */

/* Axes of nodes moved by `by` (metres) times a curve; or, with screws, nodes moved along all axes
 * as one rigid body, by one screw after the other or by a tool (LAR_TOOL_RIGID). */
typedef struct lar_move {
    lar_node_list nodes;
    unsigned axes;
    double by;
    int curve; /* index into lar_model.curve */
    int screw_count;
    lar_screw *screw; /* owned */
    int tool;         /* one more than the tool that moves them instead, as a rigid body; else 0 */
} lar_move;

/* Springs between nodes and where these are at rest: what holds tissue that itself gives way. */
typedef struct lar_spring_bed {
    lar_node_list nodes;
    double *stiffness; /* [nodes.count] along every axis [N/m] */
    int line;          /* of the file that says so, for messages; 0: unknown */
} lar_spring_bed;

/* A dead force on every node of a list: `force` newtons per node, times a curve. */
typedef struct lar_nodal_load {
    lar_node_list nodes;
    double force[3];
    int curve;
    int line; /* of the file that says so, for messages; 0: unknown */
} lar_nodal_load;

/* A pressure (pascal, positive pushes on the body) that follows the deformed faces. */
typedef struct lar_pressure_load {
    int32_t count;
    int32_t *face; /* element * 6 + local face */
    double pressure;
    int curve;
} lar_pressure_load;

/* Velocity of nodes at the start. */
typedef struct lar_initial_velocity {
    lar_node_list nodes;
    double velocity[3];
} lar_initial_velocity;

/* What may touch what (T 2.2.8). Faces are element * 6 + local face, of the outer surface. */
typedef struct lar_contact {
    enum {
        LAR_CONTACT_SELF,    /* `faces` with themselves and each other */
        LAR_CONTACT_BETWEEN, /* `faces` with `against` */
        LAR_CONTACT_PLANE    /* the nodes of `faces` with a fixed plane */
    } kind;
    int32_t face_count, against_count;
    int32_t *face, *against;
    double through[3], normal[3]; /* of a plane; the unit normal points to where bodies may be */
    double friction;              /* Coulomb's coefficient */
    double restitution;           /* of free rigid bodies on a plane, 0 to 1 */
    double distance;              /* from which bodies push each other, at most [m]; 0: it goes by
                                     their elements and the step */
} lar_contact;

/* Tools of a model and bytes of their names. A simulation takes four hands besides. */
enum { LAR_MODEL_TOOLS_MAX = 32, LAR_TOOL_PLANES_MAX = 12, LAR_TOOL_NAME_MAX = 63 };

enum { LAR_FREE_TURNS = 8 }; /* beside LAR_AXIS_X and so on; alone: about `point` */

/* A tool: something hard that a device moves. */
typedef struct lar_tool {
    char *name;
    lar_tool_shape shape;
    double radius, length;    /* [m] */
    double spread;            /* [rad] between open jaws */
    double friction;          /* Coulomb's coefficient */
    unsigned free;            /* axes along which forces take a rigid one, and LAR_FREE_TURNS */
    double point[3], axis[3]; /* about which it turns then; no axis: any [m] */
    uint32_t planes;          /* bits of the entries of contact that stop it then */
    lar_tool_pose rest;
    lar_tool_script
        path; /* begins at time 0 with `rest`; no rows: stays there; owned by the model */
} lar_tool;

/* What the public header tells of it; the name stays its own. */
static inline lar_tool_info lar_tool_inspect(const lar_tool *tool) {
    return (lar_tool_info){.name = tool->name,
                           .shape = tool->shape,
                           .radius = tool->radius,
                           .length = tool->length,
                           .spread = tool->spread,
                           .rest = tool->rest,
                           .friction = tool->friction};
}

/* What frames and probes may hold of elements, means of each. */
typedef enum lar_cell_field {
    LAR_CELL_VON_MISES,
    LAR_CELL_PRESSURE,
    LAR_CELL_ENERGY,
    LAR_CELL_STRESS,
    LAR_CELL_STRAIN,
    LAR_CELL_VOLUME,
    LAR_CELL_FIELDS
} lar_cell_field;

typedef struct lar_cell_field_row {
    unsigned bit; /* in lar_output.fields */
    const char *name, *unit;
    int components; /* 1, or 6 of a symmetric tensor: xx yy zz xy yz zx */
} lar_cell_field_row;
extern const lar_cell_field_row lar_cell_field_table[LAR_CELL_FIELDS];

/* A part of each line of probes.csv: of some nodes the mean displacement or the sum of what their
 * supports, or what bodies and planes that touch them, do to them; the mean of a field over the
 * volume at rest of some elements; where a tool is and what tissue does to it; the energies of all.
 */
typedef struct lar_probe {
    char *name;
    lar_node_list nodes; /* elements, where it is a field's mean; none of a tool and of energies */
    enum {
        LAR_PROBE_DISPLACEMENT,
        LAR_PROBE_REACTION,
        LAR_PROBE_CONTACT,
        LAR_PROBE_MEAN,
        LAR_PROBE_TOOL,
        LAR_PROBE_ENERGY
    } what;
    bool moment;          /* of the forces that are summed, too */
    double about[3];      /* that point, at rest in space [m] */
    lar_cell_field field; /* of a mean */
    int tool;             /* of the model's, where it is one's */
} lar_probe;

enum { /* beside the bits of lar_field */
       LAR_OUTPUT_FIBRES = 64,
       LAR_OUTPUT_STRETCH = 128,
       LAR_OUTPUT_STRESS = 256,
       LAR_OUTPUT_STRAIN = 512,
       LAR_OUTPUT_VOLUME = 1024,
       LAR_OUTPUT_CONTACT = 2048
};

typedef struct lar_output {
    double every;    /* seconds, 0: only the end */
    unsigned fields; /* lar_field bits (lariat.h), and these */
    bool surface;    /* the embedded surface too, in every frame */
    int probe_count;
    lar_probe *probe;
} lar_output;

struct lar_model {
    char *title;
    char *source; /* the file */
    lar_mesh mesh;
    int mesh_file_count; /* of a scene: the files that the mesh was read from */
    char **mesh_file;

    int material_count;
    lar_material *material;
    int32_t *element_material; /* [mesh.element_count] */

    int curve_count;
    lar_curve *curve;

    double gravity[3]; /* m/s^2, times gravity_curve[axis] where that is >= 0 */
    int gravity_curve[3];
    double damping;        /* 1/s, mass-proportional */
    bool damps_itself;     /* that is a guess, since nobody gave one for a body that is to rest */
    double time_step;      /* seconds, 0: automatic */
    int damping_line;      /* of the file that says so, for messages; 0: unknown */
    int time_step_line;    /* likewise */
    double mass_step;      /* seconds that all elements' steps shall be stable up to, with more mass
                              where they need it (step/mass_scaling.h); 0: nothing is added */
    double mass_share;     /* at most so much, as a part of the model's mass */
    double strained_share; /* strained elements may have so much more in place of steps in parts, as
                              a part of the model's mass (step/mass/heavier.h); 0: nothing */
    double view[3];        /* where viewers look from at first, a unit vector; 0 0 0: they choose */
    double duration;       /* seconds that the description lasts, 0: open */
    bool until_rest;       /* a run goes on until the body is at rest, see model/rest.h */
    bool by_material_time; /* mass only serves to find the states of rest on the way that viscous
                              materials take: no step may be longer than their times */
    bool own_units;        /* of a deck: it may count in millimetres and tonnes, so that no length
                              or speed in SI units means anything */

    int fix_count, move_count, spring_count, load_count, pressure_count, initial_count;
    lar_fix *fix;
    lar_move *move;
    lar_spring_bed *spring;
    lar_nodal_load *load;
    lar_pressure_load *pressure;
    lar_initial_velocity *initial;

    int contact_count, tool_count;
    lar_contact *contact;
    lar_tool *tool;

    lar_output output;

    lar_surface surface;           /* of the mesh; lar_model_check fills it */
    lar_embedded_surface embedded; /* a fine surface for display; without vertices: there is none */

    const char *fibre_remedy; /* how this kind of file gives directions, NULL: as scenes do */

    /* What a deck asks for and Lariat does not do, one sentence each, named to the user. */
    int notice_count;
    char **notice;
};

/* An empty model with defaults (no gravity curve, ...), or NULL. Destroy with
 * lar_model_destroy. */
lar_model *lar_model_create(void);

/* Appends a zeroed entry to one of the arrays above and returns it, NULL without memory:
 * lar_fix *f = LAR_MODEL_APPEND(model, fix); */
void *lar_model_append(void **array, int *count, size_t size);
#define LAR_MODEL_APPEND(model, name)                                                              \
    lar_model_append((void **)&(model)->name, &(model)->name##_count, sizeof *(model)->name)

/* The shortest step, and tick of a host, that can be asked for [s]: no matter is so fast, and in
 * steps of 1e-320 s nothing moves. */
#define LAR_STEP_MIN 1e-15

/* ":LINE" for behind a file's name in a message; nothing where the line is 0. Returns `text`. */
enum { LAR_LINE_TEXT = 16 };
const char *lar_line_text(int line, char text[LAR_LINE_TEXT]);

/* Whether it has tools that touch it. */
static inline bool lar_model_touched(const lar_model *model) {
    bool touched = false;
    for (int i = 0; i < model->tool_count; i++)
        touched = touched || model->tool[i].shape != LAR_TOOL_RIGID;
    return touched;
}

/* The first material that is viscous; NULL: none is. */
static inline const lar_material *lar_model_viscous(const lar_model *model) {
    for (int i = 0; i < model->material_count; i++)
        if (model->material[i].viscosity.terms > 0) return &model->material[i];
    return NULL;
}

/* The first material with fibres, or active ones; NULL: there are none. */
static inline const lar_material *lar_model_fibrous(const lar_model *model) {
    for (int i = 0; i < model->material_count; i++)
        if (lar_fibre_here(&model->material[i].fibre)) return &model->material[i];
    return NULL;
}

/* The first material with an active stress; NULL: there is none. */
static inline const lar_material *lar_model_active(const lar_model *model) {
    for (int i = 0; i < model->material_count; i++)
        if (lar_fibre_active(&model->material[i].fibre)) return &model->material[i];
    return NULL;
}

/* The unit vector along the fibres of element e; zero where it has none. */
static inline const double *lar_model_fibre(const lar_model *model, lar_gid e) {
    static const double none[3] = {0};
    return model->mesh.fibre ? model->mesh.fibre[e] : none;
}

/* The same of both families of a pair, 0 where there is no second. */
static inline void lar_model_fibres(const lar_model *model, lar_gid e, double out[6]) {
    const double *first = lar_model_fibre(model, e);
    for (int i = 0; i < 3; i++) {
        out[i] = first[i];
        out[3 + i] = model->mesh.second ? model->mesh.second[e][i] : 0;
    }
}

/* The material of element e. */
static inline const lar_material *lar_model_material_of(const lar_model *model, lar_gid e) {
    return &model->material[model->element_material[e]];
}

/* The highest frequency of an element with the mass that it gets [rad/s]. */
static inline double lar_model_slowed(const lar_model *model, double frequency) {
    return model->mass_step > 0 && frequency > 2 / model->mass_step ? 2 / model->mass_step
                                                                    : frequency;
}

/* Adds a notice (printf-style). */
lar_status lar_model_notice(lar_model *model, lar_error *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Everything that must hold across the parts: materials assigned to every element and valid,
 * node lists within range, fixed and moved axes not in conflict, finite values, tools and contacts
 * that make sense. Builds the surface. The last step of every reader. */
lar_status lar_model_check(lar_model *model, lar_error *error);

/* The readers of whole models; the first chooses by extension (lar_model_open goes on from what it
 * has read: simulation/rest.c). */
lar_status lar_model_read(const char *path, lar_model **model, lar_error *error);
lar_status lar_scene_read(const char *path, lar_model **model, lar_error *error);
lar_status lar_feb_read(const char *path, lar_model **model, lar_error *error);
/* Abaqus and CalculiX. */
lar_status lar_inp_read(const char *path, lar_model **model, lar_error *error);
/* From memory, for tests and fuzzing. `path` is for messages and relative files. */
lar_status lar_scene_parse(const char *path, const lar_bytes *bytes, lar_model **model,
                           lar_error *error);
lar_status lar_feb_parse(const char *path, const lar_bytes *bytes, lar_model **model,
                         lar_error *error);
lar_status lar_inp_deck_parse(const char *path, const lar_bytes *bytes, lar_model **model,
                              lar_error *error);
/* Whether such a file says more than a mesh: materials, supports, loads, a step. A *SOLID SECTION
 * whose material is not in the file says nothing. */
bool lar_inp_is_deck(const lar_bytes *bytes);

#endif
