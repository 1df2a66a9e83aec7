#include "meshing/starter/slowest.h"

#include <math.h>
#include <stdlib.h>

#include "model/supports.h"

lar_status lar_ways_create(const lar_mesh *mesh, lar_ways *ways, lar_error *error) {
    size_t nodes = (size_t)mesh->node_count;
    *ways = (lar_ways){.mesh = mesh,
                       .material = lar_calloc((size_t)mesh->element_count, sizeof *ways->material),
                       .still = lar_calloc(nodes, sizeof *ways->still),
                       .mass = lar_calloc(nodes, sizeof *ways->mass),
                       .load = lar_calloc(nodes, sizeof *ways->load),
                       .way = lar_calloc(nodes, sizeof *ways->way)};
    return ways->material && ways->still && ways->mass && ways->load && ways->way
               ? LAR_OK
               : lar_fail_memory(error, 200 * nodes, "an estimate of motion");
}

void lar_ways_clear(lar_ways *ways) {
    lar_elastic_solver_destroy(ways->solver);
    free(ways->elastic.element);
    free(ways->material);
    free(ways->still);
    free(ways->spring);
    free(ways->mass);
    free(ways->load);
    free(ways->way);
}

void lar_ways_weigh(lar_ways *ways, lar_gid e, double density, lar_elastic_material material) {
    double corner[8][3];
    lar_mesh_corners(ways->mesh, e, corner);
    double eighth = density * lar_hexahedron_volume(corner) / 8;
    ways->material[e] = material;
    for (int a = 0; a < 8; a++) ways->mass[ways->mesh->element[e][a]] += eighth;
}

lar_status lar_ways_solve(lar_ways *ways, lar_error *error) {
    lar_status status =
        ways->solver ? LAR_OK : lar_elastic_solver_create(&ways->elastic, &ways->solver, error);
    return status ? status
                  : lar_elastic_solve(ways->solver, (const lar_load_vectors *)ways->load, ways->way,
                                      ways->work, error);
}

double lar_ways_slowest(const lar_ways *ways) {
    double min = INFINITY;
    LAR_EACH_LOAD {
        double moved = 0;
        for (int32_t n = 0; n < ways->mesh->node_count; n++)
            for (int i = 0; i < 3; i++)
                moved += ways->mass[n] * ways->way[n][i][l] * ways->way[n][i][l];
        if (moved > 0 && ways->work[l] > 0) min = fmin(min, sqrt(ways->work[l] / moved));
    }
    return isfinite(min) ? min : 0;
}

/* Weight along each axis; the last turns about all of them. */
static void load_first(lar_ways *ways) {
    for (int32_t n = 0; n < ways->mesh->node_count; n++)
        for (int i = 0; i < 3; i++) {
            ways->load[n][i][i] = ways->mass[n];
            ways->load[n][i][3] = ways->mass[n] * ways->mesh->position[n][(i + 1) % 3];
        }
}

static lar_status lay_springs(lar_ways *ways, const lar_model *model, lar_error *error) {
    size_t bytes = (size_t)model->mesh.node_count * sizeof *ways->spring;
    if (model->spring_count == 0) return LAR_OK;
    ways->spring = lar_calloc(bytes, 1);
    if (!ways->spring) return lar_fail_memory(error, bytes, "an estimate of motion");
    for (int i = 0; i < model->spring_count; i++)
        for (int32_t k = 0; k < model->spring[i].nodes.count; k++)
            ways->spring[model->spring[i].nodes.node[k]] += model->spring[i].stiffness[k];
    return LAR_OK;
}

double lar_slowest_motion(const lar_model *model) {
    enum { TIMES = 2 };
    lar_ways ways;
    lar_error ignored;
    double slowest = 0;
    lar_status status = lar_ways_create(&model->mesh, &ways, &ignored);
    for (lar_gid e = 0; !status && e < model->mesh.element_count; e++) {
        const lar_material *of = lar_model_material_of(model, e);
        lar_ways_weigh(&ways, e, of->density,
                       (lar_elastic_material){lar_material_shear(of), lar_material_bulk(of), true});
    }
    if (!status) status = lay_springs(&ways, model, &ignored);
    if (!status) {
        lar_supports_mark(NULL, model, ways.still);
        status = lar_elastic_create(ways.mesh, ways.material, ways.still, ways.spring,
                                    &ways.elastic, &ignored);
        load_first(&ways);
    }
    for (int k = 0; !status && k < TIMES; k++) {
        status = lar_ways_solve(&ways, &ignored);
        slowest = lar_ways_slowest(&ways);
        for (int32_t n = 0; n < ways.mesh->node_count; n++)
            for (int i = 0; i < 3; i++) ways.load[n][i] = ways.mass[n] * ways.way[n][i];
    }
    lar_ways_clear(&ways);
    return slowest;
}
