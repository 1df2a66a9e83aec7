#include "study/doctor.h"

#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/pin.h"
#include "base/parallel_for.h"
#include "base/thread.h"
#include "comm/comm.h"
#include "comm/mpi_world.h"
#include "simulation/simulation.h"
#include "study/bench/step.h"
#include "study/frames/image.h"
#include "study/inverse/solver.h"
#include "study/implicit/linear_solver.h"
#include "study/real_time.h"

/* ---- parts ---------------------------------------------------------------------------------- */

/* cmake/LariatOptional.cmake says which of these are defined. */
#ifdef LAR_HAVE_NIFTI
static const bool nifti = true;
#else
static const bool nifti = false;
#endif
#ifdef LAR_HAVE_METIS
static const bool metis = true;
#else
static const bool metis = false;
#endif
#ifdef LAR_HAVE_LIBWEBSOCKETS
static const bool server = true;
#else
static const bool server = false;
#endif

#ifdef LAR_HAVE_PYTHON
static const bool python = true;
#else
static const bool python = false;
#endif

/* Built with its headers, loaded when the first controller is opened. It stays loaded: what its own
 * libraries keep would look like leaks. */
static bool controllers(void) {
#ifdef LAR_HAVE_SDL2
    return dlopen("libSDL2-2.0.so.0", RTLD_LAZY | RTLD_LOCAL) != NULL;
#else
    return false;
#endif
}

static bool backend(const char *name) {
    lar_comm_backend_info info;
    for (int i = 0; lar_comm_backend_list(i, &info); i++)
        if (strcmp(info.name, name) == 0) return !info.missing;
    return false;
}

/* In a build folder the module's Python files stand before it is built, which `make demo` does not
 * do. Installed commands have no such folder beside them. */
static bool has_python(void) {
    char command[PATH_MAX] = "", path[PATH_MAX + 64];
    ssize_t length = readlink("/proc/self/exe", command, sizeof command - 1);
    char *slash = length > 0 ? strrchr(command, '/') : NULL;
    if (!python || !slash) return python;
    snprintf(path, sizeof path, "%.*s/python/lariat/", (int)(slash - command), command);
    if (access(path, F_OK) != 0) return true;
    strcat(path, "_lariat.abi3.so");
    return access(path, R_OK) == 0;
}

void lar_features_look(lar_feature feature[LAR_FEATURES]) {
    const lar_feature found[LAR_FEATURES] = {
        {"nifti", "lariat mesh reads scans in NIfTI (.nii, .nii.gz)",
         "apt-get install libnifti-dev, then make", nifti},
        {"viewer", "lariat view, sessions for the browser and for devices",
         "apt-get install libwebsockets-dev, then make", server},
        {"page", "the page that lariat view shows",
#ifdef LAR_VIEWER_PACKAGE
         "apt-get install " LAR_VIEWER_PACKAGE,
#else
         server ? "apt-get install nodejs npm, then make; npm needs the network"
                : "apt-get install libwebsockets-dev nodejs npm, then make",
#endif
         lar_server_has_page() != 0},
        {"gamepad", "game controllers move instruments",
#ifdef LAR_HAVE_SDL2
         "apt-get install libsdl2-2.0-0",
#else
         "apt-get install libsdl2-dev, then make",
#endif
         controllers()},
        {"cores", "threads are bound to cores", "apt-get install libhwloc-dev, then make",
         lar_pin_cores() > 0},
        {"metis", "lariat partition --method metis", "apt-get install libmetis-dev, then make",
         metis},
        {"fit", "lariat fit, parameters of tissue from experiments",
         "apt-get install libcminpack-dev, then make", lar_inverse_available()},
        {"png", "lariat fit --profile reads frames in .png",
         "apt-get install libpng-dev, then make", lar_grey_has_png()},
        {"ucx", "--comm ucx, processors of a cluster", "apt-get install libucx-dev, then make",
         backend("ucx")},
        {"openmpi", "processors that Open MPI's mpirun starts",
         "apt-get install openmpi-bin libopenmpi-dev, then make", lar_mpi_module("openmpi")},
        {"mpich", "processors that MPICH's mpirun starts",
         "apt-get install mpich libmpich-dev, then make", lar_mpi_module("mpich")},
        {"petsc", "lariat bench implicit --solver cg and bcgs",
         "apt-get install petsc-dev, then make", lar_linear_solver_petsc()},
        {"python", "import lariat, the Python module",
         python ? "make (make demo builds the command and the page only)"
                : "apt-get install python3-dev, then make",
         has_python()}};
    memcpy(feature, found, sizeof found);
}

/* ---- the machine ---------------------------------------------------------------------------- */

static void *nothing(void *context) {
    return context;
}

/* The system is asked by doing it: limits, capabilities and containers all have a say. */
static bool may_be_urgent(void) {
    lar_thread thread;
    if (lar_thread_start_urgent(&thread, 1, nothing, NULL) != 0) return false;
    lar_thread_join(&thread);
    return true;
}

void lar_doctor_look(lar_doctor_machine *machine) {
    struct timespec tick = {0};
    clock_getres(CLOCK_MONOTONIC, &tick);
    *machine =
        (lar_doctor_machine){.usable_cores = lar_usable_cores(),
                             .memory = lar_machine_memory("MemTotal"),
                             .free = lar_machine_memory("MemAvailable"),
                             .priority = may_be_urgent(),
                             .clock_tick = (double)tick.tv_sec + 1e-9 * (double)tick.tv_nsec};
    lar_machine_look(&machine->machine);
}

/* ---- measured ------------------------------------------------------------------------------- */

static lar_status measure_organ(const lar_model *organ, lar_doctor_measured *m, lar_error *error) {
    static const double LONG = 0.3; /* [s] */
    lar_real_time speed;
    lar_model_info info;
    lar_simulation *simulation = NULL;
    lar_status status = lar_model_inspect(organ, &info, error);
    if (!status) status = lar_real_time_measure(organ, LONG, &speed, error);
    if (!status) status = lar_simulation_create(organ, NULL, &simulation, error);
    if (status) return status;
    m->elements = info.elements;
    m->step = speed.step;
    m->time_step = speed.time_step;
    m->bytes = (double)lar_simulation_bytes(simulation) / info.elements;
    lar_simulation_destroy(simulation);
    return LAR_OK;
}

lar_status lar_doctor_measure(const lar_doctor_machine *machine, lar_doctor_measured *measured,
                              lar_error *error) {
    static const double LOAD = 0.8;  /* of a core: contact, pictures and devices want some */
    static const double SHARE = 0.5; /* of the free memory: reading and results want the rest */
    const lar_bench_jitter_options ticks = {.seconds = 0.5, .repeat = 1};
    lar_bench_jitter_result jitter;
    lar_model *organ = NULL;
    *measured = (lar_doctor_measured){0};
    lar_status status = lar_bench_jitter(&ticks, &jitter, error);
    if (!status) status = lar_bench_step_organ(&organ, error);
    if (!status) status = measure_organ(organ, measured, error);
    lar_model_destroy(organ);
    if (status) return status;
    measured->late = jitter.late;
    measured->missed = jitter.missed;
    const double element = measured->step / measured->elements;
    measured->holds = pow(LOAD * measured->time_step * cbrt(measured->elements) / element, 0.75);
    measured->fits = SHARE * machine->free / measured->bytes;
    return LAR_OK;
}
