#include "contact/tool_body.h"

#include <math.h>
#include <string.h>

#include "base/quaternion.h"
#include "base/vector.h"

/* ---- limits -------------------------------------------------------------------------------- */

/* Pressure that tissue bears under a tool, in shear moduli; on the tool's cross-section and half an
 * element around it. */
static const double PRESSURE_MAX = 6;
/* Contact must bear the limit at a depth at which the tool's middle is well outside. */
static const double DEPTH_MAX = 0.5, BEARS = 0.45;
/* And elements must bear it: (omega dt / 2)^2 of the fastest, dt undivided, for some ten parts.
 * Hands press with less the faster elements have been lately, from some two parts on, and with no
 * more than tissue pushes with already from five on: a tool that went on until it had to give way,
 * and came back, would shake the organ and the hand. What presses with little of its limit is not
 * what made them fast, and may go on until they are as fast as may be. */
static const double BORNE_RATE = 100, HELD_RATE = 25, FREE_RATE = 2.5, LITTLE = 0.1;
static const double GRASP_SHARE = 0.5;
/* Jaws press less the faster elements have become by that, as BORNE_RATE counts, down to so many
 * shear moduli on half of a jaw's side. */
static const double SOUND_RATE = 0.5, PINCH = 0.5;
/* Of what contact pushes in an interval: less and a tool swings between hand and tissue. */
static const double DRAG = 16;
/* Free bodies bear the limit at a depth of so many radii, and what they push back with in an
 * interval counts as often. */
static const double FIRM = 0.03, FIRM_DRAG = 4;

uint64_t lar_tool_interval(double time_step) {
    static const double SECONDS = 4e-4;
    uint64_t steps = 1;
    while (steps < LAR_INTERVAL_MAX && (double)(2 * steps) * time_step <= SECONDS) steps *= 2;
    return steps;
}

/* The area that a lying capsule presses on. */
static double shadow(double radius, double length) {
    return 3.14159265358979 * radius * radius + 2 * radius * length;
}

void lar_tool_limits_set(const lar_tissue_scale *scale, lar_tool_list *list) {
    for (int32_t i = 0; i < list->count; i++) {
        const lar_tool *tool = &list->tool[i];
        lar_tool_limits *limits = &list->limits[i];
        double reach = tool->radius + 0.5 * scale->edge;
        double tissue = PRESSURE_MAX * scale->shear * shadow(reach, tool->length);
        double nodes = shadow(tool->radius, tool->length) / (scale->edge * scale->edge);
        double contact = BEARS * tool->radius * scale->stiffness * fmax(nodes, 1);
        *limits = (lar_tool_limits){.force = fmin(tissue, contact),
                                    .depth = DEPTH_MAX * tool->radius,
                                    .lever = fmax(tool->radius, 0.5 * tool->length),
                                    .travel = 0.5 * tool->spread * tool->length,
                                    .drag = DRAG * scale->stiffness * scale->interval};
        limits->firm = scale->firm ? limits->force / (FIRM * tool->radius) : 0;
        limits->firm_drag = FIRM_DRAG * limits->firm * scale->interval;
        limits->grasp_force = GRASP_SHARE * limits->force;
        limits->pinch =
            fmin(limits->grasp_force, PINCH * scale->shear * tool->radius * tool->length);
    }
}

/* ---- following ------------------------------------------------------------------------------ */

void lar_tool_ask(lar_tools *tools, int32_t tool, const lar_tool_motion *motion) {
    lar_tool_motion *now = &tools->motion[tool];
    lar_tool_follower *follower = &tools->follower[tool];
    follower->hand = *motion;
    follower->hand.holding = follower->hand.outside = 0;
    if (follower->lagging) return;
    int32_t holding = now->holding, outside = now->outside;
    *now = *motion;
    now->holding = holding;
    now->outside = outside;
}

/* What a tool has felt in an interval, on average. */
typedef struct mean_load {
    double force[3], torque[3]; /* [N] [N m] */
    double squeeze;             /* [N] */
    double grasp_force;         /* how hard jaws may close [N] */
    double excess;              /* how many times more than may be, at least 1 */
    double crushed;             /* what of it is because elements are too fast */
    double opens;               /* as `excess`, for jaws */
    double little;              /* part of what may be which hands press with anyway */
    double more; /* part of what may be beyond that force which hands press with, 0 to 1 */
    bool touched;
} mean_load;

/* How fast elements are, as lar_step_division.need says, and have been. */
typedef struct element_need {
    double now, lately;
} element_need;

/* What closes on a fold crushes it with less than what a tool may press with from one side: between
 * two jaws tissue gives way to nowhere but out of them. (Steeper in `need` and jaws swing.) */
static double grasp_limit(const lar_tool_limits *limits, double need) {
    double share = need > SOUND_RATE ? SOUND_RATE / need : 1;
    return fmax(limits->pinch, limits->grasp_force * share * share);
}

/* What jaws can do, or are asked to. */
typedef struct jaws_state {
    bool close;  /* they are asked to be closer than they can be pushed apart */
    double room; /* how far they can be pushed apart: 1, down to 0 where they are wide open */
} jaws_state;

static jaws_state jaws_of(const lar_tool_follower *follower, const lar_tool_motion *motion) {
    static const double NEARLY_OPEN = 0.1;
    return (jaws_state){.close = follower->hand.to.opening < 1 || motion->to.opening < 1,
                        .room = fmin(1, (1 - motion->to.opening) / NEARLY_OPEN)};
}

/* Where other things than forces ask a tool to give way, it does so where it is pushed hardest; but
 * jaws that are wide open cannot. Tissue that is deep in it counts as pushing as much beyond its
 * limit as it is too deep. Elements that are too fast make what pushes count for as much more, and
 * no limit does: that of a large tool is many times what crushes a wall, and would throw it to and
 * fro. */
static mean_load mean_of(const lar_tool_felt *felt, const lar_tool_limits *limits, jaws_state jaws,
                         element_need need, double unit, double *load) {
    mean_load mean = {.crushed = 1, .opens = 1, .grasp_force = grasp_limit(limits, need.lately)};
    double share = felt->steps ? unit / (LAR_STEP_SHARES * (double)felt->steps) : 0;
    for (int i = 0; i < 3; i++) {
        mean.force[i] = (double)felt->force[i] * share;
        mean.torque[i] = (double)felt->torque[i] * share;
    }
    mean.squeeze = (double)felt->squeeze * share;
    double force = lar_length(mean.force) / limits->force;
    double turn = lar_length(mean.torque) / (limits->force * limits->lever);
    double grasp = jaws.close ? mean.squeeze / mean.grasp_force : 0;
    double depth = felt->depth / limits->depth;
    double max = fmax(fmax(force, turn), grasp);
    double gives = fmax(fmax(force, turn), jaws.room * grasp);
    double other = fmax(depth, max > 0 ? need.now / BORNE_RATE : 0);
    *load = fmax(max, other);
    mean.touched = max > 0 || depth > 0;
    double more = (HELD_RATE - need.lately) / (HELD_RATE - FREE_RATE);
    double little = (BORNE_RATE - need.lately) / (BORNE_RATE - HELD_RATE);
    mean.more = max > 0 ? fmin(1, fmax(0, more)) : 1;
    mean.little = LITTLE * fmin(1, fmax(0, little));
    if (other > 1 && other > gives && gives > 0) mean.opens = other / gives;
    mean.excess = mean.opens;
    if (mean.opens > 1 && other > depth) mean.excess = mean.crushed = other;
    return mean;
}

/* What holds in an interval for position, turn and jaws alike. */
typedef struct follow_law {
    double drag, seconds; /* [N s/m], of the interval */
    double farthest;      /* way in the interval [m] */
    double carries;       /* the part of its drag that it goes with, but does not turn or close */
    double way[3];        /* of the hand meanwhile: that goes, turns and closes it, as far as the
                             tool goes with it [m] */
    double room;          /* how much farther each of them may be [m] */
} follow_law;

static double dot(int count, const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < count; i++) sum += a[i] * b[i];
    return sum;
}

/* Shortens a way to the farthest of an interval. True when it was no longer. */
static bool shorten(const follow_law *law, int count, double *way) {
    double far = sqrt(dot(count, way, way));
    for (int i = 0; i < count && far > law->farthest; i++) way[i] *= law->farthest / far;
    return far <= law->farthest;
}

/* The way along `count` coordinates: `gap` is what is left to go, `pushed` what the tissue pushes
 * with, `max` what the hand may. True when all of it is gone. As far as tissue pushes the way that
 * the hand wants to go nothing holds the tool back: drag keeps it from swinging against tissue, and
 * in what opens would only make it late. Across that way drag holds as anywhere: a jaw that a fold
 * pushes from both sides in turn would else be led on through it, freely in every other interval.
 */
static bool go(const follow_law *law, int count, const double *gap, const double *pushed,
               double max, double *way) {
    double drawn[3], against[3], along = dot(count, gap, pushed);
    double helped = along > 0 ? along / dot(count, pushed, pushed) : 0;
    for (int i = 0; i < count; i++) {
        against[i] = helped > 0 ? 0 : pushed[i];
        drawn[i] = law->drag * (gap[i] - helped * pushed[i]) / law->seconds - against[i];
    }
    double length = sqrt(dot(count, drawn, drawn));
    double share = length > max ? max / length : 1;
    for (int i = 0; i < count; i++)
        way[i] = law->seconds / law->drag * (drawn[i] * share + against[i]) + helped * pushed[i];
    return shorten(law, count, way) && share == 1 && sqrt(dot(count, gap, gap)) <= law->farthest;
}

/* Of the hand's ways the one that belongs to these coordinates. */
static follow_law with_hand(const follow_law *law, int which) {
    follow_law goes = *law;
    goes.farthest = fmax(law->farthest, law->way[which] + fmin(law->farthest, law->room));
    return goes;
}

/* Turns `from` by a small rotation vector. */
static void turn_by(const double from[4], const double vector[3], double out[4]) {
    double turn[4] = {1, 0.5 * vector[0], 0.5 * vector[1], 0.5 * vector[2]};
    lar_quaternion_normalise(turn);
    lar_quaternion_product(turn, from, out);
    lar_quaternion_normalise(out);
}

/* From one orientation to another: twice the vector part, which is the rotation vector where the
 * angle is small, and has its direction always. */
static void turn_between(const double from[4], const double to[4], double vector[3]) {
    double inverse[4], turn[4];
    lar_quaternion_inverse(from, inverse);
    lar_quaternion_product(to, inverse, turn);
    for (int i = 0; i < 3; i++) vector[i] = (turn[0] < 0 ? -2 : 2) * turn[1 + i];
}

/* What the hand may draw with against what tissue pushes with along three coordinates. What touches
 * nothing follows whatever drags, for drag is a matter of contact: with a step far below what the
 * body would bear it is so hard that the limit moves a tool by millimetres in a second. While
 * elements are fast a tool goes on slowly: where it would crush them, they tell by becoming faster
 * before they give way, and it stops there (decision 214). */
static double draws(const mean_load *mean, const lar_tool_limits *limits, const follow_law *law,
                    const double *pushed) {
    static const double CAREFUL = 0.07; /* [m/s] */
    if (!mean->touched) return INFINITY;
    double max = limits->force, felt = sqrt(dot(3, pushed, pushed)) / mean->crushed;
    if (!(mean->more < 1)) return max; /* to the bit the limit while elements are slow */
    double force = fmin(fmax(felt, mean->little * max), max);
    double most = max - (1 - mean->more) * (max - force);
    return fmin(most, felt + law->drag * CAREFUL / (1 - mean->more));
}

/* The pose at the end of the interval: that of the hand, or as far towards it as may be. */
static void step_pose(const lar_tool *tool, const lar_tool_limits *limits, const mean_load *mean,
                      const follow_law *law, const lar_tool_pose *now, const lar_tool_pose *hand,
                      lar_tool_pose *next) {
    double gap[3], way[3], pushed[3], lever = limits->lever;
    follow_law goes = with_hand(law, 0);
    const follow_law turns = with_hand(law, 1), closes = with_hand(law, 2);
    goes.drag *= law->carries;
    *next = *hand;
    lar_minus(hand->position, now->position, gap);
    for (int i = 0; i < 3; i++) pushed[i] = mean->excess * mean->force[i];
    if (!go(&goes, 3, gap, pushed, draws(mean, limits, &goes, pushed), way))
        for (int i = 0; i < 3; i++) next->position[i] = now->position[i] + way[i];
    /* Turns as ways of a point at the lever's end. */
    turn_between(now->orientation, hand->orientation, gap);
    for (int i = 0; i < 3; i++) {
        gap[i] *= lever;
        pushed[i] = mean->excess * mean->torque[i] / lever;
    }
    if (!go(&turns, 3, gap, pushed, draws(mean, limits, law, pushed), way)) {
        for (int i = 0; i < 3; i++) way[i] /= lever;
        turn_by(now->orientation, way, next->orientation);
    }
    if (tool->shape != LAR_TOOL_GRASPER || !(limits->travel > 0)) return;
    gap[0] = limits->travel * (hand->opening - now->opening);
    pushed[0] = mean->opens * mean->squeeze;
    if (!go(&closes, 1, gap, pushed, mean->touched ? mean->grasp_force : INFINITY, way))
        next->opening = fmin(1, fmax(0, now->opening + way[0] / limits->travel));
}

static bool same_pose(const lar_tool_pose *a, const lar_tool_pose *b) {
    return memcmp(a, b, sizeof *a) == 0;
}

/* Whether jaws that tissue pushes apart are to open farther in the interval than tools that are
 * held back go. */
static bool springs_open(const lar_tool *tool, const lar_tool_limits *limits, const mean_load *mean,
                         const follow_law *law, const lar_tool_pose *now,
                         const lar_tool_pose *hand) {
    return tool->shape == LAR_TOOL_GRASPER && mean->squeeze > 0 &&
           limits->travel * (hand->opening - now->opening) > law->farthest;
}

/* The part of its drag that jaws have which carry something that hardly pulls at them: by that they
 * see that it goes with them. Were it held, a step of theirs would push with no more than half of
 * what they may. */
static double carries(const mean_load *mean, const lar_tool_limits *limits,
                      const lar_tool_motion *motion) {
    static const double LEAST = 0.125, LIGHT = 0.125;
    if (!motion->holding) return 1;
    const double force = lar_length(mean->force) + lar_length(mean->torque) / limits->lever;
    return fmin(1, fmax(LEAST, force / (LIGHT * limits->force)));
}

/* What touches nothing goes as fast as its hand, and faster until it is there: one that a blow has
 * kept back for a millisecond would else be farther behind a faster hand for ever. */
static void go_with(const lar_tool *tool, const lar_tool_limits *limits, const lar_tool_pose *from,
                    const lar_tool_pose *to, double steps, follow_law *law) {
    static const double HALF = 0.5; /* of its radius a tool may go in a step (lariat.h) */
    const double most = HALF * tool->radius * steps;
    double way[3], turn[3], all = 0;
    lar_minus(to->position, from->position, way);
    turn_between(from->orientation, to->orientation, turn);
    law->way[0] = lar_length(way);
    law->way[1] = limits->lever * lar_length(turn);
    law->way[2] = limits->travel * fabs(to->opening - from->opening);
    for (int i = 0; i < 3; i++) {
        law->way[i] = fmin(law->way[i], most);
        all += law->way[i];
    }
    law->room = fmax(0, most - all) / 3;
}

/* A tool that is kept from following goes its own way; one that has come back to its hand follows
 * again. Jaws that are opened at once are held back likewise, or what they let go would fly as if
 * nothing had held it. True when it goes elsewhere than before. */
static bool follow(const lar_tool *tool, const lar_tool_limits *limits, lar_tools *tools,
                   int32_t index, const mean_load *mean, uint64_t step, uint64_t until,
                   double time_step) {
    /* A tool may go half its radius in a step, all its parts together (lariat.h). */
    static const double SHARE = 0.15;
    static const double FASTEST = 0.5; /* [m/s]: no blows */
    lar_tool_follower *follower = &tools->follower[index];
    lar_tool_motion *motion = &tools->motion[index];
    const bool slower = mean->more < 1;
    if (!follower->lagging && follower->load <= 1 && !(mean->squeeze > 0) && !slower) return false;
    lar_tool_pose now, hand, then, next;
    lar_tool_at(motion, step, time_step, &now, NULL);
    lar_tool_at(&follower->hand, step, time_step, &hand, NULL);
    lar_tool_at(&follower->hand, until, time_step, &then, NULL);
    double steps = (double)(until - step), seconds = steps * time_step;
    follow_law law = {.drag = fmax(limits->drag * tools->hardness[index], limits->firm_drag),
                      .carries = carries(mean, limits, motion),
                      .seconds = seconds,
                      .farthest = fmin(SHARE * tool->radius * steps, FASTEST * seconds)};
    if (!mean->touched) go_with(tool, limits, &hand, &then, steps, &law);
    step_pose(tool, limits, mean, &law, &now, &then, &next);
    bool held_back = follower->load > 1 || (slower && !same_pose(&next, &then)) ||
                     springs_open(tool, limits, mean, &law, &now, &then);
    if (!held_back && !follower->lagging) return false;
    if (!held_back && same_pose(&now, &hand)) {
        int32_t holding = motion->holding, outside = motion->outside;
        *motion = follower->hand;
        motion->holding = holding;
        motion->outside = outside;
        follower->lagging = 0;
        return true;
    }
    motion->from = now;
    motion->to = next;
    motion->start = step;
    motion->end = until;
    follower->lagging = 1;
    return true;
}

static const double DANGER = 0.65; /* radii: tissue is close to the middle of a tool */

/* What becomes of how hard a tool is. */
typedef enum hardness_change { FADES, YIELDS, STAYS, HARDENS } hardness_change;

/* Tissue that is deep in a tool, although the tool presses no harder than it may, makes it harder.
 * One that presses too hard gives way instead, and presses softer until it does not; but not where
 * tissue is deep already, which comes deeper by that faster than a tool hardens. Close to the
 * middle a tool becomes harder whatever it presses with, as long as tissue still comes deeper: it
 * was `before` there in the last interval, 0 if not so close. */
static hardness_change change_for(double depth, double before, double load) {
    static const double SOFT = 0.3, HARD = 0.15, NEAR = 0.4; /* radii */
    static const double HEAVY = 3;                           /* limits */
    if (depth > DANGER && depth > before) return HARDENS;
    if (load > HEAVY && depth < NEAR) return YIELDS;
    if (depth > SOFT) return load > 1 ? STAYS : HARDENS;
    return depth < HARD ? FADES : STAYS;
}

/* Whether the middle of a tool is known to be outside of the tissue that it touches: it has begun
 * with what looks at it and nothing else, and nothing has come so near the middle since that this
 * may have passed it. Never of jaws: what looks away from one of them is before the other. */
static bool is_outside(const lar_tool *tool, const lar_tool_follower *follower, double depth,
                       bool before) {
    return tool->shape != LAR_TOOL_GRASPER && depth > 0 && depth <= DANGER &&
           (before || !follower->behind);
}

/* Not at once: what is already in the tool is driven out by that. */
static double hardened(double hardness, hardness_change change, double fading, double seconds) {
    static const double RISE = 1e-3; /* [s] */
    double factor = 1 + seconds / RISE;
    if (change == HARDENS) return fmin(factor * hardness, LAR_HARDNESS_MAX);
    if (change == YIELDS) return fmax(1, hardness / factor);
    return change == FADES ? fmax(1, fading * hardness) : hardness;
}

lar_hardened lar_tools_harden(const lar_tool_list *list, lar_tools *tools, double least,
                              double fading, double seconds, double unit) {
    lar_hardened all = {.most = 1};
    for (int32_t i = 0; i < tools->count; i++) {
        const lar_tool_felt *felt = &tools->follower[i].felt;
        double load, depth = felt->depth / list->tool[i].radius, before = tools->hardness[i];
        hardness_change change = FADES;
        if (depth > 0) {
            mean_load mean =
                mean_of(felt, &list->limits[i], (jaws_state){0}, (element_need){0}, unit, &load);
            change = change_for(depth, tools->deep[i] / list->tool[i].radius,
                                lar_length(mean.force) / list->limits[i].force);
        }
        tools->deep[i] = depth > DANGER ? felt->depth : 0;
        double now = fmax(hardened(before, change, fading, seconds), least);
        tools->hardness[i] = now;
        int32_t *outside = &tools->motion[i].outside, was = *outside;
        *outside = is_outside(&list->tool[i], &tools->follower[i], depth, was);
        all.most = fmax(all.most, now);
        all.harder = all.harder || now > before;
        all.changed = all.changed || now != before || *outside != was;
    }
    return all;
}

/* How far any part of a tool goes in a step of the interval that begins at step `step` [m]. */
static double way_of(const lar_tool_limits *limits, const lar_tool_motion *motion, uint64_t step) {
    double way[3], turn[3];
    if (motion->end <= step) return 0;
    lar_minus(motion->to.position, motion->from.position, way);
    turn_between(motion->from.orientation, motion->to.orientation, turn);
    double far = lar_length(way) + limits->lever * lar_length(turn) +
                 limits->travel * fabs(motion->to.opening - motion->from.opening);
    return far / (double)(motion->end - motion->start);
}

bool lar_tools_are_slow(const lar_tool_list *list, const lar_tools *tools, uint64_t step,
                        double time_step, double speed) {
    bool slow = true;
    for (int32_t i = 0; i < tools->count && slow; i++)
        slow = !tools->follower[i].lagging &&
               way_of(&list->limits[i], &tools->motion[i], step) <= speed * time_step;
    return slow;
}

bool lar_tools_are_fast(const lar_tool_list *list, const lar_tools *tools, uint64_t step,
                        uint64_t steps) {
    static const double FAR = 0.25; /* of its radius */
    bool fast = false;
    for (int32_t i = 0; i < tools->count && !fast; i++)
        fast = lar_tool_touches(&list->tool[i]) &&
               way_of(&list->limits[i], &tools->motion[i], step) * (double)steps >
                   FAR * list->tool[i].radius;
    return fast;
}

double lar_tools_way(const lar_tool_list *list, const lar_tools *tools, uint64_t step) {
    double max = 0;
    for (int32_t i = 0; i < tools->count; i++)
        if (tools->follower[i].felt.depth > 0)
            max = fmax(max, way_of(&list->limits[i], &tools->motion[i], step));
    return max;
}

bool lar_tools_follow(const lar_tool_list *list, lar_tools *tools, uint64_t step, uint64_t until,
                      double time_step, double need, double unit) {
    const element_need needs = {need, lar_division_need(&tools->division)};
    bool changed = false;
    for (int32_t i = 0; i < tools->count; i++) {
        const lar_tool_limits *limits = &list->limits[i];
        lar_tool_follower *follower = &tools->follower[i];
        lar_tool_felt felt = follower->felt;
        follower->felt = (lar_tool_felt){0};
        follower->behind = 0;
        if (!lar_tool_touches(&list->tool[i]) || !(limits->drag > 0)) continue;
        jaws_state jaws = jaws_of(follower, &tools->motion[i]);
        mean_load mean = mean_of(&felt, limits, jaws, needs, unit, &follower->load);
        changed |= follow(&list->tool[i], limits, tools, i, &mean, step, until, time_step);
    }
    return changed;
}
