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
 * one sentence to *error, which may be NULL; outputs are set on success only. Destroy functions
 * accept NULL. The library never exits, and prints nothing.
 *
 * Threads. A model may be used by any number of threads at once. A simulation, and the results that
 * are written from it, belong to one thread at a time: also calls that take a const simulation may
 * use scratch memory inside it, though never change what another call returns.
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

/* ---- errors ---------------------------------------------------------------------------- */

typedef enum lar_status {
    LAR_OK = 0,
    LAR_ERROR_ARGUMENT,    /* a call or a command line that makes no sense */
    LAR_ERROR_IO,          /* a file or folder that cannot be read or written */
    LAR_ERROR_FORMAT,      /* a file that is damaged or breaks its format */
    LAR_ERROR_MODEL,       /* a readable model that cannot be simulated */
    LAR_ERROR_UNSUPPORTED, /* something sensible that Lariat does not do */
    LAR_ERROR_MEMORY,      /* the system refuses memory */
    LAR_ERROR_UNSTABLE,    /* a run that left the range in which its results mean something */
    LAR_ERROR_PEER         /* another processor that is lost, silent or does not fit */
} lar_status;

typedef struct lar_error {
    lar_status status;
    char message[1016]; /* one sentence: file, line or element, cause and remedy */
} lar_error;

/* Version of the library, "major.minor.patch". */
LAR_API const char *lar_version(void);

/* ---- model ------------------------------------------------------------------------------ */

typedef struct lar_model lar_model;

/* Reads a model: a scene (.yaml, docs/formats.md), a FEBio deck (.feb), or a bare mesh (.vtu .vtk
 * .msh .inp), which gets a soft default material and no supports. The caller destroys it. */
LAR_API lar_status lar_model_open(const char *path, lar_model **model, lar_error *error);
LAR_API void lar_model_destroy(lar_model *model);

/* What `lariat info` prints. */
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
} lar_model_info;

/* Counts, measures and the stable step: goes through all elements. `info` is the caller's. */
LAR_API lar_status lar_model_inspect(const lar_model *model, lar_model_info *info,
                                     lar_error *error);

/* Reference positions of all nodes, [nodes][3], in metres. Lives as long as the model. */
LAR_API const double (*lar_model_positions(const lar_model *model))[3];

/* The number that the mesh file gives to an element (messages use it); -1 when there is none. */
LAR_API int64_t lar_model_element_id(const lar_model *model, int32_t element);

/* One material. Strings live as long as the model. */
typedef struct lar_material_info {
    const char *name;                   /* "" when it has none */
    const char *law;                    /* as in scenes: "neo-hookean", ... */
    int32_t elements;                   /* that are made of it */
    double density;                     /* [kg/m^3] */
    double shear_modulus, bulk_modulus; /* at rest [Pa] */
} lar_material_info;

/* One named set of the mesh or the scene. */
typedef struct lar_set_info {
    const char *name;
    const char *kind; /* "nodes", "elements" or "faces" */
    int32_t count;
} lar_set_info;

/* Material `index` of lar_model_info.materials; LAR_ERROR_ARGUMENT beyond. */
LAR_API lar_status lar_model_material(const lar_model *model, int32_t index,
                                      lar_material_info *info, lar_error *error);

/* The named sets, as lar_material_info for materials: set `index` of the count. */
LAR_API int32_t lar_model_set_count(const lar_model *model);
LAR_API lar_status lar_model_set(const lar_model *model, int32_t index, lar_set_info *info,
                                 lar_error *error);

/* What the model's file asks for and Lariat does not do, one sentence each: read them, the
 * results leave it out. NULL beyond the count. */
LAR_API int32_t lar_model_notice_count(const lar_model *model);
LAR_API const char *lar_model_notice_text(const lar_model *model, int32_t index);

/* Writes the demonstration organ (uterus.yaml and its mesh) into a folder, which is made when it
 * is missing. */
LAR_API lar_status lar_demo_write(const char *folder, lar_error *error);

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
    double time_step; /* seconds; 0 takes the model's */

    /* The parallel computer: processors in a grid, each with its part of the model. The state and
     * its hash are the same with all of these (docs/parallel.md). Strings are read by
     * lar_simulation_create only. */
    const char *grid;         /* processors along x, y and z, "2x2x3"; NULL: no division */
    int32_t threads;          /* of every processor; 0: one */
    const char *scheme;       /* who sends to whom: "all" (NULL), "local", "one", "two" */
    const char *channels;     /* of scheme local: "sequential" (NULL) or "concurrent" */
    const char *distribution; /* "cut" (NULL), "genetic", "metis", "random", or a file's path */
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
} lar_options;

/* hex8, the widest instruction set, the model's time step, one processor. Start from these: options
 * may grow. */
LAR_API lar_options lar_options_default(void);

/* Compiles the model for this processor and sets the state to rest. `options` may be NULL. The
 * model must outlive the simulation. */
LAR_API lar_status lar_simulation_create(const lar_model *model, const lar_options *options,
                                         lar_simulation **simulation, lar_error *error);
LAR_API void lar_simulation_destroy(lar_simulation *simulation);

/* Advances by `steps` time steps. On LAR_ERROR_UNSTABLE the message names element or node, place,
 * time and cause; the state is then the one after the failing step, or, with several processors,
 * after the step at which all have stopped, some steps later: nearly always finite and fit for a
 * picture (lar_results_add refuses it where it is not), but not for going on, and further calls
 * fail with the same message. */
LAR_API lar_status lar_simulation_advance(lar_simulation *simulation, uint64_t steps,
                                          lar_error *error);

/* Called after every step with the number of steps done, by the thread that advances; 0 ends the
 * advance: at once, or, with several processors, some steps later in the same step on all. */
typedef int lar_watch(void *context, uint64_t step);

/* The same, watched. Ask lar_simulation_steps where it ended. */
LAR_API lar_status lar_simulation_advance_watched(lar_simulation *simulation, uint64_t steps,
                                                  lar_watch *watch, void *context,
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

/* 64 bits over step number, displacements and velocities of all nodes. The same for every
 * instruction set, thread count and division of the model. */
LAR_API uint64_t lar_simulation_hash(const lar_simulation *simulation);

/* Energies now, in joules. external = work done by loads and prescribed motion since the start,
 * damping = energy taken out; kinetic + strain + hourglass + damping = external (+ start). */
typedef struct lar_energy {
    double kinetic, strain, hourglass, external, damping;
} lar_energy;

/* Goes through all nodes and elements: as long as many steps. Asks for no memory. */
LAR_API void lar_simulation_energy(const lar_simulation *simulation, lar_energy *energy);

/* ---- results on disk -------------------------------------------------------------------- */

typedef struct lar_results lar_results;

/* Opens a folder for results of this simulation's model (made when missing): frames as .vtu with
 * one .pvd, and probes.csv, as the model's `output` asks. Frames appear whole or not at all. */
LAR_API lar_status lar_results_open(const char *folder, const lar_simulation *simulation,
                                    lar_results **results, lar_error *error);
/* Adds the present state as a frame. LAR_ERROR_UNSTABLE when it is not finite: nothing is added. */
LAR_API lar_status lar_results_add(lar_results *results, const lar_simulation *simulation,
                                   lar_error *error);
/* Completes the series and frees the results, also on failure. NULL is fine. */
LAR_API lar_status lar_results_close(lar_results *results, lar_error *error);

/* Seconds of simulated time between frames that the model asks for; 0 when it does not say. */
LAR_API double lar_model_output_interval(const lar_model *model);
/* Seconds that the model's own description lasts (its last ramp or table), at least 0. */
LAR_API double lar_model_duration(const lar_model *model);

#ifdef __cplusplus
}
#endif
#endif
