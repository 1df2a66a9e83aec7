/* The tissue that a region's name speaks of, and what is known of each. */
#include "testing.h"

#include "meshing/starter/tissue.h"

static void names_speak_of_tissues(void **state) {
    (void)state;
    static const char *const of[][2] = {{"liver", "liver"},
                                        {"Liver segment 4", "liver"},
                                        {"kidney_left", "kidney"},
                                        {"leftKidney", "kidney"},
                                        {"renal cortex", "kidney"},
                                        {"renal vein", "vessel"},
                                        {"portal_vein_and_splenic_vein", "vessel"},
                                        {"pulmonary_vein", "vessel"},
                                        {"iliac_artery_right", "vessel"},
                                        {"lung_upper_lobe_left", "lung"},
                                        {"right lung", "lung"},
                                        {"urinary_bladder", "hollow organ"},
                                        {"gallbladder", "hollow organ"},
                                        {"small_bowel", "hollow organ"},
                                        {"gastrocnemius", "muscle"},
                                        {"gluteus_maximus_left", "muscle"},
                                        {"myocardium", "heart"},
                                        {"heart_atrium_left", "heart"},
                                        {"hippocampus", "brain"},
                                        {"spinal-cord", "brain"},
                                        {"hip_left", "bone"},
                                        {"rib_left_3", "bone"},
                                        {"vertebrae_L5", "bone"},
                                        {"cervical vertebral column", "bone"},
                                        {"Femur", "bone"},
                                        {"costal_cartilages", "cartilage"},
                                        {"subcutaneous fat", "fat"},
                                        {"prostate", "prostate"},
                                        {"uterus_posterior_wall", "uterus"},
                                        {"skin", "skin"},
                                        /* Within a word it means nothing. */
                                        {"caribou", "soft tissue"},
                                        {"oliver", "soft tissue"},
                                        {"region 7", "soft tissue"},
                                        {"", "soft tissue"}};
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++)
        assert_string_equal(lar_tissue_find(of[i][0])->name, of[i][1]);
}

static void every_tissue_has_a_source(void **state) {
    (void)state;
    static const char *const names[] = {"liver", "spleen",    "kidney",  "stomach", "bladder",
                                        "brain", "pancreas",  "muscle",  "heart",   "lung",
                                        "fat",   "prostate",  "uterus",  "aorta",   "skin",
                                        "bone",  "cartilage", "whatever"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const lar_tissue *tissue = lar_tissue_find(names[i]);
        bool year = strstr(tissue->source, "(20") || strstr(tissue->source, "(19") ||
                    strstr(tissue->source, ", 20") || strstr(tissue->source, ", 19");
        assert_true(year);
        assert_true(tissue->shear_modulus >= 100 && tissue->shear_modulus <= 1e6);
        assert_true(tissue->poisson_ratio > 0 && tissue->poisson_ratio < 0.5);
        assert_true(tissue->density > 100 && tissue->density < 2500);
        assert_int_equal(tissue->rigid, strcmp(tissue->name, "bone") == 0);
        /* What nobody has measured says so first. */
        assert_int_equal(tissue->guess, strncmp(tissue->source, "a guess: ", 9) == 0);
    }
}

static void guesses_are_named(void **state) {
    (void)state;
    static const char *const guesses[] = {"stomach", "bladder", "prostate", "bone", "whatever"},
                             *const known[] = {"liver", "kidney", "brain", "muscle", "lung"};
    for (size_t i = 0; i < sizeof guesses / sizeof guesses[0]; i++)
        assert_true(lar_tissue_find(guesses[i])->guess);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        assert_false(lar_tissue_find(known[i])->guess);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(names_speak_of_tissues),
                                       cmocka_unit_test(every_tissue_has_a_source),
                                       cmocka_unit_test(guesses_are_named)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
