/* Shear moduli of healthy tissue at small strain. Mostly from elastography in living people, which
 * measures with waves of 40 to 100 Hz: slow motion finds tissue softer, by half or so. Where only
 * Young's modulus is published a third of it stands here (tissue hardly changes its volume).
 * Densities: ICRU Report 44 (1989).
 *
 * Poisson's ratio is 0.45 everywhere: the stable time step goes with the speed of pressure waves,
 * and 0.49 would halve it. Bone is thousands of times stiffer than what lies around it; it is held
 * where it is, so that its stiffness plays no part.
 *
 * Only the shear modulus is anybody's figure. The law, how it stiffens, and that nothing relaxes
 * are ours, and so are moduli marked as guesses; starter scenes say so beside the values.
 *
 * Largest volumes are ours, with room to spare: a liver of more than ten litres is one in another
 * unit.
 */
#include "meshing/starter/tissue.h"

#include <ctype.h>
#include <stddef.h>
#include <string.h>

/* In the order in which they are looked for: "renal vein" is a vessel before it is kidney, "renal
 * cortex" is kidney before it is brain. */
static const lar_tissue tissue[] = {
    {"vessel", "artery arteri vein vena aorta vessel vascul brachiocephalic", 3.7e3, 0.45, 1060,
     2e-3, false, false,
     "Kolipaka et al., J Magn Reson Imaging 35:582 (2012): 3.7 kPa, aorta with the blood in it"},
    {"muscle",
     "muscle muscul gluteus gluteal psoas iliopsoas autochthon quadriceps biceps triceps deltoid "
     "gastrocnemius soleus diaphragm tongue",
     3.7e3, 0.45, 1050, 30e-3, false, false,
     "Bensamoun et al., J Magn Reson Imaging 23:242 (2006): 3.7 kPa, thigh at rest"},
    {"heart", "heart myocard cardiac atri atrium ventricle_left ventricle_right", 6.1e3, 0.45, 1050,
     3e-3, false, false,
     "Castelein et al., J Magn Reson Imaging (2025): shear waves of 2.4 m/s in diastole of "
     "healthy people and patients, 6.1 kPa"},
    {"kidney", "kidney renal nephr", 4.9e3, 0.45, 1050, 10e-3, false, false,
     "Rouviere et al., J Magn Reson Imaging 34:880 (2011): 4.9 kPa at 45 Hz"},
    {"liver", "liver hepat", 2.1e3, 0.45, 1060, 10e-3, false, false,
     "Venkatesh et al., J Magn Reson Imaging 39:1 (2014): 2.1 kPa at 60 Hz"},
    {"spleen", "spleen splenic", 3.6e3, 0.45, 1060, 10e-3, false, false,
     "Talwalkar et al., Am J Roentgenol 193:122 (2009): 3.6 kPa at 60 Hz"},
    {"pancreas", "pancrea", 1.1e3, 0.45, 1040, 1e-3, false, false,
     "Xu et al., J Magn Reson Imaging 52:448 (2020): 1.1 kPa at 40 Hz"},
    {"hollow organ",
     "stomach gastr esophag oesophag duoden bowel intestin colon rectum jejun ileum bladder "
     "urinary_bladder gallbladder gall",
     3e3, 0.45, 1040, 20e-3, false, true,
     "a guess: between the wall of living bowel by ultrasound (Young's modulus 3.8 kPa: Zhao et "
     "al., Quant Imaging Med Surg, measured in 2020) and walls stretched, far stiffer (Egorov et "
     "al., J Biomech 35:1417, 2002)"},
    {"prostate", "prostat", 2.8e3, 0.45, 1040, 1e-3, false, true,
     "a guess: softer than enlarged ones, 4.4 kPa (Aphinives et al., Egypt J Radiol Nucl Med, "
     "2021, doi 10.1186/s43055-021-00679-8)"},
    {"uterus", "uterus uteri uterin cervix ovar", 2.7e3, 0.45, 1050, 20e-3, false, false,
     "Karakas et al., Front Med (2026), doi 10.3389/fmed.2026.1743585: 2.7 kPa, 48 women"},
    {"brain",
     "brain cerebr cerebell cortex hippocamp thalam putamen caudate pallid amygdal "
     "grey_matter gray_matter white_matter spinal_cord brodmann",
     0.9e3, 0.45, 1040, 3e-3, false, false,
     "Aurand et al., J Funct Biomater 3:839 (2012), table 1: 0.74 kPa (grey) and 1.03 kPa (white), "
     "pigs, indentation"},
    {"lung", "lung pulmon", 1.8e3, 0.45, 260, 15e-3, false, false,
     "Mariappan et al., J Magn Reson Imaging 33:1351 (2011): 1.1 kPa breathed out, 1.8 kPa "
     "breathed in"},
    {"fat", "fat adipos breast mamma", 1e3, 0.45, 950, 100e-3, false, false,
     "Briot et al., Clin Biomech (2022): Young's modulus 3.0 kPa, breast under its skin, suction"},
    {"skin", "skin cutis dermis", 19e3, 0.45, 1090, 20e-3, false, false,
     "Briot et al., Clin Biomech (2022): Young's modulus 56 kPa, suction"},
    {"cartilage", "cartilage costal_cart meniscus disc disk", 170e3, 0.45, 1100, 2e-3, false, false,
     "Soltz and Ateshian, J Biomech Eng 122:576 (2000): 0.17 MPa, calf"},
    {"bone",
     "bone vertebra rib skull crani femur femora hip pelvis sacrum humerus scapula clavic sternum "
     "tibia fibula patella ulna radius mandib maxilla spine tooth teeth",
     3e3, 0.45, 1920, 20e-3, true, true,
     "a guess: it is held where it is, so that its stiffness plays no part; the real one, 7 to 25 "
     "GPa (Zysset et al., J Biomech 32:1005, 1999), has steps of nanoseconds"},
    {"soft tissue", "", 3e3, 0.45, 1050, 0, false, true,
     "a guess: no tissue is known by this name; livers have 2.1 kPa (Venkatesh et al., 2014), "
     "kidneys 4.9 kPa (Rouviere et al., 2011)"}};
enum { TISSUES = sizeof tissue / sizeof tissue[0] };

/* "_" in a word stands for whatever separates words in a name. */
static bool begins(const char *name, const char *word, size_t length) {
    for (size_t i = 0; i < length; i++) {
        int c = tolower((unsigned char)name[i]);
        if (word[i] == '_' ? c == '\0' || isalnum(c) : c != word[i]) return false;
    }
    return true;
}

/* Whether a word of the name begins here: behind what is no letter, or where "leftLung" changes. */
static bool is_start(const char *name, size_t at) {
    if (at == 0) return true;
    unsigned char before = (unsigned char)name[at - 1], here = (unsigned char)name[at];
    return !isalpha(before) || (islower(before) && isupper(here));
}

static bool has_word(const char *name, const char *word, size_t length) {
    for (size_t at = 0; name[at]; at++)
        if (is_start(name, at) && begins(name + at, word, length)) return true;
    return false;
}

const lar_tissue *lar_tissue_find(const char *region) {
    for (int t = 0; t < TISSUES - 1; t++)
        for (const char *word = tissue[t].words; *word; word += strspn(word, " ")) {
            size_t length = strcspn(word, " ");
            if (has_word(region, word, length)) return &tissue[t];
            word += length;
        }
    return &tissue[TISSUES - 1];
}
