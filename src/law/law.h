/* The laws of material: what each of them is called, asked for and answers.
 *
 *      law/NAME.h   one file for each law, and in it one row of the table below
 *          |
 *          +-- for a lane        stress, energy, stiffened     ----> the kernels (law/lanes.h)
 *          '-- in plain numbers  the row: names, parameters,   ----> readers, moduli, fits, the
 *                                moduli, tangent, ...                stable step, implicit solvers
 *
 * Nothing outside of this room asks which law a material has in order to do something of its own:
 * it asks the row. A law whose file lacks a member does not compile (law/law.c); one whose members
 * contradict each other fails in tests/law/test_rows.c.
 */
#ifndef LAR_LAW_LAW_H
#define LAR_LAW_LAW_H

#include <stdbool.h>
#include <stddef.h>

#include "law/list.h"
#include "law/numbers.h"

/* The most parameters that a law has, and the most numbers by which another program gives one. */
enum { LAR_LAW_PARAMETERS = 7, LAR_LAW_GIVEN = 13 };

typedef enum lar_law {
#define LAR_LAW_ENUM(identifier) LAR_LAW_##identifier,
    LAR_LAWS(LAR_LAW_ENUM)
#undef LAR_LAW_ENUM
        LAR_LAW_COUNT
} lar_law;

/* What a number of a law is. */
typedef enum lar_law_value {
    LAR_VALUE_MODULUS,  /* [Pa] more than zero */
    LAR_VALUE_CONSTANT, /* [Pa] of any sign, as long as the moduli at rest are positive */
    LAR_VALUE_OPTIONAL, /* the same, zero when it is not given */
    LAR_VALUE_RATIO,    /* Poisson's, between -1 and 0.5, exclusive */
    LAR_VALUE_SOFTNESS, /* [1/Pa] Abaqus's D = 2 / K */
    LAR_VALUE_NOT_OURS, /* another program's law has it, ours has not: zero, or not given */
    LAR_VALUE_NUMBER,   /* [-] more than zero */
    LAR_VALUE_POWER     /* [-] of any sign, zero when it is not given: the power of the term whose
                           constant stands before it, and not zero unless that is */
} lar_law_value;

typedef struct lar_law_parameter {
    char name[16]; /* where it stands: a pointer would be one relocation more of the library */
    lar_law_value value;
} lar_law_parameter;

/* Whether it is in pascal: blocks hold it times a volume, and who makes a material stiffer by a
 * factor means it. */
static inline bool lar_law_in_pascal(const lar_law_parameter *parameter) {
    return parameter->value != LAR_VALUE_NUMBER && parameter->value != LAR_VALUE_POWER;
}

/* Whether parameter k of a list may be left out: it is zero then. */
static inline bool lar_law_may_miss(const lar_law_parameter *parameter, int k) {
    while (k > 0 && parameter[k].value == LAR_VALUE_POWER) k--;
    return parameter[k].value == LAR_VALUE_OPTIONAL || parameter[k].value == LAR_VALUE_NOT_OURS;
}

/* A law as another program's decks have it. */
typedef struct lar_law_dialect {
    const char *name; /* there; NULL: that program does not have it */
    int count;
    const lar_law_parameter *parameter; /* [count] in the order of the deck */
    /* Our parameters from theirs. */
    void (*read)(const double *given, double *parameter);
    const char *volume; /* our answer to a change of volume where that program has a choice of them,
                           or another one; NULL: there is no question */
    /* Abaqus's name of it as a series of N terms of `per_term` numbers each, behind which one more
     * for each term stands; NULL: it is none. `parameter` is of the longest that we have. */
    const char *series;
    int per_term;
} lar_law_dialect;

/* All of a dialect, a series as well, and none. */
#define LAR_LAW_DIALECT(name, parameters, read, volume)                                            \
    LAR_LAW_SERIES(name, parameters, read, volume, NULL, 0)
#define LAR_LAW_SERIES(name, parameters, read, volume, series, per_term)                           \
    {                                                                                              \
        name, LAR_LAW_FITTING(sizeof parameters / sizeof *parameters), parameters, read, volume,   \
            series, per_term                                                                       \
    }
#define LAR_LAW_FITTING(count)                                                                     \
    (count) +                                                                                      \
        0 * sizeof(struct {                                                                        \
            int any;                                                                               \
            _Static_assert(count <= LAR_LAW_GIVEN, "more numbers than readers have room for");     \
        })
#define LAR_LAW_NO_DIALECT                                                                         \
    { NULL, 0, NULL, NULL, NULL, NULL, 0 }

/* Stiffness of a strained law, for the stable step (mechanics/hex8_guard.h). */
typedef struct lar_law_strained {
    double pressure; /* U'(J) of the volume term, tension positive [Pa] */
    double slope;    /* U''(J) [Pa] */
    double shear;    /* 4/3 of the shear modulus [Pa] */
    double further;  /* what shear has in one direction besides, because the law stiffens [Pa] */
} lar_law_strained;

/* The invariants of a state. */
typedef struct lar_law_invariants {
    double I1, I2, J, cof[9];
} lar_law_invariants;

/* Derivatives of a law by them: w(I1, I2, J), I1 = |F|^2, I2 = |cof F|^2 (law/isotropic.h). */
typedef struct lar_law_slopes {
    double w1, w2, wJ, w11, w1J, w2J, wJJ;
} lar_law_slopes;

/* F row by row, J = det F > 0, I1 = |F|^2; p: the parameters [Pa]. */
typedef struct lar_law_row {
    const char *name;                   /* in scenes */
    const char *title;                  /* in sentences */
    int count;                          /* of its parameters */
    const lar_law_parameter *parameter; /* [count] keys of scenes */
    const lar_law_dialect *febio, *abaqus;
    int history;    /* numbers that an element remembers */
    bool fibres;    /* whether it asks for directions */
    bool uncoupled; /* w = w'(F J^(-1/3)) + U(J): it has an isochoric part */
    /* Shear and bulk modulus at rest [Pa], and the parameters that have them: those which moduli do
     * not determine are 0. */
    double (*shear)(const double *p);
    double (*bulk)(const double *p);
    void (*from_moduli)(double shear, double bulk, double *p);
    /* Energy per reference volume; P: cof F on entry, first Piola-Kirchhoff stress on return, for
     * what it returns see law/lanes.h; A: dP_ij/dF_kl as A[3 i + j][3 k + l]. */
    double (*energy)(const double F[9], double J, double I1, const double *p);
    double (*stress)(const double F[9], double P[9], double J, double I1, const double *p);
    void (*tangent)(const double *p, const double F[9], double A[9][9]);
    /* The same by invariants, whose `cof` is not looked at. NULL: there are more. */
    lar_law_slopes (*slopes)(const double *p, const lar_law_invariants *is);
    /* `area` = |cof F|^2. */
    lar_law_strained (*strained)(const double *p, double J, double I1, double area);
} lar_law_row;

extern const lar_law_row lar_law_table[LAR_LAW_COUNT];
/* Whether parameter k of a law is in pascal; of those that it does not have it does not matter. */
static inline bool lar_law_scales(lar_law law, int k) {
    return k >= lar_law_table[law].count || lar_law_in_pascal(&lar_law_table[law].parameter[k]);
}

extern const char *const lar_law_name[LAR_LAW_COUNT]; /* the names alone, for lists */

#endif
