/* Tools that are added while a simulation runs.
 *
 *     list    model's ... | hands ... | spare 0 | spare 1 | ...
 *                                        ^ what it is follows tools->spare[0]
 *
 * A simulation has room for a fixed number of them from the start, so that nothing is allocated
 * and no array grows while it computes. Those that are not placed take part in nothing: the same
 * bits come out as without them. What is placed where is plain numbers in lar_tools, which travel
 * to all processors with the order to go on, and are in checkpoints; whoever takes these over
 * (another process, a load, going back) brings its list after them.
 */
#ifndef LAR_CONTACT_SPARES_H
#define LAR_CONTACT_SPARES_H

#include "contact/tools.h"

/* The first spare of a list. */
static inline int32_t lar_spares_first(const lar_tool_list *list) {
    return list->count - list->spares;
}

/* The place of a tool among the spares; -1: it is none. */
static inline int32_t lar_spare_of(const lar_tool_list *list, int32_t tool) {
    int32_t first = lar_spares_first(list);
    return tool >= first && tool < list->count ? tool - first : -1;
}

/* Tells the tool that is at an index now from others that were: 0 for all but spares. */
static inline int32_t lar_spare_serial(const lar_tool_list *list, const lar_tools *tools,
                                       int32_t tool) {
    int32_t place = lar_spare_of(list, tool);
    return place < 0 ? 0 : tools->spare[place].serial;
}

/* How many spares must be there for what is placed: those up to the last one. */
int32_t lar_spares_needed(const lar_spare_tool spare[LAR_SPARES_MAX]);

/* Whether there is a tool at all. */
static inline bool lar_spares_any(const lar_tool_list *list, const lar_tools *tools) {
    return lar_spares_first(list) > 0 || lar_spares_needed(tools->spare) > 0;
}

/* Names of all that can be placed: "sphere 1", the place counted from 1, or, when another tool has
 * that name, as many more as there can be spares. */
void lar_spares_name(lar_tool_list *list);

/* The list's spares become those of `tools`. True when one has changed. */
bool lar_spares_take(const lar_tools *tools, lar_tool_list *list);

/* What tool `index` is when the spares are these, whatever the list has there now; a spare that is
 * there has no name. */
lar_tool lar_spare_tool_of(const lar_tool_list *list, const lar_spare_tool spare[LAR_SPARES_MAX],
                           int32_t index);

/* Places a tool, at rest, in a free place, or clears a place. The list follows. */
void lar_spare_put(int32_t place, const lar_tool *tool, lar_tool_list *list, lar_tools *tools);
void lar_spare_clear(int32_t place, lar_tool_list *list, lar_tools *tools);

/* Whether these can be, for what comes from files and from other processes. */
bool lar_spares_good(const lar_spare_tool spare[LAR_SPARES_MAX], int32_t spares);

#endif
