#include "step/interval.h"

#include <math.h>
#include <string.h>

#include "contact/tool_body.h"
#include "step/grasp.h"
#include "step/mass/heavier.h"
#include "step/rigid/free_body.h"

void lar_interval_restart(lar_interval *interval) {
    memset(interval->seen, 0, sizeof interval->seen);
    memset(interval->depth, 0, sizeof interval->depth);
}

/* Far beyond what a tool may bear; then the exact number does not matter. */
static int64_t whole_number(lar_wide value) {
    const lar_wide max = (lar_wide)1 << 60;
    return (int64_t)(value > max ? max : value < -max ? -max : value);
}

/* Larger, or no number. */
static double larger(double a, double b) {
    return b <= a ? a : b;
}

/* Where nodes and tools are no faster than this [m/s], no element becomes thinner by more than a
 * hundredth within an interval. Thin ones are as fast as they are thin. */
static double slow(const lar_domain *whole, const lar_step_division *division) {
    static const double SHARE = 0.01;
    double thinnest = whole->thinnest / sqrt(fmax(1, fmax(division->need, division->lately)));
    double seconds = (double)whole->interval * whole->time_step;
    return SHARE * thinnest / (2 * sqrt(3) * seconds);
}

/* Whether elements are strained, and nodes go so far within an interval that a corner which was
 * sound when it began may be at its barrier before it ends (mass/strained.h): what is listed then
 * is too late, and another list for who takes the run up again on the way. */
static bool is_thrown(const lar_domain *whole, double need, double fastest) {
    static const double STRAINED = 0.1, SHARE = 0.4; /* of the thinnest element at rest */
    double seconds = (double)whole->interval * whole->time_step;
    return need > STRAINED && whole->thinnest > 0 && fastest * seconds > SHARE * whole->thinnest;
}

/* An element that is taken through a blow as a heavier one goes through it in few long parts of a
 * step, where leapfrog is least exact: while nodes go farther than that in a step, it is parts that
 * are taken, as many as the elements need or as keep nodes from going farther in one. */
static void divide_blows(const lar_domain *whole, const lar_needs *needs, lar_heavy_list *list) {
    static const double SHARE = 0.03; /* of the thinnest element at rest */
    if (!whole->burden || needs->count == 0 || !(whole->thinnest > 0)) return;
    double way = needs->fastest * whole->time_step / (SHARE * whole->thinnest);
    if (way > 1)
        list->beyond_need =
            larger(list->beyond_need, fmin(needs->of[0].need, whole->room.max * way * way));
}

/* Bodies that are deep in each other have springs that ask for parts (lar_contact_deep_need),
 * beside elements that are crushed there: of those that may be heavier it is known at the decision
 * which they are, however often somebody has looked before (lar_heavier_fade). */
static void divide_deep(const lar_domain *whole, const lar_report *report, int32_t base,
                        lar_heavy_list *list) {
    if (!(report->deep > 0)) return;
    const double elements = whole->room.max * base * base;
    list->beyond_need = larger(list->beyond_need, elements + report->deep);
    if (whole->burden) list->deep = fmaxf(list->deep, (float)report->deep);
}

void lar_interval_harvest(lar_interval *interval, const lar_domain *whole, const lar_report *report,
                          uint64_t steps, lar_tools *tools) {
    int32_t parts = tools->division.parts;
    double heavier = lar_heavier_added(whole, &tools->heavier);
    interval->steps += steps;
    interval->heavy_steps += (double)steps * heavier;
    if (steps > 0) interval->heaviest = fmax(interval->heaviest, heavier);
    if (parts > 1) interval->divided += steps;
    if (steps > 0 && parts > interval->parts) interval->parts = parts;
    tools->division.need = larger(tools->division.need, report->need);
    lar_heavier_harvest(&report->needs, &tools->strained);
    divide_blows(whole, &report->needs, &tools->strained);
    divide_deep(whole, report, tools->division.base, &tools->strained);
    lar_step_division *d = &tools->division;
    if (d->still > 0 && !(report->needs.fastest <= slow(whole, d))) d->still = (int8_t)-d->still;
    if (is_thrown(whole, d->need, report->needs.fastest)) d->due |= LAR_THROWN;
    for (int32_t t = 0; t < tools->count; t++) {
        const lar_tool_sum *now = &report->tool[t];
        lar_tool_sum *before = &interval->seen[t];
        lar_tool_felt *felt = &tools->follower[t].felt;
        for (int k = 0; k < 3; k++) {
            felt->force[k] = whole_number(felt->force[k] + now->force[k] - before->force[k]);
            felt->torque[k] = whole_number(felt->torque[k] + now->torque[k] - before->torque[k]);
        }
        felt->squeeze = whole_number(felt->squeeze + now->squeeze - before->squeeze);
        felt->depth = now->depth > felt->depth ? now->depth : felt->depth;
        felt->steps += steps;
        tools->follower[t].behind |= now->behind;
        if (now->clings && tools->motion[t].holding) tools->motion[t].holding = LAR_HOLDS_NEAR;
        interval->depth[t] = fmax(interval->depth[t], now->depth);
        *before = *now;
    }
}

uint64_t lar_interval_length(const lar_domain *whole, const lar_tools *tools) {
    bool tools_there = whole->model->tool_count > 0 || lar_spares_needed(tools->spare) > 0;
    return tools_there ? lar_tool_interval(whole->time_step) : LAR_INTERVAL_MAX;
}

uint64_t lar_interval_end(const lar_domain *whole, const lar_step_division *division,
                          uint64_t step) {
    if (lar_division_is_close(division)) return step + 1;
    return (step / whole->interval + 1) * whole->interval;
}

/* What elements take of a step, as a share of all, of the materials that are set. */
static double taken_now(const lar_domain *whole, bool *stiffer) {
    double dt = whole->time_step, stiff = 0, most = 0;
    for (int i = 0; i < LAR_FACTORS_MAX; i++) {
        most = fmax(most, whole->faster[i]);
        stiff = fmax(stiff, 0.25 * dt * dt * whole->fastest[i] * whole->faster[i]);
    }
    *stiffer = most > 1 && !lar_little_faster(most, stiff);
    return stiff;
}

static double taken_at_first(const lar_domain *whole) {
    double share = whole->time_step / whole->stable_step;
    return share * share;
}

/* Parts of a step that stiffer materials need. Elements take s^2 of a step, times what they are
 * faster, and contact at most what it takes beside elements as they are (mechanics/contact.c): a
 * part of 1/p of a step has room for p^2 of both together. */
static int32_t base_of(const lar_domain *whole) {
    static const double CONTACT_MAX = 9.0 / 16, CONTACT_MIN = 0.09;
    bool stiffer;
    double elements = taken_at_first(whole), stiff = taken_now(whole, &stiffer);
    double contact = fmax(CONTACT_MIN, fmin(CONTACT_MAX, 1 - elements));
    int32_t base = 1;
    while (stiffer && stiff + contact > fmax(1, elements + contact) * base * base) base *= 2;
    return base;
}

/* Whoever makes materials stiffer and softer again in turn would divide steps and undivide them,
 * and each change of the step may give fast modes energy: steps stay divided for some time. */
static void settle_base(const lar_domain *whole, double seconds, lar_step_division *d) {
    static const double LONG = 20; /* memories: of 50 ms a second */
    const double steps = d->softer + round(seconds / whole->time_step);
    const int32_t base = base_of(whole);
    if (base < d->base && steps < INT16_MAX && steps * whole->time_step < LONG * whole->memory) {
        d->softer = (int16_t)steps;
        return;
    }
    d->base = (int16_t)base;
    d->softer = 0;
}

double lar_interval_springs(const lar_domain *whole) {
    bool stiffer;
    double base = base_of(whole), times = taken_now(whole, &stiffer) / taken_at_first(whole);
    return fmax(1, fmin(times, base * base));
}

/* Elements that tools press on have reported what that takes of a step (step/mass/pressed.h); what
 * tools have become harder since counts beside all. */
static lar_heavy_room room_beside(const lar_domain *whole, const lar_tools *tools, double hardness,
                                  int32_t parts) {
    double more = fmax(0, hardness - tools->division.hardness);
    return (lar_heavy_room){.max = whole->room.max * parts * parts,
                            .springs = whole->room.springs * more};
}

/* Whether so many parts bear elements as they have been lately, and springs; where elements may be
 * heavier, with what they may. Tools that are harder than parts of steps bear beside any element
 * need these to be known, which they are once tools become no harder: while they do, something
 * comes into them. */
static bool bears(const lar_domain *whole, const lar_tools *tools, double hardness, int32_t parts) {
    static const double HARDER = 4;
    const lar_heavy_room beside = room_beside(whole, tools, hardness, parts);
    double harder = hardness / (parts * parts);
    if (harder > 1 && !(hardness <= tools->division.hardness && harder <= HARDER)) return false;
    return lar_heavier_bears(whole, &tools->strained, &beside);
}

/* Whether a tool that tissue is in goes too far in a part of a step: what an element is hit with
 * within one is known only after it. Known of hex8. */
static bool goes_too_far(const lar_domain *whole, double way, int32_t parts) {
    static const double SHARE = 0.1; /* of the thinnest element */
    return whole->thinnest > 0 && way > SHARE * whole->thinnest * parts;
}

/* For how many decisions nothing has moved, this one counted. A tool that becomes harder moves what
 * it presses on. */
static int8_t still_now(const lar_domain *whole, const lar_tools *tools, uint64_t step,
                        bool harder) {
    const lar_step_division *d = &tools->division;
    if (d->still < 0 || d->due || harder ||
        !lar_tools_are_slow(whole->surroundings.list, tools, step, whole->time_step,
                            slow(whole, d)))
        return 0;
    return d->still < LAR_STILL_LONG ? (int8_t)(d->still + 1) : LAR_STILL_LONG;
}

/* Whether anything but tools may hold elements in the shape that they have. */
static bool loaded(const lar_domain *whole, const lar_tools *tools, double time) {
    const lar_model *model = whole->model;
    double gravity[3];
    lar_gravity_at(model, &tools->settings, time, 0, gravity);
    return gravity[0] != 0 || gravity[1] != 0 || gravity[2] != 0 || lar_model_active(model) ||
           model->contact_count > 0 || model->move_count > 0 || model->load_count > 0 ||
           model->pressure_count > 0 || tools->forces.count > 0 || tools->supports.count > 0;
}

/* For how many steps nothing has been touched or loaded, after `seconds` more. */
static int16_t untouched_now(const lar_domain *whole, const lar_tools *tools, double time,
                             double seconds) {
    static const double LONG = 0.1; /* [s] */
    int16_t before = tools->division.untouched;
    bool touched = tools->grasp_count > 0;
    for (int32_t t = 0; t < tools->count; t++) {
        const lar_tool_felt *felt = &tools->follower[t].felt;
        touched = touched || felt->depth > 0;
        for (int k = 0; k < 3; k++) touched = touched || felt->force[k] != 0;
    }
    if (before == 0 && !touched) return 0;
    if (touched || loaded(whole, tools, time)) return 1;
    double steps = before + round(seconds / whole->time_step);
    bool over = steps * whole->time_step >= LONG || !(steps < LAR_UNTOUCHED_LONG);
    return over ? LAR_UNTOUCHED_LONG : (int16_t)steps;
}

/* Whether a load changes by much within the interval that begins. */
static bool jumps(const lar_domain *whole, uint64_t step) {
    static const double MUCH = 0.25;
    const lar_model *model = whole->model;
    double now = (double)step * whole->time_step;
    double then = now + (double)whole->interval * whole->time_step;
    for (int c = 0; c < model->curve_count; c++) {
        double before = lar_curve_value(&model->curve[c], now);
        double after = lar_curve_value(&model->curve[c], then);
        if (fabs(after - before) > MUCH * fmax(fabs(before), fabs(after))) return true;
    }
    return false;
}

/* Whether the model begins with what sets it in motion. */
static bool starts_suddenly(const lar_domain *whole, const lar_tools *tools) {
    return whole->model->initial_count > 0 || loaded(whole, tools, 0);
}

bool lar_interval_divide(const lar_domain *whole, uint64_t step, double seconds, lar_tools *tools) {
    lar_step_division *d = &tools->division;
    /* What was needed lately counts for some time: strained tissue trembles. */
    static const double HARD = 0.05; /* tools, in scenes [s] */
    const double fading = fmax(0.5, 1 - seconds / whole->memory);
    const double softens = whole->model->own_units ? fading : fmax(0.5, 1 - seconds / HARD);
    const lar_hardened tool =
        lar_tools_harden(whole->surroundings.list, tools, lar_interval_springs(whole), softens,
                         seconds, 1 / whole->scale);
    const double way = lar_tools_way(whole->surroundings.list, tools, step);
    const double reach = lar_division_reach(d);
    bool close = lar_division_is_close(d), let_go = lar_division_lets_go(d);
    if (step == 0 ? starts_suddenly(whole, tools)
                  : step % whole->interval == 0 && jumps(whole, step))
        lar_division_watch(d);
    if (d->due & LAR_THROWN ||
        lar_tools_are_fast(whole->surroundings.list, tools, step, whole->interval))
        lar_division_watch(d);
    d->still = still_now(whole, tools, step, tool.harder);
    d->untouched = untouched_now(whole, tools, (double)step * whole->time_step, seconds);
    d->due = d->due > 1 ? (int8_t)((d->due & ~1) - 2) : 0;
    d->lately = fmax(fmin(d->need, LAR_NEED_MAX), fading * d->lately);
    d->need = 0;
    lar_heavier_fade(fading, &tools->strained);
    int32_t wanted = d->base;
    while (wanted < LAR_PARTS_MAX &&
           (!bears(whole, tools, tool.most, wanted) || goes_too_far(whole, way, wanted) ||
            lar_free_bodies_turn_far(tools, step, wanted)))
        wanted = lar_more_parts(wanted);
    bool changed = tool.changed || wanted != d->parts || close != lar_division_is_close(d) ||
                   let_go != lar_division_lets_go(d) ||
                   (tools->grasp_count > 0 && reach != lar_division_reach(d));
    if (whole->burden) {
        const lar_heavy_room beside = room_beside(whole, tools, tool.most, wanted);
        lar_heavier_settle(whole, &beside, fading, &tools->strained);
        changed = lar_heavier_name(&tools->strained, &tools->heavier) || changed;
    }
    d->hardness = tool.most;
    if (wanted == d->parts) return changed;
    d->before = d->parts;
    d->parts = wanted;
    d->since = step;
    return true;
}

bool lar_interval_decide(const lar_domain *whole, uint64_t step, lar_tools *tools) {
    const lar_tool_list *list = whole->surroundings.list;
    lar_step_division *division = &tools->division;
    if (!list) return false;
    if (step % whole->interval != 0 && !lar_division_is_close(division) && !division->due)
        return false;
    double seconds = (double)(step - division->decided) * whole->time_step;
    settle_base(whole, seconds, division);
    division->decided = step;
    const double need = division->need;
    bool changed = lar_interval_divide(whole, step, seconds, tools);
    changed = lar_grasp_slip(list, tools) || changed;
    return lar_tools_follow(list, tools, step, lar_interval_end(whole, division, step),
                            whole->time_step, lar_division_beside(division, need),
                            1 / whole->scale) ||
           changed;
}
