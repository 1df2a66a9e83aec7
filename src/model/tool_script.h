/* A tool's way as a file: positions at times (docs/devices.md).
 *
 *     time,x,y,z,qw,qx,qy,qz,opening       seconds and metres
 *     0.0,0,0,0.10,1,0,0,0,1
 *     0.5,0,0,0.05,1,0,0,0,0               straight lines between, rest before and after
 *
 * Orientation and opening may be left out, columns stand in any order, lines that begin with # are
 * passed over.
 */
#ifndef LAR_MODEL_TOOL_SCRIPT_H
#define LAR_MODEL_TOOL_SCRIPT_H

#include <stdbool.h>

#include "base/error.h"

typedef struct lar_tool_script_row {
    double time; /* [s] */
    lar_tool_pose pose;
} lar_tool_script_row;

typedef struct lar_tool_script {
    lar_tool_script_row *row; /* [count], times ascending */
    size_t count, capacity;
    bool turns; /* the file has orientations; without, they are 1, 0, 0, 0 */
    size_t at;  /* the row at or before the time that was last asked for */
} lar_tool_script;

/* Where a tool may be, from the middle of space, in every direction [m]. */
#define LAR_TOOL_SCRIPT_FAR 100.0

/* Reads a file; errors name file and line. Destroy it in any case. */
lar_status lar_tool_script_read(const char *path, lar_tool_script *script, lar_error *error);
void lar_tool_script_destroy(lar_tool_script *script);

/* Puts a row before row `at`, or behind the last one. False when there is no memory. */
bool lar_tool_script_insert(lar_tool_script *script, size_t at, const lar_tool_script_row *row);

/* The pose between two rows that follow each other, at a time between theirs. */
void lar_tool_script_between(const lar_tool_script_row *row, double time, lar_tool_pose *pose);

/* The pose at a time [s]. Fast for times that grow; it does not ask for memory. */
void lar_tool_script_at(lar_tool_script *script, double time, lar_tool_pose *pose);

#endif
