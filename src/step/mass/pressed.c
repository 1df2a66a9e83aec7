#include "step/mass/pressed.h"

#include <math.h>

#include "step/mass/masses.h"
#include "step/mass/needs.h"

static lar_gid element_of(const lar_domain *domain, const lar_tool_contact *contact,
                          int32_t loaded) {
    int32_t face = contact->faces->face[contact->loaded[loaded].face].of;
    return domain->model->surface.element[face];
}

void lar_pressed_mark(const lar_domain *domain, const lar_interactions *interactions,
                      lar_state *state) {
    const lar_tool_contact *contact = &interactions->tool_contact;
    if (!state->needs) return;
    for (int32_t i = 0; i < contact->loaded_count; i++)
        state->pressed[element_of(domain, contact, i)] = LAR_PRESSED;
}

void lar_pressed_need(const lar_domain *domain, lar_gid e, double need, lar_state *state) {
    static const double ROUNDING = 1e-9; /* the fastest element and springs make all of the room */
    if (state->pressed[e]) need += domain->room.springs * state->hardness;
    if (state->pressed[e]) state->pressed[e] = LAR_PRESSED_MEASURED;
    if (!(need > (1 + ROUNDING) * domain->room.max)) return;
    if (domain->burden)
        lar_needs_add(state->needs, e, need);
    else
        lar_needs_add_beyond(state->needs, need);
}

/* Of an element that is not strained, as a part of the fastest one's. */
static double need_at_rest(const lar_domain *domain, lar_gid e) {
    double faster = domain->faster[lar_factor_of(domain->model->element_material[e])];
    double bound = domain->stable_step * domain->stable_step / 4;
    return domain->room.rest * faster * domain->rate[e].square * bound;
}

void lar_pressed_list(const lar_domain *domain, const lar_interactions *interactions,
                      lar_state *state) {
    const lar_tool_contact *contact = &interactions->tool_contact;
    if (!state->needs) return;
    state->needs->fastest = fmax(state->needs->fastest, state->fastest);
    for (int32_t i = 0; i < contact->loaded_count; i++) {
        lar_gid e = element_of(domain, contact, i);
        if (state->pressed[e] == LAR_PRESSED)
            lar_pressed_need(domain, e, need_at_rest(domain, e), state);
        state->pressed[e] = 0;
    }
}
