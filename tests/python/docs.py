"""Runs the ```python blocks of a page, one after the other in one namespace, and compares what each
prints with the ```text block behind it: the same bits everywhere print the same digits.

    docs.py PAGE
"""

import contextlib
import importlib.util
import io
import re
import sys

page = sys.argv[1]
with open(page, encoding="utf-8") as file:
    text = file.read()
blocks = re.findall(r"^```(python|python numpy|text)\n(.*?)^```$", text, re.M | re.S)
numpy = importlib.util.find_spec("numpy") is not None


names, failed, ran, printed = {"__name__": "__main__"}, 0, 0, None
needs_numpy = False  # from here on: the block that imports it for all that follow was skipped
for kind, code in blocks:
    if kind == "text":
        if printed is not None and printed != code:
            print(f"{page} shows\n{code}and it prints\n{printed}")
            failed += 1
        continue
    printed = None
    if ("numpy" in code or needs_numpy) and not numpy:
        needs_numpy = needs_numpy or "import numpy\nfrom" in code
        print("skipped: a block with numpy")
        continue
    out = io.StringIO()
    try:
        with contextlib.redirect_stdout(out):
            exec(compile(code, page, "exec"), names)  # pylint: disable=exec-used
    except Exception as error:  # pylint: disable=broad-except
        if "built without cminpack" not in str(error):
            raise
        print("skipped: a block with a fit, for which this build lacks cminpack")
        continue
    printed, ran = out.getvalue(), ran + 1
print(f"docs: {ran} blocks ran")
sys.exit(failed > 0 or ran < (5 if numpy else 2))
