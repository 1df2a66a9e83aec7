/* Contact: how hard two things that are in each other's way push apart (T 2.2.8).
 *
 *        outside        F = k (d + lead d')   while d > 0 and F > 0, along the normal
 *     ----- x -----     d   immersion of the point below the surface [m]
 *           | d         d'  its rate, from the velocities half a step back [m/s]
 *           o
 *     inside            k = beta m / dt^2,    lead = dt
 *
 * "The repelling force is limited for the step size" (T figure 2.7): k is measured by the mass m
 * that it moves. With lead = dt the force follows the immersion that the point will have a step
 * later, so a point that is about to leave is not pushed any more; that, not a rule of its own, is
 * what keeps the spring from giving back more than it took. Derivation and proof of the bounds:
 * docs/theory.md, contact. Friction is no spring (lar_friction_part).
 */
#ifndef LAR_MECHANICS_CONTACT_H
#define LAR_MECHANICS_CONTACT_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

typedef struct lar_contact_law {
    double stiffness; /* k per mass moved [1/s^2] */
    double lead;      /* [s] */
} lar_contact_law;

/* For a time step and the stable step of the elements [s]. Three kinds of springs of this law may
 * meet at a node (body, tool, grasp) as long as the stiffness of each kind is at most
 * law.stiffness times the node's mass (row sums: of k w_a over all springs of the kind, w_a being
 * the node's share of a spring's end). */
lar_contact_law lar_contact_law_for(double time_step, double stable_step);

/* The law of tools: 4.7 times as stiff and less damped, for a hand feels how soft it is, and what a
 * tool's spring gives back is work of whoever moves the tool. It takes the part of the step that
 * bodies need as well: where a tool is, no other body is. */
lar_contact_law lar_contact_tool_law_for(double time_step, double stable_step);

/* The same on free bodies, whose elements do not strain and take nothing of a step. */
static inline lar_contact_law lar_contact_free_law_for(double time_step) {
    return lar_contact_tool_law_for(time_step, INFINITY);
}

/* How stiff springs should be beside tissue, per mass and stable step of its own elements; they are
 * in series with its layers. `confined`: lar_material_confined, by which the stable step knows
 * tissue as stiffer than it is when it is pressed. */
double lar_contact_wanted(double confined);

/* Where only the state at rest counts: bodies' springs come out four times as stiff as a layer that
 * gives way by its pressure wave's modulus, as one does that walls confine. */
#define LAR_CONTACT_WANTED_AT_REST 2.5

/* The longest step, in stable steps of those elements, at which springs are at least so stiff. */
double lar_contact_longest(double wanted);

/* The force [N], at least 0, on a point that moves so much mass [kg]. */
static inline double lar_contact_force(const lar_contact_law *law, double mass, double depth,
                                       double rate) {
    double ahead = depth + law->lead * rate;
    return depth > 0 && ahead > 0 ? law->stiffness * mass * ahead : 0;
}
/* Of a spring on a sharp edge, pressed in by `depth`, and what it stores [J]: it acts later, and is
 * the harder for it until, at `full`, it has stored as much as others. */
double lar_contact_late_force(const lar_contact_law *law, double mass, double full, double depth,
                              double rate, double *stored);

/* Deep in another body springs of the law of bodies, whose lead is the step, are harder, without a
 * jump: they push with k e^2 / (2 w) more, where e = d - deep + dt d' is above 0. Both lengths are
 * parts of a layer of elements [m]; dt is `part`, of the step. As undivided steps have no room for
 * that, it is no steeper than parts bear. It goes no farther than at a layer, and is gone at two:
 * who is as deep as that has come another way. Adds what is stored to *stored [J]. */
double lar_contact_deep_force(const lar_contact_law *law, double part, double mass, double layer,
                              double depth, double rate, double *stored);

/* What that takes of a step, (omega dt / 2)^2 beside what the law's springs take, at a depth. */
double lar_contact_deep_need(const lar_contact_law *law, double layer, double depth);

/* What part of its force pushes what goes out of another body, `rate` [m/s] below zero: all of it
 * up to a third of the thinner layer deep, and the less the deeper and faster, from two thirds on
 * nothing at a layer in thirty steps. What comes to be so deep where nothing pushed it, past
 * an edge, or through a thin body as it bends, would be thrown out with what pushing it in would
 * have taken. */
double lar_contact_let_go(const lar_contact_law *law, double layer, double depth, double rate);

/* Coulomb's law within one step: the part of the velocity along the surface, which a node would
 * have half a step later, that friction takes when it may take `max` of it. All of it is stick
 * (Carpenter, Taylor and Katona 1991: the force that the step needs, cut off at the cone).
 * `square`: of that velocity; `both`: its product with that half a step earlier, against what the
 * node rubs on. Where the forces have turned the node round within the step friction takes no more
 * than what keeps the mean of both velocities from turning too: beyond that it would give energy
 * (docs/theory.md, friction). Of a node that sticks `both` is rounding, and does not count. */
static const double LAR_FRICTION_NONE = 1e-12;
static inline double lar_friction_part(double max, double square, double both) {
    double part = max * max < square ? max / sqrt(square) : 1;
    if (!(both < -LAR_FRICTION_NONE * square)) return part;
    double left = 1 + both / square;
    return left < part ? left > 0 ? left : 0 : part;
}

/* The mass that a force between two points moves. */
static inline double lar_contact_pair_mass(double a, double b) {
    return a * b / (a + b);
}

/* ---- points of a face ------------------------------------------------------------------------
 * A face is the bilinear surface through its corners, counter-clockwise seen from outside, with
 * coordinates r, s from -1 to 1. */

/* Shares of the corners in a point, sum 1. */
void lar_face_weights(double r, double s, double weight[4]);

/* sum of weight[a] x[a]: a position, or a velocity. */
static inline void lar_face_mean(const double x[4][3], const double weight[4], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = (weight[0] * x[0][i] + weight[1] * x[1][i]) +
                 (weight[2] * x[2][i] + weight[3] * x[3][i]);
}

/* Outward normal in the middle: the cross product of the diagonals, twice the area where the face
 * is flat, not of unit length. */
void lar_face_normal(const double x[4][3], double normal[3]);

/* From 0 to 1, without a slope at either end; 0 before, 1 behind. */
static inline double lar_ease(double t) {
    return !(t > 0) ? 0 : t < 1 ? t * t * (3 - 2 * t) : 1;
}

/* A number at a point of a face, by the point's weights, from those at its corners, and change[]:
 * numbers at the corners and, last, in the middle that, linear in the triangles, have the same
 * slope there. Along a side it depends on that side's ends alone, and across the side it has no
 * slope: where two faces meet a spring is not driven from one to the other. Along the lines of
 * bilinear coordinates, that is: of faces that are no parallelograms a part of the kink is left. */
double lar_face_eased(const double weight[4], const double corner[4], double change[5]);

/* What part of a spring there is at a point of a face, from `blunt` at its corners to 1 in its
 * middle; the rest as above. */
double lar_face_firmness(const double weight[4], const double blunt[4], double change[5]);

/* ---- tools -----------------------------------------------------------------------------------
 * A tool is made of segments with a radius; a sphere's ends are one point. */

typedef struct lar_segment {
    double end[2][3];
} lar_segment;

/* A sphere's. */
static inline bool lar_segment_is_point(const lar_segment *segment) {
    return memcmp(segment->end[0], segment->end[1], sizeof segment->end[0]) == 0;
}

/* What many points need of a segment. */
typedef struct lar_segment_axis {
    double way[3], square; /* from its first end to the second [m], and its length squared */
} lar_segment_axis;

static inline lar_segment_axis lar_segment_axis_of(const lar_segment *segment) {
    lar_segment_axis axis = {.square = 0};
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        axis.way[i] = segment->end[1][i] - segment->end[0][i];
        axis.square += axis.way[i] * axis.way[i];
    }
    return axis;
}

/* The way from the closest point of a segment to a point [m], and where on the segment that is (0
 * to 1). Returns its length squared. */
static inline double lar_segment_away(const lar_segment *segment, const lar_segment_axis *axis,
                                      const double point[3], double away[3], double *along) {
    double from[3], dot = 0, square = 0;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        from[i] = point[i] - segment->end[0][i];
        dot += axis->way[i] * from[i];
    }
    double t = dot > 0 ? dot < axis->square ? dot / axis->square : 1 : 0;
    if (!(axis->square > 0)) t = 0;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        away[i] = from[i] - t * axis->way[i];
        square += away[i] * away[i];
    }
    *along = t;
    return square;
}

/* How deep a point is inside the tool around a segment [m] (negative: how far outside), the unit
 * normal from the segment to the point, and where on the segment (0 to 1) it starts. A point on the
 * segment itself has no normal, and counts as outside. */
double lar_segment_depth(const lar_segment *segment, double radius, const double point[3],
                         double normal[3], double *along);

/* sin and cos of an angle of at most 2 in size, by operations whose last bit is the same
 * everywhere. */
void lar_sine_cosine(double angle, double *sine, double *cosine);

#endif
