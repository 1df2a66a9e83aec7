/* Where a starter scene holds a body and where it pulls at it: two node sets of the surface.
 *
 *          support                              handle
 *         |<- 1/10 ->|                      |<- 1/10 ->|
 *          .---------------------------------------------.
 *         |o o o                                    o o o | --> pull
 *          '---------------------------------------------'
 *         back                                          front
 *
 * A side is a tenth of the body's extent along the world's axis. A flat cut, where the image ends
 * in the middle of an organ, is held whole: the rest of the organ is behind it. A piece that none
 * of this holds (the other kidney, a loose island) is held at its own tenth, so that it stays.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "meshing/meshing.h"
#include "meshing/starter/extra_supports.h"

static const double TENTH = 0.1;
/* What the pull moves the handle by, as part of the body's length. Nothing else bounds it: what is
 * taken from the handle's own cross-section, or from that of extra supports near it, is another on
 * every mesh. */
static const double MOVES = 0.02;
/* Where nothing holds the body, and so nothing says how far it would move: what the pull would
 * stretch a bar of the handle's cross-section by. */
static const double STRETCH = 0.3;

/* Sides by name, as direction: axis * 2, + 1 for the upper side. */
enum { LEFT, RIGHT, BACK, FRONT, BOTTOM, TOP, SIDES };
static const char *const side_name[SIDES] = {"left", "right", "back", "front", "bottom", "top"};

static int opposite(int side) {
    return side ^ 1;
}

static int side_of(const char *name) {
    for (int side = 0; side < SIDES; side++)
        if (strcmp(name, side_name[side]) == 0) return side;
    return -1;
}

/* What is known while choosing: marks per node. */
typedef struct choice {
    lar_meshing *meshing;
    bool *surface, *held;        /* [nodes] */
    int32_t *outer, outer_count; /* faces of the surface, ascending */
    double lower[3], upper[3];
    lar_error *error;
} choice;

static lar_status mark_surface(choice *c) {
    const lar_mesh *mesh = &c->meshing->mesh;
    lar_status status = lar_mesh_boundary(mesh, &c->outer, &c->outer_count, c->error);
    for (int32_t i = 0; !status && i < c->outer_count; i++)
        for (int k = 0; k < 4; k++)
            c->surface[mesh->element[c->outer[i] / 6][lar_face_node[c->outer[i] % 6][k]]] = true;
    for (int i = 0; i < 3; i++) {
        c->lower[i] = DBL_MAX;
        c->upper[i] = -DBL_MAX;
        for (int32_t n = 0; n < mesh->node_count; n++) {
            c->lower[i] = fmin(c->lower[i], mesh->position[n][i]);
            c->upper[i] = fmax(c->upper[i], mesh->position[n][i]);
        }
    }
    return status;
}

static double tenth(const choice *c, int side) {
    return TENTH * (c->upper[side / 2] - c->lower[side / 2]);
}

/* Whether a place lies within reach of the body's end at that side. */
static bool at_side(const choice *c, int side, double reach, const double place[3]) {
    int axis = side / 2;
    return side % 2 ? place[axis] >= c->upper[axis] - reach : place[axis] <= c->lower[axis] + reach;
}

static lar_status add_set(choice *c, const char *name, const bool *in, int32_t *count) {
    lar_mesh *mesh = &c->meshing->mesh;
    *count = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) *count += in[n];
    if (*count == 0) return LAR_OK;
    int32_t *index = lar_calloc((size_t)*count, sizeof *index);
    if (!index) return lar_fail_memory(c->error, (size_t)*count * sizeof *index, "a node set");
    for (int32_t n = 0, i = 0; n < mesh->node_count; n++)
        if (in[n]) index[i++] = n;
    return lar_mesh_add_set(mesh, name, LAR_SET_NODES, index, *count, c->error);
}

/* ---- what holds it ------------------------------------------------------------------------- */

lar_status lar_support_check(const char *rule, lar_error *error) {
    if (!rule || side_of(rule) >= 0 || strcmp(rule, "cut") == 0 || strcmp(rule, "none") == 0)
        return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "fix %.40s: there are left, right, back, front, bottom, top, cut and none",
                    rule);
}

static int compare_faces(const void *a, const void *b) {
    const int32_t *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* Whether the set is that of a cut with this name: where two cuts of an oblique image have the same
 * one a number follows it. So it does where regions are called "cut" and "left" and touch, but then
 * the faces are inside the body. */
static bool is_cut(const choice *c, const lar_set *set, const char *name) {
    size_t length = strlen(name);
    if (set->kind != LAR_SET_FACES || strncmp(set->name, "cut_", 4) != 0) return false;
    if (strncmp(set->name + 4, name, length) != 0) return false;
    const char *rest = set->name + 4 + length;
    if (*rest && !(rest[0] == '_' && rest[1] && !rest[1 + strspn(rest + 1, "0123456789")]))
        return false;
    return bsearch(set->index, c->outer, (size_t)c->outer_count, sizeof *c->outer, compare_faces);
}

static void mark_faces(choice *c, const lar_set *faces) {
    const lar_mesh *mesh = &c->meshing->mesh;
    for (int32_t k = 0; k < faces->count; k++)
        for (int a = 0; a < 4; a++) {
            int32_t face = faces->index[k];
            c->held[mesh->element[face / 6][lar_face_node[face % 6][a]]] = true;
        }
}

/* Marks the nodes of the flat cuts; returns the side that most of them are at. */
static int mark_cuts(choice *c) {
    const lar_mesh *mesh = &c->meshing->mesh;
    const lar_boundary *boundary = &c->meshing->boundary;
    int32_t max = 0;
    int where = -1;
    for (int i = 0; i < LAR_CUTS; i++) {
        const char *name = boundary->cut[i].name;
        for (int32_t s = 0; *name && s < mesh->set_count; s++) {
            const lar_set *faces = &mesh->set[s];
            if (!is_cut(c, faces, name)) continue;
            mark_faces(c, faces);
            if (faces->count > max) {
                max = faces->count;
                where = side_of(name);
            }
        }
    }
    return where;
}

static void mark_side(choice *c, int side) {
    const lar_mesh *mesh = &c->meshing->mesh;
    for (int32_t n = 0; n < mesh->node_count; n++)
        c->held[n] = c->surface[n] && at_side(c, side, tenth(c, side), mesh->position[n]);
}

static bool is_rigid(const choice *c, int32_t tag) {
    const lar_meshing *m = c->meshing;
    for (int32_t r = 0; r < m->info.regions; r++)
        if (m->region[r].held && m->region[r].tag == tag) return true;
    return false;
}

static void mark_rigid(choice *c) {
    const lar_mesh *mesh = &c->meshing->mesh;
    for (int32_t e = 0; e < mesh->element_count; e++)
        if (is_rigid(c, mesh->element_tag[e]))
            for (int a = 0; a < 8; a++) c->held[mesh->element[e][a]] = true;
}

/* Pieces of the mesh, each named by its least node, with their extent along an axis. */
typedef struct pieces {
    int32_t *body;      /* [nodes] */
    double (*range)[2]; /* [nodes] at the least nodes: lowest and highest place */
    bool *held;         /* [nodes] the same: by the rule or by a bone */
} pieces;

static void find_pieces(const choice *c, int axis, pieces *p) {
    const lar_mesh *mesh = &c->meshing->mesh;
    lar_mesh_bodies(mesh, p->body);
    for (int32_t e = 0; e < mesh->element_count; e++)
        if (is_rigid(c, mesh->element_tag[e])) p->held[p->body[mesh->element[e][0]]] = true;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        int32_t root = p->body[n];
        double place = mesh->position[n][axis], *range = p->range[root];
        range[0] = root == n ? place : fmin(range[0], place); /* the least node comes first */
        range[1] = root == n ? place : fmax(range[1], place);
        p->held[root] = p->held[root] || c->held[n];
    }
}

/* Marks the elements that reach into the last tenth, at `side`, of every piece that nothing holds
 * yet: whole elements, because a node or two would be a hinge. */
static lar_status mark_loose_pieces(choice *c, int side) {
    const lar_mesh *mesh = &c->meshing->mesh;
    size_t nodes = (size_t)mesh->node_count;
    pieces p = {.body = lar_calloc(nodes, sizeof *p.body),
                .range = lar_calloc(nodes, sizeof *p.range),
                .held = lar_calloc(nodes, sizeof *p.held)};
    bool ready = p.body && p.range && p.held;
    if (ready) find_pieces(c, side / 2, &p);
    for (int32_t e = 0; ready && e < mesh->element_count; e++) {
        int32_t root = p.body[mesh->element[e][0]];
        const double *range = p.range[root];
        double min = DBL_MAX;
        for (int a = 0; a < 8; a++) {
            double place = mesh->position[mesh->element[e][a]][side / 2];
            min = fmin(min, side % 2 ? range[1] - place : place - range[0]);
        }
        bool reaches = !p.held[root] && min <= TENTH * (range[1] - range[0]);
        for (int a = 0; reaches && a < 8; a++) c->held[mesh->element[e][a]] = true;
    }
    free(p.body);
    free(p.range);
    free(p.held);
    return ready ? LAR_OK : lar_fail_memory(c->error, 24 * nodes, "the mesh's pieces");
}

/* Marks what the rule holds; the side that is held, -1: none, in *side. */
static lar_status hold(choice *c, const char *rule, int *side) {
    lar_support *support = &c->meshing->support;
    /* What the image ends in may have been left out. */
    int cut = !rule || strcmp(rule, "cut") == 0 ? mark_cuts(c) : -1;
    if (!rule) rule = cut >= 0 ? "cut" : side_name[BACK];
    *side = side_of(rule);
    if (strcmp(rule, "cut") == 0) {
        *side = cut;
        if (cut < 0)
            return lar_fail(c->error, LAR_ERROR_ARGUMENT,
                            "fix cut: nothing of the mesh lies on a flat cut, because the image "
                            "does not end inside the body; hold it at a side: left, right, back, "
                            "front, bottom or top");
        support->rule = "cut";
    } else if (*side >= 0) {
        mark_side(c, *side);
        support->rule = side_name[*side];
    } else {
        support->rule = "none";
    }
    int32_t count = 0;
    lar_status status = LAR_OK;
    if (strcmp(rule, "none") != 0)
        status = mark_loose_pieces(c, strcmp(rule, "cut") != 0 ? *side : BACK);
    if (!status) status = add_set(c, "support", c->held, &count);
    support->held = count > 0;
    mark_rigid(c);
    return status;
}

/* ---- where it is pulled -------------------------------------------------------------------- */

/* The harmonic mean over the volume of what is not rigid: that of a stack. 0: all is rigid. */
static double mean_shear(const lar_meshing *meshing) {
    double volume = 0, soft = 0;
    for (int32_t r = 0; r < meshing->info.regions; r++) {
        const lar_region_info *region = &meshing->region[r];
        if (region->held) continue;
        volume += region->volume;
        soft += region->volume / region->shear_modulus;
    }
    return soft > 0 ? volume / soft : 0;
}

/* Mean cross-section of the body's tenth at a side, or of its last layer of elements. */
static double cross_section(const choice *c, int side) {
    const lar_mesh *mesh = &c->meshing->mesh;
    double volume = 0, reach = fmax(tenth(c, side), c->meshing->info.size);
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double corner[8][3], centre[3] = {0};
        lar_mesh_corners(mesh, e, corner);
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) centre[i] += corner[a][i] / 8;
        if (at_side(c, side, reach, centre)) volume += lar_hexahedron_volume(corner);
    }
    return volume / reach;
}

/* The free nodes of the surface at a side; their number. */
static int32_t mark_handle(const choice *c, int side, bool *in) {
    const lar_mesh *mesh = &c->meshing->mesh;
    int32_t count = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        in[n] = c->surface[n] && !c->held[n] && at_side(c, side, tenth(c, side), mesh->position[n]);
        count += in[n];
    }
    return count;
}

/* The handle is opposite of what is held, or, when nothing is free there, at the next side that has
 * free nodes. -1: there is none. */
static int choose_handle(const choice *c, int held_side, bool *handle) {
    static const int next[SIDES] = {FRONT, TOP, BOTTOM, LEFT, RIGHT, BACK};
    int side = held_side >= 0 ? opposite(held_side) : FRONT;
    if (mark_handle(c, side, handle) > 0) return side;
    for (int i = 0; i < SIDES; i++)
        if (next[i] != held_side && mark_handle(c, next[i], handle) > 0) return next[i];
    return -1;
}

/* Two digits: it is an example. */
static double rounded(double force) {
    double digit = pow(10, floor(log10(force)) - 1);
    return round(force / digit) * digit;
}

static void choose_pull(choice *c, int side, const lar_sag *motion) {
    lar_support *support = &c->meshing->support;
    double length = 0, force;
    for (int i = 0; i < 3; i++) length = fmax(length, c->upper[i] - c->lower[i]);
    if (motion->compliance > 0)
        force = MOVES * length / motion->compliance;
    else
        force = 3 * mean_shear(c->meshing) * STRETCH * cross_section(c, side);
    if (!(force > 0)) return;
    support->handle = side_name[side];
    support->pull[side / 2] = (side % 2 ? 1 : -1) * rounded(force);
}

/* ---- together ------------------------------------------------------------------------------ */

/* Marks per node that only exist while choosing. */
typedef struct marks {
    bool *handle, *opposed, *extra;
} marks;

/* Extra supports, where nobody said what holds it and its weight asks for them. */
static lar_status add_extra_supports(choice *c, int side, const marks *in, lar_sag *motion) {
    lar_support *support = &c->meshing->support;
    int32_t count = 0;
    lar_status status = lar_extra_supports_choose(
        c->meshing, c->held, BACK / 2, -1, in->handle, side >= 0 ? side / 2 : 0, in->extra,
        &support->extra_supports, &support->carried, motion, c->error);
    if (!status) status = add_set(c, "pads", in->extra, &count);
    for (int32_t n = 0; n < c->meshing->mesh.node_count; n++) c->held[n] |= in->extra[n];
    return status;
}

static lar_status choose(choice *c, const char *rule, const marks *in) {
    const lar_mesh *mesh = &c->meshing->mesh;
    lar_support *support = &c->meshing->support;
    lar_sag motion = {0};
    int held_side = -1, side = -1;
    int32_t count = 0, held = 0;
    lar_status status = hold(c, rule, &held_side);
    for (int32_t n = 0; n < mesh->node_count; n++) held += c->held[n];
    if (!status && mean_shear(c->meshing) > 0) side = choose_handle(c, held_side, in->handle);
    if (!status && side >= 0 && held == 0)
        support->opposed = mark_handle(c, opposite(side), in->opposed) > 0;
    if (!status && !rule) status = add_extra_supports(c, side, in, &motion);
    if (!status && rule)
        status = lar_sag_estimate(c->meshing, support->opposed ? in->opposed : c->held, in->handle,
                                  side >= 0 ? side / 2 : 0, &motion, NULL, c->error);
    for (int32_t n = 0; n < mesh->node_count; n++) support->fixed_nodes += c->held[n];
    support->slowest = motion.slowest;
    if (status || side < 0 || (held == 0 && !support->opposed)) return status;
    choose_pull(c, side, &motion);
    if (!support->handle) support->opposed = false;
    if (support->handle) status = add_set(c, "handle", in->handle, &count);
    if (count == 0) support->handle = NULL; /* extra supports took it */
    if (!status && support->opposed) status = add_set(c, "handle_opposite", in->opposed, &count);
    return status;
}

lar_status lar_support_choose(lar_meshing *meshing, const char *rule, lar_error *error) {
    size_t nodes = (size_t)meshing->mesh.node_count;
    bool *mark = lar_calloc(5 * nodes, sizeof *mark);
    if (!mark) return lar_fail_memory(error, 5 * nodes, "marks of nodes");
    choice c = {.meshing = meshing, .surface = mark, .held = mark + nodes, .error = error};
    const marks in = {mark + 2 * nodes, mark + 3 * nodes, mark + 4 * nodes};
    lar_status status = mark_surface(&c);
    if (!status) status = choose(&c, rule, &in);
    free(c.outer);
    free(mark);
    meshing->info.fix = meshing->support.rule;
    meshing->info.extra_supports = meshing->support.extra_supports;
    meshing->info.fixed_nodes = meshing->support.fixed_nodes;
    return status;
}
