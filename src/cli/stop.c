#include "cli/stop.h"

#include <stdbool.h>
#include <stddef.h>

volatile sig_atomic_t cli_stop_asked;

static void ask_stop(int signal_number) {
    cli_stop_asked = signal_number;
}

static void catch_signals(bool terminate) {
    struct sigaction action = {.sa_handler = ask_stop, .sa_flags = SA_RESTART | SA_RESETHAND};
    struct sigaction hangup;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    if (terminate) sigaction(SIGTERM, &action, NULL);
    if (sigaction(SIGHUP, NULL, &hangup) == 0 && hangup.sa_handler != SIG_IGN)
        sigaction(SIGHUP, &action, NULL);
}

void cli_catch_stop(void) {
    catch_signals(true);
}

void cli_catch_stop_of_all(void) {
    catch_signals(false);
}
