/* A game controller: sticks drive the tool, rumble tells how hard it pushes.
 *
 *     left stick           to the sides (x) and away (y)
 *     right stick          up and down (z), roll about the shaft
 *     right trigger        closes jaws or takes hold
 *     left shoulder        five times slower
 *
 * SDL2 is loaded when the first controller is opened, so that nothing else needs it; only its
 * headers are there at build time. It reads files of the system, keeps lists and may wait, so a
 * thread of this device talks to it, 250 times a second, and leaves the sticks' positions in
 * atomic words; the engine's thread reads those and leaves the force.
 *
 * Sticks say how fast, not where: the hand is their sum over time. It is kept within LEAD of the
 * tool, or a tool that tissue has stopped would come back only after a long way.
 */
#include "session/device/backend.h"

#define FORM    .name = "gamepad", .form = "gamepad:N", .options = " speed "
#define SUMMARY .summary = "the N-th game controller, from 0, with rumble"

#ifdef LAR_HAVE_SDL

#include <SDL.h>
#include <dlfcn.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/pin.h"
#include "base/quaternion.h"
#include "base/text.h"
#include "base/thread.h"

enum { LOOKS_PER_SECOND = 250, RUMBLE_MS = 100 };
static const double SPEED = 0.05, ROLL = 1.5;        /* at full stick [m/s] [rad/s] */
static const double DEAD = 0.12, LEAD = 0.01;        /* of a stick's way; [m] */
static const double RUMBLE_FULL = 5, SLOW = 1 / 5.0; /* [N] */

/* ---- SDL, loaded ----------------------------------------------------------------------------- */

#define SDL_CALLS(X)                                                                               \
    X(SDL_SetHint)                                                                                 \
    X(SDL_InitSubSystem)                                                                           \
    X(SDL_QuitSubSystem)                                                                           \
    X(SDL_GetError)                                                                                \
    X(SDL_NumJoysticks)                                                                            \
    X(SDL_IsGameController)                                                                        \
    X(SDL_JoystickEventState)                                                                      \
    X(SDL_GameControllerEventState)                                                                \
    X(SDL_GameControllerOpen)                                                                      \
    X(SDL_GameControllerClose)                                                                     \
    X(SDL_GameControllerUpdate)                                                                    \
    X(SDL_GameControllerGetAttached)                                                               \
    X(SDL_GameControllerGetAxis)                                                                   \
    X(SDL_GameControllerGetButton)                                                                 \
    X(SDL_GameControllerRumble)

#define MEMBER(call) __typeof__(call) *call;
static struct {
    void *loaded;
    SDL_CALLS(MEMBER)
} sdl;
static pthread_mutex_t sdl_lock = PTHREAD_MUTEX_INITIALIZER; /* opening and closing */

/* Stays loaded until the program ends. The caller has the lock. */
static lar_status load_sdl(const lar_device_spec *spec, lar_error *error) {
    if (sdl.loaded) return LAR_OK;
    void *library = dlopen("libSDL2-2.0.so.0", RTLD_NOW | RTLD_LOCAL);
    const char *lacking = library ? NULL : "libSDL2-2.0.so.0";
#define FIND(call)                                                                                 \
    if (!lacking && !(*(void **)&sdl.call = dlsym(library, #call))) lacking = #call;
    SDL_CALLS(FIND)
    if (lacking) {
        if (library) dlclose(library);
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "device '%s': %s cannot be loaded; install libsdl2-2.0-0", spec->text,
                        lacking);
    }
    sdl.loaded = library;
    return LAR_OK;
}

/* ---- the device ------------------------------------------------------------------------------ */

typedef struct gamepad_sample {
    _Atomic int16_t axis[SDL_CONTROLLER_AXIS_MAX];
    _Atomic bool slow, attached;
} gamepad_sample;

typedef struct gamepad_state {
    SDL_GameController *controller;
    lar_thread thread;
    bool started, initialised;
    _Atomic bool ended;
    gamepad_sample sample;
    _Atomic uint16_t rumble; /* 0..65535 */
    /* The engine's own. */
    double speed;
    double position[3], roll; /* of the hand */
    double tool[3];           /* where the tool is */
    bool felt;
} gamepad_state;

static void look(gamepad_state *state) {
    sdl.SDL_GameControllerUpdate();
    for (int i = 0; i < SDL_CONTROLLER_AXIS_MAX; i++)
        atomic_store_explicit(
            &state->sample.axis[i],
            sdl.SDL_GameControllerGetAxis(state->controller, (SDL_GameControllerAxis)i),
            memory_order_relaxed);
    atomic_store_explicit(
        &state->sample.slow,
        sdl.SDL_GameControllerGetButton(state->controller, SDL_CONTROLLER_BUTTON_LEFTSHOULDER) != 0,
        memory_order_relaxed);
    atomic_store_explicit(&state->sample.attached,
                          sdl.SDL_GameControllerGetAttached(state->controller) != 0,
                          memory_order_relaxed);
}

static void *follow_controller(void *data) {
    gamepad_state *state = data;
    uint16_t told = 0;
    lar_pin_nowhere(); /* not where a processor computes, which may have started it */
    for (int looks = 0; !atomic_load(&state->ended); looks++) {
        look(state);
        /* A rumble lasts RUMBLE_MS and is renewed before it ends. */
        uint16_t rumble = atomic_load_explicit(&state->rumble, memory_order_relaxed);
        if ((rumble || told) && looks % (LOOKS_PER_SECOND / 25) == 0) {
            sdl.SDL_GameControllerRumble(state->controller, rumble, rumble / 2, RUMBLE_MS);
            told = rumble;
        }
        lar_clock_sleep_until(lar_clock_ns() + 1000000000 / LOOKS_PER_SECOND);
    }
    return NULL;
}

static void let_go(const gamepad_state *state) {
    pthread_mutex_lock(&sdl_lock);
    if (state->controller) {
        sdl.SDL_GameControllerRumble(state->controller, 0, 0, 0);
        sdl.SDL_GameControllerClose(state->controller);
    }
    if (state->initialised) sdl.SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
    pthread_mutex_unlock(&sdl_lock);
}

static void gamepad_close(void *data) {
    gamepad_state *state = data;
    /* In a forked child the controller is its parent's. */
    bool here = !state->started || lar_thread_is_here(&state->thread);
    if (state->started && here) {
        atomic_store(&state->ended, true);
        lar_thread_join(&state->thread);
    }
    if (here) let_go(state);
    free(state);
}

/* The caller has the lock. */
static lar_status open_controller(gamepad_state *state, const lar_device_spec *spec, int64_t wanted,
                                  lar_error *error) {
    lar_status status = load_sdl(spec, error);
    if (status) return status;
    /* A library leaves signals to the program, and reads controllers though it has no window. */
    sdl.SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    sdl.SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    if (sdl.SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED, "device '%s': SDL does not start: %s",
                        spec->text, sdl.SDL_GetError());
    state->initialised = true;
    sdl.SDL_JoystickEventState(SDL_IGNORE); /* nobody empties its queue */
    sdl.SDL_GameControllerEventState(SDL_IGNORE);
    int64_t found = 0;
    for (int i = 0; i < sdl.SDL_NumJoysticks() && !state->controller; i++)
        if (sdl.SDL_IsGameController(i) && found++ == wanted)
            state->controller = sdl.SDL_GameControllerOpen(i);
    if (!state->controller)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "device '%s': %ld game controllers are plugged in, counted from 0; plug "
                        "one in, and see that you may read /dev/input/event*",
                        spec->text, (long)found);
    return LAR_OK;
}

static lar_status gamepad_open(lar_device_spec *spec, void **data, lar_error *error) {
    int64_t number;
    if (!lar_span_int64((lar_span){spec->argument, strlen(spec->argument)}, &number) || number < 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "device '%s': after gamepad: the controller's number is wanted, from 0",
                        spec->text);
    gamepad_state *state = lar_calloc(1, sizeof *state);
    if (!state) return lar_fail_memory(error, sizeof *state, "a device");
    *data = state;
    state->speed = spec->speed > 0 ? spec->speed : SPEED;
    pthread_mutex_lock(&sdl_lock);
    lar_status status = open_controller(state, spec, number, error);
    pthread_mutex_unlock(&sdl_lock);
    if (status) return status;
    int cause = lar_thread_start(&state->thread, follow_controller, state);
    if (cause) return lar_fail_thread(error, cause, spec->text);
    state->started = true;
    return LAR_OK;
}

/* -1..1, zero near the middle, finer near it. */
static double stick(const gamepad_state *state, SDL_GameControllerAxis axis) {
    double way = atomic_load_explicit(&state->sample.axis[axis], memory_order_relaxed) / 32767.0;
    double beyond = (fabs(way) - DEAD) / (1 - DEAD);
    if (beyond <= 0) return 0;
    return copysign(fmin(1, beyond) * fmin(1, beyond), way);
}

static bool gamepad_poll(void *data, const lar_device_tick *tick, lar_tool_pose *pose) {
    gamepad_state *state = data;
    if (tick->paused || !atomic_load_explicit(&state->sample.attached, memory_order_relaxed))
        return false;
    bool slow = atomic_load_explicit(&state->sample.slow, memory_order_relaxed);
    double seconds = tick->seconds * (slow ? SLOW : 1), far = 0;
    double way[3] = {stick(state, SDL_CONTROLLER_AXIS_LEFTX),
                     -stick(state, SDL_CONTROLLER_AXIS_LEFTY), /* SDL's y points to the player */
                     -stick(state, SDL_CONTROLLER_AXIS_RIGHTY)};
    for (int i = 0; i < 3; i++) {
        state->position[i] += way[i] * state->speed * seconds;
        far += (state->position[i] - state->tool[i]) * (state->position[i] - state->tool[i]);
    }
    far = sqrt(far);
    for (int i = 0; i < 3 && state->felt && far > LEAD; i++)
        state->position[i] = state->tool[i] + LEAD / far * (state->position[i] - state->tool[i]);
    state->roll += stick(state, SDL_CONTROLLER_AXIS_RIGHTX) * ROLL * seconds;
    memcpy(pose->position, state->position, sizeof pose->position);
    memcpy(pose->orientation, (double[4]){cos(state->roll / 2), 0, 0, sin(state->roll / 2)},
           sizeof pose->orientation);
    double pressed = atomic_load_explicit(&state->sample.axis[SDL_CONTROLLER_AXIS_TRIGGERRIGHT],
                                          memory_order_relaxed) /
                     32767.0;
    pose->opening = fmax(0, fmin(1, 1 - pressed));
    return true;
}

static void gamepad_feel(void *data, const lar_device_tick *tick, const lar_tool_force *force,
                         const lar_tool_pose *pose) {
    gamepad_state *state = data;
    const double *f = force->force;
    double size = tick->paused ? 0 : sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    atomic_store_explicit(&state->rumble, (uint16_t)(65535 * fmin(1, size / RUMBLE_FULL)),
                          memory_order_relaxed);
    memcpy(state->tool, pose->position, sizeof state->tool);
    state->felt = true;
}

/* The hand is where the tool was at the start. */
static void gamepad_reset(void *data) {
    gamepad_state *state = data;
    memset(state->position, 0, sizeof state->position);
    state->roll = 0;
    state->felt = false;
    atomic_store_explicit(&state->rumble, 0, memory_order_relaxed);
}

static void gamepad_report(const void *data, lar_device_status *status) {
    const gamepad_state *state = data;
    status->connected = atomic_load_explicit(&state->sample.attached, memory_order_relaxed);
}

const lar_device_backend lar_device_gamepad = {FORM,
                                               SUMMARY,
                                               .open = gamepad_open,
                                               .close = gamepad_close,
                                               .poll = gamepad_poll,
                                               .feel = gamepad_feel,
                                               .reset = gamepad_reset,
                                               .report = gamepad_report};
#else

const lar_device_backend lar_device_gamepad = {
    FORM, SUMMARY,
    .missing = "this build found no SDL2; install libsdl2-dev and build Lariat again"};
#endif
