/* The Python module lariat: what its files share.
 *
 *     errors.c        lar_status to exceptions           convert.c   numbers, vectors, texts
 *     array.c         memory out and in, by the buffer protocol
 *     model.c         class Model                        model_arrays.c   Model.from_arrays
 *     simulation.c    class Simulation: life, advance    simulation_state.c   arrays, states
 *     change.c        gravity, stiffness, forces         tools.c     tools and their contacts
 *     session.c       class Session: life, clock         session_state.c   states, snapshots
 *     mesh.c          lariat.mesh                    meshing.c   class Meshing
 *     saved.c         class Saved: a state in memory     view.c      class View: the browser
 *     results.c       class Results: states on disk      look.c      rays, stress and strain
 *     rest.c          Simulation.rest
 *     batch.c         class Batch: its life, advance     batch_state.c    arrays, tools, resets
 *     pool.c          its threads                        module.c    the module itself
 *
 * It is written against CPython's stable ABI (Py_LIMITED_API 3.11): one binary for all later
 * versions, nothing but Python's headers to build it, and of Lariat nothing but lariat.h.
 *
 * Threads. The library leaves it to the caller that a simulation is used by one thread at a time.
 * Python's callers are promised more: a second thread gets an exception. Whoever computes on a
 * simulation takes it (`busy`) before it lets go of the interpreter's lock, and calls that keep the
 * lock look at `busy` first, so the lock protects the mark. Worker threads do not live on in the
 * child of a fork: what has any is refused there, and left alone when it is collected.
 */
#ifndef LARIAT_PYTHON_MODULE_H
#define LARIAT_PYTHON_MODULE_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <lariat.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* What was asked of a tool, which a move keeps where it says nothing; NaN: what is now. */
typedef struct python_asked {
    double orientation[4], opening;
} python_asked;

/* ---- classes -------------------------------------------------------------------------------- */

typedef struct python_model {
    PyObject_HEAD lar_model *model;
    PyObject *recipe; /* what __reduce__ gives: a callable and its arguments */
} python_model;

typedef struct python_session python_session;

typedef struct python_simulation {
    PyObject_HEAD lar_simulation *simulation; /* NULL: closed */
    python_model *model;
    PyObject *options;       /* dict: as it was asked for */
    python_session *session; /* that has taken it over, which keeps this alive; NULL: none */
    bool busy;               /* a thread computes on it without the interpreter's lock */
    bool broken;             /* its run is unstable, until a reset or a load */
    unsigned generation;     /* python_generation when it was made */
    python_asked asked[LAR_TOOLS_MAX];
} python_simulation;

typedef struct python_saved {
    PyObject_HEAD lar_saved *saved;
    python_model *model;
    lar_simulation_info of;  /* whom it serves */
    int users;               /* threads that take it up now; -1: one fills it */
    unsigned long long step; /* of the state in it */
    double time;             /* [s] */
    python_asked asked[LAR_TOOLS_MAX];
} python_saved;

typedef struct python_view python_view;

struct python_session {
    PyObject_HEAD lar_session *session; /* NULL: closed */
    python_simulation *simulation;
    python_view *view; /* its server, which keeps this alive; NULL: none */
    bool closing;      /* no further calls */
    int calls;         /* under way without the interpreter's lock */
    unsigned generation;
    python_asked asked[LAR_TOOLS_MAX];
    python_session *next; /* of all that are open */
};

struct python_view {
    PyObject_HEAD lar_server *server; /* NULL: closed */
    python_session *session;
};

extern PyTypeObject *python_model_type, *python_simulation_type, *python_saved_type,
    *python_batch_type, *python_session_type, *python_view_type, *python_array_type;

bool python_errors_add(PyObject *module);
bool python_array_add(PyObject *module);
bool python_model_add(PyObject *module);
bool python_meshing_add(PyObject *module);
bool python_saved_add(PyObject *module);
bool python_simulation_add(PyObject *module);
bool python_results_add(PyObject *module);
bool python_batch_add(PyObject *module);
bool python_session_add(PyObject *module);
bool python_view_add(PyObject *module);
/* Makes a type and adds it to the module, where it has a public name. */
PyTypeObject *python_type_add(PyObject *module, PyType_Spec *spec, bool is_public);
/* Frees an object of one of these classes, whose parts have been freed. */
void python_object_free(PyObject *object);

/* One more in every child of a fork. */
extern unsigned python_generation;

/* Without the interpreter's lock. */
#define PYTHON_UNLOCKED(statement)                                                                 \
    do {                                                                                           \
        PyThreadState *python_thread = PyEval_SaveThread();                                        \
        statement;                                                                                 \
        PyEval_RestoreThread(python_thread);                                                       \
    } while (0)

/* Looks whether Ctrl-C was pressed while a call computes without the lock. `thread` is what
 * PyEval_SaveThread gave; the caller takes the lock back with it. */
typedef struct python_watch {
    PyThreadState *thread;
    struct timespec last;
    unsigned calls;
    bool watching; /* this is the main thread */
    bool stopped;  /* an exception is set */
} python_watch;
bool python_watch_begin(python_watch *watch); /* true: this is the main thread */
/* Ten times a second; false: stop. */
bool python_watch_look(python_watch *watch);

/* ---- errors: all return NULL, or false ------------------------------------------------------ */

extern PyObject *python_error_argument, *python_error_state;

PyObject *python_raise(const lar_error *error);
/* A sentence of the library's in the words of this module, a new str. */
PyObject *python_sentence(const char *message);
/* The same about a scene, and of what is found in it later: where it was a dict, keys stand in
 * place of lines. `scene`: its text; NULL or None: there is none. */
PyObject *python_sentence_of(PyObject *scene, const char *message);
PyObject *python_raise_of(PyObject *scene, const lar_error *error);
/* The text of the scene of a model of arrays, borrowed; NULL: it is from a file. */
PyObject *python_model_scene(const python_model *model);
/* What a call returns that has nothing to say: None, or as python_raise. */
PyObject *python_answer(lar_status status, const lar_error *error);
/* An ArgumentError (a ValueError) or a TypeError: PyErr_Format's formats. */
bool python_refuse(const char *format, ...);
bool python_refuse_type(const char *format, ...);

/* ---- values --------------------------------------------------------------------------------- */

/* `name` begins the message: "steps: expected ..." From 0 to 2^53: */
bool python_steps(PyObject *source, const char *name, unsigned long long *steps);
bool python_number(PyObject *source, const char *name, double *number);
/* Of arguments that may be left out: NULL leaves *out as it is, of a word also None. */
bool python_int(PyObject *source, const char *name, int *out);
bool python_real(PyObject *source, const char *name, double *out);
bool python_word(PyObject *source, const char *name, const char **out);
/* Whether a callback's answer is False, or numpy's: what a comparison of arrays gives. */
bool python_is_no(PyObject *answer);
/* `count` finite numbers from any sequence. */
bool python_vector(PyObject *source, const char *name, int count, double *out);
PyObject *python_tuple(const double *value, int count);
/* A path as bytes, which is not empty, or NULL and an exception. */
PyObject *python_path(PyObject *source, const char *name);
/* Scene text: a str as it is, a dict as JSON, which is YAML. A new str. */
PyObject *python_scene_text(PyObject *scene);
/* The pose that a move asks for. Orientation and opening, NULL or None, stay what was asked for
 * before, or what they are now, as the orientation of a free body (`turns`) always is. */
bool python_pose(PyObject *position, PyObject *orientation, PyObject *opening,
                 const python_asked *asked, bool turns, const lar_tool_pose *now,
                 lar_tool_pose *pose);
/* After it was accepted, and when nothing is known any more. */
void python_asked_set(python_asked *asked, const lar_tool_pose *pose);
void python_asked_forget(python_asked asked[LAR_TOOLS_MAX]);
PyObject *python_pose_dict(const lar_tool_pose *pose);
PyObject *python_force_dict(const lar_tool_force *force);
PyObject *python_wrench(const lar_tool_force *force);
PyObject *python_touch_list(const lar_touch *touch, int32_t count);
PyObject *python_tool_dict(const lar_tool_info *info);
/* "sphere", ... as lar_tool_info for lar_simulation_add_tool. */
bool python_tool_wanted(PyObject *args, PyObject *keywords, lar_tool_info *info);
/* A str in UTF-8 that lives as long as it; NULL and an exception where it is none, has half of a
 * pair of surrogates, or a character 0, which the library would take for its end. */
const char *python_text(PyObject *text, const char *name);
/* The index of a material: a number or a name; None: all, -1. */
bool python_material(const lar_model *model, PyObject *source, int32_t *index);

/* What a call about forces names: a node or a set, and a vector or None. */
typedef struct python_force_call {
    const char *set; /* NULL: the node */
    int32_t node;
    double vector[3];
    const double *force; /* NULL: none any more */
} python_force_call;
/* A node, or the name of a set of nodes. */
bool python_where(PyObject *where, const char **set, int32_t *node);
bool python_force_parse(PyObject *args, PyObject *keywords, python_force_call *call);

/* ---- arrays --------------------------------------------------------------------------------- */

/* A memoryview of [rows][columns] items (columns 0: [rows]); format 'd', 'f', 'i' or 'H'. `owner`
 * keeps the memory alive. Read only. */
PyObject *python_array_of(PyObject *owner, const void *data, char format, Py_ssize_t rows,
                          Py_ssize_t columns);
/* The same with fresh memory, writable; *data is where it is. */
PyObject *python_array_new(char format, Py_ssize_t rows, Py_ssize_t columns, void **data);

/* Where a call puts an array: the caller's own, or a fresh one. */
typedef struct python_target {
    Py_buffer view; /* of the caller's */
    PyObject *result;
    void *data;
} python_target;
/* `out` NULL or None: a fresh one. */
bool python_target_open(PyObject *out, char format, Py_ssize_t rows, Py_ssize_t columns,
                        python_target *target);
/* The same of one, two or three dimensions. */
bool python_target_of_shape(PyObject *out, char format, int dimensions, const Py_ssize_t *shape,
                            python_target *target);
/* Gives what the call returns, a new reference, or NULL when `failed`. */
PyObject *python_target_close(python_target *target, bool failed);

/* An array that came in: [rows][columns] (columns 0: [rows]) of float64 or int32. */
typedef struct python_rows {
    Py_buffer view;
    bool held; /* the view is */
    void *own; /* converted */
    const void *data;
    Py_ssize_t rows;
} python_rows;
/* Takes a buffer of float64 as it is, nested sequences of numbers by copying them; all finite. */
bool python_doubles(PyObject *source, const char *name, int columns, python_rows *out);
/* Likewise int32; other integers are converted. */
bool python_integers(PyObject *source, const char *name, int columns, python_rows *out);
void python_rows_free(python_rows *rows);
/* Refuses an array of numpy.ma of which something is masked. */
bool python_unmasked(PyObject *source, const char *name);
/* Likewise float64 [members][rows][columns], of exactly this shape. */
bool python_block(PyObject *source, const char *name, const Py_ssize_t shape[3], python_rows *out);

typedef struct python_meshing {
    PyObject_HEAD lar_meshing *meshing;
} python_meshing;
PyObject *python_meshing_wrap(lar_meshing *meshing); /* takes it over, also on failure */
/* lariat.mesh */
PyObject *python_mesh(PyObject *module, PyObject *args, PyObject *keywords);

/* Model.rays */
PyObject *python_model_rays(PyObject *me, PyObject *args, PyObject *keywords);

/* ---- simulations ---------------------------------------------------------------------------- */

/* The simulation for a call that keeps the interpreter's lock; NULL: an exception says why not. */
lar_simulation *python_simulation_look(python_simulation *self, const char *call);
/* The same, and taken until python_simulation_give: for calls that let go of the lock. */
lar_simulation *python_simulation_take(python_simulation *self, const char *call);
void python_simulation_give(python_simulation *self);
/* Whether its run is sound; else an UnstableError says why not. The caller has looked. */
bool python_simulation_sound(python_simulation *self, const char *call);
/* Looks, and takes, for calls that change what goes on: an unstable run does not. */
lar_simulation *python_simulation_look_sound(python_simulation *self, const char *call);
lar_simulation *python_simulation_take_sound(python_simulation *self, const char *call);
/* For one thread that fills it, or any number that take up what is there: false, with an exception,
 * where others are in the way. What is taken is given back by each. */
bool python_saved_take(python_saved *saved, bool fills, const char *call);
void python_saved_give(python_saved *saved);
/* Whether the state may be put into the simulation, or the other way round; else what differs. */
bool python_saved_fits(const python_saved *saved, const lar_simulation *simulation,
                       const char *call);
/* One advance of the library, without the interpreter's lock; Ctrl-C ends it. */
bool python_simulation_advance(python_simulation *self, unsigned long long steps);
/* Whole steps of a time from 0 on. */
bool python_seconds(PyObject *seconds, python_simulation *self, const char *call,
                    unsigned long long *steps);
/* The simulation for a call about a tool, and the index of that, of a number or a name. Reading a
 * number may run any code, so who may use the simulation is looked at afterwards. */
lar_simulation *python_simulation_tool(python_simulation *self, const char *call, PyObject *source,
                                       int32_t *index);

/* Where the nodes are now [m], [nodes][3]; needs no interpreter. */
void python_positions(const lar_simulation *simulation, double (*out)[3]);

/* Rows of the class that stand in other files; each table ends with a row of NULL. */
extern PyMethodDef python_state_methods[], python_change_methods[], python_tool_methods[],
    python_look_methods[], python_rest_methods[];
extern PyGetSetDef python_change_properties[], python_tool_properties[];

/* ---- threads of a batch ------------------------------------------------------------------------
 *
 *     items      0 . . . . . . . . n - 1      each takes the next one that is left
 *     caller     ###   ####   ##  (waits, looks for Ctrl-C)
 *     thread 1      ###    ###  ###           asleep before and after: a condition, no polling
 *
 * Threads start with the first run and live as long as the pool. They know nothing of Python. */

typedef struct python_pool python_pool;

/* Does one item; `caller`: in the thread that called python_pool_run. */
typedef void python_pool_work(void *context, int item, bool caller);
/* Called by the caller ten times a second while it only waits for others. */
typedef void python_pool_wait(void *context);

/* The caller and threads - 1 more; NULL: no memory. */
python_pool *python_pool_create(int threads);
/* Nobody runs anything on it. In a child of a fork its threads are not there: `lost` frees nothing.
 */
void python_pool_destroy(python_pool *pool, bool lost);

/* Does `items` items and returns when all are done. Where the system gives fewer threads these do
 * it: what comes out may not depend on it. */
void python_pool_run(python_pool *pool, int items, python_pool_work *work, python_pool_wait *wait,
                     void *context);

/* ---- batches -------------------------------------------------------------------------------- */

/* A simulation of a batch, and what became of it in the call under way. */
typedef struct python_member {
    python_simulation *simulation;
    lar_simulation *taken;
    lar_status status;
    char *message; /* owned; NULL: nothing failed */
} python_member;

typedef struct python_batch {
    PyObject_HEAD int count, workers;
    int nodes, tools; /* of every member, tools without spares */
    bool busy;
    unsigned generation; /* of the pool's threads */
    python_pool *pool;
    python_member *member; /* [count]; NULL: closed */
} python_batch;

/* Some members, or all, for a call on them. */
typedef struct python_members {
    python_rows rows;
    int count;
} python_members;
static inline int python_member_at(const python_members *members, int place) {
    return members->rows.data ? ((const int32_t *)members->rows.data)[place] : place;
}
/* Each at most once; NULL or None: all. */
bool python_members_parse(python_batch *self, PyObject *source, python_members *members);

/* What a call does with one member, the `place`-th of those that it is for, in any thread. */
typedef struct python_member_call python_member_call;
typedef lar_status python_member_work(python_member_call *call, python_member *member, int place,
                                      bool caller, lar_error *error);
struct python_member_call {
    const char *name;
    python_member_work *work;
    python_members members;
    double cost; /* about how long it takes for one [s]: threads are woken for more than some */
    void *context;
    python_watch watch;
    int stop; /* atomic */
};
/* Whether all states can be kept; else raises which members have broken off, and why. */
bool python_batch_sound(python_batch *self, const char *name);
/* Takes the members, does it on all of them, frees call->members, and raises what failed first. */
bool python_batch_run(python_batch *self, python_member_call *call);
python_batch *python_batch_look(PyObject *me, const char *call);
extern PyMethodDef python_batch_state_methods[];

/* ---- sessions ------------------------------------------------------------------------------- */

/* The session for a call that keeps the lock, and for one that does not. */
lar_session *python_session_look(python_session *self, const char *call);
/* For a call that lets it go on, or leads a tool: one that has stopped does neither. */
lar_session *python_session_look_sound(python_session *self, const char *call);
lar_session *python_session_take(python_session *self, const char *call);
void python_session_give(python_session *self);
lar_session *python_session_tool(python_session *self, const char *call, PyObject *source,
                                 int32_t *index);
void python_view_shut(python_view *view);
PyObject *python_view_open(PyObject *session, PyObject *args, PyObject *keywords);

extern PyMethodDef python_session_state_methods[], python_session_change_methods[],
    python_session_tool_methods[];
extern PyGetSetDef python_session_change_properties[], python_session_tool_properties[];

/* A class's methods or properties: tables one behind the other. */
PyMethodDef *python_join_methods(PyMethodDef *const *tables, int count);
PyGetSetDef *python_join_properties(PyGetSetDef *const *tables, int count);

#endif
