/* Devices: what a spec may say, scripts, where the device's axes lie, and the trocar. */
#include "testing.h"

#include "base/quaternion.h"
#include "session/device/device.h"
#include "session/device/trocar.h"

static const lar_tool_info PROBE = {
    .name = "probe",
    .shape = LAR_TOOL_CAPSULE,
    .radius = 0.005,
    .length = 0.2,
    .rest = {.position = {0.01, 0.02, 0.1}, .orientation = {1, 0, 0, 0}, .opening = 1}};

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static lar_device *open_device(const char *spec) {
    lar_device *device = NULL;
    lar_error error = {LAR_OK, ""};
    if (lar_device_open(spec, &PROBE, &device, &error)) fail_msg("%s", error.message);
    return device;
}

static void assert_refused(const char *spec, lar_status status, const char *words) {
    lar_device *device = NULL;
    lar_error error = {LAR_OK, ""};
    assert_int_equal(lar_device_open(spec, &PROBE, &device, &error), status);
    assert_null(device);
    if (!strstr(error.message, words)) fail_msg("\"%s\" does not say \"%s\"", error.message, words);
}

static lar_device_tick at(double time) {
    return (lar_device_tick){.time = time - 0.001, .seconds = 0.001};
}

static lar_tool_pose pose_at(lar_device *device, double time) {
    lar_tool_pose pose = PROBE.rest;
    lar_device_tick tick = at(time);
    assert_true(lar_device_poll(device, &tick, &pose));
    return pose;
}

static void assert_near(const double *a, const double *b, int count, double tolerance) {
    for (int i = 0; i < count; i++)
        if (!(fabs(a[i] - b[i]) <= tolerance))
            fail_msg("value %d is %.17g, not %.17g", i, a[i], b[i]);
}

/* ---- specs -------------------------------------------------------------------------------- */

static void test_unknown_devices_are_refused(void **state) {
    (void)state;
    assert_refused("phantom:0", LAR_ERROR_ARGUMENT,
                   "use script:FILE.csv, udp:HOST:PORT or gamepad:N");
    assert_refused("skript:a.csv", LAR_ERROR_ARGUMENT, "no such kind of device");
    assert_refused("script", LAR_ERROR_ARGUMENT, "does not say which; use script:FILE.csv");
    assert_refused("script:", LAR_ERROR_ARGUMENT, "does not say which; use script:FILE.csv");
    assert_refused("udp:,scale=2", LAR_ERROR_ARGUMENT, "does not say which; use udp:HOST:PORT");
    assert_refused("script:s.csv,trocar=0:0:0,scale=2,trocar=1:1:1", LAR_ERROR_ARGUMENT,
                   "trocar is there twice");
    assert_refused("udp:127.0.0.1:0,color=red", LAR_ERROR_ARGUMENT,
                   "there are at axes scale trocar token rate to write");
    assert_refused("udp:127.0.0.1:0,", LAR_ERROR_ARGUMENT, "no option");
    assert_refused("udp:127.0.0.1:0,scale", LAR_ERROR_ARGUMENT, "no option");
    assert_refused("udp:127.0.0.1:0,at axes=1", LAR_ERROR_ARGUMENT, "no option");
    assert_refused("script:x.csv,token=12345678", LAR_ERROR_ARGUMENT, "no option");
    assert_refused("udp:127.0.0.1:0,scale=0", LAR_ERROR_ARGUMENT, "0.001 to 1000");
    assert_refused("udp:127.0.0.1:0,scale=nan", LAR_ERROR_ARGUMENT, "0.001 to 1000");
    assert_refused("udp:127.0.0.1:0,trocar=0:0", LAR_ERROR_ARGUMENT, "X:Y:Z");
    assert_refused("udp:127.0.0.1:0,trocar=0:0:0:0", LAR_ERROR_ARGUMENT, "X:Y:Z");
    assert_refused("udp:127.0.0.1:0,at=0:0:inf", LAR_ERROR_ARGUMENT, "X:Y:Z");
    assert_refused("udp:127.0.0.1:0,axes=xyy", LAR_ERROR_ARGUMENT, "right-handed");
    assert_refused("udp:127.0.0.1:0,axes=xzy", LAR_ERROR_ARGUMENT, "right-handed");
    assert_refused("udp:127.0.0.1:0,axes=xyzx", LAR_ERROR_ARGUMENT, "right-handed");
    assert_refused("udp:127.0.0.1:0,token=short", LAR_ERROR_ARGUMENT, "8 to 16");
    assert_refused("udp:127.0.0.1", LAR_ERROR_ARGUMENT, "udp:127.0.0.1:9000");
    assert_refused("udp:127.0.0.1:99999", LAR_ERROR_ARGUMENT, "udp:127.0.0.1:9000");
    assert_refused("udp:127.0.0.1:1x", LAR_ERROR_ARGUMENT, "udp:127.0.0.1:9000");
    assert_refused("udp:0.0.0.0:0", LAR_ERROR_ARGUMENT, "token=");
}

/* ---- scripts ------------------------------------------------------------------------------ */

static void test_script_is_interpolated(void **state) {
    (void)state;
    write_file("device_way.csv",
               "# a way\n"
               " time, x,y,z,qw,qx,qy,qz,opening\r\n"
               "1,0,0,0,1,0,0,0,1\n"
               "\n"
               "2,0.1,0,-0.2,0.70710678118654752,0,0,0.70710678118654752,0\n"
               "4,0.1,0.4,-0.2,0.70710678118654752,0,0,0.70710678118654752,0.5\n");
    lar_device *device = open_device("script:device_way.csv");
    lar_tool_pose pose = pose_at(device, 0.5);
    assert_near(pose.position, (double[]){0, 0, 0}, 3, 0);
    pose = pose_at(device, 1.5);
    assert_near(pose.position, (double[]){0.05, 0, -0.1}, 3, 1e-12);
    assert_true(fabs(pose.opening - 0.5) < 1e-12);
    const double eighth = 0.39269908169872414; /* half of 45 degrees */
    assert_near(pose.orientation, (double[]){cos(eighth), 0, 0, sin(eighth)}, 4, 1e-9);
    pose = pose_at(device, 3);
    assert_near(pose.position, (double[]){0.1, 0.2, -0.2}, 3, 1e-12);
    pose = pose_at(device, 100);
    assert_near(pose.position, (double[]){0.1, 0.4, -0.2}, 3, 0);
    pose = pose_at(device, 1.25); /* back again, as after a reset */
    assert_near(pose.position, (double[]){0.025, 0, -0.05}, 3, 1e-12);
    lar_device_tick tick = at(1.5);
    tick.paused = true;
    assert_false(lar_device_poll(device, &tick, &pose));
    lar_device_close(device);
}

/* Without orientations the tool stays as it is at rest. */
static void test_script_of_positions_only(void **state) {
    (void)state;
    write_file("device_way.csv", "\xef\xbb\xbfz,time,y,x\n3,0,2,1\n"); /* by a spreadsheet */
    lar_device *device = open_device("script:device_way.csv");
    lar_tool_pose pose = pose_at(device, 0);
    assert_near(pose.position, (double[]){1, 2, 3}, 3, 0);
    assert_near(pose.orientation, PROBE.rest.orientation, 4, 0);
    assert_true(pose.opening == 1);
    lar_device_close(device);
}

static void test_bad_scripts_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *words;
    } bad[] = {
        {"# only\n", "device_bad.csv: nothing in it"},
        {"time,x,y\n0,0,0\n", "device_bad.csv:1: the column z is missing"},
        {"time,x,y,z,qx\n", "device_bad.csv:1: the column qw is missing"},
        {"time,x,y,z,w\n", "device_bad.csv:1: 'w' is no column"},
        {"time,x,y,z,x\n", "device_bad.csv:1: 'x' stands twice"},
        {"time,x,y,z\n", "no row follows"},
        {"time,x,y,z\n\n0,0,0,0\n0,1,0,0\n", "device_bad.csv:4: time 0 does not come after 0"},
        {"time,x,y,z\n0,0,0,zero\n", "device_bad.csv:2: 'zero' is no number for z"},
        {"time,x,y,z\n0,0,0,nan\n", "device_bad.csv:2: 'nan' is no number for z"},
        {"time,x,y,z\n0,0,0\n", "device_bad.csv:2: fewer values"},
        {"time,x,y,z\n0,0,0,0,0\n", "device_bad.csv:2: more values"},
        {"time,x,y,z\n0,0,0,1000\n", "device_bad.csv:2: z is 1000 m"},
        {"time,x,y,z,opening\n0,0,0,0,2\n", "device_bad.csv:2: an opening of 2"},
        {"time,x,y,z,qw,qx,qy,qz\n0,0,0,0,0,0,0,0\n",
         "device_bad.csv:2: the orientation has length 0"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        write_file("device_bad.csv", bad[i].text);
        assert_refused("script:device_bad.csv", LAR_ERROR_FORMAT, bad[i].words);
    }
    assert_refused("script:missing.csv", LAR_ERROR_IO, "missing.csv");
    static const char two_bytes_each[] = "time,x,y,z\n0,0,0,\0001\0\n"; /* a spreadsheet's */
    FILE *file = fopen("device_bad.csv", "w");
    assert_non_null(file);
    assert_int_equal(fwrite(two_bytes_each, 1, sizeof two_bytes_each - 1, file),
                     sizeof two_bytes_each - 1);
    fclose(file);
    assert_refused("script:device_bad.csv", LAR_ERROR_FORMAT,
                   "device_bad.csv:2: a byte is 0, which no text has");
}

/* ---- the device's axes ----------------------------------------------------------------------- */

static void test_axes_scale_and_place(void **state) {
    (void)state;
    write_file("device_way.csv", "time,x,y,z\n0,1,2,3\n");
    lar_device *device = open_device("script:device_way.csv,axes=x-zy,scale=0.1,at=1:0:0");
    lar_tool_pose pose = pose_at(device, 0);
    assert_near(pose.position, (double[]){1.1, -0.3, 0.2}, 3, 1e-12);
    lar_device_close(device);
    static const char *const axes[] = {"xyz", "yzx", "zxy", "-x-yz", "-zyx", "x-y-z", "-y-z+x"};
    for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
        char spec[64];
        double wanted[3];
        const char *letter = axes[i];
        for (int k = 0; k < 3; k++) {
            double sign = *letter == '-' ? -1 : 1;
            if (*letter == '-' || *letter == '+') letter++;
            wanted[k] = sign * (*letter++ - 'x' + 1);
        }
        snprintf(spec, sizeof spec, "script:device_way.csv,axes=%s", axes[i]);
        device = open_device(spec);
        pose = pose_at(device, 0);
        assert_near(pose.position, wanted, 3, 1e-12);
        lar_device_close(device);
    }
}

/* ---- the trocar ------------------------------------------------------------------------------ */

static double distance_to_shaft(const lar_tool_pose *pose, const double point[3]) {
    double way[3], along[3];
    for (int i = 0; i < 3; i++) way[i] = point[i] - pose->position[i];
    const double *q = pose->orientation; /* third column of the turn: the shaft */
    along[0] = 2 * (q[1] * q[3] + q[0] * q[2]);
    along[1] = 2 * (q[2] * q[3] - q[0] * q[1]);
    along[2] = 1 - 2 * (q[1] * q[1] + q[2] * q[2]);
    double dot = 0, square = 0;
    for (int i = 0; i < 3; i++) dot += way[i] * along[i];
    for (int i = 0; i < 3; i++) square += (way[i] - dot * along[i]) * (way[i] - dot * along[i]);
    return dot > 0 ? sqrt(square) : INFINITY;
}

static void test_trocar_there_and_back(void **state) {
    (void)state;
    const double point[3] = {0.03, -0.02, 0.2};
    lar_trocar trocar;
    lar_trocar_create(&trocar, point, &PROBE.rest);
    for (int i = 0; i < 5 * 5 * 3 * 5; i++) {
        lar_trocar_angles angles = {.alpha = 0.6 * (i % 5 - 2),
                                    .beta = 0.6 * (i / 5 % 5 - 2),
                                    .d = 0.002 + 0.2 * (i / 25 % 3),
                                    .gamma = 1.4 * (i / 75 - 2)};
        lar_trocar_angles back = {0};
        lar_tool_pose pose = {.opening = 0.25};
        lar_trocar_pose(&trocar, &angles, &pose);
        assert_true(distance_to_shaft(&pose, point) < 1e-12);
        assert_true(pose.opening == 0.25);
        for (int k = 0; k < 4 && i % 2; k++) pose.orientation[k] *= -1; /* the same turn */
        assert_true(lar_trocar_find(&trocar, &pose, &back));
        assert_near(&back.alpha, &angles.alpha, 1, 1e-9);
        assert_near(&back.beta, &angles.beta, 1, 1e-9);
        assert_near(&back.d, &angles.d, 1, 1e-12);
        assert_near(&back.gamma, &angles.gamma, 1, 1e-9);
    }
    lar_trocar_angles rest;
    assert_true(lar_trocar_find(&trocar, &PROBE.rest, &rest));
    assert_true(fabs(rest.alpha) < 1e-9 && fabs(rest.beta) < 1e-9);
}

static void test_trocar_limits(void **state) {
    (void)state;
    lar_trocar trocar;
    lar_tool_pose rest = {.position = {0, 0, 0.1}, .orientation = {1, 0, 0, 0}};
    lar_trocar_create(&trocar, (double[]){0, 0, 0.2}, &rest);
    lar_trocar_angles angles = {.alpha = 3, .beta = -3, .d = 7, .gamma = 3};
    lar_trocar_limit(&trocar, &angles);
    assert_true(angles.alpha == trocar.tilt_max && angles.beta == -trocar.tilt_max);
    assert_true(angles.d == trocar.depth_max && angles.gamma == 3);
    /* Pulled out: it stays in the point, tilted as it was. */
    angles = (lar_trocar_angles){.alpha = 0.3, .beta = 0.2, .d = 0.1};
    rest.position[2] = 0.25;
    assert_false(lar_trocar_find(&trocar, &rest, &angles));
    assert_true(angles.alpha == 0.3 && angles.beta == 0.2 && angles.d == trocar.depth_min);
    rest.position[2] = 0.2;
    assert_false(lar_trocar_find(&trocar, &rest, &angles));
    /* A tool that rests in the point: the trocar points along its shaft. */
    lar_trocar_create(&trocar, rest.position, &rest);
    assert_near(trocar.frame, (double[]){1, 0, 0, 0}, 4, 1e-12);
}

/* A device with a trocar: wherever the hand goes, the shaft passes through the point. */
static void test_device_pivots(void **state) {
    (void)state;
    write_file("device_way.csv",
               "time,x,y,z\n0,0.05,0.02,0.1\n1,-0.1,0.1,0.05\n2,0,0,0.5\n3,0,0,0.1\n");
    lar_device *device = open_device("script:device_way.csv,trocar=0.01:0.02:0.3");
    const double point[3] = {0.01, 0.02, 0.3};
    for (int i = 0; i <= 300; i++) {
        lar_tool_pose pose = pose_at(device, 0.01 * i);
        assert_true(distance_to_shaft(&pose, point) < 1e-9);
    }
    lar_tool_pose pose = pose_at(device, 0);
    assert_near(pose.position, (double[]){0.05, 0.02, 0.1}, 3, 1e-12);
    lar_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unknown_devices_are_refused),
        cmocka_unit_test(test_script_is_interpolated),
        cmocka_unit_test(test_script_of_positions_only),
        cmocka_unit_test(test_bad_scripts_are_refused),
        cmocka_unit_test(test_axes_scale_and_place),
        cmocka_unit_test(test_trocar_there_and_back),
        cmocka_unit_test(test_trocar_limits),
        cmocka_unit_test(test_device_pivots),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
