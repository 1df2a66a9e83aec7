/* A symmetric matrix of 6 x 6 blocks, of which few are not zero, and its factor.
 *
 *     1  2  3  4  5          rows and columns in an order that keeps the factor sparse: next comes
 *     #                      always one with the fewest others left that it knows, which from then
 *     .  #                   on all know each other (minimum degree: Tinney and Walker, Proceedings
 *     #  .  #                of the IEEE 55, 1967; Rose 1972)
 *     .  #  .  #
 *     #  .  #  #  #          a column holds its diagonal block and those below
 *
 * In a body that is cut into some hundred boxes a box knows a dozen others; of 801 x 801 blocks
 * 6,700 are left, where a band along the body would hold 58,000. */
#ifndef LAR_MESHING_STARTER_ELASTIC_FACTOR_H
#define LAR_MESHING_STARTER_ELASTIC_FACTOR_H

#include "meshing/starter/elastic.h"

enum { LAR_FACTOR_BLOCK = 6 };

typedef double lar_factor_block[LAR_FACTOR_BLOCK][LAR_FACTOR_BLOCK];

typedef struct lar_factor {
    int32_t count;           /* columns, in blocks */
    size_t *start;           /* [count + 1] where a column's blocks stand */
    int32_t *row;            /* of each block; a column's own first, then ascending */
    lar_factor_block *block; /* [row within][column within] */
} lar_factor;

/* Lays the blocks out, all zero, for `count` unknowns (of six numbers each) of which each of
 * `pairs` pairs, in any order, know each other. place: [count] the column that each of them
 * becomes; what follows goes by columns. */
lar_status lar_factor_lay(int32_t count, const int32_t (*pair)[2], size_t pairs, int32_t *place,
                          lar_factor *factor, lar_error *error);
void lar_factor_clear(lar_factor *factor);

/* The block at a row and a column not after it; the pair must be known. Of a block on the diagonal
 * only the lower half is read. */
lar_factor_block *lar_factor_at(lar_factor *factor, int32_t row, int32_t column);

/* Cholesky's, in place. Of numbers that depend on others those that come later are left out: they
 * will be 0. */
lar_status lar_factor_compute(lar_factor *factor, lar_error *error);

/* x: [6 count] two loads, which become the solution. */
void lar_factor_solve(const lar_factor *factor, lar_pair *x);

#endif
