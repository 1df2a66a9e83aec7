#include "cli/stop.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "cli/commands.h"
#include "study/processes.h"

volatile sig_atomic_t cli_stop_asked;

/* In handlers nothing but write() and the like may be called. */
static void say(const char *text) {
    ssize_t ignored = write(STDERR_FILENO, text, strlen(text));
    (void)ignored;
}

enum { HALF_A_SECOND = 500000000 /* [ns] */ };

/* True for the first signal. A second one, half a second later or more, ends the program; but the
 * system says in every second again that the processor time is used up. */
static bool is_first(int signal_number) {
    static int64_t asked_at; /* [ns]; atomic */
    const int64_t now = lar_clock_ns();
    int64_t never = 0;
    if (__atomic_compare_exchange_n(&asked_at, &never, now, false, __ATOMIC_RELAXED,
                                    __ATOMIC_RELAXED)) {
        cli_stop_asked = signal_number;
        return true;
    }
    if (now - never > HALF_A_SECOND && signal_number != SIGXCPU) {
        signal(signal_number, SIG_DFL);
        raise(signal_number);
    }
    return false;
}

static void ask_stop(int signal_number) {
    is_first(signal_number);
}

static char leaving[96];

static void leave(int signal_number) {
    if (lar_processes_interrupt()) {
        ask_stop(signal_number);
        return;
    }
    say(leaving);
    _exit(CLI_INTERRUPTED);
}

static void point_to_zero(int signal_number) {
    if (is_first(signal_number))
        say("\nnote: this processor goes on: Ctrl-C at processor 0 ends the run for all, with "
            "results; once more here, this one is lost and the run ends without\n");
}

static void catch_signals(void (*terminate)(int), void (*handler)(int)) {
    struct sigaction action = {.sa_handler = handler, .sa_flags = SA_RESTART};
    static const int unless_ignored[] = {SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};
    struct sigaction before;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    for (size_t i = 0; i < sizeof unless_ignored / sizeof unless_ignored[0]; i++)
        if (sigaction(unless_ignored[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(unless_ignored[i], &action, NULL);
    action.sa_handler = terminate;
    sigaction(SIGTERM, &action, NULL);
}

void cli_leave_at_stop(const char *name) {
    snprintf(leaving, sizeof leaving, "lariat %s: interrupted\n", name);
    catch_signals(leave, leave);
}

void cli_catch_stop(void) {
    catch_signals(ask_stop, ask_stop);
}

void cli_catch_stop_of_all(bool by_hand) {
    catch_signals(SIG_DFL, by_hand ? point_to_zero : ask_stop);
}
