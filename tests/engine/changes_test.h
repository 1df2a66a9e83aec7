/* What the tests of changes during a run share (settings, parameters, forces, supports): a run that
 * is changed between its parts has the same bits on any grid, with any threads and set of
 * instructions, in processes, and through checkpoints; every joule is accounted for. */
#ifndef LAR_TESTS_ENGINE_CHANGES_TEST_H
#define LAR_TESTS_ENGINE_CHANGES_TEST_H

#include "engine/engine_test.h"
#include "engine/fleet_test.h"

typedef struct changed_run {
    lar_model *(*model)(void);                         /* the caller's */
    void (*change)(lar_simulation *simulation, int i); /* before the steps of part `i` */
    int parts, stride;                                 /* steps of a part, best an odd number */
    int grid_stride;                                   /* 1: all grids */
    bool divides;                                      /* changes divide steps */
    const char *path;                                  /* of a checkpoint */
} changed_run;

/* Parts first .. end - 1. */
static void run_changed(const changed_run *c, lar_simulation *simulation, int first, int end) {
    for (int i = first; i < end; i++) {
        c->change(simulation, i);
        advance(simulation, c->stride);
    }
}

/* The hash in the end, on one processor. */
static uint64_t changed_straight(const changed_run *c, const lar_model *model) {
    lar_simulation *simulation = start_with(model, lar_options_default());
    run_changed(c, simulation, 0, c->parts);
    uint64_t hash = lar_simulation_hash(simulation);
    assert_int_equal(lar_simulation_divided_steps(simulation, NULL) > 0, c->divides);
    lar_simulation_destroy(simulation);
    return hash;
}

static void check_changed_everywhere(const changed_run *c) {
    static const char *const grids[] = {NULL, "1x1x1", "2x1x1", "2x2x1", "2x2x3"};
    static const lar_isa isas[] = {LAR_ISA_C, LAR_ISA_AVX2, LAR_ISA_AVX512, LAR_ISA_AUTO};
    lar_model *model = c->model();
    uint64_t wanted = changed_straight(c, model);
    for (int grid = 0; grid < 5; grid += c->grid_stride)
        for (int threads = 1; threads <= (grid ? 2 : 1); threads++)
            for (int i = 0; i < 4; i++) {
                lar_options options = lar_options_default();
                options.grid = grids[grid];
                options.threads = threads;
                options.isa = isas[i];
                options.delays = (uint64_t)(3 + grid);
                lar_simulation *simulation = NULL;
                if (lar_simulation_create(model, &options, &simulation, NULL)) continue;
                run_changed(c, simulation, 0, c->parts);
                assert_int_equal(lar_simulation_hash(simulation), wanted);
                lar_simulation_destroy(simulation);
            }
    lar_model_destroy(model);
}

/* Also when they are asked for energies, and go back to a checkpoint. */
static void check_changed_in_processes(const changed_run *c) {
    lar_model *model = c->model();
    uint64_t wanted = changed_straight(c, model);
    for (int i = 0; i < 2; i++) {
        lar_options options = lar_options_default();
        fleet f;
        lar_energy e;
        options.grid = i ? "2x2x1" : "2x1x1";
        options.comm = i ? "tcp" : "shm";
        start_fleet(&f, model, options, i ? 4 : 2, NULL);
        run_changed(c, f.zero, 0, c->parts / 2);
        assert_int_equal(lar_simulation_save(f.zero, c->path, NULL), LAR_OK);
        run_changed(c, f.zero, c->parts / 2, c->parts);
        assert_int_equal(lar_simulation_hash(f.zero), wanted);
        lar_simulation_energy(f.zero, &e);
        assert_int_equal(lar_simulation_load(f.zero, c->path, NULL), LAR_OK);
        run_changed(c, f.zero, c->parts / 2, c->parts);
        assert_int_equal(lar_simulation_hash(f.zero), wanted);
        end_fleet(&f);
    }
    lar_model_destroy(model);
}

TEST_UNUSED static uint32_t changed_version(const char *path) {
    uint32_t head[4] = {0};
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fread(head, sizeof *head, 4, file), 4);
    fclose(file);
    return head[2];
}

/* Through checkpoints on disk and states in memory, taken up after every part on another grid,
 * where `other` has set something else before. `version`: which one the file must have; NULL: any.
 */
static void check_changed_goes_on(const changed_run *c, void (*other)(lar_simulation *simulation),
                                  uint32_t (*version)(const lar_simulation *simulation)) {
    lar_model *model = c->model();
    uint64_t wanted = changed_straight(c, model);
    for (int part = 1; part < c->parts; part++) {
        lar_options options = lar_options_default();
        lar_simulation *first = start_with(model, options);
        lar_saved *saved = NULL;
        lar_energy before, after;
        run_changed(c, first, 0, part);
        lar_simulation_energy(first, &before);
        assert_int_equal(lar_simulation_save(first, c->path, NULL), LAR_OK);
        if (version) assert_int_equal(changed_version(c->path), version(first));
        assert_int_equal(lar_saved_create(first, &saved, NULL), LAR_OK);
        assert_int_equal(lar_simulation_save_to(first, saved, NULL), LAR_OK);
        options.grid = "2x1x1";
        for (int memory = 0; memory < 2; memory++) {
            lar_simulation *second = start_with(model, options);
            other(second);
            advance(second, 5);
            assert_int_equal(memory ? lar_simulation_load_from(second, saved, NULL)
                                    : lar_simulation_load(second, c->path, NULL),
                             LAR_OK);
            lar_simulation_energy(second, &after);
            assert_below(fabs(after.strain - before.strain), 1e-12 * before.strain);
            assert_below(fabs(after.external - before.external), 1e-12 * before.strain);
            assert_below(fabs(after.damping - before.damping), 1e-12 * before.strain);
            run_changed(c, second, part, c->parts);
            assert_int_equal(lar_simulation_hash(second), wanted);
            lar_simulation_destroy(second);
        }
        lar_saved_destroy(saved);
        lar_simulation_destroy(first);
    }
    lar_model_destroy(model);
}

/* 2,000 steps that are changed after every twentieth, `i` times so far: by how much the account is
 * open at most, of the work that was done. */
TEST_UNUSED static double changed_account(lar_simulation *simulation,
                                          void (*change)(lar_simulation *simulation, int i)) {
    double worst = 0, work = 0;
    for (int i = 0; i < 100; i++) {
        lar_energy e;
        advance(simulation, 20);
        change(simulation, i);
        lar_simulation_energy(simulation, &e);
        worst = fmax(worst,
                     fabs(e.kinetic + e.strain + e.hourglass + e.damping + e.viscous - e.external));
        work = fmax(work, fabs(e.external));
    }
    print_message("%.2g of %.3g J\n", worst / work, work);
    return worst / work;
}

/* With a step that is `part` of what the model bears as it is. */
TEST_UNUSED static lar_simulation *start_near_limit(const lar_model *model, double part) {
    lar_simulation *simulation = start(model);
    lar_options options = lar_options_default();
    options.time_step = part * simulation->domain.stable_step;
    lar_simulation_destroy(simulation);
    return start_with(model, options);
}

#endif
