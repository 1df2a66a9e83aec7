/* A second simulation in the state of the first one, without compiling the model again. */
#include <string.h>

#include "simulation/simulation.h"
#include "step/domain_share.h"

static lar_status check(const lar_simulation *simulation, lar_simulation **clone,
                        lar_error *error) {
    lar_status status = lar_simulation_check_zero(simulation, "lar_simulation_clone", error);
    if (status) return status;
    if (!clone)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_simulation_clone needs a place for the clone");
    /* One processor with one thread has the whole state: its clone does without the division. */
    if (lar_simulation_processors(simulation) == 1 && lar_simulation_threads(simulation) == 1)
        return LAR_OK;
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "a simulation on several processors or threads cannot be cloned; create "
                    "another one and take its state there with lar_simulation_save_to and "
                    "lar_simulation_load_from");
}

/* Everything but the state, which is at the start. */
static lar_status make(lar_simulation *from, lar_simulation *made, lar_error *error) {
    const lar_model *model = from->domain.model;
    int32_t spares = from->list.spares;
    int32_t hands = from->list.count - spares - lar_model_tool_count(model);
    lar_status status = lar_tool_list_create(model, hands, spares, &made->list, error);
    if (!status) status = lar_domain_share(&from->domain, &made->domain, error);
    if (status) return status;
    memcpy(made->list.limits, from->list.limits, sizeof made->list.limits);
    made->domain.surroundings.list = &made->list;
    lar_tools_reset(&made->list, &made->tools);
    return lar_simulation_create_state(made, from->interactions.tool_contact.always, error);
}

lar_status lar_simulation_clone(lar_simulation *simulation, lar_simulation **clone,
                                lar_error *error) {
    lar_saved *saved = NULL;
    lar_simulation *made = NULL;
    lar_status status = check(simulation, clone, error);
    if (!status) status = lar_saved_create(simulation, &saved, error);
    if (!status) status = lar_simulation_save_to(simulation, saved, error);
    if (!status && !(made = lar_calloc(1, sizeof *made)))
        status = lar_fail_memory(error, sizeof *made, "a clone");
    if (!status) status = make(simulation, made, error);
    if (!status) status = lar_simulation_load_from(made, saved, error);
    lar_saved_destroy(saved);
    if (status)
        lar_simulation_destroy(made);
    else
        *clone = made;
    return status;
}
