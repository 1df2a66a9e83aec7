/* Which processes are alive: a thread beside the step loop, on the connections of the rendezvous.
 *
 *     everyone  --- heartbeat, ten times a second --->  zero  --- heartbeat --->  everyone
 *     someone   --- "p sends nothing" ---------->  zero  --- "p is lost, because" ---> everyone
 *
 * Processor zero decides: a connection that ends without a goodbye, or three quarters of the
 * timeout without a heartbeat, or the report of a processor that waited in vain: of several within
 * a moment the one from the earliest step, because who is held up by another who waits has come
 * further (T 6.5.2). The verdict goes into *comm->verdict, where every wait looks. The others
 * decide only about processor zero. Whoever was held up itself (between two of its own looks at the
 * clock lies more than a few heartbeats) does not take the others' silence for theirs: they get a
 * whole period anew. So a job that is suspended as a whole goes on when it is continued, and one
 * processor that is stopped alone is missed by the others.
 */
#ifndef LAR_COMM_HEARTBEAT_H
#define LAR_COMM_HEARTBEAT_H

#include "comm/backend.h"

/* Starts the thread; takes nothing over: links are closed by the caller after lar_heartbeat_stop.
 */
lar_status lar_heartbeat_start(lar_comm *comm, lar_error *error);

/* Reports a processor as lost and waits a moment for the verdict, which may name another. */
void lar_heartbeat_report(lar_comm *comm, int32_t processor, lar_comm_loss loss, uint64_t step);

/* Says goodbye and ends the thread, if it runs in this process. */
void lar_heartbeat_stop(lar_comm *comm);

#endif
