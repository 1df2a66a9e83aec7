/* What is too long for a message loses its middle: who, what and what to do stay. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "base/text.h"

enum { LONG = 5000 };
static char path[LONG + 1];
static lar_error error;

static void fill(const char *part) {
    size_t length = strlen(part);
    path[0] = '\0';
    for (size_t at = 0; at + length <= LONG; at += length) memcpy(path + at, part, length + 1);
}

static void long_paths_leave_room_for_the_cause(void **unused) {
    (void)unused;
    static const char END[] = "/a.yaml: cannot be read: no such file; check the name";
    fill("/folder");
    assert_int_equal(lar_fail(&error, LAR_ERROR_IO, "scene %s%s", path, END), LAR_ERROR_IO);
    size_t length = strlen(error.message);
    assert_int_equal(length, sizeof error.message - 1);
    assert_memory_equal(error.message, "scene /folder/folder", 20);
    assert_non_null(strstr(error.message, "..."));
    assert_string_equal(error.message + length - strlen(END), END);
}

static void what_fits_stays(void **unused) {
    (void)unused;
    fill("x");
    path[sizeof error.message - 1] = '\0';
    lar_fail(&error, LAR_ERROR_IO, "%s", path);
    assert_string_equal(error.message, path);
    assert_int_equal(lar_fail(NULL, LAR_ERROR_IO, "%s", path), LAR_ERROR_IO);
}

/* Wherever it is cut. */
static void characters_stay_whole(void **unused) {
    (void)unused;
    static const char *const parts[] = {"\xc3\xa4", "\xe2\x82\xac", "\xf0\x9f\x98\x80"};
    for (int i = 0; i < 3; i++)
        for (int before = 0; before < 4; before++) {
            fill(parts[i]);
            lar_fail(&error, LAR_ERROR_IO, "%.*s%s: is gone", before, "abc", path);
            const unsigned char *c = (const unsigned char *)error.message;
            for (size_t left = strlen(error.message); left > 0;) {
                int bytes = lar_utf8_length(c, left);
                assert_true(bytes > 0);
                c += bytes;
                left -= (size_t)bytes;
            }
            assert_non_null(strstr(error.message, ": is gone"));
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_paths_leave_room_for_the_cause),
        cmocka_unit_test(what_fits_stays),
        cmocka_unit_test(characters_stay_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
