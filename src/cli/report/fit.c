#include "cli/report/fit.h"

#include <math.h>

#include "base/json/write.h"
#include "study/inverse/parameters.h"

static const char *unit_of(const lar_inverse_problem *problem, int j) {
    const lar_inverse_parameter *p = &problem->parameter[j];
    return lar_inverse_unit(lar_inverse_material(problem, p->material), p->name);
}

/* ---- for machines --------------------------------------------------------------------------- */

static void write_parameters(lar_json *json, const lar_inverse_problem *problem,
                             const lar_inverse_result *r) {
    lar_json_open(json, "parameters", '[');
    for (int j = 0; j < problem->parameters; j++) {
        const lar_inverse_parameter *p = &problem->parameter[j];
        const lar_inverse_estimate *e = &r->estimate[j];
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "material", p->material);
        lar_json_text(json, "parameter", p->name);
        lar_json_text(json, "unit", unit_of(problem, j));
        lar_json_number(json, "value", e->value);
        lar_json_number(json, "low", e->low);
        lar_json_number(json, "high", e->high);
        lar_json_boolean(json, "told", e->told);
        lar_json_boolean(json, "profiled", e->profiled);
        lar_json_boolean(json, "at_bound", e->at_bound);
        lar_json_number(json, "sensitivity", e->sensitivity);
        lar_json_number(json, "guess", p->guess);
        lar_json_number(json, "lower_bound", p->low);
        lar_json_number(json, "upper_bound", p->high);
        lar_json_vector(json, "correlation", r->correlation[j], problem->parameters);
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void write_experiments(lar_json *json, const lar_inverse_problem *problem,
                              const lar_inverse_result *r) {
    const double *model = r->model;
    lar_json_open(json, "experiments", '[');
    for (int k = 0; k < problem->experiments; model += problem->experiment[k++].values) {
        const lar_inverse_experiment *e = &problem->experiment[k];
        const lar_inverse_residuals *left = &r->residuals[k];
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "name", e->name);
        lar_json_text(json, "kind", lar_inverse_kind_name[e->kind]);
        lar_json_text(json, "scene", e->scene);
        lar_json_text(json, "data", e->data);
        lar_json_boolean(json, "in_time", e->in_time);
        lar_json_integer(json, "values", e->values);
        lar_json_number(json, "noise", e->noise);
        lar_json_number(json, "rms", left->rms);
        lar_json_number(json, "relative", left->relative);
        lar_json_integer(json, "sign_runs", left->runs);
        lar_json_number(json, "sign_runs_z", left->runs_z);
        lar_json_number(json, "lag", left->lag);
        lar_json_boolean(json, "systematic", left->systematic);
        lar_json_vector(json, "measured", e->measured, e->values);
        lar_json_vector(json, "model", model, e->values);
        lar_json_close(json);
    }
    lar_json_close(json);
}

void fit_report_json(const lar_inverse_problem *problem, const lar_inverse_result *r, FILE *out) {
    lar_json json = lar_json_to(out);
    lar_json_text(&json, "file", problem->path);
    lar_json_text(&json, "title", problem->title);
    lar_json_boolean(&json, "converged", r->converged);
    lar_json_boolean(&json, "interrupted", r->interrupted);
    lar_json_integer(&json, "values", r->values);
    lar_json_integer(&json, "runs", r->runs);
    lar_json_number(&json, "wall_time", r->seconds);
    lar_json_number(&json, "deviation", r->deviation);
    write_parameters(&json, problem, r);
    write_experiments(&json, problem, r);
    lar_json_open(&json, "notes", '[');
    for (int i = 0; i < r->notes; i++) lar_json_text(&json, NULL, r->note[i]);
    lar_json_close(&json);
    lar_json_end(&json);
}

/* ---- for people ----------------------------------------------------------------------------- */

static void print_parameter(const lar_inverse_problem *problem, const lar_inverse_result *r, int j,
                            FILE *out) {
    const lar_inverse_parameter *p = &problem->parameter[j];
    const lar_inverse_estimate *e = &r->estimate[j];
    const char *unit = unit_of(problem, j);
    fprintf(out, "%-16s%s: ", p->material, p->name);
    if (r->interrupted)
        fprintf(out, "%.5g %s, the best so far\n", e->value, unit);
    else if (e->at_bound)
        fprintf(out, "%.5g%s%s, AT ITS BOUND: no answer yet\n", e->value, *unit ? " " : "", unit);
    else if (!e->told && e->profiled)
        fprintf(out, "cannot be told; between %.4g and %.4g %s everything fits\n", e->low, e->high,
                unit);
    else if (isnan(e->low))
        fprintf(out, "%.5g %s\n", e->value, unit);
    else
        fprintf(out, "%.5g%s%s, 95 %% between %.5g and %.5g%s\n", e->value, *unit ? " " : "", unit,
                e->low, e->high, e->profiled ? " (by its profile)" : "");
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
        fprintf(out, "%-16s%s: %d values, residual %.3g %s, %.2g %% of the largest%s\n",
                k ? "" : "experiments", problem->experiment[k].name,
                (int)problem->experiment[k].values, r->residuals[k].rms,
                problem->experiment[k].kind < LAR_INVERSE_ASPIRATION ? "N" : "m",
                100 * r->residuals[k].relative, r->residuals[k].systematic ? ", systematic" : "");
    fprintf(out, "%-16s%d simulations in %.3g s\n", r->converged ? "converged" : "NOT CONVERGED",
            r->runs, r->seconds);
    for (int i = 0; i < r->notes; i++) fprintf(out, "note            %s\n", r->note[i]);
}
