/* Slices of a scan reach viewers as they lie in the image: docs/viewer-protocol.md, message 5. */
#include "session/session_test.h"

#include "session/server_test.h"

#include "meshing/image_file.h"

#define SCAN LAR_TEST_BUILD "/server_scan.nrrd"

enum { NI = 5, NJ = 4, NK = 3 };

static int label_of(int i, int j, int k) {
    return 100 * i + 10 * j + k;
}

/* Oblique, so that no axis is the world's. */
static int write_scan_file(void **unused) {
    (void)unused;
    static const char *const names[] = {"liver", "left kidney"};
    uint16_t label[NI * NJ * NK];
    lar_image image = {
        .size = {NI, NJ, NK},
        .to_world = {{1e-3, 0, 2e-3, -0.01}, {0, 2e-3, 0, 0.02}, {-2e-3, 0, 1e-3, 0.3}},
        .label = label};
    for (int k = 0; k < NK; k++)
        for (int j = 0; j < NJ; j++)
            for (int i = 0; i < NI; i++) label[i + NI * (j + NJ * k)] = (uint16_t)label_of(i, j, k);
    image_file(&image, SCAN, names, 2);
    return 0;
}

static float float_at(const client *c, size_t offset) {
    uint32_t word = word_at(c, offset);
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

static uint16_t pixel(const client *c, int width, int x, int y) {
    uint16_t value;
    memcpy(&value, c->data + 72 + 2 * (width * y + x), sizeof value);
    return value;
}

static void slices_are_those_of_the_image(void **unused) {
    (void)unused;
    static const int size[3] = {NI, NJ, NK};
    served s = serve_with(NULL, &(lar_server_options){.scan = SCAN});
    client c = open_client_at(s.port, "/socket?watch=1");
    const char *hello = await_text(&c, "hello");
    assert_non_null(
        strstr(hello, "\"scan\":{\"size\":[5,4,3],\"labels\":[{\"label\":1,\"name\":\"liver\"}"));
    for (int axis = 0; axis < 3; axis++) {
        int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2, index = size[axis] - 1;
        char text[64];
        snprintf(text, sizeof text, "{\"do\":\"slice\",\"axis\":%d,\"index\":%d}", axis, index);
        say(&c, text);
        await_binary(&c, 5);
        const uint32_t head[] = {(uint32_t)axis, (uint32_t)index, (uint32_t)size[axis],
                                 (uint32_t)size[u], (uint32_t)size[v]};
        for (size_t i = 0; i < 5; i++) assert_int_equal(word_at(&c, 4 + 4 * i), head[i]);
        assert_int_equal(c.length, 72 + (2 * (size_t)(size[u] * size[v]) + 3) / 4 * 4);
        for (int y = 0; y < size[v]; y++)
            for (int x = 0; x < size[u]; x++) {
                int at[3];
                at[axis] = index;
                at[u] = x;
                at[v] = y;
                assert_int_equal(pixel(&c, size[u], x, y), label_of(at[0], at[1], at[2]));
            }
        /* Where the last pixel lies, by the head, and by the image. */
        int last[3];
        last[axis] = index;
        last[u] = size[u] - 1;
        last[v] = size[v] - 1;
        const double world[3] = {1e-3 * last[0] + 2e-3 * last[2] - 0.01, 2e-3 * last[1] + 0.02,
                                 -2e-3 * last[0] + 1e-3 * last[2] + 0.3};
        for (size_t i = 0; i < 3; i++) {
            float place = float_at(&c, 32 + 4 * i) + (float)last[u] * float_at(&c, 44 + 4 * i) +
                          (float)last[v] * float_at(&c, 56 + 4 * i);
            assert_below(fabs((double)place - world[i]), 1e-7);
        }
    }
    say(&c, "{\"do\":\"slice\",\"axis\":1,\"index\":4}");
    assert_non_null(strstr(await_text(&c, "note"), "5 x 4 x 3"));
    say(&c, "{\"do\":\"slice\",\"axis\":3,\"index\":0}");
    assert_int_equal(await_close(&c), 1008);
    close_client(&c);
    end_serving(&s);
}

static void without_a_scan_a_sentence_says_so(void **unused) {
    (void)unused;
    served s = serve(NULL);
    client c = open_client(s.port);
    assert_null(strstr(await_text(&c, "hello"), "\"scan\""));
    say(&c, "{\"do\":\"slice\",\"axis\":0,\"index\":0}");
    assert_non_null(strstr(await_text(&c, "note"), "--scan"));
    close_client(&c);
    lar_server *other = NULL;
    lar_error error;
    assert_int_equal(lar_server_open(s.b.session, s.b.model,
                                     &(lar_server_options){.scan = "/nonexistent.nii"}, &other,
                                     &error),
                     LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "/nonexistent.nii"));
    end_serving(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(slices_are_those_of_the_image),
                                       cmocka_unit_test(without_a_scan_a_sentence_says_so)};
    return cmocka_run_group_tests(tests, write_scan_file, NULL);
}
