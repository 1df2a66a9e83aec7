/* Playing a recording: the same inputs at the same steps give the same hashes, on any grid. */
#include <inttypes.h>

#include "session/recording/file.h"
#include "session/session.h"

typedef struct player {
    lar_simulation *simulation;
    lar_recording_reader reader;
    lar_step_callback *callback;
    void *context;
    lar_replay_report *report;
    bool stopped;   /* by the callback */
    uint64_t equal; /* step of the latest hash that was equal; UINT64_MAX: none yet */
} player;

/* ---- whose recording it is ----------------------------------------------------------------- */

static const char *const ELEMENTS[] = {"hex8", "hex8-full", "hex8-matrix"};

static lar_status check_counts(const char *path, const lar_recording_header *header,
                               const lar_mesh *mesh, lar_error *error) {
    if (header->nodes == mesh->node_count && header->elements == mesh->element_count) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: was recorded with another model: %ld nodes and %ld elements instead of "
                    "%ld and %ld; play it with the model that it was recorded with",
                    path, (long)header->nodes, (long)header->elements, (long)mesh->node_count,
                    (long)mesh->element_count);
}

lar_status lar_recording_check_simulation(const char *path, const lar_recording_header *header,
                                          const lar_simulation *simulation, lar_error *error) {
    const lar_domain *domain = &simulation->domain;
    int32_t spares = simulation->list.spares, tools = lar_spares_first(&simulation->list);
    lar_status status = check_counts(path, header, &domain->model->mesh, error);
    if (status) return status;
    if (header->time_step != domain->time_step)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: was recorded with a time step of %.17g s, this simulation has %.17g "
                        "s; choose the same",
                        path, header->time_step, domain->time_step);
    if (header->element != domain->kind)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: was recorded with elements %s, this simulation has %s; choose the "
                        "same",
                        path, ELEMENTS[header->element], ELEMENTS[domain->kind]);
    if (header->tools != tools)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: was recorded with %ld tools, %ld hands among them, and this "
                        "simulation has %ld tools; create it with options.hands = %ld",
                        path, (long)header->tools, (long)header->hands, (long)tools,
                        (long)header->hands);
    if (header->spares > spares)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: was recorded where %ld tools could be added, and this simulation has "
                        "places for %ld; create it with options.spares = %ld",
                        path, (long)header->spares, (long)spares, (long)header->spares);
    return LAR_OK;
}

/* ---- records ------------------------------------------------------------------------------- */

/* Steps between two looks, also where ticks are long. */
static const uint64_t PART_MAX = 1000;

static void look(player *p) {
    p->simulation->calling = 2;
    p->stopped = p->callback && !p->callback(p->context, lar_simulation_steps(p->simulation));
    p->simulation->calling = 0;
}

static lar_status advance_to(player *p, uint64_t step, lar_error *error) {
    lar_status status = LAR_OK;
    uint64_t now = lar_simulation_steps(p->simulation);
    while (now < step && !status && !p->stopped) {
        uint64_t steps = step - now;
        if (steps > p->reader.header.tick_steps) steps = p->reader.header.tick_steps;
        if (steps > PART_MAX) steps = PART_MAX;
        status = lar_simulation_compute(p->simulation, steps, NULL, NULL, error);
        now = lar_simulation_steps(p->simulation);
        if (status) break;
        p->report->steps += steps;
        look(p);
    }
    return status;
}

static lar_status compare(player *p, const lar_record *record, lar_error *error) {
    lar_status status = lar_simulation_gather(p->simulation, error);
    if (status) return status;
    uint64_t hash = lar_simulation_hash(p->simulation);
    p->report->hashes++;
    p->report->recorded_hash = record->hash;
    p->report->replayed_hash = hash;
    if (hash == record->hash) {
        p->equal = record->step;
        return LAR_OK;
    }
    p->report->different = record->step;
    char before[80] = "no hash before it was compared";
    if (p->equal != UINT64_MAX)
        snprintf(before, sizeof before, "at step %" PRIu64 " it was still equal", p->equal);
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: at step %" PRIu64 " the state hash is %016" PRIx64 ", and %016" PRIx64
                    " was recorded; %s: the recording was altered, or the Lariat that made it "
                    "computes differently",
                    p->reader.path, record->step, hash, record->hash, before);
}

static lar_status take_state(player *p, const lar_record *record, lar_error *error) {
    lar_bytes state = {0};
    lar_status status = lar_recording_state(&p->reader, record, &state, error);
    if (!status) status = lar_simulation_unpack(p->simulation, p->reader.path, &state, error);
    lar_bytes_free(&state);
    if (!status && lar_simulation_steps(p->simulation) != record->step)
        return lar_recording_refuse(&p->reader, error,
                                    "has a state of another step; it was altered");
    if (!status) look(p);
    return status;
}

static lar_status reset(player *p, lar_error *error) {
    lar_status status = lar_simulation_reset(p->simulation, error);
    if (!status) look(p);
    return status;
}

static lar_status move(player *p, const lar_record *record, lar_error *error) {
    lar_error cause;
    lar_status status =
        lar_simulation_tool_move(p->simulation, record->tool, &record->pose, record->steps, &cause);
    if (!status) return LAR_OK;
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: record %" PRIu64 ", at step %" PRIu64
                    ", moves a tool where it cannot go: %s",
                    p->reader.path, p->reader.number, record->step, cause.message);
}

static lar_status set(player *p, const lar_record *record, lar_error *error) {
    lar_error cause;
    lar_status status = lar_setting_apply(&record->setting, p->simulation, &cause);
    if (status == LAR_ERROR_PEER && error) *error = cause;
    if (!status || status == LAR_ERROR_PEER) return status;
    return lar_fail(error, status == LAR_ERROR_MODEL ? status : LAR_ERROR_FORMAT,
                    "%s: record %" PRIu64 ", at step %" PRIu64 ", sets what cannot be: %s",
                    p->reader.path, p->reader.number, record->step, cause.message);
}

static lar_status play(player *p, const lar_record *record, lar_error *error) {
    if (record->kind == LAR_RECORD_STATE) return take_state(p, record, error);
    if (p->reader.number == 1)
        return lar_recording_refuse(
            &p->reader, error, "is not the state that a recording begins with; it was altered");
    lar_status status = advance_to(p, record->step, error);
    /* Before the end of a run that has not broken stands its hash: nothing is left to compute. */
    p->report->broken = status == LAR_ERROR_UNSTABLE && record->kind == LAR_RECORD_END;
    if (status || p->stopped) return status;
    if (record->kind == LAR_RECORD_MOVE) return move(p, record, error);
    if (record->kind == LAR_RECORD_SET) return set(p, record, error);
    if (record->kind == LAR_RECORD_HASH) return compare(p, record, error);
    if (record->kind == LAR_RECORD_RESET) return reset(p, error);
    return lar_recording_check_end(&p->reader, error);
}

lar_status lar_replay(lar_simulation *simulation, const char *path, lar_step_callback *callback,
                      void *context, lar_replay_report *report, lar_error *error) {
    lar_replay_report found = {.different = UINT64_MAX};
    player p = {.simulation = simulation,
                .callback = callback,
                .context = context,
                .report = &found,
                .equal = UINT64_MAX};
    if (!path)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "lar_replay needs the path of a recording");
    lar_status status = lar_simulation_check_idle(simulation, "lar_replay", error);
    if (status) return status;
    status = lar_recording_open(path, &p.reader, error);
    if (status) return status;
    lar_record record = {.kind = LAR_RECORD_STATE};
    status = lar_recording_check_simulation(p.reader.path, &p.reader.header, simulation, error);
    while (!status && !p.stopped && record.kind != LAR_RECORD_END) {
        status = lar_recording_next(&p.reader, &record, error);
        if (!status) status = play(&p, &record, error);
    }
    lar_recording_close(&p.reader);
    if (report) *report = found;
    return status;
}

lar_status lar_recording_inspect(const char *path, lar_recording_info *info, lar_error *error) {
    lar_recording_reader reader;
    if (!path || !info)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_recording_inspect needs the path of a recording and a place for the "
                        "answer");
    lar_status status = lar_recording_open(path, &reader, error);
    if (status) return status;
    *info = (lar_recording_info){.element = reader.header.element,
                                 .nodes = reader.header.nodes,
                                 .elements = reader.header.elements,
                                 .tools = reader.header.tools,
                                 .hands = reader.header.hands,
                                 .time_step = reader.header.time_step,
                                 .tick_steps = reader.header.tick_steps,
                                 .spares = reader.header.spares};
    lar_recording_close(&reader);
    return LAR_OK;
}
