/* The file of a recording: what went into a simulation, and what came out (docs/formats.md).
 *
 *     header | state | record | record | ... | end
 *              ^ a checkpoint: where it begins, and again after every load
 *
 *     record: kind, length | payload, whole words | checksum of it and of all before
 *
 * Words are little-endian. The checksums are a chain, so that a record that is damaged, missing,
 * doubled or moved is found at its place, and a file without `end` is one whose writer was killed:
 * everything before the first incomplete record still holds. Nothing is read further than it is
 * checked, and no more memory is taken than one record: a state at most.
 */
#ifndef LAR_SESSION_RECORDING_FILE_H
#define LAR_SESSION_RECORDING_FILE_H

#include <stdbool.h>
#include <stdio.h>

#include "base/memory.h"
#include "session/setting.h"

/* What the recording was made with. */
typedef struct lar_recording_header {
    lar_element_kind element;
    int32_t nodes, elements; /* of the model */
    int32_t tools, hands;    /* without spares; hands are the last ones of the tools */
    double time_step;        /* [s] */
    uint64_t tick_steps, hash_every;
    int32_t spares; /* tools that could be added, behind all others */
} lar_recording_header;

typedef enum lar_record_kind {
    LAR_RECORD_STATE = 1, /* a checkpoint of `bytes` bytes: the simulation is there now */
    LAR_RECORD_MOVE,      /* lar_simulation_tool_move(tool, pose, steps) at step */
    LAR_RECORD_HASH,      /* the state hash at step */
    LAR_RECORD_RESET,     /* lar_simulation_reset at step */
    LAR_RECORD_END,       /* at step; nothing follows */
    LAR_RECORD_SET        /* lar_setting_apply(setting) at step */
} lar_record_kind;

typedef struct lar_record {
    lar_record_kind kind;
    int32_t tool;
    uint64_t step;
    uint64_t steps, hash;
    lar_tool_pose pose;
    lar_setting setting;
    uint64_t bytes; /* of a state, in the file behind this */
} lar_record;

/* ---- writing ------------------------------------------------------------------------------- */

typedef struct lar_recording_writer {
    const char *path; /* borrowed */
    FILE *file;
    uint64_t checksum;
    uint64_t words, begun; /* put so far, and when the first state was complete; 0: not yet */
    int cause;             /* errno of the first failure; 0: none */
} lar_recording_writer;

/* Creates the file. One that is there is written over when it is a recording, or empty, and refused
 * otherwise. */
lar_status lar_recording_create(const char *path, const lar_recording_header *header,
                                lar_recording_writer *writer, lar_error *error);
/* Adds a record that is no state. A failure is kept and told by lar_recording_finish. */
void lar_recording_put(lar_recording_writer *writer, const lar_record *record);
/* Adds a state: the bytes of a checkpoint (simulation/checkpoint.h). */
void lar_recording_put_state(lar_recording_writer *writer, uint64_t step, const lar_bytes *state);
/* Hands over to the system what has been put so far: it outlives this process. */
void lar_recording_flush(lar_recording_writer *writer);
/* LAR_ERROR_IO, and what `cause` (an errno) means for the recording. */
lar_status lar_recording_incomplete(const char *path, int cause, lar_error *error);
/* Closes; LAR_ERROR_IO when something could not be written, and when that was not even a whole
 * first state the file is removed. Twice is fine. */
lar_status lar_recording_finish(lar_recording_writer *writer, lar_error *error);
/* Closes this process's copy of the file without a word in it. */
void lar_recording_forget(lar_recording_writer *writer);

/* ---- reading ------------------------------------------------------------------------------- */

typedef struct lar_recording_reader {
    const char *path; /* borrowed */
    FILE *file;
    uint64_t size, at; /* bytes; `at` is where the record under way begins */
    uint64_t checksum;
    uint64_t number; /* records so far */
    uint64_t step;   /* of the latest record */
    uint64_t known;  /* of the latest state, reset or hash */
    lar_recording_header header;
} lar_recording_reader;

/* LAR_ERROR_FORMAT: no recording, of another version, or damaged. */
lar_status lar_recording_open(const char *path, lar_recording_reader *reader, lar_error *error);
void lar_recording_close(lar_recording_reader *reader); /* twice is fine */

/* The next record. A state must be fetched by lar_recording_state before the next one.
 * LAR_ERROR_FORMAT when it is cut off or damaged, or when the file ends without `end`. */
lar_status lar_recording_next(lar_recording_reader *reader, lar_record *record, lar_error *error);
/* The bytes of a state, which the caller frees; LAR_ERROR_FORMAT when it is damaged. */
lar_status lar_recording_state(lar_recording_reader *reader, const lar_record *record,
                               lar_bytes *state, lar_error *error);

/* Behind the end there is nothing. */
lar_status lar_recording_check_end(const lar_recording_reader *reader, lar_error *error);

/* Whether a simulation can play what this header begins; LAR_ERROR_MODEL says why not. */
lar_status lar_recording_check_simulation(const char *path, const lar_recording_header *header,
                                          const lar_simulation *simulation, lar_error *error);

/* The error of a file that breaks the rules at the record under way. */
lar_status lar_recording_refuse(const lar_recording_reader *reader, lar_error *error,
                                const char *what);

#endif
