/* PNG by libpng's simplified calls, which give grey of 8 or 16 bits whatever is in the file. */
#include <stdlib.h>

#include "study/frames/image.h"

#ifdef LAR_HAVE_PNG
#include <png.h>

bool lar_grey_has_png(void) {
    return true;
}

static lar_status refuse(const char *path, png_image *png, lar_error *error) {
    lar_status status = lar_fail(error, LAR_ERROR_FORMAT,
                                 "%s: libpng cannot read it (%s); copy or convert it again", path,
                                 png->message[0] ? png->message : "it ends early");
    png_image_free(png);
    return status;
}

/* 16 bits are light as it was, 8 bits numbers as they stand: neither is bent. */
lar_status lar_png_read(const char *path, const lar_bytes *bytes, lar_samples *s,
                        lar_error *error) {
    png_image png = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_memory(&png, bytes->data, bytes->size))
        return refuse(path, &png, error);
    const bool wide = (png.format & PNG_FORMAT_FLAG_LINEAR) != 0;
    const png_color black = {0, 0, 0};
    lar_status status = lar_samples_make(path, png.width, png.height, s, error);
    if (status) {
        png_image_free(&png);
        return status;
    }
    png.format = wide ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
    s->most = wide ? 65535 : 255;
    if (!png_image_finish_read(&png, wide ? NULL : &black, s->sample, 0, NULL))
        return refuse(path, &png, error);
    const size_t count = (size_t)s->width * (size_t)s->height;
    const uint8_t *narrow = (const uint8_t *)s->sample;
    for (size_t i = count; !wide && i-- > 0;) s->sample[i] = narrow[i]; /* in place, from behind */
    return LAR_OK;
}

#else

bool lar_grey_has_png(void) {
    return false;
}

lar_status lar_png_read(const char *path, const lar_bytes *bytes, lar_samples *s,
                        lar_error *error) {
    (void)bytes;
    (void)s;
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "%s: this program was built without libpng, which PNG images need; apt-get "
                    "install libpng-dev, then make, or convert them to PGM",
                    path);
}

#endif
