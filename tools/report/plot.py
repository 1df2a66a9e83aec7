"""Drawings in SVG, by gnuplot. Lines differ in dashes and marks as well as in colour, so that they
can be told apart in black and white."""
import subprocess

# Colours of different lightness (after Okabe and Ito), each with its own dash and mark.
STYLES = (
    ("#000000", "1", 7),
    ("#0072b2", "(12,6)", 5),
    ("#d55e00", "(3,4)", 9),
    ("#009e73", "(14,5,3,5)", 13),
    ("#a05090", "(20,6,3,6,3,6)", 11),
    ("#b08000", "(6,3)", 4),
    ("#555555", "(2,6)", 6),
    ("#56b4e9", "(9,3,2,3)", 8),
)


class Plot:
    """series: lines of (x, y) points; both axes with a name and a unit."""

    def __init__(self, x, y, log="", height=420, key="outside right top"):
        self.settings = [
            f'set terminal svg size 820,{height} dynamic font "sans-serif,14" background "white"',
            f'set xlabel "{x}"', f'set ylabel "{y}"',
            "set grid linecolor rgb '#cccccc' linewidth 0.6", f"set key {key} Left reverse samplen 4",
            "set border 3", "set tics nomirror"]
        for axis in log:
            self.settings += [f"set logscale {axis}", f'set format {axis} "10^{{%L}}"']
        self.series = []

    def set(self, line):
        self.settings.append(line)

    def line(self, label, points, marks=True, steps=False):
        self.series.append(("steps" if steps else "linespoints" if marks else "lines",
                            label, points))

    def mark(self, label, points):
        self.series.append(("points", label, points))

    def bars(self, label, points):
        self.series.append(("boxes", label, points))

    def write(self, path):
        # gnuplot wants the terminal first.
        script = self.settings[:1] + [f'set output "{path}"'] + self.settings[1:]
        blocks, drawn = [], []
        for index, (kind, label, points) in enumerate(self.series):
            colour, dash, mark = STYLES[index % len(STYLES)]
            look = f"linecolor rgb '{colour}'"
            if kind in ("linespoints", "lines", "steps"):
                look += f" linewidth 2 dashtype {dash}"
            if kind in ("linespoints", "points"):
                look += f" pointtype {mark} pointsize {1.4 if kind == 'points' else 0.8}"
            if kind == "boxes":
                look += f" fillstyle pattern {3 if index else 1} border linecolor rgb '{colour}'"
            drawn.append(f'$data{index} using 1:2 with {kind} {look} title "{label}"')
            blocks.append(f"$data{index} << END\n" +
                          "".join(f"{x!r} {y!r}\n" for x, y in points) + "END")
        script += blocks
        script.append("plot " + ", \\\n     ".join(drawn))
        run = subprocess.run(["gnuplot"], input="\n".join(script) + "\n", text=True,
                             capture_output=True, check=False)
        if run.returncode or run.stderr.strip():
            raise RuntimeError(f"{path}: gnuplot says: {run.stderr.strip()}")
