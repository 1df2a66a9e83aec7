/* What viewers may say, word by word; and what is written for them is JSON. */
#include "base/json/write.h"
#include "server/message.h"
#include "testing.h"

enum { TOOLS = 5 };

static lar_close read_text(const char *text, lar_command *command, char reason[LAR_REASON_BYTES]) {
    return lar_command_read(text, strlen(text), TOOLS, command, reason);
}

static lar_command good(const char *text) {
    lar_command command = {0};
    char reason[LAR_REASON_BYTES] = "";
    if (read_text(text, &command, reason) != LAR_CLOSE_NOT) fail_msg("%s: %s", text, reason);
    return command;
}

static void examples_of_the_page_are_understood(void **unused) {
    (void)unused;
    assert_int_equal(good("{\"do\":\"frame\"}").field, 0);
    lar_command command = good("{\"do\":\"frame\",\"field\":\"von_mises\"}");
    assert_int_equal(command.kind, LAR_COMMAND_FRAME);
    assert_int_equal(command.field, LAR_FIELD_VON_MISES);
    command = good(" { \"after\" : 51234 ,\t\"tool\":2,\r\n\"do\":\"forces\" } ");
    assert_int_equal(command.kind, LAR_COMMAND_FORCES);
    assert_true(command.after == 51234 && command.tool == 2);
    command = good("{\"do\":\"grab\",\"hand\":3,\"point\":[0.01,-2e-2,1.5E+1]}");
    assert_int_equal(command.kind, LAR_COMMAND_GRAB);
    assert_int_equal(command.hand, 3);
    assert_true(command.point[0] == 0.01 && command.point[1] == -0.02 && command.point[2] == 15);
    command = good("{\"do\":\"pull\",\"hand\":0,\"to\":[1,2,3]}");
    assert_int_equal(command.kind, LAR_COMMAND_PULL);
    assert_true(command.point[2] == 3);
    assert_int_equal(good("{\"do\":\"release\",\"hand\":0}").kind, LAR_COMMAND_RELEASE);
    command =
        good("{\"do\":\"tool\",\"tool\":4,\"position\":[0,0,0.12],\"orientation\":[0.6,0,0.8,0],"
             "\"opening\":0.5}");
    assert_int_equal(command.kind, LAR_COMMAND_TOOL);
    assert_true(command.turns && command.opens && command.opening == 0.5 &&
                command.orientation[2] == 0.8);
    command = good("{\"do\":\"tool\",\"tool\":0,\"position\":[0,0,1]}");
    assert_false(command.turns || command.opens);
    assert_int_equal(good("{\"do\":\"play\"}").kind, LAR_COMMAND_PLAY);
    assert_int_equal(good("{\"do\":\"pause\"}").kind, LAR_COMMAND_PAUSE);
    assert_true(good("{\"do\":\"step\",\"steps\":10}").steps == 10);
    assert_int_equal(good("{\"do\":\"reset\"}").kind, LAR_COMMAND_RESET);
    assert_true(good("{\"do\":\"pace\",\"value\":0.5}").pace == 0.5);
    assert_true(good("{\"do\":\"pace\",\"value\":0}").pace == 0);
    assert_true(good("{\"do\":\"record\",\"on\":true}").on);
    assert_false(good("{\"do\":\"record\",\"on\":false}").on);
    assert_int_equal(good("{\"do\":\"save\"}").kind, LAR_COMMAND_SAVE);
    assert_string_equal(good("{\"do\":\"load\"}").name, "");
    assert_string_equal(good("{\"do\":\"replay\",\"name\":\"a.recording\"}").name, "a.recording");
    assert_true(good("{\"do\":\"seek\",\"time\":1.5}").time == 1.5);
    command = good("{\"do\":\"inspect\",\"node\":7,\"energy\":true}");
    assert_true(command.node == 7 && command.face == -1 && command.energy);
    assert_int_equal(good("{\"do\":\"inspect\",\"face\":0}").face, 0);
    command = good("{\"do\":\"slice\",\"axis\":2,\"index\":40}");
    assert_true(command.axis == 2 && command.index == 40);
    assert_string_equal(good("{\"do\":\"load\",\"name\":\"uterus-1.checkpoint\"}").name,
                        "uterus-1.checkpoint");
    command = good("{\"do\":\"gravity\",\"to\":[0,0.5,-9.81]}");
    assert_int_equal(command.kind, LAR_COMMAND_GRAVITY);
    assert_true(command.valued && command.point[1] == 0.5 && command.point[2] == -9.81);
    assert_false(good("{\"do\":\"gravity\"}").valued);
    command = good("{\"do\":\"damping\",\"value\":250}");
    assert_true(command.kind == LAR_COMMAND_DAMPING && command.valued && command.value == 250);
    assert_false(good("{\"do\":\"damping\"}").valued);
    command = good("{\"do\":\"stiffness\",\"value\":0.5,\"material\":2}");
    assert_true(command.kind == LAR_COMMAND_STIFFNESS && command.valued && command.value == 0.5);
    assert_int_equal(command.material, 2);
    command = good("{\"do\":\"stiffness\"}");
    assert_true(!command.valued && command.material == -1);
    command = good("{\"do\":\"activate\",\"value\":0.25,\"material\":1}");
    assert_true(command.kind == LAR_COMMAND_ACTIVATE && command.valued && command.value == 0.25);
    assert_int_equal(command.material, 1);
    command = good("{\"do\":\"activate\"}");
    assert_true(!command.valued && command.material == -1);
    command = good("{\"do\":\"add_tool\",\"shape\":\"grasper\",\"radius\":0.003,\"length\":0.02}");
    assert_true(command.kind == LAR_COMMAND_ADD_TOOL && command.shape == LAR_TOOL_GRASPER);
    assert_true(command.radius == 0.003 && command.length == 0.02);
    command = good("{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":0.003}");
    assert_true(command.shape == LAR_TOOL_SPHERE && command.length == 0);
    command = good("{\"do\":\"remove_tool\",\"tool\":4}");
    assert_true(command.kind == LAR_COMMAND_REMOVE_TOOL && command.tool == 4);
    /* Escapes are characters like others. */
    assert_int_equal(good("{\"\\u0064o\":\"pl\\u0061y\"}").kind, LAR_COMMAND_PLAY);
}

static void everything_else_is_refused(void **unused) {
    (void)unused;
    static const struct {
        lar_close close;
        const char *text, *reason;
    } wrong[] = {
        {LAR_CLOSE_POLICY, "", "object"},
        {LAR_CLOSE_POLICY, "null", "object"},
        {LAR_CLOSE_POLICY, "[]", "object"},
        {LAR_CLOSE_POLICY, "{", "key"},
        {LAR_CLOSE_POLICY, "{}", "do is missing"},
        {LAR_CLOSE_POLICY, "{do:\"play\"}", "key"},
        {LAR_CLOSE_POLICY, "{\"do\" \"play\"}", "colon"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\"", "does not end"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\",}", "key"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\"}}", "behind"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\"} {\"do\":\"play\"}", "behind"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\",\"do\":\"play\"}", "twice"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\",\"x\":1}", "no key x"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\",\"<b>\":1}", "no key of that name"},
        {LAR_CLOSE_POLICY, "{\"do\":\"frame\",\"field\":\"nix\"}", "no field nix: none, disp"},
        {LAR_CLOSE_POLICY, "{\"do\":\"add_tool\",\"shape\":\"hand\",\"radius\":1}",
         "no shape hand: sphere"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\",\"steps\":1}", "play has no key steps"},
        {LAR_CLOSE_POLICY, "{\"do\":\"Play\"}", "no message Play"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play \"}", "no message of that name"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\\u0000\"}", "no message of that name"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pl\\x61y\"}", "do must be a string"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pl\\u00zzy\"}", "do must be a string"},
        {LAR_CLOSE_POLICY, "{\"do\":\"play\n\"}", "do must be a string"},
        {LAR_CLOSE_POLICY, "{\"do\":1}", "do must be a string"},
        {LAR_CLOSE_POLICY, "{\"do\":\"frame\",\"field\":\"velocity\"}", "no field velocity"},
        {LAR_CLOSE_POLICY, "{\"do\":\"frame\",\"field\":null}", "field must be a string"},
        {LAR_CLOSE_POLICY, "{\"do\":\"add_tool\",\"shape\":\"sphere\"}", "needs the key radius"},
        {LAR_CLOSE_POLICY, "{\"do\":\"add_tool\",\"radius\":1}", "needs the key shape"},
        {LAR_CLOSE_POLICY, "{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":1e400}", "number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"remove_tool\",\"tool\":5}", "there are 5 tools"},
        {LAR_CLOSE_POLICY, "{\"do\":\"step\"}", "step needs the key steps"},
        {LAR_CLOSE_POLICY, "{\"do\":\"step\",\"steps\":0}", "between 1 and 100000"},
        {LAR_CLOSE_POLICY, "{\"do\":\"step\",\"steps\":1.5}", "whole"},
        {LAR_CLOSE_POLICY, "{\"do\":\"step\",\"steps\":\"1\"}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"step\",\"steps\":01}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"step\",\"steps\":+1}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"step\",\"steps\":0x10}", "between"},
        {LAR_CLOSE_POLICY, "{\"do\":\"step\",\"steps\":1e999}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":NaN}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":nan}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":Infinity}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":.5}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":5.}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":5e}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":-1}", "between 0.001 and 100, or be 0"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":1e9}", "between 0.001 and 100, or be 0"},
        {LAR_CLOSE_POLICY, "{\"do\":\"damping\",\"value\":1e9}", "between 0 and 1e+06"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":101}", "between 0.001 and 100"},
        {LAR_CLOSE_POLICY, "{\"do\":\"gravity\",\"to\":[0,0]}", "array of 3"},
        {LAR_CLOSE_POLICY, "{\"do\":\"gravity\",\"to\":[0,0,-1001]}", "between -1000 and 1000"},
        {LAR_CLOSE_POLICY, "{\"do\":\"gravity\",\"value\":1}", "gravity has no key value"},
        {LAR_CLOSE_POLICY, "{\"do\":\"damping\",\"value\":-1}", "between 0 and"},
        {LAR_CLOSE_POLICY, "{\"do\":\"damping\",\"material\":1}", "damping has no key material"},
        {LAR_CLOSE_POLICY, "{\"do\":\"stiffness\",\"value\":1,\"material\":0.5}", "whole"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":1e-9}", "0.001"},
        {LAR_CLOSE_POLICY, "{\"do\":\"pace\",\"value\":[1]}", "a number"},
        {LAR_CLOSE_POLICY, "{\"do\":\"grab\",\"hand\":4,\"point\":[0,0,0]}", "between 0 and 3"},
        {LAR_CLOSE_POLICY, "{\"do\":\"grab\",\"hand\":-1,\"point\":[0,0,0]}", "between 0 and 3"},
        {LAR_CLOSE_POLICY, "{\"do\":\"grab\",\"hand\":0,\"point\":[0,0]}", "array of 3"},
        {LAR_CLOSE_POLICY, "{\"do\":\"grab\",\"hand\":0,\"point\":[0,0,0,0]}", "array of 3"},
        {LAR_CLOSE_POLICY, "{\"do\":\"grab\",\"hand\":0,\"point\":[[0,0,0]]}", "array of 3"},
        {LAR_CLOSE_POLICY, "{\"do\":\"grab\",\"hand\":0,\"point\":{\"x\":1}}", "array of 3"},
        {LAR_CLOSE_POLICY, "{\"do\":\"grab\",\"hand\":0,\"point\":[0,0,1e4]}", "between -1000"},
        {LAR_CLOSE_POLICY, "{\"do\":\"grab\",\"hand\":0,\"to\":[0,0,0]}", "needs the key point"},
        {LAR_CLOSE_POLICY, "{\"do\":\"tool\",\"tool\":5,\"position\":[0,0,0]}", "5 tools"},
        {LAR_CLOSE_POLICY, "{\"do\":\"forces\",\"tool\":9e15,\"after\":0}", "between|5 tools"},
        {LAR_CLOSE_POLICY,
         "{\"do\":\"tool\",\"tool\":0,\"position\":[0,0,0],\"orientation\":[1,1,0,0]}", "unit"},
        {LAR_CLOSE_POLICY,
         "{\"do\":\"tool\",\"tool\":0,\"position\":[0,0,0],\"orientation\":[0,0,0,0]}", "unit"},
        {LAR_CLOSE_POLICY, "{\"do\":\"tool\",\"tool\":0,\"position\":[0,0,0],\"opening\":1.1}",
         "between 0 and 1"},
        {LAR_CLOSE_POLICY, "{\"do\":\"record\",\"on\":1}", "true or false"},
        {LAR_CLOSE_POLICY, "{\"do\":\"record\",\"on\":\"true\"}", "true or false"},
        {LAR_CLOSE_POLICY, "{\"do\":\"record\",\"on\":truely}", "end|key"},
        {LAR_CLOSE_TEXT, "{\"do\":\"pl\xff\"}", "UTF-8"},
        {LAR_CLOSE_TEXT, "{\"do\":\"\xc0\xaf\"}", "UTF-8"},         /* overlong */
        {LAR_CLOSE_TEXT, "{\"do\":\"\xed\xa0\x80\"}", "UTF-8"},     /* a surrogate */
        {LAR_CLOSE_TEXT, "{\"do\":\"\xf4\x90\x80\x80\"}", "UTF-8"}, /* beyond the last */
        {LAR_CLOSE_TEXT, "{\"do\":\"\xe2\x82", "UTF-8"},            /* cut */
        {LAR_CLOSE_POLICY, "{\"do\":\"\xe2\x82\xac\"}", "no message of that name"}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        lar_command command = {.kind = LAR_COMMAND_LOAD, .steps = 77};
        char reason[LAR_REASON_BYTES] = "";
        lar_close close = read_text(wrong[i].text, &command, reason);
        if (close != wrong[i].close) fail_msg("%s: %d, %s", wrong[i].text, close, reason);
        assert_true(command.steps == 77); /* untouched */
        bool found = false;
        char words[64];
        snprintf(words, sizeof words, "%s", wrong[i].reason);
        for (char *word = strtok(words, "|"); word; word = strtok(NULL, "|"))
            found = found || strstr(reason, word);
        if (!found) fail_msg("%s: the reason is: %s", wrong[i].text, reason);
    }
}

static void long_words_are_none_of_ours(void **unused) {
    (void)unused;
    char text[LAR_MESSAGE_MAX + 2], reason[LAR_REASON_BYTES];
    lar_command command;
    memset(text, ' ', sizeof text);
    memcpy(text, "{\"do\":\"play\"}", 13);
    assert_int_equal(lar_command_read(text, LAR_MESSAGE_MAX, TOOLS, &command, reason),
                     LAR_CLOSE_NOT);
    assert_int_equal(lar_command_read(text, LAR_MESSAGE_MAX + 1, TOOLS, &command, reason),
                     LAR_CLOSE_SIZE);
    /* A name that begins like one of ours, and is longer than any. */
    for (int length = 1; length < 200; length++) {
        snprintf(text, sizeof text, "{\"do\":\"load\",\"name\":\"%0*d\"}", length, 0);
        command.name[0] = 'x';
        assert_int_equal(read_text(text, &command, reason), LAR_CLOSE_NOT);
        assert_true(strlen(command.name) ==
                    (size_t)(length < LAR_NAME_MAX ? length : LAR_NAME_MAX));
        assert_true((command.name[LAR_NAME_MAX - 1] == 0x7f) == (length > LAR_NAME_MAX));
    }
}

/* Every beginning of a message, in memory of exactly its size. */
static void beginnings_are_refused(void **unused) {
    (void)unused;
    static const char whole[] = "{\"do\":\"tool\",\"tool\":0,\"position\":[1,-2.5e1,0],"
                                "\"orientation\":[1,0,0,0],\"opening\":1}";
    for (size_t length = 0; length < strlen(whole); length++) {
        char *text = malloc(length + 1), reason[LAR_REASON_BYTES] = "";
        lar_command command;
        memcpy(text, whole, length);
        char *exact = length ? realloc(text, length) : text;
        assert_int_equal(lar_command_read(exact, length, TOOLS, &command, reason),
                         LAR_CLOSE_POLICY);
        assert_true(strlen(reason) > 0);
        free(exact);
    }
    good(whole);
}

static void json_is_written_as_it_must_be(void **unused) {
    (void)unused;
    lar_json json = {.headroom = 5};
    for (int again = 0; again < 2; again++) {
        lar_json_begin(&json);
        lar_json_text(&json, "text", "a\"\\\n\x01\xff\xe2\x82\xac");
        lar_json_text(&json, "none", NULL);
        lar_json_number(&json, "third", 1.0 / 3);
        lar_json_number(&json, "half", 0.5);
        lar_json_number(&json, "nan", NAN);
        lar_json_integer(&json, "step", INT64_MIN);
        lar_json_boolean(&json, "on", true);
        lar_json_open(&json, "list", '[');
        lar_json_open(&json, NULL, '{');
        lar_json_close(&json);
        lar_json_vector(&json, NULL, (double[]){1, INFINITY}, 2);
        lar_json_close(&json);
        lar_json_end(&json);
        assert_false(json.failed);
        assert_string_equal(
            lar_json_data(&json),
            "{\"text\":\"a\\\"\\\\\\u000a\\u0001\\ufffd\xe2\x82\xac\",\"none\":null,"
            "\"third\":0.33333333333333331,\"half\":0.5,\"nan\":null,"
            "\"step\":-9223372036854775808,\"on\":true,\"list\":[{},[1,null]]}");
        assert_true(json.length == strlen(lar_json_data(&json)));
    }
    lar_json_clear(&json);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(examples_of_the_page_are_understood),
        cmocka_unit_test(everything_else_is_refused), cmocka_unit_test(long_words_are_none_of_ours),
        cmocka_unit_test(beginnings_are_refused), cmocka_unit_test(json_is_written_as_it_must_be)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
