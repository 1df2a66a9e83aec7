/* Abaqus decks: *ANISOTROPIC HYPERELASTIC, HOLZAPFEL and *ORIENTATION. See deck.h.
 *
 *     *ORIENTATION, NAME=helix, LOCAL DIRECTIONS=2
 *     1., 0., 0., 0., 1., 0.           a, b (and c): the first axis runs from c to a, the second
 *     3, 0.                            one in the plane of b; then they turn about one of them
 *     0.866, 0.5, 0.                   directions of the families, in these axes
 *     0.866, -0.5, 0.
 *
 * The law is C10 (I1 - 3) + 1/D ((J^2 - 1)/2 - ln J) and that of the fibres (law/fibre.h).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "model/format/inp/deck.h"

/* LOCAL DIRECTIONS, 0 without it. */
static lar_status read_count(const inp_deck *deck, const inp_card *card, int *count) {
    lar_span text;
    int64_t value = 0;
    *count = 0;
    if (!inp_parameter(card, "LOCAL DIRECTIONS", &text)) return LAR_OK;
    if (!lar_span_int64(text, &value) || value < 1 || value > 2)
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "LOCAL DIRECTIONS=%.*s; Lariat has one family of fibres or two, give 1 or "
                        "2",
                        inp_shown(text), text.at);
    *count = (int)value;
    return LAR_OK;
}

lar_status inp_read_anisotropic(inp_deck *deck, const inp_card *card) {
    static const char known[] = "HOLZAPFEL,LOCAL DIRECTIONS,MODULI";
    static const char *const what[] = {"C10", "D", "k1", "k2", "kappa"};
    lar_span ignored, field[6]; /* and a temperature */
    double value[5] = {0};
    int families, fields;
    inp_material *material;
    if (!inp_parameter(card, "HOLZAPFEL", &ignored))
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "this kind of *ANISOTROPIC HYPERELASTIC is not read; Lariat has HOLZAPFEL");
    lar_status status = inp_only(deck, card, known);
    if (!status) status = read_count(deck, card, &families);
    if (!status && families == 0)
        status = inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                          "*ANISOTROPIC HYPERELASTIC needs LOCAL DIRECTIONS, the number of its "
                          "families of fibres; add it");
    if (!status) status = inp_read_option(deck, card, field, 6, &fields, &material);
    for (int k = 0; k < 5 && !status; k++)
        status = inp_number(deck, field, fields, k, what[k], &value[k]);
    if (!status) status = inp_take_law(deck, card, material, LAR_LAW_neo_hookean);
    if (!status) status = inp_read_moduli(deck, card, material);
    if (status) return status;
    if (!(value[1] > 0))
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "D is %g, which asks for a material that cannot change its volume; give it "
                        "D = 2 / K, with a bulk modulus K of some hundred times the shear modulus",
                        value[1]);
    lar_material_from_shear_bulk(&material->value, 2 * value[0], 2 / value[1]);
    material->value.fibre = (lar_fibre){.law = LAR_FIBRE_HGO,
                                        .isochoric = true,
                                        .paired = families == 2,
                                        .parameter = {value[2], value[3], value[4]},
                                        .line = card->line};
    return inp_check_law(deck, material);
}

/* ---- directions ---------------------------------------------------------------------------- */

/* Local axes from points a, b and c; false: they span no plane. */
static bool find_axes(const double point[9], double axis[3][3]) {
    double b[3];
    lar_minus(point, point + 6, axis[0]);
    lar_minus(point + 3, point + 6, b);
    lar_cross(axis[0], b, axis[2]);
    lar_cross(axis[2], axis[0], axis[1]);
    for (int k = 0; k < 3; k++) {
        double length = lar_length(axis[k]);
        if (!(length > 0) || !isfinite(length)) return false;
        for (int i = 0; i < 3; i++) axis[k][i] /= length;
    }
    return true;
}

/* The line that turns the axes about one of them; none: they stay. */
static lar_status read_turn(inp_deck *deck, double axis[3][3]) {
    lar_span line, field[2];
    int count;
    double about = 1, angle = 0;
    if (!inp_data_line(&deck->reader, &line)) return LAR_OK;
    lar_status status = inp_fields(deck, line, field, 2, &count);
    if (!status) status = inp_optional(deck, field, count, 0, "an axis, 1 to 3", 1, &about);
    if (!status) status = inp_optional(deck, field, count, 1, "an angle in degrees", 0, &angle);
    if (status) return status;
    if (about != 1 && about != 2 && about != 3)
        return inp_fail(deck, deck->reader.line, LAR_ERROR_FORMAT,
                        "*ORIENTATION turns about axis %g; give 1, 2 or 3", about);
    angle *= 3.14159265358979323846 / 180;
    double *first = axis[(int)about % 3], *second = axis[((int)about + 1) % 3];
    for (int i = 0; i < 3; i++) {
        double x = first[i], y = second[i];
        first[i] = cos(angle) * x + sin(angle) * y;
        second[i] = cos(angle) * y - sin(angle) * x;
    }
    return LAR_OK;
}

/* Directions in the axes, or without any the first two axes. */
static lar_status read_directions(inp_deck *deck, int count, const double axis[3][3],
                                  inp_orientation *made) {
    made->directions = count ? count : 2;
    memcpy(made->direction, axis, sizeof made->direction);
    for (int k = 0; k < count; k++) {
        lar_span line, field[3];
        double local[3];
        int fields;
        if (!inp_data_line(&deck->reader, &line))
            return inp_fail(deck, deck->reader.line, LAR_ERROR_FORMAT,
                            "*ORIENTATION '%.60s' promises %d directions; behind the line of axis "
                            "and angle give each on a line of its own",
                            made->name, count);
        lar_status status = inp_fields(deck, line, field, 3, &fields);
        for (int i = 0; i < 3 && !status; i++)
            status = inp_optional(deck, field, fields, i, "a direction", 0, &local[i]);
        if (status) return status;
        for (int i = 0; i < 3; i++)
            made->direction[k][i] =
                local[0] * axis[0][i] + local[1] * axis[1][i] + local[2] * axis[2][i];
    }
    return LAR_OK;
}

/* DEFINITION and SYSTEM have one value here. */
static lar_status check_orientation(const inp_deck *deck, const inp_card *card) {
    static const char *const only[][2] = {{"DEFINITION", "COORDINATES"}, {"SYSTEM", "RECTANGULAR"}};
    static const char known[] = "NAME,DEFINITION,SYSTEM,LOCAL DIRECTIONS";
    lar_span value;
    for (int k = 0; k < 2; k++)
        if (inp_parameter(card, only[k][0], &value) && !lar_span_equal_nocase(value, only[k][1]))
            return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                            "%s=%.*s of *ORIENTATION is not read; Lariat has %s", only[k][0],
                            inp_shown(value), value.at, only[k][1]);
    return inp_only(deck, card, known);
}

lar_status inp_read_orientation(inp_deck *deck, const inp_card *card) {
    lar_span line, field[9];
    double point[9] = {0}, axis[3][3];
    int count, fields;
    lar_status status = check_orientation(deck, card);
    if (!status) status = read_count(deck, card, &count);
    if (!status) status = INP_ADD(deck, card, orientation);
    if (status) return status;
    if (!inp_data_line(&deck->reader, &line))
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "*ORIENTATION has no line of numbers; add it");
    status = inp_fields(deck, line, field, 9, &fields);
    for (int k = 0; k < 9 && !status; k++)
        status = k < 6 ? inp_number(deck, field, fields, k, "points a and b", &point[k])
                       : inp_optional(deck, field, fields, k, "point c", 0, &point[k]);
    if (status) return status;
    if (!find_axes(point, axis))
        return inp_fail(deck, deck->reader.line, LAR_ERROR_MODEL,
                        "the points of *ORIENTATION span no plane; give two ways from c to a and b "
                        "that are not parallel");
    status = read_turn(deck, axis);
    inp_orientation *made = &deck->orientation[deck->orientation_count - 1];
    return status ? status : read_directions(deck, count, (const double(*)[3])axis, made);
}

static bool make_room(lar_mesh *mesh, double (**fibre)[3]) {
    if (!*fibre) *fibre = lar_calloc((size_t)mesh->element_count, sizeof **fibre);
    return *fibre != NULL;
}

lar_status inp_lay_fibres(inp_deck *deck, const inp_card *card, const lar_fibre *fibre,
                          const int32_t *element, int32_t count) {
    lar_span name;
    lar_mesh *mesh = deck->mesh;
    int families = lar_fibre_families(fibre);
    bool given = inp_parameter(card, "ORIENTATION", &name);
    const inp_orientation *from = given ? INP_FIND(deck, orientation, name) : NULL;
    if (given && !from)
        return inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                        "there is no *ORIENTATION called '%.*s'; define it or correct the name",
                        inp_shown(name), name.at);
    if (!from || from->directions < families)
        return inp_fail(deck, card->line, LAR_ERROR_MODEL,
                        "the fibres of this section need %d direction%s; give the section an "
                        "ORIENTATION with so many LOCAL DIRECTIONS",
                        families, families == 2 ? "s" : "");
    if (!make_room(mesh, &mesh->fibre) || (families == 2 && !make_room(mesh, &mesh->second)))
        return inp_no_memory(deck, "the directions of fibres");
    for (int32_t i = 0; i < count; i++) {
        memcpy(mesh->fibre[element[i]], from->direction[0], sizeof *mesh->fibre);
        if (families == 2)
            memcpy(mesh->second[element[i]], from->direction[1], sizeof *mesh->second);
    }
    return LAR_OK;
}
