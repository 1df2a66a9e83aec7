#include "engine/interval.h"

#include <math.h>
#include <string.h>

#include "contact/tool_body.h"

static bool has_bodies(const lar_tool_list *list) {
    for (int32_t i = 0; list && i < list->count; i++)
        if (list->tool[i].shape != LAR_TOOL_HAND && list->limits[i].drag > 0) return true;
    return false;
}

void lar_interval_restart(lar_interval *interval) {
    memset(interval->seen, 0, sizeof interval->seen);
    memset(interval->depth, 0, sizeof interval->depth);
}

/* Far beyond what a tool may bear; then the exact number does not matter. */
static int64_t whole_number(lar_wide value) {
    const lar_wide most = (lar_wide)1 << 60;
    return (int64_t)(value > most ? most : value < -most ? -most : value);
}

/* Larger, or no number. */
static double larger(double a, double b) {
    return b <= a ? a : b;
}

void lar_interval_harvest(lar_interval *interval, const lar_report *report, uint64_t steps,
                          lar_tools *tools) {
    int32_t parts = tools->division.parts;
    if (parts > 1) interval->divided += steps;
    if (steps > 0 && parts > interval->parts) interval->parts = parts;
    tools->division.need = larger(tools->division.need, report->need);
    for (int32_t t = 0; t < tools->count; t++) {
        const lar_tool_sum *now = &report->tool[t];
        lar_tool_sum *before = &interval->seen[t];
        lar_tool_felt *felt = &tools->follower[t].felt;
        for (int k = 0; k < 3; k++) {
            felt->force[k] += whole_number(now->force[k] - before->force[k]);
            felt->torque[k] += whole_number(now->torque[k] - before->torque[k]);
        }
        felt->squeeze += now->squeeze - before->squeeze;
        felt->depth = now->depth > felt->depth ? now->depth : felt->depth;
        felt->steps += steps;
        interval->depth[t] = fmax(interval->depth[t], now->depth);
        *before = *now;
    }
}

uint64_t lar_interval_end(const lar_domain *whole, uint64_t step) {
    return (step / whole->interval + 1) * whole->interval;
}

/* How much of the 4 that central differences bear elements may take, over 4: all that the step took
 * at rest, and more as long as no tool touches them, which takes its own part (theory.md 10). */
static double most_of(const lar_domain *whole, const lar_tools *tools) {
    double share = whole->time_step / whole->stable_step, most = 0.9;
    for (int32_t i = 0; i < tools->count; i++)
        if (tools->follower[i].felt.depth > 0) most = 0.65;
    return fmax(most, 1.02 * share * share);
}

bool lar_interval_decide(const lar_domain *whole, uint64_t step, lar_tools *tools) {
    const lar_tool_list *list = whole->acting.touch.list;
    if (!list || step % whole->interval != 0) return false;
    bool changed = lar_tools_divide(list, tools, step, (double)whole->interval * whole->time_step,
                                    most_of(whole, tools), 1 / whole->scale);
    if (!has_bodies(list)) return changed;
    return lar_tools_follow(list, tools, step, step + whole->interval, whole->time_step,
                            1 / whole->scale) ||
           changed;
}
