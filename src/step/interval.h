/* Intervals: what is decided every few steps, in the same steps on every grid.
 *
 *     step      0       4       8      12          an interval of four steps
 *               |decide |decide |decide |          what is decided holds
 *     advance   ------------->---->-------->       may end anywhere: what was felt is kept in
 * lar_tools
 *
 * Several processors stop there, for one of them has to know what all have felt. What is decided:
 * where tools go (contact/tool_body.h), whether steps are divided, and which strained elements are
 * heavier instead (step/mass/heavier.h). A material that was made
 * stiffer (model/settings.h) does not wait: there is a decision before the next step.
 */
#ifndef LAR_STEP_INTERVAL_H
#define LAR_STEP_INTERVAL_H

#include "step/domain.h"
#include "step/report.h"

/* What has been handed on of the tools' sums of an advance, and what is known of all advances. */
typedef struct lar_interval {
    lar_tool_sum seen[LAR_TOOLS_MAX];
    double depth[LAR_TOOLS_MAX]; /* the deepest tissue in a tool in this advance [m] */
    uint64_t divided;            /* steps in more than one part, of all advances */
    int32_t parts;               /* of a step, at most, of all advances; 0: none was done */
    uint64_t steps;              /* of all advances */
    double heavy_steps;          /* sum over them of what strained elements had more [kg] */
    double heaviest;             /* of that the most [kg] */
} lar_interval;

/* An advance begins: its sums begin with nothing. */
void lar_interval_restart(lar_interval *interval);

/* After some steps of an advance: what tools have felt, and elements need, since the last call. */
void lar_interval_harvest(lar_interval *interval, const lar_domain *whole, const lar_report *report,
                          uint64_t steps, lar_tools *tools);

/* Before the step `step`: where an interval begins, or a decision is due, decides. True when
 * lar_tools has changed. */
bool lar_interval_decide(const lar_domain *whole, uint64_t step, lar_tools *tools);

/* Of these decisions the one that divides steps, or no longer, and says which elements are heavier
 * instead. Elements: `division->need`, which with the tools' springs has to find room. Tools: where
 * tissue is deep in one, all become harder, which takes parts of a step. `seconds`: since the last
 * decision. True when something changes. */
bool lar_interval_divide(const lar_domain *whole, uint64_t step, double seconds, lar_tools *tools);

/* How many times as stiff springs of tools are as those of the model's own materials: what stiffer
 * ones that are set ask for, as far as the parts that they divide steps into have room. At least 1.
 */
double lar_interval_springs(const lar_domain *whole);

/* Steps of an interval: those with tools decide more often. */
uint64_t lar_interval_length(const lar_domain *whole, const lar_tools *tools);

/* The step before which the interval that `step` belongs to ends: domain.interval steps, or one
 * while elements are strained. */
uint64_t lar_interval_end(const lar_domain *whole, const lar_step_division *division,
                          uint64_t step);

#endif
