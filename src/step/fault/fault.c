#include "step/step.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "mechanics/hex8_full.h"
#include "mechanics/hexahedron.h"

/* det F of an element and how much its smallest stretch has raised its frequency. */
static void examine_element(const lar_domain *domain, const lar_state *state, lar_gid e,
                            double *volume_ratio, double *frequency_growth) {
    const lar_model *model = domain->model;
    double corner[8][3], u[8][3], F[3][3], cof[9];
    lar_hex8 hex8;
    lar_mesh_corners(&model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    lar_hex8_prepare(corner, lar_domain_material(domain, e), &hex8);
    lar_hex8_gradient(&hex8, u, F);
    *volume_ratio = lar_lane_cofactor((const double *)F, cof);
    /* |F^-1| / sqrt(3): 1 at rest */
    *frequency_growth = sqrt(lar_lane_square_sum(cof) / 3) / fabs(*volume_ratio);
}

/* The volume of an element in its worst corner, as a part of that at rest. */
static double worst_corner(const lar_domain *domain, const lar_state *state, lar_gid e) {
    double rest[8][3], now[8][3], u[8][3], at[3], J[2][3][3], cof[9], min = INFINITY;
    lar_mesh_corners(&domain->model->mesh, e, rest);
    lar_domain_corners(domain, state->u, e, u);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) now[a][i] = rest[a][i] + u[a][i];
    for (int a = 0; a < 8; a++) {
        for (int i = 0; i < 3; i++) at[i] = lar_node_sign[a][i];
        lar_hexahedron_jacobian((const double(*)[3])rest, at, J[0]);
        lar_hexahedron_jacobian((const double(*)[3])now, at, J[1]);
        double ratio = lar_lane_cofactor((const double *)J[1], cof) /
                       lar_lane_cofactor((const double *)J[0], cof);
        if (!(ratio >= min)) min = ratio;
    }
    return min;
}

/* Where the surface is folded most. */
static void examine_surface(const lar_domain *domain, const lar_state *state, lar_fault *fault) {
    const lar_surface *surface = &domain->model->surface;
    fault->volume_ratio = INFINITY;
    for (int32_t f = 0; f < surface->face_count; f++) {
        double ratio = worst_corner(domain, state, surface->element[f]);
        if (ratio >= fault->volume_ratio) continue;
        fault->volume_ratio = ratio;
        fault->element = surface->element[f];
    }
}

/* What the instability begins with says more than the step size: nothing has had time to grow. */
static const char *hint(const lar_fault *fault) {
    return fault->step < 8 ? ", and check the units of mesh, material and loads" : "";
}

/* The place of a node or element, or its place at rest when it has left the range of numbers. */
static void choose_place(const double now[3], const double rest[3], double place[3]) {
    bool finite = isfinite(now[0]) && isfinite(now[1]) && isfinite(now[2]);
    for (int i = 0; i < 3; i++) place[i] = finite ? now[i] : rest[i];
}

static void examine_place(const lar_domain *domain, const lar_state *state, lar_fault *fault) {
    const lar_mesh *mesh = &domain->model->mesh;
    double center[3] = {0}, rest[3] = {0};
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) {
            lar_gid node = mesh->element[fault->element][a];
            rest[i] += mesh->position[node][i] / 8;
            center[i] += (mesh->position[node][i] +
                          state->u[lar_state_at(state, domain->layout.local[node], i)]) /
                         8;
        }
    choose_place(center, rest, fault->place);
}

/* A shorter step to try [s], with two digits. */
static double shorter_step(const lar_domain *domain) {
    double half = 0.5 * domain->time_step, digit = pow(10, floor(log10(half)) - 1);
    return floor(half / digit * (1 + 1e-9)) * digit;
}

/* What a tool does to an element. */
static const char *describe_action(const lar_domain *domain, const lar_fault *fault) {
    if (!isfinite(fault->volume_ratio) || !isfinite(fault->growth)) return "tears apart";
    if (!(fault->volume_ratio > domain->limits.min_volume)) return "turns inside out or crushes";
    if (fault->growth * domain->time_step > domain->stable_step)
        return "strains more than the time step allows";
    return "exceeds the force limit at";
}

static lar_status report_element(const lar_domain *domain, const lar_fault *fault,
                                 lar_error *error) {
    const lar_mesh *mesh = &domain->model->mesh;
    const double *place = fault->place, volume_ratio = fault->volume_ratio, growth = fault->growth;
    const char *cause, *remedy;
    bool forceful = false;
    if (fault->tool != 0)
        return lar_fault_report_tool(domain, fault, describe_action(domain, fault), error);
    if (!isfinite(volume_ratio) || !isfinite(growth))
        return lar_fail(
            error, LAR_ERROR_UNSTABLE,
            "unstable at step %llu (%.6g s): element %lld near (%.4g, %.4g, %.4g) m is "
            "torn beyond the range of numbers; use a smaller time step, such as %.2g s, or "
            "slower or smaller loads and motions%s",
            (unsigned long long)fault->step, (double)fault->step * domain->time_step,
            (long long)mesh->element_id[fault->element], place[0], place[1], place[2],
            shorter_step(domain), hint(fault));
    if (!(volume_ratio > domain->limits.min_volume)) {
        cause = "is turned inside out or crushed";
        remedy = ", slower or smaller loads, or a finer mesh there";
    } else if (growth * domain->time_step > domain->stable_step) {
        cause = "is strained so much that the time step has become too large for it";
        remedy = " or a stiffer or finer mesh there";
    } else {
        cause = "exceeds the force limit";
        forceful = true;
        remedy = ", or slower or smaller loads";
    }
    char why[500];
    bool step_helps;
    bool named = lar_fault_remedy(domain, fault, forceful, why, sizeof why, &step_helps);
    if (step_helps) {
        size_t used = named ? strlen(why) : 0;
        snprintf(why + used, sizeof why - used, "%s a smaller time step, such as %.2g s%s%s",
                 named ? ", or use" : "; use", shorter_step(domain), named ? "" : remedy,
                 named ? "" : hint(fault));
    }
    return lar_fail(error, LAR_ERROR_UNSTABLE,
                    "unstable at step %llu (%.6g s): element %lld near (%.4g, %.4g, %.4g) m %s "
                    "(volume ratio %.3g, time step %.3g s of %.3g s stable at rest)%s",
                    (unsigned long long)fault->step, (double)fault->step * domain->time_step,
                    (long long)mesh->element_id[fault->element], place[0], place[1], place[2],
                    cause, volume_ratio, domain->time_step, domain->stable_step, why);
}

/* The fastest of some nodes, and where it is. */
static void examine_speed(const lar_domain *domain, const lar_state *state, lar_lid first,
                          lar_lid end, lar_fault *fault) {
    const lar_mesh *mesh = &domain->model->mesh;
    lar_lid fastest = -1;
    double highest = -1;
    for (lar_lid n = first; n < end && n < domain->layout.node_count; n++)
        for (int i = 0; i < 3 && domain->layout.global[n] >= 0; i++)
            if (!(fabs(state->v[lar_state_at(state, n, i)]) <= highest)) {
                highest = fabs(state->v[lar_state_at(state, n, i)]);
                fastest = n;
            }
    if (fastest < 0) return;
    fault->element = domain->layout.global[fastest];
    fault->speed = highest;
    const double *rest = mesh->position[fault->element];
    double u[3];
    lar_state_displacement(state, fastest, u);
    double now[3] = {rest[0] + u[0], rest[1] + u[1], rest[2] + u[2]};
    choose_place(now, rest, fault->place);
}

static lar_status report_speed(const lar_domain *domain, const lar_fault *fault, lar_error *error) {
    const lar_mesh *mesh = &domain->model->mesh;
    lar_gid node = fault->element;
    const double *place = fault->place, highest = fault->speed;
    if (fault->tool != 0)
        return lar_fault_report_tool(domain, fault, "exceeds the speed limit at", error);
    if (!isfinite(highest))
        return lar_fail(
            error, LAR_ERROR_UNSTABLE,
            "unstable at step %llu (%.6g s): node %lld near (%.4g, %.4g, %.4g) m has "
            "left the range of numbers; use a smaller time step, such as %.2g s, or slower "
            "or smaller loads and motions%s",
            (unsigned long long)fault->step, (double)fault->step * domain->time_step,
            (long long)mesh->node_id[node], place[0], place[1], place[2], shorter_step(domain),
            hint(fault));
    return lar_fail(error, LAR_ERROR_UNSTABLE,
                    "unstable at step %llu (%.6g s): node %lld near (%.4g, %.4g, %.4g) m moves at "
                    "%.3g m/s, hundreds of elements per time step (the limit is %.3g m/s); use a "
                    "smaller time step, such as %.2g s, or slower or smaller loads and motions%s",
                    (unsigned long long)fault->step, (double)fault->step * domain->time_step,
                    (long long)mesh->node_id[node], place[0], place[1], place[2], highest,
                    domain->leapfrog.speed, shorter_step(domain), hint(fault));
}

static lar_status report_load(const lar_domain *domain, const lar_fault *fault, lar_error *error) {
    const lar_mesh *mesh = &domain->model->mesh;
    const double *at = mesh->position[fault->element];
    return lar_fail(error, LAR_ERROR_UNSTABLE,
                    "unstable at step %llu (%.6g s): the forces and pressures on node %lld, at "
                    "(%.4g, %.4g, %.4g) m at rest, are far beyond what the material can bear; use "
                    "smaller loads, and check the units of mesh, material and loads",
                    (unsigned long long)fault->step, (double)fault->step * domain->time_step,
                    (long long)mesh->node_id[fault->element], at[0], at[1], at[2]);
}

static lar_status report_gain(const lar_domain *domain, const lar_fault *fault, lar_error *error) {
    if (fault->tool != 0)
        return lar_fault_report_tool(domain, fault, "folds the surface over itself at", error);
    return lar_fail(
        error, LAR_ERROR_UNSTABLE,
        "unstable at step %llu (%.6g s): contact has given %.3g J more than it took: "
        "the surface is crushed, folds over itself or slides over an edge, most at "
        "element %lld near (%.4g, %.4g, %.4g) m (volume ratio of its worst corner "
        "%.3g); use a smaller time_step, slower or smaller loads and motions, or a finer mesh",
        (unsigned long long)fault->step, (double)fault->step * domain->time_step, fault->given,
        (long long)domain->model->mesh.element_id[fault->element], fault->place[0], fault->place[1],
        fault->place[2], fault->volume_ratio);
}

static lar_status report_pairs(const lar_domain *domain, const lar_fault *fault, lar_error *error) {
    return lar_fail(error, LAR_ERROR_UNSTABLE,
                    "unstable at step %llu (%.6g s): more than %d faces lie close to the surface "
                    "nodes that may touch them, on average: the surface is crushed; use slower or "
                    "smaller loads and motions, or a finer mesh where bodies touch",
                    (unsigned long long)fault->step, (double)fault->step * domain->time_step,
                    LAR_PAIRS_PER_NODE);
}

static lar_status report_too_fast(const lar_domain *domain, const lar_fault *fault,
                                  lar_error *error) {
    const char *pairs =
        fault->too_many_pairs
            ? ", the less since many faces are crowded around the nodes that may touch "
              "them"
            : "";
    if (fault->tool != 0)
        return lar_fault_report_tool(domain, fault,
                                     fault->too_many_pairs
                                         ? "crowds the surface and exceeds the speed limit at"
                                         : "exceeds the speed limit at",
                                     error);
    if (fault->element < 0)
        return lar_fail(error, LAR_ERROR_UNSTABLE,
                        "unstable at step %llu (%.6g s): the surface became so fast within a few "
                        "steps that the search for contact on several processors could not "
                        "follow%s; use slower or smaller loads and motions, or one processor",
                        (unsigned long long)fault->step, (double)fault->step * domain->time_step,
                        pairs);
    return lar_fail(error, LAR_ERROR_UNSTABLE,
                    "unstable at step %llu (%.6g s): node %lld near (%.4g, %.4g, %.4g) m became so "
                    "fast within a few steps (%.3g m/s) that the search for contact on several "
                    "processors could not follow%s; use slower or smaller loads and motions, or "
                    "one processor",
                    (unsigned long long)fault->step, (double)fault->step * domain->time_step,
                    (long long)domain->model->mesh.node_id[fault->element], fault->place[0],
                    fault->place[1], fault->place[2], fault->speed, pairs);
}

void lar_fault_examine(const lar_domain *domain, const lar_state *state, lar_lid first, lar_lid end,
                       lar_fault *fault) {
    if (fault->examined) return;
    fault->examined = true;
    if (fault->kind == LAR_FAULT_ELEMENT) {
        examine_element(domain, state, fault->element, &fault->volume_ratio, &fault->growth);
        examine_place(domain, state, fault);
        lar_fault_examine_strain(domain, state, fault);
    } else if (fault->kind == LAR_FAULT_ENERGY_GAIN) {
        examine_surface(domain, state, fault);
        examine_place(domain, state, fault);
    } else if (fault->kind == LAR_FAULT_SPEED || fault->kind == LAR_FAULT_TOO_FAST) {
        examine_speed(domain, state, first, end, fault);
    }
}

lar_status lar_fault_report(const lar_domain *domain, const lar_fault *fault, lar_error *error) {
    if (fault->kind == LAR_FAULT_NONE) return LAR_OK;
    if (fault->kind == LAR_FAULT_ELEMENT) return report_element(domain, fault, error);
    if (fault->kind == LAR_FAULT_LOAD) return report_load(domain, fault, error);
    if (fault->kind == LAR_FAULT_ENERGY_GAIN) return report_gain(domain, fault, error);
    if (fault->kind == LAR_FAULT_TOO_MANY_PAIRS) return report_pairs(domain, fault, error);
    if (fault->kind == LAR_FAULT_TOO_FAST) return report_too_fast(domain, fault, error);
    return report_speed(domain, fault, error);
}
