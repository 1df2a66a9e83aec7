/* What the readers of label images share: bytes that may be compressed, taken in small pieces, and
 * their way into labels.
 *
 *     file in memory --(as it is | gzip members)--> pieces --(type, byte order, slope)--> labels
 *
 * The voxels are never held twice: a piece of some thousand is inflated, decoded, checked and
 * stored as labels. So memory is bounded by the file and by two bytes per voxel, and both are known
 * before a voxel is read; what a gzip stream holds beyond the promised voxels is inflated for its
 * check sum only, and refused.
 */
#ifndef LAR_MESHING_IMAGE_PARTS_H
#define LAR_MESHING_IMAGE_PARTS_H

#include <stdbool.h>
#include <zlib.h>

#include "base/text.h"
#include "meshing/image/image.h"

typedef struct lar_image_stream {
    const char *path;
    const unsigned char *at, *end;
    bool gzip;
    bool damaged;   /* the compressed data make no sense from here on */
    bool starved;   /* there is no memory to decompress more, which then counts as damaged */
    bool ended;     /* nothing more comes */
    uint64_t given; /* bytes handed out */
    z_stream inflate;
} lar_image_stream;

/* The stream points into `bytes`. Closing a zeroed or closed one is fine. */
lar_status lar_image_stream_open(lar_image_stream *stream, const char *path,
                                 const unsigned char *bytes, size_t size, bool gzip,
                                 lar_error *error);
void lar_image_stream_close(lar_image_stream *stream);

bool lar_image_is_gzip(const unsigned char *bytes, size_t size);

/* Up to `size` bytes; fewer where the data end or are damaged. `out` may be NULL: passed over. */
uint64_t lar_image_stream_read(lar_image_stream *stream, void *out, uint64_t size);

/* More bytes cannot come. */
uint64_t lar_image_stream_max(const lar_image_stream *stream);

typedef enum lar_voxel_type {
    LAR_VOXEL_NONE,
    LAR_VOXEL_U8,
    LAR_VOXEL_I8,
    LAR_VOXEL_U16,
    LAR_VOXEL_I16,
    LAR_VOXEL_U32,
    LAR_VOXEL_I32,
    LAR_VOXEL_U64,
    LAR_VOXEL_I64,
    LAR_VOXEL_F32,
    LAR_VOXEL_F64
} lar_voxel_type;

size_t lar_voxel_bytes(lar_voxel_type type);

/* Takes the sizes over once they are bounded, and asks for the labels' memory once the stream can
 * hold so many voxels of `bytes_each`. */
lar_status lar_image_allocate(lar_image *image, const int64_t size[3], size_t bytes_each,
                              const lar_image_stream *stream, lar_error *error);

/* All voxels from the stream: label = slope * value + intercept. Nothing may follow them but zeros
 * behind gzip's end. */
lar_status lar_image_fill(lar_image *image, lar_image_stream *stream, lar_voxel_type type,
                          bool swap, double slope, double intercept, lar_error *error);

/* One voxel. A value is a label when it is whole and in range. */
lar_status lar_image_put(lar_image *image, int64_t voxel, double value, lar_error *error);

/* Refuses a map to the world that is not finite, cannot be turned round, or has voxels of a size
 * that no scanner has. */
lar_status lar_image_check_world(const lar_image *image, lar_error *error);

typedef struct lar_image_entry {
    int32_t label;
    size_t order; /* of two names for a label the later one counts */
    lar_span name;
} lar_image_entry;

/* Adds names to the image's, replacing those that it has; names are kept in the labels' order.
 * `entry` must have room for image->name_count more, and is sorted. */
lar_status lar_image_add_names(lar_image *image, lar_image_entry *entry, size_t count,
                               lar_error *error);

#endif
