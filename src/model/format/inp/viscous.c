/* Abaqus decks: *VISCOELASTIC, TIME=PRONY. See deck.h.
 *
 *     g_1, k_1, tau_1      shares of the shear and bulk modulus AT ONCE that relax, and in which
 *     g_2, k_2, tau_2      time; a line for each term
 *
 * k of 0 throughout: the isochoric part of the stress relaxes; k equal to g: the whole of it. The
 * moduli of the law are those in the end (MODULI=LONG TERM, Abaqus's default), or those at once
 * (MODULI=INSTANTANEOUS): then 1 - sum g is left of them. law/viscosity.h counts shares by the
 * law's moduli.
 *
 *     *STATIC               elastic, with the moduli at once
 *     *STATIC, LONG TERM    elastic, with those in the end
 *     *VISCO, *DYNAMIC      relaxes in the step's time
 */
#include <math.h>
#include <stdio.h>

#include "model/format/inp/deck.h"

/* MODULI of *ELASTIC and *HYPERELASTIC. */
lar_status inp_read_moduli(const inp_deck *deck, const inp_card *card, inp_material *material) {
    lar_span moduli;
    material->instant = false;
    if (!inp_parameter(card, "MODULI", &moduli)) return LAR_OK;
    material->instant = lar_span_equal_nocase(moduli, "INSTANTANEOUS");
    if (material->instant || lar_span_equal_nocase(moduli, "LONG TERM")) return LAR_OK;
    return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                    "MODULI=%.*s is neither LONG TERM nor INSTANTANEOUS; give one of them",
                    inp_shown(moduli), moduli.at);
}

static lar_status check_term(const inp_deck *deck, double shear, double bulk, double time,
                             const lar_viscosity *v) {
    int line = deck->reader.line;
    if (v->terms == LAR_VISCOUS_TERMS)
        return inp_fail(deck, line, LAR_ERROR_UNSUPPORTED,
                        "more than %d terms of *VISCOELASTIC; Lariat has %d at most",
                        LAR_VISCOUS_TERMS, LAR_VISCOUS_TERMS);
    if (!(shear > 0 && shear < 1))
        return inp_fail(deck, line, LAR_ERROR_MODEL,
                        "g of *VISCOELASTIC is %g; it is the share of the shear modulus that "
                        "relaxes and must be between 0 and 1, exclusive",
                        shear);
    if (bulk != 0 && bulk != shear)
        return inp_fail(deck, line, LAR_ERROR_UNSUPPORTED,
                        "k of *VISCOELASTIC is %g and g %g; Lariat relaxes the isochoric part of "
                        "the stress or the whole of it, give k = 0 or k = g",
                        bulk, shear);
    if (v->terms > 0 && v->isochoric != (bulk == 0))
        return inp_fail(deck, line, LAR_ERROR_UNSUPPORTED,
                        "the terms of *VISCOELASTIC differ in whether the volume relaxes; give "
                        "k = 0 in all of them or k = g in all of them");
    if (!(time > 0))
        return inp_fail(deck, line, LAR_ERROR_MODEL,
                        "tau of *VISCOELASTIC is %g; it must be a positive time", time);
    return LAR_OK;
}

static lar_status read_term(inp_deck *deck, lar_span text, lar_viscosity *v) {
    lar_span field[3];
    double shear = 0, bulk = 0, time = 0;
    int count;
    lar_status status = inp_fields(deck, text, field, 3, &count);
    if (!status) status = inp_number(deck, field, count, 0, "g", &shear);
    if (!status) status = inp_optional(deck, field, count, 1, "k", 0.0, &bulk);
    if (!status) status = inp_number(deck, field, count, 2, "tau", &time);
    if (!status) status = check_term(deck, shear, bulk, time, v);
    if (status) return status;
    v->isochoric = bulk == 0;
    v->share[v->terms] = shear;
    v->time[v->terms++] = time;
    return LAR_OK;
}

lar_status inp_read_viscoelastic(inp_deck *deck, const inp_card *card) {
    static const char known[] = "TIME";
    lar_span time, text;
    lar_status status = inp_only(deck, card, known);
    if (!status) status = inp_need(deck, card, "TIME", &time);
    if (status) return status;
    if (!lar_span_equal_nocase(time, "PRONY"))
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "*VISCOELASTIC with TIME=%.*s is not read; give the terms themselves, "
                        "TIME=PRONY",
                        inp_shown(time), time.at);
    if (deck->current < 0)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "*VISCOELASTIC stands outside of a material; put it behind its *MATERIAL");
    lar_viscosity *v = &deck->material[deck->current].value.viscosity;
    if (v->terms > 0)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "a second *VISCOELASTIC of one material; keep one of the two");
    while (!status && inp_data_line(&deck->reader, &text)) status = read_term(deck, text, v);
    if (!status && v->terms == 0)
        status = inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                          "*VISCOELASTIC has no line of numbers; add g, k, tau");
    v->line = card->line;
    return status;
}

/* In Abaqus too nothing relaxes in a static step. */
static lar_status freeze(inp_deck *deck, const inp_material *from, lar_material *material) {
    static const char *const long_term = ", LONG TERM";
    const bool at_once = !deck->step.long_term;
    lar_material_freeze(material, at_once);
    return inp_notice(
        deck, material->viscosity.line,
        "material '%.60s': *STATIC%s takes its moduli %s; *STATIC%s takes those %s, and "
        "*VISCO follows what relaxes",
        from->name, at_once ? "" : long_term, at_once ? "at once" : "in the end",
        at_once ? long_term : "", at_once ? "in the end" : "at once");
}

lar_status inp_finish_viscosity(inp_deck *deck, const inp_material *from, lar_material *material) {
    lar_viscosity *v = &material->viscosity;
    char where[300];
    double left = 1;
    if (v->terms == 0) return LAR_OK;
    for (int i = 0; i < v->terms; i++) left -= v->share[i];
    if (!(left > 0))
        return inp_fail(deck, v->line, LAR_ERROR_MODEL,
                        "the g of *VISCOELASTIC make up %g; they must stay below 1, for a body "
                        "that keeps no stress flows",
                        1 - left);
    v->rest = from->instant ? left : 1;
    for (int i = 0; i < v->terms && !from->instant; i++) v->share[i] /= left;
    snprintf(where, sizeof where, "%.200s:%d", deck->reader.path, v->line);
    lar_material tried = *material;
    tried.density = 1.0; /* it may not be known yet */
    lar_status status = lar_material_check(&tried, where, deck->reader.error);
    if (!status && deck->step.procedure == INP_STATIC) return freeze(deck, from, material);
    return status ? status
                  : inp_notice(deck, v->line,
                               "material '%.60s': Lariat relaxes the stress of the shape at rest "
                               "(Simo 1987), Abaqus that of the present one; they are equal where "
                               "strain is small",
                               from->name);
}
