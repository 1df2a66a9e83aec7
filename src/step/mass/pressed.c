#include "step/mass/pressed.h"

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

double lar_pressed_takes(const lar_domain *domain, lar_gid e, lar_state *state) {
    if (!state->pressed[e]) return 0;
    state->pressed[e] = LAR_PRESSED_MEASURED;
    return domain->burden->springs * state->hardness;
}

void lar_pressed_list(const lar_domain *domain, const lar_interactions *interactions,
                      lar_state *state) {
    const lar_tool_contact *contact = &interactions->tool_contact;
    if (!state->needs) return;
    double need = domain->burden->room + domain->burden->springs * (state->hardness - 1);
    for (int32_t i = 0; i < contact->loaded_count; i++) {
        lar_gid e = element_of(domain, contact, i);
        if (state->pressed[e] == LAR_PRESSED && state->hardness > 1)
            lar_needs_add(state->needs, e, need);
        state->pressed[e] = 0;
    }
}
