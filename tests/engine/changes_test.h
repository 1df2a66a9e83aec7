/* A run that is changed between its parts (settings, forces): the same bits on any grid, with any
 * threads and set of instructions, and in processes. */
#ifndef LAR_TESTS_ENGINE_CHANGES_TEST_H
#define LAR_TESTS_ENGINE_CHANGES_TEST_H

#include "engine/engine_test.h"
#include "engine/fleet_test.h"

typedef struct changed_run {
    lar_model *(*model)(void);                                   /* the caller's */
    void (*run)(lar_simulation *simulation, int first, int end); /* parts, with their changes */
    int parts;
    int grid_stride;  /* 1: all grids */
    bool divides;     /* changes divide steps */
    const char *path; /* of a checkpoint */
} changed_run;

/* The hash in the end, on one processor. */
static uint64_t changed_straight(const changed_run *c, const lar_model *model) {
    lar_simulation *simulation = start_with(model, lar_options_default());
    c->run(simulation, 0, c->parts);
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
                c->run(simulation, 0, c->parts);
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
        c->run(f.zero, 0, c->parts / 2);
        assert_int_equal(lar_simulation_save(f.zero, c->path, NULL), LAR_OK);
        c->run(f.zero, c->parts / 2, c->parts);
        assert_int_equal(lar_simulation_hash(f.zero), wanted);
        lar_simulation_energy(f.zero, &e);
        assert_int_equal(lar_simulation_load(f.zero, c->path, NULL), LAR_OK);
        c->run(f.zero, c->parts / 2, c->parts);
        assert_int_equal(lar_simulation_hash(f.zero), wanted);
        end_fleet(&f);
    }
    lar_model_destroy(model);
}

#endif
