/* Blocks of eight hex8 elements, one per lane, and the kernels that recover them.
 *
 * A block holds everything a step reads of eight elements, number by number and lane by lane, so
 * that one aligned load brings the same number of all eight (328 bytes per element). Narrower
 * instruction sets take a block in halves or quarters; the layout does not depend on them. All
 * elements of one call follow the same law. A lane without an element has zeros throughout and
 * points to a spare node: it produces exactly no force.
 *
 * Forces are 64-bit integers in units of 2^-scale newton (DESIGN 5). The modal forces are rounded,
 * once each, and the transform back to the nodes is integer arithmetic: the forces of an element
 * add up to exactly zero, whatever the rounding.
 *
 * lar_hex8_kernel() is the same source, hex8_kernel.c, compiled once per instruction set.
 */
#ifndef LAR_MECHANICS_HEX8_BLOCK_H
#define LAR_MECHANICS_HEX8_BLOCK_H

#include "mechanics/hex8.h"

enum { LAR_BLOCK = 8 };

typedef struct lar_hex8_block {
    double gradient[LAR_HEX8_GRADIENTS][3][LAR_BLOCK];
    double shape[LAR_HEX8_HOURGLASS][3][LAR_BLOCK];
    double stiffness[LAR_HEX8_HOURGLASS][LAR_BLOCK]; /* times the force scale */
    double modulus[LAR_LAW_PARAMETERS][LAR_BLOCK];   /* law parameters times volume and scale */
    int32_t node[8][LAR_BLOCK];                      /* offset of local node a: 4 times its index */
} __attribute__((aligned(64))) lar_hex8_block;

/* What an element may do before a run is stopped. */
typedef struct lar_hex8_limits {
    double least_volume;  /* det F must stay above this */
    double stress_square; /* the stress sum of law.h, scaled as `modulus`, must stay below this */
    double hourglass_square; /* the same for sum |c q|^2, looked at by a watching call only */
} lar_hex8_limits;

/* Recovers blocks[0..count): adds the internal forces for the displacements `u` [nodes][4] to
 * `force` [nodes][4]. Returns the first element (block * 8 + lane) beyond the limits, or -1; all
 * forces are added in any case. */
typedef int64_t (*lar_hex8_recover)(const lar_hex8_block *blocks, int32_t count, const double *u,
                                    int64_t *force, const lar_hex8_limits *limits);

/* How nodes move in one leapfrog step of length dt with mass-proportional damping. */
typedef struct lar_motion {
    double keep;     /* (1 - c dt/2) / (1 + c dt/2) */
    double dt;       /* [s] */
    double speed;    /* no node may be this fast along an axis [m/s] */
    double drift[4]; /* gravity g dt / (1 + c dt/2) [m/s]; the fourth value is 0 */
} lar_motion;

/* Moves nodes first..end-1 (both even) by one step and clears their forces:
 *     v' = keep v - push f + drift,   u' = u + dt v',   f = 0
 * u, v, f are [nodes][4], aligned to 64 bytes; push [nodes] is dt / (m (1 + c dt/2)) times the
 * force unit. With `mass` (not NULL; [nodes], kg) *damped grows by sum m |v + v'|^2, for the energy
 * that damping takes. Returns false when a node reached `speed`. */
typedef bool (*lar_node_update)(const lar_motion *motion, int32_t first, int32_t end, double *u,
                                double *v, int64_t *force, const double *push, const double *mass,
                                double *damped);

/* The kernels of one instruction set. */
typedef struct lar_kernels {
    lar_isa isa;
    const char *name; /* as in LARIAT_ISA */
    bool (*available)(void);
    lar_hex8_recover recover[LAR_LAW_COUNT];
    lar_hex8_recover watch[LAR_LAW_COUNT]; /* the same, and also looks at the hourglass modes */
    lar_node_update update;
} lar_kernels;

/* The kernels for `isa`; AUTO takes the environment's LARIAT_ISA or the widest there is. An
 * unknown name, or a set that this processor or build lacks, is an error that lists the others. */
lar_status lar_kernels_find(lar_isa isa, const lar_kernels **kernels, lar_error *error);

#endif
