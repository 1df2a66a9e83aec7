#include "server/reading.h"

#include <float.h>
#include <math.h>

#include "simulation/field.h"

static const lar_field value_table[LAR_READ_VALUES] = {LAR_FIELD_VON_MISES, LAR_FIELD_PRESSURE,
                                                       LAR_FIELD_ENERGY};

static bool has_node(const lar_mesh *mesh, lar_gid e, int32_t node) {
    for (int a = 0; a < 8; a++)
        if (mesh->element[e][a] == node) return true;
    return false;
}

static lar_status read_element(const lar_simulation *simulation, lar_gid e,
                               const lar_snapshot *snapshot, double out[LAR_READ_VALUES],
                               lar_error *error) {
    lar_status status = LAR_OK;
    for (int i = 0; i < LAR_READ_VALUES && !status; i++)
        status = lar_field_of_element(simulation, value_table[i], e,
                                      (const double(*)[3])snapshot->u, &out[i], error);
    return status;
}

/* The mean of the elements around, each counting the same, as in lar_field_of_elements. */
static lar_status read_node(const lar_simulation *simulation, const lar_mesh *mesh, int32_t node,
                            const lar_snapshot *snapshot, lar_reading *reading, lar_error *error) {
    int count[LAR_READ_VALUES] = {0};
    for (int i = 0; i < 3; i++) {
        reading->rest[i] = mesh->position[node][i];
        reading->displacement[i] = snapshot->u[node][i];
    }
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        double value[LAR_READ_VALUES];
        if (!has_node(mesh, e, node)) continue;
        lar_status status = read_element(simulation, e, snapshot, value, error);
        if (status) return status;
        for (int i = 0; i < LAR_READ_VALUES; i++) {
            if (!(fabs(value[i]) <= (double)FLT_MAX)) continue;
            reading->of_node[i] += value[i];
            count[i]++;
        }
    }
    for (int i = 0; i < LAR_READ_VALUES; i++)
        if (count[i] > 0) reading->of_node[i] /= count[i];
    return LAR_OK;
}

lar_status lar_reading_take(const lar_simulation *simulation, const lar_model *model,
                            const lar_question *question, const lar_snapshot *snapshot,
                            lar_reading *reading, lar_error *error) {
    lar_status status = LAR_OK;
    *reading =
        (lar_reading){.step = snapshot->step, .time = snapshot->time, .kinetic = snapshot->kinetic};
    if (question->node >= 0)
        status = read_node(simulation, &model->mesh, question->node, snapshot, reading, error);
    if (!status && question->element >= 0)
        status = read_element(simulation, question->element, snapshot, reading->of_element, error);
    if (!status && question->energy)
        status = lar_field_stored_energy(simulation, (const double(*)[3])snapshot->u,
                                         &reading->strain, &reading->hourglass, error);
    return status;
}
