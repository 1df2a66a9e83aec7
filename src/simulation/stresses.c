/* Stress and strain of all elements as they are now, viscous and active parts included: those that
 * results on disk are made of (results.c), with all their components. */
#include <math.h>
#include <string.h>

#include "simulation/simulation.h"
#include "law/kinematics.h"
#include "mechanics/stress.h"
#include "step/measure.h"

void lar_element_gradient(const lar_domain *domain, const lar_state *state, lar_gid e,
                          double F[3][3]) {
    double corner[8][3], u[8][3];
    const lar_material now = lar_domain_material_copy(domain, e, NULL);
    lar_hex8 hex8;
    lar_mesh_corners(&domain->model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    lar_hex8_prepare(corner, &now, &hex8);
    lar_hex8_gradient(&hex8, u, F);
}

/* Green and Lagrange's (F^T F - 1) / 2 of the mean deformation gradient; returns det F. */
static double element_strain(const lar_domain *domain, const lar_state *state, lar_gid e,
                             double strain[6]) {
    static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
    double F[3][3], row_by_row[9], cof[9];
    lar_element_gradient(domain, state, e, F);
    for (int n = 0; n < 6; n++) {
        double sum = row[n] == column[n] ? -1 : 0;
        for (int i = 0; i < 3; i++) sum += F[i][row[n]] * F[i][column[n]];
        strain[n] = sum / 2;
    }
    memcpy(row_by_row, F, sizeof row_by_row);
    return lar_lane_cofactor(row_by_row, cof);
}

lar_state lar_state_measured(const lar_simulation *simulation) {
    lar_state state = simulation->state;
    state.past =
        lar_past_step(&simulation->domain, lar_division_of(&simulation->interactions), &state);
    return state;
}

void lar_element_fields(const lar_domain *domain, const lar_state *state, lar_gid e,
                        unsigned wanted, double value[LAR_CELL_FIELDS][6]) {
    const unsigned of_strain = 1U << LAR_CELL_STRAIN | 1U << LAR_CELL_VOLUME;
    if (wanted & ~of_strain) {
        double *cauchy = value[LAR_CELL_STRESS];
        value[LAR_CELL_ENERGY][0] = lar_measure_stress(domain, state, e, cauchy);
        value[LAR_CELL_VON_MISES][0] = lar_von_mises(cauchy);
        value[LAR_CELL_PRESSURE][0] = lar_mean_pressure(cauchy);
    }
    if (wanted & of_strain)
        value[LAR_CELL_VOLUME][0] = element_strain(domain, state, e, value[LAR_CELL_STRAIN]);
    for (int i = 0; i < LAR_CELL_FIELDS; i++)
        for (int k = 0; wanted >> i & 1 && k < lar_cell_field_table[i].components; k++)
            if (!isfinite(value[i][k])) value[i][k] = 0;
}

lar_status lar_simulation_stresses(const lar_simulation *simulation, double (*cauchy)[6],
                                   double (*strain)[6], lar_error *error) {
    lar_status status = lar_simulation_check_zero(simulation, "lar_simulation_stresses", error);
    if (status) return status;
    lar_simulation_state(simulation);
    const lar_state state = lar_state_measured(simulation);
    for (lar_gid e = 0; e < simulation->domain.model->mesh.element_count; e++) {
        if (cauchy) lar_measure_stress(&simulation->domain, &state, e, cauchy[e]);
        if (strain) element_strain(&simulation->domain, &state, e, strain[e]);
    }
    return LAR_OK;
}
