#include "cli/report/requirements.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "base/json/write.h"

static const char *const method_text[LAR_METHODS] = {
    "implicit, CG (4.1)", "explicit, matrices (4.2.1)", "explicit, vector (4.2.2)",
    "explicit, hourglass (4.2.3)"};

/* "1.551 M" and the like: so many digits and a prefix. */
typedef struct scaled {
    char text[24];
} scaled;

static scaled scale(double value, int digits) {
    static const char *const prefix[] = {"", " k", " M", " G", " T", " P"};
    int step = 0;
    scaled s;
    while (fabs(value) >= 999.95 && step < 5) {
        value /= 1000;
        step++;
    }
    snprintf(s.text, sizeof s.text, "%.*g%s", digits, value, prefix[step]);
    return s;
}

/* ---- quantities ----------------------------------------------------------------------------- */

static void print_quantity(const requirements_report *p, const char *name, const char *what,
                           double value, double thesis, double factor, int digits) {
    printf("  %-8s%-52s%12.*f", name, what, digits, factor * value);
    if (p->thesis && p->title) printf("%12.*f", digits, factor * thesis);
    printf("\n");
}

static void print_quantities(const requirements_report *p) {
    const lar_quantities *q = &p->r->quantities, t = lar_thesis_quantities();
    printf("QUANTITIES (%s)\n", p->title
                                    ? "counted from the mesh, its distribution, its stable step"
                                    : "the thesis's, T 4");
    if (p->title && p->thesis) printf("  %-60s%12s%12s\n", "", "model", "thesis");
    print_quantity(p, "n_el", "elements", q->n_el, t.n_el, 1, 0);
    print_quantity(p, "n_k", "nodes", q->n_k, t.n_k, 1, 0);
    print_quantity(p, "df_g", "degrees of freedom of the model, 3 n_k", lar_freedoms(q),
                   lar_freedoms(&t), 1, 0);
    print_quantity(p, "n_eav", "elements at a node, mean", q->n_eav, t.n_eav, 1, 2);
    print_quantity(p, "df_el", "degrees of freedom of an element", q->df_el, t.df_el, 1, 0);
    print_quantity(p, "df_eav", "values in a row of the assembled matrix, mean", q->df_eav,
                   t.df_eav, 1, 1);
    print_quantity(p, "n_int", "integration points of full integration", q->n_int, t.n_int, 1, 0);
    print_quantity(p, "n_it", "iterations of the implicit solver (assumed)", q->n_it, t.n_it, 1, 0);
    print_quantity(p, "dt_im", "implicit step [ms] (assumed)", q->step_im, t.step_im, 1e3, 1);
    print_quantity(p, "dt_ex", "explicit step [us]", q->step_ex, t.step_ex, 1e6, 2);
    print_quantity(p, "n_p", "processors", q->n_p, t.n_p, 1, 0);
    print_quantity(p, "n_pav", "processors that have a node, mean", q->n_pav, t.n_pav, 1, 2);
}

/* ---- formulas ------------------------------------------------------------------------------- */

static void print_point_table(const char *title, const lar_formula_row row[LAR_FORMULA_ROWS],
                              double df) {
    printf("\n%s, df_el = %.0f (formula)\n  %-30s%14s%18s\n", title, df, "", "additions",
           "multiplications");
    for (int i = 0; i < LAR_FORMULA_ROWS; i++)
        printf("  %-30s%14.0f%18.0f\n", row[i].calculation, row[i].additions,
               row[i].multiplications);
}

static void print_elements(const requirements_report *p) {
    const lar_quantities *q = &p->r->quantities;
    lar_formula_row row[LAR_FORMULA_ROWS];
    lar_formula_matrix(q->df_el, row);
    print_point_table("TABLE 4.1  operations per integration point for an element matrix", row,
                      q->df_el);
    printf("  of an element with %.0f points, N_K (eq. 4.4): %.0f", q->n_int, lar_formula_N_K(q));
    if (p->thesis) printf("; the thesis: the same table, 90,000");
    printf("\n");
    lar_formula_vector(q->df_el, row);
    print_point_table("TABLE 4.2  operations per integration point for an element's forces", row,
                      q->df_el);
    printf("  of an element with %.0f points (eq. 4.10): %.0f", q->n_int, lar_formula_N_Ku(q));
    if (p->thesis) printf("; the thesis: the same table, more than 20,000");
    printf("\n");
}

static void print_methods(const requirements_report *p) {
    const lar_quantities *q = &p->r->quantities;
    printf("\nTABLE 4.3  operations (formulas, eqs. 4.1, 4.9, 4.11, 4.12)\n  %-30s%14s%14s", "",
           "per step", "per second");
    if (p->thesis) printf("%24s", "thesis: step, second");
    printf("\n");
    for (int m = 0; m < LAR_METHODS; m++) {
        const lar_thesis_print *t = &lar_thesis_printed[m];
        double operations = lar_formula_operations((lar_method)m, q);
        printf("  %-30s%14s%14s", method_text[m], scale(operations, 4).text,
               scale(operations / lar_formula_step((lar_method)m, q), 4).text);
        if (p->thesis)
            printf("%14s%10s", scale(t->operations, 3).text,
                   scale(t->operations_per_second, 3).text);
        printf("\n");
    }
    if (p->thesis)
        printf("  The thesis prints 339 M where its eq. 4.1 gives 368 M: the 83 df_el of table 4.1 "
               "are\n  missing in it. Its 167 M is with N_K rounded to 90,000.\n");
    printf(
        "  With hourglass control that is %.0f of the thesis's processors (444 MFLOPS, a third of "
        "their peak)",
        ceil(lar_formula_alphas(lar_formula_operations(LAR_METHOD_HOURGLASS, q) / q->step_ex)));
    if (p->thesis) printf(";\n  the thesis says 36, from 16 GFLOPS");
    printf(".\n\nTABLE 4.4  values that are sent (formulas, eqs. 4.2, 4.8)\n  %-30s%14s%14s", "",
           "per step", "bytes/s");
    if (p->thesis) printf("%24s", "thesis: step, bytes/s");
    printf("\n");
    for (int m = 0; m < 2; m++) {
        const lar_thesis_print *t = &lar_thesis_printed[m];
        double values = lar_formula_values((lar_method)m, q);
        printf("  %-30s%14s%14s", m == 0 ? "implicit" : "explicit", scale(values, 4).text,
               scale(8 * values / lar_formula_step((lar_method)m, q), 4).text);
        if (p->thesis)
            printf("%14s%10s", scale(t->values, 3).text, scale(t->bytes_per_second, 3).text);
        printf("\n");
    }
}

static void print_vectors(const requirements_report *p) {
    int64_t n = lar_formula_edge(&p->r->quantities);
    printf("\nTABLE 3.1  vectors that a processor with %" PRId64 "^3 elements sends in a step "
           "(formula)\n  %-30s%14s%14s\n",
           n, "", "local", "global");
    for (int s = 0; s < LAR_FORMULA_SCHEMES; s++) {
        lar_formula_traffic row = lar_formula_scheme(s, n);
        printf("  %-30s%14" PRId64 "%14" PRId64 "\n", row.scheme, row.local, row.global);
    }
    printf("  all to all %.0f in all, local only %.0f", lar_formula_vectors_all((double)n),
           lar_formula_vectors_local((double)n));
    if (p->thesis && n == 5) printf("; the thesis: 296 and 216");
    printf("\n");
}

/* ---- what we really do ---------------------------------------------------------------------- */

static void print_kernels(const requirements_report *p) {
    printf("\nOUR KERNELS, per element (counted from the code; law neo-hookean)\n"
           "  %-14s%10s%10s%10s%10s%12s%12s\n",
           "", "add", "multiply", "fused", "divide", "operations", "bytes");
    for (int k = 0; k <= LAR_KERNEL_KINDS; k++) {
        bool node = k == LAR_KERNEL_KINDS;
        lar_kernel_kind kind = (lar_kernel_kind)k;
        lar_operations o = node ? lar_operations_of_node() : lar_operations_of_element(kind, 0);
        lar_step_bytes b = node ? lar_bytes_of_node() : lar_bytes_of_element(kind, 0);
        printf("  %-14s%10" PRId64 "%10" PRId64 "%10" PRId64 "%10" PRId64 "%12" PRId64 "%12" PRId64
               "\n",
               node ? "node" : lar_kernel_kind_name[k], o.additions + o.integer_additions,
               o.multiplications, o.fused, o.divisions + o.roots, lar_operations_all(&o),
               b.read + b.written);
    }
    printf("  A fused multiply-add is two operations. Additions are with the integer ones of "
           "forces (90\n  per hex8). Bytes: of an element's constants; of a node, all that is read "
           "and written.\n  The thesis: %d operations for its element (T 4.2.3).\n",
           LAR_THESIS_HOURGLASS);
    for (int i = 0; i < p->r->shape_count; i++) {
        const lar_requirements_shape *s = &p->r->shape[i];
        printf("  This model: %" PRId64 " as %s, in %" PRId64 " lanes.\n", s->elements,
               lar_kernel_kind_name[s->kind], s->lanes);
    }
}

static void print_sent(const requirements_report *p) {
    const lar_quantities *q = &p->r->quantities;
    double estimate = 8 * lar_formula_values(LAR_METHOD_HOURGLASS, q);
    printf("\nSENT in a step by all %d processors (counted from the schedules)\n"
           "  %-10s%12s%12s%14s%14s%20s\n",
           (int)q->n_p, "scheme", "vectors", "packets", "bytes", "bytes/s", "of one, at most");
    for (int i = 0; i < LAR_REQUIREMENTS_SCHEMES; i++) {
        const lar_requirements_sent *s = &p->r->sent[i];
        printf("  %-10s%12" PRId64 "%12" PRId64 "%14" PRId64 "%14s%20" PRId64 "\n", s->scheme,
               s->vectors, s->packets, s->bytes, scale((double)s->bytes / q->step_ex, 4).text,
               s->bytes_max);
    }
    printf("  Eq. 4.8 estimates %.0f bytes, %s/s, without the 16 bytes at the ends of each packet.",
           estimate, scale(estimate / q->step_ex, 4).text);
    if (p->thesis)
        printf("\n  The thesis counts 40 kB, 400 MB/s, in its own distribution (T 4.3).");
    printf("\n");
}

static void print_cores(const requirements_report *p) {
    const lar_requirements *r = p->r;
    double step = r->quantities.step_ex;
    printf("\nNEEDED to be as fast as the clock (%s)\n  %-14s%14s%12s%12s%14s%10s\n",
           r->measured ? "counted; step and cores measured on one core of this machine, now"
                       : "counted",
           "element", "operations/s", "flop/s", "bytes/s", "step [us]", "cores");
    for (int k = 0; k < LAR_NEEDS; k++) {
        const lar_requirements_kernel *n = &r->kernel[k];
        printf("  %-14s%14s%12s%12s", n->name, scale(n->operations / step, 4).text,
               scale(n->floating / step, 4).text, scale(n->bytes / step, 4).text);
        if (r->measured)
            printf("%14.2f%10s\n", 1e6 * n->seconds, scale(n->seconds / step, 3).text);
        else
            printf("%14s%10s\n", "-", "-");
    }
    if (r->measured) {
        double rule = lar_formula_operations(LAR_METHOD_HOURGLASS, &r->quantities) / step /
                      (r->peak_gflops * 1e9 / 3);
        printf("  This core: %.1f Gflop/s at most (%s); %.2f ns per element in a block of general "
               "elements.\n  By the thesis's rule, a third of the peak, eq. 4.12 asks for %s of "
               "these cores.\n",
               r->peak_gflops, r->isa, r->nanoseconds, scale(rule, 3).text);
    } else if (r->why_not.status) {
        printf("  Not measured: %s\n", r->why_not.message);
    }
}

void requirements_print(const requirements_report *p) {
    if (p->title)
        printf("%s: %.0f elements, %d x %d x %d processors\n\n", p->title, p->r->quantities.n_el,
               (int)p->r->grid[0], (int)p->r->grid[1], (int)p->r->grid[2]);
    print_quantities(p);
    print_elements(p);
    print_methods(p);
    print_vectors(p);
    print_kernels(p);
    if (!p->title) return;
    print_sent(p);
    print_cores(p);
}
