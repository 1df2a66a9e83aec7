/* Blocks of eight hex8 elements, one per lane, and the kernels that recover them.
 *
 * A block holds everything a step reads of eight elements, number by number and lane by lane, so
 * that one aligned load brings the same number of all eight. Narrower instruction sets take a
 * block in halves or quarters; the layout does not depend on them. A lane without an element has
 * zeros throughout and points to a spare node: it produces exactly no force.
 *
 * Two things make elements cheaper, without changing a bit of the result:
 *
 *   rows     +---+---+---+---+   Lane k+1 continues lane k in the xi direction: its left nodes are
 *            | 0 | 1 | 2 | 3 |   lane k's right nodes. Four lines of nine nodes are loaded and
 *            +---+---+---+---+   stored instead of 64 nodes, whole vectors at a time because the
 *                                nodes of a line are consecutive: the right ones are the same load
 *                                one node further. Neighbours' forces are added in registers.
 *   boxes    edges along the axes: of the 18 modal gradients three are not zero, and the hourglass
 *            shapes vanish (112 bytes per element instead of 328).
 *
 * And one makes models that are larger than caches cheaper, again with the same bits:
 *
 *     lean     gradients and shapes follow from where the nodes are at rest, which neighbours
 * share, nodes of a row from its first ones, and moduli from volume and material: 48 bytes per
 * element (80 outside rows) and 24 per node are read instead of 328, and the rest is made anew in
 * every step, a few blocks at a time (docs/performance.md, "Lean blocks").
 *
 * Forces are 64-bit integers, newtons times the model's scale, a power of two (docs/theory.md). The
 * modal forces are rounded, once each, and the transform back to the nodes is integer arithmetic:
 * the forces of an element add up to exactly zero, whatever the rounding.
 *
 * The kernels are the same source, hex8_kernel.c, compiled once per instruction set.
 */
#ifndef LAR_MECHANICS_HEX8_BLOCK_H
#define LAR_MECHANICS_HEX8_BLOCK_H

#include "mechanics/axes.h"
#include "mechanics/hex8.h"

/* Elements; parameters of a law that a block has room for, and those that stand beside the blocks,
 * for laws that have more. */
enum {
    LAR_BLOCK = 8,
    LAR_BLOCK_PARAMETERS = 3,
    LAR_MORE_PARAMETERS = LAR_LAW_PARAMETERS - LAR_BLOCK_PARAMETERS
};

/* How the lanes of a block hang together. */
typedef enum lar_block_rows {
    LAR_ROWS_NONE,  /* not at all */
    LAR_ROWS_FOUR,  /* two rows of four */
    LAR_ROWS_EIGHT, /* one row of eight */
    LAR_ROWS_COUNT
} lar_block_rows;

typedef enum lar_block_shape { LAR_SHAPE_GENERAL, LAR_SHAPE_BOX, LAR_SHAPE_COUNT } lar_block_shape;

/* What every block begins with. */
typedef struct lar_block_head {
    double modulus[LAR_BLOCK_PARAMETERS][LAR_BLOCK]; /* law parameters times volume and scale */
    double stiffness[LAR_HEX8_HOURGLASS][LAR_BLOCK]; /* c_m times scale */
    int32_t node[8][LAR_BLOCK];                      /* local nodes */
} __attribute__((aligned(64))) lar_block_head;

typedef struct lar_hex8_block { /* LAR_SHAPE_GENERAL */
    lar_block_head head;
    double gradient[LAR_HEX8_GRADIENTS][3][LAR_BLOCK];
    double shape[LAR_HEX8_HOURGLASS][3][LAR_BLOCK];
} lar_hex8_block;

/* What is kept of a general block where it is made anew in every step. */
typedef struct lar_lean_block {
    double stiffness[LAR_HEX8_HOURGLASS][LAR_BLOCK]; /* as in a head */
    double volume[LAR_BLOCK];    /* at rest [m^3]; LAR_LEAN_NOTHING in lanes without an element */
    int32_t material[LAR_BLOCK]; /* row of the run's parameters */
    int32_t line[4][2]; /* of rows: first local node of each line, and the one four further */
} __attribute__((aligned(64))) lar_lean_block;
/* The same of lanes that do not lie in rows. */
typedef struct lar_loose_block {
    lar_lean_block lean;
    int32_t node[8][LAR_BLOCK]; /* local nodes */
} lar_loose_block;
/* So large that all gradients are as good as zero. */
#define LAR_LEAN_NOTHING 1e200

typedef struct lar_box_block { /* LAR_SHAPE_BOX */
    lar_block_head head;
    double gradient[3][LAR_BLOCK]; /* B_m along its own axis, m = 0..2 */
} lar_box_block;

/* A box may be turned: its xi, eta, zeta run along the axes turn, turn + 1, turn + 2 (mod 3). */

static inline size_t lar_block_size(lar_block_shape shape) {
    return shape == LAR_SHAPE_BOX ? sizeof(lar_box_block) : sizeof(lar_hex8_block);
}

/* The other parameters of a block's law, likewise. */
typedef struct lar_block_more {
    double modulus[LAR_MORE_PARAMETERS][LAR_BLOCK];
} __attribute__((aligned(64))) lar_block_more;

/* What a block's materials say of their viscosity (law/viscosity.h), beside it as well. */
typedef struct lar_viscous_block {
    double rest[LAR_BLOCK];
    double unit[LAR_BLOCK];    /* volume, scale and factor of stiffness: by which P is more than
                                  what is remembered; 0 without an element */
    double inverse[LAR_BLOCK]; /* of that; 0 without an element */
    struct {
        double share[LAR_BLOCK], rate[LAR_BLOCK]; /* g_i, 1 / t_i [1/s] */
    } term[LAR_VISCOUS_TERMS];
} __attribute__((aligned(64))) lar_viscous_block;

/* Fibres (law/fibre.h), beside the block as well: parameters in pascal and active stresses times
 * volume and scale. All 0 without an element. */
typedef struct lar_fibre_block {
    double direction[3][LAR_BLOCK], parameter[LAR_FIBRE_PARAMETERS][LAR_BLOCK];
    double along[LAR_BLOCK], across[LAR_BLOCK];
    double limit[LAR_BLOCK]; /* of lar_fibre_stiffness, from where on an element is listed:
                                lar_fibre_limit */
} __attribute__((aligned(64))) lar_fibre_block;

/* What keeps flat elements from folding (fold/hex8_fold.h), beside the block as well. All 0 of
 * others and without an element. */
typedef struct lar_fold_block {
    double axis[3][LAR_BLOCK], weight[LAR_HEX8_HOURGLASS][LAR_BLOCK];
    double softness[LAR_HEX8_HOURGLASS][LAR_BLOCK]; /* weight over the stiffness of the head */
    double bulk[LAR_BLOCK], from[LAR_BLOCK];        /* times volume and scale; as it is */
} __attribute__((aligned(64))) lar_fold_block;

/* Where parameter k of a lane stands; `more` is of that block, NULL for laws that fit. */
static inline double *lar_block_parameter(lar_block_head *head, lar_block_more *more, int k,
                                          int lane) {
    return k < LAR_BLOCK_PARAMETERS ? &head->modulus[k][lane]
                                    : &more->modulus[k - LAR_BLOCK_PARAMETERS][lane];
}

static inline bool lar_law_has_more(lar_law law) {
    return lar_law_table[law].count > LAR_BLOCK_PARAMETERS;
}

/* A law's parameters times the scale, before those that stiffness scales are multiplied with a
 * volume; all 0 in the row for lanes without an element, which is the last. */
typedef struct lar_lean_parameters {
    double of[LAR_BLOCK_PARAMETERS];
} lar_lean_parameters;

/* Blocks that caches do not hold are asked for ahead (hex8_lean.h): every so many lines before the
 * force of an earlier block, others before its stress. */
enum { LAR_ASK_NOTHING, LAR_ASK_MANY = 2, LAR_ASK_FEW = 5 };

/* Consecutive blocks of one law, one shape and one kind of rows. */
typedef struct lar_block_run {
    lar_law law;
    lar_block_shape shape;
    lar_block_rows rows;
    int turn; /* of boxes, 0..2; else 0 */
    int asks; /* LAR_ASK_FEW or MANY, of models that caches do not hold; else NOTHING */
    int32_t count;
    size_t axis_stride; /* values from one axis of a node to the next, in all of its arrays */
    const void
        *blocks; /* lar_hex8_block, lar_box_block, lar_lean_block or lar_loose_block [count] */
    const lar_block_more *more; /* [count], NULL when the law has no more parameters */
    const double *rest;         /* [3][axis_stride] at rest [m]: the blocks are lean. Else NULL */
    const lar_lean_parameters *parameters; /* of lean blocks [materials + 1] */
    int viscous; /* lar_viscosity_kind; 0: elastic, and what follows does not count */
    int terms;
    bool isochoric;
    double softer; /* part of the stiffening of shear at which elements are listed, for isochoric
                      terms make shear stiffer beside the bulk modulus */
    const lar_viscous_block *relaxing; /* [count] */
    int fibrous;                       /* lar_fibre_kind; 0: no fibres */
    const lar_fibre_block *fibres;     /* [count] where there are any */
    const lar_fibre_block *second;     /* [count] of the other family where they are pairs */
    const lar_fold_block *folds;       /* [count] where elements might fold; NULL: they do not */
} lar_block_run;

/* A step of the viscous elements of a run. */
typedef struct lar_viscous_step {
    double *history; /* [count] of lar_history_values(terms) values of eight lanes */
    double length;   /* [s] since the forces before; 0: what is strained was so at once */
    bool keep;       /* it counts; false: somebody only looks, and the history stays as it is */
    uint8_t *beyond; /* [count] bits of the lanes beyond the limits, noted where there are some:
                        once the history has gone on nobody can ask again. May be NULL */
} lar_viscous_step;

/* From one block of a run to the next. */
static inline size_t lar_run_stride(const lar_block_run *run) {
    if (!run->rest) return lar_block_size(run->shape);
    return run->rows == LAR_ROWS_NONE ? sizeof(lar_loose_block) : sizeof(lar_lean_block);
}

static inline const void *lar_run_block(const lar_block_run *run, int32_t b) {
    return (const char *)run->blocks + (size_t)b * lar_run_stride(run);
}

/* Corner a of a lane in a row: on the line of the edge along xi that it ends. */
static inline int32_t lar_lean_node(const lar_lean_block *lean, int a, int lane) {
    int right = (a ^ a >> 1) & 1;
    return lean->line[a / 2][lane / 4] + lane % 4 + right;
}

/* What a whole block begins with, of a lean one: once for all instruction sets, which would each be
 * larger by a kilobyte. */
void lar_lean_head(const lar_block_run *run, const lar_lean_block *lean, lar_block_head *head);

/* The local nodes at the corners of a lane of block b, each `step` behind the one before. */
static inline void lar_run_nodes_apart(const lar_block_run *run, int32_t b, int lane, int step,
                                       int32_t *node) {
    const void *block = lar_run_block(run, b);
    if (run->rest && run->rows != LAR_ROWS_NONE) {
        for (int a = 0; a < 8; a++) node[a * step] = lar_lean_node(block, a, lane);
        return;
    }
    const int32_t(*nodes)[LAR_BLOCK] =
        run->rest ? ((const lar_loose_block *)block)->node : ((const lar_block_head *)block)->node;
#pragma GCC unroll 8
    for (int a = 0; a < 8; a++) node[a * step] = nodes[a][lane];
}

static inline void lar_run_nodes(const lar_block_run *run, int32_t b, int lane, int32_t node[8]) {
    lar_run_nodes_apart(run, b, lane, 1, node);
}

/* How much of a run's active stress is there now. */
typedef struct lar_active_step {
    const double *now; /* [8 for each block] from 0 to 1 */
    double *energy;    /* [8 for each block] becomes what all of it would store, times the
                          scale [J]; 0 without an element */
} lar_active_step;

/* What an element may do before a run is stopped. */
typedef struct lar_hex8_limits {
    double min_volume;       /* det F must stay above this */
    double stress_square;    /* what a law's stress returns, scaled as `modulus`, must stay below */
    double hourglass_square; /* sum |c q|^2 must stay below; looked at when watching only */
} lar_hex8_limits;

/* What a monitor says of an element's strain: det F, |F|^2, |cof F|^2 and along fibres |F a|^2, of
 * fibres that spread lar_fibre_mean, of two families the larger: 1, 3, 3 and 1 at rest, the last
 * one 0 where there are none. */
enum {
    LAR_STRAIN_VOLUME,
    LAR_STRAIN_LENGTH,
    LAR_STRAIN_AREA,
    LAR_STRAIN_FIBRE,
    LAR_STRAIN_NUMBERS
};

/* The |cof F|^2 from which on an element is looked at more closely. */
#define LAR_STRAINED_AREA (3 * 1.4)

enum { LAR_LANE_FLAT = 1 << 30 };

/* Elements that are strained so much that they must be looked at more closely (hex8_guard.h):
 * squeezed, or bent by their hourglass modes, by about a fifth. */
typedef struct lar_hex8_monitor {
    const double *limit; /* [8 for each block of the run] of lar_hex8_corner_limit, squared units of
                            force */
    const double *area;  /* [likewise] lar_hex8_area_limit; below 0: minus what |F^-1|^2 must not
                            come to either; NULL: for no element */
    int32_t count;
    int32_t *lane; /* [8 for each block of the run] block * 8 + lane, ascending; with LAR_LANE_FLAT
                      where `area` alone says so */
    float (*strain)[LAR_STRAIN_NUMBERS]; /* [as many] of each */
} lar_hex8_monitor;

/* Recovers a run: adds the internal forces for the displacements `u` to `force`, both
 * [3][axis_stride]. Returns -1, or where the first block with elements beyond the limits is:
 * block << 8 | a bit for each lane; all forces are added in any case. With `monitor` (may be NULL)
 * hourglass forces are compared with their limit, and strained elements are listed. */
typedef int64_t (*lar_hex8_recover)(const lar_block_run *run, const double *u, int64_t *force,
                                    const lar_hex8_limits *limits, lar_hex8_monitor *monitor);

/* The same of a run that has fibres, or folds, or is viscous: else `step` is NULL. `active` NULL:
 * all of the active stress is there. */
typedef int64_t (*lar_hex8_recover_more)(const lar_block_run *run, const lar_viscous_step *step,
                                         const lar_active_step *active, const double *u,
                                         int64_t *force, const lar_hex8_limits *limits,
                                         lar_hex8_monitor *monitor);

/* Makes block `block` of a lean run whole. */
typedef void (*lar_hex8_expand)(const lar_block_run *run, int32_t block, lar_hex8_block *whole);

/* Elements of any blocks side by side. Lanes that are not looked at have nodes all the same. */
typedef struct lar_hex8_group {
    double largest[LAR_BLOCK] __attribute__((aligned(64))); /* no corner's edges span more at rest
                                                               [m^3] */
    int32_t node[8][LAR_BLOCK];                             /* as in lar_block_head */
} lar_hex8_group;

/* Where nodes are: at `rest`, displaced by `u`, and, with `v` (else NULL), moved on with that for
 * ahead[lane] seconds; all [3][stride]. */
typedef struct lar_hex8_places {
    size_t stride;
    const double *rest, *u, *v, *ahead;
} lar_hex8_places;

/* What corners have, their edges span it. */
typedef struct lar_hex8_corner_look {
    double above[LAR_BLOCK] __attribute__((aligned(64))); /* of none less than this more than
                                                             share[1] of that at rest [m^3] */
    double over[LAR_BLOCK];    /* the same of share[0], of lanes with a bit for share[1] */
    double longest[LAR_BLOCK]; /* square of an edge [m^2] */
    uint8_t at[LAR_BLOCK];     /* a bit for each corner that has not more than share[0] */
} lar_hex8_corner_look;

/* Looks at the corners of those of a group that have a bit in `lanes`. Returns a bit for each lane
 * where one has not more than share[0] of its volume at rest; and for share[1], which is more,
 * eight bits further up. */
typedef unsigned (*lar_hex8_corners)(const lar_hex8_group *group, unsigned lanes,
                                     const lar_hex8_places *places, const double share[2],
                                     lar_hex8_corner_look *look);

/* How such elements are and move: lar_hex8_areas [m^4], the square of the longest edge [m^2], and
 * the largest square of a corner's speed beside the first one [m^2/s^2]. */
typedef struct lar_hex8_motion {
    double areas[LAR_BLOCK] __attribute__((aligned(64)));
    double longest[LAR_BLOCK];
    double parting[LAR_BLOCK];
} lar_hex8_motion;

/* Of those lanes that have a bit; nodes move with `v` [3][stride]; NULL: the areas alone. */
typedef void (*lar_hex8_motion_of)(const lar_hex8_group *group, unsigned lanes,
                                   const lar_hex8_places *places, const double *v,
                                   lar_hex8_motion *motion);

/* How nodes move in one leapfrog step of length dt with mass-proportional damping. */
typedef struct lar_leapfrog {
    double keep;     /* (1 - c dt/2) / (1 + c dt/2) */
    double dt;       /* [s] */
    double speed;    /* no node may be this fast along an axis [m/s] */
    double drift[3]; /* gravity g dt / (1 + c dt/2) [m/s] */
    double push;     /* how many times lar_node_update's `push` counts: 1 but for divided steps */
} lar_leapfrog;

/* Moves nodes first..end-1 (both multiples of LAR_NODES_TOGETHER) by one step and clears their
 * forces: v' = keep v - push f + drift,   u' = u + dt v',   f = 0 u, v, f are [3][stride], aligned
 * to 64 bytes; push [nodes] is dt / (m (1 + c dt/2)) times the force unit, and counts
 * leapfrog->push times. With `mass` (not NULL; [nodes], kg) *damped grows by sum m |v + v'|^2, for
 * the energy that damping takes. *fastest becomes the largest |v'| of an axis where that is more:
 * nothing has moved further than sqrt(3) dt of it, which is what the search for contact builds on.
 * Returns false when a node reached `speed`; *fastest then says nothing. */
typedef bool (*lar_node_update)(const lar_leapfrog *leapfrog, int32_t first, int32_t end,
                                size_t stride, double *u, double *v, int64_t *force,
                                const double *push, const double *mass, double *damped,
                                double *fastest);

/* The kernels of one instruction set. */
typedef struct lar_kernels {
    const char *name; /* as in LARIAT_ISA */
    bool (*available)(void);
    lar_hex8_recover recover;
    lar_hex8_recover_more recover_more;
    lar_hex8_expand expand;
    lar_hex8_corners corners;
    lar_hex8_motion_of motion;
    lar_node_update update;
} lar_kernels;

/* The kernels for `isa`; AUTO takes the environment's LARIAT_ISA or the widest there is. An
 * unknown name, or a set that this processor or build lacks, is an error that lists the others. */
lar_status lar_kernels_find(lar_isa isa, const lar_kernels **kernels, lar_error *error);

/* Whether this processor is one that does not wait for large models while LAR_ASK_MANY lines of
 * their blocks are asked for. A matter of time only. */
bool lar_kernels_ask_many(void);

#endif
