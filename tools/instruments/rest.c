/* What contact of two bodies costs while one lies on the other, on a plane: paired with the same
 * bodies beside each other, without contact between them. From the header alone. */
#include <getopt.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "lariat.h"

static const char usage[] =
    "rest LOWER UPPER [OPTION...]: scenes whose bodies are laid on each other; only their meshes\n"
    "count. The lower one lies on a plane.\n"
    "  --self            bodies touch themselves, too\n"
    "  --gravity G       default 2 m/s^2: as heavy as organs are that others carry\n"
    "  --settle S        simulated before it is measured; default 5\n"
    "  --grid XxYxZ      processors; default: one, or what LARIAT_GRID says\n"
    "  --rounds N        of 200 steps each, one after the other; default 100\n"
    "Rows: processor time of a step (median, least), and the ratios to bodies without contact.\n"
    "The last column is the state's hash.\n";

enum { CASES = 3, STEPS = 200 };

static const char *const name[CASES] = {"beside each other, without contact",
                                        "beside each other, with contact", "on each other"};

typedef struct options {
    const char *body[2], *grid;
    double gravity, settle;
    int rounds;
    bool self;
} options;

static void stop_on(lar_status status, const lar_error *error) {
    if (!status) return;
    fprintf(stderr, "rest: %s\n", error->message);
    exit(EXIT_FAILURE);
}

/* ---- the pair ------------------------------------------------------------------------------ */

static void box_of(const lar_model *model, double low[3], double high[3]) {
    const double(*x)[3] = lar_model_positions(model);
    for (int i = 0; i < 3; i++) low[i] = INFINITY, high[i] = -INFINITY;
    for (int32_t n = 0; n < lar_model_node_count(model); n++)
        for (int i = 0; i < 3; i++) {
            low[i] = fmin(low[i], x[n][i]);
            high[i] = fmax(high[i], x[n][i]);
        }
}

/* Puts a body's middle above the origin, `aside` of it, its lowest node at `height`. */
static void add_body(const lar_model *model, int32_t tag, double aside, double height,
                     lar_mesh_arrays *mesh, double (*position)[3], int32_t (*element)[8],
                     int32_t *tags) {
    const double(*x)[3] = lar_model_positions(model);
    double low[3], high[3];
    box_of(model, low, high);
    for (int32_t e = 0; e < lar_model_element_count(model); e++) {
        const int32_t *node = lar_model_element_nodes(model, e);
        for (int a = 0; a < 8; a++) element[mesh->elements][a] = mesh->nodes + node[a];
        tags[mesh->elements++] = tag;
    }
    for (int32_t n = 0; n < lar_model_node_count(model); n++, mesh->nodes++) {
        double *to = position[mesh->nodes];
        for (int i = 0; i < 2; i++) to[i] = x[n][i] - 0.5 * (low[i] + high[i]);
        to[0] += aside;
        to[2] = x[n][2] - low[2] + height;
    }
}

static lar_model *pair(const options *o, lar_model *const body[2], int which) {
    static const char scene[] =
        "lariat: 1\ngravity: [0, 0, -%g]\ndamping: 40\nmaterials:\n"
        "  - { cells: all, law: coupled-neo-hookean, density: 1050, shear_modulus: 4.9e3,\n"
        "      bulk_modulus: 4.74e4 }\n"
        "contact:\n"
        "  - { faces: all, plane: { through: [0, 0, -0.0005], normal: [0, 0, 1] } }\n%s";
    const char *contact = which == 0 ? ""
                          : o->self  ? "  - { self: true }\n"
                                     : "  - { between: [{ tag: 1 }, { tag: 2 }] }\n";
    char text[1024];
    lar_mesh_arrays mesh = {0};
    double low[3], high[3];
    size_t nodes = 0, elements = 0;
    for (int b = 0; b < 2; b++) {
        nodes += (size_t)lar_model_node_count(body[b]);
        elements += (size_t)lar_model_element_count(body[b]);
    }
    double(*position)[3] = calloc(nodes, sizeof *position);
    int32_t(*element)[8] = calloc(elements, sizeof *element), *tags = calloc(elements, 4);
    if (!position || !element || !tags) exit(EXIT_FAILURE);
    box_of(body[0], low, high);
    bool above = which == CASES - 1;
    add_body(body[0], 1, 0, 0, &mesh, position, element, tags);
    add_body(body[1], 2, above ? 0 : 0.3, above ? high[2] - low[2] + 0.001 : 0, &mesh, position,
             element, tags);
    mesh.position = (const double(*)[3])position;
    mesh.element = (const int32_t(*)[8])element;
    mesh.tag = tags;
    snprintf(text, sizeof text, scene, o->gravity, contact);
    lar_model *model;
    lar_error error;
    stop_on(lar_model_from_arrays(&mesh, text, &model, &error), &error);
    free(position);
    free(element);
    free(tags);
    return model;
}

/* ---- measuring ----------------------------------------------------------------------------- */

/* Of this process [us]: others on the machine count less. */
static double processor_time(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e6 * (double)now.tv_sec + 1e-3 * (double)now.tv_nsec;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static void measure(const options *o, lar_simulation *const simulation[CASES]) {
    double *took[CASES];
    lar_error error;
    for (int c = 0; c < CASES; c++) {
        took[c] = calloc((size_t)o->rounds, sizeof **took);
        if (!took[c]) exit(EXIT_FAILURE);
    }
    for (int r = 0; r < o->rounds; r++)
        for (int c = 0; c < CASES; c++) {
            double begin = processor_time();
            stop_on(lar_simulation_advance(simulation[c], STEPS, &error), &error);
            took[c][r] = (processor_time() - begin) / STEPS;
        }
    for (int c = 0; c < CASES; c++) {
        lar_contact_info seen;
        lar_simulation_contact(simulation[c], &seen);
        qsort(took[c], (size_t)o->rounds, sizeof **took, compare);
        double median = took[c][o->rounds / 2];
        printf("| %s | %.1f us | %.1f us | %.3f | %.3f | %d parts | %d nodes touch | %016llx |\n",
               name[c], median, took[c][0], median / took[0][o->rounds / 2],
               took[c][0] / took[0][0], (int)lar_simulation_step_parts(simulation[c]),
               (int)seen.touching, (unsigned long long)lar_simulation_hash(simulation[c]));
    }
    for (int c = 0; c < CASES; c++) free(took[c]);
}

static options parse(int count, char **words) {
    enum { SELF = 256, GRAVITY, SETTLE, GRID, ROUNDS };
    static const struct option longs[] = {
        {"self", no_argument, NULL, SELF},           {"gravity", required_argument, NULL, GRAVITY},
        {"settle", required_argument, NULL, SETTLE}, {"grid", required_argument, NULL, GRID},
        {"rounds", required_argument, NULL, ROUNDS}, {0}};
    options o = {.gravity = 2, .settle = 5, .rounds = 100};
    for (int option; (option = getopt_long(count, words, "", longs, NULL)) != -1;) {
        if (option == SELF) o.self = true;
        if (option == GRAVITY) o.gravity = strtod(optarg, NULL);
        if (option == SETTLE) o.settle = strtod(optarg, NULL);
        if (option == GRID) o.grid = optarg;
        if (option == ROUNDS) o.rounds = (int)strtol(optarg, NULL, 10);
        if (option == '?') optind = count;
    }
    if (count - optind != 2 || o.rounds < 1) {
        fputs(usage, stderr);
        exit(2);
    }
    o.body[0] = words[optind];
    o.body[1] = words[optind + 1];
    return o;
}

int main(int count, char **words) {
    options o = parse(count, words);
    lar_error error;
    lar_model *body[2], *model[CASES];
    lar_simulation *simulation[CASES];
    for (int b = 0; b < 2; b++) stop_on(lar_model_open(o.body[b], &body[b], &error), &error);
    for (int c = 0; c < CASES; c++) {
        lar_options wanted = {.grid = o.grid};
        model[c] = pair(&o, body, c);
        stop_on(lar_simulation_create(model[c], &wanted, &simulation[c], &error), &error);
        double steps = o.settle / lar_simulation_time_step(simulation[c]);
        stop_on(lar_simulation_advance(simulation[c], (uint64_t)steps, &error), &error);
    }
    measure(&o, simulation);
    for (int c = 0; c < CASES; c++) {
        lar_simulation_destroy(simulation[c]);
        lar_model_destroy(model[c]);
    }
    for (int b = 0; b < 2; b++) lar_model_destroy(body[b]);
    return EXIT_SUCCESS;
}
