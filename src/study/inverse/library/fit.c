/* lariat_fit.h: a fit for programs. All that it does is study/inverse's, as for the command. */
#include "lariat_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "simulation/lent.h"
#include "study/inverse/forward.h"
#include "study/inverse/inverse.h"
#include "study/inverse/output.h"
#include "study/inverse/parameters.h"

struct lar_fit {
    lar_inverse_problem problem;
    lar_inverse_result result;  /* of the last run that had one */
    bool done;                  /* there is one */
    volatile sig_atomic_t stop; /* asked for; atomic */
};

/* ---- structs that grow (session/sizes.c) ----------------------------------------------------- */

/* Nothing where there is no place. */
static void give(void *place, size_t size, const void *all, size_t known) {
    if (!place) return;
    memcpy(place, all, size < known ? size : known);
    if (size > known) memset((char *)place + known, 0, size - known);
}

static lar_status take(lar_fit_options *all, const lar_fit_options *given, size_t size,
                       lar_error *error) {
    if (!given) return LAR_OK;
    memcpy(all, given, size < sizeof *all ? size : sizeof *all);
    for (size_t i = sizeof *all; i < size; i++)
        if (((const unsigned char *)given)[i])
            return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                            "the program sets members of a lar_fit_options that Lariat %s does not "
                            "know; leave them 0, or use the version that the program was made with",
                            lar_version());
    return LAR_OK;
}

/* ---- opening --------------------------------------------------------------------------------- */

/* Both libraries share structs. Nothing of the other one is called before this. */
static lar_status check_engine(lar_error *error) {
    const lar_lent *lent = &lar_lent_to_fit;
    if (strcmp(lent->version, LAR_VERSION) == 0 && lent->size == sizeof *lent &&
        lent->model == sizeof(lar_model) && lent->simulation == sizeof(lar_simulation))
        return LAR_OK;
    if (error) {
        error->status = LAR_ERROR_UNSUPPORTED;
        snprintf(error->message, sizeof error->message,
                 "liblariat-fit is of version %s and liblariat of %s, or of another build; install "
                 "both together",
                 LAR_VERSION, lent->version);
    }
    return LAR_ERROR_UNSUPPORTED;
}

static lar_status create(lar_fit **fit, lar_error *error) {
    *fit = lar_calloc(1, sizeof **fit);
    return *fit ? LAR_OK : lar_fail_memory(error, sizeof **fit, "a fit");
}

lar_status lar_fit_open(const char *path, lar_fit **fit, lar_error *error) {
    lar_fit *made = NULL;
    lar_status status = check_engine(error);
    if (status) return status;
    if (!path || !fit)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_fit_open needs the path of an experiment file and a place for the "
                        "fit, not NULL");
    status = create(&made, error);
    if (!status) status = lar_inverse_problem_read(path, &made->problem, error);
    if (status)
        lar_fit_destroy(made);
    else
        *fit = made;
    return status;
}

lar_status lar_fit_from_text(const char *text, const char *folder, lar_fit **fit,
                             lar_error *error) {
    lar_fit *made = NULL;
    lar_status status = check_engine(error);
    if (status) return status;
    if (!text || !fit)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_fit_from_text needs the text of an experiment file and a place for "
                        "the fit, not NULL");
    const lar_bytes bytes = {.data = (unsigned char *)lar_strdup(text), .size = strlen(text)};
    char *path = folder ? lar_folder_join(folder, "experiment") : lar_strdup("experiment");
    status = bytes.data && path ? create(&made, error) : lar_fail_memory(error, bytes.size, "text");
    if (!status) status = lar_inverse_problem_parse(path, &bytes, &made->problem, error);
    free(bytes.data);
    free(path);
    if (status)
        lar_fit_destroy(made);
    else
        *fit = made;
    return status;
}

void lar_fit_destroy(lar_fit *fit) {
    if (!fit) return;
    lar_inverse_problem_clear(&fit->problem);
    lar_inverse_result_clear(&fit->result);
    free(fit);
}

/* ---- fitting --------------------------------------------------------------------------------- */

void lar_fit_options_default_sized(lar_fit_options *options, size_t size) {
    const lar_fit_options all = {.workers = 0};
    give(options, size, &all, sizeof all);
}

typedef struct listener {
    lar_fit *fit;
    lar_fit_options options;
} listener;

static void hear(void *context, const lar_inverse_progress *p) {
    const listener *l = context;
    const lar_fit_progress progress = {
        .doing = p->doing, .runs = p->runs, .residual = p->residual, .remaining = p->remaining};
    if (l->options.progress(l->options.context, &progress)) lar_fit_stop(l->fit);
}

static lar_status run(lar_fit *fit, listener *l, lar_error *error) {
    const lar_inverse_options options = {.stop = &fit->stop,
                                         .progress = l->options.progress ? hear : NULL,
                                         .context = l,
                                         .workers = l->options.workers};
    lar_inverse_result *result = lar_calloc(1, sizeof *result);
    if (!result) return lar_fail_memory(error, sizeof *result, "a fit");
    lar_status status = lar_inverse_solve(&fit->problem, &options, result, error);
    if (status && lar_inverse_stop_asked(&fit->stop))
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "%s: stopped before the first guess was computed: there is no answer",
                          fit->problem.path);
    if (!status) {
        lar_inverse_result_clear(&fit->result);
        fit->result = *result;
        fit->done = true;
    } else {
        lar_inverse_result_clear(result);
    }
    free(result);
    __atomic_store_n(&fit->stop, 0, __ATOMIC_RELAXED);
    return status;
}

static lar_status check_fit(const lar_fit *fit, const char *call, lar_error *error) {
    lar_status status = fit ? LAR_OK : check_engine(error);
    if (fit || status) return status;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%s needs a fit, not NULL", call);
}

lar_status lar_fit_run_sized(lar_fit *fit, const lar_fit_options *options, size_t size,
                             lar_error *error) {
    listener l = {.fit = fit};
    lar_status status = check_fit(fit, "lar_fit_run", error);
    if (!status) status = take(&l.options, options, size, error);
    if (!status && l.options.workers < 0)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "%d workers; give 1 or more, or 0 for one on each core",
                          (int)l.options.workers);
    return status ? status : run(fit, &l, error);
}

void lar_fit_stop(lar_fit *fit) {
    if (fit) __atomic_store_n(&fit->stop, 1, __ATOMIC_RELAXED);
}

/* ---- the answer ------------------------------------------------------------------------------ */

lar_status lar_fit_inspect_sized(const lar_fit *fit, lar_fit_info *info, size_t size,
                                 lar_error *error) {
    lar_status status = check_fit(fit, "lar_fit_inspect", error);
    if (status) return status;
    const lar_inverse_result *r = &fit->result;
    const lar_fit_info all = {.file = fit->problem.path,
                              .title = fit->problem.title,
                              .parameters = fit->problem.parameters,
                              .experiments = fit->problem.experiments,
                              .values = lar_inverse_problem_values(&fit->problem),
                              .done = fit->done,
                              .converged = r->converged,
                              .interrupted = r->interrupted,
                              .runs = r->runs,
                              .notes = r->notes,
                              .seconds = r->seconds,
                              .deviation = r->deviation};
    give(info, size, &all, sizeof all);
    return LAR_OK;
}

static lar_status check_index(const lar_fit *fit, int32_t index, int count, const char *what,
                              lar_error *error) {
    if (index >= 0 && index < count) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: there is no %s %d; they count from 0 to %d",
                    fit->problem.path, what, (int)index, count - 1);
}

lar_status lar_fit_parameter_sized(const lar_fit *fit, int32_t index, lar_fit_parameter_info *info,
                                   size_t size, lar_error *error) {
    lar_status status = check_fit(fit, "lar_fit_parameter", error);
    if (!status) status = check_index(fit, index, fit->problem.parameters, "parameter", error);
    if (status) return status;
    const lar_inverse_parameter *p = &fit->problem.parameter[index];
    const lar_inverse_estimate *e = &fit->result.estimate[index];
    lar_fit_parameter_info all = {.material = p->material,
                                  .name = p->name,
                                  .unit = lar_inverse_unit_of(&fit->problem, index),
                                  .guess = p->guess,
                                  .lower_bound = p->low,
                                  .upper_bound = p->high,
                                  .value = p->guess,
                                  .low = NAN,
                                  .high = NAN};
    if (fit->done) {
        all.value = e->value;
        all.low = e->low;
        all.high = e->high;
        all.told = e->told;
        all.profiled = e->profiled;
        all.at_bound = e->at_bound;
        all.given_bound = e->given_bound;
        all.sensitivity = e->sensitivity;
    }
    give(info, size, &all, sizeof all);
    return LAR_OK;
}

double lar_fit_correlation(const lar_fit *fit, int32_t i, int32_t j) {
    if (!fit || !fit->done || fit->result.interrupted) return NAN;
    const int count = fit->problem.parameters;
    if (i < 0 || i >= count || j < 0 || j >= count) return NAN;
    return fit->result.correlation[i][j];
}

lar_status lar_fit_experiment_sized(const lar_fit *fit, int32_t index,
                                    lar_fit_experiment_info *info, size_t size, lar_error *error) {
    lar_status status = check_fit(fit, "lar_fit_experiment", error);
    if (!status) status = check_index(fit, index, fit->problem.experiments, "experiment", error);
    if (status) return status;
    const lar_inverse_experiment *e = &fit->problem.experiment[index];
    const lar_inverse_residuals *left = &fit->result.residuals[index];
    const double *model = fit->result.model;
    for (int k = 0; k < index && model; k++) model += fit->problem.experiment[k].values;
    const lar_fit_experiment_info all = {.name = e->name,
                                         .kind = lar_inverse_kind_name[e->kind],
                                         .scene = e->scene,
                                         .data = e->data,
                                         .in_time = e->in_time,
                                         .values = e->values,
                                         .measured = e->measured,
                                         .model = model,
                                         .noise = e->noise,
                                         .rms = left->rms,
                                         .relative = left->relative,
                                         .systematic = left->systematic,
                                         .sign_runs = left->runs,
                                         .sign_runs_z = left->runs_z,
                                         .lag = left->lag};
    give(info, size, &all, sizeof all);
    return LAR_OK;
}

const char *lar_fit_note(const lar_fit *fit, int32_t index) {
    return fit && index >= 0 && index < fit->result.notes ? fit->result.note[index] : NULL;
}

/* ---- files ----------------------------------------------------------------------------------- */

static lar_status check_write(const lar_fit *fit, const char *path, const char *call,
                              lar_error *error) {
    lar_status status = check_fit(fit, call, error);
    if (status) return status;
    if (!path) return lar_fail(error, LAR_ERROR_ARGUMENT, "%s needs a path, not NULL", call);
    if (fit->done) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: there is no answer yet; call lar_fit_run first",
                    fit->problem.path);
}

lar_status lar_fit_write(const lar_fit *fit, const char *folder, lar_error *error) {
    lar_status status = check_write(fit, folder, "lar_fit_write", error);
    return status ? status : lar_inverse_write_folder(folder, &fit->problem, &fit->result, error);
}

lar_status lar_fit_write_tissue(const lar_fit *fit, const char *path, const char *material,
                                lar_error *error) {
    lar_status status = check_write(fit, path, "lar_fit_write_tissue", error);
    if (status) return status;
    const lar_inverse_problem *p = &fit->problem;
    int found = -1, different = 0;
    for (int j = 0; j < p->parameters; j++) {
        different += lar_inverse_first_of_material(p, j);
        if (!material || strcmp(material, p->parameter[j].material) == 0) found = j;
    }
    if (found < 0 || (!material && different > 1))
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: %s%s; name one whose parameters are free",
                        p->path, found < 0 ? "this fit has no material " : "more than one material",
                        found < 0 ? material : "");
    return lar_inverse_write_tissue(path, p, &fit->result, p->parameter[found].material, error);
}

lar_status lar_fit_write_svg(const lar_fit *fit, const char *path, int32_t experiment,
                             lar_error *error) {
    lar_status status = check_write(fit, path, "lar_fit_write_svg", error);
    if (!status)
        status = check_index(fit, experiment, fit->problem.experiments, "experiment", error);
    if (status) return status;
    return lar_inverse_write_svg(path, &fit->problem, &fit->result, experiment, error);
}

lar_status lar_fit_write_json(const lar_fit *fit, const char *path, lar_error *error) {
    lar_status status = check_write(fit, path, "lar_fit_write_json", error);
    return status ? status : lar_inverse_write_json(path, &fit->problem, &fit->result, error);
}
