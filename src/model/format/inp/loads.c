/* Abaqus and CalculiX decks: forces, pressures, gravity. See deck.h.
 *
 * A positive pressure pushes on the face, in decks as in Lariat. Forces at the same node in the
 * same step add up, and pressures on the same face, with a notice, since programs that write a deck
 * face by face mean it so.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/format/inp/deck.h"

static lar_status read_load_card(inp_deck *deck, const inp_card *card, int *curve) {
    static const char known[] = "OP,AMPLITUDE";
    lar_status status = inp_only(deck, card, known);
    if (!status) status = inp_in_step(deck, card);
    return status ? status : inp_curve_of(deck, card, deck->step.procedure == INP_STATIC, curve);
}

/* ---- *CLOAD -------------------------------------------------------------------------------- */

static lar_status forces_on(inp_deck *deck, int curve, inp_forces **forces) {
    enum { MAX = 64 }; /* three numbers per node each */
    for (size_t i = 0; i < deck->forces_count; i++)
        if (deck->forces[i].curve == curve) {
            *forces = &deck->forces[i];
            return LAR_OK;
        }
    if (deck->forces_count >= MAX)
        return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                        "forces on more than %d amplitudes; join some of them", MAX);
    double(*force)[3] = lar_calloc((size_t)deck->mesh->node_count, sizeof *force);
    if (!force || !LAR_GROW(deck->forces, deck->forces_room, deck->forces_count)) {
        free(force);
        return inp_no_memory(deck, "the loads");
    }
    *forces = &deck->forces[deck->forces_count++];
    **forces = (inp_forces){curve, deck->reader.line, force};
    return LAR_OK;
}

/* What a line adds to what is there. */
static lar_status notice_twice(inp_deck *deck, int32_t twice, const char *what) {
    if (twice == 0) return LAR_OK;
    return inp_notice(deck, deck->reader.line, "%d %s already; the two are added", (int)twice,
                      what);
}

static lar_status read_force(inp_deck *deck, inp_forces *forces, lar_span line) {
    lar_span field[3];
    const int32_t *index;
    int32_t own, nodes = 0, twice = 0;
    int count;
    int64_t axis = 0;
    double value;
    lar_status status = inp_fields(deck, line, field, 3, &count);
    if (status) return status;
    if (count < 2 || !lar_span_int64(field[1], &axis) || axis < 1 || axis > 3)
        return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                        "a force needs a direction 1, 2 or 3; nodes of solids have no moments and "
                        "no other loads");
    status = inp_number(deck, field, count, 2, "a force", &value);
    if (!status) status = inp_nodes(deck, field[0], &own, &index, &nodes);
    for (int32_t n = 0; n < nodes && !status; n++) {
        double *force = &forces->force[index[n]][axis - 1];
        if (*force != 0.0 && value != 0.0) twice++;
        *force += value;
    }
    return status ? status : notice_twice(deck, twice, "nodes have a force in this direction");
}

lar_status inp_read_cload(inp_deck *deck, const inp_card *card) {
    lar_span line;
    int curve = 0;
    inp_forces *forces = NULL;
    lar_status status = read_load_card(deck, card, &curve);
    if (!status) status = forces_on(deck, curve, &forces);
    while (!status && inp_data_line(&deck->reader, &line)) status = read_force(deck, forces, line);
    return status;
}

/* ---- pressures ----------------------------------------------------------------------------- */

/* Pressures of 0 do not count for *twice. */
static lar_status add_pressure(inp_deck *deck, int32_t face, double pressure, int curve,
                               int32_t *twice) {
    if (!deck->pressed) deck->pressed = lar_calloc((size_t)deck->mesh->element_count, 6);
    if (!deck->pressed || !LAR_GROW(deck->pressure, deck->pressure_room, deck->pressure_count))
        return inp_no_memory(deck, "the pressures");
    if (pressure != 0.0) {
        *twice += deck->pressed[face];
        deck->pressed[face] = 1;
    }
    deck->pressure[deck->pressure_count++] = (inp_pressure){curve, pressure, face};
    return LAR_OK;
}

static lar_status read_pressure(inp_deck *deck, const lar_span *field, int count, int curve) {
    const int32_t *index;
    int32_t own, elements = 0, twice = 0;
    double pressure;
    lar_span label = field[1];
    int face = inp_face_of(label.at[1]);
    if (face >= 4 && deck->mesh->turned) face ^= 1; /* as those of sets (lar_mesh_turn) */
    lar_status status = inp_number(deck, field, count, 2, "a pressure", &pressure);
    if (!status && count > 3)
        status = inp_expected(&deck->reader, deck->reader.line, "the end of the line", field[3]);
    if (!status) status = inp_elements(deck, field[0], &own, &index, &elements);
    for (int32_t e = 0; e < elements && !status; e++)
        status = add_pressure(deck, 6 * index[e] + face, pressure, curve, &twice);
    return status ? status : notice_twice(deck, twice, "faces have a pressure");
}

/* ---- gravity ------------------------------------------------------------------------------- */

static lar_status gravity_vector(inp_deck *deck, const lar_span *field, int count,
                                 double gravity[3]) {
    double size, square = 0.0;
    lar_status status = inp_number(deck, field, count, 2, "an acceleration", &size);
    for (int i = 0; i < 3 && !status; i++) {
        status = inp_optional(deck, field, count, 3 + i, "a direction", 0.0, &gravity[i]);
        square += gravity[i] * gravity[i];
    }
    if (status) return status;
    if (!(fabs(sqrt(square) - 1.0) < 1e-3))
        return inp_fail(deck, deck->reader.line, LAR_ERROR_FORMAT,
                        "the direction of GRAV has the length %g; write three numbers of length 1",
                        sqrt(square));
    for (int i = 0; i < 3; i++) gravity[i] = gravity[i] * size / sqrt(square) + 0.0; /* no -0 */
    return LAR_OK;
}

/* The one with this vector and curve, new where there is none: a model of several parts has a line
 * for each of them. */
static lar_status open_gravity(inp_deck *deck, const double by[3], int curve, int *bit) {
    inp_gravity *made = &deck->gravity[deck->gravity_count];
    for (*bit = 0; *bit < deck->gravity_count; (*bit)++)
        if (deck->gravity[*bit].curve == curve &&
            memcmp(by, deck->gravity[*bit].by, sizeof made->by) == 0)
            return LAR_OK;
    if (*bit == INP_GRAVITIES)
        return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                        "more than %d different GRAV; add some of them up", INP_GRAVITIES);
    *made = (inp_gravity){{by[0], by[1], by[2]}, curve, deck->reader.line};
    deck->gravity_count++;
    return LAR_OK;
}

/* Different ones add up; each must be that of the whole model. */
static lar_status read_gravity(inp_deck *deck, const lar_span *field, int count, int curve) {
    double gravity[3] = {0};
    int bit = 0;
    lar_status status = gravity_vector(deck, field, count, gravity);
    if (!status) status = open_gravity(deck, gravity, curve, &bit);
    if (status) return status;
    if (!deck->heavy) deck->heavy = lar_calloc((size_t)deck->mesh->element_count, 1);
    if (!deck->heavy) return inp_no_memory(deck, "gravity");
    const bool whole = field[0].length == 0;
    const int32_t *index = NULL;
    int32_t own, elements = deck->mesh->element_count, twice = 0;
    if (!whole) status = inp_elements(deck, field[0], &own, &index, &elements);
    for (int32_t e = 0; e < elements && !status; e++) {
        unsigned char *heavy = &deck->heavy[whole ? e : index[e]];
        twice += *heavy >> bit & 1;
        *heavy |= (unsigned char)(1u << bit);
    }
    if (status || twice == 0) return status;
    return inp_notice(deck, deck->reader.line,
                      "%d elements have this GRAV already; it acts once, not twice", (int)twice);
}

static lar_status finish_gravity(inp_deck *deck) {
    lar_model *model = deck->model;
    for (int g = 0; g < deck->gravity_count; g++) {
        const inp_gravity *gravity = &deck->gravity[g];
        for (int32_t e = 0; e < deck->mesh->element_count; e++)
            if (!(deck->heavy[e] >> g & 1))
                return inp_fail(
                    deck, gravity->line, LAR_ERROR_UNSUPPORTED,
                    "GRAV leaves out element %lld; Lariat's gravity acts on the whole model",
                    (long long)deck->mesh->element_id[e]);
        for (int i = 0; i < 3; i++) {
            if (gravity->by[i] == 0 && model->gravity[i] != 0) continue;
            if (model->gravity[i] != 0 && model->gravity_curve[i] != gravity->curve)
                return inp_fail(deck, gravity->line, LAR_ERROR_UNSUPPORTED,
                                "another GRAV along %c has another amplitude; Lariat has one for "
                                "each axis",
                                "xyz"[i]);
            model->gravity[i] += gravity->by[i];
            model->gravity_curve[i] = gravity->curve;
        }
    }
    return LAR_OK;
}

/* ---- *DLOAD and *DSLOAD -------------------------------------------------------------------- */

lar_status inp_read_dload(inp_deck *deck, const inp_card *card) {
    lar_span line, field[6];
    int count, curve = 0;
    lar_status status = read_load_card(deck, card, &curve);
    while (!status && inp_data_line(&deck->reader, &line)) {
        status = inp_fields(deck, line, field, 6, &count);
        if (status) break;
        lar_span label = count > 1 ? field[1] : (lar_span){"", 0};
        if (lar_span_equal_nocase(label, "GRAV"))
            status = read_gravity(deck, field, count, curve);
        else if (label.length == 2 && (label.at[0] | 32) == 'p' && inp_face_of(label.at[1]) >= 0)
            status = read_pressure(deck, field, count, curve);
        else
            status = inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                              "the load '%.*s' is not read; Lariat reads pressures P1 to P6 on "
                              "faces, and GRAV",
                              inp_shown(label), label.at);
    }
    return status;
}

lar_status inp_read_dsload(inp_deck *deck, const inp_card *card) {
    lar_span line, field[3];
    int count, curve = 0;
    lar_status status = read_load_card(deck, card, &curve);
    while (!status && inp_data_line(&deck->reader, &line)) {
        const lar_set *set;
        double pressure;
        int32_t twice = 0;
        status = inp_fields(deck, line, field, 3, &count);
        if (status) break;
        if (count < 2 || !lar_span_equal_nocase(field[1], "P"))
            return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                            "this load on a surface is not read; Lariat reads pressures (surface, "
                            "P, pressure)");
        status = inp_number(deck, field, count, 2, "a pressure", &pressure);
        if (!status) status = inp_faces(deck, field[0], &set);
        for (int32_t i = 0; !status && i < set->count; i++)
            status = add_pressure(deck, set->index[i], pressure, curve, &twice);
        if (!status) status = notice_twice(deck, twice, "faces have a pressure");
    }
    return status;
}

/* ---- loads as the model has them ----------------------------------------------------------- */

static int compare_pressures(const void *a, const void *b) {
    const inp_pressure *x = a, *y = b;
    if (x->curve != y->curve) return x->curve < y->curve ? -1 : 1;
    if (x->pressure != y->pressure) return x->pressure < y->pressure ? -1 : 1;
    return (x->face > y->face) - (x->face < y->face);
}

/* Faces with the same pressure and curve become one entry. */
static lar_status finish_pressures(inp_deck *deck) {
    size_t count = deck->pressure_count;
    if (count == 0) return LAR_OK;
    const inp_pressure *all = deck->pressure;
    qsort(deck->pressure, count, sizeof *deck->pressure, compare_pressures);
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i; end < count && end - i < INT32_MAX && all[end].curve == all[i].curve &&
                      all[end].pressure == all[i].pressure;)
            end++;
        int32_t *face = lar_calloc(end - i, sizeof *face);
        lar_pressure_load *load = face ? LAR_MODEL_APPEND(deck->model, pressure) : NULL;
        if (!load) {
            free(face);
            return inp_no_memory(deck, "the pressures");
        }
        *load = (lar_pressure_load){(int32_t)(end - i), face, all[i].pressure, all[i].curve};
        for (size_t k = i; k < end; k++) face[k - i] = all[k].face;
    }
    return LAR_OK;
}

/* Whether a force only pulls along axes that are held. */
static bool is_held(const inp_deck *deck, const inp_vector *force) {
    for (int i = 0; i < 3; i++)
        if (force->value[i] != 0.0 && deck->hold[3 * (size_t)force->node + (size_t)i] == 0)
            return false;
    return true;
}

static lar_status notice_held(inp_deck *deck, const inp_forces *forces, const inp_vector *vector,
                              int32_t count) {
    int32_t held = 0;
    for (int32_t i = 0; i < count; i++) held += is_held(deck, &vector[i]);
    if (held == 0) return LAR_OK;
    return inp_notice(deck, forces->line,
                      "forces on %d nodes act along axes that *BOUNDARY holds: they move nothing",
                      (int)held);
}

static lar_status finish_forces(inp_deck *deck, const inp_forces *forces) {
    inp_vector *vector = NULL;
    int32_t count = 0;
    lar_status status = inp_sort_vectors(deck, (const double(*)[3])forces->force, &vector, &count);
    if (!status) status = notice_held(deck, forces, vector, count);
    for (int32_t i = 0, end = 0; i < count && !status; i = end) {
        lar_nodal_load *load = LAR_MODEL_APPEND(deck->model, load);
        if (!load) status = inp_no_memory(deck, "the loads");
        if (status) break;
        memcpy(load->force, vector[i].value, sizeof load->force);
        load->curve = forces->curve;
        status = inp_take_run(deck, vector, count, i, &load->nodes, &end);
    }
    free(vector);
    return status;
}

lar_status inp_finish_loads(inp_deck *deck) {
    lar_status status = finish_gravity(deck);
    for (size_t i = 0; i < deck->forces_count && !status; i++)
        status = finish_forces(deck, &deck->forces[i]);
    return status ? status : finish_pressures(deck);
}
