/* Materials as data: which law, which parameters, which density.
 *
 * The mathematics of a law lives in mechanics/law_*.h; here are the names a user writes, what
 * they mean and what is allowed. LAR_LAWS is the one table: adding a law is one row here and one
 * file there.
 */
#ifndef LAR_MODEL_MATERIAL_H
#define LAR_MODEL_MATERIAL_H

#include "base/error.h"

enum { LAR_LAW_PARAMETERS = 3 };

/* X(identifier, "name in scenes")
 * neo_hookean          W = G/2 (I1 J^(-2/3) - 3) + K/2 (J - 1)^2           parameters G, K
 *                      (the thesis's law, eq. 1.1, with G = 2 mu, K = kappa)
 * coupled_neo_hookean  W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2     parameters mu, lambda
 *                      (FEBio "neo-Hookean")
 * mooney_rivlin        W = c1 (I1 J^(-2/3) - 3) + c2 (I2 J^(-4/3) - 3) + K/2 (ln J)^2
 *                      (FEBio "Mooney-Rivlin")                             parameters c1, c2, K */
#define LAR_LAWS(X)                                                                                \
    X(neo_hookean, "neo-hookean")                                                                  \
    X(coupled_neo_hookean, "coupled-neo-hookean")                                                  \
    X(mooney_rivlin, "mooney-rivlin")

typedef enum lar_law {
#define LAR_LAW_ENUM(identifier, name) LAR_LAW_##identifier,
    LAR_LAWS(LAR_LAW_ENUM)
#undef LAR_LAW_ENUM
        LAR_LAW_COUNT
} lar_law;

extern const char *const lar_law_name[LAR_LAW_COUNT];

typedef struct lar_material {
    char *name; /* for messages; may be NULL */
    lar_law law;
    double density;                       /* kg/m^3 */
    double parameter[LAR_LAW_PARAMETERS]; /* pascal, as listed above; unused ones 0 */
} lar_material;

/* Small-strain moduli of the material at rest [Pa]. */
double lar_material_shear(const lar_material *material);
double lar_material_bulk(const lar_material *material);

/* Refuses: density not positive and finite, shear or bulk modulus not positive, Poisson ratio
 * 0.5 or more, not finite. `where` begins the message (file:line:column). */
lar_status lar_material_check(const lar_material *material, const char *where, lar_error *error);

/* Parameters from Young's modulus and Poisson's ratio (-1 < nu < 0.5). For mooney_rivlin c2 = 0. */
void lar_material_from_young(lar_material *material, double young, double poisson);
/* Parameters from shear and bulk modulus. */
void lar_material_from_shear_bulk(lar_material *material, double shear, double bulk);

#endif
