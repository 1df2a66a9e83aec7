/* Fuzz target: what `lariat fit --profile` reads. The input is the file of a view, a line of %%,
 * and the second of two frames; the first is whole. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "study/frames/profiles.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { WIDTH = 48, HEIGHT = 32 };

static char folder[] = "/tmp/lariat_fuzz_frames_XXXXXX";
static const char *const name[] = {"film/1.pgm", "film/2.pgm", "view.yaml", "out.csv", "out.svg"};

static const char *path_of(const char *file) {
    static char path[4][96];
    static int next;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s", folder, file);
    return path[next];
}

static void write_file(const char *file, const void *data, size_t size) {
    FILE *out = fopen(path_of(file), "wb");
    if (!out || (size > 0 && fwrite(data, 1, size, out) != size) || fclose(out)) abort();
}

static void remove_all(void) {
    for (size_t i = 0; i < sizeof name / sizeof name[0]; i++) unlink(path_of(name[i]));
    rmdir(path_of("film"));
    rmdir(folder);
}

/* A bump, dark before bright. */
static void begin(void) {
    static uint8_t frame[64 + WIDTH * HEIGHT];
    if (!mkdtemp(folder) || mkdir(path_of("film"), 0777)) abort();
    atexit(remove_all);
    size_t used = (size_t)snprintf((char *)frame, 64, "P5 %d %d 255\n", WIDTH, HEIGHT);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double x = (i % WIDTH - 24) / 20.0, edge = 25 - 12 * (1 - x * x);
        frame[used++] = (uint8_t)(140 - 80 * tanh(i / WIDTH - edge) + i * 7 % 5);
    }
    write_file(name[0], frame, used);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static bool ready;
    const uint8_t *frame = data, *end = data + size;
    lar_error error = {0};
    lar_profiles p = {0};
    if (!ready) begin();
    ready = true;
    while (frame + 3 <= end && memcmp(frame, "%%\n", 3) != 0) frame++;
    write_file("view.yaml", data, frame + 3 <= end ? (size_t)(frame - data) : size);
    write_file(name[1], frame + 3, frame + 3 <= end ? (size_t)(end - frame - 3) : 0);
    if (lar_profiles_read(path_of("film"), path_of("view.yaml"), NULL, &p, &error)) {
        if (!*error.message) abort();
    } else {
        if (lar_profiles_write(&p, path_of("out.csv"), &error) ||
            lar_profiles_draw(&p, path_of("out.svg"), &error))
            abort();
        for (int i = 0; i < p.frames.count * p.view.points; i++)
            if (!isfinite(p.point[i].z) || !isfinite(p.point[i].error)) abort();
    }
    lar_profiles_clear(&p);
    return 0;
}
