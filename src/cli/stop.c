#include "cli/stop.h"

#include <stddef.h>
#include <unistd.h>

volatile sig_atomic_t cli_stop_asked;

static void ask_stop(int signal_number) {
    cli_stop_asked = signal_number;
}

/* Nothing but write() may be called here. */
static void point_to_zero(int signal_number) {
    static const char text[] =
        "\nnote: this processor goes on: Ctrl-C at processor 0 ends the run for all, with results; "
        "once more here, this one is lost and the run ends without\n";
    cli_stop_asked = signal_number;
    ssize_t ignored = write(STDERR_FILENO, text, sizeof text - 1);
    (void)ignored;
}

static void catch_signals(bool terminate, void (*handler)(int)) {
    struct sigaction action = {.sa_handler = handler, .sa_flags = SA_RESTART | SA_RESETHAND};
    struct sigaction hangup;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    if (terminate) sigaction(SIGTERM, &action, NULL);
    if (sigaction(SIGHUP, NULL, &hangup) == 0 && hangup.sa_handler != SIG_IGN)
        sigaction(SIGHUP, &action, NULL);
}

void cli_catch_stop(void) {
    catch_signals(true, ask_stop);
}

void cli_catch_stop_of_all(bool by_hand) {
    catch_signals(false, by_hand ? point_to_zero : ask_stop);
}
