#ifdef LAR_HAVE_UCX
#include "comm/ucx_calls.h"

#include <dlfcn.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

lar_ucx_calls lar_ucx;
static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER;

static const char *find_all(void) {
    void *library = dlopen("libucp.so.0", RTLD_NOW | RTLD_LOCAL);
    if (!library) return "libucp.so.0";
    const char *lacking = NULL;
#define FIND(call)                                                                                 \
    if (!lacking && !(*(void **)&lar_ucx.call = dlsym(library, #call))) lacking = #call;
    UCX_CALLS(FIND)
    if (lacking)
        dlclose(library);
    else
        lar_ucx.loaded = library;
    return lacking;
}

/* The same, with every signal caught by whom it was before. */
static const char *find_and_leave_signals(void) {
    struct sigaction before[NSIG];
    bool known[NSIG] = {false};
    for (int i = 1; i < NSIG; i++) known[i] = sigaction(i, NULL, &before[i]) == 0;
    const char *lacking = find_all();
    for (int i = 1; i < NSIG; i++)
        if (known[i]) sigaction(i, &before[i], NULL);
    return lacking;
}

lar_status lar_ucx_load(lar_error *error) {
    const bool crashes = getenv("UCX_ERROR_SIGNALS") || getenv("UCX_HANDLE_ERRORS");
    pthread_mutex_lock(&loading);
    const char *lacking = lar_ucx.loaded ? NULL : crashes ? find_all() : find_and_leave_signals();
    if (!lacking && !getenv("UCX_LOG_LEVEL"))
        lar_ucx.ucs_global_opts_set_value("LOG_LEVEL", "fatal");
    if (!lacking && !getenv("UCX_HANDLE_ERRORS"))
        lar_ucx.ucs_global_opts_set_value("HANDLE_ERRORS", "none");
    pthread_mutex_unlock(&loading);
    if (!lacking) return LAR_OK;
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "backend ucx: %s cannot be loaded; install libucx0, or use the backend tcp",
                    lacking);
}
#endif
