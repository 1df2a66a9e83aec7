/* The text header of an NRRD file ("nearly raw raster data", Teem's definition of the format,
 * versions 1 to 5):
 *
 *     NRRD0004
 *     # comment
 *     type: unsigned char                 field: description
 *     sizes: 128 128 34
 *     Segment0_Name:=ribs                 key:=value
 *                                         (an empty line, then the data; or a data file's name)
 */
#ifndef LAR_MESHING_IMAGE_NRRD_H
#define LAR_MESHING_IMAGE_NRRD_H

#include "meshing/image/parts.h"

typedef enum lar_nrrd_field {
    LAR_NRRD_IGNORED, /* known, and of no use here */
    LAR_NRRD_TYPE,
    LAR_NRRD_DIMENSION,
    LAR_NRRD_SIZES,
    LAR_NRRD_ENCODING,
    LAR_NRRD_ENDIAN,
    LAR_NRRD_SPACE,
    LAR_NRRD_SPACE_DIMENSION,
    LAR_NRRD_SPACE_DIRECTIONS,
    LAR_NRRD_SPACE_ORIGIN,
    LAR_NRRD_SPACE_UNITS,
    LAR_NRRD_SPACINGS,
    LAR_NRRD_AXIS_MINS,
    LAR_NRRD_CENTERS,
    LAR_NRRD_UNITS,
    LAR_NRRD_KINDS,
    LAR_NRRD_DATA_FILE,
    LAR_NRRD_LINE_SKIP,
    LAR_NRRD_BYTE_SKIP,
    LAR_NRRD_FIELDS
} lar_nrrd_field;

enum { LAR_NRRD_AXES_MAX = 4 };

typedef struct lar_nrrd_value {
    lar_span text; /* at == NULL: not there */
    int line;
} lar_nrrd_value;

/* A half of what names a segment: Segment{number}_Name or Segment{number}_LabelValue. */
typedef struct lar_nrrd_segment {
    int64_t number;
    bool is_name;
    lar_nrrd_value value;
} lar_nrrd_segment;

typedef struct lar_nrrd_header {
    const char *path;
    lar_nrrd_value field[LAR_NRRD_FIELDS];
    lar_nrrd_segment *segment;
    size_t segment_count, segment_capacity;
    lar_text rest; /* what follows the empty line; at == end when there is none */
    bool has_data; /* there was an empty line */
} lar_nrrd_header;

/* Spans point into `bytes`. Cleared by the caller, also on failure. */
lar_status lar_nrrd_read_header(const char *path, const lar_bytes *bytes, lar_nrrd_header *header,
                                lar_error *error);
void lar_nrrd_clear_header(lar_nrrd_header *header);

/* Sizes of the three axes in space, and the map to the world. */
lar_status lar_nrrd_geometry(const lar_nrrd_header *header, int64_t size[3], lar_image *image,
                             lar_error *error);

/* The only number of a field; `missing` where the field is not there. */
lar_status lar_nrrd_whole(const lar_nrrd_header *header, lar_nrrd_field field, int64_t missing,
                          int64_t *value, lar_error *error);

/* FORMAT, "FILE:LINE: FIELD \"VALUE\" CAUSE". */
lar_status lar_nrrd_bad(const lar_nrrd_header *header, lar_nrrd_field field, const char *cause,
                        lar_error *error);
lar_status lar_nrrd_missing(const lar_nrrd_header *header, lar_nrrd_field field, lar_error *error);

#endif
