/* A viewer sees the organ as it is, pulls at it, and commands the run: docs/viewer-protocol.md. */
#include "session/session_test.h"

#include "session/server_test.h"

/* ---- what a viewer sees ---------------------------------------------------------------------- */

static void says_hello_and_shows_the_surface(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client c = open_client(s.port);
    lar_surface_info surface;
    lar_model_surface(s.b.model, &surface);
    const char *hello = await_text(&c, "hello");
    assert_int_equal((int)number_of(hello, "protocol"), 1);
    assert_int_equal((int)number_of(hello, "nodes"), s.b.model->mesh.node_count);
    assert_int_equal((int)number_of(hello, "faces"), surface.faces);
    assert_non_null(strstr(hello, "\"hands\":[2,3]"));
    assert_non_null(strstr(hello, "\"name\":\"grasper\",\"shape\":\"grasper\""));
    assert_non_null(strstr(hello, "\"saves\":false"));
    assert_null(strstr(hello, "\"view\""));
    assert_true(number_of(hello, "tick") == 0.001);

    await_binary(&c, 1);
    uint32_t n = word_at(&c, 4), f = word_at(&c, 8);
    assert_int_equal(n, surface.nodes);
    assert_int_equal(f, surface.faces);
    assert_int_equal(c.length, 16 + 20 * n + 24 * f);
    const double(*rest)[3] = lar_model_positions(s.b.model);
    const float *position = (const float *)(const void *)(c.data + 16);
    for (uint32_t i = 0; i < n; i++) {
        int32_t node = surface.node[i];
        assert_int_equal(word_at(&c, 16 + 16 * n + 24 * f + 4 * i), node);
        for (int axis = 0; axis < 3; axis++)
            assert_true(position[3 * i + axis] == (float)rest[node][axis]);
    }
    for (uint32_t i = 0; i < f; i++) {
        for (uint32_t a = 0; a < 4; a++)
            assert_int_equal(surface.node[word_at(&c, 16 + 12 * n + 16 * i + 4 * a)],
                             surface.face[i][a]);
        assert_int_equal(word_at(&c, 16 + 12 * n + 16 * f + 4 * i), 0); /* material */
        assert_int_equal(word_at(&c, 16 + 12 * n + 20 * f + 4 * i), 0); /* one body */
    }
    await_status(&c, "\"state\":\"playing\"");
    assert_int_equal((int)number_of((char *)c.data, "viewers"), 1);
    close_client(&c);
    end_serving(&s);
}

/* The brick without its elements in the middle: two bodies. */
static lar_model *two_bodies(void) {
    lar_model *model = unchecked_model();
    lar_mesh *mesh = &model->mesh;
    int32_t kept = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        if (e % soft_brick.cells[0] == 1) continue;
        memcpy(mesh->element[kept], mesh->element[e], sizeof *mesh->element);
        mesh->element_id[kept++] = mesh->element_id[e];
    }
    mesh->element_count = kept;
    DONE(lar_model_check(model, &failure));
    return model;
}

static void bodies_and_processors_are_told_apart(void **unused) {
    (void)unused;
    served s = {.b = {.model = two_bodies()}};
    s.b.simulation = served_simulation(s.b.model, "2x1x1");
    DONE(lar_session_open(s.b.simulation, NULL, &s.b.session, &failure));
    DONE(lar_server_open(s.b.session, s.b.model, NULL, &s.server, &failure));
    client c = open_client(port_of(s.server));
    await_binary(&c, 1);
    uint32_t n = word_at(&c, 4), f = word_at(&c, 8), seen = 0;
    const float *position = (const float *)(const void *)(c.data + 16);
    for (uint32_t i = 0; i < f; i++) {
        uint32_t node = word_at(&c, 16 + 12 * n + 16 * i);
        uint32_t body = word_at(&c, 16 + 12 * n + 20 * f + 4 * i);
        assert_int_equal(body, position[3 * node] > 0.015);
        seen |= 1u << body;
    }
    assert_int_equal(seen, 3);
    seen = 0;
    for (uint32_t i = 0; i < n; i++) seen |= 1u << word_at(&c, 16 + 12 * n + 24 * f + 4 * i);
    assert_int_equal(seen, 3);
    close_client(&c);
    end_serving(&s);
}

/* A picture is what a plain run has at its step, and nothing else: state hash and every position,
 * whatever the grid of the session. `plain` is advanced to the picture's step. */
static void compare_frame(const client *c, lar_simulation *plain, const lar_surface_info *surface) {
    const lar_model *model = plain->domain.model;
    size_t nodes = (size_t)model->mesh.node_count;
    uint64_t step = long_at(c, 8), now = lar_simulation_steps(plain);
    assert_true(step >= now);
    DONE(lar_simulation_advance(plain, step - now, &failure));
    assert_true(long_at(c, 24) == lar_simulation_hash(plain));
    assert_true(double_at(c, 16) == (double)step * lar_simulation_time_step(plain));
    double(*u)[3] = lar_calloc(nodes, sizeof *u);
    lar_simulation_displacements(plain, u);
    const float *position = positions_of(c);
    uint32_t hash[2] = {0, 0};
    for (int32_t i = 0; i < surface->nodes; i++)
        for (int axis = 0; axis < 3; axis++) {
            int32_t k = surface->node[i];
            uint32_t at = (uint32_t)(3 * i + axis), word, *h = &hash[at % 2];
            assert_true(position[at] == (float)(model->mesh.position[k][axis] + u[k][axis]));
            memcpy(&word, &position[at], 4);
            *h = ((*h << 5 | *h >> 27) ^ word) * 0x9e3779b1u;
        }
    assert_int_equal(hash[0], word_at(c, 32));
    assert_int_equal(hash[1], word_at(c, 36));
    free(u);
}

/* The values of the field that the frame has, against the library's own. */
static void compare_values(const client *c, const lar_simulation *plain,
                           const lar_surface_info *surface) {
    size_t nodes = (size_t)plain->domain.model->mesh.node_count, n = (size_t)surface->nodes;
    double(*u)[3] = lar_calloc(nodes, sizeof *u);
    float *value = lar_calloc(nodes, sizeof *value);
    const float *shown = positions_of(c) + 3 * n;
    uint32_t field = word_at(c, 40);
    lar_simulation_displacements(plain, u);
    DONE(lar_simulation_field(plain, (lar_field)field, (const double(*)[3])u, value, &failure));
    double min = INFINITY, max = -INFINITY;
    assert_int_equal(word_at(c, 44), n);
    for (size_t i = 0; i < n; i++) {
        assert_true(shown[i] == value[surface->node[i]]);
        min = fmin(min, shown[i]);
        max = fmax(max, shown[i]);
    }
    assert_true(double_at(c, 48) == min && double_at(c, 56) == max);
    assert_true(field == LAR_FIELD_PROCESSOR || max > min);
    free(value);
    free(u);
}

static void pictures_are_of_one_step(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "3x2x1"};
    static const char *const fields[] = {"none", "displacement", "von_mises", "pressure", "energy"};
    for (int g = 0; g < 3; g++) {
        served s = serve(grids[g]);
        lar_model *model = served_model();
        lar_simulation *plain = served_simulation(model, NULL);
        lar_surface_info surface;
        lar_model_surface(model, &surface);
        client c = open_client(s.port);
        for (int i = 0; i < 10; i++) {
            ask_frame(&c, fields[i % 5]);
            assert_int_equal(word_at(&c, 4), surface.nodes);
            assert_int_equal(word_at(&c, 64), 4); /* tools */
            uint32_t v = word_at(&c, 44);
            assert_int_equal(c.length, 72 + 12 * surface.nodes + 4 * (int)v + 4 * 64);
            compare_frame(&c, plain, &surface);
            if (i % 5 > 0) compare_values(&c, plain, &surface);
        }
        close_client(&c);
        end_serving(&s);
        lar_simulation_destroy(plain);
        lar_model_destroy(model);
    }
}

static void one_frame_is_under_way_at_most(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client c = open_client(s.port);
    await_binary(&c, 1);
    for (int i = 0; i < 20; i++) say(&c, "{\"do\":\"frame\"}");
    await_binary(&c, 2);
    /* Only statuses follow. */
    for (int i = 0; i < 3; i++) {
        assert_true(next_frame(&c));
        if (i > 0) assert_int_equal(c.opcode, TEXT_FRAME);
    }
    close_client(&c);
    end_serving(&s);
}

/* ---- what a viewer does ---------------------------------------------------------------------- */

/* Where the body's free end is in a frame: its mean height, and one of its corners. */
static double height_of(const client *c, float corner[3]) {
    const float *position = positions_of(c);
    double sum = 0, far = -1e9;
    uint32_t n = word_at(c, 4);
    for (uint32_t i = 0; i < n; i++) {
        sum += position[3 * i + 2];
        double score = position[3 * i] + position[3 * i + 1] + position[3 * i + 2];
        if (score > far) memcpy(corner, &position[3 * i], 3 * sizeof *corner);
        far = fmax(far, score);
    }
    return sum / n;
}

static void grab_at(client *c, int hand, const float at[3]) {
    char text[160];
    snprintf(text, sizeof text, "{\"do\":\"grab\",\"hand\":%d,\"point\":[%.6f,%.6f,%.6f]}", hand,
             (double)at[0], (double)at[1], (double)at[2]);
    say(c, text);
}

/* Waits until the body is above, or below, a height, on however busy a machine. */
static double await_height(client *c, double limit, bool above) {
    float corner[3];
    for (int i = 0; i < 1000; i++) {
        ask_frame(c, "none");
        double height = height_of(c, corner);
        if ((height > limit) == above) return height;
        nap(0.01);
    }
    fail_msg("the body does not come %s %g", above ? "above" : "below", limit);
    return 0;
}

static void pulls_and_lets_go(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client c = open_client(s.port);
    nap(0.3);
    ask_frame(&c, "none");
    float corner[3];
    double before = height_of(&c, corner);
    grab_at(&c, 0, corner);
    char text[160];
    snprintf(text, sizeof text, "{\"do\":\"pull\",\"hand\":0,\"to\":[%.6f,%.6f,%.6f]}",
             (double)corner[0], (double)corner[1], (double)corner[2] + 0.02);
    say(&c, text);
    const char *hand = await_text(&c, "hand");
    assert_non_null(strstr(hand, "\"hand\":0"));
    assert_non_null(strstr(hand, "\"state\":\"holding\""));
    double pulled = await_height(&c, before + 0.001, true);
    await_status(&c, "\"by\":\"you\"");
    say(&c, "{\"do\":\"forces\",\"tool\":2,\"after\":0}");
    await_binary(&c, 3);
    assert_int_equal(word_at(&c, 4), 2);
    uint32_t count = word_at(&c, 8);
    assert_int_equal(c.length, 32 + 12 * count);
    double strongest = 0;
    for (uint32_t i = 0; i < count; i++) {
        float z;
        memcpy(&z, c.data + 32 + 12 * i + 8, sizeof z);
        strongest = fmax(strongest, fabs(z));
    }
    if (!(strongest > 1e-3)) fail_msg("%u ticks, and no more than %g N", count, strongest);
    uint64_t last = long_at(&c, 16);
    snprintf(text, sizeof text, "{\"do\":\"forces\",\"tool\":2,\"after\":%llu}",
             (unsigned long long)last);
    say(&c, text);
    await_binary(&c, 3);
    assert_true(long_at(&c, 16) == last + word_at(&c, 8));
    assert_true(word_at(&c, 8) < count || count == 0);

    say(&c, "{\"do\":\"release\",\"hand\":0}");
    await_height(&c, before + 0.3 * (pulled - before), false);
    close_client(&c);
    end_serving(&s);
}

static void hands_are_handed_out(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client one = open_client(s.port), other = open_client(s.port);
    float corner[3], nowhere[3] = {5, 5, 5};
    grab_at(&one, 1, nowhere);
    assert_non_null(strstr(await_text(&one, "hand"), "\"state\":\"missed\""));
    ask_frame(&one, "none");
    height_of(&one, corner);
    grab_at(&one, 0, corner);
    assert_non_null(strstr(await_text(&one, "hand"), "\"state\":\"holding\""));
    grab_at(&one, 3, corner);
    assert_non_null(strstr(await_text(&one, "hand"), "\"hand\":3"));
    assert_non_null(strstr((char *)one.data, "\"state\":\"holding\""));
    await_status(&other, "\"by\":\"other\"");
    grab_at(&other, 0, corner);
    const char *answer = await_text(&other, "hand");
    assert_non_null(strstr(answer, "\"state\":\"refused\""));
    assert_non_null(strstr(answer, "\"tool\":null"));
    say(&other, "{\"do\":\"pull\",\"hand\":0,\"to\":[0,0,0]}"); /* of nothing: passed over */
    /* Who leaves lets go. */
    close_client(&one);
    for (int i = 0; i < 100; i++) {
        grab_at(&other, 0, corner);
        if (strstr(await_text(&other, "hand"), "holding")) break;
        nap(0.02);
    }
    assert_non_null(strstr((char *)other.data, "\"state\":\"holding\""));
    say(&other, "{\"do\":\"reset\"}");
    assert_non_null(strstr(await_text(&other, "hand"), "\"state\":\"lost\""));
    close_client(&other);
    end_serving(&s);
}

static void instruments_have_one_owner(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client one = open_client(s.port), other = open_client(s.port);
    say(&one, "{\"do\":\"tool\",\"tool\":1,\"position\":[0.2,0.01,0.2],\"opening\":0.1}");
    await_status(&one, "\"by\":\"you\"");
    say(&other, "{\"do\":\"tool\",\"tool\":1,\"position\":[0.2,0.02,0.2]}");
    assert_non_null(strstr(await_text(&other, "note"), "another viewer"));
    say(&other, "{\"do\":\"tool\",\"tool\":2,\"position\":[0.2,0.02,0.2]}");
    assert_non_null(strstr(await_text(&other, "note"), "hand"));
    /* It goes there, no faster than the session lets it. */
    lar_tool_pose pose = {.opening = -1};
    for (int i = 0; i < 2000 && !(fabs(pose.position[1] - 0.01) < 1e-4); i++) {
        lar_session_tool_force(s.b.session, SERVED_GRASPER, &pose, NULL, NULL);
        nap(0.002);
    }
    assert_true(fabs(pose.position[1] - 0.01) < 1e-4);
    assert_true(fabs(pose.opening - 0.1) < 0.01);
    close_client(&one); /* opens it */
    for (int i = 0; i < 2000 && pose.opening < 0.99; i++) {
        lar_session_tool_force(s.b.session, SERVED_GRASPER, &pose, NULL, NULL);
        nap(0.002);
    }
    assert_true(pose.opening > 0.99);
    say(&other, "{\"do\":\"tool\",\"tool\":1,\"position\":[0.2,0.02,0.2]}");
    await_status(&other, "\"by\":\"you\"");
    close_client(&other);
    end_serving(&s);
}

static double grasper_height(const served *s) {
    lar_tool_pose pose;
    DONE(lar_session_tool_force(s->b.session, SERVED_GRASPER, &pose, NULL, &failure));
    return pose.position[1];
}

/* A reset puts an instrument where the scene has it. Whoever moved it does not bring it back,
 * neither with what was still on its way nor by leaving. */
static void a_reset_takes_instruments_out_of_hands(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client one = open_client(s.port);
    const double rest = grasper_height(&s);
    say(&one, "{\"do\":\"tool\",\"tool\":1,\"position\":[0.2,0.02,0.2],\"opening\":0.1}");
    for (int i = 0; i < 2000 && !(fabs(grasper_height(&s) - 0.02) < 1e-4); i++) nap(0.002);
    assert_true(fabs(rest - 0.02) > 1e-3);
    await_status(&one, "\"by\":\"you\"");
    say(&one, "{\"do\":\"reset\"}");
    for (int i = 0; i < 2000 && fabs(grasper_height(&s) - rest) > 1e-9; i++) nap(0.002);
    say(&one, "{\"do\":\"tool\",\"tool\":1,\"position\":[0.2,0.02,0.2],\"opening\":0.1}");
    nap(0.1);
    assert_true(grasper_height(&s) == rest);
    await_status(&one, "\"placed\":1");
    assert_non_null(strstr((char *)one.data, "\"by\":\"nobody\""));
    assert_null(strstr((char *)one.data, "\"by\":\"you\""));
    close_client(&one);
    nap(0.2);
    assert_true(grasper_height(&s) == rest);
    /* Taken anew, it goes where it is moved. */
    client other = open_client(s.port);
    say(&other, "{\"do\":\"tool\",\"tool\":1,\"position\":[0.2,0.02,0.2]}");
    for (int i = 0; i < 2000 && !(fabs(grasper_height(&s) - 0.02) < 1e-4); i++) nap(0.002);
    assert_true(fabs(grasper_height(&s) - 0.02) < 1e-4);
    close_client(&other);
    end_serving(&s);
}

/* Pressed against the side that is held: it is seen where it is, not where it should go. */
static void a_tool_that_tissue_stops_says_so(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client c = open_client(s.port);
    const char *told = await_text(&c, "status");
    assert_true(number_of(told, "step_parts") >= 1 && number_of(told, "divided_steps") >= 0);
    assert_true(number_of(told, "limit") > 0);
    assert_true(number_of(told, "apart") == 0 && number_of(told, "depth") == 0);
    assert_null(strstr(told, "\"limited\":true"));
    say(&c, "{\"do\":\"tool\",\"tool\":0,\"position\":[0.06,0.01,0.008]}");
    lar_tool_pose pose = {.opening = -1};
    for (int i = 0; i < 2000 && !(pose.opening > 0 && fabs(pose.position[0] - 0.06) < 1e-4); i++) {
        lar_session_tool_force(s.b.session, SERVED_BALL, &pose, NULL, NULL);
        nap(0.002);
    }
    say(&c, "{\"do\":\"tool\",\"tool\":0,\"position\":[-0.01,0.01,0.008]}");
    await_status(&c, "\"limited\":true");
    told = (char *)c.data;
    const char *tools = strstr(told, "\"tools\":[");
    assert_non_null(tools);
    print_message("limit %g N, depth %g m, apart %g m, %g steps divided\n",
                  number_of(tools, "limit"), number_of(tools, "depth"), number_of(tools, "apart"),
                  number_of(told, "divided_steps"));
    assert_true(number_of(tools, "depth") > 0 && number_of(tools, "apart") > 0);
    double x = 0;
    assert_int_equal(sscanf(tools, "\"tools\":[{\"position\":[%lf", &x), 1);
    assert_true(x > -0.01 + number_of(tools, "apart"));
    lar_tool_load load;
    DONE(lar_session_tool_load(s.b.session, SERVED_BALL, &load, &failure));
    assert_true(load.reached && load.force > 0 && load.limit == number_of(tools, "limit"));
    say(&c, "{\"do\":\"tool\",\"tool\":0,\"position\":[0.06,0.01,0.008]}");
    /* On a busy machine the way back is slow motion. */
    for (int i = 0; i < 600 && strstr(await_text(&c, "status"), "\"limited\":true"); i++) continue;
    assert_null(strstr((char *)c.data, "\"limited\":true"));
    close_client(&c);
    end_serving(&s);
}

/* ---- commands -------------------------------------------------------------------------------- */

static void plays_pauses_steps_and_resets(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client c = open_client(s.port);
    say(&c, "{\"do\":\"pause\"}");
    await_status(&c, "\"state\":\"paused\"");
    uint64_t step = (uint64_t)number_of((char *)c.data, "step");
    say(&c, "{\"do\":\"step\",\"steps\":7}");
    char wanted[64];
    snprintf(wanted, sizeof wanted, "\"step\":%llu,", (unsigned long long)step + 7);
    await_status(&c, wanted);
    say(&c, "{\"do\":\"reset\"}");
    await_status(&c, "\"step\":0,");
    ask_frame(&c, "none");
    assert_true(long_at(&c, 8) == 0);
    say(&c, "{\"do\":\"pace\",\"value\":0.25}");
    await_status(&c, "\"pace\":0.25");
    say(&c, "{\"do\":\"play\"}");
    await_status(&c, "\"state\":\"playing\"");
    close_client(&c);
    end_serving(&s);
}

/* Body: what one viewer sets the others see. */
static void gravity_damping_and_stiffness_are_set(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client c = open_client(s.port), other = open_client(s.port);
    const char *hello = await_text(&c, "hello");
    assert_non_null(strstr(hello, "\"body\":{\"gravity\":[0,0,-9.81],\"gravity_varies\":false,"
                                  "\"damping\":20,\"stiffness_min\":0.1,\"stiffness_max\":4}"));
    await_status(&other, "\"body\":{\"gravity\":[0,0,-9.81],\"damping\":20,\"stiffness\":[1]}");
    say(&c, "{\"do\":\"gravity\",\"to\":[1,0,-2.5]}");
    say(&c, "{\"do\":\"damping\",\"value\":150}");
    say(&c, "{\"do\":\"stiffness\",\"value\":2.5}");
    await_status(&other, "\"body\":{\"gravity\":[1,0,-2.5],\"damping\":150,\"stiffness\":[2.5]}");
    await_status(&other, "\"step_parts\":");
    say(&other, "{\"do\":\"stiffness\",\"value\":0.5,\"material\":0}");
    await_status(&c, "\"stiffness\":[0.5]");
    say(&c, "{\"do\":\"stiffness\",\"value\":9}");
    assert_non_null(strstr(await_text(&c, "note"), "0.1 to 4"));
    say(&c, "{\"do\":\"stiffness\",\"value\":1,\"material\":7}");
    assert_non_null(strstr(await_text(&c, "note"), "no material 7"));
    say(&c, "{\"do\":\"gravity\"}");
    say(&c, "{\"do\":\"damping\"}");
    say(&c, "{\"do\":\"stiffness\"}");
    await_status(&other, "\"body\":{\"gravity\":[0,0,-9.81],\"damping\":20,\"stiffness\":[1]}");
    close_client(&c);
    close_client(&other);
    end_serving(&s);
}

/* Who comes after a while without viewers is not told of long ago. */
static void first_status_is_fresh(void **unused) {
    (void)unused;
    served s = serve(NULL);
    lar_session_status now;
    nap(0.3);
    lar_session_status_get(s.b.session, &now);
    assert_true(now.step > 0);
    client c = open_client(s.port);
    assert_true(number_of(await_text(&c, "status"), "step") >= (double)now.step);
    close_client(&c);
    end_serving(&s);
}

/* The folder takes so much and no more: a recording ends there, and then nothing is saved. */
static void saves_as_much_as_it_may(void **unused) {
    (void)unused;
    char folder[256];
    snprintf(folder, sizeof folder, "%s/server-quota-%d", LAR_TEST_BUILD, (int)getpid());
    served s = serve_with(NULL, &(lar_server_options){.save_folder = folder, .save_max = 40000});
    client c = open_client(s.port);
    await_text(&c, "hello");
    say(&c, "{\"do\":\"record\",\"on\":true}");
    await_status(&c, "\"recording\":true");
    char other[300]; /* fills it from elsewhere, as a long recording would */
    snprintf(other, sizeof other, "%s/old-1.checkpoint", folder);
    FILE *file = fopen(other, "w");
    assert_non_null(file);
    assert_int_equal(ftruncate(fileno(file), 50000), 0);
    fclose(file);
    assert_non_null(strstr(await_text(&c, "note"), "the recording has ended"));
    await_status(&c, "\"recording\":false");
    nap(0.6);
    say(&c, "{\"do\":\"save\"}");
    assert_non_null(strstr(await_text(&c, "note"), "as much as they may"));
    close_client(&c);
    end_serving(&s);
}

static void saves_where_it_may(void **unused) {
    (void)unused;
    char folder[256];
    snprintf(folder, sizeof folder, "%s/server-saves-%d/below", LAR_TEST_BUILD, (int)getpid());
    served s = serve_with(NULL, &(lar_server_options){.save_folder = folder});
    client c = open_client(s.port);
    assert_non_null(strstr(await_text(&c, "hello"), "\"saves\":true"));
    say(&c, "{\"do\":\"load\"}");
    assert_non_null(strstr(await_text(&c, "note"), "no saved state"));
    say(&c, "{\"do\":\"save\"}");
    assert_non_null(strstr(await_text(&c, "saved"), "\"name\":\"model-1.checkpoint\""));
    nap(0.6);
    for (int i = 0; i < 20; i++) say(&c, "{\"do\":\"save\"}"); /* the first of them is done */
    assert_non_null(strstr(await_text(&c, "note"), "too often"));
    await_status(&c, "\"saved\":[\"model-1.checkpoint\",\"model-2.checkpoint\"");
    uint64_t before = (uint64_t)number_of((char *)c.data, "step");
    say(&c, "{\"do\":\"pause\"}");
    await_status(&c, "\"state\":\"paused\"");
    say(&c, "{\"do\":\"load\",\"name\":\"model-1.checkpoint\"}");
    for (int i = 0; i < 50; i++)
        if (number_of(await_text(&c, "status"), "step") < (double)before) break;
    assert_true(number_of((char *)c.data, "step") < (double)before);
    /* Only what was saved here has a name. */
    say(&c, "{\"do\":\"load\",\"name\":\"../../etc/passwd\"}");
    assert_non_null(strstr(await_text(&c, "note"), "no saved state"));
    say(&c, "{\"do\":\"play\"}");
    nap(0.6);
    say(&c, "{\"do\":\"record\",\"on\":true}");
    await_status(&c, "\"recording\":true");
    say(&c, "{\"do\":\"record\",\"on\":false}");
    while (!strstr(await_text(&c, "saved"), ".recording\"")) continue; /* others may still come */
    await_status(&c, "\"recording\":false");
    close_client(&c);
    end_serving(&s);

    s = serve(NULL); /* without a folder */
    c = open_client(s.port);
    say(&c, "{\"do\":\"save\"}");
    assert_non_null(strstr(await_text(&c, "note"), "--save-folder"));
    say(&c, "{\"do\":\"record\",\"on\":true}");
    assert_non_null(strstr(await_text(&c, "note"), "--save-folder"));
    close_client(&c);
    end_serving(&s);
}

static void shows_why_it_stopped_and_begins_again(void **unused) {
    (void)unused;
    served s = {.b = {.model = served_model()}};
    s.b.model->gravity[2] = -1e5; /* breaks it within some milliseconds */
    s.b.simulation = served_simulation(s.b.model, NULL);
    DONE(lar_session_open(s.b.simulation, NULL, &s.b.session, &failure));
    DONE(lar_server_open(s.b.session, s.b.model, NULL, &s.server, &failure));
    DONE(lar_session_start(s.b.session, &failure));
    client c = open_client(port_of(s.server));
    await_status(&c, "\"state\":\"stopped\"");
    assert_null(strstr((char *)c.data, "\"message\":\"\""));
    double ticks = number_of((char *)c.data, "ticks");
    /* A picture of the last state, or a word that there is none. */
    say(&c, "{\"do\":\"frame\",\"field\":\"pressure\"}");
    bool answered = false;
    for (int i = 0; i < 50 && !answered && next_frame(&c); i++)
        answered = (c.opcode == BINARY_FRAME && word_at(&c, 0) == 2) ||
                   strstr((char *)c.data, "no_frame") != NULL;
    assert_true(answered);
    say(&c, "{\"do\":\"play\"}"); /* takes nothing up */
    say(&c, "{\"do\":\"reset\"}");
    for (int i = 0; i < 100; i++)
        if (number_of(await_text(&c, "status"), "ticks") > ticks) break;
    assert_true(number_of((char *)c.data, "ticks") > ticks);
    await_status(&c, "\"state\":\"stopped\"");
    close_client(&c);
    end_serving(&s);
}

static void tells_when_it_ends(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client c = open_client(s.port);
    await_text(&c, "status");
    lar_server_close(s.server);
    s.server = NULL;
    assert_int_equal(await_close(&c), 1001);
    close_client(&c);
    end_serving(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(says_hello_and_shows_the_surface),
                                       cmocka_unit_test(bodies_and_processors_are_told_apart),
                                       cmocka_unit_test(pictures_are_of_one_step),
                                       cmocka_unit_test(one_frame_is_under_way_at_most),
                                       cmocka_unit_test(pulls_and_lets_go),
                                       cmocka_unit_test(hands_are_handed_out),
                                       cmocka_unit_test(instruments_have_one_owner),
                                       cmocka_unit_test(a_reset_takes_instruments_out_of_hands),
                                       cmocka_unit_test(a_tool_that_tissue_stops_says_so),
                                       cmocka_unit_test(plays_pauses_steps_and_resets),
                                       cmocka_unit_test(gravity_damping_and_stiffness_are_set),
                                       cmocka_unit_test(first_status_is_fresh),
                                       cmocka_unit_test(saves_as_much_as_it_may),
                                       cmocka_unit_test(saves_where_it_may),
                                       cmocka_unit_test(shows_why_it_stopped_and_begins_again),
                                       cmocka_unit_test(tells_when_it_ends)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
