"""Runs the code of a notebook, cell by cell in one namespace, as Jupyter would.

    notebook.py PAGE.ipynb            what cells print is compared with what the page shows
    notebook.py PAGE.ipynb --write    the page shows what they print and draw from now on
"""

import base64
import contextlib
import io
import json
import sys

try:
    import matplotlib
except ImportError:
    print("skipped: no matplotlib (apt-get install python3-matplotlib)")
    sys.exit(77)
matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

page, write = sys.argv[1], "--write" in sys.argv[2:]
with open(page, encoding="utf-8") as file:
    notebook = json.load(file)
names, failed, pictures = {"__name__": "__main__"}, 0, 0


def lines(text):
    """As notebooks store a text."""
    return text.splitlines(keepends=True)


def drawn():
    """The figures that a cell has left open, as outputs; closed."""
    for number in pyplot.get_fignums():
        out = io.BytesIO()
        pyplot.figure(number).savefig(out, format="png", dpi=72, metadata={"Software": None})
        yield {"output_type": "display_data", "metadata": {},
               "data": {"image/png": base64.b64encode(out.getvalue()).decode() + "\n",
                        "text/plain": ["<Figure>"]}}
    pyplot.close("all")


count = 0
for cell in notebook["cells"]:
    if cell["cell_type"] != "code":
        continue
    count += 1
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile("".join(cell["source"]), f"{page}, cell {count}", "exec"), names)  # pylint: disable=exec-used
    outputs = [{"output_type": "stream", "name": "stdout", "text": lines(out.getvalue())}]
    outputs = (outputs if out.getvalue() else []) + list(drawn())
    pictures += sum(one["output_type"] == "display_data" for one in outputs)
    if write:
        cell.update(execution_count=count, outputs=outputs)
        continue
    shown = "".join("".join(one["text"]) for one in cell["outputs"] if one["output_type"] == "stream")
    wanted = sum(one["output_type"] == "display_data" for one in cell["outputs"])
    if shown != out.getvalue() or wanted != sum(one["output_type"] == "display_data" for one in outputs):
        print(f"{page}, cell {count}, shows {wanted} pictures and\n{shown}and it prints\n{out.getvalue()}")
        failed += 1
if write:
    with open(page, "w", encoding="utf-8") as file:
        json.dump(notebook, file, indent=1, ensure_ascii=False, sort_keys=True)
        file.write("\n")
print(f"{page}: {count} cells ran, {pictures} pictures")
sys.exit(failed > 0 or count == 0)
