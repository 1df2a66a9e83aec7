#include "study/machine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include "mechanics/hex8_block.h"

/* Linux tells the name on x86 only; elsewhere there is the architecture. */
static void find_cpu(char *cpu, size_t size) {
    char line[256];
    struct utsname system;
    snprintf(cpu, size, "%s", uname(&system) == 0 ? system.machine : "unknown");
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file)) {
        const char *name = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !name) continue;
        name += 1 + strspn(name + 1, " \t");
        snprintf(cpu, size, "%.*s", (int)strcspn(name, "\n"), name);
        break;
    }
    if (file) fclose(file);
}

double lar_machine_memory(const char *name) {
    char line[256];
    double kilobytes = 0;
    FILE *file = fopen("/proc/meminfo", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, name, strlen(name)) == 0 &&
            sscanf(line + strlen(name), ": %lf", &kilobytes) == 1)
            break;
    if (file) fclose(file);
    return 1024 * kilobytes;
}

void lar_machine_look(lar_machine *machine) {
    const lar_kernels *kernels = NULL;
    struct tm parts;
    time_t now = time(NULL);
    *machine = (lar_machine){.isa = "unknown", .date = "unknown"};
    find_cpu(machine->cpu, sizeof machine->cpu);
    machine->cores = (int32_t)sysconf(_SC_NPROCESSORS_ONLN);
    if (!lar_kernels_find(LAR_ISA_AUTO, &kernels, NULL)) machine->isa = kernels->name;
    if (getloadavg(machine->load, 3) != 3)
        for (int i = 0; i < 3; i++) machine->load[i] = -1;
    if (gmtime_r(&now, &parts))
        strftime(machine->date, sizeof machine->date, "%Y-%m-%dT%H:%M:%SZ", &parts);
}
