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
 * Nodes are stored as four values (x, y, z, 0) so that one aligned load brings a whole node;
 * lar_lane_gather and lar_ilane_scatter_add turn nodes into lanes and back in registers. Intrinsics
 * appear in this file and nowhere else.
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

/* Element p of a row stands in lane LAR_ROW_LANES[p] (its own inverse); see lar_lane_gather_row. */
static const int8_t LAR_ROW_LANES[8] __attribute__((unused)) = {0, 2, 1, 3, 4, 6, 5, 7};

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
/* Beside values k, k + 1, ... of an array of nodes (four values each): a number per node, or the
 * same four values for every node. k is a multiple of LAR_LANES. */
LAR_INLINE lar_lane lar_lane_per_node(const double *p, int64_t k) {
    const __m512i twice = _mm512_setr_epi64(0, 0, 0, 0, 1, 1, 1, 1);
    return (lar_lane)_mm512_permutexvar_pd(twice, _mm512_castpd128_pd512(_mm_loadu_pd(p + k / 4)));
}
LAR_INLINE lar_lane lar_lane_repeat4(const double p[4], int64_t k) {
    (void)k;
    return (lar_lane)_mm512_broadcast_f64x4(_mm256_loadu_pd(p));
}

/* One local node of eight elements: offset[lane] counts doubles from `nodes` (4 per node). */
LAR_INLINE void lar_lane_gather(const double *nodes, const int32_t *offset, lar_lane out[3]) {
#define LAR_PAIR(i, j)                                                                             \
    _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(nodes + offset[i])),                  \
                       _mm256_load_pd(nodes + offset[j]), 1)
    __m512d n02 = LAR_PAIR(0, 2), n13 = LAR_PAIR(1, 3), n46 = LAR_PAIR(4, 6), n57 = LAR_PAIR(5, 7);
#undef LAR_PAIR
    __m512d xz0 = _mm512_unpacklo_pd(n02, n13), yw0 = _mm512_unpackhi_pd(n02, n13);
    __m512d xz4 = _mm512_unpacklo_pd(n46, n57), yw4 = _mm512_unpackhi_pd(n46, n57);
    out[0] = (lar_lane)_mm512_shuffle_f64x2(xz0, xz4, 0x88);
    out[2] = (lar_lane)_mm512_shuffle_f64x2(xz0, xz4, 0xdd);
    out[1] = (lar_lane)_mm512_shuffle_f64x2(yw0, yw4, 0x88);
}

/* Two nodes' (x, y, z, 0) picked out of xy and z, added one after the other. */
LAR_INLINE void lar_node_add(int64_t *nodes, int32_t first, int32_t second, __m512i xy,
                             __m512i pick, __m512i z) {
    __m512i pair = _mm512_maskz_permutex2var_epi64(0x77, xy, pick, z);
    __m256i *node = (__m256i *)(nodes + first);
    _mm256_store_si256(node,
                       _mm256_add_epi64(_mm256_load_si256(node), _mm512_castsi512_si256(pair)));
    node = (__m256i *)(nodes + second);
    _mm256_store_si256(
        node, _mm256_add_epi64(_mm256_load_si256(node), _mm512_extracti64x4_epi64(pair, 1)));
}

/* Adds lanes to eight nodes, one after the other: the same node may appear in several lanes. */
LAR_INLINE void lar_ilane_scatter_add(int64_t *nodes, const int32_t *offset,
                                      const lar_ilane add[3]) {
    __m512i x = (__m512i)add[0], y = (__m512i)add[1], z = (__m512i)add[2];
    __m512i xy_even = _mm512_unpacklo_epi64(x, y), xy_odd = _mm512_unpackhi_epi64(x, y);
    const __m512i pick02 = _mm512_setr_epi64(0, 1, 8, 0, 2, 3, 10, 0);
    const __m512i pick46 = _mm512_setr_epi64(4, 5, 12, 0, 6, 7, 14, 0);
    const __m512i pick13 = _mm512_setr_epi64(0, 1, 9, 0, 2, 3, 11, 0);
    const __m512i pick57 = _mm512_setr_epi64(4, 5, 13, 0, 6, 7, 15, 0);
    lar_node_add(nodes, offset[0], offset[2], xy_even, pick02, z);
    lar_node_add(nodes, offset[4], offset[6], xy_even, pick46, z);
    lar_node_add(nodes, offset[1], offset[3], xy_odd, pick13, z);
    lar_node_add(nodes, offset[5], offset[7], xy_odd, pick57, z);
}

/* A row of eight elements, or two of four (`half`), whose left and right nodes are consecutive in
 * memory: nine nodes from left[0], or five from left[0] and five from left[4]. Element p of a row
 * of eight is in lane p, but 1 and 2 and 5 and 6 change places (LAR_ROW_LANES): then pairs of
 * nodes are loaded and stored whole. */
LAR_INLINE void lar_lane_gather_row(const double *nodes, const int32_t *left_offset,
                                    const int32_t *right_offset, bool half, lar_lane left[3],
                                    lar_lane right[3]) {
    (void)right_offset;
    const double *a = nodes + left_offset[0], *b = half ? nodes + left_offset[4] : a + 16;
    __m512d n01 = _mm512_loadu_pd(a), n23 = _mm512_loadu_pd(a + 8);
    __m512d n45 = _mm512_loadu_pd(b), n67 = _mm512_loadu_pd(b + 8);
    __m512d ends = _mm512_castpd256_pd512(_mm256_load_pd(half ? a + 16 : b + 16));
    if (half) ends = _mm512_insertf64x4(ends, _mm256_load_pd(b + 16), 1);
    __m512d xz0 = _mm512_unpacklo_pd(n01, n23), yw0 = _mm512_unpackhi_pd(n01, n23);
    __m512d xz4 = _mm512_unpacklo_pd(n45, n67), yw4 = _mm512_unpackhi_pd(n45, n67);
    left[0] = (lar_lane)_mm512_shuffle_f64x2(xz0, xz4, 0x88);
    left[1] = (lar_lane)_mm512_shuffle_f64x2(yw0, yw4, 0x88);
    left[2] = (lar_lane)_mm512_shuffle_f64x2(xz0, xz4, 0xdd);
    for (int i = 0; i < 3; i++) {
        const __m512i next = half ? _mm512_setr_epi64(2, 3, 1, 8 + i, 6, 7, 5, 12 + i)
                                  : _mm512_setr_epi64(2, 3, 1, 4, 6, 7, 5, 8 + i);
        right[i] = (lar_lane)_mm512_permutex2var_pd((__m512d)left[i], next, ends);
    }
}

/* Adds z-completed pairs of nodes, (x, y, z, 0) twice, picked out of xy and z. */
LAR_INLINE void lar_pair_add(int64_t *nodes, __m512i xy, __m512i pick, __m512i z) {
    __m512i pair = _mm512_maskz_permutex2var_epi64(0x77, xy, pick, z);
    _mm512_storeu_si512(nodes, _mm512_add_epi64(_mm512_loadu_si512(nodes), pair));
}

LAR_INLINE void lar_ilane_scatter_row(int64_t *nodes, const int32_t *left_offset,
                                      const int32_t *right_offset, bool half,
                                      const lar_ilane left[3], const lar_ilane right[3]) {
    (void)right_offset;
    const __m512i before = half ? _mm512_setr_epi64(0, 2, 0, 1, 0, 6, 4, 5)
                                : _mm512_setr_epi64(0, 2, 0, 1, 3, 6, 4, 5);
    __m512i sum[3];
    for (int i = 0; i < 3; i++)
        sum[i] = _mm512_add_epi64(
            (__m512i)left[i],
            _mm512_maskz_permutexvar_epi64(half ? 0xee : 0xfe, before, (__m512i)right[i]));
    __m512i xy_even = _mm512_unpacklo_epi64(sum[0], sum[1]);
    __m512i xy_odd = _mm512_unpackhi_epi64(sum[0], sum[1]);
    int64_t *a = nodes + left_offset[0], *b = half ? nodes + left_offset[4] : a + 16;
    lar_pair_add(a, xy_even, _mm512_setr_epi64(0, 1, 8, 0, 2, 3, 10, 0), sum[2]);
    lar_pair_add(a + 8, xy_odd, _mm512_setr_epi64(0, 1, 9, 0, 2, 3, 11, 0), sum[2]);
    lar_pair_add(b, xy_even, _mm512_setr_epi64(4, 5, 12, 0, 6, 7, 14, 0), sum[2]);
    lar_pair_add(b + 8, xy_odd, _mm512_setr_epi64(4, 5, 13, 0, 6, 7, 15, 0), sum[2]);
    __m512i end_xy = _mm512_unpackhi_epi64((__m512i)right[0], (__m512i)right[1]);
    const __m512i pick37 = _mm512_setr_epi64(2, 3, 11, 0, 6, 7, 15, 0);
    const __m512i pick7 = _mm512_setr_epi64(6, 7, 15, 0, 0, 0, 0, 0);
    __m512i ends = _mm512_maskz_permutex2var_epi64(half ? 0x77 : 0x07, end_xy,
                                                   half ? pick37 : pick7, (__m512i)right[2]);
    __m256i *end = (__m256i *)(half ? a + 16 : b + 16);
    _mm256_store_si256(end, _mm256_add_epi64(_mm256_load_si256(end), _mm512_castsi512_si256(ends)));
    if (half) {
        end = (__m256i *)(b + 16);
        _mm256_store_si256(
            end, _mm256_add_epi64(_mm256_load_si256(end), _mm512_extracti64x4_epi64(ends, 1)));
    }
}

#elif LAR_SIMD == LAR_SIMD_AVX2

#include <immintrin.h>
typedef double lar_lane __attribute__((vector_size(32)));
typedef int64_t lar_ilane __attribute__((vector_size(32)));

LAR_INLINE lar_lane lar_lane_load(const double *p) {
    return (lar_lane)_mm256_load_pd(p);
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

/* Nearest integer of |a| < 2^62 in two halves. Adding 1.5 * 2^84 leaves the nearest multiple of 2^32
 * as an integer in the low bits of `high`; the rest is exact and at most 2^31 in size, and adding
 * 1.5 * 2^52 does the same for it. What then stands above the rest, the bits of 1.5 * 2^52, is
 * taken away by as much less in the low bits of `high`. */
LAR_INLINE lar_ilane lar_lane_round(lar_lane a) {
    const lar_lane magic = lar_lane_set(0x1.8p52);
    const lar_lane above = lar_lane_set(0x1.80000bcc8p84); /* 1.5 * 2^84 - 0x43380000 * 2^32 */
    lar_lane high = a + above;
    lar_lane rest = (a - (high - above)) + magic;
    return ((lar_ilane)high << 32) + (lar_ilane)rest;
}
/* Correctly rounded: both halves are exact doubles and one fused operation joins them. */
LAR_INLINE lar_lane lar_ilane_to_lane(lar_ilane a) {
    const lar_lane magic = lar_lane_set(0x1.8p52);
    lar_ilane low = a & 0xffffffffLL;
    __m256i shifted = _mm256_srli_epi64((__m256i)a, 32);
    /* sign-extend the high half by adding and taking away 2^31 in the unsigned range */
    __m256i high = _mm256_xor_si256(shifted, _mm256_set1_epi64x(0x80000000LL));
    lar_lane high_d = (lar_lane)((lar_ilane)high + (lar_ilane)magic) - lar_lane_set(0x1.8p52) -
                      lar_lane_set(0x1p31);
    lar_lane low_d = (lar_lane)(low + (lar_ilane)magic) - magic;
    return lar_lane_fma(high_d, lar_lane_set(0x1p32), low_d);
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
LAR_INLINE lar_lane lar_lane_per_node(const double *p, int64_t k) {
    return (lar_lane)_mm256_set1_pd(p[k / 4]);
}
LAR_INLINE lar_lane lar_lane_repeat4(const double p[4], int64_t k) {
    (void)k;
    return (lar_lane)_mm256_loadu_pd(p);
}

LAR_INLINE void lar_lane_gather(const double *nodes, const int32_t *offset, lar_lane out[3]) {
    __m256d n0 = _mm256_load_pd(nodes + offset[0]), n1 = _mm256_load_pd(nodes + offset[1]);
    __m256d n2 = _mm256_load_pd(nodes + offset[2]), n3 = _mm256_load_pd(nodes + offset[3]);
    __m256d xz0 = _mm256_unpacklo_pd(n0, n1), yw0 = _mm256_unpackhi_pd(n0, n1);
    __m256d xz2 = _mm256_unpacklo_pd(n2, n3), yw2 = _mm256_unpackhi_pd(n2, n3);
    out[0] = (lar_lane)_mm256_permute2f128_pd(xz0, xz2, 0x20);
    out[2] = (lar_lane)_mm256_permute2f128_pd(xz0, xz2, 0x31);
    out[1] = (lar_lane)_mm256_permute2f128_pd(yw0, yw2, 0x20);
}

LAR_INLINE void lar_ilane_scatter_add(int64_t *nodes, const int32_t *offset,
                                      const lar_ilane add[3]) {
    __m256i x = (__m256i)add[0], y = (__m256i)add[1], z = (__m256i)add[2];
    __m256i none = _mm256_setzero_si256();
    __m256i xy_even = _mm256_unpacklo_epi64(x, y), xy_odd = _mm256_unpackhi_epi64(x, y);
    __m256i z_even = _mm256_unpacklo_epi64(z, none), z_odd = _mm256_unpackhi_epi64(z, none);
    __m256i value[4] = {_mm256_permute2x128_si256(xy_even, z_even, 0x20),
                        _mm256_permute2x128_si256(xy_odd, z_odd, 0x20),
                        _mm256_permute2x128_si256(xy_even, z_even, 0x31),
                        _mm256_permute2x128_si256(xy_odd, z_odd, 0x31)};
    for (int i = 0; i < 4; i++) {
        __m256i *node = (__m256i *)(nodes + offset[i]);
        _mm256_store_si256(node, _mm256_add_epi64(_mm256_load_si256(node), value[i]));
    }
}

#elif LAR_SIMD == LAR_SIMD_NEON

#include <arm_neon.h>
typedef double lar_lane __attribute__((vector_size(16)));
typedef int64_t lar_ilane __attribute__((vector_size(16)));

LAR_INLINE lar_lane lar_lane_load(const double *p) {
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
LAR_INLINE lar_lane lar_lane_per_node(const double *p, int64_t k) {
    return (lar_lane)vdupq_n_f64(p[k / 4]);
}
LAR_INLINE lar_lane lar_lane_repeat4(const double p[4], int64_t k) {
    return (lar_lane)vld1q_f64(p + k % 4);
}

LAR_INLINE void lar_lane_gather(const double *nodes, const int32_t *offset, lar_lane out[3]) {
    float64x2_t a = vld1q_f64(nodes + offset[0]), b = vld1q_f64(nodes + offset[1]);
    out[0] = (lar_lane)vzip1q_f64(a, b);
    out[1] = (lar_lane)vzip2q_f64(a, b);
    out[2] =
        (lar_lane)vzip1q_f64(vld1q_f64(nodes + offset[0] + 2), vld1q_f64(nodes + offset[1] + 2));
}

LAR_INLINE void lar_ilane_scatter_add(int64_t *nodes, const int32_t *offset,
                                      const lar_ilane add[3]) {
    int64x2_t xx = (int64x2_t)add[0], yy = (int64x2_t)add[1], zz = (int64x2_t)add[2];
    int64x2_t none = vdupq_n_s64(0);
    int64_t *n = nodes + offset[0];
    vst1q_s64(n, vaddq_s64(vld1q_s64(n), vzip1q_s64(xx, yy)));
    vst1q_s64(n + 2, vaddq_s64(vld1q_s64(n + 2), vzip1q_s64(zz, none)));
    n = nodes + offset[1];
    vst1q_s64(n, vaddq_s64(vld1q_s64(n), vzip2q_s64(xx, yy)));
    vst1q_s64(n + 2, vaddq_s64(vld1q_s64(n + 2), vzip2q_s64(zz, none)));
}

#else /* LAR_SIMD_C */

typedef double lar_lane;
typedef int64_t lar_ilane;

LAR_INLINE lar_lane lar_lane_load(const double *p) {
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
LAR_INLINE lar_lane lar_lane_per_node(const double *p, int64_t k) {
    return p[k / 4];
}
LAR_INLINE lar_lane lar_lane_repeat4(const double p[4], int64_t k) {
    return p[k % 4];
}

LAR_INLINE void lar_lane_gather(const double *nodes, const int32_t *offset, lar_lane out[3]) {
    const double *n = nodes + offset[0];
    out[0] = n[0];
    out[1] = n[1];
    out[2] = n[2];
}

LAR_INLINE void lar_ilane_scatter_add(int64_t *nodes, const int32_t *offset,
                                      const lar_ilane add[3]) {
    int64_t *n = nodes + offset[0];
    for (int i = 0; i < 3; i++) n[i] += add[i];
}

#endif

#if LAR_SIMD != LAR_SIMD_AVX512
/* Rows (see above) bring narrower sets too little to be worth shuffles. */
LAR_INLINE void lar_lane_gather_row(const double *nodes, const int32_t *left_offset,
                                    const int32_t *right_offset, bool half, lar_lane left[3],
                                    lar_lane right[3]) {
    (void)half;
    lar_lane_gather(nodes, left_offset, left);
    lar_lane_gather(nodes, right_offset, right);
}

LAR_INLINE void lar_ilane_scatter_row(int64_t *nodes, const int32_t *left_offset,
                                      const int32_t *right_offset, bool half,
                                      const lar_ilane left[3], const lar_ilane right[3]) {
    (void)half;
    lar_ilane_scatter_add(nodes, left_offset, left);
    lar_ilane_scatter_add(nodes, right_offset, right);
}
#endif

/* A load whose value stays in a register. Compilers like to fold a load into every instruction
 * that uses it; with two loads a cycle, three uses of 30 numbers are what a kernel waits for. */
LAR_INLINE lar_lane lar_lane_load_once(const double *p) {
    lar_lane a = lar_lane_load(p);
#if LAR_SIMD == LAR_SIMD_AVX512
    __asm__("" : "+v"(a));
#elif LAR_SIMD == LAR_SIMD_AVX2
    __asm__("" : "+x"(a));
#endif
    return a;
}

#endif
