/* Whether a division can be trusted, in three steps of growing cost (T 6.9, 7.5.8):
 *
 *     schedules   proved from what stands in them, before anything runs
 * (divide/proof/schedule_proof.h) lists       the real program passes lists of elements instead of
 * forces, with random delays: every force arrives at every node once (parallel/verification.h)
 *     forces      the real program with forces: its state is one processor's, bit for bit
 *
 * Each step is a function, so that whoever calls can tell how far it got. Processor zero calls
 * them in this order; other processes call lar_verify_serve instead.
 */
#ifndef LAR_STUDY_VERIFY_H
#define LAR_STUDY_VERIFY_H

#include "divide/proof/schedule_proof.h"
#include "study/processes.h"

typedef struct lar_verify_setting {
    const lar_model *model;
    lar_options options; /* the division; delays 0: those of the lists have the seed 1 */
    uint64_t steps;      /* with forces */
    lar_processes *processes;
} lar_verify_setting;

typedef struct lar_verify_report {
    lar_schedule_proof proof; /* lar_verify_schedules */
    int32_t passes;           /* lar_verify_lists: steps until every element was in a list */
    uint64_t listed;          /* steps with lists */
    uint64_t seed;            /* of their delays */
    uint64_t hash;            /* lar_verify_forces: the state, the same for one processor */
} lar_verify_report;

/* LAR_OK when it holds; otherwise a sentence that says where it does not. */
lar_status lar_verify_schedules(const lar_verify_setting *setting, lar_verify_report *report,
                                lar_error *error);
lar_status lar_verify_lists(const lar_verify_setting *setting, lar_verify_report *report,
                            lar_error *error);
lar_status lar_verify_forces(const lar_verify_setting *setting, lar_verify_report *report,
                             lar_error *error);

lar_status lar_verify_serve(const lar_verify_setting *setting, lar_error *error);

#endif
