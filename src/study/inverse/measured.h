/* What an experiment has measured: its table's columns, by the kind of the experiment.
 *
 *     tension, compression   time, displacement or stretch, force
 *     indentation            time, depth, force
 *     aspiration             time, r, z, pressure; or pressure in a table of its own: time,
 * pressure markers                x, y, z before; to_x, to_y, to_z after surface                x,
 * y, z
 *
 * `columns: {force: F_mess}` of the experiment says what a column is called in the table, and
 * `scale: {force: 0.001}` by what its numbers are multiplied to be SI. Lengths that do not fit the
 * scene's body are refused as what they nearly always are: another unit.
 */
#ifndef LAR_STUDY_INVERSE_MEASURED_H
#define LAR_STUDY_INVERSE_MEASURED_H

#include "model/scene/scene.h"
#include "study/inverse/problem.h"

/* Into `e`, whose kind, files, model and `in_time` stand already. `node` is the experiment in the
 * file that `scene` reads. */
lar_status lar_inverse_measured_read(const lar_scene *scene, const lar_yaml *node,
                                     lar_inverse_experiment *e);

#endif
