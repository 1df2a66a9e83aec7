/* From label images, closed surfaces or other meshes to a hexahedral mesh: the public calls, and
 * the line of steps behind them (meshing/grid/voxel_grid.h draws it). */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/thread.h"
#include "meshing/fine_surface.h"
#include "meshing/fit/fit.h"
#include "meshing/grid/voxel_grid_check.h"
#include "meshing/meshing.h"
#include "model/format/mesh_io.h"

/* The mesh that is made when nothing is said, and the smallest that is one. */
enum { ELEMENTS_DEFAULT = 5000, ELEMENTS_MIN = 8 };

lar_meshing_options lar_meshing_options_default(void) {
    return (lar_meshing_options){.elements = ELEMENTS_DEFAULT, .scale = 1};
}

void lar_meshing_destroy(lar_meshing *meshing) {
    if (!meshing) return;
    lar_starter_clear_tissues(meshing);
    lar_boundary_clear(&meshing->boundary);
    lar_mesh_clear(&meshing->mesh);
    lar_triangles_clear(&meshing->outer);
    free(meshing->region);
    free(meshing->title);
    free(meshing->stem);
    free(meshing->from);
    free(meshing->scene);
    free(meshing->text);
    free(meshing->set);
    free(meshing->fibres);
    free(meshing);
}

/* ---- what is asked for -------------------------------------------------------------------- */

/* One meshing under way, of files, of an image or of surfaces. */
typedef struct work {
    const char *const *path; /* of what is given: how messages call it */
    int32_t count;
    const lar_surface_arrays *given; /* [count]; NULL: none */
    const lar_image *image;          /* given, or `read`; NULL: none yet */
    lar_meshing_options options;
    lar_meshing *meshing;
    lar_image read;
    lar_voxel_grid voxel_grid;
    lar_cleaning cleaning;
    lar_unfitted_mesh unfitted;
    lar_dropped dropped;
    lar_error *error;
} work;

static lar_status refuse(const work *w, const char *format, const char *text) {
    return lar_fail(w->error, LAR_ERROR_ARGUMENT, format, text);
}

static lar_status check_paths(work *w) {
    w->meshing->image = w->image != NULL;
    for (int32_t i = 0; i < w->count && !w->image && !w->given; i++) {
        const char *path = w->path[i];
        if (!path || !*path)
            return refuse(w, "%s", "the name of a file to mesh is empty; give one");
        bool image = lar_image_ending(path) != NULL, solids = lar_mesh_named(path);
        if (!image && !solids && !lar_triangles_named(path))
            return refuse(w,
                          "%.400s: this extension is not known; label images are .nii .nii.gz "
                          ".nrrd .nhdr, surfaces .stl .obj .vtk .vtp, meshes .msh .vtu .vtk .inp "
                          ".feb",
                          path);
        if ((image || solids) && w->count > 1)
            return lar_fail(w->error, LAR_ERROR_ARGUMENT,
                            "%.400s is %s, and other files are given besides: mesh one image, one "
                            "mesh, or surfaces of one region each",
                            path, image ? "an image" : "a mesh");
        w->meshing->image = image;
        w->meshing->solids = solids;
    }
    return LAR_OK;
}

static lar_status check_image_options(const work *w) {
    const lar_meshing_options *o = &w->options;
    if (w->meshing->image && o->scale > 0 && o->scale != 1)
        return refuse(w, "%.400s: an image says how large it is; a scale is for surfaces only",
                      w->path[0]);
    if (w->image && o->names)
        return refuse(w,
                      "%.400s: an image in memory brings the names of its labels along; a file "
                      "of names is for one of a file",
                      w->path[0]);
    if (w->meshing->image) return LAR_OK;
    if (o->label_count > 0)
        return refuse(w,
                      w->meshing->solids
                          ? "%.400s: labels are for images; all regions of a mesh are taken"
                          : "%.400s: a surface has no labels; each file is one region",
                      w->path[0]);
    if (o->names)
        return refuse(w,
                      "%.400s: names of labels are for images; surfaces are called as their "
                      "files are, regions of meshes as their sets",
                      w->path[0]);
    if (o->fuse && !w->meshing->solids)
        return refuse(w,
                      "%.400s: only labels of an image can be fused; join the surfaces in the "
                      "program that made them",
                      w->path[0]);
    return LAR_OK;
}

static lar_status check_options(work *w) {
    const lar_meshing_options *o = &w->options;
    if (!isfinite(o->size) || o->size < 0 || !isfinite(o->scale) || o->scale < 0)
        return refuse(w, "%s", "size and scale are finite and not negative; 0 is the default");
    if (o->elements < 0 || o->label_count < 0 || (o->label_count > 0 && !o->labels) ||
        o->tissue_count < 0 || (o->tissue_count > 0 && !o->tissues))
        return refuse(w, "%s",
                      "the numbers of elements, labels and tissues are not negative, and labels "
                      "and tissues are not NULL");
    if (o->size > 0 && o->elements > 0)
        return refuse(w, "%s",
                      "size and number of elements are both given; one follows from the "
                      "other, set one of them to 0");
    if (o->title && !*o->title)
        return refuse(w, "%s", "the title is empty; leave it NULL or name one");
    if (o->fibre_region && !o->fibres)
        return refuse(w, "%s",
                      "a region is named for fibres, but no fibres are asked for; add a rule for "
                      "them");
    if (o->apart && o->fuse)
        return refuse(w, "%s",
                      "regions are to be fused and to be bodies of their own, apart; ask for one");
    lar_status status = check_paths(w);
    if (!status) status = lar_support_check(o->fix, w->error);
    return status ? status : check_image_options(w);
}

/* Tells the one who waits; refuses to go on when he says so. */
static lar_status tell(const work *w, const char *what, double part) {
    const lar_meshing_options *o = &w->options;
    if (!o->progress || o->progress(o->context, what, part)) return LAR_OK;
    return lar_fail(w->error, LAR_ERROR_ARGUMENT, "stopped as asked, while %s", what);
}

/* ---- titles ------------------------------------------------------------------------------- */

/* The name of a file without folder and known ending. */
static char *name_of_file(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    const char *ending = lar_image_ending(name);
    size_t length = strlen(name);
    size_t left_out = ending ? strlen(ending) : strlen(lar_path_extension(name));
    left_out += !ending && left_out > 0; /* the dot */
    return lar_strndup(name, left_out < length ? length - left_out : length);
}

static char *name_of(const work *w, int32_t i) {
    return w->given ? lar_strdup(w->path[i]) : name_of_file(w->path[i]);
}

/* As a file's name that needs no quotes anywhere. */
static char *stem_of(const char *title) {
    enum { MAX = 100 }; /* with an ending it is still a name that every file system takes */
    char *stem = lar_strdup(title);
    if (stem && strlen(stem) > MAX) stem[MAX] = 0;
    for (char *c = stem; c && *c; c++) {
        bool plain = (unsigned char)*c < 128 && isalnum((unsigned char)*c);
        if (!plain && *c != '-' && *c != '.') *c = '_';
    }
    if (stem && (stem[0] == '.' || stem[0] == '-')) stem[0] = '_';
    return stem;
}

static char *joined_names(const work *w) {
    size_t length = 1;
    for (int32_t i = 0; i < w->count; i++) length += strlen(w->path[i]) + 2;
    char *all = lar_calloc(length, 1);
    for (int32_t i = 0; all && i < w->count; i++) {
        const char *slash = w->given ? NULL : strrchr(w->path[i], '/');
        const size_t used = strlen(all);
        snprintf(all + used, length - used, "%s%s", i > 0 ? ", " : "",
                 slash ? slash + 1 : w->path[i]);
    }
    return all;
}

static lar_status name_meshing(work *w) {
    lar_meshing *m = w->meshing;
    const lar_boundary *boundary = &m->boundary;
    const char *given = w->options.title;
    if (!given && boundary->region_count == 1) given = boundary->region[1].name;
    m->title = given && *given ? lar_strdup(given) : name_of(w, 0);
    m->stem = m->title ? stem_of(m->title) : NULL;
    m->from = joined_names(w);
    if (!m->title || !m->stem || !m->from) return lar_fail_memory(w->error, 256, "a title");
    m->info.title = m->title;
    m->info.name = m->stem;
    return LAR_OK;
}

/* ---- the true boundary -------------------------------------------------------------------- */

static lar_status boundary_of_image(work *w) {
    const lar_meshing_options *o = &w->options;
    const lar_label_choice choice = {o->label_count, o->labels, o->fuse != 0};
    lar_status status = tell(w, "reading", 0);
    if (!status && !w->image) {
        status = lar_image_read(w->path[0], &w->read, w->error);
        w->image = &w->read;
    }
    if (!status && o->names) status = lar_image_read_names(o->names, &w->read, w->error);
    if (!status) status = tell(w, "finding the boundary", 0);
    if (!status)
        status = lar_boundary_from_image(w->image, &choice, &w->meshing->boundary, w->error);
    return status;
}

static lar_status boundary_of_surfaces(work *w) {
    lar_triangles *surface = lar_calloc((size_t)w->count, sizeof *surface);
    char **name = lar_calloc((size_t)w->count, sizeof *name);
    double scale = w->options.scale > 0 ? w->options.scale : 1;
    lar_status status =
        surface && name ? LAR_OK : lar_fail_memory(w->error, sizeof *surface, "surfaces");
    for (int32_t i = 0; !status && i < w->count; i++) {
        status = tell(w, "reading", (double)i / w->count);
        if (!status)
            status = w->given ? lar_meshing_take_surface(&w->given[i], scale, &surface[i], w->error)
                              : lar_triangles_read(w->path[i], scale, &surface[i], w->error);
        if (!status && !(name[i] = name_of(w, i)))
            status = lar_fail_memory(w->error, strlen(w->path[i]), "a name");
    }
    if (!status) status = tell(w, "checking surfaces", 0);
    bool taken = !status;
    if (taken)
        status = lar_boundary_from_surfaces(surface, (const char *const *)name, w->count,
                                            &w->meshing->boundary, w->error);
    for (int32_t i = 0; i < w->count; i++) {
        if (surface && !taken) lar_triangles_clear(&surface[i]);
        if (name) free(name[i]);
    }
    free(surface);
    free(name);
    return status;
}

static lar_status boundary_of_mesh(work *w) {
    double scale = w->options.scale > 0 ? w->options.scale : 1;
    char *name = name_of_file(w->path[0]);
    if (!name) return lar_fail_memory(w->error, strlen(w->path[0]), "a name");
    lar_status status = tell(w, "reading", 0);
    if (!status)
        status = lar_boundary_from_mesh(w->path[0], scale, w->options.fuse != 0, name,
                                        &w->meshing->boundary, &w->meshing->info.joined, w->error);
    free(name);
    return status;
}

/* Regions of one name get their tags behind it: a scene has each material once. */
static lar_status tell_names_apart(lar_boundary *boundary, lar_error *error) {
    for (int32_t r = 2; r <= boundary->region_count; r++) {
        lar_region *region = &boundary->region[r];
        for (int32_t s = 1; s < r; s++) {
            const char *known = boundary->region[s].name;
            if (!known || !region->name || strcmp(known, region->name) != 0) continue;
            size_t size = strlen(known) + 24;
            char *name = lar_calloc(size, 1);
            if (!name) return lar_fail_memory(error, size, "a name");
            snprintf(name, size, "%s (%d)", known, (int)region->tag);
            free(region->name);
            region->name = name;
            s = 0; /* that may be another one's */
        }
    }
    return LAR_OK;
}

static lar_status make_boundary(work *w) {
    lar_meshing *m = w->meshing;
    lar_status status = m->image    ? boundary_of_image(w)
                        : m->solids ? boundary_of_mesh(w)
                                    : boundary_of_surfaces(w);
    if (!status) status = tell_names_apart(&m->boundary, w->error);
    if (!status) status = name_meshing(w);
    if (!status && w->options.principal)
        status = lar_boundary_principal_axes(&m->boundary, w->error);
    if (!status) status = lar_boundary_outer(&m->boundary, &m->outer, w->error);
    return status;
}

/* ---- from there to a mesh ------------------------------------------------------------------ */

static lar_status fill_voxel_grid(work *w) {
    const lar_meshing_options *o = &w->options;
    const lar_boundary *boundary = &w->meshing->boundary;
    int32_t elements = o->elements > 0 ? o->elements : ELEMENTS_DEFAULT;
    if (o->voxel && o->size <= 0 && o->elements <= 0 && w->meshing->image) {
        if (o->principal)
            return refuse(w, "%s",
                          "the image's own voxels lie along the image's axes, not the "
                          "body's; give a size or a number of elements with principal "
                          "axes");
        return lar_voxel_grid_from_image(w->image, boundary, &w->voxel_grid, w->error);
    }
    if (o->size > 0) return lar_voxel_grid_fill(boundary, o->size, &w->voxel_grid, w->error);
    lar_status status =
        lar_voxel_grid_check_thickness(boundary, &w->meshing->outer, elements, w->error);
    if (status) return status;
    return lar_voxel_grid_fill_count(boundary, elements, &w->voxel_grid, w->error);
}

static lar_status check_count(const work *w) {
    int32_t count = w->unfitted.mesh.element_count;
    if (count >= ELEMENTS_MIN) return LAR_OK;
    return lar_fail(w->error, LAR_ERROR_MODEL,
                    "%.200s: elements of %.3g m are too large: the body becomes %d of them, at "
                    "least %d are a mesh; ask for a smaller size (in metres) or for more elements",
                    w->path[0], w->unfitted.size, (int)count, ELEMENTS_MIN);
}

static bool fit_progress(void *context, double part) {
    const work *w = context;
    return tell(w, "fitting", part) == LAR_OK;
}

static lar_status make_mesh(work *w) {
    lar_meshing *m = w->meshing;
    const lar_fit_options fit = {
        .dropped = w->dropped.volume, .progress = fit_progress, .context = w};
    lar_status status = tell(w, "laying the grid", 0);
    if (!status) status = fill_voxel_grid(w);
    lar_image_clear(&w->read);
    if (!status) status = tell(w, "cleaning", 0);
    if (!status) status = lar_voxel_grid_clean(&w->voxel_grid, &w->cleaning, w->error);
    if (!status)
        status = lar_voxel_grid_check_reach(&m->boundary, &m->outer, &w->voxel_grid, w->error);
    if (!status) status = lar_unfitted_create(&w->voxel_grid, &m->boundary, &w->unfitted, w->error);
    lar_voxel_grid_clear(&w->voxel_grid);
    if (!status) status = check_count(w);
    if (!status)
        status = lar_fine_surface_drop(&w->unfitted.mesh, w->unfitted.size, &m->boundary, &m->outer,
                                       &w->dropped, w->error);
    m->fitted = !w->options.voxel;
    if (!status && m->fitted) status = lar_fit(&m->boundary, &w->unfitted, &fit, w->error);
    m->info.size = w->unfitted.size;
    m->apart = w->options.apart;
    if (!status)
        status = lar_unfitted_finish(&w->unfitted, &m->boundary, m->apart ? &m->info.parted : NULL,
                                     &m->mesh, w->error);
    return status;
}

/* ---- what came out ------------------------------------------------------------------------ */

static void count_regions(lar_meshing *m) {
    for (int32_t r = 0; r < m->info.regions; r++) {
        const lar_region *true_region = &m->boundary.region[r + 1];
        const lar_tissue *tissue = lar_tissue_find(true_region->name ? true_region->name : "");
        double g = tissue->shear_modulus, v = tissue->poisson_ratio;
        lar_region_info *region = &m->region[r];
        *region = (lar_region_info){.name = true_region->name ? true_region->name : "",
                                    .tag = true_region->tag,
                                    .true_volume = true_region->volume,
                                    .tissue = tissue->name,
                                    .source = tissue->source,
                                    .shear_modulus = g,
                                    .bulk_modulus = 2 * g * (1 + v) / (3 * (1 - 2 * v)),
                                    .density = tissue->density,
                                    .held = tissue->rigid,
                                    .usual_max = tissue->max};
        if (m->given[r].path) {
            region->source = m->given[r].path;
            region->shear_modulus = m->given[r].shear;
            region->bulk_modulus = m->given[r].bulk;
            region->density = m->given[r].density;
        }
        m->info.quality.true_volume += region->true_volume;
        for (int32_t e = 0; e < m->mesh.element_count; e++) {
            double corner[8][3];
            if (m->mesh.element_tag[e] != region->tag) continue;
            lar_mesh_corners(&m->mesh, e, corner);
            region->elements++;
            region->volume += lar_hexahedron_volume(corner);
        }
    }
}

static lar_status measure(const work *w, lar_error *error) {
    lar_meshing *m = w->meshing;
    /* Bodies that come apart show what no outer surface has: where they met. */
    if (m->apart)
        return lar_quality_measure(&m->mesh, &m->boundary.triangles, &m->info.quality, error);
    lar_status status = lar_quality_measure(&m->mesh, &m->outer, &m->info.quality, error);
    return status ? status : lar_fine_surface_draw(&m->mesh, m->info.size, &m->outer, error);
}

/* A mesh that holds so much less, or more, than the body is not the body's. Cubes stand off more.
 */
static lar_status check_volume(const work *w) {
    const lar_mesh_quality *quality = &w->meshing->info.quality;
    const double max = w->meshing->fitted ? 0.2 : 0.5;
    double aim = quality->true_volume;
    for (int r = 1; r <= w->meshing->info.regions; r++) aim -= w->dropped.volume[r];
    const double off = quality->volume / aim - 1;
    if (!(aim > 0) || fabs(off) <= max) return LAR_OK;
    return lar_fail(w->error, LAR_ERROR_MODEL,
                    "%.300s: the mesh would hold %.3g mL, %.0f %% %s than the body, of which parts "
                    "are thinner than an element of %.3g mm; ask for more elements or a smaller "
                    "size",
                    w->path[0], 1e6 * quality->volume, 100 * fabs(off), off < 0 ? "less" : "more",
                    1e3 * w->meshing->info.size);
}

/* Two that need nothing from each other and take about as long. */
typedef struct judging {
    const work *work;
    lar_status status[2];
    lar_error error[2];
} judging;

static void *measure_beside(void *context) {
    judging *both = context;
    both->status[1] = measure(both->work, &both->error[1]);
    return NULL;
}

static bool measuring_goes_on(void *context) {
    return tell(context, "measuring", 0) == LAR_OK;
}

/* The support on this thread, which may ask whether to go on. */
static lar_status judge(work *w) {
    lar_meshing *m = w->meshing;
    judging both = {.work = w};
    lar_thread thread;
    bool beside = !lar_thread_start(&thread, measure_beside, &both);
    m->goes_on = measuring_goes_on;
    m->asker = w;
    both.status[0] = lar_support_choose(m, w->options.fix, &both.error[0]);
    m->goes_on = NULL;
    if (beside)
        lar_thread_join(&thread);
    else if (!both.status[0])
        measure_beside(&both);
    for (int i = 0; i < 2; i++) {
        if (!both.status[i]) continue;
        *w->error = both.error[i];
        return both.status[i];
    }
    return tell(w, "measuring", 1);
}

static lar_status lay_fibres(work *w) {
    lar_meshing *m = w->meshing;
    m->fibres = lar_strdup(w->options.fibres);
    if (!m->fibres)
        return lar_fail_memory(w->error, strlen(w->options.fibres), "a rule for fibres");
    m->fibre_region = w->options.fibre_region;
    return lar_starter_lay_fibres(m, w->error);
}

static lar_status describe(work *w) {
    lar_meshing *m = w->meshing;
    const lar_cleaning *did = &w->cleaning;
    lar_meshing_info *info = &m->info;
    info->image = m->image;
    info->nodes = m->mesh.node_count;
    info->elements = m->mesh.element_count;
    info->regions = m->boundary.region_count;
    info->islands = did->islands, info->island_cells = did->island_cells;
    info->pinholes = w->dropped.hollows > did->pinholes ? w->dropped.hollows : did->pinholes;
    info->pinhole_cells = did->pinhole_cells;
    info->added = did->added, info->removed = did->removed;
    info->cuts = m->boundary.cut_count;
    m->region = lar_calloc((size_t)info->regions, sizeof *m->region);
    if (!m->region) return lar_fail_memory(w->error, sizeof *m->region, "regions");
    count_regions(m);
    lar_status status = tell(w, "measuring", 0);
    if (!status) status = judge(w);
    if (m->apart) lar_triangles_clear(&m->outer);
    if (!status) status = check_volume(w);
    if (!status && w->options.fibres) status = lay_fibres(w);
    if (!status) status = lar_starter_check_tissues(m, w->error);
    return status ? status : lar_meshing_list_sets(m, w->error);
}

/* Makes it of what the work names. */
static lar_status create(work *w, const lar_meshing_options *options, lar_meshing **meshing,
                         lar_error *error) {
    lar_error own;
    w->error = error ? error : &own;
    if (options) w->options = *options;
    w->meshing = lar_calloc(1, sizeof *w->meshing);
    if (!w->meshing) return lar_fail_memory(error, sizeof *w->meshing, "a meshing");
    lar_status status = check_options(w);
    if (!status) status = make_boundary(w);
    if (!status) status = lar_starter_take_tissues(w->meshing, &w->options, w->error);
    if (!status) status = make_mesh(w);
    if (!status) status = describe(w);
    lar_image_clear(&w->read);
    lar_voxel_grid_clear(&w->voxel_grid);
    lar_unfitted_clear(&w->unfitted);
    if (status)
        lar_meshing_destroy(w->meshing);
    else
        *meshing = w->meshing;
    return status;
}

lar_status lar_meshing_create(const char *const *paths, int32_t count,
                              const lar_meshing_options *options, lar_meshing **meshing,
                              lar_error *error) {
    if (!paths || count < 1 || !meshing)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_meshing_create needs at least one file and a place for the meshing; "
                        "neither may be NULL");
    work w = {.path = paths, .count = count};
    return create(&w, options, meshing, error);
}

lar_status lar_meshing_of_image(const lar_image *image, const lar_meshing_options *options,
                                lar_meshing **meshing, lar_error *error) {
    if (!image || !meshing)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_meshing_of_image needs an image and a place for the meshing");
    const char *const name = image->source;
    work w = {.path = &name, .count = 1, .image = image};
    return create(&w, options, meshing, error);
}

lar_status lar_meshing_of_surfaces(const lar_surface_arrays *surface, int32_t count,
                                   const lar_meshing_options *options, lar_meshing **meshing,
                                   lar_error *error) {
    const char *name[LAR_REGIONS_MAX];
    if (!surface || !meshing || count < 1 || count > LAR_REGIONS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_meshing_of_surfaces needs 1 to %d surfaces and a place for the "
                        "meshing",
                        (int)LAR_REGIONS_MAX);
    for (int32_t i = 0; i < count; i++)
        name[i] = surface[i].name && *surface[i].name ? surface[i].name : "surface";
    work w = {.path = name, .count = count, .given = surface};
    return create(&w, options, meshing, error);
}

void lar_meshing_inspect(const lar_meshing *meshing, lar_meshing_info *info) {
    if (info) *info = meshing ? meshing->info : (lar_meshing_info){0};
}

lar_status lar_meshing_region(const lar_meshing *meshing, int32_t index, lar_region_info *info,
                              lar_error *error) {
    if (!meshing || !info)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_meshing_region needs a meshing and a place for the answer; neither "
                        "may be NULL");
    if (index < 0 || index >= meshing->info.regions)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no region %ld; the meshing has %ld, counted from 0", (long)index,
                        (long)meshing->info.regions);
    *info = meshing->region[index];
    return LAR_OK;
}
