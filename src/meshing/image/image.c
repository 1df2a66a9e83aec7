#include "meshing/image/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "meshing/image/parts.h"

typedef lar_status parser(const char *, const lar_bytes *, lar_image *, lar_error *);

static const struct {
    const char *ending;
    parser *parse;
} READERS[] = {{".nii", lar_nifti_parse},
               {".nii.gz", lar_nifti_parse},
               {".nrrd", lar_nrrd_parse},
               {".nhdr", lar_nrrd_parse}};
enum { READER_COUNT = sizeof READERS / sizeof READERS[0] };

static bool ends_with(const char *path, const char *ending) {
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

static int reader_of(const char *path) {
    int r = 0;
    while (r < READER_COUNT && !ends_with(path, READERS[r].ending)) r++;
    return r;
}

const char *lar_image_ending(const char *path) {
    int reader = reader_of(path);
    return reader < READER_COUNT ? READERS[reader].ending : NULL;
}

lar_status lar_image_read(const char *path, lar_image *image, lar_error *error) {
    *image = (lar_image){0};
    if (ends_with(path, ".hdr") || ends_with(path, ".img") || ends_with(path, ".img.gz"))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: images in two files (.hdr and .img) are not read; write it as one, "
                        ".nii or .nii.gz",
                        path);
    int reader = reader_of(path);
    if (reader == READER_COUNT)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: label images are read from .nii, .nii.gz, .nrrd and .nhdr; convert it",
                        path);
    lar_bytes bytes;
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    status = READERS[reader].parse(path, &bytes, image, error);
    lar_bytes_free(&bytes);
    if (status) lar_image_clear(image);
    return status;
}

void lar_image_clear(lar_image *image) {
    for (int32_t n = 0; n < image->name_count; n++) free(image->name[n].name);
    free(image->name);
    free(image->label);
    free(image->source);
    *image = (lar_image){0};
}

/* ---- the public calls ------------------------------------------------------------------------ */

lar_status lar_image_open(const char *path, lar_image **out, lar_error *error) {
    if (!path || !*path || !out)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_image_open needs the path of a label image and a place for it");
    lar_image *image = lar_calloc(1, sizeof *image);
    if (!image) return lar_fail_memory(error, sizeof *image, "a label image");
    lar_status status = lar_image_read(path, image, error);
    if (status)
        free(image);
    else
        *out = image;
    return status;
}

/* Names from the caller, through the same sieve as those of files. */
static lar_status take_names(const lar_image_info *from, const char *const *name,
                             const int32_t *named, lar_image *image, lar_error *error) {
    if (from->names <= 0) return LAR_OK;
    lar_image_entry *entry = lar_calloc((size_t)from->names, sizeof *entry);
    lar_status status = LAR_OK;
    if (!entry) return lar_fail_memory(error, (size_t)from->names * sizeof *entry, "names");
    for (int32_t n = 0; n < from->names && !status; n++) {
        if (!name || !named || !name[n] || !*name[n] || named[n] < 0 ||
            named[n] > LAR_IMAGE_LABEL_MAX)
            status = lar_fail(error, LAR_ERROR_ARGUMENT,
                              "name %d of the image (from 0) is empty or NULL, or its label is not "
                              "between 0 and %d",
                              (int)n, LAR_IMAGE_LABEL_MAX);
        else
            entry[n] = (lar_image_entry){named[n], (size_t)n + 1, {name[n], strlen(name[n])}};
    }
    if (!status) status = lar_image_add_names(image, entry, (size_t)from->names, error);
    free(entry);
    return status;
}

static lar_status check_size(const lar_image_info *from, lar_error *error) {
    int64_t voxels = 1;
    for (int a = 0; a < 3; a++) {
        if (from->size[a] < 1 || from->size[a] > LAR_IMAGE_SIDE_MAX ||
            (voxels *= from->size[a]) > LAR_IMAGE_VOXELS_MAX)
            return lar_fail(
                error, LAR_ERROR_ARGUMENT,
                "an image of %d x %d x %d voxels: 1 to %d along each axis and %d in all "
                "can be; crop it",
                (int)from->size[0], (int)from->size[1], (int)from->size[2], LAR_IMAGE_SIDE_MAX,
                LAR_IMAGE_VOXELS_MAX);
    }
    return LAR_OK;
}

lar_status lar_image_create(const lar_image_info *from, const char *const *name,
                            const int32_t *named, lar_image **out, lar_error *error) {
    if (!from || !from->label || !out)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_image_create needs sizes and labels and a place for the image");
    lar_status status = check_size(from, error);
    if (status) return status;
    const size_t voxels = (size_t)from->size[0] * (size_t)from->size[1] * (size_t)from->size[2];
    lar_image *image = lar_calloc(1, sizeof *image);
    if (!image) return lar_fail_memory(error, sizeof *image, "a label image");
    memcpy(image->size, from->size, sizeof image->size);
    memcpy(image->to_world, from->to_world, sizeof image->to_world);
    image->source = lar_strdup("image");
    image->label = lar_calloc(voxels, sizeof *image->label);
    if (!image->source || !image->label)
        status = lar_fail_memory(error, voxels * sizeof *image->label, "a label image");
    else
        memcpy(image->label, from->label, voxels * sizeof *image->label);
    if (!status) status = lar_image_check_world(image, error);
    if (!status) status = take_names(from, name, named, image, error);
    if (status)
        lar_image_destroy(image);
    else
        *out = image;
    return status;
}

void lar_image_destroy(lar_image *image) {
    if (image) lar_image_clear(image);
    free(image);
}

void lar_image_inspect(const lar_image *image, lar_image_info *info) {
    if (!info) return;
    *info = (lar_image_info){0};
    if (!image) return;
    info->names = image->name_count;
    info->label = image->label;
    memcpy(info->size, image->size, sizeof info->size);
    memcpy(info->to_world, image->to_world, sizeof info->to_world);
}

const char *lar_image_name(const lar_image *image, int32_t index, int32_t *label) {
    if (!image || index < 0 || index >= image->name_count) return NULL;
    if (label) *label = image->name[index].label;
    return image->name[index].name;
}

/* ---- what is in it --------------------------------------------------------------------------- */

void lar_image_count(const lar_image *image, int64_t *count) {
    memset(count, 0, (LAR_IMAGE_LABEL_MAX + 1) * sizeof *count);
    size_t voxels = (size_t)image->size[0] * (size_t)image->size[1] * (size_t)image->size[2];
    for (size_t v = 0; v < voxels; v++) count[image->label[v]]++;
}

double lar_image_voxel_volume(const lar_image *image) {
    const double(*m)[4] = image->to_world;
    return fabs(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}

const char *lar_image_label_name(const lar_image *image, int32_t label) {
    for (int32_t n = 0; n < image->name_count; n++)
        if (image->name[n].label == label) return image->name[n].name;
    return NULL;
}

/* ---- names ---------------------------------------------------------------------------------- */

static int by_label(const void *left, const void *right) {
    const lar_image_entry *a = left, *b = right;
    if (a->label != b->label) return a->label < b->label ? -1 : 1;
    return a->order < b->order ? -1 : a->order > b->order;
}

/* A copy that can be printed: a file may hold anything. */
static char *printable(lar_span name) {
    char *copy = lar_strndup(name.at, name.length);
    for (char *c = copy; c && *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f) *c = ' ';
    return copy;
}

lar_status lar_image_add_names(lar_image *image, lar_image_entry *entry, size_t count,
                               lar_error *error) {
    for (int32_t n = 0; n < image->name_count; n++) { /* before all others */
        const lar_label_name *known = &image->name[n];
        entry[count++] = (lar_image_entry){known->label, 0, {known->name, strlen(known->name)}};
    }
    if (count == 0) return LAR_OK;
    qsort(entry, count, sizeof *entry, by_label);
    size_t kept = 0;
    for (size_t n = 0; n < count; n++) {
        if (n + 1 < count && entry[n + 1].label == entry[n].label) continue;
        entry[kept++] = entry[n];
    }
    lar_label_name *name = lar_calloc(kept, sizeof *name);
    if (!name) return lar_fail_memory(error, kept * sizeof *name, "names of labels");
    for (size_t n = 0; n < kept; n++) {
        name[n] = (lar_label_name){entry[n].label, printable(entry[n].name)};
        if (name[n].name) continue;
        while (n > 0) free(name[--n].name);
        free(name);
        return lar_fail_memory(error, entry[n].name.length, "names of labels");
    }
    for (int32_t n = 0; n < image->name_count; n++) free(image->name[n].name);
    free(image->name);
    image->name = name;
    image->name_count = (int32_t)kept;
    return LAR_OK;
}

/* The word before a comma, a semicolon or a blank; the rest behind it. */
static lar_span take_column(lar_span *rest, char separator) {
    lar_span column;
    *rest = lar_span_trim(*rest);
    if (separator) {
        lar_span_split(*rest, separator, &column, rest);
    } else {
        size_t length = 0;
        while (length < rest->length && rest->at[length] != ' ' && rest->at[length] != '\t')
            length++;
        column = (lar_span){rest->at, length};
        *rest = (lar_span){rest->at + length, rest->length - length};
    }
    return lar_span_trim(column);
}

/* The name in a line behind its label: what stands in quotes, or the next column. */
static lar_span take_name(lar_span rest, char separator) {
    lar_span before, quoted, after;
    if (lar_span_split(rest, '"', &before, &after) && lar_span_split(after, '"', &quoted, &after))
        return lar_span_trim(quoted);
    return take_column(&rest, separator);
}

static char separator_of(lar_span line) {
    for (size_t c = 0; c < line.length; c++)
        if (line.at[c] == ',' || line.at[c] == ';') return line.at[c];
    return '\0';
}

/* Entries point into `bytes`. A first line that begins with no number is the columns' titles. */
static lar_status collect_names(const char *path, const lar_bytes *bytes, lar_image_entry **entry,
                                size_t *capacity, size_t *count, lar_error *error) {
    lar_text text = lar_text_from(bytes);
    lar_span line;
    bool first = true;
    for (int number = text.line; lar_text_line(&text, &line); number = text.line) {
        line = lar_span_trim(line);
        if (line.length == 0 || line.at[0] == '#') continue;
        char separator = separator_of(line);
        lar_span rest = line, word = take_column(&rest, separator);
        int64_t label;
        bool titles = first;
        first = false;
        if (!lar_span_int64(word, &label)) {
            if (titles) continue;
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s:%d: the line does not begin with a label; write \"LABEL,NAME\"",
                            path, number);
        }
        if (label < 0 || label > LAR_IMAGE_LABEL_MAX)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s:%d: label %lld is not between 0 and %d; write \"LABEL,NAME\"", path,
                            number, (long long)label, LAR_IMAGE_LABEL_MAX);
        lar_span name = take_name(rest, separator);
        if (name.length == 0)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s:%d: label %lld has no name; write \"LABEL,NAME\"", path, number,
                            (long long)label);
        if (!LAR_GROW(*entry, *capacity, *count))
            return lar_fail_memory(error, *count * sizeof **entry, path);
        (*entry)[*count] = (lar_image_entry){(int32_t)label, *count + 1, name};
        ++*count;
    }
    return LAR_OK;
}

lar_status lar_image_read_names(const char *path, lar_image *image, lar_error *error) {
    lar_bytes bytes;
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    lar_image_entry *entry = NULL;
    size_t capacity = 0, count = 0;
    status = collect_names(path, &bytes, &entry, &capacity, &count, error);
    if (!status && count == 0)
        status = lar_fail(error, LAR_ERROR_FORMAT,
                          "%s: the file names no label; write \"LABEL,NAME\" per line", path);
    if (!status) {
        size_t all = count + (size_t)image->name_count;
        lar_image_entry *wide = realloc(entry, all * sizeof *wide);
        if (wide) entry = wide;
        status = wide ? lar_image_add_names(image, entry, count, error)
                      : lar_fail_memory(error, all * sizeof *wide, path);
    }
    free(entry);
    lar_bytes_free(&bytes);
    return status;
}
