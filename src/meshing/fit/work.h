/* What fitting works on. Lengths are in cells, from the first node of the unfitted mesh: everything
 * is near 1, and a weight means the same for a mouse and for a man.
 *
 *     fit.c          the order of things
 *     faces.c        which elements and faces are around each node
 *     target.c       where faces and nodes shall lie: planes at the true boundary
 *     volume.c       how far off the boundary they shall lie, so that regions keep their volumes
 *     sweep.c        nodes move, as if one after the other
 *     rows.c         which of them may move at once
 *     apart.c        no outer face goes through another one
 *     quality.c      the energy of a corner
 */
#ifndef LAR_MESHING_FIT_WORK_H
#define LAR_MESHING_FIT_WORK_H

#include "meshing/fit/face_boxes.h"
#include "meshing/fit/fit.h"
#include "meshing/fit/quality.h"
#include "model/triangles/tree.h"

/* A plane that a point of the mesh shall lie on, or by the pair's offset before it: normal * x =
 * level + offset. Weight 0: none. */
typedef struct lar_fit_plane {
    double normal[3], level, weight;
    double asked[3], point[3]; /* from where it was found, and the boundary's nearest point */
} lar_fit_plane;

/* Faces are asked at the four points of Gauss' rule: the sum over them of the squared distances is
 * the integral over the face, for which nodes in front of the boundary and nodes behind it must
 * balance. */
enum { LAR_FIT_GAUSS = 4 };

/* A face between two regions, corners counter-clockwise seen from the first of its pair. */
typedef struct lar_fit_face {
    int32_t node[4];
    int32_t pair;
    lar_fit_plane plane[LAR_FIT_GAUSS];
} lar_fit_face;

/* The shape function of a face's corner a at Gauss point g is lar_fit_share[(a - g) & 3]. */
extern const double lar_fit_share[4];

/* A node where a pair of regions meets. */
typedef struct lar_fit_point {
    int32_t node, pair;
    int32_t faces; /* of this pair, around the node */
    lar_fit_plane plane;
} lar_fit_point;

typedef struct lar_fit_pair {
    uint16_t region[2];
    lar_triangle_tree *tree; /* NULL: the true boundary has nothing between them */
    double area;             /* of its faces [cells^2] */
    double offset;           /* how far towards the first region faces shall lie [cells] */
} lar_fit_pair;

/* Of a region's volume: what was missing last time [cells], and how much that counts. */
typedef struct lar_fit_region {
    double missing, weight;
} lar_fit_region;

/* A face near another one. Until the ways of both (lar_fit_apart.way) sum up to `clear`, they are
 * apart wherever their nodes went. */
typedef struct lar_fit_near {
    double clear;
    int32_t face;
} lar_fit_near;

/* Of a face while nodes are watched: the box around it. */
typedef struct lar_fit_extent {
    double lower[3], upper[3];
} lar_fit_extent;

/* The part of the grid that a face's nodes come from. */
typedef struct lar_fit_span {
    int32_t lower[3], upper[3];
} lar_fit_span;

/* What keeps outer faces apart (apart.c). */
typedef struct lar_fit_apart {
    int32_t (*face)[4], count;
    int32_t *start, *around; /* per node: face * 4 + corner */
    bool *crosses;           /* per face */
    bool *checked;           /* per node: its faces must stay clear of others */
    bool any, all;           /* of nodes */
    bool pairs;              /* atomic: some faces cross */
    bool *strict;            /* per face: clear of neighbours that look the same way too */
    bool *ring;              /* per node: of faces that cross, and around them */
    int tries;               /* of this round */
    int32_t *near_start;     /* per face with a watched node: the faces that it may meet */
    lar_fit_near *near;
    double (*from)[3];      /* per node: where it was before this round, */
    bool *awake;            /* and whether it was worth moving */
    lar_fit_extent *extent; /* per face */
    double *way;            /* per face: all that its nodes went since the lists were made */
    lar_fit_span *span;     /* per face */
    lar_face_boxes boxes;   /* of the faces where they are; without a tree: to be made */
} lar_fit_apart;

/* Nodes that follow each other along the grid's first axis (rows.c). */
typedef struct lar_fit_rows {
    const int32_t (*point)[3];  /* per node: the unfitted mesh's */
    int32_t count, *start;      /* [count + 1]: the first node */
    int32_t *ahead;             /* atomic, per row: where on the first axis the next node is */
    int32_t touch[3], reach[3]; /* points between nodes that have a part in each other's moves: by
                                   elements and slots, and by these and faces kept apart */
} lar_fit_rows;

/* Sweeps of a round, at most. */
enum { LAR_FIT_SWEEPS = 4 };

/* What a node did in a sweep. */
typedef struct lar_fit_action {
    double x[3];                                                /* where it was then */
    enum { LAR_FIT_SLEPT, LAR_FIT_STAYED, LAR_FIT_MOVED } what; /* MOVED: it woke others */
} lar_fit_action;

/* A round that is done again begins as before, and a node that is not watched does as before while
 * all around it do. */
typedef struct lar_fit_record {
    lar_fit_action *action; /* [LAR_FIT_SWEEPS * nodes] */
    bool *differs;          /* [nodes] it has done something else since */
    int sweep, sweeps;      /* the one that is done now; those that are to be done as before */
} lar_fit_record;

typedef struct lar_fit_work {
    const lar_boundary *boundary;
    const double *dropped; /* of lar_fit_options */
    const lar_mesh *mesh;  /* its elements; positions are in `x` */
    double size, origin[3];
    double (*x)[3];

    int32_t *element_start, *element_around; /* per node: element * 8 + local node */
    int32_t *face_start, *face_around;       /* per node: face * 4 + corner */
    int32_t *slot_start, *slot_around;       /* per node: slot * 4 + its place there */
    int32_t *point_start;                    /* per node, into `point` */
    int32_t face_count, point_count, pair_count;
    lar_fit_face *face;
    lar_fit_point *point;
    lar_fit_pair *pair;
    lar_fit_region *region; /* [regions + 1] */

    const int32_t (*slot)[4]; /* the unfitted mesh's */
    lar_fit_law law, slot_law;
    double face_weight, node_weight; /* of a whole face's planes, of a node's with four faces */
    bool *awake;                     /* per node: worth moving */
    lar_fit_rows rows;
    lar_fit_apart apart;
    lar_fit_record record;
} lar_fit_work;

/* Fills a zeroed one. The unfitted mesh and the boundary must outlive it. */
lar_status lar_fit_work_create(const lar_boundary *boundary, const lar_unfitted_mesh *unfitted,
                               lar_fit_work *work, lar_error *error);
void lar_fit_work_clear(lar_fit_work *work);

/* Trees over the triangles of each pair. */
lar_status lar_fit_targets_create(lar_fit_work *work, lar_error *error);
/* Planes anew, from where faces and nodes are now, for those that have moved on. */
void lar_fit_targets_renew(lar_fit_work *work);

/* The cubic cells that each region has and shall have; changes the pairs' offsets by what is
 * missing. `share`: the part of it to make up for. */
lar_status lar_fit_volume_balance(lar_fit_work *work, double share, lar_error *error);

/* Nodes between regions, whose planes have changed or are to stand elsewhere. */
void lar_fit_wake_boundary(lar_fit_work *work);

/* Moves every node that is awake once, in the order of their numbers or so that it comes to the
 * same; the number that moved. */
int32_t lar_fit_sweep(lar_fit_work *work);

/* Before the first sweep of a round (record.sweep 0), and before the first of one that is done
 * again. */
void lar_fit_sweep_again(lar_fit_work *work);

/* The rows of a mesh; freed with `work`. */
lar_status lar_fit_rows_create(lar_fit_work *work, const lar_unfitted_mesh *unfitted,
                               lar_error *error);
void lar_fit_rows_clear(lar_fit_rows *rows);
/* How far nodes have a part in each other's moves, anew: by faces up to `near` points. */
void lar_fit_rows_reach(lar_fit_rows *rows, const int32_t near[3]);
/* Calls `visit` for all nodes, on all cores: each after those of lower number within reach, and
 * before those of higher number. `visit` may look at and change what belongs to nodes within reach.
 * The sum of what it returned. */
typedef int32_t lar_fit_visit(lar_fit_work *work, int32_t node);
int32_t lar_fit_rows_visit(lar_fit_work *work, lar_fit_visit *visit);

/* Makes apart's lists; all are freed with `work`. point: [nodes] of the grid. */
lar_status lar_fit_apart_create(lar_fit_work *work, const int32_t (*point)[3], lar_error *error);
void lar_fit_apart_clear(lar_fit_apart *apart);
/* Notes where a round of sweeps begins. */
lar_status lar_fit_apart_begin(lar_fit_work *work, lar_error *error);
/* After the round: when outer faces cross, everything is as it was before it, more nodes are
 * watched, and it is to be done *again. */
lar_status lar_fit_apart_check(lar_fit_work *work, bool *again, lar_error *error);
/* Moves a node to `x` that is not watched. */
void lar_fit_apart_place(lar_fit_work *work, int32_t n, const double x[3]);
/* Moves a node to `x`; a watched one only when its faces stay clear of others: whether it did. */
bool lar_fit_apart_move(lar_fit_work *work, int32_t n, const double x[3]);

/* Lists, per node, of the places that name it: node[i * stride + a] for i < count and a < per, as
 * i * per + a, in that order. False: no memory. */
bool lar_fit_list_around(const int32_t *node, size_t stride, size_t count, int per, int32_t nodes,
                         int32_t **start, int32_t **around);

/* The least scaled Jacobian, the part of the elements above `bar`. */
double lar_fit_min(const lar_fit_work *work, double bar, double *part_above);

/* The area of a quadrilateral, as a vector: half the product of its diagonals. */
void lar_fit_area(const lar_fit_work *work, const int32_t node[4], double area[3]);

/* Corners of element e, in cells. */
void lar_fit_corners(const lar_fit_work *work, int32_t e, double corner[8][3]);

#endif
