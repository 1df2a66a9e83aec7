#include "study/requirements/thesis_formulas.h"

#include <math.h>

#include "divide/traffic.h"

const char *const lar_method_name[LAR_METHODS] = {"implicit", "matrix", "vector", "hourglass"};

const lar_thesis_print lar_thesis_printed[LAR_METHODS] = {
    [LAR_METHOD_IMPLICIT] = {339e6, 17e9, 477e3, 191e6},
    [LAR_METHOD_MATRIX] = {167e6, 1.7e12, 5.5e3, 437e6},
    [LAR_METHOD_VECTOR] = {38e6, 379e9, 5.5e3, 437e6},
    [LAR_METHOD_HOURGLASS] = {1.6e6, 16e9, 5.5e3, 437e6},
};

lar_quantities lar_thesis_quantities(void) {
    return (lar_quantities){.n_el = 1840,
                            .n_k = 2528,
                            .n_eav = 5.6,
                            .df_el = 24,
                            .df_eav = 61.4,
                            .n_int = 8,
                            .n_it = 100,
                            .step_im = 20e-3,
                            .step_ex = 100e-6,
                            .n_p = 12,
                            .n_pav = 1.36};
}

double lar_freedoms(const lar_quantities *q) {
    return 3 * q->n_k;
}

static void add_up(lar_formula_row row[LAR_FORMULA_ROWS]) {
    lar_formula_row total = {"total", 0, 0};
    for (int i = 0; i < LAR_FORMULA_ROWS - 1; i++) {
        total.additions += row[i].additions;
        total.multiplications += row[i].multiplications;
    }
    row[LAR_FORMULA_ROWS - 1] = total;
}

void lar_formula_matrix(double df, lar_formula_row row[LAR_FORMULA_ROWS]) {
    row[0] = (lar_formula_row){"B_L, B_N, S", 25 * df, 31 * df};
    row[1] = (lar_formula_row){"B_L^T C B_L", 5 * df * (df + 6), 6 * df * (df + 6)};
    row[2] = (lar_formula_row){"B_N^T S B_N", 2 * df * (df / 3 + 3), df * (df + 9)};
    row[3] = (lar_formula_row){"K", df * df, 0};
    row[4] = (lar_formula_row){"miscellaneous", 5 * df, 7 * df};
    add_up(row);
}

void lar_formula_vector(double df, lar_formula_row row[LAR_FORMULA_ROWS]) {
    row[0] = (lar_formula_row){"B_L, B_N, S", 25 * df, 31 * df};
    row[1] = (lar_formula_row){"B_L^T (C (B_L u))", 11 * df + 24, 12 * df + 36};
    row[2] = (lar_formula_row){"B_N^T (S (B_N u))", 5 * df + 9, 6 * df + 27};
    row[3] = (lar_formula_row){"K u", df, 0};
    row[4] = (lar_formula_row){"miscellaneous", 5 * df, 7 * df};
    add_up(row);
}

static double of_all_points(const lar_quantities *q, const lar_formula_row *total) {
    return q->n_int * (total->additions + total->multiplications);
}

double lar_formula_N_K(const lar_quantities *q) {
    lar_formula_row row[LAR_FORMULA_ROWS];
    lar_formula_matrix(q->df_el, row);
    return of_all_points(q, &row[LAR_FORMULA_ROWS - 1]);
}

double lar_formula_N_Ku(const lar_quantities *q) {
    lar_formula_row row[LAR_FORMULA_ROWS];
    lar_formula_vector(q->df_el, row);
    return of_all_points(q, &row[LAR_FORMULA_ROWS - 1]);
}

/* Two products of matrix and vector and 20 df_g for the vectors. */
double lar_formula_N_g(const lar_quantities *q) {
    return 2 * lar_freedoms(q) * (2 * q->df_eav + 9);
}

double lar_formula_C_K(const lar_quantities *q) {
    return q->df_eav * lar_freedoms(q);
}

double lar_formula_C_g(const lar_quantities *q) {
    return (q->n_p - 1) * (q->n_p - 1);
}

double lar_formula_step(lar_method method, const lar_quantities *q) {
    return method == LAR_METHOD_IMPLICIT ? q->step_im : q->step_ex;
}

double lar_formula_operations(lar_method method, const lar_quantities *q) {
    /* Force sums and the new positions, of every explicit method. */
    double nodes = lar_freedoms(q) * (q->n_eav + 1);
    switch (method) {
    case LAR_METHOD_IMPLICIT:
        return q->n_el * lar_formula_N_K(q) + q->n_it * lar_formula_N_g(q);
    case LAR_METHOD_MATRIX:
        return q->n_el * (lar_formula_N_K(q) + q->df_el * q->df_el - q->df_el) + nodes;
    case LAR_METHOD_VECTOR:
        return q->n_el * lar_formula_N_Ku(q) + nodes;
    default:
        return q->n_el * LAR_THESIS_HOURGLASS + nodes;
    }
}

double lar_formula_values(lar_method method, const lar_quantities *q) {
    if (method == LAR_METHOD_IMPLICIT) return lar_formula_C_K(q) + q->n_it * lar_formula_C_g(q);
    return 2 * (q->n_pav - 1) * lar_freedoms(q);
}

double lar_formula_vectors_all(double n) {
    return 6 * n * n + 24 * n + 26;
}

double lar_formula_vectors_local(double n) {
    return 6 * n * n + 12 * n + 6;
}

lar_formula_traffic lar_formula_scheme(int scheme, int64_t n) {
    lar_formula_traffic row = {lar_scheme_name[scheme], 0, 0};
    lar_traffic_formula((lar_scheme)scheme, n, &row.local, &row.global);
    return row;
}

int64_t lar_formula_edge(const lar_quantities *q) {
    int64_t n = llround(cbrt(q->n_el / q->n_p));
    return n > 1 ? n : 1;
}

double lar_formula_alphas(double operations_per_second) {
    return operations_per_second / (666e6 * 2 / 3);
}
