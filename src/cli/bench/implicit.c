/* lariat bench implicit: the same slow loading, implicitly and explicitly. */
#include <inttypes.h>
#include <stdio.h>

#include "cli/bench/frame.h"
#include "cli/commands.h"
#include "study/implicit/bench_implicit.h"

static const char *const case_names[] = {"slow", "buckle", "loose", NULL};
static const char *const solver_names[] = {"own", "cg", "bcgs", NULL};
static const char *const preconditioner_names[] = {"jacobi", "icc", "ilu", "gamg", NULL};

typedef struct implicit_settings {
    const char *scene; /* NULL: the case */
    int which, solver, preconditioner;
    int64_t halvings;
    lar_bench_implicit_options options;
    bench_frame frame;
} implicit_settings;

/* Seconds by the clock for a simulated second. */
static double explicit_pace(const lar_bench_implicit_result *r) {
    return r->explicit_seconds / r->until;
}

static double implicit_pace(const lar_bench_implicit_result *r) {
    return r->reached > 0 ? r->implicit_seconds / r->reached : 0;
}

static void write_implicit(lar_json *json, const implicit_settings *s,
                           const lar_bench_implicit_result *r) {
    lar_json_open(json, "implicit", '{');
    lar_json_text(json, "solver", r->solver);
    lar_json_boolean(json, "static", s->options.implicit.quasi_static);
    lar_json_number(json, "time_step", s->options.implicit.time_step);
    lar_json_integer(json, "steps", r->tally.steps);
    lar_json_integer(json, "newton_iterations", r->tally.newton);
    lar_json_integer(json, "linear_iterations", r->tally.linear);
    lar_json_integer(json, "halved", r->tally.halved);
    lar_json_integer(json, "searched", r->tally.searches);
    lar_json_integer(json, "rows", r->rows);
    lar_json_integer(json, "values", r->values);
    lar_json_number(json, "seconds", r->implicit_seconds);
    lar_json_number(json, "assembly_seconds", r->tally.assembly);
    lar_json_number(json, "solving_seconds", r->tally.solving);
    lar_json_number(json, "seconds_per_second", implicit_pace(r));
    lar_json_boolean(json, "failed", r->failed);
    lar_json_number(json, "reached", r->reached);
    lar_json_text(json, "reason", r->reason);
    lar_json_close(json);
}

static void write_json(const implicit_settings *s, const lar_bench_implicit_result *r) {
    lar_json json = bench_open_json(&s->frame);
    lar_json_text(&json, "title", r->info.title);
    lar_json_integer(&json, "elements", r->info.elements);
    lar_json_integer(&json, "nodes", r->info.nodes);
    lar_json_integer(&json, "left_out", r->left_out);
    lar_json_number(&json, "simulated", r->until);
    lar_json_number(&json, "largest", r->largest);
    lar_json_number(&json, "apart", r->apart);
    lar_json_number(&json, "kinetic_most", r->kinetic_max);
    lar_json_open(&json, "explicit", '{');
    lar_json_number(&json, "time_step", r->explicit_step);
    lar_json_integer(&json, "steps", (int64_t)r->explicit_steps);
    lar_json_number(&json, "seconds", r->explicit_seconds);
    lar_json_number(&json, "seconds_per_second", explicit_pace(r));
    lar_json_close(&json);
    write_implicit(&json, s, r);
    bench_close_json(&s->frame, &json);
}

static void print_table(const implicit_settings *s, const lar_bench_implicit_result *r) {
    const lar_implicit_tally *t = &r->tally;
    printf("%s: %d elements, %d nodes, %.4g s simulated\n",
           *r->info.title ? r->info.title : s->scene, (int)r->info.elements, (int)r->info.nodes,
           r->until);
    if (r->left_out > 0)
        printf("%-23sof %d contacts and tools, from both\n", "left out", (int)r->left_out);
    printf("%-23s%-22s%s\n", "", "explicit", "implicit");
    printf("%-23s%-22s%s, %s\n", "solver", "none", r->solver,
           s->options.implicit.quasi_static ? "quasi-static" : "Newmark");
    printf("%-23s%-22.4g%.4g\n", "time-step [s]", r->explicit_step, s->options.implicit.time_step);
    printf("%-23s%-22" PRIu64 "%" PRId64 " (%" PRId64 " of Newton, %" PRId64 " of the solver)\n",
           "steps (iterations)", r->explicit_steps, t->steps, t->newton, t->linear);
    printf("%-23s%-22s%" PRId64 " steps halved, %" PRId64 " iterations shortened\n", "trouble",
           "none", t->halved, t->searches);
    printf("%-23s%-22s%d rows, %" PRId64 " values\n", "matrix", "none", (int)r->rows, r->values);
    printf("%-23s%-22.4g%.4g (%.2g building matrices, %.2g solving)\n", "time taken [s]",
           r->explicit_seconds, r->implicit_seconds, t->assembly, t->solving);
    printf("%-23s%-22.4g%.4g\n", "per simulated second", explicit_pace(r), implicit_pace(r));
    printf("%-23s%-22.4g%.4g\n", "reached [s]", r->until, r->reached);
    if (r->failed)
        printf("The implicit way fails: %s.\n", r->reason);
    else if (r->apart >= 0)
        printf("%-23s%.3g %% of the largest displacement, %.4g m\n", "apart at the end",
               100 * r->apart, r->largest);
}

static int report(implicit_settings *s, const lar_bench_implicit_result *r) {
    lar_bench_report *report = &s->frame.report;
    lar_bench_add(report, "s", explicit_pace(r), true, "explicit.seconds_per_second");
    lar_bench_add(report, "s", implicit_pace(r), !r->failed, "implicit.seconds_per_second");
    lar_bench_add(report, "", r->apart, false, "apart");
    if (s->frame.json)
        write_json(s, r);
    else
        print_table(s, r);
    return bench_end(&s->frame);
}

/* What the figures depend on. */
static int begin(implicit_settings *s) {
    lar_bench_report *r = &s->frame.report;
    lar_bench_set_text(r, "case", s->scene ? "scene" : case_names[s->which]);
    lar_bench_set_number(r, "elements", s->options.model->mesh.element_count);
    lar_bench_set_text(r, "solver", solver_names[s->solver]);
    if (s->solver) lar_bench_set_text(r, "preconditioner", preconditioner_names[s->preconditioner]);
    lar_bench_set_number(r, "step", s->options.implicit.time_step);
    lar_bench_set_number(r, "time", s->options.until);
    lar_bench_set_text(r, "static", s->options.implicit.quasi_static ? "yes" : "no");
    return bench_begin(&s->frame);
}

static int measure(implicit_settings *s) {
    lar_bench_implicit_result result;
    lar_error error;
    s->options.linear = lar_linear_options_default();
    s->options.linear.tolerance = 1e-4; /* Newton's method mends the rest */
    s->options.linear.method = solver_names[s->solver];
    s->options.linear.preconditioner = preconditioner_names[s->preconditioner];
    s->options.implicit.tolerance = 1e-4;
    s->options.implicit.halvings_max = (int)s->halvings;
    int failure = begin(s);
    if (failure) return failure;
    lar_status status = lar_bench_implicit(&s->options, &result, &error);
    if (!status) return report(s, &result);
    return bench_abandon(&s->frame, cli_refuse(&cli_bench_implicit, &error));
}

static int open_model(implicit_settings *s) {
    lar_error error;
    if (s->scene) return cli_open_model(&cli_bench_implicit, s->scene, &s->options.model);
    if (lar_implicit_case_create((lar_implicit_case)s->which, &s->options.model, &error))
        return cli_complain(&cli_bench_implicit, CLI_FAILED, "%s", error.message);
    return CLI_DONE;
}

static int implicit_main(int argc, char **argv) {
    implicit_settings s = {.halvings = 4,
                           .which = -1,
                           .preconditioner = -1,
                           .options.implicit = lar_implicit_options_default(),
                           .frame = bench_frame_of(&cli_bench_implicit, "implicit")};
    const cli_option options[] = {
        CLI_CHOICE("--case", "NAME",
                   "without a scene: slow (default), a block pulled slowly;\nbuckle, "
                   "an arch that does; loose, a piece that nothing holds",
                   &s.which, case_names),
        CLI_FLAG("--static", "the implicit way leaves masses and damping out",
                 &s.options.implicit.quasi_static),
        CLI_REAL("--step", "S", "implicit time-step (0.01)", &s.options.implicit.time_step, 1e-6,
                 1e3),
        CLI_REAL("--time", "S", "simulated time (the scene's duration)", &s.options.until, 1e-6,
                 1e5),
        CLI_COUNT("--halvings", "N", "of an implicit step that fails (4)", &s.halvings, 0, 20),
        CLI_CHOICE("--solver", "NAME",
                   "own (default): conjugate gradients, diagonal as\npreconditioner; of PETSc: cg, "
                   "or bcgs (BiCGSTAB)",
                   &s.solver, solver_names),
        CLI_CHOICE("--preconditioner", "NAME", "of PETSc: jacobi (default), icc, ilu, gamg",
                   &s.preconditioner, preconditioner_names),
        BENCH_OPTIONS(s.frame),
        CLI_END};
    int status = cli_parse(&cli_bench_implicit, options, argc, argv, &s.scene, 1);
    if (status >= 0) return status;
    if (s.scene && s.which >= 0)
        return cli_complain(&cli_bench_implicit, CLI_USAGE, "a scene, or --case, not both");
    if (s.preconditioner >= 0 && !s.solver)
        return cli_complain(&cli_bench_implicit, CLI_USAGE,
                            "--preconditioner is for PETSc: add --solver cg or bcgs");
    if (s.which < 0) s.which = 0;
    if (s.preconditioner < 0) s.preconditioner = 0;
    status = open_model(&s);
    if (!status) status = measure(&s);
    lar_model_destroy(s.options.model);
    return status;
}

const cli_command cli_bench_implicit = {
    .name = "bench implicit",
    .summary = "the same slow loading, implicitly and explicitly",
    .arguments = "[SCENE]",
    .description =
        "Integrates a model twice: by the engine, and with implicit time-steps (Newmark, Newton,\n"
        "sparse matrices), and sets answers and times beside each other. The implicit way knows\n"
        "neither contact nor tools: both do without. That it finds no solution is a result, too.\n"
        "PETSc is used where Lariat was built with it (install petsc-dev).",
    .examples = "  lariat bench implicit\n"
                "  lariat bench implicit --case buckle --static --step 0.02\n"
                "  lariat bench implicit --case loose --static\n"
                "  lariat bench implicit demo/uterus.yaml --time 0.1 --step 0.005\n",
    .main = implicit_main};
