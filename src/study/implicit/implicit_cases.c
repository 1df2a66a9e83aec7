/* The bodies of the implicit comparison that are made in memory (bench_implicit.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/mesh/surface.h"
#include "study/implicit/bench_implicit.h"
#include "study/bench/kernel.h"

static const double pi = 3.14159265358979323846;

typedef struct implicit_body {
    const char *title;
    int32_t edge[3]; /* hexahedra */
    bool general;    /* no element is a box */
    double shear, bulk, damping, duration;
} implicit_body;

static const implicit_body body_of[LAR_IMPLICIT_CASES] = {
    [LAR_IMPLICIT_SLOW] = {"Block, loaded slowly", {6, 6, 6}, true, 2e3, 2e4, 20, 0.5},
    [LAR_IMPLICIT_BUCKLE] = {"Arch that buckles", {24, 2, 2}, false, 2e3, 2e4, 20, 1},
    [LAR_IMPLICIT_LOOSE] = {"Block with a loose piece", {6, 2, 2}, false, 2e3, 2e4, 5, 0.2}};

/* Nodes whose place x fastest, is `at` along x, and beyond `min` along y and z. */
static lar_status list(const implicit_body *b, int at, const int min[2], lar_node_list *nodes,
                       lar_error *error) {
    int32_t wide = b->edge[0] + 1, deep = b->edge[1] + 1, high = b->edge[2] + 1;
    nodes->node = lar_calloc((size_t)deep * (size_t)high, sizeof *nodes->node);
    if (!nodes->node) return lar_fail_memory(error, (size_t)deep * 4, "a set of nodes");
    for (int32_t z = min[1]; z < high; z++)
        for (int32_t y = min[0]; y < deep; y++)
            nodes->node[nodes->count++] = at + wide * (y + deep * z);
    return LAR_OK;
}

static lar_status hold(lar_model *model, const implicit_body *b, int at, lar_error *error) {
    lar_fix *fix = LAR_MODEL_APPEND(model, fix);
    if (!fix) return lar_fail_memory(error, sizeof *fix, "a support");
    fix->axes = LAR_AXIS_X | LAR_AXIS_Y | LAR_AXIS_Z;
    return list(b, at, (int[2]){0, 0}, &fix->nodes, error);
}

/* `total` newtons on the nodes of a list, shared equally, growing smoothly `over` seconds. */
static lar_status pull(lar_model *model, const implicit_body *b, int at, const int min[2],
                       const double total[3], double over, lar_error *error) {
    lar_curve *curve = LAR_MODEL_APPEND(model, curve);
    lar_nodal_load *load = LAR_MODEL_APPEND(model, load);
    if (!curve || !load) return lar_fail_memory(error, sizeof *load, "a load");
    *curve = (lar_curve){.kind = LAR_CURVE_RAMP, .over = over};
    load->curve = model->curve_count - 1;
    lar_status status = list(b, at, min, &load->nodes, error);
    for (int i = 0; i < 3 && !status; i++) load->force[i] = total[i] / load->nodes.count;
    return status;
}

/* 48 mm long, 4 mm thick and wide, a cosine of 5 mm rise; symmetric to the last bit, so that
 * nothing but rounding says to which side it leans. */
static lar_status make_arch(lar_model *model, const implicit_body *b, lar_error *error) {
    lar_mesh *mesh = &model->mesh;
    double cell = mesh->position[b->edge[0]][0] / b->edge[0];
    for (int32_t n = 0; n < mesh->node_count; n++) {
        double *x = mesh->position[n], along = x[0] / (cell * b->edge[0]);
        for (int i = 0; i < 3; i++) x[i] *= 0.002 / cell;
        x[2] += 0.0025 * (1 - cos(2 * pi * along));
    }
    lar_status status = hold(model, b, 0, error);
    if (!status) status = hold(model, b, b->edge[0], error);
    if (!status)
        status = pull(model, b, b->edge[0] / 2, (int[2]){0, 2}, (double[3]){0, 0, -0.012},
                      b->duration, error);
    return status;
}

/* Without the elements of the fourth layer along x: what is beyond hangs on nothing. */
static lar_status cut_loose(lar_model *model, const implicit_body *b, lar_error *error) {
    lar_mesh *mesh = &model->mesh;
    int32_t kept = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        if (e % b->edge[0] == 3) continue;
        memcpy(mesh->element[kept], mesh->element[e], sizeof mesh->element[e]);
        mesh->element_id[kept++] = mesh->element_id[e];
    }
    mesh->element_count = kept;
    model->gravity[2] = -2;
    return hold(model, b, 0, error);
}

lar_status lar_implicit_case_create(lar_implicit_case which, lar_model **model, lar_error *error) {
    const implicit_body *b = &body_of[which];
    lar_model *made;
    lar_status status = lar_bench_block(b->edge, b->general, &made, error);
    if (status) return status;
    lar_material_from_shear_bulk(&made->material[0], b->shear, b->bulk);
    made->damping = b->damping;
    made->duration = b->duration;
    free(made->title);
    made->title = lar_strdup(b->title);
    if (!made->title) status = lar_fail_memory(error, strlen(b->title), "a title");
    if (!status && which == LAR_IMPLICIT_SLOW) {
        status = hold(made, b, 0, error);
        if (!status)
            status = pull(made, b, b->edge[0], (int[2]){0, 0}, (double[3]){0.3, 0.05, 0.1},
                          0.8 * b->duration, error);
    }
    if (!status && which == LAR_IMPLICIT_BUCKLE) status = make_arch(made, b, error);
    if (!status && which == LAR_IMPLICIT_LOOSE) status = cut_loose(made, b, error);
    lar_surface_clear(&made->surface); /* the mesh has changed */
    if (!status) status = lar_mesh_check(&made->mesh, error);
    if (!status) status = lar_model_check(made, error);
    if (status)
        lar_model_destroy(made);
    else
        *model = made;
    return status;
}
