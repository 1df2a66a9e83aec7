/* Which machine a figure is from, and what else it did at that time. */
#ifndef LAR_STUDY_MACHINE_H
#define LAR_STUDY_MACHINE_H

#include <stdint.h>

typedef struct lar_machine {
    char cpu[128];   /* the processor's name as the system gives it, else its architecture */
    int32_t cores;   /* that are there, second threads of cores included */
    const char *isa; /* the instruction set that a simulation takes when none is asked for */
    double load[3];  /* threads that ran or wanted to, over 1, 5 and 15 minutes; -1: unknown */
    char date[24];   /* 2026-11-20T15:04:05Z */
} lar_machine;

/* A line of /proc/meminfo, such as "MemAvailable", what a new program may have [bytes]; 0: there is
 * none. */
double lar_machine_memory(const char *name);

/* Now. What cannot be found out says "unknown". */
void lar_machine_look(lar_machine *machine);

#endif
