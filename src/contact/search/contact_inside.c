/* Bodies that are so deep in each other that contact does not see them: at the start, where they
 * are refused, and later, where nodes have come in past the end of a contact's faces or from
 * behind. */
#include "contact/contact_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/face_contact.h"

/* What is asked of the nodes that no face of another body is near: rays from them, out of their own
 * body. What a ray meets first, it meets from outside; where it meets another body from within, the
 * node lies inside that. */
typedef struct inside {
    const lar_model *model;
    const lar_contact_surface *surface;
    const double (*u)[3]; /* [nodes of the model] displacements; NULL: at rest */
    int32_t *body;        /* [nodes of the model] the first node of its body (lar_mesh_bodies) */
    uint64_t *active; /* [nodes of the model] passes of the faces of the body that begins there */
    bool *near; /* [contact nodes] contact sees them: faces of another body are near, or push */
    int32_t count;
    int32_t *node;                    /* [count] contact nodes that are asked */
    double (*origin)[3], (*along)[3]; /* [count] */
    lar_ray_hit *hit;                 /* [count] */
} inside;

static void inside_clear(inside *in) {
    free(in->body);
    free(in->active);
    free(in->near);
    free(in->node);
    free(in->origin);
    free(in->along);
    free(in->hit);
}

static lar_status inside_create(const lar_model *model, const lar_contact_surface *s,
                                const double (*u)[3], inside *in, lar_error *error) {
    const size_t all = (size_t)model->mesh.node_count, nodes = (size_t)s->node_count;
    *in = (inside){.model = model,
                   .surface = s,
                   .u = u,
                   .body = lar_calloc(all, sizeof *in->body),
                   .active = lar_calloc(all, sizeof *in->active),
                   .near = lar_calloc(nodes, sizeof *in->near),
                   .node = lar_calloc(nodes, sizeof *in->node),
                   .origin = lar_calloc(nodes, sizeof *in->origin),
                   .along = lar_calloc(nodes, sizeof *in->along),
                   .hit = lar_calloc(nodes, sizeof *in->hit)};
    if (in->body && in->active && in->near && in->node && in->origin && in->along && in->hit)
        return LAR_OK;
    return lar_fail_memory(error, 12 * all + nodes * sizeof *in->hit, "bodies at rest");
}

static void place_of(const inside *in, int32_t n, double x[3]) {
    const double *u = in->u ? in->u[in->surface->node[n].node] : NULL;
    for (int i = 0; i < 3; i++) x[i] = in->surface->rest[n][i] + (u ? u[i] : 0);
}

/* Whether a face of a group is so near, in parts of the layer below it, that contact knows where
 * the node is. */
static bool is_near(const inside *in, const lar_contact_list *list, const lar_contact_group *group,
                    double part) {
    const lar_contact_surface *s = in->surface;
    bool near = false;
    double x[3];
    place_of(in, group->node, x);
    for (int32_t i = group->first; i < group->first + group->count && !near; i++) {
        const lar_contact_face *face = &s->face[list->face[i]];
        double corner[4][3];
        lar_face_point point;
        for (int a = 0; a < 4; a++) place_of(in, face->corner[a], corner[a]);
        lar_face_closest(x, (const double(*)[3])corner, LAR_FACE_TIE * face->size, &point);
        near = point.distance <= part * lar_contact_reach(s, &s->node[group->node], face);
    }
    return near;
}

/* Along the sum of the normals of a node's faces. */
static void find_ways_out(inside *in) {
    const lar_contact_surface *s = in->surface;
    lar_mesh_bodies(&in->model->mesh, in->body);
    for (int32_t f = 0; f < s->face_count; f++) {
        double corner[4][3], normal[3];
        for (int a = 0; a < 4; a++) place_of(in, s->face[f].corner[a], corner[a]);
        lar_face_normal((const double(*)[3])corner, normal);
        in->active[in->body[s->node[s->face[f].corner[0]].node]] |= s->face[f].active;
        for (int k = 0; k < 12; k++) in->along[s->face[f].corner[k / 3]][k % 3] += normal[k % 3];
    }
}

static void find_near(inside *in, const lar_contact_list *list, double part) {
    const lar_contact_surface *s = in->surface;
    for (int32_t g = 0; g < list->group_count; g++) {
        const lar_contact_group *group = &list->group[g];
        if (group->node < s->node_count &&
            s->face[list->face[group->first]].body != s->node[group->node].body &&
            is_near(in, list, group, part))
            in->near[group->node] = true;
    }
}

/* A ray from a node, beginning `off` of the layer below its faces farther along. */
static void aim(inside *in, int32_t k, double off) {
    const int32_t n = in->node[k];
    const double layer = in->surface->body[in->surface->node[n].body].reach[1];
    place_of(in, n, in->origin[k]);
    for (int i = 0; i < 3; i++) in->origin[k][i] += off * layer * in->along[k][i];
}

/* From a little outside, or they would meet their own faces. */
static const double OFF = 1e-3;

static lar_status cast(inside *in, lar_error *error) {
    return lar_model_rays(in->model, in->u, in->count, (const double(*)[3])in->origin,
                          (const double(*)[3])in->along, INFINITY, in->hit, error);
}

static void choose_nodes(inside *in) {
    const lar_contact_surface *s = in->surface;
    for (int32_t n = 0; n < s->node_count; n++) {
        double along[3], length = lar_length(in->along[n]);
        if (in->near[n] || !s->node[n].passes || !(length > 0)) continue;
        for (int i = 0; i < 3; i++) along[i] = in->along[n][i] / length;
        memcpy(in->along[in->count], along, sizeof along);
        in->node[in->count] = n;
        aim(in, in->count++, OFF);
    }
}

static bool is_inside(const inside *in, int32_t k) {
    const lar_contact_node *node = &in->surface->node[in->node[k]];
    const lar_ray_hit *hit = &in->hit[k];
    if (hit->face < 0 || !(lar_dot(hit->normal, in->along[k]) > 0)) return false;
    const int32_t body = in->body[in->model->surface.corner[hit->face][0]];
    return body != in->body[node->node] && (node->passes & in->active[body]) != 0;
}

/* in->near[n] becomes whether node n lies inside another body. A ray that meets an edge from
 * outside may name the face that looks away there: another one, which goes a little askew, must say
 * the same. (No direction of a mesh's edges and diagonals is near that.) */
static lar_status find_inside(inside *in, lar_error *error) {
    static const double ASKEW[3] = {0.031, -0.019, 0.047};
    bool any = true;
    lar_status status = LAR_OK;
    for (int ray = 0; ray < 2 && any && !status; ray++) {
        for (int32_t k = 0; k < in->count && ray == 1; k++)
            for (int i = 0; i < 3; i++) in->along[k][i] += ASKEW[i];
        status = cast(in, error);
        any = false;
        for (int32_t k = 0; k < in->count; k++) {
            bool *found = &in->near[in->node[k]];
            *found = (ray == 0 || *found) && is_inside(in, k);
            any = any || *found;
        }
    }
    return status;
}

static lar_status refuse(const inside *in, int32_t k, lar_error *error) {
    const lar_mesh *mesh = &in->model->mesh;
    const int32_t node = in->node[k];
    double way[3];
    lar_minus(in->hit[k].point, in->surface->rest[node], way);
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: node %lld lies inside another body at the start, whose surface at element "
                    "%lld is %.3g m away, and contact would not see them; move the bodies apart, "
                    "or leave contact between them out",
                    lar_model_source(in->model),
                    (long long)mesh->node_id[in->surface->node[node].node],
                    (long long)mesh->element_id[in->hit[k].element], lar_length(way));
}

lar_status lar_contact_refuse_inside(const lar_model *model, const lar_contact_surface *surface,
                                     const lar_contact_list *list, lar_error *error) {
    inside in;
    if (surface->body_count < 2) return LAR_OK;
    lar_status status = inside_create(model, surface, NULL, &in, error);
    if (!status) {
        find_ways_out(&in);
        find_near(&in, list, 1);
        choose_nodes(&in);
        status = find_inside(&in, error);
    }
    for (int32_t k = 0; k < in.count && !status; k++)
        if (in.near[in.node[k]]) status = refuse(&in, k, error);
    inside_clear(&in);
    return status;
}

/* Finds what is near now: faces that hold a node, and those of a search. */
static lar_status look_around(inside *in, const lar_contact_tree *tree, const double (*force)[3],
                              lar_error *error) {
    static const double TOUCHES = 0.2; /* of the layer below a face */
    const lar_contact_surface *s = &tree->surface;
    lar_contact_search search;
    double(*x)[3] = lar_calloc((size_t)s->point_count, sizeof *x);
    if (!x) return lar_fail_memory(error, 24 * (size_t)s->point_count, "bodies in each other");
    lar_status status = lar_contact_search_create(tree, &search, error);
    for (int32_t n = 0; n < s->node_count; n++) {
        in->near[n] = lar_length(force[s->node[n].node]) > 0;
        place_of(in, n, x[n]);
    }
    for (int32_t p = 0; p < s->point_count - s->node_count; p++)
        for (int k = 0; k < s->point[p].count; k++)
            for (int i = 0; i < 3; i++)
                x[s->node_count + p][i] += s->point[p].weight[k] * x[s->point[p].node[k]][i];
    if (!status) {
        if (lar_contact_search_run(&search, (const double(*)[3])x, 0))
            find_near(in, &search.list, TOUCHES);
        lar_contact_search_clear(&search);
    }
    free(x);
    return status;
}

lar_status lar_contact_count_inside(const lar_model *model, const lar_contact_tree *tree,
                                    const double (*u)[3], const double (*force)[3], int32_t *count,
                                    int32_t *node, lar_error *error) {
    const lar_contact_surface *surface = &tree->surface;
    inside in;
    *count = 0;
    *node = -1;
    if (surface->body_count < 2) return LAR_OK;
    lar_status status = inside_create(model, surface, u, &in, error);
    if (!status) status = look_around(&in, tree, force, error);
    if (!status) {
        find_ways_out(&in);
        choose_nodes(&in);
        status = find_inside(&in, error);
    }
    for (int32_t k = 0; k < in.count && !status; k++)
        if (in.near[in.node[k]] && !(*count)++) *node = surface->node[in.node[k]].node;
    inside_clear(&in);
    return status;
}
