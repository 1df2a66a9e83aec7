/* The kernels of mechanics, run once more with numbers that count what is done with them.
 *
 *     mechanics/hex8_kernel.c   ---- as it stands, one lane ---->   liblariat's kernel "c"
 *                        `--------- with counting numbers ------>   counted.c
 *
 * The very source is compiled a second time. Its results have the same bits, its operations are
 * counted as the source writes them: a compiler may share what is written twice. What is counted
 * does not depend on the values, and lanes of wider instruction sets do the same for each element.
 */
#ifndef LAR_STUDY_REQUIREMENTS_COUNTED_H
#define LAR_STUDY_REQUIREMENTS_COUNTED_H

#include <stdbool.h>
#include <stdint.h>

typedef struct lar_operations {
    int64_t additions; /* and subtractions */
    int64_t multiplications;
    int64_t fused; /* multiply-adds: two operations each */
    int64_t divisions;
    int64_t roots;
    int64_t integer_additions;          /* of forces, which are 64-bit integers */
    int64_t conversions;                /* between the two */
    int64_t bytes_loaded, bytes_stored; /* by the instructions, wherever the bytes are */
} lar_operations;

/* Floating point operations. */
static inline int64_t lar_operations_floating(const lar_operations *o) {
    return o->additions + o->multiplications + 2 * o->fused + o->divisions + o->roots;
}
/* With the additions of forces, which the thesis's figures contain too. */
static inline int64_t lar_operations_all(const lar_operations *o) {
    return lar_operations_floating(o) + o->integer_additions;
}

/* Numbers of one block of eight elements, lane by lane, as in mechanics/hex8_block.h. */
typedef struct lar_counted_block {
    double modulus[7][8], stiffness[4][8];
    double gradient[6][3][8]; /* of a box: [m][0] along its own axis, m < 3 */
    double shape[4][3][8];
    int32_t node[8][8];
} lar_counted_block;

/* Recovers a block (law: lar_law) from u[3][nodes], adds to force[3][nodes], adds to *counts what
 * all eight elements need. */
void lar_counted_recover(int law, bool box, const lar_counted_block *block, const double *u,
                         int32_t nodes, int64_t *force, lar_operations *counts);

/* Moves eight nodes by one step: u, v, force [3][8], push [8]. */
void lar_counted_update(double keep, double dt, double *u, double *v, int64_t *force,
                        const double *push, lar_operations *counts);

/* Forces of one element of hex8-full, or hex8-matrix; returns det F. */
double lar_counted_full(int law, const double parameter[7], const double corner[8][3],
                        const double u[8][3], double force[8][3], lar_operations *counts);
double lar_counted_matrix(int law, const double parameter[7], const double corner[8][3],
                          const double u[8][3], double force[8][3], lar_operations *counts);

#endif
