/* Every public call with nothing but NULL and 0: none crashes. The list is made from lariat.h. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "lariat.h"
#include "null_calls.h"

enum { COUNT = sizeof calls / sizeof *calls };

static void no_call_crashes_on_null(void **unused) {
    (void)unused;
    int crashed = 0;
    assert_true(COUNT > 100);
    for (int i = 0; i < COUNT; i++) {
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            alarm(20);
            calls[i].call();
            _exit(0);
        }
        int how;
        assert_int_equal(waitpid(child, &how, 0), child);
        if (WIFEXITED(how) && WEXITSTATUS(how) == 0) continue;
        crashed++;
        print_error("%s(0, ...) %s\n", calls[i].name,
                    WIFSIGNALED(how) ? strsignal(WTERMSIG(how)) : "ended the program");
    }
    assert_int_equal(crashed, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_call_crashes_on_null)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
