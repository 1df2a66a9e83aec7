#include "meshing/image_bytes.h"

#include <sys/stat.h>

#define FOLDER LAR_TEST_BUILD "/image_nrrd"

#define SIZES "dimension: 3\nsizes: 3 2 2\n"
#define PLAIN "type: uchar\n" SIZES "encoding: raw\nspacings: 1.5 2 2.5\n"

static const double PLAIN_WORLD[3][4] = {{1.5e-3, 0, 0, 0}, {0, 2e-3, 0, 0}, {0, 0, 2.5e-3, 0}};

/* The first line, `fields`, an empty line and the labels as bytes. */
static lar_bytes file_of(const char *fields) {
    lar_bytes bytes = {0};
    append(&bytes, "NRRD0005\n", 9);
    append(&bytes, fields, strlen(fields));
    append(&bytes, "\n", 1);
    append_labels(&bytes, U8, false);
    return bytes;
}

static void read_good(const char *fields, lar_image *image) {
    lar_bytes bytes = file_of(fields);
    parse_good(lar_nrrd_parse, "a.nrrd", &bytes, image);
    lar_bytes_free(&bytes);
    expect_labels(image, U8);
}

static void expect_nrrd_world(const char *fields, const double world[3][4]) {
    lar_image image;
    read_good(fields, &image);
    expect_world(&image, world);
    lar_image_clear(&image);
}

static void expect_refused(const char *fields, lar_status status, const char *words) {
    lar_bytes bytes = file_of(fields);
    expect_bad(lar_nrrd_parse, "a.nrrd", &bytes, status, words);
    lar_bytes_free(&bytes);
}

/* ---- what is read --------------------------------------------------------------------------- */

static void every_type(void **state) {
    (void)state;
    static const char *const ENCODING[] = {"raw", "gzip", "GZ", "ascii"};
    for (int way = 0; way < VALUE_TYPES * 8; way++) {
        value_type type = (value_type)(way / 8);
        bool big = way & 1;
        int encoding = way / 2 % 4;
        char fields[300];
        snprintf(fields, sizeof fields,
                 "NRRD000%d\n# comment\ntype: %s\n" SIZES
                 "encoding: %s\n%s%sspacings: 1.5 2 2.5\n\n",
                 1 + way % 5, VALUE_TYPE[type].nrrd, ENCODING[encoding],
                 VALUE_TYPE[type].size > 1 ? "endian: " : "",
                 VALUE_TYPE[type].size == 1 ? "" : (big ? "big\n" : "little\n"));
        lar_bytes bytes = {0};
        append(&bytes, fields, strlen(fields));
        size_t start = bytes.size;
        if (encoding < 3) {
            append_labels(&bytes, type, big);
            if (encoding > 0) gzip_from(&bytes, start);
        } else {
            for (int v = 0; v < VOXELS; v++) {
                char word[20];
                snprintf(word, sizeof word, "%d%c", label_of(type, v), v % 3 == 2 ? '\n' : ' ');
                append(&bytes, word, strlen(word));
            }
        }
        lar_image image;
        parse_good(lar_nrrd_parse, "a.nrrd", &bytes, &image);
        expect_labels(&image, type);
        expect_world(&image, PLAIN_WORLD);
        lar_image_clear(&image);
        lar_bytes_free(&bytes);
    }
}

/* The same four numbers per axis, as the file's world turns them. */
static void spaces(void **state) {
    (void)state;
    static const struct {
        const char *space;
        double x, y;
    } SPACES[] = {{"space: left-posterior-superior", -1, -1},
                  {"space: LPS", -1, -1},
                  {"space: left-anterior-superior", -1, 1},
                  {"space: las", -1, 1},
                  {"space: right-anterior-superior", 1, 1},
                  {"space: RAS", 1, 1},
                  {"space: scanner-xyz", 1, 1},
                  {"space: 3D-right-handed", 1, 1},
                  {"space dimension: 3", 1, 1}};
    for (size_t s = 0; s < sizeof SPACES / sizeof SPACES[0]; s++) {
        char fields[400];
        /* oblique, left-handed or not, as the signs make it */
        snprintf(fields, sizeof fields,
                 "type: uchar\n" SIZES "encoding: raw\n%s\n"
                 "space directions: (3,0.4,0) (-0.3, 2 ,0.1)(0,-0.2,5)\n"
                 "space origin: (10,-20,30)\nkinds: domain domain domain\n",
                 SPACES[s].space);
        double x = 1e-3 * SPACES[s].x, y = 1e-3 * SPACES[s].y, z = 1e-3;
        const double world[3][4] = {{3 * x, -0.3 * x, 0, 10 * x},
                                    {0.4 * y, 2 * y, -0.2 * y, -20 * y},
                                    {0, 0.1 * z, 5 * z, 30 * z}};
        expect_nrrd_world(fields, world);
    }
}

static void units(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double metres;
    } UNITS[] = {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}, {"um", 1e-6}, {"", 1e-3}, {"microns", 1e-6}};
    for (size_t u = 0; u < sizeof UNITS / sizeof UNITS[0]; u++) {
        const char *name = UNITS[u].name;
        double world[3][4];
        for (int c = 0; c < 3; c++)
            for (int d = 0; d < 4; d++) world[c][d] = PLAIN_WORLD[c][d] * 1e3 * UNITS[u].metres;
        char fields[400];
        snprintf(fields, sizeof fields, PLAIN "units: \"%s\" \"%s\" \"%s\"\n", name, name, name);
        expect_nrrd_world(fields, world);
        world[0][0] = -world[0][0];
        world[1][1] = -world[1][1];
        snprintf(fields, sizeof fields,
                 "type: uchar\n" SIZES "encoding: raw\nspace: LPS\nspace directions: (1.5,0,0) "
                 "(0,2,0) (0,0,2.5)\nspace units: \"%s\" \"%s\" \"%s\"\n",
                 name, name, name);
        expect_nrrd_world(fields, world);
    }
}

static void names_of_segments(void **state) {
    (void)state;
    lar_image image;
    read_good(PLAIN "Segment1_LabelValue:=2\nSegment0_Name:=left lung: upper\n"
                    "Segment0_ID:=Segment_1\nSegment10_Name:=ribs\nSegment1_Name:=li\tver\n"
                    "Segment10_LabelValue:=1\nSegment0_LabelValue:=300\nSegment7_Name:=lost\n"
                    "Segmentation_Name:=x\nSegment0_Tags:=a.b: c|d\nSegment8_LabelValue:=9\n"
                    "Segment9_Name:=lost, too\n",
              &image);
    static const lar_label_name WANTED[] = {{1, "ribs"}, {2, "li ver"}, {300, "left lung: upper"}};
    assert_int_equal(image.name_count, 3);
    for (int n = 0; n < 3; n++) {
        assert_int_equal(image.name[n].label, WANTED[n].label);
        assert_string_equal(image.name[n].name, WANTED[n].name);
    }
    lar_image_clear(&image);
}

static void more_that_is_fine(void **state) {
    (void)state;
    expect_nrrd_world("type: uchar\r\ndimension: 3\r\nsizes: 3 2 2\r\nencoding: raw\r\n"
                      "Spacings: 1.5 2 2.5\r\ncontent: a:=b\r\nmeasurement frame: (1,0,0) "
                      "(0,1,0) (0,0,1)\r\n\r",
                      PLAIN_WORLD);
    /* without a space axes may say where they begin, at a face or in a middle */
    static const double face[3][4] = {
        {1.5e-3, 0, 0, 10.75e-3}, {0, 2e-3, 0, 0}, {0, 0, 2.5e-3, -3.75e-3}};
    static const double middle[3][4] = {
        {1.5e-3, 0, 0, 10e-3}, {0, 2e-3, 0, -1e-3}, {0, 0, 2.5e-3, -3.75e-3}};
    expect_nrrd_world(PLAIN "axis mins: 10 nan -5\n", face);
    expect_nrrd_world(PLAIN "axis mins: 10 -1 -5\ncenters: node node cell\n", middle);
    expect_nrrd_world(PLAIN "axis mins: 10 0 -5\nspace origin: (0,0,0)\n", PLAIN_WORLD);
    /* one layer of segments, or one point of time */
    expect_nrrd_world("type: uchar\ndimension: 4\nsizes: 1 3 2 2\nencoding: raw\nspace: RAS\n"
                      "space directions: none (1.5,0,0) (0,2,0) (0,0,2.5)\n",
                      PLAIN_WORLD);
    expect_nrrd_world("type: uchar\ndimension: 4\nsizes: 3 2 2 1\nencoding: raw\n"
                      "kinds: domain domain domain time\nspacings: 1.5 2 2.5 nan\n",
                      PLAIN_WORLD);
}

/* ---- data files ----------------------------------------------------------------------------- */

static void read_detached(const char *fields, const lar_bytes *data, lar_image *image) {
    save(data, FOLDER "/a.data");
    lar_bytes header = {0};
    append(&header, "NRRD0004\n", 9);
    append(&header, fields, strlen(fields));
    save(&header, FOLDER "/a.nhdr");
    lar_bytes_free(&header);
    lar_error error = {0};
    if (lar_image_read(FOLDER "/a.nhdr", image, &error)) fail_msg("%s", error.message);
}

static void detached(void **state) {
    (void)state;
    mkdir(FOLDER, 0777);
    static const char *const FIELDS[] = {
        PLAIN "data file: a.data",
        PLAIN "datafile: a.data\nbyte skip: 7\n",
        PLAIN "data file: a.data\nline skip: 2\n",
        PLAIN "data file: a.data\nlineskip: 1\nbyteskip: 3\n",
        PLAIN "data file: ./a.data\nbyte skip: -1\n",
    };
    static const char *const BEFORE[] = {"", "1234567", "one\ntwo\n", "\nabc", "anything"};
    for (int packed = 0; packed < 2; packed++)
        for (int f = 0; f < 4 + !packed; f++) {
            char fields[300], *raw;
            snprintf(fields, sizeof fields, "%s", FIELDS[f]);
            /* lines are skipped before the data are decompressed, bytes after */
            size_t lines = packed && strchr(BEFORE[f], '\n')
                               ? (size_t)(strrchr(BEFORE[f], '\n') - BEFORE[f]) + 1
                               : 0;
            lar_bytes data = {0};
            append(&data, BEFORE[f], strlen(BEFORE[f]));
            append_labels(&data, U8, false);
            if (packed) gzip_from(&data, lines);
            if (packed && (raw = strstr(fields, "raw"))) memcpy(raw, "gz ", 3);
            lar_image image;
            read_detached(fields, &data, &image);
            expect_labels(&image, U8);
            lar_image_clear(&image);
            lar_bytes_free(&data);
        }
}

static void bad_data_files(void **state) {
    (void)state;
    expect_refused(PLAIN "data file: LIST\na.raw\nb.raw\n", LAR_ERROR_UNSUPPORTED,
                   "a.nrrd:7: |several files|LIST");
    expect_refused(PLAIN "data file: slice%03d.raw 1 20 1\n", LAR_ERROR_UNSUPPORTED,
                   "a.nrrd:7: |several files|slice%03d");
    expect_refused(PLAIN "data file: no such file.raw\n", LAR_ERROR_IO,
                   "no such file.raw: cannot be opened");
    expect_refused(PLAIN "data file: .\n", LAR_ERROR_IO, "not a regular file");
    expect_refused(PLAIN "byte skip: 13\n", LAR_ERROR_FORMAT, "a.nrrd:7: byte skip \"13\" is more");
    expect_refused(PLAIN "byte skip: -2\n", LAR_ERROR_FORMAT, "byte skip \"-2\" is below 0");
    expect_refused(PLAIN "byte skip: x\n", LAR_ERROR_FORMAT, "byte skip \"x\" is no whole number");
    expect_refused(PLAIN "line skip: 3\n", LAR_ERROR_FORMAT, "line skip \"3\" is more than");
    expect_refused(PLAIN "line skip: -1\n", LAR_ERROR_FORMAT, "line skip \"-1\" is below 0");
    expect_refused(PLAIN "byte skip: 5\n", LAR_ERROR_FORMAT, "12 bytes of voxels|holds 7;");
}

/* ---- what is refused ------------------------------------------------------------------------ */

static void bad_headers(void **state) {
    (void)state;
    static const struct {
        const char *fields, *words;
    } BAD[] = {
        {"type: uchar\n" SIZES "spacings: 1 1 1\n", "lacks the field \"encoding\""},
        {PLAIN "axis mins: 1 2\n", "axis mins \"1 2\" has no number for each axis"},
        {SIZES "spacings: 1 1 1\nencoding: raw\n", "lacks the field \"type\""},
        {"type: uchar\nsizes: 3 2 2\n", "lacks the field \"dimension\""},
        {"type: uchar\ndimension: 3\n", "lacks the field \"sizes\""},
        {"type: short\n" SIZES "spacings: 1 1 1\nencoding: raw\n", "lacks the field \"endian\""},
        {"type: short\n" SIZES "spacings: 1 1 1\nencoding: raw\nendian: middle\n", "middle"},
        {"type: block\n" SIZES "spacings: 1 1 1\nencoding: raw\n", "a.nrrd:2: type \"block\""},
        {"type: uchar\n" SIZES "spacings: 1 1 1\nencoding: bzip2\n", "\"bzip2\" is not read|gzip"},
        {"type: uchar\n" SIZES "spacings: 1 1 1\nencoding: hex\n", "\"hex\" is not read|gzip"},
        {"type: uchar\ndimension: 2\nsizes: 6 2\n", "dimension \"2\" is not 3"},
        {"type: uchar\ndimension: 5\nsizes: 3 2 2 1 1\n", "dimension \"5\" is not 3"},
        {"type: uchar\ndimension: three\nsizes: 3 2 2\n", "\"three\" is no whole number"},
        {"type: uchar\ndimension: 3\nsizes: 3 2\n", "sizes \"3 2\" are not"},
        {"type: uchar\ndimension: 3\nsizes: 3 2 2 2\n", "sizes \"3 2 2 2\" are not"},
        {"type: uchar\ndimension: 3\nsizes: 3 0 2\n", "sizes \"3 0 2\" are not"},
        {"type: uchar\ndimension: 3\nsizes: 3 2 -2\n", "sizes \"3 2 -2\" are not"},
        {PLAIN "encoding: raw\n", "a.nrrd:7: |\"encoding\" is there already, in line 5"},
        {PLAIN "spce: LPS\n", "a.nrrd:7: \"spce\" is no field"},
        {PLAIN "nothing at all\n", "a.nrrd:7: \"nothing at all\" is neither"},
        {PLAIN "space: \n", "a.nrrd:7: the field \"space\" is empty"},
        {PLAIN "Segment0_Name:=a\nSegment0_LabelValue:=70000\n", "a.nrrd:8: |label"},
        {PLAIN "Segment0_Name:=a\nSegment0_LabelValue:=one\n", "a.nrrd:8: |label"},
    };
    for (size_t b = 0; b < sizeof BAD / sizeof BAD[0]; b++)
        expect_refused(BAD[b].fields, LAR_ERROR_FORMAT, BAD[b].words);
    lar_bytes bytes = file_of(PLAIN);
    bytes.data[7] = '6';
    expect_bad(lar_nrrd_parse, "a.nrrd", &bytes, LAR_ERROR_UNSUPPORTED, "version 6");
    bytes.data[3] = 'X';
    expect_bad(lar_nrrd_parse, "a.nrrd", &bytes, LAR_ERROR_FORMAT, "does not begin with");
    bytes.size = 3;
    expect_bad(lar_nrrd_parse, "a.nrrd", &bytes, LAR_ERROR_FORMAT, "does not begin with");
    lar_bytes_free(&bytes);
    bytes = file_of(PLAIN);
    bytes.size -= VOXELS + 1; /* the empty line, too */
    expect_bad(lar_nrrd_parse, "a.nrrd", &bytes, LAR_ERROR_FORMAT, "no empty line");
    lar_bytes_free(&bytes);
}

#define IN_SPACE   "type: uchar\n" SIZES "encoding: raw\nspace: LPS\n"
#define DIRECTIONS "space directions: (1,0,0) (0,1,0) (0,0,1)\n"

static void bad_spaces(void **state) {
    (void)state;
    static const struct {
        const char *fields, *words;
    } BAD[] = {
        {IN_SPACE, "neither \"space directions\" nor \"spacings\""},
        {PLAIN "space: 3D-left-handed\n", "\"3D-left-handed\"|left-posterior-superior"},
        {PLAIN "space: left-posterior-superior-time\n", "left-posterior-superior-time"},
        {PLAIN "space dimension: 2\n", "space dimension \"2\" is not 3"},
        {IN_SPACE "space directions: (1,0,0) (0,1,0)\n", "a.nrrd:7: space directions|each axis"},
        {IN_SPACE "space directions: (1,0) (0,1) (0,0)\n", "is not a vector"},
        {IN_SPACE "space directions: (1,0,0,0) (0,1,0) (0,0,1)\n", "is not a vector"},
        {IN_SPACE "space directions: (1,0,0 0,1,0 0,0,1\n", "is not a vector"},
        {IN_SPACE "space directions: (1,0,0) (0,1,0) (0,0,1) (1,1,1)\n", "more than one entry"},
        {IN_SPACE "space directions: none (0,1,0) (0,0,1)\n", "three axes in space"},
        {IN_SPACE "space directions: (1,0,0) (0,1,0) (0,0,0)\n", "0 m long along axis k"},
        {IN_SPACE "space directions: (1,0,0) (0,1,0) (1,1,0)\n", "in one plane"},
        {IN_SPACE "space directions: (1,0,0) (0,nan,0) (0,0,1)\n", "no number"},
        {IN_SPACE DIRECTIONS "space origin: (1,2)\n", "space origin \"(1,2)\" is no vector"},
        {IN_SPACE DIRECTIONS "space origin: (1,2,inf)\n", "no number"},
        {IN_SPACE DIRECTIONS "space units: \"mm\" \"mm\" \"cm\"\n", "different units"},
        {IN_SPACE DIRECTIONS "space units: \"furlong\" \"mm\" \"cm\"\n", "no unit of length"},
        {"type: uchar\n" SIZES "encoding: raw\nspacings: 1 0 1\n", "larger than 0"},
        {"type: uchar\n" SIZES "encoding: raw\nspacings: 1 nan 1\n", "larger than 0"},
        {"type: uchar\n" SIZES "encoding: raw\nspacings: 1 1\n", "no number for each axis"},
    };
    for (size_t b = 0; b < sizeof BAD / sizeof BAD[0]; b++)
        expect_refused(BAD[b].fields, LAR_ERROR_FORMAT, BAD[b].words);
}

#define FOUR "type: uchar\ndimension: 4\nencoding: raw\nspace: LPS\n"

static void four_axes(void **state) {
    (void)state;
    expect_refused(FOUR "sizes: 2 3 2 1\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
                        "Segment0_Name:=a\nSegment0_Layer:=1\n",
                   LAR_ERROR_UNSUPPORTED, "overlap|2 layers|label map");
    expect_refused(FOUR "sizes: 3 2 1 2\nspace directions: (1,0,0) (0,1,0) (0,0,1) none\n",
                   LAR_ERROR_UNSUPPORTED, "4 axes|2 values for each voxel along axis 3");
    expect_refused(FOUR "sizes: 3 2 1 2\nspacings: 1 1 1 1\n", LAR_ERROR_FORMAT,
                   "three axes in space");
}

static void claims(void **state) {
    (void)state;
#define CLAIM(sizes) "type: double\nendian: big\ndimension: 3\nspacings: 1 1 1\nsizes: " sizes "\n"
    expect_refused(CLAIM("8000 8000 8000") "encoding: raw\n", LAR_ERROR_UNSUPPORTED,
                   "8000 x 8000 x 8000|536870912");
    expect_refused(CLAIM("9223372036854775807 9223372036854775807 3") "encoding: gzip\n",
                   LAR_ERROR_UNSUPPORTED, "axis i, more than 8192");
    expect_refused(
        CLAIM("9223372036854775807 9223372036854775807 3") "encoding: raw\nbyte skip: -1\n",
        LAR_ERROR_UNSUPPORTED, "axis i, more than 8192");
    expect_refused(CLAIM("800 800 800") "encoding: raw\n", LAR_ERROR_FORMAT,
                   "4096000000 bytes|holds 12;");
    expect_refused(CLAIM("800 800 800") "encoding: gzip\n", LAR_ERROR_FORMAT,
                   "4096000000 bytes|holds at most ");
    expect_refused(CLAIM("800 800 800") "encoding: ascii\n", LAR_ERROR_FORMAT,
                   "512000000 bytes|holds 12;");
}

static void bad_values(void **state) {
    (void)state;
    static const char HEADER[] =
        "NRRD0001\ntype: float\n" SIZES "encoding: text\nspacings: 1 1 1\n\n";
    static const struct {
        const char *numbers, *words;
    } BAD[] = {{"1 2 3 4 5 6 7 8 9 10 11", "12 numbers|the file ends after 11"},
               {"1 2 3 4 5 6 7 8 9 10 11 liver", "something that is no number comes after 11"},
               {"1 2 3 4 5 6 7 8 9 10 11.5 12", "voxel (1, 1, 1) has the value 11.5|no label map"},
               {"1 2 3 4 5 6 7 8 9 10 nan 12", "voxel (1, 1, 1) has the value no number"},
               {"1 2 3 4 5 6 7 8 9 10 11 12 \n 13", "12 numbers|more follow them"},
               {"1 2 3 4 5 6 7 8 9 10 -1 12", "the value -1"}};
    for (size_t b = 0; b < sizeof BAD / sizeof BAD[0]; b++) {
        lar_bytes bytes = {0};
        append(&bytes, HEADER, strlen(HEADER));
        append(&bytes, BAD[b].numbers, strlen(BAD[b].numbers));
        expect_bad(lar_nrrd_parse, "a.nrrd", &bytes, LAR_ERROR_FORMAT, BAD[b].words);
        lar_bytes_free(&bytes);
    }
    lar_bytes bytes = file_of(PLAIN); /* no gzip */
    memcpy(strstr((char *)bytes.data, "raw"), "gz ", 3);
    expect_bad(lar_nrrd_parse, "a.nrrd", &bytes, LAR_ERROR_FORMAT,
               "12 bytes of voxels|holds 0 that can be decompressed");
    lar_bytes_free(&bytes);
    bytes = file_of(PLAIN);
    bytes.size -= 4;
    expect_bad(lar_nrrd_parse, "a.nrrd", &bytes, LAR_ERROR_FORMAT,
               "12 bytes of voxels|holds 8;|cut short");
    lar_bytes_free(&bytes);
}

/* Data longer than the header says, in the file itself and beside it, packed or not. */
static void too_long(void **state) {
    (void)state;
    for (int packed = 0; packed < 2; packed++) {
        lar_bytes bytes = file_of(PLAIN);
        size_t start = bytes.size - VOXELS;
        if (packed) memcpy(strstr((char *)bytes.data, "raw"), "gz ", 3);
        append(&bytes, "\1", 1);
        if (packed) gzip_from(&bytes, start);
        expect_bad(lar_nrrd_parse, "a.nrrd", &bytes, LAR_ERROR_FORMAT,
                   "12 bytes of voxels, but 1 more|damaged");
        lar_bytes data = {0};
        append(&data, bytes.data + start, bytes.size - start);
        mkdir(FOLDER, 0777);
        save(&data, FOLDER "/long.raw");
        bytes.size = start - 1; /* the empty line */
        append(&bytes, "data file: long.raw\n", 20);
        expect_bad(lar_nrrd_parse, FOLDER "/a.nhdr", &bytes, LAR_ERROR_FORMAT,
                   "12 bytes of voxels, but 1 more|damaged");
        lar_bytes_free(&data);
        lar_bytes_free(&bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type),
        cmocka_unit_test(spaces),
        cmocka_unit_test(units),
        cmocka_unit_test(names_of_segments),
        cmocka_unit_test(more_that_is_fine),
        cmocka_unit_test(detached),
        cmocka_unit_test(bad_data_files),
        cmocka_unit_test(bad_headers),
        cmocka_unit_test(bad_spaces),
        cmocka_unit_test(four_axes),
        cmocka_unit_test(claims),
        cmocka_unit_test(bad_values),
        cmocka_unit_test(too_long),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
