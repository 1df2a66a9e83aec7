/* The table of the laws. Every member of a row is looked for by its name in the law's file, and
 * what is not there does not compile. */
#define LAR_LAW_ROWS 1
#include "law/law.h"
#include "law/isotropic.h"
#include "law/lanes.h"

#define ROW(law)                                                                                   \
    [LAR_LAW_##law] = {.name = lar_##law##_name,                                                   \
                       .title = lar_##law##_title,                                                 \
                       .count = sizeof lar_##law##_parameter / sizeof *lar_##law##_parameter,      \
                       .parameter = lar_##law##_parameter,                                         \
                       .febio = &lar_##law##_febio,                                                \
                       .abaqus = &lar_##law##_abaqus,                                              \
                       .history = lar_##law##_history,                                             \
                       .fibres = lar_##law##_fibres,                                               \
                       .uncoupled = lar_##law##_uncoupled,                                         \
                       .shear = lar_##law##_shear,                                                 \
                       .bulk = lar_##law##_bulk,                                                   \
                       .from_moduli = lar_##law##_from_moduli,                                     \
                       .energy = lar_##law##_energy,                                               \
                       .stress = lar_##law##_stress,                                               \
                       .tangent = lar_##law##_tangent,                                             \
                       .slopes = lar_##law##_slopes,                                               \
                       .strained = lar_##law##_strained},
const lar_law_row lar_law_table[LAR_LAW_COUNT] = {LAR_LAWS(ROW)};

#define NAME(law) [LAR_LAW_##law] = lar_##law##_name,
const char *const lar_law_name[LAR_LAW_COUNT] = {LAR_LAWS(NAME)};

/* What there is no room for, and what the engine has no place for yet. */
#define CHECK(law)                                                                                 \
    _Static_assert(sizeof lar_##law##_parameter / sizeof *lar_##law##_parameter <=                 \
                       LAR_LAW_PARAMETERS,                                                         \
                   #law " has more parameters than materials");                                    \
    _Static_assert(lar_##law##_history == 0 && lar_##law##_fibres == 0,                            \
                   #law " asks for what elements do not have");
LAR_LAWS(CHECK)
