/* Supports that are set and released while a simulation runs, as the public header has them. No
 * work is worked out here: what a node that is stopped has of kinetic energy goes into the support
 * in the step that stops it, as what moved supports do (contact/conditions.h), and a node that is
 * released begins with the velocity that its support gave it. */
#include "simulation/simulation.h"

/* A rigid body goes as a whole: a node that were held, or let go, would be torn out of it. */
static lar_status check_free(const lar_model *model, const lar_support_entry *entry,
                             lar_error *error) {
    const lar_force_nodes nodes = lar_nodes_of(model, &entry->of, entry->on_set);
    for (int m = 0; m < model->move_count; m++) {
        const lar_move *move = &model->move[m];
        const lar_tool *tool = move->tool ? &model->tool[move->tool - 1] : NULL;
        for (int32_t k = 0; tool && tool->free && k < move->nodes.count; k++)
            for (int32_t i = 0; i < nodes.count; i++)
                if (nodes.node[i] == move->nodes.node[k])
                    return lar_fail(
                        error, LAR_ERROR_ARGUMENT,
                        "node %ld belongs to the free body \"%.100s\", which moves as a "
                        "whole; to hold that, lead it to where it is, "
                        "lar_simulation_tool_move to its pose, for as many steps as it "
                        "is to stay",
                        (long)nodes.node[i], tool->name);
    }
    return LAR_OK;
}

static lar_status check(const lar_simulation *simulation, const lar_support_entry *entry,
                        unsigned axes, lar_error *error) {
    const lar_model *model = simulation->domain.model;
    if (axes < 1 || axes > LAR_AXIS_ALL)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there are no axes %u of nodes; give LAR_AXIS_X, _Y and _Z, added up, 1 to "
                        "7",
                        axes);
    if (lar_support_good(entry, model)) return check_free(model, entry, error);
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "there is no node%s %ld to support; the model has %ld nodes, counted from 0",
                    entry->on_set ? " set" : "", (long)entry->of, (long)model->mesh.node_count);
}

lar_status lar_simulation_support_here(lar_simulation *simulation, const lar_supports *supports,
                                       lar_error *error) {
    const lar_condition_context all = lar_domain_context(&simulation->domain);
    lar_interactions *measure = &simulation->scratch->measure.interactions;
    const lar_supports before = measure->notes.set;
    lar_status status = lar_step_support(&all, supports, measure, error);
    if (!status) status = lar_step_support(&all, supports, &simulation->interactions, error);
    if (status) lar_step_support(&all, &before, measure, NULL);
    return status;
}

lar_status lar_simulation_set_support_of(lar_simulation *simulation, int32_t of, bool on_set,
                                         unsigned axes, bool held, lar_error *error) {
    lar_status status =
        lar_simulation_check_change(simulation, "lar_simulation_set_support", error);
    const lar_support_entry entry = {
        .of = of, .on_set = on_set, .axes = (uint8_t)(axes & LAR_AXIS_ALL), .held = held};
    if (!status) status = check(simulation, &entry, axes, error);
    if (status) return status;
    const lar_model *model = simulation->domain.model;
    lar_supports wanted = simulation->tools.supports;
    uint8_t *mark = lar_calloc((size_t)model->mesh.node_count, 1);
    if (!mark) return lar_fail_memory(error, (size_t)model->mesh.node_count, "supports");
    bool fits = lar_supports_put(&wanted, model, &entry, mark);
    free(mark);
    if (!fits)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d supports are set already; release one, or give nodes of one support a "
                        "set",
                        LAR_SUPPORTS_MAX);
    status = lar_simulation_support_here(simulation, &wanted, error);
    if (status) return status;
    simulation->tools.supports = wanted;
    lar_simulation_set(simulation);
    return LAR_OK;
}

lar_status lar_simulation_set_support(lar_simulation *simulation, int32_t node, unsigned axes,
                                      int held, lar_error *error) {
    return lar_simulation_set_support_of(simulation, node, false, axes, held != 0, error);
}

lar_status lar_simulation_set_support_on(lar_simulation *simulation, const char *set, unsigned axes,
                                         int held, lar_error *error) {
    int32_t index;
    lar_status status =
        lar_simulation_check_change(simulation, "lar_simulation_set_support_on", error);
    if (!status) status = lar_simulation_force_set(simulation->domain.model, set, &index, error);
    return status ? status
                  : lar_simulation_set_support_of(simulation, index, true, axes, held != 0, error);
}

unsigned lar_simulation_support(const lar_simulation *simulation, int32_t node) {
    if (!simulation) return 0;
    return lar_supports_at(&simulation->tools.supports, simulation->domain.model, node);
}
