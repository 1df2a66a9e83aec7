/* The search over boxes finds what comparing everything with everything finds, keeps doing so while
 * things move by as much as its skin allows, and leaves neighbours and the body's own shape alone.
 */
#include "engine/body_contact_test.h"
#include "mechanics/face_contact.h"

static const brick one_brick = {{5, 4, 3}, 0.01, 0.1, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};
static const brick other_brick = {{4, 4, 2}, 0.008, 0.1, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};

static lar_contact_tree tree;
static lar_contact_search search;

static void create(lar_model *model) {
    lar_error error;
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
    size_t nodes = (size_t)model->mesh.node_count;
    double *mass = lar_calloc(nodes, sizeof *mass);
    int32_t *local = lar_calloc(nodes, sizeof *local);
    for (size_t n = 0; n < nodes; n++) {
        local[n] = (int32_t)n;
        mass[n] = 1;
    }
    if (lar_contact_tree_create(model, mass, local, &tree, &error) ||
        (tree.surface.node_count > 0 && lar_contact_search_create(&tree, &search, &error)))
        fail_msg("%s", error.message);
    free(mass);
    free(local);
}

/* Of a node, or a point of a sharp edge or a face between some of them. */
static double distance(const double (*x)[3], int32_t node, int32_t face) {
    double corner[4][3], at[3] = {0}, weight[LAR_CONTACT_PARENTS];
    int32_t parent[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(&tree.surface, node, parent, weight);
    for (int k = 0; k < count; k++)
        for (int i = 0; i < 3; i++) at[i] += weight[k] * x[parent[k]][i];
    for (int a = 0; a < 4; a++)
        memcpy(corner[a], x[tree.surface.face[face].corner[a]], sizeof corner[a]);
    return lar_face_distance(at, (const double(*)[3])corner);
}

static bool listed(int32_t node, int32_t face) {
    const lar_contact_list *list = &search.list;
    for (int32_t g = 0; g < list->group_count; g++)
        for (int32_t i = 0; list->group[g].node == node && i < list->group[g].count; i++)
            if (list->face[list->group[g].first + i] == face) return true;
    return false;
}

/* Points of edges meet no face of their own body. */
static bool kept_apart(int32_t node, int32_t face) {
    const lar_contact_surface *s = &tree.surface;
    if (node < s->node_count) return lar_contact_apart(s, node, face);
    return s->node[node].body == s->face[face].body;
}

/* Pairs that belong together and are nearer than the reach, all of them listed. */
static int32_t check_complete(const double (*x)[3]) {
    const lar_contact_surface *s = &tree.surface;
    int32_t near = 0;
    for (int32_t n = 0; n < s->point_count; n++)
        for (int32_t f = 0; f < s->face_count; f++) {
            if (!lar_contact_active(&s->node[n], &s->face[f]) || kept_apart(n, f) ||
                distance(x, n, f) > lar_contact_reach(s, &s->node[n], &s->face[f]))
                continue;
            near++;
            assert_true(listed(n, f));
        }
    return near;
}

static double (*places(void))[3] {
    size_t nodes = (size_t)tree.surface.node_count;
    double(*x)[3] = lar_calloc(nodes, sizeof *x);
    memcpy(x, tree.surface.rest, nodes * sizeof *x);
    return x;
}

/* Every node moves by all that it may, one way or the other along each axis. */
static void shake(const double (*x)[3], int trial, double (*moved)[3]) {
    for (int32_t n = 0; n < tree.surface.node_count; n++)
        for (int i = 0; i < 3; i++) {
            double may = search.list.allow[n];
            moved[n][i] = x[n][i] + (noise((uint32_t)(7919 * trial + 3 * n + i)) > 0 ? may : -may);
        }
}

static void nothing_is_missed(void **unused) {
    (void)unused;
    for (int self = 0; self < 2; self++) {
        lar_model *model = two_bricks(&one_brick, &other_brick, 0.003, false);
        if (self) touch_self(model);
        create(model);
        const double skin = 0.004;
        double(*x)[3] = places(), (*moved)[3] = places();
        /* The upper body sinks into the lower one, which bulges. */
        for (int32_t n = 0; n < tree.surface.node_count; n++) {
            if (tree.surface.node[n].body > 0) x[n][2] -= 0.006;
            for (int i = 0; i < 3; i++) x[n][i] += 0.002 * noise((uint32_t)(3 * n + i));
        }
        assert_true(lar_contact_search_run(&search, (const double(*)[3])x, skin));
        assert_true(search.list.skin == skin && search.list.allow[0] == 0.5 * skin);
        assert_true(check_complete((const double(*)[3])x) > 100);
        for (int trial = 0; trial < 20; trial++) {
            shake((const double(*)[3])x, trial, moved);
            assert_true(check_complete((const double(*)[3])moved) > 50);
        }
        free(x);
        free(moved);
        lar_contact_search_clear(&search);
        lar_contact_tree_clear(&tree);
        lar_model_destroy(model);
    }
}

/* Nodes that may move less than others are in fewer pairs, and these are enough. */
static void each_has_its_share(void **unused) {
    (void)unused;
    lar_model *model = two_bricks(&one_brick, &other_brick, 0.003, false);
    touch_self(model);
    create(model);
    double(*x)[3] = places(), (*moved)[3] = places();
    for (int32_t n = 0; n < tree.surface.node_count; n++)
        if (tree.surface.node[n].body > 0) x[n][2] -= 0.006;
    assert_true(lar_contact_search_run(&search, (const double(*)[3])x, 0.008));
    int32_t pairs = search.list.face_count;
    for (int32_t n = 0; n < tree.surface.node_count; n++)
        search.share[n] = 0.1f + 0.9f * (float)(n % 23 == 0);
    assert_true(lar_contact_search_run(&search, (const double(*)[3])x, 0.008));
    assert_true(2 * search.list.face_count < pairs);
    for (int32_t n = 0; n < tree.surface.node_count; n++)
        assert_true(search.list.allow[n] == 0.004 * (double)search.share[n]);
    for (int trial = 0; trial < 20; trial++) {
        shake((const double(*)[3])x, trial, moved);
        assert_true(check_complete((const double(*)[3])moved) > 50);
    }
    free(x);
    free(moved);
    lar_contact_search_clear(&search);
    lar_contact_tree_clear(&tree);
    lar_model_destroy(model);
}

/* In parts it is the same list, made of the places at its beginning. */
static void in_parts_it_is_the_same(void **unused) {
    (void)unused;
    lar_model *model = two_bricks(&one_brick, &other_brick, 0.001, false);
    touch_self(model);
    create(model);
    double(*x)[3] = places();
    assert_true(lar_contact_search_run(&search, (const double(*)[3])x, 0.003));
    int32_t groups = search.list.group_count, faces = search.list.face_count;
    int32_t *face = lar_calloc((size_t)faces, sizeof *face);
    memcpy(face, search.list.face, (size_t)faces * sizeof *face);
    lar_contact_search_begin(&search, (const double(*)[3])x, 0.003);
    int parts = 1;
    lar_contact_progress progress;
    while ((progress = lar_contact_search_go_on(&search, 7)) == LAR_SEARCH_UNDER_WAY) {
        assert_int_equal(search.list.group_count, groups); /* the last one, until it is done */
        parts++;
    }
    assert_int_equal(progress, LAR_SEARCH_DONE);
    assert_true(parts > 10);
    assert_int_equal(search.list.group_count, groups);
    assert_int_equal(search.list.face_count, faces);
    assert_memory_equal(search.list.face, face, (size_t)faces * sizeof *face);
    free(face);
    free(x);
    lar_contact_search_clear(&search);
    lar_contact_tree_clear(&tree);
    lar_model_destroy(model);
}

/* A gap that a face states is one, and its group has the smallest: whoever moves by less than half
 * of it stays out of reach. */
static void gaps_are_no_more_than_that(void **unused) {
    (void)unused;
    lar_model *model = two_bricks(&one_brick, &other_brick, 0.012, false);
    create(model);
    double(*x)[3] = places();
    for (int32_t n = 0; n < tree.surface.node_count; n++)
        search.share[n] = 0.2f + 0.8f * (float)(n % 3 == 0);
    assert_true(lar_contact_search_run(&search, (const double(*)[3])x, 0.02));
    const lar_contact_surface *s = &tree.surface;
    int32_t outside = 0;
    for (int32_t g = 0; g < search.list.group_count; g++) {
        const lar_contact_group *group = &search.list.group[g];
        float least = INFINITY;
        for (int32_t i = group->first; i < group->first + group->count; i++) {
            int32_t f = search.list.face[i];
            double reach = lar_contact_reach(s, &s->node[group->node], &s->face[f]);
            assert_true(distance((const double(*)[3])x, group->node, f) >=
                        (double)search.list.gap[i] + reach - 1e-12);
            least = fminf(least, search.list.gap[i]);
        }
        assert_true(group->gap == least);
        outside += group->gap > 0;
    }
    assert_true(outside > 10);
    free(x);
    lar_contact_search_clear(&search);
    lar_contact_tree_clear(&tree);
    lar_model_destroy(model);
}

/* A strip bent to a ring whose ends lie in each other already in the mesh. */
static void the_shape_of_a_body_is_no_contact(void **unused) {
    (void)unused;
    brick b = {{24, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};
    lar_model *model = brick_model(&b);
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double *x = model->mesh.position[n];
        double angle = -6.35 * (x[0] / 0.24 - 0.5), radius = 0.045 - x[2];
        double at[3] = {-radius * cos(angle), x[1], radius * sin(angle)};
        memcpy(x, at, sizeof at);
    }
    touch_self(model);
    create(model);
    assert_true(lar_contact_search_run(&search, (const double(*)[3])tree.surface.rest, 0));
    for (int32_t g = 0; g < search.list.group_count; g++) {
        const lar_contact_group *group = &search.list.group[g];
        for (int32_t i = group->first; i < group->first + group->count; i++) {
            const lar_contact_face *f = &tree.surface.face[search.list.face[i]];
            lar_face_point point;
            double corner[4][3];
            for (int a = 0; a < 4; a++)
                memcpy(corner[a], tree.surface.rest[f->corner[a]], sizeof corner[a]);
            lar_face_closest(tree.surface.rest[group->node], (const double(*)[3])corner, 1e-11,
                             &point);
            assert_true(point.distance > tree.surface.body[0].reach[0] || point.height > -1e-9);
        }
    }
    lar_contact_search_clear(&search);
    lar_contact_tree_clear(&tree);
    lar_model_destroy(model);
}

static void without_contact_there_is_nothing(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&one_brick);
    create(model);
    assert_int_equal(tree.surface.node_count, 0);
    assert_null(tree.fork);
    lar_contact_search_clear(&search);
    lar_contact_tree_clear(&tree);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_missed),
        cmocka_unit_test(each_has_its_share),
        cmocka_unit_test(in_parts_it_is_the_same),
        cmocka_unit_test(gaps_are_no_more_than_that),
        cmocka_unit_test(the_shape_of_a_body_is_no_contact),
        cmocka_unit_test(without_contact_there_is_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
