/* What is wrong with contacts and tools, in one sentence; the reader adds the place in the file.
 *
 * A run that begins with one thing inside another begins with energy from nowhere: contact would
 * throw the two apart. So what overlaps at rest is refused here, before it is computed.
 *
 *     contact_check.c  lists of faces, planes, sizes, names
 *     tool_gap.c       how far a tool is from the surface at rest
 */
#ifndef LAR_MODEL_CONTACT_CHECK_H
#define LAR_MODEL_CONTACT_CHECK_H

#include <stdbool.h>

#include "model/model.h"

enum { LAR_PROBLEM_SIZE = 400 };

/* Each returns true when something is wrong, and has then written the sentence. model->surface is
 * there. Faces are listed in ascending order, each once. */
bool lar_face_list_problem(const lar_model *model, const int32_t *face, int32_t count,
                           char problem[LAR_PROBLEM_SIZE]);
bool lar_contact_problem(const lar_model *model, const lar_contact *contact,
                         char problem[LAR_PROBLEM_SIZE]);
bool lar_tool_name_problem(const char *name, char problem[LAR_PROBLEM_SIZE]);
bool lar_tool_problem(const lar_model *model, const lar_tool *tool, char problem[LAR_PROBLEM_SIZE]);
/* False: radians were written for degrees, or the other way round, and jaws are always closed. */
bool lar_tool_jaws_part(const lar_tool *tool);
/* Of its shape, size and pose alone; NULL: nothing. */
const char *lar_tool_size_problem(const lar_tool *tool);

/* What lies on or at something may be inside it by so much, from rounding [m]. */
double lar_overlap_rounding(const lar_mesh *mesh);

/* Distance from the tool's surface to the surface at rest [m]: negative when they overlap, also
 * when the tool lies inside a body. `face` is the index into model->surface of the face next to it.
 */
double lar_tool_gap(const lar_model *model, const lar_tool *tool, int32_t *face);

/* What is wrong with Coulomb's coefficient of a plane or a tool; NULL: nothing. */
const char *lar_friction_problem(double friction);

/* Of planes with restitution, once all tools are known. */
bool lar_restitution_problem(const lar_model *model, char problem[LAR_PROBLEM_SIZE]);

#endif
