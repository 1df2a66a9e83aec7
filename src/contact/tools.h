/* Where the tools are, and what else is the input of a simulation besides its model. Where they are
 * asked to go is one thing (their hand), where they go another (tool_body.h).
 *
 *     tool_move at step 100, 10 steps:   from ---- linear ---- to ======= rests there
 *                                        100                  110
 *
 * Plain numbers without pointers, so that they travel in orders to other processes and into
 * checkpoints as they are. Changed between advances only, when no processor computes (so the change
 * takes effect in the same step everywhere, T 6.5.1); read by all threads within them.
 *
 * Who holds what is decided here too, by whoever has the whole state: a grasp binds a point of a
 * face to the tool's own axes (docs/theory.md, contact).
 */
#ifndef LAR_CONTACT_TOOLS_H
#define LAR_CONTACT_TOOLS_H

#include <stdbool.h>
#include <stddef.h>

#include "layout/state.h"
#include "model/forces.h"
#include "model/parameters.h"
#include "model/settings.h"
#include "model/supports.h"

enum { LAR_GRASPS_MAX = 256 };

enum { LAR_HOLDS = 1, LAR_HOLDS_NEAR };
typedef struct lar_tool_motion {
    lar_tool_pose from, to;
    /* Steps; of a free body in the part of step `end` that is under way, start > end. */
    uint64_t start, end;
    int32_t holding; /* it has closed upon something, or nothing, and not opened since: 1; and
                        since the last decision something has been within its jaws, or it has
                        just closed: 2 */
    int32_t outside; /* no tissue that it touches has come near its middle: 1 (tool_body.h) */
} lar_tool_motion;

/* A surface point that a tool has hold of. */
typedef struct lar_grasp {
    int32_t tool;
    int32_t face;     /* index into the model's surface */
    double weight[4]; /* of the face's corners, sum 1 */
    double anchor[3]; /* where the point is kept, in the tool's own axes [m] */
    double stiffness; /* [N/m] */
} lar_grasp;

/* What a tool has felt of the tissue since the present interval began (contact/tool_body.h). Whole
 * numbers, so that it does not matter who felt it nor where an advance ended. */
typedef struct lar_tool_felt {
    int64_t force[3], torque[3]; /* sums over shares of steps [force units, and times metres] */
    int64_t squeeze;             /* of the jaws, outwards at their ends, likewise [force units] */
    double depth;                /* the deepest point of the tissue in the tool [m] */
    uint64_t steps;
} lar_tool_felt;

/* Forces on tools are summed in shares of a step, so that a part of a divided one counts for what
 * it is. Every number of parts divides them. */
enum { LAR_STEP_SHARES = 96 };

/* Into how many parts a step is divided, how hard tools become, and up to what elements' need is
 * remembered: more than any number of parts bears makes no difference, and must be over some time.
 */
enum { LAR_PARTS_MAX = 32, LAR_HARDNESS_MAX = 64 };
enum { LAR_NEED_MAX = LAR_PARTS_MAX * LAR_PARTS_MAX };
enum { LAR_UNTOUCHED_LONG = INT16_MAX, LAR_STILL_LONG = 32 };

/* How steps are divided, for a while, where elements are strained or tools press hard. */
typedef struct lar_step_division {
    int32_t parts;   /* of a step: 1, 2, 3, 4, 6, 8, 12, ... (lar_more_parts) */
    int32_t before;  /* as many until `since` */
    uint64_t since;  /* step */
    double hardness; /* of the hardest tool (lar_tools), at most parts^2 or, where elements may be
                        heavier, four times that */
    double need;   /* of the last interval: (omega dt / 2)^2 of the fastest element, dt undivided */
    double lately; /* the largest `need`, fading */
    uint64_t decided;  /* the step when it was decided last */
    int16_t base;      /* parts that stiffer materials (settings.h) take at least, a power of two */
    int16_t softer;    /* for how many steps these have asked for fewer */
    int8_t due;        /* 1: to be decided before the next step, wherever an interval begins; and 2
                          for each decision to come that is close (lar_division_watch); and
                          LAR_THROWN from the end of an interval to the next decision */
    int8_t still;      /* for how many decisions nothing has moved, LAR_STILL_LONG: long enough;
                          negative: something has since the last one */
    int16_t untouched; /* for how many steps, and one, nothing has pressed on the body since a tool
                          did; LAR_UNTOUCHED_LONG: for a tenth of a second; 0: none ever did */
} lar_step_division;

/* An element that is strained, and may move with more mass for that (step/mass/heavier.h). */
typedef struct lar_heavy {
    int32_t element, padding;
    double factor;       /* its mass is so many times what it is otherwise; 1: not heavier */
    double need, lately; /* as in lar_step_division, of this element */
    double held;         /* the factor, fading */
} lar_heavy;

/* More of them would be looked after than need it: those that need it most are, and until it is
 * decided again those of the next interval, too. */
enum { LAR_HEAVIER_MAX = 64, LAR_HEAVY_LIST = 2 * LAR_HEAVIER_MAX };

/* All zero where the scene does not ask for them. */
typedef struct lar_heavy_list {
    int32_t count;
    float deep;                   /* what springs deep in other bodies need, of this interval */
    double beyond_need, beyond;   /* the same, the largest of those that did not find room */
    lar_heavy of[LAR_HEAVY_LIST]; /* by element */
} lar_heavy_list;

/* What of it all processors have to know: the elements that are heavier now. Zero behind them. */
typedef struct lar_heavy_now {
    int32_t count, padding;
    int32_t element[LAR_HEAVIER_MAX];
    uint8_t eighths[LAR_HEAVIER_MAX]; /* of their mass */
} lar_heavy_now;

/* The next larger number of parts that there is: powers of two, and three halves of them. */
static inline int32_t lar_more_parts(int32_t parts) {
    return (parts & (parts - 1)) != 0 ? parts / 3 * 4 : parts == 1 ? 2 : parts / 2 * 3;
}

/* A need beside what stiffer materials make it. */
static inline double lar_division_beside(const lar_step_division *division, double need) {
    return need / ((double)division->base * division->base);
}

/* How fast elements have been lately, as `need` counts, likewise. */
static inline double lar_division_need(const lar_step_division *division) {
    return lar_division_beside(division, division->lately);
}

/* How long the spring of a hold may be, as a part of what it may be in sound tissue: what is torn
 * away from a tool slips instead of being torn apart. Elements that have become so fast that steps
 * need some six parts slip earlier: a hand that went on pulling would turn them inside out. */
static inline double lar_division_reach(const lar_step_division *division) {
    static const double BORNE_RATE = 30; /* (omega dt / 2)^2 of the fastest element */
    double need = lar_division_need(division);
    return need > BORNE_RATE ? BORNE_RATE / need : 1;
}

/* Something is sudden: loads at the start, what is set in a run, a curve that jumps, nodes that are
 * thrown far (LAR_THROWN). Within one interval it can strain elements from nothing to beyond what a
 * step bears, so the next decisions are close. */
enum { LAR_WATCHED = 16, LAR_THROWN = 64 };
static inline void lar_division_watch(lar_step_division *division) {
    division->due = (int8_t)((division->due & 1) + 2 * LAR_WATCHED);
}

/* Whether it must be decided in every step: something is sudden, or elements are strained so that
 * they may soon be too fast for it, or must be heavier where tools begin to press; but not while
 * nothing moves, for then they stay as they are for an interval. */
static inline bool lar_division_is_close(const lar_step_division *division) {
    bool still = division->still == LAR_STILL_LONG || division->still == -LAR_STILL_LONG;
    bool strained = lar_division_need(division) > 0.7 ||
                    division->hardness > (double)division->parts * division->parts;
    return (division->due & ~LAR_THROWN) > 1 || (!still && strained);
}

/* Nothing presses on the body any more, so barriers of corners (mechanics/hex8_guard.h) are not
 * needed. They go, for one that a corner was pushed around would hold it there for good, and
 * without it hourglass forces bring the corner home. */
static inline bool lar_division_lets_go(const lar_step_division *division) {
    return division->untouched == LAR_UNTOUCHED_LONG;
}

/* The hand of a tool, and how far the tool is from following it. */
typedef struct lar_tool_follower {
    lar_tool_motion hand; /* what was asked for; `holding` and `outside` are 0 */
    lar_tool_felt felt;
    double load;     /* of the last interval: what was felt, as a part of what the tool may bear */
    int32_t lagging; /* it goes its own way: tools->motion is not that of the hand */
    int32_t behind;  /* in this interval a surface that looks away has been in the tool: 1 */
} lar_tool_follower;

/* A place for a tool that is added while the simulation runs (spares.h). Zero: free. */
typedef struct lar_spare_tool {
    int32_t placed, shape; /* 0 or 1; lar_tool_shape */
    int32_t serial;        /* how many have been placed here: tells one from the one before */
    int32_t padding;
    double radius, length, spread;
    lar_tool_pose rest;
} lar_spare_tool;

/* What a tool asks of a free body that it touches. */
typedef struct lar_bearing {
    int32_t tool, body; /* and the tool that moves the body */
    double asked;       /* as a part of what there is [m^2] */
    double deep;        /* the deepest of its springs, as they push [m] */
} lar_bearing;

/* Of all tools: whatever touches is no free body. */
enum { LAR_BEARINGS_MAX = LAR_TOOLS_MAX * LAR_TOOLS_MAX / 4 };
typedef struct lar_bearings {
    int32_t count;
    lar_bearing of[LAR_BEARINGS_MAX];
} lar_bearings;

static inline bool lar_bearings_good(const lar_bearings *all) {
    return all->count >= 0 && all->count <= LAR_BEARINGS_MAX;
}

/* NULL: it does not touch it. */
static inline const lar_bearing *lar_bearing_of(const lar_bearings *all, int32_t tool,
                                                int32_t body) {
    for (int32_t i = 0; i < all->count; i++)
        if (all->of[i].tool == tool && all->of[i].body == body) return &all->of[i];
    return NULL;
}

typedef struct lar_tools {
    int32_t count, grasp_count;
    lar_step_division division;
    lar_settings settings;
    lar_forces forces;
    lar_supports supports;
    lar_parameters parameters;
    lar_heavy_now heavier;
    lar_spare_tool spare[LAR_SPARES_MAX];
    lar_tool_motion motion[LAR_TOOLS_MAX]; /* where tools really go */
    double hardness[LAR_TOOLS_MAX];        /* how many times as stiff as at rest they are */
    lar_bearings bearings; /* of the step that comes, for threads that do not see all that a tool
                              touches */
    lar_grasp grasps[LAR_GRASPS_MAX];
    lar_tool_follower follower[LAR_TOOLS_MAX]; /* of processor zero only, */
    lar_heavy_list strained;                   /* as this, */
    double deep[LAR_TOOLS_MAX]; /* and this: the tissue in tools in the last interval [m], where it
                                   was close to their middle; else 0 */
} lar_tools;

/* What a tool may bear before it stays behind its hand, and how it then moves. */
typedef struct lar_tool_limits {
    double force;       /* [N] */
    double depth;       /* tissue in the tool [m] */
    double lever;       /* [m]: torques are forces at this distance from the tip */
    double grasp_force; /* of closing jaws, at their ends [N] */
    double pinch;       /* the same where elements are crushed [N] */
    double travel;      /* of a jaw's end from open to closed [m] */
    double drag;        /* of a tool on its own way [N s/m] */
    double firm;        /* how hard it is at most for free bodies [N/m]; 0: there are none */
    double firm_drag;   /* its drag beside these is no less [N s/m] */
} lar_tool_limits;

enum { LAR_HANDS_MAX = 4 };

/* What a tool is: the model's, then hands, then spares. The same on all processors; constant but
 * for the spares, which follow lar_tools.spare. */
typedef struct lar_tool_list {
    int32_t count, spares;
    lar_tool tool[LAR_TOOLS_MAX]; /* names are borrowed from the model, or `hand` or `name` */
    lar_tool_limits limits[LAR_TOOLS_MAX];
    char hand[LAR_HANDS_MAX][24];                                    /* names */
    char name[LAR_SPARES_MAX][LAR_TOOL_HAND][LAR_TOOL_NAME_MAX + 1]; /* by place and shape */
} lar_tool_list;

/* The model's tools, so many hands and so many spares; too many are an error. */
lar_status lar_tool_list_create(const lar_model *model, int32_t hands, int32_t spares,
                                lar_tool_list *list, lar_error *error);
/* All at rest, holding nothing. What was added stays. */
void lar_tools_reset(const lar_tool_list *list, lar_tools *tools);

/* Whether tissue can touch it: it is there, and has a surface. */
static inline bool lar_tool_touches(const lar_tool *tool) {
    return tool->shape <= LAR_TOOL_GRASPER;
}

/* Bytes of the used part, from the beginning on: what travels. */
static inline size_t lar_tools_bytes(const lar_tools *tools) {
    return offsetof(lar_tools, grasps) + (size_t)tools->grasp_count * sizeof tools->grasps[0];
}

/* Whether tools, of the first `count`, are not all as hard as the hardest, or tissue is close to
 * the middle of one. */
bool lar_tools_differ(const lar_tools *tools, int32_t count);

/* ---- whether what a file says of them may be, at a step, of so many tools -----------------------
 */

/* Numbers of steps are far below this: sums of two of them do not overflow. */
#define LAR_STEPS_MAX ((uint64_t)1 << 60)

bool lar_tool_motion_good(const lar_tool *tool, const lar_tool_motion *motion);
bool lar_tool_follower_good(const lar_tool *tool, const lar_tool_follower *follower);
bool lar_grasp_good(const lar_grasp *grasp, int32_t tools, const lar_model *model);
bool lar_division_good(const lar_step_division *division, uint64_t step);
bool lar_hardness_good(const lar_tools *tools, int32_t tool, double radius);

/* ---- where they are ----------------------------------------------------------------------------
 */

/* Pose and velocity (of the tip, [m/s]; may be NULL) of a tool at a step. */
void lar_tool_at(const lar_tool_motion *motion, uint64_t step, double time_step,
                 lar_tool_pose *pose, double velocity[3]);

/* The same when a part of the step, 0 up to 1, has passed. */
void lar_tool_within(const lar_tool_motion *motion, uint64_t step, double part, double time_step,
                     lar_tool_pose *pose, double velocity[3]);

/* Whether it is the way of a free body (step/rigid/free_body.h): `from` now, `to` a part later. */
static inline bool lar_tool_motion_free(const lar_tool_motion *motion) {
    return motion->start > motion->end;
}

/* For who looks before it is decided where tools go that are kept from their hands, and whose way
 * has come to its end: as if they went on so. False: there are none, and nothing is written. */
bool lar_tools_go_on(const lar_tools *tools, uint64_t step, lar_tools *next);

/* The same at the state's part of a step, or `ahead` parts later. `time_step`: of a whole step. */
void lar_tool_pose_now(const lar_tool_motion *motion, const lar_state *state, int32_t ahead,
                       double time_step, lar_tool_pose *pose);

/* ---- quaternions w, x, y, z, of unit length ------------------------------------------------- */

void lar_turn(const double q[4], const double v[3], double out[3]);      /* own axes to the world */
void lar_turn_back(const double q[4], const double v[3], double out[3]); /* and back */

#endif
