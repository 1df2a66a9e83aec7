#include "server/reading.h"

static const lar_field value_table[LAR_READ_VALUES] = {LAR_FIELD_VON_MISES, LAR_FIELD_PRESSURE,
                                                       LAR_FIELD_ENERGY};

lar_status lar_reading_take(const lar_simulation *simulation, const lar_question *question,
                            const lar_snapshot *snapshot, lar_reading *reading, lar_error *error) {
    const double(*u)[3] = (const double(*)[3])snapshot->u;
    int32_t node = question->node, element = question->element;
    lar_simulation_info info;
    lar_status status = LAR_OK;
    lar_simulation_inspect(simulation, &info);
    *reading =
        (lar_reading){.step = snapshot->step, .time = snapshot->time, .kinetic = snapshot->kinetic};
    for (int i = 0; i < 3 && node >= 0; i++) {
        reading->rest[i] = lar_model_positions(info.model)[node][i];
        reading->displacement[i] = u[node][i];
    }
    for (int i = 0; i < LAR_READ_VALUES && !status; i++) {
        if (node >= 0)
            status = lar_simulation_node_value(simulation, value_table[i], node, u,
                                               &reading->of_node[i], error);
        if (!status && element >= 0)
            status = lar_simulation_element_value(simulation, value_table[i], element, u,
                                                  &reading->of_element[i], error);
    }
    if (!status && question->energy)
        status = lar_simulation_stored_energy(simulation, u, &reading->strain, &reading->hourglass,
                                              error);
    return status;
}
