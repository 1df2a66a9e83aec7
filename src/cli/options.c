#include "cli/options.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "cli/help.h"

/* ---- messages --------------------------------------------------------------------------- */

static int32_t speaker;

void cli_speak_as(int32_t processor) {
    speaker = processor;
}

int32_t cli_speaker(void) {
    return speaker;
}

int cli_complain(const cli_command *command, int status, const char *format, ...) {
    char text[2048];
    va_list args;
    va_start(args, format);
    lar_text_print(text, sizeof text, format, args);
    va_end(args);
    /* What a message quotes from a file must not steer the terminal. */
    for (unsigned char *c = (unsigned char *)text; *c; c++) {
        if (*c < ' ' || *c == 0x7f) *c = '?';
        if (c[0] == 0xc2 && c[1] >= 0x80 && c[1] <= 0x9f) c[0] = c[1] = '?';
    }
    char who[32] = "";
    if (speaker > 0) snprintf(who, sizeof who, "processor %d: ", (int)speaker);
    fprintf(stderr, "lariat%s%s: %s%s\n", command ? " " : "", command ? command->name : "", who,
            text);
    return status;
}

const char *cli_quote(const char *path, char *quoted, size_t size) {
    static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "/._-+,:@%=";
    const char *c = path;
    while (*c && (strchr(PLAIN, *c) || (unsigned char)*c >= 0x80)) c++;
    if (!*c) return path;
    size_t used = 0;
    quoted[used++] = '\'';
    for (c = path; *c && used + 7 < size; c++) {
        const char *as = *c == '\'' ? "'\\''" : (char[]){*c, '\0'};
        used += (size_t)snprintf(quoted + used, size - used, "%s", as);
    }
    snprintf(quoted + used, size - used, "'");
    return *c ? path : quoted;
}

/* Edit distance with neighbours exchanged as one edit (optimal string alignment). Long words are
 * not compared. */
static int distance(const char *a, const char *b) {
    enum { LONGEST = 32 };
    size_t rows = strlen(a), columns = strlen(b);
    int d[LONGEST + 1][LONGEST + 1];
    if (rows > LONGEST || columns > LONGEST) return LONGEST;
    for (size_t i = 0; i <= rows; i++)
        for (size_t j = 0; j <= columns; j++) {
            if (i == 0 || j == 0) {
                d[i][j] = (int)(i + j);
                continue;
            }
            int best = d[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            if (d[i - 1][j] + 1 < best) best = d[i - 1][j] + 1;
            if (d[i][j - 1] + 1 < best) best = d[i][j - 1] + 1;
            bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped && d[i - 2][j - 2] + 1 < best) best = d[i - 2][j - 2] + 1;
            d[i][j] = best;
        }
    return d[rows][columns];
}

const char *cli_nearest_name(const char *word, const char *const *names) {
    const char *nearest = NULL;
    size_t letters = strlen(word + strspn(word, "-"));
    int limit = letters <= 4 ? 1 : 2, min = limit + 1;
    for (; *names; names++) {
        int d = distance(word, *names);
        /* The beginning of a name is meant as that name. */
        if (letters >= 2 && strncmp(word, *names, strlen(word)) == 0) d = 1;
        if (d < min) {
            min = d;
            nearest = *names;
        }
    }
    return nearest;
}

/* ---- values ----------------------------------------------------------------------------- */

static int refuse_value(const cli_command *command, const cli_option *option, const char *text,
                        const char *expected) {
    return cli_complain(command, CLI_USAGE, "%s %s: expected %s", option->name, text, expected);
}

static int parse_real(const cli_command *command, const cli_option *option, const char *text) {
    char *end, expected[160];
    double value = strtod(text, &end);
    if (end != text && *end == '\0' && isfinite(value) && value >= option->min &&
        value <= option->max) {
        *(double *)option->value = value;
        return -1;
    }
    snprintf(expected, sizeof expected, "a number from %g to %g", option->min, option->max);
    return refuse_value(command, option, text, expected);
}

static int parse_count(const cli_command *command, const cli_option *option, const char *text) {
    char *end, expected[160];
    errno = 0;
    long long value = strtoll(text, &end, 10);
    if (end != text && *end == '\0' && errno == 0 && (double)value >= option->min &&
        (double)value <= option->max) {
        *(int64_t *)option->value = value;
        return -1;
    }
    snprintf(expected, sizeof expected, "a whole number from %.0f to %.0f", option->min,
             option->max);
    return refuse_value(command, option, text, expected);
}

static int parse_choice(const cli_command *command, const cli_option *option, const char *text) {
    char expected[160] = "one of";
    for (int i = 0; option->choices[i]; i++) {
        if (strcmp(text, option->choices[i]) == 0) {
            *(int *)option->value = i;
            return -1;
        }
        size_t used = strlen(expected);
        snprintf(expected + used, sizeof expected - used, "%s %s", i > 0 ? "," : "",
                 option->choices[i]);
    }
    return refuse_value(command, option, text, expected);
}

static int parse_texts(const cli_command *command, const cli_option *option, const char *text) {
    cli_texts *texts = option->value;
    if (!*text) return refuse_value(command, option, "\"\"", option->placeholder);
    if (texts->count == CLI_TEXTS_MAX)
        return cli_complain(command, CLI_USAGE, "%s can be given %d times", option->name,
                            CLI_TEXTS_MAX);
    texts->text[texts->count++] = text;
    return -1;
}

static int parse_value(const cli_command *command, const cli_option *option, const char *text) {
    switch (option->kind) {
    case OPTION_FLAG:
        *(bool *)option->value = true;
        return -1;
    case OPTION_TEXT:
        if (*text) *(const char **)option->value = text;
        return *text ? -1 : refuse_value(command, option, "\"\"", option->placeholder);
    case OPTION_REAL:
        return parse_real(command, option, text);
    case OPTION_COUNT:
        return parse_count(command, option, text);
    case OPTION_CHOICE:
        return parse_choice(command, option, text);
    case OPTION_TEXTS:
        return parse_texts(command, option, text);
    }
    return CLI_USAGE;
}

/* ---- the command line ------------------------------------------------------------------- */

static int unknown_option(const cli_command *command, const cli_option *options, const char *name) {
    enum { MAX = 40 };
    const char *names[MAX + 2];
    int count = 0;
    for (; options[count].name && count < MAX; count++) names[count] = options[count].name;
    names[count++] = "--help";
    names[count] = NULL;
    const char *meant = cli_nearest_name(name, names);
    if (meant)
        return cli_complain(command, CLI_USAGE, "unknown option %s; did you mean %s?", name, meant);
    return cli_complain(command, CLI_USAGE, "unknown option %s; lariat %s --help lists them", name,
                        command->name);
}

/* One option, whose value may be the next argument: moves *at behind it. */
static int parse_option(const cli_command *command, const cli_option *options, int argc,
                        char **argv, int *at) {
    char name[64];
    const char *word = argv[(*at)++];
    const char *equals = strchr(word, '=');
    snprintf(name, sizeof name, "%.*s", equals ? (int)(equals - word) : (int)strlen(word), word);
    const cli_option *option = options;
    while (option->name && strcmp(option->name, name) != 0) option++;
    if (!option->name) return unknown_option(command, options, name);
    if (option->kind == OPTION_FLAG) {
        if (equals) return cli_complain(command, CLI_USAGE, "%s takes no value", name);
        return parse_value(command, option, "");
    }
    if (equals) return parse_value(command, option, equals + 1);
    if (*at >= argc)
        return cli_complain(command, CLI_USAGE, "%s needs a value: %s %s", name, name,
                            option->placeholder);
    if (strncmp(argv[*at], "--", 2) == 0)
        return cli_complain(command, CLI_USAGE,
                            "%s needs a value, and %s looks like an option; write %s %s, or "
                            "%s=%s if that is meant",
                            name, argv[*at], name, option->placeholder, name, argv[*at]);
    return parse_value(command, option, argv[(*at)++]);
}

static bool asks_help(int argc, char **argv) {
    for (int i = 0; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) return true;
    return false;
}

/* How many arguments there must be, of those there may be. */
static int min_arguments(const char *arguments, int max) {
    if (arguments[0] == '[') return 0;
    return strstr(arguments, "...") ? 1 : max;
}

int cli_parse(const cli_command *command, const cli_option *options, int argc, char **argv,
              const char **arguments, int argument_count) {
    int given = 0;
    bool only_arguments = false;
    for (int i = 0; i < argument_count; i++) arguments[i] = NULL;
    if (asks_help(argc, argv)) {
        cli_tell_help(command, options);
        return CLI_DONE;
    }
    for (int at = 0; at < argc;) {
        const char *word = argv[at];
        if (!only_arguments && strcmp(word, "--") == 0) {
            only_arguments = true;
            at++;
        } else if (!only_arguments && word[0] == '-' && word[1] != '\0') {
            int status = parse_option(command, options, argc, argv, &at);
            if (status >= 0) return status;
        } else {
            if (given == argument_count)
                return cli_complain(
                    command, CLI_USAGE, "unexpected argument %s; usage: lariat %s%s%s", word,
                    command->name, *command->arguments ? " " : "", command->arguments);
            arguments[given++] = argv[at++];
        }
    }
    if (given < min_arguments(command->arguments, argument_count))
        return cli_complain(command, CLI_USAGE, "%s is missing; usage: lariat %s %s [OPTIONS]",
                            command->arguments, command->name, command->arguments);
    return -1;
}
