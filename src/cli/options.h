/* The command line of every command, from one table.
 *
 *     const cli_option options[] = {
 *         CLI_REAL("--time", "S", "simulated seconds", &time, 0, 1e6),
 *         CLI_FLAG("--json", "one JSON object on standard output", &json),
 *         CLI_END};
 *
 * The table parses, checks ranges, and makes the help, the man pages and the completion scripts
 * (help.h): an option cannot exist without being documented. Values may stand behind a space or an
 * equals sign, such as begin with `--` behind an equals sign only; `--` ends the options.
 */
#ifndef LAR_CLI_OPTIONS_H
#define LAR_CLI_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum cli_option_kind {
    OPTION_FLAG,   /* bool *value */
    OPTION_TEXT,   /* const char **value */
    OPTION_REAL,   /* double *value, min..max */
    OPTION_COUNT,  /* int64_t *value, min..max */
    OPTION_CHOICE, /* int *value: index into choices */
    OPTION_TEXTS,  /* cli_texts *value: may be given again and again */
} cli_option_kind;

enum { CLI_TEXTS_MAX = 64 };

typedef struct cli_texts {
    int count;
    const char *text[CLI_TEXTS_MAX];
} cli_texts;

typedef struct cli_option {
    const char *name; /* "--time"; NULL ends the table */
    cli_option_kind kind;
    const char *placeholder; /* of the value in the help */
    const char *help;
    void *value;
    double min, max;
    const char *const *choices; /* NULL ends the list */
} cli_option;

/* Rows of the table: name, placeholder of the value, help, where the value goes, limits. */
#define CLI_FLAG(n, h, v)                                                                          \
    { .name = n, .kind = OPTION_FLAG, .help = h, .value = v }
#define CLI_VALUE(k, n, p, h, v) .name = n, .kind = k, .placeholder = p, .help = h, .value = v
#define CLI_TEXT(n, p, h, v)                                                                       \
    { CLI_VALUE(OPTION_TEXT, n, p, h, v) }
#define CLI_TEXTS(n, p, h, v)                                                                      \
    { CLI_VALUE(OPTION_TEXTS, n, p, h, v) }
#define CLI_REAL(n, p, h, v, from, to)                                                             \
    { CLI_VALUE(OPTION_REAL, n, p, h, v), .min = from, .max = to }
#define CLI_COUNT(n, p, h, v, from, to)                                                            \
    { CLI_VALUE(OPTION_COUNT, n, p, h, v), .min = from, .max = to }
#define CLI_CHOICE(n, p, h, v, names)                                                              \
    { CLI_VALUE(OPTION_CHOICE, n, p, h, v), .choices = names }
#define CLI_END                                                                                    \
    { .name = NULL }

/* One command: what --help prints and what main calls. */
typedef struct cli_command {
    const char *name;                   /* "run" or "bench kernel" */
    const char *summary;                /* one line */
    const char *arguments;              /* "SCENE", "[SCENE]": may be left out, "INPUT...": one or
                                           more, or "" */
    const char *description;            /* a paragraph */
    const char *examples;               /* lines */
    int (*main)(int argc, char **argv); /* behind the command's name; returns the exit status */
} cli_command;

enum {
    CLI_DONE = 0,
    CLI_FAILED = 1,
    CLI_USAGE = 2,
    CLI_UNSTABLE = 3,
    CLI_RESTLESS = 4,
    CLI_INTERRUPTED = 130
};

/* Parses the arguments behind the command's name. Options go to their values; at most
 * `argument_count` others to arguments[] (NULL where fewer are given). Returns -1 to go on, or the
 * exit status when help was printed or the usage is wrong (message printed). */
int cli_parse(const cli_command *command, const cli_option *options, int argc, char **argv,
              const char **arguments, int argument_count);

/* "lariat NAME: message" on standard error, in one piece; returns `status`. */
int cli_complain(const cli_command *command, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A path as one word of a command that is printed to be typed: itself, or in `quoted` (`size`
 * bytes) with quotes that a shell takes off. */
const char *cli_quote(const char *path, char *quoted, size_t size);
enum { CLI_QUOTED = 8192 };

/* From now on messages begin with the processor that they are from; 0: they do not. Who is not
 * processor zero leaves to it what all would say alike. */
void cli_speak_as(int32_t processor);
int32_t cli_speaker(void);

/* The name among `names` (NULL ends them) that `word` was probably meant to be, or NULL. */
const char *cli_nearest_name(const char *word, const char *const *names);

#endif
