/* Fuzz target: recordings, played on two cubes with a ball, a grasper and a hand. What is taken is
 * played for some ticks, whatever it does to the tools.
 *
 * Checksums would stop nearly every input at the door, so each is tried a second time with those
 * put right. */
#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz/two_cubes.h"
#include "session/recording/words.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int few(void *context, uint64_t step) {
    (void)step;
    return ++*(int *)context < 20;
}

static void play(const void *data, size_t size) {
    static int file = -1;
    static char path[64];
    if (file < 0) {
        file = memfd_create("fuzz.recording", 0);
        require(file >= 0);
        snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    }
    require(ftruncate(file, 0) == 0 && pwrite(file, data, size, 0) == (ssize_t)size);
    int ticks = 0;
    lar_error error = {0};
    lar_replay_report report;
    lar_status status = lar_replay(simulation(), path, few, &ticks, &report, &error);
    require(status == LAR_OK || error.message[0] != 0);
    require(status != LAR_ERROR_IO && status != LAR_ERROR_PEER);
}

/* Every record whose end can be found gets the checksum that it should have. */
static void sign(uint64_t *word, size_t words) {
    const size_t header = 1 + LAR_RECORDING_HEADER_WORDS;
    if (words <= header) return;
    uint64_t sum = lar_chain(0, word, header);
    word[header] = sum;
    for (size_t at = header + 1; at + 2 < words;) {
        uint64_t payload = word[at + 1];
        if (payload > 8 * words) return;
        size_t end = at + 2 + (size_t)((payload + 7) / 8);
        if (end >= words) return;
        sum = lar_chain(sum, word + at, end - at);
        word[end] = sum;
        at = end + 1;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint64_t *word = calloc(size / 8 + 1, sizeof *word);
    if (!word) return 0;
    play(data, size);
    if (size > 0) memcpy(word, data, size);
    sign(word, size / 8);
    play(word, size);
    free(word);
    return 0;
}
