/* Which face of a body counts for a node or point, of all that are near, with as few looks at the
 * others as will do: every group and face knows the travel until which nothing can come of it. */
#ifndef LAR_CONTACT_SURVEY_SURVEY_H
#define LAR_CONTACT_SURVEY_SURVEY_H

#include "contact/body_contact.h"
#include "mechanics/face_contact.h"

/* How much nearer a node and a face come when all nodes move by 1 along every axis. */
#define LAR_APPROACH 3.4641016151377546 /* 2 sqrt 3 */

/* Of the depth behind the faces of another body, that part is what others than the closest one may
 * be farther away and still count. */
#define LAR_FADE_BEHIND 0.02

/* What is known of a group's faces: distances of those that may matter, at least so much. */
typedef struct lar_survey {
    double x[3];   /* the node [m] */
    double reach;  /* of the faces for the node [m] */
    bool flush;    /* with the body: some of its faces are not seen */
    unsigned held; /* axes that the node is held along; 0 for other bodies than its own */
    double fade;   /* by how much others than the closest may be farther away and still count, at
                      most, [m] */
    double above;  /* the same before the faces [m] */
    int32_t count;
    int32_t entry[LAR_GROUP_FACES_MAX]; /* ascending */
    double distance[LAR_GROUP_FACES_MAX];
    double corner[LAR_GROUP_FACES_MAX][4][3];  /* [m] */
    lar_face_point point[LAR_GROUP_FACES_MAX]; /* where they are closest, of those near `min` */
    double min;                                /* of those within reach; INFINITY: none is */
    double gap;  /* by which those looked at are out of reach, at most 0 when one is not [m] */
    double next; /* travel at which the first of the others may matter [m] */
} lar_survey;

/* The face that counts of group g, and where; -1: none is within reach. Sets when it is due. */
int32_t lar_survey_closest(lar_body_contact *contact, const lar_state *state, int32_t g,
                           lar_survey *s, lar_face_point *point);

/* How far nodes may move against each other [m] until a node of another body that touches nothing,
 * before its closest face, is looked at again. */
double lar_survey_clear(const lar_body_contact *contact, int32_t g, const lar_survey *s,
                        const lar_face_point *point);

#endif
