/* NIfTI: headers laid down byte by byte, so that the reader's library is not its own judge. */
#include "meshing/image_bytes.h"

#ifdef LAR_TEST_NIFTI
static const bool with_library = true;
#else
static const bool with_library = false;
#endif

typedef struct nifti {
    int version;
    bool big, packed;
    value_type type;
    int datatype; /* 0: that of `type` */
    int64_t dim[8];
    double pixdim[8], offset, slope, intercept;
    int units, qform, sform;
    double quaternion[3], shift[3], row[3][4];
    const char *magic; /* NULL: that of one file */
} nifti;

static nifti plain(void) {
    return (nifti){.version = 1,
                   .dim = {3, 3, 2, 2, 1, 1, 1, 1},
                   .pixdim = {1, 1.5, 2, 2.5, 0, 0, 0, 0},
                   .units = 2,
                   .sform = 1,
                   .row = {{1.5, 0, 0, -10}, {0, 2, 0, 20}, {0, 0, 2.5, -30}}};
}

static const double PLAIN_WORLD[3][4] = {
    {1.5e-3, 0, 0, -10e-3}, {0, 2e-3, 0, 20e-3}, {0, 0, 2.5e-3, -30e-3}};

static void header_one(const nifti *n, unsigned char *h) {
    bool big = n->big;
    place_word(h, 348, 4, big);
    for (int d = 0; d < 8; d++) {
        place_word(h + 40 + 2 * d, (uint64_t)n->dim[d], 2, big);
        place_float(h + 76 + 4 * d, (float)n->pixdim[d], big);
    }
    place_word(h + 70, (uint64_t)n->datatype, 2, big);
    place_word(h + 72, 8 * VALUE_TYPE[n->type].size, 2, big);
    place_float(h + 108, (float)n->offset, big);
    place_float(h + 112, (float)n->slope, big);
    place_float(h + 116, (float)n->intercept, big);
    h[123] = (unsigned char)n->units;
    place_word(h + 252, (uint64_t)n->qform, 2, big);
    place_word(h + 254, (uint64_t)n->sform, 2, big);
    for (int c = 0; c < 3; c++) {
        place_float(h + 256 + 4 * c, (float)n->quaternion[c], big);
        place_float(h + 268 + 4 * c, (float)n->shift[c], big);
        for (int d = 0; d < 4; d++) place_float(h + 280 + 16 * c + 4 * d, (float)n->row[c][d], big);
    }
    memcpy(h + 344, n->magic ? n->magic : "n+1", 4);
}

static void header_two(const nifti *n, unsigned char *h) {
    bool big = n->big;
    place_word(h, 540, 4, big);
    memcpy(h + 4, n->magic ? n->magic : "n+2\0\r\n\032\n", 8);
    place_word(h + 12, (uint64_t)n->datatype, 2, big);
    place_word(h + 14, 8 * VALUE_TYPE[n->type].size, 2, big);
    for (int d = 0; d < 8; d++) {
        place_word(h + 16 + 8 * d, (uint64_t)n->dim[d], 8, big);
        place_double(h + 104 + 8 * d, n->pixdim[d], big);
    }
    place_word(h + 168, (uint64_t)n->offset, 8, big);
    place_double(h + 176, n->slope, big);
    place_double(h + 184, n->intercept, big);
    place_word(h + 344, (uint64_t)n->qform, 4, big);
    place_word(h + 348, (uint64_t)n->sform, 4, big);
    for (int c = 0; c < 3; c++) {
        place_double(h + 352 + 8 * c, n->quaternion[c], big);
        place_double(h + 376 + 8 * c, n->shift[c], big);
        for (int d = 0; d < 4; d++) place_double(h + 400 + 32 * c + 8 * d, n->row[c][d], big);
    }
    place_word(h + 500, (uint64_t)n->units, 4, big);
}

/* The header, and what lies between it and the voxels. */
static lar_bytes header_of(nifti n) {
    unsigned char h[544] = {0};
    size_t end = n.version == 1 ? 352 : 544;
    if (n.offset == 0) n.offset = (double)end;
    if (n.datatype == 0) n.datatype = VALUE_TYPE[n.type].nifti;
    if (n.version == 1)
        header_one(&n, h);
    else
        header_two(&n, h);
    lar_bytes bytes = {0};
    append(&bytes, h, end);
    if (n.offset > (double)end && n.offset < 4096) append(&bytes, NULL, (size_t)n.offset - end);
    return bytes;
}

static lar_bytes file_of(nifti n) {
    lar_bytes bytes = header_of(n);
    append_labels(&bytes, n.type, n.big);
    if (n.packed) gzip_from(&bytes, 0);
    return bytes;
}

static void read_good(nifti n, lar_image *image) {
    lar_bytes bytes = file_of(n);
    parse_good(lar_nifti_parse, "a.nii", &bytes, image);
    lar_bytes_free(&bytes);
}

static void expect_nifti_world(nifti n, const double world[3][4]) {
    lar_image image;
    read_good(n, &image);
    expect_world(&image, world);
    lar_image_clear(&image);
}

static void expect_refused(nifti n, lar_status status, const char *words) {
    lar_bytes bytes = file_of(n);
    expect_bad(lar_nifti_parse, "a.nii", &bytes, status, words);
    lar_bytes_free(&bytes);
}

/* ---- what is read --------------------------------------------------------------------------- */

static void every_type(void **state) {
    (void)state;
    for (int way = 0; way < VALUE_TYPES * 8; way++) {
        nifti n = plain();
        n.type = (value_type)(way / 8);
        n.version = way & 1 ? 2 : 1;
        n.big = way & 2;
        n.packed = way & 4;
        n.units = n.version == 1 ? 2 : 2 | 8; /* seconds do not matter */
        lar_image image;
        read_good(n, &image);
        expect_labels(&image, n.type);
        expect_world(&image, PLAIN_WORLD);
        assert_below(fabs(lar_image_voxel_volume(&image) - 7.5e-9), 1e-17);
        assert_int_equal(image.name_count, 0);
        lar_image_clear(&image);
    }
}

static void units(void **state) {
    (void)state;
    static const struct {
        int code;
        double metres;
    } UNITS[] = {{0, 1e-3}, {1, 1}, {2, 1e-3}, {3, 1e-6}};
    for (int u = 0; u < 4; u++) {
        double world[3][4];
        for (int c = 0; c < 3; c++)
            for (int d = 0; d < 4; d++) world[c][d] = PLAIN_WORLD[c][d] * 1e3 * UNITS[u].metres;
        nifti n = plain();
        n.units = UNITS[u].code;
        expect_nifti_world(n, world);
    }
}

/* The map of a quaternion, from its rotation's axis and angle (Rodrigues). */
static void turned(const double axis[3], double angle, const double *size, double qfac,
                   const double shift[3], double world[3][4]) {
    double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            int k = 3 - i - j;
            double cross = i == j ? 0 : (j == (i + 1) % 3 ? -axis[k] : axis[k]) * s;
            double r = (i == j) * c + (1 - c) * axis[i] * axis[j] + cross;
            world[i][j] = 1e-3 * r * size[j] * (j == 2 ? qfac : 1);
        }
        world[i][3] = 1e-3 * shift[i];
    }
}

static void oblique_and_left_handed(void **state) {
    (void)state;
    const double axis[3] = {2. / 3, -1. / 3, 2. / 3}, angle = 0.7, shift[3] = {5, -6, 7};
    for (int way = 0; way < 4; way++) {
        nifti n = plain();
        n.version = way & 1 ? 2 : 1;
        n.pixdim[0] = way & 2 ? -1 : 1;
        double world[3][4];
        turned(axis, angle, n.pixdim + 1, n.pixdim[0], shift, world);
        nifti with_sform = n, with_qform = n;
        for (int c = 0; c < 3; c++)
            for (int d = 0; d < 4; d++) with_sform.row[c][d] = 1e3 * world[c][d];
        expect_nifti_world(with_sform, world);
        with_qform.sform = 0;
        with_qform.qform = 1;
        for (int c = 0; c < 3; c++) {
            with_qform.quaternion[c] = axis[c] * sin(angle / 2);
            with_qform.shift[c] = shift[c];
        }
        expect_nifti_world(with_qform, world);
        with_qform.sform = 2; /* has its rows of `plain`, and is preferred */
        expect_nifti_world(with_qform, PLAIN_WORLD);
    }
}

static void sizes_alone(void **state) {
    (void)state;
    nifti n = plain();
    n.sform = 0;
    const double world[3][4] = {{1.5e-3, 0, 0, 0}, {0, 2e-3, 0, 0}, {0, 0, 2.5e-3, 0}};
    expect_nifti_world(n, world);
}

static void more_that_is_fine(void **state) {
    (void)state;
    lar_image image;
    nifti n = plain();
    n.offset = 416; /* an extension between header and voxels */
    n.packed = true;
    read_good(n, &image);
    expect_labels(&image, U8);
    lar_image_clear(&image);
    n = plain();
    n.dim[0] = 2; /* a slice: what is said of further axes does not count */
    n.dim[1] = 12, n.dim[2] = 1, n.dim[3] = 77;
    read_good(n, &image);
    assert_int_equal(image.size[2], 1);
    lar_image_clear(&image);
    n = plain();
    n.dim[0] = 5;
    read_good(n, &image);
    expect_labels(&image, U8);
    lar_image_clear(&image);
}

static void slopes(void **state) {
    (void)state;
    lar_image image;
    nifti n = plain();
    n.type = I16;
    n.slope = NAN;
    n.intercept = 3; /* without a slope it does not count */
    read_good(n, &image);
    expect_labels(&image, I16);
    lar_image_clear(&image);
    n.slope = 2;
    read_good(n, &image);
    for (int v = 0; v < VOXELS; v++) assert_int_equal(image.label[v], 2 * label_of(I16, v) + 3);
    lar_image_clear(&image);
    n.slope = 0.1;
    expect_refused(n, LAR_ERROR_FORMAT, "voxel (1, 0, 0) has the value 3.1|no label map");
    n.slope = 1;
    n.intercept = INFINITY;
    expect_refused(n, LAR_ERROR_FORMAT, "scl_inter|no number");
    n = plain(); /* 10, 20, 30 .. times 0.1f */
    n.slope = 0.1;
    lar_bytes bytes = header_of(n);
    for (int v = 0; v < VOXELS; v++) append_value(&bytes, U8, 10 * v, false);
    parse_good(lar_nifti_parse, "a.nii", &bytes, &image);
    for (int v = 0; v < VOXELS; v++) assert_int_equal(image.label[v], v);
    lar_image_clear(&image);
    lar_bytes_free(&bytes);
}

/* Some programs write several members one after the other. */
static void gzip_members(void **state) {
    (void)state;
    lar_bytes whole = file_of(plain()), bytes = {0};
    for (size_t from = 0; from < whole.size; from += 100) {
        size_t piece = whole.size - from < 100 ? whole.size - from : 100, start = bytes.size;
        append(&bytes, whole.data + from, piece);
        gzip_from(&bytes, start);
    }
    append(&bytes, "\0\0\0", 3); /* padding */
    lar_image image;
    parse_good(lar_nifti_parse, "a.nii.gz", &bytes, &image);
    expect_labels(&image, U8);
    lar_image_clear(&image);
    lar_bytes_free(&bytes);
    lar_bytes_free(&whole);
}

/* ---- what is refused ------------------------------------------------------------------------ */

static void bad_axes(void **state) {
    (void)state;
    nifti n = plain();
    n.dim[0] = 4, n.dim[4] = 5;
    expect_refused(n, LAR_ERROR_UNSUPPORTED, "a.nii: |4 axes|5 volumes|one volume");
    n.dim[0] = 9;
    expect_refused(n, LAR_ERROR_FORMAT, "9 axes");
    n.dim[0] = 0;
    expect_refused(n, LAR_ERROR_FORMAT, "0 axes");
    n = plain();
    n.dim[2] = 0;
    expect_refused(n, LAR_ERROR_FORMAT, "0 voxels along axis j");
    n.dim[2] = -7;
    expect_refused(n, LAR_ERROR_FORMAT, "-7 voxels along axis j");
    n = plain();
    n.magic = "ni1";
    expect_refused(n, LAR_ERROR_UNSUPPORTED, "two files|.nii.gz");
    n.version = 2;
    n.magic = "ni2\0\r\n\032\n";
    expect_refused(n, LAR_ERROR_UNSUPPORTED, "two files|.nii.gz");
}

static void claims(void **state) {
    (void)state;
    nifti n = plain();
    n.version = 2;
    for (int d = 1; d < 4; d++) n.dim[d] = 8000;
    expect_refused(n, LAR_ERROR_UNSUPPORTED, "8000 x 8000 x 8000|536870912");
    for (int d = 1; d < 4; d++) n.dim[d] = INT64_MAX;
    expect_refused(n, LAR_ERROR_UNSUPPORTED, "axis i, more than 8192");
    n.dim[1] = 4, n.dim[2] = (int64_t)1 << 62, n.dim[3] = 1; /* 2^64 is 0 */
    expect_refused(n, LAR_ERROR_UNSUPPORTED, "axis j, more than 8192");
    for (int d = 1; d < 4; d++) n.dim[d] = 800; /* may be, but not here */
    expect_refused(n, LAR_ERROR_FORMAT, "512000000 bytes|holds 12;");
    n.packed = true;
    expect_refused(n, LAR_ERROR_FORMAT, "512000000 bytes|holds at most ");
}

static void bad_worlds(void **state) {
    (void)state;
    nifti n = plain();
    for (int d = 0; d < 4; d++) n.row[2][d] = n.row[1][d];
    expect_refused(n, LAR_ERROR_FORMAT, "0 m long along axis k");
    n.row[2][2] = n.row[1][2] = 3;
    expect_refused(n, LAR_ERROR_FORMAT, "in one plane");
    n = plain();
    n.row[1][3] = NAN;
    expect_refused(n, LAR_ERROR_FORMAT, "no number");
    n = plain();
    n.row[0][0] = 3e38;
    expect_refused(n, LAR_ERROR_FORMAT, "long along axis i");
    n = plain();
    n.row[0][3] = 1e12;
    expect_refused(n, LAR_ERROR_FORMAT, "from the world's origin");
    for (int form = 0; form < 2; form++) {
        n = plain();
        n.sform = 0;
        n.qform = form;
        n.pixdim[2] = 0;
        expect_refused(n, LAR_ERROR_FORMAT, "along axis j is 0");
        n.pixdim[2] = -2;
        expect_refused(n, LAR_ERROR_FORMAT, "along axis j is -2");
        n.pixdim[2] = NAN;
        expect_refused(n, LAR_ERROR_FORMAT, "along axis j is no number");
    }
    n = plain();
    n.sform = 0;
    n.qform = 1;
    n.quaternion[1] = NAN;
    expect_refused(n, LAR_ERROR_FORMAT, "no number");
    n = plain();
    n.units = 7;
    expect_refused(n, LAR_ERROR_FORMAT, "code 7");
}

static void bad_values(void **state) {
    (void)state;
    static const struct {
        value_type type;
        double value;
        const char *words;
    } BAD[] = {{F32, 0.25, "voxel (1, 1, 1) has the value 0.25|no label map|segment"},
               {F64, 1.0000001, "the value 1.0000001"},
               {F32, NAN, "the value no number"},
               {F64, -INFINITY, "the value no number"},
               {I16, -1024, "the value -1024"},
               {I64, -1, "the value -1"},
               {U32, 65536, "the value 65536"},
               {F32, 1e30, "the value 1.00000002e+30"}};
    for (size_t b = 0; b < sizeof BAD / sizeof BAD[0]; b++) {
        nifti n = plain();
        n.type = BAD[b].type;
        lar_bytes bytes = header_of(n);
        for (int v = 0; v < VOXELS; v++)
            append_value(&bytes, n.type, v == 10 ? BAD[b].value : 1, false);
        expect_bad(lar_nifti_parse, "a.nii", &bytes, LAR_ERROR_FORMAT, BAD[b].words);
        lar_bytes_free(&bytes);
    }
    nifti n = plain();
    n.datatype = 128;
    expect_refused(n, LAR_ERROR_UNSUPPORTED, "RGB24|no labels");
    n.datatype = 1792;
    expect_refused(n, LAR_ERROR_UNSUPPORTED, "COMPLEX128|no labels");
    n.datatype = 3333;
    expect_refused(n, LAR_ERROR_UNSUPPORTED, "3333|no labels");
}

static void cut_short(void **state) {
    (void)state;
    nifti n = plain();
    n.type = I32;
    lar_bytes bytes = file_of(n);
    bytes.size -= 5;
    expect_bad(lar_nifti_parse, "a.nii", &bytes, LAR_ERROR_FORMAT,
               "48 bytes of voxels|holds 43;|cut short");
    bytes.size = 350;
    expect_bad(lar_nifti_parse, "a.nii", &bytes, LAR_ERROR_FORMAT, "begin at byte 352|holds 350");
    bytes.size = 200;
    expect_bad(lar_nifti_parse, "a.nii", &bytes, LAR_ERROR_FORMAT,
               "does not begin with the header");
    memset(bytes.data, 'x', 200);
    expect_bad(lar_nifti_parse, "a.nii", &bytes, LAR_ERROR_FORMAT,
               "does not begin with the header");
    lar_bytes_free(&bytes);
    for (int version = 1; version < 3; version++) {
        n.version = version;
        n.offset = 100;
        expect_refused(n, LAR_ERROR_FORMAT, "vox_offset");
        n.offset = 1e9;
        expect_refused(n, LAR_ERROR_FORMAT, "begin at byte 1000000000");
    }
    n.version = 1;
    n.offset = 352.5;
    expect_refused(n, LAR_ERROR_FORMAT, "vox_offset");
    n.offset = NAN;
    expect_refused(n, LAR_ERROR_FORMAT, "vox_offset");
}

static void damaged_gzip(void **state) {
    (void)state;
    nifti n = plain();
    n.packed = true;
    lar_bytes bytes = file_of(n);
    size_t size = bytes.size;
    /* Every cut is noticed: within the voxels, the check sum, or the header. */
    for (bytes.size = 2; bytes.size < size; bytes.size++) {
        lar_image image;
        lar_error error = {0};
        assert_int_equal(lar_nifti_parse("a.nii.gz", &bytes, &image, &error), LAR_ERROR_FORMAT);
        expect_words(&error, "damaged|a.nii.gz");
        lar_image_clear(&image);
    }
    bytes.data[size - 6] ^= 1;
    expect_bad(lar_nifti_parse, "a.nii.gz", &bytes, LAR_ERROR_FORMAT, "check sum|damaged");
    lar_bytes_free(&bytes);
}

/* The check sum of a file that holds more than its header promises is looked at all the same; and
 * what follows is refused, within the stream and behind it. */
static void more_than_promised(void **state) {
    (void)state;
    for (int more = 1; more < 100000; more *= 7) {
        lar_bytes bytes = file_of(plain());
        append(&bytes, NULL, (size_t)more);
        expect_bad(lar_nifti_parse, "a.nii", &bytes, LAR_ERROR_FORMAT,
                   "promises 12 bytes|more follow them|damaged");
        gzip_from(&bytes, 0);
        expect_bad(lar_nifti_parse, "a.nii.gz", &bytes, LAR_ERROR_FORMAT,
                   "promises 12 bytes|more follow them|damaged");
        bytes.data[bytes.size - 6] ^= 1;
        expect_bad(lar_nifti_parse, "a.nii.gz", &bytes, LAR_ERROR_FORMAT, "check sum|damaged");
        lar_bytes_free(&bytes);
    }
    nifti n = plain();
    n.packed = true;
    lar_bytes bytes = file_of(n);
    append(&bytes, "\0\0more", 6);
    expect_bad(lar_nifti_parse, "a.nii.gz", &bytes, LAR_ERROR_FORMAT, "4 bytes that are no gzip");
    lar_bytes_free(&bytes);
}

/* A build without the library says how to get it. */
static int without_library(void) {
    lar_bytes bytes = file_of(plain());
    lar_image image;
    lar_error error = {0};
    bool says = lar_nifti_parse("a.nii", &bytes, &image, &error) == LAR_ERROR_UNSUPPORTED &&
                strstr(error.message, "install libnifti-dev");
    lar_bytes_free(&bytes);
    printf("skipped: built without libnifti\n");
    return says ? 77 : 1;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type),
        cmocka_unit_test(units),
        cmocka_unit_test(oblique_and_left_handed),
        cmocka_unit_test(sizes_alone),
        cmocka_unit_test(more_that_is_fine),
        cmocka_unit_test(slopes),
        cmocka_unit_test(gzip_members),
        cmocka_unit_test(bad_axes),
        cmocka_unit_test(claims),
        cmocka_unit_test(bad_worlds),
        cmocka_unit_test(bad_values),
        cmocka_unit_test(cut_short),
        cmocka_unit_test(damaged_gzip),
        cmocka_unit_test(more_than_promised),
    };
    return with_library ? cmocka_run_group_tests(tests, NULL, NULL) : without_library();
}
