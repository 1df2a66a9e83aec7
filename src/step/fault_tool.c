/* Which tool, or force that was set, an unstable run has to do with: people can move it slower or
 * make it smaller, when they are told. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/vector.h"
#include "step/step.h"

/* A tool that is no farther from a broken element than so many of its edges had a part in it. One
 * that moves, or has just come to rest, may be farther off: what it has bent springs back when it
 * slips off, and what it pulls may break some layers below. */
static const double TOUCHING = 1.5, MOVING = 8, PULLING = 6;
/* A force no farther than so many edges; a tool that is nearer comes before it. */
static const double PUSHING = 3;
enum { JUST = 1000 };

/* The middle of an element at rest, and about how long its edges are. */
static double element_at_rest(const lar_domain *domain, lar_gid e, double place[3]) {
    double corner[8][3];
    lar_mesh_corners(&domain->model->mesh, e, corner);
    for (int i = 0; i < 3; i++) {
        place[i] = 0;
        for (int a = 0; a < 8; a++) place[i] += corner[a][i] / 8;
    }
    return cbrt(lar_hexahedron_volume(corner));
}

static double touching_distance(const lar_tool *tool, const lar_tool_pose *pose,
                                const double place[3]) {
    lar_tool_body body;
    lar_tool_place(tool, pose, &body, body.now);
    return lar_tool_contact_distance(&body, tool->radius, place);
}

static double holding_distance(const lar_domain *domain, const lar_tools *tools, int32_t tool,
                               const double rest[3]) {
    const lar_tool_faces *faces = &domain->surroundings.faces;
    double nearest = INFINITY;
    for (int32_t i = 0; i < tools->grasp_count; i++) {
        const lar_grasp *grasp = &tools->grasps[i];
        if (grasp->tool != tool) continue;
        double point[3], square = 0;
        lar_face_mean(faces->face[faces->face_of[grasp->face]].rest, grasp->weight, point);
        for (int k = 0; k < 3; k++) square += (point[k] - rest[k]) * (point[k] - rest[k]);
        nearest = fmin(nearest, sqrt(square));
    }
    return nearest;
}

/* Names the nearest force; returns how far it is, INFINITY: too far [m]. */
static double pushing_distance(const lar_domain *domain, const lar_tools *tools,
                               const double rest[3], double edge, lar_fault *fault) {
    double nearest = PUSHING * edge;
    for (int32_t i = 0; i < tools->forces.count; i++) {
        const lar_force_entry *entry = &tools->forces.entry[i];
        const lar_force_nodes on = lar_force_nodes_of(domain->model, entry);
        for (int32_t n = 0; n < on.count; n++) {
            double way[3];
            lar_minus(domain->model->mesh.position[on.node[n]], rest, way);
            if (!(lar_length(way) < nearest)) continue;
            nearest = lar_length(way);
            fault->tool = -1;
            fault->pushed = on.node[n];
            fault->force = lar_length(entry->force);
        }
    }
    return fault->tool < 0 ? nearest : INFINITY;
}

void lar_fault_attribute(const lar_domain *domain, const lar_tools *tools, lar_fault *fault) {
    const lar_tool_faces *faces = &domain->surroundings.faces;
    const lar_tool_list *list = domain->surroundings.list;
    bool moves = fault->kind == LAR_FAULT_SPEED || fault->kind == LAR_FAULT_TOO_FAST;
    bool of_element = fault->kind == LAR_FAULT_ELEMENT || fault->kind == LAR_FAULT_ENERGY_GAIN;
    if (fault->attributed || !(moves || of_element)) return;
    fault->attributed = true;
    if (fault->element < 0) return;
    double rest[3], edge = 0, closest = 1;
    if (of_element) {
        edge = element_at_rest(domain, fault->element, rest);
    } else {
        memcpy(rest, domain->model->mesh.position[fault->element], sizeof rest);
        edge = faces->face_count > 0 ? faces->face[0].edge : domain->thinnest;
    }
    const double force = pushing_distance(domain, tools, rest, edge, fault);
    if (faces->face_count == 0) return;
    for (int32_t t = 0; t < list->count; t++) {
        const lar_tool *tool = &list->tool[t];
        lar_tool_pose pose;
        double velocity[3];
        if (tool->shape == LAR_TOOL_NONE) continue;
        lar_tool_at(&tools->motion[t], fault->step, domain->time_step, &pose, velocity);
        double holding = holding_distance(domain, tools, t, rest), touching = INFINITY;
        const lar_tool_motion *motion = &tools->motion[t];
        bool moving = motion->end > 0 && fault->step < motion->end + JUST;
        if (tool->shape != LAR_TOOL_HAND) touching = touching_distance(tool, &pose, fault->place);
        if (!(fmin(holding, touching) < force)) continue;
        holding /= PULLING * edge;
        touching /= (moving ? MOVING : TOUCHING) * edge;
        if (!(fmin(holding, touching) < closest)) continue;
        closest = fmin(holding, touching);
        fault->tool = t + 1;
        fault->tool_pulls = holding < touching;
        fault->tool_speed =
            sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]);
    }
}

/* Who has caused it, and what to do about that. */
static void name_cause(const lar_domain *domain, const lar_fault *fault, char *cause, size_t size,
                       const char **remedy) {
    if (fault->tool < 0) {
        snprintf(cause, size, "the force of %.3g N that was set on node %lld", fault->force,
                 (long long)domain->model->mesh.node_id[fault->pushed]);
        *remedy = "set a smaller one, on more nodes or growing from step to step";
        return;
    }
    const char *name = domain->surroundings.list->tool[fault->tool - 1].name;
    if (fault->tool_speed > 0)
        snprintf(cause, size, "tool %s moves at %.3g m/s and", name, fault->tool_speed);
    else
        snprintf(cause, size, "tool %s %s and", name,
                 fault->tool_pulls ? "holds the tissue there" : "is pressed in there");
    *remedy = fault->tool_pulls ? "move it slower or pull less far" : "move it slower or less deep";
}

lar_status lar_fault_report_tool(const lar_domain *domain, const lar_fault *fault,
                                 const char *what_it_does, lar_error *error) {
    const lar_mesh *mesh = &domain->model->mesh;
    bool element = fault->kind == LAR_FAULT_ELEMENT || fault->kind == LAR_FAULT_ENERGY_GAIN;
    long long number = (long long)(element ? mesh->element_id : mesh->node_id)[fault->element];
    char cause[400];
    const char *remedy;
    name_cause(domain, fault, cause, sizeof cause, &remedy);
    return lar_fail(error, LAR_ERROR_UNSTABLE,
                    "unstable at step %llu (%.6g s): %s %s %s %lld near (%.4g, %.4g, %.4g) m; %s, "
                    "or use a smaller time step or a finer mesh there",
                    (unsigned long long)fault->step, (double)fault->step * domain->time_step, cause,
                    what_it_does, element ? "element" : "node", number, fault->place[0],
                    fault->place[1], fault->place[2], remedy);
}
