/* FEBio decks: <Material> and <MeshDomains>. See feb.h.
 *
 * Which types are read, by which parameters, and what becomes of them stands in the rows of the
 * laws (law/law.h). "viscoelastic" and "uncoupled viscoelastic" have a law inside of them, as
 * <elastic>, and the terms of their relaxation; the second one a bulk modulus as well, beside that
 * of the law. "solid mixture" and "uncoupled solid mixture" are one law and fibres, as
 * <solid>; "Holzapfel-Gasser-Ogden" is a law with two families (hgo.c), "trans iso Mooney-Rivlin"
 * and "trans iso Veronda-Westmann" have them built in.
 */
#include "model/format/feb/feb.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static lar_status list_one(lar_feb *feb, xmlNode *node) {
    int64_t id;
    lar_status status = lar_feb_id_attribute(feb, node, "id", &id);
    if (status) return status;
    if (id < 1 || id > INT32_MAX)
        return lar_feb_fail(feb, node, LAR_ERROR_FORMAT,
                            "material id %lld is out of range; number materials from 1",
                            (long long)id);
    for (int i = 0; i < feb->material_count; i++)
        if (feb->material[i].id == id)
            return lar_feb_fail(feb, node, LAR_ERROR_FORMAT,
                                "a second material has the id %lld; renumber one of them",
                                (long long)id);
    enum { MAX = 10000 }; /* the search above is linear */
    if (feb->material_count >= MAX)
        return lar_feb_fail(feb, node, LAR_ERROR_UNSUPPORTED,
                            "more than %d materials; remove those that no part uses", MAX);
    if (!LAR_GROW(feb->material, feb->material_room, feb->material_count))
        return lar_feb_no_memory(feb, "the materials");
    const char *name = lar_feb_attribute(feb, node, "name");
    feb->material[feb->material_count++] =
        (lar_feb_material){(int32_t)id, name ? name : "", node, -1};
    return LAR_OK;
}

lar_status lar_feb_list_materials(lar_feb *feb) {
    const xmlNode *section = lar_feb_child(feb->root, "Material");
    xmlNode *node = section ? lar_feb_first(section) : NULL;
    lar_status status = LAR_OK;
    for (; node && !status; node = lar_feb_next(node)) {
        if (lar_feb_is(node, "material"))
            status = list_one(feb, node);
        else
            status = lar_feb_notice(feb, node, "<%s> among the materials was left out",
                                    (const char *)node->name);
    }
    return status;
}

/* The `mat` that MeshDomains gives the part, NULL when it has none. *at is where it stands. */
static const char *domain_material(lar_feb *feb, const char *part, const xmlNode **at) {
    const xmlNode *section = part ? lar_feb_child(feb->root, "MeshDomains") : NULL;
    const xmlNode *domain = section ? lar_feb_first(section) : NULL;
    for (; domain; domain = lar_feb_next(domain)) {
        const char *name = lar_feb_attribute(feb, domain, "name");
        if (!lar_feb_is(domain, "SolidDomain") || !name || strcmp(name, part) != 0) continue;
        *at = domain;
        return lar_feb_attribute(feb, domain, "mat");
    }
    return NULL;
}

lar_status lar_feb_part_material(lar_feb *feb, const xmlNode *elements,
                                 const lar_feb_material **material) {
    const xmlNode *at = elements;
    const char *wanted = lar_feb_attribute(feb, elements, "mat");
    if (!wanted) wanted = domain_material(feb, lar_feb_attribute(feb, elements, "name"), &at);
    *material = NULL;
    if (!wanted) return LAR_OK;
    for (int i = 0; i < feb->material_count; i++) {
        if (strcmp(feb->material[i].name, wanted) != 0) continue;
        if (*material && feb->model)
            return lar_feb_fail(feb, at, LAR_ERROR_FORMAT,
                                "<%s> names the material '%.100s', and two in <Material> are "
                                "called so; give them names of their own",
                                (const char *)at->name, wanted);
        if (!*material) *material = &feb->material[i];
    }
    int64_t id;
    lar_span span = lar_span_trim((lar_span){wanted, strlen(wanted)});
    if (!*material && lar_span_int64(span, &id))
        for (int i = 0; i < feb->material_count; i++)
            if (feb->material[i].id == id) *material = &feb->material[i];
    /* A file that only lends its mesh may lack its materials. */
    if (*material || !feb->model) return LAR_OK;
    return lar_feb_fail(feb, at, LAR_ERROR_FORMAT,
                        "<%s> names the material '%.100s', which <Material> does not define; "
                        "define it or correct the name",
                        (const char *)at->name, wanted);
}

/* ---- parameters ------------------------------------------------------------------------------ */

lar_status lar_feb_parameter(lar_feb *feb, const xmlNode *material, const char *name, bool required,
                             double *value) {
    const xmlNode *child = lar_feb_child(material, name);
    if (!child && !required) return LAR_OK;
    if (!child)
        return lar_feb_fail(feb, material, LAR_ERROR_FORMAT,
                            "the material has no parameter <%s>; add it", name);
    const char *type = lar_feb_attribute(feb, child, "type");
    if ((type && strcmp(type, "const") != 0) || lar_feb_attribute(feb, child, "lc"))
        return lar_feb_fail(feb, child, LAR_ERROR_UNSUPPORTED,
                            "the parameter <%s> varies in space or time, which Lariat does not "
                            "do; give it one number",
                            name);
    return lar_feb_doubles(feb, child, value, 1);
}

static bool is_mixture(const char *type) {
    return strcmp(type, "uncoupled solid mixture") == 0 || strcmp(type, "solid mixture") == 0;
}

static bool is_viscous(const char *type) {
    return strcmp(type, "uncoupled viscoelastic") == 0 || strcmp(type, "viscoelastic") == 0;
}

/* Adds the bulk modulus of an uncoupled material, as FEBio puts it together: a viscous one adds
 * that of its <elastic> to its own, a mixture without one of its own takes those of its parts. */
static lar_status add_bulk(lar_feb *feb, const xmlNode *node, double *bulk) {
    const char *type = lar_feb_attribute(feb, node, "type");
    const xmlNode *elastic = type && is_viscous(type) ? lar_feb_child(node, "elastic") : NULL;
    double own = 0, inner = 0, parts = 0;
    lar_status status = lar_feb_parameter(feb, node, "k", false, &own);
    if (elastic && !status) status = lar_feb_parameter(feb, elastic, "k", false, &inner);
    if (elastic && !status && inner == 0) status = add_bulk(feb, elastic, &parts);
    if (!status && parts != 0)
        return lar_feb_fail(feb, elastic, LAR_ERROR_UNSUPPORTED,
                            "versions of FEBio differ in whether <k> of the parts of a mixture "
                            "counts within a viscous material; give the mixture its own");
    own += inner;
    const bool sums = own == 0 && type && is_mixture(type);
    const xmlNode *solid = sums ? lar_feb_first(node) : NULL;
    for (; solid && !status; solid = lar_feb_next(solid))
        if (lar_feb_is(solid, "solid")) status = add_bulk(feb, solid, &own);
    *bulk += own;
    return status;
}

/* Adds the density of a material: that of a mixture is the sum of its parts', in FEBio since
 * version 3. */
static lar_status add_density(lar_feb *feb, const xmlNode *node, double *density) {
    const char *type = lar_feb_attribute(feb, node, "type");
    const bool said = lar_feb_child(node, "density");
    const bool sums = type && is_mixture(type) &&
                      strcmp(lar_feb_attribute(feb, feb->root, "version"), "2.5") != 0;
    double own = 1, parts = 0; /* FEBio's default */
    lar_status status = lar_feb_parameter(feb, node, "density", false, &own);
    if (!status && !said && !sums && !feb->weightless)
        status =
            lar_feb_notice(feb, node, "the material has no density; it gets FEBio's default, 1");
    for (const xmlNode *solid = sums ? lar_feb_first(node) : NULL; solid && !status;
         solid = lar_feb_next(solid))
        if (lar_feb_is(solid, "solid")) status = add_density(feb, solid, &parts);
    *density += sums ? parts : own;
    if (status || !sums || !said || parts == own || feb->weightless) return status;
    return lar_feb_notice(feb, node,
                          "the density of the mixture is the sum of its parts', %g, as in FEBio "
                          "since version 3, and not its own, %g",
                          parts, own);
}

/* Lariat has one answer to a change of volume for each law. */
static lar_status check_pressure_model(lar_feb *feb, const xmlNode *node,
                                       const lar_law_dialect *dialect) {
    const xmlNode *pressure = dialect->volume ? lar_feb_child(node, "pressure_model") : NULL;
    if (!pressure) return LAR_OK;
    lar_span model = lar_feb_text(feb, pressure);
    if (lar_span_equal(model, "default") || lar_span_equal(model, "0")) return LAR_OK;
    return lar_feb_fail(feb, pressure, LAR_ERROR_UNSUPPORTED,
                        "pressure_model '%.*s' is not read; Lariat has FEBio's default, %s",
                        (int)(model.length < 40 ? model.length : 40), model.at, dialect->volume);
}

static lar_status check_value(lar_feb *feb, const xmlNode *node, const lar_law_row *law,
                              const lar_law_parameter *of, double value) {
    if (of->value == LAR_VALUE_RATIO && !(value > -1.0 && value < 0.5))
        return lar_feb_fail(feb, node, LAR_ERROR_MODEL,
                            "Poisson's ratio %s = %g is not between -1 and 0.5; correct it",
                            of->name, value);
    if (of->value == LAR_VALUE_NOT_OURS && value != 0.0)
        return lar_feb_fail(feb, node, LAR_ERROR_UNSUPPORTED,
                            "the parameter <%s> is %g; Lariat's %s law does not have that term, "
                            "give it 0 or remove it",
                            of->name, value, law->title);
    return LAR_OK;
}

/* FEBio's default is 0, and 1 for the powers of Ogden's law. Of a first constant that is a law when
 * there is another one. */
static bool has_default(const xmlNode *node, lar_law law, int i) {
    return i == 0 && (law == LAR_LAW_ogden || law == LAR_LAW_mooney_rivlin) &&
           (lar_feb_child(node, "c2") || lar_feb_child(node, "c3"));
}

/* `outer`: the uncoupled material around it, which says the bulk modulus, or NULL. */
static lar_status read_law(lar_feb *feb, const xmlNode *node, const xmlNode *outer, lar_law law,
                           bool trans_iso, lar_material *material) {
    const lar_law_dialect *dialect = lar_law_table[law].febio;
    char known[200];
    int length =
        snprintf(known, sizeof known, "density%s%s", dialect->volume ? " pressure_model" : "",
                 trans_iso ? " c3 c4 c5 lam_max fiber mat_axis active_contraction" : "");
    double given[LAR_LAW_GIVEN] = {0};
    material->law = law;
    lar_status status = check_pressure_model(feb, node, dialect);
    for (int i = 0; i < dialect->count && !status; i++) {
        const lar_law_parameter *of = &dialect->parameter[i];
        bool needed = !lar_law_may_miss(dialect->parameter, i) && !has_default(node, law, i);
        bool outside = outer && strcmp(of->name, "k") == 0;
        length += snprintf(known + length, sizeof known - (size_t)length, " %s", of->name);
        status = outside ? add_bulk(feb, outer, &given[i])
                         : lar_feb_parameter(feb, node, of->name, needed, &given[i]);
        if (outside && !status && given[i] == 0)
            status = lar_feb_fail(feb, outer, LAR_ERROR_FORMAT,
                                  "the material has no parameter <k>, nor has what is within it; "
                                  "add it");
    }
    for (int i = 0; law == LAR_LAW_ogden && i < 3; i++)
        if (given[i] != 0 && !lar_feb_child(node, dialect->parameter[3 + i].name)) given[3 + i] = 1;
    for (int i = 0; i < dialect->count && !status; i++)
        status = check_value(feb, node, &lar_law_table[law], &dialect->parameter[i], given[i]);
    if (status) return status;
    dialect->read(given, material->parameter);
    return lar_feb_notice_others(feb, node, known);
}

/* The law that FEBio calls so, LAR_LAW_COUNT when there is none. */
static lar_law find_law(const char *type) {
    int law = 0;
    while (law < LAR_LAW_COUNT &&
           !(lar_law_table[law].febio->name && strcmp(type, lar_law_table[law].febio->name) == 0))
        law++;
    return (lar_law)law;
}

/* Letters to change, insert or leave out, of whichever case; many where a word is long. */
static int count_typos(const char *word, const char *name) {
    enum { LONGEST = 60 };
    const size_t m = strlen(name);
    int row[LONGEST + 1];
    if (m > LONGEST || strlen(word) > LONGEST) return LONGEST;
    for (size_t j = 0; j <= m; j++) row[j] = (int)j;
    for (; *word; word++) {
        int diagonal = row[0]++;
        for (size_t j = 1; j <= m; j++) {
            int best =
                diagonal + (tolower((unsigned char)*word) != tolower((unsigned char)name[j - 1]));
            diagonal = row[j];
            if (diagonal + 1 < best) best = diagonal + 1;
            if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
            row[j] = best;
        }
    }
    return row[m];
}

/* Types that are no laws and stand in no other table. */
static const char *const other_types[] = {"Holzapfel-Gasser-Ogden",     "trans iso Mooney-Rivlin",
                                          "trans iso Veronda-Westmann", "viscoelastic",
                                          "uncoupled viscoelastic",     "solid mixture",
                                          "uncoupled solid mixture"};

/* Type i of all that are read, NULL behind the last one. */
static const char *type_name(int i) {
    const int others = sizeof other_types / sizeof *other_types;
    if (i < LAR_LAW_COUNT) return lar_law_table[i].febio->name ? lar_law_table[i].febio->name : "";
    i -= LAR_LAW_COUNT;
    return i < others ? other_types[i] : lar_feb_fibre_name(i - others);
}

static lar_status refuse_type(lar_feb *feb, const xmlNode *node, const char *type) {
    const char *law[LAR_LAW_COUNT], *near = NULL, *name;
    char list[300], meant[100] = "";
    int count = 0, least = 3;
    if (lar_feb_is_hgo(type))
        return lar_feb_fail(feb, node, LAR_ERROR_UNSUPPORTED,
                            "the material %s is read where it stands alone, not within another "
                            "one; take it out, or write the model as a scene",
                            type);
    for (int i = 0; (name = type_name(i)); i++) {
        if (!*name) continue;
        const int typos = count_typos(type, name);
        if (i < LAR_LAW_COUNT) law[count++] = name;
        if (typos < least) near = name, least = typos;
    }
    lar_text_list(law, count, list, sizeof list);
    if (near && strcmp(near, type) == 0)
        snprintf(meant, sizeof meant, " here");
    else if (near)
        snprintf(meant, sizeof meant, " (did you mean '%s'?)", near);
    return lar_feb_fail(
        feb, node, LAR_ERROR_UNSUPPORTED,
        "material type '%.60s' is not read%s; of FEBio's, Lariat has %s; "
        "Holzapfel-Gasser-Ogden and trans iso; and mixtures, viscoelasticity, fibers "
        "and contractions of them, as docs/formats.md lists them",
        type, meant, list);
}

/* ---- fibres ---------------------------------------------------------------------------------- */

/* The law in a "trans iso" type, LAR_LAW_COUNT: it is none. */
static lar_law trans_iso_law(const char *type) {
    static const char prefix[] = "trans iso ";
    size_t length = sizeof prefix - 1;
    lar_law law = strncmp(type, prefix, length) == 0 ? find_law(type + length) : LAR_LAW_COUNT;
    return law == LAR_LAW_mooney_rivlin || law == LAR_LAW_veronda_westmann ? law : LAR_LAW_COUNT;
}

/* A law, or one with fibres built in; `outer` as for read_law. */
static lar_status read_law_part(lar_feb *feb, const xmlNode *node, const xmlNode *outer,
                                const char *type, lar_material *material) {
    lar_law law = trans_iso_law(type);
    bool fibres = law != LAR_LAW_COUNT;
    if (!fibres) law = find_law(type);
    if (law == LAR_LAW_COUNT) return refuse_type(feb, node, type);
    lar_status status = outer ? check_pressure_model(feb, outer, lar_law_table[law].febio) : LAR_OK;
    if (!status) status = read_law(feb, node, outer, law, fibres, material);
    return status || !fibres ? status : lar_feb_read_trans_iso(feb, node, &material->fibre);
}

/* FEBio takes only uncoupled materials into an uncoupled one (`outer`). */
static lar_status refuse_coupled(lar_feb *feb, const xmlNode *node, const xmlNode *outer,
                                 const char *type) {
    const lar_law law = find_law(type);
    bool coupled = !strstr(type, "uncoupled");
    if (law != LAR_LAW_COUNT)
        coupled = !lar_law_table[law].febio->volume;
    else
        coupled = coupled && (lar_feb_is_fibre(type) || lar_feb_is_active(type) ||
                              is_mixture(type) || is_viscous(type));
    if (!outer || !coupled) return LAR_OK;
    return lar_feb_fail(feb, node, LAR_ERROR_UNSUPPORTED,
                        "'%s' is no uncoupled material, which FEBio wants within an uncoupled one; "
                        "take its uncoupled form, or the coupled form of what is around it",
                        type);
}

/* Where the bulk modulus of what is within stands: the outermost uncoupled material. */
static const xmlNode *outermost(const xmlNode *node, const char *type, const xmlNode *outer) {
    return outer || strncmp(type, "uncoupled ", 10) != 0 ? outer : node;
}

/* Parts that only one of can be. */
static lar_status refuse_second(lar_feb *feb, const xmlNode *node, const char *what) {
    return lar_feb_fail(feb, node, LAR_ERROR_UNSUPPORTED,
                        "a second %s in a solid mixture; Lariat's have one law, one family of "
                        "fibres and one contraction, leave it out or put the two together",
                        what);
}

static lar_status read_viscous(lar_feb *feb, const xmlNode *node, const xmlNode *outer,
                               const char *type, lar_material *material);

static bool is_body(const char *type) {
    return is_viscous(type) || find_law(type) != LAR_LAW_COUNT ||
           trans_iso_law(type) != LAR_LAW_COUNT;
}

/* A part of a mixture that is no fibres and nothing active: of one only the law. */
static lar_status read_body(lar_feb *feb, const xmlNode *solid, const xmlNode *outer,
                            const char *type, lar_material *material) {
    const bool fibrous = material->fibre.law != LAR_FIBRE_NONE;
    if (!is_viscous(type)) {
        if (fibrous && trans_iso_law(type) != LAR_LAW_COUNT)
            return refuse_second(feb, solid, "family of fibres");
        return read_law_part(feb, solid, outer, type, material);
    }
    if (!fibrous) return read_viscous(feb, solid, outer, type, material);
    return lar_feb_fail(feb, solid, LAR_ERROR_UNSUPPORTED,
                        "fibres beside a viscous solid; in Lariat they relax with it, put them "
                        "into it, in a mixture of its own");
}

/* One law, with the bulk modulus of the mixture where that is uncoupled, and fibres. */
static lar_status read_mixture(lar_feb *feb, const xmlNode *node, const xmlNode *outer,
                               lar_material *material) {
    static const char known[] = "density solid mat_axis k pressure_model";
    const xmlNode *body = NULL;
    lar_status status = LAR_OK;
    for (xmlNode *solid = lar_feb_first(node); solid && !status; solid = lar_feb_next(solid)) {
        const char *type;
        if (!lar_feb_is(solid, "solid")) continue;
        status = lar_feb_need_attribute(feb, solid, "type", &type);
        if (!status) status = refuse_coupled(feb, solid, outer, type);
        if (status) return status;
        if (lar_feb_is_fibre(type)) {
            if (material->fibre.law != LAR_FIBRE_NONE)
                return refuse_second(feb, solid, "family of fibres");
            status = lar_feb_read_fibre(feb, solid, type, &material->fibre);
        } else if (lar_feb_is_active(type)) {
            if (lar_fibre_active(&material->fibre))
                return refuse_second(feb, solid, "active contraction");
            status = lar_feb_read_active(feb, solid, type, &material->fibre);
        } else if (body) {
            return is_body(type) ? refuse_second(feb, solid, "law") : refuse_type(feb, solid, type);
        } else {
            body = solid; /* behind the fibres: read_body looks at them */
        }
    }
    if (!status && !body)
        return lar_feb_fail(feb, node, LAR_ERROR_UNSUPPORTED,
                            "the mixture has no law besides its fibres; add one as <solid>");
    if (!status)
        status = read_body(feb, body, outer, lar_feb_attribute(feb, body, "type"), material);
    return status ? status : lar_feb_notice_others(feb, node, known);
}

/* ---- viscosity ------------------------------------------------------------------------------- */

/* Terms without a share do nothing, whatever their times are. */
static lar_status read_terms(lar_feb *feb, const xmlNode *node, lar_viscosity *v) {
    v->rest = 1;
    lar_status status = lar_feb_parameter(feb, node, "g0", false, &v->rest);
    for (int i = 1; i <= LAR_VISCOUS_TERMS && !status; i++) {
        const char share_name[] = {'g', (char)('0' + i), '\0'};
        const char time_name[] = {'t', (char)('0' + i), '\0'};
        double share = 0, time = 1;
        status = lar_feb_parameter(feb, node, share_name, false, &share);
        if (!status) status = lar_feb_parameter(feb, node, time_name, share != 0, &time);
        if (status || share == 0) continue;
        v->share[v->terms] = share;
        v->time[v->terms++] = time;
    }
    if (!status && v->terms == 0 && v->rest != 1)
        status = lar_feb_fail(feb, node, LAR_ERROR_UNSUPPORTED,
                              "g0 is %g and nothing relaxes; multiply the moduli by it and take "
                              "the material inside",
                              v->rest);
    return status;
}

/* The law inside a viscous material, with fibres or without. */
static lar_status read_viscous(lar_feb *feb, const xmlNode *node, const xmlNode *outer,
                               const char *of, lar_material *material) {
    static const char known[] =
        "k pressure_model density elastic g0 g1 g2 g3 g4 g5 g6 t1 t2 t3 t4 t5 t6";
    lar_viscosity *v = &material->viscosity;
    const xmlNode *inner = lar_feb_child(node, "elastic");
    const char *type;
    if (!inner || v->line)
        return lar_feb_fail(feb, node, LAR_ERROR_FORMAT,
                            inner ? "a viscous material within another one; keep one of them"
                                  : "the viscous material has no <elastic> inside; add it");
    v->line = lar_feb_line(node);
    v->isochoric = strcmp(of, "uncoupled viscoelastic") == 0;
    lar_status status = lar_feb_need_attribute(feb, inner, "type", &type);
    if (status) return status;
    const bool active = lar_fibre_active(&material->fibre);
    outer = outermost(node, of, outer);
    status = refuse_coupled(feb, inner, outer, type);
    if (status) return status;
    status = is_mixture(type) ? read_mixture(feb, inner, outer, material)
                              : read_law_part(feb, inner, outer, type, material);
    if (!status && lar_fibre_active(&material->fibre) != active)
        return lar_feb_fail(feb, inner, LAR_ERROR_UNSUPPORTED,
                            "an active contraction within a viscous material; Lariat's does not "
                            "relax, put it beside, in a mixture of the two");
    if (!status) status = read_terms(feb, node, v);
    return status ? status : lar_feb_notice_others(feb, node, v->isochoric ? known : known + 17);
}

/* ---- augmentation ---------------------------------------------------------------------------- */

/* <laugon> 1 of a material of any depth. */
static lar_status find_laugon(lar_feb *feb, const xmlNode *node, const xmlNode **at) {
    bool set;
    lar_status status = lar_feb_flag(feb, node, "laugon", false, &set);
    if (set) *at = lar_feb_child(node, "laugon");
    for (const xmlNode *inner = lar_feb_first(node); inner && !status; inner = lar_feb_next(inner))
        if (lar_feb_is_any(inner, "solid elastic")) status = find_laugon(feb, inner, at);
    return status;
}

/* The same of the domains of a material. */
static lar_status find_domain_laugon(lar_feb *feb, const lar_feb_material *entry,
                                     const xmlNode **at) {
    const xmlNode *section = lar_feb_child(feb->root, "MeshDomains");
    const xmlNode *domain = section ? lar_feb_first(section) : NULL;
    lar_status status = LAR_OK;
    for (; domain && !status; domain = lar_feb_next(domain)) {
        const lar_feb_material *of;
        status = lar_feb_part_material(feb, domain, &of);
        if (!status && of == entry) status = find_laugon(feb, domain, at);
    }
    return status;
}

/* FEBio then adds pressure until the volume stays, whatever k is. Here the bulk modulus is what a
 * thousandth of pressure changes the volume by: a thousand times what resists shear. */
static lar_status augment(lar_feb *feb, const lar_feb_material *entry, lar_material *material) {
    enum { TIMES = 1000 };
    const lar_law_row *law = &lar_law_table[material->law];
    const lar_fibre *fibre = &material->fibre;
    const xmlNode *at = NULL;
    lar_status status = find_laugon(feb, entry->node, &at);
    if (!status) status = find_domain_laugon(feb, entry, &at);
    if (status || !at) return status;
    if (!law->uncoupled)
        return lar_feb_notice(feb, at, "<laugon> was left out: the material is not uncoupled");
    double *bulk = &material->parameter[law->count - 1];
    double least = TIMES * (lar_material_instant_shear(material) + lar_fibre_modulus(fibre) +
                            fmax(fabs(fibre->along), fabs(fibre->across)));
    if (*bulk >= least) return LAR_OK;
    status = lar_feb_notice(feb, at,
                            "<laugon> asks for a volume that stays; the bulk modulus becomes %d "
                            "times what resists shear, %g instead of %g, and time steps %.2g times "
                            "shorter",
                            TIMES, least, *bulk, sqrt(least / *bulk));
    *bulk = least;
    return status;
}

static lar_status read_material(lar_feb *feb, lar_feb_material *entry) {
    const char *type;
    lar_status status = lar_feb_need_attribute(feb, entry->node, "type", &type);
    if (status) return status;
    entry->index = feb->model->material_count;
    lar_material *material = LAR_MODEL_APPEND(feb->model, material);
    if (!material) return lar_feb_no_memory(feb, "the materials");
    material->name = lar_strdup(entry->name);
    if (!material->name) return lar_feb_no_memory(feb, "the materials");
    if (lar_feb_is_rigid(feb, entry)) return LAR_OK; /* made when there are others */
    status = add_density(feb, entry->node, &material->density);
    if (status) return status;
    const xmlNode *outer = outermost(entry->node, type, NULL);
    if (is_viscous(type))
        status = read_viscous(feb, entry->node, NULL, type, material);
    else if (is_mixture(type))
        status = read_mixture(feb, entry->node, outer, material);
    else if (lar_feb_is_hgo(type))
        status = lar_feb_read_hgo(feb, entry->node, material);
    else
        status = read_law_part(feb, entry->node, NULL, type, material);
    if (!status) status = augment(feb, entry, material);
    if (status) return status;
    char where[300];
    snprintf(where, sizeof where, "%.200s:%d", feb->path, lar_feb_line(entry->node));
    return lar_material_check(material, where, feb->error);
}

/* Position in feb->material of a part's tag; tags were made from that table. */
static int find_tag(const lar_feb *feb, int32_t tag) {
    for (int i = 0; i < feb->material_count; i++)
        if (feb->material[i].id == tag) return i;
    return -1;
}

lar_status lar_feb_read_materials(lar_feb *feb) {
    const lar_mesh *mesh = feb->mesh;
    int32_t *assigned = lar_calloc((size_t)mesh->element_count, sizeof *assigned);
    if (!assigned) return lar_feb_no_memory(feb, "the materials");
    feb->model->element_material = assigned;
    int last = -1;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        if (last < 0 || feb->material[last].id != mesh->element_tag[e])
            last = find_tag(feb, mesh->element_tag[e]);
        if (last < 0)
            return lar_feb_fail(feb, feb->root, LAR_ERROR_MODEL,
                                "element %lld has no material; give its part one, in "
                                "<MeshDomains> or by mat=\"...\" in <Elements>",
                                (long long)mesh->element_id[e]);
        lar_feb_material *entry = &feb->material[last];
        lar_status status = entry->index < 0 ? read_material(feb, entry) : LAR_OK;
        if (status) return status;
        assigned[e] = entry->index;
    }
    lar_status status = LAR_OK;
    for (int i = 0; i < feb->material_count && !status; i++)
        if (feb->material[i].index < 0)
            status = lar_feb_notice(feb, feb->material[i].node,
                                    "material '%.100s' is not used by any element and was left "
                                    "out",
                                    feb->material[i].name);
    if (!status) status = lar_feb_fill_rigid(feb);
    return status ? status : lar_feb_lay_fibres(feb);
}
