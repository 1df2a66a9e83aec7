/* Viewers that ask for values: whose turn it is, and what they are told. */
#include <stdio.h>

#include "server/state.h"

static const char *const value_names[LAR_READ_VALUES] = {"von_mises", "pressure", "energy"};

static bool is_there(lar_server *server, lar_viewer *viewer, const lar_command *command,
                     const lar_surface_info *surface) {
    if (command->node < surface->nodes && command->face < surface->faces) return true;
    char sentence[160];
    snprintf(sentence, sizeof sentence,
             "the surface has %d nodes and %d faces, each counted from 0; ask for one of them",
             (int)surface->nodes, (int)surface->faces);
    lar_viewer_note(server, viewer, sentence);
    return false;
}

void lar_server_inspect(lar_server *server, lar_viewer *viewer, const lar_command *command) {
    lar_surface_info surface;
    lar_model_surface(server->model, &surface);
    if (!is_there(server, viewer, command, &surface)) return;
    viewer->question =
        (lar_question){.node = command->node < 0 ? -1 : surface.node[command->node],
                       .element = command->face < 0 ? -1 : surface.element[command->face],
                       .energy = command->energy};
    if (!viewer->inspects) viewer->inspects_since = lar_clock_ns();
    viewer->inspects = true;
}

/* Who has waited longest. One reading at a time: what is saved and loaded does not wait behind
 * many. */
void lar_server_ask_readings(lar_server *server) {
    lar_viewer *next = NULL;
    if (server->reading) return;
    for (lar_viewer *viewer = server->first; viewer; viewer = viewer->next)
        if (viewer->inspects && viewer->closing == LAR_CLOSE_NOT &&
            (!next || viewer->inspects_since < next->inspects_since))
            next = viewer;
    if (!next) return;
    lar_job job = {.kind = LAR_COMMAND_INSPECT, .viewer = next->number, .question = next->question};
    server->reading = lar_work_ask(&server->work, &job);
    if (server->reading) next->inspects = false;
}

static void write_values(lar_json *json, const double value[LAR_READ_VALUES]) {
    for (int i = 0; i < LAR_READ_VALUES; i++) lar_json_number(json, value_names[i], value[i]);
}

static void write_node(const lar_server *server, const lar_job_end *end, lar_json *json) {
    int32_t node = end->job.question.node;
    lar_json_open(json, "node", '{');
    lar_json_integer(json, "index", node);
    lar_json_integer(json, "number", lar_model_node_id(server->model, node));
    lar_json_vector(json, "rest", end->reading.rest, 3);
    lar_json_vector(json, "displacement", end->reading.displacement, 3);
    write_values(json, end->reading.of_node);
    lar_json_close(json);
}

static void write_element(const lar_server *server, const lar_job_end *end, lar_json *json) {
    int32_t element = end->job.question.element;
    lar_json_open(json, "element", '{');
    lar_json_integer(json, "index", element);
    lar_json_integer(json, "number", lar_model_element_id(server->model, element));
    lar_json_integer(json, "material", lar_model_element_material(server->model, element));
    write_values(json, end->reading.of_element);
    lar_json_close(json);
}

static void write_energy(const lar_reading *reading, lar_json *json) {
    lar_json_open(json, "energy", '{');
    lar_json_number(json, "kinetic", reading->kinetic);
    lar_json_number(json, "strain", reading->strain);
    lar_json_number(json, "hourglass", reading->hourglass);
    lar_json_close(json);
}

void lar_server_tell_reading(lar_server *server, const lar_job_end *end) {
    const lar_question *question = &end->job.question;
    lar_viewer *viewer = lar_server_find(server, end->job.viewer);
    lar_json *json = &server->json;
    server->reading = false;
    if (!viewer) return;
    lar_message_begin(json, end->error.status ? "no_values" : "values");
    if (end->error.status) {
        lar_json_text(json, "text", end->error.message);
    } else {
        lar_json_integer(json, "step", (int64_t)end->reading.step);
        lar_json_number(json, "time", end->reading.time);
        if (question->node >= 0) write_node(server, end, json);
        if (question->element >= 0) write_element(server, end, json);
        if (question->energy) write_energy(&end->reading, json);
    }
    lar_viewer_tell(viewer, json);
}
