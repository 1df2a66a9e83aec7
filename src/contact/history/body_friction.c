#include "contact/history/body_friction.h"

#include <stdlib.h>

#include "base/vector.h"

/* ---- memory ---------------------------------------------------------------------------------- */

lar_status lar_body_friction_create(const lar_contact_surface *surface, lar_body_contact *contact,
                                    lar_error *error) {
    if (!surface->rough) return LAR_OK;
    size_t nodes = (size_t)surface->node_count;
    lar_body_friction *friction = contact->friction = lar_calloc(1, sizeof *friction);
    if (friction) {
        friction->note = lar_calloc(nodes, sizeof *friction->note);
        friction->touched = lar_calloc(nodes, sizeof *friction->touched);
        friction->active = lar_calloc(nodes, sizeof *friction->active);
    }
    if (friction && friction->note && friction->touched && friction->active) return LAR_OK;
    lar_body_friction_destroy(contact);
    return lar_fail_memory(error, nodes * sizeof *friction->note, "friction of bodies");
}

void lar_body_friction_destroy(lar_body_contact *contact) {
    lar_body_friction *friction = contact->friction;
    if (!friction) return;
    free(friction->note);
    free(friction->touched);
    free(friction->active);
    free(friction);
    contact->friction = NULL;
}

/* ---- the face as it goes on to the node ------------------------------------------------------ */

/* How a flat face carries a point beside it along, by the velocities of its corners. */
typedef struct carrier {
    double weight[4];  /* of the corners, sum 1, */
    double normal[3];  /* and with the distance from the face, how it tilts: */
    double tilt[2][3]; /* by the velocities of its diagonals along the normal */
    double row;        /* how hard a force on the point is for the corners, at least 1 */
} carrier;

/* False: the point is too far from the face, or the face has no area. */
static bool carry(const double x[3], const double corner[4][3], const double closest[4],
                  carrier *c) {
    static const double BESIDE = 0.5, TILT = 2; /* of the diagonals */
    double diagonal[2][3], dual[2][3], way[3], length;
    lar_face_normal(corner, c->normal);
    length = lar_length(c->normal);
    if (!(length > 0)) return false;
    lar_face_mean(corner, closest, way);
    length = 1 / length;
    for (int i = 0; i < 3; i++) {
        c->normal[i] *= length;
        way[i] = x[i] - way[i];
        diagonal[0][i] = (corner[2][i] - corner[0][i]) * length;
        diagonal[1][i] = (corner[3][i] - corner[1][i]) * length;
    }
    lar_cross(diagonal[1], c->normal, dual[0]);
    lar_cross(c->normal, diagonal[0], dual[1]);
    double above = lar_dot(way, c->normal), most = 0;
    for (int d = 0; d < 2; d++) most += lar_dot(dual[d], dual[d]);
    most = fabs(above) * sqrt(2 * most); /* no less than both together */
    if (!(most <= TILT)) return false;
    c->row = 2 * most;
    for (int d = 0; d < 2; d++) {
        double beside = lar_dot(way, dual[d]);
        if (!(fabs(beside) <= BESIDE)) return false;
        c->weight[d] = closest[d] - beside;
        c->weight[d + 2] = closest[d + 2] + beside;
        c->row += fabs(c->weight[d]) + fabs(c->weight[d + 2]);
        for (int i = 0; i < 3; i++) c->tilt[d][i] = above * dual[d][i];
    }
    return true;
}

/* Velocity of the point relative to the face, along the surface across `way`. */
static void slide(const carrier *c, const double v[3], const double speed[4][3],
                  const double way[3], double out[3]) {
    double mean[3];
    lar_face_mean(speed, c->weight, mean);
    for (int i = 0; i < 3; i++) out[i] = v[i] - mean[i];
    for (int d = 0; d < 2; d++) {
        double tilts = 0;
        for (int i = 0; i < 3; i++) tilts += c->normal[i] * (speed[d + 2][i] - speed[d][i]);
        for (int i = 0; i < 3; i++) out[i] += c->tilt[d][i] * tilts;
    }
    double through = lar_dot(out, way);
    for (int i = 0; i < 3; i++) out[i] -= way[i] * through;
}

/* What the corners get when the point gets `force`: the transpose of the velocities. */
static void spread(const carrier *c, const double force[3], double on[4][3]) {
    for (int d = 0; d < 2; d++) {
        double tilts = lar_dot(c->tilt[d], force);
        for (int i = 0; i < 3; i++) {
            on[d][i] -= c->weight[d] * force[i] + tilts * c->normal[i];
            on[d + 2][i] -= c->weight[d + 2] * force[i] - tilts * c->normal[i];
        }
    }
}

/* ---- one push -------------------------------------------------------------------------------- */

static const double *stick_of(const lar_body_contact *contact, const lar_state *state,
                              int32_t node) {
    const lar_contact_view *view = &contact->view;
    return view->stick ? view->stick[view->slot[node]]
                       : lar_stick_of(contact->surface, state, node);
}

/* Where the slip of a node that had `stick` is now, after it went on by `moved`. One that has taken
 * hold just now has come from somewhere else. */
static void go_on(const double *stick, const double way[3], const double moved[3], double slip[3]) {
    double through = lar_dot(stick, way);
    for (int i = 0; i < 3; i++) slip[i] = stick[i] - way[i] * through + moved[i];
}

/* Notes a push for a node: `limit` is the slip within its cone; `slip` NULL: it does not hold on to
 * the body. */
static void note(lar_body_friction *friction, int32_t node, int32_t body, double press,
                 double limit, const double *slip) {
    lar_rub_note *n = &friction->note[node];
    if (!(n->hardest > 0)) {
        *n = (lar_rub_note){.leading = body};
        friction->touched[friction->touched_count++] = node;
    }
    if (press > n->hardest) {
        n->hardest = press;
        n->leading = body;
    }
    if (!slip) return;
    if (limit > n->limit) n->limit = limit;
    if (!(press > n->same)) return;
    n->same = press;
    memcpy(n->slip, slip, sizeof n->slip);
}

bool lar_body_friction_rub(lar_body_contact *contact, const lar_state *state, const lar_rub *rub,
                           double on[4][3]) {
    const lar_contact_surface *surface = contact->surface;
    const lar_contact_face *face = &surface->face[rub->face];
    double most = lar_contact_friction(surface, &surface->node[rub->node], face) * rub->press;
    double moved[3], slip[3] = {0}, share = 0;
    carrier c;
    if (!(most > 0)) return false;
    if (!carry(rub->x, rub->corner, rub->weight, &c)) return false;
    slide(&c, rub->v, rub->speed, rub->way, moved);
    double stiffness = contact->law.stiffness * rub->mass / c.row;
    const double lead = contact->law.lead / contact->time_step;
    for (int i = 0; i < 3; i++) moved[i] *= contact->time_step;

    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(surface, rub->node, parent, weight);
    for (int k = 0; k < count; k++) {
        const double *stick = stick_of(contact, state, parent[k]);
        bool holds = stick[3] == face->body + 1;
        double own[3];
        if (holds) go_on(stick, rub->way, moved, own);
        if (!contact->keeps || contact->keeps[parent[k]])
            note(contact->friction, parent[k], face->body, weight[k] * rub->press, most / stiffness,
                 holds ? own : NULL);
        if (!holds && stick[3] != 0) continue; /* it rubs on another body */
        share += weight[k];
        for (int i = 0; i < 3; i++) slip[i] += weight[k] * ((holds ? own[i] : 0) + lead * moved[i]);
    }
    double wanted = stiffness * lar_length(slip), max = share * most;
    if (!(wanted > 0)) return false;
    double part = wanted > max ? max / wanted : 1;
    for (int i = 0; i < 3; i++) slip[i] *= -part * stiffness;
    spread(&c, slip, on);
    return true;
}

/* ---- from step to step ----------------------------------------------------------------------- */

void lar_body_friction_begin(lar_body_friction *friction) {
    for (int32_t i = 0; i < friction->touched_count; i++)
        friction->note[friction->touched[i]].hardest = 0;
    friction->touched_count = 0;
}

static void take_on(const lar_rub_note *note, double *stick) {
    if (!(note->same > 0) || note->hardest > 2 * note->same) {
        memset(stick, 0, 3 * sizeof *stick);
        stick[3] = note->leading + 1;
        return;
    }
    double size = lar_length(note->slip), part = size > note->limit ? note->limit / size : 1;
    for (int i = 0; i < 3; i++) stick[i] = part * note->slip[i];
}

static void let_go(const lar_body_contact *contact, lar_state *state, int32_t node) {
    if (contact->keeps && !contact->keeps[node]) return;
    if (contact->friction->note[node].hardest > 0) return;
    memset(lar_stick_of(contact->surface, state, node), 0, LAR_STICK_VALUES * sizeof(double));
}

void lar_body_friction_keep(lar_body_contact *contact, lar_state *state) {
    lar_body_friction *friction = contact->friction;
    for (int32_t i = 0; i < friction->active_count && friction->known; i++)
        let_go(contact, state, friction->active[i]);
    for (int32_t n = 0; n < contact->surface->node_count && !friction->known; n++)
        let_go(contact, state, n);
    for (int32_t i = 0; i < friction->touched_count; i++) {
        int32_t node = friction->active[i] = friction->touched[i];
        take_on(&friction->note[node], lar_stick_of(contact->surface, state, node));
    }
    friction->active_count = friction->touched_count;
    friction->known = true;
}
