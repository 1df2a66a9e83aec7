#include "cli/report/mesh_quality.h"

#include <math.h>
#include <stdio.h>

/* ---- elements ------------------------------------------------------------------------------ */

/* All is said only of all, none only of none. */
static const char *share(double part, char text[16]) {
    double percent = fmin(fmax(100 * part, 0.1), 99.9);
    if (part >= 1)
        snprintf(text, 16, "all");
    else
        snprintf(text, 16, "%.1f %%", part > 0 ? percent : 0.0);
    return text;
}

void cli_print_jacobians(const lar_mesh_quality *quality) {
    enum { BINS = 10, WIDTH = 40 };
    static const char bar[WIDTH + 1] = "########################################";
    int first = 0;
    int32_t max = 1;
    char above_02[16], above_05[16];
    while (first < BINS - 1 && quality->jacobian_bin[first] == 0) first++;
    for (int b = 0; b < BINS; b++)
        if (quality->jacobian_bin[b] > max) max = quality->jacobian_bin[b];
    for (int b = first; b < BINS; b++) {
        int32_t count = quality->jacobian_bin[b];
        int length = (int)ceil((double)WIDTH * count / max);
        printf("%-17s%.1f .. %.1f %8d%s%.*s\n", "", 0.1 * b, 0.1 * (b + 1), (int)count,
               length ? " " : "", length, bar);
    }
    printf("%-17s%s of the elements are above 0.2, %s above 0.5\n", "",
           share(quality->above_02, above_02), share(quality->above_05, above_05));
}

/* ---- units ----------------------------------------------------------------------------------- */

cli_measure cli_length(double metres) {
    static const double LONG = 10, SHORT = 1e-6; /* [m] */
    const double size = fabs(metres);
    cli_measure measure;
    if (size >= LONG)
        snprintf(measure.text, sizeof measure.text, "%.4g m", metres);
    else if (size >= SHORT || size == 0)
        snprintf(measure.text, sizeof measure.text, "%.4g mm", 1e3 * metres);
    else
        snprintf(measure.text, sizeof measure.text, "%.4g um", 1e6 * metres);
    return measure;
}

cli_measure cli_volume(double cubic_metres) {
    static const double LARGE = 0.1, SMALL = 1e-9; /* [m^3] */
    cli_measure measure;
    if (cubic_metres >= LARGE)
        snprintf(measure.text, sizeof measure.text, "%.4g m^3", cubic_metres);
    else if (cubic_metres >= SMALL || cubic_metres == 0)
        snprintf(measure.text, sizeof measure.text, cubic_metres < 0.01 ? "%.4g mL" : "%.0f mL",
                 1e6 * cubic_metres);
    else
        snprintf(measure.text, sizeof measure.text, "%.4g mm^3", 1e9 * cubic_metres);
    return measure;
}

/* ---- beside the true surface ----------------------------------------------------------------- */

static void print_distance(const lar_mesh_quality *quality, double distance) {
    printf("%s (%.1f %% of an edge)", cli_length(distance).text,
           100 * distance / quality->mean_edge);
}

void cli_print_deviation(const lar_mesh_quality *quality) {
    if (quality->true_volume > 0)
        printf("%-17s%s, the true surface holds %s (%+.2f %%)\n", "volume",
               cli_volume(quality->volume).text, cli_volume(quality->true_volume).text,
               100 * (quality->volume / quality->true_volume - 1));
    if (!(quality->deviation_max > 0)) return;
    printf("%-17smean ", "deviation");
    print_distance(quality, quality->deviation_mean);
    printf(",\n%-17s95 %% of the surface below ", "");
    print_distance(quality, quality->deviation_95);
    printf(",\n%-17slargest (Hausdorff) ", "");
    print_distance(quality, quality->deviation_max);
    putchar('\n');
}

void cli_print_crossings(const lar_mesh_quality *quality) {
    printf("%-17s", "crossing");
    if (quality->crossings == 0) {
        printf("none: no outer face goes through another one\n");
        return;
    }
    printf("%d pair%s of outer faces go%s through each other, by up to ", (int)quality->crossings,
           quality->crossings == 1 ? "" : "s", quality->crossings == 1 ? "es" : "");
    print_distance(quality, quality->crossing_depth);
    putchar('\n');
}

void cli_write_quality(lar_json *json, const lar_mesh_quality *quality) {
    lar_json_open(json, "quality", '{');
    lar_json_integers(json, "jacobian_histogram", quality->jacobian_bin, 10);
    lar_json_number(json, "above_02", quality->above_02);
    lar_json_number(json, "above_05", quality->above_05);
    lar_json_number(json, "mean_edge", quality->mean_edge);
    lar_json_number(json, "volume", quality->volume);
    lar_json_number(json, "true_volume", quality->true_volume);
    lar_json_number(json, "deviation_mean", quality->deviation_mean);
    lar_json_number(json, "deviation_95", quality->deviation_95);
    lar_json_number(json, "deviation_max", quality->deviation_max);
    lar_json_integer(json, "crossings", quality->crossings);
    lar_json_number(json, "crossing_depth", quality->crossing_depth);
    lar_json_close(json);
}

/* ---- speed ----------------------------------------------------------------------------------- */

cli_speed cli_measure_speed(const lar_model *model) {
    static const double LONG = 0.1; /* [s] */
    cli_speed speed = {0};
    speed.measured = lar_real_time_measure(model, LONG, &speed.found, &speed.why) == LAR_OK;
    return speed;
}

void cli_print_speed(const cli_speed *speed) {
    const lar_real_time *found = &speed->found;
    if (!speed->measured) {
        printf("%-17snot measured: %s\n", "speed", speed->why.message);
        return;
    }
    printf("%-17s%.3g times as fast as real time on one core of this machine (a step of "
           "%.3g s\n%-17stakes %.3g us)\n",
           "speed", found->factor, found->time_step, "", 1e6 * found->step);
    if (found->choice.processors > 1)
        printf("%-17s%.3g times on the grid %s\n", "", found->divided, found->choice.grid);
    printf("%-17sabout %.0f elements of this body keep the clock with a third in reserve\n", "",
           found->holds);
}

void cli_write_speed(lar_json *json, const cli_speed *speed) {
    lar_json_open(json, "speed", '{');
    lar_json_number(json, "real_time_factor", speed->measured ? speed->found.factor : NAN);
    lar_json_number(json, "wall_per_step_us", speed->measured ? 1e6 * speed->found.step : NAN);
    lar_json_text(json, "grid", speed->measured ? speed->found.choice.grid : "");
    lar_json_number(json, "divided_factor", speed->measured ? speed->found.divided : NAN);
    lar_json_number(json, "real_time_elements", speed->measured ? speed->found.holds : NAN);
    lar_json_text(json, "why_not", speed->measured ? "" : speed->why.message);
    lar_json_close(json);
}
