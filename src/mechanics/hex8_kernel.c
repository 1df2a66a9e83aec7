/* The hex8 kernels of one instruction set: compiled once per LAR_SIMD (src/CMakeLists.txt).
 *
 * The formulas are those of hex8.h, in the same order as hex8.c, a lane per element. The order of
 * the statements follows the life of the values: 21 modal displacements and 9 gradients fill the
 * 32 registers of AVX-512, the hourglass forces wait in the stack's cache line until the stress is
 * known. Compilers keep this order, so mind it.
 */
#include "mechanics/hex8_block.h"

#define UNROLL3 _Pragma("GCC unroll 3")
#define UNROLL4 _Pragma("GCC unroll 4")
#define UNROLL6 _Pragma("GCC unroll 6")

typedef struct lane_modes {
    lar_lane m[7][3]; /* xi, eta, zeta, eta zeta, xi zeta, xi eta, xi eta zeta */
} lane_modes;

/* Sums and differences along xi and eta of the four nodes with one sign of zeta:
 * index 0: ++, 1: +-, 2: -+, 3: -- (xi first). */
LAR_INLINE void gather_layer(const double *u, const int32_t (*node)[LAR_BLOCK], int lane,
                             lar_lane layer[4][3]) {
    lar_lane s0[3], d0[3];
    UNROLL3 for (int half = 0; half < 2; half++) {
        lar_lane left[3], right[3];
        const int32_t *a = node[half ? 3 : 0] + lane, *b = node[half ? 2 : 1] + lane;
        lar_lane_gather(u, a, &left[0], &left[1], &left[2]);
        lar_lane_gather(u, b, &right[0], &right[1], &right[2]);
        UNROLL3 for (int i = 0; i < 3; i++) {
            lar_lane s = right[i] + left[i], d = right[i] - left[i];
            if (half == 0) {
                s0[i] = s;
                d0[i] = d;
            } else {
                layer[0][i] = s + s0[i];
                layer[1][i] = s - s0[i];
                layer[2][i] = d + d0[i];
                layer[3][i] = d - d0[i];
            }
        }
    }
}

LAR_INLINE lane_modes gather_modes(const double *u, const lar_hex8_block *block, int lane) {
    lar_lane lower[4][3], upper[4][3];
    lane_modes U;
    gather_layer(u, block->node, lane, lower);
    gather_layer(u, block->node + 4, lane, upper);
    UNROLL3 for (int i = 0; i < 3; i++) {
        U.m[0][i] = upper[2][i] + lower[2][i];
        U.m[1][i] = upper[1][i] + lower[1][i];
        U.m[2][i] = upper[0][i] - lower[0][i];
        U.m[3][i] = upper[1][i] - lower[1][i];
        U.m[4][i] = upper[2][i] - lower[2][i];
        U.m[5][i] = upper[3][i] + lower[3][i];
        U.m[6][i] = upper[3][i] - lower[3][i];
    }
    return U;
}

/* The four nodes of one layer from the sums over zeta: along eta, then along xi. */
LAR_INLINE void scatter_layer(int64_t *force, const int32_t (*node)[LAR_BLOCK], int lane,
                              const lar_ilane eta[3], const lar_ilane zeta[3],
                              const lar_ilane xi[3], const lar_ilane xieta[3]) {
    UNROLL3 for (int half = 0; half < 2; half++) {
        lar_ilane left[3], right[3];
        UNROLL3 for (int i = 0; i < 3; i++) {
            lar_ilane s = half ? zeta[i] + eta[i] : zeta[i] - eta[i];
            lar_ilane d = half ? xi[i] + xieta[i] : xi[i] - xieta[i];
            left[i] = s - d;
            right[i] = s + d;
        }
        lar_ilane_scatter_add(force, node[half ? 3 : 0] + lane, left[0], left[1], left[2]);
        lar_ilane_scatter_add(force, node[half ? 2 : 1] + lane, right[0], right[1], right[2]);
    }
}

LAR_INLINE void scatter_modes(int64_t *force, const lar_hex8_block *block, int lane,
                              lar_ilane n[7][3]) {
    lar_ilane eta[3], zeta[3], xi[3], xieta[3];
    UNROLL3 for (int i = 0; i < 3; i++) {
        zeta[i] = -n[2][i];
        eta[i] = n[1][i] - n[3][i];
        xi[i] = n[0][i] - n[4][i];
        xieta[i] = n[5][i] - n[6][i];
    }
    scatter_layer(force, block->node, lane, eta, zeta, xi, xieta);
    UNROLL3 for (int i = 0; i < 3; i++) {
        eta[i] = n[1][i] + n[3][i];
        xi[i] = n[0][i] + n[4][i];
        xieta[i] = n[5][i] + n[6][i];
    }
    scatter_layer(force, block->node + 4, lane, eta, n[2], xi, xieta);
}

typedef lar_lane (*lane_law)(const lar_lane F[9], lar_lane P[9], lar_lane J, lar_lane I1,
                             const lar_lane p[3]);

/* Recovers the lanes [lane, lane + LAR_LANES) of a block; returns the lanes beyond the limits. */
LAR_INLINE unsigned recover_lanes(const lar_hex8_block *block, int lane, const double *u,
                                  int64_t *force, const lar_hex8_limits *limits, lane_law law,
                                  bool watch) {
    lane_modes U = gather_modes(u, block, lane);

    lar_lane F[9]; /* H at first */
    UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane B = lar_lane_load(&block->gradient[0][j][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) F[3 * i + j] = U.m[0][i] * B;
    }
    UNROLL6 for (int m = 1; m < LAR_HEX8_GRADIENTS; m++) UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane B = lar_lane_load(&block->gradient[m][j][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) F[3 * i + j] = lar_lane_fma(U.m[m][i], B, F[3 * i + j]);
    }

    lar_lane cq[LAR_HEX8_HOURGLASS][3]; /* hourglass forces c_m q_m */
    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        UNROLL3 for (int i = 0; i < 3; i++) cq[m][i] = U.m[3 + m][i];
        UNROLL3 for (int j = 0; j < 3; j++) {
            lar_lane X = lar_lane_load(&block->shape[m][j][lane]);
            UNROLL3 for (int i = 0; i < 3; i++) cq[m][i] = lar_lane_fnma(F[3 * i + j], X, cq[m][i]);
        }
        lar_lane c = lar_lane_load(&block->stiffness[m][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) cq[m][i] *= c;
    }
    UNROLL3 for (int i = 0; i < 3; i++) F[4 * i] += lar_lane_set(1);

    lar_lane S[9], p[LAR_LAW_PARAMETERS];
    UNROLL3 for (int k = 0; k < LAR_LAW_PARAMETERS; k++) p[k] =
        lar_lane_load(&block->modulus[k][lane]);
    lar_lane J = lar_lane_cofactor(F, S);
    lar_lane stress = law(F, S, J, lar_lane_square_sum(F), p);
    unsigned beyond = lar_lane_not_greater(J, lar_lane_set(limits->least_volume)) |
                      lar_lane_not_greater(lar_lane_set(limits->stress_square), stress);
    if (watch) {
        lar_lane sum = lar_lane_set(0);
        UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) UNROLL3 for (int i = 0; i < 3; i++)
            sum = lar_lane_fma(cq[m][i], cq[m][i], sum);
        beyond |= lar_lane_not_greater(lar_lane_set(limits->hourglass_square), sum);
    }

    UNROLL4 for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) UNROLL3 for (int j = 0; j < 3; j++) {
        lar_lane X = lar_lane_load(&block->shape[m][j][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) S[3 * i + j] = lar_lane_fnma(cq[m][i], X, S[3 * i + j]);
    }

    lar_ilane n[7][3];
    UNROLL6 for (int m = 0; m < LAR_HEX8_GRADIENTS; m++) {
        lar_lane B[3];
        UNROLL3 for (int j = 0; j < 3; j++) B[j] = lar_lane_load(&block->gradient[m][j][lane]);
        UNROLL3 for (int i = 0; i < 3; i++) {
            lar_lane G = m < 3 ? S[3 * i] * B[0] : lar_lane_fma(S[3 * i], B[0], cq[m - 3][i]);
            G = lar_lane_fma(S[3 * i + 1], B[1], G);
            n[m][i] = lar_lane_round(lar_lane_fma(S[3 * i + 2], B[2], G));
        }
    }
    UNROLL3 for (int i = 0; i < 3; i++) n[6][i] = lar_lane_round(cq[3][i]);
    scatter_modes(force, block, lane, n);
    return beyond;
}

LAR_INLINE int64_t recover_blocks(const lar_hex8_block *blocks, int32_t count, const double *u,
                                  int64_t *force, const lar_hex8_limits *limits, lane_law law,
                                  bool watch) {
    int64_t first = -1;
    for (int32_t b = 0; b < count; b++)
        for (int lane = 0; lane < LAR_BLOCK; lane += LAR_LANES) {
            unsigned beyond = recover_lanes(&blocks[b], lane, u, force, limits, law, watch);
            if (__builtin_expect(beyond != 0 && first < 0, 0))
                first = (int64_t)b * LAR_BLOCK + lane + __builtin_ctz(beyond);
        }
    return first;
}

#define LAR_DEFINE_LAW(identifier, name)                                                           \
    static int64_t recover_##identifier(const lar_hex8_block *blocks, int32_t count,               \
                                        const double *u, int64_t *force,                           \
                                        const lar_hex8_limits *limits) {                           \
        return recover_blocks(blocks, count, u, force, limits, lar_##identifier##_stress, false);  \
    }                                                                                              \
    static int64_t watch_##identifier(const lar_hex8_block *blocks, int32_t count,                 \
                                      const double *u, int64_t *force,                             \
                                      const lar_hex8_limits *limits) {                             \
        return recover_blocks(blocks, count, u, force, limits, lar_##identifier##_stress, true);   \
    }
LAR_LAWS(LAR_DEFINE_LAW)
#undef LAR_DEFINE_LAW

/* Nodes are runs of four values (the last always 0), so every value is treated alike. */
LAR_INLINE bool update_values(const lar_motion *motion, int64_t first, int64_t end, double *u,
                              double *v, int64_t *force, const double *push, const double *mass,
                              double *damped) {
    const lar_lane keep = lar_lane_set(motion->keep), dt = lar_lane_set(motion->dt);
    const lar_lane speed = lar_lane_set(motion->speed);
    lar_lane sum = lar_lane_set(0);
    unsigned beyond = 0;
    for (int64_t k = 4 * first; k < 4 * end; k += LAR_LANES) {
        lar_lane f = lar_ilane_to_lane(lar_ilane_load(force + k));
        lar_lane before = lar_lane_load(v + k);
        lar_lane after = lar_lane_fma(keep, before, lar_lane_repeat4(motion->drift, k));
        after = lar_lane_fnma(f, lar_lane_per_node(push, k), after);
        lar_lane_store(v + k, after);
        lar_lane_store(u + k, lar_lane_fma(dt, after, lar_lane_load(u + k)));
        lar_ilane_store(force + k, (lar_ilane){0});
        beyond |= lar_lane_not_greater(speed, lar_lane_abs(after));
        if (mass) {
            lar_lane twice = before + after;
            sum = lar_lane_fma(lar_lane_per_node(mass, k) * twice, twice, sum);
        }
    }
    if (mass) {
        double values[LAR_LANES] __attribute__((aligned(64)));
        lar_lane_store(values, sum);
        for (int i = 0; i < LAR_LANES; i++) *damped += values[i];
    }
    return beyond == 0;
}

static bool update(const lar_motion *motion, int32_t first, int32_t end, double *u, double *v,
                   int64_t *force, const double *push, const double *mass, double *damped) {
    if (mass) return update_values(motion, first, end, u, v, force, push, mass, damped);
    return update_values(motion, first, end, u, v, force, push, NULL, NULL);
}

#if LAR_SIMD == LAR_SIMD_AVX512
#define LAR_KERNELS_NAME   lar_kernels_avx512
#define LAR_KERNELS_TEXT   "avx512"
#define LAR_KERNELS_ISA    LAR_ISA_AVX512
#define LAR_KERNELS_USABLE __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")
#elif LAR_SIMD == LAR_SIMD_AVX2
#define LAR_KERNELS_NAME   lar_kernels_avx2
#define LAR_KERNELS_TEXT   "avx2"
#define LAR_KERNELS_ISA    LAR_ISA_AVX2
#define LAR_KERNELS_USABLE __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
#elif LAR_SIMD == LAR_SIMD_NEON
#define LAR_KERNELS_NAME   lar_kernels_neon
#define LAR_KERNELS_TEXT   "neon"
#define LAR_KERNELS_ISA    LAR_ISA_NEON
#define LAR_KERNELS_USABLE true
#else
#define LAR_KERNELS_NAME   lar_kernels_c
#define LAR_KERNELS_TEXT   "c"
#define LAR_KERNELS_ISA    LAR_ISA_C
#define LAR_KERNELS_USABLE true
#endif

static bool available(void) {
    return LAR_KERNELS_USABLE;
}

extern const lar_kernels LAR_KERNELS_NAME;
const lar_kernels LAR_KERNELS_NAME = {
    .isa = LAR_KERNELS_ISA,
    .name = LAR_KERNELS_TEXT,
    .available = available,
#define LAR_ROW(identifier, name) [LAR_LAW_##identifier] = recover_##identifier,
    .recover = {LAR_LAWS(LAR_ROW)},
#undef LAR_ROW
#define LAR_ROW(identifier, name) [LAR_LAW_##identifier] = watch_##identifier,
    .watch = {LAR_LAWS(LAR_ROW)},
#undef LAR_ROW
    .update = update,
};
