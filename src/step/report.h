/* What an advance brings besides the state: what the tools felt, what contact did. Sums of whole
 * numbers but for the work, so that threads and processors can be added in any order. Plain,
 * travels as it is, without tools that there are not. */
#ifndef LAR_STEP_REPORT_H
#define LAR_STEP_REPORT_H

#include <stddef.h>
#include <string.h>

#include "contact/interactions.h"
#include "step/mass/needs.h"

typedef struct lar_report {
    lar_contact_info contact; /* since the start */
    double moved, way; /* for contact of bodies: since the search, and in the last step [m] */
    double need;       /* of the elements: lar_state.need */
    double deep;       /* of bodies deep in each other: lar_body_contact.need */
    double taken;      /* by contact, as lar_state.contact: since the start [J] */
    double exchanged;  /* by contact of bodies, as lar_state.exchanged, likewise */
    lar_needs needs;   /* of single elements, where strained ones may be heavier */
    int32_t tools;     /* whose sums are there; those of others are 0 */
    lar_tool_sum tool[LAR_TOOLS_MAX];
} lar_report;

static inline size_t lar_report_bytes(const lar_report *report) {
    return offsetof(lar_report, tool) + (size_t)report->tools * sizeof report->tool[0];
}

static inline void lar_report_contact(lar_contact_info *sum, const lar_contact_info *other) {
    sum->possible += other->possible;
    sum->boxed += other->boxed;
    sum->tested += other->tested;
    sum->searches += other->searches;
    if (other->steps > sum->steps) sum->steps = other->steps;
    sum->touching += other->touching;
    if (other->deepest > sum->deepest) sum->deepest = other->deepest;
    if (other->deepest_ever > sum->deepest_ever) sum->deepest_ever = other->deepest_ever;
    if (sum->deepest > sum->deepest_ever) sum->deepest_ever = sum->deepest;
    sum->through += other->through;
    if (other->way > sum->way) sum->way = other->way;
}

static inline int32_t lar_report_tools(const lar_interactions *interactions) {
    return interactions->tool_contact.list ? interactions->tool_contact.list->count : 0;
}

/* Before an advance: what one thread has felt is forgotten. */
static inline void lar_report_begin(lar_interactions *interactions) {
    for (int32_t i = 0; i < lar_report_tools(interactions); i++)
        interactions->tool_contact.sum[i] = (lar_tool_sum){0};
}

/* Before a stretch of steps: what is the most of all of them. */
static inline void lar_report_stretch(lar_interactions *interactions) {
    lar_tool_contact_forget_depths(&interactions->tool_contact);
    interactions->body_contact.need = 0;
}

/* Whether so many bytes are a report. */
static inline bool lar_report_fits(const void *bytes, size_t count) {
    lar_report head;
    if (count < offsetof(lar_report, tool)) return false;
    memcpy(&head, bytes, offsetof(lar_report, tool));
    return head.tools >= 0 && head.tools <= LAR_TOOLS_MAX && count == lar_report_bytes(&head);
}

/* Adds `other` to `sum`. */
static inline void lar_report_join(lar_report *sum, const lar_report *other) {
    for (int32_t i = 0; i < other->tools; i++) {
        lar_tool_sum *to = &sum->tool[i];
        const lar_tool_sum *from = &other->tool[i];
        for (int k = 0; k < 3; k++) {
            to->force[k] += from->force[k];
            to->torque[k] += from->torque[k];
            to->rest[k] += from->rest[k];
        }
        to->squeeze += from->squeeze;
        for (int s = 0; s < 2; s++) to->jaw[s] += from->jaw[s];
        to->depth = from->depth > to->depth ? from->depth : to->depth;
        to->touching += from->touching;
        to->held += from->held;
        to->clings |= from->clings;
        to->behind |= from->behind;
    }
    if (other->tools > sum->tools) sum->tools = other->tools;
    lar_report_contact(&sum->contact, &other->contact);
    sum->moved = lar_larger(sum->moved, other->moved);
    sum->way = lar_larger(sum->way, other->way);
    sum->deep = lar_larger(sum->deep, other->deep);
    sum->need = lar_larger(sum->need, other->need);
    sum->taken += other->taken;
    sum->exchanged += other->exchanged;
    lar_needs_join(&sum->needs, &other->needs);
}

/* Adds what one thread has felt since lar_report_begin. */
static inline void lar_report_add(lar_report *sum, const lar_interactions *interactions,
                                  const lar_state *state) {
    lar_report own;
    own.tools = lar_report_tools(interactions);
    for (int32_t i = 0; i < own.tools; i++) own.tool[i] = interactions->tool_contact.sum[i];
    own.contact = interactions->tool_contact.seen;
    lar_report_contact(&own.contact, &interactions->body_contact.info);
    own.moved = interactions->body_contact.moved;
    own.way = interactions->body_contact.way;
    own.deep = interactions->body_contact.need;
    own.need = state->need;
    own.taken = state->contact;
    own.exchanged = state->exchanged;
    lar_needs_clear(&own.needs);
    lar_report_join(sum, &own);
    if (state->needs) lar_needs_join(&sum->needs, state->needs);
}

#endif
