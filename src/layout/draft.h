/* A layout in the making: what placing rows (row_plan.h), placing the rest (finish.h) and the
 * layouts of models and parts share.
 *
 * While a draft is being made, layout->local counts from 0 for each owner: whole ranges are put
 * one behind the other in the end, when their lengths are known. */
#ifndef LAR_LAYOUT_DRAFT_H
#define LAR_LAYOUT_DRAFT_H

#include "layout/part_layout.h"

typedef struct lar_draft_range {
    lar_gid *node; /* [count], -1: spare */
    size_t room;
    int32_t count;
} lar_draft_range;

typedef struct lar_draft {
    const lar_model *model;
    const lar_part *part; /* NULL: the whole model by one thread */
    lar_layout *layout;
    int32_t threads;
    int32_t count;        /* elements to be laid out */
    const lar_gid *order; /* [count] in which they are looked at */
    bool *open;           /* [elements] not yet in a block */
    size_t block_room;
    lar_draft_range range[LAR_LAYOUT_THREADS]; /* the nodes of each owner, as numbered */
} lar_draft;

/* What a block is made of: the same for all its elements. */
typedef struct lar_kind {
    lar_law law;
    lar_block_shape shape;
    int turn;
    int viscous; /* lar_viscosity_kind */
    int fibrous; /* lar_fibre_kind */
} lar_kind;

/* General, and boxes in 3 turns. */
enum { LAR_KINDS = LAR_LAW_COUNT * LAR_VISCOUS_KINDS * LAR_FIBRE_KINDS * 4 };

/* A number for a kind, 0..LAR_KINDS-1. */
int lar_kind_index(lar_kind kind);

/* The kind of `count` elements of one law that will share a row; corner[k]: turned nodes. */
lar_kind lar_draft_kind(const lar_draft *draft, const lar_gid *element, const int32_t (*corner)[8],
                        int count);

/* Who recovers an element, and with which batch; who moves a node (-1: not of this part). */
static inline int32_t lar_draft_thread(const lar_draft *draft, lar_gid e) {
    return draft->part ? draft->part->thread[e] : 0;
}
static inline int32_t lar_draft_batch(const lar_draft *draft, lar_gid e) {
    return draft->part ? draft->part->batch[e] : 0;
}
static inline int32_t lar_draft_owner(const lar_draft *draft, lar_gid node) {
    return draft->part ? draft->part->owner[node] : 0;
}

/* Whether two elements may be in one row. */
bool lar_draft_joins(const lar_draft *draft, lar_gid e, lar_gid other);

/* Allocates an empty layout of loose elements order[0..count), all open and unnumbered: of the
 * whole model with part NULL, else of a part that borrows the corners of `whole`. False without
 * memory. */
bool lar_draft_begin(lar_draft *draft, const lar_model *model, const lar_layout *whole,
                     const lar_part *part, const lar_gid *order, int32_t count, lar_layout *layout);
/* Frees what is the draft's own, not the layout. Idempotent. */
void lar_draft_end(lar_draft *draft);

/* A new block without elements, or NULL without memory. Valid until the next one. */
lar_lanes *lar_draft_block(lar_draft *draft, lar_kind kind, lar_block_rows rows);

/* Puts an open element into a lane of a block. */
void lar_draft_put(lar_draft *draft, lar_lanes *block, int lane, lar_gid e);

/* Gives the owner's next number to a node of the model, or to a spare one (-1). */
bool lar_draft_number(lar_draft *draft, int32_t owner, lar_gid node);

#endif
