/* How good a mesh is, told to people and to machines: what `lariat mesh` and `lariat info` share.
 */
#ifndef LAR_CLI_REPORT_MESH_QUALITY_H
#define LAR_CLI_REPORT_MESH_QUALITY_H

#include "base/json/write.h"
#include "lariat.h"
#include "study/real_time.h"

/* A length and a volume in the unit that suits them, "6.08 mm", "1126 mL". */
typedef struct cli_measure {
    char text[40];
} cli_measure;
cli_measure cli_length(double metres);
cli_measure cli_volume(double cubic_metres);

/* A small chart of the elements by scaled Jacobian, and the shares above 0.2 and 0.5. */
void cli_print_jacobians(const lar_mesh_quality *quality);
/* Volumes and distances to the true surface; nothing where there is none. */
void cli_print_deviation(const lar_mesh_quality *quality);
/* Outer faces that go through each other, or that there are none. */
void cli_print_crossings(const lar_mesh_quality *quality);
void cli_write_quality(lar_json *json, const lar_mesh_quality *quality);

/* The model's speed on this machine, or why it has none. */
typedef struct cli_speed {
    bool measured;
    lar_real_time found;
    lar_error why;
} cli_speed;

cli_speed cli_measure_speed(const lar_model *model);
void cli_print_speed(const cli_speed *speed);
void cli_write_speed(lar_json *json, const cli_speed *speed);

#endif
