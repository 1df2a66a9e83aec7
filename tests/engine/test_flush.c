/* Blocks that stand exactly on each other, side over side: pressed they bear what one block does,
 * and when they part they are like any others. */
#include "engine/body_contact_test.h"
#include "engine/friction_test.h"

/* Nodes of the sides of both cubes of n elements, the second of which begins at node `first`. */
static lar_node_list both_sides(const brick *b, int axis, int32_t first) {
    lar_node_list one = brick_side(b, axis, 0),
                  all = {2 * one.count, lar_calloc(2 * (size_t)one.count, 4)};
    for (int32_t i = 0; i < one.count; i++) {
        all.node[i] = one.node[i];
        all.node[one.count + i] = one.node[i] + first;
    }
    free(one.node);
    return all;
}

static lar_node_list shifted(lar_node_list nodes, int32_t by) {
    for (int32_t i = 0; i < nodes.count; i++) nodes.node[i] += by;
    return nodes;
}

static double force_below(const lar_simulation *s, const brick *b) {
    lar_node_list below = brick_side(b, 2, 0);
    double(*force)[3] = lar_calloc((size_t)s->domain.model->mesh.node_count, sizeof *force),
    sum = 0;
    lar_error error;
    if (lar_simulation_nodal_forces(s, LAR_CAUSE_SUPPORTS, -1, force, &error))
        fail_msg("%s", error.message);
    for (int32_t i = 0; i < below.count; i++) sum += force[below.node[i]][2];
    free(below.node);
    free(force);
    return sum;
}

/* One cube on another: the nodes of the upper one begin with *first. */
static lar_model *two_cubes(const brick *cube, double edge, int32_t *first) {
    lar_model *model = empty_model(cube);
    add_brick(model, cube, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    *first = add_brick(model, cube, (double[]){0, 0, edge});
    touch_between(model, split);
    return model;
}

/* What the fixed nodes below bear in the end [N]; the model is destroyed. */
static double force_in_the_end(lar_model *model, const brick *cube) {
    model->damping = 60;
    lar_simulation *s = start(model);
    while (lar_simulation_time(s) < 0.6) advance(s, 100);
    double force = force_below(s, cube);
    finish(s, model);
    return force;
}

/* Two cubes of 3 x 3 x 3 elements, the upper one moved aside and turned about the vertical axis,
 * pressed by a tenth of one with what is above and below held. Returns the force [N]. */
static double pressed_aside(double aside, double degrees) {
    const double edge = 0.03, turn = degrees * acos(-1) / 180;
    const brick cube = {{3, 3, 3}, edge / 3, 0, LAR_LAW_neo_hookean, 1e4, 1e6, 1000};
    int32_t first;
    lar_model *model = two_cubes(&cube, edge, &first);
    for (int32_t n = first; n < model->mesh.node_count; n++) {
        double *x = model->mesh.position[n], a = x[0] - edge / 2, b = x[1] - edge / 2;
        x[0] = edge / 2 + aside + cos(turn) * a - sin(turn) * b;
        x[1] = edge / 2 + sin(turn) * a + cos(turn) * b;
    }
    fix_nodes(model, brick_side(&cube, 2, 0), LAR_AXIS_ALL);
    fix_nodes(model, shifted(brick_side(&cube, 2, -1), first), LAR_AXIS_X | LAR_AXIS_Y);
    move_nodes(model, shifted(brick_side(&cube, 2, -1), first), LAR_AXIS_Z, -0.1 * edge,
               add_ramp(model, 0.1));
    return force_in_the_end(model, &cube);
}

/* Both in one piece. */
static double pressed_as_one(void) {
    const double edge = 0.03;
    const brick body = {{3, 3, 6}, edge / 3, 0, LAR_LAW_neo_hookean, 1e4, 1e6, 1000};
    lar_model *model = brick_model(&body);
    fix_nodes(model, brick_side(&body, 2, 0), LAR_AXIS_ALL);
    fix_nodes(model, brick_side(&body, 2, -1), LAR_AXIS_X | LAR_AXIS_Y);
    move_nodes(model, brick_side(&body, 2, -1), LAR_AXIS_Z, -0.1 * edge, add_ramp(model, 0.1));
    return force_in_the_end(model, &body);
}

/* Not quite flush blocks bear what flush ones do: 0.1 mm aside, or half a degree, once cost 27 and
 * 47 % of it. Farther aside less of them lies on each other. */
static void a_little_aside_bears_too(void **unused) {
    (void)unused;
    static const struct {
        double aside, degrees, least;
    } way[] = {{2e-5, 0, 0.98},    {1e-4, 0, 0.98}, {3e-4, 0, 0.98}, {1e-3, 0, 0.975},
               {2.4e-3, 0, 0.96},  {5e-3, 0, 0.91}, {0, 0.5, 0.972}, {2e-4, 2, 0.972},
               {1e-3, -10, 0.962}, {0, 45, 0.922}};
    const double one = pressed_as_one();
    for (size_t i = 0; i < sizeof way / sizeof way[0]; i++) {
        double part = pressed_aside(way[i].aside, way[i].degrees) / one;
        print_message("%g mm aside, turned by %g degrees: %.4f of the force\n", 1e3 * way[i].aside,
                      way[i].degrees, part);
        assert_below(way[i].least, part);
        assert_below(part, 1.002);
    }
}

/* A quarter of two cubes with n elements along an edge, pressed together by a part of one. Returns
 * the force, as a part of that of a body of which all is strained alike. */
static double pressed(int n, double by) {
    const double edge = 0.02;
    const brick cube = {{n, n, n}, edge / n, 0, LAR_LAW_neo_hookean, 1e3, 1e4, 1000};
    int32_t first;
    lar_model *model = two_cubes(&cube, edge, &first);
    fix_nodes(model, both_sides(&cube, 0, first), LAR_AXIS_X);
    fix_nodes(model, both_sides(&cube, 1, first), LAR_AXIS_Y);
    fix_nodes(model, brick_side(&cube, 2, 0), LAR_AXIS_Z);
    move_nodes(model, shifted(brick_side(&cube, 2, -1), first), LAR_AXIS_Z, -by * edge,
               add_ramp(model, 0.2));
    double force = force_in_the_end(model, &cube);

    /* One element of the same shape and strain, with nothing between. */
    const brick alike = {{1, 1, 1}, edge, 0, LAR_LAW_neo_hookean, 1e3, 1e4, 1000};
    model = brick_model(&alike);
    fix_nodes(model, brick_side(&alike, 0, 0), LAR_AXIS_X);
    fix_nodes(model, brick_side(&alike, 1, 0), LAR_AXIS_Y);
    fix_nodes(model, brick_side(&alike, 2, 0), LAR_AXIS_Z);
    move_nodes(model, brick_side(&alike, 2, -1), LAR_AXIS_Z, -0.5 * by * edge,
               add_ramp(model, 0.2));
    double wanted = force_in_the_end(model, &alike);
    return force / wanted;
}

/* What is missing is how far contact lets them in, which is less the smaller the elements are: with
 * edges that went down along each other's sides 0.15, 0.61 and 0.77 were left with 2, 4 and 6. */
static void a_pressed_edge_bears(void **unused) {
    (void)unused;
    static const double least[] = {0.73, 0.84, 0.87, 0.92}, half[] = {0.64, 0.78, 0.82, 0.89};
    static const int cells[] = {1, 2, 3, 6};
    for (int i = 0; i < 4; i++) {
        double part = pressed(cells[i], 0.2), hard = pressed(cells[i], 0.5);
        print_message("%d elements along an edge: %.3f of the force when pressed by a fifth, %.3f "
                      "by half\n",
                      cells[i], part, hard);
        assert_below(least[i], part);
        assert_below(part, 1.001);
        assert_below(half[i], hard);
        assert_below(hard, 1.001);
    }
}

/* Two cubes of 4 x 4 x 4 elements, `gap` apart at rest, are drawn apart by `part` and then pressed
 * by a twentieth of one. Returns the force [N]; *hash of all that is at its end. */
static double pressed_again(double gap, double part, int always, uint64_t *hash) {
    const double edge = 0.01, by = 0.05 * edge; /* the gap is the contact distance */
    const brick cube = {{4, 4, 4}, edge / 4, 0, LAR_LAW_neo_hookean, 4e3, 2e5, 1040};
    const double way[][2] = {{0, 0}, {0.05, -part / by}, {0.15, 1}};
    int32_t first;
    lar_model *model = two_cubes(&cube, edge, &first);
    for (int32_t n = first; n < model->mesh.node_count; n++) model->mesh.position[n][2] += gap;
    fix_nodes(model, brick_side(&cube, 2, 0), LAR_AXIS_ALL);
    fix_nodes(model, shifted(brick_side(&cube, 2, -1), first), LAR_AXIS_X | LAR_AXIS_Y);
    move_nodes(model, shifted(brick_side(&cube, 2, -1), first), LAR_AXIS_Z, -by,
               add_table(model, LAR_CURVE_SMOOTH, 3, way));
    model->damping = 200;
    lar_options options = lar_options_default();
    options.search_always = always;
    lar_simulation *s = start_with(model, options);
    while (lar_simulation_time(s) < 0.3) advance(s, 100);
    double force = force_below(s, &cube);
    *hash = lar_simulation_hash(s);
    finish(s, model);
    return force;
}

/* They went 0.3 mm into each other along all edges, and a quarter of the force was missing. */
static void who_parts_and_meets_again_bears(void **unused) {
    (void)unused;
    static const double gap[] = {0, 0, 0, 1e-6, 5e-5, 1.5e-4, 5e-5},
                        part[] = {2e-4, 6e-4, 3e-3, 0, 0, 0, 1e-3};
    uint64_t hash, always;
    const double flush = pressed_again(0, 0, 0, &hash);
    for (size_t i = 0; i < sizeof gap / sizeof gap[0]; i++) {
        double force = pressed_again(gap[i], part[i], 0, &hash) / flush;
        pressed_again(gap[i], part[i], 1, &always);
        print_message("%g mm apart at rest, drawn apart by %g mm: %.4f of the force\n",
                      1e3 * gap[i], 1e3 * part[i], force);
        assert_true(hash == always);
        assert_below(0.97, force); /* 0.75 before */
        assert_below(force, 1.03);
    }
}

/* A block that stands flush on another one and slides off over its edge, falls beside it and comes
 * against its side. */
static lar_model *sliding(int32_t *first) {
    static const brick lower = {{4, 3, 3}, 0.01, 0, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};
    static const brick upper = {{4, 3, 2}, 0.01, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1000};
    lar_model *model = empty_model(&lower);
    add_brick(model, &lower, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    *first = add_brick(model, &upper, (double[]){0, 0, 0.03});
    touch_between(model, split);
    fix_nodes(model, brick_side(&lower, 2, 0), LAR_AXIS_ALL);
    memcpy(model->gravity, (double[]){0, 0, -9.81}, 24);
    throw_nodes(model, *first, model->mesh.node_count, (double[]){0.35, 0.1, 0});
    return model;
}

static void who_slides_off_gains_nothing(void **unused) {
    (void)unused;
    int32_t first;
    lar_model *model = sliding(&first);
    lar_simulation *s = start(model);
    lar_energy e;
    double start = body_energy(s, &e), highest = start, error = 0, lowest = 0;
    while (lar_simulation_time(s) < 0.3) {
        advance(s, 5);
        double now = body_energy(s, &e);
        highest = fmax(highest, now - e.external);
        error = fmax(error, fabs(now + e.contact - e.external - start));
        lowest = fmin(lowest, node_u(s, first)[2]);
    }
    print_message(
        "slid off: energy at most %.6f of the start, account %.1e of it; fell by %.3f m\n",
        highest / start, error / start, -lowest);
    assert_below(highest, 1.001 * start);
    assert_below(error, 2e-3 * start);
    assert_below(0.01, -lowest);
    finish(s, model);
}

/* A block of 40 x 40 x 40 mm that is cut through at an angle of that slope in its middle, its two
 * halves pressed by 2 mm while the top is drawn along the slope by `along`; or in one piece.
 * Returns the force on the lower half across the cut, and *tangential along it [N]. */
static double pressed_oblique(double steep, int cut, double friction, double along,
                              double *tangential) {
    const double edge = 0.04;
    const int32_t layers = cut ? 4 : 8;
    const brick half = {{8, 8, layers}, edge / 8, 0, LAR_LAW_neo_hookean, 8e3, 2e4, 1000};
    lar_model *model = empty_model(&half);
    add_brick(model, &half, (double[]){0, 0, 0});
    const int32_t split = model->mesh.element_count;
    const int32_t first = cut ? add_brick(model, &half, (double[]){0, 0, edge / 2}) : 0;
    if (cut) touch_between(model, split);
    if (cut) model->contact[0].friction = friction;
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double *x = model->mesh.position[n];
        x[2] += steep * (x[0] - edge / 2) * (1 - fabs(2 * x[2] / edge - 1));
    }
    const double way[][2] = {{0, 0}, {0.15, 0}, {0.35, 1}};
    fix_nodes(model, brick_side(&half, 2, 0), LAR_AXIS_ALL);
    fix_nodes(model, shifted(brick_side(&half, 2, -1), first), LAR_AXIS_Y);
    move_nodes(model, shifted(brick_side(&half, 2, -1), first), LAR_AXIS_Z, -0.002,
               add_ramp(model, 0.15));
    move_nodes(model, shifted(brick_side(&half, 2, -1), first), LAR_AXIS_X, along,
               add_table(model, LAR_CURVE_SMOOTH, 3, way));
    model->damping = 100;
    lar_simulation *s = start(model);
    while (lar_simulation_time(s) < 0.45) advance(s, 100);
    lar_node_list below = brick_side(&half, 2, 0);
    double(*force)[3] = lar_calloc((size_t)model->mesh.node_count, sizeof *force), sum[2] = {0};
    lar_error error;
    if (lar_simulation_nodal_forces(s, LAR_CAUSE_SUPPORTS, -1, force, &error))
        fail_msg("%s", error.message);
    for (int32_t i = 0; i < below.count; i++)
        for (int k = 0; k < 2; k++) sum[k] += force[below.node[i]][2 * k];
    free(below.node);
    free(force);
    finish(s, model);
    const double cosine = 1 / sqrt(1 + steep * steep), sine = steep * cosine;
    *tangential = cosine * sum[0] + sine * sum[1];
    return cosine * sum[1] - sine * sum[0];
}

/* Edges of less than 105 degrees alone were taken for such of flush bodies: the others sank in by a
 * fifth of an element, and held what slides like nails. */
static void an_oblique_cut_bears(void **unused) {
    (void)unused;
    static const double steep[] = {0, 0.2, 0.36, 0.84};
    for (int i = 0; i < 4; i++) {
        double along, held = pressed_oblique(steep[i], 1, 5, 0, &along) /
                             pressed_oblique(steep[i], 0, 0, 0, &along);
        double across = pressed_oblique(steep[i], 1, 0.15, -0.002, &along);
        print_message("cut with a slope of %g: %.4f of the force in one piece; friction %.4f\n",
                      steep[i], held, along / across);
        assert_below(0.92, held);
        assert_below(held, 1.002);
        assert_below(fabs(along / across), 0.165);
    }
}

/* Blocks that stand side by side on one (T) or on two (X), pulled apart or laid on each other, in
 * the first place by nothing but rounding. A node on the line where they meet is no more in a
 * joint of the two others than beside it. */
static void who_meets_along_a_line_stays(void **unused) {
    (void)unused;
    static const double edge = 0.01;
    for (int kind = 0; kind < 8; kind++) {
        const int below = 1 + (kind & 1), up = (kind & 2) != 0, even = (kind & 4) == 0;
        const brick slab = {
            {below == 2 ? 2 : 4, 2, 2}, edge / 2, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
        const brick cube = {{2, 2, 2}, edge / 2, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
        lar_model *model = empty_model(&slab);
        int32_t first[2] = {0};
        for (int i = 0; i < below; i++)
            first[i] = add_brick(model, &slab, (double[]){i * edge, 0, 0});
        for (int i = 0; i < 2; i++)
            add_brick(model, &cube, (double[]){i * edge + (even ? 0 : 1e-3), 0, edge});
        touch_self(model);
        for (int i = 0; i < below; i++)
            fix_nodes(model, shifted(brick_side(&slab, 2, 0), first[i]), LAR_AXIS_ALL);
        memcpy(model->gravity, (double[]){up ? 1e-4 : 0, 0, up ? 1e-3 : -9.81}, 24);
        model->damping = 100;
        lar_simulation *s = start(model);
        while (lar_simulation_time(s) < 0.3) advance(s, 100);
        lar_energy e;
        const double energy = body_energy(s, &e);
        print_message("kind %d: kinetic %.2e J, contact %.2e J of %.2e J\n", kind, e.kinetic,
                      e.contact, energy);
        assert_below(-1e-3 * fabs(energy), e.contact);
        if (!up) assert_below(e.kinetic, 1e-2 * fabs(energy));
        finish(s, model);
    }
}

static bool has_parted(const lar_simulation *s, int32_t node) {
    return signbit(s->state.level[s->domain.layout.local[node]]);
}

/* Two cubes stand on a slab, flush with it and each other, and one slides off. The lower corners of
 * the side that they had in common are flush with the slab still, whether the cube that has gone is
 * in the list or not. */
static uint64_t one_has_gone(const lar_model *model, const brick *cube, int32_t stays, int always) {
    lar_options options = lar_options_default();
    options.search_always = always;
    lar_simulation *s = start_with(model, options);
    while (lar_simulation_time(s) < 0.2) advance(s, 20);
    const uint64_t hash = lar_simulation_hash(s);
    const lar_node_list side = brick_side(cube, 0, -1);
    for (int32_t i = 0; i < side.count; i++) {
        const int32_t node = stays + side.node[i];
        const double y = model->mesh.position[node][1], z = model->mesh.position[node][2];
        if (y == 0) assert_int_equal(has_parted(s, node), z > 0.011);
    }
    free(side.node);
    lar_simulation_destroy(s);
    return hash;
}

static void who_stands_on_another_stays_flush(void **unused) {
    (void)unused;
    const brick slab = {{8, 2, 2}, 0.005, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    const brick cube = {{2, 2, 2}, 0.005, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = empty_model(&slab);
    add_brick(model, &slab, (double[]){0, 0, 0});
    const int32_t goes = add_brick(model, &cube, (double[]){0.01, 0, 0.01});
    const int32_t stays = add_brick(model, &cube, (double[]){0, 0, 0.01});
    touch_self(model);
    fix_nodes(model, brick_side(&slab, 2, 0), LAR_AXIS_ALL);
    throw_nodes(model, goes, stays, (double[]){0.1, 0, 0});
    memcpy(model->gravity, (double[]){0, 0, -9.81}, 24);
    assert_true(one_has_gone(model, &cube, stays, 0) == one_has_gone(model, &cube, stays, 1));
    lar_model_destroy(model);
}

static void it_has_the_same_bits(void **unused) {
    (void)unused;
    static const halves run = {90, 260}; /* in the middle of parting */
    int32_t first;
    lar_model *model = sliding(&first);
    for (int rough = 0; rough < 2; rough++) {
        model->contact[0].friction = rough ? 0.2 : 0;
        lar_simulation *s = start(model);
        lar_error error;
        advance(s, run.half_way);
        assert_int_equal(lar_simulation_save(s, "flush.checkpoint", &error), LAR_OK);
        advance(s, run.end - run.half_way);
        uint64_t hash = lar_simulation_hash(s);
        lar_simulation_destroy(s);
        has_the_same_bits(model, "flush.checkpoint", run, hash);
    }
    lar_model_destroy(model);
}

/* A plate that falls on a cushion of its own outline from some millimetres meets the rim, too. */
static void who_falls_straight_on_it_stays_out(void **unused) {
    (void)unused;
    static const double gap[] = {0, 0.002, 0.005, 0.02};
    const brick cushion = {{6, 6, 3}, 0.01, 0, LAR_LAW_coupled_neo_hookean, 1.5e5, 1e5, 30};
    const brick plate = {{4, 4, 1}, 0.015, 0, LAR_LAW_coupled_neo_hookean, 1.5e6, 1e6, 3e4};
    for (size_t i = 0; i < sizeof gap / sizeof gap[0]; i++) {
        lar_model *model = empty_model(&cushion);
        add_brick(model, &cushion, (double[]){0, 0, 0});
        lar_material *material = LAR_MODEL_APPEND(model, material);
        *material = model->material[0];
        material->name = NULL;
        material->density = plate.density;
        const int32_t nodes = model->mesh.node_count, elements = model->mesh.element_count;
        add_brick(model, &plate, (double[]){0, 0, 0.03 + gap[i]});
        for (int32_t e = elements; e < model->mesh.element_count; e++)
            model->element_material[e] = 1;
        fix_nodes(model, brick_side(&cushion, 2, 0), LAR_AXIS_ALL);
        throw_nodes(model, nodes, model->mesh.node_count, (double[]){0, 0, -1});
        touch_between(model, elements);
        lar_simulation *s = start(model);
        while (lar_simulation_time(s) < 0.02 + gap[i]) advance(s, 16);
        lar_contact_info info;
        lar_simulation_contact(s, &info);
        print_message("from %g mm: %.2f mm deep\n", 1e3 * gap[i], 1e3 * info.deepest_ever);
        assert_true(info.deepest_ever > 0);
        assert_below(info.deepest_ever, 0.0025); /* the rim by 6 mm before */
        finish(s, model);
    }
}

/* Who has parted from what it was flush with may then come behind another body, and files hold
 * both. */
static void files_hold_who_parted_and_is_behind(void **unused) {
    (void)unused;
    static const double levels[] = {-4e-300, -5e-300, -1e-300, -1e-3, -0.0};
    int32_t first;
    lar_model *model = sliding(&first);
    lar_simulation *s = start(model), *later = start(model);
    lar_error error;
    advance(s, 90);
    for (int k = 0; k < 5; k++) s->state.level[k] = levels[k];
    assert_int_equal(lar_simulation_save(s, "parted.checkpoint", &error), LAR_OK);
    if (lar_simulation_load(later, "parted.checkpoint", &error)) fail_msg("%s", error.message);
    assert_memory_equal(later->state.level, levels, sizeof levels);
    lar_simulation_destroy(later);
    finish(s, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_little_aside_bears_too),
        cmocka_unit_test(a_pressed_edge_bears),
        cmocka_unit_test(who_parts_and_meets_again_bears),
        cmocka_unit_test(an_oblique_cut_bears),
        cmocka_unit_test(who_meets_along_a_line_stays),
        cmocka_unit_test(who_slides_off_gains_nothing),
        cmocka_unit_test(who_stands_on_another_stays_flush),
        cmocka_unit_test(it_has_the_same_bits),
        cmocka_unit_test(who_falls_straight_on_it_stays_out),
        cmocka_unit_test(files_hold_who_parted_and_is_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
