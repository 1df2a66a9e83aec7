"""Section 5.1.7 of the thesis: the network of fast, moderate and slow processors."""
import os

import thesis
from page import Page, number, percent
from plot import Plot

SYSTEMS = (
    ("5.2", (("12x2_fast", "12 nodes of 2 fast processors"),)),
    ("5.3", (("24x1_fast", "24 nodes of 1 fast processor"),
             ("24x2_moderate", "24 nodes of 2 moderate processors"))),
    ("5.4", (("48x1_moderate", "48 nodes of 1 moderate processor"),
             ("48x2_slow", "48 nodes of 2 slow processors"))),
)


def occupation(run):
    """Points of a staircase over a step that all begin together: time [us], share of the links that
    is busy [%], the mean of two slices."""
    fine = run["occupation_from_start"]
    share = [(a + b) / 2 for a, b in zip(fine[::2], fine[1::2])]
    width = run["start_step_us"] / len(share)
    points = [(k * width, 100 * value) for k, value in enumerate(share)]
    return points + [(run["start_step_us"], 100 * share[-1]), (run["start_step_us"], 0.0)]


def write(runs, path):
    page = Page("The network of other machines (5.1.7)")
    page.say("All systems have the same peak: 24 fast processors, 48 of half their speed, or 96 of "
             "a quarter. All have the thesis's network. What happens in a step is simulated over "
             "the real schedules of the demonstration organ; what is assumed about the cluster is "
             "listed with sources by `lariat predict --list-machines`, and how far such a "
             "prediction is right is in [prediction.md](../prediction.md).")
    rows = []
    for figure, systems in SYSTEMS:
        plot = Plot("time from the common start of all processors [us]", "links that are busy [%]", height=320,
                    key="outside top center horizontal")
        plot.set("set xrange [0:400]")
        plot.set("set yrange [0:90]")
        for name, label in systems:
            run = runs["network." + name]
            plot.line(label, occupation(run), steps=True)
            rows.append((figure, label, number(run["step_us"]), percent(run["occupation"]),
                         percent(run["efficiency"])))
        file = f"network_{figure.replace('.', '_')}.svg"
        plot.write(os.path.join(os.path.dirname(path), file))
        page.picture(file, f"Figure {figure} again: occupation of the network during a step that all begin "
                     "together",
                     "Simulated: " + ", ".join(runs.command("network." + name)
                                               for name, label in systems))
    page.table(("figure", "system", "predicted step [us]", "links busy, mean", "efficiency"), rows,
               "Simulated, commands above. The thesis: just under "
               f"{number(1e6 * thesis.STEP_REACHED)} us measured for 12 nodes of two fast "
               "processors, and the faster the processors, the shorter the step. Its figures "
               "5.2 to 5.4 are curves of which we have no numbers; shape by shape they are compared "
               "in [prediction.md](../prediction.md#what-was-checked). The steps of this table are "
               "later ones, without a common start.")
    check = runs["check"]["check"]
    page.chapter("Is it right?")
    page.table(("grid", "channel", "predicted [us]", "measured [us]", "predicted / measured"),
               [(row["grid"], row["comm"], number(row["predicted_us"]),
                 number(row["measured_us"]), number(row["predicted_over_measured"]))
                for row in check],
               "Measured: this machine's numbers, the prediction from them, and then the steps "
               "themselves, the fastest samples. " + runs.command("check"))
    page.write(path)
