#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "base/pose.h"
#include "contact/tools.h"
#include "session/recording/words.h"

/* Sums of two numbers of steps do not overflow. */
static const uint64_t STEPS_MAX = (uint64_t)1 << 60;

lar_status lar_recording_refuse(const lar_recording_reader *reader, lar_error *error,
                                const char *what) {
    return lar_fail(error, LAR_ERROR_FORMAT, "%s: record %" PRIu64 ", at byte %" PRIu64 ", %s",
                    reader->path, reader->number, reader->at, what);
}

static lar_status refuse_cut(const lar_recording_reader *reader, lar_error *error) {
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: the recording is cut off in record %" PRIu64 ", at byte %" PRIu64
                    ", step %" PRIu64
                    ": the process that wrote it was killed, or the file was not copied "
                    "completely; what comes before holds",
                    reader->path, reader->number, reader->at, reader->step);
}

static lar_status refuse_damaged(const lar_recording_reader *reader, lar_error *error) {
    return lar_recording_refuse(reader, error,
                                "is damaged: its checksum does not fit; take an undamaged copy");
}

static bool get_words(lar_recording_reader *reader, uint64_t *word, size_t count) {
    if (fread(word, sizeof *word, count, reader->file) != count) return false;
    for (size_t i = 0; i < count; i++) word[i] = le64toh(word[i]);
    return true;
}

/* ---- the header ---------------------------------------------------------------------------- */

static lar_status check_header(const lar_recording_reader *reader, const uint64_t *word,
                               lar_error *error) {
    double time_step = lar_double_of(word[6]);
    bool good = word[1] <= LAR_ELEMENT_HEX8_MATRIX && word[2] > 0 && word[2] <= INT32_MAX &&
                word[3] > 0 && word[3] <= INT32_MAX && word[4] <= INT16_MAX && word[5] <= word[4] &&
                time_step > 0 && isfinite(time_step) && word[7] > 0 && word[7] <= STEPS_MAX &&
                word[8] > 0 &&
                (word[0] <= LAR_RECORDING_WITHOUT_SPARES || word[9] <= LAR_SPARES_MAX);
    if (good) return LAR_OK;
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: the header of the recording holds numbers that no recording has; take an "
                    "undamaged copy",
                    reader->path);
}

static lar_status read_header(lar_recording_reader *reader, lar_error *error) {
    uint64_t word[LAR_RECORDING_HEADER_WORDS], checksum, first;
    char magic[8];
    if (fread(magic, 1, 8, reader->file) != 8 || memcmp(magic, LAR_RECORDING_MAGIC, 8) != 0)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: is no recording of Lariat; give a file that a session has recorded",
                        reader->path);
    if (!get_words(reader, word, LAR_RECORDING_HEADER_WORDS) || !get_words(reader, &checksum, 1))
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the recording is cut off in its header; take a complete copy",
                        reader->path);
    if (word[0] < 1 || word[0] > LAR_RECORDING_VERSION)
        return lar_fail(
            error, LAR_ERROR_FORMAT,
            "%s: is a recording of version %" PRIu64
            ", and this Lariat reads versions 1 to %d; play it with the Lariat that made it",
            reader->path, word[0], LAR_RECORDING_VERSION);
    memcpy(&first, magic, sizeof first);
    first = le64toh(first);
    reader->checksum = lar_chain(lar_chain(0, &first, 1), word, LAR_RECORDING_HEADER_WORDS);
    if (checksum != reader->checksum)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: the header of the recording is damaged: its checksum does not fit; "
                        "take an undamaged copy",
                        reader->path);
    lar_status status = check_header(reader, word, error);
    if (status) return status;
    reader->header = (lar_recording_header){
        .element = (lar_element_kind)word[1],
        .nodes = (int32_t)word[2],
        .elements = (int32_t)word[3],
        .tools = (int32_t)word[4],
        .hands = (int32_t)word[5],
        .time_step = lar_double_of(word[6]),
        .tick_steps = word[7],
        .hash_every = word[8],
        .spares = word[0] > LAR_RECORDING_WITHOUT_SPARES ? (int32_t)word[9] : 0};
    reader->at = 8 * (2 + LAR_RECORDING_HEADER_WORDS);
    return LAR_OK;
}

lar_status lar_recording_open(const char *path, lar_recording_reader *reader, lar_error *error) {
    struct stat about;
    /* A pipe would keep an ordinary open waiting for somebody who writes into it. */
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    *reader = (lar_recording_reader){.path = path, .file = file < 0 ? NULL : fdopen(file, "rb")};
    if (!reader->file || fstat(fileno(reader->file), &about)) {
        lar_status status = lar_fail(error, LAR_ERROR_IO, "%s: cannot be read: %s; check the path",
                                     path, strerror(errno));
        lar_recording_close(reader);
        return status;
    }
    lar_status status = LAR_OK;
    if (!S_ISREG(about.st_mode))
        status =
            lar_fail(error, LAR_ERROR_IO, "%s: is no file; give one that a session recorded", path);
    reader->size = (uint64_t)about.st_size;
    if (!status) status = read_header(reader, error);
    if (status) lar_recording_close(reader);
    return status;
}

void lar_recording_close(lar_recording_reader *reader) {
    if (reader->file) fclose(reader->file);
    reader->file = NULL;
}

/* ---- records ------------------------------------------------------------------------------- */

static lar_status take_move(const lar_recording_reader *reader, const uint64_t *word,
                            lar_record *record, lar_error *error) {
    if (word[1] >= (uint64_t)(reader->header.tools + reader->header.spares))
        return lar_recording_refuse(
            reader, error, "moves a tool that the recording does not have; it was altered");
    record->tool = (int32_t)word[1];
    record->steps = word[2];
    for (int i = 0; i < 3; i++) record->pose.position[i] = lar_double_of(word[3 + i]);
    for (int i = 0; i < 4; i++) record->pose.orientation[i] = lar_double_of(word[6 + i]);
    record->pose.opening = lar_double_of(word[10]);
    if (record->steps > 0 && record->steps <= STEPS_MAX && lar_pose_is_normal(&record->pose))
        return LAR_OK;
    return lar_recording_refuse(reader, error, "moves a tool to where none can be; it was altered");
}

/* Whether the values make sense is said where they are set. */
static lar_status take_setting(const lar_recording_reader *reader, const uint64_t *word,
                               lar_record *record, lar_error *error) {
    bool on_set = word[1] == LAR_SETTING_FORCE_ON || word[1] == LAR_SETTING_SUPPORT_ON;
    uint64_t members = on_set ? word[2] >> 32 : 0;
    int64_t of = (int64_t)(word[2] ^ members << 32);
    if (word[1] >= LAR_SETTING_KINDS || of < -1 || of > INT32_MAX)
        return lar_recording_refuse(reader, error, "sets what cannot be set; it was altered");
    record->setting = (lar_setting){
        .kind = (lar_setting_kind)word[1],
        .of = (int32_t)of,
        .members = (uint32_t)members,
        .value = {lar_double_of(word[3]), lar_double_of(word[4]), lar_double_of(word[5])}};
    return LAR_OK;
}

/* Hashes come every hash_every steps and a tick. What lies a thousand times as far behind the last
 * one would make whoever plays it compute for ever. */
static bool is_too_late(const lar_recording_reader *reader, uint64_t step) {
    const lar_recording_header *h = &reader->header;
    uint64_t after = (step - reader->known) / 1000;
    return after > h->tick_steps && after - h->tick_steps > h->hash_every;
}

/* Only a reset or a new state goes back in time. */
static lar_status take_record(lar_recording_reader *reader, const uint64_t *word,
                              lar_record *record, lar_error *error) {
    record->step = word[0];
    if (record->step > STEPS_MAX)
        return lar_recording_refuse(reader, error, "has a step beyond all range; it was altered");
    if (record->kind != LAR_RECORD_STATE && record->step < reader->step)
        return lar_recording_refuse(reader, error, "goes back in time; it was altered");
    if (record->kind != LAR_RECORD_STATE && is_too_late(reader, record->step))
        return lar_recording_refuse(
            reader, error,
            "comes far more steps after the last state hash than hashes are apart; it was altered");
    reader->step = record->kind == LAR_RECORD_RESET ? 0 : record->step;
    if (record->kind == LAR_RECORD_STATE || record->kind == LAR_RECORD_RESET ||
        record->kind == LAR_RECORD_HASH)
        reader->known = reader->step;
    if (record->kind == LAR_RECORD_HASH) record->hash = word[1];
    if (record->kind == LAR_RECORD_SET) return take_setting(reader, word, record, error);
    return record->kind == LAR_RECORD_MOVE ? take_move(reader, word, record, error) : LAR_OK;
}

/* Kind and length, and that the file is long enough for them. */
static lar_status read_head(lar_recording_reader *reader, lar_record *record, lar_error *error) {
    uint64_t head[2], left = reader->size - reader->at;
    if (left < 24 || !get_words(reader, head, 2)) return refuse_cut(reader, error);
    int words = lar_record_words(head[0]);
    if (words == 0)
        return lar_recording_refuse(reader, error, "is of an unknown kind: the file is damaged");
    record->kind = (lar_record_kind)head[0];
    bool state = record->kind == LAR_RECORD_STATE;
    if (state ? head[1] < 8 : head[1] != 8 * (uint64_t)words)
        return lar_recording_refuse(reader, error, "has a wrong length: the file is damaged");
    if (head[1] > left - 24 || (head[1] + 7) / 8 * 8 > left - 24) return refuse_cut(reader, error);
    record->bytes = state ? head[1] - 8 : 0;
    reader->checksum = lar_chain(reader->checksum, head, 2);
    return LAR_OK;
}

lar_status lar_recording_next(lar_recording_reader *reader, lar_record *record, lar_error *error) {
    uint64_t word[LAR_RECORD_WORDS_MAX], checksum;
    *record = (lar_record){0};
    reader->number++;
    lar_status status = read_head(reader, record, error);
    if (status) return status;
    size_t words = (size_t)lar_record_words(record->kind);
    if (!get_words(reader, word, words)) return refuse_cut(reader, error);
    reader->checksum = lar_chain(reader->checksum, word, words);
    if (record->kind != LAR_RECORD_STATE) {
        if (!get_words(reader, &checksum, 1)) return refuse_cut(reader, error);
        if (checksum != reader->checksum) return refuse_damaged(reader, error);
        reader->at += 8 * (words + 3);
    }
    return take_record(reader, word, record, error);
}

lar_status lar_recording_state(lar_recording_reader *reader, const lar_record *record,
                               lar_bytes *state, lar_error *error) {
    uint64_t checksum, words = (record->bytes + 7) / 8;
    uint64_t *word = lar_calloc(words, sizeof *word); /* the file is as long as that: read_head */
    lar_status status = LAR_OK;
    if (!word) return lar_fail_memory(error, record->bytes, reader->path);
    if (!get_words(reader, word, words) || !get_words(reader, &checksum, 1))
        status = refuse_cut(reader, error);
    if (!status) {
        reader->checksum = lar_chain(reader->checksum, word, words);
        if (checksum != reader->checksum) status = refuse_damaged(reader, error);
    }
    if (status) {
        free(word);
        return status;
    }
    for (uint64_t i = 0; i < words; i++) word[i] = htole64(word[i]);
    *state = (lar_bytes){(unsigned char *)word, record->bytes};
    reader->at += 8 * (4 + words);
    return LAR_OK;
}

lar_status lar_recording_check_end(const lar_recording_reader *reader, lar_error *error) {
    if (reader->at == reader->size) return LAR_OK;
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s: %" PRIu64 " bytes follow the end of the recording; it was altered",
                    reader->path, reader->size - reader->at);
}
