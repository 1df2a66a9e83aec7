/* Start-up without a shared file system (T 7.5.7): processor zero gathers and distributes.
 *
 *     others   --- hello: version, backend, identity, number, address --->  zero
 *     zero     --- welcome: a token and all addresses --------------------> everyone
 *                        ... everyone connects to everyone ...
 *     others   --- ready ------------------------------------------------>  zero
 *     zero     --- go ---------------------------------------------------->  everyone
 *
 * Instead of `welcome` and `go` there may be a refusal: one sentence, the same for all, which
 * names the processor that does not fit, did not come or could not connect. The connections stay
 * in comm->links for watch.h. A stranger that connects and does not say hello is shown out after a
 * second.
 */
#ifndef LAR_COMM_MEETING_H
#define LAR_COMM_MEETING_H

#include "comm/backend.h"

/* Sets comm->addresses, comm->token and comm->links. */
lar_status lar_meeting_gather(lar_comm *comm, lar_error *error);

/* `own` is what prevented this processor from connecting, or NULL. LAR_OK only when all can. */
lar_status lar_meeting_ready(lar_comm *comm, const lar_error *own, lar_error *error);

#endif
