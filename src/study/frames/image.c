#include "study/frames/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- any image ------------------------------------------------------------------------------- */

lar_status lar_samples_make(const char *path, double width, double height, lar_samples *s,
                            lar_error *error) {
    static const double SIDE = 20000, ALL = 1 << 26;
    if (!(width >= 1 && height >= 1 && width <= SIDE && height <= SIDE && width * height <= ALL))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: an image of %g x %g pixels; it must have one at least, and %g at most",
                        path, width, height, ALL);
    s->width = (int)width;
    s->height = (int)height;
    s->sample = lar_calloc((size_t)s->width * (size_t)s->height, sizeof *s->sample);
    return s->sample ? LAR_OK : lar_fail_memory(error, (size_t)(width * height), path);
}

static lar_status make_light(const char *path, const lar_samples *s, double gamma, lar_grey *image,
                             lar_error *error) {
    const size_t count = (size_t)s->width * (size_t)s->height;
    float *light = lar_calloc((size_t)s->most + 1, sizeof *light);
    image->width = s->width;
    image->height = s->height;
    image->step = 1.0 / s->most;
    image->value = lar_calloc(count, sizeof *image->value);
    if (!light || !image->value) {
        free(light);
        return lar_fail_memory(error, count, path);
    }
    for (int i = 0; i <= s->most; i++)
        light[i] = (float)(gamma == 1 ? (double)i / s->most : pow((double)i / s->most, gamma));
    for (size_t i = 0; i < count; i++)
        image->value[i] = light[s->sample[i] < s->most ? s->sample[i] : s->most];
    free(light);
    return LAR_OK;
}

lar_status lar_grey_read(const char *path, double gamma, lar_grey *image, lar_error *error) {
    static const unsigned char png[] = {0x89, 'P', 'N', 'G'};
    lar_bytes bytes;
    lar_samples samples = {0};
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    if (bytes.size >= 4 && memcmp(bytes.data, png, 4) == 0)
        status = lar_png_read(path, &bytes, &samples, error);
    else if (bytes.size >= 2 && bytes.data[0] == 'P' &&
             (bytes.data[1] == '2' || bytes.data[1] == '5'))
        status = lar_pgm_read(path, &bytes, &samples, error);
    else
        status = lar_fail(error, LAR_ERROR_FORMAT,
                          "%s: it begins neither as a PNG nor as a PGM image (P5, P2); convert it, "
                          "for example with ffmpeg or ImageMagick",
                          path);
    lar_bytes_free(&bytes);
    if (!status) status = make_light(path, &samples, gamma, image, error);
    free(samples.sample);
    return status;
}

void lar_grey_clear(lar_grey *image) {
    free(image->value);
    *image = (lar_grey){0};
}

/* ---- PGM ------------------------------------------------------------------------------------- */

typedef struct reader {
    const unsigned char *at, *end;
} reader;

static bool is_space(unsigned char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* The next number behind spaces and comments. False: there is none, or one of many digits. */
static bool next_number(reader *r, int *value) {
    while (r->at < r->end && (is_space(*r->at) || *r->at == '#')) {
        bool comment = *r->at == '#';
        while (comment && r->at < r->end && *r->at != '\n') r->at++;
        if (r->at < r->end) r->at++;
    }
    const unsigned char *from = r->at;
    for (*value = 0; r->at < r->end && *r->at >= '0' && *r->at <= '9' && r->at - from < 9; r->at++)
        *value = 10 * *value + (*r->at - '0');
    return r->at > from && (r->at == r->end || *r->at < '0' || *r->at > '9');
}

static lar_status read_binary(const char *path, reader *r, lar_samples *s, lar_error *error) {
    const size_t count = (size_t)s->width * (size_t)s->height, each = s->most > 255 ? 2 : 1;
    const size_t there = (size_t)(r->end - r->at);
    if (there < count * each)
        return lar_fail(
            error, LAR_ERROR_FORMAT,
            "%s: it ends early: %zu bytes of pixels, and %d x %d of them need %zu; copy "
            "it again",
            path, there, s->width, s->height, count * each);
    for (size_t i = 0; i < count; i++)
        s->sample[i] = (uint16_t)(each == 1 ? r->at[i] : r->at[2 * i] << 8 | r->at[2 * i + 1]);
    return LAR_OK;
}

static lar_status read_text(const char *path, reader *r, lar_samples *s, lar_error *error) {
    const size_t count = (size_t)s->width * (size_t)s->height;
    int value;
    for (size_t i = 0; i < count; i++) {
        if (!next_number(r, &value) || value > s->most)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: pixel %zu of %d x %d is no number from 0 to %d", path, i + 1,
                            s->width, s->height, s->most);
        s->sample[i] = (uint16_t)value;
    }
    return LAR_OK;
}

lar_status lar_pgm_read(const char *path, const lar_bytes *bytes, lar_samples *s,
                        lar_error *error) {
    reader r = {bytes->data + 2, bytes->data + bytes->size};
    const bool text = bytes->data[1] == '2';
    int width, height;
    if (!next_number(&r, &width) || !next_number(&r, &height) || !next_number(&r, &s->most) ||
        s->most < 1 || s->most > 65535 || r.at == r.end || !is_space(*r.at))
        return lar_fail(
            error, LAR_ERROR_FORMAT,
            "%s: behind P%c a PGM image says its width, its height and what is white, 1 "
            "to 65535; this one does not",
            path, bytes->data[1]);
    r.at++;
    /* A header may claim what the file has not: a number takes a byte at least. */
    if (!lar_claim_fits((unsigned long long)width * (unsigned long long)height, 1,
                        (size_t)(r.end - r.at)))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: it ends early: %zu bytes of pixels for %d x %d; copy it again", path,
                        (size_t)(r.end - r.at), width, height);
    lar_status status = lar_samples_make(path, width, height, s, error);
    if (status) return status;
    return text ? read_text(path, &r, s, error) : read_binary(path, &r, s, error);
}
