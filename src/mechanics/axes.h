/* Vectors of many nodes, axis by axis:
 *
 *     x x x ... x . .   y y y ... y . .   z z z ... z . .       `stride` values from x to y to z
 *
 * The same axis of consecutive nodes is consecutive: whole lanes of it are loaded as they are
 * (base/simd.h), and where a fourth value would only fill up, nothing is read or written. The
 * distance between axes is not near a multiple of 4 KiB, for processors take a load for a later
 * part of a store when the last twelve bits of both addresses are the same.
 */
#ifndef LAR_MECHANICS_AXES_H
#define LAR_MECHANICS_AXES_H

#include <stddef.h>
#include <stdint.h>

/* Nodes that whole lanes hold: ranges of nodes begin and end with multiples of it. */
enum { LAR_NODES_TOGETHER = 8 };

static inline int32_t lar_whole_lanes(int32_t nodes) {
    return (nodes + LAR_NODES_TOGETHER - 1) / LAR_NODES_TOGETHER * LAR_NODES_TOGETHER;
}

static inline int lar_axes_collide(size_t distance) {
    enum { PAGE = 4096 / sizeof(double), NEAR = 64 };
    return (distance + NEAR) % PAGE < 2 * NEAR;
}

/* For so many nodes, a multiple of LAR_NODES_TOGETHER, and as many behind them that nobody moves:
 * lanes without an element read them whenever they are looked at. */
static inline size_t lar_axis_stride(size_t nodes) {
    size_t stride = nodes + LAR_NODES_TOGETHER;
    while (lar_axes_collide(stride) || lar_axes_collide(2 * stride)) stride += LAR_NODES_TOGETHER;
    return stride;
}

static inline void lar_axes_get(const double *of, size_t stride, int32_t node, double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = of[(size_t)node + (size_t)i * stride];
}

static inline void lar_axes_put(double *of, size_t stride, int32_t node, const double in[3]) {
    for (int i = 0; i < 3; i++) of[(size_t)node + (size_t)i * stride] = in[i];
}

#endif
