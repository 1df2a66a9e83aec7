/* The embedded surface, for viewers (binary message 4 of
 * docs/viewer-protocol.md): they move it themselves, by the nodes that frames carry.
 *
 *     surface's nodes 0 .. n-1 | further nodes n .. n+s-1, of the elements that carry vertices
 */
#ifndef LAR_SERVER_EMBEDDED_H
#define LAR_SERVER_EMBEDDED_H

#include "base/memory.h"
#include "server/blob.h"

/* More than a browser moves thirty times a second. */
enum { LAR_EMBEDDED_MAX = 1000000 };

/* The nodes that frames carry, by index in the model: those of the surface, and behind them what a
 * embedded surface needs besides. */
typedef struct lar_shown {
    int32_t count, surface; /* all; of them of the surface */
    int32_t *node;          /* [count], ascending in each of the two parts */
    bool has_embedded;      /* there is an embedded surface to draw */
} lar_shown;

lar_status lar_shown_create(const lar_model *model, lar_shown *shown, lar_error *error);
void lar_shown_destroy(lar_shown *shown); /* idempotent; a zeroed one is fine */

/* Whether the model has an embedded surface with more triangles or vertices than are drawn. */
bool lar_embedded_is_too_large(const lar_model *model);

/* `processor`: of each node of the model. Without an embedded surface the message stays empty. The
 * caller frees message->memory. */
lar_status lar_embedded_message(const lar_model *model, const lar_shown *shown,
                                const float *processor, lar_blob *message, lar_error *error);

#endif
