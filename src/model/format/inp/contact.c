/* Abaqus and CalculiX decks: contact pairs, and the friction of their interactions. See deck.h.
 *
 *     *SURFACE INTERACTION, NAME=A <---.      walk 1: names and coefficients
 *     *FRICTION                        |
 *     0.3                              |
 *     *CONTACT PAIR, INTERACTION=A ----'      walk 2: surfaces
 *
 * Friction is Coulomb's, with one coefficient for all directions. How stiff contact is, and how
 * stiff surfaces hold until they slide, Lariat says itself: what a deck says of it is named in a
 * notice, what asks for more is refused.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/contact_check.h"
#include "model/format/inp/deck.h"

static int compare_faces(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* A surface's faces, ascending; contact wants them so. */
static lar_status copy_faces(inp_deck *deck, lar_span name, int32_t **face, int32_t *count) {
    const lar_set *set;
    lar_status status = inp_faces(deck, name, &set);
    if (status) return status;
    *face = lar_calloc((size_t)set->count, sizeof **face);
    if (!*face) return inp_no_memory(deck, "the contact");
    memcpy(*face, set->index, (size_t)set->count * sizeof **face);
    *count = set->count;
    qsort(*face, (size_t)*count, sizeof **face, compare_faces);
    return LAR_OK;
}

static bool same_surface(const inp_deck *deck, lar_span a, lar_span b) {
    return inp_mesh_set(deck, a, LAR_SET_FACES) == inp_mesh_set(deck, b, LAR_SET_FACES);
}

static lar_status read_pair(inp_deck *deck, lar_span line, double friction) {
    char problem[LAR_PROBLEM_SIZE];
    lar_span field[2];
    int count;
    lar_status status = inp_fields(deck, line, field, 2, &count);
    if (status) return status;
    if (count == 0) return inp_expected(&deck->reader, deck->reader.line, "two surfaces", line);
    if (!deck->model->surface.face) {
        status = lar_surface_build(deck->mesh, &deck->model->surface, deck->reader.error);
        if (status) return status;
    }
    lar_contact *contact = LAR_MODEL_APPEND(deck->model, contact);
    if (!contact) return inp_no_memory(deck, "the contact");
    contact->kind = LAR_CONTACT_SELF;
    contact->friction = friction;
    status = copy_faces(deck, field[0], &contact->face, &contact->face_count);
    if (!status && count > 1 && field[1].length > 0 && !same_surface(deck, field[0], field[1])) {
        contact->kind = LAR_CONTACT_BETWEEN;
        status = copy_faces(deck, field[1], &contact->against, &contact->against_count);
    }
    if (!status && lar_contact_problem(deck->model, contact, problem))
        status = inp_fail(deck, deck->reader.line, LAR_ERROR_MODEL, "%s", problem);
    return status;
}

lar_status inp_read_contact_pair(inp_deck *deck, const inp_card *card) {
    static const char known[] =
        "INTERACTION,TYPE,SMALL SLIDING,ADJUST,CPSET,MECHANICAL CONSTRAINT,WEIGHT";
    const inp_interaction *interaction = NULL;
    lar_span value, line;
    lar_status status = inp_only(deck, card, known);
    bool named = inp_parameter(card, "INTERACTION", &value);
    if (named) interaction = INP_FIND(deck, interaction, value);
    const double friction = interaction ? interaction->friction : 0;
    if (!status && inp_parameter(card, "SMALL SLIDING", &value))
        status = inp_notice(deck, card->line,
                            "SMALL SLIDING was left out: Lariat's surfaces may slide any way");
    if (!status && inp_parameter(card, "ADJUST", &value))
        status = inp_notice(deck, card->line, "ADJUST was left out: no node is moved at the start");
    int pairs = 0;
    for (; !status && inp_data_line(&deck->reader, &line); pairs++)
        status = read_pair(deck, line, friction);
    if (!status && pairs == 0)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "*CONTACT PAIR names no surfaces; write the two that touch in the line "
                        "below it");
    if (!status && named && !interaction)
        return inp_fail(
            deck, card->line, LAR_ERROR_FORMAT,
            "there is no *SURFACE INTERACTION called '%.*s', which could have friction; "
            "add it, or correct INTERACTION=",
            inp_shown(value), value.at);
    return status;
}

lar_status inp_read_interaction(inp_deck *deck, const inp_card *card) {
    return INP_ADD(deck, card, interaction);
}

lar_status inp_read_surface_behavior(inp_deck *deck, const inp_card *card) {
    static const char known[] = "PRESSURE-OVERCLOSURE,PENALTY,AUGMENTED LAGRANGE,DIRECT";
    lar_span kind;
    lar_status status = inp_only(deck, card, known);
    if (status || !inp_parameter(card, "PRESSURE-OVERCLOSURE", &kind) ||
        lar_span_equal_nocase(kind, "HARD"))
        return status;
    if (lar_span_equal_nocase(kind, "TIED"))
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "surfaces that are TIED are not read; join their nodes in the mesh");
    return inp_notice(deck, card->line,
                      "PRESSURE-OVERCLOSURE=%.*s was left out: Lariat's contact has its own "
                      "stiffness",
                      inp_shown(kind), kind.at);
}

/* One line: the coefficient, and nothing that it would depend on; CalculiX's second number is how
 * stiff surfaces hold. */
static lar_status read_coefficient(inp_deck *deck, double *friction) {
    lar_span line, field[4];
    int count;
    double stick = 0;
    *friction = 0;
    if (!inp_data_line(&deck->reader, &line)) return LAR_OK;
    lar_status status = inp_fields(deck, line, field, 4, &count);
    if (!status) status = inp_optional(deck, field, count, 0, "a coefficient", 0.0, friction);
    if (!status) status = inp_optional(deck, field, count, 1, "a stick slope", 0.0, &stick);
    if (status) return status;
    for (int k = 2; k < count; k++)
        if (field[k].length > 0)
            return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                            "a coefficient of *FRICTION that depends on pressure or temperature is "
                            "not read; give one number");
    const char *wrong = lar_friction_problem(*friction);
    if (wrong)
        return inp_fail(deck, deck->reader.line, LAR_ERROR_MODEL, "*FRICTION is %g; %s", *friction,
                        wrong);
    if (stick != 0)
        status = inp_notice(deck, deck->reader.line,
                            "the second number of *FRICTION, a stick slope, was left out: Lariat's "
                            "surfaces hold by a stiffness of their own");
    if (!status && inp_data_line(&deck->reader, &line))
        status = inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                          "a second line of *FRICTION is not read: a coefficient that depends on "
                          "slip rate, pressure or temperature; give one number");
    return status;
}

lar_status inp_read_friction(inp_deck *deck, const inp_card *card) {
    static const char known[] = "SLIP TOLERANCE";
    double friction;
    lar_span value;
    lar_status status = inp_only(deck, card, known);
    if (!status) status = read_coefficient(deck, &friction);
    if (status) return status;
    if (deck->interaction_count == 0)
        return friction == 0 ? LAR_OK
                             : inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                                        "*FRICTION belongs to no *SURFACE INTERACTION; put it "
                                        "behind the one that a *CONTACT PAIR names");
    inp_interaction *interaction = &deck->interaction[deck->interaction_count - 1];
    if (interaction->friction_line > 0)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "a second *FRICTION of *SURFACE INTERACTION '%.*s', after line %d; remove "
                        "one of them",
                        inp_shown((lar_span){interaction->name, strlen(interaction->name)}),
                        interaction->name, interaction->friction_line);
    interaction->friction = friction;
    interaction->friction_line = card->line;
    if (friction > 0 && inp_parameter(card, "SLIP TOLERANCE", &value))
        return inp_notice(deck, card->line,
                          "SLIP TOLERANCE was left out: Lariat's surfaces hold by a stiffness of "
                          "their own");
    return LAR_OK;
}
