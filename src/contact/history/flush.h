/* Blocks that stand on each other, side over side or nearly so, at rest.
 *
 *          |      |            A node on the edge of the upper block that sinks in goes down along
 *          |      |            the other's side, which would be the closest face, at distance 0 or
 *     -----o------o            nearly: nothing would push it up. As long as a node has not parted
 *          |      |            from the block that it is flush with, it does not see those of its
 *          |      |            faces that its own body's faces go on in, or go on a little within
 *                              and turned, and stands on what is left. So it is with one that
 *                              begins straight before the block, or comes there again.
 *
 * However sharp the edge is: where one body is cut at an angle of 60 degrees the other has 120.
 *
 * Points of edges are flush as the nodes are of which they are made. What becomes of it in a run is
 * in body_contact.h, offsets.
 */
#ifndef LAR_CONTACT_HISTORY_FLUSH_H
#define LAR_CONTACT_HISTORY_FLUSH_H

#include "contact/contact_surface.h"
#include "mechanics/face_contact.h"

/* Who is nearer to a body than this part of a face has not parted from it. */
#define LAR_FLUSH_NEAR 0.05

/* Finds what is flush: sets surface->flush. The list is that of a search at rest; what is no
 * farther from a plane than `rounding` [m] is in it. */
lar_status lar_flush_find(lar_contact_surface *surface, const lar_contact_list *list,
                          double rounding, lar_error *error);

/* The bodies that a node or point is flush with, one after the other: *at from 0 and *body from -1
 * on. False: there is none left. */
bool lar_flush_next_body(const lar_contact_surface *surface, int32_t node, int32_t *at,
                         int32_t *body);

/* Whether it is flush with a body. */
bool lar_flush_at_rest(const lar_contact_surface *surface, int32_t node, int32_t body);

/* Whether a face is one that it does not see as long as it is flush. */
bool lar_flush_hides(const lar_contact_surface *surface, int32_t node, int32_t face);

/* The same for one face of a body after the other, ascending: *next is surface->flush_first[node]
 * before the first one. */
bool lar_flush_hides_next(const lar_contact_surface *surface, int32_t node, int32_t face,
                          int32_t *next);

/* Who slides off what it is flush with, past an edge of that where only hidden faces go on. There
 * it stands on the plane of the last face, less and less: the closest point stays on the edge, and
 * would hold it back like a nail. */
typedef struct lar_rim {
    double way[3];   /* past the edge, in that plane [m] */
    double away[3];  /* from the closest point of the face [m] */
    double shift[4]; /* of the corners' weights from that to the foot of the node on the plane */
    double lasts;    /* how far past the edge there is something left [m] */
    double part;     /* of that, from 0 to 1 */
} lar_rim;

/* Most nodes are: nothing is to be asked of them. */
static inline bool lar_flush_is_straight(const lar_face_point *closest) {
    static const double STRAIGHT = 1 - 1e-14; /* square of a cosine */
    const double height = closest->height, distance = closest->distance;
    return height * height >= STRAIGHT * (distance * distance);
}

/* Who is farther from the face's plane to the side than behind it. */
static inline bool lar_flush_is_beside(const lar_face_point *closest) {
    static const double STRAIGHT = 0.7; /* 45 degrees */
    return closest->height < 0 && -closest->height < STRAIGHT * closest->distance;
}

/* The unit normal of a triangle of a face; 0 where that is crushed to a line. */
void lar_rim_normal(const double corner[4][3], int triangle, double normal[3]);

/* Fills rim->away, way and shift for a node at x, which `closest` of a face is seen from. False:
 * the triangle is crushed to a line. */
bool lar_rim_foot(const double x[3], const double corner[4][3], const lar_face_point *closest,
                  lar_rim *rim);

/* What has to be added to the weights of a point of a triangle to move it by `way` in its plane.
 * False: as above. */
bool lar_rim_shift(const double corner[4][3], int triangle, const double way[3], double shift[4]);

/* Whether two faces of a body have a corner in common. */
bool lar_rim_meets(const lar_contact_surface *surface, int32_t one, int32_t other);

/* The forces on a face's corners of what changes by `pull` per metre past its edge [N]. */
void lar_rim_forces(const lar_rim *rim, const lar_face_point *closest, double pull,
                    double on[4][3]);

/* False: the node at x, which `closest` of a face is seen from, is not past an edge. */
bool lar_flush_past(const lar_contact_surface *surface, int32_t node, int32_t face,
                    const double x[3], const double corner[4][3], const lar_face_point *closest,
                    lar_rim *rim);

/* What is left there of a force that stores `energy` [J]. Sets the slope's forces on the corners
 * [N]; the node gets minus their sum. */
double lar_flush_left(const lar_rim *rim, const lar_face_point *closest, double energy,
                      double on[4][3]);

#endif
