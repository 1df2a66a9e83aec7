/* Instruments: scenes that have them, where they reach, and the hand that leads them. */
#ifndef LAR_INSTRUMENTS_TOOL_H
#define LAR_INSTRUMENTS_TOOL_H

#include "body.h"
#include "session/coupling.h"

/* Opens a scene of `lariat mesh` with other tools: its supports, materials and damping, but no
 * gravity, load, motion or embedded surface. `tools` are the lines below the key; "" for none. With
 * `contact` the surface touches itself. A file beside the scene is written for it, and removed. */
lar_status lar_scene_with(const char *path, const char *tools, int contact, lar_model **model,
                          lar_error *error);

/* The middle line of a tool: one segment, of jaws two; a sphere's ends are the same. */
typedef struct lar_line {
    int count;
    double end[2][2][3];
} lar_line;

lar_line lar_tool_line(const lar_tool_info *tool, const lar_tool_pose *pose);

/* How far the surface is from a middle line, as 8 x 8 points on each face have it. */
double lar_line_gap(const lar_line *line, const lar_body *body);

/* The largest winding number on a middle line. */
double lar_line_winding(const lar_line *line, const lar_body *body);

/* A tool that is led: by the positions themselves, or by a hand on a spring as in a session. */
typedef struct lar_guide {
    int32_t tool;
    int coupled;
    lar_coupling coupling;
    lar_tool_info info;
    lar_tool_pose sent;
    uint64_t steps;   /* of a tick */
    uint64_t refused; /* moves that the engine would not do */
} lar_guide;

/* Steps of a tick of a millisecond, as a session has them. */
uint64_t lar_tick_steps(const lar_simulation *simulation);

lar_status lar_guide_create(const lar_simulation *simulation, int32_t tool, int coupled,
                            lar_guide *guide, lar_error *error);
/* Where the simulation has put it: begins anew there. */
void lar_guide_reset(lar_guide *guide, const lar_simulation *simulation);
/* Before a tick: sends the tool where the hand is. Moves that are refused are counted only. */
lar_status lar_guide_follow(lar_guide *guide, lar_simulation *simulation, const lar_tool_pose *hand,
                            lar_error *error);
/* After a tick. */
void lar_guide_feel(lar_guide *guide, const lar_simulation *simulation);

/* Between two places. */
double lar_apart(const double a[3], const double b[3]);

#endif
