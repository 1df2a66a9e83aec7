/* short_slices COMMAND...: runs a command whose processes take turns ten times as often as Linux
 * lets them by itself, every 0.1 ms.
 *
 * Processors of a simulation that wait for each other let others have their core (sched_yield), who
 * keep it for a whole slice. With another test on the same core that is 1 to 3 ms for every
 * exchange of a step of microseconds: 1,000 steps on two processors took 5 s instead of 0.8 s, and
 * 2 s with short slices (docs/decisions.md, 102). Linux has slices of a process's own since 6.12;
 * before, and where it does not allow them, the command runs as it is. */
#include <stdio.h>
#include <unistd.h>

#include "base/thread.h"

int main(int argc, char **argv) {
    if (argc < 2) {
        fprintf(stderr, "short_slices: the command is missing: short_slices COMMAND...\n");
        return 2;
    }
    lar_thread_shorten_slice(); /* inherited by the command and its children */
    execvp(argv[1], argv + 1);
    perror(argv[1]);
    return 127;
}
