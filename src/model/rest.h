/* What a static analysis becomes: a motion that dies out (docs/theory.md has the engine's step).
 *
 * An explicit engine follows everything in time, so a static answer is the state of rest that a
 * damped body reaches under loads that no longer change. Here are the two figures that this needs
 * from the model alone: the damping, and the time on which the body answers; and what readers of
 * decks make of them.
 */
#ifndef LAR_MODEL_REST_H
#define LAR_MODEL_REST_H

#include "model/model.h"

/* Damping that lets the slowest motion die out without swinging [1/s]. Its frequency is guessed as
 * that of a shear wave in a bar as long as the body: omega = pi/2 sqrt(G / rho) / L, with the
 * longest side of the bounding box and the least G / rho; 2 omega is critical for damping in
 * proportion to mass. 0 when there is no such number. */
double lar_model_rest_damping(const lar_model *model);

/* The period of that motion, 2 pi / omega [s]; 1 when there is no such number. */
double lar_model_slow_period(const lar_model *model);

/* How long a step stays divided after it had to be, fading: strained tissue trembles, and where
 * steps become longer and shorter with it energy grows. 50 ms; that period where it is longer, and
 * nothing damps the motion; that period in decks, whose seconds may be any [s]. */
double lar_model_memory(const lar_model *model);

/* Gives the body so much more or less mass that this period becomes `period` [s], and gravity so
 * much less or more: forces and what they come to at rest stay as they are. */
void lar_model_slow_to(lar_model *model, double period);

/* What a static analysis that ends at the model's duration (0: it has no end) becomes, in a
 * sentence about the `what` that is static.
 *
 * Its answer does not depend on mass, so that is such that the body would swing two to twenty times
 * while the loads come, whatever units and durations the deck has: less, and loads would be blows;
 * more, and they would be followed wave by wave. The analysis ends with the deck's last step, and
 * so do its loads, whatever their curves would do behind it.
 *
 * With a viscous material the deck's time is the material's, and its end the answer. There mass
 * must not be felt on the way: the body answers in a hundredth of the deck, and with a tenth of
 * that damping lags behind its loads by 0.1/pi of that (2 zeta/omega); what swings at first is less
 * by exp(-2 pi 10) in the end. */
typedef struct lar_rest_words {
    char text[400];
} lar_rest_words;
lar_rest_words lar_model_follow_static(lar_model *model, const char *what);

/* Time after which no load, no prescribed value and no activation changes [s], at least 0; of what
 * comes again and again, by curves that repeat or waves, the end of the first round or nothing. */
double lar_model_loads_end(const lar_model *model);
bool lar_model_repeats(const lar_model *model);

/* What readers say of a displacement in a deck with time; %s: what to name, and by which word. */
#define LAR_DISPLACED_AT_ONCE                                                                      \
    "this displacement is there at once: the body starts with these nodes displaced, and shakes; " \
    "to ramp it, name %s that rises from 0 (%s=)"

#endif
