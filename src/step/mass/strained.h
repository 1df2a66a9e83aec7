/* The strained elements of a domain, beside the state: what is known of them, and how they are
 * looked at side by side, for their barriers (step/guard.c) and for how fast they have become
 * (measured.c). */
#ifndef LAR_STEP_MASS_STRAINED_H
#define LAR_STEP_MASS_STRAINED_H

#include "layout/state.h"
#include "mechanics/hex8_guard.h"
#include "step/domain.h"

/* What damped an element in the step before, and what its barriers should have pushed with. */
typedef struct lar_damped {
    lar_gid element;
    float step;      /* that its nodes then moved [s] */
    float half_mean; /* of the time that the force acted [s] */
    float damper[8]; /* of each corner: what takes energy [J] */
    float lack[8];   /* what a softened barrier lacks [J] */
    bool gone;       /* there were no barriers */
} lar_damped;

/* While lar_strained.travel is below `until` an element's lar_hex8_areas are not more than that
 * [m^4]; while it is below `far` one of its corners is below twice START, and none below START. */
typedef struct lar_steady {
    double areas, until, far;
} lar_steady;

/* The strained elements of a domain's runs, beside the state: each run has the places of its
 * blocks, and is one thread's. */
struct lar_strained {
    int32_t *lane;         /* [8 for each block] what is looked at in every step */
    int32_t *count;        /* [run_count] of these, from the first of a run's places on */
    int32_t *listed_count; /* [run_count] elements that the last monitor has listed in `lane` */
    float (*strain)[LAR_STRAIN_NUMBERS]; /* [8 for each block] scratch of a monitor */
    int32_t *near;                       /* [8 for each block] scratch: lanes with a corner below */
    double *stiffness;  /* twice START, and of their barriers, likewise [N/m], or LAR_BARRIER_FAR */
    bool follows;       /* one thread moves all nodes: it is known how far they can have gone */
    double travel;      /* that is, along any way [m] */
    double *sound;      /* [8 for each block] `travel` until which no corner is below twice START */
    lar_steady *steady; /* [8 for each block] of those that have been looked at */
    lar_damped *damped; /* [8 for each block] with half of their work to come */
    int32_t *damped_count; /* [run_count] of these, as above */
    int32_t *lacked;       /* [8 for each block] scratch: elements whose barriers were softer than
                              their energy says in the step before */
    int32_t *lacked_count; /* [run_count] of these, as above */
    double *activation;    /* [8 for each block] scratch (step/activation.h), */
    double *active_energy; /* likewise; NULL where nothing is active */
    uint8_t *pressed;      /* [elements of the model] step/mass/pressed.h; NULL: none is heavier */
    uint8_t *beyond;       /* [blocks] of lar_viscous_step, zero but in a step that fails */
};

lar_status lar_strained_create(const lar_domain *domain, lar_strained *strained, lar_error *error);
void lar_strained_destroy(lar_strained *strained); /* idempotent */

/* Elements are listed when a corner is no farther from its barrier than twice START. That no corner
 * comes there before the next list is made is no theorem: in fast pushes with tools at 1.6 m/s the
 * least corner that was not listed stood at 0.48. Where nodes go farther within an interval, lists
 * are made in every step (LAR_THROWN). */
static const double LAR_GUARD_SHARES[2] = {LAR_GUARD_START, 2 * LAR_GUARD_START};

/* Part of the step by which the damping leads; it counts twice beside the spring (theory.md 10). */
static const double LAR_BARRIER_LEAD = 0.5;

/* Elements of one run, a lane each. */
typedef struct lar_strained_group {
    lar_hex8_group hex8;
    int count;
    int32_t lane[LAR_BLOCK];  /* block * 8 + lane */
    int32_t entry[LAR_BLOCK]; /* of a list */
    lar_gid element[LAR_BLOCK];
} lar_strained_group;

/* A lane of run r goes into a group that is not full, with where a list has it. */
void lar_group_add(const lar_domain *domain, int32_t r, int32_t lane, int32_t entry,
                   lar_strained_group *group);

/* All lanes are computed with. */
static inline unsigned lar_group_fill(lar_strained_group *group) {
    for (int at = group->count; at < LAR_BLOCK; at++) {
        for (int a = 0; a < 8; a++) group->hex8.node[a][at] = group->hex8.node[a][0];
        group->hex8.largest[at] = 0;
    }
    return (1U << group->count) - 1;
}

/* Corners of a lane of run r as the mesh counts them: forces of several are added in that order. */
unsigned lar_corners_in_mesh(const lar_domain *domain, int32_t r, int32_t lane, unsigned at);

/* Where the corners of an element are at rest and now, and how fast they are (`v` may be NULL). */
void lar_strained_corners(const lar_domain *domain, const lar_state *state, lar_gid e,
                          double rest[8][3], double now[8][3], double v[8][3]);

/* Which is below zero where there is none. */
static inline lar_gid lar_lane_element(const lar_domain *domain, int32_t r, uint32_t lane) {
    const lar_lanes *block = domain->layout.block + domain->run_first[r] + lane / LAR_BLOCK;
    return block->element[lane % LAR_BLOCK];
}

#endif
