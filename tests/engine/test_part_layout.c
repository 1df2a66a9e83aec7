/* Layouts of parts of models: what must hold of every layout, and beyond it threads, batches,
 * owners and the corners of the whole. At last how many blocks the demonstration organ needs when
 * it is cut (printed), since a part may not cost much more than its share. */
#include "divide/distribution.h"
#include "layout/finish.h"
#include "layout_test.h"
#include "model/demo/demo.h"

/* ---- parts ---------------------------------------------------------------------------------- */

/* The arrays of a part that may be written. */
typedef struct slice {
    lar_part part;
    int32_t *thread, *batch, *owner;
} slice;

static slice new_slice(const lar_mesh *mesh, int32_t threads) {
    slice s = {.thread = lar_calloc((size_t)mesh->element_count, sizeof(int32_t)),
               .batch = lar_calloc((size_t)mesh->element_count, sizeof(int32_t)),
               .owner = lar_calloc((size_t)mesh->node_count, sizeof(int32_t))};
    s.part = (lar_part){threads, s.thread, s.batch, s.owner};
    return s;
}

static void free_slice(slice *s) {
    free(s->thread);
    free(s->batch);
    free(s->owner);
}

/* Every node is moved by a thread that has an element there, the first one or any. */
static void give_nodes(const lar_mesh *mesh, slice *s, bool any) {
    for (int32_t n = 0; n < mesh->node_count; n++) s->owner[n] = -1;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; s->thread[e] >= 0 && a < 8; a++) {
            int32_t *owner = &s->owner[mesh->element[e][a]];
            if (*owner < 0 || (any ? chance(2) == 0 : s->thread[e] < *owner)) *owner = s->thread[e];
        }
}

/* Batch 0 at the border to other processors, 1 behind it, and so on. */
static void batches_from_border(const lar_mesh *mesh, slice *s, int32_t max) {
    int32_t *depth = lar_calloc((size_t)mesh->node_count, sizeof *depth);
    for (int32_t n = 0; n < mesh->node_count; n++) depth[n] = max;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; s->thread[e] < 0 && a < 8; a++) depth[mesh->element[e][a]] = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) s->batch[e] = max;
    for (int32_t layer = 0; layer < max; layer++) {
        for (int32_t e = 0; e < mesh->element_count; e++)
            for (int a = 0; s->thread[e] >= 0 && s->batch[e] == max && a < 8; a++)
                if (depth[mesh->element[e][a]] == layer) s->batch[e] = layer;
        for (int32_t e = 0; e < mesh->element_count; e++)
            for (int a = 0; s->batch[e] == layer && a < 8; a++)
                if (depth[mesh->element[e][a]] == max) depth[mesh->element[e][a]] = layer + 1;
    }
    free(depth);
}

/* ---- what must hold ------------------------------------------------------------------------- */

static void check_lanes(const lar_part *part, const lar_lanes *block) {
    int32_t earliest = INT32_MAX;
    for (int k = 0; k < LAR_BLOCK; k++) {
        lar_gid e = block->element[k];
        if (e < 0) continue;
        assert_int_equal(part->thread[e], block->thread);
        if (part->batch[e] < earliest) earliest = part->batch[e];
    }
    assert_int_equal(block->batch, earliest);
}

static void check_part(const lar_model *model, const lar_layout *whole, const lar_part *part,
                       const lar_layout *layout) {
    const lar_mesh *mesh = &model->mesh;
    bool *seen = lar_calloc((size_t)mesh->element_count, sizeof *seen);
    assert_ptr_equal(layout->corner, whole->corner);
    assert_int_equal(layout->thread_count, part->threads);
    check_nodes(mesh, layout, part->owner);
    for (int32_t b = 0; b < layout->block_count; b++) {
        check_block(model, layout, &layout->block[b], seen);
        check_lanes(part, &layout->block[b]);
    }
    for (lar_gid e = 0; e < mesh->element_count; e++)
        assert_int_equal(seen[e], part->thread[e] >= 0);
    check_order(layout);
    free(seen);
}

/* Lays out a part and checks it; the cost. */
static double cost_of_part(const lar_model *model, const lar_layout *whole, const lar_part *part) {
    lar_layout layout;
    lar_error error;
    if (lar_layout_create_part(model, whole, part, &layout, &error)) fail_msg("%s", error.message);
    check_part(model, whole, part, &layout);
    double cost = lar_layout_cost(&layout);
    lar_layout_destroy(&layout);
    lar_layout_destroy(&layout); /* idempotent, and the whole keeps its corners */
    return cost;
}

/* ---- tests ----------------------------------------------------------------------------------- */

/* Threads in slabs or at random, some elements elsewhere, batches at random. */
static void fill_at_random(const lar_mesh *mesh, slice *s) {
    int32_t slab = 1 + chance(mesh->element_count), elsewhere = chance(3) * 20;
    int32_t batches = 1 + chance(5), way = chance(3);
    for (int32_t e = 0; e < mesh->element_count; e++) {
        s->thread[e] = way == 0   ? chance(s->part.threads)
                       : way == 1 ? e / slab % s->part.threads
                                  : s->part.threads / 2;
        s->batch[e] = way == 0 ? chance(batches) : e / (1 + slab / 2) % batches;
        if (chance(100) < elsewhere) s->thread[e] = -1;
    }
    s->thread[0] = 0;
    give_nodes(mesh, s, chance(2));
}

static void parts_of_bricks(void **unused) {
    (void)unused;
    chance_state = 11;
    for (int n = 0; n < 30; n++) {
        brick b = {{1 + chance(14), 1 + chance(6), 1 + chance(5)},
                   0.01,
                   n % 2 ? 0.1 : 0,
                   LAR_LAW_neo_hookean,
                   2e3,
                   2e4,
                   1000};
        lar_model *model = brick_model(&b);
        if (n % 3 == 0) mix_laws(model, n % 2);
        if (n % 5 == 0) turn_elements(&model->mesh);
        lar_layout whole;
        assert_int_equal(lar_layout_create(model, &whole, NULL), LAR_OK);
        for (int i = 0; i < 4; i++) {
            slice s = new_slice(&model->mesh, 1 + chance(i < 3 ? 4 : LAR_LAYOUT_THREADS));
            fill_at_random(&model->mesh, &s);
            cost_of_part(model, &whole, &s.part);
            free_slice(&s);
        }
        lar_layout_destroy(&whole);
        lar_model_destroy(model);
    }
}

/* All of a model in one part, and slices of it at random, in turn; the model is destroyed. */
static void check_slices(lar_model *model, int slices) {
    lar_layout whole;
    assert_int_equal(lar_layout_create(model, &whole, NULL), LAR_OK);
    for (int i = 0; i < slices; i++) {
        slice s = new_slice(&model->mesh, 1 + i / 2);
        if (i % 2) fill_at_random(&model->mesh, &s);
        cost_of_part(model, &whole, &s.part);
        free_slice(&s);
    }
    lar_layout_destroy(&whole);
    lar_model_destroy(model);
}

/* Chains that end nowhere, and one that crosses itself. */
static void parts_of_rings(void **unused) {
    (void)unused;
    chance_state = 12;
    for (int n = 0; n < 12; n++) {
        int width = 1 + n % 3, around = width == 1 ? 3 + 3 * n : 9 + n;
        lar_model *model = n ? ring(around, width, around > 8 ? n % 5 : 0) : loop();
        check_slices(model, 4);
    }
}

/* Around a core, where the line that goes on beyond the end of a row may be another of the row. */
static void parts_of_discs(void **unused) {
    (void)unused;
    chance_state = 13;
    for (int n = 0; n < 40; n++) {
        lar_model *model = disc(1 + n % 5, 1 + chance(6), 1 + chance(4));
        if (n % 4 == 3) turn_elements(&model->mesh);
        check_slices(model, 6);
    }
}

/* A row of eight needs its lines in one hand. */
static void owners_end_rows(void **unused) {
    (void)unused;
    brick b = {{16, 1, 1}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = brick_model(&b);
    lar_layout whole;
    assert_int_equal(lar_layout_create(model, &whole, NULL), LAR_OK);
    slice s = new_slice(&model->mesh, 2);
    assert_true(cost_of_part(model, &whole, &s.part) == 2);
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        s.owner[n] = 1; /* another thread's: fine */
    assert_true(cost_of_part(model, &whole, &s.part) == 2);
    for (int i = 0; i < 4; i++) s.owner[brick_node(&b, 8, i % 2, i / 2)] = 0;
    assert_true(cost_of_part(model, &whole, &s.part) > 2); /* rows 0..3 and 9..12 */
    free_slice(&s);
    lar_layout_destroy(&whole);
    lar_model_destroy(model);
}

/* A row is as early as its first element. */
static void batches_and_rows(void **unused) {
    (void)unused;
    brick b = {{8, 4, 1}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = brick_model(&b);
    lar_layout whole;
    assert_int_equal(lar_layout_create(model, &whole, NULL), LAR_OK);
    slice s = new_slice(&model->mesh, 1);
    for (int e = 0; e < 32; e++) s.batch[e] = e % 8 < 4 ? 3 : 7;
    assert_true(cost_of_part(model, &whole, &s.part) == 4);
    free_slice(&s);
    lar_layout_destroy(&whole);
    lar_model_destroy(model);
}

static void one_element_and_idle_threads(void **unused) {
    (void)unused;
    brick b = {{5, 2, 2}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = brick_model(&b);
    lar_layout whole, layout;
    assert_int_equal(lar_layout_create(model, &whole, NULL), LAR_OK);
    for (int32_t thread = 0; thread < 4; thread++) {
        slice s = new_slice(&model->mesh, 4);
        for (int e = 0; e < 20; e++) s.thread[e] = e == 7 ? thread : -1;
        give_nodes(&model->mesh, &s, false);
        cost_of_part(model, &whole, &s.part);
        assert_int_equal(lar_layout_create_part(model, &whole, &s.part, &layout, NULL), LAR_OK);
        assert_int_equal(layout.block_count, 1);
        assert_int_equal(layout.node_count, 8);
        assert_int_equal(layout.node_padded, 16);
        assert_int_equal(layout.first_node[thread], 0);
        assert_int_equal(layout.first_node[thread + 1], 16);
        lar_layout_destroy(&layout);
        s.owner[0] = (thread + 1) % 4; /* moved here, though no element here has it */
        cost_of_part(model, &whole, &s.part);
        free_slice(&s);
    }
    lar_layout_destroy(&whole);
    lar_model_destroy(model);
}

static void what_is_not_there_is_refused(void **unused) {
    (void)unused;
    brick b = {{3, 1, 1}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = brick_model(&b);
    lar_layout whole, layout;
    lar_error error;
    assert_int_equal(lar_layout_create(model, &whole, NULL), LAR_OK);
    for (int fault = 0; fault < 6; fault++) {
        slice s = new_slice(&model->mesh, 2);
        if (fault == 0) s.part.threads = 0;
        if (fault == 1) s.part.threads = LAR_LAYOUT_THREADS + 1;
        if (fault == 2) s.thread[1] = 2;
        if (fault == 3) s.batch[1] = -1;
        if (fault == 4) s.owner[3] = -1;
        if (fault == 5) s.owner[3] = 2;
        assert_int_equal(lar_layout_create_part(model, &whole, &s.part, &layout, &error),
                         LAR_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, fault < 2   ? "threads in a processor"
                                              : fault < 4 ? "element 2 is given to"
                                                          : "node 4 of element 3"));
        assert_null(layout.block);
        free_slice(&s);
    }
    lar_layout_destroy(&whole);
    lar_model_destroy(model);
}

/* ---- the organ ------------------------------------------------------------------------------ */

static lar_model *organ; /* and its whole layout, once for all tests */
static lar_layout organ_whole;

static int make_organ(void **unused) {
    (void)unused;
    brick b = soft_brick;
    organ = brick_model(&b);
    lar_mesh_clear(&organ->mesh);
    free(organ->element_material);
    organ->element_material = lar_calloc(LAR_DEMO_ELEMENTS, sizeof(int32_t));
    return lar_demo_mesh(&organ->mesh, NULL) || lar_layout_create(organ, &organ_whole, NULL);
}

static int free_organ(void **unused) {
    (void)unused;
    lar_layout_destroy(&organ_whole);
    lar_model_destroy(organ);
    return 0;
}

typedef struct tally {
    int32_t blocks[LAR_ROWS_COUNT];
    double cost;
} tally;

static void count_blocks(const lar_layout *layout, tally *in) {
    for (int32_t b = 0; b < layout->block_count; b++) in->blocks[layout->block[b].rows]++;
    in->cost += lar_layout_cost(layout);
}

static void print_tally(const char *what, const tally *in) {
    print_message("%-44s %4d eights %3d pairs of fours %3d loose, cost %.2f (ideal %.2f)\n", what,
                  in->blocks[LAR_ROWS_EIGHT], in->blocks[LAR_ROWS_FOUR], in->blocks[LAR_ROWS_NONE],
                  in->cost, LAR_DEMO_ELEMENTS / 8.0);
}

/* One processor with one thread may lose next to nothing against the plain loop. */
static void all_of_the_organ_in_one_part(void **unused) {
    (void)unused;
    lar_layout layout;
    tally before = {0}, after = {0};
    count_blocks(&organ_whole, &before);
    slice s = new_slice(&organ->mesh, 1);
    assert_int_equal(lar_layout_create_part(organ, &organ_whole, &s.part, &layout, NULL), LAR_OK);
    check_part(organ, &organ_whole, &s.part, &layout);
    count_blocks(&layout, &after);
    print_tally("whole layout", &before);
    print_tally("the same as a part", &after);
    assert_true(after.cost <= 1.03 * before.cost);
    lar_layout_destroy(&layout);
    free_slice(&s);
}

/* The organ cut for a grid, each processor again into threads. */
static void cut_organ(const int grid[3], int32_t threads, int32_t batches) {
    const lar_mesh *mesh = &organ->mesh;
    lar_distribution cut, finer;
    lar_grid places, workers;
    lar_error error;
    assert_int_equal(lar_grid_make(grid[0], grid[1], grid[2], &places, &error), LAR_OK);
    assert_int_equal(lar_grid_make(grid[0], grid[1], grid[2] * threads, &workers, &error), LAR_OK);
    assert_int_equal(lar_distribution_cut(mesh, &places, &cut, &error), LAR_OK);
    assert_int_equal(lar_distribution_cut(mesh, &workers, &finer, &error), LAR_OK);
    tally in = {0};
    for (int32_t p = 0; p < places.count; p++) {
        slice s = new_slice(mesh, threads);
        for (int32_t e = 0; e < mesh->element_count; e++) {
            int32_t place[3];
            lar_grid_place(&workers, finer.processor[e], place);
            s.thread[e] = cut.processor[e] == p ? place[2] % threads : -1;
        }
        batches_from_border(mesh, &s, batches);
        give_nodes(mesh, &s, false);
        lar_layout layout;
        assert_int_equal(lar_layout_create_part(organ, &organ_whole, &s.part, &layout, NULL),
                         LAR_OK);
        check_part(organ, &organ_whole, &s.part, &layout);
        count_blocks(&layout, &in);
        lar_layout_destroy(&layout);
        free_slice(&s);
    }
    char what[80];
    snprintf(what, sizeof what, "%dx%dx%d, threads %d, batches %d", grid[0], grid[1], grid[2],
             threads, batches + 1);
    print_tally(what, &in);
    lar_distribution_clear(&cut);
    lar_distribution_clear(&finer);
}

static void the_organ_cut(void **unused) {
    (void)unused;
    static const int grids[][3] = {{2, 1, 1}, {2, 2, 1}, {2, 2, 3}};
    for (int32_t threads = 1; threads < 3; threads++)
        for (int g = 0; g < 3; g++) cut_organ(grids[g], threads, 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_of_bricks),
        cmocka_unit_test(parts_of_rings),
        cmocka_unit_test(parts_of_discs),
        cmocka_unit_test(owners_end_rows),
        cmocka_unit_test(batches_and_rows),
        cmocka_unit_test(one_element_and_idle_threads),
        cmocka_unit_test(what_is_not_there_is_refused),
        cmocka_unit_test(all_of_the_organ_in_one_part),
        cmocka_unit_test(the_organ_cut),
    };
    return cmocka_run_group_tests(tests, make_organ, free_organ);
}
