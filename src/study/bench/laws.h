/* What laws, fibres and viscosity cost beside the neo-Hookean law, in one run: two blocks of the
 * same shape, computed in turn.
 *
 *     neo-Hookean | law | law | neo-Hookean | neo-Hookean | law ...      sections of a millisecond
 *           '-- ratio --'     '--- ratio ---'
 *
 * Each pair of neighbours gives a ratio, the median of twenty is a sample, the median of the
 * samples counts: what slows the machine for longer than a section slows both.
 *
 * The block is that of kernel.h. All materials have its shear modulus at rest, and its bulk modulus
 * where they have a part for the volume alone, else twice the shear modulus; constants that these
 * do not determine are a quarter of the first one, so that every term is at work. The strain is
 * small: fibres pull in about half of the elements at a time.
 */
#ifndef LAR_STUDY_BENCH_LAWS_H
#define LAR_STUDY_BENCH_LAWS_H

#include "study/bench/kernel.h"

enum { LAR_LAW_WORDS = 96 };

typedef struct lar_bench_law_row {
    char words[LAR_LAW_WORDS]; /* "ogden", "yeoh+hgo-pair+viscous-2" */
    lar_spread ratio;          /* of the times */
    lar_spread nanoseconds;    /* of a step per element */
    lar_spread beside;         /* the same of the neo-Hookean block, in between */
    double bytes_per_element;
    int32_t elements, edge[3];
    const char *isa;
} lar_bench_law_row;

/* Viscosity of one, two and three terms is measured; each further one costs as much as the third. */
enum { LAR_BENCH_TERMS = 3 };

/* The words that "all" stands for, one after the other: each law, each law of fibres, so many
 * viscous terms and what is active alone; NULL beyond. */
const char *lar_bench_law_words(int index);

/* The material of some words joined by '+': a law (neo-Hookean without), a law of fibres,
 * "hgo-pair" for two families, "viscous" with one term or "viscous-2", "viscous-3", and "active".
 * LAR_ERROR_ARGUMENT with the words that there are. */
lar_status lar_bench_law_material(const char *words, lar_material *material, lar_error *error);

/* Measures one row, some tenths of a second. Fails as lar_bench_kernel does. */
lar_status lar_bench_law(const lar_bench_kernel_options *options, const char *words,
                         lar_bench_law_row *row, lar_error *error);

#endif
