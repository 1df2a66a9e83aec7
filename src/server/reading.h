/* Values of one node, one element and the whole body, all of one step, for a viewer that has asked
 * for them ("inspect" of docs/viewer-protocol.md).
 *
 *     snapshot --u--> node: displacement, and the mean of its elements, as pictures have it
 *              |----> element: its own stress and energy
 *              '-v--> kinetic energy;  u --> what all elements store
 *
 * The worker makes it (work.h): the whole takes as long as a picture of one field.
 */
#ifndef LAR_SERVER_READING_H
#define LAR_SERVER_READING_H

#include <stdbool.h>
#include <stdint.h>

#include "lariat.h"

enum { LAR_READ_VALUES = 3 }; /* von Mises stress [Pa], pressure [Pa], energy density [J/m^3] */

/* What is asked for. */
typedef struct lar_question {
    int32_t node, element; /* of the model; -1: not asked for */
    bool energy;
} lar_question;

typedef struct lar_reading {
    uint64_t step;
    double time;                        /* [s] */
    double rest[3], displacement[3];    /* of the node [m] */
    double of_node[LAR_READ_VALUES];    /* 0 for a node whose elements are all inside out */
    double of_element[LAR_READ_VALUES]; /* not finite where it is inside out */
    double kinetic, strain, hourglass;  /* of all nodes and elements [J] */
} lar_reading;

/* Reads from a snapshot of the session on this simulation. */
lar_status lar_reading_take(const lar_simulation *simulation, const lar_question *question,
                            const lar_snapshot *snapshot, lar_reading *reading, lar_error *error);

#endif
