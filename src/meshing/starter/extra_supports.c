#include "meshing/starter/extra_supports.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"

/* Of a piece's length: how far its weight may move it; how far extra supports are apart, at first;
 * of that, how large they are. */
static const double SAG_MAX = 0.15, APART = 0.5, RADIUS = 0.3;
/* Extra supports this part of the limit do not need. */
static const double WORTH_IT = 0.5;
enum { ROUNDS = 4 };

typedef struct search {
    const lar_meshing *meshing;
    int32_t *face, faces; /* that look down */
    double *sag;          /* [nodes] */
    double *length;       /* [nodes] of the piece that the node belongs to */
    int32_t *piece;       /* [nodes] its least node */
    bool *sags;           /* [nodes] at that: the piece is not carried */
    bool *all;            /* [nodes] held, by whatever */
    bool *handle;         /* [nodes] where no extra support may be */
    bool all_else_done;   /* but now it may */
} search;

/* ---- what there is -------------------------------------------------------------------------- */

static void find_underside(search *s, int axis, int sign) {
    static const double COSINE = 0.5;
    const lar_mesh *mesh = &s->meshing->mesh;
    int32_t kept = 0;
    for (int32_t k = 0; k < s->faces; k++) {
        const int32_t *element = mesh->element[s->face[k] / 6];
        const uint8_t *corner = lar_face_node[s->face[k] % 6];
        const double *x[4];
        double across[2][3], area[3];
        for (int a = 0; a < 4; a++) x[a] = mesh->position[element[corner[a]]];
        for (int d = 0; d < 2; d++) lar_minus(x[d + 2], x[d], across[d]);
        lar_cross(across[0], across[1], area);
        if (sign * area[axis] >= COSINE * lar_length(area)) s->face[kept++] = s->face[k];
    }
    s->faces = kept;
}

/* The largest extent of each piece, at all of its nodes. */
static lar_status find_lengths(search *s, lar_error *error) {
    const lar_mesh *mesh = &s->meshing->mesh;
    size_t nodes = (size_t)mesh->node_count;
    double(*box)[2][3] = lar_calloc(nodes, sizeof *box);
    bool ready = box != NULL;
    if (ready) lar_mesh_bodies(mesh, s->piece);
    for (int32_t n = 0; ready && n < mesh->node_count; n++) {
        int32_t root = s->piece[n];
        for (int i = 0; i < 3; i++) {
            double x = mesh->position[n][i], *low = &box[root][0][i], *high = &box[root][1][i];
            *low = root == n ? x : fmin(*low, x); /* the least node comes first */
            *high = root == n ? x : fmax(*high, x);
        }
    }
    for (int32_t n = 0; ready && n < mesh->node_count; n++) {
        int32_t root = s->piece[n];
        for (int i = 0; i < 3; i++)
            s->length[n] = fmax(s->length[n], box[root][1][i] - box[root][0][i]);
    }
    free(box);
    return ready ? LAR_OK : lar_fail_memory(error, 48 * nodes, "the body's pieces");
}

static lar_status begin(search *s, const lar_meshing *meshing, const bool *held, bool *handle,
                        int axis, int sign, lar_error *error) {
    size_t nodes = (size_t)meshing->mesh.node_count;
    *s = (search){.meshing = meshing,
                  .handle = handle,
                  .sag = lar_calloc(nodes, sizeof *s->sag),
                  .length = lar_calloc(nodes, sizeof *s->length),
                  .piece = lar_calloc(nodes, sizeof *s->piece),
                  .sags = lar_calloc(nodes, sizeof *s->sags),
                  .all = lar_calloc(nodes, sizeof *s->all)};
    if (!s->sag || !s->length || !s->piece || !s->sags || !s->all)
        return lar_fail_memory(error, 22 * nodes, "extra supports");
    memcpy(s->all, held, nodes * sizeof *held);
    lar_status status = lar_mesh_boundary(&meshing->mesh, &s->face, &s->faces, error);
    if (status) return status;
    find_underside(s, axis, sign);
    return find_lengths(s, error);
}

static void end(search *s) {
    free(s->face);
    free(s->sag);
    free(s->length);
    free(s->piece);
    free(s->sags);
    free(s->all);
}

/* ---- a round -------------------------------------------------------------------------------- */

static bool is_carried(search *s) {
    const int32_t nodes = s->meshing->mesh.node_count;
    bool carried = true;
    memset(s->sags, 0, (size_t)nodes * sizeof *s->sags);
    for (int32_t n = 0; n < nodes; n++) {
        if (!(s->sag[n] > SAG_MAX * s->length[n])) continue;
        s->sags[s->piece[n]] = true;
        carried = false;
    }
    return carried;
}

static double distance(const search *s, int32_t m, int32_t n) {
    double way[3];
    lar_minus(s->meshing->mesh.position[m], s->meshing->mesh.position[n], way);
    return lar_length(way);
}

/* An island may be all handle, which then gives way. */
static bool is_spared(const search *s, int32_t n) {
    return s->handle[n] && !s->all_else_done;
}

/* The node of the underside that would sag most, as a part of what it may; -1: none is worth it. */
static int32_t lowest(const search *s) {
    const lar_mesh *mesh = &s->meshing->mesh;
    double max = WORTH_IT * SAG_MAX;
    int32_t best = -1;
    for (int32_t k = 0; k < s->faces; k++)
        for (int a = 0; a < 4; a++) {
            int32_t n = mesh->element[s->face[k] / 6][lar_face_node[s->face[k] % 6][a]];
            if (is_spared(s, n) || !s->sags[s->piece[n]]) continue;
            if (!(s->sag[n] > max * s->length[n])) continue;
            max = s->sag[n] / s->length[n];
            best = n;
        }
    return best;
}

/* Holds the faces around a node that are within reach of it: those that it belongs to, at least. */
static void put_extra_support(search *s, int32_t middle, double reach, bool *extra) {
    const lar_mesh *mesh = &s->meshing->mesh;
    for (int32_t k = 0; k < s->faces; k++) {
        int32_t node[4];
        bool near = false, inside = true;
        for (int a = 0; a < 4; a++) {
            node[a] = mesh->element[s->face[k] / 6][lar_face_node[s->face[k] % 6][a]];
            near |= node[a] == middle;
            inside &= distance(s, node[a], middle) <= reach;
        }
        for (int a = 0; a < 4 && (near || inside); a++) {
            if (is_spared(s, node[a])) continue;
            s->handle[node[a]] = false;
            extra[node[a]] |= !s->all[node[a]];
            s->all[node[a]] = true;
        }
    }
}

/* Extra supports where it would sag most; what is near one needs none in this round. */
static int32_t put_extra_supports(search *s, double apart, bool *extra) {
    int32_t count = 0;
    for (int32_t n; (n = lowest(s)) >= 0; count++) {
        double reach = apart * s->length[n];
        put_extra_support(s, n, RADIUS * reach, extra);
        for (int32_t m = 0; m < s->meshing->mesh.node_count; m++)
            if (distance(s, m, n) < reach) s->sag[m] = 0;
    }
    return count;
}

lar_status lar_extra_supports_choose(const lar_meshing *meshing, const bool *held, int axis,
                                     int sign, bool *handle, int pulled, bool *extra,
                                     int32_t *count, bool *carried, lar_sag *motion,
                                     lar_error *error) {
    search s;
    const size_t nodes = (size_t)meshing->mesh.node_count;
    double apart = APART;
    int round = 0;
    *count = 0;
    *carried = false;
    bool *kept = lar_calloc(nodes, sizeof *kept); /* of the handle, as it is carried so far */
    if (!kept) return lar_fail_memory(error, nodes, "marks of nodes");
    lar_status status = begin(&s, meshing, held, handle, axis, sign, error);
    for (int32_t put = 1; !status && put > 0; *count += put) {
        memcpy(kept, handle, nodes * sizeof *kept);
        status = lar_sag_estimate(meshing, s.all, kept, pulled, motion, s.sag, error);
        *carried = !status && is_carried(&s);
        put = 0;
        for (; !status && !*carried && put == 0 && round < ROUNDS; round++, apart /= 2) {
            put = put_extra_supports(&s, apart, extra);
            s.all_else_done = put == 0;
            if (put == 0) put = put_extra_supports(&s, apart, extra);
            s.all_else_done = false;
        }
    }
    end(&s);
    memcpy(handle, kept, nodes * sizeof *kept);
    free(kept);
    return status;
}
