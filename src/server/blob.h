/* A binary message in memory, as it is sent, with room before it for the sender's header. */
#ifndef LAR_SERVER_BLOB_H
#define LAR_SERVER_BLOB_H

#include <stddef.h>

enum { LAR_HEADROOM = 64 }; /* bytes before a message */

typedef struct lar_blob {
    unsigned char *memory; /* LAR_HEADROOM bytes, then the message */
    size_t length;         /* 0: there is none */
} lar_blob;

static inline unsigned char *lar_blob_data(const lar_blob *message) {
    return message->memory + LAR_HEADROOM;
}

#endif
