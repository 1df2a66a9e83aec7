/* The fibres' phases of the kernels (hex8_kernel.c): what they add to the stress of the law, and,
 * behind what relaxes, what is active. For kernels only.
 */
#ifndef LAR_MECHANICS_HEX8_FIBRE_H
#define LAR_MECHANICS_HEX8_FIBRE_H

#include "law/fibre_stress.h"
#include "mechanics/hex8_gather.h"

LAR_INLINE lar_fibre_lane fibre_lane_of(const lar_fibre_block *block, int lane) {
    lar_fibre_lane c = {.along = lar_lane_load(&block->along[lane]),
                        .across = lar_lane_load(&block->across[lane])};
    for (int i = 0; i < 3; i++) c.direction[i] = lar_lane_load(&block->direction[i][lane]);
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        c.parameter[k] = lar_lane_load(&block->parameter[k][lane]);
    return c;
}

/* One family of some blocks, in short loops, for the law is as long a chain as that of the
 * material. Returns those lanes that are beyond the limit `max`; where somebody `watches`,
 * *strained gets those that are much stiffer. Of a pair the larger number counts. */
LAR_INLINE unsigned stretch_family(int kind, const lar_fibre_block *fibres, int32_t b, size_t count,
                                   double max, bool watches, lar_lane gradient[][9],
                                   lane_record *record, lane_strain *strain, unsigned *strained) {
    lar_fibre_stretch to[CHUNK * PARTS];
    lar_fibre_answer now[CHUNK * PARTS];
    unsigned beyond = 0;
    for (size_t part = 0; part < count * PARTS; part++) {
        lar_fibre_lane c =
            fibre_lane_of(&fibres[(size_t)b + part / PARTS], part % PARTS * LAR_LANES);
        to[part] = lar_fibre_look(kind, gradient[part], &c);
    }
    for (size_t part = 0; part < count * PARTS; part++) {
        lar_fibre_lane c =
            fibre_lane_of(&fibres[(size_t)b + part / PARTS], part % PARTS * LAR_LANES);
        lar_fibre_answer answer =
            lar_fibre_tension(lar_fibre_kind_law(kind), to[part].square, c.parameter);
        now[part].tension = answer.tension;
        if (watches) now[part].slope = answer.slope;
    }
    for (size_t part = 0; part < count * PARTS; part++) {
        int lane = (int)(part % PARTS) * LAR_LANES;
        const lar_fibre_block *block = &fibres[(size_t)b + part / PARTS];
        lar_fibre_lane c = fibre_lane_of(block, lane);
        lar_lane stiff, *number = &strain[part].number[LAR_STRAIN_FIBRE];
        lar_lane size = lar_fibre_pull(kind, gradient[part], &c, &to[part], &now[part],
                                       watches ? &stiff : NULL, record[part].F);
        beyond |= lar_lane_not_greater(lar_lane_set(max), size) << part * LAR_LANES;
        if (!watches) continue;
        unsigned soft = lar_lane_not_greater(stiff, lar_lane_load(&block->limit[lane]));
        *strained |= (~soft & ((1U << LAR_LANES) - 1)) << part * LAR_LANES;
        *number = kind == LAR_FIBRE_KIND_SPREAD ? lar_lane_max(to[part].length, *number)
                                                : to[part].length;
    }
    return beyond;
}

/* `now` and `energy`: of these lanes (lar_active_step), or NULL. */
LAR_INLINE unsigned active_lanes(const lar_fibre_block *block, int lane, const lar_lane F[9],
                                 const double *now, double *energy, double limit, lar_lane P[9]) {
    lar_fibre_lane c;
    for (int i = 0; i < 3; i++) c.direction[i] = lar_lane_load(&block->direction[i][lane]);
    c.along = lar_lane_load(&block->along[lane]);
    c.across = lar_lane_load(&block->across[lane]);
    if (now) {
        lar_lane_store(energy, lar_active_potential(F, &c));
        c.along = c.along * lar_lane_load(now);
        c.across = c.across * lar_lane_load(now);
    }
    return lar_lane_not_greater(lar_lane_set(limit), lar_active_stress(F, &c, P));
}

#endif
