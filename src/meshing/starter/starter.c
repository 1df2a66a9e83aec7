/* The scene of a meshing: it runs as it is, and says why it is so. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/vector.h"
#include "meshing/fit/quality.h"
#include "meshing/meshing.h"
#include "meshing/starter/tissue.h"
#include "model/format/vtk/vtk_xml_write.h"

/* ---- words -------------------------------------------------------------------------------- */

/* Bytes of a well-formed character that YAML lets through, 0: none begins here. */
static int character(const unsigned char *c) {
    if (c[0] < 0x80) return c[0] >= ' ' && c[0] < 0x7f;
    int more = c[0] >= 0xc2 && c[0] < 0xe0 ? 1 : c[0] >= 0xe0 && c[0] < 0xf0 ? 2 : 0;
    for (int i = 1; i <= more; i++)
        if ((c[i] & 0xc0) != 0x80) return 0;
    if (more == 1) return c[0] == 0xc2 && c[1] < 0xa0 ? 0 : 2;           /* C1 controls */
    if (more == 0 || (c[0] == 0xe0 && c[1] < 0xa0)) return 0;            /* over-long */
    if (c[0] == 0xed && c[1] >= 0xa0) return 0;                          /* surrogates */
    if (c[0] == 0xe2 && c[1] == 0x80 && (c[2] & 0xfe) == 0xa8) return 0; /* line ends */
    return c[0] == 0xef && c[1] >= 0xbb ? 0 : 3; /* byte order mark, no characters */
}

/* A text that comes from a file, on one line; between quotes with `quoted`. */
static void put(FILE *file, const char *text, bool quoted) {
    if (quoted) fputc('"', file);
    for (const unsigned char *c = (const unsigned char *)text; *c;) {
        int length = character(c);
        if (quoted && (*c == '"' || *c == '\\')) fputc('\\', file);
        if (length > 0)
            fwrite(c, 1, (size_t)length, file);
        else
            fputc('?', file);
        c += length > 0 ? length : 1;
    }
    if (quoted) fputc('"', file);
}

/* ---- the scene ----------------------------------------------------------------------------- */

static double two_digits(double x) {
    double digit = pow(10, floor(log10(x)) - 1);
    return round(x / digit) * digit;
}

/* A motion that is damped by c while it swings at w decays with c/2, as long as c is below 2 w. The
 * estimate of w is above the slowest, by a tenth or two, so c = 1.6 w is a little below 2 w and
 * everything decays with 0.8 w at least. */
static double damping(const lar_meshing *m) {
    static const double WITHOUT = 10, MIN = 0.3, PART = 1.6;
    if (!(m->support.slowest > 0)) return WITHOUT;
    return two_digits(fmax(MIN, PART * m->support.slowest));
}

/* Time in which the slowest motion has become a hundredth, with some room. */
static double settling(const lar_meshing *m) {
    return 2 * log(300) / damping(m);
}

/* The pull and what comes after it; half seconds. */
static double duration(const lar_meshing *m) {
    static const double PULL = 1.2, MIN = 2;
    if (!m->support.handle) return MIN;
    return fmax(MIN, ceil(2 * (PULL + settling(m))) / 2);
}

static double min_height(const lar_mesh *mesh, int32_t e) {
    double min = INFINITY, x[8][3], edge[3][3], area[3];
    lar_mesh_corners(mesh, e, x);
    for (int a = 0; a < 8; a++) {
        double largest = 0;
        for (int k = 0; k < 3; k++) lar_minus(x[lar_fit_edge[a][k]], x[a], edge[k]);
        for (int k = 0; k < 3; k++) {
            lar_cross(edge[k], edge[(k + 1) % 3], area);
            largest = fmax(largest, lar_length(area));
        }
        /* `area` is that of edges 2 and 0 now. */
        min = fmin(min, fabs(lar_dot(area, edge[1])) / largest);
    }
    return min;
}

/* The least height of an element, divided by the speed of pressure waves in it, and half of that:
 * an element that is squeezed to half its height still bears the step. The height at a corner is
 * the volume that its edges span over the largest area of two of them. */
static double squeezed_step(const lar_meshing *m) {
    double min = INFINITY;
    for (int32_t r = 0; r < m->info.regions; r++) {
        const lar_region_info *region = &m->region[r];
        double modulus = region->bulk_modulus + 4 * region->shear_modulus / 3;
        double speed = sqrt(modulus / region->density);
        for (int32_t e = 0; e < m->mesh.element_count; e++)
            if (m->mesh.element_tag[e] == region->tag)
                min = fmin(min, min_height(&m->mesh, e) / speed);
    }
    return min / 2;
}

static void put_files(const lar_meshing *m, FILE *f) {
    fprintf(f, "\nmesh: \"%s.vtu\"\n", m->stem);
    if (!m->apart)
        fprintf(f, "surface: \"%s_surface.vtp\"   # the true surface, embedded in the mesh\n",
                m->stem);
}

static void put_head(const lar_meshing *m, bool files, FILE *f) {
    const lar_meshing_info *info = &m->info;
    fputs("# ", f);
    put(f, m->title, false);
    fputs(": made by `lariat mesh` from ", f);
    put(f, m->from, false);
    fprintf(f,
            ".\n"
            "# %" PRId32 " hexahedra %s, about %.3g mm wide.\n"
            "#\n",
            info->elements, m->fitted ? "on the true boundary" : "on a grid, as cubes",
            1e3 * info->size);
    if (files)
        fprintf(f,
                "#     lariat info %s.yaml                  sizes, quality, speed\n"
                "#     lariat view %s.yaml                  take hold of it\n"
                "#     lariat run %s.yaml --out results     pull at it, for ParaView\n"
                "#\n",
                m->stem, m->stem, m->stem);
    fputs("# A first scene to change as you need it: docs/formats.md has every key.\n"
          "# All numbers are in SI units: metres, kilograms, seconds, newtons, pascals.\n",
          f);
    fputs(m->image ? "# x points to the patient's right, y to the front, z to the head.\n"
          : files  ? "# Axes are those of the file.\n"
                   : "# Axes are those of the arrays.\n",
          f);
    fputs("lariat: 1\ntitle: ", f);
    put(f, m->title, true);
    if (files)
        put_files(m, f);
    else
        fputs("\nmesh: given\n", f);
    fputs(m->image
              ? "view: [0.15, 1, 0.35]   # looked at from the patient's front, the head is up\n\n"
              : "\n",
          f);
}

static void put_motion(const lar_meshing *m, FILE *f) {
    fprintf(
        f,
        "# No gravity: the scanner saw the organ sag already, and what was seen is its shape at\n"
        "# rest here. %s, %s:\n"
        "#     gravity: [0, -9.81, 0]\n"
        "# A body that its support does not carry folds up under it; elements that are squeezed\n"
        "# need shorter steps than at rest:\n"
        "#     time_step: %.1e\n"
        "gravity: [0, 0, 0]\n"
        "time_step: auto\n"
        "damping: %g             # 1/s; let go, it comes to rest in about %.2g s\n"
        "duration: %g              # s; a run lasts so long unless --time says otherwise\n"
        "# Where tools squeeze it, elements move with more mass for a while, up to 2 %% of all, "
        "in\n"
        "# place of shorter steps for the whole body:\n"
        "mass_scaling: { strained: 0.02 }\n\n",
        m->support.carried ? "What holds it bears its weight besides" : "For its weight besides",
        m->image ? "the patient lying on the back" : "lying on its back", squeezed_step(m),
        damping(m), settling(m), duration(m));
}

static void put_direction(const lar_meshing *m, FILE *f) {
    fprintf(f, *m->fibres == '{' ? "direction: %s" : "direction: { %s }", m->fibres);
}

/* 4 ksi more along the fibres than E = 3 G of what is incompressible. */
static void put_fibres(const lar_meshing *m, const lar_region_info *region, FILE *f) {
    fprintf(
        f,
        "      # The mesh shows them as cell array \"fibre\", a run as its own model has them.\n"
        "      fibres: { law: exp-pow, part: isochoric,\n"
        "        ksi: %g, alpha: 1, beta: 2,   # a guess: twice as stiff along as across\n"
        "        ",
        0.75 * region->shear_modulus);
    put_direction(m, f);
    fputs(" }", f);
}

/* One line of a tissue file, but for its own version and name; fibres get their direction. */
static void put_given_line(const lar_meshing *m, lar_span line, FILE *f) {
    lar_span key, value;
    bool here = lar_span_split(line, ':', &key, &value);
    if (lar_span_equal(line, "---") || lar_span_equal(key, "lariat-tissue") ||
        lar_span_equal(key, "name"))
        return;
    bool fibres = here && lar_span_equal(key, "fibres");
    value = lar_span_trim(value);
    if (fibres && value.length > 0 && *value.at == '{') {
        fputs("      fibres: { ", f);
        put_direction(m, f);
        fprintf(f, ", %.*s\n", (int)value.length - 1, value.at + 1);
        return;
    }
    fprintf(f, "      %.*s\n", (int)line.length, line.at);
    if (!fibres) return;
    fputs("        ", f);
    put_direction(m, f);
    fputc('\n', f);
}

static void put_given(const lar_meshing *m, const lar_region_info *region, FILE *f) {
    const lar_given_tissue *given = &m->given[region - m->region];
    lar_text text = lar_text_from(&given->text);
    lar_span line;
    fputs("  # From ", f);
    put(f, given->path, false);
    fputs(":\n  -   name: ", f);
    put(f, region->name, true);
    fprintf(f, "\n      cells: %" PRId32 "\n", region->tag);
    while (lar_text_line(&text, &line)) put_given_line(m, line, f);
    if (given->fibres || !lar_starter_fibrous(m, region)) return;
    put_fibres(m, region, f);
    fputc('\n', f);
}

/* Beside each number stands whose it is, or that it is a guess. */
static void put_material(const lar_meshing *m, const lar_region_info *region, FILE *f) {
    if (m->given[region - m->region].path) {
        put_given(m, region, f);
        return;
    }
    const bool guess = lar_tissue_find(region->name)->guess,
               fibres = lar_starter_fibrous(m, region);
    fprintf(f, "  # As %s. Shear modulus: %s.\n", region->tissue, region->source);
    fputs("  - { name: ", f);
    put(f, region->name, true);
    fprintf(f,
            ", cells: %" PRId32 ", density: %g,\n"
            "      law: coupled-neo-hookean,   # a guess at larger strain\n"
            "      shear_modulus: %g,%s\n"
            "      bulk_modulus: %.3g%s   # a guess, see above\n",
            region->tag, region->density, region->shear_modulus,
            region->held ? "   # a guess, and without effect: it is held"
            : guess      ? "   # a guess: measure it, lariat fit"
                         : "",
            region->bulk_modulus, fibres ? "," : " }");
    if (!fibres) return;
    put_fibres(m, region, f);
    fputs(" }\n", f);
}

static void put_materials(const lar_meshing *m, FILE *f) {
    fputs(
        "# Stiffnesses at small strain, of healthy adults, from the literature: they differ\n"
        "# between people, ages and methods by a factor of two and more. What is marked as a "
        "guess\n"
        "# has no source: which law it is, how it stiffens, that it does not relax (there is no\n"
        "# `viscous`), and some moduli. Measure them: `lariat fit` makes a tissue file of an\n"
        "# experiment (indentation, aspiration, tension, ...), docs/fit.md; here it is then\n"
        "#     - { name: NAME, cells: TAG, tissue: NAME.tissue.yaml }\n"
        "# The bulk modulus is that of Poisson's ratio 0.45. Tissue is nearer to 0.5, but the "
        "stable\n"
        "# time step goes with the speed of pressure waves: at 0.49 it is less than half as long.\n"
        "# `cells` is the tag of the elements, the label in the image.\n"
        "materials:\n",
        f);
    for (int32_t r = 0; r < m->info.regions; r++)
        if (m->region[r].elements > 0) put_material(m, &m->region[r], f);
    fputc('\n', f);
}

static void put_fix(const lar_meshing *m, FILE *f) {
    const lar_support *support = &m->support;
    bool any = false;
    if (strcmp(support->rule, "cut") == 0)
        fputs("# Held where the image cuts it off.\n", f);
    else if (support->held)
        fprintf(f, "# Held at the %s: the surface's nodes in the last tenth of its extent.\n",
                support->rule);
    else
        fputs(
            "# Nothing holds it: hold it by { nodes: support, axes: xyz } and a set of your own.\n",
            f);
    if (support->extra_supports > 0)
        fputs("# Extra supports (pads): small places of its underside, where its neighbours carry "
              "it\n"
              "# in the patient and without which it could not bear its weight. Without that line "
              "it\n"
              "# hangs free.\n",
              f);
    if (support->held) fputs("fix:\n  - { nodes: support, axes: xyz }\n", f);
    any = support->held;
    if (support->extra_supports > 0) {
        fprintf(f, "%s  - { nodes: pads, axes: xyz }\n", any ? "" : "fix:\n");
        any = true;
    }
    for (int32_t r = 0; r < m->info.regions; r++) {
        const lar_region_info *region = &m->region[r];
        if (region->elements == 0 || !region->held) continue;
        if (!any) fputs("fix:\n", f);
        any = true;
        fprintf(f, "  - { nodes: { tag: %" PRId32 " }, axes: xyz }   # ", region->tag);
        put(f, region->name, false);
        fputs(" is bone, and stays where it is\n", f);
    }
    fputc('\n', f);
}

static void put_load(const lar_meshing *m, FILE *f) {
    const lar_support *s = &m->support;
    static const char curve[] =
        "      curve: { points: [[0, 0], [0.4, 1], [0.8, 1], [1.2, 0]], shape: smooth } }\n";
    if (!s->handle) return;
    fprintf(
        f,
        "# A pull at the %s: it grows, stays, and lets go. The force is the total, shared by the\n"
        "# nodes of the set. In the viewer your hand pulls too; take this out for your hand "
        "alone.\n"
        "load:\n"
        "  - { nodes: handle, force: [%g, %g, %g],\n%s",
        s->handle, s->pull[0], s->pull[1], s->pull[2], curve);
    if (s->opposed)
        fprintf(f, "  - { nodes: handle_opposite, force: [%g, %g, %g],\n%s", 0 - s->pull[0],
                0 - s->pull[1], 0 - s->pull[2], curve);
    fputc('\n', f);
}

/* A ball around the mesh: the middle of its box and half of its diagonal. */
static double ball_around(const lar_mesh *mesh, double middle[3]) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (lar_gid n = 0; n < mesh->node_count; n++)
        for (int i = 0; i < 3; i++) {
            lower[i] = fmin(lower[i], mesh->position[n][i]);
            upper[i] = fmax(upper[i], mesh->position[n][i]);
        }
    for (int i = 0; i < 3; i++) middle[i] = 0.5 * (lower[i] + upper[i]);
    lar_minus(upper, lower, upper);
    return 0.5 * lar_length(upper);
}

static double longest_edge(const lar_mesh *mesh) {
    double max = 0, x[8][3], edge[3];
    for (int32_t e = 0; e < mesh->element_count; e++) {
        lar_mesh_corners(mesh, e, x);
        for (int a = 0; a < 8; a++)
            for (int k = 0; k < 3; k++) {
                lar_minus(x[lar_fit_edge[a][k]], x[a], edge);
                max = fmax(max, lar_length(edge));
            }
    }
    return max;
}

/* Outside of that ball, so that they touch nothing, above the body as the viewer sees it at first:
 * one to the left of the picture's middle, one to the right. */
static void put_tools(const lar_meshing *m, FILE *f) {
    static const double from_image[3] = {0.15, 1, 0.35}, from_other[3] = {-0.14, -0.925, 0.352};
    static const double up[3] = {0, 0, 1};
    const double *eye = m->image ? from_image : from_other;
    double middle[3], right[3], way[2][3], place[2][3];
    double radius = ball_around(&m->mesh, middle), length = lar_length(eye);
    /* Thinner ones would be felt by some points of large faces only (model/contact_check.h). */
    double min = 0.13 * longest_edge(&m->mesh);
    double probe = fmax(min, 0.035 * radius), jaw = fmax(min, 0.012 * radius);
    double jaws = fmax(5 * jaw, 0.12 * radius);
    double away = fmax(1.28 * radius, 1.05 * radius + jaws + jaw);
    lar_cross(up, eye, right);
    double wide = lar_length(right);
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < 3; i++)
            way[side][i] =
                0.8 * eye[i] / length + (side ? 0.38 : -0.38) * right[i] / wide + 0.46 * up[i];
        double whole = lar_length(way[side]);
        for (int i = 0; i < 3; i++) place[side][i] = middle[i] + away * way[side][i] / whole;
    }
    fprintf(f,
            "# Instruments for the viewer and for devices (lariat view --device). They wait beside "
            "the\n"
            "# body and touch nothing until they are moved: a run is the same without them.\n"
            "tools:\n"
            "  - { name: probe, shape: sphere, radius: %.3g, at: [%.6g, %.6g, %.6g] }\n"
            "  - { name: grasper, shape: grasper, radius: %.3g, length: %.3g, spread: 50,\n"
            "      at: [%.6g, %.6g, %.6g], towards: [%.4g, %.4g, %.4g] }\n\n",
            probe, place[0][0], place[0][1], place[0][2], jaw, jaws, place[1][0], place[1][1],
            place[1][2], -way[1][0], -way[1][1], -way[1][2]);
}

static void put_end(const lar_meshing *m, FILE *f) {
    if (m->apart)
        fputs("# Bodies touch, slide and come apart, and pass neither through each other nor "
              "through\n"
              "# themselves. Coulomb's friction: { self: true, friction: 0.1 }\n"
              "contact: [ { self: true } ]\n\n",
              f);
    else
        fputs("# It does not pass through itself: takes some of each step.\n"
              "# contact: [ { self: true } ]\n\n",
              f);
    fputs("output:\n  every: 0.02\n  fields: [displacement, von_mises]\n", f);
    if (!m->apart)
        fputs("# surface: true   # the true surface in every frame too, for ParaView: takes more "
              "room\n",
              f);
    if (!m->support.handle && !m->support.held) return;
    fputs("  probes:\n", f);
    if (m->support.handle)
        fputs("    - { set: handle }                        # mean displacement\n", f);
    if (m->support.held)
        fputs("    - { set: support, sum: reaction }        # force of the support\n", f);
}

static void put_scene(const lar_meshing *m, bool files, FILE *f) {
    locale_t before = uselocale(lar_text_locale());
    put_head(m, files, f);
    put_motion(m, f);
    put_materials(m, f);
    put_fix(m, f);
    put_load(m, f);
    put_tools(m, f);
    put_end(m, f);
    uselocale(before);
}

lar_status lar_starter_write(const lar_meshing *meshing, const char *path, lar_error *error) {
    lar_part_file out;
    lar_status status = lar_part_open(&out, path, error);
    if (!status) put_scene(meshing, true, out.file);
    return lar_part_close(&out, status);
}

lar_status lar_starter_text(const lar_meshing *meshing, char **text, lar_error *error) {
    char *made = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&made, &size);
    if (file) put_scene(meshing, false, file);
    char *copy = file && fclose(file) == 0 && made ? lar_strdup(made) : NULL;
    (free)(made); /* the C library's own */
    if (!copy) return lar_fail_memory(error, size + 1, "a scene");
    *text = copy;
    return LAR_OK;
}
