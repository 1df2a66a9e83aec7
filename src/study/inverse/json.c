#include "study/inverse/json.h"

#include "base/json/write.h"
#include "study/inverse/parameters.h"

static void write_parameters(lar_json *json, const lar_inverse_problem *problem,
                             const lar_inverse_result *r) {
    lar_json_open(json, "parameters", '[');
    for (int j = 0; j < problem->parameters; j++) {
        const lar_inverse_parameter *p = &problem->parameter[j];
        const lar_inverse_estimate *e = &r->estimate[j];
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "material", p->material);
        lar_json_text(json, "parameter", p->name);
        lar_json_text(json, "unit", lar_inverse_unit_of(problem, j));
        lar_json_number(json, "value", e->value);
        lar_json_number(json, "low", e->low);
        lar_json_number(json, "high", e->high);
        lar_json_boolean(json, "told", e->told);
        lar_json_boolean(json, "profiled", e->profiled);
        lar_json_boolean(json, "at_bound", e->at_bound);
        lar_json_boolean(json, "given_bound", e->given_bound);
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

void lar_inverse_json(const lar_inverse_problem *problem, const lar_inverse_result *r, FILE *out) {
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
