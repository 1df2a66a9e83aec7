/* Who sends what to whom in one step (T 3.7), counted from the real sets of nodes.
 *
 * A node that several processors have (P_k) is worth a vector of 24 bytes wherever a part or the
 * whole of its force travels. Sets of nodes by direction (eqs. 3.20 to 3.22): in K^X when P_k
 * spans one channel along x and nothing else, in K^XY when it spans x and y, and so on; irregular
 * when it spans two or more along some axis. With the processors of P_k as corners of a box:
 *
 *     all to all   every one sends its part to every other, the neighbours over local channels
 *     local only   partial sums travel along x, then y, then z (eq. 3.23)
 *     one point    all send to the lowest corner, which sends the sum back
 *     two points   K^XYZ: all send to the lowest and to the highest corner; each of these sends
 *                  the sum to its three neighbours. Others: as local only
 *                  (but each node at once, in two stages)
 *
 *         o---o     +===o     The partial sums of the last three need the whole box. A node whose
 *         | k |     | k |     P_k leaves a corner out (o o o of four), or spans more than one
 *         o---o     o   .     channel, is scattered: its vectors go all to all in every scheme.
 *
 * A node in K^X, K^Y or K^Z is exchanged directly in every scheme.
 *
 * So that no processor works for more corners than others, "lowest" and "highest" are the same
 * direction for all nodes: within a regular grid every processor is it equally often. For a cube
 * of n^3 elements inside a grid of such cubes this gives table 3.1 exactly.
 */
#ifndef LAR_DIVIDE_TRAFFIC_H
#define LAR_DIVIDE_TRAFFIC_H

#include "divide/distribution.h"

enum { LAR_VECTOR_BYTES = 24, LAR_STAGES = 3 };

typedef enum lar_scheme {
    LAR_SCHEME_ALL = 0,
    LAR_SCHEME_LOCAL,
    LAR_SCHEME_ONE,
    LAR_SCHEME_TWO,
    LAR_SCHEMES
} lar_scheme;

/* "all", "local", "one", "two", as on the command line. */
extern const char *const lar_scheme_name[LAR_SCHEMES];

/* How the scheme `local` uses its channels; the others do not care. */
typedef enum lar_channel_use {
    LAR_CHANNELS_SEQUENTIAL = 0, /* x, then y, then z (T 6.6.2.1, algorithm 2) */
    LAR_CHANNELS_CONCURRENT,     /* all at the same time, far travellers first (T 6.6.2.2) */
    LAR_CHANNEL_USES
} lar_channel_use;

/* "sequential", "concurrent", as on the command line. */
extern const char *const lar_channel_use_name[LAR_CHANNEL_USES];

/* ---- sets of nodes ---------------------------------------------------------------------- */

/* Which processors have a node, P_k, for all nodes. */
typedef struct lar_sharing {
    lar_grid grid;
    int32_t node_count;
    int64_t *first;     /* [node_count + 1] */
    int32_t *processor; /* [first[node_count]] ascending within a node; owned as first is */
} lar_sharing;

lar_status lar_sharing_build(const lar_incidence *incidence, const lar_distribution *distribution,
                             lar_sharing *out, lar_error *error);
void lar_sharing_clear(lar_sharing *sharing);

/* P_k of node k: returns the count, *set points into the sharing. */
static inline int32_t lar_sharing_of(const lar_sharing *s, int32_t k, const int32_t **set) {
    *set = s->processor + s->first[k];
    return (int32_t)(s->first[k + 1] - s->first[k]);
}

/* Set of a node by direction: the sum of 1 for x, 2 for y, 4 for z (0: K^I, 3: K^XY, 7: K^XYZ; eqs.
 * 3.20, 3.21), or LAR_DIRECTION_IRREGULAR (eq. 3.22). */
enum { LAR_DIRECTION_IRREGULAR = 8, LAR_DIRECTIONS };
int lar_node_direction(const lar_grid *grid, const int32_t *set, int32_t count);

/* Whether partial sums do not work for it: irregular, or not all corners of its box are taken. */
bool lar_node_scattered(const lar_grid *grid, const int32_t *set, int32_t count);

/* ---- messages --------------------------------------------------------------------------- */

/* One vector on its way. Messages of a later stage leave when those of the stages before have
 * arrived. */
typedef struct lar_message {
    int32_t from, to;
    int stage; /* 0 .. LAR_STAGES - 1 */
    enum {
        LAR_CARRIES_OWN, /* what the sender's own elements give; added by the receiver */
        LAR_CARRIES_SUM, /* what the sender knew before this stage; added by the receiver */
        LAR_CARRIES_ALL  /* the whole force; replaces what the receiver has */
    } what;
    int onward; /* how often what it carries travels on after this, until everybody has it */
} lar_message;
typedef void lar_message_visit(void *context, const lar_message *message);

/* Visits the messages of a node with P_k = set[count] under a scheme. In the concurrent use of
 * local channels a vector with h ways to go is a message of stage LAR_STAGES - h: what travels far
 * leaves first. */
void lar_scheme_messages(lar_scheme scheme, lar_channel_use channels, const lar_grid *grid,
                         const int32_t *set, int32_t count, lar_message_visit *visit,
                         void *context);

/* ---- counts ----------------------------------------------------------------------------- */

/* What one processor sends in one step. It receives as much in the schemes `all` and `local`. */
typedef struct lar_traffic {
    int64_t local, global;                 /* vectors over local and over global channels */
    int64_t local_packets, global_packets; /* vectors of one stage to one peer are one packet */
    int64_t largest_packet;                /* vectors */
} lar_traffic;

/* Mean number of processors that have a node: n_pav = sum of |P_k| / number of nodes (T 3.5). */
double lar_sharing_mean(const lar_sharing *sharing);

/* Vectors of table 3.1 for a cube of n^3 elements inside a grid of such cubes. */
void lar_traffic_formula(lar_scheme scheme, int64_t n, int64_t *local, int64_t *global);

#endif
