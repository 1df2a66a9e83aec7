#include "meshing/grid/voxel_grid_thin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel_for.h"
#include "base/vector.h"
#include "model/triangles/tree.h"

/* All in cells. What is wider than REACH beside something thin has room enough, and what is thicker
 * than FAR behind a gap that is to be open. */
static const double REACH = 1.5, FAR = 4;

/* Slots from SLOT_MIN on are widened to SLOT_WIDE, as far as the body beside them keeps
 * PART_KEPT; parts the same. Narrower slots cost more in cells than they gain, and among several
 * regions they take the cells of those that have but a few; thinner parts would be elements that
 * ask for a short time step. More than a cell for slots: those that lie across the axes shall still
 * have cells that hang together by faces. */
static const double SLOT_MIN = 0.12, SLOT_MIN_REGIONS = 0.2, SLOT_WIDE = 1.2, PART_KEPT = 0.5;
static const double PART_MIN = 0.15, PART_WIDE = 1, SLOT_KEPT = 0.5;
/* A sheet of cells without holes is as thick as a cell is across the sheet, the sum of its normal's
 * parts along the grid's axes (a standard plane: Andres, Acharya and Sibata 1997), and a little
 * more where the body is one region. What is thinner than SHEET_MIN is left with a cell's edge:
 * fitting could not make it thin again, and ribs and lobes would stand off. */
static const double SHEET_MIN = 0.45, SHEET_ROOM = 1.05, SHEET_ROOM_REGIONS = 1;
static const double SHEET_MAX = 1.82; /* that of a sheet across the cells' diagonal */

/* The outside hangs together by faces, and what is beside it is apart, where it is as wide as such
 * a sheet. Slots from GAP_MIN on get that width as far as the body beside them keeps it too, and
 * GAP_ROOM more, since a surface moves by whole parts of cells. Narrower ones would cost too many
 * cells. */
static const double GAP_MIN = 0.7, GAP_ROOM = 0.3;

/* Parts of cells are counted around a place as far as others lie from it. */
static const double AROUND = 0.4;

/* Where a ball touches the surface a second time it must be so far on its other side: the cosine of
 * the angle between the normal and the way from the one place to the other. */
static const double FACING = 0.85;

/* Places per cell's face; a place stands for this part of its share of the area at least. */
static const double PLACES_PER_FACE = 20, PLACE_MIN = 0.7;

/* What was measured at a place serves for some that follow, so near, with normals so alike: that
 * saves most of the time. */
enum { SERVES = 7, PORTION = 1024 };
static const double NEAR = 0.6, ALIKE = 0.7;

void lar_thin_clear(lar_thin *thin) {
    free(thin->place);
    *thin = (lar_thin){0};
}

/* ---- how thin -------------------------------------------------------------------------------- */

typedef struct search {
    const lar_boundary *boundary;
    lar_triangles outer;
    lar_triangle_tree *tree;
    lar_thin *thin;
    double due;     /* area since the last place */
    int32_t last;   /* place that is to be measured; -1: none yet */
    int32_t served; /* by it */
} search;

/* The largest ball's diameter on the side of `normal`; INFINITY: more than `max`, or the second
 * place is not opposite. A ball of radius r at p + r n that has q in it becomes the one through q:
 * r = |q - p|^2 / (2 (q - p) n). */
static double measure_thickness(const search *s, const double point[3], const double normal[3],
                                double max) {
    enum { ROUNDS = 20 };
    double radius = max / 2;
    bool opposite = false;
    for (int round = 0; round < ROUNDS; round++) {
        double centre[3], away[3];
        lar_nearest nearest;
        for (int d = 0; d < 3; d++) centre[d] = point[d] + radius * normal[d];
        if (!lar_triangle_tree_nearest(s->tree, centre, 0.95 * radius, &nearest)) break;
        lar_minus(nearest.point, point, away);
        const double along = lar_dot(away, normal), square = lar_dot(away, away);
        if (!(along > 1e-9 * max)) break;
        opposite = along > FACING * sqrt(square);
        if (!(square / (2 * along) < 0.995 * radius)) break;
        radius = square / (2 * along);
    }
    return opposite ? 2 * radius : INFINITY;
}

/* The planes of flat cuts end the image, not the body. */
static bool on_cut(const lar_boundary *boundary, const double point[3], const double normal[3],
                   double size) {
    for (int c = 0; boundary->cut_count > 0 && c < LAR_CUTS; c++) {
        const lar_cut *cut = &boundary->cut[c];
        double away[3];
        lar_minus(point, cut->through, away);
        if (cut->name[0] && lar_dot(normal, cut->normal) > 1 - 1e-6 &&
            fabs(lar_dot(away, cut->normal)) < 1e-6 * size)
            return true;
    }
    return false;
}

static bool beyond_cut(const lar_boundary *boundary, const double point[3]) {
    for (int c = 0; boundary->cut_count > 0 && c < LAR_CUTS; c++) {
        double away[3];
        lar_minus(point, boundary->cut[c].through, away);
        if (boundary->cut[c].name[0] && lar_dot(away, boundary->cut[c].normal) > 0) return true;
    }
    return false;
}

static uint8_t region_of_tag(const lar_boundary *boundary, int32_t tag) {
    int32_t region = 1;
    while (region < boundary->region_count && boundary->region[region].tag != tag) region++;
    return (uint8_t)region;
}

/* Where one side is thin the other one is looked at farther: the less the ball the faster. */
static void measure_place(const search *s, lar_thin_place *place) {
    const double *normal = place->normal, size = s->thin->size;
    const double behind[3] = {-normal[0], -normal[1], -normal[2]};
    double slot = measure_thickness(s, place->point, normal, SLOT_WIDE * size);
    double part = measure_thickness(s, place->point, behind, SHEET_MAX * size);
    if (isinf(slot))
        slot = measure_thickness(s, place->point, normal, (isinf(part) ? SHEET_MAX : REACH) * size);
    if (isinf(part) && !isinf(slot))
        part = measure_thickness(s, place->point, behind, REACH * size);
    if (isinf(part) && !isinf(slot)) part = measure_thickness(s, place->point, behind, FAR * size);
    place->slot = (float)slot;
    place->part = (float)part;
}

static bool last_serves(const search *s, const double point[3], const double normal[3]) {
    double away[3];
    if (s->last < 0 || s->served == SERVES) return false;
    const lar_thin_place *last = &s->thin->place[s->last];
    lar_minus(point, last->point, away);
    return lar_length(away) < NEAR * s->thin->size && lar_dot(normal, last->normal) > ALIKE;
}

static bool add_place(search *s, const double point[3], const double normal[3], int32_t triangle) {
    lar_thin *thin = s->thin;
    if (!LAR_GROW(thin->place, thin->capacity, thin->count)) return false;
    lar_thin_place *place = &thin->place[thin->count];
    *place = (lar_thin_place){.region = region_of_tag(s->boundary, s->outer.tag[triangle])};
    memcpy(place->point, point, sizeof place->point);
    memcpy(place->normal, normal, sizeof place->normal);
    place->measured = !last_serves(s, point, normal);
    s->served = place->measured ? 0 : s->served + 1;
    if (place->measured) s->last = (int32_t)thin->count;
    thin->count++;
    return true;
}

/* The middles of the small triangles into which lines parallel to its sides cut a large one; of
 * small ones every so many. */
static bool add_places(search *s, int32_t t) {
    enum { CUTS_MAX = 256 };
    const double each = s->thin->size * s->thin->size / PLACES_PER_FACE;
    double normal[3], point[3];
    lar_triangles_normal(&s->outer, t, normal);
    const double length = lar_length(normal), area = length / 2;
    if (!(length > 0)) return true;
    for (int d = 0; d < 3; d++) normal[d] /= length;
    const int cuts = (int)fmin(fmax(1, ceil(sqrt(area / each))), CUTS_MAX);
    for (int k = 0; k < cuts * cuts; k++) {
        s->due += area / (cuts * cuts);
        if (s->due < PLACE_MIN * each) continue;
        s->due = 0;
        lar_triangles_part(&s->outer, t, cuts, k, point);
        if (!add_place(s, point, normal, t)) return false;
    }
    return true;
}

static void measure_places(void *context, int32_t first, int32_t end) {
    const search *s = context;
    for (int32_t p = first; p < end; p++)
        if (s->thin->place[p].measured) measure_place(s, &s->thin->place[p]);
}

/* Places that are thin on neither side are left out. */
static void keep_thin(const search *s) {
    lar_thin *thin = s->thin;
    float slot = INFINITY, part = INFINITY;
    size_t kept = 0;
    for (size_t p = 0; p < thin->count; p++) {
        lar_thin_place place = thin->place[p];
        if (place.measured) slot = place.slot, part = place.part;
        place.slot = slot;
        place.part = part;
        if (isinf(slot) && isinf(part)) continue;
        if (on_cut(s->boundary, place.point, place.normal, thin->size)) continue;
        thin->place[kept++] = place;
    }
    thin->count = kept;
}

lar_status lar_thin_find(const lar_boundary *boundary, double size, lar_thin *thin,
                         lar_error *error) {
    search s = {.boundary = boundary, .thin = thin, .last = -1};
    thin->count = 0;
    thin->size = size;
    lar_status status = lar_boundary_outer(boundary, &s.outer, error);
    if (!status)
        status = lar_triangle_tree_create(&s.outer, NULL, s.outer.triangle_count, &s.tree, error);
    for (int32_t t = 0; !status && t < s.outer.triangle_count; t++)
        if (!add_places(&s, t))
            status = lar_fail_memory(error, 2 * thin->capacity * sizeof *thin->place,
                                     "what is thin of the body");
    if (!status) {
        lar_parallel_for((int32_t)thin->count, PORTION, measure_places, &s);
        keep_thin(&s);
    }
    lar_triangle_tree_destroy(s.tree);
    lar_triangles_clear(&s.outer);
    return status;
}

/* ---- widening -------------------------------------------------------------------------------- */

enum { FINE = 4 }; /* parts of a cell along an edge: 64 in all, a bit each */

typedef struct fine_cell {
    uint64_t emptied, filled;
    uint8_t region;
} fine_cell;

typedef struct widening {
    const lar_boundary *boundary;
    const lar_voxel_grid *voxel_grid;
    double origin[3]; /* along the grid's axes */
    int32_t *of;      /* [cells] */
    fine_cell *fine;
    size_t count, capacity;
} widening;

/* The thickness of a sheet of cells without holes through a place [cells]. */
static double aslant(const lar_thin_place *place, const lar_voxel_grid *voxel_grid) {
    double sum = 0;
    for (int a = 0; a < 3; a++) sum += fabs(lar_dot(voxel_grid->axis[a], place->normal));
    return sum;
}

/* How far the surface counts as moved [cells]: outwards when it is positive. A slot goes before a
 * part. */
static double way_of(const lar_thin_place *place, bool regions, const lar_voxel_grid *voxel_grid) {
    const double size = voxel_grid->size, slot = place->slot / size, part = place->part / size;
    const double min = regions ? SLOT_MIN_REGIONS : SLOT_MIN;
    const double room = regions ? SHEET_ROOM_REGIONS : SHEET_ROOM;
    const double sheet = aslant(place, voxel_grid);
    const double wide = part > SHEET_MIN ? room * sheet : PART_WIDE;
    double open = fmin(SLOT_WIDE - slot, part - PART_KEPT);
    if (slot > GAP_MIN) open = fmax(open, fmin(sheet + GAP_ROOM - slot, part - sheet));
    if (slot > min && open > 0) return -open / 2;
    if (part > PART_MIN && part < wide && slot > SLOT_KEPT)
        return fmin(wide - part, slot - SLOT_KEPT) / 2;
    return 0;
}

static fine_cell *fine_cell_at(widening *w, size_t cell) {
    if (w->of[cell] < 0) {
        if (w->count >= INT32_MAX || !LAR_GROW(w->fine, w->capacity, w->count)) return NULL;
        w->fine[w->count] = (fine_cell){0};
        w->of[cell] = (int32_t)w->count++;
    }
    return &w->fine[w->of[cell]];
}

static void fine_middle(const widening *w, const int at[3], double middle[3]) {
    const lar_voxel_grid *voxel_grid = w->voxel_grid;
    memcpy(middle, voxel_grid->origin, 3 * sizeof *middle);
    for (int a = 0; a < 3; a++)
        for (int d = 0; d < 3; d++)
            middle[d] += (at[a] + 0.5) / FINE * voxel_grid->size * voxel_grid->axis[a][d];
}

/* What of the half ball around a place, on the side that it moves to and no farther off than it
 * moves, lies in the grid's cells but the outermost ones. */
static bool add_half_ball(widening *w, const lar_thin_place *place, double way) {
    const lar_voxel_grid *voxel_grid = w->voxel_grid;
    const double far = FINE * fabs(way), radius = fmax(far, FINE * AROUND);
    const double side = way < 0 ? -1 : 1;
    double centre[3], normal[3];
    int low[3], high[3];
    for (int a = 0; a < 3; a++) {
        const double along = lar_dot(voxel_grid->axis[a], place->point) - w->origin[a];
        centre[a] = FINE * along / voxel_grid->size - 0.5;
        normal[a] = side * lar_dot(voxel_grid->axis[a], place->normal);
        low[a] = (int)fmax(FINE, ceil(centre[a] - radius));
        high[a] = (int)fmin(FINE * (voxel_grid->cells[a] - 1) - 1, floor(centre[a] + radius));
    }
    for (int k = low[2]; k <= high[2]; k++)
        for (int j = low[1]; j <= high[1]; j++)
            for (int i = low[0]; i <= high[0]; i++) {
                const double away[3] = {i - centre[0], j - centre[1], k - centre[2]};
                const double above = lar_dot(away, normal);
                if (lar_dot(away, away) > radius * radius || above < 0 || above > far) continue;
                double middle[3];
                fine_middle(w, (const int[]){i, j, k}, middle);
                if (way > 0 && beyond_cut(w->boundary, middle)) continue;
                fine_cell *cell =
                    fine_cell_at(w, lar_voxel_grid_cell(voxel_grid, i / FINE, j / FINE, k / FINE));
                if (!cell) return false;
                const int bit = i % FINE + FINE * (j % FINE) + FINE * FINE * (k % FINE);
                *(way < 0 ? &cell->emptied : &cell->filled) |= UINT64_C(1) << bit;
                if (way > 0) cell->region = place->region;
            }
    return true;
}

static int count_bits(uint64_t bits) {
    int count = 0;
    for (; bits; bits &= bits - 1) count++;
    return count;
}

/* What is both emptied and filled stays as it is. */
static lar_status sum_up(widening *w, lar_thin_changes *changes, lar_error *error) {
    changes->one = lar_calloc(w->count, sizeof *changes->one);
    if (!changes->one)
        return lar_fail_memory(error, w->count * sizeof *changes->one, "what is thin of the body");
    for (size_t c = 0; c < w->count; c++) {
        const fine_cell *fine = &w->fine[c];
        const int more = count_bits(fine->filled & ~fine->emptied);
        const int less = count_bits(fine->emptied & ~fine->filled);
        changes->one[c] = (lar_thin_change){(float)(more - less) / (FINE * FINE * FINE),
                                            fine->region ? fine->region : 1};
    }
    changes->count = w->count;
    changes->of = w->of;
    w->of = NULL;
    return LAR_OK;
}

void lar_thin_changes_clear(lar_thin_changes *changes) {
    free(changes->of);
    free(changes->one);
    *changes = (lar_thin_changes){0};
}

lar_status lar_thin_widen(const lar_thin *thin, const lar_boundary *boundary,
                          const lar_voxel_grid *voxel_grid, lar_thin_changes *changes,
                          lar_error *error) {
    if (!thin || thin->count == 0) return LAR_OK;
    const bool regions = boundary->region_count > 1;
    widening w = {.boundary = boundary, .voxel_grid = voxel_grid};
    const size_t cells =
        (size_t)voxel_grid->cells[0] * (size_t)voxel_grid->cells[1] * (size_t)voxel_grid->cells[2];
    lar_status status = LAR_OK;
    w.of = lar_calloc(cells, sizeof *w.of);
    if (!w.of) return lar_fail_memory(error, cells * sizeof *w.of, "what is thin of the body");
    for (size_t c = 0; c < cells; c++) w.of[c] = -1;
    for (int a = 0; a < 3; a++) w.origin[a] = lar_dot(voxel_grid->axis[a], voxel_grid->origin);
    for (size_t p = 0; !status && p < thin->count; p++) {
        const double way = way_of(&thin->place[p], regions, voxel_grid);
        if (way != 0 && !add_half_ball(&w, &thin->place[p], way))
            status =
                lar_fail_memory(error, 2 * w.capacity * sizeof *w.fine, "what is thin of the body");
    }
    if (!status && w.count > 0) status = sum_up(&w, changes, error);
    free(w.of);
    free(w.fine);
    return status;
}
