#include "step/mass/strained.h"

#include <stdlib.h>

lar_status lar_strained_create(const lar_domain *domain, lar_strained *strained, lar_error *error) {
    size_t lanes = LAR_BLOCK * (size_t)domain->layout.block_count;
    size_t runs = (size_t)domain->run_count;
    *strained = (lar_strained){.lane = lar_calloc(lanes, sizeof *strained->lane),
                               .count = lar_calloc(runs, sizeof *strained->count),
                               .listed_count = lar_calloc(runs, sizeof *strained->count),
                               .strain = lar_calloc(lanes, sizeof *strained->strain),
                               .near = lar_calloc(lanes, sizeof *strained->near),
                               .stiffness = lar_calloc(lanes, sizeof *strained->stiffness),
                               .sound = lar_calloc(lanes, sizeof *strained->sound),
                               .steady = lar_calloc(lanes, sizeof *strained->steady),
                               .damped = lar_calloc(lanes, sizeof *strained->damped),
                               .damped_count = lar_calloc(runs, sizeof *strained->damped_count),
                               .lacked = lar_calloc(lanes, sizeof *strained->lacked),
                               .lacked_count = lar_calloc(runs, sizeof *strained->lacked_count)};
    strained->follows = domain->layout.thread_count == 1;
    bool active = lar_model_active(domain->model) != NULL;
    size_t elements = (size_t)domain->model->mesh.element_count;
    strained->pressed = lar_calloc(elements, sizeof *strained->pressed);
    strained->beyond = lar_calloc(lanes / LAR_BLOCK, sizeof *strained->beyond);
    if (active) {
        strained->activation = lar_calloc_aligned(lanes, sizeof *strained->activation);
        strained->active_energy = lar_calloc_aligned(lanes, sizeof *strained->active_energy);
    }
    if (strained->lane && strained->count && strained->listed_count && strained->strain &&
        strained->near && strained->stiffness && strained->sound && strained->steady &&
        strained->damped && strained->damped_count && strained->lacked && strained->lacked_count &&
        strained->pressed && strained->beyond &&
        (!active || (strained->activation && strained->active_energy)))
        return LAR_OK;
    lar_strained_destroy(strained);
    size_t each = 3 * sizeof *strained->lane + sizeof *strained->strain +
                  2 * sizeof *strained->sound + sizeof *strained->steady + sizeof *strained->damped;
    return lar_fail_memory(error, lanes * each, "the strained elements");
}

void lar_strained_destroy(lar_strained *strained) {
    free(strained->lane);
    free(strained->count);
    free(strained->listed_count);
    free(strained->strain);
    free(strained->near);
    free(strained->stiffness);
    free(strained->sound);
    free(strained->steady);
    free(strained->damped);
    free(strained->damped_count);
    free(strained->lacked);
    free(strained->lacked_count);
    free(strained->activation);
    free(strained->active_energy);
    free(strained->pressed);
    free(strained->beyond);
    *strained = (lar_strained){0};
}

void lar_strained_corners(const lar_domain *domain, const lar_state *state, lar_gid e,
                          double rest[8][3], double now[8][3], double v[8][3]) {
    const lar_mesh *mesh = &domain->model->mesh;
    const double *u = state->u, *speed = state->v;
    size_t stride = state->stride;
    for (int a = 0; a < 8; a++) {
        lar_gid node = mesh->element[e][a];
        size_t at = lar_state_at(state, domain->layout.local[node], 0);
        const double *position = mesh->position[node];
#pragma GCC unroll 3
        for (size_t i = 0; i < 3; i++) {
            rest[a][i] = position[i];
            now[a][i] = u[at + i * stride] + position[i];
        }
#pragma GCC unroll 3
        for (size_t i = 0; i < 3 && v; i++) v[a][i] = speed[at + i * stride];
    }
}

void lar_group_add(const lar_domain *domain, int32_t r, int32_t lane, int32_t entry,
                   lar_strained_group *group) {
    const lar_block_run *run = &domain->run[r];
    int32_t at = group->count++;
    size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
    lar_run_nodes_apart(run, lane / LAR_BLOCK, lane % LAR_BLOCK, LAR_BLOCK,
                        &group->hex8.node[0][at]);
    group->hex8.largest[at] = domain->base[first + (size_t)lane].largest;
    group->lane[at] = lane;
    group->entry[at] = entry;
    group->element[at] = lar_lane_element(domain, r, (uint32_t)lane);
}

unsigned lar_corners_in_mesh(const lar_domain *domain, int32_t r, int32_t lane, unsigned at) {
    uint32_t corner = domain->base[LAR_BLOCK * domain->run_first[r] + lane].corner;
    unsigned in_mesh = 0;
    for (; at; at &= at - 1) in_mesh |= 1u << (corner >> 4 * __builtin_ctz(at) & 7);
    return in_mesh;
}
