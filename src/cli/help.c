#include "cli/help.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "base/error.h"
#include "cli/commands.h"

/* The form in which the next command that is asked for help tells it. */
static struct {
    cli_help_form form;
    FILE *out; /* NULL: standard output */
} wanted;

/* ---- text ----------------------------------------------------------------------------------- */

static void print_option(FILE *out, const char *name, const char *placeholder, const char *help) {
    char left[64];
    enum { COLUMN = 26 };
    snprintf(left, sizeof left, "%s%s%s", name, placeholder ? " " : "",
             placeholder ? placeholder : "");
    fprintf(out, "  %-*s", COLUMN, left);
    if (strlen(left) >= COLUMN) fprintf(out, "\n  %*s", COLUMN, "");
    for (const char *c = help; *c; c++) {
        fputc(*c, out);
        if (*c == '\n') fprintf(out, "  %*s", COLUMN, "");
    }
    fputc('\n', out);
}

static void print_text(FILE *out, const cli_command *command, const cli_option *options) {
    fprintf(out, "lariat %s: %s\n\nUsage: lariat %s%s%s%s\n\n%s\n\nOptions:\n", command->name,
            command->summary, command->name, *command->arguments ? " " : "", command->arguments,
            " [OPTIONS]", command->description);
    for (; options->name; options++)
        print_option(out, options->name, options->placeholder, options->help);
    print_option(out, "--help", NULL, "this text");
    fprintf(out, "\nExamples:\n%s", command->examples);
}

void cli_tell_help(const cli_command *command, const cli_option *options) {
    FILE *out = wanted.out ? wanted.out : stdout;
    switch (wanted.form) {
    case CLI_HELP_TEXT:
        print_text(out, command, options);
        break;
    case CLI_HELP_MAN:
        cli_help_man(out, command, options);
        break;
    case CLI_HELP_BASH:
    case CLI_HELP_ZSH:
    case CLI_HELP_FISH:
        cli_completion_add(out, wanted.form, command, options);
        break;
    }
}

/* ---- commands that are asked ----------------------------------------------------------------- */

/* A command's options are known to the command alone: it is asked as a user would. */
static void ask(const cli_command *command, cli_help_form form, FILE *out) {
    char *help[] = {"--help"};
    wanted.form = form;
    wanted.out = out;
    command->main(1, help);
    wanted.form = CLI_HELP_TEXT;
    wanted.out = NULL;
}

static void tell_completion(cli_help_form shell, FILE *out) {
    cli_completion_begin(out, shell);
    for (int i = 0; cli_commands[i]; i++) ask(cli_commands[i], shell, out);
    for (int i = 0; cli_benchmarks[i]; i++) ask(cli_benchmarks[i], shell, out);
    cli_completion_end(out, shell);
}

/* "run", or "bench" and "kernel". NULL: there is none. */
static const cli_command *find(const char *first, const char *second) {
    char name[64];
    snprintf(name, sizeof name, "%s%s%s", first, second ? " " : "", second ? second : "");
    for (int i = 0; cli_commands[i]; i++)
        if (strcmp(cli_commands[i]->name, name) == 0) return cli_commands[i];
    for (int i = 0; cli_benchmarks[i]; i++)
        if (strcmp(cli_benchmarks[i]->name, name) == 0) return cli_benchmarks[i];
    return NULL;
}

/* ---- files ----------------------------------------------------------------------------------- */

static int cannot_write(const char *path) {
    return cli_complain(&cli_help, CLI_FAILED, "%s cannot be written: %s; %s", path,
                        strerror(errno), lar_remedy(errno, "name another folder, or make room"));
}

/* Opens DIR/FOLDER/NAME, folders made. NULL: told. */
static FILE *open_file(const char *directory, const char *folder, const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s/%s", directory, folder, name);
    for (char *c = path + 1; *c; c++) {
        if (*c != '/') continue;
        *c = '\0';
        mkdir(path, 0777); /* what fails here, fopen tells */
        *c = '/';
    }
    FILE *file = fopen(path, "w");
    if (!file) cannot_write(path);
    return file;
}

static int close_file(FILE *file, const char *name) {
    bool failed = ferror(file) != 0;
    return fclose(file) != 0 || failed ? cannot_write(name) : CLI_DONE;
}

static int write_page(const char *directory, const cli_command *command) {
    char name[80];
    snprintf(name, sizeof name, "lariat%s%s.1", command ? "-" : "", command ? command->name : "");
    for (char *c = name; *c; c++)
        if (*c == ' ') *c = '-';
    FILE *file = open_file(directory, "man/man1", name);
    if (!file) return CLI_FAILED;
    if (command)
        ask(command, CLI_HELP_MAN, file);
    else
        cli_help_man_overview(file);
    return close_file(file, name);
}

static int write_all(const char *directory) {
    static const struct {
        cli_help_form shell;
        const char *folder, *name;
    } scripts[] = {{CLI_HELP_BASH, "bash-completion/completions", "lariat"},
                   {CLI_HELP_ZSH, "zsh/site-functions", "_lariat"},
                   {CLI_HELP_FISH, "fish/vendor_completions.d", "lariat.fish"}};
    int status = write_page(directory, NULL);
    for (int i = 0; cli_commands[i] && !status; i++)
        status = write_page(directory, cli_commands[i]);
    for (int i = 0; cli_benchmarks[i] && !status; i++)
        status = write_page(directory, cli_benchmarks[i]);
    for (size_t i = 0; i < sizeof scripts / sizeof *scripts && !status; i++) {
        FILE *file = open_file(directory, scripts[i].folder, scripts[i].name);
        if (!file) return CLI_FAILED;
        tell_completion(scripts[i].shell, file);
        status = close_file(file, scripts[i].name);
    }
    return status;
}

/* ---- lariat help ----------------------------------------------------------------------------- */

static int help_main(int argc, char **argv) {
    static const char *const shells[] = {"bash", "zsh", "fish", NULL};
    const char *words[2], *directory = NULL;
    int shell = -1;
    bool man = false;
    const cli_option options[] = {
        CLI_FLAG("--man", "the man page, of COMMAND or of lariat itself", &man),
        CLI_CHOICE("--completion", "SHELL", "the completion script of bash, zsh or fish", &shell,
                   shells),
        CLI_TEXT("--write", "DIR",
                 "write all man pages and completion scripts below DIR, as\nthey lie below "
                 "/usr/share",
                 &directory),
        CLI_END};
    int status = cli_parse(&cli_help, options, argc, argv, words, 2);
    if (status >= 0) return status;
    if ((words[0] && (shell >= 0 || directory)) || man + (shell >= 0) + (directory != NULL) > 1)
        return cli_complain(&cli_help, CLI_USAGE,
                            "--completion and --write tell of all commands: give one of them, and "
                            "neither a command nor --man");
    if (directory) return write_all(directory);
    if (shell >= 0) {
        tell_completion((cli_help_form)(CLI_HELP_BASH + shell), stdout);
        return CLI_DONE;
    }
    if (!words[0]) {
        if (man)
            cli_help_man_overview(stdout);
        else
            cli_print_overview(stdout);
        return CLI_DONE;
    }
    const cli_command *command = find(words[0], words[1]);
    if (!command && words[1] && find(words[0], NULL))
        return cli_complain(&cli_help, CLI_USAGE,
                            "there is no %s of %s; lariat %s --help says more", words[1], words[0],
                            words[0]);
    if (!command) return cli_unknown_command(words[0]);
    ask(command, man ? CLI_HELP_MAN : CLI_HELP_TEXT, NULL);
    return CLI_DONE;
}

const cli_command cli_help = {
    .name = "help",
    .summary = "explain a command; man pages and completion for shells",
    .arguments = "[COMMAND]",
    .description = "Without COMMAND it lists the commands. An installed copy has its man pages and "
                   "completion\n"
                   "scripts where man and the shells look for them; for a copy in a build folder:\n"
                   "  lariat help run --man | man -l -\n"
                   "  eval \"$(lariat help --completion bash)\"",
    .examples = "  lariat help run\n"
                "  lariat help bench kernel --man\n"
                "  lariat help --completion bash\n"
                "  lariat help --write share\n",
    .main = help_main};
