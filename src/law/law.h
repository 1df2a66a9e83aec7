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

/* The most parameters that a law has, and the most numbers by which another program gives one. */
enum { LAR_LAW_PARAMETERS = 4, LAR_LAW_GIVEN = 8 };

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
    LAR_VALUE_NOT_OURS  /* another program's law has it, ours has not: zero, or not given */
} lar_law_value;

typedef struct lar_law_parameter {
    const char *name;
    lar_law_value value;
} lar_law_parameter;

/* A law as another program's decks have it. */
typedef struct lar_law_dialect {
    const char *name; /* there; NULL: that program does not have it */
    int count;
    const lar_law_parameter *parameter; /* [count] in the order of the deck */
    /* Our parameters from theirs. */
    void (*read)(const double *given, double *parameter);
    const char *volume; /* our answer to a change of volume where that program has a choice of them,
                           or another one; NULL: there is no question */
} lar_law_dialect;

/* All of a dialect, and none. */
#define LAR_LAW_DIALECT(name, parameters, read, volume)                                            \
    { name, LAR_LAW_FITTING(sizeof parameters / sizeof *parameters), parameters, read, volume }
#define LAR_LAW_FITTING(count)                                                                     \
    (count) +                                                                                      \
        0 * sizeof(struct {                                                                        \
            int any;                                                                               \
            _Static_assert(count <= LAR_LAW_GIVEN, "more numbers than readers have room for");     \
        })
#define LAR_LAW_NO_DIALECT                                                                         \
    { NULL, 0, NULL, NULL, NULL }

/* Stiffness of a strained law, for the stable step (mechanics/hex8_guard.h). */
typedef struct lar_law_strained {
    double pressure; /* U'(J) of the volume term, tension positive [Pa] */
    double slope;    /* U''(J) [Pa] */
    double shear;    /* 4/3 of the shear modulus [Pa] */
    double further;  /* what shear has in one direction besides, because the law stiffens [Pa] */
} lar_law_strained;

/* F row by row, J = det F > 0, I1 = |F|^2; p: the parameters [Pa]. */
typedef struct lar_law_row {
    const char *name;                   /* in scenes */
    const char *title;                  /* in sentences */
    int count;                          /* of its parameters */
    const lar_law_parameter *parameter; /* [count] keys of scenes */
    const lar_law_dialect *febio, *abaqus;
    int history; /* numbers that an element remembers */
    bool fibres; /* whether it asks for directions */
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
    /* `area` = |cof F|^2. */
    lar_law_strained (*strained)(const double *p, double J, double I1, double area);
} lar_law_row;

extern const lar_law_row lar_law_table[LAR_LAW_COUNT];
extern const char *const lar_law_name[LAR_LAW_COUNT]; /* the names alone, for lists */

#endif
