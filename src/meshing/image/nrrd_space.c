/* Where the voxels of an NRRD file are. */
#include <math.h>
#include <string.h>

#include "meshing/image/nrrd.h"

/* How a file's world becomes ours (right, anterior, superior). */
typedef struct space_kind {
    const char *name, *short_name;
    double sign[2]; /* of x and y; z is superior in all of them */
} space_kind;

static const space_kind SPACES[] = {{"right-anterior-superior", "RAS", {1, 1}},
                                    {"left-anterior-superior", "LAS", {-1, 1}},
                                    {"left-posterior-superior", "LPS", {-1, -1}},
                                    /* without anatomy: taken as it is */
                                    {"scanner-xyz", "scanner-xyz", {1, 1}},
                                    {"3D-right-handed", "3D-right-handed", {1, 1}}};
enum { SPACE_KINDS = sizeof SPACES / sizeof SPACES[0] };

static lar_status set_signs(const lar_nrrd_header *header, double sign[2], lar_error *error) {
    const lar_nrrd_value *space = &header->field[LAR_NRRD_SPACE];
    sign[0] = sign[1] = 1;
    int64_t dimension = 3;
    lar_status status = lar_nrrd_whole(header, LAR_NRRD_SPACE_DIMENSION, 3, &dimension, error);
    if (status) return status;
    if (dimension != 3)
        return lar_nrrd_bad(header, LAR_NRRD_SPACE_DIMENSION,
                            "is not 3; write the image as one volume in space", error);
    if (!space->text.at) return LAR_OK;
    for (int s = 0; s < SPACE_KINDS; s++) {
        if (!lar_span_equal_nocase(space->text, SPACES[s].name) &&
            !lar_span_equal_nocase(space->text, SPACES[s].short_name))
            continue;
        memcpy(sign, SPACES[s].sign, sizeof SPACES[s].sign);
        return LAR_OK;
    }
    return lar_nrrd_bad(header, LAR_NRRD_SPACE,
                        "is none that says where right, front and head are in three axes; write "
                        "the image with space left-posterior-superior",
                        error);
}

/* ---- lists ---------------------------------------------------------------------------------- */

/* "(a,b,c)". */
static bool take_vector(lar_text *text, double vector[3]) {
    if (!lar_text_skip_space(text) || *text->at != '(') return false;
    const char *start = text->at + 1;
    const char *stop = memchr(start, ')', (size_t)(text->end - start));
    if (!stop) return false;
    text->at = stop + 1;
    lar_span rest = {start, (size_t)(stop - start)}, number;
    for (int c = 0; c < 3; c++) {
        bool more = lar_span_split(rest, ',', &number, &rest);
        if (more != (c < 2) || !lar_span_double(lar_span_trim(number), &vector[c])) return false;
    }
    return true;
}

static lar_text text_of(const lar_nrrd_value *value) {
    if (!value->text.at) return (lar_text){0};
    return (lar_text){value->text.at, value->text.at + value->text.length, value->line};
}

/* A direction per axis; false in `is_space` where it is "none". */
static lar_status read_directions(const lar_nrrd_header *header, int axes, double direction[][3],
                                  bool *is_space, lar_error *error) {
    lar_text text = text_of(&header->field[LAR_NRRD_SPACE_DIRECTIONS]);
    lar_span word;
    for (int a = 0; a < axes; a++) {
        lar_text before = text;
        if (lar_text_word(&before, &word) && lar_span_equal_nocase(word, "none")) {
            text = before;
            is_space[a] = false;
        } else if (!take_vector(&text, direction[a])) {
            return lar_nrrd_bad(header, LAR_NRRD_SPACE_DIRECTIONS,
                                "is not a vector \"(x,y,z)\" or \"none\" for each axis; correct it",
                                error);
        }
    }
    if (lar_text_skip_space(&text))
        return lar_nrrd_bad(header, LAR_NRRD_SPACE_DIRECTIONS,
                            "has more than one entry for each "
                            "axis; correct it",
                            error);
    return LAR_OK;
}

/* Along axis a of the file only, a space axis each, in their order. */
static lar_status read_spacings(const lar_nrrd_header *header, int axes, double direction[][3],
                                const bool *is_space, lar_error *error) {
    lar_text text = text_of(&header->field[LAR_NRRD_SPACINGS]);
    for (int a = 0, c = 0; a < axes; a++) {
        double spacing;
        if (!lar_text_double(&text, &spacing))
            return lar_nrrd_bad(header, LAR_NRRD_SPACINGS,
                                "has no number for each axis; correct it", error);
        if (!is_space[a]) continue;
        if (!isfinite(spacing) || spacing <= 0)
            return lar_nrrd_bad(header, LAR_NRRD_SPACINGS,
                                "are not all larger than 0; write the image again with its voxel "
                                "sizes",
                                error);
        if (c < 3) direction[a][c++] = spacing;
    }
    return LAR_OK;
}

/* Without a space, where the axes begin: at the first voxel's middle where samples are called
 * nodes, else at its face. An axis that says "nan" begins with its first voxel's middle at 0. */
static lar_status read_minima(const lar_nrrd_header *header, int axes, const double direction[][3],
                              const bool *is_space, double origin[3], lar_error *error) {
    lar_text text = text_of(&header->field[LAR_NRRD_AXIS_MINS]);
    lar_text centers = text_of(&header->field[LAR_NRRD_CENTERS]);
    for (int a = 0, c = 0; text.at && a < axes; a++) {
        double min;
        lar_span center = {0};
        bool node =
            centers.at && lar_text_word(&centers, &center) && lar_span_equal_nocase(center, "node");
        if (!lar_text_double(&text, &min) || isinf(min))
            return lar_nrrd_bad(header, LAR_NRRD_AXIS_MINS,
                                "has no number for each axis; correct it", error);
        if (!is_space[a] || c == 3) continue;
        if (!isnan(min)) origin[c] = min + (node ? 0 : 0.5 * direction[a][c]);
        c++;
    }
    return LAR_OK;
}

/* All units named must be the same; none: millimetres, what nearly all files mean. */
static lar_status read_unit(const lar_nrrd_header *header, lar_nrrd_field field, double *metres,
                            lar_error *error) {
    static const struct {
        const char *name;
        double metres;
    } UNITS[] = {{"mm", 1e-3},
                 {"millimeter", 1e-3},
                 {"millimeters", 1e-3},
                 {"millimetre", 1e-3},
                 {"cm", 1e-2},
                 {"centimeter", 1e-2},
                 {"m", 1},
                 {"meter", 1},
                 {"metre", 1},
                 {"um", 1e-6},
                 {"\xc2\xb5m", 1e-6},
                 {"micron", 1e-6},
                 {"microns", 1e-6},
                 {"micrometer", 1e-6},
                 {"nm", 1e-9}};
    *metres = 0;
    lar_text text = text_of(&header->field[field]);
    lar_span word;
    while (text.at && lar_text_word(&text, &word)) {
        while (word.length > 0 && word.at[0] == '"') word.at++, word.length--;
        while (word.length > 0 && word.at[word.length - 1] == '"') word.length--;
        if (word.length == 0 || lar_span_equal(word, "???") || lar_span_equal(word, "none"))
            continue;
        double found = 0;
        for (size_t u = 0; u < sizeof UNITS / sizeof UNITS[0]; u++)
            if (lar_span_equal(word, UNITS[u].name)) found = UNITS[u].metres;
        if (found == 0)
            return lar_nrrd_bad(header, field, "is no unit of length; write mm, cm, m or um",
                                error);
        if (*metres != 0 && found != *metres)
            return lar_nrrd_bad(header, field, "are different units; write the same for all axes",
                                error);
        *metres = found;
    }
    if (*metres == 0) *metres = 1e-3;
    return LAR_OK;
}

/* Where nothing else says which axes are in space: their kinds. */
static void read_kinds(const lar_nrrd_header *header, int axes, bool *is_space) {
    lar_text text = text_of(&header->field[LAR_NRRD_KINDS]);
    lar_span word;
    for (int a = 0; a < axes && text.at && lar_text_word(&text, &word); a++)
        is_space[a] = lar_span_equal_nocase(word, "domain") ||
                      lar_span_equal_nocase(word, "space") || lar_span_equal(word, "???") ||
                      lar_span_equal_nocase(word, "none");
}

/* ---- axes ----------------------------------------------------------------------------------- */

static lar_status read_sizes(const lar_nrrd_header *header, int *axes, int64_t *size,
                             lar_error *error) {
    int64_t dimension = 3;
    if (!header->field[LAR_NRRD_DIMENSION].text.at)
        return lar_nrrd_missing(header, LAR_NRRD_DIMENSION, error);
    if (!header->field[LAR_NRRD_SIZES].text.at)
        return lar_nrrd_missing(header, LAR_NRRD_SIZES, error);
    lar_status status = lar_nrrd_whole(header, LAR_NRRD_DIMENSION, 0, &dimension, error);
    if (status) return status;
    if (dimension < 3 || dimension > LAR_NRRD_AXES_MAX)
        return lar_nrrd_bad(header, LAR_NRRD_DIMENSION,
                            "is not 3; write the one volume that holds the labels", error);
    *axes = (int)dimension;
    lar_text text = text_of(&header->field[LAR_NRRD_SIZES]);
    bool good = true;
    for (int a = 0; a < *axes; a++) good = good && lar_text_int64(&text, &size[a]) && size[a] > 0;
    if (!good || lar_text_skip_space(&text))
        return lar_nrrd_bad(header, LAR_NRRD_SIZES,
                            "are not as many numbers of voxels, each from 1 on, as the dimension "
                            "says; correct it",
                            error);
    return LAR_OK;
}

/* Finds the three axes in space. A fourth one, of segments that overlap or of time, may only have
 * one entry. */
static lar_status choose_axes(const lar_nrrd_header *header, int axes, const int64_t *size,
                              const bool *is_space, int chosen[3], lar_error *error) {
    int count = 0, odd = -1;
    for (int a = 0; a < axes; a++) {
        if (is_space[a]) {
            if (count < 3) chosen[count] = a;
            count++;
        } else {
            odd = a;
        }
    }
    if (count != 3)
        return lar_nrrd_bad(header, LAR_NRRD_SIZES,
                            "has not exactly three axes in space; write the one volume that holds "
                            "the labels",
                            error);
    if (odd >= 0 && size[odd] != 1 && header->segment_count > 0)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: the segments overlap and lie in %lld layers (axis %d); export them "
                        "as a label map, or save segments that do not overlap into files of their "
                        "own",
                        header->path, (long long)size[odd], odd);
    if (odd >= 0 && size[odd] != 1)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: the image has 4 axes, with %lld values for each voxel along axis %d; "
                        "write the one volume that holds the labels",
                        header->path, (long long)size[odd], odd);
    return LAR_OK;
}

lar_status lar_nrrd_geometry(const lar_nrrd_header *header, int64_t size[3], lar_image *image,
                             lar_error *error) {
    int axes = 0, chosen[3] = {0};
    int64_t all[LAR_NRRD_AXES_MAX];
    double direction[LAR_NRRD_AXES_MAX][3] = {{0}}, origin[3] = {0}, sign[2], metres = 1e-3;
    bool is_space[LAR_NRRD_AXES_MAX] = {true, true, true, true};
    bool directed = header->field[LAR_NRRD_SPACE_DIRECTIONS].text.at != NULL;
    lar_status status = read_sizes(header, &axes, all, error);
    if (!status) status = set_signs(header, sign, error);
    if (status) return status;
    if (directed)
        status = read_directions(header, axes, direction, is_space, error);
    else
        read_kinds(header, axes, is_space);
    if (!status) status = choose_axes(header, axes, all, is_space, chosen, error);
    if (!status && !directed && !header->field[LAR_NRRD_SPACINGS].text.at)
        status = lar_fail(error, LAR_ERROR_FORMAT,
                          "%s: neither \"space directions\" nor \"spacings\" say how large voxels "
                          "are; write the image again with them",
                          header->path);
    if (!status && !directed) status = read_spacings(header, axes, direction, is_space, error);
    if (!status && !directed && !header->field[LAR_NRRD_SPACE_ORIGIN].text.at)
        status = read_minima(header, axes, (const double(*)[3])direction, is_space, origin, error);
    if (!status)
        status =
            read_unit(header, directed ? LAR_NRRD_SPACE_UNITS : LAR_NRRD_UNITS, &metres, error);
    if (status) return status;
    if (header->field[LAR_NRRD_SPACE_ORIGIN].text.at) {
        lar_text text = text_of(&header->field[LAR_NRRD_SPACE_ORIGIN]);
        if (!take_vector(&text, origin) || lar_text_skip_space(&text))
            return lar_nrrd_bad(header, LAR_NRRD_SPACE_ORIGIN,
                                "is no vector \"(x,y,z)\"; correct it", error);
    }
    for (int a = 0; a < 3; a++) size[a] = all[chosen[a]];
    for (int c = 0; c < 3; c++) {
        double factor = c < 2 ? sign[c] * metres : metres;
        for (int a = 0; a < 3; a++) image->to_world[c][a] = factor * direction[chosen[a]][c] + 0.0;
        image->to_world[c][3] = factor * origin[c];
    }
    return LAR_OK;
}
