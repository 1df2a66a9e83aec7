"""Makes docs/python-reference.md of the docstrings of lariat.

    PYTHONPATH=build/python python3 tests/python/reference.py > docs/python-reference.md

A test makes it again and compares. Nothing is written there that help() does not say. Environments
have a page of their own, and docstrings that depend on whether gymnasium is installed.
"""

import inspect
import re
import sys

import lariat

GROUPS = (
    ("Models", "Model Meshing mesh write_demo"),
    ("Simulations", "Simulation Saved checkpoint_info Results"),
    ("Many at once", "Batch"),
    ("In real time", "Session View"),
    ("Measuring, planning, fitting",
     "info requirements predict fit profiles Fit Parameter Experiment Answer"),
)


def signature(thing):
    """As it is written where it is documented, without `self`."""
    text = getattr(thing, "__text_signature__", None)
    if text is None:
        try:
            text = str(inspect.signature(thing))
        except (TypeError, ValueError):
            return ""
    text = re.sub(r"\s+", " ", text)
    text = re.sub(r"^\((\$?(self|module|type|cls|me))(, )?(/, |/)?", "(", text)
    text = re.sub(r", \$?(/)\)$", ")", text)
    return text


def words(thing):
    """The docstring: sentences as they are, tables of parameters in a block."""
    doc = inspect.cleandoc(thing.__doc__ or "")
    parts = []
    for part in doc.split("\n\n"):
        if "\n" in part and re.search(r"\S  +\S", part) or part.startswith("    "):
            parts.append("```text\n" + part + "\n```")
        else:
            parts.append(" ".join(part.split()).replace("<", "\\<").replace("*", "\\*"))
    return "\n\n".join(parts)


def members(kind):
    """(name, object) of what a class itself has, methods behind properties."""
    shown = [(name, thing) for name, thing in vars(kind).items() if not name.startswith("_")]
    calls = [(name, thing) for name, thing in shown if callable(getattr(kind, name))]
    fields = [(name, thing) for name, thing in shown if not callable(getattr(kind, name))]
    return sorted(fields), sorted(calls)


def line(name, thing, kind):
    doc = words(thing)
    title = f"`{name}{signature(thing)}`" if kind == "call" else f"`{name}`"
    return f"**{title}**: {doc}" if not doc.startswith("```") else f"**{title}**\n\n{doc}"


def entry(name, thing):
    if not inspect.isclass(thing):
        yield f"### {name}\n\n`lariat.{name}{signature(thing)}`\n\n{words(thing)}"
        return
    made = signature(thing) if thing.__text_signature__ or "__init__" in vars(thing) else ""
    hidden = made in ("", "()", "(*args, **kwargs)") or made.startswith("(fields")
    yield f"### {name}\n\n" + ("" if hidden else f"`lariat.{name}{made}`\n\n") + words(thing)
    fields, calls = members(thing)
    for member, what in fields:
        yield line(member, what, "field")
    for member, _ in calls:
        yield line(member, getattr(thing, member), "call")


def errors():
    yield "## Errors"
    rows = ["| exception | is also | |", "|---|---|---|"]
    for name, thing in sorted(vars(lariat).items()):
        if inspect.isclass(thing) and issubclass(thing, lariat.Error):
            also = ", ".join(f"`{base.__name__}`" for base in thing.__bases__
                             if base not in (lariat.Error, Exception))
            rows.append(f"| `{name}` | {also} | {words(thing)} |")
    yield "\n".join(rows)


def page():
    yield ("# Python, call by call\n\nMade of the docstrings by `tests/python/reference.py`; `help()` says "
           "the same. The tutorial is [python.md](python.md). SI units; vectors are x, y, z; nodes "
           "and elements count from 0. Arrays are memoryviews unless it says otherwise, and "
           "`numpy.asarray` takes them without a copy. Environments for learning: "
           "[environments.md](environments.md).")
    told = {"__version__"}
    for title, names in GROUPS:
        yield f"## {title}"
        for name in names.split():
            told.add(name)
            yield from entry(name, getattr(lariat, name))
    left = [name for name in lariat.__all__ if name not in told
            and not (inspect.isclass(getattr(lariat, name))
                     and issubclass(getattr(lariat, name), lariat.Error))]
    if left:
        raise SystemExit(f"tests/python/reference.py: in no group: {', '.join(left)}")
    yield from errors()


if __name__ == "__main__":
    sys.stdout.write("\n\n".join(page()) + "\n")
