/* Distributions: load balance of every way to make one, and the file in and out and damaged. */
#include "divide/balance.h"
#include "brick_mesh.h"
#include "model/demo/demo.h"

static const int edges[][3] = {{1, 1, 1}, {2, 1, 1}, {2, 2, 1}, {2, 2, 3}, {3, 3, 3},
                               {4, 4, 4}, {1, 5, 1}, {7, 1, 2}, {1, 1, 11}};
enum { GRIDS = sizeof edges / sizeof *edges };

/* Eq. 6.7, and no processor below the floor either. */
static void check_balance(const lar_distribution *d) {
    int32_t count[LAR_GRID_MAX];
    assert_true(lar_distribution_load(d, count));
    for (int32_t p = 0; p < d->grid.count; p++)
        assert_true(count[p] >= d->element_count / d->grid.count);
}

static void cut_and_random_are_balanced(void **state) {
    (void)state;
    lar_mesh organ = {0}, block = brick_mesh(5, 7, 3);
    assert_int_equal(lar_demo_mesh(&organ, NULL), LAR_OK);
    const lar_mesh *const meshes[] = {&organ, &block};
    for (int m = 0; m < 2; m++)
        for (int i = 0; i < GRIDS; i++) {
            lar_grid grid = grid_of(edges[i][0], edges[i][1], edges[i][2]);
            lar_distribution d = {0};
            assert_int_equal(lar_distribution_cut(meshes[m], &grid, &d, NULL), LAR_OK);
            check_balance(&d);
            lar_distribution_clear(&d);
            assert_int_equal(lar_distribution_random(meshes[m], &grid, 9, &d, NULL), LAR_OK);
            check_balance(&d);
            lar_distribution_clear(&d);
        }
    lar_mesh_clear(&organ);
    lar_mesh_clear(&block);
}

static void cutting_equal_positions_goes_by_element(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(12, 1, 1);
    for (int n = 0; n < mesh.node_count; n++) mesh.position[n][0] = 0;
    lar_grid grid = grid_of(4, 1, 1);
    lar_distribution d = {0};
    assert_int_equal(lar_distribution_cut(&mesh, &grid, &d, NULL), LAR_OK);
    for (int e = 0; e < 12; e++) assert_int_equal(d.processor[e], e / 3);
    lar_distribution_clear(&d);
    lar_mesh_clear(&mesh);
}

/* Every processor has one element at least, and by no more than the heaviest element and what is
 * cut off by each of three axes more than its share. */
static void weights_are_cut_too(void **state) {
    (void)state;
    lar_mesh organ = {0};
    assert_int_equal(lar_demo_mesh(&organ, NULL), LAR_OK);
    float *weight = lar_calloc((size_t)organ.element_count, sizeof *weight);
    for (int i = 0; i < GRIDS; i++)
        for (int heavy = 1; heavy <= 1000; heavy *= 10) {
            lar_grid grid = grid_of(edges[i][0], edges[i][1], edges[i][2]);
            lar_distribution d = {0};
            double all = 0;
            for (int32_t e = 0; e < organ.element_count; e++)
                all += (double)(weight[e] = (float)(e % 50 == 7 ? heavy : 1));
            assert_int_equal(lar_distribution_cut_by_weight(&organ, &grid, weight, &d, NULL), 0);
            for (int32_t p = 0; p < grid.count; p++) {
                double sum = 0;
                int32_t count = 0;
                for (int32_t e = 0; e < organ.element_count; e++)
                    if (d.processor[e] == p) count++, sum += (double)weight[e];
                assert_true(count >= 1);
                assert_true(sum <= all / grid.count + 3 * heavy);
            }
            if (heavy == 1) check_balance(&d);
            lar_distribution_clear(&d);
        }
    free(weight);
    lar_mesh_clear(&organ);
}

static void random_follows_its_seed(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 4, 4);
    lar_grid grid = grid_of(2, 2, 2);
    lar_distribution a = {0}, b = {0}, c = {0};
    lar_distribution_random(&mesh, &grid, 1, &a, NULL);
    lar_distribution_random(&mesh, &grid, 1, &b, NULL);
    lar_distribution_random(&mesh, &grid, 2, &c, NULL);
    assert_memory_equal(a.processor, b.processor, 64 * sizeof *a.processor);
    assert_memory_not_equal(a.processor, c.processor, 64 * sizeof *a.processor);
    lar_distribution_clear(&a);
    lar_distribution_clear(&b);
    lar_distribution_clear(&c);
    lar_mesh_clear(&mesh);
}

static void balancing(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(6, 5, 4);
    lar_incidence incidence;
    assert_int_equal(lar_incidence_build(&mesh, &incidence, NULL), LAR_OK);
    for (int way = 0; way < 3; way++) {
        /* All on one; slabs of unequal thickness with nobody on processor 3; far too many. */
        lar_distribution d = {0};
        lar_grid grid = grid_of(7, 1, 1);
        assert_int_equal(lar_distribution_create(&mesh, &grid, &d, NULL), LAR_OK);
        for (int e = 0; e < mesh.element_count && way > 0; e++)
            d.processor[e] = way == 1 ? (e / 30 == 3 ? 6 : e / 30) : e % 11 < 6 ? 0 : e % 7;
        assert_int_equal(lar_balance(&mesh, &incidence, 7, d.processor, NULL), LAR_OK);
        check_balance(&d);
        lar_distribution_clear(&d);
    }
    lar_incidence_clear(&incidence);
    lar_mesh_clear(&mesh);
}

static void metis(void **state) {
    (void)state;
    lar_mesh mesh = {0};
    lar_incidence incidence;
    assert_int_equal(lar_demo_mesh(&mesh, NULL), LAR_OK);
    assert_int_equal(lar_incidence_build(&mesh, &incidence, NULL), LAR_OK);
    for (int i = 0; i < GRIDS; i++) {
        lar_grid grid = grid_of(edges[i][0], edges[i][1], edges[i][2]);
        lar_distribution d = {0};
        lar_error error = {0};
        lar_status status = lar_distribution_metis(&mesh, &incidence, &grid, 1, &d, &error);
        if (!lar_distribution_has_metis()) {
            assert_int_equal(status, LAR_ERROR_UNSUPPORTED);
            assert_non_null(strstr(error.message, "libmetis-dev"));
            continue;
        }
        assert_int_equal(status, LAR_OK);
        check_balance(&d);
        lar_distribution_clear(&d);
    }
    lar_incidence_clear(&incidence);
    lar_mesh_clear(&mesh);
}

/* ---- the file --------------------------------------------------------------------------- */

static lar_status parse(const char *text, size_t size, const lar_mesh *mesh, lar_distribution *d,
                        lar_error *error) {
    /* Exactly as long as the text: a sanitizer sees every step too far. */
    lar_bytes bytes = {malloc(size + 1), size};
    memcpy(bytes.data, text, size);
    bytes.data[size] = 0;
    lar_status status = lar_distribution_parse("x.dist", &bytes, mesh, d, error);
    lar_bytes_free(&bytes);
    return status;
}

static void write_and_read(void **state) {
    (void)state;
    static const char path[] = LAR_TEST_BUILD "/divide.dist";
    lar_mesh mesh = brick_mesh(4, 3, 3);
    lar_grid grid = grid_of(2, 1, 3);
    lar_distribution d = {0}, again = {0};
    lar_distribution_random(&mesh, &grid, 4, &d, NULL);
    assert_int_equal(lar_distribution_write(path, &mesh, &d, NULL), LAR_OK);
    assert_int_equal(lar_distribution_read(path, &mesh, &again, NULL), LAR_OK);
    assert_memory_equal(&again.grid, &grid, sizeof grid);
    assert_memory_equal(again.processor, d.processor, 36 * sizeof *d.processor);
    lar_bytes bytes;
    assert_int_equal(lar_bytes_read(path, &bytes, NULL), LAR_OK);
    /* No beginning of the file passes for a file, but the one without the last line end. */
    for (size_t size = 0; size + 1 < bytes.size; size++) {
        lar_distribution none = {0};
        lar_error error = {0};
        lar_status status = parse((char *)bytes.data, size, &mesh, &none, &error);
        if (status != LAR_ERROR_FORMAT) fail_msg("the first %zu bytes: status %d", size, status);
        assert_non_null(strstr(error.message, "x.dist:"));
        assert_null(none.processor);
    }
    lar_bytes_free(&bytes);
    /* The same numbers of elements, but another mesh. */
    lar_mesh other = brick_mesh(3, 4, 3);
    lar_distribution none = {0};
    lar_error error = {0};
    assert_int_equal(lar_distribution_read(path, &other, &none, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, ":4: "));
    assert_int_equal(lar_distribution_write(LAR_TEST_BUILD "/none/x.dist", &mesh, &d, &error),
                     LAR_ERROR_IO);
    remove(path);
    lar_distribution_clear(&d);
    lar_distribution_clear(&again);
    lar_mesh_clear(&mesh);
    lar_mesh_clear(&other);
}

#define HEAD "lariat-distribution 1\ngrid 2x1x1\nelements 4\n"

static void by_hand(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1);
    lar_distribution d = {0};
    static const char text[] = "# the left one works less\nlariat-distribution   1\r\n\n"
                               "grid 2x1x1 # two\nelements 4\n"
                               "3  1\n0 0\n\n  1 1 # middle\n2\t1\nend\n# that was it\n";
    lar_error error = {0};
    /* A tab is no separator here, and is said so. */
    assert_int_equal(parse(text, strlen(text), &mesh, &d, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "x.dist:10: "));
    static const char good[] = "# the left one works less\nlariat-distribution   1\r\n\n"
                               "grid 2x1x1 # two\nelements 4\n"
                               "3  1\n0 0\n\n  1 1 # middle\n2 1\nend\n# that was it\n";
    if (parse(good, strlen(good), &mesh, &d, &error)) fail_msg("%s", error.message);
    assert_memory_equal(d.processor, ((int32_t[]){0, 1, 1, 1}), 16);
    lar_distribution_clear(&d);
    lar_mesh_clear(&mesh);
}

static void damaged(void **state) {
    (void)state;
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"hello\n", "x.dist:1: this is no distribution"},
        {"<?xml version=\"1.0\"?>\n", "x.dist:1: this is no distribution"},
        {"lariat-distribution 2\n", "x.dist:1: version 2"},
        {"lariat-distribution 1\nelements 4\n", "x.dist:2: here must stand 'grid'"},
        {"lariat-distribution 1\ngrid 2x2\n", "x.dist:2: '2x2' is no grid"},
        {"lariat-distribution 1\ngrid 5x1x1\nelements 4\n0 0\n1 1\n2 1\n3 1\nend\n",
         "x.dist:3: a grid of 5"},
        {"lariat-distribution 1\ngrid 2x1x1\nelements 5\n", "x.dist:3: the file is for 5"},
        {"lariat-distribution 1\ngrid 2x1x1\nelements -4\n", "x.dist:3: '-4' is no number"},
        {HEAD "0 0\n1 1\n2 1\n3 2\nend\n", "x.dist:7: the grid has no processor 2"},
        {HEAD "0 0\n1 1\n2 1\n4 1\nend\n", "x.dist:7: there is no element 4"},
        {HEAD "0 0\n1 1\n2 1\n-1 1\nend\n", "x.dist:7: there is no element -1"},
        {HEAD "0 0\n1 1\n2 1\n2 1\n3 1\nend\n", "x.dist:7: element 2 has a processor already"},
        {HEAD "0 0\n1 1\n2 1 \nend\n# ...\n", "x.dist:7: element 3 has no processor"},
        {HEAD "0 0\n1 1\n2 1\n3 x\nend\n", "x.dist:7: '3 x' is not"},
        {HEAD "0 0\n1 1\n2 1\n3\nend\n", "x.dist:7: '3' is not"},
        {HEAD "0 0\n1 0\n2 0\n3 0\nend\n", "x.dist:8: processor 1 has no element"},
        {HEAD "0 0\n1 1\n2 1\n3 1\nend\n3 1\n", "x.dist:9: nothing may follow"},
        {HEAD "mesh 12\n0 0\n1 1\n2 1\n3 1\nend\n", "x.dist:4: behind 'mesh'"},
        {HEAD "mesh 0123456789abcdef\n0 0\n1 1\n2 1\n3 1\nend\n", "x.dist:4: the file was made"},
        {HEAD "0 0\n1 1\n2 1\n3 1\n", "the file ends before"},
    };
    lar_mesh mesh = brick_mesh(4, 1, 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lar_distribution d = {0};
        lar_error error = {0};
        assert_int_not_equal(parse(cases[i].text, strlen(cases[i].text), &mesh, &d, &error),
                             LAR_OK);
        if (!strstr(error.message, cases[i].says))
            fail_msg("'%s' instead of '%s'", error.message, cases[i].says);
        assert_null(d.processor);
    }
    lar_distribution d = {0};
    lar_error error = {0};
    assert_int_equal(lar_distribution_read("/nowhere/x.dist", &mesh, &d, &error), LAR_ERROR_IO);
    lar_mesh_clear(&mesh);
}

static void too_many_processors(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(2, 1, 1);
    lar_grid grid = grid_of(3, 1, 1);
    lar_distribution d = {0};
    lar_error error = {0};
    assert_int_equal(lar_distribution_cut(&mesh, &grid, &d, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "smaller grid"));
    lar_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cut_and_random_are_balanced),
        cmocka_unit_test(cutting_equal_positions_goes_by_element),
        cmocka_unit_test(weights_are_cut_too),
        cmocka_unit_test(random_follows_its_seed),
        cmocka_unit_test(balancing),
        cmocka_unit_test(metis),
        cmocka_unit_test(write_and_read),
        cmocka_unit_test(by_hand),
        cmocka_unit_test(damaged),
        cmocka_unit_test(too_many_processors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
