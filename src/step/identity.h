/* Numbers that tell whether two simulations compute the same. */
#ifndef LAR_STEP_IDENTITY_H
#define LAR_STEP_IDENTITY_H

#include "step/domain.h"
#include "layout/state.h"

/* Of model, time step, start and division: comm.h refuses a peer with another one. */
uint64_t lar_identity(const lar_domain *whole, const lar_state *start, uint64_t division);

/* What a state belongs to, whatever the division: part by part, so that a state of something else
 * can be refused with the reason (checkpoint.h). Plain; a file has it as it stands. */
typedef struct lar_model_identity {
    uint64_t nodes, elements; /* counts */
    uint64_t element_kind;
    double time_step;   /* [s] */
    uint64_t mesh;      /* hashes: positions and elements in the mesh's order */
    uint64_t materials; /* and which element is made of which */
    uint64_t conditions;
    uint64_t contact;
    uint64_t tools; /* shapes and places at rest, hands among them */
} lar_model_identity;

void lar_model_identify(const lar_domain *whole, lar_model_identity *identity);

/* Of kind and members of a set; names do not count. */
uint64_t lar_set_hash(const lar_set *set);

/* What `conditions` is of a state in which something was set on sets of nodes: these are numbers
 * there, and count by what they stand for. */
uint64_t lar_conditions_with_sets(const lar_model_identity *identity, const lar_model *model);

#endif
