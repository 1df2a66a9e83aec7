/* Going back to the start, saving and loading, as the public header has them. */
#include <string.h>

#include "simulation/checkpoint.h"
#include "simulation/simulation.h"

static lar_status check_whole(const lar_simulation *simulation, lar_error *error) {
    return simulation->computer && simulation->computer->broken ? lar_computer_refuse(error)
                                                                : LAR_OK;
}

lar_status lar_simulation_reset(lar_simulation *simulation, lar_error *error) {
    lar_status status = lar_simulation_check_zero(simulation, "lar_simulation_reset", error);
    if (!status) status = check_whole(simulation, error);
    if (status) return status;
    lar_simulation_set_start(simulation);
    return lar_simulation_take_up(simulation, error);
}

/* Only what carries the state from one step to the next. A run that breaks off may do so between
 * the parts of a step; copies are made between steps. */
static void copy_state(const lar_state *from, lar_state *to) {
    to->step = from->step;
    to->part = 0;
    to->parts = 1;
    to->listed = false;
    to->damped = from->damped;
    to->external = from->external;
    to->contact = from->contact;
#define LAR_STATE_COPY(type, name, values, kept)                                                   \
    if (kept) memcpy(to->name, from->name, (size_t)from->node_count *(values) * sizeof(type));
    LAR_STATE_ARRAYS(LAR_STATE_COPY)
#undef LAR_STATE_COPY
}

lar_status lar_simulation_copy(lar_simulation *simulation, lar_state *state, lar_tools *tools,
                               lar_error *error) {
    if (simulation->fault.kind)
        return lar_fail(error, LAR_ERROR_UNSTABLE,
                        "the state at step %llu is not kept: the run has broken off, and would "
                        "again from here; load an earlier checkpoint or go back to the start",
                        (unsigned long long)lar_simulation_steps(simulation));
    lar_status status = lar_simulation_gather(simulation, error);
    if (status) return status;
    copy_state(&simulation->state, state);
    *tools = simulation->tools;
    return LAR_OK;
}

lar_status lar_simulation_go_back(lar_simulation *simulation, const lar_state *state,
                                  const lar_tools *tools, lar_error *error) {
    lar_status status = check_whole(simulation, error);
    if (status) return status;
    copy_state(state, &simulation->state);
    memset(simulation->state.force, 0,
           4 * (size_t)simulation->state.node_count * sizeof *simulation->state.force);
    simulation->tools = *tools;
    lar_interactions_forget(&simulation->interactions);
    return lar_simulation_take_up(simulation, error);
}

static lar_status check_path(const char *path, const char *call, lar_error *error) {
    if (path && *path) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%s needs the path of a checkpoint", call);
}

lar_status lar_simulation_pack(const lar_simulation *simulation, const char *path, lar_bytes *bytes,
                               lar_error *error) {
    if (simulation->fault.kind)
        return lar_fail(error, LAR_ERROR_UNSTABLE,
                        "%s: is not written: the run has broken off, and would again from here; "
                        "load an earlier checkpoint or go back to the start",
                        path);
    lar_status status = lar_simulation_gather(simulation, error);
    if (status) return status;
    return lar_checkpoint_pack(path, &simulation->domain, &simulation->state, &simulation->tools,
                               bytes, error);
}

lar_status lar_simulation_unpack(lar_simulation *simulation, const char *path,
                                 const lar_bytes *bytes, lar_error *error) {
    lar_checkpoint checkpoint;
    lar_status status = check_whole(simulation, error);
    if (!status)
        status = lar_checkpoint_parse(path, bytes, &simulation->domain, &checkpoint, error);
    if (status) return status;
    lar_checkpoint_take(&checkpoint, &simulation->domain, &simulation->state, &simulation->tools);
    lar_interactions_forget(&simulation->interactions);
    return lar_simulation_take_up(simulation, error);
}

lar_status lar_simulation_save(const lar_simulation *simulation, const char *path,
                               lar_error *error) {
    lar_bytes bytes = {0};
    lar_status status = lar_simulation_check_zero(simulation, "lar_simulation_save", error);
    if (!status) status = check_path(path, "lar_simulation_save", error);
    if (!status) status = lar_simulation_pack(simulation, path, &bytes, error);
    if (!status) status = lar_checkpoint_store(path, &bytes, error);
    lar_bytes_free(&bytes);
    return status;
}

lar_status lar_simulation_load(lar_simulation *simulation, const char *path, lar_error *error) {
    lar_bytes bytes = {0};
    lar_status status = lar_simulation_check_zero(simulation, "lar_simulation_load", error);
    if (!status) status = check_path(path, "lar_simulation_load", error);
    if (!status) status = lar_checkpoint_read(path, &bytes, error);
    if (!status) status = lar_simulation_unpack(simulation, path, &bytes, error);
    lar_bytes_free(&bytes);
    return status;
}
