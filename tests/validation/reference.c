#include "validation/reference.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/text.h"

static void check(lar_status status, const lar_error *error) {
    if (status) fail_msg("%s", error->message);
}

/* ---- reference data ----------------------------------------------------------------------- */

const char *reference_path(const char *relative) {
    static char path[1024];
    snprintf(path, sizeof path, "%s/%s", LAR_TEST_SHARED, relative);
    return path;
}

bool reference_present(void) {
    if (access(reference_path("reference/static.tsv"), R_OK) == 0) return true;
    print_message("skipped: no shared data\n");
    return false;
}

static void read_file(const char *relative, lar_bytes *bytes) {
    lar_error error;
    check(lar_bytes_read(reference_path(relative), bytes, &error), &error);
}

static void count_lines(const lar_bytes *bytes, int32_t *nodes, int32_t *elements) {
    lar_text text = lar_text_from(bytes);
    for (lar_span line; lar_text_line(&text, &line);) {
        *nodes += line.length > 1 && line.at[0] == 'n';
        *elements += line.length > 1 && line.at[0] == 'e';
    }
}

static void allocate_mesh(lar_mesh *mesh, int32_t nodes, int32_t elements) {
    mesh->node_count = nodes;
    mesh->element_count = elements;
    mesh->position = lar_calloc((size_t)nodes, sizeof *mesh->position);
    mesh->node_id = lar_calloc((size_t)nodes, sizeof *mesh->node_id);
    mesh->element = lar_calloc((size_t)elements, sizeof *mesh->element);
    mesh->element_id = lar_calloc((size_t)elements, sizeof *mesh->element_id);
    mesh->element_tag = lar_calloc((size_t)elements, sizeof *mesh->element_tag);
    assert_true(mesh->position && mesh->node_id && mesh->element && mesh->element_id &&
                mesh->element_tag);
}

/* Lines "n id X Y Z" and "e id n1 ... n8", ids from 1 in order. */
static void read_mesh(const char *name, double scale, lar_mesh *mesh) {
    char file[256];
    lar_bytes bytes;
    int32_t nodes = 0, elements = 0;
    snprintf(file, sizeof file, "reference/meshes/%s.txt", name);
    read_file(file, &bytes);
    count_lines(&bytes, &nodes, &elements);
    allocate_mesh(mesh, nodes, elements);
    mesh->source = lar_strdup(name);
    lar_text text = lar_text_from(&bytes);
    for (lar_span line; lar_text_line(&text, &line);) {
        if (line.length < 2 || (line.at[0] != 'n' && line.at[0] != 'e')) continue;
        lar_text part = {line.at + 1, line.at + line.length, 1};
        int64_t id, corner;
        assert_true(lar_text_int64(&part, &id));
        if (line.at[0] == 'n') {
            mesh->node_id[id - 1] = id;
            for (int i = 0; i < 3; i++) {
                assert_true(lar_text_double(&part, &mesh->position[id - 1][i]));
                mesh->position[id - 1][i] *= scale;
            }
            continue;
        }
        mesh->element_id[id - 1] = id;
        for (int a = 0; a < 8; a++) {
            assert_true(lar_text_int64(&part, &corner));
            mesh->element[id - 1][a] = (int32_t)(corner - 1);
        }
    }
    lar_bytes_free(&bytes);
    lar_error error;
    check(lar_mesh_check(mesh, &error), &error);
}

lar_model *reference_model(const char *name, double scale, double shear, double bulk,
                           double density) {
    lar_model *model = lar_model_create();
    assert_non_null(model);
    read_mesh(name, scale, &model->mesh);
    lar_material *material = LAR_MODEL_APPEND(model, material);
    assert_non_null(material);
    *material = (lar_material){.law = LAR_LAW_neo_hookean, .density = density};
    lar_material_from_shear_bulk(material, shear, bulk);
    model->element_material =
        lar_calloc((size_t)model->mesh.element_count, sizeof *model->element_material);
    assert_non_null(model->element_material);
    return model;
}

double reference_value(const char *name, const char *element, double t, const char *key) {
    lar_bytes bytes;
    read_file("reference/static.tsv", &bytes);
    lar_text text = lar_text_from(&bytes);
    double value = NAN;
    for (lar_span line; isnan(value) && lar_text_line(&text, &line);) {
        lar_span field[3], rest = line;
        for (int i = 0; i < 3; i++) lar_span_split(rest, '\t', &field[i], &rest);
        if (!lar_span_equal(field[0], name) || !lar_span_equal(field[2], element)) continue;
        double level = NAN, found = NAN;
        lar_text words = {rest.at, rest.at + rest.length, 1};
        for (lar_span word; lar_text_word(&words, &word);) {
            lar_span head, number;
            if (!lar_span_split(word, '=', &head, &number)) continue;
            if (lar_span_equal(head, "t")) lar_span_double(number, &level);
            if (lar_span_equal(head, key)) lar_span_double(number, &found);
        }
        if (fabs(level - t) < 1e-9) value = found;
    }
    lar_bytes_free(&bytes);
    if (isnan(value)) fail_msg("static.tsv has no %s of %s, %s, t = %g", key, name, element, t);
    return value;
}

void reference_field(const char *file, double scale, int32_t nodes, double (*u)[3]) {
    char path[256];
    lar_bytes bytes;
    snprintf(path, sizeof path, "reference/fields/%s", file);
    read_file(path, &bytes);
    lar_text text = lar_text_from(&bytes);
    int32_t read = 0;
    for (lar_span line; read < nodes && lar_text_line(&text, &line);) {
        lar_text part = {line.at, line.at + line.length, 1};
        int64_t id;
        if (line.length == 0 || line.at[0] == '#' || !lar_text_int64(&part, &id)) continue;
        assert_int_equal(id, read + 1);
        for (int i = 0; i < 3; i++) {
            assert_true(lar_text_double(&part, &u[read][i]));
            u[read][i] *= scale;
        }
        read++;
    }
    lar_bytes_free(&bytes);
    assert_int_equal(read, nodes);
}

/* ---- parts of a model --------------------------------------------------------------------- */

lar_node_list nodes_at(const lar_model *model, int axis, double at) {
    const lar_mesh *mesh = &model->mesh;
    lar_node_list list = {0, lar_calloc((size_t)mesh->node_count, sizeof(int32_t))};
    assert_non_null(list.node);
    double size = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) size = fmax(size, fabs(mesh->position[n][axis]));
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (fabs(mesh->position[n][axis] - at) < 1e-9 * size) list.node[list.count++] = n;
    return list;
}

int32_t node_near(const lar_model *model, double x, double y, double z) {
    int32_t nearest = 0;
    double min = INFINITY;
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        const double *p = model->mesh.position[n];
        double d = (p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y) + (p[2] - z) * (p[2] - z);
        if (d < min) {
            min = d;
            nearest = n;
        }
    }
    return nearest;
}

void fix_nodes(lar_model *model, lar_node_list nodes, unsigned axes) {
    lar_fix *fix = LAR_MODEL_APPEND(model, fix);
    assert_non_null(fix);
    *fix = (lar_fix){nodes, axes};
}

void move_nodes_by(lar_model *model, lar_node_list nodes, unsigned axes, double by, int curve) {
    lar_move *move = LAR_MODEL_APPEND(model, move);
    assert_non_null(move);
    *move = (lar_move){.nodes = nodes, .axes = axes, .by = by, .curve = curve};
}

int add_ramp(lar_model *model, double time, double over, double from, double to) {
    lar_curve *curve = LAR_MODEL_APPEND(model, curve);
    assert_non_null(curve);
    *curve = (lar_curve){.kind = LAR_CURVE_TABLE,
                         .shape = LAR_CURVE_SMOOTH,
                         .count = 2,
                         .point = lar_calloc(2, sizeof(double[2]))};
    assert_non_null(curve->point);
    set_ramp(model, model->curve_count - 1, time, over, from, to);
    return model->curve_count - 1;
}

void set_ramp(lar_model *model, int curve, double time, double over, double from, double to) {
    double(*point)[2] = model->curve[curve].point;
    point[0][0] = time;
    point[0][1] = from;
    point[1][0] = time + over;
    point[1][1] = to;
}

/* ---- running ------------------------------------------------------------------------------ */

lar_simulation *start(lar_model *model, lar_element_kind element) {
    lar_options options = lar_options_default();
    lar_simulation *simulation = NULL;
    lar_error error;
    options.element = element;
    check(lar_model_check(model, &error), &error);
    check(lar_simulation_create(model, &options, &simulation, &error), &error);
    return simulation;
}

static void advance_by(lar_simulation *simulation, double seconds) {
    lar_error error;
    uint64_t steps = (uint64_t)ceil(seconds / lar_simulation_time_step(simulation));
    check(lar_simulation_advance(simulation, steps, &error), &error);
}

void run_until(lar_simulation *simulation, double until) {
    double left = until - lar_simulation_time(simulation);
    if (left > 0) advance_by(simulation, left);
}

void run_to_rest(lar_simulation *simulation, double share, double longest) {
    double window = 0.25 / simulation->domain.model->damping;
    double end = lar_simulation_time(simulation) + longest;
    for (int quiet = 0; quiet < 4;) {
        advance_by(simulation, window);
        lar_energy energy;
        lar_simulation_energy(simulation, &energy);
        quiet = energy.kinetic <= share * (energy.strain + energy.hourglass) ? quiet + 1 : 0;
        if (lar_simulation_time(simulation) > end)
            fail_msg("not at rest after %g s: kinetic energy %g J, strain energy %g J", longest,
                     energy.kinetic, energy.strain);
    }
}

double displacement(const lar_simulation *simulation, int32_t node, int axis) {
    return simulation->state
        .u[lar_state_at(&simulation->state, simulation->domain.layout.local[node], axis)];
}

void set_displacements(lar_simulation *simulation, double (*u)[3]) {
    lar_state *state = &simulation->state;
    for (int32_t g = 0; g < simulation->domain.model->mesh.node_count; g++)
        for (int i = 0; i < 3; i++) {
            size_t value = lar_state_at(state, simulation->domain.layout.local[g], i);
            state->u[value] = u[g][i];
            state->v[value] = 0;
        }
}

double hourglass_share(const lar_simulation *simulation) {
    lar_energy energy;
    lar_simulation_energy(simulation, &energy);
    return energy.strain > 0 ? energy.hourglass / energy.strain : 0;
}

static struct timespec report_start;

void begin_report(void) {
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &report_start);
}

double report(const char *name, const char *element, const char *mesh, const char *quantity,
              double reference, double ours, const lar_simulation *simulation) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    double seconds = (double)(now.tv_sec - report_start.tv_sec) +
                     1e-9 * (double)(now.tv_nsec - report_start.tv_nsec);
    print_message("| %s | %s | %s | %s | %.6g | %.6g | %+.2f%% | %.2f%% | %llu | %.2f |\n", name,
                  element, mesh, quantity, reference, ours, 100 * (ours / reference - 1),
                  100 * hourglass_share(simulation),
                  (unsigned long long)lar_simulation_steps(simulation), seconds);
    return fabs(ours / reference - 1);
}
