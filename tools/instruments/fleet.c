#include "fleet.h"

#include <stdio.h>

static void *serve(void *context) {
    lar_fleet_member *member = context;
    lar_simulation *simulation = NULL;
    lar_error error;
    lar_status status = lar_simulation_create(member->model, &member->options, &simulation, &error);
    if (!status) status = lar_simulation_serve(simulation, &error);
    if (status)
        fprintf(stderr, "processor %d: %s\n", (int)member->options.processor, error.message);
    lar_simulation_destroy(simulation);
    return NULL;
}

lar_status lar_fleet_start(lar_fleet *fleet, const lar_model *model, const char *comm,
                           lar_options *options, lar_error *error) {
    int of[3], listener;
    fleet->count = 0;
    if (!options->grid || sscanf(options->grid, "%dx%dx%d", &of[0], &of[1], &of[2]) != 3 ||
        of[0] < 1 || of[1] < 1 || of[2] < 1 || of[0] * of[1] * of[2] > LAR_FLEET_MAX) {
        snprintf(error->message, sizeof error->message,
                 "--comm needs a --grid XxYxZ of at most %d processors", LAR_FLEET_MAX);
        return LAR_ERROR_ARGUMENT;
    }
    lar_status status = lar_comm_listen("127.0.0.1:0", &listener, fleet->master, error);
    if (status) return status;
    options->comm = comm;
    options->master = fleet->master;
    for (int p = 1; p < of[0] * of[1] * of[2]; p++) {
        lar_fleet_member *member = &fleet->member[p];
        *member = (lar_fleet_member){.model = model, .options = *options};
        member->options.processor = p;
        if (pthread_create(&member->thread, NULL, serve, member)) break;
        fleet->count++;
    }
    options->listener = listener;
    return LAR_OK;
}

void lar_fleet_join(lar_fleet *fleet) {
    for (int p = 1; p <= fleet->count; p++) pthread_join(fleet->member[p].thread, NULL);
    fleet->count = 0;
}
