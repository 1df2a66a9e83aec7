/* What label images of all kinds have in common, and real ones. */
#include "meshing/image_bytes.h"

#include <sys/stat.h>
#include <unistd.h>

#include "meshing/image/parts.h"

#define FOLDER LAR_TEST_BUILD "/image"

#define HEADER                                                                                     \
    "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 3 2 2\nencoding: raw\nspacings: 1 2 3\n"          \
    "Segment0_LabelValue:=5\nSegment0_Name:=five\n\n"

static void save_nrrd(const char *path) {
    lar_bytes bytes = {0};
    append(&bytes, HEADER, strlen(HEADER));
    append_labels(&bytes, U8, false);
    save(&bytes, path);
    lar_bytes_free(&bytes);
}

static void save_text(const char *path, const char *text) {
    lar_bytes bytes = {0};
    append(&bytes, text, strlen(text));
    save(&bytes, path);
    lar_bytes_free(&bytes);
}

static void expect_unread(const char *path, lar_status status, const char *words) {
    lar_image image;
    lar_error error = {0};
    assert_int_equal(lar_image_read(path, &image, &error), status);
    expect_words(&error, words);
    assert_null(image.source); /* cleared */
    assert_null(image.label);
    assert_null(image.name);
}

static void by_extension(void **state) {
    (void)state;
    mkdir(FOLDER, 0777);
    save_nrrd(FOLDER "/a.seg.NRRD");
    lar_image image;
    lar_error error = {0};
    if (lar_image_read(FOLDER "/a.seg.NRRD", &image, &error)) fail_msg("%s", error.message);
    expect_labels(&image, U8);
    static int64_t count[LAR_IMAGE_LABEL_MAX + 1];
    count[77] = 1;
    lar_image_count(&image, count);
    assert_int_equal(count[0], 4);
    assert_int_equal(count[1], 2);
    assert_int_equal(count[255], 1);
    assert_int_equal(count[77], 0);
    assert_below(fabs(lar_image_voxel_volume(&image) - 6e-9), 1e-20);

    /* The same by the public calls. */
    lar_image *open = NULL;
    lar_image_info info;
    if (lar_image_open(FOLDER "/a.seg.NRRD", &open, &error)) fail_msg("%s", error.message);
    lar_image_inspect(open, &info);
    size_t voxels = (size_t)info.size[0] * (size_t)info.size[1] * (size_t)info.size[2];
    assert_memory_equal(info.size, image.size, sizeof info.size);
    assert_memory_equal(info.to_world, image.to_world, sizeof info.to_world);
    assert_memory_equal(info.label, image.label, voxels * sizeof *info.label);
    assert_int_equal(info.names, image.name_count);
    for (int32_t n = 0; n < info.names; n++) {
        int32_t label = -1;
        assert_string_equal(lar_image_name(open, n, &label), image.name[n].name);
        assert_int_equal(label, image.name[n].label);
    }
    assert_null(lar_image_name(open, -1, NULL));
    assert_null(lar_image_name(open, info.names, NULL));
    lar_image_destroy(open);
    lar_image_clear(&image);
    lar_image_clear(&image); /* once more is fine */

    static const char *const IMAGES[] = {"a.nii", "x/a.NII.gz", "a.nrrd", "a.nhdr"};
    static const char *const OTHERS[] = {"a.gz", ".nii", "a.stl", "nrrd", "a.nii/b", "a.nrrd.gz"};
    for (int i = 0; i < 4; i++) assert_true(lar_image_ending(IMAGES[i]));
    for (int i = 0; i < 6; i++) assert_false(lar_image_ending(OTHERS[i]));

    expect_unread(FOLDER "/a.png", LAR_ERROR_UNSUPPORTED, "a.png: |.nii.gz|.nrrd");
    expect_unread(FOLDER "/a.hdr", LAR_ERROR_UNSUPPORTED, "a.hdr: |two files|.nii.gz");
    expect_unread(FOLDER "/a.img.gz", LAR_ERROR_UNSUPPORTED, "two files");
    expect_unread(FOLDER "/none.nii.gz", LAR_ERROR_IO, "none.nii.gz: cannot be opened");
    save_text(FOLDER "/bad.nrrd", HEADER "few");
    expect_unread(FOLDER "/bad.nrrd", LAR_ERROR_FORMAT, "bad.nrrd: |12 bytes|holds 3;");
    save_text(FOLDER "/bad.nii", "no image");
#ifdef LAR_TEST_NIFTI
    expect_unread(FOLDER "/bad.nii", LAR_ERROR_FORMAT, "bad.nii: ");
#else
    expect_unread(FOLDER "/bad.nii", LAR_ERROR_UNSUPPORTED, "libnifti-dev");
#endif
}

/* 64 MB of zeros behind 12 voxels: counted, kept nowhere, and refused. */
static void bomb(void **state) {
    (void)state;
    lar_bytes bytes = {0};
    append_labels(&bytes, U8, false);
    append(&bytes, NULL, 64 << 20);
    gzip_from(&bytes, 0);
    assert_true(bytes.size < 70000);
    lar_error error = {0};
    lar_image image = {.source = lar_strdup("bomb.nii.gz")};
    lar_image_stream stream;
    const int64_t size[3] = {3, 2, 2}, too_large[3] = {500, 500, 300};
    assert_int_equal(
        lar_image_stream_open(&stream, "bomb.nii.gz", bytes.data, bytes.size, true, &error),
        LAR_OK);
    assert_int_equal(lar_image_allocate(&image, too_large, 1, &stream, &error), LAR_ERROR_FORMAT);
    assert_null(image.label);
    assert_int_equal(lar_image_allocate(&image, size, 1, &stream, &error), LAR_OK);
    assert_int_equal(lar_image_fill(&image, &stream, LAR_VOXEL_U8, false, 1, 0, &error),
                     LAR_ERROR_FORMAT);
    expect_words(&error, "promises 12 bytes|67108864 more follow");
    lar_image_stream_close(&stream);
    lar_image_clear(&image);
    lar_bytes_free(&bytes);
}

/* ---- names ---------------------------------------------------------------------------------- */

static void open_plain(lar_image *image) {
    mkdir(FOLDER, 0777);
    save_nrrd(FOLDER "/a.nrrd");
    lar_error error = {0};
    if (lar_image_read(FOLDER "/a.nrrd", image, &error)) fail_msg("%s", error.message);
}

static void expect_names(const char *text, int count, const lar_label_name *wanted) {
    lar_image image;
    lar_error error = {0};
    open_plain(&image);
    save_text(FOLDER "/names", text);
    if (lar_image_read_names(FOLDER "/names", &image, &error)) fail_msg("%s", error.message);
    assert_int_equal(image.name_count, count);
    for (int n = 0; n < count; n++) {
        assert_int_equal(image.name[n].label, wanted[n].label);
        assert_string_equal(image.name[n].name, wanted[n].name);
    }
    lar_image_clear(&image);
}

static void lists_of_names(void **state) {
    (void)state;
    /* the columns' titles, further columns, quotes; the image's own name stays */
    expect_names("label,name,colour\n1, spleen ,red\n300,\"a, b\",blue\n", 3,
                 (lar_label_name[]){{1, "spleen"}, {5, "five"}, {300, "a, b"}});
    expect_names("# comment\r\n\r\n2 kidney_right 0 0 0\r\n 1\tspleen\r\n", 3,
                 (lar_label_name[]){{1, "spleen"}, {2, "kidney_right"}, {5, "five"}});
    /* ITK-SNAP's columns; a name that replaces another; no line end at the end */
    expect_names("0 0 0 0 0 0 0 \"Clear Label\"\n5 255 0 0 1 1 1 \"Label 5\"\n5 9 9 \"last\"", 2,
                 (lar_label_name[]){{0, "Clear Label"}, {5, "last"}});
    expect_names("65535;a\x1b[31m;x\n", 2, (lar_label_name[]){{5, "five"}, {65535, "a [31m"}});
    /* a spreadsheet's byte order mark */
    expect_names("\xef\xbb\xbf"
                 "7,liver\n8,spleen\n",
                 3, (lar_label_name[]){{5, "five"}, {7, "liver"}, {8, "spleen"}});
}

static void bad_names(void **state) {
    (void)state;
    static const struct {
        const char *text, *words;
    } BAD[] = {{"label,name\nliver,5\n", "names:2: |LABEL,NAME"},
               {"1,liver\nspleen,2\n", "names:2: |does not begin with a label"},
               {"1,liver\n65536,x\n", "names:2: label 65536 is not between 0 and 65535"},
               {"-1,liver\n", "names:1: label -1 is not between"},
               {"1,liver\n2,\n", "names:2: label 2 has no name"},
               {"3\n", "names:1: label 3 has no name"},
               {"label,name\n", "names: the file names no label"},
               {"\n\n", "names: the file names no label"}};
    lar_image image;
    open_plain(&image);
    for (size_t b = 0; b < sizeof BAD / sizeof BAD[0]; b++) {
        lar_error error = {0};
        save_text(FOLDER "/names", BAD[b].text);
        assert_int_equal(lar_image_read_names(FOLDER "/names", &image, &error), LAR_ERROR_FORMAT);
        expect_words(&error, BAD[b].words);
        assert_int_equal(image.name_count, 1); /* as before */
        assert_string_equal(image.name[0].name, "five");
    }
    lar_error error = {0};
    assert_int_equal(lar_image_read_names(FOLDER "/none", &image, &error), LAR_ERROR_IO);
    lar_image_clear(&image);
}

/* ---- real images ---------------------------------------------------------------------------- */

static void read_shared(const char *name, lar_image *image) {
    char path[1000];
    snprintf(path, sizeof path, "%s/data/labels/%s", LAR_TEST_SHARED, name);
    bool there = access(path, R_OK) == 0;
    if (!there) print_message("skipped: no shared data\n");
#ifndef LAR_TEST_NIFTI
    if (strstr(name, ".nii")) {
        there = false;
        print_message("skipped: built without libnifti\n");
    }
#endif
    if (!there) skip();
    lar_error error = {0};
    if (lar_image_read(path, image, &error)) fail_msg("%s", error.message);
}

/* Voxels of a label, and their centre in the world. */
static int64_t centre_of(const lar_image *image, int label, double centre[3]) {
    int64_t count = 0;
    double sum[4] = {0};
    const uint16_t *next = image->label;
    for (int k = 0; k < image->size[2]; k++)
        for (int j = 0; j < image->size[1]; j++)
            for (int i = 0; i < image->size[0]; i++) {
                if (*next++ != label) continue;
                count++;
                sum[0] += i, sum[1] += j, sum[2] += k;
            }
    sum[3] = (double)count;
    for (int c = 0; c < 3; c++) {
        centre[c] = 0;
        for (int d = 0; d < 4; d++) centre[c] += image->to_world[c][d] * sum[d] / (double)count;
    }
    return count;
}

static const char *name_of(const lar_image *image, int label) {
    for (int32_t n = 0; n < image->name_count; n++)
        if (image->name[n].label == label) return image->name[n].name;
    return "";
}

static void abdomen(void **state) {
    (void)state;
    lar_image image;
    read_shared("totalseg_abdomen_pelvis_3mm.nii.gz", &image);
    assert_int_equal(image.size[0], 122);
    assert_int_equal(image.size[1], 101);
    assert_int_equal(image.size[2], 112);
    assert_below(fabs(lar_image_voxel_volume(&image) - 27e-9), 1e-16);
    lar_error error = {0};
    if (lar_image_read_names(LAR_TEST_SHARED "/data/labels/totalseg_total_labels.csv", &image,
                             &error))
        fail_msg("%s", error.message);
    static const struct {
        int label;
        const char *name;
        int64_t voxels;
    } KNOWN[] = {{5, "liver", 41692},
                 {3, "kidney_left", 5090},
                 {4, "gallbladder", 1319},
                 {21, "urinary_bladder", 17756}};
    double centre[4][3];
    for (int n = 0; n < 4; n++) {
        assert_string_equal(name_of(&image, KNOWN[n].label), KNOWN[n].name);
        assert_int_equal(centre_of(&image, KNOWN[n].label, centre[n]), KNOWN[n].voxels);
    }
    assert_true(centre[0][0] > 0.05);                /* the liver: right, */
    assert_true(centre[1][0] < -0.05);               /* the left kidney: left, */
    assert_true(centre[0][1] > centre[1][1] + 0.04); /* behind the liver, */
    assert_true(centre[0][2] > centre[3][2] + 0.20); /* and the bladder below. */
    lar_image_clear(&image);
}

static void brain(void **state) {
    (void)state;
    lar_image image;
    read_shared("mricron_brodmann.nii.gz", &image);
    assert_int_equal(image.size[0], 181);
    assert_int_equal(image.size[1], 217);
    assert_int_equal(image.size[2], 181);
    assert_below(fabs(lar_image_voxel_volume(&image) - 1e-9), 1e-17);
    static int64_t count[LAR_IMAGE_LABEL_MAX + 1];
    lar_image_count(&image, count);
    int labels = 0;
    for (int l = 1; l <= LAR_IMAGE_LABEL_MAX; l++) labels += count[l] > 0;
    assert_int_equal(labels, 41);
    double motor[3], visual[3];
    centre_of(&image, 4, motor); /* Brodmann's areas 4 and 17: on top, and at the back */
    centre_of(&image, 17, visual);
    assert_true(motor[2] > visual[2] + 0.03);
    assert_true(visual[1] < motor[1] - 0.04);
    lar_image_clear(&image);
}

static void chest(void **state) {
    (void)state;
    lar_image image;
    read_shared("slicerio_chest.seg.nrrd", &image);
    assert_int_equal(image.size[0], 128);
    assert_int_equal(image.size[1], 128);
    assert_int_equal(image.size[2], 34);
    assert_below(fabs(lar_image_voxel_volume(&image) / (3.04687595e-3 * 3.04687595e-3 * 10e-3) - 1),
                 1e-8);
    assert_int_equal(image.name_count, 7);
    assert_string_equal(name_of(&image, 1), "ribs");
    assert_string_equal(name_of(&image, 5), "right lung");
    assert_string_equal(name_of(&image, 6), "left lung");
    double right[3], left[3], cervical[3], lumbar[3];
    assert_int_equal(centre_of(&image, 5, right), 34450);
    centre_of(&image, 6, left);
    centre_of(&image, 2, cervical);
    centre_of(&image, 4, lumbar);
    assert_true(right[0] > 0.05 && left[0] < -0.05);
    assert_true(cervical[2] > lumbar[2] + 0.2);
    assert_true(right[1] > lumbar[1] + 0.05);
    lar_image_clear(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_extension), cmocka_unit_test(bomb),    cmocka_unit_test(lists_of_names),
        cmocka_unit_test(bad_names),    cmocka_unit_test(abdomen), cmocka_unit_test(brain),
        cmocka_unit_test(chest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
