/* Man pages, in the macros of man(7). */
#include <ctype.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/help.h"

/* Letters as they are: a minus is one that can be copied, a backslash one that is seen. */
static void write_letters(FILE *out, const char *text, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (text[i] == '-')
            fputs("\\-", out);
        else if (text[i] == '\\')
            fputs("\\e", out);
        else
            fputc(text[i], out);
    }
}

static void write_text(FILE *out, const char *text) {
    write_letters(out, text, strlen(text));
}

/* Lines that are filled; one that is indented stays a line of its own, and so does what follows it.
 * A dot or an apostrophe at the beginning would be a macro. */
static void write_paragraph(FILE *out, const char *text) {
    bool indented = false;
    while (*text) {
        size_t length = strcspn(text, "\n");
        if (length == 0)
            fputs(".PP", out);
        else if (indented && text[0] != ' ')
            fputs(".br\n", out);
        if (text[0] == '.' || text[0] == '\'') fputs("\\&", out);
        write_letters(out, text, length);
        fputc('\n', out);
        indented = text[0] == ' ';
        text += length + (text[length] == '\n');
    }
}

static void write_upper(FILE *out, const char *name) {
    for (; *name; name++) fputc(*name == ' ' ? '-' : toupper((unsigned char)*name), out);
}

/* "lariat\-bench\-kernel" */
static void write_page_name(FILE *out, const char *name) {
    fputs("lariat\\-", out);
    for (; *name; name++) fputs(*name == ' ' || *name == '-' ? "\\-" : (char[]){*name, 0}, out);
}

static void write_option(FILE *out, const char *name, const cli_option *option) {
    fputs(".TP\n\\fB", out);
    write_text(out, name);
    fputs("\\fR", out);
    if (option && option->placeholder) {
        fputs(" \\fI", out);
        write_text(out, option->placeholder);
        fputs("\\fR", out);
    }
    fputc('\n', out);
    write_paragraph(out, option ? option->help : "a short form of this page");
    if (option && option->kind == OPTION_CHOICE) {
        fputs("One of", out);
        for (int i = 0; option->choices[i]; i++) {
            fputs(i ? ", " : " ", out);
            write_text(out, option->choices[i]);
        }
        fputs(".\n", out);
    }
}

static void write_examples(FILE *out, const char *examples) {
    fputs(".SH EXAMPLES\n.nf\n", out);
    write_text(out, examples);
    fputs(".fi\n", out);
}

void cli_help_man(FILE *out, const cli_command *command, const cli_option *options) {
    fputs(".TH LARIAT-", out);
    write_upper(out, command->name);
    fprintf(out, " 1 \"\" \"Lariat %s\" \"Lariat\"\n.SH NAME\n", lar_version());
    write_page_name(out, command->name);
    fputs(" \\- ", out);
    write_text(out, command->summary);
    fputs("\n.SH SYNOPSIS\n\\fBlariat ", out);
    write_text(out, command->name);
    fputs("\\fR ", out);
    write_text(out, command->arguments);
    fputs(" [OPTIONS]\n.SH DESCRIPTION\n", out);
    write_paragraph(out, command->description);
    fputs(".SH OPTIONS\n", out);
    for (; options->name; options++) write_option(out, options->name, options);
    write_option(out, "--help", NULL);
    write_examples(out, command->examples);
    fputs(".SH SEE ALSO\n.BR lariat (1)\n", out);
}

static void write_commands(FILE *out, const cli_command *const *commands) {
    for (; *commands; commands++) {
        fputs(".TP\n\\fB", out);
        write_text(out, (*commands)->name);
        fputs("\\fR\n", out);
        write_paragraph(out, (*commands)->summary);
    }
}

void cli_help_man_overview(FILE *out) {
    fprintf(
        out,
        ".TH LARIAT 1 \"\" \"Lariat %s\" \"Lariat\"\n"
        ".SH NAME\nlariat \\- real\\-time finite elements for soft tissue\n"
        ".SH SYNOPSIS\n\\fBlariat\\fR COMMAND [ARGUMENTS]\n"
        ".SH DESCRIPTION\n"
        "Each command has a page of its own, \\fBlariat\\-COMMAND\\fR(1), and \\fB\\-\\-help\\fR.\n"
        "\\fBlariat doctor\\fR says what this copy can do and what this machine is good for.\n"
        ".SH COMMANDS\n",
        lar_version());
    write_commands(out, cli_commands);
    write_commands(out, cli_benchmarks);
    write_examples(out, "  lariat demo-model demo\n"
                        "  lariat view demo/uterus_live.yaml --open\n"
                        "  lariat run demo/uterus.yaml --out demo/results\n");
    fputs(".SH EXIT STATUS\n0 success, 1 failure, 2 wrong usage, 3 an unstable run, 4 a "
          "run that did not come to rest, 130 interrupted.\n.SH SEE ALSO\n",
          out);
    for (int i = 0; cli_commands[i]; i++) {
        fputs(".BR ", out);
        write_page_name(out, cli_commands[i]->name);
        fprintf(out, " (1)%s\n", cli_commands[i + 1] ? "," : "");
    }
}
