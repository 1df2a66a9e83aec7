"""Pages agree with docs/figures.txt, which says how it is written, and so does the command where a
figure comes from it.

    figures.py SOURCE LARIAT SCRATCH
    figures.py --self-test SCRATCH
"""
import decimal
import json
import os
import re
import shutil
import subprocess
import sys

NUMBER = r"([0-9](?:[0-9,]*[0-9])?(?:\.[0-9]+)?)"
failures = []


def fail(text):
    failures.append(text)


def read(path):
    """Entries: name, value, `from` or none, [(page, text)]."""
    entries, entry = [], None
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    for number, line in enumerate(lines, 1):
        words = line.split(None, 1)
        if not words or line.startswith("#"):
            continue
        if not line.startswith(" "):
            name, _, value = line.rpartition(" = ")
            if not name or not re.fullmatch(NUMBER, value):
                raise SystemExit(f"FAILED: {path}:{number}: no NAME = VALUE: {line}")
            entry = {"name": name, "value": value, "from": None, "in": [], "line": number}
            entries.append(entry)
        elif words[0] == "from":
            entry["from"] = words[1]
        elif words[0] == "in":
            page, _, text = words[1].partition(": ")
            if not re.search(r"\{\d*\}", text):
                raise SystemExit(f"FAILED: {path}:{number}: no {{}} for the value: {line}")
            entry["in"].append((page, text))
        elif words[0] != "is" and not line.startswith("        "):
            raise SystemExit(f"FAILED: {path}:{number}: neither is, from nor in: {line}")
    return entries


def plain(text):
    return decimal.Decimal(text.replace(",", ""))


def rounded(value, digits):
    """To so many digits, halves away from zero as a reader does."""
    if not digits or not value:
        return value
    step = decimal.Decimal(1).scaleb(value.adjusted() - digits + 1)
    return value.quantize(step, rounding=decimal.ROUND_HALF_UP)


def as_written(value, like):
    """Rounded to the decimals of the text it is compared with."""
    step = decimal.Decimal(1).scaleb(plain(like).as_tuple().exponent)
    return decimal.Decimal(value).quantize(step, rounding=decimal.ROUND_HALF_UP)


def look_at_pages(source, entry, pages):
    if len({page for page, _ in entry["in"]}) < 2 and not entry["from"]:
        fail(f"{entry['name']}: on one page only, and from nowhere")
    for page, text in entry["in"]:
        if page not in pages:
            with open(os.path.join(source, page), encoding="utf-8") as file:
                pages[page] = " ".join(file.read().split())
        before, digits, after = re.split(r"\{(\d*)\}", text, maxsplit=1)
        wanted = rounded(plain(entry["value"]), int(digits or 0))
        found = re.findall(r"(?<![0-9.])" * (not before) + re.escape(before) + NUMBER +
                           re.escape(after), pages[page])
        if not found:
            fail(f"{page} lacks '{text}', {entry['name']}")
        for number in found:
            if plain(number) != wanted:
                fail(f"{page} says {number} for {entry['name']}, and docs/figures.txt {wanted}: "
                     f"'{text}'")


def of_key(data, path):
    for key in path.split("."):
        data = data[int(key)] if isinstance(data, list) else data[key]
    return data


def computed(entry, lariat, scratch):
    command, _, key = entry["from"].partition(" > ")
    if not key:
        if not re.fullmatch(r"[0-9.e+*/() -]+", command):
            raise SystemExit(f"FAILED: {entry['name']}: no expression of numbers: {command}")
        return eval(command)  # digits and operators only
    key, _, factor = key.partition(" * ")
    run = subprocess.run([lariat, *command.split(), "--json"], cwd=scratch, text=True,
                         capture_output=True, check=False)
    if run.returncode:
        fail(f"{entry['name']}: lariat {command}: {run.stderr.strip()}")
        return None
    return of_key(json.loads(run.stdout), key) * float(factor or 1)


def look(source, lariat, scratch):
    pages = {}
    for entry in read(os.path.join(source, "docs/figures.txt")):
        look_at_pages(source, entry, pages)
        value = computed(entry, lariat, scratch) if entry["from"] else None
        if value is not None and as_written(value, entry["value"]) != plain(entry["value"]):
            fail(f"{entry['name']} is {value}, and docs/figures.txt says {entry['value']}")


def self_test(scratch):
    """What must be noticed is noticed."""
    os.makedirs(os.path.join(scratch, "docs"), exist_ok=True)
    cases = (("8.75", "takes 8.75 ns", "takes 8.75 ns", 0), ("8.75", "takes 8.8 ns", "", 1),
             ("8.75", "takes 8.75 ns", "takes 8.76 ns", 1), ("8.75", "takes 18.75 ns", "", 1),
             ("2571", "takes 2,571 ns", "", 0))
    for value, one, two, wanted in cases:
        failures.clear()
        with open(os.path.join(scratch, "docs/figures.txt"), "w", encoding="utf-8") as file:
            file.write(f"a b = {value}\n  is    it\n  from  {value} * 1\n  in    a.md: takes {{}} ns\n")
        with open(os.path.join(scratch, "a.md"), "w", encoding="utf-8") as file:
            file.write(f"It\n{one}.\nAnd {two}\n")
        look(scratch, "", scratch)
        if bool(failures) != bool(wanted):
            raise SystemExit(f"FAILED: {value} beside '{one}' and '{two}': {failures}")
    failures.clear()
    with open(os.path.join(scratch, "docs/figures.txt"), "w", encoding="utf-8") as file:
        file.write("a = 8.75\n  from  8.76 * 1\n")
    look(scratch, "", scratch)
    if not failures:
        raise SystemExit("FAILED: another value where it comes from")
    failures.clear()


def main():
    scratch = os.path.join(sys.argv[-1], "figures")
    shutil.rmtree(scratch, ignore_errors=True)
    os.makedirs(scratch)
    self_test(os.path.join(scratch, "self_test"))
    if sys.argv[1] != "--self-test":
        source, lariat = map(os.path.abspath, sys.argv[1:3])
        subprocess.run([lariat, "demo-model", "demo"], cwd=scratch, capture_output=True, check=True)
        look(source, lariat, scratch)
    for line in failures:
        print("FAILED:", line)
    return bool(failures)


if __name__ == "__main__":
    sys.exit(main())
