/* Abaqus and CalculiX decks: contact pairs. See deck.h.
 *
 * Lariat's contact has a stiffness of its own and no friction: what a deck says about the first is
 * named in a notice, what asks for more is refused.
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

static lar_status read_pair(inp_deck *deck, lar_span line) {
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
    static const char *const known[] = {"INTERACTION", "TYPE",  "SMALL SLIDING",
                                        "ADJUST",      "CPSET", "MECHANICAL CONSTRAINT",
                                        "WEIGHT",      NULL};
    lar_span value, line;
    lar_status status = inp_only(deck, card, known);
    if (!status && inp_parameter(card, "SMALL SLIDING", &value))
        status = inp_notice(deck, card->line,
                            "SMALL SLIDING was left out: Lariat's surfaces may slide any way");
    if (!status && inp_parameter(card, "ADJUST", &value))
        status = inp_notice(deck, card->line, "ADJUST was left out: no node is moved at the start");
    while (!status && inp_data_line(&deck->reader, &line)) status = read_pair(deck, line);
    return status;
}

lar_status inp_read_surface_behavior(inp_deck *deck, const inp_card *card) {
    static const char *const known[] = {"PRESSURE-OVERCLOSURE", "PENALTY", "AUGMENTED LAGRANGE",
                                        "DIRECT", NULL};
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

lar_status inp_read_friction(inp_deck *deck, const inp_card *card) {
    lar_span line, field[4];
    int count;
    double friction = 0.0;
    lar_status status = LAR_OK;
    if (inp_data_line(&deck->reader, &line)) {
        status = inp_fields(deck, line, field, 4, &count);
        if (!status) status = inp_optional(deck, field, count, 0, "a coefficient", 0.0, &friction);
    }
    if (status || (friction == 0.0 && card->parameters.length == 0)) return status;
    return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                    "*FRICTION is not read from decks and would change the answer; set the "
                    "coefficient to 0 or remove it");
}
