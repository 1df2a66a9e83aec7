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

#endif
