/* A device and an engine whose clocks are not the same, and a network between them: what a hand
 * feels when positions come early, late and in bunches. */
#include "coupling_test.h"

#include "session/device/jitter_buffer.h"

static const lar_tool_info PROBE = {
    .name = "probe", .shape = LAR_TOOL_SPHERE, .radius = 0.005, .rest = {.orientation = {1}}};

/* ---- two clocks and a network ---------------------------------------------------------------- */

/* Time goes on by this much at once [us]. */
enum { FINE = 50, PERIOD = 1000, QUEUE = 64 };

typedef struct packet {
    lar_tool_pose pose;
    double time, comes; /* the device's, the engine's [us] */
} packet;

typedef struct rig {
    world w;
    bool evenly;                     /* or the newest position counts */
    double late, jitter;             /* of packets [us] */
    double tick;                     /* [us] */
    double fast;                     /* the device's clock, against the engine's */
    double now, sends, due, answers; /* the next ones [us] */
    lar_jitter_buffer buffer;
    packet queue[QUEUE];
    int sent, taken;
    lar_tool_pose newest;
    double held;        /* force that the device holds [N] */
    double work, least; /* that its hand put in [J] */
    double z;           /* where the hand is [m] */
    double force_sum, force_squares, force_max;
    int forces;
} rig;

static rig rig_at(double z, double stiffness, double tick_us) {
    rig r = {.late = 100, .jitter = 600, .tick = tick_us, .fast = 1.0003, .due = 130, .z = z};
    r.w = start_at(&PROBE, stiffness, z, 1e-6 * tick_us);
    r.newest = r.w.hand;
    r.answers = INFINITY;
    return r;
}

static void send_position(rig *r) {
    packet *p = &r->queue[r->sent++ % QUEUE];
    double before = r->sent > 1 ? r->queue[(r->sent - 2) % QUEUE].comes : 0;
    p->pose = r->w.hand;
    p->pose.position[2] = r->z;
    p->time = r->now * r->fast;
    p->comes = fmax(before, r->now + r->late + r->jitter * any());
    r->sends += PERIOD / r->fast;
}

static void tick_with(rig *r, const lar_tool_pose *evenly) {
    world *w = &r->w;
    double from = w->tool.position[2];
    w->hand = r->newest;
    lar_coupling_follow(&w->coupling, &w->hand, evenly, &w->tool);
    lar_tool_force tissue = {.force = {0, 0, wall_force(&w->wall, from, w->tool.position[2])}};
    lar_coupling_feel(&w->coupling, &tissue, w->seconds, &w->felt);
}

static void play_tick(rig *r) {
    for (; r->taken < r->sent && r->queue[r->taken % QUEUE].comes <= r->now; r->taken++) {
        const packet *p = &r->queue[r->taken % QUEUE];
        r->newest = p->pose;
        lar_jitter_buffer_put(&r->buffer, &p->pose, (uint64_t)p->time);
    }
    lar_tool_pose evenly = r->newest;
    lar_jitter_buffer_at(&r->buffer, (int64_t)(1e3 * r->due), &evenly);
    tick_with(r, r->evenly ? &evenly : NULL);
    r->answers = r->now + 0.2 * r->tick;
    r->due += r->tick;
}

static void count_force(rig *r) {
    r->force_sum += r->held;
    r->force_squares += r->held * r->held;
    r->force_max = fmax(r->force_max, fabs(r->held));
    r->forces++;
}

/* The hand goes to `z` within FINE. */
static void go_to(rig *r, double z) {
    r->work -= r->held * (z - r->z);
    r->least = fmin(r->least, r->work + 1e-3 * 1e-6 * r->now);
    r->z = z;
    r->now += FINE;
    if (r->now >= r->answers) r->held = r->w.felt.force[2], r->answers = INFINITY;
    if (r->now >= r->sends) send_position(r);
    if (r->now >= r->due + 80 * any()) play_tick(r);
}

/* ---- what is felt ---------------------------------------------------------------------------- */

/* Root mean square of what the hand feels in the air at a steady speed. */
static double felt_in_air(bool evenly, double speed, double tick_us) {
    seed = 3;
    rig r = rig_at(0.5, 0, tick_us);
    r.evenly = evenly;
    while (r.now < 1e6) {
        go_to(&r, r.z - 1e-6 * FINE * speed);
        if (r.now > 3e5) count_force(&r);
    }
    return sqrt(r.force_squares / r.forces);
}

static void test_air_is_not_felt(void **state) {
    (void)state;
    const double speed[] = {0.01, 0.05, 0.2, 0.5}, tick_us[] = {950, 1000, 1900};
    for (int run = 0; run < 4 * 3; run++) {
        double v = speed[run % 4], tick = tick_us[run / 4];
        double evenly = felt_in_air(true, v, tick), newest = felt_in_air(false, v, tick);
        printf("ticks of %g us, %g m/s: %.4f N, by the newest position %.4f\n", tick, v, evenly,
               newest);
        assert_true(evenly < 0.001 + 0.03 * v);
        assert_true(evenly < 0.2 * newest);
    }
}

/* Light devices in a soft grip on soft walls and hard ones: what is later than the newest position
 * makes nothing swing that did not. */
static void test_device_rests(void **state) {
    (void)state;
    const double stiffness[] = {300, 3000, 30000}, mass = 0.1;
    for (int i = 0; i < 3; i++) {
        seed = 9;
        rig r = rig_at(0.005, stiffness[i], 950);
        r.evenly = true;
        double v = 0, low = 1, high = -1;
        while (r.now < 5e6) {
            double z = r.z;
            v += 1e-6 * FINE / mass * (r.held + 200 * (-0.02 - z) - 1 * v);
            go_to(&r, z + 1e-6 * FINE * v);
            if (r.now < 4e6) continue;
            count_force(&r);
            low = fmin(low, r.z), high = fmax(high, r.z);
        }
        printf("wall %g N/m: swings by %.2g m, %.3f N\n", stiffness[i], high - low,
               r.force_sum / r.forces);
        assert_true(high - low < 1e-5 && r.force_sum / r.forces > 1);
    }
}

/* Hands that move as hands do get nothing: to and fro in tissue, soft and hard. */
static void test_hands_are_not_fed(void **state) {
    (void)state;
    const double stiffness[] = {300, 3000}, hertz[] = {1, 5, 20}, way[] = {0.01, 0.005, 0.002};
    for (int run = 0; run < 2 * 3; run++) {
        seed = 7;
        double w = 2 * M_PI * hertz[run / 2];
        rig r = rig_at(0, stiffness[run % 2], 950);
        r.evenly = true;
        while (r.now < 3e6) {
            double t = 1e-6 * r.now;
            go_to(&r, -0.006 * fmin(1, t) + way[run / 2] * (1 - cos(w * t)) * 0.5);
        }
        if (r.least < -5e-4) fail_msg("%g Hz: gets %.3g J", hertz[run / 2], -r.least);
    }
}

/* ---- the buffer -------------------------------------------------------------------------------
 */

enum { TOLD = 100 };

/* What is played of a hand at x = 0, 1, 2, ... mm, one position and one question a millisecond. */
static double play(lar_jitter_buffer *buffer, const uint64_t time[TOLD]) {
    lar_tool_pose pose = {.orientation = {1}}, played = {.orientation = {1}};
    lar_jitter_buffer_clear(buffer);
    for (int i = 0; i < TOLD; i++) {
        pose.position[0] = 1e-3 * i;
        pose.opening = i & 1;
        lar_jitter_buffer_put(buffer, &pose, time[i]);
        assert_true(lar_jitter_buffer_at(buffer, 1000000 * (int64_t)(i + 1), &played));
        assert_true(played.opening == pose.opening);
    }
    return played.position[0];
}

/* A device's clock may stand still, go backwards, jump, or count something else: what is played is
 * then the newest position, or near it. */
static void test_any_clock_does(void **state) {
    (void)state;
    uint64_t time[6][TOLD];
    for (uint64_t i = 0; i < TOLD; i++) {
        time[0][i] = 0;
        time[1][i] = 17;
        time[2][i] = UINT64_MAX - 1000 * i;
        time[3][i] = i * 0x123456789abcdefu;
        time[4][i] = UINT64_MAX - 50000 + 1000 * i; /* and goes round */
        time[5][i] = i;                             /* milliseconds */
    }
    for (int k = 0; k < 6; k++) {
        lar_jitter_buffer buffer = {.count = 0};
        double last = 1e-3 * (TOLD - 1), played = play(&buffer, time[k]);
        if (fabs(played - last) > 1e-9) fail_msg("clock %d: %g m, not %g", k, played, last);
    }
}

/* Nothing is there before something has come; a silence is not filled in. */
static void test_silence(void **state) {
    (void)state;
    lar_jitter_buffer buffer = {.count = 0};
    lar_tool_pose pose = {.orientation = {1}}, played = {.position = {7}};
    assert_false(lar_jitter_buffer_at(&buffer, 1000, &played));
    assert_true(played.position[0] == 7);
    lar_jitter_buffer_put(&buffer, &pose, 1000);
    pose.position[0] = 0.1;
    lar_jitter_buffer_put(&buffer, &pose, 30000);
    assert_true(lar_jitter_buffer_at(&buffer, 2000, &played));
    assert_true(played.position[0] == 0.1);
}

/* A hand that turns evenly is seen to turn evenly, though two positions come in every other tick.
 */
static void test_turns_are_even(void **state) {
    (void)state;
    lar_jitter_buffer buffer = {.count = 0};
    lar_tool_pose pose = {.orientation = {1}}, played = pose;
    double before = 0, least = INFINITY, most = 0;
    for (int i = 0; i < 400; i++) {
        for (int k = 0; k < (i & 1 ? 2 : 0); k++) {
            double angle = 1e-3 * (i + k);
            pose.orientation[0] = cos(angle / 2), pose.orientation[2] = sin(angle / 2);
            lar_jitter_buffer_put(&buffer, &pose, (uint64_t)(1000 * (i + k)));
        }
        lar_jitter_buffer_at(&buffer, 1000000 * (int64_t)(i + 1), &played);
        double angle = 2 * atan2(played.orientation[2], played.orientation[0]);
        if (i > 300) least = fmin(least, angle - before), most = fmax(most, angle - before);
        before = angle;
    }
    assert_true(least > 0.99e-3 && most < 1.01e-3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_air_is_not_felt),   cmocka_unit_test(test_device_rests),
        cmocka_unit_test(test_hands_are_not_fed), cmocka_unit_test(test_any_clock_does),
        cmocka_unit_test(test_silence),           cmocka_unit_test(test_turns_are_even),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
