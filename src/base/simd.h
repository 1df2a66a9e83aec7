/* Lanes: one double of each of several elements, the same bits on every processor.
 *
 * A kernel source is compiled once per instruction set with LAR_SIMD set to one of the numbers
 * below; `lar_lane` is then a vector of LAR_LANES doubles and `lar_ilane` one of 64-bit integers.
 * Plus, minus and times are the C operators; everything else is a function of this file. All
 * arithmetic is IEEE 754 double with fused multiply-add where it is written out, so a lane's
 * bits depend on nothing but its own inputs:
 *
 *     LAR_SIMD_C       1 lane    the reference; fma() is exact in software where need be, and on
 *                                x86 compiled once more with the instruction
 *     LAR_SIMD_NEON    2 lanes
 *     LAR_SIMD_AVX2    4 lanes   64-bit integer conversions are put together from halves
 *     LAR_SIMD_AVX512  8 lanes
 *
 * Nodes are stored axis by axis: all x, then all y, then all z. The lanes of a row are then
 * consecutive in memory, and what follows takes one axis at a time. Intrinsics appear in this file
 * and nowhere else.
 */
#ifndef LAR_BASE_SIMD_H
#define LAR_BASE_SIMD_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define LAR_SIMD_C      1
#define LAR_SIMD_NEON   2
#define LAR_SIMD_AVX2   4
#define LAR_SIMD_AVX512 8

#ifndef LAR_SIMD
#define LAR_SIMD LAR_SIMD_C
#endif
#define LAR_LANES LAR_SIMD

#define LAR_INLINE static inline __attribute__((always_inline, unused))
/* Long functions: in single numbers a call costs less than its copies do. */
#if LAR_SIMD == LAR_SIMD_C
#define LAR_LONG static __attribute__((noinline, unused))
#else
#define LAR_LONG LAR_INLINE
#endif

#if LAR_SIMD == LAR_SIMD_AVX512

#include <immintrin.h>
typedef double lar_lane __attribute__((vector_size(64)));
typedef int64_t lar_ilane __attribute__((vector_size(64)));

LAR_INLINE lar_lane lar_lane_load(const double *p) {
    return (lar_lane)_mm512_load_pd(p);
}
/* From anywhere. */
LAR_INLINE lar_lane lar_lane_load_row(const double *p) {
    return (lar_lane)_mm512_loadu_pd(p);
}
LAR_INLINE void lar_lane_store(double *p, lar_lane a) {
    _mm512_store_pd(p, (__m512d)a);
}
LAR_INLINE lar_lane lar_lane_set(double a) {
    return (lar_lane)_mm512_set1_pd(a);
}
LAR_INLINE lar_lane lar_lane_fma(lar_lane a, lar_lane b, lar_lane c) {
    return (lar_lane)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}
LAR_INLINE lar_lane lar_lane_fnma(lar_lane a, lar_lane b, lar_lane c) {
    return (lar_lane)_mm512_fnmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}
LAR_INLINE lar_ilane lar_lane_bits(lar_lane a) {
    return (lar_ilane)a;
}
LAR_INLINE lar_lane lar_ilane_as_lane(lar_ilane a) {
    return (lar_lane)a;
}
LAR_INLINE lar_ilane lar_lane_round(lar_lane a) {
    return (lar_ilane)_mm512_cvtpd_epi64((__m512d)a);
}
LAR_INLINE lar_lane lar_ilane_to_lane(lar_ilane a) {
    return (lar_lane)_mm512_cvtepi64_pd((__m512i)a);
}
/* Bit i set: NOT a > b in lane i (true also for NaN). */
LAR_INLINE unsigned lar_lane_not_greater(lar_lane a, lar_lane b) {
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_NGT_UQ);
}

LAR_INLINE lar_lane lar_lane_abs(lar_lane a) {
    return (lar_lane)_mm512_abs_pd((__m512d)a);
}
LAR_INLINE lar_lane lar_lane_max(lar_lane a, lar_lane b) {
    return (lar_lane)_mm512_max_pd((__m512d)a, (__m512d)b);
}
LAR_INLINE lar_lane lar_lane_sqrt(lar_lane a) {
    return (lar_lane)_mm512_sqrt_pd((__m512d)a);
}
LAR_INLINE lar_ilane lar_ilane_load(const int64_t *p) {
    return (lar_ilane)_mm512_load_si512(p);
}
LAR_INLINE void lar_ilane_store(int64_t *p, lar_ilane a) {
    _mm512_store_si512(p, (__m512i)a);
}

LAR_INLINE lar_lane lar_axis_gather(const double *axis, const int32_t *node) {
#define LAR_PAIR(i) _mm_loadh_pd(_mm_load_sd(axis + node[i]), axis + node[(i) + 1])
#define LAR_FOUR(i) _mm256_insertf128_pd(_mm256_castpd128_pd256(LAR_PAIR(i)), LAR_PAIR((i) + 2), 1)
    return (lar_lane)_mm512_insertf64x4(_mm512_castpd256_pd512(LAR_FOUR(0)), LAR_FOUR(4), 1);
#undef LAR_PAIR
#undef LAR_FOUR
}

/* Of two rows of four. */
LAR_INLINE lar_lane lar_axis_fours(const double *axis, const int32_t *left) {
    return (lar_lane)_mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(axis + left[0])),
                                        _mm256_loadu_pd(axis + left[4]), 1);
}

LAR_INLINE void lar_four_add(int64_t *p, __m256i add) {
    _mm256_storeu_si256((__m256i *)p,
                        _mm256_add_epi64(_mm256_loadu_si256((const __m256i *)p), add));
}
LAR_INLINE void lar_one_add(int64_t *p, __m128i add) {
    _mm_storel_epi64((__m128i *)p, _mm_add_epi64(_mm_loadl_epi64((const __m128i *)p), add));
}

/* Adds forces of a row of eight whose first left node is at a, or of two rows of four (`half`), the
 * second from b on. One turn moves every right force to the next lane, and the last one into the
 * first, from where it is stored without another. */
LAR_INLINE void lar_axis_add_row(int64_t *a, int64_t *b, bool half, lar_ilane left,
                                 lar_ilane right) {
    const __m512i l = (__m512i)left, r = (__m512i)right;
    if (!half) {
        __m512i turned = _mm512_alignr_epi64(r, r, 7);
        __m512i sum = _mm512_mask_add_epi64(l, 0xfe, l, turned);
        _mm512_storeu_si512(a, _mm512_add_epi64(_mm512_loadu_si512(a), sum));
        lar_one_add(a + 8, _mm512_castsi512_si128(turned));
        return;
    }
    __m512i turned = _mm512_permutex_epi64(r, 0x93);
    __m512i sum = _mm512_mask_add_epi64(l, 0xee, l, turned);
    lar_four_add(a, _mm512_castsi512_si256(sum));
    lar_four_add(b, _mm512_extracti64x4_epi64(sum, 1)); /* before a[4], where it may begin */
    lar_one_add(a + 4, _mm512_castsi512_si128(turned));
    lar_one_add(b + 4, _mm512_extracti64x2_epi64(turned, 2));
}

#elif LAR_SIMD == LAR_SIMD_AVX2

#include <immintrin.h>
typedef double lar_lane __attribute__((vector_size(32)));
typedef int64_t lar_ilane __attribute__((vector_size(32)));

LAR_INLINE lar_lane lar_lane_load(const double *p) {
    return (lar_lane)_mm256_load_pd(p);
}
LAR_INLINE lar_lane lar_lane_load_row(const double *p) {
    return (lar_lane)_mm256_loadu_pd(p);
}
LAR_INLINE void lar_lane_store(double *p, lar_lane a) {
    _mm256_store_pd(p, (__m256d)a);
}
LAR_INLINE lar_lane lar_lane_set(double a) {
    return (lar_lane)_mm256_set1_pd(a);
}
LAR_INLINE lar_lane lar_lane_fma(lar_lane a, lar_lane b, lar_lane c) {
    return (lar_lane)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
LAR_INLINE lar_lane lar_lane_fnma(lar_lane a, lar_lane b, lar_lane c) {
    return (lar_lane)_mm256_fnmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
LAR_INLINE lar_ilane lar_lane_bits(lar_lane a) {
    return (lar_ilane)a;
}
LAR_INLINE lar_lane lar_ilane_as_lane(lar_ilane a) {
    return (lar_lane)a;
}

/* Nearest integer of |a| < 2^62 in two halves. Adding 1.5 * 2^84 leaves the nearest multiple of
 * 2^32 as an integer in the low bits of `high`; the rest is exact and at most 2^31 in size, and
 * adding 1.5 * 2^52 does the same for it. What then stands above the rest, the bits of 1.5 * 2^52,
 * is taken away by as much less in the low bits of `high`. */
LAR_INLINE lar_ilane lar_lane_round(lar_lane a) {
    const lar_lane magic = lar_lane_set(0x1.8p52);
    const lar_lane above = lar_lane_set(0x1.80000bcc8p84); /* 1.5 * 2^84 - 0x43380000 * 2^32 */
    lar_lane high = a + above;
    lar_lane rest = (a - (high - above)) + magic;
    return ((lar_ilane)high << 32) + (lar_ilane)rest;
}
/* Correctly rounded: as bits of doubles the lower half stands above 2^52 and the upper one, its
 * sign turned, above 2^84; what they stand above, 2^52 and 2^84 + 2^63, goes away without a
 * rounding, and one addition joins them. */
LAR_INLINE lar_lane lar_ilane_to_lane(lar_ilane a) {
    const __m256i above_low = _mm256_set1_epi64x(0x4330000000000000LL);
    const lar_ilane above_high = (lar_ilane)lar_lane_set(0x1.000008p84);
    __m256i low = _mm256_blend_epi32(above_low, (__m256i)a, 0x55);
    lar_ilane high = (lar_ilane)_mm256_srli_epi64((__m256i)a, 32) ^ above_high;
    return ((lar_lane)high - lar_lane_set(0x1.00000801p84)) + (lar_lane)low;
}
/* Adding 1.5 * 2^52 leaves the nearest integer in the low bits of what is below 2^51. */
LAR_INLINE lar_ilane lar_lane_round_small(lar_lane a) {
    const lar_lane magic = lar_lane_set(0x1.8p52);
    return (lar_ilane)(a + magic) - (lar_ilane)magic;
}
/* As below, where others have them: numbers of 32 bits need no general conversion. */
LAR_INLINE lar_lane lar_lane_upper(lar_lane a) {
    const int64_t sign = 0x80000000LL, above = 0x4338000000000000LL;
    lar_ilane upper = (lar_ilane)_mm256_srli_epi64((__m256i)a, 32);
    return (lar_lane)((upper ^ sign) + (above - sign)) - lar_lane_set(0x1.8p52);
}
LAR_INLINE lar_lane lar_lane_from_upper(lar_lane a) {
    return (lar_lane)((lar_ilane)(a + lar_lane_set(0x1.8p52)) << 32);
}
LAR_INLINE unsigned lar_lane_not_greater(lar_lane a, lar_lane b) {
    return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_NGT_UQ));
}

LAR_INLINE lar_lane lar_lane_abs(lar_lane a) {
    return (lar_lane)_mm256_andnot_pd(_mm256_set1_pd(-0.0), (__m256d)a);
}
LAR_INLINE lar_lane lar_lane_max(lar_lane a, lar_lane b) {
    return (lar_lane)_mm256_max_pd((__m256d)a, (__m256d)b);
}
LAR_INLINE lar_lane lar_lane_sqrt(lar_lane a) {
    return (lar_lane)_mm256_sqrt_pd((__m256d)a);
}
LAR_INLINE lar_ilane lar_ilane_load(const int64_t *p) {
    return (lar_ilane)_mm256_load_si256((const __m256i *)p);
}
LAR_INLINE void lar_ilane_store(int64_t *p, lar_ilane a) {
    _mm256_store_si256((__m256i *)p, (__m256i)a);
}

LAR_INLINE lar_lane lar_axis_gather(const double *axis, const int32_t *node) {
    __m128d a = _mm_loadh_pd(_mm_load_sd(axis + node[0]), axis + node[1]);
    __m128d b = _mm_loadh_pd(_mm_load_sd(axis + node[2]), axis + node[3]);
    return (lar_lane)_mm256_insertf128_pd(_mm256_castpd128_pd256(a), b, 1);
}

/* As above: r3, r0, r1, r2. */
LAR_INLINE void lar_axis_add_row(int64_t *a, int64_t *b, bool half, lar_ilane left,
                                 lar_ilane right) {
    (void)half, (void)b;
    __m256i *row = (__m256i *)a;
    __m128i *end = (__m128i *)(a + 4);
    __m256i turned = _mm256_permute4x64_epi64((__m256i)right, 0x93);
    __m256i before = _mm256_blend_epi32(turned, _mm256_setzero_si256(), 3);
    __m256i sum = _mm256_add_epi64((__m256i)left, before);
    _mm256_storeu_si256(row, _mm256_add_epi64(_mm256_loadu_si256(row), sum));
    _mm_storel_epi64(end, _mm_add_epi64(_mm_loadl_epi64(end), _mm256_castsi256_si128(turned)));
}

#elif LAR_SIMD == LAR_SIMD_NEON

#include <arm_neon.h>
typedef double lar_lane __attribute__((vector_size(16)));
typedef int64_t lar_ilane __attribute__((vector_size(16)));

LAR_INLINE lar_lane lar_lane_load(const double *p) {
    return (lar_lane)vld1q_f64(p);
}
LAR_INLINE lar_lane lar_lane_load_row(const double *p) {
    return (lar_lane)vld1q_f64(p);
}
LAR_INLINE void lar_lane_store(double *p, lar_lane a) {
    vst1q_f64(p, (float64x2_t)a);
}
LAR_INLINE lar_lane lar_lane_set(double a) {
    return (lar_lane)vdupq_n_f64(a);
}
LAR_INLINE lar_lane lar_lane_fma(lar_lane a, lar_lane b, lar_lane c) {
    return (lar_lane)vfmaq_f64((float64x2_t)c, (float64x2_t)a, (float64x2_t)b);
}
LAR_INLINE lar_lane lar_lane_fnma(lar_lane a, lar_lane b, lar_lane c) {
    return (lar_lane)vfmsq_f64((float64x2_t)c, (float64x2_t)a, (float64x2_t)b);
}
LAR_INLINE lar_ilane lar_lane_bits(lar_lane a) {
    return (lar_ilane)a;
}
LAR_INLINE lar_lane lar_ilane_as_lane(lar_ilane a) {
    return (lar_lane)a;
}
LAR_INLINE lar_ilane lar_lane_round(lar_lane a) {
    return (lar_ilane)vcvtnq_s64_f64((float64x2_t)a);
}
LAR_INLINE lar_lane lar_ilane_to_lane(lar_ilane a) {
    return (lar_lane)vcvtq_f64_s64((int64x2_t)a);
}
LAR_INLINE unsigned lar_lane_not_greater(lar_lane a, lar_lane b) {
    uint64x2_t greater = vcgtq_f64((float64x2_t)a, (float64x2_t)b);
    return (vgetq_lane_u64(greater, 0) ? 0u : 1u) | (vgetq_lane_u64(greater, 1) ? 0u : 2u);
}

LAR_INLINE lar_lane lar_lane_abs(lar_lane a) {
    return (lar_lane)vabsq_f64((float64x2_t)a);
}
LAR_INLINE lar_lane lar_lane_max(lar_lane a, lar_lane b) {
    return (lar_lane)vmaxq_f64((float64x2_t)a, (float64x2_t)b);
}
LAR_INLINE lar_lane lar_lane_sqrt(lar_lane a) {
    return (lar_lane)vsqrtq_f64((float64x2_t)a);
}
LAR_INLINE lar_ilane lar_ilane_load(const int64_t *p) {
    return (lar_ilane)vld1q_s64(p);
}
LAR_INLINE void lar_ilane_store(int64_t *p, lar_ilane a) {
    vst1q_s64(p, (int64x2_t)a);
}

LAR_INLINE lar_lane lar_axis_gather(const double *axis, const int32_t *node) {
    return (lar_lane)vcombine_f64(vld1_f64(axis + node[0]), vld1_f64(axis + node[1]));
}

LAR_INLINE void lar_axis_add_row(int64_t *a, int64_t *b, bool half, lar_ilane left,
                                 lar_ilane right) {
    (void)half, (void)b;
    int64x2_t before = vextq_s64(vdupq_n_s64(0), (int64x2_t)right, 1); /* nothing, r0 */
    vst1q_s64(a, vaddq_s64(vld1q_s64(a), vaddq_s64((int64x2_t)left, before)));
    a[2] += right[1];
}

#else /* LAR_SIMD_C */

typedef double lar_lane;
typedef int64_t lar_ilane;

LAR_INLINE lar_lane lar_lane_load(const double *p) {
    return *p;
}
LAR_INLINE lar_lane lar_lane_load_row(const double *p) {
    return *p;
}
LAR_INLINE void lar_lane_store(double *p, lar_lane a) {
    *p = a;
}
LAR_INLINE lar_lane lar_lane_set(double a) {
    return a;
}
LAR_INLINE lar_lane lar_lane_fma(lar_lane a, lar_lane b, lar_lane c) {
    return fma(a, b, c);
}
LAR_INLINE lar_lane lar_lane_fnma(lar_lane a, lar_lane b, lar_lane c) {
    return fma(-a, b, c);
}
LAR_INLINE lar_ilane lar_lane_bits(lar_lane a) {
    int64_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}
LAR_INLINE lar_lane lar_ilane_as_lane(lar_ilane a) {
    double value;
    memcpy(&value, &a, sizeof value);
    return value;
}
LAR_INLINE lar_ilane lar_lane_round(lar_lane a) {
    return llrint(a);
}
LAR_INLINE lar_lane lar_ilane_to_lane(lar_ilane a) {
    return (double)a;
}
LAR_INLINE unsigned lar_lane_not_greater(lar_lane a, lar_lane b) {
    return !(a > b);
}

LAR_INLINE lar_lane lar_lane_abs(lar_lane a) {
    return fabs(a);
}
LAR_INLINE lar_lane lar_lane_max(lar_lane a, lar_lane b) {
    return a > b ? a : b;
}
LAR_INLINE lar_lane lar_lane_sqrt(lar_lane a) {
    return sqrt(a);
}
LAR_INLINE lar_ilane lar_ilane_load(const int64_t *p) {
    return *p;
}
LAR_INLINE void lar_ilane_store(int64_t *p, lar_ilane a) {
    *p = a;
}

LAR_INLINE lar_lane lar_axis_gather(const double *axis, const int32_t *node) {
    return axis[node[0]];
}

LAR_INLINE void lar_axis_add_row(int64_t *a, int64_t *b, bool half, lar_ilane left,
                                 lar_ilane right) {
    (void)half;
    *a += left;
    *b += right;
}

#endif

#if LAR_SIMD != LAR_SIMD_AVX2
/* The upper half of a double as a whole number, and from one, |a| < 2^31, a double with that as its
 * upper half. */
LAR_INLINE lar_lane lar_lane_upper(lar_lane a) {
    return lar_ilane_to_lane(lar_lane_bits(a) >> 32);
}
LAR_INLINE lar_lane lar_lane_from_upper(lar_lane a) {
    return lar_ilane_as_lane(lar_lane_round(a) << 32);
}
#endif

/* ---- nodes, `stride` values from one axis to the next ---------------------------------------- */

/* One local node of each lane. */
LAR_INLINE void lar_lane_gather(const double *nodes, size_t stride, const int32_t *node,
                                lar_lane out[3]) {
    for (int i = 0; i < 3; i++) out[i] = lar_axis_gather(nodes + (size_t)i * stride, node);
}

/* Adds lanes to their nodes, one after the other: the same node may appear in several lanes. */
LAR_INLINE void lar_ilane_scatter_add(int64_t *nodes, size_t stride, const int32_t *node,
                                      const lar_ilane add[3]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < LAR_LANES; k++)
#if LAR_SIMD == LAR_SIMD_C
            nodes[(size_t)i * stride + (size_t)node[k]] += add[i];
#else
            nodes[(size_t)i * stride + (size_t)node[k]] += add[i][k];
#endif
}

/* A row of eight elements, or two of four (`half`), whose nodes are consecutive: nine from left[0],
 * or five from left[0] and five from left[4]. Its left nodes are one load, the right ones the same
 * one node further. */
LAR_INLINE void lar_lane_gather_row(const double *nodes, size_t stride, const int32_t *node,
                                    bool half, lar_lane out[3]) {
    for (int i = 0; i < 3; i++) {
        const double *axis = nodes + (size_t)i * stride;
#if LAR_SIMD == LAR_SIMD_AVX512
        out[i] = half ? lar_axis_fours(axis, node) : lar_lane_load_row(axis + node[0]);
#else
        (void)half;
        out[i] = lar_lane_load_row(axis + node[0]);
#endif
    }
}

/* The forces along so many axes. Neighbours' forces are added before they are stored. The last
 * node's right force is added on its own: a masked store there costs as much as all the rest. */
LAR_INLINE void lar_ilane_scatter_row(int64_t *nodes, size_t stride, const int32_t *left_node,
                                      const int32_t *right_node, bool half, int axes,
                                      const lar_ilane *left, const lar_ilane *right) {
    /* Read once: what is stored between the axes might be places, for all that a compiler knows. */
    const bool halves = half && LAR_LANES == 8; /* narrower lanes take a row of four as it is */
    const int64_t a = left_node[0], b = halves ? left_node[4] : right_node[0];
    for (int i = 0; i < axes; i++) {
        int64_t *axis = nodes + (size_t)i * stride;
        lar_axis_add_row(axis + a, axis + b, halves, left[i], right[i]);
    }
}

/* A value that stays in a register once it is loaded. Compilers like to fold a load into every
 * instruction that uses it; with two loads a cycle, three uses of 30 numbers are what a kernel
 * waits for. */
LAR_INLINE lar_lane lar_lane_keep(lar_lane a) {
#if LAR_SIMD == LAR_SIMD_AVX512
    __asm__("" : "+v"(a));
#elif LAR_SIMD == LAR_SIMD_AVX2
    __asm__("" : "+x"(a));
#endif
    return a;
}
LAR_INLINE lar_lane lar_lane_load_once(const double *p) {
    return lar_lane_keep(lar_lane_load(p));
}

#endif
