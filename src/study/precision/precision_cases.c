#include "study/precision/precision_cases.h"

#include "base/memory.h"
#include "model/model.h"
#include "study/bench/kernel.h"

const char *const lar_precision_case_names[LAR_CASE_COUNT] = {
    "vibration", "rest", "path", "turn", "creep", "creep 1 m away", "model"};

static const double FAR_AWAY = 1; /* [m] */

double lar_precision_offset(lar_precision_case what) {
    return what == LAR_CASE_FAR ? FAR_AWAY : 0;
}

static bool is_clamped(lar_precision_case what) {
    return what != LAR_CASE_TURN;
}

/* The nodes of the block's first layer along x. */
static lar_status list_clamped(const lar_model *model, const int32_t edge[3], lar_node_list *list,
                               lar_error *error) {
    const int32_t along = edge[0] + 1;
    list->count = model->mesh.node_count / along;
    list->node = lar_calloc((size_t)list->count, sizeof *list->node);
    if (!list->node) return lar_fail_memory(error, (size_t)list->count * 4, "the clamped nodes");
    for (int32_t k = 0; k < list->count; k++) list->node[k] = k * along;
    return LAR_OK;
}

static lar_status clamp(lar_precision_case what, const int32_t edge[3], lar_model *model,
                        lar_error *error) {
    if (what != LAR_CASE_FAR) {
        lar_fix *fix = LAR_MODEL_APPEND(model, fix);
        if (!fix) return lar_fail_memory(error, sizeof *fix, "the clamp");
        fix->axes = LAR_AXIS_ALL;
        return list_clamped(model, edge, &fix->nodes, error);
    }
    lar_curve *curve = LAR_MODEL_APPEND(model, curve);
    lar_move *move = LAR_MODEL_APPEND(model, move);
    if (!curve || !move) return lar_fail_memory(error, sizeof *move, "the clamp");
    *curve = (lar_curve){.kind = LAR_CURVE_RAMP};
    move->axes = LAR_AXIS_ALL;
    move->by = FAR_AWAY;
    move->curve = model->curve_count - 1;
    return list_clamped(model, edge, &move->nodes, error);
}

/* Nothing, all of it, nothing, and time to come to rest. */
static lar_status add_path(double duration, lar_model *model, lar_error *error) {
    lar_curve *curve = LAR_MODEL_APPEND(model, curve);
    if (!curve) return lar_fail_memory(error, sizeof *curve, "the load path");
    *curve = (lar_curve){.kind = LAR_CURVE_TABLE, .shape = LAR_CURVE_SMOOTH, .count = 3};
    curve->point = lar_calloc(3, sizeof *curve->point);
    if (!curve->point) return lar_fail_memory(error, 48, "the load path");
    curve->point[1][0] = 0.25 * duration;
    curve->point[1][1] = 1;
    curve->point[2][0] = 0.5 * duration;
    model->gravity_curve[2] = model->curve_count - 1;
    return LAR_OK;
}

lar_status lar_precision_block(lar_precision_case what, int32_t elements, double duration,
                               lar_model **model, lar_error *error) {
    static const double gravity[LAR_CASE_COUNT] = {
        [LAR_CASE_REST] = -2, [LAR_CASE_PATH] = -2, [LAR_CASE_CREEP] = -2, [LAR_CASE_FAR] = -2};
    static const double damping[LAR_CASE_COUNT] = {
        [LAR_CASE_REST] = 30, [LAR_CASE_PATH] = 30, [LAR_CASE_CREEP] = 1e4, [LAR_CASE_FAR] = 1e4};
    int32_t edge[3];
    lar_model *made = NULL;
    lar_bench_edges(elements, edge);
    lar_status status = lar_bench_block(edge, true, &made, error);
    if (status) return status;
    made->damping = damping[what];
    made->gravity[2] = gravity[what];
    if (is_clamped(what)) status = clamp(what, edge, made, error);
    if (!status && what == LAR_CASE_PATH) status = add_path(duration, made, error);
    if (status)
        lar_model_destroy(made);
    else
        *model = made;
    return status;
}

void lar_precision_start(lar_precision_case what, lar_simulation *simulation) {
    static const double SWING = 0.05, TURN = 2, DRIFT = 0.1; /* [m/s], [1/s], [m/s] */
    const lar_domain *domain = &simulation->domain;
    const lar_mesh *mesh = &domain->model->mesh;
    const double *end = mesh->position[mesh->node_count - 1];
    const double away = lar_precision_offset(what);
    for (lar_gid g = 0; g < mesh->node_count; g++) {
        const double *place = mesh->position[g];
        lar_state *state = &simulation->state;
        double u[3], v[3];
        lar_state_displacement(state, domain->layout.local[g], u);
        lar_state_velocity(state, domain->layout.local[g], v);
        if (away > 0)
            for (int i = 0; i < 3; i++) u[i] = away;
        if (what == LAR_CASE_VIBRATION) {
            double along = place[0] / end[0];
            v[2] = place[0] > 0.01 * end[0] ? SWING * along * along : 0;
        }
        if (what == LAR_CASE_TURN) {
            v[0] = DRIFT - TURN * (place[1] - 0.5 * end[1]);
            v[1] = DRIFT + TURN * (place[0] - 0.5 * end[0]);
            v[2] = DRIFT;
        }
        lar_axes_put(state->u, state->stride, domain->layout.local[g], u);
        lar_axes_put(state->v, state->stride, domain->layout.local[g], v);
    }
}
