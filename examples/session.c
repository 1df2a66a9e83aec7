/* Lariat in real time inside another program: a thread of ours holds the tip of the beam and lifts
 * it at 1 kHz, as the driver of a device would; the main thread watches.
 *     cc session.c $(pkg-config --cflags --libs lariat) -lpthread -o session && ./session beam.yaml
 */
#define _POSIX_C_SOURCE 200809L
#include <inttypes.h>
#include <lariat.h>
#include <pthread.h>
#include <stdio.h>
#include <time.h>

static const double LIFT = 0.01;       /* [m] */
enum { MILLISECONDS = 500, HAND = 0 }; /* the scene has no tools: the hand is the first one */

/* What our device does: at `from` it closes, and then it goes up. */
typedef struct hand {
    lar_session *session;
    double from[3];
} hand;

static void *lead(void *argument) {
    const hand *h = argument;
    struct timespec next;
    clock_gettime(CLOCK_MONOTONIC, &next);
    for (int ms = 0; ms < MILLISECONDS; ms++) {
        double share = (double)ms / MILLISECONDS;
        double lift = LIFT * share * share * (3 - 2 * share);
        lar_tool_pose pose = {.position = {h->from[0], h->from[1], h->from[2] + lift},
                              .orientation = {1, 0, 0, 0},
                              .opening = ms < 20 ? 1 : 0};
        lar_session_tool_move(h->session, HAND, &pose, NULL);
        next.tv_nsec += 1000000;
        next.tv_sec += next.tv_nsec / 1000000000;
        next.tv_nsec %= 1000000000;
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
    }
    return NULL;
}

/* The node farthest along x, where it is now. */
static void find_tip(const lar_model *model, const lar_snapshot *snapshot, double tip[3]) {
    const double(*position)[3] = lar_model_positions(model);
    int node = 0;
    for (int i = 1; i < snapshot->nodes; i++)
        if (position[i][0] > position[node][0]) node = i;
    for (int i = 0; i < 3; i++) tip[i] = position[node][i] + snapshot->u[node][i];
}

static int callback(lar_session *session, lar_snapshot *snapshot, lar_error *error) {
    static const struct timespec tenth = {0, 100000000};
    lar_session_status status;
    lar_tool_force force;
    for (int i = 0; i < 5; i++) {
        nanosleep(&tenth, NULL);
        if (lar_session_tool_force(session, HAND, NULL, &force, error)) return 1;
        lar_session_status_get(session, &status);
        if (status.state == LAR_SESSION_STOPPED) {
            snprintf(error->message, sizeof error->message, "%s", status.message);
            return 1;
        }
        printf("%.2f s  force %.3f %.3f %.3f N, %d points held\n", status.time, force.force[0],
               force.force[1], force.force[2], (int)force.held);
    }
    if (lar_session_snapshot(session, snapshot, 5, error)) return 1;
    lar_session_status_get(session, &status);
    printf("real-time factor %.2f, %" PRIu64 " of %" PRIu64 " ticks late\n",
           status.real_time_factor, status.misses, status.ticks);
    return 0;
}

/* Only while the session lives: the hand's thread uses it. */
static int play(const lar_model *model, lar_session *session, lar_snapshot *snapshot,
                lar_error *error) {
    hand h = {.session = session};
    double tip[3];
    pthread_t device;
    if (lar_session_snapshot(session, snapshot, 5, error)) return 1;
    find_tip(model, snapshot, h.from);
    if (pthread_create(&device, NULL, lead, &h)) return 1;
    int failed = lar_session_start(session, error) || callback(session, snapshot, error);
    pthread_join(device, NULL);
    if (failed) return failed;
    find_tip(model, snapshot, tip);
    printf("tip lifted by %.1f mm\nhash %016" PRIx64 " at step %" PRIu64 "\n",
           1e3 * (tip[2] - h.from[2]), snapshot->hash, snapshot->step);
    return 0;
}

int main(int argc, char **argv) {
    lar_error error = {LAR_OK, "no thread could be started"};
    lar_options options = lar_options_default();
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_session *session = NULL;
    lar_snapshot *snapshot = NULL;
    options.hands = 1;
    int failed = lar_model_open(argc > 1 ? argv[1] : "beam.yaml", &model, &error) ||
                 lar_simulation_create(model, &options, &simulation, &error) ||
                 lar_session_open(simulation, NULL, &session, &error) ||
                 lar_snapshot_create(session, &snapshot, &error) ||
                 play(model, session, snapshot, &error);
    lar_snapshot_destroy(snapshot);
    failed = lar_session_close(session, failed ? NULL : &error) || failed;
    if (failed) fprintf(stderr, "%s\n", error.message);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return failed;
}
