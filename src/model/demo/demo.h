/* The demonstration organ: a uterus with tubes, ovaries and ligaments.
 *
 * It stands for the organ of the thesis (T 3.2.2, figures 2.5 and 3.6): 1840 hexahedra, about 12 cm
 * from left to right. Its 2,567 nodes lie within 2 % of the thesis's 2,528. How it is made is in
 * demo_parts.h; lar_demo_write (lariat.h) writes it with its scenes (demo_scene.h).
 *
 * Axes, as in DICOM: x to the patient's left, y to the back, z up; the cervix stands on z = 0.
 * Cell tags 1..4 and element sets: uterus, tubes, ovaries, ligaments.
 * Node sets: cervix, ligament_ends, ligament_end_left, ligament_end_right (to hold), fundus (to
 * pull), posterior (a patch of the back), ovary_left, ovary_right.
 */
#ifndef LAR_MODEL_DEMO_DEMO_H
#define LAR_MODEL_DEMO_DEMO_H

#include <stdbool.h>

#include "model/demo/demo_scene.h"
#include "model/mesh/mesh.h"

enum { LAR_DEMO_ELEMENTS = 1840 };

/* Fills a zeroed mesh, in metres; the same bits on every machine. The caller clears it, also on
 * failure. Fails only without memory. */
lar_status lar_demo_mesh(lar_mesh *mesh, lar_error *error);

/* lar_demo_write (lariat.h), which says also which scenes were there, differ and stay as they are;
 * with `force` all are written. */
lar_status lar_demo_write_beside(const char *folder, bool force, bool kept[LAR_DEMO_SCENES],
                                 lar_error *error);

#endif
