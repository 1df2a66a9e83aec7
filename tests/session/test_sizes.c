/* Programs whose structs are smaller or larger than the library's: compiled with lariat.h as it is,
 * with one in which every struct that grows lacks its last member (LAR_TEST_OLDER), and with one in
 * which they have more (LAR_TEST_NEWER). Nothing is written behind a struct; what the library does
 * not know is 0, or must be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lariat.h"

#define STATE     LAR_TEST_BUILD "/sizes_" LAR_TEST_WAY ".lariat"
#define RECORDING LAR_TEST_BUILD "/sizes_" LAR_TEST_WAY ".recording"

static lar_error error;
static lar_model *model;
static lar_simulation *simulation;

#define DONE(call)                                                                                 \
    do {                                                                                           \
        lar_status done_ = call;                                                                   \
        if (done_) fail_msg("%s", error.message);                                                  \
    } while (0)

/* A struct of this program with a guard behind it: `call` fills in `value`. */
enum { GUARD = 256, FILL = 0xa5 };
#ifdef LAR_TEST_NEWER
#define LATER_IS_ZERO(value) assert_memory_equal(value.later, (double[3]){0}, sizeof value.later)
#else
#define LATER_IS_ZERO(value) (void)0
#endif
#define WRITES(type, call)                                                                         \
    do {                                                                                           \
        struct {                                                                                   \
            type value;                                                                            \
            unsigned char guard[GUARD];                                                            \
        } kept;                                                                                    \
        memset(&kept, FILL, sizeof kept);                                                          \
        type *value = &kept.value;                                                                 \
        call;                                                                                      \
        const unsigned char *byte = (const unsigned char *)&kept;                                  \
        for (size_t i = sizeof kept.value; i < sizeof kept; i++) assert_int_equal(byte[i], FILL);  \
        unsigned char filled[sizeof kept.value];                                                   \
        memset(filled, FILL, sizeof filled);                                                       \
        assert_memory_not_equal(byte, filled, sizeof filled);                                      \
        LATER_IS_ZERO(kept.value);                                                                 \
    } while (0)

static const double position[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                      {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const int32_t element[1][8] = {{0, 1, 2, 3, 4, 5, 6, 7}};

static lar_mesh_arrays cube(void) {
    return (lar_mesh_arrays){.nodes = 8, .elements = 1, .position = position, .element = element};
}

static int open_all(void **unused) {
    (void)unused;
    static const char scene[] =
        "lariat: 1\n"
        "materials: [ { cells: all, law: neo-hookean, density: 1000, shear_modulus: 1.0e4, "
        "bulk_modulus: 1.0e5 } ]\n"
        "tools: [ { name: ball, shape: sphere, radius: 0.4, at: [0.5, 0.5, 1.6] } ]\n";
    const lar_mesh_arrays mesh = cube();
    if (lar_model_from_arrays(&mesh, scene, &model, &error)) return -1;
    return lar_simulation_create(model, NULL, &simulation, &error) ? -1 : 0;
}

static int close_all(void **unused) {
    (void)unused;
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return 0;
}

static void of_models(void **unused) {
    (void)unused;
    WRITES(lar_model_info, DONE(lar_model_inspect(model, value, &error)));
    WRITES(lar_material_info, DONE(lar_model_material(model, 0, value, &error)));
    WRITES(lar_tool_info, DONE(lar_model_tool(model, 0, value, &error)));
    WRITES(lar_mesh_quality, DONE(lar_model_quality(model, NULL, 1, value, &error)));
}

static void of_simulations(void **unused) {
    (void)unused;
    DONE(lar_simulation_advance(simulation, 20, &error));
    DONE(lar_simulation_save(simulation, STATE, &error));
    WRITES(lar_simulation_info, lar_simulation_inspect(simulation, value));
    WRITES(lar_energy, lar_simulation_energy(simulation, value));
    WRITES(lar_tool_info, DONE(lar_simulation_tool(simulation, 0, value, &error)));
    WRITES(lar_tool_force, DONE(lar_simulation_tool_force(simulation, 0, value, &error)));
    WRITES(lar_heavier, lar_simulation_heavier(simulation, value));
    WRITES(lar_contact_info, lar_simulation_contact(simulation, value));
    WRITES(lar_checkpoint_info, DONE(lar_checkpoint_inspect(STATE, value, &error)));
    lar_grid_choice choice;
    DONE(lar_grid_choose(model, NULL, &(lar_grid_aim){.steps = 1}, &choice, &error));
    WRITES(lar_grid_choice,
           DONE(lar_grid_choose(model, NULL, &(lar_grid_aim){.steps = 1}, value, &error)));
    assert_string_equal(choice.grid, "1x1x1");
}

static void of_sessions(void **unused) {
    (void)unused;
    lar_session *session = NULL;
    lar_session_options options = lar_session_options_default();
    assert_true(options.pace == 1);
    options.paused = 1;
    options.record = RECORDING;
    remove(RECORDING);
    DONE(lar_session_open(simulation, &options, &session, &error));
    DONE(lar_session_start(session, &error));
    lar_session_step(session, 100);
    DONE(lar_session_reset(session, &error));
    WRITES(lar_session_info, lar_session_inspect(session, value));
    WRITES(lar_session_status, lar_session_status_get(session, value));
    WRITES(lar_tool_info, DONE(lar_session_tool_info(session, 0, value, &error)));
    WRITES(lar_tool_force, DONE(lar_session_tool_force(session, 0, NULL, value, &error)));
    WRITES(lar_device_status, DONE(lar_session_device(session, 0, value, &error)));
    DONE(lar_session_close(session, &error));
    WRITES(lar_recording_info, DONE(lar_recording_inspect(RECORDING, value, &error)));
    WRITES(lar_replay_report, DONE(lar_replay(simulation, RECORDING, NULL, NULL, value, &error)));
}

static void of_meshings(void **unused) {
    (void)unused;
    const uint16_t label[64] = {
        [21] = 1, [22] = 1, [25] = 1, [26] = 1, [37] = 1, [38] = 1, [41] = 1, [42] = 1};
    const lar_image_info from = {
        .size = {4, 4, 4},
        .to_world = {{0.01, 0, 0, 0}, {0, 0.01, 0, 0}, {0, 0, 0.01, 0}},
        .label = label,
    };
    lar_image *image = NULL;
    lar_meshing *meshing = NULL;
    DONE(lar_image_create(&from, NULL, NULL, &image, &error));
    WRITES(lar_image_info, lar_image_inspect(image, value));
    lar_meshing_options options = lar_meshing_options_default();
    options.voxel = 1;
    DONE(lar_meshing_of_image(image, &options, &meshing, &error));
    WRITES(lar_mesh_arrays, lar_meshing_arrays(meshing, value, NULL));
    WRITES(lar_meshing_info, lar_meshing_inspect(meshing, value));
    WRITES(lar_region_info, DONE(lar_meshing_region(meshing, 0, value, &error)));
    lar_meshing_destroy(meshing);
    lar_image_destroy(image);
}

/* What only the library has is as by default: an older program's options are good as they are. */
static void what_is_read(void **unused) {
    (void)unused;
    lar_options options = lar_options_default();
    lar_simulation *made = NULL;
    lar_model *given = NULL;
    assert_int_equal(options.listener, -1);
    options.spares = 1;
    DONE(lar_simulation_create(model, &options, &made, &error));
    assert_int_equal(lar_simulation_tool_count(made), lar_simulation_tool_count(simulation) + 1);
    lar_tool_info wanted = {.shape = LAR_TOOL_SPHERE, .radius = 0.4};
    DONE(lar_simulation_add_tool(made, &wanted, NULL, &error));
    lar_simulation_destroy(made);
    lar_mesh_arrays mesh = cube();
    DONE(lar_model_from_arrays(&mesh, NULL, &given, &error));
    lar_model_destroy(given);
}

#ifdef LAR_TEST_NEWER
#define REFUSED(call, name)                                                                        \
    do {                                                                                           \
        assert_int_equal(call, LAR_ERROR_UNSUPPORTED);                                             \
        assert_non_null(strstr(error.message, name));                                              \
        assert_non_null(strstr(error.message, lar_version()));                                     \
    } while (0)

/* A newer program that asks for what this library has not. */
static void what_is_not_known(void **unused) {
    (void)unused;
    lar_options options = lar_options_default();
    lar_session_options live = lar_session_options_default();
    lar_tool_info wanted = {.shape = LAR_TOOL_SPHERE, .radius = 0.4, .later = {0, 1}};
    lar_mesh_arrays mesh = cube();
    lar_simulation *made = NULL;
    lar_session *session = NULL;
    lar_model *given = NULL;
    lar_grid_choice choice;
    options.later[2] = live.later[0] = mesh.later[1] = 1;
    REFUSED(lar_simulation_create(model, &options, &made, &error), "lar_options");
    REFUSED(lar_grid_choose(model, &options, NULL, &choice, &error), "lar_options");
    REFUSED(lar_session_open(simulation, &live, &session, &error), "lar_session_options");
    REFUSED(lar_simulation_add_tool(simulation, &wanted, NULL, &error), "lar_tool_info");
    REFUSED(lar_model_from_arrays(&mesh, NULL, &given, &error), "lar_mesh_arrays");
    assert_true(!made && !session && !given);
}
#endif

static void versions(void **unused) {
    (void)unused;
    int major, minor, patch;
    assert_int_equal(sscanf(lar_version(), "%d.%d.%d", &major, &minor, &patch), 3);
    assert_int_equal(lar_version_number(), 10000 * major + 100 * minor + patch);
    assert_int_equal(lar_version_number(), LARIAT_VERSION);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_models),         cmocka_unit_test(of_simulations),
        cmocka_unit_test(of_sessions),       cmocka_unit_test(of_meshings),
        cmocka_unit_test(what_is_read),
#ifdef LAR_TEST_NEWER
        cmocka_unit_test(what_is_not_known),
#endif
        cmocka_unit_test(versions),
    };
    return cmocka_run_group_tests_name("sizes " LAR_TEST_WAY, tests, open_all, close_all);
}
