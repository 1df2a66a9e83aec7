/* Fibres of a material, on top of any law: one family of them in each element, along a unit vector
 * `a` of the body at rest, or, of the law hgo, a pair of families alike, along two; they carry
 * tension only. And the stress that they develop when a muscle is active. Adding to the law's
 * energy (a solid mixture, in FEBio's words),
 *
 *     exp-pow      W = ksi / (alpha beta) (exp(alpha (I - 1)^beta) - 1),      I = l^2 > 1
 *                  alpha = 0: ksi / beta (I - 1)^beta
 *     exp-linear   l dW/dl = c3 (exp(c4 (l - 1)) - 1),                        1 < l <= lam_max
 *                          = ... at lam_max + c5 (l - lam_max)                beyond
 *     pow-linear   dW/dl = 2 ksi l (I - 1)^(beta - 1),                        1 < l <= lam0
 *                        = ... at lam0 + its slope there (l - lam0)           beyond
 *                  ksi = E / (4 (beta - 1) lam0^3) (lam0^2 - 1)^(2 - beta)
 *     hgo          W = k1 / (2 k2) (exp(k2 E^2) - 1),     E = kappa I1 + (1 - 3 kappa) I - 1 > 0
 *                  k2 = 0: k1 / 2 E^2
 *     active       W = along / 2 (I - 1) + across / 2 (I1 - 2 - I), times the activation
 *
 * l = |F a| is the stretch along the fibres, or its isochoric part J^(-1/3) |F a|. exp-pow is
 * FEBio's "fiber-exp-pow" (Maas and others 2012; Holzapfel, Gasser and Ogden 2000 for beta = 2),
 * exp-linear that of Weiss, Maker and Govindjee (1996, eqs. 7.1 to 7.3) in FEBio's "trans iso
 * Mooney-Rivlin", pow-linear FEBio's "fiber-pow-linear": E is d2W/dl2 in the straight part, less 2
 * ksi (lam0^2 - 1)^(beta - 1), times lam0. hgo is the law of Gasser, Ogden and Holzapfel (2006) for
 * fibres that spread about `a`, by kappa from 0, not at all, to 1/3, evenly: E + 1 is the mean of
 * l^2 over them. It is defined by isochoric parts, I1 = J^(-2/3) |F|^2 likewise. An active stress
 * is T/J F a (x) F a, FEBio's "prescribed active contraction"; of a pair the first family has it.
 *
 * The stress for a lane is in fibre_stress.h. Directions belong to elements (lar_mesh.fibre,
 * lar_mesh.second).
 */
#ifndef LAR_LAW_FIBRE_H
#define LAR_LAW_FIBRE_H

#include <stdbool.h>

typedef enum lar_fibre_law {
    LAR_FIBRE_NONE,
    LAR_FIBRE_EXP_POW,    /* ksi [Pa], alpha, beta */
    LAR_FIBRE_EXP_LINEAR, /* c3 [Pa], c4, c5 [Pa], lam_max */
    LAR_FIBRE_POW_LINEAR, /* E [Pa], lam0, beta */
    LAR_FIBRE_HGO,        /* k1 [Pa], k2, kappa; isochoric */
    LAR_FIBRE_LAWS
} lar_fibre_law;

enum { LAR_FIBRE_PARAMETERS = 4 };
/* kappa of fibres in all directions alike, with room for 0.3333334. */
#define LAR_FIBRE_EVEN (1.0 / 3 + 1e-6)

typedef struct lar_fibre {
    lar_fibre_law law;
    bool isochoric; /* they see the isochoric part of the stretch */
    bool paired;    /* two families of the law hgo, both as the parameters say */
    double parameter[LAR_FIBRE_PARAMETERS];
    double along, across; /* active stress [Pa] at an activation of 1 */
    int line;             /* of the file that says so, for messages */
} lar_fibre;

/* Whether there are any, and whether they need a direction. */
static inline bool lar_fibre_active(const lar_fibre *fibre) {
    return fibre->along != 0 || fibre->across != 0;
}
static inline bool lar_fibre_here(const lar_fibre *fibre) {
    return fibre->law != LAR_FIBRE_NONE || lar_fibre_active(fibre);
}
static inline bool lar_fibre_directed(const lar_fibre *fibre) {
    return fibre->law != LAR_FIBRE_NONE || fibre->along != fibre->across;
}

/* How many families each element has a direction for. */
static inline int lar_fibre_families(const lar_fibre *fibre) {
    return fibre->paired && fibre->law != LAR_FIBRE_NONE ? 2 : 1;
}

/* Kinds of fibres whose elements may share a block: 0 none, else law and part. Pairs have kinds of
 * their own, LAR_FIBRE_SINGLE further up than that of one of their families. */
enum { LAR_FIBRE_SINGLE = 1 + 2 * LAR_FIBRE_LAWS, LAR_FIBRE_KINDS = 2 * LAR_FIBRE_SINGLE };
/* Those from here on spread; the kind of one of their families. */
enum { LAR_FIBRE_SPREAD = 1 + 2 * LAR_FIBRE_HGO, LAR_FIBRE_KIND_SPREAD = LAR_FIBRE_SPREAD + 1 };
static inline int lar_fibre_kind_single(const lar_fibre *fibre) {
    return lar_fibre_here(fibre) ? 1 + 2 * (int)fibre->law + fibre->isochoric : 0;
}
static inline int lar_fibre_kind(const lar_fibre *fibre) {
    return lar_fibre_kind_single(fibre) + (lar_fibre_families(fibre) == 2 ? LAR_FIBRE_SINGLE : 0);
}
/* Of a single family's kind. */
static inline lar_fibre_law lar_fibre_kind_law(int kind) {
    return (lar_fibre_law)((kind - 1) / 2);
}
static inline bool lar_fibre_kind_isochoric(int kind) {
    return (kind - 1) % 2 != 0;
}

/* Whether parameter k is in pascal. */
static inline bool lar_fibre_scales(lar_fibre_law law, int k) {
    return k == 0 || (law == LAR_FIBRE_EXP_LINEAR && k == 2);
}

/* The slope of l dW/dl by l where tension begins, of one family [Pa]. */
static inline double lar_fibre_modulus(const lar_fibre *fibre) {
    const double *p = fibre->parameter;
    if (fibre->law == LAR_FIBRE_EXP_LINEAR) return p[0] * p[1];
    if (fibre->law == LAR_FIBRE_HGO) return 4 * p[0] * (1 - 3 * p[2]) * (1 - 3 * p[2]);
    if (fibre->law == LAR_FIBRE_POW_LINEAR) return p[2] <= 2 ? p[0] / (p[1] * p[1] * p[1]) : 0;
    return fibre->law == LAR_FIBRE_EXP_POW && p[2] <= 2 ? 4 * p[0] : 0;
}

/* The largest eigenvalue of one family's stiffness there [Pa]: the square of the deviator of a (x)
 * a is 2/3. */
static inline double lar_fibre_stiffest(const lar_fibre *fibre) {
    return lar_fibre_modulus(fibre) * (fibre->isochoric ? 2.0 / 3 : 1);
}

#endif
