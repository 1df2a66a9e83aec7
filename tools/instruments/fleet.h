/* Processors as processes are, within this one: each in a thread, with its own simulation, and they
 * talk to each other by messages. */
#ifndef LAR_INSTRUMENTS_FLEET_H
#define LAR_INSTRUMENTS_FLEET_H

#include <pthread.h>

#include "comm/comm.h"

enum { LAR_FLEET_MAX = 64 };

typedef struct lar_fleet_member {
    const lar_model *model; /* lent */
    lar_options options;
    pthread_t thread;
} lar_fleet_member;

typedef struct lar_fleet {
    int count; /* of processors that were started: 1, 2, ... */
    char master[LAR_COMM_ADDRESS_TEXT];
    lar_fleet_member member[LAR_FLEET_MAX];
} lar_fleet;

/* Starts all processors of options->grid but number zero, which talk by `comm`, and sets in
 * *options what number zero needs to meet them. */
lar_status lar_fleet_start(lar_fleet *fleet, const lar_model *model, const char *comm,
                           lar_options *options, lar_error *error);

/* Waits until they have gone, which they do when number zero's simulation is destroyed. */
void lar_fleet_join(lar_fleet *fleet);

#endif
