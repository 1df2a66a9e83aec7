"""Pages of the report: Markdown with tables and drawings, each with a line that says where its
numbers are from."""
import json
import math
import os


class Runs:
    """What the runs printed: NAME.json, and NAME.command, how a reader gets the same."""

    def __init__(self, folder):
        self.folder = folder

    def has(self, name):
        return os.path.exists(os.path.join(self.folder, name + ".json"))

    def names(self, start):
        found = [name[:-5] for name in os.listdir(self.folder)
                 if name.startswith(start) and name.endswith(".json")]
        return sorted(found)

    def __getitem__(self, name):
        with open(os.path.join(self.folder, name + ".json"), encoding="utf-8") as file:
            return json.load(file)

    def command(self, name):
        with open(os.path.join(self.folder, name + ".command"), encoding="utf-8") as file:
            return "`" + file.read().strip() + "`"


def number(value, digits=3):
    """Integers as they are, others with about so many digits; commas for thousands, and no
    exponent for what people read."""
    if value is None or not math.isfinite(value):
        raise ValueError("the report was given a number that is none")
    if isinstance(value, int):
        return f"{value:,}"
    if value == 0:
        return "0"
    size = abs(value)
    if size >= 1e15 or size < 1e-4:
        return f"{value:.{digits - 1}e}"
    decimals = max(0, digits - 1 - math.floor(math.log10(size)))
    return f"{value:,.{decimals}f}"


def scaled(value, digits=3):
    """With k, M, G or T, as the thesis prints operations."""
    for factor, letter in ((1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= factor:
            return f"{number(value / factor, digits)} {letter}"
    return number(value, digits)


def percent(part, digits=3):
    return number(100 * part, digits) + " %"


def median_of(spread, digits=3):
    """A median with the least and the greatest sample."""
    return (f"{number(spread['median'], digits)} ({number(spread['min'], digits)} to "
            f"{number(spread['max'], digits)})")


class Page:
    def __init__(self, title):
        self.lines = [f"# {title}", ""]

    def say(self, text):
        self.lines += [" ".join(text.split()), ""]

    def chapter(self, title):
        self.lines += [f"## {title}", ""]

    def table(self, head, rows, source):
        self.lines.append("| " + " | ".join(head) + " |")
        self.lines.append("|" + "---|" * len(head))
        for row in rows:
            if len(row) != len(head):
                raise ValueError(f"a row of {len(row)} cells in a table of {len(head)}: {row}")
            self.lines.append("| " + " | ".join(str(cell) for cell in row) + " |")
        self.lines.append("")
        self.source(source)

    def picture(self, file, caption, source):
        self.lines += [f"![{caption}]({file})", "", f"*{caption}*", ""]
        self.source(source)

    def source(self, text):
        self.lines += ["<sub>" + " ".join(text.split()) + "</sub>", ""]

    def write(self, path):
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(self.lines).rstrip() + "\n")
