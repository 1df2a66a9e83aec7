#include "study/implicit/sparse.h"

#include <stdlib.h>
#include <string.h>

/* Which elements a node has. */
typedef struct incidence {
    int32_t *start, *element;
    int32_t *seen, *near; /* scratch: the last node that met a node; its neighbours */
} incidence;

static void release(incidence *in) {
    free(in->start);
    free(in->element);
    free(in->seen);
    free(in->near);
}

static lar_status list_elements(const lar_mesh *mesh, incidence *in, lar_error *error) {
    size_t nodes = (size_t)mesh->node_count, corners = 8 * (size_t)mesh->element_count;
    in->start = lar_calloc(nodes + 2, sizeof *in->start);
    in->element = lar_calloc(corners, sizeof *in->element);
    in->seen = lar_calloc(nodes, sizeof *in->seen);
    in->near = lar_calloc(nodes, sizeof *in->near);
    if (!in->start || !in->element || !in->seen || !in->near)
        return lar_fail_memory(error, (3 * nodes + corners) * sizeof(int32_t), "a sparse matrix");
    for (size_t k = 0; k < corners; k++) in->start[mesh->element[k / 8][k % 8] + 2]++;
    for (size_t n = 0; n < nodes; n++) in->start[n + 2] += in->start[n + 1];
    for (size_t k = 0; k < corners; k++)
        in->element[in->start[mesh->element[k / 8][k % 8] + 1]++] = (int32_t)(k / 8);
    return LAR_OK;
}

static int ascending(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* The neighbours of a node in in->near, ascending; returns their number, at least itself. */
static int32_t neighbours(const lar_mesh *mesh, incidence *in, int32_t node) {
    int32_t count = 0;
    in->near[count++] = node;
    in->seen[node] = node + 1;
    for (int32_t k = in->start[node]; k < in->start[node + 1]; k++)
        for (int a = 0; a < 8; a++) {
            int32_t other = mesh->element[in->element[k]][a];
            if (in->seen[other] == node + 1) continue;
            in->seen[other] = node + 1;
            in->near[count++] = other;
        }
    qsort(in->near, (size_t)count, sizeof *in->near, ascending);
    return count;
}

static lar_status fill_pattern(const lar_mesh *mesh, incidence *in, lar_sparse *matrix,
                               lar_error *error) {
    int64_t values = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) values += 9 * (int64_t)neighbours(mesh, in, n);
    if (values > INT32_MAX || mesh->node_count > INT32_MAX / 3 - 1)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: the matrix of %d nodes is too large for the implicit comparison; take "
                        "a coarser mesh",
                        mesh->source ? mesh->source : "the mesh", (int)mesh->node_count);
    matrix->rows = 3 * mesh->node_count;
    matrix->start = lar_calloc((size_t)matrix->rows + 1, sizeof *matrix->start);
    matrix->column = lar_calloc((size_t)values, sizeof *matrix->column);
    matrix->value = lar_calloc((size_t)values, sizeof *matrix->value);
    if (!matrix->start || !matrix->column || !matrix->value)
        return lar_fail_memory(error, (size_t)values * 12, "a sparse matrix");
    memset(in->seen, 0, (size_t)mesh->node_count * sizeof *in->seen);
    int32_t at = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        int32_t count = neighbours(mesh, in, n);
        for (int i = 0; i < 3; i++) {
            for (int32_t k = 0; k < 3 * count; k++)
                matrix->column[at++] = 3 * in->near[k / 3] + k % 3;
            matrix->start[3 * n + i + 1] = at;
        }
    }
    return LAR_OK;
}

lar_status lar_sparse_create(const lar_mesh *mesh, lar_sparse *matrix, lar_error *error) {
    *matrix = (lar_sparse){0};
    incidence in = {0};
    lar_status status = list_elements(mesh, &in, error);
    if (!status) status = fill_pattern(mesh, &in, matrix, error);
    if (status) lar_sparse_destroy(matrix);
    release(&in);
    return status;
}

void lar_sparse_destroy(lar_sparse *matrix) {
    free(matrix->start);
    free(matrix->column);
    free(matrix->value);
    *matrix = (lar_sparse){0};
}

double *lar_sparse_at(const lar_sparse *matrix, int32_t row, int32_t column) {
    int32_t low = matrix->start[row], high = matrix->start[row + 1] - 1;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (matrix->column[middle] < column)
            low = middle + 1;
        else
            high = middle;
    }
    return &matrix->value[low];
}

void lar_sparse_multiply(const lar_sparse *matrix, const double *x, double *y) {
    for (int32_t r = 0; r < matrix->rows; r++) {
        double sum = 0;
        for (int32_t k = matrix->start[r]; k < matrix->start[r + 1]; k++)
            sum += matrix->value[k] * x[matrix->column[k]];
        y[r] = sum;
    }
}
