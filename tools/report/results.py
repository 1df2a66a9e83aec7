"""Chapter 8 of the thesis: throughput, speed-up, share of the peak, critical sub-domains."""
import os

import thesis
from page import Page, median_of, number, percent
from plot import Plot

GRIDS = ("1x1x1", "2x1x1", "2x2x1", "2x2x2", "2x2x3", "2x2x4", "2x3x4", "3x4x4")
PREDICTED = (("thesis", "thesis's cluster, 1 thread a node"),
             ("thesis2", "thesis's cluster, 2 threads a node"),
             ("infiniband", "today, 200 Gbit/s InfiniBand"),
             ("ethernet", "today, 1 Gbit/s Ethernet"))
BELOW = "outside bottom center horizontal"


def rows_of(runs, name):
    """What was measured with several processors, MPI's row included."""
    rows = [row for row in runs[name]["rows"] if "us_per_step" in row]
    if runs.has(name + "_mpi"):
        rows += [row for row in runs[name + "_mpi"]["rows"] if row["comm"] == "mpi"]
    return rows


def here(page, runs):
    page.chapter("This machine")
    for name, title in (("scaling.organ", "the demonstration organ, 1840 elements"),
                        ("scaling.large",
                         f"a block of {number(runs['scaling.large']['elements'])} elements")):
        elements = runs[name]["elements"]
        rows = []
        plain = next(row for row in runs[name]["rows"] if row["grid"] == "none")["us_per_step"]
        for row in rows_of(runs, name):
            way = "no schedule" if row["grid"] == "none" else f"{row['grid']}, {row['comm']}"
            if row["threads"] > 1:
                way += f", {row['threads']} threads"
            # Against the line of this table; under mpirun there was another one.
            rows.append((way, median_of(row["us_per_step_spread"]),
                         number(elements / row["us_per_step"]),
                         number(plain / row["us_per_step"])))
        page.table((title, "us per step: median (least to greatest)", "million elements / s",
                    "speed-up"), rows,
                   "Measured in turns, the first line is the plain loop of one core that the "
                   "speed-ups refer to; all come to the state "
                   f"`{runs[name]['state_hash']}`. " + runs.command(name) +
                   (", and for MPI, afterwards, " + runs.command(name + "_mpi")
                    if runs.has(name + "_mpi") else ""))


def predicted(runs, machine):
    """Points (processors, run)."""
    points = []
    for grid in GRIDS:
        run = runs[f"speed.{machine}.{grid}"]
        points.append((run["processors"] * run["threads"], run))
    return points


def processors_axis(plot):
    plot.set("set format x '%g'")
    plot.set("set xtics (1,2,4,8,12,16,24,48,96)")
    plot.set("set xrange [0.9:110]")


def figures(page, runs, folder):
    elements = runs["scaling.organ"]["elements"]
    measured = sorted((row["processors"], row) for row in rows_of(runs, "scaling.organ")
                      if row["comm"] in ("none", "shm"))
    throughput = Plot("processors", "elements per second", log="xy", height=500, key=BELOW)
    speed_up = Plot("processors", "speed-up", log="xy", height=500, key=BELOW)
    for plot in (throughput, speed_up):
        processors_axis(plot)
    one = next(row for _, row in measured if row["grid"] == "none")["us_per_step"]
    throughput.line("this machine, measured",
                    [(n, 1e6 * elements / row["us_per_step"]) for n, row in measured])
    speed_up.line("this machine, measured",
                  [(n, one / row["us_per_step"]) for n, row in measured])
    for machine, label in PREDICTED:
        points = predicted(runs, machine)
        throughput.line(label + ", predicted",
                        [(n, 1e6 * elements / run["step_us"]) for n, run in points])
        speed_up.line(label + ", predicted", [(n, run["speed_up"]) for n, run in points])
    throughput.mark("thesis, measured: 12 x 2",
                    [(thesis.PROCESSORS, elements / thesis.STEP_REACHED)])
    speed_up.line("ideal", [(1, 1), (96, 96)], marks=False)
    for plot, file, caption, point in (
            (throughput, "results_8_1.svg", "Figure 8.1 again: throughput of the organ",
             "The thesis's point: 1840 elements in 200 us (T 8.2); its curves we have not as "
             "numbers."),
            (speed_up, "results_8_2.svg", "Figure 8.2 again: speed-up of the organ",
             "No point of the thesis: the step of one processor, to which its speed-up refers, is "
             "in its curves only.")):
        plot.write(os.path.join(folder, file))
        page.picture(file, caption,
                     "Measured: " + runs.command("scaling.organ") + ". Predicted over real "
                     "schedules: " + runs.command("speed.thesis.2x2x3") + " and so on. " + point)


def peak(page, runs, folder):
    needs = runs["requirements"]
    quantities = needs["quantities"]
    floating = needs["needs"][0]["floating_per_second"] * quantities["dt_ex"]
    as_thesis = thesis.ELEMENT_OPERATIONS * quantities["n_el"]
    core = 1e3 * needs["peak_gflops"] # operations a us
    rows, here_points = [], []
    for row in rows_of(runs, "scaling.organ"):
        processors = row["processors"] * row["threads"]
        bound = row["us_per_step"] * core * processors
        way = "one core, no schedule" if row["grid"] == "none" else \
            f"{row['grid']}, {row['comm']}" + (", 2 threads" if row["threads"] > 1 else "")
        rows.append((way, percent(as_thesis / bound), percent(floating / bound)))
        if row["comm"] in ("none", "shm"):
            here_points.append((processors, 100 * as_thesis / bound))
    plot = Plot("processors", "share of the peak [%]", log="x", height=420, key=BELOW)
    processors_axis(plot)
    plot.set("set yrange [0:80]")
    plot.line("this machine, measured", here_points)
    for machine, label in PREDICTED[:3]:
        of_one = core if machine == "infiniband" else 1e-6 * thesis.PEAK_FLOPS
        plot.line(label + ", predicted", [(n, 100 * as_thesis / (run["step_us"] * of_one * n))
                                          for n, run in predicted(runs, machine)])
    plot.line("thesis: a third", [(1, 100 * thesis.PEAK_SHARE), (96, 100 * thesis.PEAK_SHARE)],
              marks=False)
    plot.write(os.path.join(folder, "results_8_3.svg"))
    page.picture("results_8_3.svg", "Figure 8.3 again: share of the theoretical peak",
                 "As above, with the thesis's 816 operations for each of 1840 elements. Peak of a "
                 f"core of this machine: {number(needs['peak_gflops'])} Gflop/s, measured at fused "
                 "multiply-adds; of an Alpha 21264A: two operations a clock. "
                 "\"Thesis: a third\" is what it says of its element, with 500 MFLOPS, which are "
                 "about 1,000 operations in 2 us; the 816 drawn here are "
                 f"{percent(thesis.ELEMENT_OPERATIONS / thesis.ELEMENT_SECONDS / thesis.PEAK_FLOPS)}"
                 " of the peak at most, without nodes. " +
                 runs.command("requirements"))
    page.table(("the organ on this machine", "816 operations an element", "operations that are "
                "done"), rows,
               f"Measured, as above. Counted: {number(round(floating))} floating point operations "
               "a step; our element needs fewer than the thesis's.")


def step_of(row):
    """With the efficiency; where processors' paces still differ, with these."""
    text = f"{number(row['step_us'])} ({percent(row['efficiency'])})"
    if not row["settled"]:
        text += f", not settled: {number(row['fastest_us'])} to {number(row['slowest_us'])}"
    return text


def critical(page, runs):
    page.chapter("Critical sub-domains and size (8.3.1)")
    run = runs["critical"]
    schemes = [row["scheme"] for row in run["critical"]
               if row["name"] == run["critical"][0]["name"]]
    rows = []
    for machine in dict.fromkeys(row["name"] for row in run["critical"]):
        cells = []
        for row in run["critical"]:
            if row["name"] == machine:
                most = f"more than {number(run['elements_most'])}"
                cells.append(number(row["elements_per_processor"])
                             if row["elements_per_processor"] else most)
        rows.append([machine] + cells)
    page.table(["machine"] + [f"`{scheme}`" for scheme in schemes], rows,
               f"Simulated: the smallest cube of elements on each of {run['processors']} "
               f"processors with an efficiency of {percent(run['efficiency'])}. The thesis measured "
               f"{thesis.CRITICAL} with at most four neighbours, and expected "
               f"{thesis.CRITICAL_LARGE} in a larger grid. " + runs.command("critical"))
    rows = []
    for name in runs.names("size."):
        run = runs[name]
        for scheme in dict.fromkeys(row["scheme"] for row in run["scaling"]):
            found = [row for row in run["scaling"] if row["scheme"] == scheme]
            rows.append([run["machine"]["name"],
                         number(found[0]["elements_per_processor"]), f"`{scheme}`"] +
                        [step_of(row) for row in found])
    sizes = [row["processors"] for row in run["scaling"] if row["scheme"] == scheme]
    page.table(["machine", "elements per processor", "scheme"] +
               [f"{number(size)} processors: us per step" for size in sizes], rows,
               "Simulated: bodies of equal blocks that grow with the machine; in brackets the "
               "efficiency. Where the simulation of so many processors ended before all went at the "
               "same pace, \"not settled\" stands before the paces of the fastest and of the "
               "slowest. " + runs.command(runs.names("size.")[0]) + " and so on")


def write(runs, path):
    page = Page("Throughput, speed-up, scaling (chapter 8)")
    here(page, runs)
    figures(page, runs, os.path.dirname(path))
    peak(page, runs, os.path.dirname(path))
    critical(page, runs)
    page.say("Table 8.1 of the thesis, elements per second and Swiss franc, is not made again: "
             "prices can neither be run nor counted.")
    page.write(path)
