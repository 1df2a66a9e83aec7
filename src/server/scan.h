/* Slices of the segmented scan that a body was meshed from, for viewers (binary message 5 of
 * docs/viewer-protocol.md).
 *
 *     image: labels along i, j, k  --axis, index-->  a picture of w x h labels, and where it lies
 *
 * The scan is read once, when the server opens, and stays as it is: it shows the body at rest.
 */
#ifndef LAR_SERVER_SCAN_H
#define LAR_SERVER_SCAN_H

#include <stdbool.h>

#include "lariat.h"
#include "server/blob.h"

enum { LAR_SLICE_HEADER = 72 };

typedef struct lar_scan {
    lar_image *image; /* NULL: there is none */
    lar_image_info info;
    lar_blob slice; /* as large as the largest */
} lar_scan;

/* Reads the image at `path`; NULL: there is none. Cleared by lar_scan_clear. */
lar_status lar_scan_read(const char *path, lar_scan *scan, lar_error *error);
void lar_scan_clear(lar_scan *scan); /* idempotent; a zeroed one is fine */

static inline bool lar_scan_is_there(const lar_scan *scan) {
    return scan->image != NULL;
}

/* Makes scan->slice: across `axis` (0, 1, 2: i, j, k), at `index` along it, which is there. */
void lar_scan_slice(lar_scan *scan, int axis, int32_t index);

#endif
