/* The JSON writer: escapes, numbers that come back with the same bits, no NaN, commas. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cli/report/json.h"

typedef struct page {
    char *text;
    size_t size;
    json_writer json;
} page;

static void open_page(page *p) {
    FILE *out = open_memstream(&p->text, &p->size);
    assert_non_null(out);
    p->json = json_begin(out);
}

/* Ends the object and leaves its text without blanks and line ends. */
static const char *close_page(page *p) {
    json_end(&p->json);
    fclose(p->json.out);
    char *to = p->text;
    for (const char *from = p->text; *from; from++)
        if (*from != ' ' && *from != '\n') *to++ = *from;
    *to = '\0';
    return p->text;
}

static void nothing_is_an_empty_object(void **state) {
    (void)state;
    page p;
    open_page(&p);
    assert_string_equal(close_page(&p), "{}");
    free(p.text);
}

static void values_nest_with_commas_between(void **state) {
    (void)state;
    page p;
    open_page(&p);
    json_integer(&p.json, "a", -7);
    json_open(&p.json, "b", '{');
    json_close(&p.json);
    json_open(&p.json, "c", '[');
    json_boolean(&p.json, NULL, true);
    json_open(&p.json, NULL, '{');
    json_boolean(&p.json, "d", false);
    assert_string_equal(close_page(&p), "{\"a\":-7,\"b\":{},\"c\":[true,{\"d\":false}]}");
    free(p.text);
}

static void what_is_no_number_is_null(void **state) {
    (void)state;
    page p;
    open_page(&p);
    json_number(&p.json, "a", NAN);
    json_number(&p.json, "b", -INFINITY);
    json_vector(&p.json, "c", (const double[3]){1, INFINITY, 0.5});
    assert_string_equal(close_page(&p), "{\"a\":null,\"b\":null,\"c\":[1,null,0.5]}");
    free(p.text);
}

static void numbers_come_back_with_the_same_bits(void **state) {
    (void)state;
    static const double values[] = {0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308, -2.5e-17};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        page p;
        open_page(&p);
        json_number(&p.json, "a", values[i]);
        double back = strtod(strchr(close_page(&p), ':') + 1, NULL);
        assert_memory_equal(&back, &values[i], sizeof back);
        free(p.text);
    }
}

static void text_is_escaped(void **state) {
    (void)state;
    page p;
    open_page(&p);
    json_text(&p.json, "a\"", "\"\\\n\t\x01/\x7f");
    assert_string_equal(close_page(&p), "{\"a\\\"\":\"\\\"\\\\\\n\\u0009\\u0001/\\u007f\"}");
    free(p.text);
}

/* Good: two, three and four bytes. Bad: a lone continuation, a cut sequence, an overlong slash, a
 * surrogate, a byte that never occurs. */
static void bytes_that_are_no_utf8_are_replaced(void **state) {
    (void)state;
    static const struct {
        const char *given, *written;
    } sample[] = {{"\xc3\xbc", "\xc3\xbc"},
                  {"\xe2\x82\xac", "\xe2\x82\xac"},
                  {"\xf0\x9f\x98\x80", "\xf0\x9f\x98\x80"},
                  {"a\x80", "a\\ufffd"},
                  {"\xe2\x82", "\\ufffd\\ufffd"},
                  {"\xc0\xaf", "\\ufffd\\ufffd"},
                  {"\xed\xa0\x80", "\\ufffd\\ufffd\\ufffd"},
                  {"\xff", "\\ufffd"}};
    for (size_t i = 0; i < sizeof sample / sizeof sample[0]; i++) {
        char expected[64];
        snprintf(expected, sizeof expected, "{\"a\":\"%s\"}", sample[i].written);
        page p;
        open_page(&p);
        json_text(&p.json, "a", sample[i].given);
        assert_string_equal(close_page(&p), expected);
        free(p.text);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_is_an_empty_object),
                                       cmocka_unit_test(values_nest_with_commas_between),
                                       cmocka_unit_test(what_is_no_number_is_null),
                                       cmocka_unit_test(numbers_come_back_with_the_same_bits),
                                       cmocka_unit_test(text_is_escaped),
                                       cmocka_unit_test(bytes_that_are_no_utf8_are_replaced)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
