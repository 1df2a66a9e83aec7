/* What this build can do, and what this machine is good for: what `lariat doctor` tells.
 *
 *     parts      one row for each optional library: built in? works here? how to get it
 *     machine    cores, instruction set, memory, whether threads may have real-time priority
 *     measured   how late a thread wakes, how long a step takes, and from both how many elements
 *                keep pace with the clock, and how many fit into memory
 *
 * How many keep pace. Of the same body in smaller elements a step takes N elements' time, and its
 * length goes with the edge, as N^(-1/3):
 *
 *     N s = LOAD h1 (N1 / N)^(1/3)     s: time per element, h1, N1: step and elements of the
 *                                      demonstration organ
 *
 * so N = (LOAD h1 N1^(1/3) / s)^(3/4). It holds for a body of that organ's size and stiffness; a
 * larger or softer one holds more.
 */
#ifndef LAR_STUDY_DOCTOR_H
#define LAR_STUDY_DOCTOR_H

#include <stdbool.h>

#include "study/bench/jitter.h"
#include "study/machine.h"

typedef struct lar_feature {
    const char *name;  /* "nifti" */
    const char *gives; /* what can be done with it */
    const char *get;   /* how to get it, when it is not there */
    bool there;        /* built in, and it works here */
} lar_feature;

enum { LAR_FEATURES = 13 };

/* The optional parts, always the same rows in the same order. */
void lar_features_look(lar_feature feature[LAR_FEATURES]);

typedef struct lar_doctor_machine {
    lar_machine machine;
    int32_t usable_cores; /* that this process may use */
    double memory, free;  /* of the machine, and what a new program may have of it [bytes]; 0:
                             unknown */
    bool priority;        /* threads may have real-time priority */
    double clock_tick;    /* resolution of the clock [s] */
} lar_doctor_machine;

void lar_doctor_look(lar_doctor_machine *machine);

typedef struct lar_doctor_measured {
    lar_percentiles late; /* a thread that should wake every millisecond does so late [us] */
    double missed;        /* ticks that ended after the next was due, 0..1 */
    double step;          /* of the demonstration organ, on one core [s] */
    double time_step;     /* that it stands for [s] */
    int32_t elements;     /* of that organ */
    double bytes;         /* of memory per element */
    double holds;         /* elements in real time on one core */
    double fits;          /* elements in memory; 0: unknown */
} lar_doctor_measured;

/* Takes two or three seconds. Fails as creating and advancing a simulation fails. */
lar_status lar_doctor_measure(const lar_doctor_machine *machine, lar_doctor_measured *measured,
                              lar_error *error);

#endif
