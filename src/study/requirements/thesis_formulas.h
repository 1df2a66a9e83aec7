/* What chapter 4 of the thesis computes: how many operations and how many values a simulation of
 * so many elements needs, per step and per second.
 *
 *     implicit    conjugate gradients (BiCGSTAB) on the assembled matrix        eqs. 4.1 to 4.7
 *     matrix      explicit, an element stiffness matrix in every step           eq. 4.9
 *     vector      explicit, forces directly, eight integration points           eqs. 4.10, 4.11
 *     hourglass   explicit, one point, total hourglass control                  eq. 4.12
 *
 * The formulas as they stand, as functions of the quantities below; nothing here is measured or
 * counted from a model. What the thesis prints in its tables is beside them. Three of its printed
 * numbers are not what its own formulas give for its own quantities:
 *
 *     table 4.3, implicit    339 M, 17 GFLOPS  eq. 4.1 gives 368 M, 18 GFLOPS; 339 M is what it
 *                                              gives when eq. 4.4 loses the 83 df_el
 *                                              multiplications of table 4.1
 *     table 4.3, matrix      167 M             170 M; 167 M comes from N_K rounded to 90,000
 *     table 4.4, implicit    477 k             477,758, cut off instead of rounded
 */
#ifndef LAR_STUDY_REQUIREMENTS_THESIS_FORMULAS_H
#define LAR_STUDY_REQUIREMENTS_THESIS_FORMULAS_H

#include <stdint.h>

/* The quantities, by the thesis's names. */
typedef struct lar_quantities {
    double n_el;    /* elements */
    double n_k;     /* nodes */
    double n_eav;   /* elements at a node, mean */
    double df_el;   /* degrees of freedom of an element */
    double df_eav;  /* values that are not zero in a row of the assembled matrix, mean */
    double n_int;   /* integration points of full integration */
    double n_it;    /* iterations of the solver in a step */
    double step_im; /* dt_im [s] */
    double step_ex; /* dt_ex [s] */
    double n_p;     /* processors */
    double n_pav;   /* processors that have a node, mean */
} lar_quantities;

/* The thesis's own (its chapter 4). */
lar_quantities lar_thesis_quantities(void);

/* Degrees of freedom of the model, df_g = 3 n_k. */
double lar_freedoms(const lar_quantities *q);

/* One row of table 4.1 or 4.2: additions (with subtractions) and multiplications. */
typedef struct lar_formula_row {
    const char *calculation;
    double additions, multiplications;
} lar_formula_row;

enum { LAR_FORMULA_ROWS = 6 }; /* the last one is the total */

/* Table 4.1: for an element matrix, per integration point. */
void lar_formula_matrix(double df_el, lar_formula_row row[LAR_FORMULA_ROWS]);
/* Table 4.2: for an element's forces, per integration point. */
void lar_formula_vector(double df_el, lar_formula_row row[LAR_FORMULA_ROWS]);

double lar_formula_N_K(const lar_quantities *q);  /* eq. 4.4: of one element matrix */
double lar_formula_N_g(const lar_quantities *q);  /* eq. 4.5: of one iteration */
double lar_formula_N_Ku(const lar_quantities *q); /* eq. 4.10: of one element's forces */
double lar_formula_C_K(const lar_quantities *q);  /* eq. 4.6: values, for the matrix */
double lar_formula_C_g(const lar_quantities *q);  /* eq. 4.7: values, for one iteration */

typedef enum lar_method {
    LAR_METHOD_IMPLICIT = 0,
    LAR_METHOD_MATRIX,
    LAR_METHOD_VECTOR,
    LAR_METHOD_HOURGLASS,
    LAR_METHODS
} lar_method;

/* "implicit", "matrix", "vector", "hourglass". */
extern const char *const lar_method_name[LAR_METHODS];

/* Operations that the thesis counts for an element with total hourglass control. */
enum { LAR_THESIS_HOURGLASS = 816 };

/* Length of a step of the method [s]. */
double lar_formula_step(lar_method method, const lar_quantities *q);
/* Operations of a step; per second they are eqs. 4.1, 4.9, 4.11, 4.12. */
double lar_formula_operations(lar_method method, const lar_quantities *q);
/* Values of 8 bytes that are sent in a step; per second they are eqs. 4.2 and 4.8. */
double lar_formula_values(lar_method method, const lar_quantities *q);

/* Vectors that the cube of n^3 elements of T 3.7 sends in a step: eq. 3.18 (every node to all that
 * have it), eq. 3.23 (local channels only). The numerical examples are n = 5. */
double lar_formula_vectors_all(double n);
double lar_formula_vectors_local(double n);

/* A row of table 3.1: what such a processor sends in a step under a scheme, in vectors. */
enum { LAR_FORMULA_SCHEMES = 4 };
typedef struct lar_formula_traffic {
    const char *scheme; /* "all", "local", "one", "two" */
    int64_t local, global;
} lar_formula_traffic;
lar_formula_traffic lar_formula_scheme(int scheme, int64_t n);

/* The n whose cube is nearest to a processor's share of the elements, at least 1. */
int64_t lar_formula_edge(const lar_quantities *q);

/* Processors that the thesis takes for this many operations per second: of 666 MHz, two operations
 * every three cycles (T 4.3). */
double lar_formula_alphas(double operations_per_second);

/* As printed in tables 4.3 and 4.4. The explicit methods share a row of table 4.4. */
typedef struct lar_thesis_print {
    double operations, operations_per_second; /* table 4.3 */
    double values, bytes_per_second;          /* table 4.4 */
} lar_thesis_print;
extern const lar_thesis_print lar_thesis_printed[LAR_METHODS];

#endif
