/* What a broken element says of why it broke: how far it is stretched, what its material bears
 * there, and whether it came so far little by little, which no time step changes. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/hex8.h"
#include "mechanics/stress.h"
#include "step/step.h"

/* A step that changes so much of the strain, or more, may be too long for it. */
static const double SLOW = 0.3;
/* So many moduli are the doing of a law that stiffens. */
static const double STIFF = 1e3;
/* So far a wall is stretched near its limit load; so far nothing is stretched by a long step, when
 * it came slowly. */
static const double BLOWN = 1.5, FAR = 3;
/* A face no farther than so many edges of an element presses on it. */
static const double PRESSED = 3;

static double dot9(const double a[3][3], const double b[3][3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++) sum += lar_dot(a[i], b[i]);
    return sum;
}

/* F^T F - I, twice the strain. */
static void strain_of(const double F[3][3], double E[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            E[i][j] = i == j ? -1 : 0;
            for (int k = 0; k < 3; k++) E[i][j] += F[k][i] * F[k][j];
        }
}

/* The largest principal stretch, of F^T F - I. */
static double largest_stretch(const double E[3][3]) {
    double mean = (E[0][0] + E[1][1] + E[2][2]) / 3, D[3][3], cross[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) D[i][j] = E[i][j] - (i == j ? mean : 0);
    double size = sqrt(dot9((const double(*)[3])D, (const double(*)[3])D) / 6);
    lar_cross(D[1], D[2], cross);
    double third = size > 0 ? lar_dot(D[0], cross) / (2 * size * size * size) : 0;
    double angle = acos(fmax(-1, fmin(1, third))) / 3;
    return sqrt(fmax(0, 1 + mean + 2 * size * cos(angle)));
}

/* The stress of the fibres, or of the law where there are none, and how far fibres are stretched.
 */
static void examine_stress(const lar_domain *domain, lar_gid e, const double F[3][3],
                           lar_fault *fault) {
    const lar_material *material = lar_domain_material(domain, e);
    double fibre[6], P[3][3], law[3][3] = {{0}}, along[3];
    lar_model_fibres(domain->model, e, fibre);
    if (material->fibre.law != LAR_FIBRE_NONE && domain->kind == LAR_ELEMENT_HEX8) {
        lar_law_stress(material, F, law);
        for (int f = 0; f < lar_fibre_families(&material->fibre); f++) {
            for (int i = 0; i < 3; i++) along[i] = lar_dot(F[i], fibre + 3 * f);
            fault->fibre_stretch = fmax(fault->fibre_stretch, lar_length(along));
        }
    }
    lar_material_stress(material, fibre, F, P);
    for (int i = 0; i < 3; i++) lar_minus(P[i], law[i], P[i]);
    double factor = domain->factor[lar_factor_of(domain->model->element_material[e])];
    double stress = factor * sqrt(dot9((const double(*)[3])P, (const double(*)[3])P));
    fault->stress = fmin(stress, 1e300);
    double modulus = lar_material_instant_shear(material);
    if (fault->fibre_stretch == 0) modulus = fmax(modulus, lar_material_instant_bulk(material));
    fault->times = fmin(stress / (factor * modulus), 1e300);
}

void lar_fault_examine_strain(const lar_domain *domain, const lar_state *state, lar_fault *fault) {
    double corner[8][3], u[8][3], v[8][3], F[3][3], E[3][3], before[3][3], change[3][3];
    lar_hex8 hex8;
    lar_gid e = fault->element;
    lar_mesh_corners(&domain->model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    lar_domain_corners(domain, state->v, e, v);
    lar_hex8_prepare(corner, lar_domain_material(domain, e), &hex8);
    lar_hex8_gradient(&hex8, (const double(*)[3])u, F);
    strain_of((const double(*)[3])F, E);
    fault->stretch = largest_stretch((const double(*)[3])E);
    examine_stress(domain, e, (const double(*)[3])F, fault);
    for (int k = 0; k < 24; k++) u[k / 3][k % 3] -= domain->time_step * v[k / 3][k % 3];
    lar_hex8_gradient(&hex8, (const double(*)[3])u, F);
    strain_of((const double(*)[3])F, before);
    for (int i = 0; i < 3; i++) lar_minus(E[i], before[i], change[i]);
    fault->slow = dot9((const double(*)[3])change, (const double(*)[3])change) <
                  SLOW * SLOW * dot9((const double(*)[3])E, (const double(*)[3])E);
}

/* The largest pressure on faces near the element [Pa]. */
static double pressure_near(const lar_domain *domain, const lar_fault *fault) {
    const lar_model *model = domain->model;
    double time = (double)fault->step * domain->time_step, most = 0;
    double corner[8][3], middle[3] = {0}, way[3];
    lar_mesh_corners(&model->mesh, fault->element, corner);
    for (int k = 0; k < 24; k++) middle[k % 3] += corner[k / 3][k % 3] / 8;
    double reach = PRESSED * cbrt(lar_hexahedron_volume((const double(*)[3])corner));
    for (int i = 0; i < model->pressure_count; i++) {
        const lar_pressure_load *load = &model->pressure[i];
        double factor = load->curve < 0 ? 1 : lar_curve_value(&model->curve[load->curve], time);
        double pressure = fabs(factor * load->pressure);
        for (int32_t f = 0; f < load->count && pressure > most; f++) {
            const int32_t *node = model->mesh.element[load->face[f] / 6];
            lar_minus(model->mesh.position[node[lar_face_node[load->face[f] % 6][0]]], middle, way);
            if (lar_length(way) < reach) most = pressure;
        }
    }
    return most;
}

/* ": its fibres ... bear 8e+06 Pa": what stiffened, and which number of it to look at. */
static const char *describe_stiff(const lar_domain *domain, const lar_fault *fault, char *text,
                                  size_t size) {
    int index = lar_factor_of(domain->model->element_material[fault->element]);
    const lar_material *material = lar_domain_material(domain, fault->element);
    const lar_fibre *fibre = &material->fibre;
    bool fibres = fault->fibre_stretch > 0;
    char name[80];
    snprintf(name, sizeof name, "%d", index + 1);
    if (material->name) snprintf(name, sizeof name, "%.60s", material->name);
    snprintf(text, size,
             "; its %s (material %s, %s) %s stretched to %.4g times %s length, where the stress is "
             "%.3g Pa, %.2g times the %s modulus: ",
             fibres ? "fibres" : "tissue", name,
             fibres ? lar_fibre_law_name[fibre->law] : lar_law_name[material->law],
             fibres ? "are" : "is", fibres ? fault->fibre_stretch : fault->stretch,
             fibres ? "their" : "its", fault->stress, fault->times, fibres ? "shear" : "larger");
    if (!fibres) return "its parameters";
    return lar_fibre_parameter_name[fibre->law][fibre->law == LAR_FIBRE_POW_LINEAR ? 0 : 1];
}

bool lar_fault_remedy(const lar_domain *domain, const lar_fault *fault, bool forceful, char *text,
                      size_t size, bool *step_helps) {
    double pressure = fault->stretch > BLOWN ? pressure_near(domain, fault) : 0;
    bool runs_away = pressure > 0 && fault->stretch > FAR;
    size_t used;
    *step_helps = !fault->slow && !runs_away;
    if (forceful && fault->times >= STIFF) {
        const char *number = describe_stiff(domain, fault, text, size);
        used = strlen(text);
        snprintf(text + used, size - used, "check %s, loads and motions", number);
    } else if (pressure > 0) {
        snprintf(
            text, size,
            "; it is stretched to %.3g times its length where a pressure of %.3g Pa acts: that "
            "may be more than the wall bears (its limit load); use a smaller pressure, or a "
            "thicker or stiffer wall",
            fault->stretch, pressure);
    } else if (fault->slow && fault->stretch > FAR) {
        snprintf(text, size,
                 "; it is stretched to %.3g times its length: use smaller loads and motions, or a "
                 "stiffer or finer mesh there",
                 fault->stretch);
    } else {
        *step_helps = true;
        return false;
    }
    used = strlen(text);
    if (!*step_helps) snprintf(text + used, size - used, "; a smaller time step does not help");
    return true;
}
