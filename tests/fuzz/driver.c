/* A main for fuzz targets where libFuzzer is not at hand, and for the short run in the tests.
 *
 *     fuzz_msh [--runs N] [--from I] [--seconds S] SEED...     (files or folders)
 *
 * First every seed as it is, then N mutated inputs. Input I depends on the seeds and on I alone,
 * so `--from I --runs 1` repeats it; the input that kills the program is saved beside it as
 * fuzz_NAME-I.bin. Besides what the sanitizers find, three things are failures: an input that
 * takes more than 20 seconds, one that leaks (memory in use grows every time it is repeated), and
 * one that makes the target return something else than 0.
 *
 * A mutation is one to four of: a flipped bit, a replaced byte, a cut, a piece taken out or
 * doubled, a number replaced by one that lies at a border, two words swapped, a word or a tail
 * taken from another seed. Words and numbers matter because most formats here are text.
 */
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The sanitizers' runtime, where there is one, and what it asks the program. */
void __sanitizer_set_death_callback(void (*callback)(void)) __attribute__((weak));
size_t __sanitizer_get_current_allocated_bytes(void) __attribute__((weak));
const char *__asan_default_options(void);
const char *__ubsan_default_options(void);

/* A claim in a header that reaches the allocator unchecked is a failure, not a refusal. */
const char *__asan_default_options(void) {
    return "max_allocation_size_mb=512:allocator_may_return_null=0:abort_on_error=1";
}

const char *__ubsan_default_options(void) {
    return "print_stacktrace=1:abort_on_error=1";
}

enum { INPUT_MAX = 1 << 16, SECONDS_PER_INPUT = 20 };

typedef struct input {
    uint8_t *data; /* INPUT_MAX bytes of room */
    size_t size;
} input;

static input *seeds;
static size_t seed_count;

/* What runs now, for the handlers below. */
static const uint8_t *current_data;
static size_t current_size;
static char current_file[256];

/* ---- seeds ------------------------------------------------------------------------------ */

static void need(bool held, const char *what) {
    if (held) return;
    fprintf(stderr, "fuzz: %s: %s\n", what, errno ? strerror(errno) : "not possible");
    exit(2);
}

static void add_seed(const void *data, size_t size) {
    seeds = realloc(seeds, (seed_count + 1) * sizeof *seeds);
    need(seeds, "memory");
    input *seed = &seeds[seed_count++];
    seed->data = calloc(1, INPUT_MAX);
    need(seed->data, "memory");
    seed->size = size < INPUT_MAX ? size : INPUT_MAX;
    memcpy(seed->data, data, seed->size);
}

static void add_seed_file(const char *path) {
    static uint8_t buffer[INPUT_MAX];
    FILE *file = fopen(path, "rb");
    need(file, path);
    size_t size = fread(buffer, 1, sizeof buffer, file);
    fclose(file);
    add_seed(buffer, size);
}

/* A file, or the files of a folder in the order of their names. */
static void add_seeds(const char *path) {
    struct stat info;
    need(stat(path, &info) == 0, path);
    if (!S_ISDIR(info.st_mode)) {
        add_seed_file(path);
        return;
    }
    struct dirent **entry = NULL;
    int count = scandir(path, &entry, NULL, alphasort);
    need(count >= 0, path);
    for (int i = 0; i < count; i++) {
        char file[4096];
        snprintf(file, sizeof file, "%s/%s", path, entry[i]->d_name);
        if (stat(file, &info) == 0 && S_ISREG(info.st_mode)) add_seed_file(file);
        free(entry[i]);
    }
    free(entry);
}

/* Inputs that belong to no format. */
static void add_degenerate_seeds(void) {
    static const uint8_t zeros[64];
    add_seed("", 0);
    add_seed("\n", 1);
    add_seed("0 1 2 -1 1e9 nan\n", 17);
    add_seed(zeros, sizeof zeros);
}

/* ---- chance ----------------------------------------------------------------------------- */

/* splitmix64 (Steele, Lea, Flood 2014). */
static uint64_t chance(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static size_t below(uint64_t *state, size_t bound) {
    return bound ? (size_t)(chance(state) % bound) : 0;
}

/* ---- mutations -------------------------------------------------------------------------- */

/* Replaces [at, at + length) by other bytes, cut to the room that there is. */
static void replace(input *in, size_t at, size_t length, const void *bytes, size_t count) {
    size_t tail = in->size - at - length;
    if (count > INPUT_MAX - at) count = INPUT_MAX - at;
    if (tail > INPUT_MAX - at - count) tail = INPUT_MAX - at - count;
    memmove(in->data + at + count, in->data + at + length, tail);
    memcpy(in->data + at, bytes, count);
    in->size = at + count + tail;
}

static bool in_word(uint8_t c) {
    return !isspace(c) && c != ',' && c != '<' && c != '>' && c != '"' && c != ':' && c != '[' &&
           c != ']' && c != '=';
}

static bool in_number(uint8_t c) {
    return isdigit(c) || c == '.' || c == '-' || c == '+';
}

/* A run of characters of one kind, searched from a place taken by chance. */
static bool pick_run(const input *in, uint64_t *state, bool (*inside)(uint8_t), size_t *at,
                     size_t *length) {
    size_t start = below(state, in->size);
    while (start < in->size && !inside(in->data[start])) start++;
    if (start == in->size) return false;
    while (start > 0 && inside(in->data[start - 1])) start--;
    size_t end = start;
    while (end < in->size && inside(in->data[end])) end++;
    *at = start;
    *length = end - start;
    return true;
}

static void mutate_number(input *in, uint64_t *state) {
    static const char *const border[] = {"0",
                                         "-1",
                                         "1",
                                         "2",
                                         "9",
                                         "127",
                                         "2147483647",
                                         "2147483648",
                                         "-2147483648",
                                         "4294967295",
                                         "4294967296",
                                         "9223372036854775807",
                                         "-9223372036854775808",
                                         "18446744073709551615",
                                         "99999999999999999999999",
                                         "1e308",
                                         "1e309",
                                         "-1e-320",
                                         "nan",
                                         "inf",
                                         "-inf",
                                         "1e",
                                         ".",
                                         "0x10",
                                         "1d5"};
    size_t at, length;
    if (!pick_run(in, state, in_number, &at, &length)) return;
    const char *text = border[below(state, sizeof border / sizeof *border)];
    replace(in, at, length, text, strlen(text));
}

static void mutate_swap_words(input *in, uint64_t *state) {
    size_t at[2], length[2];
    uint8_t word[2][64];
    for (int i = 0; i < 2; i++) {
        if (!pick_run(in, state, in_word, &at[i], &length[i])) return;
        if (length[i] > sizeof word[i]) return;
        memcpy(word[i], in->data + at[i], length[i]);
    }
    int last = at[1] >= at[0]; /* from the back, so that the first place stays valid */
    replace(in, at[last], length[last], word[!last], length[!last]);
    if (at[0] != at[1]) replace(in, at[!last], length[!last], word[last], length[last]);
}

static void mutate_word_from_seed(input *in, uint64_t *state) {
    const input *other = &seeds[below(state, seed_count)];
    size_t at, length, other_at, other_length;
    if (!pick_run(in, state, in_word, &at, &length)) return;
    if (!pick_run(other, state, in_word, &other_at, &other_length)) return;
    replace(in, at, length, other->data + other_at, other_length);
}

/* A piece of at most 256 bytes: taken out, or put in again somewhere else. */
static void mutate_piece(input *in, uint64_t *state, bool twice) {
    uint8_t piece[256];
    size_t at = below(state, in->size);
    size_t length = 1 + below(state, sizeof piece - 1);
    if (length > in->size - at) length = in->size - at;
    memcpy(piece, in->data + at, length);
    if (twice)
        replace(in, below(state, in->size + 1), 0, piece, length);
    else
        replace(in, at, length, "", 0);
}

static void mutate_tail_from_seed(input *in, uint64_t *state) {
    const input *other = &seeds[below(state, seed_count)];
    if (other->size == 0) return;
    size_t at = below(state, in->size), from = below(state, other->size);
    replace(in, at, in->size - at, other->data + from, other->size - from);
}

static void mutate(input *in, uint64_t *state) {
    if (in->size == 0) {
        uint8_t byte = (uint8_t)chance(state);
        replace(in, 0, 0, &byte, 1);
        return;
    }
    size_t at = below(state, in->size);
    switch (below(state, 12)) {
    case 0:
        in->data[at] ^= (uint8_t)(1u << below(state, 8));
        break;
    case 1:
        in->data[at] = (uint8_t)chance(state);
        break;
    case 2:
        in->size = at;
        break;
    case 3:
        mutate_piece(in, state, false);
        break;
    case 4:
        mutate_piece(in, state, true);
        break;
    case 5:
        mutate_swap_words(in, state);
        break;
    case 6:
    case 7:
        mutate_word_from_seed(in, state);
        break;
    case 8:
        mutate_tail_from_seed(in, state);
        break;
    default:
        mutate_number(in, state);
        break;
    }
}

/* Input number `index`: a seed as it is, or one changed by chance. */
static void make_input(input *in, uint64_t index) {
    uint64_t state = index;
    const input *seed = &seeds[index < seed_count ? index : below(&state, seed_count)];
    memcpy(in->data, seed->data, seed->size);
    in->size = seed->size;
    if (index < seed_count) return;
    for (size_t changes = 1 + below(&state, 4); changes > 0; changes--) mutate(in, &state);
}

/* ---- running ---------------------------------------------------------------------------- */

/* Only calls that a signal handler may make. */
static void say(const char *text) {
    if (write(STDERR_FILENO, text, strlen(text)) < 0) _exit(1);
}

static void save_current(void) {
    static volatile sig_atomic_t saved;
    if (saved) return;
    saved = 1;
    int file = open(current_file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    bool written = file >= 0 && write(file, current_data, current_size) == (ssize_t)current_size;
    if (file >= 0) close(file);
    say(written ? "fuzz: the input is saved as " : "fuzz: the input could not be saved as ");
    say(current_file);
    say("\n");
}

static void on_signal(int number) {
    if (number == SIGALRM) say("fuzz: the input takes longer than 20 seconds\n");
    save_current();
    signal(number, SIG_DFL);
    raise(number == SIGALRM ? SIGKILL : number);
}

static void install_handlers(void) {
    static const int deadly[] = {SIGALRM, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL};
    struct sigaction action = {.sa_handler = on_signal};
    int count = sizeof deadly / sizeof *deadly;
    if (__sanitizer_set_death_callback) {
        __sanitizer_set_death_callback(save_current);
        count = 2; /* the runtime explains the others better */
    } else {
        struct rlimit limit = {.rlim_cur = (rlim_t)4 << 30, .rlim_max = (rlim_t)4 << 30};
        setrlimit(RLIMIT_AS, &limit);
    }
    for (int i = 0; i < count; i++) sigaction(deadly[i], &action, NULL);
}

/* Without a sanitizer there is no exact figure, and no leak is looked for. */
static size_t memory_in_use(void) {
    return __sanitizer_get_current_allocated_bytes ? __sanitizer_get_current_allocated_bytes() : 0;
}

/* Runs the input once, from a block of exactly its size, so that a read past the end shows.
 * Returns by how much the memory in use grew. */
static size_t run_once(const input *in) {
    uint8_t *exact = malloc(in->size ? in->size : 1);
    need(exact, "memory");
    memcpy(exact, in->data, in->size);
    current_data = exact;
    current_size = in->size;
    size_t before = memory_in_use();
    alarm(SECONDS_PER_INPUT);
    int result = LLVMFuzzerTestOneInput(exact, in->size);
    alarm(0);
    size_t after = memory_in_use();
    if (result != 0) {
        fprintf(stderr, "fuzz: the target returned %d; it must return 0\n", result);
        save_current();
        _exit(1);
    }
    free(exact);
    return after > before ? after - before : 0;
}

/* A library may keep something at its first use; a leak grows every time. */
static void run_input(const input *in) {
    size_t grown = 0;
    for (int attempt = 0; attempt < 4; attempt++) {
        grown = run_once(in);
        if (grown == 0) return;
    }
    fprintf(stderr, "fuzz: the input leaks %zu bytes every time it is read\n", grown);
    current_data = in->data;
    save_current();
    _exit(1);
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

int main(int argc, char **argv) {
    uint64_t runs = 1000, from = 0;
    double seconds = 1e9;
    const char *name = strrchr(argv[0], '/') ? strrchr(argv[0], '/') + 1 : argv[0];
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--runs") && i + 1 < argc)
            runs = strtoull(argv[++i], NULL, 10);
        else if (!strcmp(argv[i], "--from") && i + 1 < argc)
            from = strtoull(argv[++i], NULL, 10);
        else if (!strcmp(argv[i], "--seconds") && i + 1 < argc)
            seconds = strtod(argv[++i], NULL);
        else
            add_seeds(argv[i]);
    }
    size_t given = seed_count;
    add_degenerate_seeds();
    install_handlers();

    input in = {.data = calloc(1, INPUT_MAX)};
    need(in.data, "memory");
    double start = now();
    uint64_t done = 0;
    uint64_t wanted = from == 0 ? runs + seed_count : runs;
    while (done < wanted && now() - start < seconds) {
        uint64_t index = from + done++;
        snprintf(current_file, sizeof current_file, "%s-%" PRIu64 ".bin", name, index);
        make_input(&in, index);
        run_input(&in);
    }
    printf("%s: %" PRIu64 " inputs from %zu seeds in %.1f s%s\n", name, done, given, now() - start,
           done < wanted ? " (cut short by --seconds)" : "");

    free(in.data);
    for (size_t i = 0; i < seed_count; i++) free(seeds[i].data);
    free(seeds);
    return 0;
}
