/* JSON. The writer: escapes, numbers that come back with the same bits, no NaN, commas. The reader:
 * what is JSON and what is not, texts, values by name. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/json/write.h"
#include "base/json/read.h"

typedef struct page {
    char *text;
    size_t size;
    lar_json json;
} page;

static void open_page(page *p) {
    FILE *out = open_memstream(&p->text, &p->size);
    assert_non_null(out);
    p->json = lar_json_to(out);
}

/* Ends the object and leaves its text without blanks and line ends. */
static const char *close_page(page *p) {
    lar_json_end(&p->json);
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
    lar_json_integer(&p.json, "a", -7);
    lar_json_open(&p.json, "b", '{');
    lar_json_close(&p.json);
    lar_json_open(&p.json, "c", '[');
    lar_json_boolean(&p.json, NULL, true);
    lar_json_open(&p.json, NULL, '{');
    lar_json_boolean(&p.json, "d", false);
    assert_string_equal(close_page(&p), "{\"a\":-7,\"b\":{},\"c\":[true,{\"d\":false}]}");
    free(p.text);
}

static void what_is_no_number_is_null(void **state) {
    (void)state;
    page p;
    open_page(&p);
    lar_json_number(&p.json, "a", NAN);
    lar_json_number(&p.json, "b", -INFINITY);
    lar_json_vector(&p.json, "c", (const double[3]){1, INFINITY, 0.5}, 3);
    assert_string_equal(close_page(&p), "{\"a\":null,\"b\":null,\"c\":[1,null,0.5]}");
    free(p.text);
}

static void numbers_come_back_with_the_same_bits(void **state) {
    (void)state;
    static const double values[] = {0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308, -2.5e-17};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        page p;
        open_page(&p);
        lar_json_number(&p.json, "a", values[i]);
        double back = strtod(strchr(close_page(&p), ':') + 1, NULL);
        assert_memory_equal(&back, &values[i], sizeof back);
        free(p.text);
    }
}

static void text_is_escaped(void **state) {
    (void)state;
    page p;
    open_page(&p);
    lar_json_text(&p.json, "a\"", "\"\\\n\t\x01/\x7f");
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
        lar_json_text(&p.json, "a", sample[i].given);
        assert_string_equal(close_page(&p), expected);
        free(p.text);
    }
}

/* ---- reading -------------------------------------------------------------------------------- */

/* In memory of exactly its size. */
static bool is_whole(const char *text, size_t length) {
    char *exact = malloc(length ? length : 1);
    assert_non_null(exact);
    memcpy(exact, text, length);
    lar_json_reader reader = {exact, exact + length};
    bool whole = lar_json_is_whole(&reader);
    assert_true(reader.at >= exact && reader.at <= exact + length);
    free(exact);
    return whole;
}

static void json_and_nothing_else_is_whole(void **state) {
    (void)state;
    static const char *const good[] = {"{}",
                                       " [ ] ",
                                       "null",
                                       "-0.5e+3",
                                       "\"\\ud83d\\ude00 \\u00e4 \\n\"",
                                       "[true,false,null,{\"a\":[[],{}]},\"\"]",
                                       "{\"a\":1,\"b\":{\"c\":[1, 2 ,3]}}\r\n"};
    static const char *const wrong[] = {
        "",          " ",     "{",     "}",       "[1,]",        "[,1]",    "{\"a\":1,}",
        "{\"a\" 1}", "{a:1}", "{1:1}", "[1 2]",   "[1}",         "{\"a\"]", "nul",
        "truefalse", "01",    "+1",    "1.",      ".5",          "1e",      "0x1",
        "NaN",       "1e999", "\"a",   "\"\\x\"", "\"\\u00g0\"", "\"\t\"",  "\"\xff\"",
        "{} {}",     "[1]\"", "--1",   "\"\\u12", "[\"\\\"]",    "'a'",     "// a\n1"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        if (!is_whole(good[i], strlen(good[i]))) fail_msg("refused: %s", good[i]);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        if (is_whole(wrong[i], strlen(wrong[i]))) fail_msg("taken: %s", wrong[i]);
    assert_false(is_whole("1\0", 2));
    for (size_t length = 0; length < strlen(good[5]); length++)
        assert_false(is_whole(good[5], length));
}

static void nesting_is_bounded(void **state) {
    (void)state;
    char text[300];
    for (size_t depth = 1; depth < 150; depth++) {
        memset(text, '[', depth);
        memset(text + depth, ']', depth);
        assert_int_equal(is_whole(text, 2 * depth), depth <= 64);
        assert_false(is_whole(text, depth));
    }
}

static void texts_are_decoded_and_cut(void **state) {
    (void)state;
    static const char text[] = "\"a\\\"\\/\\u00e4\\u20ac\\ud83d\\ude00\\u0000\\ud800x\"";
    static const char meant[] = "a\"/\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80\xef\xbf\xbd\xef\xbf\xbdx";
    char found[64], cut[4];
    size_t length = 0;
    lar_json_reader reader = {text, text + strlen(text)};
    assert_true(lar_json_take_string(&reader, found, sizeof found, &length));
    assert_string_equal(found, meant);
    assert_int_equal(length, strlen(meant));
    reader.at = text;
    assert_true(lar_json_take_string(&reader, cut, sizeof cut, &length));
    assert_memory_equal(cut, "a\"/", 4);
    assert_int_equal(length, strlen(meant));
}

static void values_are_found_by_name(void **state) {
    (void)state;
    static const char text[] =
        "{\"other\": {\"a\": 1}, \"a\": {\"b\": \"x\"}, \"list\": [1, [2], \"3\"], \"n\": null}";
    const lar_json_reader root = {text, text + strlen(text)};
    char found[8];
    lar_json_reader a = lar_json_member(root, "a");
    assert_true(lar_json_scalar(lar_json_member(a, "b"), found, sizeof found));
    assert_string_equal(found, "x");
    assert_true(lar_json_scalar(lar_json_member(root, "n"), found, 3));
    assert_string_equal(found, "nu");
    assert_false(lar_json_scalar(a, found, sizeof found));
    assert_null(lar_json_member(a, "a").at);
    assert_null(lar_json_member(lar_json_member(a, "b"), "c").at);
    assert_null(lar_json_member(lar_json_member(a, "none"), "c").at);
    assert_false(lar_json_scalar(lar_json_member(root, "none"), found, sizeof found));
    lar_json_reader list = lar_json_member(root, "list"), element;
    int count = 0;
    assert_true(lar_json_take(&list, '['));
    while (lar_json_element(&list, &element))
        count += lar_json_scalar(element, found, sizeof found) ? 1 : 10;
    assert_int_equal(count, 12);
    assert_string_equal(found, "3");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_is_an_empty_object),
                                       cmocka_unit_test(values_nest_with_commas_between),
                                       cmocka_unit_test(what_is_no_number_is_null),
                                       cmocka_unit_test(numbers_come_back_with_the_same_bits),
                                       cmocka_unit_test(text_is_escaped),
                                       cmocka_unit_test(bytes_that_are_no_utf8_are_replaced),
                                       cmocka_unit_test(json_and_nothing_else_is_whole),
                                       cmocka_unit_test(nesting_is_bounded),
                                       cmocka_unit_test(texts_are_decoded_and_cut),
                                       cmocka_unit_test(values_are_found_by_name)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
