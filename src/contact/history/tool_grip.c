#include "contact/history/tool_grip.h"

#include <string.h>

#include "base/vector.h"

int32_t lar_grips_list(const lar_model *model, int32_t *node) {
    int32_t count = 0;
    bool rough = false;
    for (int t = 0; t < model->tool_count; t++) rough = rough || model->tool[t].friction > 0;
    for (int m = 0; rough && m < model->move_count; m++) {
        const lar_move *move = &model->move[m];
        if (!move->tool || !model->tool[move->tool - 1].free) continue;
        if (node) memcpy(&node[count], move->nodes.node, (size_t)move->nodes.count * sizeof *node);
        count += move->nodes.count;
    }
    return count;
}

/* What of `v` is across a unit vector. */
static void across(const double v[3], const double way[3], double out[3]) {
    const double through = lar_dot(v, way);
    for (int i = 0; i < 3; i++) out[i] = v[i] - way[i] * through;
}

void lar_tool_grip_pull(const lar_grip *grip, double lead, double dt,
                        const double had[LAR_STICK_VALUES], double next[LAR_STICK_VALUES],
                        double force[3]) {
    const double stiffness = grip->stiffness, most = lar_length(grip->press);
    double way[3], slip[3] = {0}, moved[3], pull[3];
    for (int i = 0; i < 3; i++) way[i] = grip->press[i] / most;
    across(grip->slide, way, moved);
    if (had[3] == grip->tool + 1) {
        across(had, way, slip);
        for (int i = 0; i < 3; i++) slip[i] += dt * moved[i];
    }
    for (int i = 0; i < 3; i++) pull[i] = stiffness * (slip[i] + lead * moved[i]);
    const double wanted = lar_length(pull), held = stiffness * lar_length(slip);
    for (int i = 0; i < 3; i++) {
        force[i] = -(wanted > most ? most / wanted : 1) * pull[i];
        next[i] = (held > most ? most / held : 1) * slip[i];
    }
    next[3] = grip->tool + 1;
}
