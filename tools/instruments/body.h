/* A body that is tried: its surface and elements, and what can be seen of them from outside. */
#ifndef LAR_INSTRUMENTS_BODY_H
#define LAR_INSTRUMENTS_BODY_H

#include "lariat.h"

/* Holds no more of the model than pointers into it. */
typedef struct lar_body {
    int32_t nodes, elements;
    const double (*rest)[3]; /* places at rest [m] */
    const lar_model *model;
    lar_surface_info surface;
    double rest_lower[3], rest_upper[3]; /* its box at rest [m] */
    double diagonal;                     /* of its box at rest [m] */
    double (*u)[3], (*x)[3];             /* displacements and places, of the last look */
    double lower[3], upper[3];           /* its box then */
    double (*middle)[3]; /* of each face of the surface then, and how far its corners are */
    double *extent;
    double (*gradient)[8][3]; /* mean gradients of the shape functions, of each element [1/m] */
    double (*corner)[8];      /* its corners' Jacobians at rest */
    unsigned char *fixed;     /* of each node, not 0: some axis is held or moved */
} lar_body;

/* The simulation's element state at one moment. */
typedef struct lar_shape {
    double min_volume, min_corner; /* det F of the mean gradient; the worst corner's Jacobian as
                                          a part of that at rest */
    int32_t inverted, negative;    /* elements with det F <= 0, with a corner <= 0 */
} lar_shape;

/* Memory for a body at rest. The model must outlive it. */
lar_status lar_body_create(const lar_model *model, lar_body *body, lar_error *error);
void lar_body_clear(lar_body *body);

/* Takes the displacements over; NULL: at rest. */
void lar_body_look(lar_body *body, const lar_simulation *simulation);

/* Goes through all elements of the last look. */
lar_shape lar_body_shape(const lar_body *body);

/* How often the surface goes around a place: 1 inside, 0 outside. The sum of the solid angles of
 * its faces, each of four triangles around its middle. */
double lar_body_winding(const lar_body *body, const double place[3]);

/* The farthest displacement [m] from those before; NULL: from rest. */
double lar_body_farthest(const lar_body *body, const double (*before)[3]);

/* Middle and outward unit normal of a face, at the last look. */
void lar_body_face(const lar_body *body, int32_t face, double middle[3], double normal[3]);

/* The face without held nodes, and where there is one not near to any, that lies farthest along
 * `direction` at rest. */
int32_t lar_body_extreme(const lar_body *body, const double direction[3]);

/* How far a line from `place` along the unit vector goes until it leaves the body for good; 0 when
 * it does not meet it. */
double lar_body_beyond(const lar_body *body, const double place[3], const double direction[3]);

#endif
