#include "study/verify.h"

#include "parallel/division.h"
#include "parallel/verification.h"
#include "model/model.h"

enum { LISTED_MIN = 20, SEED = 1 };

/* ---- schedules ------------------------------------------------------------------------------ */

lar_status lar_verify_schedules(const lar_verify_setting *setting, lar_verify_report *report,
                                lar_error *error) {
    lar_division division = {0};
    lar_incidence incidence = {0};
    const lar_mesh *mesh = &setting->model->mesh;
    lar_status status = lar_division_create(setting->model, &setting->options, &division, error);
    if (!status) status = lar_incidence_build(mesh, &incidence, error);
    if (!status)
        status = lar_schedule_prove(mesh, &incidence, &division.schedules, &report->proof, error);
    lar_incidence_clear(&incidence);
    lar_division_destroy(&division);
    return status;
}

/* ---- lists and forces ------------------------------------------------------------------------ */

static lar_options options_for(const lar_verify_setting *setting, bool lists) {
    lar_options options = setting->options;
    options.verify = lists;
    if (lists && options.delays == 0) options.delays = SEED;
    return options;
}

/* Runs and tells the hash, as the options say. */
static lar_status run(const lar_verify_setting *setting, const lar_options *options, uint64_t steps,
                      uint64_t *hash, lar_error *error) {
    lar_simulation *simulation = NULL;
    lar_status status =
        lar_processes_create(setting->processes, setting->model, options, &simulation, error);
    if (!status) status = lar_simulation_advance(simulation, steps, error);
    if (!status) *hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return status;
}

lar_status lar_verify_lists(const lar_verify_setting *setting, lar_verify_report *report,
                            lar_error *error) {
    lar_verification check = {0};
    lar_status status = lar_verification_create(setting->model, &check, error);
    if (status) return status;
    report->passes = check.passes;
    report->listed = check.passes > LISTED_MIN ? (uint64_t)check.passes : LISTED_MIN;
    lar_verification_destroy(&check);
    lar_options options = options_for(setting, true);
    report->seed = options.delays;
    uint64_t unmoved;
    return run(setting, &options, report->listed, &unmoved, error);
}

static lar_status run_alone(const lar_verify_setting *setting, uint64_t *hash, lar_error *error) {
    lar_simulation *simulation = NULL;
    lar_options options = lar_options_default();
    options.element = setting->options.element;
    options.isa = setting->options.isa;
    options.time_step = setting->options.time_step;
    lar_status status = lar_simulation_create(setting->model, &options, &simulation, error);
    if (!status) status = lar_simulation_advance(simulation, setting->steps, error);
    if (!status) *hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return status;
}

/* Alone last: the other processes do not wait for it. */
lar_status lar_verify_forces(const lar_verify_setting *setting, lar_verify_report *report,
                             lar_error *error) {
    uint64_t alone;
    lar_options options = options_for(setting, false);
    lar_status status = run(setting, &options, setting->steps, &report->hash, error);
    if (!status) status = run_alone(setting, &alone, error);
    if (status || alone == report->hash) return status;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "after %llu steps the state hash is %016llx, and %016llx with one processor: "
                    "a force was lost, doubled or late; report this with the scene",
                    (unsigned long long)setting->steps, (unsigned long long)report->hash,
                    (unsigned long long)alone);
}

lar_status lar_verify_serve(const lar_verify_setting *setting, lar_error *error) {
    lar_status status = LAR_OK;
    for (int lists = 1; lists >= 0 && !status; lists--) {
        lar_simulation *simulation = NULL;
        lar_options options = options_for(setting, lists);
        status =
            lar_processes_create(setting->processes, setting->model, &options, &simulation, error);
        if (!status) status = lar_simulation_serve(simulation, error);
        lar_simulation_destroy(simulation);
    }
    return status;
}
