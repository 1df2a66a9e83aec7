#include "tool.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"
#include "base/vector.h"
#include "contact/tools.h"

/* ---- scenes -------------------------------------------------------------------------------- */

/* Keys that a scene loses; all others stay. */
static bool leaves(const char *line) {
    static const char *const key[] = {"gravity:", "load:",    "move:",   "initial:", "contact:",
                                      "tools:",   "surface:", "output:", "view:"};
    for (size_t i = 0; i < sizeof key / sizeof key[0]; i++)
        if (strncmp(line, key[i], strlen(key[i])) == 0) return true;
    return false;
}

/* A key's lines are those up to the next line that begins at the margin. */
static void copy_scene(FILE *from, FILE *to) {
    char line[4096];
    bool out = false;
    while (fgets(line, sizeof line, from)) {
        if (!strchr(" #\n\r", line[0])) out = leaves(line);
        if (!out) fputs(line, to);
    }
}

static lar_status write_scene(const char *path, const char *made, const char *tools, int contact,
                              lar_error *error) {
    FILE *from = fopen(path, "r"), *to = from ? fopen(made, "w") : NULL;
    if (!to) {
        if (from) fclose(from);
        return lar_fail(error, LAR_ERROR_IO, "%s cannot be read, or %s not written", path, made);
    }
    copy_scene(from, to);
    fputs("gravity: [0, 0, 0]\n", to);
    if (contact) fputs("contact: [ { self: true } ]\n", to);
    if (*tools) fprintf(to, "tools:\n%s", tools);
    fclose(from);
    if (fclose(to) == 0) return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO, "%s cannot be written", made);
}

lar_status lar_scene_with(const char *path, const char *tools, int contact, lar_model **model,
                          lar_error *error) {
    char made[4096];
    if (snprintf(made, sizeof made, "%s.%ld.yaml", path, (long)getpid()) >= (int)sizeof made)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "the path of a scene is too long");
    lar_status status = write_scene(path, made, tools, contact, error);
    if (!status) status = lar_model_open(made, model, error);
    remove(made);
    return status;
}

/* ---- where a tool is ----------------------------------------------------------------------- */

double lar_apart(const double a[3], const double b[3]) {
    double way[3];
    lar_minus(a, b, way);
    return lar_length(way);
}

lar_line lar_tool_line(const lar_tool_info *tool, const lar_tool_pose *pose) {
    bool jaws = tool->shape == LAR_TOOL_GRASPER;
    lar_line line = {.count = jaws ? 2 : 1};
    double half = 0.5 * tool->spread * pose->opening;
    for (int s = 0; s < line.count; s++) {
        double end[3] = {0, 0, tool->shape == LAR_TOOL_CAPSULE ? tool->length : 0};
        if (jaws) {
            end[0] = (s ? -1 : 1) * tool->length * sin(half);
            end[2] = -tool->length * cos(half);
        }
        lar_turn(pose->orientation, end, line.end[s][1]);
        for (int i = 0; i < 3; i++) {
            line.end[s][0][i] = pose->position[i];
            line.end[s][1][i] += pose->position[i];
        }
    }
    return line;
}

static double from_segment(const double end[2][3], const double place[3]) {
    double along[3], away[3];
    lar_minus(end[1], end[0], along);
    lar_minus(place, end[0], away);
    double square = lar_dot(along, along);
    double t = square > 0 ? fmax(0, fmin(1, lar_dot(away, along) / square)) : 0;
    for (int i = 0; i < 3; i++) away[i] -= t * along[i];
    return lar_length(away);
}

double lar_line_gap(const lar_line *line, const lar_body *body) {
    enum { N = 8 };
    double min = INFINITY;
    for (int32_t f = 0; f < body->surface.faces; f++)
        for (int k = 0; k < N * N; k++) {
            double p = (double)(k % N) / (N - 1), q = (double)(k / N) / (N - 1), place[3] = {0};
            double weight[4] = {(1 - p) * (1 - q), p * (1 - q), p * q, (1 - p) * q};
            for (int a = 0; a < 4; a++)
                for (int i = 0; i < 3; i++)
                    place[i] += weight[a] * body->x[body->surface.face[f][a]][i];
            for (int s = 0; s < line->count; s++)
                min = fmin(min, from_segment((const double(*)[3])line->end[s], place));
        }
    return min;
}

double lar_line_winding(const lar_line *line, const lar_body *body) {
    static const double SPACING = 0.006;
    double max = -INFINITY;
    for (int s = 0; s < line->count; s++) {
        const double *from = line->end[s][0], *to = line->end[s][1];
        int parts = (int)ceil(lar_apart(from, to) / SPACING);
        for (int k = s > 0; k <= parts; k++) {
            double place[3], t = parts ? (double)k / parts : 0;
            for (int i = 0; i < 3; i++) place[i] = (1 - t) * from[i] + t * to[i];
            max = fmax(max, lar_body_winding(body, place));
        }
    }
    return max;
}

/* ---- leading a tool ------------------------------------------------------------------------ */

uint64_t lar_tick_steps(const lar_simulation *simulation) {
    double steps = floor(1e-3 / lar_simulation_time_step(simulation) * (1 + 1e-9));
    return steps < 1 ? 1 : (uint64_t)steps;
}

lar_status lar_guide_create(const lar_simulation *simulation, int32_t tool, int coupled,
                            lar_guide *guide, lar_error *error) {
    double step = lar_simulation_time_step(simulation);
    *guide = (lar_guide){.tool = tool, .coupled = coupled, .steps = lar_tick_steps(simulation)};
    lar_status status = lar_simulation_tool(simulation, tool, &guide->info, error);
    if (status) return status;
    const lar_coupling_limits limits = {.tool_speed = 1,
                                        .hand_force = 1,
                                        .seconds = (double)guide->steps * step,
                                        .time_step = step};
    lar_coupling_create(&guide->coupling, &guide->info, &limits);
    lar_guide_reset(guide, simulation);
    return LAR_OK;
}

void lar_guide_reset(lar_guide *guide, const lar_simulation *simulation) {
    lar_simulation_tool_pose(simulation, guide->tool, &guide->sent, NULL);
    lar_coupling_reset(&guide->coupling, &guide->sent);
}

lar_status lar_guide_follow(lar_guide *guide, lar_simulation *simulation, const lar_tool_pose *hand,
                            lar_error *error) {
    lar_tool_pose pose = *hand;
    if (guide->coupled) lar_coupling_follow(&guide->coupling, hand, NULL, &pose);
    if (memcmp(&pose, &guide->sent, sizeof pose) == 0) return LAR_OK;
    lar_status status =
        lar_simulation_tool_move(simulation, guide->tool, &pose, guide->steps, error);
    if (!status) guide->sent = pose;
    if (status != LAR_ERROR_ARGUMENT) return status;
    guide->refused++;
    lar_guide_reset(guide, simulation);
    return LAR_OK;
}

void lar_guide_feel(lar_guide *guide, const lar_simulation *simulation) {
    lar_tool_force force, felt;
    lar_simulation_tool_force(simulation, guide->tool, &force, NULL);
    /* As at pace 1, with no tick late. */
    if (guide->coupled) lar_coupling_feel(&guide->coupling, &force, guide->coupling.seconds, &felt);
}
