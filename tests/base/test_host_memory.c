/* Memory from the host: all of it, back to the last block; and where it gives none, a sentence and
 * nothing lost, whichever request it is that fails. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lariat.h"
#include "testing.h"

#define FOLDER LAR_TEST_BUILD "/host_memory"

/* Every block has its size and a mark in front, so that nobody else's is taken for one. */
enum { MARK = 0x1a71a7 };
typedef struct head {
    void *block;
    size_t bytes, mark;
} head;

static long blocks, requests, fail_at; /* atomic; fail_at: 0: none */
static lar_error error;

static head *head_of(void *memory) {
    head *h = (head *)((char *)memory - sizeof(head));
    if (h->mark != MARK) abort();
    return h;
}

static void *allocate(void *context, size_t bytes, size_t alignment) {
    if (context != &blocks) abort();
    if (__atomic_add_fetch(&requests, 1, __ATOMIC_RELAXED) == fail_at) return NULL;
    char *block = malloc(bytes + alignment + sizeof(head));
    if (!block) return NULL;
    uintptr_t at = ((uintptr_t)block + sizeof(head) + alignment - 1) / alignment * alignment;
    char *memory = block + (at - (uintptr_t)block);
    *(head *)(void *)(memory - sizeof(head)) = (head){block, bytes, MARK};
    memset(memory, 0xa5, bytes);
    __atomic_add_fetch(&blocks, 1, __ATOMIC_RELAXED);
    return memory;
}

static void release(void *context, void *memory) {
    if (context != &blocks) abort();
    head *h = head_of(memory);
    h->mark = 0;
    __atomic_sub_fetch(&blocks, 1, __ATOMIC_RELAXED);
    free(h->block);
}

static void *resize(void *context, void *memory, size_t bytes) {
    void *larger = allocate(context, bytes, _Alignof(max_align_t));
    if (!larger) return NULL;
    size_t old = head_of(memory)->bytes;
    memcpy(larger, memory, old < bytes ? old : bytes);
    release(context, memory);
    return larger;
}

static const lar_memory_hooks hooks = {allocate, resize, release, &blocks};

/* From a file to results: the first failure. */
static lar_status live(const char *grid) {
    lar_options options = lar_options_default();
    lar_model *model = NULL;
    lar_simulation *simulation = NULL, *clone = NULL;
    lar_saved *saved = NULL;
    lar_session *session = NULL;
    lar_snapshot *snapshot = NULL;
    lar_results *results = NULL;
    lar_tool_info wanted = {.shape = LAR_TOOL_SPHERE, .radius = 0.02};
    options.hands = options.spares = 1;
    options.grid = grid;
    lar_status status = lar_model_open(LAR_TEST_EXAMPLES "/beam.yaml", &model, &error);
    if (!status) status = lar_simulation_create(model, &options, &simulation, &error);
    if (!status) status = lar_simulation_add_tool(simulation, &wanted, NULL, &error);
    if (!status) status = lar_simulation_advance(simulation, 20, &error);
    if (!status) status = lar_simulation_set_support(simulation, 3, LAR_AXIS_ALL, 1, &error);
    if (!status) status = lar_simulation_advance(simulation, 20, &error);
    if (!status) status = lar_saved_create(simulation, &saved, &error);
    if (!status) status = lar_simulation_save_to(simulation, saved, &error);
    if (!status) status = lar_simulation_save(simulation, FOLDER "_state", &error);
    if (!status) status = lar_simulation_load(simulation, FOLDER "_state", &error);
    if (!status && !grid) status = lar_simulation_clone(simulation, &clone, &error);
    if (!status) status = lar_results_open(FOLDER, simulation, &results, &error);
    if (!status) status = lar_results_add(results, simulation, &error);
    lar_status closed = lar_results_close(results, status ? NULL : &error);
    if (!status) status = closed;
    if (!status) status = lar_simulation_reset(simulation, &error);
    if (!status) status = lar_session_open(simulation, NULL, &session, &error);
    if (!status) status = lar_snapshot_create(session, &snapshot, &error);
    if (!status) status = lar_session_start(session, &error);
    if (!status) status = lar_session_snapshot(session, snapshot, 60, &error);
    lar_snapshot_destroy(snapshot);
    closed = lar_session_close(session, status ? NULL : &error);
    if (!status) status = closed;
    lar_simulation_destroy(clone);
    lar_saved_destroy(saved);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return status;
}

static lar_status mesh(void) {
    uint16_t label[512] = {0};
    const lar_image_info from = {
        .size = {8, 8, 8},
        .to_world = {{0.01, 0, 0, 0}, {0, 0.01, 0, 0}, {0, 0, 0.01, 0}},
        .label = label,
    };
    for (int i = 0; i < 512; i++)
        label[i] =
            i % 8 > 1 && i % 8 < 6 && i / 8 % 8 > 1 && i / 8 % 8 < 6 && i / 64 > 1 && i / 64 < 6;
    lar_meshing_options options = lar_meshing_options_default();
    lar_image *image = NULL;
    lar_meshing *meshing = NULL;
    const char *scene;
    options.elements = 100;
    lar_status status = lar_image_create(&from, NULL, NULL, &image, &error);
    if (!status) status = lar_meshing_of_image(image, &options, &meshing, &error);
    if (!status) status = lar_meshing_scene(meshing, &scene, &error);
    if (!status) status = lar_meshing_write(meshing, FOLDER, NULL, &error);
    lar_meshing_destroy(meshing);
    lar_image_destroy(image);
    return status;
}

static void all_of_it_comes_back(void **unused) {
    (void)unused;
    const char *const grids[] = {NULL, "2x1x1"};
    for (int k = 0; k < 3; k++) {
        long before = requests;
        if (k < 2 ? live(grids[k]) : mesh()) fail_msg("%s", error.message);
        assert_true(requests - before > 100);
        assert_int_equal(blocks, 0);
    }
    assert_int_equal(lar_memory_set(&hooks, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "before all other calls"));
    assert_int_equal(lar_memory_set(NULL, &error), LAR_ERROR_ARGUMENT);
}

/* Every so many-th request fails in its turn. What can do without may. */
static void refusals(lar_status (*work)(void)) {
    long before = requests, told = 0;
    if (work()) fail_msg("%s", error.message);
    long all = requests - before, stride = all * test_every(3) / 300 + 1;
    for (long k = 1; k <= all; k += stride) {
        error = (lar_error){LAR_OK, ""};
        requests = 0;
        fail_at = k;
        lar_status status = work();
        fail_at = 0;
        if (blocks != 0) fail_msg("request %ld: %ld blocks are lost", k, blocks);
        if (status && status != LAR_ERROR_MEMORY)
            fail_msg("request %ld: status %d: %s", k, (int)status, error.message);
        if (status) assert_non_null(strstr(error.message, "memory"));
        told += status != LAR_OK;
    }
    assert_true(told > 100 / test_every(3));
}

static lar_status live_alone(void) {
    return live(NULL);
}
static lar_status live_divided(void) {
    return live("2x1x1");
}

static void none_is_told(void **unused) {
    (void)unused;
    refusals(live_alone);
    refusals(live_divided);
    refusals(mesh);
}

/* Supports are set, or nothing has changed. */
static void no_support_is_set_by_half(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_simulation *one = NULL, *other = NULL;
    lar_status status = lar_model_open(LAR_TEST_EXAMPLES "/beam.yaml", &model, &error);
    if (!status) status = lar_simulation_create(model, NULL, &one, &error);
    if (!status) status = lar_simulation_create(model, NULL, &other, &error);
    assert_int_equal(status, LAR_OK);
    for (int held = 1; held >= 0; held--) {
        long failures = 0;
        do {
            lar_simulation_advance(one, 20, NULL);
            lar_simulation_advance(other, 20, NULL);
            assert_true(lar_simulation_hash(one) == lar_simulation_hash(other));
            requests = 0;
            fail_at = failures + 1;
            status = lar_simulation_set_support(one, 3, LAR_AXIS_ALL, held, &error);
            fail_at = 0;
            assert_int_equal(lar_simulation_support(one, 3) != 0, (held != 0) ^ (status != LAR_OK));
            failures += status == LAR_ERROR_MEMORY;
        } while (status == LAR_ERROR_MEMORY);
        assert_int_equal(status, LAR_OK);
        assert_true(failures > 4);
        assert_int_equal(lar_simulation_set_support(other, 3, LAR_AXIS_ALL, held, &error), LAR_OK);
    }
    lar_simulation_destroy(one);
    lar_simulation_destroy(other);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_of_it_comes_back),
        cmocka_unit_test(none_is_told),
        cmocka_unit_test(no_support_is_set_by_half),
    };
    if (lar_memory_set(&hooks, &error)) return 1;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
