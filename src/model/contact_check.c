#include "model/contact_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/pose.h"

/* What rests exactly on a plane or at a tool may lie this part of the model's size inside, from
 * rounding. */
static const double ROUNDING = 1e-6;

static double size_of(const lar_mesh *mesh) {
    double square = 0;
    for (int i = 0; i < 3; i++) {
        double low = mesh->position[0][i], high = low;
        for (int32_t n = 1; n < mesh->node_count; n++) {
            low = fmin(low, mesh->position[n][i]);
            high = fmax(high, mesh->position[n][i]);
        }
        square += (high - low) * (high - low);
    }
    return sqrt(square);
}

double lar_overlap_rounding(const lar_mesh *mesh) {
    return ROUNDING * size_of(mesh);
}

static bool finite3(const double v[3]) {
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* ---- contact -------------------------------------------------------------------------------- */

bool lar_face_list_problem(const lar_model *model, const int32_t *face, int32_t count,
                           char problem[LAR_PROBLEM_SIZE]) {
    const lar_mesh *mesh = &model->mesh;
    if (count <= 0 || !face) {
        snprintf(problem, LAR_PROBLEM_SIZE, "there is no face in this contact; name at least one");
        return true;
    }
    for (int32_t i = 0; i < count; i++) {
        if (i > 0 && face[i] <= face[i - 1]) {
            snprintf(problem, LAR_PROBLEM_SIZE, "its faces must be in ascending order, each once");
            return true;
        }
        if (lar_surface_find(&model->surface, face[i]) >= 0) continue;
        if (face[i] < 0 || face[i] / 6 >= mesh->element_count)
            snprintf(problem, LAR_PROBLEM_SIZE, "there is no face %d in the mesh", (int)face[i]);
        else
            snprintf(problem, LAR_PROBLEM_SIZE,
                     "face %d of element %lld is inside the body, where nothing can touch it; take "
                     "faces of the outer surface only, for example {all: [NAME, {surface: true}]}",
                     (int)(face[i] % 6), (long long)mesh->element_id[face[i] / 6]);
        return true;
    }
    return false;
}

static int ascending(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

static bool between_problem(const lar_model *model, const lar_contact *contact,
                            char problem[LAR_PROBLEM_SIZE]) {
    if (lar_face_list_problem(model, contact->against, contact->against_count, problem))
        return true;
    int32_t shared = 0, first = 0;
    for (int32_t i = 0; i < contact->face_count; i++)
        if (bsearch(&contact->face[i], contact->against, (size_t)contact->against_count,
                    sizeof *contact->against, ascending)) {
            if (!shared++) first = contact->face[i];
        }
    if (shared)
        snprintf(problem, LAR_PROBLEM_SIZE,
                 "the two sets of faces have %d in common (one is face %d of element %lld); "
                 "contact of a surface with itself is {self: FACES}",
                 (int)shared, (int)(first % 6), (long long)model->mesh.element_id[first / 6]);
    return shared > 0;
}

static bool plane_problem(const lar_model *model, const lar_contact *contact,
                          char problem[LAR_PROBLEM_SIZE]) {
    const lar_mesh *mesh = &model->mesh;
    const double *p = contact->through, *n = contact->normal;
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), deepest = 0;
    if (!finite3(p) || !(fabs(length - 1) < 1e-9)) {
        snprintf(problem, LAR_PROBLEM_SIZE,
                 "the plane needs a finite point and a normal of length one");
        return true;
    }
    int32_t worst = -1;
    for (int32_t i = 0; i < 4 * contact->face_count; i++) {
        int32_t face = contact->face[i / 4];
        int32_t node = mesh->element[face / 6][lar_face_node[face % 6][i % 4]];
        const double *x = mesh->position[node];
        double depth = (p[0] - x[0]) * n[0] + (p[1] - x[1]) * n[1] + (p[2] - x[2]) * n[2];
        if (depth > deepest) {
            deepest = depth;
            worst = node;
        }
    }
    if (deepest <= ROUNDING * size_of(mesh)) return false;
    snprintf(
        problem, LAR_PROBLEM_SIZE,
        "node %lld lies %.3g m behind this plane at the start; move the plane, turn its normal "
        "to the side where the body is, or leave those faces out",
        (long long)mesh->node_id[worst], deepest);
    return true;
}

/* Rubber on dry glass has 3; more is a mistake in units. */
static const double FRICTION_MAX = 5;

const char *lar_friction_problem(double friction) {
    return friction >= 0 && friction <= FRICTION_MAX ? NULL : "the friction must be from 0 to 5";
}

bool lar_contact_problem(const lar_model *model, const lar_contact *contact,
                         char problem[LAR_PROBLEM_SIZE]) {
    if (lar_face_list_problem(model, contact->face, contact->face_count, problem)) return true;
    const char *wrong = lar_friction_problem(contact->friction);
    if (wrong) {
        snprintf(problem, LAR_PROBLEM_SIZE, "%s", wrong);
        return true;
    }
    if (contact->kind == LAR_CONTACT_SELF) return false;
    if (contact->kind == LAR_CONTACT_BETWEEN) return between_problem(model, contact, problem);
    return plane_problem(model, contact, problem);
}

bool lar_restitution_problem(const lar_model *model, char problem[LAR_PROBLEM_SIZE]) {
    for (int i = 0; i < model->contact_count; i++) {
        bool stops = !(model->contact[i].restitution > 0);
        for (int t = 0; t < model->tool_count; t++)
            stops = stops || (i < 32 && model->tool[t].planes >> i & 1);
        if (stops) continue;
        snprintf(
            problem, LAR_PROBLEM_SIZE,
            "contact entry %d: restitution is of rigid bodies with the key free, and the plane "
            "is before none",
            i + 1);
        return true;
    }
    return false;
}

/* ---- tools ---------------------------------------------------------------------------------- */

bool lar_tool_name_problem(const char *name, char problem[LAR_PROBLEM_SIZE]) {
    static const char hand[] = "hand";
    size_t length = strlen(name), word = sizeof hand - 1;
    bool reserved = strncmp(name, hand, word) == 0 && (name[word] == '\0' || name[word] == ' ');
    if (length > 0 && length <= LAR_TOOL_NAME_MAX && !reserved) return false;
    if (reserved)
        snprintf(problem, LAR_PROBLEM_SIZE,
                 "\"%.40s\" is the name of the hand that pulls with the mouse; choose another name",
                 name);
    else
        snprintf(problem, LAR_PROBLEM_SIZE,
                 "the name of a tool has 1 to %d bytes, this one has %zu", LAR_TOOL_NAME_MAX,
                 length);
    return true;
}

bool lar_tool_jaws_part(const lar_tool *tool) {
    static const double RADIANS = 3.2 * LAR_PI / 180; /* more degrees are no radians */
    return tool->spread >= RADIANS || 0.5 * tool->length * tool->spread >= tool->radius;
}

const char *lar_tool_size_problem(const lar_tool *tool) {
    static const double LARGEST = 1e6; /* [m] */
    const bool rigid = tool->shape == LAR_TOOL_RIGID;
    bool long_one = tool->shape == LAR_TOOL_CAPSULE || tool->shape == LAR_TOOL_GRASPER;
    if (tool->shape != LAR_TOOL_SPHERE && !long_one && !rigid)
        return "the shape must be a sphere, a capsule or a grasper";
    if (!(tool->radius > 0) || !isfinite(tool->radius))
        return "the radius must be finite and more than zero";
    if (long_one ? !(tool->length > 0) || !isfinite(tool->length) : !rigid && tool->length != 0)
        return long_one ? "the length must be finite and more than zero" : "a sphere has no length";
    if (tool->shape == LAR_TOOL_GRASPER ? !(tool->spread > 0 && tool->spread < LAR_PI)
                                        : tool->spread != 0)
        return tool->shape == LAR_TOOL_GRASPER
                   ? "the spread must be more than zero and less than 180 degrees"
                   : "only a grasper has a spread";
    if (tool->shape == LAR_TOOL_GRASPER && !lar_tool_jaws_part(tool))
        return "its jaws do not part at that spread (radians here)";
    if (tool->radius > LARGEST || tool->length > LARGEST)
        return "its radius and length must be below 1e6 m";
    for (int i = 0; i < 3; i++)
        if (!(fabs(tool->rest.position[i]) <= LAR_POSE_FARTHEST))
            return "its place must be finite and within 1e9 m";
    if (!(tool->rest.opening >= 0 && tool->rest.opening <= 1))
        return "its opening must be between 0 and 1";
    if (!lar_pose_is_normal(&tool->rest))
        return "its orientation must be a quaternion of length one";
    return lar_friction_problem(tool->friction);
}

bool lar_tool_problem(const lar_model *model, const lar_tool *tool,
                      char problem[LAR_PROBLEM_SIZE]) {
    const char *wrong = lar_tool_size_problem(tool);
    if (wrong) {
        snprintf(problem, LAR_PROBLEM_SIZE, "%s", wrong);
        return true;
    }
    if (tool->shape == LAR_TOOL_RIGID) return false; /* it touches nothing */
    int32_t face = 0;
    double gap = lar_tool_gap(model, tool, &face);
    if (gap >= -ROUNDING * size_of(&model->mesh)) return false;
    snprintf(problem, LAR_PROBLEM_SIZE,
             "the tool would begin %.3g m inside the body, at element %lld; begin outside and move "
             "it in",
             -gap, (long long)model->mesh.element_id[model->surface.element[face]]);
    return true;
}
