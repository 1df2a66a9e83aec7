#include "study/frames/view.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/scene/scene.h"

static const double MM = 1e-3;

typedef struct key {
    const char *name, *example;
    double low, high; /* of what makes sense */
    bool must;
} key;

/* ---- keys ------------------------------------------------------------------------------------ */

static lar_status read_number(const lar_scene *s, const key *k, double *value) {
    const lar_yaml *node = lar_yaml_get(s->root, k->name);
    char expected[128];
    if (!node && !k->must) return LAR_OK;
    lar_status status = lar_scene_need(s, s->root, "a view", k->name, k->example, &node);
    if (status) return status;
    snprintf(expected, sizeof expected, "a number, for example %s",
             k->example + strlen(k->name) + 2);
    status = lar_scene_number(s, node, expected, value);
    if (status || (*value >= k->low && *value <= k->high)) return status;
    return lar_scene_fail(s, node, LAR_ERROR_MODEL, "%s: %g lies outside of %g to %g", k->name,
                          *value, k->low, k->high);
}

static lar_status read_word(const lar_scene *s, const char *name, const char *const *word,
                            int count, int *which) {
    const lar_yaml *node = lar_yaml_get(s->root, name);
    if (!node) return LAR_OK;
    for (*which = 0; *which < count; (*which)++)
        if (lar_scene_is_word(node, word[*which])) return LAR_OK;
    return lar_scene_unknown(s, node, LAR_ERROR_FORMAT, name, "there are", word, count);
}

static lar_status read_heights(const lar_scene *s, lar_view *v) {
    const lar_yaml *node = lar_yaml_get(s->root, "heights_mm");
    double low, high;
    v->low = -INFINITY;
    v->high = INFINITY;
    if (!node) return LAR_OK;
    if (node->kind != LAR_YAML_LIST || node->count != 2)
        return lar_scene_fail(s, node, LAR_ERROR_FORMAT,
                              "heights_mm: expected two numbers, for example [-0.5, 6]");
    lar_status status = lar_scene_number(s, node->first, "a number in mm", &low);
    if (!status) status = lar_scene_number(s, node->first->next, "a number in mm", &high);
    if (!status && !(low < high))
        status =
            lar_scene_fail(s, node, LAR_ERROR_MODEL,
                           "heights_mm: %g is not below %g; give the lower one first", low, high);
    if (status) return status;
    v->low = low * MM;
    v->high = high * MM;
    return LAR_OK;
}

static lar_status read_numbers(const lar_scene *s, lar_view *v) {
    double scale = 0, radius = 0, turn = 0;
    const struct {
        key key;
        double *value;
    } number[] = {
        {{"mm_per_pixel", "mm_per_pixel: 0.02", 1e-5, 10, true}, &scale},
        {{"axis_pixel", "axis_pixel: 320", -1e5, 1e5, true}, &v->axis},
        {{"rim_pixel", "rim_pixel: 400", -1e5, 1e5, true}, &v->rim},
        {{"radius_mm", "radius_mm: 4.5", 1e-3, 1e3, true}, &radius},
        {{"turn_degrees", "turn_degrees: 1.5", -180, 180, false}, &turn},
        {{"frames_per_second", "frames_per_second: 25", 1e-6, 1e6, false}, &v->rate},
        {{"start_s", "start_s: -0.2", -1e6, 1e6, false}, &v->start},
        {{"gamma", "gamma: 2.2", 0.1, 10, false}, &v->gamma},
    };
    lar_status status = LAR_OK;
    for (size_t i = 0; i < sizeof number / sizeof number[0] && !status; i++)
        status = read_number(s, &number[i].key, number[i].value);
    v->scale = scale * MM;
    v->radius = radius * MM;
    v->turn = turn * acos(-1.0) / 180;
    return status;
}

static lar_status read_root(const lar_scene *s, lar_view *v) {
    static const char *const keys[] = {"lariat-view",
                                       "mm_per_pixel",
                                       "axis_pixel",
                                       "rim_pixel",
                                       "turn_degrees",
                                       "radius_mm",
                                       "heights_mm",
                                       "points",
                                       "frames_per_second",
                                       "start_s",
                                       "gamma",
                                       "tissue",
                                       "sides",
                                       NULL};
    static const char *const shade[] = {"dark", "bright"}, *const side[] = {"both", "left",
                                                                            "right"};
    const lar_yaml *version, *points = lar_yaml_get(s->root, "points");
    int64_t number;
    lar_status status = lar_scene_keys(s, s->root, "a view", keys);
    if (!status)
        status = lar_scene_need(s, s->root, "a view", "lariat-view", "lariat-view: 1", &version);
    if (status) return status;
    if (!lar_scene_is_integer(version, &number) || number != 1)
        return lar_scene_fail(s, version, LAR_ERROR_UNSUPPORTED,
                              "lariat-view: expected 1, the version that this program reads");
    *v = (lar_view){.points = 10, .rate = 25, .gamma = 1};
    status = read_numbers(s, v);
    if (!status) status = read_heights(s, v);
    if (!status && points) {
        status = lar_scene_integer(s, points, "an integer, for example 10", &number);
        if (!status && (number < 2 || number > LAR_VIEW_POINTS_MAX))
            status = lar_scene_fail(s, points, LAR_ERROR_MODEL,
                                    "points: a profile has from 2 to %d", LAR_VIEW_POINTS_MAX);
        v->points = status ? 0 : (int)number;
    }
    int which = -1, sides = 0;
    if (!status) status = read_word(s, "tissue", shade, 2, &which);
    if (!status) status = read_word(s, "sides", side, 3, &sides);
    v->tissue = which < 0 ? 0 : which ? 1 : -1;
    v->sides = (lar_view_sides)sides;
    return status;
}

lar_status lar_view_read(const char *path, lar_view *view, lar_error *error) {
    lar_bytes bytes;
    lar_yaml_tree tree;
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    status = lar_yaml_parse(path, &bytes, &tree, error);
    lar_bytes_free(&bytes);
    if (status) return status;
    const lar_scene scene = {.path = path, .root = tree.root, .error = error};
    status = read_root(&scene, view);
    lar_yaml_clear(&tree);
    return status;
}

/* ---- the picture ----------------------------------------------------------------------------- */

void lar_view_to_picture(const lar_view *v, double x, double y, double *column, double *row) {
    *column = v->axis + x * cos(v->turn) + y * sin(v->turn);
    *row = v->rim + x * sin(v->turn) - y * cos(v->turn);
}

lar_status lar_view_check(const lar_view *v, const char *view_path, const char *frame,
                          const lar_grey *image, lar_error *error) {
    static const double FINEST = 4; /* pixels from the axis to the last point */
    const double reach = v->radius / v->scale;
    double column[2], row[2];
    const double left = v->sides == LAR_VIEW_RIGHT ? 0 : -reach,
                 right = v->sides == LAR_VIEW_LEFT ? 0 : reach;
    lar_view_to_picture(v, left, 0, &column[0], &row[0]);
    lar_view_to_picture(v, right, 0, &column[1], &row[1]);
    for (int i = 0; i < 2; i++)
        if (!(column[i] >= 0 && column[i] <= image->width - 1 && row[i] >= 0 &&
              row[i] <= image->height - 1))
            return lar_fail(
                error, LAR_ERROR_MODEL,
                "%s: the tube lies out of the picture, %d x %d pixels: its rim goes "
                "from pixel (%.0f, %.0f) to (%.0f, %.0f); look at axis_pixel, rim_pixel, "
                "mm_per_pixel and radius_mm in %s",
                frame, image->width, image->height, column[0], row[0], column[1], row[1],
                view_path);
    if (reach < FINEST)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: %g mm are %.2g pixels of %g mm, too few for a profile; look at "
                        "mm_per_pixel and radius_mm in %s",
                        frame, v->radius / MM, reach, v->scale / MM, view_path);
    return LAR_OK;
}
