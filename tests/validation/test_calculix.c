/* Decks for CalculiX, read as they are and followed to rest, against CalculiX's own answers (and
 * FEBio's, of the same element) to the same problems. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "validation/reference.h"

/* ---- writing decks --------------------------------------------------------------------------- */

typedef struct deck {
    FILE *file;
    char *text;
    size_t size;
    const lar_mesh *mesh;
} deck;

/* The mesh of the reference, and its material: C10 = G / 2, D1 = 2 / K. */
static void begin_deck(deck *d, const lar_model *model, double density) {
    const lar_material *material = &model->material[0];
    d->mesh = &model->mesh;
    d->file = open_memstream(&d->text, &d->size);
    assert_non_null(d->file);
    fprintf(d->file, "*NODE\n");
    for (int32_t n = 0; n < d->mesh->node_count; n++)
        fprintf(d->file, "%d, %.17g, %.17g, %.17g\n", n + 1, d->mesh->position[n][0],
                d->mesh->position[n][1], d->mesh->position[n][2]);
    fprintf(d->file, "*ELEMENT, TYPE=C3D8, ELSET=BODY\n");
    for (int32_t e = 0; e < d->mesh->element_count; e++) {
        fprintf(d->file, "%d", e + 1);
        for (int a = 0; a < 8; a++) fprintf(d->file, ", %d", d->mesh->element[e][a] + 1);
        fprintf(d->file, "\n");
    }
    fprintf(d->file, "*MATERIAL, NAME=INH\n*HYPERELASTIC, NEO HOOKE\n%.17g, %.17g\n",
            0.5 * material->parameter[0], 2 / material->parameter[1]);
    if (density > 0) fprintf(d->file, "*DENSITY\n%g\n", density);
    fprintf(d->file, "*SOLID SECTION, ELSET=BODY, MATERIAL=INH\n");
}

/* A set of the nodes at a coordinate. */
static void write_set(deck *d, const lar_model *model, const char *name, int axis, double place) {
    lar_node_list list = nodes_at(model, axis, place);
    fprintf(d->file, "*NSET, NSET=%s\n", name);
    for (int32_t n = 0; n < list.count; n++) fprintf(d->file, "%d,\n", list.node[n] + 1);
    free(list.node);
}

/* Ends the deck and reads it. */
static lar_model *read_deck(deck *d) {
    lar_model *model = NULL;
    lar_error error;
    assert_int_equal(fclose(d->file), 0);
    lar_bytes bytes = {(unsigned char *)d->text, d->size};
    if (lar_inp_deck_parse("deck.inp", &bytes, &model, &error)) fail_msg("%s", error.message);
    free(d->text);
    assert_int_equal(lar_model_until_rest(model), 1);
    return model;
}

static lar_simulation *follow(lar_model *model, lar_element_kind kind) {
    lar_simulation *simulation = start(model, kind);
    lar_rest rest;
    lar_error error;
    begin_report();
    lar_rest_begin(&rest, simulation);
    while (!lar_rest_look(&rest, simulation) && rest.next <= rest.limit)
        if (lar_simulation_advance(simulation, rest.next - lar_simulation_steps(simulation),
                                   &error))
            fail_msg("%s", error.message);
    assert_int_equal(rest.reached, 1);
    return simulation;
}

/* Largest difference of a node's displacement from the reference's, over the largest of those. */
static double worst(const lar_simulation *simulation, const lar_model *model, const char *field) {
    int32_t nodes = model->mesh.node_count;
    double(*u)[3] = lar_calloc((size_t)nodes, sizeof *u), max = 0, largest = 0;
    assert_non_null(u);
    reference_field(field, 1, nodes, u);
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) {
            max = fmax(max, fabs(displacement(simulation, n, i) - u[n][i]));
            largest = fmax(largest, fabs(u[n][i]));
        }
    free(u);
    return max / largest;
}

/* ---- cases ----------------------------------------------------------------------------------- */

/* *BOUNDARY with a displacement that grows over the step. */
static void a_stretched_cube(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    for (int kind = 0; kind < 2; kind++) {
        lar_model *mesh = reference_model("a_2x2x2", 1, 1034.482759, 10000, 1000);
        deck d;
        begin_deck(&d, mesh, 1000);
        write_set(&d, mesh, "X0", 0, 0);
        write_set(&d, mesh, "Y0", 1, 0);
        write_set(&d, mesh, "Z0", 2, 0);
        write_set(&d, mesh, "X1", 0, 1);
        fprintf(d.file, "*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n*STEP, NLGEOM\n*STATIC\n0.1, 1\n"
                        "*BOUNDARY\nX1, 1, 1, 0.5\n*END STEP\n");
        lar_model *model = read_deck(&d);
        lar_simulation *simulation = follow(model, kind ? LAR_ELEMENT_HEX8_FULL : LAR_ELEMENT_HEX8);
        double off = worst(simulation, model, "a_uniax_inh_nu45_C3D8_t1.txt");
        print_message("stretched cube, %s: %.2g%% from CalculiX\n", kind ? "hex8-full" : "hex8",
                      100 * off);
        assert_within(off, 2e-5);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
        lar_model_destroy(mesh);
    }
}

/* *DLOAD, GRAV: the cantilever, 0.01 g. */
static void a_cantilever_under_gravity(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    lar_model *mesh = reference_model("c_beam_20x2x2", 1, 1034.482759, 10000, 1000);
    deck d;
    begin_deck(&d, mesh, 1000);
    write_set(&d, mesh, "X0", 0, 0);
    fprintf(d.file, "*BOUNDARY\nX0, 1, 3\n*STEP, NLGEOM\n*STATIC\n0.1, 1\n*DLOAD\nBODY, GRAV, "
                    "0.0981, 0, 0, -1\n*END STEP\n");
    lar_model *model = read_deck(&d);
    lar_simulation *simulation = follow(model, LAR_ELEMENT_HEX8_FULL);
    double off = worst(simulation, model, "c_beam_inh_nu45_20x2x2_full_t0.01.txt");
    print_message("cantilever, hex8-full: %.2g%% from the same element, after %.3g s\n", 100 * off,
                  lar_simulation_time(simulation));
    assert_within(off, 1e-3);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    lar_model_destroy(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stretched_cube),
        cmocka_unit_test(a_cantilever_under_gravity),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
