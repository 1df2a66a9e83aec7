/* Files of checkpoints: damaged, forged, of other models, and what saving leaves alone. */
#define PATH LAR_TEST_BUILD "/files.checkpoint"
#include "engine/checkpoint_test.h"

static lar_bytes saved_bytes(lar_simulation *simulation) {
    lar_bytes bytes = {0};
    lar_error error;
    save(simulation, PATH);
    if (lar_bytes_read(PATH, &bytes, &error)) fail_msg("%s", error.message);
    return bytes;
}

static void write_bytes(const char *path, const lar_bytes *bytes) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    if (bytes->size) assert_int_equal(fwrite(bytes->data, bytes->size, 1, file), 1);
    assert_int_equal(fclose(file), 0);
}

#define BAD LAR_TEST_BUILD "/bad.checkpoint"

/* Refused with these words, and nothing has changed. */
static void refuse(lar_simulation *simulation, const char *path, lar_status status,
                   const char *why) {
    uint64_t before = lar_simulation_hash(simulation);
    lar_error error = {0};
    assert_int_equal(lar_simulation_load(simulation, path, &error), status);
    if (!strstr(error.message, why)) fail_msg("'%s' lacks '%s'", error.message, why);
    assert_int_equal(lar_simulation_hash(simulation), before);
}

static void repair_sum(lar_bytes *bytes) {
    uint64_t sum = lar_checkpoint_sum(bytes->data, bytes->size / 8 - 1);
    memcpy(bytes->data + bytes->size - 8, &sum, sizeof sum);
}

static void damaged_files_are_refused(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    act(simulation, 0, 8);
    lar_bytes good = saved_bytes(simulation);
    lar_bytes bad = {lar_calloc(good.size + 8, 1), good.size};
    memcpy(bad.data, good.data, good.size);
    for (size_t size = 1; size < good.size; size += size < 160 ? 1 : 977) {
        bad.size = size;
        write_bytes(BAD, &bad);
        refuse(simulation, BAD, LAR_ERROR_FORMAT, size < 8 ? "not a checkpoint" : "cut off");
    }
    bad.size = good.size + 8;
    write_bytes(BAD, &bad);
    refuse(simulation, BAD, LAR_ERROR_FORMAT, "altered");
    assert_int_equal(truncate(BAD, (off_t)1 << 40), 0); /* more than any memory */
    refuse(simulation, BAD, LAR_ERROR_FORMAT, "altered");
    bad.size = good.size;
    for (size_t at = 24; at < good.size; at += at < 200 ? 1 : 1009) {
        bad.data[at] ^= 0x10;
        write_bytes(BAD, &bad);
        refuse(simulation, BAD, LAR_ERROR_FORMAT, "checksum");
        bad.data[at] ^= 0x10;
    }
    bad.data[8] = 22;
    write_bytes(BAD, &bad);
    refuse(simulation, BAD, LAR_ERROR_UNSUPPORTED, "version 22");
    bad.data[8] = good.data[8];
    memcpy(bad.data + 12, (unsigned char[]){1, 2, 3, 4}, 4);
    write_bytes(BAD, &bad);
    refuse(simulation, BAD, LAR_ERROR_FORMAT, "order of bytes");
    memcpy(bad.data + 12, good.data + 12, 4);
    lar_bytes_free(&bad);
    lar_bytes_free(&good);
    refuse(simulation, LAR_TEST_BUILD "/nowhere/x", LAR_ERROR_IO, "nowhere");
    finish(simulation, model);
}

/* Whoever forges the checksum still gets no state that is none. */
static void forged_files_are_refused(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    act(simulation, 0, 8);
    lar_bytes bytes = saved_bytes(simulation);
    size_t offset = bytes.size - 8 - 56 * (size_t)model->mesh.node_count; /* of the first node */
    /* A tool presses, and hard: version 18, without forces, supports, parameters. */
    enum { DIVISION = 144, SETTINGS = DIVISION + 56, PRESSED = SETTINGS + 1064 + 8 };
    enum { HARD = PRESSED + 24 + 8 + 8, TOOL = HARD + 16 * TEST_TOOLS };
    assert_int_equal(bytes.data[8], 18);
    enum { FOLLOWER = TOOL + 152 * TEST_TOOLS, FELT = FOLLOWER + 152 };
    enum { HAND = FOLLOWER + 240 * TEST_HAND };
    const struct {
        size_t at, size;
        double value; /* as a double, or as a 32-bit integer */
        const char *why;
    } forged[] = {
        {96, 8, 1e300, "numbers beyond"}, /* the step */
        {104, 8, NAN, "numbers beyond"},  /* work */
        {136, 4, 3, "sizes"},             /* tools */
        {140, 4, 300, "sizes"},           /* holds */
        {DIVISION, 4, 0, "tool"},         /* parts of a step */
        {DIVISION, 4, 5, "tool"},
        {DIVISION, 4, 48, "tool"},
        {DIVISION, 4, 64, "tool"},
        {DIVISION, 4, -2, "tool"},
        {DIVISION + 4, 4, 9, "tool"},     /* and before */
        {DIVISION + 8, 8, 1e300, "tool"}, /* since when */
        {DIVISION + 16, 8, NAN, "tool"},  /* hardness */
        {DIVISION + 16, 8, 0.5, "tool"},
        {DIVISION + 16, 8, 65, "tool"},
        {DIVISION + 16, 8, INFINITY, "tool"},
        {DIVISION + 24, 8, NAN, "tool"}, /* need */
        {DIVISION + 24, 8, -1, "tool"},
        {DIVISION + 32, 8, -1, "tool"}, /* and lately */
        {DIVISION + 32, 8, 1025, "tool"},
        {DIVISION + 32, 8, NAN, "tool"},
        {DIVISION + 40, 8, 1e300, "tool"},  /* when decided */
        {DIVISION + 48, 4, 0, "tool"},      /* parts of stiffer materials */
        {DIVISION + 52, 4, 34, "tool"},     /* due */
        {DIVISION + 52, 4, 0x2100, "tool"}, /* still for 33 decisions */
        {SETTINGS, 4, 2, "tool"},           /* whether gravity is set */
        {SETTINGS + 4, 4, -1, "tool"},      /* and damping */
        {SETTINGS + 8, 8, 1001, "tool"},    /* gravity */
        {SETTINGS + 24, 8, NAN, "tool"},
        {SETTINGS + 32, 8, -1, "tool"}, /* damping */
        {SETTINGS + 32, 8, 1e9, "tool"},
        {SETTINGS + 40, 8, 0, "tool"}, /* the factor of the first material, and of the last */
        {SETTINGS + 40 + 63 * 8, 8, 4.5, "tool"},
        {PRESSED, 4, 1, "sizes"},      /* heavier elements */
        {PRESSED + 8, 8, NAN, "tool"}, /* what pressed ones need */
        {PRESSED + 16, 8, -1, "tool"},
        {PRESSED + 24, 4, 1, "sizes"}, /* supports, and parameters */
        {PRESSED + 32, 4, 1, "sizes"},
        {HARD, 8, NAN, "tool"},
        {HARD + 8 * TEST_TOOLS, 8, -1e-9, "tool"},
        {HARD + 8 * TEST_TOOLS, 8, 1, "tool"},
        {HARD + 8 * TEST_TOOLS, 8, NAN, "tool"},
        {TOOL, 8, INFINITY, "tool"}, /* a position */
        {TOOL, 8, -1e200, "tool"},
        {TOOL + 24, 8, 0.5, "tool"},    /* an orientation */
        {TOOL + 56, 8, 1.5, "tool"},    /* an opening */
        {TOOL + 128, 8, 1e300, "tool"}, /* the step at which it began */
        {TOOL + 144, 4, 3, "tool"},     /* whether it holds, and something near */
        {TOOL + 148, 4, 2, "tool"},     /* and its middle is outside */
        {FOLLOWER, 8, NAN, "tool"},     /* where it was asked to go */
        {FOLLOWER + 64, 8, 1e200, "tool"},
        {FOLLOWER + 24, 8, 0.5, "tool"},
        {FOLLOWER + 64 + 56, 8, -1, "tool"},
        {FOLLOWER + 136, 8, -1, "tool"},
        {FOLLOWER + 144, 4, 1, "tool"}, /* the hand itself does not hold */
        {FOLLOWER + 148, 4, 1, "tool"},
        {FELT + 56, 8, NAN, "tool"}, /* depth */
        {FELT + 56, 8, -1e-3, "tool"},
        {FELT + 56, 8, 1, "tool"},
        {FELT + 64, 8, 1e300, "tool"},    /* steps */
        {FELT + 72, 8, INFINITY, "tool"}, /* load */
        {FELT + 72, 8, -1, "tool"},
        {FELT + 80, 4, 2, "tool"}, /* lagging */
        {FELT + 80, 4, -1, "tool"},
        {FELT + 84, 4, 2, "tool"},            /* whether what looks away is in it */
        {HAND + 152 + 80, 4, 1, "tool"},      /* hands do not lag */
        {bytes.size - 16, 8, NAN, "numbers"}, /* a velocity */
        {bytes.size - 16, 8, 3, "hash"},
        {offset, 8, NAN, "numbers"}, /* from the side, outside */
        {offset, 8, 1e-3, "hash"},
    };
    for (size_t i = 0; i < sizeof forged / sizeof forged[0]; i++) {
        lar_bytes bad = {lar_calloc(bytes.size, 1), bytes.size};
        memcpy(bad.data, bytes.data, bytes.size);
        int32_t integer = forged[i].size == 4 ? (int32_t)forged[i].value : 0;
        const void *value = forged[i].size == 8 ? (const void *)&forged[i].value : &integer;
        memcpy(bad.data + forged[i].at, value, forged[i].size);
        repair_sum(&bad);
        write_bytes(BAD, &bad);
        refuse(simulation, BAD, LAR_ERROR_FORMAT, forged[i].why);
        lar_bytes_free(&bad);
    }
    lar_bytes_free(&bytes);
    finish(simulation, model);
}

/* How hard tools are stands in files where they differ, and only there. */
static void tools_differ_in_files(void **unused) {
    (void)unused;
    enum { VERSION = 8, HARD = 144 + 56 + 1064 + 8 + 24 + 8 + 8 };
    static const double bad_ones[] = {NAN, 0.5, 2.5, -INFINITY};
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0)), *other;
    lar_tools *tools = &simulation->tools;
    lar_bytes bytes = saved_bytes(simulation);
    assert_below(bytes.data[VERSION], 17);
    lar_bytes_free(&bytes);
    tools->division.hardness = tools->hardness[0] = 2;
    tools->hardness[1] = 1.25;
    tools->deep[0] = 1e-4;
    bytes = saved_bytes(simulation);
    assert_int_equal(bytes.data[VERSION], 18);
    other = start_with(model, setting(0));
    lar_error error;
    if (lar_simulation_load(other, PATH, &error)) fail_msg("%s", error.message);
    assert_memory_equal(other->tools.hardness, tools->hardness, sizeof tools->hardness);
    assert_memory_equal(other->tools.deep, tools->deep, sizeof tools->deep);
    for (size_t i = 0; i < sizeof bad_ones / sizeof *bad_ones; i++) {
        memcpy(bytes.data + HARD + 8, &bad_ones[i], 8);
        repair_sum(&bytes);
        write_bytes(BAD, &bytes);
        refuse(other, BAD, LAR_ERROR_FORMAT, "tool");
    }
    /* Without it all are as hard as the hardest: as files of before. */
    for (int32_t i = 0; i < tools->count; i++) tools->hardness[i] = 2;
    tools->deep[0] = 0;
    lar_bytes_free(&bytes);
    bytes = saved_bytes(simulation);
    assert_below(bytes.data[VERSION], 17);
    if (lar_simulation_load(other, PATH, &error)) fail_msg("%s", error.message);
    assert_true(other->tools.hardness[0] == 2 && other->tools.hardness[1] == 2);
    lar_bytes_free(&bytes);
    lar_simulation_destroy(other);
    finish(simulation, model);
}

static void refuse_with(const lar_model *model, lar_options options, const char *why) {
    lar_simulation *simulation = start_with(model, options);
    refuse(simulation, PATH, LAR_ERROR_MODEL, why);
    lar_simulation_destroy(simulation);
}

/* Says what is different. */
static void other_models_are_refused(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    act(simulation, 0, 3);
    save(simulation, PATH);
    double step = lar_simulation_time_step(simulation);
    lar_simulation_destroy(simulation);
    lar_options options = setting(0);
    options.time_step = step / 2;
    refuse_with(model, options, "time step");
    options = setting(0);
    options.element = LAR_ELEMENT_HEX8_FULL;
    refuse_with(model, options, "hex8-full");
    options = setting(0);
    options.hands = 2;
    refuse_with(model, options, "hands");
    options = setting(0);
    options.time_step = step;
    lar_model *other = tool_model();
    other->material[1].density *= 1.001;
    refuse_with(other, options, "materials");
    other->material[1].density = model->material[1].density;
    other->mesh.position[17][1] += 1e-9;
    refuse_with(other, options, "places");
    other->mesh.position[17][1] = model->mesh.position[17][1];
    other->damping += 1;
    refuse_with(other, options, "damping");
    other->damping -= 1;
    other->tool[1].radius *= 1.05;
    refuse_with(other, options, "tools");
    lar_model_destroy(other);
    other = everything_model(&soft_brick);
    refuse_with(other, setting(0), "12 elements");
    lar_model_destroy(other);
    lar_model_destroy(model);
}

/* Checkpoints that were begun and are still there. */
static int count_parts(void) {
    DIR *folder = opendir(LAR_TEST_BUILD);
    int count = 0;
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder));)
        count += (strncmp(entry->d_name, "files.checkpoint.", 17) == 0 ||
                  strncmp(entry->d_name, "shared.checkpoint.", 18) == 0) &&
                 strstr(entry->d_name, ".part");
    closedir(folder);
    return count;
}

/* A file is whole or not there; what is no checkpoint is not overwritten. */
static void saving_spares_what_is_there(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    lar_error error = {0};
    lar_bytes scene = {(unsigned char *)lar_strdup("lariat: 1\nmesh: x.vtu\n"), 22};
    write_bytes(BAD, &scene);
    lar_bytes_free(&scene);
    assert_int_equal(lar_simulation_save(simulation, BAD, &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "not overwritten"));
    assert_int_equal(lar_simulation_save(simulation, LAR_TEST_BUILD "/nowhere/x", &error),
                     LAR_ERROR_IO);
    assert_int_equal(lar_simulation_save(simulation, LAR_TEST_BUILD, &error), LAR_ERROR_IO);
    remove(BAD);
    assert_int_equal(mkfifo(BAD, 0600), 0);
    assert_int_equal(lar_simulation_save(simulation, BAD, &error), LAR_ERROR_IO);
    assert_int_equal(lar_simulation_load(simulation, BAD, &error), LAR_ERROR_IO);
    remove(BAD);
    assert_int_equal(symlink(PATH, BAD), 0); /* also to a checkpoint */
    assert_int_equal(lar_simulation_save(simulation, BAD, &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "is no plain file"));
    remove(BAD);
    save(simulation, PATH);
    save(simulation, PATH); /* a checkpoint is */
    assert_int_equal(count_parts(), 0);
    finish(simulation, model);
}

#define SHARED LAR_TEST_BUILD "/shared.checkpoint"

typedef struct saver {
    lar_bytes bytes;
    int failures;
} saver;

static void *save_often(void *argument) {
    saver *s = argument;
    for (int i = 0; i < 15; i++) s->failures += lar_checkpoint_store(SHARED, &s->bytes, NULL) != 0;
    return NULL;
}

/* Each writes a file of its own, and the last name given stands. */
static void several_save_to_one_path(void **unused) {
    (void)unused;
    enum { SAVERS = 4, MAX = 400000 };
    saver s[SAVERS];
    pthread_t thread[SAVERS];
    lar_bytes left;
    remove(SHARED);
    for (int k = 0; k < SAVERS; k++) {
        s[k] = (saver){.bytes = {malloc(MAX), (size_t)(MAX / (k + 1))}};
        memset(s[k].bytes.data, 'a' + k, MAX);
        memcpy(s[k].bytes.data, "LARIATCP", 8);
        assert_int_equal(pthread_create(&thread[k], NULL, save_often, &s[k]), 0);
    }
    for (int k = 0; k < SAVERS; k++) pthread_join(thread[k], NULL);
    assert_int_equal(lar_bytes_read(SHARED, &left, NULL), LAR_OK);
    int whose = left.data[8] - 'a';
    assert_in_range(whose, 0, SAVERS - 1);
    assert_int_equal(left.size, s[whose].bytes.size);
    assert_memory_equal(left.data, s[whose].bytes.data, left.size);
    for (int k = 0; k < SAVERS; k++) {
        assert_int_equal(s[k].failures, 0);
        lar_bytes_free(&s[k].bytes);
    }
    lar_bytes_free(&left);
    assert_int_equal(count_parts(), 0);
    remove(SHARED);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(damaged_files_are_refused),   cmocka_unit_test(forged_files_are_refused),
        cmocka_unit_test(tools_differ_in_files),       cmocka_unit_test(other_models_are_refused),
        cmocka_unit_test(saving_spares_what_is_there), cmocka_unit_test(several_save_to_one_path),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
