#include "mechanics/hex8_block.h"

#include <string.h>

/* Vectors that every processor has: this is done for every lean block in every step. */
typedef int32_t four_nodes __attribute__((vector_size(16)));
typedef double two_values __attribute__((vector_size(16)));

static void put_nodes(const lar_block_run *run, const lar_lean_block *lean, lar_block_head *head) {
    static const four_nodes ALONG = {0, 1, 2, 3};
    if (run->rows == LAR_ROWS_NONE) {
        memcpy(head->node, ((const lar_loose_block *)(const void *)lean)->node, sizeof head->node);
        return;
    }
    for (int a = 0; a < 8; a++)
        for (int half = 0; half < 2; half++)
            *(four_nodes *)&head->node[a][4 * half] = lar_lean_node(lean, a, 4 * half) + ALONG;
}

void lar_lean_head(const lar_block_run *run, const lar_lean_block *lean, lar_block_head *head) {
    const double *parameter[LAR_BLOCK];
    memcpy(head->stiffness, lean->stiffness, sizeof head->stiffness);
    put_nodes(run, lean, head);
    for (int lane = 0; lane < LAR_BLOCK; lane++)
        parameter[lane] = run->parameters[lean->material[lane]].of;
    for (int k = 0; k < LAR_BLOCK_PARAMETERS; k++) {
        const bool scales = lar_law_scales(run->law, k);
        for (int lane = 0; lane < LAR_BLOCK; lane += 2) {
            two_values value = {parameter[lane][k], parameter[lane + 1][k]};
            if (scales) value *= *(const two_values *)&lean->volume[lane];
            *(two_values *)&head->modulus[k][lane] = value;
        }
    }
}
