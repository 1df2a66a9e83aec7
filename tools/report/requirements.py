"""Chapter 4 of the thesis, and table 3.1: what a model needs."""
import thesis
from page import Page, number, scaled

METHODS = {"implicit": "implicit, CG (4.1)", "matrix": "explicit, matrices (4.9)",
           "vector": "explicit, direct vector (4.11)",
           "hourglass": "explicit, total hourglass control (4.12)"}


def operations(page, runs, needs):
    rows = []
    for ours, theirs in zip(needs["methods"], needs["methods"]):
        prints = theirs["thesis_prints"]
        rows.append((METHODS[ours["method"]], scaled(prints["operations_per_step"]),
                     scaled(prints["operations_per_second"]),
                     scaled(ours["operations_per_step"]),
                     scaled(ours["operations_per_second"])))
    page.chapter("Table 4.3: operations by the thesis's formulas")
    page.table(("method (equation)", "thesis: per step", "per second", "organ: per step",
                "per second"), rows,
               "Formula: the thesis's equations 4.1 to 4.12, left as it prints the results, right "
               "with the quantities counted from our demonstration organ and its own step of "
               f"{number(1e6 * needs['quantities']['dt_ex'])} us. {runs.command('requirements')}. "
               "The test `study/requirements` computes the thesis's tables 3.1 and 4.1 to 4.4 "
               "to their digits, but for those that do not follow from its equations "
               "(docs/requirements.md).")


def communication(page, runs, needs):
    rows = []
    for method in needs["methods"]:
        if method["method"] in ("implicit", "hourglass"):
            prints = method["thesis_prints"]
            rows.append((METHODS[method["method"]].split(",")[0], scaled(prints["values_per_step"]),
                         scaled(prints["bytes_per_second"]) + "B/s",
                         scaled(method["values_per_step"]),
                         scaled(method["bytes_per_second"]) + "B/s"))
    page.chapter("Table 4.4: communication by the thesis's formulas")
    page.table(("method", "thesis: values per step", "bytes", "organ: values per step", "bytes"),
               rows, "Formula: equations 4.2 and 4.8. " + runs.command("requirements"))


def tables_4_1_and_4_2(page, runs, needs):
    page.chapter("Tables 4.1 and 4.2: operations of an element, by parts")
    rows = [(row["calculation"], number(row["additions"]), number(row["multiplications"]))
            for table in ("table_4_1", "table_4_2") for row in needs[table]]
    page.table(("calculation", "additions", "multiplications"), rows,
               "Formula, for an element of 24 degrees of freedom and one integration point; first "
               "the element matrix, then the direct vector; the totals are the thesis's. " +
               runs.command("requirements"))


def kernels(page, runs, needs):
    page.chapter("What our elements really do")
    named = {"hex8": thesis.ELEMENT_OPERATIONS, "hex8-full": 8 * (103 * 24 + 96)}
    rows = []
    for kernel in needs["kernels"]:
        rows.append((f"`{kernel['kernel']}`",
                     number(kernel["additions"] + kernel["multiplications"]),
                     number(kernel["fused"]), number(kernel["integer_additions"]),
                     number(kernel["divisions"] + kernel["roots"]),
                     number(kernel["operations"]),
                     number(named[kernel["kernel"]]) if kernel["kernel"] in named else ""))
    page.table(("kernel", "additions, multiplications", "fused", "integer additions",
                "divisions, roots", "operations", "thesis"), rows,
               "Counted: the kernels' own sources are compiled with a number type that counts and "
               "gives the same bits; a fused multiply-add is two operations. " +
               runs.command("requirements"))
    rows = []
    for need in needs["needs"]:
        rows.append((f"`{need['element']}`", scaled(need["operations_per_second"]),
                     number(1e6 * need["step_seconds"]), number(need["cores"])))
    page.table(("element", "operations per second", "one core needs for a step [us]",
                "cores for real time"), rows,
               f"Operations counted; times measured on one core ({needs['isa']}), medians. The "
               "thesis reckoned with 36 processors, and had 24. " + runs.command("requirements"))


def sent(page, runs, needs, searched):
    page.chapter("Table 3.1, and what real schedules send")
    rows = [(f"`{scheme['scheme']}`", scheme["local_vectors"], scheme["global_vectors"])
            for scheme in needs["table_3_1"]["schemes"]]
    page.table(("scheme", "local vectors", "global vectors"), rows,
               "Formula (T 3.7): vectors that a sub-domain of 5 x 5 x 5 elements sends in a step; "
               "the test holds them against real schedules. " + runs.command("requirements"))
    rows = [(f"`{cut['scheme']}`", number(cut["packets"]), number(cut["bytes"]),
             number(found["packets"]), number(found["bytes"]))
            for cut, found in zip(needs["sent"], searched["sent"])]
    page.table(("scheme", "plain cut: packets", "bytes", "searched: packets", "bytes"), rows,
               "Counted from the schedules of 2 x 2 x 3 processors, with the ends of packets. The "
               f"thesis: {number(thesis.STEP_BYTES)} bytes, its own mesh and distribution. " +
               runs.command("requirements") + ", " + runs.command("searched"))


def write(runs, path):
    needs, searched = runs["requirements"], runs["searched"]
    page = Page("What a model needs (chapter 4)")
    page.say("Operations and bytes of a time-step of the demonstration organ, beside the thesis's "
             "numbers for its own. What the quantities mean, and where the thesis's digits do not "
             "follow from its equations: [requirements.md](../requirements.md).")
    operations(page, runs, needs)
    communication(page, runs, needs)
    kernels(page, runs, needs)
    sent(page, runs, needs, searched)
    tables_4_1_and_4_2(page, runs, needs)
    page.write(path)
