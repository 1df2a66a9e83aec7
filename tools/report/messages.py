"""Chapter 7 of the thesis: what is sent, and how fast."""
import collections
import os

import thesis
from page import Page, number
from plot import Plot

STEPS = 1 / thesis.STEP_GOAL # a second


def schedules(page, runs, folder):
    run = runs["searched"]
    sent = next(row for row in run["sent"] if row["scheme"] == "all")
    of = collections.Counter()
    for sender, _, size in sent["list"]:
        of[sender] += size
    plot = Plot("processor", "sent in a step [bytes]", height=320, key="off")
    plot.set("set style fill pattern 1")
    plot.set("set boxwidth 0.6")
    plot.set("set yrange [0:*]")
    plot.set("set xtics 1")
    plot.bars("", [(sender + 1, size) for sender, size in sorted(of.items())])
    plot.write(os.path.join(folder, "messages_7_1.svg"))
    page.picture("messages_7_1.svg", "Figure 7.1 again: what each of 12 processors sends",
                 f"Counted from the schedules, scheme `all`, with a searched distribution; at "
                 f"10,000 steps a second {number(max(of.values()) * STEPS / 1e6)} MB/s for the "
                 f"processor that sends most and {number(sum(of.values()) * STEPS / 1e6)} MB/s in "
                 "all. The thesis, at its 5,000 steps a second: "
                 f"{number(thesis.PROCESSOR_BANDWIDTH / 1e6)} and "
                 f"{number(thesis.TOTAL_BANDWIDTH / 1e6)} MB/s. " + runs.command("searched"))
    width = 128
    sizes = collections.Counter(size // width for _, _, size in sent["list"])
    mean = sum(size for _, _, size in sent["list"]) / len(sent["list"])
    plot = Plot("size of a packet [bytes]", "packets in a step", height=320, key="off")
    plot.set("set style fill pattern 1")
    plot.set(f"set boxwidth {0.9 * width}")
    plot.set("set xrange [0:*]")
    plot.set("set yrange [0:*]")
    plot.bars("", [((k + 0.5) * width, n) for k, n in sorted(sizes.items())])
    plot.write(os.path.join(folder, "messages_7_2.svg"))
    page.picture("messages_7_2.svg", "Figure 7.2 again: sizes of packets",
                 f"Counted likewise; {len(sent['list'])} packets, {number(mean)} bytes in the "
                 f"mean. The thesis: {thesis.PACKET_BYTES} bytes.")


def curves(runs, key):
    """Of every way that was measured: its name, and points (bytes, figure)."""
    rows = {row["name"]: row for row in runs["comm"]["rows"] if "sizes" in row}
    if runs.has("comm_mpi"):
        rows.update({row["name"]: row for row in runs["comm_mpi"]["rows"]
                     if row["name"] == "mpi" and "sizes" in row})
    return [(name, [(size["bytes"], size[key]) for size in row["sizes"]])
            for name, row in rows.items()]


FIGURES = (
    ("7.4", "half_duplex_mb_s", "half duplex bandwidth", "bandwidth [MB/s]", 1),
    ("7.5", "full_duplex_mb_s", "full duplex bandwidth", "bandwidth, both ways [MB/s]", 1),
    ("7.6", "latency_ns", "latency", "latency [us]", 1e-3),
    ("7.7", "send_ns", "time in the call that sends", "time [us]", 1e-3),
    ("7.8", "receive_ns", "time in the call that receives", "time [us]", 1e-3),
)


def measured(page, runs, folder):
    commands = runs.command("comm")
    if runs.has("comm_mpi"):
        commands += ", " + runs.command("comm_mpi")
    for figure, key, what, axis, factor in FIGURES:
        plot = Plot("size of a packet [bytes]", axis, log="xy", height=380)
        for name, points in curves(runs, key):
            plot.line(name, [(x, factor * y) for x, y in points if y > 0])
        if figure == "7.4":
            sizes = [8 * 2 ** k for k in range(12)]
            plot.line("thesis, FE protocol", [(s, thesis.bandwidth(
                s, thesis.HALF_BYTES, thesis.PEAK_BANDWIDTH)) for s in sizes], marks=False)
        file = f"messages_{figure.replace('.', '_')}.svg"
        plot.write(os.path.join(folder, file))
        more = ""
        if figure == "7.4":
            more = (" The thesis's line is computed from what it prints: "
                    f"{thesis.MEAN_BANDWIDTH} MB/s for its packets of {thesis.PACKET_BYTES} bytes, "
                    f"half of the peak at {thesis.HALF_BYTES}.")
        page.picture(file, f"Figure {figure} again: {what}",
                     f"Measured between two cores of this machine, medians. {commands}.{more}")


def summary(page, runs):
    rows = [("thesis, FE protocol on Myrinet", "a few", thesis.MEAN_BANDWIDTH,
             thesis.HALF_BYTES),
            ("thesis, MPI on Myrinet", "", thesis.MPI_MEAN_BANDWIDTH, thesis.MPI_HALF_BYTES),
            ("thesis, MPI-LAM on Ethernet", f"{thesis.MPI_LAM_LATENCY} and more", "", "")]
    found = list(runs["comm"]["rows"])
    if runs.has("comm_mpi"):
        found = [row for row in found if row["name"] != "mpi"] + \
            [row for row in runs["comm_mpi"]["rows"] if row["name"] == "mpi"]
    for row in found:
        if "sizes" in row:
            rows.append((row["name"], number(row["latency_ns"] / 1000),
                         number(row["half_duplex_mb_s"]), number(row["half_bandwidth_bytes"])))
    page.chapter("In numbers")
    page.table(("way", "latency [us]", "half duplex [MB/s]", "bytes for half of the best bandwidth"),
               rows, f"Measured with packets of {runs['comm']['packet_bytes']} bytes, the thesis's "
               "mean, as above. `by hand` is a copy and a poll without any program around it. One "
               "machine's cores share memory, and a network between machines is slower: we have "
               "none to measure, see [the prediction](network.md).")


def write(runs, path):
    folder = os.path.dirname(path)
    page = Page("Messages (chapter 7)")
    page.chapter("What has to be sent")
    schedules(page, runs, folder)
    page.chapter("How fast it is sent")
    measured(page, runs, folder)
    summary(page, runs)
    page.write(path)
