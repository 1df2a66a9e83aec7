/* NIfTI-1 and -2 in one file, compressed or not (R. W. Cox and others, "A (sort of) new image data
 * format standard: NIfTI-1", 2004; NIfTI-2, 2011). libnifti knows the headers, their byte order and
 * quaternions; it is given nothing but these, so a hostile file can make it neither allocate nor
 * read. */
#include "meshing/image/parts.h"

#ifdef LAR_HAVE_NIFTI

#include <math.h>
#include <nifti2_io.h>
#include <string.h>

typedef struct nifti_header {
    int version;
    bool swap;
    int64_t dim[8];
    int type, units, qform, sform;
    double pixdim[8], offset, slope, intercept;
    double quaternion[3], shift[3], row[3][4];
    char magic[4];
} nifti_header;

typedef union raw_header {
    int32_t size;
    nifti_1_header one;
    nifti_2_header two;
} raw_header;

/* The headers' fields have the same names but different types. */
#define TAKE_HEADER(from)                                                                          \
    do {                                                                                           \
        for (int d = 0; d < 8; d++) {                                                              \
            header->dim[d] = (from)->dim[d];                                                       \
            header->pixdim[d] = (double)(from)->pixdim[d];                                         \
        }                                                                                          \
        header->type = (from)->datatype;                                                           \
        header->units = (from)->xyzt_units;                                                        \
        header->qform = (from)->qform_code;                                                        \
        header->sform = (from)->sform_code;                                                        \
        header->offset = (double)(from)->vox_offset;                                               \
        header->slope = (double)(from)->scl_slope;                                                 \
        header->intercept = (double)(from)->scl_inter;                                             \
        header->quaternion[0] = (double)(from)->quatern_b;                                         \
        header->quaternion[1] = (double)(from)->quatern_c;                                         \
        header->quaternion[2] = (double)(from)->quatern_d;                                         \
        header->shift[0] = (double)(from)->qoffset_x;                                              \
        header->shift[1] = (double)(from)->qoffset_y;                                              \
        header->shift[2] = (double)(from)->qoffset_z;                                              \
        for (int d = 0; d < 4; d++) {                                                              \
            header->row[0][d] = (double)(from)->srow_x[d];                                         \
            header->row[1][d] = (double)(from)->srow_y[d];                                         \
            header->row[2][d] = (double)(from)->srow_z[d];                                         \
        }                                                                                          \
        memcpy(header->magic, (from)->magic, sizeof header->magic);                                \
    } while (0)

static lar_status read_header(const char *path, const lar_bytes *bytes, nifti_header *header,
                              lar_error *error) {
    raw_header raw;
    memset(&raw, 0, sizeof raw);
    lar_image_stream stream;
    lar_status status = lar_image_stream_open(&stream, path, bytes->data, bytes->size,
                                              lar_image_is_gzip(bytes->data, bytes->size), error);
    if (status) return status;
    size_t got = (size_t)lar_image_stream_read(&stream, &raw, sizeof raw);
    bool damaged = stream.damaged && got < sizeof raw.one, starved = stream.starved;
    lar_image_stream_close(&stream);
    if (starved) return lar_fail_memory(error, bytes->size, path);
    if (damaged)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the compressed data are damaged or cut short after %zu bytes; copy or "
                        "write the file again",
                        path, got);
    nifti_set_debug_level(0);
    header->version = got < sizeof raw.one ? -1 : nifti_header_version((const char *)&raw, got);
    if (header->version != 1 && (header->version != 2 || got < sizeof raw.two))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the file does not begin with the header of NIfTI-1 or NIfTI-2; write "
                        "it as .nii, .nii.gz or .nrrd",
                        path);
    header->swap = raw.size != (header->version == 1 ? 348 : 540);
    if (header->swap) swap_nifti_header(&raw, header->version);
    if (header->version == 1)
        TAKE_HEADER(&raw.one);
    else
        TAKE_HEADER(&raw.two);
    return LAR_OK;
}

static lar_voxel_type type_of(int datatype) {
    switch (datatype) {
    case NIFTI_TYPE_UINT8:
        return LAR_VOXEL_U8;
    case NIFTI_TYPE_INT8:
        return LAR_VOXEL_I8;
    case NIFTI_TYPE_UINT16:
        return LAR_VOXEL_U16;
    case NIFTI_TYPE_INT16:
        return LAR_VOXEL_I16;
    case NIFTI_TYPE_UINT32:
        return LAR_VOXEL_U32;
    case NIFTI_TYPE_INT32:
        return LAR_VOXEL_I32;
    case NIFTI_TYPE_UINT64:
        return LAR_VOXEL_U64;
    case NIFTI_TYPE_INT64:
        return LAR_VOXEL_I64;
    case NIFTI_TYPE_FLOAT32:
        return LAR_VOXEL_F32;
    case NIFTI_TYPE_FLOAT64:
        return LAR_VOXEL_F64;
    default:
        return LAR_VOXEL_NONE;
    }
}

/* Three axes, one volume; a slice is an image of one voxel's thickness. */
static lar_status check_axes(const char *path, nifti_header *header, lar_error *error) {
    if (header->magic[1] == 'i')
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: this is the header of an image in two files (.hdr and .img); write "
                        "it as one, .nii or .nii.gz",
                        path);
    int64_t axes = header->dim[0];
    if (axes < 1 || axes > 7)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the header says %lld axes; it is damaged, write the image again", path,
                        (long long)axes);
    for (int64_t d = axes + 1; d < 8; d++) header->dim[d] = 1;
    for (int d = 4; d < 8; d++)
        if (header->dim[d] != 1)
            return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                            "%s: the image has %lld axes, with %lld volumes along axis %d; write "
                            "the one volume that holds the labels",
                            path, (long long)axes, (long long)header->dim[d], d);
    return LAR_OK;
}

static lar_status unit_of(const char *path, int units, double *metres, lar_error *error) {
    switch (XYZT_TO_SPACE(units)) {
    case NIFTI_UNITS_METER:
        *metres = 1;
        return LAR_OK;
    case NIFTI_UNITS_MICRON:
        *metres = 1e-6;
        return LAR_OK;
    case NIFTI_UNITS_MM:
    case NIFTI_UNITS_UNKNOWN:
        *metres = 1e-3;
        return LAR_OK; /* what nearly all files mean */
    default:
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: code %d for the unit of length is none of NIfTI's; write the image "
                        "again, in millimetres",
                        path, XYZT_TO_SPACE(units));
    }
}

/* The standard's methods 3 (sform), 2 (qform) and 1 (voxel sizes alone), in this order. */
static lar_status set_world(const nifti_header *header, lar_image *image, lar_error *error) {
    double metres = 1e-3;
    lar_status status = unit_of(image->source, header->units, &metres, error);
    if (status) return status;
    double row[3][4] = {{0}};
    if (header->sform > 0) {
        memcpy(row, header->row, sizeof row);
    } else {
        const double *size = header->pixdim + 1;
        for (int a = 0; a < 3; a++) {
            if (size[a] > 0 && isfinite(size[a])) continue;
            char words[32] = "no number";
            if (isfinite(size[a])) snprintf(words, sizeof words, "%g", size[a]);
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: the size of a voxel along axis %c is %s; write the image again "
                            "with its voxel sizes",
                            image->source, "ijk"[a], words);
        }
        nifti_dmat44 turned = {{{size[0], 0, 0, 0}, {0, size[1], 0, 0}, {0, 0, size[2], 0}}};
        if (header->qform > 0)
            turned = nifti_quatern_to_dmat44(header->quaternion[0], header->quaternion[1],
                                             header->quaternion[2], header->shift[0],
                                             header->shift[1], header->shift[2], size[0], size[1],
                                             size[2], header->pixdim[0] < 0 ? -1 : 1);
        for (int c = 0; c < 3; c++) memcpy(row[c], turned.m[c], sizeof row[c]);
    }
    for (int c = 0; c < 3; c++)
        for (int d = 0; d < 4; d++) image->to_world[c][d] = metres * row[c][d];
    return lar_image_check_world(image, error);
}

/* A slope of 0, or none, means: as they are. */
static lar_status check_scaling(const char *path, nifti_header *header, lar_error *error) {
    if (header->slope == 0 || !isfinite(header->slope)) {
        header->slope = 1;
        header->intercept = 0;
    }
    if (!isfinite(header->intercept))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: scl_inter, which is added to every voxel, is no number; write the "
                        "image again without scaling",
                        path);
    return LAR_OK;
}

static lar_status read_voxels(const nifti_header *header, const lar_bytes *bytes, lar_image *image,
                              lar_error *error) {
    const char *path = image->source;
    lar_voxel_type type = type_of(header->type);
    if (type == LAR_VOXEL_NONE)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: voxels of type %s (%d) are no labels; write whole numbers", path,
                        nifti_datatype_string(header->type), header->type);
    double min = header->version == 1 ? 352 : 544;
    if (!(header->offset >= min && header->offset < 0x1p53) ||
        header->offset != floor(header->offset))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: vox_offset, where the voxels begin, is not a byte from %g on; the "
                        "header is damaged, write the image again",
                        path, min);
    lar_image_stream stream;
    lar_status status = lar_image_stream_open(&stream, path, bytes->data, bytes->size,
                                              lar_image_is_gzip(bytes->data, bytes->size), error);
    if (status) return status;
    uint64_t offset = (uint64_t)header->offset;
    uint64_t skipped = lar_image_stream_read(&stream, NULL, offset);
    if (skipped < offset)
        status = lar_fail(error, LAR_ERROR_FORMAT,
                          "%s: the voxels begin at byte %llu, the file holds %llu; it is cut short "
                          "or damaged, copy or write it again",
                          path, (unsigned long long)offset, (unsigned long long)skipped);
    if (!status)
        status = lar_image_allocate(image, header->dim + 1, lar_voxel_bytes(type), &stream, error);
    if (!status) status = set_world(header, image, error);
    if (!status)
        status = lar_image_fill(image, &stream, type, header->swap, header->slope,
                                header->intercept, error);
    lar_image_stream_close(&stream);
    return status;
}

lar_status lar_nifti_parse(const char *path, const lar_bytes *bytes, lar_image *image,
                           lar_error *error) {
    *image = (lar_image){.source = lar_strdup(path)};
    if (!image->source) return lar_fail_memory(error, strlen(path), path);
    nifti_header header;
    lar_status status = read_header(path, bytes, &header, error);
    if (!status) status = check_axes(path, &header, error);
    if (!status) status = check_scaling(path, &header, error);
    if (!status) status = read_voxels(&header, bytes, image, error);
    return status;
}

#else

lar_status lar_nifti_parse(const char *path, const lar_bytes *bytes, lar_image *image,
                           lar_error *error) {
    (void)bytes;
    *image = (lar_image){0};
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "%s: this build of Lariat reads no NIfTI; install libnifti-dev and build "
                    "Lariat again, or write the image as .nrrd",
                    path);
}

#endif
