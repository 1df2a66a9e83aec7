/* Start-up without a shared file system (T 7.5.7): processor zero gathers and distributes.
 *
 *     others   --- hello: version, backend, identity, number, address --->  zero
 *     zero     --- welcome: a token and all addresses --------------------> everyone
 *                        ... everyone connects to everyone ...
 *     others   --- ready ------------------------------------------------>  zero
 *     zero     --- go ---------------------------------------------------->  everyone
 *
 * Instead of `welcome` and `go` there may be a refusal: one sentence, the same for all, which
 * names the processor that does not fit, did not come, could not connect or died on the way. The
 * connections stay in comm->links for heartbeat.h. A stranger that connects and does not say hello
 * is disconnected after a second.
 */
#ifndef LAR_COMM_RENDEZVOUS_H
#define LAR_COMM_RENDEZVOUS_H

#include "comm/backend.h"

/* Sets comm->addresses, comm->token and comm->links. */
lar_status lar_rendezvous_gather(lar_comm *comm, lar_error *error);

/* `own` is what prevented this processor from connecting, or NULL. LAR_OK only when all can. */
lar_status lar_rendezvous_ready(lar_comm *comm, const lar_error *own, lar_error *error);

/* For what takes time between the two: fails when processor zero has refused, or, at zero, when
 * somebody has gone. Give up then; lar_rendezvous_ready finds out the sentence for all. */
lar_status lar_rendezvous_check(const lar_comm *comm, lar_error *error);

/* Connects to processor p, again and again while nobody listens there; whoever cannot is told who was
 * called. */
lar_status lar_rendezvous_call(int32_t p, const char *address, double deadline, int *socket,
                               lar_error *error);

/* The next connection at `listener`, checking meanwhile; *guest is -1 at the deadline. */
lar_status lar_rendezvous_accept(const lar_comm *comm, int listener, double deadline, int *guest,
                                 lar_error *error);

#endif
