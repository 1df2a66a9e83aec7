#include "mechanics/contact.h"

#include <math.h>
#include <stdbool.h>

/* Where three kinds of springs of this law still leave a step of 0.8 of the stable one stable:
 * elements take 4 s^2 of the 4 that central differences allow, and a spring whose damper looks at
 * the last half step counts three times (docs/theory.md). Close to the stable limit there is no
 * room at all, and the softest springs are kept: what they take is hidden in the difference between
 * the elements' bound and the fastest mode of a body. */
static const double STIFFEST = 4.0 / 9, SOFTEST = 0.04;

static double body_share(double time_step, double stable_step) {
    double s = time_step / stable_step;
    return STIFFEST * (1 - s * s);
}

lar_contact_law lar_contact_law_for(double time_step, double stable_step) {
    double beta = fmax(body_share(time_step, stable_step), SOFTEST);
    return (lar_contact_law){.stiffness = beta / (time_step * time_step), .lead = time_step};
}

double lar_contact_wanted(double confined) {
    static const double ENOUGH = 2; /* K = 22 G at 0.8 of the stable step */
    return ENOUGH / confined;
}

/* Of a step. Tools that are harder stir tissue that lies still (engine/tool_contact), and what of
 * bodies overlaps in a longer step is more, however hard the springs (engine/slices). */
static const double ENOUGH_SHARE = 0.25;

double lar_contact_longest(double wanted) {
    double square = STIFFEST / (wanted + STIFFEST); /* beta(s) / s^2 falls with s */
    return sqrt(fmin(square, ENOUGH_SHARE / wanted));
}

/* Of the 4 (1 - s^2) that elements leave, grasps take a sixth, and tools all the rest: beta
 * (1 + 2 lead). So much of it is the damper's that a hand does not feel the spring tremble. */
lar_contact_law lar_contact_tool_law_for(double time_step, double stable_step) {
    static const double REST = 10.0 / 3, LEAD = 0.3, SOFTEST_TOOL = 0.12;
    double times = 2.25 * REST / (1 + 2 * LEAD); /* as stiff as bodies */
    double share = fmin(body_share(time_step, stable_step), ENOUGH_SHARE);
    double beta = fmax(times * share, SOFTEST_TOOL);
    return (lar_contact_law){.stiffness = beta / (time_step * time_step), .lead = LEAD * time_step};
}

double lar_contact_late_force(const lar_contact_law *law, double mass, double full, double depth,
                              double rate, double *stored) {
    static const double LATE = 0.1; /* of `full` */
    double steep = 1 / (1 - LATE), late = (depth - LATE * full) * steep;
    bool is_full = depth >= full;
    double force =
        lar_contact_force(law, mass, is_full ? depth : late, is_full ? rate : steep * rate);
    *stored = 0.5 * (is_full ? depth : late) * force;
    return is_full ? force : steep * force;
}

/* Of a layer. Organs that press on each other by their weight are not that deep, and their steps
 * are not divided for it. At a depth of a layer springs push with twelve times their force, for
 * which steps of four parts have room. */
static const double DEEP = 1.0 / 3, HARDENS = 0.02;

/* How much a depth more takes of a step [1/m]. */
static double deep_rate(const lar_contact_law *law, double layer) {
    return law->stiffness * law->lead * law->lead / (STIFFEST * HARDENS * layer);
}

double lar_contact_deep_need(const lar_contact_law *law, double layer, double depth) {
    return fmax(0, depth - DEEP * layer) * deep_rate(law, layer);
}

double lar_contact_deep_force(const lar_contact_law *law, double part, double mass, double layer,
                              double depth, double rate, double *stored) {
    static const double ELEMENTS = 0.9; /* of what a step has room for they may take that */
    const double end = (1 - DEEP) * layer, left = fmin(1, 2 - depth / layer);
    double deep = fmin(depth - DEEP * layer, end), ahead = fmin(deep + part * rate, end);
    double parts = law->lead / part;
    if (!(deep > 0 && ahead > 0 && left > 0)) return 0;
    double steepest = ELEMENTS * (parts * parts - 1) / deep_rate(law, layer);
    double curved = fmin(deep, steepest), soft = fmin(ahead, steepest);
    double stiffness = left * law->stiffness * mass / (2 * HARDENS * layer);
    *stored += stiffness * (deep * curved * (deep - curved) + curved * curved * curved / 3);
    return stiffness * soft * (2 * ahead - soft);
}

double lar_contact_let_go(const lar_contact_law *law, double layer, double depth, double rate) {
    static const double ENDS = 2.0 / 3, LEADS = 100; /* thirty steps */
    const double slow = fmax(0, 1 + rate * LEADS * law->lead / layer);
    if (!(rate < 0 && depth > DEEP * layer)) return 1;
    return 1 - lar_ease((depth / layer - DEEP) / (ENDS - DEEP)) * (1 - slow);
}

void lar_face_weights(double r, double s, double weight[4]) {
    weight[0] = 0.25 * (1 - r) * (1 - s);
    weight[1] = 0.25 * (1 + r) * (1 - s);
    weight[2] = 0.25 * (1 + r) * (1 + s);
    weight[3] = 0.25 * (1 - r) * (1 + s);
}

void lar_face_normal(const double x[4][3], double normal[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] =
            (x[2][j] - x[0][j]) * (x[3][k] - x[1][k]) - (x[2][k] - x[0][k]) * (x[3][j] - x[1][j]);
    }
}

/* From 0 to 1, without a slope at either end. */
static double ease(double t, double *slope) {
    *slope = 6 * t * (1 - t);
    return t * t * (3 - 2 * t);
}

/* A place in a face by its bilinear coordinates. */
typedef struct face_place {
    double at[2], eased[2], steep[2];
} face_place;

static face_place place_of(double x, double y) {
    face_place p = {.at = {x, y}};
    for (int d = 0; d < 2; d++) p.eased[d] = ease(p.at[d], &p.steep[d]);
    return p;
}

/* Bilinear in coordinates that are eased, and what it changes along these. */
static double between_corners(const face_place *p, const double corner[4], double along[2]) {
    double low = corner[1] - corner[0], high = corner[2] - corner[3];
    along[1] = (corner[3] - corner[0]) + p->eased[0] * (high - low);
    along[0] = low + p->eased[1] * (high - low);
    return corner[0] + p->eased[0] * low + p->eased[1] * along[1];
}

static void change_along(const double slope[2], double change[5]) {
    change[0] = 0;
    change[1] = slope[0];
    change[2] = slope[0] + slope[1];
    change[3] = slope[1];
    change[4] = 0.5 * (slope[0] + slope[1]);
}

double lar_face_eased(const double weight[4], const double corner[4], double change[5]) {
    /* Who slides off has a point past the side. */
    const face_place p =
        place_of(fmin(fmax(weight[1] + weight[2], 0), 1), fmin(fmax(weight[2] + weight[3], 0), 1));
    double along[2], value = between_corners(&p, corner, along);
    change_along((double[]){p.steep[0] * along[0], p.steep[1] * along[1]}, change);
    return value;
}

/* And a hill in the middle that ends on the sides without a slope. */
double lar_face_firmness(const double weight[4], const double blunt[4], double change[5]) {
    const face_place p = place_of(weight[1] + weight[2], weight[2] + weight[3]);
    double hill[2], rise[2], along[2], base = between_corners(&p, blunt, along);
    for (int d = 0; d < 2; d++) {
        bool over = p.at[d] > 0.5;
        hill[d] = ease(over ? 2 * (1 - p.at[d]) : 2 * p.at[d], &rise[d]);
        rise[d] *= over ? -2 : 2;
    }
    double top = hill[0] * hill[1];
    double slope[2] = {(1 - top) * p.steep[0] * along[0] + (1 - base) * rise[0] * hill[1],
                       (1 - top) * p.steep[1] * along[1] + (1 - base) * hill[0] * rise[1]};
    change_along(slope, change);
    return base + (1 - base) * top;
}

double lar_segment_depth(const lar_segment *segment, double radius, const double point[3],
                         double normal[3], double *along) {
    const lar_segment_axis axis = lar_segment_axis_of(segment);
    double distance = sqrt(lar_segment_away(segment, &axis, point, normal, along));
    if (!(distance > 0)) return -radius;
    for (int i = 0; i < 3; i++) normal[i] /= distance;
    return radius - distance;
}

/* Series for an eighth of the angle, then doubled three times: 1 - cos is carried along, so that
 * nothing cancels. */
void lar_sine_cosine(double angle, double *sine, double *cosine) {
    double x = angle / 8, y = x * x;
    double s = x * (1 - y / 6 * (1 - y / 20 * (1 - y / 42 * (1 - y / 72 * (1 - y / 110)))));
    double versine =
        y / 2 * (1 - y / 12 * (1 - y / 30 * (1 - y / 56 * (1 - y / 90 * (1 - y / 132)))));
    for (int i = 0; i < 3; i++) {
        double c = 1 - versine;
        versine = 2 * s * s;
        s = 2 * s * c;
    }
    *sine = s;
    *cosine = 1 - versine;
}
