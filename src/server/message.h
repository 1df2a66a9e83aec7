/* What a viewer says to the server, docs/viewer-protocol.md: one JSON object, read strictly.
 *
 * These bytes come from anybody who can reach the port, so every key, type and range is in one
 * table, and what is not there is refused: the connection ends, with a sentence for whoever writes
 * viewers. Pure functions; nothing is allocated.
 */
#ifndef LAR_SERVER_MESSAGE_H
#define LAR_SERVER_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "lariat.h"

enum {
    LAR_MESSAGE_MAX = 1024, /* bytes */
    LAR_NAME_MAX = 64,      /* of a saved state's name */
    LAR_REASON_BYTES = 124, /* a close frame has room for 123 and no zero */
    LAR_VIEWER_HANDS = 4    /* that one viewer may have */
};

/* Why a connection is closed (RFC 6455, 7.4). */
typedef enum lar_close {
    LAR_CLOSE_NOT = 0,
    LAR_CLOSE_AWAY = 1001,
    LAR_CLOSE_BINARY = 1003,
    LAR_CLOSE_TEXT = 1007,
    LAR_CLOSE_POLICY = 1008,
    LAR_CLOSE_SIZE = 1009,
    LAR_CLOSE_TOKEN = 4001,
    LAR_CLOSE_SLOW = 4002,
    LAR_CLOSE_FULL = 4003
} lar_close;

typedef enum lar_command_kind {
    LAR_COMMAND_FRAME = 0,
    LAR_COMMAND_FORCES,
    LAR_COMMAND_GRAB,
    LAR_COMMAND_PULL,
    LAR_COMMAND_RELEASE,
    LAR_COMMAND_TOOL,
    LAR_COMMAND_PLAY,
    LAR_COMMAND_PAUSE,
    LAR_COMMAND_STEP,
    LAR_COMMAND_RESET,
    LAR_COMMAND_PACE,
    LAR_COMMAND_RECORD,
    LAR_COMMAND_SAVE,
    LAR_COMMAND_LOAD,
    LAR_COMMAND_REPLAY,
    LAR_COMMAND_SEEK,
    LAR_COMMAND_INSPECT,
    LAR_COMMAND_SLICE,
    LAR_COMMAND_GRAVITY,
    LAR_COMMAND_DAMPING,
    LAR_COMMAND_STIFFNESS,
    LAR_COMMAND_ACTIVATE,
    LAR_COMMAND_ADD_TOOL,
    LAR_COMMAND_REMOVE_TOOL
} lar_command_kind;

/* One message. What its kind does not have is zero. */
typedef struct lar_command {
    lar_command_kind kind;
    lar_field field; /* frame; 0: none */
    int32_t tool;    /* forces, tool, remove_tool */
    int32_t hand;    /* grab, pull, release: 0..LAR_VIEWER_HANDS-1 */
    uint64_t after;  /* forces */
    uint64_t steps;  /* step */
    double pace;
    bool valued;      /* gravity, damping, stiffness: else as the model says */
    double value;     /* damping, stiffness */
    int32_t material; /* stiffness; -1: all */
    double time;      /* seek [s] */
    double point[3];  /* grab, pull, tool, gravity */
    double orientation[4];
    double opening;
    bool turns, opens;    /* tool: orientation, opening were given */
    bool on;              /* record */
    int32_t axis, index;  /* slice */
    int32_t node, face;   /* inspect: of the surface; -1: none */
    bool energy;          /* inspect */
    lar_tool_shape shape; /* add_tool, as the next two [m] */
    double radius, length;
    char name[LAR_NAME_MAX + 1]; /* load; "": the last one; replay; "": ends */
} lar_command;

/* Reads `length` bytes. Returns LAR_CLOSE_NOT, or why the connection must end, with a sentence in
 * `reason`; *command is set on success only. `tools`: how many there are. */
lar_close lar_command_read(const char *text, size_t length, int32_t tools, lar_command *command,
                           char reason[LAR_REASON_BYTES]);

/* Fields that a viewer can ask for, in the order of the protocol. */
typedef struct lar_field_name {
    const char *name, *title, *unit;
    lar_field field;
} lar_field_name;

/* Words of lar_tool_shape. */
extern const char *const lar_shape_names[LAR_TOOL_RIGID + 1];

enum { LAR_FIELDS = 6 }; /* the first is "none" */
extern const lar_field_name lar_field_names[LAR_FIELDS];
/* Index into the table. */
int lar_field_index(lar_field field);

#endif
