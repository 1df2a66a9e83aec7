/* Profiles of all frames of a film, and the table that aspiration reads (study/inverse/measured.h).
 */
#ifndef LAR_STUDY_FRAMES_PROFILES_H
#define LAR_STUDY_FRAMES_PROFILES_H

#include <signal.h>

#include "study/frames/list.h"
#include "study/frames/view.h"

typedef struct lar_profile_point {
    double z, error; /* height and its standard deviation [m]; error 0: no edge was found there */
    bool clipped;    /* the picture is black or white in full there */
} lar_profile_point;

typedef struct lar_profiles {
    char *film, *view_path;
    lar_view view; /* with tissue 1 or -1 */
    lar_frame_list frames;
    lar_profile_point *point; /* [frames][view.points] */
    int width, height;        /* of the frames */
    int32_t found, missed;    /* points of all frames */
    int32_t clipped;          /* of those found, beside too much black or white in full */
    int32_t early;            /* frames before time 0, which the table leaves out */
    int64_t lost;             /* numbers without a frame */
    double error, worst,
        blur; /* of points, median and largest [m]; blur of edges, median [pixels] */
    double seconds;
} lar_profiles;

/* Reads view and frames and finds all profiles, on all cores. `stop` may be NULL; once it is not 0
 * no further frame is looked at, and that is an error. The caller clears in any case. */
lar_status lar_profiles_read(const char *film, const char *view_path,
                             const volatile sig_atomic_t *stop, lar_profiles *profiles,
                             lar_error *error);
void lar_profiles_clear(lar_profiles *profiles); /* idempotent */

double lar_profiles_time(const lar_profiles *profiles, int32_t frame);
double lar_profiles_radius(const lar_profiles *profiles, int point);

/* The table, in metres and seconds; and a picture of the curves. */
lar_status lar_profiles_write(const lar_profiles *profiles, const char *path, lar_error *error);
lar_status lar_profiles_draw(const lar_profiles *profiles, const char *path, lar_error *error);

#endif
