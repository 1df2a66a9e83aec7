/* Frames of tissue in a tube, seen from the side, become profiles z(r, t) (T 1.3.4).
 *
 *        picture, pixels           what is measured
 *     +------------------+
 *     |   |  light   |   |            z ^
 *     |   |   ____   |   |              |  .-'''-.          image.h    pixels
 *     |   | .'    '. |   |              |.'       '.        view.h     where the tube is
 *     |   |/ tissue \|   |   rim  ------+-----------> r     outline.h  about where the edge is
 *     |---+----o-----+---|              |                   edge.h     where it is, and how well
 *     +--------|---------+             axis                 profiles.h all frames, the table
 *              axis, rim
 *
 * In the tube's frame x goes from the axis to the right and y along the axis out of the tissue,
 * both in pixels; the tube may lean in the picture. A profile is read at some distances from the
 * axis on both sides, which are put together.
 *
 * What a camera sees from the side is the outline: a bump, but no dimple. Lens and glass are not
 * thought of: a scale that is the same all over the picture is taken as given.
 */
#ifndef LAR_STUDY_FRAMES_VIEW_H
#define LAR_STUDY_FRAMES_VIEW_H

#include <stdbool.h>

#include "base/error.h"
#include "study/frames/image.h"

enum { LAR_VIEW_POINTS_MAX = 200 };

typedef enum lar_view_sides { LAR_VIEW_BOTH, LAR_VIEW_LEFT, LAR_VIEW_RIGHT } lar_view_sides;

typedef struct lar_view {
    double scale;     /* metres of a pixel */
    double axis, rim; /* pixels from the left and the top, 0 in the middle of the first: where the
                         axis meets the plane of the rim */
    double turn;      /* of the axis, from straight up to the right [rad] */
    double radius;    /* profiles are read from the axis to here [m] */
    double low, high; /* heights that are looked at [m]; not finite: all that is in the picture */
    int points;       /* of a profile */
    double rate;      /* frames a second */
    double start;     /* time of the first frame [s] */
    double gamma;     /* of the picture's numbers */
    int tissue;       /* 1 brighter than what is behind it, -1 darker, 0 as the frames show it */
    lar_view_sides sides;
} lar_view;

/* Reads the file of a view, docs/formats.md. */
lar_status lar_view_read(const char *path, lar_view *view, lar_error *error);

/* Whether the tube lies in a picture of that size; else a sentence with the file and the view. */
lar_status lar_view_check(const lar_view *view, const char *view_path, const char *frame,
                          const lar_grey *image, lar_error *error);

/* Of the tube's frame in the picture. */
void lar_view_to_picture(const lar_view *view, double x, double y, double *column, double *row);

#endif
