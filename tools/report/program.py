"""Section 6.10 of the thesis: compilers, instruction sets, and the same bits from all of them."""
import os
import shutil

import thesis
from page import Page, median_of, number, percent

BUILDS = ("default", "gcc-O3", "gcc-O1", "clang-O3", "clang-O1")
INSTRUCTIONS = ("c", "neon", "avx2", "avx512")


def builds(runs):
    found = {name.split(".")[1] for name in runs.names("kernel.")}
    return [name for name in BUILDS if name in found]


def kernels(runs, build):
    names = [f"kernel.{build}.{isa}" for isa in INSTRUCTIONS]
    return [name for name in names if runs.has(name)]


def here(runs):
    """The build that stands in table 6.1 for this one: where the same compiler has made another with
    the same optimisation, that one is shown and not both."""
    return "gcc-O3" if "gcc-O3" in builds(runs) else "default"


def compiler(runs, build):
    made = runs[kernels(runs, build)[0]]["build"]
    level = [flag for flag in made["flags"].split() if flag.startswith("-O")]
    return " ".join(made["compiler"].split() + level)


def roofline(page, runs, folder):
    page.chapter("What the machine allows")
    shutil.copy(os.path.join(runs.folder, "..", "roofline.svg"),
                os.path.join(folder, "program_roofline.svg"))
    sweep = runs["sweep"]
    page.say("The same kernel over sizes, shapes and instruction sets: a point lies at 816 "
             "operations in the time of an element, over the operations for each byte that a "
             f"simulation keeps for it. Memory gives one core {number(sweep['bandwidth'])} GB/s "
             "(dashed); what fits into a cache does better.")
    page.picture("program_roofline.svg", "Roofline of one core", "Measured: " + runs.command("sweep"))
    rows = [(row["isa"], row["shape"], row["elements"], number(row["ns_per_element"]),
             percent(row["fraction_of_peak"]), number(round(row["bytes_per_element"])))
            for row in sweep["sweep"]]
    page.table(("instructions", "shape", "elements", "ns per element", "of the core's peak",
                "bytes per element"), rows, "Measured: " + runs.command("sweep"))


def write(runs, path):
    page = Page("Compilers and instruction sets (6.10)")
    rows = [(f"thesis: {code}", "", number(round(1000 * time)), "", "") for code, time in
            thesis.TABLE_6_1]
    states = set()
    for build in builds(runs):
        if build == "default" and here(runs) != "default":
            continue
        name = compiler(runs, build)
        needs = {need["element"]: need for need in runs[f"slow.{build}"]["needs"]}
        for element in ("hex8-matrix", "hex8-full"):
            nanoseconds = 1e9 * needs[element]["step_seconds"] / 1840
            rows.append((f"`{element}`, the plain reference", name, number(nanoseconds), "", ""))
        for run in kernels(runs, build):
            kernel = runs[run]
            state = runs[run.replace("kernel.", "same.")]["state_hash"]
            states.add(state)
            rows.append((f"`hex8`, {kernel['isa']}", name,
                         median_of(kernel["ns_per_element_spread"]),
                         percent(kernel["fraction_of_peak"]), f"`{state}`"))
    box = runs["box"]
    rows.append(("`hex8`, boxes only", compiler(runs, "default"),
                 median_of(box["ns_per_element_spread"]), "", ""))
    page.say("Time of a step per element, nodes included, on one core. The thesis's row is the "
             "recovery of an element without its nodes, 816 operations.")
    page.chapter("Table 6.1")
    first = runs.names("kernel.")[0]
    page.table(("code", "compiler", "ns per element: median (least to greatest)",
                "of the core's peak", "state after 200 steps of the organ"), rows,
               "Measured: a block of 1840 general elements, " + runs.command(first) +
               " and so on; the peak is of fused multiply-adds with the same instructions, and "
               "what counts against it are the thesis's 816 operations. The references: the organ's "
               "step, " + runs.command("slow.default") + ", divided by 1840. State: "
               + runs.command(first.replace("kernel.", "same.")))
    page.say(f"{'All builds and instruction sets come to the same bits' if len(states) == 1 else '**The states differ: this is a bug**'}. "
             "`c` is plain C without vector instructions, and without the processor's fused "
             "multiply-add, so each one is a call of the C library.")
    roofline(page, runs, os.path.dirname(path))
    page.write(path)
