/* What would let a body rest that did not come to rest in its time. */
#ifndef LAR_CLI_REPORT_REST_REMEDY_H
#define LAR_CLI_REPORT_REST_REMEDY_H

#include <stdbool.h>

#include "lariat.h"

enum { REST_REMEDY_SIZE = 192 };

/* Of what is known of a body that is not at rest: its `kinetic` energy now [J], as lar_energy has
 * it, its damping [1/s], its step [s] and whether bodies touch. A constant, or what it writes into
 * `text`. */
const char *rest_remedy(const lar_rest *rest, double kinetic, double damping, double time_step,
                        bool touching, char text[REST_REMEDY_SIZE]);

#endif
