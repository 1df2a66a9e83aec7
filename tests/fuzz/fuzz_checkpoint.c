/* Fuzz target: checkpoints, loaded into two cubes with a ball, a grasper and a hand. Whatever is
 * taken must be fit for computing on: some steps, and packed again the same bytes.
 *
 * Checksums and hashes would stop nearly every input at the door, so each is tried a second time
 * with those, its length and the model's identity put right. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "simulation/checkpoint.h"
#include "step/identity.h"
#include "fuzz/two_cubes.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum {
    AT_VERSION = 8,
    AT_BYTES = 16, /* docs/formats.md */
    AT_IDENTITY = 24,
    AT_STEP = 96,
    AT_HASH = 128,
    AT_COUNTS = 136,
    AT_DIVISION = 144
};

static void load(const lar_bytes *bytes) {
    lar_error error = {0};
    lar_simulation *s = simulation();
    lar_bytes again = {0};
    if (lar_simulation_unpack(s, "fuzz.checkpoint", bytes, &error)) {
        require(error.message[0] != 0);
        return;
    }
    require(lar_simulation_pack(s, "fuzz.checkpoint", &again, &error) == LAR_OK);
    uint32_t version;
    memcpy(&version, bytes->data + AT_VERSION, sizeof version);
    if (version > 5) /* older ones come out as newer ones */
        require(again.size == bytes->size && memcmp(again.data, bytes->data, again.size) == 0);
    lar_bytes_free(&again);
    lar_status status = lar_simulation_advance(s, 3, &error);
    require(status == LAR_OK || status == LAR_ERROR_UNSTABLE);
}

static uint64_t word_at(const lar_bytes *bytes, size_t at) {
    uint64_t word;
    memcpy(&word, bytes->data + at, sizeof word);
    return word;
}

/* Puts right what says that the file is whole and of this model. */
static void repair(lar_bytes *bytes) {
    lar_model_identity identity;
    int32_t counts[2];
    uint64_t length = bytes->size;
    lar_model_identify(&simulation()->domain, &identity);
    memcpy(bytes->data + AT_BYTES, &length, sizeof length);
    memcpy(bytes->data + AT_IDENTITY, &identity, sizeof identity);
    memcpy(counts, bytes->data + AT_COUNTS, sizeof counts);
    size_t offsets = (size_t)NODES * 8, values = 6 * (size_t)NODES * 8, last = bytes->size - 8;
    if (counts[0] == 3 && counts[1] >= 0 && counts[1] <= LAR_GRASPS_MAX &&
        last == AT_DIVISION + sizeof(lar_step_division) + offsetof(lar_settings, activation) +
                    3 * (sizeof(lar_tool_motion) + sizeof(lar_tool_follower)) +
                    (size_t)counts[1] * sizeof(lar_grasp) + offsets + values) {
        uint64_t hash = lar_hash_word(0, word_at(bytes, AT_STEP));
        for (size_t n = 0; n < NODES; n++) {
            uint64_t offset = word_at(bytes, last - values - offsets + 8 * n);
            for (size_t i = 0; i < 6; i++)
                hash = lar_hash_word(hash, word_at(bytes, last - values + (i < 3 ? 0 : values / 2) +
                                                              8 * (3 * n + i % 3)));
            if (offset != 0) hash = lar_hash_word(hash, offset);
        }
        memcpy(bytes->data + AT_HASH, &hash, sizeof hash);
    }
    uint64_t sum = lar_checkpoint_sum(bytes->data, bytes->size / 8 - 1);
    memcpy(bytes->data + last, &sum, sizeof sum);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    lar_bytes bytes = {malloc(size + 1), size};
    if (!bytes.data) return 0;
    if (size > 0) memcpy(bytes.data, data, size);
    bytes.data[size] = 0;
    load(&bytes);
    bytes.size -= bytes.size % 8;
    if (bytes.size >= AT_DIVISION + 8) {
        repair(&bytes);
        load(&bytes);
    }
    lar_bytes_free(&bytes);
    return 0;
}
