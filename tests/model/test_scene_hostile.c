/* Scenes that mean harm: too deep, too many, cut off, garbage. */
#include "model/wrong_scene.h"

static void hostile(const char *text, size_t size, const char *words) {
    lar_error error = {0};
    assert_int_not_equal(parse(text, size, &error), LAR_OK);
    assert_int_equal(strncmp(error.message, "s.yaml:", 7), 0);
    if (!strstr(error.message, words)) fail_msg("\"%s\" lacks \"%s\"", error.message, words);
}

static void test_bounds(void **state) {
    (void)state;
    enum { SIZE = 1 << 20 };
    char *text = malloc(SIZE + 64);
    assert_non_null(text);
    memset(text, '[', SIZE);
    hostile(text, SIZE, "s.yaml:1:33: lists and mappings stand more than 32 deep");
    for (int i = 0; i < SIZE; i++) text[i] = i % 2 ? ' ' : '-';
    hostile(text, SIZE, "more than 32 deep");
    memset(text, '{', SIZE);
    hostile(text, SIZE, "s.yaml:1:");
    size_t used = (size_t)sprintf(text, "fix: [");
    for (; used < SIZE; used++) text[used] = used % 2 ? ',' : '1';
    hostile(text, SIZE, "not YAML");
    used = 0;
    for (int i = 0; used + 16 < SIZE; i++) used += (size_t)sprintf(text + used, "k%d: 1\n", i);
    hostile(text, used, "s.yaml:101:1: this mapping has more than 100 keys");
    free(text);
    const size_t entries = 1000001;
    char *many = malloc(2 * entries + 64);
    assert_non_null(many);
    used = (size_t)sprintf(many, "fix:\n [");
    for (size_t i = 0; i < entries; i++) many[used++] = '1', many[used++] = ',';
    many[used++] = ']';
    hostile(many, used, "more than 1000000 values");
    free(many);
}

static void test_alias_bomb(void **state) {
    (void)state;
    const char *bomb = "a: &a [x,x,x,x,x,x,x,x,x]\nb: &b [*a,*a,*a,*a,*a,*a,*a,*a]\n"
                       "c: &c [*b,*b,*b,*b,*b,*b,*b,*b]\nd: [*c,*c,*c,*c,*c,*c,*c,*c]\n";
    hostile(bomb, strlen(bomb), "s.yaml:1:4: anchors");
}

static void test_garbage(void **state) {
    (void)state;
    enum { SIZE = 1 << 20 };
    char *text = malloc(SIZE);
    assert_non_null(text);
    uint64_t random = 12345;
    for (int kind = 0; kind < 3; kind++) {
        for (int i = 0; i < SIZE; i++) {
            random = random * 6364136223846793005ULL + 1442695040888963407ULL;
            unsigned byte = (unsigned)(random >> 56);
            text[i] = kind == 0   ? (char)byte
                      : kind == 1 ? (char)(' ' + byte % 95)
                                  : "ab: -[]{},\n #'\"&*!|>?%@"[byte % 23];
        }
        hostile(text, SIZE, "s.yaml:");
    }
    free(text);
}

/* Every beginning of a good scene is refused or read, and nothing else happens. */
static void test_prefixes(void **state) {
    (void)state;
    const char *good =
        BASE "title: \"\xc3\xa4\"\nscale: 1\nsets:\n"
             "  - {name: a, nodes: {all: [{box: [[0, 0, 0], [1, 1, 0.01]]}, {not: {tag: 2}}]}}\n"
             "  - {name: b, faces: {any: [lid, {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}]}}\n"
             "fix: [{nodes: a, axes: xyz}]\n"
             "move: [{nodes: {nearest: [0, 0, 1]}, axes: x, by: 0.1, over: 0.1}]\n"
             "load:\n- {nodes: lid, force: [0, 0, 1], over: 1}\n"
             "- faces: b\n  pressure: 5\n  curve:\n    points: [[0, 0], [1, 2]]\n    shape: step\n"
             "initial: [{nodes: all, velocity: [0, 0, 1]}]\n"
             "output:\n  every: 0.1\n  fields: [energy]\n"
             "  probes: [{node: 3}, {set: a, sum: reaction, name: r}]\nduration: 1\n";
    size_t size = strlen(good);
    lar_error error = {0};
    if (parse(good, size, &error)) fail_msg("%s", error.message);
    int accepted = 0;
    for (size_t length = 0; length < size; length++) {
        error.message[0] = '\0';
        if (parse(good, length, &error) == LAR_OK)
            accepted++;
        else if (strncmp(error.message, "s.yaml:", 7) != 0)
            fail_msg("length %zu: \"%s\"", length, error.message);
    }
    assert_true(accepted > 0 && accepted < 200);
}

static void test_error_may_be_missing(void **state) {
    (void)state;
    assert_int_equal(parse("lariat: 1\nmesh: bad.vtu\nmaterials: []\n", 38, NULL), LAR_ERROR_IO);
    assert_int_equal(parse("[", 1, NULL), LAR_ERROR_FORMAT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_alias_bomb),
        cmocka_unit_test(test_garbage),
        cmocka_unit_test(test_prefixes),
        cmocka_unit_test(test_error_may_be_missing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
