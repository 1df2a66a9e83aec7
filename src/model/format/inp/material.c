/* Abaqus and CalculiX decks: materials and sections. See deck.h.
 *
 *   *ELASTIC E, nu     neo-Hookean with the same G and K: equal at small strain
 *   *HYPERELASTIC      which of them are read, by which constants, and what becomes of them stands
 * in the rows of the laws (law/law.h). Of a law's terms only those count that are not zero:
 * Mooney-Rivlin without C01 is exactly neo-Hookean.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/format/inp/deck.h"
#include "model/rest.h"

lar_status inp_read_material(inp_deck *deck, const inp_card *card) {
    static const char known[] = "NAME,RTOL,DEPENDENCIES";
    lar_status status = inp_only(deck, card, known);
    if (!status) status = INP_ADD(deck, card, material);
    if (status) return status;
    deck->current = (int64_t)deck->material_count - 1;
    deck->material[deck->current].line = card->line;
    deck->material[deck->current].index = -1;
    return LAR_OK;
}

/* The material that an option belongs to, and its one line of numbers, or two where there are more
 * than eight. More lines are values at other temperatures. */
lar_status inp_read_option(inp_deck *deck, const inp_card *card, lar_span *field, int max,
                           int *count, inp_material **material) {
    enum { LINE = 8 };
    lar_span line;
    int more;
    if (deck->current < 0)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "*%.*s stands outside of a material; put it behind its *MATERIAL",
                        inp_shown(card->keyword), card->keyword.at);
    *material = &deck->material[deck->current];
    if (!inp_data_line(&deck->reader, &line))
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT, "*%.*s has no line of numbers; add it",
                        inp_shown(card->keyword), card->keyword.at);
    lar_status status = inp_fields(deck, line, field, max, count);
    if (!status && *count == LINE && max > LINE + 1 && inp_data_line(&deck->reader, &line)) {
        status = inp_fields(deck, line, field + LINE, max - LINE, &more);
        *count += more;
    }
    if (!status && inp_data_line(&deck->reader, &line))
        return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                        "*%.*s depends on temperature or other fields, which Lariat does not have; "
                        "keep one line",
                        inp_shown(card->keyword), card->keyword.at);
    return status;
}

static lar_status refuse_second(const inp_deck *deck, const inp_card *card,
                                const inp_material *material, const char *what) {
    return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                    "the material '%.60s' has a second %s; keep one of the two", material->name,
                    what);
}

lar_status inp_take_law(inp_deck *deck, const inp_card *card, inp_material *material, lar_law law) {
    if (material->has_law) return refuse_second(deck, card, material, "law");
    material->has_law = true;
    material->line = card->line;
    material->value.law = law;
    return LAR_OK;
}

/* The law as a whole: moduli that are positive. The density is not known yet. */
lar_status inp_check_law(const inp_deck *deck, const inp_material *material) {
    char where[300];
    lar_material tried = material->value;
    tried.density = 1.0;
    tried.viscosity.terms = 0; /* looked at when both are known */
    snprintf(where, sizeof where, "%.200s:%d", deck->reader.path, material->line);
    return lar_material_check(&tried, where, deck->reader.error);
}

lar_status inp_read_elastic(inp_deck *deck, const inp_card *card) {
    static const char known[] = "TYPE,MODULI";
    lar_span type, field[3];
    int count;
    inp_material *material;
    double young, poisson;
    lar_status status = inp_only(deck, card, known);
    if (status) return status;
    if (inp_parameter(card, "TYPE", &type) && !lar_span_equal_nocase(type, "ISO") &&
        !lar_span_equal_nocase(type, "ISOTROPIC"))
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "*ELASTIC of type '%.*s' is not read; Lariat's tissue is isotropic "
                        "(TYPE=ISO)",
                        inp_shown(type), type.at);
    status = inp_read_option(deck, card, field, 3, &count, &material);
    if (!status) status = inp_number(deck, field, count, 0, "Young's modulus", &young);
    if (!status) status = inp_number(deck, field, count, 1, "Poisson's ratio", &poisson);
    if (!status) status = inp_take_law(deck, card, material, LAR_LAW_neo_hookean);
    if (!status) status = inp_read_moduli(deck, card, material);
    if (status) return status;
    if (!(poisson > -1.0 && poisson < 0.5))
        return inp_fail(deck, deck->reader.line, LAR_ERROR_MODEL,
                        "Poisson's ratio %g is not between -1 and 0.5; correct it", poisson);
    material->linear = true;
    lar_material_from_young(&material->value, young, poisson);
    return inp_check_law(deck, material);
}

/* What a constant may be. */
static lar_status check_constant(const inp_deck *deck, const inp_card *card, const lar_law_row *law,
                                 const lar_law_parameter *of, double given) {
    if (of->value == LAR_VALUE_SOFTNESS && !(given > 0.0))
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "%s is %g, which asks for a material that cannot change its volume; "
                        "give it %s = 2 / K, with a bulk modulus K of some hundred times the shear "
                        "modulus",
                        of->name, given, of->name);
    if (of->value == LAR_VALUE_NOT_OURS && given != 0.0)
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "%s is %g; Lariat's %s law does not have that term, give it 0 or leave "
                        "it out",
                        of->name, given, law->title);
    if (of->value == LAR_VALUE_NUMBER && !(given > 0.0))
        return inp_fail(deck, card->line, LAR_ERROR_MODEL, "%s is %g; it must be more than zero",
                        of->name, given);
    return LAR_OK;
}

/* The constants of a law, in the order of its deck. */
static lar_status read_constants(inp_deck *deck, const inp_card *card, const lar_law_row *law,
                                 const lar_span *field, int fields, double *given) {
    const lar_law_dialect *dialect = law->abaqus;
    for (int i = 0; i < dialect->count; i++) {
        const lar_law_parameter *of = &dialect->parameter[i];
        bool needed = of->value == LAR_VALUE_CONSTANT || of->value == LAR_VALUE_NUMBER;
        lar_status status = needed ? inp_number(deck, field, fields, i, of->name, &given[i])
                                   : inp_optional(deck, field, fields, i, of->name, 0.0, &given[i]);
        if (status) return status;
    }
    lar_status status = LAR_OK;
    for (int i = 0; i < dialect->count && !status; i++)
        status = check_constant(deck, card, law, &dialect->parameter[i], given[i]);
    return status;
}

static int find_constant(const lar_law_dialect *dialect, const char *name) {
    for (int i = 0; i < dialect->count; i++)
        if (strcmp(dialect->parameter[i].name, name) == 0) return i;
    return -1;
}

/* Whether a law has every constant of another one that is not zero; then *own are they. */
static bool has_constants(const lar_law_dialect *dialect, const lar_law_dialect *asked,
                          const double *given, double *own) {
    memset(own, 0, LAR_LAW_GIVEN * sizeof *own);
    for (int i = 0; i < asked->count; i++) {
        int at = find_constant(dialect, asked->parameter[i].name);
        if (at < 0 && given[i] != 0.0) return false;
        if (at >= 0) own[at] = given[i];
    }
    return dialect->count > 0;
}

/* What a card asks for: LAR_LAW_COUNT, none of ours; as a series of so many terms, 0 where it is
 * none. */
typedef struct asked_law {
    lar_law law;
    int terms;
} asked_law;

/* Whether a card has no other parameter than these. */
static bool has_only(const inp_deck *deck, const inp_card *card, const char *known) {
    lar_error unused;
    inp_reader quiet = deck->reader;
    quiet.error = &unused;
    return inp_check_parameters(&quiet, card, known) == LAR_OK;
}

/* Without a kind it is a polynomial. */
static asked_law find_asked(const inp_deck *deck, const inp_card *card) {
    lar_span ignored;
    for (int law = LAR_LAW_COUNT - 1; law >= 0; law--) {
        const lar_law_dialect *dialect = lar_law_table[law].abaqus;
        if (dialect->series && inp_parameter(card, dialect->series, &ignored))
            return (asked_law){(lar_law)law, 1}; /* without N */
        if (dialect->name && inp_parameter(card, dialect->name, &ignored))
            return (asked_law){(lar_law)law, 0};
    }
    if (has_only(deck, card, "MODULI,N")) return (asked_law){LAR_LAW_mooney_rivlin, 1};
    return (asked_law){LAR_LAW_COUNT, 0};
}

/* What Abaqus calls our laws; ends with NULL. */
enum { NAMES_MAX = 2 * LAR_LAW_COUNT };
static int list_laws(const char *name[NAMES_MAX + 1]) {
    int count = 0;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        const lar_law_dialect *dialect = lar_law_table[law].abaqus;
        if (dialect->name) name[count++] = dialect->name;
        if (dialect->series && strcmp(dialect->series, dialect->name) != 0)
            name[count++] = dialect->series;
    }
    name[count] = NULL;
    return count;
}

static lar_status refuse_law(inp_deck *deck, const inp_card *card) {
    const char *name[NAMES_MAX + 1];
    char list[300];
    lar_text_list(name, list_laws(name), list, sizeof list);
    return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                    "this kind of *HYPERELASTIC is not read; Lariat has %s, with constants", list);
}

static int terms_max(const lar_law_dialect *dialect) {
    return dialect->count / (dialect->per_term + 1);
}

/* The terms of a series, N of its card. */
static lar_status read_terms(inp_deck *deck, const inp_card *card, asked_law *asked) {
    lar_span text;
    int64_t count;
    const lar_law_row *law = &lar_law_table[asked->law];
    if (!inp_parameter(card, "N", &text)) return LAR_OK;
    if (!lar_span_int64(text, &count) || count < 1)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "N=%.*s of *HYPERELASTIC is no number of terms; give 1, 2 or 3",
                        inp_shown(text), text.at);
    if (count > terms_max(law->abaqus))
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "N=%lld of *HYPERELASTIC; Lariat's %s law has %d term%s at most",
                        (long long)count, law->title, terms_max(law->abaqus),
                        terms_max(law->abaqus) > 1 ? "s" : "");
    asked->terms = (int)count;
    return LAR_OK;
}

/* Fields of a series of fewer terms than there are, to where those of the longest one stand. */
static void spread(const lar_law_dialect *dialect, int terms, lar_span *field, int *fields) {
    lar_span from[LAR_LAW_GIVEN];
    int per_term = dialect->per_term, given = *fields < LAR_LAW_GIVEN ? *fields : LAR_LAW_GIVEN;
    memcpy(from, field, (size_t)given * sizeof *from);
    for (int i = 0; i < dialect->count; i++) {
        int behind = i - per_term * terms_max(dialect);
        int at = behind < 0 ? i : per_term * terms + behind;
        bool there = behind < 0 ? i < per_term * terms : behind < terms;
        field[i] = there && at < given ? from[at] : (lar_span){"", 0};
    }
    *fields = dialect->count;
}

/* The numbers of a card in the order of the law's row. */
static lar_status read_card(inp_deck *deck, const inp_card *card, asked_law asked,
                            inp_material **material, double given[LAR_LAW_GIVEN]) {
    const lar_law_row *law = &lar_law_table[asked.law];
    lar_span field[LAR_LAW_GIVEN + 1]; /* and a temperature */
    int fields, count = law->abaqus->count;
    if (asked.terms) count = asked.terms * (law->abaqus->per_term + 1);
    lar_status status = inp_read_option(deck, card, field, count + 1, &fields, material);
    if (status) return status;
    if (asked.terms) spread(law->abaqus, asked.terms, field, &fields);
    return read_constants(deck, card, law, field, fields, given);
}

lar_status inp_read_hyperelastic(inp_deck *deck, const inp_card *card) {
    const char *name[NAMES_MAX + 1];
    char known[300];
    double given[LAR_LAW_GIVEN] = {0}, own[LAR_LAW_GIVEN];
    int count = list_laws(name), length;
    inp_material *material;
    asked_law asked = find_asked(deck, card);
    lar_law law = 0;
    if (asked.law == LAR_LAW_COUNT) return refuse_law(deck, card);
    length = snprintf(known, sizeof known, "MODULI%s", asked.terms ? ",N" : "");
    for (int i = 0; i < count; i++)
        length += snprintf(known + length, sizeof known - (size_t)length, ",%s", name[i]);
    lar_status status = inp_only(deck, card, known);
    if (!status && asked.terms) status = read_terms(deck, card, &asked);
    if (!status) status = read_card(deck, card, asked, &material, given);
    if (status) return status;
    while (!has_constants(lar_law_table[law].abaqus, lar_law_table[asked.law].abaqus, given, own))
        law++; /* as far as the one that is asked for */
    status = inp_take_law(deck, card, material, law);
    if (!status) status = inp_read_moduli(deck, card, material);
    if (status) return status;
    lar_law_table[law].abaqus->read(own, material->value.parameter);
    return inp_check_law(deck, material);
}

lar_status inp_read_density(inp_deck *deck, const inp_card *card) {
    static const char known[] = "";
    lar_span field[2];
    int count;
    inp_material *material;
    lar_status status = inp_only(deck, card, known);
    if (!status) status = inp_read_option(deck, card, field, 2, &count, &material);
    if (!status) status = inp_number(deck, field, count, 0, "a density", &material->value.density);
    if (!status && material->has_density) status = refuse_second(deck, card, material, "*DENSITY");
    if (status) return status;
    if (!(material->value.density > 0.0))
        return inp_fail(deck, deck->reader.line, LAR_ERROR_MODEL,
                        "the density is %g; it must be positive", material->value.density);
    material->has_density = true;
    return LAR_OK;
}

/* Rayleigh damping: ALPHA in proportion to mass, as Lariat's. */
lar_status inp_read_damping(inp_deck *deck, const inp_card *card) {
    static const char known[] = "ALPHA,BETA";
    lar_span alpha, beta;
    double value = 0.0, other = 0.0;
    lar_status status = inp_only(deck, card, known);
    if (status) return status;
    if (deck->current < 0)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "*DAMPING stands outside of a material; put it behind its *MATERIAL");
    if (inp_parameter(card, "ALPHA", &alpha))
        status = inp_number(deck, &alpha, 1, 0, "ALPHA, a number in 1/s", &value);
    if (!status && inp_parameter(card, "BETA", &beta))
        status = inp_number(deck, &beta, 1, 0, "BETA, a number", &other);
    if (status) return status;
    if (other != 0.0 || value < 0.0)
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "Lariat damps in proportion to mass only; leave BETA out and give ALPHA, "
                        "not negative");
    deck->material[deck->current].damping = value;
    deck->material[deck->current].damping_line = card->line;
    return LAR_OK;
}

/* ---- sections ------------------------------------------------------------------------------ */

/* Puts a material into the model when the first section uses it. */
static lar_status use_material(inp_deck *deck, inp_material *material) {
    if (material->index >= 0) return LAR_OK;
    if (!material->has_law)
        return inp_fail(deck, material->line, LAR_ERROR_MODEL,
                        "the material '%.60s' has no law; give it *ELASTIC, *HYPERELASTIC "
                        "or *ANISOTROPIC HYPERELASTIC",
                        material->name);
    int index = deck->model->material_count;
    lar_material *made = LAR_MODEL_APPEND(deck->model, material);
    if (!made) return inp_no_memory(deck, "the materials");
    *made = material->value;
    made->name = lar_strdup(material->name);
    if (!made->name) return inp_no_memory(deck, "the materials");
    material->index = index;
    return inp_finish_viscosity(deck, material, made);
}

lar_status inp_read_section(inp_deck *deck, const inp_card *card) {
    static const char known[] = "ELSET,MATERIAL,CONTROLS,ORIENTATION";
    lar_span name, elements, ignored;
    const int32_t *index;
    int32_t own, count;
    lar_status status = inp_only(deck, card, known);
    if (!status) status = inp_need(deck, card, "ELSET", &elements);
    if (!status) status = inp_need(deck, card, "MATERIAL", &name);
    if (status) return status;
    inp_material *material = INP_FIND(deck, material, name);
    deck->reader.line = card->line;
    if (!material)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "there is no *MATERIAL called '%.*s'; define it or correct the name",
                        inp_shown(name), name.at);
    if (material->value.fibre.law == LAR_FIBRE_NONE && inp_parameter(card, "ORIENTATION", &ignored))
        return inp_fail(
            deck, card->line, LAR_ERROR_UNSUPPORTED,
            "ORIENTATION of *SOLID SECTION is not read where the material has no fibres; "
            "remove it");
    status = inp_elements(deck, elements, &own, &index, &count);
    if (!status) status = inp_check_solids(&deck->reader, elements);
    if (!status) status = use_material(deck, material);
    if (!status && inp_parameter(card, "CONTROLS", &ignored))
        status = inp_notice(deck, card->line, "CONTROLS of *SOLID SECTION was left out");
    if (!status && material->value.fibre.law != LAR_FIBRE_NONE)
        status = inp_lay_fibres(deck, card, &material->value.fibre, index, count);
    for (int32_t i = 0; i < count && !status; i++) {
        int32_t *assigned = &deck->model->element_material[index[i]];
        if (*assigned >= 0 && *assigned != material->index)
            status = inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                              "element %lld gets a second material; it stands in two sections",
                              (long long)deck->mesh->element_id[index[i]]);
        *assigned = material->index;
    }
    return status;
}

/* ---- the end of the deck ------------------------------------------------------------------- */

static lar_status notice_law(inp_deck *deck, const inp_material *material) {
    if (material->index < 0)
        return inp_notice(deck, material->line,
                          "material '%.60s' is not used by any section and was left out",
                          material->name);
    if (material->linear)
        return inp_notice(deck, material->line,
                          "material '%.60s' is linear elastic; Lariat takes the neo-Hookean law "
                          "with the same moduli, which is equal at small strain only",
                          material->name);
    const lar_law_row *law = &lar_law_table[material->value.law];
    if (material->value.fibre.law != LAR_FIBRE_NONE)
        return inp_notice(deck, material->line,
                          "material '%.60s': Lariat answers a change of volume by (J - 1)^2 / D "
                          "instead of ((J^2 - 1)/2 - ln J) / D, which is equal where the volume "
                          "changes little",
                          material->name);
    if (law->abaqus->volume)
        return inp_notice(deck, material->line,
                          "material '%.60s': Lariat's %s law answers a change of volume by %s "
                          "instead of (J - 1)^2 / D1 or what Abaqus has for it, which is equal "
                          "where the volume changes little",
                          material->name, law->title, law->abaqus->volume);
    return LAR_OK;
}

/* A static answer does not depend on density unless gravity pulls, and decks leave it out: then a
 * shear wave shall cross the body ten times in the step, whatever the deck's units are. */
static lar_status choose_density(inp_deck *deck, const inp_material *material) {
    enum { PERIODS = 10 };
    lar_model *model = deck->model;
    if (!inp_is_static(deck) || deck->gravity_count > 0)
        return inp_fail(deck, material->line, LAR_ERROR_MODEL,
                        "the material '%.60s' has no density; give it *DENSITY", material->name);
    for (int i = 0; i < model->material_count; i++) model->material[i].density = 1.0;
    double wanted = deck->step.period / PERIODS / lar_model_slow_period(model);
    for (int i = 0; i < model->material_count; i++) model->material[i].density = wanted * wanted;
    return inp_notice(deck, material->line,
                      "no *DENSITY: the static answer does not depend on it, Lariat takes one that "
                      "fits the step");
}

static lar_status finish_densities(inp_deck *deck) {
    const inp_material *missing = NULL, *given = NULL;
    for (size_t i = 0; i < deck->material_count; i++) {
        const inp_material *material = &deck->material[i];
        if (material->index < 0) continue;
        if (material->has_density)
            given = material;
        else if (!missing)
            missing = material;
    }
    if (!missing) return LAR_OK;
    if (given)
        return inp_fail(deck, missing->line, LAR_ERROR_MODEL,
                        "the material '%.60s' has no density, others have; give it *DENSITY",
                        missing->name);
    return choose_density(deck, missing);
}

static lar_status finish_damping(inp_deck *deck) {
    const inp_material *first = NULL;
    for (size_t i = 0; i < deck->material_count; i++) {
        const inp_material *material = &deck->material[i];
        if (material->index < 0) continue;
        if (inp_is_static(deck)) {
            if (material->damping > 0)
                return inp_notice(deck, material->damping_line,
                                  "*DAMPING was left out: it does not count in a static step");
            continue;
        }
        if (first && first->damping != material->damping)
            return inp_fail(deck, material->line, LAR_ERROR_UNSUPPORTED,
                            "the materials '%.60s' and '%.60s' have different *DAMPING; Lariat has "
                            "one for the whole model",
                            first->name, material->name);
        first = material;
    }
    deck->model->damping = first ? first->damping : 0.0;
    return LAR_OK;
}

lar_status inp_finish_materials(inp_deck *deck) {
    for (int32_t e = 0; e < deck->mesh->element_count; e++)
        if (deck->model->element_material[e] < 0)
            return inp_fail(deck, deck->mesh->element_line[e], LAR_ERROR_MODEL,
                            "element %lld has no material; put it into a *SOLID SECTION",
                            (long long)deck->mesh->element_id[e]);
    lar_status status = finish_densities(deck);
    if (!status) status = finish_damping(deck);
    for (size_t i = 0; i < deck->material_count && !status; i++)
        status = notice_law(deck, &deck->material[i]);
    return status;
}
