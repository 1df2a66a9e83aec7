#include "meshing/boundary_nets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void lar_nets_clear(lar_nets *nets) {
    free(nets->start);
    free(nets->moved);
    free(nets->neighbour);
    free(nets->line);
    free(nets->corner);
    free(nets->side);
    free(nets->diagonal);
    *nets = (lar_nets){0};
}

enum { NO_REGION = UINT16_MAX };

/* Goes through the image slice by slice: once to count, once to write. */
typedef struct scan {
    const lar_image *image;
    const uint8_t *region_of_label;
    lar_nets *nets;
    bool write;
    uint8_t *slice[2];   /* regions of voxels, of this slice and the one below */
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
static void add_quad(scan *s, const int32_t at[3], int axis, uint16_t below, uint16_t above) {
    int32_t quad = (int32_t)s->quads++, slice = at[2], corner[4];
    for (int c = 0; c < 4; c++) {
        int32_t place[3] = {at[0], at[1], at[2]};
        place[(axis + 1) % 3] += c == 1 || c == 2;
        place[(axis + 2) % 3] += c >= 2;
        corner[c] = vertex_at(s, place, slice);
    }
    if (!s->write) return;
    /* Outside and cuts are in front; of two regions the smaller one. */
    bool above_in_front =
        above == 0 || above >= LAR_REGION_CUT || (below < LAR_REGION_CUT && below && above < below);
    uint16_t side[2] = {above_in_front ? above : below, above_in_front ? below : above};
    memcpy(s->nets->side[quad], side, sizeof side);
    for (int c = 0; c < 4; c++) s->nets->corner[quad][c] = corner[above_in_front ? c : (4 - c) % 4];
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    add_edge(s, corner[0], corner[1], b, side);
    add_edge(s, corner[3], corner[2], b, side);
    add_edge(s, corner[0], corner[3], c, side);
    add_edge(s, corner[1], corner[2], c, side);
}

/* The voxel at i, j of a slice and the one before it along an axis; beyond the image there is what
 * cuts the body off. */
static void look(scan *s, const int32_t at[3], int axis, uint8_t here, uint8_t before) {
    if (here == before) return;
    uint16_t above = here, below = before;
    if (at[axis] == 0) below = (uint16_t)(LAR_REGION_CUT + 2 * axis);
    if (at[axis] == s->image->size[axis]) above = (uint16_t)(LAR_REGION_CUT + 2 * axis + 1);
    add_quad(s, at, axis, below, above);
}

static void scan_row(scan *s, int32_t j, int32_t k) {
    const int32_t *size = s->image->size;
    size_t row = (size_t)j * (size_t)size[0], width = (size_t)size[0];
    bool in = j < size[1] && k < size[2];
    const uint8_t *here = &s->slice[0][row];
    for (int32_t i = 0; in && i <= size[0]; i++) {
        int32_t at[3] = {i, j, k};
        look(s, at, 0, i < size[0] ? here[i] : 0, i > 0 ? here[i - 1] : 0);
    }
    for (int32_t i = 0; k < size[2] && i < size[0]; i++) {
        int32_t at[3] = {i, j, k};
        look(s, at, 1, j < size[1] ? here[i] : 0, j > 0 ? s->slice[0][row - width + (size_t)i] : 0);
    }
    for (int32_t i = 0; j < size[1] && i < size[0]; i++) {
        int32_t at[3] = {i, j, k};
        look(s, at, 2, k < size[2] ? here[i] : 0, k > 0 ? s->slice[1][row + (size_t)i] : 0);
    }
}

static bool scan_image(scan *s) {
    const int32_t *size = s->image->size;
    size_t voxels = (size_t)size[0] * (size_t)size[1];
    size_t corners = (size_t)s->nets->size[0] * (size_t)s->nets->size[1];
    s->vertices = s->quads = 0;
    memset(s->corners[1], 0xff, corners * sizeof(int32_t));
    for (int32_t k = 0; k <= size[2]; k++) {
        uint8_t *slice = s->slice[1];
        s->slice[1] = s->slice[0];
        s->slice[0] = slice;
        int32_t *layer = s->corners[0];
        s->corners[0] = s->corners[1];
        s->corners[1] = layer;
        memset(layer, 0xff, corners * sizeof *layer);
        const uint16_t *label = k < size[2] ? s->image->label + (size_t)k * voxels : NULL;
        for (size_t v = 0; label && v < voxels; v++) slice[v] = s->region_of_label[label[v]];
        for (int32_t j = 0; j <= size[1]; j++) scan_row(s, j, k);
        if (s->quads > LAR_NETS_QUADS_MOST) return false;
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
    nets->corner = lar_calloc(quads, sizeof *nets->corner);
    nets->side = lar_calloc(quads, sizeof *nets->side);
    nets->diagonal = lar_calloc(quads, sizeof *nets->diagonal);
    s->around = lar_calloc(vertices, sizeof *s->around);
    nets->vertex_count = (int32_t)vertices;
    nets->quad_count = (int32_t)quads;
    if (nets->start && nets->moved && nets->neighbour && nets->line && nets->corner && nets->side &&
        nets->diagonal && s->around)
        return LAR_OK;
    return lar_fail_memory(error, 73 * vertices + 21 * quads, "the regions' surfaces");
}

static lar_status build(scan *s, lar_error *error) {
    const int32_t *size = s->image->size;
    size_t voxels = (size_t)size[0] * (size_t)(size[1] + 1);
    size_t corners = (size_t)s->nets->size[0] * (size_t)s->nets->size[1];
    for (int i = 0; i < 2; i++) {
        s->slice[i] = lar_calloc(voxels, 1);
        s->corners[i] = lar_calloc(corners, sizeof(int32_t));
    }
    if (!s->slice[0] || !s->slice[1] || !s->corners[0] || !s->corners[1])
        return lar_fail_memory(error, 2 * voxels + 8 * corners, "two slices of the image");
    if (!scan_image(s))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: its labels have more than %d faces of voxels between them, as noise "
                        "has and no body; choose labels, or look whether it is a label map",
                        s->image->source, (int)LAR_NETS_QUADS_MOST);
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
    for (int i = 0; i < 2; i++) {
        free(s.slice[i]);
        free(s.corners[i]);
    }
    free(s.around);
    if (status) lar_nets_clear(nets);
    return status;
}
