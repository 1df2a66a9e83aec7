#include "layout/draft.h"

#include <stdlib.h>
#include <string.h>

int lar_kind_index(lar_kind kind) {
    int more = kind.viscous * LAR_FIBRE_KINDS + kind.fibrous;
    return ((int)kind.law * LAR_VISCOUS_KINDS * LAR_FIBRE_KINDS + more) * 4 +
           (kind.shape == LAR_SHAPE_BOX ? 1 + kind.turn : 0);
}

static lar_kind law_of(const lar_draft *draft, lar_gid e) {
    const lar_material *material = lar_model_material_of(draft->model, e);
    return (lar_kind){.law = material->law,
                      .viscous = lar_viscosity_kind(&material->viscosity),
                      .fibrous = lar_fibre_kind(&material->fibre)};
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
    const lar_kind general = law_of(draft, element[0]);
    lar_kind common = general;
    common.shape = LAR_SHAPE_BOX;
    for (int k = 0; k < count; k++) {
        int turn = box_turn(&draft->model->mesh, corner[k]);
        if (turn < 0 || (k > 0 && turn != common.turn)) return general;
        common.turn = turn;
    }
    return common;
}

bool lar_draft_joins(const lar_draft *draft, lar_gid e, lar_gid other) {
    const lar_part *part = draft->part;
    if (lar_kind_index(law_of(draft, e)) != lar_kind_index(law_of(draft, other))) return false;
    return !part || part->thread[e] == part->thread[other];
}

bool lar_draft_begin(lar_draft *draft, const lar_model *model, const lar_layout *whole,
                     const lar_part *part, const lar_gid *order, int32_t count,
                     lar_layout *layout) {
    const lar_mesh *mesh = &model->mesh;
    size_t elements = (size_t)mesh->element_count, nodes = (size_t)mesh->node_count;
    *layout = (lar_layout){.corner_lent = part, .corner = part ? whole->corner : NULL};
    *draft = (lar_draft){.model = model,
                         .part = part,
                         .layout = layout,
                         .threads = part ? part->threads : 1,
                         .count = count,
                         .order = order};
    draft->open = lar_calloc(elements, sizeof *draft->open);
    layout->local = lar_calloc(nodes, sizeof *layout->local);
    if (!part) layout->corner = lar_calloc(elements, sizeof *layout->corner);
    if (!draft->open || !layout->corner || !layout->local) return false;
    if (!part) memcpy(layout->corner, mesh->element, elements * sizeof *mesh->element);
    for (int32_t i = 0; i < count; i++) draft->open[order[i]] = true;
    for (size_t n = 0; n < nodes; n++) layout->local[n] = -1;
    return true;
}

void lar_draft_end(lar_draft *draft) {
    for (int t = 0; t < LAR_LAYOUT_THREADS; t++) free(draft->range[t].node);
    free(draft->open);
    *draft = (lar_draft){0};
}

lar_lanes *lar_draft_block(lar_draft *draft, lar_kind kind, lar_block_rows rows) {
    lar_layout *layout = draft->layout;
    if (!LAR_GROW(layout->block, draft->block_room, layout->block_count)) return NULL;
    lar_lanes *block = &layout->block[layout->block_count++];
    *block = (lar_lanes){.law = kind.law,
                         .shape = kind.shape,
                         .turn = kind.turn,
                         .rows = rows,
                         .viscous = kind.viscous,
                         .fibrous = kind.fibrous,
                         .batch = INT32_MAX};
    for (int i = 0; i < LAR_BLOCK; i++) block->element[i] = -1;
    return block;
}

void lar_draft_put(lar_draft *draft, lar_lanes *block, int lane, lar_gid e) {
    int32_t batch = lar_draft_batch(draft, e);
    block->element[lane] = e;
    block->thread = lar_draft_thread(draft, e);
    if (batch < block->batch) block->batch = batch;
    draft->open[e] = false;
}

bool lar_draft_number(lar_draft *draft, int32_t owner, lar_gid node) {
    lar_draft_range *range = &draft->range[owner];
    if (!LAR_GROW(range->node, range->room, range->count)) return false;
    if (node >= 0) draft->layout->local[node] = range->count;
    range->node[range->count++] = node;
    return true;
}
