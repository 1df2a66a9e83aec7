/* The faces before tools: found once, constant. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "contact/search/symmetry.h"
#include "contact/tool_contact.h"

static bool mine(const lar_model *model, const lar_condition_share *share, int32_t face) {
    return !share || share->presses[model->surface.element[face]] == share->thread;
}

/* Faster than any hand moves; and, in stiff or light bodies, than their nodes go to and fro before
 * a tool that presses them, from step to step: by depth over time step, which goes with that of
 * pressure waves. Without the second the spring would push in every other step, for ever. */
static double lets_go(const lar_model *model, const lar_material *material) {
    static const double HANDS = 0.5, WAVES = 0.02; /* [m/s]; of their speed */
    double modulus =
        lar_material_instant_bulk(material) + 4.0 / 3 * lar_material_instant_shear(material);
    double waves = WAVES * sqrt(modulus / material->density);
    return model->own_units ? waves : fmax(HANDS, waves);
}

/* What lies in a plane of symmetry takes next to nothing from its corners: only tools that are
 * behind that plane meet it. */
static const double CUT_SHARE = 1.0 / 64;

/* Where the wall of a face begins, in radii of the tool. */
static const double WALL = 0.2;

static void add_face(const lar_model *model, const int32_t *local, const uint8_t *faces_at,
                     int32_t face, bool cut, lar_tool_faces *faces) {
    lar_tool_contact_face *f = &faces->face[faces->face_count++];
    *f = (lar_tool_contact_face){.of = face, .wall = WALL, .body = -1};
    for (int a = 0; a < 4; a++) {
        int32_t node = model->surface.corner[face][a];
        f->node[a] = local[node];
        f->share[a] = cut ? CUT_SHARE : 1.0 / faces_at[node];
        memcpy(f->rest[a], model->mesh.position[node], sizeof f->rest[a]);
    }
    for (int a = 0; a < 4; a++) {
        double square = 0;
        for (int i = 0; i < 3; i++) {
            double d = f->rest[(a + 1) % 4][i] - f->rest[a][i];
            square += d * d;
        }
        f->edge = fmax(f->edge, sqrt(square));
    }
    f->lets_go = lets_go(model, lar_model_material_of(model, model->surface.element[face]));
}

/* Corners of own faces that other threads move. */
static void list_foreign(const lar_model *model, const int32_t *local,
                         const lar_condition_share *share, uint8_t *marked, lar_tool_faces *faces) {
    memset(marked, 0, (size_t)model->mesh.node_count);
    for (int32_t f = 0; f < faces->face_count; f++)
        for (int a = 0; a < 4; a++) {
            int32_t node = model->surface.corner[faces->face[f].of][a];
            if (share->holds[node] == share->thread || marked[node]) continue;
            marked[node] = 1;
            faces->foreign[faces->foreign_count++] = local[node];
        }
}

static lar_status allocate_faces(const lar_model *model, int32_t count, lar_tool_faces *faces,
                                 lar_error *error) {
    faces->face = lar_calloc((size_t)count, sizeof *faces->face);
    faces->foreign = lar_calloc((size_t)model->surface.node_count, sizeof *faces->foreign);
    faces->face_of = lar_calloc((size_t)model->surface.face_count, sizeof *faces->face_of);
    faces->weights = lar_calloc(1, sizeof *faces->weights);
    if (faces->face && faces->foreign && faces->face_of && faces->weights) return LAR_OK;
    return lar_fail_memory(error, (size_t)count * sizeof *faces->face, "the faces before tools");
}

LAR_SETUP lar_status lar_tool_faces_create(const lar_model *model, const int32_t *local,
                                           const lar_condition_share *share, lar_tool_faces *faces,
                                           lar_error *error) {
    const lar_surface *surface = &model->surface;
    int32_t count = 0;
    *faces = (lar_tool_faces){0};
    for (int32_t f = 0; f < surface->face_count; f++) count += mine(model, share, f);
    uint8_t *marked = lar_calloc((size_t)model->mesh.node_count, sizeof *marked);
    if (!marked) return lar_fail_memory(error, (size_t)model->mesh.node_count, "the surface");
    lar_symmetry symmetry;
    lar_status status = allocate_faces(model, count, faces, error);
    if (!status) status = lar_symmetry_find(model, &symmetry, error);
    if (!status) {
        for (int32_t f = 0; f < surface->face_count; f++)
            for (int a = 0; a < 4 && !lar_symmetry_cuts(&symmetry, model, f); a++)
                marked[surface->corner[f][a]]++;
        for (int32_t f = 0; f < surface->face_count; f++)
            if (mine(model, share, f))
                add_face(model, local, marked, f, lar_symmetry_cuts(&symmetry, model, f), faces);
        for (int n = 2; n <= LAR_POINTS_ALONG_EDGE; n++)
            lar_tool_contact_grid(n, &faces->weights->of[n]);
        status = lar_tool_faces_group(faces, error);
    }
    if (!status) {
        for (int32_t f = 0; f < surface->face_count; f++) faces->face_of[f] = -1;
        for (int32_t f = 0; f < count; f++) faces->face_of[faces->face[f].of] = f;
        if (share) list_foreign(model, local, share, marked, faces);
    }
    free(marked);
    if (status) lar_tool_faces_destroy(faces);
    return status;
}

void lar_tool_faces_destroy(lar_tool_faces *faces) {
    free(faces->face);
    free(faces->group);
    free(faces->foreign);
    free(faces->face_of);
    free(faces->weights);
    free(faces->rub);
    free(faces->rub_at);
    *faces = (lar_tool_faces){0};
}

void lar_tool_faces_yield_as(const lar_tool_faces *whole, lar_tool_faces *faces) {
    for (int32_t f = 0; f < faces->face_count && whole->weighs; f++) {
        lar_tool_contact_face *face = &faces->face[f];
        const lar_tool_contact_face *like = &whole->face[whole->face_of[face->of]];
        face->wall = like->wall;
        face->body = like->body;
        memcpy(face->yields, like->yields, sizeof face->yields);
    }
}
