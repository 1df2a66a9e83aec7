/* A simulator on one page: a haptic thread that gets a force a thousand times a second, a drawing
 * thread, and Lariat's own between them. Who knows no device sees one here: a hand that pokes the
 * slab. cc simulator.c $(pkg-config --cflags --libs lariat) -lpthread -lm -o simulator &&
 * ./simulator
 * ./simulator SECONDS ends by itself; ./simulator SECONDS SCENE takes another model, whose first
 * tool is led. In a file or a pipe only the last picture is drawn.
 */
#define _POSIX_C_SOURCE 200809L
#include <lariat.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { N = 12, LAYERS = 3, NODES = (N + 1) * (N + 1) * (LAYERS + 1), COLUMNS = 72, ROWS = 22 };
static const double EDGE = 0.008; /* of a cell [m] */
static const char SCENE[] =
    "lariat: 1\n"
    "title: A slab that is poked\n"
    "damping: 15\n"
    "materials:\n"
    "  - { cells: all, law: neo-hookean, density: 1050, shear_modulus: 3.0e3, bulk_modulus: 3.0e4 "
    "}\n"
    "fix: [ { nodes: floor, axes: xyz } ]\n"
    "tools: [ { name: probe, shape: sphere, radius: 0.010, at: [0.048, 0.048, 0.040] } ]\n";

/* What the threads share: the session takes calls from any of them. */
typedef struct simulator {
    const lar_model *model;
    lar_session *session;
    lar_snapshot *snapshot; /* the drawing thread's */
    lar_tool_pose start;
    double seconds;
    atomic_int over;
    double strongest; /* [N], the haptic thread's until it is joined */
    long asked;
} simulator;

static lar_status make_slab(lar_model **model, lar_error *error) {
    static double position[NODES][3];
    static int32_t element[N * N * LAYERS][8], floor_nodes[(N + 1) * (N + 1)];
    const int32_t corner[8] = {0,
                               1,
                               N + 2,
                               N + 1,
                               (N + 1) * (N + 1),
                               (N + 1) * (N + 1) + 1,
                               (N + 1) * (N + 1) + N + 2,
                               (N + 1) * (N + 1) + N + 1};
    lar_array_set set = {.name = "floor", .count = (N + 1) * (N + 1), .index = floor_nodes};
    lar_mesh_arrays mesh = {.nodes = NODES,
                            .elements = N * N * LAYERS,
                            .sets = 1,
                            .position = (const double(*)[3])position,
                            .element = (const int32_t(*)[8])element,
                            .set = &set};
    for (int n = 0; n < NODES; n++) {
        position[n][0] = EDGE * (n % (N + 1));
        position[n][1] = EDGE * (n / (N + 1) % (N + 1));
        position[n][2] = EDGE * (n / ((N + 1) * (N + 1)));
        if (n < set.count) floor_nodes[n] = n;
    }
    for (int e = 0; e < mesh.elements; e++)
        for (int a = 0; a < 8; a++)
            element[e][a] =
                e % N + (N + 1) * (e / N % N) + (N + 1) * (N + 1) * (e / (N * N)) + corner[a];
    return lar_model_from_arrays(&mesh, SCENE, model, error);
}

/* A driver reads its device here, and gives it the force; this hand goes round and up and down. */
static void *haptic_thread(void *argument) {
    simulator *s = argument;
    lar_tool_pose pose = s->start;
    struct timespec next;
    clock_gettime(CLOCK_MONOTONIC, &next);
    for (; !atomic_load(&s->over); s->asked++) {
        double t = 1e-3 * (double)s->asked;
        pose.position[0] = s->start.position[0] + 0.02 * sin(1.5 * t);
        pose.position[1] = s->start.position[1] + 0.02 * sin(1.1 * t);
        pose.position[2] = s->start.position[2] - 0.005 * (1 - cos(6 * t));
        double felt[3];
        lar_session_tool_move(s->session, 0, &pose, NULL);
        if (!lar_session_tool_felt(s->session, 0, felt, NULL, NULL))
            s->strongest =
                fmax(s->strongest, sqrt(felt[0] * felt[0] + felt[1] * felt[1] + felt[2] * felt[2]));
        next.tv_nsec += 1000000;
        if (next.tv_nsec >= 1000000000) next.tv_sec++, next.tv_nsec -= 1000000000;
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
    }
    return NULL;
}

/* The surface from obliquely above, nearer faces before others, lighter the more it looks up. */
static void draw(const simulator *s, char picture[ROWS][COLUMNS + 1]) {
    static const char shade[] = ".:-=+*#%@";
    static double depth[ROWS][COLUMNS];
    const double(*rest)[3] = lar_model_positions(s->model);
    lar_surface_info surface;
    lar_model_info info;
    lar_model_surface(s->model, &surface);
    if (lar_model_inspect(s->model, &info, NULL)) return;
    double width = info.upper[0] - info.lower[0], scale = (COLUMNS - 20) / width;
    for (int r = 0; r < ROWS; r++) {
        memset(picture[r], ' ', COLUMNS);
        picture[r][COLUMNS] = '\0';
        for (int c = 0; c < COLUMNS; c++) depth[r][c] = -INFINITY;
    }
    for (int f = 0; f < surface.faces; f++) {
        double x[4][3];
        for (int a = 0; a < 4; a++)
            for (int k = 0; k < 3; k++)
                x[a][k] = rest[surface.face[f][a]][k] + s->snapshot->u[surface.face[f][a]][k];
        double d[2][3], n[3];
        for (int k = 0; k < 3; k++) d[0][k] = x[2][k] - x[0][k], d[1][k] = x[3][k] - x[1][k];
        for (int k = 0; k < 3; k++)
            n[k] = d[0][(k + 1) % 3] * d[1][(k + 2) % 3] - d[0][(k + 2) % 3] * d[1][(k + 1) % 3];
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        double light = fmax(0, (0.6 * n[2] - 0.5 * n[1] + 0.6 * n[0]) / fmax(length, 1e-30));
        for (int i = 0; i <= 64; i++) { /* points of the face */
            double p = i % 8 / 7.0, q = fmin(1, i / 8 / 7.0), at[3];
            for (int k = 0; k < 3; k++)
                at[k] = (1 - q) * ((1 - p) * x[0][k] + p * x[1][k]) +
                        q * ((1 - p) * x[3][k] + p * x[2][k]);
            double y = at[1] - info.lower[1], z = at[2] - info.lower[2];
            int c = (int)lround(scale * (at[0] - info.lower[0] + 0.35 * y)) + 1;
            int r = ROWS - 2 - (int)lround(0.5 * scale * (0.6 * y + z));
            if (r < 0 || r >= ROWS || c < 0 || c >= COLUMNS || z - y < depth[r][c]) continue;
            depth[r][c] = z - y;
            picture[r][c] = shade[(int)(light * 8.99)];
        }
    }
}

static void *drawing_thread(void *argument) {
    simulator *s = argument;
    static char picture[ROWS][COLUMNS + 1];
    const struct timespec frame = {0, 40000000};
    const int terminal = isatty(STDOUT_FILENO);
    int last = 0;
    for (long frames = 0; !last; frames++) {
        last = atomic_load(&s->over);
        if (lar_session_snapshot(s->session, s->snapshot, 1, NULL)) continue;
        if (terminal || last) {
            draw(s, picture);
            if (terminal) printf("\033[H\033[2J");
            for (int r = 0; r < ROWS; r++) printf("%s\n", picture[r]);
            printf("%.2f s, picture %ld\n", s->snapshot->time, frames);
            fflush(stdout);
        }
        if (!last) nanosleep(&frame, NULL);
    }
    return NULL;
}

static int play(simulator *s, lar_error *error) {
    pthread_t haptic, drawing;
    lar_session_status status;
    lar_tool_info tool;
    if (lar_model_tool(s->model, 0, &tool, error) || lar_session_start(s->session, error)) return 1;
    s->start = tool.rest;
    if (pthread_create(&haptic, NULL, haptic_thread, s)) return 1;
    int drawn = !pthread_create(&drawing, NULL, drawing_thread, s);
    struct timespec time = {(time_t)s->seconds, (long)(1e9 * fmod(s->seconds, 1))};
    nanosleep(&time, NULL);
    atomic_store(&s->over, 1);
    pthread_join(haptic, NULL);
    if (drawn) pthread_join(drawing, NULL);
    lar_session_status_get(s->session, &status);
    printf("haptic   %ld times in %.1f s, strongest force %.3f N\n", s->asked, s->seconds,
           s->strongest);
    printf("engine   %llu ticks, %llu late, %.2f times real time\n",
           (unsigned long long)status.ticks, (unsigned long long)status.misses,
           status.real_time_factor);
    return !drawn;
}

int main(int argc, char **argv) {
    lar_error error = {LAR_OK, "no thread could be started"};
    char *end = "";
    simulator s = {.seconds = argc > 1 ? strtod(argv[1], &end) : 20};
    if (*end || !(s.seconds > 0)) {
        fputs("usage: simulator [SECONDS [SCENE]]\n", stderr);
        return 2;
    }
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    int failed = (argc > 2 ? lar_model_open(argv[2], &model, &error) : make_slab(&model, &error)) ||
                 lar_simulation_create(model, NULL, &simulation, &error) ||
                 lar_session_open(simulation, NULL, &s.session, &error) ||
                 lar_snapshot_create(s.session, &s.snapshot, &error);
    s.model = model;
    failed = failed || play(&s, &error);
    if (failed) fprintf(stderr, "simulator: %s\n", error.message);
    lar_snapshot_destroy(s.snapshot);
    lar_session_close(s.session, NULL);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return failed;
}
