/* Completion scripts. A word behind an option with choices is one of these; a word that begins with
 * a minus is an option; all else is a file. */
#include <string.h>

#include "cli/commands.h"
#include "cli/help.h"

/* ---- text in quotes ------------------------------------------------------------------------- */

/* `text` inside the apostrophes of a shell, lines joined; what is in `special` gets a backslash. */
static void write_quoted(FILE *out, const char *text, const char *special, const char *apostrophe) {
    for (; *text; text++) {
        if (*text == '\'')
            fputs(apostrophe, out);
        else if (*text == '\n')
            fputc(' ', out);
        else
            fprintf(out, strchr(special, *text) ? "\\%c" : "%c", *text);
    }
}

static void zsh_quoted(FILE *out, const char *text) {
    write_quoted(out, text, "[]:\\", "'\\''");
}

static void fish_quoted(FILE *out, const char *text) {
    write_quoted(out, text, "\\", "\\'");
}

static void write_choices(FILE *out, const char *const *choices) {
    for (int i = 0; choices[i]; i++) fprintf(out, "%s%s", i ? " " : "", choices[i]);
}

/* Names of the commands, without the word "bench" of benchmarks. */
static const char *last_word(const cli_command *command) {
    const char *space = strchr(command->name, ' ');
    return space ? space + 1 : command->name;
}

static void write_names(FILE *out, const cli_command *const *commands) {
    for (int i = 0; commands[i]; i++) fprintf(out, "%s%s", i ? " " : "", last_word(commands[i]));
}

/* ---- bash ----------------------------------------------------------------------------------- */

static void bash_begin(FILE *out) {
    fputs("# bash completion of lariat, made by: lariat help --completion bash\n"
          "_lariat() {\n"
          "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
          "    local command=${COMP_WORDS[1]} options='' values=''\n"
          "    COMPREPLY=()\n"
          "    if [ \"$COMP_CWORD\" -eq 1 ] || { [ \"$command\" = help ] && [[ $word != -* ]]; }; "
          "then\n"
          "        values='",
          out);
    write_names(out, cli_commands);
    fputs(" --help --version'\n"
          "    elif [ \"$command\" = bench ] && [ \"$COMP_CWORD\" -eq 2 ]; then\n"
          "        values='",
          out);
    write_names(out, cli_benchmarks);
    fputs("'\n    fi\n"
          "    [ \"$command\" != bench ] || command=\"bench ${COMP_WORDS[2]}\"\n"
          "    case $command in\n",
          out);
}

static void bash_add(FILE *out, const cli_command *command, const cli_option *options) {
    fprintf(out, "    '%s')\n        options='", command->name);
    for (const cli_option *o = options; o->name; o++) fprintf(out, "%s ", o->name);
    fputs("--help'\n        case $before in\n", out);
    for (const cli_option *o = options; o->name; o++) {
        if (o->kind != OPTION_CHOICE) continue;
        fprintf(out, "        %s) values='", o->name);
        write_choices(out, o->choices);
        fputs("' ;;\n", out);
    }
    fputs("        esac\n        ;;\n", out);
}

static void bash_end(FILE *out) {
    fputs(
        "    esac\n"
        "    [ -n \"$values\" ] || [[ $word != -* ]] || values=$options\n"
        "    [ -z \"$values\" ] || mapfile -t COMPREPLY < <(compgen -W \"$values\" -- \"$word\")\n"
        "}\n"
        "complete -o default -F _lariat lariat\n",
        out);
}

/* ---- zsh ------------------------------------------------------------------------------------ */

static void zsh_describe(FILE *out, const char *array, const cli_command *const *commands) {
    fprintf(out, "    %s=(\n", array);
    for (; *commands; commands++) {
        fprintf(out, "        '%s:", last_word(*commands));
        zsh_quoted(out, (*commands)->summary);
        fputs("'\n", out);
    }
    fputs("    )\n", out);
}

static void zsh_begin(FILE *out) {
    fputs("#compdef lariat\n"
          "# zsh completion of lariat, made by: lariat help --completion zsh\n"
          "_lariat() {\n"
          "    local -a commands benchmarks\n"
          "    local command=$words[2]\n",
          out);
    zsh_describe(out, "commands", cli_commands);
    zsh_describe(out, "benchmarks", cli_benchmarks);
    fputs("    if (( CURRENT == 2 )); then\n"
          "        _describe command commands\n"
          "        return\n"
          "    fi\n"
          "    if [[ $command == bench ]]; then\n"
          "        if (( CURRENT == 3 )); then\n"
          "            _describe benchmark benchmarks\n"
          "            return\n"
          "        fi\n"
          "        command=\"bench $words[3]\"\n"
          "        shift words\n"
          "        (( CURRENT-- ))\n"
          "    fi\n"
          "    shift words\n"
          "    (( CURRENT-- ))\n"
          "    case $command in\n",
          out);
}

static void zsh_add(FILE *out, const cli_command *command, const cli_option *options) {
    fprintf(out, "    '%s')\n        _arguments \\\n", command->name);
    for (const cli_option *o = options; o->name; o++) {
        fprintf(out, "            '%s%s[", o->kind == OPTION_TEXTS ? "*" : "", o->name);
        zsh_quoted(out, o->help);
        fputc(']', out);
        if (o->placeholder) {
            fputc(':', out);
            zsh_quoted(out, o->placeholder);
            fputc(':', out);
        }
        if (o->kind == OPTION_CHOICE) {
            fputc('(', out);
            write_choices(out, o->choices);
            fputc(')', out);
        } else if (o->kind == OPTION_TEXT || o->kind == OPTION_TEXTS) {
            fputs("_files", out);
        }
        fputs("' \\\n", out);
    }
    fputs("            '--help[explain the command]' \\\n            '*:file:_files'\n        ;;\n",
          out);
}

static void zsh_end(FILE *out) {
    fputs("    esac\n}\n_lariat \"$@\"\n", out);
}

/* ---- fish ----------------------------------------------------------------------------------- */

static void fish_commands(FILE *out, const char *condition, const cli_command *const *commands) {
    for (; *commands; commands++) {
        fprintf(out, "complete -c lariat -f -n '%s' -a %s -d '", condition, last_word(*commands));
        fish_quoted(out, (*commands)->summary);
        fputs("'\n", out);
    }
}

static void fish_begin(FILE *out) {
    fputs("# fish completion of lariat, made by: lariat help --completion fish\n", out);
    fish_commands(out, "__fish_use_subcommand", cli_commands);
    fish_commands(out,
                  "test (count (commandline -opc)) -eq 2; and __fish_seen_subcommand_from bench",
                  cli_benchmarks);
}

static void fish_add(FILE *out, const cli_command *command, const cli_option *options) {
    const bool benchmark = strchr(command->name, ' ') != NULL;
    for (const cli_option *o = options; o->name; o++) {
        fprintf(out, "complete -c lariat -n '__fish_seen_subcommand_from %s%s' -l %s",
                benchmark ? "bench; and __fish_seen_subcommand_from " : "", last_word(command),
                o->name + 2);
        if (o->kind == OPTION_CHOICE) {
            fputs(" -x -a '", out);
            write_choices(out, o->choices);
            fputc('\'', out);
        } else if (o->kind != OPTION_FLAG) {
            fputs(" -r", out);
        }
        fputs(" -d '", out);
        fish_quoted(out, o->help);
        fputs("'\n", out);
    }
}

/* ---- all of them ----------------------------------------------------------------------------- */

void cli_completion_begin(FILE *out, cli_help_form shell) {
    if (shell == CLI_HELP_BASH) bash_begin(out);
    if (shell == CLI_HELP_ZSH) zsh_begin(out);
    if (shell == CLI_HELP_FISH) fish_begin(out);
}

void cli_completion_add(FILE *out, cli_help_form shell, const cli_command *command,
                        const cli_option *options) {
    if (shell == CLI_HELP_BASH) bash_add(out, command, options);
    if (shell == CLI_HELP_ZSH) zsh_add(out, command, options);
    if (shell == CLI_HELP_FISH) fish_add(out, command, options);
}

void cli_completion_end(FILE *out, cli_help_form shell) {
    if (shell == CLI_HELP_BASH) bash_end(out);
    if (shell == CLI_HELP_ZSH) zsh_end(out);
}
