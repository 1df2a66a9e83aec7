/* lariat bench comm: how fast processors can talk on this machine. */
#include <stdio.h>

#include "cli/commands.h"
#include "cli/json.h"
#include "study/bench_comm.h"

static void write_row(json_writer *json, const lar_bench_comm_row *row) {
    json_open(json, NULL, '{');
    json_text(json, "name", row->name);
    if (row->missing) {
        json_text(json, "missing", row->missing);
        json_close(json);
        return;
    }
    json_number(json, "latency_ns", row->latency.median);
    json_open(json, "latency_ns_spread", '{');
    json_number(json, "min", row->latency.least);
    json_number(json, "median", row->latency.median);
    json_number(json, "max", row->latency.most);
    json_close(json);
    if (row->moves_packets) {
        json_number(json, "half_duplex_mb_s", row->half_duplex);
        json_number(json, "full_duplex_mb_s", row->full_duplex);
        json_number(json, "send_ns", row->send);
        json_number(json, "receive_ns", row->receive);
        json_number(json, "best_half_duplex_mb_s", row->best_half_duplex);
        json_number(json, "half_bandwidth_bytes", row->half_bandwidth_bytes);
    }
    json_close(json);
}

static void write_json(const lar_bench_comm_result *r) {
    json_writer json = json_begin(stdout);
    json_integer(&json, "packet_bytes", r->bytes);
    json_integer(&json, "samples", r->repeat);
    json_open(&json, "cores", '[');
    for (int i = 0; i < 2; i++) json_integer(&json, NULL, r->cores[i]);
    json_close(&json);
    json_open(&json, "rows", '[');
    for (int i = 0; i < r->rows; i++) write_row(&json, &r->row[i]);
    json_end(&json);
}

static void print_table(const lar_bench_comm_result *r) {
    printf("packets of %d bytes, two ends on ", (int)r->bytes);
    if (r->cores[0] >= 0)
        printf("cores %d and %d", r->cores[0], r->cores[1]);
    else
        printf("one core");
    printf(", median of %d samples\n\n", r->repeat);
    printf("%-13s %21s %11s %11s %8s %8s %9s\n", "", "latency one way", "half duplex",
           "full duplex", "send", "receive", "half size");
    printf("%-13s %21s %11s %11s %8s %8s %9s\n", "", "us (least to most)", "MB/s", "MB/s", "us",
           "us", "bytes");
    for (int i = 0; i < r->rows; i++) {
        const lar_bench_comm_row *row = &r->row[i];
        if (row->missing) {
            printf("%-13s missing: %s\n", row->name, row->missing);
            continue;
        }
        printf("%-13s %6.3f (%.3f to %.3f)", row->name, 1e-3 * row->latency.median,
               1e-3 * row->latency.least, 1e-3 * row->latency.most);
        if (row->moves_packets)
            printf(" %10.0f %11.0f %8.3f %8.3f %9.0f", row->half_duplex, row->full_duplex,
                   1e-3 * row->send, 1e-3 * row->receive, row->half_bandwidth_bytes);
        printf("\n");
    }
    printf("\nhalf size: the packet that reaches half of the best half-duplex bandwidth\n");
}

static int comm_main(int argc, char **argv) {
    int64_t bytes = 424, repeat = 15;
    bool json = false;
    const cli_option options[] = {
        CLI_COUNT("--bytes", "N", "of a packet (424)", &bytes, 1, LAR_BENCH_COMM_BYTES_MOST),
        CLI_COUNT("--repeat", "N", "samples (15)", &repeat, 1, LAR_BENCH_REPEAT_MOST),
        CLI_FLAG("--json", "one JSON object on standard output", &json), CLI_END};
    int status = cli_parse(&cli_bench_comm, options, argc, argv, NULL, 0);
    if (status >= 0) return status;
    lar_bench_comm_options wanted = {.bytes = (int32_t)bytes, .repeat = (int)repeat};
    lar_bench_comm_result result;
    lar_error error;
    if (lar_bench_comm(&wanted, &result, &error))
        return cli_complain(&cli_bench_comm, CLI_FAILED, "%s", error.message);
    if (result.rows == 0) return CLI_DONE; /* the other process tells */
    if (json)
        write_json(&result);
    else
        print_table(&result);
    return CLI_DONE;
}

const cli_command cli_bench_comm = {
    .name = "bench comm",
    .summary = "latency and bandwidth between processors, for every backend",
    .arguments = "",
    .description =
        "Sends packets between two ends on two cores of this machine, by every backend, and "
        "beside\n"
        "them by a hand-written copy and poll and by a single word from core to core. Samples of\n"
        "all take turns; medians count. For quiet figures run nothing else on the machine.",
    .examples = "  lariat bench comm\n"
                "  mpirun -n 2 lariat bench comm\n"
                "  lariat bench comm --bytes 1000 --json\n",
    .main = comm_main};
