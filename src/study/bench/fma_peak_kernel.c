/* One instruction set's loop of fma_peak.h; compiled once per LAR_SIMD (src/CMakeLists.txt). */
#include "base/simd.h"
#include "study/bench/fma_peak.h"

#if LAR_SIMD == LAR_SIMD_AVX512
#define LOOP lar_fma_peak_avx512
#define NAME "avx512"
enum { ACCUMULATORS = 20 };
#elif LAR_SIMD == LAR_SIMD_AVX2
#define LOOP lar_fma_peak_avx2
#define NAME "avx2"
enum { ACCUMULATORS = 12 };
#elif LAR_SIMD == LAR_SIMD_NEON
#define LOOP lar_fma_peak_neon
#define NAME "neon"
enum { ACCUMULATORS = 20 };
#elif defined(LAR_SIMD_C_FMA)
#define LOOP lar_fma_peak_c_fma
#define NAME "c"
enum { ACCUMULATORS = 12 };
#else
#define LOOP lar_fma_peak_c
#define NAME "c"
enum { ACCUMULATORS = 12 };
#endif

enum { REPEAT = 4 };

/* Plain C on a processor family without the instruction: fma() is then a function call, and the
 * peak is that of a multiplication and an addition. */
LAR_INLINE lar_lane multiply_add(lar_lane a, lar_lane b, lar_lane c) {
#if LAR_SIMD == LAR_SIMD_C && !defined(__FP_FAST_FMA)
    return a * b + c;
#else
    return lar_lane_fma(a, b, c);
#endif
}

static double run(uint64_t rounds) {
    /* x' = 0.5 x + 0.5 stays between 0 and 1: no denormal numbers, no infinities. The values start
     * apart, so that the compiler cannot take two accumulators for one. */
    const lar_lane half = lar_lane_set(0.5);
    lar_lane x[ACCUMULATORS];
#pragma GCC unroll 32
    for (int i = 0; i < ACCUMULATORS; i++) x[i] = lar_lane_set(1.0 / (i + 2));
    for (uint64_t round = 0; round < rounds; round++) {
#pragma GCC unroll 4
        for (int repeat = 0; repeat < REPEAT; repeat++) {
#pragma GCC unroll 32
            for (int i = 0; i < ACCUMULATORS; i++) x[i] = multiply_add(x[i], half, half);
        }
    }
    lar_lane sum = x[0];
#pragma GCC unroll 32
    for (int i = 1; i < ACCUMULATORS; i++) sum = sum + x[i];
    double lane[LAR_LANES] __attribute__((aligned(64))), total = 0;
    lar_lane_store(lane, sum);
    for (int i = 0; i < LAR_LANES; i++) total += lane[i];
    return total;
}

extern const lar_fma_peak LOOP;
const lar_fma_peak LOOP = {NAME, 2 * REPEAT *ACCUMULATORS *LAR_LANES, run};
