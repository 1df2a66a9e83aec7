"""What the thesis asked and did not measure: deadlines, single precision, the implicit way."""
from page import Page, number, percent


def deadlines(page, runs):
    page.chapter("A thousand deadlines a second")
    rows = []
    for name, what in (("jitter", "only waking"), ("jitter_loaded", "waking and 210 us of work")):
        run = runs[name]
        late = run["late_us"]
        rows.append((what, number(late["p50"]), number(late["p99"]), number(late["p999"]),
                     number(late["max"]), f"{run['misses']} of {number(run['ticks'])}"))
    page.table(("a thread that wakes every millisecond", "late, median [us]", "99 %", "99.9 %",
                "most", "ticks missed"), rows,
               "Measured on this machine without a priority: what no simulation on it can do "
               "better. " + runs.command("jitter") + ", " + runs.command("jitter_loaded"))


def steps(page, runs):
    rows = []
    for name, what in (("step", "at rest, no tools"), ("touched", "with its two tools")):
        run = runs[name]
        single = run["single_steps_us"]
        rows.append((what, number(run["us_per_step"]), number(single["p99"]),
                     number(single["p999"]), number(single["max"]),
                     number(run["real_time_factor"])))
    page.table(("the organ", "us per step, median", "single steps: 99 %", "99.9 %", "most",
                "simulated time / time"), rows, "Measured on one core. " + runs.command("step") +
               ", " + runs.command("touched"))


def precision(page, runs):
    page.chapter("Is double precision needed? (5.1.1)")
    run = runs["precision"]
    rows = []
    for case in run["cases"]:
        row = [case["case"]]
        for way in ("mixed", "single"):
            found = case[way]
            row += [percent(found["difference"], 2) if found["went"] else "stopped",
                    number(abs(found["energy_drift"]), 2) if found["went"] else ""]
        row.append(number(abs(case["double"]["energy_drift"]), 2))
        rows.append(row)
    page.table(("case", "mixed: off at the end", "energy made", "single: off", "energy made",
                "double: energy made"), rows,
               f"Measured: {number(run['steps'])} steps of {run['elements']} elements, beside "
               "the same in double; energies as a part of the largest strain energy. A million "
               "steps, and the answer (no): [precision.md](../precision.md). " +
               runs.command("precision"))


def implicit(page, runs):
    page.chapter("The implicit way (2.2.4)")
    rows = []
    for name in ("slow", "organ", "buckle", "loose"):
        run = runs["implicit." + name]
        found = run["implicit"]
        rows.append((run["title"], number(run["elements"]),
                     number(run["explicit"]["seconds_per_second"]),
                     "fails" if found["failed"] else number(found["seconds_per_second"]),
                     "" if found["failed"] else percent(run["apart"], 2),
                     number(found["reached"]), number(run["simulated"])))
    page.table(("case", "elements", "explicit: s per simulated s", "implicit: s per simulated s",
                "apart", "implicit reached [s]", "of [s]"), rows,
               "Measured on one core; the last two without masses, where the implicit way finds no "
               "equilibrium and the explicit one goes on. More: [implicit.md](../implicit.md). " +
               ", ".join(runs.command("implicit." + name)
                         for name in ("slow", "organ", "buckle", "loose")))


def write(runs, path):
    page = Page("What the thesis asked")
    steps(page, runs)
    deadlines(page, runs)
    precision(page, runs)
    implicit(page, runs)
    page.write(path)
