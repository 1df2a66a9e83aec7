/* cmocka with all it needs, and what every room's tests use. */
#ifndef LAR_TESTS_TESTING_H
#define LAR_TESTS_TESTING_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of functions in headers that not every test calls. */
#define TEST_UNUSED __attribute__((unused))

#define assert_below(value, bound)                                                                 \
    do {                                                                                           \
        double value_ = (value), bound_ = (bound);                                                 \
        if (!(value_ <= bound_)) fail_msg("%s is %.6g, more than %.6g", #value, value_, bound_);   \
    } while (0)

/* Whether this run is of `make check-long`, which sets LARIAT_TEST_FULL: tests that have a short
 * form take the full one. */
TEST_UNUSED static inline bool test_in_full(void) {
    return getenv("LARIAT_TEST_FULL") != NULL;
}

/* With a sanitizer, of many runs that take the same paths every n-th is made, unless in full: i +=
 * test_every(n). The release build makes them all. */
TEST_UNUSED static inline int test_every(int n) {
    return LAR_TEST_SANITIZED && !test_in_full() ? n : 1;
}

#endif
