/* How a command that takes time is asked to stop: Ctrl-C, SIGTERM, or, where they are not ignored,
 * SIGHUP (nohup ignores it), SIGUSR1, SIGUSR2 (batch systems, before the end) and SIGXCPU (the
 * processor time of `ulimit -S -t` is used up).
 *
 *     from the start     ends the command at once: one sentence, status 130
 *     cli_catch_stop     ends it with what there is: the command looks at cli_stop_asked
 *
 * A second signal then ends the program at once. One that comes within half a second of the first
 * does not count again: GNU timeout sends its own twice, to its child and to the group of it. */
#ifndef LAR_CLI_STOP_H
#define LAR_CLI_STOP_H

#include <signal.h>
#include <stdbool.h>

/* The signal that asked; 0: none has. */
extern volatile sig_atomic_t cli_stop_asked;

/* Once, for the command of that name. While processors wait for each other, a signal ends their
 * wait instead (lar_processes_interrupt), so that nothing is left behind. */
void cli_leave_at_stop(const char *name);

/* From now on there is something to end with. */
void cli_catch_stop(void);

/* A processor that is not zero. What zero has started leaves all signals to zero and never gets
 * one (processes.h). Of what a terminal sends to all of a run otherwise, zero hears it too, and
 * ends the run for all; SIGTERM, which is for one, ends this one at once. Of processors that were
 * started `by_hand`, each in its own terminal, zero hears nothing: then this one says so. */
void cli_catch_stop_of_all(bool by_hand);

#endif
