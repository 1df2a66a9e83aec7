/* A body whose concave crease folds shut: nodes that come into its layer without having come
 * through a face are not pushed out with energy from nowhere, and the run goes on to rest. */
#include "engine/body_contact_test.h"
#include "parallel/computer.h"
#include "engine/fleet_test.h"
#include "engine/tool_contact_test.h"

#include "mechanics/face_contact.h"

/* A bar bent to a V with a sharp inner edge, thrown by its weight into the corner of a wall and a
 * ceiling, which shut it. */
static lar_model *folding_bar(double shear, int layers) {
    static const double angle = 1.0471975511965976, half = 0.06;
    brick b = {{12, 3, layers}, 0.01, 0, LAR_LAW_neo_hookean, shear, 100 * shear, 1000};
    lar_model *model = brick_model(&b);
    double max[3] = {-1, -1, -1}, c = cos(angle), s = sin(angle);
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double *x = model->mesh.position[n];
        double along = fabs(x[0] - half), deep = b.edge * layers - x[2];
        /* Upright in the middle, square to the arm from a third of it on. */
        double share = fmin(3 * along / half, 1);
        x[0] = (x[0] < half ? -1 : 1) * (along * c + share * deep * s);
        x[2] = along * s - (1 - share) * deep / c - share * deep * c;
        for (int i = 0; i < 3; i++) max[i] = fmax(max[i], x[i]);
    }
    touch_self(model);
    add_plane(model, (double[]){max[0] + 0.001, 0, 0}, (double[]){-1, 0, 0});
    add_plane(model, (double[]){0, 0, max[2] + 0.001}, (double[]){0, 0, -1});
    memcpy(model->gravity, (double[]){7, 0, 7}, sizeof model->gravity);
    model->damping = 20;
    return model;
}

static double offset_of(const lar_simulation *s, int32_t node) {
    return lar_simulation_state(s)->level[s->domain.layout.local[node]];
}

/* Nodes that have come in without coming through a face. */
static int stowaways(const lar_simulation *s) {
    int count = 0;
    for (int32_t n = 0; n < s->domain.model->mesh.node_count; n++)
        count += offset_of(s, n) > LAR_OFFSET_RETURN;
    return count;
}

/* ---- how deep ------------------------------------------------------------------------------- */

static double determinant(const double a[3], const double b[3], const double c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Whether x is in the tetrahedron of four points, as they stand relative to the first. */
static bool in_tetrahedron(const double x[3], const double corner[4][3]) {
    double edge[3][3], to[3];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) edge[a][i] = corner[a + 1][i] - corner[0][i];
        to[i] = x[i] - corner[0][i];
    }
    double whole = determinant(edge[0], edge[1], edge[2]);
    double share[3] = {determinant(to, edge[1], edge[2]) / whole,
                       determinant(edge[0], to, edge[2]) / whole,
                       determinant(edge[0], edge[1], to) / whole};
    return share[0] > 0 && share[1] > 0 && share[2] > 0 && share[0] + share[1] + share[2] < 1;
}

/* A hexahedron is 24 tetrahedra around its middle, four for each face. */
static bool in_element(const double x[3], const double corner[8][3]) {
    double part[4][3] = {{0}};
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) part[0][i] += corner[a][i] / 8;
    for (int f = 0; f < 6; f++) {
        const uint8_t *face = lar_face_node[f];
        for (int i = 0; i < 3; i++)
            part[1][i] = 0.25 * ((corner[face[0]][i] + corner[face[1]][i]) +
                                 (corner[face[2]][i] + corner[face[3]][i]));
        for (int a = 0; a < 4; a++) {
            memcpy(part[2], corner[face[a]], sizeof part[2]);
            memcpy(part[3], corner[face[(a + 1) % 4]], sizeof part[3]);
            if (in_tetrahedron(x, (const double(*)[3])part)) return true;
        }
    }
    return false;
}

static void place_of(const lar_simulation *s, int32_t node, double x[3]) {
    for (int i = 0; i < 3; i++) x[i] = s->domain.model->mesh.position[node][i] + node_u(s, node)[i];
}

/* How far the surface is from the deepest of the nodes that lie in elements of others. */
static double deepest_inside(const lar_simulation *s, int *count) {
    const lar_model *model = s->domain.model;
    double deepest = 0;
    *count = 0;
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double x[3], corner[8][3], min = INFINITY;
        bool inside = false;
        place_of(s, n, x);
        for (int32_t e = 0; e < model->mesh.element_count && !inside; e++) {
            bool own = false;
            for (int a = 0; a < 8; a++) {
                own = own || model->mesh.element[e][a] == n;
                place_of(s, model->mesh.element[e][a], corner[a]);
            }
            inside = !own && in_element(x, (const double(*)[3])corner);
        }
        if (!inside) continue;
        for (int32_t f = 0; f < model->surface.face_count; f++) {
            bool own = false;
            for (int a = 0; a < 4; a++) {
                own = own || model->surface.corner[f][a] == n;
                place_of(s, model->surface.corner[f][a], corner[a]);
            }
            if (!own) min = fmin(min, lar_face_distance(x, (const double(*)[3])corner));
        }
        deepest = fmax(deepest, min);
        (*count)++;
    }
    return deepest;
}

/* ---- one node ------------------------------------------------------------------------------- */

/* Puts a node at `depth` below the middle of a face, sinking by `sinks` in a step. Returns the
 * force on it, in the way out, and lets the step pass. */
static double put(lar_simulation *s, int32_t node, int32_t face, double depth, double sinks) {
    lar_domain *domain = &s->domain;
    const lar_model *model = domain->model;
    const lar_body_contact *contact = &s->interactions.body_contact;
    static const double even[4] = {0.25, 0.25, 0.25, 0.25};
    double corner[4][3], middle[3], normal[3], length = 0, force = 0;
    for (int a = 0; a < 4; a++) place_of(s, model->surface.corner[face][a], corner[a]);
    lar_face_mean((const double(*)[3])corner, even, middle);
    lar_face_normal((const double(*)[3])corner, normal);
    for (int i = 0; i < 3; i++) length += normal[i] * normal[i];
    for (int i = 0; i < 3; i++) {
        double way = normal[i] / sqrt(length);
        s->state.u[node_at(s, node, i)] = middle[i] - depth * way - model->mesh.position[node][i];
        s->state.v[node_at(s, node, i)] = -sinks * way / domain->time_step;
    }
    lar_condition_context context = lar_domain_context(domain);
    lar_body_contact_forget(&s->interactions.body_contact);
    lar_body_contact_apply(&s->interactions.body_contact, &context, &s->state);
    for (int32_t p = 0; p < contact->part_count; p++)
        for (int i = 0; i < 3 && contact->part[p].node[0] == domain->layout.local[node]; i++)
            force += contact->part[p].force[0][i] * normal[i] / sqrt(length);
    lar_body_contact_moved(&s->interactions.body_contact, &s->state, 0);
    clear_forces(s);
    return force;
}

/* A node of an end, and a face against it on the inside of the other. */
static void end_and_face(const lar_model *model, int32_t *node, int32_t *face) {
    const brick b = {.cells = {12, 3, 2}};
    *node = brick_node(&b, 12, 1, 2);
    *face = -1;
    for (int32_t f = 0; f < model->surface.face_count; f++) {
        const int32_t *corner = model->surface.corner[f];
        int on = 0;
        for (int a = 0; a < 4; a++)
            for (int j = 0; j < 4; j++) on += corner[a] == brick_node(&b, 1 + j % 2, 1 + j / 2, 2);
        if (on == 4) *face = f;
    }
    assert_true(*face >= 0);
}

static void a_node_is_pushed_from_where_it_appeared(void **unused) {
    (void)unused;
    static const double mm = 1e-3;
    lar_model *model = folding_bar(1e3, 2);
    lar_simulation *s = start(model);
    int32_t node, face;
    end_and_face(model, &node, &face);
    /* From the side: only what it sinks deeper counts, and it takes the offset out with it. */
    assert_true(put(s, node, face, 1 * mm, 0) == 0);
    assert_below(fabs(offset_of(s, node) - 1 * mm), 1e-9);
    double deeper = put(s, node, face, 1.5 * mm, 0);
    assert_true(deeper > 0);
    assert_below(fabs(offset_of(s, node) - 1 * mm), 1e-9);
    assert_true(put(s, node, face, 0.5 * mm, 0) == 0);
    assert_below(fabs(offset_of(s, node) - 0.5 * mm), 1e-9);
    assert_below(fabs(put(s, node, face, 1 * mm, 0) - deeper), 1e-6 * deeper);
    assert_true(put(s, node, face, -0.1 * mm, 0) == 0);
    assert_true(offset_of(s, node) == 0);
    /* Through the face: all counts, also later. */
    assert_true(put(s, node, face, 0.1 * mm, 0.2 * mm) > 0);
    assert_true(offset_of(s, node) == LAR_OFFSET_FRONT);
    assert_below(fabs(put(s, node, face, 0.5 * mm, 0) - deeper), 1e-6 * deeper);
    assert_true(offset_of(s, node) == LAR_OFFSET_FRONT);
    /* Deeper than the layer it is lost, and comes back from the side. */
    assert_true(put(s, node, face, 6 * mm, 0) == 0);
    assert_true(offset_of(s, node) == 0);
    assert_true(put(s, node, face, 4 * mm, 0) == 0);
    assert_below(fabs(offset_of(s, node) - 4 * mm), 1e-9);
    finish(s, model);
}

/* Squeezed out through the back of a face, it is not caught there. */
static void a_node_from_inside_may_return(void **unused) {
    (void)unused;
    static const double mm = 1e-3;
    lar_model *model = folding_bar(1e3, 2);
    lar_simulation *s = start(model);
    int32_t node, face;
    end_and_face(model, &node, &face);
    assert_true(put(s, node, face, 3 * mm, 0) == 0);
    assert_true(put(s, node, face, 0.1 * mm, 0) == 0);
    assert_below(fabs(offset_of(s, node) - 3 * mm), 1e-9);
    assert_true(put(s, node, face, -0.1 * mm, 0) == 0);
    assert_true(offset_of(s, node) == LAR_OFFSET_OUT);
    assert_true(put(s, node, face, -30 * mm, 0) == 0); /* far from all faces */
    assert_true(offset_of(s, node) == LAR_OFFSET_OUT);
    assert_true(put(s, node, face, 0.1 * mm, 0.2 * mm) == 0);
    assert_true(offset_of(s, node) == LAR_OFFSET_RETURN);
    assert_true(put(s, node, face, 3 * mm, 0.2 * mm) == 0);
    assert_true(offset_of(s, node) == LAR_OFFSET_RETURN);
    assert_true(put(s, node, face, -0.1 * mm, 0) == 0);
    assert_true(offset_of(s, node) == LAR_OFFSET_OUT);
    assert_true(put(s, node, face, 0.1 * mm, 0.2 * mm) == 0);
    assert_true(put(s, node, face, 6 * mm, 0) == 0);
    assert_true(offset_of(s, node) == 0);
    assert_true(put(s, node, face, 0.1 * mm, 0.2 * mm) > 0);
    finish(s, model);
}

/* ---- to rest -------------------------------------------------------------------------------- */

/* Kinetic energy half a step back, as in test_body_contact_rest.c. */
static double kinetic(const lar_simulation *s) {
    double energy = 0;
    for (int32_t n = 0; n < s->domain.model->mesh.node_count; n++)
        for (int i = 0; i < 3; i++)
            energy +=
                0.5 * s->domain.mass[s->domain.layout.local[n]] * node_v(s, n)[i] * node_v(s, n)[i];
    return energy;
}

static void fold_shut(double shear, int layers) {
    lar_model *model = folding_bar(shear, layers);
    lar_simulation *s = start(model);
    lar_energy e;
    int inside, max = 0;
    double given = 0, over = 0, before = 0;
    while (lar_simulation_time(s) < 6) {
        advance(s, 20);
        lar_simulation_energy(s, &e);
        max = stowaways(s) > max ? stowaways(s) : max;
        given = fmax(given, before - e.contact);
        over = fmax(over, e.kinetic + e.strain + e.hourglass - e.external);
        before = e.contact;
    }
    double deepest = deepest_inside(s, &inside);
    print_message("G = %g kPa, %d layers: %d nodes came in from the side at most; at rest %d "
                  "inside, %.2f of an element deep, kinetic %.2g of %.2g J; contact took %.2g J, "
                  "gave at most %.2g at a time\n",
                  1e-3 * shear, layers, max, inside, deepest / 0.01, kinetic(s), e.strain,
                  e.contact, given);
    assert_true(max > 0); /* or this tests nothing */
    assert_true(e.contact > 0);
    assert_below(given, 0.02 * e.contact);
    assert_below(over, 1e-9);
    assert_below(kinetic(s), 1e-6 * e.strain);
    assert_below(deepest, 0.005);
    finish(s, model);
}

static void a_crease_that_folds_shut_goes_on_to_rest(void **unused) {
    (void)unused;
    fold_shut(1e3, 2);
    if (test_every(2) > 1) return;
    fold_shut(3e3, 2);
    fold_shut(3e3, 3);
}

/* ---- the same bits -------------------------------------------------------------------------- */

enum { MIDDLE = 800, END = 900 };

#define PATH LAR_TEST_BUILD "/fold.checkpoint"

/* Also who does not account for a node knows its offset: the next search may need it there. */
static void check_copies(const lar_simulation *s) {
    const lar_state *state = lar_simulation_state(s);
    for (int32_t i = 0; s->computer && i < s->computer->hosted; i++) {
        const lar_processor *p = &s->computer->processor[i];
        for (int32_t n = 0; n < s->domain.model->mesh.node_count; n++) {
            lar_lid here = p->domain.layout.local[n], there = s->domain.layout.local[n];
            if (here >= 0) assert_true(p->worker[0].state.level[here] == state->level[there]);
        }
    }
}

/* At MIDDLE and END steps of a run that nothing interrupts. */
static void straight(lar_model *model, lar_options options, uint64_t hash[2]) {
    lar_simulation *s = start_with(model, options);
    lar_error error;
    advance(s, MIDDLE);
    hash[0] = lar_simulation_hash(s);
    assert_true(stowaways(s) > 0);
    check_copies(s);
    if (!options.grid) assert_int_equal(lar_simulation_save(s, PATH, &error), LAR_OK);
    advance(s, END - MIDDLE);
    hash[1] = lar_simulation_hash(s);
    lar_simulation_destroy(s);
}

/* From the checkpoint on: what lies inside still does, and is not pushed. */
static void take_up(lar_simulation *s, const uint64_t hash[2]) {
    lar_error error;
    advance(s, 60); /* from here another way */
    if (lar_simulation_load(s, PATH, &error)) fail_msg("%s", error.message);
    assert_true(lar_simulation_hash(s) == hash[0]);
    advance(s, END - MIDDLE);
    assert_true(lar_simulation_hash(s) == hash[1]);
}

static void bits_do_not_depend_on_the_division(void **unused) {
    (void)unused;
    static const char *const grids[] = {"1x1x1", "2x1x1", "2x2x1", "1x3x1", "3x1x2", "4x1x1"};
    lar_model *model = folding_bar(1e3, 2);
    lar_options options = lar_options_default();
    uint64_t one[2], other[2];
    straight(model, options, one);
    for (int i = test_every(3) - 1; i < 8; i += test_every(3)) {
        options = lar_options_default();
        options.grid = i < 6 ? grids[i] : NULL;
        options.threads = i < 6 ? 1 + i % 2 : 0;
        options.delays = i == 2 ? 5 : 0;
        options.isa = i == 6 ? LAR_ISA_C : LAR_ISA_AUTO;
        options.search_always = i == 3 || i == 7;
        straight(model, options, other);
        if (other[0] != one[0] || other[1] != one[1]) fail_msg("number %d: other bits", i);
        lar_simulation *s = start_with(model, options);
        take_up(s, one);
        lar_simulation_destroy(s);
    }
    lar_model_destroy(model);
}

/* The body rubs on itself: other bits, the same on every division, and less energy in the end. */
static void a_body_rubs_on_itself(void **unused) {
    (void)unused;
    static const char *const grids[] = {"2x1x1", "2x2x1", "3x1x2"};
    lar_model *model = folding_bar(1e3, 2);
    lar_options options = lar_options_default();
    uint64_t smooth[2], one[2], other[2];
    straight(model, options, smooth);
    model->contact[0].friction = 0.5;
    straight(model, options, one);
    assert_true(one[1] != smooth[1]);
    for (int i = 0; i < 4; i++) {
        options = lar_options_default();
        options.grid = i < 3 ? grids[i] : NULL;
        options.threads = i < 3 ? 1 + i % 2 : 0;
        options.search_always = i == 3;
        straight(model, options, other);
        if (other[0] != one[0] || other[1] != one[1]) fail_msg("number %d: other bits", i);
        lar_simulation *s = start_with(model, options);
        take_up(s, one);
        lar_simulation_destroy(s);
    }
    lar_simulation *s = start(model);
    lar_energy e;
    double given = 0, over = 0, before = 0;
    while (lar_simulation_time(s) < 2) {
        advance(s, 20);
        lar_simulation_energy(s, &e);
        given = fmax(given, before - e.contact);
        over = fmax(over, e.kinetic + e.strain + e.hourglass - e.external);
        before = e.contact;
    }
    print_message("rubbing on itself: kinetic %.2g of %.2g J; contact took %.2g J, gave at most "
                  "%.2g at a time\n",
                  kinetic(s), e.strain, e.contact, given);
    assert_below(given, 0.02 * e.contact);
    assert_below(over, 1e-9);
    finish(s, model);
}

static void nor_on_processes(void **unused) {
    (void)unused;
    lar_model *model = folding_bar(1e3, 2);
    uint64_t hash[2];
    straight(model, lar_options_default(), hash);
    for (int i = 0; i < 2; i++) {
        lar_options options = lar_options_default();
        options.grid = i ? "2x2x1" : "2x1x1";
        options.threads = 1;
        options.comm = i ? "shm" : "tcp";
        fleet f;
        start_fleet(&f, model, options, i ? 4 : 2, NULL);
        take_up(f.zero, hash);
        end_fleet(&f);
    }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_node_is_pushed_from_where_it_appeared),
        cmocka_unit_test(a_node_from_inside_may_return),
        cmocka_unit_test(a_crease_that_folds_shut_goes_on_to_rest),
        cmocka_unit_test(bits_do_not_depend_on_the_division),
        cmocka_unit_test(a_body_rubs_on_itself),
        cmocka_unit_test(nor_on_processes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
