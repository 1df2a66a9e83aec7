/* short_slices COMMAND...: runs a command whose processes take turns ten times as often as Linux
 * lets them by itself, every 0.1 ms.
 *
 * Processors of a simulation that wait for each other let others have their core (sched_yield), who
 * keep it for a whole slice. With another test on the same core that is 1 to 3 ms for every
 * exchange of a step of microseconds: 1,000 steps on two processors took 5 s instead of 0.8 s, and
 * 2 s with short slices (docs/decisions.md, 102). Linux has slices of a process's own since 6.12;
 * before, and where it does not allow them, the command runs as it is. */
#include <stdint.h>
#include <stdio.h>
#include <sys/syscall.h>
#include <unistd.h>

/* As the kernel has it; older headers have neither. */
typedef struct scheduling {
    uint32_t size, policy;
    uint64_t flags;
    int32_t nice;
    uint32_t priority;
    uint64_t runtime, deadline, period; /* [ns] runtime: the slice, inherited by children */
} scheduling;

enum { SLICE = 100000 /* [ns] the shortest that there is */, OTHERS = 0 /* SCHED_OTHER */ };

int main(int argc, char **argv) {
    if (argc < 2) {
        fprintf(stderr, "short_slices: the command is missing: short_slices COMMAND...\n");
        return 2;
    }
    scheduling own = {0};
    if (!syscall(SYS_sched_getattr, 0, &own, sizeof own, 0) && own.policy == OTHERS &&
        own.runtime > SLICE) {
        own.size = sizeof own;
        own.runtime = SLICE;
        own.deadline = own.period = 0;
        syscall(SYS_sched_setattr, 0, &own, 0); /* refused: slices stay as they are */
    }
    execvp(argv[1], argv + 1);
    perror(argv[1]);
    return 127;
}
