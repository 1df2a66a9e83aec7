/* Fuzz target: what `lariat fit` reads and writes. The input is up to four files, parted by lines
 * of %%: the experiment, its table data.csv, the tube's pressure.csv, and a tissue file. The scenes
 * gel.yaml and tissue.yaml are there. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "study/inverse/experiment.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char folder[] = "/tmp/lariat_fuzz_fit_XXXXXX";
static const char *const own[] = {"fit.yaml", "data.csv", "pressure.csv", "gel.tissue.yaml"};
static const char *const given[] = {"gel.yaml", "tissue.yaml", "one.vtk"};

static void write_file(const char *name, const void *data, size_t size) {
    char path[96];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *out = fopen(path, "wb");
    if (!out || (size > 0 && fwrite(data, 1, size, out) != size) || fclose(out)) abort();
}

static void write_text(const char *name, const char *text) {
    write_file(name, text, strlen(text));
}

static void remove_all(void) {
    char path[96];
    for (size_t i = 0; i < sizeof own / sizeof own[0] + sizeof given / sizeof given[0]; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, i < 4 ? own[i] : given[i - 4]);
        unlink(path);
    }
    rmdir(folder);
}

#define TOP "{ plane: { point: [0, 0, 0.02], normal: [0, 0, 1] } }"

static void begin(void) {
    if (!mkdtemp(folder)) abort();
    atexit(remove_all);
    write_text("one.vtk", "# vtk DataFile Version 3.0\none\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                          "POINTS 8 double\n0 0 0 0.01 0 0 0.01 0.01 0 0 0.01 0\n0 0 0.02 0.01 0 "
                          "0.02 0.01 0.01 0.02 0 0.01 0.02\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\n"
                          "CELL_TYPES 1\n12\n");
    write_text("gel.yaml",
               "lariat: 1\nmesh: one.vtk\nmaterials:\n  - { cells: all, name: gel, law: "
               "neo-hookean, density: 1050, shear_modulus: 1.0e3, bulk_modulus: 4.0e4 }\n"
               "move: [ { nodes: " TOP ", axes: z, by: 0.002, over: 1 } ]\n"
               "load: [ { faces: " TOP ", pressure: -100 } ]\n"
               "tools: [ { name: ball, shape: sphere, radius: 0.008, at: [0, 0, 0.1] } ]\n");
    write_text("tissue.yaml", "lariat: 1\nmesh: one.vtk\nmaterials: [ { cells: all, tissue: "
                              "gel.tissue.yaml } ]\n");
}

/* Bytes before the next line of %%; *next is behind that line, `end` where there is none. */
static size_t section(const uint8_t *from, const uint8_t *end, const uint8_t **next) {
    for (const uint8_t *at = from; at + 3 <= end; at++)
        if (memcmp(at, "%%\n", 3) == 0 && (at == from || at[-1] == '\n')) {
            *next = at + 3;
            return (size_t)(at - from);
        }
    *next = end;
    return (size_t)(end - from);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static bool ready;
    const uint8_t *at = data, *end = data + size;
    char path[96];
    lar_error error = {0};
    if (!ready) begin();
    ready = true;
    for (size_t i = 0; i < sizeof own / sizeof own[0]; i++) {
        const uint8_t *from = at;
        size_t length = section(from, end, &at);
        write_file(own[i], from, length);
    }
    lar_inverse_problem problem = {0};
    snprintf(path, sizeof path, "%s/fit.yaml", folder);
    if (lar_inverse_problem_read(path, &problem, &error) && !*error.message) abort();
    lar_inverse_problem_clear(&problem);
    lar_model *model = NULL;
    snprintf(path, sizeof path, "%s/tissue.yaml", folder);
    if (lar_model_open(path, &model, &error) && !*error.message) abort();
    lar_model_destroy(model);
    return 0;
}
