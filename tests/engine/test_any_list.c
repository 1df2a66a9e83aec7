/* What contact does is the same whatever pairs are in its list beside those that matter: heaps of
 * blocks of all kinds, with a list that is made in every step, with one that is made now and then,
 * and with those of two processors, which look at other times and as far as others move. */
#include "engine/body_contact_test.h"
#include "engine/tools_test.h"

/* One of `count`, by the seed and what it is for. */
static int choice(uint32_t seed, uint32_t what, int count) {
    return (int)(0.5 * (noise(97 * seed + 13 * what) + 1) * count);
}

static brick block(int cells, double edge) {
    return (brick){{cells, cells, cells}, edge / cells, 0, LAR_LAW_neo_hookean, 3e3, 2e4, 1000};
}

/* Two slabs that stand flush against each other, held below. */
static void add_ground(lar_model *model, uint32_t seed, double edge, double high) {
    const int wide = 1 + choice(seed, 1, 3);
    const brick slab = {{wide, 2 * wide, 1}, edge / wide, 0, LAR_LAW_neo_hookean, 3e3, 2e4, 1000};
    for (int i = 0; i < 2; i++) {
        const int32_t first = add_brick(model, &slab, (double[]){i * edge, 0, 0});
        for (int32_t n = first; n < model->mesh.node_count; n++)
            model->mesh.position[n][2] *= high / slab.edge;
        lar_node_list below = brick_side(&slab, 2, 0);
        for (int32_t k = 0; k < below.count; k++) below.node[k] += first;
        fix_nodes(model, below, LAR_AXIS_ALL);
    }
}

static void bind_block(lar_model *model, int32_t first, int32_t end, int i) {
    lar_tool *tool = bind_nodes(model, first, end);
    free(tool->name);
    tool->name = lar_strdup((const char[]){'b', (char)('0' + i), 0});
}

static lar_model *heap(uint32_t seed) {
    static const double edge = 0.02, gaps[] = {0, 0, 1e-3}, aside[] = {0, 0, 3e-4, 2e-3};
    const double gap = gaps[choice(seed, 2, 3)], shift = aside[choice(seed, 3, 4)], high = 0.01;
    const int blocks = 2 + choice(seed, 4, 4);
    const brick any = block(1, edge);
    lar_model *model = empty_model(&any);
    add_ground(model, seed, edge, high);
    for (int i = 0; i < blocks; i++) {
        const uint32_t what = 10 + 10 * (uint32_t)i;
        const brick cube = block(1 + choice(seed, what, 3), edge);
        const int column = i % 4;
        const double at[] = {
            (column % 2) * (edge + gap + 2 * shift) + shift * noise(7 * seed + what),
            (column / 2) * (edge + gap + 2 * shift) + shift * noise(9 * seed + what),
            high + gap + (i / 4) * (edge + gap)};
        const int32_t first = add_brick(model, &cube, at), end = model->mesh.node_count;
        if (choice(seed, what + 1, 3) == 0) bind_block(model, first, end, i);
        if (choice(seed, what + 2, 2) == 0)
            throw_nodes(model, first, end,
                        (double[]){noise(3 * seed + what), noise(5 * seed + what), 0});
    }
    touch_self(model);
    model->contact[0].friction = choice(seed, 5, 2) ? 0.5 : 0;
    memcpy(model->gravity, (double[]){2.0 * choice(seed, 6, 3), 0, -9.81}, 24);
    return model;
}

enum { LOOKS = 5, STEPS = 20 };

/* Which nodes are not flush any more: the hash does not say that. */
static uint64_t parted(lar_simulation *s) {
    uint64_t all = 0;
    assert_int_equal(lar_simulation_gather(s, NULL), LAR_OK);
    for (int32_t n = 0; n < s->domain.layout.node_count; n++)
        if (s->domain.layout.global[n] >= 0 && signbit(s->state.level[n]))
            all += (uint64_t)(s->domain.layout.global[n] + 1) * 0x9e3779b97f4a7c15;
    return all;
}

static void run(const lar_model *model, const char *grid, bool always, uint64_t hash[LOOKS]) {
    lar_options options = lar_options_default();
    options.grid = grid;
    options.search_always = always;
    lar_simulation *s = start_with(model, options);
    for (int i = 0; i < LOOKS; i++) {
        advance(s, STEPS);
        hash[i] = 31 * lar_simulation_hash(s) + parted(s);
    }
    lar_simulation_destroy(s);
}

/* How many of the other lists end otherwise. */
static int differ(const lar_model *model, uint32_t seed) {
    uint64_t always[LOOKS], hash[LOOKS];
    int wrong = 0;
    run(model, NULL, true, always);
    for (int kind = 0; kind < 2; kind++) {
        run(model, kind ? "2x1x1" : NULL, false, hash);
        int same = 0;
        while (same < LOOKS && hash[same] == always[same]) same++;
        if (same < LOOKS)
            print_message("%d, %s: another one between steps %d and %d\n", (int)seed,
                          kind ? "two processors" : "one", same * STEPS, (same + 1) * STEPS);
        wrong += same < LOOKS;
    }
    return wrong;
}

static void it_makes_no_difference(void **unused) {
    (void)unused;
    enum { HEAPS = 10 };
    int wrong = 0;
    for (uint32_t seed = 0; seed < HEAPS; seed++) {
        lar_model *model = heap(seed);
        wrong += differ(model, seed);
        lar_model_destroy(model);
    }
    assert_int_equal(wrong, 0);
}

/* A block that stands flush beside another one, of which there is only the upper half: it goes out
 * beyond the plane of symmetry, as far as some lists know of it and others do not, and comes back.
 */
static void nor_beyond_a_plane_of_symmetry(void **unused) {
    (void)unused;
    static const double edge = 0.02;
    int wrong = 0;
    for (uint32_t seed = 0; seed < 12; seed++) {
        const brick half = block(2, edge), other = block(1 + (int)seed % 2, edge);
        lar_model *model = empty_model(&half);
        add_brick(model, &half, (double[]){0, 0, 0});
        fix_nodes(model, brick_side(&half, 2, 0), LAR_AXIS_Z);
        const int32_t first = add_brick(model, &other, (double[]){edge, 0, 0});
        throw_nodes(model, first, model->mesh.node_count,
                    (double[]){0, 0, -0.7 - 0.05 * (double)seed});
        touch_self(model);
        model->gravity[2] = 40;
        wrong += differ(model, seed);
        lar_model_destroy(model);
    }
    assert_int_equal(wrong, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_makes_no_difference),
        cmocka_unit_test(nor_beyond_a_plane_of_symmetry),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
