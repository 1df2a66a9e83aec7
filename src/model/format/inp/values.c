/* Abaqus and CalculiX decks: messages, fields, names. See deck.h. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "model/format/inp/deck.h"

/* ---- messages ------------------------------------------------------------------------------ */

lar_status inp_fail(const inp_deck *deck, int line, lar_status status, const char *format, ...) {
    char text[sizeof deck->reader.error->message];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return lar_fail(deck->reader.error, status, "%s:%d: %s", deck->reader.path, line, text);
}

lar_status inp_notice(const inp_deck *deck, int line, const char *format, ...) {
    char text[sizeof deck->reader.error->message];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return lar_model_notice(deck->model, deck->reader.error, "%s:%d: %s", deck->reader.path, line,
                            text);
}

lar_status inp_no_memory(const inp_deck *deck, const char *what) {
    return lar_fail(deck->reader.error, LAR_ERROR_MEMORY,
                    "%s: no memory for %s; close other programs", deck->reader.path, what);
}

int inp_shown(lar_span word) {
    return word.length < 60 ? (int)word.length : 60;
}

/* ---- parameters ---------------------------------------------------------------------------- */

lar_status inp_only(const inp_deck *deck, const inp_card *card, const char *known) {
    return inp_check_parameters(&deck->reader, card, known);
}

lar_status inp_need(const inp_deck *deck, const inp_card *card, const char *name, lar_span *value) {
    if (inp_parameter(card, name, value) && value->length > 0) return LAR_OK;
    return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                    "*%.*s has no %s; add %s=", inp_shown(card->keyword), card->keyword.at, name,
                    name);
}

/* ---- data lines ---------------------------------------------------------------------------- */

lar_status inp_fields(inp_deck *deck, lar_span line, lar_span *field, int max, int *count) {
    lar_span rest = line;
    *count = 0;
    for (bool more = true; more && rest.length > 0;) {
        lar_span one;
        more = lar_span_split(rest, ',', &one, &rest);
        one = lar_span_trim(one);
        if (*count == max) {
            if (one.length == 0) continue;
            return inp_expected(&deck->reader, deck->reader.line, "the end of the line", one);
        }
        field[(*count)++] = one;
    }
    return LAR_OK;
}

lar_status inp_number(inp_deck *deck, const lar_span *field, int count, int at, const char *what,
                      double *value) {
    lar_span nothing = {"", 0}, text = at < count ? field[at] : nothing;
    if (lar_span_double(text, value) && isfinite(*value)) return LAR_OK;
    return inp_expected(&deck->reader, deck->reader.line, what, text);
}

lar_status inp_optional(inp_deck *deck, const lar_span *field, int count, int at, const char *what,
                        double fallback, double *value) {
    *value = fallback;
    if (at >= count || field[at].length == 0) return LAR_OK;
    return inp_number(deck, field, count, at, what, value);
}

/* ---- names --------------------------------------------------------------------------------- */

static const lar_set *find_set(const lar_mesh *mesh, lar_span name, lar_set_kind kind) {
    for (int32_t i = 0; i < mesh->set_count; i++)
        if (mesh->set[i].kind == kind && lar_span_equal_nocase(name, mesh->set[i].name))
            return &mesh->set[i];
    return NULL;
}

static lar_span without_quotes(lar_span name) {
    if (name.length < 2 || name.at[0] != '"' || name.at[name.length - 1] != '"') return name;
    return (lar_span){name.at + 1, name.length - 2};
}

/* Of two sets of one name, that of the part is called by its instance in the mesh. */
const lar_set *inp_mesh_set(const inp_deck *deck, lar_span name, lar_set_kind kind) {
    enum { LONGEST = 2100 }; /* longer than two names */
    char full[LONGEST];
    name = without_quotes(name);
    const lar_span bare = inp_without_instance(name);
    const char *instance = deck->reader.instance ? deck->reader.instance : "";
    int length = snprintf(full, sizeof full, "%s.%.*s", instance,
                          (int)(bare.length < LONGEST ? bare.length : LONGEST), bare.at);
    const lar_set *of_part = NULL, *set = NULL;
    if (length < LONGEST) of_part = find_set(deck->mesh, (lar_span){full, (size_t)length}, kind);
    if (of_part && (deck->reader.in_part || bare.length < name.length)) return of_part;
    set = find_set(deck->mesh, name, kind);
    if (!set) set = find_set(deck->mesh, bare, kind);
    return set ? set : of_part;
}

static lar_status spend(inp_deck *deck, size_t count) {
    if (count <= deck->reader.entries_left) {
        deck->reader.entries_left -= count;
        return LAR_OK;
    }
    return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                    "the conditions name the same nodes or elements more often than such a deck "
                    "can mean; remove those that are not used");
}

static lar_status refuse_empty(const inp_deck *deck, lar_span name) {
    return inp_fail(deck, deck->reader.line, LAR_ERROR_FORMAT,
                    "the set '%.*s' has nothing of the hexahedra; fill it or remove the line",
                    inp_shown(name), name.at);
}

static lar_status find_many(inp_deck *deck, lar_span field, bool of_nodes, int32_t *own,
                            const int32_t **index, int32_t *count) {
    const char *what = of_nodes ? "node" : "element";
    int64_t id;
    const bool bare = lar_span_int64(field, &id);
    if (bare || lar_span_int64(inp_without_instance(field), &id)) {
        bool apart = of_nodes && bare && inp_is_apart(&deck->reader, id);
        *own = apart ? -1 : lar_id_map_find(of_nodes ? &deck->nodes : &deck->elements, id);
        *index = own;
        *count = 1;
        if (*own >= 0) return LAR_OK;
        return inp_fail(deck, deck->reader.line, LAR_ERROR_FORMAT,
                        "there is no %s %lld that %s; correct the number", what, (long long)id,
                        of_nodes ? "belongs to a hexahedron" : "is a hexahedron");
    }
    const lar_set *set = inp_mesh_set(deck, field, of_nodes ? LAR_SET_NODES : LAR_SET_ELEMENTS);
    if (!set)
        return inp_fail(deck, deck->reader.line, LAR_ERROR_FORMAT,
                        "'%.*s' is neither a number nor a set of %ss of the hexahedra; define it "
                        "or correct the name",
                        inp_shown(field), field.at, what);
    if (set->count == 0) return refuse_empty(deck, field);
    *index = set->index;
    *count = set->count;
    return spend(deck, (size_t)set->count);
}

lar_status inp_nodes(inp_deck *deck, lar_span field, int32_t *own, const int32_t **index,
                     int32_t *count) {
    return find_many(deck, field, true, own, index, count);
}

lar_status inp_elements(inp_deck *deck, lar_span field, int32_t *own, const int32_t **index,
                        int32_t *count) {
    return find_many(deck, field, false, own, index, count);
}

lar_status inp_faces(inp_deck *deck, lar_span field, const lar_set **set) {
    *set = inp_mesh_set(deck, field, LAR_SET_FACES);
    if (*set && (*set)->count == 0) return refuse_empty(deck, field);
    if (*set) return spend(deck, (size_t)(*set)->count);
    bool nodes = inp_mesh_set(deck, field, LAR_SET_NODES) != NULL;
    return inp_fail(deck, deck->reader.line, nodes ? LAR_ERROR_UNSUPPORTED : LAR_ERROR_FORMAT,
                    nodes ? "the surface '%.*s' is one of nodes; define it by faces of elements "
                            "(*SURFACE, TYPE=ELEMENT)"
                          : "there is no surface '%.*s' of faces; define it (*SURFACE) or correct "
                            "the name",
                    inp_shown(field), field.at);
}

/* ---- lists of names ------------------------------------------------------------------------ */

void *inp_find(const void *entry, size_t count, size_t size, lar_span name) {
    const char *at = entry;
    for (; count > 0; count--, at += size) {
        char *own;
        memcpy(&own, at, sizeof own);
        if (lar_span_equal_nocase(name, own)) return (void *)(uintptr_t)at;
    }
    return NULL;
}

lar_status inp_add(inp_deck *deck, const inp_card *card, void *list, size_t *room, size_t *count,
                   size_t size) {
    enum { MAX = 10000 }; /* they are looked up by walking the list */
    lar_span name, what = card->keyword;
    char *entry;
    lar_status status = inp_need(deck, card, "NAME", &name);
    if (status) return status;
    memcpy(&entry, list, sizeof entry);
    if (inp_find(entry, *count, size, name))
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "a second *%.*s is called '%.*s'; rename one of them", inp_shown(what),
                        what.at, inp_shown(name), name.at);
    if (*count >= MAX)
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "more than %d *%.*s; remove those that nothing uses", MAX, inp_shown(what),
                        what.at);
    char *copy = lar_strndup(name.at, name.length);
    if (!copy || !lar_grow_array(list, room, *count, size)) {
        free(copy);
        return inp_no_memory(deck, "the names");
    }
    memcpy(&entry, list, sizeof entry);
    entry += size * (*count)++;
    memset(entry, 0, size);
    memcpy(entry, &copy, sizeof copy);
    return LAR_OK;
}

/* ---- curves -------------------------------------------------------------------------------- */

static lar_status add_curve(inp_deck *deck, const lar_curve *like, int *curve) {
    int index = deck->model->curve_count;
    lar_curve *made = LAR_MODEL_APPEND(deck->model, curve);
    if (!made) return inp_no_memory(deck, "a curve");
    *made = *like;
    *curve = index;
    return LAR_OK;
}

/* 1 from the start, or from 0 to 1 over the step. */
static lar_status step_curve(inp_deck *deck, bool ramps, int *curve) {
    int *known = ramps ? &deck->ramp : &deck->constant;
    lar_curve made = {.kind = LAR_CURVE_RAMP};
    lar_status status = LAR_OK;
    if (*known < 0 && ramps) {
        made = (lar_curve){.kind = LAR_CURVE_TABLE, .shape = LAR_CURVE_LINEAR, .count = 2};
        made.point = lar_calloc(2, sizeof *made.point);
        if (!made.point) return inp_no_memory(deck, "a curve");
        made.point[1][0] = deck->step.period;
        made.point[1][1] = 1.0;
    }
    if (*known < 0) status = add_curve(deck, &made, known);
    if (status) free(made.point);
    *curve = *known;
    return status;
}

lar_status inp_curve_of(inp_deck *deck, const inp_card *card, bool ramps, int *curve) {
    lar_span name;
    if (deck->step.amplitude) ramps = deck->step.amplitude == 2;
    if (!inp_parameter(card, "AMPLITUDE", &name)) return step_curve(deck, ramps, curve);
    const inp_amplitude *amplitude = INP_FIND(deck, amplitude, name);
    if (amplitude) {
        *curve = amplitude->curve;
        return LAR_OK;
    }
    return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                    "there is no *AMPLITUDE called '%.*s'; define it or correct the name",
                    inp_shown(name), name.at);
}

lar_status inp_in_step(const inp_deck *deck, const inp_card *card) {
    if (deck->step.open) return LAR_OK;
    return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                    "*%.*s stands outside of a step; move it between *STEP and *END STEP",
                    inp_shown(card->keyword), card->keyword.at);
}
