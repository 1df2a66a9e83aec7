#include "meshing/boundary/nets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void lar_nets_clear(lar_nets *nets) {
    free(nets->start);
    free(nets->moved);
    free(nets->neighbour);
    free(nets->line);
    free(nets->thin);
    free(nets->corner);
    free(nets->side);
    free(nets->diagonal);
    *nets = (lar_nets){0};
}

enum { NO_REGION = UINT16_MAX, SLICES = 4 };

/* Goes through the image slice by slice: once to count, once to write. */
typedef struct scan {
    const lar_image *image;
    const uint8_t *region_of_label;
    lar_nets *nets;
    bool write;
    uint8_t *slice[SLICES]; /* regions of voxels: this slice, the next, two before; k % SLICES */
    uint8_t *nothing;       /* a row of zeros */
    int32_t *corners[2]; /* vertices of the corners below this slice and above it; -1: none yet */
    uint16_t (*around)[3][2]; /* first two regions at a vertex's edges along +i, +j, +k */
    int64_t vertices, quads;
} scan;

static int32_t vertex_at(scan *s, const int32_t at[3], int32_t slice) {
    size_t index = (size_t)at[1] * (size_t)s->nets->size[0] + (size_t)at[0];
    int32_t *vertex = &s->corners[at[2] - slice][index];
    if (*vertex < 0) {
        *vertex = (int32_t)s->vertices++;
        if (s->write) {
            memcpy(s->nets->start[*vertex], at, 3 * sizeof *at);
            for (int d = 0; d < 6; d++) s->nets->neighbour[*vertex][d] = -1;
            memset(s->around[*vertex], 0xff, sizeof *s->around);
        }
    }
    return *vertex;
}

/* A region comes to an edge: with the third one it is a line. */
static void add_region(scan *s, int32_t low, int32_t high, int axis, uint16_t region) {
    uint16_t *known = s->around[low][axis];
    if (known[0] == region || known[1] == region) return;
    if (known[0] == NO_REGION) {
        known[0] = region;
    } else if (known[1] == NO_REGION) {
        known[1] = region;
    } else {
        s->nets->line[low] |= (uint8_t)(1 << (2 * axis + 1));
        s->nets->line[high] |= (uint8_t)(1 << (2 * axis));
    }
}

static void add_edge(scan *s, int32_t low, int32_t high, int axis, const uint16_t side[2]) {
    s->nets->neighbour[low][2 * axis + 1] = high;
    s->nets->neighbour[high][2 * axis] = low;
    for (int i = 0; i < 2; i++) add_region(s, low, high, axis, side[i]);
}

/* Between the voxels below and above along `axis`, at the corner `at`. */
static void add_quad(scan *s, const int32_t at[3], int axis, uint16_t below, uint16_t above,
                     bool thin) {
    int32_t quad = (int32_t)s->quads++, corner[4];
    for (int c = 0; c < 4; c++) {
        int32_t place[3] = {at[0], at[1], at[2]};
        place[(axis + 1) % 3] += c == 1 || c == 2;
        place[(axis + 2) % 3] += c >= 2;
        corner[c] = vertex_at(s, place, at[2]);
    }
    if (!s->write) return;
    /* Outside and cuts are in front; of two regions the smaller one. */
    bool above_in_front =
        above == 0 || above >= LAR_REGION_CUT || (below < LAR_REGION_CUT && below && above < below);
    uint16_t side[2] = {above_in_front ? above : below, above_in_front ? below : above};
    memcpy(s->nets->side[quad], side, sizeof side);
    for (int c = 0; c < 4; c++) {
        s->nets->corner[quad][c] = corner[above_in_front ? c : (4 - c) % 4];
        if (thin) s->nets->thin[corner[c]] |= (uint8_t)(1 << axis);
    }
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    add_edge(s, corner[0], corner[1], b, side);
    add_edge(s, corner[3], corner[2], b, side);
    add_edge(s, corner[0], corner[3], c, side);
    add_edge(s, corner[1], corner[2], c, side);
}

static int region_at(const scan *s, const int32_t at[3]) {
    size_t row = (size_t)at[1] * (size_t)s->image->size[0];
    return s->slice[at[2] % SLICES][row + (size_t)at[0]];
}

/* The voxels before the corner `at` along an axis and behind it; beyond the image there is what
 * cuts the body off. */
static void look(scan *s, const int32_t at[3], int axis) {
    int32_t end = s->image->size[axis], next[3] = {at[0], at[1], at[2]};
    uint16_t region[4] = {0}; /* of two voxels before the corner and two behind */
    for (int i = 1; i < 3; i++) {
        next[axis] = at[axis] - 2 + i;
        if (next[axis] >= 0 && next[axis] < end) region[i] = (uint16_t)region_at(s, next);
    }
    if (region[1] == region[2]) return;
    bool thin = false;
    for (int i = 0; i < 4; i += 3) {
        next[axis] = at[axis] - 2 + i;
        if (next[axis] >= 0 && next[axis] < end) thin |= region_at(s, next) != region[i ? 2 : 1];
    }
    if (at[axis] == 0) region[1] = (uint16_t)(LAR_REGION_CUT + 2 * axis);
    if (at[axis] == end) region[2] = (uint16_t)(LAR_REGION_CUT + 2 * axis + 1);
    add_quad(s, at, axis, region[1], region[2], thin);
}

/* Regions of a row of voxels; beyond the image: 0. */
static const uint8_t *row_of(const scan *s, int32_t j, int32_t k) {
    const int32_t *size = s->image->size;
    if (j < 0 || k < 0 || j == size[1] || k == size[2]) return s->nothing;
    return &s->slice[k % SLICES][(size_t)j * (size_t)size[0]];
}

/* All faces of voxels that begin at the corners of a row. */
static void scan_row(scan *s, int32_t j, int32_t k) {
    const int32_t *size = s->image->size;
    const uint8_t *here = row_of(s, j, k), *back = row_of(s, j - 1, k),
                  *below = row_of(s, j, k - 1);
    for (int32_t i = 0; i <= size[0]; i++) {
        const int32_t at[3] = {i, j, k};
        uint8_t region = i < size[0] ? here[i] : 0;
        if (region != (i > 0 ? here[i - 1] : 0)) look(s, at, 0);
        if (i == size[0]) break;
        if (region != back[i] && k < size[2]) look(s, at, 1);
        if (region != below[i] && j < size[1]) look(s, at, 2);
    }
}

static void load_slice(scan *s, int32_t k) {
    if (k >= s->image->size[2]) return;
    size_t voxels = (size_t)s->image->size[0] * (size_t)s->image->size[1];
    const uint16_t *label = s->image->label + (size_t)k * voxels;
    uint8_t *slice = s->slice[k % SLICES];
    for (size_t v = 0; v < voxels; v++) slice[v] = s->region_of_label[label[v]];
}

static bool scan_image(scan *s) {
    size_t corners = (size_t)s->nets->size[0] * (size_t)s->nets->size[1];
    s->vertices = s->quads = 0;
    memset(s->corners[1], 0xff, corners * sizeof(int32_t));
    load_slice(s, 0);
    for (int32_t k = 0; k <= s->image->size[2]; k++) {
        int32_t *layer = s->corners[0];
        s->corners[0] = s->corners[1];
        s->corners[1] = layer;
        memset(layer, 0xff, corners * sizeof *layer);
        load_slice(s, k + 1);
        for (int32_t j = 0; j <= s->image->size[1]; j++) scan_row(s, j, k);
        if (s->quads > LAR_NETS_QUADS_MAX) return false;
    }
    return true;
}

static lar_status allocate(scan *s, lar_error *error) {
    lar_nets *nets = s->nets;
    size_t vertices = (size_t)s->vertices, quads = (size_t)s->quads;
    nets->start = lar_calloc(vertices, sizeof *nets->start);
    nets->moved = lar_calloc(vertices, sizeof *nets->moved);
    nets->neighbour = lar_calloc(vertices, sizeof *nets->neighbour);
    nets->line = lar_calloc(vertices, sizeof *nets->line);
    nets->thin = lar_calloc(vertices, sizeof *nets->thin);
    nets->corner = lar_calloc(quads, sizeof *nets->corner);
    nets->side = lar_calloc(quads, sizeof *nets->side);
    nets->diagonal = lar_calloc(quads, sizeof *nets->diagonal);
    s->around = lar_calloc(vertices, sizeof *s->around);
    nets->vertex_count = (int32_t)vertices;
    nets->quad_count = (int32_t)quads;
    if (nets->start && nets->moved && nets->neighbour && nets->line && nets->thin && nets->corner &&
        nets->side && nets->diagonal && s->around)
        return LAR_OK;
    return lar_fail_memory(error, 74 * vertices + 21 * quads, "the regions' surfaces");
}

static lar_status build(scan *s, lar_error *error) {
    const int32_t *size = s->image->size;
    size_t voxels = (size_t)size[0] * (size_t)size[1];
    size_t corners = (size_t)s->nets->size[0] * (size_t)s->nets->size[1];
    s->nothing = lar_calloc((size_t)size[0], 1);
    bool given = s->nothing != NULL;
    for (int i = 0; i < SLICES; i++) given &= (s->slice[i] = lar_calloc(voxels, 1)) != NULL;
    for (int i = 0; i < 2; i++)
        given &= (s->corners[i] = lar_calloc(corners, sizeof(int32_t))) != NULL;
    if (!given) return lar_fail_memory(error, SLICES * voxels + 8 * corners, "slices of the image");
    if (!scan_image(s))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: its labels have more than %d faces of voxels between them, as noise "
                        "has and no body; choose labels, or look whether it is a label map",
                        s->image->source, (int)LAR_NETS_QUADS_MAX);
    lar_status status = allocate(s, error);
    if (status) return status;
    s->write = true;
    scan_image(s);
    return LAR_OK;
}

lar_status lar_nets_create(const lar_image *image, const uint8_t *region_of_label, lar_nets *nets,
                           lar_error *error) {
    *nets = (lar_nets){0};
    for (int a = 0; a < 3; a++) {
        nets->size[a] = image->size[a] + 1;
        double squared = 0;
        for (int b = 0; b < 3; b++) squared += image->to_world[b][a] * image->to_world[b][a];
        nets->spacing[a] = sqrt(squared);
    }
    scan s = {.image = image, .region_of_label = region_of_label, .nets = nets};
    lar_status status = build(&s, error);
    for (int i = 0; i < SLICES; i++) free(s.slice[i]);
    for (int i = 0; i < 2; i++) free(s.corners[i]);
    free(s.nothing);
    free(s.around);
    if (status) lar_nets_clear(nets);
    return status;
}
