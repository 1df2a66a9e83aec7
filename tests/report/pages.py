"""Looks through the pages of a report: every table and picture says where it is from, every picture
is there with named axes, every link leads somewhere, and no number is none."""
import os
import re
import sys
import xml.etree.ElementTree

PAGES = ("README.md", "requirements.md", "network.md", "program.md", "messages.md", "results.md",
         "questions.md")
# What the thesis prints and must stand in its place: page, text.
PRINTED = (("requirements.md", "| implicit, CG (4.1) | 339 M | 17.0 G |"),
           ("requirements.md", "| total | 5,424 | 6,024 |"),
           ("requirements.md", "| total | 1,161 | 1,407 |"),
           ("requirements.md", "| `all` | 216 | 80 |"),
           ("requirements.md", "| implicit | 477 k | 191 MB/s |"),
           ("messages.md", "| thesis, FE protocol on Myrinet | a few | 111 | 196 |"),
           ("program.md", "| thesis: optimised code, ccc, 21264A at 666 MHz |  | 2,000 |"))
PICTURES = 14
failures = []


def fail(text):
    failures.append(text)


def look_at_picture(path):
    text = " ".join(xml.etree.ElementTree.parse(path).getroot().itertext())
    if not re.search(r"\[(us|bytes|%|MB/s)\]|processor", text):
        fail(f"{path}: no axis with a unit")
    if len(re.findall(r"\d+", text)) < 6:
        fail(f"{path}: axes without numbers")


def look_at_page(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        text = file.read()
    if re.search(r"(?i:\b(nan|inf|infinity)\b)|\bNone\b", text):
        fail(f"{name}: a number that is none")
    blocks = [block for block in text.split("\n\n") if block.strip()]
    pictures = []
    for block, after in zip(blocks, blocks[1:] + ["", ""]):
        if block.startswith("|") and not after.startswith("<sub>"):
            fail(f"{name}: a table that does not say where it is from: {block[:60]}")
        if block.startswith("|") and len(block.splitlines()) < 3:
            fail(f"{name}: an empty table")
        found = re.match(r"!\[.+\]\((.+\.svg)\)", block)
        if found:
            pictures.append(found.group(1))
    if text.count("<sub>") < text.count("\n![") + len(re.findall(r"\n\n\|", text)):
        fail(f"{name}: fewer sources than tables and pictures")
    for picture in pictures:
        path = os.path.join(folder, picture)
        if os.path.exists(path):
            look_at_picture(path)
        else:
            fail(f"{name}: {picture} is not there")
    for link in re.findall(r"\]\(([a-z_]+\.md)\)", text):
        if not os.path.exists(os.path.join(folder, link)):
            fail(f"{name}: a link to {link}, which is not there")
    return text, len(pictures)


def look_at_speed_ups(text):
    """A speed-up refers to the first line of its table, and a caption to what is drawn."""
    for table in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        rows = [[cell.strip() for cell in row.strip("|").split("|")] for row in table.splitlines()]
        if rows[0][-1] != "speed-up":
            continue
        times = [float(row[1].split()[0].replace(",", "")) for row in rows[2:]]
        for row, time in zip(rows[2:], times):
            # Both are printed with three digits.
            if abs(float(row[-1]) * time / times[0] - 1) > 0.015:
                fail(f"results.md: {row[0]}: a speed-up of {row[-1]}, and {times[0]} over {time}")
    after = text.split("results_8_2.svg", 1)[-1].split("![", 1)[0]
    if "thesis's point" in after:
        fail("results.md: figure 8.2 names a point that is not drawn")


def main():
    folder = sys.argv[1]
    text, pictures = {}, 0
    for name in PAGES:
        text[name], count = look_at_page(folder, name)
        pictures += count
    if pictures != PICTURES:
        fail(f"{pictures} pictures instead of {PICTURES}")
    for name, line in PRINTED:
        if line not in text[name]:
            fail(f"{name} lacks '{line}'")
    look_at_speed_ups(text["results.md"])
    front = re.search(r"an element, one processor \| [0-9,]+ ns \| ([0-9.]+) ns", text["README.md"])
    if not front or f"| {front.group(1)} (" not in text["program.md"]:
        fail("README.md: the time of an element is not one of table 6.1")
    if "come to the same bits" not in text["program.md"]:
        fail("program.md: states that differ")
    for line in failures:
        print("FAILED:", line)
    return bool(failures)


if __name__ == "__main__":
    sys.exit(main())
