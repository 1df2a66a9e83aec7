/* Which slow motion it is, and what would help. */
#include <string.h>

#include "session/advice.h"
#include "testing.h"

static const lar_advice organ = {
    .time_step = 1e-4, .elements = 13000, .busy = 1, .cores = 4, .priority = 0};

static lar_session_status slow(const lar_advice *advice, double pace, double min, int parts) {
    lar_session_status status = {.slow_motion = 1, .step_min = min, .step_parts = parts};
    lar_advise(advice, pace, &status);
    return status;
}

static void has(const lar_session_status *status, const char *words) {
    if (!strstr(status->slow_advice, words)) fail_msg("no '%s' in: %s", words, status->slow_advice);
}

static void a_step_that_is_too_long_names_grid_and_elements(void **unused) {
    (void)unused;
    lar_session_status s = slow(&organ, 1, 1.17e-4, 1);
    assert_int_equal(s.slow_cause, LAR_SLOW_STEP);
    has(&s, "a step takes 117 us and stands for 100 us of the clock");
    has(&s, "--grid 2x1x1, ");
    has(&s, "a mesh of about 10000 elements");
    has(&s, "a slower pace");
    s = slow(&organ, 1, 2.5e-4, 1);
    has(&s, "--grid 2x2x1, ");
    s = slow(&organ, 0.5, 2.5e-4, 1);
    has(&s, "stands for 200 us");
    has(&s, "--grid 2x1x1, ");
    /* No grid where there are no cores for it. */
    s = slow(&organ, 1, 9e-4, 1);
    has(&s, "what would hold: a mesh of about 1300 elements");
    /* No mesh that is another model: the pace that would hold. */
    s = slow(&organ, 1, 1e-3, 1);
    has(&s, "what would hold: a pace of 0.085");
    lar_advice few = organ;
    few.elements = 27;
    s = slow(&few, 1, 1.6e-4, 1);
    has(&s, "what would hold: --grid 3x1x1, or a pace of 0.53");
    /* Five times as slow as steps alone would make it. */
    lar_session_status busy = {
        .slow_motion = 1, .step_min = 2e-4, .step_parts = 1, .real_time_factor_now = 0.09};
    lar_advise(&organ, 1, &busy);
    has(&busy, "a slower pace; and other programs keep the processor busy");
    busy.real_time_factor_now = 0.44;
    lar_advise(&organ, 1, &busy);
    assert_null(strstr(busy.slow_advice, "other programs"));
    lar_advice full = organ;
    full.busy = 4;
    s = slow(&full, 1, 1.17e-4, 1);
    assert_null(strstr(s.slow_advice, "--grid"));
}

static void strained_tissue_is_named(void **unused) {
    (void)unused;
    lar_advice held = organ;
    held.touched = true;
    lar_session_status s = slow(&held, 1, 1.6e-4, 4);
    assert_int_equal(s.slow_cause, LAR_SLOW_DIVISION);
    has(&s, "divided by 4");
    has(&s, "tissue is strained or tools press hard; let go, or pull, press and load it less");
    s = slow(&organ, 1, 1.6e-4, 4); /* nobody has it in hand */
    has(&s, "divided by 4 while tissue is strained; load it less, or choose a slower pace");
    lar_advice stiffer = organ;
    stiffer.stiffer = 4;
    s = slow(&stiffer, 1, 1.6e-4, 4);
    has(&s, "divided by 4 because the body was made stiffer");
    stiffer.stiffer = 2; /* strained besides */
    s = slow(&stiffer, 1, 1.6e-4, 4);
    has(&s, "tissue is strained");
    s = slow(&organ, 1, 1.6e-3, 4); /* too long undivided, too */
    assert_int_equal(s.slow_cause, LAR_SLOW_STEP);
}

static void a_busy_machine_is_named(void **unused) {
    (void)unused;
    lar_session_status s = slow(&organ, 1, 2.4e-5, 1);
    assert_int_equal(s.slow_cause, LAR_SLOW_MACHINE);
    has(&s, "24 us of the 100 us");
    has(&s, "--priority 10");
    lar_advice urgent = organ;
    urgent.priority = 5;
    s = slow(&urgent, 1, 2.4e-5, 1);
    assert_null(strstr(s.slow_advice, "--priority"));
}

/* Several processors wait for the one whose core is taken: one alone may do, where it is fast
 * enough. Whatever is said fits. */
static void one_processor_is_named_where_it_is_enough(void **unused) {
    (void)unused;
    lar_advice two = organ;
    two.processors = two.busy = 2;
    lar_session_status s = slow(&two, 1, 2.4e-5, 1);
    has(&s,
        "end them, or try --grid 1x1x1: it may hold beside a browser that draws in software, or "
        "try --priority 10");
    two.priority = 5;
    s = slow(&two, 1, 2.4e-5, 1);
    has(&s, "draws in software");
    assert_null(strstr(s.slow_advice, "--priority"));
    s = slow(&two, 1, 6e-5, 1); /* alone it would take 96 of the 90 us that there are */
    assert_null(strstr(s.slow_advice, "--grid"));
    lar_advice threads = organ; /* of one processor */
    threads.processors = 1, threads.busy = 2;
    s = slow(&threads, 1, 2.4e-5, 1);
    assert_null(strstr(s.slow_advice, "--grid"));
    s = slow(&organ, 1, 2.213e-3, 1);
    has(&s, "a step takes 2.21 ms and stands for 100 us of the clock");
    s = slow(&organ, 100, 9.999e-4, 1);
    has(&s, "a step takes 1 ms and stands for 1 us of the clock");
}

static void without_slow_motion_or_knowledge_there_is_none(void **unused) {
    (void)unused;
    lar_session_status s = slow(&organ, 1, 0, 1);
    assert_int_equal(s.slow_cause, LAR_SLOW_NOT);
    assert_string_equal(s.slow_advice, "");
    s = (lar_session_status){.step_min = 1, .slow_cause = LAR_SLOW_STEP, .slow_advice = "x"};
    lar_advise(&organ, 1, &s);
    assert_int_equal(s.slow_cause, LAR_SLOW_NOT);
    assert_string_equal(s.slow_advice, "");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_that_is_too_long_names_grid_and_elements),
        cmocka_unit_test(strained_tissue_is_named), cmocka_unit_test(a_busy_machine_is_named),
        cmocka_unit_test(one_processor_is_named_where_it_is_enough),
        cmocka_unit_test(without_slow_motion_or_knowledge_there_is_none)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
