#include <errno.h>
#include <fcntl.h>
#include <stdio_ext.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file/folder.h"
#include "session/recording/words.h"

static void put_words(lar_recording_writer *writer, const uint64_t *word, size_t count) {
    for (size_t i = 0; i < count && !writer->cause; i++) {
        uint64_t out = htole64(word[i]);
        errno = EIO;
        if (fwrite(&out, sizeof out, 1, writer->file) != 1) writer->cause = errno;
    }
    writer->checksum = lar_chain(writer->checksum, word, count);
    writer->words += count;
}

static void put_checksum(lar_recording_writer *writer) {
    uint64_t checksum = writer->checksum;
    put_words(writer, &checksum, 1);
    writer->checksum = checksum; /* is no part of itself */
}

/* The file, empty, and nobody else's: two recordings in one file would be none. -1: errno says why.
 * A pipe would wait for a reader. */
static int open_empty(const char *path) {
    int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
    if (file < 0) return -1;
    bool taken = flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!taken && ftruncate(file, 0) == 0) return file;
    int cause = taken ? EBUSY : errno;
    close(file);
    errno = cause;
    return -1;
}

lar_status lar_recording_create(const char *path, const lar_recording_header *header,
                                lar_recording_writer *writer, lar_error *error) {
    lar_status status = lar_file_replaceable(path, error);
    if (!status) status = lar_file_spare(path, LAR_RECORDING_MAGIC, "no recording", error);
    if (status) return status;
    int file = open_empty(path);
    *writer = (lar_recording_writer){.path = path, .file = file < 0 ? NULL : fdopen(file, "wb")};
    if (!writer->file && file >= 0) close(file);
    if (!writer->file && errno == EBUSY)
        return lar_fail(error, LAR_ERROR_IO,
                        "%s: another recording is being written to it; choose another name", path);
    if (!writer->file)
        return lar_fail(error, LAR_ERROR_IO, "%s: cannot be written: %s; %s", path, strerror(errno),
                        lar_remedy(errno, LAR_FILE_REMEDY));
    uint64_t version = header->spares > 0 ? LAR_RECORDING_VERSION : LAR_RECORDING_WITHOUT_SPARES;
    uint64_t words[1 + LAR_RECORDING_HEADER_WORDS] = {0,
                                                      version,
                                                      (uint64_t)header->element,
                                                      (uint64_t)header->nodes,
                                                      (uint64_t)header->elements,
                                                      (uint64_t)header->tools,
                                                      (uint64_t)header->hands,
                                                      lar_word_of(header->time_step),
                                                      header->tick_steps,
                                                      header->hash_every,
                                                      (uint64_t)header->spares};
    memcpy(words, LAR_RECORDING_MAGIC, sizeof words[0]);
    words[0] = le64toh(words[0]);
    put_words(writer, words, 1 + LAR_RECORDING_HEADER_WORDS);
    put_checksum(writer);
    return LAR_OK;
}

void lar_recording_put(lar_recording_writer *writer, const lar_record *record) {
    int words = lar_record_words(record->kind);
    uint64_t word[2 + LAR_RECORD_WORDS_MAX] = {(uint64_t)record->kind, 8 * (uint64_t)words,
                                               record->step};
    if (record->kind == LAR_RECORD_HASH) word[3] = record->hash;
    if (record->kind == LAR_RECORD_MOVE) {
        word[3] = (uint64_t)record->tool;
        word[4] = record->steps;
        for (int i = 0; i < 3; i++) word[5 + i] = lar_word_of(record->pose.position[i]);
        for (int i = 0; i < 4; i++) word[8 + i] = lar_word_of(record->pose.orientation[i]);
        word[12] = lar_word_of(record->pose.opening);
    }
    if (record->kind == LAR_RECORD_SET) {
        word[3] = (uint64_t)record->setting.kind;
        word[4] = (uint64_t)(int64_t)record->setting.of ^ (uint64_t)record->setting.members << 32;
        for (int i = 0; i < 3; i++) word[5 + i] = lar_word_of(record->setting.value[i]);
    }
    put_words(writer, word, 2 + (size_t)words);
    put_checksum(writer);
}

void lar_recording_put_state(lar_recording_writer *writer, uint64_t step, const lar_bytes *state) {
    const uint64_t head[3] = {LAR_RECORD_STATE, 8 + (uint64_t)state->size, step};
    put_words(writer, head, 3);
    for (size_t at = 0; at < state->size; at += 8) {
        uint64_t word = 0; /* the last one is filled up */
        memcpy(&word, state->data + at, state->size - at < 8 ? state->size - at : 8);
        word = le64toh(word);
        put_words(writer, &word, 1);
    }
    put_checksum(writer);
    if (!writer->begun) writer->begun = writer->words;
}

void lar_recording_flush(lar_recording_writer *writer) {
    if (writer->file && fflush(writer->file) && !writer->cause) writer->cause = errno;
}

lar_status lar_recording_incomplete(const char *path, int cause, lar_error *error) {
    return lar_fail(error, LAR_ERROR_IO,
                    "%s: the recording could not be written completely: %s; %s, and record again",
                    path, strerror(cause), lar_remedy(cause, "check the free space"));
}

/* What ends before its first state is complete is no recording, and would lie in the way. */
static void remove_stump(const lar_recording_writer *writer, const struct stat *ours) {
    struct stat there;
    bool whole = writer->begun && (uint64_t)ours->st_size >= 8 * writer->begun;
    if (!whole && lstat(writer->path, &there) == 0 && S_ISREG(there.st_mode) &&
        there.st_dev == ours->st_dev && there.st_ino == ours->st_ino)
        unlink(writer->path);
}

lar_status lar_recording_finish(lar_recording_writer *writer, lar_error *error) {
    if (!writer->file) return LAR_OK;
    lar_recording_flush(writer);
    struct stat ours;
    if (writer->cause && fstat(fileno(writer->file), &ours) == 0) remove_stump(writer, &ours);
    if (fclose(writer->file) && !writer->cause) writer->cause = errno;
    writer->file = NULL;
    return writer->cause ? lar_recording_incomplete(writer->path, writer->cause, error) : LAR_OK;
}

void lar_recording_forget(lar_recording_writer *writer) {
    if (!writer->file) return;
    __fpurge(writer->file);
    fclose(writer->file);
    writer->file = NULL;
}
