/* Random sessions: a probe and a grasper that fly around and through a body, a hand that pulls at
 * its surface, gravity that comes and goes. The same for a seed on every machine; prints a row per
 * session. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/quaternion.h"
#include "base/vector.h"
#include "divide/random.h"
#include "fleet.h"
#include "tool.h"

static const char usage[] =
    "hands SCENE [OPTION...]: random sessions with a body of `lariat mesh`.\n"
    "  --sessions N    how many; default 5\n"
    "  --seed N        of the first; default 1\n"
    "  --seconds S     simulated, of each; default 10\n"
    "  --name NAME     of the rows; default: the scene\n"
    "  --without-hand  nothing pulls\n"
    "  --weightless    gravity stays as the scene has it\n"
    "  --contact       the surface touches itself\n"
    "  --coupled       hands lead by springs, as in a session\n"
    "  --grid XxYxZ    processors\n"
    "  --comm BACKEND  these as processes would be: shm, tcp\n"
    "  --every N       looks at the state every N ms; default 5\n"
    "  --log           says on stderr what is done when\n"
    "  --rows          without the table's head\n"
    "  --head          nothing but that\n"
    "stops: how often it broke, and was reset; inside: how long a tool's middle line was in the\n"
    "body; inverted: how long elements had a mean det F <= 0, and how many at most; energy: the\n"
    "largest error of the account, in per cent of all that was in it then, and in joules; hash: "
    "of\n"
    "the last state.\n";

enum { PROBE, GRASPER, HAND, TOOLS };

static const double FASTEST = 1, SLOWEST = 0.05; /* [m/s] */
static const double PULL = 0.1;                  /* [m] */
static const double TURN = 1.5;                  /* at most, of a leg [rad] */

typedef struct lar_hands_options {
    const char *scene, *name, *grid, *comm;
    double seconds;
    int sessions, without_hand, weightless, contact, coupled, every, log, rows, head;
    uint64_t seed;
} lar_hands_options;

/* A way from one pose to the next, slow at both ends. */
typedef struct lar_leg {
    lar_tool_pose from, to;
    double start, end; /* [s] */
} lar_leg;

/* What came of it. Times in milliseconds. */
typedef struct lar_outcome {
    int stops, resets, grips, inverted, negative;
    double inside[2], inverted_ms, min_corner, energy, energy_part, seconds, peak;
    double first; /* time of the first stop in the session [s] */
    uint64_t steps, hash;
    char message[1016];
} lar_outcome;

typedef struct lar_hands {
    const lar_hands_options *options;
    lar_body *body;
    lar_simulation *simulation;
    lar_random random;
    lar_guide guide[TOOLS];
    lar_leg leg[TOOLS];
    int tools;             /* that are led: with or without the hand */
    int pulls;             /* legs that the hand still makes; 0: it holds nothing */
    double grip[3];        /* where it took hold [m] */
    lar_random weather;    /* of gravity: without it all the rest is the same */
    bool heavy;            /* gravity is on */
    double time, reset_at; /* of the session; resets do not change it [s] */
    double turn_at;        /* when gravity comes or goes [s] */
    double turnover;       /* the most energy that was in the account [J] */
    lar_outcome out;
} lar_hands;

/* ---- random ways --------------------------------------------------------------------------- */

static double between(lar_hands *h, double low, double high) {
    return low + (high - low) * lar_random_unit(&h->random);
}

/* Somewhere in or around the body: mostly at a node, else in a box a third larger. */
static void random_place(lar_hands *h, double place[3]) {
    const lar_body *body = h->body;
    int32_t node = lar_random_below(&h->random, body->nodes);
    bool at_node = lar_random_unit(&h->random) < 0.6;
    for (int i = 0; i < 3; i++) {
        double low = h->body->rest_lower[i], high = h->body->rest_upper[i];
        double spare = 0.3 * (high - low);
        place[i] = between(h, low - spare, high + spare);
        if (at_node) place[i] = body->rest[node][i];
    }
}

static void random_turn(lar_hands *h, const double from[4], double to[4]) {
    double wanted[4];
    do
        for (int i = 0; i < 4; i++) wanted[i] = lar_random_normal(&h->random);
    while (!lar_quaternion_normalise(wanted));
    double angle = lar_quaternion_angle(from, wanted);
    lar_quaternion_blend(from, wanted, angle > TURN ? TURN / angle : 1, to);
}

/* How long a leg takes: no part of the tool goes so far in a step that the engine refuses it. */
static double duration_of(lar_hands *h, int tool, const lar_leg *leg) {
    const lar_tool_info *info = &h->guide[tool].info;
    double max = 0.15 * info->radius / lar_simulation_time_step(h->simulation); /* of a half */
    double speed = fmin(max, between(h, SLOWEST, FASTEST) / 1.5);
    double turn = lar_quaternion_angle(leg->from.orientation, leg->to.orientation) * info->length;
    double jaws = fabs(leg->from.opening - leg->to.opening) * 0.5 * info->length * info->spread;
    double way = lar_apart(leg->from.position, leg->to.position);
    return 0.02 + fmax(way / speed, fmax(1.3 * turn, jaws) / fmin(max, FASTEST / 1.5));
}

static void next_leg(lar_hands *h, int tool) {
    lar_leg *leg = &h->leg[tool];
    leg->from = leg->to;
    leg->start = h->time;
    if (lar_random_unit(&h->random) < 0.2) { /* rests */
        leg->end = h->time + between(h, 0.05, 0.3);
        return;
    }
    random_place(h, leg->to.position);
    random_turn(h, leg->from.orientation, leg->to.orientation);
    if (tool == GRASPER) leg->to.opening = lar_random_unit(&h->random) < 0.5 ? 0 : 1;
    leg->end = h->time + duration_of(h, tool, leg);
}

static void log_it(const lar_hands *h, const char *what, const double place[3]) {
    if (h->options->log)
        fprintf(stderr, "%.4f s: %s (%.4f, %.4f, %.4f)\n", h->time, what, place[0], place[1],
                place[2]);
}

/* The hand takes hold, pulls some times, lets go, waits. */
static void next_pull(lar_hands *h) {
    lar_leg *leg = &h->leg[HAND];
    leg->from = leg->to;
    leg->start = h->time;
    if (h->pulls == 0) {
        lar_body_look(h->body, h->simulation);
        int32_t chosen = lar_random_below(&h->random, h->body->surface.nodes);
        memcpy(h->grip, h->body->x[h->body->surface.node[chosen]], sizeof h->grip);
        memcpy(leg->to.position, h->grip, sizeof h->grip);
        leg->to.opening = 0;
        leg->from = leg->to;
        leg->end = h->time + 0.01;
        h->pulls = 2 + lar_random_below(&h->random, 3);
        h->out.grips++;
        log_it(h, "takes hold at", h->grip);
        return;
    }
    if (--h->pulls == 0) {
        leg->from.opening = leg->to.opening = 1;
        leg->end = h->time + between(h, 0.05, 0.8);
        log_it(h, "lets go at", leg->to.position);
        return;
    }
    double way[3], length;
    do {
        for (int i = 0; i < 3; i++) way[i] = between(h, -PULL, PULL);
        length = lar_length(way);
    } while (length > PULL);
    for (int i = 0; i < 3; i++) leg->to.position[i] = h->grip[i] + way[i];
    leg->end = h->time + duration_of(h, HAND, leg) + between(h, 0, 0.3);
}

static lar_tool_pose pose_on(const lar_leg *leg, double time) {
    double t = fmax(0, fmin(1, (time - leg->start) / (leg->end - leg->start)));
    double share = t * t * (3 - 2 * t);
    lar_tool_pose pose = leg->to;
    for (int i = 0; i < 3; i++)
        pose.position[i] = (1 - share) * leg->from.position[i] + share * leg->to.position[i];
    lar_quaternion_blend(leg->from.orientation, leg->to.orientation, share, pose.orientation);
    pose.opening = (1 - share) * leg->from.opening + share * leg->to.opening;
    return pose;
}

/* ---- a session ----------------------------------------------------------------------------- */

static void begin_anew(lar_hands *h) {
    for (int t = 0; t < h->tools; t++) {
        lar_guide_reset(&h->guide[t], h->simulation);
        h->leg[t] = (lar_leg){.from = h->guide[t].sent, .to = h->guide[t].sent, .end = h->time};
    }
    h->pulls = h->turnover = 0;
    h->reset_at = h->time + between(h, 2, 8);
    h->heavy = false;
    h->turn_at = h->time + 0.2 + 2 * lar_random_unit(&h->weather);
}

static lar_status go_back(lar_hands *h, lar_error *error) {
    static const double nowhere[3];
    log_it(h, "reset", nowhere);
    lar_status status = lar_simulation_reset(h->simulation, error);
    if (!status) begin_anew(h);
    return status;
}

/* Earth's, in any direction, or none. */
static lar_status turn_gravity(lar_hands *h, lar_error *error) {
    double gravity[3] = {0}, length = 0;
    h->heavy = !h->heavy;
    while (h->heavy && !(length > 0)) {
        for (int i = 0; i < 3; i++) gravity[i] = lar_random_normal(&h->weather);
        length = lar_length(gravity);
    }
    for (int i = 0; i < 3 && h->heavy; i++) gravity[i] *= 9.81 / length;
    h->turn_at = h->time + 0.2 + 2 * lar_random_unit(&h->weather);
    log_it(h, "gravity", gravity);
    return lar_simulation_set_gravity(h->simulation, gravity, error);
}

static void account(lar_hands *h) {
    lar_energy e;
    lar_simulation_energy(h->simulation, &e);
    double error =
        fabs(e.kinetic + e.strain + e.hourglass + e.damping + e.contact + e.viscous - e.external);
    h->turnover = fmax(h->turnover, fabs(e.kinetic) + fabs(e.strain) + fabs(e.hourglass) +
                                        fabs(e.damping) + fabs(e.contact) + fabs(e.viscous));
    h->out.energy = fmax(h->out.energy, error);
    /* Less than a millijoule is nothing to take parts of. */
    h->out.energy_part = fmax(h->out.energy_part, 100 * error / fmax(1e-3, h->turnover));
}

static void look(lar_hands *h, double ms, bool energy) {
    lar_body_look(h->body, h->simulation);
    for (int t = 0; t < HAND; t++) {
        lar_tool_pose pose;
        lar_simulation_tool_pose(h->simulation, t, &pose, NULL);
        const lar_line line = lar_tool_line(&h->guide[t].info, &pose);
        if (lar_line_winding(&line, h->body) > 0.5) h->out.inside[t] += ms;
    }
    lar_shape shape = lar_body_shape(h->body);
    if (shape.inverted > 0) h->out.inverted_ms += ms;
    if (shape.inverted > h->out.inverted) h->out.inverted = shape.inverted;
    if (shape.negative > h->out.negative) h->out.negative = shape.negative;
    h->out.min_corner = fmin(h->out.min_corner, shape.min_corner);
    if (energy) account(h); /* takes longer than all the rest */
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static lar_status tick(lar_hands *h, lar_error *error) {
    lar_status status = LAR_OK;
    for (int t = 0; t < h->tools && !status; t++) {
        if (h->time >= h->leg[t].end) {
            if (t == HAND)
                next_pull(h);
            else
                next_leg(h, t);
        }
        const lar_tool_pose pose = pose_on(&h->leg[t], h->time);
        status = lar_guide_follow(&h->guide[t], h->simulation, &pose, error);
    }
    if (!status && !h->options->weightless && h->time >= h->turn_at)
        status = turn_gravity(h, error);
    double begun = now();
    if (!status) status = lar_simulation_advance(h->simulation, h->guide[0].steps, error);
    h->out.seconds += now() - begun;
    for (int t = 0; t < h->tools && !status; t++) {
        lar_tool_force force;
        lar_guide_feel(&h->guide[t], h->simulation);
        lar_simulation_tool_force(h->simulation, t, &force, NULL);
        h->out.peak = fmax(h->out.peak, lar_length(force.force));
    }
    h->out.steps += h->guide[0].steps;
    return status;
}

static lar_status broke(lar_hands *h, lar_error *error) {
    static const double nowhere[3];
    log_it(h, error->message, nowhere);
    if (h->out.stops++ == 0) {
        h->out.first = h->time;
        snprintf(h->out.message, sizeof h->out.message, "%s", error->message);
    }
    return go_back(h, error);
}

static lar_status play(lar_hands *h, lar_error *error) {
    double seconds = (double)h->guide[0].steps * lar_simulation_time_step(h->simulation);
    uint64_t every = (uint64_t)fmax(1, round(1e-3 * h->options->every / seconds));
    uint64_t ticks = (uint64_t)ceil(h->options->seconds / seconds);
    lar_status status = LAR_OK;
    for (uint64_t n = 1; n <= ticks && !status; n++) {
        h->time = (double)n * seconds;
        status = tick(h, error);
        if (status == LAR_ERROR_UNSTABLE)
            status = broke(h, error);
        else if (!status && n % every == 0)
            look(h, 1e3 * seconds * (double)every, n % (4 * every) == 0);
        if (!status && h->time > h->reset_at) {
            h->out.resets++;
            status = go_back(h, error);
        }
    }
    h->out.hash = lar_simulation_hash(h->simulation);
    return status;
}

static void print_head(void) {
    puts(
        "| body | elements | seed | stops | resets | grips | probe inside, ms | grasper inside, ms "
        "| inverted, ms | inverted | negative | least corner | energy, % | energy, J | peak, N "
        "| refused | steps/s | hash | first stop |");
    puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
}

static void print_row(const lar_hands *h, uint64_t seed) {
    const lar_outcome *o = &h->out;
    const char *why = strstr(o->message, "): ");
    uint64_t refused = 0;
    for (int t = 0; t < h->tools; t++) refused += h->guide[t].refused;
    printf("| %s | %d | %llu | %d | %d | %d | %.0f | %.0f | %.0f | %d | %d | %.3g | %.3g | %.2g "
           "| %.3g | %llu | %.0f | %016llx | ",
           h->options->name, h->body->elements, (unsigned long long)seed, o->stops, o->resets,
           o->grips, o->inside[PROBE], o->inside[GRASPER], o->inverted_ms, o->inverted, o->negative,
           o->min_corner, o->energy_part, o->energy, o->peak, (unsigned long long)refused,
           (double)o->steps / o->seconds, (unsigned long long)o->hash);
    if (o->stops)
        printf("%.3f s: %s |\n", o->first, why ? why + 3 : o->message);
    else
        puts("no |");
    fflush(stdout);
}

static lar_status session(const lar_hands_options *options, const lar_model *model, lar_body *body,
                          uint64_t seed, lar_error *error) {
    lar_hands h = {.options = options,
                   .body = body,
                   .random = {.state = seed},
                   .weather = {.state = ~seed},
                   .tools = options->without_hand ? HAND : TOOLS};
    lar_options with = lar_options_default();
    with.grid = options->grid;
    with.hands = h.tools - HAND;
    h.out.min_corner = INFINITY;
    static lar_fleet fleet;
    lar_status status = LAR_OK;
    if (options->comm) status = lar_fleet_start(&fleet, model, options->comm, &with, error);
    if (!status) status = lar_simulation_create(model, &with, &h.simulation, error);
    for (int t = 0; t < h.tools && !status; t++)
        status = lar_guide_create(h.simulation, t, options->coupled, &h.guide[t], error);
    if (!status) {
        begin_anew(&h);
        status = play(&h, error);
    }
    if (!status) print_row(&h, seed);
    lar_simulation_destroy(h.simulation);
    lar_fleet_join(&fleet);
    return status;
}

/* ---- the program --------------------------------------------------------------------------- */

/* A probe beside the body, a grasper on the other side. */
static lar_status open_scene(const lar_hands_options *options, lar_model **model, lar_body *body,
                             lar_error *error) {
    char tools[512];
    double middle[3], half[3];
    lar_status status = lar_scene_with(options->scene, "", 0, model, error);
    if (!status) status = lar_body_create(*model, body, error);
    if (status) return status;
    for (int i = 0; i < 3; i++) {
        middle[i] = 0.5 * (body->rest_upper[i] + body->rest_lower[i]);
        half[i] = 0.5 * (body->rest_upper[i] - body->rest_lower[i]);
    }
    snprintf(tools, sizeof tools,
             "  - { name: probe, shape: sphere, radius: 0.005, at: [%.17g, %.17g, %.17g] }\n"
             "  - { name: grasper, shape: grasper, radius: 0.0015, length: 0.02, spread: 60,\n"
             "      at: [%.17g, %.17g, %.17g], towards: [1, 0, 0] }\n",
             middle[0] + half[0] + 0.03, middle[1], middle[2], middle[0] - half[0] - 0.05,
             middle[1], middle[2]);
    lar_body_clear(body);
    lar_model_destroy(*model);
    *model = NULL;
    status = lar_scene_with(options->scene, tools, options->contact, model, error);
    return status ? status : lar_body_create(*model, body, error);
}

static lar_hands_options read_options(int count, char **word) {
    static const struct option known[] = {
        {"sessions", 1, 0, 'n'},   {"seed", 1, 0, 's'},    {"seconds", 1, 0, 'S'},
        {"name", 1, 0, 'N'},       {"contact", 0, 0, 'C'}, {"coupled", 0, 0, 'H'},
        {"grid", 1, 0, 'g'},       {"every", 1, 0, 'e'},   {"log", 0, 0, 'l'},
        {"rows", 0, 0, 'r'},       {"head", 0, 0, 'h'},    {"without-hand", 0, 0, 'w'},
        {"weightless", 0, 0, 'W'}, {"comm", 1, 0, 'c'},    {0}};
    lar_hands_options o = {.sessions = 5, .seed = 1, .seconds = 10, .every = 5};
    for (int c; (c = getopt_long(count, word, "", known, NULL)) != -1;) {
        if (c == 'n') o.sessions = atoi(optarg);
        if (c == 's') o.seed = strtoull(optarg, NULL, 0);
        if (c == 'S') o.seconds = strtod(optarg, NULL);
        if (c == 'N') o.name = optarg;
        if (c == 'C') o.contact = 1;
        if (c == 'H') o.coupled = 1;
        if (c == 'g') o.grid = optarg;
        if (c == 'c') o.comm = optarg;
        if (c == 'e') o.every = atoi(optarg);
        if (c == 'l') o.log = 1;
        if (c == 'r') o.rows = 1;
        if (c == 'h') o.head = 1;
        if (c == 'w') o.without_hand = 1;
        if (c == 'W') o.weightless = 1;
        if (c == '?') exit(2);
    }
    if (optind + 1 == count) o.scene = word[optind];
    if (!o.name) o.name = o.scene;
    return o;
}

int main(int count, char **word) {
    lar_error error = {0};
    lar_model *model = NULL;
    lar_body body = {0};
    const lar_hands_options options = read_options(count, word);
    if (options.head) print_head();
    if (options.head) return 0;
    if (!options.scene) {
        fputs(usage, stderr);
        return 2;
    }
    lar_status status = open_scene(&options, &model, &body, &error);
    if (!status && !options.rows) print_head();
    for (int n = 0; n < options.sessions && !status; n++)
        status = session(&options, model, &body, options.seed + (uint64_t)n, &error);
    if (status) fprintf(stderr, "hands: %s\n", error.message);
    lar_body_clear(&body);
    lar_model_destroy(model);
    return status ? 1 : 0;
}
