/* Compiled with two lanes, and with four for processors that have them (AVX2): LAR_TOGETHER. */
#include "mechanics/tool_lanes.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "mechanics/contact.h"

typedef double lanes __attribute__((vector_size(8 * LAR_TOGETHER)));
typedef int64_t lane_bits __attribute__((vector_size(8 * LAR_TOGETHER)));
typedef lanes lanes_anywhere __attribute__((aligned(8), may_alias));

static inline lanes all(double value) {
    return (lanes){0} + value;
}

static inline lanes choose(lane_bits yes, lanes a, lanes b) {
    return (lanes)((yes & (lane_bits)a) | (~yes & (lane_bits)b));
}

static inline lanes magnitude(lanes a) {
    return (lanes)((lane_bits)a & INT64_MAX);
}

static inline lanes root(lanes a) {
    for (int t = 0; t < LAR_TOGETHER; t++) a[t] = sqrt(a[t]);
    return a;
}

/* The nearest whole number, the even one of two: what llrint() has. */
static inline lanes nearest(lanes a) {
    lane_bits sign = (lane_bits)a & INT64_MIN;
    lanes big = (lanes)(sign | (lane_bits)all(0x1p52));
    return choose(magnitude(a) < 0x1p52, (a + big) - big, a);
}

static inline lanes dot(const lanes a[3], const lanes b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void take(const lar_three_fours from, int first, lanes to[3]) {
    for (int i = 0; i < 3; i++) to[i] = *(const lanes_anywhere *)&from[i][first];
}

static inline void put(const lanes from[3], lar_three_fours to, int first) {
    for (int i = 0; i < 3; i++) *(lanes_anywhere *)&to[i][first] = from[i];
}

/* lar_friction_part. */
static inline lanes part_of(lanes max, lanes square, lanes both) {
    lanes part = choose(max * max < square, max / root(square), all(1));
    lanes left = 1 + both / square;
    lanes less = choose(left < part, choose(left > 0, left, all(0)), part);
    return choose(both < -LAR_FRICTION_NONE * square, less, part);
}

static inline void find_friction(const lar_leapfrog *leapfrog, const lar_tool_rubs *rubs, int first,
                                 lanes friction[3]) {
    lanes press[3], force[3], v[3], velocity[3], along[3], before[3];
    const lanes unit = *(const lanes_anywhere *)&rubs->unit[first];
    take(rubs->press, first, press);
    take(rubs->force, first, force);
    take(rubs->v, first, v);
    take(rubs->velocity, first, velocity);
    for (int i = 0; i < 3; i++) {
        lanes ahead = leapfrog->keep * v[i] + leapfrog->drift[i] - unit * force[i];
        before[i] = v[i] - velocity[i];
        along[i] = ahead - velocity[i];
    }
    lanes square = dot(press, press), across = dot(press, along) / square;
    for (int i = 0; i < 3; i++) along[i] -= press[i] * across;
    lanes part = part_of(unit * root(square), dot(along, along), dot(along, before));
    lanes times = -part / unit;
    for (int i = 0; i < 3; i++) {
        lanes wanted = times * along[i];
        friction[i] = choose(magnitude(wanted) < 0x1p56, nearest(wanted), all(0));
    }
}

/* `force`: whole. */
static inline void find_torques(const lanes force[3], const lanes arm[3], int first,
                                lar_tool_pushes *pushes) {
    lanes all_of_it[3], rest[3];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        lanes torque = -(arm[j] * force[k] - arm[k] * force[j]);
        torque = choose(magnitude(torque) < 0x1p56, torque, all(0)); /* an arm beyond all places */
        lanes whole = nearest(torque);
        all_of_it[i] = choose(whole > torque, whole - 1, whole);
        rest[i] = nearest((torque - all_of_it[i]) / LAR_TORQUE_REST);
    }
    put(force, pushes->force, first);
    put(all_of_it, pushes->torque, first);
    put(rest, pushes->rest, first);
}

static inline void rub(const lar_leapfrog *leapfrog, lar_tool_rubs *rubs, int32_t count) {
    for (int32_t i = 0; i < count; i++)
        for (int first = 0; first < LAR_TOOL_LANES; first += LAR_TOGETHER) {
            lanes force[3], arm[3];
            find_friction(leapfrog, &rubs[i], first, force);
            take(rubs[i].arm, first, arm);
            find_torques(force, arm, first, &rubs[i].friction);
        }
}

static inline bool push(double scale, const double force[3][4], const double x[4][3],
                        const double tip[3], lar_tool_pushes *pushes) {
    bool all_fit = true;
    for (int first = 0; first < LAR_TOOL_LANES; first += LAR_TOGETHER) {
        lanes units[3], arm[3];
        take(force, first, units);
        for (int i = 0; i < 3; i++) {
            units[i] *= scale;
            lane_bits fits = magnitude(units[i]) < 0x1p56;
            units[i] = nearest(units[i]);
            for (int t = 0; t < LAR_TOGETHER; t++) {
                all_fit &= fits[t] != 0;
                arm[i][t] = x[first + t][i];
            }
            arm[i] -= tip[i];
        }
        find_torques(units, arm, first, pushes);
    }
    return all_fit;
}

#if LAR_TOGETHER == 4
void lar_tool_rub_fours(const lar_leapfrog *leapfrog, lar_tool_rubs *rubs, int32_t count) {
    rub(leapfrog, rubs, count);
}

bool lar_tool_push_fours(double scale, const double force[3][4], const double x[4][3],
                         const double tip[3], lar_tool_pushes *pushes) {
    return push(scale, force, x, tip, pushes);
}
#else
void lar_tool_rub_pairs(const lar_leapfrog *leapfrog, lar_tool_rubs *rubs, int32_t count) {
    rub(leapfrog, rubs, count);
}

bool lar_tool_push_pairs(double scale, const double force[3][4], const double x[4][3],
                         const double tip[3], lar_tool_pushes *pushes) {
    return push(scale, force, x, tip, pushes);
}

#if defined(LAR_HAVE_FACE_LANES)
#define HERE(fours, pairs) (__builtin_cpu_supports("avx2") ? fours : pairs)
#else
#define HERE(fours, pairs) pairs
#endif

void lar_tool_rub_lanes(const lar_leapfrog *leapfrog, lar_tool_rubs *rubs, int32_t count) {
    HERE(lar_tool_rub_fours, lar_tool_rub_pairs)(leapfrog, rubs, count);
}

bool lar_tool_push_lanes(double scale, const double force[3][4], const double x[4][3],
                         const double tip[3], lar_tool_pushes *pushes) {
    return HERE(lar_tool_push_fours, lar_tool_push_pairs)(scale, force, x, tip, pushes);
}
#endif
