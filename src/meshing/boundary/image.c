#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/vector.h"
#include "meshing/boundary/nets.h"

enum { VOXELS_MIN = 8, LABELS = LAR_IMAGE_LABEL_MAX + 1 };

typedef struct maker {
    const lar_image *image;
    const lar_label_choice *choice;
    lar_boundary *boundary;
    int64_t *count; /* [LABELS] voxels in the image */
    double *voxels; /* [LAR_REGIONS_MAX + 1] of each region */
} maker;

/* ---- which labels --------------------------------------------------------------------------- */

/* "1, 2, 3 (liver), .." as far as they fit. */
static void list_labels(const maker *m, char *text, size_t size) {
    size_t used = 0;
    text[0] = '\0';
    for (int32_t label = 1; label < LABELS; label++) {
        if (!m->count[label]) continue;
        const char *name = lar_image_label_name(m->image, label);
        char word[64];
        snprintf(word, sizeof word, "%s%d%s%.40s%s", used ? ", " : "", (int)label, name ? " (" : "",
                 name ? name : "", name ? ")" : "");
        size_t length = strlen(word);
        if (used + length + 6 > size) {
            strcpy(text + used, ", ..");
            return;
        }
        strcpy(text + used, word);
        used += length;
    }
}

/* Of several labels of one name the first that has voxels. */
static int32_t label_named(const maker *m, const char *word) {
    int32_t found = -1;
    for (int32_t n = 0; n < m->image->name_count; n++) {
        const lar_label_name *name = &m->image->name[n];
        if (strcasecmp(name->name, word) != 0 || name->label < 0 || name->label >= LABELS) continue;
        if (m->count[name->label]) return name->label;
        if (found < 0) found = name->label;
    }
    return found;
}

static lar_status find_label(const maker *m, const char *word, int32_t *label, lar_error *error) {
    char *end, known[300];
    long number = strtol(word, &end, 10);
    *label = label_named(m, word);
    if (*label < 0 && end != word && !*end && number >= 0 && number < LABELS)
        *label = (int32_t)number;
    list_labels(m, known, sizeof known);
    if (*label < 0)
        return lar_fail(error, LAR_ERROR_MODEL, "%s: there is no label \"%s\"; there are %s",
                        m->image->source, word, known);
    if (*label == 0)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: label 0 is what belongs to no organ; there are %s", m->image->source,
                        known);
    if (m->count[*label]) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL, "%s: label \"%s\" has no voxel; there are %s",
                    m->image->source, word, known);
}

static lar_status name_region(lar_region *region, const char *name, int32_t label,
                              lar_error *error) {
    char number[32];
    snprintf(number, sizeof number, "label_%d", (int)label);
    region->name = lar_strdup(name ? name : number);
    region->tag = label;
    return region->name ? LAR_OK : lar_fail_memory(error, sizeof number, "a name");
}

static lar_status add_label(maker *m, int32_t label, lar_error *error) {
    lar_boundary *boundary = m->boundary;
    bool fuse = m->choice && m->choice->fuse;
    uint8_t *region_of = &boundary->region_of_label[label];
    if (*region_of) return LAR_OK; /* named twice */
    if (!fuse || boundary->region_count == 0) {
        if (boundary->region_count == LAR_REGIONS_MAX)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: more than %d labels; choose some, or fuse them", m->image->source,
                            (int)LAR_REGIONS_MAX);
        int32_t region = ++boundary->region_count;
        lar_status status = name_region(&boundary->region[region],
                                        lar_image_label_name(m->image, label), label, error);
        if (status) return status;
    } else if (boundary->region[1].tag != 1 || strcmp(boundary->region[1].name, "body") != 0) {
        free(boundary->region[1].name);
        boundary->region[1].name = NULL;
        lar_status status = name_region(&boundary->region[1], "body", 1, error);
        if (status) return status;
    }
    *region_of = (uint8_t)boundary->region_count;
    m->voxels[*region_of] += (double)m->count[label];
    return LAR_OK;
}

/* A region of a few voxels is no body. Where all labels are meshed together, such strays have no
 * say: they get the elements that they fill, which may be none. */
static lar_status check_regions(const maker *m, lar_error *error) {
    const lar_boundary *boundary = m->boundary;
    bool named = m->choice && m->choice->count > 0;
    if (boundary->region_count == 0)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: no voxel has a label; all are 0, which belongs to no organ",
                        m->image->source);
    int32_t largest = 1;
    for (int32_t r = 1; r <= boundary->region_count; r++) {
        if (m->voxels[r] > m->voxels[largest]) largest = r;
        if (named && m->voxels[r] < VOXELS_MIN) largest = r, r = boundary->region_count;
    }
    if (m->voxels[largest] >= VOXELS_MIN) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: label %d (%s) has %.0f voxel%s only, too few for a body (%d at least); "
                    "choose another label",
                    m->image->source, (int)boundary->region[largest].tag,
                    boundary->region[largest].name, m->voxels[largest],
                    m->voxels[largest] == 1 ? "" : "s", (int)VOXELS_MIN);
}

static lar_status choose_labels(maker *m, lar_error *error) {
    const lar_label_choice *choice = m->choice;
    lar_status status = LAR_OK;
    lar_image_count(m->image, m->count);
    for (int32_t w = 0; choice && w < choice->count && !status; w++) {
        int32_t label;
        status = find_label(m, choice->word[w], &label, error);
        if (!status) status = add_label(m, label, error);
    }
    for (int32_t label = 1; label < LABELS && !(choice && choice->count) && !status; label++)
        if (m->count[label]) status = add_label(m, label, error);
    if (!status) status = check_regions(m, error);
    double voxel = lar_image_voxel_volume(m->image);
    for (int32_t r = 1; r <= m->boundary->region_count; r++)
        m->boundary->region[r].volume = m->voxels[r] * voxel;
    return status;
}

/* ---- axes and cuts -------------------------------------------------------------------------- */

/* The image's axes; a sheared image's second and third are turned square to those before, and a
 * left-handed one's third turned round. */
static void set_axes(const lar_image *image, lar_boundary *boundary) {
    double step[3][3];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) step[a][b] = image->to_world[b][a];
    for (int a = 0; a < 2; a++) {
        double *axis = boundary->axis[a];
        memcpy(axis, step[a], sizeof step[a]);
        double along = a ? lar_dot(step[1], boundary->axis[0]) : 0;
        for (int b = 0; b < 3; b++) axis[b] -= along * boundary->axis[0][b];
        double length = lar_length(axis);
        for (int b = 0; b < 3; b++) axis[b] /= length;
    }
    lar_cross(boundary->axis[0], boundary->axis[1], boundary->axis[2]);
}

/* Normals of the image's sides i, j, k in the world, towards higher indices. */
static void set_normals(const lar_image *image, double normal[3][3]) {
    double step[3][3];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) step[a][b] = image->to_world[b][a];
    for (int a = 0; a < 3; a++) {
        lar_cross(step[(a + 1) % 3], step[(a + 2) % 3], normal[a]);
        double length = lar_length(normal[a]);
        if (lar_dot(normal[a], step[a]) < 0) length = -length;
        for (int b = 0; b < 3; b++) normal[a][b] /= length;
    }
}

/* The world's axis for each of the image's, each once: the permutation that fits best. */
static void match_axes(double normal[3][3], int world[3]) {
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                    {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    double best = -1;
    for (int p = 0; p < 6; p++) {
        double sum = 0;
        for (int a = 0; a < 3; a++) sum += fabs(normal[a][order[p][a]]);
        if (sum <= best + 1e-9) continue;
        best = sum;
        memcpy(world, order[p], sizeof order[p]);
    }
}

static void set_cuts(const lar_image *image, lar_boundary *boundary) {
    static const char *const name[3][2] = {{"left", "right"}, {"back", "front"}, {"bottom", "top"}};
    double normal[3][3];
    int world[3] = {0, 1, 2};
    set_normals(image, normal);
    match_axes(normal, world);
    bool there[LAR_CUTS] = {false};
    for (int32_t t = 0; t < boundary->triangles.triangle_count; t++)
        if (boundary->side[t][0] >= LAR_REGION_CUT)
            there[boundary->side[t][0] - LAR_REGION_CUT] = true;
    for (int s = 0; s < LAR_CUTS; s++) {
        if (!there[s]) continue;
        lar_cut *cut = &boundary->cut[s];
        int axis = s / 2, high = s % 2;
        double middle[3];
        for (int a = 0; a < 3; a++) middle[a] = 0.5 * (image->size[a] - 1);
        middle[axis] = high ? image->size[axis] - 0.5 : -0.5;
        for (int b = 0; b < 3; b++) {
            const double *row = image->to_world[b];
            cut->through[b] = row[0] * middle[0] + row[1] * middle[1] + row[2] * middle[2] + row[3];
            cut->normal[b] = high ? normal[axis][b] : -normal[axis][b];
        }
        strcpy(cut->name, name[world[axis]][cut->normal[world[axis]] > 0]);
        boundary->cut_count++;
    }
}

/* ---- into the world ------------------------------------------------------------------------- */

static lar_status take_nets(const lar_image *image, const lar_nets *nets, lar_boundary *boundary,
                            lar_error *error) {
    size_t vertices = (size_t)nets->vertex_count, triangles = 2 * (size_t)nets->quad_count;
    lar_triangles *made = &boundary->triangles;
    made->vertex = lar_calloc(vertices, sizeof *made->vertex);
    made->corner = lar_calloc(triangles, sizeof *made->corner);
    boundary->side = lar_calloc(triangles, sizeof *boundary->side);
    made->source = lar_strdup(image->source ? image->source : "image");
    if (!made->vertex || !made->corner || !boundary->side || !made->source)
        return lar_fail_memory(error, 24 * vertices + 16 * triangles, "the regions' surfaces");
    made->vertex_count = nets->vertex_count;
    made->triangle_count = 2 * nets->quad_count;
    for (size_t v = 0; v < vertices; v++)
        for (int b = 0; b < 3; b++) {
            made->vertex[v][b] = image->to_world[b][3];
            for (int a = 0; a < 3; a++)
                made->vertex[v][b] +=
                    image->to_world[b][a] * (nets->start[v][a] + nets->moved[v][a] - 0.5);
        }
    double step[3][3], normal[3];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) step[a][b] = image->to_world[b][a];
    lar_cross(step[0], step[1], normal);
    int left_handed = lar_dot(normal, step[2]) < 0;
    for (int32_t q = 0; q < nets->quad_count; q++)
        for (int half = 0; half < 2; half++) {
            int32_t t = 2 * q + half;
            const int order[3] = {0, 1 + half + left_handed, 2 + half - left_handed};
            for (int c = 0; c < 3; c++)
                made->corner[t][c] = nets->corner[q][(order[c] + nets->diagonal[q]) % 4];
            memcpy(boundary->side[t], nets->side[q], sizeof *boundary->side);
        }
    return LAR_OK;
}

static lar_status make(maker *m, lar_error *error) {
    lar_boundary *boundary = m->boundary;
    m->count = lar_calloc(LABELS, sizeof *m->count);
    m->voxels = lar_calloc(LAR_REGIONS_MAX + 1, sizeof *m->voxels);
    boundary->region_of_label = lar_calloc(LABELS, 1);
    boundary->region = lar_calloc(LAR_REGIONS_MAX + 1, sizeof *boundary->region);
    if (!m->count || !m->voxels || !boundary->region_of_label || !boundary->region)
        return lar_fail_memory(error, 9 * LABELS, "the image's labels");
    lar_status status = choose_labels(m, error);
    lar_nets nets = {0};
    if (!status) status = lar_nets_create(m->image, boundary->region_of_label, &nets, error);
    if (!status) status = lar_nets_relax(&nets, boundary->region_count, m->voxels, error);
    if (!status) status = take_nets(m->image, &nets, boundary, error);
    lar_nets_clear(&nets);
    if (status) return status;
    set_axes(m->image, boundary);
    set_cuts(m->image, boundary);
    return LAR_OK;
}

lar_status lar_boundary_from_image(const lar_image *image, const lar_label_choice *choice,
                                   lar_boundary *boundary, lar_error *error) {
    *boundary = (lar_boundary){0};
    maker m = {.image = image, .choice = choice, .boundary = boundary};
    lar_status status = make(&m, error);
    free(m.count);
    free(m.voxels);
    if (status) lar_boundary_clear(boundary);
    return status;
}
