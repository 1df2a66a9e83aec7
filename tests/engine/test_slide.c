/* A body that slides over another one keeps its speed: there is no friction. */
#include "engine/body_contact_test.h"
#include "engine/tool_contact_test.h"

/* One slide: a brick that has come to rest on a slab is set going, and runs over some of the slab's
 * elements. */
typedef struct ride {
    double slab_edge, brick_edge, gap; /* [m] */
    double y;                          /* of the brick's side [m] */
    double speed;                      /* [m/s] */
    double way;                        /* [m] */
    double part;                       /* of the stable step */
    bool stiff;                        /* the whole slab is fixed */
} ride;

typedef struct outcome {
    double lost, worst;           /* of the speed: at the end, and at most meanwhile */
    double kinetic, trembling;    /* of the brick's motion at the start, and the rest of it [J] */
    double strain, taken, weight; /* what these have become more [J] */
} outcome;

static const double slab_length = 0.14, slab_width = 0.05, slab_height = 0.02;

/* Mean velocity and height of the nodes from `first` on, and their mass. */
static double mean_motion(const lar_simulation *s, int32_t first, double velocity[3],
                          double *fall) {
    double mass = 0;
    *fall = 0;
    for (int i = 0; i < 3; i++) velocity[i] = 0;
    for (int32_t n = first; n < s->domain.model->mesh.node_count; n++) {
        double m = s->domain.mass[s->domain.layout.local[n]];
        for (int i = 0; i < 3; i++) velocity[i] += m * node_v(s, n)[i];
        *fall += m * node_u(s, n)[2];
        mass += m;
    }
    for (int i = 0; i < 3; i++) velocity[i] /= mass;
    *fall /= mass;
    return mass;
}

static double trembling(const lar_simulation *s, int32_t first, const double velocity[3]) {
    double energy = 0;
    for (int32_t n = 0; n < s->domain.model->mesh.node_count; n++)
        for (int i = 0; i < 3; i++) {
            double v = node_v(s, n)[i] - (n >= first ? velocity[i] : 0);
            energy += 0.5 * s->domain.mass[s->domain.layout.local[n]] * v * v;
        }
    return energy;
}

static lar_model *ride_model(const ride *r, int32_t *first) {
    const brick slab = {{(int)lround(slab_length / r->slab_edge),
                         (int)lround(slab_width / r->slab_edge),
                         (int)lround(slab_height / r->slab_edge)},
                        r->slab_edge,
                        0,
                        LAR_LAW_neo_hookean,
                        2e4,
                        4e5,
                        1000};
    const brick upper = {{3, 3, 2}, r->brick_edge, 0, LAR_LAW_neo_hookean, 2e4, 4e5, 1000};
    lar_model *model = empty_model(&slab);
    add_brick(model, &slab, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    /* The same way to both ends: it sags the same. */
    double x = 0.5 * (slab_length - upper.cells[0] * r->brick_edge - r->way) + 0.0003;
    *first = add_brick(model, &upper, (double[]){x, r->y, slab_height + r->gap});
    for (int k = 0; k <= (r->stiff ? slab.cells[2] : 0); k++)
        fix_nodes(model, brick_side(&slab, 2, k), LAR_AXIS_ALL);
    touch_between(model, split);
    model->gravity[2] = -9.81;
    model->damping = 60;
    return model;
}

/* From now on nothing brakes, and the brick has its speed. */
static void set_going(lar_simulation *s, lar_model *model, int32_t first, double speed) {
    lar_domain *domain = &s->domain;
    double dt = domain->time_step;
    model->damping = 0;
    domain->leapfrog.keep = 1;
    for (int i = 0; i < 3; i++) domain->leapfrog.drift[i] = model->gravity[i] * dt;
    for (int32_t n = 0; n < domain->layout.node_count; n++)
        if (domain->mass[n] > 0) domain->push[n] = dt / (domain->mass[n] * domain->scale);
    for (int32_t n = first; n < model->mesh.node_count; n++) s->state.v[node_at(s, n, 0)] += speed;
    s->state.fastest = speed;
    lar_body_contact_forget(&s->interactions.body_contact);
}

static outcome slide(const ride *r) {
    int32_t first;
    lar_model *model = ride_model(r, &first);
    lar_options options = lar_options_default();
    options.time_step = r->part * stable_step_of(model);
    lar_simulation *s = start_with(model, options);
    double dt = options.time_step, velocity[3], start[3], high, low;
    advance(s, (uint64_t)(0.6 / dt));
    set_going(s, model, first, r->speed);
    lar_energy before, e;
    lar_simulation_energy(s, &before);
    double mass = mean_motion(s, first, start, &high), sum = 0;
    outcome out = {.kinetic = 0.5 * mass * r->speed * r->speed};
    uint64_t steps = (uint64_t)(r->way / r->speed / dt), last = steps / 8;
    for (uint64_t i = 0; i < steps; i++) {
        advance(s, 1);
        mean_motion(s, first, velocity, &low);
        out.worst = fmax(out.worst, fabs(velocity[0] / start[0] - 1));
        if (i >= steps - last) sum += velocity[0] / (double)last;
    }
    lar_simulation_energy(s, &e);
    out.lost = 1 - sum / start[0];
    out.trembling = trembling(s, first, velocity);
    out.strain = e.strain + e.hourglass - before.strain - before.hourglass;
    out.taken = e.contact - before.contact;
    out.weight = mass * 9.81 * (low - high);
    finish(s, model);
    return out;
}

static void print_ride(const ride *r, const outcome *o) {
    double k = o->kinetic;
    print_message(
        "%s slab %4.1f brick %4.1f gap %4.1f y %5.2f mm, %.2f m/s, %.1f: lost %9.2e, most "
        "%8.1e; energy: trembling %8.1e strain %9.1e contact %9.1e weight %9.1e\n",
        r->stiff ? "fixed" : "soft ", 1e3 * r->slab_edge, 1e3 * r->brick_edge, 1e3 * r->gap,
        1e3 * r->y, r->speed, r->part, o->lost, o->worst, o->trembling / k, o->strain / k,
        o->taken / k, o->weight / k);
}

static const double sizes[][2] = {{0.01, 0.008}, {0.005, 0.006}, {0.01, 0.004}};

/* Four rides over the same meshes. */
static ride ride_of(int size, int which, bool stiff) {
    return (ride){.slab_edge = sizes[size][0],
                  .brick_edge = sizes[size][1],
                  .gap = which == 3 ? 0 : 0.006, /* laid on it, or kept at a distance */
                  .y = which == 1 ? 0.0131 : 0.0102,
                  .speed = (double[]){0.18, 0.5, 0.05, 0.18}[which],
                  .way = 0.06,
                  .part = 0.8,
                  .stiff = stiff};
}

/* Of the speed at 0.18 m/s; what goes to and fro while springs are taken up is an energy, and a
 * larger part of a smaller speed. */
static double at_test_speed(const ride *r, double lost) {
    double times = fmin(r->speed / 0.18, 1);
    return fabs(lost) * times * times;
}

static void a_slide_over_what_is_fixed_costs_no_speed(void **unused) {
    (void)unused;
    for (int size = 0; size < 3; size++)
        for (int which = 0; which < 4; which++) {
            ride r = ride_of(size, which, true);
            outcome o = slide(&r);
            print_ride(&r, &o);
            assert_below(at_test_speed(&r, o.lost), 1e-4);
            assert_below(at_test_speed(&r, o.worst), 1e-4);
        }
}

/* A slab that gives way lies lower towards its ends and in the middle of its faces: up and down, to
 * and fro. It also has waves of its own, which a faster body leaves behind. */
static void a_slide_over_what_gives_way_costs_next_to_none(void **unused) {
    (void)unused;
    for (int size = 0; size < 2; size++)
        for (int which = 0; which < 4; which++) {
            ride r = ride_of(size, which, false);
            if (which == 2) continue;
            outcome o = slide(&r);
            print_ride(&r, &o);
            double max = r.speed > 0.2 ? 2e-4 : 1e-4;
            assert_below(fabs(o.lost), max);
            assert_below(0.5 * (o.taken + o.trembling) / o.kinetic, max);
            assert_below(o.worst, 6e-4);
        }
}

/* A soft block, touching from the start, comes to the end of the slab it lies on, or to a second
 * one that stands flush against it. */
typedef struct end {
    double edge, modulus; /* of the block [m], of all [Pa] */
    double speed;         /* [m/s] */
    bool seam;            /* there is a second slab */
} end;

/* The part of its speed that a block has left after so much time as it takes for a way; contact
 * never gives more than it took. */
static double left_after(lar_simulation *s, int32_t first, double way, double speed) {
    double velocity[3], fall;
    while (lar_simulation_time(s) < way / speed) {
        lar_energy energy;
        advance(s, 10);
        lar_simulation_energy(s, &energy);
        assert_true(energy.contact >= 0);
    }
    mean_motion(s, first, velocity, &fall);
    return velocity[0] / speed;
}

static lar_model *end_model(const end *e, int32_t *first) {
    static const double before = 0.012;
    const brick slab = {{5, 6, 2},  1.1 * e->edge,   0,   LAR_LAW_neo_hookean,
                        e->modulus, 10 * e->modulus, 1000};
    const brick block = {{4, 4, 2},  e->edge,         0,   LAR_LAW_neo_hookean,
                         e->modulus, 10 * e->modulus, 1000};
    lar_model *model = empty_model(&slab);
    const double length = 5 * slab.edge;
    for (int k = 0; k <= e->seam; k++) {
        *first = add_brick(model, &slab, (double[]){k * length, 0, 0});
        lar_node_list base = brick_side(&slab, 2, 0);
        for (int32_t n = 0; n < base.count; n++) base.node[n] += *first;
        fix_nodes(model, base, LAR_AXIS_ALL);
    }
    int32_t split = model->mesh.element_count;
    *first = add_brick(model, &block,
                       (double[]){length - before - 4 * e->edge, 1.3 * e->edge, 2 * slab.edge});
    touch_between(model, split);
    throw_nodes(model, *first, model->mesh.node_count, (double[]){e->speed, 0, 0});
    model->gravity[2] = -9.81;
    return model;
}

/* The part of its speed that it has left 18 mm farther on. */
static double go_over(const end *e) {
    static const double way = 0.03;
    int32_t first = 0;
    lar_model *model = end_model(e, &first);
    lar_simulation *s = start(model);
    double left = left_after(s, first, way, e->speed);
    print_message("%s, G %g Pa, elements of %g mm, %g m/s: %.3f of the speed\n",
                  e->seam ? "over a seam" : "off the end", e->modulus, 1e3 * e->edge, e->speed,
                  left);
    finish(s, model);
    return left;
}

/* Its front sinks there, for nothing bears it in the corner; what then lay in the block behind its
 * front was pushed out there, and the block back. */
static void an_end_is_no_wall(void **unused) {
    (void)unused;
    static const end ends[] = {{0.01, 1e4, 0.05, false}, {0.015, 1e4, 0.1, false},
                               {0.015, 2e4, 0.1, true},  {0.015, 2e4, 0.05, true},
                               {0.015, 1e4, 0.05, true}, {0.01, 1e4, 0.1, true},
                               {0.01, 1e4, 0.05, true},  {0.01, 2e4, 0.05, true}};
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
        assert_below(ends[i].seam ? 0.95 : 1, go_over(&ends[i]));
}

/* Whether a joint is closed is seen by what is near of both bodies, whoever computes them. */
static void a_seam_is_one_on_every_grid(void **unused) {
    (void)unused;
    const end e = {0.01, 1e4, 0.1, true};
    static const char *const grids[] = {NULL, "2x1x1", "2x2x1", "1x2x2"};
    uint64_t hash = 0;
    for (int g = 0; g < 4; g++) {
        int32_t first = 0;
        lar_model *model = end_model(&e, &first);
        lar_options options = lar_options_default();
        options.grid = grids[g];
        lar_simulation *s = start_with(model, options);
        while (lar_simulation_time(s) < 0.02 / e.speed) advance(s, 10);
        if (g == 0) hash = lar_simulation_hash(s);
        assert_true(lar_simulation_hash(s) == hash);
        finish(s, model);
    }
}

/* A soft block lies half over the side of a long slab that is fixed, its middle on the slab's edge,
 * and slides along that: a prism along x does not push along x. */
typedef struct side {
    double cell[3]; /* of the slab [m] */
    double overlap; /* of its side, beyond the block's middle [m] */
    double speed;   /* [m/s] */
    double gap;     /* at the start: the contact distance [m] */
} side;

/* Stretches the nodes from `first` on, and moves them. */
static void stretch(lar_model *model, int32_t first, const double by[3], const double to[3]) {
    for (int32_t n = first; n < model->mesh.node_count; n++)
        for (int i = 0; i < 3; i++)
            model->mesh.position[n][i] = to[i] + by[i] * model->mesh.position[n][i];
}

/* The part of its speed that it has left when it has gone 20 mm. */
static double go_along(const side *e) {
    static const double way = 0.02, cell[3] = {0.04 / 3, 0.04 / 3, 0.008};
    const double width = 0.04 + e->overlap, height = 0.02;
    const brick slab = {{(int)lround(0.2 / e->cell[0]), (int)lround(width / e->cell[1]),
                         (int)lround(height / e->cell[2])},
                        1,
                        0,
                        LAR_LAW_neo_hookean,
                        2.07e4,
                        2e5,
                        1000};
    const brick block = {{3, 3, 2}, 1, 0, LAR_LAW_neo_hookean, 2.07e4, 2e5, 1000};
    lar_model *model = empty_model(&slab);
    add_brick(model, &slab, (double[]){0, 0, 0});
    stretch(model, 0, e->cell, (double[]){-0.08, -0.04, 0});
    for (int k = 0; k <= slab.cells[2]; k++)
        fix_nodes(model, brick_side(&slab, 2, k), LAR_AXIS_ALL);
    int32_t split = model->mesh.element_count;
    int32_t first = add_brick(model, &block, (double[]){0, 0, 0});
    stretch(model, first, cell, (double[]){-0.05, -0.02, height + e->gap});
    touch_between(model, split);
    throw_nodes(model, first, model->mesh.node_count, (double[]){e->speed, 0, 0});
    model->gravity[2] = -9.81;
    lar_simulation *s = start(model);
    double left = left_after(s, first, way, e->speed);
    print_message("along a side, %g mm of it beyond the middle, elements of %g mm, %g m/s, %g mm "
                  "above: %.3f of the speed\n",
                  1e3 * e->overlap, 1e3 * e->cell[0], e->speed, 1e3 * e->gap, left);
    finish(s, model);
    return left;
}

/* What of the slab's edge came into the block through its front was pushed out there. */
static void a_side_is_no_wall(void **unused) {
    (void)unused;
    static const struct {
        double cell, overlap, speed, gap;
    } sides[] = {
        {0.025, 0, 0.05, 0},      {0.025, 0, 0.05, 1e-4},      {0.025, 0, 0.05, 3e-4},
        {0.025, 0, 0.05, 5e-4},   {0.025, 0, 0.2, 0},          {0.025, 0, 0.2, 3e-4},
        {0.0125, 0.008, 0.05, 0}, {0.0125, 0.008, 0.05, 1e-4}, {0.0125, 0.008, 0.05, 3e-4}};
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        const side e = {
            {sides[i].cell, 0.008, 0.01}, sides[i].overlap, sides[i].speed, sides[i].gap};
        double left = go_along(&e);
        assert_below(0.95, left);
        assert_below(left, 1.1);
    }
}

/* A rigid plate is pressed on a block and slid on it until its end is over the block; then nothing
 * moves, whatever the steps. (Springs that faded to nothing on either side of an end fed a tremor:
 * more energy came from contact than had been put in.) */
static double plate_at_rest(double slide, double part, double *strain) {
    const brick block = {{4, 4, 4}, 0.005, 0, LAR_LAW_neo_hookean, 4e3, 8.667e3, 1000};
    const brick plate = {{3, 3, 1}, 0.01, 0, LAR_LAW_neo_hookean, 4e3, 8.667e3, 1000};
    static const double down[][2] = {{0, 0}, {0.1, 1}}, aside[][2] = {{0.1, 0}, {0.2, 1}};
    lar_model *model = empty_model(&block);
    add_brick(model, &block, (double[]){0, 0, 0});
    fix_nodes(model, brick_side(&block, 2, 0), LAR_AXIS_ALL);
    const int32_t split = model->mesh.element_count;
    const int32_t first = add_brick(model, &plate, (double[]){-0.005, -0.005, 0.02});
    for (int axis = 0; axis < 3; axis++) {
        lar_node_list all = {model->mesh.node_count - first, NULL};
        all.node = lar_calloc((size_t)all.count, sizeof *all.node);
        for (int32_t n = 0; n < all.count; n++) all.node[n] = first + n;
        const int curve = add_table(model, LAR_CURVE_SMOOTH, 2, axis == 0 ? aside : down);
        const double by[3] = {slide, 0, -0.002};
        move_nodes(model, all, 1u << axis, by[axis], curve);
    }
    touch_between(model, split);
    model->damping = 100;
    lar_options options = lar_options_default();
    options.time_step = part * stable_step_of(model);
    lar_simulation *s = start_with(model, options);
    lar_energy e;
    while (lar_simulation_time(s) < 0.5) advance(s, 10);
    lar_simulation_energy(s, &e);
    *strain = e.strain + e.hourglass;
    finish(s, model);
    return e.kinetic / *strain;
}

static void a_plate_over_an_end_rests(void **unused) {
    (void)unused;
    static const double slides[] = {0.0055, 0.008};
    for (int i = 0; i < 2; i++) {
        double strain[2], left[2];
        for (int k = 0; k < 2; k++) left[k] = plate_at_rest(slides[i], k ? 0.2 : 0.1, &strain[k]);
        print_message("plate slid by %g mm: %.2e and %.2e of the strain energy, which is %.4g and "
                      "%.4g J\n",
                      1e3 * slides[i], left[0], left[1], strain[0], strain[1]);
        assert_below(fmax(left[0], left[1]), 1e-10);
        assert_below(fabs(strain[1] / strain[0] - 1), 0.1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slide_over_what_is_fixed_costs_no_speed),
        cmocka_unit_test(a_slide_over_what_gives_way_costs_next_to_none),
        cmocka_unit_test(an_end_is_no_wall),
        cmocka_unit_test(a_seam_is_one_on_every_grid),
        cmocka_unit_test(a_side_is_no_wall),
        cmocka_unit_test(a_plate_over_an_end_rests),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
