/* Abaqus and CalculiX decks: keywords, the step, entry points. See deck.h. */
#include "model/format/inp/deck.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/format/mesh_io.h"
#include "model/rest.h"

/* ---- the step ------------------------------------------------------------------------------ */

static lar_status read_heading(inp_deck *deck, const inp_card *card) {
    lar_span line;
    (void)card;
    if (deck->model->title || !inp_data_line(&deck->reader, &line)) return LAR_OK;
    deck->model->title = lar_strndup(line.at, line.length);
    return deck->model->title ? LAR_OK : inp_no_memory(deck, "the title");
}

static lar_status check_step(const inp_deck *deck, const inp_card *card) {
    static const char known[] =
        "NLGEOM,INC,INCF,NAME,AMPLITUDE,UNSYMM,SOLVER,DIRECT,EXTRAPOLATION,CONVERT SDI,EXTRAPOLATE";
    lar_span value;
    if (deck->step.open)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "a *STEP within the step of line %d; end that one with *END STEP",
                        deck->step.line);
    if (deck->step.line > 0)
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "a second *STEP; Lariat does not change conditions between steps, keep "
                        "one");
    if (inp_parameter(card, "PERTURBATION", &value))
        return inp_fail(
            deck, card->line, LAR_ERROR_UNSUPPORTED,
            "a *STEP with PERTURBATION is not read; Lariat does *STATIC, *VISCO and *DYNAMIC");
    return inp_only(deck, card, known);
}

static lar_status read_step(inp_deck *deck, const inp_card *card) {
    lar_span value;
    lar_status status = check_step(deck, card);
    if (status) return status;
    deck->step = (inp_step){.line = card->line, .open = true, .period = 1.0};
    deck->step.large = inp_parameter(card, "NLGEOM", &value) && !lar_span_equal_nocase(value, "NO");
    if (!inp_parameter(card, "AMPLITUDE", &value)) return LAR_OK;
    deck->step.amplitude = lar_span_equal_nocase(value, "STEP")   ? 1
                           : lar_span_equal_nocase(value, "RAMP") ? 2
                                                                  : 0;
    if (deck->step.amplitude) return LAR_OK;
    return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                    "AMPLITUDE=%.*s of *STEP is neither STEP nor RAMP", inp_shown(value), value.at);
}

static lar_status end_step(inp_deck *deck, const inp_card *card) {
    if (!deck->step.open)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT, "*END STEP without a *STEP above it");
    deck->step.open = false;
    return LAR_OK;
}

/* First increment, period: on one line, which may be left out. */
static lar_status read_procedure(inp_deck *deck, const inp_card *card, inp_procedure procedure) {
    static const char known[] =
        "LONG TERM,SOLVER,DIRECT,STABILIZE,ALLSDTOL,FACTOR,CONTINUE,EXPLICIT,ALPHA,"
        "TIMERESET,TOTALTIMEAT,HAFTOL,NOHAF,INITIAL,CETOL,CREEP";
    const size_t others = procedure == INP_STATIC ? 0 : strlen("LONG TERM,");
    lar_span line, field[8], ignored;
    int count = 0;
    lar_status status = inp_only(deck, card, known + others);
    if (!status) status = inp_in_step(deck, card);
    if (status) return status;
    if (deck->step.procedure != INP_NO_PROCEDURE)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "a second procedure in the step of line %d; keep one", deck->step.line);
    deck->step.procedure = procedure;
    deck->step.long_term = inp_parameter(card, "LONG TERM", &ignored);
    deck->step.explicit = inp_parameter(card, "EXPLICIT", &ignored);
    if (inp_parameter(card, "STABILIZE", &ignored))
        status = inp_notice(deck, card->line, "STABILIZE, a damping, was left out");
    if (!status && inp_data_line(&deck->reader, &line))
        status = inp_fields(deck, line, field, 8, &count);
    if (!status)
        status = inp_optional(deck, field, count, 1, "the period of the step, a number in seconds",
                              1.0, &deck->step.period);
    if (status || deck->step.period > 0.0) return status;
    return inp_fail(deck, deck->reader.line, LAR_ERROR_MODEL,
                    "the step's period is %g; make it positive", deck->step.period);
}

static lar_status read_static(inp_deck *deck, const inp_card *card) {
    return read_procedure(deck, card, INP_STATIC);
}

static lar_status read_visco(inp_deck *deck, const inp_card *card) {
    return read_procedure(deck, card, INP_VISCO);
}

static lar_status read_dynamic(inp_deck *deck, const inp_card *card) {
    return read_procedure(deck, card, INP_DYNAMIC);
}

/* In the second walk the step is known; only whether a line stands in it matters. */
static lar_status enter_step(inp_deck *deck, const inp_card *card) {
    (void)card;
    deck->step.open = true;
    return LAR_OK;
}

static lar_status leave_step(inp_deck *deck, const inp_card *card) {
    (void)card;
    deck->step.open = false;
    return LAR_OK;
}

/* A run that goes on from the results of another one begins elsewhere. */
static lar_status read_restart(inp_deck *deck, const inp_card *card) {
    lar_span value;
    if (!inp_parameter(card, "READ", &value)) return LAR_OK;
    return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                    "*RESTART, READ goes on from the results of another run, which are not read; "
                    "remove it");
}

/* Letters behind C3D8 that only say how it computes displacements. */
static lar_status check_element(inp_deck *deck, const inp_card *card) {
    static const char hexahedron[] = "C3D8", how[] = "RHISrhis";
    lar_span type;
    if (!inp_parameter(card, "TYPE", &type)) return LAR_OK;
    const size_t length = strlen(hexahedron);
    if (type.length <= length || strncasecmp(type.at, hexahedron, length) != 0) return LAR_OK;
    for (size_t c = length; c < type.length; c++)
        if (!memchr(how, type.at[c], strlen(how)))
            return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                            "elements of type '%.*s' compute more than displacements, which "
                            "Lariat does not; take only the mesh into a scene (mesh: FILE)",
                            inp_shown(type), type.at);
    return LAR_OK;
}

/* ---- keywords ------------------------------------------------------------------------------ */

typedef lar_status card_reader(inp_deck *deck, const inp_card *card);

typedef struct keyword_row {
    const char *keyword;
    card_reader *first, *second; /* in the walks; NULL: passed over */
    enum {
        OF_DECK,     /* says something about the model */
        OF_MATERIAL, /* the same, and belongs to the *MATERIAL above it */
        OF_MESH,     /* lar_inp_parse reads it */
        HARMLESS,    /* structure, solver */
        RESULTS,     /* asks for results; a notice says how to get some */
        LEFT_OUT     /* changes little; a notice names it */
    } kind;
} keyword_row;

static const keyword_row keywords[] = {
    {"HEADING", read_heading, NULL, HARMLESS},
    {"MATERIAL", inp_read_material, NULL, OF_MATERIAL},
    {"ELASTIC", inp_read_elastic, NULL, OF_MATERIAL},
    {"HYPERELASTIC", inp_read_hyperelastic, NULL, OF_MATERIAL},
    {"ANISOTROPIC HYPERELASTIC", inp_read_anisotropic, NULL, OF_MATERIAL},
    {"DENSITY", inp_read_density, NULL, OF_MATERIAL},
    {"DAMPING", inp_read_damping, NULL, OF_MATERIAL},
    {"VISCOELASTIC", inp_read_viscoelastic, NULL, OF_MATERIAL},
    {"AMPLITUDE", inp_read_amplitude, NULL, OF_DECK},
    {"ORIENTATION", inp_read_orientation, NULL, OF_DECK},
    {"STEP", read_step, enter_step, OF_DECK},
    {"STATIC", read_static, NULL, OF_DECK},
    {"VISCO", read_visco, NULL, OF_DECK},
    {"DYNAMIC", read_dynamic, NULL, OF_DECK},
    {"END STEP", end_step, leave_step, OF_DECK},
    {"SOLID SECTION", NULL, inp_read_section, HARMLESS}, /* lar_inp_is_deck says why */
    {"BOUNDARY", NULL, inp_read_boundary, OF_DECK},
    {"INITIAL CONDITIONS", NULL, inp_read_initial, OF_DECK},
    {"CLOAD", NULL, inp_read_cload, OF_DECK},
    {"DLOAD", NULL, inp_read_dload, OF_DECK},
    {"DSLOAD", NULL, inp_read_dsload, OF_DECK},
    {"CONTACT PAIR", NULL, inp_read_contact_pair, OF_DECK},
    {"SURFACE INTERACTION", inp_read_interaction, NULL, OF_DECK},
    {"SURFACE BEHAVIOR", inp_read_surface_behavior, NULL, OF_DECK},
    {"FRICTION", inp_read_friction, NULL, OF_DECK},
    {"NODE", NULL, NULL, OF_MESH},
    {"ELEMENT", check_element, NULL, OF_MESH},
    {"NSET", NULL, NULL, OF_MESH},
    {"ELSET", NULL, NULL, OF_MESH},
    {"SURFACE", NULL, NULL, OF_MESH},
    {"PART", NULL, NULL, OF_MESH},
    {"END PART", NULL, NULL, OF_MESH},
    {"ASSEMBLY", NULL, NULL, OF_MESH},
    {"END ASSEMBLY", NULL, NULL, OF_MESH},
    {"INSTANCE", NULL, NULL, OF_MESH},
    {"END INSTANCE", NULL, NULL, OF_MESH},
    {"PREPRINT", NULL, NULL, HARMLESS},
    {"RESTART", read_restart, NULL, HARMLESS},
    {"OUTPUT", NULL, NULL, RESULTS},
    {"NODE OUTPUT", NULL, NULL, HARMLESS},
    {"ELEMENT OUTPUT", NULL, NULL, HARMLESS},
    {"CONTACT OUTPUT", NULL, NULL, HARMLESS},
    {"ENERGY OUTPUT", NULL, NULL, HARMLESS},
    {"NODE PRINT", NULL, inp_read_node_print, RESULTS},
    {"NODE FILE", NULL, NULL, RESULTS},
    {"EL PRINT", NULL, NULL, RESULTS},
    {"EL FILE", NULL, NULL, RESULTS},
    {"CONTACT PRINT", NULL, NULL, RESULTS},
    {"CONTACT FILE", NULL, NULL, RESULTS},
    {"ENERGY PRINT", NULL, NULL, RESULTS},
    {"ENERGY FILE", NULL, NULL, RESULTS},
    {"SECTION PRINT", NULL, NULL, RESULTS},
    {"FILE FORMAT", NULL, NULL, HARMLESS},
    {"FILE OUTPUT", NULL, NULL, HARMLESS},
    {"MONITOR", NULL, NULL, HARMLESS},
    {"PRINT", NULL, NULL, HARMLESS},
    {"TIME POINTS", NULL, NULL, HARMLESS},
    {"CONTROLS", NULL, NULL, HARMLESS},
    {"PHYSICAL CONSTANTS", NULL, NULL, HARMLESS},
    {"EXPANSION", NULL, NULL, OF_MATERIAL}, /* temperatures are refused */
    {"CONDUCTIVITY", NULL, NULL, OF_MATERIAL},
    {"SPECIFIC HEAT", NULL, NULL, OF_MATERIAL},
    {"SECTION CONTROLS", NULL, NULL, LEFT_OUT},
    {"HOURGLASS STIFFNESS", NULL, NULL, LEFT_OUT},
    {"BULK VISCOSITY", NULL, NULL, LEFT_OUT},
    {"CONTACT CONTROLS", NULL, NULL, LEFT_OUT},
    {"CONTACT DAMPING", NULL, NULL, LEFT_OUT},
};

/* Words of keywords may stand apart by more than one blank. */
static bool same_keyword(lar_span keyword, const char *word) {
    size_t at = 0;
    for (; *word; word++) {
        if (at == keyword.length) return false;
        bool blank = keyword.at[at] == ' ' || keyword.at[at] == '\t';
        if ((*word == ' ') != blank) return false;
        char letter = keyword.at[at];
        if (letter >= 'a' && letter <= 'z') letter = (char)(letter - 32);
        if (!blank && letter != *word) return false;
        at++;
        while (blank && at < keyword.length && (keyword.at[at] == ' ' || keyword.at[at] == '\t'))
            at++;
    }
    return at == keyword.length;
}

static const keyword_row *find_keyword(lar_span keyword) {
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
        if (same_keyword(keyword, keywords[i].keyword)) return &keywords[i];
    return NULL;
}

static lar_status refuse_keyword(const inp_deck *deck, const inp_card *card) {
    return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                    "*%.*s is not read and would change the answer; remove it, or take only the "
                    "mesh into a scene (mesh: FILE)",
                    inp_shown(card->keyword), card->keyword.at);
}

static lar_status read_card(inp_deck *deck, const inp_card *card, bool second) {
    const keyword_row *row = find_keyword(card->keyword);
    if (!row) return refuse_keyword(deck, card);
    if (row->kind != OF_MATERIAL) deck->current = -1;
    if (row->kind == LEFT_OUT && !second)
        return inp_notice(deck, card->line, "*%.*s was left out", inp_shown(card->keyword),
                          card->keyword.at);
    if (row->kind == RESULTS && !second) return inp_notice_results(deck, card);
    card_reader *read = second ? row->second : row->first;
    return read ? read(deck, card) : LAR_OK;
}

static lar_status walk(inp_deck *deck, const lar_bytes *bytes, bool second) {
    inp_card card;
    lar_span line;
    lar_status status = LAR_OK;
    deck->reader.text = inp_begin(&deck->reader, bytes);
    deck->current = -1;
    while (!status && inp_next_card(&deck->reader, &card, &status)) {
        deck->reader.line = card.line;
        status = read_card(deck, &card, second);
        while (!status && inp_data_line(&deck->reader, &line)) continue;
    }
    return status;
}

/* ---- the whole ----------------------------------------------------------------------------- */

/* What an analysis without time becomes: see model/rest.h. */
static lar_status finish_step(inp_deck *deck) {
    lar_model *model = deck->model;
    const inp_step *step = &deck->step;
    if (step->line == 0) return LAR_OK;
    model->duration = step->period;
    lar_status status = LAR_OK;
    if (step->procedure != INP_DYNAMIC) {
        lar_rest_words words = lar_model_follow_static(model, "step");
        status = inp_notice(deck, step->line, "%s", words.text);
    }
    if (status || step->large) return status;
    return inp_notice(deck, step->line,
                      "the step has no NLGEOM: Lariat computes large deformation all the same, "
                      "which is equal where it is small");
}

static lar_status check_first_walk(const inp_deck *deck) {
    if (deck->step.open)
        return inp_fail(deck, deck->step.line, LAR_ERROR_FORMAT, "*STEP has no *END STEP; add it");
    if (deck->step.line > 0 && deck->step.procedure == INP_NO_PROCEDURE)
        return inp_fail(deck, deck->step.line, LAR_ERROR_FORMAT,
                        "the step has no procedure; add *STATIC, *VISCO or *DYNAMIC");
    return LAR_OK;
}

static lar_status prepare(inp_deck *deck) {
    const lar_mesh *mesh = deck->mesh;
    size_t nodes = (size_t)mesh->node_count, elements = (size_t)mesh->element_count;
    lar_id_clash clash;
    deck->model->element_material = lar_calloc(elements, sizeof(int32_t));
    deck->hold = lar_calloc(3 * nodes, sizeof *deck->hold);
    if (!deck->model->element_material || !deck->hold ||
        !lar_id_map_build(&deck->nodes, mesh->node_id, mesh->node_count, sizeof(int64_t), &clash) ||
        !lar_id_map_build(&deck->elements, mesh->element_id, mesh->element_count, sizeof(int64_t),
                          &clash))
        return inp_no_memory(deck, "the model");
    for (size_t e = 0; e < elements; e++) deck->model->element_material[e] = -1;
    return LAR_OK;
}

static lar_status read_model(inp_deck *deck, const lar_bytes *bytes) {
    enum { SPARE_ENTRIES = 1000000 };
    lar_error *error = deck->reader.error;
    lar_status status = inp_read_mesh(&deck->reader, bytes, deck->mesh);
    deck->reader.entries_left = 4 * bytes->size + SPARE_ENTRIES;
    if (!status) lar_mesh_turn(deck->mesh);
    if (!status) status = lar_mesh_check(deck->mesh, error);
    if (!status) status = prepare(deck);
    if (!status) status = walk(deck, bytes, false);
    if (!status) status = check_first_walk(deck);
    if (!status) status = walk(deck, bytes, true);
    if (!status) status = inp_finish_materials(deck);
    if (!status) status = inp_finish_supports(deck);
    if (!status) status = inp_finish_loads(deck);
    if (!status) status = finish_step(deck);
    return status ? status : lar_model_check(deck->model, error);
}

static void clear(inp_deck *deck) {
    for (size_t i = 0; i < deck->material_count; i++) free(deck->material[i].name);
    for (size_t i = 0; i < deck->amplitude_count; i++) free(deck->amplitude[i].name);
    for (size_t i = 0; i < deck->forces_count; i++) free(deck->forces[i].force);
    for (size_t i = 0; i < deck->orientation_count; i++) free(deck->orientation[i].name);
    for (size_t i = 0; i < deck->interaction_count; i++) free(deck->interaction[i].name);
    inp_clear(&deck->reader);
    free(deck->interaction);
    free(deck->material);
    free(deck->orientation);
    free(deck->amplitude);
    free(deck->forces);
    free(deck->prescribed);
    free(deck->pressure);
    free(deck->velocity);
    free(deck->pressed);
    free(deck->heavy);
    free(deck->hold);
    lar_id_map_clear(&deck->nodes);
    lar_id_map_clear(&deck->elements);
}

lar_status lar_inp_deck_parse(const char *path, const lar_bytes *bytes, lar_model **model,
                              lar_error *error) {
    lar_error unused; /* the parts may rely on an error to write to */
    lar_model *fresh = lar_model_create();
    if (!fresh) return lar_fail_memory(error, sizeof *fresh, path);
    inp_deck deck = {.reader = {.path = path, .error = error ? error : &unused},
                     .model = fresh,
                     .mesh = &fresh->mesh,
                     .constant = -1,
                     .ramp = -1};
    fresh->source = lar_strdup(path);
    fresh->own_units = true;
    lar_status status =
        fresh->source ? read_model(&deck, bytes) : inp_no_memory(&deck, "the model");
    clear(&deck);
    if (status)
        lar_model_destroy(fresh);
    else
        *model = fresh;
    return status;
}

bool lar_inp_is_deck(const lar_bytes *bytes) {
    lar_text text = lar_text_from(bytes);
    for (lar_span line, keyword, rest; lar_text_line(&text, &line);) {
        line = lar_span_trim(line);
        if (line.length < 2 || line.at[0] != '*' || line.at[1] == '*') continue;
        lar_span_split((lar_span){line.at + 1, line.length - 1}, ',', &keyword, &rest);
        const keyword_row *row = find_keyword(lar_span_trim(keyword));
        if (row && (row->kind == OF_DECK || row->kind == OF_MATERIAL)) return true;
    }
    return false;
}
