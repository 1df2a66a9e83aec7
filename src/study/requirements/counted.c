/* How numbers can count in C, where operators cannot be redefined: every `double` of the included
 * sources becomes a type of 128 bits, for which the compiler calls a function per operation,
 * __addtf3 and its kin. This file has such functions of its own. They compute in double, so every
 * number is a double all the time, and count.
 *
 * Compiled without optimisation (src/CMakeLists.txt), so that the operations are those that the
 * source writes. A kernel that takes up another function of base/simd.h which loads, stores, looks
 * at bits or computes with integers needs a counting twin of it below; the test says when.
 */
#include "study/requirements/counted.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"

#if LDBL_MANT_DIG == 113
typedef long double counted;
#else
typedef __float128 counted;
#endif
typedef double plain;

static _Thread_local lar_operations tally;
/* Between the rounding of an element's forces and the next element additions are of integers. */
static _Thread_local bool integers;

/* The compiler's names for them. gcc makes them global, so nothing else in this library may compute
 * with 128 bits (x86) or in long double (where that has 128 bits); programs and other libraries do
 * not see them. */
#define OPERATION(name, function)                                                                  \
    __attribute__((used, noinline)) static counted function(counted a, counted b);                 \
    __asm__(".set " #name ", " #function "\n.hidden " #name);                                      \
    static counted function(counted a, counted b)

OPERATION(__addtf3, added) {
    if (integers) {
        tally.integer_additions++;
        return (counted)(int64_t)((uint64_t)(int64_t)a + (uint64_t)(int64_t)b);
    }
    tally.additions++;
    return (counted)((plain)a + (plain)b);
}
OPERATION(__subtf3, subtracted) {
    if (integers) {
        tally.integer_additions++;
        return (counted)(int64_t)((uint64_t)(int64_t)a - (uint64_t)(int64_t)b);
    }
    tally.additions++;
    return (counted)((plain)a - (plain)b);
}
OPERATION(__multf3, multiplied) {
    tally.multiplications++;
    return (counted)((plain)a * (plain)b);
}
OPERATION(__divtf3, divided) {
    tally.divisions++;
    return (counted)((plain)a / (plain)b);
}

static plain counted_fma(plain a, plain b, plain c) {
    tally.fused++;
    return fma(a, b, c);
}
static plain counted_size(plain a) {
    return fabs(a);
}
static plain counted_root(plain a) {
    tally.roots++;
    return sqrt(a);
}

/* ---- the sources, with `double` that counts ---------------------------------------------- */

#pragma GCC diagnostic ignored "-Wformat"
#pragma GCC diagnostic ignored "-Wunused-function"
#ifdef __clang__
#pragma GCC diagnostic ignored "-Wunused-const-variable"
#pragma GCC diagnostic ignored "-Wkeyword-macro"
#endif

#define double counted
#define fma  counted_fma
#define sqrt counted_root
#define fabs counted_size

/* What looks at the bits of a double must do it to a double. */
#define lar_lane_bits       unused_lane_bits
#define lar_ilane_as_lane   unused_ilane_as_lane
#define lar_ilane_to_lane   unused_ilane_to_lane
#define lar_lane_upper      unused_lane_upper
#define lar_lane_from_upper unused_lane_from_upper
#undef LAR_SIMD
#define LAR_SIMD 1
#include "base/simd.h"
#undef lar_lane_bits
#undef lar_ilane_as_lane
#undef lar_ilane_to_lane
#undef lar_lane_upper
#undef lar_lane_from_upper

LAR_INLINE int64_t lar_lane_bits(lar_lane a) {
    plain value = (plain)a;
    int64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}
LAR_INLINE lar_lane lar_ilane_as_lane(int64_t a) {
    plain value;
    memcpy(&value, &a, sizeof value);
    return value;
}
LAR_INLINE lar_lane lar_ilane_to_lane(int64_t a) {
    return (plain)a;
}
LAR_INLINE lar_lane lar_lane_upper(lar_lane a) {
    return lar_ilane_to_lane(lar_lane_bits(a) >> 32);
}
LAR_INLINE lar_lane lar_lane_from_upper(lar_lane a) {
    return lar_ilane_as_lane(llrint((plain)a) * (INT64_C(1) << 32));
}

/* Other names for what other files define too. */
#define lar_law_name                 counted_law_name
#define lar_law_table                counted_law_table
#define lar_fibre_law_name           counted_fibre_law_name
#define lar_fibre_parameter_name     counted_fibre_parameter_name
#define lar_material_shear           counted_material_shear
#define lar_material_bulk            counted_material_bulk
#define lar_material_instant_shear   counted_material_instant_shear
#define lar_material_instant_bulk    counted_material_instant_bulk
#define lar_material_freeze          counted_material_freeze
#define lar_material_check           counted_material_check
#define lar_material_from_young      counted_material_from_young
#define lar_material_from_shear_bulk counted_material_from_shear_bulk
#define lar_law_stress               counted_law_stress
#define lar_law_energy               counted_law_energy
#define lar_viscous_stress_at        counted_viscous_stress_at
#define lar_relaxing_stress          counted_relaxing_stress
#define lar_material_stress          counted_material_stress
#define lar_material_energy          counted_material_energy
#define lar_active_energy            counted_active_energy
#define lar_cauchy_stress            counted_cauchy_stress
#define lar_von_mises                counted_von_mises
#define lar_mean_pressure            counted_mean_pressure
#define lar_gauss_point              counted_gauss_point
#define lar_hexahedron_jacobian      counted_hexahedron_jacobian
#define lar_hexahedron_gradients     counted_hexahedron_gradients
#define lar_hex8_full_force          counted_hex8_full_force
#define lar_hex8_full_energy         counted_hex8_full_energy
#define lar_hex8_full_stress         counted_hex8_full_stress
#define lar_hex8_full_frequency      counted_hex8_full_frequency
#define lar_hex8_matrix_build        counted_hex8_matrix_build
#define lar_hex8_matrix_force        counted_hex8_matrix_force
#define lar_kernels_c                counted_kernels

#include "law/law.c"
#include "model/material.c"
#include "mechanics/stress.c"
#include "mechanics/hexahedron.c"
#include "mechanics/hex8_full.c"
#define FREEDOMS MATRIX_FREEDOMS
#include "mechanics/hex8_matrix.c"
#undef FREEDOMS

/* For the kernel: loads and stores count, and forces are integers in counting numbers. */
LAR_INLINE lar_lane counted_load(const lar_lane *p) {
    tally.bytes_loaded += (int64_t)sizeof(plain);
    return *p;
}
LAR_INLINE void counted_store(lar_lane *p, lar_lane a) {
    tally.bytes_stored += (int64_t)sizeof(plain);
    *p = a;
}
/* One lane is a row of its own: its nodes are loaded one by one, x first. */
LAR_INLINE lar_lane counted_load_row(const lar_lane *p) {
    integers = false;
    return counted_load(p);
}
LAR_INLINE counted counted_round(lar_lane a) {
    integers = true;
    tally.conversions++;
    return llrint((plain)a);
}
LAR_INLINE void counted_scatter(int64_t *nodes, size_t stride, const int32_t *node,
                                const counted add[3]) {
    tally.bytes_loaded += (int64_t)(sizeof *node + 3 * sizeof *nodes);
    tally.bytes_stored += (int64_t)(3 * sizeof *nodes);
    for (int i = 0; i < 3; i++) {
        int64_t *sum = nodes + (size_t)*node + (size_t)i * stride;
        *sum = (int64_t)((counted)*sum + add[i]);
    }
}
LAR_INLINE void counted_scatter_row(int64_t *nodes, size_t stride, const int32_t *left_node,
                                    const int32_t *right_node, bool half, int axes,
                                    const counted *left, const counted *right) {
    (void)half, (void)axes;
    counted_scatter(nodes, stride, left_node, left);
    counted_scatter(nodes, stride, right_node, right);
}
LAR_INLINE counted counted_load_force(const int64_t *p) {
    tally.bytes_loaded += (int64_t)sizeof *p;
    return *p;
}
LAR_INLINE void counted_store_force(int64_t *p, counted a) {
    tally.bytes_stored += (int64_t)sizeof *p;
    *p = (int64_t)a;
}
LAR_INLINE lar_lane counted_to_lane(counted a) {
    tally.conversions++;
    return (plain)a;
}
#define lar_lane_load         counted_load
#define lar_lane_load_once    counted_load
#define lar_lane_store        counted_store
#define lar_lane_load_row     counted_load_row
#define lar_lane_round        counted_round
#define lar_ilane             counted
#define lar_ilane_scatter_add counted_scatter
#define lar_ilane_scatter_row counted_scatter_row
#define lar_ilane_load        counted_load_force
#define lar_ilane_store       counted_store_force
#define lar_ilane_to_lane     counted_to_lane

#define LAR_KERNEL_ELASTIC
#include "mechanics/hex8_kernel.c"

_Static_assert(sizeof(((lar_counted_block *)NULL)->modulus) ==
                   LAR_LAW_PARAMETERS * LAR_BLOCK * sizeof(plain),
               "counted.h knows as many parameters as laws have");

#undef double
#undef fma
#undef sqrt
#undef fabs

/* ---- from doubles to counting numbers and back -------------------------------------------- */

static void widen(const double *from, size_t count, counted *to) {
    for (size_t i = 0; i < count; i++) to[i] = from[i];
}

static void narrow(const counted *from, size_t count, double *to) {
    for (size_t i = 0; i < count; i++) to[i] = (double)from[i];
}

static void begin(void) {
    memset(&tally, 0, sizeof tally);
    integers = false;
}

static void end(lar_operations *counts) {
    counts->additions += tally.additions;
    counts->multiplications += tally.multiplications;
    counts->fused += tally.fused;
    counts->divisions += tally.divisions;
    counts->roots += tally.roots;
    counts->integer_additions += tally.integer_additions;
    counts->conversions += tally.conversions;
    counts->bytes_loaded += tally.bytes_loaded;
    counts->bytes_stored += tally.bytes_stored;
    integers = false;
}

static void fill_head(const lar_counted_block *from, lar_block_head *to) {
    widen(&from->modulus[0][0], LAR_BLOCK_PARAMETERS * LAR_BLOCK, &to->modulus[0][0]);
    widen(&from->stiffness[0][0], LAR_HEX8_HOURGLASS * LAR_BLOCK, &to->stiffness[0][0]);
    memcpy(to->node, from->node, sizeof to->node);
}

void lar_counted_recover(int law, bool box, const lar_counted_block *block, const double *u,
                         int32_t nodes, int64_t *force, lar_operations *counts) {
    enum { NODES_MAX = 64 };
    counted displacement[3 * NODES_MAX];
    lar_hex8_block general;
    lar_box_block boxes;
    lar_block_more more;
    if (nodes > NODES_MAX) return;
    widen(u, 3 * (size_t)nodes, displacement);
    fill_head(block, box ? &boxes.head : &general.head);
    widen(block->modulus[LAR_BLOCK_PARAMETERS], LAR_MORE_PARAMETERS * LAR_BLOCK, more.modulus[0]);
    if (box) {
        for (int m = 0; m < 3; m++) widen(block->gradient[m][0], LAR_BLOCK, boxes.gradient[m]);
    } else {
        widen(&block->gradient[0][0][0], 18 * LAR_BLOCK, &general.gradient[0][0][0]);
        widen(&block->shape[0][0][0], 12 * LAR_BLOCK, &general.shape[0][0][0]);
    }
    const lar_block_run run = {.law = (lar_law)law,
                               .shape = box ? LAR_SHAPE_BOX : LAR_SHAPE_GENERAL,
                               .rows = LAR_ROWS_NONE,
                               .count = 1,
                               .axis_stride = (size_t)nodes,
                               .blocks = box ? (const void *)&boxes : (const void *)&general,
                               .more = lar_law_has_more((lar_law)law) ? &more : NULL};
    const lar_hex8_limits limits = {1e-3, INFINITY, INFINITY};
    begin();
    counted_kernels.recover(&run, displacement, force, &limits, NULL);
    end(counts);
}

void lar_counted_update(double keep, double dt, double *u, double *v, int64_t *force,
                        const double *push, lar_operations *counts) {
    enum { NODES = 8 };
    counted wide_u[3 * NODES], wide_v[3 * NODES], wide_push[NODES], fastest = 0;
    const lar_leapfrog motion = {.keep = keep, .dt = dt, .speed = INFINITY, .push = 1};
    widen(u, 3 * NODES, wide_u);
    widen(v, 3 * NODES, wide_v);
    widen(push, NODES, wide_push);
    begin();
    counted_kernels.update(&motion, 0, NODES, NODES, wide_u, wide_v, force, wide_push, NULL, NULL,
                           &fastest);
    end(counts);
    narrow(wide_u, 3 * NODES, u);
    narrow(wide_v, 3 * NODES, v);
}

typedef counted element_force(const counted corner[8][3], const lar_material *material,
                              const counted u[8][3], counted force[8][3]);

static double recover_element(element_force *recover_it, int law,
                              const double parameter[LAR_LAW_PARAMETERS], const double corner[8][3],
                              const double u[8][3], double force[8][3], lar_operations *counts) {
    counted wide_corner[8][3], wide_u[8][3], wide_force[8][3];
    lar_material material = {.law = (lar_law)law, .density = 1};
    widen(parameter, LAR_LAW_PARAMETERS, material.parameter);
    widen(&corner[0][0], 24, &wide_corner[0][0]);
    widen(&u[0][0], 24, &wide_u[0][0]);
    begin();
    counted det = recover_it((const counted(*)[3])wide_corner, &material,
                             (const counted(*)[3])wide_u, wide_force);
    end(counts);
    narrow(&wide_force[0][0], 24, &force[0][0]);
    return (double)det;
}

double lar_counted_full(int law, const double parameter[LAR_LAW_PARAMETERS],
                        const double corner[8][3], const double u[8][3], double force[8][3],
                        lar_operations *counts) {
    return recover_element(lar_hex8_full_force, law, parameter, corner, u, force, counts);
}

double lar_counted_matrix(int law, const double parameter[LAR_LAW_PARAMETERS],
                          const double corner[8][3], const double u[8][3], double force[8][3],
                          lar_operations *counts) {
    return recover_element(lar_hex8_matrix_force, law, parameter, corner, u, force, counts);
}
