/* Activation: how much of a material's active stress (law/fibre.h) is there, from 0 to 1.
 *
 *     activation = what was set (model/settings.h)  x  curve of time  x  wave
 *
 * each of them 1 where nobody says otherwise. A wave, as that of peristalsis, is one pulse or many
 * of the shape cos^2, which travel along a direction through the body at rest:
 *
 *        1  +        _-_               place x.d of an element's centre, with the pulse's middle
 *           |      _/   \_             at  c(t) = start - length/2 + speed t:
 *     rest  +-----'       '------->
 *                 |<------>|            rest + (1 - rest) cos^2(pi (x.d - c) / length)
 *                   length
 *
 * `start` is where the material begins, so that a pulse enters it at time 0, and another one each
 * `every` seconds. Values depend on the place and the time alone and are made with + - * / and
 * floor, so that they have the same bits everywhere.
 */
#ifndef LAR_MODEL_ACTIVATION_H
#define LAR_MODEL_ACTIVATION_H

#include <stdbool.h>

typedef struct lar_wave {
    double speed;        /* [m/s], more than 0; 0: there is no wave */
    double direction[3]; /* unit vector */
    double length;       /* of a pulse [m] */
    double every;        /* from one pulse to the next [s]; 0: there is one */
    double rest;         /* activation before and behind pulses */
    double start, span;  /* where the material's first element is on its way, and how far it is from
                            there to the last one [m]; lar_model_check works them out */
} lar_wave;

typedef struct lar_activation {
    int curve; /* one more than its index in lar_model.curve; 0: none */
    lar_wave wave;
} lar_activation;

static inline bool lar_activation_varies(const lar_activation *activation) {
    return activation->curve > 0 || activation->wave.speed > 0;
}

/* Where an element with its corners there is on the way of a wave [m]. */
double lar_wave_place(const lar_wave *wave, const double corner[8][3]);

/* The wave's factor at a place [m] and a time [s]. */
double lar_wave_value(const lar_wave *wave, double place, double time);

#endif
