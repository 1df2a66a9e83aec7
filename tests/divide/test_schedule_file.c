/* Schedule files: written and read again, by hand, damaged, and whole folders of them. */
#include "testing.h"

#include <inttypes.h>
#include <sys/stat.h>
#include <unistd.h>

#include "divide/schedule/file.h"
#include "brick_mesh.h"
#include "model/demo/demo.h"
#include "same_schedule.h"

static const char folder[] = LAR_TEST_BUILD "/schedules";

/* Four cubes in a row on two processors: nodes i + 5 (j + 2 k), those at i = 2 are common. */
static const char left[] = "# the left half, by hand\n"
                           "lariat-schedule 1\r\n"
                           "grid 2x1x1\n"
                           "processor 0\n"
                           "threads 2\n"
                           "scheme all\n"
                           "channels sequential\n"
                           "mesh MESHMESHMESHMESH\n"
                           "division 0123456789abcdef\n"
                           "receive-bytes 128\n"
                           "batches 6\n"
                           "\n"
                           "thread 0 batches 3\n"
                           "batch 0\n"
                           "  recover 1  1 # at the border\n"
                           "  send 1 stage 0 offset 64\n"
                           "    add 4  2 7 12 17\n"
                           "batch 1\n"
                           "  wait 1  3\n"
                           "  receive 1 stage 0 offset 0\n"
                           "    add 3  2 7\n"
                           "\t 12\n"
                           "    whole 1  17\n"
                           "  move 8  1 2 6 7 11 12 16 17\n"
                           "batch 2\n"
                           "  wait 1  4\n"
                           "thread 1 batches 3\n"
                           "batch 3\n"
                           "  recover 1  0\n"
                           "batch 4\n"
                           "  move 4  0 5 10 15\n"
                           "  send 1 stage 1 offset 192\n"
                           "batch 5\n"
                           "  wait 1  1\n"
                           "end\n"
                           "# that was it\n";
static const char right[] = "lariat-schedule 1\n"
                            "grid 2x1x1\n"
                            "processor 1\n"
                            "threads 1\n"
                            "scheme all\n"
                            "channels sequential\n"
                            "mesh MESHMESHMESHMESH\n"
                            "division 0123456789abcdef\n"
                            "receive-bytes 256\n"
                            "batches 1\n"
                            "thread 0 batches 1\n"
                            "batch 0 recover 2 2 3\n"
                            "receive 0 stage 0 offset 64 add 4 2 7 12 17\n"
                            "receive 0 stage 1 offset 192\n"
                            "move 12 2 3 4 7 8 9 12 13 14 17 18 19\n"
                            "send 0 stage 0 offset 0 add 3 2 7 12 whole 1 17\n"
                            "end";

/* The text with its first `what` replaced; owned by the caller. */
static char *replaced(const char *text, const char *what, const char *with) {
    const char *at = strstr(text, what);
    if (!at) fail_msg("there is no '%s'", what);
    size_t before = (size_t)(at - text), size = strlen(text) + strlen(with) + 1;
    char *out = calloc(size, 1);
    snprintf(out, size, "%.*s%s%s", (int)before, text, with, at + strlen(what));
    return out;
}

static char *for_mesh(const char *text, const lar_mesh *mesh) {
    char digits[17];
    snprintf(digits, sizeof digits, "%016" PRIx64, lar_mesh_fingerprint(mesh));
    return replaced(text, "MESHMESHMESHMESH", digits);
}

static lar_status parse(const char *text, size_t size, const lar_mesh *mesh, lar_schedule *out,
                        lar_error *error) {
    /* Exactly as long as the text: a sanitizer sees every step too far. */
    lar_bytes bytes = {malloc(size + 1), size};
    memcpy(bytes.data, text, size);
    bytes.data[size] = 0;
    lar_status status = lar_schedule_parse("x.schedule", &bytes, mesh, out, error);
    lar_bytes_free(&bytes);
    return status;
}

static lar_schedule parse_good(const char *text, const lar_mesh *mesh) {
    lar_schedule s = {0};
    lar_error error = {0};
    if (parse(text, strlen(text), mesh, &s, &error)) fail_msg("%s", error.message);
    return s;
}

static void set_of(const lar_mesh *mesh, lar_schedule_set *set) {
    char *texts[2] = {for_mesh(left, mesh), for_mesh(right, mesh)};
    *set = (lar_schedule_set){2, calloc(2, sizeof *set->of)};
    for (int p = 0; p < 2; p++) {
        set->of[p] = parse_good(texts[p], mesh);
        free(texts[p]);
    }
}

static void put_file(int32_t processor, const char *text) {
    char *path = lar_schedule_path(folder, processor);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    free(path);
}

static void remove_folder(int32_t processors) {
    for (int32_t p = 0; p < processors; p++) {
        char *path = lar_schedule_path(folder, p);
        remove(path);
        free(path);
    }
    rmdir(folder);
}

/* ---- reading ---------------------------------------------------------------------------- */

static void by_hand(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1);
    char *text = for_mesh(left, &mesh);
    lar_schedule s = parse_good(text, &mesh);
    assert_int_equal(s.grid.count, 2);
    assert_int_equal(s.processor, 0);
    assert_int_equal(s.threads, 2);
    assert_int_equal(s.scheme, LAR_SCHEME_ALL);
    assert_int_equal(s.channels, LAR_CHANNELS_SEQUENTIAL);
    assert_true(s.mesh == lar_mesh_fingerprint(&mesh));
    assert_true(s.division == 0x0123456789abcdef);
    assert_int_equal(s.receive_bytes, 128);
    assert_int_equal(s.batch_count, 6);
    assert_memory_equal(s.thread_first, ((int32_t[]){0, 3, 6}), 12);
    assert_memory_equal(s.element, ((int32_t[]){1, 0}), 8);
    assert_memory_equal(s.wait, ((int32_t[]){3, 4, 1}), 12);
    assert_memory_equal(s.vector, ((int32_t[]){2, 7, 12, 17, 2, 7, 12, 17}), 32);
    const lar_batch *b = &s.batch[1];
    assert_int_equal(b->elements.count, 0);
    assert_int_equal(s.wait[b->waits.first], 3);
    assert_int_equal(b->positions.count, 8);
    assert_int_equal(s.node[b->positions.first + 7], 17);
    assert_int_equal(b->sends.count, 0);
    assert_int_equal(b->receives.count, 1);
    const lar_transfer *t = &s.transfer[b->receives.first];
    assert_int_equal(t->peer, 1);
    assert_int_equal(t->stage, 0);
    assert_int_equal(t->whole, 1);
    assert_int_equal(t->vectors.first, 4);
    assert_int_equal(t->vectors.count, 4);
    assert_int_equal(t->offset, 0);
    t = &s.transfer[s.batch[4].sends.first];
    assert_int_equal(t->stage, 1);
    assert_int_equal(t->vectors.count, 0);
    assert_int_equal(t->offset, 192);
    lar_schedule_clear(&s);
    free(text);
    lar_mesh_clear(&mesh);
}

/* What stands in `left`, what is put there instead, and what is said about it. */
static const struct {
    const char *what, *with, *says;
} damages[] = {
    {"# the", "the", "x.schedule:1: this is no schedule file"},
    {"lariat-schedule 1", "lariat-distribution 1", "x.schedule:2: this is no schedule file"},
    {"lariat-schedule 1", "lariat-schedule 2", "x.schedule:2: version 2 of the schedule file"},
    {"grid 2x1x1", "grid 2x1", "x.schedule:3: '2x1' is no grid"},
    {"grid 2x1x1\n", "", "x.schedule:3: here must stand 'grid'"},
    {"processor 0", "processor 2", "x.schedule:4: processor is 2 here"},
    {"processor 0", "processor", "x.schedule:4: here must stand 'processor'"},
    {"threads 2", "threads 0", "x.schedule:5: threads is 0 here"},
    {"threads 2", "threads 17", "x.schedule:5: threads is 17 here"},
    {"threads 2", "threads 2 2", "x.schedule:5: here must stand a number, threads, not '2 2'"},
    {"scheme all", "scheme ALL", "x.schedule:6: the scheme 'ALL' is not known; there are all, "},
    {"sequential", "parallel", "there are sequential, concurrent"},
    {"division 0123456789", "division 012345678", "x.schedule:9: behind 'division' stand 16"},
    {"division 0", "division g", "x.schedule:9: behind 'division' stand 16"},
    {"receive-bytes 128", "receive-bytes 100", "x.schedule:10: receive-bytes is 100, but"},
    {"receive-bytes 128", "receive-bytes -64", "x.schedule:10: receive-bytes is -64 here"},
    {"receive-bytes 128", "receive-bytes 64", "x.schedule:20: the packet reaches to byte 112"},
    {"receive-bytes 128", "receive-bytes 640", "x.schedule:10: receive-bytes is 640, but 128"},
    {"receive-bytes 128", "receive-bytes 9223372036854775744", "x.schedule:10: receive-bytes is"},
    {"receive-bytes 128", "receive-bytes 9223372036854775808", "x.schedule:10: here must stand"},
    {"batches 6", "batches 2000000000", "x.schedule:11: the file is too short for 2000000000 b"},
    {"batches 6", "batches 7", "x.schedule:35: the threads have 6 batches together, not the 7"},
    {"batches 6", "batches 5", "x.schedule:27: its count of batches is 3 here, but must lie"},
    {"thread 0 batches 3", "thread 1 batches 3", "x.schedule:13: the number of this thread is 1"},
    {"thread 0 batches 3", "thread 0 batch 3", "x.schedule:13: here must stand 'batches', not"},
    {"thread 0 batches 3", "thread 0 batches 4", "x.schedule:19: batch 3 is of this thread"},
    {"thread 0 batches 3", "thread 0 batches 2", "x.schedule:25: here must stand 'thread', not"},
    {"thread 1 batches 3", "thread 1 batches 2147483647", "x.schedule:27: its count of batches is"},
    {"batch 1\n", "batch 2\n", "x.schedule:18: the number of this batch is 2 here"},
    {"batch 2\n", "move 1 0\n", "x.schedule:25: the parts of a batch are"},
    {"recover 1  1", "recover 1  4", "x.schedule:15: an element is 4 here"},
    {"recover 1  1", "recover 1  -1", "x.schedule:15: an element is -1 here"},
    {"recover 1  1", "recover 1  0", "x.schedule:29: element 0 is recovered already"},
    {"recover 1  1", "recover 2  1", "x.schedule:16: here must stand a number, an element, not"},
    {"recover 1  1", "recover 2  1 1", "x.schedule:15: element 1 stands behind element 1"},
    {"recover 1  1", "recover 2  3 1", "x.schedule:15: element 1 stands behind element 3"},
    {"recover 1  1", "recover 1  1 3", "x.schedule:15: here must stand 'batch 1' or a part"},
    {"recover 1  1", "recover 0", "x.schedule:15: a count is 0 here"},
    {"recover 1  1", "recover 2000000000 1", "x.schedule:15: the file is too short for 2000"},
    {"recover 1  1", "recover 99999999999 1", "x.schedule:15: a count is 99999999999 here"},
    {"recover 1  1", "recover 1  2", "x.schedule:35: node 3 of element 2 never moves"},
    {"wait 1  3", "move 1  0 wait 1  3", "x.schedule:19: the parts of a batch are"},
    {"recover 1  1", "recover 1  1\nrecover 1 2", "x.schedule:16: the parts of a batch are"},
    {"  recover 1  0\n", "", "x.schedule:30: node 0 moves, but no element here has it"},
    {"wait 1  3", "wait 1  0", "x.schedule:19: batch 0 is of this thread, which has 0 to 2"},
    {"wait 1  3", "wait 1  6", "x.schedule:19: a batch is 6 here, but must lie between 0 and 5"},
    {"wait 1  3", "wait 2  3 3", "x.schedule:19: batch 3 is waited for already"},
    {"wait 1  1\n", "wait 2  1 5\n", "x.schedule:34: batch 5 is of this thread, which has 3"},
    {"receive 1", "receive 2", "x.schedule:20: a processor is 2 here"},
    {"receive 1", "receive 0", "x.schedule:20: processor 0 cannot exchange packets with itself"},
    {"send 1 stage 0", "send 1 stage 3", "x.schedule:16: a stage is 3 here"},
    {"send 1 stage 0", "send 1 step 0", "x.schedule:16: here must stand 'stage', not 'step'"},
    {"offset 64", "offset 65", "x.schedule:16: the offset 65 is no multiple of 64"},
    {"offset 64", "offset -64", "x.schedule:16: an offset is -64 here"},
    {"offset 64", "offset 9223372036854775744", "x.schedule:16: an offset is 9223372036854775744"},
    {"offset 64", "offset 128", "x.schedule:32: the packet lies over that of line 16, which"},
    {"offset 0", "offset 64", "x.schedule:20: the packet reaches to byte 176, but receive-bytes"},
    {"stage 1", "stage 0", "x.schedule:32: there is a packet of stage 0 to processor 1 in line 16"},
    {"add 4  2 7 12 17", "add 4  2 7 17 12", "x.schedule:17: node 12 stands behind node 17"},
    {"add 4  2 7 12 17", "add 4  2 7 12 20", "x.schedule:17: a node is 20 here"},
    {"add 4  2 7 12 17", "add 4  2 7 12 18", "x.schedule:16: node 18 is in this packet, but no"},
    {"whole 1  17", "whole 1  7", "x.schedule:23: node 7 is in this packet already"},
    {"whole 1  17", "whole 1  17 whole 1 6", "x.schedule:23: here must stand 'batch 2' or a part"},
    {"move 4  0 5", "move 4  1 5", "x.schedule:31: node 1 moves in line 24 already"},
    {"move 4  0 5", "move 4  5 0", "x.schedule:31: node 0 stands behind node 5"},
    {"move 4  0 5", "move 5  0 3 5", "x.schedule:31: node 3 moves, but no element here has it"},
    {"move 4  0 5", "move 3  5", "x.schedule:35: node 0 of element 0 never moves"},
    {"  move 4", "  moves 4", "x.schedule:31: here must stand 'batch 5' or a part of a batch, no"},
    {"end\n", "end end\n", "x.schedule:35: nothing may follow the line 'end'"},
    {"end\n", "end\nbatch 6\n", "x.schedule:36: nothing may follow the line 'end'"},
    {"end\n", "", "the file ends before its line 'end'"},
    {"end\n", "finis\n", "x.schedule:35: here must stand 'end' or a part of a batch, not 'finis'"},
};

static void damaged(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1);
    char *good = for_mesh(left, &mesh);
    for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
        char *text = replaced(good, damages[i].what, damages[i].with);
        lar_schedule s = {0};
        lar_error error = {0};
        lar_status status = parse(text, strlen(text), &mesh, &s, &error);
        if (status != LAR_ERROR_FORMAT || !strstr(error.message, damages[i].says))
            fail_msg("'%s' for '%s': %d '%s' instead of '%s'", damages[i].with, damages[i].what,
                     (int)status, error.message, damages[i].says);
        assert_null(s.batch);
        free(text);
    }
    free(good);
    lar_mesh_clear(&mesh);
}

/* The example of docs/formats.md. */
static void documented(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1);
    lar_bytes docs = {0};
    assert_int_equal(lar_bytes_read(LAR_TEST_FORMATS, &docs, NULL), LAR_OK);
    char *start = strstr((char *)docs.data, "```\nlariat-schedule 1\n");
    assert_non_null(start);
    char *stop = strstr(start += 4, "```");
    assert_non_null(stop);
    *stop = 0;
    lar_schedule s = parse_good(start, &mesh);
    assert_int_equal(s.batch_count, 6);
    lar_schedule_clear(&s);
    lar_bytes_free(&docs);
    lar_mesh_clear(&mesh);
}

static void overlapping_receives(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1);
    char *good = for_mesh(right, &mesh), *text = replaced(good, "offset 192", "offset 128");
    lar_schedule s = {0};
    lar_error error = {0};
    assert_int_equal(parse(text, strlen(text), &mesh, &s, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "x.schedule:14: the packet lies over that of line 13"));
    free(text);
    free(good);
    lar_mesh_clear(&mesh);
}

static void zero_bytes(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1);
    char *good = for_mesh(left, &mesh);
    size_t size = strlen(good);
    for (size_t at = 0; at < size; at++) {
        char kept = good[at];
        good[at] = 0;
        lar_schedule s = {0};
        lar_error error = {0};
        lar_status status = parse(good, size, &mesh, &s, &error);
        if (status != LAR_ERROR_FORMAT) fail_msg("zero at byte %zu: status %d", at, status);
        lar_schedule_clear(&s);
        good[at] = kept;
    }
    free(good);
    lar_mesh_clear(&mesh);
}

static void cut_off(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1);
    char *text = for_mesh(left, &mesh);
    size_t complete = (size_t)(strstr(text, "\nend\n") + 4 - text);
    size_t head = (size_t)(strstr(text, "thread 0") - text);
    for (size_t size = 0; size < complete; size++) {
        lar_schedule s = {0};
        lar_error error = {0};
        lar_status status = parse(text, size, &mesh, &s, &error);
        if (status != LAR_ERROR_FORMAT) fail_msg("the first %zu bytes: status %d", size, status);
        assert_non_null(strstr(error.message, "x.schedule:"));
        /* Half a number is never taken for another one. */
        if (size > head && !strstr(error.message, "the file ends before") &&
            !strstr(error.message, "the file is too short"))
            fail_msg("the first %zu bytes: %s", size, error.message);
        assert_null(s.batch);
    }
    lar_schedule s = {0};
    assert_int_equal(parse(text, complete, &mesh, &s, NULL), LAR_OK);
    lar_schedule_clear(&s);
    free(text);
    lar_mesh_clear(&mesh);
}

static void nothing_to_do(void **state) {
    (void)state;
    static const char idle[] = "lariat-schedule 1\ngrid 2x1x1\nprocessor 0\nthreads 1\nscheme all\n"
                               "channels sequential\nmesh MESHMESHMESHMESH\n"
                               "division 0123456789abcdef\nreceive-bytes 0\nbatches 1\n"
                               "thread 0 batches 1\nbatch 0\nend\n";
    lar_mesh mesh = brick_mesh(4, 1, 1);
    char *text = for_mesh(idle, &mesh);
    lar_schedule s = {0};
    lar_error error = {0};
    assert_int_equal(parse(text, strlen(text), &mesh, &s, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "x.schedule:13: processor 0 recovers no element"));
    free(text);
    lar_mesh_clear(&mesh);
}

static void another_mesh(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1), other = brick_mesh(1, 4, 1);
    char *text = for_mesh(left, &mesh);
    lar_schedule s = {0};
    lar_error error = {0};
    assert_int_equal(parse(text, strlen(text), &other, &s, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "x.schedule:8: the file was made for a mesh with other"));
    free(text);
    lar_mesh_clear(&mesh);
    lar_mesh_clear(&other);
}

/* ---- folders ---------------------------------------------------------------------------- */

static void names(void **state) {
    (void)state;
    char *path = lar_schedule_path("a/b", 4);
    assert_string_equal(path, "a/b/processor-0004.schedule");
    free(path);
    path = lar_schedule_path("a/", 1023);
    assert_string_equal(path, "a/processor-1023.schedule");
    free(path);
}

static void write_and_read(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1);
    lar_schedule_set set, again = {0};
    set_of(&mesh, &set);
    remove_folder(2);
    lar_error error = {0};
    if (lar_schedule_write(folder, &set, &error)) fail_msg("%s", error.message);
    if (lar_schedule_read_all(folder, &mesh, &again, &error)) fail_msg("%s", error.message);
    assert_int_equal(again.count, 2);
    for (int p = 0; p < 2; p++) assert_same_schedule(&set.of[p], &again.of[p]);
    /* Over the files that are there. */
    assert_int_equal(lar_schedule_write(folder, &again, NULL), LAR_OK);
    remove_folder(2);
    lar_schedule_set_clear(&set);
    lar_schedule_set_clear(&again);
    lar_mesh_clear(&mesh);
}

/* Schedules as they are built, for the demonstration organ. */
static void organ(void **state) {
    (void)state;
    lar_mesh mesh = {0};
    lar_incidence incidence = {0};
    lar_distribution d = {0};
    lar_grid grid = grid_of(2, 2, 3);
    assert_int_equal(lar_demo_mesh(&mesh, NULL), LAR_OK);
    assert_int_equal(lar_incidence_build(&mesh, &incidence, NULL), LAR_OK);
    assert_int_equal(lar_distribution_cut(&mesh, &grid, &d, NULL), LAR_OK);
    for (int way = 0; way < LAR_SCHEMES + 1; way++) {
        lar_schedule_options options = lar_schedule_options_default();
        options.threads = 2;
        options.scheme = way < LAR_SCHEMES ? (lar_scheme)way : LAR_SCHEME_LOCAL;
        if (way == LAR_SCHEMES) options.channels = LAR_CHANNELS_CONCURRENT;
        lar_schedule_set set = {0}, again = {0};
        lar_error error = {0};
        if (lar_schedule_build(&mesh, &incidence, &d, &options, &set, &error) ||
            lar_schedule_write(folder, &set, &error) ||
            lar_schedule_read_all(folder, &mesh, &again, &error))
            fail_msg("%s: %s", lar_scheme_name[options.scheme], error.message);
        assert_int_equal(again.count, grid.count);
        for (int p = 0; p < grid.count; p++) assert_same_schedule(&set.of[p], &again.of[p]);
        lar_schedule_set_clear(&set);
        lar_schedule_set_clear(&again);
    }
    remove_folder(grid.count);
    lar_distribution_clear(&d);
    lar_incidence_clear(&incidence);
    lar_mesh_clear(&mesh);
}

static void whole_or_not_at_all(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(4, 1, 1);
    lar_schedule_set set;
    set_of(&mesh, &set);
    remove_folder(2);
    mkdir(folder, 0777);
    char *path = lar_schedule_path(folder, 1), part[sizeof folder + 64];
    snprintf(part, sizeof part, "%s.part", path);
    /* A folder stands where the second file should go. */
    assert_int_equal(mkdir(path, 0777), 0);
    lar_error error = {0};
    assert_int_equal(lar_schedule_write(folder, &set, &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "processor-0001.schedule: is there and is no plain"));
    assert_int_not_equal(access(part, F_OK), 0);
    rmdir(path);
    free(path);
    remove_folder(2);
    lar_schedule_set_clear(&set);
    lar_mesh_clear(&mesh);
}

static void folders_that_do_not_fit(void **state) {
    (void)state;
    static const struct {
        const char *what, *with; /* in the file of processor 1; NULL: no such file */
        lar_status status;
        const char *says;
    } cases[] = {
        {NULL, NULL, LAR_ERROR_IO, "one such file for every processor of the grid"},
        {"grid 2x1x1", "grid 1x2x1", LAR_ERROR_FORMAT, "is of another grid than"},
        {"scheme all", "scheme one", LAR_ERROR_FORMAT, "is of another scheme than"},
        {"sequential", "concurrent", LAR_ERROR_FORMAT, "is of another use of channels than"},
        {"division 0", "division 1", LAR_ERROR_FORMAT, "is of another division than"},
        {"recover 2", "recover 3", LAR_ERROR_FORMAT, ":13: here must stand a number"},
    };
    lar_mesh mesh = brick_mesh(4, 1, 1);
    char *texts[2] = {for_mesh(left, &mesh), for_mesh(right, &mesh)};
    lar_schedule_set set = {0};
    lar_error error = {0};
    remove_folder(2);
    assert_int_equal(lar_schedule_read_all(folder, &mesh, &set, &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "processor-0000.schedule"));
    mkdir(folder, 0777);
    put_file(0, texts[0]);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (cases[i].what) {
            char *text = replaced(texts[1], cases[i].what, cases[i].with);
            put_file(1, text);
            free(text);
        }
        assert_int_equal(lar_schedule_read_all(folder, &mesh, &set, &error), cases[i].status);
        if (!strstr(error.message, cases[i].says) ||
            !strstr(error.message, "processor-0001.schedule"))
            fail_msg("'%s' instead of '%s'", error.message, cases[i].says);
        assert_null(set.of);
    }
    put_file(0, texts[1]);
    assert_int_equal(lar_schedule_read_all(folder, &mesh, &set, &error), LAR_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "processor-0000.schedule: holds the schedule of p"));
    put_file(0, texts[0]);
    put_file(1, texts[1]);
    assert_int_equal(lar_schedule_read_all(folder, &mesh, &set, &error), LAR_OK);
    remove_folder(2);
    lar_schedule_set_clear(&set);
    for (int p = 0; p < 2; p++) free(texts[p]);
    lar_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_hand),
        cmocka_unit_test(damaged),
        cmocka_unit_test(documented),
        cmocka_unit_test(overlapping_receives),
        cmocka_unit_test(zero_bytes),
        cmocka_unit_test(cut_off),
        cmocka_unit_test(nothing_to_do),
        cmocka_unit_test(another_mesh),
        cmocka_unit_test(names),
        cmocka_unit_test(write_and_read),
        cmocka_unit_test(organ),
        cmocka_unit_test(whole_or_not_at_all),
        cmocka_unit_test(folders_that_do_not_fit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
