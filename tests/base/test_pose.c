/* Poses from outside: one rule for callers, scripts, packets, messages and files. */
#include "base/pose.h"

#include <math.h>
#include <string.h>

#include "testing.h"

static const lar_tool_pose good = {{1, -2, 3}, {1, 0, 0, 0}, 0.5};

static void refuse(lar_tool_pose pose, const char *says) {
    lar_error error;
    lar_tool_pose before = pose;
    assert_int_equal(lar_pose_normalise(&pose, "a.csv:7", &error), LAR_ERROR_ARGUMENT);
    if (!strstr(error.message, says) || !strstr(error.message, "a.csv:7: "))
        fail_msg("\"%s\" does not say %s", error.message, says);
    assert_memory_equal(&pose, &before, sizeof pose);
    assert_false(lar_pose_is_normal(&pose));
}

static void what_is_no_pose_is_refused(void **unused) {
    (void)unused;
    static const double far_away[] = {NAN, INFINITY, -INFINITY, 1.1e9};
    for (size_t i = 0; i < sizeof far_away / sizeof *far_away; i++) {
        lar_tool_pose pose = good;
        pose.position[i % 3] = far_away[i];
        refuse(pose, "three finite numbers");
    }
    static const double turns[] = {NAN, INFINITY, 0, 0.98, 1.02};
    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++) {
        lar_tool_pose pose = good;
        pose.orientation[0] = turns[i];
        refuse(pose, "length 1 (1, 0, 0, 0");
    }
    static const double openings[] = {NAN, -1e-9, 1.000001};
    for (size_t i = 0; i < sizeof openings / sizeof *openings; i++) {
        lar_tool_pose pose = good;
        pose.opening = openings[i];
        refuse(pose, "0, closed, to 1, open");
    }
}

static void rounded_turns_are_brought_to_length_one(void **unused) {
    (void)unused;
    for (int i = -9; i <= 9; i++) {
        lar_tool_pose pose = good;
        double length = 1 + 0.001 * i;
        pose.orientation[0] = 0.6 * length;
        pose.orientation[2] = -0.8 * length;
        assert_int_equal(lar_pose_normalise(&pose, NULL, NULL), LAR_OK);
        assert_true(fabs(pose.orientation[0] - 0.6) < 1e-15);
        assert_true(fabs(pose.orientation[2] + 0.8) < 1e-15);
        assert_true(lar_pose_is_normal(&pose));
        assert_memory_equal(pose.position, good.position, sizeof pose.position);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_no_pose_is_refused),
        cmocka_unit_test(rounded_turns_are_brought_to_length_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
