/* Plays scripts as a session does, without a clock, and prints what came of it: a row, and where it
 * is asked for a line per look. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/error.h"
#include "base/vector.h"
#include "simulation/simulation.h"
#include "session/device/device.h"
#include "tool.h"

static const char usage[] =
    "scripts SCENE [OPTION...]: moves the tools of a scene as files say.\n"
    "  --device TOOL=FILE.csv  may be given for every tool\n"
    "  --seconds S             simulated; default 30\n"
    "  --grid XxYxZ            processors\n"
    "  --every N               looks at the state every N ms; default 10\n"
    "  --inside                looks also whether a tool's middle line is in the body\n"
    "  --trace FILE            all that is seen, as CSV\n"
    "The row: when and why it stopped; how long a tool's middle line was in the body; the largest\n"
    "force on a tool and of its jaws; the largest speed of a node, and when; divided steps;\n"
    "processor time as a part of the time simulated, of all and of the slowest tenth of a second;\n"
    "the last state's hash. Where strained elements may be heavier, a line about that.\n";

enum { DEVICES = 4 };

typedef struct lar_scripts_options {
    const char *scene, *grid, *trace, *device[DEVICES];
    double seconds;
    int devices, every, inside;
} lar_scripts_options;

/* A tool that a file leads. */
typedef struct lar_led {
    lar_guide guide;
    lar_device *device;
    lar_tool_pose hand;
} lar_led;

typedef struct lar_scripts {
    const lar_scripts_options *options;
    lar_model *model;
    lar_simulation *simulation;
    lar_body body;
    lar_led led[DEVICES];
    double tick;         /* [s] */
    double busy;         /* processor time since the last tenth of a second began [s] */
    double all, slowest; /* processor time, and the most of a tenth of a second [s] */
    double force, grasp_force, inside; /* the largest [N]; [s] */
    double fastest, fastest_at;        /* [m/s] [s] */
    FILE *trace;
} lar_scripts;

/* ---- opening ------------------------------------------------------------------------------- */

static lar_status attach(lar_scripts *s, const char *text, lar_led *led, lar_error *error) {
    const char *file = strchr(text, '=');
    char spec[4096];
    if (!file) return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: write TOOL=FILE.csv", text);
    snprintf(spec, sizeof spec, "script:%s", file + 1);
    for (int32_t t = 0; t < lar_simulation_tool_count(s->simulation); t++) {
        lar_tool_info info;
        lar_status status = lar_simulation_tool(s->simulation, t, &info, error);
        if (status) return status;
        if (strncmp(info.name, text, (size_t)(file - text)) != 0) continue;
        status = lar_guide_create(s->simulation, t, 1, &led->guide, error);
        return status ? status : lar_device_open(spec, &info, &led->device, error);
    }
    return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: there is no such tool", text);
}

static lar_status open_all(lar_scripts *s, lar_error *error) {
    lar_options options = lar_options_default();
    options.grid = s->options->grid;
    options.hands = 4; /* as lariat view has them */
    lar_status status = lar_model_open(s->options->scene, &s->model, error);
    if (!status) status = lar_body_create(s->model, &s->body, error);
    if (!status) status = lar_simulation_create(s->model, &options, &s->simulation, error);
    for (int i = 0; i < s->options->devices && !status; i++)
        status = attach(s, s->options->device[i], &s->led[i], error);
    if (status) return status;
    s->tick = (double)lar_tick_steps(s->simulation) * lar_simulation_time_step(s->simulation);
    if (s->options->trace) s->trace = fopen(s->options->trace, "w");
    if (s->trace)
        fputs("time,tool,hand_opening,opening,fx,fy,fz,grasp,held,touching,limited,apart,depth,"
              "parts,hardness,need,fastest,near,kinetic,winding,us\n",
              s->trace);
    return LAR_OK;
}

static void close_all(lar_scripts *s) {
    for (int i = 0; i < s->options->devices; i++) lar_device_close(s->led[i].device);
    if (s->trace) fclose(s->trace);
    lar_simulation_destroy(s->simulation);
    lar_body_clear(&s->body);
    lar_model_destroy(s->model);
}

/* ---- playing ------------------------------------------------------------------------------- */

static double processor_time(void) {
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static lar_status tick(lar_scripts *s, double time, lar_error *error) {
    const lar_device_tick now = {.time = time, .seconds = s->tick};
    lar_status status = LAR_OK;
    double begun = processor_time();
    for (int i = 0; i < s->options->devices && !status; i++) {
        lar_led *led = &s->led[i];
        lar_device_poll(led->device, &now, &led->hand);
        status = lar_guide_follow(&led->guide, s->simulation, &led->hand, error);
    }
    if (!status) status = lar_simulation_advance(s->simulation, s->led[0].guide.steps, error);
    for (int i = 0; i < s->options->devices && !status; i++)
        lar_guide_feel(&s->led[i].guide, s->simulation);
    s->busy += processor_time() - begun;
    return status;
}

/* The fastest node, and the fastest within `reach` of a place. */
static double fastest_node(const lar_scripts *s, const double place[3], double reach) {
    double max = 0;
    for (int32_t n = 0; n < s->body.nodes; n++) {
        double v[3];
        if (place && lar_apart(s->body.x[n], place) > reach) continue;
        lar_state_velocity(&s->simulation->state, s->simulation->domain.layout.local[n], v);
        max = fmax(max, lar_length(v));
    }
    return max;
}

static void trace(lar_scripts *s, const lar_led *led, const lar_tool_force *force, double winding) {
    const lar_step_division *division = &s->simulation->tools.division;
    lar_tool_pose pose;
    lar_energy energy;
    lar_simulation_tool_pose(s->simulation, led->guide.tool, &pose, NULL);
    lar_simulation_energy(s->simulation, &energy);
    fprintf(s->trace,
            "%.4f,%s,%.3f,%.4f,%.4f,%.4f,%.4f,%.4f,%d,%d,%d,%.5f,%.6f,%d,%.2f,%.3f,%.4f,%.4f,%.3g,"
            "%.2f,%.1f\n",
            lar_simulation_time(s->simulation), led->guide.info.name, led->hand.opening,
            pose.opening, force->force[0], force->force[1], force->force[2], force->grasp_force,
            (int)force->held, (int)force->touching, (int)force->limited, force->apart, force->depth,
            (int)division->parts, division->hardness, division->lately, fastest_node(s, NULL, 0),
            fastest_node(s, pose.position, led->guide.info.length + 0.005), energy.kinetic, winding,
            1e6 * s->busy);
}

static void look(lar_scripts *s, double seconds) {
    double time = lar_simulation_time(s->simulation);
    lar_body_look(&s->body, s->simulation);
    double fastest = fastest_node(s, NULL, 0);
    if (fastest > s->fastest) s->fastest = fastest, s->fastest_at = time;
    for (int i = 0; i < s->options->devices; i++) {
        const lar_led *led = &s->led[i];
        lar_tool_force force;
        lar_tool_pose pose;
        lar_simulation_tool_force(s->simulation, led->guide.tool, &force, NULL);
        lar_simulation_tool_pose(s->simulation, led->guide.tool, &pose, NULL);
        double winding = 0;
        if (s->options->inside) {
            const lar_line line = lar_tool_line(&led->guide.info, &pose);
            winding = lar_line_winding(&line, &s->body);
        }
        if (winding > 0.5) s->inside += seconds;
        s->force = fmax(s->force, lar_length(force.force));
        s->grasp_force = fmax(s->grasp_force, force.grasp_force);
        if (s->trace) trace(s, led, &force, winding);
    }
    s->all += s->busy;
    s->slowest = fmax(s->slowest, s->busy / seconds);
    s->busy = 0;
}

static lar_status play(lar_scripts *s, lar_error *error) {
    int every = (int)fmax(1, round(1e-3 * s->options->every / s->tick));
    lar_status status = LAR_OK;
    for (int n = 0; n * s->tick < s->options->seconds && !status; n++) {
        status = tick(s, n * s->tick, error);
        if (!status && (n + 1) % every == 0) look(s, every * s->tick);
    }
    return status;
}

/* ---- the program --------------------------------------------------------------------------- */

static void print_row(lar_scripts *s, const char *why) {
    int32_t max;
    lar_heavier heavier;
    lar_energy e;
    double time = lar_simulation_time(s->simulation);
    uint64_t divided = lar_simulation_divided_steps(s->simulation, &max);
    printf(
        "| %s | inside %.3f s | %.3g N | grasp %.3g N | %.3g m/s at %.3f s | %llu steps in up to "
        "%d | %.3g x, worst %.3g x | %016llx |\n",
        *why ? why : "no stop", s->inside, s->force, s->grasp_force, s->fastest, s->fastest_at,
        (unsigned long long)divided, (int)max, s->all / time, s->slowest,
        (unsigned long long)lar_simulation_hash(s->simulation));
    lar_simulation_heavier(s->simulation, &heavier);
    lar_simulation_energy(s->simulation, &e);
    if (heavier.largest_share > 0)
        printf("heavier by %.3g %% on average, %.3g %% at most; of %.3g J outside %.2g missing\n",
               100 * heavier.mean_share, 100 * heavier.largest_share, e.external,
               fabs(e.kinetic + e.strain + e.hourglass + e.damping + e.contact + e.viscous -
                    e.external) /
                   fabs(e.external));
}

static lar_scripts_options read_options(int count, char **word) {
    static const struct option known[] = {{"device", 1, 0, 'd'},
                                          {"seconds", 1, 0, 'S'},
                                          {"grid", 1, 0, 'g'},
                                          {"every", 1, 0, 'e'},
                                          {"inside", 0, 0, 'i'},
                                          {"trace", 1, 0, 'c'},
                                          {0}};
    lar_scripts_options o = {.seconds = 30, .every = 10};
    for (int c; (c = getopt_long(count, word, "", known, NULL)) != -1;) {
        if (c == 'd' && o.devices < DEVICES) o.device[o.devices++] = optarg;
        if (c == 'S') o.seconds = strtod(optarg, NULL);
        if (c == 'g') o.grid = optarg;
        if (c == 'e') o.every = atoi(optarg);
        if (c == 'i') o.inside = 1;
        if (c == 'c') o.trace = optarg;
        if (c == '?') exit(2);
    }
    if (optind + 1 == count) o.scene = word[optind];
    return o;
}

int main(int count, char **word) {
    lar_error error = {0};
    const lar_scripts_options options = read_options(count, word);
    lar_scripts s = {.options = &options};
    if (!options.scene || options.devices == 0) {
        fputs(usage, stderr);
        return 2;
    }
    lar_status status = open_all(&s, &error);
    if (!status) {
        status = play(&s, &error);
        print_row(&s, error.message);
        if (status == LAR_ERROR_UNSTABLE) status = LAR_OK;
    }
    if (status) fprintf(stderr, "scripts: %s\n", error.message);
    close_all(&s);
    return status ? 1 : 0;
}
