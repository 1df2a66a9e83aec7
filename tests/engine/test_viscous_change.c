/* Parameters of what relaxes, set while it is strained: no strain of it. What has relaxed stays so,
 * moduli that are all multiplied are a stiffness, who was strained at once has what it would have
 * had with the new parameters, and springs of Maxwell elements are paid for. */
#include "engine/engine_test.h"
#include "step/viscous_history.h"

static const brick pair = {{2, 1, 1}, 0.01, 0, LAR_LAW_neo_hookean, 1e3, 2e4, 1000};

/* Everything that can be set of it. */
typedef struct tissue {
    lar_law law;
    bool isochoric, fibrous;
    int terms;
    double time; /* of the first term [s] */
} tissue;

static const tissue tissues[] = {
    {LAR_LAW_neo_hookean, true, false, 1, 0.02}, {LAR_LAW_neo_hookean, false, false, 2, 0.02},
    {LAR_LAW_neo_hookean, true, true, 1, 0.02},  {LAR_LAW_ogden, true, true, 6, 0.02},
    {LAR_LAW_yeoh, false, true, 3, 0.02},        {LAR_LAW_mooney_rivlin, true, false, 2, 0.02}};
enum { TISSUES = sizeof tissues / sizeof *tissues };

static lar_model *tissue_model(const tissue *t) {
    static const double share[] = {4, 0.9, 0.3, 0.2, 0.4, 0.1}, longer[] = {1, 0.3, 8, 2, 0.5, 20};
    brick b = pair;
    b.law = t->law;
    lar_model *model = brick_model(&b);
    lar_material *m = &model->material[0];
    m->viscosity = (lar_viscosity){.terms = t->terms, .isochoric = t->isochoric, .rest = 1};
    for (int i = 0; i < t->terms; i++) {
        m->viscosity.share[i] = share[i];
        m->viscosity.time[i] = longer[i] * t->time;
    }
    if (!t->fibrous) return model;
    m->fibre =
        (lar_fibre){.law = LAR_FIBRE_HGO, .isochoric = t->isochoric, .parameter = {1e3, 0.5, 0.05}};
    if (!t->isochoric) m->fibre = (lar_fibre){.law = LAR_FIBRE_EXP_POW, .parameter = {800, 1, 2}};
    model->mesh.fibre = lar_calloc(2, sizeof *model->mesh.fibre);
    for (int e = 0; e < 2; e++) model->mesh.fibre[e][0] = 1;
    return model;
}

/* All nodes are moved: pulled by a fifth along x, thinner across, and sheared by `shear`. */
static void pull(lar_model *model, double shear, int points, const double (*point)[2]) {
    int curve = add_table(model, LAR_CURVE_LINEAR, points, point);
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        const double *x = model->mesh.position[n];
        const double by[3] = {0.2 * x[0] + shear * x[1], -0.08 * x[1], -0.08 * x[2]};
        for (int i = 0; i < 3; i++) {
            if (by[i] == 0)
                fix_nodes(model, single_node(n), 1U << i);
            else
                move_nodes(model, single_node(n), 1U << i, by[i], curve);
        }
    }
    model->time_step = 1e-4;
}

/* On which processors, by which kernels. */
static const struct {
    const char *grid;
    lar_isa isa;
} places[] = {{NULL, LAR_ISA_C},       {NULL, LAR_ISA_AUTO},    {"1x1x1", LAR_ISA_C},
              {"1x1x1", LAR_ISA_AUTO}, {"2x1x1", LAR_ISA_AUTO}, {"2x1x1", LAR_ISA_C}};

static lar_simulation *start_at(const lar_model *model, int place) {
    lar_options options = lar_options_default();
    options.grid = places[place].grid;
    options.isa = places[place].isa;
    return start_with(model, options);
}

static void set(lar_simulation *simulation, const char *name, double value) {
    lar_error error;
    if (lar_simulation_set_parameter(simulation, 0, name, value, &error))
        fail_msg("%s", error.message);
}

static void set_times(lar_simulation *simulation, const char *name, double times) {
    set(simulation, name, times * lar_simulation_parameter(simulation, 0, name));
}

/* All moduli. */
static void scale(lar_simulation *simulation, double times) {
    const lar_material *m = &simulation->domain.model->material[0];
    const lar_law_row *law = &lar_law_table[m->law];
    char name[64];
    for (int k = 0; k < law->count; k++)
        if (lar_law_scales(m->law, k)) set_times(simulation, law->parameter[k].name, times);
    for (int k = 0; k < LAR_FIBRE_PARAMETERS && m->fibre.law != LAR_FIBRE_NONE; k++)
        if (lar_fibre_scales(m->fibre.law, k)) {
            snprintf(name, sizeof name, "fibres.%s", lar_parameter_name(m, LAR_LAW_PARAMETERS + k));
            set_times(simulation, name, times);
        }
}

static void stresses(lar_simulation *simulation, double cauchy[6]) {
    lar_state state = *lar_simulation_state(simulation);
    state.past =
        lar_past_step(&simulation->domain, lar_division_of(&simulation->interactions), &state);
    lar_measure_stress(&simulation->domain, &state, 1, cauchy);
}

/* By how much stresses differ, of the largest. */
static double apart(const double a[6], double times, const double b[6]) {
    double most = 0, largest = 0;
    for (int k = 0; k < 6; k++) {
        most = fmax(most, fabs(a[k] - times * b[k]));
        largest = fmax(largest, fabs(times * b[k]));
    }
    return most / largest;
}

static double all_of(const lar_energy *e) {
    return e->kinetic + e->strain + e->hourglass + e->damping + e->contact + e->viscous;
}

static double viscous(const lar_simulation *simulation) {
    lar_energy e;
    lar_simulation_energy(simulation, &e);
    return e.viscous;
}

/* ---- stress --------------------------------------------------------------------------------- */

static const double held[3][2] = {{0, 0}, {0.002, 1}, {9, 1}};

static void what_has_relaxed_stays_relaxed(void **unused) {
    (void)unused;
    for (int i = 0; i < TISSUES; i++) {
        tissue t = tissues[i];
        t.terms = 1;
        lar_model *model = tissue_model(&t);
        pull(model, 0, 3, held);
        for (int place = 0; place < 6; place++) {
            lar_simulation *simulation = start_at(model, place);
            double before[6], at_once[6], soon[6], later[6];
            advance(simulation, 8000);
            stresses(simulation, before);
            scale(simulation, 2);
            stresses(simulation, at_once);
            advance(simulation, 1);
            stresses(simulation, soon);
            advance(simulation, 4000);
            stresses(simulation, later);
            assert_below(apart(at_once, 2, before), 1e-9);
            assert_below(apart(soon, 2, before), 1e-9);
            assert_below(apart(later, 2, before), 1e-9);
            lar_simulation_destroy(simulation);
        }
        lar_model_destroy(model);
    }
}

/* One parameter of many: at once what it is in the end. Active fibres stay as active as they are.
 */
static void one_parameter_is_no_strain(void **unused) {
    (void)unused;
    static const char *const names[] = {"shear_modulus", "fibres.k1", "fibres.k2"};
    for (int k = 0; k < 6; k++) {
        lar_model *model = tissue_model(&tissues[2]);
        if (k > 2) model->material[0].fibre.along = 500;
        pull(model, 0.1, 3, held);
        lar_simulation *simulation = start_at(model, k);
        double before[6], at_once[6], later[6];
        advance(simulation, 8000);
        stresses(simulation, before);
        set_times(simulation, names[k % 3], 1.9);
        stresses(simulation, at_once);
        advance(simulation, 4000);
        stresses(simulation, later);
        assert_below(apart(at_once, 1, later), 1e-9);
        assert_true(apart(at_once, 1, before) > 1e-3);
        finish(simulation, model);
    }
}

/* In the middle of relaxing, sheared besides. */
static void moduli_times_a_factor_are_a_stiffness(void **unused) {
    (void)unused;
    for (int i = 0; i < TISSUES; i++) {
        lar_model *model = tissue_model(&tissues[i]);
        pull(model, 0.15, 3, held);
        for (int place = 0; place < 6; place++)
            for (int softer = 0; softer < 2; softer++) {
                lar_simulation *by_parts = start_at(model, place), *whole = start_at(model, place);
                double one[6], other[6];
                advance(by_parts, 150);
                advance(whole, 150);
                scale(by_parts, softer ? 0.4 : 1.7);
                assert_int_equal(lar_simulation_set_stiffness(whole, 0, softer ? 0.4 : 1.7, NULL),
                                 LAR_OK);
                for (int n = 0; n < 4; n++) {
                    stresses(by_parts, one);
                    stresses(whole, other);
                    assert_below(apart(one, 1, other), 1e-9);
                    advance(by_parts, 1 + (uint64_t)n * n * 50);
                    advance(whole, 1 + (uint64_t)n * n * 50);
                }
                lar_simulation_destroy(by_parts);
                lar_simulation_destroy(whole);
            }
        lar_model_destroy(model);
    }
}

/* Whatever is set first. */
static void the_order_counts_for_nothing(void **unused) {
    (void)unused;
    double one[6], other[6];
    lar_model *model = tissue_model(&tissues[2]);
    pull(model, 0.15, 3, held);
    for (int back = 0; back < 2; back++) {
        lar_simulation *simulation = start(model);
        advance(simulation, 150);
        set_times(simulation, back ? "fibres.k1" : "shear_modulus", 1.8);
        if (back) set_times(simulation, "fibres.k1", 0.5);
        set_times(simulation, back ? "shear_modulus" : "fibres.k1", back ? 1.8 : 0.9);
        stresses(simulation, back ? other : one);
        lar_simulation_destroy(simulation);
    }
    assert_below(apart(one, 1, other), 1e-7);
    lar_model_destroy(model);
}

/* ---- energy --------------------------------------------------------------------------------- */

/* Strained within a thousandth of a term's time: dampers have not moved, springs hold all. Then
 * stress and energy are those of a body that had the new parameters from the start. */
static void who_was_strained_at_once_has_what_it_would_have(void **unused) {
    (void)unused;
    for (int i = 0; i < TISSUES; i++)
        for (int k = 0; k < 4; k++) {
            tissue t = tissues[i];
            t.time = 20;
            lar_model *model = tissue_model(&t);
            const lar_material *m = &model->material[0];
            const char *name = lar_law_table[m->law].parameter[0].name;
            if (t.fibrous && k > 1) name = t.isochoric ? "fibres.k1" : "fibres.ksi";
            pull(model, 0.1, 3, held);
            lar_simulation *changed = start(model), *fresh = start(model);
            double one[6], other[6], times = k % 2 ? 0.4 : 2.5;
            set_times(fresh, name, times);
            advance(fresh, 30);
            advance(changed, 30);
            set_times(changed, name, times);
            stresses(changed, one);
            stresses(fresh, other);
            print_message("%s %s x %g: stress %.1e, springs %.1e\n", lar_law_name[m->law], name,
                          times, apart(one, 1, other), viscous(changed) / viscous(fresh) - 1);
            assert_below(apart(one, 1, other), 5e-3);
            assert_below(fabs(viscous(changed) / viscous(fresh) - 1), 5e-3);
            lar_simulation_destroy(changed);
            finish(fresh, model);
        }
}

/* Stretched slowly or suddenly, held or not, changed, and let go within a tenth of the term's time:
 * no more comes back than was given, and the account stays closed. */
static void nothing_comes_from_nothing(void **unused) {
    (void)unused;
    static const double rise[] = {0.4, 0.002}, hold[] = {0.2, 0.003}, times[] = {2.5, 0.3};
    for (int i = 0; i < TISSUES; i++)
        for (int k = 0; k < 8; k++) {
            double up = rise[k & 1], end = up + hold[k >> 1 & 1];
            const double way[5][2] = {{0, 0}, {up, 1}, {end, 1}, {end + 0.002, 0}, {9, 0}};
            lar_model *model = tissue_model(&tissues[i]);
            pull(model, 0, 5, way);
            lar_simulation *simulation = start_at(model, k % 6);
            lar_energy before, after, last;
            advance(simulation, (uint64_t)lround((end - 0.001) / 1e-4));
            lar_simulation_energy(simulation, &before);
            scale(simulation, times[k >> 2]);
            lar_simulation_energy(simulation, &after);
            advance(simulation, 4000);
            lar_simulation_energy(simulation, &last);
            assert_true(last.viscous > 0 && after.viscous > 0);
            assert_below(last.strain, 1e-9 * before.strain);
            double open = all_of(&last) - last.external - (all_of(&before) - before.external);
            assert_below(fabs(open), 3e-3 * all_of(&last));
            assert_below(fabs(all_of(&after) - after.external - all_of(&before) + before.external),
                         1e-9 * before.strain);
            if ((k & 3) == 0 &&
                tissues[i].terms <
                    3) { /* it had relaxed: springs held nothing, and take all of it */
                assert_below(fabs(after.viscous - before.viscous), 1e-6 * before.viscous);
                assert_true(last.viscous > after.viscous + after.strain);
            }
            finish(simulation, model);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_has_relaxed_stays_relaxed),
        cmocka_unit_test(one_parameter_is_no_strain),
        cmocka_unit_test(moduli_times_a_factor_are_a_stiffness),
        cmocka_unit_test(the_order_counts_for_nothing),
        cmocka_unit_test(who_was_strained_at_once_has_what_it_would_have),
        cmocka_unit_test(nothing_comes_from_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
