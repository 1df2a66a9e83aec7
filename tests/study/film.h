/* Films of tissue in a tube as a camera takes them from the side, of a profile that is known:
 * blurred, noisy, in uneven light, with specks, and the tube's walls beside. */
#ifndef LAR_TESTS_STUDY_FILM_H
#define LAR_TESTS_STUDY_FILM_H

#include <sys/stat.h>

#include "fit_twin.h"

#ifdef LAR_TEST_PNG
#include <png.h>
#endif

typedef double film_height(const void *context, double r); /* m of m */

typedef struct film {
    int width, height;
    double scale, axis, rim, turn; /* as the view has them: m per pixel, pixels, rad */
    double tube;                   /* radius [m]; beyond it are walls 0.6 mm thick */
    double tissue, behind;         /* light, of 1 */
    double blur, noise, uneven;    /* pixels; of 1; of the light, from one corner to the other */
    double gamma;                  /* of the camera: 0 is 1 */
    double grain;                  /* over which noise is alike [pixels] */
    int specks;
    bool motion; /* blurred by a box, not by a normal curve */
    uint64_t seed;
} film;

enum { FILM_PIXELS = 700000, FILM_SUB = 24 };

TEST_UNUSED static double film_uniform(uint64_t *seed) {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return ((double)(*seed >> 11) + 0.5) / 9007199254740992.0;
}

/* Light at a place of the tube's frame, pixels. */
TEST_UNUSED static double film_light(const film *f, film_height *height, const void *context,
                                     double x, double y) {
    const double r = fabs(x) * f->scale, z = y * f->scale;
    if (r > f->tube && r < f->tube + 6e-4 && z > 0) return 0.5 * (f->tissue + f->behind);
    return z < (r < f->tube ? height(context, r) : 0) ? f->tissue : f->behind;
}

/* At a place of the picture, pixels. */
TEST_UNUSED static double film_at(const film *f, film_height *height, const void *context, double i,
                                  double j) {
    const double dx = i - f->axis, dy = j - f->rim;
    return film_light(f, height, context, dx * cos(f->turn) + dy * sin(f->turn),
                      dx * sin(f->turn) - dy * cos(f->turn));
}

/* The mean over each pixel. Where all is alike around it, one look is enough; else many, since a
 * level edge is rendered only as exactly as rows of looks are close. */
TEST_UNUSED static void film_expose(const film *f, film_height *height, const void *context,
                                    float *light) {
    for (int j = 0; j < f->height; j++)
        for (int i = 0; i < f->width; i++) {
            double sum = film_at(f, height, context, i, j);
            bool alike = true;
            for (int c = 0; c < 4; c++)
                alike = alike && film_at(f, height, context, c & 1 ? i + 1 : i - 1,
                                         c & 2 ? j + 1 : j - 1) == sum;
            if (!alike) {
                sum = 0;
                for (int s = 0; s < FILM_SUB * FILM_SUB; s++)
                    sum += film_at(f, height, context, i + (s % FILM_SUB + 0.5) / FILM_SUB - 0.5,
                                   j + (s / FILM_SUB + 0.5) / FILM_SUB - 0.5);
                sum /= FILM_SUB * FILM_SUB;
            }
            light[j * f->width + i] = (float)sum;
        }
}

/* Along rows or columns; the picture goes on beyond its border as it ends. */
TEST_UNUSED static void film_blur(const film *f, float *light, bool rows) {
    static float line[4096];
    double kernel[129], sum = 0;
    const int reach = f->motion ? (int)f->blur : (int)ceil(4 * f->blur);
    assert_in_range(reach, 0, 64);
    for (int k = -reach; k <= reach; k++)
        sum += kernel[k + reach] = f->motion ? 1 : exp(-0.5 * k * k / (f->blur * f->blur + 1e-9));
    const int lines = rows ? f->height : f->width, length = rows ? f->width : f->height,
              along = rows ? 1 : f->width, across = rows ? f->width : 1;
    for (int j = 0; j < lines; j++) {
        for (int i = 0; i < length; i++) line[i] = light[j * across + i * along];
        for (int i = 0; i < length; i++) {
            double value = 0;
            for (int k = -reach; k <= reach; k++) {
                int at = i + k < 0 ? 0 : i + k >= length ? length - 1 : i + k;
                value += kernel[k + reach] * (double)line[at];
            }
            light[j * across + i * along] = (float)(value / sum);
        }
    }
}

TEST_UNUSED static void film_specks(film *f, float *light) {
    for (int n = 0; n < f->specks; n++) {
        double x = f->width * film_uniform(&f->seed), y = f->height * film_uniform(&f->seed),
               size = 1 + 3 * film_uniform(&f->seed), value = film_uniform(&f->seed) > 0.5;
        for (int j = 0; j < f->height; j++)
            for (int i = 0; i < f->width; i++)
                if (hypot(i - x, j - y) < size) light[j * f->width + i] = (float)value;
    }
}

/* Normal numbers of deviation 1, alike over the grain. */
TEST_UNUSED static void film_noise(film *f, float *noise) {
    const int count = f->width * f->height;
    for (int i = 0; i < count; i++) noise[i] = (float)twin_noise(&f->seed);
    if (!(f->grain > 0)) return;
    film alike = *f;
    double squares = 0;
    alike.blur = f->grain;
    alike.motion = false;
    film_blur(&alike, noise, true);
    film_blur(&alike, noise, false);
    for (int i = 0; i < count; i++) squares += (double)noise[i] * (double)noise[i];
    for (int i = 0; i < count; i++) noise[i] /= (float)sqrt(squares / count);
}

/* One frame into a file, .pgm or .png. */
TEST_UNUSED static void film_write(film *f, film_height *height, const void *context,
                                   const char *path) {
    static float light[FILM_PIXELS], noise[FILM_PIXELS];
    static uint8_t grey[FILM_PIXELS];
    const int count = f->width * f->height;
    assert_in_range(count, 1, FILM_PIXELS);
    film_expose(f, height, context, light);
    film_blur(f, light, true);
    film_blur(f, light, false);
    film_specks(f, light);
    film_noise(f, noise);
    for (int i = 0; i < count; i++) {
        double place = 0.5 * (i % f->width) / f->width + 0.5 * i / count;
        double value = (double)light[i] * (1 - f->uneven * place * place);
        value = fmin(fmax(value + f->noise * (double)noise[i], 0), 1);
        if (f->gamma > 0) value = pow(value, 1 / f->gamma);
        grey[i] = (uint8_t)(255 * value + 0.5);
    }
    const char *dot = strrchr(path, '.');
    if (dot && strcmp(dot, ".png") == 0) {
#ifdef LAR_TEST_PNG
        png_image png = {.version = PNG_IMAGE_VERSION,
                         .width = (png_uint_32)f->width,
                         .height = (png_uint_32)f->height,
                         .format = PNG_FORMAT_GRAY};
        assert_true(png_image_write_to_file(&png, path, 0, grey, 0, NULL));
#endif
        return;
    }
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    fprintf(out, "P5\n# a frame\n%d %d\n255\n", f->width, f->height);
    assert_int_equal(fwrite(grey, 1, (size_t)count, out), count);
    assert_int_equal(fclose(out), 0);
}

/* An empty folder below the build folder. */
TEST_UNUSED static const char *film_folder(const char *name) {
    char command[600];
    snprintf(command, sizeof command, "rm -rf '%s'", twin_path(name));
    assert_int_equal(system(command), 0);
    assert_int_equal(mkdir(twin_path(name), 0777), 0);
    return twin_path(name);
}

#endif
