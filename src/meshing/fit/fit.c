/* The boundary of a staircase cannot simply be put onto a smooth surface: a cell at the edge of a
 * step has two faces there, three at its corner, and between faces in one plane its corner has no
 * volume. So faces are drawn to the boundary, in the mean over each, while an energy of the
 * elements' shape (quality.h) holds against it, steeply where it would get bad.
 *
 *     planes at the true boundary, from where faces and nodes are    target.c
 *     offsets of these planes, so that regions keep their volumes    volume.c
 *     some sweeps of Newton steps, node by node                      sweep.c
 *     the same again, watched, where outer faces cross               apart.c
 *     ... and again, until the nodes are still
 */
#include <math.h>

#include "meshing/fit/work.h"

/* Against 1 for a face that is one cell off the boundary. */
static const lar_fit_law usual = {.shape = 0.001, .steep = 1, .aim = 0.55, .floor = 0.25};
/* Of a slot: it may become thin and lean, but not turn inside out, where its walls would cross. */
static const lar_fit_law lenient = {.shape = 1e-4, .steep = 0.1, .aim = 0.2, .floor = 0.02};
static const double FACE_WEIGHT = 1, NODE_WEIGHT = 0.3;

/* Rounds of some sweeps each. From BALANCE on volumes are balanced; from STAND on the planes stand,
 * so that points of something thin, which are drawn to its one side now and to its other one then,
 * come to rest and volumes with them; several regions take longer. */
enum { ROUNDS = 15, ROUNDS_REGIONS = 18, BALANCE = 3, STAND = 9, ATTEMPTS = 4 };

static lar_status check_start(lar_fit_work *work, lar_error *error) {
    double part;
    const double min = lar_fit_min(work, work->law.floor, &part);
    if (!(min > 0))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "the grid that is to be fitted has an element without volume");
    work->law.floor = fmin(work->law.floor, 0.9 * min);
    work->law.aim = fmax(work->law.aim, work->law.floor);
    return LAR_OK;
}

/* A round's sweeps, until no outer faces cross; where they never cease to, as if there were none.
 */
static lar_status sweep_apart(lar_fit_work *work, lar_error *error) {
    lar_status status = lar_fit_apart_begin(work, error);
    bool again = true;
    work->record.sweep = 0;
    for (int attempt = 0; !status && again && attempt < ATTEMPTS; attempt++) {
        lar_fit_sweep_again(work);
        for (int sweep = 0; sweep < LAR_FIT_SWEEPS; sweep++)
            if (lar_fit_sweep(work) == 0) break;
        status = lar_fit_apart_check(work, &again, error);
    }
    return status;
}

static lar_status run(lar_fit_work *work, const lar_fit_options *options, lar_error *error) {
    for (int32_t n = 0; n < work->mesh->node_count; n++) work->awake[n] = true;
    const int rounds = work->boundary->region_count > 1 ? ROUNDS_REGIONS : ROUNDS;
    for (int round = 0; round < rounds; round++) {
        if (options && options->progress &&
            !options->progress(options->context, (double)round / rounds))
            return lar_fail(error, LAR_ERROR_ARGUMENT, "stopped while the mesh was fitted");
        if (round >= BALANCE) {
            lar_status status = lar_fit_volume_balance(work, 0.8, error);
            if (status != LAR_OK) return status;
        }
        if (round < STAND) lar_fit_targets_renew(work);
        lar_fit_wake_boundary(work);
        lar_status status = sweep_apart(work, error);
        if (status != LAR_OK) return status;
    }
    return LAR_OK;
}

lar_status lar_fit(const lar_boundary *boundary, lar_unfitted_mesh *unfitted,
                   const lar_fit_options *options, lar_error *error) {
    lar_fit_work work = {
        .law = usual, .slot_law = lenient, .face_weight = FACE_WEIGHT, .node_weight = NODE_WEIGHT};
    if (options && options->floor > 0) work.law.floor = options->floor;
    if (options && options->aim > 0) work.law.aim = options->aim;
    if (options) work.dropped = options->dropped;
    lar_status status = lar_fit_work_create(boundary, unfitted, &work, error);
    if (status == LAR_OK) status = check_start(&work, error);
    if (status == LAR_OK) status = lar_fit_targets_create(&work, error);
    if (status == LAR_OK) status = run(&work, options, error);
    for (int32_t n = 0; status == LAR_OK && n < unfitted->mesh.node_count; n++)
        for (int i = 0; i < 3; i++)
            unfitted->mesh.position[n][i] = work.origin[i] + work.size * work.x[n][i];
    lar_fit_work_clear(&work);
    return status;
}
