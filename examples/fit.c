/* Parameters of a tissue from an experiment, inside another program: values with intervals, and
 * what to make of them. cc fit.c $(pkg-config --cflags --libs lariat-fit) -o fit && ./fit
 * fit_tension.yaml fitted */
#include <lariat_fit.h>
#include <stdio.h>
#include <time.h>

/* Ends with the best so far when it has taken too long. */
static int look(void *context, const lar_fit_progress *progress) {
    fprintf(stderr, "%s: %d simulations, residual %.3g\n", progress->doing, (int)progress->runs,
            progress->residual);
    return time(NULL) > *(const time_t *)context;
}

static void print_parameter(const lar_fit_parameter_info *p) {
    printf("%s %s: %.5g%s%s, ", p->material, p->name, p->value, *p->unit ? " " : "", p->unit);
    if (p->at_bound)
        printf("at its bound: no answer yet\n");
    else if (p->told)
        printf("95 %% between %.5g and %.5g\n", p->low, p->high);
    else
        printf("which these data cannot tell\n");
}

static int print_answer(const lar_fit *fit, lar_error *error) {
    lar_fit_info info;
    lar_fit_parameter_info parameter;
    lar_fit_experiment_info experiment;
    if (lar_fit_inspect(fit, &info, error)) return 1;
    for (int32_t j = 0; j < info.parameters; j++) {
        if (lar_fit_parameter(fit, j, &parameter, error)) return 1;
        print_parameter(&parameter);
        for (int32_t i = 0; i < j; i++)
            printf("  correlates with %d by %.3f\n", (int)i, lar_fit_correlation(fit, i, j));
    }
    for (int32_t k = 0; k < info.experiments; k++) {
        if (lar_fit_experiment(fit, k, &experiment, error)) return 1;
        printf("%s: %d values, the last one %.4g, of the model %.4g\n", experiment.name,
               (int)experiment.values, experiment.measured[experiment.values - 1],
               experiment.model[experiment.values - 1]);
    }
    printf("%s after %d simulations in %.3g s\n", info.converged ? "converged" : "not converged",
           (int)info.runs, info.seconds);
    for (int32_t i = 0; i < info.notes; i++) printf("note: %s\n", lar_fit_note(fit, i));
    return 0;
}

int main(int argc, char **argv) {
    lar_error error;
    lar_fit *fit = NULL;
    lar_fit_options options = lar_fit_options_default();
    time_t latest = time(NULL) + 3600;
    options.progress = look;
    options.context = &latest;
    int failed = lar_fit_open(argc > 1 ? argv[1] : "fit_tension.yaml", &fit, &error) ||
                 lar_fit_run(fit, &options, &error) || print_answer(fit, &error) ||
                 (argc > 2 && lar_fit_write(fit, argv[2], &error));
    if (failed) fprintf(stderr, "%s\n", error.message);
    lar_fit_destroy(fit);
    return failed;
}
