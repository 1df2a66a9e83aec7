/* The table of a command's options, told in several ways: for people who ask --help, as a man page,
 * and as completion for shells. All of them come from the rows that parse the command line, so that
 * no option can be missing in one.
 *
 *     lariat run --help                text
 *     lariat help run --man            the man page, for man -l -
 *     lariat help --completion bash    the script, of all commands
 *     lariat help --write DIR          all pages and scripts, where an installed copy has them
 */
#ifndef LAR_CLI_HELP_H
#define LAR_CLI_HELP_H

#include <stdio.h>

#include "cli/options.h"

typedef enum cli_help_form {
    CLI_HELP_TEXT = 0,
    CLI_HELP_MAN,
    CLI_HELP_BASH,
    CLI_HELP_ZSH,
    CLI_HELP_FISH
} cli_help_form;

/* What cli_parse does for --help: tells the command in the form that is asked for. */
void cli_tell_help(const cli_command *command, const cli_option *options);

/* ---- the forms; `out` gets one command ------------------------------------------------------ */

void cli_help_man(FILE *out, const cli_command *command, const cli_option *options);
/* The page of lariat itself. */
void cli_help_man_overview(FILE *out);

/* A script is begun, gets every command's part, and is ended. */
void cli_completion_begin(FILE *out, cli_help_form shell);
void cli_completion_add(FILE *out, cli_help_form shell, const cli_command *command,
                        const cli_option *options);
void cli_completion_end(FILE *out, cli_help_form shell);

#endif
