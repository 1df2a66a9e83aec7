/* A game controller: SDL's virtual one, so that no real one is needed. */
#include "testing.h"

#include <unistd.h>

#include "session/device/device.h"

static const lar_tool_info PROBE = {.name = "probe",
                                    .radius = 0.005,
                                    .rest = {.position = {0, 0, 0.1}, .orientation = {1, 0, 0, 0}}};

static void assert_refused(const char *spec, lar_status status, const char *words) {
    lar_device *device = NULL;
    lar_error error = {LAR_OK, ""};
    assert_int_equal(lar_device_open(spec, &PROBE, &device, &error), status);
    assert_null(device);
    if (!strstr(error.message, words)) fail_msg("\"%s\" does not say \"%s\"", error.message, words);
}

#ifdef LAR_TEST_SDL

#include <SDL.h>

static SDL_Joystick *joystick;
static _Atomic Uint16 strongest;

static int on_rumble(void *data, Uint16 low, Uint16 high) {
    (void)data, (void)high;
    if (low > strongest) strongest = low;
    return 0;
}

static int attach(void **state) {
    (void)state;
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    setenv("SDL_JOYSTICK_DISABLE_UDEV", "1", 1);
    if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER)) return -1;
    SDL_VirtualJoystickDesc what = {.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION,
                                    .type = SDL_JOYSTICK_TYPE_GAMECONTROLLER,
                                    .naxes = SDL_CONTROLLER_AXIS_MAX,
                                    .nbuttons = SDL_CONTROLLER_BUTTON_MAX,
                                    .vendor_id = 0x1234,
                                    .name = "a controller",
                                    .Rumble = on_rumble};
    int index = SDL_JoystickAttachVirtualEx(&what);
    joystick = index < 0 ? NULL : SDL_JoystickOpen(index);
    return joystick ? 0 : -1;
}

static int detach(void **state) {
    (void)state;
    SDL_JoystickClose(joystick);
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
    return 0;
}

static void rest(void) {
    for (int i = 0; i < SDL_CONTROLLER_AXIS_MAX; i++)
        SDL_JoystickSetVirtualAxis(joystick, i, i >= SDL_CONTROLLER_AXIS_TRIGGERLEFT ? -32768 : 0);
}

static const lar_device_tick TICK = {.seconds = 0.001};

/* Presses the right trigger or lets it go, and waits until the device's thread has seen it: then it
 * has seen what the sticks did before, too. Ticks of no time move nothing. */
static void settle(lar_device *device, bool pressed) {
    const lar_device_tick now = {.seconds = 0};
    lar_tool_pose pose = {.opening = -1};
    SDL_JoystickSetVirtualAxis(joystick, SDL_CONTROLLER_AXIS_TRIGGERRIGHT,
                               pressed ? 32767 : -32768);
    for (int i = 0; i < 1000; i++) {
        if (lar_device_poll(device, &now, &pose) && pose.opening == (pressed ? 0 : 1)) return;
        usleep(5000);
    }
    fail_msg("the device does not see its controller");
}

static lar_tool_pose play(lar_device *device, int ticks, double tool_follows) {
    lar_tool_pose pose = PROBE.rest, tool = PROBE.rest;
    lar_tool_force none = {.touching = 0};
    for (int i = 0; i < ticks; i++) {
        assert_true(lar_device_poll(device, &TICK, &pose));
        for (int k = 0; k < 3; k++)
            tool.position[k] += tool_follows * (pose.position[k] - tool.position[k]);
        lar_device_feel(device, &TICK, &none, &tool);
    }
    return pose;
}

static lar_device *open_device(const char *spec) {
    lar_device *device = NULL;
    lar_error error = {LAR_OK, ""};
    if (lar_device_open(spec, &PROBE, &device, &error)) fail_msg("%s", error.message);
    return device;
}

static void test_sticks_move(void **state) {
    (void)state;
    rest();
    lar_device *device = open_device("gamepad:0,speed=0.1");
    settle(device, false);
    lar_tool_pose pose = play(device, 100, 1);
    assert_true(fabs(pose.position[0]) < 1e-12 && fabs(pose.position[2] - 0.1) < 1e-12);
    assert_true(pose.opening == 1);
    SDL_JoystickSetVirtualAxis(joystick, SDL_CONTROLLER_AXIS_LEFTX, 32767);
    SDL_JoystickSetVirtualAxis(joystick, SDL_CONTROLLER_AXIS_RIGHTY, 32767);
    settle(device, true);
    pose = play(device, 100, 1); /* 0.1 s at 0.1 m/s to the side and down, closed */
    assert_true(fabs(pose.position[0] - 0.01) < 1e-6);
    assert_true(fabs(pose.position[2] - 0.09) < 1e-6);
    assert_true(pose.opening < 0.01);
    lar_device_reset(device);
    rest();
    settle(device, false);
    pose = play(device, 1, 1);
    assert_true(fabs(pose.position[0]) < 1e-12);
    lar_device_close(device);
}

/* A tool that tissue has stopped: the hand does not run away from it. */
static void test_hand_stays_near_a_stopped_tool(void **state) {
    (void)state;
    rest();
    lar_device *device = open_device("gamepad:0");
    SDL_JoystickSetVirtualAxis(joystick, SDL_CONTROLLER_AXIS_LEFTX, -32768);
    settle(device, true);
    lar_tool_pose pose = play(device, 3000, 0);
    assert_true(fabs(pose.position[0] + 0.01) < 1e-4);
    lar_device_close(device);
}

static void test_force_rumbles(void **state) {
    (void)state;
    rest();
    lar_device *device = open_device("gamepad:0");
    lar_tool_pose pose = PROBE.rest;
    lar_tool_force force = {.force = {0, 0, 2.5}};
    strongest = 0;
    lar_device_feel(device, &TICK, &force, &pose);
    for (int i = 0; i < 1000 && strongest == 0; i++) usleep(5000);
    assert_true(strongest > 32000 && strongest < 33500);
    force.force[2] = 100;
    lar_device_feel(device, &TICK, &force, &pose);
    for (int i = 0; i < 1000 && strongest < 65535; i++) usleep(5000);
    assert_int_equal(strongest, 65535);
    lar_device_close(device);
}

static void test_no_such_controller(void **state) {
    (void)state;
    assert_refused("gamepad:7", LAR_ERROR_UNSUPPORTED, "1 game controllers are plugged in");
    assert_refused("gamepad:x", LAR_ERROR_ARGUMENT, "number is wanted");
    assert_refused("gamepad:0,speed=9", LAR_ERROR_ARGUMENT, "at most 1");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sticks_move),
        cmocka_unit_test(test_hand_stays_near_a_stopped_tool),
        cmocka_unit_test(test_force_rumbles),
        cmocka_unit_test(test_no_such_controller),
    };
    return cmocka_run_group_tests(tests, attach, detach);
}

#else

static void test_says_how_to_get_it(void **state) {
    (void)state;
    assert_refused("gamepad:0", LAR_ERROR_UNSUPPORTED, "libsdl2-dev");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_says_how_to_get_it)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
