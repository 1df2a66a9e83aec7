/* The guard: what keeps an element from turning a corner inside out.
 *
 *      3                 The mean gradient, which is all that the law sees, may be sound while a
 * node |   j = det[e1 e2 e3] / the same at rest      is pushed through its element: hourglass
 * control e3 | / e2            is a weak spring, and knows no end. So every corner has an energy of
 * its own
 *      |/                as soon as the volume that its three edges span falls below START of that
 *      a----- e1         at rest, x = j / START < 1:
 *
 *     w = kappa V/8 START^2 (1/x + x - 2)/2,   dw/dj = -kappa V/8 START/2 (1/x^2 - 1)
 *
 * a barrier as in incremental potential contact (Li and others 2020), with a rational function that
 * needs no library and has the second derivative kappa V/8 / x^3. Below x = MIN it goes on as a
 * parabola: a corner that is inside out all the same is pushed back as well (invertible elements:
 * Irving, Teran, Fedkiw 2004). Above START it is zero, exactly; a body whose corners keep START of
 * their volume has the same bits with and without it.
 *
 * A corner that is pressed together is damped as well, by the barrier's stiffness times a lead in
 * time as in contact (mechanics/contact.h): without that corners rattle. One that opens may have
 * another lead, for a barrier that was met too late has more to give back than it took. The barrier
 * never pulls.
 *
 * kappa is a part of the modulus of the pressure wave, so that a barrier at work is not faster than
 * the element itself by more than its 1/x^3; divided steps (contact/tool_body.h) take that.
 */
#ifndef LAR_MECHANICS_HEX8_GUARD_H
#define LAR_MECHANICS_HEX8_GUARD_H

#include <math.h>
#include <stdbool.h>

#include "base/vector.h"
#include "mechanics/hex8.h"
#include "mechanics/hex8_block.h"

#define LAR_GUARD_START 0.3

typedef struct lar_guard {
    double min;       /* the least j of the corners */
    double energy;    /* [J] */
    double stiffness; /* the largest eigenvalue of its second derivative is not above this [N/m] */
    double slope[8];  /* dw/dj of each corner [J] */
    double damper[8]; /* the same of what damps [J] */
    double opening[8][4]; /* how fast j grows with the corner and with its neighbours [1/s]: where
                             velocities are known, of corners with a barrier that damps */
} lar_guard;

/* Looks at an element with corners `rest` and `now` [m]. */
void lar_hex8_guard(const double rest[8][3], const double now[8][3], const lar_material *material,
                    lar_guard *guard);

/* How many seconds times the barrier's stiffness damp a corner. */
typedef struct lar_guard_lead {
    double closing, opening; /* [s] */
} lar_guard_lead;

enum { LAR_ALL_CORNERS = 255 };

/* The same of those corners that have a bit in `corners`: the others are known to be sound. And
 * adds the barrier's forces dw/dx [N] to `force` (may be NULL), for corners with the velocities `v`
 * [m/s]. */
void lar_hex8_guard_force(const double rest[8][3], const double now[8][3], const double v[8][3],
                          const lar_material *material, lar_guard_lead lead, unsigned corners,
                          double force[8][3], lar_guard *guard);

/* The power [W] that such dampers take at these velocities. */
double lar_hex8_guard_power(const double rest[8][3], const double now[8][3], const double v[8][3],
                            const double damper[8]);

/* The sum of the squares of the hourglass forces c_m |q_m| [N^2] up to which the gradient in every
 * corner is the mean one but for a matrix of norm 1: so much of it is what corners may be off, in
 * proportion to its root. */
double lar_hex8_corner_limit(const lar_hex8 *element, const double rest[8][3]);

/* No corner's edges span more than that at rest, however it is rounded [m^3]. */
double lar_hex8_largest_corner(const double rest[8][3]);

/* The |cof F|^2 from which on an element is looked at more closely: LAR_STRAINED_AREA, and less for
 * a flat one. */
double lar_hex8_area_limit(const lar_hex8 *element);

/* While its corners go no farther than lar_hex8_steady_way [m] an element's lar_hex8_areas do not
 * become more than that many times as large. `longest`: the square of its longest edge. */
#define LAR_HEX8_STEADY 1.26
double lar_hex8_steady_way(double areas, double longest);

/* What the stiffness of a strained element is made of [Pa]. */
typedef struct lar_hex8_stiff {
    double square;         /* (det F)^2; 0 where the gradient is turned over */
    double slope, pressed; /* of the volume term: what goes with its areas, and what does not */
    double shear, further; /* of shear likewise */
    double of_volume, of_shear; /* how much stiffer both are at once, in parts */
    double fibres;              /* what they have become stiffer */
    double whole;               /* all of it at rest */
    bool fibrous;
} lar_hex8_stiff;

/* What of it is the material's alone. */
void lar_hex8_stiff_begin(const lar_material *material, lar_hex8_stiff *stiff);

/* What fibres have become stiffer than where tension begins [Pa]. */
double lar_hex8_fibre_growth(const lar_fibre *fibre, const float strain[LAR_STRAIN_NUMBERS]);

/* Then, for any number of its elements, what comes with `strain`: what a monitor says
 * (hex8_block.h), of the mean gradient. */
static inline void lar_hex8_stiff_of(const lar_material *material,
                                     const float strain[LAR_STRAIN_NUMBERS],
                                     lar_hex8_stiff *stiff) {
    double J = strain[LAR_STRAIN_VOLUME];
    stiff->square = 0;
    if (!(J > 0)) return;
    lar_law_strained now = lar_law_table[material->law].strained(
        material->parameter, J, strain[LAR_STRAIN_LENGTH], strain[LAR_STRAIN_AREA]);
    stiff->square = J * J;
    stiff->slope = lar_greater(0, now.slope);
    stiff->pressed = fabs(now.pressure) * sqrt(strain[LAR_STRAIN_LENGTH] / 3.0);
    stiff->shear = now.shear;
    stiff->further = now.further;
    if (stiff->fibrous)
        stiff->fibres = stiff->of_shear * lar_hex8_fibre_growth(&material->fibre, strain);
}

/* How the square of such an element's highest frequency has grown with its strain, barrier apart:
 * the volume term goes with the squares of its areas and the law's own slope, shear with |F^-1|^2.
 * `area`: what lar_hex8_areas has become, in parts of that at rest; |cof F|^2 / 3 for one that is
 * as long as wide. Infinite where the gradient is turned over. */
static inline double lar_hex8_growth(const lar_hex8_stiff *stiff, double area) {
    if (!(stiff->square > 0)) return INFINITY;
    double volume = stiff->slope * area + stiff->pressed;
    double shear = stiff->shear * lar_greater(1, area / stiff->square) + stiff->further;
    double growth = (stiff->of_volume * volume + stiff->of_shear * shear) / stiff->whole;
    if (!stiff->fibrous) return growth;
    /* Along any direction the element is as stiff as `whole`, and fibres at rest count beside. */
    return lar_greater(1, growth) + stiff->fibres / stiff->whole;
}

/* How stiff a family of an element's fibres may be before it is listed [Pa]. */
double lar_fibre_limit(const lar_material *material);

#endif
