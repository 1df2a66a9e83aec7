/* Schedules as text, one file per processor, docs/formats.md:
 *
 *     lariat-schedule 1
 *     grid 2x2x3
 *     processor 4
 *     ...
 *     end
 *
 * A file that is damaged, or does not fit the mesh, is refused with file and line. Whether the
 * schedules of all processors fit each other is for schedule_proof.h.
 */
#ifndef LAR_DIVIDE_SCHEDULE_FILE_H
#define LAR_DIVIDE_SCHEDULE_FILE_H

#include "divide/schedule/schedule.h"

/* Name of a processor's file in a folder, "FOLDER/processor-0004.schedule"; freed by the caller,
 * NULL without memory. */
char *lar_schedule_path(const char *folder, int32_t processor);

/* Writes all schedules into a folder, which is made when it is missing; each file whole or not at
 * all. */
lar_status lar_schedule_write(const char *folder, const lar_schedule_set *set, lar_error *error);

/* Reads one file. The mesh must be the one it was made for. lar_schedule_parse reads from memory,
 * for fuzzing; `path` is for messages. */
lar_status lar_schedule_read(const char *path, const lar_mesh *mesh, lar_schedule *out,
                             lar_error *error);
lar_status lar_schedule_parse(const char *path, const lar_bytes *bytes, const lar_mesh *mesh,
                              lar_schedule *out, lar_error *error);

/* Reads the files of all processors of a folder; refuses files of different divisions. */
lar_status lar_schedule_read_all(const char *folder, const lar_mesh *mesh, lar_schedule_set *out,
                                 lar_error *error);

#endif
