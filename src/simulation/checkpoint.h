/* A state in a file: everything that the next step depends on, and nothing about who computes it.
 *
 *     | head | division, forces, tools, grasps | offsets | u of all nodes | v of all nodes |
 * checksum |
 *
 * What it has of the nodes, and in which order, stands in the state's table (layout/state.h).
 *
 * Binary, words of eight bytes, described in docs/formats.md. The nodes are in the mesh's order, so
 * that a checkpoint of one grid goes on on any other; numbers are written as they are, so that the
 * bits are the same. What a state belongs to is hashed part by part (identity.h), for a refusal
 * that says what differs.
 */
#ifndef LAR_SIMULATION_CHECKPOINT_H
#define LAR_SIMULATION_CHECKPOINT_H

#include "step/domain.h"
#include "layout/state.h"
#include "contact/tools.h"

/* What a file begins with. */
#define LAR_CHECKPOINT_MAGIC "LARIATCP"
enum { LAR_CHECKPOINT_MAGIC_BYTES = 8 };

/* What a file says, found to be right. The arrays stand in the bytes that were parsed. */
typedef struct lar_checkpoint {
    uint64_t step;
    double external, damped, contact, exchanged; /* as in lar_state */
    lar_tools tools;
    const double *rows;    /* of the state's table, [nodes of the mesh] each */
    const double *history; /* of step/viscous_history.h, element after element */
} lar_checkpoint;

/* State and tools of the whole model as the bytes of a file, which the caller frees. A state that
 * is not finite is refused. `path` is for messages. */
lar_status lar_checkpoint_pack(const char *path, const lar_domain *whole, const lar_state *state,
                               const lar_tools *tools, lar_bytes *bytes, lar_error *error);
/* Writes them: beside first, then renamed when all of it is on the disk. A path where something
 * else stands is refused. */
lar_status lar_checkpoint_store(const char *path, const lar_bytes *bytes, lar_error *error);

/* Reads the file into memory, unless its size already shows that it is no whole checkpoint. The
 * caller frees the bytes. */
lar_status lar_checkpoint_read(const char *path, lar_bytes *bytes, lar_error *error);

/* Checks every byte. `path` is for messages; `bytes` must stay, at an address that is a multiple of
 * 8, as malloc gives it. What is in *checkpoint after a failure is nothing (it is too large to
 * stand on the stack until then). */
lar_status lar_checkpoint_parse(const char *path, const lar_bytes *bytes, const lar_domain *whole,
                                lar_checkpoint *checkpoint, lar_error *error);

/* Puts a parsed one into the state and tools of the whole model. */
void lar_checkpoint_take(const lar_checkpoint *checkpoint, const lar_domain *whole,
                         lar_state *state, lar_tools *tools);

/* For tests that damage files: the checksum of `words` words, as it stands behind them. */
uint64_t lar_checkpoint_sum(const void *data, size_t words);

#endif
