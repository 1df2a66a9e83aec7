#include "cli/report/info.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "cli/report/mass_scaling.h"

/* The words of scenes; hands are in none. */
static const char *const shape_word[] = {"sphere", "capsule", "grasper", "hand", "none", "rigid"};

static double degrees(double radians) {
    static const double HALF_TURN = 3.14159265358979323846;
    return radians * 180 / HALF_TURN;
}

/* Where the tip points: the tool's own -z. */
static void towards(const lar_tool_pose *pose, double out[3]) {
    const double *q = pose->orientation;
    out[0] = 0 - 2 * (q[1] * q[3] + q[0] * q[2]);
    out[1] = 0 - 2 * (q[2] * q[3] - q[0] * q[1]);
    out[2] = -(1 - 2 * (q[1] * q[1] + q[2] * q[2]));
}

/* Mean angle between both families of a material's fibres [degrees], as between lines: 0 to 90. */
static double mean_angle(const lar_model *model, int32_t material) {
    double sum = 0, count = 0;
    for (int32_t e = 0; e < lar_model_element_count(model); e++) {
        double a[2][3];
        if (lar_model_element_material(model, e) != material ||
            lar_model_element_fibres(model, e, a) != 2)
            continue;
        double cosine = fabs(a[0][0] * a[1][0] + a[0][1] * a[1][1] + a[0][2] * a[1][2]);
        sum += degrees(acos(fmin(cosine, 1)));
        count += 1;
    }
    return count > 0 ? sum / count : 0;
}

/* Elements whose fibres have a direction. */
static int32_t directed_elements(const lar_model *model) {
    int32_t count = 0;
    for (int32_t e = 0; e < lar_model_element_count(model); e++)
        count += lar_model_element_fibres(model, e, NULL) > 0;
    return count;
}

/* ---- for machines ----------------------------------------------------------------------- */

static void write_contacts(lar_json *json, const lar_model *model) {
    lar_model_contact_info contact;
    lar_json_open(json, "contacts", '[');
    for (int32_t i = 0; !lar_model_contact(model, i, &contact, NULL); i++) {
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "kind", contact.kind);
        lar_json_integer(json, "faces", contact.faces);
        lar_json_integer(json, "against", contact.against);
        lar_json_vector(json, "through", contact.through, 3);
        lar_json_vector(json, "normal", contact.normal, 3);
        lar_json_number(json, "friction", contact.friction);
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void write_tools(lar_json *json, const lar_model *model) {
    lar_tool_info tool;
    lar_json_open(json, "tools", '[');
    for (int32_t i = 0; !lar_model_tool(model, i, &tool, NULL); i++) {
        double direction[3];
        towards(&tool.rest, direction);
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "name", tool.name);
        lar_json_text(json, "shape", shape_word[tool.shape]);
        lar_json_number(json, "radius", tool.radius);
        lar_json_number(json, "length", tool.length);
        lar_json_number(json, "spread", degrees(tool.spread));
        lar_json_vector(json, "at", tool.rest.position, 3);
        lar_json_vector(json, "towards", direction, 3);
        lar_json_number(json, "friction", tool.friction);
        lar_json_close(json);
    }
    lar_json_close(json);
}

void info_report_json(const info_report *report) {
    const lar_model *model = report->model;
    const lar_model_info *info = &report->info;
    lar_json json = lar_json_to(stdout);
    lar_json_text(&json, "file", report->path);
    lar_json_text(&json, "title", info->title);
    lar_json_integer(&json, "nodes", info->nodes);
    lar_json_integer(&json, "elements", info->elements);
    lar_json_integer(&json, "fixed_nodes", info->fixed_nodes);
    lar_json_vector(&json, "lower", info->lower, 3);
    lar_json_vector(&json, "upper", info->upper, 3);
    lar_json_number(&json, "volume", info->volume);
    lar_json_number(&json, "mass", info->mass);
    lar_json_number(&json, "shortest_edge", info->shortest_edge);
    lar_json_open(&json, "scaled_jacobian", '{');
    lar_json_number(&json, "min", info->scaled_jacobian_min);
    lar_json_number(&json, "mean", info->scaled_jacobian_mean);
    lar_json_integer(&json, "worst_element",
                     lar_model_element_id(model, info->scaled_jacobian_worst));
    lar_json_close(&json);
    cli_write_quality(&json, &report->quality);
    lar_json_integer(&json, "thin_elements", info->thin_elements);
    lar_json_integer(&json, "spring_nodes", info->spring_nodes);
    lar_json_number(&json, "spring_stiffness", info->spring_stiffness);
    lar_json_number(&json, "stable_step", info->stable_step);
    lar_json_integer(&json, "stable_step_element", lar_model_element_id(model, info->stable_worst));
    lar_json_number(&json, "time_step", info->time_step);
    cli_write_mass_scaling(&json, model, &info->mass_scaling);
    if (report->timed) cli_write_speed(&json, &report->speed);
    lar_json_number(&json, "duration", lar_model_duration(model));
    lar_json_boolean(&json, "until_rest", lar_model_until_rest(model));
    lar_json_number(&json, "output_interval", lar_model_output_interval(model));
    lar_json_integer(&json, "fibre_elements", directed_elements(model));
    lar_json_open(&json, "materials", '[');
    lar_material_info material;
    for (int32_t i = 0; !lar_model_material(model, i, &material, NULL); i++) {
        lar_json_open(&json, NULL, '{');
        lar_json_text(&json, "name", material.name);
        lar_json_text(&json, "law", material.law);
        lar_json_integer(&json, "elements", material.elements);
        lar_json_number(&json, "density", material.density);
        lar_json_number(&json, "shear_modulus", material.shear_modulus);
        lar_json_number(&json, "bulk_modulus", material.bulk_modulus);
        lar_json_integer(&json, "viscous_terms", material.viscous_terms);
        lar_json_number(&json, "instant_shear_modulus", material.instant_shear_modulus);
        lar_json_text(&json, "fibres", material.fibres);
        lar_json_number(&json, "fibre_modulus", material.fibre_modulus);
        lar_json_integer(&json, "fibre_families", material.fibre_families);
        lar_json_number(&json, "fibre_angle", mean_angle(model, i));
        lar_json_number(&json, "fibre_dispersion", material.fibre_dispersion);
        lar_json_number(&json, "active_along", material.active_along);
        lar_json_number(&json, "active_across", material.active_across);
        lar_json_close(&json);
    }
    lar_json_close(&json);
    lar_json_open(&json, "sets", '[');
    lar_set_info set;
    for (int32_t i = 0; !lar_model_set(model, i, &set, NULL); i++) {
        lar_json_open(&json, NULL, '{');
        lar_json_text(&json, "name", set.name);
        lar_json_text(&json, "kind", set.kind);
        lar_json_integer(&json, "count", set.count);
        lar_json_close(&json);
    }
    lar_json_close(&json);
    write_contacts(&json, model);
    write_tools(&json, model);
    lar_json_open(&json, "notices", '[');
    for (int32_t i = 0; i < lar_model_notice_count(model); i++)
        lar_json_text(&json, NULL, lar_model_notice_text(model, i));
    lar_json_end(&json);
}

/* ---- for people ------------------------------------------------------------------------- */

static void print_fibres(const lar_model *model, int32_t material, const lar_material_info *m) {
    printf(", fibres (%s", m->fibres);
    if (m->fibre_families == 2)
        printf(", two families %.4g degrees apart", mean_angle(model, material));
    if (m->fibre_dispersion > 0) printf(", dispersion %.4g", m->fibre_dispersion);
    printf(", modulus where they begin to pull %.4g Pa)", m->fibre_modulus);
}

static void print_materials(const lar_model *model) {
    lar_material_info m;
    for (int32_t i = 0; !lar_model_material(model, i, &m, NULL); i++) {
        printf("%-17s%s%s%s, %d elements, %g kg/m^3, shear modulus %.4g Pa, bulk modulus %.4g Pa",
               i ? "" : "materials", m.name, *m.name ? ": " : "", m.law, (int)m.elements, m.density,
               m.shear_modulus, m.bulk_modulus);
        if (m.viscous_terms > 0)
            printf(", viscous (%d term%s, shear modulus at once %.4g Pa)", (int)m.viscous_terms,
                   m.viscous_terms > 1 ? "s" : "", m.instant_shear_modulus);
        if (*m.fibres) print_fibres(model, i, &m);
        if (m.active_along > 0 || m.active_across > 0)
            printf(", active (up to %.4g Pa along fibres and %.4g Pa across)", m.active_along,
                   m.active_across);
        putchar('\n');
    }
    int32_t directed = directed_elements(model);
    if (directed > 0) printf("%-17s%d elements have a direction\n", "fibres", (int)directed);
}

static void print_sets(const lar_model *model) {
    enum { SHOWN = 30 };
    int32_t count = lar_model_set_count(model);
    lar_set_info set;
    for (int32_t i = 0; i < count && i < SHOWN && !lar_model_set(model, i, &set, NULL); i++)
        printf("%-17s%s: %d %s\n", i ? "" : "sets", set.name, (int)set.count, set.kind);
    if (count > SHOWN) printf("%-17sand %d more (--json lists all)\n", "", (int)(count - SHOWN));
}

static void print_contacts(const lar_model *model) {
    lar_model_contact_info c;
    for (int32_t i = 0; !lar_model_contact(model, i, &c, NULL); i++) {
        printf("%-17s%d faces ", i ? "" : "contact", (int)c.faces);
        if (c.kind[0] == 'b')
            printf("with %d others", (int)c.against);
        else if (c.kind[0] == 'p')
            printf("with a plane through (%.4g, %.4g, %.4g), normal (%.4g, %.4g, %.4g)",
                   c.through[0], c.through[1], c.through[2], c.normal[0], c.normal[1], c.normal[2]);
        else
            printf("with each other");
        if (c.friction > 0) printf(", friction %.4g", c.friction);
        putchar('\n');
    }
}

static void print_tools(const lar_model *model) {
    lar_tool_info t;
    for (int32_t i = 0; !lar_model_tool(model, i, &t, NULL); i++) {
        printf("%-17s%s: %s, radius %.4g m", i ? "" : "tools", t.name, shape_word[t.shape],
               t.radius);
        if (t.length > 0) printf(", length %.4g m", t.length);
        if (t.spread > 0) printf(", spread %.4g degrees", degrees(t.spread));
        const double *at = t.rest.position;
        printf(", at (%.4g, %.4g, %.4g)", at[0], at[1], at[2]);
        if (t.friction > 0) printf(", friction %.4g", t.friction);
        putchar('\n');
    }
}

static void print_duration(const lar_model *model) {
    double duration = lar_model_duration(model), interval = lar_model_output_interval(model);
    if (lar_model_until_rest(model))
        printf("%-17suntil it is at rest, ", "duration");
    else if (duration > 0)
        printf("%-17s%g s, ", "duration", duration);
    else
        printf("%-17sopen, ", "duration");
    if (interval > 0)
        printf("a frame every %g s\n", interval);
    else
        printf("one frame at the end\n");
}

/* One element bends with no stress that differs over its thickness (docs/theory.md, hourglass
 * control). */
static void print_thin(const lar_model_info *info) {
    if (info->thin_elements == 0) return;
    printf(
        "%-17s%d of %d elements have outer faces on two opposite sides: one layer bends too far, "
        "n layers by 1/n^2 of that\n",
        "thin", (int)info->thin_elements, (int)info->elements);
}

void info_report_table(const info_report *report) {
    const lar_model *model = report->model;
    const lar_model_info *info = &report->info;
    double size[3];
    for (int i = 0; i < 3; i++) size[i] = info->upper[i] - info->lower[i];
    printf("%-17s%s\n", "title", *info->title ? info->title : "(none)");
    printf("%-17s%d elements, %d nodes, ", "mesh", (int)info->elements, (int)info->nodes);
    if (info->fixed_nodes > 0)
        printf("of these %d held or moved\n", (int)info->fixed_nodes);
    else
        printf("none held or moved\n");
    printf("%-17s%.4g x %.4g x %.4g m, from (%.4g, %.4g, %.4g) to (%.4g, %.4g, %.4g)\n", "size",
           size[0], size[1], size[2], info->lower[0], info->lower[1], info->lower[2],
           info->upper[0], info->upper[1], info->upper[2]);
    printf("%-17s%.4g m^3, %.4g kg\n", "volume, mass", info->volume, info->mass);
    cli_print_deviation(&report->quality);
    cli_print_crossings(&report->quality);
    printf("%-17s%.4g m, mean %.4g m\n", "shortest edge", info->shortest_edge,
           report->quality.mean_edge);
    printf("%-17smean %.3f, worst %.3f (element %" PRId64 "); a box has 1\n", "scaled Jacobian",
           info->scaled_jacobian_mean, info->scaled_jacobian_min,
           lar_model_element_id(model, info->scaled_jacobian_worst));
    cli_print_jacobians(&report->quality);
    print_thin(info);
    printf("%-17s%.4g s (stable up to %.4g s, set by element %" PRId64 ")\n", "time step",
           info->time_step, info->stable_step, lar_model_element_id(model, info->stable_worst));
    cli_print_mass_scaling(model, &info->mass_scaling, true, stdout);
    if (report->timed) cli_print_speed(&report->speed);
    print_duration(model);
    print_materials(model);
    print_sets(model);
    if (info->spring_nodes > 0)
        printf("%-17s%d nodes, %.4g N/m together\n", "springs", (int)info->spring_nodes,
               info->spring_stiffness);
    print_contacts(model);
    print_tools(model);
}
