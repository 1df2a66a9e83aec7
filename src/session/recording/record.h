/* Recording while the engine runs.
 *
 *     engine's thread ---ring of records---> writer's thread ---> file
 *
 * The engine only fills places of a ring; the file is written by a thread of its own, which looks
 * twenty times a second and hands everything over to the system. A ring that runs full ends the
 * recording, never a tick: whoever closes it is told. A state is a record, too: packed by the
 * engine, written and freed by the writer.
 */
#ifndef LAR_SESSION_RECORDING_RECORD_H
#define LAR_SESSION_RECORDING_RECORD_H

#include <pthread.h>

#include "simulation/simulation.h"
#include "session/recording/file.h"

typedef struct lar_recorder lar_recorder;

/* Creates the file and starts the thread. A file that is there and is no recording is refused. */
lar_status lar_recorder_create(const char *path, const lar_recording_header *header,
                               lar_recorder **recorder, lar_error *error);
/* Writes what is left and closes the file. Frees the recorder, also on failure. NULL is fine. Any
 * thread, when the engine has let go of it. */
lar_status lar_recorder_close(lar_recorder *recorder, lar_error *error);

/* The engine, between advances, without waiting. False when the recording is over: the ring was
 * full, the disk was, or a state could not be recorded. */
bool lar_recorder_put(lar_recorder *recorder, const lar_record *record);
/* The engine, after that: why. */
void lar_recorder_why(const lar_recorder *recorder, lar_error *error);
/* The same with the simulation's present state. A failure ends the recording, and whoever closes it
 * is told. */
lar_status lar_recorder_put_state(lar_recorder *recorder, const lar_simulation *simulation,
                                  lar_error *error);

#endif
