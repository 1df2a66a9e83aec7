/* The hex8 kernels of one instruction set: compiled once per LAR_SIMD (src/CMakeLists.txt).
 *
 * The formulas are those of hex8.h, in the same order as hex8.c, a lane per element, in three
 * phases:
 *
 *     strain   gather nodes, transform, deformation gradient, hourglass forces    by shape, rows
 *     stress   the material law                                                   by law
 *   ( fibres   what they add (hex8_fibre.h)                                       by fibre law )
 *   ( relax    what a viscous material remembers (hex8_viscous.h)                 by viscosity )
 *     force    modal forces, rounding, transform back, scatter to nodes           by shape, rows
 *
 * The order of the statements follows the life of the values: 21 modal displacements and 9
 * gradients fill the 32 registers of AVX-512. Compilers keep this order, so mind it.
 */
#include "mechanics/hex8_block.h"

#include "base/simd.h"
#include "law/lanes.h"
#include "mechanics/hex8_gather.h"
#include "mechanics/node_update.h"
#ifndef LAR_KERNEL_ELASTIC
#include "mechanics/hex8_fibre.h"
#include "mechanics/hex8_group.h"
#include "mechanics/hex8_viscous.h"
#endif

/* ---- lean blocks --------------------------------------------------------------------------- */

/* The quotient as division would round it: what is left over, times the reciprocal (Markstein
 * 1990). Divisions take five times as long. It may be wrong once in some 10^15 times, and then
 * lar_domain_create sees it and keeps whole blocks. */
LAR_INLINE lar_lane quotient(lar_lane a, lar_lane b, lar_lane reciprocal) {
    lar_lane q = a * reciprocal;
    return lar_lane_fma(lar_lane_fnma(q, b, a), reciprocal, q);
}

/* Gradients and shapes of some lanes, as hex8.c makes them, operation for operation. */
LAR_INLINE void expand_lanes(const lar_lean_block *lean, int lane, lar_block_rows rows,
                             lane_nodes rest, lar_hex8_block *whole) {
    lar_lane X[7][3];
    gather_modes(&whole->head, lane, rows, false, rest, X);
    lar_lane volume = lar_lane_load(&lean->volume[lane]), reciprocal = lar_lane_set(1) / volume;
    UNROLL6 for (int m = 0; m < LAR_HEX8_GRADIENTS; m++) UNROLL3 for (int i = 0; i < 3; i++) {
        lar_lane term[2];
        for (int t = 0; t < 2; t++)
            term[t] =
                volume_term(LAR_HEX8_VOLUME_TERM[m][t].factor, X[LAR_HEX8_VOLUME_TERM[m][t].left],
                            X[LAR_HEX8_VOLUME_TERM[m][t].right], i);
        lar_lane_store(&whole->gradient[m][i][lane],
                       quotient(term[0] + term[1], volume, reciprocal));
    }
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) UNROLL3 for (int i = 0; i < 3; i++)
        lar_lane_store(&whole->shape[m][i][lane], X[3 + m][i]);
}

static lane_nodes nodes_of(const lar_block_run *run, const double *value) {
    return (lane_nodes){value, run->axis_stride};
}

/* Of some memory every so many lines are asked for, from the first one on.
 *
 * Blocks that come from beyond the second-level cache are asked for while the chunk before them is
 * computed: a few lines of each, evenly. Hardware fetches on from a line that was asked for, some
 * twenty lines, but only while somebody asks, and a core can wait for sixteen lines at once; asked
 * for in one go they keep it from computing (docs/performance.md, "Large models"). */
LAR_INLINE void ask(const char *memory, size_t bytes, size_t first, size_t each) {
    enum { LINE = 64 };
#pragma GCC unroll 1
    for (size_t k = first * LINE; k < bytes; k += each * LINE) __builtin_prefetch(memory + k, 0, 3);
}

/* Of a lean block in a model that caches do not hold nearly all that comes from memory is its
 * nodes. They are numbered as blocks come: what this many nodes further stands is needed soon. */
__attribute__((noinline)) static void ask_for_nodes(const lar_block_run *run,
                                                    const lar_block_head *head, const double *u,
                                                    const int64_t *force) {
    enum { AHEAD = 128 };
    __asm__ volatile(""); /* else calls of a function that changes nothing are left out */
    size_t at = (size_t)head->node[left_node[3]][0] + AHEAD;
    for (int i = 0; i < 3; i++, at += run->axis_stride) {
        __builtin_prefetch(run->rest + at, 0, 3);
        __builtin_prefetch(u + at, 0, 3);
        __builtin_prefetch(force + at, 1, 3);
    }
}

static void expand(const lar_block_run *run, int32_t b, lar_hex8_block *whole) {
    const void *block = lar_run_block(run, b);
    lar_lean_head(run, block, &whole->head);
    for (int lane = 0; lane < LAR_BLOCK; lane += LAR_LANES)
        expand_lanes(block, lane, run->rows, nodes_of(run, run->rest), whole);
}

/* The blocks of a chunk that begins with block b as phases take them. */
static const char *whole_blocks(const lar_block_run *run, int32_t b, size_t count, const double *u,
                                const int64_t *force, lar_hex8_block *made) {
    const char *kept = lar_run_block(run, b);
    if (!run->rest) return kept;
    if (run->streamed) ask(kept + count * lar_run_stride(run), count * lar_run_stride(run), 0, 1);
    for (size_t i = 0; i < count; i++) {
        expand(run, b + (int32_t)i, &made[i]);
        if (run->streamed) ask_for_nodes(run, &made[i].head, u, force);
    }
    return (const char *)made;
}

/* ---- phases -------------------------------------------------------------------------------- */

LAR_INLINE void strain_general(const lar_hex8_block *block, int lane, lar_lane U[7][3],
                               lar_lane H[9]) {
    UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane B = lar_lane_load_once(&block->gradient[0][j][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) H[3 * i + j] = U[0][i] * B;
    }
    UNROLL6 for (int m = 1; m < LAR_HEX8_GRADIENTS; m++) UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane B = lar_lane_load_once(&block->gradient[m][j][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) H[3 * i + j] = lar_lane_fma(U[m][i], B, H[3 * i + j]);
    }
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) /* q_m = U_m - H X_m */
        UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane X = lar_lane_load_once(&block->shape[m][j][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) U[3 + m][i] =
            lar_lane_fnma(H[3 * i + j], X, U[3 + m][i]);
    }
}

/* Straight into the record: column turn + m of F is U_m B_m, plus 1 on the diagonal. */
LAR_INLINE void strain_box(const lar_box_block *block, int lane, int turn, lar_lane U[7][3],
                           lar_lane F[9]) {
    UNROLL3 for (int m = 0; m < 3; m++) {
        int axis = turn + m < 3 ? turn + m : turn + m - 3;
        lar_lane B = lar_lane_load_once(&block->gradient[m][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) F[3 * i + axis] =
            U[m][i] * B + lar_lane_set(i == axis ? 1 : 0);
    }
}

/* Phase 1: displacements to deformation gradient and hourglass forces. */
LAR_INLINE void strain_lanes(const void *block, int lane, lar_block_shape shape,
                             lar_block_rows rows, bool fours, int turn, lane_nodes u,
                             lane_record *record) {
    const lar_block_head *head = block;
    lar_lane U[7][3];
    gather_modes(head, lane, rows, fours, u, U);
    if (shape == LAR_SHAPE_BOX) {
        strain_box(block, lane, turn, U, record->F);
    } else {
        lar_lane H[9];
        strain_general(block, lane, U, H);
        UNROLL9 for (int k = 0; k < 9; k++) record->F[k] =
            k % 4 == 0 ? H[k] + lar_lane_set(1) : H[k];
    }
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        lar_lane c = lar_lane_load_once(&head->stiffness[m][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) record->cq[m][i] = U[3 + m][i] * c;
    }
}

typedef lar_lane (*lane_law)(const lar_lane F[9], lar_lane P[9], lar_lane J, lar_lane I1,
                             const lar_lane *p);
typedef unsigned (*lane_stiffened)(lar_lane J, lar_lane I1, lar_lane area, const lar_lane *p,
                                   lar_lane share);

/* From where on an element is looked at more closely, besides LAR_STRAINED_AREA: its volume; the
 * part of its modulus at rest by which a law stiffens; and how far the gradient in a corner may be
 * from the mean one, squared. */
static const double STRAINED_VOLUME = 0.7, STRAINED_SHEAR = 0.4, STRAINED_CORNER = 0.09;

LAR_INLINE unsigned strained_lanes(const lane_strain *strain) {
    return lar_lane_not_greater(lar_lane_set(LAR_STRAINED_AREA), strain->number[LAR_STRAIN_AREA]) |
           lar_lane_not_greater(strain->number[LAR_STRAIN_VOLUME], lar_lane_set(STRAINED_VOLUME));
}

/* Phase 2: deformation gradient to stress, in place; returns the lanes beyond the limits. With the
 * corners' `limit` (may be NULL) *strained gets those to be looked at more closely. */
LAR_INLINE unsigned stress_lanes(const lar_block_head *head, int lane, lane_record *record,
                                 const lar_block_more *more, const lar_hex8_limits *limits,
                                 lane_law law, lane_stiffened stiffened, double share,
                                 const double *limit, lane_strain *strain, unsigned *strained) {
    lar_lane P[9], p[LAR_LAW_PARAMETERS];
    UNROLL3 for (int k = 0; k < LAR_BLOCK_PARAMETERS; k++) p[k] =
        lar_lane_load(&head->modulus[k][lane]);
    for (int k = 0; k < LAR_MORE_PARAMETERS; k++) /* not there for laws that do not look at them */
        p[LAR_BLOCK_PARAMETERS + k] =
            more ? lar_lane_load(&more->modulus[k][lane]) : lar_lane_set(0);
    lar_lane J = lar_lane_cofactor(record->F, P), I1 = lar_lane_square_sum(record->F);
    if (limit) {
        *strain = (lane_strain){{J, I1, lar_lane_square_sum(P)}};
        *strained = strained_lanes(strain) |
                    stiffened(J, I1, strain->number[LAR_STRAIN_AREA], p, lar_lane_set(share));
    }
    lar_lane stress = law(record->F, P, J, I1, p);
    UNROLL9 for (int k = 0; k < 9; k++) record->F[k] = P[k];
    unsigned beyond = lar_lane_not_greater(J, lar_lane_set(limits->min_volume)) |
                      lar_lane_not_greater(lar_lane_set(limits->stress_square), stress);
    if (limit) {
        lar_lane sum = lar_lane_set(0);
        UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) UNROLL3 for (int i = 0; i < 3; i++)
            sum = lar_lane_fma(record->cq[m][i], record->cq[m][i], sum);
        beyond |= lar_lane_not_greater(lar_lane_set(limits->hourglass_square), sum);
        lar_lane max = lar_lane_set(STRAINED_CORNER) * lar_lane_load(limit);
        *strained |= lar_lane_not_greater(max, sum);
    }
    return beyond;
}

LAR_INLINE void force_general(const lar_hex8_block *block, int lane, const lane_record *record,
                              lar_ilane n[7][3]) {
    lar_lane S[9];
    UNROLL9 for (int k = 0; k < 9; k++) S[k] = record->F[k];
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane X = lar_lane_load_once(&block->shape[m][j][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) S[3 * i + j] =
            lar_lane_fnma(record->cq[m][i], X, S[3 * i + j]);
    }
    UNROLL6 for (int m = 0; m < LAR_HEX8_GRADIENTS; m++) {
        lar_lane B[3];
        UNROLL3 for (int j = 0; j < 3; j++) B[j] = lar_lane_load_once(&block->gradient[m][j][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) {
            lar_lane G =
                m < 3 ? S[3 * i] * B[0] : lar_lane_fma(S[3 * i], B[0], record->cq[m - 3][i]);
            G = lar_lane_fma(S[3 * i + 1], B[1], G);
            n[m][i] = lar_lane_round(lar_lane_fma(S[3 * i + 2], B[2], G));
        }
    }
}

LAR_INLINE void force_box(const lar_box_block *block, int lane, int turn, const lane_record *record,
                          lar_ilane n[7][3]) {
    UNROLL3 for (int m = 0; m < 3; m++) {
        int axis = turn + m < 3 ? turn + m : turn + m - 3;
        lar_lane B = lar_lane_load_once(&block->gradient[m][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) {
            n[m][i] = lar_lane_round(record->F[3 * i + axis] * B);
            n[3 + m][i] = lar_lane_round(record->cq[m][i]);
        }
    }
}

LAR_INLINE void scatter_edge(const lar_block_head *head, int lane, lar_block_rows rows, bool fours,
                             int edge, const lar_ilane sum[3], const lar_ilane difference[3],
                             lane_sums force, lar_ilane corner[8][3]) {
    lar_ilane left[3], right[3];
    UNROLL3 for (int i = 0; i < 3; i++) {
        left[i] = sum[i] - difference[i];
        right[i] = sum[i] + difference[i];
    }
    if (fours || LANES_LIE_IN_ROWS(rows)) {
        lar_ilane_scatter_row(force.value, force.stride, head->node[left_node[edge]] + lane,
                              head->node[right_node[edge]] + lane, fours, left, right);
        return;
    }
    UNROLL3 for (int i = 0; i < 3; i++) {
        corner[left_node[edge]][i] = left[i];
        corner[right_node[edge]][i] = right[i];
    }
}

/* The transform back, from the modes n: along zeta, eta, xi. */
LAR_INLINE void scatter_modes(const lar_block_head *head, int lane, lar_block_rows rows, bool fours,
                              lar_ilane n[7][3], lane_sums force) {
    lar_ilane corner[8][3];
    UNROLL3 for (int top = 0; top < 2; top++) {
        lar_ilane s0[3], s1[3], d0[3], d1[3];
        UNROLL3 for (int i = 0; i < 3; i++) {
            lar_ilane zeta = top ? n[2][i] : -n[2][i];
            lar_ilane eta = top ? n[1][i] + n[3][i] : n[1][i] - n[3][i];
            lar_ilane xi = top ? n[0][i] + n[4][i] : n[0][i] - n[4][i];
            lar_ilane xieta = top ? n[5][i] + n[6][i] : n[5][i] - n[6][i];
            s0[i] = zeta - eta;
            s1[i] = zeta + eta;
            d0[i] = xi - xieta;
            d1[i] = xi + xieta;
        }
        scatter_edge(head, lane, rows, fours, 2 * top, s0, d0, force, corner);
        scatter_edge(head, lane, rows, fours, 2 * top + 1, s1, d1, force, corner);
    }
    if (!fours && !LANES_LIE_IN_ROWS(rows))
        hand_out(head, lane, rows, (const lar_ilane(*)[3])corner, force);
}

/* Phase 3: stress and hourglass forces to the nodes. */
LAR_INLINE void force_lanes(const void *block, int lane, lar_block_shape shape, lar_block_rows rows,
                            bool fours, int turn, const lane_record *record, lane_sums force) {
    lar_ilane n[7][3];
    if (shape == LAR_SHAPE_BOX)
        force_box(block, lane, turn, record, n);
    else
        force_general(block, lane, record, n);
    UNROLL3 for (int i = 0; i < 3; i++) n[6][i] = lar_lane_round(record->cq[3][i]);
    scatter_modes(block, lane, rows, fours, n, force);
}

#define FOR_PARTS(blocks, count, size)                                                             \
    for (const char *block = (blocks), *end = block + (count) * (size); block < end;               \
         block += (size))                                                                          \
        for (int lane = 0; lane < LAR_BLOCK; lane += LAR_LANES, record++)

typedef void (*strain_phase)(const char *blocks, size_t count, lar_block_rows rows, int turn,
                             lane_nodes u, lane_record *record);
typedef unsigned (*stress_phase)(const char *blocks, const lar_block_more *more, size_t count,
                                 size_t size, lane_record *record, const lar_hex8_limits *limits,
                                 double share, const double *limit, lane_strain *strain,
                                 unsigned *strained);
typedef void (*force_phase)(const char *blocks, size_t count, lar_block_rows rows, int turn,
                            size_t ahead, const lane_record *record, lane_sums force);

#define DEFINE_PHASES(name, shape, fours)                                                          \
    static void strain_##name(const char *blocks, size_t count, lar_block_rows rows, int turn,     \
                              lane_nodes u, lane_record *record) {                                 \
        FOR_PARTS(blocks, count, lar_block_size(shape))                                            \
        strain_lanes(block, lane, shape, rows, fours, turn, u, record);                            \
    }                                                                                              \
    static void force_##name(const char *blocks, size_t count, lar_block_rows rows, int turn,      \
                             size_t ahead, const lane_record *record, lane_sums force) {           \
        FOR_PARTS(blocks, count, lar_block_size(shape)) {                                          \
            if (ahead && lane == 0) ask(block + ahead, lar_block_size(shape), 2, 5);               \
            force_lanes(block, lane, shape, rows, fours, turn, record, force);                     \
        }                                                                                          \
    }
DEFINE_PHASES(generals, LAR_SHAPE_GENERAL, false)
DEFINE_PHASES(boxes, LAR_SHAPE_BOX, false)
#if LANES_KNOW_FOURS
DEFINE_PHASES(general_fours, LAR_SHAPE_GENERAL, true)
DEFINE_PHASES(box_fours, LAR_SHAPE_BOX, true)
#define BY_ROWS(name, fours)                                                                       \
    { name, fours, name }
#else
#define BY_ROWS(name, fours)                                                                       \
    { name, name, name }
#endif

static const strain_phase strain_table[LAR_SHAPE_COUNT][LAR_ROWS_COUNT] = {
    BY_ROWS(strain_generals, strain_general_fours), BY_ROWS(strain_boxes, strain_box_fours)};
static const force_phase force_table[LAR_SHAPE_COUNT][LAR_ROWS_COUNT] = {
    BY_ROWS(force_generals, force_general_fours), BY_ROWS(force_boxes, force_box_fours)};

/* Returns a bit per element of the chunk that is beyond the limits. */
#define DEFINE_LAW(identifier)                                                                     \
    static unsigned stress_##identifier(                                                           \
        const char *blocks, const lar_block_more *more, size_t count, size_t size,                 \
        lane_record *record, const lar_hex8_limits *limits, double share, const double *limit,     \
        lane_strain *strain, unsigned *strained) {                                                 \
        unsigned beyond = 0, part = 0;                                                             \
        int shift = 0;                                                                             \
        FOR_PARTS(blocks, count, size) {                                                           \
            beyond |= stress_lanes((const lar_block_head *)(const void *)block, lane, record,      \
                                   more ? more + shift / LAR_BLOCK : NULL, limits,                 \
                                   lar_##identifier##_stress, lar_##identifier##_stiffened, share, \
                                   limit ? limit + shift : NULL, strain, &part)                    \
                      << shift;                                                                    \
            if (limit) *strained |= part << shift;                                                 \
            strain++;                                                                              \
            shift += LAR_LANES;                                                                    \
        }                                                                                          \
        return beyond;                                                                             \
    }
LAR_LAWS(DEFINE_LAW)
#define LAW_ROW(identifier) [LAR_LAW_##identifier] = stress_##identifier,
static const stress_phase stress_table[LAR_LAW_COUNT] = {LAR_LAWS(LAW_ROW)};

_Static_assert(CHUNK *LAR_BLOCK <= 32, "one bit per element of a chunk");

/* Flat elements of a chunk that are strained too much for their shape. */
LAR_INLINE unsigned flat_lanes(const double *area, size_t parts, const lane_strain *strain) {
    unsigned found = 0;
    for (size_t i = 0; i < parts; i++)
        found |= lar_lane_not_greater(lar_lane_load(area + i * LAR_LANES),
                                      strain[i].number[LAR_STRAIN_AREA])
                 << i * LAR_LANES;
    return found;
}

/* Lists the strained elements of a chunk that begins with block b, and those that only are too
 * `flat` for their strain. */
static void list_strained(lar_hex8_monitor *monitor, int32_t b, unsigned strained, unsigned flat,
                          const lane_strain *strain) {
    for (unsigned all = strained | flat; all; all &= all - 1, monitor->count++) {
        int lane = __builtin_ctz(all);
        double values[LAR_LANES] __attribute__((aligned(64)));
        for (int k = 0; k < LAR_STRAIN_NUMBERS; k++) {
            lar_lane_store(values, strain[lane / LAR_LANES].number[k]);
            monitor->strain[monitor->count][k] = (float)values[lane % LAR_LANES];
        }
        int32_t mark = strained >> lane & 1 ? 0 : LAR_LANE_FLAT;
        monitor->lane[monitor->count] = (b * LAR_BLOCK + lane) | mark;
    }
}

#ifdef LAR_KERNEL_ELASTIC
typedef struct lar_viscous_step lar_viscous_step;
typedef struct lar_active_step lar_active_step;
typedef struct viscous_lane {
    int nothing;
} viscous_lane;
enum { SOFTER = 1 };
#define viscous_begin(of)                                                   ((void)(of))
#define softer_of(run)                                                      ((void)(run), SOFTER)
#define relax(run, step, b, count, limits, gradient, of, record)            0U
#define stretch(run, b, count, limits, limit, gradient, record, strain, of) 0U
#define contract(run, active, b, count, limits, gradient, record)           ((void)(active), 0U)
#else
#define softer_of(run) (run)->softer

/* A function of its own, so that straight fibres do not pay for it. */
__attribute__((noinline)) static unsigned stretch_spread(const lar_block_run *run, int32_t b,
                                                         size_t count, double max, bool watches,
                                                         lar_lane gradient[][9],
                                                         lane_record *record, lane_strain *strain,
                                                         unsigned *strained) {
    unsigned beyond = 0;
    for (const lar_fibre_block *of = run->fibres; of; of = of == run->second ? NULL : run->second)
        beyond |= stretch_family(LAR_FIBRE_KIND_SPREAD, of, b, count, max, watches, gradient,
                                 record, strain, strained);
    return beyond;
}

static unsigned stretch(const lar_block_run *run, int32_t b, size_t count, double max, bool watches,
                        lar_lane gradient[][9], lane_record *record, lane_strain *strain,
                        unsigned *strained) {
    if (lar_fibre_kind_law(run->fibrous) == LAR_FIBRE_NONE) return 0;
    if (run->fibrous >= LAR_FIBRE_SPREAD)
        return stretch_spread(run, b, count, max, watches, gradient, record, strain, strained);
    return stretch_family(run->fibrous, run->fibres, b, count, max, watches, gradient, record,
                          strain, strained);
}

/* What is active, behind all that relaxes. */
static unsigned contract(const lar_block_run *run, const lar_active_step *active, int32_t b,
                         size_t count, const lar_hex8_limits *limits, lar_lane gradient[][9],
                         lane_record *record) {
    unsigned beyond = 0;
    size_t part = 0;
    for (size_t i = (size_t)b; i < (size_t)b + count; i++)
        for (int lane = 0; lane < LAR_BLOCK; lane += LAR_LANES, part++) {
            size_t at = LAR_BLOCK * i + (size_t)lane;
            beyond |=
                active_lanes(&run->fibres[i], lane, gradient[part],
                             active ? active->now + at : NULL, active ? active->energy + at : NULL,
                             limits->stress_square, record[part].F)
                << part * LAR_LANES;
        }
    return beyond;
}
#endif

/* `fibrous` is a constant 0 and `step` NULL for what is elastic alone, and then none of this is
 * there. */
LAR_INLINE int64_t recover_form(const lar_block_run *run, int fibrous, const lar_viscous_step *step,
                                const lar_active_step *active, const double *u, int64_t *force,
                                const lar_hex8_limits *limits, lar_hex8_monitor *monitor) {
    lar_lane gradient[CHUNK * PARTS][9];
    double share = step ? STRAINED_SHEAR * softer_of(run) : STRAINED_SHEAR;
    lane_record record[CHUNK * PARTS];
    lane_strain strains[CHUNK * PARTS];
    strain_phase strain = strain_table[run->shape][run->rows];
    stress_phase stress = stress_table[run->law];
    force_phase forces = force_table[run->shape][run->rows];
    size_t size = lar_block_size(run->shape);
    /* Where blocks are asked for, a little before the stress of each and before its force. */
    size_t ahead = run->streamed && !run->rest ? CHUNK * size : 0, together = ahead ? 1 : CHUNK;
    int64_t first = -1;
    lar_hex8_block made[CHUNK];
    viscous_lane fade;
    if (step) viscous_begin(&fade);
    for (int32_t b = 0; b < run->count; b += CHUNK) {
        size_t count = (size_t)(run->count - b < CHUNK ? run->count - b : CHUNK);
        const char *blocks = whole_blocks(run, b, count, u, force, made);
        strain(blocks, count, run->rows, run->turn, nodes_of(run, u), record);
        unsigned strained = 0;
        const double *limit = monitor ? monitor->limit + b * LAR_BLOCK : NULL;
        const lar_block_more *more = run->more ? run->more + b : NULL;
        for (size_t i = 0; (step || fibrous) && i < count * PARTS; i++)
            memcpy(gradient[i], record[i].F, sizeof gradient[i]);
        unsigned beyond = 0;
        for (size_t i = 0; i < count; i += together) {
            unsigned some = 0;
            if (ahead) ask(blocks + i * size + ahead, size, 0, 10);
            beyond |=
                stress(blocks + i * size, more ? more + i : NULL,
                       count < together ? count : together, size, record + i * PARTS, limits, share,
                       limit ? limit + i * LAR_BLOCK : NULL, strains + i * PARTS, &some)
                << i * LAR_BLOCK;
            strained |= some << i * LAR_BLOCK;
        }
        if (fibrous)
            beyond |= stretch(run, b, count, limits->stress_square, limit, gradient, record,
                              strains, &strained);
        if (step) beyond |= relax(run, step, b, count, limits, gradient, &fade, record);
        if (fibrous) beyond |= contract(run, active, b, count, limits, gradient, record);
        forces(blocks, count, run->rows, run->turn, ahead, record,
               (lane_sums){force, run->axis_stride});
        unsigned flat = 0;
        if (monitor && monitor->area)
            flat = flat_lanes(monitor->area + b * LAR_BLOCK, count * PARTS, strains);
        if (__builtin_expect((strained | flat) != 0, 0))
            list_strained(monitor, b, strained, flat, strains);
        if (__builtin_expect(beyond != 0 && first < 0, 0)) {
            int block = __builtin_ctz(beyond) / LAR_BLOCK;
            first = (int64_t)(b + block) << 8 | (beyond >> (block * LAR_BLOCK) & 0xff);
        }
    }
    return first;
}

static int64_t recover(const lar_block_run *run, const double *u, int64_t *force,
                       const lar_hex8_limits *limits, lar_hex8_monitor *monitor) {
    return recover_form(run, 0, NULL, NULL, u, force, limits, monitor);
}

#ifndef LAR_KERNEL_ELASTIC
static int64_t recover_more(const lar_block_run *run, const lar_viscous_step *step,
                            const lar_active_step *active, const double *u, int64_t *force,
                            const lar_hex8_limits *limits, lar_hex8_monitor *monitor) {
    return recover_form(run, run->fibrous, step, active, u, force, limits, monitor);
}
#endif

#if LAR_SIMD == LAR_SIMD_AVX512
#define LAR_KERNELS_NAME   lar_kernels_avx512
#define LAR_KERNELS_TEXT   "avx512"
#define LAR_KERNELS_USABLE __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")
#elif LAR_SIMD == LAR_SIMD_AVX2
#define LAR_KERNELS_NAME   lar_kernels_avx2
#define LAR_KERNELS_TEXT   "avx2"
#define LAR_KERNELS_USABLE __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
#elif LAR_SIMD == LAR_SIMD_NEON
#define LAR_KERNELS_NAME   lar_kernels_neon
#define LAR_KERNELS_TEXT   "neon"
#define LAR_KERNELS_USABLE true
#elif defined(LAR_SIMD_C_FMA)
#define LAR_KERNELS_NAME   lar_kernels_c_fma
#define LAR_KERNELS_TEXT   "c"
#define LAR_KERNELS_USABLE __builtin_cpu_supports("fma")
#else
#define LAR_KERNELS_NAME   lar_kernels_c
#define LAR_KERNELS_TEXT   "c"
#define LAR_KERNELS_USABLE true
#endif

static bool available(void) {
    return LAR_KERNELS_USABLE;
}

extern const lar_kernels LAR_KERNELS_NAME;
const lar_kernels LAR_KERNELS_NAME = {
    .name = LAR_KERNELS_TEXT,
    .available = available,
    .recover = recover,
#ifndef LAR_KERNEL_ELASTIC
    .recover_more = recover_more,
    .corners = corners,
    .motion = motion,
#endif
    .expand = expand,
    .update = update,
};
