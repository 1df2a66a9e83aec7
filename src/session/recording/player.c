#include "session/recording/player.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* So much memory may a recording take, and its keys [bytes]; simulated time between keys at first
 * [s]. */
static const size_t RECORD_BYTES = (size_t)512 << 20, KEY_BYTES = (size_t)256 << 20;
static const double KEY_SECONDS = 0.25;

/* ---- reading ------------------------------------------------------------------------------- */

static lar_status add_record(lar_player *p, lar_recording_reader *reader, const lar_record *record,
                             uint64_t *step, lar_error *error) {
    if ((p->count + 1) * sizeof *p->record > RECORD_BYTES)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: is too long to be played in the viewer; play it with lariat replay",
                        p->path);
    if (!LAR_GROW(p->record, p->capacity, p->count))
        return lar_fail_memory(error, sizeof *p->record, p->path);
    lar_play_record *added = &p->record[p->count];
    *added = (lar_play_record){.record = *record, .place = p->length};
    if (record->kind == LAR_RECORD_STATE) {
        lar_status status = lar_recording_state(reader, record, &added->state, error);
        if (status) return status;
        *step = record->step;
    } else {
        if (record->step > *step) p->length += record->step - *step;
        *step = record->kind == LAR_RECORD_RESET ? 0 : record->step;
        added->place = p->length;
    }
    p->count++;
    return LAR_OK;
}

static lar_status read_records(lar_player *p, lar_recording_reader *reader, lar_error *error) {
    lar_record record = {.kind = LAR_RECORD_STATE};
    uint64_t step = 0;
    lar_status status = LAR_OK;
    while (!status && record.kind != LAR_RECORD_END) {
        status = lar_recording_next(reader, &record, error);
        if (!status && p->count == 0 && record.kind != LAR_RECORD_STATE)
            status = lar_recording_refuse(
                reader, error, "is not the state that a recording begins with; it was altered");
        if (!status) status = add_record(p, reader, &record, &step, error);
    }
    return status ? status : lar_recording_check_end(reader, error);
}

lar_status lar_player_open(const char *path, lar_player **out, lar_error *error) {
    lar_recording_reader reader;
    lar_player *p = lar_calloc(1, sizeof *p);
    if (!p) return lar_fail_memory(error, sizeof *p, path);
    p->path = lar_strdup(path);
    lar_status status = p->path ? LAR_OK : lar_fail_memory(error, strlen(path), path);
    if (!status) status = lar_recording_open(p->path, &reader, error);
    if (!status) {
        p->header = reader.header;
        status = read_records(p, &reader, error);
        lar_recording_close(&reader);
    }
    if (status)
        lar_player_close(p);
    else
        *out = p;
    return status;
}

void lar_player_close(lar_player *p) {
    if (!p) return;
    for (size_t i = 0; i < p->count; i++) lar_bytes_free(&p->record[i].state);
    for (int i = 0; i < p->keys; i++) lar_bytes_free(&p->key[i].state);
    free(p->record);
    free(p->path);
    free(p);
}

/* ---- keys ---------------------------------------------------------------------------------- */

/* Every second one goes, but for the first; those to come are twice as far apart. */
static void thin_keys(lar_player *p) {
    int kept = 1;
    for (int i = 1; i < p->keys; i++)
        if (i % 2 == 0)
            p->key[kept++] = p->key[i];
        else
            lar_bytes_free(&p->key[i].state);
    p->keys = kept;
    p->key_every *= 2;
}

/* Keeps the present state when it is time to. */
static lar_status keep_key(lar_player *p, lar_simulation *simulation, lar_error *error) {
    if (p->keys > 0 && p->place < p->key[p->keys - 1].place + p->key_every) return LAR_OK;
    lar_play_key key = {.place = p->place, .next = p->next};
    lar_status status = lar_simulation_gather(simulation, error);
    if (!status) status = lar_simulation_pack(simulation, p->path, &key.state, error);
    if (status) return status;
    size_t max = KEY_BYTES / key.state.size;
    p->keys_max = max > LAR_KEYS_MAX ? LAR_KEYS_MAX : max < 4 ? 4 : (int)max;
    if (p->keys >= p->keys_max) thin_keys(p);
    p->key[p->keys++] = key;
    return LAR_OK;
}

/* ---- playing ------------------------------------------------------------------------------- */

static lar_status compare(const lar_player *p, lar_simulation *simulation, const lar_record *record,
                          lar_error *error) {
    lar_status status = lar_simulation_gather(simulation, error);
    if (status || lar_simulation_hash(simulation) == record->hash) return status;
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: at step %" PRIu64 " the state hash is %016" PRIx64 ", and %016" PRIx64
                    " was recorded: the recording was altered, or the Lariat that made it computes "
                    "differently",
                    p->path, record->step, lar_simulation_hash(simulation), record->hash);
}

static lar_status apply(lar_player *p, lar_simulation *simulation, const lar_play_record *at,
                        lar_error *error) {
    const lar_record *record = &at->record;
    switch (record->kind) {
    case LAR_RECORD_STATE:
        return lar_simulation_unpack(simulation, p->path, &at->state, error);
    case LAR_RECORD_MOVE:
        return lar_simulation_tool_move(simulation, record->tool, &record->pose, record->steps,
                                        error);
    case LAR_RECORD_SET:
        return lar_setting_apply(&record->setting, simulation, error);
    case LAR_RECORD_HASH:
        return compare(p, simulation, record, error);
    case LAR_RECORD_RESET:
        return lar_simulation_reset(simulation, error);
    default:
        return LAR_OK;
    }
}

/* Records of the present place. */
static lar_status apply_due(lar_player *p, lar_simulation *simulation, lar_error *error) {
    lar_status status = LAR_OK;
    while (!status && p->next < p->count && p->record[p->next].place <= p->place) {
        status = apply(p, simulation, &p->record[p->next], error);
        if (!status) p->next++;
    }
    return status;
}

lar_status lar_player_begin(lar_player *p, lar_simulation *simulation, lar_error *error) {
    p->place = p->goal = 0;
    p->next = 0;
    lar_status status = lar_recording_check_simulation(p->path, &p->header, simulation, error);
    if (!status) status = apply(p, simulation, &p->record[p->next++], error);
    p->key_every = (uint64_t)(KEY_SECONDS / p->header.time_step) + 1;
    return status ? status : keep_key(p, simulation, error);
}

lar_status lar_player_advance(lar_player *p, lar_simulation *simulation, uint64_t steps,
                              lar_error *error) {
    uint64_t until = p->length - p->place < steps ? p->length : p->place + steps;
    lar_status status = keep_key(p, simulation, error);
    while (!status && p->place < until) {
        status = apply_due(p, simulation, error);
        if (status) break;
        uint64_t next = p->next < p->count ? p->record[p->next].place : until;
        uint64_t part = (next < until ? next : until) - p->place;
        status = lar_simulation_compute(simulation, part, NULL, NULL, error);
        if (!status) p->place += part;
    }
    if (!status && p->place == p->length) status = apply_due(p, simulation, error);
    /* Where the recorded run broke this one does, too: there it ends. */
    bool last = p->next < p->count && p->record[p->next].record.kind == LAR_RECORD_END;
    if (status == LAR_ERROR_UNSTABLE && last) {
        uint64_t end = p->place;
        status = lar_player_seek(p, simulation, p->key[p->keys - 1].place, error);
        p->length = end;
    }
    return status;
}

lar_status lar_player_seek(lar_player *p, lar_simulation *simulation, uint64_t place,
                           lar_error *error) {
    p->goal = place < p->length ? place : p->length;
    if (p->goal >= p->place) return LAR_OK;
    int i = p->keys - 1;
    while (i > 0 && p->key[i].place > p->goal) i--;
    lar_status status = lar_simulation_unpack(simulation, p->path, &p->key[i].state, error);
    if (status) return status;
    p->place = p->key[i].place;
    p->next = p->key[i].next;
    return LAR_OK;
}
