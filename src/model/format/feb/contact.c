/* FEBio decks: <Contact>, what touches and slides. See feb.h.
 *
 *     <SurfacePair name="p"> <primary>a</primary> <secondary>b</secondary>     in <Mesh>
 *     <contact type="sliding-elastic" surface_pair="p"> <fric_coeff>0.2</fric_coeff>
 *
 * How stiff contact is, and how stiff surfaces hold until they slide, Lariat says itself: what a
 * deck says of it is left out, with one notice. What asks for more than pushing and rubbing is
 * refused: surfaces that are tied, that stick or pull, or that fluid passes through.
 */
#include "model/format/feb/feb.h"

#include <stdlib.h>
#include <string.h>

#include "model/contact_check.h"

/* What is read, and behind it how FEBio's own contact is made to hold. */
#define LOOKED_AT                                                                                  \
    "fric_coeff tension offset flip_primary flip_secondary shell_bottom_primary "                  \
    "shell_bottom_secondary "
static const char KNOWN[] =
    LOOKED_AT "laugon penalty auto_penalty update_penalty tolerance gaptol minaug maxaug two_pass "
              "knmult search_tol search_radius seg_up node_reloc smooth_aug symmetric_stiffness "
              "fric_penalty";

static const xmlNode *find_pair(lar_feb *feb, const char *name) {
    const xmlNode *section = lar_feb_child(feb->root, "Mesh");
    const xmlNode *block = section ? lar_feb_first(section) : NULL;
    for (; block; block = lar_feb_next(block)) {
        const char *found =
            lar_feb_is(block, "SurfacePair") ? lar_feb_attribute(feb, block, "name") : NULL;
        if (found && strcmp(found, name) == 0) break;
    }
    return block;
}

/* A side of a pair, which the decks of version 2.5 call `old`, and its name; NULL: an error. */
static const xmlNode *find_side(lar_feb *feb, const xmlNode *pair, const char *side,
                                const char *old, const char **name, lar_status *status) {
    const xmlNode *found = lar_feb_child(pair, side);
    if (found) {
        *name = lar_feb_word(feb, found);
        *status = *name ? LAR_OK : lar_feb_no_memory(feb, "the contact");
    } else if ((found = lar_feb_child(pair, old))) {
        *status = lar_feb_need_attribute(feb, found, "surface", name);
    } else {
        *status = lar_feb_need_child(feb, pair, side, &found);
    }
    return *status ? NULL : found;
}

static int compare_faces(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* The faces of one side, ascending: contact wants them so. */
static lar_status read_side(lar_feb *feb, const xmlNode *pair, const char *side, const char *old,
                            const lar_set **set, int32_t **face, int32_t *count) {
    const char *name = NULL;
    char problem[LAR_PROBLEM_SIZE];
    lar_status status;
    const xmlNode *at = find_side(feb, pair, side, old, &name, &status);
    if (status) return status;
    *set = lar_mesh_find_set(feb->mesh, name, LAR_SET_FACES);
    if (!*set) return lar_feb_no_set(feb, at, "surface", name);
    *face = lar_calloc((size_t)(*set)->count, sizeof **face);
    if (!*face) return lar_feb_no_memory(feb, "the contact");
    memcpy(*face, (*set)->index, (size_t)(*set)->count * sizeof **face);
    *count = (*set)->count;
    qsort(*face, (size_t)*count, sizeof **face, compare_faces);
    if (lar_face_list_problem(feb->model, *face, *count, problem))
        return lar_feb_fail(feb, at, LAR_ERROR_MODEL, "%s", problem);
    return LAR_OK;
}

static lar_status read_friction(lar_feb *feb, const xmlNode *at, double *friction) {
    const xmlNode *value = lar_feb_child(at, "fric_coeff");
    *friction = 0;
    if (!value) return LAR_OK;
    lar_status status = lar_feb_curve_of(feb, value, NULL);
    if (!status && lar_feb_attribute(feb, value, "lc"))
        return lar_feb_fail(feb, value, LAR_ERROR_UNSUPPORTED,
                            "a friction that follows a load curve is not read; give it a number");
    if (!status) status = lar_feb_doubles(feb, value, friction, 1);
    const char *wrong = status ? NULL : lar_friction_problem(*friction);
    return wrong ? lar_feb_fail(feb, value, LAR_ERROR_MODEL, "<fric_coeff> is %g; %s", *friction,
                                wrong)
                 : status;
}

/* What would change the answer, unless it is 0. */
static lar_status refuse_more(lar_feb *feb, const xmlNode *at) {
    static const char *const names[] = {"tension",
                                        "offset",
                                        "flip_primary",
                                        "flip_secondary",
                                        "shell_bottom_primary",
                                        "shell_bottom_secondary"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const xmlNode *value = lar_feb_child(at, names[i]);
        double number = 0;
        lar_status status = value ? lar_feb_doubles(feb, value, &number, 1) : LAR_OK;
        if (!status && number != 0)
            status = lar_feb_fail(feb, value, LAR_ERROR_UNSUPPORTED,
                                  "<%s> other than 0 is not read: Lariat's surfaces push where "
                                  "they touch; set it to 0",
                                  names[i]);
        if (status) return status;
    }
    return LAR_OK;
}

static lar_status notice_numerics(lar_feb *feb, const xmlNode *at) {
    const xmlNode *child = lar_feb_first(at);
    while (child && !lar_feb_is_any(child, KNOWN + sizeof LOOKED_AT - 1))
        child = lar_feb_next(child);
    lar_status status =
        child ? lar_feb_notice(feb, at,
                               "penalties, tolerances and searches of <contact> were left out: "
                               "Lariat's contact has its own stiffness")
              : LAR_OK;
    return status ? status : lar_feb_notice_others(feb, at, KNOWN);
}

static lar_status read_pair(lar_feb *feb, const xmlNode *at, const xmlNode *pair, double friction) {
    char problem[LAR_PROBLEM_SIZE];
    const lar_set *first, *second;
    lar_status status = LAR_OK;
    if (!feb->model->surface.face)
        status = lar_surface_build(feb->mesh, &feb->model->surface, feb->error);
    lar_contact *contact = status ? NULL : LAR_MODEL_APPEND(feb->model, contact);
    if (!contact) return status ? status : lar_feb_no_memory(feb, "the contact");
    contact->kind = LAR_CONTACT_BETWEEN;
    contact->friction = friction;
    status = read_side(feb, pair, "primary", "slave", &first, &contact->face, &contact->face_count);
    if (!status)
        status = read_side(feb, pair, "secondary", "master", &second, &contact->against,
                           &contact->against_count);
    if (!status && first == second) {
        contact->kind = LAR_CONTACT_SELF;
        free(contact->against);
        contact->against = NULL;
        contact->against_count = 0;
    }
    if (!status && lar_contact_problem(feb->model, contact, problem))
        status = lar_feb_fail(feb, at, LAR_ERROR_MODEL, "%s", problem);
    return status;
}

static lar_status read_contact(lar_feb *feb, const xmlNode *at) {
    static const char *const types[] = {"sliding-elastic",       "sliding-facet-on-facet",
                                        "sliding-node-on-facet", "facet-to-facet sliding",
                                        "sliding_with_gaps",     "sliding2"};
    const char *type, *name;
    double friction;
    lar_status status = lar_feb_need_attribute(feb, at, "type", &type);
    if (status) return status;
    size_t known = 0;
    while (known < sizeof types / sizeof types[0] && strcmp(type, types[known]) != 0) known++;
    if (strncmp(type, "tied", 4) == 0)
        return lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                            "<contact> of type '%.60s': surfaces that are tied are not read; join "
                            "their nodes in the mesh",
                            type);
    if (!lar_feb_is(at, "contact") || known == sizeof types / sizeof types[0])
        return lar_feb_refuse_type(feb, at,
                                   "<contact> of types sliding-elastic, sliding-facet-on-facet "
                                   "and sliding-node-on-facet");
    status = lar_feb_need_attribute(feb, at, "surface_pair", &name);
    const xmlNode *pair = status ? NULL : find_pair(feb, name);
    if (!status && !pair) return lar_feb_no_set(feb, at, "surface pair", name);
    if (!status) status = read_friction(feb, at, &friction);
    if (!status) status = refuse_more(feb, at);
    if (!status) status = notice_numerics(feb, at);
    return status ? status : read_pair(feb, at, pair, friction);
}

lar_status lar_feb_read_contact(lar_feb *feb, const xmlNode *section) {
    lar_status status = LAR_OK;
    for (xmlNode *at = lar_feb_first(section); at && !status; at = lar_feb_next(at))
        status = read_contact(feb, at);
    return status;
}
