/* Tools as bodies: stopped by tissue, whatever the hand does (Zilles and Salisbury 1995: god
 * object; Colgate, Stanley, Brown 1995: virtual coupling).
 *
 *     hand  o----[ |D| <= limit ]----( tool )----[ contact ]---- tissue
 *           asked for                 goes                       pushes with F
 *
 * As long as the tissue pushes no harder than the limit, and is nowhere deeper in the tool than its
 * depth limit, the tool is where its hand asks it to be, exactly. Beyond that it is a body without
 * mass, with a drag b, between its hand and the tissue: the hand draws it with the force D that
 * would bring it to where it is asked to be,
 *
 *     b dx/dt = D + F,      D = b (x_hand - x) / T - F, shortened to the limit,
 *
 * so it stays where the tissue bears the limit, and is pushed back where it bears more. The same
 * for the turn (torques about the tip) and for the jaws (their moment against closing). Where the
 * tissue is too deep in the tool F counts for more than it is: contact can hold a tool outside only
 * as long as the tool's middle line is outside (mechanics/contact.h). Where elements come close to
 * what steps bear the limit sinks to F, and the tool stays.
 *
 * This is decided at the beginning of INTERVALS of a few steps, the same steps everywhere, from
 * sums of whole numbers: the way of a tool does not depend on who computes, nor on how many steps
 * are advanced at once. Within an interval a tool moves evenly.
 */
#ifndef LAR_CONTACT_TOOL_BODY_H
#define LAR_CONTACT_TOOL_BODY_H

#include "contact/tools.h"

/* What the limits follow from. */
typedef struct lar_tissue_scale {
    double shear;     /* least shear modulus at the surface [Pa] */
    double edge;      /* mean length of an element's edges at the surface [m] */
    double stiffness; /* of contact with tools at a node of the surface, mean [N/m] */
    double interval;  /* [s] */
    bool firm;        /* there are free bodies */
} lar_tissue_scale;

/* Limits for all tools of a list. Without a surface (edge 0) there are none. */
void lar_tool_limits_set(const lar_tissue_scale *scale, lar_tool_list *list);

/* Steps of an interval: a power of two, at most LAR_INTERVAL_MAX. */
enum { LAR_INTERVAL_MAX = 8 };
uint64_t lar_tool_interval(double time_step);

/* Asks a tool to go where `motion` says; it does when nothing keeps it. */
void lar_tool_ask(lar_tools *tools, int32_t tool, const lar_tool_motion *motion);

/* What tools have become: as hard as the hardest, some harder than before, some other than before.
 */
typedef struct lar_hardened {
    double most;
    bool harder, changed;
} lar_hardened;

/* At the beginning of an interval: how hard each tool is from now on (lar_tools.hardness). One that
 * tissue is deep in becomes harder, which takes parts of a step. `fading`: what is left of
 * something over the time since the last decision, `seconds`; `unit`: newtons of a force unit;
 * `least`: how hard they are at least. */
lar_hardened lar_tools_harden(const lar_tool_list *list, lar_tools *tools, double least,
                              double fading, double seconds, double unit);

/* How far a tool that tissue is in goes in a step, from step `step` on [m]. */
double lar_tools_way(const lar_tool_list *list, const lar_tools *tools, uint64_t step);

/* Whether from step `step` on no tool goes faster than `speed` [m/s] anywhere, nor is kept from
 * its hand. */
bool lar_tools_are_slow(const lar_tool_list *list, const lar_tools *tools, uint64_t step,
                        double time_step, double speed);

/* Whether a tool goes so far within so many steps that it may be deep in what it meets, or through
 * it, before anybody decides how hard that holds it. */
bool lar_tools_are_fast(const lar_tool_list *list, const lar_tools *tools, uint64_t step,
                        uint64_t steps);

/* At the beginning of an interval that ends at step `until`: decides where tools go in it, and
 * forgets what they have felt. `need`: of elements in the interval before it (lar_step_division);
 * `unit`: newtons of a force unit. True when a tool does not go where it went before. */
bool lar_tools_follow(const lar_tool_list *list, lar_tools *tools, uint64_t step, uint64_t until,
                      double time_step, double need, double unit);

#endif
