#include "step/stable_step.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mechanics/contact.h"
#include "mechanics/hex8_full.h"
#include "mechanics/hex8_guard.h"
#include "model/springs.h"
#include "step/mass/compressible.h"

double lar_element_frequency(const lar_model *model, lar_element_kind kind, lar_gid e,
                             const lar_material *material, lar_hex8 *hex8) {
    double corner[8][3];
    lar_mesh_corners(&model->mesh, e, corner);
    lar_hex8_prepare(corner, material, hex8);
    lar_model_fibres(model, e, hex8->fibre);
    return kind == LAR_ELEMENT_HEX8 ? lar_hex8_frequency(hex8, material)
                                    : lar_hex8_full_frequency(corner, material);
}

/* With its neighbours an element is not as fast as alone. Where x_e are the values of x on element
 * e and K_e has no eigenvalue above m_e w_e^2, x K x <= sum_e m_e w_e^2 |x_e|^2, which is a sum
 * over the nodes: no mode is faster than the mean of the w_e^2 around some node, weighed by mass.
 */
static lar_status share_frequencies(const lar_model *model, lar_element_rate *rate,
                                    lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    size_t bytes = (size_t)mesh->node_count * sizeof(double[2]);
    double(*sum)[2] = lar_calloc(bytes, 1);
    if (!sum) return lar_fail_memory(error, bytes, "the elements");
    for (lar_gid e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++) {
            sum[mesh->element[e][a]][0] += rate[e].mass * rate[e].square;
            sum[mesh->element[e][a]][1] += rate[e].mass;
        }
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        double most = 0;
        for (int a = 0; a < 8; a++)
            most = fmax(most, sum[mesh->element[e][a]][0] / sum[mesh->element[e][a]][1]);
        rate[e].share = fmin(most / rate[e].square, 1);
    }
    free(sum);
    return LAR_OK;
}

/* What is nearly as stiff as the stiffest tissue holds like a support, and would take from steps
 * what strained elements need. Named is the stiffest of those springs. */
static lar_status check_springs(const lar_model *model, const double *squares, double moving,
                                lar_error *error) {
    static const double PART = 0.1;
    const lar_spring_bed *worst = NULL;
    int32_t which = 0;
    double most = 0;
    char line[LAR_LINE_TEXT];
    for (int i = 0; squares && i < model->spring_count; i++) {
        const lar_spring_bed *bed = &model->spring[i];
        for (int32_t k = 0; k < bed->nodes.count; k++) {
            double square = squares[bed->nodes.node[k]];
            if (!(square > PART * moving * moving)) continue;
            most = fmax(most, square);
            if (worst && bed->stiffness[k] <= worst->stiffness[which]) continue;
            worst = bed;
            which = k;
        }
    }
    if (!worst) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s%s: springs of %.3g N/m on node %lld are nearly as stiff as the stiffest "
                    "elements, and steps have no room for both; hold such nodes with fix, or give "
                    "these springs %.2g of their stiffness",
                    lar_model_source(model), lar_line_text(worst->line, line),
                    worst->stiffness[which],
                    (long long)model->mesh.node_id[worst->nodes.node[which]],
                    0.99 * PART * moving * moving / most);
}

/* Of an element with the mass that it gets, where springs take their part of the step. */
static double slowed(const lar_model *model, double frequency, double springs) {
    if (!(springs > 0) || !(model->mass_step > 0)) return lar_model_slowed(model, frequency);
    double bound = 2 / model->mass_step;
    return fmin(frequency, sqrt(fmax(bound * bound - springs, 0.5 * bound * bound)));
}

/* One element's part of the bound. */
static void add_element(const lar_model *model, lar_element_kind kind, lar_gid e, double springs,
                        lar_element_rate *rate, lar_step_bound *bound, double fastest[2]) {
    const lar_material *material = lar_model_material_of(model, e);
    lar_hex8 hex8;
    double frequency = lar_element_frequency(model, kind, e, material, &hex8);
    double now = slowed(model, frequency, springs), alone = frequency * frequency + springs;
    double mass = material->density * hex8.volume / 8;
    *rate = (lar_element_rate){now * now + springs, mass, 0, 1};
    if (now < frequency) {
        rate->added = mass * ((frequency / now) * (frequency / now) - 1);
        rate->mass = mass + rate->added;
    }
    double *among = &bound->fastest[lar_factor_of(model->element_material[e])];
    *among = fmax(*among, rate->square);
    if (!(rate->square <= fastest[0])) {
        fastest[0] = rate->square;
        bound->worst = e;
    }
    if (!(alone <= fastest[1])) {
        fastest[1] = alone;
        bound->worst_without = e;
    }
}

lar_status lar_step_bound_find(const lar_model *model, lar_element_kind kind,
                               lar_element_rate *rate, lar_step_bound *bound, lar_error *error) {
    double fastest[2] = {0}, *squares; /* with and without added mass */
    *bound = (lar_step_bound){0};
    lar_status status = lar_spring_squares(model, &squares, error);
    for (lar_gid e = 0; !status && e < model->mesh.element_count; e++)
        add_element(model, kind, e, lar_spring_square(model, squares, e), &rate[e], bound, fastest);
    if (!status && (!(fastest[1] > 0) || !isfinite(fastest[1])))
        status = lar_fail(error, LAR_ERROR_MODEL,
                          "%s: element %lld has no finite frequency; check its shape and material",
                          lar_model_source(model),
                          (long long)model->mesh.element_id[bound->worst_without]);
    bound->step = 2 / sqrt(fastest[0]);
    bound->without = 2 / sqrt(fastest[1]);
    if (!status) status = check_springs(model, squares, sqrt(fastest[0]), error);
    free(squares);
    return status ? status : share_frequencies(model, rate, error);
}

lar_status lar_stable_step(const lar_model *model, lar_element_kind kind, double *step,
                           lar_gid *worst, lar_error *error) {
    size_t bytes = (size_t)model->mesh.element_count * sizeof(lar_element_rate);
    lar_element_rate *rate = lar_calloc(bytes, 1);
    lar_step_bound bound;
    if (!rate) return lar_fail_memory(error, bytes, "the elements");
    lar_status status = lar_step_bound_find(model, kind, rate, &bound, error);
    free(rate);
    if (status) return status;
    *step = bound.step;
    *worst = bound.worst;
    return LAR_OK;
}

/* Of the pressure wave's speed. */
static double wave_square(const lar_material *material) {
    double shear = lar_material_instant_shear(material), bulk = lar_material_instant_bulk(material);
    return (bulk + 4.0 / 3 * shear) / material->density;
}

/* How much tools count: all beside compressible tissue, and nothing from K = 8 G on. A step that
 * jumped at a Poisson's ratio would let forces jump there. */
static double tools_count(const lar_model *model, const lar_material *material) {
    double ratio = lar_material_instant_bulk(material) / lar_material_instant_shear(material);
    return lar_model_touched(model) ? fmax(0, fmin(1, 2 - ratio / 4)) : 0;
}

/* Where bodies touch, springs of a longer step would be softer than their tissue: it would go
 * through them. So are those of tools on compressible tissue, which besides has modes as fast as
 * what is left for springs: under a tool at rest it would tremble for ever. Where only the state at
 * rest counts springs are as hard beside all other tissue. Elements are taken to be of one size. */
static double share_for_contact(const lar_model *model) {
    static const double ENOUGH = 0.25; /* what springs have at 0.8 of the stable step */
    double share = 1, fastest = 0;
    bool bodies = false, at_rest;
    for (int i = 0; i < model->contact_count; i++)
        bodies = bodies || model->contact[i].kind != LAR_CONTACT_PLANE;
    at_rest = model->until_rest && (bodies || lar_model_touched(model));
    for (int i = 0; i < model->material_count; i++)
        fastest = fmax(fastest, wave_square(&model->material[i]));
    for (int i = 0; i < model->material_count; i++) {
        const lar_material *material = &model->material[i];
        const double tools = tools_count(model, material);
        if (!bodies && !(tools > 0) && !at_rest) continue;
        double slower = sqrt(fastest / wave_square(material));
        double wanted = lar_contact_wanted(lar_material_confined(material));
        if (!bodies && !at_rest) wanted = ENOUGH + tools * (wanted - ENOUGH);
        if (at_rest) wanted *= 2;
        if (at_rest && bodies) wanted = fmax(wanted, LAR_CONTACT_WANTED_AT_REST);
        share = fmin(share, slower * lar_contact_longest(wanted));
    }
    return share;
}

double lar_auto_step(const lar_model *model, double stable_step) {
    double step = fmin(0.8, share_for_contact(model)) * stable_step;
    if (model->duration > 0) step = fmin(step, model->duration / 200);
    for (int i = 0; model->by_material_time && i < model->material_count; i++)
        for (int k = 0; k < model->material[i].viscosity.terms; k++)
            step = fmin(step, fmax(model->material[i].viscosity.time[k], model->duration / 1e6));
    return model->by_material_time ? model->duration / ceil(model->duration / step) : step;
}

lar_step_room lar_step_room_of(double time_step, double stable_step) {
    static const double MAX = 0.9, SPRINGS = 0.25;
    double share = time_step / stable_step;
    lar_step_room room = {.rest = 1.02 * share * share};
    room.max = fmax(MAX, room.rest);
    room.springs = fmin(SPRINGS, room.max - room.rest);
    return room;
}

/* ---- force units ------------------------------------------------------------------------------
 */

/* By how many powers of two units are finer where soft tissue is beside what is far stiffer in
 * shear: metal, bone and glass strain by less than tissue, and less room is enough for them. */
static int finer_by(double stiff, double soft) {
    enum { NOTHING = 5, MOST = 4 };
    int exponent; /* of a number from a half to one */
    frexp(stiff / soft, &exponent);
    const int more = exponent - 1 - NOTHING;
    return more < 0 ? 0 : more > MOST ? MOST : more;
}

int lar_force_scale_choose(const lar_model *model, double *scale) {
    double characteristic = DBL_MIN, stiff = 0, weakest = INFINITY, soft = INFINITY;
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        const lar_material *material = lar_model_material_of(model, e);
        lar_mesh_corners(&model->mesh, e, corner);
        double side = cbrt(lar_hexahedron_volume(corner));
        double modulus =
            lar_material_instant_bulk(material) + 4 * lar_material_instant_shear(material) / 3;
        if (lar_fibre_here(&material->fibre))
            modulus += lar_fibre_families(&material->fibre) * lar_fibre_modulus(&material->fibre) +
                       fabs(material->fibre.along) + fabs(material->fibre.across);
        const double force = modulus * side * side, shear = lar_material_instant_shear(material);
        if (force > characteristic) stiff = shear;
        characteristic = fmax(characteristic, force);
        weakest = fmin(weakest, force);
        soft = fmin(soft, shear);
    }
    int exponent, finer = finer_by(fmin(characteristic / weakest * soft, stiff), soft);
    frexp(characteristic, &exponent);
    *scale = ldexp(1, 46 + finer - exponent);
    return finer;
}
