/* Pushes instruments into an organ as a hand would, and prints what came of it, a row per case. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/error.h"
#include "base/vector.h"
#include "tool.h"

static const char usage[] =
    "push SCENE [OPTION...]: pushes a tool into the body of a scene of `lariat mesh`, waits, "
    "draws\n"
    "it out and waits. All combinations of the lists that these options take:\n"
    "  --tool LIST     sphere3, sphere5, sphere10, shaft, shaft-lying, grasper; default sphere5\n"
    "  --speed LIST    of the hand [m/s]; default 0.1\n"
    "  --from LIST     the side: +x, -x, +y, ..., or +x-z between two; default +z\n"
    "  --name NAME     of the rows; default: the scene\n"
    "  --deep M        how deep [m]; default 0.03\n"
    "  --through       to 20 mm beyond the far side instead\n"
    "  --behind M      so far behind its start it is drawn out; default 0 [m]\n"
    "  --slant DEG     not along the face's normal but so much beside it\n"
    "  --grasp         jaws close while they wait inside, and open at the end\n"
    "  --contact       the surface touches itself\n"
    "  --coupled       the hand leads the tool by a spring, as in a session\n"
    "  --grid XxYxZ    processors\n"
    "  --every N       looks at the state every N ms; default 2\n"
    "  --trace FILE    all that is seen, as CSV; of the last case\n"
    "  --rows          without the table's head\n"
    "  --head          nothing but that\n"
    "winding: the largest winding number of the surface around the tool's middle line; inside: "
    "how\n"
    "long it was above 0.5; apart: between tool and hand; after: the force at the end; J: det F "
    "of\n"
    "the mean gradient; corner: Jacobian of the worst corner as a part of that at rest; left: the\n"
    "largest displacement at the end in per cent of the body's diagonal.\n";

static const double AWAY = 0.002, BEYOND = 0.02, WAIT = 0.2, REST = 1;

typedef struct lar_kind {
    const char *name, *shape;
    double radius, length;
    bool lying;
} lar_kind;

static const lar_kind kinds[] = {
    {"sphere3", "sphere", 0.003, 0, false},        {"sphere5", "sphere", 0.005, 0, false},
    {"sphere10", "sphere", 0.010, 0, false},       {"shaft", "capsule", 0.0025, 0.1, false},
    {"shaft-lying", "capsule", 0.0025, 0.1, true}, {"grasper", "grasper", 0.0015, 0.02, false},
};

typedef struct lar_push_options {
    const char *scene, *name, *tools, *speeds, *sides, *grid, *trace;
    double deep, slant, behind;
    int through, grasp, contact, coupled, every, rows, head;
} lar_push_options;

/* One case. */
typedef struct lar_push {
    const lar_push_options *options;
    const lar_kind *kind;
    double speed;
    char side[16];
    lar_body *body;
    double entry[3], inward[3], towards[3]; /* towards: where the tip points */
    double travel;                          /* [m] */
    lar_model *model;
    lar_simulation *simulation;
    lar_guide guide;
    lar_tool_pose start, hand, pose;
    FILE *trace;
} lar_push;

/* What came of it. */
typedef struct lar_outcome {
    double winding, inside, peak, apart, after, left;
    lar_shape shape;
    uint64_t steps;
    double seconds;
    bool stopped;
} lar_outcome;

/* ---- where it begins ----------------------------------------------------------------------- */

/* "+x-z" as a unit vector. */
static bool read_side(const char *text, double direction[3]) {
    double length;
    memset(direction, 0, 3 * sizeof *direction);
    for (; text[0]; text += 2) {
        if ((text[0] != '+' && text[0] != '-') || text[1] < 'x' || text[1] > 'z') return false;
        direction[text[1] - 'x'] = text[0] == '+' ? 1 : -1;
    }
    length = lar_length(direction);
    for (int i = 0; i < 3; i++) direction[i] /= length;
    return length > 0;
}

static void choose_way(lar_push *p, const double side[3]) {
    double normal[3], tangent[3], min[3] = {0}, slant = p->options->slant * acos(-1) / 180;
    int axis = 0;
    lar_body_face(p->body, lar_body_extreme(p->body, side), p->entry, normal);
    for (int i = 1; i < 3; i++)
        if (fabs(normal[i]) < fabs(normal[axis])) axis = i;
    min[axis] = 1;
    lar_cross(normal, min, tangent);
    double length = lar_length(tangent);
    for (int i = 0; i < 3; i++) {
        tangent[i] /= length;
        p->inward[i] = sin(slant) * tangent[i] - cos(slant) * normal[i];
        p->towards[i] = p->kind->lying ? tangent[i] : p->inward[i];
    }
}

static lar_status open_with_tool(lar_push *p, const double at[3], lar_error *error) {
    char text[512], size[96] = "";
    const lar_kind *kind = p->kind;
    if (kind->length > 0) snprintf(size, sizeof size, ", length: %.17g", kind->length);
    snprintf(text, sizeof text,
             "  - { name: tool, shape: %s, radius: %.17g%s,\n"
             "      at: [%.17g, %.17g, %.17g]%s",
             kind->shape, kind->radius, size, at[0], at[1], at[2], kind->length > 0 ? "," : " }\n");
    if (kind->length > 0)
        snprintf(text + strlen(text), sizeof text - strlen(text),
                 "\n      towards: [%.17g, %.17g, %.17g] }\n", p->towards[0], p->towards[1],
                 p->towards[2]);
    return lar_scene_with(p->options->scene, text, p->options->contact, &p->model, error);
}

/* The tool's tip when the middle of what goes in is at a distance from the entry. */
static void tip_at(const lar_push *p, double away, double tip[3]) {
    for (int i = 0; i < 3; i++)
        tip[i] = p->entry[i] - away * p->inward[i] +
                 (p->kind->lying ? 0.5 * p->kind->length * p->towards[i] : 0);
}

/* From afar along the way until it is AWAY from touching; then the scene is opened anew with the
 * tool there. */
static lar_status place_tool(lar_push *p, lar_error *error) {
    double away = 2 * p->body->diagonal + p->kind->length, tip[3], gap = INFINITY;
    lar_tool_info info;
    tip_at(p, away, tip);
    lar_status status = open_with_tool(p, tip, error);
    if (!status) status = lar_model_tool(p->model, 0, &info, error);
    if (status) return status;
    for (int i = 0; i < 200 && gap > 1e-4 && away > -p->body->diagonal; i++) {
        tip_at(p, away, info.rest.position);
        const lar_line line = lar_tool_line(&info, &info.rest);
        gap = lar_line_gap(&line, p->body) - p->kind->radius - AWAY;
        if (gap > 1e-4) away -= gap;
    }
    tip_at(p, away, tip);
    lar_model_destroy(p->model);
    p->model = NULL;
    p->travel = AWAY + p->options->deep;
    if (p->options->through) {
        double from[3];
        for (int i = 0; i < 3; i++) from[i] = p->entry[i] - away * p->inward[i];
        p->travel = BEYOND + lar_body_beyond(p->body, from, p->inward);
    }
    return open_with_tool(p, tip, error);
}

/* ---- the push ------------------------------------------------------------------------------ */

/* Where the hand is at a time; false when all is over. */
static bool lead(lar_push *p, double time) {
    double way = p->travel / p->speed, back = way + p->options->behind / p->speed;
    double depth = 0, closed = 0;
    double t[4] = {time, time - way, time - way - WAIT, time - way - WAIT - back};
    if (t[1] <= 0)
        depth = t[0] * p->speed;
    else if (t[2] <= 0)
        depth = p->travel;
    else if (t[3] <= 0)
        depth = p->travel - t[2] * p->speed;
    else
        depth = -p->options->behind;
    if (t[1] > 0) closed = fmin(1, t[1] / (0.75 * WAIT));
    if (t[3] > 0) closed = 1 - fmin(1, t[3] / (0.75 * WAIT));
    p->hand = p->start;
    if (p->options->grasp) p->hand.opening = p->start.opening * (1 - closed);
    for (int i = 0; i < 3; i++) p->hand.position[i] += depth * p->inward[i];
    return t[3] <= REST;
}

static void look(lar_push *p, const double force[3], double ms, lar_outcome *out) {
    const lar_line line = lar_tool_line(&p->guide.info, &p->pose);
    lar_body_look(p->body, p->simulation);
    double winding = lar_line_winding(&line, p->body);
    lar_shape shape = lar_body_shape(p->body);
    out->winding = fmax(out->winding, winding);
    if (winding > 0.5) out->inside += ms;
    out->shape.min_volume = fmin(out->shape.min_volume, shape.min_volume);
    out->shape.min_corner = fmin(out->shape.min_corner, shape.min_corner);
    if (shape.inverted > out->shape.inverted) out->shape.inverted = shape.inverted;
    if (shape.negative > out->shape.negative) out->shape.negative = shape.negative;
    if (!p->trace) return;
    double way[2][3];
    lar_minus(p->hand.position, p->start.position, way[0]);
    lar_minus(p->pose.position, p->start.position, way[1]);
    fprintf(p->trace, "%.5f,%.6f,%.6f,%.5g,%.5g,%.5g,%.3f,%.5f,%.5f,%d,%d,%.6f\n",
            lar_simulation_time(p->simulation), lar_dot(way[0], p->inward),
            lar_dot(way[1], p->inward), force[0], force[1], force[2], winding, shape.min_volume,
            shape.min_corner, shape.inverted, shape.negative, lar_body_farthest(p->body, NULL));
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* One tick. */
static lar_status tick(lar_push *p, lar_outcome *out, lar_tool_force *force, lar_error *error) {
    lar_status status = lar_guide_follow(&p->guide, p->simulation, &p->hand, error);
    double begun = now();
    if (!status) status = lar_simulation_advance(p->simulation, p->guide.steps, error);
    out->seconds += now() - begun;
    if (status) return status;
    out->steps += p->guide.steps;
    lar_guide_feel(&p->guide, p->simulation);
    lar_simulation_tool_force(p->simulation, 0, force, NULL);
    lar_simulation_tool_pose(p->simulation, 0, &p->pose, NULL);
    out->after = lar_length(force->force);
    out->peak = fmax(out->peak, out->after);
    out->apart = fmax(out->apart, lar_apart(p->hand.position, p->pose.position));
    return LAR_OK;
}

static lar_status push(lar_push *p, lar_outcome *out, lar_error *error) {
    lar_options options = lar_options_default();
    lar_tool_force force = {0};
    options.grid = p->options->grid;
    lar_status status = lar_simulation_create(p->model, &options, &p->simulation, error);
    if (!status) status = lar_guide_create(p->simulation, 0, p->options->coupled, &p->guide, error);
    if (status) return status;
    p->start = p->pose = p->guide.sent;
    double seconds = (double)p->guide.steps * lar_simulation_time_step(p->simulation);
    int every = (int)fmax(1, round(1e-3 * p->options->every / seconds));
    for (int n = 1; lead(p, n * seconds) && !status; n++) {
        status = tick(p, out, &force, error);
        if (!status && n % every == 0) look(p, force.force, 1e3 * seconds * every, out);
    }
    lar_body_look(p->body, p->simulation);
    out->left = 100 * lar_body_farthest(p->body, NULL) / p->body->diagonal;
    out->stopped = status == LAR_ERROR_UNSTABLE;
    return out->stopped ? LAR_OK : status;
}

/* ---- rows ---------------------------------------------------------------------------------- */

static void print_head(void) {
    puts("| body | elements | tool | m/s | side | winding | inside, ms | peak, N | apart, mm "
         "| after, N | least J | inverted | least corner | negative | left, % | steps/s | stopped "
         "|");
    puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
}

static void print_row(const lar_push *p, const lar_outcome *out, const char *message) {
    const char *why = strstr(message, "): ");
    printf(
        "| %s | %d | %s%s%s | %g | %s | %.1f | %.0f | %.3g | %.2f | %.2g | %.3f | %d | %.3f | %d "
        "| ",
        p->options->name, p->body->elements, p->kind->name, p->options->through ? " through" : "",
        p->options->grasp ? " grasps" : "", p->speed, p->side, out->winding, out->inside, out->peak,
        1e3 * out->apart, out->after, out->shape.min_volume, out->shape.inverted,
        out->shape.min_corner, out->shape.negative);
    if (out->stopped)
        printf("- | %.0f | %.3f s: %s |", (double)out->steps / out->seconds,
               lar_simulation_time(p->simulation), why ? why + 3 : message);
    else
        printf("%.2g | %.0f | no |", out->left, (double)out->steps / out->seconds);
    if (p->guide.refused) printf(" %llu moves refused", (unsigned long long)p->guide.refused);
    putchar('\n');
    fflush(stdout);
}

static lar_status run_case(lar_push *p, lar_error *error) {
    lar_outcome out = {.winding = -INFINITY,
                       .shape = {.min_volume = INFINITY, .min_corner = INFINITY}};
    double side[3];
    if (!read_side(p->side, side) || !(p->speed > 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT, "a side is +x, -z, +x-y, ..., a speed above 0");
    *error = (lar_error){0};
    lar_body_look(p->body, NULL);
    choose_way(p, side);
    lar_status status = place_tool(p, error);
    if (p->options->trace) p->trace = fopen(p->options->trace, "w");
    if (p->trace)
        fputs("time,hand,tool,fx,fy,fz,winding,least J,least corner,inverted,negative,farthest\n",
              p->trace);
    if (!status) status = push(p, &out, error);
    if (!status) print_row(p, &out, error->message);
    if (p->trace) fclose(p->trace);
    p->trace = NULL;
    lar_simulation_destroy(p->simulation);
    lar_model_destroy(p->model);
    p->simulation = NULL;
    p->model = NULL;
    return status;
}

/* ---- lists --------------------------------------------------------------------------------- */

/* The next item of a list with commas; false at its end. */
static bool next_item(const char **list, char *item, size_t size) {
    size_t length = strcspn(*list, ",");
    if (length == 0) return false;
    snprintf(item, size, "%.*s", (int)length, *list);
    *list += length + ((*list)[length] == ',');
    return true;
}

static const lar_kind *find_kind(const char *name) {
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (strcmp(kinds[i].name, name) == 0) return &kinds[i];
    fprintf(stderr, "push: there is no tool %s\n", name);
    exit(2);
}

static lar_status run_all(const lar_push_options *options, lar_body *body, lar_error *error) {
    char tool[32], speed[32], side[16];
    lar_status status = LAR_OK, failed = LAR_OK;
    for (const char *t = options->tools; next_item(&t, tool, sizeof tool);)
        for (const char *s = options->speeds; next_item(&s, speed, sizeof speed);)
            for (const char *d = options->sides; next_item(&d, side, sizeof side);) {
                lar_push p = {.options = options,
                              .kind = find_kind(tool),
                              .speed = strtod(speed, NULL),
                              .body = body};
                snprintf(p.side, sizeof p.side, "%s", side);
                status = run_case(&p, error);
                if (!status) continue;
                fprintf(stderr, "push: %s %s %s %s: %s\n", options->name, tool, speed, side,
                        error->message);
                failed = status;
            }
    return failed;
}

static lar_push_options read_options(int count, char **word) {
    static const struct option known[] = {{"tool", 1, 0, 't'},
                                          {"speed", 1, 0, 's'},
                                          {"from", 1, 0, 'f'},
                                          {"name", 1, 0, 'n'},
                                          {"deep", 1, 0, 'd'},
                                          {"slant", 1, 0, 'l'},
                                          {"behind", 1, 0, 'B'},
                                          {"through", 0, 0, 'T'},
                                          {"grasp", 0, 0, 'G'},
                                          {"contact", 0, 0, 'C'},
                                          {"grid", 1, 0, 'g'},
                                          {"coupled", 0, 0, 'H'},
                                          {"every", 1, 0, 'e'},
                                          {"trace", 1, 0, 'c'},
                                          {"rows", 0, 0, 'r'},
                                          {"head", 0, 0, 'h'},
                                          {0}};
    lar_push_options o = {
        .tools = "sphere5", .speeds = "0.1", .sides = "+z", .deep = 0.03, .every = 2};
    for (int c; (c = getopt_long(count, word, "", known, NULL)) != -1;) {
        if (c == 't') o.tools = optarg;
        if (c == 's') o.speeds = optarg;
        if (c == 'f') o.sides = optarg;
        if (c == 'n') o.name = optarg;
        if (c == 'd') o.deep = strtod(optarg, NULL);
        if (c == 'l') o.slant = strtod(optarg, NULL);
        if (c == 'B') o.behind = strtod(optarg, NULL);
        if (c == 'T') o.through = 1;
        if (c == 'G') o.grasp = 1;
        if (c == 'C') o.contact = 1;
        if (c == 'g') o.grid = optarg;
        if (c == 'H') o.coupled = 1;
        if (c == 'e') o.every = atoi(optarg);
        if (c == 'c') o.trace = optarg;
        if (c == 'r') o.rows = 1;
        if (c == 'h') o.head = 1;
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
    const lar_push_options options = read_options(count, word);
    if (options.head) {
        print_head();
        return 0;
    }
    if (!options.scene) {
        fputs(usage, stderr);
        return 2;
    }
    lar_status status = lar_scene_with(options.scene, "", 0, &model, &error);
    if (!status) status = lar_body_create(model, &body, &error);
    if (status) fprintf(stderr, "push: %s\n", error.message);
    if (!status && !options.rows) print_head();
    if (!status) status = run_all(&options, &body, &error);
    lar_body_clear(&body);
    lar_model_destroy(model);
    return status ? 1 : 0;
}
