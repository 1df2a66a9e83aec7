/* What `lariat mesh` says of what it made. */
#ifndef LAR_CLI_REPORT_MESH_H
#define LAR_CLI_REPORT_MESH_H

#include "cli/report/mesh_quality.h"
#include "cli/report/mesh_shape.h"
#include "study/label_list.h"

typedef struct mesh_report {
    const lar_meshing *meshing;
    lar_meshing_info info;
    const char *scene;    /* as written */
    lar_model_info model; /* of that scene */
    cli_speed speed;
    double seconds;           /* that meshing took */
    mesh_shape mesh, surface; /* of a single region */
} mesh_report;

void mesh_report_table(const mesh_report *report);
void mesh_report_json(const mesh_report *report);

/* The labels of an image, to a stream. */
void mesh_report_labels(const char *path, const lar_label_list *list, FILE *out);
void mesh_report_labels_json(const char *path, const lar_label_list *list);

#endif
