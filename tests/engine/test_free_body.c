/* Rigid bodies that nothing leads: they fly, spin, swing and lie as mechanics says, their account
 * closes, and the bits are the same everywhere. */
#include "engine/engine_test.h"

#include "engine/body_contact_test.h"
#include "engine/tools_test.h"
#include "base/quaternion.h"
#include "step/rigid/free_body.h"

static const brick stone = {{2, 3, 5}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
enum { STONE_NODES = 3 * 4 * 6 };

static lar_model *stone_model(void) {
    lar_model *model = empty_model(&stone);
    add_brick(model, &stone, (double[]){0, 0, 0});
    bind_nodes(model, 0, model->mesh.node_count);
    return model;
}

static double sum_of(const lar_energy *e) {
    return e->kinetic + e->strain + e->hourglass + e->damping + e->contact + e->viscous;
}

/* Kinetic energy; the account is what was there at the start as long as it closes. */
static double energy_of(const lar_simulation *simulation, double *account) {
    lar_energy e;
    lar_simulation_energy(simulation, &e);
    *account = sum_of(&e) - e.external;
    return e.kinetic;
}

/* Thrown, it flies as its nodes would fly alone: x0 + v0 t + g t^2 / 2, to the last digits. */
static void it_flies(void **unused) {
    (void)unused;
    lar_model *model = stone_model();
    const double v[3] = {0.3, -0.2, 0.5};
    throw_nodes(model, 0, STONE_NODES, v);
    model->gravity[2] = -9.81;
    lar_simulation *simulation = start(model);
    double first, account;
    const double began = energy_of(simulation, &first);
    advance(simulation, 2000);
    const double t = lar_simulation_time(simulation);
    for (int32_t n = 0; n < STONE_NODES; n += 7)
        for (int i = 0; i < 3; i++) {
            const double want = v[i] * t - (i == 2 ? 0.5 * 9.81 * t * t : 0);
            assert_below(fabs(node_u(simulation, n)[i] - want), 1e-9 * t);
        }
    assert_true(energy_of(simulation, &account) > 2 * began);
    assert_below(fabs(account - first), 1e-9 * began);
    finish(simulation, model);
}

static const double centre_of_stone[3] = {0.01, 0.015, 0.025};

/* About the centre of the model, w x r. */
static void spin_nodes(lar_model *model, const double w[3]) {
    for (int32_t n = 0; n < STONE_NODES; n++) {
        double r[3], v[3];
        lar_minus(model->mesh.position[n], centre_of_stone, r);
        lar_cross(w, r, v);
        throw_nodes(model, n, n + 1, v);
    }
}

/* Angular momentum of the stone about its centre of mass, by the nodes' ways in the last step;
 * beside it there may be a block. */
static void spin_of(const lar_simulation *simulation, double spin[3]) {
    const lar_domain *domain = &simulation->domain;
    double v[STONE_NODES + 27][3], u[STONE_NODES + 27][3], x[3], c[3] = {0}, turn[3], mass = 0;
    lar_simulation_velocities(simulation, v);
    lar_simulation_displacements(simulation, u);
    memset(spin, 0, 3 * sizeof *spin);
    for (int pass = 0; pass < 2; pass++)
        for (int32_t n = 0; n < STONE_NODES; n++) {
            const double m = domain->mass[domain->layout.local[n]];
            for (int i = 0; i < 3; i++) x[i] = domain->model->mesh.position[n][i] + u[n][i];
            mass += pass == 0 ? m : 0;
            for (int i = 0; i < 3 && pass == 0; i++) c[i] += m * x[i];
            for (int i = 0; i < 3 && pass == 1; i++) x[i] -= c[i] / mass;
            lar_cross(x, v[n], turn);
            for (int i = 0; i < 3 && pass == 1; i++) spin[i] += m * turn[i];
        }
}

/* About the axis of the middle inertia a spin turns over, again and again (Euler); angular momentum
 * and energy stay all the while. The start is half a step before and after; the middle is measured
 * against the first step. */
static void it_spins_as_euler_says(void **unused) {
    (void)unused;
    lar_model *model = stone_model();
    spin_nodes(model, (double[]){0.02, 20, 0.02});
    lar_simulation *simulation = start(model);
    double before[3], now[3], account;
    advance(simulation, 1);
    spin_of(simulation, before);
    const double began = energy_of(simulation, &account);
    bool over = false;
    for (int k = 0; k < 300; k++) {
        advance(simulation, 10);
        spin_of(simulation, now);
        for (int i = 0; i < 3; i++)
            assert_below(fabs(now[i] - before[i]), 1e-9 * lar_length(before));
        assert_below(fabs(energy_of(simulation, &account) / began - 1), 2e-3);
        lar_tool_pose pose;
        assert_int_equal(lar_simulation_tool_pose(simulation, 0, &pose, NULL), LAR_OK);
        const double *q = pose.orientation; /* the own y axis, along y: -1 turned over */
        over = over || 1 - 2 * (q[1] * q[1] + q[3] * q[3]) < -0.9;
    }
    assert_true(over);
    finish(simulation, model);
}

/* Beside a block that is crushed, for which steps are divided. */
static void it_spins_on_in_divided_steps(void **unused) {
    (void)unused;
    static const brick block = {{2, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = stone_model();
    add_brick(model, &block, (double[]){0.2, 0, 0});
    lar_node_list floor = {0, lar_calloc(9, sizeof(int32_t))}, lid = floor;
    lid.node = lar_calloc(9, sizeof(int32_t));
    for (int32_t n = STONE_NODES; n < model->mesh.node_count; n++) {
        if (model->mesh.position[n][2] < 0.001) floor.node[floor.count++] = n;
        if (model->mesh.position[n][2] > 0.019) lid.node[lid.count++] = n;
    }
    fix_nodes(model, floor, LAR_AXIS_ALL);
    move_nodes(model, lid, LAR_AXIS_Z, -0.016, add_ramp(model, 0.02));
    spin_nodes(model, (double[]){0, 0, 300});
    lar_simulation *simulation = start(model);
    double before[3], now[3];
    int32_t most = 1;
    advance(simulation, 1);
    spin_of(simulation, before);
    while (lar_simulation_time(simulation) < 0.03) {
        advance(simulation, 1);
        const int32_t parts = lar_simulation_step_parts(simulation);
        most = parts > most ? parts : most;
        if (parts > 1) continue; /* the last part has another chord */
        spin_of(simulation, now);
        for (int i = 0; i < 3; i++)
            assert_below(fabs(now[i] - before[i]), 1e-6 * lar_length(before));
    }
    print_message("steps in up to %d parts, spin %.9g of %.9g\n", (int)most, now[2], before[2]);
    assert_true(most > 1);
    finish(simulation, model);
}

/* However fast: three radians in a step, or a twentieth. */
static void it_spins_fast(void **unused) {
    (void)unused;
    double kinetic[2], account;
    for (int fast = 0; fast < 2; fast++) {
        lar_model *model = stone_model();
        lar_simulation *simulation = start(model);
        const double turn = fast ? 3 : 0.05, dt = lar_simulation_time_step(simulation);
        lar_simulation_destroy(simulation);
        spin_nodes(model, (double[]){0, 0, turn / dt});
        simulation = start(model);
        const double began = energy_of(simulation, &account); /* nobody has divided a step yet */
        advance(simulation, 200);
        const double ends = energy_of(simulation, &account);
        assert_below(fabs(began / ends - 1), 0.01);
        kinetic[fast] = ends / (turn * turn);
        assert_int_equal(lar_simulation_step_parts(simulation) > 1, fast);
        finish(simulation, model);
    }
    print_message("%.6g and %.6g J of a radian in a step\n", kinetic[0], kinetic[1]);
    assert_below(fabs(kinetic[1] / kinetic[0] - 1), 0.02);
}

/* I v + v x (I v) / 2 = (1 + v.v / 4) dt L, also for large turns; about an axis the same along it;
 * what lies in a line does not turn. */
static void turns_solve_their_equation(void **unused) {
    (void)unused;
    lar_rigid_sum sum = {.mass = 1, .spin = {0.7, -0.4, 0.9}, .inertia = {2, 3, 4, 0.3, -0.2, 0.5}};
    const double I[3][3] = {{2, 0.3, 0.5}, {0.3, 3, -0.2}, {0.5, -0.2, 4}}, any[3] = {0};
    double v[3], carried[3], across[3];
    for (double dt = 1e-3; dt < 2; dt *= 10) {
        lar_free_body_turn(&sum, any, dt, v);
        for (int i = 0; i < 3; i++) carried[i] = lar_dot(I[i], v);
        lar_cross(v, carried, across);
        const double far = lar_dot(v, v);
        for (int i = 0; i < 3; i++)
            assert_below(fabs(carried[i] + 0.5 * across[i] - (1 + far / 4) * dt * sum.spin[i]),
                         1e-6 * dt * far + 1e-15);
    }
    const double axis[3] = {0.6, 0, 0.8};
    lar_free_body_turn(&sum, axis, 0.01, v);
    for (int i = 0; i < 3; i++) carried[i] = lar_dot(I[i], v);
    assert_below(fabs(v[1]) + fabs(v[0] / 0.6 - v[2] / 0.8), 1e-15);
    assert_below(fabs(lar_dot(axis, carried) - (1 + lar_dot(v, v) / 4) * 0.01 * 1.14), 1e-12);
    const lar_rigid_sum line = {.mass = 1, .spin = {0, 1, 0}, .inertia = {0, 1, 1}};
    lar_free_body_turn(&line, any, 0.01, v);
    assert_true(v[0] == 0 && v[1] == 0 && v[2] == 0);
    lar_free_body_turn(&line, (double[]){1, 0, 0}, 0.01, v);
    assert_true(v[0] == 0 && v[1] == 0 && v[2] == 0);
}

/* The arithmetic-geometric mean has the period of a large swing. */
static double period_of(double angle, double small) {
    double a = 1, b = cos(angle / 2);
    for (int i = 0; i < 8; i++) {
        const double mean = (a + b) / 2;
        b = sqrt(a * b);
        a = mean;
    }
    return small / a;
}

/* A bar that is let go from the horizontal, on an axis at its end, is back after one period, and so
 * it is on a point. */
static void it_swings_on_a_hinge(void **unused) {
    (void)unused;
    static const brick rod = {{10, 2, 2}, 0.03, 0, LAR_LAW_neo_hookean, 2e5, 2e6, 1000};
    for (int hinge = 0; hinge < 2; hinge++) {
        lar_model *model = empty_model(&rod);
        add_brick(model, &rod, (double[]){0, -0.03, -0.03});
        lar_tool *tool = bind_nodes(model, 0, model->mesh.node_count);
        tool->free = LAR_FREE_TURNS;
        if (hinge) tool->axis[1] = 1;
        model->gravity[2] = -9.81;
        lar_simulation *simulation = start(model);
        const lar_domain *domain = &simulation->domain;
        double inertia = 0, moment = 0, account;
        for (int32_t n = 0; n < model->mesh.node_count; n++) {
            const double *x = model->mesh.position[n], m = domain->mass[domain->layout.local[n]];
            inertia += m * (x[0] * x[0] + x[2] * x[2]);
            moment += m * x[0] * 9.81;
        }
        const double period = period_of(LAR_PI / 2, 2 * LAR_PI * sqrt(inertia / moment));
        const int32_t end = brick_node(&rod, 10, 1, 1);
        double highest = -1, back = 0;
        while (lar_simulation_time(simulation) < 1.2 * period) {
            advance(simulation, 1);
            const double t = lar_simulation_time(simulation), z = node_u(simulation, end)[2];
            if (t > 0.7 * period && z > highest) highest = z, back = t;
        }
        assert_below(fabs(back / period - 1), 5e-4);
        assert_below(fabs(highest), 1e-6);
        assert_below(fabs(node_u(simulation, end)[1]), 1e-12);
        energy_of(simulation, &account);
        assert_below(fabs(account), 1e-5 * moment * 0.15);
        finish(simulation, model);
    }
}

static const brick cushion = {{8, 8, 3}, 0.01, 0, LAR_LAW_coupled_neo_hookean, 1e4, 1e4, 200},
                   block = {{3, 3, 3}, 0.01, 0, LAR_LAW_coupled_neo_hookean, 1e4, 1e4, 200};

/* A heavy block above a cushion on the ground. */
static lar_model *cushion_model(double gap) {
    lar_model *model = two_bricks(&cushion, &block, gap, true);
    bind_nodes(model, 9 * 9 * 4, model->mesh.node_count);
    lar_material *heavy = LAR_MODEL_APPEND(model, material);
    *heavy = model->material[0];
    heavy->density = 4000;
    for (int32_t e = 8 * 8 * 3; e < model->mesh.element_count; e++) model->element_material[e] = 1;
    model->gravity[2] = -9.81;
    return model;
}

/* It comes to rest where the cushion bears its weight, and nothing turns it. */
static void it_lies_on_what_bears_it(void **unused) {
    (void)unused;
    lar_model *model = cushion_model(0);
    model->damping = 60;
    model->contact[0].friction = 0.5; /* or it slides off */
    lar_simulation *simulation = start(model);
    lar_tool_force felt;
    while (lar_simulation_time(simulation) < 2.5) advance(simulation, 100);
    assert_int_equal(lar_simulation_tool_force(simulation, 0, &felt, NULL), LAR_OK);
    assert_below(fabs(felt.force[2] / (4000 * 27e-6 * 9.81) - 1), 1e-5);
    assert_true(node_u(simulation, 9 * 9 * 4)[2] < -3e-4);
    finish(simulation, model);
}

/* A stone above a slot between two walls that nothing moves, with so much room on both sides. How
 * far up it is after 0.15 s [m]. */
static double fall_in(double room, double distance) {
    const brick wall = {{4, 4, 4}, 0.005, 0, LAR_LAW_neo_hookean, 2e4, 2e5, 1000};
    const brick peg = {{2, 4, 4}, 0.005, 0, LAR_LAW_neo_hookean, 2e4, 2e5, 1000};
    lar_model *model = empty_model(&wall);
    add_brick(model, &wall, (double[]){-0.025 - room, -0.01, -0.02});
    add_brick(model, &wall, (double[]){0.005 + room, -0.01, -0.02});
    const int32_t walls = model->mesh.element_count;
    const int32_t first = add_brick(model, &peg, (double[]){-0.005, -0.01, 0.002});
    lar_node_list held = {first, lar_calloc((size_t)first, sizeof *held.node)};
    for (int32_t n = 0; n < first; n++) held.node[n] = n;
    fix_nodes(model, held, LAR_AXIS_ALL);
    bind_nodes(model, first, model->mesh.node_count);
    lar_contact *contact = LAR_MODEL_APPEND(model, contact);
    contact->kind = LAR_CONTACT_BETWEEN;
    contact->distance = distance;
    contact->face = outer_faces(model, 0, walls, &contact->face_count);
    contact->against =
        outer_faces(model, walls, model->mesh.element_count, &contact->against_count);
    model->gravity[2] = -9.81;
    model->damping = 2;
    lar_simulation *simulation = start(model);
    while (lar_simulation_time(simulation) < 0.15) advance(simulation, 10);
    if (distance > 0) assert_below(lar_simulation_contact_distance(simulation), 1.001 * distance);
    const double way = node_u(simulation, first)[2];
    finish(simulation, model);
    return way;
}

/* Bodies push each other from a distance on, which a clearance may be smaller than: then the
 * contact says which it is to be. */
static void it_falls_through_a_narrow_slot(void **unused) {
    (void)unused;
    const double caught = fall_in(0.0005, 0), falls = fall_in(0.0005, 1e-4);
    print_message("0.5 mm of room: %.2f mm down, with a distance of 0.1 mm %.2f mm\n", 1e3 * caught,
                  1e3 * falls);
    assert_true(caught > -0.002);
    assert_true(falls < -0.05);
}

/* Thrown down it is thrown back; contact and what holds it together give nothing. */
static void it_bounces_and_gains_nothing(void **unused) {
    (void)unused;
    lar_model *model = cushion_model(0.001);
    throw_nodes(model, 9 * 9 * 4, model->mesh.node_count, (double[]){0.1, 0, -0.6});
    lar_simulation *simulation = start(model);
    double first, account, most = 0, highest = -1;
    const double began = energy_of(simulation, &first);
    while (lar_simulation_time(simulation) < 0.12) {
        advance(simulation, 20);
        most = fmax(most, energy_of(simulation, &account));
        assert_below(fabs(account - first), 1e-4 * began);
        highest = fmax(highest, node_u(simulation, 9 * 9 * 4)[2]);
    }
    assert_true(highest > 0);
    assert_below(most / began, 1.2); /* it fell on by what it sank in */
    finish(simulation, model);
}

/* A stone within a body that swings beside a cushion on which a block falls, and what both come to
 * in 100 steps; `looks`: somebody asks for energies all the while. */
static uint64_t hash_with(lar_options options, bool looks, bool saves) {
    lar_model *model = cushion_model(0);
    throw_nodes(model, 9 * 9 * 4, model->mesh.node_count, (double[]){0.2, 0.1, -1});
    lar_node_list core = {5, lar_calloc(5, 4)};
    for (int32_t n = 0; n < 5; n++) core.node[n] = brick_node(&cushion, 1 + n % 2, 1 + n / 2, 2);
    add_tool(model, "core", LAR_TOOL_RIGID, 0.012, 0.012, 0.02);
    model->tool[1].free = LAR_AXIS_ALL | LAR_FREE_TURNS;
    *(lar_move *)LAR_MODEL_APPEND(model, move) =
        (lar_move){.nodes = core, .axes = LAR_AXIS_ALL, .tool = 2};
    lar_simulation *simulation = start_with(model, options);
    for (int k = 0; k < 10; k++) {
        double account;
        advance(simulation, looks ? 7 : 10);
        if (looks) energy_of(simulation, &account);
        if (looks) advance(simulation, 3);
        if (!saves || k != 4) continue;
        const char *path = LAR_TEST_BUILD "/free_body.checkpoint";
        assert_int_equal(lar_simulation_save(simulation, path, NULL), LAR_OK);
        lar_simulation_destroy(simulation);
        simulation = start_with(model, options);
        assert_int_equal(lar_simulation_load(simulation, path, NULL), LAR_OK);
    }
    const uint64_t hash = lar_simulation_hash(simulation);
    finish(simulation, model);
    return hash;
}

/* Who looks, and how often, changes nothing; nor does a grid, nor where a run was saved, nor a set
 * of instructions. */
static void bits_are_the_same_everywhere(void **unused) {
    (void)unused;
    static const char *const grids[] = {"1x1x1", "2x1x1", "1x3x1", "2x2x3"};
    static const lar_isa sets[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    const uint64_t golden = 0xa3c437994b8b11fd;
    const lar_kernels *kernels;
    lar_options options = lar_options_default();
    assert_true(hash_with(options, true, false) == hash_with(options, false, true));
    for (int i = 0; i < 4; i++) {
        if (lar_kernels_find(sets[i], &kernels, NULL)) continue;
        options.isa = sets[i];
        const uint64_t hash = hash_with(options, false, false);
        if (hash != golden) fail_msg("%s: 0x%016llx", kernels->name, (unsigned long long)hash);
    }
    options = lar_options_default();
    for (int g = 0; g < 4; g++) {
        options.grid = grids[g];
        assert_true(hash_with(options, g == 1, g == 2) == golden);
    }
}

/* Along its axes alone; and what is led goes on as it was led. */
static void it_goes_where_it_may(void **unused) {
    (void)unused;
    lar_model *model = stone_model();
    model->tool[0].free = LAR_AXIS_X;
    memcpy(model->gravity, (double[]){1, 2, 3}, sizeof model->gravity);
    lar_simulation *simulation = start(model);
    advance(simulation, 200);
    const double t = lar_simulation_time(simulation);
    for (int32_t n = 0; n < STONE_NODES; n += 5) {
        const double *u = node_u(simulation, n);
        assert_below(fabs(u[0] - 0.5 * t * t), 1e-9);
        assert_true(u[1] == 0 && u[2] == 0);
    }
    finish(simulation, model);
    model = stone_model();
    simulation = start(model);
    lar_tool_pose pose = model->tool[0].rest;
    pose.position[1] += 0.01;
    assert_int_equal(lar_simulation_tool_move(simulation, 0, &pose, 100, NULL), LAR_OK);
    advance(simulation, 300);
    assert_below(fabs(node_u(simulation, 0)[1] - 0.03), 1e-12);
    finish(simulation, model);
}

/* ---- planes ---------------------------------------------------------------------------------- */

static void stand_before(lar_model *model, const double through[3], const double normal[3],
                         double friction) {
    lar_contact *plane = LAR_MODEL_APPEND(model, contact);
    *plane = (lar_contact){.kind = LAR_CONTACT_PLANE, .friction = friction};
    plane->face = outer_faces(model, 0, model->mesh.element_count, &plane->face_count);
    memcpy(plane->through, through, sizeof plane->through);
    memcpy(plane->normal, normal, sizeof plane->normal);
    model->tool[0].planes |= 1u << (model->contact_count - 1);
}

/* On a slope whose angle has the tangent `slope`, for half a second: how far it went, and may go.
 */
static void slide_down(double slope, double friction, double *way, double *law) {
    const double down = 9.81 * slope / sqrt(1 + slope * slope), on = 9.81 / sqrt(1 + slope * slope);
    lar_model *model = empty_model(&stone);
    add_brick(model, &stone, (double[]){0, 0, 0});
    for (int32_t n = 0; n < STONE_NODES; n++) { /* the irregular brick lies on a flat side */
        double *x = model->mesh.position[n];
        if (x[0] < 0.005) x[0] = 0;
    }
    bind_nodes(model, 0, STONE_NODES);
    stand_before(model, (double[]){0, 0, 0}, (double[]){1, 0, 0}, friction);
    memcpy(model->gravity, (double[]){-on, 0, -down}, sizeof model->gravity);
    lar_simulation *simulation = start(model);
    while (lar_simulation_time(simulation) < 0.5) advance(simulation, 10);
    const double t = lar_simulation_time(simulation);
    *way = -node_u(simulation, 0)[2];
    *law = 0.5 * fmax(down - friction * on, 0) * t * t;
    assert_below(fabs(node_u(simulation, 0)[0]), 1e-6);
    finish(simulation, model);
}

static void planes_rub_as_coulomb_says(void **unused) {
    (void)unused;
    static const double of[][2] = {{0.1, 0}, {0.29, 0.3}, {0.31, 0.3}, {0.49, 0.5}, {0.6, 0.5}};
    for (int k = 0; k < 5; k++) {
        double way, law;
        slide_down(of[k][0], of[k][1], &way, &law);
        print_message("slope %g, friction %g: %.6f mm, by the law %.6f\n", of[k][0], of[k][1],
                      1e3 * way, 1e3 * law);
        assert_below(fabs(way - law), 1e-3 * law + 2e-5);
    }
}

/* How high the bottom of a stone comes again that falls from 0.1 m, in parts of that, and the most
 * that it has of the energy that it began with. */
static double bounce(double restitution, double *most) {
    static const double height = 0.1, gravity = 9.81;
    const brick even = {{2, 3, 5}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = empty_model(&even);
    add_brick(model, &even, (double[]){0, 0, 0});
    bind_nodes(model, 0, model->mesh.node_count);
    stand_before(model, (double[]){0, 0, -height}, (double[]){0, 0, 1}, 0.3);
    model->contact[0].restitution = restitution;
    model->gravity[2] = -gravity;
    lar_simulation *simulation = start(model);
    double account, highest = 0, mass = 0.02 * 0.03 * 0.05 * 1000;
    *most = 0;
    while (lar_simulation_time(simulation) < 0.4) {
        advance(simulation, 1);
        const double z = node_u(simulation, 0)[2] + height;
        const double energy = energy_of(simulation, &account) + mass * gravity * z;
        *most = fmax(*most, energy / (mass * gravity * height));
        if (lar_simulation_time(simulation) > 0.15) highest = fmax(highest, z);
    }
    finish(simulation, model);
    return highest / height;
}

/* Planes throw back as Newton's restitution says, and give nothing. */
static void planes_throw_back(void **unused) {
    (void)unused;
    for (int k = 0; k <= 4; k++) {
        const double part = 0.25 * k;
        double most, high = bounce(part, &most);
        print_message("restitution %.2f: comes to %.4f of its height, energy %.6f\n", part, high,
                      most);
        assert_below(fabs(high - part * part), 0.02);
        assert_below(most, 1 + 1e-9);
    }
}

/* What is pressed on a plane with many times its weight lies still, whatever that throws back. */
static void what_is_pressed_lies_still(void **unused) {
    (void)unused;
    lar_model *model = stone_model();
    add_tool(model, "press", LAR_TOOL_SPHERE, 0.01, 0.015, 0.0585);
    stand_before(model, (double[]){0, 0, -0.001}, (double[]){0, 0, 1}, 0.3);
    model->contact[0].restitution = 0.9;
    model->gravity[2] = -9.81;
    lar_simulation *simulation = start(model);
    double account;
    place_tool(simulation, 1, 0.01, 0.015, 0.055, 1, 200);
    advance(simulation, 2000);
    lar_tool_force felt;
    assert_int_equal(lar_simulation_tool_force(simulation, 1, &felt, NULL), LAR_OK);
    print_message("pressed with %.3g N, %.3g J\n", felt.force[2], energy_of(simulation, &account));
    assert_true(felt.force[2] > 2 * 0.3);
    assert_below(energy_of(simulation, &account), 1e-12);
    finish(simulation, model);
}

/* Thrown into a corner of three planes, a tilted stone comes to rest there, with all of its weight
 * on them; it is below them by what turns have of the second order, and gains nothing. */
static void three_planes_stop_it(void **unused) {
    (void)unused;
    static const double centre[3] = {0.2, 0.2, 0.3};
    lar_model *model = stone_model();
    for (int32_t n = 0; n < STONE_NODES; n++) {
        double r[3], *x = model->mesh.position[n];
        lar_minus(x, centre_of_stone, r);
        lar_turn((double[]){0.8, 0.6 / sqrt(3), 0.6 / sqrt(3), 0.6 / sqrt(3)}, r, x);
        for (int i = 0; i < 3; i++) x[i] += centre[i];
    }
    memcpy(model->tool[0].rest.position, centre, sizeof centre);
    for (int i = 0; i < 3; i++) {
        double normal[3] = {0};
        normal[i] = 1;
        stand_before(model, (double[]){0, 0, 0}, normal, 0.2);
    }
    throw_nodes(model, 0, STONE_NODES, (double[]){-2, -1, 0.5});
    model->gravity[2] = -9.81;
    lar_simulation *simulation = start(model);
    double first, account, most = INFINITY, lowest = 0;
    energy_of(simulation, &first);
    while (lar_simulation_time(simulation) < 1.5) {
        advance(simulation, 20);
        double height = 0;
        for (int32_t n = 0; n < STONE_NODES; n++)
            for (int i = 0; i < 3; i++) {
                const double x = model->mesh.position[n][i] + node_u(simulation, n)[i];
                lowest = fmin(lowest, x);
                if (i == 2)
                    height +=
                        9.81 * x * simulation->domain.mass[simulation->domain.layout.local[n]];
            }
        const double all = height + energy_of(simulation, &account);
        assert_true(all < most + 1e-5 * height);
        most = fmin(most, all);
    }
    const double left = energy_of(simulation, &account);
    print_message("lowest %.3g m, kinetic energy %.3g J at the end, account off by %.3g J\n",
                  lowest, left, account - first);
    assert_true(lowest > -5e-5);
    assert_below(left, 1e-10);
    finish(simulation, model);
}

/* It is one thing: no node of it is held, or let go. */
static void its_nodes_are_not_held_one_by_one(void **unused) {
    (void)unused;
    lar_model *model = stone_model();
    lar_simulation *simulation = start(model);
    lar_error error;
    for (int held = 0; held < 2; held++) {
        assert_int_equal(lar_simulation_set_support(simulation, 3, LAR_AXIS_ALL, held, &error),
                         LAR_ERROR_ARGUMENT);
        assert_true(strstr(error.message, "free body \"stone\"") != NULL);
    }
    assert_int_equal(lar_model_tool_free(model, 0), LAR_AXIS_ALL | LAR_FREE_TURNS);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_flies),
        cmocka_unit_test(it_spins_as_euler_says),
        cmocka_unit_test(it_spins_on_in_divided_steps),
        cmocka_unit_test(it_spins_fast),
        cmocka_unit_test(turns_solve_their_equation),
        cmocka_unit_test(it_swings_on_a_hinge),
        cmocka_unit_test(it_lies_on_what_bears_it),
        cmocka_unit_test(it_falls_through_a_narrow_slot),
        cmocka_unit_test(it_bounces_and_gains_nothing),
        cmocka_unit_test(bits_are_the_same_everywhere),
        cmocka_unit_test(it_goes_where_it_may),
        cmocka_unit_test(planes_rub_as_coulomb_says),
        cmocka_unit_test(planes_throw_back),
        cmocka_unit_test(what_is_pressed_lies_still),
        cmocka_unit_test(three_planes_stop_it),
        cmocka_unit_test(its_nodes_are_not_held_one_by_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
