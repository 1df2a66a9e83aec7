#include "cli/report/mesh.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "cli/options.h"

/* ---- for machines ---------------------------------------------------------------------------- */

static void write_regions(lar_json *json, const mesh_report *report) {
    lar_region_info region;
    lar_json_open(json, "regions", '[');
    for (int32_t r = 0; !lar_meshing_region(report->meshing, r, &region, NULL); r++) {
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "name", region.name);
        lar_json_integer(json, "tag", region.tag);
        lar_json_integer(json, "elements", region.elements);
        lar_json_number(json, "volume", region.volume);
        lar_json_number(json, "true_volume", region.true_volume);
        lar_json_text(json, "tissue", region.tissue);
        lar_json_text(json, "source", region.source);
        lar_json_number(json, "shear_modulus", region.shear_modulus);
        lar_json_number(json, "bulk_modulus", region.bulk_modulus);
        lar_json_number(json, "density", region.density);
        lar_json_boolean(json, "held", region.held != 0);
        lar_json_close(json);
    }
    lar_json_close(json);
}

void mesh_report_json(const mesh_report *report) {
    const lar_meshing_info *info = &report->info;
    lar_json json = lar_json_to(stdout);
    lar_json_text(&json, "scene", report->scene);
    lar_json_text(&json, "title", info->title);
    lar_json_integer(&json, "elements", info->elements);
    lar_json_integer(&json, "nodes", info->nodes);
    lar_json_number(&json, "size", info->size);
    write_regions(&json, report);
    lar_json_open(&json, "cleaning", '{');
    lar_json_integer(&json, "islands", info->islands);
    lar_json_integer(&json, "island_cells", info->island_cells);
    lar_json_integer(&json, "pinholes", info->pinholes);
    lar_json_integer(&json, "pinhole_cells", info->pinhole_cells);
    lar_json_integer(&json, "added", info->added);
    lar_json_integer(&json, "removed", info->removed);
    lar_json_close(&json);
    lar_json_integer(&json, "parted", info->parted);
    lar_json_integer(&json, "cuts", info->cuts);
    if (info->regions == 1) {
        lar_json_open(&json, "holes", '{');
        lar_json_integer(&json, "mesh", report->mesh.holes);
        lar_json_integer(&json, "surface", report->surface.holes);
        lar_json_close(&json);
    }
    lar_json_text(&json, "fix", info->fix);
    lar_json_integer(&json, "pads", info->extra_supports);
    lar_json_integer(&json, "fixed_nodes", info->fixed_nodes);
    lar_json_open(&json, "scaled_jacobian", '{');
    lar_json_number(&json, "min", report->model.scaled_jacobian_min);
    lar_json_number(&json, "mean", report->model.scaled_jacobian_mean);
    lar_json_close(&json);
    cli_write_quality(&json, &info->quality);
    lar_json_number(&json, "shortest_edge", report->model.shortest_edge);
    lar_json_number(&json, "stable_step", report->model.stable_step);
    lar_json_number(&json, "time_step", report->model.time_step);
    cli_write_speed(&json, &report->speed);
    lar_json_number(&json, "seconds", report->seconds);
    lar_json_end(&json);
}

void mesh_report_labels_json(const char *path, const lar_label_list *list) {
    lar_json json = lar_json_to(stdout);
    lar_json_text(&json, "file", path);
    lar_json_integers(&json, "voxels", list->size, 3);
    lar_json_open(&json, "labels", '[');
    for (int32_t i = 0; i < list->count; i++) {
        const lar_label_row *row = &list->row[i];
        lar_json_open(&json, NULL, '{');
        lar_json_integer(&json, "label", row->label);
        lar_json_text(&json, "name", row->name ? row->name : "");
        lar_json_integer(&json, "voxels", row->voxels);
        lar_json_number(&json, "volume", (double)row->voxels * list->voxel);
        lar_json_close(&json);
    }
    lar_json_end(&json);
}

/* ---- for people ------------------------------------------------------------------------------ */

void mesh_report_labels(const char *path, const lar_label_list *list, FILE *out) {
    fprintf(out,
            "%s: %d x %d x %d voxels of %.4g x %.4g x %.4g mm, %d label%s\n"
            "%7s  %-36s%12s%12s\n",
            path, (int)list->size[0], (int)list->size[1], (int)list->size[2], 1e3 * list->edge[0],
            1e3 * list->edge[1], 1e3 * list->edge[2], (int)list->count, list->count == 1 ? "" : "s",
            "label", "name", "voxels", "mL");
    for (int32_t i = 0; i < list->count; i++) {
        const lar_label_row *row = &list->row[i];
        fprintf(out, "%7d  %-36s%12" PRId64 "%12.4g\n", (int)row->label, row->name ? row->name : "",
                row->voxels, 1e6 * (double)row->voxels * list->voxel);
    }
}

static void print_regions(const mesh_report *report) {
    enum { SHOWN = 30 };
    lar_region_info r;
    for (int32_t i = 0; i < SHOWN && !lar_meshing_region(report->meshing, i, &r, NULL); i++) {
        printf("%-17s%s (%d): ", i ? "" : "regions", r.name, (int)r.tag);
        if (r.elements > 0)
            printf("%d elements, %s (%+.2f %%), as %s\n", (int)r.elements,
                   cli_volume(r.volume).text, 100 * (r.volume / r.true_volume - 1), r.tissue);
        else if (r.true_volume > 0)
            printf("left out: %s are too little for elements of this size\n",
                   cli_volume(r.true_volume).text);
        else
            printf("left out: a later surface covers all of it; name the outer one first\n");
    }
    if (report->info.regions > SHOWN)
        printf("%-17sand %d more (--json lists all)\n", "", (int)(report->info.regions - SHOWN));
}

static void print_cleaning(const lar_meshing_info *info) {
    const char *label = "cleaned";
    if (info->islands > 0)
        printf("%-17s%d loose piece%s left out (%d cells)\n", label, (int)info->islands,
               info->islands == 1 ? "" : "s", (int)info->island_cells);
    if (info->islands > 0) label = "";
    if (info->pinholes > 0) {
        printf("%-17s%d small hollow%s filled", label, (int)info->pinholes,
               info->pinholes == 1 ? "" : "s");
        if (info->pinhole_cells > 0)
            printf(" (%d cells, %.1f %% of the body's)\n", (int)info->pinhole_cells,
                   100.0 * info->pinhole_cells / info->elements);
        else
            printf(", smaller than a cell%s\n", info->pinholes == 1 ? "" : " each");
    }
    if (info->pinholes > 0) label = "";
    if (info->added + info->removed > 0)
        printf("%-17s%d cells added and %d removed, where parts would hang together by an edge or\n"
               "%-17sa corner, and at lone bumps and dents\n",
               label, (int)info->added, (int)info->removed, "");
}

static void print_support(const mesh_report *report) {
    const lar_meshing_info *info = &report->info;
    lar_region_info region;
    bool nowhere = strcmp(info->fix, "none") == 0, cut = strcmp(info->fix, "cut") == 0;
    int bones = 0;
    for (int32_t r = 0; !lar_meshing_region(report->meshing, r, &region, NULL); r++)
        bones += region.held && region.elements > 0;
    printf("%-17s", "held");
    if (cut)
        printf("where the image cuts it off");
    else if (!nowhere)
        printf("at the %s", info->fix);
    if (bones > 0) printf("%s", nowhere ? "at its bones" : ", and at its bones");
    if (info->extra_supports > 0)
        printf(", and on %d extra support%s that bear%s its weight", (int)info->extra_supports,
               info->extra_supports == 1 ? "" : "s", info->extra_supports == 1 ? "s" : "");
    if (nowhere && bones == 0)
        printf("nowhere\n");
    else
        printf(": %d nodes\n", (int)info->fixed_nodes);
}

void mesh_report_table(const mesh_report *report) {
    const lar_meshing_info *info = &report->info;
    const lar_model_info *model = &report->model;
    printf("%s: %d elements of about %s, %d nodes, in %.1f s\n", info->title, (int)info->elements,
           cli_length(info->size).text, (int)info->nodes, report->seconds);
    print_regions(report);
    if (info->parted > 0)
        printf("%-17s%d nodes more, where regions meet and come apart\n", "bodies",
               (int)info->parted);
    print_cleaning(info);
    print_support(report);
    cli_print_deviation(&info->quality);
    cli_print_crossings(&info->quality);
    printf("%-17smean %.3f, worst %.3f (element %" PRId32 "); a box has 1\n", "scaled Jacobian",
           model->scaled_jacobian_mean, model->scaled_jacobian_min, model->scaled_jacobian_worst);
    cli_print_jacobians(&info->quality);
    printf("%-17s%s\n", "shortest edge", cli_length(model->shortest_edge).text);
    printf("%-17s%.4g s (stable up to %.4g s)\n", "time step", model->time_step,
           model->stable_step);
    cli_print_speed(&report->speed);
    char quoted[CLI_QUOTED];
    printf("\nlariat view %s\n", cli_quote(report->scene, quoted, sizeof quoted));
}
