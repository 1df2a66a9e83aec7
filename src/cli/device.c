/* lariat device: a force-feedback device for people who have none. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/stop.h"
#include "base/json/write.h"
#include "study/device_client.h"

static void write_json(const lar_device_client_options *o, const lar_device_client_report *r) {
    lar_json json = lar_json_to(stdout);
    lar_json_text(&json, "address", o->address);
    lar_json_number(&json, "seconds", r->seconds);
    lar_json_integer(&json, "sent", (int64_t)r->sent);
    lar_json_integer(&json, "answered", (int64_t)r->answered);
    lar_json_integer(&json, "lost", (int64_t)r->lost);
    lar_json_integer(&json, "strange", (int64_t)r->strange);
    lar_json_integer(&json, "steps", (int64_t)r->steps);
    lar_json_open(&json, "round_trip_us", '{');
    lar_json_number(&json, "p50", 1e6 * r->round_trip_p50);
    lar_json_number(&json, "p99", 1e6 * r->round_trip_p99);
    lar_json_number(&json, "p999", 1e6 * r->round_trip_p999);
    lar_json_number(&json, "max", 1e6 * r->round_trip_max);
    lar_json_close(&json);
    lar_json_number(&json, "largest_force", r->force_max);
    lar_json_number(&json, "mean_force", r->force_mean);
    lar_json_number(&json, "largest_torque", r->torque_max);
    lar_json_integer(&json, "touching", (int64_t)r->touching);
    lar_json_integer(&json, "holding", (int64_t)r->holding);
    lar_json_end(&json);
}

static void print_report(const lar_device_client_report *r) {
    printf("%-12s%" PRIu64 " packets in %.2f s (%.0f a second), %" PRIu64 " answered, %" PRIu64
           " lost\n",
           "sent", r->sent, r->seconds, (double)r->sent / r->seconds, r->answered, r->lost);
    printf("%-12sp50 %.0f us, p99 %.0f us, p99.9 %.0f us, max %.0f us\n", "round trip",
           1e6 * r->round_trip_p50, 1e6 * r->round_trip_p99, 1e6 * r->round_trip_p999,
           1e6 * r->round_trip_max);
    printf("%-12slargest %.3f N, mean %.3f N; torque at most %.4f N m\n", "force", r->force_max,
           r->force_mean, r->torque_max);
    printf("%-12s%" PRIu64 " steps meanwhile; it touched in %.0f %% of the answers, held in %.0f "
           "%%\n",
           "engine", r->steps, 100 * (double)r->touching / (double)r->answered,
           100 * (double)r->holding / (double)r->answered);
    if (r->strange) printf("%-12s%" PRIu64 " malformed packets\n", "strange", r->strange);
}

static int device_main(int argc, char **argv) {
    lar_device_client_options o = {
        .period = 2, .rate = 1000, .seconds = 10, .stop = &cli_stop_asked};
    bool json = false;
    const cli_option options[] = {
        CLI_TEXT("--script", "FILE", "move along a file of positions at times", &o.script),
        CLI_REAL("--circle", "RADIUS", "move in a circle in x and y [m]", &o.circle, 0, 1),
        CLI_REAL("--push", "DEPTH", "move down and up along z [m]", &o.push, 0, 1),
        CLI_REAL("--period", "S", "seconds for a circle, or down and up (2)", &o.period, 0.01,
                 1000),
        CLI_REAL("--rate", "HZ", "packets a second (1000)", &o.rate, 1, 10000),
        CLI_REAL("--seconds", "S", "how long (10)", &o.seconds, 0.001, 1e6),
        CLI_TEXT("--token", "WORD", "what the session's device asks for", &o.token),
        CLI_FLAG("--json", "one JSON object on standard output", &json),
        CLI_END};
    int status = cli_parse(&cli_device, options, argc, argv, &o.address, 1);
    if (status >= 0) return status;
    if ((o.script != NULL) + (o.circle > 0) + (o.push > 0) > 1)
        return cli_complain(&cli_device, CLI_USAGE,
                            "--script, --circle and --push exclude each other; use one");
    if (o.token && strlen(o.token) > 16)
        return cli_complain(&cli_device, CLI_USAGE, "a token has at most 16 characters");
    cli_catch_stop();
    lar_device_client_report report;
    lar_error error;
    if (lar_device_client(&o, &report, &error)) return cli_refuse(&cli_device, &error);
    if (json)
        write_json(&o, &report);
    else
        print_report(&report);
    return CLI_DONE;
}

const cli_command cli_device = {
    .name = "device",
    .summary = "a force-feedback device on the network, emulated",
    .arguments = "udp:HOST:PORT",
    .description =
        "Sends positions to a session's tool as a device's driver would, a thousand times a\n"
        "second, takes the forces and says how long they took. Without --script, --circle or\n"
        "--push the hand rests. Positions are the device's own, its origin where the tool is at\n"
        "rest. Ctrl-C or SIGTERM ends it early, with a report.",
    .examples = "  lariat device udp:127.0.0.1:9000 --push 0.02\n"
                "  lariat device udp:127.0.0.1:9000 --circle 0.03 --seconds 60 --json\n",
    .main = device_main};
