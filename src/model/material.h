/* Materials as data: which law (law/law.h), which parameters, which density. */
#ifndef LAR_MODEL_MATERIAL_H
#define LAR_MODEL_MATERIAL_H

#include "base/error.h"
#include "law/fibre.h"
#include "law/law.h"
#include "law/viscosity.h"
#include "model/activation.h"

typedef struct lar_material {
    char *name; /* for messages; may be NULL */
    lar_law law;
    double density;                       /* kg/m^3 */
    double parameter[LAR_LAW_PARAMETERS]; /* pascal or numbers, as the law's row has them; unused
                                             ones 0 */
    lar_viscosity viscosity;
    lar_fibre fibre;
    lar_activation activation; /* of what is active */
} lar_material;

/* What scenes call the laws of fibres; "" for none. */
extern const char *const lar_fibre_law_name[LAR_FIBRE_LAWS];
/* And their parameters, in the order of lar_fibre.parameter; NULL: no more. */
extern const char *const lar_fibre_parameter_name[LAR_FIBRE_LAWS][LAR_FIBRE_PARAMETERS];

/* Small-strain moduli of the material at rest [Pa], of a viscous one in the end. */
double lar_material_shear(const lar_material *material);
double lar_material_bulk(const lar_material *material);
/* The same when it is strained at once. */
double lar_material_instant_shear(const lar_material *material);
double lar_material_instant_bulk(const lar_material *material);

/* How much stiffer it is at once where it cannot give way to the sides, as in a pressure wave, than
 * where it can: (K + 4/3 G) / E, 1 for nu = 0. */
static inline double lar_material_confined(const lar_material *material) {
    double shear = lar_material_instant_shear(material), bulk = lar_material_instant_bulk(material);
    return (bulk + 4.0 / 3 * shear) * (3 * bulk + shear) / (9 * bulk * shear);
}

/* Makes a viscous material elastic: as it is at once, or in the end. */
void lar_material_freeze(lar_material *material, bool at_once);

/* Refuses: density not positive and finite, shear or bulk modulus not positive, Poisson ratio
 * 0.5 or more, not finite. `where` begins the message (file:line:column). */
lar_status lar_material_check(const lar_material *material, const char *where, lar_error *error);

/* Parameters from Young's modulus and Poisson's ratio (-1 < nu < 0.5). What moduli do not determine
 * becomes 0. */
void lar_material_from_young(lar_material *material, double young, double poisson);
/* Parameters from shear and bulk modulus. */
void lar_material_from_shear_bulk(lar_material *material, double shear, double bulk);

#endif
