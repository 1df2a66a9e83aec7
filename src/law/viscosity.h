/* Viscosity of a material, on top of any law: a generalised Maxwell model in the frame of the body
 * at rest (Simo 1987), as FEBio has it.
 *
 *     S(t) = g0 Se(t) + sum_i g_i Hi(t),      Hi' + Hi / t_i = Se'
 *
 * S is the second Piola-Kirchhoff stress, Se what the law answers to the strain at that time: the
 * whole of it, or its isochoric part (quasi-linear viscoelasticity, Fung 1981; the volume then
 * answers at once). After a sudden strain S falls as g0 + sum_i g_i exp(-t / t_i). The stress of
 * one step is in viscous_stress.h, what an element remembers between two of them is here:
 *
 *     value   0       1 .. 6   7 .. 12   13 .. 18   19 .. 24       43 .. 48
 *             work    C - 1      Se         H1         H2     ...     H6       xx xy xz yy yz zz
 *
 * in pascal of the material as the model has it: who makes a material stiffer by a factor makes it
 * so from the beginning.
 */
#ifndef LAR_LAW_VISCOSITY_H
#define LAR_LAW_VISCOSITY_H

#include <stdbool.h>

enum { LAR_VISCOUS_TERMS = 6 }; /* as many as FEBio has */

typedef struct lar_viscosity {
    int terms;                       /* 0: the material is elastic, and nothing else counts */
    bool isochoric;                  /* only that part of the stress relaxes */
    double rest;                     /* g0: of the law's stress, what is left in the end */
    double share[LAR_VISCOUS_TERMS]; /* g_i */
    double time[LAR_VISCOUS_TERMS];  /* t_i [s] */
    int line;                        /* of the file that says so, for messages */
} lar_viscosity;

/* Where an element's values stand. */
enum {
    LAR_HISTORY_WORK,       /* that the terms have taken [J per m^3 at rest] */
    LAR_HISTORY_STRAIN,     /* 6: C - 1 */
    LAR_HISTORY_STRESS = 7, /* 6: Se [Pa] */
    LAR_HISTORY_TERMS = 13, /* 6 of each term [Pa] */
    LAR_HISTORY_MAX = 13 + 6 * LAR_VISCOUS_TERMS
};

/* Values of an element with so many terms. */
static inline int lar_history_values(int terms) {
    return terms > 0 ? LAR_HISTORY_TERMS + 6 * terms : 0;
}

/* How much stiffer than its law such a material is when it is strained at once: what relaxes. */
static inline double lar_viscosity_instant(const lar_viscosity *viscosity) {
    if (viscosity->terms == 0) return 1;
    double sum = viscosity->rest;
    for (int i = 0; i < viscosity->terms; i++) sum += viscosity->share[i];
    return sum;
}

/* And in the end. */
static inline double lar_viscosity_rest(const lar_viscosity *viscosity) {
    return viscosity->terms == 0 ? 1 : viscosity->rest;
}

/* The same of a change of volume. */
static inline double lar_viscosity_volume_instant(const lar_viscosity *viscosity) {
    return viscosity->isochoric ? 1 : lar_viscosity_instant(viscosity);
}
static inline double lar_viscosity_volume_rest(const lar_viscosity *viscosity) {
    return viscosity->isochoric ? 1 : lar_viscosity_rest(viscosity);
}

/* Kinds of viscosity whose elements may share a block: 0 none, else terms and part. Model hashes
 * and checkpoints have these numbers, those of up to three terms for longer than the others. */
enum { LAR_VISCOUS_KINDS = 14 };
static inline int lar_viscosity_kind(const lar_viscosity *viscosity) {
    const int terms = viscosity->terms, isochoric = viscosity->isochoric;
    if (terms == 0) return 0;
    return terms <= 3 ? terms + 4 * isochoric : terms + 4 + 3 * isochoric;
}

#endif
