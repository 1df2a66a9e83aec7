#include "model/tool_script.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/pose.h"
#include "base/quaternion.h"
#include "base/text.h"

enum { TIME, X, Y, Z, QW, QX, QY, QZ, OPENING, COLUMNS };
static const char *const column_name[COLUMNS] = {"time", "x",  "y",  "z",      "qw",
                                                 "qx",   "qy", "qz", "opening"};

typedef struct script_reader {
    const char *path;
    lar_text text;
    int line; /* of the row that is read */
    int column[COLUMNS], columns;
    bool has[COLUMNS];
} script_reader;

/* The next line that is neither empty nor a comment. */
static bool next_line(script_reader *reader, lar_span *line) {
    do {
        reader->line = reader->text.line;
        if (!lar_text_line(&reader->text, line)) return false;
        *line = lar_span_trim(*line);
    } while (line->length == 0 || line->at[0] == '#');
    return true;
}

static lar_status read_header(script_reader *reader, lar_error *error) {
    lar_span rest, name;
    if (!next_line(reader, &rest))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: nothing in it; a script begins with a line of names, as time,x,y,z",
                        reader->path);
    bool more = true;
    while (more) {
        more = lar_span_split(rest, ',', &name, &rest);
        name = lar_span_trim(name);
        int i = 0;
        while (i < COLUMNS && !lar_span_equal(name, column_name[i])) i++;
        if (i == COLUMNS || reader->has[i])
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s:%d: '%.*s' %s; a script begins with a line of names: time, x, y, z "
                            "and, if wanted, qw, qx, qy, qz and opening",
                            reader->path, reader->line, (int)(name.length < 40 ? name.length : 40),
                            name.at, i == COLUMNS ? "is no column of a script" : "stands twice");
        reader->has[i] = true;
        reader->column[reader->columns++] = i;
    }
    bool some = false, all = true;
    for (int i = QW; i <= QZ; i++) {
        some = some || reader->has[i];
        all = all && reader->has[i];
    }
    for (int i = TIME; i <= QZ; i++)
        if (!reader->has[i] && (i <= Z || some != all))
            return lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: the column %s is missing",
                            reader->path, reader->line, column_name[i]);
    return LAR_OK;
}

static lar_status read_values(const script_reader *reader, lar_span line, double value[COLUMNS],
                              lar_error *error) {
    lar_span rest = line, part;
    bool more = true;
    int i = 0;
    for (; i < reader->columns && more; i++) {
        more = lar_span_split(rest, ',', &part, &rest);
        part = lar_span_trim(part);
        int c = reader->column[i];
        if (!lar_span_double(part, &value[c]) || !isfinite(value[c]))
            return lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: '%.*s' is no number for %s",
                            reader->path, reader->line, (int)(part.length < 40 ? part.length : 40),
                            part.at, column_name[c]);
    }
    if (more || i < reader->columns)
        return lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: %s values than the %d columns named above",
                        reader->path, reader->line, more ? "more" : "fewer", reader->columns);
    return LAR_OK;
}

static lar_status take_pose(const script_reader *reader, lar_tool_pose *pose, lar_error *error) {
    lar_error why;
    if (!lar_pose_normalise(pose, NULL, &why)) return LAR_OK;
    return lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: %s", reader->path, reader->line, why.message);
}

static lar_status add_row(script_reader *reader, lar_tool_script *script, lar_span line,
                          lar_error *error) {
    double value[COLUMNS] = {[QW] = 1, [OPENING] = 1};
    lar_status status = read_values(reader, line, value, error);
    if (status) return status;
    const char *path = reader->path;
    if (script->count && !(value[TIME] > script->row[script->count - 1].time))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s:%d: time %g does not come after %g; times must grow from row to row",
                        path, reader->line, value[TIME], script->row[script->count - 1].time);
    for (int i = X; i <= Z; i++)
        if (fabs(value[i]) > LAR_TOOL_SCRIPT_FAR)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s:%d: %s is %g m; positions are in metres, within %g", path,
                            reader->line, column_name[i], value[i], LAR_TOOL_SCRIPT_FAR);
    lar_tool_script_row row = {.time = value[TIME], .pose.opening = value[OPENING]};
    memcpy(row.pose.position, &value[X], sizeof row.pose.position);
    memcpy(row.pose.orientation, &value[QW], sizeof row.pose.orientation);
    status = take_pose(reader, &row.pose, error);
    if (!status && !lar_tool_script_insert(script, script->count, &row))
        status = lar_fail_memory(error, script->capacity * sizeof row, "a script");
    return status;
}

lar_status lar_tool_script_read(const char *path, lar_tool_script *script, lar_error *error) {
    lar_bytes bytes;
    *script = (lar_tool_script){0};
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    script_reader reader = {.path = path};
    status = lar_text_open(path, &bytes, &reader.text, error);
    if (!status) status = read_header(&reader, error);
    lar_span line;
    while (!status && next_line(&reader, &line)) status = add_row(&reader, script, line, error);
    if (!status && script->count == 0)
        status = lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: no row follows the names of the columns",
                          path, reader.line);
    script->turns = reader.has[QW];
    lar_bytes_free(&bytes);
    return status;
}

bool lar_tool_script_insert(lar_tool_script *script, size_t at, const lar_tool_script_row *row) {
    if (!LAR_GROW(script->row, script->capacity, script->count)) return false;
    lar_tool_script_row *place = &script->row[at];
    memmove(place + 1, place, (script->count++ - at) * sizeof *place);
    *place = *row;
    return true;
}

void lar_tool_script_destroy(lar_tool_script *script) {
    free(script->row);
    *script = (lar_tool_script){0};
}

void lar_tool_script_between(const lar_tool_script_row *row, double time, lar_tool_pose *pose) {
    double share = (time - row->time) / (row[1].time - row->time);
    for (int i = 0; i < 3; i++)
        pose->position[i] = (1 - share) * row->pose.position[i] + share * row[1].pose.position[i];
    lar_quaternion_blend(row->pose.orientation, row[1].pose.orientation, share, pose->orientation);
    pose->opening = (1 - share) * row->pose.opening + share * row[1].pose.opening;
}

void lar_tool_script_at(lar_tool_script *script, double time, lar_tool_pose *pose) {
    const lar_tool_script_row *row = script->row;
    if (time < row[script->at].time) script->at = 0; /* gone back */
    while (script->at + 1 < script->count && row[script->at + 1].time <= time) script->at++;
    row += script->at;
    *pose = row->pose;
    if (time > row->time && script->at + 1 < script->count)
        lar_tool_script_between(row, time, pose);
}
