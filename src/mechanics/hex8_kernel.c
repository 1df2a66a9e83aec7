/* The hex8 kernels of one instruction set: compiled once per LAR_SIMD (src/CMakeLists.txt).
 *
 * The formulas are those of hex8.h, in the same order as hex8.c, a lane per element, in three
 * phases:
 *
 *     strain   gather nodes, transform, deformation gradient, hourglass forces    by shape, rows
 *   ( fold     what keeps flat elements from folding (fold/hex8_fold_lanes.h)                   )
 *     stress   the material law                                                   by law
 *   ( fibres   what they add (hex8_fibre.h)                                       by fibre law )
 *   ( relax    what a viscous material remembers (viscous/hex8_viscous.h)         by viscosity )
 *     force    modal forces, rounding, transform back, scatter to nodes           by shape, rows
 *
 * The order of the statements follows the life of the values: 21 modal displacements and 9
 * gradients fill the 32 registers of AVX-512. With sixteen, axes take turns where that suffices
 * (AXES, hex8_gather.h). Compilers keep this order, so mind it.
 */
#include "mechanics/hex8_block.h"

#include "base/simd.h"
#include "law/lanes.h"
#include "mechanics/hex8_gather.h"
#include "mechanics/hex8_lean.h"
#include "mechanics/node_update.h"
#ifndef LAR_KERNEL_ELASTIC
#include "mechanics/fold/hex8_fold_lanes.h"
#include "mechanics/hex8_fibre.h"
#include "mechanics/hex8_group.h"
#include "mechanics/viscous/hex8_viscous.h"
#endif

/* ---- phases -------------------------------------------------------------------------------- */

/* Some lanes' gradients and, of general blocks, the shapes behind them, LAR_BLOCK values from one
 * number to the next. Where axes take turns a compiler that knows where this comes from keeps each
 * number, or each address, for the next axis, and has registers for neither. */
LAR_INLINE const double *constants_of(const void *block, int lane, lar_block_shape shape) {
    const lar_hex8_block *general = block;
    const lar_box_block *box = block;
    const double *first =
        shape == LAR_SHAPE_BOX ? &box->gradient[0][lane] : &general->gradient[0][0][lane];
    __asm__("" : "+r"(first));
    return first;
}
/* What one axis uses at a time is loaded where it does. */
LAR_INLINE lar_lane gradient_of(const double *constants, int k) {
    const double *p = constants + (size_t)k * LAR_BLOCK;
    return AXES > 1 ? lar_lane_load_once(p) : lar_lane_load(p);
}
LAR_INLINE lar_lane shape_of(const double *constants, int k) {
    return lar_lane_load_once(constants + (size_t)(3 * LAR_HEX8_GRADIENTS + k) * LAR_BLOCK);
}
_Static_assert(offsetof(lar_hex8_block, shape) ==
                   offsetof(lar_hex8_block, gradient) + sizeof(((lar_hex8_block *)NULL)->gradient),
               "shapes stand behind gradients");

#if LAR_SIMD == LAR_SIMD_AVX2
__attribute__((noinline, cold)) static void round_large(const lar_lane G[7], lar_ilane n[7]) {
    for (int m = 0; m < 7; m++) n[m] = lar_lane_round(G[m]);
}

/* Modal forces are below 2^51 units but where a material is crushed, and those take half the
 * operations. */
LAR_INLINE void round_modes(const lar_lane G[7], lar_ilane n[7]) {
    lar_lane sum = lar_lane_fma(G[0], G[0], G[1] * G[1]), more = G[2] * G[2];
    UNROLL7 for (int m = 3; m < 7; m++) more = lar_lane_fma(G[m], G[m], more);
    if (__builtin_expect(lar_lane_not_greater(lar_lane_set(0x1p101), sum + more) != 0, 0)) {
        lar_lane large[7]; /* copies, so that the others stay in registers */
        lar_ilane rounded[7];
        memcpy(large, G, sizeof large);
        round_large(large, rounded);
        memcpy(n, rounded, sizeof rounded);
        return;
    }
    UNROLL7 for (int m = 0; m < 7; m++) n[m] = lar_lane_round_small(G[m]);
}
#else
LAR_INLINE void round_modes(const lar_lane G[7], lar_ilane n[7]) {
    UNROLL7 for (int m = 0; m < 7; m++) n[m] = lar_lane_round(G[m]);
}
#endif

/* Some axes of the gradient of displacement, from modes U of these axes. */
LAR_INLINE void strain_general(const double *constants, lar_lane U[AXES][7], lar_lane H[AXES][3]) {
    UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane B = gradient_of(constants, j);
        UNROLL3 for (int i = 0; i < AXES; i++) H[i][j] = U[i][0] * B;
    }
    UNROLL6 for (int m = 1; m < LAR_HEX8_GRADIENTS; m++) UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane B = gradient_of(constants, 3 * m + j);
        UNROLL3 for (int i = 0; i < AXES; i++) H[i][j] = lar_lane_fma(U[i][m], B, H[i][j]);
    }
}

/* The same of a box: column turn + m is U_m B_m. */
LAR_INLINE void strain_box(const double *constants, int turn, lar_lane U[AXES][7],
                           lar_lane H[AXES][3]) {
    UNROLL3 for (int m = 0; m < 3; m++) {
        int axis = turn + m < 3 ? turn + m : turn + m - 3;
        lar_lane B = gradient_of(constants, m);
        UNROLL3 for (int i = 0; i < AXES; i++) H[i][axis] = U[i][m] * B;
    }
}

/* Of the modes of a general element what its gradient does not explain: q_m = U_m - H X_m. */
LAR_INLINE void strain_hourglass(const double *constants, const lar_lane H[3][3],
                                 lar_lane q[3][LAR_HEX8_HOURGLASS]) {
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane X = shape_of(constants, 3 * m + j);
        UNROLL3 for (int i = 0; i < 3; i++) q[i][m] = lar_lane_fnma(H[i][j], X, q[i][m]);
    }
}

/* Phase 1: displacements to deformation gradient and hourglass forces. */
LAR_INLINE void strain_lanes(const void *block, int lane, lar_block_shape shape,
                             lar_block_rows rows, bool fours, int turn, lane_nodes u,
                             lane_record *record) {
    const lar_block_head *head = block;
    picked_corners picked;
    const lane_corners from = find_corners(head, lane, rows, fours, u, &picked);
    lar_lane H[3][3], q[3][LAR_HEX8_HOURGLASS];
    UNROLL3 for (int first = 0; first < 3; first += AXES) {
        const double *constants = constants_of(block, lane, shape);
        lar_lane U[AXES][7];
        UNROLL3 for (int i = 0; i < AXES; i++) gather_axis(from, first + i, fours, U[i]);
        if (shape == LAR_SHAPE_BOX)
            strain_box(constants, turn, U, H + first);
        else
            strain_general(constants, U, H + first);
        UNROLL3 for (int i = 0; i < AXES; i++) UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
            q[first + i][m] = U[i][3 + m];
    }
    if (shape == LAR_SHAPE_GENERAL)
        strain_hourglass(constants_of(block, lane, shape), (const lar_lane(*)[3])H, q);
    UNROLL3 for (int i = 0; i < 3; i++) UNROLL3 for (int j = 0; j < 3; j++) record->F[3 * i + j] =
        i == j ? H[i][j] + lar_lane_set(1) : H[i][j];
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        lar_lane c = lar_lane_load_once(&head->stiffness[m][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) record->cq[m][i] = q[i][m] * c;
    }
}

typedef lar_lane (*lane_law)(const lar_lane F[9], lar_lane P[9], lar_lane J, lar_lane I1,
                             const lar_lane *p);
typedef unsigned (*lane_stiffened)(lar_lane J, lar_lane I1, lar_lane area, const lar_lane *p,
                                   lar_lane share);

/* From where on an element is looked at more closely, besides LAR_STRAINED_AREA: its volume (the
 * slope of K ln J / J is then 1.5 K, and what is held on all sides and flat feels all of it); the
 * part of its modulus at rest by which a law stiffens; and how far the gradient in a corner may be
 * from the mean one, squared. */
static const double STRAINED_VOLUME = 0.88, STRAINED_SHEAR = 0.4, STRAINED_CORNER = 0.09;

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

/* Stress less what hourglass forces take of it. */
LAR_INLINE void stress_left(const double *constants, const lane_record *record, lar_lane S[3][3]) {
    UNROLL3 for (int i = 0; i < 3; i++) UNROLL3 for (int j = 0; j < 3; j++) S[i][j] =
        record->F[3 * i + j];
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane X = shape_of(constants, 3 * m + j);
        UNROLL3 for (int i = 0; i < 3; i++) S[i][j] = lar_lane_fnma(record->cq[m][i], X, S[i][j]);
    }
}

/* Some axes of the modal forces, `first` and those after it, from these axes of S. */
LAR_INLINE void force_general(const double *constants, const lane_record *record, int first,
                              lar_lane S[AXES][3], lar_lane G[AXES][7]) {
    UNROLL6 for (int m = 0; m < LAR_HEX8_GRADIENTS; m++) {
        lar_lane B[3];
        UNROLL3 for (int j = 0; j < 3; j++) B[j] = gradient_of(constants, 3 * m + j);
        UNROLL3 for (int i = 0; i < AXES; i++) {
            lar_lane sum =
                m < 3 ? S[i][0] * B[0] : lar_lane_fma(S[i][0], B[0], record->cq[m - 3][first + i]);
            G[i][m] = lar_lane_fma(S[i][2], B[2], lar_lane_fma(S[i][1], B[1], sum));
        }
    }
}

LAR_INLINE void force_box(const double *constants, int turn, const lane_record *record, int first,
                          lar_lane G[AXES][7]) {
    UNROLL3 for (int m = 0; m < 3; m++) {
        int axis = turn + m < 3 ? turn + m : turn + m - 3;
        lar_lane B = gradient_of(constants, m);
        UNROLL3 for (int i = 0; i < AXES; i++) {
            G[i][m] = record->F[3 * (first + i) + axis] * B;
            G[i][3 + m] = record->cq[m][first + i];
        }
    }
}

/* The transform back of some axes, from the modes n: along zeta, eta, xi; and to the nodes of rows,
 * while corners of other lanes wait for hand_out. */
LAR_INLINE void scatter_modes(const lar_block_head *head, int lane, bool in_rows, bool fours,
                              lar_ilane n[AXES][7], int first, lane_sums force,
                              lar_ilane corner[8][3]) {
    UNROLL3 for (int top = 0; top < 2; top++) {
        lar_ilane left[2][AXES], right[2][AXES];
        UNROLL3 for (int i = 0; i < AXES; i++) {
            lar_ilane zeta = top ? n[i][2] : -n[i][2];
            lar_ilane eta = top ? n[i][1] + n[i][3] : n[i][1] - n[i][3];
            lar_ilane xi = top ? n[i][0] + n[i][4] : n[i][0] - n[i][4];
            lar_ilane xieta = top ? n[i][5] + n[i][6] : n[i][5] - n[i][6];
            lar_ilane sum = zeta - eta, difference = xi - xieta;
            left[0][i] = sum - difference;
            right[0][i] = sum + difference;
            sum = zeta + eta;
            difference = xi + xieta;
            left[1][i] = sum - difference;
            right[1][i] = sum + difference;
        }
        UNROLL3 for (int k = 0; k < 2; k++) {
            const int a = left_node[2 * top + k], b = right_node[2 * top + k];
            if (in_rows)
                lar_ilane_scatter_row(force.value + (size_t)first * force.stride, force.stride,
                                      head->node[a] + lane, head->node[b] + lane, fours, AXES,
                                      left[k], right[k]);
            else
                UNROLL3 for (int i = 0; i < AXES; i++) {
                    corner[a][first + i] = left[k][i];
                    corner[b][first + i] = right[k][i];
                }
        }
    }
}

/* Phase 3: stress and hourglass forces to the nodes. */
LAR_INLINE void force_lanes(const void *block, int lane, lar_block_shape shape, lar_block_rows rows,
                            bool fours, int turn, const lane_record *record, lane_sums force) {
    const bool in_rows = fours || LANES_LIE_IN_ROWS(rows);
    lar_ilane corner[8][3];
    lar_lane S[3][3];
    if (shape == LAR_SHAPE_GENERAL) stress_left(constants_of(block, lane, shape), record, S);
    /* Where axes take turns this stays a loop: as fast as three copies, and a third of the code. */
    _Pragma("GCC unroll 1") for (int first = 0; first < 3; first += AXES) {
        lar_lane G[AXES][7];
        lar_ilane n[AXES][7];
        const double *constants = constants_of(block, lane, shape);
        if (shape == LAR_SHAPE_BOX)
            force_box(constants, turn, record, first, G);
        else
            force_general(constants, record, first, S + first, G);
        UNROLL3 for (int i = 0; i < AXES; i++) {
            G[i][6] = record->cq[3][first + i];
            round_modes(G[i], n[i]);
        }
        if (in_rows)
            scatter_modes(block, lane, true, fours, n, first, force, corner);
        else
            scatter_modes(block, lane, false, fours, n, first, force, corner);
    }
    if (!in_rows) hand_out(block, lane, rows, (const lar_ilane(*)[3])corner, force);
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
                            int asks, const lane_record *record, lane_sums force);

#define DEFINE_PHASES(name, shape, fours)                                                          \
    static void strain_##name(const char *blocks, size_t count, lar_block_rows rows, int turn,     \
                              lane_nodes u, lane_record *record) {                                 \
        FOR_PARTS(blocks, count, lar_block_size(shape))                                            \
        strain_lanes(block, lane, shape, rows, fours, turn, u, record);                            \
    }                                                                                              \
    static void force_##name(const char *blocks, size_t count, lar_block_rows rows, int turn,      \
                             int asks, const lane_record *record, lane_sums force) {               \
        const size_t each = (size_t)asks, size = lar_block_size(shape);                            \
        FOR_PARTS(blocks, count, size) {                                                           \
            if (each && lane == 0) ask(block + CHUNK * size, size, each / 2, each);                \
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

#ifdef __OPTIMIZE_SIZE__
/* Where it cannot be fast laws are called: those of the table, which are the same to the bit. */
#define FOR_EACH_LAW           __attribute__((noinline)) static
#define LAW_STRESS(identifier) lar_law_table[LAR_LAW_##identifier].stress
#else
#define FOR_EACH_LAW           LAR_INLINE
#define LAW_STRESS(identifier) lar_##identifier##_stress
#endif

/* Returns a bit per element of the chunk that is beyond the limits. */
FOR_EACH_LAW unsigned stress_parts(const char *blocks, const lar_block_more *more, size_t count,
                                   size_t size, lane_record *record, const lar_hex8_limits *limits,
                                   lane_law law, lane_stiffened stiffened, double share,
                                   const double *limit, lane_strain *strain, unsigned *strained) {
    unsigned beyond = 0, part = 0;
    int shift = 0;
    FOR_PARTS(blocks, count, size) {
        beyond |= stress_lanes((const lar_block_head *)(const void *)block, lane, record,
                               more ? more + shift / LAR_BLOCK : NULL, limits, law, stiffened,
                               share, limit ? limit + shift : NULL, strain, &part)
                  << shift;
        if (limit) *strained |= part << shift;
        strain++;
        shift += LAR_LANES;
    }
    return beyond;
}

#define DEFINE_LAW(identifier)                                                                     \
    static unsigned stress_##identifier(                                                           \
        const char *blocks, const lar_block_more *more, size_t count, size_t size,                 \
        lane_record *record, const lar_hex8_limits *limits, double share, const double *limit,     \
        lane_strain *strain, unsigned *strained) {                                                 \
        return stress_parts(blocks, more, count, size, record, limits, LAW_STRESS(identifier),     \
                            lar_##identifier##_stiffened, share, limit, strain, strained);         \
    }
LAR_LAWS(DEFINE_LAW)
#define LAW_ROW(identifier) [LAR_LAW_##identifier] = stress_##identifier,
static const stress_phase stress_table[LAR_LAW_COUNT] = {LAR_LAWS(LAW_ROW)};

_Static_assert(CHUNK *LAR_BLOCK <= 32, "one bit per element of a chunk");

/* Elements of a chunk that are strained too much for their shape or their tissue. */
LAR_INLINE unsigned flat_lanes(const double *area, size_t parts, const lane_strain *strain) {
    unsigned found = 0;
    for (size_t i = 0; i < parts; i++) {
        lar_lane limit = lar_lane_load(area + i * LAR_LANES);
        lar_lane now = strain[i].number[LAR_STRAIN_AREA], J = strain[i].number[LAR_STRAIN_VOLUME];
        unsigned by_area = lar_lane_not_greater(limit, now);
        if (by_area) {
            unsigned tissue = by_area & lar_lane_not_greater(limit, lar_lane_set(0));
            lar_lane most = lar_lane_set(0) - limit;
            by_area &= ~tissue | lar_lane_not_greater(most, now) |
                       lar_lane_not_greater(most, now / (J * J));
        }
        found |= by_area << i * LAR_LANES;
    }
    return found;
}

/* Lists the strained elements of a chunk that begins with block b, and those that only are too
 * `flat` for their strain. */
static void list_strained(lar_hex8_monitor *monitor, int32_t b, unsigned strained, unsigned flat,
                          const lane_strain *strain) {
    int32_t count = monitor->count, *listed = monitor->lane;
    float(*to)[LAR_STRAIN_NUMBERS] = monitor->strain;
    for (unsigned all = strained | flat; all; all &= all - 1, count++) {
        int lane = __builtin_ctz(all);
        const lar_lane *number = strain[lane / LAR_LANES].number;
        UNROLL4 for (int k = 0; k < LAR_STRAIN_NUMBERS; k++) {
            double value; /* of one lane: no need to load the others */
            memcpy(&value, (const double *)(const void *)&number[k] + lane % LAR_LANES,
                   sizeof value);
            to[count][k] = (float)value;
        }
        int32_t mark = strained >> lane & 1 ? 0 : LAR_LANE_FLAT;
        listed[count] = (b * LAR_BLOCK + lane) | mark;
    }
    monitor->count = count;
}

#ifdef LAR_KERNEL_ELASTIC
typedef struct lar_viscous_step lar_viscous_step;
typedef struct lar_active_step lar_active_step;
typedef struct lar_fold_block lar_fold_block;
typedef struct viscous_lane {
    int nothing;
} viscous_lane;
enum { SOFTER = 1 };
#define viscous_begin(of)                                                   ((void)(of))
#define softer_of(run)                                                      ((void)(run), SOFTER)
#define relax(run, step, b, count, limits, gradient, of, record)            0U
#define stretch(run, b, count, limits, limit, gradient, record, strain, of) 0U
#define contract(run, active, b, count, limits, gradient, record)           ((void)(active), 0U)
#define note_beyond(step, b, count, beyond)                                 ((void)0)
#define fold(of, count, record, P)                                          0U
#define unfold(parts, P, record)                                            ((void)(parts), (void)(P))
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

/* Of the blocks of a chunk that begins with block b. */
__attribute__((noinline, cold)) static void note_beyond(const lar_viscous_step *step, int32_t b,
                                                        size_t count, unsigned beyond) {
    for (size_t i = 0; step->beyond && i < count; i++)
        step->beyond[(size_t)b + i] = beyond >> i * LAR_BLOCK & 0xff;
}
#endif

/* Constants 0 and NULL for what is elastic alone: `fibrous`, `step`, `all`. */
LAR_INLINE int64_t recover_form(const lar_block_run *run, int fibrous, const lar_fold_block *all,
                                const lar_viscous_step *step, const lar_active_step *active,
                                const double *u, int64_t *force, const lar_hex8_limits *limits,
                                lar_hex8_monitor *monitor) {
    lar_lane gradient[CHUNK * PARTS][9], folded[CHUNK * PARTS][9];
    double share = step ? STRAINED_SHEAR * softer_of(run) : STRAINED_SHEAR;
    lane_record record[CHUNK * PARTS];
    lane_strain strains[CHUNK * PARTS];
    strain_phase strain = strain_table[run->shape][run->rows];
    stress_phase stress = stress_table[run->law];
    force_phase forces = force_table[run->shape][run->rows];
    size_t size = lar_block_size(run->shape);
    /* Where blocks are asked for, a little before the stress of each and before its force. */
    int asks = run->rest ? LAR_ASK_NOTHING : run->asks;
    size_t together = asks ? 1 : CHUNK, first_each = asks == LAR_ASK_MANY ? 2 : 2 * LAR_ASK_FEW;
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
        unsigned folds = all ? fold(all + b, count, record, folded) : 0;
        for (size_t i = 0; (step || fibrous) && i < count * PARTS; i++)
            memcpy(gradient[i], record[i].F, sizeof gradient[i]);
        unsigned beyond = 0;
        for (size_t i = 0; i < count; i += together) {
            unsigned some = 0;
            const char *block = blocks + i * size;
            if (asks) ask(block + CHUNK * size, size, 0, first_each);
            if (asks == LAR_ASK_MANY) ask_for_nodes(run, (const void *)block, u, force);
            beyond |= stress(block, more ? more + i : NULL, count < together ? count : together,
                             size, record + i * PARTS, limits, share,
                             limit ? limit + i * LAR_BLOCK : NULL, strains + i * PARTS, &some)
                      << i * LAR_BLOCK;
            strained |= some << i * LAR_BLOCK;
        }
        if (fibrous)
            beyond |= stretch(run, b, count, limits->stress_square, limit, gradient, record,
                              strains, &strained);
        if (step) beyond |= relax(run, step, b, count, limits, gradient, &fade, record);
        if (fibrous) beyond |= contract(run, active, b, count, limits, gradient, record);
        if (all) unfold(folds, folded, record);
        forces(blocks, count, run->rows, run->turn, asks, record,
               (lane_sums){force, run->axis_stride});
        unsigned flat = 0;
        if (monitor && monitor->area)
            flat = flat_lanes(monitor->area + b * LAR_BLOCK, count * PARTS, strains);
        if (__builtin_expect((strained | flat) != 0, 0))
            list_strained(monitor, b, strained, flat, strains);
        if (__builtin_expect(beyond != 0 && (first < 0 || step), 0)) {
            int block = __builtin_ctz(beyond) / LAR_BLOCK;
            if (first < 0)
                first = (int64_t)(b + block) << 8 | (beyond >> (block * LAR_BLOCK) & 0xff);
            if (step) note_beyond(step, b, count, beyond);
        }
    }
    return first;
}

static int64_t recover(const lar_block_run *run, const double *u, int64_t *force,
                       const lar_hex8_limits *limits, lar_hex8_monitor *monitor) {
    return recover_form(run, 0, NULL, NULL, NULL, u, force, limits, monitor);
}

#ifndef LAR_KERNEL_ELASTIC
static int64_t recover_more(const lar_block_run *run, const lar_viscous_step *step,
                            const lar_active_step *active, const double *u, int64_t *force,
                            const lar_hex8_limits *limits, lar_hex8_monitor *monitor) {
    return recover_form(run, run->fibrous, run->folds, step, active, u, force, limits, monitor);
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
