/* Results on disk: what is in the files, after every frame, and what happens when they cannot be
 * written. */
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/file/folder.h"
#include "step/measure.h"
#include "simulation/results_probe.h"
#include "mechanics/stress.h"
#include "meshing/shapes.h"
#include "model/brick.h"
#include "model/format/mesh_io.h"

#define FOLDER LAR_TEST_BUILD "/results"

typedef struct fixture {
    lar_model *model;
    lar_simulation *simulation;
    lar_results *results;
    lar_error error;
} fixture;

static void remove_results(void) {
    static const char *const names[] = {
        "organ_000000.vtu", "organ_000001.vtu",   "organ_000002.vtu",   "organ.pvd",  "probes.csv",
        "expected.vtu",     "surface_000000.vtp", "surface_000001.vtp", "surface.pvd"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char path[512];
        snprintf(path, sizeof path, "%s/%s", FOLDER, names[i]);
        remove(path);
    }
    remove(FOLDER);
}

static void add_probe(lar_model *model, const char *name, int what, int32_t first, int32_t count) {
    lar_probe *probe = LAR_MODEL_APPEND(model, output.probe);
    *probe = (lar_probe){.name = lar_strdup(name), .what = what};
    probe->nodes = (lar_node_list){count, lar_calloc((size_t)count, sizeof(int32_t))};
    for (int32_t i = 0; i < count; i++) probe->nodes.node[i] = first + i;
}

/* The brick under its weight, its nine lower nodes held, a mean and a reaction probed. */
static int set_up(void **state) {
    fixture *f = calloc(1, sizeof *f);
    lar_model *model = f->model = lar_model_create();
    if (brick_read("one.vtu", 1, &model->mesh, &f->error)) return -1;
    model->source = lar_strdup("some/folder/organ.yaml");
    model->element_material = lar_calloc(BRICK_ELEMENTS, sizeof(int32_t));
    lar_material *material = LAR_MODEL_APPEND(model, material);
    material->law = LAR_LAW_neo_hookean;
    material->density = 1000;
    lar_material_from_shear_bulk(material, 4e3, 4e5);
    model->gravity[2] = -9.81;
    model->damping = 10;
    lar_fix *fix = LAR_MODEL_APPEND(model, fix);
    fix->axes = LAR_AXIS_ALL;
    fix->nodes = (lar_node_list){9, lar_calloc(9, sizeof(int32_t))};
    for (int i = 0; i < 9; i++) fix->nodes.node[i] = i;
    model->output.fields = LAR_FIELD_DISPLACEMENT | LAR_FIELD_VELOCITY | LAR_FIELD_VON_MISES |
                           LAR_FIELD_PRESSURE | LAR_FIELD_ENERGY | LAR_OUTPUT_STRESS |
                           LAR_OUTPUT_STRAIN | LAR_OUTPUT_VOLUME;
    add_probe(model, "lid", LAR_PROBE_DISPLACEMENT, 18, 9);
    add_probe(model, "foot, \"left\"", LAR_PROBE_REACTION, 0, 9);
    remove_results();
    if (lar_model_check(model, &f->error)) return -1;
    if (lar_simulation_create(model, NULL, &f->simulation, &f->error)) return -1;
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    lar_results_close(f->results, NULL);
    lar_simulation_destroy(f->simulation);
    lar_model_destroy(f->model);
    free(f);
    remove_results();
    return 0;
}

static void open_results(fixture *f) {
    if (lar_results_open(FOLDER, f->simulation, &f->results, &f->error))
        fail_msg("%s", f->error.message);
}

static void add(fixture *f) {
    if (lar_results_add(f->results, f->simulation, &f->error)) fail_msg("%s", f->error.message);
}

static lar_bytes read_all(const char *path) {
    lar_bytes bytes = {0};
    lar_error error;
    if (lar_bytes_read(path, &bytes, &error)) fail_msg("%s", error.message);
    return bytes;
}

static void expect_same(const char *path, const char *other) {
    lar_bytes got = read_all(path), expected = read_all(other);
    assert_int_equal(got.size, expected.size);
    assert_memory_equal(got.data, expected.data, got.size);
    lar_bytes_free(&got);
    lar_bytes_free(&expected);
}

/* ---- frames ----------------------------------------------------------------------------- */

/* The same frame, put together from the public calls. */
static void write_expected(fixture *f, const char *path) {
    double u[BRICK_NODES][3], v[BRICK_NODES][3], mises[8], pressure[8], energy[8], cauchy[6];
    double stress[8][6], strain[8][6], volume[8];
    lar_simulation_stresses(f->simulation, stress, strain, NULL);
    lar_simulation_displacements(f->simulation, u);
    lar_simulation_velocities(f->simulation, v);
    for (int e = 0; e < 8; e++) {
        energy[e] = lar_measure_stress(&f->simulation->domain, &f->simulation->state, e, cauchy);
        mises[e] = lar_von_mises(cauchy);
        pressure[e] = lar_mean_pressure(cauchy);
        assert_memory_equal(cauchy, stress[e], sizeof cauchy);
        double value[LAR_CELL_FIELDS][6];
        lar_element_fields(&f->simulation->domain, &f->simulation->state, e, 1U << LAR_CELL_VOLUME,
                           value);
        volume[e] = value[LAR_CELL_VOLUME][0];
        /* det(1 + 2 E) = det(F)^2 */
        const double *E = strain[e];
        double det = (1 + 2 * E[0]) * ((1 + 2 * E[1]) * (1 + 2 * E[2]) - 4 * E[4] * E[4]) -
                     2 * E[3] * (2 * E[3] * (1 + 2 * E[2]) - 4 * E[4] * E[5]) +
                     2 * E[5] * (4 * E[3] * E[4] - 2 * E[5] * (1 + 2 * E[1]));
        assert_true(fabs(volume[e] * volume[e] - det) < 1e-14);
    }
    const lar_vtu_array point[] = {{"displacement", 3, &u[0][0]}, {"velocity", 3, &v[0][0]}};
    const lar_vtu_array cell[] = {{"von_mises", 1, mises},      {"pressure", 1, pressure},
                                  {"energy", 1, energy},        {"stress", 6, &stress[0][0]},
                                  {"strain", 6, &strain[0][0]}, {"volume_ratio", 1, volume}};
    const lar_vtu_frame frame = {.mesh = &f->model->mesh,
                                 .point_array = point,
                                 .point_array_count = 2,
                                 .cell_array = cell,
                                 .cell_array_count = 6,
                                 .time = lar_simulation_time(f->simulation)};
    assert_int_equal(lar_vtu_write(path, &frame, &f->error), LAR_OK);
    assert_true(mises[0] > 0 && energy[0] > 0 && u[26][2] < 0);
}

static void a_frame_holds_the_state(void **state) {
    fixture *f = *state;
    open_results(f);
    lar_simulation_advance(f->simulation, 100, NULL);
    add(f);
    write_expected(f, FOLDER "/expected.vtu");
    expect_same(FOLDER "/organ_000000.vtu", FOLDER "/expected.vtu");

    lar_mesh mesh = {0};
    assert_int_equal(lar_mesh_read(FOLDER "/organ_000000.vtu", 1, &mesh, &f->error), LAR_OK);
    assert_memory_equal(mesh.position, f->model->mesh.position, BRICK_NODES * 3 * sizeof(double));
    assert_non_null(lar_mesh_find_set(&mesh, "bottom", LAR_SET_NODES));
    lar_mesh_clear(&mesh);
}

static void fields_are_those_asked_for(void **state) {
    fixture *f = *state;
    f->model->output.fields = LAR_FIELD_PRESSURE;
    open_results(f);
    add(f);
    lar_bytes bytes = read_all(FOLDER "/organ_000000.vtu");
    const char *text = (const char *)bytes.data;
    assert_non_null(strstr(text, "Name=\"pressure\""));
    assert_null(strstr(text, "Name=\"displacement\""));
    assert_null(strstr(text, "Name=\"von_mises\""));
    lar_bytes_free(&bytes);
}

/* F a of a cube of 10 mm, by the differences along its edges. */
static void turn(const double u[BRICK_NODES][3], const int32_t node[8], const double a[3],
                 double out[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = a[i];
        for (int c = 0; c < 8; c++)
            for (int j = 0; j < 3; j++)
                out[i] += (lar_node_sign[c][j] > 0 ? 25 : -25) * u[node[c]][i] * a[j];
    }
}

/* Reads the mesh of a frame whose directions are, by their names, the present ones. */
static void read_turned(lar_mesh *mesh, lar_error *error) {
    static const char *const names[] = {"\"fibre\"",      "\"rest1\"",     "\"fibre2\"",
                                        "\"rest_2\"",     "\"fibre_now\"", "\"fibre\"    ",
                                        "\"fibre2_now\"", "\"fibre2\"    "};
    lar_bytes bytes = read_all(FOLDER "/organ_000000.vtu");
    char *text = (char *)bytes.data;
    for (int i = 0; i < 8; i += 2) {
        char *at = strstr(text, names[i]);
        assert_non_null(at);
        memcpy(at, names[i + 1], strlen(names[i]));
    }
    FILE *file = fopen(FOLDER "/expected.vtu", "w");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, bytes.size, file), bytes.size);
    assert_int_equal(fclose(file), 0);
    lar_bytes_free(&bytes);
    assert_int_equal(lar_mesh_read(FOLDER "/expected.vtu", 1, mesh, error), LAR_OK);
}

/* The frame of fibres, put together from gradients: directions now, and how long they are. */
static void write_fibres(fixture *f, const char *path) {
    double now[2][BRICK_ELEMENTS][3], stretch[2][BRICK_ELEMENTS];
    const lar_mesh *mesh = &f->model->mesh;
    for (int e = 0; e < BRICK_ELEMENTS; e++)
        for (int k = 0; k < 2; k++) {
            const double *a = k ? mesh->second[e] : mesh->fibre[e];
            double F[3][3], *n = now[k][e];
            lar_element_gradient(&f->simulation->domain, &f->simulation->state, e, F);
            for (int i = 0; i < 3; i++) n[i] = F[i][0] * a[0] + F[i][1] * a[1] + F[i][2] * a[2];
            stretch[k][e] = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        }
    const lar_vtu_array cell[] = {{"fibre_now", 3, &now[0][0][0]},
                                  {"fibre_stretch", 1, stretch[0]},
                                  {"fibre2_now", 3, &now[1][0][0]},
                                  {"fibre2_stretch", 1, stretch[1]}};
    const lar_vtu_frame frame = {.mesh = mesh,
                                 .cell_array = cell,
                                 .cell_array_count = 4,
                                 .time = lar_simulation_time(f->simulation)};
    assert_int_equal(lar_vtu_write(path, &frame, &f->error), LAR_OK);
    assert_true(fabs(stretch[0][2] - 1) > 1e-4);
}

/* Along the fibres as they are now: in frames that ask for it, where there are some. */
static void fibres_turn_with_the_tissue(void **state) {
    fixture *f = *state;
    lar_mesh *mesh = &f->model->mesh;
    double u[BRICK_NODES][3], now[2][BRICK_ELEMENTS][3];
    f->model->output.fields = LAR_OUTPUT_FIBRES | LAR_OUTPUT_STRETCH;
    open_results(f);
    add(f); /* nothing has any */
    assert_int_equal(lar_results_close(f->results, &f->error), LAR_OK);
    lar_bytes bytes = read_all(FOLDER "/organ_000000.vtu");
    assert_null(strstr((const char *)bytes.data, "fibre"));
    lar_bytes_free(&bytes);
    /* Directions belong to the model; the run does not have to know of them. */
    f->model->material[0].fibre =
        (lar_fibre){.law = LAR_FIBRE_HGO, .isochoric = true, .paired = true, .parameter = {1e3}};
    mesh->fibre = lar_calloc(BRICK_ELEMENTS, sizeof *mesh->fibre);
    mesh->second = lar_calloc(BRICK_ELEMENTS, sizeof *mesh->second);
    for (int e = 0; e < BRICK_ELEMENTS; e++) {
        mesh->fibre[e][e % 3] = 1;
        mesh->second[e][0] = 0.6;
        mesh->second[e][2] = -0.8;
    }
    lar_simulation_advance(f->simulation, 300, NULL);
    open_results(f);
    add(f);
    lar_simulation_displacements(f->simulation, u);
    for (int e = 0; e < BRICK_ELEMENTS; e++) {
        turn((const double(*)[3])u, mesh->element[e], mesh->fibre[e], now[0][e]);
        turn((const double(*)[3])u, mesh->element[e], mesh->second[e], now[1][e]);
    }
    assert_true(fabs(now[0][2][2] - 1) > 1e-3 && fabs(now[1][4][0] - 0.6) > 1e-5);
    lar_mesh frame = {0};
    write_fibres(f, FOLDER "/expected.vtu");
    expect_same(FOLDER "/organ_000000.vtu", FOLDER "/expected.vtu");
    read_turned(&frame, &f->error);
    for (int e = 0; e < BRICK_ELEMENTS; e++)
        for (int i = 0; i < 3; i++) {
            assert_true(fabs(frame.fibre[e][i] - now[0][e][i]) < 1e-12);
            assert_true(fabs(frame.second[e][i] - now[1][e][i]) < 1e-12);
        }
    lar_mesh_clear(&frame);
}

static void the_series_lists_what_is_there(void **state) {
    fixture *f = *state;
    open_results(f);
    for (int frame = 0; frame < 3; frame++) {
        add(f);
        lar_bytes bytes = read_all(FOLDER "/organ.pvd");
        int listed = 0;
        for (const char *at = (const char *)bytes.data; (at = strstr(at, "<DataSet")); at++) {
            char expected[64];
            snprintf(expected, sizeof expected, "file=\"organ_%06d.vtu\"", listed++);
            assert_non_null(strstr(at, expected));
        }
        assert_int_equal(listed, frame + 1);
        lar_bytes_free(&bytes);
        lar_simulation_advance(f->simulation, 10, NULL);
    }
}

static void adding_frames_changes_nothing(void **state) {
    fixture *f = *state;
    lar_simulation *other = NULL;
    assert_int_equal(lar_simulation_create(f->model, NULL, &other, &f->error), LAR_OK);
    open_results(f);
    for (int frame = 0; frame < 3; frame++) {
        add(f);
        lar_simulation_advance(f->simulation, 25, NULL);
    }
    lar_simulation_advance(other, 75, NULL);
    assert_true(lar_simulation_hash(f->simulation) == lar_simulation_hash(other));
    lar_energy a, b;
    lar_simulation_energy(f->simulation, &a);
    lar_simulation_energy(other, &b);
    assert_memory_equal(&a, &b, sizeof a);
    lar_simulation_destroy(other);
}

/* ---- probes ----------------------------------------------------------------------------- */

/* The numbers of a line, and where the next one begins. */
static char *read_line(char *line, double *value, int count) {
    for (int i = 0; i < count; i++) {
        value[i] = strtod(line, &line);
        assert_int_equal(*line++, i < count - 1 ? ',' : '\n');
    }
    return line;
}

static void probes_have_names_units_and_values(void **state) {
    fixture *f = *state;
    open_results(f);
    add(f);
    lar_simulation_advance(f->simulation, 40000, NULL);
    add(f);
    lar_bytes bytes = read_all(FOLDER "/probes.csv");
    char *text = (char *)bytes.data;
    const char *header = "time [s],lid x [m],lid y [m],lid z [m],\"foot, \"\"left\"\" x [N]\","
                         "\"foot, \"\"left\"\" y [N]\",\"foot, \"\"left\"\" z [N]\"\n";
    assert_memory_equal(text, header, strlen(header));
    char *line = text + strlen(header);
    assert_memory_equal(line, "0,0,0,0,", 8);
    line = strchr(line, '\n') + 1;
    double value[7];
    assert_int_equal(*read_line(line, value, 7), 0);

    double u[BRICK_NODES][3], mean = 0;
    lar_simulation_displacements(f->simulation, u);
    for (int n = 18; n < 27; n++) mean += u[n][2] / 9;
    assert_true(fabs(value[0] - lar_simulation_time(f->simulation)) < 1e-9 * value[0]);
    assert_true(fabs(value[3] - mean) <= 1e-12 * fabs(mean));
    /* At rest the foot carries the whole weight: 1000 kg/m^3 in a cube of 20 mm. */
    assert_true(fabs(value[6] - 8e-6 * 1000 * 9.81) < 1e-6);
    assert_true(fabs(value[4]) < 1e-9 && fabs(value[5]) < 1e-9);
    lar_bytes_free(&bytes);
}

/* What stands on its foot carries half its weight on average, by its top and bottom; the mean of a
 * field is that of its elements, which are of one size here. */
static void probes_of_elements_are_means(void **state) {
    fixture *f = *state;
    f->model->output.probe_count = 0;
    free(f->model->output.probe[0].name);
    free(f->model->output.probe[0].nodes.node);
    free(f->model->output.probe[1].name);
    free(f->model->output.probe[1].nodes.node);
    add_probe(f->model, "all", LAR_PROBE_MEAN, 0, BRICK_ELEMENTS);
    f->model->output.probe[0].field = LAR_CELL_STRESS;
    add_probe(f->model, "all pressure", LAR_PROBE_MEAN, 0, BRICK_ELEMENTS); /* it says so already */
    f->model->output.probe[1].field = LAR_CELL_PRESSURE;
    add_probe(f->model, "one", LAR_PROBE_MEAN, 5, 1);
    f->model->output.probe[2].field = LAR_CELL_VOLUME;
    open_results(f);
    lar_simulation_advance(f->simulation, 40000, NULL);
    add(f);
    lar_bytes bytes = read_all(FOLDER "/probes.csv");
    char *text = (char *)bytes.data;
    const char *header = "time [s],all stress xx [Pa],all stress yy [Pa],all stress zz [Pa],"
                         "all stress xy [Pa],all stress yz [Pa],all stress zx [Pa],"
                         "all pressure [Pa],one volume_ratio [1]\n";
    assert_memory_equal(text, header, strlen(header));
    double value[9], cauchy[BRICK_ELEMENTS][6], sum[3] = {0};
    assert_int_equal(*read_line(text + strlen(header), value, 9), 0);
    lar_simulation_stresses(f->simulation, cauchy, NULL, NULL);
    for (int e = 0; e < BRICK_ELEMENTS; e++)
        for (int k = 0; k < 3; k++) sum[k] += cauchy[e][k] / BRICK_ELEMENTS;
    for (int k = 0; k < 3; k++) assert_true(fabs(value[1 + k] - sum[k]) < 1e-9);
    assert_true(fabs(value[7] + (sum[0] + sum[1] + sum[2]) / 3) < 1e-9);
    assert_true(fabs(value[3] + 1000 * 9.81 * 0.01) < 4); /* 98.1 Pa, bulging apart */
    assert_true(value[8] > 0.99 && value[8] < 1.01 && value[8] != 1);
    lar_bytes_free(&bytes);
}

static void without_probes_there_is_the_time(void **state) {
    fixture *f = *state;
    for (int i = 0; i < f->model->output.probe_count; i++) {
        free(f->model->output.probe[i].name);
        free(f->model->output.probe[i].nodes.node);
    }
    f->model->output.probe_count = 0;
    open_results(f);
    add(f);
    lar_bytes bytes = read_all(FOLDER "/probes.csv");
    assert_string_equal((char *)bytes.data, "time [s]\n0\n");
    lar_bytes_free(&bytes);
}

/* A disk that fills up in the middle of a line, played by a limit on the size of files. */
static void a_line_is_whole_or_not_there(void **state) {
    fixture *f = *state;
    lar_probe_file file;
    assert_int_equal(lar_folder_make(FOLDER, &f->error), LAR_OK);
    assert_int_equal(
        lar_probe_file_open(&file, lar_strdup(FOLDER "/probes.csv"), f->model, -1, NULL), LAR_OK);
    lar_bytes header = read_all(FOLDER "/probes.csv");
    struct rlimit before, tight;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    tight = before;
    tight.rlim_cur = header.size + 5;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
    lar_status status = lar_probe_file_add(&file, f->simulation, &f->error);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);
    assert_int_equal(status, LAR_ERROR_IO);
    assert_non_null(strstr(f->error.message, "probes.csv"));

    lar_bytes after = read_all(FOLDER "/probes.csv");
    assert_int_equal(after.size, header.size);
    lar_bytes_free(&after);
    assert_int_equal(lar_probe_file_add(&file, f->simulation, &f->error), LAR_OK);
    after = read_all(FOLDER "/probes.csv");
    assert_memory_equal(after.data, header.data, header.size);
    assert_memory_equal(after.data + header.size, "0,0,0,0,", 8);
    lar_bytes_free(&after);
    lar_bytes_free(&header);
    assert_int_equal(lar_probe_file_close(&file, &f->error), LAR_OK);
    assert_int_equal(lar_probe_file_close(&file, &f->error), LAR_OK);
}

/* ---- the embedded surface ------------------------------------------------------------------- */

static void let_ball_ride(fixture *f) {
    lar_triangles ball;
    shape_ellipsoid_surface(&ball, (double[3]){0.012, 0.011, 0.009}, (double[3]){0.01, 0.01, 0.01},
                            6);
    if (lar_embedded_surface_bind(&f->model->mesh, &ball, &f->model->embedded, &f->error))
        fail_msg("%s", f->error.message);
    f->model->output.surface = true;
}

/* It takes many times the room of the mesh, so it is written only when it is asked for. */
static void an_embedded_surface_waits_to_be_asked(void **state) {
    fixture *f = *state;
    remove(FOLDER "/surface_000000.vtp");
    remove(FOLDER "/surface.pvd");
    let_ball_ride(f);
    f->model->output.surface = false;
    open_results(f);
    add(f);
    assert_int_not_equal(access(FOLDER "/surface_000000.vtp", F_OK), 0);
    assert_int_not_equal(access(FOLDER "/surface.pvd", F_OK), 0);
    assert_int_equal(lar_results_close(f->results, &f->error), LAR_OK);
    f->results = NULL;
    if (lar_results_open_surface(FOLDER, f->simulation, &f->results, &f->error))
        fail_msg("%s", f->error.message);
    add(f);
    assert_int_equal(access(FOLDER "/surface_000000.vtp", F_OK), 0);
}

static void an_embedded_surface_has_frames_of_its_own(void **state) {
    fixture *f = *state;
    lar_triangles read;
    lar_embedded_info info;
    double u[BRICK_NODES][3];
    let_ball_ride(f);
    assert_int_equal(lar_model_embedded(f->model, &info), 1);
    uint64_t hash = lar_simulation_hash(f->simulation);
    open_results(f);
    add(f);
    assert_true(lar_simulation_hash(f->simulation) == hash);
    lar_simulation_advance(f->simulation, 200, NULL);
    add(f);
    double(*place)[3] = lar_calloc((size_t)info.vertices, sizeof *place);
    for (int frame = 0; frame < 2; frame++) {
        const char *path = frame ? FOLDER "/surface_000001.vtp" : FOLDER "/surface_000000.vtp";
        if (lar_triangles_read(path, 1, &read, &f->error)) fail_msg("%s", f->error.message);
        lar_simulation_displacements(f->simulation, u);
        lar_model_embedded_move(f->model, frame ? (const double(*)[3])u : NULL, place);
        assert_int_equal(read.vertex_count, info.vertices);
        assert_int_equal(read.triangle_count, info.triangles);
        double max = 0, moved = 0;
        for (int32_t v = 0; v < info.vertices; v++)
            for (int i = 0; i < 3; i++) {
                max = fmax(max, fabs(read.vertex[v][i] - place[v][i]));
                moved = fmax(moved, fabs(place[v][i] - info.rest[v][i]));
            }
        assert_true(max < 1e-8);
        assert_true((moved > 1e-5) == (frame == 1));
        lar_triangles_clear(&read);
    }
    free(place);
    lar_bytes series = read_all(FOLDER "/surface.pvd");
    assert_non_null(strstr((char *)series.data, "file=\"surface_000000.vtp\""));
    assert_non_null(strstr((char *)series.data, "file=\"surface_000001.vtp\""));
    lar_bytes_free(&series);
}

/* Results of a scene surface.yaml are called surface, too. */
static void the_frames_of_the_mesh_keep_their_name(void **state) {
    fixture *f = *state;
    let_ball_ride(f);
    free(f->model->source);
    f->model->source = lar_strdup("surface.yaml");
    open_results(f);
    add(f);
    assert_int_equal(access(FOLDER "/surface_000000.vtu", F_OK), 0);
    lar_bytes series = read_all(FOLDER "/surface.pvd");
    assert_non_null(strstr((char *)series.data, "file=\"surface_000000.vtu\""));
    lar_bytes_free(&series);
    remove(FOLDER "/surface_000000.vtu");
    assert_int_equal(remove(FOLDER "/fine_surface_000000.vtp"), 0);
    assert_int_equal(remove(FOLDER "/fine_surface.pvd"), 0);
}

static void the_surface_it_was_read_from_is_spared(void **state) {
    fixture *f = *state;
    let_ball_ride(f);
    open_results(f);
    add(f);
    free(f->model->embedded.surface.source);
    f->model->embedded.surface.source = lar_strdup(FOLDER "/surface_000001.vtp");
    FILE *file = fopen(FOLDER "/surface_000001.vtp", "w");
    assert_non_null(file);
    fclose(file);
    assert_int_equal(lar_results_add(f->results, f->simulation, &f->error), LAR_ERROR_IO);
    assert_non_null(strstr(f->error.message, "is the embedded surface of this model"));
}

/* A checkpoint does not know of it: it is taken up with another surface, and without one. */
static void checkpoints_do_not_know_of_it(void **state) {
    fixture *f = *state;
    lar_simulation *other = NULL;
    assert_int_equal(lar_folder_make(FOLDER, &f->error), LAR_OK);
    lar_simulation_advance(f->simulation, 20, NULL);
    assert_int_equal(lar_simulation_save(f->simulation, FOLDER "/expected.vtu", &f->error), LAR_OK);
    uint64_t hash = lar_simulation_hash(f->simulation);
    let_ball_ride(f);
    assert_int_equal(lar_simulation_create(f->model, NULL, &other, &f->error), LAR_OK);
    if (lar_simulation_load(other, FOLDER "/expected.vtu", &f->error))
        fail_msg("%s", f->error.message);
    assert_true(lar_simulation_hash(other) == hash);
    lar_simulation_destroy(other);
}

/* ---- what can go wrong ------------------------------------------------------------------ */

static void names_follow_the_models_file(void **state) {
    fixture *f = *state;
    free(f->model->source);
    f->model->source = NULL;
    open_results(f);
    add(f);
    assert_int_equal(access(FOLDER "/model_000000.vtu", F_OK), 0);
    remove(FOLDER "/model_000000.vtu");
    remove(FOLDER "/model.pvd");
}

static void senseless_calls_are_refused(void **state) {
    fixture *f = *state;
    lar_results *none = NULL;
    assert_int_equal(lar_results_open(NULL, f->simulation, &none, NULL), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_results_open("", f->simulation, &none, NULL), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_results_open(FOLDER, NULL, &none, NULL), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_results_add(NULL, f->simulation, NULL), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_results_close(NULL, NULL), LAR_OK);
    assert_null(none);
}

/* Its arrays might have another length. */
static void another_model_is_refused(void **state) {
    fixture *f = *state;
    void *other = NULL;
    assert_int_equal(set_up(&other), 0);
    open_results(f);
    assert_int_equal(lar_results_add(f->results, ((fixture *)other)->simulation, &f->error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(f->error.message, "another model"));
    assert_int_equal(access(FOLDER "/organ_000000.vtu", F_OK), -1);
    add(f);
    tear_down(&other);
}

static void a_file_is_no_folder(void **state) {
    fixture *f = *state;
    FILE *file = fopen(FOLDER, "w");
    assert_non_null(file);
    fclose(file);
    assert_int_equal(lar_results_open(FOLDER, f->simulation, &f->results, &f->error), LAR_ERROR_IO);
    assert_non_null(strstr(f->error.message, FOLDER));
    assert_int_equal(lar_results_open(FOLDER "/below", f->simulation, &f->results, &f->error),
                     LAR_ERROR_IO);
    assert_null(f->results);
}

static void a_lost_folder_is_reported_and_may_come_back(void **state) {
    fixture *f = *state;
    open_results(f);
    remove(FOLDER "/probes.csv");
    assert_int_equal(rmdir(FOLDER), 0);
    assert_int_equal(lar_results_add(f->results, f->simulation, &f->error), LAR_ERROR_IO);
    assert_non_null(strstr(f->error.message, "organ_000000.vtu"));
    assert_int_equal(mkdir(FOLDER, 0777), 0);
    add(f);
    assert_int_equal(access(FOLDER "/organ_000000.vtu", F_OK), 0);
    assert_int_equal(access(FOLDER "/organ_000001.vtu", F_OK), -1);
}

static void a_state_without_numbers_is_not_written(void **state) {
    fixture *f = *state;
    open_results(f);
    f->simulation->state
        .u[lar_state_at(&f->simulation->state, f->simulation->domain.layout.local[7], 1)] = NAN;
    assert_int_equal(lar_results_add(f->results, f->simulation, &f->error), LAR_ERROR_UNSTABLE);
    assert_non_null(strstr(f->error.message, "node 8 "));
    assert_int_equal(access(FOLDER "/organ_000000.vtu", F_OK), -1);
    assert_int_equal(access(FOLDER "/organ.pvd", F_OK), -1);
}

static void folders_are_made_with_those_above(void **state) {
    (void)state;
    lar_error error;
    assert_int_equal(lar_folder_make(FOLDER "/a//b/c/", &error), LAR_OK);
    assert_int_equal(lar_folder_make(FOLDER "/a/b/c", &error), LAR_OK);
    assert_int_equal(rmdir(FOLDER "/a/b/c"), 0);
    assert_int_equal(rmdir(FOLDER "/a/b"), 0);
    assert_int_equal(rmdir(FOLDER "/a"), 0);
    assert_int_equal(lar_folder_make("/", &error), LAR_OK);
    assert_int_equal(lar_folder_make("", &error), LAR_ERROR_IO);
    char *path = lar_folder_join("a/", "b");
    assert_string_equal(path, "a/b");
    free(path);
}

int main(void) {
#define WITH_FIXTURE(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
    const struct CMUnitTest tests[] = {WITH_FIXTURE(a_frame_holds_the_state),
                                       WITH_FIXTURE(fields_are_those_asked_for),
                                       WITH_FIXTURE(fibres_turn_with_the_tissue),
                                       WITH_FIXTURE(the_series_lists_what_is_there),
                                       WITH_FIXTURE(adding_frames_changes_nothing),
                                       WITH_FIXTURE(probes_have_names_units_and_values),
                                       WITH_FIXTURE(probes_of_elements_are_means),
                                       WITH_FIXTURE(without_probes_there_is_the_time),
                                       WITH_FIXTURE(a_line_is_whole_or_not_there),
                                       WITH_FIXTURE(an_embedded_surface_waits_to_be_asked),
                                       WITH_FIXTURE(an_embedded_surface_has_frames_of_its_own),
                                       WITH_FIXTURE(the_frames_of_the_mesh_keep_their_name),
                                       WITH_FIXTURE(the_surface_it_was_read_from_is_spared),
                                       WITH_FIXTURE(checkpoints_do_not_know_of_it),
                                       WITH_FIXTURE(names_follow_the_models_file),
                                       WITH_FIXTURE(senseless_calls_are_refused),
                                       WITH_FIXTURE(another_model_is_refused),
                                       WITH_FIXTURE(a_file_is_no_folder),
                                       WITH_FIXTURE(a_lost_folder_is_reported_and_may_come_back),
                                       WITH_FIXTURE(a_state_without_numbers_is_not_written),
                                       WITH_FIXTURE(folders_are_made_with_those_above)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
