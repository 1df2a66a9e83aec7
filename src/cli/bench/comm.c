/* lariat bench comm: how fast processors can talk on this machine. */
#include <stddef.h>
#include <stdio.h>

#include "cli/bench/frame.h"
#include "cli/commands.h"
#include "study/bench/comm.h"

/* One size of packet. */
static void write_figures(lar_json *json, const lar_bench_comm_figures *at) {
    lar_json_number(json, "half_duplex_mb_s", at->half_duplex);
    lar_json_number(json, "full_duplex_mb_s", at->full_duplex);
    lar_json_number(json, "send_ns", at->send);
    lar_json_number(json, "receive_ns", at->receive);
    lar_json_number(json, "delay_ns", at->delay);
    lar_json_number(json, "slowdown", at->slowdown);
}

static void write_sizes(lar_json *json, const lar_bench_comm_result *r,
                        const lar_bench_comm_row *row) {
    lar_json_open(json, "sizes", '[');
    for (int i = 0; i < r->sizes; i++) {
        lar_json_open(json, NULL, '{');
        lar_json_integer(json, "bytes", r->size[i]);
        lar_json_number(json, "latency_ns", row->at[i].latency);
        write_figures(json, &row->at[i]);
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void write_row(lar_json *json, const lar_bench_comm_result *r,
                      const lar_bench_comm_row *row) {
    lar_json_open(json, NULL, '{');
    lar_json_text(json, "name", row->name);
    if (row->missing) {
        lar_json_text(json, "missing", row->missing);
        lar_json_close(json);
        return;
    }
    lar_json_number(json, "latency_ns", row->latency.median);
    bench_write_spread(json, "latency_ns_spread", &row->latency);
    if (row->moves_packets) {
        if (row->over_hand > 0) lar_json_number(json, "over_by_hand", row->over_hand);
        write_figures(json, &row->at[r->asked]);
        lar_json_number(json, "best_half_duplex_mb_s", row->best_half_duplex);
        lar_json_number(json, "half_bandwidth_bytes", row->half_bandwidth_bytes);
        write_sizes(json, r, row);
    }
    lar_json_close(json);
}

static void write_json(const bench_frame *frame, const lar_bench_comm_result *r) {
    lar_json json = bench_open_json(frame);
    lar_json_integer(&json, "packet_bytes", r->bytes);
    lar_json_integer(&json, "samples", r->repeat);
    lar_json_integers(&json, "cores", r->cores, 2);
    lar_json_number(&json, "portion_ns", r->portion);
    lar_json_open(&json, "rows", '[');
    for (int i = 0; i < r->rows; i++) write_row(&json, r, &r->row[i]);
    lar_json_close(&json);
    bench_close_json(frame, &json);
}

static void print_summary(const lar_bench_comm_result *r) {
    printf("packets of %d bytes, two ends on ", (int)r->bytes);
    if (r->cores[0] >= 0)
        printf("cores %d and %d", r->cores[0], r->cores[1]);
    else
        printf("one core");
    printf(", median of %d samples\n\n", r->repeat);
    printf("%-13s %21s %8s %11s %11s %7s %7s %7s %9s\n", "", "latency one way", "times",
           "half duplex", "full duplex", "send", "receive", "delay", "half size");
    printf("%-13s %21s %8s %11s %11s %7s %7s %7s %9s\n", "", "us (least to most)", "by hand",
           "MB/s", "MB/s", "us", "us", "us", "bytes");
    for (int i = 0; i < r->rows; i++) {
        const lar_bench_comm_row *row = &r->row[i];
        const lar_bench_comm_figures *at = &row->at[r->asked];
        if (row->missing) {
            printf("%-13s missing: %s\n", row->name, row->missing);
            continue;
        }
        printf("%-13s %6.3f (%.3f to %.3f)", row->name, 1e-3 * row->latency.median,
               1e-3 * row->latency.min, 1e-3 * row->latency.max);
        if (row->moves_packets && row->over_hand > 0)
            printf(" %8.2f", row->over_hand);
        else if (row->moves_packets)
            printf(" %8s", "");
        if (row->moves_packets)
            printf(" %11.0f %11.0f %7.3f %7.3f %7.3f %9.0f", at->half_duplex, at->full_duplex,
                   1e-3 * at->send, 1e-3 * at->receive, 1e-3 * at->delay,
                   row->half_bandwidth_bytes);
        printf("\n");
    }
    printf("\nhalf size: the packet that reaches half of the best half-duplex bandwidth\n"
           "delay: of a computation of %.0f us by a packet that goes and one that comes\n",
           1e-3 * r->portion);
}

/* A figure over the size of packets, all ways side by side. */
static void print_curves(const lar_bench_comm_result *r, const char *title, double scale,
                         size_t offset) {
    printf("\n%s\n%7s", title, "bytes");
    for (int i = 0; i < r->rows; i++)
        if (r->row[i].moves_packets) printf(" %9s", r->row[i].name);
    printf("\n");
    for (int size = 0; size < r->sizes; size++) {
        printf("%7d", (int)r->size[size]);
        for (int i = 0; i < r->rows; i++) {
            if (!r->row[i].moves_packets) continue;
            const char *figures = (const char *)&r->row[i].at[size];
            double value = scale * *(const double *)(const void *)(figures + offset);
            printf(" %9.*f", value >= 1000 ? 0 : 3, value);
        }
        printf("\n");
    }
}

static void print_table(const lar_bench_comm_result *r) {
    print_summary(r);
    print_curves(r, "latency one way [us]", 1e-3, offsetof(lar_bench_comm_figures, latency));
    print_curves(r, "half duplex [MB/s]", 1, offsetof(lar_bench_comm_figures, half_duplex));
    print_curves(r, "full duplex, both directions together [MB/s]", 1,
                 offsetof(lar_bench_comm_figures, full_duplex));
    print_curves(r, "time in send [us]", 1e-3, offsetof(lar_bench_comm_figures, send));
    print_curves(r, "time in receive, the packet being there [us]", 1e-3,
                 offsetof(lar_bench_comm_figures, receive));
    print_curves(r, "slow-down of the computation [%]", 100,
                 offsetof(lar_bench_comm_figures, slowdown));
}

/* Packets of the size that was asked for. */
static void add_figures(const lar_bench_comm_result *r, lar_bench_report *report) {
    for (int i = 0; i < r->rows; i++) {
        const lar_bench_comm_row *row = &r->row[i];
        const lar_bench_comm_figures *at = &row->at[r->asked];
        if (row->missing) continue;
        lar_bench_add(report, "ns", row->latency.median, true, "%s: latency_ns", row->name);
        if (!row->moves_packets) continue;
        lar_bench_add(report, "MB/s", at->half_duplex, true, "%s: half_duplex_mb_s", row->name)
            ->more = true;
        lar_bench_add(report, "MB/s", at->full_duplex, true, "%s: full_duplex_mb_s", row->name)
            ->more = true;
        lar_bench_add(report, "ns", at->send, false, "%s: send_ns", row->name);
        lar_bench_add(report, "ns", at->receive, false, "%s: receive_ns", row->name);
    }
}

static int comm_main(int argc, char **argv) {
    int64_t bytes = 424, repeat = 15;
    const char *backends = NULL;
    bool quick = false;
    bench_frame frame = bench_frame_of(&cli_bench_comm, "comm");
    const cli_option options[] = {
        CLI_COUNT("--bytes", "N", "of a packet (424)", &bytes, 1, LAR_BENCH_COMM_BYTES_MAX),
        CLI_COUNT("--repeat", "N", "samples (15)", &repeat, 1, LAR_BENCH_REPEAT_MAX),
        CLI_TEXT("--backend", "NAMES", "only these, as in shm,tcp (all)", &backends),
        CLI_FLAG("--quick", "does it work? few sizes, short samples", &quick),
        BENCH_OPTIONS(frame),
        CLI_END};
    int status = cli_parse(&cli_bench_comm, options, argc, argv, NULL, 0);
    if (status >= 0) return status;
    lar_bench_set_number(&frame.report, "bytes", (double)bytes);
    lar_bench_set_text(&frame.report, "backend", backends ? backends : "all");
    lar_bench_set_text(&frame.report, "quick", quick ? "yes" : "no");
    status = bench_begin(&frame);
    if (status) return status;
    lar_bench_comm_options wanted = {
        .bytes = (int32_t)bytes, .repeat = (int)repeat, .backends = backends, .quick = quick};
    lar_bench_comm_result result;
    lar_error error;
    if (lar_bench_comm(&wanted, &result, &error))
        return bench_abandon(&frame, cli_refuse(&cli_bench_comm, &error));
    if (result.rows == 0) return bench_abandon(&frame, CLI_DONE); /* the other process tells */
    add_figures(&result, &frame.report);
    if (frame.json)
        write_json(&frame, &result);
    else
        print_table(&result);
    return bench_end(&frame);
}

const cli_command cli_bench_comm = {
    .name = "bench comm",
    .summary = "latency and bandwidth between processors, for every backend",
    .arguments = "",
    .description =
        "Sends packets between two ends on two cores of this machine, by every backend, and "
        "beside\n"
        "them by a hand-written copy and poll and by a single word from core to core; and "
        "computes\n"
        "while they travel. Samples of all take turns; medians count. For quiet figures run\n"
        "nothing else on the machine.",
    .examples = "  lariat bench comm\n"
                "  mpirun -n 2 lariat bench comm\n"
                "  lariat bench comm --backend shm,tcp --bytes 1000 --json\n",
    .main = comm_main};
