#include "cli/bench/laws.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/stop.h"
#include "study/bench/laws.h"

enum { ROWS = 64 };

static void print_table(const lar_bench_law_row *row, int rows, bool general) {
    printf("%d elements (%d x %d x %d, %s), double precision, %s; beside the neo-Hookean block in "
           "turn\n",
           (int)row->elements, (int)row->edge[0], (int)row->edge[1], (int)row->edge[2],
           general ? "general hexahedra" : "boxes", row->isa);
    printf("%-24s%8s%18s%12s%12s%14s\n", "", "times", "of all samples", "ns", "neo-Hookean",
           "bytes each");
    for (int i = 0; i < rows; i++, row++)
        printf("%-24s%8.3f    %.3f to %.3f%12.2f%12.2f%14.0f\n", row->words, row->ratio.median,
               row->ratio.min, row->ratio.max, row->nanoseconds.median, row->beside.median,
               row->bytes_per_element);
}

static void write_json(const bench_frame *frame, const lar_bench_law_row *row, int rows,
                       bool general) {
    lar_json json = bench_open_json(frame);
    lar_json_integer(&json, "elements", row->elements);
    lar_json_text(&json, "shape", general ? "general" : "box");
    lar_json_text(&json, "isa", row->isa);
    lar_json_open(&json, "laws", '[');
    for (int i = 0; i < rows; i++, row++) {
        lar_json_open(&json, NULL, '{');
        lar_json_text(&json, "law", row->words);
        lar_json_number(&json, "ratio", row->ratio.median);
        lar_json_number(&json, "ns_per_element", row->nanoseconds.median);
        lar_json_number(&json, "ns_beside", row->beside.median);
        lar_json_number(&json, "bytes_per_element", row->bytes_per_element);
        bench_write_spread(&json, "ratio_spread", &row->ratio);
        lar_json_close(&json);
    }
    lar_json_close(&json);
    bench_close_json(frame, &json);
}

/* One row after the other, until Ctrl-C. */
static lar_status measure(const lar_bench_kernel_options *wanted, const char *words,
                          lar_bench_law_row *row, int *rows, lar_error *error) {
    if (strcmp(words, "all") != 0) {
        *rows = 1;
        return lar_bench_law(wanted, words, row, error);
    }
    lar_status status = LAR_OK;
    for (*rows = 0; *rows < ROWS && !status && !cli_stop_asked; ++*rows) {
        const char *next = lar_bench_law_words(*rows);
        if (!next) break;
        if (isatty(STDERR_FILENO)) fprintf(stderr, "\r%s \033[K", next);
        status = lar_bench_law(wanted, next, &row[*rows], error);
    }
    if (isatty(STDERR_FILENO)) fputs("\r\033[K", stderr);
    return status;
}

int bench_laws(bench_frame *frame, const lar_bench_kernel_options *wanted, const char *words) {
    static lar_bench_law_row row[ROWS];
    lar_material unused;
    lar_error error;
    int rows = 0;
    if (strcmp(words, "all") != 0 && lar_bench_law_material(words, &unused, &error))
        return cli_complain(&cli_bench_kernel, CLI_USAGE, "--law: %s", error.message);
    lar_bench_set_text(&frame->report, "law", words);
    int status = bench_begin(frame);
    if (status) return status;
    cli_catch_stop();
    if (measure(wanted, words, row, &rows, &error))
        return bench_abandon(frame,
                             cli_complain(&cli_bench_kernel, CLI_FAILED, "%s", error.message));
    if (rows == 0) return bench_abandon(frame, CLI_INTERRUPTED);
    for (int i = 0; i < rows; i++) {
        lar_bench_add(&frame->report, "", row[i].ratio.median, true, "%s_ratio", row[i].words);
        lar_bench_add(&frame->report, "ns", row[i].nanoseconds.median, false, "%s_ns",
                      row[i].words);
    }
    if (frame->json)
        write_json(frame, row, rows, wanted->general);
    else
        print_table(row, rows, wanted->general);
    if (!cli_stop_asked) return bench_end(frame);
    return bench_abandon(frame, CLI_INTERRUPTED);
}
