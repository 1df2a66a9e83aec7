#include "study/frames/profiles.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/parallel_for.h"
#include "study/frames/edge.h"

/* ---- one frame ------------------------------------------------------------------------------- */

/* Of all frames at once; what threads write together is behind the lock. */
typedef struct work {
    lar_profiles *p;
    const volatile sig_atomic_t *stop;
    double *blur; /* [frames][points] of edges; 0: none */
    pthread_mutex_t lock;
    int32_t failed; /* the first frame with an error; beyond the last: none */
    lar_error error;
} work;

static bool stopped(const work *w) {
    return w->stop && *w->stop;
}

/* Both sides of the axis are one profile: their mean by variances. Where they differ by more than
 * chance has it, the axis is not where the view says, or the tissue is not round: then half of the
 * difference is the error. */
static void put_together(const lar_edge side[2], double scale, lar_profile_point *point,
                         double *blur) {
    static const double CHANCE = 3;
    double sum = 0, weights = 0;
    *point = (lar_profile_point){0};
    for (int i = 0; i < 2; i++) {
        if (!side[i].found) continue;
        double weight = 1 / (side[i].error * side[i].error);
        sum += weight * side[i].y;
        weights += weight;
        *blur = side[i].blur;
        point->clipped = point->clipped || side[i].clipped;
    }
    if (!(weights > 0)) return;
    point->z = scale * sum / weights;
    point->error = scale / sqrt(weights);
    /* Too much light moves both sides alike. */
    if (point->clipped) point->error = scale * fmax(side[0].error, side[1].error);
    double apart = fabs(side[0].y - side[1].y);
    if (side[0].found && side[1].found && apart > CHANCE * hypot(side[0].error, side[1].error))
        point->error = fmax(point->error, 0.5 * scale * apart);
}

static int find_points(const lar_view *v, const lar_grey *image, const lar_outline *outline,
                       lar_profile_point *point, double *blur) {
    int found = 0;
    for (int k = 0; k < v->points; k++) {
        const double x = v->radius / v->scale * k / (v->points - 1);
        lar_edge side[2] = {{0}, {0}};
        if (v->sides != LAR_VIEW_LEFT || k == 0)
            lar_edge_find(v, image, outline, v->tissue, x, &side[0]);
        if (v->sides != LAR_VIEW_RIGHT && k > 0)
            lar_edge_find(v, image, outline, v->tissue, -x, &side[1]);
        blur[k] = 0;
        put_together(side, v->scale, &point[k], &blur[k]);
        found += point[k].error > 0;
    }
    return found;
}

static lar_status read_frame(const lar_profiles *p, int32_t i, lar_grey *image, lar_error *error) {
    const char *path = p->frames.frame[i].path;
    lar_status status = lar_grey_read(path, p->view.gamma, image, error);
    if (status || (image->width == p->width && image->height == p->height)) return status;
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: frame %d has %d x %d pixels and the first one, %s, %d x %d; frames of one "
                    "film are alike",
                    path, (int)i + 1, image->width, image->height, p->frames.frame[0].path,
                    p->width, p->height);
}

static lar_status do_frame(work *w, int32_t i, lar_error *error) {
    lar_profiles *p = w->p;
    const lar_view *v = &p->view;
    lar_grey image = {0};
    lar_outline outline = {0};
    int found = 0;
    lar_status status = read_frame(p, i, &image, error);
    if (!status) status = lar_outline_find(v, &image, v->tissue, &outline, error);
    if (!status)
        found = find_points(v, &image, &outline, &p->point[(size_t)i * (size_t)v->points],
                            &w->blur[(size_t)i * (size_t)v->points]);
    if (!status && 2 * found < v->points)
        status =
            lar_fail(error, LAR_ERROR_MODEL,
                     "%s: in frame %d of %d an edge of %s tissue was found at %d of %d places; "
                     "look at rim_pixel, heights_mm and tissue in %s, or leave the frame out",
                     p->frames.frame[i].path, (int)i + 1, (int)p->frames.count,
                     v->tissue > 0 ? "bright" : "dark", found, v->points, p->view_path);
    lar_outline_clear(&outline);
    lar_grey_clear(&image);
    return status;
}

static void do_frames(void *context, int32_t first, int32_t end) {
    work *w = context;
    for (int32_t i = first; i < end && !stopped(w); i++) {
        lar_error error = {0};
        if (!do_frame(w, i, &error)) continue;
        pthread_mutex_lock(&w->lock);
        if (i < w->failed) {
            w->failed = i;
            w->error = error;
        }
        pthread_mutex_unlock(&w->lock);
    }
}

/* ---- all frames ------------------------------------------------------------------------------ */

static lar_status look_at_first(lar_profiles *p, lar_error *error) {
    lar_grey image = {0};
    const char *path = p->frames.frame[0].path;
    lar_status status = lar_grey_read(path, p->view.gamma, &image, error);
    if (!status) status = lar_view_check(&p->view, p->view_path, path, &image, error);
    p->width = image.width;
    p->height = image.height;
    lar_grey_clear(&image);
    return status;
}

/* Whether tissue is brighter or darker than what is behind it: by where the picture changes more,
 * in the first frame, one in the middle and the last. */
static lar_status look_at_tissue(lar_profiles *p, lar_error *error) {
    double change[2] = {0};
    lar_status status = LAR_OK;
    for (int i = 0; i < 3 && !status && p->view.tissue == 0; i++) {
        lar_grey image = {0};
        status = read_frame(p, (p->frames.count - 1) * i / 2, &image, error);
        for (int bright = 0; bright < 2 && !status; bright++) {
            lar_outline outline = {0};
            status = lar_outline_find(&p->view, &image, bright ? 1 : -1, &outline, error);
            change[bright] += outline.change;
            lar_outline_clear(&outline);
        }
        lar_grey_clear(&image);
    }
    if (p->view.tissue == 0) p->view.tissue = change[1] > change[0] ? 1 : -1;
    return status;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The middle one of those that are more than zero; sorts them. */
static double median(double *value, size_t count) {
    qsort(value, count, sizeof *value, ascending);
    size_t first = 0;
    while (first < count && !(value[first] > 0)) first++;
    return first < count ? value[first + (count - first) / 2] : 0;
}

static void count_up(lar_profiles *p, double *scratch) {
    const size_t all = (size_t)p->frames.count * (size_t)p->view.points;
    p->blur = median(scratch, all);
    for (size_t i = 0; i < all; i++) {
        scratch[i] = p->point[i].error;
        *(scratch[i] > 0 ? &p->found : &p->missed) += 1;
        p->clipped += p->point[i].clipped;
        p->worst = fmax(p->worst, scratch[i]);
    }
    p->error = median(scratch, all);
    for (int32_t i = 0; i < p->frames.count; i++) p->early += lar_profiles_time(p, i) < 0;
    p->lost = p->frames.frame[p->frames.count - 1].number + 1 - p->frames.count;
}

static lar_status do_all(lar_profiles *p, const volatile sig_atomic_t *stop, lar_error *error) {
    const size_t all = (size_t)p->frames.count * (size_t)p->view.points;
    work w = {.p = p, .stop = stop, .failed = p->frames.count};
    p->point = lar_calloc(all, sizeof *p->point);
    w.blur = lar_calloc(all, sizeof *w.blur);
    lar_status status = p->point && w.blur ? LAR_OK : lar_fail_memory(error, all, "profiles");
    if (!status) {
        pthread_mutex_init(&w.lock, NULL);
        lar_parallel_for(p->frames.count, 1, do_frames, &w);
        pthread_mutex_destroy(&w.lock);
    }
    if (!status && w.failed < p->frames.count)
        status = lar_fail(error, w.error.status, "%s", w.error.message);
    if (!status && stopped(&w))
        status = lar_fail(error, LAR_ERROR_IO, "interrupted before all frames were looked at");
    if (!status) count_up(p, w.blur);
    if (!status && p->early == p->frames.count)
        status = lar_fail(error, LAR_ERROR_MODEL,
                          "%s: all %d frames are before time 0; look at start_s and "
                          "frames_per_second in %s",
                          p->film, (int)p->frames.count, p->view_path);
    free(w.blur);
    return status;
}

lar_status lar_profiles_read(const char *film, const char *view_path,
                             const volatile sig_atomic_t *stop, lar_profiles *p, lar_error *error) {
    const double started = lar_clock_seconds();
    p->film = lar_strdup(film);
    p->view_path = lar_strdup(view_path);
    lar_status status = p->film && p->view_path ? LAR_OK : lar_fail_memory(error, 1, film);
    if (!status) status = lar_view_read(view_path, &p->view, error);
    if (!status) status = lar_frame_list_read(film, &p->frames, error);
    if (!status) status = look_at_first(p, error);
    if (!status) status = look_at_tissue(p, error);
    if (!status) status = do_all(p, stop, error);
    p->seconds = lar_clock_seconds() - started;
    return status;
}

void lar_profiles_clear(lar_profiles *p) {
    lar_frame_list_clear(&p->frames);
    free(p->film);
    free(p->view_path);
    free(p->point);
    *p = (lar_profiles){0};
}

double lar_profiles_time(const lar_profiles *p, int32_t frame) {
    static const double EXACT = 1e-9; /* s: sums that are to be 0 are not always */
    double time = p->view.start + (double)p->frames.frame[frame].number / p->view.rate;
    return fabs(time) < EXACT ? 0 : time;
}

double lar_profiles_radius(const lar_profiles *p, int point) {
    return p->view.radius * point / (p->view.points - 1);
}
