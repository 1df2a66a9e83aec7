"""Writes the pages of the report from what the runs printed (run.sh).

    python3 tools/report/report.py --data out/report/data --pages docs/report
"""
import argparse
import os
import tempfile

import messages
import network
import program
import questions
import requirements
import results
import thesis
from page import Page, Runs, number, percent

CHAPTERS = ((requirements, "requirements.md", "What a model needs", "4, 3.1"),
            (network, "network.md", "The network of other machines", "5.1.7"),
            (program, "program.md", "Compilers and instruction sets", "6.10"),
            (messages, "messages.md", "Messages", "7"),
            (results, "results.md", "Throughput, speed-up, scaling", "8"),
            (questions, "questions.md", "Deadlines, precision, the implicit way", "2.2.4, 5.1.1"))


def then_and_now(page, runs):
    # The row of table 6.1, so that both pages show one figure.
    kernel = runs[program.kernels(runs, program.here(runs))[-1]]
    steps = {row["comm"]: row for row in runs["scaling.organ"]["rows"]
             if row["grid"] in ("none", "2x1x1") and "us_per_step" in row}
    comm = {row["name"]: row for row in runs["comm"]["rows"]}
    needs = runs["requirements"]["needs"][0]
    rate = round(needs["bytes_per_second"] / needs["bytes_per_step"])
    rows = (
        ("an element, one processor", f"{number(round(1e9 * thesis.ELEMENT_SECONDS))} ns",
         f"{number(kernel['ns_per_element'])} ns", "program.md"),
        ("operations of an element", thesis.ELEMENT_OPERATIONS,
         runs["requirements"]["kernels"][0]["operations"], "requirements.md"),
        ("a step of the organ, one processor",
         f"{number(round(1e6 * 1840 * thesis.ELEMENT_SECONDS))} us and its nodes",
         f"{number(steps['none']['us_per_step'])} us", "results.md"),
        ("a step of the organ, best", "just under 200 us on 24 processors",
         f"{number(steps['shm']['us_per_step'])} us on 2", "results.md"),
        ("processors for steps in real time", "36 (expected) for 10,000 a second",
         f"{number(needs['cores'])} for {number(rate)}",
         "requirements.md"),
        ("a packet of 424 bytes", "a few us",
         f"{number(comm['shm']['latency_ns'] / 1000)} us between cores", "messages.md"),
        ("share of the peak, 816 operations an element",
         percent(thesis.ELEMENT_OPERATIONS / thesis.ELEMENT_SECONDS / thesis.PEAK_FLOPS),
         percent(kernel["fraction_of_peak"]), "program.md"),
    )
    page.chapter("Then and now")
    page.table(("", "thesis, 2000", "this machine", ""),
               [(what, then, now, f"[how]({link})") for what, then, now, link in rows],
               "Left: printed in the thesis, or computed from what it prints: 1840 elements, and "
               "816 operations, at 2 us an element and 1332 MFLOPS of a processor. (Its own 500 "
               "MFLOPS, T 6.10, are 37.5 % of that, and would be 1,000 operations in 2 us.) "
               "Right: measured or counted, on the pages linked.")


def front(runs, path, quick):
    build, machine = runs["step"]["build"], runs["step"]["machine"]
    loads = [runs[name]["machine"]["load_average"][0]
             for name in ("kernel.default." + runs["step"]["isa"], "comm", "scaling.organ",
                          "jitter")]
    page = Page("The thesis's figures, again")
    if quick == "yes":
        page.say("**Made with --quick: these figures are worth nothing.**")
    page.say("The thesis argues with numbers. These pages make its tables and figures again on the "
             "machine that they were written on, with one command: `make report`. No number is "
             "typed in: below every table stands whether it was measured, simulated, counted or "
             "computed by a formula, and the command that gives the same. Only the thesis's own "
             "numbers are copied, from its text.")
    page.table(("", ""),
               [("machine", f"{machine['cpu']}, {machine['cores']} cores, {machine['isa']}"),
                ("compiler", f"{build['compiler']}, `{build['flags']}`"),
                ("Lariat", f"{build['version']}, commit `{build['commit']}`"),
                ("begun", runs["requirements"].get("date", runs["step"]["date"])),
                ("load average when kernel, messages, scaling and deadlines were measured",
                 ", ".join(number(load, 2) for load in loads))],
               "`lariat bench step --json`")
    then_and_now(page, runs)
    page.chapter("Pages")
    page.table(("page", "thesis"),
               [(f"[{title}]({file})", sections) for _, file, title, sections in CHAPTERS],
               "Commands with `demo/` want the demonstration organ: `lariat demo-model demo`; "
               "`uterus.dist` is `lariat partition demo/uterus.yaml --grid 2x2x3 --method genetic "
               "--generations 800 --out uterus.dist`.")
    page.write(path)


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--data", required=True)
    options.add_argument("--pages", required=True)
    options.add_argument("--quick", default="no", choices=("yes", "no"))
    given = options.parse_args()
    runs = Runs(given.data)
    os.makedirs(given.pages, exist_ok=True)
    # Old pages stay until all new ones are whole.
    with tempfile.TemporaryDirectory(dir=given.pages) as made:
        for chapter, file, _, _ in CHAPTERS:
            chapter.write(runs, os.path.join(made, file))
        front(runs, os.path.join(made, "README.md"), given.quick)
        for name in os.listdir(given.pages):
            if name.endswith((".md", ".svg")):
                os.remove(os.path.join(given.pages, name))
        for name in os.listdir(made):
            os.rename(os.path.join(made, name), os.path.join(given.pages, name))


if __name__ == "__main__":
    main()
