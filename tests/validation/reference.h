/* What the validation tests share: the reference solutions of other programs, and bodies brought to
 * rest under a load.
 *
 * The reference data (meshes, tips, fields computed with CalculiX and FEBio, a measured experiment)
 * stands beside the checkout and is not part of the project; every test says "skipped: no shared
 * data" where it is missing. Static answers are found by running with mass-proportional damping
 * near critical for the slowest mode until the kinetic energy is negligible. Every figure that a
 * test looks at is also printed as one line
 *
 *     case | element | mesh | quantity | reference | ours | difference | hourglass | steps |
 * seconds
 *
 * from which docs/validation.md is made.
 */
#ifndef LAR_TESTS_VALIDATION_REFERENCE_H
#define LAR_TESTS_VALIDATION_REFERENCE_H

#include "model/model.h"
#include "simulation/simulation.h"
#include "testing.h"

/* ---- reference data ----------------------------------------------------------------------- */

/* False, after saying so, when the data is not there. */
bool reference_present(void);

/* Skips the test when the data is not there. */
#define NEED_REFERENCE()                                                                           \
    do {                                                                                           \
        if (!reference_present()) skip();                                                          \
    } while (0)

/* A file below the data's folder, in a buffer that the next call overwrites. */
const char *reference_path(const char *relative);

/* A model of the mesh `name` ("c_beam_40x4x4"), coordinates times `scale`, of one material. */
lar_model *reference_model(const char *name, double scale, double shear, double bulk,
                           double density);

/* The number behind "key=" in the line of static.tsv for case, element and load level t. Fails the
 * test when there is none. */
double reference_value(const char *name, const char *element, double t, const char *key);

/* Displacements [m] of a file in fields/, in node order, coordinates times `scale`. */
void reference_field(const char *file, double scale, int32_t nodes, double (*u)[3]);

/* ---- parts of a model --------------------------------------------------------------------- */

/* Nodes whose coordinate along `axis` is `at` (within 1e-9 of the body's size). */
lar_node_list nodes_at(const lar_model *model, int axis, double at);
/* The node nearest to a point. */
int32_t node_near(const lar_model *model, double x, double y, double z);

void fix_nodes(lar_model *model, lar_node_list nodes, unsigned axes);
void move_nodes_by(lar_model *model, lar_node_list nodes, unsigned axes, double by, int curve);
/* A smooth ramp from `from` to `to`, starting at `time`; returns its index. */
int add_ramp(lar_model *model, double time, double over, double from, double to);
/* The same curve again, for the next load level. */
void set_ramp(lar_model *model, int curve, double time, double over, double from, double to);

/* ---- running ------------------------------------------------------------------------------ */

lar_simulation *start(lar_model *model, lar_element_kind element);
/* Runs until `until` [s] of simulated time. */
void run_until(lar_simulation *simulation, double until);
/* Runs on until the kinetic energy stays below `share` of the strain energy for a time of
 * 1 / damping, and fails the test when that takes longer than `longest` [s]. */
void run_to_rest(lar_simulation *simulation, double share, double longest);
/* Displacement of a node [m]. */
double displacement(const lar_simulation *simulation, int32_t node, int axis);
/* Sets the displacements of all nodes; velocities become zero. */
void set_displacements(lar_simulation *simulation, double (*u)[3]);
/* Hourglass energy over strain energy. */
double hourglass_share(const lar_simulation *simulation);

/* Remembers the start of a run, for the time in the report. */
void begin_report(void);
/* Prints the line; returns the relative difference |ours - reference| / |reference|. */
double report(const char *name, const char *element, const char *mesh, const char *quantity,
              double reference, double ours, const lar_simulation *simulation);

#define assert_within(difference, bound)                                                           \
    do {                                                                                           \
        double value_ = (difference), bound_ = (bound);                                            \
        if (!(value_ <= bound_))                                                                   \
            fail_msg("%s is %.4g%%, more than %.4g%%", #difference, 100 * value_, 100 * bound_);   \
    } while (0)

#endif
