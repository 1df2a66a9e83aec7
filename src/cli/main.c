/* lariat: the command line. One row per command; everything a command needs is in its own file. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/error.h"
#include "cli/commands.h"
#include "cli/stop.h"
#include "study/parallel.h"

const cli_command *const cli_commands[] = {
    &cli_mesh,      &cli_info,         &cli_run,     &cli_view, &cli_replay,     &cli_verify,
    &cli_partition, &cli_requirements, &cli_predict, &cli_fit,  &cli_demo_model, &cli_bench,
    &cli_device,    &cli_doctor,       &cli_help,    NULL};
enum { COUNT = sizeof cli_commands / sizeof cli_commands[0] - 1 };

void cli_print_overview(FILE *out) {
    fprintf(out,
            "lariat: real-time finite elements for soft tissue, version %s\n\n"
            "Usage: lariat COMMAND [ARGUMENTS]\n\nCommands:\n",
            lar_version());
    for (int i = 0; i < COUNT; i++)
        fprintf(out, "  %-14s%s\n", cli_commands[i]->name, cli_commands[i]->summary);
    fprintf(out, "\nlariat COMMAND --help explains one command; lariat --version prints the "
                 "version.\n\nFor a first look:\n"
                 "  lariat doctor\n"
                 "  lariat demo-model demo\n"
                 "  lariat run demo/uterus.yaml --out demo/results\n\n"
                 "Exit status: 0 success, 1 failure, 2 wrong usage, 3 an unstable run,\n"
                 "4 a run that did not come to rest, 130 interrupted.\n");
}

int cli_unknown_command(const char *name) {
    const char *names[COUNT + 1] = {NULL};
    for (int i = 0; i < COUNT; i++) names[i] = cli_commands[i]->name;
    const char *meant = cli_nearest_name(name, names);
    if (meant)
        return cli_complain(NULL, CLI_USAGE, "unknown command %s; did you mean %s?", name, meant);
    return cli_complain(NULL, CLI_USAGE, "unknown command %s; lariat --help lists them", name);
}

/* A word in the environment that no build knows is wrong usage, as behind an option. */
static int check_word(const cli_command *command, const char *variable, const char *const *words,
                      const char *list) {
    const char *wanted = getenv(variable);
    if (!wanted || !*wanted) return CLI_DONE;
    for (int i = 0; words[i]; i++)
        if (strcmp(words[i], wanted) == 0) return CLI_DONE;
    return cli_complain(command, CLI_USAGE, "%s=%.40s: expected one of %s", variable, wanted, list);
}

static int check_environment(const cli_command *command) {
    static const char *const blocks[] = {"auto", "whole", "lean", NULL};
    static const char *const ways[] = {"message", "put", NULL};
    lar_error error;
    int status = check_word(command, "LARIAT_ISA", cli_isa_names, "auto, c, neon, avx2, avx512");
    if (!status) status = check_word(command, "LARIAT_BLOCKS", blocks, "auto, whole, lean");
    if (!status) status = check_word(command, "LARIAT_UCX", ways, "message, put");
    if (!status && lar_parallel_check_environment(&error)) status = cli_refuse(command, &error);
    return status;
}

/* Tests run the commands with so much; with a quarter some crash, without a word. */
enum { STACK = 256 * 1024 /* [bytes] */ };

static int check_stack(const cli_command *command) {
    struct rlimit limit;
    if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= STACK) return CLI_DONE;
    return cli_complain(command, CLI_FAILED,
                        "the stack may have %llu KiB only, and a command needs %d; raise the limit "
                        "(ulimit -s)",
                        (unsigned long long)limit.rlim_cur / 1024, STACK / 1024);
}

static int dispatch(int argc, char **argv) {
    if (argc < 2) {
        cli_print_overview(stderr);
        return CLI_USAGE;
    }
    const char *name = argv[1];
    if (strcmp(name, "--version") == 0) {
        printf("lariat %s\n", lar_version());
        return CLI_DONE;
    }
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        cli_print_overview(stdout);
        return CLI_DONE;
    }
    for (int i = 0; i < COUNT; i++)
        if (strcmp(cli_commands[i]->name, name) == 0) {
            cli_leave_at_stop(name);
            int status = check_stack(cli_commands[i]);
            if (!status) status = check_environment(cli_commands[i]);
            return status ? status : cli_commands[i]->main(argc - 2, argv + 2);
        }
    return cli_unknown_command(name);
}

/* A closed standard stream's number would go to the next file that is opened, and our words into
 * it. What is put there instead can be read but not written: output fails, as it should. A file
 * that grows beyond the user's limit fails likewise, instead of ending the program. What hwloc
 * misses (/sys in a container), it need not say on standard error. */
static void prepare_process(void) {
    int opened = open("/dev/null", O_RDONLY);
    while (opened >= 0 && opened <= STDERR_FILENO) opened = open("/dev/null", O_RDONLY);
    if (opened >= 0) close(opened);
    signal(SIGXFSZ, SIG_IGN);
    setenv("HWLOC_HIDE_ERRORS", "2", 0);
}

int main(int argc, char **argv) {
    prepare_process();
    int status = dispatch(argc, argv);
    /* A result that did not reach its file is no success. */
    if ((fflush(stdout) == 0 && !ferror(stdout)) || status != CLI_DONE) return status;
    const char *remedy = errno == EPIPE
                             ? "what read it has ended before all was told"
                             : lar_remedy(errno, "check where it goes and the free space");
    return cli_complain(NULL, CLI_FAILED, "standard output cannot be written: %s; %s",
                        strerror(errno), remedy);
}
