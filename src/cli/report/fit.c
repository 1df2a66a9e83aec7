#include "cli/report/fit.h"

#include <math.h>

#include "study/inverse/parameters.h"

static void print_parameter(const lar_inverse_problem *problem, const lar_inverse_result *r, int j,
                            FILE *out) {
    const lar_inverse_parameter *p = &problem->parameter[j];
    const lar_inverse_estimate *e = &r->estimate[j];
    const char *unit = lar_inverse_unit_of(problem, j);
    fprintf(out, "%-16s%s: ", p->material, p->name);
    if (r->interrupted)
        fprintf(out, "%.5g %s, the best so far\n", e->value, unit);
    else if (e->at_bound)
        fprintf(out, "%.5g%s%s, AT ITS BOUND: no answer yet\n", e->value, *unit ? " " : "", unit);
    else if (!e->told && e->profiled)
        fprintf(out, "cannot be told; between %.4g and %.4g %s everything fits\n", e->low, e->high,
                unit);
    else if (!e->told && e->given_bound)
        fprintf(out, "cannot be told while another one stands at its bound\n");
    else if (isnan(e->low))
        fprintf(out, "%.5g%s%s, no interval\n", e->value, *unit ? " " : "", unit);
    else
        fprintf(out, "%.5g%s%s, 95 %% between %.5g and %.5g%s%s\n", e->value, *unit ? " " : "",
                unit, e->low, e->high, e->profiled ? " (by its profile)" : "",
                e->given_bound ? " (given what stands at its bound)" : "");
}

static void print_correlations(const lar_inverse_problem *problem, const lar_inverse_result *r,
                               FILE *out) {
    static const double STRONG = 0.9;
    for (int i = 0; i < problem->parameters; i++)
        for (int j = 0; j < i; j++)
            if (fabs(r->correlation[i][j]) > STRONG)
                fprintf(out, "correlation     %s and %s: %.3f\n", problem->parameter[j].name,
                        problem->parameter[i].name, r->correlation[i][j]);
}

void fit_report_table(const lar_inverse_problem *problem, const lar_inverse_result *r, FILE *out) {
    for (int j = 0; j < problem->parameters; j++) print_parameter(problem, r, j, out);
    print_correlations(problem, r, out);
    for (int k = 0; k < problem->experiments; k++)
        fprintf(out, "%-16s%s: %d values, residual %.3g %s, %.2g %% of %s%s\n",
                k ? "" : "experiments", problem->experiment[k].name,
                (int)problem->experiment[k].values, r->residuals[k].rms,
                problem->experiment[k].kind < LAR_INVERSE_ASPIRATION ? "N" : "m",
                100 * r->residuals[k].relative, lar_inverse_whole(&problem->experiment[k]),
                r->residuals[k].systematic ? ", systematic" : "");
    fprintf(out, "%-16s%d simulations in %.3g s\n", r->converged ? "converged" : "NOT CONVERGED",
            r->runs, r->seconds);
    for (int i = 0; i < r->notes; i++) fprintf(out, "note            %s\n", r->note[i]);
}
