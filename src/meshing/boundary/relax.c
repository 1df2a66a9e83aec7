/* Smoothing is Taubin's (1995, "A signal processing approach to fair surface design"): a step
 * towards the mean of the neighbours, and a somewhat longer one back, which takes the stairs away
 * and leaves what is larger. Thin parts, which plain Laplacian steps would eat up, stay.
 *
 * Volumes are restored by moving each interface along its normal by the difference of two numbers,
 * one per region (0 for outside): that is the least movement, in squares over the area, that adds
 * the missing volumes. The numbers solve a small system of equations of the areas in between.
 */
#include "meshing/boundary/nets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel_for.h"
#include "base/vector.h"

/* Voxels per axis that a corner may move; and where the part is one voxel thick along it, so that
 * it neither vanishes nor turns inside out. */
static const double LIMIT = 0.7, THIN_LIMIT = 0.25;

enum { PORTION = 4096 }; /* of vertices or quadrilaterals, for one core at a time */

/* Of a quadrilateral, in voxels. */
typedef struct quad_size {
    double volume, area;
} quad_size;

typedef struct relaxation {
    lar_nets *nets;
    double (*next)[3]; /* scratch per vertex */
    double factor;     /* of a smoothing step */
    double *weight;    /* scratch per vertex */
    quad_size *quad;   /* scratch per quadrilateral */
    int32_t regions;
    const double *target; /* volumes */
    double *volume;       /* as they are */
    double *area;         /* [regions + 1][regions + 1] between regions */
    double *offset;       /* number per region */
} relaxation;

static double limited(double way, double limit) {
    return way > limit ? limit : way < -limit ? -limit : way;
}

static double limit_of(const lar_nets *nets, int32_t v, int axis) {
    return nets->thin[v] >> axis & 1 ? THIN_LIMIT : LIMIT;
}

/* On the image's border a corner belongs to a cut: it stays in its plane. */
static bool locked(const lar_nets *nets, int32_t v, int axis) {
    return nets->start[v][axis] == 0 || nets->start[v][axis] == nets->size[axis] - 1;
}

/* ---- smoothing ------------------------------------------------------------------------------ */

static void step_vertex(const lar_nets *nets, int32_t v, double factor, double next[3]) {
    const double *moved = nets->moved[v];
    double sum[3] = {0};
    int count = 0;
    for (int d = 0; d < 6; d++) {
        int32_t w = nets->neighbour[v][d];
        if (w < 0 || (nets->line[v] && !(nets->line[v] >> d & 1))) continue;
        for (int a = 0; a < 3; a++) sum[a] += nets->moved[w][a] - moved[a];
        sum[d / 2] += d % 2 ? 1 : -1;
        count++;
    }
    for (int a = 0; a < 3; a++) {
        bool stays = count < 2 || locked(nets, v, a);
        next[a] =
            stays ? moved[a] : limited(moved[a] + factor * sum[a] / count, limit_of(nets, v, a));
    }
}

static void step_some(void *context, int32_t first, int32_t end) {
    const relaxation *r = context;
    for (int32_t v = first; v < end; v++) step_vertex(r->nets, v, r->factor, r->next[v]);
}

/* A wave of length L along one direction of the surface has the value k = (1 - cos(2 pi / L)) / 2
 * and is multiplied by (1 - FORTH k) (1 + BACK k) per pair of steps: of 4 voxels it keeps 6 % after
 * all pairs, of 6 half, and from 21 on (k = 1 / FORTH - 1 / BACK) all of it. */
static void smooth(relaxation *r) {
    enum { PAIRS = 25 };
    const double FORTH = 0.67, BACK = 0.68;
    lar_nets *nets = r->nets;
    for (int step = 0; step < 2 * PAIRS; step++) {
        r->factor = step % 2 ? -BACK : FORTH;
        lar_parallel_for(nets->vertex_count, PORTION, step_some, r);
        double(*swap)[3] = nets->moved;
        nets->moved = r->next;
        r->next = swap;
    }
}

/* ---- triangles ------------------------------------------------------------------------------ */

/* Place in units of length. */
static void place_of(const lar_nets *nets, int32_t v, double place[3]) {
    for (int a = 0; a < 3; a++)
        place[a] = (nets->start[v][a] + nets->moved[v][a]) * nets->spacing[a];
}

/* Twice the area times the normal of a triangle. */
static void normal_of(double x[4][3], int a, int b, int c, double normal[3]) {
    double u[3], v[3];
    lar_minus(x[b], x[a], u);
    lar_minus(x[c], x[a], v);
    lar_cross(u, v, normal);
}

/* How flat two triangles lie to each other: the cosine between their normals. */
static double flatness(const double a[3], const double b[3]) {
    double lengths = lar_length(a) * lar_length(b);
    return lengths > 0 ? lar_dot(a, b) / lengths : -2;
}

/* The flatter pair of triangles; of equally flat ones the shorter diagonal. */
static void choose_some(void *context, int32_t first, int32_t end) {
    lar_nets *nets = context;
    for (int32_t q = first; q < end; q++) {
        double x[4][3], n[4][3], d[2][3];
        for (int c = 0; c < 4; c++) place_of(nets, nets->corner[q][c], x[c]);
        normal_of(x, 0, 1, 2, n[0]);
        normal_of(x, 0, 2, 3, n[1]);
        normal_of(x, 1, 2, 3, n[2]);
        normal_of(x, 1, 3, 0, n[3]);
        lar_minus(x[2], x[0], d[0]);
        lar_minus(x[3], x[1], d[1]);
        double better = flatness(n[2], n[3]) - flatness(n[0], n[1]);
        double shorter = lar_dot(d[0], d[0]) - lar_dot(d[1], d[1]);
        nets->diagonal[q] = fabs(better) > 1e-9 ? better > 0 : shorter > 1e-9 * lar_dot(d[0], d[0]);
    }
}

static void choose_diagonals(lar_nets *nets) {
    lar_parallel_for(nets->quad_count, PORTION, choose_some, nets);
}

/* ---- volumes -------------------------------------------------------------------------------- */

static void measure_some(void *context, int32_t first, int32_t end) {
    const relaxation *r = context;
    const lar_nets *nets = r->nets;
    const double voxel = nets->spacing[0] * nets->spacing[1] * nets->spacing[2];
    for (int32_t q = first; q < end; q++) {
        double x[4][3], n[2][3], volume = 0, area = 0;
        for (int c = 0; c < 4; c++)
            place_of(nets, nets->corner[q][(c + nets->diagonal[q]) % 4], x[c]);
        normal_of(x, 0, 1, 2, n[0]);
        normal_of(x, 0, 2, 3, n[1]);
        for (int t = 0; t < 2; t++) {
            volume += lar_dot(x[0], n[t]) / (6 * voxel);
            area += lar_length(n[t]) / (2 * voxel);
        }
        r->quad[q] = (quad_size){volume, area};
    }
}

/* Summed up in one order, whatever number of cores measures. */
static void measure(relaxation *r) {
    const lar_nets *nets = r->nets;
    size_t all = (size_t)r->regions + 1;
    memset(r->volume, 0, all * sizeof *r->volume);
    memset(r->area, 0, all * all * sizeof *r->area);
    lar_parallel_for(nets->quad_count, PORTION, measure_some, r);
    for (int32_t q = 0; q < nets->quad_count; q++) {
        int front = lar_boundary_region(nets->side[q][0]),
            behind = lar_boundary_region(nets->side[q][1]);
        r->volume[behind] += r->quad[q].volume;
        r->volume[front] -= r->quad[q].volume;
        if (nets->side[q][0] >= LAR_REGION_CUT) continue; /* cuts stay where they are */
        r->area[(size_t)front * all + (size_t)behind] += r->quad[q].area;
        r->area[(size_t)behind * all + (size_t)front] += r->quad[q].area;
    }
}

/* Gauss and Seidel's sweeps: a region's number from those of its neighbours. */
static void solve_offsets(relaxation *r) {
    enum { SWEEPS = 60 };
    size_t all = (size_t)r->regions + 1;
    memset(r->offset, 0, all * sizeof *r->offset);
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (size_t i = 1; i < all; i++) {
            double sum = r->target[i] - r->volume[i], area = 0;
            for (size_t j = 0; j < all; j++) {
                sum += r->area[i * all + j] * r->offset[j];
                area += r->area[i * all + j];
            }
            if (area > 0) r->offset[i] = sum / area;
        }
}

/* Each vertex by the mean of what its triangles ask for along their normals. */
static void move_surfaces(relaxation *r) {
    lar_nets *nets = r->nets;
    size_t vertices = (size_t)nets->vertex_count;
    double min = fmin(nets->spacing[0], fmin(nets->spacing[1], nets->spacing[2]));
    memset(r->next, 0, vertices * sizeof *r->next);
    memset(r->weight, 0, vertices * sizeof *r->weight);
    for (int32_t q = 0; q < nets->quad_count; q++) {
        if (nets->side[q][0] >= LAR_REGION_CUT) continue;
        double way = r->offset[nets->side[q][1]] - r->offset[nets->side[q][0]];
        double x[4][3];
        int32_t v[4];
        for (int c = 0; c < 4; c++) {
            v[c] = nets->corner[q][(c + nets->diagonal[q]) % 4];
            place_of(nets, v[c], x[c]);
        }
        way = limited(way, 0.2 * min);
        for (int t = 0; t < 2; t++) {
            const int c[3] = {0, 1 + t, 2 + t};
            double normal[3];
            normal_of(x, c[0], c[1], c[2], normal);
            for (int i = 0; i < 3; i++) {
                r->weight[v[c[i]]] += lar_length(normal);
                for (int a = 0; a < 3; a++) r->next[v[c[i]]][a] += way * normal[a];
            }
        }
    }
    for (int32_t v = 0; v < nets->vertex_count; v++)
        for (int a = 0; a < 3 && r->weight[v] > 0; a++) {
            double way = r->next[v][a] / (r->weight[v] * nets->spacing[a]);
            if (!locked(nets, v, a))
                nets->moved[v][a] = limited(nets->moved[v][a] + way, limit_of(nets, v, a));
        }
}

static bool volumes_are_right(const relaxation *r) {
    const double near = 5e-4;
    for (int32_t i = 1; i <= r->regions; i++)
        if (fabs(r->volume[i] - r->target[i]) > near * r->target[i]) return false;
    return true;
}

lar_status lar_nets_relax(lar_nets *nets, int32_t region_count, const double *volume,
                          lar_error *error) {
    enum { ROUNDS = 30 };
    size_t vertices = (size_t)nets->vertex_count, all = (size_t)region_count + 1;
    relaxation r = {.nets = nets, .regions = region_count, .target = volume};
    r.next = lar_calloc(vertices, sizeof *r.next);
    r.weight = lar_calloc(vertices, sizeof *r.weight);
    r.quad = lar_calloc((size_t)nets->quad_count, sizeof *r.quad);
    r.volume = lar_calloc(all, sizeof *r.volume);
    r.area = lar_calloc(all * all, sizeof *r.area);
    r.offset = lar_calloc(all, sizeof *r.offset);
    bool given = r.next && r.weight && r.quad && r.volume && r.area && r.offset;
    if (given) {
        smooth(&r);
        choose_diagonals(nets);
        for (int round = 0; round < ROUNDS; round++) {
            measure(&r);
            if (volumes_are_right(&r)) break;
            solve_offsets(&r);
            move_surfaces(&r);
        }
    }
    free(r.next);
    free(r.weight);
    free(r.quad);
    free(r.volume);
    free(r.area);
    free(r.offset);
    return given ? LAR_OK
                 : lar_fail_memory(error, 48 * vertices + 8 * all * (all + 2),
                                   "smoothing the regions' surfaces");
}
