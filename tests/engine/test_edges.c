/* Bars that meet with their sharp edges stay outside each other. */
#include "engine/body_contact_test.h"
#include "engine/tool_contact_test.h"
#include "mechanics/face_contact.h"

/* How two bars meet. */
typedef struct crossing {
    brick bar;
    double along[2]; /* where on each bar they cross, from its middle [m] */
    double angle;    /* between the bars, as a part of a right one */
    double speed;    /* [m/s] */
    bool pushed; /* the upper one's upper edge goes down at this speed; otherwise it is thrown */
    double way;  /* of what is pushed [m] */
    double part; /* of the stable step */
} crossing;

/* Turns a bar around its axis until an edge is up, then about the vertical, its middle at `at`. */
static void lay(lar_model *model, int32_t first, int32_t end, const brick *b, double turn,
                double shift, double height) {
    double half = sqrt(0.5);
    for (int32_t n = first; n < end; n++) {
        double *x = model->mesh.position[n], c[3];
        for (int i = 0; i < 3; i++) c[i] = x[i] - 0.5 * b->edge * b->cells[i];
        double along = c[0] + shift, side = half * (c[1] - c[2]), up = half * (c[1] + c[2]);
        x[0] = cos(turn) * along - sin(turn) * side;
        x[1] = sin(turn) * along + cos(turn) * side;
        x[2] = height + up;
    }
}

static lar_node_list edge_nodes(const brick *b, int32_t first, int at) {
    lar_node_list list = {0, lar_calloc((size_t)(b->cells[0] + 1), sizeof(int32_t))};
    for (int i = 0; i <= b->cells[0]; i++)
        list.node[list.count++] = first + brick_node(b, i, at * b->cells[1], at * b->cells[2]);
    return list;
}

static const double PI = 3.14159265358979323846;

static lar_model *crossing_model(const crossing *c, int32_t *first) {
    const brick *b = &c->bar;
    double gap = 0.004, tall = sqrt(2) * b->edge * b->cells[1];
    lar_model *model = empty_model(b);
    add_brick(model, b, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    *first = add_brick(model, b, (double[]){0, 0, 0});
    lay(model, 0, *first, b, 0, -c->along[0], 0);
    lay(model, *first, model->mesh.node_count, b, 0.5 * PI * c->angle, -c->along[1], tall + gap);
    fix_nodes(model, edge_nodes(b, 0, 0), LAR_AXIS_ALL);
    touch_between(model, split);
    if (c->pushed) {
        double until = c->way / c->speed;
        const double points[3][2] = {{0, 0}, {until, 1}, {2 * until, 1}};
        lar_node_list top = edge_nodes(b, *first, 1);
        move_nodes(model, top, LAR_AXIS_Z, -c->way, add_table(model, LAR_CURVE_LINEAR, 3, points));
        fix_nodes(model, edge_nodes(b, *first, 1), LAR_AXIS_X | LAR_AXIS_Y);
        model->damping = 10;
    } else {
        throw_nodes(model, *first, model->mesh.node_count, (double[]){0, 0, -c->speed});
    }
    return model;
}

/* ---- how much of them overlaps ----------------------------------------------------------------
 */

static double solid_angle(const double x[3], const double *const corner[3]) {
    double r[3][3], length[3], dot[3], volume = 0;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) r[k][i] = corner[k][i] - x[i];
        length[k] = sqrt(r[k][0] * r[k][0] + r[k][1] * r[k][1] + r[k][2] * r[k][2]);
    }
    for (int k = 0; k < 3; k++) {
        const double *a = r[(k + 1) % 3], *b = r[(k + 2) % 3];
        dot[k] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        volume += r[0][i] * (r[1][j] * r[2][k] - r[1][k] * r[2][j]);
    }
    return 2 * atan2(volume, length[0] * length[1] * length[2] + dot[0] * length[0] +
                                 dot[1] * length[1] + dot[2] * length[2]);
}

typedef struct shells {
    int32_t count[2], *face[2];
    double (*place)[3];
} shells;

static bool inside(const double x[3], const shells *s, const lar_mesh *mesh, int which) {
    static const double even[4] = {0.25, 0.25, 0.25, 0.25};
    double angle = 0;
    for (int32_t f = 0; f < s->count[which]; f++) {
        int32_t face = s->face[which][f];
        double corner[4][3], middle[3];
        for (int a = 0; a < 4; a++)
            memcpy(corner[a], s->place[mesh->element[face / 6][lar_face_node[face % 6][a]]], 24);
        lar_face_mean((const double(*)[3])corner, even, middle);
        for (int a = 0; a < 4; a++)
            angle +=
                solid_angle(x, (const double *const[]){corner[a], corner[(a + 1) % 4], middle});
    }
    return angle > 2 * PI;
}

/* The volume in both, by points half a millimetre apart around where the bars cross [m3]. */
static double overlap(const lar_simulation *s, shells *both, int32_t first, double reach) {
    static const double STEP = 5e-4;
    const lar_mesh *mesh = &s->domain.model->mesh;
    double low = INFINITY, high = -INFINITY, sum = 0;
    lar_simulation_displacements(s, both->place);
    for (int32_t n = 0; n < mesh->node_count; n++) {
        double *x = both->place[n];
        for (int i = 0; i < 3; i++) x[i] += mesh->position[n][i];
        if (fabs(x[0]) > 2 * reach || fabs(x[1]) > 2 * reach) continue;
        if (n < first) high = fmax(high, x[2]);
        if (n >= first) low = fmin(low, x[2]);
    }
    for (double z = low; z < high; z += STEP)
        for (double y = -reach; y < reach; y += STEP)
            for (double x = -reach; x < reach; x += STEP)
                if (inside((double[]){x, y, z}, both, mesh, 0) &&
                    inside((double[]){x, y, z}, both, mesh, 1))
                    sum += STEP * STEP * STEP;
    return sum;
}

/* ---- the tests --------------------------------------------------------------------------------
 */

typedef struct met {
    double overlap; /* the most, as a part of a bar's volume */
    double fastest; /* of all nodes, as a part of the speed */
    double gained;  /* energy, as a part of what it was, only of what is thrown */
    double apart;   /* how far the upper bar is above the lower one at the end [m] */
    char why[sizeof(((lar_error *)0)->message)];
} met;

static met meet(const crossing *c) {
    int32_t first;
    lar_model *model = crossing_model(c, &first);
    lar_options options = lar_options_default();
    options.time_step = c->part * stable_step_of(model);
    lar_simulation *s = start_with(model, options);
    const lar_mesh *mesh = &model->mesh;
    int32_t split = mesh->element_count / 2;
    shells both = {.place = lar_calloc((size_t)mesh->node_count, 24)};
    both.face[0] = outer_faces(model, 0, split, &both.count[0]);
    both.face[1] = outer_faces(model, split, mesh->element_count, &both.count[1]);
    double seconds = c->pushed ? 1.2 * c->way / c->speed : 0.004 / c->speed + 0.06;
    double volume = pow(c->bar.edge, 3) * split, start = 0;
    uint64_t steps = (uint64_t)(seconds / options.time_step), stride = steps / 12;
    met out = {0};
    lar_energy e;
    for (uint64_t i = 0; i < steps; i++) {
        lar_error error = {0};
        if (lar_simulation_advance(s, 1, &error)) {
            snprintf(out.why, sizeof out.why, "%s", error.message);
            break;
        }
        for (int32_t n = 0; n < mesh->node_count; n++) {
            const double *v = node_v(s, n);
            out.fastest =
                fmax(out.fastest, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / c->speed);
        }
        lar_simulation_energy(s, &e);
        if (i == 0) start = e.kinetic;
        out.gained = fmax(out.gained, (e.kinetic + e.strain + e.hourglass) / start - 1);
        if (i % stride == 0)
            out.overlap = fmax(out.overlap, overlap(s, &both, first, c->bar.edge) / volume);
    }
    double low = INFINITY, high = -INFINITY;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        double z = mesh->position[n][2] + node_u(s, n)[2];
        if (n < first) high = fmax(high, z);
        if (n >= first) low = fmin(low, z);
    }
    out.apart = low - high;
    free(both.place);
    free(both.face[0]);
    free(both.face[1]);
    finish(s, model);
    return out;
}

static void print_met(const crossing *c, const met *m) {
    print_message("%d x %d x %d bars, %4.1f and %4.1f mm, %.2f of a right angle, %s at %.2f m/s: "
                  "overlap %.4f %%, fastest %.3f, energy %+.1e, apart %.2f mm %s\n",
                  c->bar.cells[0], c->bar.cells[1], c->bar.cells[2], 1e3 * c->along[0],
                  1e3 * c->along[1], c->angle, c->pushed ? "pushed" : "thrown", c->speed,
                  100 * m->overlap, m->fastest, c->pushed ? 0 : m->gained, 1e3 * m->apart, m->why);
}

static const brick thin = {{6, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 2e4, 4e5, 1000},
                   thick = {{6, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e4, 4e5, 1000};

/* Node on node, middle of an edge on the middle of another, a node exactly on an edge, and neither,
 * askew. */
static const double along[][2] = {{0, 0}, {0.005, 0.005}, {0, 0.005}, {0.0025, 0.0013}};

static crossing crossing_of(const brick *bar, int which, double speed) {
    return (crossing){.bar = *bar,
                      .along = {along[which][0], along[which][1]},
                      .angle = which == 3 ? 0.7 : 1,
                      .speed = speed,
                      .way = bar->cells[1] == 1 ? 0.008 : 0.01,
                      .part = 0.8};
}

/* What is stopped in its middle swings with its ends, the faster the thinner it is: no faster, and
 * with no more energy, than without contact's help. */
static void bars_that_are_thrown_stay_outside(void **unused) {
    (void)unused;
    static const double speeds[] = {0.1, 0.5};
    for (int k = 0; k < 16; k++) {
        crossing c = crossing_of(k / 8 ? &thick : &thin, k % 4, speeds[k / 4 % 2]);
        met m = meet(&c);
        print_met(&c, &m);
        if (m.why[0]) fail_msg("%s", m.why);
        assert_below(m.overlap, 1e-3);
        assert_below(m.gained, 1e-3);
        assert_below(m.fastest, 2.6);
    }
}

/* Pressed by 4 mm and 6 mm, until they slip off each other or the way is done; a bar of one element
 * gives way with springs and tissue in series. */
static void bars_that_are_pushed_stay_outside(void **unused) {
    (void)unused;
    static const double speeds[] = {0.1, 0.5};
    for (int k = 0; k < 12; k++) {
        crossing c = crossing_of(k / 6 ? &thick : &thin, k % 3, speeds[k / 3 % 2]);
        c.pushed = true;
        met m = meet(&c);
        print_met(&c, &m);
        if (m.why[0]) fail_msg("%s", m.why);
        assert_below(m.overlap, k / 6 ? 1e-3 : 4e-3);
    }
}

/* ---- laid on each other ------------------------------------------------------------------------
 */

/* Two bars that are one element wide, the upper one over the lower, so that edges lie over edges:
 * all their nodes go down exactly along the other's sides. */
static lar_model *pile(const brick *b, double gap, const double shift[2]) {
    lar_model *model = empty_model(b);
    add_brick(model, b, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    add_brick(model, b, (double[]){shift[0], shift[1], b->edge * b->cells[2] + gap});
    lar_node_list ground = {0, lar_calloc((size_t)model->mesh.node_count, sizeof(int32_t))};
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        if (model->mesh.position[n][2] == 0) ground.node[ground.count++] = n;
    fix_nodes(model, ground, LAR_AXIS_ALL);
    touch_between(model, split);
    model->gravity[2] = -9.81;
    model->damping = 20;
    return model;
}

/* How far the middle of the upper bar has gone down. */
static double sunk(const lar_simulation *s, int32_t first) {
    const int32_t end = s->domain.model->mesh.node_count;
    double sum = 0;
    for (int32_t n = first; n < end; n++) sum -= node_u(s, n)[2];
    return sum / (end - first);
}

static void bars_that_lie_edge_on_edge_hold_each_other(void **unused) {
    (void)unused;
    static const brick cube = {{1, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 4e4, 1050};
    static const brick bar = {{3, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 4e4, 1050};
    static const struct {
        const brick *b;
        double gap, shift[2];
    } piles[] = {{&cube, 0, {0, 0}},       {&cube, 1e-4, {0, 0}}, {&cube, 2e-4, {1e-4, 0}},
                 {&cube, 1e-4, {5e-4, 0}}, {&bar, 1e-4, {0, 0}},  {&bar, 0, {0.005, 0}},
                 {&cube, 0.02, {0, 0}}};
    for (size_t i = 0; i < sizeof piles / sizeof *piles; i++) {
        const brick *b = piles[i].b;
        lar_model *model = pile(b, piles[i].gap, piles[i].shift);
        const int32_t first = model->mesh.node_count / 2;
        uint64_t hash[2];
        double went[2];
        for (int g = 0; g < 2; g++) {
            lar_options options = lar_options_default();
            options.grid = g ? "2x1x1" : NULL;
            lar_simulation *s = start_with(model, options);
            advance(s, (int64_t)(0.3 / lar_simulation_time_step(s)));
            hash[g] = lar_simulation_hash(s);
            went[g] = sunk(s, first);
            lar_simulation_destroy(s);
        }
        print_message("%d elements, gap %g mm, shifted by %g mm: %.2f mm down\n", b->cells[0],
                      1e3 * piles[i].gap, 1e3 * piles[i].shift[0], 1e3 * went[0]);
        assert_true(hash[0] == hash[1]);
        assert_below(went[0], piles[i].gap + 0.25 * b->edge);
        lar_model_destroy(model);
    }
}

/* Two bodies of an element with a face in common that is twisted, as parts of an organ have: what
 * touches is not in each other, and stays where it is. */
static void twisted_faces_touch(void **state) {
    (void)state;
    const brick b = {{1, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1000};
    for (int sign = -1; sign <= 1; sign += 2) {
        lar_model *model = empty_model(&b);
        add_brick(model, &b, (double[]){0, 0, 0});
        int32_t split = model->mesh.element_count;
        int32_t second = add_brick(model, &b, (double[]){0, 0, b.edge});
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++) {
                double lift = sign * (i == j ? 0.2 : -0.2) * b.edge;
                model->mesh.position[brick_node(&b, i, j, 1)][2] += lift;
                model->mesh.position[second + brick_node(&b, i, j, 0)][2] += lift;
            }
        touch_between(model, split);
        lar_simulation *s = start(model);
        advance(s, 100);
        for (int32_t n = 0; n < model->mesh.node_count; n++)
            for (int i = 0; i < 3; i++) assert_below(fabs(node_u(s, n)[i]), 1e-12);
        lar_simulation_destroy(s);
        lar_model_destroy(model);
    }
}

/* A tongue that is narrower than what lies between the points of a block's edge, and held in all
 * its nodes, as the block is: it goes round the lower edge of the block's front, `deep` in the
 * block, out through the bottom and in past the front, or the other way. */
static lar_model *tongue_model(bool back, double turn) {
    enum { TURNS = 13, BLOCK = 8, TONGUE = 36 };
    static const double way = 0.0012, deep = 1e-3; /* [m] */
    const brick block = {{1, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1000};
    const brick tongue = {{8, 1, 1}, 0.002, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1000};
    lar_model *model = empty_model(&block);
    add_brick(model, &block, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    add_brick(model, &tongue, (double[]){-0.005, 0.004, -tongue.edge});
    for (int what = 0; what < 4; what++) {
        lar_node_list nodes = {0, lar_calloc(TONGUE, sizeof(int32_t))};
        for (int32_t n = what ? BLOCK : 0; n < (what ? BLOCK + TONGUE : BLOCK); n++)
            nodes.node[nodes.count++] = n;
        double point[TURNS][2] = {{0}};
        for (int k = 1; k < TURNS; k++) {
            bool early = k % 4 == 1 || k % 4 == 2, late = k % 4 >= 2;
            point[k][0] = k * turn;
            point[k][1] = (what == 2) != back ? early : late;
        }
        if (what < 2)
            fix_nodes(model, nodes, what ? LAR_AXIS_Y : LAR_AXIS_ALL);
        else
            move_nodes(model, nodes, what == 2 ? LAR_AXIS_Z : LAR_AXIS_X, what == 2 ? deep : -way,
                       add_table(model, LAR_CURVE_SMOOTH, TURNS, (const double(*)[2])point));
    }
    touch_between(model, split);
    return model;
}

/* What springs up on the way round gives nothing that nobody has put in. */
static void round_an_edge_nothing_is_given(void **state) {
    (void)state;
    static const double turn = 0.02; /* [s] */
    for (int back = 0; back < 2; back++) {
        lar_model *model = tongue_model(back, turn);
        lar_simulation *s = start(model);
        lar_energy energy = {0};
        double most = 0, least = 0;
        for (int k = 4; k <= 12; k += 4) {
            double before = energy.contact;
            while (lar_simulation_time(s) < k * turn) {
                advance(s, 1);
                lar_simulation_energy(s, &energy);
                most = fmax(most, energy.contact);
                least = fmin(least, energy.contact);
            }
            print_message("%s, round %d: contact has taken %.3e J of %.3e J\n",
                          back ? "back" : "forth", k / 4, energy.contact - before, most);
            assert_true(energy.contact - before > 0);
            assert_below(energy.contact - before, 0.1 * most); /* its damper */
        }
        assert_true(least > -1e-3 * most);
        finish(s, model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bars_that_are_thrown_stay_outside),
        cmocka_unit_test(bars_that_are_pushed_stay_outside),
        cmocka_unit_test(bars_that_lie_edge_on_edge_hold_each_other),
        cmocka_unit_test(twisted_faces_touch),
        cmocka_unit_test(round_an_edge_nothing_is_given),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
