/* Bodies that lie on each other: they come to rest, where there is a place to rest. */
#include "engine/body_contact_test.h"
#include "engine/tool_contact_test.h"

static const brick lower_brick = {{5, 4, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e4, 4e5, 1000};
static const brick upper_brick = {{3, 3, 3}, 0.008, 0, LAR_LAW_neo_hookean, 2e4, 4e5, 1000};

/* How a brick lies on another: where its sides are, whether it is kept from sliding, and how deep
 * the hollow is that it lies in. */
typedef struct laid {
    double x, y; /* [m] */
    bool kept;
    double hollow; /* [m] */
} laid;

static lar_model *laid_model(const brick *lower, const brick *upper, const laid *how) {
    lar_model *model = empty_model(lower);
    add_brick(model, lower, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    double top = lower->edge * lower->cells[2];
    int32_t first = add_brick(model, upper, (double[]){how->x, how->y, top});
    for (int32_t n = 0; n < first; n++) {
        double *x = model->mesh.position[n], side[2];
        if (x[2] < top - 0.5 * lower->edge) continue;
        for (int i = 0; i < 2; i++) side[i] = 2 * x[i] / (lower->edge * lower->cells[i]) - 1;
        x[2] -= how->hollow * (2 - side[0] * side[0] - side[1] * side[1]);
    }
    fix_nodes(model, brick_side(lower, 2, 0), LAR_AXIS_ALL);
    if (how->kept) {
        lar_node_list held = brick_side(upper, 2, -1);
        for (int32_t i = 0; i < held.count; i++) held.node[i] += first;
        fix_nodes(model, held, LAR_AXIS_X | LAR_AXIS_Y);
    }
    touch_between(model, split);
    memcpy(model->gravity, (double[]){0, 0, -9.81}, 24);
    model->damping = 60;
    return model;
}

/* Mean velocity of the nodes from `first` on. */
static void slide(const lar_simulation *s, int32_t first, double velocity[3]) {
    double mass = 0;
    for (int i = 0; i < 3; i++) velocity[i] = 0;
    for (int32_t n = first; n < s->domain.model->mesh.node_count; n++) {
        double m = s->domain.mass[s->domain.layout.local[n]];
        for (int i = 0; i < 3; i++) velocity[i] += m * node_v(s, n)[i];
        mass += m;
    }
    for (int i = 0; i < 3; i++) velocity[i] /= mass;
}

/* Kinetic energy half a step back, where nothing hides that goes to and fro in every step; of the
 * nodes from `first` on relative to a velocity. */
static double trembling(const lar_simulation *s, int32_t first, const double velocity[3]) {
    double energy = 0;
    for (int32_t n = 0; n < s->domain.model->mesh.node_count; n++)
        for (int i = 0; i < 3; i++) {
            double v = node_v(s, n)[i] - (n >= first ? velocity[i] : 0);
            energy += 0.5 * s->domain.mass[s->domain.layout.local[n]] * v * v;
        }
    return energy;
}

static void come_to_rest(const brick *lower, const brick *upper, const laid *how, double seconds) {
    lar_model *model = laid_model(lower, upper, how);
    lar_simulation *s = start(model);
    advance(s, (uint64_t)(seconds / lar_simulation_time_step(s)));
    lar_energy e;
    lar_contact_info info;
    lar_simulation_energy(s, &e);
    lar_simulation_contact(s, &info);
    print_message("at rest: %d nodes touch, %.2g of an element deep, kinetic %.2g of %.2g J\n",
                  (int)info.touching, info.deepest / upper->edge, e.kinetic, e.strain);
    assert_true(info.touching >= 16);
    bool deep = how->hollow > 0 || lower->bulk < 10 * lower->shear;
    assert_below(info.deepest, (deep ? 0.04 : 0.02) * upper->edge);
    assert_below(trembling(s, 0, (double[]){0, 0, 0}), 1e-9 * e.strain);
    finish(s, model);
}

static const double ahead = 0.013, middle = 0.008, beside = 0.0071;

/* In the middle nothing drives it to one side, kept in its place it cannot go, and in a hollow it
 * finds the deepest place. */
static void a_body_comes_to_rest_on_another(void **unused) {
    (void)unused;
    const laid balanced = {.x = ahead, .y = middle}, kept = {.x = ahead, .y = beside, .kept = true},
               hollow = {.x = ahead, .y = beside, .hollow = 0.001};
    brick lower = lower_brick, upper = upper_brick;
    for (int soft = 0; soft < 2; soft++) {
        if (soft) {
            lower.shear = upper.shear = 4e3;
            lower.bulk = upper.bulk = 4e4;
        }
        come_to_rest(&lower, &upper, &balanced, 1.5);
        come_to_rest(&lower, &upper, &kept, 1.5);
        if (soft) come_to_rest(&lower, &upper, &hollow, 4);
    }
}

/* Nodes lie exactly over lines between faces and between triangles, some of them beside a sharp
 * edge: no line may drive them to and fro. */
static void a_body_comes_to_rest_amid_another(void **unused) {
    (void)unused;
    const brick lower = {{4, 4, 2}, 0.01, 0, LAR_LAW_neo_hookean, 3.57e3, 1.67e4, 1000};
    const brick upper = {{6, 6, 3}, 0.005, 0, LAR_LAW_neo_hookean, 1.07e4, 5e4, 1000};
    come_to_rest(&lower, &upper, &(laid){.x = 0.005, .y = 0.005}, 3);
    come_to_rest(&lower, &upper, &(laid){.x = 0.005, .y = 0.005, .kept = true}, 1.5);
}

/* Beside the middle the lower one sags askew, and without friction there is no rest: as one piece,
 * and only so, the upper one goes down the slope, as slowly as the damping has it. */
static void a_body_beside_the_middle_slides_and_does_not_tremble(void **unused) {
    (void)unused;
    brick lower = lower_brick, upper = upper_brick;
    lower.shear = upper.shear = 4e3;
    lower.bulk = upper.bulk = 4e4;
    double way[2][3];
    for (int side = 0; side < 2; side++) {
        const laid how = {.x = ahead, .y = side ? 2 * middle - beside : beside};
        lar_model *model = laid_model(&lower, &upper, &how);
        int32_t first = brick_node(&lower, lower.cells[0], lower.cells[1], lower.cells[2]) + 1;
        lar_simulation *s = start(model);
        lar_energy before, e;
        advance(s, (uint64_t)(1.5 / lar_simulation_time_step(s)));
        lar_simulation_energy(s, &before);
        advance(s, (uint64_t)(1.5 / lar_simulation_time_step(s)));
        lar_simulation_energy(s, &e);
        slide(s, first, way[side]);
        double left = trembling(s, first, way[side]);
        print_message("beside the middle: %.2g mm/s, kinetic %.3g of %.2g J, but for the slide "
                      "%.2g J\n",
                      1e3 * way[side][1], e.kinetic, e.strain, left);
        assert_below(left, 1e-8 * e.strain);
        /* Downhill: what it has of weight's and strain's energy falls. */
        assert_below(e.strain + e.hourglass - e.external,
                     before.strain + before.hourglass - before.external);
        finish(s, model);
    }
    assert_true(way[0][1] < -1e-5); /* away from the middle */
    assert_below(fabs(way[0][1] + way[1][1]), 1e-4 * fabs(way[0][1]));
}

/* ---- with a tool between ----------------------------------------------------------------------
 */

/* A rod between two slabs of one layer, which are pressed onto each other around it: springs of
 * tools and of bodies side by side, where elements need all of their part of the step. */
/* A brick is pressed onto one like it, face on face and edge on edge, by a fifth of its height. */
static void press_face_on_face(int cells, double bulk, double share_of_stable) {
    const brick b = {{cells, cells, cells}, 0.02 / cells, 0, LAR_LAW_neo_hookean, 2e3, bulk, 1000};
    lar_model *model = empty_model(&b);
    add_brick(model, &b, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    int32_t first = add_brick(model, &b, (double[]){0, 0, 0.02});
    fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
    lar_node_list top = brick_side(&b, 2, -1), same = brick_side(&b, 2, -1);
    for (int32_t i = 0; i < top.count; i++) same.node[i] = top.node[i] += first;
    fix_nodes(model, same, LAR_AXIS_X | LAR_AXIS_Y);
    move_nodes(model, top, LAR_AXIS_Z, -0.004, add_ramp(model, 0.2));
    touch_between(model, split);
    model->damping = 100;
    lar_simulation *probe = start(model);
    double stable = probe->domain.stable_step;
    lar_simulation_destroy(probe);
    lar_options options = lar_options_default();
    options.time_step = share_of_stable * stable;
    lar_simulation *s = start_with(model, options);
    advance(s, (uint64_t)(1.0 / options.time_step));
    lar_energy e;
    lar_simulation_energy(s, &e);
    double left = trembling(s, 0, (double[]){0, 0, 0}) / e.strain;
    print_message("%d cells, K = %g G, %g of the stable step: kinetic %.2g\n", cells, bulk / 2e3,
                  share_of_stable, left);
    assert_below(left, 1e-7);
    finish(s, model);
}

/* However short steps are, and so hard the springs. */
static void bodies_rest_face_on_face(void **unused) {
    (void)unused;
    static const double share[] = {0.1, 0.2, 0.32, 0.5};
    for (int cells = 1; cells <= 3; cells++)
        for (int i = 0; i < 4; i++) {
            press_face_on_face(cells, 2e3, share[i]);
            press_face_on_face(cells, 2e4, share[i]);
        }
}

static void press_around_a_rod(double share_of_stable) {
    static const double radius = 0.006, down = 0.0145;
    brick slab = {{6, 6, 1}, 0.01, 0, LAR_LAW_neo_hookean, 4e3, 2e4, 1000};
    lar_model *model = empty_model(&slab);
    add_brick(model, &slab, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    int32_t first = add_brick(model, &slab, (double[]){0.003, 0.004, 0.01 + 2 * radius + 0.001});
    fix_nodes(model, brick_side(&slab, 2, 0), LAR_AXIS_ALL);
    for (int axis = 0; axis < 2; axis++) {
        lar_node_list top = brick_side(&slab, 2, -1);
        for (int32_t i = 0; i < top.count; i++) top.node[i] += first;
        if (axis)
            fix_nodes(model, top, LAR_AXIS_X | LAR_AXIS_Y);
        else
            move_nodes(model, top, LAR_AXIS_Z, -down, add_ramp(model, 0.3));
    }
    touch_between(model, split);
    model->damping = 40;
    double half = sqrt(0.5), along[4] = {half, 0, half, 0}, height = 0.01 + radius + 0.0005;
    touch_tool(model, "rod",
               (lar_tool){.shape = LAR_TOOL_CAPSULE, .radius = radius, .length = 0.04},
               (double[]){0.01, 0.03, height});
    memcpy(model->tool[0].rest.orientation, along, sizeof along);
    lar_options options = lar_options_default();
    options.time_step = share_of_stable * stable_step_of(model);
    lar_simulation *s = start_with(model, options);
    uint64_t steps = (uint64_t)(0.3 / options.time_step);
    place(s, 0, (double[]){0.01, 0.03, height - 0.5 * down}, along, 1, steps);
    advance(s, 5 * steps);
    lar_energy e;
    lar_contact_info info;
    lar_tool_force force;
    lar_simulation_energy(s, &e);
    lar_simulation_contact(s, &info);
    assert_int_equal(lar_simulation_tool_force(s, 0, &force, NULL), LAR_OK);
    double left = trembling(s, 0, (double[]){0, 0, 0});
    print_message("%.2f of the stable step: %d nodes and %d points of the rod touch, kinetic %.2g "
                  "of %.2g J\n",
                  share_of_stable, (int)info.touching, (int)force.touching, left, e.strain);
    assert_true(info.touching > 20 && force.touching > 20);
    assert_below(left, 1e-9 * e.strain);
    finish(s, model);
}

static void bodies_come_to_rest_around_a_tool(void **unused) {
    (void)unused;
    press_around_a_rod(0.5);
    press_around_a_rod(0.8);
}

/* Bends a brick around the axis z, a quarter of a ring between two radii: axis x goes around it, y
 * outwards. */
static void bend(lar_model *model, const brick *b, int32_t first, double inner, double outer) {
    const double right = acos(0);
    for (int32_t n = first; n < model->mesh.node_count; n++) {
        double *x = model->mesh.position[n];
        double turn = right * (1 - x[0] / (b->edge * b->cells[0]));
        double radius = inner + (outer - inner) * x[1] / (b->edge * b->cells[1]);
        x[0] = radius * cos(turn);
        x[1] = radius * sin(turn);
    }
}

static void press_outside(lar_model *model, int32_t first, double pressure, int curve) {
    enum { OUTER = 3 }; /* the local face that looks along y */
    int32_t count, kept = 0, *faces = outer_faces(model, first, model->mesh.element_count, &count);
    for (int32_t i = 0; i < count; i++)
        if (faces[i] % 6 == OUTER) faces[kept++] = faces[i];
    *(lar_pressure_load *)LAR_MODEL_APPEND(model, pressure) =
        (lar_pressure_load){kept, faces, pressure, curve};
}

static lar_node_list shifted(lar_node_list nodes, int32_t by) {
    for (int32_t i = 0; i < nodes.count; i++) nodes.node[i] += by;
    return nodes;
}

/* What lies on x = 0 or y = 0 has its mirror image there. */
static void fix_planes(lar_model *model, const brick *b, int32_t first) {
    fix_nodes(model, shifted(brick_side(b, 0, 0), first), LAR_AXIS_X);
    fix_nodes(model, shifted(brick_side(b, 0, -1), first), LAR_AXIS_Y);
    fix_nodes(model, shifted(brick_side(b, 2, 0), first), LAR_AXIS_Z);
    fix_nodes(model, shifted(brick_side(b, 2, -1), first), LAR_AXIS_Z);
}

/* A cuff that is pressed on a limb of as many elements around: its nodes go over the limb's, whose
 * feet in hollows of the cuff lie on sides of faces. It may tremble for ever, but contact
 * gives nothing, and it is not stopped. */
static void put_a_cuff_around_a_limb(int around, double friction) {
    const double bone = 0.015, skin = 0.045, wall = 0.003, gap = 0.0003;
    const brick limb = {{around, 4, 2}, 0.01, 0, LAR_LAW_neo_hookean, 5e3, 1e5, 1000};
    const brick cuff = {{around, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e4, 4e5, 1000};
    lar_model *model = empty_model(&limb);
    add_brick(model, &limb, (double[]){0, 0, 0});
    bend(model, &limb, 0, bone, skin);
    int32_t split = model->mesh.element_count;
    int32_t first = add_brick(model, &cuff, (double[]){0, 0, 0});
    bend(model, &cuff, first, skin + gap, skin + gap + wall);
    fix_nodes(model, brick_side(&limb, 1, 0), LAR_AXIS_ALL);
    fix_planes(model, &limb, 0);
    fix_planes(model, &cuff, first);
    press_outside(model, split, 500, add_ramp(model, 0.2));
    touch_between(model, split);
    model->contact[0].friction = friction;
    model->damping = 50;
    lar_simulation *s = start(model);
    advance(s, (uint64_t)(1.2 / lar_simulation_time_step(s)));
    lar_energy e;
    lar_simulation_energy(s, &e);
    print_message("cuff of %d elements, friction %g: kinetic %.2g of %.2g J, contact %.2g J\n",
                  around, friction, e.kinetic, e.strain, e.contact);
    assert_below(0, e.contact);
    assert_below(trembling(s, 0, (double[]){0, 0, 0}), (friction > 0 ? 1e-6 : 1e-2) * e.strain);
    finish(s, model);
}

static void cuffs_stay_around_limbs(void **unused) {
    (void)unused;
    static const int around[] = {6, 9};
    for (int i = 0; i < 2; i++)
        for (int rubs = 0; rubs < 2; rubs++) put_a_cuff_around_a_limb(around[i], 0.3 * rubs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_body_comes_to_rest_on_another),
        cmocka_unit_test(a_body_comes_to_rest_amid_another),
        cmocka_unit_test(a_body_beside_the_middle_slides_and_does_not_tremble),
        cmocka_unit_test(bodies_rest_face_on_face),
        cmocka_unit_test(bodies_come_to_rest_around_a_tool),
        cmocka_unit_test(cuffs_stay_around_limbs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
