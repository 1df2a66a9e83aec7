/* What a parallel computer is for a prediction: how fast its processors are and how packets get
 * from one to the other. All times in seconds.
 *
 *     sender     ---[ overhead + bytes x byte ]--> free again
 *     its link            [ gap + bytes / bandwidth ]             one packet after the other
 *     receiver's link              .. latency .. [ the same ]     one packet after the other
 *     receiver                                              |--[ receive + vectors x vector ]-->
 *                                                           its tail is seen
 *
 * The parameters of LogGP (Alexandrov et al. 1995) with the processor's share of a byte beside the
 * link's. `latency` is that of a packet without bytes, from the sender's end of work to the
 * receiver's first sight.
 *
 * Every machine of the table says where each of its numbers is from: measured, from a document, or
 * an assumption. A file may describe another (docs/prediction.md).
 */
#ifndef LAR_STUDY_PREDICT_CLUSTER_H
#define LAR_STUDY_PREDICT_CLUSTER_H

#include "base/memory.h"

enum { LAR_CLUSTER_TEXT = 64, LAR_CLUSTER_NUMBERS = 11 };

typedef enum lar_cluster_number {
    LAR_CLUSTER_ELEMENT = 0, /* to recover an element */
    LAR_CLUSTER_NODE,        /* to move a node */
    LAR_CLUSTER_VECTOR,      /* to take a vector from the sums, or to add it */
    LAR_CLUSTER_STEP,        /* of every thread, once a step */
    LAR_CLUSTER_OVERHEAD,    /* processor time to send a packet */
    LAR_CLUSTER_BYTE,        /* processor time per byte of it */
    LAR_CLUSTER_RECEIVE,     /* processor time to find a packet that is there */
    LAR_CLUSTER_JOIN,        /* until a thread sees what another of its processor has done */
    LAR_CLUSTER_LATENCY,
    LAR_CLUSTER_GAP,      /* of a link between packets */
    LAR_CLUSTER_BANDWIDTH /* of a link, each direction [bytes/s] */
} lar_cluster_number;

/* "element", "node", ... as in machine files. */
extern const char *const lar_cluster_number_name[LAR_CLUSTER_NUMBERS];

typedef struct lar_cluster {
    char name[LAR_CLUSTER_TEXT];
    const char *title;
    double number[LAR_CLUSTER_NUMBERS];
    const char *source[LAR_CLUSTER_NUMBERS]; /* NULL: given by the user */
} lar_cluster;

/* Machine i of the table, or NULL behind its end. */
const lar_cluster *lar_cluster_at(int i);

/* A machine of the table, or of a file (its name has a dot or a slash): lines of a word of
 * lar_cluster_number_name and a number, in us, bandwidth in MB/s; # begins a comment; what is not
 * given is 0. */
lar_status lar_cluster_find(const char *name, lar_cluster *out, lar_error *error);
/* The same from memory, for fuzzing; `path` is for messages. */
lar_status lar_cluster_parse(const char *path, const lar_bytes *bytes, lar_cluster *out,
                             lar_error *error);

/* What makes sense: nothing negative or infinite, element and bandwidth above 0. */
lar_status lar_cluster_check(const lar_cluster *machine, lar_error *error);

/* Seconds that one processor with one thread needs for a step of so many elements and nodes. */
double lar_cluster_alone(const lar_cluster *machine, double elements, double nodes);

/* This machine, measured now: elements by plain steps of the model on one core, packets by the
 * communication benchmark of a backend ("threads", "shm", ...). Takes some seconds. */
lar_status lar_cluster_measure(const lar_model *model, const char *backend, lar_cluster *out,
                               lar_error *error);

#endif
