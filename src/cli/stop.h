/* How a command that takes time is asked to stop. */
#ifndef LAR_CLI_STOP_H
#define LAR_CLI_STOP_H

#include <signal.h>
#include <stdbool.h>

/* The signal that asked; 0: none has. */
extern volatile sig_atomic_t cli_stop_asked;

/* The first Ctrl-C (or SIGTERM, or SIGHUP where it is not ignored, as under nohup) ends the command
 * with what there is: it looks at cli_stop_asked. A second one ends the program at once. */
void cli_catch_stop(void);

/* A processor that is not zero: of what a terminal sends to all of a run, zero hears it too, and
 * ends the run for all. SIGTERM, which is for one, ends this one at once. Of processors that were
 * started `by_hand`, each in its own terminal, zero hears nothing: then this one says so. */
void cli_catch_stop_of_all(bool by_hand);

#endif
