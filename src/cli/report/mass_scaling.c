#include "cli/report/mass_scaling.h"

#include <inttypes.h>

void cli_write_mass_scaling(lar_json *json, const lar_model *model, const lar_mass_scaling *m) {
    lar_json_open(json, "mass_scaling", '{');
    lar_json_number(json, "time_step", m->time_step);
    lar_json_number(json, "largest_share", m->largest_share);
    lar_json_integer(json, "elements", m->elements);
    lar_json_number(json, "added", m->added);
    lar_json_number(json, "share", m->share);
    lar_json_number(json, "largest_factor", m->factor);
    lar_json_integer(json, "largest_factor_element",
                     m->elements > 0 ? lar_model_element_id(model, m->worst) : -1);
    lar_json_number(json, "stable_step_without", m->stable_step);
    lar_json_number(json, "possible_step", m->possible_step);
    lar_json_number(json, "slowing", m->slowing);
    lar_json_number(json, "strained_share", m->strained_share);
    lar_json_close(json);
}

void cli_print_mass_scaling(const lar_model *model, const lar_mass_scaling *m, bool offers,
                            FILE *out) {
    if (m->elements > 0) {
        fprintf(out,
                "%-17s%d elements, %.3g kg, %.3g %% of the mass; %.4g times the mass of element "
                "%" PRId64 "\n",
                "mass added", (int)m->elements, m->added, 100 * m->share, m->factor,
                lar_model_element_id(model, m->worst));
        fprintf(out,
                "%-17sstable up to %.4g s without it; slow motions: frequencies lower by up to "
                "%.2g %%\n",
                "", m->stable_step, 100 * m->slowing);
    } else if (m->time_step > 0) {
        fprintf(out, "%-17snone: all elements are stable up to %.4g s as they are\n", "mass added",
                m->stable_step);
    } else if (offers) {
        fprintf(out, "%-17snone; with up to %g %% (mass_scaling) stable up to %.3g s\n",
                "mass added", 100 * m->largest_share, 0.994 * m->possible_step);
    }
    if (offers && m->strained_share > 0)
        fprintf(out, "%-17sup to %g %% of the mass, for elements that are strained\n", "",
                100 * m->strained_share);
}

void cli_write_heavier(lar_json *json, const lar_simulation *simulation) {
    lar_heavier heavier;
    lar_simulation_heavier(simulation, &heavier);
    lar_json_open(json, "heavier", '{');
    lar_json_integer(json, "elements", heavier.elements);
    lar_json_number(json, "share", heavier.share);
    lar_json_number(json, "mean_share", heavier.mean_share);
    lar_json_number(json, "largest_share", heavier.largest_share);
    lar_json_close(json);
}

void cli_print_heavier(const lar_simulation *simulation, FILE *out) {
    lar_heavier heavier;
    lar_simulation_heavier(simulation, &heavier);
    if (heavier.largest_share > 0)
        fprintf(out,
                "%-17sstrained elements by %.2g %% of the mass on average, by %.2g %% at most; "
                "now %d element%s by %.2g %%\n",
                "heavier", 100 * heavier.mean_share, 100 * heavier.largest_share,
                (int)heavier.elements, heavier.elements == 1 ? "" : "s", 100 * heavier.share);
}
