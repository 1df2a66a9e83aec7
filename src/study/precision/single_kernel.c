/* hex8_kernel.c in single precision: its `double` is a float here, and its lanes are those below.
 *
 * Compiled once per instruction set (LAR_SIMD) and once for either state (LAR_SINGLE_STATE). The
 * functions of base/simd.h for doubles stay what they are: with them nodes are gathered and forces
 * added, for two times LAR_SIMD elements.
 */
#include "study/precision/single.h"

#include "base/simd.h"
#include "model/material.h"

#pragma GCC diagnostic ignored "-Wpsabi"
#pragma GCC diagnostic ignored "-Wunused-function"
#ifdef __clang__
#pragma GCC diagnostic ignored "-Wunused-const-variable"
#pragma GCC diagnostic ignored "-Wkeyword-macro"
#endif

#if LAR_SIMD == LAR_SIMD_AVX512

enum { LANES = 16 };
typedef float single_lane __attribute__((vector_size(64)));
typedef int32_t single_bits __attribute__((vector_size(64)));
typedef int64_t single_ilane __attribute__((vector_size(128)));
typedef union single_halves {
    single_ilane whole;
    lar_ilane half[2];
} single_halves;

LAR_INLINE single_lane single_load(const float *p) {
    return (single_lane)_mm512_load_ps(p);
}
LAR_INLINE single_lane single_load_once(const float *p) {
    single_lane a = single_load(p);
    __asm__("" : "+v"(a));
    return a;
}
LAR_INLINE single_lane single_set(float a) {
    return (single_lane)_mm512_set1_ps(a);
}
LAR_INLINE single_lane single_fma(single_lane a, single_lane b, single_lane c) {
    return (single_lane)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
}
LAR_INLINE single_lane single_fnma(single_lane a, single_lane b, single_lane c) {
    return (single_lane)_mm512_fnmadd_ps((__m512)a, (__m512)b, (__m512)c);
}
LAR_INLINE single_lane single_max(single_lane a, single_lane b) {
    return (single_lane)_mm512_max_ps((__m512)a, (__m512)b);
}
LAR_INLINE single_lane single_sqrt(single_lane a) {
    return (single_lane)_mm512_sqrt_ps((__m512)a);
}
LAR_INLINE single_bits single_bits_of(single_lane a) {
    return (single_bits)a;
}
LAR_INLINE single_lane single_of_bits(single_bits a) {
    return (single_lane)a;
}
LAR_INLINE single_lane single_convert(single_bits a) {
    return (single_lane)_mm512_cvtepi32_ps((__m512i)a);
}
LAR_INLINE single_bits single_nearest(single_lane a) {
    return (single_bits)_mm512_cvtps_epi32((__m512)a);
}
LAR_INLINE single_ilane single_round(single_lane a) {
    single_halves to;
    to.half[0] = (lar_ilane)_mm512_cvtps_epi64(_mm512_castps512_ps256((__m512)a));
    to.half[1] = (lar_ilane)_mm512_cvtps_epi64(_mm512_extractf32x8_ps((__m512)a, 1));
    return to.whole;
}
LAR_INLINE single_lane narrow(const lar_lane a[2]) {
    return (single_lane)_mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps((__m512d)a[0])),
                                           _mm512_cvtpd_ps((__m512d)a[1]), 1);
}
enum { HALVES = 2 };

#else /* LAR_SIMD_C */

enum { LANES = 1 };
typedef float single_lane;
typedef int32_t single_bits;
typedef int64_t single_ilane;
typedef union single_halves {
    single_ilane whole;
    lar_ilane half[1];
} single_halves;

LAR_INLINE single_lane single_load(const float *p) {
    return *p;
}
LAR_INLINE single_lane single_load_once(const float *p) {
    return *p;
}
LAR_INLINE single_lane single_set(float a) {
    return a;
}
LAR_INLINE single_lane single_fma(single_lane a, single_lane b, single_lane c) {
    return fmaf(a, b, c);
}
LAR_INLINE single_lane single_fnma(single_lane a, single_lane b, single_lane c) {
    return fmaf(-a, b, c);
}
LAR_INLINE single_lane single_max(single_lane a, single_lane b) {
    return a > b ? a : b;
}
LAR_INLINE single_lane single_sqrt(single_lane a) {
    return sqrtf(a);
}
LAR_INLINE single_bits single_bits_of(single_lane a) {
    single_bits bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}
LAR_INLINE single_lane single_of_bits(single_bits a) {
    single_lane value;
    memcpy(&value, &a, sizeof value);
    return value;
}
LAR_INLINE single_lane single_convert(single_bits a) {
    return (float)a;
}
/* Beyond the integers, as NaN is: what AVX-512 gives. */
LAR_INLINE single_bits single_nearest(single_lane a) {
    return fabsf(a) < 0x1p31F ? (single_bits)lrintf(a) : INT32_MIN;
}
LAR_INLINE single_ilane single_round(single_lane a) {
    return fabsf(a) < 0x1p63F ? (int64_t)llrintf(a) : INT64_MIN;
}
LAR_INLINE single_lane narrow(const lar_lane a[1]) {
    return (float)a[0];
}
enum { HALVES = 1 };

#endif

LAR_INLINE void single_store(float *p, single_lane a) {
    memcpy(p, &a, sizeof a);
}

/* ---- nodes: relative to the element's first ---------------------------------------------- */

LAR_INLINE void relate(lar_lane at[HALVES][3], lar_lane origin[HALVES][3], single_lane out[3]) {
    for (int i = 0; i < 3; i++) {
        lar_lane a[HALVES];
        for (int h = 0; h < HALVES; h++) a[h] = at[h][i];
#if LAR_SINGLE_STATE
        lar_lane o[HALVES];
        for (int h = 0; h < HALVES; h++) o[h] = origin[h][i];
        out[i] = narrow(a) - narrow(o);
#else
        for (int h = 0; h < HALVES; h++) a[h] -= origin[h][i];
        out[i] = narrow(a);
#endif
    }
}

LAR_INLINE void single_gather(const float *nodes, size_t stride, const int32_t *first,
                              const int32_t *node, single_lane out[3]) {
    const double *u = (const double *)(const void *)nodes;
    lar_lane at[HALVES][3], origin[HALVES][3];
    for (int h = 0; h < HALVES; h++) {
        lar_lane_gather(u, stride, first + h * LAR_LANES, origin[h]);
        lar_lane_gather(u, stride, node + h * LAR_LANES, at[h]);
    }
    relate(at, origin, out);
}

LAR_INLINE void single_gather_row(const float *nodes, size_t stride, const int32_t *first,
                                  const int32_t *node, bool half, single_lane out[3]) {
    const double *u = (const double *)(const void *)nodes;
    lar_lane at[HALVES][3], origin[HALVES][3];
    for (int h = 0; h < HALVES; h++) {
        lar_lane_gather_row(u, stride, first + h * LAR_LANES, half, origin[h]);
        lar_lane_gather_row(u, stride, node + h * LAR_LANES, half, at[h]);
    }
    relate(at, origin, out);
}

LAR_INLINE void single_scatter(int64_t *nodes, size_t stride, const int32_t *node,
                               const single_ilane add[3]) {
    single_halves from[3];
    for (int i = 0; i < 3; i++) from[i].whole = add[i];
    for (int h = 0; h < HALVES; h++) {
        const lar_ilane part[3] = {from[0].half[h], from[1].half[h], from[2].half[h]};
        lar_ilane_scatter_add(nodes, stride, node + h * LAR_LANES, part);
    }
}

LAR_INLINE void single_scatter_row(int64_t *nodes, size_t stride, const int32_t *left_node,
                                   const int32_t *right_node, bool half, int axes,
                                   const single_ilane *left, const single_ilane *right) {
    single_halves l[3], r[3];
    for (int i = 0; i < 3; i++) {
        l[i].whole = left[i];
        r[i].whole = right[i];
    }
    for (int h = 0; h < HALVES; h++) {
        const lar_ilane l_part[3] = {l[0].half[h], l[1].half[h], l[2].half[h]};
        const lar_ilane r_part[3] = {r[0].half[h], r[1].half[h], r[2].half[h]};
        lar_ilane_scatter_row(nodes, stride, left_node + h * LAR_LANES, right_node + h * LAR_LANES,
                              half, axes, l_part, r_part);
    }
}

/* ---- lane_math.h in float ---------------------------------------------------------------- */

#define LAR_LAW_LANE_MATH_H

/* J^(-1/3): the guess reads the whole float as an integer, within 3.5 % as there. */
LAR_INLINE single_lane lar_lane_rcbrt(single_lane J) {
    single_lane bits = single_convert(single_bits_of(J));
    single_lane guess = single_fma(bits, single_set(-1.0F / 3), single_set(1419898955.0F));
    single_lane y = single_of_bits(single_nearest(guess));
    for (int i = 0; i < 2; i++) {
        single_lane r = single_fnma(y * y, J * y, single_set(1));
        single_lane series = single_fma(r, single_set(14.0F / 81), single_set(2.0F / 9));
        series = single_fma(r, series, single_set(1.0F / 3));
        y = single_fma(y * r, series, y);
    }
    return y;
}

/* ln(J): the odd series up to s^9 leaves less than 4e-9. */
LAR_INLINE single_lane lar_lane_log(single_lane J) {
    const int32_t half_bits = 0x3f3504f3; /* sqrt(1/2) */
    single_bits bits = single_bits_of(J);
    single_bits above = bits - half_bits;
    single_bits k = above >> 23;
    single_lane m = single_of_bits(bits - (above & ~((1 << 23) - 1)));
    single_lane s = (m - single_set(1)) / (m + single_set(1));
    single_lane s2 = s * s;
    single_lane sum = single_set(2.0F / 9);
    for (int n = 7; n >= 3; n -= 2) sum = single_fma(sum, s2, single_set(2.0F / (float)n));
    single_lane log_m = single_fma(s2 * s, sum, s + s);
    return single_fma(single_convert(k), single_set(0x1.62e430p-1F), log_m);
}

/* e^x as there, by Taylor's series up to r^7; x counts as 87 at most in size. */
LAR_INLINE single_lane lar_lane_exp_parts(single_lane x, single_lane *power) {
    static const float term[] = {1.0F / 5040, 1.0F / 720, 1.0F / 120, 1.0F / 24, 1.0F / 6, 0.5F};
    const single_lane magic = single_set(0x1.8p23F), max = single_set(87);
    x = -single_max(-max, -single_max(-max, x));
    single_lane shifted = single_fma(x, single_set(0x1.715476p+0F), magic);
    single_lane k = shifted - magic;
    single_lane r = single_fnma(k, single_set(0x1.62e430p-1F), x);
    r = single_fnma(k, single_set(-0x1.05c610p-29F), r);
    single_lane sum = single_set(term[0]);
    for (int n = 1; n < 6; n++) sum = single_fma(sum, r, single_set(term[n]));
    *power = single_of_bits(((single_bits_of(shifted) + 127) & 0xff) << 23);
    return single_fma(r * r, sum, r);
}
LAR_INLINE single_lane lar_lane_exp(single_lane x) {
    single_lane power, less_one = lar_lane_exp_parts(x, &power);
    return single_fma(power, less_one, power);
}
LAR_INLINE single_lane lar_lane_expm1(single_lane x) {
    single_lane power, less_one = lar_lane_exp_parts(x, &power);
    return single_fma(power, less_one, power - single_set(1));
}

LAR_INLINE single_lane lar_lane_sign(single_lane x) {
    return single_of_bits((single_bits_of(x) & INT32_MIN) | 0x3f800000);
}

#define LAR_LANE_TINY 1e-30F

/* ---- the source, in float ---------------------------------------------------------------- */

#define lar_lane              single_lane
#define lar_ilane             single_ilane
#define lar_lane_load         single_load
#define lar_lane_keep(a)      (a)
#define lar_lane_load_once    single_load_once
#define lar_lane_load_row     single_load
#define lar_lane_store        single_store
#define lar_lane_set          single_set
#define lar_lane_fma          single_fma
#define lar_lane_fnma         single_fnma
#define lar_lane_sqrt         single_sqrt
#define lar_lane_max          single_max
#define lar_lane_round        single_round
#define lar_ilane_scatter_add single_scatter
#define lar_ilane_scatter_row single_scatter_row
/* Where the kernel gathers, `head` is the block and `lane` its first lane. */
#define lar_lane_gather(u, stride, local, out)                                                     \
    single_gather(u, stride, head->node[0] + lane, local, out)
#define lar_lane_gather_row(u, stride, local, half, out)                                           \
    single_gather_row(u, stride, head->node[0] + lane, local, half, out)
/* What is relative to an element's first node is made in one place. */
#define LANES_LIE_IN_ROWS(rows) ((void)(rows), false)
#define LANES_KNOW_FOURS        0
/* Watching and moving are left to others: what they need does nothing. */
#define lar_lane_not_greater(a, b) ((void)(a), (void)(b), 0U)
#define lar_lane_abs(a)            (a)
#define lar_ilane_to_lane(a)       ((void)(a), single_set(0))
#define lar_ilane_load(p)          ((void)(p), (single_ilane){0})
#define lar_ilane_store(p, a)      ((void)(p), (void)(a))

#define double float
#include "mechanics/hex8.h"

/* Instead of mechanics/hex8_block.h: 16 elements, and only what the kernel's source names. */
#define LAR_MECHANICS_HEX8_BLOCK_H
enum { LAR_BLOCK = LAR_SINGLE_BLOCK, LAR_BLOCK_PARAMETERS = 3 };
enum { LAR_MORE_PARAMETERS = LAR_LAW_PARAMETERS - LAR_BLOCK_PARAMETERS };
typedef enum { LAR_ROWS_NONE, LAR_ROWS_FOUR, LAR_ROWS_EIGHT, LAR_ROWS_COUNT } lar_block_rows;
typedef enum { LAR_SHAPE_GENERAL, LAR_SHAPE_BOX, LAR_SHAPE_COUNT } lar_block_shape;
typedef lar_single_head lar_block_head;
typedef lar_single_more lar_block_more;
typedef lar_single_general lar_hex8_block;
typedef lar_single_box lar_box_block;
typedef struct lar_lean_block { /* there are none: single.c makes them whole */
    float volume[LAR_BLOCK];
} lar_lean_block;
enum { LAR_ASK_NOTHING, LAR_ASK_MANY = 2, LAR_ASK_FEW = 5 };
typedef struct lar_block_run {
    lar_law law;
    lar_block_shape shape;
    lar_block_rows rows;
    int turn;
    int asks;
    int32_t count;
    size_t axis_stride;
    const void *blocks;
    const lar_block_more *more;
    const float *rest;
} lar_block_run;
typedef struct lar_hex8_limits {
    float min_volume, stress_square, hourglass_square;
} lar_hex8_limits;
enum { LAR_STRAIN_VOLUME, LAR_STRAIN_LENGTH, LAR_STRAIN_AREA, LAR_STRAIN_NUMBERS };
#define LAR_STRAINED_AREA (3 * 1.4F)
enum { LAR_LANE_FLAT = 1 << 30 };
typedef struct lar_hex8_monitor {
    const float *limit, *area;
    int32_t count, *lane;
    float (*strain)[LAR_STRAIN_NUMBERS];
} lar_hex8_monitor;
typedef struct lar_leapfrog {
    float keep, dt, speed, drift[3], push;
} lar_leapfrog;
typedef struct lar_kernels {
    const char *name;
    bool (*available)(void);
    int64_t (*recover)(const lar_block_run *run, const float *u, int64_t *force,
                       const lar_hex8_limits *limits, lar_hex8_monitor *monitor);
    void (*expand)(const lar_block_run *run, int32_t b, lar_hex8_block *whole);
    bool (*update)(const lar_leapfrog *leapfrog, int32_t first, int32_t end, size_t stride,
                   float *u, float *v, int64_t *force, const float *push, const float *mass,
                   float *damped, float *fastest);
} lar_kernels;
static inline size_t lar_block_size(lar_block_shape shape) {
    return shape == LAR_SHAPE_BOX ? sizeof(lar_box_block) : sizeof(lar_hex8_block);
}
static inline size_t lar_run_stride(const lar_block_run *run) {
    return lar_block_size(run->shape);
}
static inline const void *lar_run_block(const lar_block_run *run, int32_t b) {
    return (const char *)run->blocks + (size_t)b * lar_run_stride(run);
}
static inline void lar_lean_head(const lar_block_run *run, const lar_lean_block *lean,
                                 lar_block_head *head) {
    (void)run, (void)lean, (void)head;
}

/* A bit per element of a chunk: 64 of them. */
#define unsigned uint64_t
#define _Static_assert(condition, text) extern int single_nothing
#define JOIN_(a, b, c)     a##b##c
#define JOIN(a, b, c)      JOIN_(a, b, c)
#define lar_kernels_avx512 JOIN(single_source_, LAR_SINGLE_NAME, LAR_SINGLE_STATE)
#define lar_kernels_c      JOIN(single_source_, LAR_SINGLE_NAME, LAR_SINGLE_STATE)
#undef LAR_LANES
#define LAR_LANES LANES
#define LAR_KERNEL_ELASTIC
#include "mechanics/hex8_kernel.c"
#undef double
#undef unsigned

/* ------------------------------------------------------------------------------------------ */

static void recover_run(const lar_single_run *run, const double *u, int64_t *force) {
    const lar_hex8_limits none = {0, 0, 0};
    const lar_block_run made = {.law = (lar_law)run->law,
                                .shape = (lar_block_shape)run->shape,
                                .rows = (lar_block_rows)run->rows,
                                .turn = run->turn,
                                .count = run->count,
                                .axis_stride = run->axis_stride,
                                .blocks = run->blocks,
                                .more = run->more};
    LAR_KERNELS_NAME.recover(&made, (const float *)(const void *)u, force, &none, NULL);
}

#define EXPORTED JOIN(lar_single_, LAR_SINGLE_NAME, LAR_SINGLE_STATE)
#define TEXT_(a) #a
#define TEXT(a)  TEXT_(a)

extern const lar_single_kernels EXPORTED;
const lar_single_kernels EXPORTED = {
    .name = TEXT(LAR_SINGLE_NAME), .lanes = LANES, .recover = recover_run};
