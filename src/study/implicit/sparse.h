/* A sparse matrix over the nodes of a mesh: three rows per node, in compressed rows.
 *
 *     start    0        5          (rows + 1)     row r: values start[r] .. start[r + 1] - 1
 *     column   | 0 1 2 6 7 | 0 1 ...              ascending within a row
 *     value    | . . . . . | . . ...
 *
 * Rows 3 n + i of node n have the same columns: the axes of all nodes that share an element with
 * n, itself included. The pattern is symmetric.
 */
#ifndef LAR_STUDY_IMPLICIT_SPARSE_H
#define LAR_STUDY_IMPLICIT_SPARSE_H

#include "model/mesh/mesh.h"

typedef struct lar_sparse {
    int32_t rows;
    int32_t *start, *column;
    double *value;
} lar_sparse;

/* The pattern, all values zero. Refuses meshes whose matrix would have 2^31 values. */
lar_status lar_sparse_create(const lar_mesh *mesh, lar_sparse *matrix, lar_error *error);
void lar_sparse_destroy(lar_sparse *matrix); /* idempotent */

/* Where the value at (row, column) stands; both must be in the pattern. */
double *lar_sparse_at(const lar_sparse *matrix, int32_t row, int32_t column);

/* y = A x */
void lar_sparse_multiply(const lar_sparse *matrix, const double *x, double *y);

#endif
