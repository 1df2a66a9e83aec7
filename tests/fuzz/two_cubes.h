/* What fuzz targets of whole simulations compute: two cubes with a ball, a grasper and a hand. */
#ifndef LAR_TESTS_FUZZ_TWO_CUBES_H
#define LAR_TESTS_FUZZ_TWO_CUBES_H

#include <stdlib.h>
#include <string.h>

#include "simulation/simulation.h"

enum { NODES = 12 };

static void require(bool good) {
    if (!good) __builtin_trap();
}

static void add_tool(lar_model *model, const char *name, lar_tool_shape shape, double length,
                     double spread) {
    lar_tool *tool = LAR_MODEL_APPEND(model, tool);
    require(tool != NULL);
    *tool = (lar_tool){
        .name = lar_strdup(name),
        .shape = shape,
        .radius = 0.002,
        .length = length,
        .spread = spread,
        .rest = {.position = {0.005, 0.005, 0.1}, .orientation = {1, 0, 0, 0}, .opening = 1}};
}

static lar_model *two_cubes(void) {
    lar_model *model = lar_model_create();
    lar_error error;
    require(model != NULL);
    lar_mesh *mesh = &model->mesh;
    mesh->source = lar_strdup("cubes");
    mesh->node_count = NODES;
    mesh->element_count = 2;
    mesh->position = lar_calloc(NODES, sizeof *mesh->position);
    mesh->node_id = lar_calloc(NODES, sizeof *mesh->node_id);
    mesh->element = lar_calloc(2, sizeof *mesh->element);
    mesh->element_id = lar_calloc(2, sizeof *mesh->element_id);
    mesh->element_tag = lar_calloc(2, sizeof *mesh->element_tag);
    for (int n = 0; n < NODES; n++)
        for (int i = 0; i < 3; i++)
            mesh->position[n][i] = 0.01 * (int[]){n % 4 == 1 || n % 4 == 2, n % 4 > 1, n / 4}[i];
    for (int e = 0; e < 2; e++)
        for (int a = 0; a < 8; a++) mesh->element[e][a] = 4 * e + a;
    lar_material *material = LAR_MODEL_APPEND(model, material);
    require(material != NULL);
    material->density = 1000;
    lar_material_from_shear_bulk(material, 2e3, 2e4);
    model->element_material = lar_calloc(2, sizeof(int32_t));
    add_tool(model, "ball", LAR_TOOL_SPHERE, 0, 0);
    add_tool(model, "grasper", LAR_TOOL_GRASPER, 0.01, 0.5);
    require(lar_model_check(model, &error) == LAR_OK);
    return model;
}

/* Made once and kept: what a load leaves, the next one replaces. */
static lar_simulation *simulation(void) {
    static lar_simulation *made;
    lar_options options = lar_options_default();
    lar_error error;
    options.hands = 1;
    options.isa = LAR_ISA_C;
    if (!made) require(lar_simulation_create(two_cubes(), &options, &made, &error) == LAR_OK);
    return made;
}

#endif
