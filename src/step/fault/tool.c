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
/* A smaller force than this part of the largest beside it is not what broke the tissue; nor one
 * that strains the element by less than a thousandth. */
static const double BESIDE = 0.1, STRAINS = 1e-3;
/* Hands press with no more than tools may bear (contact/tool_body.h): so many times that is what
 * tissue does that is thrown at the tool. */
static const double THROWN = 4;

/* Where something broke, and what acts there. */
typedef struct fault_spot {
    double rest[3]; /* the middle of the element, or the node, at rest [m] */
    double edge;    /* about how long the element's edges are [m] */
    double firm;    /* the force that strains it by about one [N] */
    double loads;   /* the largest on a node there, of the scene, and set where one is named [N] */
} fault_spot;

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

/* How far a node is from there, in edges, at rest. */
static double edges_from(const lar_domain *domain, lar_gid node, const fault_spot *spot) {
    double way[3];
    lar_minus(domain->model->mesh.position[node], spot->rest, way);
    return lar_length(way) / spot->edge;
}

static double factor_at(const lar_model *model, int curve, double time) {
    return curve < 0 ? 1 : fabs(lar_curve_value(&model->curve[curve], time));
}

/* The largest load of the scene on a node there [N]; of pressures about. */
static double loads_at(const lar_domain *domain, const lar_tools *tools, double time, double weight,
                       const fault_spot *spot) {
    const lar_model *model = domain->model;
    double gravity[3], most;
    lar_gravity_at(model, &tools->settings, time, 0, gravity);
    most = weight * lar_length(gravity);
    for (int i = 0; i < model->load_count; i++) {
        const lar_nodal_load *load = &model->load[i];
        double force = factor_at(model, load->curve, time) * lar_length(load->force);
        for (int32_t n = 0; n < load->nodes.count && force > most; n++)
            if (edges_from(domain, load->nodes.node[n], spot) < PUSHING) most = force;
    }
    for (int i = 0; i < model->pressure_count; i++) {
        const lar_pressure_load *load = &model->pressure[i];
        double force = factor_at(model, load->curve, time) * fabs(load->pressure);
        force *= spot->edge * spot->edge;
        for (int32_t f = 0; f < load->count && force > most; f++) {
            const int32_t *nodes = model->mesh.element[load->face[f] / 6];
            lar_gid node = nodes[lar_face_node[load->face[f] % 6][0]];
            if (edges_from(domain, node, spot) < PUSHING) most = force;
        }
    }
    return most;
}

/* An element that has the node. */
static lar_gid element_of(const lar_mesh *mesh, lar_gid node) {
    for (lar_gid e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++)
            if (mesh->element[e][a] == node) return e;
    return 0;
}

static void find_spot(const lar_domain *domain, const lar_tools *tools, const lar_fault *fault,
                      bool of_element, fault_spot *spot) {
    const lar_mesh *mesh = &domain->model->mesh;
    lar_gid e = of_element ? fault->element : element_of(mesh, fault->element);
    const lar_material *material = lar_domain_material(domain, e);
    double time = (double)fault->step * domain->time_step;
    spot->edge = element_at_rest(domain, e, spot->rest);
    if (!of_element) memcpy(spot->rest, mesh->position[fault->element], sizeof spot->rest);
    double face = spot->edge * spot->edge;
    spot->firm = domain->factor[lar_factor_of(domain->model->element_material[e])] *
                 lar_material_instant_shear(material) * face;
    spot->loads = loads_at(domain, tools, time, material->density * face * spot->edge, spot);
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

/* Of a tool that moves nodes: from the nearest of them. */
static double moving_distance(const lar_model *model, int32_t tool, const double rest[3]) {
    double nearest = INFINITY, way[3];
    for (int i = 0; i < model->move_count; i++)
        for (int32_t k = 0; model->move[i].tool == tool + 1 && k < model->move[i].nodes.count;
             k++) {
            lar_minus(model->mesh.position[model->move[i].nodes.node[k]], rest, way);
            nearest = fmin(nearest, lar_length(way));
        }
    return nearest;
}

/* How far the nearest node with a force of an entry is, in edges; *node says which. */
static double push_distance(const lar_domain *domain, const lar_force_entry *entry,
                            const fault_spot *spot, lar_gid *node) {
    const lar_force_nodes on = lar_force_nodes_of(domain->model, entry);
    double nearest = INFINITY;
    for (int32_t n = 0; n < on.count; n++) {
        double distance = edges_from(domain, on.node[n], spot);
        if (!(distance < nearest)) continue;
        nearest = distance;
        *node = on.node[n];
    }
    return nearest;
}

/* Names the nearest force that is not small beside others there; returns how far it is, INFINITY:
 * there is none [m]. */
static double pushing_distance(const lar_domain *domain, const lar_tools *tools,
                               const fault_spot *spot, lar_fault *fault) {
    double nearest = PUSHING, most = spot->loads;
    lar_gid node = 0;
    for (int32_t i = 0; i < tools->forces.count; i++) {
        const lar_force_entry *entry = &tools->forces.entry[i];
        if (push_distance(domain, entry, spot, &node) < PUSHING)
            most = fmax(most, lar_length(entry->force));
    }
    const double least = fmax(BESIDE * most, STRAINS * spot->firm);
    for (int32_t i = 0; i < tools->forces.count; i++) {
        const lar_force_entry *entry = &tools->forces.entry[i];
        double distance = push_distance(domain, entry, spot, &node);
        if (!(lar_length(entry->force) >= least) || !(distance < nearest)) continue;
        nearest = distance;
        fault->tool = -1;
        fault->pushed = node;
        fault->force = lar_length(entry->force);
    }
    return fault->tool < 0 ? nearest * spot->edge : INFINITY;
}

/* Whether a tool may have had a part in it: some tool has touched the body, and where loads are
 * enough to break it, this one moves and presses or pulls hard beside them. */
static bool may_have_part(const lar_domain *domain, const lar_tools *tools, int32_t tool,
                          bool moving, const fault_spot *spot) {
    const lar_tool_follower *follower = &tools->follower[tool];
    const lar_tool_felt *felt = &follower->felt;
    const double steps = fmax(1, (double)felt->steps) * LAR_STEP_SHARES * domain->scale;
    double mean[3];
    for (int i = 0; i < 3; i++) mean[i] = (double)felt->force[i] / steps;
    double force =
        fmax(lar_length(mean), follower->load * domain->surroundings.list->limits[tool].force);
    bool touched = tools->division.untouched != 0 || felt->depth > 0 || force > 0;
    bool pressed = force >= BESIDE * spot->loads && follower->load < THROWN;
    return touched && (spot->loads < spot->firm || (moving && pressed));
}

void lar_fault_attribute(const lar_domain *domain, const lar_tools *tools, lar_fault *fault) {
    const lar_tool_faces *faces = &domain->surroundings.faces;
    const lar_tool_list *list = domain->surroundings.list;
    bool moves = fault->kind == LAR_FAULT_SPEED || fault->kind == LAR_FAULT_TOO_FAST;
    bool of_element = fault->kind == LAR_FAULT_ELEMENT || fault->kind == LAR_FAULT_ENERGY_GAIN;
    if (fault->attributed || !(moves || of_element)) return;
    fault->attributed = true;
    if (fault->element < 0) return;
    double closest = 1;
    fault_spot spot;
    find_spot(domain, tools, fault, of_element, &spot);
    const double force = pushing_distance(domain, tools, &spot, fault);
    if (fault->tool < 0) spot.loads = fmax(spot.loads, fault->force);
    if (faces->face_count == 0) return;
    for (int32_t t = 0; t < list->count; t++) {
        const lar_tool *tool = &list->tool[t];
        lar_tool_pose pose;
        double velocity[3];
        const lar_tool_motion *motion = &tools->motion[t];
        bool moving = motion->end > 0 && fault->step < motion->end + JUST;
        if (tool->shape == LAR_TOOL_NONE || lar_tool_motion_free(motion) ||
            !may_have_part(domain, tools, t, moving, &spot))
            continue;
        lar_tool_at(&tools->motion[t], fault->step, domain->time_step, &pose, velocity);
        double holding = holding_distance(domain, tools, t, spot.rest), touching = INFINITY;
        if (tool->shape == LAR_TOOL_RIGID)
            touching = moving_distance(domain->model, t, spot.rest);
        else if (tool->shape != LAR_TOOL_HAND)
            touching = touching_distance(tool, &pose, fault->place);
        if (!(fmin(holding, touching) < force)) continue;
        holding /= PULLING * spot.edge;
        touching /= (moving ? MOVING : TOUCHING) * spot.edge;
        if (!(fmin(holding, touching) < closest)) continue;
        closest = fmin(holding, touching);
        fault->tool = t + 1;
        fault->tool_pulls = holding < touching;
        fault->tool_speed = lar_length(velocity);
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
