#include "session/advice.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include "base/text.h"

/* Of a step's time, what is left for it: forces, pictures and waking take the rest. */
static const double ROOM = 0.9;
/* What several processors make of themselves. */
static const double EFFICIENCY = 0.8;

/* The grid of so many processors that is nearest to a cube, longest first. */
static void name_grid(int32_t processors, char text[32]) {
    int32_t best[3] = {processors, 1, 1};
    for (int32_t c = 1; c * c * c <= processors; c++)
        for (int32_t b = c; b * b * c <= processors; b++)
            if (processors % (b * c) == 0 && processors / (b * c) <= best[0]) {
                best[0] = processors / (b * c);
                best[1] = b;
                best[2] = c;
            }
    snprintf(text, 32, "%dx%dx%d", (int)best[0], (int)best[1], (int)best[2]);
}

double lar_two_digits(double count) {
    if (count < 1) return 1;
    double unit = pow(10, fmax(0, floor(log10(count)) - 1));
    return floor(count / unit) * unit;
}

/* What is no longer the same model is no advice. */
static bool is_a_mesh(double ratio, double elements) {
    static const double RATIO_MAX = 10.01, ELEMENTS_MIN = 20;
    return ratio < RATIO_MAX && elements >= ELEMENTS_MIN;
}

/* Much slower than steps of that length alone would make it. */
static bool is_busy_besides(double slower, double pace, const lar_session_status *status) {
    double now = status->real_time_factor_now;
    return now > 0 && now * slower < 0.6 * pace;
}

static void advise_smaller(const lar_advice *a, double pace, double min, double allowed,
                           lar_session_status *status) {
    double ratio = min / allowed;
    double wanted = ceil(ratio * a->busy / EFFICIENCY);
    double elements = lar_two_digits(a->elements / ratio);
    char way[48] = "", other[64];
    if (a->cores > a->busy && wanted <= a->cores) {
        char grid[32];
        name_grid((int32_t)wanted, grid);
        snprintf(way, sizeof way, "--grid %s, ", grid);
    }
    if (is_a_mesh(ratio, elements))
        snprintf(other, sizeof other, "a mesh of about %.0f elements, or a slower pace", elements);
    else
        snprintf(other, sizeof other, "%sa pace of %.2g", *way ? "or " : "", 0.95 * pace / ratio);
    snprintf(status->slow_advice, sizeof status->slow_advice,
             "a step takes %s and stands for %s of the clock; what would hold: %s%s%s",
             lar_text_time(min).text, lar_text_time(allowed / ROOM).text, way, other,
             is_busy_besides(ratio, pace, status) ? "; and other programs keep the processor busy"
                                                  : "");
}

/* Steps on several processors wait for the one whose core another program has taken: where one
 * alone is fast enough it may hold, beside a browser that takes the other cores. */
static void advise_alone(const lar_advice *a, double min, double allowed,
                         lar_session_status *status) {
    bool alone = a->processors > 1 && min * a->busy * EFFICIENCY <= allowed;
    snprintf(status->slow_advice, sizeof status->slow_advice,
             "a step takes %s of the %s that it has, but other programs keep the processor busy, "
             "here or on a virtual machine's host; end them%s%s",
             lar_text_time(min).text, lar_text_time(allowed / ROOM).text,
             alone ? ", or try --grid 1x1x1: it may hold beside a browser that draws in software"
                   : "",
             a->priority > 0 ? "" : ", or try --priority 10");
}

void lar_advise(const lar_advice *a, double pace, lar_session_status *status) {
    status->slow_cause = LAR_SLOW_NOT;
    status->slow_advice[0] = '\0';
    if (!status->slow_motion || status->step_min <= 0 || pace <= 0) return;
    double allowed = ROOM * a->time_step / pace, min = status->step_min;
    if (min > allowed && status->step_parts > 1 && min / status->step_parts <= allowed) {
        status->slow_cause = LAR_SLOW_DIVISION;
        bool stiffer = a->stiffer >= status->step_parts;
        const char *why = stiffer ? "because the body was made stiffer than the model has it; make "
                                    "it softer"
                          : a->touched
                              ? "while tissue is strained or tools press hard; let go, or pull, "
                                "press and load it less"
                              : "while tissue is strained; load it less";
        snprintf(status->slow_advice, sizeof status->slow_advice,
                 "steps are divided by %d %s, or choose a slower pace", (int)status->step_parts,
                 why);
    } else if (min > allowed) {
        status->slow_cause = LAR_SLOW_STEP;
        advise_smaller(a, pace, min, allowed, status);
    } else {
        status->slow_cause = LAR_SLOW_MACHINE;
        advise_alone(a, min, allowed, status);
    }
}
