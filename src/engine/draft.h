/* A layout in the making: what placing rows (row_plan.h) and placing the rest (layout.c) share. */
#ifndef LAR_ENGINE_DRAFT_H
#define LAR_ENGINE_DRAFT_H

#include "engine/layout.h"

typedef struct lar_draft {
    const lar_model *model;
    lar_layout *layout;
    size_t block_room, node_room;
    bool *open; /* [elements] not yet in a block */
} lar_draft;

/* What a block is made of: the same for all its elements. */
typedef struct lar_kind {
    lar_law law;
    lar_block_shape shape;
    int turn;
} lar_kind;

enum { LAR_KINDS = LAR_LAW_COUNT * 4 }; /* general, boxes in 3 turns */

/* A number for a kind, 0..LAR_KINDS-1. */
int lar_kind_index(lar_kind kind);

/* The law of an element's material. */
lar_law lar_draft_law(const lar_draft *draft, lar_gid e);

/* The kind of `count` elements of one law that will share a row; corner[k]: turned nodes. */
lar_kind lar_draft_kind(const lar_draft *draft, const lar_gid *element, const int32_t (*corner)[8],
                        int count);

/* Allocates an empty layout of loose elements, all open and unnumbered. False without memory. */
bool lar_draft_begin(lar_draft *draft, const lar_model *model, lar_layout *layout);
/* Frees what is the draft's own, not the layout. Idempotent. */
void lar_draft_end(lar_draft *draft);

/* A new block without elements, or NULL without memory. Valid until the next one. */
lar_lanes *lar_draft_block(lar_draft *draft, lar_kind kind, lar_block_rows rows);

/* Gives the next local number to a node of the model, or to a spare one (-1). */
bool lar_draft_number(lar_draft *draft, lar_gid node);

#endif
