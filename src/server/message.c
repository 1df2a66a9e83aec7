#include "server/message.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/json/read.h"
#include "base/pose.h"
#include "base/text.h"

const lar_field_name lar_field_names[LAR_FIELDS] = {
    {"none", "", "", 0},
    {"displacement", "displacement", "m", LAR_FIELD_DISPLACEMENT},
    {"von_mises", "von Mises stress", "Pa", LAR_FIELD_VON_MISES},
    {"pressure", "pressure", "Pa", LAR_FIELD_PRESSURE},
    {"energy", "strain energy density", "J/m³", LAR_FIELD_ENERGY},
    {"processor", "processor", "", LAR_FIELD_PROCESSOR}};

const char *const lar_shape_names[LAR_TOOL_RIGID + 1] = {"sphere", "capsule", "grasper",
                                                         "hand",   "none",    "rigid"};

int lar_field_index(lar_field field) {
    for (int i = 0; i < LAR_FIELDS; i++)
        if (lar_field_names[i].field == field) return i;
    return 0;
}

/* ---- the language ----------------------------------------------------------------------- */

typedef enum key_id {
    KEY_DO,
    KEY_FIELD,
    KEY_NAME,
    KEY_TOOL,
    KEY_HAND,
    KEY_AFTER,
    KEY_STEPS,
    KEY_VALUE,
    KEY_TIME,
    KEY_OPENING,
    KEY_ON,
    KEY_POINT,
    KEY_TO,
    KEY_POSITION,
    KEY_ORIENTATION,
    KEY_NODE,
    KEY_FACE,
    KEY_ENERGY,
    KEY_AXIS,
    KEY_INDEX,
    KEY_MATERIAL,
    KEY_SHAPE,
    KEY_RADIUS,
    KEY_LENGTH,
    KEYS
} key_id;

typedef enum key_kind { IS_STRING, IS_WHOLE, IS_REAL, IS_BOOLEAN, IS_VECTOR } key_kind;

typedef struct key_row {
    const char *name;
    key_kind kind;
    double min, max; /* of numbers */
    int count;       /* of a vector's numbers */
} key_row;

/* Whole numbers stay below 2^53, where every one is a double. */
static const key_row key_table[KEYS] = {[KEY_DO] = {"do", IS_STRING, 0, 0, 0},
                                        [KEY_FIELD] = {"field", IS_STRING, 0, 0, 0},
                                        [KEY_NAME] = {"name", IS_STRING, 0, 0, 0},
                                        [KEY_TOOL] = {"tool", IS_WHOLE, 0, 9007199254740991.0, 0},
                                        [KEY_HAND] = {"hand", IS_WHOLE, 0, LAR_VIEWER_HANDS - 1, 0},
                                        [KEY_AFTER] = {"after", IS_WHOLE, 0, 9007199254740991.0, 0},
                                        [KEY_STEPS] = {"steps", IS_WHOLE, 1, 100000, 0},
                                        [KEY_VALUE] = {"value", IS_REAL, -DBL_MAX, DBL_MAX, 0},
                                        [KEY_TIME] = {"time", IS_REAL, 0, 1e9, 0},
                                        [KEY_OPENING] = {"opening", IS_REAL, 0, 1, 0},
                                        [KEY_ON] = {"on", IS_BOOLEAN, 0, 0, 0},
                                        [KEY_POINT] = {"point", IS_VECTOR, -1000, 1000, 3},
                                        [KEY_TO] = {"to", IS_VECTOR, -1000, 1000, 3},
                                        [KEY_POSITION] = {"position", IS_VECTOR, -1000, 1000, 3},
                                        [KEY_ORIENTATION] = {"orientation", IS_VECTOR, -2, 2, 4},
                                        [KEY_NODE] = {"node", IS_WHOLE, 0, INT32_MAX, 0},
                                        [KEY_FACE] = {"face", IS_WHOLE, 0, INT32_MAX, 0},
                                        [KEY_ENERGY] = {"energy", IS_BOOLEAN, 0, 0, 0},
                                        [KEY_AXIS] = {"axis", IS_WHOLE, 0, 2, 0},
                                        [KEY_INDEX] = {"index", IS_WHOLE, 0, INT32_MAX, 0},
                                        [KEY_MATERIAL] = {"material", IS_WHOLE, 0, INT32_MAX, 0},
                                        [KEY_SHAPE] = {"shape", IS_STRING, 0, 0, 0},
                                        [KEY_RADIUS] = {"radius", IS_REAL, -DBL_MAX, DBL_MAX, 0},
                                        [KEY_LENGTH] = {"length", IS_REAL, -DBL_MAX, DBL_MAX, 0}};

#define BIT(key) (1u << KEY_##key)

/* Beside `do`, by lar_command_kind. */
static const struct {
    const char *name;
    uint32_t needed, allowed;
} command_table[] = {
    [LAR_COMMAND_FRAME] = {"frame", 0, BIT(FIELD)},
    [LAR_COMMAND_FORCES] = {"forces", BIT(TOOL) | BIT(AFTER), 0},
    [LAR_COMMAND_GRAB] = {"grab", BIT(HAND) | BIT(POINT), 0},
    [LAR_COMMAND_PULL] = {"pull", BIT(HAND) | BIT(TO), 0},
    [LAR_COMMAND_RELEASE] = {"release", BIT(HAND), 0},
    [LAR_COMMAND_TOOL] = {"tool", BIT(TOOL) | BIT(POSITION), BIT(ORIENTATION) | BIT(OPENING)},
    [LAR_COMMAND_PLAY] = {"play", 0, 0},
    [LAR_COMMAND_PAUSE] = {"pause", 0, 0},
    [LAR_COMMAND_STEP] = {"step", BIT(STEPS), 0},
    [LAR_COMMAND_RESET] = {"reset", 0, 0},
    [LAR_COMMAND_PACE] = {"pace", BIT(VALUE), 0},
    [LAR_COMMAND_RECORD] = {"record", BIT(ON), 0},
    [LAR_COMMAND_SAVE] = {"save", 0, 0},
    [LAR_COMMAND_LOAD] = {"load", 0, BIT(NAME)},
    [LAR_COMMAND_REPLAY] = {"replay", 0, BIT(NAME)},
    [LAR_COMMAND_SEEK] = {"seek", BIT(TIME), 0},
    [LAR_COMMAND_INSPECT] = {"inspect", 0, BIT(NODE) | BIT(FACE) | BIT(ENERGY)},
    [LAR_COMMAND_SLICE] = {"slice", BIT(AXIS) | BIT(INDEX), 0},
    [LAR_COMMAND_GRAVITY] = {"gravity", 0, BIT(TO)},
    [LAR_COMMAND_DAMPING] = {"damping", 0, BIT(VALUE)},
    [LAR_COMMAND_STIFFNESS] = {"stiffness", 0, BIT(VALUE) | BIT(MATERIAL)},
    [LAR_COMMAND_ACTIVATE] = {"activate", 0, BIT(VALUE) | BIT(MATERIAL)},
    [LAR_COMMAND_ADD_TOOL] = {"add_tool", BIT(SHAPE) | BIT(RADIUS), BIT(LENGTH)},
    [LAR_COMMAND_REMOVE_TOOL] = {"remove_tool", BIT(TOOL), 0}};
enum { COMMANDS = sizeof command_table / sizeof command_table[0] };

/* ---- reading ---------------------------------------------------------------------------- */

typedef struct reader {
    lar_json_reader in;
    uint32_t seen; /* keys, as bits */
    char text[KEYS][LAR_NAME_MAX + 1];
    double number[KEYS][4];
    lar_close close;
    char *reason;
} reader;

static bool refuse(reader *r, lar_close close, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The first reason stays. Always false. */
static bool refuse(reader *r, lar_close close, const char *format, ...) {
    if (r->close != LAR_CLOSE_NOT) return false;
    va_list args;
    va_start(args, format);
    vsnprintf(r->reason, LAR_REASON_BYTES, format, args);
    va_end(args);
    r->close = close;
    return false;
}

/* Longer ones can be nothing we know, and must not become the same as what we do. */
static bool read_string(reader *r, char text[LAR_NAME_MAX + 1]) {
    size_t length;
    if (!lar_json_take_string(&r->in, text, LAR_NAME_MAX + 1, &length)) return false;
    if (length > LAR_NAME_MAX) text[LAR_NAME_MAX - 1] = 0x7f;
    return true;
}

static bool read_boolean(reader *r, double *value) {
    bool is_true;
    if (!lar_json_take_boolean(&r->in, &is_true)) return false;
    *value = is_true;
    return true;
}

static bool read_numbers(reader *r, const key_row *row, double *value) {
    bool vector = row->kind == IS_VECTOR;
    int count = vector ? row->count : 1;
    if (vector && !lar_json_take(&r->in, '['))
        return refuse(r, LAR_CLOSE_POLICY, "%s must be an array of %d numbers", row->name, count);
    for (int i = 0; i < count; i++) {
        if ((i > 0 && !lar_json_take(&r->in, ',')) || !lar_json_take_number(&r->in, &value[i]))
            return refuse(r, LAR_CLOSE_POLICY, "%s must be %s%.0d number%s", row->name,
                          vector ? "an array of " : "a", vector ? count : 0, vector ? "s" : "");
        if (value[i] < row->min || value[i] > row->max)
            return refuse(r, LAR_CLOSE_POLICY, "%s must lie between %g and %g", row->name, row->min,
                          row->max);
        if (row->kind == IS_WHOLE && value[i] != floor(value[i]))
            return refuse(r, LAR_CLOSE_POLICY, "%s must be a whole number", row->name);
    }
    if (vector && !lar_json_take(&r->in, ']'))
        return refuse(r, LAR_CLOSE_POLICY, "%s must be an array of %d numbers", row->name, count);
    return true;
}

static bool read_value(reader *r, key_id key) {
    const key_row *row = &key_table[key];
    switch (row->kind) {
    case IS_STRING:
        return read_string(r, r->text[key]) ||
               refuse(r, LAR_CLOSE_POLICY, "%s must be a string", row->name);
    case IS_BOOLEAN:
        return read_boolean(r, r->number[key]) ||
               refuse(r, LAR_CLOSE_POLICY, "%s must be true or false", row->name);
    default:
        return read_numbers(r, row, r->number[key]);
    }
}

/* Others' words may hold anything: what is no word like ours is not repeated. */
static const char *plain(const char *word) {
    enum { LONGEST = 20 };
    size_t length = strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789");
    return length > 0 && length <= LONGEST && word[length] == '\0' ? word : "of that name";
}

static bool read_member(reader *r) {
    char name[LAR_NAME_MAX + 1];
    if (!read_string(r, name)) return refuse(r, LAR_CLOSE_POLICY, "a key must be a string");
    key_id key = 0;
    while (key < KEYS && strcmp(key_table[key].name, name) != 0) key++;
    if (key == KEYS) return refuse(r, LAR_CLOSE_POLICY, "there is no key %s", plain(name));
    if (r->seen & 1u << key)
        return refuse(r, LAR_CLOSE_POLICY, "the key %s is there twice", key_table[key].name);
    r->seen |= 1u << key;
    if (!lar_json_take(&r->in, ':'))
        return refuse(r, LAR_CLOSE_POLICY, "a colon is missing behind a key");
    return read_value(r, key);
}

static bool read_object(reader *r) {
    if (!lar_json_take(&r->in, '{'))
        return refuse(r, LAR_CLOSE_POLICY, "a message must be a JSON object");
    if (!lar_json_take(&r->in, '}')) {
        do {
            if (!read_member(r)) return false;
        } while (lar_json_take(&r->in, ','));
        if (!lar_json_take(&r->in, '}'))
            return refuse(r, LAR_CLOSE_POLICY, "the object does not end");
    }
    return (lar_json_next(&r->in) == '\0' && r->in.at == r->in.end) ||
           refuse(r, LAR_CLOSE_POLICY, "there is more behind the object");
}

/* ---- meaning ---------------------------------------------------------------------------- */

static bool check_keys(reader *r, lar_command_kind *kind) {
    if (!(r->seen & BIT(DO))) return refuse(r, LAR_CLOSE_POLICY, "the key do is missing");
    int found = 0;
    while (found < COMMANDS && strcmp(command_table[found].name, r->text[KEY_DO]) != 0) found++;
    if (found == COMMANDS)
        return refuse(r, LAR_CLOSE_POLICY, "do: there is no message %s", plain(r->text[KEY_DO]));
    *kind = (lar_command_kind)found;
    uint32_t needed = command_table[found].needed, given = r->seen & ~BIT(DO);
    for (int key = 0; key < KEYS; key++) {
        uint32_t bit = 1u << key;
        if (needed & ~given & bit)
            return refuse(r, LAR_CLOSE_POLICY, "%s needs the key %s", command_table[found].name,
                          key_table[key].name);
        if (given & ~needed & ~command_table[found].allowed & bit)
            return refuse(r, LAR_CLOSE_POLICY, "%s has no key %s", command_table[found].name,
                          key_table[key].name);
    }
    return true;
}

static bool set_field(reader *r, lar_command *command) {
    if (!(r->seen & BIT(FIELD))) return true;
    for (int i = 0; i < LAR_FIELDS; i++)
        if (strcmp(lar_field_names[i].name, r->text[KEY_FIELD]) == 0) {
            command->field = lar_field_names[i].field;
            return true;
        }
    return refuse(
        r, LAR_CLOSE_POLICY,
        "there is no field %s: none, displacement, von_mises, pressure, energy or processor",
        plain(r->text[KEY_FIELD]));
}

static bool set_shape(reader *r, lar_command *command) {
    command->radius = r->number[KEY_RADIUS][0];
    command->length = r->number[KEY_LENGTH][0];
    if (!(r->seen & BIT(SHAPE))) return true;
    for (int i = 0; i < LAR_TOOL_HAND; i++)
        if (strcmp(lar_shape_names[i], r->text[KEY_SHAPE]) == 0) {
            command->shape = (lar_tool_shape)i;
            return true;
        }
    return refuse(r, LAR_CLOSE_POLICY, "there is no shape %s: sphere, capsule or grasper",
                  plain(r->text[KEY_SHAPE]));
}

static bool set_tool(reader *r, int32_t tools, lar_command *command) {
    if (!(r->seen & BIT(TOOL))) return true;
    if (r->number[KEY_TOOL][0] >= tools)
        return refuse(r, LAR_CLOSE_POLICY, "there are %d tools, counted from 0", (int)tools);
    command->tool = (int32_t)r->number[KEY_TOOL][0];
    command->turns = r->seen & BIT(ORIENTATION);
    command->opens = r->seen & BIT(OPENING);
    command->opening = r->number[KEY_OPENING][0];
    if (!command->turns) return true;
    lar_tool_pose pose = {.opening = 1};
    memcpy(pose.orientation, r->number[KEY_ORIENTATION], sizeof pose.orientation);
    if (lar_pose_normalise(&pose, NULL, NULL))
        return refuse(r, LAR_CLOSE_POLICY, "orientation must be a unit quaternion w, x, y, z");
    memcpy(command->orientation, pose.orientation, sizeof command->orientation);
    return true;
}

/* What it may be depends on what it is of. */
static bool set_value(reader *r, lar_command *command) {
    double value = r->number[KEY_VALUE][0];
    bool pace = command->kind == LAR_COMMAND_PACE;
    command->value = command->pace = value;
    if (value == 0 || (value >= (pace ? 0.001 : 0) && value <= (pace ? 100 : 1e6))) return true;
    return refuse(r, LAR_CLOSE_POLICY, "value must lie between %s",
                  pace ? "0.001 and 100, or be 0" : "0 and 1e+06");
}

static bool set_rest(reader *r, lar_command *command) {
    key_id point = command->kind == LAR_COMMAND_GRAB ? KEY_POINT
                   : command->kind == LAR_COMMAND_PULL || command->kind == LAR_COMMAND_GRAVITY
                       ? KEY_TO
                       : KEY_POSITION;
    memcpy(command->point, r->number[point], sizeof command->point);
    command->hand = (int32_t)r->number[KEY_HAND][0];
    command->after = (uint64_t)r->number[KEY_AFTER][0];
    command->steps = (uint64_t)r->number[KEY_STEPS][0];
    command->on = r->number[KEY_ON][0] != 0;
    command->time = r->number[KEY_TIME][0];
    command->node = r->seen & BIT(NODE) ? (int32_t)r->number[KEY_NODE][0] : -1;
    command->face = r->seen & BIT(FACE) ? (int32_t)r->number[KEY_FACE][0] : -1;
    command->axis = (int32_t)r->number[KEY_AXIS][0];
    command->index = (int32_t)r->number[KEY_INDEX][0];
    command->valued = r->seen & (BIT(TO) | BIT(VALUE));
    command->material = r->seen & BIT(MATERIAL) ? (int32_t)r->number[KEY_MATERIAL][0] : -1;
    command->energy = r->number[KEY_ENERGY][0] != 0;
    memcpy(command->name, r->text[KEY_NAME], sizeof command->name);
    return true;
}

lar_close lar_command_read(const char *text, size_t length, int32_t tools, lar_command *command,
                           char reason[LAR_REASON_BYTES]) {
    reader r = {.in = {text, text + length}, .reason = reason};
    lar_command found = {0};
    if (length > LAR_MESSAGE_MAX)
        refuse(&r, LAR_CLOSE_SIZE, "a message has at most %d bytes", LAR_MESSAGE_MAX);
    for (size_t i = 0; i < length && r.close == LAR_CLOSE_NOT;) {
        int bytes = lar_utf8_length((const unsigned char *)text + i, length - i);
        if (bytes == 0) refuse(&r, LAR_CLOSE_TEXT, "a message must be UTF-8");
        i += (size_t)bytes;
    }
    bool good = r.close == LAR_CLOSE_NOT && read_object(&r) && check_keys(&r, &found.kind) &&
                set_field(&r, &found) && set_shape(&r, &found) && set_tool(&r, tools, &found) &&
                set_value(&r, &found) && set_rest(&r, &found);
    if (good) *command = found;
    return r.close;
}
