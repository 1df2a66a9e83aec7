/* lariat mesh: from a scan to a model. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/commands.h"
#include "cli/mesh_real_time.h"
#include "cli/report/mesh.h"
#include "cli/report/mesh_touch.h"
#include "cli/stop.h"

enum { INPUTS_MAX = 255 };

typedef struct mesh_settings {
    const char *input[INPUTS_MAX];
    int32_t inputs;
    cli_texts labels, tissues;
    const char *names, *title, *out, *fibres, *fibres_in;
    int64_t elements; /* 0: not given */
    double size, scale;
    int fix; /* index into fix_names; 0: not given */
    bool fuse, apart, principal, voxel, force, list, json, real_time;
} mesh_settings;

static const char *const fix_names[] = {"auto",   "left", "right", "back", "front",
                                        "bottom", "top",  "cut",   "none", NULL};

static double now(void) {
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

/* ---- progress ------------------------------------------------------------------------------ */

typedef struct progress {
    double start, shown; /* [s]; shown 0: nothing is on the screen */
} progress;

/* lar_meshing_progress. */
static int show_progress(void *context, const char *what, double part) {
    static const double QUIET = 1.0, EVERY = 0.1; /* shorter work says nothing [s] */
    progress *p = context;
    double at = now();
    if (at > p->start + QUIET && at > p->shown + EVERY && isatty(STDERR_FILENO)) {
        if (part > 0)
            fprintf(stderr, "\r%s %3.0f %% \033[K", what, 100 * part);
        else
            fprintf(stderr, "\r%s \033[K", what);
        fflush(stderr);
        p->shown = at;
    }
    return !cli_stop_asked;
}

static void clear_progress(const progress *p) {
    if (p->shown > 0) fputs("\r\033[K", stderr);
}

/* ---- labels -------------------------------------------------------------------------------- */

static int list_labels(const mesh_settings *s) {
    lar_label_list list;
    lar_error error;
    if (s->inputs > 1)
        return cli_complain(&cli_mesh, CLI_USAGE, "--list lists the labels of one image");
    if (lar_label_list_read(s->input[0], s->names, &list, &error))
        return cli_complain(&cli_mesh, CLI_FAILED, "%s", error.message);
    if (s->json)
        mesh_report_labels_json(s->input[0], &list);
    else
        mesh_report_labels(s->input[0], &list, stdout);
    lar_label_list_clear(&list);
    return CLI_DONE;
}

/* Who asks for a label that there is not wants to know which there are. */
static void show_what_there_is(const mesh_settings *s) {
    lar_label_list list;
    bool known = true, named = false;
    if (s->labels.count == 0 || s->inputs > 1 ||
        lar_label_list_read(s->input[0], s->names, &list, NULL))
        return;
    for (int i = 0; i < s->labels.count; i++)
        known = known && lar_label_list_has(&list, s->labels.text[i]);
    for (int32_t i = 0; i < list.count; i++) named = named || list.row[i].name;
    if (!known) mesh_report_labels(s->input[0], &list, stderr);
    if (!known && !named)
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: the image does not name its labels; --names FILE does, a line "
                     "LABEL,NAME for each");
    lar_label_list_clear(&list);
}

/* ---- files ---------------------------------------------------------------------------------- */

/* A scene that is there may have been changed by hand, a mesh or surface may be somebody's own or
 * even what is being meshed: they stay, unless --force says otherwise. */
static int check_free(const mesh_settings *s, const char *folder, const char *stem) {
    for (int i = 0; cli_mesh_endings[i]; i++) {
        char path[4096];
        int length = snprintf(path, sizeof path, "%s/%s%s", folder, stem, cli_mesh_endings[i]);
        if (length < 0 || (size_t)length >= sizeof path)
            return cli_complain(&cli_mesh, CLI_FAILED, "the name of the folder is too long");
        if (s->force || access(path, F_OK) != 0) continue;
        return cli_complain(&cli_mesh, CLI_FAILED,
                            "%s is there already, perhaps with changes of yours; --force replaces "
                            "it, --out puts the new one elsewhere",
                            path);
    }
    return CLI_DONE;
}

/* Of a single region: surfaces of several are open where these meet. */
static int find_shape(mesh_report *report) {
    if (report->info.regions != 1) return CLI_DONE;
    lar_mesh_arrays mesh;
    lar_surface_arrays surface;
    lar_meshing_arrays(report->meshing, &mesh, &surface);
    if (mesh_shape_of_surface(&surface, 0, &report->surface) &&
        mesh_shape_of_mesh(&mesh, NULL, &report->mesh))
        return CLI_DONE;
    return cli_complain(&cli_mesh, CLI_FAILED, "out of memory");
}

/* A wall's first hole only joins its two sides: then a hollow is not closed any more. Of one region
 * among several that is all that is sure, for the surfaces of regions touch themselves. */
static void doubt_hollows(const mesh_report *report) {
    static const double LEAST = 27; /* elements: smaller ones are filled, or left to others */
    const double size = report->info.size;
    lar_region_info r;
    lar_mesh_arrays mesh;
    lar_meshing_arrays(report->meshing, &mesh, NULL);
    for (int32_t i = 0; !lar_meshing_region(report->meshing, i, &r, NULL); i++) {
        const int32_t count = lar_meshing_region_boundary(report->meshing, i, NULL, NULL);
        int32_t(*triangle)[3] = lar_calloc((size_t)count + 1, sizeof *triangle);
        lar_surface_arrays surface;
        mesh_shape wanted, got;
        if (triangle) lar_meshing_region_boundary(report->meshing, i, triangle, &surface);
        if (triangle && r.elements > 0 &&
            mesh_shape_of_surface(&surface, LEAST * size * size * size, &wanted) &&
            wanted.hollows > 0 && mesh_shape_of_mesh(&mesh, &r.tag, &got) &&
            got.hollows < wanted.hollows)
            cli_complain(&cli_mesh, CLI_DONE,
                         "note: %s encloses %d hollow%s and its mesh %d: its wall has holes, for "
                         "it is about as thin as an element of %s, or among other regions up to "
                         "two thirds thicker; take elements of half the wall's thickness or less",
                         r.name, (int)wanted.hollows, wanted.hollows > 1 ? "s" : "",
                         (int)got.hollows, cli_length(size).text);
        free(triangle);
    }
}

/* Where what is between two regions is thinner than elements they hang together through it. */
static void doubt_layers(const mesh_report *report) {
    enum { NAMED = 3 };
    int32_t count;
    mesh_touch *touch = mesh_touches(report->meshing, &count);
    char text[512];
    size_t used = 0;
    for (int32_t i = 0; i < count && i < NAMED; i++) {
        lar_region_info a, b;
        lar_meshing_region(report->meshing, touch[i].region[0], &a, NULL);
        lar_meshing_region(report->meshing, touch[i].region[1], &b, NULL);
        const double got = 1e6 * touch[i].area, wanted = 1e6 * touch[i].wanted;
        int length = snprintf(text + used, sizeof text - used,
                              "%s%.60s and %.60s touch over %.*f mm^2 instead of %.*f",
                              i ? ", " : "", a.name, b.name, got < 10 ? 2 : 0, got,
                              wanted > 0 && wanted < 10 ? 2 : 0, wanted);
        if (length < 0 || (used += (size_t)length) >= sizeof text) break;
    }
    if (count > 0)
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: in the mesh %s%s: what is between them has holes, for it is thinner "
                     "than elements of %s; take elements of half its thickness or less",
                     text, count > NAMED ? ", and others" : "", cli_length(report->info.size).text);
    free(touch);
}

/* Reads back what was written, as every other command will. */
static int inspect(mesh_report *report) {
    lar_model *model = NULL;
    lar_error error;
    int status = cli_open_model(&cli_mesh, report->scene, &model);
    if (status) return status;
    if (lar_model_inspect(model, &report->model, &error))
        status = cli_complain(&cli_mesh, CLI_FAILED, "%s", error.message);
    else
        report->speed = cli_measure_speed(model);
    lar_model_destroy(model);
    return status;
}

/* A liver of 36 cubic metres is one in another unit: says so once, and whether millimetres would
 * make it a liver. False: nothing is odd. */
static bool doubt_units(const mesh_report *report) {
    static const double MIN = 1e-9, LIKELY = 1e-3; /* [m^3], and of the most that there is */
    const char *remedy = report->info.image ? "look at the voxel sizes in the image's header"
                                            : "say --scale, the metres per unit of the file";
    lar_region_info r;
    double all = 0;
    for (int32_t i = 0; !lar_meshing_region(report->meshing, i, &r, NULL); i++) {
        all += r.true_volume;
        if (!(r.usual_max > 0 && r.true_volume > r.usual_max)) continue;
        const double millimetres = 1e-9 * r.true_volume;
        const bool fits =
            !report->info.image && millimetres < r.usual_max && millimetres > LIKELY * r.usual_max;
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: %s holds %s, and no %s is larger than %s: the file may be in another "
                     "unit%s, or the region be something else; %s",
                     r.name, cli_volume(r.true_volume).text, r.tissue, cli_volume(r.usual_max).text,
                     fits ? ", such as millimetres (--scale 0.001)" : "", remedy);
        return true;
    }
    if (!(all > 0 && all < MIN)) return false;
    cli_complain(
        &cli_mesh, CLI_DONE,
        "note: the body holds %s, less than a cubic millimetre: the file may be in another "
        "unit; %s",
        cli_volume(all).text, remedy);
    return true;
}

/* Two bodies with a gap between them that become one are held together where nothing holds them;
 * sheets about as thick as an element have holes where two halves of it are lost. */
static void doubt_shape(const mesh_report *report) {
    const mesh_shape mesh = report->mesh, surface = report->surface;
    if (!report->info.image && mesh.bodies < surface.bodies)
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: the surface has %d bodies and the mesh %d: gaps between them of less "
                     "than 0.7 elements of %s, or of less than two beside walls that are as "
                     "thin, are closed, or such bodies left out; take more elements or a smaller "
                     "size, or give each body a file of its own and say --apart",
                     (int)surface.bodies, (int)mesh.bodies, cli_length(report->info.size).text);
    const int32_t holes = mesh.holes - surface.holes;
    if (holes > 0)
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: the mesh has %d hole%s that the surface has not: walls are about as "
                     "thin as an element of %s, or gaps bridged in places, of less than 0.7 "
                     "elements or between such walls; there it is softer or stiffer than the body: "
                     "take elements of two thirds of a wall's thickness or less",
                     (int)holes, holes > 1 ? "s" : "", cli_length(report->info.size).text);
}

/* What the user should look at twice: another unit, parts that the grid is too coarse for. */
static void doubt(const mesh_report *report, bool cubes) {
    static const double LARGE = 10;
    /* What a fitted mesh keeps (docs/meshing.md, "How good it is"); cubes stand off more. */
    const double LOST = cubes ? 0.1 : 0.02, FAR = cubes ? 0.3 : 0.15;
    const lar_mesh_quality *quality = &report->info.quality;
    double size = 0, lost = 1 - quality->volume / quality->true_volume;
    for (int i = 0; i < 3; i++) size = fmax(size, report->model.upper[i] - report->model.lower[i]);
    if (report->info.joined > 0)
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: %d nodes of the file stand at the place of another one; they are taken "
                     "as one, so that what meets there is connected",
                     (int)report->info.joined);
    if (!doubt_units(report) && size > LARGE)
        cli_complain(
            &cli_mesh, CLI_DONE,
            "note: the body is %.4g m long; if the file is in millimetres, say --scale 0.001",
            size);
    doubt_shape(report);
    doubt_hollows(report);
    doubt_layers(report);
    if (quality->true_volume > 0 && lost < -LOST && report->info.pinholes > 0)
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: the mesh holds %.0f %% more than the true surface, of which hollows of "
                     "a few elements of %s are filled: take more elements or a smaller size",
                     -100 * lost, cli_length(report->info.size).text);
    else if (quality->true_volume > 0 && fabs(lost) > LOST)
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: the mesh holds %.0f %% %s than the true surface, of which parts are "
                     "thinner than an element of %s: take more elements or a smaller size",
                     100 * fabs(lost), lost > 0 ? "less" : "more",
                     cli_length(report->info.size).text);
    else if (quality->deviation_mean > FAR * quality->mean_edge)
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: the mesh is %.0f %% of an edge off the true surface in the mean: parts "
                     "of it are thinner than an element of %s, and coarse or lost; take more "
                     "elements or a smaller size",
                     100 * quality->deviation_mean / quality->mean_edge,
                     cli_length(report->info.size).text);
}

static int write_and_tell(const mesh_settings *s, lar_meshing *meshing, double seconds) {
    mesh_report report = {.meshing = meshing, .seconds = seconds};
    lar_error error;
    lar_meshing_inspect(meshing, &report.info);
    const char *folder = s->out ? s->out : report.info.name;
    int status = check_free(s, folder, report.info.name);
    if (!status && lar_meshing_write(meshing, folder, &report.scene, &error))
        status = cli_complain(&cli_mesh, CLI_FAILED, "%s", error.message);
    if (!status) status = inspect(&report);
    if (!status) status = find_shape(&report);
    if (status) return status;
    if (s->json)
        mesh_report_json(&report);
    else
        mesh_report_table(&report);
    doubt(&report, s->voxel);
    return CLI_DONE;
}

/* ---- the command ---------------------------------------------------------------------------- */

typedef struct making {
    const mesh_settings *settings;
    progress progress;
} making;

/* cli_make_mesh. `elements` 0: as the settings say. */
static lar_status make(void *context, int32_t elements, lar_meshing **meshing, lar_error *error) {
    making *m = context;
    const mesh_settings *s = m->settings;
    lar_meshing_options options = lar_meshing_options_default();
    options.size = s->size;
    options.elements = s->size > 0 || (s->voxel && s->elements == 0) ? 0 : options.elements;
    if (s->elements > 0) options.elements = (int32_t)s->elements;
    if (elements > 0) options.elements = elements;
    if (s->scale > 0) options.scale = s->scale;
    options.labels = s->labels.text;
    options.label_count = s->labels.count;
    options.fuse = s->fuse;
    options.apart = s->apart;
    options.names = s->names;
    options.principal = s->principal;
    options.voxel = s->voxel;
    options.title = s->title;
    options.fix = s->fix > 0 ? fix_names[s->fix] : NULL;
    options.fibres = s->fibres;
    options.fibre_region = s->fibres_in;
    options.tissues = s->tissues.text;
    options.tissue_count = s->tissues.count;
    options.progress = show_progress;
    options.context = &m->progress;
    lar_status status = lar_meshing_create(s->input, s->inputs, &options, meshing, error);
    clear_progress(&m->progress);
    m->progress.shown = 0;
    return status;
}

static lar_status make_real_time(making *m, lar_meshing **meshing, lar_error *error) {
    int holds = 0;
    lar_status status = cli_mesh_real_time(make, m, meshing, &holds, error);
    if (!status && !holds)
        cli_complain(&cli_mesh, CLI_DONE,
                     "note: no mesh of this body keeps the clock on this machine, as busy as it is "
                     "now; softer tissue, or one of smaller bulk modulus, allows longer steps");
    return status;
}

static int mesh(const mesh_settings *s) {
    making m = {.settings = s, .progress = {.start = now()}};
    lar_meshing *meshing = NULL;
    lar_error error;
    cli_catch_stop();
    lar_status failed =
        s->real_time ? make_real_time(&m, &meshing, &error) : make(&m, 0, &meshing, &error);
    if (cli_stop_asked) {
        if (!failed) lar_meshing_destroy(meshing);
        return cli_complain(&cli_mesh, CLI_INTERRUPTED, "interrupted; nothing is written");
    }
    if (failed) {
        cli_complain(&cli_mesh, CLI_FAILED, "%s", error.message);
        show_what_there_is(s);
        return CLI_FAILED;
    }
    int status = write_and_tell(s, meshing, now() - m.progress.start);
    lar_meshing_destroy(meshing);
    return status;
}

static int check_settings(const mesh_settings *s) {
    if (s->size > 0 && s->elements > 0)
        return cli_complain(&cli_mesh, CLI_USAGE,
                            "--elements and --size both say how fine the mesh is; give one");
    if (s->apart && s->fuse)
        return cli_complain(&cli_mesh, CLI_USAGE,
                            "--fuse makes one region of all, --apart a body of each; give one");
    if (s->fibres_in && !s->fibres)
        return cli_complain(&cli_mesh, CLI_USAGE,
                            "--fibres-in names a region, but no fibres are asked for; add --fibres "
                            "RULE");
    if (s->real_time && (s->size > 0 || s->elements > 0))
        return cli_complain(&cli_mesh, CLI_USAGE,
                            "--real-time finds out how fine the mesh can be; leave --%s out",
                            s->size > 0 ? "size" : "elements");
    return CLI_DONE;
}

static int mesh_main(int argc, char **argv) {
    mesh_settings s = {0};
    const cli_option options[] = {
        CLI_TEXTS("--label", "NAME|N",
                  "a label of the image, by name or number, as a region;\nmay be given again; "
                  "without: all labels",
                  &s.labels),
        CLI_FLAG("--fuse", "all labels, or regions of a mesh, become one region", &s.fuse),
        CLI_FLAG("--apart",
                 "labels, or regions, become bodies of their own that\ntouch, slide and come apart "
                 "where they meet; without:\nthey hang together",
                 &s.apart),
        CLI_TEXT("--names", "FILE", "names of the labels, a line LABEL,NAME for each", &s.names),
        CLI_FLAG("--list", "list the image's labels, and do nothing else", &s.list),
        CLI_COUNT("--elements", "N", "about so many elements (5000)", &s.elements, 1, 1e7),
        CLI_REAL("--size", "M", "edge of an element in metres, instead of --elements", &s.size,
                 1e-6, 10),
        CLI_FLAG("--real-time",
                 "as many elements as keep the clock on this machine,\nwith a third in reserve: "
                 "meshes are made and measured",
                 &s.real_time),
        CLI_REAL("--scale", "S",
                 "surfaces and meshes: metres per unit of the file,\n0.001 for millimetres (1)",
                 &s.scale, 1e-9, 1e9),
        CLI_FLAG("--principal", "elements along the body's principal axes, not the\nimage's",
                 &s.principal),
        CLI_FLAG("--voxel",
                 "cubes on a grid, not fitted; without --elements and\n--size the image's own "
                 "voxels",
                 &s.voxel),
        CLI_CHOICE(
            "--fix", "SIDE",
            "where the scene holds it: left, right, back, front,\nbottom, top, cut (where the "
            "image cuts it off), none;\nwithout: cut where there is one, else back, and on\npads "
            "where its weight asks for them",
            &s.fix, fix_names),
        CLI_TEXT("--fibres", "RULE",
                 "along what fibres run, as `direction` of a scene says it,\nfor example \"axis: "
                 "[0, 0, 1]\"",
                 &s.fibres),
        CLI_TEXT("--fibres-in", "NAME", "the region that has them; without: all but bones",
                 &s.fibres_in),
        CLI_TEXTS("--tissue", "[REGION=]FILE",
                  "a tissue file for a region, or for all but bones, in\nplace of a figure of the "
                  "literature; may be given again",
                  &s.tissues),
        CLI_TEXT("--title", "TEXT", "title, and the name of the files", &s.title),
        CLI_TEXT("--out", "DIR", "folder for the files; without: called as the title", &s.out),
        CLI_FLAG("--force", "replace files that are there", &s.force),
        CLI_FLAG("--json", "the report as one JSON object on standard output", &s.json),
        CLI_END};
    int status = cli_parse(&cli_mesh, options, argc, argv, s.input, INPUTS_MAX);
    if (status >= 0) return status;
    while (s.inputs < INPUTS_MAX && s.input[s.inputs]) s.inputs++;
    if (s.list) return list_labels(&s);
    status = check_settings(&s);
    return status ? status : mesh(&s);
}

const cli_command cli_mesh = {
    .name = "mesh",
    .summary = "make a model of a segmented scan, of surfaces or of tetrahedra",
    .arguments = "INPUT...",
    .description =
        "Meshes a label image (.nii .nii.gz .nrrd .nhdr), closed surfaces (.stl .obj .vtk .vtp),\n"
        "one region each, or the boundary and regions of a mesh of tetrahedra (.msh .vtu .vtk\n"
        ".inp .feb) with hexahedra that lie on the true boundary and run in real time. Writes\n"
        "the mesh, the embedded surface and a scene with materials, a support and a pull, which\n"
        "runs as it is and says in comments what to change. Lengths are metres.",
    .examples = "  lariat mesh scan.nii.gz --list\n"
                "  lariat mesh scan.nii.gz --label liver --names labels.csv\n"
                "  lariat mesh scan.seg.nrrd --label 3 --label 4 --elements 20000 --out chest\n"
                "  lariat mesh liver.stl tumour.stl --scale 0.001 --fix top\n"
                "  lariat mesh organ.msh --scale 0.001\n",
    .main = mesh_main};
