/* Contact of bodies on the parallel computer: who needs whose places, and how they come there.
 *
 *     search        between two stretches of steps, when nobody computes: processor zero searches
 *                   the whole model and everyone gets the same list of groups (computer_contact.c)
 *     compile       each processor takes the groups that concern it: it accounts for the node, or
 *                   recovers the element behind a face that may push, or has the node of a group
 *                   within one body, or of rough ones, and keeps what it remembers. All who take
 * part in a group need the places of all its nodes, and compute its contact to the same bits; who
 * accounts for the node adds the node's force, who recovers the element the forces of the corners.
 * So nothing but places travels, with velocities and offsets, once per step. each step     publish
 * --> buffer --> packets to others --> their buffers --> contact
 *
 * The exchange buffer. A thread may not read the displacements of nodes that others move: nothing
 * makes those wait for it, unless it has an element there. So every thread copies the contact nodes
 * that it moves into the processor's exchange buffer when a step is over, one of two sides by the
 * parity of the round, and sets its flag to the round for which they are good. Contact of round r
 * begins when all flags have reached r. Side r is written again for round r + 2, at the end of
 * round r + 1, by threads that have seen all flags reach r + 1; a thread sets its flag to r + 1
 * after it has read side r. So nobody writes what is still read.
 *
 * Packets. Thread 0 sends, at the beginning of round r, what others lack, waits for what this
 * processor lacks when its first elements are recovered, and copies it into the exchange buffer;
 * then it sets `arrived` to r. Regions lie behind the schedule's part of each receive buffer, one
 * per sender, large enough for all contact nodes that the sender accounts for. A packet is put
 * against the END of its region (as in control.h): its tail never moves, and no payload ever covers
 * it, whatever its length is after the next search. Between two processors there are always packets
 * in both directions, possibly empty. So buffering by parity holds: the sender of round r + 2 has
 * heard the receiver's packet of round r + 1, which the receiver sent when all its threads had set
 * their flags to r + 1, which they do after reading what came in round r. When lists change, all
 * have stopped in the same step and every packet that was sent has been waited for.
 *
 * How long a list is good. Every thread adds up how far its own nodes can have moved since the
 * search, from the fastest of each round, and asks everyone to stop early enough for the rounds
 * that the request takes to go round, at a speed of twice its present one, and of at least
 * LAR_CONTACT_SPEED. If it moves farther than the list allows even so, the run ends with a fault:
 * nothing is missed silently.
 */
#ifndef LAR_PARALLEL_CONTACT_EXCHANGE_H
#define LAR_PARALLEL_CONTACT_EXCHANGE_H

#include "parallel/processor.h"

/* A speed that any node may reach within a few steps [m/s]. */
#define LAR_CONTACT_SPEED 2.0

/* Who has which contact nodes and faces. The same on all processors, constant. */
typedef struct lar_contact_map {
    const lar_contact_surface *surface;
    int32_t processors;
    int32_t *reporter;   /* [contact nodes] the processor that accounts for it */
    int32_t *recoverer;  /* [contact faces] the processor that has the element behind it */
    int32_t *has_first;  /* [contact nodes + 1] processors that have the node: */
    int32_t *has;        /* ascending for each node */
    size_t *region;      /* [processors + 1] where its region begins among all regions */
    const size_t *shift; /* [processors] bytes of a receive buffer before the regions */
} lar_contact_map;

/* elements[e]: the processor that recovers element e; reporter[node]: as in lar_division. `surface`
 * and `shift` outlive the map. Cleared with lar_contact_map_clear, also after a failure. */
lar_status lar_contact_map_create(const lar_model *model, const lar_contact_surface *surface,
                                  int32_t processors, const int32_t *elements,
                                  const int32_t *reporter, const size_t *shift,
                                  lar_contact_map *map, lar_error *error);
void lar_contact_map_clear(lar_contact_map *map); /* idempotent */

/* Bytes of all regions in a half of a receive buffer. */
static inline size_t lar_contact_bytes(const lar_contact_map *map) {
    return map->surface ? map->region[map->processors] : 0;
}

/* Of a node in a packet: its place, and behind it what it remembers where bodies rub. */
static inline size_t lar_contact_node_bytes(const lar_contact_surface *surface) {
    return (LAR_PLACE_VALUES + (surface->rough ? LAR_STICK_VALUES : 0)) * sizeof(double);
}

/* The round for which something is good, alone in its cache line, and how fast it is. */
typedef struct lar_contact_sequence {
    uint64_t round;  /* atomic */
    double speed[2]; /* by parity: the largest of an axis of the nodes published [m/s] */
} __attribute__((aligned(64))) lar_contact_sequence;

/* What one other processor gets and gives. */
typedef struct lar_contact_peer {
    int32_t peer, send_count, receive_count;
    int32_t *send, *receive; /* slots */
} lar_contact_peer;

/* What a thread publishes. */
typedef struct lar_publish_list {
    int32_t count;
    int32_t *slot, *node; /* [count] where, and which contact node */
} lar_publish_list;

/* One processor's part of it. */
typedef struct lar_contact_exchange {
    const lar_contact_map *map;
    int32_t *local;  /* [contact nodes] local node, -1: not here */
    int32_t *mover;  /* [contact nodes] thread that moves it, -1: not here */
    int32_t *pusher; /* [contact faces] thread that recovers its element, -1: not here */
    int32_t *loader; /* [contact nodes] thread that adds its force, -1: another processor */
    int32_t slot_count;
    int32_t *slot;                        /* [contact nodes], -1: not in it */
    double (*place[2])[LAR_PLACE_VALUES]; /* [contact nodes] by slot, as in lar_contact_view, */
    double (*stick[2])[LAR_STICK_VALUES]; /* and where bodies rub, or NULL */
    lar_publish_list *publish;            /* [threads] */
    lar_contact_sequence *sequence;       /* [threads] */
    lar_contact_sequence arrived;
    int32_t peer_count, peer_room;
    lar_contact_peer *peer; /* [peer_room], those in use first */
    unsigned char *gather;
    uint8_t *marked; /* [contact nodes] scratch */
} lar_contact_exchange;

/* For a processor whose threads are there: also their worker->interactions.body_contact. `whole` is
 * the whole model's; without contacts of bodies nothing is made. Of `share` the thread does not
 * matter.
 */
lar_status lar_contact_exchange_create(const lar_body_contact *whole,
                                       const lar_condition_share *share, const int32_t *reporter,
                                       int32_t processors, lar_processor *processor,
                                       lar_error *error);
void lar_contact_exchange_destroy(lar_processor *processor); /* idempotent */

/* Takes the groups of a list that concern this processor. Asks for no memory. */
void lar_contact_compile(lar_processor *processor, const lar_contact_map *map,
                         const lar_contact_list *list);

/* Before the first step of a stretch, when nobody computes; without contact nothing. */
void lar_contact_begin(lar_processor *processor);
/* Puts the nodes that this thread moves into the exchange buffer of a round. */
void lar_contact_publish(lar_worker *worker, uint64_t round);

/* In a step: sends; then receives and adds the forces. */
lar_status lar_contact_send(lar_worker *worker, uint64_t round, lar_error *error);
lar_status lar_contact_apply(lar_worker *worker, uint64_t round, lar_error *error);

/* After a round: asks for a stop in time, or reports a fault. `rounds`: until all have stopped;
 * `ends`: they stop now, and the list is looked at before it is used again. */
void lar_contact_check_travel(lar_worker *worker, uint64_t rounds, bool ends);

#endif
