/* What the tests of checkpoints share. Who includes it says first where its checkpoint lies, as
 * PATH, for tests run side by side. */
#ifndef LAR_TESTS_CHECKPOINT_TEST_H
#define LAR_TESTS_CHECKPOINT_TEST_H

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include "simulation/checkpoint.h"
#include "engine/body_contact_test.h"
#include "engine/engine_test.h"
#include "engine/fleet_test.h"
#include "engine/tools_test.h"

static const char *const grids[] = {NULL, "2x1x1", "2x2x1", "1x2x3"};
static const char *const schemes[] = {NULL, "all", "local", "two"};
enum { GRIDS = 4 };

TEST_UNUSED static lar_options setting(int grid) {
    lar_options options = lar_options_default();
    options.grid = grids[grid];
    options.scheme = schemes[grid];
    options.threads = grid ? 1 + grid % 2 : 0;
    options.delays = grid ? (uint64_t)(17 + grid) : 0;
    options.hands = 1;
    return options;
}

TEST_UNUSED static void save(lar_simulation *simulation, const char *path) {
    lar_error error;
    if (lar_simulation_save(simulation, path, &error)) fail_msg("%s", error.message);
}

TEST_UNUSED static void load(lar_simulation *simulation, const char *path) {
    lar_error error;
    if (lar_simulation_load(simulation, path, &error)) fail_msg("%s", error.message);
}

TEST_UNUSED static lar_saved *save_to(const lar_simulation *simulation) {
    lar_saved *saved = NULL;
    lar_error error;
    if (lar_saved_create(simulation, &saved, &error) ||
        lar_simulation_save_to(simulation, saved, &error))
        fail_msg("%s", error.message);
    return saved;
}

TEST_UNUSED static void load_from(lar_simulation *simulation, const lar_saved *saved) {
    lar_error error;
    if (lar_simulation_load_from(simulation, saved, &error)) fail_msg("%s", error.message);
}

TEST_UNUSED static void reset(lar_simulation *simulation) {
    lar_error error;
    if (lar_simulation_reset(simulation, &error)) fail_msg("%s", error.message);
}

#endif
