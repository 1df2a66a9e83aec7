/* The public calls refuse what makes no sense: a status and a sentence, never a crash, and nothing
 * is set. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lariat.h"

#define BEAM LAR_TEST_EXAMPLES "/beam.yaml"

static lar_error error;

#define REFUSED(call)                                                                              \
    do {                                                                                           \
        error = (lar_error){LAR_OK, ""};                                                           \
        assert_int_equal(call, LAR_ERROR_ARGUMENT);                                                \
        assert_int_equal(error.status, LAR_ERROR_ARGUMENT);                                        \
        assert_true(strlen(error.message) > 20);                                                   \
    } while (0)

static void model_calls(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_model_info info;
    lar_material_info material;
    lar_set_info set;
    lar_model_contact_info contact;
    lar_tool_info tool;
    REFUSED(lar_model_open(NULL, &model, &error));
    REFUSED(lar_model_open(BEAM, NULL, &error));
    REFUSED(lar_model_from_arrays(NULL, NULL, &model, &error));
    REFUSED(
        lar_model_from_arrays(&(lar_mesh_arrays){.nodes = 8, .elements = 1}, NULL, &model, &error));
    assert_null(model);
    assert_int_equal(lar_model_open(BEAM, &model, &error), LAR_OK);
    REFUSED(lar_model_inspect(NULL, &info, &error));
    REFUSED(lar_model_inspect(model, NULL, &error));
    REFUSED(lar_model_material(NULL, 0, &material, &error));
    REFUSED(lar_model_material(model, 0, NULL, &error));
    REFUSED(lar_model_material(model, -1, &material, &error));
    REFUSED(lar_model_material(model, 1, &material, &error));
    REFUSED(lar_model_set(NULL, 0, &set, &error));
    REFUSED(lar_model_set(model, 0, NULL, &error));
    REFUSED(lar_model_set(model, -1, &set, &error));
    REFUSED(lar_model_set(model, 99, &set, &error));
    assert_int_equal(lar_model_contact_count(model), 0);
    REFUSED(lar_model_contact(NULL, 0, &contact, &error));
    REFUSED(lar_model_contact(model, 0, NULL, &error));
    REFUSED(lar_model_contact(model, 0, &contact, &error));
    assert_int_equal(lar_model_tool_count(model), 0);
    assert_int_equal(lar_model_tool_free(model, 0), 0);
    REFUSED(lar_model_tool(NULL, 0, &tool, &error));
    REFUSED(lar_model_tool(model, 0, NULL, &error));
    REFUSED(lar_model_tool(model, 0, &tool, &error));
    lar_embedded_info embedded;
    assert_int_equal(lar_model_embedded(NULL, &embedded), 0);
    assert_int_equal(lar_model_embedded(model, &embedded), 0);
    lar_model_embedded_move(model, NULL, NULL);
    assert_non_null(lar_model_element_nodes(model, 0));
    assert_null(lar_model_element_nodes(model, -1));
    assert_null(lar_model_element_nodes(NULL, 0));
    REFUSED(lar_demo_write(NULL, &error));
    lar_model_destroy(model);
    lar_model_destroy(NULL);
}

static void models_tell_what_they_are(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_model_info info;
    double view[3] = {7, 7, 7}, gravity[3];
    assert_int_equal(lar_model_open(BEAM, &model, &error), LAR_OK);
    assert_int_equal(lar_model_inspect(model, &info, &error), LAR_OK);
    assert_int_equal(lar_model_node_count(model), info.nodes);
    assert_int_equal(lar_model_element_count(model), info.elements);
    assert_int_equal(lar_model_material_count(model), info.materials);
    assert_string_equal(lar_model_source(model), BEAM);
    assert_true(lar_model_node_id(model, 0) >= 0);
    assert_int_equal(lar_model_node_id(model, -1), -1);
    assert_int_equal(lar_model_node_id(model, info.nodes), -1);
    assert_int_equal(lar_model_view(model, view), 0);
    assert_true(view[0] == 0 && view[1] == 0 && view[2] == 0);
    assert_int_equal(lar_model_gravity(model, 0, gravity), 0);
    assert_true(gravity[0] == 0 && gravity[1] == 0 && gravity[2] < -9);
    lar_model_destroy(model);
}

static void image_calls(void **unused) {
    (void)unused;
    lar_image *image = NULL;
    REFUSED(lar_image_open(NULL, &image, &error));
    REFUSED(lar_image_open("", &image, &error));
    REFUSED(lar_image_open("organ.nrrd", NULL, &error));
    assert_int_equal(lar_image_open("organ.nrrd", &image, &error), LAR_ERROR_IO);
    assert_int_equal(lar_image_open(BEAM, &image, &error), LAR_ERROR_UNSUPPORTED);
    assert_null(image);
}

static int never(void *context, const char *what, double part) {
    (void)context;
    (void)what;
    (void)part;
    return 0;
}

static void meshing_calls(void **unused) {
    (void)unused;
    static const char *const none[] = {NULL}, *const text[] = {"organ.txt"},
                             *const image[] = {"organ.nrrd"};
    lar_model *model = NULL;
    lar_meshing *meshing = NULL;
    lar_mesh_quality quality;
    lar_embedded_info embedded;
    lar_meshing_options options = lar_meshing_options_default();
    assert_int_equal(options.elements, 5000);
    assert_true(options.scale == 1);
    assert_int_equal(lar_model_open(BEAM, &model, &error), LAR_OK);
    REFUSED(lar_model_quality(NULL, NULL, 1, &quality, &error));
    REFUSED(lar_model_quality(model, NULL, 1, NULL, &error));
    REFUSED(lar_model_quality(model, "organ.stl", 0, &quality, &error));
    REFUSED(lar_model_quality(model, "organ.stl", -1, &quality, &error));
    REFUSED(lar_model_quality(model, "organ.stl", INFINITY, &quality, &error));
    assert_int_equal(lar_model_quality(model, NULL, 1, &quality, &error), LAR_OK);
    assert_true(quality.true_volume == 0 && quality.deviation_max == 0);
    assert_true(quality.above_05 == 1 && quality.volume > 0);
    assert_int_equal(lar_model_embedded(model, &embedded), 0);
    REFUSED(lar_meshing_create(NULL, 1, NULL, &meshing, &error));
    REFUSED(lar_meshing_create(image, 0, NULL, &meshing, &error));
    REFUSED(lar_meshing_create(image, -1, NULL, &meshing, &error));
    REFUSED(lar_meshing_create(image, 1, NULL, NULL, &error));
    REFUSED(lar_meshing_create(none, 1, NULL, &meshing, &error));
    REFUSED(lar_meshing_create(text, 1, NULL, &meshing, &error));
    options.size = -1;
    REFUSED(lar_meshing_create(image, 1, &options, &meshing, &error));
    options = (lar_meshing_options){.elements = -1};
    REFUSED(lar_meshing_create(image, 1, &options, &meshing, &error));
    options = (lar_meshing_options){.label_count = -1};
    REFUSED(lar_meshing_create(image, 1, &options, &meshing, &error));
    options = (lar_meshing_options){.fix = "sideways"};
    REFUSED(lar_meshing_create(image, 1, &options, &meshing, &error));
    options = (lar_meshing_options){.progress = never};
    REFUSED(lar_meshing_create(image, 1, &options, &meshing, &error));
    assert_int_equal(lar_meshing_create(image, 1, NULL, &meshing, NULL), LAR_ERROR_IO);
    assert_null(meshing);
    REFUSED(lar_meshing_region(NULL, 0, &(lar_region_info){0}, &error));
    assert_int_equal(lar_meshing_region_boundary(NULL, 0, NULL, NULL), -1);
    REFUSED(lar_meshing_write(NULL, "organ", NULL, &error));
    lar_meshing_destroy(NULL);
    lar_model_destroy(model);
}

static void simulation_calls(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_results *results = NULL;
    assert_int_equal(lar_model_open(BEAM, &model, &error), LAR_OK);
    lar_grid_choice choice;
    REFUSED(lar_grid_choose(NULL, NULL, NULL, &choice, &error));
    REFUSED(lar_grid_choose(model, NULL, NULL, NULL, &error));
    lar_grid_take(NULL, NULL);
    REFUSED(lar_simulation_create(NULL, NULL, &simulation, &error));
    REFUSED(lar_simulation_create(model, NULL, NULL, &error));
    static const double steps[] = {-1, NAN, INFINITY, -INFINITY};
    lar_options options = lar_options_default();
    for (int i = 0; i < 4; i++) {
        options.time_step = steps[i];
        REFUSED(lar_simulation_create(model, &options, &simulation, &error));
    }
    options = lar_options_default();
    options.element = (lar_element_kind)42;
    REFUSED(lar_simulation_create(model, &options, &simulation, &error));
    options = lar_options_default();
    options.isa = (lar_isa)77;
    REFUSED(lar_simulation_create(model, &options, &simulation, &error));
    assert_null(simulation);
    REFUSED(lar_simulation_advance(NULL, 1, &error));
    lar_simulation_info made;
    options = lar_options_default();
    options.hands = options.spares = 2;
    options.element = LAR_ELEMENT_HEX8_FULL;
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_OK);
    lar_simulation_inspect(simulation, &made);
    assert_ptr_equal(made.model, model);
    assert_int_equal(made.element, LAR_ELEMENT_HEX8_FULL);
    assert_int_equal(made.tools, 2);
    assert_int_equal(made.spares, 2);
    assert_true(made.time_step == lar_simulation_time_step(simulation));
    lar_simulation_destroy(simulation);
    simulation = NULL;
    REFUSED(lar_results_open(NULL, simulation, &results, &error));
    REFUSED(lar_results_resume(NULL, simulation, 1, &results, &error));
    assert_int_equal(lar_results_frames(NULL), 0);
    REFUSED(lar_results_add(NULL, NULL, &error));
    assert_int_equal(lar_results_close(NULL, &error), LAR_OK);
    lar_simulation_destroy(NULL);
    lar_model_destroy(model);
}

/* A simulation without and with a hand. */
static void tool_calls(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_tool_info info;
    lar_tool_pose pose = {{0, 0, 1}, {1, 0, 0, 0}, 1};
    lar_tool_force force;
    lar_options options = lar_options_default();
    assert_int_equal(lar_model_open(BEAM, &model, &error), LAR_OK);
    options.hands = -1;
    REFUSED(lar_simulation_create(model, &options, &simulation, &error));
    options.hands = 1000;
    REFUSED(lar_simulation_create(model, &options, &simulation, &error));
    for (int32_t hands = 0; hands < 2; hands++) {
        options.hands = hands;
        assert_int_equal(lar_simulation_create(model, &options, &simulation, &error), LAR_OK);
        assert_int_equal(lar_simulation_tool_count(simulation), hands);
        REFUSED(lar_simulation_tool(simulation, hands, &info, &error));
        REFUSED(lar_simulation_tool(simulation, -1, &info, &error));
        REFUSED(lar_simulation_tool_pose(simulation, hands, &pose, &error));
        REFUSED(lar_simulation_tool_move(simulation, hands, &pose, 10, &error));
        REFUSED(lar_simulation_tool_force(simulation, hands, &force, &error));
        if (hands == 0) lar_simulation_destroy(simulation);
    }
    REFUSED(lar_simulation_tool(NULL, 0, &info, &error));
    REFUSED(lar_simulation_tool(simulation, 0, NULL, &error));
    REFUSED(lar_simulation_tool_pose(NULL, 0, &pose, &error));
    REFUSED(lar_simulation_tool_pose(simulation, 0, NULL, &error));
    REFUSED(lar_simulation_tool_move(NULL, 0, &pose, 10, &error));
    REFUSED(lar_simulation_set_gravity(NULL, NULL, &error));
    REFUSED(lar_simulation_set_damping(NULL, 0, &error));
    REFUSED(lar_simulation_set_stiffness(NULL, -1, 1, &error));
    REFUSED(lar_simulation_set_stiffness(simulation, INT32_MAX, 1, &error));
    REFUSED(lar_simulation_set_parameter(NULL, 0, "shear_modulus", 1, &error));
    REFUSED(lar_simulation_set_parameter(simulation, INT32_MAX, NULL, 1, &error));
    REFUSED(lar_session_set_parameter(NULL, 0, "shear_modulus", 1, &error));
    REFUSED(lar_simulation_activate(NULL, -1, 1, &error));
    REFUSED(lar_simulation_activate(simulation, INT32_MAX, 1, &error));
    REFUSED(lar_session_activate(NULL, -1, 1, &error));
    const double pull[3] = {1, 0, 0};
    lar_touch touch;
    int32_t count = -1;
    REFUSED(lar_simulation_set_force(NULL, 0, pull, &error));
    REFUSED(lar_simulation_set_force(simulation, -1, pull, &error));
    REFUSED(lar_simulation_set_force(simulation, INT32_MAX, NULL, &error));
    REFUSED(lar_simulation_set_force_on(NULL, "wall", pull, &error));
    REFUSED(lar_simulation_set_force_on(simulation, NULL, pull, &error));
    REFUSED(lar_simulation_set_force_on(simulation, "nothing", NULL, &error));
    REFUSED(lar_simulation_set_support(NULL, 0, LAR_AXIS_ALL, 1, &error));
    REFUSED(lar_simulation_set_support(simulation, -1, LAR_AXIS_ALL, 1, &error));
    REFUSED(lar_simulation_set_support(simulation, 0, UINT32_MAX, 0, &error));
    REFUSED(lar_simulation_set_support_on(simulation, NULL, LAR_AXIS_ALL, 1, &error));
    REFUSED(lar_simulation_set_support_on(NULL, "wall", LAR_AXIS_ALL, 1, &error));
    REFUSED(lar_session_set_support(NULL, 0, LAR_AXIS_ALL, 1, &error));
    REFUSED(lar_session_set_support_on(NULL, "wall", LAR_AXIS_ALL, 1, &error));
    assert_int_equal(lar_simulation_support(NULL, 0), 0);
    REFUSED(lar_session_set_force(NULL, 0, pull, &error));
    REFUSED(lar_session_set_force_on(NULL, "wall", pull, &error));
    REFUSED(lar_simulation_tool_touches(NULL, 0, 1, &touch, &count, &error));
    REFUSED(lar_simulation_tool_touches(simulation, 99, 1, &touch, &count, &error));
    REFUSED(lar_simulation_tool_touches(simulation, 0, 1, NULL, &count, &error));
    REFUSED(lar_simulation_tool_touches(simulation, 0, -1, &touch, &count, &error));
    REFUSED(lar_simulation_tool_touches(simulation, 0, 1, &touch, NULL, &error));
    double on_node[1][3];
    REFUSED(lar_simulation_nodal_forces(NULL, LAR_CAUSE_LOADS, -1, on_node, &error));
    REFUSED(lar_simulation_nodal_forces(simulation, LAR_CAUSE_LOADS, -1, NULL, &error));
    REFUSED(lar_simulation_nodal_forces(simulation, (lar_cause)99, -1, on_node, &error));
    REFUSED(lar_simulation_nodal_forces(simulation, (lar_cause)-1, -1, on_node, &error));
    REFUSED(lar_simulation_nodal_forces(simulation, LAR_CAUSE_TOOL, 99, on_node, &error));
    REFUSED(lar_simulation_contact_inside(NULL, &count, NULL, &error));
    REFUSED(lar_simulation_contact_inside(simulation, NULL, NULL, &error));
    REFUSED(lar_simulation_contact_pressure(NULL, on_node, NULL, &error));
    REFUSED(lar_session_tool_touches(NULL, 0, 1, &touch, &count, &error));
    assert_int_equal(count, -1);
    REFUSED(lar_session_set_gravity(NULL, NULL, &error));
    REFUSED(lar_session_set_damping(NULL, 0, &error));
    REFUSED(lar_session_set_stiffness(NULL, -1, 1, &error));
    REFUSED(lar_simulation_tool_move(simulation, 0, NULL, 10, &error));
    REFUSED(lar_simulation_tool_move(simulation, 0, &pose, 0, &error));
    REFUSED(lar_simulation_tool_force(NULL, 0, &force, &error));
    REFUSED(lar_simulation_tool_force(simulation, 0, NULL, &error));
    assert_int_equal(lar_simulation_tool(simulation, 0, &info, &error), LAR_OK);
    assert_string_equal(info.name, "hand");
    assert_int_equal(info.shape, LAR_TOOL_HAND);
    assert_int_equal(lar_simulation_tool_move(simulation, 0, &pose, 10, &error), LAR_OK);
    assert_int_equal(lar_simulation_tool_force(simulation, 0, &force, &error), LAR_OK);
    assert_true(force.limit == 0 && force.depth == 0 && force.apart == 0 && !force.limited);
    assert_int_equal(lar_simulation_step_parts(simulation), 1);
    assert_int_equal(lar_simulation_divided_steps(simulation, NULL), 0);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

static void restart_and_picture_calls(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    assert_int_equal(lar_model_open(BEAM, &model, &error), LAR_OK);
    assert_int_equal(lar_simulation_create(model, NULL, &simulation, &error), LAR_OK);
    REFUSED(lar_simulation_reset(NULL, &error));
    REFUSED(lar_simulation_save(NULL, "x", &error));
    REFUSED(lar_simulation_save(simulation, NULL, &error));
    REFUSED(lar_simulation_save(simulation, "", &error));
    REFUSED(lar_simulation_load(NULL, "x", &error));
    REFUSED(lar_simulation_load(simulation, NULL, &error));
    REFUSED(lar_simulation_load(simulation, "", &error));
    assert_int_equal(lar_simulation_load(simulation, BEAM, &error), LAR_ERROR_FORMAT);
    assert_int_equal(lar_simulation_reset(simulation, &error), LAR_OK);
    lar_saved *saved = NULL;
    REFUSED(lar_saved_create(NULL, &saved, &error));
    REFUSED(lar_saved_create(simulation, NULL, &error));
    assert_int_equal(lar_saved_create(simulation, &saved, &error), LAR_OK);
    REFUSED(lar_simulation_save_to(NULL, saved, &error));
    REFUSED(lar_simulation_save_to(simulation, NULL, &error));
    REFUSED(lar_simulation_load_from(simulation, saved, &error)); /* it is empty */
    assert_int_equal(lar_simulation_save_to(simulation, saved, &error), LAR_OK);
    REFUSED(lar_simulation_load_from(NULL, saved, &error));
    REFUSED(lar_simulation_load_from(simulation, NULL, &error));
    lar_simulation *clone = NULL;
    REFUSED(lar_simulation_clone(NULL, &clone, &error));
    REFUSED(lar_simulation_clone(simulation, NULL, &error));
    assert_int_equal(lar_simulation_clone(simulation, &clone, &error), LAR_OK);
    assert_int_equal(lar_simulation_hash(clone), lar_simulation_hash(simulation));
    assert_int_equal(lar_simulation_load_from(clone, saved, &error), LAR_OK);
    lar_simulation_destroy(clone);
    REFUSED(lar_session_save_to(NULL, saved, &error));
    REFUSED(lar_session_load_from(NULL, saved, &error));
    for (int i = 0; i < 4; i++) {
        lar_simulation *other = NULL;
        lar_options options = lar_options_default();
        options.hands = i == 0;
        options.spares = i == 1;
        if (i == 2) options.element = LAR_ELEMENT_HEX8_FULL;
        if (i == 3) options.time_step = 0.5 * lar_simulation_time_step(simulation);
        assert_int_equal(lar_simulation_create(model, &options, &other, &error), LAR_OK);
        REFUSED(lar_simulation_save_to(other, saved, &error));
        REFUSED(lar_simulation_load_from(other, saved, &error));
        lar_simulation_destroy(other);
    }
    lar_saved_destroy(saved);
    lar_saved_destroy(NULL);
    int32_t nodes;
    lar_model_info info;
    assert_int_equal(lar_model_inspect(model, &info, &error), LAR_OK);
    nodes = info.nodes;
    double(*u)[3] = calloc((size_t)nodes, sizeof *u);
    float *out = calloc((size_t)nodes, sizeof *out);
    const double(*at)[3] = (const double(*)[3])u;
    REFUSED(lar_simulation_field(NULL, LAR_FIELD_VON_MISES, at, out, &error));
    REFUSED(lar_simulation_field(simulation, LAR_FIELD_VON_MISES, NULL, out, &error));
    REFUSED(lar_simulation_field(simulation, LAR_FIELD_VON_MISES, at, NULL, &error));
    REFUSED(lar_simulation_field(simulation, LAR_FIELD_VELOCITY, at, out, &error));
    REFUSED(lar_simulation_field(simulation, (lar_field)0, at, out, &error));
    REFUSED(lar_simulation_field(simulation, (lar_field)3, at, out, &error));
    assert_int_equal(lar_simulation_field(simulation, LAR_FIELD_VON_MISES, at, out, &error),
                     LAR_OK);
    double value = 7;
    REFUSED(lar_simulation_node_value(NULL, LAR_FIELD_ENERGY, 0, at, &value, &error));
    REFUSED(lar_simulation_node_value(simulation, LAR_FIELD_ENERGY, 0, NULL, &value, &error));
    REFUSED(lar_simulation_node_value(simulation, LAR_FIELD_ENERGY, 0, at, NULL, &error));
    REFUSED(lar_simulation_node_value(simulation, LAR_FIELD_ENERGY, -1, at, &value, &error));
    REFUSED(lar_simulation_node_value(simulation, LAR_FIELD_ENERGY, nodes, at, &value, &error));
    REFUSED(lar_simulation_node_value(simulation, LAR_FIELD_PROCESSOR, 0, at, &value, &error));
    REFUSED(lar_simulation_element_value(NULL, LAR_FIELD_ENERGY, 0, at, &value, &error));
    REFUSED(lar_simulation_element_value(simulation, LAR_FIELD_ENERGY, 0, at, NULL, &error));
    REFUSED(lar_simulation_element_value(simulation, LAR_FIELD_ENERGY, info.elements, at, &value,
                                         &error));
    REFUSED(lar_simulation_element_value(simulation, LAR_FIELD_VELOCITY, 0, at, &value, &error));
    REFUSED(lar_simulation_stored_energy(NULL, at, &value, &value, &error));
    REFUSED(lar_simulation_stored_energy(simulation, at, &value, NULL, &error));
    assert_true(value == 7);
    free(out);
    free(u);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* All calls of lariat.h that have no status. */
static void calls_without_a_status_accept_nothing(void **unused) {
    (void)unused;
    const char *text;
    lar_model_destroy(NULL);
    assert_true(lar_model_element_id(NULL, 0) <= 0);
    assert_true(lar_model_set_count(NULL) <= 0);
    assert_true(lar_model_notice_count(NULL) <= 0);
    text = lar_model_notice_text(NULL, 0);
    assert_true(!text || !*text);
    lar_model_surface(NULL, NULL);
    assert_true(lar_model_element_material(NULL, 0) <= 0);
    assert_true(lar_model_embedded(NULL, NULL) <= 0);
    lar_model_embedded_move(NULL, NULL, NULL);
    assert_null(lar_model_element_nodes(NULL, 0));
    assert_int_equal(lar_model_node_count(NULL), 0);
    assert_int_equal(lar_model_element_count(NULL), 0);
    assert_int_equal(lar_model_material_count(NULL), 0);
    assert_string_equal(lar_model_source(NULL), "");
    assert_int_equal(lar_model_node_id(NULL, 0), -1);
    double zero[3] = {7, 7, 7};
    assert_int_equal(lar_model_view(NULL, zero), 0);
    assert_true(zero[0] == 0 && zero[2] == 0);
    zero[0] = 7;
    assert_int_equal(lar_model_gravity(NULL, 0, zero), 0);
    assert_true(zero[0] == 0);
    lar_image_info image = {.names = 7};
    lar_image_inspect(NULL, &image);
    assert_int_equal(image.names, 0);
    assert_null(lar_image_name(NULL, 0, NULL));
    lar_image_destroy(NULL);
    lar_simulation_info made = {.tools = 7};
    lar_simulation_inspect(NULL, &made);
    assert_true(made.tools == 0 && !made.model);
    lar_session_info session = {.tick = 7};
    lar_session_inspect(NULL, &session);
    assert_true(session.tick == 0 && !session.simulation);
    assert_true(lar_model_contact_count(NULL) <= 0);
    assert_true(lar_model_tool_count(NULL) <= 0);
    assert_int_equal(lar_model_tool_free(NULL, 0), 0);
    lar_meshing_destroy(NULL);
    lar_meshing_inspect(NULL, NULL);
    lar_simulation_destroy(NULL);
    assert_true(lar_simulation_processors(NULL) <= 0);
    assert_true(lar_simulation_threads(NULL) <= 0);
    assert_true(lar_simulation_steps(NULL) == 0);
    assert_true(lar_simulation_time(NULL) == 0);
    assert_true(lar_simulation_time_step(NULL) == 0);
    text = lar_simulation_isa(NULL);
    assert_true(!text || !*text);
    lar_simulation_displacements(NULL, NULL);
    lar_simulation_velocities(NULL, NULL);
    assert_true(lar_simulation_hash(NULL) == 0);
    lar_simulation_energy(NULL, NULL);
    lar_simulation_gravity(NULL, NULL);
    assert_true(lar_simulation_damping(NULL) == 0);
    assert_true(lar_simulation_stiffness(NULL, 0) == 0);
    assert_true(lar_simulation_tool_count(NULL) <= 0);
    assert_true(lar_simulation_step_parts(NULL) <= 0);
    assert_true(lar_simulation_divided_steps(NULL, NULL) == 0);
    lar_simulation_contact(NULL, NULL);
    assert_true(lar_simulation_contact_distance(NULL) == 0);
    assert_true(lar_model_output_interval(NULL) == 0);
    assert_true(lar_model_duration(NULL) == 0);
    lar_rest_begin(NULL, NULL);
    assert_true(lar_rest_look(NULL, NULL) <= 0);
    assert_true(lar_model_damping(NULL) == 0);
    assert_true(lar_model_until_rest(NULL) <= 0);
    lar_session_play(NULL);
    lar_session_pause(NULL);
    lar_session_step(NULL, 0);
    lar_session_set_pace(NULL, 0);
    lar_session_gravity(NULL, NULL);
    assert_true(lar_session_damping(NULL) == 0);
    assert_true(lar_session_stiffness(NULL, 0) == 0);
    lar_session_status_get(NULL, NULL);
    lar_snapshot_destroy(NULL);
    assert_true(lar_session_force_history(NULL, 0, 0, 0, NULL, NULL) <= 0);
    lar_session_seek(NULL, 0);
    text = lar_server_url(NULL);
    assert_true(!text || !*text);
    text = lar_server_watch_url(NULL);
    assert_true(!text || !*text);
    assert_true(lar_server_viewers(NULL) <= 0);
    lar_server_close(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(model_calls),
                                       cmocka_unit_test(models_tell_what_they_are),
                                       cmocka_unit_test(image_calls),
                                       cmocka_unit_test(meshing_calls),
                                       cmocka_unit_test(simulation_calls),
                                       cmocka_unit_test(tool_calls),
                                       cmocka_unit_test(restart_and_picture_calls),
                                       cmocka_unit_test(calls_without_a_status_accept_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
