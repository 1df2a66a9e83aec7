/* The .vtu and .pvd writers: what is written reads back bit for bit, and appears whole or not at
 * all. */
#include "model/vtk_sample.h"

#include <float.h>
#include <locale.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#include "model/format/vtk/vtk_grid.h"
#include "model/format/vtk/vtu_array.h"
#include "model/format/vtk/vtu_split.h"

enum { NX = 16, NY = 10, NZ = 10, COLUMN = (NY + 1) * (NZ + 1) };

static const char path[] = LAR_TEST_BUILD "/test_vtu_write.vtu";
static const char part[] = LAR_TEST_BUILD "/test_vtu_write.vtu.part";

static int32_t *copy_of(const int32_t *index, size_t count) {
    int32_t *copy = malloc((count + 1) * sizeof *copy);
    assert_non_null(copy);
    if (count > 0) memcpy(copy, index, count * sizeof *copy);
    return copy;
}

static void add_set(lar_mesh *mesh, const char *name, lar_set_kind kind, const int32_t *index,
                    int32_t count) {
    lar_error error;
    if (lar_mesh_add_set(mesh, name, kind, copy_of(index, (size_t)count), count, &error))
        fail_msg("%s", error.message);
}

/* A bent brick whose arrays are longer than one block of 32 KiB. */
static lar_mesh make_brick(void) {
    lar_mesh mesh = {.node_count = (NX + 1) * COLUMN, .element_count = NX * NY * NZ};
    mesh.position = calloc((size_t)mesh.node_count, sizeof *mesh.position);
    mesh.element = calloc((size_t)mesh.element_count, sizeof *mesh.element);
    mesh.element_tag = calloc((size_t)mesh.element_count, sizeof *mesh.element_tag);
    assert_true(mesh.position && mesh.element && mesh.element_tag);
    for (int32_t n = 0; n < mesh.node_count; n++) {
        double x = n / COLUMN, y = n % COLUMN / (NZ + 1), z = n % (NZ + 1);
        mesh.position[n][0] = x / 7 + 0.01 * sin(y);
        mesh.position[n][1] = y / 3 + 0.01 * sin(z);
        mesh.position[n][2] = z / 11 + 0.01 * sin(x);
    }
    for (int32_t e = 0; e < mesh.element_count; e++) {
        int32_t x = e / (NY * NZ), y = e / NZ % NY, z = e % NZ;
        int32_t first = x * COLUMN + y * (NZ + 1) + z;
        const int32_t step[8] = {0, COLUMN,     COLUMN + NZ + 1, NZ + 1,
                                 1, COLUMN + 1, COLUMN + NZ + 2, NZ + 2};
        for (int a = 0; a < 8; a++) mesh.element[e][a] = first + step[a];
        mesh.element_tag[e] = e % 5 - 2;
    }
    add_set(&mesh, "base", LAR_SET_NODES, (const int32_t[]){0, 5, 1000}, 3);
    add_set(&mesh, "base", LAR_SET_ELEMENTS, (const int32_t[]){1599}, 1);
    add_set(&mesh, "a \"b\" <c> & 100%\t\xc3\xa4\xff", LAR_SET_FACES,
            (const int32_t[]){9599, 3, 4, 0}, 4);
    add_set(&mesh, "nobody", LAR_SET_NODES, NULL, 0);
    return mesh;
}

static lar_mesh read_back(const char *file) {
    lar_bytes bytes = {0};
    lar_mesh mesh = {0};
    lar_error error;
    if (lar_bytes_read(file, &bytes, &error) || lar_vtu_parse(file, &bytes, &mesh, &error))
        fail_msg("%s", error.message);
    lar_bytes_free(&bytes);
    return mesh;
}

static void test_round_trip(void **state) {
    (void)state;
    lar_mesh mesh = make_brick();
    lar_error error;
    const lar_vtu_frame frame = {.mesh = &mesh, .time = 0.25};
    if (lar_vtu_write(path, &frame, &error)) fail_msg("%s", error.message);
    assert_int_not_equal(access(part, F_OK), 0);
    lar_mesh back = read_back(path);
    assert_int_equal(back.node_count, mesh.node_count);
    assert_int_equal(back.element_count, mesh.element_count);
    assert_memory_equal(back.position, mesh.position,
                        (size_t)mesh.node_count * sizeof *mesh.position);
    assert_memory_equal(back.element, mesh.element,
                        (size_t)mesh.element_count * sizeof *mesh.element);
    assert_memory_equal(back.element_tag, mesh.element_tag,
                        (size_t)mesh.element_count * sizeof *mesh.element_tag);
    assert_int_equal(back.set_count, mesh.set_count);
    for (int32_t i = 0; i < mesh.set_count; i++) {
        assert_string_equal(back.set[i].name, mesh.set[i].name);
        expect_set(&back, mesh.set[i].name, mesh.set[i].kind, mesh.set[i].index, mesh.set[i].count);
    }
    if (lar_mesh_check(&back, &error)) fail_msg("%s", error.message);
    lar_mesh_clear(&back);
    lar_mesh_clear(&mesh);
    remove(path);
}

/* A mesh without tags, other positions. */
static void test_positions_of_the_frame(void **state) {
    (void)state;
    lar_mesh mesh = make_brick();
    free(mesh.element_tag);
    mesh.element_tag = NULL;
    double(*moved)[3] = calloc((size_t)mesh.node_count, sizeof *moved);
    assert_non_null(moved);
    for (int32_t n = 0; n < mesh.node_count; n++) moved[n][0] = n / 3.0;
    moved[1][1] = -0.0;
    moved[2][2] = DBL_TRUE_MIN;
    const lar_vtu_frame frame = {.mesh = &mesh, .position = (const double(*)[3])moved};
    lar_error error;
    if (lar_vtu_write(path, &frame, &error)) fail_msg("%s", error.message);
    lar_mesh back = read_back(path);
    assert_memory_equal(back.position, moved, (size_t)mesh.node_count * sizeof *moved);
    for (int32_t e = 0; e < back.element_count; e++) assert_int_equal(back.element_tag[e], 0);
    lar_mesh_clear(&back);
    lar_mesh_clear(&mesh);
    free(moved);
    remove(path);
}

/* The values of the array with that Name, through the reader's own decoder. */
static double *read_array(const lar_bytes *bytes, const char *name, size_t count) {
    lar_vtu_split split;
    lar_error error;
    if (lar_vtu_split_file("back", bytes, &split, &error)) fail_msg("%s", error.message);
    char quoted[100];
    snprintf(quoted, sizeof quoted, "Name=\"%s\"", name);
    const char *tag = strstr(split.xml, quoted);
    if (!tag) fail_msg("%s is not in the file", quoted);
    size_t offset = strtoull(strstr(tag, "offset=\"") + 8, NULL, 10);
    const lar_vtu_array_text array = {
        .path = "back",
        .name = name,
        .type = LAR_VTK_FLOAT64,
        .encoding = LAR_VTU_RAW,
        .appended = true,
        .compressed = true,
        .header64 = true,
        .payload = {split.appended.at + offset, split.appended.length - offset}};
    double *values = NULL;
    if (lar_vtu_array_doubles(&array, count, &values, &error)) fail_msg("%s", error.message);
    lar_vtu_split_clear(&split);
    return values;
}

static void test_results(void **state) {
    (void)state;
    lar_mesh mesh = make_brick();
    size_t nodes = (size_t)mesh.node_count, elements = (size_t)mesh.element_count;
    double *u = calloc(nodes * 3, sizeof *u), *stress = calloc(elements, sizeof *stress);
    assert_true(u && stress);
    for (size_t i = 0; i < nodes * 3; i++) u[i] = cos((double)i) * pow(10, (double)(i % 600) - 300);
    u[0] = NAN;
    u[1] = -INFINITY;
    for (size_t i = 0; i < elements; i++) stress[i] = 1.0 / (double)(i + 1);
    const lar_vtu_array point = {"displacement", 3, u}, cell = {"p < q & \"r\"", 1, stress};
    const lar_vtu_frame frame = {&mesh, NULL, &point, 1, &cell, 1, 1.0 / 3};
    lar_error error;
    if (lar_vtu_write(path, &frame, &error)) fail_msg("%s", error.message);
    lar_bytes bytes = {0};
    assert_int_equal(lar_bytes_read(path, &bytes, &error), LAR_OK);
    double *back = read_array(&bytes, "displacement", nodes * 3);
    assert_memory_equal(back, u, nodes * 3 * sizeof *u);
    free(back);
    back = read_array(&bytes, "p &lt; q &amp; &quot;r&quot;", elements);
    assert_memory_equal(back, stress, elements * sizeof *stress);
    free(back);
    back = read_array(&bytes, "TimeValue", 1);
    assert_memory_equal(back, &frame.time, sizeof frame.time);
    free(back);
    lar_bytes_free(&bytes);
    lar_mesh_clear(&mesh);
    free(u);
    free(stress);
    remove(path);
}

/* The same frame gives the same bytes. */
static void test_same_bytes(void **state) {
    (void)state;
    lar_mesh mesh = make_brick();
    const lar_vtu_frame frame = {.mesh = &mesh};
    lar_bytes first = {0}, second = {0};
    lar_error error;
    assert_int_equal(lar_vtu_write(path, &frame, &error), LAR_OK);
    assert_int_equal(lar_bytes_read(path, &first, &error), LAR_OK);
    assert_int_equal(lar_vtu_write(path, &frame, &error), LAR_OK);
    assert_int_equal(lar_bytes_read(path, &second, &error), LAR_OK);
    assert_int_equal(first.size, second.size);
    assert_memory_equal(first.data, second.data, first.size);
    lar_bytes_free(&first);
    lar_bytes_free(&second);
    lar_mesh_clear(&mesh);
    remove(path);
}

static void expect_write_error(const char *file, const lar_vtu_frame *frame, const char *cause) {
    lar_error error = {0};
    assert_int_equal(lar_vtu_write(file, frame, &error), LAR_ERROR_IO);
    if (!strstr(error.message, cause) || !strstr(error.message, file))
        fail_msg("message: %s", error.message);
    assert_int_equal(error.status, LAR_ERROR_IO);
}

/* /dev/full takes nothing: ENOSPC, for a frame larger and for one smaller than stdio's buffer. */
static void test_full_disk(void **state) {
    (void)state;
    if (access("/dev/full", W_OK) != 0) skip();
    lar_mesh mesh = make_brick(), small = make_brick();
    small.node_count = 8;
    small.element_count = 1;
    const lar_vtu_frame frame = {.mesh = &mesh}, small_frame = {.mesh = &small};
    lar_error error;
    assert_int_equal(lar_vtu_write(path, &frame, &error), LAR_OK); /* stays as it is below */
    lar_bytes before = {0}, after = {0};
    assert_int_equal(lar_bytes_read(path, &before, &error), LAR_OK);
    for (int k = 0; k < 3; k++) {
        assert_int_equal(symlink("/dev/full", part), 0);
        if (k < 2) {
            expect_write_error(path, k ? &frame : &small_frame, "No space left on device");
        } else {
            const double time = 0;
            const char *const file = "a.vtu";
            assert_int_equal(lar_pvd_write(path, &file, &time, 1, &error), LAR_ERROR_IO);
            assert_non_null(strstr(error.message, "No space left on device"));
        }
        struct stat info;
        assert_int_not_equal(lstat(part, &info), 0);
    }
    assert_int_equal(lar_bytes_read(path, &after, &error), LAR_OK);
    assert_int_equal(before.size, after.size);
    assert_memory_equal(before.data, after.data, before.size);
    lar_bytes_free(&before);
    lar_bytes_free(&after);
    lar_mesh_clear(&mesh);
    lar_mesh_clear(&small);
    remove(path);
}

static void test_bad_places(void **state) {
    (void)state;
    lar_mesh mesh = make_brick();
    const lar_vtu_frame frame = {.mesh = &mesh};
    expect_write_error(LAR_TEST_BUILD "/no such folder/a.vtu", &frame, "No such file");
    const char *folder = LAR_TEST_BUILD "/test_vtu_write.folder";
    mkdir(folder, 0700);
    expect_write_error(folder, &frame, "is no plain file");
    assert_int_not_equal(access(LAR_TEST_BUILD "/test_vtu_write.folder.part", F_OK), 0);
    rmdir(folder);
    lar_error error;
    const char *const file = "a.vtu";
    const double time = 0;
    assert_int_equal(lar_pvd_write("/proc/no/a.pvd", &file, &time, 1, &error), LAR_ERROR_IO);
    lar_mesh_clear(&mesh);
}

static void test_collection(void **state) {
    (void)state;
    static const char file[] = LAR_TEST_BUILD "/test_vtu_write.pvd";
    static const char *const files[] = {"frame_0.vtu", "a & \"b\" <c>.vtu"};
    static const double times[] = {0, 0.1};
    /* A comma as decimal point must not reach the file; where no such locale is installed the
     * test still holds. */
    setlocale(LC_ALL, "de_DE.UTF-8");
    lar_error error;
    lar_status status = lar_pvd_write(file, files, times, 2, &error);
    setlocale(LC_ALL, "C");
    if (status) fail_msg("%s", error.message);
    lar_bytes bytes = {0};
    assert_int_equal(lar_bytes_read(file, &bytes, &error), LAR_OK);
    const char *text = (const char *)bytes.data;
    assert_non_null(strstr(text, "<VTKFile type=\"Collection\""));
    assert_non_null(strstr(text, "timestep=\"0\" part=\"0\" file=\"frame_0.vtu\"/>"));
    assert_non_null(strstr(text, "timestep=\"0.10000000000000001\" part=\"0\" "
                                 "file=\"a &amp; &quot;b&quot; &lt;c>.vtu\"/>"));
    lar_bytes_free(&bytes);
    remove(file);
}

static void test_set_names(void **state) {
    (void)state;
    char every[256];
    for (int i = 1; i < 256; i++) every[i - 1] = (char)i;
    every[255] = '\0';
    char *encoded = lar_vtk_encode_name("", every);
    assert_non_null(encoded);
    for (const char *c = encoded; *c; c++)
        assert_true(*c > ' ' && *c < 0x7f && !strchr("\"<>&", *c));
    char *decoded = lar_vtk_decode_name(encoded, strlen(encoded));
    assert_string_equal(decoded, every);
    free(encoded);
    free(decoded);
    decoded = lar_vtk_decode_name("100% %4 %zz%41%00%4", 19);
    assert_string_equal(decoded, "100% %4 %zzA%00%4");
    free(decoded);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip), cmocka_unit_test(test_positions_of_the_frame),
        cmocka_unit_test(test_results),    cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_full_disk),  cmocka_unit_test(test_bad_places),
        cmocka_unit_test(test_collection), cmocka_unit_test(test_set_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
