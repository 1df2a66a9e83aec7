#include "engine/draft.h"

#include <stdlib.h>
#include <string.h>

int lar_kind_index(lar_kind kind) {
    return (int)kind.law * 4 + (kind.shape == LAR_SHAPE_BOX ? 1 + kind.turn : 0);
}

lar_law lar_draft_law(const lar_draft *draft, lar_gid e) {
    return lar_model_material_of(draft->model, e)->law;
}

/* The turn of a box whose edges follow the axes to the bit, -1 for any other element. */
static int box_turn(const lar_mesh *mesh, const lar_gid corner[8]) {
    for (int turn = 0; turn < 3; turn++) {
        bool box = true;
        for (int a = 0; box && a < 8; a++)
            for (int i = 0; i < 3; i++) {
                int axis = (i + turn) % 3, representative = lar_node_sign[a][i] < 0 ? 0 : 6;
                box = box && mesh->position[corner[a]][axis] ==
                                 mesh->position[corner[representative]][axis];
            }
        for (int i = 0; i < 3; i++)
            box = box && mesh->position[corner[0]][i] < mesh->position[corner[6]][i];
        if (box) return turn;
    }
    return -1;
}

lar_kind lar_draft_kind(const lar_draft *draft, const lar_gid *element, const int32_t (*corner)[8],
                        int count) {
    lar_kind common = {lar_draft_law(draft, element[0]), LAR_SHAPE_BOX, 0};
    for (int k = 0; k < count; k++) {
        int turn = box_turn(&draft->model->mesh, corner[k]);
        if (turn < 0 || (k > 0 && turn != common.turn))
            return (lar_kind){common.law, LAR_SHAPE_GENERAL, 0};
        common.turn = turn;
    }
    return common;
}

bool lar_draft_begin(lar_draft *draft, const lar_model *model, lar_layout *layout) {
    const lar_mesh *mesh = &model->mesh;
    size_t elements = (size_t)mesh->element_count, nodes = (size_t)mesh->node_count;
    *layout = (lar_layout){0};
    *draft = (lar_draft){.model = model, .layout = layout};
    draft->open = lar_calloc(elements, sizeof *draft->open);
    layout->corner = lar_calloc(elements, sizeof *layout->corner);
    layout->local = lar_calloc(nodes, sizeof *layout->local);
    if (!draft->open || !layout->corner || !layout->local) return false;
    memcpy(layout->corner, mesh->element, elements * sizeof *mesh->element);
    for (size_t e = 0; e < elements; e++) draft->open[e] = true;
    for (size_t n = 0; n < nodes; n++) layout->local[n] = -1;
    return true;
}

void lar_draft_end(lar_draft *draft) {
    free(draft->open);
    *draft = (lar_draft){0};
}

lar_lanes *lar_draft_block(lar_draft *draft, lar_kind kind, lar_block_rows rows) {
    lar_layout *layout = draft->layout;
    if (!LAR_GROW(layout->block, draft->block_room, layout->block_count)) return NULL;
    lar_lanes *block = &layout->block[layout->block_count++];
    *block = (lar_lanes){.law = kind.law, .shape = kind.shape, .turn = kind.turn, .rows = rows};
    for (int i = 0; i < LAR_BLOCK; i++) block->element[i] = -1;
    return block;
}

bool lar_draft_number(lar_draft *draft, lar_gid node) {
    lar_layout *layout = draft->layout;
    if (!LAR_GROW(layout->global, draft->node_room, layout->node_count)) return false;
    if (node >= 0) layout->local[node] = layout->node_count;
    layout->global[layout->node_count++] = node;
    return true;
}
