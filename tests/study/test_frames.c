/* Profiles from side views (study/frames): rendered frames of a profile that is known. */
#include "film.h"

#include "study/frames/profiles.h"

/* A bump with a flank that is steep near the rim of a tube of 5 mm. */
typedef struct bump {
    double high, power;
} bump;

static double bump_at(const void *context, double r) {
    const bump *b = context;
    return b->high * (1 - pow(r / 0.005, b->power));
}

/* 20 um a pixel. */
static const film GOOD = {.width = 560,
                          .height = 250,
                          .scale = 2e-5,
                          .axis = 281.3,
                          .rim = 205.6,
                          .tube = 0.005,
                          .tissue = 0.3,
                          .behind = 0.8,
                          .blur = 1.5,
                          .noise = 0.02,
                          .seed = 88172645463325252u};

static void write_view(const char *name, const film *f, const char *more) {
    char text[600];
    snprintf(text, sizeof text,
             "lariat-view: 1\nmm_per_pixel: %.9g\naxis_pixel: %.9g\nrim_pixel: %.9g\n"
             "turn_degrees: %.9g\nradius_mm: 4.6\n%s%s",
             1e3 * f->scale, f->axis, f->rim, f->turn * 180 / acos(-1.0),
             strstr(more, "points") ? "" : "points: 12\n", more);
    twin_write(name, text);
}

typedef struct tally {
    int points, covered, missed;
    double worst;
} tally;

/* Writes some frames of growing bumps, reads them, and compares. */
static void look(const char *what, film f, const char *more, const char *extension, tally *all) {
    enum { FRAMES = 4 };
    lar_profiles p = {0};
    lar_error error = {0};
    tally t = {0};
    char path[600];
    film_folder("film");
    for (int i = 0; i < FRAMES; i++) {
        const bump b = {4e-4 + 8e-4 * i, 2 + i};
        snprintf(path, sizeof path, "%s/%03d.%s", twin_path("film"), i, extension);
        film_write(&f, bump_at, &b, path);
    }
    write_view("view.yaml", &f, more);
    if (lar_profiles_read(twin_path("film"), twin_path("view.yaml"), NULL, &p, &error))
        fail_msg("%s: %s", what, error.message);
    assert_int_equal(p.frames.count, FRAMES);
    assert_int_equal(p.view.tissue, f.tissue > f.behind ? 1 : -1);
    for (int i = 0; i < FRAMES * p.view.points; i++) {
        const bump b = {4e-4 + 8e-4 * (i / p.view.points), 2 + i / p.view.points};
        double off = p.point[i].z - bump_at(&b, lar_profiles_radius(&p, i % p.view.points));
        if (!(p.point[i].error > 0)) {
            t.missed++;
            continue;
        }
        t.points++;
        t.covered += fabs(off) < 1.96 * p.point[i].error;
        t.worst = fmax(t.worst, fabs(off));
    }
    print_message(
        "%-28s worst %5.2f um, stated %5.2f um, %2d of %2d covered, %d missed, blur %.2f, "
        "%.0f frames/s\n",
        what, 1e6 * t.worst, 1e6 * p.error, t.covered, t.points, t.missed, p.blur,
        FRAMES / p.seconds);
    lar_profiles_clear(&p);
    assert_below(t.worst, 30e-6); /* T 1.3.4 */
    assert_true(t.missed <= t.points / (f.specks ? 8 : 20));
    all->points += t.points;
    all->covered += t.covered;
}

static void edges_are_found(void **state) {
    (void)state;
    tally all = {0};
    film f = GOOD;
    look("dark tissue", f, "", "pgm", &all);
    f.tissue = 0.85;
    f.behind = 0.2;
    look("bright tissue", f, "", "pgm", &all);
    f = GOOD;
    f.noise = 0;
    look("no noise", f, "", "pgm", &all);
    f.noise = 0.1;
    look("much noise", f, "", "pgm", &all);
    f = GOOD;
    f.blur = 0.6;
    look("sharp", f, "", "pgm", &all);
    f.blur = 5;
    look("blurred", f, "", "pgm", &all);
    f.motion = true;
    look("moved", f, "", "pgm", &all);
    f = GOOD;
    f.uneven = 0.8;
    look("uneven light", f, "", "pgm", &all);
    f = GOOD;
    f.specks = 60;
    look("specks", f, "", "pgm", &all);
    f = GOOD;
    f.turn = 0.12;
    look("turned", f, "", "pgm", &all);
    f.turn = 1.5707963267948966;
    f.width = 250;
    f.height = 560;
    f.axis = 40.2;
    f.rim = 280.4;
    look("lying", f, "", "pgm", &all);
    f = GOOD;
    f.gamma = 2.2;
    look("gamma", f, "gamma: 2.2\n", "pgm", &all);
    f = GOOD;
    f.noise = 0.03;
    f.blur = 3;
    f.uneven = 0.5;
    f.specks = 40;
    f.tissue = 0.6;
    f.behind = 0.35;
    look("all of it", f, "", "pgm", &all);
    f = GOOD;
    f.grain = 1;
    look("grainy", f, "", "pgm", &all);
    f = GOOD;
    if (lar_grey_has_png()) look("png", f, "", "png", &all);
    double share = all.covered / (double)all.points;
    print_message("%d points, %.1f %% of them within 1.96 standard deviations\n", all.points,
                  100 * share);
    assert_true(share > 0.9 && share <= 0.995);
}

/* A background that is lighter than white moves the edge, and the errors say so. */
static void exposure_is_felt(void **state) {
    (void)state;
    film f = GOOD;
    const bump b = {2.5e-3, 3};
    lar_profiles p = {0};
    lar_error error = {0};
    char path[600];
    f.behind = 1.2;
    film_folder("film");
    snprintf(path, sizeof path, "%s/1.pgm", twin_path("film"));
    film_write(&f, bump_at, &b, path);
    write_view("view.yaml", &f, "");
    if (lar_profiles_read(twin_path("film"), twin_path("view.yaml"), NULL, &p, &error))
        fail_msg("%s", error.message);
    assert_int_equal(p.clipped, p.found);
    for (int k = 0; k < p.view.points; k++)
        assert_below(fabs(p.point[k].z - bump_at(&b, lar_profiles_radius(&p, k))),
                     1.96 * p.point[k].error);
    lar_profiles_clear(&p);
}

/* ---- what is refused ------------------------------------------------------------------------- */

static void refuse(const char *film_path, const char *view, lar_status status, const char *text) {
    lar_profiles p = {0};
    lar_error error = {0};
    lar_status got = lar_profiles_read(film_path, twin_path(view), NULL, &p, &error);
    lar_profiles_clear(&p);
    if (got != status || !strstr(error.message, text))
        fail_msg("expected %d and '%s', got %d: %s", status, text, got, error.message);
}

static const char *frame(const char *name) {
    static char path[600];
    snprintf(path, sizeof path, "%s/%s", twin_path("bad"), name);
    return path;
}

static void put(const char *name, const char *text) {
    FILE *out = fopen(frame(name), "wb");
    assert_non_null(out);
    fputs(text, out);
    assert_int_equal(fclose(out), 0);
}

/* Small and coarse, for sentences. */
static const film SMALL = {.width = 160,
                           .height = 90,
                           .scale = 8e-5,
                           .axis = 80,
                           .rim = 70,
                           .tube = 0.005,
                           .tissue = 0.3,
                           .behind = 0.8,
                           .blur = 1,
                           .noise = 0.02,
                           .seed = 88172645463325252u};

static void bad_frames_are_refused(void **state) {
    (void)state;
    film f = SMALL;
    const bump b = {2e-3, 2}, none = {-1, 2};
    write_view("view.yaml", &f, "");
    refuse(film_folder("bad"), "view.yaml", LAR_ERROR_IO, "there is no image");
    refuse(twin_path("nowhere"), "view.yaml", LAR_ERROR_IO, "cannot read");
    refuse(twin_path("view.yaml"), "view.yaml", LAR_ERROR_FORMAT, "neither a folder");
    put("side.pgm", "P5 1 1 255\n ");
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_FORMAT, "side.pgm: frames of a folder are");
    film_folder("bad");
    film_write(&f, bump_at, &b, frame("v1.pgm"));
    film_write(&f, bump_at, &b, frame("v01.pgm"));
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_FORMAT, "the number 1 is that of");
    film_folder("bad");
    film_write(&f, bump_at, &b, frame("v1.pgm"));
    f.width = 158;
    film_write(&f, bump_at, &b, frame("v2.pgm"));
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_FORMAT, "frame 2 has 158 x 90 pixels");
    f = SMALL;
    film_write(&f, bump_at, &none, frame("v2.pgm"));
    f.tissue = f.behind;
    film_write(&f, bump_at, &b, frame("v2.pgm"));
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_MODEL,
           "v2.pgm: in frame 2 of 2 an edge of dark");
    f.noise = 0;
    film_write(&f, bump_at, &b, frame("v2.pgm"));
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_MODEL,
           "v2.pgm: in frame 2 of 2 an edge of dark");
    f = SMALL;
    f.axis = 30;
    write_view("beside.yaml", &f, "");
    refuse(twin_path("bad"), "beside.yaml", LAR_ERROR_MODEL, "the tube lies out of the picture");
    f = SMALL;
    f.scale = 2e-3;
    write_view("coarse.yaml", &f, "");
    refuse(twin_path("bad"), "coarse.yaml", LAR_ERROR_MODEL, "too few for a profile");
    put("v2.pgm", "P5 160 90 255\nshort");
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_FORMAT, "v2.pgm: it ends early");
    put("v2.pgm", "P2 160 90 255\n1 2 300");
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_FORMAT, "v2.pgm: it ends early");
    put("v2.pgm", "P5 99999999 99999999 255\n");
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_FORMAT, "v2.pgm: it ends early");
    put("v2.pgm", "GIF89a");
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_FORMAT, "v2.pgm: it begins neither as");
    put("v2.pgm", "\x89PNG\r\n\x1a\nand no more");
    refuse(twin_path("bad"), "view.yaml",
           lar_grey_has_png() ? LAR_ERROR_FORMAT : LAR_ERROR_UNSUPPORTED, "v2.pgm: ");
    put("v2.pgm", "");
    refuse(twin_path("bad"), "view.yaml", LAR_ERROR_FORMAT, "v2.pgm");
}

static void bad_views_are_refused(void **state) {
    (void)state;
    static const char *const wrong[][2] = {
        {"lariat-view: 2", "expected 1, the version"},
        {"lariat-view: 1", "mm_per_pixel"},
        {"lariat-view: 1\nmm_per_pixel: 0\naxis_pixel: 1", "lies outside of"},
        {"lariat-view: 1\nmm_per_pixl: 0.1", "did you mean mm_per_pixel"},
        {"lariat-view: 1\nmm_per_pixel: 0.02 mm", "a number, for example 0.02"}};
    static const char *const more[][2] = {{"points: 1", "from 2 to 200"},
                                          {"tissue: grey", "dark, bright"},
                                          {"heights_mm: [3, 1]", "not below 1"},
                                          {"heights_mm: 3", "expected two numbers"},
                                          {"sides: up", "both, left"},
                                          {"frames_per_second: -25", "lies outside of"},
                                          {"start_s: -9", "are before time 0"},
                                          {"gamma: 0", "lies outside of"},
                                          {"heights_mm: [3, 4]", "places; look at"}};
    film f = SMALL;
    const bump b = {2e-3, 2};
    film_folder("bad");
    film_write(&f, bump_at, &b, frame("v1.pgm"));
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char text[200];
        snprintf(text, sizeof text, "%s\n", wrong[i][0]);
        twin_write("wrong.yaml", text);
        lar_profiles p = {0};
        lar_error error = {0};
        assert_int_not_equal(
            lar_profiles_read(twin_path("bad"), twin_path("wrong.yaml"), NULL, &p, &error), LAR_OK);
        lar_profiles_clear(&p);
        if (!strstr(error.message, wrong[i][1])) fail_msg("%s: %s", wrong[i][0], error.message);
    }
    for (size_t i = 0; i < sizeof more / sizeof more[0]; i++) {
        char text[200];
        snprintf(text, sizeof text, "%s\n", more[i][0]);
        write_view("wrong.yaml", &f, text);
        lar_profiles p = {0};
        lar_error error = {0};
        assert_int_not_equal(
            lar_profiles_read(twin_path("bad"), twin_path("wrong.yaml"), NULL, &p, &error), LAR_OK);
        lar_profiles_clear(&p);
        if (!strstr(error.message, more[i][1])) fail_msg("%s: %s", more[i][0], error.message);
    }
}

/* ---- what is counted ------------------------------------------------------------------------- */

/* Frames keep the time of their numbers; those before 0 are left out of the table. A list has the
 * times of its lines. One side alone is a profile too. */
static void time_is_counted(void **state) {
    (void)state;
    film f = SMALL;
    const bump b = {2e-3, 2};
    lar_profiles p = {0};
    lar_error error = {0};
    char line[256];
    film_folder("bad");
    film_write(&f, bump_at, &b, frame("v8.pgm"));
    film_write(&f, bump_at, &b, frame("v9.pgm"));
    film_write(&f, bump_at, &b, frame("v11.pgm"));
    put("notes.md", "no image");
    write_view("view.yaml", &f, "start_s: -0.04\nsides: left\nheights_mm: [-0.5, 4]\n");
    if (lar_profiles_read(twin_path("bad"), twin_path("view.yaml"), NULL, &p, &error))
        fail_msg("%s", error.message);
    assert_int_equal(p.frames.count, 3);
    assert_int_equal(p.early, 1);
    assert_int_equal(p.lost, 1);
    assert_true(lar_profiles_time(&p, 1) == 0);
    assert_below(fabs(lar_profiles_time(&p, 2) - 0.08), 1e-12);
    assert_int_equal(lar_profiles_write(&p, twin_path("view.csv"), &error), LAR_OK);
    lar_profiles_clear(&p);
    FILE *in = fopen(twin_path("view.csv"), "r");
    int rows = 0, first = 0;
    assert_non_null(in);
    while (fgets(line, sizeof line, in)) {
        rows += line[0] >= '0' && line[0] <= '9';
        first += strncmp(line, "0,", 2) == 0;
    }
    fclose(in);
    assert_int_equal(rows, 24);
    assert_int_equal(first, 12);
    twin_write("list.txt", "# a film\ntest_frames_bad/v11.pgm\n\ntest_frames_bad/v8.pgm\n");
    if (lar_profiles_read(twin_path("list.txt"), twin_path("view.yaml"), NULL, &p, &error))
        fail_msg("%s", error.message);
    assert_int_equal(p.frames.count, 2);
    assert_int_equal(p.lost, 0);
    lar_profiles_clear(&p);
}

/* The axis of the view lies half a pixel beside the one of the film: the two sides differ, and the
 * error says so. */
static void wrong_axis_is_felt(void **state) {
    (void)state;
    film f = GOOD;
    const bump b = {2.5e-3, 2};
    lar_profiles p = {0};
    lar_error error = {0};
    film_folder("bad");
    film_write(&f, bump_at, &b, frame("v1.pgm"));
    f.axis += 3;
    write_view("view.yaml", &f, "");
    if (lar_profiles_read(twin_path("bad"), twin_path("view.yaml"), NULL, &p, &error))
        fail_msg("%s", error.message);
    for (int k = 3; k < p.view.points; k++) {
        double r = lar_profiles_radius(&p, k), slope = 2 * 2.5e-3 * r / 25e-6;
        assert_true(p.point[k].error > 0.5 * slope * 3 * f.scale);
    }
    lar_profiles_clear(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_are_found),        cmocka_unit_test(exposure_is_felt),
        cmocka_unit_test(bad_frames_are_refused), cmocka_unit_test(bad_views_are_refused),
        cmocka_unit_test(time_is_counted),        cmocka_unit_test(wrong_axis_is_felt)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
