/* Bodies that begin so deep in each other that no face is near. */
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
    int32_t *body;    /* [nodes of the model] the first node of its body (lar_mesh_bodies) */
    uint64_t *active; /* [nodes of the model] passes of the faces of the body that begins there */
    bool *near;       /* [contact nodes] faces of another body are near */
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

static lar_status inside_create(const lar_model *model, const lar_contact_surface *s, inside *in,
                                lar_error *error) {
    const size_t all = (size_t)model->mesh.node_count, nodes = (size_t)s->node_count;
    *in = (inside){.model = model,
                   .surface = s,
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

/* Whether a face of a group is so near that it has told where the node is. */
static bool is_near(const lar_contact_surface *s, const lar_contact_list *list,
                    const lar_contact_group *group) {
    bool near = false;
    for (int32_t i = group->first; i < group->first + group->count && !near; i++) {
        const lar_contact_face *face = &s->face[list->face[i]];
        double corner[4][3];
        lar_face_point point;
        for (int a = 0; a < 4; a++) memcpy(corner[a], s->rest[face->corner[a]], sizeof corner[a]);
        lar_face_closest(s->rest[group->node], (const double(*)[3])corner,
                         LAR_FACE_TIE * face->size, &point);
        near = point.distance <= lar_contact_reach(s, &s->node[group->node], face);
    }
    return near;
}

/* Along the sum of the normals of a node's faces. */
static void find_ways_out(inside *in, const lar_contact_list *list) {
    const lar_contact_surface *s = in->surface;
    lar_mesh_bodies(&in->model->mesh, in->body);
    for (int32_t f = 0; f < s->face_count; f++) {
        double corner[4][3], normal[3];
        for (int a = 0; a < 4; a++)
            memcpy(corner[a], s->rest[s->face[f].corner[a]], sizeof corner[a]);
        lar_face_normal((const double(*)[3])corner, normal);
        in->active[in->body[s->node[s->face[f].corner[0]].node]] |= s->face[f].active;
        for (int k = 0; k < 12; k++) in->along[s->face[f].corner[k / 3]][k % 3] += normal[k % 3];
    }
    for (int32_t g = 0; g < list->group_count; g++) {
        const lar_contact_group *group = &list->group[g];
        if (group->node < s->node_count &&
            s->face[list->face[group->first]].body != s->node[group->node].body &&
            is_near(s, list, group))
            in->near[group->node] = true;
    }
}

/* From a little outside, or they would meet their own faces. */
static void choose_nodes(inside *in) {
    static const double OUTSIDE = 1e-3; /* of what faces a body has below */
    const lar_contact_surface *s = in->surface;
    for (int32_t n = 0; n < s->node_count; n++) {
        double along[3], length = lar_length(in->along[n]);
        if (in->near[n] || !s->node[n].passes || !(length > 0)) continue;
        for (int i = 0; i < 3; i++) {
            along[i] = in->along[n][i] / length;
            in->origin[in->count][i] =
                s->rest[n][i] + OUTSIDE * s->body[s->node[n].body].reach[1] * along[i];
        }
        memcpy(in->along[in->count], along, sizeof along);
        in->node[in->count++] = n;
    }
}

static bool is_inside(const inside *in, int32_t k) {
    const lar_contact_node *node = &in->surface->node[in->node[k]];
    const lar_ray_hit *hit = &in->hit[k];
    if (hit->face < 0 || !(lar_dot(hit->normal, in->along[k]) > 0)) return false;
    const int32_t body = in->body[in->model->surface.corner[hit->face][0]];
    return body != in->body[node->node] && (node->passes & in->active[body]) != 0;
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
    lar_status status = inside_create(model, surface, &in, error);
    if (!status) {
        find_ways_out(&in, list);
        choose_nodes(&in);
        status = lar_model_rays(model, NULL, in.count, (const double(*)[3])in.origin,
                                (const double(*)[3])in.along, INFINITY, in.hit, error);
    }
    for (int32_t k = 0; k < in.count && !status; k++)
        if (is_inside(&in, k)) status = refuse(&in, k, error);
    inside_clear(&in);
    return status;
}
