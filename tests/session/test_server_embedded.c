/* An embedded surface reaches viewers: once, with what moves it, and frames carry
 * the nodes that it needs: docs/viewer-protocol.md, message 4. */
#include "session/session_test.h"

#include "session/server_test.h"

#include "meshing/shapes.h"

/* Around the block's left end, within and without it; what it is embedded in has inner nodes too.
 */
static void let_ball_ride(lar_model *model, int n) {
    static const double half[3] = {0.008, 0.012, 0.011}, centre[3] = {0.0102, 0.0098, 0.0101};
    lar_triangles ball;
    shape_ellipsoid_surface(&ball, half, centre, n);
    DONE(lar_embedded_surface_bind(&model->mesh, &ball, &model->embedded, &failure));
}

static served serve_ball(int n, const char *grid) {
    served s = {.b = {.model = served_model()}};
    s.b.model->view[1] = 1;
    let_ball_ride(s.b.model, n);
    s.b.simulation = served_simulation(s.b.model, grid);
    DONE(lar_session_open(s.b.simulation, NULL, &s.b.session, &failure));
    DONE(lar_server_open(s.b.session, s.b.model, NULL, &s.server, &failure));
    DONE(lar_session_start(s.b.session, &failure));
    s.port = port_of(s.server);
    return s;
}

/* Both messages of a surface, kept while frames come. */
typedef struct shown {
    uint32_t nodes, faces, vertices, triangles, further;
    uint32_t *node;    /* [nodes + further] indices in the model */
    float *rest;       /* [nodes + further][3] */
    float *weight;     /* [vertices][8] */
    uint32_t *carrier; /* [vertices][8] */
    uint32_t *material, *corner;
} shown;

static uint32_t *copy_words(const client *c, size_t offset, size_t count) {
    uint32_t *word = malloc((count + 1) * 4);
    assert_true(offset + 4 * count <= c->length);
    memcpy(word, c->data + offset, 4 * count);
    return word;
}

static shown await_shown(client *c) {
    shown s = {0};
    await_binary(c, 1);
    s.nodes = word_at(c, 4);
    s.faces = word_at(c, 8);
    uint32_t *node = copy_words(c, 16 + 16 * s.nodes + 24 * s.faces, s.nodes);
    uint32_t *rest = copy_words(c, 16, 3 * s.nodes);
    await_binary(c, 4);
    s.vertices = word_at(c, 4);
    s.triangles = word_at(c, 8);
    s.further = word_at(c, 12);
    size_t f = s.further, m = s.vertices, all = s.nodes + f;
    assert_int_equal(c->length, 16 + 20 * f + 68 * m + 12 * s.triangles);
    s.node = realloc(node, 4 * all);
    s.rest = realloc((void *)rest, 12 * all);
    memcpy(s.rest + 3 * s.nodes, c->data + 16, 12 * f);
    memcpy(s.node + s.nodes, c->data + 16 + 16 * f, 4 * f);
    s.weight = (float *)(void *)copy_words(c, 16 + 20 * f, 8 * m);
    s.carrier = copy_words(c, 16 + 20 * f + 32 * m, 8 * m);
    s.material = copy_words(c, 16 + 20 * f + 64 * m, m);
    s.corner = copy_words(c, 16 + 20 * f + 68 * m, 3 * s.triangles);
    return s;
}

static void forget(shown *s) {
    free(s->node);
    free(s->rest);
    free(s->weight);
    free(s->carrier);
    free(s->material);
    free(s->corner);
}

/* The place of vertex v when its nodes are at x. */
static void place_of(const shown *s, uint32_t v, const float *x, double place[3]) {
    for (int i = 0; i < 3; i++) {
        place[i] = 0;
        for (int a = 0; a < 8; a++)
            place[i] += (double)s->weight[8 * v + a] * (double)x[3 * s->carrier[8 * v + a] + i];
    }
}

static void embedded_surface_is_told(void **unused) {
    (void)unused;
    served s = serve_ball(12, "2x1x1");
    client c = open_client(s.port);
    const char *hello = await_text(&c, "hello");
    assert_non_null(strstr(hello, "\"view\":[0,1,0]"));
    lar_embedded_info info;
    assert_int_equal(lar_model_embedded(s.b.model, &info), 1);
    const char *embedded = strstr(hello, "\"riding\":{");
    assert_non_null(embedded);
    assert_int_equal((int)number_of(embedded, "vertices"), info.vertices);
    assert_int_equal((int)number_of(embedded, "triangles"), info.triangles);
    int further = (int)number_of(embedded, "nodes");
    assert_true(further > 0);
    shown sent = await_shown(&c);
    assert_int_equal(sent.vertices, info.vertices);
    assert_int_equal(sent.triangles, info.triangles);
    assert_int_equal(sent.further, further);
    assert_memory_equal(sent.corner, info.triangle, 12 * (size_t)info.triangles);
    const double(*rest)[3] = lar_model_positions(s.b.model);
    for (uint32_t i = 0; i < sent.nodes + sent.further; i++) {
        if (i != 0 && i != sent.nodes) assert_true(sent.node[i] > sent.node[i - 1]);
        for (int axis = 0; axis < 3; axis++)
            assert_true(sent.rest[3 * i + (uint32_t)axis] == (float)rest[sent.node[i]][axis]);
    }
    for (uint32_t v = 0; v < sent.vertices; v++) {
        const int32_t *nodes = lar_model_element_nodes(s.b.model, info.element[v]);
        double place[3];
        for (uint32_t a = 0; a < 8; a++) {
            assert_true(sent.carrier[8 * v + a] < sent.nodes + sent.further);
            assert_int_equal(sent.node[sent.carrier[8 * v + a]], nodes[a]);
        }
        assert_int_equal(sent.material[v], 0);
        place_of(&sent, v, sent.rest, place);
        for (int i = 0; i < 3; i++) assert_below(fabs(place[i] - info.rest[v][i]), 1e-7);
    }
    forget(&sent);
    close_client(&c);
    end_serving(&s);
}

/* Frames have all that moves it, of one step, and their hash covers all of that. */
static void frames_move_it(void **unused) {
    (void)unused;
    served s = serve_ball(12, NULL);
    lar_model *model = served_model();
    let_ball_ride(model, 12);
    lar_simulation *plain = served_simulation(model, NULL);
    size_t nodes = (size_t)model->mesh.node_count;
    double(*u)[3] = lar_calloc(nodes, sizeof *u);
    double(*place)[3] = lar_calloc((size_t)model->embedded.surface.vertex_count, sizeof *place);
    float *value = lar_calloc(nodes, sizeof *value);
    client c = open_client(s.port);
    shown sent = await_shown(&c);
    uint32_t n = sent.nodes + sent.further;
    for (int round = 0; round < 6; round++) {
        ask_frame(&c, round % 2 ? "von_mises" : "none");
        uint32_t hash[2] = {0, 0};
        assert_int_equal(word_at(&c, 4), n);
        assert_int_equal(c.length, 72 + (round % 2 ? 16 : 12) * n + 4 * 64);
        DONE(lar_simulation_advance(plain, long_at(&c, 8) - lar_simulation_steps(plain), &failure));
        assert_true(long_at(&c, 24) == lar_simulation_hash(plain));
        lar_simulation_displacements(plain, u);
        lar_model_embedded_move(model, (const double(*)[3])u, place);
        for (uint32_t v = 0; v < sent.vertices; v++) {
            double here[3];
            place_of(&sent, v, positions_of(&c), here);
            for (int i = 0; i < 3; i++) assert_below(fabs(here[i] - place[v][i]), 2e-7);
        }
        for (uint32_t i = 0; i < 3 * n; i++) {
            uint32_t *h = &hash[i % 2], word = word_at(&c, 72 + 4 * i);
            *h = ((*h << 5 | *h >> 27) ^ word) * 0x9e3779b1u;
        }
        assert_int_equal(hash[0], word_at(&c, 32));
        assert_int_equal(hash[1], word_at(&c, 36));
        if (round % 2 == 0) continue;
        assert_int_equal(word_at(&c, 44), n);
        DONE(lar_simulation_field(plain, LAR_FIELD_VON_MISES, (const double(*)[3])u, value,
                                  &failure));
        for (uint32_t i = 0; i < n; i++)
            assert_true(positions_of(&c)[3 * n + i] == value[sent.node[i]]);
    }
    forget(&sent);
    free(u);
    free(place);
    free(value);
    close_client(&c);
    lar_simulation_destroy(plain);
    lar_model_destroy(model);
    end_serving(&s);
}

/* One that is too large is not sent: a sentence says so, and all is as without one. */
static void too_large_is_a_note(void **unused) {
    (void)unused;
    served s = serve_ball(502, NULL);
    lar_embedded_info info;
    assert_int_equal(lar_model_embedded(s.b.model, &info), 1);
    assert_true(info.triangles > 1000000);
    client c = open_client(s.port);
    assert_null(strstr(await_text(&c, "hello"), "riding"));
    await_binary(&c, 1);
    uint32_t n = word_at(&c, 4);
    assert_non_null(strstr(await_text(&c, "note"), "more than 1000000 triangles"));
    ask_frame(&c, "none");
    assert_int_equal(word_at(&c, 4), n);
    close_client(&c);
    end_serving(&s);
}

/* A model without one: no message 4, and frames as ever. */
static void nothing_is_embedded(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client c = open_client(s.port);
    assert_null(strstr(await_text(&c, "hello"), "riding"));
    say(&c, "{\"do\":\"frame\"}");
    for (int frames = 0; frames < 3 && next_frame(&c);) {
        if (c.opcode != BINARY_FRAME) continue;
        assert_true(word_at(&c, 0) != 4);
        frames += word_at(&c, 0) == 2;
        if (word_at(&c, 0) == 2) say(&c, "{\"do\":\"frame\"}");
    }
    close_client(&c);
    end_serving(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(embedded_surface_is_told), cmocka_unit_test(frames_move_it),
        cmocka_unit_test(too_large_is_a_note), cmocka_unit_test(nothing_is_embedded)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
