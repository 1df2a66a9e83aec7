#include <string.h>

#include "model/contact_check.h"
#include "model/scene/scene.h"

/* Faces of the outer surface; `self: true` means all of it. */
static lar_status read_faces(lar_scene *scene, const lar_yaml *node, int32_t **face,
                             int32_t *count) {
    char problem[LAR_PROBLEM_SIZE];
    lar_status status = lar_scene_select(scene, node, LAR_SET_FACES, false, face, count);
    if (!status && lar_face_list_problem(scene->model, *face, *count, problem))
        status = lar_scene_fail(scene, node, LAR_ERROR_MODEL, "%s", problem);
    return status;
}

static lar_status read_self(lar_scene *scene, const lar_yaml *node, lar_contact *contact) {
    contact->kind = LAR_CONTACT_SELF;
    bool plain = node->kind == LAR_YAML_SCALAR && !node->quoted;
    if (plain && strcmp(node->text, "false") == 0)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "self: expected true, or faces; without contact remove the entry");
    if (!plain || strcmp(node->text, "true") != 0)
        return read_faces(scene, node, &contact->face, &contact->face_count);
    const lar_surface *surface = &scene->model->surface;
    size_t bytes = (size_t)surface->face_count * sizeof *contact->face;
    contact->face = lar_calloc(bytes, 1);
    if (!contact->face) return lar_scene_no_memory(scene, bytes);
    memcpy(contact->face, surface->face, bytes);
    contact->face_count = surface->face_count;
    return LAR_OK;
}

static lar_status read_between(lar_scene *scene, const lar_yaml *node, lar_contact *contact) {
    contact->kind = LAR_CONTACT_BETWEEN;
    if (node->kind != LAR_YAML_LIST || node->count != 2)
        return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                              "between: expected two sets of faces, for example [left, right]");
    lar_status status = read_faces(scene, node->first, &contact->face, &contact->face_count);
    if (!status)
        status = read_faces(scene, node->first->next, &contact->against, &contact->against_count);
    return status;
}

static lar_status read_plane(lar_scene *scene, const lar_yaml *entry, const lar_yaml *faces,
                             lar_contact *contact) {
    static const char *const keys[] = {"through", "normal", NULL};
    const char *const what = "the plane of a contact";
    const lar_yaml *plane = lar_yaml_get(entry, "plane"), *through = NULL, *normal = NULL;
    contact->kind = LAR_CONTACT_PLANE;
    lar_status status = lar_scene_keys(scene, plane, what, keys);
    if (!status)
        status = lar_scene_need(scene, plane, what, "through", "through: [0, 0, 0]", &through);
    if (!status)
        status = lar_scene_need(scene, plane, what, "normal", "normal: [0, 0, 1]", &normal);
    if (!status) status = lar_scene_vector(scene, through, LAR_IN_POSITION, contact->through);
    if (!status) status = lar_scene_direction(scene, normal, contact->normal);
    return status ? status : read_faces(scene, faces, &contact->face, &contact->face_count);
}

static lar_status read_distance(lar_scene *scene, const lar_yaml *entry, lar_contact *contact) {
    const lar_yaml *node = lar_yaml_get(entry, "distance");
    if (!node) return LAR_OK;
    if (contact->kind == LAR_CONTACT_PLANE)
        return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                              "a plane pushes what touches it, at no distance; leave it out");
    return lar_scene_positive(scene, node, LAR_IN_METRES, &contact->distance);
}

static lar_status read_restitution(lar_scene *scene, const lar_yaml *entry, lar_contact *contact) {
    const lar_yaml *node = lar_yaml_get(entry, "restitution");
    if (!node) return LAR_OK;
    if (contact->kind != LAR_CONTACT_PLANE)
        return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                              "restitution is of planes; leave it out");
    lar_status status = lar_scene_number(scene, node, LAR_A_RESTITUTION, &contact->restitution);
    if (status || (contact->restitution >= 0 && contact->restitution <= 1)) return status;
    return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                          "restitution is %.40s; it must be from 0 to 1, for example 0.5",
                          node->text);
}

static lar_status read_contact_entry(lar_scene *scene, const lar_yaml *entry) {
    static const char *const keys[] = {"self",     "between",  "faces",       "plane",
                                       "friction", "distance", "restitution", NULL};
    lar_status status = lar_scene_keys(scene, entry, "a contact entry", keys);
    if (status) return status;
    const lar_yaml *self = lar_yaml_get(entry, "self"), *between = lar_yaml_get(entry, "between");
    const lar_yaml *faces = lar_yaml_get(entry, "faces"), *plane = lar_yaml_get(entry, "plane");
    if (!!self + !!between + (faces || plane) != 1 || !faces != !plane)
        return lar_scene_fail(scene, entry, LAR_ERROR_FORMAT,
                              "a contact entry says one of three things: {self: true}, {between: "
                              "[FACES, FACES]}, or {faces: FACES, plane: {through: [0, 0, 0], "
                              "normal: [0, 0, 1]}}");
    lar_contact *contact = LAR_MODEL_APPEND(scene->model, contact);
    if (!contact) return lar_scene_no_memory(scene, sizeof *contact);
    if (self)
        status = read_self(scene, self, contact);
    else if (between)
        status = read_between(scene, between, contact);
    else
        status = read_plane(scene, entry, faces, contact);
    if (!status) status = lar_scene_friction(scene, entry, &contact->friction);
    if (!status) status = read_distance(scene, entry, contact);
    if (!status) status = read_restitution(scene, entry, contact);
    char problem[LAR_PROBLEM_SIZE];
    if (!status && lar_contact_problem(scene->model, contact, problem))
        status = lar_scene_fail(scene, entry, LAR_ERROR_MODEL, "%s", problem);
    return status;
}

lar_status lar_scene_read_contact(lar_scene *scene, const lar_yaml *node) {
    lar_status status = lar_scene_list(scene, node, "contacts, {self: true}");
    if (!status) status = lar_scene_need_surface(scene);
    for (const lar_yaml *entry = node->first; !status && entry; entry = entry->next)
        status = read_contact_entry(scene, entry);
    return status;
}
