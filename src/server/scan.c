#include "server/scan.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

typedef struct slice_head {
    uint32_t kind, axis, index, count, width, height, zero[2];
    float corner[3], across[3], down[3]; /* of the first pixel's centre; from one to the next [m] */
    uint32_t end;
} slice_head;
_Static_assert(sizeof(slice_head) == LAR_SLICE_HEADER, "the header of a slice has no gaps");

/* The axes of a slice's picture. */
static int first_axis(int axis) {
    return axis == 0 ? 1 : 0;
}

static int second_axis(int axis) {
    return axis == 2 ? 1 : 2;
}

static size_t slice_bytes(const lar_image_info *image, int axis) {
    size_t pixels = (size_t)image->size[first_axis(axis)] * (size_t)image->size[second_axis(axis)];
    return LAR_SLICE_HEADER + (2 * pixels + 3) / 4 * 4;
}

lar_status lar_scan_read(const char *path, lar_scan *scan, lar_error *error) {
    *scan = (lar_scan){0};
    if (!path) return LAR_OK;
    lar_status status = lar_image_open(path, &scan->image, error);
    if (status) return status;
    lar_image_inspect(scan->image, &scan->info);
    size_t max = 0;
    for (int axis = 0; axis < 3; axis++)
        if (slice_bytes(&scan->info, axis) > max) max = slice_bytes(&scan->info, axis);
    scan->slice.memory = lar_calloc_aligned(LAR_HEADROOM + max, 1);
    if (scan->slice.memory) return LAR_OK;
    lar_scan_clear(scan);
    return lar_fail_memory(error, max, "slices of a scan for viewers");
}

void lar_scan_clear(lar_scan *scan) {
    lar_image_destroy(scan->image);
    free(scan->slice.memory);
    *scan = (lar_scan){0};
}

static void copy_labels(const lar_image_info *image, int axis, int32_t index, uint16_t *out) {
    const int u = first_axis(axis), v = second_axis(axis);
    const size_t step[3] = {1, (size_t)image->size[0],
                            (size_t)image->size[0] * (size_t)image->size[1]};
    for (int32_t y = 0; y < image->size[v]; y++)
        for (int32_t x = 0; x < image->size[u]; x++)
            *out++ =
                image
                    ->label[(size_t)index * step[axis] + (size_t)x * step[u] + (size_t)y * step[v]];
}

void lar_scan_slice(lar_scan *scan, int axis, int32_t index) {
    const lar_image_info *image = &scan->info;
    const int u = first_axis(axis), v = second_axis(axis);
    slice_head head = {.kind = 5,
                       .axis = (uint32_t)axis,
                       .index = (uint32_t)index,
                       .count = (uint32_t)image->size[axis],
                       .width = (uint32_t)image->size[u],
                       .height = (uint32_t)image->size[v]};
    for (int i = 0; i < 3; i++) {
        const double *row = image->to_world[i];
        head.corner[i] = (float)(row[3] + (double)index * row[axis]);
        head.across[i] = (float)row[u];
        head.down[i] = (float)row[v];
    }
    unsigned char *out = lar_blob_data(&scan->slice);
    scan->slice.length = slice_bytes(image, axis);
    memset(out + scan->slice.length - 4, 0, 4); /* what fills the last word */
    memcpy(out, &head, sizeof head);
    copy_labels(image, axis, index, (uint16_t *)(void *)(out + sizeof head));
}
