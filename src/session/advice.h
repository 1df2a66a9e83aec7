/* Why a session runs in slow motion, and what to do about it.
 *
 *     least time of a step      |=====|
 *     time that it stands for   |========|  divided by the pace    it fits: the machine is busy
 *     least time of a step      |============|                     it does not: the model is too
 *                                                                  large, or steps are divided
 *
 * Of the steps of the last second the one that had least of a processor tells what a step takes
 * when nothing is in its way. It is the engine's thread whose time is taken: while other programs
 * have its core it has none.
 */
#ifndef LAR_SESSION_ADVICE_H
#define LAR_SESSION_ADVICE_H

#include <stdbool.h>

#include "lariat.h"

/* What the advice depends on, and is constant. */
typedef struct lar_advice {
    double time_step; /* [s] */
    int32_t elements;
    int32_t processors;
    int32_t busy, cores; /* threads that compute; cores of this machine that they may use */
    int priority;        /* lar_session_options.priority */
    int32_t stiffer;     /* not constant: parts of a step that stiffer materials take; 0, 1: none */
    bool touched;        /* not constant: somebody pulls or presses */
} lar_advice;

/* A number of elements that is an estimate: two digits, rounded down; at least 1. */
double lar_two_digits(double count);

/* Fills in slow_cause and slow_advice, from slow_motion, step_min and step_parts. `pace`: as
 * asked for. */
void lar_advise(const lar_advice *advice, double pace, lar_session_status *status);

#endif
