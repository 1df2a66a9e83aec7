/* What the writer and the reader of recordings share: words and their chain (file.h). */
#ifndef LAR_SESSION_RECORDING_WORDS_H
#define LAR_SESSION_RECORDING_WORDS_H

#include <endian.h>
#include <string.h>

#include "base/hash.h"
#include "session/recording/file.h"

/* Eight bytes that no text file begins with; a transfer that changes line ends breaks them. */
#define LAR_RECORDING_MAGIC "\x89LARREC\n"

enum {
    LAR_RECORDING_VERSION = 3,        /* version 1 had no settings, and is read */
    LAR_RECORDING_WITHOUT_SPARES = 2, /* is written where no tool can be added */
    LAR_RECORDING_HEADER_WORDS = 10,  /* behind the magic, without the checksum */
    LAR_RECORD_WORDS_MAX = 11         /* of the payload, but for states */
};

/* Words of a record's payload; of a state: those before the checkpoint. 0: no such kind. */
static inline int lar_record_words(uint64_t kind) {
    switch (kind) {
    case LAR_RECORD_STATE:
        return 1;
    case LAR_RECORD_MOVE:
        return 11;
    case LAR_RECORD_HASH:
        return 2;
    case LAR_RECORD_RESET:
        return 1;
    case LAR_RECORD_END:
        return 1;
    case LAR_RECORD_SET:
        return 6;
    default:
        return 0;
    }
}

static inline uint64_t lar_word_of(double value) {
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}

static inline double lar_double_of(uint64_t word) {
    double value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* The chain over words as they are in memory, not in the file. */
static inline uint64_t lar_chain(uint64_t checksum, const uint64_t *word, size_t count) {
    for (size_t i = 0; i < count; i++) checksum = lar_hash_word(checksum, word[i]);
    return checksum;
}

#endif
