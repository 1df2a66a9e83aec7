#include "contact/spares.h"

#include <stdio.h>
#include <string.h>

#include "model/contact_check.h"

static const char *const shape_word[LAR_TOOL_HAND] = {"sphere", "shaft", "grasper"};

static bool is_taken(const lar_tool_list *list, const char *name) {
    bool taken = false;
    for (int32_t i = 0; i < lar_spares_first(list); i++)
        taken = taken || strcmp(list->tool[i].name, name) == 0;
    return taken;
}

int32_t lar_spares_needed(const lar_spare_tool spare[LAR_SPARES_MAX]) {
    int32_t needed = 0;
    for (int32_t k = 0; k < LAR_SPARES_MAX; k++)
        if (spare[k].placed) needed = k + 1;
    return needed;
}

static const lar_tool nothing = {.name = (char *)"",
                                 .shape = LAR_TOOL_NONE,
                                 .rest = {.orientation = {1, 0, 0, 0}, .opening = 1}};

void lar_spares_name(lar_tool_list *list) {
    for (int32_t k = 0; k < list->spares; k++) {
        list->tool[lar_spares_first(list) + k] = nothing;
        for (int shape = 0; shape < LAR_TOOL_HAND; shape++) {
            char *name = list->name[k][shape];
            int number = k + 1;
            do {
                snprintf(name, sizeof list->name[k][shape], "%s %d", shape_word[shape], number);
                number += LAR_SPARES_MAX;
            } while (is_taken(list, name));
        }
    }
}

lar_tool lar_spare_tool_of(const lar_tool_list *list, const lar_spare_tool spares[LAR_SPARES_MAX],
                           int32_t index) {
    int32_t place = lar_spare_of(list, index);
    if (place < 0) return list->tool[index];
    const lar_spare_tool *spare = &spares[place];
    if (!spare->placed) return nothing;
    return (lar_tool){.shape = (lar_tool_shape)spare->shape,
                      .radius = spare->radius,
                      .length = spare->length,
                      .spread = spare->spread,
                      .rest = spare->rest};
}

/* Names are those of place and shape. */
static bool are_same(const lar_tool *a, const lar_tool *b) {
    return a->shape == b->shape && a->radius == b->radius && a->length == b->length &&
           a->spread == b->spread && memcmp(&a->rest, &b->rest, sizeof a->rest) == 0;
}

bool lar_spares_take(const lar_tools *tools, lar_tool_list *list) {
    bool changed = false;
    for (int32_t i = lar_spares_first(list); i < list->count; i++) {
        lar_tool *here = &list->tool[i];
        lar_tool there = lar_spare_tool_of(list, tools->spare, i);
        changed = changed || !are_same(here, &there);
        *here = there;
        if (here->shape != LAR_TOOL_NONE)
            here->name = list->name[i - lar_spares_first(list)][here->shape];
    }
    return changed;
}

/* Where it is, and what it has felt, begin anew. */
static void begin(const lar_tool_list *list, int32_t tool, lar_tools *tools) {
    const lar_tool_pose *rest = &list->tool[tool].rest;
    tools->motion[tool] = (lar_tool_motion){.from = *rest, .to = *rest};
    tools->follower[tool] = (lar_tool_follower){.hand = tools->motion[tool]};
    tools->hardness[tool] = 1;
    tools->deep[tool] = 0;
}

void lar_spare_put(int32_t place, const lar_tool *tool, lar_tool_list *list, lar_tools *tools) {
    lar_spare_tool *spare = &tools->spare[place];
    *spare = (lar_spare_tool){.placed = 1,
                              .shape = (int32_t)tool->shape,
                              .serial = (spare->serial + 1) & INT32_MAX,
                              .radius = tool->radius,
                              .length = tool->length,
                              .spread = tool->spread,
                              .rest = tool->rest};
    lar_spares_take(tools, list);
    begin(list, lar_spares_first(list) + place, tools);
}

void lar_spare_clear(int32_t place, lar_tool_list *list, lar_tools *tools) {
    lar_spare_tool *spare = &tools->spare[place];
    *spare = (lar_spare_tool){.serial = spare->serial};
    lar_spares_take(tools, list);
    begin(list, lar_spares_first(list) + place, tools);
}

static bool good(const lar_spare_tool *spare) {
    const lar_tool tool = {.shape = (lar_tool_shape)spare->shape,
                           .radius = spare->radius,
                           .length = spare->length,
                           .spread = spare->spread,
                           .rest = spare->rest};
    if (spare->serial < 0 || spare->padding != 0) return false;
    if (!spare->placed) return spare->shape == 0;
    return spare->placed == 1 && spare->shape >= 0 && spare->shape < LAR_TOOL_HAND &&
           !lar_tool_size_problem(&tool);
}

bool lar_spares_good(const lar_spare_tool spare[LAR_SPARES_MAX], int32_t spares) {
    bool fine = lar_spares_needed(spare) <= spares;
    for (int k = 0; k < LAR_SPARES_MAX; k++) fine = fine && good(&spare[k]);
    return fine;
}
