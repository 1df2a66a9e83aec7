/* A device that is played from a file: the thesis's pre-programmed inputs (T 6.1).
 *
 * Time is simulated time, so a run with a script is the same run every time, at whatever pace, and
 * begins anew with the simulation.
 */
#include <stdlib.h>

#include "base/memory.h"
#include "model/tool_script.h"
#include "session/device/backend.h"

static void script_close(void *state) {
    lar_tool_script_destroy(state);
    free(state);
}

static lar_status script_open(lar_device_spec *spec, void **state, lar_error *error) {
    lar_tool_script *script = lar_calloc(1, sizeof *script);
    if (!script) return lar_fail_memory(error, sizeof *script, "a script");
    *state = script;
    lar_status status = lar_tool_script_read(spec->argument, script, error);
    spec->turns_absolute = script->turns;
    return status;
}

/* The tool is to be there at the end of the tick. */
static bool script_poll(void *state, const lar_device_tick *tick, lar_tool_pose *pose) {
    if (tick->paused) return false;
    lar_tool_script_at(state, tick->time + tick->seconds, pose);
    return true;
}

const lar_device_backend lar_device_script = {.name = "script",
                                              .form = "script:FILE.csv",
                                              .summary = "positions at times, from a file",
                                              .options = " ",
                                              .absolute = true,
                                              .open = script_open,
                                              .close = script_close,
                                              .poll = script_poll};
