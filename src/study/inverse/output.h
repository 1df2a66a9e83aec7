/* What a fit leaves: a tissue file that scenes take (`tissue: FILE`), and a picture of every
 * experiment. */
#ifndef LAR_STUDY_INVERSE_OUTPUT_H
#define LAR_STUDY_INVERSE_OUTPUT_H

#include "study/inverse/inverse.h"

/* The tissue file of one fitted material, whole or not at all: law and parameters as scenes have
 * them, and in comments where they are from and how well they are known. */
lar_status lar_inverse_write_tissue(const char *path, const lar_inverse_problem *problem,
                                    const lar_inverse_result *result, const char *material,
                                    lar_error *error);

/* Measured numbers and the model's over the way, time or number of experiment k, as .svg. */
lar_status lar_inverse_write_svg(const char *path, const lar_inverse_problem *problem,
                                 const lar_inverse_result *result, int k, lar_error *error);

/* All that `lariat fit --out` leaves in a folder, which is made where it is missing:
 * MATERIAL.tissue.yaml of each material, K_NAME.svg of each experiment and fit.json. What is no
 * letter or digit in a name, and no hyphen, is _ in that of the file. */
lar_status lar_inverse_write_folder(const char *folder, const lar_inverse_problem *problem,
                                    const lar_inverse_result *result, lar_error *error);

/* The answer as lar_inverse_json has it, whole or not at all. */
lar_status lar_inverse_write_json(const char *path, const lar_inverse_problem *problem,
                                  const lar_inverse_result *result, lar_error *error);

/* The first parameter of each fitted material: j is one whose material no earlier one has. */
bool lar_inverse_first_of_material(const lar_inverse_problem *problem, int j);

#endif
