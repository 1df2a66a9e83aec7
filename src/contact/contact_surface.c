#include "contact/contact_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/search/symmetry.h"
#include "divide/incidence.h"
#include "mechanics/contact.h"
#include "mechanics/hex8.h"
#include "model/springs.h"

/* While it is put together. */
typedef struct workspace {
    const lar_model *model;
    lar_contact_surface *surface;
    lar_incidence incidence;
    int32_t *body;     /* [nodes of the model] a node that stands for the whole body */
    uint64_t *passes;  /* [nodes of the model] */
    uint64_t *touched; /* [nodes of the model] passes whose faces have the node */
    uint64_t *active;  /* [faces of the model's surface] */
    int32_t *index_of; /* [nodes of the model] contact node, -1: none */
    int32_t *face_of;  /* [faces of the model's surface] contact face, -1: none */
    int32_t *seen;     /* [elements] the last node, plus 1, that went by */
    lar_symmetry symmetry;
} workspace;

static void clear_workspace(workspace *d) {
    lar_incidence_clear(&d->incidence);
    free(d->body);
    free(d->passes);
    free(d->touched);
    free(d->active);
    free(d->index_of);
    free(d->face_of);
    free(d->seen);
}

static lar_status allocate_workspace(workspace *d, lar_error *error) {
    size_t nodes = (size_t)d->model->mesh.node_count;
    size_t faces = (size_t)d->model->surface.face_count;
    d->body = lar_calloc(nodes, sizeof *d->body);
    d->passes = lar_calloc(nodes, sizeof *d->passes);
    d->touched = lar_calloc(nodes, sizeof *d->touched);
    d->active = lar_calloc(faces, sizeof *d->active);
    d->index_of = lar_calloc(nodes, sizeof *d->index_of);
    d->face_of = lar_calloc(faces, sizeof *d->face_of);
    d->seen = lar_calloc((size_t)d->model->mesh.element_count, sizeof *d->seen);
    if (d->body && d->passes && d->touched && d->active && d->index_of && d->face_of && d->seen)
        return lar_incidence_build(&d->model->mesh, &d->incidence, error);
    return lar_fail_memory(error, 24 * nodes + 12 * faces, "the surfaces in contact");
}

/* ---- passes --------------------------------------------------------------------------------- */

static void add_pass(workspace *d, const int32_t *slave, int32_t slave_count, const int32_t *master,
                     int32_t master_count, uint64_t pass) {
    const lar_surface *surface = &d->model->surface;
    for (int32_t i = 0; i < slave_count; i++) {
        const int32_t *corner = surface->corner[lar_surface_find(surface, slave[i])];
        for (int a = 0; a < 4; a++) d->passes[corner[a]] |= pass;
    }
    for (int32_t i = 0; i < master_count; i++) {
        int32_t face = lar_surface_find(surface, master[i]);
        d->active[face] |= pass;
        for (int a = 0; a < 4; a++) d->touched[surface->corner[face][a]] |= pass;
    }
}

static lar_status add_passes(workspace *d, lar_error *error) {
    const lar_model *model = d->model;
    int used = 0;
    for (int i = 0; i < model->contact_count; i++) {
        const lar_contact *c = &model->contact[i];
        if (c->kind == LAR_CONTACT_PLANE) continue;
        if (used > LAR_CONTACT_PASSES_MAX - 2)
            return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                            "%s: there are more than %d contacts of bodies; put surfaces together "
                            "in one contact of a set with itself",
                            lar_model_source(model), LAR_CONTACT_PASSES_MAX / 2);
        bool self = c->kind == LAR_CONTACT_SELF;
        const int32_t *against = self ? c->face : c->against;
        int32_t count = self ? c->face_count : c->against_count;
        d->surface->friction[used] = c->friction;
        if (!self) d->surface->friction[used + 1] = c->friction;
        d->surface->rough = d->surface->rough || c->friction > 0;
        add_pass(d, c->face, c->face_count, against, count, UINT64_C(1) << used++);
        if (!self) add_pass(d, against, count, c->face, c->face_count, UINT64_C(1) << used++);
    }
    return LAR_OK;
}

static uint64_t touched_by(const workspace *d, int32_t face) {
    const int32_t *corner = d->model->surface.corner[face];
    return d->touched[corner[0]] | d->touched[corner[1]] | d->touched[corner[2]] |
           d->touched[corner[3]];
}

/* ---- nodes and faces ------------------------------------------------------------------------ */

/* What the element measures across, from this face to the opposite one. */
static double thickness(const lar_mesh *mesh, int32_t face) {
    double corner[8][3], middle[3] = {0}, opposite[3] = {0}, normal[3];
    int f = face % 6;
    lar_mesh_corners(mesh, face / 6, corner);
    const uint8_t *own = lar_face_node[f], *other = lar_face_node[f ^ 1];
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) {
            middle[i] += 0.25 * corner[own[a]][i];
            opposite[i] += 0.25 * corner[other[a]][i];
        }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] =
            (corner[own[2]][j] - corner[own[0]][j]) * (corner[own[3]][k] - corner[own[1]][k]) -
            (corner[own[2]][k] - corner[own[0]][k]) * (corner[own[3]][j] - corner[own[1]][j]);
    }
    double length = 0, across = 0;
    for (int i = 0; i < 3; i++) {
        length += normal[i] * normal[i];
        across += (middle[i] - opposite[i]) * normal[i];
    }
    return length > 0 ? fabs(across) / sqrt(length) : 0;
}

static double size_of(const lar_mesh *mesh, const int32_t corner[4]) {
    double max = 0;
    for (int a = 0; a < 2; a++) {
        double square = 0;
        for (int i = 0; i < 3; i++) {
            double d = mesh->position[corner[a]][i] - mesh->position[corner[a + 2]][i];
            square += d * d;
        }
        max = fmax(max, sqrt(square));
    }
    return max;
}

static lar_status list_nodes(workspace *d, const double *mass, const int32_t *local,
                             lar_error *error) {
    const lar_mesh *mesh = &d->model->mesh;
    lar_contact_surface *s = d->surface;
    for (int32_t n = 0; n < mesh->node_count; n++)
        d->index_of[n] = d->index_of[n] ? s->node_count++ : -1;
    s->node = lar_calloc((size_t)s->node_count, sizeof *s->node);
    s->rest = lar_calloc((size_t)s->node_count, sizeof *s->rest);
    if (!s->node || !s->rest)
        return lar_fail_memory(error, 56 * (size_t)s->node_count, "the nodes in contact");
    for (int32_t n = 0; n < mesh->node_count; n++) {
        int32_t i = d->index_of[n];
        if (i < 0) continue;
        s->node[i] = (lar_contact_node){
            .node = n, .body = d->body[n], .passes = d->passes[n], .mass = mass[local[n]]};
        memcpy(s->rest[i], mesh->position[n], sizeof s->rest[i]);
        s->slave_count += d->passes[n] != 0;
    }
    return LAR_OK;
}

static lar_status list_faces(workspace *d, lar_error *error) {
    const lar_surface *surface = &d->model->surface;
    lar_contact_surface *s = d->surface;
    for (int32_t f = 0; f < surface->face_count; f++)
        d->face_of[f] =
            (d->active[f] | touched_by(d, f)) && !lar_symmetry_cuts(&d->symmetry, d->model, f)
                ? s->face_count++
                : -1;
    s->face = lar_calloc((size_t)s->face_count, sizeof *s->face);
    if (!s->face)
        return lar_fail_memory(error, (size_t)s->face_count * sizeof *s->face,
                               "the faces in contact");
    for (int32_t f = 0; f < surface->face_count; f++) {
        if (d->face_of[f] < 0) continue;
        lar_contact_face *face = &s->face[d->face_of[f]];
        face->element = surface->element[f];
        face->active = d->active[f];
        face->mute = touched_by(d, f) & ~d->active[f];
        face->size = size_of(&d->model->mesh, surface->corner[f]);
        memcpy(face->corner, surface->corner[f], sizeof face->corner);
        for (int a = 0; a < 4; a++) d->index_of[face->corner[a]] = 1;
    }
    return LAR_OK;
}

/* Bodies of a contact with a distance keep no more. */
static void take_distances(const workspace *d) {
    for (int i = 0; i < d->model->contact_count; i++) {
        const lar_contact *contact = &d->model->contact[i];
        for (int32_t k = 0; k < contact->face_count + contact->against_count; k++) {
            const int32_t of = k < contact->face_count ? contact->face[k]
                                                       : contact->against[k - contact->face_count];
            const int32_t face = d->face_of[lar_surface_find(&d->model->surface, of)];
            if (!(contact->distance > 0) || face < 0) continue;
            double *clear = &d->surface->body[d->surface->face[face].body].clear;
            *clear = fmin(*clear, contact->distance);
        }
    }
}

/* A face that is none in contact may be where its body, of that number, ends at a plane. */
static void note_end(const workspace *d, int32_t f, int32_t number) {
    if (number < 0) return;
    lar_contact_body *body = &d->surface->body[number];
    const bool ends = lar_symmetry_ends(&d->symmetry, d->model, f, body->from, body->to);
    body->cut = body->cut || ends;
}

/* Bodies count from 0, in the order of their first nodes. */
static lar_status number_bodies(workspace *d, lar_error *error) {
    lar_contact_surface *s = d->surface;
    int32_t *number = d->index_of; /* read no more: by the node that stands for a body */
    memset(number, -1, (size_t)d->model->mesh.node_count * sizeof *number);
    for (int32_t n = 0; n < s->node_count; n++) {
        if (number[s->node[n].body] < 0) number[s->node[n].body] = s->body_count++;
        s->node[n].body = number[s->node[n].body];
    }
    s->body = lar_calloc((size_t)s->body_count, sizeof *s->body);
    if (!s->body) return lar_fail_memory(error, (size_t)s->body_count * sizeof *s->body, "bodies");
    for (int32_t b = 0; b < s->body_count; b++)
        s->body[b] = (lar_contact_body){.reach = {INFINITY, INFINITY},
                                        .clear = INFINITY,
                                        .from = {-INFINITY, -INFINITY, -INFINITY},
                                        .to = {INFINITY, INFINITY, INFINITY}};
    for (int32_t f = 0; f < d->model->surface.face_count; f++) {
        if (d->face_of[f] < 0) {
            note_end(d, f, number[d->body[d->model->surface.corner[f][0]]]);
            continue;
        }
        lar_contact_face *face = &s->face[d->face_of[f]];
        face->body = s->node[face->corner[0]].body;
        lar_contact_body *body = &s->body[face->body];
        double deep = thickness(&d->model->mesh, d->model->surface.face[f]);
        body->reach[0] = fmin(body->reach[0], 0.5 * deep);
        body->reach[1] = fmin(body->reach[1], deep);
    }
    take_distances(d);
    s->reach = INFINITY;
    for (int32_t b = 0; b < s->body_count; b++) {
        s->reach = fmin(s->reach, s->body[b].reach[0]);
        if (s->body[b].reach[1] < INFINITY) s->reach_max = fmax(s->reach_max, s->body[b].reach[1]);
    }
    return LAR_OK;
}

/* Nodes of slaves that are on no face of a pass' other side count too. */
static lar_status list_all(workspace *d, const double *mass, const int32_t *local,
                           lar_error *error) {
    lar_contact_surface *s = d->surface;
    lar_status status = list_faces(d, error);
    for (int32_t n = 0; n < d->model->mesh.node_count; n++)
        if (d->passes[n]) d->index_of[n] = 1;
    if (!status) status = list_nodes(d, mass, local, error);
    if (status) return status;
    for (int32_t f = 0; f < s->face_count; f++)
        for (int a = 0; a < 4; a++) s->face[f].corner[a] = d->index_of[s->face[f].corner[a]];
    return number_bodies(d, error);
}

static void count_possible(lar_contact_surface *s) {
    uint64_t nodes[LAR_CONTACT_PASSES_MAX] = {0}, faces[LAR_CONTACT_PASSES_MAX] = {0};
    for (int pass = 0; pass < LAR_CONTACT_PASSES_MAX; pass++) {
        for (int32_t n = 0; n < s->point_count; n++) nodes[pass] += s->node[n].passes >> pass & 1;
        for (int32_t f = 0; f < s->face_count; f++) faces[pass] += s->face[f].active >> pass & 1;
        s->possible += nodes[pass] * faces[pass];
    }
}

/* ---- springs -------------------------------------------------------------------------------- */

/* The springs at a node take what its own elements leave of the step, those at the body's worst
 * element the least (docs/theory.md, contact). On sharp edges they take no more than a part of it:
 * where bodies lie edge on edge both press, points between nodes do too, and all together is 1.8
 * times what it is within a face. Only short steps leave more (engine/body_contact_rest). */
static double stiffness_at(const lar_contact_node *node, double time_step, double stable) {
    static const double ON_EDGES = 0.3; /* m/dt^2 */
    double stiffness = lar_contact_law_for(time_step, stable).stiffness;
    return node->blunt < 1 ? fmin(stiffness, ON_EDGES / (time_step * time_step)) : stiffness;
}

/* Fits masses to these, and finds how stiff each body wants its springs. */
static lar_status fit_masses(const lar_model *model, double time_step, double stable_step,
                             lar_contact_surface *s, lar_error *error) {
    /* A quarter makes it of the frequency's square and the stable step's; but light nodes between
     * sharp edges are thrown by more than this (engine/edges). */
    static const double FIRM = 0.375 * 0.25;
    const lar_mesh *mesh = &model->mesh;
    double *fastest = lar_calloc(2 * (size_t)mesh->node_count, sizeof *fastest), max = 0, *squares;
    double *firm = fastest + mesh->node_count; /* 0: none */
    if (!fastest) return lar_fail_memory(error, 8 * (size_t)mesh->node_count, "springs of contact");
    lar_status status = lar_spring_squares(model, &squares, error);
    if (status) {
        free(fastest);
        return status;
    }
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double corner[8][3];
        lar_hex8 hex8;
        const lar_material *material = lar_model_material_of(model, e);
        lar_mesh_corners(mesh, e, corner);
        lar_hex8_prepare(corner, material, &hex8);
        lar_model_fibres(model, e, hex8.fibre);
        double frequency = lar_model_slowed(model, lar_hex8_frequency(&hex8, material));
        if (squares) frequency = sqrt(frequency * frequency + lar_spring_square(model, squares, e));
        max = fmax(max, frequency);
        double own =
            FIRM * lar_contact_wanted(lar_material_confined(material)) * frequency * frequency;
        for (int a = 0; a < 8; a++) {
            int32_t n = mesh->element[e][a];
            fastest[n] = fmax(fastest[n], frequency);
            firm[n] = firm[n] > 0 ? fmin(firm[n], own) : own;
        }
    }
    double body = lar_contact_law_for(time_step, stable_step).stiffness;
    for (int32_t b = 0; b < s->body_count; b++) s->body[b].firm = INFINITY;
    for (int32_t n = 0; n < s->node_count; n++) {
        double *softest = &s->body[s->node[n].body].firm;
        *softest = fmin(*softest, firm[s->node[n].node]);
        double stable = stable_step * max / fastest[s->node[n].node];
        s->node[n].mass *= stiffness_at(&s->node[n], time_step, stable) / body;
    }
    lar_contact_edges_fit(s);
    free(squares);
    free(fastest);
    return LAR_OK;
}

lar_status lar_contact_surface_fit(const lar_model *model, double time_step, double stable_step,
                                   lar_contact_surface *s, lar_error *error) {
    /* What comes at this speed [m/s] is noticed a step before it touches, from no nearer and no
     * farther than these parts of the thinnest element. */
    static const double SPEED = 6, NEAREST = 0.25, FARTHEST = 0.5;
    s->speed = model->own_units ? 0 : SPEED;
    for (int32_t b = 0; b < s->body_count; b++) {
        lar_contact_body *body = &s->body[b];
        double min = NEAREST * body->reach[1], max = FARTHEST * body->reach[1];
        double wanted = fmin(fmax(s->speed * time_step, min), max);
        body->standoff = fmin(wanted, body->clear);
    }
    return fit_masses(model, time_step, stable_step, s, error);
}

/* ---- never together ------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* A growing list. */
typedef struct numbers {
    int32_t *value;
    int64_t count, room;
} numbers;

static bool append(numbers *list, int32_t value) {
    if (list->count == list->room) {
        int64_t room = list->room ? 2 * list->room : 1024;
        int32_t *value_more = realloc(list->value, (size_t)room * sizeof *value_more);
        if (!value_more) return false;
        list->value = value_more;
        list->room = room;
    }
    list->value[list->count++] = value;
    return true;
}

/* The contact faces of an element: at most one per local face. */
static bool append_faces_of(const workspace *d, int32_t element, numbers *list) {
    for (int f = 0; f < 6; f++) {
        int32_t face = lar_surface_find(&d->model->surface, element * 6 + f);
        if (face >= 0 && d->face_of[face] >= 0 && !append(list, d->face_of[face])) return false;
    }
    return true;
}

/* Faces of all elements around the elements around a node. */
static bool append_neighbours(workspace *d, int32_t node, numbers *list) {
    const lar_incidence *around = &d->incidence;
    const lar_mesh *mesh = &d->model->mesh;
    for (int64_t i = around->first[node]; i < around->first[node + 1]; i++)
        for (int a = 0; a < 8; a++) {
            int32_t other = mesh->element[around->element[i]][a];
            for (int64_t j = around->first[other]; j < around->first[other + 1]; j++) {
                int32_t element = around->element[j];
                if (d->seen[element] == node + 1) continue;
                d->seen[element] = node + 1;
                if (!append_faces_of(d, element, list)) return false;
            }
        }
    return true;
}

static lar_status list_apart(workspace *d, lar_error *error) {
    lar_contact_surface *s = d->surface;
    numbers list = {0};
    s->apart_first = lar_calloc((size_t)s->node_count + 1, sizeof *s->apart_first);
    bool fits = s->apart_first != NULL;
    for (int32_t n = 0; n < s->node_count && fits; n++) {
        s->apart_first[n] = list.count;
        if (!s->node[n].passes) continue;
        fits = append_neighbours(d, s->node[n].node, &list);
        qsort(list.value + s->apart_first[n], (size_t)(list.count - s->apart_first[n]),
              sizeof *list.value, ascending);
    }
    s->apart = list.value;
    if (!fits)
        return lar_fail_memory(error, 8 * (size_t)list.room, "the neighbours of nodes in contact");
    s->apart_first[s->node_count] = list.count;
    return LAR_OK;
}

lar_status lar_contact_surface_keep_apart(lar_contact_surface *s, const int32_t (*pair)[2],
                                          int32_t count, lar_error *error) {
    if (count == 0) return LAR_OK;
    size_t total = (size_t)(s->apart_first[s->node_count] + count);
    int32_t *all = lar_calloc(total, sizeof *all);
    if (!all) return lar_fail_memory(error, 4 * total, "the neighbours of nodes in contact");
    int64_t written = 0, from = 0;
    int32_t next = 0;
    for (int32_t n = 0; n < s->node_count; n++) {
        int64_t first = written, end = s->apart_first[n + 1];
        for (; from < end; from++) all[written++] = s->apart[from];
        for (; next < count && pair[next][0] == n; next++) all[written++] = pair[next][1];
        s->apart_first[n] = first;
        qsort(all + first, (size_t)(written - first), sizeof *all, ascending);
    }
    s->apart_first[s->node_count] = written;
    free(s->apart);
    s->apart = all;
    return LAR_OK;
}

bool lar_contact_apart(const lar_contact_surface *surface, int32_t node, int32_t face) {
    int64_t low = surface->apart_first[node], end = surface->apart_first[node + 1], high = end;
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (surface->apart[middle] < face)
            low = middle + 1;
        else
            high = middle;
    }
    return low < end && surface->apart[low] == face;
}

/* ---- slices between two planes -------------------------------------------------------------- */

/* What lies in a plane across which it is held (docs/decisions.md, 185). */
static lar_status note_planes(const lar_model *model, lar_contact_surface *s, lar_error *error) {
    unsigned *held = lar_calloc((size_t)model->mesh.node_count, sizeof *held);
    if (!held) return lar_fail_memory(error, 4 * (size_t)model->mesh.node_count, "supports");
    for (int i = 0; i < model->fix_count; i++)
        for (int32_t n = 0; n < model->fix[i].nodes.count; n++)
            held[model->fix[i].nodes.node[n]] |= model->fix[i].axes;
    for (int32_t n = 0; n < s->node_count; n++) s->node[n].held = held[s->node[n].node];
    for (int32_t f = 0; f < s->face_count; f++) {
        const int32_t *corner = s->face[f].corner;
        unsigned all = ~0U;
        for (int a = 0; a < 4; a++) all &= s->node[corner[a]].held;
        for (int axis = 0; axis < 3; axis++)
            for (int a = 1; a < 4; a++)
                if (s->rest[corner[a]][axis] != s->rest[corner[0]][axis]) all &= ~(1U << axis);
        s->face[f].plane = all;
    }
    free(held);
    return LAR_OK;
}

/* ---- all of it ------------------------------------------------------------------------------ */

static bool asked_for(const lar_model *model) {
    for (int i = 0; i < model->contact_count; i++)
        if (model->contact[i].kind != LAR_CONTACT_PLANE) return true;
    return false;
}

lar_status lar_contact_surface_create(const lar_model *model, const double *mass,
                                      const int32_t *local, lar_contact_surface *surface,
                                      lar_error *error) {
    *surface = (lar_contact_surface){0};
    if (!asked_for(model)) return LAR_OK;
    workspace d = {.model = model, .surface = surface};
    lar_status status = allocate_workspace(&d, error);
    if (!status) status = lar_symmetry_find(model, &d.symmetry, error);
    if (!status) lar_mesh_bodies(&model->mesh, d.body);
    if (!status) status = add_passes(&d, error);
    if (!status) status = list_all(&d, mass, local, error);
    if (!status) status = lar_contact_surface_edges(surface, error);
    if (!status) status = note_planes(model, surface, error);
    if (!status) status = list_apart(&d, error);
    if (!status) count_possible(surface);
    clear_workspace(&d);
    if (status) lar_contact_surface_clear(surface);
    return status;
}

void lar_contact_surface_clear(lar_contact_surface *surface) {
    free(surface->node);
    free(surface->face);
    free(surface->body);
    free(surface->point);
    free(surface->rest);
    free(surface->apart_first);
    free(surface->apart);
    free(surface->flush_first);
    free(surface->flush);
    *surface = (lar_contact_surface){0};
}

double lar_contact_softness(const lar_contact_surface *s, int32_t node, int32_t face,
                            double standoff, double stiffness) {
    double speed = 0.5 * s->speed / standoff;
    if (!(speed * speed < stiffness)) return 1;
    double firm = fmin(s->body[s->node[node].body].firm, s->body[s->face[face].body].firm);
    return fmin(1, fmax(speed * speed, firm) / stiffness);
}
