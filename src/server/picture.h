/* What viewers see: the surface, once, and frames of it (binary messages 1 and 2 of
 * docs/viewer-protocol.md; the embedded surface that may ride on it: embedded.h).
 *
 *     model ------------------> surface messages        (once)
 *     snapshot of one step ---> positions, their hash   (once for all viewers)
 *                         '---> values of a field       (once for all viewers that want this field)
 */
#ifndef LAR_SERVER_PICTURE_H
#define LAR_SERVER_PICTURE_H

#include "server/message.h"
#include "server/embedded.h"

enum {
    LAR_FRAME_HEADER = 72,
    LAR_TOOL_WORDS = 16 /* of a tool in a frame */
};

/* The surface of a simulation's model, and its embedded surface, if it has one. The caller frees
 * the memory of both. */
lar_status lar_surface_messages(const lar_simulation *simulation, const lar_model *model,
                                lar_blob *surface, lar_blob *embedded, lar_error *error);

/* Frames of one step, one per field that somebody wants. */
typedef struct lar_picture {
    uint64_t step;
    lar_blob frame[LAR_FIELDS]; /* by the table of fields; length 0: not wanted */
} lar_picture;

/* What makes pictures, with its scratch memory. */
typedef struct lar_painter {
    lar_session *session;
    const lar_simulation *simulation; /* the session's */
    int32_t tools;
    lar_shown shown;
    const double (*rest)[3]; /* [nodes of the model] */
    int32_t nodes;           /* of the model */
    lar_snapshot *snapshot;
    float *value; /* [nodes] of a field */
} lar_painter;

lar_status lar_painter_create(lar_session *session, const lar_model *model, lar_painter *painter,
                              lar_error *error);
void lar_painter_destroy(lar_painter *painter); /* idempotent; a zeroed one is fine */

lar_status lar_picture_create(const lar_painter *painter, lar_picture *picture, lar_error *error);
void lar_picture_destroy(lar_picture *picture);

/* Takes a snapshot, waiting at most `seconds`, and makes the frames of `wanted` (bits: indices into
 * the table of fields) from it. LAR_ERROR_UNSTABLE when the state is not finite. */
lar_status lar_painter_paint(lar_painter *painter, unsigned wanted, double seconds,
                             lar_picture *picture, lar_error *error);

#endif
