/* Abaqus and CalculiX decks as models: what the parts of the reader share.
 *
 *     bytes --lar_inp_parse--> lar_mesh with its sets      `mesh:` in a scene stops here
 *       |---walk 1: materials, amplitudes, the step's procedure
 *       |---walk 2: sections, supports, loads, contact (they name sets, materials and amplitudes)
 *       '---finish: materials of elements, supports and loads gathered node by node
 *
 * One table says of every keyword in which walk it is read, that it is harmless (solver settings),
 * or that it is left out with a notice (requests for results: one for all of them); every other one
 * is refused by name and line, because leaving it out would change the answer. The same holds for
 * parameters.
 *
 * In a deck what comes later overrides: a step's displacement takes the place of a support that
 * stands above. So supports are kept per node and axis while the deck is read, and made into lists
 * at its end.
 */
#ifndef LAR_MODEL_FORMAT_INP_DECK_H
#define LAR_MODEL_FORMAT_INP_DECK_H

#include "model/format/inp/reader.h"
#include "model/mesh/id_map.h"
#include "model/model.h"

typedef struct inp_material {
    char *name;
    int line;
    bool has_law, has_density;
    bool linear;    /* from *ELASTIC */
    double damping; /* ALPHA of *DAMPING [1/s] */
    int damping_line;
    lar_material value; /* its viscosity without what `instant` says */
    bool instant;       /* its moduli are those at once: MODULI=INSTANTANEOUS */
    int index;          /* in lar_model.material, -1 until a section uses it */
} inp_material;

/* Along what fibres run where a section says so. */
typedef struct inp_orientation {
    char *name;
    int directions;
    double direction[2][3];
} inp_orientation;

/* What *SURFACE INTERACTION says of the pairs that name it. */
typedef struct inp_interaction {
    char *name;
    double friction;
    int friction_line; /* 0: nothing is said of it */
} inp_interaction;

typedef struct inp_amplitude {
    char *name;
    int curve;
} inp_amplitude;

/* A displacement that is not zero. */
typedef struct inp_prescribed {
    double by;
    int curve;
} inp_prescribed;

/* One force or velocity of a node: equal ones become one entry. */
typedef struct inp_vector {
    double value[3];
    int32_t node;
} inp_vector;

/* Concentrated forces on one curve, summed per node. */
typedef struct inp_forces {
    int curve;
    int line; /* of the first */
    double (*force)[3];
} inp_forces;

/* A pressure on one face. */
typedef struct inp_pressure {
    int curve;
    double pressure;
    int32_t face; /* element * 6 + local face */
} inp_pressure;

/* An acceleration of GRAV. */
typedef struct inp_gravity {
    double by[3];
    int curve, line;
} inp_gravity;
enum { INP_GRAVITIES = 8 };

typedef enum inp_procedure { INP_NO_PROCEDURE, INP_STATIC, INP_VISCO, INP_DYNAMIC } inp_procedure;

typedef struct inp_step {
    int line;  /* of *STEP, 0: none so far */
    bool open; /* between *STEP and *END STEP */
    inp_procedure procedure;
    bool long_term; /* of *STATIC: what is viscous has relaxed */
    bool explicit;  /* of *DYNAMIC */
    double period;  /* [s] */
    int amplitude;  /* AMPLITUDE of *STEP: 0 not given, 1 STEP, 2 RAMP */
    bool large;     /* NLGEOM */
    bool supports;  /* a *BOUNDARY has been read in it */
    bool told;      /* a notice says when displacements are there */
} inp_step;

typedef struct inp_deck {
    inp_reader reader; /* position, path, error; what it knows of the mesh */
    lar_model *model;
    lar_mesh *mesh;
    lar_id_map nodes, elements;

    size_t material_count, material_room;
    inp_material *material;
    int64_t current; /* material that options belong to, -1: none */
    size_t orientation_count, orientation_room;
    inp_orientation *orientation;
    size_t interaction_count, interaction_room; /* *FRICTION belongs to the last of them */
    inp_interaction *interaction;
    size_t amplitude_count, amplitude_room;
    inp_amplitude *amplitude;

    inp_step step;
    bool results;       /* a notice says that requests for results were left out */
    int constant, ramp; /* curves, -1 until wanted */

    int32_t *hold; /* [nodes][3]: 0 free, 1 fixed, 2 + index into `prescribed` */
    size_t prescribed_count, prescribed_room;
    inp_prescribed *prescribed;
    size_t forces_count, forces_room;
    inp_forces *forces;
    double (*velocity)[3]; /* of *INITIAL CONDITIONS, NULL: none */
    int velocity_line;
    size_t pressure_count, pressure_room;
    inp_pressure *pressure;
    char *pressed; /* [elements][6]: the face has a pressure */
    int gravity_count;
    inp_gravity gravity[INP_GRAVITIES];
    unsigned char *heavy; /* [elements]: bits of those that act on it */
} inp_deck;

/* ---- values.c: what every card needs ------------------------------------------------- */

/* FILE:LINE: and the sentence; a notice likewise. */
lar_status inp_fail(const inp_deck *deck, int line, lar_status status, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
lar_status inp_notice(const inp_deck *deck, int line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
lar_status inp_no_memory(const inp_deck *deck, const char *what);
/* As much of a word as a message takes, for %.*s. */
int inp_shown(lar_span word);

/* Refuses a card with another parameter than these, with commas in between. */
lar_status inp_only(const inp_deck *deck, const inp_card *card, const char *known);
/* The value of a parameter that must be there. */
lar_status inp_need(const inp_deck *deck, const inp_card *card, const char *name, lar_span *value);

/* Fields of a data line, trimmed; at most `max`, more are an error. */
lar_status inp_fields(inp_deck *deck, lar_span line, lar_span *field, int max, int *count);
/* A finite number, or `fallback` where the field is empty or not there and that is allowed. */
lar_status inp_number(inp_deck *deck, const lar_span *field, int count, int at, const char *what,
                      double *value);
lar_status inp_optional(inp_deck *deck, const lar_span *field, int count, int at, const char *what,
                        double fallback, double *value);

/* The set that a card means by that name, in any case of letters and with or without its instance,
 * or NULL. */
const lar_set *inp_mesh_set(const inp_deck *deck, lar_span name, lar_set_kind kind);
/* What a field names: a node or a node set, an element or an element set. *index points into the
 * mesh or to `own`. Naming costs: few bytes could ask for any amount of work. */
lar_status inp_nodes(inp_deck *deck, lar_span field, int32_t *own, const int32_t **index,
                     int32_t *count);
lar_status inp_elements(inp_deck *deck, lar_span field, int32_t *own, const int32_t **index,
                        int32_t *count);
/* The faces of a surface; `what` names the user in messages. */
lar_status inp_faces(inp_deck *deck, lar_span field, const lar_set **set);

/* Of a list whose entries begin with their name: the one of that name in any case of letters, or
 * NULL. One more at its end, all zero but the name that the card gives it (NAME=), which is
 * refused where there is one of that name; `list` is the address of the array. */
void *inp_find(const void *entry, size_t count, size_t size, lar_span name);
lar_status inp_add(inp_deck *deck, const inp_card *card, void *list, size_t *room, size_t *count,
                   size_t size);
#define INP_FIND(deck, list, name)                                                                 \
    inp_find((deck)->list, (deck)->list##_count, sizeof *(deck)->list, name)
#define INP_ADD(deck, card, list)                                                                  \
    inp_add(deck, card, &(deck)->list, &(deck)->list##_room, &(deck)->list##_count,                \
            sizeof *(deck)->list)

/* Whether time is none, or the material's. */
static inline bool inp_is_static(const inp_deck *deck) {
    return deck->step.procedure == INP_STATIC || deck->step.procedure == INP_VISCO;
}

/* The curve of a condition: AMPLITUDE of its card, else what *STEP says, else `ramps`. */
lar_status inp_curve_of(inp_deck *deck, const inp_card *card, bool ramps, int *curve);
/* Refuses a load that stands outside of a step. */
lar_status inp_in_step(const inp_deck *deck, const inp_card *card);

/* ---- material.c -------------------------------------------------------------------------- */

lar_status inp_read_material(inp_deck *deck, const inp_card *card);
lar_status inp_read_elastic(inp_deck *deck, const inp_card *card);
lar_status inp_read_hyperelastic(inp_deck *deck, const inp_card *card);
lar_status inp_read_density(inp_deck *deck, const inp_card *card);
lar_status inp_read_damping(inp_deck *deck, const inp_card *card);
lar_status inp_read_section(inp_deck *deck, const inp_card *card);
/* Densities, notices and the damping of what sections use. */
lar_status inp_finish_materials(inp_deck *deck);

/* The material that an option belongs to, and its one line of numbers; its law; whether that makes
 * sense. */
lar_status inp_read_option(inp_deck *deck, const inp_card *card, lar_span *field, int max,
                           int *count, inp_material **material);
lar_status inp_take_law(inp_deck *deck, const inp_card *card, inp_material *material, lar_law law);
lar_status inp_check_law(const inp_deck *deck, const inp_material *material);

/* ---- fibre.c ----------------------------------------------------------------------------- */

lar_status inp_read_anisotropic(inp_deck *deck, const inp_card *card);
lar_status inp_read_orientation(inp_deck *deck, const inp_card *card);
/* The directions of a section's elements. */
lar_status inp_lay_fibres(inp_deck *deck, const inp_card *card, const lar_fibre *fibre,
                          const int32_t *element, int32_t count);

/* ---- viscous.c --------------------------------------------------------------------------- */

lar_status inp_read_viscoelastic(inp_deck *deck, const inp_card *card);
/* Whether the moduli of *ELASTIC or *HYPERELASTIC are those at once. */
lar_status inp_read_moduli(const inp_deck *deck, const inp_card *card, inp_material *material);
/* The viscosity of the model's material, once its moduli are known too, or what a static step takes
 * instead. */
lar_status inp_finish_viscosity(inp_deck *deck, const inp_material *from, lar_material *material);

/* ---- conditions.c ------------------------------------------------------------------------ */

lar_status inp_read_amplitude(inp_deck *deck, const inp_card *card);
lar_status inp_read_boundary(inp_deck *deck, const inp_card *card);
lar_status inp_read_initial(inp_deck *deck, const inp_card *card);
lar_status inp_finish_supports(inp_deck *deck);
/* The nodes with a vector that is not zero, sorted by vector; *vector is the caller's. */
lar_status inp_sort_vectors(const inp_deck *deck, const double (*value)[3], inp_vector **vector,
                            int32_t *count);
/* Nodes of the run of equal vectors that begins at `first`; *end is behind it. */
lar_status inp_take_run(const inp_deck *deck, const inp_vector *vector, int32_t count,
                        int32_t first, lar_node_list *nodes, int32_t *end);

/* ---- loads.c ----------------------------------------------------------------------------- */

lar_status inp_read_cload(inp_deck *deck, const inp_card *card);
lar_status inp_read_dload(inp_deck *deck, const inp_card *card);
lar_status inp_read_dsload(inp_deck *deck, const inp_card *card);
lar_status inp_finish_loads(inp_deck *deck);

/* ---- results.c --------------------------------------------------------------------------- */

/* Once for all such cards. */
lar_status inp_notice_results(inp_deck *deck, const inp_card *card);
lar_status inp_read_node_print(inp_deck *deck, const inp_card *card);

/* ---- contact.c --------------------------------------------------------------------------- */

lar_status inp_read_interaction(inp_deck *deck, const inp_card *card);
lar_status inp_read_contact_pair(inp_deck *deck, const inp_card *card);
lar_status inp_read_surface_behavior(inp_deck *deck, const inp_card *card);
lar_status inp_read_friction(inp_deck *deck, const inp_card *card);

#endif
